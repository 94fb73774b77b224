//! The sums of one pixel.

use super::fixed::{self, RADIANCE, WEIGHT};
use crate::color::Rgb;

/// What one iteration found for one pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PixelSum {
    /// Σ w·L per channel, in W/(m²·sr).
    pub radiance: [f64; 3],
    /// Σ (w·Y)² over the independent estimates, where Y is the luminance.
    pub luminance_sq: f64,
    /// Σ w, the weights of the reconstruction filter.
    pub weight: f64,
    /// Estimates that the variance counts as independent. Samples of a progressive iteration and of a step of light
    /// tracing make one together: see [`PixelSum::as_one_estimate`]. Those of the photon mapper count each, though
    /// they share the photons of a map.
    pub samples: u32,
    /// Σ w·D of progressive estimates, where D is the luminance that half of their squared radius would take away: half of
    /// their bias. See [`Quality::bias`](super::Quality::bias).
    pub blur: f64,
}

impl PixelSum {
    /// Adds an independent sample of weight `weight`.
    #[inline]
    pub fn add(&mut self, radiance: Rgb, weight: f32) {
        let weight = f64::from(weight);
        let weighted = radiance.to_array().map(|v| weight * f64::from(v));
        for (sum, v) in self.radiance.iter_mut().zip(weighted) {
            *sum += v;
        }
        let y = luminance(weighted);
        self.luminance_sq += y * y;
        self.weight += weight;
        self.samples += 1;
    }

    /// Adds what half of the squared radius would take away from the luminance of a sample.
    #[inline]
    pub fn add_blur(&mut self, luminance: f32, weight: f32) {
        self.blur += f64::from(weight) * f64::from(luminance);
    }

    /// The same light, counted as a single estimate: for samples of one iteration that are
    /// correlated because they gather from the same photons.
    pub fn as_one_estimate(self) -> Self {
        let y = luminance(self.radiance);
        Self { luminance_sq: y * y, samples: self.samples.min(1), ..self }
    }

    /// Whether it can be added to a film.
    pub(super) fn is_usable(&self) -> bool {
        self.radiance.iter().all(|v| v.is_finite())
            && self.weight.is_finite()
            && self.luminance_sq.is_finite()
            && self.luminance_sq >= 0.0
    }
}

/// The exact sums of one pixel over all iterations, in fixed point: see [`Film`](super::Film).
///
/// The bits of each are as many as a file keeps, and sums end there.
#[derive(Clone, Copy, Debug, Default)]
pub struct PixelTotal {
    /// Σ w·L per channel in 96 bits, in steps of 2^−48 units.
    pub radiance: [i128; 3],
    /// Σ (w·Y)² in 96 bits, in steps of 2^−40 units squared. At its largest value it is saturated.
    pub luminance_sq: u128,
    /// Σ w, in steps of 2^−32.
    pub weight: i64,
    /// Independent estimates.
    pub samples: u32,
    /// Σ w·D in 96 bits, in steps of 2^−48 units: see [`PixelSum::blur`].
    pub blur: i128,
    /// Σ (Σ w·D)² over iterations in 96 bits, in steps of 2^−40 units squared.
    pub blur_sq: u128,
    /// Σ w·Y in 96 bits, in steps of 2^−48 units, as it was when the film had a power of two of iterations for the last time:
    /// see [`Convergence`](super::Convergence). A note that depends on how a render was shared out, and so none of what is
    /// compared.
    pub mark: i128,
}

impl PartialEq for PixelTotal {
    fn eq(&self, other: &Self) -> bool {
        let sums = |t: &Self| (t.radiance, t.luminance_sq, t.weight, t.samples, t.blur, t.blur_sq);
        sums(self) == sums(other)
    }
}

impl Eq for PixelTotal {}

impl PixelTotal {
    /// Rounds one iteration's sums, each once, and counts how many had to be cut.
    pub(super) fn from_sum(sum: &PixelSum, unit: i32) -> (Self, u64) {
        let [r, g, b] = sum.radiance.map(|v| RADIANCE.term(v, unit));
        let square = fixed::square(sum.luminance_sq, unit);
        let weight = WEIGHT.term(sum.weight, 0);
        // It is no part of the picture, which no fault of it may change.
        let blur = if sum.blur.is_finite() { sum.blur } else { 0.0 };
        let cut = [r.1, g.1, b.1, weight.1, square.1].into_iter().filter(|&cut| cut).count();
        let total = Self {
            radiance: [r.0, g.0, b.0],
            luminance_sq: square.0,
            // It is within 48 bits.
            weight: weight.0 as i64,
            samples: sum.samples,
            blur: RADIANCE.term(blur, unit).0,
            blur_sq: fixed::square(blur * blur, unit).0,
            mark: 0,
        };
        (total, cut as u64)
    }

