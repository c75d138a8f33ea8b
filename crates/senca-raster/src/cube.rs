//! Textures around a point: the six faces of a cube, read in the direction of a fragment (Greene 1986; OpenGL 1.5,
//! section 3.8.6). The faces lie below each other in one image, each with a rim of a texel that belongs to its
//! neighbours, so that no fragment has to look at two faces.

use crate::texture::{MAX_TEXTURE_SIDE, Sampler, TextureError};
use fearless_simd::{Simd, f32x16, i32x16, mask32x16, prelude::*};

/// Axes of the faces +x, -x, +y, -y, +z, -z: the major axis, and which of x, y, z are s and t, each with its sign.
pub const FACES: [[(usize, f32); 3]; 6] = [
    [(0, 1.0), (2, -1.0), (1, -1.0)],
    [(0, -1.0), (2, 1.0), (1, -1.0)],
    [(1, 1.0), (0, 1.0), (2, 1.0)],
    [(1, -1.0), (0, 1.0), (2, -1.0)],
    [(2, 1.0), (0, 1.0), (1, -1.0)],
    [(2, -1.0), (0, -1.0), (1, -1.0)],
];

/// The face that a direction meets.
#[must_use]
pub fn face_of([x, y, z]: [f32; 3]) -> usize {
    let (ax, ay, az) = (x.abs(), y.abs(), z.abs());
    if ax >= ay && ax >= az {
        usize::from(x < 0.0)
    } else if ay >= az {
        2 + usize::from(y < 0.0)
    } else {
        4 + usize::from(z < 0.0)
    }
}

/// Where a direction meets the plane of a face: s and t, within [0, 1] on the face itself.
#[must_use]
pub fn on_face(face: usize, direction: [f32; 3]) -> [f32; 2] {
    let [major, s, t] = FACES[face % 6].map(|(axis, sign)| sign * direction[axis]);
    let scale = 0.5 / major;
    [s * scale + 0.5, t * scale + 0.5]
}

/// The texel beyond the edge of a face of `n` by `n` texels: of the neighbour, or at corners, which have none, the
/// nearest. Face, column and row.
#[must_use]
pub fn across_edge(face: usize, [i, j]: [i32; 2], n: i32) -> (usize, [i32; 2]) {
    let outside = |v: i32| v < 0 || v >= n;
    if outside(i) && outside(j) {
        return (face, [i.clamp(0, n - 1), j.clamp(0, n - 1)]);
    }
    let place = |v: i32| (2 * v + 1) as f32 / n as f32 - 1.0;
    let mut direction = [0.0; 3];
    for ((axis, sign), value) in FACES[face % 6].into_iter().zip([1.0, place(i), place(j)]) {
        direction[axis] = sign * value;
    }
    let face = face_of(direction);
    let texel = |s: f32| ((s * n as f32).floor() as i32).clamp(0, n - 1);
    (face, on_face(face, direction).map(texel))
}

/// One level of a [`CubeTexture`].
#[derive(Clone, Debug, PartialEq)]
struct CubeLevel {
    /// Texels along an edge of a face.
    size: u32,
    /// Rows of `size + 2` texels, `size + 2` of them for each face.
    texels: Vec<[u8; 4]>,
}

impl CubeLevel {
    fn new(faces: &[&[[u8; 4]]; 6], size: u32, seamless: bool) -> Result<Self, TextureError> {
        let expected = size as usize * size as usize;
        if let Some(face) = faces.iter().find(|face| face.len() != expected) {
            return Err(TextureError::Count { expected, found: face.len() });
        }
        let n = size as i32;
        let mut texels = Vec::with_capacity(6 * (size as usize + 2).pow(2));
        for (number, face) in faces.iter().enumerate() {
            let beyond = |i: i32, j: i32| {
                let (face, [i, j]) = match seamless {
                    true => across_edge(number, [i, j], n),
                    false => (number, [i.clamp(0, n - 1), j.clamp(0, n - 1)]),
                };
                faces[face][(j * n + i) as usize]
            };
            texels.extend((-1..=n).map(|i| beyond(i, -1)));
            for (j, row) in (0..n).zip(face.chunks_exact(size as usize)) {
                texels.push(beyond(-1, j));
                texels.extend_from_slice(row);
                texels.push(beyond(n, j));
            }
            texels.extend((-1..=n).map(|i| beyond(i, n)));
        }
        Ok(Self { size, texels })
    }

