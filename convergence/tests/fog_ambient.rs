//! Ambient fog, the report's first method: L_i σ_s/σ_t (1 − e^(−σ_t d)) is added along what the camera sees, and light
//! is attenuated on every way. And media that shine themselves.
//!
//! Most has a closed form and no noise, so that bounds are on rounding alone. The others share the level [`ALPHA`] by
//! Šidák's formula: on seeds chosen afresh, correct code would fail with probability 1 %.

use nephroid::color::Rgb;
use nephroid::integrator::{FinalGather, Method, PhotonMapperConfig};
use nephroid::light::LightKind;
use nephroid::math::{DVec3, Transform, Vec3};
use nephroid::medium::{Coefficient, GridValues, Medium, Phase};
use nephroid::shape::Geometry;
use nephroid::texture::Image;
use nephroid::transport::{Fog, WalkSettings};
use nephroid::world::World;
use nephroid_convergence::{Builder, channel_means, expect_fair_books, photons, render, volpath};
use nephroid_testkit::{ALPHA, MeanTest, Tolerance, integrate, sidak};

/// More than the statistical tests of this file.
const TESTS: usize = 30;

const SIGMA_T: [f32; 3] = [0.25, 0.5, 1.5];
const ALBEDO: [f32; 3] = [0.9, 0.5, 0.2];
/// L_i, the radiance that ambient fog scatters.
const AMBIENT: [f32; 3] = [1.0, 2.0, 0.5];

fn ambient_fog() -> Medium {
    let (sigma_t, albedo) = (Rgb::from(SIGMA_T), Rgb::from(ALBEDO));
    Medium { ambient: Rgb::from(AMBIENT), ..Medium::homogeneous("fog", sigma_t, albedo, Phase::Isotropic) }
}

fn ambient_method() -> Method {
    Method::PhotonMapper(PhotonMapperConfig {
        fog: Fog::Ambient,
        emit: Some(100),
        final_gather: FinalGather::Off,
        ..PhotonMapperConfig::default()
    })
}

/// What is left of light after a way, and what ambient fog adds to the ray that comes along it.
fn fogged(channel: usize, distance: f64) -> (f64, f64) {
    let stopped = -libm::expm1(-f64::from(SIGMA_T[channel]) * distance);
    (1.0 - stopped, f64::from(AMBIENT[channel]) * f64::from(ALBEDO[channel]) * stopped)
}

/// A lamp that fills the picture, facing along +z or, turned, along −z.
fn lamp(b: &mut Builder, z: f64, turned: bool, radiance: Rgb) {
    let (black, glow) = (b.diffuse(0.0), b.scene.textures.constant(radiance));
    let turn = Transform::rotate(DVec3::X, if turned { 180.0 } else { 0.0 });
    let place = turn.then(Transform::translate(DVec3::new(0.0, 0.0, z)));
    b.shape(Geometry::Rectangle, place, black).emission = Some(glow);
}

fn looking_down(z: f32) -> Builder {
    Builder::parallel_view(Vec3::new(0.0, 0.0, z), Vec3::ZERO, 0.005, 4, 4)
}

#[track_caller]
fn expect_every_pixel(image: &Image, expected: impl Fn(usize) -> f64, bound: f64) {
    for pixel in &image.pixels {
        for (channel, value) in pixel.to_array().into_iter().enumerate() {
            let (value, expected) = (f64::from(value), expected(channel));
            assert!(
                (value - expected).abs() <= bound * expected,
                "channel {channel}: {value}, not {expected}"
            );
        }
    }
}

/// Where L_i σ_s/σ_t is what everything around gives off, fog changes nothing: the picture is constant, near walls
/// and far ones, in a room and without one.
#[test]
fn ambient_fog_as_bright_as_what_is_behind_it_is_not_seen() {
    let radiance = Rgb::from(AMBIENT) * Rgb::from(ALBEDO);
    let view = || Builder::seen_from(Vec3::new(0.2, 0.1, 0.5), Vec3::new(1.0, 0.3, 0.0), 90.0, 8);
    let mut walls = view();
    let (black, glow) = (walls.diffuse(0.0), walls.scene.textures.constant(radiance));
    let shape = walls.shape(Geometry::Cube, Transform::scale(DVec3::new(1.0, 2.0, 3.0)), black);
    (shape.emission, shape.flip_normals) = (Some(glow), true);
    let mut open = view();
    open.light(LightKind::Constant { radiance });
    for mut b in [walls, open] {
        let medium = b.medium(ambient_fog());
        b.fill(medium);
        let image = render(&b.build(), ambient_method(), 1, 1);
        expect_every_pixel(&image, |c| f64::from(radiance[c]), 1e-6);
    }
}

