//! Light that comes straight from lamps and from the sky.
//!
//! Lamps without extent take no part in the exchange between patches, so what they send is found for
//! each element by itself and joins the light the element gives off: the system is solved with
//! `E + reflectance * direct` in place of E. Lamps light as in the other renderers
//! ([`senca_shading::ShadingLight`]), with these rules:
//!
//! | what | how it lights |
//! |---|---|
//! | point, spot, parallel, box | as the lamp says, with one shadow ray to each place of an element |
//! | area | with the radiance that the path tracer gives it: by Lambert's formula where that is the same from everywhere, and the share of equal cells that are seen |
//! | background colour, gradient | from all around, by directions that are spread as the cosine weighs them |
//! | environment | by the middles of regions of equal light (median cut, Debevec 2005) |
//! | ambient light | not at all: it stands for what surfaces send each other, and that is computed |
//!
//! An element is lit as the mean over its area. It is looked at in quarters, and quarters that differ
//! are looked at in quarters again ([`DirectSettings`]).

mod sky;

use rayon::prelude::*;
use senca_math::glam::{DMat4, DVec3};
use senca_math::{Control, LinearRgb};
use senca_scene::{Attenuation, LightKind, Scene};
use senca_shading::{Lamp, ShadingLight, distance_attenuation};

use crate::form_factor::point_to_polygon;
use crate::open_parts::OpenParts;
use crate::{ElementMesh, Occluders, PatchPolygon, RadiosityError};
use sky::Sky;
pub(crate) use sky::cosine_direction;

/// How finely elements look at lamps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectSettings {
    /// Light at the quarters of an element, or of a part of it, may differ by this share of the
    /// brightest before they are divided again; in (0, 1]. Default 0.1.
    pub tolerance: f32,
    /// Divisions at most: 0 looks at the middle of the element, each more at four times the places, up
    /// to 6. Default 3.
    pub depth: u32,
    /// Directions in which the sky is looked at from each place, 1 to 65 536. Default 64.
    pub sky_directions: u32,
    /// Cells along each edge of an area light, 1 to 64. Default 4.
    pub area_cells: u32,
}

impl Default for DirectSettings {
    fn default() -> Self {
        Self { tolerance: 0.1, depth: 3, sky_directions: 64, area_cells: 4 }
    }
}

impl DirectSettings {
    /// `Ok` when every number is in its range.
    ///
    /// # Errors
    /// [`RadiosityError::Setting`].
    pub fn check(&self) -> Result<(), RadiosityError> {
        let tolerance = f64::from(self.tolerance);
        let in_range = tolerance > 0.0 && tolerance <= 1.0;
        setting("direct light's tolerance", tolerance, in_range, "above 0 and at most 1")?;
        setting("direct light's depth", self.depth.into(), self.depth <= 6, "at most 6")?;
        let n = self.sky_directions;
        setting("sky directions", n.into(), (1..=1 << 16).contains(&n), "from 1 to 65536")?;
        let n = self.area_cells;
        setting("cells of area lights", n.into(), (1..=64).contains(&n), "from 1 to 64")
    }
}

/// How far from the corners, as a share of the way to the middle, an element is looked at there.
const CORNER_INSET: f64 = 0.05;

fn setting(name: &'static str, value: f64, fits: bool, expected: &'static str) -> Result<(), RadiosityError> {
    if fits { Ok(()) } else { Err(RadiosityError::Setting { name, value, expected }) }
}

/// The lamps and the sky of a scene. The default is dark.
#[derive(Clone, Debug, Default)]
pub struct DirectLight {
    lamps: Vec<ShadingLight>,
    rectangles: Vec<Rectangle>,
    sky: Option<Sky>,
    settings: DirectSettings,
}

/// Light on an element.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DirectSample {
    /// Mean over the area: what a white matt element would show.
    pub mean: LinearRgb,
    /// Per channel, the least at any place that was looked at.
    pub least: LinearRgb,
    /// Per channel, the most.
    pub most: LinearRgb,
}

