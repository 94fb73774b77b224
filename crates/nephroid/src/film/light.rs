//! What light each pixel has without its noise, as far as a picture tells.

use rayon::prelude::*;

use super::Film;
use super::pixel::luminance;

/// Of the squared mean luminance: it keeps dark pixels, whose relative error nobody sees, from counting most.
const DARK: f64 = 0.01;

/// How far from what is around them pixels are thought to be before they are known: their variance over that light squared.
const CONTRAST: f64 = 0.1;

/// As many times its variance a pixel's squared distance from what is around it may be by luck: once is what a single bright
/// sample among dark ones has, and k times what k of them have.
const LUCK: f64 = 2.0;

/// What errors of pixels are measured by.
pub(super) struct Lights {
    /// Σ wL / Σ w of luminances, row by row.
    pub means: Vec<f64>,
    /// The [variance](Film::variance) of each.
    pub variances: Vec<f64>,
    /// What a squared error of each is divided by: t² + (m/10)², with its light t without noise and the mean luminance m
    /// of the picture.
    pub divisors: Vec<f64>,
}

impl Lights {
    /// Those of a film.
    ///
    /// A pixel's own luminance will not do for t where it is noisy: a bright sample that makes a large error makes as
    /// large a divisor, and the error of a picture with a few such samples would seem a fifth of what it is. So t is the
    /// pixel's luminance where that is known well, and the mean of its eight neighbours *without it* where it is not,
    /// weighted as a Wiener filter does (Lee 1980, doi 10.1109/TPAMI.1980.4766994). The further a pixel is
    /// from its neighbours than [`LUCK`] explains, as the image of a lamp in a mirror is, the more it stands for itself.
    pub fn of(film: &Film) -> Self {
        let unit = film.unit();
        let (means, variances): (Vec<f64>, Vec<f64>) =
            film.pixels().par_iter().map(|pixel| (luminance(pixel.mean(unit)), pixel.variance(unit))).unzip();
        let mean = means.iter().sum::<f64>() / means.len().max(1) as f64;
        let floor = DARK * mean * mean;
        let width = film.width() as usize;
        let divisor = |pixel: usize| {
            let light = light(&means, &variances, width, pixel);
            light * light + floor
        };
        let divisors = (0..means.len()).into_par_iter().map(divisor).collect();
        Self { means, variances, divisors }
    }

    /// The mean of squares over divisors, of the pixels that have some.
    pub fn mean(&self, square: impl Fn(usize) -> Option<f64> + Sync) -> Option<f64> {
        let of = |pixel: usize| {
            let divisor = self.divisors[pixel];
            square(pixel).filter(|_| divisor > 0.0).map(|square| square / divisor)
        };
        let terms: Vec<Option<f64>> = (0..self.divisors.len()).into_par_iter().map(of).collect();
        // One after another, whoever made them.
        let (mut sum, mut count) = (0.0, 0u64);
        for term in terms.into_iter().flatten() {
            sum += term;
            count += 1;
        }
        (count > 0).then(|| sum / count as f64)
    }
}

fn light(means: &[f64], variances: &[f64], width: usize, pixel: usize) -> f64 {
    let (own, variance) = (means[pixel], variances[pixel]);
    let (x, y) = (pixel % width, pixel / width);
    let height = means.len() / width;
    let (mut sum, mut count) = (-own, -1.0);
    for row in y.saturating_sub(1)..(y + 2).min(height) {
        for column in x.saturating_sub(1)..(x + 2).min(width) {
            sum += means[row * width + column];
            count += 1.0;
        }
    }
    if count == 0.0 {
        return own;
    }
    let around = sum / count;
    let expected = CONTRAST * around * around;
    let seen = (own - around) * (own - around) - LUCK * variance;
    let expected = expected.max(seen);
    // An infinite variance knows nothing of the pixel, and none at all everything.
    let known = if variance == 0.0 { 1.0 } else { expected / (expected + variance) };
    around + known * (own - around)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Rgb;
    use crate::film::PixelSum;

    fn film(samples: &[[f32; 9]]) -> Film {
        let mut film = Film::new(3, 3);
        for values in samples {
            let sums: Vec<PixelSum> = values
                .iter()
                .map(|&value| {
                    let mut sum = PixelSum::default();
                    sum.add(Rgb::splat(value), 1.0);
                    sum
                })
                .collect();
            film.add_iteration(&sums);
        }
        film
    }

    #[test]
    fn what_is_known_is_its_own_measure() {
        let values = [1.0, 2.0, 3.0, 0.0, 5.0, 6.0, 7.0, 8.0, 9.0];
        let lights = Lights::of(&film(&[values, values]));
        let mean = 41.0 / 9.0;
        for (divisor, value) in lights.divisors.iter().zip(values) {
            let expected = f64::from(value * value) + 0.01 * mean * mean;
            assert!((divisor - expected).abs() < 1e-5, "{divisor} {expected}");
        }
    }

    /// One sample of 100 among ones: its variance is as large as it is, so it is measured by what is around it.
    #[test]
    fn a_bright_sample_is_no_measure_of_itself() {
        let mut bright = [1.0; 9];
        bright[4] = 400.0;
        let lights = Lights::of(&film(&[[1.0; 9], bright, [1.0; 9], [1.0; 9]]));
        let floor = 0.01 * (108.75f64 / 9.0).powi(2);
        let light = libm::sqrt(lights.divisors[4] - floor);
        assert!(light > 1.0 && light < 1.01, "{light}");
    }

    /// A sixth of the samples see a lamp: twenty have seen it, and no luck does that.
    #[test]
    fn an_image_of_a_lamp_is_its_own_measure() {
        let mut lamp = [0.1; 9];
        lamp[4] = 100.0;
        let samples: Vec<[f32; 9]> = (0..120).map(|i| if i % 6 == 0 { lamp } else { [0.1; 9] }).collect();
        let lights = Lights::of(&film(&samples));
        let own = 0.1 + 99.9 / 6.0;
        let light = libm::sqrt(lights.divisors[4]);
        assert!((light / own - 1.0).abs() < 0.1, "{light} {own}");
    }

    #[test]
    fn a_single_pixel_is_its_own_measure() {
        let mut film = Film::new(1, 1);
        film.add_iteration(&[PixelSum {
            radiance: [2.0; 3],
            weight: 1.0,
            samples: 1,
            ..PixelSum::default()
        }]);
        assert!((Lights::of(&film).divisors[0] - 4.04).abs() < 1e-9);
        assert!(Lights::of(&Film::new(0, 0)).divisors.is_empty());
    }
}
