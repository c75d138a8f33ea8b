use super::*;
use crate::game::exact_frame::draw_frame_exactly;
use crate::game::street::street;
use proptest::prelude::*;

const SIZE: [usize; 2] = [320, 200];

fn start() -> Viewer {
    Viewer { eye: [20, 40, -60], heading: Angle(3), ..Viewer::default() }
}

fn picture(world: &World, viewer: &Viewer, stages: &Stages) -> (ColorMap, Counters) {
    let mut map = ColorMap::new(SIZE[0], SIZE[1]);
    let counters = draw_frame(world, viewer, stages, &mut map);
    (map, counters)
}

/// Share of the pixels whose shades differ by more than one.
fn share_that_differs(a: &ColorMap, b: &ColorMap) -> f64 {
    let differ = a.pixels().iter().zip(b.pixels()).filter(|(a, b)| a.abs_diff(**b) > 1).count();
    differ as f64 / a.pixels().len() as f64
}

#[test]
fn the_integers_draw_what_the_reference_draws() {
    let world = street();
    let still = Viewer { heading: Angle(0), ..start() };
    for surface in [Surface::Flat, Surface::Shaded, Surface::Wire, Surface::Textured, Surface::Lit] {
        let stages = Stages {
            surface,
            arithmetic: Arithmetic::Float,
            mapping: Mapping::Subdivided(1),
            ..Stages::default()
        };
        let (map, counters) = picture(&world, &still, &stages);
        let mut exact = ColorMap::new(SIZE[0], SIZE[1]);
        draw_frame_exactly(&world, &still, &stages, &mut exact);
        let differs = share_that_differs(&map, &exact);
        // Borders are a pixel wider, and textures as fine as pixels come out otherwise.
        let limit = if surface.has_textures() { 0.4 } else { 0.12 };
        assert!(differs < limit, "{surface:?}: {differs}");
        assert_eq!(counters.faces, counters.turned_away + counters.outside + counters.drawn);
    }
}

#[test]
fn throwing_away_changes_nothing_that_is_seen() {
    let world = street();
    let viewer = Viewer { eye: [20, 40, 1200], heading: Angle(40), ..start() };
    let (with, counters) = picture(&world, &viewer, &Stages::default());
    let (without, all) = picture(&world, &viewer, &Stages { rejects_volume: false, ..Stages::default() });
    assert_eq!(with, without);
    assert!(counters.outside > 300 && all.outside == 0, "{counters:?}");
}

#[test]
fn the_cut_at_the_plane_closes_the_ground() {
    let world = street();
    let viewer = Viewer { eye: [20, 8, 500], ..start() };
    let holes = |stages: Stages| {
        let (map, counters) = picture(&world, &viewer, &stages);
        assert!(counters.crossing > 0);
        map.pixels()[SIZE[0] * (SIZE[1] - 1)..].iter().filter(|&&p| p == world.sky).count()
    };
    assert_eq!(holes(Stages::default()), 0);
    assert!(holes(Stages { cuts_at_plane: false, ..Stages::default() }) > 20);
}

#[test]
fn stages_are_seen() {
    let world = street();
    let (picture_of, base) = (|stages| picture(&world, &start(), &stages).0, Stages::default());
    let reference = picture_of(base);
    let changed = [
        Stages { arithmetic: Arithmetic::Fixed8, ..base },
        Stages { mapping: Mapping::Affine, ..base },
        Stages { texture_arithmetic: TextureArithmetic { fraction_bits: 16, is_32_bit: true }, ..base },
        Stages { surface: Surface::Flat, ..base },
        Stages { projection: Projection::Parallel { log_depth: 8 }, ..base },
        Stages { log_focus: 7, ..base },
        Stages { search: Search::AsPrinted, ..base },
    ];
    for stages in changed {
        assert_ne!(picture_of(stages), reference, "{stages:?}");
    }
}

#[test]
fn the_viewer_turns_and_goes_ahead() {
    assert_eq!(Viewer::default().ahead(100), [0, 100]);
    assert_eq!(Viewer { heading: Angle(64), ..Viewer::default() }.ahead(100), [100, 0]);
    // What is ahead is seen in the middle, for any heading.
    for heading in 0..=255 {
        let viewer = Viewer { heading: Angle(heading), ..Viewer::default() };
        let [x, z] = viewer.ahead(1000);
        let [seen] = Arithmetic::Float.view(&[[x, 0, z]], &viewer)[..] else { panic!("one point") };
        assert!(seen[0].abs() <= 2 && (seen[2] - 1000).abs() <= 3, "{heading}: {seen:?}");
    }
    // Looking up lowers what is ahead, and tilting the head to the right turns the world to the left.
    let up = Viewer { pitch: Angle(10), ..Viewer::default() };
    assert!(Arithmetic::Float.view(&[[0, 0, 100]], &up)[0][1] < 0);
    let tilted = Viewer { roll: Angle(10), ..Viewer::default() };
    assert!(Arithmetic::Float.view(&[[0, 100, 100]], &tilted)[0][0] < 0);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn any_viewer_gets_a_picture(eye: [i32; 3], heading: u8, pitch: u8, roll: u8, near: bool, log_focus: u32) {
        let world = street();
        let eye = if near { eye.map(|c| c % 700) } else { eye };
        let viewer = Viewer { eye, heading: Angle(heading), pitch: Angle(pitch), roll: Angle(roll) };
        let stages = Stages { log_focus, search: Search::AsPrinted, ..Stages::default() };
        picture(&world, &viewer, &stages);
        let mut map = ColorMap::new(SIZE[0], SIZE[1]);
        draw_frame_exactly(&world, &viewer, &stages, &mut map);
    }
}
