//! Surroundings from a latitude-longitude picture.

use std::f32::consts::{PI, TAU};

use senca_math::glam::Vec3;
use senca_math::{LinearRgb, Srgb8};

use crate::{Background, ImageData, Scene};

/// The surroundings of a scene, ready to be looked at. See [`Background::Environment`] for how the
/// picture lies.
#[derive(Clone, Copy, Debug)]
pub struct Environment<'a> {
    image: &'a ImageData,
    strength: f32,
    rotation: f32,
}

impl<'a> Environment<'a> {
    /// The surroundings of `scene`, if its background is an environment whose picture is there.
    #[must_use]
    pub fn of(scene: &'a Scene) -> Option<Self> {
        Self::of_background(scene, scene.background)
    }

    /// The surroundings that `background` describes, its picture being one of those of `scene`.
    #[must_use]
    pub fn of_background(scene: &'a Scene, background: Background) -> Option<Self> {
        let Background::Environment { image, strength, rotation } = background else { return None };
        let image = &scene.images.get(image.index())?.data;
        let (width, height) = image.size();
        (width > 0 && height > 0).then_some(Self { image, strength, rotation })
    }

    /// Light that comes from `direction` (world space, any length but 0): the picture's texels
    /// interpolated bilinearly, around the sphere without a seam.
    #[must_use]
    pub fn color(&self, direction: Vec3) -> LinearRgb {
        let [u, v] = self.place(direction);
        let (width, height) = self.image.size();
        let (x, y) = (u * width as f32 - 0.5, v * height as f32 - 0.5);
        let (column, row) = (x.floor(), y.floor());
        let (fx, fy) = (x - column, y - row);
        let columns = [0, 1].map(|i| (column as i64 + i).rem_euclid(i64::from(width)) as u32);
        let rows = [0, 1].map(|i| (row as i64 + i).clamp(0, i64::from(height) - 1) as u32);
        let across = |row: u32| self.texel(columns[0], row).lerp(self.texel(columns[1], row), fx);
        across(rows[0]).lerp(across(rows[1]), fy) * self.strength
    }

    /// Where in the picture a direction is found: u from 0 at the left edge to 1 at the right one, v
    /// from 0 at the top to 1 at the bottom.
    #[must_use]
    pub fn place(&self, direction: Vec3) -> [f32; 2] {
        let d = direction.normalize_or(Vec3::NEG_Z);
        let longitude = d.x.atan2(-d.z) + self.rotation;
        let u = 0.5 + longitude / TAU;
        [u - u.floor(), d.y.clamp(-1.0, 1.0).acos() / PI]
    }

    /// The unit direction that is found at the place `[u, v]` of the picture; the inverse of
    /// [`Environment::place`].
    #[must_use]
    pub fn direction(&self, [u, v]: [f32; 2]) -> Vec3 {
        let longitude = (u - 0.5) * TAU - self.rotation;
        let (sin, cos) = longitude.sin_cos();
        let (radius, y) = (v * PI).sin_cos();
        Vec3::new(radius * sin, y, -radius * cos)
    }

    /// Width and height of the picture in texels, each at least 1.
    #[must_use]
    pub fn size(&self) -> (u32, u32) {
        self.image.size()
    }

    /// Light of one texel, with the strength of the surroundings.
    ///
    /// # Panics
    /// When the texel is out of range.
    #[must_use]
    pub fn texel_color(&self, column: u32, row: u32) -> LinearRgb {
        self.texel(column, row) * self.strength
    }

    /// Mean light from all directions, each row counting by its share of the sphere.
    #[must_use]
    pub fn mean(&self) -> LinearRgb {
        let (width, height) = self.image.size();
        let mut sum = [0.0f64; 3];
        for row in 0..height {
            let edge = |r: u32| (f64::from(r) / f64::from(height) * std::f64::consts::PI).cos();
            let share = 0.5 * (edge(row) - edge(row + 1)) / f64::from(width);
            for column in 0..width {
                let color = self.texel(column, row).to_array();
                (0..3).for_each(|k| sum[k] += share * f64::from(color[k]));
            }
        }
        LinearRgb::from_array(sum.map(|s| s as f32)) * self.strength
    }

