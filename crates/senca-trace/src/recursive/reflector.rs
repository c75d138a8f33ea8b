//! How a surface sends the light of a lamp to the viewer.

use std::f32::consts::PI;

use senca_math::LinearRgb;
use senca_math::glam::Vec3;
use senca_shading::{
    AmbientLight, Incident, MetallicRoughnessConstants, PhongConstants, cos_reflection, environment_shares,
    grazing_viewer, metallic_roughness_brdf, phong_term,
};

use super::LightModel;
use crate::material::{MaterialPoint, ReflectionPoint};

/// The reflection model at a place, ready for many lights.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reflector {
    model: Model,
    normal: Vec3,
    to_viewer: Vec3,
    /// See [`MaterialPoint::sharpness`].
    sharpness: f32,
}

#[derive(Clone, Copy, Debug)]
enum Model {
    Phong(PhongConstants),
    MetallicRoughness(MetallicRoughnessConstants),
    /// Shows a colour whatever the light.
    Unlit(LinearRgb),
}

impl Reflector {
    /// At a place with this material, seen from `to_viewer` (unit).
    #[inline]
    pub(crate) fn new(material: &MaterialPoint, to_viewer: Vec3, light_model: LightModel) -> Self {
        let (normal, sharpness) = (material.normal, material.sharpness);
        match (material.reflection, light_model) {
            (ReflectionPoint::Phong(constants), _) => {
                Self { model: Model::Phong(constants), normal, to_viewer, sharpness }
            }
            (ReflectionPoint::Unlit(color), _) => {
                Self { model: Model::Unlit(color), normal, to_viewer, sharpness }
            }
            (ReflectionPoint::MetallicRoughness { base_color, metallic, roughness }, LightModel::Phong) => {
                let constants = PhongConstants::of_metallic_roughness(base_color, metallic, roughness);
                Self { model: Model::Phong(constants), normal, to_viewer, sharpness }
            }
            (ReflectionPoint::MetallicRoughness { base_color, metallic, roughness }, _) => {
                let mut constants = MetallicRoughnessConstants::new(base_color, metallic, roughness);
                // What goes through is not scattered back (KHR_materials_transmission).
                constants.diffuse = constants.diffuse * material.transmission.map(|k| (1.0 - k).max(0.0));
                let to_viewer = grazing_viewer(normal, to_viewer);
                Self { model: Model::MetallicRoughness(constants), normal, to_viewer, sharpness }
            }
        }
    }

    /// Light that leaves without any lamp: ambient light reflected, or the colour of an unlit surface.
    #[inline]
    pub(crate) fn ambient(&self, ambient: &AmbientLight, occlusion: f32) -> LinearRgb {
        match &self.model {
            Model::Unlit(color) => *color,
            Model::Phong(constants) => ambient.towards(self.normal) * constants.ambient * occlusion,
            Model::MetallicRoughness(_) if ambient.is_none() => LinearRgb::BLACK,
            Model::MetallicRoughness(constants) => {
                let n_v = self.normal.dot(self.to_viewer).max(1e-3);
                let [matt, mirror] = environment_shares(constants, n_v);
                let mirrored = 2.0 * n_v * self.normal - self.to_viewer;
                let arriving = ambient.towards(mirrored) * (1.0 - self.sharpness);
                (ambient.towards(self.normal) * matt + arriving * mirror) * occlusion
            }
        }
    }

    /// The part that is reflected of light that comes from everywhere and is known well: what hides it
    /// is accounted for.
    #[inline]
    pub(crate) fn of_known(&self, arriving: LinearRgb) -> LinearRgb {
        match &self.model {
            Model::Phong(constants) => arriving * constants.diffuse,
            Model::Unlit(_) | Model::MetallicRoughness(_) => self.ambient(&arriving.into(), 1.0),
        }
    }

    /// Whether lamps make a difference.
    #[inline]
    pub(crate) fn is_lit(&self) -> bool {
        !matches!(self.model, Model::Unlit(_))
    }

