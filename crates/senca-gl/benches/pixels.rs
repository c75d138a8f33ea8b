//! Pixels between client memory and framebuffer or texture: run with `cargo bench -p senca-gl --bench pixels`.
//!
//! Each bench moves one image of 1024 x 1024 pixels.

use divan::Bencher;
use divan::counter::ItemsCount;
use senca_gl::{Config, Context, gl};

const SIDE: i32 = 1024;
const PIXELS: usize = (SIDE * SIDE) as usize;

fn main() {
    divan::main();
}

fn context() -> Context {
    let mut c = Context::new(Config::default());
    assert!(c.resize(SIDE as u32, SIDE as u32), "memory for a window");
    c.window_pos([0, 0]);
    c
}

#[divan::bench]
fn clear_color_and_depth(bencher: Bencher<'_, '_>) {
    let mut c = context();
    c.clear_color([0.2, 0.4, 0.6, 1.0]);
    bencher.counter(ItemsCount::new(PIXELS)).bench_local(|| {
        c.clear(gl::COLOR_BUFFER_BIT | gl::DEPTH_BUFFER_BIT);
        c.finish();
    });
}

#[divan::bench(args = [gl::RGBA, gl::BGRA, gl::RGB, gl::LUMINANCE])]
fn read_bytes(bencher: Bencher<'_, '_>, format: u32) {
    let mut c = context();
    let mut bytes = vec![0; 4 * PIXELS];
    bencher
        .counter(ItemsCount::new(PIXELS))
        .bench_local(|| c.read_pixels([0, 0], [SIDE; 2], format, gl::UNSIGNED_BYTE, &mut bytes));
}

#[divan::bench]
fn read_depth_floats(bencher: Bencher<'_, '_>) {
    let mut c = context();
    let mut bytes = vec![0; 4 * PIXELS];
    bencher
        .counter(ItemsCount::new(PIXELS))
        .bench_local(|| c.read_pixels([0, 0], [SIDE; 2], gl::DEPTH_COMPONENT, gl::FLOAT, &mut bytes));
}

#[divan::bench(args = [gl::RGBA, gl::BGRA, gl::RGB])]
fn draw_bytes(bencher: Bencher<'_, '_>, format: u32) {
    let mut c = context();
    let bytes = vec![77; 4 * PIXELS];
    bencher.counter(ItemsCount::new(PIXELS)).bench_local(|| {
        c.draw_pixels([SIDE; 2], format, gl::UNSIGNED_BYTE, &bytes);
        c.finish();
    });
}

#[divan::bench]
fn draw_blended_bytes(bencher: Bencher<'_, '_>) {
    let mut c = context();
    c.enable(gl::BLEND);
    c.blend_func(gl::SRC_ALPHA, gl::ONE_MINUS_SRC_ALPHA);
    let bytes = vec![77; 4 * PIXELS];
    bencher.counter(ItemsCount::new(PIXELS)).bench_local(|| {
        c.draw_pixels([SIDE; 2], gl::RGBA, gl::UNSIGNED_BYTE, &bytes);
        c.finish();
    });
}

#[divan::bench(args = [gl::RGBA, gl::BGRA, gl::RGB, gl::LUMINANCE])]
fn sub_image_bytes(bencher: Bencher<'_, '_>, format: u32) {
    let mut c = context();
    let bytes = vec![77; 4 * PIXELS];
    let (t, byte) = (gl::TEXTURE_2D, gl::UNSIGNED_BYTE);
    c.tex_image_2d(t, 0, gl::RGBA as i32, [SIDE; 2], 0, gl::RGBA, byte, None);
    bencher
        .counter(ItemsCount::new(PIXELS))
        .bench_local(|| c.tex_sub_image_2d(t, 0, [0, 0], [SIDE; 2], format, byte, Some(&bytes)));
}

#[divan::bench]
fn mipmaps(bencher: Bencher<'_, '_>) {
    let mut c = context();
    let bytes = vec![77; 4 * PIXELS];
    let (t, byte) = (gl::TEXTURE_2D, gl::UNSIGNED_BYTE);
    c.tex_image_2d(t, 0, gl::RGBA as i32, [SIDE; 2], 0, gl::RGBA, byte, Some(&bytes));
    bencher.counter(ItemsCount::new(PIXELS)).bench_local(|| c.generate_mipmap(t));
}
