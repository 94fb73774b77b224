//! What films of numbers with known spread tell of their error.

use nephroid_testkit::{ALPHA, Pcg32, binomial_test, sidak};

use super::*;

const SIDE: usize = 8;

/// More than the tests here that may fail by chance.
const TESTS: usize = 4;

/// A normal deviate (Box and Muller 1958).
fn normal(rng: &mut Pcg32) -> f64 {
    let (u, v) = (1.0 - rng.next_f64(), rng.next_f64());
    libm::sqrt(-2.0 * libm::log(u)) * libm::cos(std::f64::consts::TAU * v)
}

/// A render of pixels that are 1 with a standard deviation of one half, as many in a row alike as `alike` says.
struct Fake {
    film: Film,
    convergence: Convergence,
    pixels: Pixels,
    rng: Pcg32,
}

impl Fake {
    fn new(pixels: Pixels, seed: u64) -> Self {
        let film = Film::new(SIDE as u32, SIDE as u32);
        Self { film, convergence: Convergence::default(), pixels, rng: Pcg32::new(seed) }
    }

    fn step(&mut self, alike: usize) {
        let mut value = 0.0;
        let mut sums = Vec::new();
        for pixel in 0..SIDE * SIDE {
            if pixel % alike == 0 {
                value = 1.0 + 0.5 * normal(&mut self.rng);
            }
            let radiance = [value; 3];
            let luminance_sq = value * value;
            sums.push(PixelSum { radiance, luminance_sq, weight: 1.0, samples: 1, blur: 0.0 });
        }
        self.film.add_iteration(&sums);
        self.convergence.add(&mut self.film, self.pixels, |pixel| &sums[pixel]);
    }

    fn quality(&self) -> Option<Quality> {
        Quality::of(&self.film, &self.convergence, self.pixels)
    }

    /// E against a picture of ones.
    fn error(&self) -> f64 {
        let image = self.film.develop();
        let mean_square: f64 = image.pixels.iter().map(|p| (f64::from(p.g) - 1.0).powi(2)).sum();
        libm::sqrt(mean_square / image.pixels.len() as f64 / 1.01)
    }
}

/// The level is shared by Šidák's formula; that the interval is too wide is not tested, as it may be.
#[test]
fn the_true_error_lies_in_the_interval() {
    for (pixels, alike) in [(Pixels::Apart, 1), (Pixels::Together, 4)] {
        for steps in [8, 40] {
            let trials = 200;
            let inside = (0..trials).filter(|seed| {
                let mut fake = Fake::new(pixels, 77 + seed);
                (0..steps).for_each(|_| fake.step(alike));
                let [low, high] = fake.quality().expect("enough steps").interval;
                (low..=high).contains(&fake.error())
            });
            let inside = inside.count() as u64;
            let outcome = binomial_test(inside, trials, 0.9);
            assert!(10 * inside >= 9 * trials || outcome.passes(sidak(ALPHA, TESTS)), "{pixels:?} {outcome}");
        }
    }
}

/// An interval that ignores that pixels are alike is too narrow.
#[test]
fn pixels_that_err_together_make_the_error_uncertain() {
    let width = |alike| {
        let mut fake = Fake::new(Pixels::Together, 5);
        (0..64).for_each(|_| fake.step(alike));
        let quality = fake.quality().expect("enough steps");
        libm::log(quality.interval[1] / quality.interval[0])
    };
    assert!(width(16) > 1.5 * width(1), "{} {}", width(16), width(1));
}

#[test]
fn four_estimates_are_needed() {
    let mut fake = Fake::new(Pixels::Apart, 1);
    for steps in 1..6 {
        fake.step(1);
        assert_eq!(fake.quality().is_some(), steps >= 4);
    }
    assert!(Quality::of(&Film::new(0, 0), &Convergence::default(), Pixels::Apart).is_none());
}

