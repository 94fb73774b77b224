//! Fixed-point numbers, whose sums do not depend on the order of the terms.
//!
//! A sum of light counts in steps of a fraction of the film's *unit*, 2^`unit`, so that the same bits do for
//! scenes of any brightness. Dividing by a power of two rounds nothing.

/// A number rounded to a step, and whether it had to be cut to fit.
pub type Rounded<T> = (T, bool);

/// Units are brought between −`UNIT_LIMIT` and `UNIT_LIMIT`, which is more than single precision spans.
pub const UNIT_LIMIT: i32 = 160;

/// How a sum of signed numbers is kept.
#[derive(Clone, Copy, Debug)]
pub struct Signed {
    /// Bits of the sum, its sign included.
    bits: u32,
    /// It counts in steps of 2^−`fraction_bits` units.
    fraction_bits: i32,
    /// 2^`headroom` of the largest terms still fit.
    headroom: u32,
}

/// Radiance of the picture: up to ±2^47 units, and ±2^32 of them from one iteration.
pub const RADIANCE: Signed = Signed { bits: 96, fraction_bits: 48, headroom: 15 };

/// Weights of the picture, which have no unit: up to ±2^31, and ±2^16 from one iteration.
pub const WEIGHT: Signed = Signed { bits: 64, fraction_bits: 32, headroom: 15 };

/// Whatever a layer has: up to ±2^63, and ±2^39 from one iteration.
pub const LAYER: Signed = Signed { bits: 128, fraction_bits: 64, headroom: 24 };

impl Signed {
    const fn largest(self) -> i128 {
        i128::MAX >> (128 - self.bits)
    }

    /// A term, which must be finite.
    pub fn term(self, value: f64, unit: i32) -> Rounded<i128> {
        let scaled = (value * power_of_two(self.fraction_bits - unit)).round();
        // The conversion saturates, far beyond the bound.
        let rounded = scaled as i128;
        let bound = self.largest() >> self.headroom;
        let cut = rounded.clamp(-bound, bound);
        (cut, cut != rounded)
    }

    /// A sum and a further term.
    pub fn sum(self, a: i128, b: i128) -> i128 {
        let largest = self.largest();
        a.saturating_add(b).clamp(-largest - 1, largest)
    }

    /// Whether a number can be such a sum.
    pub fn holds(self, sum: i128) -> bool {
        self.sum(sum, 0) == sum
    }

    /// The number that a sum stands for.
    pub fn value(self, sum: i128, unit: i32) -> f64 {
        sum as f64 * power_of_two(unit - self.fraction_bits)
    }
}

/// Sums of squares are counted in steps of 2^−40 units squared: what a small lamp that is seen brings
/// counts in full, and what is a millionth of a typical radiance does not.
const SQUARE_FRACTION_BITS: i32 = 40;

/// A sum of squares that has become as large as that, 2^56 units squared, tells nothing but that.
pub const SATURATED_SQUARE: u128 = u128::MAX >> 32;

/// A term of a sum of squares, which must be finite and not below zero.
pub fn square(value: f64, unit: i32) -> Rounded<u128> {
    let scaled = (value * power_of_two(SQUARE_FRACTION_BITS - 2 * unit)).round();
    // The conversion saturates, beyond the bound.
    let square = (scaled as u128).min(SATURATED_SQUARE);
    (square, square == SATURATED_SQUARE)
}

/// A sum of squares and a further term. Once saturated it stays so, whatever the order.
pub fn sum_of_squares(a: u128, b: u128) -> u128 {
    a.saturating_add(b).min(SATURATED_SQUARE)
}

/// The number that a sum of squares stands for; infinite if it saturated.
pub fn square_value(sum: u128, unit: i32) -> f64 {
    if sum >= SATURATED_SQUARE {
        return f64::INFINITY;
    }
    sum as f64 * power_of_two(2 * unit - SQUARE_FRACTION_BITS)
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
        for (kind, headroom) in [(RADIANCE, 15), (WEIGHT, 15), (LAYER, 24)] {
            let (term, cut) = kind.term(f64::MAX, 0);
            assert!(cut);
            let all = term << headroom;
            assert!(kind.holds(all) && kind.holds(-all), "{kind:?}");
            assert!(!kind.holds(all) || !kind.holds(all.saturating_add(1 << headroom)) || kind.bits == 128);
            assert_eq!(kind.term(-f64::MAX, 0), (-term, true));
        }
        assert_eq!(RADIANCE.term(4_294_967_295.0, 0), (4_294_967_295 << 48, false));
        assert!(RADIANCE.term(4_294_967_296.0, 0).1);
        assert_eq!(WEIGHT.term(-65_535.0, 0), (-65_535 << 32, false));
    }

    #[test]
    fn sums_end_at_their_bounds() {
        let largest = (1i128 << 95) - 1;
        assert_eq!(RADIANCE.sum(largest, 1), largest);
        assert_eq!(RADIANCE.sum(-largest, -2), -largest - 1);
        assert!(!RADIANCE.holds(largest + 1));
        assert!(WEIGHT.holds(i128::from(i64::MIN)) && !WEIGHT.holds(i128::from(i64::MIN) - 1));
        assert!(LAYER.holds(i128::MIN) && LAYER.sum(i128::MAX, 1) == i128::MAX);
    }

    #[test]
    fn rounding_is_to_the_nearest_step() {
        for unit in [0, -40, 40, UNIT_LIMIT, -UNIT_LIMIT] {
            let of_unit = power_of_two(unit);
            for value in [1.0, -1.5, 3.7e8, 1e-12, -2.6e-15, 0.0].map(|v| v * of_unit) {
                let (fixed, cut) = RADIANCE.term(value, unit);
                let error = (RADIANCE.value(fixed, unit) - value).abs();
                assert!(!cut && error <= 0.5 * power_of_two(unit - 48), "{value}");
            }
            for value in [1.0, 1e14, 1e-12, 1.1e-14, 0.0].map(|v| v * of_unit * of_unit) {
                let (fixed, cut) = square(value, unit);
                let error = (square_value(fixed, unit) - value).abs();
                assert!(!cut && error <= 0.5 * power_of_two(2 * unit - SQUARE_FRACTION_BITS), "{value}");
            }
        }
        let (fixed, cut) = LAYER.term(-2.6e-19, 0);
        assert!(!cut && (LAYER.value(fixed, 0) + 2.6e-19).abs() <= 0.5 * power_of_two(-64));
    }

    #[test]
    fn filter_weights_are_exact() {
        for weight in [1.0f32, -1.25, 1.1, 0.987_654_3] {
            let (fixed, cut) = WEIGHT.term(f64::from(weight), 0);
            assert!(!cut && WEIGHT.value(fixed, 0) == f64::from(weight), "{weight}");
        }
    }

    #[test]
    fn squares_saturate() {
        assert_eq!(square(1e30, 0), (SATURATED_SQUARE, true));
        assert_eq!(square(f64::MAX, -UNIT_LIMIT), (SATURATED_SQUARE, true));
        let almost = SATURATED_SQUARE - 1;
        assert!(square_value(almost, 0).is_finite());
        assert_eq!(square_value(sum_of_squares(almost, 1), 0), f64::INFINITY);
        assert_eq!(sum_of_squares(SATURATED_SQUARE, SATURATED_SQUARE), SATURATED_SQUARE);
    }
}
