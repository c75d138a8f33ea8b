use super::*;
use crate::hierarchy::facet::Facet;

fn quad(origin: [f64; 3], u: [f64; 3], v: [f64; 3]) -> [DVec3; 4] {
    let [o, u, v] = [origin, u, v].map(DVec3::from_array);
    [o, o + u, o + u + v, o + v]
}

/// A floor, a lamp of 1 x 1 at height 2 that looks down, and a plate below half of it.
fn scene() -> ElementMesh {
    let floor = quad([-5.0, 0.0, -5.0], [0.0, 0.0, 10.0], [10.0, 0.0, 0.0]);
    let lamp = quad([-0.5, 2.0, -0.5], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
    let plate = quad([0.0, 1.99, -1.0], [1.0, 0.0, 0.0], [0.0, 0.0, 2.0]);
    let grey = LinearRgb::splat(0.5);
    let polygons = [(floor, 0.0), (lamp, 10.0), (plate, 0.0)];
    let polygons: Vec<_> = polygons.iter().map(|(c, e)| (&c[..], grey, LinearRgb::splat(*e))).collect();
    ElementMesh::of_polygons(&polygons)
}

#[test]
fn a_half_hidden_lamp_gives_half_of_its_light() {
    let mesh = scene();
    let occluders = Occluders::new(&mesh).expect("few");
    let gather = DirectGather::new(&mesh, &DirectLight::default(), &occluders, &GatherSettings::default());
    let light = |x: f64| f64::from(gather.at(DVec3::new(x, 0.0, 0.0), DVec3::Y, 7).g);
    // The way to the lamp at height 2 passes the plate's edge at height 1.99 and x = 0.
    let seen = |x: f64| {
        let end = x - x / 0.995;
        let part = crate::PatchPolygon::quad(quad([-0.5, 2.0, -0.5], [0.5 + end, 0.0, 0.0], [0.0, 0.0, 1.0]));
        10.0 * Facet::of_polygon(part).share_at(DVec3::new(x, 0.0, 0.0), DVec3::Y)
    };
    for x in [0.0, -1.0, -4.0] {
        assert!((light(x) / seen(x) - 1.0).abs() < 1e-5, "{} {}", light(x), seen(x));
    }
    assert_eq!(gather.at(DVec3::new(0.1, 3.0, 0.0), DVec3::Y, 7), LinearRgb::BLACK);
    // Below the plate nothing is seen of the lamp.
    assert!(gather.at(DVec3::new(0.4, 1.989, 0.0), DVec3::Y, 7).g < 1e-3);
}

/// A room of 2 x 2 x 2 with walls of different light.
fn lit_room() -> Solution {
    let walls = [
        quad([-1.0; 3], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]),
        quad([1.0, -1.0, -1.0], [0.0, 0.0, 2.0], [0.0, 2.0, 0.0]),
        quad([-1.0; 3], [0.0, 0.0, 2.0], [2.0, 0.0, 0.0]),
        quad([-1.0, 1.0, -1.0], [2.0, 0.0, 0.0], [0.0, 0.0, 2.0]),
        quad([-1.0; 3], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]),
        quad([-1.0, -1.0, 1.0], [0.0, 2.0, 0.0], [2.0, 0.0, 0.0]),
    ];
    let polygons: Vec<_> = walls.iter().map(|c| (&c[..], LinearRgb::WHITE, LinearRgb::BLACK)).collect();
    let mesh = ElementMesh::of_polygons(&polygons);
    let incident: Vec<LinearRgb> =
        [3.0, 0.5, 1.0, 0.2, 0.7, 0.1].map(|v| LinearRgb::new(v, 1.0, 0.5 * v)).to_vec();
    Solution { mesh, direct: vec![LinearRgb::BLACK; 6], incident, ..Solution::default() }
}

#[test]
fn reflected_light_is_carried_along_its_gradient() {
    let solution = lit_room();
    let occluders = Occluders::new(&solution.mesh).expect("few");
    let settings = GatherSettings { rings: 24, reach: 0.3, ..GatherSettings::default() };
    let mut gather = ReflectedGather::new(&solution, &occluders, &settings);
    let exact = |place: DVec3| {
        let share = |wall: u32| Facet::of(&solution.mesh, wall).share_at(place, DVec3::Y);
        (0..6).map(|wall| share(wall) * f64::from(solution.incident[wall as usize].r)).sum::<f64>()
    };
    let blockers = visible::Blockers::new(&solution.mesh, 1e-7);
    let start = DVec3::new(0.2, -1.0, -0.1);
    gather.prepare(&[(start, DVec3::Y)], &blockers, &Control::default()).expect("not cancelled");
    assert_eq!(gather.len(), 1);
    for way in [DVec3::ZERO, 0.1 * DVec3::X, -0.1 * DVec3::X, 0.1 * DVec3::Z, -0.1 * DVec3::Z] {
        let [carried, exact] = [f64::from(gather.at(start + way, DVec3::Y).r), exact(start + way)];
        assert!((carried / exact - 1.0).abs() < 0.015, "{way}: {carried} {exact}");
    }
    // All walls are equally bright in the second channel.
    assert!((gather.at(start, DVec3::Y).g - 1.0).abs() < 1e-6);
    // A normal that turns towards the bright wall sees more of it.
    let turned = DVec3::new(-0.05, 1.0, 0.0).normalize();
    assert!(gather.at(start, turned).r > gather.at(start, DVec3::Y).r);
}

