//! The lighting of sixteen vertices at a time; the plain twin is [`LightPlan::light`], whose steps these are.

use crate::lighting::{LightPlan, LightSource, tracks};
use crate::state::Material;
use crate::{Enum, gl};
use senca_math::glam::Vec3;
use senca_raster::simd::{Simd, f32x16, i32x16, prelude::*};

type F<S> = f32x16<S>;
/// Vectors: x, y, z, of sixteen vertices each.
type Vectors<S> = [F<S>; 3];

/// Sixteen lit vertices; see [`crate::lighting::Lit`].
pub(crate) struct LitLanes<S: Simd> {
    pub(crate) color: [F<S>; 4],
    pub(crate) secondary: Vectors<S>,
}

/// The material at sixteen vertices.
struct Surface<S: Simd> {
    ambient: Vectors<S>,
    diffuse: Vectors<S>,
    specular: Vectors<S>,
    emission: Vectors<S>,
    alpha: F<S>,
    /// Whether it may have a highlight.
    shines: bool,
}

impl<S: Simd> Surface<S> {
    /// `mode` says what `color` replaces, if anything.
    #[inline(always)]
    fn new(simd: S, material: &Material, mode: Option<Enum>, color: [F<S>; 4]) -> Self {
        let takes = |part: Enum| mode.is_some_and(|mode| tracks(mode, part));
        let [r, g, b, a] = color;
        let part = |takes: bool, of: [f32; 4]| if takes { [r, g, b] } else { splat3(simd, of) };
        Self {
            ambient: part(takes(gl::AMBIENT), material.ambient),
            diffuse: part(takes(gl::DIFFUSE), material.diffuse),
            specular: part(takes(gl::SPECULAR), material.specular),
            emission: part(takes(gl::EMISSION), material.emission),
            alpha: if takes(gl::DIFFUSE) { a } else { F::splat(simd, material.diffuse[3]) },
            shines: takes(gl::SPECULAR) || material.specular[..3] != [0.0; 3],
        }
    }
}

impl LightPlan {
    /// What [`Self::light`] does, for sixteen vertices. `eye` and `color` have four coordinates.
    #[inline(always)]
    pub(crate) fn light_lanes<S: Simd>(
        &self,
        simd: S,
        eye: [F<S>; 4],
        normal: Vectors<S>,
        color: [F<S>; 4],
        side: usize,
    ) -> LitLanes<S> {
        let (zero, material) = (F::splat(simd, 0.0), &self.materials[side]);
        let surface = Surface::new(simd, material, self.color_material[side], color);
        let mut primary = [zero; 3];
        let mut shine = [zero; 3];
        for (k, primary) in primary.iter_mut().enumerate() {
            *primary = surface.emission[k] + surface.ambient[k] * F::splat(simd, self.ambient[k]);
        }
        let at = [eye[0] / eye[3], eye[1] / eye[3], eye[2] / eye[3]];
        for source in &self.sources {
            let (towards, attenuation) = source.towards_lanes(simd, at);
            let strength = attenuation * source.spot_lanes(simd, towards);
            let reached = !strength.simd_eq(zero);
            let light = &source.light;
            let cosine = positive(simd, dot(normal, towards));
            let [la, ld] = [splat3(simd, light.ambient), splat3(simd, light.diffuse)];
            for (k, primary) in primary.iter_mut().enumerate() {
                let of_light = surface.ambient[k] * la[k] + cosine * surface.diffuse[k] * ld[k];
                *primary = reached.select(*primary + strength * of_light, *primary);
            }
            let faces = reached & cosine.simd_gt(zero);
            if !surface.shines || light.specular[..3] == [0.0; 3] || !faces.any_true() {
                continue;
            }
            let half = source.half_lanes(simd, towards, at, self.local_viewer);
            let factor = power(simd, positive(simd, dot(normal, half)), material.shininess);
            let ls = splat3(simd, light.specular);
            for (k, shine) in shine.iter_mut().enumerate() {
                *shine = faces.select(*shine + strength * factor * surface.specular[k] * ls[k], *shine);
            }
        }
        if !self.separate {
            primary = [primary[0] + shine[0], primary[1] + shine[1], primary[2] + shine[2]];
            shine = [zero; 3];
        }
        let [r, g, b] = clamped3(simd, primary);
        LitLanes { color: [r, g, b, clamped(simd, surface.alpha)], secondary: clamped3(simd, shine) }
    }
}

