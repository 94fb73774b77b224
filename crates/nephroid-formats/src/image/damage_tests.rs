//! What the readers make of files that are cut off, damaged or lie about their size.

use std::io::Cursor;

use ::image::{DynamicImage, ImageBuffer, ImageFormat as Kind};
use nephroid::color::Rgb;
use nephroid::texture::Image;

use super::*;

/// Small sound files of every format.
fn samples() -> Vec<(ImageFormat, Vec<u8>)> {
    let value = |x: u32, y: u32| ((x * 37 + y * 101) % 256) as u8;
    let eight = ImageBuffer::from_fn(19, 11, |x, y| ::image::Rgb([value(x, y), value(y, x), 90]));
    let eight = DynamicImage::ImageRgb8(eight);
    let float = DynamicImage::ImageRgb32F(eight.to_rgb32f());
    let encoded = |image: &DynamicImage, kind| {
        let mut bytes = Cursor::new(Vec::new());
        image.write_to(&mut bytes, kind).unwrap();
        bytes.into_inner()
    };
    let pixels = float.to_rgb32f().pixels().map(|p| Rgb::from(p.0)).collect();
    let image = Image { width: 19, height: 11, pixels };
    let mut pfm = b"PF\n19 11\n-1\n".to_vec();
    pfm.extend(image.pixels.iter().flat_map(|p| p.to_array()).flat_map(f32::to_le_bytes));
    vec![
        (ImageFormat::Tga, encoded(&eight, Kind::Tga)),
        (ImageFormat::Bmp, encoded(&eight, Kind::Bmp)),
        (ImageFormat::Pfm, pfm),
        (ImageFormat::Png, encoded(&eight, Kind::Png)),
        (ImageFormat::Jpeg, encoded(&eight, Kind::Jpeg)),
        (ImageFormat::Hdr, encoded(&float, Kind::Hdr)),
        (ImageFormat::Exr, encode_exr(&[Layer { name: "", data: LayerData::Rgb(&image) }]).unwrap()),
    ]
}

#[test]
fn every_truncation_is_an_error() {
    for (format, bytes) in samples() {
        assert!(read_image_bytes(&bytes).is_ok(), "{format:?}");
        // The last twelve bytes of a PNG file hold nothing: its pixels are complete without them.
        let needed = if format == ImageFormat::Png { bytes.len() - 12 } else { bytes.len() };
        for length in 0..needed {
            assert!(read_image_bytes(&bytes[..length]).is_err(), "{format:?} of {length} bytes");
        }
    }
}

#[test]
fn damaged_files_end_in_an_error_or_in_an_image_of_sane_size() {
    let mut state = 1u64;
    let mut next = move |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    for (format, bytes) in samples() {
        for _ in 0..1500 {
            let mut damaged = bytes.clone();
            for _ in 0..=next(4) {
                // Headers are the most delicate part.
                let range = if next(2) == 0 { bytes.len().min(400) } else { bytes.len() };
                let at = next(range);
                damaged[at] = if next(2) == 0 { next(256) as u8 } else { damaged[at] ^ (1 << next(8)) };
            }
            if let Ok(file) = read_texture(&damaged, false) {
                let size = u64::from(file.image.width) * u64::from(file.image.height);
                assert!(size > 0 && size <= MAX_PIXELS, "{format:?}");
                assert_eq!(file.image.pixels.len() as u64, size);
            }
        }
    }
}

/// A sound start of a PNG file, and hardly more.
fn png_header(width: u32, height: u32) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgb);
    let mut writer = encoder.write_header().unwrap();
    writer.write_chunk(png::chunk::IDAT, &[0x78, 0x9c]).unwrap();
    drop(writer);
    bytes
}

fn exr_header(width: u32, height: u32) -> Vec<u8> {
    let (_, mut bytes) = samples().pop().unwrap();
    for name in [&b"dataWindow\0box2i\0"[..], b"displayWindow\0box2i\0"] {
        let at = bytes.windows(name.len()).position(|w| w == name).unwrap() + name.len() + 4;
        bytes[at + 8..at + 12].copy_from_slice(&(width as i32 - 1).to_le_bytes());
        bytes[at + 12..at + 16].copy_from_slice(&(height as i32 - 1).to_le_bytes());
    }
    bytes
}

