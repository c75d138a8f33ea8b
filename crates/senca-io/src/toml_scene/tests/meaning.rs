//! What is written is what is there.

use std::f64::consts::{FRAC_PI_2, PI};

use senca_math::LinearRgb;
use senca_math::glam::{DMat4, DQuat, DVec2, DVec3, Vec2, Vec3};
use senca_math::view::ViewingOperation;
use senca_scene::*;

use super::{error, read_text, scene};
use crate::toml_scene::{AccelerationHint, AntialiasingHint, MethodHint, RenderHints, ShadingHint};

fn close(a: DVec3, b: DVec3) -> bool {
    (a - b).length() < 1e-9
}

/// `world_from_node` of the first root and all below it, in the order of nodes.
fn places(text: &str) -> Vec<DMat4> {
    scene(text).world_from_nodes().into_iter().map(|m| m.expect("a root reaches it")).collect()
}

fn first_place(keys: &str) -> DMat4 {
    places(&format!("[[object]]\n{keys}"))[0]
}

/// Shape and place of the only object.
fn shape(keys: &str) -> (Shape, DMat4) {
    let scene = scene(&format!("[[object]]\n{keys}"));
    assert_eq!((scene.nodes.len(), scene.geometries.len()), (1, 1));
    (scene.geometries[0].shape.clone(), scene.nodes[0].transform.matrix())
}

#[test]
fn an_empty_file_is_an_empty_scene() {
    assert_eq!(read_text("").expect("reads"), Default::default());
    assert_eq!(scene("# nothing\n"), Scene::default());
}

#[test]
fn parts_scale_then_turn_then_move() {
    let place = first_place("scale = [1, 2, 3]\nrotate = [0, 0, 90]\ntranslate = [5, 0, 0]");
    assert!(close(place.transform_point3(DVec3::Y), DVec3::new(3.0, 0.0, 0.0)));
    let place = first_place("rotate = [90, 90, 0]");
    assert!(close(place.transform_point3(DVec3::Y), DVec3::X), "about x first: y to z, then about y: z to x");
    let axis = first_place("rotate = { axis = [0, 0, 2], angle = 90 }");
    assert!(close(axis.transform_point3(DVec3::X), DVec3::Y));
    let quaternion = first_place("rotate = { quaternion = [0, 0, 1, 1] }");
    assert!(close(quaternion.transform_point3(DVec3::X), DVec3::Y));
}

#[test]
fn matrices_and_steps_are_for_column_vectors() {
    let place = first_place("matrix = [[0, -1, 0, 5], [1, 0, 0, 6], [0, 0, 1, 7], [0, 0, 0, 1]]");
    assert!(close(place.transform_point3(DVec3::X), DVec3::new(5.0, 7.0, 7.0)));
    let steps = "transform = [{ translate = [1, 0, 0] }, { rotate = [0, 0, 90] }, { scale = 2 }]";
    assert!(close(first_place(steps).transform_point3(DVec3::ZERO), DVec3::new(0.0, 2.0, 0.0)));
    let shear = "transform = [{ shear = { x = [0.5, 0.25] } }]";
    assert!(close(first_place(shear).transform_point3(DVec3::ONE), DVec3::new(1.75, 1.0, 1.0)));
}

#[test]
fn look_at_points_minus_z_at_the_target() {
    let place = first_place("look_at = { eye = [0, 0, 5], target = [5, 0, 5] }");
    assert!(close(place.transform_point3(DVec3::NEG_Z), DVec3::new(1.0, 0.0, 5.0)));
    assert!(close(place.transform_vector3(DVec3::Y), DVec3::Y));
    let down = first_place("look_at = { eye = [0, 5, 0], target = [0, 0, 0] }");
    assert!(close(down.transform_vector3(DVec3::NEG_Z), DVec3::NEG_Y));
    assert!(close(down.transform_vector3(DVec3::Y), DVec3::NEG_Z), "-z is up on a map");
}

#[test]
fn children_follow_their_parent() {
    let text = "[[object]]\ntranslate = [1, 0, 0]\n[[object.child]]\ntranslate = [0, 2, 0]\n\
                [[object.child.child]]\ntranslate = [0, 0, 3]\n[[object.child]]\ntranslate = [0, 0, 9]";
    let places: Vec<_> = places(text).iter().map(|m| m.w_axis.truncate()).collect();
    assert_eq!(places, [DVec3::X, DVec3::new(1., 2., 0.), DVec3::new(1., 2., 3.), DVec3::new(1., 0., 9.)]);
}

