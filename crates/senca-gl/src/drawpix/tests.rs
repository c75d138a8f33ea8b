use crate::{Config, Context, Enum, gl};

fn context(width: u32, height: u32) -> Context {
    let mut c = Context::new(Config::default());
    assert!(c.resize(width, height));
    c.pixel_store(gl::UNPACK_ALIGNMENT, 1);
    c.pixel_store(gl::PACK_ALIGNMENT, 1);
    c
}

fn read(c: &mut Context, at: [i32; 2], size: [i32; 2], format: Enum, ty: Enum, bytes: usize) -> Vec<u8> {
    let mut out = vec![0xee; bytes];
    c.read_pixels(at, size, format, ty, &mut out);
    assert_eq!(c.get_error(), gl::NO_ERROR);
    out
}

fn read_rgba(c: &mut Context, at: [i32; 2], size: [i32; 2]) -> Vec<[u8; 4]> {
    let bytes = read(c, at, size, gl::RGBA, gl::UNSIGNED_BYTE, (size[0] * size[1] * 4) as usize);
    bytes.as_chunks::<4>().0.to_vec()
}

fn read_red(c: &mut Context, at: [i32; 2], size: [i32; 2]) -> Vec<u8> {
    read(c, at, size, gl::RED, gl::UNSIGNED_BYTE, (size[0] * size[1]) as usize)
}

fn draw_red(c: &mut Context, size: [i32; 2], values: &[u8]) {
    c.draw_pixels(size, gl::RED, gl::UNSIGNED_BYTE, values);
}

/// A state in which fragments are drawn one by one although nothing happens to them.
fn one_by_one(c: &mut Context) {
    c.enable(gl::ALPHA_TEST);
}

#[test]
fn what_is_drawn_is_read_back() {
    for slow in [false, true] {
        let mut c = context(4, 3);
        if slow {
            one_by_one(&mut c);
        }
        let pixels: Vec<u8> = (0..48).map(|i| i * 5).collect();
        c.window_pos([0, 0]);
        c.draw_pixels([4, 3], gl::BGRA, gl::UNSIGNED_BYTE, &pixels);
        assert_eq!(read(&mut c, [0, 0], [4, 3], gl::BGRA, gl::UNSIGNED_BYTE, 48), pixels, "{slow}");
        // What lies outside the window stays as it was.
        let mut out = [7; 16];
        c.read_pixels([-1, -1], [2, 2], gl::RGBA, gl::UNSIGNED_BYTE, &mut out);
        assert_eq!(out, [7, 7, 7, 7, 7, 7, 7, 7, 7, 7, 7, 7, 10, 5, 0, 15]);
    }
}

#[test]
fn zoom_repeats_leaves_out_and_mirrors() {
    for slow in [false, true] {
        let mut c = context(6, 4);
        if slow {
            one_by_one(&mut c);
        }
        c.window_pos([1, 0]);
        c.pixel_zoom([2.0, 1.0]);
        draw_red(&mut c, [2, 1], &[10, 20]);
        assert_eq!(read_red(&mut c, [0, 0], [6, 1]), [0, 10, 10, 20, 20, 0]);
        c.pixel_zoom([-1.0, -2.0]);
        c.window_pos([3, 3]);
        draw_red(&mut c, [3, 1], &[1, 2, 3]);
        assert_eq!(read_red(&mut c, [0, 1], [6, 3]), [3, 2, 1, 0, 0, 0, 3, 2, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0]);
        c.pixel_zoom([0.5, 1.0]);
        c.window_pos([0, 3]);
        draw_red(&mut c, [6, 1], &[1, 2, 3, 4, 5, 6]);
        assert_eq!(read_red(&mut c, [0, 3], [4, 1]), [2, 4, 6, 0]);
    }
}

