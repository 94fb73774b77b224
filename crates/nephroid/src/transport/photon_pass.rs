//! The photon pass: how many paths to emit, and emitting them.

use std::ops::Range;

use rayon::prelude::*;

use super::ledger::Ledger;
use super::walk::{LightChoice, MapKind, Next, PhotonKind, WalkSettings, walk};
use crate::observer::{Observer, Phase, Work};
use crate::photon_map::{Photon, Photons};
use crate::sampling::{Key, Sampler, Sequence, Stream};
use crate::world::World;

/// Paths that are traced as one piece of work. Their photons are joined in the order of the paths.
const CHUNK: u64 = 2048;

/// Pieces of work between two joinings: enough for any number of threads, and few enough that their memory is
/// soon used again.
const BATCH: usize = 128;

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
    /// Paths to emit for each map, whatever they store; overrides the targets.
    pub emit: Option<u64>,
    /// Paths emitted are at most this multiple of the target.
    pub emit_max: u64,
    /// Whether light that comes straight from a light belongs in the global map.
    pub store_direct: bool,
}

/// What a photon pass stores besides indirect light and caustics.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Extras {
    /// Light that comes straight from a light, in the global map.
    pub direct: bool,
    /// The light of caustics after one more bounce, in a map of its own.
    pub afterglow: bool,
}

/// How many paths a render emits for each map in each iteration: fixed before the first is traced,
/// so that dividing by them is exact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PhotonPlan {
    /// For the global map.
    pub global: MapPlan,
    /// For the caustic map.
    pub caustic: MapPlan,
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

/// The photons of one iteration.
#[derive(Clone, Debug)]
pub struct PhotonPass {
    /// Those of the global map.
    pub global: Photons,
    /// Those of the caustic map.
    pub caustic: Photons,
    /// Those that the paths for the caustic map stored one bounce later, if asked for.
    pub afterglow: Photons,
    /// The books of the paths for the global map, as sums over them.
    pub ledger: Ledger,
}