    /// The light that surfaces receive, by the direction that they face.
    #[must_use]
    pub fn irradiance(&self) -> Irradiance {
        // Texels as large as those of small pictures are not taken for points.
        let (width, height) = self.image.size();
        let (width, height) = (width.max(128), height.max(64));
        let mut sums = [[0.0f64; 3]; 9];
        for row in 0..height {
            let edge = |r: u32| (f64::from(r) / f64::from(height) * std::f64::consts::PI).cos();
            let solid_angle = std::f64::consts::TAU * (edge(row) - edge(row + 1)) / f64::from(width);
            for column in 0..width {
                let place = [(column as f32 + 0.5) / width as f32, (row as f32 + 0.5) / height as f32];
                let direction = self.direction(place);
                let (basis, color) = (harmonics(direction), self.color(direction).to_array());
                for (sum, y) in sums.iter_mut().zip(basis) {
                    (0..3).for_each(|k| sum[k] += solid_angle * f64::from(y) * f64::from(color[k]));
                }
            }
        }
        let mut irradiance = Irradiance::default();
        for (i, sum) in sums.into_iter().enumerate() {
            let share = COSINE_LOBE[i];
            irradiance.coefficients[i] = LinearRgb::from_array(sum.map(|s| s as f32 * share));
        }
        irradiance
    }

    fn texel(&self, column: u32, row: u32) -> LinearRgb {
        let i = row as usize * self.image.size().0 as usize + column as usize;
        match self.image {
            ImageData::RgbaF32 { texels, .. } => {
                let [r, g, b, _] = texels[i];
                LinearRgb::new(r, g, b)
            }
            ImageData::Rgba8 { texels, .. } => {
                let [r, g, b, _] = texels[i];
                Srgb8 { r, g, b }.to_linear()
            }
        }
    }
}

/// Light that arrives at a surface from all around, as a white matt surface that faces some way would show
/// it: the first nine spherical harmonics, which are right to some percent.
/// Source: Ramamoorthi and Hanrahan 2001, "An efficient representation for irradiance environment maps".
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Irradiance {
    coefficients: [LinearRgb; 9],
}

impl Irradiance {
    /// The same from everywhere.
    #[must_use]
    pub fn even(color: LinearRgb) -> Self {
        let mut irradiance = Self::default();
        irradiance.coefficients[0] = color * (2.0 * PI.sqrt());
        irradiance
    }

    /// Arriving light over pi where the surface faces `normal` (unit, world space); not negative.
    #[must_use]
    pub fn towards(&self, normal: Vec3) -> LinearRgb {
        let mut sum = LinearRgb::BLACK;
        for (coefficient, y) in self.coefficients.iter().zip(harmonics(normal)) {
            sum += *coefficient * y;
        }
        sum.map(|v| v.max(0.0))
    }
}

/// Share of each harmonic that the cosine lobe leaves, over pi: 1 of order 0, 2/3 of order 1, 1/4 of order 2.
const COSINE_LOBE: [f32; 9] = [1.0, 2.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0, 0.25, 0.25, 0.25, 0.25, 0.25];

/// The real spherical harmonics of orders 0 to 2 in a unit direction.
fn harmonics(d: Vec3) -> [f32; 9] {
    let (zeroth, first) = (0.5 / PI.sqrt(), (0.75 / PI).sqrt());
    let (second, middle) = ((3.75 / PI).sqrt(), (5.0 / (16.0 * PI)).sqrt());
    [
        zeroth,
        first * d.y,
        first * d.z,
        first * d.x,
        second * d.x * d.y,
        second * d.y * d.z,
        middle * (3.0 * d.z * d.z - 1.0),
        second * d.x * d.z,
        0.5 * second * (d.x * d.x - d.y * d.y),
    ]
}

impl Scene {
    /// Light of the surroundings from `direction`; black without an environment. Where many
    /// directions are asked for, keep the [`Environment`].
    #[must_use]
    pub fn environment_color(&self, direction: Vec3) -> LinearRgb {
        Environment::of(self).map_or(LinearRgb::BLACK, |environment| environment.color(direction))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ImageId, TextureImage};
    use proptest::prelude::*;

    /// Four columns and two rows: red, green, blue, white above, black below.
    fn scene(rotation: f32) -> Scene {
        let row = [[1.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, 1.0], [0.0, 0.0, 1.0, 1.0], [1.0; 4]];
        let mut texels = row.to_vec();
        texels.extend([[0.0, 0.0, 0.0, 1.0]; 4]);
        let data = ImageData::RgbaF32 { width: 4, height: 2, texels };
        let image = TextureImage { name: String::new(), data };
        let background = Background::Environment { image: ImageId(0), strength: 2.0, rotation };
        Scene { images: vec![image], background, ..Scene::default() }
    }