#[test]
fn round_shapes_have_their_natural_keys() {
    let (sphere, place) = shape("shape = 'sphere'\nradius = 2\ncenter = [1, 2, 3]");
    assert_eq!(sphere, Shape::Sphere { radius: 2.0 });
    assert_eq!(place.w_axis.truncate(), DVec3::new(1.0, 2.0, 3.0));
    assert_eq!(
        shape("shape = 'ellipsoid'\nradii = [1, 2, 3]").0,
        Shape::Ellipsoid { radii: DVec3::new(1., 2., 3.) }
    );
    let (torus, place) = shape("shape = 'torus'\nmajor_radius = 3\nminor_radius = 1\nnormal = [0, 0, 1]");
    assert_eq!(torus, Shape::Torus { major_radius: 3.0, minor_radius: 1.0 });
    assert!(close(place.transform_vector3(DVec3::Y), DVec3::Z));
    let (disc, place) = shape("shape = 'disc'\nradius = 2\ninner_radius = 1\nnormal = [0, -3, 0]");
    assert_eq!(disc, Shape::Disc { radius: 2.0, inner_radius: 1.0 });
    assert!(close(place.transform_vector3(DVec3::Y), DVec3::NEG_Y));
    assert_eq!(shape("shape = 'plane'").0, Shape::Plane { size: None });
}

#[test]
fn boxes_are_given_by_size_or_corners() {
    assert_eq!(shape("shape = 'box'\nsize = 2").0, Shape::Box { size: DVec3::splat(2.0) });
    let (cuboid, place) = shape("shape = 'box'\nmin = [0, 0, 0]\nmax = [2, 4, 6]");
    assert_eq!(cuboid, Shape::Box { size: DVec3::new(2.0, 4.0, 6.0) });
    assert_eq!(place.w_axis.truncate(), DVec3::new(1.0, 2.0, 3.0));
}

#[test]
fn axes_are_given_by_height_or_ends() {
    let (cylinder, place) =
        shape("shape = 'cylinder'\nfrom = [1, 1, 0]\nto = [4, 5, 0]\nradius = 2\ncapped = false");
    assert_eq!(cylinder, Shape::Cylinder { radius: 2.0, height: 5.0, capped: false });
    assert!(close(place.transform_point3(DVec3::ZERO), DVec3::new(1.0, 1.0, 0.0)));
    assert!(close(place.transform_point3(DVec3::Y * 5.0), DVec3::new(4.0, 5.0, 0.0)));
    let (cone, place) = shape("shape = 'cone'\nbase = [0, 1, 0]\nradius = 1\ntop_radius = 0.5\nheight = 3");
    assert_eq!(cone, Shape::Cone { radius: 1.0, top_radius: 0.5, height: 3.0, capped: true });
    assert_eq!(place.w_axis.truncate(), DVec3::Y);
    let (_, down) = shape("shape = 'cylinder'\nfrom = [0, 1, 0]\nto = [0, 0, 0]");
    assert!(close(down.transform_vector3(DVec3::Y), DVec3::NEG_Y));
}

#[test]
fn a_center_is_turned_with_its_object() {
    let text =
        "[[object]]\nname = 'moon'\nshape = 'sphere'\ncenter = [2, 0, 0]\nrotate = [0, 0, 90]\nmaterial = {}";
    let scene = scene(text);
    let instances = scene.instances();
    assert_eq!(instances.len(), 1);
    assert!(close(instances[0].world_from_object.w_axis.truncate(), DVec3::Y * 2.0));
    assert!(scene.nodes[instances[0].node.index()].material.is_some());
}

#[test]
fn sweeps_keep_their_outlines() {
    let (prism, _) = shape("shape = 'prism'\npoints = [[0,0],[1,0],[0,1]]\nheight = 2\ncapped = false");
    let base = vec![DVec2::ZERO, DVec2::X, DVec2::Y];
    assert_eq!(prism, Shape::Prism { base, height: 2.0, capped: false });
    let (turned, _) = shape("shape = 'revolution'\nprofile = [[1,0],[2,1]]\nangle = 90");
    let profile = vec![DVec2::X, DVec2::new(2.0, 1.0)];
    assert_eq!(turned, Shape::Revolution { profile, bezier: false, angle: FRAC_PI_2, capped: true });
    let (polygon, _) =
        shape("shape = 'polygon'\npoints = [[0,0,0],[9,0,0],[0,9,0]]\nholes = [[[1,1,0],[1,2,0],[2,1,0]]]");
    let Shape::Polygon { outline, holes } = polygon else { panic!("a polygon") };
    assert_eq!((outline.len(), holes[0].len()), (3, 3));
}

