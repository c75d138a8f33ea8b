use super::*;
use crate::gl;
use crate::pixel::{PixelLayout, PixelSink, PixelSource, PixelStore, Transfer};
use crate::state::TexTarget;

fn format(token: u32) -> InternalFormat {
    InternalFormat::for_texture(token).expect("an internal format")
}

fn layout(format: u32, ty: u32) -> PixelLayout {
    PixelLayout::new(format, ty).expect("a layout")
}

/// An image of bytes.
fn image(internal: u32, size: [u32; 3], border: u32, pixels: u32, bytes: &[u8]) -> TexImage {
    let mut image = TexImage::new(format(internal), size, border).expect("small");
    let layout = layout(pixels, gl::UNSIGNED_BYTE);
    let source = PixelSource::new(bytes, &PixelStore::TIGHT, layout, size, true).expect("enough");
    image.write([0; 3], &Upload { source, transfer: Transfer::plain() });
    image
}

fn read(image: &TexImage, pixels: u32, ty: u32) -> Vec<u8> {
    let layout = layout(pixels, ty);
    let span = PixelStore::TIGHT.span(layout, image.size(), true).expect("small");
    let mut bytes = vec![0x77; span.bytes];
    let mut sink =
        PixelSink::new(&mut bytes, &PixelStore::TIGHT, layout, image.size(), true).expect("enough");
    image.read(&mut sink);
    bytes
}

fn bytes_of(image: &TexImage) -> Vec<[u8; 4]> {
    match &*image.texels {
        Texels::Rgba8(colors) => colors.clone(),
        other => panic!("not bytes: {other:?}"),
    }
}

#[test]
fn base_formats_are_those_of_the_specification() {
    use BaseFormat::*;
    let table: [(BaseFormat, &[u32]); 8] = [
        (Alpha, &[gl::ALPHA, gl::ALPHA4, gl::ALPHA8, gl::ALPHA12, gl::ALPHA16, gl::COMPRESSED_ALPHA]),
        (
            Luminance,
            &[
                1,
                gl::LUMINANCE,
                gl::LUMINANCE4,
                gl::LUMINANCE8,
                gl::LUMINANCE12,
                gl::LUMINANCE16,
                gl::COMPRESSED_LUMINANCE,
                gl::SLUMINANCE8,
            ],
        ),
        (
            LuminanceAlpha,
            &[
                2,
                gl::LUMINANCE_ALPHA,
                gl::LUMINANCE4_ALPHA4,
                gl::LUMINANCE6_ALPHA2,
                gl::LUMINANCE8_ALPHA8,
                gl::LUMINANCE12_ALPHA4,
                gl::LUMINANCE12_ALPHA12,
                gl::LUMINANCE16_ALPHA16,
            ],
        ),
        (Intensity, &[gl::INTENSITY, gl::INTENSITY4, gl::INTENSITY8, gl::INTENSITY12, gl::INTENSITY16]),
        (
            Rgb,
            &[
                3,
                gl::RGB,
                gl::R3_G3_B2,
                gl::RGB4,
                gl::RGB5,
                gl::RGB8,
                gl::RGB10,
                gl::RGB12,
                gl::RGB16,
                gl::SRGB8,
                gl::COMPRESSED_RGB,
            ],
        ),
        (
            Rgba,
            &[
                4,
                gl::RGBA,
                gl::RGBA2,
                gl::RGBA4,
                gl::RGB5_A1,
                gl::RGBA8,
                gl::RGB10_A2,
                gl::RGBA12,
                gl::RGBA16,
                gl::SRGB8_ALPHA8,
                gl::COMPRESSED_SRGB_ALPHA,
            ],
        ),
        (
            Depth,
            &[
                gl::DEPTH_COMPONENT,
                gl::DEPTH_COMPONENT16,
                gl::DEPTH_COMPONENT24,
                gl::DEPTH_COMPONENT32,
                gl::DEPTH_COMPONENT32F,
            ],
        ),
        (DepthStencil, &[gl::DEPTH_STENCIL, gl::DEPTH24_STENCIL8, gl::DEPTH32F_STENCIL8]),
    ];
    for (base, tokens) in table {
        for &token in tokens {
            assert_eq!(format(token).base(), base, "{token:#x}");
        }
    }
    for token in [0, 5, gl::RED, gl::BGRA, gl::COLOR_INDEX, gl::STENCIL_INDEX8, u32::MAX] {
        assert_eq!(InternalFormat::for_texture(token), None);
    }
}

