//! The error of a picture, as the picture itself tells it.

use super::light::Lights;
use super::{Convergence, Film};

/// The fewest steps from which the spread of estimates is told, and how evenly they are spread.
const FEWEST: u64 = 4;

/// 90 % of a normal distribution lie within so many standard deviations.
const WITHIN_90: f64 = 1.645;

/// What the logarithm of the error is uncertain by, however well its noise is known: how evenly samples are spread is a guess,
/// and the light that pixels are measured by is noisy, too.
const OF_METHOD: f64 = 0.05;

/// The same for each e-folding that it matters by what noisy pixels are measured.
const OF_MEASURE: f64 = 0.05;

/// The variance of the logarithm of a squared error of which nothing is known.
const UNKNOWN: f64 = 1.0;

/// The variance that the logarithm of [`evenness`] is thought to have before it is known.
const OF_EVENNESS: f64 = 0.25;

/// How the errors of pixels hang together, which decides how far the error of one picture is from what is expected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pixels {
    /// Each pixel has samples of its own.
    Apart,
    /// Pixels share photons or light paths, and err together.
    Together,
}

/// How far a picture a is from the truth t:
///
/// ```text
/// E = sqrt(mean over pixels of (a − t)² / (t² + (m/10)²))
/// ```
///
/// with luminances, of which m is the mean over the picture. It is told from the render itself; see `docs/error.md`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quality {
    /// What E is expected to be.
    pub error: f64,
    /// Where E lies with a probability of 90 %.
    pub interval: [f64; 2],
    /// The part of it that is noise, by itself.
    pub noise: f64,
    /// The part of it that is the blur of progressive estimates on surfaces, by itself; 0 for methods without.
    pub bias: f64,
    /// Independent estimates of each pixel.
    pub estimates: u64,
}

/// Means over the pixels.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    noise: f64,
    /// Where pixels are measured by their own luminance.
    noise_by_own: f64,
    noise_sq: f64,
    bias: f64,
    /// Squared noise of D alone.
    blur_noise: f64,
    count: f64,
}

impl Quality {
    /// That of a film, whose variance must be that of all it has of noise: it is
    /// [not for every method](crate::integrator::Method::tells_error). `None` if there are too few estimates, or no light.
    pub fn of(film: &Film, convergence: &Convergence, pixels: Pixels) -> Option<Self> {
        let estimates = film.pixels().iter().map(|pixel| u64::from(pixel.samples)).max()?;
        if film.iterations().min(estimates) < FEWEST {
            return None;
        }
        let sums = Sums::of(film);
        if sums.count == 0.0 {
            return None;
        }
        let of_noise = sums.scatter(convergence, pixels);
        let (evenness, of_evenness) = evenness(convergence, estimates, of_noise);
        let noise_sq = sums.noise / sums.count * evenness;
        let bias_sq = (sums.bias / sums.count).max(0.0);
        let error_sq = noise_sq + bias_sq;
        // That noise is known from so many estimates.
        let of_noise = of_noise * (1.0 + 1.0 / estimates as f64) + of_evenness;
        // 4 D̄² − 4 var(D̄) varies as the square of a noise of that size does.
        let of_blur = sums.scatter(convergence, pixels) * (4.0 * sums.blur_noise / sums.count).powi(2);
        let relative = |variance: f64| if variance > 0.0 { variance / (error_sq * error_sq) } else { 0.0 };
        let method = OF_METHOD + OF_MEASURE * libm::log(sums.measure());
        let of_error_sq = relative(of_noise * noise_sq * noise_sq) + relative(of_blur);
        let variance = 0.25 * of_error_sq + method * method;
        let error = libm::sqrt(error_sq);
        let factor = libm::exp(WITHIN_90 * libm::sqrt(variance));
        let (noise, bias) = (libm::sqrt(noise_sq), libm::sqrt(bias_sq));
        Some(Self { error, interval: [error / factor, error * factor], noise, bias, estimates })
    }
}

/// How much of the evenness that a render has shown so far is thought to go on.
const GOES_ON: f64 = 0.5;

