//! The film: exact sums of radiance, reconstruction filters and tone mapping.

mod aov;
mod aov_film;
mod convergence;
mod error;
mod filter;
mod filter_sampler;
mod fixed;
mod light;
mod merge_error;
mod pixel;
mod quality;
#[cfg(test)]
mod quality_tests;
mod splatter;
mod sums;
#[cfg(test)]
mod sums_tests;
mod tonemap;
mod tonemap_name;

pub use aov::{Aov, AovSample};
pub use aov_film::{AovFilm, AovImage, AovSum};
pub use convergence::Convergence;
pub use error::{ImageError, SizeMismatch, difference_picture};
pub use filter::Filter;
pub use filter_sampler::{FilterSample, FilterSampler};
pub use merge_error::MergeError;
pub use pixel::{PixelSum, PixelTotal};
pub use quality::{Pixels, Quality};
pub(crate) use splatter::Splatter;
pub use sums::{Film, FilmCounts};
pub use tonemap::{Equalization, ToneMap, White};
pub use tonemap_name::ToneMapError;

/// Size and sampling of the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmSettings {
    /// Pixels in a row of the whole picture.
    pub width: u32,
    /// Rows of the whole picture.
    pub height: u32,
    /// The part that is rendered, if not all.
    pub crop: Option<Crop>,
    /// Reconstruction filter.
    pub filter: Filter,
}

/// A window of the whole picture, in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crop {
    /// First column.
    pub x: u32,
    /// First row.
    pub y: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl FilmSettings {
    /// The window that is rendered.
    pub fn window(&self) -> Crop {
        self.crop.unwrap_or(Crop { x: 0, y: 0, width: self.width, height: self.height })
    }
}