#[test]
fn formats_tell_their_bits() {
    let bits = |token, pname| format(token).bits(pname).expect("a size");
    assert_eq!(bits(gl::RGB, gl::TEXTURE_RED_SIZE), 8);
    assert_eq!(bits(gl::RGB, gl::TEXTURE_ALPHA_SIZE), 0);
    assert_eq!(bits(gl::RGBA16, gl::TEXTURE_ALPHA_SIZE), 16);
    assert_eq!(bits(gl::LUMINANCE8, gl::TEXTURE_LUMINANCE_SIZE), 8);
    assert_eq!(bits(gl::LUMINANCE8, gl::TEXTURE_RED_SIZE), 0);
    assert_eq!(bits(gl::INTENSITY, gl::TEXTURE_INTENSITY_SIZE), 8);
    assert_eq!(bits(gl::DEPTH24_STENCIL8, gl::TEXTURE_DEPTH_SIZE), 24);
    assert_eq!(bits(gl::DEPTH24_STENCIL8, gl::TEXTURE_STENCIL_SIZE), 8);
    assert_eq!(format(gl::RGB).bits(gl::TEXTURE_WIDTH), None);
    // Compressed formats stand for their uncompressed ones.
    assert_eq!(format(gl::COMPRESSED_RGBA).token(), gl::RGBA);
    assert_eq!(format(gl::COMPRESSED_SRGB).token(), gl::RGB);
    assert!(format(gl::COMPRESSED_SRGB).is_srgb());
    assert_eq!(format(4).token(), 4);
}

#[test]
fn renderbuffers_take_nothing_compressed() {
    for token in [gl::RGB, gl::RGBA8, gl::RGBA16, gl::SRGB8_ALPHA8, gl::DEPTH24_STENCIL8, gl::STENCIL_INDEX8]
    {
        assert!(InternalFormat::for_renderbuffer(token).is_some());
    }
    for token in [3, 4, gl::COMPRESSED_RGBA, gl::COMPRESSED_ALPHA, gl::RED, 0] {
        assert!(InternalFormat::for_renderbuffer(token).is_none());
    }
}

#[test]
fn texels_are_stored_as_sampled() {
    let stored = |internal| bytes_of(&image(internal, [1, 1, 1], 0, gl::RGBA, &[10, 20, 30, 40]))[0];
    assert_eq!(stored(gl::RGBA), [10, 20, 30, 40]);
    assert_eq!(stored(gl::RGB), [10, 20, 30, 255]);
    assert_eq!(stored(gl::LUMINANCE), [10, 10, 10, 255]);
    assert_eq!(stored(gl::LUMINANCE_ALPHA), [10, 10, 10, 40]);
    assert_eq!(stored(gl::ALPHA), [0, 0, 0, 40]);
    assert_eq!(stored(gl::INTENSITY), [10; 4]);
}

