//! Comparisons of pictures, as slices of single-precision values of any number of channels.

use crate::Outcome;
use crate::special::{binomial_upper, normal_two_sided};

/// The root of the mean squared difference, in units of the pictures.
///
/// # Panics
/// If the slices differ in length. Empty slices give NaN.
#[must_use]
pub fn rmse(image: &[f32], reference: &[f32]) -> f64 {
    mean_over(image, reference, |a, r| (a - r) * (a - r)).sqrt()
}

/// The relative mean squared error, the mean of (a − r)² / (r² + ε).
///
/// `epsilon` is a squared radiance and keeps black pixels from deciding the result: 1e-2 times the square of the
/// reference's mean is customary. It has no default, because pictures have no common unit.
///
/// # Panics
/// If the slices differ in length. Empty slices give NaN.
#[must_use]
pub fn rel_mse(image: &[f32], reference: &[f32], epsilon: f64) -> f64 {
    mean_over(image, reference, |a, r| (a - r) * (a - r) / (r * r + epsilon))
}

/// The mean of `image` divided by the mean of `reference`: 1 where they have the same energy.
///
/// # Panics
/// If the slices differ in length. NaN where the reference is black.
#[must_use]
pub fn mean_ratio(image: &[f32], reference: &[f32]) -> f64 {
    mean_over(image, reference, |a, _| a) / mean_over(image, reference, |_, r| r)
}

fn mean_over(image: &[f32], reference: &[f32], term: impl Fn(f64, f64) -> f64) -> f64 {
    assert_eq!(image.len(), reference.len(), "pictures of different size");
    let terms = image.iter().zip(reference).map(|(&a, &r)| term(f64::from(a), f64::from(r)));
    terms.sum::<f64>() / image.len() as f64
}

/// A Z-test of every pixel of a picture against a reference, with one p-value for all of them.
///
/// With no outliers allowed the p-value is the smallest of the pixels', Šidák-corrected for their number. With m
/// allowed it is that of the (m+1)-th smallest, whose distribution under the hypothesis is known as well, so that the
/// false-positive rate stays α in either case. Pixels must be independent of each other (box filter) and their
/// means nearly normal.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PixelTest {
    /// Share of pixels that is ignored, worst first, for pictures with heavy tails whose variances are
    /// themselves uncertain: 0.0025, say.
    pub outliers: f64,
    /// The difference forgiven in each pixel, relative to the reference: a stated bias, or rounding.
    pub relative_bias: f64,
}

impl PixelTest {
    /// Tests `image` against `reference`.
    ///
    /// `variance` is, per value, the variance of the *difference* of the two pictures: of the mean over a pixel's
    /// samples, not of one sample, and the sum of both pictures' where the reference has noise too.
    ///
    /// # Panics
    /// If the slices differ in length.
    pub fn run(&self, image: &[f32], reference: &[f32], variance: &[f32]) -> Outcome {
        assert_eq!(image.len(), reference.len(), "pictures of different size");
        assert_eq!(image.len(), variance.len(), "one variance per value is needed");
        let mut scores: Vec<(f64, usize)> = (0..image.len())
            .map(|i| self.score(f64::from(image[i]), f64::from(reference[i]), f64::from(variance[i])))
            .zip(0..)
            .collect();
        scores.sort_by(|a, b| b.0.total_cmp(&a.0));
        let ignored = (self.outliers * scores.len() as f64) as usize;
        let Some(&(score, worst)) = scores.get(ignored) else {
            let details = "no pixel to test".to_owned();
            return Outcome { test: "pixels", statistic: f64::NAN, dof: None, p_value: f64::NAN, details };
        };
        let p_value = binomial_upper(ignored as u64 + 1, scores.len() as u64, normal_two_sided(score));
        let details = format!(
            "{} values, worst {ignored} ignored; then value {worst}: {:.6e}, reference {:.6e} ± {:.1e}; mean ratio {:.6}",
            scores.len(),
            image[worst],
            reference[worst],
            f64::from(variance[worst]).sqrt(),
            mean_ratio(image, reference),
        );
        Outcome { test: "pixels", statistic: score, dof: None, p_value, details }
    }

