//! How fast meshes are read, on data made here.

use std::fmt::Write;

use senca_io::ply::PlyEncoding;
use senca_io::stl::StlEncoding;
use senca_io::{NoFiles, obj, ply, stl};
use senca_scene::{Scene, TessellationSettings};

/// Side of the grid: about as many triangles as the Stanford bunny.
const SIDE: usize = 186;

fn main() {
    divan::main();
}

/// A wavy grid of triangles as OBJ, with numbers of as many digits as scanners write.
fn obj_text() -> Vec<u8> {
    let mut text = String::new();
    for i in 0..=SIDE {
        for j in 0..=SIDE {
            let (x, z) = (i as f32 / SIDE as f32, j as f32 / SIDE as f32);
            let y = (7.0 * x).sin() * (5.0 * z).cos() * 0.1;
            let _ = writeln!(text, "v {x:.6} {y:.7} {z:.6}");
        }
    }
    for i in 0..SIDE {
        for j in 1..=SIDE {
            let a = i * (SIDE + 1) + j;
            let (b, c, d) = (a + 1, a + SIDE + 1, a + SIDE + 2);
            let _ = writeln!(text, "f {a} {b} {d}\nf {a} {d} {c}");
        }
    }
    text.into_bytes()
}

fn scene() -> Scene {
    obj::read("grid.obj", &obj_text(), &NoFiles).unwrap_or_default()
}

#[divan::bench]
fn obj(bencher: divan::Bencher<'_, '_>) {
    let bytes = obj_text();
    bencher
        .counter(divan::counter::BytesCount::new(bytes.len()))
        .bench(|| obj::read("grid.obj", &bytes, &NoFiles));
}

#[divan::bench]
fn stl_binary(bencher: divan::Bencher<'_, '_>) {
    let bytes =
        stl::write(&scene(), StlEncoding::Binary, &TessellationSettings::default()).unwrap_or_default();
    bencher
        .counter(divan::counter::BytesCount::new(bytes.len()))
        .bench(|| stl::read("grid.stl", &bytes, &NoFiles));
}

#[divan::bench]
fn stl_text(bencher: divan::Bencher<'_, '_>) {
    let bytes = stl::write(&scene(), StlEncoding::Text, &TessellationSettings::default()).unwrap_or_default();
    bencher
        .counter(divan::counter::BytesCount::new(bytes.len()))
        .bench(|| stl::read("grid.stl", &bytes, &NoFiles));
}

#[divan::bench(args = [PlyEncoding::LittleEndian, PlyEncoding::BigEndian, PlyEncoding::Text])]
fn ply(bencher: divan::Bencher<'_, '_>, encoding: PlyEncoding) {
    let bytes = ply::write(&scene(), encoding, &TessellationSettings::default()).unwrap_or_default();
    bencher
        .counter(divan::counter::BytesCount::new(bytes.len()))
        .bench(|| ply::read("grid.ply", &bytes, &NoFiles));
}
