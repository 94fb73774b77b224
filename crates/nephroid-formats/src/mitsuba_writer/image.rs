//! Images: as PNG where that loses nothing, else as OpenEXR.

use nephroid::color::srgb;
use nephroid::texture::Image;

use crate::image::{ImageProblem, Layer, LayerData, encode_exr, encode_png};

/// The ending of a file and its bytes.
pub(super) fn encode(image: &Image) -> Result<(&'static str, Vec<u8>), ImageProblem> {
    match encoded(image) {
        Some(display) => Ok(("png", encode_png(&display)?)),
        None => Ok(("exr", encode_exr(&[Layer { name: "", data: LayerData::Rgb(image) }])?)),
    }
}

/// The image in the encoding of sRGB, if it came from one with 8 bits a channel.
fn encoded(image: &Image) -> Option<Image> {
    let byte = |v: f32| {
        let byte = (srgb::encode(v) * 255.0).round();
        (srgb::decode(byte / 255.0) == v).then_some(byte / 255.0)
    };
    let pixel = |p: &nephroid::color::Rgb| {
        let [r, g, b] = p.to_array().map(byte);
        Some(nephroid::color::Rgb::new(r?, g?, b?))
    };
    let pixels = image.pixels.iter().map(pixel).collect::<Option<_>>()?;
    Some(Image { pixels, ..image.clone() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::read_texture;
    use nephroid::color::Rgb;

    #[test]
    fn images_come_back_to_the_bit() {
        let from_bytes = |i: u32| Rgb::splat(srgb::decode(i as f32 / 255.0));
        let bytes = Image { width: 64, height: 4, pixels: (0..256).map(from_bytes).collect() };
        let mut floats = bytes.clone();
        floats.pixels[7] = Rgb::new(0.123, 1e-20, 70.0);
        for (image, ending) in [(bytes, "png"), (floats, "exr")] {
            let (found, bytes) = encode(&image).unwrap();
            assert_eq!(found, ending);
            assert_eq!(read_texture(&bytes, false).unwrap().image, image);
        }
    }
}
