use super::index::{Item, NearestList, PhotonIndex};
use crate::math::{Bounds, Vec3};

/// An index that looks at every point: the oracle of the others, for tests and tiny maps.
#[derive(Clone, Debug, PartialEq)]
pub struct BruteForce {
    positions: Vec<Vec3>,
}

impl PhotonIndex for BruteForce {
    fn build_with<T: Item>(len: usize, point: impl Fn(usize) -> (Vec3, T) + Sync) -> (Self, Vec<T>) {
        assert!(u32::try_from(len).is_ok(), "an index holds fewer than 2^32 photons, not {len}");
        let (positions, items) = (0..len).map(point).unzip();
        (Self { positions }, items)
    }

    fn len(&self) -> usize {
        self.positions.len()
    }

    fn position(&self, place: u32) -> Vec3 {
        self.positions[place as usize]
    }

    fn bounds(&self) -> Bounds {
        Bounds::of(self.positions.iter().copied())
    }

    fn memory_bytes(&self) -> usize {
        size_of_val(self.positions.as_slice())
    }

    fn for_each_within(&self, center: Vec3, radius_sq: f32, mut visit: impl FnMut(u32, f32)) {
        for (place, p) in (0u32..).zip(&self.positions) {
            let dist_sq = p.distance_squared(center);
            if dist_sq <= radius_sq {
                visit(place, dist_sq);
            }
        }
    }

    fn nearest(
        &self,
        center: Vec3,
        max_radius_sq: f32,
        k: usize,
        mut measure: impl FnMut(u32, f32) -> Option<f32>,
        found: &mut NearestList,
    ) {
        found.start(usize::MAX, max_radius_sq);
        self.for_each_within(center, max_radius_sq, |place, dist_sq| {
            if let Some(d) = measure(place, dist_sq).filter(|d| *d <= max_radius_sq) {
                found.offer(place, d);
            }
        });
        found.finish();
        found.truncate(k);
    }
}
