use std::sync::atomic::{AtomicBool, Ordering};

use senca_math::glam::DVec3;
use senca_scene::{Attenuation, Light, LightId, LightKind, Material, Node, Phong, Reflection, Shape};

use super::*;
use crate::MeshSettings;

const BLACK: LinearRgb = LinearRgb::BLACK;

fn grey(v: f32) -> LinearRgb {
    LinearRgb::splat(v)
}

/// Faces of a box that look inwards (or outwards): x low, x high, y low, y high, z low, z high.
fn faces(min: [f64; 3], max: [f64; 3], inwards: bool) -> Vec<[DVec3; 4]> {
    let corner = |i: usize| {
        let pick = |k: usize| if i >> k & 1 == 1 { max[k] } else { min[k] };
        DVec3::new(pick(0), pick(1), pick(2))
    };
    [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]]
        .map(|face| {
            let mut corners = face.map(corner);
            if inwards {
                corners.reverse();
            }
            corners
        })
        .to_vec()
}

type Face = ([DVec3; 4], LinearRgb, LinearRgb);

fn mesh_of(faces: &[Face]) -> ElementMesh {
    let polygons: Vec<_> = faces.iter().map(|(corners, rho, e)| (&corners[..], *rho, *e)).collect();
    ElementMesh::of_polygons(&polygons)
}

fn cube_with(rho: f32, emission: [f32; 6]) -> Vec<Face> {
    let corners = faces([0.0; 3], [1.0; 3], true);
    corners.into_iter().zip(emission).map(|(face, e)| (face, grey(rho), grey(e))).collect()
}

fn no_lamps() -> DirectLight {
    DirectLight::of_scene(&Scene::default(), &Default::default()).expect("in range")
}

fn solve_faces(faces: &[Face], size: f64, settings: &BookSettings) -> Solved {
    let mut mesh = mesh_of(faces);
    mesh.divide_to_size(size, 1 << 20).expect("few");
    solve_mesh(mesh, &no_lamps(), settings, &Control::default(), |_| ()).expect("solved")
}

fn radiosities(solved: &Solved) -> Vec<f32> {
    let solution = &solved.solution;
    solution.mesh.leaves().map(|leaf| solution.radiosity(leaf).r).collect()
}

/// A room with two floating blocks, and a lamp below the ceiling.
fn furnished(rho: f32, emission: f32, lamp: f32) -> Vec<Face> {
    let mut all: Vec<Face> =
        faces([0.0; 3], [2.0; 3], true).into_iter().map(|f| (f, grey(rho), grey(emission))).collect();
    for (min, max) in [([0.3, 0.1, 0.3], [0.8, 1.2, 0.9]), ([1.1, 0.3, 1.0], [1.6, 0.8, 1.5])] {
        all.extend(faces(min, max, false).into_iter().map(|f| (f, grey(rho), grey(emission))));
    }
    if lamp > 0.0 {
        let panel = [[0.7, 1.3], [1.3, 1.3], [1.3, 0.7], [0.7, 0.7]];
        let mut corners = panel.map(|[x, z]| DVec3::new(x, 1.99, z));
        all.push((corners, grey(rho), BLACK));
        corners.reverse();
        all.push((corners, grey(rho), grey(lamp)));
    }
    all
}

