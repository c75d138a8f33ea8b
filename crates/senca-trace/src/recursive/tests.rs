//! The worked numbers of the text, and what it leaves open.

use senca_math::glam::{DVec3, Vec3};
use senca_math::{LinearRgb, View, world_from_look_at};
use senca_scene::{
    AlphaMode, Attenuation, Background, Fog, FogFalloff, Geometry, Light, LightKind, Material, Node, Phong,
    Reflection, Scene, Shape, Transform,
};

use super::*;
use crate::TraceCounts;

/// A matt black material with light of its own, so that I_l is known.
fn glowing(light: f32) -> Material {
    let phong = Phong { ambient: LinearRgb::BLACK, diffuse: LinearRgb::BLACK, ..Phong::default() };
    Material {
        reflection: Reflection::Phong(phong),
        emission: LinearRgb::splat(light),
        double_sided: true,
        ..Material::default()
    }
}

fn mirror(light: f32, k_r: f32) -> Material {
    Material { mirror: LinearRgb::splat(k_r), ..glowing(light) }
}

fn glass(k_t: f32, ior: f32) -> Material {
    Material { transmission: LinearRgb::splat(k_t), ior, ..glowing(0.0) }
}

/// The parameter set of the text's figure 2.11.
fn figure_2_11() -> Material {
    let phong = Phong {
        ambient: LinearRgb::splat(0.4),
        diffuse: LinearRgb::splat(0.4),
        specular: LinearRgb::splat(0.6),
        exponent: 5.0,
        ..Phong::default()
    };
    Material { reflection: Reflection::Phong(phong), ..Material::default() }
}

fn add(scene: &mut Scene, shape: Shape, place: [f64; 3], material: Material) {
    let material = Some(scene.add_material(material));
    let geometry = scene.add_geometry(Geometry { name: String::new(), shape, material });
    let transform = Transform::Parts {
        translation: place.into(),
        rotation: senca_math::glam::DQuat::IDENTITY,
        scale: DVec3::ONE,
    };
    let node = scene.add_node(Node { geometry: Some(geometry), transform, ..Node::default() });
    scene.roots.push(node);
}

fn add_light(scene: &mut Scene, kind: LightKind, place: [f64; 3]) {
    let light = Light { name: "lamp".into(), color: LinearRgb::WHITE, attenuation: Attenuation::None, kind };
    scene.lights.push(light);
    let light = Some(senca_scene::LightId(scene.lights.len() as u32 - 1));
    // Lights shine down -z; these look down on y = 0.
    let down = senca_math::glam::DQuat::from_rotation_x(-std::f64::consts::FRAC_PI_2);
    let transform = Transform::Parts { translation: place.into(), rotation: down, scale: DVec3::ONE };
    let node = scene.add_node(Node { light, transform, ..Node::default() });
    scene.roots.push(node);
}

/// A square in a plane z = const, twice `half` wide, seen from both sides.
fn square(half: f64) -> Shape {
    let corner = |x: f64, y: f64| DVec3::new(x * half, y * half, 0.0);
    Shape::Polygon {
        outline: vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)],
        holes: Vec::new(),
    }
}

fn sphere(radius: f64) -> Shape {
    Shape::Sphere { radius }
}

fn fixed_depth(max_depth: u32) -> RecursiveSettings {
    RecursiveSettings { max_depth, adaptive_depth: 0.0, soft_shadows: 0, ..RecursiveSettings::default() }
}

fn view(eye: DVec3, target: DVec3) -> View {
    let frame = world_from_look_at(eye, target, DVec3::new(0.1, 1.0, 0.2)).expect("a frame");
    View::perspective(&frame, 0.6, 1.0, 0.01, None).expect("a view")
}

