//! Tests of means.

use crate::Outcome;
use crate::special::student_two_sided;

/// Accumulates independent samples of an estimator and tests their mean.
///
/// The sums are Welford's (Technometrics 4, 1962), which lose nothing when the mean is large against the
/// deviation. The tests assume that the *mean* is nearly normal: estimators with rare, large values (fireflies)
/// need many samples or a batch mean for each sample, and will be rejected too often otherwise.
///
/// ```
/// use nephroid_testkit::{ALPHA, MeanTest, Pcg32};
///
/// let mut rng = Pcg32::new(1);
/// let estimates: MeanTest = (0..10_000).map(|_| 4.0 * (1.0 - rng.next_f64() * rng.next_f64())).collect();
/// estimates.against(3.0).assert_passes(ALPHA);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MeanTest {
    count: u64,
    mean: f64,
    /// Sum of the squared deviations from the mean.
    squares: f64,
}

impl MeanTest {
    /// An accumulator without samples.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds one sample.
    pub fn push(&mut self, sample: f64) {
        self.count += 1;
        let before = sample - self.mean;
        self.mean += before / self.count as f64;
        self.squares += before * (sample - self.mean);
    }

    /// Number of samples.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Mean of the samples.
    #[must_use]
    pub fn mean(&self) -> f64 {
        self.mean
    }

    /// Unbiased estimate of the variance of one sample; NaN for fewer than two.
    #[must_use]
    pub fn variance(&self) -> f64 {
        if self.count < 2 { f64::NAN } else { self.squares / (self.count - 1) as f64 }
    }

    /// Standard deviation of the mean.
    #[must_use]
    pub fn standard_error(&self) -> f64 {
        (self.variance() / self.count as f64).sqrt()
    }

    /// Tests whether the mean is `exact` (Student's t-test, two-sided; with many samples a Z-test).
    pub fn against(&self, exact: f64) -> Outcome {
        self.within(exact, 0.0)
    }

    /// Tests whether the mean lies within `relative_bias · |exact|` of `exact`.
    ///
    /// For estimators with a stated bias, and for those whose samples are constant up to rounding: without any
    /// noise to hide in, a single-precision sum is told from the exact value unless a few 1e-7 are allowed.
    pub fn within(&self, exact: f64, relative_bias: f64) -> Outcome {
        // Rounding of the accumulation itself is never held against an estimator.
        let allowance = (relative_bias + 64.0 * f64::EPSILON) * exact.abs();
        let dof = self.count.saturating_sub(1) as f64;
        let details = format!(
            "mean {:.9e} of {} samples, exact {exact:.9e}, relative difference {:.3e}, bias allowed {relative_bias:.1e}",
            self.mean,
            self.count,
            self.mean / exact - 1.0,
        );
        t_test("mean", self.mean - exact, allowance, self.standard_error(), dof, details)
    }

    /// Tests whether two independent estimators have the same mean (Welch's t-test, two-sided).
    ///
    /// Welch, "The generalization of Student's problem when several different population variances are involved",
    /// Biometrika 34 (1947).
    pub fn welch(&self, other: &Self) -> Outcome {
        let (a, b) = (self.variance() / self.count as f64, other.variance() / other.count as f64);
        let denominator = a * a / (self.count as f64 - 1.0) + b * b / (other.count as f64 - 1.0);
        let dof = if denominator == 0.0 { f64::INFINITY } else { (a + b) * (a + b) / denominator };
        let allowance = 64.0 * f64::EPSILON * self.mean.abs().max(other.mean.abs());
        let details = format!(
            "mean {:.9e} of {} samples against {:.9e} of {}",
            self.mean, self.count, other.mean, other.count
        );
        t_test("difference of means", self.mean - other.mean, allowance, (a + b).sqrt(), dof, details)
    }
}

impl Extend<f64> for MeanTest {
    fn extend<I: IntoIterator<Item = f64>>(&mut self, samples: I) {
        samples.into_iter().for_each(|sample| self.push(sample));
    }
}

impl FromIterator<f64> for MeanTest {
    fn from_iter<I: IntoIterator<Item = f64>>(samples: I) -> Self {
        let mut accumulator = Self::new();
        accumulator.extend(samples);
        accumulator
    }
}

/// Tests whether `value`, normally distributed with the known `standard_error`, has the mean `exact`.
pub fn z_test(value: f64, exact: f64, standard_error: f64) -> Outcome {
    let details = format!("value {value:.9e}, exact {exact:.9e}, standard error {standard_error:.3e}");
    let allowance = 64.0 * f64::EPSILON * exact.abs();
    t_test("Z-test", value - exact, allowance, standard_error, f64::INFINITY, details)
}

