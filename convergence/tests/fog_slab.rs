//! A slab in parallel light, seen along its normal: single scattering in closed form, for every estimator, with
//! extinctions and albedos that differ between channels, and with the same extinction on a grid. And the error of the
//! report's march, which is known.
//!
//! The tests of the file share the level [`ALPHA`] by Šidák's formula: on seeds chosen afresh, correct code would fail
//! somewhere in this file with probability 1 %.

use nephroid::color::Rgb;
use nephroid::integrator::{DirectSource, Method, PhotonMapperConfig, VolumeEstimate};
use nephroid::math::{DVec3, Vec3};
use nephroid::medium::{GridValues, Medium, Phase};
use nephroid::transport::VolumeKind;
use nephroid::world::World;
use nephroid_convergence::{Builder, channel_means, grey_fog, medium_view, medium_views, volpath};
use nephroid_testkit::{ALPHA, MeanTest, Outcome, sidak};
use std::f64::consts::PI;

/// More than the statistical tests of this file.
const TESTS: usize = 200;

#[track_caller]
fn judge(name: &str, outcome: &Outcome) {
    assert!(outcome.passes(sidak(ALPHA, TESTS)), "{name}: {outcome}");
}

#[track_caller]
fn judge_channels(name: &str, means: &[[f64; 3]], exact: [f64; 3], bias: f64) {
    for (channel, exact) in exact.into_iter().enumerate() {
        let test: MeanTest = means.iter().map(|mean| mean[channel]).collect();
        judge(&format!("{name}, channel {channel}"), &test.within(exact, bias));
    }
}

/// Cosine of the light to the slab's normal.
const MU: f64 = 0.6;

/// A slab between z = 0 and 1, so wide that its sides are not seen, lit from above.
fn slab(from_above: bool, medium: impl FnOnce(&mut Builder, DVec3, DVec3) -> Medium) -> World {
    let z = if from_above { 1.5 } else { -0.5 };
    let target = Vec3::new(0.0, 0.0, 0.5);
    let mut b = Builder::parallel_view(Vec3::new(0.0, 0.0, z), target, 0.6, 8, 8);
    b.sunlight(Vec3::new((1.0 - MU * MU).sqrt() as f32, 0.0, -MU as f32), 1.0);
    // The light comes in from the left, by as much as the slab is thick.
    let (low, high) = (DVec3::new(-2.2, -0.9, 0.0), DVec3::new(0.9, 0.9, 1.0));
    let medium = medium(&mut b, low, high);
    let medium = b.medium(medium);
    b.box_of(low, high, medium);
    b.build()
}

/// Light scattered once by a slab of optical depth τ, for an irradiance of 1 on a surface that faces the light. From
/// above a p ∫ e^(−t/μ − t) dt, from below a p ∫ e^(−t/μ − (τ−t)) dt, over depths t from 0 to τ.
fn slab_exactly(from_above: bool, tau: f64, albedo: f64, phase: impl Fn(f64) -> f64) -> f64 {
    if from_above {
        let rate = 1.0 / MU + 1.0;
        albedo * phase(-MU) * -libm::expm1(-rate * tau) / rate
    } else {
        let rate = 1.0 / MU - 1.0;
        albedo * phase(MU) * libm::exp(-tau) * -libm::expm1(-rate * tau) / rate
    }
}

/// Henyey and Greenstein's function of the cosine between the directions before and after.
fn henyey_greenstein(g: f64, cos: f64) -> f64 {
    let distance_sq = 1.0 + g * g - 2.0 * g * cos;
    (1.0 - g * g) / (4.0 * PI * distance_sq * distance_sq.sqrt())
}

/// Every estimator but marches, whose balls reach out of the slab: as the camera looks along the normal, discs and beams
/// are blurred along the slab, where nothing changes.
fn methods(count: u64) -> Vec<(String, Method)> {
    let views = medium_views(count).into_iter().filter(|(_, c)| c.volume_estimate != VolumeEstimate::March);
    let views = views.map(|(name, config)| {
        (name, Method::PhotonMapper(PhotonMapperConfig { max_depth: Some(2), ..config }))
    });
    views.chain([("volpath".into(), volpath(Some(2)))]).collect()
}

fn samples_for(name: &str) -> u32 {
    if ["rays", "volpath"].contains(&name) { 64 } else { 4 }
}

/// Channels that differ, by Henyey and Greenstein's function, from both sides.
#[test]
fn a_slab_in_parallel_light_has_its_closed_form() {
    let (sigma_t, albedo) = ([0.4f32, 1.0, 2.5], [0.9f32, 0.6, 0.8]);
    for g in [0.8f32, -0.8] {
        for from_above in [true, false] {
            let phase = Phase::HenyeyGreenstein { g };
            let fog = Medium::homogeneous("fog", Rgb::from(sigma_t), Rgb::from(albedo), phase);
            let world = slab(from_above, |_, _, _| fog);
            let exact = [0, 1, 2].map(|c| {
                let (tau, albedo) = (f64::from(sigma_t[c]), f64::from(albedo[c]));
                slab_exactly(from_above, tau, albedo, |cos| henyey_greenstein(f64::from(g), cos))
            });
            for (name, method) in methods(10_000) {
                let means = channel_means(&world, &method, samples_for(&name), 0..20);
                judge_channels(&format!("{name}, {g}, {from_above}"), &means, exact, 1e-3);
            }
        }
    }
}

