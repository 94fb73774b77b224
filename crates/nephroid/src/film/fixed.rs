//! Fixed-point numbers, whose sums do not depend on the order of the terms.

/// Signed sums are counted in steps of 2^−64.
const SIGNED_FRACTION_BITS: i32 = 64;

/// Sums of squares are counted in steps of 2^−56.
const SQUARE_FRACTION_BITS: i32 = 56;

/// No term of a signed sum counts more: 2^24 terms of this size still fit.
const LARGEST_TERM: f64 = (1u64 << 39) as f64;

/// A number rounded to a step, and whether it had to be cut to fit.
pub type Rounded<T> = (T, bool);

/// A term of a signed sum, which must be finite.
pub fn signed(value: f64) -> Rounded<i128> {
    let cut = value.clamp(-LARGEST_TERM, LARGEST_TERM);
    // Scaling by a power of two is exact; the conversion is too, after rounding.
    ((cut * power_of_two(SIGNED_FRACTION_BITS)).round() as i128, cut != value)
}

/// A term of a sum of squares, which must be finite and not below zero.
pub fn square(value: f64) -> Rounded<u128> {
    let scaled = (value * power_of_two(SQUARE_FRACTION_BITS)).round();
    // The conversion saturates.
    (scaled as u128, scaled >= u128::MAX as f64)
}

/// The number that a signed sum stands for.
pub fn signed_value(sum: i128) -> f64 {
    sum as f64 * power_of_two(-SIGNED_FRACTION_BITS)
}

/// The number that a sum of squares stands for; infinite if it saturated.
pub fn square_value(sum: u128) -> f64 {
    if sum == u128::MAX { f64::INFINITY } else { sum as f64 * power_of_two(-SQUARE_FRACTION_BITS) }
}

/// Exact for exponents of normal numbers.
const fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((1023 + exponent) as u64) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_terms_do_not_overflow_their_sum() {
        let (term, cut) = signed(f64::MAX);
        assert!(cut);
        assert!(term.checked_mul((1 << 24) - 1).is_some());
        assert_eq!(signed(-LARGEST_TERM), (-term, false));
    }

    #[test]
    fn rounding_is_to_the_nearest_step() {
        for value in [1.0, -1.5, 3.7e8, 1e-12, -2.6e-19, 0.0] {
            let (fixed, cut) = signed(value);
            assert!(!cut && (signed_value(fixed) - value).abs() <= 0.5 * power_of_two(-64), "{value}");
        }
        for value in [1.0, 1e20, 1e-12, 1.1e-17, 0.0] {
            let (fixed, cut) = square(value);
            assert!(!cut && (square_value(fixed) - value).abs() <= 0.5 * power_of_two(-56), "{value}");
        }
    }

    #[test]
    fn squares_saturate() {
        assert_eq!(square(1e30), (u128::MAX, true));
        assert_eq!(square_value(u128::MAX), f64::INFINITY);
    }
}