/// An area light: `color / area` times the integral over its area of both cosines and the share that
/// is left at the distance.
#[derive(Clone, Copy, Debug)]
struct Rectangle {
    middle: DVec3,
    /// Whole edges.
    edges: [DVec3; 2],
    /// Unit, the side that shines.
    axis: DVec3,
    color: LinearRgb,
    attenuation: Attenuation,
}

impl DirectLight {
    /// What the nodes of `scene` place, and its background.
    ///
    /// # Errors
    /// [`RadiosityError::Setting`].
    pub fn of_scene(scene: &Scene, settings: &DirectSettings) -> Result<Self, RadiosityError> {
        settings.check()?;
        let sky = Sky::new(scene, settings.sky_directions);
        let mut light = Self { lamps: Vec::new(), rectangles: Vec::new(), sky, settings: *settings };
        for (node, world_from_node) in scene.nodes.iter().zip(scene.world_from_nodes()) {
            let (Some(id), Some(world_from_light)) = (node.light, world_from_node) else { continue };
            let Some(placed) = scene.lights.get(id.index()) else { continue };
            if placed.color.max_component() <= 0.0 {
                continue;
            }
            if let LightKind::Area { size, .. } = placed.kind {
                light.rectangles.extend(Rectangle::new(
                    size,
                    &world_from_light,
                    placed.color,
                    placed.attenuation,
                ));
            } else {
                ShadingLight::resolve(placed, &world_from_light, |lamp| light.lamps.push(lamp));
            }
        }
        Ok(light)
    }

    /// Takes out the area lights that are plain matt lamps, those whose light falls with the square of
    /// the distance and has no end: their shapes, whose fronts shine, and what they show. A method that
    /// has them among its emitters lights by the rest of this.
    #[must_use]
    pub fn take_plain_areas(&mut self) -> Vec<(PatchPolygon, LinearRgb)> {
        let plain = |area: &Rectangle| area.attenuation == Attenuation::InverseSquare { range: None };
        let (taken, left) = self.rectangles.iter().partition(|area| plain(area));
        self.rectangles = left;
        let taken: Vec<Rectangle> = taken;
        taken.iter().map(Rectangle::as_emitter).collect()
    }

