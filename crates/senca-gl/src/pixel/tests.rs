use proptest::prelude::*;

use super::*;
use crate::error::Error;
use crate::gl;

const COLOR_FORMATS: [u32; 11] = [
    gl::RED,
    gl::GREEN,
    gl::BLUE,
    gl::ALPHA,
    gl::RGB,
    gl::BGR,
    gl::RGBA,
    gl::BGRA,
    gl::ABGR_EXT,
    gl::LUMINANCE,
    gl::LUMINANCE_ALPHA,
];
const INDEX_FORMATS: [u32; 2] = [gl::COLOR_INDEX, gl::STENCIL_INDEX];
const PLAIN_TYPES: [u32; 8] = [
    gl::UNSIGNED_BYTE,
    gl::BYTE,
    gl::UNSIGNED_SHORT,
    gl::SHORT,
    gl::UNSIGNED_INT,
    gl::INT,
    gl::FLOAT,
    gl::HALF_FLOAT,
];
const THREE_TYPES: [u32; 4] = [
    gl::UNSIGNED_BYTE_3_3_2,
    gl::UNSIGNED_BYTE_2_3_3_REV,
    gl::UNSIGNED_SHORT_5_6_5,
    gl::UNSIGNED_SHORT_5_6_5_REV,
];
const FOUR_TYPES: [u32; 8] = [
    gl::UNSIGNED_SHORT_4_4_4_4,
    gl::UNSIGNED_SHORT_4_4_4_4_REV,
    gl::UNSIGNED_SHORT_5_5_5_1,
    gl::UNSIGNED_SHORT_1_5_5_5_REV,
    gl::UNSIGNED_INT_8_8_8_8,
    gl::UNSIGNED_INT_8_8_8_8_REV,
    gl::UNSIGNED_INT_10_10_10_2,
    gl::UNSIGNED_INT_2_10_10_10_REV,
];

fn color_layouts() -> Vec<PixelLayout> {
    let all = PLAIN_TYPES.into_iter().chain(THREE_TYPES).chain(FOUR_TYPES);
    all.flat_map(|ty| COLOR_FORMATS.into_iter().filter_map(move |f| PixelLayout::new(f, ty).ok())).collect()
}

fn source(bytes: &[u8], layout: PixelLayout, width: u32) -> PixelSource<'_> {
    PixelSource::new(bytes, &PixelStore::TIGHT, layout, [width, 1, 1], false).expect("enough bytes")
}

fn layout(format: u32, ty: u32) -> PixelLayout {
    PixelLayout::new(format, ty).expect("a layout")
}

fn read_one(format: u32, ty: u32, bytes: &[u8]) -> [f32; 4] {
    let mut out = [[9.0; 4]];
    source(bytes, layout(format, ty), 1).colors(0, 0, 0, &Transfer::plain(), &mut out);
    out[0]
}

#[test]
fn which_formats_and_types_go_together() {
    for ty in PLAIN_TYPES {
        for format in COLOR_FORMATS.into_iter().chain(INDEX_FORMATS).chain([gl::DEPTH_COMPONENT]) {
            assert!(PixelLayout::new(format, ty).is_ok(), "{format:x} {ty:x}");
        }
        assert_eq!(PixelLayout::new(gl::DEPTH_STENCIL, ty), Err(Error::InvalidEnum));
    }
    for format in COLOR_FORMATS {
        assert_eq!(PixelLayout::new(format, gl::BITMAP), Err(Error::InvalidEnum));
        assert_eq!(PixelLayout::new(format, gl::UNSIGNED_INT_24_8), Err(Error::InvalidOperation));
        for ty in THREE_TYPES {
            assert_eq!(PixelLayout::new(format, ty).is_ok(), format == gl::RGB);
        }
        for ty in FOUR_TYPES {
            let four = [gl::RGBA, gl::BGRA, gl::ABGR_EXT].contains(&format);
            let wanted = if four { None } else { Some(Error::InvalidOperation) };
            assert_eq!(PixelLayout::new(format, ty).err(), wanted);
        }
    }
    for format in INDEX_FORMATS {
        assert!(PixelLayout::new(format, gl::BITMAP).is_ok());
        assert_eq!(PixelLayout::new(format, gl::UNSIGNED_SHORT_5_6_5), Err(Error::InvalidOperation));
    }
    assert!(PixelLayout::new(gl::DEPTH_STENCIL, gl::UNSIGNED_INT_24_8).is_ok());
    assert!(PixelLayout::new(gl::DEPTH_STENCIL, gl::FLOAT_32_UNSIGNED_INT_24_8_REV).is_ok());
    assert_eq!(PixelLayout::new(gl::RGBA, gl::RGBA), Err(Error::InvalidEnum));
    assert_eq!(PixelLayout::new(gl::INTENSITY, gl::FLOAT), Err(Error::InvalidEnum));
    assert_eq!(PixelLayout::new(0, gl::FLOAT), Err(Error::InvalidEnum));
}

