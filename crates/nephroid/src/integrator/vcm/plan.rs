//! What an iteration does, found before the first.

use super::VcmConfig;
use crate::integrator::photon_mapper::CameraPlan;
use crate::observer::Observer;
use crate::photon_map::PhotonMap;
use crate::sampling::{Key, Stream};
use crate::transport::{Extras, MapPlan, PhotonPlan, PhotonTargets, photon_pass};
use crate::world::World;

/// Photons of the first iteration that are merged at a point, where they lie at their mean density.
const MERGED: u32 = 4;

/// Photons of the trial that tells how densely they lie.
const TRIAL_PHOTONS: u64 = 20_000;

/// Plans for so many camera samples of each pixel in an iteration.
pub(crate) fn plan(
    world: &World,
    config: &VcmConfig,
    seed: u64,
    observer: &dyn Observer,
) -> (PhotonPlan, CameraPlan) {
    let walks = config.mapper.walk_settings();
    let in_media = PhotonTargets { global: 0, caustic: 0, ..config.mapper.targets() };
    let mut photons = PhotonPlan::by_pilot(world, &walks, &in_media, seed);
    let mut camera = CameraPlan::plain(1);
    if world.lights_by_power().is_none() {
        return (photons, camera);
    }
    let window = world.scene().film.window();
    let pixels = u64::from(window.width) * u64::from(window.height);
    let paths = config.light_paths.unwrap_or(pixels);
    photons.global = MapPlan { paths, expected_photons: 0, limited: false };
    let targets =
        PhotonTargets { global: TRIAL_PHOTONS, caustic: 0, volume: 0, emit: None, ..config.mapper.targets() };
    let trial = PhotonPlan::by_pilot(world, &walks, &targets, seed);
    let extras = Extras::default();
    let seed = Key::new(seed, 0, Stream::Pilot).with(1).hash();
    if let Some(pass) = photon_pass(world, &walks, &trial, extras, seed, 0, observer) {
        let map: PhotonMap = PhotonMap::build(pass.global);
        let expected = map.len() as f64 / map.emitted().max(1) as f64 * paths as f64;
        photons.global.expected_photons = expected as u64;
        if expected > 0.0 {
            let closer = (map.len() as f64 / expected).sqrt() as f32;
            camera.merging_radius = map.typical_radius(MERGED) * closer;
        }
    }
    (photons, camera)
}
