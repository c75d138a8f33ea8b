//! Illuminance on a grid of places, for people who plan lighting.

use rayon::prelude::*;
use senca_math::glam::DVec3;
use senca_math::{Aabb, Cancelled, Control, Image, LinearRgb};

use crate::RadiosityError;
use crate::false_color::{FalseColors, with_scale};

/// Places in rows and columns on a horizontal plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LuxGrid {
    /// The place of column 0 and row 0.
    pub origin: DVec3,
    /// From one column to the next.
    pub column: DVec3,
    /// From one row to the next.
    pub row: DVec3,
    /// Numbers of columns and rows.
    pub size: [u32; 2],
    /// Unit normal of the measured side.
    pub normal: DVec3,
}

/// Colour of places that do not count.
const LEFT_OUT: LinearRgb = LinearRgb::splat(0.18);

/// Most places of a grid.
pub const MOST_LUX_PLACES: u64 = 1 << 22;

impl LuxGrid {
    /// Evenly spread places at `height` over the box from above, half a step from its border, about
    /// `spacing` apart, looking up.
    ///
    /// # Errors
    /// [`RadiosityError::Setting`] for a spacing that is not above 0, or that makes too many places.
    pub fn horizontal(bounds: &Aabb, height: f64, spacing: f64) -> Result<Self, RadiosityError> {
        let size = bounds.size();
        let counts = counts([size.x, size.z], spacing)?;
        let [dx, dz] = [size.x / f64::from(counts[0]), size.z / f64::from(counts[1])];
        Ok(Self {
            origin: DVec3::new(bounds.min.x + 0.5 * dx, height, bounds.min.z + 0.5 * dz),
            column: DVec3::X * dx,
            row: DVec3::Z * dz,
            size: counts,
            normal: DVec3::Y,
        })
    }

    /// Evenly spread places on a rectangle with this corner and these edges, half a step from its border,
    /// about `spacing` apart. Columns run along the first edge, rows along the second; measured is the
    /// side from which the second edge follows the first one counter-clockwise.
    ///
    /// # Errors
    /// [`RadiosityError::Setting`] for edges that are not at a right angle, or have no length, and for
    /// spacings as in [`LuxGrid::horizontal`].
    pub fn rectangle(corner: DVec3, edges: [DVec3; 2], spacing: f64) -> Result<Self, RadiosityError> {
        let lengths = edges.map(DVec3::length);
        let cosine = edges[0].dot(edges[1]) / (lengths[0] * lengths[1]);
        // Written so that numbers that are none are refused.
        if !(cosine.abs() < 1e-3 && corner.is_finite()) {
            let expected = "0: at a right angle, and with a length";
            return Err(RadiosityError::Setting {
                name: "cosine between the edges",
                value: cosine,
                expected,
            });
        }
        let size = counts(lengths, spacing)?;
        let [column, row] = [0, 1].map(|k| edges[k] / f64::from(size[k]));
        let normal = edges[0].cross(edges[1]).normalize();
        Ok(Self { origin: corner + 0.5 * (column + row), column, row, size, normal })
    }

    /// A place of the grid.
    #[must_use]
    pub fn place(&self, column: u32, row: u32) -> DVec3 {
        self.origin + self.column * f64::from(column) + self.row * f64::from(row)
    }
}

/// Numbers of places along two lengths.
fn counts(lengths: [f64; 2], spacing: f64) -> Result<[u32; 2], RadiosityError> {
    let refuse = |value, expected| Err(RadiosityError::Setting { name: "spacing", value, expected });
    if !(spacing > 0.0 && spacing.is_finite()) {
        return refuse(spacing, "above 0 and finite");
    }
    let counts = lengths.map(|length| (length / spacing).round().max(1.0));
    let places = counts[0] * counts[1];
    if !(places.is_finite() && places <= MOST_LUX_PLACES as f64) {
        return refuse(spacing, "so large that there are at most 4 million places");
    }
    Ok(counts.map(|count| count as u32))
}

