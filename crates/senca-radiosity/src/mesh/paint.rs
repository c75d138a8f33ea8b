//! What polygons are made of, on the mean over their area.
//!
//! Matt reflection is what takes part; what a surface mirrors or throws back as a highlight is left out,
//! as is its share of the light. The rules are those of the path tracer:
//!
//! | material | reflectance | own light |
//! |---|---|---|
//! | Phong | diffuse coefficient, lowered where the coefficients add up to more than 1 | emission |
//! | metallic-roughness | base colour without metal and transmission, less 4 % for the surface's mirror | emission |
//! | unlit | 0 | its colour |
//! | blended, masked | as much as is there; the rest lets light pass | as much as is there |
//! | transmitting | what is left of it; light passes unbent | emission |
//!
//! Pictures and vertex colours count by their mean over the polygon, in linear light, from
//! places that lie evenly on it. Own light comes from the back too where the material has two sides.

use senca_math::LinearRgb;
use senca_math::glam::{DVec2, DVec3, Vec4};
use senca_scene::{Material, Mesh, Reflection, Scene};
use senca_trace::{Interaction, MaterialPoint, MaterialTable, ReflectionPoint};

use super::RadiantSurface;

/// Share of the light that a dielectric sends back at its surface, which a matt base does not see.
const DIELECTRIC_MIRROR: f32 = 0.04;

/// Places on a polygon along each side: pictures are looked at about so often.
const PLACES: u32 = 12;

/// The materials of a scene.
#[derive(Debug)]
pub(super) struct Paint<'s> {
    scene: &'s Scene,
    table: MaterialTable<'s>,
    default: Material,
}

/// A mean over an area.
#[derive(Clone, Copy, Debug, Default)]
struct Mean {
    reflectance: LinearRgb,
    emission: LinearRgb,
    transmittance: LinearRgb,
}

impl<'s> Paint<'s> {
    pub(super) fn new(scene: &'s Scene) -> Self {
        let default = Material { double_sided: true, ..Material::default() };
        Self { scene, table: MaterialTable::new(scene), default }
    }

    /// A material; the scene's count stands for the default material.
    pub(super) fn material(&self, number: u32) -> &Material {
        self.scene.materials.get(number as usize).unwrap_or(&self.default)
    }

    /// Whether polygons of the material differ from each other.
    pub(super) fn varies(&self, number: u32, mesh: &Mesh) -> bool {
        let material = self.material(number);
        let base = match &material.reflection {
            Reflection::Phong(phong) => phong.texture.is_some(),
            Reflection::MetallicRoughness(rough) => {
                rough.base_color_texture.is_some() || rough.metallic_roughness_texture.is_some()
            }
        };
        base || material.emission_texture.is_some() || !mesh.vertices.color.is_empty()
    }

    /// One side of a material where nothing varies.
    pub(super) fn plain(&self, surface: RadiantSurface) -> RadiantSurface {
        let at = self.at(surface.material, [DVec2::ZERO; 2], Vec4::ONE);
        self.surface(surface, at)
    }

    /// One side of a material, on the mean over a triangle or quadrilateral of vertices of `mesh`.
    pub(super) fn mean(&self, surface: RadiantSurface, mesh: &Mesh, corners: &[u32]) -> RadiantSurface {
        let step = 1.0 / f64::from(PLACES);
        let mut sum = Mean::default();
        for place in 0..PLACES * PLACES {
            let [u, v] = [place % PLACES, place / PLACES].map(|i| (f64::from(i) + 0.5) * step);
            let weights = weights(corners.len(), u, v);
            let (texcoords, color) = attributes(mesh, corners, weights);
            let here = self.at(surface.material, texcoords, color);
            sum.reflectance += here.reflectance;
            sum.emission += here.emission;
            sum.transmittance += here.transmittance;
        }
        let share = (step * step) as f32;
        let mean = Mean {
            reflectance: sum.reflectance * share,
            emission: sum.emission * share,
            transmittance: sum.transmittance * share,
        };
        self.surface(surface, mean)
    }

    fn surface(&self, surface: RadiantSurface, mean: Mean) -> RadiantSurface {
        let dark = surface.back && !self.material(surface.material).double_sided;
        let Mean { reflectance, emission, transmittance } = mean;
        let emission = if dark { LinearRgb::BLACK } else { emission };
        RadiantSurface { reflectance, emission, transmittance, ..surface }
    }

    /// The material at one place.
    fn at(&self, material: u32, texcoords: [DVec2; 2], color: Vec4) -> Mean {
        let point = self.table.at(&Interaction {
            point: DVec3::ZERO,
            normal: DVec3::Z,
            shading_normal: DVec3::Z,
            to_viewer: DVec3::Z,
            entering: true,
            texcoords,
            tangent: DVec3::ZERO,
            handedness: 1.0,
            color,
            material: material as usize,
            object: 0,
            error: 0.0,
        });
        let there = point.coverage.clamp(0.0, 1.0);
        let passed = point.transmission.map(|t| t.clamp(0.0, 1.0)) * there;
        Mean {
            reflectance: matt(&point) * there,
            emission: own_light(&point) * there,
            transmittance: passed + LinearRgb::splat(1.0 - there),
        }
    }
}

/// The share of light that is scattered evenly.
fn matt(point: &MaterialPoint) -> LinearRgb {
    let below_mirror = |mirror: LinearRgb| {
        let share = if point.fresnel { DIELECTRIC_MIRROR } else { 1.0 };
        mirror.map(|m| (1.0 - m * share).max(0.0))
    };
    match &point.reflection {
        ReflectionPoint::Unlit(_) => LinearRgb::BLACK,
        ReflectionPoint::Phong(phong) => {
            let all = phong.diffuse + phong.specular + point.mirror + point.transmission;
            phong.diffuse * all.max_component().max(1.0).recip()
        }
        ReflectionPoint::MetallicRoughness { base_color, metallic, .. } => {
            let base = base_color.map(|c| c.clamp(0.0, 1.0)) * (1.0 - metallic.clamp(0.0, 1.0));
            let left = (base - point.transmission).map(|c| c.max(0.0));
            left * (1.0 - DIELECTRIC_MIRROR) * below_mirror(point.mirror)
        }
    }
}

fn own_light(point: &MaterialPoint) -> LinearRgb {
    match point.reflection {
        ReflectionPoint::Unlit(color) => color,
        _ => point.emission,
    }
}

/// Weights of 3 or 4 corners at a place that is spread evenly over the polygon.
fn weights(corners: usize, u: f64, v: f64) -> [f64; 4] {
    if corners == 3 {
        let s = u.sqrt();
        return [1.0 - s, s * (1.0 - v), s * v, 0.0];
    }
    [(1.0 - u) * (1.0 - v), u * (1.0 - v), u * v, (1.0 - u) * v]
}

fn attributes(mesh: &Mesh, corners: &[u32], weights: [f64; 4]) -> ([DVec2; 2], Vec4) {
    let all = || corners.iter().zip(weights);
    let texcoords = [&mesh.vertices.texcoord0, &mesh.vertices.texcoord1].map(|set| {
        let at = |corner: u32| set.get(corner as usize).map_or(DVec2::ZERO, |t| t.as_dvec2());
        all().map(|(&corner, weight)| at(corner) * weight).sum()
    });
    let color = |corner: u32| mesh.vertices.color.get(corner as usize).copied().unwrap_or(Vec4::ONE);
    let mixed = all().map(|(&corner, weight)| color(corner) * weight as f32).sum();
    // Without colours rounding must not make one up.
    (texcoords, if mesh.vertices.color.is_empty() { Vec4::ONE } else { mixed })
}