impl LightSource {
    /// See [`Self::towards`].
    #[inline(always)]
    fn towards_lanes<S: Simd>(&self, simd: S, at: Vectors<S>) -> (Vectors<S>, F<S>) {
        let (zero, one) = (F::splat(simd, 0.0), F::splat(simd, 1.0));
        if let Some(direction) = self.direction {
            return (splat_vector(simd, direction), one);
        }
        let [px, py, pz] = splat_vector(simd, self.position);
        let way = [px - at[0], py - at[1], pz - at[2]];
        let distance = dot(way, way).sqrt();
        let apart = distance.simd_gt(zero);
        let towards = [
            apart.select(way[0] / distance, zero),
            apart.select(way[1] / distance, zero),
            apart.select(way[2] / distance, zero),
        ];
        if !self.attenuates {
            return (towards, one);
        }
        let [a, b, c] = self.light.attenuation.map(
            #[inline(always)]
            |v| F::splat(simd, v),
        );
        (towards, one / (a + b * distance + c * distance * distance))
    }

    /// See [`Self::spot`].
    #[inline(always)]
    fn spot_lanes<S: Simd>(&self, simd: S, towards: Vectors<S>) -> F<S> {
        if self.light.spot_cutoff == 180.0 {
            return F::splat(simd, 1.0);
        }
        let zero = F::splat(simd, 0.0);
        let away = [-towards[0], -towards[1], -towards[2]];
        let cosine = dot(away, splat_vector(simd, self.spot_direction));
        let outside = cosine.simd_lt(F::splat(simd, self.spot_cosine));
        outside.select(zero, power(simd, positive(simd, cosine), self.light.spot_exponent))
    }

    /// Half-way between light and viewer.
    #[inline(always)]
    fn half_lanes<S: Simd>(
        &self,
        simd: S,
        towards: Vectors<S>,
        at: Vectors<S>,
        local_viewer: bool,
    ) -> Vectors<S> {
        if let Some(half) = self.half {
            return splat_vector(simd, half);
        }
        let viewer = match local_viewer {
            true => normalized_or_zero(simd, [-at[0], -at[1], -at[2]]),
            false => splat_vector(simd, Vec3::Z),
        };
        normalized_or_zero(simd, [towards[0] + viewer[0], towards[1] + viewer[1], towards[2] + viewer[2]])
    }
}

#[inline(always)]
fn splat3<S: Simd>(simd: S, v: [f32; 4]) -> Vectors<S> {
    [F::splat(simd, v[0]), F::splat(simd, v[1]), F::splat(simd, v[2])]
}

#[inline(always)]
fn splat_vector<S: Simd>(simd: S, v: Vec3) -> Vectors<S> {
    [F::splat(simd, v.x), F::splat(simd, v.y), F::splat(simd, v.z)]
}