#[test]
fn rows_are_padded_to_the_alignment() {
    let store = |alignment| PixelStore { alignment, ..PixelStore::TIGHT };
    let bytes = |alignment, w, h, format, ty| {
        image_bytes(&store(alignment), [w, h, 1], false, format, ty).expect("a layout").expect("small")
    };
    // The last row ends with its last pixel: padding behind it is not touched.
    assert_eq!(bytes(1, 5, 3, gl::RGB, gl::UNSIGNED_BYTE), 45);
    assert_eq!(bytes(2, 5, 3, gl::RGB, gl::UNSIGNED_BYTE), 16 + 16 + 15);
    assert_eq!(bytes(4, 5, 3, gl::RGB, gl::UNSIGNED_BYTE), 16 + 16 + 15);
    assert_eq!(bytes(8, 5, 3, gl::RGB, gl::UNSIGNED_BYTE), 16 + 16 + 15);
    assert_eq!(bytes(8, 3, 2, gl::RGB, gl::FLOAT), 40 + 36);
    assert_eq!(bytes(4, 9, 2, gl::COLOR_INDEX, gl::BITMAP), 4 + 2);
    assert_eq!(bytes(4, 33, 2, gl::STENCIL_INDEX, gl::BITMAP), 8 + 5);
    assert_eq!(bytes(4, 1, 2, gl::RGB, gl::UNSIGNED_SHORT_5_6_5), 4 + 2);
    assert_eq!(bytes(4, 0, 2, gl::RGB, gl::UNSIGNED_BYTE), 0);
    assert_eq!(bytes(4, 3, 2, gl::DEPTH_STENCIL, gl::FLOAT_32_UNSIGNED_INT_24_8_REV), 48);
}

#[test]
fn row_length_and_skips_move_the_origin() {
    let store = PixelStore {
        row_length: 7,
        image_height: 4,
        skip_pixels: 2,
        skip_rows: 1,
        skip_images: 3,
        ..PixelStore::default()
    };
    let span = store.span(layout(gl::RGB, gl::UNSIGNED_BYTE), [3, 2, 2], true).expect("small");
    assert_eq!(span.row_stride, 24); // 21 bytes padded to 4
    assert_eq!(span.image_stride, 96);
    assert_eq!(span.offset, 3 * 96 + 24 + 6);
    assert_eq!(span.bytes, 3 * 96 + 24 + 6 + 96 + 24 + 9);

    // Images neither count nor are skipped outside commands for volumes.
    let flat = store.span(layout(gl::RGB, gl::UNSIGNED_BYTE), [3, 2, 1], false).expect("small");
    assert_eq!(flat.offset, 24 + 6);

    // A bitmap is skipped by bits.
    let store = PixelStore { skip_pixels: 13, row_length: 40, ..PixelStore::default() };
    let span = store.span(PixelLayout::BITMAP, [4, 2, 1], false).expect("small");
    assert_eq!((span.offset, span.first_bit, span.row_stride, span.row_bytes), (1, 5, 8, 2));
}

#[test]
fn sizes_beyond_memory_are_none() {
    let huge = PixelStore { row_length: u32::MAX, skip_rows: u32::MAX, ..PixelStore::default() };
    let huge = PixelStore { image_height: u32::MAX, skip_images: u32::MAX, ..huge };
    assert_eq!(image_bytes(&huge, [u32::MAX; 3], true, gl::RGBA, gl::FLOAT), Ok(None));
    assert!(PixelSource::new(&[0; 8], &huge, layout(gl::RGBA, gl::FLOAT), [1, 1, 1], true).is_none());
}

