//! The density of photons along a ray.

use super::balls::Beam;
use super::cloud::Cloud;
use super::map::VolumeMap;
use super::photon::VolumePhoton;
use crate::bvh::{LANES, Lanes, Simd, Work};
use crate::math::Ray;
use crate::photon_map::estimate::Spread;
use crate::photon_map::{Kernel, PhotonIndex};

/// Photons found at a time: what is done with them is then no part of the search, which is compiled for
/// wider instructions than its caller.
const BATCH: usize = 256;

/// Levels that a search can go down: eight to the power of as many are more blocks than there are.
const MAX_HEIGHT: usize = 11;

impl VolumeMap {
    /// The beam radiance estimate: calls `visit(t, photon, weight)` for each photon of a medium whose ball the
    /// ray passes, by increasing place, where the photon's projection to the ray lies at a distance `t` from
    /// its origin, in (0, `t_max`), which may be infinite. With a weight in 1/m²,
    /// Σ phase · power · transmittance(t) · weight is the radiance in W/(m²·sr) that photons scatter into the
    /// ray (Jarosz et al. 2008, equation 13, but that each photon's disc stands across the ray at its
    /// projection, and powers have the albedo multiplied in already).
    ///
    /// The direction must have length one; the ray also ends at its own `t_max`. Whoever leaves photons out,
    /// for their depth, need only ignore them: the radii do not depend on it.
    pub fn along(
        &self,
        ray: &Ray,
        t_max: f32,
        medium: u16,
        kernel: Kernel,
        visit: impl FnMut(f32, &VolumePhoton, f32),
    ) {
        self.along_by(Simd::detect(), ray, t_max, medium, kernel, visit);
    }

    pub(super) fn along_by(
        &self,
        simd: Simd,
        ray: &Ray,
        t_max: f32,
        medium: u16,
        kernel: Kernel,
        mut visit: impl FnMut(f32, &VolumePhoton, f32),
    ) {
        let Some(cloud) = self.cloud(medium) else { return };
        let mut search = Search::new(cloud, Ray { t_max: t_max.min(ray.t_max), ..*ray });
        let mut batch = [Passed::default(); BATCH];
        let (mut block, mut spread) = (usize::MAX, None);
        loop {
            let len = simd.run(Next { search: &mut search, batch: &mut batch });
            for passed in batch.iter().take(len) {
                let number = passed.place as usize / LANES;
                if number != block {
                    (block, spread) = (number, Spread::new(kernel, cloud.radii.of_block(number)));
                }
                if let Some(spread) = &spread {
                    visit(passed.t, &cloud.photon(passed.place), spread.weight(passed.dist_sq));
                }
            }
            if search.is_over() {
                return;
            }
        }
    }
}

/// A photon whose ball the ray passes.
#[derive(Clone, Copy, Default)]
struct Passed {
    place: u32,
    t: f32,
    dist_sq: f32,
}

/// A search along a ray, and where it stands.
struct Search<'a> {
    cloud: &'a Cloud,
    ray: Ray,
    /// For each level the node that is being looked at, and which of its children are left.
    nodes: [(u32, u32); MAX_HEIGHT],
    /// The level that is being looked at, from the lowest, which is 0.
    level: usize,
    /// Whether the root is still to be looked at.
    fresh: bool,
}

impl<'a> Search<'a> {
    fn new(cloud: &'a Cloud, ray: Ray) -> Self {
        Self { cloud, ray, nodes: [(0, 0); MAX_HEIGHT], level: cloud.balls.height() - 1, fresh: true }
    }

    /// Whether it has found all.
    fn is_over(&self) -> bool {
        !self.fresh && self.level + 1 == self.cloud.balls.height() && self.nodes[self.level].1 == 0
    }
}

/// Finds the next photons, until the batch is nearly full or the search over; returns how many.
struct Next<'a, 'b> {
    search: &'b mut Search<'a>,
    batch: &'b mut [Passed; BATCH],
}

impl Work for Next<'_, '_> {
    type Output = usize;

    #[inline(always)]
    fn run<L: Lanes>(self) -> usize {
        let Self { search, batch } = self;
        let Cloud { ref balls, ref index, ref radii, ref payloads, .. } = *search.cloud;
        let beam = Beam::<L>::new(search.ray.origin, search.ray.direction, search.ray.t_max);
        let top = balls.height() - 1;
        if search.fresh {
            search.fresh = false;
            search.nodes[top % MAX_HEIGHT] = (0, search.cloud.enter(&beam, top, 0));
        }
        let (mut level, mut len) = (search.level, 0);
        loop {
            let (number, mut children) = search.nodes[level % MAX_HEIGHT];
            if children == 0 {
                if level == top {
                    break;
                }
                level += 1;
                continue;
            }
            if level > 0 {
                search.nodes[level % MAX_HEIGHT].1 = children & (children - 1);
                let child = number as usize * LANES + children.trailing_zeros() as usize;
                level -= 1;
                search.nodes[level % MAX_HEIGHT] = (child as u32, search.cloud.enter(&beam, level, child));
                continue;
            }
            if len + LANES * LANES > BATCH {
                break;
            }
            search.nodes[0].1 = 0;
            while children != 0 {
                let block = number as usize * LANES + children.trailing_zeros() as usize;
                children &= children - 1;
                let (t, dist_sq) = beam.project(index.blocks.coordinates(block));
                let radius = radii.of_block(block);
                let mut mask = beam.passes(t, dist_sq, L::splat(radius * radius));
                // Beyond the last photon of all lie none.
                mask &= u32::MAX >> (32 - (index.len() - block * LANES).min(LANES));
                let (t, dist_sq) = (t.store(), dist_sq.store());
                while mask != 0 {
                    let lane = mask.trailing_zeros() as usize % LANES;
                    mask &= mask - 1;
                    let place = block * LANES + lane;
                    L::prefetch(&payloads[place]);
                    batch[len % BATCH] = Passed { place: place as u32, t: t[lane], dist_sq: dist_sq[lane] };
                    len += 1;
                }
            }
        }
        search.level = level;
        len
    }
}

impl Cloud {
    /// Which children of a node a ray meets. All of them are asked of memory at once: where there are a
    /// million photons, waiting for one after the other took a third of the time.
    #[inline(always)]
    fn enter<L: Lanes>(&self, beam: &Beam<L>, level: usize, number: usize) -> u32 {
        let children = beam.meet(self.balls.node(level, number));
        let mut left = children;
        while left != 0 {
            let child = number * LANES + left.trailing_zeros() as usize;
            left &= left - 1;
            if level > 0 {
                self.balls.prefetch::<L>(level - 1, child);
            } else {
                self.index.blocks.prefetch::<L>(child);
            }
        }
        children
    }
}
