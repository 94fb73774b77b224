//! Masks: surfaces that a ray meets with a probability, for every method, against closed forms.
//!
//! All tests together reject a correct program with a probability of [`ALPHA`]; seeds are fixed.

use std::f64::consts::PI;

use nephroid::color::Rgb;
use nephroid::handle::Handle;
use nephroid::integrator::{Method, Show};
use nephroid::light::LightKind;
use nephroid::material::Material;
use nephroid::math::{DVec3, Transform, Vec3};
use nephroid::shape::Geometry;
use nephroid::world::World;
use nephroid_convergence::{Builder, Contestant, every_method_but, map_view, mean_radiances, photon_mapper};
use nephroid_testkit::{ALPHA, MeanTest, sidak};

/// More than the methods for three scenes.
const TESTS: usize = 20;

fn mask(b: &mut Builder, opacity: f32, inside: Handle<Material>) -> Handle<Material> {
    let opacity = b.constant(opacity);
    b.scene.materials.push(Material::Mask { opacity, inside })
}

/// A square of half-side `half` at height `y`, facing up.
fn square(b: &mut Builder, y: f64, half: f64, material: Handle<Material>) {
    let to_world = Transform::scale(DVec3::splat(half))
        .then(Transform::rotate(DVec3::X, -90.0))
        .then(Transform::translate(DVec3::new(0.0, y, 0.0)));
    b.shape(Geometry::Rectangle, to_world, material);
}

fn methods() -> Vec<(&'static str, Method)> {
    let methods = every_method_but(&["volpath", "ppm"], &photon_mapper(2000)).into_iter();
    let map = ("map on the spot", Method::PhotonMapper(map_view(Show::Direct, 20_000)));
    methods.map(|contestant| (contestant.method.name(), contestant.method)).chain([map]).collect()
}

/// Every method sees the same mean, to `bias`, relative.
fn judge(name: &str, world: &World, method: &Method, exact: f64, bias: f64) {
    let mut test = MeanTest::new();
    mean_radiances(world, method, 8, 0..24).into_iter().for_each(|v| test.push(v));
    let outcome = test.within(exact, bias);
    assert!(outcome.passes(sidak(ALPHA, TESTS)), "{name}: {outcome}");
}

/// Light falls straight through three black veils onto a floor that is looked at from below them: shadow
/// rays and photons lose the same.
#[test]
fn veils_let_shadow_rays_and_photons_through() {
    let mut b = Builder::parallel_view(Vec3::Y * 0.5, Vec3::ZERO, 0.3, 12, 12);
    let (white, black) = (b.diffuse(0.8), b.diffuse(0.0));
    square(&mut b, 0.0, 1.0, white);
    let veil = mask(&mut b, 0.4, black);
    for y in [1.0, 2.0, 3.0] {
        square(&mut b, y, 1.2, veil);
    }
    b.light(LightKind::Directional { direction: Vec3::NEG_Y, irradiance: Rgb::WHITE });
    let world = b.build();
    for (name, method) in methods() {
        judge(name, &world, &method, 0.8 / PI * 0.6f64.powi(3), 0.0);
    }
}

/// What is there with probability o shows o times its radiance over the black behind it, although only
/// o of the photons land on it.
#[test]
fn a_veil_shows_its_opacity_of_itself() {
    let mut b = Builder::parallel_view(Vec3::Y * 0.5, Vec3::ZERO, 0.3, 12, 12);
    let white = b.diffuse(0.8);
    let veil = mask(&mut b, 0.3, white);
    square(&mut b, 0.0, 1.0, veil);
    b.light(LightKind::Directional { direction: Vec3::NEG_Y, irradiance: Rgb::WHITE });
    let world = b.build();
    for (name, method) in methods() {
        judge(name, &world, &method, 0.3 * 0.8 / PI, 0.0);
    }
}

/// White veils in a white sky cannot be seen, however often light goes to and fro between them. Photons
/// near an edge are fewer than a disk there asks for, so the map may miss a hundredth.
#[test]
fn white_veils_vanish_in_a_white_sky() {
    let mut b = Builder::parallel_view(Vec3::Y * 2.0, Vec3::ZERO, 0.4, 12, 12);
    let white = b.diffuse(1.0);
    let paper = b.two_sided(white);
    let (thin, thick) = (mask(&mut b, 0.5, paper), mask(&mut b, 0.8, paper));
    square(&mut b, 0.0, 1.0, thick);
    square(&mut b, 0.5, 1.0, thin);
    b.light(LightKind::Constant { radiance: Rgb::WHITE });
    let world = b.build();
    for Contestant { method, blurs, .. } in every_method_but(&["volpath", "ppm"], &photon_mapper(20_000)) {
        judge(method.name(), &world, &method, 1.0, if blurs { 0.01 } else { 0.0 });
    }
}