#[test]
fn parameters_are_checked() {
    let mut store = PixelStore::default();
    assert_eq!(store.get(gl::UNPACK_ALIGNMENT), Some(4));
    for wrong in [0, 3, 5, 16, -1] {
        assert_eq!(store.set(gl::PACK_ALIGNMENT, wrong), Err(Error::InvalidValue));
    }
    for pname in [gl::UNPACK_ROW_LENGTH, gl::PACK_SKIP_ROWS, gl::UNPACK_SKIP_IMAGES, gl::PACK_IMAGE_HEIGHT] {
        assert_eq!(store.set(pname, -1), Err(Error::InvalidValue));
        assert_eq!(store.set(pname, 9), Ok(()));
        assert_eq!(store.get(pname), Some(9));
    }
    assert_eq!(store.set(gl::TEXTURE_2D, 1), Err(Error::InvalidEnum));
    store.set(gl::UNPACK_LSB_FIRST, -7).expect("a boolean");
    assert_eq!(store.get(gl::UNPACK_LSB_FIRST), Some(1));
}

#[test]
fn integers_become_the_values_of_the_specification() {
    assert_eq!(read_one(gl::RGBA, gl::UNSIGNED_BYTE, &[0, 255, 51, 102]), [0.0, 1.0, 0.2, 0.4]);
    // Signed c is (2c + 1) / (2^b - 1), clamped afterwards.
    let signed = read_one(gl::RGBA, gl::BYTE, &[127, 128, 0, 63]);
    assert_eq!(signed, [1.0, 0.0, 1.0 / 255.0, 127.0 / 255.0]);
    let shorts: Vec<u8> = [65535_u16, 0, 13107, 1].iter().flat_map(|c| c.to_ne_bytes()).collect();
    assert_eq!(read_one(gl::RGBA, gl::UNSIGNED_SHORT, &shorts), [1.0, 0.0, 0.2, 1.0 / 65535.0]);
    assert_eq!(read_one(gl::RED, gl::UNSIGNED_INT, &u32::MAX.to_ne_bytes()), [1.0, 0.0, 0.0, 1.0]);
    assert_eq!(read_one(gl::GREEN, gl::INT, &i32::MAX.to_ne_bytes()), [0.0, 1.0, 0.0, 1.0]);
    assert_eq!(read_one(gl::BLUE, gl::FLOAT, &0.3_f32.to_ne_bytes()), [0.0, 0.0, 0.3, 1.0]);
    assert_eq!(read_one(gl::ALPHA, gl::FLOAT, &f32::NAN.to_ne_bytes()), [0.0, 0.0, 0.0, 0.0]);
    assert_eq!(read_one(gl::LUMINANCE, gl::HALF_FLOAT, &0x3800_u16.to_ne_bytes()), [0.5, 0.5, 0.5, 1.0]);
    assert_eq!(read_one(gl::LUMINANCE_ALPHA, gl::UNSIGNED_BYTE, &[255, 0]), [1.0, 1.0, 1.0, 0.0]);
    assert_eq!(read_one(gl::ABGR_EXT, gl::UNSIGNED_BYTE, &[255, 0, 0, 255]), [1.0, 0.0, 0.0, 1.0]);
}

#[test]
fn packed_fields_lie_where_the_specification_puts_them() {
    let short = |ty, format, word: u16| read_one(format, ty, &word.to_ne_bytes());
    let long = |ty, format, word: u32| read_one(format, ty, &word.to_ne_bytes());
    assert_eq!(read_one(gl::RGB, gl::UNSIGNED_BYTE_3_3_2, &[0b1110_0001]), [1.0, 0.0, 1.0 / 3.0, 1.0]);
    assert_eq!(read_one(gl::RGB, gl::UNSIGNED_BYTE_2_3_3_REV, &[0b01_000_111]), [1.0, 0.0, 1.0 / 3.0, 1.0]);
    assert_eq!(short(gl::UNSIGNED_SHORT_5_6_5, gl::RGB, 0xf800), [1.0, 0.0, 0.0, 1.0]);
    assert_eq!(short(gl::UNSIGNED_SHORT_5_6_5_REV, gl::RGB, 0xf800), [0.0, 0.0, 1.0, 1.0]);
    assert_eq!(short(gl::UNSIGNED_SHORT_4_4_4_4, gl::BGRA, 0xf003), [0.0, 0.0, 1.0, 0.2]);
    assert_eq!(short(gl::UNSIGNED_SHORT_4_4_4_4_REV, gl::RGBA, 0xf003), [0.2, 0.0, 0.0, 1.0]);
    assert_eq!(short(gl::UNSIGNED_SHORT_5_5_5_1, gl::RGBA, 0x07c1), [0.0, 1.0, 0.0, 1.0]);
    assert_eq!(short(gl::UNSIGNED_SHORT_1_5_5_5_REV, gl::RGBA, 0x83e0), [0.0, 1.0, 0.0, 1.0]);
    assert_eq!(long(gl::UNSIGNED_INT_8_8_8_8, gl::RGBA, 0xff00_33ff), [1.0, 0.0, 0.2, 1.0]);
    assert_eq!(long(gl::UNSIGNED_INT_8_8_8_8_REV, gl::BGRA, 0xff00_33ff), [0.0, 0.2, 1.0, 1.0]);
    assert_eq!(long(gl::UNSIGNED_INT_10_10_10_2, gl::RGBA, 0x003f_f003), [0.0, 1.0, 0.0, 1.0]);
    assert_eq!(long(gl::UNSIGNED_INT_2_10_10_10_REV, gl::RGBA, 0xc000_03ff), [1.0, 0.0, 0.0, 1.0]);
}

