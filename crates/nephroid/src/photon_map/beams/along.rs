use super::block::{Block, Probe};
use super::parallel::inside;
use super::{Beam, BeamMap};
use crate::bvh::{Kind, LANES, Lanes, Simd, Visitor, Work};
use crate::math::Ray;
use crate::photon_map::Kernel;

impl BeamMap {
    /// Visits the beams of a medium that pass a ray within their radius, each once, with the nearest points: at
    /// t in (0, `t_max`) on the ray and at s in (0, length) on the beam. `ray.direction` must be a unit
    /// vector; `ray.t_max` is not asked.
    ///
    /// `visit(t, s, beam, weight)`, weight in 1/m: `kernel.weight_1d` at the distance of the two, over the
    /// sine of the angle between them. Of beams nearly parallel to the ray (below [`Self::parallel_sin`]) t and s
    /// are a point of the stretch within the radius, and the weight is that stretch times
    /// `kernel.weight_2d`. The radiance scattered towards the ray's origin is then the sum of
    /// σ_s · phase · power · T_beam(s) · T_ray(t) · weight over the beams.
    ///
    /// The order depends on the map and the ray alone.
    #[inline]
    pub fn along(
        &self,
        ray: &Ray,
        t_max: f32,
        medium: u16,
        kernel: Kernel,
        visit: impl FnMut(f32, f32, &Beam, f32),
    ) {
        self.along_by(Simd::detect(), ray, t_max, medium, kernel, visit);
    }

    #[inline]
    pub(super) fn along_by(
        &self,
        simd: Simd,
        ray: &Ray,
        t_max: f32,
        medium: u16,
        kernel: Kernel,
        visit: impl FnMut(f32, f32, &Beam, f32),
    ) {
        if t_max > 0.0 && self.radius > 0.0 {
            simd.run(Along { map: self, ray, t_max, medium, kernel, visit });
        }
    }
}

/// See [`BeamMap::along`].
struct Along<'a, F> {
    map: &'a BeamMap,
    ray: &'a Ray,
    t_max: f32,
    medium: u16,
    kernel: Kernel,
    visit: F,
}

impl<F: FnMut(f32, f32, &Beam, f32)> Work for Along<'_, F> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let (map, ray, mut t_max) = (self.map, self.ray, self.t_max);
        let radius_sq = map.radius * map.radius;
        let parallel_sq = map.parallel_sin * map.parallel_sin;
        let probe = Probe::<L>::new(ray, t_max, radius_sq, parallel_sq);
        let mut search = Search { probe, radius_sq, along: self };
        map.tree.traverse::<L, true>(ray, &mut t_max, &mut search);
    }
}

/// Goes through the leaves.
struct Search<'a, L, F> {
    probe: Probe<L>,
    radius_sq: f32,
    along: Along<'a, F>,
}

impl<L: Lanes, F: FnMut(f32, f32, &Beam, f32)> Visitor for Search<'_, L, F> {
    #[inline(always)]
    fn visit(&mut self, _: Kind, number: usize, _: &mut f32) -> bool {
        let block = &self.along.map.blocks[number];
        let met = block.meet(&self.probe);
        if met.found != 0 {
            let (t, s, dist_sq, sin_sq) =
                (met.t.store(), met.s.store(), met.dist_sq.store(), met.sin_sq.store());
            let mut mask = met.found;
            while mask != 0 {
                let lane = mask.trailing_zeros() as usize % LANES;
                mask &= mask - 1;
                let weight = self.along.kernel.weight_1d(dist_sq[lane], self.radius_sq) / sin_sq[lane].sqrt();
                self.along.report(block.beam(lane), t[lane], s[lane], weight);
            }
        }
        if met.parallel != 0 {
            self.along.parallel(block, met.parallel);
        }
        false
    }

    #[inline(always)]
    fn prefetch(&self, _: Kind, number: usize) {
        if let Some(block) = self.along.map.blocks.get(number) {
            L::prefetch(block);
        }
    }
}

impl<F: FnMut(f32, f32, &Beam, f32)> Along<'_, F> {
    #[inline(always)]
    fn report(&mut self, number: usize, t: f32, s: f32, weight: f32) {
        let beam = &self.map.beams[number];
        if beam.medium == self.medium {
            (self.visit)(t, s, beam, weight);
        }
    }

    #[inline(never)]
    fn parallel(&mut self, block: &Block, mut mask: u32) {
        while mask != 0 {
            let lane = mask.trailing_zeros() as usize % LANES;
            mask &= mask - 1;
            let number = block.beam(lane);
            let beam = &self.map.beams[number];
            let found = inside(self.ray, self.t_max, beam, number, self.map.radius, self.kernel);
            if let Some(found) = found.filter(|found| block.holds(lane, found.s)) {
                self.report(number, found.t, found.s, found.weight);
            }
        }
    }
}
