use senca_io::classic::{ClassicObject, ClassicProjection, read_patches};
use senca_io::{Files, NoFiles};
use senca_math::glam::DVec3;
use senca_scene::{PatchConversion, Shape, patch_to_polygons};

use super::super::test_support::{load, sample, samples, scene};
use super::super::{BuildAlgorithm, Object, ObjectRecords};
use super::*;

fn run(scene: &ClassicScene, settings: &RenderSettings) -> (Rendering, Database) {
    let mut database = load(scene, BuildAlgorithm::AsRead);
    let rendering = render("scene1.dat", scene, &mut database, settings).expect("a picture");
    (rendering, database)
}

fn both() -> [RenderSettings; 2] {
    [false, true].map(|as_printed| RenderSettings { as_printed, ..RenderSettings::default() })
}

#[test]
fn two_faces_of_the_house_are_seen_and_the_front_wall_fills_the_window() {
    for operation in [ClassicOperation::Phong, ClassicOperation::Gouraud] {
        let scene = ClassicScene { operation, ..sample("house.dat") };
        for settings in both() {
            let (rendering, database) = run(&scene, &settings);
            let seen = |polygons: &[super::super::Polygon]| {
                (0..polygons.len()).filter(|&p| !polygons[p].culled).collect::<Vec<_>>()
            };
            assert_eq!(seen(&database.objects[0].polygons), [0, 7]);
            assert_eq!(rendering.report.culled, 11);
            assert!(rendering.picture().indices.iter().all(|&index| index == 10));
            assert_eq!(rendering.report.histogram[10], 22_500);
        }
    }
}

#[test]
fn indices_are_the_cosine_of_the_light() {
    for (light, index) in [(DVec3::Z, 15), (DVec3::new(0.0, 1.0, 1.0), 10), (-DVec3::Z, 1), (DVec3::Y, 1)] {
        for operation in [ClassicOperation::Phong, ClassicOperation::Gouraud] {
            let scene = ClassicScene { operation, light: Some(light), ..sample("house.dat") };
            for settings in both() {
                assert_eq!(run(&scene, &settings).0.picture().get(75, 75), Some(index), "{light}");
            }
        }
    }
}

#[test]
fn normals_of_the_cylinder_and_of_the_house() {
    let (_, database) = run(&sample("cylinder.dat"), &RenderSettings::default());
    let cylinder = &database.objects[0];
    let near = |a: DVec3, b: [f64; 3]| assert!((a - DVec3::from(b)).abs().max_element() < 5e-5, "{a} {b:?}");
    let of = |vertex: usize| cylinder.vertices[vertex].normals.iter().map(|&n| cylinder.normals[n].normal);
    let vertex_0: Vec<_> = of(0).collect();
    near(vertex_0[0], [-0.9239, -0.3827, 0.0]);
    near(vertex_0[1], [0.0, 0.0, -1.0]);
    let vertex_9: Vec<_> = of(9).collect();
    near(vertex_9[0], [-0.3827, -0.9239, 0.0]);
    near(vertex_9[1], [0.0, 0.0, 1.0]);
    let (_, database) = run(&sample("house.dat"), &RenderSettings::default());
    let house = &database.objects[0];
    near(house.polygons[4].normal, [0.6, 0.8, 0.0]);
    near(house.polygons[5].normal, [-0.6, 0.8, 0.0]);
}

/// The teapot as printed, with 0.89 in point 49, in 16 x 16 steps.
fn printed_teapot() -> ObjectRecords {
    let bytes = samples().read("teapot.bez").expect("the teapot");
    let mut scene = read_patches("teapot.bez", &bytes, &NoFiles).expect("reads");
    let Some(Shape::BezierPatches { patches }) = scene.geometries.first_mut().map(|g| &mut g.shape) else {
        panic!("no patches")
    };
    let (right, printed) = (DVec3::new(1.75, -0.98, 1.875), DVec3::new(1.75, -0.89, 1.875));
    for point in patches.iter_mut().flat_map(|patch| &mut patch.points).filter(|point| **point == right) {
        *point = printed;
    }
    let settings = PatchConversion { steps: [16, 16], as_printed: true, ..PatchConversion::default() };
    ObjectRecords::from_mesh(&patch_to_polygons(patches, &settings).expect("a mesh"), &[])
}

