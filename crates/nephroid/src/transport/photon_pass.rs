//! The photon pass: the photons of one iteration, for each map by paths of its own.

use super::emit::{Job, Kept, emit};
use super::history::PhotonKind;
use super::ledger::Ledger;
use super::plan::{PhotonPlan, PhotonTargets, VolumeKind, after_caustic, is_read, stored_in_volume};
use super::walk::{Event, MapKind, Next, WalkSettings};
use crate::observer::{Observer, Phase, Work};
use crate::photon_map::{Beams, Photons, VolumePhotons};
use crate::sampling::{Key, Stream};
use crate::world::World;

/// What a photon pass stores besides indirect light and caustics on surfaces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Extras {
    /// Light that comes straight from a light, in the global map.
    pub direct: bool,
    /// What gather rays do not bring, in maps of its own: the light of caustics after one more bounce, and that
    /// which comes to surfaces from media.
    pub unseen: bool,
}

/// The photons of one iteration.
#[derive(Clone, Debug)]
pub struct PhotonPass {
    /// Those of the global map.
    pub global: Photons,
    /// Those of the caustic map.
    pub caustic: Photons,
    /// Those that the paths for the caustic map stored one bounce later, if asked for.
    pub afterglow: Photons,
    /// Those of the global map that came to where they lie from a medium, if asked for.
    pub haze: Photons,
    /// The books of the paths for the global map, as sums over them.
    pub ledger: Ledger,
}

/// The photons of one iteration in media.
#[derive(Clone, Debug, PartialEq)]
pub enum InMedia {
    /// Where photons collided.
    Points(VolumePhotons),
    /// The ways that they went.
    Beams(Beams),
}

/// Emits the paths of one iteration that end on surfaces: what photon methods build their maps of. `None` if the
/// observer cancelled.
pub fn photon_pass(
    world: &World,
    settings: &WalkSettings,
    plan: &PhotonPlan,
    extras: Extras,
    seed: u64,
    iteration: u64,
    observer: &dyn Observer,
) -> Option<PhotonPass> {
    let record = |(): &mut (), _, event: Event<'_>| match event {
        Event::Surface(photon, _) => Some(photon),
        Event::Start(_) | Event::Collision(..) | Event::Way(_) | Event::Bounce(..) => None,
    };
    let pass = photon_pass_with(world, settings, plan, extras, seed, iteration, observer, record)?;
    Some(PhotonPass {
        global: Photons::new(plan.global.paths, pass.global),
        caustic: Photons::new(plan.caustic.paths, pass.caustic),
        afterglow: Photons::new(plan.caustic.paths, pass.afterglow),
        haze: Photons::new(plan.global.paths, pass.haze),
        ledger: pass.ledger,
    })
}

/// Emits the paths of one iteration that are stored in media: those of all light but caustics, and those of
/// caustics. `None` if the observer cancelled.
pub fn volume_pass(
    world: &World,
    settings: &WalkSettings,
    plan: &PhotonPlan,
    targets: &PhotonTargets,
    seed: u64,
    iteration: u64,
    observer: &dyn Observer,
) -> Option<[InMedia; 2]> {
    let paths = [plan.volume.paths, plan.volume_caustic.paths];
    match targets.volume_kind {
        VolumeKind::Points => {
            let record = |(): &mut (), _, event: Event<'_>| match event {
                Event::Collision(photon, _) => Some(photon),
                Event::Start(_) | Event::Surface(..) | Event::Way(_) | Event::Bounce(..) => None,
            };
            let lists = volume_pass_with(world, settings, plan, targets, seed, iteration, observer, record)?;
            let [all, caustics] = lists;
            Some(
                [VolumePhotons::new(paths[0], all), VolumePhotons::new(paths[1], caustics)]
                    .map(InMedia::Points),
            )
        }
        VolumeKind::Beams => {
            let record = |(): &mut (), _, event: Event<'_>| match event {
                Event::Way(beam) => Some(beam),
                Event::Start(_) | Event::Surface(..) | Event::Collision(..) | Event::Bounce(..) => None,
            };
            let lists = volume_pass_with(world, settings, plan, targets, seed, iteration, observer, record)?;
            let [all, caustics] = lists;
            Some([Beams::new(paths[0], all), Beams::new(paths[1], caustics)].map(InMedia::Beams))
        }
    }
}