fn jpeg_header(width: u16, height: u16) -> Vec<u8> {
    let mut bytes = samples().swap_remove(4).1;
    let at = bytes.windows(2).position(|w| w == [0xff, 0xc0]).unwrap();
    bytes[at + 5..at + 7].copy_from_slice(&height.to_be_bytes());
    bytes[at + 7..at + 9].copy_from_slice(&width.to_be_bytes());
    bytes
}

fn hdr_header(width: u32, height: u32) -> Vec<u8> {
    format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n\x01\x02\x03\x04").into_bytes()
}

fn bmp_header(width: u32, height: u32) -> Vec<u8> {
    let mut bytes = samples().swap_remove(1).1;
    bytes[18..22].copy_from_slice(&width.to_le_bytes());
    bytes[22..26].copy_from_slice(&height.to_le_bytes());
    bytes
}

fn tga_header(width: u16, height: u16) -> Vec<u8> {
    let mut bytes = samples().swap_remove(0).1;
    bytes[12..14].copy_from_slice(&width.to_le_bytes());
    bytes[14..16].copy_from_slice(&height.to_le_bytes());
    bytes
}

#[test]
fn absurd_sizes_are_refused() {
    let too_large = [
        png_header(1_000_000, 1_000_000),
        png_header(65_537, 1),
        exr_header(100_000, 100_000),
        jpeg_header(65_500, 65_500),
        hdr_header(4_000_000_000, 4_000_000_000),
        b"PF\n70000 1\n-1\n".to_vec(),
        bmp_header(60_000, 60_000),
    ];
    for bytes in too_large {
        let problem = read_image_bytes(&bytes).unwrap_err();
        assert!(
            matches!(problem, ImageProblem::TooLarge { .. } | ImageProblem::NotSupported { .. }),
            "{problem}"
        );
    }
}

#[test]
fn sizes_that_the_file_cannot_hold_are_refused_before_allocating() {
    for bytes in [
        png_header(16_384, 16_384),
        exr_header(16_384, 16_384),
        jpeg_header(16_384, 16_384),
        hdr_header(16_384, 16_384),
        b"Pf\n16384 16384\n1\n".to_vec(),
        bmp_header(16_384, 16_384),
        tga_header(16_384, 16_384),
    ] {
        let problem = read_image_bytes(&bytes).unwrap_err();
        assert!(matches!(problem, ImageProblem::TooShort { .. }), "{problem}");
    }
}

#[test]
fn compressible_images_are_not_taken_for_damaged_ones() {
    let black = Image::filled(3000, 1500, Rgb::BLACK);
    let exr = encode_exr(&[Layer { name: "", data: LayerData::Rgb(&black) }]).unwrap();
    let bits = DynamicImage::ImageLuma8(ImageBuffer::new(3000, 1500));
    let mut files = vec![exr, encode_png(&black).unwrap()];
    for kind in [Kind::Png, Kind::Jpeg] {
        let mut bytes = Cursor::new(Vec::new());
        bits.write_to(&mut bytes, kind).unwrap();
        files.push(bytes.into_inner());
    }
    let mut bytes = Cursor::new(Vec::new());
    DynamicImage::ImageRgb32F(bits.to_rgb32f()).write_to(&mut bytes, Kind::Hdr).unwrap();
    files.push(bytes.into_inner());
    for bytes in files {
        let file = read_image_bytes(&bytes).unwrap();
        assert_eq!((file.image.width, file.image.height), (3000, 1500), "{:?}", file.format);
    }
}

#[test]
fn a_decoder_that_overflows_does_no_harm() {
    // Empty runs, each of which multiplies the length of the next by 256.
    let mut bytes = hdr_header(4, 1);
    bytes.extend([1, 1, 1, 0].repeat(12));
    assert!(matches!(read_image_bytes(&bytes), Err(ImageProblem::Damaged { .. })));
}

#[test]
fn images_without_pixels_are_refused() {
    for bytes in [hdr_header(0, 5), hdr_header(5, 0), jpeg_header(0, 9), exr_header(0, 0)] {
        assert!(read_image_bytes(&bytes).is_err());
    }
}
