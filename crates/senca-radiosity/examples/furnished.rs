//! Solves furnished halls of growing numbers of polygons and tells what it costs.
//!
//! `furnished POLYGONS... [--threads N] [--threshold T] [--repeat N]`

use std::error::Error;
use std::time::Instant;

use senca_math::glam::{DMat3, DVec3};
use senca_math::{Control, LinearRgb};
use senca_radiosity::{DirectLight, ElementMesh, HierarchySettings, solve_hierarchy};

type Corners = Vec<DVec3>;

/// Polygons with their reflectance and emission.
#[derive(Default)]
struct Hall {
    polygons: Vec<(Corners, LinearRgb, LinearRgb)>,
}

const BLACK: LinearRgb = LinearRgb::BLACK;
const WOOD: LinearRgb = LinearRgb::new(0.5, 0.33, 0.2);
const STEEL: LinearRgb = LinearRgb::splat(0.3);
const RED: LinearRgb = LinearRgb::new(0.6, 0.1, 0.08);
const WALL: LinearRgb = LinearRgb::new(0.75, 0.73, 0.7);

/// Edge of the square that one set of furniture stands on, in metres.
const SET: f64 = 3.0;

impl Hall {
    /// A hall with about this many polygons: as many sets of a table, four chairs, a shelf and a ball
    /// as that takes, and a lamp above each.
    fn new(polygons: usize) -> Self {
        let per_set = 320;
        let side = ((polygons as f64 / per_set as f64).sqrt().ceil() as usize).max(1);
        let size = side as f64 * SET;
        let mut hall = Self::default();
        hall.room(size);
        let places = (0..side * side).map(|i| DVec3::new((i % side) as f64, 0.0, (i / side) as f64));
        let places: Vec<DVec3> = places.map(|at| (at + DVec3::new(0.5, 0.0, 0.5)) * SET).collect();
        for &at in &places {
            hall.quad(
                at + DVec3::new(-0.3, 2.99, -0.6),
                DVec3::X * 0.6,
                DVec3::Z * 1.2,
                BLACK,
                LinearRgb::splat(12.0),
            );
        }
        for (number, &at) in (0..).zip(&places) {
            hall.set(at, f64::from(number) * 0.7);
        }
        hall.polygons.truncate(polygons.max(7));
        hall
    }

    fn mesh(&self) -> ElementMesh {
        let polygons: Vec<_> = self.polygons.iter().map(|(c, r, e)| (&c[..], *r, *e)).collect();
        ElementMesh::of_polygons(&polygons)
    }

    fn room(&mut self, size: f64) {
        let (x, y, z) = (DVec3::X * size, DVec3::Y * 3.0, DVec3::Z * size);
        self.quad(DVec3::ZERO, z, x, WOOD, BLACK);
        self.quad(y, x, z, WALL, BLACK);
        self.quad(DVec3::ZERO, x, y, WALL, BLACK);
        self.quad(z, y, x, WALL, BLACK);
        self.quad(DVec3::ZERO, y, z, RED, BLACK);
        self.quad(x, z, y, WALL, BLACK);
    }

    fn quad(&mut self, origin: DVec3, u: DVec3, v: DVec3, color: LinearRgb, light: LinearRgb) {
        self.polygons.push((vec![origin, origin + u, origin + u + v, origin + v], color, light));
    }

