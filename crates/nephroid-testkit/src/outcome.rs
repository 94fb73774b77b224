//! What a test found.

use std::fmt;

/// The result of one statistical test.
#[derive(Clone, Debug, PartialEq)]
#[must_use]
pub struct Outcome {
    /// The name of the test.
    pub test: &'static str,
    /// The test's statistic: χ², t, z, D or a count of successes.
    pub statistic: f64,
    /// Degrees of freedom of the statistic, where it has any. May be fractional (Welch) or infinite (Z-test).
    pub dof: Option<f64>,
    /// The probability of a result at least as extreme if what is tested were true. It is zero where the data
    /// are impossible (NaN, samples where the density vanishes, …); `details` then says why.
    pub p_value: f64,
    /// What a person needs to understand a failure: counts, means, the worst cells. May have several lines.
    pub details: String,
}

impl Outcome {
    /// Whether the p-value reaches `alpha`. A p-value that is NaN does not.
    #[must_use]
    pub fn passes(&self, alpha: f64) -> bool {
        self.p_value >= alpha
    }

    /// Panics with a readable report unless the test passes at level `alpha` (see [`ALPHA`](crate::ALPHA)).
    #[track_caller]
    pub fn assert_passes(&self, alpha: f64) {
        assert!(self.passes(alpha), "rejected at alpha = {alpha:.3e}: {self}");
    }

    /// Panics with a readable report if the test passes at level `alpha`: for tests of tests.
    #[track_caller]
    pub fn assert_rejects(&self, alpha: f64) {
        assert!(!self.passes(alpha), "not rejected at alpha = {alpha:.3e}: {self}");
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: statistic {:.6}", self.test, self.statistic)?;
        if let Some(dof) = self.dof {
            write!(f, ", {dof:.1} degrees of freedom")?;
        }
        write!(f, ", p = {:.3e}", self.p_value)?;
        if self.details.is_empty() { Ok(()) } else { write!(f, "\n{}", self.details) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn outcome(p_value: f64) -> Outcome {
        Outcome { test: "coin", statistic: 1.5, dof: Some(3.0), p_value, details: "heads".into() }
    }

    #[test]
    fn displays_what_a_person_needs() {
        let expected = "coin: statistic 1.500000, 3.0 degrees of freedom, p = 2.500e-1\nheads";
        assert_eq!(outcome(0.25).to_string(), expected);
    }

    #[test]
    fn an_undefined_p_value_never_passes() {
        assert!(outcome(0.25).passes(0.01) && !outcome(0.001).passes(0.01));
        assert!(!outcome(f64::NAN).passes(0.01));
    }

    #[test]
    #[should_panic(expected = "rejected at alpha = 1.000e-2: coin")]
    fn a_rejection_panics_with_the_report() {
        outcome(0.001).assert_passes(0.01);
    }
}