/// What the even spread of samples leaves of the variance that they show, and the variance of its logarithm.
///
/// If that of the mean of n falls as n^(−1−δ), halves whose difference has the mean square ρ of the shown variance leave
/// ρ/(2^(1+δ) − 1) of it, and further on n^(−δ). From the first estimate on the mean δ is about −ln ρ / ln(m/2) for halves of m; but
/// what even samples take away is at last gone, and the δ of now is less. A ρ that is uncertain is drawn to 1.
pub(super) fn evenness(convergence: &Convergence, estimates: u64, scatter: f64) -> (f64, f64) {
    match convergence.ln_ratio() {
        Some((compared, ln_ratio)) if compared >= 8 => {
            let compared = compared as f64;
            let of_delta = GOES_ON / libm::log(0.25 * compared);
            let delta = -of_delta * ln_ratio.min(0.0);
            let further = libm::log(estimates as f64 / compared).max(0.0);
            let ln_left = ln_ratio.min(0.0) - libm::log(libm::exp2(1.0 + delta) - 1.0) - delta * further;
            // The derivative by ln ρ, near 1.
            let lever = 1.0 + of_delta * (2.0 * std::f64::consts::LN_2 + further);
            let of_ratio = scatter * lever * lever;
            let known = OF_EVENNESS / (OF_EVENNESS + of_ratio);
            // Half of what is beyond the ratio is a guess, and a fifth of that.
            let guess = 0.5 * (ln_ratio.min(0.0) - ln_left);
            let guesses = guess * guess + 0.04 * ln_ratio.min(0.0) * ln_ratio.min(0.0);
            (libm::exp(known * ln_left), known * (of_ratio + guesses))
        }
        _ => (1.0, OF_EVENNESS),
    }
}

impl Sums {
    /// The relative variance of a squared error about what it is expected to be.
    fn scatter(&self, convergence: &Convergence, pixels: Pixels) -> f64 {
        match pixels {
            // χ² of independent pixels.
            Pixels::Apart if self.noise > 0.0 => 2.0 * self.noise_sq / (self.noise * self.noise),
            Pixels::Together if convergence.differences() > 1 => convergence.log_variance(),
            _ => UNKNOWN,
        }
    }

    /// How much more the noise is by the light it is measured by than by the pixels' own; at least 1.
    fn measure(&self) -> f64 {
        if self.noise_by_own > 0.0 { (self.noise / self.noise_by_own).max(1.0) } else { 1.0 }
    }

    fn of(film: &Film) -> Self {
        let lights = Lights::of(film);
        let mut sums = Self::default();
        for (pixel, terms) in film.terms(&lights).enumerate() {
            let Some([noise, bias]) = terms else { continue };
            let (mean, divisor) = (lights.means[pixel], lights.divisors[pixel]);
            sums.noise += noise;
            sums.noise_by_own += noise * divisor / divisor.max(mean * mean);
            sums.noise_sq += noise * noise;
            sums.bias += bias;
            sums.blur_noise += film.pixels()[pixel].blur_variance(film.unit()) / divisor;
            sums.count += 1.0;
        }
        sums
    }
}

impl Film {
    /// What noise and bias each pixel is expected to have, squared and relative to its light; that of bias may be below
    /// zero by chance. `None` where it cannot be told.
    fn terms<'f>(&'f self, lights: &'f Lights) -> impl Iterator<Item = Option<[f64; 2]>> + 'f {
        let variances = lights.variances.iter().zip(&lights.divisors);
        self.pixels().iter().zip(variances).map(|(pixel, (variance, divisor))| {
            let bias_sq = pixel.bias_sq(self.unit());
            let known = variance.is_finite() && bias_sq.is_finite() && *divisor > 0.0;
            known.then(|| [variance / divisor, bias_sq / divisor])
        })
    }
}

impl Quality {
    /// The relative error that each pixel is expected to have, row by row: the root of what [`Self::error`] has the mean of.
    /// 0 where it cannot be told. Takes what [`Self::of`] takes.
    pub fn of_pixels(film: &Film, convergence: &Convergence, pixels: Pixels) -> Option<Vec<f32>> {
        let quality = Self::of(film, convergence, pixels)?;
        let scatter = Sums::of(film).scatter(convergence, pixels);
        let (evenness, _) = evenness(convergence, quality.estimates, scatter);
        let root = |[noise, bias]: [f64; 2]| libm::sqrt((noise * evenness + bias).max(0.0)) as f32;
        Some(film.terms(&Lights::of(film)).map(|terms| terms.map_or(0.0, root)).collect())
    }
}
