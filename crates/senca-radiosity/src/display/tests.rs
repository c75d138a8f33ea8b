use senca_math::glam::DVec3;
use senca_math::{Image, LinearRgb, View};
use senca_scene::{Background, Geometry, Material, Node, Phong, Reflection, Scene, Shape, Transform};
use senca_trace::recursive::{RecursiveSettings, Tracer, Work};
use senca_trace::{Ray, World};

use super::*;
use crate::{ElementMesh, MeshSettings};

fn matt(diffuse: f32) -> Material {
    let color = LinearRgb::splat(diffuse);
    let phong = Phong { diffuse: color, ambient: color, ..Phong::default() };
    Material { reflection: Reflection::Phong(phong), ..Material::default() }
}

fn add(scene: &mut Scene, shape: Shape, place: DVec3, material: Material) {
    let material = Some(scene.add_material(material));
    let geometry = scene.add_geometry(Geometry { name: String::new(), shape, material });
    let transform = Transform::Parts { translation: place, rotation: Default::default(), scale: DVec3::ONE };
    let node = scene.add_node(Node { geometry: Some(geometry), transform, ..Node::default() });
    scene.roots.push(node);
}

/// A floor of 4 x 4 with a ball above it.
fn scene() -> Scene {
    let mut scene = Scene::default();
    add(&mut scene, Shape::Plane { size: Some(4.0) }, DVec3::ZERO, matt(0.5));
    add(&mut scene, Shape::Sphere { radius: 0.5 }, DVec3::new(0.0, 1.0, 0.0), matt(0.25));
    scene
}

/// The mesh, one corner of the floor divided deeper, and at each element the x of its middle.
fn light(scene: &Scene) -> (ElementMesh, Vec<LinearRgb>) {
    let settings = MeshSettings { patch_size: Some(0.7), ..MeshSettings::default() };
    let mut mesh = ElementMesh::of_scene(scene, &settings).expect("a mesh");
    let first = mesh.leaves().next().expect("a leaf");
    assert!(mesh.divide(first));
    let x = |element: &crate::Element| LinearRgb::splat(3.0 + element.center.x as f32);
    let values = mesh.elements().iter().map(x).collect();
    (mesh, values)
}

#[test]
fn places_on_floor_and_ball_find_their_elements() {
    let scene = scene();
    let (mesh, _) = light(&scene);
    let finder = ElementFinder::new(&mesh).expect("a finder");
    for i in 0..40 {
        for j in 0..40 {
            let at = |k: i32| -2.0 + 4.0 * f64::from(k) / 39.0;
            let point = DVec3::new(at(i), 0.0, at(j));
            let place = finder.find(0, 0, point, DVec3::Y).expect("floor");
            assert!(mesh.elements()[place.element as usize].is_leaf());
            let shape = mesh.shape(place.element);
            let [u, v] = shape.parameters_at(point);
            assert!(shape.place(u, v).distance(point) < 1e-9, "{point} is in its element");
        }
    }
    for i in 0..100 {
        let angle = f64::from(i);
        let normal = DVec3::new(angle.sin() * 0.8, (angle * 1.7).sin() * 0.6, angle.cos()).normalize();
        let place = finder.find(1, 1, DVec3::Y + 0.5 * normal, normal).expect("ball");
        assert_eq!(mesh.surface(place.element).instance, 1);
        assert!(mesh.normal(place.element).dot(normal) > 0.9);
    }
    assert_eq!(finder.find(0, 0, DVec3::ZERO, DVec3::NEG_Y), None, "the floor has one side");
    assert_eq!(finder.find(7, 0, DVec3::ZERO, DVec3::Y), None, "there is no such instance");
}

#[test]
fn smooth_light_has_no_steps_where_elements_meet() {
    let scene = scene();
    let (mesh, values) = light(&scene);
    let finder = ElementFinder::new(&mesh).expect("a finder");
    let field = LightField::new(&mesh, values, Interpolation::Smooth);
    let at = |x: f64, z: f64| {
        let place = finder.find(0, 0, DVec3::new(x, 0.0, z), DVec3::Y).expect("floor");
        field.at(place.element, place.point).r
    };
    for row in 0..23 {
        let z = -1.95 + 0.17 * f64::from(row);
        let mut last = at(-1.99, z);
        for step in 1..2000 {
            let next = at(-1.99 + 0.00199 * f64::from(step), z);
            assert!((next - last).abs() < 0.02, "a step of {} in row {z}", next - last);
            last = next;
        }
    }
}