#[test]
fn transfer_happens_in_both_directions() {
    let mut c = context(2, 1);
    c.pixel_transfer(gl::RED_SCALE, 0.5);
    c.pixel_transfer(gl::GREEN_BIAS, 1.0);
    c.window_pos([0, 0]);
    c.draw_pixels([2, 1], gl::RGB, gl::UNSIGNED_BYTE, &[200, 0, 9, 100, 3, 4]);
    assert_eq!(read_rgba(&mut c, [0, 0], [2, 1]), [[50, 255, 9, 255], [25, 255, 4, 255]]);
    c.pixel_transfer(gl::RED_SCALE, 1.0);
    c.pixel_transfer(gl::GREEN_BIAS, 0.0);
    assert_eq!(read_rgba(&mut c, [0, 0], [2, 1]), [[100, 255, 9, 255], [50, 255, 4, 255]]);
}

#[test]
fn colour_indices_are_looked_up() {
    let mut c = context(3, 1);
    c.pixel_map(gl::PIXEL_MAP_I_TO_R, &[0.0, 0.2, 0.4, 1.0]);
    c.pixel_map(gl::PIXEL_MAP_I_TO_B, &[1.0, 0.0]);
    c.window_pos([0, 0]);
    c.draw_pixels([3, 1], gl::COLOR_INDEX, gl::UNSIGNED_SHORT, bytes_of(&[1u16, 2, 3]).as_slice());
    assert_eq!(read_rgba(&mut c, [0, 0], [3, 1]), [[51, 0, 0, 0], [102, 0, 255, 0], [255, 0, 0, 0]]);
    c.draw_pixels([3, 1], gl::COLOR_INDEX, gl::BITMAP, &[0b1010_0000]);
    assert_eq!(read_rgba(&mut c, [0, 0], [3, 1]), [[51, 0, 0, 0], [0, 0, 255, 0], [51, 0, 0, 0]]);
    assert_eq!(c.get_pixel_map(gl::PIXEL_MAP_I_TO_B), [1.0, 0.0]);
    c.pixel_map(gl::PIXEL_MAP_I_TO_R, &[0.0; 3]);
    assert_eq!(c.get_error(), gl::INVALID_VALUE);
}

fn bytes_of(shorts: &[u16]) -> Vec<u8> {
    shorts.iter().flat_map(|s| s.to_ne_bytes()).collect()
}

#[test]
fn depths_and_stencil_values_are_drawn_and_read() {
    let mut c = context(2, 1);
    c.window_pos([0, 0]);
    c.enable(gl::DEPTH_TEST);
    c.depth_func(gl::ALWAYS);
    c.color([0.2, 0.4, 0.6]);
    c.window_pos([0, 0]);
    let floats: Vec<u8> = [0.25f32, 0.75].iter().flat_map(|d| d.to_ne_bytes()).collect();
    c.draw_pixels([2, 1], gl::DEPTH_COMPONENT, gl::FLOAT, &floats);
    assert_eq!(read(&mut c, [0, 0], [2, 1], gl::DEPTH_COMPONENT, gl::FLOAT, 8), floats);
    assert_eq!(read_rgba(&mut c, [0, 0], [2, 1]), [[51, 102, 153, 255]; 2]);

    c.stencil_mask(0xf0);
    c.draw_pixels([2, 1], gl::STENCIL_INDEX, gl::UNSIGNED_BYTE, &[0xab, 0x3c]);
    let stencils = read(&mut c, [0, 0], [2, 1], gl::STENCIL_INDEX, gl::UNSIGNED_BYTE, 2);
    assert_eq!(stencils, [0xa0, 0x30]);

    c.stencil_mask(0xff);
    let words: Vec<u8> = [0x8000_0011u32, 0x4000_0022].iter().flat_map(|w| w.to_ne_bytes()).collect();
    c.draw_pixels([2, 1], gl::DEPTH_STENCIL, gl::UNSIGNED_INT_24_8, &words);
    assert_eq!(read(&mut c, [0, 0], [2, 1], gl::DEPTH_STENCIL, gl::UNSIGNED_INT_24_8, 8), words);
}

