//! Exercise 1 as a program: three equations as three planes.

use senca_window::{Canvas, Event, Flow, Program};

use crate::lab::draw::{self, Sheet};
use crate::lab::space::{Orbit, Piece, Stage, block_corners, cut, far_to_near};
use crate::lab::vectors::{Row3, Row4, Solution, add, cross, dot, scale, solve_system, subtract};

/// Colours of the planes, by the number of their equation.
const COLORS: [u32; 3] = [0xf0_b0b0, 0xb0_e0b8, 0xb0_c4f0];

/// Three equations as planes within a box, cut where they meet: the solution is the black point, the
/// red line or the area with a red border that all have in common. Planes that contradict each other
/// have nothing in red. Equations whose coefficients are all 0 have no plane.
///
/// Dragging, or the arrow keys, turn space.
#[derive(Clone, Debug)]
pub struct SystemProgram {
    planes: [Option<Row4>; 3],
    solution: Solution,
    center: Row3,
    half: f64,
    orbit: Orbit,
}

impl SystemProgram {
    /// Three equations, each its coefficients of x, y and z and its right side.
    #[must_use]
    pub fn new(equations: &[[f64; 4]; 3]) -> Self {
        let planes = equations.map(unit_plane);
        let solution = solve_system(equations);
        let center = common_point(&planes, solution);
        let half = half_size(&planes, center);
        Self { planes, solution, center, half, orbit: Orbit::START }
    }

    fn corner(&self, sign: f64) -> Row3 {
        self.center.map(|v| v + sign * self.half)
    }

    /// The part of a plane within the box.
    fn piece(&self, which: usize) -> Option<Piece> {
        let plane = self.planes[which]?;
        let normal = [plane[0], plane[1], plane[2]];
        let foot = subtract(self.center, scale(normal, dot(normal, self.center) - plane[3]));
        let [u, v] = in_plane(normal).map(|way| scale(way, 4.0 * self.half));
        let corner = |a: f64, b: f64| add(foot, add(scale(u, a), scale(v, b)));
        let all = vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
        let corners = self.sides().into_iter().fold(all, |corners, side| cut(&corners, side));
        (corners.len() > 2).then_some(Piece { corners, plane, which })
    }

    /// The planes of the box, with their insides where their values are not negative.
    fn sides(&self) -> [Row4; 6] {
        let (low, high) = (self.corner(-1.0), self.corner(1.0));
        std::array::from_fn(|i| {
            let mut side = [0.0; 4];
            let (k, upper) = (i / 2, i % 2 == 1);
            side[k] = if upper { -1.0 } else { 1.0 };
            side[3] = if upper { -high[k] } else { low[k] };
            side
        })
    }

    /// The ends of the line of solutions within the box.
    fn line(&self) -> Option<[Row3; 2]> {
        let along = line_direction(&self.planes)?;
        let reach = scale(along, 4.0 * self.half);
        let ends = [subtract(self.center, reach), add(self.center, reach)];
        let kept = self.sides().into_iter().fold(ends.to_vec(), |ends, side| cut_line(&ends, side));
        <[Row3; 2]>::try_from(kept).ok()
    }

    fn draw_solution(&self, stage: &mut Stage<'_>) {
        match self.solution {
            Solution::One(point) => {
                let pixel = stage.pixel(point);
                draw::dot(stage.canvas, pixel, 4, draw::BLACK);
            }
            Solution::Line => {
                if let Some([start, end]) = self.line() {
                    stage.thick_line(start, end, draw::RED);
                }
            }
            Solution::Plane => {
                let piece = (0..3).find_map(|i| self.piece(i));
                let corners = piece.map_or_else(Vec::new, |piece| piece.corners);
                for (i, &corner) in corners.iter().enumerate() {
                    stage.thick_line(corner, corners[(i + 1) % corners.len()], draw::RED);
                }
            }
            Solution::Space => stage.block(self.corner(-1.0), self.corner(1.0), draw::RED),
            Solution::None => {}
        }
    }
}

impl Program for SystemProgram {
    fn title(&self) -> String {
        match self.solution {
            Solution::One(point) => format!("[x y z] = {}", super::told(point)),
            Solution::Line => "All points of a line".to_owned(),
            Solution::Plane => "All points of a plane".to_owned(),
            Solution::Space => "All points".to_owned(),
            Solution::None => "No point: the equations contradict each other".to_owned(),
        }
    }

    fn size(&self) -> (usize, usize) {
        (400, 400)
    }

