//! Pictures of the whole pipeline.

use std::sync::Mutex;
use std::sync::atomic::AtomicBool;

use senca_math::glam::{DMat4, DVec3, Vec2, Vec3, Vec4};
use senca_math::{Image, LinearRgb, View};
use senca_scene::{
    AlphaMode, Background, Filter, Fog, FogFalloff, Geometry, ImageData, ImageId, Material, Mesh,
    MetallicRoughness, Node, Phong, Reflection, Scene, Shape, Surface, Texture, TextureId, TextureImage,
    TextureRef, Transform, Vertices, Wrap,
};

use crate::test_support::{add_lamp, largest_difference, picture_difference};
use crate::{
    ColorInterpolation, Control, Crop, Culling, Raster, RenderError, Settings, Shading, TextureMethod,
    render, render_part, render_with,
};

const BLACK: Option<Background> = Some(Background::Color(LinearRgb::BLACK));

fn camera(eye: DVec3) -> View {
    let world_from_camera = View::look_at(eye, DVec3::ZERO, DVec3::Y).expect("regular");
    View::perspective(&world_from_camera, 0.7, 1.0, 0.5, Some(50.0)).expect("regular")
}

/// Looks down -z on a window of 2 x 2 around the origin, from z = 10; what is there lies 10 away.
fn window_view() -> View {
    let world_from_camera = DMat4::from_translation(DVec3::Z * 10.0);
    View::orthographic(&world_from_camera, 2.0, 1.0, 0.5, 50.0).expect("regular")
}

fn draw_with(scene: &Scene, view: &View, settings: &Settings, width: u32, height: u32) -> Image {
    let mut image = Image::new(width, height, [9.0; 4]);
    render(scene, view, settings, &mut image).expect("draws");
    image
}

fn settings(shading: Shading) -> Settings {
    Settings { shading, background: BLACK, ..Settings::default() }
}

fn draw(scene: &Scene, view: &View, shading: Shading, size: u32) -> Image {
    draw_with(scene, view, &settings(shading), size, size)
}

fn matte(color: LinearRgb) -> Material {
    let phong = Phong { ambient: color, diffuse: color, ..Phong::default() };
    Material { reflection: Reflection::Phong(phong), ..Material::default() }
}

/// Shows its colour whatever the light.
fn unlit(color: LinearRgb, alpha: f32) -> Material {
    let phong = Phong { diffuse: color, alpha, ..Phong::default() };
    Material { reflection: Reflection::Phong(phong), unlit: true, double_sided: true, ..Material::default() }
}

fn place(scene: &mut Scene, shape: Shape, at: DVec3, material: Material) {
    let material = Some(scene.add_material(material));
    let geometry = Some(scene.add_geometry(Geometry { name: String::new(), shape, material }));
    let transform = Transform::Matrix(DMat4::from_translation(at));
    let node = scene.add_node(Node { geometry, transform, ..Node::default() });
    scene.roots.push(node);
}

/// A square of side 2 `half` that faces +z, with the picture upright on it.
fn square(half: f32) -> Shape {
    let points = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let mut mesh = Mesh {
        points: points.map(|[x, y]| Vec3::new(x, y, 0.0) * half).to_vec(),
        vertices: Vertices {
            point: vec![0, 1, 2, 3],
            normal: vec![Vec3::Z; 4],
            texcoord0: [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]].map(Vec2::from_array).to_vec(),
            ..Vertices::default()
        },
        surfaces: vec![Surface::default()],
        ..Mesh::default()
    };
    mesh.faces.push(&[0, 1, 2], 0);
    mesh.faces.push(&[0, 2, 3], 0);
    Shape::Mesh(mesh)
}

/// A shiny ball and a box, lit from the upper right.
fn still_life() -> Scene {
    let mut scene = Scene { ambient: LinearRgb::splat(0.1), ..Scene::default() };
    let shiny = Phong {
        ambient: LinearRgb::new(0.2, 0.3, 0.6),
        diffuse: LinearRgb::new(0.2, 0.3, 0.6),
        specular: LinearRgb::WHITE,
        exponent: 60.0,
        ..Phong::default()
    };
    let shiny = Material { reflection: Reflection::Phong(shiny), ..Material::default() };
    place(&mut scene, Shape::Sphere { radius: 1.0 }, DVec3::new(-0.4, 0.2, 0.0), shiny);
    let gold = MetallicRoughness { base_color: LinearRgb::new(1.0, 0.7, 0.3), ..Default::default() };
    let gold = Material { reflection: Reflection::MetallicRoughness(gold), ..Material::default() };
    place(&mut scene, Shape::Box { size: DVec3::ONE }, DVec3::new(0.9, -0.6, 0.3), gold);
    add_lamp(&mut scene, DVec3::new(2.0, 3.0, 4.0), 1.0);
    scene
}

