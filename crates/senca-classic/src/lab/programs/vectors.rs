//! Exercise 1 as a program: the vectors of the first task, and its matrix at work.

use senca_window::{Canvas, Event, Flow, Program};

use super::told;
use crate::lab::draw::{self, Sheet};
use crate::lab::space::{Orbit, Stage, block_corners};
use crate::lab::vectors::{
    FirstTask, Matrix, Row3, add, cosine, dot, normalized, scale, subtract, vector_projection,
};

/// Points on the arc of an angle.
const ARC: u32 = 24;

/// What a part of the picture shows.
#[derive(Clone, Copy, Debug)]
enum Part {
    Sum,
    Shadow,
    Product,
    Move,
}

impl Part {
    const ALL: [Self; 4] = [Self::Sum, Self::Shadow, Self::Product, Self::Move];

    /// Points that have to be seen.
    fn points(self, task: &FirstTask) -> Vec<Row3> {
        match self {
            Self::Sum => vec![[0.0; 3], FirstTask::SUMMANDS[0], FirstTask::SUMMANDS[1], task.v1],
            Self::Shadow => vec![[0.0; 3], task.v1, FirstTask::OTHER],
            Self::Product => {
                vec![task.v1, FirstTask::FACTOR, add(task.v1, FirstTask::FACTOR), task.v2, task.v4]
            }
            Self::Move => block().into_iter().chain(block().map(moved)).collect(),
        }
    }

    fn draw(self, task: &FirstTask, stage: &mut Stage<'_>) {
        match self {
            Self::Sum => draw_sum(task, stage),
            Self::Shadow => draw_shadow(task, stage),
            Self::Product => draw_product(task, stage),
            Self::Move => draw_move(task, stage),
        }
    }
}

/// The first task in four parts: the sum as a parallelogram; the scalar product as the shadow of one
/// vector on the other, with the angle between them; the vector product upright on the parallelogram
/// whose area is its length; and the homogeneous point moved by the matrix, in a box that goes with it.
///
/// Dragging, or the arrow keys, turn space.
#[derive(Clone, Debug)]
pub struct VectorsProgram {
    task: FirstTask,
    orbit: Orbit,
}

impl VectorsProgram {
    /// The first task with its constants.
    #[must_use]
    pub fn new() -> Self {
        Self { task: FirstTask::compute(), orbit: Orbit::START }
    }
}

impl Default for VectorsProgram {
    fn default() -> Self {
        Self::new()
    }
}

impl Program for VectorsProgram {
    fn title(&self) -> String {
        let FirstTask { v1, s, v2, v, .. } = self.task;
        let moved = told([v[0], v[1], v[2]]);
        format!("v1 = {}, s = {s}, v2 = {}, V = {moved}", told(v1), told(v2))
    }

    fn size(&self) -> (usize, usize) {
        (480, 480)
    }

    fn event(&mut self, event: Event) -> Flow {
        self.orbit.event(event)
    }

    fn draw(&mut self, canvas: &mut Canvas) {
        canvas.fill(draw::WHITE);
        let (width, height) = (canvas.width() / 2, canvas.height() / 2);
        for (i, part) in Part::ALL.into_iter().enumerate() {
            let points = part.points(&self.task).into_iter().map(|p| self.orbit.flat(p));
            let points: Vec<_> = points.collect();
            let place = [(i % 2 * width) as f64, (i / 2 * height) as f64];
            let sheet = Sheet::around(&points, (width, height)).moved(place[0], place[1]);
            let mut stage = Stage { canvas, orbit: self.orbit, sheet };
            axes(&mut stage, 0.16 * width.min(height) as f64 / sheet.scale);
            part.draw(&self.task, &mut stage);
        }
        let [w, h] = [width as f64, height as f64];
        draw::line(canvas, [w, 0.0], [w, 2.0 * h], draw::GREY);
        draw::line(canvas, [0.0, h], [2.0 * w, h], draw::GREY);
    }
}

fn axes(stage: &mut Stage<'_>, length: f64) {
    for k in 0..3 {
        let mut end = [0.0; 3];
        end[k] = length;
        stage.arrow([0.0; 3], end, draw::GREY);
    }
}

