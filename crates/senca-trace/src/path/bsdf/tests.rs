//! Energy, reciprocity and densities of every kind of surface.

use super::*;
use crate::{Pattern, Sampler};
use senca_math::glam::Vec3;
use senca_shading::{MetallicRoughnessConstants, PhongConstants, metallic_roughness_brdf};

fn phong(diffuse: f32, specular: f32, exponent: f32) -> MaterialPoint {
    let constants = PhongConstants {
        ambient: LinearRgb::BLACK,
        diffuse: LinearRgb::splat(diffuse),
        specular: LinearRgb::splat(specular),
        exponent,
    };
    point(ReflectionPoint::Phong(constants))
}

fn gltf(base: LinearRgb, metallic: f32, roughness: f32) -> MaterialPoint {
    point(ReflectionPoint::MetallicRoughness { base_color: base, metallic, roughness })
}

fn point(reflection: ReflectionPoint) -> MaterialPoint {
    MaterialPoint {
        reflection,
        normal: Vec3::Z,
        emission: LinearRgb::BLACK,
        coverage: 1.0,
        occlusion: 1.0,
        mirror: LinearRgb::BLACK,
        sharpness: 0.0,
        transmission: LinearRgb::BLACK,
        ior: 1.5,
        absorption: LinearRgb::BLACK,
        fresnel: false,
        double_sided: false,
    }
}

/// Glass with border roughness, which lets all light through that it does not reflect.
fn rough_glass(roughness: f32) -> MaterialPoint {
    MaterialPoint { transmission: LinearRgb::WHITE, ..gltf(LinearRgb::WHITE, 0.0, roughness) }
}

fn smooth_glass() -> MaterialPoint {
    MaterialPoint {
        mirror: LinearRgb::WHITE,
        transmission: LinearRgb::WHITE,
        fresnel: true,
        ..phong(0.0, 0.0, 1.0)
    }
}

/// Unit direction by its angle from the normal in degrees and its azimuth in radians.
fn towards(degrees: f64, azimuth: f64) -> DVec3 {
    let (sin, cos) = degrees.to_radians().sin_cos();
    DVec3::new(sin * azimuth.cos(), sin * azimuth.sin(), cos)
}

fn seen(point: &MaterialPoint, view: DVec3, eta: f64) -> Bsdf {
    Bsdf::new(point, DVec3::Z, view, Border { eta, thin: false })
}

/// A rough pane without a body behind it.
fn pane(view: DVec3) -> Bsdf {
    Bsdf::new(&rough_glass(0.2), DVec3::Z, view, Border { eta: 1.5, thin: true })
}

fn samples(bsdf: &Bsdf, n: u32) -> impl Iterator<Item = Option<Chosen>> {
    (0..n).map(move |i| {
        let mut sampler = Sampler::new(Pattern::Sobol, 11, 0, 0, i);
        bsdf.sample(sampler.next_1d(), sampler.next_2d())
    })
}

/// What an even environment of radiance 1 looks like; light gathered by a medium is counted as it was
/// before.
fn albedo(bsdf: &Bsdf, n: u32) -> f64 {
    let weight = |c: Option<Chosen>| c.map_or(0.0, |c| mean(c.weight) / c.gathered);
    samples(bsdf, n).map(weight).sum::<f64>() / f64::from(n)
}

fn rough_surfaces() -> Vec<(&'static str, MaterialPoint, f64)> {
    let orange = LinearRgb::new(0.9, 0.5, 0.1);
    vec![
        ("matt", phong(0.8, 0.0, 1.0), 1.5),
        ("phong", phong(0.3, 0.6, 12.0), 1.5),
        ("wide phong", phong(0.0, 1.0, 1.0), 1.5),
        ("plastic", gltf(orange, 0.0, 0.5), 1.5),
        ("metal", gltf(orange, 1.0, 0.6), 1.5),
        ("mixed", gltf(orange, 0.5, 0.8), 1.5),
        ("rough glass", rough_glass(0.6), 1.5),
        ("inside rough glass", rough_glass(0.6), 1.0 / 1.5),
        ("tinted", MaterialPoint { transmission: orange * 0.5, ..gltf(orange, 0.2, 0.7) }, 1.3),
    ]
}

