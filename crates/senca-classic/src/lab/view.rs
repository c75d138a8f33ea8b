//! Exercise 5: the view transform, both ways, and perspective.
//!
//! The scene is right-handed. In the eye's system x points right, y up and z along the gaze, which is
//! left-handed; z is the depth. Points are rows.

use super::LabError;
use super::input::Input;
use super::vectors::{Matrix, Row3, cross, length, normalized, subtract};

/// How the axes of the eye are found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ViewMethod {
    /// From the gaze and a vector that points up; gives the left-handed system at once.
    #[default]
    Axes,
    /// The same with the T_Z of (5.15) after it, which turns z over once more: what lies before the eye
    /// then has negative depth, and the picture is turned by 180 degrees.
    AxesWithFlip,
    /// By rotations about the axes of the scene; up is the scene's z.
    Rotations,
}

/// The transform T from the scene to the eye.
#[derive(Clone, Debug, PartialEq)]
pub struct ViewTransform {
    /// The partial matrices with their names, in order.
    pub steps: Vec<(&'static str, Matrix<4>)>,
    /// Their product.
    pub matrix: Matrix<4>,
    /// H, the distance from the eye to the point it looks at (5.22).
    pub distance: f64,
    /// Whether depth is -z, because of T_Z.
    pub flipped: bool,
}

/// A point in the picture plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projected {
    /// To the right, in units of the scene.
    pub x: f64,
    /// Up, in units of the scene.
    pub y: f64,
    /// zo, as the transform gives it.
    pub z: f64,
}

/// Share of H before which things are not drawn.
const NEAR: f64 = 1e-3;

impl ViewTransform {
    /// The transform by one of the methods; `up` is used by those with axes.
    ///
    /// # Errors
    /// The eye is where it looks at, or it looks along `up`; for the method of rotations, along z.
    pub fn new(method: ViewMethod, eye: Row3, target: Row3, up: Row3) -> Result<Self, LabError> {
        match method {
            ViewMethod::Axes => Self::by_axes(eye, target, up, false),
            ViewMethod::AxesWithFlip => Self::by_axes(eye, target, up, true),
            ViewMethod::Rotations => Self::by_rotations(eye, target),
        }
    }

    /// First method: the axes of the eye as columns (5.8)-(5.15).
    ///
    /// (5.11) is printed as a unit vector, but z x up has the length of the sine between them, so it is
    /// normalized here; without that the picture is smaller.
    fn by_axes(eye: Row3, target: Row3, up: Row3, flipped: bool) -> Result<Self, LabError> {
        let [x, y, z] = axes(eye, target, up)?;
        let rotation = Matrix([
            [x[0], y[0], z[0], 0.0],
            [x[1], y[1], z[1], 0.0],
            [x[2], y[2], z[2], 0.0],
            [0.0, 0.0, 0.0, 1.0],
        ]);
        let mut steps = vec![("T1", translation(eye)), ("R", rotation)];
        if flipped {
            steps.push(("TZ", diagonal([1.0, 1.0, -1.0])));
        }
        Ok(Self::of(steps, eye, target, flipped))
    }

