use std::path::Path;

use nephroid::texture::Image;

use super::output::write_atomically;
use super::{ImageError, ImageProblem};

/// Writes display-encoded values in [0, 1] as an 8-bit PNG file that is marked as sRGB. Values
/// outside are clipped, and NaN is black. The file appears whole or not at all.
pub fn write_png(path: &Path, image: &Image) -> Result<(), ImageError> {
    write_atomically(path, || encode_png(image))
}

/// The bytes that [`write_png`] writes: always the same for the same image.
pub fn encode_png(image: &Image) -> Result<Vec<u8>, ImageProblem> {
    if image.width == 0 || image.height == 0 {
        return Err(ImageProblem::NoPixels);
    }
    // The conversion saturates, and sends NaN to 0.
    let byte = |v: f32| (v * 255.0 + 0.5) as u8;
    let data: Vec<u8> = image.pixels.iter().flat_map(|p| p.to_array().map(byte)).collect();
    encode(image.width, image.height, &data).map_err(|e| ImageProblem::Write(e.into()))
}

fn encode(width: u32, height: u32, data: &[u8]) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(data)?;
    writer.finish()?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::read_texture;
    use nephroid::color::Rgb;

    #[test]
    fn values_are_rounded_clipped_and_marked_as_srgb() {
        let pixels = vec![
            Rgb::new(0.0, 1.0, 0.5),
            Rgb::new(-1.0, 2.0, f32::NAN),
            Rgb::new(1.49 / 255.0, 1.51 / 255.0, f32::INFINITY),
        ];
        let bytes = encode_png(&Image { width: 1, height: 3, pixels }).unwrap();
        let image = read_texture(&bytes, true).unwrap().image;
        let expected = [[0.0, 255.0, 128.0], [0.0, 255.0, 0.0], [1.0, 2.0, 255.0]];
        for (found, expected) in image.pixels.iter().zip(expected) {
            assert_eq!((found * 255.0).to_array().map(f32::round), expected);
        }
        assert_eq!((image.width, image.height), (1, 3));
        assert!(bytes.windows(4).any(|w| w == b"sRGB"));
    }

    #[test]
    fn one_pixel_is_enough_and_none_is_not() {
        assert!(read_texture(&encode_png(&Image::filled(1, 1, Rgb::WHITE)).unwrap(), false).is_ok());
        assert!(matches!(encode_png(&Image::filled(0, 1, Rgb::WHITE)), Err(ImageProblem::NoPixels)));
    }
}
