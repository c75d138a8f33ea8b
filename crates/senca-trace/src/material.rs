//! What surfaces are made of, evaluated where a ray meets them.
//!
//! A [`MaterialTable`] is made once a picture; [`MaterialTable::at`] gives the coefficients at a place
//! with textures, normal map and the colour of the vertices worked in. Both tracers ask it, and the
//! rasterizing pipeline shades with the same numbers.

use senca_math::LinearRgb;
use senca_math::glam::{DVec2, Vec3, Vec4};
use senca_scene::{AlphaMode, ColorSpace, Filter, Material, Reflection, Scene, TextureRef};
use senca_shading::{PhongConstants, perturb_normal, with_occlusion};

use crate::Interaction;
use crate::texture::{BoundTexture, Decoding};

/// How a place on a surface answers light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaterialPoint {
    /// The reflection model with its coefficients here.
    pub reflection: ReflectionPoint,
    /// Unit normal to shade with, after the normal map, on the side that the ray comes from.
    pub normal: Vec3,
    /// Light given off.
    pub emission: LinearRgb,
    /// Share of the surface that is there, in [0, 1]: 1 for opaque materials, 0 or 1 for masks, alpha
    /// for blended ones. A ray sees the rest of what lies behind, unbent.
    pub coverage: f32,
    /// Share of ambient light that reaches the place, in [0, 1].
    pub occlusion: f32,
    /// k_r, per channel in [0, 1].
    pub mirror: LinearRgb,
    /// Share of the mirrored part of glTF's model that k_r has taken over, in [0, 1]; 0 but where the
    /// recursive tracer sends reflected rays from smooth surfaces.
    pub sharpness: f32,
    /// k_t, per channel in [0, 1].
    pub transmission: LinearRgb,
    /// Index of refraction of the inside, > 0.
    pub ior: f32,
    /// Light lost inside, per world unit and channel: after a way d, `exp(-absorption d)` is left.
    pub absorption: LinearRgb,
    /// Whether k_r and k_t are weighted by Fresnel's law.
    pub fresnel: bool,
    /// Whether the back is seen too.
    pub double_sided: bool,
}

/// The reflection models at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ReflectionPoint {
    /// The model of the books.
    Phong(PhongConstants),
    /// glTF's.
    MetallicRoughness {
        /// Colour of the matt part, or of the mirror of a metal.
        base_color: LinearRgb,
        /// 0 dielectric to 1 metal.
        metallic: f32,
        /// Perceptual roughness in [0, 1].
        roughness: f32,
    },
    /// Light is ignored and this colour shown as it is.
    Unlit(LinearRgb),
}

impl MaterialPoint {
    /// Whether the ray goes on through the body.
    #[must_use]
    pub fn transmits(&self) -> bool {
        self.transmission != LinearRgb::BLACK
    }
}

/// The materials of a scene, ready for many rays; the scene's count is the number of the default
/// material. That has two sides: nothing is known of a body that has no material, and many models of
/// the kind are open.
#[derive(Debug)]
pub struct MaterialTable<'s> {
    entries: Vec<Entry<'s>>,
}

#[derive(Debug)]
struct Entry<'s> {
    /// The point where nothing varies; its coverage is alpha.
    constant: MaterialPoint,
    alpha_mode: AlphaMode,
    /// Whether anything varies over the surface but the normal and the vertex colour.
    textured: bool,
    base: Option<BoundTexture<'s>>,
    /// Specular coefficient, or metallic and roughness.
    second: Option<BoundTexture<'s>>,
    emission: Option<BoundTexture<'s>>,
    normal: Option<BoundTexture<'s>>,
    occlusion: Option<BoundTexture<'s>>,
}

impl<'s> MaterialTable<'s> {
    /// The materials of `scene`, with the filters of its textures.
    #[must_use]
    pub fn new(scene: &'s Scene) -> Self {
        Self::with_filter(scene, None)
    }

    /// The materials of `scene`; `filter` replaces that of every texture.
    #[must_use]
    pub fn with_filter(scene: &'s Scene, filter: Option<Filter>) -> Self {
        let binder = Binder { scene, filter, decoding: Decoding::default() };
        let default = Material { double_sided: true, ..Material::default() };
        Self { entries: scene.materials.iter().chain([&default]).map(|m| binder.entry(m)).collect() }
    }