#[test]
fn get_returns_components_by_base_format() {
    let given = |internal, pixels| {
        read(&image(internal, [1, 1, 1], 0, gl::RGBA, &[10, 20, 30, 40]), pixels, gl::UNSIGNED_BYTE)
    };
    assert_eq!(given(gl::LUMINANCE, gl::RGBA), [10, 0, 0, 255]);
    assert_eq!(given(gl::LUMINANCE, gl::LUMINANCE), [10]);
    assert_eq!(given(gl::INTENSITY, gl::RGBA), [10, 0, 0, 255]);
    assert_eq!(given(gl::LUMINANCE_ALPHA, gl::LUMINANCE_ALPHA), [10, 40]);
    assert_eq!(given(gl::ALPHA, gl::RGBA), [0, 0, 0, 40]);
    assert_eq!(given(gl::RGB, gl::BGRA), [30, 20, 10, 255]);
    assert_eq!(given(gl::RGBA, gl::LUMINANCE), [10]);
    assert_eq!(given(gl::RGB16, gl::LUMINANCE_ALPHA), [10, 255]);
    assert_eq!(given(gl::RGBA16, gl::RGBA), [10, 20, 30, 40]);
    assert_eq!(given(gl::LUMINANCE16, gl::RGBA), [10, 0, 0, 255]);
}

#[test]
fn sixteen_bits_survive() {
    let mut image = TexImage::new(format(gl::RGBA16), [2, 1, 1], 0).expect("small");
    let shorts = [1_u16, 2, 1000, 40_000, 65_535, 32_768, 0, 12_345];
    let bytes: Vec<u8> = shorts.iter().flat_map(|s| s.to_ne_bytes()).collect();
    let layout = layout(gl::RGBA, gl::UNSIGNED_SHORT);
    let source = PixelSource::new(&bytes, &PixelStore::TIGHT, layout, [2, 1, 1], false).expect("enough");
    image.write([0; 3], &Upload { source, transfer: Transfer::plain() });
    assert_eq!(read(&image, gl::RGBA, gl::UNSIGNED_SHORT), bytes);
}

#[test]
fn depth_with_stencil_goes_in_and_out() {
    let mut image = TexImage::new(format(gl::DEPTH24_STENCIL8), [2, 1, 1], 0).expect("small");
    let bytes: Vec<u8> = [0x1234_5678_u32, 0xffff_ff01].iter().flat_map(|s| s.to_ne_bytes()).collect();
    let layout = layout(gl::DEPTH_STENCIL, gl::UNSIGNED_INT_24_8);
    let source = PixelSource::new(&bytes, &PixelStore::TIGHT, layout, [2, 1, 1], false).expect("enough");
    image.write([0; 3], &Upload { source, transfer: Transfer::plain() });
    assert_eq!(read(&image, gl::DEPTH_STENCIL, gl::UNSIGNED_INT_24_8), bytes);
    assert_eq!(image.texels.stencils(), Some(&[0x78, 1][..]));
    // A depth alone leaves the stencil.
    let half = PixelLayout::new(gl::DEPTH_COMPONENT, gl::FLOAT).expect("a layout");
    let bytes: Vec<u8> = [0.5_f32, 0.25].iter().flat_map(|s| s.to_ne_bytes()).collect();
    let source = PixelSource::new(&bytes, &PixelStore::TIGHT, half, [2, 1, 1], false).expect("enough");
    image.write([0; 3], &Upload { source, transfer: Transfer::plain() });
    assert_eq!(image.texels.depths(), Some(&[0.5, 0.25][..]));
    assert_eq!(image.texels.stencils(), Some(&[0x78, 1][..]));
}

#[test]
fn a_sub_image_leaves_the_rest() {
    let mut whole = image(gl::RGBA, [4, 3, 2], 0, gl::LUMINANCE, &[7; 24]);
    let before = whole.texels.clone();
    let layout = layout(gl::RED, gl::UNSIGNED_BYTE);
    let source =
        PixelSource::new(&[1, 2, 3, 4], &PixelStore::TIGHT, layout, [2, 2, 1], false).expect("enough");
    whole.write([1, 1, 1], &Upload { source, transfer: Transfer::plain() });
    let texels = bytes_of(&whole);
    assert_eq!(texels[whole.index(1, 1, 1)], [1, 0, 0, 255]);
    assert_eq!(texels[whole.index(2, 2, 1)], [4, 0, 0, 255]);
    assert_eq!(texels.iter().filter(|t| **t == [7, 7, 7, 255]).count(), 20);
    // A draw that waits still sees the old texels.
    assert!(matches!(&*before, Texels::Rgba8(old) if old.iter().all(|t| *t == [7, 7, 7, 255])));
}

