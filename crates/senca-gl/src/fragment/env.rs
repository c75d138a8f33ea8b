//! Texture environments: how a texel and the colour so far become the next colour.
//!
//! Source: OpenGL 1.5, section 3.8.13, tables 3.22 to 3.24; ARB_texture_env_crossbar.

use super::ops::inverse;
use super::real::{Color, Real, clamped, constant, mixed};
use crate::state::TexEnv;
use crate::texture::BaseFormat;
use crate::{Enum, gl};

/// What an environment may refer to.
#[derive(Clone, Copy)]
pub(crate) struct Sources<'a, R> {
    /// Colour of the fragment before texturing.
    pub(crate) primary: Color<R>,
    /// Result of the unit before.
    pub(crate) previous: Color<R>,
    /// This unit's texel.
    pub(crate) texel: Color<R>,
    /// Texels of all units that are on, by unit number.
    pub(crate) texels: &'a [(usize, Color<R>)],
}

/// The colour after a unit, clamped to [0, 1].
#[inline(always)]
pub(crate) fn apply<R: Real>(env: &TexEnv, base: BaseFormat, s: &Sources<'_, R>) -> Color<R> {
    let (f, t) = (s.previous, s.texel);
    match env.mode {
        gl::REPLACE => replace(base, f, t),
        gl::MODULATE => modulate(base, f, t),
        gl::DECAL => decal(base, f, t),
        gl::BLEND => blend(base, f, t, constant(f[0], env.color)),
        gl::ADD => add(base, f, t),
        gl::COMBINE => combine(env, s),
        _ => f,
    }
}

#[inline(always)]
fn replace<R: Real>(base: BaseFormat, f: Color<R>, t: Color<R>) -> Color<R> {
    match base {
        BaseFormat::Alpha => [f[0], f[1], f[2], t[3]],
        BaseFormat::Luminance | BaseFormat::Rgb => [t[0], t[1], t[2], f[3]],
        _ => t,
    }
}

#[inline(always)]
fn modulate<R: Real>(base: BaseFormat, f: Color<R>, t: Color<R>) -> Color<R> {
    match base {
        BaseFormat::Alpha => [f[0], f[1], f[2], f[3] * t[3]],
        BaseFormat::Luminance | BaseFormat::Rgb => [f[0] * t[0], f[1] * t[1], f[2] * t[2], f[3]],
        _ => [f[0] * t[0], f[1] * t[1], f[2] * t[2], f[3] * t[3]],
    }
}

/// Undefined but for RGB and RGBA, where the fragment's colour stays.
#[inline(always)]
fn decal<R: Real>(base: BaseFormat, f: Color<R>, t: Color<R>) -> Color<R> {
    match base {
        BaseFormat::Rgb => [t[0], t[1], t[2], f[3]],
        BaseFormat::Rgba => {
            let [r, g, b, _] = mixed(f, t, t[3]);
            [r, g, b, f[3]]
        }
        _ => f,
    }
}

#[inline(always)]
fn blend<R: Real>(base: BaseFormat, f: Color<R>, t: Color<R>, c: Color<R>) -> Color<R> {
    let [r, g, b, a] = [
        f[0].towards(c[0], t[0]),
        f[1].towards(c[1], t[1]),
        f[2].towards(c[2], t[2]),
        f[3].towards(c[3], t[3]),
    ];
    match base {
        BaseFormat::Alpha => [f[0], f[1], f[2], f[3] * t[3]],
        BaseFormat::Luminance | BaseFormat::Rgb => [r, g, b, f[3]],
        BaseFormat::Intensity => [r, g, b, a],
        _ => [r, g, b, f[3] * t[3]],
    }
}

#[inline(always)]
fn add<R: Real>(base: BaseFormat, f: Color<R>, t: Color<R>) -> Color<R> {
    clamped(match base {
        BaseFormat::Alpha => [f[0], f[1], f[2], f[3] * t[3]],
        BaseFormat::Luminance | BaseFormat::Rgb => [f[0] + t[0], f[1] + t[1], f[2] + t[2], f[3]],
        BaseFormat::Intensity => [f[0] + t[0], f[1] + t[1], f[2] + t[2], f[3] + t[3]],
        _ => [f[0] + t[0], f[1] + t[1], f[2] + t[2], f[3] * t[3]],
    })
}

