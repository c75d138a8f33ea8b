use super::*;
use proptest::prelude::*;

const SIZE: [usize; 2] = [320, 200];

fn texels(place: i64) -> f64 {
    place as f64 / f64::from(1 << TEXEL_BITS)
}

fn arithmetic(fraction_bits: u32, is_32_bit: bool) -> TextureArithmetic {
    TextureArithmetic { fraction_bits, is_32_bit }
}

/// The plane that the numbers of overflow are known for.
fn known_plane() -> TexturePlane {
    TexturePlane { origin: [-50, -50, 200], anchor: [0; 2], u: [100, 0, 60], v: [0, 100, 0], log_scale: 6 }
}

/// A wall on 160 pixels whose depth goes from 100 to 400 times `scale`, and 64 texels from its left to its right.
fn deep_wall() -> TexturePlane {
    TexturePlane {
        origin: [-8000, -3000, 25_600],
        anchor: [0; 2],
        u: [40_000, 0, 76_800],
        v: [0, 6000, 0],
        log_scale: 6,
    }
}

const DEEP_CORNERS: [[i32; 4]; 4] =
    [[80, 80, 0, 0], [240, 80, 64 << 8, 0], [240, 120, 64 << 8, 0], [80, 120, 0, 0]];

fn largest_error(mapping: Mapping) -> f64 {
    let plane = TextureMapping::new(&deep_wall(), Lens::new(320, 200), TextureArithmetic::default());
    let polygon = TexturedPolygon { corners: &DEEP_CORNERS, plane };
    let mut largest = 0f64;
    for_each_textured_pixel(&polygon, SIZE, mapping, Search::Precise, |x, y, [u, _]| {
        let exact = plane.at(x, y).expect("not edge on")[0];
        largest = largest.max((texels(u) - texels(exact)).abs());
    });
    largest
}

#[test]
fn places_known_from_the_text_and_overflow() {
    let lens = Lens::new(320, 200);
    let u = |arithmetic, x| {
        let at = TextureMapping::new(&known_plane(), lens, arithmetic).at(160 + x, 100);
        texels(at.expect("not edge on")[0])
    };
    let cases = [
        (-60, 1.753, 1.756),
        (-45, 8.594, 8.597),
        (-30, 15.883, 15.886),
        (-15, 23.668, 23.672),
        (0, 32.0, 32.0),
        (15, 40.939, 40.938),
        (30, 50.555, 50.556),
    ];
    for (x, exact, in_32_bits) in cases {
        assert!((u(arithmetic(16, false), x) - exact).abs() < 6e-4, "{x}");
        assert!((u(arithmetic(12, true), x) - in_32_bits).abs() < 8e-4, "{x}");
    }
    let mut largest = 0f64;
    let mut wrong = [0; 3];
    for x in -60..=30 {
        let exact = u(arithmetic(16, false), x);
        largest = largest.max((u(arithmetic(12, true), x) - exact).abs());
        for (count, bits) in wrong.iter_mut().zip([8, 12, 16]) {
            *count += i32::from((u(arithmetic(bits, true), x) - exact).abs() > 0.01);
        }
    }
    assert!(largest < 0.00475, "{largest}");
    assert_eq!(wrong, [0, 0, 88], "with 16 fraction bits 32 are too few");
}

#[test]
fn the_middle_of_an_edge_is_not_the_middle_of_its_texture() {
    for (z0, z1, share) in [(100, 100, 0.5), (100, 200, 1.0 / 3.0), (100, 400, 0.2), (100, 1000, 1.0 / 11.0)]
    {
        let at = |pixel: i32, z: i32| [pixel * z, 0, 256 * z];
        let (a, b) = (at(-80, z0), at(80, z1));
        let u = [b[0] - a[0], 0, b[2] - a[2]];
        let plane = TexturePlane { origin: a, anchor: [0; 2], u, v: [0, 100, 0], log_scale: 6 };
        let mapping = TextureMapping::new(&plane, Lens::new(320, 200), TextureArithmetic::default());
        let middle = texels(mapping.at(160, 100).expect("not edge on")[0]) / 64.0;
        assert!((middle - share).abs() < 1e-4, "{middle} {share}");
    }
}

#[test]
fn subdivision_bounds_the_error() {
    let cases = [(160, 21.3), (32, 3.74), (16, 1.29), (8, 0.39), (4, 0.11), (1, 0.0)];
    for (n, expected) in cases {
        let error = largest_error(Mapping::Subdivided(n));
        assert!((error - expected).abs() < 0.06, "N = {n}: {error}");
    }
    let affine = largest_error(Mapping::Affine);
    assert!((affine - 64.0 / 3.0).abs() < 0.01, "{affine}");
}

