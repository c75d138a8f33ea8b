use proptest::prelude::*;
use senca_math::{Image, LinearRgb};
use senca_scene::{ColorSpace, ImageData};

use super::*;
use crate::{Limits, ReadError, WriteError};

/// A small picture with a value of every kind.
fn sample(alpha: f32) -> Image {
    let pixels = (0..7 * 5).map(|i| {
        let v = i as f32 / 34.0;
        [v, 1.0 - v, v * v, if i % 3 == 0 { alpha } else { 1.0 }]
    });
    Image::from_pixels(7, 5, pixels.collect()).expect("the count fits")
}

fn written(image: &Image, format: PictureFormat) -> Vec<u8> {
    encode(image, format, &PictureOptions::default()).expect("encodes")
}

fn read(bytes: &[u8]) -> Image {
    decode_picture("test", bytes, &Limits::default()).expect("decodes")
}

fn srgb(image: &Image) -> Vec<[u8; 4]> {
    let pixels = image.pixels().iter();
    pixels
        .map(|&[r, g, b, a]| {
            let c = LinearRgb::new(r, g, b).to_srgb8();
            [c.r, c.g, c.b, (a.clamp(0.0, 1.0) * 255.0 + 0.5) as u8]
        })
        .collect()
}

#[test]
fn eight_bit_formats_hold_the_srgb_bytes() {
    let image = sample(1.0);
    for format in [PictureFormat::Png, PictureFormat::Ppm, PictureFormat::Bmp] {
        assert_eq!(srgb(&read(&written(&image, format))), srgb(&image), "{format:?}");
    }
}

#[test]
fn a_picture_with_holes_is_written_with_alpha_by_png() {
    let image = sample(0.25);
    let bytes = written(&image, PictureFormat::Png);
    assert_eq!(bytes[25], 6, "colour type RGBA");
    assert_eq!(srgb(&read(&bytes)), srgb(&image));
    assert_eq!(written(&sample(1.0), PictureFormat::Png)[25], 2, "colour type RGB");
}

#[test]
fn both_png_packings_hold_the_same_picture() {
    let image = sample(0.5);
    let options = PictureOptions { png_compression: PngCompression::Small, ..PictureOptions::default() };
    let small = encode(&image, PictureFormat::Png, &options).expect("encodes");
    assert_eq!(read(&small), read(&written(&image, PictureFormat::Png)));
}

#[test]
fn float_formats_are_exact() {
    let mut image = sample(1.0);
    image.set_pixel(3, 3, [1e30, -2.5, 1e-30, 1.0]);
    for format in [PictureFormat::Exr, PictureFormat::Pfm] {
        assert_eq!(read(&written(&image, format)), image, "{format:?}");
    }
    // A power of two as alpha multiplies in and out without rounding.
    let holes = sample(0.25);
    assert_eq!(read(&written(&holes, PictureFormat::Exr)), holes);
}

#[test]
fn formats_without_alpha_show_the_picture_over_black() {
    let image = Image::new(1, 1, [0.8, 0.4, 0.2, 0.5]);
    assert_eq!(read(&written(&image, PictureFormat::Pfm)).pixel(0, 0), [0.4, 0.2, 0.1, 1.0]);
    let over = Image::new(1, 1, [0.4, 0.2, 0.1, 1.0]);
    for format in [PictureFormat::Ppm, PictureFormat::Bmp] {
        assert_eq!(written(&image, format), written(&over, format));
    }
}

#[test]
fn nan_is_written_as_black() {
    let nan = Image::new(2, 2, [f32::NAN, 0.5, f32::NAN, 1.0]);
    let black = Image::new(2, 2, [0.0, 0.5, 0.0, 1.0]);
    for format in PictureFormat::ALL {
        assert_eq!(written(&nan, format), written(&black, format), "{format:?}");
    }
    let no_alpha = Image::new(1, 1, [1.0, 1.0, 1.0, f32::NAN]);
    assert_eq!(read(&written(&no_alpha, PictureFormat::Png)).pixel(0, 0)[3], 0.0);
}

#[test]
fn jpeg_is_close_and_follows_its_quality() {
    let image = Image::new(16, 16, [0.2, 0.5, 0.1, 1.0]);
    for (a, b) in srgb(&read(&written(&image, PictureFormat::Jpeg))).iter().zip(srgb(&image)) {
        assert!((0..3).all(|i| a[i].abs_diff(b[i]) <= 3), "{a:?} {b:?}");
    }
    let noisy = Image::from_pixels(32, 32, (0..1024).map(|i| [(i * 7919 % 97) as f32 / 97.0; 4]).collect())
        .expect("the count fits");
    let size = |jpeg_quality| {
        let options = PictureOptions { jpeg_quality, ..PictureOptions::default() };
        encode(&noisy, PictureFormat::Jpeg, &options).expect("encodes").len()
    };
    assert!(size(10) < size(95));
}

#[test]
fn one_pixel_works_and_none_is_an_error() {
    for format in PictureFormat::ALL {
        let one = read(&written(&Image::new(1, 1, [1.0; 4]), format));
        assert_eq!((one.width(), one.height()), (1, 1));
        for (width, height) in [(0, 0), (0, 5), (5, 0)] {
            let empty = Image::new(width, height, [0.0; 4]);
            let error = encode(&empty, format, &PictureOptions::default()).expect_err("no pixel");
            assert!(matches!(error, WriteError::Unsupported { .. }));
        }
    }
}

#[test]
fn sides_of_16384_work() {
    for (width, height) in [(16384, 3), (3, 16384)] {
        let image = Image::new(width, height, [0.25, 0.5, 1.0, 1.0]);
        for format in PictureFormat::ALL {
            let back = read(&written(&image, format));
            assert_eq!((back.width(), back.height()), (width, height), "{format:?}");
        }
    }
}

