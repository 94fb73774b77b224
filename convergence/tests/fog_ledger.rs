//! The books of photons in participating media: what a purely absorbing medium takes by the law of Beer and Lambert, and
//! that all that is emitted in a closed room is absorbed, by whatever medium and phase function.
//!
//! The tests of the file share the level [`ALPHA`] by Šidák's formula; roulette's column is held to 4 standard errors.
//! On seeds chosen afresh, correct code would fail somewhere in this file with probability 1 %, and by roulette's column
//! with 3 %.

use nephroid::color::Rgb;
use nephroid::light::LightKind;
use nephroid::math::{DVec3, Transform, Vec3};
use nephroid::medium::{Coefficient, GridValues, Medium, Phase};
use nephroid::shape::Geometry;
use nephroid::transport::{Balance, Fog, WalkSettings};
use nephroid::world::World;
use nephroid_convergence::{Builder, expect_fair_books, grey_fog, photons};
use nephroid_testkit::{ALPHA, MeanTest, Outcome, binomial_test, sidak};

/// More than the statistical tests of this file.
const TESTS: usize = 60;

#[track_caller]
fn judge(name: &str, outcome: &Outcome) {
    assert!(outcome.passes(sidak(ALPHA, TESTS)), "{name}: {outcome}");
}

fn camera() -> Builder {
    Builder::seen_from(Vec3::new(0.0, 0.0, 0.4), Vec3::ZERO, 40.0, 1)
}

/// A point light in the middle of a ball of radius 1: all light goes a way of 1 through it.
fn ball(medium: Medium) -> World {
    let mut b = camera();
    let medium = b.medium(medium);
    b.filled(Geometry::Sphere { center: Vec3::ZERO, radius: 1.0 }, Transform::IDENTITY, medium);
    b.point_light(Vec3::ZERO, 1.0);
    b.build()
}

/// A narrow beam, straight through a slab of thickness 1; the cosine of its edge is 1 to 2·10⁻⁶.
fn slab(medium: Medium) -> World {
    let mut b = camera();
    let medium = b.medium(medium);
    b.box_of(DVec3::new(-1.0, -1.0, -1.0), DVec3::new(1.0, 1.0, 0.0), medium);
    let to_world = Transform::look_at(DVec3::Z, DVec3::ZERO, DVec3::Y).expect("a direction");
    let (intensity, cutoff_deg, beam_width_deg) = (Rgb::splat(1e5), 0.1, 0.1);
    b.light(LightKind::Spot { to_world, intensity, cutoff_deg, beam_width_deg, texture: None });
    b.build()
}

/// The light's books for the paths of a pass, which are fair.
fn book(world: &World, settings: &WalkSettings, paths: u64, seed: u64) -> Balance {
    let ledger = photons(world, settings, paths, seed).ledger;
    expect_fair_books(world, &ledger);
    ledger.lights[0]
}

/// A share 1 − e^(−τ) is absorbed, .632121 for τ = 1. With a second random number against e^(−τ) after
/// the distance was sampled it would be half of that, or .1998 if both must agree. In grey media each path
/// is absorbed or not, so that the share is binomial.
#[test]
fn an_absorbing_medium_takes_what_beer_and_lambert_say() {
    const PATHS: u64 = 20_000;
    for (name, build) in [("ball", ball as fn(Medium) -> World), ("slab", slab)] {
        for tau in [0.1f32, 1.0, 4.0] {
            let world = build(grey_fog(tau, 0.0, Phase::Isotropic));
            let book = book(&world, &WalkSettings::default(), PATHS, 1);
            let share = book.absorbed_by_media[0] / book.emitted[0];
            let count = (share * PATHS as f64).round();
            assert!((share * PATHS as f64 - count).abs() < 0.01, "{name}: paths of equal power");
            judge(name, &binomial_test(count as u64, PATHS, -libm::expm1(-f64::from(tau))));
            let (out, into) = (book.escaped[0] / book.emitted[0], book.absorbed[0]);
            assert!((out + share - 1.0).abs() < 1e-6 && into == 0.0, "{name}: {book:?}");
        }
    }
}

/// The same with extinctions that differ between channels, each of which must have its own mean although they share
/// the sampled distance.
#[test]
fn every_channel_has_its_own_extinction() {
    let tau = Rgb::new(0.5, 1.0, 2.0);
    for (name, build) in [("ball", ball as fn(Medium) -> World), ("slab", slab)] {
        let world = build(Medium::homogeneous("fog", tau, Rgb::BLACK, Phase::Isotropic));
        let mut shares = [MeanTest::new(); 3];
        for seed in 0..30 {
            let book = book(&world, &WalkSettings::default(), 1000, seed);
            for (channel, share) in shares.iter_mut().enumerate() {
                share.push(book.absorbed_by_media[channel] / book.emitted[channel]);
            }
        }
        for (share, tau) in shares.iter().zip(tau.to_array()) {
            judge(name, &share.against(-libm::expm1(-f64::from(tau))));
        }
    }
}

