//! Adaptive Gauss–Kronrod quadrature in one and two dimensions.

/// When an integral is good enough: its error is below the larger of the two bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Bound on the error itself, in units of the integral.
    pub absolute: f64,
    /// Bound on the error divided by the integral's absolute value.
    pub relative: f64,
}

impl Tolerance {
    /// A purely relative tolerance.
    #[must_use]
    pub const fn relative(relative: f64) -> Self {
        Self { absolute: 0.0, relative }
    }

    fn met_by(self, integral: Integral) -> bool {
        integral.error <= self.absolute.max(self.relative * integral.value.abs())
    }
}

/// The value of an integral and an estimate, usually pessimistic, of its error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Integral {
    /// The integral.
    pub value: f64,
    /// An estimate of the absolute error. Where it exceeds the tolerance, the limit on subdivisions was reached.
    pub error: f64,
}

/// Integrates over the range of `breakpoints` (ascending, at least two), adaptively between them.
///
/// Give the places where the integrand jumps, has kinks or peaks, if they are known. The adaptive halving finds
/// the others, except for peaks narrower than about a tenth of their interval, which fifteen points may miss.
/// A jump within 0.4 % of the interval's width from its end may be missed as well.
/// The ends are never evaluated, so that integrable singularities may lie there.
///
/// The 15-point rule with its embedded 7-point rule, and the error estimate, are those of QUADPACK (Piessens et
/// al., Springer 1983): always halve the interval with the largest error, until the sum of errors is small.
///
/// # Panics
/// If there are fewer than two breakpoints or if they descend.
pub fn integrate(mut f: impl FnMut(f64) -> f64, breakpoints: &[f64], tolerance: Tolerance) -> Integral {
    assert!(breakpoints.len() >= 2, "an integral needs two limits");
    assert!(breakpoints.is_sorted(), "breakpoints must ascend: {breakpoints:?}");
    let mut pieces: Vec<Piece> = breakpoints.windows(2).map(|w| Piece::new(&mut f, w[0], w[1])).collect();
    for _ in 0..MAX_HALVINGS {
        let total = sum(&pieces);
        // An integrand that is not finite somewhere will not become so by looking closer.
        if tolerance.met_by(total) || !total.error.is_finite() {
            return total;
        }
        let worst = (1..pieces.len()).fold(0, |w, i| if pieces[i].error > pieces[w].error { i } else { w });
        let (a, b) = (pieces[worst].a, pieces[worst].b);
        let middle = 0.5 * (a + b);
        if middle <= a || middle >= b {
            return total;
        }
        let (mut left, mut right) = (Piece::new(&mut f, a, middle), Piece::new(&mut f, middle, b));
        // At a jump the two rules agree by chance now and then. What halving changed tells otherwise.
        let change = (left.value + right.value - pieces[worst].value).abs();
        left.error = left.error.max(0.25 * change);
        right.error = right.error.max(0.25 * change);
        pieces[worst] = left;
        pieces.push(right);
    }
    sum(&pieces)
}

/// Integrates over the rectangle spanned by two lists of breakpoints, as an adaptive integral over x of adaptive
/// integrals over y.
///
/// The nesting follows jumps along curves at the cost of a few halvings, where cutting the rectangle into small
/// ones would need very many: the inner integral finds the curve, and is smooth as a function of x.
///
/// # Panics
/// If a list has fewer than two breakpoints or descends.
pub fn integrate_2d(
    mut f: impl FnMut([f64; 2]) -> f64,
    x_breakpoints: &[f64],
    y_breakpoints: &[f64],
    tolerance: Tolerance,
) -> Integral {
    let width = x_breakpoints.last().unwrap_or(&0.0) - x_breakpoints.first().unwrap_or(&0.0);
    // The outer rule must not mistake the inner one's error for structure.
    let inner = Tolerance {
        absolute: if width > 0.0 { 0.1 * tolerance.absolute / width } else { tolerance.absolute },
        relative: 0.1 * tolerance.relative,
    };
    integrate(|x| integrate(|y| f([x, y]), y_breakpoints, inner).value, x_breakpoints, tolerance)
}

/// Enough to follow a jump down to the last bits of its position; a bound on the work for noisy integrands.
const MAX_HALVINGS: usize = 100;

