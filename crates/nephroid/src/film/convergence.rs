//! How far apart the estimates of a picture are, as a few numbers that go with its film.

use super::light::Lights;
use super::pixel::{PixelSum, PixelTotal, luminance};
use super::{Film, Pixels};

/// Σ q counts in steps of 2^−64, which are below the rounding of any q that matters.
const SUM_BITS: f64 = 64.0;

/// Σ (Δ ln q)² counts in steps of 2^−40 …
const SPREAD_BITS: f64 = 40.0;

/// … and no difference counts for more than that.
const LARGEST: f64 = 64.0;

/// How far each step of a render was from the mean of those before, relative to the light and over the whole picture:
///
/// ```text
/// q_n = mean over pixels of (x_n − ā_(n−1))² / d · W_(n−1)/W_n
/// ```
///
/// with the luminances x of the step, ā before it, d as for [`Quality`](super::Quality) and the weights W so far. Its mean
/// is the squared error of one step. How much it jumps from one step to the next tells how much a squared error of
/// such pictures scatters: pixels that share photons err together, and a few bright samples may make all of it.
///
/// Whenever the film has a power of two of steps, it is also held against what it was at half of them:
///
/// ```text
/// ρ = mean over pixels of (ā_m − ā_2m)² / d  over  mean of the variance of ā_2m / d
/// ```
///
/// is 1 if the halves are independent. Samples of a pixel that go on from one another are more evenly spread the more of
/// them there are, and ρ is less.
///
/// What is kept are whole numbers, so [merging](Self::merge) parts of a render gives the same in any order. They go
/// with the film wherever it goes, by [`Self::numbers`] into a file, and back by
/// [`Session::with_convergence`](crate::session::Session::with_convergence): a render that was interrupted then states the
/// same as one that was not.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Convergence {
    steps: u64,
    sum: u128,
    differences: u64,
    spread: u64,
    /// Bits of the last q; 0 if the next one follows upon none.
    last: u64,
    /// Iterations of the film when it was marked; 0 if it is not, or was merged since.
    marked: u64,
    /// Estimates of a pixel when halves were compared for the last time; 0 if they never were.
    compared: u64,
    /// Bits of ln ρ as it was then.
    ln_ratio: u64,
}

impl Convergence {
    /// How many numbers it is.
    pub const NUMBERS: usize = 9;

    /// All that it is, for a file.
    pub fn numbers(&self) -> [u64; Self::NUMBERS] {
        let &Self { steps, sum, differences, spread, last, marked, compared, ln_ratio } = self;
        [steps, (sum >> 64) as u64, sum as u64, differences, spread, last, marked, compared, ln_ratio]
    }

    /// From what [`Self::numbers`] gave.
    pub fn from_numbers(numbers: [u64; Self::NUMBERS]) -> Self {
        let [steps, high, low, differences, spread, last, marked, compared, ln_ratio] = numbers;
        let sum = u128::from(high) << 64 | u128::from(low);
        Self { steps, sum, differences, spread, last, marked, compared, ln_ratio }
    }

    /// Adds that of another part of the render, whose film is merged into this one's.
    pub fn merge(&mut self, other: &Self) {
        if *other == Self::default() {
            return;
        }
        if *self == Self::default() {
            *self = *other;
            return;
        }
        self.steps = self.steps.saturating_add(other.steps);
        self.sum = self.sum.saturating_add(other.sum);
        self.differences = self.differences.saturating_add(other.differences);
        self.spread = self.spread.saturating_add(other.spread);
        // What follows upon the sum of both is comparable with neither.
        (self.last, self.marked) = (0, 0);
        let comparison = |c: &Self| (c.compared, c.ln_ratio);
        (self.compared, self.ln_ratio) = comparison(self).max(comparison(other));
    }

    /// Steps that were compared with those before: the first of a film is not.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// The mean of q, the squared relative error of one step; 0 without steps.
    pub fn mean(&self) -> f64 {
        self.sum as f64 * libm::exp2(-SUM_BITS) / self.steps.max(1) as f64
    }

    /// Differences between successive q that [`Self::log_variance`] is the mean of.
    pub fn differences(&self) -> u64 {
        self.differences
    }

    /// The variance of ln q, from its jumps, so that a q which drifts does not count as one that scatters. 0 without
    /// differences.
    pub fn log_variance(&self) -> f64 {
        self.spread as f64 * libm::exp2(-SPREAD_BITS) / self.differences.max(1) as f64
    }

    /// Estimates of a pixel when halves were compared for the last time, and ln ρ as it was then. `None` if they never were.
    pub fn ln_ratio(&self) -> Option<(u64, f64)> {
        let value = f64::from_bits(self.ln_ratio);
        (self.compared > 0 && value.is_finite()).then_some((self.compared, value))
    }

    /// Takes a step in that was just added to the film: `sums(pixel)` is what it brought. Marks the film if it is time.
    pub fn add<'s>(&mut self, film: &mut Film, pixels: Pixels, sums: impl Fn(usize) -> &'s PixelSum + Sync) {
        let compares = film.iterations().is_power_of_two();
        if !compares && pixels == Pixels::Apart {
            return;
        }
        let lights = Lights::of(film);
        if pixels == Pixels::Together {
            let terms = |pixel: usize| off_sq(&film.pixels()[pixel], lights.means[pixel], sums(pixel));
            if let Some(q) = lights.mean(terms) {
                self.push(q);
            }
        }
        if compares {
            self.compare(film, &lights);
            film.mark();
            self.marked = film.iterations();
        }
    }

    /// Compares the film with what it was at half of its iterations.
    fn compare(&mut self, film: &Film, lights: &Lights) {
        if self.marked.checked_mul(2) != Some(film.iterations()) {
            return;
        }
        let off_sq = |pixel: usize| {
            let off = film.pixels()[pixel].mean_at_half(film.unit()) - lights.means[pixel];
            lights.variances[pixel].is_finite().then_some(off * off)
        };
        let variance = |pixel: usize| Some(lights.variances[pixel]).filter(|variance| variance.is_finite());
        let estimates = film.pixels().iter().map(|pixel| pixel.samples).max().unwrap_or(0);
        if let (Some(found), Some(told)) = (lights.mean(off_sq), lights.mean(variance))
            && found > 0.0
            && told > 0.0
        {
            self.compared = u64::from(estimates);
            self.ln_ratio = libm::log(found / told).to_bits();
        }
    }

    fn push(&mut self, q: f64) {
        // The conversions saturate.
        self.sum = self.sum.saturating_add((q * libm::exp2(SUM_BITS)) as u128);
        self.steps += 1;
        if self.last != 0 && q > 0.0 {
            let jump = libm::log(q / f64::from_bits(self.last));
            let term = (0.5 * jump * jump).min(LARGEST);
            self.spread = self.spread.saturating_add((term * libm::exp2(SPREAD_BITS)) as u64);
            self.differences += 1;
        }
        self.last = if q > 0.0 { q.to_bits() } else { 0 };
    }
}

/// (x_n − ā_(n−1))² · W_(n−1)/W_n of a pixel whose mean is now ā_n; nothing if the step was left out of the film, or is the
/// first.
fn off_sq(total: &PixelTotal, mean: f64, sum: &PixelSum) -> Option<f64> {
    let weight = total.weight();
    let before = weight - sum.weight;
    if !(sum.is_usable() && sum.weight > 0.0 && before > 0.0) {
        return None;
    }
    // (x_n − ā_(n−1)) is (x_n − ā_n) W_n/W_(n−1).
    let off = luminance(sum.radiance) / sum.weight - mean;
    Some(off * off * (weight / before))
}