#[test]
fn copies_go_through_the_same_way() {
    for slow in [false, true] {
        let mut c = context(4, 2);
        c.window_pos([0, 0]);
        draw_red(&mut c, [2, 1], &[10, 20]);
        if slow {
            one_by_one(&mut c);
        }
        c.window_pos([2, 1]);
        c.copy_pixels([0, 0], [2, 1], gl::COLOR);
        assert_eq!(read_red(&mut c, [0, 0], [4, 2]), [10, 20, 0, 0, 0, 0, 10, 20]);
        // Of the part outside the window nothing is copied, and its place is left.
        c.window_pos([0, 1]);
        c.copy_pixels([-1, 0], [2, 1], gl::COLOR);
        assert_eq!(read_red(&mut c, [0, 0], [4, 2]), [10, 20, 0, 0, 0, 10, 10, 20]);
    }
    let mut c = context(2, 2);
    c.window_pos([0, 0]);
    c.draw_pixels([2, 1], gl::STENCIL_INDEX, gl::UNSIGNED_BYTE, &[1, 2]);
    c.window_pos([0, 1]);
    c.copy_pixels([0, 0], [2, 1], gl::STENCIL);
    let stencils = read(&mut c, [0, 0], [2, 2], gl::STENCIL_INDEX, gl::UNSIGNED_BYTE, 4);
    assert_eq!(stencils, [1, 2, 1, 2]);
}

#[test]
fn bitmaps_are_drawn_and_move_the_raster_position() {
    for slow in [false, true] {
        let mut c = context(6, 3);
        c.color([1.0, 0.0, 0.0]);
        if slow {
            one_by_one(&mut c);
        }
        c.window_pos([1, 0]);
        c.bitmap([2, 2], [0.0, 0.0], [2.5, 1.0], Some(&[0b1000_0000, 0b0100_0000]));
        c.bitmap([1, 1], [-0.5, 0.0], [0.0, 0.0], Some(&[0x80]));
        assert_eq!(
            read_red(&mut c, [0, 0], [6, 3]),
            [0, 255, 0, 0, 0, 0, 0, 0, 255, 0, 255, 0, 0, 0, 0, 0, 0, 0],
            "{slow}"
        );
    }
}

#[test]
fn a_bitmap_in_a_list_keeps_its_bits() {
    let mut c = context(2, 1);
    let list = c.gen_lists(1);
    let bits = vec![0x80];
    c.new_list(list, gl::COMPILE);
    c.bitmap([1, 1], [0.0; 2], [1.0, 0.0], Some(&bits));
    c.end_list();
    drop(bits);
    c.window_pos([0, 0]);
    c.call_list(list);
    c.call_list(list);
    assert_eq!(read_red(&mut c, [0, 0], [2, 1]), [255, 255]);
}

#[test]
fn an_invalid_raster_position_draws_nothing() {
    let mut c = context(2, 1);
    c.raster_pos([5.0, 5.0]);
    draw_red(&mut c, [2, 1], &[1, 2]);
    c.bitmap([1, 1], [0.0; 2], [1.0, 0.0], Some(&[0x80]));
    c.copy_pixels([0, 0], [1, 1], gl::COLOR);
    assert_eq!(read_red(&mut c, [0, 0], [2, 1]), [0, 0]);
    assert_eq!(c.get_error(), gl::NO_ERROR);
}

#[test]
fn the_scissor_cuts_pixels() {
    let mut c = context(3, 1);
    c.enable(gl::SCISSOR_TEST);
    c.scissor(1, 0, 1, 1);
    c.window_pos([0, 0]);
    draw_red(&mut c, [3, 1], &[1, 2, 3]);
    assert_eq!(read_red(&mut c, [0, 0], [3, 1]), [0, 2, 0]);
}

