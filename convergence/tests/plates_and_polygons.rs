//! Diffuse light between two parallel plates, and direct light from a polygon at a point.
//!
//! All tests together reject a correct program with a probability of [`ALPHA`]; seeds are fixed.

use std::f64::consts::PI;

use nephroid::integrator::{DirectSource, FinalGather, Method, PhotonMapperConfig, Show, VcmConfig};
use nephroid::math::{DVec3, Transform, Vec3};
use nephroid::shape::Geometry;
use nephroid::world::World;
use nephroid_convergence::{
    Builder, blurred, map_view, mean_radiances, path, photon_mapper, pixel_origins, polygon_irradiance,
    renders,
};
use nephroid_testkit::{ALPHA, MeanTest, sidak};

/// Pixels of a strip across the light of a polygon.
const STRIP: u32 = 12;
/// Two plates by six estimators, and two strips by five, with their sums.
const TESTS: usize = 2 * 6 + 2 * 5 * (1 + STRIP as usize);

fn level() -> f64 {
    sidak(ALPHA, TESTS)
}

/// Exitance and albedo of the lower and the upper plate.
const EXITANCE: [f64; 2] = [1.0, 0.5];
const ALBEDO: [f64; 2] = [0.6, 0.3];

/// Plates of 2 by 2 at distance 1 between four perfect mirrors: to anyone inside, the plates are
/// infinite. Looks at the middle of the lower plate, or of the upper one.
fn plates(look_at_upper: bool) -> World {
    let middle = Vec3::new(0.0, 0.5, 0.0);
    let target = Vec3::new(0.0, f32::from(look_at_upper), 0.0);
    let mut b = Builder::parallel_view(middle, target, 0.3, 8, 8);
    for (i, (degrees, y)) in [(-90.0, 0.0), (90.0, 1.0)].into_iter().enumerate() {
        let plate = b.diffuse(ALBEDO[i] as f32);
        let radiance = b.constant((EXITANCE[i] / PI) as f32);
        let to_world =
            Transform::rotate(DVec3::X, degrees).then(Transform::translate(DVec3::new(0.0, y, 0.0)));
        b.shape(Geometry::Rectangle, to_world, plate).emission = Some(radiance);
    }
    let mirror = b.mirror(1.0);
    for turn in 0..4 {
        // From the plane z = 0 to the plane z = −1, facing in, then around the y axis.
        let to_world = Transform::translate(DVec3::new(0.0, 0.5, -1.0))
            .then(Transform::rotate(DVec3::Y, 90.0 * f64::from(turn)));
        b.shape(Geometry::Rectangle, to_world, mirror);
    }
    b.build()
}

/// B₁ = (M₁ + ρ₁ M₂) / (1 − ρ₁ ρ₂), and the same with the plates exchanged.
///
/// Path tracing and a map of fixed radius are unbiased: all light together is uniform, and so are
/// direct photons, caustic and global ones together under one kernel. With k nearest neighbours each
/// map has its own radius, but holds a part of the light that is nearly uniform at the middle, at
/// 1e-3. Gather rays read the maps next to the mirrors, too. There .17 r of every metre of edge is
/// lost to a kernel of radius r, half the mean distance along one axis: with 6 of 40 000 photons on
/// 8 m², r = .02, that is 8 · .17 r / 4 = .7 % of light of two bounces or more, itself less than 18 %
/// of all; twice as much is allowed.
#[test]
fn parallel_plates_reach_the_sum_of_their_series() {
    let fixed = PhotonMapperConfig {
        direct: DirectSource::Map,
        final_gather: FinalGather::Off,
        radius: Some(0.1),
        ..photon_mapper(40_000)
    };
    let nearest = PhotonMapperConfig { radius: None, neighbours: 100, ..fixed.clone() };
    let vcm = VcmConfig { light_paths: Some(5000), ..VcmConfig::default() };
    let methods = [
        (path(), 64, 1e-6),
        (Method::PhotonMapper(fixed), 4, 1e-6),
        (Method::PhotonMapper(nearest), 4, 1e-3),
        (Method::PhotonMapper(photon_mapper(40_000)), 16, 3e-3),
        (Method::Vcm(vcm.clone()), 1, 3e-3),
        (Method::Vcm(VcmConfig { merging: false, ..vcm }), 1, 1e-6),
    ];
    for (i, upper) in [(0, false), (1, true)] {
        let series = EXITANCE[i] + ALBEDO[i] * EXITANCE[1 - i];
        let radiosity = series / (1.0 - ALBEDO[0] * ALBEDO[1]);
        let world = plates(upper);
        for (method, samples, bias) in &methods {
            let radiances = mean_radiances(&world, method, *samples, 1..9);
            let test: MeanTest = radiances.into_iter().map(|l| PI * l).collect();
            test.within(radiosity, *bias).assert_passes(level());
        }
    }
}