/// The two-sided t-test of a difference of which `allowance` is forgiven.
///
/// Forgiving means testing the hypothesis that the true difference lies anywhere in ± `allowance`; the p-value is
/// the largest of those hypotheses'.
fn t_test(
    test: &'static str,
    difference: f64,
    allowance: f64,
    standard_error: f64,
    dof: f64,
    details: String,
) -> Outcome {
    let excess = (difference.abs() - allowance).max(0.0);
    // `max` would have turned a NaN into 0.
    let (statistic, p_value) = if difference.is_nan() || allowance.is_nan() || standard_error.is_nan() {
        (f64::NAN, 0.0)
    } else if excess == 0.0 {
        (0.0, 1.0)
    } else {
        let t = (excess / standard_error).copysign(difference);
        (t, student_two_sided(t, dof))
    };
    Outcome { test, statistic, dof: Some(dof), p_value, details }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ALPHA, Pcg32, binomial_test, sidak};

    /// Samples of an exponential variable with this mean, skewed as estimators are.
    fn exponential(seed: u64, n: usize, mean: f64) -> MeanTest {
        let mut rng = Pcg32::new(seed);
        (0..n).map(|_| -mean * libm::log1p(-rng.next_f64())).collect()
    }

    #[test]
    fn moments_and_tests_done_by_hand() {
        let few: MeanTest = [2.0, 4.0, 4.0, 6.0].into_iter().collect();
        assert_eq!((few.count(), few.mean()), (4, 4.0));
        assert!((few.variance() - 8.0 / 3.0).abs() < 1e-15);
        assert!((few.standard_error() - (2.0_f64 / 3.0).sqrt()).abs() < 1e-15);
        // t = 2/√(2/3) = √6 with 3 degrees of freedom.
        let outcome = few.against(2.0);
        assert!((outcome.statistic - 6.0_f64.sqrt()).abs() < 1e-12);
        assert!((outcome.p_value - 0.0917211).abs() < 1e-6, "{outcome}");
        // Forgiving 1 of the 2 halves t.
        assert!((few.within(2.0, 0.5).statistic - 1.5_f64.sqrt()).abs() < 1e-12);
        // Welch with equal sizes and variances: t = 2/√(4/3) with 6 degrees of freedom.
        let shifted: MeanTest = [4.0, 6.0, 6.0, 8.0].into_iter().collect();
        let outcome = shifted.welch(&few);
        assert!((outcome.statistic - 3.0_f64.sqrt()).abs() < 1e-12);
        assert!((outcome.dof.unwrap() - 6.0).abs() < 1e-12);
    }

    #[test]
    fn a_large_offset_does_not_spoil_the_variance() {
        let offset: MeanTest = [2.0, 4.0, 4.0, 6.0].iter().map(|x| x + 1e9).collect();
        assert!((offset.variance() - 8.0 / 3.0).abs() < 1e-6);
    }

    #[test]
    fn accepts_the_right_mean_and_rejects_one_three_per_cent_off() {
        let samples = exponential(1, 100_000, 2.0);
        samples.against(2.0).assert_passes(ALPHA);
        samples.against(2.06).assert_rejects(1e-6);
        samples.against(1.94).assert_rejects(1e-6);
        z_test(samples.mean(), 2.0, 2.0 / 100_000_f64.sqrt()).assert_passes(ALPHA);
        z_test(samples.mean(), 2.06, 2.0 / 100_000_f64.sqrt()).assert_rejects(1e-6);
    }

    #[test]
    fn a_stated_bias_is_forgiven_and_no_more() {
        let samples = exponential(1, 400_000, 2.0);
        samples.within(2.06, 0.03).assert_passes(ALPHA);
        samples.within(1.94, 0.031).assert_passes(ALPHA);
        samples.within(2.06, 0.01).assert_rejects(1e-6);
    }

    #[test]
    fn welch_tells_means_apart_and_not_variances() {
        let a = exponential(1, 100_000, 2.0);
        let mut rng = Pcg32::new(2);
        let quiet: MeanTest = (0..20_000).map(|_| 1.9 + 0.2 * rng.next_f64()).collect();
        a.welch(&quiet).assert_passes(ALPHA);
        exponential(3, 100_000, 2.06).welch(&quiet).assert_rejects(1e-4);
    }

    /// 4000 tests of ten right samples. The exponential would be too skewed for ten; the sum of three uniform
    /// numbers is nearly normal, and using the normal distribution's tail instead of Student's gives 2.9 % at 1 %.
    #[test]
    fn the_false_positive_rate_is_the_level() {
        let mut rng = Pcg32::new(5);
        let mut batch =
            || (0..10).map(|_| rng.next_f64() + rng.next_f64() + rng.next_f64()).collect::<MeanTest>();
        let one: Vec<f64> = (0..4000).map(|_| batch().against(1.5).p_value).collect();
        let two: Vec<f64> = (0..4000).map(|_| batch().welch(&batch()).p_value).collect();
        for p_values in [one, two] {
            for level in [0.01, 0.1] {
                let below = p_values.iter().filter(|&&p| p < level).count() as u64;
                binomial_test(below, 4000, level).assert_passes(sidak(ALPHA, 4));
            }
        }
    }

    #[test]
    fn constant_samples() {
        let constant: MeanTest = [0.1 + 0.2; 5].into_iter().collect();
        constant.against(0.3).assert_passes(ALPHA);
        constant.against(0.300_000_1).assert_rejects(ALPHA);
        constant.within(0.300_000_1, 1e-6).assert_passes(ALPHA);
        constant.welch(&constant).assert_passes(ALPHA);
    }

    #[test]
    fn undefined_values_never_pass() {
        [1.0, f64::NAN, 1.0].into_iter().collect::<MeanTest>().against(1.0).assert_rejects(ALPHA);
        [1.0, f64::INFINITY].into_iter().collect::<MeanTest>().against(1.0).assert_rejects(ALPHA);
        [1.0].into_iter().collect::<MeanTest>().against(2.0).assert_rejects(ALPHA);
        MeanTest::new().against(0.0).assert_rejects(ALPHA);
    }
}
