//! What a render did so far.

use super::RenderPlan;
use crate::integrator::{MapTotals, Maps, PictureSums};
use crate::transport::Ledger;

/// What a render did so far.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Statistics {
    /// Paths emitted and photons stored for the global map, over all iterations.
    pub global: MapStatistics,
    /// The same for the caustic map.
    pub caustic: MapStatistics,
    /// The same for the map of light in media, which holds photons or beams.
    pub volume: MapStatistics,
    /// The same for that of caustics in media.
    pub volume_caustic: MapStatistics,
    /// What is done in each iteration.
    pub plan: RenderPlan,
    /// Where the power of each light went, in W, mean over the iterations; no lights where no photon
    /// was traced.
    pub ledger: Ledger,
    /// The picture's light by kind.
    pub picture: PictureSums,
    /// Iterations begun.
    pub iterations: u64,
    /// Camera samples taken of each pixel.
    pub samples_per_pixel: u64,
}

/// One map's numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MapStatistics {
    /// Paths emitted.
    pub paths: u64,
    /// Photons stored.
    pub photons: u64,
    /// Bytes of the current map.
    pub bytes: u64,
}

impl Statistics {
    /// Takes new maps in. `ledger` has the sums over all of them.
    pub(super) fn count(&mut self, maps: &Maps, ledger: &mut Ledger) {
        for (numbers, map) in [(&mut self.global, &maps.global), (&mut self.caustic, &maps.caustic)] {
            numbers.add(map.emitted(), map.len(), map.memory_bytes());
        }
        self.count_volumes(maps);
        self.add_ledger(&maps.ledger, ledger);
    }

    /// Takes new maps of light in media in.
    pub(super) fn count_volumes(&mut self, maps: &Maps) {
        for (numbers, map) in [&mut self.volume, &mut self.volume_caustic].into_iter().zip(&maps.volumes) {
            numbers.add(map.emitted(), map.len(), map.memory_bytes());
        }
    }

    /// Takes new light paths in, which are counted as a global map's.
    pub(super) fn count_paths(&mut self, new: &MapTotals, books: &Ledger, ledger: &mut Ledger) {
        self.global.add(new.paths, new.photons, new.bytes);
        self.add_ledger(books, ledger);
    }

    fn add_ledger(&mut self, books: &Ledger, ledger: &mut Ledger) {
        if ledger.lights.is_empty() {
            *ledger = Ledger::new(books.lights.len());
        }
        ledger.append(books);
        self.ledger = ledger.per_path();
    }
}

impl MapStatistics {
    fn add(&mut self, paths: u64, photons: usize, bytes: usize) {
        self.paths += paths;
        self.photons += photons as u64;
        self.bytes = bytes as u64;
    }
}
