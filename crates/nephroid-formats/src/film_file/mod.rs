//! Film files: a render's exact sums, to be continued or added up later.
//!
//! ```text
//! NEPHFILM, version            8 + 4 bytes
//! header                       a JSON object
//! picture                      blocks of 1024 pixels, row by row
//! further values               blocks of the same pixels, if there are any
//! FILM END                     8 bytes
//! ```
//!
//! Header and blocks each have their length and their checksum before them, 4 and 4 bytes. A block has a byte for
//! the width of each of its columns, and then the columns: of the picture those of red, green, blue, squares, weights,
//! estimates, blur, its squares and marks; of further values the three weights and all numbers, as [`AovFilm::sums`] has them. All numbers are
//! little-endian; a pixel of the picture takes 96 bytes at most.
//!
//! [`AovFilm::sums`]: nephroid::film::AovFilm::sums

mod columns;
mod covered;
mod error;
mod frame;
mod header;
mod identity;
mod merge;
mod read;
mod write;

#[cfg(test)]
mod damage_tests;
#[cfg(test)]
mod merge_tests;
#[cfg(test)]
mod tests;

use nephroid::film::{AovFilm, Film};

pub use covered::{Covered, Overlap};
pub use error::{FilmFileError, FilmFileProblem, Section};
pub use header::FilmHeader;
pub use identity::identity_differences;
pub use merge::FilmMerger;
pub use read::{read_film, read_film_bytes, read_header};
pub use write::{encode_film, write_film};

/// What a film file begins with.
const MAGIC: &[u8; 8] = b"NEPHFILM";

/// The version that is written, and the only one that can be read: squares of version 1 had fewer bits behind the point,
/// and version 2 knew nothing of how films converge.
const VERSION: u32 = 3;

/// Pixels of a block: they and their sums fit into a processor's second cache.
const BLOCK: usize = 1024;

/// A film file as it was read.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmFile {
    /// What it says about itself.
    pub header: FilmHeader,
    /// The picture's sums.
    pub film: Film,
    /// Sums of further values, if it has any.
    pub aovs: Option<AovFilm>,
}
