//! How far each photon's power is spread for rays.

use std::f64::consts::PI;

use rayon::prelude::*;

use crate::bvh::LANES;
use crate::photon_map::{GridTree, NearestList, PhotonIndex};

/// Blocks of eight photons that share a radius. A search for each photon would take most of the time of
/// building, and neighbours would find nearly the same.
const SHARED: usize = 4;

/// The default of the largest radius, in radii that hold the photons wanted at the mean density: as on
/// surfaces.
const LARGEST: f32 = 2.0;

/// A group of photons counts as filling at most so many times the volume that the middle one does.
const FARTHEST: f64 = 64.0;

/// The radii of the photons of a cloud, and what is known of its density.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Radii {
    /// One for each [`SHARED`] blocks. Not positive where there is none.
    radii: Vec<f32>,
    /// The volume for each photon, at the mean over the photons.
    volume: f64,
    /// The radius of the ball around all photons.
    whole: f32,
}

impl Radii {
    /// For each group of consecutive places the distance to the `k`-th nearest of the photon in its middle,
    /// though at most [`Self::default_max_radius`], and that also where `k` photons lie in one place.
    ///
    /// Whatever the radius, the kernel of a photon integrates to one over any plane across a ray, so all
    /// rays of a direction together see exactly its power. That asks only that its radius is the same for
    /// all rays. What a wrong radius changes is the blur.
    ///
    /// All of it is multiplied by `factor`.
    pub fn new(index: &GridTree, k: u32, factor: f32) -> Self {
        let (_, whole) = index.bounds().bounding_sphere();
        let k = k.max(2);
        let middle = |group: usize| {
            let first = group * SHARED * LANES;
            (first + (index.len().min(first + SHARED * LANES) - first) / 2) as u32
        };
        let search = |found: &mut NearestList, group: usize| {
            index.nearest(index.position(middle(group)), f32::INFINITY, k as usize, |_, d| Some(d), found);
            let radius = found.iter().last().map_or(0.0, |last| last.dist_sq.sqrt());
            (radius, found.len())
        };
        let groups = index.len().div_ceil(SHARED * LANES);
        let found: Vec<(f32, usize)> =
            (0..groups).into_par_iter().map_init(NearestList::new, search).collect();
        let volumes = found.iter().map(|(radius, count)| ball(*radius) / (count - 1).max(1) as f64).collect();
        let mut all = Self { radii: Vec::new(), volume: mean(volumes), whole };
        let largest = all.default_max_radius(k);
        let radius = |&(radius, _): &(f32, usize)| if radius > 0.0 { radius.min(largest) } else { largest };
        all.radii = found.iter().map(|found| factor * radius(found)).collect();
        all
    }

    /// The radius of the photons of a block.
    #[inline(always)]
    pub fn of_block(&self, number: usize) -> f32 {
        self.radii[number / SHARED]
    }

    /// See [`VolumeMap::default_max_radius`](super::VolumeMap::default_max_radius).
    pub fn default_max_radius(&self, k: u32) -> f32 {
        let typical = libm::cbrt(f64::from(k) * self.volume * 3.0 / (4.0 * PI)) as f32;
        if typical > 0.0 { (LARGEST * typical).min(self.whole) } else { self.whole }
    }

    pub fn memory_bytes(&self) -> usize {
        size_of_val(self.radii.as_slice())
    }
}

/// The volume of a ball.
fn ball(radius: f32) -> f64 {
    4.0 / 3.0 * PI * f64::from(radius).powi(3)
}

/// The mean of the volumes for a photon, of which a few around stray photons may be huge.
fn mean(volumes: Vec<f64>) -> f64 {
    if volumes.is_empty() {
        return 0.0;
    }
    let mut sorted = volumes.clone();
    let middle = sorted.len() / 2;
    let median = *sorted.select_nth_unstable_by(middle, f64::total_cmp).1;
    let most = if median > 0.0 { median * FARTHEST } else { f64::INFINITY };
    volumes.iter().map(|v| v.min(most)).sum::<f64>() / volumes.len() as f64
}
