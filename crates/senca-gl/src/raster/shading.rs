//! What the rasterizer can do by itself, which is the fastest: one colour per vertex, perhaps in the light of a shadow
//! map, perhaps times a texture, blended in the usual ways, or depth alone.

use crate::fragment::{MAX_LOD_BIAS, View};
use crate::raster_state::{Batch, Kind, RasterState, UnitState};
use crate::state::{Cap, ColorBuffer, StencilBuffer, TexTarget};
use crate::texture::{BaseFormat, TexImage, TexParams, Texels};
use crate::{Enum, gl};
use senca_raster::{
    AlphaTest, Blend, ColorSource, Compare, CubeTexture, CubeUnit, Factor, Filter, FixedShading, Mip,
    Sampler, Shading, ShadowUnit, SharedTexels, StencilOp, StencilTest, Target, Texture, TextureLevel,
    TextureUnit, Wrap,
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

/// A shadow map that dims colours.
#[derive(Debug)]
struct SimpleShadow {
    /// Depths kept in blocks.
    depths: Arc<Texels>,
    coords: usize,
    compare: Compare,
    filter: Filter,
    dims_colors: bool,
    dims_alpha: bool,
}

/// A cube of textures that the rasterizer multiplies colours by, or that is all there is to see.
#[derive(Debug)]
struct SimpleCube {
    texture: Arc<CubeTexture>,
    sampler: Sampler,
    coords: usize,
    replaces: bool,
}

/// What units of texture do, if the rasterizer can do it by itself.
#[derive(Debug, Default)]
pub(super) struct SimpleUnits {
    texture: Option<SimpleTexture>,
    cube: Option<SimpleCube>,
    shadow: Option<SimpleShadow>,
}

impl SimpleUnits {
    /// Of a batch whose target has squares of `side` samples along each side of a pixel: a texture or a cube, or a
    /// shadow map, or both. `None` if they are more than that.
    pub(super) fn new(batch: &Batch, side: u32) -> Option<Self> {
        let [first, second] = match batch.state.units.as_slice() {
            [] => return Some(Self::default()),
            [unit] => [Some(unit), None],
            [first, second] => [Some(first), Some(second)],
            _ => return None,
        };
        if batch.kind != Kind::Triangles {
            return None;
        }
        let mut units = Self::default();
        for unit in [first, second].into_iter().flatten() {
            match simple_shadow(batch, unit) {
                Some(shadow) if units.shadow.is_none() => units.shadow = Some(shadow),
                _ if units.texture.is_some() || units.cube.is_some() => return None,
                _ if unit.target == TexTarget::Cube => units.cube = Some(simple_cube(batch, unit, side)?),
                _ => units.texture = Some(simple_texture(batch, unit, side)?),
            }
        }
        // After a shadow the texture would have the last word.
        (units.shadow.is_none() || !units.replaces()).then_some(units)
    }

    /// Whether the vertices' colours do not count.
    fn replaces(&self) -> bool {
        self.texture.as_ref().is_some_and(|texture| texture.replaces)
            || self.cube.as_ref().is_some_and(|cube| cube.replaces)
    }
}

/// The shadow map of a unit, if the rasterizer can read it by itself: one that was drawn, modulating.
fn simple_shadow(batch: &Batch, unit: &UnitState) -> Option<SimpleShadow> {
    let View { params, levels, .. } = &unit.view;
    let [images] = levels.as_slice() else { return None };
    let image = images.first()?;
    let (Texels::Depth(depths) | Texels::DepthStencil { depth: depths, .. }) = &*image.texels else {
        return None;
    };
    let filter = match [params.min_filter, params.mag_filter] {
        [gl::NEAREST, gl::NEAREST] => Filter::Nearest,
        [gl::LINEAR, gl::LINEAR] => Filter::Linear,
        _ => return None,
    };
    let fits = unit.target == TexTarget::Two
        && unit.env.mode == gl::MODULATE
        && image.border == 0
        && depths.kept_blocks().is_some()
        && params.wrap[..2] == [gl::CLAMP_TO_EDGE; 2]
        && params.compare_mode == gl::COMPARE_R_TO_TEXTURE;
    fits.then_some(())?;
    let dims = match params.depth_mode {
        gl::INTENSITY => [true, true],
        gl::ALPHA => [false, true],
        _ => [true, false],
    };
    Some(SimpleShadow {
        depths: Arc::clone(&image.texels),
        coords: usize::from(batch.layout.tex_coords[unit.unit]?),
        compare: super::compare(params.compare_func),
        filter,
        dims_colors: dims[0],
        dims_alpha: dims[1],
    })
}

impl SimpleShadow {
    /// In the rasterizer's terms.
    fn unit(&self) -> Option<ShadowUnit<'_>> {
        let (Texels::Depth(depths) | Texels::DepthStencil { depth: depths, .. }) = &*self.depths else {
            return None;
        };
        Some(ShadowUnit {
            depths: depths.kept_blocks()?,
            coords: self.coords,
            compare: self.compare,
            filter: self.filter,
            dims_colors: self.dims_colors,
            dims_alpha: self.dims_alpha,
        })
    }
}