#[test]
fn found_light_does_not_depend_on_threads() {
    let solution = lit_room();
    let occluders = Occluders::new(&solution.mesh).expect("few");
    let places: Vec<(DVec3, DVec3)> = (0..900)
        .map(|i| {
            (DVec3::new(f64::from(i % 30) / 15.0 - 0.97, -1.0, f64::from(i / 30) / 15.0 - 0.97), DVec3::Y)
        })
        .collect();
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| {
            let blockers = visible::Blockers::new(&solution.mesh, 1e-7);
            let settings = GatherSettings { rings: 4, ..GatherSettings::default() };
            let mut gather = ReflectedGather::new(&solution, &occluders, &settings);
            gather.prepare(&places, &blockers, &Control::default()).expect("not cancelled");
            assert!(gather.len() < places.len());
            places.iter().map(|&(place, normal)| gather.at(place, normal)).collect::<Vec<_>>()
        })
    };
    assert_eq!(with(1), with(3));
}

#[test]
fn places_find_their_leaves() {
    let mut mesh = scene();
    mesh.divide_to_size(0.7, 1 << 16).expect("few");
    for (x, z) in [(-4.9, 3.3), (0.1, 0.2), (4.99, -4.99)] {
        let place = DVec3::new(x, 0.0, z);
        let leaf = leaf_at(&mesh, 0, place);
        assert!(mesh.elements()[leaf as usize].is_leaf());
        assert!(inside_by(mesh.shape(leaf).corners(), DVec3::Y, place) >= 0.0);
    }
}

/// A dark floor of 2 x 2 and a wall of 2 x 2 on its left edge that shows 1.
fn floor_and_wall() -> Solution {
    let floor = quad([-1.0, 0.0, 1.0], [2.0, 0.0, 0.0], [0.0, 0.0, -2.0]);
    let wall = quad([-1.0, 0.0, 1.0], [0.0, 0.0, -2.0], [0.0, 2.0, 0.0]);
    let polygons =
        [(&floor[..], LinearRgb::BLACK, LinearRgb::BLACK), (&wall[..], LinearRgb::WHITE, LinearRgb::BLACK)];
    let mesh = ElementMesh::of_polygons(&polygons);
    let incident = vec![LinearRgb::BLACK, LinearRgb::WHITE];
    Solution { mesh, direct: vec![LinearRgb::BLACK; 2], incident, ..Solution::default() }
}

/// Places on the edge itself, and beyond it by rounding, see the wall as those beside it do.
#[test]
fn at_a_common_edge_light_tends_to_half_of_the_walls() {
    let solution = floor_and_wall();
    let occluders = Occluders::new(&solution.mesh).expect("few");
    let wall = Facet::of(&solution.mesh, 1);
    let settings = GatherSettings { rings: 20, ..GatherSettings::default() };
    let mut gather =
        Gather::new(&solution, &DirectLight::default(), &occluders, &settings).expect("in range");
    let offs = [-1e-9, 0.0, 1e-8, 1e-7, 1e-6, 1e-4, 1e-3, 3e-3, 0.01, 0.02, 0.03, 0.05, 0.1, 0.2];
    let place = |off: f64, z: f64| DVec3::new(off - 1.0, 0.0, z);
    let places: Vec<(DVec3, DVec3)> = (0..60)
        .map(|i| f64::from(i) / 60.0 - 0.5)
        .flat_map(|z| offs.map(|off| (place(off, z), DVec3::Y)))
        .collect();
    gather.prepare(&places, &Control::default()).expect("not cancelled");
    for off in offs {
        let exact = wall.share_at(place(off.max(1e-9), 0.0), DVec3::Y);
        let n = 41;
        let light = |i: i32| f64::from(gather.at(place(off, f64::from(i - n / 2) / 100.0), DVec3::Y, 0).g);
        let mean = (0..n).map(light).sum::<f64>() / f64::from(n);
        assert!((mean / exact - 1.0).abs() < 0.02, "{off}: {mean} {exact}");
        let worst = (0..n).map(|i| (light(i) / exact - 1.0).abs()).fold(0.0, f64::max);
        assert!(worst < 0.08, "{off}: {worst}");
    }
    assert!((wall.share_at(place(1e-9, 0.0), DVec3::Y) - 0.5).abs() < 1e-6);
    let afresh = gather.afresh(place(0.0, 0.1), DVec3::Y, 4096, 3).g;
    assert!((afresh - 0.5).abs() < 5e-3, "{afresh}");
}

