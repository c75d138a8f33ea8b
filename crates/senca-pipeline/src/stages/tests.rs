use senca_math::glam::{DVec2, DVec3, DVec4, Vec2, Vec4};
use senca_math::view::{ViewParameters, ViewWindow};
use senca_math::{DeviceMap, Image, LinearRgb, View, ViewKind};
use senca_raster::{ScanlineRasterizer, TiledRasterizer};
use senca_scene::{Geometry, Material, Phong, Reflection, Scene, Shape};
use senca_shading::{LightRig, PhongConstants};

use super::*;
use crate::test_support::{add_lamp, largest_difference, picture_difference};
use crate::{Culling, Settings, Shading, render};

/// The simple camera of the viewing tests: PRP = (0, 0, 5), window 2 x 2, F = 1, B = -5.
fn simple_view() -> View {
    let camera = ViewParameters {
        vrp: DVec3::ZERO,
        vpn: DVec3::Z,
        vup: DVec3::Y,
        prp: DVec3::new(0.0, 0.0, 5.0),
        window: ViewWindow::centered(2.0, 2.0),
        front: 1.0,
        back: -5.0,
    };
    camera.central_view().expect("regular")
}

fn triangle(corners: [[f64; 3]; 3]) -> Triangle {
    Triangle::from_corners(corners.map(DVec3::from_array))
}

