//! The half cube: form factors of one patch to all others by five pictures of patch numbers (course
//! text, section 4.2, equations 4.10 to 4.13; Cohen and Greenberg 1985).
//!
//! 1. A half cube of half-edge 1 stands on the patch. Its top and its four sides are divided in cells,
//!    and the form factor of each cell is worked out once.
//! 2. All patches are drawn on the five faces, seen from a point of the patch, by a rasterizer that
//!    keeps depth and the number of the nearest patch for each cell.
//! 3. The factor to a patch is the sum of the factors of the cells that hold its number.
//!
//! A patch that is not small for its surroundings is divided, and the factors of the parts averaged
//! (equation 4.15). Obstacles smaller than a cell come out as chance has it.

use senca_math::conventions::NO_ID;
use senca_math::glam::{DMat3, DQuat, DVec3, Vec4};
use senca_math::newell_normal;
use senca_raster::{
    Clear, Compare, DepthBias, Ids, Primitives, Rasterizer, Shading, State, Target, TargetError,
    TiledRasterizer, TiledSettings,
};

use super::cells::cells;
use super::clip::{Corners, part_above};
use super::point_to_polygon;
use crate::{PatchPolygon, RadiosityError};

/// What a cell counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CellFactor {
    /// Equations 4.11 and 4.12, taken at the middle of the cell: their sum is a little above 1.
    Middle,
    /// The factor to the cell as a square, by Lambert's formula: the sum is 1. The default.
    #[default]
    Exact,
}

/// The half cube: resolution, and the factor of each cell.
#[derive(Clone, Debug, PartialEq)]
pub struct Hemicube {
    resolution: u32,
    /// Row 0 is at y = 1.
    top: Vec<f64>,
    /// Row 0 is at z = 1; the same for all four sides.
    side: Vec<f64>,
}

/// Smallest and largest number of cells along an edge.
const RESOLUTIONS: std::ops::RangeInclusive<u32> = 2..=4096;

impl Hemicube {
    /// A half cube with `resolution` cells along an edge of the top and half as many up its sides: an even
    /// number from 2 to 4096. The text has 20 to 100.
    ///
    /// # Errors
    /// [`RadiosityError::Setting`].
    pub fn new(resolution: u32, factor: CellFactor) -> Result<Self, RadiosityError> {
        if !RESOLUTIONS.contains(&resolution) || resolution % 2 == 1 {
            let expected = "an even number from 2 to 4096";
            return Err(RadiosityError::Setting {
                name: "resolution",
                value: f64::from(resolution),
                expected,
            });
        }
        let n = resolution as usize;
        let step = 2.0 / f64::from(resolution);
        let middle = |k: usize| (k as f64 + 0.5) * step;
        let at = |k: usize| (middle(k % n) - 1.0, 1.0 - middle(k / n));
        let top = (0..n * n).map(|k| top_factor(at(k), step, factor)).collect();
        let side = (0..n * n / 2).map(|k| side_factor(at(k), step, factor)).collect();
        Ok(Self { resolution, top, side })
    }

    /// Cells along an edge of the top.
    #[must_use]
    pub fn resolution(&self) -> u32 {
        self.resolution
    }

    /// Number of cells of all five faces: 3 N^2.
    #[must_use]
    pub fn cell_count(&self) -> usize {
        self.top.len() + 4 * self.side.len()
    }

    /// Factors of the cells of the top, N x N, row 0 at y = 1, column 0 at x = -1.
    #[must_use]
    pub fn top(&self) -> &[f64] {
        &self.top
    }

    /// Factors of the cells of one side, N x N/2, row 0 at z = 1.
    #[must_use]
    pub fn side(&self) -> &[f64] {
        &self.side
    }

    /// Sum of the factors of all cells: 1, or what the resolution makes of it.
    #[must_use]
    pub fn sum(&self) -> f64 {
        self.top.iter().sum::<f64>() + 4.0 * self.side.iter().sum::<f64>()
    }
}

/// Factor of the cell of the top round (x, y, 1): equation 4.11.
fn top_factor((x, y): (f64, f64), step: f64, factor: CellFactor) -> f64 {
    match factor {
        CellFactor::Middle => step * step / (std::f64::consts::PI * (x * x + y * y + 1.0).powi(2)),
        CellFactor::Exact => square_factor(DVec3::new(x, y, 1.0), DVec3::Y, DVec3::X, step),
    }
}

