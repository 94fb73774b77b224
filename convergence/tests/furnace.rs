//! Closed rooms of uniform light, whose radiance is known exactly (the furnace test): the inside of a
//! diffuse sphere of radius R and albedo ρ with a point light of intensity I at its centre has
//! irradiance I/R² straight from the light and I/(R²(1 − ρ)) in all, everywhere. Photons lie
//! uniformly there and a ball about a point cuts out an area of exactly πr², so density estimation
//! has no bias either, whatever kernel and bandwidth.
//!
//! Each test compares the mean of pictures with different seeds by a t-test; the tests of the file
//! share the level [`ALPHA`] by Šidák's formula. On seeds chosen afresh, correct code would fail
//! somewhere in this file with probability 1 %.

use nephroid::color::Rgb;
use nephroid::integrator::{
    DirectSource, FinalGather, Method, PathConfig, PhotonMapperConfig, PpmConfig, Show, VcmConfig,
};
use nephroid::light::SphereSampling;
use nephroid::math::{DVec3, Transform, Vec3};
use nephroid::photon_map::Kernel;
use nephroid::shape::Geometry;
use nephroid::transport::{DirectLights, LightChoice};
use nephroid::world::World;
use nephroid_convergence::{
    Builder, means, photon_mapper_variants, progressive, render, session, single_iterations,
};
use nephroid_testkit::{ALPHA, MeanTest, Outcome, sidak};
use std::f64::consts::PI;

/// More than the t-tests of this file.
const TESTS: usize = 300;

/// Rounding of single precision over a path, which a noiseless estimator would be convicted for.
const ROUNDING: f64 = 1e-5;

/// Seeds of vertex connection and merging at most.
const VCM_SEEDS: u64 = 8;

const RADIUS: f32 = 2.0;
const INTENSITY: f32 = 3.0;

#[track_caller]
fn judge(name: &str, outcome: &Outcome) {
    assert!(outcome.passes(sidak(ALPHA, TESTS)), "{name}: {outcome}");
}

#[track_caller]
fn expect(name: &str, world: &World, method: &Method, seeds: u64, exact: f64) {
    // Paths from both ends are long here, and each iteration has many.
    let seeds = if matches!(method, Method::Vcm(_)) { seeds.min(VCM_SEEDS) } else { seeds };
    let estimates: MeanTest = means(world, method, 4, 0..seeds).into_iter().collect();
    judge(name, &estimates.within(exact, ROUNDING));
}

/// The sphere, seen from its centre.
fn sphere(albedo: Rgb) -> Builder {
    let mut b = Builder::seen_from(Vec3::ZERO, Vec3::new(0.3, 0.5, 1.0), 120.0, 8);
    let reflectance = b.scene.textures.constant(albedo);
    let wall = b.scene.materials.push(nephroid::material::Material::Diffuse { reflectance });
    b.sphere(Vec3::ZERO, RADIUS, wall).flip_normals = true;
    b
}

fn furnace(albedo: f32) -> World {
    let mut b = sphere(Rgb::splat(albedo));
    b.point_light(Vec3::ZERO, INTENSITY);
    b.build()
}

/// Radiance of the wall by light that met it between 1 and `bounces` times.
fn radiance(albedo: f64, bounces: i32) -> f64 {
    let direct = f64::from(INTENSITY / (RADIUS * RADIUS));
    direct / PI * (1..=bounces).map(|n| libm::pow(albedo, f64::from(n))).sum::<f64>()
}

fn all_bounces(albedo: f64) -> f64 {
    f64::from(INTENSITY / (RADIUS * RADIUS)) / PI * albedo / (1.0 - albedo)
}

fn mapper() -> PhotonMapperConfig {
    PhotonMapperConfig { emit: Some(2000), neighbours: 20, radius: Some(0.4), ..Default::default() }
}

fn nearest() -> PhotonMapperConfig {
    PhotonMapperConfig { radius: None, ..mapper() }
}

fn path(max_depth: Option<u32>) -> Method {
    Method::Path(PathConfig { max_depth, ..Default::default() })
}

/// A path tracer and the ways of the photon mapper that share no code with one another.
fn few_methods(max_depth: Option<u32>) -> Vec<(&'static str, Method)> {
    let with = |config: PhotonMapperConfig| Method::PhotonMapper(PhotonMapperConfig { max_depth, ..config });
    let ppm = |config: PhotonMapperConfig| match progressive(PhotonMapperConfig { max_depth, ..config }) {
        // Three iterations: few samples in each are enough.
        Method::Ppm(config) => Method::Ppm(PpmConfig { samples_per_pixel: Some(1), ..config }),
        method => method,
    };
    let vcm = VcmConfig {
        mapper: PhotonMapperConfig { max_depth, ..Default::default() },
        light_paths: Some(500),
        ..VcmConfig::default()
    };
    vec![
        ("path", path(max_depth)),
        ("map", with(PhotonMapperConfig { final_gather: FinalGather::Off, ..nearest() })),
        ("gather", with(PhotonMapperConfig { final_gather: FinalGather::Rays(4), ..nearest() })),
        ("direct from the map", with(PhotonMapperConfig { direct: DirectSource::Map, ..nearest() })),
        ("ppm", ppm(nearest())),
        ("ppm by the map", ppm(PhotonMapperConfig { final_gather: FinalGather::Off, ..nearest() })),
        ("ppm of fixed radius", ppm(PhotonMapperConfig { direct: DirectSource::Map, ..mapper() })),
        ("vcm", Method::Vcm(vcm.clone())),
        ("vcm, correlation", Method::Vcm(VcmConfig { correlation: true, ..vcm.clone() })),
        ("vcm that merges", Method::Vcm(VcmConfig { connections: false, ..vcm.clone() })),
        ("vcm that connects", Method::Vcm(VcmConfig { merging: false, ..vcm })),
    ]
}

