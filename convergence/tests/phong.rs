//! Glossy surfaces: the energy of Phong's lobe in closed form, and the photon mapper against path
//! tracing.
//!
//! All tests together reject a correct program with a probability of [`ALPHA`]; seeds are fixed.

use nephroid::color::Rgb;
use nephroid::handle::Handle;
use nephroid::integrator::{FinalGather, Method, PhotonMapperConfig, Show, VcmConfig};
use nephroid::light::LightKind;
use nephroid::material::Material;
use nephroid::math::{DVec3, Transform, Vec3};
use nephroid::shape::Geometry;
use nephroid::world::World;
use nephroid_convergence::{
    Builder, Contestant, block_samples, every_method_but, forgiving, map_view, mean_radiances, path,
    photon_mapper, renders, session,
};
use nephroid_testkit::{ALPHA, MeanTest, sidak};

const EXPONENTS: [f32; 3] = [5.0, 50.0, 1000.0];
/// Albedos of the lobes.
const DIFFUSE: f64 = 0.3;
const GLOSSY: f64 = 0.6;

const SIDE: usize = 24;
const BLOCK: usize = 8;
const BLOCKS: usize = (SIDE / BLOCK) * (SIDE / BLOCK);
/// More than, for each exponent, the sky by each method, photons, and a room by three methods.
const TESTS: usize = EXPONENTS.len() * (6 + 1 + 3 * BLOCKS);

fn level() -> f64 {
    sidak(ALPHA, TESTS)
}

fn phong(b: &mut Builder, exponent: f32) -> Handle<Material> {
    let (diffuse_reflectance, specular_reflectance) = (b.constant(DIFFUSE as f32), b.constant(GLOSSY as f32));
    b.scene.materials.push(Material::Phong { diffuse_reflectance, specular_reflectance, exponent })
}

fn floor() -> Transform {
    Transform::rotate(DVec3::X, -90.0)
}

/// A Phong surface under a sky of radiance 1, seen straight down: the lobe lies about the normal and
/// loses nothing below the horizon, (n+2)/2π ∫ cosⁿ⁺¹ = 1, so L = k_d + k_s for any exponent.
#[test]
fn under_a_white_sky_the_lobe_keeps_its_energy() {
    for exponent in EXPONENTS {
        let mut b = Builder::parallel_view(Vec3::Y, Vec3::ZERO, 0.5, 8, 8);
        let glossy = phong(&mut b, exponent);
        b.shape(Geometry::Rectangle, floor(), glossy);
        b.light(LightKind::Constant { radiance: Rgb::WHITE });
        let world = b.build();
        for Contestant { method, .. } in every_method_but(&["volpath", "ppm"], &photon_mapper(0)) {
            let test: MeanTest = mean_radiances(&world, &method, 256, 1..9).into_iter().collect();
            test.within(DIFFUSE + GLOSSY, 1e-5).assert_passes(level());
        }
    }
}

/// Of photons that come straight down, or nearly, all but k_d + k_s is absorbed, in the books and in the
/// mean: what one photon carries on depends on where it goes.
#[test]
fn photons_keep_the_energy_of_the_lobe() {
    for exponent in EXPONENTS {
        let mut b = Builder::parallel_view(Vec3::Y * 0.5, Vec3::ZERO, 0.5, 1, 1);
        let glossy = phong(&mut b, exponent);
        b.shape(Geometry::Disk, floor(), glossy);
        b.light(LightKind::Spot {
            to_world: Transform::look_at(DVec3::Y, DVec3::ZERO, DVec3::Z).expect("it looks down"),
            intensity: Rgb::WHITE,
            cutoff_deg: 1.0,
            beam_width_deg: 1.0,
            texture: None,
        });
        let world = b.build();
        let absorbed = |seed| {
            let method = Method::PhotonMapper(map_view(Show::Direct, 20_000));
            let session = session(&world, method, 1, seed);
            let books = &session.statistics().ledger.lights[0];
            books.absorbed[0] / books.emitted[0]
        };
        let test: MeanTest = (1..17).map(absorbed).collect();
        // Inclined light loses the cosine of the lobe's axis; this is its mean over the cone.
        let glossy = GLOSSY * 0.5 * (1.0 + libm::cos(1.0f64.to_radians()));
        test.within(1.0 - DIFFUSE - glossy, 2e-5).assert_passes(level());
    }
}

/// A Phong floor and a Phong ball before a grey wall, under a lamp.
fn room(exponent: f32) -> World {
    let mut b = Builder::seen_from(Vec3::new(0.0, 1.2, 3.5), Vec3::new(0.0, 0.5, 0.0), 35.0, SIDE as u32);
    let (glossy, grey, black) = (phong(&mut b, exponent), b.diffuse(0.6), b.diffuse(0.0));
    b.shape(Geometry::Rectangle, floor(), glossy);
    b.sphere(Vec3::new(0.2, 0.4, 0.0), 0.4, glossy);
    let wall = Transform::translate(DVec3::new(0.0, 1.0, -1.0));
    b.shape(Geometry::Rectangle, wall, grey);
    let radiance = b.constant(2.0);
    let lamp = Transform::scale(DVec3::splat(0.7))
        .then(Transform::rotate(DVec3::X, 90.0))
        .then(Transform::translate(DVec3::new(-0.2, 1.9, 0.2)));
    b.shape(Geometry::Rectangle, lamp, black).emission = Some(radiance);
    b.build()
}

/// Blocks of 8 by 8 pixels agree to 1 % by gather rays, and to 2 % from the maps on the spot, which
/// glossy lobes do not use: what either reads off the wall near its edges is too dark by .17 of the
/// kernel's radius, of some .03 and .1. So is what paths from both ends merge.
#[test]
fn a_glossy_room_is_what_paths_make_it() {
    for exponent in EXPONENTS {
        let world = room(exponent);
        let paths = block_samples(&renders(&world, &path(), 64, 1..17), SIDE, BLOCK);
        let mapper =
            |final_gather| Method::PhotonMapper(PhotonMapperConfig { final_gather, ..photon_mapper(20_000) });
        let vcm = Method::Vcm(VcmConfig { light_paths: Some(4000), ..VcmConfig::default() });
        for (method, bias) in
            [(mapper(FinalGather::Rays(4)), 0.01), (mapper(FinalGather::Off), 0.02), (vcm, 0.01)]
        {
            let pictures = renders(&world, &method, 16, 21..37);
            for (a, b) in block_samples(&pictures, SIDE, BLOCK).iter().zip(&paths) {
                let mapped: MeanTest = a.iter().copied().collect();
                let traced: MeanTest = forgiving(a, b, bias).into_iter().collect();
                mapped.welch(&traced).assert_passes(level());
            }
        }
    }
}