#[test]
fn large_images_are_written_by_rows_on_all_threads() {
    let (w, h) = (701, 400);
    let bytes: Vec<u8> = (0..w * h * 3).map(|i| (i % 251) as u8).collect();
    let image = image(gl::RGB, [w as u32, h as u32, 1], 0, gl::BGR, &bytes);
    let wanted: Vec<[u8; 4]> = bytes.chunks_exact(3).map(|p| [p[2], p[1], p[0], 255]).collect();
    assert!(bytes_of(&image) == wanted);
    assert!(read(&image, gl::BGR, gl::UNSIGNED_BYTE) == bytes);
}

#[test]
fn too_large_an_image_is_out_of_memory() {
    let huge = TexImage::new(format(gl::RGBA16), [u32::MAX; 3], 0);
    assert_eq!(huge.err(), Some(crate::error::Error::OutOfMemory));
}

#[test]
fn a_mipmap_is_the_mean_of_four() {
    let fine = image(gl::LUMINANCE, [4, 2, 1], 0, gl::LUMINANCE, &[0, 1, 10, 20, 2, 3, 30, 41]);
    let half = next_level(&fine).expect("a level").expect("small");
    assert_eq!(half.size(), [2, 1, 1]);
    // (0 + 1 + 2 + 3) / 4 = 1.5 and 101 / 4 = 25.25, rounded.
    assert_eq!(read(&half, gl::LUMINANCE, gl::UNSIGNED_BYTE), [2, 25]);
    let last = next_level(&half).expect("a level").expect("small");
    assert_eq!(read(&last, gl::LUMINANCE, gl::UNSIGNED_BYTE), [14]);
    assert!(next_level(&last).is_none());
}

#[test]
fn odd_sides_are_reduced_by_area() {
    // 5 texels to 2: each covers 2.5 of them.
    let fine = image(gl::LUMINANCE, [5, 1, 1], 0, gl::LUMINANCE, &[10, 20, 30, 40, 50]);
    let half = next_level(&fine).expect("a level").expect("small");
    assert_eq!(read(&half, gl::LUMINANCE, gl::UNSIGNED_BYTE), [18, 42]);
    let three = image(gl::LUMINANCE, [3, 1, 1], 0, gl::LUMINANCE, &[10, 20, 60]);
    let one = next_level(&three).expect("a level").expect("small");
    assert_eq!(read(&one, gl::LUMINANCE, gl::UNSIGNED_BYTE), [30]);
}

#[test]
fn srgb_is_averaged_as_light() {
    let fine = image(gl::SRGB8_ALPHA8, [2, 1, 1], 0, gl::RGBA, &[0, 255, 10, 0, 255, 255, 10, 255]);
    let half = next_level(&fine).expect("a level").expect("small");
    // Half the light is code 188, half the alpha is 128.
    assert_eq!(bytes_of(&half), [[188, 255, 10, 128]]);
}

#[test]
fn a_border_is_reduced_along_itself() {
    let fine = image(gl::LUMINANCE, [4, 3, 1], 1, gl::LUMINANCE, &[1, 2, 4, 5, 9, 10, 20, 11, 6, 7, 9, 8]);
    let half = next_level(&fine).expect("a level").expect("small");
    assert_eq!(half.size(), [3, 3, 1]);
    assert_eq!(read(&half, gl::LUMINANCE, gl::UNSIGNED_BYTE), [1, 3, 5, 9, 15, 11, 6, 8, 8]);
}

