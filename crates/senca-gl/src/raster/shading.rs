//! What the rasterizer can do by itself, which is the fastest: one colour per vertex, perhaps times a
//! texture, blended in the usual ways, or depth alone.

use crate::fragment::{MAX_LOD_BIAS, View};
use crate::raster_state::{Batch, Kind, RasterState};
use crate::state::{Cap, ColorBuffer, StencilBuffer, TexTarget};
use crate::texture::{BaseFormat, TexImage, TexParams, Texels};
use crate::{Enum, gl};
use senca_raster::{
    Blend, ColorSource, Factor, Filter, Mip, Sampler, Shading, SharedTexels, StencilOp, StencilTest, Target,
    Texture, TextureLevel, TextureUnit, Wrap,
};
use std::sync::Arc;

/// A texture that the rasterizer multiplies colours by, or that is all there is to see.
#[derive(Debug)]
pub(super) struct SimpleTexture {
    texture: Texture,
    sampler: Sampler,
    coords: usize,
    /// The vertices' colours do not count.
    replaces: bool,
}

/// Texels as the rasterizer takes them.
struct Colors(Arc<Texels>);

impl AsRef<[[u8; 4]]> for Colors {
    fn as_ref(&self) -> &[[u8; 4]] {
        match &*self.0 {
            Texels::Rgba8(colors) => colors,
            _ => &[],
        }
    }
}

/// The texture of a batch, if the rasterizer can read it by itself: one of two dimensions and 8 bits,
/// modulating or replacing, and not projected.
pub(super) fn simple_texture(batch: &Batch) -> Option<SimpleTexture> {
    let [unit] = batch.state.units.as_slice() else { return None };
    let View { params, levels } = &unit.view;
    let first = levels.first()?.first()?;
    let colored =
        !matches!(first.format.base(), BaseFormat::Alpha | BaseFormat::Depth | BaseFormat::DepthStencil);
    let opaque = matches!(first.format.base(), BaseFormat::Rgb | BaseFormat::Luminance);
    let replaces = unit.env.mode == gl::REPLACE && !opaque;
    let fits = unit.target == TexTarget::Two
        && batch.kind == Kind::Triangles
        && colored
        && (replaces || unit.env.mode == gl::MODULATE)
        && first.border == 0
        && !first.format.is_srgb();
    if !fits {
        return None;
    }
    let coords = usize::from(batch.layout.tex_coords[unit.unit]?);
    let stride = usize::from(batch.layout.stride);
    if batch.varyings.chunks_exact(stride).any(|v| v[coords + 3] != 1.0) {
        return None;
    }
    let sampler = sampler(params, unit.env.lod_bias, levels.len())?;
    let level = |images: &Vec<TexImage>| {
        let image = images.first().filter(|image| matches!(*image.texels, Texels::Rgba8(_)))?;
        let shared = SharedTexels(Arc::new(Colors(Arc::clone(&image.texels))));
        TextureLevel::new(image.width, image.height, senca_raster::Texels::Shared(shared)).ok()
    };
    let texture = Texture::from_levels(levels.iter().map(level).collect::<Option<_>>()?).ok()?;
    Some(SimpleTexture { texture, sampler, coords, replaces })
}

impl SimpleTexture {
    /// The same for a target whose pixels are samples, `side` along each side of a pixel: the level of detail is that
    /// of the whole pixel (OpenGL 1.5, section 3.8.8).
    pub(super) fn of_samples(mut self, side: u32) -> Self {
        self.sampler.lod_bias += side.ilog2() as f32;
        self
    }
}

/// The parameters of a texture in the rasterizer's terms, if it has them.
fn sampler(p: &TexParams, env_lod_bias: f32, levels: usize) -> Option<Sampler> {
    let (minify, mip) = match p.min_filter {
        gl::NEAREST => (Filter::Nearest, Mip::None),
        gl::LINEAR => (Filter::Linear, Mip::None),
        gl::NEAREST_MIPMAP_NEAREST => (Filter::Nearest, Mip::Nearest),
        gl::LINEAR_MIPMAP_NEAREST => (Filter::Linear, Mip::Nearest),
        gl::NEAREST_MIPMAP_LINEAR => (Filter::Nearest, Mip::Linear),
        _ => (Filter::Linear, Mip::Linear),
    };
    let magnify = if p.mag_filter == gl::LINEAR { Filter::Linear } else { Filter::Nearest };
    // Between a linear and a sharp filter OpenGL's border is elsewhere.
    let borders_agree = magnify == Filter::Nearest || minify == Filter::Linear || mip == Mip::None;
    let unlimited = p.min_lod <= 0.0 && p.max_lod >= levels as f32;
    if !borders_agree || !unlimited {
        return None;
    }
    let sharp = [magnify, minify] == [Filter::Nearest; 2];
    let wrap = |wrap: Enum| match wrap {
        gl::REPEAT => Some(Wrap::Repeat),
        gl::MIRRORED_REPEAT => Some(Wrap::Mirror),
        gl::CLAMP_TO_EDGE => Some(Wrap::Clamp),
        gl::CLAMP if sharp => Some(Wrap::Clamp),
        _ => None,
    };
    Some(Sampler {
        wrap_u: wrap(p.wrap[0])?,
        wrap_v: wrap(p.wrap[1])?,
        magnify,
        minify,
        mip,
        lod_bias: (p.lod_bias + env_lod_bias).clamp(-MAX_LOD_BIAS, MAX_LOD_BIAS),
        ..Sampler::default()
    })
}

