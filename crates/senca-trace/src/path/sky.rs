//! Light from beyond the scene.
//!
//! A background of one colour or a gradient lights evenly enough to be left to the directions that
//! surfaces choose. A picture of the surroundings is a light of its own: directions are chosen by how
//! bright its cells are, each the solid angle of one texel.

use senca_math::LinearRgb;
use senca_math::glam::{DVec3, Vec3};
use senca_scene::{Environment, Scene};

use super::distribution::Distribution;
use crate::recursive::background;

/// What is around the scene.
#[derive(Debug)]
pub(super) struct Sky<'s> {
    colors: background::Sky<'s>,
    picture: Option<Picture<'s>>,
}

/// Surroundings that are chosen by brightness.
#[derive(Debug)]
struct Picture<'s> {
    environment: Environment<'s>,
    cells: Cells,
    /// Mean luminance.
    brightness: f64,
}

impl<'s> Sky<'s> {
    /// What `scene` says that is around it.
    pub(super) fn new(scene: &'s Scene) -> Self {
        let picture = Environment::of_background(scene, scene.background).and_then(Picture::new);
        Self { colors: background::Sky::new(scene, scene.background, 1), picture }
    }

    /// Light from a direction (unit): a gradient runs from straight down to straight up.
    pub(super) fn towards(&self, direction: DVec3) -> LinearRgb {
        self.colors.towards(direction)
    }

    /// Whether directions can be chosen by brightness.
    pub(super) fn can_be_sampled(&self) -> bool {
        self.picture.is_some()
    }

    /// Mean luminance of what can be chosen.
    pub(super) fn brightness(&self) -> f64 {
        self.picture.as_ref().map_or(0.0, |picture| picture.brightness)
    }

    /// A bright direction and its density per steradian.
    pub(super) fn sample(&self, u: [f64; 2]) -> Option<(DVec3, f64)> {
        let picture = self.picture.as_ref()?;
        let CellPlace { place, pdf } = picture.cells.sample(u)?;
        let direction: Vec3 = picture.environment.direction(place.map(|t| t as f32));
        Some((direction.as_dvec3().try_normalize()?, pdf))
    }

    /// Density of [`Sky::sample`].
    pub(super) fn pdf(&self, direction: DVec3) -> f64 {
        let Some(picture) = &self.picture else { return 0.0 };
        picture.cells.pdf(picture.environment.place(direction.as_vec3()).map(f64::from))
    }
}

impl<'s> Picture<'s> {
    /// `None` where there is no light.
    fn new(environment: Environment<'s>) -> Option<Self> {
        let (width, height) = environment.size();
        let brightness = f64::from(environment.mean().luminance());
        let cells = Cells::new(width, height, |column, row| environment.texel_color(column, row));
        let shines = brightness > 0.0 && brightness.is_finite() && cells.rows.total() > 0.0;
        shines.then_some(Self { environment, cells, brightness })
    }
}

/// Chances of the cells of a latitude-longitude picture.
#[derive(Clone, Debug)]
pub(super) struct Cells {
    rows: Distribution,
    columns: Vec<Distribution>,
}

/// A place in the picture, with the density per steradian of the directions there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct CellPlace {
    /// u from left to right, v from top to bottom, in [0, 1].
    pub(super) place: [f64; 2],
    pub(super) pdf: f64,
}

impl Cells {
    /// Of a picture whose texels have these colours. Between texels colours are interpolated, so a
    /// cell is as bright as its texel and its neighbours, in the shares in which they show in it.
    pub(super) fn new(width: u32, height: u32, texel: impl Fn(u32, u32) -> LinearRgb) -> Self {
        let brightness = |column: u32, row: u32| {
            let color = texel(column, row);
            f64::from(color.luminance().max(1e-3 * color.max_component()).max(0.0))
        };
        let across = |row: u32| -> Vec<f64> {
            let line: Vec<f64> = (0..width).map(|column| brightness(column, row)).collect();
            let n = line.len();
            let beside = |i: usize| line[(i + 1) % n] + line[(i + n - 1) % n];
            (0..n).map(|i| 0.75 * line[i] + 0.125 * beside(i)).collect()
        };
        let lines: Vec<Vec<f64>> = (0..height).map(across).collect();
        let (mut columns, mut rows) = (Vec::new(), Vec::new());
        for row in 0..lines.len() {
            let (above, below) = (row.saturating_sub(1), (row + 1).min(lines.len() - 1));
            let mixed = (0..width as usize)
                .map(|i| 0.75 * lines[row][i] + 0.125 * (lines[above][i] + lines[below][i]));
            let distribution = Distribution::new(mixed);
            let [top, bottom] = heights(row, lines.len());
            rows.push(distribution.total() * (top - bottom));
            columns.push(distribution);
        }
        Self { rows: Distribution::new(rows), columns }
    }

