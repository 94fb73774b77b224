//! The exact sums of further values of a picture.

use super::aov::{Aov, AovSample, NUMBERS, Over};
use super::fixed::{LAYER, UNIT_LIMIT};
use super::{MergeError, SizeMismatch};

/// What one iteration found of further values for one pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AovSum {
    numbers: [f64; NUMBERS],
    /// Weights of the samples, of those that meet a surface, and of estimates.
    weights: [f64; 3],
}

impl Default for AovSum {
    fn default() -> Self {
        Self { numbers: [0.0; NUMBERS], weights: [0.0; 3] }
    }
}

impl AovSum {
    /// Adds a sample, with the weight of the picture's filter. Where a value is no sum over all
    /// samples, the size of the weight counts: with both signs a mean over few would have no bounds.
    pub fn add(&mut self, sample: &AovSample, weight: f32) {
        let weight = f64::from(weight);
        let size = weight.abs();
        let hit = if sample.hit { size } else { 0.0 };
        for (sum, w) in self.weights.iter_mut().zip([weight, hit, size * f64::from(sample.look_ups)]) {
            *sum += w;
        }
        for aov in Aov::ALL {
            let w = if aov.over() == Over::Samples { weight } else { size };
            let range = aov.start()..aov.start() + aov.channels().len();
            for (sum, v) in self.numbers[range.clone()].iter_mut().zip(&sample.numbers()[range]) {
                *sum += w * f64::from(*v);
            }
        }
    }

    fn is_usable(&self) -> bool {
        self.numbers.iter().chain(&self.weights).all(|v| v.is_finite())
    }
}

/// Further values of a picture as exact sums: each of each iteration is rounded once to a fixed-point
/// number, as a [`Film`](super::Film) does, and integers are added. They count in steps of 2^−64, of light in
/// steps of 2^−64 units.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AovFilm {
    width: u32,
    height: u32,
    unit: i32,
    aovs: Vec<Aov>,
    /// For each pixel its weights, as in [`AovSum`], and the numbers of each value asked for.
    sums: Vec<i128>,
}

/// Weights of a pixel, which come before its numbers.
const WEIGHTS: usize = 3;

/// One value of every pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct AovImage {
    /// What it is.
    pub aov: Aov,
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// For each of [`Aov::channels`] the numbers of all pixels, row by row.
    pub channels: Vec<Vec<f32>>,
}

impl AovFilm {
    /// An empty one for the values of a list; one that is named twice is kept once.
    pub fn new(width: u32, height: u32, aovs: &[Aov]) -> Self {
        Self::with_unit(width, height, 0, aovs)
    }

    /// An empty one for light around 2^`unit` W/(m²·sr): see [`Film::with_unit`](super::Film::with_unit).
    pub fn with_unit(width: u32, height: u32, unit: i32, aovs: &[Aov]) -> Self {
        let mut aovs = aovs.to_vec();
        aovs.sort_unstable();
        aovs.dedup();
        let unit = unit.clamp(-UNIT_LIMIT, UNIT_LIMIT);
        let mut film = Self { width, height, unit, aovs, sums: Vec::new() };
        film.sums = vec![0; width as usize * height as usize * film.sums_per_pixel()];
        film
    }

    /// Pixels in a row.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Light is kept as multiples of a fraction of two to this power, in W/(m²·sr).
    pub fn unit(&self) -> i32 {
        self.unit
    }

    /// The values it keeps.
    pub fn aovs(&self) -> &[Aov] {
        &self.aovs
    }

    /// Integers that are kept for each pixel.
    pub fn sums_per_pixel(&self) -> usize {
        WEIGHTS + self.aovs.iter().map(|aov| aov.channels().len()).sum::<usize>()
    }

    /// The integers of all pixels, row by row: what a file keeps, and [`AovFilm::add_sums`] takes.
    pub fn sums(&self) -> &[i128] {
        &self.sums
    }

