//! A solution as the light on surfaces that rays meet.

use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;
use senca_math::LinearRgb;
use senca_math::glam::DVec3;
use senca_scene::{Material, NodeId, Reflection, Scene};
use senca_trace::recursive::{KnownLight, SurfaceLight};
use senca_trace::{Interaction, MaterialPoint, ReflectionPoint, World};

use super::{ElementFinder, LightField, Place};
use crate::Gather;
use crate::false_color::FalseColors;

/// Share of the light that a dielectric sends back at its surface, which a matt base does not see.
const DIELECTRIC_MIRROR: f32 = 0.04;

/// What is shown of the light.
#[derive(Clone, Debug, Default)]
pub enum Look {
    /// Matt light and the light of emitters; no mirrors, no highlights.
    #[default]
    Matt,
    /// Light that arrives, in place of the ambient light of the recursive tracer, which adds what mirrors,
    /// glass and lamps bring: the light of lamps must not be in the field.
    /// Source: course text, task 4.9.
    Ambient,
    /// Light that arrives, by a scale of colours.
    FalseColors(FalseColors),
}

/// Thin lines around elements.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshLines {
    /// Place of the eye; `None` in a parallel view.
    pub eye: Option<DVec3>,
    /// Size of a pixel at distance 1 from the eye, or anywhere in a parallel view.
    pub pixel: f64,
    /// Colour.
    pub color: LinearRgb,
}

/// The light of a field at the places that rays meet.
pub struct ShownLight<'a> {
    field: &'a LightField<'a>,
    finder: &'a ElementFinder<'a>,
    /// Number among the scene's instances, by object of the world.
    instances: Vec<u32>,
    /// Light where no element is.
    elsewhere: LinearRgb,
    look: Look,
    lines: Option<MeshLines>,
    gather: Option<&'a Gather<'a>>,
}

impl<'a> ShownLight<'a> {
    /// For the objects of `world`, whose scene is that of the field.
    #[must_use]
    pub fn new(
        world: &World<'_>,
        field: &'a LightField<'a>,
        finder: &'a ElementFinder<'a>,
        look: Look,
    ) -> Self {
        let scene = world.scene();
        let instances = instance_numbers(scene);
        let number = |node: NodeId| instances.get(node.index()).copied().unwrap_or(u32::MAX);
        Self {
            field,
            finder,
            instances: world.objects().iter().map(|object| number(object.node)).collect(),
            elsewhere: scene.ambient,
            look,
            lines: None,
            gather: None,
        }
    }

    /// The same with lines around elements.
    #[must_use]
    pub fn with_lines(mut self, lines: MeshLines) -> Self {
        self.lines = Some(lines);
        self
    }

    /// The same with light gathered once more at each place that is met (final gathering).
    #[must_use]
    pub fn gathered_by(mut self, gather: &'a Gather<'a>) -> Self {
        self.gather = Some(gather);
        self
    }

    /// Light that arrives at a place.
    fn arriving(&self, at: &Interaction, place: &Place) -> LinearRgb {
        match self.gather {
            Some(gather) => gather.at(place.point, facing(at), key_of(at.point)),
            None => self.field.at(place.element, place.point),
        }
    }

    fn place(&self, at: &Interaction) -> Option<Place> {
        let normal = if at.entering { at.normal } else { -at.normal };
        let instance = self.instances[at.object as usize];
        self.finder.find(instance, at.material as u32, at.point, normal)
    }

    /// Share of the place that a line around its element covers.
    fn line_share(&self, lines: &MeshLines, place: &Place, at: &Interaction) -> f32 {
        let mesh = self.field.mesh();
        let shape = mesh.shape(place.element);
        let corners = shape.corners();
        let next = corners.iter().cycle().skip(1);
        let distance = |(a, b): (&DVec3, &DVec3)| {
            let edge = (*b - *a).normalize_or_zero();
            (place.point - *a).reject_from(edge).length()
        };
        let nearest = corners.iter().zip(next).map(distance).fold(f64::INFINITY, f64::min);
        let pixel = lines.pixel * lines.eye.map_or(1.0, |eye| eye.distance(at.point));
        let cos = at.normal.dot(at.to_viewer).abs().max(0.25);
        f32::from(u8::from(nearest < 0.5 * pixel / cos.sqrt()))
    }
}