    #[test]
    fn the_picture_lies_as_documented() {
        let scene = scene(0.0);
        let environment = Environment::of(&scene).expect("an environment");
        assert_eq!(environment.place(Vec3::NEG_Z)[0], 0.5);
        assert_eq!(environment.place(Vec3::X)[0], 0.75);
        assert_eq!(environment.place(Vec3::NEG_X)[0], 0.25);
        assert_eq!(environment.place(Vec3::Y)[1], 0.0);
        assert_eq!(environment.place(Vec3::NEG_Y)[1], 1.0);
        // The middle of the third column's upper texel, to the right of straight ahead.
        let blue = environment.color(environment.direction([0.625, 0.25]));
        assert!((blue.b - 2.0).abs() < 1e-5 && blue.r < 1e-5);
        // Between the last column and the first there is no seam.
        let seam = environment.color(environment.direction([0.0, 0.25]));
        assert!((seam.r - 2.0).abs() < 1e-5 && (seam.g - 1.0).abs() < 1e-5);
        assert_eq!(environment.texel_color(3, 0), LinearRgb::splat(2.0));
    }

    #[test]
    fn a_turn_moves_what_is_ahead_to_the_left() {
        // Counter-clockwise from above: what was ahead (-z) is then at -x.
        let scene = scene(std::f32::consts::FRAC_PI_2);
        let environment = Environment::of(&scene).expect("an environment");
        assert!((environment.place(Vec3::NEG_X)[0] - 0.5).abs() < 1e-6);
    }

    #[test]
    fn the_mean_weighs_by_solid_angle() {
        let scene = scene(1.0);
        let mean = Environment::of(&scene).expect("an environment").mean();
        // Half of the sphere has the mean of red, green, blue and white, times 2.
        assert!((mean.r - 0.5).abs() < 1e-6 && (mean.g - 0.5).abs() < 1e-6);
        assert_eq!(Scene::default().environment_color(Vec3::X), LinearRgb::BLACK);
        assert!(Environment::of(&Scene { images: Vec::new(), ..scene }).is_none());
    }

    proptest! {
        #[test]
        fn places_and_directions_are_inverse(u in 0.001f32..0.999, v in 0.01f32..0.99, rotation in -3.0f32..3.0) {
            let scene = scene(rotation);
            let environment = Environment::of(&scene).expect("an environment");
            let [u2, v2] = environment.place(environment.direction([u, v]));
            prop_assert!((u - u2).abs() < 1e-5 && (v - v2).abs() < 1e-5);
        }
    }

    /// One colour everywhere.
    fn even_picture() -> Scene {
        let data = ImageData::RgbaF32 { width: 1, height: 1, texels: vec![[0.5, 0.25, 0.125, 1.0]] };
        let images = vec![TextureImage { name: String::new(), data }];
        let background = Background::Environment { image: ImageId(0), strength: 2.0, rotation: 1.0 };
        Scene { images, background, ..Scene::default() }
    }

    #[test]
    fn even_surroundings_light_all_sides_alike() {
        let scene = even_picture();
        let irradiance = Environment::of(&scene).expect("an environment").irradiance();
        let even = Irradiance::even(LinearRgb::new(1.0, 0.5, 0.25));
        for normal in [Vec3::X, Vec3::NEG_Y, Vec3::Z, Vec3::new(0.6, 0.0, -0.8)] {
            for seen in [irradiance.towards(normal), even.towards(normal)] {
                assert!((seen.r - 1.0).abs() < 1e-3 && (seen.b - 0.25).abs() < 1e-3, "{seen:?}");
            }
        }
    }

    #[test]
    fn a_bright_half_lights_what_faces_it() {
        // Rows 0 to 31 are above the horizon. The harmonics give the closed form exactly here: (1 + cos) / 2.
        let texel = |i: usize| if i < 32 * 4 { [1.0; 4] } else { [0.0; 4] };
        let data = ImageData::RgbaF32 { width: 4, height: 64, texels: (0..64 * 4).map(texel).collect() };
        let images = vec![TextureImage { name: String::new(), data }];
        let background = Background::Environment { image: ImageId(0), strength: 1.0, rotation: 0.0 };
        let scene = Scene { images, background, ..Scene::default() };
        let irradiance = Environment::of(&scene).expect("an environment").irradiance();
        for angle in [0.0f32, 0.7, 1.6, 2.5, PI] {
            let (sin, cos) = angle.sin_cos();
            let seen = irradiance.towards(Vec3::new(sin, cos, 0.0)).g;
            assert!((seen - 0.5 * (1.0 + cos)).abs() < 2e-3, "{angle}: {seen}");
        }
    }
}
