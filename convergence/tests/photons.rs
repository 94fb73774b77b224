//! Photons one by one: where they go, how many there are and what they are worth, by exact binomial
//! tests wherever a photon is there or not with a known probability.
//!
//! The tests of the file share the level [`ALPHA`] by Šidák's formula: on seeds chosen afresh, correct
//! code would fail somewhere in this file with probability 1 %.

use libm::{atan, sqrt};
use nephroid::color::Rgb;
use nephroid::integrator::{DirectSource, FinalGather, Method, PathConfig, PhotonMapperConfig, Show};
use nephroid::light::{LightKind, SphereSampling};
use nephroid::material::Material;
use nephroid::math::{DVec3, Transform, Vec3};
use nephroid::photon_map::{Kernel, Photon};
use nephroid::shape::Geometry;
use nephroid::transport::{PhotonPass, WalkSettings};
use nephroid::world::World;
use nephroid_convergence::{Builder, means, photons};
use nephroid_testkit::{
    ALPHA, MeanTest, Outcome, SphereTest, Tolerance, binomial_test, goodness_of_fit, integrate_2d, sidak,
};
use std::f64::consts::PI;

/// More than the statistical tests of this file.
const TESTS: usize = 120;

/// Rounding of single precision, for sums that should be exact.
const ROUNDING: f64 = 1e-5;

const SAMPLINGS: [SphereSampling; 2] = [SphereSampling::SolidAngle, SphereSampling::Rejection];

#[track_caller]
fn judge(name: &str, outcome: &Outcome) {
    assert!(outcome.passes(sidak(ALPHA, TESTS)), "{name}: {outcome}");
}

#[track_caller]
fn close(name: &str, value: f64, exact: f64) {
    assert!((value / exact - 1.0).abs() < ROUNDING, "{name}: {value} is not {exact}");
}

fn builder() -> Builder {
    Builder::seen_from(Vec3::new(0.0, 0.0, 5.0), Vec3::ZERO, 40.0, 1)
}

fn walks(sphere_sampling: SphereSampling) -> WalkSettings {
    WalkSettings { sphere_sampling, ..Default::default() }
}

/// Power of photons in W, per channel.
fn power<'a>(pass: &PhotonPass, photons: impl IntoIterator<Item = &'a Photon>) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for photon in photons {
        for (s, p) in sum.iter_mut().zip(photon.power.to_array()) {
            *s += f64::from(p);
        }
    }
    sum.map(|s| s / pass.global.emitted() as f64)
}

/// A light of intensity I at height h sends 2πI(1 − h/√(h² + R²)) into the disc of radius R
/// below it; as a share of 4πI, the probability that a photon lands there.
fn disc_share(h: f64, radius: f64) -> f64 {
    0.5 * (1.0 - h / sqrt(h * h + radius * radius))
}

#[test]
fn photons_land_in_discs_below_a_light_by_solid_angle() {
    const PATHS: u64 = 200_000;
    let (h, intensity) = (1.5, 2.0);
    let mut b = builder();
    let floor = b.diffuse(0.5);
    b.shape(Geometry::Plane, Transform::IDENTITY, floor);
    b.point_light(Vec3::new(0.0, 0.0, h as f32), intensity);
    let world = b.build();
    for (seed, sampling) in (0..).zip(SAMPLINGS) {
        let settings = WalkSettings { max_photon_depth: Some(1), ..walks(sampling) };
        let pass = photons(&world, &settings, PATHS, seed);
        let landed = pass.global.as_slice();
        for r in [0.2, 0.75, 1.5, 6.0] {
            let inside = landed.iter().filter(|p| f64::from(p.position.length()) < r).count() as u64;
            let share = disc_share(h, r);
            judge(&format!("{sampling:?}, R = {r}"), &binomial_test(inside, PATHS, share));
        }
        judge(&format!("{sampling:?}, plane"), &binomial_test(landed.len() as u64, PATHS, 0.5));
        let each = 4.0 * PI * f64::from(intensity);
        assert!(landed.iter().all(|p| (f64::from(p.power.mean()) / each - 1.0).abs() < ROUNDING));
    }
}

/// The share of a light's photons in the rectangle [0, x] × [0, y] of a wall at distance 1.
fn corner_share(x: f64, y: f64) -> f64 {
    atan(x * y / sqrt(1.0 + x * x + y * y)) / (4.0 * PI)
}

