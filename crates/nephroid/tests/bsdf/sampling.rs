//! Samplers against their densities.

use nephroid::material::{Bsdf, Surface, Transport};
use nephroid::math::{Frame, Vec2, Vec3};

use crate::statistics::{COLUMNS, ROWS, Rng, cell, chi_square, integrate, significance};
use crate::zoo::for_each;

const SAMPLES: usize = 60_000;

/// Counts of samples in the cells about `axis`, with one more for draws that gave nothing.
fn histogram(bsdf: &Bsdf, axis: &Frame, wo: Vec3, rng: &mut Rng) -> Vec<f64> {
    let mut counts = vec![0.0; ROWS * COLUMNS + 1];
    for _ in 0..SAMPLES {
        let sample = bsdf.sample(wo, rng.square(), rng.next(), Transport::Radiance);
        counts[sample.map_or(ROWS * COLUMNS, |sample| cell(axis, sample.wi))] += 1.0;
    }
    counts
}

/// The counts to expect, by integrating the density.
fn expectation(bsdf: &Bsdf, axis: &Frame, wo: Vec3) -> Vec<f64> {
    let mut shares = integrate(axis, |wi| f64::from(bsdf.pdf(wo, wi)));
    let total: f64 = shares.iter().sum();
    assert!(total < 1.001, "the density integrates to {total}");
    shares.push((1.0 - total).max(0.0));
    shares.iter().map(|share| share * SAMPLES as f64).collect()
}

#[test]
fn samples_follow_their_density() {
    let mut results = Vec::new();
    for_each(|_, case, place, wo, bsdf| {
        let name = format!("{} from {wo}, flat: {}", case.name, place.flat);
        let drawn = bsdf.sample(wo, Vec2::splat(0.4), 0.5, Transport::Radiance);
        if bsdf.is_black()
            || bsdf.is_dirac()
            || wo.dot(place.surface.frame.n) * wo.dot(place.surface.ng) < 0.0
        {
            assert!(drawn.is_none_or(|sample| sample.is_dirac()), "{name}");
            return;
        }
        let axis = Frame::from_normal(place.surface.ng);
        let observed = histogram(&bsdf, &axis, wo, &mut Rng(results.len() as u64));
        results.push((name, chi_square(&observed, &expectation(&bsdf, &axis, wo))));
    });
    assert!(results.len() > 50);
    let alpha = significance(results.len());
    for (name, p_value) in results {
        assert!(p_value > alpha, "{name}: {p_value}");
    }
}

#[test]
fn a_weight_is_f_cos_over_pdf() {
    let mut rng = Rng(1);
    for_each(|_, case, place, wo, bsdf| {
        for _ in 0..200 {
            let (u, u_lobe) = (rng.square(), rng.next());
            for transport in [Transport::Radiance, Transport::Flux] {
                let Some(sample) = bsdf.sample(wo, u, u_lobe, transport) else { continue };
                if sample.is_dirac() {
                    assert_eq!(sample.pdf_solid_angle, 0.0);
                    continue;
                }
                let pdf = bsdf.pdf(wo, sample.wi);
                assert!(pdf > 0.0 && sample.pdf_solid_angle == pdf, "{}", case.name);
                let n = place.surface.frame.n;
                let mut expected = bsdf.eval(wo, sample.wi) * (sample.wi.dot(n).abs() / pdf);
                if transport == Transport::Flux {
                    expected *= bsdf.adjoint_factor(wo, sample.wi);
                }
                assert!(
                    (expected - sample.weight).map(f32::abs).max_channel() <= 1e-5 * expected.max_channel()
                );
            }
        }
    });
}

#[test]
fn sampling_dirac_lobes_is_following_all_on_average() {
    const DRAWS: usize = 4096;
    for_each(|_, case, _, wo, bsdf| {
        if !bsdf.is_dirac() {
            assert_eq!(bsdf.dirac_lobes(wo, Transport::Flux), [None, None], "{}", case.name);
            return;
        }
        for transport in [Transport::Radiance, Transport::Flux] {
            let lobes = bsdf.dirac_lobes(wo, transport);
            let mut sums = [0.0f32; 2];
            for i in 0..DRAWS {
                let u_lobe = (i as f32 + 0.5) / DRAWS as f32;
                let Some(sample) = bsdf.sample(wo, Vec2::ZERO, u_lobe, transport) else { continue };
                let Some(lobe) = lobes[usize::from(sample.transmitted)] else {
                    panic!("{} draws a lobe it does not have", case.name)
                };
                assert!(sample.is_dirac() && lobe.is_dirac() && sample.transmitted == lobe.transmitted);
                assert_eq!(sample.wi, lobe.wi);
                sums[usize::from(sample.transmitted)] += sample.weight.g / DRAWS as f32;
            }
            for (sum, lobe) in sums.into_iter().zip(lobes) {
                let weight = lobe.map_or(0.0, |lobe| lobe.weight.g);
                // The number of draws of a lobe is off by one at most; a draw weighs at most 4.
                assert!((sum - weight).abs() < 4.0 / DRAWS as f32, "{}: {sum} for {weight}", case.name);
            }
        }
    });
}

#[test]
fn extreme_numbers_and_directions_give_no_nan() {
    let top = 1.0 - f32::EPSILON / 2.0;
    for_each(|zoo, case, place, _, _| {
        let Surface { ng, frame, .. } = place.surface;
        let grazing = Frame::from_normal(ng).s;
        for wo in [ng, -ng, frame.n, frame.s, -frame.t, grazing, (grazing + 1e-20 * ng).normalize()] {
            let bsdf = zoo.bsdf(case, &place.surface, wo);
            for u in
                [Vec2::ZERO, Vec2::splat(top), Vec2::new(0.0, top), Vec2::new(top, 0.5), Vec2::splat(0.5)]
            {
                for (u_lobe, transport) in [(0.0, Transport::Radiance), (top, Transport::Flux)] {
                    if let Some(sample) = bsdf.sample(wo, u, u_lobe, transport) {
                        assert!(sample.weight.is_finite() && sample.weight.min_channel() >= 0.0);
                        assert!((sample.wi.length() - 1.0).abs() < 1e-5, "{}", case.name);
                        assert!(sample.pdf_solid_angle.is_finite() && sample.pdf_solid_angle >= 0.0);
                    }
                }
            }
        }
    });
}