/// [`volume_pass`], storing what `record` makes of each event, as [`photon_pass_with`] does: the list for all light
/// but caustics, and that for caustics.
#[expect(clippy::too_many_arguments, reason = "those of `volume_pass`, and one")]
pub(super) fn volume_pass_with<H: Default, T: Copy + Send>(
    world: &World,
    settings: &WalkSettings,
    plan: &PhotonPlan,
    targets: &PhotonTargets,
    seed: u64,
    iteration: u64,
    observer: &dyn Observer,
    record: impl Fn(&mut H, u64, Event<'_>) -> Option<T> + Sync,
) -> Option<[Vec<T>; 2]> {
    if plan.volume.paths + plan.volume_caustic.paths == 0 {
        return Some([Vec::new(), Vec::new()]);
    }
    let work = Work::begin(observer, Phase::Photons, plan.volume.paths + plan.volume_caustic.paths);
    let pass = |map, paths, stream| {
        let job = Job { world, settings, map, paths, key: Key::new(seed, iteration, stream), work: &work };
        let ([stored, _], _) = emit(&job, |state, path, event, kind| {
            let (belongs, next) = stored_in_volume(map, targets, &event, kind);
            Kept { item: record(state, path, event), lists: [belongs, false], next }
        })?;
        Some(stored)
    };
    let volume = pass(MapKind::Volume, plan.volume.paths, Stream::VolumePhotons)?;
    let caustic = pass(MapKind::VolumeCaustic, plan.volume_caustic.paths, Stream::VolumeCausticPhotons)?;
    Some([volume, caustic])
}

/// What [`photon_pass_with`] stored for each map, and the books of the paths for the global map.
pub(super) struct Stored<T> {
    pub global: Vec<T>,
    pub caustic: Vec<T>,
    pub afterglow: Vec<T>,
    pub haze: Vec<T>,
    pub ledger: Ledger,
}

/// [`photon_pass`], storing what `record` makes of each event. It is shown every event of a path in turn,
/// stored or not, with the number of the path and a state that begins anew with each.
#[expect(clippy::too_many_arguments, reason = "those of `photon_pass`, and one")]
pub(super) fn photon_pass_with<H: Default, T: Copy + Send>(
    world: &World,
    settings: &WalkSettings,
    plan: &PhotonPlan,
    extras: Extras,
    seed: u64,
    iteration: u64,
    observer: &dyn Observer,
    record: impl Fn(&mut H, u64, Event<'_>) -> Option<T> + Sync,
) -> Option<Stored<T>> {
    let work = Work::begin(observer, Phase::Photons, plan.global.paths + plan.caustic.paths);
    let job = |map, paths, key| Job { world, settings, map, paths, key, work: &work };
    let global_key = Key::new(seed, iteration, Stream::GlobalPhotons);
    let global_job = job(MapKind::Global, plan.global.paths, global_key);
    let ([global, haze], ledger) = emit(&global_job, |state, path, event, kind| {
        let lists = match kind {
            PhotonKind::Global | PhotonKind::Afterglow => [true, false],
            PhotonKind::Haze => [true, extras.unseen],
            PhotonKind::Direct => [extras.direct, false],
            PhotonKind::Caustic => [false, false],
        };
        let lists = if is_read(world, &event, kind) { lists } else { [false, false] };
        Kept { item: record(state, path, event), lists, next: Next::Continue }
    })?;
    let caustic_key = Key::new(seed, iteration, Stream::CausticPhotons);
    let caustic_job = job(MapKind::Caustic, plan.caustic.paths, caustic_key);
    let ([caustic, afterglow], _) = emit(&caustic_job, |state, path, event, kind| {
        let (lists, next) = match (&event, kind) {
            (Event::Start(_) | Event::Way(_), _) => ([false, false], Next::Continue),
            (Event::Bounce(..), PhotonKind::Caustic) if extras.unseen => ([false, false], Next::Continue),
            // Whatever follows is the global map's.
            (Event::Bounce(..) | Event::Collision(..), _) => ([false, false], after_caustic(&event)),
            (_, PhotonKind::Caustic) if extras.unseen => ([true, false], Next::Continue),
            (_, PhotonKind::Caustic) => ([true, false], after_caustic(&event)),
            (_, PhotonKind::Afterglow) => ([false, true], after_caustic(&event)),
            (_, PhotonKind::Direct) => ([false, false], after_caustic(&event)),
            (_, PhotonKind::Haze | PhotonKind::Global) => ([false, false], Next::Stop),
        };
        let lists = if is_read(world, &event, kind) { lists } else { [false, false] };
        Kept { item: record(state, path, event), lists, next }
    })?;
    Some(Stored { global, caustic, afterglow, haze, ledger })
}
