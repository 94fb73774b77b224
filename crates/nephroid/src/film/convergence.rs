//! How far apart the estimates of a picture are, as a few numbers that go with its film.

use rayon::prelude::*;

use super::Film;
use super::pixel::{PixelSum, PixelTotal, luminance};

/// Pixels whose terms are summed one after another, so that the sum is the same on any number of threads.
const CHUNK: usize = 4096;

/// Σ q counts in steps of 2^−64, which are below the rounding of any q that matters.
const SUM_BITS: f64 = 64.0;

/// Σ (Δ ln q)² counts in steps of 2^−40 …
const SPREAD_BITS: f64 = 40.0;

/// … and no difference counts for more than that.
const LARGEST: f64 = 64.0;

/// How far each step of a render was from the mean of those before, relative to the light and over the whole picture:
///
///     q_n = mean over pixels of (x_n − ā_(n−1))² / d · W_(n−1)/W_n
///
/// with the luminances x of the step, ā before it, d as for [`Quality`](super::Quality) and the weights W so far. Its mean
/// is the squared error of one step. How much it jumps from one step to the next tells how much a squared error of
/// such pictures scatters: pixels that share photons err together, and a few bright samples may make all of it.
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
}

impl Convergence {
    /// How many numbers it is.
    pub const NUMBERS: usize = 6;

    /// All that it is, for a file.
    pub fn numbers(&self) -> [u64; Self::NUMBERS] {
        [self.steps, (self.sum >> 64) as u64, self.sum as u64, self.differences, self.spread, self.last]
    }

    /// From what [`Self::numbers`] gave.
    pub fn from_numbers([steps, high, low, differences, spread, last]: [u64; Self::NUMBERS]) -> Self {
        let sum = u128::from(high) << 64 | u128::from(low);
        Self { steps, sum, differences, spread, last }
    }

    /// Adds that of another part of the render, whose film is merged into this one's.
    pub fn merge(&mut self, other: &Self) {
        if other.steps == 0 {
            return;
        }
        if self.steps == 0 {
            *self = *other;
            return;
        }
        self.steps = self.steps.saturating_add(other.steps);
        self.sum = self.sum.saturating_add(other.sum);
        self.differences = self.differences.saturating_add(other.differences);
        self.spread = self.spread.saturating_add(other.spread);
        self.last = 0;
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

    /// Takes a step in that was just added to the film: `sums(pixel)` is what it brought.
    pub fn add<'s>(&mut self, film: &Film, sums: impl Fn(usize) -> &'s PixelSum + Sync) {
        let mean = film.mean_luminance();
        let unit = film.unit();
        let floor = 0.01 * mean * mean;
        let chunks: Vec<(f64, u64)> = film
            .pixels()
            .par_chunks(CHUNK)
            .enumerate()
            .map(|(chunk, totals)| {
                let mut found = (0.0, 0);
                for (i, total) in totals.iter().enumerate() {
                    if let Some(term) = term(total, sums(chunk * CHUNK + i), unit, floor) {
                        found.0 += term;
                        found.1 += 1;
                    }
                }
                found
            })
            .collect();
        let (sum, count) = chunks.into_iter().fold((0.0, 0), |(s, n), (term, count)| (s + term, n + count));
        if count > 0 {
            self.push(sum / count as f64);
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

/// What a pixel adds to q; nothing if it was left out of the film, or has no two steps.
fn term(total: &PixelTotal, sum: &PixelSum, unit: i32, floor: f64) -> Option<f64> {
    let weight = total.weight();
    let before = weight - sum.weight;
    if !sum.is_usable() || !(sum.weight > 0.0 && before > 0.0) {
        return None;
    }
    let mean = luminance(total.mean(unit));
    let off = luminance(sum.radiance) / sum.weight - mean;
    let divisor = total.light_sq(unit) + floor;
    // (x − ā_(n−1)) is (x − ā_n) W_n/W_(n−1).
    (divisor > 0.0).then(|| off * off * (weight / before) / divisor)
}
