//! Colour of fragments, the plain form: one lane after another.

use crate::api::{ColorSource, FixedShading, Fragments, LANES, Shaded, Shading, TextureUnit};
use crate::assemble::TriangleVaryings;
use crate::cube::CubeUnit;
use crate::setup::Setup;

/// Varyings at the 16 lanes of a batch whose lane 0 is pixel (`fx`, `fy`) from the reference.
pub(crate) fn interpolate(
    setup: &Setup,
    varyings: &TriangleVaryings,
    [fx, fy]: [f32; 2],
    out: &mut [[f32; LANES]],
) {
    for lane in 0..LANES {
        let (x, y) = (fx + (lane % 8) as f32, fy + (lane / 8) as f32);
        let weights = setup.weights(x, y);
        for (k, plane) in out.iter_mut().enumerate().take(varyings.count) {
            plane[lane] = varyings.at(k, setup.affine, [x, y], weights);
        }
    }
}

/// Change of varyings `k`, `k + 1` and so on, which are `values` there, per pixel: `[[ux, vx], [uy, vy]]`.
///
/// With weights `b = B w`, where `B` and `q = 1/w` are linear on the screen, a varying is
/// `u0 + b1 u1 + b2 u2`; its change along an axis is `(B1' u1 + B2' u2 - (u - u0) q') w`.
pub(crate) fn derivatives<const N: usize>(
    setup: &Setup,
    varyings: &TriangleVaryings,
    k: usize,
    w: f32,
    values: [f32; N],
) -> [[f32; N]; 2] {
    let terms: [[f32; 3]; N] = std::array::from_fn(|n| varyings.terms[k + n]);
    if setup.affine {
        return [terms.map(|t| t[1]), terms.map(|t| t[2])];
    }
    let (b1, b2, q) = (&setup.b1, &setup.b2, &setup.q);
    let change = |k: usize, b1: f32, b2: f32, q: f32| {
        let [u0, u1, u2] = terms[k];
        ((b1 * u1 + b2 * u2) - (values[k] - u0) * q) * w
    };
    [
        std::array::from_fn(|k| change(k, b1.dx, b2.dx, q.dx)),
        std::array::from_fn(|k| change(k, b1.dy, b2.dy, q.dy)),
    ]
}

/// Fills `out` for the lanes of `fragments`.
pub(crate) fn shade_plain(
    shading: &Shading<'_>,
    setup: &Setup,
    varyings: &TriangleVaryings,
    origin_to_lane0: [f32; 2],
    fragments: &Fragments<'_>,
    out: &mut Shaded,
) {
    match shading {
        Shading::None | Shading::Stage(_) => {}
        Shading::Custom(shader) => shader.shade(fragments, out),
        Shading::Fixed(FixedShading { color, texture, cube, shadow, alpha_test }) => {
            for lane in fragments.lanes() {
                let mut rgba = color_of(color, fragments.varyings, lane);
                if let Some(unit) = shadow {
                    let of_lane = |k: usize| fragments.varyings.get(k).map_or(0.0, |plane| plane[lane]);
                    let coords = [0, 1, 2, 3].map(|k| of_lane(unit.coords.saturating_add(k)));
                    rgba = unit.dimmed(rgba, unit.light(coords));
                }
                if let Some(unit) = texture {
                    let at = place_of(fragments.columns as usize, origin_to_lane0, lane);
                    let texel = texture_at(unit, setup, varyings, at);
                    rgba = std::array::from_fn(|k| rgba[k] * texel[k]);
                } else if let Some(unit) = cube {
                    let at = place_of(fragments.columns as usize, origin_to_lane0, lane);
                    let texel = cube_at(unit, setup, varyings, at);
                    rgba = std::array::from_fn(|k| rgba[k] * texel[k]);
                }
                out.set(lane, rgba);
                if alpha_test.is_some_and(|test| !test.passes(rgba[3])) {
                    out.discard(lane);
                }
            }
        }
    }
}

