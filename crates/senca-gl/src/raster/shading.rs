//! What the rasterizer can do by itself, which is the fastest: one colour per vertex, blended in the usual
//! ways, or depth alone.

use crate::raster_state::{Kind, RasterState};
use crate::state::{Cap, ColorBuffer};
use crate::{Enum, gl};
use senca_raster::{Blend, ColorSource, Factor, Shading, Target};

/// The rasterizer's own shading and blending, where the state asks for no more than it can.
pub(crate) fn simple_shading(
    s: &RasterState,
    kind: Kind,
    target: &Target<'_>,
) -> Option<(Shading<'static>, Option<Blend>)> {
    let stencil = s.has(Cap::StencilTest) && target.has_stencil();
    let stipple = kind == Kind::Triangles && s.has(Cap::PolygonStipple);
    if stencil || stipple {
        return None;
    }
    let alpha_test = s.has(Cap::AlphaTest) && s.color.alpha_func != gl::ALWAYS;
    if s.color.mask == [false; 4] && !alpha_test {
        return Some((Shading::None, None));
    }
    let plain = s.units.is_empty()
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
    Some((Shading::Fixed { color: ColorSource::Rgba { first: 0 }, texture: None }, blend))
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
