//! Tail probabilities of the distributions that the tests need.

use statrs::function::{beta::beta_reg, gamma::gamma_lr, gamma::gamma_ur};
use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// P(|Z| ≥ |z|) of a standard normal Z.
pub(crate) fn normal_two_sided(z: f64) -> f64 {
    libm::erfc(z.abs() * FRAC_1_SQRT_2)
}

/// P(|T| ≥ |t|) of a Student T with `dof` degrees of freedom, which may be infinite.
pub(crate) fn student_two_sided(t: f64, dof: f64) -> f64 {
    // From here on the two distributions agree to more digits than the incomplete beta function has.
    if dof > 1e7 {
        return normal_two_sided(t);
    }
    let x = dof / (dof + t * t);
    if x.is_nan() { 0.0 } else { beta_reg(0.5 * dof, 0.5, x) }
}

/// P(X ≥ `statistic`) of a χ² variable with `dof` degrees of freedom.
pub(crate) fn chi_square_upper(statistic: f64, dof: f64) -> f64 {
    if statistic <= 0.0 {
        1.0
    } else if statistic.is_finite() {
        gamma_ur(0.5 * dof, 0.5 * statistic)
    } else {
        0.0
    }
}

/// P(X ≥ `count`) of a Poisson variable with mean `mean`.
pub(crate) fn poisson_upper(count: u64, mean: f64) -> f64 {
    if count == 0 {
        1.0
    } else if mean <= 0.0 {
        0.0
    } else {
        gamma_lr(count as f64, mean)
    }
}

/// P(X ≥ `count`) of a binomial variable, by summing its probabilities away from the mean.
///
/// The sum needs some 10 √n terms at most. The incomplete beta function would do the same by a continued
/// fraction, whose usual iteration limits are too low for the pixel counts and photon counts met here.
pub(crate) fn binomial_upper(count: u64, trials: u64, probability: f64) -> f64 {
    if count == 0 || probability >= 1.0 && count <= trials {
        1.0
    } else if count > trials || probability <= 0.0 {
        0.0
    } else if count as f64 > trials as f64 * probability {
        sum_upwards(count, trials, probability)
    } else {
        1.0 - sum_upwards(trials + 1 - count, trials, 1.0 - probability)
    }
}

/// The sum of the binomial probabilities from `count`, at or above the mean, to `trials`.
fn sum_upwards(count: u64, trials: u64, probability: f64) -> f64 {
    let (n, k) = (trials as f64, count as f64);
    let log_choose = libm::lgamma(n + 1.0) - libm::lgamma(k + 1.0) - libm::lgamma(n - k + 1.0);
    let first = libm::exp(log_choose + k * libm::log(probability) + (n - k) * libm::log1p(-probability));
    let odds = probability / (1.0 - probability);
    let (mut term, mut sum) = (1.0, 1.0);
    for j in count..trials {
        term *= odds * (trials - j) as f64 / (j + 1) as f64;
        sum += term;
        if term < 1e-17 * sum {
            break;
        }
    }
    (first * sum).min(1.0)
}

/// P(K ≥ x) of the Kolmogorov distribution, the limit of √n times the Kolmogorov–Smirnov statistic.
pub(crate) fn kolmogorov_upper(x: f64) -> f64 {
    if x <= 0.0 {
        return 1.0;
    }
    // Two series for the same function, related by the theta function's identity: one converges for small x,
    // the other for large x, and four terms give full precision on either side of 1.
    if x < 1.0 {
        let series: f64 =
            [1.0, 3.0, 5.0, 7.0].map(|k| libm::exp(-k * k * PI * PI / (8.0 * x * x))).iter().sum();
        1.0 - (2.0 * PI).sqrt() / x * series
    } else {
        let term = |k: f64| libm::exp(-2.0 * k * k * x * x);
        2.0 * (term(1.0) - term(2.0) + term(3.0) - term(4.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Asserts agreement with values computed by arbitrary-precision arithmetic.
    fn assert_near(value: f64, expected: f64, what: impl std::fmt::Debug) {
        let relative = (value / expected - 1.0).abs();
        assert!(relative < 1e-7, "{what:?}: {value:e} is not {expected:e} ({relative:e})");
    }

    #[test]
    fn student_tails() {
        let table = [
            (0.5, 1.0, 0.704832764699133),
            (2.0, 1.0, 0.295167235300867),
            (2.5, 7.3, 0.0396502346656005),
            (3.0, 100.0, 0.00340791534332945),
            (4.0, 5000.0, 6.42571830679837e-5),
            (0.01, 9999.0, 0.992021486869305),
            (3.0, 1e6, 0.0026998625414218),
            (6.0, 1e5, 1.97992945560176e-9),
            (5.0, 9e6, 5.73313881258118e-7),
        ];
        for (t, dof, expected) in table {
            assert_near(student_two_sided(t, dof), expected, (t, dof));
            assert_near(student_two_sided(-t, dof), expected, (t, dof));
        }
        assert_eq!(student_two_sided(f64::INFINITY, 5.0), 0.0);
        assert_eq!(student_two_sided(0.0, 5.0), 1.0);
    }

    #[test]
    fn chi_square_tails() {
        let table = [
            (0.1, 1.0, 0.751829634045849),
            (3.84, 1.0, 0.0500435212487051),
            (12.0, 5.0, 0.0347877805062418),
            (1000.0, 1000.0, 0.49405285382924),
            (1100.0, 1000.0, 0.0146144081262952),
            (1200.0, 1000.0, 1.22559423306229e-5),
            (20500.0, 20000.0, 0.00651786348834256),
            (900.0, 1000.0, 0.98928276190871),
        ];
        for (x, dof, expected) in table {
            assert_near(chi_square_upper(x, dof), expected, (x, dof));
        }
        assert_eq!(chi_square_upper(f64::INFINITY, 5.0), 0.0);
        assert_eq!(chi_square_upper(0.0, 5.0), 1.0);
    }

    #[test]
    fn binomial_tails() {
        let table = [
            (3, 10, 0.2, 0.3222004736),
            (60, 100, 0.5, 0.0284439668204906),
            (501_000, 1_000_000, 0.5, 0.022804149932691),
            (499_000, 1_000_000, 0.5, 0.977303832045328),
            (3, 1_000_000, 1e-6, 0.0803013051014496),
            (1, 1_000_000, 1e-8, 0.00995016630033444),
        ];
        for (k, n, p, expected) in table {
            assert_near(binomial_upper(k, n, p), expected, (k, n, p));
        }
        assert_eq!(binomial_upper(0, 10, 0.0), 1.0);
        assert_eq!(binomial_upper(1, 10, 0.0), 0.0);
        assert_eq!(binomial_upper(10, 10, 1.0), 1.0);
        assert_eq!(binomial_upper(11, 10, 1.0), 0.0);
    }

    #[test]
    fn kolmogorov_and_poisson_tails() {
        let table = [
            (0.3, 0.999990694198665),
            (0.5, 0.963945243664875),
            (0.8276, 0.499958416563547),
            (0.999, 0.271073164115064),
            (1.0, 0.269999671677355),
            (1.3581, 0.0499996304316674),
            (1.9495, 0.000999801979025898),
        ];
        for (x, expected) in table {
            assert_near(kolmogorov_upper(x), expected, x);
        }
        assert_near(poisson_upper(1, 0.1), 0.0951625819640404, "one of 0.1");
        assert_near(poisson_upper(10, 1.0), 1.11425478338721e-7, "ten of 1");
        assert_near(poisson_upper(50, 30.0), 0.000518891462548034, "fifty of thirty");
    }
}
