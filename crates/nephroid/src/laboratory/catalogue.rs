//! From a photon of a map back to its path.

use rayon::prelude::*;

use crate::photon_map::{Photon, PhotonMap, Photons};
use crate::transport::RecordedPhoton;

/// A map with the records of its photons.
pub(super) struct Catalogue {
    records: Vec<RecordedPhoton>,
    /// What identifies each photon of the map, and its number among the records; sorted.
    keys: Vec<(Key, u32)>,
}

/// The bits of a photon's place, direction and power, as the map hands it out. Two photons that agree in
/// all of them count the same in every estimate.
type Key = [u32; 9];

fn key(photon: &Photon) -> Key {
    let Photon { position: p, wi, power, .. } = photon;
    [p.x, p.y, p.z, wi.x, wi.y, wi.z, power.r, power.g, power.b].map(f32::to_bits)
}

impl Catalogue {
    /// Builds the map of the photons that `paths` paths stored.
    pub fn build(records: Vec<RecordedPhoton>, paths: u64) -> (PhotonMap, Self) {
        let photons = Photons::new(paths, records.iter().map(|r| r.photon).collect());
        let (map, order) = PhotonMap::build_ordered(photons);
        let mut keys: Vec<_> = (0..).zip(order).map(|(place, n)| (key(&map.photon(place)), n)).collect();
        keys.par_sort_unstable();
        (map, Self { records, keys })
    }

    /// The record of a photon that the map handed out.
    pub fn find(&self, photon: &Photon) -> Option<&RecordedPhoton> {
        let wanted = key(photon);
        let first = self.keys.partition_point(|(key, _)| *key < wanted);
        self.keys.get(first).filter(|(key, _)| *key == wanted).map(|(_, n)| &self.records[*n as usize])
    }
}