#[test]
fn white_surfaces_in_a_white_furnace_vanish() {
    for degrees in [0.0, 30.0, 70.0, 85.0] {
        let view = towards(degrees, 0.3);
        let of = |point: &MaterialPoint, eta| albedo(&seen(point, view, eta), 4096);
        assert!((of(&phong(1.0, 0.0, 1.0), 1.5) - 1.0).abs() < 1e-5);
        let mirror = MaterialPoint { mirror: LinearRgb::WHITE, ..phong(0.0, 0.0, 1.0) };
        assert!((of(&mirror, 1.5) - 1.0).abs() < 1e-5);
        assert!((of(&smooth_glass(), 1.5) - 1.0).abs() < 1e-5);
        assert!((of(&smooth_glass(), 1.0 / 1.5) - 1.0).abs() < 1e-5);
        // Single scattering between facets loses what hits twice; nearly nothing where they are flat.
        for roughness in [0.1, 0.2] {
            let metal = of(&gltf(LinearRgb::WHITE, 1.0, roughness), 1.5);
            let least = if degrees > 80.0 { 0.9 } else { 0.98 };
            assert!(metal > least && metal < 1.0 + 1e-4, "metal, {roughness}, {degrees}: {metal}");
            let glass = of(&rough_glass(roughness), 1.5);
            assert!(glass > least && glass < 1.0 + 1e-4, "glass, {roughness}, {degrees}: {glass}");
        }
    }
}

#[test]
fn no_surface_sends_out_more_than_came_in() {
    for (name, point, eta) in rough_surfaces() {
        for degrees in [0.0, 40.0, 60.0, 80.0, 89.0] {
            let sum = albedo(&seen(&point, towards(degrees, 1.0), eta), 4096);
            assert!(sum > 0.0 && sum < 1.003, "{name} at {degrees}: {sum}");
        }
    }
    // Coefficients that promise too much are scaled.
    let greedy =
        MaterialPoint { mirror: LinearRgb::WHITE, transmission: LinearRgb::WHITE, ..phong(0.8, 0.9, 5.0) };
    let sum = albedo(&seen(&greedy, towards(20.0, 0.0), 1.5), 4096);
    assert!(sum > 0.8 && sum < 1.003, "{sum}");
}

#[test]
fn reflection_is_the_same_both_ways() {
    for (name, point, eta) in rough_surfaces() {
        for (a, b) in [(10.0, 50.0), (35.0, 70.0), (80.0, 20.0)] {
            let (view, light) = (towards(a, 0.2), towards(b, 1.9));
            let there = seen(&point, view, eta).eval(light).value * (1.0 / light.z) as f32;
            let back = seen(&point, light, eta).eval(view).value * (1.0 / view.z) as f32;
            let error = (there - back).map(f32::abs).max_component();
            assert!(error <= 1e-5 * (1.0 + there.max_component()), "{name}: {there:?} {back:?}");
        }
    }
}

#[test]
fn refraction_is_the_same_both_ways_but_for_the_square_of_the_index() {
    let eta = 1.5;
    let glass = rough_glass(0.5);
    let (view, light) = (towards(40.0, 0.0), -towards(20.0, 0.3));
    let there = seen(&glass, view, eta).eval(light).value.r / light.z.abs() as f32;
    // The other way round the surface is seen from below.
    let below = MaterialPoint { normal: Vec3::NEG_Z, ..glass };
    let back =
        Bsdf::new(&below, DVec3::NEG_Z, light, Border { eta: 1.0 / eta, thin: false }).eval(view).value.r
            / view.z as f32;
    assert!(there > 0.01, "{there}");
    assert!((there * (eta * eta) as f32 - back).abs() < 1e-4 * back, "{there} {back}");
}

/// Bins of the sphere: `ROWS` of equal z times `COLUMNS` of equal azimuth.
const ROWS: usize = 16;
const COLUMNS: usize = 12;

fn bin(w: DVec3) -> usize {
    let row = ((0.5 * (w.z + 1.0) * ROWS as f64) as usize).min(ROWS - 1);
    let column = ((w.y.atan2(w.x) / TAU + 0.5) * COLUMNS as f64) as usize;
    row * COLUMNS + column.min(COLUMNS - 1)
}

/// Integrals of the density over the bins.
fn expected(bsdf: &Bsdf) -> Vec<f64> {
    let fine = 24;
    let mut bins = vec![0.0; ROWS * COLUMNS];
    let (rows, columns) = (ROWS * fine, COLUMNS * fine);
    let cell = 2.0 / rows as f64 * TAU / columns as f64;
    for i in 0..rows {
        let z = -1.0 + 2.0 * (i as f64 + 0.5) / rows as f64;
        let across = (1.0 - z * z).sqrt();
        for j in 0..columns {
            let azimuth = TAU * ((j as f64 + 0.5) / columns as f64 - 0.5);
            let w = DVec3::new(across * azimuth.cos(), across * azimuth.sin(), z);
            bins[bin(w)] += bsdf.eval(w).pdf * cell;
        }
    }
    bins
}