    /// `Od cos(phi) + Os cos^n(alpha)` or its like, times the light.
    #[inline]
    pub(crate) fn reflected(&self, incident: &Incident) -> LinearRgb {
        let cos_phi = self.normal.dot(incident.to_light);
        if cos_phi <= 0.0 {
            return LinearRgb::BLACK;
        }
        match &self.model {
            Model::Phong(constants) => {
                let shiny = constants.specular != LinearRgb::BLACK;
                let cos_alpha =
                    if shiny { cos_reflection(self.normal, incident.to_light, self.to_viewer) } else { 0.0 };
                incident.intensity * phong_term(constants, cos_phi, cos_alpha)
            }
            Model::MetallicRoughness(constants) => {
                let brdf = metallic_roughness_brdf(constants, self.normal, incident.to_light, self.to_viewer);
                incident.intensity * brdf * (PI * cos_phi)
            }
            Model::Unlit(_) => LinearRgb::BLACK,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use senca_scene::{Material, MetallicRoughness, Phong, Reflection as SceneReflection};
    use senca_shading::{LightRig, ShadingPoint, metallic_roughness, phong};

    /// The material of a scene with nothing else, at a place with this normal.
    fn point(reflection: SceneReflection, normal: Vec3) -> MaterialPoint {
        let material = Material { reflection, ..Material::default() };
        let scene = senca_scene::Scene { materials: vec![material], ..Default::default() };
        let at = crate::Interaction {
            shading_normal: normal.as_dvec3(),
            ..crate::test_support::interaction_facing_z()
        };
        crate::MaterialTable::new(&scene).at(&at)
    }

    fn rig() -> LightRig {
        let light = senca_scene::Light {
            name: String::new(),
            color: LinearRgb::new(1.0, 2.0, 3.0),
            attenuation: senca_scene::Attenuation::InverseSquare { range: None },
            kind: senca_scene::LightKind::Point,
        };
        let mut rig = LightRig { ambient: LinearRgb::splat(0.1).into(), lights: Vec::new() };
        for place in [[3.0, 1.0, 2.0], [-1.0, 0.0, 0.5], [0.0, 0.0, -4.0]] {
            let placed = senca_math::glam::DMat4::from_translation(place.into());
            senca_shading::ShadingLight::resolve(&light, &placed, |l| rig.lights.push(l));
        }
        rig
    }

    /// The light that leaves, lamp by lamp.
    fn summed(reflector: &Reflector, rig: &LightRig, position: Vec3) -> LinearRgb {
        let mut sum = reflector.ambient(&rig.ambient, 0.5);
        rig.for_each_incident(position, |incident| sum += reflector.reflected(&incident));
        sum
    }

    #[test]
    fn lamp_by_lamp_is_what_the_models_say_of_all_lamps() {
        let (position, to_viewer, rig) = (Vec3::ZERO, Vec3::new(0.6, 0.0, 0.8), rig());
        for normal in [Vec3::Z, Vec3::new(-0.8, 0.0, 0.6), Vec3::new(-0.96, 0.0, 0.28)] {
            let at = ShadingPoint { position, normal, to_viewer };
            let p = Phong { specular: LinearRgb::splat(0.6), ..Phong::default() };
            let material = point(SceneReflection::Phong(p.clone()), normal);
            let reflector = Reflector::new(&material, to_viewer, LightModel::Material);
            assert_eq!(summed(&reflector, &rig, position), phong(&rig, &at, &PhongConstants::new(&p), 0.5));

            let m = MetallicRoughness { roughness: 0.4, metallic: 0.5, ..MetallicRoughness::default() };
            let material = point(SceneReflection::MetallicRoughness(m.clone()), normal);
            let reflector = Reflector::new(&material, to_viewer, LightModel::Material);
            let constants = MetallicRoughnessConstants::new(m.base_color, m.metallic, m.roughness);
            let expected = metallic_roughness(&rig, &at, &constants, 0.5);
            let found = summed(&reflector, &rig, position);
            assert!((found - expected).map(f32::abs).max_component() < 1e-5, "{found:?} {expected:?}");
        }
    }

    #[test]
    fn worked_values_of_the_books_parameters() {
        let splat = LinearRgb::splat;
        let p = Phong {
            ambient: splat(0.4),
            diffuse: splat(0.4),
            specular: splat(0.6),
            exponent: 5.0,
            ..Phong::default()
        };
        let material = point(SceneReflection::Phong(p), Vec3::Z);
        let value = |to_viewer: Vec3, to_light: Vec3, lit: f32| {
            let reflector = Reflector::new(&material, to_viewer, LightModel::Phong);
            let incident = Incident { to_light, intensity: LinearRgb::WHITE };
            (reflector.ambient(&splat(0.1).into(), 1.0) + reflector.reflected(&incident) * lit).r
        };
        let slanted = |degrees: f32| Vec3::new(degrees.to_radians().sin(), 0.0, degrees.to_radians().cos());
        assert!((value(Vec3::Z, Vec3::Z, 1.0) - 1.04).abs() < 1e-6);
        assert!((value(Vec3::Z, Vec3::Z, 0.0) - 0.04).abs() < 1e-7);
        assert!((value(slanted(-60.0), slanted(60.0), 1.0) - 0.84).abs() < 1e-5);
        assert!((value(Vec3::Z, slanted(60.0), 1.0) - 0.25875).abs() < 1e-5);
        assert_eq!(senca_shading::polynomial_attenuation([0.0, 0.5, 0.0], 4.0), 0.5);
    }
}
