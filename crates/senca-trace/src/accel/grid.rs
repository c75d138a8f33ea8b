//! A uniform grid: space is divided by planes into equal cells, each with a list of what reaches into it.
//!
//! A ray visits cell after cell and tests only what is listed there (course text, section 3.3; the step
//! from cell to cell is that of Amanatides and Woo 1987). What the text leaves open:
//!
//! - A ray that starts outside enters where it meets the grid's box.
//! - A hit ends the search only when it lies in the cells visited so far. A large element is listed in
//!   near cells though the ray may meet it far away, behind something that only a later cell lists.
//! - An element listed in several cells is tested once for each ray. It is listed in a block of cells,
//!   and a ray, which never turns back along an axis, visits cells of a block one after the other: so
//!   the element has been tested already if and only if the cell before was in its block too. No marks
//!   have to be kept for that.

use std::ops::Range;

use senca_math::Aabb;
use senca_math::glam::DVec3;

use crate::world::{Hit, Object};
use crate::{Counters, Ray};

use super::elements::{Element, Elements};
use super::search::{Blockers, Nearest};
use super::{Accelerator, Slabs};

/// Most cells along an axis.
pub(super) const MOST_CELLS: u32 = 256;
/// Cells for each element, when their number is chosen here.
const CELLS_PER_ELEMENT: f64 = 2.0;
/// Entries in lists for each element, on average, beyond which cells are made larger.
const ENTRIES_PER_ELEMENT: usize = 64;
/// Share of a cell by which elements are listed beyond their boxes: more than rounding moves a ray.
const SLACK: f64 = 1e-7;

/// Numbers of a cell along the axes.
type Cell = [u32; 3];

/// The block of cells that an element is listed in, both ends included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Block {
    first: [u16; 3],
    last: [u16; 3],
}

impl Block {
    #[inline]
    fn contains(&self, cell: Cell) -> bool {
        (0..3).all(|a| cell[a] >= u32::from(self.first[a]) && cell[a] <= u32::from(self.last[a]))
    }

    fn size(&self) -> usize {
        (0..3).map(|a| usize::from(self.last[a] - self.first[a]) + 1).product()
    }

    fn cells(&self) -> impl Iterator<Item = Cell> {
        let along = |a: usize| u32::from(self.first[a])..=u32::from(self.last[a]);
        let [xs, ys, zs] = [along(0), along(1), along(2)];
        zs.flat_map(move |z| {
            let xs = xs.clone();
            ys.clone().flat_map(move |y| xs.clone().map(move |x| [x, y, z]))
        })
    }
}

/// A uniform grid over the elements of all objects.
#[derive(Debug)]
pub struct Grid {
    bounds: Aabb,
    /// Cells along the axes.
    counts: Cell,
    /// Edge lengths of a cell.
    cell: DVec3,
    /// Where the list of each cell begins in `lists`, x fastest, and the end of the last one.
    starts: Vec<u32>,
    lists: Vec<u32>,
    elements: Vec<Element>,
    blocks: Vec<Block>,
    endless: Vec<u32>,
}

