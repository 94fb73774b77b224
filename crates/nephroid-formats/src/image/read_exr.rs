use std::io::Cursor;

use exr::math::Vec2;
use exr::meta::MetaData;
use exr::meta::attribute::{ChannelDescription, SampleType, Text};
use exr::meta::header::Header;
use exr::prelude::{ReadChannels, ReadLayers, ReadSpecificChannel, read};
use nephroid::color::Rgb;
use nephroid::texture::Image;

use super::limits::{check_held, check_size};
use super::{ImageFormat, ImageProblem};

/// The best of the compressions: PXR24 leaves out a byte of four, then zip saves up to 1032 : 1.
const BEST_RATIO: u64 = 1376;

/// Decodes the first layer that has channels R, G and B, or Y, at its largest resolution. The data
/// window is the image; the display window is ignored.
pub fn decode(bytes: &[u8]) -> Result<Image, ImageProblem> {
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(problem)?;
    if meta.headers.iter().any(|h| h.deep) {
        return Err(not_supported("deep data"));
    }
    for header in &meta.headers {
        check_header(header, bytes.len())?;
    }
    let (_, channels) = meta
        .headers
        .iter()
        .find_map(|h| Channels::of(&h.channels.list).map(|c| (h, c)))
        .ok_or_else(|| ImageProblem::NoColour { found: channel_names(&meta.headers) })?;
    match channels {
        Channels::Rgb(names) => decode_rgb(bytes, names),
        Channels::Grey(name) => decode_grey(bytes, name),
    }
    .map_err(problem)
}

/// The names of the channels that are read.
#[derive(Debug, PartialEq)]
enum Channels {
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
        let rgb =
            |prefix: &[u8]| Some(Self::Rgb([find(prefix, b"R")?, find(prefix, b"G")?, find(prefix, b"B")?]));
        // A file of luminance and chroma is not a grey one.
        let chroma = |prefix: &[u8]| list.iter().any(|c| c.name.as_slice() == [prefix, b"RY"].concat());
        let grey = |prefix: &[u8]| if chroma(prefix) { None } else { Some(Self::Grey(find(prefix, b"Y")?)) };
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

fn empty(size: Vec2<usize>) -> Image {
    // The size was checked, so it fits.
    Image::filled(size.width() as u32, size.height() as u32, Rgb::BLACK)
}

fn set(image: &mut Image, at: Vec2<usize>, value: Rgb) {
    let index = at.y() * image.width as usize + at.x();
    image.pixels[index] = value;
}

fn decode_rgb(bytes: &[u8], [r, g, b]: [Text; 3]) -> Result<Image, exr::error::Error> {
    let file = read()
        .no_deep_data()
        .largest_resolution_level()
        .specific_channels()
        .required(r)
        .required(g)
        .required(b)
        .collect_pixels(
            |size, _| empty(size),
            |image: &mut Image, at, (r, g, b): (f32, f32, f32)| set(image, at, Rgb::new(r, g, b)),
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))?;
    Ok(file.layer_data.channel_data.pixels)
}

fn decode_grey(bytes: &[u8], y: Text) -> Result<Image, exr::error::Error> {
    let file = read()
        .no_deep_data()
        .largest_resolution_level()
        .specific_channels()
        .required(y)
        .collect_pixels(
            |size, _| empty(size),
            |image: &mut Image, at, (y,): (f32,)| set(image, at, Rgb::splat(y)),
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