/// The rasterizer's own shading and blending.
#[derive(Debug)]
pub(super) struct SimpleShading {
    /// `None` if depths are all that counts.
    color: Option<ColorSource>,
    texture: Option<SimpleTexture>,
    pub(super) blend: Option<Blend>,
    pub(super) stencil: Option<StencilTest>,
}

impl SimpleShading {
    /// In the rasterizer's terms.
    pub(super) fn shading(&self) -> Shading<'_> {
        let Some(color) = self.color else { return Shading::None };
        let texture = self.texture.as_ref();
        let texture =
            texture.map(|t| TextureUnit { texture: &t.texture, sampler: t.sampler, coords: t.coords });
        Shading::Fixed { color, texture }
    }
}

/// Vertices up to which it is worth while to look whether they have one colour.
const FEW_VERTICES: usize = 4096;

/// The colour that all vertices have.
pub(super) fn constant_color(batch: &Batch) -> Option<[f32; 4]> {
    let stride = usize::from(batch.layout.stride);
    if batch.kind != Kind::Triangles || batch.positions.len() > FEW_VERTICES {
        return None;
    }
    let color = *batch.varyings.first_chunk::<4>()?;
    batch.varyings.chunks_exact(stride).all(|v| v.starts_with(&color)).then_some(color)
}

/// The rasterizer's own shading and blending, where the state asks for no more than it can.
pub(super) fn simple_shading(
    s: &RasterState,
    kind: Kind,
    target: &Target<'_>,
    texture: Option<SimpleTexture>,
    constant: Option<[f32; 4]>,
) -> Option<SimpleShading> {
    let stencil = s.has(Cap::StencilTest) && target.has_stencil();
    let stipple = kind == Kind::Triangles && s.has(Cap::PolygonStipple);
    if stencil && kind != Kind::Triangles || stipple {
        return None;
    }
    let stencil = stencil.then(|| stencil_of(&s.stencil));
    let alpha_test = s.has(Cap::AlphaTest) && s.color.alpha_func != gl::ALWAYS;
    if s.color.mask == [false; 4] && !alpha_test {
        return Some(SimpleShading { color: None, texture: None, blend: None, stencil });
    }
    let plain = (s.units.is_empty() || texture.is_some())
        && !s.color_sum
        && !s.has(Cap::Fog)
        && !alpha_test
        && !s.has(Cap::ColorLogicOp)
        && s.color.mask == [true; 4];
    if !plain {
        return None;
    }
    let blend = if s.has(Cap::Blend) { Some(blend_of(&s.color)?) } else { None };
    let blend = blend.filter(|b| *b != Blend { source: Factor::One, destination: Factor::Zero });
    let color = match &texture {
        Some(texture) if texture.replaces => ColorSource::Constant([1.0; 4]),
        _ => constant.map_or(ColorSource::Rgba { first: 0 }, ColorSource::Constant),
    };
    Some(SimpleShading { color: Some(color), texture, blend, stencil })
}

fn stencil_of(s: &StencilBuffer) -> StencilTest {
    StencilTest {
        compare: super::compare(s.func),
        reference: s.reference.clamp(0, 255) as u8,
        value_mask: s.value_mask as u8,
        write_mask: s.write_mask as u8,
        fail: stencil_op(s.fail),
        depth_fail: stencil_op(s.depth_fail),
        pass: stencil_op(s.depth_pass),
    }
}

fn stencil_op(op: Enum) -> StencilOp {
    match op {
        gl::ZERO => StencilOp::Zero,
        gl::REPLACE => StencilOp::Replace,
        gl::INCR => StencilOp::Increment,
        gl::DECR => StencilOp::Decrement,
        gl::INCR_WRAP => StencilOp::IncrementWrap,
        gl::DECR_WRAP => StencilOp::DecrementWrap,
        gl::INVERT => StencilOp::Invert,
        _ => StencilOp::Keep,
    }
}

/// The blending, if it is a sum with the same factors for colour and alpha.
fn blend_of(c: &ColorBuffer) -> Option<Blend> {
    let [source, destination, source_alpha, destination_alpha] = c.blend_func;
    let same = [source, destination] == [source_alpha, destination_alpha];
    if !same || c.blend_equation != [gl::FUNC_ADD; 2] {
        return None;
    }
    Some(Blend { source: factor(source)?, destination: factor(destination)? })
}