impl Grid {
    /// Over all parts of `objects`, with `cells` along every axis, from 1 to 256, or as many as suit the
    /// number of parts. There may be fewer where large parts would make the lists too long.
    #[must_use]
    pub fn new(objects: &[Object<'_>], cells: Option<u32>) -> Self {
        let Elements { list, boxes, endless } = Elements::of_parts(objects);
        let bounds = boxes.iter().fold(Aabb::EMPTY, |all, b| all.union(*b));
        let counts = match cells {
            Some(n) => [n.clamp(1, MOST_CELLS); 3],
            None => suitable_counts(bounds.size(), list.len()),
        };
        let mut grid = Self {
            bounds,
            counts,
            cell: DVec3::ONE,
            starts: Vec::new(),
            lists: Vec::new(),
            elements: list,
            blocks: Vec::new(),
            endless,
        };
        grid.find_blocks(&boxes);
        let most = ENTRIES_PER_ELEMENT * boxes.len() + (1 << 16);
        while grid.blocks.iter().map(Block::size).sum::<usize>() > most && grid.counts != [1; 3] {
            grid.counts = grid.counts.map(|n| n.div_ceil(2));
            grid.find_blocks(&boxes);
        }
        grid.fill_lists();
        grid
    }

    /// Cells along the axes.
    #[must_use]
    pub fn counts(&self) -> [u32; 3] {
        self.counts
    }

    /// The cells that a ray goes through, in order.
    #[must_use]
    pub fn cells_along(&self, ray: &Ray) -> Vec<[u32; 3]> {
        let mut cells = Vec::new();
        self.walk(ray, |step| {
            cells.push(step.cell);
            step.leaves_at < ray.t_max
        });
        cells
    }

    fn find_blocks(&mut self, boxes: &[Aabb]) {
        let size = self.bounds.size();
        let counts = DVec3::from(self.counts.map(f64::from));
        self.cell = DVec3::select(size.cmpgt(DVec3::ZERO), size / counts, DVec3::ONE);
        let block = |b: &Aabb| Block {
            first: self.cell_at(b.min - SLACK * self.cell).map(|i| i as u16),
            last: self.cell_at(b.max + SLACK * self.cell).map(|i| i as u16),
        };
        self.blocks = boxes.iter().map(block).collect();
    }

    /// Two passes: how long is each list, then what is in it.
    fn fill_lists(&mut self) {
        let cells: usize = self.counts.iter().map(|&n| n as usize).product();
        let mut ends = vec![0u32; cells + 1];
        for cell in self.blocks.iter().flat_map(Block::cells) {
            ends[self.index(cell)] += 1;
        }
        let mut sum = 0;
        for end in &mut ends {
            sum += *end;
            *end = sum;
        }
        // Filled from behind, ends become starts.
        self.lists = vec![0; sum as usize];
        for (element, block) in self.blocks.iter().enumerate().rev() {
            for cell in block.cells() {
                let index = self.index(cell);
                ends[index] -= 1;
                self.lists[ends[index] as usize] = element as u32;
            }
        }
        self.starts = ends;
    }

    /// The cell that holds a place, or the one nearest to it.
    fn cell_at(&self, place: DVec3) -> Cell {
        let at = (place - self.bounds.min) / self.cell;
        // The conversion takes what is below 0, or NaN, to 0.
        [0, 1, 2].map(|a| (at[a] as u32).min(self.counts[a] - 1))
    }

    #[inline]
    fn index(&self, [x, y, z]: Cell) -> usize {
        let [nx, ny, _] = self.counts.map(|n| n as usize);
        (z as usize * ny + y as usize) * nx + x as usize
    }

    #[inline]
    fn list(&self, cell: Cell) -> &[u32] {
        let index = self.index(cell);
        let range: Range<u32> = self.starts[index]..self.starts[index + 1];
        &self.lists[range.start as usize..range.end as usize]
    }

    /// Visits the cells along the ray until `visit` says no.
    #[inline]
    fn walk(&self, ray: &Ray, mut visit: impl FnMut(Step) -> bool) {
        let slabs = Slabs::new(ray);
        let Some((enter, _)) = slabs.interval(&self.bounds, ray.t_min, ray.t_max) else { return };
        let mut cell = self.cell_at(ray.at(enter));
        let reciprocal = ray.direction.recip();
        // The t at which the ray leaves the cell along each axis.
        let leaving = |axis: usize, cell: Cell| {
            if !reciprocal[axis].is_finite() {
                return f64::INFINITY;
            }
            let side = cell[axis] + u32::from(reciprocal[axis] > 0.0);
            let plane = self.bounds.min[axis] + f64::from(side) * self.cell[axis];
            (plane - ray.origin[axis]) * reciprocal[axis]
        };
        let mut next = [0, 1, 2].map(|axis| leaving(axis, cell));
        let mut before = None;
        loop {
            let axis = if next[0] <= next[1] && next[0] <= next[2] {
                0
            } else if next[1] <= next[2] {
                1
            } else {
                2
            };
            if !visit(Step { cell, before, leaves_at: next[axis] }) || next[axis] == f64::INFINITY {
                return;
            }
            before = Some(cell);
            let forward = reciprocal[axis] > 0.0;
            let is_last = if forward { cell[axis] + 1 == self.counts[axis] } else { cell[axis] == 0 };
            if is_last {
                return;
            }
            cell[axis] = if forward { cell[axis] + 1 } else { cell[axis] - 1 };
            next[axis] = leaving(axis, cell);
        }
    }

    /// Elements of a cell that the cells before did not list.
    #[inline]
    fn new_elements(&self, step: Step) -> impl Iterator<Item = Element> {
        let is_new = move |&element: &u32| {
            step.before.is_none_or(|before| !self.blocks[element as usize].contains(before))
        };
        self.list(step.cell).iter().copied().filter(is_new).map(|element| self.elements[element as usize])
    }
}

/// A cell on the way of a ray.
#[derive(Clone, Copy, Debug)]
struct Step {
    cell: Cell,
    before: Option<Cell>,
    leaves_at: f64,
}

/// Cells along the axes, as near to cubes as can be, about [`CELLS_PER_ELEMENT`] for each element.
fn suitable_counts(size: DVec3, elements: usize) -> Cell {
    let wanted = CELLS_PER_ELEMENT * elements.max(1) as f64;
    let mut divided = [0, 1, 2].map(|a| size[a] > 0.0);
    let mut counts = [1; 3];
    loop {
        let axes = (0..3).filter(|&a| divided[a]);
        let (dimensions, volume) = axes.fold((0, 1.0), |(n, volume), a| (n + 1, volume * size[a]));
        if dimensions == 0 {
            return counts;
        }
        let edge = (volume / wanted).powf(1.0 / f64::from(dimensions));
        // Axes that are shorter than a cell stay undivided and leave the cells to the others.
        if let Some(short) = (0..3).find(|&a| divided[a] && size[a] < edge) {
            divided[short] = false;
            continue;
        }
        for axis in (0..3).filter(|&a| divided[a]) {
            counts[axis] = ((size[axis] / edge).round() as u32).clamp(1, MOST_CELLS);
        }
        return counts;
    }
}

impl Accelerator for Grid {
    fn closest(&self, objects: &[Object<'_>], ray: &Ray, counters: &mut Counters) -> Option<Hit> {
        let mut nearest = Nearest::new(objects, ray);
        self.endless.iter().for_each(|&object| nearest.ask_parts(object, counters));
        let ray = nearest.ray;
        self.walk(&ray, |step| {
            counters.cells += 1;
            for Element { object, part } in self.new_elements(step) {
                nearest.ask_part(object, part, counters);
            }
            nearest.t_max() > step.leaves_at
        });
        nearest.hit
    }

    fn occluded(
        &self,
        objects: &[Object<'_>],
        ray: &Ray,
        counters: &mut Counters,
        blocks: &dyn Fn(&Hit) -> bool,
    ) -> bool {
        let mut blockers = Blockers::new(objects, ray, blocks);
        if self.endless.iter().any(|&object| blockers.parts_block(object, counters)) {
            return true;
        }
        let mut blocked = false;
        self.walk(ray, |step| {
            counters.cells += 1;
            blocked = self
                .new_elements(step)
                .any(|Element { object, part }| blockers.part_blocks(object, part, counters));
            !blocked && ray.t_max > step.leaves_at
        });
        blocked
    }

    fn memory_bytes(&self) -> usize {
        size_of_val(&*self.starts)
            + size_of_val(&*self.lists)
            + size_of_val(&*self.elements)
            + size_of_val(&*self.blocks)
            + size_of_val(&*self.endless)
    }
}

#[cfg(test)]
mod tests {
    use senca_math::glam::DMat4;
    use senca_scene::{Geometry, GeometryId, Node, Scene, Shape, Transform};

    use super::*;
    use crate::{Accel, AccelSettings, World, WorldSettings};

    fn at(place: DVec3) -> Transform {
        Transform::Matrix(DMat4::from_translation(place))
    }

    /// A box over [0, 4]^3 and whatever else.
    fn box_of_four() -> Scene {
        let mut scene = Scene::of_shape("box", Shape::Box { size: DVec3::splat(4.0) });
        scene.nodes[0].transform = at(DVec3::splat(2.0));
        scene
    }

    fn world(scene: &Scene, cells: u32) -> World<'_> {
        let accel = AccelSettings { grid_cells: Some(cells), ..Accel::Grid.into() };
        World::with_settings(scene, &WorldSettings { accel, ..WorldSettings::default() }).expect("a world")
    }

    #[test]
    fn a_ray_goes_through_the_cells_of_the_worked_example() {
        let scene = box_of_four();
        let grid = Grid::new(world(&scene, 4).objects(), Some(4));
        let ray = Ray::new(DVec3::splat(0.5), DVec3::new(1.0, 0.5, 0.0));
        let cells = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [2, 1, 0], [3, 1, 0], [3, 2, 0]];
        assert_eq!(grid.cells_along(&ray), cells);
        let from_outside = Ray::new(ray.at(-3.0), ray.direction);
        assert_eq!(grid.cells_along(&from_outside)[..], cells, "enters at (0, 0.25, 0.5)");
        let backwards = Ray::new(ray.at(10.0), -ray.direction);
        assert!(grid.cells_along(&backwards).iter().rev().eq(&cells));
        let away = Ray::new(DVec3::splat(5.0), ray.direction);
        assert!(grid.cells_along(&away).is_empty());
    }