#[test]
fn alignment_points_stay_at_their_corners() {
    let (polygon, _) =
        shape("shape = 'polygon'\npoints = [[1,1,1],[4,5,1],[1,1,3]]\nuv = [[0.1,0.2],[0.9,0.2],[0.1,0.8]]");
    let Shape::Mesh(mesh) = polygon else { panic!("a mesh") };
    assert_eq!(mesh.faces.corners, [0, 1, 2]);
    assert_eq!(mesh.vertices.texcoord0, [Vec2::new(0.1, 0.2), Vec2::new(0.9, 0.2), Vec2::new(0.1, 0.8)]);
}

#[test]
fn surfaces_share_points_but_not_vertices() {
    let (mesh, _) = shape(
        "shape = 'mesh'\npoints = [[0,0,0],[1,0,0],[1,1,0],[0,1,0],[0,0,1]]\ncolors = [1,1,1,1,[0.5,0.5,0.5,0.25]]\n\
         [[object.surface]]\nname = 'a'\nfaces = [[0,1,2],[0,2,3]]\n[[object.surface]]\nname = 'b'\nsmooth = true\nfaces = [[0,4,1]]",
    );
    let Shape::Mesh(mesh) = mesh else { panic!("a mesh") };
    assert_eq!(mesh.points.len(), 5);
    assert_eq!(mesh.vertices.point, [0, 1, 2, 3, 0, 4, 1], "points 0 and 1 are seen from both surfaces");
    assert_eq!(mesh.faces.iter().map(<[u32]>::to_vec).collect::<Vec<_>>(), [[0, 1, 2], [0, 2, 3], [4, 5, 6]]);
    assert_eq!([0, 1, 2].map(|face| mesh.faces.surface_of(face)), [0, 0, 1]);
    assert_eq!(mesh.surfaces.iter().map(|s| s.smooth).collect::<Vec<_>>(), [false, true]);
    assert_eq!(mesh.vertices.color[5].to_array(), [0.5, 0.5, 0.5, 0.25]);
}

#[test]
fn face_uv_splits_vertices_where_it_differs() {
    let (mesh, _) = shape(
        "shape = 'mesh'\npoints = [[0,0,0],[1,0,0],[1,1,0],[0,1,0]]\nfaces = [[0,1,2],[0,2,3]]\n\
         face_uv = [[[0,0],[1,0],[1,1]],[[0,0],[0.5,1],[0,1]]]\nlines = [[0,1]]\ndots = [3]",
    );
    let Shape::Mesh(mesh) = mesh else { panic!("a mesh") };
    assert_eq!(mesh.vertices.point[..5], [0, 1, 2, 2, 3]);
    assert_eq!(mesh.vertices.texcoord0.len(), mesh.vertices.point.len());
    assert_eq!((mesh.lines.len(), mesh.dots.len()), (1, 1));
}

