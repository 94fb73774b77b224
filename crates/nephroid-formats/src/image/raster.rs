use std::io::Cursor;

use ::image::codecs::{
    bmp::BmpDecoder, hdr::HdrDecoder, jpeg::JpegDecoder, png::PngDecoder, tga::TgaDecoder,
};
use ::image::error::ImageError as DecodeError;
use ::image::{DynamicImage, ImageDecoder};
use nephroid::color::{Rgb, srgb};
use nephroid::texture::{Decoding, Pixels, Pixmap, Plane};

use super::limits::{check_held, check_size};
use super::{ImageFormat, ImageProblem};

/// Decodes PNG, JPEG, TGA, BMP and Radiance HDR.
pub fn decode(bytes: &[u8], format: ImageFormat, raw: bool) -> Result<Pixmap, ImageProblem> {
    let problem = |error| problem(format, error);
    let reader = Cursor::new(bytes);
    let pixels = match format {
        // Deflate saves up to 1032 : 1.
        ImageFormat::Png => pixels(PngDecoder::new(reader).map_err(problem)?, format, 1032, bytes)?,
        ImageFormat::Jpeg => {
            check_end_of_jpeg(bytes)?;
            // A progressive file may spend a single bit on a block of 8×8 pixels.
            pixels(JpegDecoder::new(reader).map_err(problem)?, format, 64 * 8 * 3, bytes)?
        }
        // Two bytes may stand for 128 pixels of 32 bits.
        ImageFormat::Tga => pixels(TgaDecoder::new(reader).map_err(problem)?, format, 256, bytes)?,
        // Two bytes may stand for 255 pixels of 24 bits.
        ImageFormat::Bmp => pixels(BmpDecoder::new(reader).map_err(problem)?, format, 384, bytes)?,
        // A run of a row of any length takes some 16 bytes, and a pixel 96 bits.
        _ => pixels(HdrDecoder::new_nonstrict(reader).map_err(problem)?, format, 4096 * 12, bytes)?,
    };
    Ok(kept(pixels, raw))
}

fn pixels(
    decoder: impl ImageDecoder,
    format: ImageFormat,
    best_ratio: u64,
    bytes: &[u8],
) -> Result<DynamicImage, ImageProblem> {
    let (width, height) = decoder.dimensions();
    let size = (u64::from(width), u64::from(height));
    check_size(size.0, size.1)?;
    let bits = u64::from(decoder.original_color_type().bits_per_pixel());
    check_held(size, bits, best_ratio, bytes.len())?;
    DynamicImage::from_decoder(decoder).map_err(|error| problem(format, error))
}

/// A JPEG file ends with the marker FF D9. The decoder fills up a picture that ends early without
/// a word, so its end is looked for here: behind the first start of scan (FF DA), where FF is
/// never followed by D9 for another reason.
fn check_end_of_jpeg(bytes: &[u8]) -> Result<(), ImageProblem> {
    let damaged =
        |reason: &str| Err(ImageProblem::Damaged { format: ImageFormat::Jpeg, reason: reason.to_owned() });
    let mut at = 2;
    while let Some([0xff, marker, rest @ ..]) = bytes.get(at..) {
        match *marker {
            0xda => {
                let ends = rest.windows(2).any(|pair| pair == [0xff, 0xd9]);
                return if ends { Ok(()) } else { damaged("it has no end") };
            }
            0xff => at += 1,
            0x01 | 0xd0..=0xd8 => at += 2,
            _ => {
                let Some(&length) = rest.first_chunk() else { break };
                at += 2 + usize::from(u16::from_be_bytes(length));
            }
        }
    }
    damaged("it has no image data")
}

fn kept(pixels: DynamicImage, raw: bool) -> Pixmap {
    let (width, height) = (pixels.width(), pixels.height());
    let decoding = || if raw { Decoding::linear() } else { Decoding::srgb() };
    let linear = |v: u16| {
        let value = f32::from(v) / 65_535.0;
        if raw { value } else { srgb::decode(value) }
    };
    let of_words = |words: [u16; 3]| Rgb::from(words.map(linear));
    let (pixels, alpha) = match pixels {
        DynamicImage::ImageRgb32F(p) => (Pixels::Linear(p.pixels().map(|p| Rgb::from(p.0)).collect()), None),
        DynamicImage::ImageLuma8(p) => (Pixels::Grey(p.into_raw(), decoding()), None),
        DynamicImage::ImageRgb8(p) => (Pixels::Color(p.pixels().map(|p| p.0).collect(), decoding()), None),
        DynamicImage::ImageLumaA8(p) => {
            let (values, alpha) = p.pixels().map(|p| (p.0[0], p.0[1])).unzip();
            (Pixels::Grey(values, decoding()), bytes_of_alpha(alpha))
        }
        DynamicImage::ImageLuma16(_) | DynamicImage::ImageRgb16(_) => {
            (Pixels::Linear(pixels.to_rgb16().pixels().map(|p| of_words(p.0)).collect()), None)
        }
        DynamicImage::ImageLumaA16(_) | DynamicImage::ImageRgba16(_) => {
            let (colors, alpha) = pixels
                .to_rgba16()
                .pixels()
                .map(|p| {
                    let [r, g, b, a] = p.0;
                    (of_words([r, g, b]), f32::from(a) / 65_535.0)
                })
                .unzip();
            (Pixels::Linear(colors), plane_of_alpha(alpha))
        }
        other => {
            let (values, alpha) =
                other.to_rgba8().pixels().map(|p| ([p.0[0], p.0[1], p.0[2]], p.0[3])).unzip();
            (Pixels::Color(values, decoding()), bytes_of_alpha(alpha))
        }
    };
    Pixmap { width, height, pixels, alpha }
}

/// Nothing where all is opaque.
fn bytes_of_alpha(alpha: Vec<u8>) -> Option<Plane> {
    alpha.iter().any(|&a| a != 255).then_some(Plane::Bytes(alpha))
}

/// Nothing where all is opaque.
pub fn plane_of_alpha(alpha: Vec<f32>) -> Option<Plane> {
    alpha.iter().any(|&a| a != 1.0).then_some(Plane::Linear(alpha))
}

fn problem(format: ImageFormat, error: DecodeError) -> ImageProblem {
    match error {
        DecodeError::Unsupported(e) => ImageProblem::NotSupported { format, feature: e.to_string() },
        other => ImageProblem::Damaged { format, reason: other.to_string() },
    }
}