/// A light of radiance 1 above the floor y = 0, of albedo 1, seen along the strip |x| ≤ 1.
struct Lamp {
    to_world: Transform,
    corners: [DVec3; 4],
}

/// A rectangle at a slant, all of it above the floor, and a wall that reaches down to .1 above it.
fn lamps() -> [Lamp; 2] {
    let slanted = Transform::scale(DVec3::new(0.5, 0.3, 1.0))
        .then(Transform::rotate(DVec3::X, 90.0))
        .then(Transform::rotate(DVec3::Z, 35.0))
        .then(Transform::translate(DVec3::new(-0.3, 1.0, 0.2)));
    let wall = Transform::scale(DVec3::new(0.6, 0.45, 1.0))
        .then(Transform::rotate(DVec3::Y, 90.0))
        .then(Transform::translate(DVec3::new(-1.2, 0.55, 0.1)));
    [slanted, wall].map(|to_world| {
        let corner = |x, y| to_world.0.transform_point3(DVec3::new(x, y, 0.0));
        let corners = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
        Lamp { to_world, corners }
    })
}

fn lit_by(lamp: &Lamp) -> World {
    let from = Vec3::new(0.0, 0.05, 0.0);
    let mut b = Builder::parallel_view(from, Vec3::ZERO, 1.0, STRIP, 1);
    let (white, black, one) = (b.diffuse(1.0), b.diffuse(0.0), b.constant(1.0));
    let floor = Transform::scale(DVec3::splat(2.0)).then(Transform::rotate(DVec3::X, -90.0));
    b.shape(Geometry::Rectangle, floor, white);
    b.shape(Geometry::Rectangle, lamp.to_world, black).emission = Some(one);
    b.build()
}

/// The mean irradiance of each pixel, 2/[`STRIP`] square, by Lambert's formula; under the kernel of a
/// fixed radius, if there is one.
fn irradiances(lamp: &Lamp, world: &World, radius: Option<f64>) -> Vec<f64> {
    let at = |x, z| polygon_irradiance(&lamp.corners, DVec3::new(x, 0.0, z), DVec3::Y);
    let here = |x, z| radius.map_or_else(|| at(x, z), |r| blurred(at, x, z, r));
    // Simpson's rule over the pixel's square.
    let nodes = [(-1.0, 1.0 / 6.0), (0.0, 4.0 / 6.0), (1.0, 1.0 / 6.0)];
    let half = 1.0 / f64::from(STRIP);
    let mean = |p: DVec3| {
        let row = |z: f64| nodes.map(|(u, w)| w * here(p.x + u * half, z)).iter().sum::<f64>();
        nodes.map(|(v, w)| w * row(p.z + v * half)).iter().sum()
    };
    pixel_origins(world).into_iter().map(mean).collect()
}

/// Every pixel against its exact mean, and their sum. Next event estimation, a density estimate of fixed radius,
/// whose expectation is known, and k nearest neighbours: k = 100 of some 40 000 photons a m² lie
/// within r = .03, the second derivative of E over E stays below 10, and r²/12 of it is 1e-3.
#[test]
fn polygons_light_every_point_by_lamberts_formula() {
    let radius = 0.08;
    let map = |radius| {
        let config = map_view(Show::Direct, 100_000);
        Method::PhotonMapper(PhotonMapperConfig { radius, neighbours: 100, ..config })
    };
    for lamp in lamps() {
        let world = lit_by(&lamp);
        for (method, samples, radius, bias) in [
            (path(), 512, None, 1e-5),
            (Method::PhotonMapper(photon_mapper(0)), 512, None, 1e-5),
            (map(Some(radius as f32)), 64, Some(radius), 1e-4),
            (map(None), 64, None, 2e-3),
            (Method::Vcm(VcmConfig::default()), 1, None, 1e-5),
        ] {
            let exact = irradiances(&lamp, &world, radius);
            let pictures = renders(&world, &method, samples, 1..25);
            let sum: MeanTest = pictures.iter().map(|p| PI * p.iter().sum::<f64>()).collect();
            sum.within(exact.iter().sum(), bias).assert_passes(level());
            for (pixel, exact) in exact.into_iter().enumerate() {
                let test: MeanTest = pictures.iter().map(|p| PI * p[pixel]).collect();
                test.within(exact, bias).assert_passes(level());
            }
        }
    }
}
