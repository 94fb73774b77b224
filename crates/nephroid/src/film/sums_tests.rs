//! Films of made-up iterations.

use super::fixed::UNIT_LIMIT;
use super::{Film, FilmCounts, MergeError, PixelSum, PixelTotal};
use crate::color::Rgb;

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
    let sum =
        |r: f64| PixelSum { radiance: [r, 0.0, 0.0], weight: 1.0, luminance_sq: 1e30, samples: 1, blur: 0.0 };
    let iterations = [sum(f64::MAX), sum(-f64::MAX), sum(3.0), sum(f64::MAX)];
    let film_of = |order: [usize; 4]| {
        let mut film = Film::new(1, 1);
        order.iter().for_each(|&i| film.add_iteration(&[iterations[i]]));
        film
    };
    let film = film_of([0, 1, 2, 3]);
    assert_eq!(film, film_of([3, 0, 2, 1]));
    assert_eq!(film.counts().saturated, 3 + 4);
    assert_eq!(film.develop().pixel(0, 0).r, ((f64::from(u32::MAX) + 4.0) / 4.0) as f32);
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
            blur: 0.0,
        }]);
    }
    let step = 0.5f64.powi(48);
    let total = film.pixels()[0].radiance[0] as f64 * step;
    let exact = f64::from(n) * (1.0 / 3.0);
    // Half a step an iteration, and the rounding of this comparison itself.
    assert!((total - exact).abs() <= f64::from(n) * 0.5 * step + exact * f64::EPSILON);
    assert!((film.mean_luminance() - 1.0 / 3.0).abs() <= 0.5 * step + f64::EPSILON);
}

#[test]
fn a_pixel_with_nan_or_infinity_is_left_out_and_counted() {
    let good = PixelSum { radiance: [2.0; 3], luminance_sq: 4.0, weight: 1.0, samples: 1, blur: 0.0 };
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
        Film::from_parts((film.width(), film.height()), film.unit(), film.iterations(), film.counts(), pixels)
    };
    assert_eq!(parts(6), Some(film.clone()));
    assert_eq!(parts(5), None);
}

#[test]
fn radiances_of_any_scale_are_kept_with_their_noise() {
    for (unit, scale) in [(-40, 1e-12f32), (40, 1e12), (0, 1.0), (-120, 1e-36), (120, 1e36)] {
        let mut film = Film::with_unit(1, 1, unit);
        for v in [1.0, 2.0, 3.0, 6.0] {
            let mut sum = PixelSum::default();
            sum.add(Rgb::splat(v * scale), 1.0);
            film.add_iteration(&[sum]);
        }
        assert_eq!((film.unit(), film.counts()), (unit, FilmCounts::default()));
        let developed = film.develop().pixel(0, 0).g;
        assert!((developed / scale - 3.0).abs() <= 3.0 * f32::EPSILON, "{developed} at {scale}");
        // Squared deviations 4 + 1 + 0 + 9 = 14; 14 / 3 / 4.
        let relative = film.variance()[0] / f64::from(scale).powi(2) / (14.0 / 12.0);
        assert!((relative - 1.0).abs() < 1e-5, "{relative} at {scale}");
    }
    // Without a unit the same noise is lost, so the test tells; a pixel with light is then not free of noise.
    let mut film = Film::new(1, 1);
    for v in [1e-12, 3e-12] {
        let mut sum = PixelSum::default();
        sum.add(Rgb::splat(v), 1.0);
        film.add_iteration(&[sum]);
    }
    assert_eq!(film.variance(), [f64::INFINITY]);
}

#[test]
fn dark_pixels_are_not_free_of_noise() {
    let film_of = |values: [f32; 2]| {
        let mut film = Film::new(1, 1);
        for v in values {
            let mut sum = PixelSum::default();
            sum.add(Rgb::splat(v), 1.0);
            film.add_iteration(&[sum]);
        }
        film.variance()[0]
    };
    assert_eq!(film_of([0.0, 0.0]), 0.0);
    assert_eq!(film_of([1e-7, 2e-7]), f64::INFINITY);
    // A square of 2.25e-12 is 2.47 steps and counts as two: the variance of one sample in two, a quarter of that.
    let variance = film_of([0.0, 1.5e-6]);
    let exact = 1.5e-6f64.powi(2) / 4.0;
    assert!((variance / exact - 1.0).abs() < 0.5, "{variance}, not {exact}");
}

#[test]
fn films_of_other_units_do_not_merge() {
    let mut film = Film::with_unit(2, 1, 3);
    let error = film.merge(&Film::with_unit(2, 1, -4)).unwrap_err();
    assert_eq!(error, MergeError::Units { first: 3, second: -4 });
    assert_eq!(Film::with_unit(1, 1, i32::MIN).unit(), -UNIT_LIMIT);
    assert_eq!(Film::with_unit(1, 1, i32::MAX).unit(), UNIT_LIMIT);
}

#[test]
fn a_film_is_the_sum_of_its_pieces() {
    let (mut film, mut other) = (Film::new(3, 2), Film::new(3, 2));
    film.add_iteration(&iteration(1, 6));
    other.add_iteration(&iteration(2, 6));
    let mut pieces = film.clone();
    for first in [4, 0, 2] {
        pieces.add_pixels(first, &other.pixels()[first..first + 2]);
    }
    pieces.count(other.iterations(), other.counts());
    film.merge(&other).unwrap();
    assert_eq!(film, pieces);
}

#[test]
fn sums_end_where_those_of_a_file_end() {
    let mut film = Film::new(1, 1);
    let most = PixelTotal {
        radiance: [(1 << 95) - 1, -(1 << 95), 0],
        luminance_sq: (1 << 96) - 1,
        weight: i64::MAX,
        samples: u32::MAX,
        blur: -(1 << 95),
        blur_sq: (1 << 96) - 1,
        mark: (1 << 95) - 1,
    };
    film.add_pixels(0, &[most]);
    film.add_pixels(0, &[most]);
    assert_eq!(film.pixels(), [most]);
    let parts = |total: PixelTotal| Film::from_parts((1, 1), 0, 1, FilmCounts::default(), vec![total]);
    assert!(parts(most).is_some());
    assert!(parts(PixelTotal { radiance: [0, 0, 1 << 95], ..most }).is_none());
    assert!(parts(PixelTotal { luminance_sq: 1 << 96, ..most }).is_none());
    assert!(parts(PixelTotal { blur: 1 << 95, ..most }).is_none());
    assert!(parts(PixelTotal { blur_sq: 1 << 96, ..most }).is_none());
    assert!(Film::from_parts((1, 1), UNIT_LIMIT + 1, 1, FilmCounts::default(), vec![most]).is_none());
}
