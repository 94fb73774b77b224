//! Emitting photon paths: piece by piece, joined in the order of the paths.

use std::ops::Range;

use rayon::prelude::*;

use super::history::PhotonKind;
use super::ledger::Ledger;
use super::walk::{Event, MapKind, Next, WalkSettings, walk};
use crate::observer::Work;
use crate::sampling::{Key, Sampler, Sequence};
use crate::world::World;

/// Paths that are traced as one piece of work. Their photons are joined in the order of the paths.
pub(super) const CHUNK: u64 = 2048;

/// Pieces of work between two joinings: enough for any number of threads, and few enough that their memory is
/// soon used again.
const BATCH: usize = 128;

/// Paths to emit for a map.
pub(super) struct Job<'a> {
    pub world: &'a World,
    pub settings: &'a WalkSettings,
    pub map: MapKind,
    pub paths: u64,
    pub key: Key,
    pub work: &'a Work<'a>,
}

/// What becomes of an event: an item for some of two lists, and whether the path goes on.
pub(super) struct Kept<T> {
    pub item: Option<T>,
    pub lists: [bool; 2],
    pub next: Next,
}

/// Emits paths and stores in two lists what `keep` makes of their events. It is shown every event of a path in
/// turn, with the number of the path and a state that begins anew with each.
pub(super) fn emit<H: Default, T: Copy + Send>(
    job: &Job<'_>,
    keep: impl Fn(&mut H, u64, Event<'_>, PhotonKind) -> Kept<T> + Sync,
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
                    trace(job, range, &keep)
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
fn trace<H: Default, T: Copy>(
    job: &Job<'_>,
    paths: Range<u64>,
    keep: &(impl Fn(&mut H, u64, Event<'_>, PhotonKind) -> Kept<T> + Sync),
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
        let mut state = H::default();
        walk(world, settings, map, path, &mut sampler, &mut ledger.lights, |event, kind| {
            let kept = keep(&mut state, path, event, kind);
            if let Some(item) = kept.item {
                for (list, wanted) in stored.iter_mut().zip(kept.lists) {
                    if wanted {
                        list.push(item);
                    }
                }
            }
            kept.next
        });
    }
    work.advance(ledger.paths);
    (stored, ledger)
}