/// Factor of the cell of the side x = 1 round (1, y, z): equation 4.12.
fn side_factor((y, z): (f64, f64), step: f64, factor: CellFactor) -> f64 {
    match factor {
        CellFactor::Middle => z * step * step / (std::f64::consts::PI * (y * y + z * z + 1.0).powi(2)),
        CellFactor::Exact => square_factor(DVec3::new(1.0, y, z), DVec3::Z, DVec3::Y, step),
    }
}

fn square_factor(middle: DVec3, u: DVec3, v: DVec3, side: f64) -> f64 {
    let at = |a: f64, b: f64| middle + (u * a + v * b) * (0.5 * side);
    point_to_polygon(DVec3::ZERO, DVec3::Z, &[at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)])
}

/// The five faces, each with the axes that are right, up and ahead on it, in the frame of the patch
/// (x and y along it, z its normal). The top comes first.
const FACES: [[DVec3; 3]; 5] = [
    [DVec3::X, DVec3::Y, DVec3::Z],
    [DVec3::NEG_Y, DVec3::Z, DVec3::X],
    [DVec3::X, DVec3::Z, DVec3::Y],
    [DVec3::Y, DVec3::Z, DVec3::NEG_X],
    [DVec3::NEG_X, DVec3::Z, DVec3::NEG_Y],
];

/// What stands nearer than this is not seen, as a share of the square root of the seeing area.
const NEAREST: f64 = 1e-6;
/// Backs are drawn farther away by what depth changes over a cell, so that of the two sides of a sheet the
/// front is seen.
const SHEET: DepthBias = DepthBias { constant: 0.0, slope: -1.0 };

/// Each part's half cube is turned on by this against the last, in radians: an edge that is parallel to cells
/// gains or loses a whole row of them, which then averages out. A right angle by the golden ratio.
const TURN: f64 = std::f64::consts::FRAC_PI_2 * 0.618_033_988_749_895;

/// A half cube with a rasterizer and the item buffer it draws into. Keep one per thread and use it often.
#[derive(Debug)]
pub struct HemicubeView<'h, R = TiledRasterizer> {
    hemicube: &'h Hemicube,
    rasterizer: R,
    depth: Vec<f32>,
    items: Vec<u32>,
    /// Patches that reach above the plane, in the frame of the one that sees.
    seen: Vec<SeenPatch>,
    /// Triangles on the face that is drawn: those that show their front, and their patches.
    fronts: Vec<u32>,
    ids: Vec<u32>,
    /// Those that show their back.
    backs: Vec<u32>,
    positions: Vec<Vec4>,
}

/// A patch in the frame of the one that sees it.
#[derive(Debug)]
struct SeenPatch {
    corners: Corners,
    /// Its number, or none where it shows its back.
    id: u32,
}

impl<'h> HemicubeView<'h> {
    /// With the fast rasterizer, on the calling thread.
    #[must_use]
    pub fn new(hemicube: &'h Hemicube) -> Self {
        let settings = TiledSettings { threads: 1, ..TiledSettings::default() };
        Self::with_rasterizer(hemicube, TiledRasterizer::new(settings))
    }
}

impl<'h, R: Rasterizer> HemicubeView<'h, R> {
    /// With any rasterizer.
    #[must_use]
    pub fn with_rasterizer(hemicube: &'h Hemicube, rasterizer: R) -> Self {
        let cells = hemicube.top.len();
        Self {
            hemicube,
            rasterizer,
            depth: vec![0.0; cells],
            items: vec![NO_ID; cells],
            seen: Vec::new(),
            fronts: Vec::new(),
            ids: Vec::new(),
            backs: Vec::new(),
            positions: Vec::new(),
        }
    }

    /// Factors of the polygon `from` to each of `patches`, obstacles among them heeded: `from` is
    /// divided in about `parts` x `parts`, 1 or more, and a half cube put on each. Only fronts take light; backs
    /// block it. What lies in the plane of `from`, itself included, takes nothing.
    ///
    /// All 0 for a polygon without area.
    #[must_use]
    pub fn factors(&mut self, from: &[DVec3], parts: usize, patches: &[PatchPolygon]) -> Vec<f64> {
        let mut factors = vec![0.0; patches.len()];
        let Some(normal) = newell_normal(from).try_normalize() else { return factors };
        let cells = cells(from, parts);
        let area: f64 = cells.iter().map(|c| c.area).sum();
        let (tangent, _) = normal.any_orthonormal_pair();
        for (k, cell) in cells.iter().enumerate().filter(|(_, c)| c.area > 0.0 && c.area.is_finite()) {
            let nearest = NEAREST * cell.area.sqrt();
            let tangent = DQuat::from_axis_angle(normal, TURN * k as f64) * tangent;
            let frame = [tangent, normal.cross(tangent), normal];
            self.look(cell.point, frame, nearest, patches, |id, share| {
                factors[id as usize] += share * (cell.area / area);
            });
        }
        factors
    }

