//! The street: houses along a road, trees, lamps and a wire, and all textures, made by rules.
//!
//! A unit is some ten centimetres. The road runs along Z from 0 to 2560; the houses stand at its sides.

use super::scene::{Body, Face, FaceTexture, LightTable, World};
use super::texture::Texture;

/// Shades of each colour in the palette.
const SHADES: u8 = 32;

/// Side of a panel of a wall and of a tile of the ground.
const PANEL: i32 = 80;

/// Tiles along the street.
const TILES_AHEAD: i32 = 32;

/// The colours that come in shades; each takes a row of the palette.
#[derive(Clone, Copy)]
enum Hue {
    Grey,
    Brick,
    Sand,
    Leaf,
    Sky,
    Glass,
    Wood,
    Lamp,
}

/// Red, green and blue of the brightest shade, by [`Hue`].
const HUES: [[u32; 3]; 8] = [
    [235, 235, 240],
    [226, 110, 82],
    [240, 214, 158],
    [112, 206, 88],
    [150, 200, 255],
    [90, 140, 200],
    [176, 124, 74],
    [255, 244, 170],
];

impl Hue {
    /// The colour of a shade, 0 to 31.
    fn shade(self, level: i32) -> u8 {
        self as u8 * SHADES + level.clamp(0, i32::from(SHADES) - 1) as u8
    }
}

/// Colour `c` with its shade reduced to `per_mille`.
fn darker(c: u8, per_mille: i32) -> u8 {
    c / SHADES * SHADES + (i32::from(c % SHADES) * per_mille / 1000) as u8
}

fn palette() -> [u32; 256] {
    std::array::from_fn(|i| {
        let level = i as u32 % u32::from(SHADES);
        let [r, g, b] = HUES[i / usize::from(SHADES)].map(|c| c * level / u32::from(SHADES - 1));
        r << 16 | g << 8 | b
    })
}

/// Four bits of chance that hang on two numbers.
fn noise(x: usize, y: usize) -> i32 {
    let mut h = (x as u32).wrapping_mul(0x9e37_79b1) ^ (y as u32).wrapping_mul(0x85eb_ca77);
    h = (h ^ (h >> 15)).wrapping_mul(0x2c1b_3c6d);
    ((h ^ (h >> 12)) & 15) as i32
}

/// Logarithm of the side of all textures here.
const LOG_SIDE: u32 = 6;

/// Textures before light: each is followed by its copy in the shade.
const TEXTURES: [fn(usize, usize) -> u8; 8] = [brick, window, door, storeys, road, paving, grass, roof];
const BRICK: usize = 0;
const WINDOW: usize = 2;
const DOOR: usize = 4;
const OFFICE: usize = 6;
const ROAD: usize = 8;
const PAVING: usize = 10;
const GRASS: usize = 12;
const ROOF: usize = 14;

/// How bright walls along the street are.
const SIDE_LIGHT: i32 = 720;

fn textures() -> Vec<Texture> {
    let lit = TEXTURES.iter().map(|color| Texture::from_fn(LOG_SIDE, color));
    lit.flat_map(|t| [t.clone(), t.map(|c| darker(c, SIDE_LIGHT))]).collect()
}

/// Rows of bricks, eight texels high, each shifted by half a brick.
fn brick(x: usize, y: usize) -> u8 {
    let row = y / 8;
    let x = x + 8 * (row % 2);
    if y % 8 == 7 || x % 16 == 15 {
        return Hue::Grey.shade(20);
    }
    Hue::Brick.shade(19 + noise(x % 64 / 16, row) / 2 + noise(x, y) / 6)
}

/// A cross of wood over glass, in bricks.
fn window(x: usize, y: usize) -> u8 {
    let [dx, dy] = [x.abs_diff(32), y.abs_diff(30)];
    match (dx.max(dy * 15 / 18), dx.min(dy)) {
        (0..15, 0..2) | (15..18, _) => Hue::Sand.shade(28),
        (0..15, _) => Hue::Glass.shade(14 + (63 - y as i32) / 4 + noise(x / 12, y / 9) / 5),
        _ => brick(x, y),
    }
}

