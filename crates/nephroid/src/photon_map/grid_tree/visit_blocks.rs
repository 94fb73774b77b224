//! A search by radius that goes through points in blocks of eight.

use super::{Ball, GridTree, MAX_LEVELS, Piece, Pieces, finite_bound};
use crate::bvh::{LANES, Lanes, splat3};
use crate::math::Vec3;

/// Takes what a search finds, block by block.
pub(in crate::photon_map) trait BlockVisitor<L: Lanes> {
    /// The squared distances of the points of a block, and all bits in the lanes of those that were found.
    fn visit(&mut self, number: usize, dist_sq: L, mask: L);
}

/// All bits in the lanes from one on; and in those before one, at least one and at most all.
static FROM: [[f32; LANES]; LANES] = edges(false);
static BEFORE: [[f32; LANES]; LANES] = edges(true);

const fn edges(before: bool) -> [[f32; LANES]; LANES] {
    let mut edges = [[0.0; LANES]; LANES];
    let mut i = 0;
    while i < LANES * LANES {
        let (edge, lane) = (i / LANES, i % LANES);
        if if before { lane <= edge } else { lane >= edge } {
            edges[edge][lane] = f32::from_bits(u32::MAX);
        }
        i += 1;
    }
    edges
}

impl GridTree {
    /// Visits the blocks that hold points within a radius, by increasing place, and maybe others; a block
    /// may come several times, with different points. For [`Work`](crate::bvh::Work) on lanes.
    #[inline(always)]
    pub(in crate::photon_map) fn visit_blocks<L: Lanes, V: BlockVisitor<L>>(
        &self,
        center: Vec3,
        radius_sq: f32,
        visitor: &mut V,
    ) {
        let radius_sq = finite_bound(radius_sq);
        let ball = Ball::new(center, radius_sq);
        let Some(mut node) = self.nodes.first().filter(|root| radius_sq >= 0.0 && root.meets(&ball)) else {
            return;
        };
        let (center, radius_sq) = (splat3::<L>(center.to_array()), L::splat(radius_sq));
        let mut pieces = Pieces::new(node, node.cells_in(&ball));
        let mut stack = [(0, Pieces::NONE); MAX_LEVELS];
        let (mut number, mut depth) = (0, 0);
        loop {
            match pieces.next(node, &self.starts) {
                Some(Piece::Run(start, end)) => {
                    let (first, last) = (start as usize / LANES, (end as usize - 1) / LANES);
                    let mut inside = L::load(&FROM[start as usize % LANES]);
                    for number in first..last {
                        let dist_sq = self.blocks.dist_sq(number, center);
                        visitor.visit(number, dist_sq, dist_sq.mask_le(radius_sq).and(inside));
                        inside = L::load(&FROM[0]);
                    }
                    let inside = inside.and(L::load(&BEFORE[(end as usize - 1) % LANES]));
                    let dist_sq = self.blocks.dist_sq(last, center);
                    visitor.visit(last, dist_sq, dist_sq.mask_le(radius_sq).and(inside));
                }
                Some(Piece::Inner(cell)) => {
                    let child = node.child(cell);
                    let inside = &self.nodes[child as usize];
                    if inside.meets(&ball) {
                        stack[depth] = (number, pieces);
                        depth += 1;
                        (number, node) = (child, inside);
                        pieces = Pieces::new(node, node.cells_in(&ball));
                    }
                }
                None if depth == 0 => return,
                None => {
                    depth -= 1;
                    (number, pieces) = stack[depth];
                    node = &self.nodes[number as usize];
                }
            }
        }
    }
}
