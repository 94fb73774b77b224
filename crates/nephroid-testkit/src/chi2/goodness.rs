//! Pearson's statistic, with the pooling and the guards that it needs.

use crate::Outcome;
use crate::special::{chi_square_upper, poisson_upper};

/// The expectation below which the statistic of a cell is not yet χ² distributed.
const LEAST_EXPECTED: f64 = 5.0;

/// Cells expected to hold less than this are judged together, as a place where samples should not be.
const NEGLIGIBLE: f64 = 1e-3;

/// Share of samples forgiven where the density vanishes: rounding puts a few across a boundary.
const STRAY: f64 = 1e-5;

/// Tests whether the counts `observed` agree with those `expected`: of the indices that a discrete sampler
/// returns, say, against the number of samples times their probabilities.
///
/// Cells are pooled, in ascending order of expectation, until five or more are expected in each pool. Where next
/// to nothing is expected, a few samples more than rounding explains (1e-5 of all) give p = 0.
///
/// # Panics
/// If the slices differ in length.
pub fn goodness_of_fit(observed: &[u64], expected: &[f64]) -> Outcome {
    assert_eq!(observed.len(), expected.len(), "an expectation is needed for each count");
    let (counted, predicted) = (observed.iter().sum::<u64>() as f64, expected.iter().sum::<f64>());
    let mut outcome = compare(observed, expected, |i| format!("cell {i}"));
    let undefined = expected.iter().any(|e| !e.is_finite() || *e < 0.0);
    if undefined || (predicted - counted).abs() > 1e-6 * counted {
        outcome.p_value = 0.0;
        outcome.details = format!("{predicted} expected in all, but {counted} counted\n{}", outcome.details);
    }
    outcome
}

/// Whether `observed` samples of `samples` are so many more than `expected` that neither chance (1e-6) nor
/// rounding explains them.
pub(super) fn too_many(observed: u64, expected: f64, samples: u64) -> bool {
    poisson_upper(observed, expected + STRAY * samples as f64) < 1e-6
}

/// Pearson's test; `name` describes a cell in the report.
pub(super) fn compare(observed: &[u64], expected: &[f64], name: impl Fn(usize) -> String) -> Outcome {
    let mut order: Vec<usize> = (0..expected.len()).collect();
    order.sort_by(|&a, &b| expected[a].total_cmp(&expected[b]));
    let pools = pool(&order, expected);
    let mut statistic = 0.0;
    let mut terms: Vec<(f64, &[usize])> = Vec::new();
    for cells in pools {
        let count: u64 = cells.iter().map(|&i| observed[i]).sum();
        let expectation: f64 = cells.iter().map(|&i| expected[i]).sum();
        let difference = count as f64 - expectation;
        let term = difference * difference / expectation;
        statistic += term;
        terms.push((term, cells));
    }
    let dof = terms.len().saturating_sub(1) as f64;
    let mut details = worst(&mut terms, observed, expected, name);

    let negligible: Vec<usize> = order.iter().copied().take_while(|&i| expected[i] < NEGLIGIBLE).collect();
    let stray: u64 = negligible.iter().map(|&i| observed[i]).sum();
    let expectation: f64 = negligible.iter().map(|&i| expected[i].max(0.0)).sum();
    let p_value = if too_many(stray, expectation, observed.iter().sum()) {
        details = format!("{stray} samples lie where {expectation:.1e} are expected\n{details}");
        0.0
    } else if dof == 0.0 {
        details = format!("all samples are expected in one cell: nothing was tested\n{details}");
        f64::NAN
    } else if statistic.is_nan() {
        0.0
    } else {
        chi_square_upper(statistic, dof)
    };
    Outcome { test: "chi-square", statistic, dof: Some(dof), p_value, details }
}

/// Cuts cells in ascending order of expectation into runs that expect enough; a rest joins the last run.
fn pool<'a>(order: &'a [usize], expected: &[f64]) -> Vec<&'a [usize]> {
    let mut ends = Vec::new();
    let mut sum = 0.0;
    for (i, &cell) in order.iter().enumerate() {
        sum += expected[cell];
        if sum >= LEAST_EXPECTED {
            ends.push(i + 1);
            sum = 0.0;
        }
    }
    if let Some(last) = ends.last_mut() {
        *last = order.len();
    }
    let starts = std::iter::once(0).chain(ends.iter().copied());
    starts.zip(&ends).map(|(start, &end)| &order[start..end]).collect()
}

