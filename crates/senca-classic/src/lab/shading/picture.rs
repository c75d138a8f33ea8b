//! A solid in perspective, as wires or shaded.

use senca_window::Canvas;

use super::{Light, Overflow, displayed, view_values};
use crate::lab::LabError;
use crate::lab::draw::{self, Sheet};
use crate::lab::solid::Solid;
use crate::lab::vectors::{Row3, length, subtract};
use crate::lab::view::{ViewMethod, ViewTransform};

/// How a solid is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// All edges.
    Wire,
    /// Edges of the faces that are seen from their front.
    #[default]
    WireFront,
    /// One intensity for each face.
    Constant,
    /// An intensity at each vertex, interpolated.
    Gouraud,
}

/// Who looks, and where.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The eye.
    pub eye: Row3,
    /// What it looks at.
    pub target: Row3,
    /// Direction up.
    pub up: Row3,
    /// How the view transform is made.
    pub method: ViewMethod,
}

impl Default for Camera {
    fn default() -> Self {
        Self { eye: [3.0, 2.0, 4.0], target: [0.0; 3], up: [0.0, 1.0, 0.0], method: ViewMethod::Axes }
    }
}

impl Camera {
    /// The view transform.
    ///
    /// # Errors
    /// As [`ViewTransform::new`].
    pub fn transform(&self) -> Result<ViewTransform, LabError> {
        ViewTransform::new(self.method, self.eye, self.target, self.up)
    }
}

/// A solid with its light, and how it is drawn.
#[derive(Clone, Debug)]
pub struct SolidPicture<'a> {
    /// The solid.
    pub solid: &'a Solid,
    /// Its light.
    pub light: Light,
    /// How it is drawn.
    pub mode: Mode,
    /// Half of the height that is seen at the distance of the target.
    pub half_height: f64,
}

impl SolidPicture<'_> {
    /// Draws onto `canvas` within the rectangle of a sheet.
    ///
    /// # Errors
    /// As [`ViewTransform::new`].
    pub fn draw(&self, canvas: &mut Canvas, camera: &Camera) -> Result<(), LabError> {
        let size = (canvas.width(), canvas.height());
        let half = self.half_height;
        let sheet = Sheet::fitting([-half, -half], [half, half], size);
        self.draw_on(canvas, camera, &sheet)
    }

    /// Draws onto the part of `canvas` that `sheet` shows.
    ///
    /// # Errors
    /// As [`ViewTransform::new`].
    pub fn draw_on(&self, canvas: &mut Canvas, camera: &Camera, sheet: &Sheet) -> Result<(), LabError> {
        let view = camera.transform()?;
        if self.mode == Mode::Wire {
            let vertices = &self.solid.vertices;
            for [a, b] in self.solid.edges() {
                if let Some([p, q]) = view.project_line(vertices[a], vertices[b]) {
                    draw::line(canvas, sheet.pixel(p), sheet.pixel(q), draw::WHITE);
                }
            }
            return Ok(());
        }
        let per_face = displayed(&self.light.face_intensities(self.solid), Overflow::Clamp);
        let per_vertex = displayed(&self.light.vertex_intensities(self.solid), Overflow::Clamp);
        for face in self.front_faces_from_afar(camera.eye) {
            let corner = |&v: &usize| {
                let intensity = if self.mode == Mode::Gouraud { per_vertex[v] } else { per_face[face] };
                (self.solid.vertices[v], intensity)
            };
            let corners: Vec<_> = self.solid.faces[face].iter().map(corner).collect();
            let corners: Vec<_> =
                view.project_polygon(&corners).into_iter().map(|(p, i)| (sheet.pixel(p), i)).collect();
            self.draw_face(canvas, &corners);
        }
        Ok(())
    }

    fn draw_face(&self, canvas: &mut Canvas, corners: &[([f64; 2], f64)]) {
        if self.mode == Mode::WireFront {
            let places: Vec<_> = corners.iter().map(|c| c.0).collect();
            draw::outline(canvas, &places, draw::WHITE);
            return;
        }
        for i in 2..corners.len() {
            let triangle = [corners[0], corners[i - 1], corners[i]];
            draw::triangle(canvas, triangle.map(|c| c.0), triangle.map(|c| tinted(c.1)));
        }
    }

    /// Faces seen from their front, the farthest first: so that concave solids come out nearly right,
    /// too, for which leaving out back faces is not enough.
    fn front_faces_from_afar(&self, eye: Row3) -> Vec<usize> {
        let values = view_values(self.solid, eye);
        let mut faces: Vec<usize> = (0..values.len()).filter(|&i| values[i] > 0.0).collect();
        let distance = |&i: &usize| length(subtract(self.solid.center_of(&self.solid.faces[i]), eye));
        faces.sort_by(|a, b| distance(b).total_cmp(&distance(a)));
        faces
    }
}

/// The component that the exercise computes is red; the others follow at a distance, so that dark
/// faces keep their colour.
fn tinted(intensity: f64) -> [f64; 3] {
    [intensity, 0.62 * intensity, 0.3 * intensity]
}
