//! What pictures are compared with.

use std::path::{Path, PathBuf};

use nephroid::color::Rgb;
use nephroid::film::ImageError;
use nephroid::texture::Image;
use nephroid_formats::image::read_image;

/// How many pixels there are for each that is left out of a mean because its error is the largest.
const PIXELS_TO_WORST: usize = 1000;

/// How far a picture is from a reference.
#[derive(Clone, Copy, Debug)]
pub struct Comparison {
    /// relMSE, without the noise of the reference if that is known.
    pub rel_mse: f64,
    /// The same without the pixel in a thousand where it is largest: one bright sample there can be more than all the rest.
    pub without_worst: f64,
    /// The ratio of the means.
    pub mean_ratio: f64,
}

/// A picture that others are compared with, and its own noise.
pub struct Reference {
    picture: Image,
    noise: Option<f64>,
    /// The noise in [`Comparison::without_worst`].
    noise_without_worst: f64,
    /// The noise in [`Self::error_sq`].
    luminance_noise: f64,
}

impl Reference {
    /// Reads `A.exr`, or `A.exr,B.exr`: two pictures that are independent of one another, of which the mean is taken.
    pub fn read(files: &str) -> Result<Self, String> {
        let read = |path: &str| read_image(Path::new(path)).map(|file| file.image).map_err(|e| e.to_string());
        match files.split_once(',') {
            Some((a, b)) => Self::halves(&read(a)?, &read(b)?),
            None => Ok(Self {
                picture: read(files)?,
                noise: None,
                noise_without_worst: 0.0,
                luminance_noise: 0.0,
            }),
        }
    }

    /// The mean of two halves a, b, and its noise, the mean of ((a − b)/2)² / (m² + ε) about their mean m.
    ///
    /// To subtract it is to average (x − a)(x − b) / (m² + ε), whose noise in a and in b cancels in the mean.
    pub fn halves(a: &Image, b: &Image) -> Result<Self, String> {
        let pixels: Vec<Rgb> = a.pixels.iter().zip(&b.pixels).map(|(&a, &b)| (a + b) * 0.5).collect();
        let picture = Image { width: a.width, height: a.height, pixels };
        let noise = ImageError::between(b, &picture, ImageError::EPSILON).map_err(|e| e.to_string())?.rel_mse;
        let noise_without_worst = without_worst(b, &picture);
        let luminance_noise = error_sq(b, &picture)?;
        Ok(Self { picture, noise: Some(noise), noise_without_worst, luminance_noise })
    }

    /// Its own relMSE, if there are halves to know it from.
    pub fn noise(&self) -> Option<f64> {
        self.noise
    }

    /// Compares a picture with it.
    pub fn compare(&self, picture: &Image) -> Result<Comparison, String> {
        let error = ImageError::between(picture, &self.picture, ImageError::EPSILON);
        let error = error.map_err(|e| e.to_string())?;
        Ok(Comparison {
            rel_mse: error.rel_mse - self.noise.unwrap_or(0.0),
            without_worst: without_worst(picture, &self.picture) - self.noise_without_worst,
            mean_ratio: error.mean_ratio,
        })
    }

    /// The mean over the pixels of (a − t)² / (t² + (0.1 m)²), where a and t are a pixel's luminance in the picture and
    /// here and m is the mean of t; without the pixel in a thousand where it is largest, and without the noise of the
    /// reference if that is known.
    pub fn error_sq(&self, picture: &Image) -> Result<f64, String> {
        Ok(error_sq(picture, &self.picture)? - self.luminance_noise)
    }

    /// Its width and height in pixels.
    pub fn size(&self) -> [u32; 2] {
        [self.picture.width, self.picture.height]
    }
}

/// The mean without the worst.
fn mean_without_worst(mut errors: Vec<f64>) -> f64 {
    errors.sort_unstable_by(f64::total_cmp);
    errors.truncate(errors.len() - errors.len() / PIXELS_TO_WORST);
    errors.iter().sum::<f64>() / errors.len().max(1) as f64
}