#[test]
fn the_scale_repeats_and_the_anchor_moves() {
    let lens = Lens::new(320, 200);
    let at =
        |plane: TexturePlane| TextureMapping::new(&plane, lens, TextureArithmetic::default()).at(160, 100);
    let [u, v] = at(known_plane()).expect("not edge on").map(texels);
    let twice = TexturePlane { log_scale: 7, ..known_plane() };
    assert_eq!(at(twice).expect("not edge on").map(texels), [2.0 * u, 2.0 * v]);
    let moved = TexturePlane { anchor: [3 << CORNER_BITS, -128], ..known_plane() };
    assert_eq!(at(moved).expect("not edge on").map(texels), [u + 3.0, v - 0.5]);
    // Another point of the plane as the origin, with its own place: the same texture.
    let other = TexturePlane { origin: [50, 50, 260], anchor: [64 << 8, 64 << 8], ..known_plane() };
    let [u2, v2] = at(other).expect("not edge on").map(texels);
    assert!((u2 - u).abs() < 1e-4 && (v2 - v).abs() < 1e-4);
    let texture = Texture::from_fn(2, |x, y| (10 * x + y) as u8);
    let color = |u: i64, v: i64| texture.color([u << TEXEL_BITS, v << TEXEL_BITS]);
    assert_eq!([color(1, 2), color(5, 6), color(-3, -2), color(-1, 0)], [12, 12, 12, 30]);
}

#[test]
fn spans_are_whole_and_one_pixel_wide_ones_stay() {
    let plane = TextureMapping::new(&known_plane(), Lens::new(320, 200), TextureArithmetic::default());
    let count = |corners: &[[i32; 4]], mapping| {
        let mut pixels = 0;
        let polygon = TexturedPolygon { corners, plane };
        for_each_textured_pixel(&polygon, SIZE, mapping, Search::Precise, |_, _, _| pixels += 1);
        pixels
    };
    let square = [[10, 10, 0, 0], [19, 10, 0, 0], [19, 19, 0, 0], [10, 19, 0, 0]];
    let thin = [[10, 10, 0, 0], [10, 19, 0, 0]];
    for mapping in
        [Mapping::Affine, Mapping::Subdivided(4), Mapping::Subdivided(0), Mapping::Subdivided(u32::MAX)]
    {
        assert_eq!([count(&square, mapping), count(&thin, mapping)], [100, 10]);
    }
    let printed = Mapping::SubdividedAsPrinted(4);
    assert_eq!([count(&square, printed), count(&thin, printed)], [90, 0]);
}

#[test]
fn a_plane_through_the_eye_has_no_place() {
    let edge_on = TexturePlane { origin: [0, 0, 100], anchor: [5; 2], u: [0; 3], v: [0, 1, 0], log_scale: 6 };
    for is_32_bit in [false, true] {
        let plane = TextureMapping::new(&edge_on, Lens::new(320, 200), arithmetic(8, is_32_bit));
        assert_eq!(plane.at(3, 4), None);
        let texture = Texture::from_fn(0, |_, _| 9);
        let mut map = ColorMap::new(320, 200);
        let polygon = TexturedPolygon { corners: &DEEP_CORNERS, plane };
        fill_textured(&mut map, &polygon, &texture, Mapping::Subdivided(16), Search::Precise);
        assert_eq!(map.get(80, 80), Some(9));
    }
}

#[test]
fn affine_glues_corners_together() {
    // A floor that vanishes in the distance is a triangle on the screen: two corners become one.
    let corners = [[10, 100, 0, 0], [110, 100, 64 << 8, 0], [60, 50, 64 << 8, 64 << 8], [60, 50, 0, 64 << 8]];
    let plane = TextureMapping::new(&known_plane(), Lens::new(320, 200), TextureArithmetic::default());
    let mut tip = Vec::new();
    let polygon = TexturedPolygon { corners: &corners, plane };
    for_each_textured_pixel(&polygon, SIZE, Mapping::Affine, Search::Precise, |_, y, [u, _]| {
        if y == 51 {
            tip.push(texels(u));
        }
    });
    assert!(tip.len() <= 3, "next to the tip there is room for few texels: {tip:?}");
}