/// The same from an extinction and an albedo on grids, whose values are everywhere the same and so known: distances are
/// sampled by another way then, and beams told in stretches.
#[test]
fn grids_that_are_everywhere_the_same_are_like_numbers() {
    let (sigma_t, albedo) = (Rgb::new(0.5, 1.0, 2.0), Rgb::new(0.9, 0.6, 0.8));
    for from_above in [true, false] {
        let world = slab(from_above, |b, low, high| Medium {
            sigma_t: b.grid(low, high, [2; 3], GridValues::Rgb(vec![sigma_t; 8])),
            albedo: b.grid(low, high, [1; 3], GridValues::Rgb(vec![albedo])),
            ..grey_fog(0.0, 0.0, Phase::Isotropic)
        });
        let exact = [0, 1, 2]
            .map(|c| slab_exactly(from_above, f64::from(sigma_t[c]), f64::from(albedo[c]), |_| 0.25 / PI));
        for (name, method) in methods(10_000) {
            let means = channel_means(&world, &method, samples_for(&name), 0..20);
            judge_channels(&format!("{name}, {from_above}"), &means, exact, 1e-3);
        }
    }
}

/// Light scattered once by rays and by photons is the same light: a picture of all of it with both would be twice as
/// bright. Without the map of single scattering, and limited to it, nothing is left.
#[test]
fn rays_and_map_bring_the_same_light_and_never_both() {
    let world = slab(true, |_, _, _| grey_fog(1.0, 0.8, Phase::Isotropic));
    for (name, config) in medium_views(10_000).into_iter().skip(1) {
        let config = PhotonMapperConfig { max_depth: Some(2), ..config };
        let by_map = Method::PhotonMapper(config.clone());
        let by_rays =
            Method::PhotonMapper(PhotonMapperConfig { single_scatter: DirectSource::Rays, ..config });
        let exact = slab_exactly(true, 1.0, 0.8, |_| 0.25 / PI);
        // The march's balls reach out of the slab.
        let bias = if name == "points by march" { 0.2 } else { 1e-3 };
        judge_channels(&name, &channel_means(&world, &by_map, 4, 0..20), [exact; 3], bias);
        judge_channels("rays", &channel_means(&world, &by_rays, 64, 0..20), [exact; 3], 1e-3);
    }
}

/// A medium behind the slab that no light comes out of again, and which so has no photons, adds nothing and holds nothing
/// up, neither in the maps nor in marches along it.
#[test]
fn a_medium_without_photons_is_passed() {
    let world = |black: bool| {
        slab(true, |b, low, high| {
            if black {
                let medium = b.medium(grey_fog(1.0, 0.0, Phase::Isotropic));
                b.box_of(low - DVec3::Z * 3.0, high - DVec3::Z * 3.0, medium);
            }
            grey_fog(1.0, 0.8, Phase::Isotropic)
        })
    };
    let (alone, above) = (world(false), world(true));
    let report = medium_view(VolumeKind::Points, VolumeEstimate::MarchReport, 2000);
    for (name, config) in medium_views(2000).into_iter().chain([("report".into(), report)]) {
        let method = Method::PhotonMapper(config);
        let [a, b] = [&alone, &above].map(|world| {
            channel_means(world, &method, 4, 0..10).iter().map(|mean| mean[0]).collect::<MeanTest>()
        });
        // The scene is larger, and so are the steps of the report's march.
        if name != "report" {
            judge(&name, &a.welch(&b));
        }
        assert!(b.mean() > 0.0, "{name}");
    }
}

/// A camera inside a long block in light across its view, along which the light is the same everywhere: the radiance
/// is that of an even source, a p E (1 − e^(−σ_t d)).
fn block(sigma_t: f32) -> World {
    let origin = Vec3::new(0.0, 0.0, 0.5);
    let mut b = Builder::parallel_view(origin, Vec3::new(1.0, 0.0, 0.5), 0.05, 2, 2);
    b.sunlight(-Vec3::Z, 1.0);
    let medium = b.medium(grey_fog(sigma_t, 1.0, Phase::Isotropic));
    b.box_of(DVec3::new(-0.6, -0.6, 0.0), DVec3::new(4.0, 0.6, 1.0), medium);
    b.scene.camera.medium = Some(medium);
    b.build()
}

/// With steps of optical depth τ the report's march is too bright by τ/(1 − e^(−τ)), which is 1.27 at .5 and 1.58 at
/// 1; neither the march that samples each step by transmittance nor the beam estimate is. Light is taken at the near
/// end of each step, and is the same everywhere but where the block ends, of which e^(−4) and less is seen: 4 % of bias are
/// forgiven, for that and for the blur of what falls off downwards.
#[test]
fn the_reports_march_is_as_much_too_bright_as_its_steps_are_long() {
    const SIGMA: f64 = 1.0;
    let world = block(SIGMA as f32);
    let exact = libm::exp(-0.5 * SIGMA) / (4.0 * PI) * -libm::expm1(-4.0 * SIGMA);
    let with = |estimate, march_step| {
        let config = PhotonMapperConfig {
            march_step,
            max_depth: Some(2),
            volume_neighbours: (estimate != VolumeEstimate::Beam).then_some(60),
            ..medium_view(VolumeKind::Points, estimate, 20_000)
        };
        channel_means(&world, &Method::PhotonMapper(config), 4, 0..16)
    };
    for tau in [0.25, 0.5, 1.0] {
        let too_bright = tau / -libm::expm1(-tau);
        let means = with(VolumeEstimate::MarchReport, Some((tau / SIGMA) as f32));
        judge_channels(&format!("steps of {tau}"), &means, [exact * too_bright; 3], 0.04);
    }
    for estimate in [VolumeEstimate::March, VolumeEstimate::Beam] {
        judge_channels(&format!("{estimate:?}"), &with(estimate, None), [exact; 3], 0.04);
    }
}