fn eye() -> View {
    camera(DVec3::new(1.0, 1.5, 5.0))
}

const FACES: [Shading; 4] = [Shading::Flat, Shading::Gouraud, Shading::Phong, Shading::Material];
const ALL: [Shading; 7] = [
    Shading::Wire,
    Shading::WireNormals,
    Shading::HiddenLine,
    Shading::Flat,
    Shading::Gouraud,
    Shading::Phong,
    Shading::Material,
];

#[test]
fn threads_do_not_change_a_byte() {
    let scene = still_life();
    for shading in ALL {
        let of = |threads| {
            let settings = Settings { threads, samples: 2, ..settings(shading) };
            draw_with(&scene, &eye(), &settings, 83, 61)
        };
        let one = of(1);
        assert!(one == of(2) && one == of(3), "{shading:?}");
    }
}

#[test]
fn both_rasterizers_give_the_same_picture() {
    let scene = still_life();
    for shading in FACES {
        let scanline = Settings { raster: Raster::Scanline, ..settings(shading) };
        let (plain, tiled) = (
            draw_with(&scene, &eye(), &scanline, 97, 71),
            draw_with(&scene, &eye(), &settings(shading), 97, 71),
        );
        assert!(plain == tiled, "{shading:?}: {}", picture_difference(&plain, &tiled, 0.0));
    }
}

#[test]
fn one_pass_gives_the_picture_of_two() {
    let scene = still_life();
    for shading in FACES {
        let one = draw_with(&scene, &eye(), &Settings { two_pass: false, ..settings(shading) }, 64, 64);
        let two = draw(&scene, &eye(), shading, 64);
        assert!(largest_difference(&one, &two) < 1e-5, "{shading:?}");
    }
}

#[test]
fn every_size_is_drawn_to_its_last_pixel() {
    let mut scene = Scene::default();
    place(&mut scene, square(4.0), DVec3::ZERO, unlit(LinearRgb::new(0.25, 0.5, 0.75), 1.0));
    for (width, height) in [(1, 1), (1, 7), (9, 1), (63, 65), (129, 3)] {
        for samples in [1, 3] {
            let settings = Settings { samples, ..settings(Shading::Material) };
            let image = draw_with(&scene, &window_view(), &settings, width, height);
            for pixel in image.pixels() {
                let close = pixel.iter().zip([0.25, 0.5, 0.75, 1.0]).all(|(a, b)| (a - b).abs() < 1e-6);
                assert!(close, "{width} x {height} with {samples} samples: {pixel:?}");
            }
        }
    }
}

#[test]
fn phong_shading_finds_the_highlight_that_gouraud_misses() {
    // A coarse ball: the highlight falls between its vertices.
    let tessellated = senca_scene::TessellationSettings {
        tolerance: senca_scene::Tolerance::Steps(8, 4),
        ..Default::default()
    };
    let mesh = senca_scene::tessellate(&Shape::Sphere { radius: 1.0 }, &tessellated).expect("a ball");
    let mut scene = Scene::default();
    let shiny = Phong {
        diffuse: LinearRgb::splat(0.2),
        specular: LinearRgb::WHITE,
        exponent: 80.0,
        ..Phong::default()
    };
    let shiny = Material { reflection: Reflection::Phong(shiny), ..Material::default() };
    place(&mut scene, Shape::Mesh(mesh.into_owned()), DVec3::ZERO, shiny);
    add_lamp(&mut scene, DVec3::new(0.35, 0.4, 1.0), 1.0);
    let brightest = |shading| {
        let image = draw(&scene, &camera(DVec3::Z * 5.0), shading, 120);
        image.pixels().iter().map(|p| p[0]).fold(0.0, f32::max)
    };
    let (gouraud, phong) = (brightest(Shading::Gouraud), brightest(Shading::Phong));
    assert!(phong > 1.1, "full highlight: {phong}");
    assert!(gouraud < 0.7 * phong, "{gouraud} against {phong}");
}

#[test]
fn flat_shading_has_one_colour_a_face() {
    let mut scene = Scene::default();
    place(&mut scene, Shape::Box { size: DVec3::ONE }, DVec3::ZERO, matte(LinearRgb::WHITE));
    add_lamp(&mut scene, DVec3::new(1.0, 2.0, 4.0), 1.0);
    let image = draw(&scene, &camera(DVec3::new(1.5, 2.0, 3.0)), Shading::Flat, 60);
    let mut tones: Vec<u32> = image.pixels().iter().map(|p| p[0].to_bits()).collect();
    tones.sort_unstable();
    tones.dedup();
    assert_eq!(tones.len(), 4, "three faces and the background");
    let expected = |axis: DVec3| axis.dot(DVec3::new(1.0, 2.0, 4.0).normalize()) as f32;
    for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
        let near = tones.iter().any(|&t| (f32::from_bits(t) - expected(axis)).abs() < 1e-6);
        assert!(near, "face towards {axis}");
    }
}