#[test]
fn bits_are_read_from_either_end() {
    let read = |lsb_first, skip_pixels| {
        let store = PixelStore { lsb_first, skip_pixels, ..PixelStore::TIGHT };
        let source =
            PixelSource::new(&[0b1100_0010, 0b1000_0000], &store, PixelLayout::BITMAP, [6, 1, 1], false);
        let mut out = [9; 6];
        source.expect("enough").indices(0, 0, 0, &mut out);
        out
    };
    assert_eq!(read(false, 0), [1, 1, 0, 0, 0, 0]);
    assert_eq!(read(true, 0), [0, 1, 0, 0, 0, 0]);
    assert_eq!(read(false, 4), [0, 0, 1, 0, 1, 0]);
    assert_eq!(read(true, 10), [0, 0, 0, 0, 0, 1]);
}

#[test]
fn a_written_bitmap_keeps_the_other_bits() {
    let mut bytes = [0b1111_1111, 0b1111_1111];
    let store = PixelStore { skip_pixels: 3, ..PixelStore::TIGHT };
    let mut sink = PixelSink::new(&mut bytes, &store, PixelLayout::BITMAP, [7, 1, 1], false).expect("enough");
    sink.row(0, 0).put_indices(0, &[0, 2, 1, 0, 0, 0, 0]);
    assert_eq!(bytes, [0b1110_0100, 0b0011_1111]);
}

#[test]
fn floats_are_rounded_to_the_nearest_step() {
    let put = |format, ty, color: [f32; 4]| {
        let layout = layout(format, ty);
        let mut bytes = vec![0; layout.pixel_bits() / 8];
        let sink = PixelSink::new(&mut bytes, &PixelStore::TIGHT, layout, [1, 1, 1], false);
        sink.expect("enough").row(0, 0).put_colors(0, &[color]);
        bytes
    };
    assert_eq!(put(gl::RGBA, gl::UNSIGNED_BYTE, [0.499, 0.501, -3.0, 7.0]), [127, 128, 0, 255]);
    assert_eq!(put(gl::RGB, gl::BYTE, [1.0, 127.0 / 255.0, 1.0 / 255.0, 0.0]), [127, 63, 0]);
    assert_eq!(put(gl::LUMINANCE, gl::UNSIGNED_BYTE, [0.2, 0.4, 0.2, 0.0]), [204]);
    assert_eq!(put(gl::LUMINANCE_ALPHA, gl::UNSIGNED_BYTE, [0.6, 0.4, 0.2, 0.2]), [255, 51]);
    assert_eq!(put(gl::RGB, gl::UNSIGNED_SHORT_5_6_5, [1.0, 0.0, 1.0, 0.0]), 0xf81f_u16.to_ne_bytes());
    assert_eq!(put(gl::RED, gl::INT, [1.0, 0.0, 0.0, 0.0]), i32::MAX.to_ne_bytes());
    assert_eq!(put(gl::RED, gl::UNSIGNED_INT, [1.0, 0.0, 0.0, 0.0]), u32::MAX.to_ne_bytes());
}