    /// The material of the surface that a ray meets, where it meets it.
    #[must_use]
    pub fn at(&self, at: &Interaction) -> MaterialPoint {
        let entry = self.entry(at.material);
        let mut point = entry.constant;
        point.normal = seen_normal(at);
        if entry.textured {
            entry.work_in(at, &mut point);
        }
        if at.color != Vec4::ONE {
            multiply_base(&mut point.reflection, at.color);
            point.coverage *= at.color.w;
        }
        point.coverage = coverage(entry.alpha_mode, point.coverage);
        point
    }

    /// Whether the material lets light through its body anywhere: such bodies cast no shadow unless
    /// asked to.
    #[must_use]
    pub fn is_transparent(&self, material: usize) -> bool {
        self.entry(material).constant.transmits()
    }

    /// Whether rays that meet the surface may see through it where it is: masks and blended surfaces.
    #[must_use]
    pub fn has_holes(&self, material: usize) -> bool {
        self.entry(material).alpha_mode != AlphaMode::Opaque
    }

    /// Whether the back of the material is seen too.
    #[must_use]
    pub fn is_double_sided(&self, material: usize) -> bool {
        self.entry(material).constant.double_sided
    }

    /// Light that the material gives off, before its texture.
    #[must_use]
    pub fn emission(&self, material: usize) -> LinearRgb {
        self.entry(material).constant.emission
    }

    /// What alpha means for the material.
    pub(crate) fn alpha_mode(&self, material: usize) -> AlphaMode {
        self.entry(material).alpha_mode
    }

    /// The material where nothing varies.
    pub(crate) fn constant(&self, material: usize) -> &MaterialPoint {
        &self.entry(material).constant
    }

    /// How many there are, the default one included.
    pub(crate) fn len(&self) -> usize {
        self.entries.len()
    }

    /// The texel that multiplies the base colour where coordinates of set 0 are `texcoord`.
    #[inline]
    pub(crate) fn base_texel(&self, material: usize, texcoord: DVec2) -> Option<[f32; 4]> {
        let texture = self.entry(material).base.as_ref()?;
        Some(texture.sample(&[texcoord, DVec2::ZERO]))
    }

    /// The texture that multiplies the base colour.
    pub(crate) fn base_texture(&self, material: usize) -> Option<&BoundTexture<'s>> {
        self.entry(material).base.as_ref()
    }

    /// The material where it is the same everywhere, but for a picture that multiplies its base colour;
    /// `None` where it is not, and where light passes.
    pub(crate) fn simple(&self, material: usize) -> Option<(&MaterialPoint, Option<&BoundTexture<'s>>)> {
        let entry = self.entry(material);
        let varies = [&entry.second, &entry.emission, &entry.normal, &entry.occlusion];
        let simple = varies.iter().all(|texture| texture.is_none())
            && entry.alpha_mode == AlphaMode::Opaque
            && !entry.constant.transmits();
        simple.then_some((&entry.constant, entry.base.as_ref()))
    }

    /// Whether the light that the material gives off differs from place to place: by a texture, or
    /// because the surface is not there everywhere.
    #[must_use]
    pub fn emission_varies(&self, material: usize) -> bool {
        let entry = self.entry(material);
        entry.emission.is_some() || entry.alpha_mode != AlphaMode::Opaque
    }

    fn entry(&self, material: usize) -> &Entry<'s> {
        &self.entries[material.min(self.entries.len() - 1)]
    }
}

/// The shading normal on the side that the ray comes from. The surface itself decides which side that
/// is: an interpolated normal may lean over the rim.
pub(crate) fn seen_normal(at: &Interaction) -> Vec3 {
    let normal = at.shading_normal.as_vec3();
    if at.entering { normal } else { -normal }
}

/// Share of the surface that is there.
fn coverage(mode: AlphaMode, alpha: f32) -> f32 {
    match mode {
        AlphaMode::Opaque => 1.0,
        AlphaMode::Mask { cutoff } if alpha >= cutoff => 1.0,
        AlphaMode::Mask { .. } => 0.0,
        AlphaMode::Blend => alpha.clamp(0.0, 1.0),
    }
}

/// Multiplies what a picture of the base colour multiplies.
fn multiply_base(reflection: &mut ReflectionPoint, color: Vec4) {
    let color = LinearRgb::new(color.x, color.y, color.z);
    match reflection {
        ReflectionPoint::Phong(constants) => {
            constants.ambient = constants.ambient * color;
            constants.diffuse = constants.diffuse * color;
        }
        ReflectionPoint::MetallicRoughness { base_color, .. } | ReflectionPoint::Unlit(base_color) => {
            *base_color = *base_color * color;
        }
    }
}

