//! Form factors: the share of what one diffuse surface emits that lands on another, counted in
//! photons and rendered as irradiance.
//!
//! All tests together reject a correct program with a probability of [`ALPHA`]; seeds are fixed.

use std::f64::consts::PI;

use nephroid::integrator::{DirectSource, Method, PhotonMapperConfig, Show};
use nephroid::math::{DVec3, Transform, Vec3};
use nephroid::session::Statistics;
use nephroid::shape::Geometry;
use nephroid_convergence::{
    Builder, Contestant, every_method_but, map_view, mean_radiances, photon_mapper, polygon_irradiance,
    session,
};
use nephroid_testkit::{ALPHA, MeanTest, Tolerance, binomial_test, integrate_2d, sidak};

/// More than three counts and three pictures by each method.
const TESTS: usize = 24;
const PATHS: u64 = 400_000;

/// Unit squares facing each other at distance 1.
const PARALLEL: f64 = 0.199_824_9;
/// Unit squares with an edge in common, at a right angle.
const PERPENDICULAR: f64 = 0.200_043_8;

fn level() -> f64 {
    sidak(ALPHA, TESTS)
}

/// The squares and discs have their centres on the y axis or on walls of the unit cube about
/// (0, ½, 0).
struct Pair {
    emitter: Geometry,
    emitter_to_world: Transform,
    receivers: Vec<Transform>,
    /// Half the width and depth of the window at the receiver that is looked at.
    window: f64,
}

/// A unit square in the plane z = 0, turned from +z towards +y by `degrees` about x, then moved.
fn square(axis: DVec3, degrees: f64, to: DVec3) -> Transform {
    Transform::scale(DVec3::new(0.5, 0.5, 1.0))
        .then(Transform::rotate(axis, degrees))
        .then(Transform::translate(to))
}

fn floor() -> Transform {
    square(DVec3::X, -90.0, DVec3::ZERO)
}

fn ceiling() -> Transform {
    square(DVec3::X, 90.0, DVec3::Y)
}

/// The wall at x = −½, facing +x.
fn wall() -> Transform {
    square(DVec3::Y, 90.0, DVec3::new(-0.5, 0.5, 0.0))
}

fn parallel_squares() -> Pair {
    Pair { emitter: Geometry::Rectangle, emitter_to_world: ceiling(), receivers: vec![floor()], window: 0.5 }
}

/// Looks at the middle of the floor only: where the squares touch, next event estimation without
/// multiple importance sampling, the photon mapper's, has no finite variance.
fn perpendicular_squares() -> Pair {
    Pair { emitter: Geometry::Rectangle, emitter_to_world: wall(), receivers: vec![floor()], window: 0.25 }
}

fn discs() -> Pair {
    let facing = |degrees, to| Transform::rotate(DVec3::X, degrees).then(Transform::translate(to));
    Pair {
        emitter: Geometry::Disk,
        emitter_to_world: facing(90.0, DVec3::Y),
        receivers: vec![facing(-90.0, DVec3::ZERO)],
        window: 1.0,
    }
}

/// An emitter of exitance 1 that reflects nothing, and receivers of the same shape and albedo ½.
fn scene(pair: &Pair, pixels: u32) -> Builder {
    let from = Vec3::new(0.0, 0.5, 0.0);
    let mut b = Builder::parallel_view(from, Vec3::ZERO, pair.window, pixels, pixels);
    let (black, grey) = (b.diffuse(0.0), b.diffuse(0.5));
    let radiance = b.constant((1.0 / PI) as f32);
    b.shape(pair.emitter.clone(), pair.emitter_to_world, black).emission = Some(radiance);
    for &receiver in &pair.receivers {
        b.shape(pair.emitter.clone(), receiver, grey);
    }
    b
}

/// Emits photons and stops them where they first land.
fn count(pair: &Pair) -> Statistics {
    let world = scene(pair, 1).build();
    // Sent everywhere, so that their number is their share of the light.
    let config = PhotonMapperConfig { max_depth: Some(2), aim: false, ..map_view(Show::Direct, PATHS) };
    let statistics = session(&world, Method::PhotonMapper(config), 1, 1).statistics().clone();
    let books = &statistics.ledger.lights[0];
    let landed = books.ended[0] / books.emitted[0];
    let stored = statistics.global.photons as f64 / statistics.global.paths as f64;
    assert!((landed - stored).abs() < 1e-6, "the books say {landed}, the map holds {stored}");
    statistics
}

