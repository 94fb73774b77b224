//! Images: as PNG where they are bytes, else as OpenEXR.

use nephroid::texture::{Decoding, Pixels, Pixmap, Plane};
use png::ColorType;

use crate::image::{ImageProblem, Layer, LayerData, encode_bytes, encode_exr};

/// An image as a file.
pub(super) struct Encoded {
    /// What its name ends with.
    pub(super) ending: &'static str,
    /// Whether its numbers are to be taken as they are.
    pub(super) raw: bool,
    pub(super) bytes: Vec<u8>,
}

/// The file of an image. It is read as the same pixels.
pub(super) fn encode(image: &Pixmap) -> Result<Encoded, ImageProblem> {
    if image.width == 0 || image.height == 0 {
        return Err(ImageProblem::NoPixels);
    }
    match bytes(image) {
        Some((kind, raw, data)) => {
            let bytes = encode_bytes(image.width, image.height, kind, &data)?;
            Ok(Encoded { ending: "png", raw, bytes })
        }
        None => Ok(Encoded { ending: "exr", raw: false, bytes: floats(image)? }),
    }
}

/// The rows of a PNG, and whether they are raw, if the image is of bytes.
fn bytes(image: &Pixmap) -> Option<(ColorType, bool, Vec<u8>)> {
    let (grey, decoding): (bool, &Decoding) = match &image.pixels {
        Pixels::Linear(_) => return None,
        Pixels::Grey(_, decoding) => (true, decoding),
        Pixels::Color(_, decoding) => (false, decoding),
    };
    let raw = *decoding == Decoding::linear();
    if !raw && *decoding != Decoding::srgb() {
        return None;
    }
    let alpha = match &image.alpha {
        None => None,
        Some(Plane::Bytes(alpha)) => Some(alpha),
        Some(Plane::Linear(_)) => return None,
    };
    let kind = match (grey, alpha.is_some()) {
        (true, false) => ColorType::Grayscale,
        (true, true) => ColorType::GrayscaleAlpha,
        (false, false) => ColorType::Rgb,
        (false, true) => ColorType::Rgba,
    };
    let mut data = Vec::new();
    for i in 0..image.pixels.len() {
        match &image.pixels {
            Pixels::Grey(values, _) => data.push(values[i]),
            Pixels::Color(values, _) => data.extend(values[i]),
            Pixels::Linear(_) => {}
        }
        data.extend(alpha.map(|alpha| alpha[i]));
    }
    Some((kind, raw, data))
}

fn floats(image: &Pixmap) -> Result<Vec<u8>, ImageProblem> {
    let channel = |c: usize| image.pixels.iter().map(|p| p[c]).collect::<Vec<f32>>();
    let colors = [0, 1, 2].map(channel);
    let mut channels: Vec<(&str, &[f32])> =
        ["R", "G", "B"].into_iter().zip(colors.iter().map(Vec::as_slice)).collect();
    let alpha: Option<Vec<f32>> =
        image.alpha.as_ref().map(|plane| (0..plane.len()).map(|i| plane.value(i)).collect());
    if let Some(alpha) = &alpha {
        channels.push(("A", alpha));
    }
    let (width, height) = (image.width, image.height);
    encode_exr(&[Layer { name: "", data: LayerData::Channels { width, height, channels: &channels } }])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::read_texture;
    use nephroid::color::Rgb;

    #[test]
    fn images_come_back_to_the_bit() {
        let of = |pixels: Pixels, alpha: Option<Plane>| Pixmap { width: 4, height: 1, pixels, alpha };
        let grey = || vec![0u8, 1, 128, 255];
        let color = vec![[0u8, 1, 2], [3, 4, 5], [255, 0, 77], [9, 9, 9]];
        let alpha = || Some(Plane::Bytes(vec![7, 8, 9, 10]));
        for (image, ending, raw) in [
            (of(Pixels::Grey(grey(), Decoding::srgb()), None), "png", false),
            (of(Pixels::Grey(grey(), Decoding::linear()), alpha()), "png", true),
            (of(Pixels::Color(color.clone(), Decoding::srgb()), alpha()), "png", false),
            (of(Pixels::Color(color, Decoding::linear()), None), "png", true),
            (of(Pixels::Linear(vec![Rgb::new(0.123, 1e-20, 70.0); 4]), None), "exr", false),
        ] {
            let encoded = encode(&image).unwrap();
            assert_eq!((encoded.ending, encoded.raw), (ending, raw));
            assert_eq!(read_texture(&encoded.bytes, raw).unwrap().image, image);
        }
    }
}