#[test]
fn house_in_the_sample_view_shows_two_polygons() {
    let points = [
        [0, 0, 54],
        [16, 0, 54],
        [16, 10, 54],
        [8, 16, 54],
        [0, 10, 54],
        [0, 0, 30],
        [16, 0, 30],
        [16, 10, 30],
        [8, 16, 30],
        [0, 10, 30],
        [0, 0, 58],
        [4, 0, 58],
        [4, 0, 54],
        [0, 14, 54],
        [0, 14, 58],
        [4, 14, 58],
        [4, 14, 54],
    ];
    let polygons: [&[u32]; 13] = [
        &[0, 1, 2, 3, 4],
        &[9, 8, 7, 6, 5],
        &[0, 5, 6, 1],
        &[2, 1, 6, 7],
        &[2, 7, 8, 3],
        &[4, 3, 8, 9],
        &[0, 4, 9, 5],
        &[10, 11, 15, 14],
        &[11, 12, 16, 15],
        &[0, 13, 16, 12],
        &[10, 14, 13, 0],
        &[13, 14, 15, 16],
        &[0, 12, 11, 10],
    ];
    let eye = senca_math::ViewKind::Central { eye_world: DVec3::new(1.5, 2.0, 70.0) };
    let at = |i: u32| DVec3::from_array(points[i as usize].map(f64::from));
    let visible = |polygon: &[u32]| {
        let [a, b, c] = [polygon[0], polygon[1], polygon[2]].map(at);
        !eye.sees_back_of(a, (b - a).cross(c - b))
    };
    let seen: Vec<usize> = (0..13).filter(|&i| visible(polygons[i])).collect();
    assert_eq!(seen, [0, 7]);
}