    /// Whether there is neither a lamp nor a sky.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.lamps.is_empty() && self.rectangles.is_empty() && self.sky.is_none()
    }

    /// Light that arrives at a place on a surface with this unit normal: what a white matt surface
    /// would show there.
    #[must_use]
    pub fn at(&self, occluders: &Occluders, place: DVec3, normal: DVec3) -> LinearRgb {
        let from_lamps = self.lamps.iter().map(|lamp| from_lamp(lamp, occluders, place, normal));
        let cells = self.settings.area_cells;
        let from_areas = self.rectangles.iter().map(|area| area.at(occluders, place, normal, cells));
        let sum = from_lamps.chain(from_areas).fold(LinearRgb::BLACK, |sum, light| sum + light);
        sum + self.sky.as_ref().map_or(LinearRgb::BLACK, |sky| sky.at(occluders, place, normal))
    }

    /// Light on a polygon with this unit normal.
    #[must_use]
    pub fn on(&self, occluders: &Occluders, shape: &PatchPolygon, normal: DVec3) -> DirectSample {
        if self.is_empty() {
            return DirectSample::default();
        }
        let light = |place: DVec3| self.at(occluders, place, normal);
        let center = shape.center();
        let whole = Part { shape: *shape, light: light(center) };
        let middle = DirectSample { mean: whole.light, least: whole.light, most: whole.light };
        // The corners find shadows that reach no quarter's middle.
        let corners = shape.corners().iter().take(if self.settings.depth > 0 { 4 } else { 0 });
        let seen = corners.fold(middle, |seen, &c| seen.including(light(c.lerp(center, CORNER_INSET))));
        self.mean_over(&whole, seen, 0, &light)
    }

    /// Light on the open part of an element of `mesh`.
    pub(crate) fn on_open_part(
        &self,
        occluders: &Occluders,
        mesh: &ElementMesh,
        open: &OpenParts,
        element: u32,
    ) -> DirectSample {
        if mesh.elements()[element as usize].open <= 0.0 {
            return DirectSample::default();
        }
        let Some(part) = open.get(mesh, element) else {
            return self.on_element(occluders, mesh, element);
        };
        if let Some(shape) = &part.shape {
            return self.on(occluders, shape, mesh.normal(element));
        }
        let samples =
            part.triangles().map(|(shape, share)| (self.on(occluders, &shape, mesh.normal(element)), share));
        let join = |(all, share): (DirectSample, f64), (one, more): (DirectSample, f64)| {
            let mean = all.mean + one.mean * more as f32;
            let seen = if share > 0.0 { all.including(one.least).including(one.most) } else { one };
            (DirectSample { mean, ..seen }, share + more)
        };
        samples.fold((DirectSample::default(), 0.0), join).0
    }

    /// Light on an element of `mesh`, on average over its open part.
    #[must_use]
    pub fn on_element(&self, occluders: &Occluders, mesh: &ElementMesh, element: u32) -> DirectSample {
        let sample = self.on(occluders, &mesh.shape(element), mesh.normal(element));
        let open = mesh.elements()[element as usize].open;
        if open <= 0.0 || open >= 1.0 {
            return sample;
        }
        // No lamp lights what is not open, so all of it falls on the rest.
        let [mean, most] = [sample.mean * open.recip(), sample.most];
        let mean = LinearRgb::new(mean.r.min(most.r), mean.g.min(most.g), mean.b.min(most.b));
        DirectSample { mean, ..sample }
    }

    /// Light on some elements of `mesh`, in their order, by all threads of the current rayon pool.
    ///
    /// # Errors
    /// [`RadiosityError::Cancelled`].
    pub fn on_elements(
        &self,
        occluders: &Occluders,
        mesh: &ElementMesh,
        elements: &[u32],
        control: &Control<'_>,
    ) -> Result<Vec<DirectSample>, RadiosityError> {
        let on = |&element: &u32| {
            control.check()?;
            Ok(self.on_element(occluders, mesh, element))
        };
        elements.par_iter().with_min_len(4).map(on).collect()
    }

    /// The mean over a part, from its quarters.
    fn mean_over(
        &self,
        part: &Part,
        here: DirectSample,
        depth: u32,
        light: &impl Fn(DVec3) -> LinearRgb,
    ) -> DirectSample {
        if depth >= self.settings.depth {
            return here;
        }
        let quarters = part.shape.quarters().map(|shape| Part { shape, light: light(shape.center()) });
        let seen = quarters.iter().fold(here, |seen, quarter| seen.including(quarter.light));
        let even = seen.spread() <= self.settings.tolerance * seen.most.max_component();
        let inner = quarters.map(|quarter| {
            let area = quarter.shape.normal_and_area().1 as f32;
            let value = if even {
                DirectSample { mean: quarter.light, ..seen }
            } else {
                let middle = DirectSample { mean: quarter.light, least: quarter.light, most: quarter.light };
                self.mean_over(&quarter, middle, depth + 1, light)
            };
            (area, value)
        });
        let area: f32 = inner.iter().map(|(area, _)| area).sum();
        let mean = inner.iter().fold(LinearRgb::BLACK, |sum, (a, value)| sum + value.mean * (a / area));
        let all = inner.iter().fold(seen, |all, (_, v)| all.including(v.least).including(v.most));
        DirectSample { mean, ..all }
    }
}

/// A part of an element, and the light in its middle.
struct Part {
    shape: PatchPolygon,
    light: LinearRgb,
}

impl DirectSample {
    /// The largest difference of a channel over the area.
    #[must_use]
    pub fn spread(&self) -> f32 {
        (self.most - self.least).max_component()
    }