#[test]
fn backs_are_rejected_and_edge_on_faces_stay() {
    let t = triangle([[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    let turned = triangle([[0.0; 3], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]);
    let seen_from = |eye: [f64; 3], t: Triangle| {
        let stage = RejectBacks { view: ViewKind::Central { eye_world: DVec3::from_array(eye) } };
        stage.run(vec![t]).len()
    };
    assert_eq!(seen_from([0.0, 0.0, 5.0], t), 1);
    assert_eq!(seen_from([0.0, 0.0, 5.0], turned), 0);
    assert_eq!(seen_from([3.0, 3.0, 0.0], t), 1);
    let along =
        |z: f64| RejectBacks { view: ViewKind::Parallel { direction_world: DVec3::new(0.0, 0.0, z) } };
    assert_eq!(along(-1.0).run(vec![t, turned]), [t]);
    assert_eq!(along(1.0).run(vec![t, turned]), [turned]);
}

#[test]
fn a_cut_triangle_becomes_two_with_interpolated_light() {
    let mut t = Triangle::default();
    let corners = [[0.0, 0.0], [2.0, 0.0], [0.0, 1.0]];
    let lights = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for (v, (p, l)) in t.vertices.iter_mut().zip(corners.into_iter().zip(lights)) {
        v.position = DVec4::new(p[0], p[1], -0.5, 1.0);
        v.light = LinearRgb::from_array(l);
    }
    let pieces = super::steps::clip(&t, &[Vec4::new(1.0, 0.0, 0.0, -1.0)]);
    assert_eq!(pieces.len(), 2);
    let expected = [
        ([0.0, 0.0], [1.0, 0.0, 0.0]),
        ([1.0, 0.0], [0.5, 0.5, 0.0]),
        ([1.0, 0.5], [0.0, 0.5, 0.5]),
        ([0.0, 1.0], [0.0, 0.0, 1.0]),
    ];
    for v in pieces.iter().flat_map(|t| t.vertices) {
        let fits = |(p, l): &([f64; 2], [f32; 3])| {
            v.position.truncate().truncate().abs_diff_eq(DVec2::from_array(*p), 1e-6)
                && v.light.to_array().iter().zip(l).all(|(a, b)| (a - b).abs() < 1e-6)
        };
        assert!(expected.iter().any(fits), "{v:?}");
    }
    let area: f64 = pieces.iter().map(|t| t.facet_normal().z / 2.0).sum();
    assert!((area - 0.75).abs() < 1e-6);
}

#[test]
fn a_vertex_behind_the_eye_is_clipped_before_the_division() {
    let t = triangle([[0.0, -0.5, 8.0], [0.5, 0.5, -1.0], [-0.5, 0.5, -1.0]]);
    let projected = Project { canonical_from_world: canonical_from_world(&simple_view()) }.run(vec![t]);
    let homogeneous =
        [[0.0, -0.25, 7.0 / 6.0, -0.3], [0.25, 0.25, -1.0 / 3.0, 0.6], [-0.25, 0.25, -1.0 / 3.0, 0.6]];
    for (v, h) in projected[0].vertices.iter().zip(homogeneous) {
        assert!(v.position.abs_diff_eq(DVec4::from_array(h), 1e-9), "{v:?}");
    }
    let pieces = Divide.run(ClipByVolume.run(projected));
    assert_eq!(pieces.len(), 2);
    let expected = [
        [0.486_111, 0.347_222, 0.0],
        [0.416_667, 0.416_667, -0.555_556],
        [-0.416_667, 0.416_667, -0.555_556],
        [-0.486_111, 0.347_222, 0.0],
    ];
    for v in pieces.iter().flat_map(|t| t.vertices) {
        let p = v.position.truncate();
        assert!(expected.iter().any(|&e| p.abs_diff_eq(DVec3::from_array(e), 2e-6)), "{p}");
    }
}

#[test]
fn depth_is_exact_in_the_picture_and_colour_is_not() {
    let world = [[-0.5, -0.5, 0.0], [1.0, -0.3, -4.0], [0.0, 0.8, -2.0]].map(DVec3::from_array);
    let weights = [0.2, 0.5, 0.3];
    let t = canonical_from_world(&simple_view());
    let h = world.map(|p| t * p.extend(1.0));
    let mean: DVec3 = world.iter().zip(weights).map(|(&p, w)| p * w).sum();
    let seen = t * mean.extend(1.0);
    let sum: f64 = h.iter().zip(weights).map(|(h, w)| h.w * w).sum();
    let screen: Vec<f64> = h.iter().zip(weights).map(|(h, w)| h.w * w / sum).collect();
    for (a, b) in screen.iter().zip([0.131_579, 0.592_105, 0.276_316]) {
        assert!((a - b).abs() < 1e-6, "{screen:?}");
    }
    let z: f64 = h.iter().zip(&screen).map(|(h, w)| h.z / h.w * w).sum();
    assert!((z + 0.789_474).abs() < 1e-6 && (z - seen.z / seen.w).abs() < 1e-12);
}

#[test]
fn the_stage_list_has_the_order_of_the_text() {
    let map = DeviceMap::to_pixels(4, 4).expect("regular");
    let names: Vec<_> = gouraud_stages(&simple_view(), map, LightRig::default(), Vec::new())
        .iter()
        .map(|s| s.name())
        .collect();
    let order = ["reject backs", "light vertices", "project", "clip by volume", "divide", "to device"];
    assert_eq!(names, order);
}

#[test]
fn about_half_of_a_sphere_is_rejected() {
    let scene = Scene::of_shape("ball", Shape::Sphere { radius: 1.0 });
    let view = simple_view();
    let list = tessellate(&scene, &view, (400, 400), 0.25).expect("a sphere");
    let area = |list: &[Triangle]| list.iter().map(|t| t.facet_normal().length()).sum::<f64>();
    let kept = RejectBacks { view: view.kind }.run(list.clone());
    // Seen from 5 radii, (1 - 1/5) / 2 of the surface is in sight.
    let share = area(&kept) / area(&list);
    assert!((share - 0.4).abs() < 0.02, "{share}");
    let count = kept.len() as f64 / list.len() as f64;
    assert!((0.3..0.5).contains(&count), "{count}");
}

fn ball_scene() -> Scene {
    let mut scene = Scene { ambient: LinearRgb::splat(0.1), ..Scene::default() };
    let phong = Phong {
        ambient: LinearRgb::new(0.7, 0.2, 0.1),
        diffuse: LinearRgb::new(0.7, 0.2, 0.1),
        specular: LinearRgb::splat(0.5),
        ..Phong::default()
    };
    let material =
        scene.add_material(Material { reflection: Reflection::Phong(phong), ..Material::default() });
    let shape = Shape::Sphere { radius: 0.8 };
    let geometry = scene.add_geometry(Geometry { name: String::new(), shape, material: Some(material) });
    let node = scene.add_node(senca_scene::Node { geometry: Some(geometry), ..Default::default() });
    scene.roots.push(node);
    add_lamp(&mut scene, DVec3::new(3.0, 4.0, 5.0), 1.0);
    scene
}

fn constants(scene: &Scene) -> Vec<PhongConstants> {
    let default = Material::default();
    let of = |m: &Material| match &m.reflection {
        Reflection::Phong(p) => PhongConstants::new(p),
        Reflection::MetallicRoughness(_) => PhongConstants::matte(LinearRgb::WHITE),
    };
    scene.materials.iter().chain([&default]).map(of).collect()
}

/// The picture of the plain pipeline, Gouraud or Phong.
fn plain_picture(scene: &Scene, view: &View, size: u32, phong: bool) -> Image {
    let map = DeviceMap::to_pixels(size, size).expect("regular");
    let (rig, materials) = (LightRig::of_scene(scene), constants(scene));
    let list = tessellate(scene, view, (size, size), 0.25).expect("tessellates");
    let mut buffers = z_buffer(size, size, LinearRgb::BLACK);
    let mut target = buffers.target().expect("fits");
    if phong {
        let light = PixelLight {
            view,
            map: &map,
            rig: &rig,
            materials: &materials,
            textures: &[],
            originals: &list,
            fog: scene.fog,
        };
        let done = run(&phong_stages(view, map), list.clone());
        rasterize_phong(&done, &light, &mut ScanlineRasterizer, &mut target);
    } else {
        let done = run(&gouraud_stages(view, map, rig, materials), list);
        rasterize_gouraud(&done, &mut ScanlineRasterizer, &mut target);
    }
    buffers.color
}

fn fast_picture(scene: &Scene, view: &View, size: u32, shading: Shading) -> Image {
    let settings = Settings {
        shading,
        cull: Culling::Always,
        background: Some(senca_scene::Background::Color(LinearRgb::BLACK)),
        ..Settings::default()
    };
    let mut image = Image::new(size, size, [0.0; 4]);
    render(scene, view, &settings, &mut image).expect("draws");
    image
}

#[test]
fn the_fast_path_gives_the_picture_of_the_plain_one() {
    let (scene, view) = (ball_scene(), simple_view());
    for (shading, phong) in [(Shading::Gouraud, false), (Shading::Phong, true)] {
        let (plain, fast) =
            (plain_picture(&scene, &view, 97, phong), fast_picture(&scene, &view, 97, shading));
        let difference = picture_difference(&plain, &fast, 0.02);
        assert!(difference.pixels <= 12, "{shading:?}: {difference}");
        assert!(difference.mean < 1e-3, "{shading:?}: {difference}");
    }
}

#[test]
fn the_plain_and_the_tiled_rasterizer_agree_on_the_stages() {
    let (scene, view) = (ball_scene(), simple_view());
    let map = DeviceMap::to_pixels(61, 61).expect("regular");
    let list = tessellate(&scene, &view, (61, 61), 0.5).expect("tessellates");
    let done = run(&gouraud_stages(&view, map, LightRig::of_scene(&scene), constants(&scene)), list);
    let mut one = z_buffer(61, 61, LinearRgb::BLACK);
    let mut other = one.clone();
    rasterize_gouraud(&done, &mut ScanlineRasterizer, &mut one.target().expect("fits"));
    rasterize_gouraud(&done, &mut TiledRasterizer::default(), &mut other.target().expect("fits"));
    assert_eq!(one.depth, other.depth);
    assert!(largest_difference(&one.color, &other.color) < 1e-5);
}

#[test]
fn a_pixel_goes_back_to_the_place_it_came_from() {
    let view = simple_view();
    let map = DeviceMap::to_pixels(640, 480).expect("regular");
    let rig = LightRig::default();
    let light = PixelLight {
        view: &view,
        map: &map,
        rig: &rig,
        materials: &[],
        textures: &[],
        originals: &[],
        fog: None,
    };
    let place = light.place(388, 137, 0.714_286);
    let device = view.device_from_world(&map, place).expect("in front");
    assert!((device.x - 388.5).abs() < 1e-6 && (device.y - 137.5).abs() < 1e-6, "{device}");
    assert!((place.z + 2.0).abs() < 1e-4, "{place}");
}

#[test]
fn textures_follow_the_triangle_through_the_scene() {
    use senca_raster::{Texels, Texture};
    let view = simple_view();
    let map = DeviceMap::to_pixels(32, 32).expect("regular");
    let rig = LightRig { ambient: LinearRgb::WHITE.into(), lights: Vec::new() };
    let mut t = triangle([[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [-1.0, 1.0, 0.0]]);
    for (v, uv) in t.vertices.iter_mut().zip([[0.0, 1.0], [1.0, 1.0], [0.0, 0.0]]) {
        v.alignment = Vec2::from_array(uv);
    }
    let texels: Vec<[f32; 4]> = (0..4).map(|i| [i as f32 / 4.0, 0.0, 0.0, 1.0]).collect();
    let textures = [Some(Texture::new(2, 2, Texels::Rgba32F(texels)).expect("2 x 2"))];
    let materials = [PhongConstants::matte(LinearRgb::WHITE)];
    let originals = [t];
    let light = PixelLight {
        view: &view,
        map: &map,
        rig: &rig,
        materials: &materials,
        textures: &textures,
        originals: &originals,
        fog: None,
    };
    let list = run(&phong_stages(&view, map), originals.to_vec());
    let mut buffers = z_buffer(32, 32, LinearRgb::BLACK);
    rasterize_phong(&list, &light, &mut ScanlineRasterizer, &mut buffers.target().expect("fits"));
    // Upper left, lower left and lower right corner of the picture.
    assert_eq!(buffers.color.color(2, 4).r, 0.0);
    assert_eq!(buffers.color.color(2, 28).r, 0.5);
    assert_eq!(buffers.color.color(26, 30).r, 0.75);
}