impl Entry<'_> {
    /// Multiplies the textures in.
    fn work_in(&self, at: &Interaction, point: &mut MaterialPoint) {
        if let Some(texture) = &self.base {
            let texel = Vec4::from(texture.sample(&at.texcoords));
            multiply_base(&mut point.reflection, texel);
            point.coverage *= texel.w;
        }
        if let Some(texture) = &self.second {
            let [r, g, b, _] = texture.sample(&at.texcoords);
            match &mut point.reflection {
                ReflectionPoint::Phong(constants) => {
                    constants.specular = constants.specular * LinearRgb::new(r, g, b);
                }
                ReflectionPoint::MetallicRoughness { metallic, roughness, .. } => {
                    *metallic *= b;
                    *roughness *= g;
                }
                ReflectionPoint::Unlit(_) => {}
            }
        }
        if let Some(texture) = &self.emission {
            let [r, g, b, _] = texture.sample(&at.texcoords);
            point.emission = point.emission * LinearRgb::new(r, g, b);
        }
        if let Some(map) = &self.normal {
            point.normal = mapped_normal(at, point.normal, map);
        }
        if let Some(map) = &self.occlusion {
            point.occlusion = with_occlusion(map.sample(&at.texcoords)[0], map.strength);
        }
    }
}

/// The normal after the normal map. Seen from behind the normal is turned over, and with it the
/// bitangent.
fn mapped_normal(at: &Interaction, normal: Vec3, map: &BoundTexture<'_>) -> Vec3 {
    let [x, y, z, _] = map.sample(&at.texcoords).map(|v| 2.0 * v - 1.0);
    let sign = if at.entering { at.handedness } else { -at.handedness };
    let tangent = at.tangent.as_vec3().extend(sign as f32);
    perturb_normal(normal, tangent, Vec3::new(x, y, z), map.strength)
}

struct Binder<'s> {
    scene: &'s Scene,
    filter: Option<Filter>,
    decoding: Decoding,
}

impl<'s> Binder<'s> {
    fn entry(&self, material: &Material) -> Entry<'s> {
        let (reflection, alpha) = reflection_of(material);
        let [base, second] = match &material.reflection {
            Reflection::Phong(p) => [
                self.bind(p.texture.as_ref(), ColorSpace::Srgb),
                self.bind(p.specular_texture.as_ref(), ColorSpace::Srgb),
            ],
            Reflection::MetallicRoughness(m) => [
                self.bind(m.base_color_texture.as_ref(), ColorSpace::Srgb),
                self.bind(m.metallic_roughness_texture.as_ref(), ColorSpace::Linear),
            ],
        };
        let emission = self.bind(material.emission_texture.as_ref(), ColorSpace::Srgb);
        let normal = self.bind(material.normal_texture.as_ref(), ColorSpace::Linear);
        let occlusion = self.bind(material.occlusion_texture.as_ref(), ColorSpace::Linear);
        let all = [&base, &second, &emission, &normal, &occlusion];
        let textured = all.iter().any(|texture| texture.is_some());
        let constant = constant_of(material, reflection, alpha);
        Entry {
            constant,
            // Where light goes through, transmission alone says how much: see `Material::tracer_alpha`.
            alpha_mode: if material.is_transmissive() { AlphaMode::Opaque } else { material.alpha_mode },
            textured,
            base,
            second,
            emission,
            normal,
            occlusion,
        }
    }

    fn bind(&self, used: Option<&TextureRef>, space: ColorSpace) -> Option<BoundTexture<'s>> {
        BoundTexture::new(self.scene, used?, space, self.filter, &self.decoding)
    }
}

/// The reflection with textures left aside, and alpha.
fn reflection_of(material: &Material) -> (ReflectionPoint, f32) {
    match &material.reflection {
        Reflection::Phong(p) if material.unlit => (ReflectionPoint::Unlit(p.diffuse), p.alpha),
        Reflection::Phong(p) => (ReflectionPoint::Phong(PhongConstants::new(p)), p.alpha),
        Reflection::MetallicRoughness(m) if material.unlit => (ReflectionPoint::Unlit(m.base_color), m.alpha),
        Reflection::MetallicRoughness(m) => {
            let (metallic, roughness) = (m.metallic, m.roughness);
            (ReflectionPoint::MetallicRoughness { base_color: m.base_color, metallic, roughness }, m.alpha)
        }
    }
}