#[test]
fn the_inside_of_a_cube_with_six_patches() {
    let settings = BookSettings { rounds: 0, ..BookSettings::default() };
    let faces = cube_with(0.5, [1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let solved = solve_faces(&faces, 1.5, &settings);
    let other = 0.181_836_27;
    let expected = [1.090_909_1, 0.181_745_83, other, other, other, other];
    for (found, expected) in radiosities(&solved).iter().zip(expected) {
        assert!((found - expected).abs() < 2e-6, "{found}, not {expected}");
    }
    assert!(solved.report.largest_row_sum < 1.0 + 1e-6 && solved.solution.report.converged);
    assert_eq!((solved.report.equations, solved.report.factors), (6, 30));
}

#[test]
fn a_closed_box_is_a_furnace() {
    for rho in [0.5, 0.9] {
        let settings = BookSettings { rounds: 1, ..BookSettings::default() };
        for solved in [
            solve_faces(&cube_with(rho, [1.0; 6]), 0.3, &settings),
            solve_faces(&furnished(rho, 1.0, 0.0), 0.7, &settings),
        ] {
            let expected = 1.0 / (1.0 - rho);
            for found in radiosities(&solved) {
                assert!(
                    (found / expected - 1.0).abs() < 1e-4,
                    "{found}, not {expected}, {:?}",
                    solved.report
                );
            }
            assert!(solved.solution.report.energy_error < 1e-3);
        }
    }
}

#[test]
fn half_cubes_agree_with_rays() {
    let settings = |factors| BookSettings { rounds: 1, factors, ..BookSettings::default() };
    let by = |factors| solve_faces(&furnished(0.6, 0.0, 5.0), 0.7, &settings(factors));
    let (rays, cubes) = (by(FactorMethod::RayCast { rays: 64 }), by(FactorMethod::HEMICUBE));
    assert!(cubes.solution.report.energy_error < 1e-3);
    let polygons = rays.solution.mesh.polygons().len();
    let [a, b] = [&rays, &cubes].map(|solved| &solved.solution.incident[..polygons]);
    let mean = a.iter().map(|h| h.r).sum::<f32>() / polygons as f32;
    for (i, (a, b)) in a.iter().zip(b).enumerate() {
        assert!((a.r - b.r).abs() < 0.05 * mean.max(a.r), "polygon {i}: {} {}", a.r, b.r);
    }
}

#[test]
fn the_inside_of_a_ball_is_a_furnace() {
    let mut scene = Scene::of_shape("ball", Shape::Sphere { radius: 1.0 });
    let reflection = Reflection::Phong(Phong { diffuse: grey(0.8), ..Phong::default() });
    let material =
        Material { reflection, emission: LinearRgb::WHITE, double_sided: true, ..Material::default() };
    let id = scene.add_material(material);
    scene.geometries[0].material = Some(id);
    let mesh = MeshSettings { tolerance: Some(0.1), patch_size: Some(2.0), ..MeshSettings::default() };
    let settings = BookSettings { mesh, rounds: 0, ..BookSettings::default() };
    let solved = solve(&scene, &settings, &Control::default(), |_| ()).expect("solved");
    let solution = &solved.solution;
    let mut seen = 0;
    for leaf in solution.mesh.leaves().filter(|&leaf| solution.mesh.surface(leaf).back) {
        let found = solution.radiosity(leaf).g;
        assert!(
            (found / 5.0 - 1.0).abs() < 1e-4,
            "{found} {:?} {:?}",
            solved.report,
            solution.mesh.shape(leaf)
        );
        seen += 1;
    }
    assert!(seen > 20);
}

#[test]
fn power_is_kept_in_rooms_with_obstacles_and_without_walls() {
    let settings = BookSettings::default();
    let closed = solve_faces(&furnished(0.6, 0.0, 5.0), 0.7, &settings);
    assert!(closed.solution.report.energy_error < 1e-3, "{}", closed.solution.report.energy_error);
    assert!(closed.report.lost < 1e-3, "{}", closed.report.lost);
    let open: Vec<Face> = furnished(0.6, 0.0, 5.0).into_iter().skip(1).collect();
    let open = solve_faces(&open, 0.7, &settings);
    assert!(open.solution.report.energy_error < 1e-3);
    assert!(open.report.lost > 0.1 && open.report.lost < 0.5, "{}", open.report.lost);
    assert!(open.solution.report.converged && open.report.dominance > 0.0);
}

#[test]
fn symmetric_rooms_are_lit_symmetrically() {
    let mut all = cube_with(0.5, [0.0, 0.0, 0.0, 4.0, 0.0, 0.0]);
    let table = [[0.3, 0.7], [0.7, 0.7], [0.7, 0.3], [0.3, 0.3]];
    let top = table.map(|[x, z]| DVec3::new(x, 0.4, z));
    let mut below = top;
    below.reverse();
    all.extend([(top, grey(0.5), BLACK), (below, grey(0.5), BLACK)]);
    let settings =
        BookSettings { rounds: 0, factors: FactorMethod::RayCast { rays: 256 }, ..Default::default() };
    let solved = solve_faces(&all, 0.3, &settings).solution;
    let near = |p: DVec3, normal: DVec3| {
        let off = |leaf: u32| {
            solved.mesh.elements()[leaf as usize].center.distance(p)
                + solved.mesh.normal(leaf).distance(normal)
        };
        let leaf = solved.mesh.leaves().min_by(|&a, &b| off(a).total_cmp(&off(b)));
        solved.radiosity(leaf.expect("some")).r
    };
    type Mirror = fn(DVec3) -> DVec3;
    let mirrors: [(Mirror, Mirror); 2] = [
        (|p| DVec3::new(1.0 - p.x, p.y, p.z), |n| DVec3::new(-n.x, n.y, n.z)),
        (|p| DVec3::new(p.z, p.y, p.x), |n| DVec3::new(n.z, n.y, n.x)),
    ];
    for leaf in solved.mesh.leaves() {
        let c = solved.mesh.elements()[leaf as usize].center;
        let found = solved.radiosity(leaf).r;
        for (place, normal) in mirrors {
            let there = near(place(c), normal(solved.mesh.normal(leaf)));
            // Lines of sight are the same for all pairs, and not mirrored.
            assert!((found - there).abs() < 0.02 * found.max(0.3), "{c}: {found} {there}");
        }
    }
}

#[test]
fn the_result_does_not_depend_on_threads() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| solve_faces(&furnished(0.6, 0.0, 5.0), 0.9, &BookSettings::default()))
    };
    assert_eq!(run(1), run(4));
}

