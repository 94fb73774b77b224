//! Progressive photon mapping in its memoryless form (Knaus and Zwicker 2011, doi 10.1145/1966394.1966404): iterations
//! of the photon mapper, each with few photons of its own and estimates that are narrower than those of the one
//! before. Their mean converges, and each is independent of all others.

mod balance;
mod config;
mod trial;

pub use config::PpmConfig;

use super::photon_mapper::{CameraPlan, Guides, Maps, Turn};
use crate::observer::Silent;
use crate::photon_map::Blur;
use crate::sampling::{Key, Stream};
use crate::transport::PhotonPlan;
use crate::world::World;
use balance::{Variances, balance};

/// Photons wanted in each map of a trial.
const TRIAL_PHOTONS: u64 = 30_000;

/// The seed of what is tried before a render.
fn pilot_seed(seed: u64) -> u64 {
    Key::new(seed, 0, Stream::Pilot).with(u64::MAX).hash()
}

/// The photons of trials.
fn trial_photons(world: &World, config: &PpmConfig, seed: u64) -> PhotonPlan {
    let mut targets = config.mapper.targets();
    if config.plan_photons {
        for wanted in [&mut targets.global, &mut targets.caustic, &mut targets.volume] {
            *wanted = (*wanted).min(TRIAL_PHOTONS);
        }
    }
    PhotonPlan::by_pilot(world, &config.mapper.walk_settings(), &targets, seed)
}

/// What to do in each iteration.
pub(crate) fn plan(world: &World, config: &PpmConfig, seed: u64) -> (PhotonPlan, CameraPlan) {
    let tried = trial_photons(world, config, seed);
    let gathers = config.mapper.camera_plan(1).gather_rays.is_some();
    let camera = CameraPlan {
        gather_rays: gathers.then_some(1),
        neighbours: config.neighbours(&tried),
        ..CameraPlan::default()
    };
    let found = trial::trial(world, config, &tried, &camera, pilot_seed(seed));
    let window = world.scene().film.window();
    let pixels = u64::from(window.width) * u64::from(window.height);
    let variances = Variances::of(&found.pixels);
    let (factors, mut camera) = balance(&variances, found.costs, &tried, gathers, pixels);
    let photons = match config.plan_photons {
        true => tried.scaled(world, &config.mapper.walk_settings(), factors),
        false => tried,
    };
    camera.neighbours = config.neighbours(&photons);
    if let Some(samples) = config.samples_per_pixel {
        camera.samples_per_pixel = samples.max(1).next_multiple_of(camera.stride);
    }
    (photons, camera)
}

/// Guides for the gather rays of all iterations, from photons of their own: made once, for any guide is good
/// everywhere.
pub(crate) fn guides(world: &World, config: &PpmConfig, seed: u64) -> Guides {
    let turn = Turn { seed: pilot_seed(seed), iteration: 0, gathers: true, blur: Blur::WHOLE };
    let maps = Maps::build(world, &config.mapper, &trial_photons(world, config, seed), &turn, &Silent);
    maps.map_or_else(Guides::none, |maps| Guides::new(&maps.global))
}