/// Describes the pools that contribute most to the statistic, largest first.
fn worst(
    terms: &mut [(f64, &[usize])],
    observed: &[u64],
    expected: &[f64],
    name: impl Fn(usize) -> String,
) -> String {
    terms.sort_by(|a, b| b.0.total_cmp(&a.0));
    let lines = terms.iter().take(4).map(|(term, cells)| {
        let place = match cells {
            [cell] => name(*cell),
            [.., last] => format!("{} cells pooled, the largest {}", cells.len(), name(*last)),
            [] => String::new(),
        };
        let count: u64 = cells.iter().map(|&i| observed[i]).sum();
        let expectation: f64 = cells.iter().map(|&i| expected[i]).sum();
        format!("  contributes {term:.1}: {count} observed, {expectation:.1} expected in {place}")
    });
    lines.collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ALPHA, Pcg32, binomial_test};

    #[test]
    fn the_statistic_of_a_case_done_by_hand() {
        // Mendel's peas: 315, 108, 101 and 32 of 556 against 9 : 3 : 3 : 1.
        let expected = [9.0, 3.0, 3.0, 1.0].map(|share| 556.0 * share / 16.0);
        let outcome = goodness_of_fit(&[315, 108, 101, 32], &expected);
        assert!((outcome.statistic - 0.470024).abs() < 1e-6, "{outcome}");
        assert_eq!(outcome.dof, Some(3.0));
        assert!((outcome.p_value - 0.92542).abs() < 1e-4, "{outcome}");
    }

    #[test]
    fn small_cells_are_pooled_until_five_are_expected() {
        let order = [0, 1, 2, 3, 4, 5];
        let pools = pool(&order, &[0.0, 2.0, 3.0, 4.0, 4.5, 100.0]);
        assert_eq!(pools, [&[0, 1, 2][..], &[3, 4], &[5]]);
        // A rest, which rounding or NaN can leave, joins the last pool; without any pool nothing is tested.
        assert_eq!(pool(&order[..3], &[6.0, 1.0, 2.0]), [&[0, 1, 2][..]]);
        assert!(pool(&order[..2], &[0.0, 2.0]).is_empty());
    }

    fn counts(rng: &mut Pcg32, n: u64, probabilities: &[f64]) -> Vec<u64> {
        let mut counts = vec![0; probabilities.len()];
        for _ in 0..n {
            let mut u = rng.next_f64();
            let index = probabilities.iter().position(|p| {
                u -= p;
                u < 0.0
            });
            counts[index.unwrap_or(probabilities.len() - 1)] += 1;
        }
        counts
    }

    #[test]
    fn accepts_the_right_probabilities_and_rejects_some_three_per_cent_off() {
        let right = [0.1, 0.2, 0.3, 0.4];
        let observed = counts(&mut Pcg32::new(1), 200_000, &right);
        goodness_of_fit(&observed, &right.map(|p| 2e5 * p)).assert_passes(ALPHA);
        let wrong = [0.103, 0.206, 0.3, 0.391];
        goodness_of_fit(&observed, &wrong.map(|p| 2e5 * p)).assert_rejects(1e-6);
    }

    #[test]
    fn impossible_cells_and_totals_are_rejected() {
        goodness_of_fit(&[50_000, 50_000, 0], &[5e4, 5e4, 0.0]).assert_passes(ALPHA);
        goodness_of_fit(&[50_000, 49_980, 20], &[5e4, 5e4, 0.0]).assert_rejects(1e-300);
        goodness_of_fit(&[50, 50], &[51.0, 51.0]).assert_rejects(1e-300);
        goodness_of_fit(&[50, 50], &[f64::NAN, 50.0]).assert_rejects(1e-300);
        goodness_of_fit(&[50, 50], &[-1.0, 101.0]).assert_rejects(1e-300);
        goodness_of_fit(&[100], &[100.0]).assert_rejects(ALPHA);
        goodness_of_fit(&[], &[]).assert_rejects(ALPHA);
    }

    /// 2000 right tests, at 10 %, with a long tail of small cells so that the pooling is tested with them.
    #[test]
    fn the_false_positive_rate_is_the_level() {
        let mut probabilities: Vec<f64> = (0..20).map(|i| 1.0 / f64::from(1 << i)).collect();
        let sum: f64 = probabilities.iter().sum();
        probabilities.iter_mut().for_each(|p| *p /= sum);
        let expected: Vec<f64> = probabilities.iter().map(|p| 1000.0 * p).collect();
        let mut rng = Pcg32::new(2);
        let rejected = (0..2000)
            .filter(|_| !goodness_of_fit(&counts(&mut rng, 1000, &probabilities), &expected).passes(0.1))
            .count();
        binomial_test(rejected as u64, 2000, 0.1).assert_passes(ALPHA);
    }
}
