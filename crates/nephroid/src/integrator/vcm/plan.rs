//! What an iteration does, found before the first.

use super::VcmConfig;
use super::light_paths::{LightPass, LightPaths};
use super::reach::{AtFirst, Density, Reach};
use super::weights::Techniques;
use crate::integrator::photon_mapper::CameraPlan;
use crate::integrator::{PpmConfig, Quiet, progressive};
use crate::observer::Observer;
use crate::sampling::{Key, Stream};
use crate::transport::{MapPlan, PhotonPlan};
use crate::world::World;

/// Photons of the first iteration that are merged at a point, where they lie at their mean density.
const MERGED: u32 = 4;

/// Light paths of an iteration at least: fewer would blur more than needs be.
const FEWEST_PATHS: u64 = 20_000;

/// And at most: they are held in memory, some hundred bytes for each vertex.
const MOST_PATHS: u64 = 1_000_000;

/// Light paths of the trial that tells how densely their photons lie: at most so many, else as many as an iteration has.
const TRIAL_PATHS: u64 = 16_384;

/// Plans what an iteration does.
pub(crate) fn plan(
    world: &World,
    config: &VcmConfig,
    seed: u64,
    observer: &dyn Observer,
) -> (PhotonPlan, CameraPlan) {
    if !world.has_media() {
        return plan_iteration(world, config, None, seed, observer);
    }
    let ppm = PpmConfig { mapper: config.in_media(), ..PpmConfig::default() };
    let (photons, camera, _) = progressive::plan(world, &ppm, seed, observer);
    plan_iteration(world, config, Some((&photons, &camera)), seed, observer)
}

/// The same, where it is known what progressive photon mapping would do.
pub(crate) fn plan_beside(
    world: &World,
    config: &VcmConfig,
    ppm: (&PhotonPlan, &CameraPlan),
    seed: u64,
    observer: &dyn Observer,
) -> (PhotonPlan, CameraPlan) {
    plan_iteration(world, config, Some(ppm), seed, observer)
}

fn plan_iteration(
    world: &World,
    config: &VcmConfig,
    beside: Option<(&PhotonPlan, &CameraPlan)>,
    seed: u64,
    observer: &dyn Observer,
) -> (PhotonPlan, CameraPlan) {
    let (mut photons, mut camera) = (PhotonPlan::default(), CameraPlan::plain(1));
    if world.lights_by_power().is_none() || config.light_paths == Some(0) {
        return (photons, camera);
    }
    let window = world.scene().film.window();
    let pixels = u64::from(window.width) * u64::from(window.height);
    let paths = config.light_paths.unwrap_or((pixels / 4).clamp(FEWEST_PATHS, MOST_PATHS));
    camera.samples_per_pixel = (2 * paths / pixels).clamp(1, 16) as u32;
    if let Some((planned, of_ppm)) = beside {
        photons = in_media(world, config, planned, of_ppm, &camera);
    }
    photons.global = MapPlan { paths, ..MapPlan::default() };
    let (density, stored) = density(world, config, paths, seed, observer);
    photons.global.expected_photons = stored;
    camera.merging_radius = density.typical();
    (photons, camera)
}

/// As many photons in media for each camera sample as progressive photon mapping has.
fn in_media(
    world: &World,
    config: &VcmConfig,
    planned: &PhotonPlan,
    of_ppm: &CameraPlan,
    camera: &CameraPlan,
) -> PhotonPlan {
    let share = f64::from(camera.samples_per_pixel) / f64::from(of_ppm.samples_per_pixel);
    let scaled = planned.scaled(world, &config.in_media().walk_settings(), [1.0, 1.0, share, share]);
    PhotonPlan { global: MapPlan::default(), caustic: MapPlan::default(), ..scaled }
}

/// How densely the photons of so many light paths lie, and how many there are, as a trial tells.
pub(crate) fn density(
    world: &World,
    config: &VcmConfig,
    paths: u64,
    seed: u64,
    observer: &dyn Observer,
) -> (Density, u64) {
    let seed = Key::new(seed, 0, Stream::Pilot).with(1).hash();
    let pass = LightPass {
        seed,
        iteration: 0,
        paths: paths.min(TRIAL_PATHS),
        max_depth: config.mapper.max_depth,
        watched: false,
    };
    let everything = Techniques {
        reach: Reach { radius: 0.0, paths: 1.0 },
        to_lens: 0.0,
        connects: false,
        correlation: false,
    };
    let nothing = Density::new(&[], MERGED, 1.0);
    if paths == 0 {
        return (nothing, 0);
    }
    let more = paths as f32 / pass.paths as f32;
    let at_first = AtFirst { density: &nothing, factor: 1.0 };
    let Some(trial) = LightPaths::trace(world, &pass, &everything, at_first, &Quiet(observer)) else {
        return (nothing, 0);
    };
    let stored = (trial.photon_count() as f32 * more) as u64;
    (Density::new(&trial.places(), MERGED, more), stored)
}