#[test]
fn wrong_commands_do_nothing() {
    let mut c = context(2, 1);
    c.window_pos([0, 0]);
    let cases: [(Enum, Enum, [i32; 2], Enum); 6] = [
        (gl::RGBA, gl::BITMAP, [1, 1], gl::INVALID_ENUM),
        (gl::RGBA, gl::RGBA, [1, 1], gl::INVALID_ENUM),
        (gl::RGBA, gl::UNSIGNED_SHORT_5_6_5, [1, 1], gl::INVALID_OPERATION),
        (gl::RGBA, gl::UNSIGNED_BYTE, [-1, 1], gl::INVALID_VALUE),
        (gl::RGBA, gl::UNSIGNED_BYTE, [1, -1], gl::INVALID_VALUE),
        (gl::RGBA, gl::UNSIGNED_BYTE, [9, 9], gl::INVALID_OPERATION),
    ];
    for (format, ty, size, error) in cases {
        c.draw_pixels(size, format, ty, &[255; 4]);
        assert_eq!(c.get_error(), error);
        let mut out = [9; 4];
        c.read_pixels([0, 0], size, format, ty, &mut out);
        assert_eq!((c.get_error(), out), (error, [9; 4]));
    }
    c.read_pixels([0, 0], [1, 1], gl::COLOR_INDEX, gl::UNSIGNED_BYTE, &mut [0]);
    assert_eq!(c.get_error(), gl::INVALID_OPERATION);
    c.copy_pixels([0, 0], [1, 1], gl::RGBA);
    assert_eq!(c.get_error(), gl::INVALID_ENUM);
    c.copy_pixels([0, 0], [-1, 1], gl::COLOR);
    assert_eq!(c.get_error(), gl::INVALID_VALUE);
    c.bitmap([-1, 1], [0.0; 2], [1.0; 2], None);
    assert_eq!(c.get_error(), gl::INVALID_VALUE);
    assert_eq!(read_red(&mut c, [0, 0], [2, 1]), [0, 0]);

    let mut c = Context::new(Config { depth_bits: 0, stencil_bits: 0, ..Config::default() });
    assert!(c.resize(2, 2));
    c.read_pixels([0, 0], [1, 1], gl::DEPTH_COMPONENT, gl::FLOAT, &mut [0; 4]);
    assert_eq!(c.get_error(), gl::INVALID_OPERATION);
    c.draw_pixels([1, 1], gl::STENCIL_INDEX, gl::UNSIGNED_BYTE, &[0]);
    assert_eq!(c.get_error(), gl::INVALID_OPERATION);
    c.copy_pixels([0, 0], [1, 1], gl::DEPTH);
    assert_eq!(c.get_error(), gl::INVALID_OPERATION);
}

#[test]
fn without_a_window_nothing_happens() {
    let mut c = Context::new(Config::default());
    c.window_pos([0, 0]);
    draw_red(&mut c, [1, 1], &[1]);
    c.bitmap([1, 1], [0.0; 2], [1.0; 2], Some(&[0x80]));
    c.clear(gl::COLOR_BUFFER_BIT | gl::DEPTH_BUFFER_BIT | gl::ACCUM_BUFFER_BIT);
    c.accum(gl::ACCUM, 1.0);
    c.accum(gl::RETURN, 1.0);
    c.get_error();
}

#[test]
fn luminance_is_the_sum_and_floats_are_clamped() {
    let mut c = context(1, 1);
    c.window_pos([0, 0]);
    c.draw_pixels([1, 1], gl::RGB, gl::UNSIGNED_BYTE, &[50, 60, 70]);
    assert_eq!(read(&mut c, [0, 0], [1, 1], gl::LUMINANCE, gl::UNSIGNED_BYTE, 1), [180]);
    c.pixel_transfer(gl::RED_SCALE, 100.0);
    let red = read(&mut c, [0, 0], [1, 1], gl::RED, gl::FLOAT, 4);
    assert_eq!(red, 1.0f32.to_ne_bytes());
}

#[test]
fn a_raster_position_a_little_short_of_a_pixel_counts_as_that_pixel() {
    let mut c = context(3, 1);
    c.window_pos([0.999_99, 0.0]);
    c.bitmap([1, 1], [0.0; 2], [0.0; 2], Some(&[0x80]));
    assert_eq!(read_red(&mut c, [0, 0], [3, 1]), [0, 255, 0]);
}
