//! How many photon paths to emit for each map: found by trial paths.

use rayon::prelude::*;

use super::emit::CHUNK;
use super::history::PhotonKind;
use super::ledger::Ledger;
use super::walk::{Event, Fog, LightChoice, MapKind, Next, WalkSettings, walk};
use crate::sampling::{Key, Sampler, Sequence, Stream};
use crate::world::World;

/// The pilot goes on until it has counted so many photons for each map, which tells their number per
/// path to 3 %…
const PILOT_PHOTONS: u64 = 1024;
/// … or has traced so many paths. If these bring nothing, no more are emitted: any number is unbiased.
const PILOT_PATHS: u64 = 1 << 18;

/// How many photons are wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhotonTargets {
    /// Photons in the global map.
    pub global: u64,
    /// Photons in the caustic map.
    pub caustic: u64,
    /// Photons in each of the maps of light in media.
    pub volume: u64,
    /// What these hold.
    pub volume_kind: VolumeKind,
    /// Paths to emit for each map, whatever they store; overrides the targets.
    pub emit: Option<u64>,
    /// Paths emitted are at most this multiple of the target.
    pub emit_max: u64,
    /// Whether light that comes straight from a light belongs in the global map.
    pub store_direct: bool,
    /// Whether light that comes straight from a light belongs in the map of the volume.
    pub store_single_scatter: bool,
}

/// What maps of light in media hold.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum VolumeKind {
    /// Photons where they collided (Jensen and Christensen 1998).
    #[default]
    Points,
    /// The ways that photons went (Jarosz et al. 2011).
    Beams,
}

/// How many paths a render emits for each map in each iteration: fixed before the first is traced,
/// so that dividing by them is exact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PhotonPlan {
    /// For the global map.
    pub global: MapPlan,
    /// For the caustic map.
    pub caustic: MapPlan,
    /// For the map of light in media.
    pub volume: MapPlan,
    /// For that of light in media that comes from specular surfaces.
    pub volume_caustic: MapPlan,
}

/// The paths for one map.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MapPlan {
    /// Paths to emit.
    pub paths: u64,
    /// Photons the pilot expects them to store.
    pub expected_photons: u64,
    /// Whether the limit on emission made the map thinner than asked for.
    pub limited: bool,
}

/// What a stored photon costs in rays besides those of its path: it is encoded, sorted and indexed.
const STORED_COST: f64 = 1.0;

impl MapPlan {
    /// What its photons cost in rays.
    pub(crate) fn rays(&self) -> f64 {
        let stored = self.expected_photons as f64;
        if stored > 0.0 { 2.0 * self.paths as f64 + (1.0 + STORED_COST) * stored } else { 0.0 }
    }
}

impl PhotonPlan {
    /// Traces trial paths, with a stream of their own, and plans for the targets.
    pub(crate) fn by_pilot(
        world: &World,
        settings: &WalkSettings,
        targets: &PhotonTargets,
        seed: u64,
    ) -> Self {
        if world.lights_by_power().is_none() {
            return Self::default();
        }
        let too_short = settings.max_photon_depth.is_some_and(|max| max < 2);
        // Light of media makes no caustics, and is indirect from the start.
        let specular = !too_short && world.has_specular_surfaces() && world.has_lights_to_ask();
        let short_enough = !too_short || world.glows();
        let volume = world.has_media() && settings.fog == Fog::Volume;
        let plan = |map| {
            let (wanted, possible) = match map {
                MapKind::Global => (targets.global, short_enough || targets.store_direct),
                MapKind::Caustic => (targets.caustic, specular),
                MapKind::Volume => (targets.volume, volume && (short_enough || targets.store_single_scatter)),
                MapKind::VolumeCaustic => (targets.volume, volume && specular),
            };
            if wanted == 0 || !possible {
                return MapPlan::default();
            }
            if let Some(paths) = targets.emit {
                return MapPlan { paths: round_up(paths, world, settings), ..MapPlan::default() };
            }
            let (paths, counted) = count(world, settings, map, targets, seed);
            let most = wanted.saturating_mul(targets.emit_max);
            let per_path = counted as f64 / paths as f64;
            let needed = if counted == 0 { paths } else { (wanted as f64 / per_path).ceil() as u64 };
            let emitted = round_up(needed.min(most), world, settings);
            MapPlan {
                paths: emitted,
                expected_photons: (emitted as f64 * per_path) as u64,
                limited: needed > most || counted == 0,
            }
        };
        Self {
            global: plan(MapKind::Global),
            caustic: plan(MapKind::Caustic),
            volume: plan(MapKind::Volume),
            volume_caustic: plan(MapKind::VolumeCaustic),
        }
    }
}

impl PhotonPlan {
    /// Photons that all maps together are expected to hold.
    pub(crate) fn expected_photons(&self) -> u64 {
        let maps = [self.global, self.caustic, self.volume, self.volume_caustic];
        maps.iter().map(|map| map.expected_photons).sum()
    }

