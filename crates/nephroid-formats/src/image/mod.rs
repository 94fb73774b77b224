//! Image files: OpenEXR, PNG, JPEG, Radiance HDR, TGA, BMP and PFM in, OpenEXR and PNG out.
//!
//! Which format a file has is told by its first bytes, never by its name. Nothing is allocated on
//! the word of a header before the length of the file makes it plausible.

mod error;
mod limits;
mod output;
mod raster;
mod read_exr;
mod read_pfm;
mod write_exr;
mod write_png;

#[cfg(test)]
mod damage_tests;
#[cfg(test)]
mod read_tests;

use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use nephroid::color::Rgb;
use nephroid::texture::{Image, Pixels, Pixmap, Plane};

pub use error::{ImageError, ImageProblem};
pub use limits::{MAX_PIXELS, MAX_SIDE};
pub use output::check_writable;
pub(crate) use output::{stream_atomically, write_atomically};
pub use write_exr::{Layer, LayerData, encode_exr, write_exr};
pub use write_png::{encode_png, write_png};

/// The formats that can be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImageFormat {
    /// OpenEXR: half, float or integer channels, linear.
    Exr,
    /// PNG: 1 to 16 bits, grey, palette or colour.
    Png,
    /// JPEG.
    Jpeg,
    /// Radiance HDR (RGBE), linear. Its `EXPOSURE` line is not applied.
    Hdr,
    /// Truevision TGA: grey, palette or colour of 8 bits.
    Tga,
    /// Windows BMP.
    Bmp,
    /// Portable float map, linear.
    Pfm,
}

impl ImageFormat {
    /// Its name in messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Exr => "OpenEXR",
            Self::Png => "PNG",
            Self::Jpeg => "JPEG",
            Self::Hdr => "Radiance HDR",
            Self::Tga => "TGA",
            Self::Bmp => "BMP",
            Self::Pfm => "PFM",
        }
    }

    /// The format that a file starts as.
    pub fn of(bytes: &[u8]) -> Option<Self> {
        let starts = |magic: &[u8]| bytes.starts_with(magic);
        match () {
            () if starts(&[0x76, 0x2f, 0x31, 0x01]) => Some(Self::Exr),
            () if starts(b"\x89PNG\r\n\x1a\n") => Some(Self::Png),
            () if starts(&[0xff, 0xd8, 0xff]) => Some(Self::Jpeg),
            () if starts(b"#?") => Some(Self::Hdr),
            () if starts(b"BM") => Some(Self::Bmp),
            () if starts(b"PF") || starts(b"Pf") => Some(Self::Pfm),
            () if starts_as_tga(bytes) => Some(Self::Tga),
            () => None,
        }
    }
}

/// TGA files have no signature at their start, so all that their header says must be of the few values that it can have.
fn starts_as_tga(bytes: &[u8]) -> bool {
    let Some(header) = bytes.first_chunk::<18>() else { return false };
    let (palette, kind, bits, descriptor) = (header[1], header[2], header[16], header[17]);
    let depths: &[u8] = match kind {
        1 | 9 => &[8, 16],
        2 | 10 => &[15, 16, 24, 32],
        3 | 11 => &[8, 16],
        _ => return false,
    };
    let needs_palette = matches!(kind, 1 | 9);
    depths.contains(&bits) && palette <= 1 && (palette == 1 || !needs_palette) && descriptor < 64
}

/// An image as it was read.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageFile {
    /// Its pixels. Grey is repeated in all channels; alpha is left out, not multiplied in.
    pub image: Image,
    /// What the file was.
    pub format: ImageFormat,
    /// Pixels of which the file has a channel that is NaN or infinite.
    pub non_finite: usize,
}

/// Reads an image as linear colours; bytes are decoded with the curve of sRGB. Pixels that
/// are not finite stay as they are, and are counted.
pub fn read_image(path: &Path) -> Result<ImageFile, ImageError> {
    let read = || {
        let metadata = fs::metadata(path).map_err(ImageProblem::Read)?;
        if !metadata.is_file() {
            return Err(ImageProblem::NotAFile);
        }
        read_image_bytes(&fs::read(path).map_err(ImageProblem::Read)?)
    };
    read().map_err(|problem| ImageError { path: path.to_owned(), problem })
}

/// [`read_image`] of the contents of a file.
pub fn read_image_bytes(bytes: &[u8]) -> Result<ImageFile, ImageProblem> {
    let TextureFile { image: Pixmap { width, height, pixels, .. }, format, non_finite } =
        decode(bytes, false)?;
    let pixels = match pixels {
        Pixels::Linear(pixels) => pixels,
        coded => coded.iter().collect(),
    };
    Ok(ImageFile { image: Image { width, height, pixels }, format, non_finite })
}

/// An image as it was read for a texture.
#[derive(Clone, Debug, PartialEq)]
pub struct TextureFile {
    /// Its pixels, in bytes where the file has no more. Grey is repeated in all channels, colours are not multiplied by
    /// alpha. There is no alpha plane where all pixels are opaque.
    pub image: Pixmap,
    /// What the file was.
    pub format: ImageFormat,
    /// Pixels of which the file has a channel that is NaN or infinite.
    pub non_finite: usize,
}

/// Reads an image for use on a surface or as an environment. With `raw` the numbers of formats of 8 or 16
/// bits are taken as they are, from 0 to 1; without it they are decoded with the curve of sRGB. Alpha
/// is a number as it is. Pixels that are not finite become black, and are counted; opacities become zero.
pub fn read_texture(bytes: &[u8], raw: bool) -> Result<TextureFile, ImageProblem> {
    let mut file = decode(bytes, raw)?;
    if let Pixels::Linear(pixels) = &mut file.image.pixels {
        for pixel in pixels.iter_mut().filter(|p| !p.is_finite()) {
            *pixel = Rgb::BLACK;
        }
    }
    if let Some(Plane::Linear(alpha)) = &mut file.image.alpha {
        for value in alpha.iter_mut().filter(|v| !v.is_finite()) {
            *value = 0.0;
        }
    }
    Ok(file)
}

fn decode(bytes: &[u8], raw: bool) -> Result<TextureFile, ImageProblem> {
    let format = ImageFormat::of(bytes).ok_or_else(|| ImageProblem::unknown_format(bytes))?;
    let decoder = || match format {
        ImageFormat::Exr => read_exr::decode(bytes),
        ImageFormat::Pfm => read_pfm::decode(bytes).map(Pixmap::from),
        ImageFormat::Png | ImageFormat::Jpeg | ImageFormat::Hdr | ImageFormat::Tga | ImageFormat::Bmp => {
            raster::decode(bytes, format, raw)
        }
    };
    // The decoders are other people's code on other people's bytes: should one give up in a panic,
    // the file is to blame and the program lives on.
    let image = catch_unwind(AssertUnwindSafe(decoder))
        .unwrap_or_else(|_| Err(ImageProblem::Damaged { format, reason: "it makes no sense".to_owned() }))?;
    let non_finite = match &image.pixels {
        Pixels::Linear(pixels) => pixels.iter().filter(|p| !p.is_finite()).count(),
        Pixels::Grey(..) | Pixels::Color(..) => 0,
    };
    Ok(TextureFile { image, format, non_finite })
}
