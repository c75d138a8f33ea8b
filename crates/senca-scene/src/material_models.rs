//! Phong coefficients from metallic-roughness, and back.
//!
//! The two models do not cover each other; what carries over is the size of the highlight, its peak,
//! the diffuse colour, and whether a thing is metal.
//!
//! - *Highlight.* A GGX lobe with alpha = roughness^2 has about the width of a Blinn-Phong lobe with
//!   exponent `2 / alpha^2 - 2` (Walter et al. 2007), and that of a Phong lobe, which measures angles
//!   from the mirrored ray, with a quarter of it. So `n = (1 / roughness^4 - 1) / 2`.
//! - *Peak.* Seen in the mirrored direction the GGX lobe reaches `F0 / (4 alpha^2)` times the light,
//!   the Phong lobe Os; so `Os = F0 (2 n + 1) / 4`, at most 1.
//! - *Metal.* Without surroundings to mirror, a metal in the Phong model would be black outside its
//!   highlight; it keeps 2/5 of its colour as diffuse. The way back takes for metal what has a
//!   highlight of its own hue that outshines the diffuse colour as much (up to a roughness of 0.7; rougher
//!   metal reads as matt).

use senca_math::LinearRgb;

use crate::{Material, MetallicRoughness, Phong, Reflection};

/// Reflectance of common dielectrics at right angles (glTF 2.0, section 3.9).
const DIELECTRIC_F0: f32 = 0.04;

/// Share of a metal's colour that is kept as diffuse.
const METAL_DIFFUSE: f32 = 0.4;

/// Highest exponent that is made; a mirror has none.
const MAX_EXPONENT: f32 = 10_000.0;

/// Phong exponent whose highlight is as wide as that of a perceptual roughness.
fn exponent_of(roughness: f32) -> f32 {
    let r4 = roughness.clamp(0.0, 1.0).powi(4);
    (0.5 * (1.0 / r4 - 1.0)).min(MAX_EXPONENT)
}

/// Perceptual roughness whose highlight is as wide as that of a Phong exponent.
fn roughness_of(exponent: f32) -> f32 {
    (2.0 * exponent.max(0.0) + 1.0).recip().sqrt().sqrt()
}

/// `color` made darker, if need be, so that no component exceeds 1.
fn within_one(color: LinearRgb) -> LinearRgb {
    color * (1.0 / color.max_component().max(1.0))
}

/// Colour scaled to a largest component of 1; white for black.
fn hue(color: LinearRgb) -> LinearRgb {
    let most = color.max_component();
    if most > 0.0 { color * (1.0 / most) } else { LinearRgb::WHITE }
}

impl Material {
    /// The reflection as Phong coefficients; as it is where the material has them. The map for
    /// metallic and roughness is not used: the factors count as if it were white.
    #[must_use]
    pub fn to_phong(&self) -> Phong {
        match &self.reflection {
            Reflection::Phong(phong) => phong.clone(),
            Reflection::MetallicRoughness(m) => phong_of(m),
        }
    }

    /// The reflection as metallic-roughness; as it is where the material has it. Pictures for the
    /// specular coefficient are not used.
    #[must_use]
    pub fn to_metallic_roughness(&self) -> MetallicRoughness {
        match &self.reflection {
            Reflection::Phong(phong) => metallic_roughness_of(phong),
            Reflection::MetallicRoughness(m) => m.clone(),
        }
    }
}

fn phong_of(m: &MetallicRoughness) -> Phong {
    let metallic = m.metallic.clamp(0.0, 1.0);
    let exponent = exponent_of(m.roughness);
    let f0 = LinearRgb::splat(DIELECTRIC_F0).lerp(m.base_color, metallic);
    let diffuse = m.base_color * (1.0 - (1.0 - METAL_DIFFUSE) * metallic);
    Phong {
        ambient: diffuse,
        diffuse,
        specular: within_one(f0 * (0.25 * (2.0 * exponent + 1.0))),
        exponent,
        alpha: m.alpha,
        texture: m.base_color_texture,
        specular_texture: None,
    }
}

/// Whether a Phong material looks like metal: see the module's text.
fn is_metal(phong: &Phong) -> bool {
    let (diffuse, specular) = (phong.diffuse.max_component(), phong.specular.max_component());
    let difference = hue(phong.diffuse) + hue(phong.specular) * -1.0;
    let same_hue = difference.map(f32::abs).max_component() < 0.2 || diffuse < 0.02;
    let dielectric = (DIELECTRIC_F0 * 0.25 * (2.0 * phong.exponent + 1.0)).min(1.0);
    let outshone = diffuse < 0.6 * specular;
    // Highlights of dielectrics are white; a coloured one is metal at any strength.
    let colored = hue(phong.specular).map(|c| 1.0 - c).max_component() > 0.1;
    same_hue && outshone && specular > 0.1 && (colored || specular > 1.2 * dielectric || diffuse < 0.1)
}

