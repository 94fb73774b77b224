//! The search for the nearest k.

use super::{Ball, FIRST_BALL, GROWTH, GridTree, Node, Piece, Pieces};
use crate::bvh::LANES;
use crate::math::Vec3;
use crate::photon_map::block::Hits;
use crate::photon_map::index::NearestList;

/// A search for the nearest.
pub(super) struct Nearest<'a, F> {
    pub tree: &'a GridTree,
    pub center: Vec3,
    pub k: usize,
    pub measure: F,
    pub found: &'a mut NearestList,
}

impl<F: FnMut(u32, f32) -> Option<f32>> Nearest<'_, F> {
    /// Looks through a ball that should hold k points, and if it does not through larger ones, less
    /// what was looked through before.
    pub fn search(mut self) {
        if self.tree.nodes.is_empty() {
            return;
        }
        let mut before_sq = -1.0;
        let first = self.tree.first_radius_sq(self.center, self.k);
        let mut radius_sq = if first.is_finite() { first.max(f32::MIN_POSITIVE) } else { f32::MAX };
        loop {
            radius_sq = radius_sq.min(self.found.bound_sq());
            self.shell(before_sq, radius_sq);
            let count = self.found.count_within(radius_sq);
            if count >= self.k || radius_sq >= self.found.bound_sq() {
                return;
            }
            before_sq = radius_sq;
            radius_sq *= (FIRST_BALL * self.k as f32 / count as f32).clamp(1.5, GROWTH);
        }
    }

    /// Offers the points beyond one squared distance and up to another, from near nodes to far ones.
    #[inline(always)]
    fn shell(&mut self, before_sq: f32, radius_sq: f32) {
        let Self { tree, center, ref mut measure, ref mut found, .. } = *self;
        let mut waiting = found.take_waiting();
        waiting.push((tree.nodes[0].dist_sq(center), 0));
        while let Some((dist_sq, number)) = waiting.pop() {
            let radius_sq = radius_sq.min(found.bound_sq());
            if dist_sq > radius_sq {
                continue;
            }
            let node = &tree.nodes[number as usize];
            let ball = Ball::new(center, radius_sq);
            let mut pieces = Pieces::new(node, node.cells_in(&ball));
            let first = waiting.len();
            while let Some(piece) = pieces.next(node, &tree.starts) {
                match piece {
                    Piece::Run(start, end) => {
                        tree.blocks.scan(
                            start,
                            end,
                            center,
                            radius_sq,
                            #[inline(always)]
                            |hits: Hits| {
                                hits.for_each(
                                    #[inline(always)]
                                    |place, dist_sq| {
                                        if dist_sq > before_sq
                                            && let Some(d) = measure(place, dist_sq)
                                        {
                                            found.offer(place, d);
                                        }
                                    },
                                );
                            },
                        );
                    }
                    Piece::Inner(cell) => {
                        let child = node.child(cell);
                        waiting.push((tree.nodes[child as usize].dist_sq(center), child));
                    }
                }
            }
            // The nearest is last and comes next.
            waiting[first..].sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
        }
        found.give_waiting(waiting);
    }
}

const _: () = assert!(LANES == 8 && size_of::<Node>() == 64);