    /// Adds sums of another one of the same size, unit and values to the pixels from number `first` on.
    ///
    /// # Panics
    /// If they reach beyond the last pixel.
    pub fn add_sums(&mut self, first: usize, sums: &[i128]) {
        let start = first * self.sums_per_pixel();
        for (sum, v) in self.sums[start..start + sums.len()].iter_mut().zip(sums) {
            *sum = LAYER.sum(*sum, *v);
        }
    }

    /// Adds one iteration, row by row. A pixel with a number that is NaN or infinite is left out whole.
    ///
    /// # Panics
    /// If there are not exactly `width · height` sums.
    pub fn add_iteration<'s>(&mut self, sums: impl ExactSizeIterator<Item = &'s AovSum>) {
        let per_pixel = self.sums_per_pixel();
        assert_eq!(sums.len() * per_pixel, self.sums.len(), "an iteration covers the film");
        for (pixel, sum) in self.sums.chunks_exact_mut(per_pixel).zip(sums).filter(|(_, sum)| sum.is_usable())
        {
            let weights = sum.weights.iter().map(|w| LAYER.term(*w, 0));
            let numbers = self.aovs.iter().flat_map(|aov| {
                let numbers = &sum.numbers[aov.start()..][..aov.channels().len()];
                numbers.iter().map(|v| LAYER.term(*v, unit_of(*aov, self.unit)))
            });
            for (total, (term, _)) in pixel.iter_mut().zip(weights.chain(numbers)) {
                *total = LAYER.sum(*total, term);
            }
        }
    }

    /// Adds the iterations of another one, as if they had been added here.
    ///
    /// # Errors
    /// If they differ in size, values or unit; this one is then as it was.
    pub fn merge(&mut self, other: &Self) -> Result<(), MergeError> {
        SizeMismatch::check((self.width, self.height), (other.width, other.height))?;
        if self.aovs != other.aovs {
            return Err(MergeError::Values { first: self.aovs.clone(), second: other.aovs.clone() });
        }
        if self.unit != other.unit {
            return Err(MergeError::Units { first: self.unit, second: other.unit });
        }
        self.add_sums(0, &other.sums);
        Ok(())
    }

    /// A value of every pixel, zero where nothing was added; `None` if it is not kept.
    pub fn develop(&self, aov: Aov) -> Option<AovImage> {
        let before = self.aovs.iter().position(|kept| *kept == aov)?;
        let start = WEIGHTS + self.aovs[..before].iter().map(|aov| aov.channels().len()).sum::<usize>();
        let weight_of = match aov.over() {
            Over::Samples => 0,
            Over::Hits => 1,
            Over::LookUps => 2,
        };
        let unit = unit_of(aov, self.unit);
        let mean = |pixel: &[i128], channel: usize| {
            let weight = LAYER.value(pixel[weight_of], 0);
            let sum = LAYER.value(pixel[start + channel], unit);
            let mean = if weight == 0.0 { 0.0 } else { (sum / weight) as f32 };
            if aov == Aov::Albedo { mean.clamp(0.0, 1.0) } else { mean }
        };
        let pixels = || self.sums.chunks_exact(self.sums_per_pixel());
        let channel = |c: usize| pixels().map(|pixel| mean(pixel, c)).collect();
        let channels = (0..aov.channels().len()).map(channel).collect();
        Some(AovImage { aov, width: self.width, height: self.height, channels })
    }
}

