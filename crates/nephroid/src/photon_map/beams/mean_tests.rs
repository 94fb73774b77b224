//! Means of the weights where they are known: length of beams in a unit of volume times the length of the ray.
//!
//! All are tests of the mean over independent maps (Student's t). This file is one suite with a false-positive rate of
//! `ALPHA` = 1 %, shared out by Šidák's correction.

use nephroid_testkit::{ALPHA, MeanTest, Outcome, sidak};

use super::Beam;
use super::testing::{beam, direction, map, total};
use crate::math::{Frame, Ray, Vec3};
use crate::photon_map::Kernel;
use crate::photon_map::testing::Rng;

/// All that integrate to one.
const KERNELS: [Kernel; 6] = [
    Kernel::Box,
    Kernel::Cone { k: 1.0 },
    Kernel::Cone { k: 1.1 },
    Kernel::Gaussian,
    Kernel::Epanechnikov,
    Kernel::Biweight,
];

/// 12 for beams of all directions, 24 for bundles, 6 for ends.
const TESTS: usize = 42;

fn passes(outcome: &Outcome) {
    outcome.assert_passes(sidak(ALPHA, TESTS));
}

/// Means over `maps` maps of what `sample` makes of each.
fn mean(maps: u64, seed: u64, mut sample: impl FnMut(&mut Rng) -> f64) -> MeanTest {
    (0..maps).map(|i| sample(&mut Rng::new(seed * 1_000_003 + i))).collect()
}

/// Beams of all directions, with origins uniform in a cube of half the side `half`, as long as `longest` at most.
fn isotropic(n: usize, half: f32, longest: f32, rng: &mut Rng) -> Vec<Beam> {
    let mut one = |i| {
        let origin = (rng.point() * 2.0 - 1.0) * half;
        beam(i, origin, direction(rng), longest * (1.0 - rng.next()))
    };
    (0..n).map(&mut one).collect()
}

#[test]
fn beams_of_all_directions_count_with_their_length_in_a_unit_of_volume() {
    const RAYS: usize = 80;
    const T: f32 = 0.7;
    // Longer than their width, and shorter.
    for (seed, longest, radius) in [(1, 1.0, 0.2), (2, 0.2, 0.3)] {
        // No beam from outside could come within the radius.
        let (half, n) = (T + longest + radius, 1000);
        let expected = n as f64 * 0.5 * f64::from(longest) / f64::from(2.0 * half).powi(3) * f64::from(T);
        let mut means = KERNELS.map(|_| MeanTest::new());
        for number in 0..160 {
            let mut rng = Rng::new(seed * 1_000_003 + number);
            let map = map(isotropic(n, half, longest, &mut rng), radius);
            let rays: Vec<_> = (0..RAYS).map(|_| Ray::new(Vec3::ZERO, direction(&mut rng))).collect();
            for (mean, kernel) in means.iter_mut().zip(KERNELS) {
                let sum: f64 = rays.iter().map(|ray| total(&map, ray, T, kernel)).sum();
                mean.push(sum / RAYS as f64);
            }
        }
        for mean in means {
            assert!(mean.standard_error() < 0.03 * expected, "too few samples");
            passes(&mean.against(expected));
        }
    }
}

/// Beams along `frame`'s z, through a square of side 2 around its origin, one in each of many cells so that sums vary
/// little: from z = -2 on, each as long as `length` says of its x and y.
fn bundle(frame: &Frame, length: impl Fn(f32, f32) -> f32, rng: &mut Rng) -> Vec<Beam> {
    let z = frame.to_world(Vec3::Z).normalize();
    let mut one = |i: usize| {
        let cell = |i: usize, u: f32| ((i as f32 + u) / SIDE as f32) * 2.0 - 1.0;
        let (x, y) = (cell(i % SIDE, rng.next()), cell(i / SIDE, rng.next()));
        beam(i, frame.to_world(Vec3::new(x, y, -2.0)), z, length(x, y))
    };
    (0..SIDE * SIDE).map(&mut one).collect()
}

/// Beams to a side of a bundle.
const SIDE: usize = 32;

/// Beams of a bundle in a unit of area.
const DENSITY: f64 = (SIDE * SIDE) as f64 / 4.0;

fn tilted() -> Frame {
    Frame::from_normal(Vec3::new(1.0, 2.0, -3.0).normalize())
}

/// A ray in the frame, from a point with z = 0, at an angle to z in degrees, bent towards x.
fn at_angle(frame: &Frame, x: f32, y: f32, degrees: f64) -> Ray {
    let angle = degrees.to_radians();
    let d = Vec3::new(libm::sin(angle) as f32, 0.0, libm::cos(angle) as f32);
    Ray::new(frame.to_world(Vec3::new(x, y, 0.0)), frame.to_world(d).normalize())
}

#[test]
fn a_bundle_counts_with_its_density_and_the_length_of_the_ray_at_any_angle() {
    let frame = tilted();
    for (seed, degrees) in [(3u64, 90.0), (4, 45.0), (5, 5.0), (6, 175.0), (7, 1.0), (8, 0.0)] {
        for (kernel, radius) in [
            (Kernel::Box, 0.1),
            (Kernel::Epanechnikov, 0.2),
            (Kernel::Gaussian, 0.1),
            (Kernel::Cone { k: 1.1 }, 0.3),
        ] {
            let mean = mean(50, seed, |rng| {
                let map = map(bundle(&frame, |_, _| 4.0, rng), radius);
                let ray = |y| at_angle(&frame, -0.5, y, degrees);
                (0..8).map(|i| total(&map, &ray(i as f32 * 0.15 - 0.5), 0.8, kernel)).sum::<f64>() / 8.0
            });
            assert!(mean.standard_error() < 0.03 * 0.8 * DENSITY, "too few samples");
            passes(&mean.within(0.8 * DENSITY, 1e-6));
        }
    }
}

/// Where beams end, at any slant, the sum stops there: neither light beyond nor a lack before.
#[test]
fn the_ends_of_beams_are_not_blurred_away() {
    let frame = tilted();
    type Length = fn(f32, f32) -> f32;
    let lengths: [(&str, Length); 3] = [
        ("straight across", |_, _| 2.3),
        ("slanted along the ray's plane", |x, _| 2.3 + 0.5 * x),
        ("slanted across the ray's plane", |_, y| 2.3 + 0.5 * y),
    ];
    for (seed, (name, length)) in (9u64..).zip(lengths) {
        for degrees in [45.0, 80.0] {
            // The ray starts at (-0.5, 0, 0) and leaves the beams where z = 0.3, or 0.3 + x / 2.
            let angle = f64::to_radians(degrees);
            let (sin, cos) = (libm::sin(angle), libm::cos(angle));
            let leaves = if seed == 10 { 0.05 / (cos - 0.5 * sin) } else { 0.3 / cos };
            // Where it does not leave them it ends inside.
            let t_max = 1.2;
            let expected = if leaves > 0.0 { leaves.min(t_max) } else { t_max };
            let mean = mean(120, seed, |rng| {
                let map = map(bundle(&frame, length, rng), 0.15);
                total(&map, &at_angle(&frame, -0.5, 0.0, degrees), t_max as f32, Kernel::Epanechnikov)
            });
            assert!(mean.standard_error() < 0.03 * expected * DENSITY, "{name}: too few samples");
            passes(&mean.within(expected * DENSITY, 1e-6));
        }
    }
}