#[test]
fn depth_and_stencil_share_an_element() {
    let word = 0xffff_ff05_u32.to_ne_bytes();
    let source = source(&word, layout(gl::DEPTH_STENCIL, gl::UNSIGNED_INT_24_8), 1);
    let (mut depth, mut stencil) = ([0.0], [0]);
    source.depths(0, 0, 0, &Transfer::plain(), &mut depth);
    source.stencils(0, 0, 0, &Transfer::plain(), &mut stencil);
    assert_eq!((depth, stencil), ([1.0], [5]));

    let layout = layout(gl::DEPTH_STENCIL, gl::FLOAT_32_UNSIGNED_INT_24_8_REV);
    let mut bytes = [0; 8];
    let sink = PixelSink::new(&mut bytes, &PixelStore::TIGHT, layout, [1, 1, 1], false);
    sink.expect("enough").row(0, 0).put_depth_stencils(0, &[0.25], &[200]);
    assert_eq!(bytes[..4], 0.25_f32.to_ne_bytes());
    assert_eq!(bytes[4..], 200_u32.to_ne_bytes());
}

#[test]
fn every_depth_of_24_bits_survives() {
    let layout = layout(gl::DEPTH_STENCIL, gl::UNSIGNED_INT_24_8);
    let words = (0..1 << 24).step_by(251).chain([0xff_fffe, 0xff_ffff]);
    for word in words.map(|depth: u32| depth << 8 | 0x5a) {
        let before = word.to_ne_bytes();
        let (mut depth, mut after) = ([0.0], [0; 4]);
        source(&before, layout, 1).depths(0, 0, 0, &Transfer::plain(), &mut depth);
        let sink = PixelSink::new(&mut after, &PixelStore::TIGHT, layout, [1, 1, 1], false);
        sink.expect("enough").row(0, 0).put_depth_stencils(0, &depth, &[0x5a]);
        assert_eq!(before, after);
    }
}

#[test]
fn every_half_float_survives() {
    for half in 0..=u16::MAX {
        let value = f32_from_f16(half);
        if value.is_nan() {
            assert!(f32_from_f16(f16_from_f32(value)).is_nan());
        } else {
            assert_eq!(f16_from_f32(value), half);
        }
    }
    assert_eq!(f32_from_f16(0x3555), 0.333_251_95);
    assert_eq!(f16_from_f32(65504.0), 0x7bff);
    assert_eq!(f16_from_f32(65520.0), 0x7c00);
    assert_eq!(f16_from_f32(65519.0), 0x7bff);
    assert_eq!(f16_from_f32(1e-9), 0);
}

#[test]
fn transfer_scales_biases_and_maps() {
    let mut modes = PixelTransfer::default();
    let mut maps = PixelMaps::default();
    let run = |modes: &PixelTransfer, maps: &PixelMaps, color: [f32; 4]| {
        let mut colors = [color];
        Transfer { modes, maps }.colors(&mut colors);
        colors[0]
    };
    modes.set(gl::RED_SCALE, 2.0).expect("a mode");
    modes.set(gl::ALPHA_BIAS, -0.5).expect("a mode");
    assert_eq!(run(&modes, &maps, [0.25, 0.5, 0.0, 0.75]), [0.5, 0.5, 0.0, 0.25]);
    // Clamped only after bias.
    assert_eq!(run(&modes, &maps, [0.75, -1.0, 2.0, 0.25]), [1.0, 0.0, 1.0, 0.0]);

    modes.set(gl::MAP_COLOR, 1.0).expect("a mode");
    maps.set(PixelMap::RToR, &[0.0, 0.25, 1.0]).expect("a table");
    // 2 * 0.25 is entry 1 of 0 .. 2; the other tables hold one 0.
    assert_eq!(run(&modes, &maps, [0.25, 0.5, 0.5, 1.0]), [0.25, 0.0, 0.0, 0.0]);

    modes.set(gl::INDEX_SHIFT, 1.0).expect("a mode");
    modes.set(gl::INDEX_OFFSET, 3.0).expect("a mode");
    maps.set(PixelMap::IToG, &[0.0, 0.1, 0.2, 0.3]).expect("a table");
    let mut colors = [[9.0; 4]; 2];
    Transfer { modes: &modes, maps: &maps }.colors_from_indices(&[1, 2], &mut colors);
    assert_eq!(colors, [[0.0, 0.1, 0.0, 0.0], [0.0, 0.3, 0.0, 0.0]]); // 5 and 7, modulo 4

    modes.set(gl::MAP_STENCIL, 1.0).expect("a mode");
    maps.set(PixelMap::SToS, &[10.0, 20.0]).expect("a table");
    let mut stencils = [1, 2];
    Transfer { modes: &modes, maps: &maps }.stencils(&mut stencils);
    assert_eq!(stencils, [20, 20]);
    assert_eq!(modes.set(gl::TEXTURE_2D, 0.0), Err(Error::InvalidEnum));
}