#[test]
fn the_shown_scene_has_no_cracks_and_all_of_the_area() {
    let scene = scene();
    let (mesh, values) = light(&scene);
    let field = LightField::new(&mesh, values, Interpolation::Smooth);
    let shown = shown_scene(&scene, &field, ShownColors::Exact);
    assert!(shown.validate().is_ok());
    let Shape::Mesh(drawn) = &shown.geometries[0].shape else { panic!("a mesh") };
    let area: f64 = drawn
        .faces
        .iter()
        .map(|face| {
            let [a, b, c] = [0, 1, 2].map(|i| drawn.position(face[i]).as_dvec3());
            0.5 * (b - a).cross(c - a).length()
        })
        .sum();
    assert!((area - mesh.area()).abs() < 1e-5 * area);
    // Each edge inside the floor is there in both directions.
    let mut edges = std::collections::HashMap::new();
    for face in drawn.faces.iter() {
        for i in 0..3 {
            let [a, b] = [face[i], face[(i + 1) % 3]].map(|v| drawn.vertices.point[v as usize]);
            *edges.entry([a.min(b), a.max(b)]).or_insert(0) += if a < b { 1 } else { -1 };
        }
    }
    let at_rim = |point: u32| {
        let p = drawn.points[point as usize];
        p.y == 0.0 && p.x.abs().max(p.z.abs()) > 1.999
    };
    for ([a, b], balance) in edges {
        assert!(balance == 0 || (at_rim(a) && at_rim(b)), "an open edge");
    }
}

/// Course text, section 4.1: central projection does not keep ratios. Of an edge from depth 1 to depth 3 the
/// middle of the picture shows the place at a quarter, so light that grows evenly is a quarter there, and
/// not the half that interpolation in the picture between the edge's ends would give.
#[test]
fn light_is_interpolated_in_the_scene_and_not_in_the_picture() {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, -3.0], [-1.0, -3.0]].map(|[x, z]| DVec3::new(x, -1.0, z));
    let mut mesh = ElementMesh::of_polygons(&[(&corners, LinearRgb::WHITE, LinearRgb::BLACK)]);
    mesh.divide_to_size(0.3, 1 << 10).expect("few");
    let along = |e: &crate::Element| LinearRgb::splat(((-1.0 - e.center.z) / 2.0) as f32);
    let values = mesh.elements().iter().map(along).collect();
    let field = LightField::new(&mesh, values, Interpolation::Smooth);
    let frame = senca_math::world_from_look_at(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y).expect("a frame");
    let view = View::perspective(&frame, std::f64::consts::FRAC_PI_2, 1.0, 0.1, None).expect("a view");
    // From -1 to 1 the picture has 600 rows; the edge's ends are at heights -1 and -1/3.
    let ray = senca_trace::PrimaryRays::new(&view, 600, 600).through(300.0, 500.0);
    let place = ray.origin + ray.direction * (-1.0 / ray.direction.y);
    assert!((place.z + 1.5).abs() < 1e-9, "{place}");
    let finder = ElementFinder::new(&mesh).expect("a finder");
    let found = finder.find(0, 0, place, DVec3::Y).expect("the floor");
    let light = field.at(found.element, found.point).r;
    assert!((light - 0.25).abs() < 1e-5, "{light}");
}

/// Means of two pictures' columns agree: the pipeline and rays show the same.
#[test]
fn the_pipeline_and_rays_show_the_same_light() {
    let scene = Scene { background: Background::Color(LinearRgb::BLACK), ..scene() };
    let (mesh, values) = light(&scene);
    let frame = senca_math::world_from_look_at(DVec3::new(1.0, 3.0, 5.0), DVec3::ZERO, DVec3::Y);
    let view = View::perspective(&frame.expect("a frame"), 0.7, 1.0, 0.1, None).expect("a view");
    let size = 48;
    for interpolation in [Interpolation::Flat, Interpolation::Smooth] {
        let field = LightField::new(&mesh, values.clone(), interpolation);
        let finder = ElementFinder::new(&mesh).expect("a finder");
        let world = World::new(&scene).expect("a world");
        let light = ShownLight::new(&world, &field, &finder, Look::Matt);
        let settings = RecursiveSettings { max_depth: 0, ..RecursiveSettings::default() };
        let tracer = Tracer::new(&world, &view, [size; 2], scene.background, &settings);
        let tracer = tracer.with_surface_light(&light);
        let rays = senca_trace::PrimaryRays::new(&view, size, size);
        let shown = shown_scene(&scene, &field, ShownColors::Exact);
        let mut image = Image::new(size, size, [0.0; 4]);
        let drawing = senca_pipeline::Settings::default();
        senca_pipeline::render(&shown, &view, &drawing, &mut image).expect("a picture");
        let mut apart = 0;
        for y in 0..size {
            for x in 0..size {
                let ray = rays.through(f64::from(x) + 0.5, f64::from(y) + 0.5);
                let [traced, ..] =
                    tracer.light_along(Ray::new(ray.origin, ray.direction), &mut Work::default());
                let drawn = image.pixel(x, y)[0];
                apart += u32::from((traced - drawn).abs() > 0.05);
            }
        }
        assert!(apart < size * size / 40, "{apart} pixels differ, {interpolation:?}");
    }
}
