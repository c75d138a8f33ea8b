//! Stage 8: filling, interpolation and the z-buffer.

use senca_math::conventions::{canonical_from_depth, depth_from_canonical};
use senca_math::glam::{DVec2, DVec3, Vec3, Vec4};
use senca_math::{DeviceMap, LinearRgb, View};
use senca_raster::{
    Buffers, ColorSource, Counters, FixedShading, FragmentShader, Fragments, Ids, Interpolation, LANES,
    Primitives, Rasterizer, Sampler, Shaded, Shading, State, Target, TexelGrid, Texture, Wrap,
};
use senca_scene::Fog;
use senca_shading::{LightRig, PhongConstants, ShadingPoint, apply_fog, phong};

use super::{TextureFrame, Triangle};

/// Fills `target` with the light of the vertices, interpolated in the picture.
/// Source: course text, section 2.9.
pub fn rasterize_gouraud(
    list: &[Triangle],
    rasterizer: &mut dyn Rasterizer,
    target: &mut Target<'_>,
) -> Counters {
    let varyings: Vec<f32> = list.iter().flat_map(|t| &t.vertices).flat_map(|v| v.light.to_array()).collect();
    let shading = Shading::Fixed(FixedShading::new(ColorSource::Rgb { first: 0 }));
    fill(list, &varyings, rasterizer, target, &shading)
}

/// Fills `target` with light computed at every pixel from the interpolated normal, in the scene, to
/// which the pixel is transformed back.
/// Source: course text, section 2.10.
pub fn rasterize_phong(
    list: &[Triangle],
    light: &PixelLight<'_>,
    rasterizer: &mut dyn Rasterizer,
    target: &mut Target<'_>,
) -> Counters {
    let varyings: Vec<f32> =
        list.iter().flat_map(|t| &t.vertices).flat_map(|v| v.normal.to_array()).collect();
    let shader = PhongFragments { list, light };
    fill(list, &varyings, rasterizer, target, &Shading::Custom(&shader))
}

/// A list in device coordinates with three values a vertex.
fn fill(
    list: &[Triangle],
    varyings: &[f32],
    rasterizer: &mut dyn Rasterizer,
    target: &mut Target<'_>,
    shading: &Shading<'_>,
) -> Counters {
    let (width, height) = (f64::from(target.width()), f64::from(target.height()));
    // The rasterizer starts from clip coordinates; undo its map to the whole target.
    let clip = |p: DVec3| {
        let (x, y) = (2.0 * p.x / width - 1.0, 1.0 - 2.0 * p.y / height);
        Vec4::new(x as f32, y as f32, depth_from_canonical(p.z).clamp(0.0, 1.0) as f32, 1.0)
    };
    let positions: Vec<Vec4> =
        list.iter().flat_map(|t| &t.vertices).map(|v| clip(v.position.truncate())).collect();
    let indices: Vec<u32> = (0..positions.len() as u32).collect();
    let primitives =
        Primitives { positions: &positions, varyings, stride: 3, indices: &indices, ids: Ids::From(0) };
    let state = State { interpolation: Interpolation::Screen, ..State::default() };
    rasterizer.draw(target, &primitives, &state, shading)
}

/// What lights a pixel.
#[derive(Clone, Copy)]
pub struct PixelLight<'a> {
    /// The view, for the way back.
    pub view: &'a View,
    /// The device map, for the way back.
    pub map: &'a DeviceMap,
    /// The lights.
    pub rig: &'a LightRig,
    /// Materials by number, the default material last.
    pub materials: &'a [PhongConstants],
    /// Textures by material; may be shorter.
    pub textures: &'a [Option<Texture>],
    /// The list before the first stage, for the frames of textures.
    pub originals: &'a [Triangle],
    /// Fog.
    pub fog: Option<Fog>,
}

impl PixelLight<'_> {
    /// Place in the scene of a pixel's centre at a window depth.
    /// Source: course text, section 1.9.
    #[must_use]
    pub fn place(&self, x: u32, y: u32, depth: f32) -> DVec3 {
        let centre = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
        let canonical =
            self.map.normalized_from_device(centre.extend(canonical_from_depth(f64::from(depth))));
        let clip = DVec3::new(canonical.x, canonical.y, depth_from_canonical(canonical.z));
        self.view.world_from_clip.project_point3(clip)
    }

    /// Light of `triangle` at a place of the scene.
    #[must_use]
    pub fn light(&self, triangle: &Triangle, place: DVec3, normal: Vec3) -> LinearRgb {
        let Some(constants) = self.materials.get(triangle.material) else { return LinearRgb::BLACK };
        let to_viewer = self.view.kind.towards_viewer(place).as_vec3();
        let normal = normal.normalize_or(to_viewer);
        let point = ShadingPoint { position: place.as_vec3(), normal, to_viewer };
        let texel = self.texel(triangle, place);
        let constants = PhongConstants {
            ambient: constants.ambient * texel,
            diffuse: constants.diffuse * texel,
            ..*constants
        };
        let light = phong(self.rig, &point, &constants, 1.0);
        self.fog.map_or(light, |fog| apply_fog(&fog, light, self.distance(place)))
    }

    fn distance(&self, place: DVec3) -> f32 {
        match self.view.kind {
            senca_math::ViewKind::Central { eye_world } => eye_world.distance(place) as f32,
            senca_math::ViewKind::Parallel { .. } => {
                -self.view.view_from_world.transform_point3(place).z as f32
            }
        }
    }

    /// The texture by the transformation method, the nearest texel.
    /// Source: course text, section 2.11.
    fn texel(&self, triangle: &Triangle, place: DVec3) -> LinearRgb {
        let texture = self.textures.get(triangle.material).and_then(Option::as_ref);
        let original = self.originals.get(triangle.original as usize);
        let (Some(texture), Some(original)) = (texture, original) else { return LinearRgb::WHITE };
        let alignment = original.vertices.map(|v| v.alignment.as_dvec2());
        let Some(frame) = TextureFrame::new(original.corners(), alignment) else { return LinearRgb::WHITE };
        let uv = frame.coordinates(place).as_vec2().to_array();
        let sampler = Sampler { grid: TexelGrid::Points, ..Sampler::NEAREST.wrapped(Wrap::Repeat) };
        let [r, g, b, _] = sampler.sample_lod(texture, uv, 0.0);
        LinearRgb::new(r, g, b)
    }
}

struct PhongFragments<'a> {
    list: &'a [Triangle],
    light: &'a PixelLight<'a>,
}

impl FragmentShader for PhongFragments<'_> {
    fn shade(&self, fragments: &Fragments<'_>, out: &mut Shaded) {
        let triangle = &self.list[fragments.id as usize];
        let [nx, ny, nz] = [0, 1, 2].map(|k: usize| -> [f32; LANES] { fragments.varyings[k] });
        for lane in fragments.lanes() {
            let place = self.light.place(fragments.column(lane), fragments.row(lane), fragments.depth[lane]);
            let normal = Vec3::new(nx[lane], ny[lane], nz[lane]);
            let LinearRgb { r, g, b } = self.light.light(triangle, place, normal);
            out.set(lane, [r, g, b, 1.0]);
        }
    }
}

/// Buffers of the z-buffer algorithm: colours at the background, depths infinitely far.
/// Source: course text, section 2.9.
#[must_use]
pub fn z_buffer(width: u32, height: u32, background: LinearRgb) -> Buffers {
    let mut buffers = Buffers::new(width, height);
    let LinearRgb { r, g, b } = background;
    buffers.color.pixels_mut().fill([r, g, b, 1.0]);
    buffers
}
