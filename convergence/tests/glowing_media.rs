//! Media that give off light: what they send to surfaces against closed forms, photons against paths, and the books.
//!
//! The tests of the file share the level [`ALPHA`] by Šidák's formula: on seeds chosen afresh, correct code would
//! fail somewhere in this file with probability 1 %. The others compare bits.

use std::f64::consts::PI;

use nephroid::color::Rgb;
use nephroid::handle::Handle;
use nephroid::integrator::{
    DirectSource, FinalGather, Method, PathConfig, PhotonMapperConfig, VcmConfig, VolumeEstimate,
};
use nephroid::light::LightKind;
use nephroid::material::Material;
use nephroid::math::{DVec3, Transform, Vec3};
use nephroid::medium::{Coefficient, Grid, GridValues, Medium, Phase};
use nephroid::shape::Geometry;
use nephroid::transport::{VolumeKind, WalkSettings};
use nephroid::world::World;
use nephroid_convergence::{Builder, forgiving, mean_radiances, photon_mapper, photons, session};
use nephroid_testkit::{ALPHA, MeanTest, Tolerance, integrate, sidak};

/// Six ways to see a ball of gas, twice; its power and that of a cloud; four renders of a room.
const TESTS: usize = 6 * 2 + 2 + 4;

const ALBEDO: f64 = 0.5;
const EMISSION: f64 = 2.0;
/// The floor's below the middle of a ball of radius 1, and the camera's distance beside that.
const DEPTH: f64 = 2.0;
const CAMERA: f64 = 2.5;
/// Half the width of what the camera sees.
const WINDOW: f64 = 0.5;

fn gas(b: &mut Builder, sigma_t: f32, albedo: f32, emission: Coefficient) -> Handle<Medium> {
    let medium = Medium::homogeneous("gas", Rgb::splat(sigma_t), Rgb::splat(albedo), Phase::Isotropic);
    b.scene.media.list.push(Medium { emission, ..medium })
}

fn null(b: &mut Builder) -> Handle<Material> {
    b.scene.materials.push(Material::Null)
}

/// A ball of gas above a floor, of which a small window is seen.
fn ball_above_floor(sigma_t: f32) -> World {
    let target = Vec3::new(0.0, -DEPTH as f32, 0.0);
    let mut b = Builder::parallel_view(Vec3::new(CAMERA as f32, 0.0, 0.0), target, WINDOW, 12, 12);
    let floor = b.diffuse(ALBEDO as f32);
    let to_world = Transform::scale(DVec3::splat(4.0))
        .then(Transform::rotate(DVec3::X, -90.0))
        .then(Transform::translate(DVec3::new(0.0, -DEPTH, 0.0)));
    b.shape(Geometry::Rectangle, to_world, floor);
    let gas = gas(&mut b, sigma_t, 0.0, Coefficient::Constant(Rgb::splat(EMISSION as f32)));
    let null = null(&mut b);
    b.sphere(Vec3::ZERO, 1.0, null).boundary.interior = Some(gas);
    b.build()
}

/// Mean radiance of the window. Where all of the ball is above the floor, what comes from it adds up to a vector along
/// the line to its middle: ∫ ε (1 − e^(−σc))/σ cos γ dω over its chords c.
fn below_the_ball(sigma_t: f64) -> f64 {
    let from_distance = |distance: f64| {
        let along = |gamma: f64| {
            let (sin, cos) = (libm::sin(gamma), libm::cos(gamma));
            let chord = 2.0 * (1.0 - (distance * sin) * (distance * sin)).max(0.0).sqrt();
            let seen = if sigma_t > 0.0 { -libm::expm1(-sigma_t * chord) / sigma_t } else { chord };
            2.0 * PI * sin * cos * EMISSION * seen
        };
        integrate(along, &[0.0, libm::asin(1.0 / distance)], Tolerance::relative(1e-7)).value
    };
    if sigma_t == 0.0 {
        // As if all of it came from the middle.
        let exact = EMISSION * 4.0 / 3.0 * PI / (DEPTH * DEPTH);
        assert!((from_distance(DEPTH) / exact - 1.0).abs() < 1e-6);
    }
    // The floor is seen at an angle, so that the window is longer along x.
    let stretch = (DEPTH * DEPTH + CAMERA * CAMERA).sqrt() / DEPTH;
    let places = (0..16).map(|i| WINDOW * ((f64::from(i) + 0.5) / 8.0 - 1.0));
    let irradiance =
        places.clone().flat_map(|x| places.clone().map(move |z| (stretch * x, z))).map(|(x, z)| {
            let distance = (DEPTH * DEPTH + x * x + z * z).sqrt();
            DEPTH / distance * from_distance(distance)
        });
    ALBEDO / PI * irradiance.sum::<f64>() / 256.0
}

