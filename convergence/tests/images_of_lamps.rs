//! Lamps and sky as the camera sees them in mirrors and glass, against path tracing, in scenes that show nothing else: what is
//! not specular is black. Photon mapping and vertex merging look for them by rays of their own, which follow reflection
//! and refraction both.
//!
//! Quarters of the picture and the whole share the level [`ALPHA`] by Šidák's formula, with all scenes, methods and depths.

use nephroid::color::Rgb;
use nephroid::film::Filter;
use nephroid::integrator::{Method, PhotonMapperConfig, VcmConfig};
use nephroid::light::LightKind;
use nephroid::math::{DVec3, Transform, Vec3};
use nephroid::medium::Phase;
use nephroid::shape::Geometry;
use nephroid::world::World;
use nephroid_convergence::{Builder, block_samples, grey_fog, iterated_renders, renders, volpath};
use nephroid_testkit::{ALPHA, MeanTest, sidak};

const SIDE: usize = 8;
const SEEDS: u64 = 8;

/// Scenes and depths, methods, and parts of a picture.
const TESTS: usize = 5 * 2 * 5;

/// A lamp seen in a ball of glass and a mirror behind it, and by way of both.
fn balls(sky: bool) -> Builder {
    let mut b = Builder::seen_from(Vec3::new(0.0, 0.4, 3.0), Vec3::new(0.0, 0.1, 0.0), 40.0, SIDE as u32);
    let (black, glass, mirror, glow) = (b.diffuse(0.0), b.glass(1.5), b.mirror(0.9), b.constant(40.0));
    b.sphere(Vec3::new(-0.4, 0.0, 0.3), 0.5, glass);
    b.sphere(Vec3::new(0.6, 0.1, -0.6), 0.6, mirror);
    b.sphere(Vec3::new(0.3, 1.4, 0.8), 0.2, black).emission = Some(glow);
    if sky {
        b.light(LightKind::Constant { radiance: Rgb::new(0.3, 0.4, 0.6) });
    }
    b
}

fn parts(pictures: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let mut parts = block_samples(pictures, SIDE, SIDE / 2);
    parts.extend(block_samples(pictures, SIDE, SIDE));
    parts
}

#[track_caller]
fn agrees(world: &World, max_depth: Option<u32>) {
    let mapper = PhotonMapperConfig { max_depth, ..PhotonMapperConfig::default() };
    let exact = parts(&renders(world, &volpath(max_depth), 512, 0..SEEDS));
    assert!(exact.iter().any(|part| part.iter().sum::<f64>() > 0.0), "nothing is seen");
    let few = PhotonMapperConfig { photons: 100, caustic_photons: 100, ..mapper.clone() };
    let ways = [
        Method::PhotonMapper(few),
        Method::Vcm(VcmConfig { mapper, light_paths: Some(100), ..VcmConfig::default() }),
    ];
    for method in ways {
        let found = parts(&iterated_renders(world, &method, 8, 64, 100..100 + SEEDS));
        for (found, exact) in found.iter().zip(&exact) {
            let [found, exact] = [found, exact].map(|part| part.iter().copied().collect::<MeanTest>());
            let outcome = found.welch(&exact);
            assert!(outcome.passes(sidak(ALPHA, TESTS)), "{} {max_depth:?}: {outcome}", method.name());
        }
    }
}

#[test]
fn in_glass_and_mirrors() {
    let world = balls(false).build();
    agrees(&world, None);
    agrees(&world, Some(4));
}

/// Two panes of glass that reflect a lamp around two corners: all that is seen is followed by chance.
#[test]
fn faintly_in_panes() {
    let mut b = Builder::seen_from(Vec3::new(0.0, 0.0, 3.0), Vec3::ZERO, 12.0, SIDE as u32);
    let (black, glass, glow) = (b.diffuse(0.0), b.glass(1.5), b.constant(1000.0));
    for x in [0.0, 2.0] {
        let pane = Transform::scale(DVec3::new(1.0, 1.0, 0.02)).then(Transform::rotate(DVec3::Y, 45.0));
        b.shape(Geometry::Cube, pane.then(Transform::translate(DVec3::new(x, 0.0, 0.0))), glass);
    }
    let lamp = Transform::scale(DVec3::splat(0.8)).then(Transform::translate(DVec3::new(2.0, 0.0, -3.0)));
    b.shape(Geometry::Rectangle, lamp, black).emission = Some(glow);
    agrees(&b.build(), None);
}

/// With a filter whose samples count less than nothing at the edges.
#[test]
fn under_a_sky() {
    let mut b = balls(true);
    b.scene.film.filter = Filter::Mitchell { b: 1.0 / 3.0, c: 1.0 / 3.0 };
    let world = b.build();
    agrees(&world, None);
}

/// A sky that is the same everywhere is so in each pixel, with few samples and whatever weights they have.
#[test]
fn an_even_sky_is_even() {
    let mut b = Builder::seen_from(Vec3::new(0.0, 0.0, 3.0), Vec3::ZERO, 40.0, SIDE as u32);
    let glass = b.glass(1.5);
    b.sphere(Vec3::ZERO, 0.3, glass);
    b.light(LightKind::Constant { radiance: Rgb::splat(1.0) });
    for filter in ["box", "tent", "gaussian", "mitchell"] {
        b.scene.film.filter = Filter::parse(filter).expect("a filter");
        let world = World::new(b.scene.clone()).expect("a sound scene");
        let method = Method::PhotonMapper(PhotonMapperConfig::default());
        for samples in [1, 4] {
            let picture = &renders(&world, &method, samples, 0..1)[0];
            for pixel in [0, SIDE - 1, SIDE * SIDE - 1] {
                let light = picture[pixel];
                assert!((light - 1.0).abs() < 1e-5, "{filter}, {samples} samples: {light}");
            }
        }
    }
}

/// A medium that swallows light and scatters none.
#[test]
fn in_smoke() {
    let mut b = balls(false);
    let smoke = b.medium(grey_fog(0.3, 0.0, Phase::Isotropic));
    b.fill(smoke);
    let world = b.build();
    agrees(&world, None);
}