fn door(x: usize, y: usize) -> u8 {
    match (x, y) {
        (18..=45, 10..=63) if x.abs_diff(32) > 11 || y < 13 => Hue::Sand.shade(26),
        (40..=42, 38..=40) => Hue::Lamp.shade(30),
        (18..=45, 10..=63) => Hue::Wood.shade(17 + i32::from(x % 8 > 1) * 4 + noise(x, y / 16) / 5),
        _ => brick(x, y),
    }
}

/// Bands of glass between storeys of concrete.
fn storeys(x: usize, y: usize) -> u8 {
    if y % 32 < 12 || x % 16 < 2 {
        return Hue::Sand.shade(21 + noise(x, y) / 5 - i32::from(y % 32 == 11) * 8);
    }
    Hue::Glass.shade(12 + (y % 32) as i32 / 3 + noise(x / 16, y / 32))
}

/// The whole road across: asphalt between kerbs, with dashes in the middle.
fn road(x: usize, y: usize) -> u8 {
    match x {
        0..=1 | 62..=63 => Hue::Grey.shade(22 + noise(x, y / 8) / 5),
        31..=32 if y < 40 => Hue::Grey.shade(29),
        _ => Hue::Grey.shade(10 + noise(x, y) / 4),
    }
}

fn paving(x: usize, y: usize) -> u8 {
    if x.is_multiple_of(16) || y.is_multiple_of(16) {
        return Hue::Grey.shade(12);
    }
    Hue::Sand.shade(19 + noise(x / 16 + 7, y / 16) / 4 + noise(x, y) / 7)
}

fn grass(x: usize, y: usize) -> u8 {
    Hue::Leaf.shade(11 + noise(x, y) / 3 + noise(x / 4, y / 4) / 5)
}

fn roof(x: usize, y: usize) -> u8 {
    Hue::Grey.shade(if x.is_multiple_of(32) || y.is_multiple_of(32) { 9 } else { 15 + noise(x, y) / 6 })
}

/// The whole world.
#[must_use]
pub fn street() -> World {
    let mut bodies = ground();
    for block in 0..10 {
        let z = 2 * PANEL + block * 3 * PANEL;
        for side in [-1, 1] {
            let storeys = 2 + noise(block as usize, (side + 1) as usize) % 4;
            let is_office = (block + side) % 3 == 0;
            bodies.push(if is_office { office(side, z, storeys / 2 + 1) } else { house(side, z, storeys) });
            bodies.extend(tree([side * 140, z + 5 * PANEL / 2]));
            bodies.push(lamp_post([side * LAMP[1], z - PANEL / 2]));
        }
        bodies.push(wire(z - PANEL / 2, z + 5 * PANEL / 2));
    }
    World {
        bodies,
        textures: textures(),
        palette: palette(),
        sky: Hue::Sky.shade(29),
        lights: LightTable::from_fn(|color, light| darker(color, i32::from(light) * 1000 / 31)),
    }
}

/// Height of the lamps, and their distance from the middle of the road.
const LAMP: [i32; 2] = [110, 100];

/// Depth of the first lamps, and from one to the next.
const LAMPS: [i32; 2] = [2 * PANEL - PANEL / 2, 3 * PANEL];

/// The light of a dusk with lamps at a place, 0 to [`LightTable::FULL`]: that of the sky, and the nearest lamp's, which
/// is half as much 100 units from it as beside it.
fn light_at([x, y, z]: [i32; 3]) -> u8 {
    let block = ((z - LAMPS[0] + LAMPS[1] / 2).div_euclid(LAMPS[1])).clamp(0, 9);
    let way = [x.abs() - LAMP[1], y - LAMP[0], z - LAMPS[0] - block * LAMPS[1]];
    let square: i32 = way.iter().map(|d| d * d).sum();
    (8 + 30 * 10_000 / (10_000 + square)).clamp(0, i32::from(LightTable::FULL)) as u8
}