    #[test]
    fn no_ray_goes_through_more_than_three_n_minus_two_cells() {
        let scene = box_of_four();
        for n in [1, 2, 4, 7] {
            let grid = Grid::new(world(&scene, n).objects(), Some(n));
            let mut most = 0;
            for i in 0..4000u32 {
                let turn = |k: u32| f64::from((i * k) % 4001) / 4001.0 * 4.0;
                let from = DVec3::new(turn(7), turn(91), -0.3);
                let to = DVec3::new(turn(577), turn(1201), 4.3);
                most = most.max(grid.cells_along(&Ray::new(from, to - from)).len() as u32);
            }
            assert!(most <= 3 * n - 2, "{most} cells for n = {n}");
            let diagonal = Ray::new(DVec3::new(-0.1, -0.101, -0.102), DVec3::ONE);
            assert_eq!(grid.cells_along(&diagonal).len() as u32, 3 * n - 2);
        }
    }

    #[test]
    fn tests_fall_from_m_to_m_over_n_squared() {
        // A thousand spheres, each in a cell of its own.
        let (n, radius) = (10, 0.3);
        let mut scene = Scene::of_shape("ball", Shape::Sphere { radius });
        scene.roots.clear();
        for i in 0..n * n * n {
            let place = DVec3::new(f64::from(i % n), f64::from(i / n % n), f64::from(i / n / n));
            let geometry = Some(GeometryId(0));
            let node = scene.add_node(Node { geometry, transform: at(place), ..Node::default() });
            scene.roots.push(node);
        }
        let tests = |kind: Accel, ray: &Ray| {
            let accel = AccelSettings { grid_cells: Some(10), ..kind.into() };
            let world = World::with_settings(&scene, &WorldSettings { accel, ..WorldSettings::default() });
            let mut counters = Counters::default();
            let hit = world.expect("a world").closest(ray, &mut counters);
            (counters.tests, counters.cells, hit.is_some())
        };
        let past_all = Ray::new(DVec3::new(-3.0, 4.4, 5.4), DVec3::X);
        assert_eq!(tests(Accel::None, &past_all), (1000, 0, false));
        assert_eq!(tests(Accel::Grid, &past_all), (10, 10, false), "M / n^2");
        let first = Ray::new(DVec3::new(-3.0, 4.1, 5.0), DVec3::X);
        assert_eq!(tests(Accel::Grid, &first), (1, 1, true));
    }