/// Item 43 of the report: a wrong way from random numbers to directions showed as dark regions on the
/// walls. The counts in 6 × 16 × 16 squares of the walls of a cube, and the directions themselves.
#[test]
fn a_light_in_a_cube_shines_evenly_on_all_walls() {
    const PATHS: u64 = 400_000;
    const CELLS: usize = 16;
    let mut b = builder();
    let wall = b.diffuse(0.5);
    b.shape(Geometry::Cube, Transform::IDENTITY, wall).flip_normals = true;
    b.point_light(Vec3::ZERO, 1.0);
    let world = b.build();
    let edge = |i: usize| 2.0 * i as f64 / CELLS as f64 - 1.0;
    let mut expected = Vec::new();
    for cell in 0..6 * CELLS * CELLS {
        let (i, j) = (cell / CELLS % CELLS, cell % CELLS);
        let share = corner_share(edge(i + 1), edge(j + 1)) + corner_share(edge(i), edge(j))
            - corner_share(edge(i), edge(j + 1))
            - corner_share(edge(i + 1), edge(j));
        expected.push(PATHS as f64 * share);
    }
    for (seed, sampling) in (0..).zip(SAMPLINGS) {
        let settings = WalkSettings { max_photon_depth: Some(1), ..walks(sampling) };
        let pass = photons(&world, &settings, PATHS, seed);
        let mut counts = vec![0; expected.len()];
        for photon in pass.global.as_slice() {
            let p = photon.position.to_array();
            let axis = (0..3).find(|&a| photon.normal[a] != 0.0).unwrap();
            let wall = 2 * axis + usize::from(p[axis] > 0.0);
            let cell = |x: f32| ((0.5 * (x + 1.0) * CELLS as f32) as usize).min(CELLS - 1);
            counts[(wall * CELLS + cell(p[(axis + 1) % 3])) * CELLS + cell(p[(axis + 2) % 3])] += 1;
        }
        judge(&format!("{sampling:?}, walls"), &goodness_of_fit(&counts, &expected));
        let directions: Vec<Vec3> = pass.global.as_slice().iter().map(|p| -p.wi).collect();
        let samples = directions.len() * 16 / 17;
        let mut next = directions.into_iter();
        let sphere = SphereTest { samples, ..SphereTest::default() };
        let outcome = sphere.run(|| next.next().map(|d| d.to_array().map(f64::from)), |_| 0.25 / PI);
        judge(&format!("{sampling:?}, directions"), &outcome);
    }
}

fn closed_room(albedo: Rgb, intensity: Rgb) -> World {
    let mut b = builder();
    let reflectance = b.scene.textures.constant(albedo);
    let wall = b.scene.materials.push(Material::Diffuse { reflectance });
    b.shape(Geometry::Cube, Transform::scale(DVec3::new(1.0, 2.0, 1.5)), wall).flip_normals = true;
    b.light(LightKind::Point { position: Vec3::new(0.2, 0.5, -0.3), intensity });
    b.build()
}

/// The flux that arrives after n bounces is Φρⁿ. As roulette keeps the power of photons, they are
/// there with probability ρⁿ: an exact binomial test for each n.
#[test]
fn flux_falls_geometrically_with_every_bounce() {
    const PATHS: u64 = 50_000;
    for (seed, albedo) in [(1, 0.3f32), (2, 0.7), (3, 0.95)] {
        let pass = photons(&closed_room(Rgb::splat(albedo), Rgb::WHITE), &walks(SAMPLINGS[0]), PATHS, seed);
        let of = |n: u16| pass.global.as_slice().iter().filter(move |p| p.depth == n + 1);
        assert_eq!(of(0).count() as u64, PATHS);
        for n in [1, 2, 3, 6, 12, 40] {
            let share = libm::pow(f64::from(albedo), f64::from(n));
            let name = format!("albedo {albedo}, bounce {n}");
            judge(&name, &binomial_test(of(n).count() as u64, PATHS, share));
            let each = 4.0 * PI;
            assert!(of(n).all(|p| (f64::from(p.power.mean()) / each - 1.0).abs() < 1e-4), "{name}");
        }
    }
}