/// A flat face with a texture over it, so many times along each edge as the logarithm says.
fn panel(
    points: &mut Vec<[i32; 3]>,
    corners: [[i32; 3]; 4],
    normal: [i32; 3],
    index: usize,
    log_repeats: u32,
) -> Face {
    let first = points.len();
    points.extend(corners);
    let light = corners.map(light_at);
    // Walls along the street stand in the shade.
    let index = index + usize::from(normal[0] != 0);
    let color = textured_color(index);
    Face {
        corners: (first..first + 4).collect(),
        normal,
        color,
        intensities: (0..4).map(|k| if k < 2 { color } else { darker(color, 700) }).collect(),
        texture: Some(FaceTexture { index, log_scale: LOG_SIDE + log_repeats, light }),
    }
}

/// The colour that stands for a texture where there is none.
fn textured_color(index: usize) -> u8 {
    let lit = [
        Hue::Brick.shade(22),
        Hue::Brick.shade(26),
        Hue::Wood.shade(22),
        Hue::Sand.shade(23),
        Hue::Grey.shade(12),
        Hue::Sand.shade(21),
        Hue::Leaf.shade(15),
        Hue::Grey.shade(16),
    ][index / 2];
    if index.is_multiple_of(2) { lit } else { darker(lit, SIDE_LIGHT) }
}

/// A rectangle of ground between two places.
fn tile([left, near]: [i32; 2], [right, far]: [i32; 2], index: usize) -> Body {
    let mut points = Vec::new();
    let corners = [[left, 0, far], [right, 0, far], [right, 0, near], [left, 0, near]];
    let faces = vec![panel(&mut points, corners, [0, 1, 0], index, 0)];
    let center = [(left + right) / 2, 0, (near + far) / 2];
    Body { points, faces, lines: vec![], center, is_ground: true }
}

/// The road, a pavement at each side, and grass.
fn ground() -> Vec<Body> {
    let mut tiles = Vec::new();
    for row in -4..TILES_AHEAD + 4 {
        let [near, far] = [row * PANEL, (row + 1) * PANEL];
        if row % 2 == 0 {
            tiles.push(tile([-PANEL, near], [PANEL, far + PANEL], ROAD));
        }
        for column in 1..8 {
            let index = if column == 1 { PAVING } else { GRASS };
            let [inner, outer] = [column * PANEL, (column + 1) * PANEL];
            tiles.push(tile([inner, near], [outer, far], index));
            tiles.push(tile([-outer, near], [-inner, far], index));
        }
    }
    tiles
}

/// The four walls of a storey, or of several, of a house: each from `a` to `b` along it, seen from outside.
fn walls(street: i32, side: i32, z: i32, [a, b]: [i32; 2], [low, high]: [i32; 2]) -> [Wall; 4] {
    let back = street + side * 2 * PANEL;
    let along = |x: i32| [[x, high, z + a], [x, high, z + b], [x, low, z + b], [x, low, z + a]];
    let [left, right] = [street + side * a, street + side * b];
    let across = |z: i32| [[left, high, z], [right, high, z], [right, low, z], [left, low, z]];
    [
        (along(street), [-side, 0, 0]),
        (along(back), [side, 0, 0]),
        (across(z), [0, 0, -1]),
        (across(z + 2 * PANEL), [0, 0, 1]),
    ]
}

/// Corners and normal.
type Wall = ([[i32; 3]; 4], [i32; 3]);

/// A house of bricks, of two by two panels and some storeys, from depth `z` on, at the left (-1) or right (1) of the
/// street: a panel is a face.
fn house(side: i32, z: i32, storeys: i32) -> Body {
    let (mut points, mut faces) = (Vec::new(), Vec::new());
    for storey in 0..storeys {
        let heights = [storey * PANEL, (storey + 1) * PANEL];
        for k in 0..2 {
            let panels = walls(side * 2 * PANEL, side, z, [k * PANEL, (k + 1) * PANEL], heights);
            for (i, (corners, normal)) in panels.into_iter().enumerate() {
                let index = match (storey, k, i) {
                    (0, 0, 0) => DOOR,
                    (0, 1, 1..) => BRICK,
                    _ => WINDOW,
                };
                faces.push(panel(&mut points, corners, normal, index, 0));
            }
        }
    }
    covered(points, faces, side, z, storeys * PANEL)
}

