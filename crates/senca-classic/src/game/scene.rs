//! What a world is made of: convex bodies of flat, shaded and textured faces.

use super::texture::Texture;

/// A world, in whole units: X to the right, Y up, Z ahead.
#[derive(Clone, Debug)]
pub struct World {
    /// Its bodies.
    pub bodies: Vec<Body>,
    /// Textures that the faces refer to.
    pub textures: Vec<Texture>,
    /// 256 colours, `0x00RRGGBB`.
    pub palette: [u32; 256],
    /// The colour behind everything.
    pub sky: u8,
    /// What each colour becomes in each light, for textures that are lit.
    pub lights: LightTable,
}

/// What each colour becomes in light, from darkness, 0, to full light, [`LightTable::FULL`]. The palette has to hold
/// several intensities of each colour for it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LightTable(Vec<[u8; 256]>);

impl LightTable {
    /// The full light, in which colours are as they are.
    pub const FULL: u8 = 31;

    /// From the colour that a colour becomes in a light.
    #[must_use]
    pub fn from_fn(color: impl Fn(u8, u8) -> u8) -> Self {
        Self((0..=Self::FULL).map(|light| std::array::from_fn(|c| color(c as u8, light))).collect())
    }

    /// What a colour becomes in a light; below 0 is darkness, more than full light is full light.
    #[must_use]
    pub fn color(&self, color: u8, light: i64) -> u8 {
        self.0[light.clamp(0, i64::from(Self::FULL)) as usize][usize::from(color)]
    }
}

/// A convex body, or ground.
#[derive(Clone, Debug)]
pub struct Body {
    /// Where its points are.
    pub points: Vec<[i32; 3]>,
    /// Its faces.
    pub faces: Vec<Face>,
    /// Lines between points, with their colours.
    pub lines: Vec<([usize; 2], u8)>,
    /// The point whose distance decides what is drawn first: the farthest.
    pub center: [i32; 3],
    /// Drawn before all that is not.
    pub is_ground: bool,
}

/// A face, seen from where its normal points.
#[derive(Clone, Debug)]
pub struct Face {
    /// Numbers of its points, in order.
    pub corners: Vec<usize>,
    /// Away from the body, of any length.
    pub normal: [i32; 3],
    /// Its colour as a flat polygon.
    pub color: u8,
    /// Colours at the corners as a shaded one; as many as corners, or none.
    pub intensities: Vec<u8>,
    /// Its texture. Only for faces of four corners that are a parallelogram.
    pub texture: Option<FaceTexture>,
}

/// A texture over a parallelogram: the first corner is its upper left, u grows to the second, v to the fourth corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FaceTexture {
    /// Number of the texture.
    pub index: usize,
    /// Logarithm of the texels along both edges.
    pub log_scale: u32,
    /// Light at the corners, 0 to [`LightTable::FULL`].
    pub light: [u8; 4],
}

impl FaceTexture {
    /// Place in the texture of a corner, 0 to 3, in texels.
    #[must_use]
    pub fn corner(&self, k: usize) -> [i32; 2] {
        let side = 1 << self.log_scale;
        [[0, 0], [side, 0], [side, side], [0, side]][k % 4]
    }
}

impl Face {
    /// Whether its front is seen from `eye`.
    #[must_use]
    pub fn faces(&self, point: [i32; 3], eye: [i32; 3]) -> bool {
        let along = |k: usize| (i128::from(eye[k]) - i128::from(point[k])) * i128::from(self.normal[k]);
        along(0) + along(1) + along(2) > 0
    }
}