impl PhotonPlan {
    /// Traces trial paths, with a stream of their own, and plans for the targets.
    pub(crate) fn by_pilot(
        world: &World,
        settings: &WalkSettings,
        targets: &PhotonTargets,
        seed: u64,
    ) -> Self {
        let too_short = settings.max_photon_depth.is_some_and(|max| max < 2);
        let nothing_stored = too_short && !targets.store_direct;
        if world.lights_by_power().is_none() || nothing_stored {
            return Self::default();
        }
        let caustics = !too_short && world.has_dirac_surfaces();
        if let Some(paths) = targets.emit {
            let paths = round_up(paths, world, settings);
            let plan = |wanted| MapPlan { paths: if wanted { paths } else { 0 }, ..MapPlan::default() };
            return Self { global: plan(targets.global > 0), caustic: plan(caustics && targets.caustic > 0) };
        }
        let plan = |map, target: u64| {
            if target == 0 {
                return MapPlan::default();
            }
            let (paths, counted) = count(world, settings, map, targets.store_direct, seed);
            let most = target.saturating_mul(targets.emit_max);
            let per_path = counted as f64 / paths as f64;
            let needed = if counted == 0 { paths } else { (target as f64 / per_path).ceil() as u64 };
            let emitted = round_up(needed.min(most), world, settings);
            MapPlan {
                paths: emitted,
                expected_photons: (emitted as f64 * per_path) as u64,
                limited: needed > most || counted == 0,
            }
        };
        Self {
            global: plan(MapKind::Global, targets.global),
            caustic: plan(MapKind::Caustic, if caustics { targets.caustic } else { 0 }),
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
fn count(world: &World, settings: &WalkSettings, map: MapKind, store_direct: bool, seed: u64) -> (u64, u64) {
    let key = Key::new(seed, 0, Stream::Pilot).with(map as u64);
    let (mut paths, mut counted) = (0, 0);
    let mut batch = 4 * CHUNK;
    loop {
        let trial = |chunk| {
            let mut books = Ledger::new(world.light_count());
            let mut stored = 0;
            for path in chunk * CHUNK..(chunk + 1) * CHUNK {
                let mut sampler = Sampler::new(Sequence::Independent, key, path);
                walk(world, settings, map, path, &mut sampler, &mut books.lights, |_, kind| {
                    let (counts, next) = match (map, kind) {
                        (MapKind::Global, PhotonKind::Direct) => (store_direct, Next::Continue),
                        (MapKind::Global, kind) => (kind != PhotonKind::Caustic, Next::Continue),
                        (MapKind::Caustic, kind) => (kind == PhotonKind::Caustic, Next::Stop),
                    };
                    stored += u64::from(counts);
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

/// Emits the paths of one iteration: what photon methods build their maps of. `None` if the observer
/// cancelled.
pub fn photon_pass(
    world: &World,
    settings: &WalkSettings,
    plan: &PhotonPlan,
    extras: Extras,
    seed: u64,
    iteration: u64,
    observer: &dyn Observer,
) -> Option<PhotonPass> {
    let record = |(): &mut (), _, photon| photon;
    let pass = photon_pass_with(world, settings, plan, extras, seed, iteration, observer, record)?;
    Some(PhotonPass {
        global: Photons::new(plan.global.paths, pass.global),
        caustic: Photons::new(plan.caustic.paths, pass.caustic),
        afterglow: Photons::new(plan.caustic.paths, pass.afterglow),
        ledger: pass.ledger,
    })
}

/// What [`photon_pass_with`] stored for each map, and the books of the paths for the global map.
pub(super) struct Stored<T> {
    pub global: Vec<T>,
    pub caustic: Vec<T>,
    pub afterglow: Vec<T>,
    pub ledger: Ledger,
}

/// [`photon_pass`], storing what `record` makes of each photon. It is shown every landing of a path in turn,
/// stored or not, with the number of the path and a state that begins anew with each.
#[expect(clippy::too_many_arguments, reason = "those of `photon_pass`, and one")]
pub(super) fn photon_pass_with<H: Default, T: Send>(
    world: &World,
    settings: &WalkSettings,
    plan: &PhotonPlan,
    extras: Extras,
    seed: u64,
    iteration: u64,
    observer: &dyn Observer,
    record: impl Fn(&mut H, u64, Photon) -> T + Sync,
) -> Option<Stored<T>> {
    let work = Work::begin(observer, Phase::Photons, plan.global.paths + plan.caustic.paths);
    let job = |map, paths, key| Job { world, settings, map, paths, key, work: &work };
    let global_key = Key::new(seed, iteration, Stream::GlobalPhotons);
    let ([global, _], ledger) =
        emit(&job(MapKind::Global, plan.global.paths, global_key), &record, |kind| match kind {
            PhotonKind::Global | PhotonKind::Afterglow => (Some(0), Next::Continue),
            PhotonKind::Direct => (extras.direct.then_some(0), Next::Continue),
            PhotonKind::Caustic => (None, Next::Continue),
        })?;
    let caustic_key = Key::new(seed, iteration, Stream::CausticPhotons);
    let beyond = if extras.afterglow { Next::Continue } else { Next::Stop };
    let ([caustic, afterglow], _) =
        emit(&job(MapKind::Caustic, plan.caustic.paths, caustic_key), &record, |kind| {
            match kind {
                PhotonKind::Caustic => (Some(0), beyond),
                PhotonKind::Afterglow => (Some(1), Next::Stop),
                // Whatever else follows is the global map's.
                PhotonKind::Direct | PhotonKind::Global => (None, Next::Stop),
            }
        })?;
    Some(Stored { global, caustic, afterglow, ledger })
}

/// Paths to emit for a map.
struct Job<'a> {
    world: &'a World,
    settings: &'a WalkSettings,
    map: MapKind,
    paths: u64,
    key: Key,
    work: &'a Work<'a>,
}

/// Emits paths and stores their photons in two lists, as `keep` says.
fn emit<H: Default, T: Send>(
    job: &Job<'_>,
    record: &(impl Fn(&mut H, u64, Photon) -> T + Sync),
    keep: impl Fn(PhotonKind) -> (Option<usize>, Next) + Sync,
) -> Option<([Vec<T>; 2], Ledger)> {
    let mut photons = [Vec::new(), Vec::new()];
    let mut ledger = Ledger::new(job.world.light_count());
    let chunks = job.paths.div_ceil(CHUNK);
    let mut join = |traced: Vec<([Vec<T>; 2], Ledger)>| {
        for (stored, books) in traced {
            for (all, mut more) in photons.iter_mut().zip(stored) {
                all.append(&mut more);
            }
            ledger.append(&books);
        }
    };
    let mut before = Vec::new();
    for first in (0..chunks).step_by(BATCH) {
        let trace_batch = || {
            (first..(first + BATCH as u64).min(chunks))
                .into_par_iter()
                .map(|chunk| {
                    let range = chunk * CHUNK..((chunk + 1) * CHUNK).min(job.paths);
                    trace(job, range, record, &keep)
                })
                .collect()
        };
        // A batch is joined while the next is traced.
        let joined = std::mem::take(&mut before);
        (before, ()) = rayon::join(trace_batch, || join(joined));
        if job.work.cancelled() {
            return None;
        }
    }
    join(before);
    Some((photons, ledger))
}

/// Traces a range of paths; none if the observer cancelled.
fn trace<H: Default, T>(
    job: &Job<'_>,
    paths: Range<u64>,
    record: &impl Fn(&mut H, u64, Photon) -> T,
    keep: &(impl Fn(PhotonKind) -> (Option<usize>, Next) + Sync),
) -> ([Vec<T>; 2], Ledger) {
    let &Job { world, settings, map, key, work, .. } = job;
    let mut stored = [Vec::new(), Vec::new()];
    let mut ledger = Ledger::new(world.light_count());
    if work.cancelled() {
        return (stored, ledger);
    }
    ledger.paths = paths.end - paths.start;
    for path in paths {
        let mut sampler = Sampler::new(Sequence::Independent, key, path);
        let mut history = H::default();
        walk(world, settings, map, path, &mut sampler, &mut ledger.lights, |photon, kind| {
            let (list, next) = keep(kind);
            let recorded = record(&mut history, path, photon);
            if let Some(list) = list {
                stored[list].push(recorded);
            }
            next
        });
    }
    work.advance(ledger.paths);
    (stored, ledger)
}