#[test]
fn the_order_of_triangles_does_not_matter() {
    let panes = [(0.0, [1.0, 0.0, 0.0], 0.5), (0.2, [0.0, 1.0, 0.0], 0.5), (-0.3, [0.0, 0.0, 1.0], 1.0)];
    let picture = |order: [usize; 3]| {
        let mut scene = Scene::default();
        for i in order {
            let (z, color, alpha) = panes[i];
            let alpha_mode = if alpha < 1.0 { AlphaMode::Blend } else { AlphaMode::Opaque };
            let material = Material { alpha_mode, ..unlit(LinearRgb::from_array(color), alpha) };
            place(&mut scene, square(0.7), DVec3::new(0.0, 0.0, z), material);
        }
        draw(&scene, &window_view(), Shading::Material, 16)
    };
    let first = picture([0, 1, 2]);
    for order in [[0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
        assert!(first == picture(order), "{order:?}");
    }
    // Half green over half red over blue.
    let [r, g, b, a] = first.pixel(8, 8);
    assert!((r - 0.25).abs() < 1e-6 && (g - 0.5).abs() < 1e-6 && (b - 0.25).abs() < 1e-6 && a == 1.0);
}

#[test]
fn transparent_surfaces_keep_their_alpha_over_nothing() {
    let mut scene = Scene::default();
    let pane = Material { alpha_mode: AlphaMode::Blend, ..unlit(LinearRgb::new(0.8, 0.4, 0.2), 0.25) };
    place(&mut scene, square(0.7), DVec3::ZERO, pane);
    let settings = Settings { background: None, ..Settings::default() };
    let image = draw_with(&scene, &window_view(), &settings, 16, 16);
    let pixel = image.pixel(8, 8);
    assert!(pixel.iter().zip([0.8, 0.4, 0.2, 0.25]).all(|(a, b)| (a - b).abs() < 1e-6), "{pixel:?}");
    assert_eq!(image.pixel(0, 0), [0.0; 4]);
}

#[test]
fn two_transparent_panes_in_one_place_both_show() {
    let mut scene = Scene::default();
    for _ in 0..2 {
        let pane = Material { alpha_mode: AlphaMode::Blend, ..unlit(LinearRgb::WHITE, 0.5) };
        place(&mut scene, square(0.7), DVec3::ZERO, pane);
    }
    let image = draw(&scene, &window_view(), Shading::Material, 8);
    assert!((image.pixel(4, 4)[0] - 0.75).abs() < 1e-6);
}

fn textured_square(texels: Vec<[u8; 4]>, side: u32, filter: Filter, material: Material) -> Scene {
    let mut scene = Scene { ambient: LinearRgb::WHITE, ..Scene::default() };
    let data = ImageData::Rgba8 { width: side, height: side, texels };
    scene.images.push(TextureImage { name: String::new(), data });
    scene.textures.push(Texture {
        name: String::new(),
        image: ImageId(0),
        wrap_u: Wrap::Repeat,
        wrap_v: Wrap::Repeat,
        filter,
    });
    place(&mut scene, square(1.0), DVec3::ZERO, material);
    scene
}

fn with_texture(material: Material) -> Material {
    let Reflection::Phong(phong) = material.reflection else { return material };
    let texture = Some(TextureRef::new(TextureId(0)));
    Material { reflection: Reflection::Phong(Phong { texture, ..phong }), ..material }
}

const FOUR: [[u8; 4]; 4] = [[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 0], [255, 255, 255, 255]];

#[test]
fn pictures_stand_upright_in_every_shading_and_by_both_methods() {
    let material = with_texture(unlit(LinearRgb::WHITE, 1.0));
    let scene = textured_square(FOUR.to_vec(), 2, Filter::Nearest, material);
    for shading in FACES {
        for texture_method in [TextureMethod::Interpolated, TextureMethod::Transformed] {
            let settings = Settings { texture_method, ..settings(shading) };
            let image = draw_with(&scene, &window_view(), &settings, 8, 8);
            for ((x, y), texel) in [(1, 1), (6, 1), (1, 6), (6, 6)].into_iter().zip(FOUR) {
                let expected = [texel[0], texel[1], texel[2]].map(|v| f32::from(v) / 255.0);
                let color = image.color(x, y).to_array();
                assert_eq!(color, expected, "{shading:?} {texture_method:?} at ({x}, {y})");
            }
        }
    }
}

#[test]
fn both_texture_methods_agree_in_perspective() {
    let side = 16;
    let texels = (0..side * side).map(|i| if (i % side + i / side) % 2 == 0 { [250; 4] } else { [20; 4] });
    let material = with_texture(unlit(LinearRgb::WHITE, 1.0));
    let scene = textured_square(texels.collect(), side, Filter::Bilinear, material);
    let view = camera(DVec3::new(1.5, 0.4, 1.8));
    let of = |texture_method| {
        draw_with(&scene, &view, &Settings { texture_method, ..settings(Shading::Phong) }, 90, 90)
    };
    let difference =
        picture_difference(&of(TextureMethod::Interpolated), &of(TextureMethod::Transformed), 0.02);
    assert!(difference.pixels <= 4, "{difference}");
}

#[test]
fn filters_agree_on_the_mean_of_a_fine_pattern() {
    let side = 64;
    let texels =
        (0..side * side).map(|i| if (i % side + i / side) % 2 == 0 { [255; 4] } else { [0, 0, 0, 255] });
    let material = with_texture(unlit(LinearRgb::WHITE, 1.0));
    let scene = textured_square(texels.collect(), side, Filter::Trilinear, material);
    for filter in [Filter::Footprint, Filter::Trilinear] {
        let settings = Settings { filter: Some(filter), ..settings(Shading::Material) };
        let image = draw_with(&scene, &window_view(), &settings, 8, 8);
        let mean = image.pixels().iter().map(|p| p[0]).sum::<f32>() / 64.0;
        assert!((mean - 0.5).abs() < 0.02, "{filter:?}: {mean}");
        assert!(image.pixels().iter().all(|p| (p[0] - 0.5).abs() < 0.1), "{filter:?} is even");
    }
}

#[test]
fn masks_cut_holes_and_show_what_is_behind() {
    let cut = Material { alpha_mode: AlphaMode::Mask { cutoff: 0.5 }, ..unlit(LinearRgb::WHITE, 1.0) };
    let mut scene = textured_square(FOUR.to_vec(), 2, Filter::Nearest, with_texture(cut));
    place(&mut scene, square(1.0), DVec3::new(0.0, 0.0, -1.0), unlit(LinearRgb::new(0.1, 0.2, 0.3), 1.0));
    for two_pass in [true, false] {
        let settings = Settings { two_pass, ..settings(Shading::Material) };
        let image = draw_with(&scene, &window_view(), &settings, 8, 8);
        assert_eq!(image.color(1, 6), LinearRgb::new(0.1, 0.2, 0.3), "hole");
        assert_eq!(image.color(6, 6), LinearRgb::WHITE);
    }
}

#[test]
fn normal_maps_lean_towards_the_light() {
    // Texels that lean right (+x) and up (+y in the picture), lit from the right.
    let texels = vec![[218, 128, 218, 255], [128, 218, 218, 255], [38, 128, 218, 255], [128, 38, 218, 255]];
    let map = Some(TextureRef::new(TextureId(0)));
    let material = Material { normal_texture: map, ..matte(LinearRgb::WHITE) };
    let mut scene = textured_square(texels, 2, Filter::Nearest, material);
    scene.ambient = LinearRgb::BLACK;
    add_lamp(&mut scene, DVec3::new(1.0, 0.0, 1.0), 1.0);
    let image = draw(&scene, &window_view(), Shading::Material, 8);
    let at = |x, y| image.pixel(x, y)[0];
    assert!(at(1, 1) > 0.95, "leans to the light: {}", at(1, 1));
    assert!(at(1, 6) < 0.1, "leans away: {}", at(1, 6));
    assert!((at(6, 1) - 0.5).abs() < 0.05 && (at(6, 6) - 0.5).abs() < 0.05, "leans across");
    scene.nodes.last_mut().expect("the lamp").transform = Transform::default();
    let mut from_above = scene.clone();
    from_above.lights.clear();
    add_lamp(&mut from_above, DVec3::new(0.0, 1.0, 1.0), 1.0);
    let image = draw(&from_above, &window_view(), Shading::Material, 8);
    assert!(image.pixel(6, 1)[0] > 0.95, "green leans up the picture: {}", image.pixel(6, 1)[0]);
}

#[test]
fn occlusion_dims_ambient_light_and_emission_glows() {
    let map = Some(TextureRef { strength: 0.5, ..TextureRef::new(TextureId(0)) });
    let material = Material {
        occlusion_texture: map,
        emission: LinearRgb::new(0.0, 0.0, 0.25),
        ..matte(LinearRgb::new(0.5, 0.5, 0.5))
    };
    let scene = textured_square(vec![[0, 0, 0, 255]], 1, Filter::Nearest, material);
    let c = draw(&scene, &window_view(), Shading::Material, 4).color(2, 2);
    assert!((c.r - 0.25).abs() < 1e-6 && (c.b - 0.5).abs() < 1e-6, "{c:?}");
}

#[test]
fn vertex_colours_multiply_in_every_shading() {
    let Shape::Mesh(mut mesh) = square(1.0) else { panic!("a mesh") };
    mesh.vertices.color = vec![Vec4::new(0.5, 0.25, 1.0, 1.0); 4];
    for shading in FACES {
        let mut scene = Scene { ambient: LinearRgb::WHITE, ..Scene::default() };
        place(&mut scene, Shape::Mesh(mesh.clone()), DVec3::ZERO, matte(LinearRgb::splat(0.8)));
        let c = draw(&scene, &window_view(), shading, 4).color(2, 2);
        let close = c.to_array().iter().zip([0.4, 0.2, 0.8]).all(|(a, b)| (a - b).abs() < 1e-6);
        assert!(close, "{shading:?}: {c:?}");
    }
}

#[test]
fn fog_mixes_by_distance_in_every_shading() {
    let falloff = FogFalloff::Linear { start: 5.0, end: 15.0, min_share: 0.0 };
    for shading in FACES {
        let mut scene = Scene { ambient: LinearRgb::WHITE, ..Scene::default() };
        scene.fog = Some(Fog { color: LinearRgb::new(0.0, 0.0, 1.0), falloff });
        place(&mut scene, square(1.0), DVec3::ZERO, matte(LinearRgb::new(1.0, 0.0, 0.0)));
        let c = draw(&scene, &window_view(), shading, 4).color(2, 2);
        assert!((c.r - 0.5).abs() < 1e-5 && (c.b - 0.5).abs() < 1e-5, "{shading:?}: {c:?}");
    }
}

#[test]
fn backs_are_left_out_or_lit_as_told() {
    let turned = DMat4::from_rotation_y(std::f64::consts::PI);
    let lit = |double_sided, cull| {
        let mut scene = Scene { ambient: LinearRgb::BLACK, ..Scene::default() };
        let material = Material { double_sided, ..matte(LinearRgb::WHITE) };
        place(&mut scene, square(0.9), DVec3::ZERO, material);
        scene.nodes[0].transform = Transform::Matrix(turned);
        add_lamp(&mut scene, DVec3::Z, 1.0);
        let settings = Settings { cull, ..settings(Shading::Phong) };
        draw_with(&scene, &window_view(), &settings, 4, 4).pixel(2, 2)[0]
    };
    assert_eq!(lit(false, Culling::ByMaterial), 0.0);
    assert_eq!(lit(true, Culling::Always), 0.0);
    for (double_sided, cull) in [(true, Culling::ByMaterial), (false, Culling::Never)] {
        assert!((lit(double_sided, cull) - 1.0).abs() < 1e-6, "{double_sided} {cull:?}");
    }
}

#[test]
fn mirrored_objects_show_their_outside() {
    let scene = |scale: DVec3| {
        let mut scene = Scene::default();
        place(&mut scene, Shape::Box { size: DVec3::ONE }, DVec3::ZERO, matte(LinearRgb::WHITE));
        scene.nodes[0].transform = Transform::Matrix(DMat4::from_scale(scale));
        add_lamp(&mut scene, DVec3::new(1.0, 2.0, 4.0), 1.0);
        scene
    };
    let view = camera(DVec3::new(1.5, 2.0, 3.0));
    for shading in FACES {
        let plain = draw(&scene(DVec3::ONE), &view, shading, 40);
        let mirrored = draw(&scene(DVec3::new(-1.0, 1.0, 1.0)), &view, shading, 40);
        let difference = picture_difference(&plain, &mirrored, 1e-4);
        assert!(difference.pixels <= 4, "{shading:?}: {difference}");
    }
}

#[test]
fn about_half_of_a_ball_is_culled() {
    let mut scene = Scene::default();
    place(&mut scene, Shape::Sphere { radius: 1.0 }, DVec3::ZERO, matte(LinearRgb::WHITE));
    let mut image = Image::new(200, 200, [0.0; 4]);
    let report = render(&scene, &eye(), &settings(Shading::Phong), &mut image).expect("draws");
    let share = report.triangles_culled as f64 / report.triangles_in as f64;
    assert!((0.4..0.7).contains(&share), "{report:?}");
    assert!(report.pixels_shaded > 1000 && report.pixels_shaded < 40_000);
}

#[test]
fn a_crop_is_the_same_part_of_the_whole_and_leaves_the_rest() {
    let scene = still_life();
    let crop = Crop { x: 13, y: 7, width: 31, height: 40 };
    for shading in [Shading::Phong, Shading::HiddenLine] {
        let whole = draw(&scene, &eye(), shading, 64);
        let part = draw_with(&scene, &eye(), &Settings { crop: Some(crop), ..settings(shading) }, 64, 64);
        for y in 0..64 {
            for x in 0..64 {
                let inside = (13..44).contains(&x) && (7..47).contains(&y);
                let expected = if inside { whole.pixel(x, y) } else { [9.0; 4] };
                assert_eq!(part.pixel(x, y), expected, "{shading:?} at ({x}, {y})");
            }
        }
        // And as an image of its own.
        let wish = Settings { crop: Some(crop), ..settings(shading) };
        let (own, _) = render_part(&scene, &eye(), &wish, [64, 64], &Control::default()).expect("draws");
        assert_eq!((own.width(), own.height()), (31, 40));
        for (y, row) in (7..47).enumerate() {
            assert_eq!(own.row(y as u32), &whole.row(row)[13..44]);
        }
    }
}

#[test]
fn a_part_of_a_picture_too_large_to_hold_is_drawn() {
    let wish = Settings {
        crop: Some(Crop { x: 8000, y: 8100, width: 3, height: 2 }),
        ..settings(Shading::Material)
    };
    let size = [16_000, 16_000];
    let (part, _) = render_part(&still_life(), &eye(), &wish, size, &Control::default()).expect("draws");
    assert_eq!((part.width(), part.height()), (3, 2));
    let outside = Settings { crop: Some(Crop { x: 15_999, y: 0, width: 2, height: 1 }), ..wish };
    assert!(render_part(&still_life(), &eye(), &outside, size, &Control::default()).is_err());
}

#[test]
fn samples_smooth_the_silhouette_and_keep_the_inside() {
    let mut scene = Scene::default();
    place(&mut scene, Shape::Sphere { radius: 0.8 }, DVec3::ZERO, unlit(LinearRgb::WHITE, 1.0));
    let image = draw_with(
        &scene,
        &window_view(),
        &Settings { samples: 16, tolerance_px: 0.02, ..settings(Shading::Material) },
        40,
        40,
    );
    let area: f64 = image.pixels().iter().map(|p| f64::from(p[0])).sum::<f64>() / 400.0;
    let circle = std::f64::consts::PI * 0.64;
    assert!((area - circle).abs() < 0.01, "{area} is not {circle}");
    assert!(image.pixels().iter().any(|p| p[0] > 0.2 && p[0] < 0.8));
    assert!((image.pixel(20, 20)[0] - 1.0).abs() < 1e-5);
}

#[test]
fn silhouettes_are_round_at_any_size() {
    let mut scene = Scene::default();
    place(&mut scene, Shape::Sphere { radius: 0.9 }, DVec3::ZERO, unlit(LinearRgb::WHITE, 1.0));
    for size in [50, 400] {
        let image = draw(&scene, &window_view(), Shading::Material, size);
        let half = f64::from(size) / 2.0;
        for y in 0..size {
            let row = image.row(y);
            let width = row.iter().filter(|p| p[0] > 0.5).count() as f64;
            let dy = (f64::from(y) + 0.5 - half) / half;
            let chord = 2.0 * half * (0.81 - dy * dy).max(0.0).sqrt();
            // Near the poles a quarter of a pixel in height is more in width.
            let slack = if chord > half { 2.0 } else { 2.0 + half.sqrt() };
            assert!((width - chord).abs() <= slack, "row {y} of {size}: {width} for {chord}");
        }
    }
}

#[test]
fn gradient_runs_from_the_top_row_to_the_bottom_row() {
    let background = Background::Gradient { bottom: LinearRgb::BLACK, top: LinearRgb::WHITE };
    let scene = Scene { background, ..Scene::default() };
    let image = draw_with(&scene, &eye(), &Settings::default(), 5, 5);
    let column: Vec<f32> = (0..5).map(|y| image.pixel(2, y)[0]).collect();
    assert_eq!(column, [1.0, 0.75, 0.5, 0.25, 0.0]);
}

#[test]
fn gouraud_interpolates_in_the_picture_or_in_space() {
    let Shape::Mesh(mut mesh) = square(1.0) else { panic!("a mesh") };
    mesh.vertices.color = [0.0, 1.0, 1.0, 0.0].map(|v| Vec4::new(v, v, v, 1.0)).to_vec();
    let mut scene = Scene { ambient: LinearRgb::WHITE, ..Scene::default() };
    let material = Material { double_sided: true, ..matte(LinearRgb::WHITE) };
    place(&mut scene, Shape::Mesh(mesh), DVec3::ZERO, material);
    let view = camera(DVec3::new(2.0, 0.0, 0.8));
    let of = |gouraud| draw_with(&scene, &view, &Settings { gouraud, ..settings(Shading::Gouraud) }, 60, 60);
    let phong = draw(&scene, &view, Shading::Phong, 60);
    assert!(largest_difference(&of(ColorInterpolation::Perspective), &phong) < 1e-4);
    assert!(largest_difference(&of(ColorInterpolation::Screen), &phong) > 0.1);
}

#[test]
fn cancelling_stops_and_progress_rises_to_one() {
    let scene = still_life();
    let mut image = Image::new(32, 32, [0.0; 4]);
    let cancel = AtomicBool::new(true);
    let control = Control { cancel: Some(&cancel), progress: None };
    let stopped = render_with(&scene, &eye(), &Settings::default(), &mut image, &control);
    assert_eq!(stopped, Err(RenderError::Cancelled));
    let seen = Mutex::new(Vec::new());
    let progress = |share: f32| seen.lock().expect("no panic").push(share);
    let control = Control { cancel: None, progress: Some(&progress) };
    let four = Settings { samples: 4, ..Settings::default() };
    render_with(&scene, &eye(), &four, &mut image, &control).expect("draws");
    let seen = seen.into_inner().expect("no panic");
    assert!(seen.len() >= 4 && seen.is_sorted() && seen.last() == Some(&1.0), "{seen:?}");
}

#[test]
fn wrong_settings_are_errors_with_a_clear_text() {
    let scene = still_life();
    let error = |settings: Settings, width, height| {
        render(&scene, &eye(), &settings, &mut Image::new(width, height, [0.0; 4]))
            .expect_err("refused")
            .to_string()
    };
    let usual = Settings::default();
    assert!(error(usual, 0, 4).contains("both sides must be at least 1"));
    assert!(error(Settings { samples: 0, ..usual }, 4, 4).contains("samples is 0, but must be 1 to 256"));
    assert!(error(Settings { tolerance_px: f64::NAN, ..usual }, 4, 4).contains("tolerance_px is NaN"));
    let crop = Some(Crop { x: 2, y: 0, width: u32::MAX, height: 1 });
    assert!(error(Settings { crop, ..usual }, 4, 4).contains("not inside the picture of 4 x 4"));
    let mut bad = scene.clone();
    bad.geometries[0].shape = Shape::Sphere { radius: -1.0 };
    let text =
        render(&bad, &eye(), &usual, &mut Image::new(4, 4, [0.0; 4])).expect_err("refused").to_string();
    assert!(text.contains("sphere") && text.contains("radius"), "{text}");
}

#[test]
fn hostile_places_give_a_picture() {
    let Shape::Mesh(mut mesh) = square(1.0) else { panic!("a mesh") };
    mesh.points[2] = Vec3::new(f32::NAN, f32::INFINITY, 0.0);
    let mut scene = still_life();
    place(&mut scene, Shape::Mesh(mesh), DVec3::ZERO, matte(LinearRgb::WHITE));
    place(&mut scene, square(1.0), DVec3::splat(f64::NAN), matte(LinearRgb::WHITE));
    place(&mut scene, square(1e30), DVec3::new(0.0, 0.0, -3.0), matte(LinearRgb::WHITE));
    let flat = scene.add_node(Node { geometry: Some(senca_scene::GeometryId(0)), ..Node::default() });
    scene.nodes[flat.index()].transform = Transform::Matrix(DMat4::from_scale(DVec3::new(1.0, 0.0, 1.0)));
    scene.roots.push(flat);
    for shading in ALL {
        let image = draw(&scene, &eye(), shading, 24);
        assert!(image.pixels().iter().flatten().all(|v| v.is_finite()), "{shading:?}");
    }
}

#[test]
fn an_empty_scene_is_its_background() {
    for shading in FACES {
        let image = draw(&Scene::default(), &eye(), shading, 3);
        assert!(image.pixels().iter().all(|&p| p == [0.0, 0.0, 0.0, 1.0]));
    }
}

#[test]
fn lines_and_points_of_meshes_are_drawn_among_the_faces() {
    let mesh = Mesh {
        points: vec![Vec3::new(-0.9, 0.06, 0.0), Vec3::new(0.9, 0.06, 0.0), Vec3::new(0.0, -0.55, 0.0)],
        vertices: Vertices {
            point: vec![0, 1, 2],
            color: vec![Vec4::ZERO, Vec4::ONE, Vec4::new(1.0, 0.0, 0.0, 1.0)],
            ..Vertices::default()
        },
        surfaces: vec![Surface::default()],
        lines: vec![[0, 1]],
        dots: vec![2],
        ..Mesh::default()
    };
    let mut scene = Scene::default();
    place(&mut scene, Shape::Mesh(mesh), DVec3::ZERO, matte(LinearRgb::WHITE));
    // A pane before the line's left half.
    place(&mut scene, square(0.4), DVec3::new(-0.6, 0.0, 1.0), unlit(LinearRgb::new(0.0, 0.0, 1.0), 1.0));
    for shading in FACES {
        let image = draw(&scene, &window_view(), shading, 20);
        assert_eq!(image.color(3, 9), LinearRgb::new(0.0, 0.0, 1.0), "{shading:?}: hidden");
        let grey = image.color(14, 9);
        assert!((grey.r - 0.75).abs() < 0.03 && grey.r == grey.b, "{shading:?}: {grey:?}");
        let red = image.pixels().iter().filter(|p| p[0] == 1.0 && p[1] == 0.0).count();
        assert_eq!(red, 4, "{shading:?}: a point of 2 x 2 pixels");
    }
}

#[test]
fn surroundings_are_seen_along_the_projectors() {
    let texels = (0..8u32).map(|i| [i as f32, 0.5, 1.0, 1.0]).collect();
    let data = ImageData::RgbaF32 { width: 4, height: 2, texels };
    let background = Background::Environment { image: ImageId(0), strength: 0.5, rotation: 0.3 };
    let images = vec![TextureImage { name: String::new(), data }];
    let mut scene = Scene { background, images, ..Scene::default() };
    let image = draw_with(&scene, &eye(), &Settings::default(), 9, 9);
    let device = senca_math::DeviceMap::to_pixels(9, 9).expect("a size");
    for (x, y) in [(0, 0), (4, 4), (8, 2)] {
        let ray = eye().ray_through(&device, senca_math::pixel_center(x, y)).expect("a ray");
        let expected = scene.environment_color(ray.direction.as_vec3());
        assert!((image.pixel(x, y)[0] - expected.r).abs() < 1e-4);
        assert_eq!(image.pixel(x, y)[3], 1.0);
    }
    // They are the ambient light of what faces them; their green is the same from all sides.
    let surroundings = senca_scene::Environment::of(&scene).expect("surroundings");
    let arriving = surroundings.irradiance().towards(senca_math::glam::Vec3::Z);
    assert!((arriving.g - 0.25).abs() < 1e-3, "{arriving:?}");
    place(&mut scene, square(1.0), DVec3::ZERO, matte(LinearRgb::WHITE));
    let lit = draw(&scene, &window_view(), Shading::Material, 5).pixel(2, 2);
    assert!((lit[1] - arriving.g).abs() < 1e-5 && (lit[0] - arriving.r).abs() < 1e-4);
}

#[test]
fn glass_without_an_alpha_is_seen_through() {
    let mut scene = Scene::default();
    let glass = Material { transmission: LinearRgb::splat(0.75), ..unlit(LinearRgb::WHITE, 1.0) };
    place(&mut scene, square(1.0), DVec3::Z, glass);
    place(&mut scene, square(1.0), DVec3::ZERO, unlit(LinearRgb::new(1.0, 0.0, 0.0), 1.0));
    let seen = draw(&scene, &window_view(), Shading::Material, 5).pixel(2, 2);
    assert!((seen[0] - 1.0).abs() < 1e-5 && (seen[1] - 0.25).abs() < 1e-5, "{seen:?}");
}
