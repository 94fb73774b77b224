//! The error of a picture, as the picture itself tells it.

use super::pixel::PixelTotal;
use super::{Convergence, Film};

/// Of the squared mean luminance: it keeps dark pixels, whose relative error nobody sees, from counting most.
const DARK: f64 = 0.01;

/// The fewest estimates of a pixel from which their spread is told.
const FEWEST: u64 = 4;

/// How far a picture a is from the truth t:
///
///     E = sqrt(mean over pixels of (a − t)² / (t² + (m/10)²))
///
/// with luminances, of which m is the mean over the picture. It is told from the render itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quality {
    /// What E is expected to be.
    pub error: f64,
    /// Where E lies with a probability of 90 %.
    pub interval: [f64; 2],
    /// The part of it that is noise, by itself.
    pub noise: f64,
    /// The part of it that is bias, by itself; 0 for methods without.
    pub bias: f64,
    /// Independent estimates of each pixel.
    pub estimates: u64,
}

impl Quality {
    /// That of a film, whose variance must be that of all it has of noise: it is not with the
    /// [photon mapper](crate::integrator::Method::PhotonMapper). `None` if there are too few estimates, or no light.
    pub fn of(film: &Film, convergence: &Convergence) -> Option<Self> {
        let estimates = film.pixels().iter().map(|pixel| u64::from(pixel.samples)).max()?;
        if estimates < FEWEST {
            return None;
        }
        let (mut sum, mut count) = (0.0, 0u64);
        for noise_sq in noise_sq(film) {
            sum += noise_sq;
            count += 1;
        }
        if count == 0 {
            return None;
        }
        let noise = libm::sqrt(sum / count as f64);
        let scatter = if convergence.differences() < 2 { 1.0 } else { convergence.log_variance() };
        let spread = libm::exp(1.645 * 0.5 * libm::sqrt(scatter * (1.0 + 1.0 / estimates as f64)));
        Some(Self { error: noise, interval: [noise / spread, noise * spread], noise, bias: 0.0, estimates })
    }
}

/// The squared relative error of each pixel that has two estimates.
fn noise_sq(film: &Film) -> impl Iterator<Item = f64> {
    let floor = floor(film);
    film.pixels().iter().filter_map(move |pixel| relative(pixel, film.unit(), floor))
}

fn floor(film: &Film) -> f64 {
    let mean = film.mean_luminance();
    DARK * mean * mean
}

fn relative(pixel: &PixelTotal, unit: i32, floor: f64) -> Option<f64> {
    let variance = pixel.variance(unit);
    let divisor = pixel.light_sq(unit) + floor;
    (variance.is_finite() && divisor > 0.0).then(|| variance / divisor)
}

impl Film {
    /// The relative error that each pixel is expected to have, row by row: the root of what [`Quality::error`] has the mean
    /// of. 0 where it cannot be told.
    pub fn relative_errors(&self) -> Vec<f32> {
        let floor = floor(self);
        let error = |pixel| relative(pixel, self.unit(), floor).map_or(0.0, libm::sqrt) as f32;
        self.pixels().iter().map(error).collect()
    }
}