#[inline(always)]
fn combine<R: Real>(env: &TexEnv, s: &Sources<'_, R>) -> Color<R> {
    // Functions and loops instead of closures: those would be compiled without vector instructions.
    let (mut colors, mut alphas) = ([s.primary; 3], [s.primary[3]; 3]);
    for k in 0..3 {
        colors[k] = operand(env, s, env.source_rgb[k], env.operand_rgb[k]);
        alphas[k] = operand(env, s, env.source_alpha[k], env.operand_alpha[k])[3];
    }
    let [a, b, c] = colors;
    let alpha = scaled(combined(env.combine_alpha, alphas[0], alphas[1], alphas[2]), env.alpha_scale);
    let extension = matches!(env.combine_rgb, gl::DOT3_RGB_EXT | gl::DOT3_RGBA_EXT);
    if extension || matches!(env.combine_rgb, gl::DOT3_RGB | gl::DOT3_RGBA) {
        let half = a[0].like(0.5);
        let sum =
            (a[0] - half) * (b[0] - half) + (a[1] - half) * (b[1] - half) + (a[2] - half) * (b[2] - half);
        let dot = scaled(sum * half.like(4.0), if extension { 1.0 } else { env.rgb_scale });
        if matches!(env.combine_rgb, gl::DOT3_RGBA | gl::DOT3_RGBA_EXT) {
            return [dot; 4];
        }
        return [dot, dot, dot, alpha];
    }
    let mut out = [alpha; 4];
    for k in 0..3 {
        out[k] = scaled(combined(env.combine_rgb, a[k], b[k], c[k]), env.rgb_scale);
    }
    out
}

#[inline(always)]
fn scaled<R: Real>(v: R, scale: f32) -> R {
    (v * v.like(scale)).clamped()
}

/// An argument of a combination.
#[inline(always)]
fn operand<R: Real>(env: &TexEnv, s: &Sources<'_, R>, source: Enum, operand: Enum) -> Color<R> {
    let c = match source {
        gl::TEXTURE => s.texel,
        gl::CONSTANT => constant(s.primary[0], env.color),
        gl::PRIMARY_COLOR => s.primary,
        gl::PREVIOUS => s.previous,
        _ => {
            let unit = source.wrapping_sub(gl::TEXTURE0) as usize;
            let mut found = constant(s.primary[0], [1.0; 4]);
            for (k, texel) in s.texels {
                if *k == unit {
                    found = *texel;
                }
            }
            found
        }
    };
    match operand {
        gl::ONE_MINUS_SRC_COLOR => inverse(c),
        gl::SRC_ALPHA => [c[3]; 4],
        gl::ONE_MINUS_SRC_ALPHA => [c[3].one_minus(); 4],
        _ => c,
    }
}

