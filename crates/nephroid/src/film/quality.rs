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

/// The variance of the logarithm of a squared error that is thought likely before any is known …
const LIKELY: f64 = 0.5;

/// … and as how many differences between steps that counts.
const COUNTS_AS: f64 = 2.0;

/// The variance of the logarithm of a squared bias: it is a guess from two radii.
const OF_BIAS: f64 = 0.5;

/// How the errors of pixels hang together, which decides how far the error of one picture is from what is expected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pixels {
    /// Each pixel has samples of its own.
    Apart,
    /// Pixels share photons or light paths, and err together.
    Together,
}

/// What is thought of errors where a picture tells too little, from renders whose truth is known (`docs/error.md`).
struct Experience {
    /// The mean and the variance of the logarithm of what is left of the variance by [`evenness`].
    ln_even: [f64; 2],
    /// What the logarithm of the error is uncertain by for each e-folding that it matters by what noisy pixels are measured.
    of_measure: f64,
    /// What it adds to the variance of the squared error, for each part that is scatter: a photon that brightens many pixels
    /// brightens what they are measured by.
    of_scatter: f64,
}

impl Pixels {
    fn experience(self) -> Experience {
        match self {
            Self::Apart => Experience { ln_even: [0.0, 0.25], of_measure: 0.05, of_scatter: 0.0 },
            Self::Together => Experience { ln_even: [-0.3, 0.16], of_measure: 0.25, of_scatter: 1.0 },
        }
    }
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
        let experience = pixels.experience();
        let scatter = sums.scatter(convergence, pixels);
        let (evenness, of_evenness) = evenness(convergence, estimates, scatter, experience.ln_even);
        let noise_sq = sums.noise / sums.count * evenness;
        let bias_sq = (sums.bias / sums.count).max(0.0);
        let error_sq = noise_sq + bias_sq;
        // That noise is known from so many estimates.
        let of_noise = scatter * (1.0 + 1.0 / estimates as f64 + experience.of_scatter) + of_evenness;
        // 4 D̄² − 4 var(D̄) varies as the square of a noise of that size does.
        let of_blur = scatter * (4.0 * sums.blur_noise / sums.count).powi(2) + OF_BIAS * bias_sq * bias_sq;
        let relative = |variance: f64| if variance > 0.0 { variance / (error_sq * error_sq) } else { 0.0 };
        let method = OF_METHOD + experience.of_measure * libm::log(sums.measure());
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
/// what even samples take away is at last gone, and the δ of now is less. A ρ that is uncertain is drawn to what is `likely`,
/// the mean and the variance of the logarithm of what is left.
pub(super) fn evenness(
    convergence: &Convergence,
    estimates: u64,
    scatter: f64,
    likely: [f64; 2],
) -> (f64, f64) {
    let [ln_likely, of_likely] = likely;
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
            let known = of_likely / (of_likely + of_ratio);
            // Half of what is beyond the ratio is a guess, and a fifth of that.
            let guess = 0.5 * (ln_ratio.min(0.0) - ln_left);
            let guesses = guess * guess + 0.04 * ln_ratio.min(0.0) * ln_ratio.min(0.0);
            (libm::exp(ln_likely + known * (ln_left - ln_likely)), known * (of_ratio + guesses))
        }
        _ => (libm::exp(ln_likely), of_likely),
    }
}

impl Sums {
    /// The relative variance of a squared error about what it is expected to be.
    fn scatter(&self, convergence: &Convergence, pixels: Pixels) -> f64 {
        match pixels {
            // χ² of independent pixels.
            Pixels::Apart if self.noise > 0.0 => 2.0 * self.noise_sq / (self.noise * self.noise),
            Pixels::Apart => LIKELY,
            Pixels::Together => {
                let differences = convergence.differences() as f64;
                let sum = differences * convergence.log_variance() + COUNTS_AS * LIKELY;
                sum / (differences + COUNTS_AS)
            }
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
        let (evenness, _) = evenness(convergence, quality.estimates, scatter, pixels.experience().ln_even);
        let root = |[noise, bias]: [f64; 2]| libm::sqrt((noise * evenness + bias).max(0.0)) as f32;
        Some(film.terms(&Lights::of(film)).map(|terms| terms.map_or(0.0, root)).collect())
    }
}
