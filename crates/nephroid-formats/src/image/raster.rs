use std::io::Cursor;

use ::image::codecs::{hdr::HdrDecoder, jpeg::JpegDecoder, png::PngDecoder};
use ::image::error::ImageError as DecodeError;
use ::image::{DynamicImage, ImageDecoder};
use nephroid::color::{Rgb, srgb};
use nephroid::texture::Image;

use super::limits::{check_held, check_size};
use super::{ImageFormat, ImageProblem};

/// Decodes PNG, JPEG and Radiance HDR.
pub fn decode(bytes: &[u8], format: ImageFormat, raw: bool) -> Result<Image, ImageProblem> {
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
        // A run of a row of any length takes some 16 bytes, and a pixel 96 bits.
        _ => pixels(HdrDecoder::new_nonstrict(reader).map_err(problem)?, format, 4096 * 12, bytes)?,
    };
    Ok(to_linear(&pixels, raw))
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

fn to_linear(pixels: &DynamicImage, raw: bool) -> Image {
    let (width, height) = (pixels.width(), pixels.height());
    let pixels = match pixels {
        DynamicImage::ImageRgb32F(p) => p.pixels().map(|p| Rgb::from(p.0)).collect(),
        DynamicImage::ImageLuma16(_)
        | DynamicImage::ImageLumaA16(_)
        | DynamicImage::ImageRgb16(_)
        | DynamicImage::ImageRgba16(_) => {
            let value = |v: u16| f32::from(v) / 65_535.0;
            let linear = |v: u16| if raw { value(v) } else { srgb::decode(value(v)) };
            pixels.to_rgb16().pixels().map(|p| Rgb::from(p.0.map(linear))).collect()
        }
        other => {
            let value = |v: u8| f32::from(v) / 255.0;
            let linear: Vec<f32> =
                (0..=255).map(|v| if raw { value(v) } else { srgb::decode(value(v)) }).collect();
            other.to_rgb8().pixels().map(|p| Rgb::from(p.0.map(|v| linear[usize::from(v)]))).collect()
        }
    };
    Image { width, height, pixels }
}

fn problem(format: ImageFormat, error: DecodeError) -> ImageProblem {
    match error {
        DecodeError::Unsupported(e) => ImageProblem::NotSupported { format, feature: e.to_string() },
        other => ImageProblem::Damaged { format, reason: other.to_string() },
    }
}
