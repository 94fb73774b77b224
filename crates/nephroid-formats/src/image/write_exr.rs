use std::io::Cursor;
use std::path::Path;

use exr::image::{AnyChannel, AnyChannels, Encoding, FlatSamples, Image as ExrImage, Layer as ExrLayer};
use exr::meta::header::LayerAttributes;
use exr::prelude::{SmallVec, WritableImage};
use nephroid::texture::Image;

use super::output::write_atomically;
use super::{ImageError, ImageProblem};

/// A picture in an OpenEXR file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layer<'a> {
    /// Prefix of the channels, as in `albedo.R`; empty for the picture that viewers show first.
    pub name: &'a str,
    /// Its values.
    pub data: LayerData<'a>,
}

/// The values of a layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LayerData<'a> {
    /// Channels R, G and B.
    Rgb(&'a Image),
    /// A channel Y.
    Grey {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
        /// `width · height` values, row by row.
        values: &'a [f32],
    },
    /// Channels with names of their own.
    Channels {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
        /// For each channel its name after the layer's and `width · height` values, row by row.
        channels: &'a [(&'a str, &'a [f32])],
    },
}

impl Layer<'_> {
    fn size(&self) -> (u32, u32) {
        match self.data {
            LayerData::Rgb(image) => (image.width, image.height),
            LayerData::Grey { width, height, .. } | LayerData::Channels { width, height, .. } => {
                (width, height)
            }
        }
    }

    /// Whether every channel has so many values.
    fn has_length(&self, len: usize) -> bool {
        match self.data {
            LayerData::Rgb(image) => image.pixels.len() == len,
            LayerData::Grey { values, .. } => values.len() == len,
            LayerData::Channels { channels, .. } => channels.iter().all(|(_, values)| values.len() == len),
        }
    }

    fn channels(&self) -> Vec<AnyChannel<FlatSamples>> {
        let channel = |letter: &str, values: Vec<f32>| {
            let dot = if self.name.is_empty() { "" } else { "." };
            AnyChannel::new(format!("{}{dot}{letter}", self.name).as_str(), FlatSamples::F32(values))
        };
        match self.data {
            LayerData::Grey { values, .. } => vec![channel("Y", values.to_vec())],
            LayerData::Channels { channels, .. } => {
                channels.iter().map(|(name, values)| channel(name, values.to_vec())).collect()
            }
            LayerData::Rgb(image) => (0..3)
                .zip(["R", "G", "B"])
                .map(|(i, letter)| channel(letter, image.pixels.iter().map(|p| p[i]).collect()))
                .collect(),
        }
    }
}

/// Writes layers of the same size as one OpenEXR file of 32-bit floats, linear with the primaries
/// of sRGB, zip-compressed. The file appears whole or not at all.
pub fn write_exr(path: &Path, layers: &[Layer]) -> Result<(), ImageError> {
    write_atomically(path, || encode_exr(layers))
}

/// The bytes that [`write_exr`] writes: always the same for the same layers.
pub fn encode_exr(layers: &[Layer]) -> Result<Vec<u8>, ImageProblem> {
    let (width, height) = check(layers)?;
    let channels: SmallVec<[_; 4]> = layers.iter().flat_map(Layer::channels).collect();
    let layer = ExrLayer::new(
        (width as usize, height as usize),
        LayerAttributes::default(),
        Encoding::SMALL_LOSSLESS,
        AnyChannels::sort(channels),
    );
    let mut bytes = Cursor::new(Vec::new());
    let written = ExrImage::from_layer(layer).write().non_parallel().to_buffered(&mut bytes);
    written.map_err(|e| ImageProblem::BadLayers(e.to_string()))?;
    Ok(bytes.into_inner())
}