fn teapot_scene(operation: ClassicOperation) -> (ClassicScene, Database) {
    let placement = ClassicObject {
        file: "teapot".to_owned(),
        scale: DVec3::ONE,
        rotation_degrees: DVec3::new(-60.0, 2.0, 0.0),
        translation: DVec3::ZERO,
    };
    let object = Object::build(placement, &printed_teapot(), BuildAlgorithm::AsRead);
    let scene = ClassicScene { operation, vrp: DVec3::new(0.0, 1.5, 0.0), ..sample("house.dat") };
    (scene, Database { objects: vec![object] })
}

/// Pixels of each index as the repaired listing gives them.
const PHONG_1991: [u64; 16] = [19_005, 378, 76, 86, 144, 164, 242, 336, 443, 514, 136, 84, 74, 183, 635, 0];
const GOURAUD_1991: [u64; 16] = [19_005, 362, 91, 87, 146, 162, 242, 337, 446, 512, 136, 83, 76, 181, 634, 0];

#[test]
fn the_listing_gives_its_histograms_of_the_teapot() {
    for (operation, expected) in
        [(ClassicOperation::Phong, PHONG_1991), (ClassicOperation::Gouraud, GOURAUD_1991)]
    {
        let (scene, mut database) = teapot_scene(operation);
        let settings = RenderSettings { as_printed: true, ..RenderSettings::default() };
        let rendering = render("t", &scene, &mut database, &settings).expect("a picture");
        assert_eq!(rendering.report.culled, 3820);
        let apart: u64 = rendering.report.histogram.iter().zip(expected).map(|(a, b)| a.abs_diff(b)).sum();
        // Two sums that differ in their last bit may put one pixel into the next index.
        assert!(apart <= 2, "{:?}", rendering.report.histogram);
    }
}

#[test]
fn the_textual_teapot_is_larger_by_what_the_perspective_was_weakened() {
    let (scene, mut database) = teapot_scene(ClassicOperation::Phong);
    let rendering = render("t", &scene, &mut database, &RenderSettings::default()).expect("a picture");
    let drawn = 22_500 - rendering.report.histogram[0];
    // 8/7 as wide and as high.
    let expected = (22_500.0 - 19_005.0) * (8.0f64 / 7.0).powi(2);
    assert!((drawn as f64 / expected - 1.0).abs() < 0.03, "{drawn} {expected}");
}

#[test]
fn culling_does_not_show_on_a_closed_body() {
    let turned = |scene: ClassicScene| {
        let mut scene = scene;
        scene.objects[0].rotation_degrees = DVec3::new(-70.0, 20.0, 10.0);
        scene.objects[0].scale = DVec3::splat(0.1);
        scene
    };
    let scene = turned(sample("cylinder.dat"));
    let culled = run(&scene, &RenderSettings::default()).0;
    let all = run(&scene, &RenderSettings { back_faces: Some(true), ..RenderSettings::default() }).0;
    let apart = culled.picture().indices.iter().zip(&all.picture().indices).filter(|(a, b)| a != b).count();
    assert!(culled.report.culled > 3 && culled.report.histogram[0] < 22_000);
    assert!(apart < 40, "{apart} pixels, along outlines only");
}

#[test]
fn sixteen_bits_of_depth_are_enough_for_the_sample() {
    let scene = scene("scene1.dat");
    let [wide, narrow] = [IntegerWidth::Bits32, IntegerWidth::Bits16]
        .map(|width| run(&scene, &RenderSettings { width, ..RenderSettings::default() }).0);
    let apart = wide.picture().indices.iter().zip(&narrow.picture().indices).filter(|(a, b)| a != b).count();
    assert!(apart < 20, "{apart}");
}

