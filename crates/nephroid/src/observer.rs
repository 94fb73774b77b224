//! How a render tells what it is doing, and is told to stop. The renderer itself prints nothing and
//! reads no clock.

use std::sync::atomic::{AtomicU64, Ordering};

/// A part of a render.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Building the trees that rays go through; work is counted in primitives, each twice.
    Trees,
    /// Trial photon paths that plan the render.
    Pilot,
    /// Photon paths; work is counted in paths.
    Photons,
    /// Building the photon maps; work is counted in maps.
    Maps,
    /// Camera paths; work is counted in samples.
    Camera,
}

/// Follows a render. Called from many threads.
pub trait Observer: Sync {
    /// A phase begins that has so much work.
    fn begin(&self, _phase: Phase, _work: u64) {}

    /// So much of the work of the phase has been done.
    fn advance(&self, _phase: Phase, _done: u64) {}

    /// Whether to stop as soon as possible.
    fn cancelled(&self) -> bool {
        false
    }
}

/// Does not watch.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Observer for Silent {}

/// The work of one phase.
pub(crate) struct Work<'a> {
    observer: &'a dyn Observer,
    phase: Phase,
    done: AtomicU64,
}

impl<'a> Work<'a> {
    pub fn begin(observer: &'a dyn Observer, phase: Phase, work: u64) -> Self {
        observer.begin(phase, work);
        Self { observer, phase, done: AtomicU64::new(0) }
    }

    /// Work that nobody follows.
    pub fn silent() -> Self {
        Self { observer: &Silent, phase: Phase::Trees, done: AtomicU64::new(0) }
    }

    pub fn advance(&self, more: u64) {
        let done = self.done.fetch_add(more, Ordering::Relaxed) + more;
        self.observer.advance(self.phase, done);
    }

    pub fn cancelled(&self) -> bool {
        self.observer.cancelled()
    }
}
