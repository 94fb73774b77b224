use super::SizeMismatch;
use super::fixed;
use crate::color::Rgb;
use crate::texture::Image;

/// What one iteration found for one pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PixelSum {
    /// Σ w·L per channel, in W/(m²·sr).
    pub radiance: [f64; 3],
    /// Σ (w·Y)² over the independent estimates, where Y is the luminance.
    pub luminance_sq: f64,
    /// Σ w, the weights of the reconstruction filter.
    pub weight: f64,
    /// Independent estimates that the variance may count on. Samples that share a photon map make
    /// one estimate together: see [`PixelSum::as_one_estimate`].
    pub samples: u32,
}

impl PixelSum {
    /// Adds an independent sample of weight `weight`.
    #[inline]
    pub fn add(&mut self, radiance: Rgb, weight: f32) {
        let weight = f64::from(weight);
        let weighted = radiance.to_array().map(|v| weight * f64::from(v));
        for (sum, v) in self.radiance.iter_mut().zip(weighted) {
            *sum += v;
        }
        let y = luminance(weighted);
        self.luminance_sq += y * y;
        self.weight += weight;
        self.samples += 1;
    }

    /// The same light, counted as a single estimate: for samples of one iteration that are
    /// correlated because they gather from the same photons.
    pub fn as_one_estimate(self) -> Self {
        let y = luminance(self.radiance);
        Self { luminance_sq: y * y, samples: self.samples.min(1), ..self }
    }

    /// Whether it can be added to a film.
    fn is_usable(&self) -> bool {
        self.radiance.iter().all(|v| v.is_finite())
            && self.weight.is_finite()
            && self.luminance_sq.is_finite()
            && self.luminance_sq >= 0.0
    }
}

/// The exact sums of one pixel over all iterations, in fixed point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PixelTotal {
    /// Σ w·L per channel, in steps of 2^−64.
    pub radiance: [i128; 3],
    /// Σ w, in steps of 2^−64.
    pub weight: i128,
    /// Σ (w·Y)², in steps of 2^−56. At its largest value it is saturated.
    pub luminance_sq: u128,
    /// Independent estimates.
    pub samples: u64,
}

impl PixelTotal {
    /// Rounds one iteration's sums, each once, and counts how many had to be cut.
    fn from_sum(sum: &PixelSum) -> (Self, u64) {
        let [r, g, b] = sum.radiance.map(fixed::signed);
        let weight = fixed::signed(sum.weight);
        let square = fixed::square(sum.luminance_sq);
        let cut = [r.1, g.1, b.1, weight.1, square.1].into_iter().filter(|&cut| cut).count();
        let total = Self {
            radiance: [r.0, g.0, b.0],
            weight: weight.0,
            luminance_sq: square.0,
            samples: u64::from(sum.samples),
        };
        (total, cut as u64)
    }

    fn add(&mut self, other: &Self) {
        for (sum, v) in self.radiance.iter_mut().zip(other.radiance) {
            *sum = sum.saturating_add(v);
        }
        self.weight = self.weight.saturating_add(other.weight);
        self.luminance_sq = self.luminance_sq.saturating_add(other.luminance_sq);
        self.samples = self.samples.saturating_add(other.samples);
    }

    /// Σ wL / Σ w; black where the weights sum to zero.
    fn mean(&self) -> [f64; 3] {
        if self.weight == 0 {
            return [0.0; 3];
        }
        let weight = fixed::signed_value(self.weight);
        self.radiance.map(|v| fixed::signed_value(v) / weight)
    }

    /// Variance of the mean's luminance: n/(n−1) · (Σ X² − (Σ X)²/n) / (Σ w)², X = w·Y.
    fn variance(&self) -> f64 {
        if self.samples < 2 || self.weight == 0 {
            return f64::INFINITY;
        }
        let n = self.samples as f64;
        let sum = luminance(self.radiance.map(fixed::signed_value));
        let spread = (fixed::square_value(self.luminance_sq) - sum * sum / n).max(0.0);
        let weight = fixed::signed_value(self.weight);
        n / (n - 1.0) * spread / (weight * weight)
    }
}