#[test]
fn directions_are_taken_as_often_as_their_density_says() {
    let n = 1 << 14;
    for (name, point, eta) in rough_surfaces() {
        for degrees in [15.0, 65.0] {
            let bsdf = seen(&point, towards(degrees, 0.4), eta);
            let expected = expected(&bsdf);
            let mut found = vec![0.0; ROWS * COLUMNS];
            for chosen in samples(&bsdf, n).flatten() {
                let pdf = chosen.pdf.expect("no single directions");
                assert!((bsdf.eval(chosen.direction).pdf - pdf).abs() <= 1e-6 * pdf);
                found[bin(chosen.direction)] += 1.0 / f64::from(n);
            }
            let total: f64 = expected.iter().sum();
            assert!(total < 1.005 && total > 0.7, "{name} at {degrees}: density adds up to {total}");
            for (i, (e, f)) in expected.iter().zip(&found).enumerate() {
                let noise = (e / f64::from(n)).sqrt();
                assert!(
                    (e - f).abs() < 4.0 * noise + 0.03 * e + 1e-3,
                    "{name} at {degrees}, bin {i}: {f}, not {e}"
                );
            }
        }
    }
}

#[test]
fn facets_are_those_of_the_other_renderers() {
    let base = LinearRgb::new(0.9, 0.5, 0.1);
    for (metallic, roughness) in [(0.0, 0.4), (1.0, 0.2), (0.3, 1.0), (1.0, 0.0)] {
        let constants = MetallicRoughnessConstants::new(base, metallic, roughness);
        for (a, b) in [(0.0, 10.0), (30.0, 35.0), (50.0, 50.0), (75.0, 20.0)] {
            let (view, light) = (towards(a, 0.0), towards(b, 3.0));
            let ours = seen(&gltf(base, metallic, roughness), view, 1.5).eval(light).value;
            let theirs = metallic_roughness_brdf(&constants, Vec3::Z, light.as_vec3(), view.as_vec3())
                * light.z as f32;
            let error = (ours - theirs).map(f32::abs).max_component();
            assert!(error < 2e-3 * (theirs.max_component() + 0.01), "{ours:?} {theirs:?}");
        }
    }
}

#[test]
fn nothing_leaks_through_a_bent_normal() {
    let leaning = MaterialPoint { normal: Vec3::new(0.9, 0.0, 0.436), ..phong(1.0, 0.0, 1.0) };
    let bsdf = seen(&leaning, towards(30.0, 0.0), 1.5);
    let below = DVec3::new(0.95, 0.0, -0.312);
    assert!(bsdf.local(below).z > 0.0, "the shading normal would allow it");
    assert_eq!(bsdf.eval(below), NOTHING);
    assert!(samples(&bsdf, 512).flatten().all(|chosen| chosen.direction.z > 0.0));
    // Seen from where the mapped normal faces away.
    let behind = seen(&leaning, DVec3::new(-0.9, 0.0, 0.436).normalize(), 1.5);
    assert!(samples(&behind, 64).flatten().all(|c| c.weight.is_finite() && c.direction.is_finite()));
}

#[test]
fn refraction_follows_snell_and_gathers_light() {
    let bsdf = seen(&smooth_glass(), towards(40.0, 0.0), 1.5);
    let through: Vec<_> = samples(&bsdf, 64).flatten().filter(|c| c.through).collect();
    assert!(through.len() > 50);
    let sin = (1.0 - through[0].direction.z.powi(2)).sqrt();
    assert!((sin - 40f64.to_radians().sin() / 1.5).abs() < 1e-12);
    assert!((through[0].gathered - 1.0 / 2.25).abs() < 1e-12);
    let inside = seen(&smooth_glass(), towards(45.0, 0.0), 1.0 / 1.5);
    assert!(samples(&inside, 64).flatten().all(|c| !c.through && (mean(c.weight) - 1.0).abs() < 1e-6));
}

#[test]
fn panes_bend_nothing_and_lose_nothing() {
    let view = towards(40.0, 0.0);
    let smooth = Bsdf::new(&smooth_glass(), DVec3::Z, view, Border { eta: 1.5, thin: true });
    let through = samples(&smooth, 64).flatten().find(|c| c.through).expect("goes through");
    assert!(through.direction.abs_diff_eq(-view, 1e-12) && through.gathered == 1.0);
    assert!((albedo(&smooth, 1024) - 1.0).abs() < 1e-5);
    let rough = pane(view);
    let sum = albedo(&rough, 4096);
    assert!(sum > 0.97 && sum < 1.001, "{sum}");
    let (there, back) = (towards(30.0, 1.0), towards(60.0, 2.0));
    let below = DVec3::new(1.0, 1.0, -1.0);
    let one = pane(there).eval(back * below).value.r * (1.0 / back.z) as f32;
    let other = pane(back).eval(there * below).value.r * (1.0 / there.z) as f32;
    assert!((one - other).abs() < 1e-5 * (1.0 + one));
}

#[test]
fn black_surfaces_swallow_everything() {
    let bsdf = seen(&phong(0.0, 0.0, 1.0), DVec3::Z, 1.5);
    assert!(!bsdf.scatters() && samples(&bsdf, 8).all(|c| c.is_none()));
}