    pub(super) fn add(&mut self, other: &Self) {
        for (sum, v) in self.radiance.iter_mut().zip(other.radiance) {
            *sum = RADIANCE.sum(*sum, v);
        }
        self.luminance_sq = fixed::sum_of_squares(self.luminance_sq, other.luminance_sq);
        self.weight = self.weight.saturating_add(other.weight);
        self.samples = self.samples.saturating_add(other.samples);
        self.blur = RADIANCE.sum(self.blur, other.blur);
        self.blur_sq = fixed::sum_of_squares(self.blur_sq, other.blur_sq);
        self.mark = RADIANCE.sum(self.mark, other.mark);
    }

    /// Whether each sum has no more bits than it may.
    pub(super) fn is_in_bounds(&self) -> bool {
        self.radiance.iter().chain([&self.blur, &self.mark]).all(|v| RADIANCE.holds(*v))
            && [self.luminance_sq, self.blur_sq].iter().all(|v| *v <= fixed::SATURATED_SQUARE)
    }

    /// Σ wL / Σ w; black where the weights sum to zero.
    pub(super) fn mean(&self, unit: i32) -> [f64; 3] {
        if self.weight == 0 {
            return [0.0; 3];
        }
        let weight = self.weight();
        self.radiance.map(|v| RADIANCE.value(v, unit) / weight)
    }

    /// Keeps Σ w·Y as it is now.
    pub(super) fn set_mark(&mut self) {
        let [r, g, b] = self.radiance;
        self.mark = (2_126 * r + 7_152 * g + 722 * b) / 10_000;
    }

    /// Luminance of the mean when the weight was half of what it is.
    pub(super) fn mean_at_half(&self, unit: i32) -> f64 {
        if self.weight == 0 { 0.0 } else { 2.0 * RADIANCE.value(self.mark, unit) / self.weight() }
    }

    /// Variance of the mean's luminance: n/(n−1) · (Σ X² − (Σ X)²/n) / (Σ w)², X = w·Y. Where the squares of
    /// light are all too small to be told from 0, it is unknown.
    pub(super) fn variance(&self, unit: i32) -> f64 {
        let sum = luminance(self.radiance.map(|v| RADIANCE.value(v, unit)));
        self.variance_of(sum, self.luminance_sq, unit)
    }

    fn variance_of(&self, sum: f64, squares: u128, unit: i32) -> f64 {
        if self.samples < 2 || self.weight == 0 || (squares == 0 && sum != 0.0) {
            return f64::INFINITY;
        }
        let n = f64::from(self.samples);
        let spread = (fixed::square_value(squares, unit) - sum * sum / n).max(0.0);
        let weight = self.weight();
        n / (n - 1.0) * spread / (weight * weight)
    }

    /// The square of the mean's bias, as far as it is known: of twice the mean of D, less what noise adds to it. Below zero
    /// where that is more.
    pub(super) fn bias_sq(&self, unit: i32) -> f64 {
        if self.blur_sq == 0 || self.weight == 0 {
            return 0.0;
        }
        let half = RADIANCE.value(self.blur, unit) / self.weight();
        4.0 * (half * half - self.blur_variance(unit))
    }

    /// The variance of the mean of D; 0 where there is none.
    pub(super) fn blur_variance(&self, unit: i32) -> f64 {
        if self.blur_sq == 0 {
            return 0.0;
        }
        self.variance_of(RADIANCE.value(self.blur, unit), self.blur_sq, unit)
    }

    pub(super) fn weight(&self) -> f64 {
        WEIGHT.value(i128::from(self.weight), 0)
    }
}

/// Relative luminance in double precision, as [`Rgb::luminance`].
pub(super) fn luminance([r, g, b]: [f64; 3]) -> f64 {
    0.212_6 * r + 0.715_2 * g + 0.072_2 * b
}