/// The unit that a value is kept in where light has this one.
fn unit_of(aov: Aov, unit_of_light: i32) -> i32 {
    if aov.is_light() { unit_of_light } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(depth: f32, light: f32) -> AovSample {
        let mut sample = AovSample::default();
        sample.hit = depth > 0.0;
        sample.add(Aov::Depth, &[depth]);
        sample.add(Aov::Direct, &[light, 2.0 * light, 0.0]);
        sample.add(Aov::Albedo, &[light; 3]);
        sample
    }

    fn sum(samples: &[(AovSample, f32)]) -> AovSum {
        let mut sum = AovSum::default();
        samples.iter().for_each(|(sample, weight)| sum.add(sample, *weight));
        sum
    }

    #[test]
    fn light_is_a_mean_over_samples_and_depth_one_over_hits() {
        let mut film = AovFilm::new(1, 1, &[Aov::Depth, Aov::Direct, Aov::Albedo, Aov::Depth]);
        film.add_iteration([sum(&[(sample(3.0, 1.0), 1.0), (sample(0.0, 5.0), 1.0)])].iter());
        assert_eq!(film.aovs(), [Aov::Direct, Aov::Albedo, Aov::Depth]);
        let value = |aov| film.develop(aov).map(|image| image.channels.concat());
        assert_eq!(value(Aov::Direct), Some(vec![3.0, 6.0, 0.0]));
        assert_eq!(value(Aov::Depth), Some(vec![3.0]));
        assert_eq!(value(Aov::Albedo), Some(vec![1.0; 3]), "an albedo is at most one");
        assert_eq!(value(Aov::Normal), None);
    }

    #[test]
    fn negative_weights_leave_the_depth_within_what_was_seen() {
        let mut film = AovFilm::new(1, 1, &[Aov::Depth]);
        film.add_iteration([sum(&[(sample(3.0, 0.0), 1.2), (sample(5.0, 0.0), -1.1)])].iter());
        let depth = film.develop(Aov::Depth).unwrap().channels[0][0];
        assert!((3.0..5.0).contains(&depth), "{depth}");
    }

    #[test]
    fn any_order_gives_the_same_bits_and_broken_sums_are_left_out() {
        let sums: Vec<_> = (0..9)
            .map(|i| sum(&[(sample(0.1 * i as f32, 1e-7 * i as f32), 1.0), (sample(1e9, 3e8), 0.3)]))
            .collect();
        let film_of = |order: &[usize]| {
            let mut film = AovFilm::new(1, 1, &Aov::ALL);
            order.iter().for_each(|&i| film.add_iteration([sums[i]].iter()));
            film
        };
        let film = film_of(&[0, 1, 2, 3, 4, 5, 6, 7, 8]);
        assert_eq!(film, film_of(&[8, 3, 5, 1, 0, 7, 2, 6, 4]));
        let mut more = film.clone();
        more.add_iteration([sum(&[(sample(f32::NAN, 1.0), 1.0)])].iter());
        assert_eq!(film, more);
    }

    #[test]
    fn merged_values_are_those_of_all_iterations() {
        let sums: Vec<_> = (0..4).map(|i| sum(&[(sample(0.3 * i as f32, 1e-7 * i as f32), 0.7)])).collect();
        let film_of = |numbers: &[usize]| {
            let mut film = AovFilm::with_unit(1, 1, -9, &Aov::ALL);
            numbers.iter().for_each(|&i| film.add_iteration([sums[i]].iter()));
            film
        };
        let mut film = film_of(&[3, 1]);
        assert_eq!(film.merge(&film_of(&[0, 2])), Ok(()));
        assert_eq!(film, film_of(&[0, 1, 2, 3]));
        let mut copy = AovFilm::with_unit(1, 1, -9, &Aov::ALL);
        copy.add_sums(0, film.sums());
        assert_eq!(film, copy);
        let error = |other: &AovFilm| film.clone().merge(other).unwrap_err().to_string();
        assert_eq!(error(&AovFilm::new(1, 2, &Aov::ALL)), "one picture is 1×1 pixels, the other 1×2");
        assert_eq!(error(&AovFilm::new(1, 1, &Aov::ALL)), "radiances count in units of 2^-9 and of 2^0");
        let few = AovFilm::new(1, 1, &Aov::ALL[2..]);
        assert_eq!(error(&few), "only one of the two has the values direct, global");
    }

    #[test]
    fn light_of_any_scale_is_kept() {
        for (unit, light) in [(-40, 1e-12f32), (40, 1e12), (120, 1e36), (-120, 1e-36)] {
            let mut film = AovFilm::with_unit(1, 1, unit, &[Aov::Direct, Aov::Depth]);
            film.add_iteration([sum(&[(sample(3.0, light), 1.0)])].iter());
            let value = |aov| film.develop(aov).unwrap().channels.concat();
            assert_eq!((value(Aov::Direct), value(Aov::Depth)), (vec![light, 2.0 * light, 0.0], vec![3.0]));
        }
    }
}
