//! The exact sums of further values of a picture.

use super::aov::{Aov, AovSample, NUMBERS, Over};
use super::fixed;

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
/// number, as a [`Film`](super::Film) does, and integers are added.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AovFilm {
    width: u32,
    height: u32,
    aovs: Vec<Aov>,
    /// For each pixel the numbers of each value asked for.
    numbers: Vec<i128>,
    weights: Vec<[i128; 3]>,
}

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
        let mut aovs = aovs.to_vec();
        aovs.sort_unstable();
        aovs.dedup();
        let pixels = width as usize * height as usize;
        let per_pixel: usize = aovs.iter().map(|aov| aov.channels().len()).sum();
        Self { width, height, aovs, numbers: vec![0; pixels * per_pixel], weights: vec![[0; 3]; pixels] }
    }

    /// The values it keeps.
    pub fn aovs(&self) -> &[Aov] {
        &self.aovs
    }

    /// Adds one iteration, row by row. A pixel with a number that is NaN or infinite is left out whole.
    ///
    /// # Panics
    /// If there are not exactly `width · height` sums.
    pub fn add_iteration<'s>(&mut self, sums: impl ExactSizeIterator<Item = &'s AovSum>) {
        assert_eq!(sums.len(), self.weights.len(), "an iteration covers the film");
        let per_pixel = self.per_pixel();
        for (i, sum) in sums.enumerate().filter(|(_, sum)| sum.is_usable()) {
            for (total, w) in self.weights[i].iter_mut().zip(sum.weights) {
                *total = total.saturating_add(fixed::signed(w).0);
            }
            let stored = &mut self.numbers[i * per_pixel..(i + 1) * per_pixel];
            let given = self.aovs.iter().flat_map(|aov| &sum.numbers[aov.start()..][..aov.channels().len()]);
            for (total, v) in stored.iter_mut().zip(given) {
                *total = total.saturating_add(fixed::signed(*v).0);
            }
        }
    }

    /// A value of every pixel, zero where nothing was added; `None` if it is not kept.
    pub fn develop(&self, aov: Aov) -> Option<AovImage> {
        let before = self.aovs.iter().position(|kept| *kept == aov)?;
        let start: usize = self.aovs[..before].iter().map(|aov| aov.channels().len()).sum();
        let weight_of = match aov.over() {
            Over::Samples => 0,
            Over::Hits => 1,
            Over::LookUps => 2,
        };
        let per_pixel = self.per_pixel();
        let mean = |(pixel, channel): (usize, usize)| {
            let weight = fixed::signed_value(self.weights[pixel][weight_of]);
            let sum = fixed::signed_value(self.numbers[pixel * per_pixel + start + channel]);
            let mean = if weight == 0.0 { 0.0 } else { (sum / weight) as f32 };
            if aov == Aov::Albedo { mean.clamp(0.0, 1.0) } else { mean }
        };
        let channel = |c: usize| (0..self.weights.len()).map(|pixel| mean((pixel, c))).collect();
        let channels = (0..aov.channels().len()).map(channel).collect();
        Some(AovImage { aov, width: self.width, height: self.height, channels })
    }

    fn per_pixel(&self) -> usize {
        self.aovs.iter().map(|aov| aov.channels().len()).sum()
    }
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
}
