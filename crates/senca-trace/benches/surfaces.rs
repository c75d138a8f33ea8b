//! Time per ray of every exact surface: a thousand rays through its box, about half of which hit.

use divan::{Bencher, black_box};
use senca_math::Aabb;
use senca_math::glam::{DMat4, DVec2, DVec3};
use senca_scene::Shape;
use senca_trace::{
    Counters, CsgBuilder, Cuboid, Implicit, Intersect, Operation, Ray, RootMethod, Sphere, surface_of,
};

fn main() {
    divan::main();
}

/// A number in -1 to 1, the same in every run.
fn next(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

/// Rays from a sphere around the unit box around (0, 0.5, 0) through places in it.
fn rays() -> Vec<Ray> {
    let mut state = 7;
    let mut place = || DVec3::new(next(&mut state), next(&mut state), next(&mut state));
    let ray = |target: DVec3, from: DVec3| {
        let origin = 5.0 * from.normalize_or(DVec3::X);
        let target = 1.2 * target + 0.5 * DVec3::Y;
        Ray::new(origin, (target - origin).normalize())
    };
    (0..1000).map(|_| (place(), place())).map(|(target, from)| ray(target, from)).collect()
}

fn vase() -> Vec<DVec2> {
    let points = [(0.0, 0.0), (0.5, 0.0), (1.4, -0.1), (1.3, 0.6), (1.2, 1.3), (0.1, 1.2), (0.4, 1.8)];
    points.map(|(x, y)| DVec2::new(x, y)).to_vec()
}

fn star() -> Vec<DVec2> {
    let corner = |i: u32| DVec2::from_angle(f64::from(i) * 0.1 * std::f64::consts::PI);
    (0..20).map(|i| if i % 2 == 0 { corner(i) } else { 0.5 * corner(i) }).collect()
}

fn shapes() -> Vec<(&'static str, Shape)> {
    let tau = std::f64::consts::TAU;
    vec![
        ("sphere", Shape::Sphere { radius: 1.0 }),
        ("ellipsoid", Shape::Ellipsoid { radii: DVec3::new(0.7, 1.0, 1.2) }),
        ("box", Shape::Box { size: DVec3::new(1.0, 2.0, 1.5) }),
        ("cylinder", Shape::Cylinder { radius: 0.8, height: 1.2, capped: true }),
        ("cone", Shape::Cone { radius: 1.0, top_radius: 0.2, height: 1.5, capped: true }),
        ("torus", Shape::Torus { major_radius: 0.9, minor_radius: 0.4 }),
        ("disc", Shape::Disc { radius: 1.0, inner_radius: 0.2 }),
        (
            "polygon",
            Shape::Polygon { outline: star().iter().map(|p| p.extend(0.0)).collect(), holes: vec![] },
        ),
        ("prism", Shape::Prism { base: star(), height: 1.0, capped: true }),
        ("lathe", Shape::Revolution { profile: vase(), bezier: false, angle: tau, capped: true }),
        ("bezier lathe", Shape::Revolution { profile: vase(), bezier: true, angle: tau, capped: true }),
    ]
}

const NAMES: [&str; 16] = [
    "sphere",
    "ellipsoid",
    "box",
    "cylinder",
    "cone",
    "torus",
    "disc",
    "polygon",
    "prism",
    "lathe",
    "bezier lathe",
    "quartic descartes",
    "quartic sturm",
    "quartic closed form",
    "gyroid",
    "csg",
];

fn formula(text: &str, method: RootMethod) -> Box<dyn Intersect> {
    let bounds = Aabb { min: DVec3::splat(-1.3), max: DVec3::splat(1.3) };
    let surface = Implicit::new(text.parse().expect("a formula"), bounds, true).expect("a box");
    Box::new(surface.with_method(method))
}

const TORUS: &str = "(x^2 + y^2 + z^2 + 0.65)^2 - 3.24*(x^2 + z^2)";
const GYROID: &str = "sin(5*x)*cos(5*y) + sin(5*y)*cos(5*z) + sin(5*z)*cos(5*x)";

fn csg() -> Box<dyn Intersect> {
    let mut builder = CsgBuilder::new();
    builder.open(Operation::Difference).expect("open");
    builder.leaf(Box::new(Cuboid::new(DVec3::splat(1.5))), DMat4::IDENTITY).expect("a box");
    builder.leaf(Box::new(Sphere::new(0.95)), DMat4::IDENTITY).expect("a ball");
    builder.leaf(Box::new(Sphere::new(0.3)), DMat4::from_translation(DVec3::ONE)).expect("a ball");
    builder.close().expect("closed");
    Box::new(builder.finish().expect("a body"))
}

fn surface(name: &str) -> Box<dyn Intersect> {
    match name {
        "quartic descartes" => formula(TORUS, RootMethod::Descartes),
        "quartic sturm" => formula(TORUS, RootMethod::Sturm),
        "quartic closed form" => formula(TORUS, RootMethod::ClosedForm),
        "gyroid" => formula(GYROID, RootMethod::Automatic),
        "csg" => csg(),
        _ => {
            let shapes = Box::leak(Box::new(shapes()));
            let (_, shape) = shapes.iter().find(|(known, _)| *known == name).expect("a shape");
            surface_of(shape, &mut |_| unreachable!("no meshes here")).expect("a surface")
        }
    }
}

#[divan::bench(args = NAMES)]
fn closest_of_1000_rays(bencher: Bencher, name: &str) {
    let (surface, rays) = (surface(name), rays());
    bencher.bench_local(|| {
        let mut counters = Counters::default();
        black_box(&rays)
            .iter()
            .filter_map(|ray| surface.closest(ray, &mut counters))
            .map(|c| c.t)
            .sum::<f64>()
    });
}

#[divan::bench(args = NAMES)]
fn points_of_1000_hits(bencher: Bencher, name: &str) {
    let surface = surface(name);
    let mut counters = Counters::default();
    let hits: Vec<_> =
        rays().into_iter().filter_map(|ray| Some((ray, surface.closest(&ray, &mut counters)?))).collect();
    let hits: Vec<_> = hits.iter().cycle().take(1000).collect();
    bencher.bench_local(|| {
        hits.iter().map(|(ray, crossing)| surface.surface_point(ray, crossing).texcoords[0].x).sum::<f64>()
    });
}
