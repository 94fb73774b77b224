//! Progressive photon mapping in its memoryless form (Knaus and Zwicker 2011, doi 10.1145/1966394.1966404): iterations
//! of the photon mapper, each with few photons of its own and estimates that are narrower than those of the one
//! before. Their mean converges. Each follows from its index, so none waits for another.

mod balance;
#[cfg(test)]
mod balance_tests;
mod config;
mod trial;

pub use config::PpmConfig;

use super::photon_mapper::{CameraPlan, FinalGather, Guides, Maps, Turn};
use super::{Effort, Quiet};
use crate::observer::Observer;
use crate::photon_map::Blur;
use crate::sampling::{Key, Stream};
use crate::transport::{MapPlan, PhotonPlan};
use crate::world::World;
use balance::{GatherRays, MOST_SAMPLES, Variances, balance};

/// Photons wanted in each map of a trial …
const TRIAL_PHOTONS: u64 = 30_000;

/// … for which at most so many times the paths are emitted.
const TRIAL_EMIT_MAX: u64 = 10;

/// Paths for a map that trials found empty: in trials, and in each iteration.
const PATHS_IN_VAIN: u64 = 4096;

/// The seed of what is tried before a render.
fn pilot_seed(seed: u64) -> u64 {
    Key::new(seed, 0, Stream::Pilot).with(u64::MAX).hash()
}

/// The photons of trials.
fn trial_photons(world: &World, config: &PpmConfig, seed: u64) -> PhotonPlan {
    let mut targets = config.mapper.targets();
    for wanted in [&mut targets.global, &mut targets.caustic, &mut targets.volume] {
        *wanted = (*wanted).min(TRIAL_PHOTONS);
    }
    targets.emit = None;
    targets.emit_max = targets.emit_max.min(TRIAL_EMIT_MAX);
    let mut plan = PhotonPlan::by_pilot(world, &config.mapper.walk_settings(), &targets, seed);
    let maps = [&mut plan.global, &mut plan.caustic, &mut plan.volume, &mut plan.volume_caustic];
    for MapPlan { paths, expected_photons, limited } in maps {
        *limited = false;
        if *expected_photons == 0 {
            *paths = (*paths).min(PATHS_IN_VAIN);
        }
    }
    plan
}

/// What to do in each iteration; whatever it is, where the observer cancels.
pub(crate) fn plan(
    world: &World,
    config: &PpmConfig,
    seed: u64,
    observer: &dyn Observer,
) -> (PhotonPlan, CameraPlan, Effort) {
    let tried = trial_photons(world, config, seed);
    let rays = match (config.mapper.camera_plan(1).gather_rays, config.mapper.final_gather) {
        (None, _) => GatherRays::None,
        (Some(_), FinalGather::Rays(asked)) => GatherRays::Asked(asked),
        (Some(_), _) => GatherRays::Planned,
    };
    let camera = CameraPlan {
        gather_rays: (rays != GatherRays::None).then_some(1),
        neighbours: config.neighbours(&tried),
        ..CameraPlan::default()
    };
    let found = trial::trial(world, config, &tried, &camera, pilot_seed(seed), &Quiet(observer));
    let window = world.scene().film.window();
    let pixels = u64::from(window.width) * u64::from(window.height);
    let variances = Variances::of(&found.pixels);
    let (factors, mut camera) = balance(&variances, found.costs, &tried, rays, pixels);
    let walks = config.mapper.walk_settings();
    let mut photons = tried.scaled(world, &walks, factors);
    if !config.plan_photons {
        let best = photons.expected_photons();
        photons = PhotonPlan::by_pilot(world, &walks, &config.mapper.targets(), seed);
        // As many samples as suit so many photons.
        let units = f64::from(camera.samples_per_pixel / camera.stride);
        let units = units * photons.expected_photons() as f64 / best.max(1) as f64;
        let most = f64::from(MOST_SAMPLES / camera.stride);
        camera.samples_per_pixel = camera.stride * units.round().clamp(1.0, most) as u32;
    }
    camera.neighbours = config.neighbours(&photons);
    if let Some(samples) = config.samples_per_pixel {
        camera.samples_per_pixel = samples.clamp(1, 1 << 16);
        // Those that read the maps are the same number of all.
        while !camera.samples_per_pixel.is_multiple_of(camera.stride) {
            camera.stride /= 2;
        }
    }
    let spread = Variances::of_all(&found.pixels);
    let effort = balance::effort(&spread, found.costs, &tried, (&photons, &camera), pixels);
    (photons, camera, effort)
}

/// Guides for the gather rays of all iterations, from photons of their own: made once, for any guide is good
/// everywhere. `None` if the observer cancelled.
pub(crate) fn guides(
    world: &World,
    config: &PpmConfig,
    seed: u64,
    observer: &dyn Observer,
) -> Option<Guides> {
    let turn = Turn { seed: pilot_seed(seed), iteration: 0, gathers: true, blur: Blur::WHOLE };
    let photons = trial_photons(world, config, seed);
    let maps = Maps::build(world, &config.mapper, &photons, &turn, &Quiet(observer))?;
    Some(Guides::new(&maps.global))
}