/// The common size, if the layers can be written.
fn check(layers: &[Layer]) -> Result<(u32, u32), ImageProblem> {
    let bad = |reason: String| Err(ImageProblem::BadLayers(reason));
    let Some(first) = layers.first() else { return bad("there is no layer".to_owned()) };
    let size = first.size();
    if size.0 == 0 || size.1 == 0 {
        return Err(ImageProblem::NoPixels);
    }
    for (i, layer) in layers.iter().enumerate() {
        let name = layer.name;
        if layer.size() != size || !layer.has_length(size.0 as usize * size.1 as usize) {
            return bad(format!("the layer {name:?} has another size than {}×{}", size.0, size.1));
        }
        if name.len() > 200 || !name.bytes().all(|b| b.is_ascii_graphic()) {
            return bad(format!("{name:?} is not a name for a layer"));
        }
        if layers[..i].iter().any(|other| other.name == name) {
            return bad(format!("two layers have the name {name:?}"));
        }
    }
    Ok(size)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::read_image_bytes;
    use nephroid::color::Rgb;

    fn picture(width: u32, height: u32) -> Image {
        let value = |i: u32| Rgb::new(i as f32 * 0.1, 1e-30 * i as f32, 1e30 + i as f32);
        Image { width, height, pixels: (0..width * height).map(value).collect() }
    }

    fn main_layer(image: &Image) -> Layer<'_> {
        Layer { name: "", data: LayerData::Rgb(image) }
    }

    #[test]
    fn floats_come_back_to_the_bit() {
        for (width, height) in [(1, 1), (37, 21), (1, 40), (300, 2)] {
            let image = picture(width, height);
            let bytes = encode_exr(&[main_layer(&image)]).unwrap();
            assert_eq!(read_image_bytes(&bytes).unwrap().image, image);
        }
    }

    #[test]
    fn the_same_layers_give_the_same_bytes() {
        let image = picture(200, 100);
        assert_eq!(encode_exr(&[main_layer(&image)]).unwrap(), encode_exr(&[main_layer(&image)]).unwrap());
    }

    #[test]
    fn further_layers_have_names() {
        let image = picture(2, 2);
        let albedo = Image::filled(2, 2, Rgb::new(0.1, 0.2, 0.3));
        let variance = LayerData::Grey { width: 2, height: 2, values: &[1.0, 2.0, 3.0, 4.0] };
        let depth = LayerData::Channels { width: 2, height: 2, channels: &[("Z", &[5.0, 6.0, 7.0, 8.0])] };
        let layers = [
            Layer { name: "depth", data: depth },
            Layer { name: "albedo", data: LayerData::Rgb(&albedo) },
            main_layer(&image),
            Layer { name: "variance", data: variance },
        ];
        let bytes = encode_exr(&layers).unwrap();
        assert_eq!(read_image_bytes(&bytes).unwrap().image, image);
        let all = exr::prelude::read_first_flat_layer_from_file;
        let file = tempfile::NamedTempFile::new().unwrap();
        write_exr(file.path(), &layers).unwrap();
        let channels = all(file.path()).unwrap().layer_data.channel_data.list;
        let names: Vec<_> = channels.iter().map(|c| c.name.to_string()).collect();
        assert_eq!(names, ["B", "G", "R", "albedo.B", "albedo.G", "albedo.R", "depth.Z", "variance.Y"]);
        assert_eq!(channels[6].sample_data, FlatSamples::F32(vec![5.0, 6.0, 7.0, 8.0]));
        assert_eq!(channels[7].sample_data, FlatSamples::F32(vec![1.0, 2.0, 3.0, 4.0]));
    }

    #[test]
    fn impossible_layers_are_refused() {
        let (image, other) = (picture(2, 2), picture(2, 1));
        let named = |name| Layer { name, data: LayerData::Rgb(&image) };
        let short = LayerData::Grey { width: 2, height: 2, values: &[0.0] };
        for layers in [
            vec![],
            vec![main_layer(&image), main_layer(&other)],
            vec![named("a"), named("a")],
            vec![named("with space")],
            vec![named("ü")],
            vec![Layer { name: "", data: short }],
            vec![Layer {
                name: "a",
                data: LayerData::Channels { width: 2, height: 2, channels: &[("Z", &[1.0])] },
            }],
        ] {
            assert!(matches!(encode_exr(&layers), Err(ImageProblem::BadLayers(_))), "{layers:?}");
        }
        let empty = Image::default();
        assert!(matches!(encode_exr(&[main_layer(&empty)]), Err(ImageProblem::NoPixels)));
    }
}
