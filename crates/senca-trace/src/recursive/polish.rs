//! Mirror rays of smooth surfaces of glTF's material.

use senca_math::glam::Vec3;
use senca_shading::{MetallicRoughnessConstants, environment_shares};

use super::{LightModel, Tracer};
use crate::Interaction;
use crate::material::{MaterialPoint, ReflectionPoint};

/// Roughness up to which surfaces are taken for mirrors, and from which on no ray is sent.
const SMOOTH: [f32; 2] = [0.1, 0.3];

impl Tracer<'_> {
    /// The material of the surface that a ray meets, as [`crate::MaterialTable::at`] has it. Of a smooth
    /// one the light that it mirrors is looked for along the reflected ray: all of it up to a roughness of
    /// 0.1, and less up to 0.3, beyond which one ray no longer stands for the lobe. What is left of it is
    /// taken from the ambient light.
    #[inline]
    pub(super) fn material_at(&self, at: &Interaction) -> MaterialPoint {
        let mut material = self.materials.at(at);
        if self.settings.light_model == LightModel::Material {
            polish(&mut material, at.to_viewer.as_vec3());
        }
        material
    }
}

/// Moves what a smooth surface mirrors into k_r, unless the material has coefficients of its own.
fn polish(material: &mut MaterialPoint, to_viewer: Vec3) {
    let ReflectionPoint::MetallicRoughness { base_color, metallic, roughness } = material.reflection else {
        return;
    };
    let [all, none] = SMOOTH;
    let sharpness = ((none - roughness) / (none - all)).clamp(0.0, 1.0);
    if sharpness <= 0.0 || material.transmits() || material.mirror.max_component() > 0.0 {
        return;
    }
    let constants = MetallicRoughnessConstants::new(base_color, metallic, roughness);
    let n_v = material.normal.dot(to_viewer).max(1e-3);
    let [_, mirrored] = environment_shares(&constants, n_v);
    material.mirror = (mirrored * sharpness).map(|k| k.clamp(0.0, 1.0));
    material.fresnel = false;
    material.sharpness = sharpness;
}

#[cfg(test)]
mod tests {
    use super::*;
    use senca_math::LinearRgb;
    use senca_scene::{Material, MetallicRoughness, Reflection, Scene};

    fn polished(roughness: f32, mirror: LinearRgb) -> MaterialPoint {
        let gold = LinearRgb::new(1.0, 0.8, 0.3);
        let reflection =
            MetallicRoughness { base_color: gold, metallic: 1.0, roughness, ..Default::default() };
        let reflection = Reflection::MetallicRoughness(reflection);
        let materials = vec![Material { reflection, mirror, ..Material::default() }];
        let scene = Scene { materials, ..Scene::default() };
        let at = crate::test_support::interaction_facing_z();
        let mut point = crate::MaterialTable::new(&scene).at(&at);
        polish(&mut point, at.to_viewer.as_vec3());
        point
    }

    #[test]
    fn smooth_metal_is_a_mirror_of_its_colour_and_rough_metal_is_none() {
        let smooth = polished(0.0, LinearRgb::BLACK);
        assert!((smooth.mirror.r - 1.0).abs() < 0.02 && (smooth.mirror.b - 0.3).abs() < 0.03, "{smooth:?}");
        assert_eq!(smooth.sharpness, 1.0);
        let half = polished(0.2, LinearRgb::BLACK);
        assert!((half.sharpness - 0.5).abs() < 1e-6 && half.mirror.r < 0.55, "{half:?}");
        assert_eq!(polished(0.3, LinearRgb::BLACK).mirror, LinearRgb::BLACK);
        let own = polished(0.0, LinearRgb::splat(0.25));
        assert_eq!((own.mirror, own.sharpness), (LinearRgb::splat(0.25), 0.0), "its own coefficient counts");
    }
}