/// A3 for every variant of every integrator.
#[test]
fn every_variant_has_the_closed_form() {
    let world = furnace(0.8);
    let exact = all_bounces(0.8);
    for (name, method) in photon_mapper_variants(&mapper()) {
        expect(&name, &world, &method, 20, exact);
    }
}

/// Over albedos, up to one for which a limit of 20 bounces would lose 36 %.
#[test]
fn every_albedo_has_the_closed_form() {
    for albedo in [0.5f32, 0.9, 0.95] {
        let world = furnace(albedo);
        for (name, method) in few_methods(None) {
            expect(&format!("{name} at {albedo}"), &world, &method, 40, all_bounces(f64::from(albedo)));
        }
    }
}

/// Progressive photon mapping as it plans by itself, and iterations far on in a render, where a part of the neighbours
/// is left.
#[test]
fn early_and_late_iterations_have_the_closed_form() {
    let (world, exact) = (furnace(0.8), all_bounces(0.8));
    expect("ppm", &world, &Method::Ppm(PpmConfig::default()), 8, exact);
    for final_gather in [FinalGather::Off, FinalGather::Auto] {
        for direct in [DirectSource::Rays, DirectSource::Map] {
            let method = progressive(PhotonMapperConfig { final_gather, direct, ..nearest() });
            for iteration in [10, 1000, 1_000_000] {
                let pictures = single_iterations(&world, &method, iteration, 0..60);
                let mean = |picture: Vec<f64>| picture.iter().sum::<f64>() / picture.len() as f64;
                let test: MeanTest = pictures.into_iter().map(mean).collect();
                let name = format!("iteration {iteration}, {direct:?}, {final_gather:?}");
                judge(&name, &test.within(exact, ROUNDING));
            }
        }
    }
}

/// The Gaussian of 1996 as it was published loses a known 46.9 %, and nothing but that.
#[test]
fn the_gaussian_of_1996_is_as_dark_as_it_is_known_to_be() {
    let config = PhotonMapperConfig {
        kernel: Kernel::ReportGaussian,
        direct: DirectSource::Map,
        final_gather: FinalGather::Off,
        ..nearest()
    };
    let method = Method::PhotonMapper(config);
    expect("report's Gaussian", &furnace(0.8), &method, 40, 0.531_153 * all_bounces(0.8));
}

/// Items 40 and 41 of the report: photons are worth 4πI over the number of paths *emitted*, so that
/// direct light is the same from photons and by rays.
#[test]
fn direct_light_is_the_same_from_photons_and_by_rays() {
    let exact = radiance(0.5, 1);
    for direct in [DirectSource::Rays, DirectSource::Map] {
        for emit in [500, 3000] {
            let config = PhotonMapperConfig { direct, show: Show::Direct, emit: Some(emit), ..nearest() };
            let name = format!("{direct:?} of {emit} paths");
            expect(&name, &furnace(0.5), &Method::PhotonMapper(config), 40, exact);
        }
    }
}

/// A4, the number that the report doubts: direct over indirect light is (1 − ρ)/ρ, 1.25 at ρ = 4/9.
/// Its inverse is tested, in which the noise is above the line.
#[test]
fn direct_over_indirect_light_is_as_the_albedo_says() {
    let world = furnace(4.0 / 9.0);
    for (name, method) in &few_methods(None)[..3] {
        let ratios: MeanTest = (0..40)
            .map(|seed| {
                let session = session(&world, method.clone(), 4, seed);
                1.0 / session.statistics().picture.direct_to_indirect().unwrap()
            })
            .collect();
        judge(name, &ratios.within(1.0 / 1.25, ROUNDING));
    }
}

/// With paths of at most n segments, light has met the wall n − 1 times at most.
#[test]
fn limits_of_depth_cut_the_series_where_they_say() {
    let world = furnace(0.7);
    for depth in [1, 2, 3, 5] {
        for (name, method) in few_methods(Some(depth)) {
            expect(&format!("{name} to {depth}"), &world, &method, 40, radiance(0.7, depth as i32 - 1));
        }
    }
}

