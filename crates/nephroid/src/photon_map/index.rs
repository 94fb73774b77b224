use crate::math::{Bounds, Vec3};

/// What an index arranges along with the points.
pub trait Item: Copy + Default + Send + Sync {}

impl<T: Copy + Default + Send + Sync> Item for T {}

/// Finds the photons near a point. Knows positions only.
///
/// An index arranges the photons in an order of its own; all its methods speak of a photon by its
/// place in that order. Positions must be finite. Squared distances are `(dx² + dy²) + dz²` in
/// single precision, so that all indices agree on them to the bit.
pub trait PhotonIndex: Sized + Sync {
    /// Arranges `len` points; returns the index and, for each place, the number of the point there.
    ///
    /// Panics with 2³² points or more.
    fn build(len: usize, position: impl Fn(usize) -> Vec3 + Sync) -> (Self, Vec<u32>) {
        Self::build_with(len, |i| (position(i), i as u32))
    }

    /// Arranges `len` points, each of which has an item; returns the index and the items by place.
    ///
    /// Panics with 2³² points or more.
    fn build_with<T: Item>(len: usize, point: impl Fn(usize) -> (Vec3, T) + Sync) -> (Self, Vec<T>);

    /// How many points.
    fn len(&self) -> usize;

    /// Whether there are none.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The point at a place below [`Self::len`].
    fn position(&self, place: u32) -> Vec3;

    /// The smallest box around the points.
    fn bounds(&self) -> Bounds;

    /// Bytes of heap memory.
    fn memory_bytes(&self) -> usize;

    /// Calls `visit(place, dist_sq)` for each point with `dist_sq <= radius_sq`, by increasing place.
    fn for_each_within(&self, center: Vec3, radius_sq: f32, visit: impl FnMut(u32, f32));

    /// Finds the `k` nearest points within `max_radius_sq` and leaves them in `found`, sorted by
    /// distance and, among equals, by place.
    ///
    /// `measure(place, dist_sq)` refuses a point with `None`, as if it were not there, or gives the
    /// squared distance to rank it by, which must not be less than `dist_sq` (just that for the
    /// ordinary search).
    fn nearest(
        &self,
        center: Vec3,
        max_radius_sq: f32,
        k: usize,
        measure: impl FnMut(u32, f32) -> Option<f32>,
        found: &mut NearestList,
    );
}

/// A point found by a search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Neighbor {
    /// Its place in the index.
    pub place: u32,
    /// Its squared distance, as ranked.
    pub dist_sq: f32,
}

/// The nearest points found so far. Points are only noted down, and now and then all but the nearest k
/// are struck off the list: cheaper than a heap, which has each of them in its place at any time. Make
/// one per thread and use it for all searches: it keeps its memory.
#[derive(Clone, Debug, Default)]
pub struct NearestList {
    /// Distance in the upper half, place in the lower: floats that are not negative are ordered like
    /// their bits, so one comparison of integers ranks by distance, then place.
    keys: Vec<u64>,
    k: usize,
    /// At so many all but k are struck off.
    full: usize,
    /// No point farther than this can enter.
    bound_sq: f32,
    /// Nodes that a search has yet to visit, with their squared distances.
    waiting: Vec<(f32, u32)>,
}

impl NearestList {
    /// An empty one.
    pub fn new() -> Self {
        Self::default()
    }

    /// How many were found.
    pub fn len(&self) -> usize {
        self.keys.len()
    }

    /// Whether none was found.
    pub fn is_empty(&self) -> bool {
        self.keys.is_empty()
    }

    /// The `i`-th nearest, from 0.
    #[inline]
    pub fn get(&self, i: usize) -> Option<Neighbor> {
        self.keys.get(i).map(|&key| unpack(key))
    }

    /// From the nearest to the farthest.
    #[inline]
    pub fn iter(&self) -> impl ExactSizeIterator<Item = Neighbor> {
        self.keys.iter().map(|&key| unpack(key))
    }

    /// Starts a search.
    pub(super) fn start(&mut self, k: usize, max_radius_sq: f32) {
        self.keys.clear();
        self.k = k;
        self.full = k.saturating_mul(3).saturating_add(64);
        self.bound_sq = if k == 0 { -1.0 } else { max_radius_sq };
    }

    /// No point farther than this can enter any more.
    #[inline]
    pub(super) fn bound_sq(&self) -> f32 {
        self.bound_sq
    }

    /// Offers a point.
    #[inline(always)]
    pub(super) fn offer(&mut self, place: u32, dist_sq: f32) {
        if dist_sq <= self.bound_sq {
            self.keys.push(pack(place, dist_sq));
            if self.keys.len() == self.full {
                self.strike_off();
                self.bound_sq = self.keys.last().map_or(self.bound_sq, |&key| unpack(key).dist_sq);
            }
        }
    }

    /// How many of the points noted down are within a squared distance.
    pub(super) fn count_within(&self, dist_sq: f32) -> usize {
        self.keys.iter().filter(|&&key| unpack(key).dist_sq <= dist_sq).count()
    }

    /// Ends a search.
    pub(super) fn finish(&mut self) {
        self.strike_off();
        self.keys.sort_unstable();
    }

    /// Keeps the `k` nearest of an ended search.
    pub(super) fn truncate(&mut self, k: usize) {
        self.keys.truncate(k);
    }

    /// The list of nodes to visit, empty; to be given back.
    pub(super) fn take_waiting(&mut self) -> Vec<(f32, u32)> {
        let mut waiting = std::mem::take(&mut self.waiting);
        waiting.clear();
        waiting
    }

    /// See [`Self::take_waiting`].
    pub(super) fn give_waiting(&mut self, waiting: Vec<(f32, u32)>) {
        self.waiting = waiting;
    }

    /// Keeps the nearest k, of which the last is the farthest.
    #[cold]
    fn strike_off(&mut self) {
        if self.keys.len() > self.k {
            self.keys.select_nth_unstable(self.k - 1);
            self.keys.truncate(self.k);
        }
    }
}

#[inline]
fn pack(place: u32, dist_sq: f32) -> u64 {
    u64::from(dist_sq.to_bits()) << 32 | u64::from(place)
}

#[inline]
fn unpack(key: u64) -> Neighbor {
    Neighbor { place: key as u32, dist_sq: f32::from_bits((key >> 32) as u32) }
}