#[test]
fn pixel_maps_have_sizes() {
    let mut maps = PixelMaps::default();
    assert_eq!(maps.table(PixelMap::AToA), [0.0]);
    assert_eq!(maps.set(PixelMap::IToR, &[0.0; 3]), Err(Error::InvalidValue));
    assert_eq!(maps.set(PixelMap::AToA, &[2.0, -1.0, 0.5]), Ok(()));
    assert_eq!(maps.table(PixelMap::AToA), [1.0, 0.0, 0.5]);
    assert_eq!(maps.set(PixelMap::AToA, &[]), Err(Error::InvalidValue));
    assert_eq!(maps.set(PixelMap::AToA, &vec![0.0; MAX_PIXEL_MAP_TABLE + 1]), Err(Error::InvalidValue));
    assert_eq!(maps.set(PixelMap::SToS, &[700.0]), Ok(()));
    assert_eq!(maps.table(PixelMap::SToS), [700.0]);
    assert_eq!(PixelMap::from_token(gl::PIXEL_MAP_A_TO_A), Some(PixelMap::AToA));
    assert_eq!(PixelMap::from_size_token(gl::PIXEL_MAP_S_TO_S_SIZE), Some(PixelMap::SToS));
    assert_eq!(PixelMap::from_token(gl::PIXEL_MAP_A_TO_A + 1), None);
}

#[test]
fn depths_are_scaled_and_clamped() {
    let modes = PixelTransfer { depth_scale: 2.0, depth_bias: -0.5, ..PixelTransfer::PLAIN };
    let transfer = Transfer { modes: &modes, ..Transfer::plain() };
    let bytes: Vec<u8> = [0.0_f32, 0.5, 0.75].iter().flat_map(|d| d.to_ne_bytes()).collect();
    let mut out = [9.0; 3];
    source(&bytes, layout(gl::DEPTH_COMPONENT, gl::FLOAT), 3).depths(0, 0, 0, &transfer, &mut out);
    assert_eq!(out, [0.0, 0.5, 1.0]);
}

/// Stores of any shape that stays small.
fn stores() -> impl Strategy<Value = PixelStore> {
    let numbers = (0_u32..9, 0_u32..5, 0_u32..12, 0_u32..4, 0_u32..3);
    (numbers, 0_u32..4, any::<[bool; 2]>()).prop_map(|((row, height, pixels, rows, images), log, flags)| {
        PixelStore {
            swap_bytes: flags[0],
            lsb_first: flags[1],
            row_length: row,
            image_height: height,
            skip_pixels: pixels,
            skip_rows: rows,
            skip_images: images,
            alignment: 1 << log,
        }
    })
}

/// Stores where rows and images do not overlap.
fn apart(store: PixelStore, size: [u32; 3]) -> PixelStore {
    let at_least = |chosen: u32, own: u32| if chosen < own { 0 } else { chosen };
    PixelStore {
        row_length: at_least(store.row_length, size[0]),
        image_height: at_least(store.image_height, size[1]),
        ..store
    }
}

fn random_bytes(n: usize, seed: u32) -> Vec<u8> {
    let mut state = seed | 1;
    let mut next = || {
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
        state.to_le_bytes()[1]
    };
    (0..n).map(|_| next()).collect()
}

