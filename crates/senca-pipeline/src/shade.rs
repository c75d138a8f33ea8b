//! The colour of a pixel from the triangle seen there.

use senca_math::glam::{DMat4, DVec3, Vec3, Vec4};
use senca_math::{LinearRgb, View, ViewKind};
use senca_scene::{AlphaMode, Fog};
use senca_shading::{
    LightRig, MetallicRoughnessConstants, PhongConstants, ShadingPoint, apply_fog, metallic_roughness,
    perturb_normal, phong, with_occlusion,
};

use crate::geometry::World;
use crate::gouraud::VertexColors;
use crate::material::{Bound, Model, Resolved, TexturePoint};
use crate::settings::{ColorInterpolation, Settings, Shading, TextureMethod};
use crate::surface::{PixelGrid, TriangleSetup, Weights};
use crate::transformed::coordinates_by_transformation;

/// Everything that colours of pixels are made from. Shared by all threads.
pub(crate) struct Shader<'w> {
    pub(crate) world: &'w World<'w>,
    pub(crate) materials: &'w [Resolved],
    pub(crate) rig: LightRig,
    pub(crate) fog: Option<Fog>,
    pub(crate) view: View,
    pub(crate) grid: PixelGrid,
    pub(crate) settings: Settings,
    /// Per placed mesh.
    pub(crate) clip_from_object: Vec<DMat4>,
    /// Per part, in Gouraud shading.
    pub(crate) vertex_colors: Vec<VertexColors>,
}

/// A place on a surface with what its textures say there.
struct Sampled {
    base: Vec4,
    point: ShadingPoint,
    occlusion: f32,
}

