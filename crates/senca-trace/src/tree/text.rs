//! Trees as text, and as a graph for Graphviz.

use std::fmt::Write as _;

use senca_math::LinearRgb;
use senca_math::glam::DVec3;

use super::{Meeting, PixelTrees, RayEnd, RayNode, RayTree, Shadow};
use crate::recursive::RayKind;

/// Steps of indentation that are drawn at most: deep trees stay readable and small.
const DEEPEST_INDENT: u32 = 40;

impl PixelTrees {
    /// All trees as text, one paragraph a ray, in the order of following them.
    #[must_use]
    pub fn to_text(&self) -> String {
        let mut out = String::new();
        let ([x, y], [w, h]) = (self.pixel, self.size);
        let [r, g, b, a] = self.color;
        let color = rgb(LinearRgb::new(r, g, b));
        let _ = writeln!(out, "pixel {x},{y} of {w}x{h}: {color}, alpha {a}");
        let rays = &self.counts.rays;
        let _ = writeln!(
            out,
            "{} primary, {} reflected, {} transmitted, {} shadow rays; {} tests",
            rays.primary, rays.reflected, rays.transmitted, rays.shadow, self.counts.work.tests
        );
        for (i, tree) in self.trees.iter().enumerate() {
            let _ = writeln!(out, "\nsample {} of {}", i + 1, self.trees.len());
            tree.write_text(&mut out);
        }
        out
    }

    /// All trees as a graph in the language of Graphviz.
    #[must_use]
    pub fn to_dot(&self) -> String {
        let mut out =
            String::from("digraph rays {\n  node [shape=box, fontname=\"sans-serif\", fontsize=10];\n");
        out.push_str("  edge [fontname=\"sans-serif\", fontsize=9];\n");
        for (s, tree) in self.trees.iter().enumerate() {
            let [x, y] = tree.place;
            let _ = writeln!(out, "  eye{s} [label=\"({x}, {y})\", shape=circle];");
            for (i, ray) in tree.rays.iter().enumerate() {
                tree.write_dot(&mut out, s, i, ray);
            }
        }
        out.push_str("}\n");
        out
    }
}

impl RayTree {
    fn write_text(&self, out: &mut String) {
        let [x, y] = self.place;
        let _ = writeln!(out, "place ({x}, {y}), light {}, alpha {}", rgb(self.total()), self.color[3]);
        for (number, ray) in self.rays.iter().enumerate() {
            let indent = "  ".repeat(ray.nest.min(DEEPEST_INDENT) as usize);
            let from = ray.parent.map_or_else(String::new, |parent| format!(" of {parent}"));
            let _ = writeln!(out, "{indent}{number}: {} ray{from}, level {}", kind(ray.kind), ray.nest);
            let (origin, direction) = (vector(ray.origin), vector(ray.direction));
            let _ = writeln!(out, "{indent}   from {origin} along {direction}, share {}", rgb(ray.weight));
            match &ray.end {
                RayEnd::Left { light, .. } => {
                    let _ = writeln!(out, "{indent}   leaves the scene, background {}", rgb(*light));
                }
                RayEnd::Met(meeting) => meeting.write_text(out, &indent),
            }
            let _ = writeln!(out, "{indent}   adds {}", rgb(ray.contribution()));
        }
        if self.cut {
            let _ = writeln!(out, "... and more rays");
        }
    }