/// A lamp E seen over a distance d: E e^(−σ_t d) + L_i σ_s/σ_t (1 − e^(−σ_t d)).
#[test]
fn a_lamp_fades_into_ambient_fog() {
    let radiance = Rgb::new(3.0, 1.0, 7.0);
    for distance in [0.01, 0.5, 2.0, 10.0] {
        let mut b = looking_down(distance);
        lamp(&mut b, 0.0, false, radiance);
        let medium = b.medium(ambient_fog());
        b.fill(medium);
        let image = render(&b.build(), ambient_method(), 1, 1);
        let expected = |c| {
            let (left, added) = fogged(c, f64::from(distance));
            f64::from(radiance[c]) * left + added
        };
        expect_every_pixel(&image, expected, 2e-6);
    }
}

/// In a mirror of reflectance r the distances add up: the lamp is 3 behind the mirror, which is 1 away.
#[test]
fn distances_by_way_of_a_mirror_add_up() {
    let (radiance, reflectance) = (Rgb::new(3.0, 1.0, 7.0), 0.8);
    let mut b = looking_down(1.0);
    let mirror = b.mirror(reflectance);
    b.shape(Geometry::Rectangle, Transform::IDENTITY, mirror);
    lamp(&mut b, 3.0, true, radiance);
    let medium = b.medium(ambient_fog());
    b.fill(medium);
    // Roulette at the mirror makes noise.
    let means = channel_means(&b.build(), &ambient_method(), 64, 0..20);
    for c in 0..3 {
        let ((near, before), (far, behind)) = (fogged(c, 1.0), fogged(c, 3.0));
        let exact = before + near * f64::from(reflectance) * (f64::from(radiance[c]) * far + behind);
        let test: MeanTest = means.iter().map(|mean| mean[c]).collect();
        test.within(exact, 2e-6).assert_passes(sidak(ALPHA, TESTS));
    }
}

/// A point light straight above a matt floor, ρ I/(π h²), on which the picture shows a hundredth of the height: the
/// falloff to its edge is below 10⁻⁴. Its light is attenuated on the way to the floor and to the camera, both where the
/// fog has no bounds and where it is a layer between them.
#[test]
fn light_is_attenuated_on_its_way_to_a_floor() {
    let (albedo, height) = (0.5, 2.0f32);
    for layer in [false, true] {
        let mut b = looking_down(3.0);
        let matt = b.diffuse(albedo);
        b.shape(Geometry::Rectangle, Transform::IDENTITY, matt);
        b.point_light(Vec3::new(0.0, 0.0, height), 1.0);
        let medium = b.medium(ambient_fog());
        if layer {
            b.box_of(DVec3::new(-3.0, -3.0, 0.5), DVec3::new(3.0, 3.0, 1.25), medium);
        } else {
            b.fill(medium);
        }
        let image = render(&b.build(), ambient_method(), 1, 1);
        let ways = if layer { [0.75, 0.75] } else { [f64::from(height), 3.0] };
        let lit = f64::from(albedo) / (std::f64::consts::PI * f64::from(height * height));
        let expected = |c| {
            let ((there, _), (back, added)) = (fogged(c, ways[0]), fogged(c, ways[1]));
            lit * there * back + added
        };
        expect_every_pixel(&image, expected, 1e-4);
    }
}

/// Photons lose as much on the way, and the books have it as absorbed by media: from the middle of a ball with a
/// wall of albedo 0, all of the rest is on the wall.
#[test]
fn photons_lose_in_ambient_fog_what_the_books_say() {
    let mut b = Builder::seen_from(Vec3::new(0.0, 0.0, 0.5), Vec3::ZERO, 40.0, 1);
    // Photons are not stored where nothing is reflected.
    let matt = b.diffuse(0.5);
    b.sphere(Vec3::ZERO, 1.5, matt).flip_normals = true;
    b.point_light(Vec3::ZERO, 1.0);
    let medium = b.medium(ambient_fog());
    b.fill(medium);
    let world = b.build();
    let settings = WalkSettings { fog: Fog::Ambient, max_photon_depth: Some(1), ..WalkSettings::default() };
    let pass = photons(&world, &settings, 1000, 1);
    expect_fair_books(&world, &pass.ledger);
    let book = pass.ledger.lights[0];
    for c in 0..3 {
        let left = fogged(c, 1.5).0;
        let landed: f64 = pass.global.as_slice().iter().map(|p| f64::from(p.power[c])).sum();
        assert!((landed / book.emitted[c] - left).abs() < 1e-6 + 2e-5 * left, "{landed} of {book:?}");
        assert!((book.absorbed_by_media[c] / book.emitted[c] + left - 1.0).abs() < 1e-5, "{book:?}");
    }
}