#[test]
fn rounds_divide_where_light_changes_and_add_no_equations() {
    let settings = |rounds| BookSettings { rounds, largest_factor: 1.0, ..BookSettings::default() };
    let none = solve_faces(&furnished(0.5, 0.0, 5.0), 0.7, &settings(0));
    let two = solve_faces(&furnished(0.5, 0.0, 5.0), 0.7, &settings(2));
    assert_eq!(two.report.rounds, 2);
    assert_eq!(none.report.equations, two.report.equations);
    assert!(two.report.partial_factors > none.report.partial_factors);
    assert!(two.solution.report.patches > none.solution.report.patches);
    // Patches keep the means of their elements.
    let means = |solved: &Solved| {
        let incident = &solved.solution.incident;
        (0..solved.solution.mesh.polygons().len()).map(|i| incident[i].r).collect::<Vec<_>>()
    };
    for (a, b) in means(&none).iter().zip(means(&two)) {
        assert!((a - b).abs() < 0.1 * a.max(0.2), "{a} {b}");
    }
}

#[test]
fn patches_that_fill_the_view_of_others_are_divided() {
    // Two plates close together, and a small one between.
    let plate = |y: f64, half: f64, up: bool| {
        let square = [[-1.0, 1.0], [1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]];
        let mut corners = square.map(|[x, z]| DVec3::new(half * x, y, half * z));
        if !up {
            corners.reverse();
        }
        (corners, grey(0.5), grey(1.0))
    };
    let faces = [plate(0.0, 1.0, true), plate(0.4, 1.0, false)];
    let equations = |largest_factor| {
        let settings = BookSettings { rounds: 0, largest_factor, ..BookSettings::default() };
        solve_faces(&faces, 3.0, &settings).report.equations
    };
    assert_eq!(equations(1.0), 2);
    assert_eq!(equations(0.6), 8, "quarters see less of each other");
}

fn lamp_over_table() -> Scene {
    let mut scene = Scene::of_shape("floor", Shape::Plane { size: Some(4.0) });
    scene.geometries[0].material =
        Some(scene.add_material(Material { double_sided: true, ..Material::default() }));
    let kind = LightKind::Point;
    let light = Light { name: String::new(), color: grey(1.0), attenuation: Attenuation::None, kind };
    scene.lights.push(light);
    let transform = senca_scene::Transform::Matrix(senca_math::glam::DMat4::from_translation(DVec3::Y));
    let node = scene.add_node(Node { light: Some(LightId(0)), transform, ..Node::default() });
    scene.roots.push(node);
    scene
}

#[test]
fn lamps_of_the_scene_light_it() {
    let solved =
        solve(&lamp_over_table(), &BookSettings::default(), &Control::default(), |_| ()).expect("solved");
    let solution = &solved.solution;
    let (mut most, mut below) = (0.0f32, 0.0f32);
    for leaf in solution.mesh.leaves() {
        let light = solution.incident[leaf as usize].r;
        if solution.mesh.surface(leaf).back { below = below.max(light) } else { most = most.max(light) }
    }
    assert!(most > 0.95 && most <= 1.0, "{most}");
    assert_eq!(below, 0.0);
    assert_eq!(solution.incident, solution.direct);
}