    /// Second method: rotations about z and y, then a change of the axes (5.16)-(5.20). Sine and cosine
    /// of the second angle are printed in each other's place.
    fn by_rotations(eye: Row3, target: Row3) -> Result<Self, LabError> {
        let g1 = gaze(eye, target)?;
        let across = g1[0].hypot(g1[1]);
        if across <= 1e-12 * length(g1) {
            return Err(LabError::degenerate(
                "the eye looks along the z axis, where the method of rotations has no angle; \
                 use the method of axes with another direction up",
            ));
        }
        let (sa, ca) = (g1[1] / across, g1[0] / across);
        let h = length(g1);
        let (sb, cb) = (across / h, g1[2] / h);
        let t2 = [[ca, -sa, 0.0, 0.0], [sa, ca, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
        let t3 = [[cb, 0.0, sb, 0.0], [0.0, 1.0, 0.0, 0.0], [-sb, 0.0, cb, 0.0], [0.0, 0.0, 0.0, 1.0]];
        let t4 = [[0.0, -1.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
        let steps = vec![
            ("T1", translation(eye)),
            ("T2", Matrix(t2)),
            ("T3", Matrix(t3)),
            ("T4", Matrix(t4)),
            ("T5", diagonal([-1.0, 1.0, 1.0])),
        ];
        Ok(Self::of(steps, eye, target, false))
    }

    fn of(steps: Vec<(&'static str, Matrix<4>)>, eye: Row3, target: Row3, flipped: bool) -> Self {
        let matrix = steps.iter().fold(Matrix::IDENTITY, |product, (_, step)| product.multiply(step));
        Self { steps, matrix, distance: length(subtract(target, eye)), flipped }
    }

    /// A point of the scene in the system of the eye.
    #[must_use]
    pub fn eye_from_scene(&self, [x, y, z]: Row3) -> Row3 {
        let [x, y, z, _] = self.matrix.transform([x, y, z, 1.0]);
        [x, y, z]
    }

    /// The matrix P (5.24): (xo, yo, 0, zo / H) after it, to be divided by the last.
    #[must_use]
    pub fn perspective(&self) -> Matrix<4> {
        let mut p = Matrix::IDENTITY;
        p.0[2] = [0.0, 0.0, 0.0, 1.0 / self.distance];
        p.0[3] = [0.0; 4];
        p
    }

    /// A point of the scene in the picture plane (5.23), wherever it lies; `None` in the plane of the
    /// eye, where zo = 0. Points behind the eye come out mirrored.
    #[must_use]
    pub fn project(&self, point: Row3) -> Option<Projected> {
        self.project_eye(self.eye_from_scene(point))
    }

    /// The same for a point in the system of the eye.
    #[must_use]
    pub fn project_eye(&self, [x, y, z]: Row3) -> Option<Projected> {
        let [x, y, _, h] = self.perspective().transform([x, y, z, 1.0]);
        (h != 0.0).then(|| Projected { x: x / h, y: y / h, z })
    }

    /// Distance before the eye of a point in the eye's system.
    #[must_use]
    pub fn depth(&self, point_eye: Row3) -> f64 {
        if self.flipped { -point_eye[2] } else { point_eye[2] }
    }

    /// The picture of a line of the scene, cut where it comes too near to the eye.
    #[must_use]
    pub fn project_line(&self, start: Row3, end: Row3) -> Option<[[f64; 2]; 2]> {
        let corners = self.project_polygon(&[(start, 0.0), (end, 0.0)]);
        match corners[..] {
            [(a, _), .., (b, _)] => Some([a, b]),
            _ => None,
        }
    }

    /// The picture of a polygon of the scene with a value at each corner, cut where it comes too near
    /// to the eye.
    #[must_use]
    pub fn project_polygon(&self, corners: &[(Row3, f64)]) -> Vec<([f64; 2], f64)> {
        let near = NEAR * self.distance;
        let eye: Vec<_> = corners.iter().map(|&(p, v)| (self.eye_from_scene(p), v)).collect();
        let inside = |p: Row3| self.depth(p) - near;
        let mut kept: Vec<(Row3, f64)> = Vec::new();
        for (i, &(p, v)) in eye.iter().enumerate() {
            let (q, w) = eye[(i + 1) % eye.len()];
            let (dp, dq) = (inside(p), inside(q));
            if dp >= 0.0 {
                kept.push((p, v));
            }
            if (dp < 0.0) != (dq < 0.0) {
                let t = dp / (dp - dq);
                kept.push((std::array::from_fn(|k| p[k] + (q[k] - p[k]) * t), v + (w - v) * t));
            }
        }
        let flat = |(p, v): (Row3, f64)| self.project_eye(p).map(|p| ([p.x, p.y], v));
        kept.into_iter().filter_map(flat).collect()
    }
}

fn gaze(eye: Row3, target: Row3) -> Result<Row3, LabError> {
    let gaze = subtract(target, eye);
    if !(length(gaze) > 0.0 && length(gaze).is_finite()) {
        return Err(LabError::degenerate("the eye is at the point it looks at, so it looks nowhere"));
    }
    Ok(gaze)
}

/// The axes x, y and z of the eye (5.8)-(5.12).
fn axes(eye: Row3, target: Row3, up: Row3) -> Result<[Row3; 3], LabError> {
    let gaze = gaze(eye, target)?;
    let collinear =
        || LabError::degenerate("the direction up is 0 or that of the gaze, so it does not tell where up is");
    let z = normalized(gaze).ok_or_else(collinear)?;
    let up = normalized(up).ok_or_else(collinear)?;
    let x = cross(z, up);
    if length(x) <= 1e-12 {
        return Err(collinear());
    }
    let x = normalized(x).ok_or_else(collinear)?;
    Ok([x, cross(x, z), z])
}

/// Moves the eye to the origin (5.2).
fn translation([x, y, z]: Row3) -> Matrix<4> {
    let mut matrix = Matrix::IDENTITY;
    matrix.0[3] = [-x, -y, -z, 1.0];
    matrix
}

fn diagonal([x, y, z]: [f64; 3]) -> Matrix<4> {
    Matrix([[x, 0.0, 0.0, 0.0], [0.0, y, 0.0, 0.0], [0.0, 0.0, z, 0.0], [0.0, 0.0, 0.0, 1.0]])
}

/// What the exercise reads from a text: lines `O x y z` (the eye), `G x y z` (what it looks at; the
/// origin when left out), `up x y z` (0 1 0 when left out), and `v x y z` for the vertices of a polygon.
#[derive(Clone, Debug, PartialEq)]
pub struct ViewScene {
    /// The eye.
    pub eye: Row3,
    /// What it looks at.
    pub target: Row3,
    /// Direction up.
    pub up: Row3,
    /// Corners of the polygon.
    pub polygon: Vec<Row3>,
}

impl Default for ViewScene {
    /// The eye at (1, 1, 3), as the manual proposes, looking at the origin.
    fn default() -> Self {
        Self { eye: [1.0, 1.0, 3.0], target: [0.0; 3], up: [0.0, 1.0, 0.0], polygon: Vec::new() }
    }
}

impl ViewScene {
    /// Reads the text.
    ///
    /// # Errors
    /// A line is none of these, or the eye is missing.
    pub fn read(input: &mut Input) -> Result<Self, LabError> {
        let mut scene = Self::default();
        let mut eye = None;
        while input.left() > 0 {
            match input.word("a line")? {
                "O" => eye = Some(input.numbers("the eye O")?),
                "G" => scene.target = input.numbers("the point G")?,
                "up" => scene.up = input.numbers("the direction up")?,
                "v" => scene.polygon.push(input.numbers("a vertex")?),
                other => {
                    let message = format!("a line begins with O, G, up or v, but not with '{other}'");
                    return Err(input.wrong(message));
                }
            }
        }
        scene.eye = eye.ok_or_else(|| input.wrong("there is no line 'O x y z' with the eye"))?;
        Ok(scene)
    }
}

#[cfg(test)]
mod tests;
