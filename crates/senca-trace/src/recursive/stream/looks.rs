//! Materials and lights as many rays at once need them.

use fearless_simd::{Simd, prelude::*};
use senca_math::LinearRgb;
use senca_math::glam::DVec3;
use senca_shading::PhongConstants;

use super::MOST_FORMS;
use super::forms::{Forms, Sight, Through};
use crate::lanes::{F, LANES, M};
use crate::material::{MaterialPoint, ReflectionPoint};
use crate::recursive::lamps::ToLight;
use crate::recursive::{Backs, LightModel, Tracer};

/// A material that is the same everywhere, but for a picture that multiplies its colour.
#[derive(Clone, Copy, Debug)]
pub(super) struct Look {
    pub(super) way: Way,
    numbers: [f64; NUMBERS],
}

/// How a material is evaluated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Way {
    /// It is its numbers.
    Constant,
    /// Its texture multiplies ambient and diffuse coefficient.
    Textured,
    /// Ray by ray.
    General,
}

const NUMBERS: usize = 19;

/// Materials of eight places.
#[derive(Clone, Copy)]
pub(super) struct Looks<S: Simd> {
    pub(super) emission: [F<S>; 3],
    /// Ambient light that is reflected.
    pub(super) ambient: [F<S>; 3],
    pub(super) diffuse: [F<S>; 3],
    pub(super) specular: [F<S>; 3],
    pub(super) exponent: F<S>,
    pub(super) mirror: [F<S>; 3],
    pub(super) ior: F<S>,
    pub(super) fresnel: M<S>,
    pub(super) hides_back: M<S>,
}

impl Look {
    /// The material of this number.
    pub(super) fn of(tracer: &Tracer<'_>, material: usize) -> Self {
        let general = Self { way: Way::General, numbers: [0.0; NUMBERS] };
        if tracer.ambient.even().is_none() {
            return general;
        }
        let Some((constant, texture)) = tracer.materials.simple(material) else { return general };
        let Some(mut look) = Self::at(tracer, constant) else { return general };
        look.way = if texture.is_some() { Way::Textured } else { Way::Constant };
        look.numbers[18] = f64::from(hides_back(tracer, constant));
        look
    }

    /// The material at a place; `None` where its reflection is not that of the books.
    pub(super) fn at(tracer: &Tracer<'_>, point: &MaterialPoint) -> Option<Self> {
        let ambient = tracer.ambient.towards(point.normal);
        let (ambient, phong) = match (point.reflection, tracer.settings.light_model) {
            (ReflectionPoint::Phong(phong), _) => (ambient * phong.ambient, phong),
            (ReflectionPoint::Unlit(color), _) => (color, PhongConstants::matte(LinearRgb::BLACK)),
            (ReflectionPoint::MetallicRoughness { base_color, metallic, roughness }, LightModel::Phong) => {
                let phong = PhongConstants::of_metallic_roughness(base_color, metallic, roughness);
                (ambient * phong.ambient, phong)
            }
            (ReflectionPoint::MetallicRoughness { .. }, LightModel::Material) => return None,
        };
        let is_lit = !matches!(point.reflection, ReflectionPoint::Unlit(_));
        let ambient = if is_lit { ambient * point.occlusion } else { ambient };
        Some(Self::new(point, ambient, &phong))
    }

    /// A place that reflects this much ambient light.
    pub(super) fn new(point: &MaterialPoint, ambient: LinearRgb, phong: &PhongConstants) -> Self {
        let colors = [point.emission, ambient, phong.diffuse, phong.specular];
        let mut numbers = [0.0; NUMBERS];
        for (three, color) in numbers.as_chunks_mut::<3>().0.iter_mut().zip(colors) {
            *three = color.to_array().map(f64::from);
        }
        numbers[12] = f64::from(phong.exponent);
        numbers[13..16].copy_from_slice(&point.mirror.to_array().map(f64::from));
        numbers[16] = f64::from(point.ior);
        numbers[17] = f64::from(u8::from(point.fresnel));
        Self { way: Way::General, numbers }
    }
}

/// Whether the back of a surface of this material is not seen.
fn hides_back(tracer: &Tracer<'_>, constant: &MaterialPoint) -> u8 {
    u8::from(match tracer.settings.backs {
        Backs::ByMaterial => !constant.double_sided,
        Backs::Hidden => true,
        Backs::Shown => false,
    })
}

impl<S: Simd> Looks<S> {
    /// All eight the same.
    #[inline(always)]
    pub(super) fn splat(simd: S, look: &Look) -> Self {
        Self::by(
            simd,
            #[inline(always)]
            |k| F::splat(simd, look.numbers[k]),
        )
    }

    /// Each its own.
    #[inline(always)]
    pub(super) fn of(simd: S, looks: &[&Look; LANES]) -> Self {
        Self::by(
            simd,
            #[inline(always)]
            |k| {
                F::from_fn(
                    simd,
                    #[inline(always)]
                    |lane| looks[lane].numbers[k],
                )
            },
        )
    }

    #[inline(always)]
    fn by(simd: S, number: impl Fn(usize) -> F<S>) -> Self {
        let zero = F::splat(simd, 0.0);
        Self {
            emission: [number(0), number(1), number(2)],
            ambient: [number(3), number(4), number(5)],
            diffuse: [number(6), number(7), number(8)],
            specular: [number(9), number(10), number(11)],
            exponent: number(12),
            mirror: [number(13), number(14), number(15)],
            ior: number(16),
            fresnel: number(17).simd_gt(zero),
            hides_back: number(18).simd_gt(zero),
        }
    }
}

/// A light of which many places at once know what it sends.
#[derive(Clone, Debug)]
pub(super) enum Lamp {
    /// The same colour from a place, or from afar.
    Simple(ToLight, DVec3, Option<Sight>),
    /// Asked place by place.
    General,
}

impl Lamp {
    /// The light of this number.
    pub(super) fn of(tracer: &Tracer<'_>, forms: &Forms, number: usize) -> Self {
        let Some((to_light, color)) = tracer.lights[number].simple() else { return Self::General };
        let color = DVec3::from_array(color.to_array().map(f64::from));
        let sight = match to_light {
            ToLight::Place(place) if forms.len() <= MOST_FORMS => Some(forms.seen_from(place)),
            _ => None,
        };
        Self::Simple(to_light, color, sight)
    }

    /// What is known about where rays towards it pass.
    #[inline(always)]
    pub(super) fn through(&self) -> Through<'_> {
        match self {
            Self::Simple(_, _, Some(sight)) => Through::To(sight),
            _ => Through::Anywhere,
        }
    }
}
