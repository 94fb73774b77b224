use crate::color::Rgb;
use crate::texture::Image;

/// Two pictures that should have had the same size.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("one picture is {}×{} pixels, the other {}×{}", first.0, first.1, second.0, second.1)]
pub struct SizeMismatch {
    /// Width and height of one.
    pub first: (u32, u32),
    /// Width and height of the other.
    pub second: (u32, u32),
}

impl SizeMismatch {
    pub(crate) fn check(first: (u32, u32), second: (u32, u32)) -> Result<(), Self> {
        if first == second { Ok(()) } else { Err(Self { first, second }) }
    }

    fn check_images(first: &Image, second: &Image) -> Result<(), Self> {
        Self::check((first.width, first.height), (second.width, second.height))
    }
}

/// How far a picture is from its reference, over all pixels and channels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImageError {
    /// Root of the mean squared difference, in the picture's unit.
    pub rmse: f64,
    /// Mean of (a − r)² / (r² + ε).
    pub rel_mse: f64,
    /// Mean of the picture by mean of the reference; 1 if both are zero.
    pub mean_ratio: f64,
    /// Pixels left out because one of the two is not finite there.
    pub non_finite: usize,
}

impl ImageError {
    /// The usual ε of [`ImageError::rel_mse`], for pictures whose values are around 1.
    pub const EPSILON: f64 = 0.01;

    /// Compares `image` with `reference`, both linear. Without a pixel to compare, all is perfect.
    pub fn between(image: &Image, reference: &Image, epsilon: f64) -> Result<Self, SizeMismatch> {
        SizeMismatch::check_images(image, reference)?;
        let (mut sq, mut rel_sq, mut sum, mut reference_sum) = (0.0, 0.0, 0.0, 0.0);
        let mut compared = 0usize;
        for (&a, &r) in image.pixels.iter().zip(&reference.pixels) {
            if !(a.is_finite() && r.is_finite()) {
                continue;
            }
            compared += 1;
            for (a, r) in a.to_array().into_iter().zip(r.to_array()) {
                let (a, r) = (f64::from(a), f64::from(r));
                let difference_sq = (a - r) * (a - r);
                sq += difference_sq;
                rel_sq += if difference_sq == 0.0 { 0.0 } else { difference_sq / (r * r + epsilon) };
                sum += a;
                reference_sum += r;
            }
        }
        let n = (3 * compared).max(1) as f64;
        Ok(Self {
            rmse: (sq / n).sqrt(),
            rel_mse: rel_sq / n,
            mean_ratio: if sum == reference_sum { 1.0 } else { sum / reference_sum },
            non_finite: image.pixels.len() - compared,
        })
    }
}

/// Where `image` is brighter (red) and darker (blue) than `reference`, as display values in
/// [0, 1]: full colour stands for a difference in luminance of `full_scale` or more, black for
/// none, and green for values that are not finite. Without `full_scale` the largest difference
/// takes its place.
pub fn difference_picture(
    image: &Image,
    reference: &Image,
    full_scale: Option<f32>,
) -> Result<Image, SizeMismatch> {
    SizeMismatch::check_images(image, reference)?;
    let pairs = image.pixels.iter().zip(&reference.pixels);
    let differences = pairs.map(|(a, r)| a.luminance() - r.luminance());
    let largest = || differences.clone().filter(|d| d.is_finite()).fold(0.0f32, |m, d| m.max(d.abs()));
    let full_scale = full_scale.unwrap_or_else(largest);
    let colour = |d: f32| {
        if !d.is_finite() {
            return Rgb::new(0.0, 1.0, 0.0);
        }
        let strength = if d == 0.0 { 0.0 } else { (d.abs() / full_scale).min(1.0) };
        if d > 0.0 { Rgb::new(strength, 0.0, 0.0) } else { Rgb::new(0.0, 0.0, strength) }
    };
    let pixels = differences.clone().map(colour).collect();
    Ok(Image { width: image.width, height: image.height, pixels })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pair(a: Rgb, b: Rgb) -> Image {
        Image { width: 2, height: 1, pixels: vec![a, b] }
    }

    #[test]
    fn errors_with_hand_computed_numbers() {
        let image = pair(Rgb::new(2.0, 1.0, 1.0), Rgb::BLACK);
        let reference = pair(Rgb::WHITE, Rgb::new(0.0, 0.0, 2.0));
        let error = ImageError::between(&image, &reference, 0.01).unwrap();
        // Squares: 1 and 4 of six values; relative 1/1.01 and 4/4.01; sums 4 and 5.
        assert!((error.rmse - (5.0f64 / 6.0).sqrt()).abs() < 1e-12);
        assert!((error.rel_mse - (1.0 / 1.01 + 4.0 / 4.01) / 6.0).abs() < 1e-12);
        assert!((error.mean_ratio - 0.8).abs() < 1e-12);
        assert_eq!(error.non_finite, 0);
    }

    #[test]
    fn equal_black_and_empty_pictures_have_no_error() {
        let perfect = ImageError { rmse: 0.0, rel_mse: 0.0, mean_ratio: 1.0, non_finite: 0 };
        for image in [pair(Rgb::WHITE, Rgb::BLACK), pair(Rgb::BLACK, Rgb::BLACK), Image::default()] {
            assert_eq!(ImageError::between(&image, &image, 0.0), Ok(perfect));
        }
    }

    #[test]
    fn broken_pixels_are_left_out_and_counted() {
        let image = pair(Rgb::splat(f32::NAN), Rgb::splat(3.0));
        let error = ImageError::between(&image, &pair(Rgb::WHITE, Rgb::splat(1.0)), 0.01).unwrap();
        assert_eq!((error.rmse, error.mean_ratio, error.non_finite), (2.0, 3.0, 1));
    }

    #[test]
    fn sizes_must_agree() {
        let tall = Image::filled(1, 2, Rgb::BLACK);
        let wide = Image::filled(2, 1, Rgb::BLACK);
        assert!(ImageError::between(&tall, &wide, 0.01).is_err());
        assert!(difference_picture(&tall, &wide, None).is_err());
    }

    #[test]
    fn brighter_is_red_and_darker_is_blue() {
        let image = pair(Rgb::splat(3.0), Rgb::splat(0.5));
        let reference = pair(Rgb::splat(1.0), Rgb::splat(1.0));
        let picture = |scale| difference_picture(&image, &reference, scale).unwrap().pixels;
        assert_eq!(picture(None)[0], Rgb::new(1.0, 0.0, 0.0));
        assert!((picture(None)[1].b - 0.25).abs() < 1e-6 && picture(None)[1].r == 0.0);
        assert_eq!(picture(Some(0.25))[1], Rgb::new(0.0, 0.0, 1.0));
        let same = difference_picture(&image, &image, None).unwrap();
        assert!(same.pixels.iter().all(|p| p.is_black()));
        let broken = difference_picture(&pair(Rgb::splat(f32::NAN), Rgb::BLACK), &reference, None).unwrap();
        assert_eq!(broken.pixels[0], Rgb::new(0.0, 1.0, 0.0));
    }
}
