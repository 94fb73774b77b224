//! What can go wrong with somebody else's library.

use std::path::PathBuf;

use thiserror::Error;

/// Why there is no denoiser.
#[derive(Debug, Error)]
pub enum LoadError {
    /// It is in none of the places where it was looked for.
    #[error("Open Image Denoise 2 is not found{}", besides(.refused))]
    NotFound {
        /// Libraries that were found, and cannot be used.
        refused: Vec<LoadError>,
    },
    /// There is no such file.
    #[error("{}: there is no such library", .0.display())]
    NoFile(PathBuf),
    /// The file is no library for this machine, or lacks what it needs.
    #[error("{}: cannot be loaded: {reason}", file.display())]
    NotLoaded {
        /// The library.
        file: PathBuf,
        /// What the system says.
        reason: String,
    },
    /// It is another library, or another version.
    #[error("{}: is not Open Image Denoise 2: it has no function {function}", file.display())]
    OtherLibrary {
        /// The library.
        file: PathBuf,
        /// What it does not have.
        function: &'static str,
    },
    /// It does not work on this machine.
    #[error("{}: does not work here: {reason}", file.display())]
    NotUsable {
        /// The library.
        file: PathBuf,
        /// What it says.
        reason: String,
    },
}

fn besides(refused: &[LoadError]) -> String {
    let list: Vec<String> = refused.iter().map(ToString::to_string).collect();
    if list.is_empty() { String::new() } else { format!(" ({})", list.join("; ")) }
}

/// Why a picture was not denoised.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum DenoiseError {
    /// A layer does not have three numbers for each pixel.
    #[error("{layer} has {numbers} numbers for {width} by {height} pixels")]
    Size {
        /// Which.
        layer: &'static str,
        /// What it has.
        numbers: usize,
        /// Pixels in a row of the picture.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// The library gave up.
    #[error("Open Image Denoise: {0}")]
    Library(String),
}
