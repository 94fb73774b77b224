//! The exact binomial test.

use crate::Outcome;
use crate::special::binomial_upper;

/// Tests whether `successes` of `trials` independent trials are compatible with `probability`.
///
/// The p-value is twice the smaller tail, counting the result itself, at most 1: exact, hence conservative for
/// few trials, and consistent with Clopper and Pearson's confidence interval.
///
/// # Panics
/// If `probability` is not in [0, 1] or there are more successes than trials.
pub fn binomial_test(successes: u64, trials: u64, probability: f64) -> Outcome {
    assert!((0.0..=1.0).contains(&probability), "{probability} is no probability");
    assert!(successes <= trials, "{successes} successes in {trials} trials");
    let upper = binomial_upper(successes, trials, probability);
    let lower = binomial_upper(trials - successes, trials, 1.0 - probability);
    let p_value = if trials == 0 { f64::NAN } else { (2.0 * upper.min(lower)).min(1.0) };
    let expected = trials as f64 * probability;
    let details = format!("{successes} successes in {trials} trials, expected {expected:.3}");
    Outcome { test: "binomial", statistic: successes as f64, dof: None, p_value, details }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ALPHA, Pcg32};

    #[test]
    fn the_p_value_of_cases_done_by_hand() {
        let p = |k, n, q| binomial_test(k, n, q).p_value;
        assert!((p(0, 5, 0.5) - 2.0 / 32.0).abs() < 1e-14);
        assert!((p(4, 5, 0.5) - 12.0 / 32.0).abs() < 1e-14);
        assert_eq!(p(5, 10, 0.5), 1.0);
        assert!((p(2, 2, 0.1) - 0.02).abs() < 1e-14);
    }

    #[test]
    fn certainties() {
        binomial_test(7, 7, 1.0).assert_passes(1.0);
        binomial_test(6, 7, 1.0).assert_rejects(1e-300);
        binomial_test(0, 7, 0.0).assert_passes(1.0);
        binomial_test(1, 7, 0.0).assert_rejects(1e-300);
        binomial_test(0, 0, 0.5).assert_rejects(ALPHA);
    }

    #[test]
    fn accepts_the_right_probability_and_rejects_one_three_per_cent_off() {
        let mut rng = Pcg32::new(1);
        let hits = (0..100_000).filter(|_| rng.next_f64() < 0.3).count() as u64;
        binomial_test(hits, 100_000, 0.3).assert_passes(ALPHA);
        binomial_test(hits, 100_000, 0.309).assert_rejects(1e-6);
        binomial_test(hits, 100_000, 0.291).assert_rejects(1e-6);
    }
}
