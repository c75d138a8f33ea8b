//! Trees as drawings: the tree, and the ways of its rays through the scene seen from the side.

use std::fmt::Write as _;

use senca_math::glam::{DVec2, DVec3};

use super::text::{kind, short};
use super::{PixelTrees, RayEnd, RayNode, RayTree};
use crate::World;
use crate::recursive::RayKind;

/// Rays that are drawn at most; a larger tree cannot be read.
const MAX_DRAWN: usize = 400;

/// Width of a box of the tree, and the room it takes, in pixels.
const BOX: DVec2 = DVec2::new(150.0, 58.0);
const STEP: DVec2 = DVec2::new(166.0, 104.0);

/// Side of the view from the side.
const SIDE_VIEW: DVec2 = DVec2::new(720.0, 480.0);

/// Space around everything.
const MARGIN: f64 = 20.0;

impl PixelTrees {
    /// The first tree as an SVG picture: below the tree of rays, each box a ray with what it met and
    /// adds, the same rays in the scene, in the plane of the primary ray and the first normal.
    #[must_use]
    pub fn to_svg(&self, world: &World<'_>) -> String {
        let empty = RayTree { place: [0.0; 2], color: [0.0; 4], rays: Vec::new(), cut: false };
        let tree = self.trees.first().unwrap_or(&empty);
        let layout = Layout::of(tree);
        let title_height = 30.0;
        let width = layout.size().x.max(SIDE_VIEW.x) + 2.0 * MARGIN;
        let height = title_height + layout.size().y + SIDE_VIEW.y + 3.0 * MARGIN;
        let mut out = String::new();
        let _ = writeln!(
            out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" height=\"{height:.0}\" \
             viewBox=\"0 0 {width:.0} {height:.0}\" font-family=\"sans-serif\" font-size=\"11\">"
        );
        let _ = writeln!(out, "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>");
        let [x, y] = self.pixel;
        let title = format!("pixel {x},{y}: {} rays", tree.rays.len());
        text(&mut out, DVec2::new(MARGIN, 20.0), "start", "#000", &title);
        group(&mut out, DVec2::new(MARGIN, title_height + MARGIN), |out| layout.draw(out, tree));
        let below = DVec2::new(MARGIN, title_height + layout.size().y + 2.0 * MARGIN);
        group(&mut out, below, |out| SideView::of(tree).draw(out, tree, world));
        out.push_str("</svg>\n");
        out
    }
}

/// Where the boxes of a tree lie, in units of [`STEP`].
struct Layout {
    /// Column, a leaf being one wide, and row of each ray that is drawn.
    places: Vec<DVec2>,
    columns: f64,
    rows: f64,
}

impl Layout {
    /// Leaves side by side, parents over the middle of their children. A parent comes before its
    /// children in the list, so going backwards meets children first.
    fn of(tree: &RayTree) -> Self {
        let count = tree.rays.len().min(MAX_DRAWN);
        let mut children = vec![Vec::new(); count];
        let mut depth = vec![0u32; count];
        for i in 0..count {
            if let Some(parent) = tree.rays[i].parent.map(|p| p as usize).filter(|p| *p < i) {
                children[parent].push(i);
                depth[i] = depth[parent] + 1;
            }
        }
        let mut columns = vec![f64::NAN; count];
        let mut next = 0.0;
        // Depth first, in the order of the branches: reflected before transmitted.
        let mut open: Vec<(usize, bool)> = (0..count.min(1)).map(|root| (root, false)).collect();
        while let Some((i, done)) = open.pop() {
            if children[i].is_empty() {
                columns[i] = next;
                next += 1.0;
            } else if done {
                let own: Vec<f64> = children[i].iter().map(|c| columns[*c]).collect();
                columns[i] = 0.5
                    * (own.iter().copied().fold(f64::MAX, f64::min)
                        + own.iter().copied().fold(f64::MIN, f64::max));
            } else {
                open.push((i, true));
                children[i].sort_by_key(|c| tree.rays[*c].kind != RayKind::Reflected);
                open.extend(children[i].iter().rev().map(|c| (*c, false)));
            }
        }
        let places: Vec<DVec2> =
            columns.iter().zip(&depth).map(|(x, d)| DVec2::new(*x, f64::from(*d))).collect();
        let rows = 1.0 + depth.iter().copied().max().map_or(0.0, f64::from);
        Self { places, columns: f64::max(next, 1.0), rows }
    }

    fn size(&self) -> DVec2 {
        DVec2::new(self.columns, self.rows) * STEP
    }