fn volpath(max_depth: Option<u32>) -> Method {
    Method::Path(PathConfig { max_depth, media: true, ..PathConfig::default() })
}

/// Photons are blurred, by less than a percent where irradiance is so smooth.
#[test]
fn a_ball_of_gas_lights_a_floor() {
    for sigma_t in [0.0, 2.0] {
        let world = ball_above_floor(sigma_t);
        let exact = below_the_ball(f64::from(sigma_t));
        let mapper = |final_gather, direct, max_depth| {
            // Nothing is scattered in the gas.
            let base = PhotonMapperConfig { volume_photons: Some(0), ..photon_mapper(20_000) };
            let config = PhotonMapperConfig { final_gather, direct, max_depth, ..base };
            Method::PhotonMapper(config)
        };
        // With camera samples of each pixel.
        let methods = [
            (volpath(None), 64),
            (volpath(Some(2)), 64),
            (mapper(FinalGather::Off, DirectSource::Rays, None), 1),
            (mapper(FinalGather::Rays(2), DirectSource::Rays, Some(2)), 1),
            (mapper(FinalGather::Off, DirectSource::Map, Some(2)), 1),
            (Method::Vcm(VcmConfig { light_paths: Some(500), ..VcmConfig::default() }), 1),
        ];
        for (i, (method, samples)) in methods.iter().enumerate() {
            let test: MeanTest = mean_radiances(&world, method, *samples, 1..9).into_iter().collect();
            let outcome = test.within(exact, 0.01);
            assert!(outcome.passes(sidak(ALPHA, TESTS)), "{sigma_t}, {i}: {outcome}");
            assert!((test.mean() / exact - 1.0).abs() < 0.03, "{sigma_t}, {i}: {outcome}");
        }
    }
}

/// A cloud on a turned grid in a box that it does not fill, in which the emission goes on beside its own, smaller grid.
fn cloud_in_room(emits: f32) -> World {
    let mut b = Builder::seen_from(Vec3::new(0.0, 0.3, 4.5), Vec3::new(0.0, -0.2, 0.0), 34.0, 8);
    let white = b.diffuse(0.7);
    let white = b.two_sided(white);
    let wall = |degrees: f64, axis: DVec3, to: DVec3| {
        Transform::scale(DVec3::splat(1.5))
            .then(Transform::rotate(axis, degrees))
            .then(Transform::translate(to))
    };
    b.shape(Geometry::Rectangle, wall(-90.0, DVec3::X, DVec3::new(0.0, -1.0, 0.0)), white);
    b.shape(Geometry::Rectangle, wall(0.0, DVec3::X, DVec3::new(0.0, 0.0, -1.5)), white);
    let glass = b.glass(1.5);
    b.sphere(Vec3::new(0.7, -0.6, 0.6), 0.35, glass);
    let values = |n: u32, scale: f32| (0..n).map(|i| scale * ((i * 7 % 5) as f32)).collect();
    let grids = &mut b.scene.media.grids;
    let density =
        grids.push(Grid { name: "d".into(), size: [3, 2, 4], values: GridValues::Grey(values(24, 0.4)) });
    let light =
        grids.push(Grid { name: "e".into(), size: [4, 3, 2], values: GridValues::Grey(values(24, emits)) });
    let place = |scale: f64, turn: f64| {
        Transform::translate(DVec3::splat(-0.5))
            .then(Transform::scale(DVec3::splat(scale)))
            .then(Transform::rotate(DVec3::new(0.3, 1.0, 0.2), turn))
    };
    let grid = |grid, scale, turn| Coefficient::Grid { grid, to_world: place(scale, turn), scale: 1.0 };
    let cloud = b.scene.media.list.push(Medium {
        name: "gas".into(),
        sigma_t: grid(density, 1.0, 20.0),
        albedo: Coefficient::Constant(Rgb::splat(0.8)),
        emission: grid(light, 0.6, 50.0),
        phase: Phase::Isotropic,
        ambient: Rgb::BLACK,
    });
    let null = null(&mut b);
    let shape = b.shape(Geometry::Cube, Transform::scale(DVec3::splat(0.6)), null);
    shape.boundary.interior = Some(cloud);
    b.build()
}

