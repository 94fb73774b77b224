//! Directions, indices and textures, by numbers worked out by hand.

use nephroid::color::Rgb;
use nephroid::handle::{Arena, Handle};
use nephroid::material::{Bsdf, Material, Metal, Surface, Transport};
use nephroid::math::{Affine2, Vec2, Vec3, real};
use nephroid::texture::{Checkerboard, Texture, Textures};

const DIAGONAL: f32 = std::f32::consts::FRAC_1_SQRT_2;

/// A material on the plane z = 0, built with a white texture.
fn on_a_plane(wo: Vec3, build: impl FnOnce(Handle<Texture>) -> Material) -> Bsdf {
    let mut textures = Textures::default();
    let mut materials = Arena::default();
    let material = materials.push(build(textures.constant(Rgb::WHITE)));
    Material::at(&materials, material, &textures, &Surface::flat(Vec3::Z, Vec2::ZERO), wo)
}

fn glass(white: Handle<Texture>) -> Material {
    Material::Dielectric {
        int_ior: 1.5,
        ext_ior: 1.0,
        specular_reflectance: white,
        specular_transmittance: white,
    }
}

fn close(a: Vec3, b: Vec3) {
    assert!((a - b).length() < 1e-6, "{a} is not {b}");
}

#[test]
fn both_directions_leave_the_surface() {
    let wo = Vec3::new(DIAGONAL, 0.0, DIAGONAL);
    let mirror =
        |specular_reflectance| Material::Conductor { metal: Metal::PerfectMirror, specular_reflectance };
    let [reflected, transmitted] = on_a_plane(wo, mirror).dirac_lobes(wo, Transport::Radiance);
    close(reflected.unwrap().wi, Vec3::new(-DIAGONAL, 0.0, DIAGONAL));
    assert!(transmitted.is_none());

    let [_, transmitted] = on_a_plane(wo, glass).dirac_lobes(wo, Transport::Radiance);
    let sin = DIAGONAL / 1.5;
    close(transmitted.unwrap().wi, Vec3::new(-sin, 0.0, -(1.0 - sin * sin).sqrt()));
}

#[test]
fn glass_splits_light_as_fresnel_says() {
    let [reflected, transmitted] = on_a_plane(Vec3::Z, glass).dirac_lobes(Vec3::Z, Transport::Flux);
    assert!((reflected.unwrap().weight.g - 0.04).abs() < 1e-6);
    assert!((transmitted.unwrap().weight.g - 0.96).abs() < 1e-6);
    // A camera outside sees radiance from inside spread out; one inside sees it concentrated.
    let seen = |wo| on_a_plane(wo, glass).dirac_lobes(wo, Transport::Radiance)[1].unwrap().weight.g;
    assert!((seen(Vec3::Z) - 0.96 / 2.25).abs() < 1e-6);
    assert!((seen(-Vec3::Z) - 0.96 * 2.25).abs() < 1e-6);
}

#[test]
fn reflection_in_glass_is_total_beyond_the_critical_angle() {
    // asin(1/1.5) is 41.81°.
    for (angle_deg, total) in [(41.7f32, false), (41.9, true), (75.0, true)] {
        let (sin, cos) = real::sin_cos(angle_deg.to_radians());
        let wo = Vec3::new(sin, 0.0, -cos);
        let [reflected, transmitted] = on_a_plane(wo, glass).dirac_lobes(wo, Transport::Radiance);
        assert_eq!(transmitted.is_none(), total);
        assert_eq!(reflected.unwrap().weight == Rgb::WHITE, total);
        close(reflected.unwrap().wi, Vec3::new(-sin, 0.0, -cos));
    }
}

#[test]
fn thin_glass_and_nothing_let_light_pass_straight() {
    let wo = Vec3::new(0.48, -0.6, 0.64);
    let pane = |white| Material::ThinDielectric {
        int_ior: 1.5,
        ext_ior: 1.0,
        specular_reflectance: white,
        specular_transmittance: white,
    };
    for wo in [wo, -wo] {
        let [_, passed] = on_a_plane(wo, pane).dirac_lobes(wo, Transport::Radiance);
        assert_eq!(passed.unwrap().wi, -wo);
        let null = on_a_plane(wo, |_| Material::Null);
        assert!(null.is_null() && null.is_dirac());
        let passed = null.sample(wo, Vec2::ZERO, 0.3, Transport::Radiance).unwrap();
        assert_eq!((passed.wi, passed.weight), (-wo, Rgb::WHITE));
    }
    // 2R/(1+R) with R = 0.04, and no squared indices.
    let [reflected, passed] = on_a_plane(Vec3::Z, pane).dirac_lobes(Vec3::Z, Transport::Radiance);
    assert!((reflected.unwrap().weight.g - 0.08 / 1.04).abs() < 1e-6);
    assert!((passed.unwrap().weight.g - 0.96 / 1.04).abs() < 1e-6);
}

#[test]
fn eval_has_no_cosine() {
    let grey = on_a_plane(Vec3::Z, |reflectance| Material::Diffuse { reflectance });
    let wi = Vec3::new(0.8, 0.0, 0.6);
    assert!((grey.eval(Vec3::Z, wi).g - std::f32::consts::FRAC_1_PI).abs() < 1e-7);
    assert!((grey.cosine(wi) - 0.6).abs() < 1e-7);
    assert!((grey.pdf(Vec3::Z, wi) - 0.6 * std::f32::consts::FRAC_1_PI).abs() < 1e-7);
}

#[test]
fn textures_are_read_at_uv_and_kept_below_one() {
    let mut textures = Textures::default();
    let (color0, color1) = (textures.constant(Rgb::splat(0.25)), textures.constant(Rgb::splat(7.0)));
    let board = Texture::Checkerboard(Checkerboard { color0, color1, to_uv: Affine2::IDENTITY });
    let board = textures.push(board);
    let mut materials = Arena::default();
    let diffuse = materials.push(Material::Diffuse { reflectance: board });
    let phong = materials.push(Material::Phong {
        diffuse_reflectance: board,
        specular_reflectance: board,
        exponent: 3.0,
    });
    let at =
        |material, uv| Material::at(&materials, material, &textures, &Surface::flat(Vec3::Z, uv), Vec3::Z);
    let (dark, bright) = (Vec2::splat(0.25), Vec2::new(0.25, 0.75));
    assert_eq!(at(diffuse, dark).diffuse_albedo(), Rgb::splat(0.25));
    assert_eq!(at(diffuse, bright).diffuse_albedo(), Rgb::WHITE);
    assert_eq!(at(phong, dark).glossy_albedo(), Rgb::splat(0.25));
    assert_eq!(at(phong, bright).glossy_albedo(), Rgb::splat(0.5));
}

#[test]
fn a_bsdf_stays_small() {
    assert!(size_of::<Bsdf>() <= 512, "{} bytes", size_of::<Bsdf>());
}
