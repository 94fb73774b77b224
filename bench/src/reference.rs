//! What pictures are compared with.

use std::path::Path;

use nephroid::color::Rgb;
use nephroid::film::ImageError;
use nephroid::texture::Image;
use nephroid_formats::image::read_image;

/// A picture that others are compared with, and its own noise.
pub struct Reference {
    picture: Image,
    noise: Option<f64>,
}

impl Reference {
    /// Reads `A.exr`, or `A.exr,B.exr`: two pictures that are independent of one another, of which the mean is taken.
    pub fn read(files: &str) -> Result<Self, String> {
        let read = |path: &str| read_image(Path::new(path)).map(|file| file.image).map_err(|e| e.to_string());
        match files.split_once(',') {
            Some((a, b)) => Self::halves(&read(a)?, &read(b)?),
            None => Ok(Self { picture: read(files)?, noise: None }),
        }
    }

    /// The mean of two halves a, b, and its noise, the mean of ((a − b)/2)² / (m² + ε) about their mean m.
    ///
    /// To subtract it is to average (x − a)(x − b) / (m² + ε), whose noise in a and in b cancels in the mean.
    pub fn halves(a: &Image, b: &Image) -> Result<Self, String> {
        let pixels: Vec<Rgb> = a.pixels.iter().zip(&b.pixels).map(|(&a, &b)| (a + b) * 0.5).collect();
        let picture = Image { width: a.width, height: a.height, pixels };
        let noise = ImageError::between(b, &picture, ImageError::EPSILON).map_err(|e| e.to_string())?.rel_mse;
        Ok(Self { picture, noise: Some(noise) })
    }

    /// Its own relMSE, if there are halves to know it from.
    pub fn noise(&self) -> Option<f64> {
        self.noise
    }

    /// relMSE, without the noise of the reference if that is known, and the ratio of the means.
    pub fn compare(&self, picture: &Image) -> Result<(f64, f64), String> {
        let error = ImageError::between(picture, &self.picture, ImageError::EPSILON);
        let error = error.map_err(|e| e.to_string())?;
        Ok((error.rel_mse - self.noise.unwrap_or(0.0), error.mean_ratio))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_of_halves_is_taken_off() {
        let [a, b, x] = [1.0, 3.0, 5.0].map(|value| Image::filled(1, 1, Rgb::splat(value)));
        let reference = Reference::halves(&a, &b).expect("they are of one size");
        // m = 2: ((3 − 1)/2)² and (5 − 1)(5 − 3), both over m² + 0.01.
        assert!((reference.noise().expect("there are halves") - 1.0 / 4.01).abs() < 1e-9);
        let (rel_mse, mean_ratio) = reference.compare(&x).expect("it is of the same size");
        assert!((rel_mse - 8.0 / 4.01).abs() < 1e-9);
        assert!((mean_ratio - 2.5).abs() < 1e-9);
    }
}