#[test]
fn depths_and_floats_are_averaged() {
    let mut fine = TexImage::new(format(gl::DEPTH_COMPONENT), [2, 2, 1], 0).expect("small");
    fine.write_depths([0; 3], &[0.0, 0.5]);
    fine.write_depths([0, 1, 0], &[1.0, 0.5]);
    let half = next_level(&fine).expect("a level").expect("small");
    assert_eq!(half.texels.depths(), Some(&[0.5][..]));
    let mut fine = TexImage::new(format(gl::RGB16), [2, 1, 2], 0).expect("small");
    fine.write_colors([0; 3], &[[0.0; 4], [0.25; 4]]);
    fine.write_colors([0, 0, 1], &[[0.5; 4], [0.25; 4]]);
    let half = next_level(&fine).expect("a level").expect("small");
    assert_eq!(*half.texels, Texels::Rgba32F(vec![[0.25, 0.25, 0.25, 1.0]]));
}

proptest::proptest! {
    /// The short cut for squares of four texels gives what the plain reduction gives.
    #[test]
    fn the_fast_mipmap_equals_the_plain_one(w in 1_u32..9, h in 1_u32..9, seed: u32) {
        let (w, h) = (2 * w, 2 * h);
        let bytes: Vec<u8> = (0..w * h * 4).map(|i| (i.wrapping_mul(seed | 1) >> 7) as u8).collect();
        let fine = image(gl::RGBA, [w, h, 1], 0, gl::RGBA, &bytes);
        let fast = next_level(&fine).expect("a level").expect("small");
        let mut plain = TexImage::new(fine.format, fast.size(), 0).expect("small");
        super::mipmap::reduce_plain(&fine, &mut plain);
        proptest::prop_assert_eq!(fast.texels, plain.texels);
    }

    /// A picture of one colour stays so, whatever its size.
    #[test]
    fn one_colour_stays(w in 1_u32..20, h in 1_u32..20, d in 1_u32..5, value: u8, srgb: bool) {
        let token = if srgb { gl::SRGB8_ALPHA8 } else { gl::RGBA };
        let fine = image(token, [w, h, d], 0, gl::RGBA, &vec![value; (w * h * d * 4) as usize]);
        if let Some(half) = next_level(&fine) {
            let half = half.expect("small");
            proptest::prop_assert!(bytes_of(&half).iter().all(|t| *t == [value; 4]));
        }
    }
}

fn texture(target: TexTarget, min_filter: u32) -> Texture {
    let mut texture = Texture::new(1, target);
    texture.set_parameter(gl::TEXTURE_MIN_FILTER, &[f64::from(min_filter)]).expect("a filter");
    texture
}

fn blank(size: [u32; 3]) -> Option<TexImage> {
    Some(TexImage::new(format(gl::RGBA), size, 0).expect("small"))
}

#[test]
fn a_texture_is_complete_with_all_its_levels() {
    let mut texture = texture(TexTarget::Two, gl::LINEAR_MIPMAP_LINEAR);
    assert_eq!(texture.sampled_levels(), None);
    texture.set_image(0, 0, blank([8, 4, 1]));
    texture.set_image(0, 1, blank([4, 2, 1]));
    texture.set_image(0, 2, blank([2, 1, 1]));
    assert_eq!(texture.sampled_levels(), None);
    texture.set_image(0, 3, blank([1, 1, 1]));
    assert_eq!(texture.sampled_levels(), Some(0..=3));
    // Fewer levels will do if no more are asked for.
    texture.set_image(0, 3, None);
    texture.set_parameter(gl::TEXTURE_MAX_LEVEL, &[2.0]).expect("a level");
    assert_eq!(texture.sampled_levels(), Some(0..=2));
    texture.set_parameter(gl::TEXTURE_BASE_LEVEL, &[1.0]).expect("a level");
    assert_eq!(texture.sampled_levels(), Some(1..=2));
    texture.set_image(0, 1, blank([4, 4, 1]));
    assert_eq!(texture.sampled_levels(), None);
    texture.set_parameter(gl::TEXTURE_MIN_FILTER, &[f64::from(gl::LINEAR)]).expect("a filter");
    assert_eq!(texture.sampled_levels(), Some(1..=1));
    texture.set_parameter(gl::TEXTURE_BASE_LEVEL, &[7.0]).expect("a level");
    assert_eq!(texture.sampled_levels(), None);
}

