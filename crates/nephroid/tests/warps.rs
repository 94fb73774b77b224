//! Every warp against the density it claims, by χ² tests. They share the level `ALPHA` by Šidák's
//! formula: on seeds chosen afresh, correct code would fail with probability 1 %.

use nephroid::math::{Vec2, Vec3, warp};
use nephroid_testkit::{ALPHA, ChiSquareTest, DiskTest, Outcome, Pcg32, SphereTest, sidak};
use std::f64::consts::PI;

/// More than the tests of this file.
const TESTS: usize = 20;

#[track_caller]
fn judge(name: &str, outcome: &Outcome) {
    assert!(outcome.passes(sidak(ALPHA, TESTS)), "{name}: {outcome}");
}

/// Tests a warp to directions.
#[track_caller]
fn sphere(name: &str, seed: u64, warp: impl Fn(Vec2) -> Vec3, pdf: impl Fn(Vec3) -> f32) {
    let mut rng = Pcg32::new(seed);
    let sample = || Some(warp(Vec2::from_array(rng.vec2_f32())).to_array().map(f64::from));
    let pdf = |w: [f64; 3]| f64::from(pdf(Vec3::from_array(w.map(|c| c as f32))));
    judge(name, &SphereTest::default().run(sample, pdf));
}

#[test]
fn the_disk_is_uniform() {
    let mut rng = Pcg32::new(1);
    let sample = || Some(warp::square_to_disk(Vec2::from_array(rng.vec2_f32())).to_array().map(f64::from));
    let pdf = |p: [f64; 2]| f64::from(warp::square_to_disk_pdf(Vec2::new(p[0] as f32, p[1] as f32)));
    judge("disk", &DiskTest::default().run(sample, pdf));
}

#[test]
fn the_sphere_is_uniform() {
    sphere("sphere", 2, warp::square_to_sphere, |_| warp::SPHERE_PDF);
}

#[test]
fn the_hemisphere_follows_the_cosine() {
    let (warp, pdf) = (warp::square_to_cosine_hemisphere, warp::square_to_cosine_hemisphere_pdf);
    sphere("cosine hemisphere", 3, warp, pdf);
}

/// In cells of the cone's own range of cosines; below 1e-6 or so directions are single precision's.
#[test]
fn cones_are_uniform() {
    for (seed, cos_max) in [(4, -0.5f32), (5, 0.3), (6, 0.99), (7, 0.9999)] {
        let mut rng = Pcg32::new(seed);
        let sample = || {
            let w = warp::square_to_cone(Vec2::from_array(rng.vec2_f32()), 1.0 - cos_max);
            Some(w.to_array().map(f64::from))
        };
        let test = SphereTest { cos_theta: [f64::from(cos_max), 1.0], ..Default::default() };
        let pdf = f64::from(warp::square_to_cone_pdf(1.0 - cos_max));
        judge(&format!("cone to {cos_max}"), &test.run(sample, |_| pdf));
    }
}

#[test]
fn powers_of_the_cosine_follow_it() {
    for (seed, exponent) in [(8, 0.0f32), (9, 1.0), (10, 20.0), (11, 1000.0)] {
        let warp = |u| warp::square_to_cosine_power(u, exponent);
        let pdf = |w: Vec3| warp::square_to_cosine_power_pdf(w.z, exponent);
        sphere(&format!("exponent {exponent}"), seed, warp, pdf);
    }
}

/// The angle to the axis keeps its digits however narrow the lobe: sin² θ = 1 − u^(2/(n+1)).
#[test]
fn narrow_powers_of_the_cosine_keep_their_digits() {
    for exponent in [9e3f32, 1.1e4, 1e5, 1e6, 1e8, 1e12] {
        for i in 1..200u32 {
            let u = Vec2::new(i as f32 / 200.0, 0.3);
            let w = warp::square_to_cosine_power(u, exponent);
            let exact = -libm::expm1(2.0 * libm::log(f64::from(u.x)) / (f64::from(exponent) + 1.0));
            let ratio = f64::from(w.truncate().length()) / exact.sqrt();
            // Below 10⁴ by subtraction, of which ε over sin² remains.
            let tolerance = if exponent > 1e4 { 5e-7 } else { 2e-7 / exact };
            assert!((ratio - 1.0).abs() < tolerance, "exponent {exponent}, u {}: {ratio}", u.x);
        }
    }
}

/// Barycentric weights of two vertices: density 2 on the half of the square below the diagonal.
#[test]
fn the_triangle_is_uniform() {
    let mut rng = Pcg32::new(12);
    let sample = || {
        let b = warp::square_to_triangle(Vec2::from_array(rng.vec2_f32()));
        Some(b.to_array().map(f64::from))
    };
    let test = ChiSquareTest { resolution: [12, 12], ..Default::default() };
    judge("triangle", &test.run(sample, |[x, y]| if x + y <= 1.0 { 2.0 } else { 0.0 }));
}

#[test]
fn directions_go_to_the_square_and_back() {
    let mut rng = Pcg32::new(13);
    for _ in 0..10_000 {
        let u = Vec2::from_array(rng.vec2_f32());
        let back = warp::sphere_to_square(warp::square_to_sphere(u));
        let turn = (back.y - u.y).abs();
        // Around the poles longitude is no more than rounding.
        let sin_theta = 2.0 * (u.x * (1.0 - u.x)).sqrt();
        assert!((back.x - u.x).abs() < 1e-6, "{u} came back as {back}");
        assert!(turn.min(1.0 - turn) * sin_theta < 1e-6, "{u} came back as {back}");
    }
}

/// The densities integrate to one over what they cover: πr² of the disk, 2π(1 − cos θ) of the cone.
#[test]
fn constants_are_those_of_geometry() {
    assert!((f64::from(warp::SPHERE_PDF) * 4.0 * PI - 1.0).abs() < 1e-7);
    assert!((f64::from(warp::square_to_disk_pdf(Vec2::ZERO)) * PI - 1.0).abs() < 1e-7);
    assert_eq!(warp::square_to_disk_pdf(Vec2::new(0.8, 0.7)), 0.0);
    assert_eq!(warp::square_to_cosine_power_pdf(-0.1, 3.0), 0.0);
}