fn draw_sum(task: &FirstTask, stage: &mut Stage<'_>) {
    let [a, b] = FirstTask::SUMMANDS;
    stage.area(&[[0.0; 3], a, task.v1, b], draw::YELLOW, 0.3);
    stage.line(a, task.v1, draw::GREY);
    stage.line(b, task.v1, draw::GREY);
    stage.arrow([0.0; 3], a, draw::RED);
    stage.arrow([0.0; 3], b, draw::BLUE);
    stage.arrow([0.0; 3], task.v1, draw::BLACK);
}

fn draw_shadow(task: &FirstTask, stage: &mut Stage<'_>) {
    let (a, b) = (task.v1, FirstTask::OTHER);
    let corners = arc(a, b, 0.3 * dot(b, b).sqrt());
    stage.area(&corners, draw::YELLOW, 0.0);
    stage.outline(&corners, draw::GREY);
    let shadow = vector_projection(a, b).unwrap_or([0.0; 3]);
    stage.line(a, shadow, draw::GREY);
    stage.thick_line([0.0; 3], shadow, 0xf0_a0a0);
    stage.arrow([0.0; 3], b, draw::BLUE);
    stage.arrow([0.0; 3], a, draw::BLACK);
}

/// The sector between two vectors: its tip, and points of its arc from `a` to `b`.
fn arc(a: Row3, b: Row3, radius: f64) -> Vec<Row3> {
    let (Some(first), Some(cosine)) = (normalized(a), cosine(a, b)) else { return Vec::new() };
    let aside = subtract(b, scale(first, dot(b, first)));
    let Some(second) = normalized(aside) else { return Vec::new() };
    let at = |i: u32| {
        let (sin, cos) = (cosine.acos() * f64::from(i) / f64::from(ARC)).sin_cos();
        add(scale(first, radius * cos), scale(second, radius * sin))
    };
    std::iter::once([0.0; 3]).chain((0..=ARC).map(at)).collect()
}

fn draw_product(task: &FirstTask, stage: &mut Stage<'_>) {
    let (a, b) = (task.v1, FirstTask::FACTOR);
    stage.arrow([0.0; 3], task.v4, draw::GREY);
    stage.area(&[[0.0; 3], a, add(a, b), b], draw::YELLOW, 0.3);
    stage.outline(&[[0.0; 3], a, add(a, b), b], draw::GREY);
    stage.arrow([0.0; 3], b, draw::BLUE);
    stage.arrow([0.0; 3], a, draw::BLACK);
    stage.arrow([0.0; 3], task.v2, draw::GREEN);
    stage.thick_line([0.0; 3], task.v3, draw::RED);
}

/// Moves a point by the task's matrix.
fn moved([x, y, z]: Row3) -> Row3 {
    let [x, y, z, h] = Matrix::transform(&FirstTask::MOVE, [x, y, z, 1.0]);
    [x / h, y / h, z / h]
}

/// The box between the origin and the point.
fn block() -> [Row3; 8] {
    let [x, y, z, _] = FirstTask::POINT;
    block_corners([0.0; 3], [x, y, z])
}

fn draw_move(task: &FirstTask, stage: &mut Stage<'_>) {
    let block = block();
    block.into_iter().for_each(|corner| stage.line(corner, moved(corner), 0xe4_e4e4));
    stage.block(block[0], block[7], draw::BLUE);
    stage.block(moved(block[0]), moved(block[7]), draw::RED);
    let [x, y, z, _] = task.v;
    stage.arrow(block[7], [x, y, z], draw::BLACK);
    for (point, color) in [(block[7], draw::BLUE), ([x, y, z], draw::RED)] {
        let pixel = stage.pixel(point);
        draw::dot(stage.canvas, pixel, 3, color);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::vectors::length;

    #[test]
    fn the_arc_goes_from_one_to_the_other() {
        let (a, b) = (FirstTask::compute().v1, FirstTask::OTHER);
        let arc = arc(a, b, 2.0);
        assert_eq!(arc.len(), ARC as usize + 2);
        let along = |v: Row3, w: Row3| cosine(v, w).expect("both have a length");
        assert!((along(arc[1], a) - 1.0).abs() < 1e-12 && (along(arc[25], b) - 1.0).abs() < 1e-12);
        assert!(arc[1..].iter().all(|&p| (length(p) - 2.0).abs() < 1e-12));
    }

    #[test]
    fn the_box_goes_with_its_point() {
        let [x, y, z, _] = FirstTask::compute().v;
        assert_eq!(moved(block()[7]), [x, y, z]);
        assert_eq!(moved([0.0; 3]), [2.0, 3.0, 3.0]);
    }
}