    /// A place, even over the solid angle of its cell.
    pub(super) fn sample(&self, [u, v]: [f64; 2]) -> Option<CellPlace> {
        let (row, row_chance, v) = self.rows.choose(v)?;
        let (column, column_chance, u) = self.columns[row].choose(u)?;
        let [top, bottom] = heights(row, self.rows.len());
        let y = top + v * (bottom - top);
        let width = self.columns[row].len();
        let place = [(column as f64 + u) / width as f64, y.clamp(-1.0, 1.0).acos() / std::f64::consts::PI];
        Some(CellPlace { place, pdf: row_chance * column_chance / solid_angle(top - bottom, width) })
    }

    /// Density of [`Cells::sample`] at a place.
    pub(super) fn pdf(&self, [u, v]: [f64; 2]) -> f64 {
        let index = |t: f64, n: usize| ((t * n as f64) as usize).min(n - 1);
        let row = index(v, self.rows.len());
        let columns = &self.columns[row];
        let column = index(u, columns.len());
        let [top, bottom] = heights(row, self.rows.len());
        self.rows.chance(row) * columns.chance(column) / solid_angle(top - bottom, columns.len())
    }
}

/// y at the upper and lower edge of a row on the unit sphere.
fn heights(row: usize, rows: usize) -> [f64; 2] {
    [row, row + 1].map(|r| (r as f64 / rows as f64 * std::f64::consts::PI).cos())
}

/// Solid angle of a cell.
fn solid_angle(height: f64, columns: usize) -> f64 {
    height * std::f64::consts::TAU / columns as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Pattern, Sampler};
    use senca_scene::{Background, ImageData, ImageId, TextureImage};

    /// Surroundings of 8 x 4 texels, dim but for one.
    fn scene() -> Scene {
        let mut texels = vec![[0.1, 0.1, 0.1, 1.0]; 32];
        texels[8 + 3] = [50.0, 40.0, 30.0, 1.0];
        let data = ImageData::RgbaF32 { width: 8, height: 4, texels };
        let background = Background::Environment { image: ImageId(0), strength: 2.0, rotation: 0.7 };
        Scene { images: vec![TextureImage { name: String::new(), data }], background, ..Scene::default() }
    }

    fn mean(n: u32, of: impl Fn([f64; 2]) -> f64) -> f64 {
        (0..n).map(|i| of(Sampler::new(Pattern::Sobol, 9, 0, 0, i).next_2d())).sum::<f64>() / f64::from(n)
    }

    #[test]
    fn chosen_directions_add_up_to_all_light() {
        let scene = scene();
        let sky = Sky::new(&scene);
        let light = |direction: DVec3| f64::from(sky.towards(direction).r);
        let by_brightness = mean(4096, |u| {
            let (direction, pdf) = sky.sample(u).expect("shines");
            assert!((sky.pdf(direction) / pdf - 1.0).abs() < 1e-6 || pdf < 1.0, "{pdf}");
            light(direction) / pdf
        });
        let everywhere =
            mean(1 << 16, |u| 4.0 * std::f64::consts::PI * light(super::super::warp::cone(u, 2.0)));
        assert!((by_brightness / everywhere - 1.0).abs() < 0.01, "{by_brightness} {everywhere}");
        let whole = mean(1 << 14, |u| 4.0 * std::f64::consts::PI * sky.pdf(super::super::warp::cone(u, 2.0)));
        assert!((whole - 1.0).abs() < 0.01, "the density adds up to {whole}");
    }

    #[test]
    fn plain_backgrounds_are_left_to_surfaces() {
        let scene = Scene { background: Background::Color(LinearRgb::WHITE), ..Scene::default() };
        let sky = Sky::new(&scene);
        assert!(!sky.can_be_sampled() && sky.sample([0.5; 2]).is_none());
        assert_eq!((sky.towards(DVec3::X), sky.pdf(DVec3::X)), (LinearRgb::WHITE, 0.0));
    }
}
