//! Sums and tests, in double precision.

use nephroid::math::Vec3;
use statrs::function::gamma::gamma_ur;

/// Pearson's test of counts against one expectation for all cells.
#[derive(Clone, Copy, Debug)]
pub struct ChiSquared {
    /// Σ (count − expected)² / expected.
    pub statistic: f64,
    /// Degrees of freedom.
    pub freedom: f64,
    /// The chance of so large a statistic if the counts are even.
    pub p_value: f64,
}

impl ChiSquared {
    /// Of cells that should hold the same. Five or more should be expected in each.
    pub fn of_even(counts: &[u64]) -> Self {
        let expected = counts.iter().sum::<u64>() as f64 / counts.len().max(1) as f64;
        let square = |&count: &u64| (count as f64 - expected) * (count as f64 - expected);
        let statistic = counts.iter().map(square).sum::<f64>() / expected;
        let freedom = counts.len().saturating_sub(1) as f64;
        let p_value = match statistic {
            s if s <= 0.0 => 1.0,
            s if s.is_finite() => gamma_ur(0.5 * freedom, 0.5 * s),
            _ => 0.0,
        };
        Self { statistic, freedom, p_value }
    }
}

/// Cells of equal solid angle: `columns` of longitude times `rows` of height, from the top. Row by row.
pub fn sphere_counts(directions: &[Vec3], columns: usize, rows: usize) -> Vec<u64> {
    let mut counts = vec![0; columns * rows];
    for direction in directions {
        let [x, y, z] = direction.to_array().map(f64::from);
        let turn = libm::atan2(y, x) / std::f64::consts::TAU + 0.5;
        let cell = |part: f64, n: usize| ((part * n as f64) as usize).min(n - 1);
        counts[cell((1.0 - z) * 0.5, rows) * columns + cell(turn, columns)] += 1;
    }
    counts
}

/// The test of Kolmogorov and Smirnov of numbers against an even distribution on [0, 1].
#[derive(Clone, Copy, Debug)]
pub struct KolmogorovSmirnov {
    /// The largest distance between the two distribution functions.
    pub distance: f64,
    /// The chance of so large a distance if the numbers are even: of many numbers, where its limit holds.
    pub p_value: f64,
}

impl KolmogorovSmirnov {
    /// Of numbers that should be even.
    pub fn of_even(values: &[f64]) -> Self {
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        let n = sorted.len() as f64;
        let gap = |(i, v): (usize, &f64)| (v - i as f64 / n).max((i + 1) as f64 / n - v);
        let distance = sorted.iter().enumerate().map(gap).fold(0.0, f64::max);
        let scaled = distance * (libm::sqrt(n) + 0.12 + 0.11 / libm::sqrt(n));
        let term = |j: i32| {
            let term = libm::exp(-2.0 * f64::from(j * j) * scaled * scaled);
            if j % 2 == 1 { term } else { -term }
        };
        // The series of the limit converges where the distance is not tiny; there p is 1.
        let p_value = if scaled < 0.2 { 1.0 } else { 2.0 * (1..=40).map(term).sum::<f64>() };
        Self { distance, p_value: p_value.clamp(0.0, 1.0) }
    }
}

/// Simpson's rule on [0, 1] with 2000 intervals: 10⁻⁸ or better for smooth functions.
pub fn integral(f: impl Fn(f64) -> f64) -> f64 {
    let n = 2000;
    let weight = |i| if i == 0 || i == n { 1.0 } else { f64::from(2 + 2 * (i % 2)) };
    (0..=n).map(|i| weight(i) * f(f64::from(i) / f64::from(n))).sum::<f64>() / (3.0 * f64::from(n))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn even_counts_pass_and_uneven_ones_do_not() {
        assert_eq!(ChiSquared::of_even(&[50; 20]).p_value, 1.0);
        // (100 − 50)² / 50 twice: 100 for one degree of freedom.
        let uneven = ChiSquared::of_even(&[100, 0]);
        assert_eq!((uneven.statistic, uneven.freedom), (100.0, 1.0));
        assert!(uneven.p_value < 1e-20);
        // The median of χ² with 2 degrees of freedom is 2 ln 2.
        let counts = [1000, 1000 + 37, 1000 - 37];
        assert!((ChiSquared::of_even(&counts).p_value - libm::exp(-1.369)).abs() < 1e-3);
    }

    #[test]
    fn directions_fall_into_their_cells() {
        let counts = sphere_counts(&[Vec3::Z, -Vec3::Z, Vec3::X, Vec3::Y], 2, 2);
        assert_eq!(counts.iter().sum::<u64>(), 4);
        assert_eq!(sphere_counts(&[Vec3::new(0.1, 0.1, 0.99)], 2, 2), [0, 1, 0, 0]);
        assert_eq!(sphere_counts(&[Vec3::new(-0.1, -0.1, -0.99)], 2, 2), [0, 0, 1, 0]);
    }

    #[test]
    fn even_numbers_are_told_from_steps() {
        let even: Vec<f64> = (0..1000).map(|i| (f64::from(i) + 0.5) / 1000.0).collect();
        let test = KolmogorovSmirnov::of_even(&even);
        assert!((test.distance - 0.0005).abs() < 1e-12 && test.p_value == 1.0);
        let steps: Vec<f64> = even.iter().map(|v| libm::floor(v * 5.0) / 5.0).collect();
        let test = KolmogorovSmirnov::of_even(&steps);
        assert!((test.distance - 0.2).abs() < 1e-12 && test.p_value < 1e-12);
        // The 5 % point of the limit is 1.3581: a gap of so much in 10 000 numbers.
        let shifted: Vec<f64> = (1..=10_000).map(|i| f64::from(i) / 10_000.0 * (1.0 - 0.013_565)).collect();
        assert!((KolmogorovSmirnov::of_even(&shifted).p_value - 0.05).abs() < 2e-3);
    }

    #[test]
    fn simpson_integrates_polynomials() {
        assert!((integral(|t| t * t) - 1.0 / 3.0).abs() < 1e-12);
    }
}
