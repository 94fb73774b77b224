//! The χ² tests tested: right samplers pass at level α with these seeds, and each wrong one, by a stated margin, has a
//! p-value below one in a million.

use super::*;
use crate::{ALPHA, Pcg32, ks_test};
use std::f64::consts::{PI, TAU};

const REJECTED: f64 = 1e-6;

fn spherical(cos_theta: f64, phi: f64) -> [f64; 3] {
    let sin_theta = ((1.0 - cos_theta) * (1.0 + cos_theta)).sqrt();
    [sin_theta * libm::cos(phi), sin_theta * libm::sin(phi), cos_theta]
}

fn cosine_weighted(rng: &mut Pcg32) -> [f64; 3] {
    let [u, v] = rng.vec2();
    spherical((1.0 - u).sqrt(), TAU * v)
}

fn cosine_pdf(direction: [f64; 3]) -> f64 {
    direction[2].max(0.0) / PI
}

/// A direction distributed as cosⁿ of the angle to (0.6, 0, 0.8), off the pole and across the seam of φ's domain.
fn power_lobe(rng: &mut Pcg32, exponent: f64) -> [f64; 3] {
    let [u, v] = rng.vec2();
    let [x, y, z] = spherical(libm::pow(1.0 - u, 1.0 / (exponent + 1.0)), TAU * v);
    tilt([x, y, z])
}

fn power_pdf(direction: [f64; 3], exponent: f64) -> f64 {
    let cosine = untilt(direction)[2];
    if cosine <= 0.0 { 0.0 } else { (exponent + 1.0) / TAU * libm::pow(cosine, exponent) }
}

/// Rotates the pole to (0.6, 0, 0.8).
fn tilt([x, y, z]: [f64; 3]) -> [f64; 3] {
    [0.8 * x + 0.6 * z, y, 0.8 * z - 0.6 * x]
}

fn untilt([x, y, z]: [f64; 3]) -> [f64; 3] {
    [0.8 * x - 0.6 * z, y, 0.8 * z + 0.6 * x]
}

/// Trowbridge–Reitz (GGX) half vectors with roughness α, which reach all angles and peak at angles near α.
fn ggx(rng: &mut Pcg32, alpha: f64) -> [f64; 3] {
    let [u, v] = rng.vec2();
    let tan2 = alpha * alpha * u / (1.0 - u);
    spherical(1.0 / (1.0 + tan2).sqrt(), TAU * v)
}

fn ggx_pdf([x, y, z]: [f64; 3], alpha: f64) -> f64 {
    if z <= 0.0 {
        return 0.0;
    }
    let (a2, tan2) = (alpha * alpha, (x * x + y * y) / (z * z));
    let k = 1.0 + tan2 / a2;
    1.0 / (PI * a2 * z * z * z * k * k)
}

#[test]
fn a_square_passes_and_is_rejected_when_its_density_is_three_per_cent_off() {
    let mut rng = Pcg32::new(1);
    let mut run = |density: fn([f64; 2]) -> f64| ChiSquareTest::default().run(|| Some(rng.vec2()), density);
    run(|_| 1.0).assert_passes(ALPHA);
    run(|_| 0.97).assert_rejects(REJECTED);
    run(|_| 1.03).assert_rejects(REJECTED);
    run(|[x, _]| if x < 0.5 { 1.03 } else { 0.97 }).assert_rejects(REJECTED);
    run(|[x, y]| if (x < 0.5) == (y < 0.5) { 1.03 } else { 0.97 }).assert_rejects(REJECTED);
}

#[test]
fn samples_on_the_grid_of_single_precision_pass() {
    let mut rng = Pcg32::new(19);
    ChiSquareTest::default().run(|| Some(rng.vec2_f32().map(f64::from)), |_| 1.0).assert_passes(ALPHA);
}

#[test]
fn a_rectangle_of_any_size_works_alike() {
    for scale in [1e-6, 1e6] {
        let mut rng = Pcg32::new(2);
        let domain = Domain { min: [-scale; 2], max: [scale; 2] };
        let test = ChiSquareTest { domain, ..Default::default() };
        let mut run = |value: f64| {
            let sample = || Some(rng.vec2().map(|u| scale * (2.0 * u - 1.0)));
            test.run(sample, |_| value / (4.0 * scale * scale))
        };
        run(1.0).assert_passes(ALPHA);
        run(0.97).assert_rejects(REJECTED);
    }
}