#[inline(always)]
fn combined<R: Real>(function: Enum, a: R, b: R, c: R) -> R {
    match function {
        gl::MODULATE => a * b,
        gl::ADD => a + b,
        gl::ADD_SIGNED => a + b - a.like(0.5),
        gl::INTERPOLATE => b.towards(a, c),
        gl::SUBTRACT => a - b,
        _ => a,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const F: [f32; 4] = [0.8, 0.6, 0.4, 0.5];

    fn colour(mode: Enum, base: BaseFormat, texel: [f32; 4]) -> [f32; 4] {
        let env = TexEnv { mode, color: [0.1, 0.2, 0.3, 0.4], ..TexEnv::default() };
        apply(&env, base, &Sources { primary: F, previous: F, texel, texels: &[] })
    }

    fn close(a: [f32; 4], b: [f32; 4]) {
        assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6), "{a:?} is not {b:?}");
    }

    #[test]
    fn environments_of_every_base_format() {
        let (rgba, rgb) = ([0.5, 0.25, 1.0, 0.2], [0.5, 0.25, 1.0, 1.0]);
        let (lum, lum_alpha, alpha, intensity) =
            ([0.3, 0.3, 0.3, 1.0], [0.3, 0.3, 0.3, 0.2], [0.0, 0.0, 0.0, 0.2], [0.3; 4]);
        use BaseFormat::{Alpha, Intensity, Luminance, LuminanceAlpha, Rgb, Rgba};
        for (mode, base, texel, expected) in [
            (gl::REPLACE, Alpha, alpha, [0.8, 0.6, 0.4, 0.2]),
            (gl::REPLACE, Luminance, lum, [0.3, 0.3, 0.3, 0.5]),
            (gl::REPLACE, LuminanceAlpha, lum_alpha, lum_alpha),
            (gl::REPLACE, Intensity, intensity, intensity),
            (gl::REPLACE, Rgb, rgb, [0.5, 0.25, 1.0, 0.5]),
            (gl::REPLACE, Rgba, rgba, rgba),
            (gl::MODULATE, Alpha, alpha, [0.8, 0.6, 0.4, 0.1]),
            (gl::MODULATE, Luminance, lum, [0.24, 0.18, 0.12, 0.5]),
            (gl::MODULATE, LuminanceAlpha, lum_alpha, [0.24, 0.18, 0.12, 0.1]),
            (gl::MODULATE, Intensity, intensity, [0.24, 0.18, 0.12, 0.15]),
            (gl::MODULATE, Rgb, rgb, [0.4, 0.15, 0.4, 0.5]),
            (gl::MODULATE, Rgba, rgba, [0.4, 0.15, 0.4, 0.1]),
            (gl::DECAL, Rgb, rgb, [0.5, 0.25, 1.0, 0.5]),
            (gl::DECAL, Rgba, rgba, [0.74, 0.53, 0.52, 0.5]),
            (gl::BLEND, Alpha, alpha, [0.8, 0.6, 0.4, 0.1]),
            (gl::BLEND, Luminance, lum, [0.59, 0.48, 0.37, 0.5]),
            (gl::BLEND, LuminanceAlpha, lum_alpha, [0.59, 0.48, 0.37, 0.1]),
            (gl::BLEND, Intensity, intensity, [0.59, 0.48, 0.37, 0.47]),
            (gl::BLEND, Rgb, rgb, [0.45, 0.5, 0.3, 0.5]),
            (gl::BLEND, Rgba, rgba, [0.45, 0.5, 0.3, 0.1]),
            (gl::ADD, Alpha, alpha, [0.8, 0.6, 0.4, 0.1]),
            (gl::ADD, Luminance, lum, [1.0, 0.9, 0.7, 0.5]),
            (gl::ADD, Intensity, intensity, [1.0, 0.9, 0.7, 0.8]),
            (gl::ADD, Rgba, rgba, [1.0, 0.85, 1.0, 0.1]),
        ] {
            close(colour(mode, base, texel), expected);
        }
    }

    #[test]
    fn combinations_by_their_formulas() {
        let (texel, other) = ([0.5, 0.25, 1.0, 0.2], [0.9, 0.1, 0.6, 0.7]);
        let texels = [(0, texel), (3, other)];
        let run = |env: TexEnv| {
            let env = TexEnv { mode: gl::COMBINE, color: [0.1, 0.2, 0.3, 0.4], ..env };
            let s = Sources { primary: [0.2; 4], previous: F, texel, texels: &texels };
            apply(&env, BaseFormat::Rgba, &s)
        };
        let with =
            |rgb: Enum, alpha: Enum| TexEnv { combine_rgb: rgb, combine_alpha: alpha, ..TexEnv::default() };
        close(run(with(gl::MODULATE, gl::REPLACE)), [0.4, 0.15, 0.4, 0.2]);
        close(run(with(gl::ADD, gl::SUBTRACT)), [1.0, 0.85, 1.0, 0.0]);
        close(run(with(gl::ADD_SIGNED, gl::ADD_SIGNED)), [0.8, 0.35, 0.9, 0.2]);
        // By the constant's alpha, 0.4, also for colours: 0.4 texel + 0.6 previous.
        close(run(with(gl::INTERPOLATE, gl::INTERPOLATE)), [0.68, 0.46, 0.64, 0.38]);
        let dot = 4.0 * (0.0 * 0.3 - 0.25 * 0.1 + 0.5 * -0.1);
        close(run(with(gl::DOT3_RGBA, gl::REPLACE)), [f32::max(dot, 0.0); 4]);
        let scaled = TexEnv { rgb_scale: 4.0, alpha_scale: 2.0, ..with(gl::MODULATE, gl::MODULATE) };
        close(run(scaled), [1.0, 0.6, 1.0, 0.2]);
        let crossed = TexEnv {
            source_rgb: [gl::TEXTURE0 + 3, gl::PRIMARY_COLOR, gl::CONSTANT],
            operand_rgb: [gl::ONE_MINUS_SRC_COLOR, gl::SRC_ALPHA, gl::SRC_COLOR],
            ..with(gl::ADD, gl::REPLACE)
        };
        close(run(crossed), [0.3, 1.0, 0.6, 0.2]);
    }
}
