//! Every kernel with a fixed radius and with k neighbours, on a surface in uniform light: the one case
//! in which each is free of bias, and its constants are all that counts.
//!
//! All tests together reject a correct program with a probability of [`ALPHA`]; seeds are fixed.

use std::f64::consts::PI;

use nephroid::color::Rgb;
use nephroid::integrator::{Method, PhotonMapperConfig, Show};
use nephroid::light::LightKind;
use nephroid::math::{DVec3, Transform, Vec3};
use nephroid::photon_map::Kernel;
use nephroid::shape::Geometry;
use nephroid::world::World;
use nephroid_convergence::{Builder, map_view, session};
use nephroid_testkit::{ALPHA, MeanTest, Outcome, binomial_test, sidak};

const KERNELS: [Kernel; 6] = [
    Kernel::Box,
    Kernel::Cone { k: 1.0 },
    Kernel::Cone { k: 1.5 },
    Kernel::Gaussian,
    Kernel::Epanechnikov,
    Kernel::Biweight,
];

/// Each kernel with either bandwidth, the one that is not normalised, and the count of photons.
const TESTS: usize = 2 * KERNELS.len() + 2 + 1;

fn level() -> f64 {
    sidak(ALPHA, TESTS)
}

/// Half the side of a white square in parallel light of 1 W/m², and of the window at its middle.
const SIDE: f64 = 1.1;
const WINDOW: f64 = 1.0;

fn scene() -> World {
    let mut b = Builder::parallel_view(Vec3::Y, Vec3::ZERO, WINDOW, 40, 40);
    let white = b.diffuse(1.0);
    let to_world = Transform::scale(DVec3::splat(SIDE)).then(Transform::rotate(DVec3::X, -90.0));
    b.shape(Geometry::Rectangle, to_world, white);
    b.light(LightKind::Directional { direction: Vec3::NEG_Y, irradiance: Rgb::WHITE });
    b.build()
}

/// Eleven renders, each the mean irradiance of the window over what the photons on the square amount to,
/// evenly spread: their number is a matter of chance that has nothing to do with kernels.
///
/// Estimates are exact in the mean: of k − 1 neighbours because the k-th photon only sets the radius,
/// r ≤ .1 being at twice what holds k, and of a fixed radius anyway.
fn irradiance(world: &World, kernel: Kernel, radius: Option<f32>) -> MeanTest {
    // Sent everywhere, so that their number is their share of the light.
    let config = PhotonMapperConfig { aim: false, ..map_view(Show::Direct, 150_000) };
    let config = PhotonMapperConfig { kernel, radius, max_radius: Some(0.1), neighbours: 20, ..config };
    let power: f64 = world.lights().map(|(_, power)| f64::from(power.mean())).sum();
    let render = |seed| {
        let session = session(world, Method::PhotonMapper(config.clone()), 4, seed);
        let map = session.statistics().global;
        let landed = map.photons as f64 / map.paths as f64 * power;
        let seen = PI * f64::from(session.film().develop().mean().mean());
        seen / (landed / (4.0 * SIDE * SIDE))
    };
    (1..12).map(render).collect()
}

/// Rejects an error of .3 % as well, which is four standard errors and more.
fn within_three_per_mille(test: &MeanTest, exact: f64) -> Outcome {
    let outcome = test.against(exact);
    assert!((test.mean() / exact - 1.0).abs() < 3e-3, "{outcome}");
    outcome
}

#[test]
fn every_kernel_is_exact_in_uniform_light() {
    let world = scene();
    for kernel in KERNELS {
        for radius in [Some(0.05), None] {
            let test = irradiance(&world, kernel, radius);
            within_three_per_mille(&test, 1.0).assert_passes(level());
        }
    }
}

/// The kernel of 1996 integrates to α [1 − (1 − (2/β)(1 − e^(−β/2))) / (1 − e^(−β))] = .53115.
#[test]
fn the_kernel_of_1996_is_too_dark_by_as_much_as_is_known() {
    let beta = 1.953;
    let inner = 1.0 - 2.0 / beta * -libm::expm1(-0.5 * beta);
    let mass = 0.918 * (1.0 + inner / libm::expm1(-beta));
    assert!((mass - 0.531_15).abs() < 5e-6);
    let world = scene();
    for radius in [Some(0.05), None] {
        let test = irradiance(&world, Kernel::ReportGaussian, radius);
        within_three_per_mille(&test, mass).assert_passes(level());
    }
}

/// Photons of parallel light start from a disc around the scene, and as many land on the square as its
/// area is of the disc's.
#[test]
fn photons_of_parallel_light_are_uniform() {
    let world = scene();
    let power: f64 = world.lights().map(|(_, power)| f64::from(power.mean())).sum();
    let config = PhotonMapperConfig { aim: false, ..map_view(Show::Direct, 400_000) };
    let session = session(&world, Method::PhotonMapper(config), 1, 11);
    let map = session.statistics().global;
    binomial_test(map.photons, map.paths, 4.0 * SIDE * SIDE / power).assert_passes(level());
}
