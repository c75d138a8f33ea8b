//! Colour of fragments, the plain form: one lane after another.

use crate::api::{ColorSource, Fragments, LANES, Shaded, Shading, TextureUnit};
use crate::assemble::TriangleVaryings;
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

/// Change of varyings `k` and `k + 1` per pixel: `[[ux, vx], [uy, vy]]`.
fn derivatives(setup: &Setup, varyings: &TriangleVaryings, k: usize, [b1, b2, w]: [f32; 3]) -> [[f32; 2]; 2] {
    let (u, v) = (varyings.terms[k], varyings.terms[k + 1]);
    if setup.affine {
        return [[u[1], v[1]], [u[2], v[2]]];
    }
    let (p1, p2, q) = (&setup.b1, &setup.b2, &setup.q);
    let (b1x, b2x) = ((p1.dx - b1 * q.dx) * w, (p2.dx - b2 * q.dx) * w);
    let (b1y, b2y) = ((p1.dy - b1 * q.dy) * w, (p2.dy - b2 * q.dy) * w);
    [[b1x * u[1] + b2x * u[2], b1x * v[1] + b2x * v[2]], [b1y * u[1] + b2y * u[2], b1y * v[1] + b2y * v[2]]]
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
        Shading::None => {}
        Shading::Custom(shader) => shader.shade(fragments, out),
        Shading::Fixed { color, texture } => {
            for lane in fragments.lanes() {
                let mut rgba = color_of(color, fragments.varyings, lane);
                if let Some(unit) = texture {
                    let at = [origin_to_lane0[0] + (lane % 8) as f32, origin_to_lane0[1] + (lane / 8) as f32];
                    let texel = texture_at(unit, setup, varyings, at);
                    rgba = std::array::from_fn(|k| rgba[k] * texel[k]);
                }
                out.set(lane, rgba);
            }
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

fn texture_at(
    unit: &TextureUnit<'_>,
    setup: &Setup,
    varyings: &TriangleVaryings,
    [fx, fy]: [f32; 2],
) -> [f32; 4] {
    let k = unit.coords.min(crate::api::MAX_VARYINGS - 2);
    let weights = setup.weights(fx, fy);
    let uv = [k, k + 1].map(|k| varyings.at(k, setup.affine, [fx, fy], weights));
    unit.sampler.sample(unit.texture, uv, derivatives(setup, varyings, k, weights))
}