    /// A box with its middle at `center`, turned about the vertical.
    fn block(&mut self, center: DVec3, size: DVec3, angle: f64, color: LinearRgb) {
        let turn = DMat3::from_rotation_y(angle);
        let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| turn * (axis * size));
        let low = center - 0.5 * (x + y + z);
        for (origin, u, v) in
            [(low, z, y), (low + x, y, z), (low, x, z), (low + y, z, x), (low, y, x), (low + z, x, y)]
        {
            self.quad(origin, u, v, color, BLACK);
        }
    }

    fn set(&mut self, at: DVec3, angle: f64) {
        let turn = DMat3::from_rotation_y(angle);
        let put = |x: f64, y: f64, z: f64| at + turn * DVec3::new(x, y, z);
        self.block(put(0.0, 0.73, 0.0), DVec3::new(1.2, 0.04, 0.8), angle, WOOD);
        for (x, z) in [(-0.55, -0.35), (0.55, -0.35), (0.55, 0.35), (-0.55, 0.35)] {
            self.block(put(x, 0.355, z), DVec3::new(0.05, 0.71, 0.05), angle, STEEL);
        }
        for (x, z) in [(-0.3, -0.7), (0.3, -0.7), (-0.3, 0.7), (0.3, 0.7)] {
            self.chair(put(x, 0.0, z), angle + if z > 0.0 { std::f64::consts::PI } else { 0.0 });
        }
        for board in 0..5 {
            let height = 0.1 + 0.4 * f64::from(board);
            self.block(put(-1.2, height, 0.0), DVec3::new(0.3, 0.02, 0.9), angle, WOOD);
        }
        self.ball(put(0.2, 0.85, 0.1), 0.1);
    }

    fn chair(&mut self, at: DVec3, angle: f64) {
        let turn = DMat3::from_rotation_y(angle);
        let put = |x: f64, y: f64, z: f64| at + turn * DVec3::new(x, y, z);
        self.block(put(0.0, 0.45, 0.0), DVec3::new(0.4, 0.03, 0.4), angle, RED);
        self.block(put(0.0, 0.7, -0.19), DVec3::new(0.4, 0.3, 0.02), angle, RED);
        for (x, z) in [(-0.18, -0.18), (0.18, 0.18)] {
            self.block(put(x, 0.215, z), DVec3::new(0.03, 0.43, 0.03), angle, STEEL);
        }
    }

    fn ball(&mut self, center: DVec3, radius: f64) {
        let (rows, columns) = (8, 14);
        let at = |row: i32, column: i32| {
            let (polar, round) = (
                std::f64::consts::PI * f64::from(row) / f64::from(rows),
                std::f64::consts::TAU * f64::from(column) / f64::from(columns),
            );
            center + radius * DVec3::new(polar.sin() * round.sin(), polar.cos(), polar.sin() * round.cos())
        };
        for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
            let corners =
                [at(row, column), at(row + 1, column), at(row + 1, column + 1), at(row, column + 1)];
            let corners = match row {
                0 => vec![corners[0], corners[1], corners[2]],
                _ if row == rows - 1 => vec![corners[0], corners[1], corners[3]],
                _ => corners.to_vec(),
            };
            self.polygons.push((corners, LinearRgb::new(0.2, 0.4, 0.7), BLACK));
        }
    }
}

#[expect(clippy::print_stdout, reason = "a program tells on standard output")]
fn main() -> Result<(), Box<dyn Error>> {
    let mut settings = HierarchySettings::default();
    let (mut counts, mut threads, mut repeat) = (Vec::new(), 0, 1);
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or("a value is missing");
        match &word[..] {
            "--threads" => threads = value()?.parse()?,
            "--threshold" => settings.threshold = value()?.parse()?,
            "--repeat" => repeat = value()?.parse()?,
            count => counts.push(count.parse()?),
        }
    }
    rayon::ThreadPoolBuilder::new().num_threads(threads).build_global()?;
    println!(
        "polygons seconds cpu_seconds in_main_thread elements leaves links iterations energy_error peak_MiB"
    );
    for count in counts {
        let hall = Hall::new(count);
        let [mut least, mut least_cpu, mut least_main] = [f64::INFINITY; 3];
        let mut report = None;
        for _ in 0..repeat {
            let mesh = hall.mesh();
            let (start, cpu, main) = (Instant::now(), cpu_seconds("self"), cpu_seconds("thread-self"));
            let rounds = &mut |_: &senca_radiosity::Solution| {};
            let solution =
                solve_hierarchy(mesh, &DirectLight::default(), &settings, &Control::default(), rounds)?;
            least = least.min(start.elapsed().as_secs_f64());
            least_cpu = least_cpu.min(cpu_seconds("self") - cpu);
            least_main = least_main.min(cpu_seconds("thread-self") - main);
            report = Some(solution.report);
        }
        if let Some(r) = report {
            println!(
                "{} {least:.3} {least_cpu:.2} {least_main:.2} {} {} {} {} {:.1e} {:.0}{}",
                r.polygons,
                r.elements,
                r.patches,
                r.links,
                r.iterations,
                r.energy_error,
                peak_mebibytes(),
                if r.converged { "" } else { " not converged" }
            );
        }
    }
    Ok(())
}

/// Processor time of this process (`self`) or thread (`thread-self`); 0 where the system does not tell.
/// The main thread does what is not done by all threads.
fn cpu_seconds(whose: &str) -> f64 {
    let stat = std::fs::read_to_string(format!("/proc/{whose}/stat")).unwrap_or_default();
    let after_name = stat.rsplit(')').next().unwrap_or_default();
    let fields = after_name.split_whitespace().skip(11).take(2);
    fields.filter_map(|field| field.parse::<f64>().ok()).sum::<f64>() / 100.0
}

/// The most memory that this process had so far; 0 where the system does not tell.
fn peak_mebibytes() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find(|line| line.starts_with("VmHWM"));
    let kibibytes =
        line.and_then(|line| line.split_whitespace().nth(1)).and_then(|word| word.parse::<f64>().ok());
    kibibytes.unwrap_or(0.0) / 1024.0
}