    fn event(&mut self, event: Event) -> Flow {
        self.orbit.event(event)
    }

    fn draw(&mut self, canvas: &mut Canvas) {
        canvas.fill(draw::WHITE);
        let (low, high) = (self.corner(-1.0), self.corner(1.0));
        let flat = block_corners(low, high).map(|p| self.orbit.flat(p));
        let sheet = Sheet::around(&flat, (canvas.width(), canvas.height()));
        let mut stage = Stage { canvas, orbit: self.orbit, sheet };
        stage.block(low, high, draw::GREY);
        draw_axes(&mut stage, low, high);
        let to_eye = self.orbit.to_eye();
        let pieces = (0..3).filter_map(|i| self.piece(i)).collect();
        for Piece { corners, plane, which } in far_to_near(pieces, to_eye, self.half) {
            let light = 0.72 + 0.28 * dot([plane[0], plane[1], plane[2]], to_eye).abs();
            let color = draw::rgb(draw::channels(COLORS[which]).map(|c| c * light));
            stage.area(&corners, color, 0.2);
            stage.outline(&corners, 0x80_8080);
        }
        self.draw_solution(&mut stage);
    }
}

/// The axes, as far as they are in the box.
fn draw_axes(stage: &mut Stage<'_>, low: Row3, high: Row3) {
    for k in 0..3 {
        let is_within = (0..3).all(|j| j == k || (low[j]..=high[j]).contains(&0.0));
        if is_within && high[k] > 0.0 {
            let (mut start, mut end) = ([0.0; 3], [0.0; 3]);
            (start[k], end[k]) = (low[k].max(0.0), high[k]);
            stage.arrow(start, end, draw::BLACK);
        }
    }
}

/// The plane of an equation with a normal of length 1 and its distance from the origin.
fn unit_plane([x, y, z, right]: [f64; 4]) -> Option<Row4> {
    let largest = x.abs().max(y.abs()).max(z.abs());
    if largest == 0.0 {
        return None;
    }
    let [x, y, z, right] = [x, y, z, right].map(|v| v / largest);
    let length = dot([x, y, z], [x, y, z]).sqrt();
    Some([x, y, z, right].map(|v| v / length)).filter(|plane| plane.iter().all(|v| v.is_finite()))
}

fn normal_of([a, b, c, _]: Row4) -> Row3 {
    [a, b, c]
}

/// Two directions of length 1, upright on each other and on `normal`.
fn in_plane(normal: Row3) -> [Row3; 2] {
    let least = (0..3).min_by(|&i, &j| normal[i].abs().total_cmp(&normal[j].abs())).unwrap_or(0);
    let mut axis = [0.0; 3];
    axis[least] = 1.0;
    let u = cross(normal, axis);
    let u = scale(u, 1.0 / dot(u, u).sqrt());
    [u, cross(normal, u)]
}

/// The two planes that are least parallel, and the vector product of their normals.
fn most_crossing(planes: &[Option<Row4>; 3]) -> Option<(Row4, Row4, Row3)> {
    let pairs = [(0, 1), (0, 2), (1, 2)].into_iter().filter_map(|(i, j)| {
        let (p, q) = (planes[i]?, planes[j]?);
        Some((p, q, cross(normal_of(p), normal_of(q))))
    });
    pairs.max_by(|a, b| dot(a.2, a.2).total_cmp(&dot(b.2, b.2)))
}

fn line_direction(planes: &[Option<Row4>; 3]) -> Option<Row3> {
    let (.., along) = most_crossing(planes)?;
    let length = dot(along, along).sqrt();
    (length > 0.0).then(|| scale(along, 1.0 / length))
}

/// The solution, or the one nearest to the origin; where there is none, the middle of the points of the
/// planes that are nearest to the origin.
fn common_point(planes: &[Option<Row4>; 3], solution: Solution) -> Row3 {
    match (solution, most_crossing(planes)) {
        (Solution::One(point), _) if point.iter().all(|v| v.is_finite()) => return point,
        (Solution::Line, Some((p, q, along))) if dot(along, along) > 0.0 => {
            let (m, n) = (normal_of(p), normal_of(q));
            let sum = add(scale(cross(n, along), p[3]), scale(cross(along, m), q[3]));
            return scale(sum, 1.0 / dot(along, along));
        }
        _ => {}
    }
    let feet: Vec<Row3> = planes.iter().flatten().map(|&p| scale(normal_of(p), p[3])).collect();
    let sum = feet.iter().fold([0.0; 3], |sum, &foot| add(sum, foot));
    scale(sum, 1.0 / feet.len().max(1) as f64)
}