/// Whether colours of vertices do not count where a unit's texture has a colour; `None` if the rasterizer cannot do with
/// them what the unit wants.
fn replaces(unit: &UnitState) -> Option<bool> {
    let first = unit.view.levels.first()?.first()?;
    let colored =
        !matches!(first.format.base(), BaseFormat::Alpha | BaseFormat::Depth | BaseFormat::DepthStencil);
    let opaque = matches!(first.format.base(), BaseFormat::Rgb | BaseFormat::Luminance);
    let replaces = unit.env.mode == gl::REPLACE && !opaque;
    let fits = colored
        && (replaces || unit.env.mode == gl::MODULATE)
        && first.border == 0
        && !first.format.is_srgb();
    fits.then_some(replaces)
}

/// The cube of a unit, if the rasterizer can read it by itself: one of 8 bits, modulating or replacing, whose texels are
/// mixed.
fn simple_cube(batch: &Batch, unit: &UnitState, side: u32) -> Option<SimpleCube> {
    let view = &unit.view;
    let replaces = replaces(unit)?;
    let seamless = batch.state.has(Cap::TextureCubeMapSeamless);
    // Where faces are mixed there is no wrapping.
    let params = match seamless {
        true => TexParams { wrap: [gl::CLAMP_TO_EDGE; 3], ..view.params },
        false => view.params,
    };
    let sampler = of_samples(sampler(&params, unit.env.lod_bias, view.levels.len())?, side);
    let linear = [sampler.magnify, sampler.minify] == [Filter::Linear; 2];
    if !linear || params.wrap[..2] != [gl::CLAMP_TO_EDGE; 2] {
        return None;
    }
    let coords = usize::from(batch.layout.tex_coords[unit.unit]?);
    Some(SimpleCube { texture: view.cube(seamless)?, sampler, coords, replaces })
}

/// The texture of a unit, if the rasterizer can read it by itself: one of two dimensions and 8 bits,
/// modulating or replacing, and not projected.
fn simple_texture(batch: &Batch, unit: &UnitState, side: u32) -> Option<SimpleTexture> {
    let View { params, levels, .. } = &unit.view;
    let replaces = replaces(unit)?;
    if unit.target != TexTarget::Two {
        return None;
    }
    let coords = usize::from(batch.layout.tex_coords[unit.unit]?);
    let stride = usize::from(batch.layout.stride);
    if batch.varyings.chunks_exact(stride).any(|v| v[coords + 3] != 1.0) {
        return None;
    }
    let sampler = of_samples(sampler(params, unit.env.lod_bias, levels.len())?, side);
    let level = |images: &Vec<TexImage>| {
        let image = images.first().filter(|image| matches!(*image.texels, Texels::Rgba8(_)))?;
        let shared = SharedTexels(Arc::new(Colors(Arc::clone(&image.texels))));
        TextureLevel::new(image.width, image.height, senca_raster::Texels::Shared(shared)).ok()
    };
    let texture = Texture::from_levels(levels.iter().map(level).collect::<Option<_>>()?).ok()?;
    Some(SimpleTexture { texture, sampler, coords, replaces })
}