    fn including(self, light: LinearRgb) -> Self {
        let pick = |f: fn(f32, f32) -> f32, a: LinearRgb| {
            LinearRgb::new(f(a.r, light.r), f(a.g, light.g), f(a.b, light.b))
        };
        Self { mean: self.mean, least: pick(f32::min, self.least), most: pick(f32::max, self.most) }
    }
}

/// Light of a lamp without extent.
fn from_lamp(lamp: &ShadingLight, occluders: &Occluders, place: DVec3, normal: DVec3) -> LinearRgb {
    let Some(incident) = lamp.incident(place.as_vec3()) else { return LinearRgb::BLACK };
    let cos = incident.to_light.dot(normal.as_vec3());
    if cos <= 0.0 {
        return LinearRgb::BLACK;
    }
    let (position, axis) = (lamp.position.as_dvec3(), lamp.axis.as_dvec3());
    let source = match lamp.lamp {
        Lamp::Parallel => place - axis * occluders.beyond(place),
        Lamp::Box { .. } => place - axis * (place - position).dot(axis),
        Lamp::Point | Lamp::Spot(_) | Lamp::Patch => position,
    };
    incident.intensity * occluders.transmittance(place, source) * cos
}

impl Rectangle {
    /// Of a light of this size in the xy plane of its frame, which shines along -z. `None` where the
    /// frame flattens it.
    fn new(
        size: [f64; 2],
        world_from_light: &DMat4,
        color: LinearRgb,
        attenuation: Attenuation,
    ) -> Option<Self> {
        let edges = [DVec3::X * size[0], DVec3::Y * size[1]].map(|e| world_from_light.transform_vector3(e));
        let forward = world_from_light.transform_vector3(DVec3::NEG_Z);
        let across = edges[0].cross(edges[1]).try_normalize()?;
        let axis = if across.dot(forward) < 0.0 { -across } else { across };
        let middle = world_from_light.transform_point3(DVec3::ZERO);
        middle.is_finite().then_some(Self { middle, edges, axis, color, attenuation })
    }

    /// The polygon, and what it shows.
    fn as_emitter(&self) -> (PatchPolygon, LinearRgb) {
        let [u, v] = self.edges.map(|edge| 0.5 * edge);
        let mut corners = [-u - v, u - v, u + v, v - u].map(|off| self.middle + off);
        if PatchPolygon::quad(corners).normal_and_area().0.dot(self.axis) < 0.0 {
            corners.reverse();
        }
        let shape = PatchPolygon::quad(corners);
        let area = shape.normal_and_area().1;
        (shape, self.color * (std::f64::consts::PI / area) as f32)
    }

    /// Plain lamps by Lambert's formula times the share of their cells that is seen, others cell by cell.
    fn at(&self, occluders: &Occluders, place: DVec3, normal: DVec3, cells: u32) -> LinearRgb {
        let mut all = 0.0;
        let mut seen = LinearRgb::BLACK;
        for cell in 0..cells * cells {
            let [u, v] = [cell % cells, cell / cells].map(|i| (f64::from(i) + 0.5) / f64::from(cells) - 0.5);
            let source = self.middle + u * self.edges[0] + v * self.edges[1];
            let way = source - place;
            let distance = way.length();
            let (here, there) = (way.dot(normal), -way.dot(self.axis));
            if !(here > 0.0 && there > 0.0) {
                continue;
            }
            let falloff = f64::from(distance_attenuation(&self.attenuation, distance as f32));
            let weight = falloff * here * there / (distance * distance);
            all += weight;
            seen += occluders.transmittance(place, source) * weight as f32;
        }
        if self.attenuation != (Attenuation::InverseSquare { range: None }) || all <= 0.0 {
            return self.color * seen * f64::from(cells * cells).recip() as f32;
        }
        let (shape, shows) = self.as_emitter();
        let factor = point_to_polygon(place, normal, shape.corners());
        shows * seen * (factor / all) as f32
    }
}

#[cfg(test)]
mod tests;
