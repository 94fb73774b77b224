use std::io::Cursor;

use exr::math::Vec2;
use exr::meta::MetaData;
use exr::meta::attribute::{ChannelDescription, SampleType, Text};
use exr::meta::header::Header;
use exr::prelude::{ReadChannels, ReadLayers, ReadSpecificChannel, read};
use nephroid::color::Rgb;
use nephroid::texture::{Image, Pixmap};

use super::limits::{check_held, check_size};
use super::raster::plane_of_alpha;
use super::{ImageFormat, ImageProblem};

/// The best of the compressions: PXR24 leaves out a byte of four, then zip saves up to 1032 : 1.
const BEST_RATIO: u64 = 1376;

/// Decodes the first layer that has channels R, G and B, or Y, at its largest resolution. The data
/// window is the image; the display window is ignored. Alpha is a channel A of the same prefix. Colours are taken as they
/// are, which the format says are multiplied by alpha.
pub fn decode(bytes: &[u8]) -> Result<Pixmap, ImageProblem> {
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(problem)?;
    if meta.headers.iter().any(|h| h.deep) {
        return Err(not_supported("deep data"));
    }
    for header in &meta.headers {
        check_header(header, bytes.len())?;
    }
    let channels = meta
        .headers
        .iter()
        .find_map(|h| Channels::of(&h.channels.list))
        .ok_or_else(|| ImageProblem::NoColour { found: channel_names(&meta.headers) })?;
    let canvas = match channels.colors {
        Colors::Rgb(names) => decode_rgb(bytes, names, channels.alpha),
        Colors::Grey(name) => decode_grey(bytes, name, channels.alpha),
    };
    let Canvas { image, alpha } = canvas.map_err(problem)?;
    Ok(Pixmap { alpha: plane_of_alpha(alpha), ..Pixmap::from(image) })
}

/// The names of the channels that are read.
#[derive(Debug, PartialEq)]
struct Channels {
    colors: Colors,
    alpha: Option<Text>,
}

#[derive(Debug, PartialEq)]
enum Colors {
    Rgb([Text; 3]),
    Grey(Text),
}

impl Channels {
    /// R, G and B without a prefix, else Y, else the first prefix with R, G and B, else with Y.
    fn of(list: &[ChannelDescription]) -> Option<Self> {
        let full = |c: &&ChannelDescription| c.sampling == Vec2(1, 1);
        let find = |prefix: &[u8], name: &[u8]| {
            let wanted = [prefix, name].concat();
            list.iter().filter(full).find(|c| c.name.as_slice() == wanted).map(|c| c.name.clone())
        };
        let rgb = |prefix: &[u8]| {
            let colors = Colors::Rgb([find(prefix, b"R")?, find(prefix, b"G")?, find(prefix, b"B")?]);
            Some(Self { colors, alpha: find(prefix, b"A") })
        };
        // A file of luminance and chroma is not a grey one.
        let chroma = |prefix: &[u8]| list.iter().any(|c| c.name.as_slice() == [prefix, b"RY"].concat());
        let grey = |prefix: &[u8]| {
            let colors = Colors::Grey(find(prefix, b"Y").filter(|_| !chroma(prefix))?);
            Some(Self { colors, alpha: find(prefix, b"A") })
        };
        let prefixes = || {
            list.iter().filter_map(|c| {
                let name = c.name.as_slice();
                name.iter().rposition(|&b| b == b'.').map(|dot| &name[..=dot])
            })
        };
        rgb(b"")
            .or_else(|| grey(b""))
            .or_else(|| prefixes().find_map(rgb))
            .or_else(|| prefixes().find_map(grey))
    }
}

fn check_header(header: &Header, bytes: usize) -> Result<(), ImageProblem> {
    let size = (header.layer_size.width() as u64, header.layer_size.height() as u64);
    check_size(size.0, size.1)?;
    let bits = |c: &ChannelDescription| match c.sample_type {
        SampleType::F16 => 16,
        SampleType::F32 | SampleType::U32 => 32,
    };
    // Channels of lower resolution are left out of the estimate.
    let full = header.channels.list.iter().filter(|c| c.sampling == Vec2(1, 1));
    check_held(size, full.map(bits).sum(), BEST_RATIO, bytes)
}

fn channel_names(headers: &[Header]) -> String {
    let mut names: Vec<_> =
        headers.iter().flat_map(|h| h.channels.list.iter().map(|c| c.name.to_string())).collect();
    let total = names.len();
    names.truncate(12);
    if total > names.len() {
        names.push("…".to_owned());
    }
    names.join(", ")
}

/// What is filled while a file is read.
struct Canvas {
    image: Image,
    /// Empty where the file has none.
    alpha: Vec<f32>,
}

impl Canvas {
    fn new(size: Vec2<usize>, with_alpha: bool) -> Self {
        // The size was checked, so it fits.
        let image = Image::filled(size.width() as u32, size.height() as u32, Rgb::BLACK);
        let alpha = if with_alpha { vec![1.0; image.pixels.len()] } else { Vec::new() };
        Self { image, alpha }
    }

    fn set(&mut self, at: Vec2<usize>, value: Rgb, alpha: f32) {
        let index = at.y() * self.image.width as usize + at.x();
        self.image.pixels[index] = value;
        if let Some(own) = self.alpha.get_mut(index) {
            *own = alpha;
        }
    }
}

/// The name of a channel that no file has, for what is optional.
fn no_channel() -> Text {
    Text::from("no such channel")
}

fn decode_rgb(bytes: &[u8], [r, g, b]: [Text; 3], alpha: Option<Text>) -> Result<Canvas, exr::error::Error> {
    let with_alpha = alpha.is_some();
    let file = read()
        .no_deep_data()
        .largest_resolution_level()
        .specific_channels()
        .required(r)
        .required(g)
        .required(b)
        .optional(alpha.unwrap_or_else(no_channel), 1.0f32)
        .collect_pixels(
            |size, _| Canvas::new(size, with_alpha),
            |canvas: &mut Canvas, at, (r, g, b, a): (f32, f32, f32, f32)| {
                canvas.set(at, Rgb::new(r, g, b), a);
            },
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))?;
    Ok(file.layer_data.channel_data.pixels)
}

fn decode_grey(bytes: &[u8], y: Text, alpha: Option<Text>) -> Result<Canvas, exr::error::Error> {
    let with_alpha = alpha.is_some();
    let file = read()
        .no_deep_data()
        .largest_resolution_level()
        .specific_channels()
        .required(y)
        .optional(alpha.unwrap_or_else(no_channel), 1.0f32)
        .collect_pixels(
            |size, _| Canvas::new(size, with_alpha),
            |canvas: &mut Canvas, at, (y, a): (f32, f32)| canvas.set(at, Rgb::splat(y), a),
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))?;
    Ok(file.layer_data.channel_data.pixels)
}

fn not_supported(feature: &str) -> ImageProblem {
    ImageProblem::NotSupported { format: ImageFormat::Exr, feature: feature.to_owned() }
}

fn problem(error: exr::error::Error) -> ImageProblem {
    match error {
        exr::error::Error::NotSupported(feature) => not_supported(&feature),
        other => ImageProblem::Damaged { format: ImageFormat::Exr, reason: other.to_string() },
    }
}