/// Runs `test` with a tracer for the scene.
fn with<T>(scene: &Scene, settings: &RecursiveSettings, test: impl FnOnce(&Tracer<'_>) -> T) -> T {
    let world = World::new(scene).expect("a world");
    let eye = DVec3::new(0.0, 1.0, 9.0);
    let tracer = Tracer::new(&world, &view(eye, DVec3::ZERO), [16, 16], scene.background, settings);
    test(&tracer)
}

/// What comes along a ray, and the counts, the same by both forms of the tracer.
fn traced(
    scene: &Scene,
    settings: &RecursiveSettings,
    origin: [f64; 3],
    direction: [f64; 3],
) -> (f32, TraceCounts) {
    with(scene, settings, |tracer| {
        let direction = DVec3::from_array(direction).normalize();
        let mut work = Work::default();
        let fast = tracer.light_along(Ray::new(origin.into(), direction), &mut work);
        let plain = tracer.ray_trac(origin.into(), direction, 0, &mut TraceCounts::default());
        assert!((fast[0] - plain.r).abs() <= 1e-5 * (1.0 + plain.r), "{} {}", fast[0], plain.r);
        (fast[0], work.counts)
    })
}

#[test]
fn two_facing_mirrors_add_up_the_powers_of_a_half() {
    let mut scene = Scene::default();
    add(&mut scene, square(9.0), [0.0, 0.0, -1.0], mirror(1.0, 0.5));
    add(&mut scene, square(9.0), [0.0, 0.0, 1.0], mirror(1.0, 0.5));
    for (max_depth, sum) in [(0, 1.0), (1, 1.5), (2, 1.75), (3, 1.875), (5, 1.96875)] {
        let (light, counts) = traced(&scene, &fixed_depth(max_depth), [0.0; 3], [0.0, 0.0, 1.0]);
        assert_eq!(light, sum, "MaxNest {max_depth}");
        assert_eq!(counts.rays.total(), u64::from(max_depth) + 1);
    }
}

#[test]
fn rays_double_with_every_level_at_most() {
    let mut scene = Scene::default();
    for shell in 1..=8 {
        let material = Material { mirror: LinearRgb::splat(0.5), ..glass(0.5, 1.0) };
        let size = DVec3::splat(2.0 * f64::from(shell));
        add(&mut scene, Shape::Box { size }, [0.0; 3], material);
    }
    for max_depth in 0..=5 {
        let (_, counts) = traced(&scene, &fixed_depth(max_depth), [0.0; 3], [0.3, 0.2, 1.0]);
        assert_eq!(counts.rays.total(), (1 << (max_depth + 1)) - 1, "MaxNest {max_depth}");
    }
}

/// A floor of the figure's material under a lamp, seen from above; Ia = 0.1.
fn lit_floor(kind: LightKind) -> Scene {
    let mut scene = Scene { ambient: LinearRgb::splat(0.1), ..Scene::default() };
    add(&mut scene, Shape::Plane { size: Some(20.0) }, [0.0; 3], figure_2_11());
    add_light(&mut scene, kind, [0.0, 4.0, 0.0]);
    scene
}

/// Light that a viewer at the lamp sees in the middle of the floor.
fn seen_from_above(scene: &Scene) -> f32 {
    traced(scene, &fixed_depth(0), [0.0, 1.5, 0.0], [0.0, -1.0, 0.0]).0
}

#[test]
fn blockers_count_between_the_place_and_the_light_only() {
    let lit = 1.04;
    for kind in [LightKind::Point, LightKind::Parallel, LightKind::Area { size: [0.1; 2], visible: true }] {
        let with_ball = |place: [f64; 3], material: Material| {
            let mut scene = lit_floor(kind);
            add(&mut scene, sphere(0.3), place, material);
            seen_from_above(&scene)
        };
        assert!((seen_from_above(&lit_floor(kind)) - lit).abs() < 1e-6, "nothing in the way of {kind:?}");
        assert!((with_ball([0.0, 2.5, 0.0], figure_2_11()) - 0.04).abs() < 1e-6, "between, {kind:?}");
        assert!((with_ball([0.0, -2.0, 0.0], figure_2_11()) - lit).abs() < 1e-6, "behind the place");
        assert!((with_ball([0.0, 2.5, 0.0], glass(0.5, 1.5)) - lit).abs() < 1e-6, "transparent");
        let beyond = with_ball([0.0, 6.0, 0.0], figure_2_11());
        let blocks = kind == LightKind::Parallel;
        assert!((beyond - if blocks { 0.04 } else { lit }).abs() < 1e-6, "beyond {kind:?}");
    }
    let prism = LightKind::BoxSpot { min: [-1.0; 2], max: [1.0; 2], depth: 9.0 };
    let mut scene = lit_floor(prism);
    add(&mut scene, sphere(0.3), [0.0, 6.0, 0.0], figure_2_11());
    assert!((seen_from_above(&scene) - lit).abs() < 1e-6, "beyond the plane that shines");
}

#[test]
fn transparent_shadows_have_the_colour_of_the_body() {
    let mut scene = lit_floor(LightKind::Point);
    let body = glass(0.5, 1.5);
    add(&mut scene, sphere(0.3), [0.0, 2.5, 0.0], body);
    let settings = RecursiveSettings { transparent_shadows: true, ..fixed_depth(0) };
    // Through both faces: half of a half.
    let (light, _) = traced(&scene, &settings, [0.0, 1.5, 0.0], [0.0, -1.0, 0.0]);
    assert!((light - (0.04 + 0.25)).abs() < 1e-5, "{light}");
}

#[test]
fn surfaces_with_holes_shadow_by_what_is_there() {
    let with_alpha = |alpha_mode, alpha| {
        let mut scene = lit_floor(LightKind::Point);
        let reflection = Reflection::Phong(Phong { alpha, ..Phong::default() });
        let leaf = Material { reflection, alpha_mode, double_sided: true, ..Material::default() };
        add(&mut scene, Shape::Plane { size: Some(1.0) }, [0.0, 2.0, 0.0], leaf);
        seen_from_above(&scene)
    };
    assert!((with_alpha(AlphaMode::Mask { cutoff: 0.5 }, 0.4) - 1.04).abs() < 1e-6);
    assert!((with_alpha(AlphaMode::Mask { cutoff: 0.5 }, 0.6) - 0.04).abs() < 1e-6);
    assert!((with_alpha(AlphaMode::Blend, 0.25) - (0.04 + 0.75)).abs() < 1e-6);
    assert!((with_alpha(AlphaMode::Opaque, 0.25) - 0.04).abs() < 1e-6);
}

#[test]
fn attenuation_counts_the_way_to_the_light() {
    let mut scene = lit_floor(LightKind::Point);
    scene.lights[0].attenuation = Attenuation::Polynomial { constant: 0.0, linear: 0.5, quadratic: 0.0 };
    assert!((seen_from_above(&scene) - (0.04 + 0.5)).abs() < 1e-6);
}

#[test]
fn soft_shadows_let_part_of_an_area_light_through() {
    let mut scene = lit_floor(LightKind::Area { size: [4.0, 4.0], visible: true });
    // Hides the half with x > 0 of the lamp from the middle of the floor.
    let half = Shape::Box { size: DVec3::new(10.0, 0.1, 20.0) };
    add(&mut scene, half, [5.0, 3.0, 0.0], figure_2_11());
    let settings = RecursiveSettings { soft_shadows: 8, ..fixed_depth(0) };
    let of = |scene: &Scene| {
        with(scene, &settings, |tracer| {
            let ray = Ray::new(DVec3::new(0.0, 1.5, 0.0), DVec3::NEG_Y);
            tracer.light_along(ray, &mut Work::default())[0] - 0.04
        })
    };
    let shadowed = of(&scene);
    scene.roots.pop();
    let whole = of(&scene);
    assert!((shadowed / whole - 0.5).abs() < 0.02, "{shadowed} of {whole}");
}

#[test]
fn rays_of_too_small_a_product_are_not_sent() {
    let mut scene = Scene::default();
    // Down a corridor from side to side: mirrors of 0.3, 0.5 and 0.2, then light.
    for (i, k_r) in [(0, 0.3), (1, 0.5), (2, 0.2)] {
        let (x, z) = (f64::from(i), f64::from(i % 2));
        add(&mut scene, square(0.4), [x, 0.0, z], mirror(0.0, k_r));
    }
    add(&mut scene, square(0.4), [3.0, 0.0, 1.0], glowing(1.0));
    let sent = |adaptive_depth| {
        let settings = RecursiveSettings { adaptive_depth, ..fixed_depth(9) };
        let (light, counts) = traced(&scene, &settings, [-0.5, 0.0, 0.5], [1.0, 0.0, -1.0]);
        (light, counts.rays.reflected)
    };
    assert_eq!(sent(0.05), (0.0, 2));
    let (light, reflected) = sent(0.01);
    assert!((light - 0.03).abs() < 1e-7 && reflected == 3);
}

/// A background from which the direction of a ray that leaves can be told.
fn gradient() -> Background {
    Background::Gradient { bottom: LinearRgb::BLACK, top: LinearRgb::WHITE }
}

#[test]
fn a_glass_ball_bends_as_worked_out() {
    let mut scene = Scene { background: gradient(), ..Scene::default() };
    add(&mut scene, sphere(1.0), [0.0; 3], glass(1.0, 1.5));
    let (light, counts) = traced(&scene, &fixed_depth(2), [0.0, 0.5, -3.0], [0.0, 0.0, 1.0]);
    assert!((f64::from(light) - (0.5 - 0.5 * 0.359_305_633_5)).abs() < 1e-6);
    assert_eq!((counts.rays.transmitted, counts.rays.reflected), (2, 0));
}

#[test]
fn at_total_reflection_the_transmitted_share_is_reflected() {
    let mut scene = Scene::default();
    add(
        &mut scene,
        Shape::Box { size: DVec3::splat(2.0) },
        [0.0; 3],
        Material { emission: LinearRgb::splat(1.0), ..glass(0.5, 1.5) },
    );
    // Round and round a square, at 45 degrees to every face.
    let (light, counts) = traced(&scene, &fixed_depth(3), [0.0, 0.0, 0.0], [1.0, 0.3, 0.0]);
    assert_eq!((counts.rays.transmitted, counts.rays.reflected), (1, 0), "steep rays leave");
    assert_eq!(light, 1.0);
    let (light, counts) = traced(&scene, &fixed_depth(3), [0.0, 0.0, 0.3], [1.0, 0.0, 1.0]);
    assert_eq!((counts.rays.transmitted, counts.rays.reflected), (0, 3));
    assert_eq!(light, 1.0 + 0.5 + 0.25 + 0.125);
}

#[test]
fn a_camera_inside_a_body_knows_it() {
    let mut scene = Scene { background: gradient(), ..Scene::default() };
    add(&mut scene, sphere(1.0), [0.0; 3], glass(1.0, 1.5));
    let (light, _) = traced(&scene, &fixed_depth(2), [0.0, 0.5, 0.0], [0.0, 0.0, 1.0]);
    // sin = 0.5 inside, 0.75 outside, measured from a normal that rises by 30 degrees.
    let y = (30f64.to_radians() - 0.75f64.asin()).sin();
    assert!((f64::from(light) - (0.5 + 0.5 * y)).abs() < 1e-6, "{light}");
}

#[test]
fn a_body_in_a_body_of_the_same_index_bends_nothing() {
    let mut scene = Scene { background: gradient(), ..Scene::default() };
    add(&mut scene, sphere(1.0), [0.0; 3], glass(1.0, 1.5));
    add(&mut scene, sphere(0.7), [0.1, 0.0, 0.0], glass(1.0, 1.5));
    let (light, counts) = traced(&scene, &fixed_depth(8), [0.0, 0.5, -3.0], [0.0, 0.0, 1.0]);
    assert_eq!(counts.rays.transmitted, 4);
    assert!((f64::from(light) - (0.5 - 0.5 * 0.359_305_633_5)).abs() < 1e-6);
}

#[test]
fn overlapping_bodies_belong_to_the_one_entered_last() {
    let mut scene = Scene { background: gradient(), ..Scene::default() };
    // Two slabs that overlap: parallel faces bend to and fro, so the direction stays.
    for z in [0.0, 1.0] {
        let slab = Shape::Box { size: DVec3::new(50.0, 50.0, 1.5) };
        add(&mut scene, slab, [0.0, 0.0, z], glass(1.0, 1.5 + 0.2 * z as f32));
    }
    let direction = [0.0, 0.6, 0.8];
    let (light, counts) = traced(&scene, &fixed_depth(8), [0.0, 0.0, -3.0], direction);
    assert_eq!(counts.rays.transmitted, 4);
    assert!((light - 0.8).abs() < 1e-6, "{light}");
}

#[test]
fn thin_panes_let_rays_go_straight_on() {
    let mut scene = Scene { background: gradient(), ..Scene::default() };
    add(&mut scene, square(9.0), [0.0; 3], glass(0.5, 1.5));
    let (light, _) = traced(&scene, &fixed_depth(2), [0.0, 0.0, 3.0], [0.0, 0.6, -0.8]);
    assert!((light - 0.5 * 0.8).abs() < 1e-6);
}

#[test]
fn fresnel_divides_what_comes_between_both_ways() {
    let mut scene = Scene { background: Background::Color(LinearRgb::WHITE), ..Scene::default() };
    let material = Material { mirror: LinearRgb::WHITE, fresnel: true, ..glass(1.0, 1.5) };
    add(&mut scene, sphere(1.0), [0.0; 3], material);
    for y in [0.0, 0.5, 0.9] {
        // Nothing is lost before an even background, but for what MaxNest cuts off.
        let (light, _) = traced(&scene, &fixed_depth(12), [0.0, y, 3.0], [0.0, 0.0, -1.0]);
        assert!((light - 1.0).abs() < 1e-4, "{light}");
    }
    let (light, _) = traced(&scene, &fixed_depth(0), [0.0, 0.0, 3.0], [0.0, 0.0, -1.0]);
    assert_eq!(light, 0.0);
}

#[test]
fn absorption_counts_the_way_inside() {
    let mut scene = Scene { background: Background::Color(LinearRgb::WHITE), ..Scene::default() };
    let material = Material { absorption: LinearRgb::new(0.25, 0.0, 0.0), ..glass(1.0, 1.5) };
    add(&mut scene, sphere(1.0), [0.0; 3], material);
    let (light, _) = traced(&scene, &fixed_depth(2), [0.0, 0.0, 3.0], [0.0, 0.0, -1.0]);
    assert!((light - (-0.5f32).exp()).abs() < 1e-6);
}

#[test]
fn fog_counts_the_way_along_all_rays() {
    let fog = Fog { color: LinearRgb::splat(0.5), falloff: FogFalloff::Exponential { density: 0.1 } };
    let mut scene = Scene { fog: Some(fog), ..Scene::default() };
    add(&mut scene, square(9.0), [0.0, 0.0, -1.0], mirror(0.0, 1.0));
    add(&mut scene, square(9.0), [0.0, 0.0, 4.0], glowing(1.0));
    let (light, _) = traced(&scene, &fixed_depth(1), [0.0; 3], [0.0, 0.0, -1.0]);
    let mu = (-0.6f32).exp();
    assert!((light - (mu + 0.5 * (1.0 - mu))).abs() < 1e-6, "{light}");
}

#[test]
fn light_by_way_of_a_mirror_does_not_reach_a_matt_place() {
    let mut scene = lit_floor(LightKind::Point);
    add(&mut scene, sphere(0.3), [0.0, 2.5, 0.0], figure_2_11());
    // Would throw light into the shadow.
    add(&mut scene, square(5.0), [0.0, 2.0, -2.0], mirror(0.0, 1.0));
    let (light, _) = traced(&scene, &fixed_depth(5), [0.0, 1.5, 0.0], [0.0, -1.0, 0.0]);
    assert!((light - 0.04).abs() < 1e-6, "only Ia Oa");
}

#[test]
fn a_mirror_box_may_be_as_deep_as_a_million() {
    let mut scene = Scene::default();
    let glow = 1.0 / 1024.0;
    add(&mut scene, Shape::Box { size: DVec3::splat(2.0) }, [0.0; 3], mirror(glow, 1.0));
    with(&scene, &fixed_depth(1_000_000), |tracer| {
        let mut work = Work::default();
        let ray = Ray::new(DVec3::new(0.1, 0.2, 0.3), DVec3::new(0.36, 0.48, 0.8));
        let light = tracer.light_along(ray, &mut work)[0];
        assert_eq!(work.counts.rays.reflected, 1_000_000);
        assert!((light - 1_000_001.0 * glow).abs() < 2.0, "{light}");
    });
}

#[test]
fn trees_that_never_end_are_cut() {
    let mut scene = Scene::default();
    let material = Material { mirror: LinearRgb::WHITE, ..glass(1.0, 1.0) };
    for z in [-1.0, 1.0] {
        add(&mut scene, Shape::Box { size: DVec3::ONE }, [0.0, 0.0, z], material.clone());
    }
    with(&scene, &fixed_depth(1_000_000), |tracer| {
        let mut work = Work::default();
        let ray = Ray::new(DVec3::new(0.0, 0.1, -1.1), DVec3::new(0.0, 0.01, 1.0).normalize());
        let light = tracer.light_along(ray, &mut work);
        assert!(work.counts.rays.total() <= u64::from(MAX_RAYS_PER_SAMPLE));
        assert!(light[0].is_finite());
    });
}

#[test]
fn what_is_not_a_ray_and_what_is_not_a_scene_is_black() {
    let empty = Scene::default();
    with(&empty, &fixed_depth(3), |tracer| {
        let along = |origin, direction| tracer.light_along(Ray::new(origin, direction), &mut Work::default());
        assert_eq!(along(DVec3::ZERO, DVec3::Z), [0.0; 4]);
    });
    let mut scene = Scene::default();
    add(&mut scene, sphere(1.0), [0.0; 3], mirror(1.0, 1.0));
    with(&scene, &fixed_depth(3), |tracer| {
        for (origin, direction) in [
            (DVec3::splat(f64::NAN), DVec3::Z),
            (DVec3::Z * 4.0, DVec3::NAN),
            (DVec3::Z * 4.0, DVec3::ZERO),
            (DVec3::splat(f64::INFINITY), DVec3::NEG_ONE),
        ] {
            let light = tracer.light_along(Ray::new(origin, direction), &mut Work::default());
            assert_eq!(light, [0.0; 4], "{origin} {direction}");
        }
    });
}

#[test]
fn surfaces_that_are_there_in_part_lie_over_what_is_behind() {
    let mut scene = Scene::default();
    let blended = |light, alpha| Material {
        alpha_mode: AlphaMode::Blend,
        emission: LinearRgb::splat(light),
        reflection: Reflection::Phong(Phong {
            alpha,
            ambient: LinearRgb::BLACK,
            diffuse: LinearRgb::BLACK,
            ..Phong::default()
        }),
        double_sided: true,
        ..Material::default()
    };
    add(&mut scene, square(9.0), [0.0, 0.0, 2.0], blended(0.5, 0.25));
    add(&mut scene, square(9.0), [0.0, 0.0, 1.0], blended(1.0, 0.5));
    with(&scene, &fixed_depth(0), |tracer| {
        let ray = Ray::new(DVec3::new(0.0, 0.0, 5.0), DVec3::NEG_Z);
        let [light, _, _, alpha] = tracer.light_along(ray, &mut Work::default());
        assert_eq!(light, 0.25 * 0.5 + 0.75 * 0.5);
        assert_eq!(alpha, 0.25 + 0.75 * 0.5);
    });
}

#[test]
fn backs_are_seen_as_the_settings_say() {
    let mut scene = Scene::default();
    let one_sided = Material { double_sided: false, ..glowing(1.0) };
    add(&mut scene, square(9.0), [0.0; 3], one_sided);
    for (backs, from_behind) in [(Backs::ByMaterial, 0.0), (Backs::Hidden, 0.0), (Backs::Shown, 1.0)] {
        let settings = RecursiveSettings { backs, ..fixed_depth(0) };
        assert_eq!(traced(&scene, &settings, [0.0, 0.0, -3.0], [0.0, 0.0, 1.0]).0, from_behind);
        assert_eq!(traced(&scene, &settings, [0.0, 0.0, 3.0], [0.0, 0.0, -1.0]).0, 1.0);
    }
}

#[test]
fn both_forms_agree_on_balls_of_glass_and_mirrors() {
    let mut scene = Scene { background: gradient(), ambient: LinearRgb::splat(0.1), ..Scene::default() };
    add(&mut scene, Shape::Plane { size: Some(30.0) }, [0.0, -1.0, 0.0], figure_2_11());
    for i in 0..9 {
        let (x, z) = (f64::from(i % 3) - 1.0, f64::from(i / 3) - 1.0);
        let material = Material {
            fresnel: i % 2 == 0,
            mirror: LinearRgb::new(0.3, 0.4, 0.5),
            transmission: LinearRgb::splat(if i % 3 == 0 { 0.5 } else { 0.0 }),
            ..figure_2_11()
        };
        add(&mut scene, sphere(0.45), [x, 0.0, z], material);
    }
    add_light(&mut scene, LightKind::Point, [3.0, 5.0, 4.0]);
    add_light(&mut scene, LightKind::Parallel, [0.0, 5.0, 0.0]);
    for i in 0..200u32 {
        let around = f64::from(i) * 0.7;
        let direction = [0.3 * around.sin(), -0.25 + 0.15 * (around * 0.3).cos(), -1.0];
        traced(
            &scene,
            &RecursiveSettings { max_depth: 6, soft_shadows: 0, ..Default::default() },
            [0.0, 1.0, 4.0],
            direction,
        );
    }
}

#[test]
fn lights_have_names_and_normals_face_the_ray() {
    let scene = lit_floor(LightKind::Point);
    with(&scene, &fixed_depth(0), |tracer| {
        assert_eq!(tracer.light_names(), ["lamp"]);
        assert!(tracer.is_transparent());
        let mut ray = Ray::new(DVec3::new(0.0, 3.0, 0.0), DVec3::NEG_Y);
        let seen = tracer.see(&mut ray, &mut TraceCounts::default()).expect("the floor");
        assert_eq!(seen.material.normal, Vec3::Y);
    });
}

/// Knows one answer.
struct Everywhere(KnownLight);

impl SurfaceLight for Everywhere {
    fn at(&self, _: &crate::Interaction, _: &crate::MaterialPoint) -> KnownLight {
        self.0
    }
}

#[test]
fn light_that_is_known_takes_the_place_of_the_ambient_light() {
    let mut scene = lit_floor(LightKind::Point);
    scene.ambient = LinearRgb::splat(100.0);
    let world = World::new(&scene).expect("a world");
    let size = [16, 16];
    let seen = |light: Option<KnownLight>, max_depth| {
        let known = light.map(Everywhere);
        let eye = view(DVec3::new(0.0, 3.0, 0.01), DVec3::ZERO);
        let mut tracer = Tracer::new(&world, &eye, size, Background::None, &fixed_depth(max_depth));
        if let Some(known) = &known {
            tracer = tracer.with_surface_light(known);
        }
        let ray = Ray::new(DVec3::new(0.1, 0.5, 0.1), DVec3::NEG_Y);
        let fast = LinearRgb::from_array(
            *tracer.light_along(ray, &mut Work::default()).first_chunk::<3>().expect("three of four"),
        );
        let plain = tracer.ray_trac(ray.origin, ray.direction, 0, &mut TraceCounts::default());
        assert!((fast.r - plain.r).abs() < 1e-5, "{fast:?} and {plain:?}");
        fast.r
    };
    let diffuse = 0.4;
    let arriving = |light| seen(Some(KnownLight::Arriving(LinearRgb::splat(light))), 0);
    let lamp = arriving(0.0);
    assert!(lamp > 0.0 && (seen(None, 0) - lamp - diffuse * 100.0).abs() < 1e-4);
    assert!((arriving(0.5) - lamp - diffuse * 0.5).abs() < 1e-5);
    assert_eq!(seen(Some(KnownLight::Leaving(LinearRgb::splat(0.3))), 0), 0.3);
}