/// Roulette by one number for three channels takes nothing from any of them.
#[test]
fn roulette_is_fair_to_every_colour() {
    let albedo = [0.9f32, 0.4, 0.1];
    let mut b = sphere(Rgb::from(albedo));
    b.light(nephroid::light::LightKind::Point {
        position: Vec3::ZERO,
        intensity: Rgb::new(0.1, 0.3, 1.0) * INTENSITY,
    });
    let world = b.build();
    let exact = [0.1 * all_bounces(0.9), 0.3 * all_bounces(0.4), all_bounces(0.1)];
    for (name, method) in few_methods(None) {
        let mut channels = [MeanTest::new(); 3];
        let seeds = if matches!(method, Method::Vcm(_)) { VCM_SEEDS } else { 40 };
        for seed in 0..seeds {
            let image = render(&world, method.clone(), 4, seed);
            let n = image.pixels.len() as f64;
            for (c, test) in channels.iter_mut().enumerate() {
                test.push(image.pixels.iter().map(|p| f64::from(p.to_array()[c])).sum::<f64>() / n);
            }
        }
        for (c, test) in channels.iter().enumerate() {
            judge(&format!("{name}, channel {c}"), &test.within(exact[c], ROUNDING));
        }
    }
}

/// Lights of different strength, however they and their directions are chosen, add up.
#[test]
fn lights_add_up_however_they_are_chosen() {
    let mut b = sphere(Rgb::splat(0.5));
    b.point_light(Vec3::ZERO, 0.25 * INTENSITY);
    b.point_light(Vec3::ZERO, 0.75 * INTENSITY);
    let world = b.build();
    for direct_lights in [DirectLights::One, DirectLights::All] {
        let path = Method::Path(PathConfig { direct_lights, ..Default::default() });
        expect("path", &world, &path, 40, all_bounces(0.5));
        for light_choice in [LightChoice::Power, LightChoice::Equal] {
            for sphere_sampling in [SphereSampling::SolidAngle, SphereSampling::Rejection] {
                for direct in [DirectSource::Rays, DirectSource::Map] {
                    let config = PhotonMapperConfig {
                        direct_lights,
                        light_choice,
                        sphere_sampling,
                        direct,
                        ..nearest()
                    };
                    let name = format!("{direct_lights:?} {light_choice:?} {sphere_sampling:?} {direct:?}");
                    expect(&name, &world, &Method::PhotonMapper(config), 20, all_bounces(0.5));
                }
            }
        }
    }
}

/// A wall that itself emits L and reflects ρ has radiance L/(1 − ρ).
#[test]
fn a_glowing_wall_has_the_closed_form() {
    let mut b = sphere(Rgb::splat(0.5));
    let glow = b.constant(0.5);
    b.scene.shapes[0].emission = Some(glow);
    let world = b.build();
    for (name, method) in few_methods(None) {
        expect(name, &world, &method, 20, 1.0);
    }
}

/// Two parallel plates without end that emit M₁, M₂ and reflect ρ₁, ρ₂ give off
/// B₁ = (M₁ + ρ₁ M₂)/(1 − ρ₁ρ₂). Mirrors around a piece of them stand for the rest, so that most of
/// the light takes paths with specular surfaces in it, which no estimator may lose or count twice.
#[test]
fn endless_parallel_plates_have_the_closed_form() {
    let (emitted, albedo) = ([0.7f32, 0.2], [0.5f32, 0.8]);
    let up = |z: f64| Transform::translate(DVec3::new(0.0, 0.0, z));
    let mut b = Builder::seen_from(Vec3::new(0.05, 0.0, 0.9), Vec3::ZERO, 30.0, 8);
    for i in 0..2 {
        let (material, glow) = (b.diffuse(albedo[i]), b.constant(emitted[i]));
        let plate = b.shape(Geometry::Rectangle, up(i as f64), material);
        plate.emission = Some(glow);
        plate.flip_normals = i == 1;
    }
    let mirror = b.mirror(1.0);
    for quarter in 0..4 {
        // Upright at x = −1 and facing +x, then turned into its place.
        let wall = Transform::rotate(DVec3::Y, 90.0)
            .then(Transform::translate(DVec3::new(-1.0, 0.0, 0.0)))
            .then(Transform::rotate(DVec3::Z, 90.0 * f64::from(quarter)));
        b.shape(Geometry::Rectangle, wall, mirror);
    }
    let world = b.build();
    let [m1, m2, r1, r2] = [emitted[0], emitted[1], albedo[0], albedo[1]].map(f64::from);
    let exact = (m1 + r1 * m2) / (1.0 - r1 * r2);
    let on_the_spot = |direct| {
        Method::PhotonMapper(PhotonMapperConfig { direct, final_gather: FinalGather::Off, ..mapper() })
    };
    for (name, method) in [
        ("path", path(None)),
        ("map", on_the_spot(DirectSource::Rays)),
        ("direct from the map", on_the_spot(DirectSource::Map)),
        // Merged, photons would miss those that mirrors have to their side.
        ("vcm", Method::Vcm(VcmConfig { merging: false, light_paths: Some(500), ..VcmConfig::default() })),
    ] {
        expect(name, &world, &method, 40, exact);
    }
}