    fn draw(&self, out: &mut String, tree: &RayTree) {
        for (ray, place) in tree.rays.iter().zip(&self.places) {
            if let Some(parent) = ray.parent {
                let from = self.places[parent as usize] * STEP + DVec2::new(0.5 * BOX.x, BOX.y);
                let to = *place * STEP + DVec2::new(0.5 * BOX.x, 0.0);
                line(out, from, to, color(ray.kind), "");
                let label = format!("{} {}", kind(ray.kind), short(ray.weight));
                text(out, 0.35 * from + 0.65 * to + DVec2::new(4.0, 0.0), "start", color(ray.kind), &label);
            }
        }
        for (number, (ray, place)) in tree.rays.iter().zip(&self.places).enumerate() {
            draw_box(out, number, ray, *place * STEP);
        }
    }
}

fn draw_box(out: &mut String, number: usize, ray: &RayNode, corner: DVec2) {
    let (what, lights) = match &ray.end {
        RayEnd::Left { .. } => ("background".to_owned(), String::new()),
        RayEnd::Met(m) => {
            let lit = m.shadows.iter().filter(|s| s.blocker.is_none()).count();
            (m.object_name.clone(), format!("I_l {}; {lit} of {} lit", short(m.local), m.shadows.len()))
        }
    };
    let _ = writeln!(
        out,
        "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"{}\" height=\"{}\" rx=\"5\" fill=\"#f7f7f2\" stroke=\"{}\"/>",
        corner.x,
        corner.y,
        BOX.x,
        BOX.y,
        color(ray.kind)
    );
    let lines = [format!("{number}: {what}"), lights, format!("adds {}", short(ray.contribution()))];
    for (i, content) in lines.iter().enumerate() {
        let at = corner + DVec2::new(8.0, 17.0 + 16.0 * i as f64);
        text(out, at, "start", "#222", &shortened(content));
    }
}

/// At most as many characters as fit a box.
fn shortened(content: &str) -> String {
    const FITS: usize = 26;
    if content.chars().count() <= FITS {
        return content.to_owned();
    }
    content.chars().take(FITS - 1).chain(['…']).collect()
}

/// A parallel view onto a plane.
struct SideView {
    right: DVec3,
    up: DVec3,
    /// What is seen: smallest place, and pixels per world unit.
    min: DVec2,
    scale: f64,
}

impl SideView {
    /// Onto the plane of the primary ray and the first normal that is not along it.
    fn of(tree: &RayTree) -> Self {
        let first = tree.rays.first().map_or(DVec3::NEG_Z, |ray| ray.direction);
        let right = first.normalize_or(DVec3::X);
        let mut ups = tree.rays.iter().filter_map(|ray| match &ray.end {
            RayEnd::Met(m) => (m.normal - right * m.normal.dot(right)).try_normalize(),
            RayEnd::Left { .. } => None,
        });
        let up = ups.next().unwrap_or_else(|| right.any_orthonormal_vector());
        let up = if up.y < -1e-9 { -up } else { up };
        let mut view = Self { right, up, min: DVec2::ZERO, scale: 1.0 };
        view.fit(tree);
        view
    }

    fn fit(&mut self, tree: &RayTree) {
        let places = tree.rays.iter().take(MAX_DRAWN).flat_map(|ray| {
            let end = match &ray.end {
                RayEnd::Met(m) => m.point,
                RayEnd::Left { .. } => ray.origin,
            };
            [ray.origin, end]
        });
        let places: Vec<DVec2> = places.map(|p| self.flat(p)).collect();
        let (min, max) =
            places.iter().fold((DVec2::MAX, DVec2::MIN), |(min, max), p| (min.min(*p), max.max(*p)));
        let (min, max) = if places.is_empty() { (DVec2::ZERO, DVec2::ONE) } else { (min, max) };
        let size = (max - min).max(DVec2::splat(1e-6 * (max - min).max_element().max(1e-6)));
        self.scale = (0.7 * SIDE_VIEW / size).min_element();
        self.min = 0.5 * (min + max) - 0.5 * SIDE_VIEW / self.scale;
    }

    fn flat(&self, point: DVec3) -> DVec2 {
        DVec2::new(point.dot(self.right), point.dot(self.up))
    }

    /// Pixels, y down.
    fn place(&self, point: DVec3) -> DVec2 {
        let p = (self.flat(point) - self.min) * self.scale;
        DVec2::new(p.x, SIDE_VIEW.y - p.y)
    }

