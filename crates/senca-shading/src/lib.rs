//! Reflection models, lights and fog.
//!
//! Two models answer light: the one of the books ([`phong()`], course text, section 2.5; 1991 thesis,
//! section 6) and glTF 2.0's metallic-roughness ([`metallic_roughness()`], appendix B). Both are fed
//! by a [`LightRig`], the lights of a scene resolved to world space, and both give the light that
//! leaves a point towards the observer. Nothing here casts shadows.
//!
//! # Units
//!
//! Light intensities are those of the books: a light of intensity 1 makes a white matt surface that
//! faces it show 1. Metallic-roughness follows: its BRDF is multiplied by pi, so that the same lamp
//! gives the same picture of a matt surface in both models. A reader of photometric lights divides
//! illuminances by pi on the way in.
//!
//! # Spaces
//!
//! Everything is in world space, where angles and lengths are not distorted.

mod attenuation;
mod fog;
mod light;
mod metallic_roughness;
mod normal_map;
mod phong;
mod rig;
mod spot;

pub use attenuation::{distance_attenuation, inverse_square, polynomial_attenuation};
pub use fog::{apply_fog, fog_share};
pub use light::{AREA_SAMPLES_PER_SIDE, Incident, Lamp, ShadingLight};
pub use metallic_roughness::{
    MetallicRoughnessConstants, environment_shares, fresnel_schlick, ggx_distribution, grazing_viewer,
    metallic_roughness, metallic_roughness_brdf, smith_visibility, uniform_environment,
};
pub use normal_map::{face_towards, perturb_normal, tangent_frame, with_occlusion};
pub use phong::{
    PhongConstants, cos_incidence, cos_reflection, phong, phong_term, reflected, thesis_linear_attenuation,
    thesis_physical_attenuation,
};
pub use rig::{AmbientLight, LightRig, ShadingPoint};
pub use spot::{box_light_contains, box_light_frame, cone_cosine, cone_sharp, cone_smooth, spot_share};