#[inline(always)]
fn dot<S: Simd>(a: Vectors<S>, b: Vectors<S>) -> F<S> {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Of length 1; zero if there is no direction.
#[inline(always)]
pub(crate) fn normalized_or_zero<S: Simd>(simd: S, v: Vectors<S>) -> Vectors<S> {
    let zero = F::splat(simd, 0.0);
    let per_length = F::splat(simd, 1.0) / dot(v, v).sqrt();
    let known = per_length.simd_gt(zero) & per_length.simd_lt(F::splat(simd, f32::INFINITY));
    [
        known.select(v[0] * per_length, zero),
        known.select(v[1] * per_length, zero),
        known.select(v[2] * per_length, zero),
    ]
}

/// At least 0; NaN becomes 0.
#[inline(always)]
fn positive<S: Simd>(simd: S, v: F<S>) -> F<S> {
    let zero = F::splat(simd, 0.0);
    v.simd_gt(zero).select(v, zero)
}

#[inline(always)]
fn clamped<S: Simd>(simd: S, v: F<S>) -> F<S> {
    positive(simd, v).min(F::splat(simd, 1.0))
}

#[inline(always)]
fn clamped3<S: Simd>(simd: S, v: Vectors<S>) -> Vectors<S> {
    [clamped(simd, v[0]), clamped(simd, v[1]), clamped(simd, v[2])]
}

/// `base` of at least 0 to the `exponent`, to some 1e-7 of the result for each power of two in it. 0 where `base` or the
/// result is below 2^-126, 1 for the exponent 0; held to 2^127.
///
/// The logarithm is the series of the area tangent around 1, the exponential that of Taylor around 0.
#[inline(always)]
fn power<S: Simd>(simd: S, base: F<S>, exponent: f32) -> F<S> {
    let one = F::splat(simd, 1.0);
    if exponent == 0.0 {
        return one;
    }
    let least = F::splat(simd, f32::MIN_POSITIVE);
    let positive = base.simd_ge(least) & base.simd_lt(F::splat(simd, f32::INFINITY));

    // 1. base = m 2^e with m from sqrt(1/2) to sqrt(2).
    let bits: i32x16<S> = positive.select(base, one).bitcast();
    let e = (bits - i32x16::splat(simd, std::f32::consts::FRAC_1_SQRT_2.to_bits() as i32)) >> 23;
    let m: F<S> = (bits - (e << 23)).bitcast();

    // 2. log2(m) = 2 / ln 2 * (s + s^3 / 3 + s^5 / 5 ...), s = (m - 1) / (m + 1).
    let s = (m - one) / (m + one);
    let s2 = s * s;
    let mut series = F::splat(simd, 1.0 / 9.0);
    for odd in [7.0, 5.0, 3.0, 1.0] {
        series = series * s2 + F::splat(simd, 1.0 / odd);
    }
    let log = e.to_float::<F<S>>() + F::splat(simd, 2.0 * std::f32::consts::LOG2_E) * s * series;

    // 3. 2^y = 2^i 2^f with f from -1/2 to 1/2.
    let y = F::splat(simd, exponent) * log;
    let positive = positive & y.simd_ge(F::splat(simd, -126.0));
    let y = positive.select(y, F::splat(simd, 0.0)).min(F::splat(simd, 127.0));
    let i = y.round_ties_even();
    let f = (y - i) * F::splat(simd, std::f32::consts::LN_2);
    let mut series = F::splat(simd, 1.0 / 7.0) * f + one;
    for n in [6.0, 5.0, 4.0, 3.0, 2.0, 1.0] {
        series = F::splat(simd, 1.0 / n) * f * series + one;
    }
    let scale: F<S> = ((i.to_int::<i32x16<S>>() + i32x16::splat(simd, 127)) << 23).bitcast();
    positive.select(series * scale, F::splat(simd, 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Context;
    use senca_math::glam::Vec4;
    use senca_raster::simd::dispatch;
    use senca_raster::{LANES, SimdLevel};

    #[test]
    fn powers_are_those_of_the_library() {
        for exponent in [0.0, 0.01, 0.5, 1.0, 2.0, 20.0, 50.5, 128.0f32] {
            for i in 0..2200 {
                let base = i as f32 / 2000.0;
                let found = dispatch!(SimdLevel::new(), simd => {
                    power(simd, F::splat(simd, base), exponent).to_array()[7]
                });
                let expected = base.powf(exponent);
                let allowed = 3e-7 * expected * (1.0 + (exponent * base.log2()).abs());
                assert!(
                    (found - expected).abs() <= allowed.max(2e-38),
                    "{base}^{exponent}: {found} {expected}"
                );
            }
        }
        let of = |base: f32, exponent: f32| dispatch!(SimdLevel::new(), simd => power(simd, F::splat(simd, base), exponent).to_array()[0]);
        assert_eq!([of(1.0, 77.0), of(0.0, 77.0), of(0.0, 0.0)], [1.0, 0.0, 1.0]);
        assert!(of(1e30, 100.0).is_finite() && of(1e30, 100.0) > 1e38);
    }

    /// Numbers without pattern from -1 to 1.
    fn numbers(seed: u32) -> impl FnMut() -> f32 {
        let mut state = seed.wrapping_mul(0x9e37_79b9) | 1;
        move || {
            state ^= state << 13;
            state ^= state >> 17;
            state ^= state << 5;
            state as f32 / u32::MAX as f32 * 2.0 - 1.0
        }
    }

    /// A context with lights, materials and models of lighting of all kinds.
    fn lit_context(seed: u32) -> Context {
        let mut next = numbers(seed);
        let mut c = Context::new(crate::Config::default());
        c.enable(gl::LIGHTING);
        let mut four = |scale: f32| [next(), next(), next(), next()].map(|v| v.abs() * scale);
        for k in 0..3 {
            let light = gl::LIGHT0 + k;
            c.enable(light);
            c.light(light, gl::AMBIENT, &four(0.2));
            c.light(light, gl::DIFFUSE, &four(1.0));
            c.light(light, gl::SPECULAR, &if seed.is_multiple_of(5) { [0.0; 4] } else { four(1.0) });
            let [x, y, z, w] = four(2.0);
            let far = if (seed + k).is_multiple_of(2) { 0.0 } else { w + 0.1 };
            c.light(light, gl::POSITION, &[x - 1.0, y - 1.0, z - 0.5, far]);
            if (seed / 2 + k).is_multiple_of(2) {
                let [x, y, z, e] = four(1.0);
                c.light(light, gl::SPOT_DIRECTION, &[x - 0.5, y - 0.5, -z]);
                c.light(light, gl::SPOT_CUTOFF, &[20.0 + 60.0 * e]);
                c.light(light, gl::SPOT_EXPONENT, &[if e > 0.3 { 30.0 * e } else { 0.0 }]);
            }
            if (seed / 3 + k).is_multiple_of(2) {
                c.light(light, gl::LINEAR_ATTENUATION, &[four(1.0)[0]]);
                c.light(light, gl::QUADRATIC_ATTENUATION, &[four(1.0)[0]]);
            }
        }
        for part in [gl::AMBIENT, gl::DIFFUSE, gl::SPECULAR, gl::EMISSION] {
            c.material(gl::FRONT_AND_BACK, part, &four(if part == gl::EMISSION { 0.1 } else { 1.0 }));
        }
        c.material(gl::FRONT_AND_BACK, gl::SHININESS, &[four(128.0)[1]]);
        c.light_model(gl::LIGHT_MODEL_LOCAL_VIEWER, &[(seed / 4 % 2) as f32]);
        if seed.is_multiple_of(3) {
            c.light_model(gl::LIGHT_MODEL_COLOR_CONTROL, &[gl::SEPARATE_SPECULAR_COLOR as f32]);
        }
        if !seed.is_multiple_of(4) {
            let modes = [gl::AMBIENT, gl::DIFFUSE, gl::SPECULAR, gl::EMISSION, gl::AMBIENT_AND_DIFFUSE];
            c.color_material(gl::FRONT_AND_BACK, modes[seed as usize % 5]);
            c.enable(gl::COLOR_MATERIAL);
        }
        c
    }

    #[test]
    fn sixteen_vertices_are_lit_as_each_of_them() {
        let mut bright = 0;
        for seed in 1..400 {
            let c = lit_context(seed);
            let plan = LightPlan::new(&c);
            let mut next = numbers(seed + 1000);
            let mut of =
                |n: usize| -> Vec<[f32; LANES]> { (0..n).map(|_| std::array::from_fn(|_| next())).collect() };
            let (mut eye, mut normal, color) = (of(4), of(3), of(4));
            eye[2].iter_mut().for_each(|z| *z -= 1.5);
            eye[3].iter_mut().for_each(|w| *w = 1.0 + 0.2 * *w);
            let [x, y, z] = &mut normal[..] else { unreachable!("three of them") };
            for ((x, y), z) in x.iter_mut().zip(y).zip(z).take(LANES - 2) {
                [*x, *y, *z] = Vec3::new(*x, *y, *z).normalize_or_zero().to_array();
            }
            (0..3).for_each(|k| normal[k][LANES - 1] = 0.0);
            let (mut found, mut second) = ([[0.0; LANES]; 4], [[0.0; LANES]; 3]);
            dispatch!(SimdLevel::new(), simd => {
                let load = |v: &[[f32; LANES]], k: usize| F::load_array(simd, v[k]);
                let lit = plan.light_lanes(
                    simd,
                    [load(&eye, 0), load(&eye, 1), load(&eye, 2), load(&eye, 3)],
                    [load(&normal, 0), load(&normal, 1), load(&normal, 2)],
                    [load(&color, 0), load(&color, 1), load(&color, 2), load(&color, 3)],
                    seed as usize % 2,
                );
                (0..4).for_each(|k| lit.color[k].store_array(&mut found[k]));
                (0..3).for_each(|k| lit.secondary[k].store_array(&mut second[k]));
            });
            for lane in 0..LANES {
                let at = |v: &[[f32; LANES]], k: usize| v[k][lane];
                let lit = plan.light(
                    Vec4::new(at(&eye, 0), at(&eye, 1), at(&eye, 2), at(&eye, 3)),
                    Vec3::new(at(&normal, 0), at(&normal, 1), at(&normal, 2)),
                    std::array::from_fn(|k| at(&color, k)),
                    seed as usize % 2,
                );
                let close = |a: f32, b: f32| (a - b).abs() <= 1e-5;
                assert!(
                    (0..4).all(|k| close(at(&found, k), lit.color[k])),
                    "{seed} {lane}: {lit:?} {found:?}"
                );
                assert!((0..3).all(|k| close(at(&second, k), lit.secondary[k])), "{seed} {lane}");
                bright += usize::from(lit.secondary[0] > 0.02 || lit.color[0] > 0.5);
            }
        }
        assert!(bright > 500, "{bright}");
    }
}
