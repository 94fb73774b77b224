use super::fixed::UNIT_LIMIT;
use super::pixel::{PixelSum, PixelTotal, luminance};
use super::{MergeError, SizeMismatch};
use crate::color::Rgb;
use crate::texture::Image;

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
/// A film has a *unit*, a power of two that should be near the radiances of its scene: see
/// [`World::radiance_unit`](crate::world::World::radiance_unit). Radiance counts in steps of 2^−48
/// units (3.6e-15) and an iteration may bring up to 2^32 (4.3e9) per pixel, of which 2^15 fit for
/// certain; beyond them all but absurd ones do. Squares count in steps of 2^−40 units squared up to
/// 2^56, so the noise of luminances between 1e-5 and 1e8 units is resolved; a sum of squares that
/// saturates, or is 0 where there is light, gives an infinite variance. Weights count in steps of 2^−32, which single precision
/// weights of filters are multiples of, and up to 2^16 an iteration.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Film {
    width: u32,
    height: u32,
    unit: i32,
    iterations: u64,
    counts: FilmCounts,
    pixels: Vec<PixelTotal>,
}

impl Film {
    /// An empty film for radiances around one. Takes 128 bytes a pixel.
    pub fn new(width: u32, height: u32) -> Self {
        Self::with_unit(width, height, 0)
    }

    /// An empty film for radiances around 2^`unit` W/(m²·sr). A unit that single precision does not
    /// span is brought nearer.
    pub fn with_unit(width: u32, height: u32, unit: i32) -> Self {
        let pixels = vec![PixelTotal::default(); width as usize * height as usize];
        let unit = unit.clamp(-UNIT_LIMIT, UNIT_LIMIT);
        Self { width, height, unit, iterations: 0, counts: FilmCounts::default(), pixels }
    }

    /// A film from what its accessors gave; `None` unless there are `width · height` pixels, none of
    /// them with a sum of more bits than it may have, and a unit that a film can have.
    pub fn from_parts(
        (width, height): (u32, u32),
        unit: i32,
        iterations: u64,
        counts: FilmCounts,
        pixels: Vec<PixelTotal>,
    ) -> Option<Self> {
        let expected = (width as usize).checked_mul(height as usize)?;
        let fits = pixels.len() == expected
            && pixels.iter().all(PixelTotal::is_in_bounds)
            && (-UNIT_LIMIT..=UNIT_LIMIT).contains(&unit);
        fits.then_some(Self { width, height, unit, iterations, counts, pixels })
    }

    /// Pixels in a row.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Radiances are kept as multiples of a fraction of two to this power, in W/(m²·sr).
    pub fn unit(&self) -> i32 {
        self.unit
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
                let (total, cut) = PixelTotal::from_sum(sum, self.unit);
                pixel.add(&total);
                self.counts.saturated += cut;
            } else {
                self.counts.non_finite += 1;
            }
        }
        self.iterations += 1;
    }

    /// Marks the sums as they are now.
    pub(super) fn mark(&mut self) {
        self.pixels.iter_mut().for_each(PixelTotal::set_mark);
    }

    /// Adds the iterations of another film, as if they had been added here.
    ///
    /// # Errors
    /// If the films differ in size or unit; this one is then as it was.
    pub fn merge(&mut self, other: &Self) -> Result<(), MergeError> {
        SizeMismatch::check((self.width, self.height), (other.width, other.height))?;
        if self.unit != other.unit {
            return Err(MergeError::Units { first: self.unit, second: other.unit });
        }
        self.add_pixels(0, &other.pixels);
        self.count(other.iterations, other.counts);
        Ok(())
    }

    /// Adds sums of another film of the same size and unit to the pixels from number `first` on, row
    /// by row: a part of [`Film::merge`], for films that are read a piece at a time. What the other
    /// counted is added by [`Film::count`].
    ///
    /// # Panics
    /// If they reach beyond the film's end.
    pub fn add_pixels(&mut self, first: usize, totals: &[PixelTotal]) {
        let pixels = &mut self.pixels[first..first + totals.len()];
        for (pixel, total) in pixels.iter_mut().zip(totals) {
            pixel.add(total);
        }
    }

    /// Counts iterations whose pixels were [added](Film::add_pixels).
    pub fn count(&mut self, iterations: u64, counts: FilmCounts) {
        self.iterations = self.iterations.saturating_add(iterations);
        self.counts.saturated = self.counts.saturated.saturating_add(counts.saturated);
        self.counts.non_finite = self.counts.non_finite.saturating_add(counts.non_finite);
    }

    /// The picture: Σ wL / Σ w in each pixel, black where nothing was added.
    pub fn develop(&self) -> Image {
        let pixels = self.pixels.iter().map(|p| Rgb::from(p.mean(self.unit).map(|v| v as f32))).collect();
        Image { width: self.width, height: self.height, pixels }
    }

    /// Variance of each pixel's luminance in [`Film::develop`], row by row, as estimated from the
    /// spread of its [estimates](PixelSum::samples); infinite where there are fewer than two. For the photon mapper it
    /// leaves out what the samples that read one map have in common, the noise of its photons.
    ///
    /// With negative filter weights this is an upper estimate: it takes no advantage of light and
    /// weight varying together.
    pub fn variance(&self) -> Vec<f64> {
        self.pixels.iter().map(|p| p.variance(self.unit)).collect()
    }

    /// The mean of the picture's luminance over all pixels; 0 without pixels.
    pub fn mean_luminance(&self) -> f64 {
        let sum: f64 = self.pixels.iter().map(|p| luminance(p.mean(self.unit))).sum();
        sum / self.pixels.len().max(1) as f64
    }
}