/// Photons are blurred at the edges of the walls and in the cloud: 2 % are forgiven.
#[test]
fn photons_of_a_cloud_bring_what_paths_find() {
    let world = cloud_in_room(1.0);
    let paths = mean_radiances(&world, &volpath(None), 256, 1..9);
    let base = || PhotonMapperConfig { volume_photons: Some(20_000), ..photon_mapper(40_000) };
    let methods = [
        base(),
        PhotonMapperConfig { final_gather: FinalGather::Off, ..base() },
        PhotonMapperConfig { volume_kind: VolumeKind::Beams, volume_photons: Some(4_000), ..base() },
        PhotonMapperConfig {
            single_scatter: DirectSource::Map,
            volume_estimate: VolumeEstimate::March,
            ..base()
        },
    ];
    for (i, method) in methods.map(Method::PhotonMapper).into_iter().enumerate() {
        let photons = mean_radiances(&world, &method, 16, 1..9);
        let forgiven: MeanTest = forgiving(&paths, &photons, 0.02).into_iter().collect();
        let outcome = paths.iter().copied().collect::<MeanTest>().welch(&forgiven);
        assert!(outcome.passes(sidak(ALPHA, TESTS)), "{i}: {outcome}");
    }
}

/// What photons carry away in the mean is 4π ∫ε dV, and all of it is somewhere.
#[test]
fn the_books_balance() {
    let exact = 4.0 * PI * EMISSION * 4.0 / 3.0 * PI;
    let cloud = cloud_in_room(1.0);
    for (world, exact) in [(ball_above_floor(1.0), Some(exact)), (cloud, None)] {
        let (name, power) = world.lights().next().expect("a light");
        assert_eq!(name, "gas");
        // The trial points' own error.
        let (power, allowed) = (f64::from(power.g), 0.004);
        let exact = exact.unwrap_or(power);
        assert!((power / exact - 1.0).abs() < allowed, "{power}, not {exact}");
        let books: Vec<_> =
            (1..13).map(|seed| photons(&world, &WalkSettings::default(), 20_000, seed).ledger).collect();
        let test: MeanTest = books.iter().map(|book| book.per_path().lights[0].emitted[1]).collect();
        test.within(exact, allowed).assert_passes(sidak(ALPHA, TESTS));
        for book in &books {
            let book = &book.lights[0];
            assert!(book.imbalance().abs() < 1e-5 && book.roulette_z().abs() < 4.0, "{book:?}");
        }
    }
}

#[test]
fn no_light_comes_from_a_medium_that_gives_off_none_or_has_no_bounds() {
    assert_eq!(cloud_in_room(0.0).light_count(), 0);
    let everywhere = |shape: bool| {
        let mut b = Builder::seen_from(Vec3::ZERO, Vec3::Z, 34.0, 8);
        let gas = gas(&mut b, 1.0, 0.0, Coefficient::Constant(Rgb::WHITE));
        b.scene.camera.medium = Some(gas);
        b.point_light(Vec3::X, 1.0);
        let null = null(&mut b);
        let ball = b.sphere(Vec3::X, 0.5, null);
        if shape {
            ball.boundary.exterior = Some(gas);
        }
        b.build()
    };
    for world in [everywhere(true), everywhere(false)] {
        assert_eq!(world.light_count(), 1);
        let remarks: Vec<_> = world.remarks().iter().map(|remark| remark.message.as_str()).collect();
        assert_eq!(
            remarks,
            [
                "it gives off light, but no shapes that name it close it in: it is seen, and photons bring none of \
                 its light; name it as the interior of a closed shape"
            ]
        );
    }
}

/// Beside a lamp that is next event estimation's.
#[test]
fn the_same_bits_on_any_number_of_threads() {
    let picture = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| {
            let mut scene = cloud_in_room(1.0).scene().clone();
            let mut b = Builder::seen_from(Vec3::ZERO, Vec3::Z, 34.0, 8);
            b.light(LightKind::Point { position: Vec3::new(0.0, 1.5, 1.0), intensity: Rgb::WHITE });
            scene.lights = b.scene.lights;
            let world = World::new(scene).expect("a sound scene");
            let config = PhotonMapperConfig { volume_photons: Some(2_000), ..photon_mapper(2_000) };
            session(&world, Method::PhotonMapper(config), 4, 1).film().develop()
        })
    };
    assert_eq!(picture(1).pixels, picture(2).pixels);
}