proptest! {
    /// Reading an image and writing it again in the same layout gives the same bytes.
    #[test]
    fn integers_survive_the_round_trip(
        which in 0..color_layouts().len(),
        store in stores(),
        size in [1_u32..9, 1_u32..5, 1_u32..4],
        seed: u32,
    ) {
        let layout = color_layouts()[which];
        prop_assume!(!layout.ty().is_float());
        // A sum of three equal luminances is no round trip; negative and 32-bit values lose by clamp and float.
        prop_assume!(!matches!(layout.format(), PixelFormat::Luminance | PixelFormat::LuminanceAlpha));
        let signed = matches!(layout.ty(), PixelType::I8 | PixelType::I16);
        prop_assume!(!matches!(layout.ty(), PixelType::U32 | PixelType::I32));
        let store = apart(store, size);
        let span = store.span(layout, size, true).expect("small");
        let mut before = random_bytes(span.bytes, seed);
        if signed {
            before.iter_mut().for_each(|byte| *byte &= 0x7f);
        }
        let mut after = before.clone();
        let source = PixelSource::new(&before, &store, layout, size, true).expect("enough");
        let mut sink = PixelSink::new(&mut after, &store, layout, size, true).expect("enough");
        for z in 0..size[2] as usize {
            for y in 0..size[1] as usize {
                let mut row = vec![[0.0; 4]; size[0] as usize];
                source.colors(z, y, 0, &Transfer::plain(), &mut row);
                let mut out = sink.row(z, y);
                out.bytes_mut().fill(0xa5);
                out.put_colors(0, &row);
            }
        }
        prop_assert_eq!(before, after);
    }

    /// The short cuts give what the plain forms give.
    #[test]
    fn short_cuts_equal_the_plain_forms(
        which in 0..color_layouts().len(),
        swap: bool,
        width in 1_u32..300,
        seed: u32,
    ) {
        let layout = color_layouts()[which];
        let store = PixelStore { swap_bytes: swap, ..PixelStore::TIGHT };
        let size = [width, 1, 1];
        let bytes = random_bytes(store.span(layout, size, false).expect("small").bytes, seed);
        let source = PixelSource::new(&bytes, &store, layout, size, false).expect("enough");
        let x = width as usize / 3;
        let n = width as usize - x;
        let (mut fast, mut plain) = (vec![[0; 4]; n], vec![[0; 4]; n]);
        source.colors8(0, 0, x, &Transfer::plain(), &mut fast);
        source.colors8_plain(0, 0, x, &Transfer::plain(), &mut plain);
        prop_assert_eq!(&fast, &plain);

        let (mut a, mut b) = (bytes.clone(), bytes.clone());
        PixelSink::new(&mut a, &store, layout, size, false).expect("enough").row(0, 0).put_colors8(x, &fast);
        PixelSink::new(&mut b, &store, layout, size, false).expect("enough").row(0, 0).put_colors8_plain(x, &fast);
        prop_assert_eq!(a, b);
    }

    /// Without gaps an image reads as it did with them.
    #[test]
    fn a_tight_copy_reads_alike(
        store in stores(),
        size in [1_u32..20, 1_u32..5, 1_u32..4],
        ty in 0..5_usize,
        seed: u32,
    ) {
        let ty = [gl::BITMAP, gl::UNSIGNED_BYTE, gl::SHORT, gl::UNSIGNED_INT, gl::UNSIGNED_BYTE][ty];
        let layout = layout(gl::COLOR_INDEX, ty);
        let bytes = random_bytes(store.span(layout, size, true).expect("small").bytes, seed);
        let source = PixelSource::new(&bytes, &store, layout, size, true).expect("enough");
        let tight = source.to_tight().expect("small");
        let copy = PixelSource::new(&tight, &PixelStore::TIGHT, layout, size, true).expect("enough");
        for z in 0..size[2] as usize {
            for y in 0..size[1] as usize {
                let mut rows = [vec![0; size[0] as usize], vec![1; size[0] as usize]];
                source.indices(z, y, 0, &mut rows[0]);
                copy.indices(z, y, 0, &mut rows[1]);
                prop_assert_eq!(&rows[0], &rows[1]);
            }
        }
    }

    /// Rows written on all threads are those written one after another.
    #[test]
    fn threads_write_the_same(store in stores(), seed: u32) {
        let size = [700, 300, 1];
        let layout = layout(gl::RGB, gl::UNSIGNED_SHORT);
        let store = apart(store, size);
        let span = store.span(layout, size, false).expect("small");
        let before = random_bytes(span.bytes, seed);
        let colors: Vec<[f32; 4]> = (0..700).map(|i| [i as f32 / 700.0, 0.5, 1.0, 0.0]).collect();
        let (mut a, mut b) = (before.clone(), before);
        let mut sink = PixelSink::new(&mut a, &store, layout, size, false).expect("enough");
        sink.each_row(0, 1..299, |y, mut row| row.put_colors(0, &colors[..y]));
        let mut sink = PixelSink::new(&mut b, &store, layout, size, false).expect("enough");
        for y in 1..299 {
            sink.row(0, y).put_colors(0, &colors[..y]);
        }
        prop_assert!(a == b);
    }
}