#[test]
fn a_density_over_half_of_the_sphere() {
    let mut rng = Pcg32::new(3);
    let mut run = |factor: f64| {
        SphereTest::default().run(|| Some(cosine_weighted(&mut rng)), |d| factor * cosine_pdf(d))
    };
    run(1.0).assert_passes(ALPHA);
    run(0.97).assert_rejects(REJECTED);
    run(1.03).assert_rejects(REJECTED);
    let hemisphere = SphereTest { cos_theta: [0.0, 1.0], ..Default::default() };
    hemisphere.run(|| Some(cosine_weighted(&mut rng)), cosine_pdf).assert_passes(ALPHA);
    hemisphere.run(|| Some(cosine_weighted(&mut rng)), |_| 0.5 / PI).assert_rejects(REJECTED);
}

/// The boundary of the support runs obliquely through the cells, and the density jumps there.
#[test]
fn a_density_over_a_tilted_half_of_the_sphere() {
    let mut rng = Pcg32::new(4);
    let mut uniform = || {
        let [u, v] = rng.vec2();
        Some(tilt(spherical(u, TAU * v)))
    };
    SphereTest::default().run(&mut uniform, |d| power_pdf(d, 0.0)).assert_passes(ALPHA);
    SphereTest::default().run(&mut uniform, |d| power_pdf(d, 0.03)).assert_rejects(REJECTED);
}

#[test]
fn lobes_from_wide_to_sharp_pass_and_are_rejected_when_three_per_cent_too_sharp() {
    for (seed, exponent) in [(5, 5.0), (6, 30.0), (7, 1e3), (8, 1e5)] {
        let mut rng = Pcg32::new(seed);
        let mut run = |claimed: f64| {
            SphereTest::default().run(|| Some(power_lobe(&mut rng, exponent)), |d| power_pdf(d, claimed))
        };
        run(exponent).assert_passes(ALPHA);
        run(1.03 * exponent).assert_rejects(REJECTED);
    }
}

#[test]
fn microfacet_lobes_pass_and_are_rejected_when_three_per_cent_too_rough() {
    for (seed, alpha) in [(9, 0.5), (10, 0.05), (11, 1e-3)] {
        let mut rng = Pcg32::new(seed);
        let mut run =
            |claimed: f64| SphereTest::default().run(|| Some(ggx(&mut rng, alpha)), |d| ggx_pdf(d, claimed));
        run(alpha).assert_passes(ALPHA);
        run(1.03 * alpha).assert_rejects(REJECTED);
    }
}

#[test]
fn directions_in_single_precision_pass_even_in_a_sharp_lobe() {
    let mut rng = Pcg32::new(12);
    let single = || Some(ggx(&mut rng, 1e-3).map(|c| f64::from(c as f32)));
    SphereTest::default().run(single, |d| ggx_pdf(d, 1e-3)).assert_passes(ALPHA);
}

/// A sampler that fails for a tenth of its numbers passes if its density integrates to 0.9, and only then.
#[test]
fn failed_samples_need_room_in_the_density() {
    let mut rng = Pcg32::new(13);
    let mut failing = || (rng.next_f64() < 0.9).then(|| cosine_weighted(&mut rng));
    SphereTest::default().run(&mut failing, |d| 0.9 * cosine_pdf(d)).assert_passes(ALPHA);
    SphereTest::default().run(&mut failing, |d| 0.903 * cosine_pdf(d)).assert_rejects(REJECTED);
    SphereTest::default().run(&mut failing, cosine_pdf).assert_rejects(REJECTED);
}