/// The same for a target whose pixels are samples, `side` along each side of a pixel: the level of detail is that of the
/// whole pixel (OpenGL 1.5, section 3.8.8).
fn of_samples(sampler: Sampler, side: u32) -> Sampler {
    Sampler { lod_bias: sampler.lod_bias + side.ilog2() as f32, ..sampler }
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
    units: SimpleUnits,
    alpha_test: Option<AlphaTest>,
    pub(super) blend: Option<Blend>,
    pub(super) stencil: Option<StencilTest>,
}

impl SimpleShading {
    /// In the rasterizer's terms.
    pub(super) fn shading(&self) -> Shading<'_> {
        let Some(color) = self.color else { return Shading::None };
        let texture = self.units.texture.as_ref();
        let texture =
            texture.map(|t| TextureUnit { texture: &t.texture, sampler: t.sampler, coords: t.coords });
        let cube = self.units.cube.as_ref();
        let cube = cube.map(|c| CubeUnit { texture: &c.texture, sampler: c.sampler, coords: c.coords });
        let shadow = self.units.shadow.as_ref().and_then(SimpleShadow::unit);
        Shading::Fixed(FixedShading { color, texture, cube, shadow, alpha_test: self.alpha_test })
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

/// The rasterizer's own shading and blending, where the state asks for no more than it can. `units` is what units of
/// texture do if it can do that.
pub(super) fn simple_shading(
    s: &RasterState,
    kind: Kind,
    target: &Target<'_>,
    units: Option<SimpleUnits>,
    constant: Option<[f32; 4]>,
) -> Option<SimpleShading> {
    let stencil = s.has(Cap::StencilTest) && target.has_stencil();
    let stipple = kind == Kind::Triangles && s.has(Cap::PolygonStipple);
    if stencil && kind != Kind::Triangles || stipple {
        return None;
    }
    let stencil = stencil.then(|| stencil_of(&s.stencil));
    let alpha_test = (s.has(Cap::AlphaTest) && s.color.alpha_func != gl::ALWAYS)
        .then_some(AlphaTest { compare: super::compare(s.color.alpha_func), reference: s.color.alpha_ref });
    if s.color.mask == [false; 4] && alpha_test.is_none() {
        let units = SimpleUnits::default();
        return Some(SimpleShading { color: None, units, alpha_test, blend: None, stencil });
    }
    // The stencil test comes after that of alpha, and lines are left to the program.
    if alpha_test.is_some() && (stencil.is_some() || kind != Kind::Triangles) {
        return None;
    }
    let units = units?;
    let plain = !s.color_sum && !s.has(Cap::Fog) && !s.has(Cap::ColorLogicOp) && s.color.mask == [true; 4];
    if !plain {
        return None;
    }
    let blend = if s.has(Cap::Blend) { Some(blend_of(&s.color)?) } else { None };
    let blend = blend.filter(|b| *b != Blend { source: Factor::One, destination: Factor::Zero });
    let color = match units.replaces() {
        true => ColorSource::Constant([1.0; 4]),
        false => constant.map_or(ColorSource::Rgba { first: 0 }, ColorSource::Constant),
    };
    Some(SimpleShading { color: Some(color), units, alpha_test, blend, stencil })
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
        let view = View::of_levels(params, vec![vec![image]]);
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
                    let units = SimpleUnits::new(&batch, 1);
                    let mut none = [[0u8; 4]; 1];
                    let target =
                        Target::new(1, 1).and_then(|t| t.with_color(ColorPlane::Rgba8(&mut none))).unwrap();
                    let simple = simple_shading(&batch.state, Kind::Triangles, &target, units, None);
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
        assert!(SimpleUnits::new(&batch(gl::LINEAR, gl::REPEAT, gl::MODULATE, 2.0), 1).is_none());
        assert!(SimpleUnits::new(&batch(gl::LINEAR, gl::CLAMP, gl::MODULATE, 1.0), 1).is_none());
        assert!(SimpleUnits::new(&batch(gl::NEAREST, gl::CLAMP, gl::MODULATE, 1.0), 1).is_some());
        assert!(SimpleUnits::new(&batch(gl::LINEAR, gl::REPEAT, gl::DECAL, 1.0), 1).is_none());
    }
}
