//! Pictures of media that must not depend on the number of threads, on what else is kept of a pixel, on who looks
//! into the render, or on the unit of length.

use nephroid::color::Rgb;
use nephroid::film::{Aov, Film};
use nephroid::integrator::{Method, PhotonMapperConfig, VolumeEstimate};
use nephroid::laboratory::Inspector;
use nephroid::medium::Phase;
use nephroid::observer::Silent;
use nephroid::session::{RenderSettings, Session};
use nephroid::transport::{Fog, VolumeKind};
use nephroid::world::World;
use nephroid_convergence::{
    Builder, balls_in_fog, cloud_over_floor, foggy_niche, glossy_ball_in_fog, means, session, three_media,
    volpath,
};
use nephroid_testkit::{ALPHA, MeanTest, sidak};

const SIDE: u32 = 8;

/// Eight samples, so that some of them read maps for others.
const SAMPLES: u32 = 8;

/// Pairs of means that are compared; all else compares bits.
const TESTS: usize = 2 * 2 * 6;

/// The path tracer, and the photon mapper with every way to look light up.
fn methods(emit: Option<u64>) -> Vec<(&'static str, Method)> {
    let points = PhotonMapperConfig {
        photons: 2000,
        caustic_photons: 1000,
        volume_photons: Some(3000),
        emit,
        ..PhotonMapperConfig::default()
    };
    let march = |volume_estimate| PhotonMapperConfig { volume_estimate, ..points.clone() };
    let beams = PhotonMapperConfig { volume_kind: VolumeKind::Beams, ..points.clone() };
    let ambient = PhotonMapperConfig { fog: Fog::Ambient, ..points.clone() };
    vec![
        ("volpath", volpath(None)),
        ("points", Method::PhotonMapper(points.clone())),
        ("march", Method::PhotonMapper(march(VolumeEstimate::March))),
        ("the report's march", Method::PhotonMapper(march(VolumeEstimate::MarchReport))),
        ("beams", Method::PhotonMapper(beams)),
        ("ambient", Method::PhotonMapper(ambient)),
    ]
}

/// With ambient light in every medium, for the method that asks for it.
fn scenes() -> Vec<(&'static str, Builder)> {
    let scenes = [
        ("glass in fog", balls_in_fog(SIDE)),
        ("gloss in fog", glossy_ball_in_fog(SIDE)),
        ("a coloured cloud", cloud_over_floor(SIDE, true, true)),
        ("three media", three_media(SIDE)),
    ];
    let lit = |b: Builder| b.with_media(|medium| medium.ambient = Rgb::new(0.1, 0.2, 0.3));
    scenes.map(|(name, b)| (name, lit(b))).into()
}

fn film(world: &World, method: &Method, seed: u64) -> Film {
    session(world, method.clone(), SAMPLES, seed).film().clone()
}

#[test]
fn threads_change_no_bit_and_seeds_do() {
    for (scene, builder) in scenes() {
        let world = builder.build();
        for (name, method) in methods(None) {
            let on = |threads: usize, seed: u64| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
                pool.install(|| film(&world, &method, seed))
            };
            let alone = on(1, 1);
            for threads in [2, 7] {
                assert!(on(threads, 1) == alone, "{scene}, {name} on {threads} threads");
            }
            assert!(on(2, 2) != alone, "{scene}, {name} with another seed");
        }
    }
}

/// And each of the further values that are light is in the picture.
#[test]
fn further_values_do_not_change_the_picture() {
    for (scene, builder) in scenes() {
        let world = builder.build();
        for (name, method) in methods(None) {
            let settings = RenderSettings { method: method.clone(), samples_per_pixel: SAMPLES, seed: 3 };
            let mut session = Session::new(&world, settings, &Silent).with_aovs(&Aov::ALL);
            while !session.iteration_is_complete() {
                assert!(session.step(&Silent), "nothing cancels");
            }
            assert!(*session.film() == film(&world, &method, 3), "{scene}, {name}");
            let aovs = session.aovs().expect("values that were asked for");
            let layer = |aov| aovs.develop(aov).expect("a value that was asked for").channels;
            let parts = [Aov::Direct, Aov::Global, Aov::Caustic, Aov::Emitted, Aov::Medium].map(layer);
            assert!(parts[4].concat().iter().any(|&light| light > 0.0), "{scene}, {name}");
            for (i, pixel) in session.film().develop().pixels.iter().enumerate() {
                for (channel, whole) in pixel.to_array().into_iter().enumerate() {
                    let sum: f32 = parts.iter().map(|part| part[channel][i]).sum();
                    assert!(
                        (sum - whole).abs() <= 3e-5 * whole.max(0.01),
                        "{scene}, {name}: {sum}, not {whole}"
                    );
                }
            }
        }
    }
}

#[test]
fn an_inspected_pixel_is_that_of_the_render_to_the_bit() {
    for (scene, builder) in scenes() {
        let world = builder.build();
        for (name, method) in methods(None) {
            let picture = film(&world, &method, 5).develop();
            for (x, y) in [(0, 0), (4, 5)] {
                let settings = RenderSettings { method: method.clone(), samples_per_pixel: SAMPLES, seed: 5 };
                let mut inspector = Inspector::new(&world, settings, (x, y), &Silent);
                while inspector.iterations() < 1 {
                    assert!(inspector.step(&Silent), "nothing cancels");
                }
                let report = inspector.finish();
                let pixel = picture.pixels[(y * SIDE + x) as usize];
                assert_eq!(report.radiance, pixel, "{scene}, {name} at {x}, {y}");
            }
        }
    }
}

/// Scales by powers of two change no bit.
#[test]
fn powers_of_two_times_as_large_with_as_much_thinner_media_is_the_same() {
    for i in 0..scenes().len() {
        let world = |scale| {
            let (scene, builder) = scenes().swap_remove(i);
            (scene, builder.scaled(scale).build())
        };
        let (scene, unit) = world(1.0);
        for scale in [-10.0, 20.0].map(libm::exp2) {
            let (_, other) = world(scale);
            for (name, method) in methods(None) {
                let same = film(&unit, &method, 1) == film(&other, &method, 1);
                assert!(same, "{scene}, {name} at {scale}");
            }
        }
    }
}

/// Other scales change nothing but the noise.
#[test]
fn a_thousandth_and_a_million_times_as_large_differ_by_noise() {
    let scenes: [fn() -> Builder; 2] = [
        || foggy_niche(SIDE, Rgb::new(0.3, 0.8, 2.0), Rgb::splat(0.8), Phase::HenyeyGreenstein { g: 0.5 }),
        || cloud_over_floor(SIDE, true, true),
    ];
    for scene in scenes {
        let world = |scale| scene().scaled(scale).build();
        let unit = world(1.0);
        for (name, method) in methods(Some(4000)) {
            let reference: MeanTest = means(&unit, &method, 4, 0..16).into_iter().collect();
            for (scale, first) in [(1e-3, 100), (1e6, 200)] {
                let seeds = first..first + 16;
                let found: MeanTest = means(&world(scale), &method, 4, seeds).into_iter().collect();
                let outcome = found.welch(&reference);
                assert!(outcome.passes(sidak(ALPHA, TESTS)), "{name} at {scale}: {outcome}");
            }
        }
    }
}