/// The normal on the side that is seen.
fn facing(at: &Interaction) -> DVec3 {
    if at.entering { at.shading_normal } else { -at.shading_normal }
}

/// A number that differs from place to place as chance would have it.
fn key_of(place: DVec3) -> u64 {
    let mut hash = 0_u64;
    for bits in place.to_array().map(f64::to_bits) {
        hash = (hash ^ bits).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        hash ^= hash >> 29;
    }
    hash
}

/// Number of the instance at each node.
fn instance_numbers(scene: &Scene) -> Vec<u32> {
    let mut numbers = vec![u32::MAX; scene.nodes.len()];
    for (number, instance) in (0..).zip(scene.instances()) {
        numbers[instance.node.index()] = number;
    }
    numbers
}

/// Share of light that a material scatters evenly, its pictures left aside.
pub(crate) fn matt_reflectance(material: &Material) -> LinearRgb {
    match &material.reflection {
        _ if material.unlit => LinearRgb::BLACK,
        Reflection::Phong(phong) => phong.diffuse,
        Reflection::MetallicRoughness(rough) => {
            rough.base_color * ((1.0 - rough.metallic) * (1.0 - DIELECTRIC_MIRROR))
        }
    }
}

/// Share of light that a place scatters evenly, or the colour of an unlit one.
pub(crate) fn matt_share(material: &MaterialPoint) -> LinearRgb {
    match &material.reflection {
        ReflectionPoint::Phong(constants) => constants.diffuse,
        ReflectionPoint::MetallicRoughness { base_color, metallic, .. } => {
            *base_color * ((1.0 - metallic) * (1.0 - DIELECTRIC_MIRROR))
        }
        ReflectionPoint::Unlit(_) => LinearRgb::BLACK,
    }
}

impl SurfaceLight for ShownLight<'_> {
    fn at(&self, at: &Interaction, material: &MaterialPoint) -> KnownLight {
        let place = self.place(at);
        let arriving = place.map_or(self.elsewhere, |place| self.arriving(at, &place));
        let shown = match (&self.look, &material.reflection) {
            (Look::Ambient, _) => return KnownLight::Arriving(arriving),
            (Look::FalseColors(colors), _) if place.is_some() => colors.of(arriving),
            (Look::FalseColors(_), _) => LinearRgb::splat(0.02),
            (Look::Matt, ReflectionPoint::Unlit(color)) => *color + material.emission,
            (Look::Matt, _) => material.emission + matt_share(material) * arriving,
        };
        let share = match (&self.lines, &place) {
            (Some(lines), Some(place)) => (self.line_share(lines, place, at), lines.color),
            _ => (0.0, LinearRgb::BLACK),
        };
        KnownLight::Leaving(shown.lerp(share.1, share.0))
    }
}

/// Writes down the places that are seen, so that light can be gathered for them together.
pub struct SeenPlaces<'a> {
    light: &'a ShownLight<'a>,
    places: Mutex<Vec<[u64; 6]>>,
}

impl<'a> SeenPlaces<'a> {
    /// Of what `light` is to show.
    #[must_use]
    pub fn new(light: &'a ShownLight<'a>) -> Self {
        Self { light, places: Mutex::default() }
    }

    /// Places and unit normals, in an order that does not depend on when they were seen.
    #[must_use]
    pub fn into_places(self) -> Vec<(DVec3, DVec3)> {
        let mut places = self.places.into_inner().unwrap_or_else(PoisonError::into_inner);
        places.par_sort_unstable();
        places.dedup();
        let read = |bits: [u64; 6]| {
            let [x, y, z, u, v, w] = bits.map(f64::from_bits);
            (DVec3::new(x, y, z), DVec3::new(u, v, w))
        };
        places.into_iter().map(read).collect()
    }
}

impl SurfaceLight for SeenPlaces<'_> {
    fn at(&self, at: &Interaction, _: &MaterialPoint) -> KnownLight {
        if let Some(place) = self.light.place(at) {
            let ([x, y, z], [u, v, w]) = (place.point.to_array(), facing(at).to_array());
            let mut places = self.places.lock().unwrap_or_else(PoisonError::into_inner);
            places.push([x, y, z, u, v, w].map(f64::to_bits));
        }
        KnownLight::Leaving(LinearRgb::BLACK)
    }
}