/// One interval with its integral.
struct Piece {
    a: f64,
    b: f64,
    value: f64,
    error: f64,
}

impl Piece {
    fn new(f: &mut impl FnMut(f64) -> f64, a: f64, b: f64) -> Self {
        let Integral { value, error } = gauss_kronrod(f, a, b);
        Self { a, b, value, error }
    }
}

fn sum(pieces: &[Piece]) -> Integral {
    pieces.iter().fold(Integral::default(), |total, piece| Integral {
        value: total.value + piece.value,
        error: total.error + piece.error,
    })
}

/// The 15-point Kronrod rule on [a, b] and its distance from the 7-point Gauss rule.
fn gauss_kronrod(f: &mut impl FnMut(f64) -> f64, a: f64, b: f64) -> Integral {
    let (centre, half) = (0.5 * (a + b), 0.5 * (b - a));
    let mut values = [0.0; 15];
    for (i, node) in NODES.iter().enumerate() {
        values[i] = f(centre - half * node);
        values[14 - i] = f(centre + half * node);
    }
    let weighted = |g: &dyn Fn(f64) -> f64| -> f64 {
        (0..15).map(|i| KRONROD_WEIGHTS[if i < 8 { i } else { 14 - i }] * g(values[i])).sum()
    };
    let kronrod = weighted(&|v| v);
    let gauss: f64 = (0..7).map(|i| GAUSS_WEIGHTS[if i < 4 { i } else { 6 - i }] * values[2 * i + 1]).sum();
    let difference = (kronrod - gauss).abs();
    let roughness = weighted(&|v| (v - 0.5 * kronrod).abs());
    // The difference is the error of the *Gauss* rule. The Kronrod rule's is smaller by a power where the
    // integrand is smooth, that is where the difference is far below the variation of the integrand itself.
    let error = if difference > 0.0 && roughness > 0.0 {
        let ratio = 200.0 * difference / roughness;
        roughness * (ratio * ratio.sqrt()).min(1.0)
    } else {
        difference
    };
    Integral { value: half * kronrod, error: half * error }
}

/// Nodes of the 15-point Kronrod rule on [−1, 1], from the outside to the centre; the odd ones are Gauss's.
const NODES: [f64; 8] = [
    0.991_455_371_120_812_6,
    0.949_107_912_342_758_5,
    0.864_864_423_359_769_1,
    0.741_531_185_599_394_4,
    0.586_087_235_467_691_1,
    0.405_845_151_377_397_2,
    0.207_784_955_007_898_47,
    0.0,
];

const KRONROD_WEIGHTS: [f64; 8] = [
    0.022_935_322_010_529_225,
    0.063_092_092_629_978_55,
    0.104_790_010_322_250_18,
    0.140_653_259_715_525_92,
    0.169_004_726_639_267_9,
    0.190_350_578_064_785_4,
    0.204_432_940_075_298_9,
    0.209_482_141_084_727_83,
];

