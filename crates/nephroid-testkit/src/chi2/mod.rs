//! χ² tests of samplers against the densities that they claim.
//!
//! The domain is cut into cells, the density is integrated over each, and the counts of samples are compared with
//! what the integrals predict.

mod cells;
mod goodness;
mod mappings;

use crate::{Integral, Outcome, Tolerance};
use cells::Grid;
pub use goodness::goodness_of_fit;
use goodness::{compare, too_many};
pub use mappings::{DiskTest, SphereTest};

/// A rectangle of sample coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Domain {
    /// Lower corner.
    pub min: [f64; 2],
    /// Upper corner, itself inside.
    pub max: [f64; 2],
}

impl Domain {
    /// The square [0, 1]².
    pub const UNIT_SQUARE: Self = Self { min: [0.0, 0.0], max: [1.0, 1.0] };

    /// Whether a point is inside; never for coordinates that are NaN.
    #[must_use]
    pub fn contains(&self, point: [f64; 2]) -> bool {
        (0..2).all(|axis| (self.min[axis]..=self.max[axis]).contains(&point[axis]))
    }
}

/// A χ² test on a rectangle. For directions and disks see [`SphereTest`] and [`DiskTest`], which map to one.
///
/// The default is 400 000 samples on 12 × 24 cells of the unit square. A density that is too large by 3 % over half
/// of the domain and too small by 3 % over the rest then has a p-value of 1e-20 or less; with 2 % it is still below
/// 1e-4, and with 1 % every second run passes. A run takes some 50 ms and 10⁵ evaluations of a smooth density.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChiSquareTest {
    /// The rectangle. What the sampler puts outside is compared with what the density leaves for outside.
    pub domain: Domain,
    /// Number of samples tested. A sixteenth as many again is drawn before, to place the cells.
    pub samples: usize,
    /// Number of cells along each axis. More cells see finer detail, fewer see smaller differences.
    pub resolution: [usize; 2],
}

impl Default for ChiSquareTest {
    fn default() -> Self {
        Self { domain: Domain::UNIT_SQUARE, samples: 400_000, resolution: [12, 24] }
    }
}

/// The probability by which a density may exceed 1 in total, for rounding and approximation of its constants.
const EXCESS: f64 = 1e-3;

impl ChiSquareTest {
    /// Tests whether `sample` follows `density` (per unit area of the domain's coordinates).
    ///
    /// A sample that is `None`, outside the domain or NaN counts as outside, which is a cell of its own with the
    /// expectation 1 − ∫ density: a sampler that fails with some probability, or a density over part of its
    /// range only, are tested as they are. Rejected outright (p = 0) are densities that are negative, NaN or
    /// integrate to more than 1, and more than some 1e-5 of the samples in places where the density vanishes.
    ///
    /// Half of the cell boundaries are equidistant, half are quantiles of a first run of the sampler, so that a
    /// lobe far narrower than a cell is cut into cells as well; the samples also show the quadrature where to
    /// look. What may still be missed is a density concentrated along a curve oblique to the axes.
    pub fn run(
        &self,
        mut sample: impl FnMut() -> Option<[f64; 2]>,
        density: impl Fn([f64; 2]) -> f64,
    ) -> Outcome {
        let domain = self.domain;
        let mut inside = |count: usize| -> Vec<[f64; 2]> {
            (0..count).filter_map(|_| sample()).filter(|&point| domain.contains(point)).collect()
        };
        let grid = Grid::new(domain, self.resolution, &inside(self.samples / 16));
        let cells = grid.sort(&inside(self.samples));
        let n = self.samples as f64;
        // A hundredth of a count, or of the noise of a cell with ten thousand.
        let tolerance = Tolerance { absolute: 0.01 / n, relative: 1e-4 };
        let integrals: Vec<Integral> = cells
            .iter()
            .enumerate()
            .map(|(i, points)| grid.integrate(i, points, &density, tolerance))
            .collect();
        let observed: Vec<u64> = cells.iter().map(|points| points.len() as u64).collect();
        self.judge(&grid, observed, &integrals)
    }

    fn judge(&self, grid: &Grid, mut observed: Vec<u64>, integrals: &[Integral]) -> Outcome {
        let n = self.samples as f64;
        let (total, error) = integrals.iter().fold((0.0, 0.0), |(v, e), i| (v + i.value, e + i.error));
        let mut expected: Vec<f64> = integrals.iter().map(|integral| n * integral.value).collect();
        expected.push(n * (1.0 - total).max(0.0));
        let outside = self.samples as u64 - observed.iter().sum::<u64>();
        observed.push(outside);

        let fault = if let Some(i) = integrals.iter().position(|i| !i.value.is_finite() || i.value < 0.0) {
            Some(format!("the density integrates to {} over {}", integrals[i].value, grid.describe(i)))
        } else if total > 1.0 + EXCESS + error {
            Some("the density integrates to more than 1".to_owned())
        } else if too_many(outside, n * ((1.0 - total).max(0.0) + error), self.samples as u64) {
            Some("more samples fail or lie outside than the density leaves room for".to_owned())
        } else {
            None
        };
        let mut outcome = compare(&observed, &expected, |i| grid.describe(i));
        let summary = format!(
            "{n} samples; the density integrates to {total:.6} ± {error:.1e}; outside {outside} of {:.1} expected",
            expected[expected.len() - 1],
        );
        outcome.details = format!("{summary}\n{}", outcome.details);
        if let Some(fault) = fault {
            outcome.p_value = 0.0;
            outcome.details = format!("{fault}\n{}", outcome.details);
        }
        outcome
    }
}

#[cfg(test)]
mod tests;
