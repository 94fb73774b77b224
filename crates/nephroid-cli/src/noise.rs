//! How much a picture still changes.

use nephroid::film::Film;

/// Of the squared mean luminance: it keeps dark pixels, whose relative error nobody sees, from counting most.
const DARK: f64 = 0.01;

/// The relative standard error of a picture's pixels: √ mean of σ² / (Y² + a hundredth of the picture's mean squared).
/// None where too few samples were taken to tell.
///
/// The variance is that between samples. Those of one pass share its photons, so what the photons of all passes so far
/// have in common is not in it.
pub fn noise(film: &Film) -> Option<f64> {
    let mean = film.mean_luminance();
    let floor = DARK * mean * mean;
    let image = film.develop();
    let (mut sum, mut count) = (0.0, 0u64);
    for (variance, pixel) in film.variance().into_iter().zip(&image.pixels) {
        let luminance = f64::from(pixel.luminance());
        let divisor = luminance * luminance + floor;
        if variance.is_finite() && divisor > 0.0 {
            sum += variance / divisor;
            count += 1;
        }
    }
    (count > 0).then(|| (sum / count as f64).sqrt())
}

/// For a line of text.
pub fn percent(noise: f64) -> String {
    let percent = 100.0 * noise;
    let digits = if percent < 0.1 {
        3
    } else if percent < 10.0 {
        2
    } else {
        1
    };
    format!("{percent:.digits$} %")
}

#[cfg(test)]
mod tests {
    use super::*;
    use nephroid::color::Rgb;
    use nephroid::film::PixelSum;

    fn film(values: &[f32]) -> Film {
        let mut film = Film::new(2, 1);
        for &value in values {
            let mut sum = PixelSum::default();
            sum.add(Rgb::splat(value), 1.0);
            film.add_iteration(&[sum, sum]);
        }
        film
    }

    #[test]
    fn it_is_the_standard_error_over_the_mean() {
        // Mean 2, standard deviation √2, of two samples: a standard error of 1. The floor is a hundredth of 2².
        let expected = (1.0 / (4.0 + 0.04f64)).sqrt();
        let found = noise(&film(&[1.0, 3.0])).unwrap();
        assert!((found - expected).abs() < 1e-6, "{found}");
        assert_eq!(noise(&film(&[2.0, 2.0])), Some(0.0));
        assert_eq!(noise(&film(&[2.0])), None);
        assert_eq!(noise(&film(&[0.0, 0.0])), None);
    }

    #[test]
    fn it_is_easy_to_read() {
        assert_eq!([0.0131, 0.2, 0.00012].map(percent), ["1.31 %", "20.0 %", "0.012 %"]);
    }
}