    /// |z| of one pixel; infinite where a number is undefined.
    fn score(&self, value: f64, reference: f64, variance: f64) -> f64 {
        let difference = (value - reference).abs();
        if !difference.is_finite() || variance.is_nan() || variance < 0.0 {
            return f64::INFINITY;
        }
        let excess = difference - self.relative_bias * reference.abs();
        if excess <= 0.0 { 0.0 } else { excess / variance.sqrt() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ALPHA, Pcg32, binomial_test, sidak};

    #[test]
    fn errors_done_by_hand() {
        let (image, reference) = ([1.0, 2.0, 4.0], [1.0, 1.0, 2.0]);
        assert!((rmse(&image, &reference) - (5.0_f64 / 3.0).sqrt()).abs() < 1e-15);
        assert!((rel_mse(&image, &reference, 0.0) - 2.0 / 3.0).abs() < 1e-15);
        assert!((rel_mse(&image, &reference, 1.0) - (0.5 + 0.8) / 3.0).abs() < 1e-15);
        assert!((mean_ratio(&image, &reference) - 1.75).abs() < 1e-15);
        assert!(rmse(&[f32::NAN], &[1.0]).is_nan() && rmse(&[], &[]).is_nan());
    }

    #[test]
    #[should_panic(expected = "different size")]
    fn pictures_of_different_size_cannot_be_compared() {
        let _ = rmse(&[1.0], &[1.0, 2.0]);
    }

    /// A picture whose pixels are means of 64 uniform numbers, scaled, with its reference and variances.
    fn noisy(rng: &mut Pcg32, pixels: usize) -> [Vec<f32>; 3] {
        let mut picture = [const { Vec::new() }; 3];
        for i in 0..pixels {
            let radiance = 1.0 + (i % 7) as f32;
            let mean = (0..64).map(|_| rng.next_f32()).sum::<f32>() / 32.0;
            picture[0].push(radiance * mean);
            picture[1].push(radiance);
            picture[2].push(radiance * radiance * 4.0 / (12.0 * 64.0));
        }
        picture
    }

    #[test]
    fn accepts_a_right_picture_and_rejects_one_wrong_pixel() {
        let [mut image, reference, variance] = noisy(&mut Pcg32::new(1), 10_000);
        PixelTest::default().run(&image, &reference, &variance).assert_passes(ALPHA);
        image[1234] = reference[1234] + 7.0 * variance[1234].sqrt();
        let outcome = PixelTest::default().run(&image, &reference, &variance);
        outcome.assert_rejects(1e-6);
        assert!(outcome.details.contains("value 1234"), "{outcome}");
        // One outlier in a thousand is allowed to be as wrong as it likes, but not eleven.
        let tolerant = PixelTest { outliers: 0.001, ..Default::default() };
        tolerant.run(&image, &reference, &variance).assert_passes(ALPHA);
        (0..11).for_each(|i| image[100 * i] = 1e9);
        tolerant.run(&image, &reference, &variance).assert_rejects(1e-6);
    }

    /// Single pixels of 1 % noise show a picture that is 10 % too bright; an allowance of as much forgives it.
    #[test]
    fn rejects_a_picture_ten_per_cent_off_unless_it_is_allowed() {
        let [image, reference, variance] = noisy(&mut Pcg32::new(2), 10_000);
        let quiet = |i: usize| reference[i] + 0.1 * (image[i] - reference[i]);
        let bright: Vec<f32> = (0..image.len()).map(|i| 1.1 * quiet(i)).collect();
        let variance: Vec<f32> = variance.iter().map(|v| 0.01 * v).collect();
        PixelTest::default().run(&bright, &reference, &variance).assert_rejects(1e-6);
        let tolerant = PixelTest { relative_bias: 0.11, ..Default::default() };
        tolerant.run(&bright, &reference, &variance).assert_passes(ALPHA);
    }

    /// 1000 right pictures of 100 pixels at a level of 5 %, with and without outliers.
    #[test]
    fn the_false_positive_rate_is_the_level() {
        for outliers in [0.0, 0.05] {
            let mut rng = Pcg32::new(3);
            let test = PixelTest { outliers, ..Default::default() };
            let rejected = (0..1000).filter(|_| {
                let [image, reference, variance] = noisy(&mut rng, 100);
                !test.run(&image, &reference, &variance).passes(0.05)
            });
            binomial_test(rejected.count() as u64, 1000, 0.05).assert_passes(sidak(ALPHA, 2));
        }
    }

    #[test]
    fn without_variance_only_equality_passes_and_undefined_values_never_do() {
        let test = PixelTest::default();
        test.run(&[1.0, 2.0], &[1.0, 2.0], &[0.0, 0.0]).assert_passes(ALPHA);
        test.run(&[1.0, 2.1], &[1.0, 2.0], &[0.0, 0.0]).assert_rejects(ALPHA);
        test.run(&[1.0, f32::NAN], &[1.0, 2.0], &[1.0, 1.0]).assert_rejects(ALPHA);
        test.run(&[1.0, 2.0], &[1.0, 2.0], &[1.0, f32::NAN]).assert_rejects(ALPHA);
        test.run(&[], &[], &[]).assert_rejects(ALPHA);
    }
}