#[test]
fn extensions_name_formats_in_either_case() {
    assert_eq!(PictureFormat::from_extension("PNG"), Some(PictureFormat::Png));
    assert_eq!(PictureFormat::from_extension(".jpeg"), Some(PictureFormat::Jpeg));
    assert_eq!(PictureFormat::from_extension("svg"), None);
    assert_eq!(PictureFormat::from_path("a/b.exr".as_ref()), Some(PictureFormat::Exr));
    assert_eq!(PictureFormat::from_path("a/b".as_ref()), None);
    for format in PictureFormat::ALL {
        assert_eq!(PictureFormat::from_extension(format.extension()), Some(format));
    }
}

/// A PNG of 1 x 1 with 16 bits a channel.
fn deep_png(rgba: [u16; 4]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 1, 1);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Sixteen);
    let mut writer = encoder.write_header().expect("writes");
    writer.write_image_data(&rgba.map(u16::to_be_bytes).concat()).expect("writes");
    writer.finish().expect("writes");
    bytes
}

#[test]
fn sixteen_bit_pictures_keep_their_depth() {
    let bytes = deep_png([32768, 257, 0, 65535]);
    let limits = Limits::default();
    let texel = |space| match decode_as("a.png", &bytes, &limits, space).expect("decodes") {
        ImageData::RgbaF32 { texels, .. } => texels[0],
        ImageData::Rgba8 { .. } => panic!("the depth is lost"),
    };
    assert_eq!(texel(ColorSpace::Linear), [32768.0 / 65535.0, 257.0 / 65535.0, 0.0, 1.0]);
    let [r, g, ..] = texel(ColorSpace::Srgb);
    assert!((r - 0.214_048).abs() < 1e-5 && (g - 1.0 / 255.0 / 12.92).abs() < 1e-8, "{r} {g}");
}

#[test]
fn content_counts_and_not_the_name() {
    let png = written(&sample(1.0), PictureFormat::Png);
    assert!(decode("picture.jpg", &png, &Limits::default()).is_ok());
    let error = decode("a.png", b"no picture", &Limits::default()).expect_err("unknown");
    assert!(matches!(&error, ReadError::Unsupported { .. }));
    assert!(error.to_string().starts_with("a.png: is not a picture"), "{error}");
}

#[test]
fn a_tga_is_known_by_its_name() {
    // Uncompressed true colour, 1 x 1, 24 bits: blue, green, red.
    let tga = [0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 1, 0, 24, 0x20, 30, 20, 10];
    let data = decode("WALL.TGA", &tga, &Limits::default()).expect("decodes");
    assert_eq!(data, ImageData::Rgba8 { width: 1, height: 1, texels: vec![[10, 20, 30, 255]] });
}

#[test]
fn pictures_above_the_limit_are_refused_by_their_header() {
    let limits = Limits { image_texels: 34, ..Limits::default() };
    for format in PictureFormat::ALL {
        let error = decode("big", &written(&sample(1.0), format), &limits).expect_err("35 pixels");
        assert!(matches!(error, ReadError::Limit { .. }), "{format:?}: {error}");
    }
}

#[test]
fn a_short_png_cannot_claim_a_huge_picture() {
    let mut png = written(&Image::new(1, 1, [1.0; 4]), PictureFormat::Png);
    png[16..24].copy_from_slice(&[0, 0, 0x40, 0, 0, 0, 0x40, 0]);
    let crc = crc32(&png[12..29]);
    png[29..33].copy_from_slice(&crc.to_be_bytes());
    let error = decode("bomb.png", &png, &Limits::default()).expect_err("2^28 pixels");
    assert!(error.to_string().contains("cannot hold"), "{error}");
}

fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |c, _| if c & 1 == 1 { 0xEDB8_8320 ^ (c >> 1) } else { c >> 1 })
    })
}

#[test]
fn float_maps_are_read_in_both_byte_orders_and_grey() {
    let limits = Limits::default();
    let mut big = b"Pf\n1 2\n1.0\n".to_vec();
    big.extend([2.0f32, 3.0].into_iter().flat_map(f32::to_be_bytes));
    let ImageData::RgbaF32 { texels, .. } = decode("a", &big, &limits).expect("decodes") else {
        panic!("floats");
    };
    assert_eq!(texels, [[3.0, 3.0, 3.0, 1.0], [2.0, 2.0, 2.0, 1.0]], "rows run from the bottom");
    for bad in
        ["PF\n", "PF\n1 x\n1\n", "PF\n1 1\n0\n", "PF\n1 1\n-1\nabc", "PF\n0 1\n-1\n", "PF 99999999999 1 1 "]
    {
        assert!(matches!(decode("a", bad.as_bytes(), &limits), Err(ReadError::Malformed { .. })), "{bad}");
    }
}

#[test]
fn truncated_pictures_end_in_an_error_or_a_picture() {
    let limits = Limits { image_texels: 1 << 16, ..Limits::default() };
    for format in PictureFormat::ALL {
        let bytes = written(&sample(0.5), format);
        for length in 0..bytes.len() {
            let _ = decode("cut", &bytes[..length], &limits);
        }
    }
}

proptest! {
    #[test]
    fn mutated_pictures_end_in_an_error_or_a_picture(
        format in 0..PictureFormat::ALL.len(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
    ) {
        let limits = Limits { image_texels: 1 << 16, ..Limits::default() };
        let mut bytes = written(&sample(0.5), PictureFormat::ALL[format]);
        for (place, value) in changes {
            let at = place.index(bytes.len());
            bytes[at] = value;
        }
        let _ = decode("changed", &bytes, &limits);
    }
}
