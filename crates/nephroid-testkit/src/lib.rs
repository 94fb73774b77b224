//! Statistical tests and numerical checks for renderers.
//!
//! The crate knows no type of the renderer: everything takes closures, slices and plain arrays, so that a
//! mistake in the renderer's own mathematics cannot hide in its tests.
//!
//! A sampler is checked against the density that it claims:
//!
//! ```
//! use nephroid_testkit::{ALPHA, Pcg32, SphereTest};
//!
//! let mut rng = Pcg32::new(1);
//! let cosine_weighted = || {
//!     let ([u, v], turn) = (rng.vec2(), core::f64::consts::TAU);
//!     Some([u.sqrt() * libm::cos(turn * v), u.sqrt() * libm::sin(turn * v), (1.0 - u).sqrt()])
//! };
//! let pdf_solid_angle = |d: [f64; 3]| d[2].max(0.0) / core::f64::consts::PI;
//! SphereTest::default().run(cosine_weighted, pdf_solid_angle).assert_passes(ALPHA);
//! ```
//!
//! # Which test
//!
//! | question | test |
//! |---|---|
//! | do these directions, points on a disk or pairs follow this density? | [`SphereTest`], [`DiskTest`], [`ChiSquareTest`] |
//! | do these indices follow these probabilities? | [`goodness_of_fit`] |
//! | do these numbers follow this distribution function? | [`ks_test`] |
//! | is this estimator's mean the exact value? | [`MeanTest::against`], [`MeanTest::within`] |
//! | have these two estimators the same mean? | [`MeanTest::welch`] |
//! | does this happen with this probability? | [`binomial_test`] |
//! | does this picture agree with its reference? | [`PixelTest`], or [`rmse`], [`rel_mse`], [`mean_ratio`] |
//! | what is the exact value? | [`integrate`], [`integrate_2d`] |
//!
//! Every test returns an [`Outcome`]. How often a correct program fails is explained at [`ALPHA`].

mod binomial;
mod chi2;
mod image;
mod ks;
mod mean;
mod outcome;
mod quadrature;
mod rng;
mod significance;
mod special;

pub use binomial::binomial_test;
pub use chi2::{ChiSquareTest, DiskTest, Domain, SphereTest, goodness_of_fit};
pub use image::{PixelTest, mean_ratio, rel_mse, rmse};
pub use ks::ks_test;
pub use mean::{MeanTest, z_test};
pub use outcome::Outcome;
pub use quadrature::{Integral, Tolerance, integrate, integrate_2d};
pub use rng::Pcg32;
pub use significance::{ALPHA, sidak};