#[test]
fn a_cube_needs_six_equal_squares() {
    let mut texture = texture(TexTarget::Cube, gl::LINEAR);
    for face in 0..6 {
        assert_eq!(texture.sampled_levels(), None);
        texture.set_image(face, 0, blank([4, 4, 1]));
    }
    assert_eq!(texture.sampled_levels(), Some(0..=0));
    texture.set_image(2, 0, blank([2, 2, 1]));
    assert_eq!(texture.sampled_levels(), None);
}

#[test]
fn mipmaps_are_made_up_to_the_maximum_level() {
    let mut texture = texture(TexTarget::Cube, gl::NEAREST_MIPMAP_NEAREST);
    for face in 0..6 {
        texture.set_image(face, 0, blank([7, 7, 1]));
    }
    texture.generate_mipmaps().expect("small");
    assert_eq!(texture.sampled_levels(), Some(0..=2));
    assert_eq!(texture.image(5, 1).map(|image| image.size()), Some([3, 3, 1]));
    assert!(texture.image(0, 3).is_none());
}

#[test]
fn parameters_are_checked_and_given_back() {
    use crate::error::Error;
    let mut params = TexParams::default();
    for (pname, value) in [
        (gl::TEXTURE_MIN_FILTER, gl::LINEAR),
        (gl::TEXTURE_MAG_FILTER, gl::NEAREST),
        (gl::TEXTURE_WRAP_S, gl::CLAMP),
        (gl::TEXTURE_WRAP_T, gl::MIRRORED_REPEAT),
        (gl::TEXTURE_WRAP_R, gl::CLAMP_TO_EDGE),
        (gl::TEXTURE_COMPARE_MODE, gl::COMPARE_R_TO_TEXTURE),
        (gl::TEXTURE_COMPARE_FUNC, gl::GEQUAL),
        (gl::DEPTH_TEXTURE_MODE, gl::ALPHA),
        (gl::GENERATE_MIPMAP, 1),
        (gl::TEXTURE_BASE_LEVEL, 3),
    ] {
        assert_eq!(params.set(pname, &[f64::from(value)]), Ok(()));
        assert_eq!(params.get(pname), Some([f64::from(value), 0.0, 0.0, 0.0]));
    }
    assert_eq!(
        params.set(gl::TEXTURE_MAG_FILTER, &[f64::from(gl::LINEAR_MIPMAP_LINEAR)]),
        Err(Error::InvalidEnum)
    );
    assert_eq!(params.set(gl::TEXTURE_WRAP_S, &[1.0]), Err(Error::InvalidEnum));
    assert_eq!(params.set(gl::TEXTURE_MAX_LEVEL, &[-1.0]), Err(Error::InvalidValue));
    assert_eq!(params.set(gl::TEXTURE_BORDER_COLOR, &[0.5]), Err(Error::InvalidEnum));
    assert_eq!(params.set(gl::TEXTURE_BORDER_COLOR, &[0.5, 2.0, -1.0, 1.0]), Ok(()));
    assert_eq!(params.get(gl::TEXTURE_BORDER_COLOR), Some([0.5, 1.0, 0.0, 1.0]));
    assert_eq!(params.set(gl::TEXTURE_RESIDENT, &[1.0]), Err(Error::InvalidEnum));
    assert_eq!(params.get(gl::TEXTURE_RESIDENT), Some([1.0, 0.0, 0.0, 0.0]));
    assert_eq!(params.get(gl::RGBA), None);
}

#[test]
fn names_are_used_once() {
    let mut names = Names::<char>::default();
    assert_eq!(names.generate(2), [1, 2]);
    *names.get_or_insert(3, || 'a') = 'b';
    assert_eq!(names.generate(1), [4]);
    assert_eq!((names.get(1), names.get(3)), (None, Some('b')));
    assert!(names.is_used(1) && !names.is_used(9));
    assert_eq!(names.remove(3), Some('b'));
    assert!(!names.is_used(3));
    assert_eq!(names.generate(1), [5]);
}