/// Half a side of the box: it holds the origin, and a part of each plane.
fn half_size(planes: &[Option<Row4>; 3], center: Row3) -> f64 {
    let origin = center.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    let off = planes.iter().flatten().map(|&p| (dot(normal_of(p), center) - p[3]).abs());
    let half = off.fold(1.25 * origin, |half, off| half.max(1.5 * off));
    if half > 1e-12 && half.is_finite() { half } else { 1.0 }
}

/// The part of a line from `ends[0]` to `ends[1]` where the plane's value is not negative.
fn cut_line(ends: &[Row3], plane: Row4) -> Vec<Row3> {
    let &[start, end] = ends else { return Vec::new() };
    let values = [start, end].map(|p| dot(normal_of(plane), p) - plane[3]);
    let at = || add(start, scale(subtract(end, start), values[0] / (values[0] - values[1])));
    match values.map(|v| v >= 0.0) {
        [true, true] => vec![start, end],
        [true, false] => vec![start, at()],
        [false, true] => vec![at(), end],
        [false, false] => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(equations: [[f64; 4]; 3]) -> SystemProgram {
        SystemProgram::new(&equations)
    }

    fn is_on(program: &SystemProgram, which: usize, point: Row3) -> bool {
        let plane = program.planes[which].expect("a plane");
        (dot(normal_of(plane), point) - plane[3]).abs() < 1e-12 * program.half
    }

    const MANUAL: [[f64; 4]; 3] = [[1.0, 1.0, 1.0, 6.0], [-1.0, -2.0, 1.0, -2.0], [2.0, 1.0, 3.0, 13.0]];

    #[test]
    fn three_planes_meet_in_the_solution() {
        let mut program = of(MANUAL);
        assert_eq!(
            (program.center, program.title().as_str()),
            ([1.0, 2.0, 3.0], "[x y z] = (1.00, 2.00, 3.00)")
        );
        for which in 0..3 {
            let piece = program.piece(which).expect("goes through the box");
            assert!(is_on(&program, which, program.center));
            let inside = |p: &Row3| (0..3).all(|k| (p[k] - program.center[k]).abs() <= program.half + 1e-9);
            assert!(piece.corners.iter().all(|p| is_on(&program, which, *p) && inside(p)), "{piece:?}");
        }
        let mut canvas = Canvas::new(400, 400);
        program.draw(&mut canvas);
        let black = canvas.pixels().iter().filter(|&&p| p == draw::BLACK).count();
        assert!(black > 81, "the point and the axes");
        assert_eq!(canvas.get(200, 200), Some(draw::BLACK), "the solution is in the middle");
    }

    #[test]
    fn a_line_of_solutions_lies_in_all_planes() {
        let program = of([[1.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, 2.0], [1.0, 1.0, 0.0, 3.0]]);
        let [start, end] = program.line().expect("a line");
        for which in 0..3 {
            assert!(is_on(&program, which, start) && is_on(&program, which, end));
        }
        assert!((end[2] - start[2]).abs() > 1.9 * program.half, "from side to side");
    }

    #[test]
    fn every_kind_of_system_has_its_picture() {
        let (x, z) = ([1.0, 0.0, 0.0, 1.0], [0.0; 4]);
        let red = |equations: [[f64; 4]; 3]| {
            let mut canvas = Canvas::new(200, 200);
            of(equations).draw(&mut canvas);
            let of = |color: u32| canvas.pixels().iter().filter(|&&p| p == color).count();
            assert!(of(draw::WHITE) < 40_000, "something is drawn");
            of(draw::RED)
        };
        assert!(red([x, [0.0, 1.0, 0.0, 2.0], [1.0, 1.0, 0.0, 3.0]]) > 100, "line");
        assert!(red([x, [2.0, 0.0, 0.0, 2.0], z]) > 300, "plane");
        assert!(red([z, z, z]) > 300, "space");
        assert_eq!(red([x, [2.0, 0.0, 0.0, 3.0], [0.0, 1.0, 0.0, 2.0]]), 0, "none");
        assert_eq!(red([z, z, [0.0, 0.0, 0.0, 1.0]]), 0, "none, and no plane");
        assert_eq!(red(MANUAL), 0);
        for extreme in [1e308, 1e-308, -1e300] {
            red([[extreme, 1.0, 0.0, 1.0], [0.0, extreme, 1.0, extreme], [1.0, 0.0, extreme, -extreme]]);
        }
    }
}