#[test]
fn numbers_are_all_of_it() {
    let mut whole = Fake::new(Pixels::Together, 9);
    (0..11).for_each(|_| whole.step(2));
    let numbers = whole.convergence.numbers();
    assert_eq!(Convergence::from_numbers(numbers), whole.convergence);
    assert_eq!(whole.convergence.steps(), 10);
    // Gone on with from what a file keeps, with the same numbers to come.
    let (film, rng) = (whole.film.clone(), whole.rng.clone());
    let mut again = Fake { film, convergence: Convergence::from_numbers(numbers), pixels: whole.pixels, rng };
    for fake in [&mut whole, &mut again] {
        (0..9).for_each(|_| fake.step(2));
    }
    assert_eq!(again.convergence, whole.convergence);
    assert_eq!(again.quality(), whole.quality());
    assert!(whole.convergence.ln_ratio().is_some_and(|(estimates, _)| estimates == 16));
}

#[test]
fn parts_add_up_in_any_order() {
    let parts = [3, 4, 5].map(|seed| {
        let mut part = Fake::new(Pixels::Together, seed);
        (0..9).for_each(|_| part.step(1));
        part.convergence
    });
    let sum = |order: [usize; 3]| {
        let mut sum = Convergence::default();
        order.iter().for_each(|&part| sum.merge(&parts[part]));
        sum
    };
    assert_eq!(sum([0, 1, 2]), sum([2, 0, 1]));
    assert_eq!(sum([0, 1, 2]), sum([1, 2, 0]));
    assert_eq!(sum([0, 1, 2]).steps(), 24);
    let mean = parts.iter().map(Convergence::mean).sum::<f64>() / 3.0;
    assert!((sum([0, 1, 2]).mean() / mean - 1.0).abs() < 1e-12);
}

/// Pixels that are too bright by .1 in each estimate, half of which D tells, and vary: the mean of D² is .05² and what D varies by.
#[test]
fn bias_is_twice_what_half_of_the_blur_takes_away() {
    let mut film = Film::new(SIDE as u32, SIDE as u32);
    let mut rng = Pcg32::new(3);
    for _ in 0..64 {
        let mut sum = || {
            let mut sum =
                PixelSum { radiance: [1.0; 3], luminance_sq: 1.0, weight: 1.0, samples: 1, blur: 0.0 };
            sum.add_blur((0.05 + 0.05 * normal(&mut rng)) as f32, 1.0);
            sum
        };
        let sums: Vec<PixelSum> = (0..SIDE * SIDE).map(|_| sum()).collect();
        film.add_iteration(&sums);
    }
    let bias = Quality::of(&film, &Convergence::default(), Pixels::Together).expect("enough").bias;
    let expected = 0.1 / libm::sqrt(1.01);
    // The noise of the mean of D is .00625 for each of 64 pixels: four standard deviations of their mean, a chance of 1e-4.
    assert!((bias / expected - 1.0).abs() < 4.0 * 0.00625 / 0.05 / 8.0, "{bias} {expected}");
}

/// Halves of a render whose noise falls as n^(−1.4). What is left lies between what is if that has come to its end, ρ, and
/// what is if it goes on, n^(−.4).
#[test]
fn samples_that_are_spread_evenly_have_less_noise() {
    let (delta, compared) = (0.4, 64.0);
    let ln_ratio = -delta * libm::log(compared / 4.0);
    let convergence =
        |ln_ratio: f64| Convergence::from_numbers([0, 0, 0, 0, 0, 0, 0, compared as u64, ln_ratio.to_bits()]);
    let of = |ln_ratio, scatter| quality::evenness(&convergence(ln_ratio), 100, scatter, [-0.3, 0.25]);
    let (left, variance) = of(ln_ratio, 1e-9);
    // Either lies within two standard deviations.
    let reach = 2.0 * libm::sqrt(variance);
    assert!(
        (libm::log(left) - ln_ratio).abs() < reach
            && (libm::log(left) + delta * libm::log(100.0)).abs() < reach
    );
    assert!(libm::pow(100.0, -delta) < left && left < 0.9 * libm::exp(ln_ratio), "{left}");
    // Halves that are independent, and some that are further apart by chance, leave all.
    assert!([0.0, 0.1].iter().all(|&ln_ratio| (of(ln_ratio, 1e-9).0 - 1.0).abs() < 1e-6));
    let unsure = of(ln_ratio, 1e9);
    assert!((libm::log(unsure.0) + 0.3).abs() < 1e-6 && (unsure.1 - 0.25).abs() < 1e-6, "{unsure:?}");
}