const GAUSS_WEIGHTS: [f64; 4] =
    [0.129_484_966_168_869_7, 0.279_705_391_489_276_64, 0.381_830_050_505_118_9, 0.417_959_183_673_469_4];

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    const TIGHT: Tolerance = Tolerance::relative(1e-10);

    fn assert_integral(integral: Integral, exact: f64, relative: f64) {
        let error = (integral.value - exact).abs();
        assert!(error <= relative * exact.abs(), "{integral:?} is not {exact} (error {error:e})");
    }

    fn power(x: f64, exponent: i32) -> f64 {
        (0..exponent).fold(1.0, |product, _| product * x)
    }

    #[test]
    fn the_rules_have_their_degrees() {
        // The Kronrod rule is exact to degree 23 (22 + symmetry), and no further: a wrong node would show.
        for degree in [0, 2, 10, 22] {
            let exact = 2.0 / f64::from(degree + 1);
            assert_integral(gauss_kronrod(&mut |x| power(x, degree), -1.0, 1.0), exact, 1e-14);
        }
        let beyond = gauss_kronrod(&mut |x| power(x, 24), -1.0, 1.0);
        assert!((beyond.value - 2.0 / 25.0).abs() > 1e-9);
        // The Gauss rule is exact to degree 13, where its difference from Kronrod's must vanish.
        assert!(gauss_kronrod(&mut |x| power(x, 12), -1.0, 1.0).error < 1e-14);
        assert!(gauss_kronrod(&mut |x| power(x, 14), -1.0, 1.0).error > 1e-9);
    }

    #[test]
    fn smooth_kinked_jumping_and_singular_integrands() {
        assert_integral(integrate(libm::exp, &[0.0, 1.0], TIGHT), std::f64::consts::E - 1.0, 1e-12);
        assert_integral(integrate(|x| (x - 0.3).abs(), &[0.0, 1.0], TIGHT), 0.29, 1e-10);
        assert_integral(integrate(|x| f64::from(x > 0.3), &[0.0, 1.0], TIGHT), 0.7, 1e-9);
        let root = integrate(|x| 1.0 / x.sqrt(), &[0.0, 1.0], Tolerance::relative(1e-6));
        assert_integral(root, 2.0, 1e-6);
        assert_integral(
            integrate(|x| 1.0 / (1.0 + x * x), &[-1e4, 1e4], TIGHT),
            2.0 * libm::atan(1e4),
            1e-10,
        );
    }

    #[test]
    fn breakpoints_show_a_peak_that_the_rule_would_miss() {
        let (centre, width) = (0.437, 1e-6);
        let peak = |x: f64| libm::exp(-0.5 * power((x - centre) / width, 2));
        let exact = width * (2.0 * PI).sqrt();
        assert_eq!(integrate(peak, &[0.0, 1.0], TIGHT).value, 0.0);
        assert_integral(integrate(peak, &[0.0, centre - 8e-6, centre + 8e-6, 1.0], TIGHT), exact, 1e-10);
    }

    #[test]
    fn the_error_estimate_covers_the_error() {
        for frequency in [1.0, 10.0, 100.0, 400.0] {
            let integral =
                integrate(|x| 1.0 + libm::cos(frequency * x), &[0.0, 1.0], Tolerance::relative(1e-3));
            let exact = 1.0 + libm::sin(frequency) / frequency;
            assert!((integral.value - exact).abs() <= integral.error + 1e-15, "{frequency}: {integral:?}");
        }
    }

    /// At 32 of these positions the two rules agree by chance early on, and only the change by halving tells.
    #[test]
    fn a_jump_anywhere_is_integrated_to_the_tolerance() {
        let tolerance = Tolerance { absolute: 1e-3, relative: 0.0 };
        for i in 0..20_000 {
            let place = 0.02 + 0.96 * (f64::from(i) + 0.5) / 20_000.0;
            let step = |x: f64| if x > place { 1.0 } else { 0.2 + 0.3 * x * x };
            let exact = 1.0 - 0.8 * place + 0.1 * power(place, 3);
            let error = (integrate(step, &[0.0, 1.0], tolerance).value - exact).abs();
            assert!(error <= tolerance.absolute, "a jump at {place} gives an error of {error:e}");
        }
    }

    #[test]
    fn two_dimensions_with_and_without_a_jump_along_a_curve() {
        let smooth = integrate_2d(|[x, y]| libm::exp(x) * y, &[0.0, 1.0], &[0.0, 2.0], TIGHT);
        assert_integral(smooth, 2.0 * (std::f64::consts::E - 1.0), 1e-10);
        let mut evaluations = 0;
        let disk = |[x, y]: [f64; 2]| {
            evaluations += 1;
            f64::from(x * x + y * y < 1.0)
        };
        let quarter = integrate_2d(disk, &[0.0, 1.0], &[0.0, 1.0], Tolerance::relative(1e-4));
        // Where the circle is nearly tangent to the border, slivers escape the inner rule.
        assert_integral(quarter, 0.25 * PI, 2e-4);
        assert!(evaluations < 500_000, "{evaluations} evaluations");
    }

    #[test]
    fn gives_up_where_the_integrand_is_not_finite() {
        assert!(!integrate(|_| f64::NAN, &[0.0, 1.0], TIGHT).value.is_finite());
        assert!(!integrate(|_| f64::INFINITY, &[0.0, 1.0], TIGHT).value.is_finite());
        assert_eq!(integrate(|_| 1.0, &[2.0, 2.0], TIGHT).value, 0.0);
    }
}
