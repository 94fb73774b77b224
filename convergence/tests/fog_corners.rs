//! Media where they are hard: colours that differ a hundredfold, many borders, and lamps far from any.
//!
//! The statistical tests share [`ALPHA`] by Šidák's formula.

use nephroid::color::Rgb;
use nephroid::integrator::{FinalGather, Method, PhotonMapperConfig, Show};
use nephroid::material::Material;
use nephroid::math::{DVec3, Transform, Vec3};
use nephroid::medium::{Medium, Phase};
use nephroid::scene::SceneErrors;
use nephroid::shape::Geometry;
use nephroid::world::{Surroundings, World};
use nephroid_convergence::{Builder, boxed, channel_means, facing, grey_fog, means, volpath};
use nephroid_testkit::{ALPHA, MeanTest, sidak};

const TESTS: usize = 6;

/// Sunlight from above, seen along a slab 200 long from half a unit below its top: α E e^(−σ/2) (1 − e^(−200 σ)) / 4π in
/// each channel. Where distances follow the mean of the channels, thin ones lose half of it.
#[test]
fn a_thin_channel_is_seen_far_beyond_the_end_of_a_thick_one() {
    let sigma_t = [2.0f32, 0.05, 0.02];
    let mut b = Builder::parallel_view(Vec3::new(0.0, 0.0, -1.0), Vec3::ZERO, 1e-3, 4, 4);
    let fog = Medium::homogeneous("fog", Rgb::from(sigma_t), Rgb::splat(0.9), Phase::Isotropic);
    let medium = b.medium(fog);
    b.box_of(DVec3::new(-1.0, -1.0, 0.0), DVec3::new(1.0, 0.5, 200.0), medium);
    b.sunlight(Vec3::NEG_Y, 5.0);
    let world = b.build();
    let mapper = PhotonMapperConfig { max_depth: Some(2), ..PhotonMapperConfig::default() };
    for method in [Method::PhotonMapper(mapper), volpath(Some(2))] {
        let found = channel_means(&world, &method, 256, 0..20);
        for channel in 0..3 {
            let sigma = f64::from(sigma_t[channel]);
            let stopped = libm::exp(-0.5 * sigma) * -libm::expm1(-200.0 * sigma);
            let exact = 0.9 * 5.0 * stopped / (4.0 * std::f64::consts::PI);
            let test: MeanTest = found.iter().map(|mean| mean[channel]).collect();
            test.within(exact, 1e-3).assert_passes(sidak(ALPHA, TESTS));
        }
    }
}

/// A floor under a lamp, far from the origin, with borders between them around nothing at all.
fn floor_under_a_lamp(borders: u32) -> World {
    let middle = DVec3::splat(1000.0);
    let eye = middle.as_vec3();
    let mut b = Builder::seen_from(eye + Vec3::new(0.0, 2.0, 6.0), eye, 30.0, 12);
    let grey = b.diffuse(0.5);
    b.shape(Geometry::Rectangle, facing(middle, 3.0, DVec3::X, -90.0), grey);
    let (black, glow) = (b.diffuse(0.0), b.constant(4.0));
    let above = facing(middle + DVec3::new(0.0, 3.0, 0.0), 0.3, DVec3::X, 90.0);
    b.shape(Geometry::Rectangle, above, black).emission = Some(glow);
    let nothing = b.medium(grey_fog(0.0, 0.0, Phase::Isotropic));
    for i in 0..borders {
        let half = DVec3::new(1.5, 0.6 + 0.2 * f64::from(i), 1.5);
        b.filled(Geometry::Cube, boxed(middle + DVec3::new(0.0, 1.5, 0.0), half), nothing);
    }
    b.build()
}

/// The same rays with the same numbers: nothing but rounding differs, unless shadow rays come to lie behind the lamp.
#[test]
fn borders_around_nothing_change_nothing() {
    let direct = PhotonMapperConfig {
        show: Show::Direct,
        final_gather: FinalGather::Off,
        ..PhotonMapperConfig::default()
    };
    let mean =
        |borders| means(&floor_under_a_lamp(borders), &Method::PhotonMapper(direct.clone()), 64, 0..1)[0];
    let ratio = mean(3) / mean(0);
    assert!((ratio - 1.0).abs() < 2e-3, "{ratio}");
}

/// A small ball of smoke far away is all that names media, and no ray from the lamp meets it.
#[test]
fn a_lamp_that_sees_no_border_stands_in_the_fog_of_the_camera() {
    let mut b = Builder::seen_from(Vec3::new(0.0, 0.0, 5.0), Vec3::ZERO, 30.0, 4);
    let (fog, smoke) =
        (b.medium(grey_fog(0.1, 0.5, Phase::Isotropic)), b.medium(grey_fog(1.0, 0.5, Phase::Isotropic)));
    let away = Transform::translate(DVec3::splat(500.0));
    let ball = Geometry::Sphere { center: Vec3::ZERO, radius: 0.05 };
    b.filled(ball, away, smoke).boundary.exterior = Some(fog);
    b.scene.camera.medium = Some(fog);
    b.point_light(Vec3::Y, 1.0);
    assert_eq!(b.build().light_surroundings(0), Surroundings::of(Some(fog)));
}

/// Light would come in through the surface and go out through a hole without being told.
#[test]
fn a_masked_border_is_refused() {
    let mut b = Builder::seen_from(Vec3::new(0.0, 0.0, 5.0), Vec3::ZERO, 30.0, 4);
    let (inside, half) = (b.scene.materials.push(Material::Null), b.constant(0.5));
    let masked = b.scene.materials.push(Material::Mask { inside, opacity: half });
    let smoke = b.medium(grey_fog(1.0, 0.5, Phase::Isotropic));
    b.sphere(Vec3::ZERO, 1.0, masked).boundary.interior = Some(smoke);
    let SceneErrors(problems) = World::new(b.scene).expect_err("it has holes");
    assert!(problems[0].message.contains("a masked surface bounds no medium"), "{problems:?}");
}
