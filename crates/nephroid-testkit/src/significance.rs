//! How often a correct program may fail.

/// The significance level of one suite of statistical tests, by convention: 1 %.
///
/// A suite is what one person adds and looks at together, say all samplers of one module. Its tests share the
/// level by [`sidak`], so that a *correct* suite with freshly chosen seeds fails with probability 1 %.
/// That is the false-positive rate of writing the test, not of running it: seeds are fixed, hence a test that
/// has passed once passes for ever, until the code it tests consumes its random numbers differently. Whoever
/// sees a failure after such a change looks at the p-value: a wrong density gives 1e-10 or 0 and not 0.003, and
/// a second seed settles the matter.
///
/// A pass proves little by itself. Each test should be seen to fail on a density that is a few per cent off.
pub const ALPHA: f64 = 0.01;

/// The level at which each of `tests` independent tests must run for all of them together to have a
/// false-positive rate of `alpha`: 1 − (1 − α)^(1/tests).
///
/// Šidák, "Rectangular confidence regions for the means of multivariate normal distributions", JASA 62 (1967).
///
/// # Panics
/// If `tests` is zero or `alpha` is no probability.
#[must_use]
pub fn sidak(alpha: f64, tests: usize) -> f64 {
    assert!(tests > 0, "a correction for no test at all");
    assert!((0.0..=1.0).contains(&alpha), "the level {alpha} is no probability");
    -libm::expm1(libm::log1p(-alpha) / tests as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sidak_gives_the_family_its_level() {
        assert_eq!(sidak(ALPHA, 1), ALPHA);
        for tests in [2, 7, 1000, 1_000_000] {
            let each = sidak(ALPHA, tests);
            let family = 1.0 - libm::pow(1.0 - each, tests as f64);
            assert!((family - ALPHA).abs() < 1e-9, "{tests} tests give {family}");
        }
    }
}