fn factor(factor: Enum) -> Option<Factor> {
    Some(match factor {
        gl::ZERO => Factor::Zero,
        gl::ONE => Factor::One,
        gl::SRC_COLOR => Factor::SourceColor,
        gl::ONE_MINUS_SRC_COLOR => Factor::OneMinusSourceColor,
        gl::DST_COLOR => Factor::DestinationColor,
        gl::ONE_MINUS_DST_COLOR => Factor::OneMinusDestinationColor,
        gl::SRC_ALPHA => Factor::SourceAlpha,
        gl::ONE_MINUS_SRC_ALPHA => Factor::OneMinusSourceAlpha,
        gl::DST_ALPHA => Factor::DestinationAlpha,
        gl::ONE_MINUS_DST_ALPHA => Factor::OneMinusDestinationAlpha,
        gl::SRC_ALPHA_SATURATE => Factor::SourceAlphaSaturate,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fragment::Program;
    use crate::raster_state::UnitState;
    use crate::state::TexEnv;
    use crate::texture::InternalFormat;
    use crate::vertex::Layout;
    use senca_math::glam::Vec4;
    use senca_raster::{ColorPlane, Rasterizer as _, SimdLevel, State, TiledRasterizer};

    /// A batch of two textured triangles.
    fn batch(filter: Enum, wrap: Enum, mode: Enum, q: f32) -> Batch {
        let format = InternalFormat::for_texture(gl::RGBA8).unwrap();
        let mut image = TexImage::new(format, [16, 8, 1], 0).unwrap();
        let texel = |i: u32| [(i * 37 % 251) as u8, (i * 91 % 256) as u8, (i % 16 * 16) as u8, 200];
        image.texels = Arc::new(Texels::Rgba8((0..128).map(texel).collect()));
        let params =
            TexParams { min_filter: filter, mag_filter: filter, wrap: [wrap; 3], ..TexParams::default() };
        let env = TexEnv { mode, ..TexEnv::default() };
        let view = View { params, levels: vec![vec![image]] };
        let mut tex_coords = [None; crate::state::TEXTURE_UNITS];
        tex_coords[0] = Some(4);
        let mut batch =
            Batch { layout: Layout { tex_coords, stride: 8, ..Layout::default() }, ..Batch::default() };
        batch.state.units = vec![UnitState { unit: 0, env, target: TexTarget::Two, view }];
        for (x, y, w) in [(-1.0, -1.0, 1.0), (1.0, -1.0, 1.5), (1.0, 1.0, 2.0), (-1.0, 1.0, 1.25)] {
            batch.positions.push(Vec4::new(x * w, y * w, 0.5 * w, w));
            batch.varyings.extend([1.0, 0.5 * w, 0.25, 0.5, x * 1.3, y * 0.7, 0.0, q]);
        }
        batch.indices = vec![0, 1, 2, 0, 2, 3];
        batch
    }

    #[test]
    fn the_rasterizers_own_way_is_the_stages() {
        for filter in [gl::NEAREST, gl::LINEAR] {
            for wrap in [gl::REPEAT, gl::MIRRORED_REPEAT, gl::CLAMP_TO_EDGE] {
                for mode in [gl::MODULATE, gl::REPLACE] {
                    let batch = batch(filter, wrap, mode, 1.0);
                    let draw = |shading: &Shading<'_>| {
                        let mut color = vec![[0u8; 4]; 50 * 40];
                        let mut target = Target::new(50, 40)
                            .and_then(|t| t.with_color(ColorPlane::Rgba8(&mut color)))
                            .unwrap();
                        let p = senca_raster::Primitives {
                            positions: &batch.positions,
                            varyings: &batch.varyings,
                            stride: 8,
                            indices: &batch.indices,
                            ids: senca_raster::Ids::Same(0),
                        };
                        TiledRasterizer::default().draw(&mut target, &p, &State::default(), shading);
                        color
                    };
                    let texture = simple_texture(&batch).unwrap();
                    let mut none = [[0u8; 4]; 1];
                    let target =
                        Target::new(1, 1).and_then(|t| t.with_color(ColorPlane::Rgba8(&mut none))).unwrap();
                    let simple = simple_shading(&batch.state, Kind::Triangles, &target, Some(texture), None);
                    let program = Program::new(
                        &batch.state,
                        Kind::Triangles,
                        &batch.layout,
                        SimdLevel::new(),
                        [false, false],
                    );
                    let (a, b) = (draw(&simple.unwrap().shading()), draw(&Shading::Stage(&program)));
                    let far =
                        |(a, b): &(&[u8; 4], &[u8; 4])| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 3);
                    let apart = a.iter().zip(&b).filter(far).count();
                    assert!(apart <= 4, "{filter:#x} {wrap:#x} {mode:#x}: {apart}");
                }
            }
        }
    }

    #[test]
    fn projected_textures_and_borders_are_for_the_stage() {
        assert!(simple_texture(&batch(gl::LINEAR, gl::REPEAT, gl::MODULATE, 2.0)).is_none());
        assert!(simple_texture(&batch(gl::LINEAR, gl::CLAMP, gl::MODULATE, 1.0)).is_none());
        assert!(simple_texture(&batch(gl::NEAREST, gl::CLAMP, gl::MODULATE, 1.0)).is_some());
        assert!(simple_texture(&batch(gl::LINEAR, gl::REPEAT, gl::DECAL, 1.0)).is_none());
    }
}