/// What did not go into the sums as it came.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FilmCounts {
    /// Values cut down because they were too large.
    pub saturated: u64,
    /// Pixels of an iteration left out because a value was NaN or infinite, or a square negative.
    pub non_finite: u64,
}

/// A picture as exact sums.
///
/// Each value of each iteration is rounded once to a fixed-point number, and integers are added:
/// the same iterations give the same bits in any order and in any split over films that are
/// [merged](Film::merge) later. A pixel of an iteration with a value that is NaN or infinite is
/// left out whole, weight and all, so it darkens nothing.
///
/// Radiance and weight count in steps of 2^−64 (5.4e-20) and an iteration may bring up to 2^39
/// (5.5e11) per pixel: 2^24 iterations fit for certain, and beyond them all but absurd ones do.
/// Squares count in steps of 2^−56 up to 2^72 (4.7e21), which resolves the noise of luminances
/// between 1e-6 and 1e7; a sum of squares that saturates gives an infinite variance.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Film {
    width: u32,
    height: u32,
    iterations: u64,
    counts: FilmCounts,
    pixels: Vec<PixelTotal>,
}

impl Film {
    /// An empty film. Takes 96 bytes a pixel.
    pub fn new(width: u32, height: u32) -> Self {
        let pixels = vec![PixelTotal::default(); width as usize * height as usize];
        Self { width, height, iterations: 0, counts: FilmCounts::default(), pixels }
    }

    /// A film from what its accessors gave; `None` unless there are `width · height` pixels.
    pub fn from_parts(
        width: u32,
        height: u32,
        iterations: u64,
        counts: FilmCounts,
        pixels: Vec<PixelTotal>,
    ) -> Option<Self> {
        let expected = (width as usize).checked_mul(height as usize)?;
        (pixels.len() == expected).then_some(Self { width, height, iterations, counts, pixels })
    }

    /// Pixels in a row.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Iterations added so far.
    pub fn iterations(&self) -> u64 {
        self.iterations
    }

    /// What did not go in as it came.
    pub fn counts(&self) -> FilmCounts {
        self.counts
    }

    /// The sums, row by row.
    pub fn pixels(&self) -> &[PixelTotal] {
        &self.pixels
    }

    /// Adds one iteration, row by row.
    ///
    /// # Panics
    /// If there are not exactly `width · height` sums.
    pub fn add_iteration(&mut self, sums: &[PixelSum]) {
        assert_eq!(sums.len(), self.pixels.len(), "an iteration covers the film");
        for (pixel, sum) in self.pixels.iter_mut().zip(sums) {
            if sum.is_usable() {
                let (total, cut) = PixelTotal::from_sum(sum);
                pixel.add(&total);
                self.counts.saturated += cut;
            } else {
                self.counts.non_finite += 1;
            }
        }
        self.iterations += 1;
    }

    /// Adds the iterations of another film, as if they had been added here.
    pub fn merge(&mut self, other: &Self) -> Result<(), SizeMismatch> {
        SizeMismatch::check((self.width, self.height), (other.width, other.height))?;
        for (pixel, total) in self.pixels.iter_mut().zip(&other.pixels) {
            pixel.add(total);
        }
        self.iterations = self.iterations.saturating_add(other.iterations);
        self.counts.saturated = self.counts.saturated.saturating_add(other.counts.saturated);
        self.counts.non_finite = self.counts.non_finite.saturating_add(other.counts.non_finite);
        Ok(())
    }

    /// The picture: Σ wL / Σ w in each pixel, black where nothing was added.
    pub fn develop(&self) -> Image {
        let pixels = self.pixels.iter().map(|p| Rgb::from(p.mean().map(|v| v as f32))).collect();
        Image { width: self.width, height: self.height, pixels }
    }