impl<'w> Shader<'w> {
    /// The triangle `id`, ready to be shaded.
    pub(crate) fn setup(&self, id: u32) -> TriangleSetup<'w> {
        TriangleSetup::new(self.world, id, &self.clip_from_object, &self.grid)
    }

    /// Colour and opacity at (x, y), pixels from the picture's upper left corner; `depth` is the
    /// window depth there.
    pub(crate) fn shade(&self, triangle: &TriangleSetup<'_>, x: f64, y: f64, depth: f32) -> [f32; 4] {
        let material = &self.materials[triangle.part.material];
        let weights = triangle.weights(x, y);
        let position = triangle.position(&weights);
        let texels = Texels { shader: self, triangle, x, y, depth };
        let (color, alpha) = match self.settings.shading {
            Shading::Gouraud => self.gouraud(triangle, material, &texels),
            _ => self.per_pixel(triangle, material, &weights, position, &texels),
        };
        let color = match &self.fog {
            Some(fog) => apply_fog(fog, color, self.distance(position)),
            None => color,
        };
        let alpha = if material.alpha_mode == AlphaMode::Blend { alpha.clamp(0.0, 1.0) } else { 1.0 };
        [color.r, color.g, color.b, alpha]
    }

    /// Colours of the vertices, interpolated, times the texture.
    fn gouraud(
        &self,
        triangle: &TriangleSetup<'_>,
        material: &Resolved,
        texels: &Texels<'_>,
    ) -> (LinearRgb, f32) {
        let weights = match self.settings.gouraud {
            ColorInterpolation::Screen => triangle.screen_weights(texels.x, texels.y),
            ColorInterpolation::Perspective => triangle.weights(texels.x, texels.y),
        };
        let colors = &self.vertex_colors[triangle.part_index];
        let [a, b, c] = triangle.corners.map(|c| colors.of(c));
        let light =
            Vec4::from(a) * weights.0[0] + Vec4::from(b) * weights.0[1] + Vec4::from(c) * weights.0[2];
        let color = light * Vec4::from(texels.read(material.base_texture()));
        (LinearRgb::new(color.x, color.y, color.z), color.w)
    }

    fn per_pixel(
        &self,
        triangle: &TriangleSetup<'_>,
        material: &Resolved,
        weights: &Weights,
        position: Vec3,
        texels: &Texels<'_>,
    ) -> (LinearRgb, f32) {
        let flat = self.settings.shading == Shading::Flat;
        let position = if flat { triangle.centroid() } else { position };
        let normal = if flat { triangle.plane_normal() } else { self.normal(triangle, weights, texels) };
        let base = Vec4::from(texels.read(material.base_texture())) * triangle.color(weights);
        let point = ShadingPoint { position, normal, to_viewer: self.to_viewer(position) };
        let occlusion = match &material.occlusion_texture {
            Some(map) => with_occlusion(texels.read(Some(map))[0], map.strength),
            None => 1.0,
        };
        let sampled = Sampled { base, point, occlusion };
        let alpha = material.alpha() * base.w;
        (self.lit(material, &sampled, texels) + emission(material, texels), alpha)
    }

    /// Light reflected by `material` at a sampled place.
    fn lit(&self, material: &Resolved, at: &Sampled, texels: &Texels<'_>) -> LinearRgb {
        let base = LinearRgb::new(at.base.x, at.base.y, at.base.z);
        match &material.model {
            Model::Phong { constants, specular_texture, .. } => {
                if material.unlit {
                    return constants.diffuse * base;
                }
                let shine = texels.read(specular_texture.as_ref());
                let constants = PhongConstants {
                    ambient: constants.ambient * base,
                    diffuse: constants.diffuse * base,
                    specular: constants.specular * LinearRgb::new(shine[0], shine[1], shine[2]),
                    exponent: constants.exponent,
                };
                phong(&self.rig, &at.point, &constants, at.occlusion)
            }
            Model::MetallicRoughness {
                base_color, metallic, roughness, metallic_roughness_texture, ..
            } => {
                let base = *base_color * base;
                if material.unlit {
                    return base;
                }
                let [_, g, b, _] = texels.read(metallic_roughness_texture.as_ref());
                let (metallic, roughness) = (metallic * b, roughness * g);
                if self.settings.shading == Shading::Material {
                    let constants = MetallicRoughnessConstants::new(base, metallic, roughness);
                    return metallic_roughness(&self.rig, &at.point, &constants, at.occlusion);
                }
                let constants = PhongConstants::of_metallic_roughness(base, metallic, roughness);
                phong(&self.rig, &at.point, &constants, at.occlusion)
            }
        }
    }

    /// The normal that `triangle` is lit with at (x, y), unless it is shaded flat: interpolated, and
    /// turned by the material's map.
    pub(crate) fn shading_normal(
        &self,
        triangle: &TriangleSetup<'_>,
        weights: &Weights,
        x: f64,
        y: f64,
        depth: f32,
    ) -> Vec3 {
        self.normal(triangle, weights, &Texels { shader: self, triangle, x, y, depth })
    }

    fn normal(&self, triangle: &TriangleSetup<'_>, weights: &Weights, texels: &Texels<'_>) -> Vec3 {
        match &self.materials[triangle.part.material].normal_texture {
            Some(map) => self.mapped_normal(triangle, weights, map, texels),
            None => triangle.normal(weights),
        }
    }

    fn mapped_normal(
        &self,
        triangle: &TriangleSetup<'_>,
        weights: &Weights,
        map: &Bound,
        texels: &Texels<'_>,
    ) -> Vec3 {
        let normal = triangle.normal(weights);
        let Some(tangent) = triangle.tangent(weights, map.texcoord) else { return normal };
        let [x, y, z, _] = texels.read(Some(map)).map(|v| 2.0 * v - 1.0);
        perturb_normal(normal, tangent, Vec3::new(x, y, z), map.strength)
    }

    /// Unit direction from a place of the world towards the observer.
    pub(crate) fn to_viewer(&self, position: Vec3) -> Vec3 {
        match self.view.kind {
            ViewKind::Central { eye_world } => (eye_world.as_vec3() - position).normalize_or_zero(),
            ViewKind::Parallel { direction_world } => -direction_world.as_vec3(),
        }
    }

    /// Distance from the observer: to the eye, in a parallel view to the plane through its centre.
    pub(crate) fn distance(&self, position: Vec3) -> f32 {
        match self.view.kind {
            ViewKind::Central { eye_world } => eye_world.as_vec3().distance(position),
            ViewKind::Parallel { .. } => {
                -self.view.view_from_world.transform_point3(position.as_dvec3()).z as f32
            }
        }
    }

    /// Light that a vertex of `material` sends to the observer, textures left aside, with opacity.
    pub(crate) fn vertex_light(&self, material: &Resolved, point: ShadingPoint, color: Vec4) -> [f32; 4] {
        let sampled = Sampled { base: color, point, occlusion: 1.0 };
        let base = LinearRgb::new(color.x, color.y, color.z);
        let light = match &material.model {
            Model::Phong { constants, .. } if material.unlit => constants.diffuse * base,
            Model::MetallicRoughness { base_color, .. } if material.unlit => *base_color * base,
            Model::Phong { constants, .. } => {
                let constants = PhongConstants {
                    ambient: constants.ambient * base,
                    diffuse: constants.diffuse * base,
                    ..*constants
                };
                phong(&self.rig, &sampled.point, &constants, 1.0)
            }
            Model::MetallicRoughness { base_color, metallic, roughness, .. } => {
                let constants =
                    PhongConstants::of_metallic_roughness(*base_color * base, *metallic, *roughness);
                phong(&self.rig, &sampled.point, &constants, 1.0)
            }
        } + material.emission;
        [light.r, light.g, light.b, material.alpha() * color.w]
    }

    /// Whether `triangle`'s surface is there at all at (x, y): false where a mask cuts it away.
    pub(crate) fn passes_mask(&self, triangle: &TriangleSetup<'_>, x: f64, y: f64, depth: f32) -> bool {
        let material = &self.materials[triangle.part.material];
        let AlphaMode::Mask { cutoff } = material.alpha_mode else { return true };
        let texels = Texels { shader: self, triangle, x, y, depth };
        let weights = triangle.weights(x, y);
        let texel = texels.read(material.base_texture())[3];
        material.alpha() * triangle.color(&weights).w * texel >= cutoff
    }
}