    /// Texel of a face; columns and rows -1 and `size` are those of its rim.
    fn texel(&self, face: usize, [i, j]: [i32; 2]) -> [f32; 4] {
        let width = self.size as usize + 2;
        let row = face * width + (j + 1) as usize;
        self.texels[row * width + (i + 1) as usize].map(|v| f32::from(v) * (1.0 / 255.0))
    }

    /// Weighted mean of the four texels around s, t.
    fn bilinear(&self, face: usize, st: [f32; 2]) -> [f32; 4] {
        let place = st.map(|s| held(s) * self.size as f32 - 0.5);
        let low = place.map(|p| p.floor() as i32);
        let share = [place[0] - place[0].floor(), place[1] - place[1].floor()];
        let at = |i: i32, j: i32| self.texel(face, [low[0] + i, low[1] + j]);
        lerp(lerp(at(0, 0), at(1, 0), share[0]), lerp(at(0, 1), at(1, 1), share[0]), share[1])
    }
}

fn lerp(a: [f32; 4], b: [f32; 4], t: f32) -> [f32; 4] {
    std::array::from_fn(|k| a[k] + (b[k] - a[k]) * t)
}

/// `s` within 0 and 1; 0 if it is not a number.
fn held(s: f32) -> f32 {
    if s > 0.0 { s.min(1.0) } else { 0.0 }
}

/// Six square pictures of 8 bits a channel, with their levels.
#[derive(Clone, Debug, PartialEq)]
pub struct CubeTexture {
    levels: Vec<CubeLevel>,
}

impl CubeTexture {
    /// From the faces of each level, in the order of [`FACES`], row after row from t = 0, and their sizes: each half of
    /// the one before, rounded down. Texels of two faces are mixed where they meet if it is `seamless`.
    ///
    /// # Errors
    /// [`TextureError::Side`], also without levels; [`TextureError::Count`]; [`TextureError::Level`].
    pub fn new(levels: &[(u32, [&[[u8; 4]]; 6])], seamless: bool) -> Result<Self, TextureError> {
        let size = levels.first().map_or(0, |(size, _)| *size);
        if size == 0 || size > MAX_TEXTURE_SIDE {
            return Err(TextureError::Side { width: size, height: size });
        }
        if let Some(k) = (1..levels.len()).find(|&k| levels[k].0 != (levels[k - 1].0 / 2).max(1)) {
            return Err(TextureError::Level { level: k });
        }
        let level = |(size, faces): &(u32, [&[[u8; 4]]; 6])| CubeLevel::new(faces, *size, seamless);
        Ok(Self { levels: levels.iter().map(level).collect::<Result<_, _>>()? })
    }

    /// Texels along an edge of the finest level.
    #[must_use]
    pub fn size(&self) -> u32 {
        self.levels[0].size
    }

    /// Number of levels, at least 1.
    #[must_use]
    pub fn level_count(&self) -> usize {
        self.levels.len()
    }

    /// Texels of each level.
    pub(crate) fn texels(&self) -> impl Iterator<Item = &[[u8; 4]]> {
        self.levels.iter().map(|level| level.texels.as_slice())
    }
}

/// A [`CubeTexture`], how it is read, and where its coordinates are.
#[derive(Clone, Copy, Debug)]
pub struct CubeUnit<'a> {
    /// What is read.
    pub texture: &'a CubeTexture,
    /// How it is read. Within a level the four texels around are mixed, and there is no wrapping: of the sampler only
    /// [`Sampler::mip`] and [`Sampler::lod_bias`] count.
    pub sampler: Sampler,
    /// Number of the varying that is x of the direction; y and z follow. It need not have the length 1.
    pub coords: usize,
}

impl CubeUnit<'_> {
    /// The colour in a direction, and its changes per pixel in x and y: the plain form.
    pub(crate) fn sample(&self, direction: [f32; 3], changes: [[f32; 3]; 2]) -> [f32; 4] {
        let face = face_of(direction);
        let size = self.texture.size() as f32;
        let [major, s, t] = FACES[face].map(|(axis, sign)| sign * direction[axis]);
        let scale = 0.5 / major;
        let square = |change: [f32; 3]| {
            let [major, ds, dt] = FACES[face].map(|(axis, sign)| sign * change[axis]);
            let of = |d: f32, v: f32| (d - (v * scale) * (major + major)) * (scale * size);
            of(ds, s) * of(ds, s) + of(dt, t) * of(dt, t)
        };
        let (x, y) = (square(changes[0]), square(changes[1]));
        let lod = 0.5 * crate::texture::log2(if x > y { x } else { y }) + self.sampler.lod_bias;
        let (level, share) = self.sampler.levels_at(lod, self.texture.level_count());
        let st = [s * scale + 0.5, t * scale + 0.5];
        let levels = &self.texture.levels;
        let fine = levels[level].bilinear(face, st);
        match levels.get(level + 1).filter(|_| share > 0.0) {
            Some(coarse) => lerp(fine, coarse.bilinear(face, st), share),
            None => fine,
        }
    }
}