/// A house of glass and concrete: a wall of two storeys is one face, over which the texture repeats.
fn office(side: i32, z: i32, blocks: i32) -> Body {
    let (mut points, mut faces) = (Vec::new(), Vec::new());
    for block in 0..blocks {
        let heights = [block * 2 * PANEL, (block + 1) * 2 * PANEL];
        for (corners, normal) in walls(side * 2 * PANEL, side, z, [0, 2 * PANEL], heights) {
            faces.push(panel(&mut points, corners, normal, OFFICE, 1));
        }
    }
    covered(points, faces, side, z, blocks * 2 * PANEL)
}

/// A house with its roof.
fn covered(mut points: Vec<[i32; 3]>, mut faces: Vec<Face>, side: i32, z: i32, top: i32) -> Body {
    let [a, b] = [2, 4].map(|panels| side * panels * PANEL);
    let far = z + 2 * PANEL;
    let corners = [[a, top, far], [b, top, far], [b, top, z], [a, top, z]];
    faces.push(panel(&mut points, corners, [0, 1, 0], ROOF, 1));
    Body { points, faces, lines: vec![], center: [side * 3 * PANEL, top / 2, z + PANEL], is_ground: false }
}

/// A box of flat faces.
fn post([x, z]: [i32; 2], half: i32, [low, high]: [i32; 2], hue: Hue) -> Body {
    let corner = |i: usize| {
        let sign = |bit: usize| if i & bit == 0 { -half } else { half };
        [x + sign(1), if i & 4 == 0 { low } else { high }, z + sign(2)]
    };
    let face = |corners: [usize; 4], normal: [i32; 3], level: i32| Face {
        corners: corners.to_vec(),
        normal,
        color: hue.shade(level),
        intensities: vec![],
        texture: None,
    };
    let faces = vec![
        face([0, 1, 5, 4], [0, 0, -1], 20),
        face([2, 3, 7, 6], [0, 0, 1], 20),
        face([0, 2, 6, 4], [-1, 0, 0], 12),
        face([1, 3, 7, 5], [1, 0, 0], 15),
        face([4, 5, 7, 6], [0, 1, 0], 26),
    ];
    let points = (0..8).map(corner).collect();
    Body { points, faces, lines: vec![], center: [x, (low + high) / 2, z], is_ground: false }
}

fn lamp_post(at: [i32; 2]) -> Body {
    post(at, 2, [0, LAMP[0]], Hue::Grey)
}

/// A trunk, and a ball of leaves in triangles.
fn tree([x, z]: [i32; 2]) -> [Body; 2] {
    [post([x, z], 4, [0, 45], Hue::Wood), ball([x, 70, z], 34.0, Hue::Leaf)]
}

/// Where the light comes from.
const LIGHT: [f64; 3] = [-0.48, 0.64, -0.6];