    /// Draws the five faces and tells for each cell that is not empty which patch it shows and what it counts.
    fn look(
        &mut self,
        eye: DVec3,
        frame: [DVec3; 3],
        nearest: f64,
        patches: &[PatchPolygon],
        mut count: impl FnMut(u32, f64),
    ) {
        self.place(eye, frame, patches);
        for (face, axes) in FACES.iter().enumerate() {
            let factors = if face == 0 { &self.hemicube.top } else { &self.hemicube.side };
            if self.draw_face(face, axes, nearest).is_err() {
                return;
            }
            for (&id, &factor) in self.items.iter().zip(factors) {
                if id != NO_ID {
                    count(id, factor);
                }
            }
        }
    }

    /// Takes patches that reach above the plane into the frame of the eye.
    fn place(&mut self, eye: DVec3, [tangent, bitangent, normal]: [DVec3; 3], patches: &[PatchPolygon]) {
        let local_from_world = DMat3::from_cols(tangent, bitangent, normal).transpose();
        self.seen.clear();
        for (id, patch) in (0..).zip(patches) {
            let corners = patch.corners();
            if corners.iter().any(|&p| normal.dot(p - eye) > 0.0) {
                let front = newell_normal(corners).dot(eye - corners[0]) > 0.0;
                let corners = corners.iter().map(|&p| local_from_world * (p - eye)).collect();
                self.seen.push(SeenPatch { corners, id: if front { id } else { NO_ID } });
            }
        }
    }

    /// Draws what is seen through a face. All is cut to the pyramid of the face first, in double
    /// precision: then depth, which is the nearest distance along the axis by that of the place, has as
    /// many digits as there can be.
    fn draw_face(&mut self, face: usize, axes: &[DVec3; 3], nearest: f64) -> Result<(), TargetError> {
        let n = self.hemicube.resolution;
        let rows = if face == 0 { n } else { n / 2 };
        self.cut_to_pyramid(face, axes, nearest);
        let cells = (n * rows) as usize;
        let mut target =
            Target::new(n, rows)?.with_depth(&mut self.depth[..cells])?.with_ids(&mut self.items[..cells])?;
        let clear = Clear { color: None, depth: Some(0.0), id: Some(NO_ID), stencil: None };
        let state = State { depth_test: Compare::Greater, clear: Some(clear), ..State::default() };
        let (positions, varyings, stride) = (&self.positions[..], &[][..], 0);
        let fronts =
            Primitives { positions, varyings, stride, indices: &self.fronts, ids: Ids::Each(&self.ids) };
        self.rasterizer.draw(&mut target, &fronts, &state, &Shading::None);
        if !self.backs.is_empty() {
            let state = State { clear: None, depth_bias: SHEET, ..state };
            let backs = Primitives { indices: &self.backs, ids: Ids::Same(NO_ID), ..fronts };
            self.rasterizer.draw(&mut target, &backs, &state, &Shading::None);
        }
        Ok(())
    }