    fn draw(&self, out: &mut String, tree: &RayTree, world: &World<'_>) {
        let _ = writeln!(
            out,
            "<clipPath id=\"side\"><rect width=\"{0}\" height=\"{1}\"/></clipPath>\
             <rect width=\"{0}\" height=\"{1}\" fill=\"#fcfcfa\" stroke=\"#999\"/><g clip-path=\"url(#side)\">",
            SIDE_VIEW.x, SIDE_VIEW.y
        );
        self.draw_objects(out, tree, world);
        let reach = SIDE_VIEW.max_element() / self.scale;
        for ray in tree.rays.iter().take(MAX_DRAWN) {
            let end = match &ray.end {
                RayEnd::Met(m) => m.point,
                RayEnd::Left { .. } => ray.origin + reach * ray.direction,
            };
            line(out, self.place(ray.origin), self.place(end), color(ray.kind), "");
            let RayEnd::Met(m) = &ray.end else { continue };
            for shadow in &m.shadows {
                let light = if shadow.parallel { m.point + reach * shadow.to_light } else { shadow.to_light };
                let blocked = shadow.blocker.as_ref().map(|(_, place)| *place);
                let stroke = if blocked.is_some() { "#888" } else { "#c09000" };
                let dashes = "stroke-dasharray=\"4 3\"";
                line(out, self.place(m.point), self.place(blocked.unwrap_or(light)), stroke, dashes);
            }
            let tip = m.point + m.normal * (30.0 / self.scale);
            line(out, self.place(m.point), self.place(tip), "#20a040", "");
        }
        for (number, ray) in tree.rays.iter().take(MAX_DRAWN).enumerate() {
            let RayEnd::Met(m) = &ray.end else { continue };
            let p = self.place(m.point);
            let _ = writeln!(out, "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"3\" fill=\"#222\"/>", p.x, p.y);
            text(out, p + DVec2::new(6.0, -6.0), "start", "#222", &number.to_string());
        }
        out.push_str("</g>\n");
        self.draw_legend(out);
    }

    /// The boxes around the objects that rays meet, as seen from here.
    fn draw_objects(&self, out: &mut String, tree: &RayTree, world: &World<'_>) {
        let mut drawn = Vec::new();
        for ray in tree.rays.iter().take(MAX_DRAWN) {
            let RayEnd::Met(m) = &ray.end else { continue };
            if drawn.contains(&m.object) {
                continue;
            }
            drawn.push(m.object);
            let bounds = world.objects()[m.object as usize].bounds_world;
            if !(bounds.min.is_finite() && bounds.max.is_finite()) {
                continue;
            }
            let corners = bounds.corners().map(|corner| self.place(corner));
            let min = corners.iter().fold(DVec2::MAX, |min, c| min.min(*c));
            let max = corners.iter().fold(DVec2::MIN, |max, c| max.max(*c));
            // What fills the whole view, such as the ground, would say nothing.
            let (min, max) = (min.max(DVec2::ZERO), max.min(SIDE_VIEW));
            let size = max - min;
            if size.min_element() < 0.0 || size == SIDE_VIEW {
                continue;
            }
            let _ = writeln!(
                out,
                "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\" fill=\"#eef2f7\" \
                 stroke=\"#a0b0c0\"/>",
                min.x, min.y, size.x, size.y
            );
            let label = min.clamp(DVec2::splat(4.0), SIDE_VIEW - 60.0) + DVec2::new(4.0, 12.0);
            text(out, label, "start", "#6080a0", &m.object_name);
        }
    }

    fn draw_legend(&self, out: &mut String) {
        let entries = [
            ("primary", color(RayKind::Primary)),
            ("reflected", color(RayKind::Reflected)),
            ("transmitted", color(RayKind::Transmitted)),
            ("to a light", "#c09000"),
            ("blocked", "#888"),
            ("normal", "#20a040"),
        ];
        for (i, (name, stroke)) in entries.iter().enumerate() {
            let at = DVec2::new(10.0 + 95.0 * i as f64, SIDE_VIEW.y - 10.0);
            line(out, at, at + DVec2::new(18.0, 0.0), stroke, "");
            text(out, at + DVec2::new(22.0, 4.0), "start", "#222", name);
        }
    }
}

fn color(kind: RayKind) -> &'static str {
    match kind {
        RayKind::Primary => "#222",
        RayKind::Reflected => "#c03020",
        RayKind::Transmitted => "#2050c0",
        RayKind::SeenThrough => "#999",
    }
}

fn group(out: &mut String, at: DVec2, content: impl FnOnce(&mut String)) {
    let _ = writeln!(out, "<g transform=\"translate({:.1} {:.1})\">", at.x, at.y);
    content(out);
    out.push_str("</g>\n");
}

fn line(out: &mut String, from: DVec2, to: DVec2, stroke: &str, extra: &str) {
    let _ = writeln!(
        out,
        "<line x1=\"{:.1}\" y1=\"{:.1}\" x2=\"{:.1}\" y2=\"{:.1}\" stroke=\"{stroke}\" {extra}/>",
        from.x, from.y, to.x, to.y
    );
}

fn text(out: &mut String, at: DVec2, anchor: &str, fill: &str, content: &str) {
    let content = content.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    let _ = writeln!(
        out,
        "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"{anchor}\" fill=\"{fill}\">{content}</text>",
        at.x, at.y
    );
}