/// See [`Comparison::without_worst`].
fn without_worst(picture: &Image, reference: &Image) -> f64 {
    let error = |(a, t): (&Rgb, &Rgb)| {
        let term = |(a, t): (f32, f32)| {
            let (a, t) = (f64::from(a), f64::from(t));
            (a - t) * (a - t) / (t * t + ImageError::EPSILON)
        };
        a.to_array().into_iter().zip(t.to_array()).map(term).sum::<f64>() / 3.0
    };
    mean_without_worst(picture.pixels.iter().zip(&reference.pixels).map(error).collect())
}

/// See [`Reference::error_sq`].
fn error_sq(picture: &Image, reference: &Image) -> Result<f64, String> {
    if [picture.width, picture.height] != [reference.width, reference.height] {
        return Err("the picture and the reference differ in size".to_string());
    }
    let luminance = |image: &Image| -> Vec<f64> {
        image.pixels.iter().map(|pixel| f64::from(pixel.luminance())).collect()
    };
    let (found, exact) = (luminance(picture), luminance(reference));
    let count = exact.len() as f64;
    let floor = 0.1 * exact.iter().sum::<f64>() / count;
    let term = |(a, t): (&f64, &f64)| (a - t) * (a - t) / (t * t + floor * floor);
    Ok(mean_without_worst(found.iter().zip(&exact).map(term).collect()))
}

/// Scenes that have a reference, by name: `NAME.exr`, or the halves `NAME.a.exr` and `NAME.b.exr`.
pub fn pairs_of_folders(scenes: &Path, references: &Path) -> Result<Vec<(PathBuf, String)>, String> {
    let entries = scenes.read_dir().map_err(|e| format!("{}: {e}", scenes.display()))?;
    let mut files: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    files.retain(|path| path.extension().is_some_and(|extension| extension == "xml"));
    files.sort();
    let reference = |scene: &Path| {
        let name = scene.file_stem()?.to_string_lossy();
        let [whole, a, b] = ["", ".a", ".b"].map(|part| references.join(format!("{name}{part}.exr")));
        if a.exists() && b.exists() {
            return Some(format!("{},{}", a.display(), b.display()));
        }
        whole.exists().then(|| whole.display().to_string())
    };
    Ok(files.into_iter().filter_map(|scene| reference(&scene).map(|r| (scene, r))).collect())
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
        let found = reference.compare(&x).expect("it is of the same size");
        assert!((found.rel_mse - 8.0 / 4.01).abs() < 1e-9);
        assert!((found.without_worst - 8.0 / 4.01).abs() < 1e-9);
        assert!((found.mean_ratio - 2.5).abs() < 1e-9);
    }

    #[test]
    fn one_bright_pixel_in_a_thousand_does_not_count() {
        let one = Image::filled(100, 10, Rgb::splat(1.0));
        let reference = Reference::halves(&one, &one).expect("they are of one size");
        let mut x = Image::filled(100, 10, Rgb::splat(2.0));
        x.pixels[17] = Rgb::splat(1e6);
        let found = reference.compare(&x).expect("it is of the same size");
        assert!(found.rel_mse > 1e8);
        assert!((found.without_worst - 1.0 / 1.01).abs() < 1e-6);
        assert!((reference.error_sq(&x).expect("it is of the same size") - 1.0 / 1.01).abs() < 1e-6);
    }

    #[test]
    fn errors_of_luminance_are_relative_to_the_pixel_and_the_mean() {
        let [a, b, x] = [1.0, 3.0, 5.0].map(|value| Image::filled(2, 1, Rgb::splat(value)));
        let reference = Reference::halves(&a, &b).expect("they are of one size");
        // The same as above, over m² + (0.1 m)².
        let found = reference.error_sq(&x).expect("it is of the same size");
        assert!((found - 8.0 / 4.04).abs() < 1e-6, "{found}");
    }
}
