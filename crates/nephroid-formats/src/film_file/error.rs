use std::fmt;
use std::io::{self, ErrorKind};
use std::path::PathBuf;

use super::VERSION;
use crate::image::{ImageFormat, ImageProblem, MAX_PIXELS, MAX_SIDE};

/// What went wrong with which film file.
#[derive(Debug, thiserror::Error)]
#[error("{}: {problem}", path.display())]
pub struct FilmFileError {
    /// The file, as it was named by the caller.
    pub path: PathBuf,
    /// What went wrong.
    #[source]
    pub problem: FilmFileProblem,
}

/// What went wrong with a film file.
#[derive(Debug, thiserror::Error)]
pub enum FilmFileProblem {
    /// The file cannot be opened or read.
    #[error("cannot be read: {0}")]
    Read(#[source] io::Error),
    /// The file cannot be made, written or put in its place. What was there before is as it was.
    #[error("{problem}{}", advice(problem))]
    Write {
        /// In the words for all files.
        #[source]
        problem: ImageProblem,
    },
    /// A folder, a device or the like.
    #[error("is not a file")]
    NotAFile,
    /// The first bytes are not those of a film file.
    #[error("is {found}, not a film file")]
    NotAFilm {
        /// What it looks like, with its article.
        found: String,
    },
    /// Written by a later program.
    #[error(
        "has version {version} of the format, but this program reads up to {VERSION}: use the program that wrote it, or a newer one"
    )]
    TooNew {
        /// The file's version.
        version: u32,
    },
    /// Written by an earlier program.
    #[error(
        "has version {version} of the format, but this program reads from {VERSION} on: use the program that wrote it, or render again"
    )]
    TooOld {
        /// The file's version.
        version: u32,
    },
    /// The file ends too early.
    #[error("is cut off: it ends after {at} bytes, before it is complete; copy it again, or render again")]
    CutOff {
        /// Length of the file.
        at: u64,
    },
    /// Bytes are not as they were written.
    #[error("is damaged: {section} are not as they were written; copy the file again, or render again")]
    Damaged {
        /// Where.
        section: Section,
    },
    /// The file goes on after its end.
    #[error("is damaged: {bytes} bytes follow its end")]
    Trailing {
        /// How many.
        bytes: usize,
    },
    /// The checksum is right, but the contents are not.
    #[error("makes no sense: {section} cannot be understood")]
    Nonsense {
        /// Where.
        section: Section,
    },
    /// A header that does not say what it should.
    #[error("makes no sense: in its header, {0}")]
    Header(String),
    /// More pixels than are ever read or written, or none.
    #[error(
        "is of {width}×{height} pixels; from 1 to {MAX_SIDE} on a side and {MAX_PIXELS} in all are possible"
    )]
    Size {
        /// Of the film, or as a file declares it.
        width: u64,
        /// Of the film, or as a file declares it.
        height: u64,
    },
    /// A value beside the picture of which nothing is known here.
    #[error("has the values `{0}`, which this program does not know: use the one that wrote it")]
    UnknownAov(String),
    /// Two films of different renders.
    #[error("does not belong together with {}: {}", other.display(), differences.join("; "))]
    Differs {
        /// The other film.
        other: PathBuf,
        /// In words.
        differences: Vec<String>,
    },
    /// Two films that hold the same samples.
    #[error(
        "has {} in common with {}: what is in both would count twice; leave one of them out",
        passes(*first_pass, *last_pass),
        other.display()
    )]
    Overlap {
        /// The other film.
        other: PathBuf,
        /// The first pass of which both have samples, counted from 0.
        first_pass: u64,
        /// The last of those in a row.
        last_pass: u64,
    },
}

/// A part of a film file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Section {
    /// What the file says about itself.
    Header,
    /// The picture's sums of some pixels.
    Picture {
        /// The first of them.
        first: usize,
        /// The last.
        last: usize,
    },
    /// The sums of further values of some pixels.
    Values {
        /// The first of them.
        first: usize,
        /// The last.
        last: usize,
    },
    /// The mark at the end.
    End,
}

impl fmt::Display for Section {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Header => write!(f, "the bytes of its header"),
            Self::Picture { first, last } => write!(f, "the picture's pixels {first} to {last}"),
            Self::Values { first, last } => write!(f, "the further values of pixels {first} to {last}"),
            Self::End => write!(f, "the last bytes"),
        }
    }
}

impl FilmFileProblem {
    /// For a file that does not start as a film.
    pub(super) fn not_a_film(bytes: &[u8]) -> Self {
        let found = match ImageFormat::of(bytes) {
            Some(ImageFormat::Exr) => "an OpenEXR image".to_owned(),
            Some(format) => format!("a {} image", format.name()),
            None if bytes.starts_with(b"<") => "an XML file, perhaps a scene".to_owned(),
            None => match ImageProblem::unknown_format(bytes) {
                ImageProblem::UnknownFormat { found } => found.to_owned(),
                other => other.to_string(),
            },
        };
        Self::NotAFilm { found }
    }
}

fn passes(first: u64, last: u64) -> String {
    if first == last { format!("pass {first}") } else { format!("passes {first} to {last}") }
}

/// What can be done about a file that could not be written.
fn advice(problem: &ImageProblem) -> &'static str {
    let ImageProblem::Write(error) = problem else { return "" };
    match error.kind() {
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => "; free some space, or write elsewhere",
        ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => {
            "; write to a folder in which files may be made"
        }
        _ => "",
    }
}