    fn write_dot(&self, out: &mut String, sample: usize, number: usize, ray: &RayNode) {
        let label = match &ray.end {
            RayEnd::Left { .. } => "background".to_owned(),
            RayEnd::Met(m) => format!("{}\\nI_l {}", escaped(&m.object_name), short(m.local)),
        };
        let adds = short(ray.contribution());
        let _ = writeln!(out, "  r{sample}_{number} [label=\"{number}: {label}\\nadds {adds}\"];");
        let from = ray.parent.map_or_else(|| format!("eye{sample}"), |p| format!("r{sample}_{p}"));
        let style = match ray.kind {
            RayKind::Primary => "color=black",
            RayKind::Reflected => "color=\"#c03020\"",
            RayKind::Transmitted => "color=\"#2050c0\"",
            RayKind::SeenThrough => "color=gray",
        };
        let share = short(ray.weight);
        let _ = writeln!(
            out,
            "  {from} -> r{sample}_{number} [label=\"{}\\n{share}\", {style}];",
            kind(ray.kind)
        );
        let RayEnd::Met(meeting) = &ray.end else { return };
        for (i, shadow) in meeting.shadows.iter().enumerate() {
            let lit = shadow.blocker.is_none();
            let text = shadow.blocker.as_ref().map_or("lit".to_owned(), |(name, _)| format!("by {name}"));
            let name = escaped(&shadow.light_name);
            let color = if lit { "#b08000" } else { "#808080" };
            let _ = writeln!(
                out,
                "  s{sample}_{number}_{i} [label=\"{name}\\n{}\", shape=ellipse, color=\"{color}\"];",
                escaped(&text)
            );
            let _ = writeln!(
                out,
                "  r{sample}_{number} -> s{sample}_{number}_{i} [style=dashed, color=\"{color}\"];"
            );
        }
    }
}

impl Meeting {
    fn write_text(&self, out: &mut String, indent: &str) {
        let side = if self.entering { "outside" } else { "inside" };
        let material = match &*self.material_name {
            "" => String::new(),
            name => format!(" ({name})"),
        };
        let _ =
            writeln!(out, "{indent}   meets {}{material} from {side} at t = {}", self.object_name, self.t);
        let _ = writeln!(out, "{indent}   X = {}, normal {}", vector(self.point), vector(self.normal));
        let (k_r, k_t) = (rgb(self.mirror), rgb(self.transmission));
        let _ = writeln!(out, "{indent}   k_r = {k_r}, k_t = {k_t}, eta = {}", self.ior);
        if self.coverage < 1.0 {
            let _ = writeln!(out, "{indent}   is there to the share of {}", self.coverage);
        }
        for shadow in &self.shadows {
            shadow.write_text(out, indent);
        }
        let _ = writeln!(out, "{indent}   I_l = {}, share {}", rgb(self.local), rgb(self.weight));
        if self.fog != LinearRgb::BLACK {
            let _ = writeln!(out, "{indent}   fog adds {}", rgb(self.fog));
        }
        if self.too_deep {
            let _ = writeln!(out, "{indent}   sends no rays: MaxNest is reached");
        }
        if self.negligible > 0 {
            let _ = writeln!(out, "{indent}   sends {} rays less: too small a share", self.negligible);
        }
    }
}

impl Shadow {
    fn write_text(&self, out: &mut String, indent: &str) {
        let to = if self.parallel { "along" } else { "at" };
        let what = match &self.blocker {
            None => format!("lit, reflects {}", rgb(self.reflected)),
            Some((name, place)) if self.share == LinearRgb::BLACK => {
                format!("blocked by {name} at {}", vector(*place))
            }
            Some((name, _)) => {
                format!("tinted by {name} to {}, reflects {}", rgb(self.share), rgb(self.reflected))
            }
        };
        let _ = writeln!(out, "{indent}   light {} {to} {}: {what}", self.light_name, vector(self.to_light));
    }
}

/// Name of a kind of ray.
pub(super) fn kind(kind: RayKind) -> &'static str {
    match kind {
        RayKind::Primary => "primary",
        RayKind::Reflected => "reflected",
        RayKind::Transmitted => "transmitted",
        RayKind::SeenThrough => "seen-through",
    }
}

fn rgb(c: LinearRgb) -> String {
    if c.r == c.g && c.g == c.b { format!("{}", c.r) } else { format!("({}, {}, {})", c.r, c.g, c.b) }
}

/// A colour in few digits.
pub(super) fn short(c: LinearRgb) -> String {
    if c.r == c.g && c.g == c.b {
        return format!("{:.3}", c.r);
    }
    format!("{:.3} {:.3} {:.3}", c.r, c.g, c.b)
}

fn vector(v: DVec3) -> String {
    let rounded = |x: f64| (x * 1e9).round() / 1e9 + 0.0;
    format!("({}, {}, {})", rounded(v.x), rounded(v.y), rounded(v.z))
}

fn escaped(text: &str) -> String {
    text.replace('\\', "\\\\").replace('"', "\\\"")
}