    /// Variance of each pixel's luminance in [`Film::develop`], row by row, as estimated from the
    /// spread of its independent estimates; infinite where there are fewer than two.
    ///
    /// With negative filter weights this is an upper estimate: it takes no advantage of light and
    /// weight varying together.
    pub fn variance(&self) -> Vec<f64> {
        self.pixels.iter().map(PixelTotal::variance).collect()
    }

    /// The mean of the picture's luminance over all pixels; 0 without pixels.
    pub fn mean_luminance(&self) -> f64 {
        let sum: f64 = self.pixels.iter().map(|p| luminance(p.mean())).sum();
        sum / self.pixels.len().max(1) as f64
    }
}

/// Relative luminance in double precision, as [`Rgb::luminance`].
fn luminance([r, g, b]: [f64; 3]) -> f64 {
    0.212_6 * r + 0.715_2 * g + 0.072_2 * b
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Deterministic values of mixed sign and very mixed size.
    fn iteration(number: u64, pixels: usize) -> Vec<PixelSum> {
        let mut state = number.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f32 / (1u64 << 24) as f32
        };
        let mut sums = vec![PixelSum::default(); pixels];
        for sum in &mut sums {
            for _ in 0..3 {
                let scale = 10f32.powi((next() * 16.0) as i32 - 8);
                let weight = if next() < 0.2 { -1.25 } else { 1.25 };
                sum.add(Rgb::new(next(), next(), next()) * scale, weight);
            }
        }
        sums
    }

    #[test]
    fn any_order_and_any_split_give_the_same_bits() {
        let iterations: Vec<_> = (0..12).map(|i| iteration(i, 6)).collect();
        let film_of = |list: &[usize]| {
            let mut film = Film::new(3, 2);
            list.iter().for_each(|&i| film.add_iteration(&iterations[i]));
            film
        };
        let whole = film_of(&[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11]);
        assert_eq!(whole, film_of(&[7, 3, 11, 0, 9, 2, 10, 1, 8, 4, 6, 5]));
        let mut merged = film_of(&[8, 2, 5]);
        let mut rest = film_of(&[11, 0, 1, 3, 4]);
        rest.merge(&film_of(&[10, 9, 7, 6])).unwrap();
        merged.merge(&rest).unwrap();
        assert_eq!(whole, merged);
        // The same sums in floating point do depend on the order, so the test tells.
        let float = |order: &[usize]| {
            let mut sums = [0.0; 6];
            for &i in order {
                sums.iter_mut().zip(&iterations[i]).for_each(|(s, v)| *s += v.radiance[0]);
            }
            sums
        };
        assert_ne!(
            float(&[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11]),
            float(&[7, 3, 11, 0, 9, 2, 10, 1, 8, 4, 6, 5])
        );
    }

    #[test]
    fn order_does_not_matter_even_where_values_are_cut() {
        let sum = |r: f64| PixelSum { radiance: [r, 0.0, 0.0], weight: 1.0, luminance_sq: 1e30, samples: 1 };
        let iterations = [sum(f64::MAX), sum(-f64::MAX), sum(3.0), sum(f64::MAX)];
        let film_of = |order: [usize; 4]| {
            let mut film = Film::new(1, 1);
            order.iter().for_each(|&i| film.add_iteration(&[iterations[i]]));
            film
        };
        let film = film_of([0, 1, 2, 3]);
        assert_eq!(film, film_of([3, 0, 2, 1]));
        assert_eq!(film.counts().saturated, 3 + 4);
        assert_eq!(film.develop().pixel(0, 0).r, ((f64::from(1u32 << 30) * 512.0 + 3.0) / 4.0) as f32);
        assert_eq!(film.variance(), [f64::INFINITY]);
    }

    #[test]
    fn the_sum_is_right_to_half_a_step_per_iteration() {
        let mut film = Film::new(1, 1);
        let n = 1000;
        for _ in 0..n {
            let third = 1.0 / 3.0;
            film.add_iteration(&[PixelSum {
                radiance: [third; 3],
                luminance_sq: third * third,
                weight: 1.0,
                samples: 1,
            }]);
        }
        let step = 0.5f64.powi(64);
        let total = film.pixels()[0].radiance[0] as f64 * step;
        let exact = f64::from(n) * (1.0 / 3.0);
        // Half a step an iteration, and the rounding of this comparison itself.
        assert!((total - exact).abs() <= f64::from(n) * 0.5 * step + exact * f64::EPSILON);
        assert!((film.mean_luminance() - 1.0 / 3.0).abs() < 1e-15);
    }

    #[test]
    fn a_pixel_with_nan_or_infinity_is_left_out_and_counted() {
        let good = PixelSum { radiance: [2.0; 3], luminance_sq: 4.0, weight: 1.0, samples: 1 };
        let mut film = Film::new(2, 1);
        film.add_iteration(&[good, good]);
        let bad_ones = [
            PixelSum { radiance: [1.0, f64::NAN, 1.0], ..good },
            PixelSum { radiance: [f64::INFINITY, 0.0, 0.0], ..good },
            PixelSum { luminance_sq: f64::INFINITY, ..good },
            PixelSum { luminance_sq: -1.0, ..good },
            PixelSum { weight: f64::NAN, ..good },
        ];
        for bad in bad_ones {
            film.add_iteration(&[bad, good]);
        }
        assert_eq!(film.counts(), FilmCounts { saturated: 0, non_finite: 5 });
        assert_eq!(film.iterations(), 6);
        assert_eq!(film.pixels()[0].samples, 1);
        assert_eq!(film.develop().pixels, [Rgb::splat(2.0); 2]);
    }

    #[test]
    fn variance_of_the_mean_is_that_of_its_samples() {
        let mut film = Film::new(1, 1);
        let mut sum = PixelSum::default();
        for v in [1.0, 2.0] {
            sum.add(Rgb::splat(v), 1.0);
        }
        film.add_iteration(&[sum]);
        let mut sum = PixelSum::default();
        for v in [3.0, 6.0] {
            sum.add(Rgb::splat(v), 1.0);
        }
        film.add_iteration(&[sum]);
        // Values 1, 2, 3, 6: mean 3, squared deviations 4 + 1 + 0 + 9 = 14; 14 / 3 / 4.
        assert_eq!(film.develop().pixel(0, 0).g, 3.0);
        assert!((film.variance()[0] - 14.0 / 12.0).abs() < 1e-6);
    }

    #[test]
    fn correlated_samples_count_as_one() {
        let mut film = Film::new(1, 1);
        for v in [1.0, 3.0] {
            let mut sum = PixelSum::default();
            (0..4).for_each(|_| sum.add(Rgb::splat(v), 1.0));
            film.add_iteration(&[sum.as_one_estimate()]);
        }
        // Two estimates, 1 and 3: the variance of their mean is 2 / 2.
        assert_eq!(film.develop().pixel(0, 0).b, 2.0);
        assert!((film.variance()[0] - 1.0).abs() < 1e-6);
        assert_eq!(PixelSum::default().as_one_estimate(), PixelSum::default());
    }

    #[test]
    fn empty_films_are_black_and_know_nothing() {
        let film = Film::new(2, 1);
        assert_eq!(film.develop().pixels, [Rgb::BLACK; 2]);
        assert_eq!(film.variance(), [f64::INFINITY; 2]);
        assert_eq!(Film::new(0, 7).mean_luminance(), 0.0);
    }

    #[test]
    fn films_of_other_sizes_do_not_merge() {
        let error = Film::new(2, 3).merge(&Film::new(3, 2)).unwrap_err();
        assert_eq!(error.to_string(), "one picture is 2×3 pixels, the other 3×2");
    }

    #[test]
    fn parts_make_the_same_film() {
        let mut film = Film::new(3, 2);
        film.add_iteration(&iteration(5, 6));
        let parts = |n: usize| {
            let pixels = film.pixels()[..n].to_vec();
            Film::from_parts(film.width(), film.height(), film.iterations(), film.counts(), pixels)
        };
        assert_eq!(parts(6), Some(film.clone()));
        assert_eq!(parts(5), None);
    }
}