    /// A plan for so many times the photons of each map: the global, the caustic, the volume and its caustic one.
    pub(crate) fn scaled(&self, world: &World, settings: &WalkSettings, factors: [f64; 4]) -> Self {
        let scale = |map: &MapPlan, factor: f64| {
            let paths = round_up((map.paths as f64 * factor).ceil() as u64, world, settings);
            let expected = map.expected_photons as f64 * paths as f64 / map.paths.max(1) as f64;
            MapPlan { paths, expected_photons: expected as u64, ..*map }
        };
        Self {
            global: scale(&self.global, factors[0]),
            caustic: scale(&self.caustic, factors[1]),
            volume: scale(&self.volume, factors[2]),
            volume_caustic: scale(&self.volume_caustic, factors[3]),
        }
    }
}

/// Gives every light the same number of paths where that was asked for.
fn round_up(paths: u64, world: &World, settings: &WalkSettings) -> u64 {
    match settings.light_choice {
        LightChoice::Power => paths,
        LightChoice::Equal => paths.next_multiple_of(world.light_count().max(1) as u64),
    }
}

/// Trial paths for a map: how many were traced, and how many photons they would have stored.
fn count(
    world: &World,
    settings: &WalkSettings,
    map: MapKind,
    targets: &PhotonTargets,
    seed: u64,
) -> (u64, u64) {
    let key = Key::new(seed, 0, Stream::Pilot).with(map as u64);
    let (mut paths, mut counted) = (0, 0);
    let mut batch = 4 * CHUNK;
    loop {
        let trial = |chunk| {
            let mut books = Ledger::new(world.light_count());
            let mut stored = 0;
            for path in chunk * CHUNK..(chunk + 1) * CHUNK {
                let mut sampler = Sampler::new(Sequence::Independent, key, path);
                walk(world, settings, map, path, &mut sampler, &mut books.lights, |event, kind| {
                    let (counts, next) = tried(map, targets, &event, kind);
                    stored += u64::from(counts && is_read(world, &event, kind));
                    next
                });
            }
            stored
        };
        let chunks = paths / CHUNK..(paths + batch) / CHUNK;
        counted += chunks.into_par_iter().map(trial).sum::<u64>();
        paths += batch;
        if counted >= PILOT_PHOTONS || paths >= PILOT_PATHS {
            return (paths, counted);
        }
        batch = paths;
    }
}

/// Whether a trial path's event would be stored, and whether another may be.
fn tried(map: MapKind, targets: &PhotonTargets, event: &Event<'_>, kind: PhotonKind) -> (bool, Next) {
    match map {
        MapKind::Global => {
            let counts = match kind {
                PhotonKind::Direct => targets.store_direct,
                kind => kind != PhotonKind::Caustic,
            };
            (counts && matches!(event, Event::Surface(..)), Next::Continue)
        }
        MapKind::Caustic => match event {
            Event::Surface(..) => (kind == PhotonKind::Caustic, after_caustic(event)),
            Event::Collision(..) | Event::Bounce(..) => (false, after_caustic(event)),
            Event::Start(_) | Event::Way(_) => (false, Next::Continue),
        },
        MapKind::Volume | MapKind::VolumeCaustic => stored_in_volume(map, targets, event, kind),
    }
}

/// Whether anything reads a photon: surfaces without a broad lobe are followed, not estimated at, but for the light of Dirac
/// lamps that came by specular surfaces, which no ray finds.
pub(super) fn is_read(world: &World, event: &Event<'_>, kind: PhotonKind) -> bool {
    match event {
        Event::Surface(photon, lit) => {
            let is_dirac = || world.emitters()[photon.light as usize].is_dirac();
            lit.gathers() || (kind == PhotonKind::Caustic && is_dirac())
        }
        _ => true,
    }
}

/// Whether a path goes on that is to make a caustic, after light met a surface or was scattered: only by lobes that are
/// specular, for whatever follows others is no caustic.
pub(super) fn after_caustic(event: &Event<'_>) -> Next {
    let goes_on = match event {
        Event::Surface(_, lit) => lit.has_specular(),
        Event::Bounce(_, bounce) => bounce.specular,
        Event::Collision(..) => false,
        Event::Start(_) | Event::Way(_) => true,
    };
    if goes_on { Next::Continue } else { Next::Stop }
}

/// Whether an event belongs in a map of light in media, and whether another of its path may.
pub(super) fn stored_in_volume(
    map: MapKind,
    targets: &PhotonTargets,
    event: &Event<'_>,
    kind: PhotonKind,
) -> (bool, Next) {
    let fits = match event {
        Event::Start(_) | Event::Surface(..) | Event::Bounce(..) => false,
        Event::Collision(..) => targets.volume_kind == VolumeKind::Points,
        Event::Way(_) => targets.volume_kind == VolumeKind::Beams,
    };
    if map == MapKind::Volume {
        let belongs = match kind {
            PhotonKind::Direct => targets.store_single_scatter,
            kind => kind != PhotonKind::Caustic,
        };
        return (fits && belongs, Next::Continue);
    }
    match (event, kind) {
        (Event::Surface(..) | Event::Bounce(..), _) => (false, after_caustic(event)),
        (Event::Collision(..), kind) => (fits && kind == PhotonKind::Caustic, Next::Stop),
        (Event::Start(_), _) => (false, Next::Continue),
        (Event::Way(_), kind) => (fits && kind == PhotonKind::Caustic, Next::Continue),
    }
}