fn metallic_roughness_of(phong: &Phong) -> MetallicRoughness {
    let metal = is_metal(phong);
    // A black metal, as chrome is often written, has its colour in the highlight alone.
    let base_color = match (metal, phong.diffuse.max_component() < 0.1 * phong.specular.max_component()) {
        (false, _) => phong.diffuse,
        (true, true) => phong.specular,
        (true, false) => phong.diffuse * (1.0 / METAL_DIFFUSE),
    };
    // Without a highlight there is nothing to be seen of the exponent.
    let shines = phong.specular.max_component() > 0.0;
    MetallicRoughness {
        base_color: base_color.map(|c| c.clamp(0.0, 1.0)),
        alpha: phong.alpha,
        metallic: if metal { 1.0 } else { 0.0 },
        roughness: if shines { roughness_of(phong.exponent) } else { 1.0 },
        base_color_texture: phong.texture,
        metallic_roughness_texture: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn material(reflection: Reflection) -> Material {
        Material { reflection, ..Material::default() }
    }

    fn there_and_back(m: &MetallicRoughness) -> MetallicRoughness {
        let phong = material(Reflection::MetallicRoughness(m.clone())).to_phong();
        material(Reflection::Phong(phong)).to_metallic_roughness()
    }

    proptest! {
        #[test]
        fn dielectrics_and_metals_survive_the_round_trip(
            r in 0.3f32..1.0, g in 0.3f32..1.0, b in 0.3f32..1.0, roughness in 0.15f32..0.7, metal in any::<bool>(),
        ) {
            let base_color = LinearRgb::new(r, g, b);
            let metallic = if metal { 1.0 } else { 0.0 };
            // The highlight of polished grey metal is cut at 1 as that of any polished thing.
            let m = MetallicRoughness { base_color, roughness, metallic, alpha: 0.5, ..MetallicRoughness::default() };
            prop_assume!(!metal || roughness > 0.34 || hue(base_color).map(|c| 1.0 - c).max_component() > 0.12);
            let back = there_and_back(&m);
            prop_assert_eq!((back.metallic, back.alpha), (metallic, 0.5));
            prop_assert!((back.roughness - roughness).abs() < 1e-3);
            let error = (back.base_color + base_color * -1.0).map(f32::abs).max_component();
            prop_assert!(error < 1e-3, "{:?} {:?}", back.base_color, base_color);
        }
    }

    #[test]
    fn exponent_and_roughness_are_inverse() {
        for n in [0.0, 1.0, 5.0, 20.0, 100.0, 1000.0] {
            assert!((exponent_of(roughness_of(n)) - n).abs() < 1e-3 * (1.0 + n));
        }
        assert_eq!((exponent_of(0.0), exponent_of(1.0)), (MAX_EXPONENT, 0.0));
    }

    #[test]
    fn usual_phong_materials_become_what_they_mean() {
        let of = |diffuse: [f32; 3], specular: [f32; 3], exponent: f32| {
            let (diffuse, specular) = (LinearRgb::from_array(diffuse), LinearRgb::from_array(specular));
            let phong = Phong { diffuse, specular, exponent, ..Phong::default() };
            material(Reflection::Phong(phong)).to_metallic_roughness()
        };
        let matt = of([0.8; 3], [0.0; 3], 20.0);
        assert_eq!((matt.metallic, matt.roughness), (0.0, 1.0));
        let plastic = of([0.8, 0.1, 0.1], [0.5; 3], 50.0);
        assert_eq!((plastic.metallic, plastic.base_color.r), (0.0, 0.8));
        let chrome = of([0.0; 3], [0.9; 3], 200.0);
        assert_eq!((chrome.metallic, chrome.base_color.g), (1.0, 0.9));
        let gold = of([0.3, 0.24, 0.1], [0.8, 0.62, 0.26], 50.0);
        assert_eq!(gold.metallic, 1.0);
    }

    #[test]
    fn polished_metal_has_a_highlight_of_its_colour() {
        let base_color = LinearRgb::new(1.0, 0.5, 0.2);
        let phong =
            phong_of(&MetallicRoughness { base_color, roughness: 0.2, ..MetallicRoughness::default() });
        assert!((phong.specular.g - 0.5).abs() < 1e-6 && (phong.specular.b - 0.2).abs() < 1e-6);
        assert!((phong.diffuse.g - 0.2).abs() < 1e-6);
        assert!(phong.exponent > 100.0);
    }
}