/// Where sixteen directions meet the cube.
pub(crate) struct OnCube<S: Simd> {
    /// Number of the face.
    pub(crate) face: i32x16<S>,
    pub(crate) st: [f32x16<S>; 2],
    /// Square of the longer side of a pixel, in texels of the finest level.
    pub(crate) footprint: f32x16<S>,
}

/// Which faces directions meet.
struct Major<S: Simd> {
    x: mask32x16<S>,
    /// If not x.
    y: mask32x16<S>,
    /// 1 or -1.
    sign: f32x16<S>,
}

impl<S: Simd> Major<S> {
    /// Major coordinate, s and t of [`FACES`].
    #[inline(always)]
    fn turned(&self, simd: S, [x, y, z]: [f32x16<S>; 3]) -> [f32x16<S>; 3] {
        let zero = f32x16::splat(simd, 0.0);
        let major = self.x.select(x, self.y.select(y, z)) * self.sign;
        let s = self.x.select(zero - z * self.sign, self.y.select(x, x * self.sign));
        let t = (!self.x & self.y).select(z * self.sign, zero - y);
        [major, s, t]
    }
}

/// The vector twin of [`CubeUnit::sample`]: directions and their changes per pixel in x and y.
#[inline(always)]
pub(crate) fn on_cube<S: Simd>(
    simd: S,
    size: u32,
    direction: [f32x16<S>; 3],
    [dx, dy]: [[f32x16<S>; 3]; 2],
) -> OnCube<S> {
    let splat = |v: f32| f32x16::splat(simd, v);
    let [ax, ay, az] = [direction[0].abs(), direction[1].abs(), direction[2].abs()];
    let (x, y) = (ax.simd_ge(ay) & ax.simd_ge(az), ay.simd_ge(az));
    let value = x.select(direction[0], y.select(direction[1], direction[2]));
    let negative = value.simd_lt(splat(0.0));
    let major = Major { x, y, sign: negative.select(splat(-1.0), splat(1.0)) };
    let number = |v: i32| i32x16::splat(simd, v);
    let first = x.select(number(0), y.select(number(2), number(4)));
    let [value, s, t] = major.turned(simd, direction);
    let scale = splat(0.5) / value;
    let of = [s * scale, t * scale];
    let (dx, dy) = (major.turned(simd, dx), major.turned(simd, dy));
    let size = splat(size as f32);
    let along_x = square(dx, of, scale * size);
    let along_y = square(dy, of, scale * size);
    OnCube {
        face: negative.select(first + number(1), first),
        st: [of[0] + splat(0.5), of[1] + splat(0.5)],
        footprint: along_x.simd_gt(along_y).select(along_x, along_y),
    }
}

/// Square of the length of a change, turned as [`Major::turned`] does, by which s and t change about `of`.
#[inline(always)]
fn square<S: Simd>([major, s, t]: [f32x16<S>; 3], of: [f32x16<S>; 2], scale: f32x16<S>) -> f32x16<S> {
    let (s, t) = ((s - of[0] * (major + major)) * scale, (t - of[1] * (major + major)) * scale);
    s * s + t * t
}

/// Numbers of the texels of a level upper left of places on faces, and below those; the position between them, in
/// 1/256.
pub(crate) struct CubeTaps<S: Simd> {
    pub(crate) left: [i32x16<S>; 2],
    pub(crate) between: [i32x16<S>; 2],
}