#[test]
fn wireframes_show_edges_and_normals() {
    let plain = ClassicScene { operation: ClassicOperation::Wireframe, light: None, ..sample("patch.dat") };
    let normals = ClassicScene { operation: ClassicOperation::WireframeWithNormals, ..plain.clone() };
    let lit = |scene: &ClassicScene, settings| run(scene, &settings).0.report.histogram;
    let count = lit(&plain, RenderSettings::default());
    assert_eq!(count[1..15], [0; 14]);
    let default = RenderSettings::default();
    let with = lit(&normals, default);
    let all = lit(&normals, RenderSettings { normals: NormalsDrawn::OfVisibleVertices, ..default });
    assert!(count[15] > 500 && with[15] > count[15] + 20 && all[15] > count[15] + 20);
    // The patch's outline: corner 0 at (0, 0, 0), which the window of 8 around (1.5, 2) shows here.
    let picture = run(&plain, &default).0;
    let place = |x: f64, y: f64| ((x + 2.5) / 8.0 * 149.0, 149.0 - (y + 2.0) / 8.0 * 149.0);
    let (x, y) = place(0.0, 0.0);
    assert_eq!(picture.picture().get(x as u32, y as u32), Some(15));
    // Shading draws the edges first.
    let shaded = run(&sample("patch.dat"), &default).0;
    assert_eq!(shaded.wireframe, picture.wireframe);
}

#[test]
fn a_view_from_within_shows_what_lies_before_the_eye() {
    // The eye stands inside of the house, and looks along -z at its back wall, from inside.
    let scene = ClassicScene {
        vrp: DVec3::new(8.0, 5.0, 42.0),
        projection_distance: 4.0,
        view_plane_distance: -10.0,
        ..sample("house.dat")
    };
    let all = RenderSettings { back_faces: Some(true), ..RenderSettings::default() };
    let (rendering, _) = run(&scene, &all);
    assert_eq!(rendering.report.histogram[0], 0, "walls all around");
    let (rendering, _) = run(&scene, &RenderSettings::default());
    assert_eq!(rendering.report.histogram[0], 22_500, "which turn their back");
}

#[test]
fn clipping_opens_the_object() {
    // F at VRP, B one unit before it: a slice of the pot.
    let mut scene = ClassicScene { view_plane_distance: 1.0, ..sample("teapot.dat") };
    scene.objects[0].rotation_degrees = DVec3::new(-60.0, 2.0, 0.0);
    let whole = run(&scene, &RenderSettings::default()).0.report.histogram;
    let cut = run(&scene, &RenderSettings { clip: true, ..RenderSettings::default() }).0.report.histogram;
    assert!(cut[0] > whole[0], "what lies behind F is gone: {} {}", cut[0], whole[0]);
    let parallel = ClassicScene { projection: ClassicProjection::Parallel, ..scene };
    let whole = run(&parallel, &RenderSettings::default()).0.report.histogram;
    let cut = run(&parallel, &RenderSettings { clip: true, ..RenderSettings::default() }).0.report.histogram;
    assert!(cut[0] > whole[0]);
}

#[test]
fn rasters_beyond_the_screen_are_refused_on_their_line() {
    let scene = sample("house.dat");
    let mut database = load(&scene, BuildAlgorithm::AsRead);
    let mut fails = |scene: &ClassicScene, settings: RenderSettings| {
        render("s.dat", scene, &mut database, &settings).expect_err("too large").to_string()
    };
    let screen = RenderSettings { screen: Some([100, 149]), ..RenderSettings::default() };
    let expected = "s.dat:8:1: cannot get the desired screen resolution: 150 x 150 pixels on 100 x 149";
    assert_eq!(fails(&scene, screen), expected);
    let huge = ClassicScene { window: [1e9, 1.0], ..scene.clone() };
    assert!(fails(&huge, RenderSettings::default()).contains("s.dat:8:1: 4294967295 x 150 pixels are more"));
    let narrow = ClassicScene { window: [1e-9, 1.0], ..scene.clone() };
    assert!(fails(&narrow, RenderSettings::default()).contains("too narrow"));
    let colors = RenderSettings { colors: 1, ..RenderSettings::default() };
    assert_eq!(fails(&scene, colors), "1 colours: there must be 2 to 65536");
}