    fn cut_to_pyramid(&mut self, face: usize, &[right, up, ahead]: &[DVec3; 3], nearest: f64) {
        self.positions.clear();
        self.fronts.clear();
        self.ids.clear();
        self.backs.clear();
        // Of the sides only the upper half is there.
        let lower = if face == 0 { ahead + up } else { up };
        let planes = [ahead + right, ahead - right, ahead - up, lower];
        let mut least = f64::INFINITY;
        for patch in &self.seen {
            if planes.iter().any(|plane| patch.corners.iter().all(|p| plane.dot(*p) <= 0.0)) {
                continue;
            }
            let cut = |part: Corners, plane: &DVec3| part_above(&part, 0.0, |p| plane.dot(p));
            let part = planes.iter().fold(patch.corners.clone(), cut);
            let first = self.positions.len() as u32;
            for corner in &part {
                let w = ahead.dot(*corner);
                let y = if face == 0 { up.dot(*corner) } else { 2.0 * up.dot(*corner) - w };
                self.positions.push(Vec4::new(right.dot(*corner) as f32, y as f32, 1.0, w as f32));
                least = least.min(w);
            }
            for corner in 2..part.len() as u32 {
                let triangle = [first, first + corner - 1, first + corner];
                if patch.id == NO_ID {
                    self.backs.extend(triangle);
                } else {
                    self.fronts.extend(triangle);
                    self.ids.push(patch.id);
                }
            }
        }
        let least = least.max(nearest) as f32;
        self.positions.iter_mut().for_each(|p| p.z *= least);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use senca_raster::ScanlineRasterizer;

    fn text(n: u32) -> Hemicube {
        Hemicube::new(n, CellFactor::Middle).expect("even")
    }

    #[test]
    fn the_cells_have_the_sums_of_the_text() {
        let known =
            [(10, 1.005_460_350_3), (20, 1.001_357_415_1), (50, 1.000_216_849_2), (100, 1.000_054_200_3)];
        for (n, sum) in known {
            assert!((text(n).sum() - sum).abs() < 1e-10, "{n}: {}", text(n).sum());
        }
        assert_eq!([20, 50, 100].map(|n| text(n).cell_count()), [1200, 7500, 30_000]);
    }

    #[test]
    fn exact_cells_add_up_to_the_faces_and_to_one() {
        for n in [2, 20, 50] {
            let cube = Hemicube::new(n, CellFactor::Exact).expect("even");
            assert!((cube.sum() - 1.0).abs() < 1e-12);
            assert!((cube.top().iter().sum::<f64>() - 0.554_126_424_0).abs() < 1e-10);
            assert!((cube.side().iter().sum::<f64>() - 0.111_468_394_0).abs() < 1e-10);
        }
    }

    #[test]
    fn single_cells_have_their_known_factors() {
        let cube = text(20);
        // Columns and rows from the middle outwards.
        let (top, side) = (
            |x: usize, y: usize| cube.top()[(9 - y) * 20 + 10 + x],
            |y: usize, z: usize| cube.side()[(9 - z) * 20 + 10 + y],
        );
        let close = |a: f64, b: f64| (a / b - 1.0).abs() < 3e-9;
        assert!(close(top(0, 0), 0.003_151_505_02), "{}", top(0, 0));
        assert!(close(top(9, 9), 0.000_404_561_356), "{}", top(9, 9));
        assert!(close(side(0, 0), 0.000_157_575_251), "{}", side(0, 0));
        assert!(close(side(0, 9), 0.000_833_266_213), "{}", side(0, 9));
        assert!(close(side(9, 9), 0.000_384_333_288), "{}", side(9, 9));
    }

    #[test]
    fn resolutions_out_of_range_are_refused() {
        for n in [0, 1, 21, 5000] {
            assert!(
                matches!(Hemicube::new(n, CellFactor::Exact), Err(RadiosityError::Setting { .. })),
                "{n}"
            );
        }
    }

    fn square(z: f64, half: f64, up: bool) -> PatchPolygon {
        let turn = if up { 1.0 } else { -1.0 };
        let at = |x: f64, y: f64| DVec3::new(x * half, y * half * turn, z);
        PatchPolygon::quad([at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)])
    }

    /// A patch so small that its division does not matter.
    fn spot() -> PatchPolygon {
        square(0.0, 1e-4, true)
    }

    fn of_square(n: u32) -> f64 {
        let cube = text(n);
        HemicubeView::new(&cube).factors(spot().corners(), 1, &[square(1.0, 0.5, false)])[0]
    }

    #[test]
    fn a_square_above_counts_the_cells_of_the_text() {
        assert!((of_square(20) - 0.239_913_272_8).abs() < 1e-10, "{}", of_square(20));
        assert!((of_square(100) - 0.239_474_698_1).abs() < 1e-10, "{}", of_square(100));
    }

    /// With 50 cells, centres of cells lie on the border of the square: 26 x 26 touch it, 24 x 24 lie inside,
    /// and 25 x 25 count by the rule of the rasterizers, which gives the border of two sides to the square.
    #[test]
    fn cells_on_the_border_count_on_two_sides_of_four() {
        let cube = text(50);
        let middle = |from: usize, to: usize| -> f64 {
            (from..to).map(|y| cube.top()[50 * y + from..50 * y + to].iter().sum::<f64>()).sum()
        };
        assert!((middle(12, 38) - 0.253_986_211_76).abs() < 1e-10, "{}", middle(12, 38));
        assert!((middle(13, 37) - 0.225_087_825_41).abs() < 1e-10, "{}", middle(13, 37));
        assert!((middle(12, 37) - 0.239_310_664_89).abs() < 1e-10, "{}", middle(12, 37));
        assert!((of_square(50) - middle(12, 37)).abs() < 1e-10, "{}", of_square(50));
    }