proptest! {
    #[test]
    fn any_plane_and_polygon_can_be_drawn(
        o: [i32; 3], u: [i32; 3], v: [i32; 3], anchor: [i32; 2], log_scale: u32, n: u32, bits: u32, is_32_bit: bool,
        corners in prop::collection::vec(any::<[i32; 4]>(), 0..5), log_focus: u32,
    ) {
        let plane = TexturePlane { origin: o, anchor, u, v, log_scale };
        let lens = Lens { log_focus, ..Lens::new(32, 20) };
        let plane = TextureMapping::new(&plane, lens, arithmetic(bits, is_32_bit));
        let polygon = TexturedPolygon { corners: &corners, plane };
        let texture = Texture::from_fn(3, |x, _| x as u8);
        for mapping in [Mapping::Affine, Mapping::Subdivided(n), Mapping::SubdividedAsPrinted(n % 9)] {
            fill_textured(&mut ColorMap::new(32, 20), &polygon, &texture, mapping, Search::Precise);
        }
    }

    #[test]
    fn the_mapping_finds_the_place_again(
        o in prop::array::uniform3(-200i32..200), u in prop::array::uniform3(-200i32..200),
        v in prop::array::uniform3(-200i32..200), x in -150i32..150, y in -90i32..90,
    ) {
        let plane = TexturePlane { origin: o, anchor: [0; 2], u, v, log_scale: 0 };
        let lens = Lens::new(320, 200);
        let mapping = TextureMapping::new(&plane, lens, TextureArithmetic::default());
        let Some([a, b]) = mapping.at(160 + x, 100 - y) else { return Ok(()) };
        let [a, b] = [a, b].map(texels);
        prop_assume!(a.abs() < 1e3 && b.abs() < 1e3);
        let point: [f64; 3] =
            std::array::from_fn(|k| f64::from(o[k]) + a * f64::from(u[k]) + b * f64::from(v[k]));
        // The point lies on the ray of the pixel, up to the last fraction bit.
        let step = 800.0 / 65536.0;
        prop_assert!((point[0] - f64::from(x) / 256.0 * point[2]).abs() < step);
        prop_assert!((point[1] - f64::from(y) / 256.0 * point[2]).abs() < step);
    }
}

#[test]
fn light_is_interpolated_as_intensities_are() {
    // One colour all over: what is left is the light.
    let texture = Texture::from_fn(2, |_, _| 200);
    let table = LightTable::from_fn(|color, light| color.saturating_sub(31 - light));
    let plane = TextureMapping::new(&deep_wall(), Lens::new(320, 200), TextureArithmetic::default());
    let polygon = TexturedPolygon { corners: &DEEP_CORNERS, plane };
    let lights = [31, 4, 0, 17];
    let shaded: Vec<_> = DEEP_CORNERS.iter().zip(lights).map(|(c, light)| [c[0], c[1], light]).collect();
    for mapping in [Mapping::Affine, Mapping::Subdivided(16), Mapping::Subdivided(1)] {
        let (mut lit, mut plain) = (ColorMap::new(320, 200), ColorMap::new(320, 200));
        fill_lit(&mut lit, &polygon, &lights, (&texture, &table), mapping, Search::Precise);
        crate::game::fill_shaded(&mut plain, &shaded, Search::Precise);
        for (i, (&lit, &light)) in lit.pixels().iter().zip(plain.pixels()).enumerate() {
            let is_inside = (80..=240).contains(&(i % 320)) && (80..=120).contains(&(i / 320));
            assert_eq!(lit, if is_inside { 169 + light } else { 0 }, "{i}");
        }
    }
}

#[test]
fn in_full_light_textures_are_as_they_are() {
    let texture = Texture::from_fn(6, |x, y| (x * 4 + y) as u8);
    let table = LightTable::from_fn(|color, light| if light == LightTable::FULL { color } else { 0 });
    let plane = TextureMapping::new(&deep_wall(), Lens::new(320, 200), TextureArithmetic::default());
    let polygon = TexturedPolygon { corners: &DEEP_CORNERS, plane };
    let (mut lit, mut plain) = (ColorMap::new(320, 200), ColorMap::new(320, 200));
    let mapping = Mapping::Subdivided(16);
    fill_lit(&mut lit, &polygon, &[31; 4], (&texture, &table), mapping, Search::Precise);
    fill_textured(&mut plain, &polygon, &texture, mapping, Search::Precise);
    assert_eq!(lit, plain);
    let mut dark = ColorMap::new(320, 200);
    fill_lit(&mut dark, &polygon, &[], (&texture, &table), mapping, Search::Precise);
    assert!(dark.pixels().iter().all(|&p| p == 0), "no light is darkness");
    assert_eq!((table.color(9, -5), table.color(9, 1 << 40)), (0, 9));
}
