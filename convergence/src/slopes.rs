//! How fast renders of many iterations converge, and how fast progressive estimates narrow.

use std::ops::Range;

use nephroid::integrator::Method;
use nephroid::observer::Silent;
use nephroid::session::{Place, RenderPlan, RenderSettings, Session};
use nephroid::world::World;
use nephroid_testkit::MeanTest;
use rayon::prelude::*;

/// A session that has done so many iterations.
///
/// # Panics
/// Never: nothing cancels it.
pub fn iterated(world: &World, method: Method, iterations: u64, seed: u64) -> Session<'_> {
    let settings = RenderSettings { method, samples_per_pixel: 1, seed };
    let mut session = Session::new(world, settings, &Silent);
    iterate_to(&mut session, iterations);
    session
}

/// Renders on until so many iterations are complete.
pub(crate) fn iterate_to(session: &mut Session<'_>, iterations: u64) {
    while session.place().iteration + u64::from(session.iteration_is_complete()) < iterations {
        assert!(session.step(&Silent), "nothing cancels");
    }
}

/// The mean of the channels of each pixel so far.
pub(crate) fn pixels(session: &Session<'_>) -> Vec<f64> {
    let mean = |p: &nephroid::color::Rgb| p.to_array().iter().map(|&v| f64::from(v)).sum::<f64>() / 3.0;
    session.film().develop().pixels.iter().map(mean).collect()
}

/// Pictures after some numbers of iterations, for several seeds: by seed, number and pixel.
#[derive(Clone, Debug)]
pub struct Series {
    /// The numbers of iterations, ascending.
    pub iterations: Vec<u64>,
    /// Each pixel over what it should be.
    pub pictures: Vec<Vec<Vec<f64>>>,
}

/// What is left of an error after each of the numbers of iterations, relative to the light and squared.
#[derive(Clone, Debug, PartialEq)]
pub struct Errors {
    /// The mean over pixels and seeds.
    pub mse: Vec<f64>,
    /// The part that varies from seed to seed.
    pub variance: Vec<f64>,
    /// The part that all seeds share, without what is left of the noise; below zero by chance.
    pub bias_sq: Vec<f64>,
}

/// Which of the [`Errors`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// All of it.
    Mse,
    /// Noise.
    Variance,
}

impl Series {
    /// Renders on and on. One iteration's camera samples are one per pixel. `exact` is what each pixel should be.
    pub fn render(
        world: &World,
        method: &Method,
        iterations: &[u64],
        seeds: Range<u64>,
        exact: &[f64],
    ) -> Self {
        let settings = |seed| RenderSettings { method: method.clone(), samples_per_pixel: 1, seed };
        let plan = RenderPlan::new(world, &settings(seeds.start), &Silent);
        let render = |seed| {
            let mut session = Session::with_plan(world, settings(seed), plan);
            let picture = |&n: &u64| {
                iterate_to(&mut session, n);
                pixels(&session).iter().zip(exact).map(|(found, exact)| found / exact).collect()
            };
            iterations.iter().map(picture).collect()
        };
        let pictures = seeds.into_par_iter().map(render).collect();
        Self { iterations: iterations.to_vec(), pictures }
    }

    /// The errors of all seeds, or of all but one.
    pub fn errors(&self, without: Option<usize>) -> Errors {
        let mut errors = Errors { mse: Vec::new(), variance: Vec::new(), bias_sq: Vec::new() };
        for number in 0..self.iterations.len() {
            let kept: Vec<&Vec<f64>> = (0..self.pictures.len())
                .filter(|seed| Some(*seed) != without)
                .map(|seed| &self.pictures[seed][number])
                .collect();
            let (count, pixels) = (kept.len() as f64, kept[0].len());
            let (mut mse, mut variance, mut bias_sq) = (0.0, 0.0, 0.0);
            for pixel in 0..pixels {
                let test: MeanTest = kept.iter().map(|picture| picture[pixel] - 1.0).collect();
                let bias = test.mean() * test.mean();
                mse += bias + test.variance() * (count - 1.0) / count;
                variance += test.variance();
                bias_sq += bias - test.variance() / count;
            }
            for (sums, value) in
                [(&mut errors.mse, mse), (&mut errors.variance, variance), (&mut errors.bias_sq, bias_sq)]
            {
                sums.push(value / pixels as f64);
            }
        }
        errors
    }

    /// The slope of the logarithm of an error against that of the number of iterations: pseudo-values of the
    /// jackknife over the seeds, whose mean and spread are the slope's (Tukey 1958).
    pub fn slope(&self, part: Part) -> MeanTest {
        let of = |errors: &Errors| {
            let values = match part {
                Part::Mse => &errors.mse,
                Part::Variance => &errors.variance,
            };
            log_slope(&self.iterations, values)
        };
        let (all, count) = (of(&self.errors(None)), self.pictures.len());
        let pseudo = |seed| count as f64 * all - (count - 1) as f64 * of(&self.errors(Some(seed)));
        (0..count).map(pseudo).collect()
    }
}

/// The slope of the least squares line through (log n, log value).
pub fn log_slope(numbers: &[u64], values: &[f64]) -> f64 {
    let x: Vec<f64> = numbers.iter().map(|&n| libm::log(n as f64)).collect();
    let y: Vec<f64> = values.iter().map(|&v| libm::log(v)).collect();
    let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
    let (mx, my) = (mean(&x), mean(&y));
    let (mut xy, mut xx) = (0.0, 0.0);
    for (x, y) in x.iter().zip(&y) {
        xy += (x - mx) * (y - my);
        xx += (x - mx) * (x - mx);
    }
    xy / xx
}

/// The pictures of single iterations at one place of the series, for several seeds.
///
/// # Panics
/// Never: nothing cancels it.
pub fn single_iterations(world: &World, method: &Method, iteration: u64, seeds: Range<u64>) -> Vec<Vec<f64>> {
    let settings = |seed| RenderSettings { method: method.clone(), samples_per_pixel: 1, seed };
    let plan = RenderPlan::new(world, &settings(seeds.start), &Silent);
    let render = |seed| {
        let mut session =
            Session::with_plan(world, settings(seed), plan).starting_at(Place { iteration, samples: 0 });
        assert!(session.step(&Silent), "nothing cancels");
        pixels(&session)
    };
    seeds.into_par_iter().map(render).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_has_its_slope() {
        let numbers = [8, 16, 32, 64];
        let values = numbers.map(|n| 3.0 * libm::pow(n as f64, -0.7));
        assert!((log_slope(&numbers, &values) + 0.7).abs() < 1e-12);
    }

    /// Two pixels, of which one is 1.1 and one .9 in the mean, and seeds ± .2 apart.
    #[test]
    fn errors_are_noise_and_bias() {
        let pictures = vec![vec![vec![1.3, 0.7]], vec![vec![0.9, 1.1]]];
        let series = Series { iterations: vec![1], pictures };
        let errors = series.errors(None);
        assert!((errors.mse[0] - 0.05).abs() < 1e-12, "{errors:?}");
        assert!((errors.variance[0] - 0.08).abs() < 1e-12, "{errors:?}");
        assert!((errors.bias_sq[0] + 0.03).abs() < 1e-12, "{errors:?}");
    }
}