/// In colour the number of photons is roulette's business, but the flux of every channel after n
/// bounces is its own Φρⁿ, whatever the others do.
#[test]
fn flux_of_every_colour_falls_by_its_own_albedo() {
    let (albedo, intensity) = ([0.9f32, 0.5, 0.1], [0.1f32, 0.4, 1.0]);
    let world = closed_room(Rgb::from(albedo), Rgb::from(intensity));
    let mut tests = [[MeanTest::new(); 3]; 8];
    for seed in 0..60 {
        let pass = photons(&world, &walks(SAMPLINGS[0]), 2000, seed);
        for (n, channels) in (0..).zip(&mut tests) {
            let flux = power(&pass, pass.global.as_slice().iter().filter(|p| p.depth == n + 1));
            channels.iter_mut().zip(flux).for_each(|(test, flux)| test.push(flux));
        }
    }
    for (n, channels) in tests.iter().enumerate() {
        for (c, test) in channels.iter().enumerate() {
            let flux = 4.0 * PI * f64::from(intensity[c]) * libm::pow(f64::from(albedo[c]), n as f64);
            judge(&format!("channel {c}, bounce {n}"), &test.within(flux, ROUNDING));
        }
    }
}

/// A photon path of n segments at most leaves exactly n photons in a room that absorbs nothing.
#[test]
fn limits_of_depth_hold_for_photons() {
    let world = closed_room(Rgb::WHITE, Rgb::WHITE);
    for max in [1, 2, 5] {
        let settings = WalkSettings { max_photon_depth: Some(max), ..Default::default() };
        let pass = photons(&world, &settings, 1000, 1);
        assert_eq!(pass.global.stored() as u32, 1000 * max);
        assert!(pass.global.as_slice().iter().all(|p| u32::from(p.depth) <= max));
    }
}

/// The caustic map gets L S+ D and nothing else. A mirror faces a matt floor, and light reaches the
/// floor directly, by the mirror, and by floor and mirror (L D S D, which is the global map's).
#[test]
fn caustic_photons_met_specular_surfaces_and_no_other() {
    const PATHS: u64 = 100_000;
    let mut b = builder();
    let (floor, mirror) = (b.diffuse(0.6), b.mirror(1.0));
    b.shape(Geometry::Plane, Transform::IDENTITY, floor);
    let ceiling = Transform::rotate(DVec3::X, 180.0).then(Transform::translate(DVec3::new(0.0, 0.0, 2.0)));
    b.shape(Geometry::Plane, ceiling, mirror);
    b.point_light(Vec3::new(0.0, 0.0, 1.0), 1.0);
    let pass = photons(&b.build(), &walks(SAMPLINGS[0]), PATHS, 1);
    // Half of the paths go up to the mirror, and then down: one caustic photon each, at depth 2.
    let caustic = pass.caustic.as_slice();
    judge("L S D", &binomial_test(caustic.len() as u64, PATHS, 0.5));
    assert!(caustic.iter().all(|p| p.depth == 2));
    // The other half is direct. All go on by floor, mirror, floor with probability 0.6 each time, and
    // belong to the global map at odd depths after a direct hit, even ones after a caustic one.
    let of = |n: u16| pass.global.as_slice().iter().filter(move |p| p.depth == n).count() as u64;
    judge("L D", &binomial_test(of(1), PATHS, 0.5));
    assert_eq!(of(2), 0, "L S D is not the global map's");
    judge("L D S D", &binomial_test(of(3), PATHS, 0.5 * 0.6));
    judge("L S D S D", &binomial_test(of(4), PATHS, 0.5 * 0.6));
    judge("L D S D S D", &binomial_test(of(5), PATHS, 0.5 * 0.36));
}

/// The same flux by another way: nothing is lost or counted twice between the two maps and direct light.
#[test]
fn the_two_maps_add_up_to_all_light() {
    let mut b = builder();
    let (wall, glass) = (b.diffuse(0.6), b.glass(1.5));
    b.sphere(Vec3::ZERO, 2.0, wall).flip_normals = true;
    b.sphere(Vec3::new(0.5, 0.0, 0.0), 0.7, glass);
    b.point_light(Vec3::new(-1.0, 0.0, 0.3), 1.0);
    let world = b.build();
    let total: MeanTest = (0..40)
        .map(|seed| {
            let pass = photons(&world, &walks(SAMPLINGS[0]), 2000, seed);
            power(&pass, pass.global.as_slice())[0] + power(&pass, pass.caustic.as_slice())[0]
        })
        .collect();
    judge("flux", &total.within(4.0 * PI / (1.0 - 0.6), ROUNDING));
}