/// Where a lane is, from the reference: the middle of the samples of its pixel if there are four pixels in a row.
pub(crate) fn place_of(columns: usize, [x, y]: [f32; 2], lane: usize) -> [f32; 2] {
    let (column, row) = ((lane % columns) as f32, (lane / columns) as f32);
    if columns == 8 { [x + column, y + row] } else { [x + 0.5 + 2.0 * column, y + 0.5 + 2.0 * row] }
}

/// Colour of a fragment with these varyings, which do not change from pixel to pixel.
#[inline(always)]
pub(crate) fn color_of_values(shading: &Shading<'_>, values: &[f32]) -> [f32; 4] {
    let Shading::Fixed(FixedShading { color, texture, cube, shadow, .. }) = shading else {
        return [0.0, 0.0, 0.0, 1.0];
    };
    let at = |k: usize| values.get(k).copied().unwrap_or(0.0);
    let mut rgba = source_color(color, values);
    if let Some(unit) = shadow {
        let coords = [0, 1, 2, 3].map(|k| at(unit.coords.saturating_add(k)));
        rgba = unit.dimmed(rgba, unit.light(coords));
    }
    let texel = match (texture, cube) {
        (Some(unit), _) => {
            let uv = [at(unit.coords), at(unit.coords.saturating_add(1))];
            unit.sampler.sample(unit.texture, uv, [[0.0; 2]; 2])
        }
        (None, Some(unit)) => {
            let direction = [0, 1, 2].map(|k| at(unit.coords.saturating_add(k)));
            unit.sample(direction, [[0.0; 3]; 2])
        }
        (None, None) => return rgba,
    };
    std::array::from_fn(|k| rgba[k] * texel[k])
}

/// The colour among the varyings of a fragment or a corner.
#[inline(always)]
pub(crate) fn source_color(color: &ColorSource, values: &[f32]) -> [f32; 4] {
    let at = |k: usize| values.get(k).copied().unwrap_or(0.0);
    match *color {
        ColorSource::Constant(rgba) => rgba,
        ColorSource::Rgb { first: f } => [at(f), at(f.saturating_add(1)), at(f.saturating_add(2)), 1.0],
        ColorSource::Rgba { first: f } => {
            [at(f), at(f.saturating_add(1)), at(f.saturating_add(2)), at(f.saturating_add(3))]
        }
    }
}

fn color_of(color: &ColorSource, varyings: &[[f32; LANES]], lane: usize) -> [f32; 4] {
    let at = |first: usize, k: usize| varyings.get(first.saturating_add(k)).map_or(0.0, |v| v[lane]);
    match *color {
        ColorSource::Constant(rgba) => rgba,
        ColorSource::Rgb { first: f } => [at(f, 0), at(f, 1), at(f, 2), 1.0],
        ColorSource::Rgba { first: f } => [at(f, 0), at(f, 1), at(f, 2), at(f, 3)],
    }
}

fn cube_at(unit: &CubeUnit<'_>, setup: &Setup, varyings: &TriangleVaryings, [fx, fy]: [f32; 2]) -> [f32; 4] {
    let k = unit.coords.min(crate::api::MAX_VARYINGS - 3);
    let weights = setup.weights(fx, fy);
    let direction = [k, k + 1, k + 2].map(|k| varyings.at(k, setup.affine, [fx, fy], weights));
    unit.sample(direction, derivatives(setup, varyings, k, weights[2], direction))
}

fn texture_at(
    unit: &TextureUnit<'_>,
    setup: &Setup,
    varyings: &TriangleVaryings,
    [fx, fy]: [f32; 2],
) -> [f32; 4] {
    let k = unit.coords.min(crate::api::MAX_VARYINGS - 2);
    let weights = setup.weights(fx, fy);
    let uv = [k, k + 1].map(|k| varyings.at(k, setup.affine, [fx, fy], weights));
    unit.sampler.sample(unit.texture, uv, derivatives(setup, varyings, k, weights[2], uv))
}