/// A ball of triangles whose corners are lit.
fn ball(center: [i32; 3], radius: f64, hue: Hue) -> Body {
    const AROUND: usize = 12;
    const BANDS: usize = 6;
    let direction = |band: usize, k: usize| {
        let (sin, cos) = (band as f64 / BANDS as f64 * std::f64::consts::PI).sin_cos();
        let (s, c) = (k as f64 / AROUND as f64 * std::f64::consts::TAU).sin_cos();
        [sin * c, cos, sin * s]
    };
    let directions: Vec<_> =
        (0..=BANDS).flat_map(|band| (0..AROUND).map(move |k| direction(band, k))).collect();
    let place = |d: &[f64; 3]| std::array::from_fn(|k| center[k] + (radius * d[k]).round() as i32);
    let shade = |i: usize| {
        let lit: f64 = (0..3).map(|k| directions[i][k] * LIGHT[k]).sum();
        hue.shade((8.0 + 22.0 * lit.max(0.0)).round() as i32)
    };
    let mut faces = Vec::new();
    for band in 0..BANDS {
        for k in 0..AROUND {
            let [a, b] = [k, (k + 1) % AROUND].map(|k| band * AROUND + k);
            let halves = [[a, b, b + AROUND], [a, b + AROUND, a + AROUND]];
            // At the poles one of the two has no area.
            let drawn = [band > 0, band + 1 < BANDS];
            for (corners, _) in halves.into_iter().zip([drawn[0], drawn[1]]).filter(|(_, is)| *is) {
                let normal = std::array::from_fn(|j| {
                    (corners.iter().map(|&i| directions[i][j]).sum::<f64>() * 1000.0).round() as i32
                });
                let intensities: Vec<_> = corners.iter().map(|&i| shade(i)).collect();
                let color = intensities[1];
                faces.push(Face { corners: corners.to_vec(), normal, color, intensities, texture: None });
            }
        }
    }
    let points = directions.iter().map(place).collect();
    Body { points, faces, lines: vec![], center, is_ground: false }
}

/// Wires from post to post over the road.
fn wire(z: i32, next: i32) -> Body {
    let points = vec![[-100, 108, z], [100, 108, z], [-100, 108, next], [100, 108, next]];
    let color = Hue::Grey.shade(3);
    let lines = vec![([0, 1], color), ([0, 2], color), ([1, 3], color)];
    Body { points, faces: vec![], lines, center: [0, 108, z], is_ground: false }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_world_is_sound() {
        let world = street();
        let faces = world.bodies.iter().flat_map(|b| b.faces.iter().map(move |f| (b, f)));
        for (body, face) in faces {
            assert!(face.corners.iter().all(|&i| i < body.points.len()));
            assert!(face.intensities.is_empty() || face.intensities.len() == face.corners.len());
            let Some(texture) = face.texture else { continue };
            assert!(texture.index < world.textures.len());
            let corner = |k: usize| body.points[face.corners[k]];
            let is_parallelogram = (0..3).all(|k| corner(0)[k] + corner(2)[k] == corner(1)[k] + corner(3)[k]);
            assert!(face.corners.len() == 4 && is_parallelogram);
        }
        assert!(world.bodies.iter().flat_map(|b| &b.lines).count() > 10);
    }

    #[test]
    fn normals_point_outwards() {
        for body in street().bodies.iter().filter(|b| !b.is_ground) {
            for face in &body.faces {
                let point = body.points[face.corners[0]];
                assert!(!face.faces(point, body.center), "the middle of a body sees no front");
            }
        }
    }

    #[test]
    fn lamps_light_what_is_near() {
        let [height, aside] = LAMP;
        let under = light_at([aside, 0, LAMPS[0] + LAMPS[1]]);
        assert_eq!(light_at([-aside, height, LAMPS[0] + LAMPS[1]]), LightTable::FULL);
        assert!(under < LightTable::FULL && under > light_at([aside, 0, LAMPS[0] + LAMPS[1] * 3 / 2]));
        assert_eq!(light_at([700, 0, -300]), 8, "far away the sky alone");
        let world = street();
        assert_eq!(world.lights.color(Hue::Leaf.shade(20), 31), Hue::Leaf.shade(20));
        assert_eq!(world.lights.color(Hue::Leaf.shade(20), 0), Hue::Leaf.shade(0));
    }

    #[test]
    fn shades_follow_each_other() {
        let palette = palette();
        let brightness = |i: u8| palette[usize::from(i)] & 0xff;
        assert!(
            (1..31).all(|level| brightness(Hue::Grey.shade(level)) > brightness(Hue::Grey.shade(level - 1)))
        );
        assert_eq!(darker(Hue::Leaf.shade(30), 500), Hue::Leaf.shade(15));
        assert_eq!(Hue::Sky.shade(99), Hue::Sky.shade(31));
    }
}