#[test]
fn light_does_not_depend_on_the_view() {
    let solved = |eye: DVec3| {
        let mut scene = lamp_over_table();
        let projection =
            senca_scene::Projection::Perspective { yfov: 1.0, aspect: None, near: None, far: None };
        scene.cameras.push(senca_scene::Camera::new("eye", projection));
        let transform = senca_scene::Transform::Matrix(senca_math::glam::DMat4::from_translation(eye));
        let camera = Some(senca_scene::CameraId(0));
        let node = scene.add_node(Node { camera, transform, ..Node::default() });
        scene.roots.push(node);
        solve(&scene, &BookSettings::default(), &Control::default(), |_| ()).expect("solved")
    };
    assert_eq!(solved(DVec3::ONE), solved(DVec3::new(-7.0, 2.0, 0.5)));
}

#[test]
fn interrupting_keeps_the_best_so_far() {
    let mut mesh = mesh_of(&furnished(0.6, 0.0, 5.0));
    mesh.divide_to_size(0.7, 1 << 20).expect("few");
    let stop = AtomicBool::new(false);
    let control = Control { cancel: Some(&stop), ..Control::default() };
    let mut first = None;
    let solved = solve_mesh(mesh.clone(), &no_lamps(), &BookSettings::default(), &control, |solution| {
        first.get_or_insert_with(|| solution.clone());
        stop.store(true, Ordering::Relaxed);
    })
    .expect("the first round");
    assert_eq!(Some(solved.solution.incident), first.map(|solution| solution.incident));
    assert!(!solved.solution.report.converged && solved.warnings.len() == 1);
    let none = solve_mesh(mesh, &no_lamps(), &BookSettings::default(), &control, |_| ());
    assert_eq!(none.map(|_| ()), Err(RadiosityError::Cancelled));
}

#[test]
fn reflectance_that_no_paint_has_is_held() {
    for rho in [1.0, 7.5] {
        let solved = solve_faces(&cube_with(rho, [1.0; 6]), 1.5, &BookSettings::default());
        assert_eq!(solved.warnings.len(), 1);
        assert!((radiosities(&solved)[0] / 100.0 - 1.0).abs() < 1e-2, "{:?}", radiosities(&solved));
        let settings = BookSettings {
            stop: crate::system::StopRule { max_sweeps: 3, ..Default::default() },
            ..BookSettings::default()
        };
        let short = solve_faces(&cube_with(rho, [1.0; 6]), 1.5, &settings);
        assert!(!short.solution.report.converged);
        assert!(short.warnings[1].0.starts_with("not converged"), "{:?}", short.warnings);
    }
}

#[test]
fn odd_input_has_an_answer() {
    let settings = BookSettings::default();
    let nothing = solve(&Scene::default(), &settings, &Control::default(), |_| ()).expect("solved");
    assert_eq!(nothing.solution.mesh.elements().len(), 0);
    // A lamp that faces away from all, and a face without area.
    let mut away = faces([0.0; 3], [1.0; 3], false);
    away.truncate(2);
    let mut faces: Vec<Face> = away.into_iter().map(|f| (f, grey(0.5), grey(1.0))).collect();
    faces.push(([DVec3::ZERO; 4], grey(0.5), grey(1.0)));
    faces.push(([DVec3::NAN; 4], grey(0.5), grey(1.0)));
    let solved = solve_faces(&faces, 0.6, &settings);
    assert!(radiosities(&solved).iter().all(|&b| b == 1.0));
    assert!(solved.solution.report.converged);
    let small = BookSettings { max_factors: 10, ..settings };
    let error =
        solve_mesh(mesh_of(&cube_with(0.5, [1.0; 6])), &no_lamps(), &small, &Control::default(), |_| ());
    assert_eq!(error.map(|_| ()), Err(RadiosityError::TooManyFactors { limit: 10 }));
}

#[test]
fn settings_out_of_range_are_refused() {
    let d = BookSettings::default();
    for settings in [
        BookSettings { largest_factor: 0.0, ..d },
        BookSettings { largest_step: f64::NAN, ..d },
        BookSettings { smallest: -1.0, ..d },
        BookSettings { largest_reflectance: 1.0, ..d },
        BookSettings { factors: FactorMethod::RayCast { rays: 0 }, ..d },
    ] {
        assert!(solve(&Scene::default(), &settings, &Control::default(), |_| ()).is_err(), "{settings:?}");
    }
}

mod shooting;