/// Exact binomial tests of the photons that land.
#[test]
fn photons_land_in_proportion_to_the_form_factor() {
    let discs_factor = 0.5 * (3.0 - 5.0f64.sqrt());
    let expected =
        [(parallel_squares(), PARALLEL), (perpendicular_squares(), PERPENDICULAR), (discs(), discs_factor)];
    for (pair, factor) in expected {
        let map = count(&pair).global;
        assert_eq!(map.paths, PATHS);
        binomial_test(map.photons, PATHS, factor).assert_passes(level());
    }
}

/// From one face of a cube every photon lands on one of the other five, F∥ + 4 F⟂ = 1: there is no
/// gap along an edge, and no chance in it.
#[test]
fn a_closed_cube_lets_no_photon_out() {
    assert!((PARALLEL + 4.0 * PERPENDICULAR - 1.0).abs() < 2e-7);
    let mut pair = parallel_squares();
    pair.receivers = vec![
        floor(),
        wall(),
        square(DVec3::Y, -90.0, DVec3::new(0.5, 0.5, 0.0)),
        square(DVec3::X, 0.0, DVec3::new(0.0, 0.5, -0.5)),
        square(DVec3::X, 180.0, DVec3::new(0.0, 0.5, 0.5)),
    ];
    let statistics = count(&pair);
    assert_eq!(statistics.global.photons, PATHS);
    assert_eq!(statistics.ledger.lights[0].escaped, [0.0; 3]);
}

/// The irradiance that the whole receiver gets in the mean, or a window of it, with the same area as
/// the emitter: F · exitance. `exact` is that mean over the window. L = ½ E / π.
fn render(pair: &Pair, exact: f64) {
    let world = scene(pair, 16).build();
    for Contestant { method, .. } in every_method_but(&["volpath", "ppm"], &photon_mapper(0)) {
        let radiances = mean_radiances(&world, &method, 64, 1..13);
        // Single precision is worth 1e-6.
        radiances
            .into_iter()
            .map(|l| 2.0 * PI * l)
            .collect::<MeanTest>()
            .within(exact, 1e-6)
            .assert_passes(level());
    }
}

#[test]
fn parallel_squares_light_one_another() {
    render(&parallel_squares(), PARALLEL);
}

/// The window's mean by Lambert's formula, whose mean over the whole floor is the form factor.
#[test]
fn perpendicular_squares_light_one_another() {
    let corner = |y, z| DVec3::new(-0.5, y, z);
    let wall = [corner(0.0, -0.5), corner(1.0, -0.5), corner(1.0, 0.5), corner(0.0, 0.5)];
    let mean = |half: f64, tolerance| {
        // The floor lies below the wall by a hair: on its edge the formula is undefined.
        let e = |[x, z]: [f64; 2]| polygon_irradiance(&wall, DVec3::new(x, -1e-9, z), DVec3::Y) / PI;
        let range = [-half, half];
        integrate_2d(e, &range, &range, Tolerance::relative(tolerance)).value / (4.0 * half * half)
    };
    assert!((mean(0.5, 1e-6) / PERPENDICULAR - 1.0).abs() < 1e-5);
    render(&perpendicular_squares(), mean(0.25, 1e-8));
}

/// The window is the square around the disc, of which the disc fills π/4.
#[test]
fn discs_light_one_another() {
    render(&discs(), 0.25 * PI * 0.5 * (3.0 - 5.0f64.sqrt()));
}

/// The photon mapper's direct light is rays here: with no photons wanted, none is traced.
#[test]
fn direct_light_by_rays_needs_no_photons() {
    let world = scene(&parallel_squares(), 1).build();
    let config = photon_mapper(0);
    assert_eq!(config.direct, DirectSource::Rays);
    let session = session(&world, Method::PhotonMapper(config), 1, 1);
    assert_eq!(session.statistics().global.paths, 0);
}