fn emission(material: &Resolved, texels: &Texels<'_>) -> LinearRgb {
    if material.emission == LinearRgb::BLACK {
        return LinearRgb::BLACK;
    }
    let [r, g, b, _] = texels.read(material.emission_texture.as_ref());
    material.emission * LinearRgb::new(r, g, b)
}

/// Reads textures at one pixel of one triangle.
struct Texels<'a> {
    shader: &'a Shader<'a>,
    triangle: &'a TriangleSetup<'a>,
    x: f64,
    y: f64,
    depth: f32,
}

impl Texels<'_> {
    /// The texel here, white without a texture.
    fn read(&self, bound: Option<&Bound>) -> [f32; 4] {
        match bound {
            Some(bound) => bound.sample(&self.point(bound.texcoord)),
            None => [1.0; 4],
        }
    }

    fn point(&self, set: u32) -> TexturePoint {
        match self.shader.settings.texture_method {
            TextureMethod::Interpolated => self.triangle.texture_point(self.x, self.y, set),
            TextureMethod::Transformed => {
                coordinates_by_transformation(self.shader, self.triangle, [self.x, self.y], self.depth, set)
            }
        }
    }
}

/// Place in the world that is seen at a pixel of `grid` at a window depth: the inverse of the device
/// map and of the view.
/// Source: course text, section 1.9.
pub(crate) fn world_of_pixel(view: &View, grid: &PixelGrid, [x, y]: [f64; 2], depth: f64) -> DVec3 {
    let normalized = grid.normalized(x, y);
    view.world_from_clip.project_point3(DVec3::new(normalized.x, normalized.y, depth))
}
