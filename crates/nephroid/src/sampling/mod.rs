//! Random and low-discrepancy numbers, discrete tables and sampling weights.
//!
//! Every number is a function of (seed, iteration, stream, path, dimension): nothing depends on
//! threads or on the order of the work.

mod discrete;
mod key;
mod sampler;

pub use discrete::{Discrete, Discrete2d};
pub use key::{Key, Stream};
pub use sampler::{Sampler, Sequence};

/// The power heuristic with exponent 2 for one sample of each of two techniques (Veach 1997,
/// §9.2.4): the weight of the technique whose density is `pdf`.
#[inline]
pub fn power_heuristic(pdf: f32, other_pdf: f32) -> f32 {
    if pdf.is_infinite() {
        return 1.0;
    }
    if pdf <= 0.0 {
        return 0.0;
    }
    // As a ratio, since the square of a lamp's density far away may be beyond single precision.
    let ratio = other_pdf / pdf;
    1.0 / (1.0 + ratio * ratio)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_weights_of_two_techniques_add_up_to_one_at_any_scale() {
        for (a, b) in [(1.0, 3.0), (1e-30, 2e-30), (3e19, 0.3), (1e38, 1e38), (2.0, 0.0)] {
            let sum = power_heuristic(a, b) + power_heuristic(b, a);
            assert!((sum - 1.0).abs() < 1e-6, "{a} and {b}: {sum}");
        }
        assert_eq!(power_heuristic(1.0, 3.0), 0.1);
        assert_eq!((power_heuristic(0.0, 0.0), power_heuristic(f32::INFINITY, 1.0)), (0.0, 1.0));
    }
}