#[test]
fn polygons_without_a_normal_are_refused_on_their_line() {
    let text = "4 2 1\n0 0 0 0\n1 1 0 0\n\n2 2 0 0\n3 0 1 0\n0 0 3 0 1 3\n\n1 0 3 0 1 2\n";
    struct One(&'static str);
    impl Files for One {
        fn read(&self, _: &str) -> Result<Vec<u8>, ReadError> {
            Ok(self.0.as_bytes().to_vec())
        }
    }
    let scene = sample("flat.dat");
    let (mut database, _) = Database::load(&scene, &One(text), BuildAlgorithm::AsRead).expect("reads");
    let error = render("s.dat", &scene, &mut database, &RenderSettings::default()).expect_err("flat");
    let expected = "flat.dat:9:1: polygon 1 has no normal: no three consecutive corners span a plane";
    assert_eq!(error.to_string(), expected);
}

#[test]
fn a_moved_vertex_takes_its_normals_along() {
    let scene = sample("teapot.dat");
    let (_, mut moved) = run(&scene, &RenderSettings::default());
    let to = moved.objects[0].vertices[100].local + DVec3::new(0.1, -0.2, 0.05);
    moved.move_vertex(0, 100, to).expect("moves");
    let mut whole = moved.clone();
    whole.compute_normals().expect("normals");
    assert_eq!(moved, whole, "all that changed is what the links reach");
    let (_, before) = run(&scene, &RenderSettings::default());
    assert_ne!(moved.objects[0].normals, before.objects[0].normals);
}

#[test]
fn polygons_with_highlights_are_shaded_after_phong() {
    let scene = scene("teapot1.dat");
    let with = |highlight, operation| {
        let scene = ClassicScene { operation, ..scene.clone() };
        let settings = RenderSettings { colors: 64, highlight, ..RenderSettings::default() };
        run(&scene, &settings).0
    };
    let phong = with(None, ClassicOperation::Phong);
    let mixed = with(Some(0.9), ClassicOperation::Phong);
    let gouraud = with(None, ClassicOperation::Gouraud);
    let visible = phong.report.polygons - phong.report.culled;
    assert_eq!((phong.report.after_phong, gouraud.report.after_phong), (visible, 0));
    assert!((1..visible / 2).contains(&mixed.report.after_phong), "{}", mixed.report.after_phong);
    // Where Phong has a highlight it has not changed, and nothing else became one.
    let first = 1 + (0.9 * 62.0) as u32;
    for (&mixed, &phong) in mixed.picture().indices.iter().zip(&phong.picture().indices) {
        assert!(mixed == phong || mixed.max(phong) <= first, "{mixed} {phong}");
    }
    assert_ne!(mixed.picture(), phong.picture());
    let none = with(Some(1.1), ClassicOperation::Phong);
    assert_eq!((none.report.after_phong, none.picture() == gouraud.picture()), (0, true));
    let all = with(Some(-2.0), ClassicOperation::Phong);
    assert_eq!(all.picture(), phong.picture());
}

#[test]
fn objects_and_surfaces_have_ranges_of_indices() {
    let scene = scene("patches.dat");
    let with = |ranges, colors| {
        let mut database = load(&scene, BuildAlgorithm::AsRead);
        render("p", &scene, &mut database, &RenderSettings { ranges, colors, ..RenderSettings::default() })
    };
    let one = with(Ranges::Scene, 16).expect("a picture");
    let two = with(Ranges::Objects, 31).expect("a picture");
    assert_eq!((one.report.ranges, two.report.ranges), (1, 2));
    // 15 indices each: the same shades, the second object's behind the first one's.
    for (&one, &two) in one.picture().indices.iter().zip(&two.picture().indices) {
        assert!(two == one || (one > 0 && two == one + 15), "{one} {two}");
    }
    let of = |range: std::ops::RangeInclusive<usize>| two.report.histogram[range].iter().sum::<u64>();
    assert!(of(1..=15) > 100 && of(16..=30) > 100);
    let error = with(Ranges::Objects, 4).expect_err("too few");
    assert_eq!(error.to_string(), "4 colours are too few for 2 ranges: with the background they take 5");
    // Each polygon of the house is a surface.
    let house = sample("house.dat");
    let settings = RenderSettings { ranges: Ranges::Surfaces, colors: 27, ..RenderSettings::default() };
    let (rendering, _) = run(&house, &settings);
    assert_eq!(rendering.report.ranges, 13);
    assert!(rendering.picture().indices.iter().all(|&i| (1..=2).contains(&i) || (15..=16).contains(&i)));
}