#[test]
fn groupings_make_the_faces_of_the_figure() {
    let points = |n: i32| (0..n).map(|i| format!("[{i},{},0]", i * i)).collect::<Vec<_>>().join(",");
    let faces = |keys: &str| {
        let (Shape::Mesh(mesh), _) = shape(keys) else { panic!("a mesh") };
        mesh.faces.iter().map(<[u32]>::to_vec).collect::<Vec<_>>()
    };
    let strip = faces(&format!("shape = 'triangle-strip'\npoints = [{}]", points(5)));
    assert_eq!(strip, [[0, 1, 2], [2, 1, 3], [2, 3, 4]]);
    let fan = faces(&format!("shape = 'triangle-fan'\npoints = [{}]", points(5)));
    assert_eq!(fan, [[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
    let quads = faces(&format!("shape = 'quad-strip'\npoints = [{}]", points(6)));
    assert_eq!(quads, [[0, 1, 3, 2], [2, 3, 5, 4]]);
    let mesh = faces(&format!("shape = 'quad-mesh'\nrows = [[{0}],[{0}]]", points(3)));
    assert_eq!(mesh, [[0, 3, 4, 1], [1, 4, 5, 2]]);
}

#[test]
fn morph_targets_and_weights_are_read() {
    let scene = scene(
        "[[object]]\nshape = 'mesh'\npoints = [[0,0,0],[1,0,0],[0,1,0]]\nfaces = [[0,1,2]]\nmorph_weights = [0.5]\n\
         [[object.morph]]\nname = 'up'\npoints = [[0,1,0],[0,1,0],[0,1,0]]",
    );
    let Shape::Mesh(mesh) = &scene.geometries[0].shape else { panic!("a mesh") };
    assert_eq!(mesh.morph_targets[0].points, [Vec3::Y; 3]);
    assert_eq!(scene.nodes[0].morph_weights, [0.5]);
}

#[test]
fn patches_take_lists_or_rows() {
    let row = "[0,0,0],[1,0,0],[2,0,0],[3,0,0]";
    let flat = shape(&format!("shape = 'bezier'\npoints = [{row},{row},{row},{row}]")).0;
    assert_eq!(flat, shape(&format!("shape = 'bezier'\npatches = [[[{row}],[{row}],[{row}],[{row}]]]")).0);
    let (with_surface, _) = shape(&format!(
        "shape = 'bezier'\npatches = [{{ points = [{row},{row},{row},{row}], surface = 3 }}]"
    ));
    let Shape::BezierPatches { patches } = with_surface else { panic!("patches") };
    assert_eq!((patches[0].surface, patches[0].points[6]), (3, DVec3::X * 2.0));
}

#[test]
fn nurbs_get_clamped_even_knots() {
    let row = "[[0,0,0],[1,0,0],[2,0,0],[3,0,0],[4,0,0]]";
    let Shape::Nurbs(nurbs) = shape(&format!("shape = 'nurbs'\npoints = [{row},{row}]")).0 else {
        panic!("NURBS")
    };
    assert_eq!((nurbs.degree, nurbs.counts), ([3, 1], [5, 2]));
    assert_eq!(nurbs.knots, [vec![0., 0., 0., 0., 1., 2., 2., 2., 2.], vec![0., 0., 1., 1.]]);
    assert_eq!((nurbs.points.len(), nurbs.weights.len()), (10, 0));
}

#[test]
fn colors_have_four_forms() {
    let color = |text: &str| match scene(&format!("background = {text}")).background {
        Background::Color(color) => color,
        other => panic!("{other:?}"),
    };
    assert_eq!(color("[0.1, 2, 0]"), LinearRgb::new(0.1, 2.0, 0.0));
    assert_eq!(color("0.25"), LinearRgb::splat(0.25));
    assert_eq!(color("'#ff8000'"), senca_math::Srgb8 { r: 255, g: 128, b: 0 }.to_linear());
    assert_eq!(color("'#F80'"), color("'#ff8800'"));
    assert_eq!(color("'green'"), LinearRgb::new(0.0, 1.0, 0.0));
    assert_eq!(color("'grey'"), color("'#808080'"));
    let gradient = scene("background = { bottom = 0, top = 1 }").background;
    assert_eq!(gradient, Background::Gradient { bottom: LinearRgb::BLACK, top: LinearRgb::WHITE });
}

fn material(keys: &str) -> Material {
    scene(&format!("[material.m]\n{keys}")).materials.remove(0)
}

#[test]
fn phong_materials_have_the_coefficients_of_the_text() {
    let m = material(
        "ambient = 0.1\ndiffuse = [0.2, 0.3, 0.4]\nspecular = 0.5\nexponent = 60\nalpha = 0.5\nmirror = 0.25\n\
         transmission = 0.75\nior = 1.33\nemission = [2, 0, 0]\ndouble_sided = true\nunlit = true",
    );
    let Reflection::Phong(phong) = &m.reflection else { panic!("Phong") };
    assert_eq!((phong.ambient, phong.diffuse), (LinearRgb::splat(0.1), LinearRgb::new(0.2, 0.3, 0.4)));
    assert_eq!((phong.specular.r, phong.exponent, phong.alpha), (0.5, 60.0, 0.5));
    assert_eq!((m.mirror.r, m.transmission.r, m.ior, m.emission.r), (0.25, 0.75, 1.33, 2.0));
    assert_eq!(m.alpha_mode, AlphaMode::Blend, "alpha below 1 blends");
    assert!(m.double_sided && m.unlit);
    assert_eq!(material(""), Material { name: "m".into(), ..Material::default() });
    let Reflection::Phong(phong) = material("color = 0.3").reflection else { panic!("Phong") };
    assert_eq!((phong.ambient.r, phong.diffuse.r), (0.3, 0.3));
    let Reflection::Phong(phong) = material("diffuse = 0.3").reflection else { panic!("Phong") };
    assert_eq!(phong.ambient.r, 0.3, "Oa follows Od");
}

#[test]
fn metallic_materials_are_told_by_their_keys() {
    let m = material("base_color = 'red'\nmetallic = 1\nalpha_mode = 'mask'\ncutoff = 0.3");
    let Reflection::MetallicRoughness(metallic) = &m.reflection else { panic!("metallic") };
    assert_eq!((metallic.base_color.r, metallic.metallic, metallic.roughness), (1.0, 1.0, 0.5));
    assert_eq!(m.alpha_mode, AlphaMode::Mask { cutoff: 0.3 });
}

#[test]
fn materials_go_down_to_what_names_none() {
    let scene = scene(
        "[material.a]\n[material.b]\n[define.pair]\nchild = [{ shape = 'sphere' }, { shape = 'box', material = 'b' }]\n\
         [[object]]\nuse = 'pair'\nmaterial = 'a'\n[[object]]\nuse = 'pair'",
    );
    assert_eq!(scene.geometries.len(), 2, "both uses share their shapes");
    let materials: Vec<_> = scene.instances().iter().map(|i| scene.nodes[i.node.index()].material).collect();
    let [a, b] = [MaterialId(0), MaterialId(1)];
    assert_eq!(materials, [Some(a), Some(b), None, Some(b)]);
}

#[test]
fn textures_keep_their_texels_and_rules() {
    let scene = scene(
        "[texture.t]\ntexels = [[[1, 0, 0], 0.5], ['white', [0, 0, 2]]]\nwrap = ['clamp', 'mirror']\nfilter = 'footprint'\n\
         [material.m]\ntexture = { name = 't', scale = [2, 3], offset = [0.5, 0], texcoord = 1 }\nspecular_texture = 't'",
    );
    let ImageData::RgbaF32 { width, height, texels } = &scene.images[0].data else { panic!("floats") };
    assert_eq!((*width, *height, texels[1], texels[3]), (2, 2, [0.5, 0.5, 0.5, 1.0], [0.0, 0.0, 2.0, 1.0]));
    let texture = &scene.textures[0];
    assert_eq!(
        (texture.wrap_u, texture.wrap_v, texture.filter),
        (Wrap::Clamp, Wrap::Mirror, Filter::Footprint)
    );
    let Reflection::Phong(phong) = &scene.materials[0].reflection else { panic!("Phong") };
    let used = phong.texture.expect("a texture");
    assert_eq!(used.uv_transform.transform_point2(Vec2::ONE), Vec2::new(2.5, 3.0));
    assert_eq!((used.texcoord, used.texture), (1, TextureId(0)));
    assert_eq!(phong.specular_texture, Some(TextureRef::new(TextureId(0))));
}

fn light(keys: &str) -> (Light, DMat4) {
    let scene = scene(&format!("[light]\n{keys}"));
    (scene.lights[0].clone(), scene.nodes[0].transform.matrix())
}

#[test]
fn lights_stand_and_shine_where_they_should() {
    let (point, place) = light("kind = 'point'\nposition = [1, 2, 3]\ncolor = [1, 0.5, 0]\nintensity = 10");
    assert_eq!((point.kind, point.color), (LightKind::Point, LinearRgb::new(10.0, 5.0, 0.0)));
    assert_eq!(place.w_axis.truncate(), DVec3::new(1.0, 2.0, 3.0));
    let (sun, place) = light("kind = 'parallel'\ndirection = [0, -3, 0]");
    assert_eq!(sun.kind, LightKind::Parallel);
    assert!(close(place.transform_vector3(DVec3::NEG_Z), DVec3::NEG_Y));
    let (spot, place) = light("kind = 'spot'\nposition = [0, 0, 4]\ntarget = [4, 0, 4]\nangle = 30");
    assert_eq!(spot.kind, LightKind::Spot(SpotFalloff::Sharp { angle: PI / 6.0 }));
    assert!(close(place.transform_vector3(DVec3::NEG_Z), DVec3::X));
    let spot = |keys: &str| light(&format!("kind = 'spot'\ndirection = [0, 0, -1]\n{keys}")).0.kind;
    assert_eq!(spot("exponent = 10"), LightKind::Spot(SpotFalloff::Cosine { exponent: 10.0 }));
    assert_eq!(
        spot("inner = 0\nouter = 90"),
        LightKind::Spot(SpotFalloff::Smooth { inner: 0.0, outer: FRAC_PI_2 })
    );
    let (area, _) = light("kind = 'area'\ndirection = [0, -1, 0]\nsize = [2, 1]");
    assert_eq!(area.kind, LightKind::Area { size: [2.0, 1.0], visible: true });
    assert_eq!(light("kind = 'ambient'\ncolor = 0.1").0.kind, LightKind::Ambient);
}

/// Course text, section 2.5: where points lie in the frame of a box reflector.
#[test]
fn the_box_reflector_has_the_frame_of_the_text() {
    let (light, place) = light(
        "kind = 'box'\nposition = [0, 5, 0]\ndirection = [0, -1, 0]\nup = [0, 0, 1]\nx = [-1, 0.25]\ny = [-1, 1]\ndepth = 10",
    );
    let LightKind::BoxSpot { min, max, depth } = light.kind else { panic!("a box") };
    let lit = |point: [f64; 3]| {
        let p = place.inverse().transform_point3(DVec3::from_array(point));
        let inside = |axis: usize| min[axis] <= p[axis] && p[axis] <= max[axis];
        inside(0) && inside(1) && (0.0..=depth).contains(&-p.z)
    };
    // The text's x axis is world x here, its y axis world z.
    assert!(lit([0.0, 0.0, 0.0]) && lit([0.2, 1.0, 0.25]) && lit([-0.9, 1.0, -0.9]));
    assert!(!lit([0.5, 1.0, 0.25]), "beyond the limit of x");
    assert!(!lit([1.5, 1.0, 0.0]) && !lit([0.0, 6.0, 0.0]) && !lit([0.0, -6.0, 0.0]));
}

#[test]
fn attenuation_has_its_forms_and_a_common_default() {
    let of = |text: &str| {
        light(&format!("kind = 'point'\nposition = [0,0,0]\nattenuation = {text}")).0.attenuation
    };
    let poly = |constant, linear, quadratic| Attenuation::Polynomial { constant, linear, quadratic };
    assert_eq!(of("[1, 0.5, 0.25]"), poly(1.0, 0.5, 0.25));
    assert_eq!(of("{ linear = 0.1 }"), poly(0.0, 0.1, 0.0));
    assert_eq!(of("'inverse-square'"), Attenuation::InverseSquare { range: None });
    assert_eq!(of("{ range = 9 }"), Attenuation::InverseSquare { range: Some(9.0) });
    assert_eq!(of("'none'"), Attenuation::None);
    let lights = "attenuation = [0, 0.1, 0]\n[[light]]\nkind = 'point'\nposition = [0,0,0]\n\
                  [[light]]\nkind = 'point'\nposition = [0,0,0]\nattenuation = 'none'";
    let lights = scene(lights).lights;
    assert_eq!((lights[0].attenuation, lights[1].attenuation), (poly(0.0, 0.1, 0.0), Attenuation::None));
}

#[test]
fn fog_is_linear_or_exponential() {
    let fog = |keys: &str| scene(&format!("[fog]\ncolor = 0.5\n{keys}")).fog.expect("fog").falloff;
    assert_eq!(
        fog("start = 10\nend = 40\nmin_share = 0.1"),
        FogFalloff::Linear { start: 10.0, end: 40.0, min_share: 0.1 }
    );
    assert_eq!(fog("density = 2"), FogFalloff::Exponential { density: 2.0 });
    assert_eq!(
        fog("density = 2\nfalloff = 'exponential-squared'"),
        FogFalloff::ExponentialSquared { density: 2.0 }
    );
}

fn camera(keys: &str) -> (Projection, DMat4) {
    let scene = scene(&format!("[camera]\n{keys}"));
    (scene.cameras[0].projection.clone(), scene.nodes[0].transform.matrix())
}

#[test]
fn cameras_look_at_their_targets() {
    let (projection, place) = camera("eye = [0, 0, 5]\ntarget = [0, 0, 0]\nfov = 90\nnear = 0.5");
    let expected = Projection::Perspective { yfov: FRAC_PI_2, aspect: None, near: Some(0.5), far: None };
    assert_eq!(projection, expected);
    assert_eq!(place.w_axis.truncate(), DVec3::Z * 5.0);
    let (projection, _) = camera("height = 4\naspect = 1.5\nnear = -1\nfar = 9");
    let expected =
        Projection::Orthographic { height: 4.0, aspect: Some(1.5), near: Some(-1.0), far: Some(9.0) };
    assert_eq!(projection, expected);
    let (_, place) = camera("translate = [1, 2, 3]\nrotate = [0, 90, 0]");
    assert!(close(place.transform_vector3(DVec3::NEG_Z), DVec3::NEG_X));
}

/// Course text, sections 1.5 to 1.7.
#[test]
fn cameras_take_the_viewing_operations_of_the_text() {
    let keys = "vrp = [1,2,3]\nvpn = [1,2,2]\nvup = [0,0,1]\nprp = [0.5,-0.5,4]\nwindow = [-1,2,-1.5,1.5]\nfront = 1\nback = -4";
    let (b, place) = camera(&format!("operation = 'B'\n{keys}"));
    let Projection::Operation(ViewingOperation::Central(parameters)) = b else { panic!("B") };
    assert_eq!((parameters.vrp, parameters.vpn), (DVec3::new(1., 2., 3.), DVec3::new(1., 2., 2.)));
    assert_eq!((parameters.window.umax, parameters.front, parameters.back), (2.0, 1.0, -4.0));
    assert_eq!(place, DMat4::IDENTITY);
    let (c, _) = camera(&format!("operation = 'C'\n{keys}"));
    assert_eq!(c, Projection::Operation(ViewingOperation::Parallel(parameters)));
    let (old, _) = camera(&format!("operation = '1991-parallel'\n{keys}"));
    assert!(
        matches!(old, Projection::Operation(ViewingOperation::View1991(v)) if v.parameters == parameters)
    );

    let third = 1.0 / 3.0;
    let a = format!("operation = 'A'\np = [1,2,3]\nn = [{}, {third}, {}]\nf = 2", 2.0 * third, 2.0 * third);
    let (open, _) = camera(&a);
    assert!(matches!(open, Projection::Operation(ViewingOperation::CentralByNormal(a)) if a.focal == 2.0));
    let (bounded, _) = camera(&format!("{a}\nwindow = [-1,1,-1,1]\nfront = 0\nback = -9"));
    let Projection::Operation(ViewingOperation::Central(parameters)) = bounded else { panic!("B") };
    assert!((parameters.prp - DVec3::Z * 2.0).length() < 1e-12);
    let (parallel, _) = camera("operation = 'P'\np = [1,2,3]\nn = [0,0,1]");
    assert!(matches!(parallel, Projection::Operation(ViewingOperation::ParallelByNormal(_))));
}

#[test]
fn lights_and_cameras_may_ride_on_objects() {
    let scene = scene(
        "[[object]]\ntranslate = [5, 0, 0]\n[[object.light]]\nkind = 'point'\nposition = [0, 1, 0]\n[object.camera]\neye = [0, 2, 0]",
    );
    let places: Vec<_> =
        scene.world_from_nodes().into_iter().map(|m| m.expect("reached").w_axis.truncate()).collect();
    assert_eq!(places, [DVec3::new(5., 0., 0.), DVec3::new(5., 1., 0.), DVec3::new(5., 2., 0.)]);
    assert!(scene.nodes[1].light.is_some() && scene.nodes[2].camera.is_some());
}

fn channel(keys: &str) -> Channel {
    let text = format!("[[object]]\nname = 'a'\n[[animation]]\nnode = 'a'\n{keys}");
    scene(&text).animations.remove(0).channels.remove(0)
}

#[test]
fn animations_hold_their_keys() {
    let c =
        channel("property = 'translate'\ntimes = [0, 2]\nvalues = [[0,0,0],[1,2,3]]\ninterpolation = 'step'");
    assert_eq!((c.times, c.interpolation), (vec![0.0, 2.0], Interpolation::Step));
    assert_eq!(c.values, ChannelValues::Translation(vec![DVec3::ZERO, DVec3::new(1., 2., 3.)]));
    let c = channel("property = 'scale'\ntimes = [0, 1]\nvalues = [1, [1, 2, 3]]");
    assert_eq!(c.values, ChannelValues::Scale(vec![DVec3::ONE, DVec3::new(1., 2., 3.)]));
    let c = channel("property = 'weights'\ntimes = [0, 1]\nvalues = [[0, 1], [1, 0]]");
    assert_eq!(c.values, ChannelValues::Weights { count: 2, values: vec![0., 1., 1., 0.] });
    let c = channel(
        "property = 'translate'\ninterpolation = 'cubic'\ntimes = [1]\nvalues = [{ in = [1,0,0], value = [2,0,0], out = [3,0,0] }]",
    );
    assert_eq!(c.values, ChannelValues::Translation([1., 2., 3.].map(|x| DVec3::X * x).to_vec()));
    let points = "points = [[0,0,0],[1,0,0],[2,0,0],[3,0,0]]";
    let c = channel(&format!("property = 'path'\ntimes = [0, 1, 5]\n{points}\nlook_ahead = true"));
    let ChannelValues::Path { parameters, look_ahead, .. } = c.values else { panic!("a path") };
    assert_eq!((parameters, look_ahead), (vec![0.0, 0.5, 1.0], true));
}

#[test]
fn whole_turns_are_not_lost() {
    for values in ["[[0,0,0],[0,0,360]]", "[{axis=[0,0,1],angle=0},{axis=[0,0,2],angle=360}]"] {
        let c = channel(&format!("property = 'rotate'\ntimes = [0, 6]\nvalues = {values}"));
        assert_eq!(c.times, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        let ChannelValues::Rotation(turns) = c.values else { panic!("rotations") };
        for (i, turn) in turns.iter().enumerate() {
            let expected = DQuat::from_rotation_z(i as f64 * PI / 3.0);
            assert!(turn.dot(expected).abs() > 1.0 - 1e-12, "{i}");
        }
    }
    let c = channel("property = 'rotate'\ntimes = [0, 1]\nvalues = [[0,0,0,1],[0,0,1,0]]");
    assert_eq!(c.times, [0.0, 1.0], "quaternions stay as they are");
}

#[test]
fn animations_of_one_name_run_together() {
    let scene = scene(
        "[[object]]\nname = 'a'\n[[animation]]\nname = 'x'\nnode = 'a'\nproperty = 'scale'\ntimes = [0]\nvalues = [1]\n\
         [[animation]]\nnode = 'a'\nproperty = 'scale'\ntimes = [0]\nvalues = [1]\n\
         [[animation]]\nname = 'x'\nnode = 'a'\nproperty = 'rotate'\ntimes = [0]\nvalues = [[0,0,0]]",
    );
    let counts: Vec<_> = scene.animations.iter().map(|a| (a.name.as_str(), a.channels.len())).collect();
    assert_eq!(counts, [("x", 2), ("", 1)]);
}

#[test]
fn render_hints_are_read() {
    let text = "[render]\nsize = [640, 480]\nmethod = 'trace'\nshading = 'hidden-line'\ncamera = 'c'\nsamples = 16\ntime = 1.5\nmax_depth = 5\naa = 'adaptive'\naccel = 'octree'\n[camera]\nname = 'c'";
    let expected = RenderHints {
        size: Some([640, 480]),
        method: Some(MethodHint::Trace),
        shading: Some(ShadingHint::HiddenLine),
        camera: Some("c".to_owned()),
        samples: Some(16),
        time: Some(1.5),
        max_depth: Some(5),
        aa: Some(AntialiasingHint::Adaptive),
        accel: Some(AccelerationHint::Octree),
    };
    assert_eq!(read_text(text).expect("reads").render, expected);
}

#[test]
fn implicit_surfaces_are_read() {
    let (of, place) = shape(
        "shape = 'implicit'\nexpression = 'x^2 + y^2 - 1'\nmin = -2\nmax = [2, 3, 4]\ncapped = false\ncenter = [0, 1, 0]",
    );
    let Shape::Implicit(surface) = of else { panic!("not implicit") };
    assert_eq!(surface.expression.to_string(), "x^2 + y^2 - 1");
    assert_eq!((surface.bounds.min, surface.bounds.max), (DVec3::splat(-2.0), DVec3::new(2.0, 3.0, 4.0)));
    assert!(!surface.capped);
    assert_eq!(place.w_axis.y, 1.0);
    let Shape::Implicit(plain) = shape("shape = 'implicit'\nexpression = 'z'").0 else {
        panic!("not implicit")
    };
    assert_eq!((plain.bounds.min, plain.bounds.max, plain.capped), (-DVec3::ONE, DVec3::ONE, true));
}

#[test]
fn bodies_are_put_together() {
    let text = "[material.red]\ncolor = 'red'\n[[object]]\nshape = 'csg'\noperation = 'difference'\nbodies = [\n\
        { shape = 'box', size = 2 },\n\
        { operation = 'union', material = 'red', translate = [1, 0, 0], bodies = [\n\
            { shape = 'sphere', radius = 0.5, center = [0, 2, 0] },\n\
            { shape = 'cylinder', name = 'bore', from = [0, -2, 0], to = [0, 2, 0], material = { color = 'blue' } },\n\
        ] },\n]";
    let scene = scene(text);
    assert_eq!(scene.validate(), Ok(()));
    let Shape::Csg(csg) = &scene.geometries[0].shape else { panic!("not csg") };
    let CsgNode::Difference(nodes) = &csg.root else { panic!("not a difference") };
    assert!(matches!(nodes[1], CsgNode::Union(_)));
    let leaves = csg.leaves();
    assert_eq!(leaves.iter().map(|l| l.name.as_str()).collect::<Vec<_>>(), ["", "", "bore"]);
    assert_eq!(leaves[1].transform.matrix().w_axis.truncate(), DVec3::new(1.0, 2.0, 0.0));
    assert_eq!(leaves.iter().map(|l| l.material.map(|m| m.0)).collect::<Vec<_>>(), [None, Some(0), Some(1)]);
}

#[test]
fn lenses_shutters_and_surroundings_are_read() {
    let camera = |text: &str| scene(&format!("[camera]\n{text}")).cameras[0].clone();
    assert_eq!((camera("fov = 40").lens, camera("fov = 40").shutter), (None, None));
    let lens = camera("lens = { radius = 0.1, focus = 5 }").lens.expect("a lens");
    assert_eq!((lens.radius, lens.focus_distance), (0.1, 5.0));
    assert_eq!(camera("shutter = 0.5").shutter, Some([0.0, 0.5]));
    assert_eq!(camera("shutter = [-0.25, 0.25]").shutter, Some([-0.25, 0.25]));
    let glass =
        "[material.g]\ntransmission = 0.9\nmirror = 1\nfresnel = true\nabsorption = [0, 1, 2]\nior = 1.3";
    let material = scene(glass).materials[0].clone();
    assert!(material.fresnel && material.absorption.b == 2.0 && material.absorption.r == 0.0);
    assert!(error("background = { environment = 'sky.exr' }").contains("sky.exr"));
}