    fn room() -> Vec<PatchPolygon> {
        let box_at = |c: DVec3, h: f64, inside: f64| {
            FACES.iter().map(|f| f[2]).chain([DVec3::NEG_Z]).map(move |n| {
                let (u, v) = n.any_orthonormal_pair();
                let at = |a: f64, b: f64| c + (n + u * a - v * b * inside) * h;
                PatchPolygon::quad([at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)])
            })
        };
        box_at(DVec3::ZERO, 1.0, 1.0).chain(box_at(DVec3::new(0.2, -0.1, -0.3), 0.3, -1.0)).collect()
    }

    #[test]
    fn the_plain_rasterizer_gives_the_same_factors() {
        let (cube, patches) = (text(64), room());
        let mut tiled = HemicubeView::new(&cube);
        let mut plain = HemicubeView::with_rasterizer(&cube, ScanlineRasterizer);
        for from in &patches {
            let row = tiled.factors(from.corners(), 2, &patches);
            assert_eq!(row, plain.factors(from.corners(), 2, &patches));
            assert!(row.iter().sum::<f64>() <= 1.0 + 2e-4);
        }
    }

    #[test]
    fn a_room_with_a_box_is_closed() {
        let cube = Hemicube::new(100, CellFactor::Exact).expect("even");
        let patches = room();
        let mut view = HemicubeView::new(&cube);
        for (k, from) in patches.iter().enumerate() {
            let row = view.factors(from.corners(), 1, &patches);
            assert!((row.iter().sum::<f64>() - 1.0).abs() < 1e-12, "{k}: {}", row.iter().sum::<f64>());
            assert_eq!(row[k], 0.0);
        }
    }

    #[test]
    fn apart_from_edges_the_half_cube_is_within_a_percent() {
        let cube = text(100);
        let mut view = HemicubeView::new(&cube);
        for k in 0..20 {
            let k = f64::from(k);
            let shift = DVec3::new((k * 1.3).sin(), (k * 0.7).cos(), 1.0 + 0.3 * (k * 2.1).sin());
            let to = PatchPolygon::quad(
                [[0.5, 0.5], [0.5, -0.5], [-0.5, -0.5], [-0.5, 0.5]]
                    .map(|[x, y]| DVec3::new(x, y, 0.1 * x) + shift),
            );
            let from = square(0.0, 0.2, true);
            let exact = super::super::polygon_to_polygon(from.corners(), to.corners());
            let cells = view.factors(from.corners(), 3, &[to])[0];
            assert!((cells / exact - 1.0).abs() < 0.01, "{k}: {cells} {exact}");
        }
    }

    #[test]
    fn the_half_cube_and_the_hemisphere_agree() {
        // Course text, task 4.7: the same solid angle gets the same power.
        let cube = text(200);
        let (spot, to) = (spot(), square(1.0, 0.7, false));
        let on_cube = HemicubeView::new(&cube).factors(spot.corners(), 1, &[to])[0];
        let on_sphere = super::super::nusselt_area(DVec3::ZERO, DVec3::Z, to.corners(), 500);
        assert!((on_cube - on_sphere).abs() < 2e-3, "{on_cube} {on_sphere}");
    }

    #[test]
    fn obstacles_backs_and_sheets() {
        let cube = text(50);
        let mut view = HemicubeView::new(&cube);
        let (ceiling, shade) = (square(1.0, 0.5, false), square(0.5, 1.0, true));
        assert_eq!(view.factors(spot().corners(), 1, &[ceiling, shade]), [0.0, 0.0]);
        let sheet = view.factors(spot().corners(), 1, &[shade, square(0.5, 1.0, false)]);
        assert_eq!(sheet[0], 0.0);
        assert!(sheet[1] > 0.5);
        let flat = PatchPolygon::triangle([DVec3::ZERO; 3]);
        assert_eq!(view.factors(flat.corners(), 1, &[ceiling]), [0.0]);
        let nan = PatchPolygon::triangle([DVec3::NAN; 3]);
        assert_eq!(view.factors(spot().corners(), 1, &[nan]), [0.0]);
        assert!(view.factors(spot().corners(), 1, &[]).is_empty());
    }
}
