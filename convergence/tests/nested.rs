//! Overlapping dielectrics: the camera, paths and photons agree on what is there.
//!
//! The tests of the file share the level [`ALPHA`] by Šidák's formula; roulette's column is held to 4 standard
//! errors, which correct code exceeds once in 16 000 books. Seeds are fixed.

use nephroid::color::Rgb;
use nephroid::light::LightKind;
use nephroid::math::{DVec3, Transform, Vec3};
use nephroid::shape::Geometry;
use nephroid::transport::WalkSettings;
use nephroid::world::World;
use nephroid_convergence::{
    Builder, Contestant, every_method_but, forgiving, mean_radiances, path, photon_mapper, photons,
};
use nephroid_testkit::{ALPHA, MeanTest, sidak};

/// More than the methods whose photons bring to the floor what paths do.
const TESTS: usize = 4;

/// Glass from 0 to 1 and water from 0.9 to 2, seen from above.
fn glass_of_water(priorities: [u32; 2], mut rest: impl FnMut(&mut Builder)) -> World {
    let mut b = Builder::seen_from(Vec3::new(0.3, 5.0, 0.2), Vec3::new(0.0, 0.0, 0.0), 12.0, 8);
    for ((ior, from, to), priority) in [(1.5, 0.0, 1.0), (1.33, 0.9, 2.0)].into_iter().zip(priorities) {
        let material = b.glass(ior);
        let to_world = Transform::scale(DVec3::new(3.0, 0.5 * (to - from), 3.0))
            .then(Transform::translate(DVec3::new(0.0, 0.5 * (from + to), 0.0)));
        b.shape(Geometry::Cube, to_world, material).boundary.priority = Some(priority);
    }
    rest(&mut b);
    b.build()
}

/// What loses nothing cannot be seen in a sky that is the same everywhere.
#[test]
fn overlapping_glass_vanishes_in_a_uniform_sky() {
    for priorities in [[1, 0], [0, 1]] {
        let world = glass_of_water(priorities, |b| b.light(LightKind::Constant { radiance: Rgb::WHITE }));
        for Contestant { method, .. } in every_method_but(&["volpath", "ppm"], &photon_mapper(1000)) {
            for mean in mean_radiances(&world, &method, 4, 1..3) {
                // Roulette alone makes noise, and only where light is caught for long.
                assert!((mean - 1.0).abs() < 0.02, "{priorities:?}, {method:?}: {mean}");
            }
        }
    }
}

/// A floor under both, lit by a lamp above.
fn lit_floor() -> World {
    glass_of_water([1, 0], |b| {
        let (white, black, radiance) = (b.diffuse(0.5), b.diffuse(0.0), b.constant(5.0));
        let down = Transform::rotate(DVec3::X, 90.0);
        let floor = Transform::scale(DVec3::splat(3.0)).then(Transform::rotate(DVec3::X, -90.0));
        b.shape(Geometry::Rectangle, floor.then(Transform::translate(DVec3::new(0.0, -0.5, 0.0))), white);
        let lamp = down.then(Transform::translate(DVec3::new(0.0, 6.0, 0.0)));
        b.shape(Geometry::Rectangle, lamp, black).emission = Some(radiance);
    })
}

/// The caustic map is blurred, and the light through the slabs is smooth: 2 % are forgiven.
#[test]
fn paths_and_photons_bring_the_same_light() {
    let world = lit_floor();
    let paths = mean_radiances(&world, &path(), 64, 1..7);
    for Contestant { method, .. } in
        every_method_but(&["path", "volpath", "ptracer", "ppm"], &photon_mapper(10_000))
    {
        let photons = mean_radiances(&world, &method, 4, 1..7);
        let forgiven: MeanTest = forgiving(&paths, &photons, 0.02).into_iter().collect();
        let outcome = paths.iter().copied().collect::<MeanTest>().welch(&forgiven);
        assert!(outcome.passes(sidak(ALPHA, TESTS)), "{}: {outcome}", method.name());
    }
    let mean = paths.iter().sum::<f64>() / 6.0;
    assert!(mean > 0.05, "it is lit: {mean}");
}

#[test]
fn the_books_balance() {
    let world = lit_floor();
    let book = &photons(&world, &WalkSettings::default(), 20_000, 1).ledger.lights[0];
    assert!(book.imbalance().abs() < 1e-5 && book.roulette_z().abs() < 4.0, "{book:?}");
}
