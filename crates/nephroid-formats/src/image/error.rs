use std::io;
use std::path::PathBuf;

use super::ImageFormat;
use super::limits::{MAX_PIXELS, MAX_SIDE};

/// What went wrong with which file.
#[derive(Debug, thiserror::Error)]
#[error("{}: {problem}", path.display())]
pub struct ImageError {
    /// The file, as it was named by the caller.
    pub path: PathBuf,
    /// What went wrong.
    #[source]
    pub problem: ImageProblem,
}

/// What went wrong with an image.
#[derive(Debug, thiserror::Error)]
pub enum ImageProblem {
    /// The file cannot be opened or read.
    #[error("cannot be read: {0}")]
    Read(#[source] io::Error),
    /// The file cannot be made, written or put in its place.
    #[error("cannot be written: {0}")]
    Write(#[source] io::Error),
    /// The folder that the file should be in does not exist.
    #[error("cannot be written: there is no folder {}", folder.display())]
    NoFolder {
        /// The missing folder.
        folder: PathBuf,
    },
    /// A folder, a device or the like.
    #[error("is not a file")]
    NotAFile,
    /// The file exists and is protected against writing.
    #[error("cannot be written: it exists and is read-only")]
    ReadOnly,
    /// The first bytes are of no format that can be read.
    #[error("is {found}; images can be OpenEXR, PNG, JPEG, Radiance HDR, TGA, BMP or PFM files")]
    UnknownFormat {
        /// What it looks like, with its article.
        found: &'static str,
    },
    /// Width or height is zero.
    #[error("has no pixels")]
    NoPixels,
    /// More pixels than are ever read.
    #[error("has {width}×{height} pixels; at most {MAX_SIDE} on a side and {MAX_PIXELS} in all are possible")]
    TooLarge {
        /// As declared.
        width: u64,
        /// As declared.
        height: u64,
    },
    /// More pixels than the format can hold in so short a file.
    #[error(
        "claims to have {width}×{height} pixels, which do not fit into its {bytes} bytes: it is cut off or damaged"
    )]
    TooShort {
        /// As declared.
        width: u64,
        /// As declared.
        height: u64,
        /// Length of the file.
        bytes: usize,
    },
    /// The contents break the rules of the format, or end early.
    #[error("is cut off or damaged: as a {} file, {reason}", format.name())]
    Damaged {
        /// What the file starts as.
        format: ImageFormat,
        /// In the decoder's words.
        reason: String,
    },
    /// The format allows it, but it is not supported.
    #[error("uses a feature of {} that is not supported: {feature}", format.name())]
    NotSupported {
        /// What the file is.
        format: ImageFormat,
        /// In the decoder's words.
        feature: String,
    },
    /// An OpenEXR file without colour or luminance.
    #[error("has neither channels R, G, B nor a channel Y, only {found}")]
    NoColour {
        /// The channels it has.
        found: String,
    },
    /// Layers that cannot be written into one file.
    #[error("cannot be written: {0}")]
    BadLayers(String),
}

impl ImageProblem {
    /// For a file that starts as none of the formats that can be read.
    pub(crate) fn unknown_format(bytes: &[u8]) -> Self {
        const KNOWN: [(&[u8], &str); 6] = [
            (b"P6", "a PPM image"),
            (b"GIF8", "a GIF image"),
            (b"II*\0", "a TIFF image"),
            (b"MM\0*", "a TIFF image"),
            (b"RIFF", "a RIFF file, perhaps a WebP image"),
            (b"DDS ", "a DDS image"),
        ];
        let known = KNOWN.into_iter().find(|(magic, _)| bytes.starts_with(magic));
        let found = match known {
            _ if bytes.is_empty() => "an empty file",
            Some((_, found)) => found,
            None => "of no format that is known here",
        };
        Self::UnknownFormat { found }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unknown_formats_are_named_where_possible() {
        let message = |bytes: &[u8]| ImageProblem::unknown_format(bytes).to_string();
        let supported = "; images can be OpenEXR, PNG, JPEG, Radiance HDR, TGA, BMP or PFM files";
        assert_eq!(message(b""), format!("is an empty file{supported}"));
        assert_eq!(message(b"GIF89a"), format!("is a GIF image{supported}"));
        assert_eq!(message(b"hello"), format!("is of no format that is known here{supported}"));
    }

    #[test]
    fn errors_name_the_file() {
        let error = ImageError { path: "a/b.png".into(), problem: ImageProblem::NoPixels };
        assert_eq!(error.to_string(), "a/b.png: has no pixels");
    }
}