    #[test]
    fn a_hit_counts_only_within_the_cells_visited() {
        // A large slanted triangle is listed from the first cell on, but the ray meets it far away,
        // behind a small sphere that only a later cell lists.
        let p = senca_math::glam::Vec3::new;
        let slanted = vec![p(0.0, 0.0, 0.0), p(0.0, 4.0, 4.0), p(8.0, 0.0, 4.0)];
        let mut scene = Scene::of_shape("large", super::super::tests::triangles(slanted));
        let shape = Shape::Sphere { radius: 0.2 };
        let small = scene.add_geometry(Geometry { name: "small".to_owned(), shape, material: None });
        let transform = at(DVec3::new(2.5, 0.5, 1.5));
        let node = scene.add_node(Node { geometry: Some(small), transform, ..Node::default() });
        scene.roots.push(node);
        let world = world(&scene, 8);
        let ray = Ray::new(DVec3::new(-1.0, 0.5, 1.5), DVec3::X);
        let mut counters = Counters::default();
        let hit = world.closest(&ray, &mut counters).expect("a hit");
        assert_eq!(hit.object, 0, "the triangle stands before the sphere from here");
        let ray = Ray::new(DVec3::new(7.0, 0.5, 1.5), -DVec3::X);
        let mut counters = Counters::default();
        let hit = world.closest(&ray, &mut counters).expect("a hit");
        assert_eq!((hit.object, counters.tests), (1, 2), "each was tested once");
    }

    #[test]
    fn cells_suit_the_shape_of_the_scene() {
        assert_eq!(suitable_counts(DVec3::ONE, 500), [10, 10, 10]);
        assert_eq!(suitable_counts(DVec3::new(1.0, 0.0, 1.0), 50), [10, 1, 10]);
        assert_eq!(suitable_counts(DVec3::new(100.0, 1e-3, 1e-3), 50), [100, 1, 1]);
        assert_eq!(suitable_counts(DVec3::ZERO, 50), [1, 1, 1]);
        let all: u64 = suitable_counts(DVec3::ONE, 10_000_000).iter().map(|&n| u64::from(n)).product();
        assert!(all <= u64::from(MOST_CELLS).pow(3));
    }

    #[test]
    fn large_parts_do_not_fill_the_memory() {
        let mut scene = Scene::of_shape("box", Shape::Box { size: DVec3::splat(4.0) });
        scene.roots.clear();
        for i in 0..3000 {
            let transform = at(DVec3::splat(1e-4 * f64::from(i)));
            let geometry = Some(GeometryId(0));
            let node = scene.add_node(Node { geometry, transform, ..Node::default() });
            scene.roots.push(node);
        }
        let world = world(&scene, 256);
        assert!(world.memory_bytes() < 8 << 20, "{}", world.memory_bytes());
    }
}