impl CubeTexture {
    /// Texels of level `number`, or of the last one, around places on faces.
    #[inline(always)]
    pub(crate) fn taps<S: Simd>(
        &self,
        simd: S,
        number: usize,
        face: i32x16<S>,
        [s, t]: [f32x16<S>; 2],
    ) -> CubeTaps<S> {
        let size = self.levels[number.min(self.levels.len() - 1)].size;
        let splat = |v: f32| f32x16::splat(simd, v);
        // The rim moves texels by one.
        let size_lanes = splat(size as f32);
        let (x, y) =
            (held_lanes(simd, s) * size_lanes + splat(0.5), held_lanes(simd, t) * size_lanes + splat(0.5));
        let (fx, fy) = (x.floor(), y.floor());
        let width = i32x16::splat(simd, size as i32 + 2);
        let (column, row): (i32x16<S>, i32x16<S>) = (fx.to_int(), fy.to_int());
        let upper = (face * width + row) * width + column;
        let (scale, half) = (splat(256.0), splat(0.5));
        let between = [((x - fx) * scale + half).to_int(), ((y - fy) * scale + half).to_int()];
        CubeTaps { left: [upper, upper + width], between }
    }
}

/// See [`held`].
#[inline(always)]
fn held_lanes<S: Simd>(simd: S, s: f32x16<S>) -> f32x16<S> {
    let zero = f32x16::splat(simd, 0.0);
    s.simd_gt(zero).select(s.min(f32x16::splat(simd, 1.0)), zero)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Faces of `n` by `n` texels: red is the number of the face, green the column, blue the row.
    fn faces(n: u32) -> [Vec<[u8; 4]>; 6] {
        std::array::from_fn(|f| (0..n * n).map(|i| [f as u8, (i % n) as u8, (i / n) as u8, 255]).collect())
    }

    #[test]
    fn rims_belong_to_neighbours() {
        let faces = faces(4);
        let level = |seamless| CubeLevel::new(&faces.each_ref().map(Vec::as_slice), 4, seamless).unwrap();
        let texel = |level: &CubeLevel, face, at| level.texel(face, at).map(|v| (v * 255.0).round() as u8);
        // Left of +z is -x, whose right column it is; above it +y, whose lowest row it is.
        assert_eq!(texel(&level(true), 4, [-1, 2]), [1, 3, 2, 255]);
        assert_eq!(texel(&level(true), 4, [1, -1]), [2, 1, 3, 255]);
        assert_eq!(texel(&level(true), 4, [-1, -1]), [4, 0, 0, 255]);
        assert_eq!(texel(&level(false), 4, [-1, 2]), [4, 0, 2, 255]);
        assert_eq!(texel(&level(true), 4, [3, 2]), [4, 3, 2, 255]);
    }

    #[test]
    fn levels_must_follow_from_each_other() {
        let (four, two) = (faces(4), faces(2));
        let (four, two) = (four.each_ref().map(Vec::as_slice), two.each_ref().map(Vec::as_slice));
        assert_eq!(CubeTexture::new(&[(4, four), (2, two)], true).unwrap().level_count(), 2);
        let error = |levels: &[(u32, [&[[u8; 4]]; 6])]| CubeTexture::new(levels, true).unwrap_err();
        assert_eq!(error(&[(4, four), (4, four)]), TextureError::Level { level: 1 });
        assert_eq!(error(&[(2, four)]), TextureError::Count { expected: 4, found: 16 });
        assert_eq!(error(&[]), TextureError::Side { width: 0, height: 0 });
    }

    #[test]
    fn faces_lie_as_opengl_says() {
        // Table 3.20: +x: s = -z, t = -y; -y: s = x, t = -z.
        assert_eq!((face_of([2.0, 1.0, -0.5]), on_face(0, [2.0, 1.0, -0.5])), (0, [0.625, 0.25]));
        assert_eq!((face_of([0.5, -1.0, 0.25]), on_face(3, [0.5, -1.0, 0.25])), (3, [0.75, 0.375]));
        let simd = fearless_simd::Level::baseline();
        fearless_simd::dispatch!(simd, simd => {
            let mut n = 0u32;
            let mut next = || { n = n.wrapping_mul(1_664_525).wrapping_add(1_013_904_223); n as f32 / 2e9 - 1.0 };
            let lanes: [[f32; 16]; 9] = std::array::from_fn(|_| std::array::from_fn(|_| next()));
            let load = |k: usize| f32x16::load_array(simd, lanes[k]);
            let three = |k: usize| [load(k), load(k + 1), load(k + 2)];
            let on = on_cube(simd, 1, three(0), [three(3), three(6)]);
            let (found, s, t) = (on.face.to_array(), on.st[0].to_array(), on.st[1].to_array());
            for i in 0..16 {
                let direction = [lanes[0][i], lanes[1][i], lanes[2][i]];
                let face = face_of(direction);
                assert_eq!(found[i] as usize, face);
                assert_eq!([s[i], t[i]], on_face(face, direction));
            }
        });
    }
}