/// One sample in ten thousand below the horizon, undefined, or not of unit length.
#[test]
fn rare_faults_of_a_sampler_are_rejected() {
    type Fault = fn([f64; 3]) -> Option<[f64; 3]>;
    let faults: [Fault; 4] =
        [|[x, y, z]| Some([x, y, -z]), |_| Some([f64::NAN; 3]), |d| Some(d.map(|c| 1.01 * c)), |_| None];
    for fault in faults {
        let mut rng = Pcg32::new(14);
        let mut run = |rate: f64| {
            let sample = || {
                let direction = cosine_weighted(&mut rng);
                if rng.next_f64() < rate { fault(direction) } else { Some(direction) }
            };
            SphereTest::default().run(sample, cosine_pdf)
        };
        run(1e-4).assert_rejects(REJECTED);
        run(2e-6).assert_passes(ALPHA);
    }
}

#[test]
fn faults_of_a_density_are_rejected_and_named() {
    let mut rng = Pcg32::new(15);
    let mut run = |density: fn([f64; 2]) -> f64| {
        let outcome = ChiSquareTest::default().run(|| Some(rng.vec2()), density);
        outcome.assert_rejects(1e-300);
        outcome.to_string()
    };
    assert!(run(|[x, _]| if x < 0.2 { f64::NAN } else { 1.0 }).contains("integrates to NaN"));
    assert!(run(|[x, _]| if x < 0.5 { -1.0 } else { 3.0 }).contains("integrates to -"));
    assert!(run(|_| 1.01).contains("more than 1"));
    assert!(run(|[x, _]| if x < 0.5 { 2.0 } else { 0.0 }).contains("lie where"));
    let sphere = SphereTest { samples: 1000, resolution: [1, 1], ..Default::default() };
    let coarse = sphere.run(|| Some([0.0, 0.0, 1.0]), |_| 0.25 / PI);
    coarse.assert_rejects(ALPHA);
    assert!(coarse.to_string().contains("nothing was tested"), "{coarse}");
}

#[test]
fn a_disk_of_any_radius() {
    for radius in [1e-3, 1.0, 1e4] {
        let mut rng = Pcg32::new(16);
        let test = DiskTest { radius, ..Default::default() };
        let area = PI * radius * radius;
        let mut uniform = || {
            let [u, v] = rng.vec2();
            let r = radius * u.sqrt();
            Some([r * libm::cos(TAU * v), r * libm::sin(TAU * v)])
        };
        test.run(&mut uniform, |_| 1.0 / area).assert_passes(ALPHA);
        test.run(&mut uniform, |_| 0.97 / area).assert_rejects(REJECTED);
        let slanted = |[x, _]: [f64; 2]| (1.0 + 0.03 * x.signum()) / area;
        test.run(&mut uniform, slanted).assert_rejects(REJECTED);
        let linear = || {
            let [u, v] = rng.vec2();
            Some([radius * u * libm::cos(TAU * v), radius * u * libm::sin(TAU * v)])
        };
        test.run(linear, |_| 1.0 / area).assert_rejects(REJECTED);
    }
}

/// A mirror-like lobe that holds a fifth of the samples, on a wide pedestal, and another one below.
#[test]
fn several_lobes_of_different_width() {
    let mut rng = Pcg32::new(18);
    let mut mixed = |below: f64| {
        let choice = rng.next_f64();
        if choice < 0.5 {
            cosine_weighted(&mut rng)
        } else if choice < 0.5 + below {
            power_lobe(&mut rng, 1e6).map(|c| -c)
        } else {
            power_lobe(&mut rng, 1e6)
        }
    };
    let pdf =
        |d: [f64; 3]| 0.5 * cosine_pdf(d) + 0.3 * power_pdf(d.map(|c| -c), 1e6) + 0.2 * power_pdf(d, 1e6);
    SphereTest::default().run(|| Some(mixed(0.3)), pdf).assert_passes(ALPHA);
    SphereTest::default().run(|| Some(mixed(0.309)), pdf).assert_rejects(REJECTED);
}

/// The p-values of 300 right tests are uniform: pooling, cells placed by the samples and quadrature do not bias them.
#[test]
fn p_values_of_right_samplers_are_uniform() {
    let mut rng = Pcg32::new(17);
    let test = SphereTest { samples: 2000, resolution: [6, 8], ..Default::default() };
    let p_values: Vec<f64> = (0..300)
        .map(|_| test.run(|| Some(power_lobe(&mut rng, 30.0)), |d| power_pdf(d, 30.0)).p_value)
        .collect();
    ks_test(&p_values, |p| p).assert_passes(ALPHA);
}