fn constant_of(material: &Material, reflection: ReflectionPoint, alpha: f32) -> MaterialPoint {
    MaterialPoint {
        reflection,
        normal: Vec3::Z,
        emission: material.emission,
        coverage: alpha,
        occlusion: 1.0,
        mirror: material.mirror,
        sharpness: 0.0,
        transmission: material.transmission,
        ior: if material.ior > 0.0 { material.ior } else { 1.0 },
        absorption: material.absorption,
        fresnel: material.fresnel,
        double_sided: material.double_sided,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::interaction_facing_z;
    use senca_scene::{ImageData, ImageId, MetallicRoughness, Phong, Texture, TextureId, TextureImage, Wrap};

    fn place(material: usize) -> Interaction {
        Interaction { material, ..interaction_facing_z() }
    }

    /// A scene with one material and one texture of one texel.
    fn scene(material: Material, texel: [u8; 4]) -> Scene {
        let data = ImageData::Rgba8 { width: 1, height: 1, texels: vec![texel] };
        let texture = Texture {
            name: String::new(),
            image: ImageId(0),
            wrap_u: Wrap::Repeat,
            wrap_v: Wrap::Repeat,
            filter: Filter::Bilinear,
        };
        Scene {
            materials: vec![material],
            textures: vec![texture],
            images: vec![TextureImage { name: String::new(), data }],
            ..Scene::default()
        }
    }

    fn picture() -> Option<TextureRef> {
        Some(TextureRef::new(TextureId(0)))
    }

    #[test]
    fn vertex_colours_and_textures_multiply_ambient_diffuse_and_alpha() {
        let phong = Phong { specular: LinearRgb::WHITE, texture: picture(), alpha: 0.5, ..Phong::default() };
        let material = Material {
            reflection: Reflection::Phong(phong),
            alpha_mode: AlphaMode::Blend,
            ..Material::default()
        };
        let scene = scene(material, [255, 0, 255, 255]);
        let at = Interaction { color: Vec4::new(0.5, 1.0, 1.0, 0.5), ..place(0) };
        let point = MaterialTable::new(&scene).at(&at);
        let ReflectionPoint::Phong(constants) = point.reflection else { panic!("a Phong material") };
        assert_eq!(constants.diffuse, LinearRgb::new(0.4, 0.0, 0.8));
        assert_eq!(constants.ambient, constants.diffuse);
        assert_eq!(constants.specular, LinearRgb::WHITE);
        assert_eq!(point.coverage, 0.25);
    }

    #[test]
    fn roughness_is_green_and_metallic_blue() {
        let m = MetallicRoughness { metallic_roughness_texture: picture(), ..MetallicRoughness::default() };
        let material = Material { reflection: Reflection::MetallicRoughness(m), ..Material::default() };
        let scene = scene(material, [9, 51, 102, 255]);
        let point = MaterialTable::new(&scene).at(&place(0));
        let ReflectionPoint::MetallicRoughness { metallic, roughness, .. } = point.reflection else {
            panic!("a metallic-roughness material")
        };
        assert!((roughness - 0.2).abs() < 1e-6 && (metallic - 0.4).abs() < 1e-6);
    }

    #[test]
    fn masks_are_there_or_not_and_opaque_alpha_is_ignored() {
        let with = |alpha, alpha_mode| {
            let reflection = Reflection::Phong(Phong { alpha, ..Phong::default() });
            let scene = scene(Material { reflection, alpha_mode, ..Material::default() }, [0; 4]);
            MaterialTable::new(&scene).at(&place(0)).coverage
        };
        assert_eq!(with(0.4, AlphaMode::Mask { cutoff: 0.5 }), 0.0);
        assert_eq!(with(0.5, AlphaMode::Mask { cutoff: 0.5 }), 1.0);
        assert_eq!(with(0.1, AlphaMode::Opaque), 1.0);
        assert_eq!(with(7.0, AlphaMode::Blend), 1.0);
    }

    #[test]
    fn a_normal_map_leans_towards_its_tangent_on_both_sides() {
        let material = Material { normal_texture: picture(), ..Material::default() };
        let scene = scene(material, [255, 128, 128, 255]);
        let table = MaterialTable::new(&scene);
        let front = table.at(&place(0)).normal;
        assert!((front.x - 1.0).abs() < 0.01, "{front}");
        let back = table.at(&Interaction { entering: false, ..place(0) }).normal;
        assert!((back.x - 1.0).abs() < 0.01, "{back}");
    }

    #[test]
    fn the_default_material_has_two_sides() {
        let scene = Scene::default();
        let table = MaterialTable::new(&scene);
        assert!(table.is_double_sided(0) && table.at(&place(0)).double_sided);
        assert_eq!(table.at(&Interaction { entering: false, ..place(0) }).normal, Vec3::NEG_Z);
    }
}