/// Photons from inside a glass ball come out with the power they had, and all of them do.
#[test]
fn power_is_the_same_outside_glass() {
    for light in [Vec3::ZERO, Vec3::new(0.2, 0.1, 0.0)] {
        let mut b = builder();
        let (wall, glass) = (b.diffuse(0.6), b.glass(1.5));
        b.sphere(Vec3::ZERO, 2.0, wall).flip_normals = true;
        b.sphere(Vec3::ZERO, 1.0, glass);
        b.point_light(light, 1.0);
        let settings = WalkSettings { max_photon_depth: Some(40), ..Default::default() };
        let pass = photons(&b.build(), &settings, 20_000, 1);
        assert_eq!(pass.caustic.stored(), 20_000);
        close(&format!("light at {light}"), power(&pass, pass.caustic.as_slice())[0], 4.0 * PI);
    }
}

/// Items 41 and 42 of the report, A1: a point light over a plane, seen at single points. Rays have no
/// noise here; the map's box is the mean of I h/(h² + r²)^{3/2} over a disc, and only a small share
/// of the paths lands there at all.
#[test]
fn irradiance_below_a_point_light_has_the_cosine_and_the_paths_emitted() {
    let (h, intensity, albedo, radius) = (1.0f64, 2.0f64, 0.5, 0.25f64);
    let irradiance = |x: f64, y: f64| intensity * h / libm::pow(h * h + x * x + y * y, 1.5);
    for x in [0.0f64, 1.0, 2.0] {
        let look_at = Vec3::new(x as f32, 0.0, 0.0);
        let mut b = Builder::seen_from(look_at + Vec3::new(1.0, 0.3, 2.0), look_at, 1e-3, 1);
        let floor = b.diffuse(albedo as f32);
        b.shape(Geometry::Plane, Transform::IDENTITY, floor);
        b.point_light(Vec3::new(0.0, 0.0, h as f32), intensity as f32);
        let world = b.build();
        let by_rays = Method::PhotonMapper(PhotonMapperConfig { emit: Some(1), ..Default::default() });
        for method in [Method::Path(PathConfig::default()), by_rays] {
            let seen = means(&world, &method, 1, 0..1)[0];
            close(&format!("{} at {x}", method.name()), seen, albedo / PI * irradiance(x, 0.0));
        }
        let config = PhotonMapperConfig {
            direct: DirectSource::Map,
            final_gather: FinalGather::Off,
            kernel: Kernel::Box,
            emit: Some(50_000),
            radius: Some(radius as f32),
            ..Default::default()
        };
        let disc = |[r, phi]: [f64; 2]| r * irradiance(x + r * libm::cos(phi), r * libm::sin(phi));
        let tolerance = Tolerance { absolute: 0.0, relative: 1e-9 };
        let mean =
            integrate_2d(disc, &[0.0, radius], &[0.0, 2.0 * PI], tolerance).value / (PI * radius * radius);
        let seen: MeanTest = means(&world, &Method::PhotonMapper(config), 1, 0..60).into_iter().collect();
        judge(&format!("map at {x}"), &seen.within(albedo / PI * mean, ROUNDING));
    }
}

/// Item 41 for the caustic map: it is divided by its own paths, of which there are other numbers than
/// of the global map's. Above the light is a mirror, in which it is seen at height 3 over the floor.
#[test]
fn the_caustic_map_is_divided_by_its_own_paths() {
    let (albedo, radius) = (0.5, 0.5f64);
    let mut b = Builder::seen_from(Vec3::new(0.3, 0.0, 0.5), Vec3::ZERO, 1e-3, 1);
    let (floor, mirror) = (b.diffuse(albedo as f32), b.mirror(1.0));
    b.shape(Geometry::Plane, Transform::IDENTITY, floor);
    let ceiling = Transform::scale(DVec3::splat(2.0))
        .then(Transform::rotate(DVec3::X, 180.0))
        .then(Transform::translate(DVec3::new(0.0, 0.0, 2.0)));
    b.shape(Geometry::Disk, ceiling, mirror);
    b.point_light(Vec3::new(0.0, 0.0, 1.0), 1.0);
    let world = b.build();
    for (photons, caustic_photons) in [(1000, 20_000), (20_000, 5000)] {
        let config = PhotonMapperConfig {
            kernel: Kernel::Box,
            radius: Some(radius as f32),
            photons,
            caustic_photons,
            show: Show::Caustic,
            ..Default::default()
        };
        let exact = albedo / PI * 4.0 * PI * disc_share(3.0, radius) / (PI * radius * radius);
        let seen: MeanTest = means(&world, &Method::PhotonMapper(config), 1, 0..60).into_iter().collect();
        judge(&format!("{photons} and {caustic_photons} photons"), &seen.within(exact, ROUNDING));
    }
}