/// Light at the middle of a closed cube whose walls show 1 is 1, whatever part of it is their own.
#[test]
fn in_a_room_of_even_light_the_light_is_even() {
    let mut room = lit_room();
    let (grey, glow) = (LinearRgb::splat(0.75), LinearRgb::splat(0.25));
    let shapes: Vec<_> = (0..6).map(|wall| room.mesh.shape(wall)).collect();
    let polygons: Vec<_> = shapes.iter().map(|shape| (shape.corners(), grey, glow)).collect();
    room.mesh = ElementMesh::of_polygons(&polygons);
    room.incident = vec![LinearRgb::WHITE; 6];
    let occluders = Occluders::new(&room.mesh).expect("few");
    let gather = Gather::new(&room, &DirectLight::default(), &occluders, &GatherSettings::default());
    let gather = gather.expect("in range");
    for place in [DVec3::ZERO, DVec3::new(-0.6, 0.8, -0.2)] {
        let light = gather.afresh(place, DVec3::new(0.6, 0.0, 0.8), 512, 0);
        assert!((light.g - 1.0).abs() < 1e-4, "{light:?}");
    }
}

#[test]
fn panes_tint_what_is_seen_through_them() {
    let mut solution = floor_and_wall();
    let shapes: Vec<_> = (0..2).map(|p| solution.mesh.shape(p)).collect();
    let pane = crate::PatchPolygon::quad(quad([-0.9, -1.0, 3.0], [0.0, 0.0, -6.0], [0.0, 9.0, 0.0]));
    let white = (LinearRgb::WHITE, LinearRgb::BLACK);
    let polygons: Vec<_> = shapes.iter().chain([&pane]).map(|s| (s.corners(), white.0, white.1)).collect();
    solution.mesh = ElementMesh::of_polygons(&polygons);
    solution.mesh.set_transmittance(2, LinearRgb::new(1.0, 0.5, 0.25));
    solution.incident.push(LinearRgb::BLACK);
    let occluders = Occluders::new(&solution.mesh).expect("few");
    let along = |place| reflected_along(&solution, &occluders, place, DVec3::NEG_X).expect("a wall");
    let met = along(DVec3::new(0.0, 0.5, 0.0));
    assert_eq!(met.light, LinearRgb::new(1.0, 0.5, 0.25));
    assert!((met.distance - 1.0).abs() < 1e-6);
    assert_eq!(along(DVec3::new(-0.95, 0.5, 0.0)).light, LinearRgb::WHITE);
}

#[test]
fn settings_out_of_range_are_refused() {
    let all = GatherSettings::default();
    for wrong in [
        GatherSettings { cells: 0, ..all },
        GatherSettings { rings: 1, ..all },
        GatherSettings { reach: f64::NAN, ..all },
        GatherSettings { least: Some(0.0), ..all },
    ] {
        assert!(matches!(wrong.check(), Err(RadiosityError::Setting { .. })), "{wrong:?}");
    }
    assert_eq!(all.check(), Ok(()));
}

/// A plate of 1 x 1 hangs a hundredth below a ceiling. Few rays from beside it see it, but what they
/// find is not carried to the dark above it.
#[test]
fn light_is_not_carried_into_a_gap() {
    let ceiling = quad([-2.0, 1.0, -2.0], [4.0, 0.0, 0.0], [0.0, 0.0, 4.0]);
    let floor = quad([-2.0, -1.0, 2.0], [4.0, 0.0, 0.0], [0.0, 0.0, -4.0]);
    let plate = quad([-0.5, 0.99, -0.5], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
    let polygons: Vec<_> =
        [&ceiling, &floor, &plate].map(|c| (&c[..], LinearRgb::WHITE, LinearRgb::BLACK)).to_vec();
    let mesh = ElementMesh::of_polygons(&polygons);
    let (direct, incident) = (vec![LinearRgb::BLACK; 3], vec![LinearRgb::WHITE; 3]);
    let solution = Solution { mesh, direct, incident, ..Solution::default() };
    let occluders = Occluders::new(&solution.mesh).expect("few");
    let settings = GatherSettings::default();
    let mut gather =
        Gather::new(&solution, &DirectLight::default(), &occluders, &settings).expect("in range");
    let place =
        |i: usize| (DVec3::new(0.4 + 0.006 * (i % 100) as f64, 1.0, 0.01 * (i / 100) as f64), DVec3::NEG_Y);
    let places: Vec<_> = (0..3000).map(place).collect();
    gather.prepare(&places, &Control::default()).expect("not cancelled");
    for (at, normal) in places {
        let light = gather.at(at, normal, 0).g;
        assert!(at.x > 0.485 || light < 0.02, "{at}: {light}");
        assert!(at.x < 0.515 || light > 0.2, "{at}: {light}");
    }
}