/// A slab between z = 0 and 1, seen from above by parallel rays, on a black floor.
fn slab(medium: impl FnOnce(&mut Builder, DVec3, DVec3) -> Medium) -> World {
    let mut b = looking_down(1.5);
    let black = b.diffuse(0.0);
    let floor = Transform::translate(DVec3::new(0.0, 0.0, -0.5));
    b.shape(Geometry::Rectangle, floor, black);
    let (low, high) = (DVec3::new(-1.0, -1.0, 0.0), DVec3::ONE);
    let medium = medium(&mut b, low, high);
    let medium = b.medium(medium);
    b.box_of(low, high, medium);
    b.build()
}

fn methods() -> [Method; 2] {
    [volpath(None), Method::PhotonMapper(PhotonMapperConfig::default())]
}

/// A medium that gives off ε along a way d: ε (1 − e^(−σ_t d))/σ_t, and ε d where nothing is taken.
#[test]
fn a_shining_medium_is_as_bright_as_its_depth() {
    let (sigma_t, emission) = ([0.0f32, 0.5, 4.0], [1.0f32, 2.0, 3.0]);
    let world = slab(|_, _, _| Medium {
        emission: Coefficient::Constant(Rgb::from(emission)),
        ..Medium::homogeneous("glow", Rgb::from(sigma_t), Rgb::BLACK, Phase::Isotropic)
    });
    for method in methods() {
        let image = render(&world, method, 4, 1);
        let expected = |c: usize| {
            let sigma = f64::from(sigma_t[c]);
            f64::from(emission[c]) * if sigma > 0.0 { -libm::expm1(-sigma) / sigma } else { 1.0 }
        };
        expect_every_pixel(&image, expected, 2e-6);
    }
}

/// The same with the emission on a grid of two cells, from 0 below to 4 above: it rises between their middles. The
/// extinction is the same everywhere, said as a number and as a grid.
#[test]
fn a_medium_may_shine_by_a_grid() {
    const SIGMA: f32 = 1.5;
    let shine = |z: f64| 4.0 * ((z - 0.25) * 2.0).clamp(0.0, 1.0);
    let along = |t: f64| shine(1.0 - t) * libm::exp(-f64::from(SIGMA) * t);
    let exact = integrate(along, &[0.0, 0.25, 0.75, 1.0], Tolerance::relative(1e-9)).value;
    for gridded in [false, true] {
        let world = slab(|b, low, high| {
            let emission = b.grid(low, high, [1, 1, 2], GridValues::Grey(vec![0.0, 4.0]));
            let even = b.grid(low, high, [1; 3], GridValues::Grey(vec![SIGMA]));
            let sigma_t = if gridded { even } else { Coefficient::Constant(Rgb::splat(SIGMA)) };
            let black = Medium::homogeneous("glow", Rgb::BLACK, Rgb::BLACK, Phase::Isotropic);
            Medium { sigma_t, emission, ..black }
        });
        for method in methods() {
            let means = channel_means(&world, &method, 64, 0..20);
            let test: MeanTest = means.iter().map(|mean| mean[0]).collect();
            test.within(exact, 1e-6).assert_passes(sidak(ALPHA, TESTS));
        }
    }
}

/// An extinction ends with its grid, which fills the upper half of a slab, and emission does not: 1 for each length gives
/// (1 − e^(−σ/2))/σ from above, and e^(−σ/2)/2 from below.
#[test]
fn a_medium_shines_beyond_the_grid_of_its_extinction() {
    const SIGMA: f32 = 1.5;
    let half = 0.5 * f64::from(SIGMA);
    let exact = -libm::expm1(-half) / f64::from(SIGMA) + 0.5 * libm::exp(-half);
    let world = slab(|b, low, high| Medium {
        sigma_t: b.grid(low.with_z(0.5), high, [1; 3], GridValues::Grey(vec![SIGMA])),
        emission: Coefficient::Constant(Rgb::WHITE),
        ..Medium::homogeneous("glow", Rgb::BLACK, Rgb::BLACK, Phase::Isotropic)
    });
    for method in methods() {
        let means = channel_means(&world, &method, 64, 0..20);
        let test: MeanTest = means.iter().map(|mean| mean[0]).collect();
        test.within(exact, 1e-6).assert_passes(sidak(ALPHA, TESTS));
    }
}
