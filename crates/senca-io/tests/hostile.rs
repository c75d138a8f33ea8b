//! Broken files: cut off at every byte, changed at random, and made to promise too much. No reader
//! may panic or hang; what it makes must hold together.

use senca_io::{Directory, Files, NoFiles, ReadError, classic, load_bytes, obj, ply, stl};
use senca_scene::{Scene, Shape};

type Reader = fn(&str, &[u8], &dyn Files) -> Result<Scene, ReadError>;

const OBJ: &[u8] = b"# sample\nmtllib a.mtl\no one\nv 0 0 0\nv 1 0 0 1 0.5 0\nv 1 1 0\nv 0 1 .5e-1\nvt 0 0\nvt 1 0\nvn 0 0 1\n\
    g a b\nusemtl red\ns 1\nf 1/1/1 2/2/1 3/1/1 \\\n 4/2/1\ns off\nf -1 -2 -3\no two\nl 1 2 3\np 4\nf 1//1 2//1 3//1\n";
const STL_TEXT: &[u8] =
    b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1e0 0\nendloop\n\
    endfacet\nendsolid a\n";
const PLY_TEXT: &[u8] = b"ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
    property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 2\nproperty list uchar int vertex_indices\n\
    element edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n0 0 0 1 2 3\n1 0 0 4 5 6\n1 1 0 7 8 9\n\
    0 1 0 10 11 12\n3 0 1 2\n4 0 1 2 3\n0 2\n";
const HOUSE: &[u8] = include_bytes!("../../../samples/classic/house.dat");
const PATCH: &[u8] = include_bytes!("../../../samples/classic/patch.bez");
const SCENE: &[u8] = include_bytes!("../../../samples/classic/scene1.dat");

/// A binary STL file of two facets.
fn stl_binary() -> Vec<u8> {
    let mut bytes = vec![b' '; 80];
    bytes.extend(2u32.to_le_bytes());
    for i in 0..24u8 {
        bytes.extend(f32::from(i).to_le_bytes());
        if i % 12 == 11 {
            bytes.extend([i, 0x80]);
        }
    }
    bytes
}

fn ply_binary() -> Vec<u8> {
    let head = "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty double x\nproperty short y\nproperty float z\n\
        property list uchar float more\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n";
    let mut bytes = head.as_bytes().to_vec();
    for i in 0..3i16 {
        bytes.extend(f64::from(i).to_be_bytes());
        bytes.extend((i * i).to_be_bytes());
        bytes.extend(1.5f32.to_be_bytes());
        bytes.push(1);
        bytes.extend(2.5f32.to_be_bytes());
    }
    [5, 0, 1, 2, -1, 0].iter().for_each(|v: &i32| bytes.extend(v.to_be_bytes()));
    bytes
}

fn samples() -> Vec<(&'static str, Reader, Vec<u8>)> {
    vec![
        ("a.obj", obj::read as Reader, OBJ.to_vec()),
        ("a.stl", stl::read, STL_TEXT.to_vec()),
        ("b.stl", stl::read, stl_binary()),
        ("a.ply", ply::read, PLY_TEXT.to_vec()),
        ("b.ply", ply::read, ply_binary()),
        ("house.dat", classic::read_object, HOUSE.to_vec()),
        ("patch.bez", classic::read_patches, PATCH.to_vec()),
        ("scene1.dat", classic::read_scene, SCENE.to_vec()),
    ]
}

/// Whether what was read holds together.
fn check(scene: &Scene, what: &str) {
    for geometry in &scene.geometries {
        if let Shape::Mesh(mesh) = &geometry.shape {
            mesh.check().unwrap_or_else(|error| panic!("{what}: {error}"));
            mesh.check_finite().unwrap_or_else(|error| panic!("{what}: {error}"));
        }
    }
    for node in &scene.nodes {
        assert!(node.geometry.is_none_or(|geometry| geometry.index() < scene.geometries.len()), "{what}");
    }
}

fn try_read(name: &str, read: Reader, bytes: &[u8], what: &str) {
    let samples = Directory::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../samples/classic"));
    if let Ok(scene) = read(name, bytes, &samples) {
        check(&scene, what);
    }
    if let Ok(scene) = load_bytes(name, bytes, &NoFiles) {
        check(&scene, what);
    }
}

/// Numbers that follow from `state` alone (Vigna 2015, splitmix64).
fn random(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[test]
fn samples_are_sound_themselves() {
    for (name, read, bytes) in samples() {
        let samples = Directory::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../samples/classic"));
        check(&read(name, &bytes, &samples).expect(name), name);
    }
}

#[test]
fn files_cut_off_at_any_byte_do_no_harm() {
    for (name, read, bytes) in samples() {
        for end in 0..bytes.len() {
            try_read(name, read, &bytes[..end], &format!("{name} cut off at {end}"));
        }
    }
}

#[test]
fn files_changed_at_random_do_no_harm() {
    const PIECES: [&[u8]; 12] = [
        b"-1",
        b"99999999999",
        b"nan",
        b"1e999",
        b"\\\n",
        b"/",
        b"\n",
        b" ",
        b"\0",
        b"\xff\xff\xff\xff",
        b"0",
        b"{",
    ];
    for (name, read, bytes) in samples() {
        for seed in 0..1500u64 {
            let mut state = seed;
            let mut changed = bytes.clone();
            for _ in 0..=random(&mut state) % 4 {
                let place = (random(&mut state) % (changed.len() as u64 + 1)) as usize;
                let length = (random(&mut state) % 8) as usize;
                let end = (place + length).min(changed.len());
                match random(&mut state) % 4 {
                    0 => {
                        changed.drain(place..end);
                    }
                    1 => {
                        let piece = PIECES[(random(&mut state) % PIECES.len() as u64) as usize];
                        changed.splice(place..end, piece.iter().copied());
                    }
                    2 => {
                        let copy = changed[place..end].to_vec();
                        let target = (random(&mut state) % (changed.len() as u64 + 1)) as usize;
                        changed.splice(target..target, copy);
                    }
                    _ => changed[place..end].iter_mut().for_each(|b| *b ^= 1 << (random(&mut state) % 8)),
                }
            }
            try_read(name, read, &changed, &format!("{name} with seed {seed}"));
        }
    }
}

#[test]
fn empty_promises_are_refused_at_once() {
    let header = |rest: &str| format!("ply\nformat {rest}\nend_header\n").into_bytes();
    let huge = [
        header(
            "ascii 1.0\nelement vertex 18446744073709551615\nproperty float x\nproperty float y\nproperty float z",
        ),
        header(
            "binary_little_endian 1.0\nelement vertex 999999999999\nproperty float x\nproperty float y\nproperty float z",
        ),
        header("binary_little_endian 1.0\nelement junk 999999999999999999"),
        header("ascii 1.0\nelement junk 999999999999999999\nproperty list uint float x"),
        b"999999999999 999999999999 9\n0 0 0 0\n".to_vec(),
        b"3 999999999999 9\n0 0 0 0\n1 0 0 0\n2 0 0 0\n0 0 99999999999 0 1 2\n".to_vec(),
        {
            let mut bytes = vec![b' '; 80];
            bytes.extend([0xff; 4]);
            bytes
        },
    ];
    for bytes in &huge {
        for (name, read, _) in samples() {
            let _ = read(name, bytes, &NoFiles);
            let _ = load_bytes(name, bytes, &NoFiles);
        }
    }
}