/// Illuminance on a grid, in lux.
#[derive(Clone, Debug, PartialEq)]
pub struct LuxReport {
    /// Where.
    pub grid: LuxGrid,
    /// Row by row; `None` for places that do not count, such as those in bodies.
    pub values: Vec<Option<f64>>,
}

impl LuxReport {
    /// Measures all places of the grid. `light` tells the light at a place, as shown, or `None` where it
    /// does not count; a shown 1 stands for `luminance_of_one` cd/m².
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn measure(
        grid: &LuxGrid,
        luminance_of_one: f64,
        control: &Control<'_>,
        light: impl Fn(DVec3, DVec3) -> Option<LinearRgb> + Sync,
    ) -> Result<Self, Cancelled> {
        let [columns, rows] = grid.size;
        let lux = std::f64::consts::PI * luminance_of_one;
        let mut values = Vec::with_capacity(columns as usize * rows as usize);
        for row in 0..rows {
            control.check()?;
            let value = |column: u32| {
                light(grid.place(column, row), grid.normal).map(|light| f64::from(light.luminance()) * lux)
            };
            values.par_extend((0..columns).into_par_iter().map(value));
            control.report((row + 1) as f32 / rows as f32);
        }
        Ok(Self { grid: *grid, values })
    }

    /// Values of the places that count.
    fn measured(&self) -> impl Iterator<Item = f64> + '_ {
        self.values.iter().copied().flatten()
    }

    /// Places that do not count.
    #[must_use]
    pub fn left_out(&self) -> usize {
        self.values.iter().filter(|value| value.is_none()).count()
    }

    /// The least value; 0 where nothing counts.
    #[must_use]
    pub fn least(&self) -> f64 {
        self.measured().reduce(f64::min).unwrap_or(0.0)
    }

    /// The largest value.
    #[must_use]
    pub fn most(&self) -> f64 {
        self.measured().fold(0.0, f64::max)
    }

    /// The mean of all places that count.
    #[must_use]
    pub fn mean(&self) -> f64 {
        self.measured().sum::<f64>() / (self.values.len() - self.left_out()).max(1) as f64
    }

    /// Uniformity Uo, the least value as a share of the mean (EN 12464-1); 0 where it is dark.
    #[must_use]
    pub fn uniformity(&self) -> f64 {
        let mean = self.mean();
        if mean > 0.0 { self.least() / mean } else { 0.0 }
    }

    /// A line `x,y,z,lux` for each place, row by row, below a head; `lux` is empty where a place does not
    /// count.
    #[must_use]
    pub fn to_csv(&self) -> String {
        use std::fmt::Write;
        let mut text = String::from("x,y,z,lux\n");
        let [columns, _] = self.grid.size;
        for (i, value) in self.values.iter().enumerate() {
            let (column, row) = (i as u32 % columns.max(1), i as u32 / columns.max(1));
            let DVec3 { x, y, z } = self.grid.place(column, row);
            // Writing to a string cannot fail.
            let _ = match value {
                Some(value) => writeln!(text, "{x:.4},{y:.4},{z:.4},{value:.4}"),
                None => writeln!(text, "{x:.4},{y:.4},{z:.4},"),
            };
        }
        text
    }

    /// The grid in false colours, with their scale: columns to the right, rows downwards, each place a
    /// square, the longer side about `longest` pixels. Places that do not count are grey.
    #[must_use]
    pub fn to_image(&self, colors: &FalseColors, longest: u32) -> Image {
        let [columns, rows] = self.grid.size;
        let side = (longest / columns.max(rows).max(1)).max(1);
        let mut image = Image::new(columns * side, rows * side, [0.0; 4]);
        for y in 0..rows * side {
            for x in 0..columns * side {
                let value = self.values[(y / side * columns + x / side) as usize];
                let LinearRgb { r, g, b } = value.map_or(LEFT_OUT, |value| colors.of_value(value));
                image.set_pixel(x, y, [r, g, b, 1.0]);
            }
        }
        with_scale(&image, colors, "lux")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid() -> LuxGrid {
        let bounds = Aabb::of_points([DVec3::new(-2.0, 0.0, 0.0), DVec3::new(2.0, 3.0, 1.0)]);
        LuxGrid::horizontal(&bounds, 0.75, 0.5).expect("a grid")
    }

    #[test]
    fn places_are_half_a_step_from_the_border() {
        let grid = grid();
        assert_eq!(grid.size, [8, 2]);
        assert_eq!(grid.place(0, 0), DVec3::new(-1.75, 0.75, 0.25));
        assert_eq!(grid.place(7, 1), DVec3::new(1.75, 0.75, 0.75));
        let bounds = Aabb::of_points([DVec3::ZERO, DVec3::ONE]);
        for spacing in [0.0, -1.0, f64::NAN, 1e-9] {
            assert!(LuxGrid::horizontal(&bounds, 0.0, spacing).is_err(), "{spacing}");
        }
        assert_eq!(LuxGrid::horizontal(&bounds, 0.0, 50.0).map(|g| g.size), Ok([1, 1]));
    }

    #[test]
    fn numbers_are_those_of_photometry() {
        let light = |place: DVec3, _: DVec3| Some(LinearRgb::splat((place.x + 2.0) as f32));
        let report = LuxReport::measure(&grid(), 100.0, &Control::default(), light).expect("numbers");
        let lux = 100.0 * std::f64::consts::PI;
        assert!((report.mean() - 2.0 * lux).abs() < 1e-4);
        assert!((report.least() - 0.25 * lux).abs() < 1e-4 && (report.most() - 3.75 * lux).abs() < 1e-4);
        assert!((report.uniformity() - 0.125).abs() < 1e-7);
        let csv = report.to_csv();
        assert_eq!(csv.lines().count(), 17);
        assert_eq!(csv.lines().nth(1), Some("-1.7500,0.7500,0.2500,78.5398"));
        let image = report.to_image(&FalseColors { unit: 1.0, most: 2000.0, logarithmic: false }, 80);
        assert_eq!(image.height(), 20);
        // Places in a body take no part in anything.
        let half = |place: DVec3, normal: DVec3| light(place, normal).filter(|_| place.x > 0.0);
        let report = LuxReport::measure(&grid(), 100.0, &Control::default(), half).expect("numbers");
        assert_eq!(report.left_out(), 8);
        assert!((report.mean() - 3.0 * lux).abs() < 1e-4 && (report.least() - 2.25 * lux).abs() < 1e-4);
        assert_eq!(report.to_csv().lines().nth(1), Some("-1.7500,0.7500,0.2500,"));
        let none = LuxReport::measure(&grid(), 1.0, &Control::default(), |_, _| None).expect("no numbers");
        assert_eq!([none.mean(), none.least(), none.most(), none.uniformity()], [0.0; 4]);
    }

    #[test]
    fn rectangles_stand_anywhere() {
        let edges = [DVec3::new(0.0, 2.0, 0.0), DVec3::new(0.0, 0.0, 1.0)];
        let wall = LuxGrid::rectangle(DVec3::new(3.0, 0.0, 0.0), edges, 0.5).expect("a grid");
        assert_eq!((wall.size, wall.normal), ([4, 2], DVec3::X));
        assert_eq!(wall.place(3, 1), DVec3::new(3.0, 1.75, 0.75));
        for edges in [[DVec3::X, DVec3::ONE], [DVec3::X, DVec3::ZERO], [DVec3::X, DVec3::NAN]] {
            assert!(LuxGrid::rectangle(DVec3::ZERO, edges, 0.5).is_err(), "{edges:?}");
        }
    }
}
