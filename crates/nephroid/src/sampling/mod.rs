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
    let (a, b) = (pdf * pdf, other_pdf * other_pdf);
    if a + b > 0.0 { a / (a + b) } else { 0.0 }
}