/// Ambient fog takes from photons without noise, and the books say so.
#[test]
fn ambient_fog_books_what_it_takes() {
    let tau = Rgb::new(0.5, 1.0, 2.0);
    let settings = WalkSettings { fog: Fog::Ambient, ..WalkSettings::default() };
    for (name, build) in [("ball", ball as fn(Medium) -> World), ("slab", slab)] {
        // Ambient fog attenuates by all of its extinction, whatever its albedo.
        let world = build(Medium::homogeneous("fog", tau, Rgb::splat(0.7), Phase::Isotropic));
        let book = book(&world, &settings, 1000, 1);
        for (channel, tau) in tau.to_array().into_iter().enumerate() {
            let share = book.absorbed_by_media[channel] / book.emitted[channel];
            assert!((share + libm::expm1(-f64::from(tau))).abs() < 5e-6, "{name}: {share} for {tau}");
        }
    }
}

/// A room of side 2 that a medium fills, with walls of an albedo, a glass ball that keeps the medium out, and a light.
fn room(wall: f32, medium: impl FnOnce(&mut Builder) -> Medium) -> World {
    let mut b = camera();
    let (wall, glass) = (b.diffuse(wall), b.glass(1.5));
    let medium = medium(&mut b);
    let medium = b.medium(medium);
    let walls = b.shape(Geometry::Cube, Transform::IDENTITY, wall);
    walls.flip_normals = true;
    walls.boundary.exterior = Some(medium);
    b.sphere(Vec3::new(-0.4, -0.5, -0.3), 0.3, glass).boundary.exterior = Some(medium);
    b.point_light(Vec3::new(0.2, 0.3, 0.5), 1.0);
    b.build()
}

/// Values between 0 and about 3 that are no pattern.
fn uneven(b: &mut Builder) -> Coefficient {
    let values = (0..64u16).map(|i| f32::from((i * 29) % 13) * 0.25).collect();
    b.grid(-DVec3::ONE, DVec3::ONE, [4; 3], GridValues::Grey(values))
}

/// In a closed room, all that is emitted is absorbed, by walls and by the medium, in every channel; nothing
/// escapes or is cut off.
#[test]
fn closed_rooms_absorb_all_that_is_emitted() {
    // Beyond the 64th bounce survivors gain a twentieth each time: between white walls their variance has no bound
    // where the medium's albedo is above √.95.
    const FORWARD: Phase = Phase::HenyeyGreenstein { g: 0.8 };
    let colours = || Medium::homogeneous("fog", Rgb::new(0.3, 1.0, 3.0), Rgb::new(0.9, 0.5, 0.95), FORWARD);
    type Build = Box<dyn Fn(&mut Builder) -> Medium>;
    let fog = |phase| -> Build { Box::new(move |_| grey_fog(1.5, 0.8, phase)) };
    let rooms: [(&str, f32, Build); 9] = [
        ("isotropic, white walls", 1.0, fog(Phase::Isotropic)),
        ("isotropic", 0.5, fog(Phase::Isotropic)),
        ("forward", 0.5, fog(FORWARD)),
        ("backward, white walls", 1.0, fog(Phase::HenyeyGreenstein { g: -0.8 })),
        ("Rayleigh", 0.5, fog(Phase::Rayleigh)),
        ("channels that differ", 0.5, Box::new(move |_| colours())),
        ("channels that differ, white walls", 1.0, Box::new(move |_| colours())),
        ("a medium that takes nothing", 0.5, Box::new(|_| grey_fog(1.0, 1.0, Phase::Isotropic))),
        (
            "a gridded cloud",
            0.5,
            Box::new(|b| {
                let sigma_t = uneven(b);
                Medium { sigma_t, ..grey_fog(1.0, 0.7, Phase::Isotropic) }
            }),
        ),
    ];
    for (name, wall, medium) in rooms {
        let world = room(wall, medium);
        let mut shares = [MeanTest::new(); 3];
        for seed in 0..16 {
            let book = book(&world, &WalkSettings::default(), 1000, seed);
            assert_eq!((book.escaped, book.ended), ([0.0; 3], [0.0; 3]), "{name}: {book:?}");
            for (channel, share) in shares.iter_mut().enumerate() {
                let absorbed = book.absorbed[channel] + book.absorbed_by_media[channel];
                share.push(absorbed / book.emitted[channel]);
            }
        }
        // Where walls take nothing and the medium does, roulette alone tells: the mean is still 1.
        for share in shares {
            judge(name, &share.within(1.0, 1e-6));
        }
    }
}

/// A limit of depth cuts off what the next collision would have scattered, and the books say so.
#[test]
fn books_balance_where_depth_is_limited() {
    for max in [1, 2, 5] {
        let world = room(0.5, |_| grey_fog(2.0, 0.9, Phase::Rayleigh));
        let settings = WalkSettings { max_photon_depth: Some(max), ..WalkSettings::default() };
        let book = book(&world, &settings, 20_000, 3);
        assert!(book.ended[0] > 0.0, "{book:?}");
    }
}
