//! The photons that the maps of an iteration hold.

use crate::integrator::{MapName, PhotonMapperConfig, Turn};
use crate::math::Vec3;
use crate::observer::Observer;
use crate::photon_map::{Photon, VolumePhoton};
use crate::session::{RenderPlan, RenderSettings};
use crate::transport::{
    Bounces, PhotonPlan, RecordedPass, RecordedPhoton, record_photon_pass, record_volume_pass,
};
use crate::world::World;

/// A photon of a map, with what is known of its path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapPhoton {
    /// Where it landed, and its share of the light's power in W: divided by the paths emitted for its map. In a
    /// medium the power is what is scattered there, and the normal is zero.
    pub photon: Photon,
    /// The map that holds it.
    pub map: MapName,
    /// The number of its path among those emitted for the map.
    pub path: u64,
    /// What its path met before.
    pub bounces: Bounces,
}

/// The photons of one iteration.
#[derive(Clone, Debug, PartialEq)]
pub struct MapPhotons {
    /// By map, and within a map by path.
    pub photons: Vec<MapPhoton>,
    /// Paths that were planned for each map, and whether the limit on emission made it thin.
    pub plan: PhotonPlan,
}

/// Traces the photons that iteration `iteration` of a render with these settings has in its maps; none for methods
/// without photons. Beams in media are left out. `None` if the observer cancelled.
pub fn record_photons(
    world: &World,
    settings: &RenderSettings,
    iteration: u64,
    observer: &dyn Observer,
) -> Option<MapPhotons> {
    let render = RenderPlan::new(world, settings, observer);
    let (plan, method) = (render.photons, render.method(world, &settings.method));
    let Some(config) = method.mapper() else {
        return Some(MapPhotons { photons: Vec::new(), plan });
    };
    let turn = Turn::new(&method, &render.camera, settings.seed, iteration);
    let pass = record(world, config, &plan, &turn, observer)?;
    let (walks, targets) = (config.walk_settings(), config.targets());
    let media = record_volume_pass(world, &walks, &plan, &targets, turn.seed, iteration, observer)?;
    let volume: Vec<_> = media.volume.into_iter().map(anywhere).collect();
    let volume_caustic = media.volume_caustic.into_iter().map(anywhere).collect();
    let lists = [
        (MapName::Global, pass.global, pass.global_paths),
        (MapName::Caustic, pass.caustic, pass.caustic_paths),
        (MapName::Afterglow, pass.afterglow, pass.caustic_paths),
        (MapName::Haze, pass.haze, pass.global_paths),
        (MapName::Volume, volume, media.volume_paths),
        (MapName::VolumeCaustic, volume_caustic, media.volume_caustic_paths),
    ];
    let mut photons = Vec::new();
    for (map, list, paths) in lists {
        // As `PhotonMap::build` divides.
        let share = (1.0 / paths.max(1) as f64) as f32;
        photons.extend(list.into_iter().map(|RecordedPhoton { photon, path, bounces }| {
            let photon = Photon { power: photon.power * share, ..photon };
            MapPhoton { photon, map, path, bounces }
        }));
    }
    Some(MapPhotons { photons, plan })
}

/// A photon in a medium as one on a surface would be, without a normal.
fn anywhere(recorded: RecordedPhoton<VolumePhoton>) -> RecordedPhoton {
    let RecordedPhoton { photon, path, bounces } = recorded;
    let VolumePhoton { position, power, wi, depth, light, .. } = photon;
    RecordedPhoton { photon: Photon { position, power, wi, normal: Vec3::ZERO, depth, light }, path, bounces }
}

/// The photon pass that a session makes, recorded.
pub(super) fn record(
    world: &World,
    config: &PhotonMapperConfig,
    plan: &PhotonPlan,
    turn: &Turn,
    observer: &dyn Observer,
) -> Option<RecordedPass> {
    let (settings, extras) = (config.walk_settings(), config.extras(turn.gathers));
    record_photon_pass(world, &settings, plan, extras, turn.seed, turn.iteration, observer)
}
