mod nearest;
mod visit_blocks;

use self::nearest::Nearest;
pub(super) use self::visit_blocks::BlockVisitor;
use super::block::Blocks;
use super::index::{Item, NearestList, PhotonIndex};
use crate::bvh::LANES;
use crate::math::{Bounds, Vec3};

/// A tree over points whose nodes are grids of up to 64 cells.
///
/// A node divides the tight box around its points into a grid of about as many cells as make runs of
/// a dozen points: 8 × 8 × 1 on a wall, 4 × 4 × 4 in a corner, 64 × 1 × 1 on a line. The points of a
/// cell are a run of consecutive places, and so are those of neighbouring cells in a row. A cell with
/// many points has a node of its own. So cells are as fine as the points are dense, be they spread
/// evenly or a million times denser here than there; and 64 bits say which cells hold anything.
///
/// A search takes the cells that the box around its ball meets: no epsilon is needed, as rounding is
/// monotonic and a point's cell is found by the same arithmetic as the range of cells.
///
/// The arrangement depends on the positions and the order of the points alone, not on threads.
#[derive(Clone, Debug, PartialEq)]
pub struct GridTree {
    pub(super) bounds: Bounds,
    pub(super) covered_area: f32,
    pub(super) blocks: Blocks,
    /// The root comes first; the nodes in the cells of a node lie side by side. None if there is no point.
    pub(super) nodes: Vec<Node>,
    /// Where the points of each cell that holds any begin, node by node, and at each node's end where
    /// the last cell's points end.
    pub(super) starts: Vec<u32>,
}

/// A grid of cells.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub(super) struct Node {
    /// The tight box around the points.
    pub min: [f32; 3],
    pub max: [f32; 3],
    /// Cells for each unit of length.
    pub per_length: [f32; 3],
    /// The logarithm to base 2 of the number of cells along each axis.
    pub bits: [u8; 3],
    /// Cells that hold points: the cell at (x, y, z) is bit x + (y << bits.x) + (z << bits.x + bits.y).
    pub occupied: u64,
    /// Those of them that have a node of their own.
    pub inner: u64,
    /// Where the starts of this node's cells begin.
    pub first_start: u32,
    /// The node of the first cell that has one.
    pub first_child: u32,
}

/// The most levels of nodes: cells below are not divided, however many points they hold. Each level
/// divides boxes by 64, so only points that crowd together faster than that, level by level, come here.
pub(super) const MAX_LEVELS: usize = 32;

/// Photons in the first ball of a search for the nearest k, times k, at the density around its centre:
/// one in a dozen searches finds too few and needs a larger ball.
const FIRST_BALL: f32 = 1.3;

/// Factor of the squared radius where a ball held no point at all.
const GROWTH: f32 = 8.0;

impl Node {
    /// The cell of a coordinate along an axis; the first or last for what lies outside.
    #[inline(always)]
    fn along(&self, axis: usize, coordinate: f32) -> u32 {
        let cell = (coordinate - self.min[axis]) * self.per_length[axis];
        // Saturates: negative numbers and NaN are the first cell.
        (cell as i32).clamp(0, (1 << self.bits[axis]) - 1) as u32
    }

    /// The cell that a point in the box belongs to.
    #[inline(always)]
    pub fn cell(&self, p: Vec3) -> u32 {
        let [x, y, z] = [self.along(0, p.x), self.along(1, p.y), self.along(2, p.z)];
        x | y << self.bits[0] | z << (self.bits[0] + self.bits[1])
    }

    /// The bits of the cells that meet a box, which must meet the node's.
    #[inline(always)]
    fn cells_in(&self, ball: &Ball) -> u64 {
        let range = |axis| (self.along(axis, ball.low[axis]), self.along(axis, ball.high[axis]));
        let ((x0, x1), (y0, y1), (z0, z1)) = (range(0), range(1), range(2));
        let row = (2u64 << x1).wrapping_sub(1 << x0);
        let rows = (y0..=y1).fold(0, |rows, y| rows | row << (y << self.bits[0]));
        (z0..=z1).fold(0, |cells, z| cells | rows << (z << (self.bits[0] + self.bits[1])))
    }

    #[inline(always)]
    fn meets(&self, ball: &Ball) -> bool {
        self.dist_sq(ball.center) <= ball.radius_sq
    }

    /// Squared distance to the box; bounds that of its points, in floating point, too.
    #[inline(always)]
    fn dist_sq(&self, center: Vec3) -> f32 {
        // Comparisons instead of `f32::max`, whose rule for NaN costs instructions.
        let larger = |a: f32, b: f32| if a > b { a } else { b };
        let outside = |axis: usize| {
            let c = center[axis];
            larger(larger(self.min[axis] - c, c - self.max[axis]), 0.0)
        };
        let (x, y, z) = (outside(0), outside(1), outside(2));
        x * x + y * y + z * z
    }

    /// Where in `starts` the points of a cell begin.
    #[inline(always)]
    fn start_of(&self, cell: u32) -> usize {
        (self.first_start + below(self.occupied, cell).count_ones()) as usize
    }

    /// The node of an inner cell.
    #[inline(always)]
    fn child(&self, cell: u32) -> u32 {
        self.first_child + below(self.inner, cell).count_ones()
    }
}

/// The bits under a bit.
#[inline(always)]
fn below(bits: u64, bit: u32) -> u64 {
    bits & ((1 << bit) - 1)
}

/// What a search looks through.
#[derive(Clone, Copy)]
struct Ball {
    center: Vec3,
    radius_sq: f32,
    /// Coordinates that no point of the ball lies beyond.
    low: [f32; 3],
    high: [f32; 3],
}

impl Ball {
    /// A computed distance may round to the radius from a little beyond, and squares may underflow.
    #[inline(always)]
    fn new(center: Vec3, radius_sq: f32) -> Self {
        let radius = radius_sq.max(1e-37).sqrt() * (1.0 + 4.0 * f32::EPSILON);
        Self {
            center,
            radius_sq,
            low: (center - Vec3::splat(radius)).to_array(),
            high: (center + Vec3::splat(radius)).to_array(),
        }
    }
}

/// The bound of a search: finite, to keep out what lies at infinity, and negative in place of NaN.
#[inline(always)]
fn finite_bound(radius_sq: f32) -> f32 {
    if radius_sq.is_nan() { -1.0 } else { radius_sq.min(f32::MAX) }
}

/// The runs of places in the cells of a node that are in a range, and the inner cells among them, in order.
#[derive(Clone, Copy)]
struct Pieces {
    inside: u64,
    /// Where a run must end: cells that hold points and are not in the range, and inner ones.
    stops: u64,
}

enum Piece {
    Run(u32, u32),
    Inner(u32),
}

impl Pieces {
    const NONE: Self = Self { inside: 0, stops: 0 };

    #[inline(always)]
    fn new(node: &Node, range: u64) -> Self {
        Self { inside: node.occupied & range, stops: node.occupied & !range | node.inner }
    }

    #[inline(always)]
    fn next(&mut self, node: &Node, starts: &[u32]) -> Option<Piece> {
        if self.inside == 0 {
            return None;
        }
        let cell = self.inside.trailing_zeros();
        if node.inner >> cell & 1 == 1 {
            self.inside &= self.inside - 1;
            return Some(Piece::Inner(cell));
        }
        // The lowest stop above the cell, and all bits under it; all bits if there is none.
        let above = self.stops & (u64::MAX << cell);
        let run = above.wrapping_sub(1) & !above;
        self.inside &= !run;
        let end = node.first_start + (node.occupied & run).count_ones();
        Some(Piece::Run(starts[node.start_of(cell)], starts[end as usize]))
    }
}

impl GridTree {
    /// The area the points cover if they lie on surfaces, estimated from the cells.
    ///
    /// The points of a cell lie on a piece of a plane whose projections fill the sides of their tight
    /// box, or nearly; then the area is the length of the vector of the sides' areas. The box around
    /// n random points falls short of the piece by (n − 1)/(n + 1) in either direction, which is made
    /// good. Cells of one point say nothing and count as the others do on the average. Cells that
    /// bridge a gap or an edge count too much, and so do planes at a slant to all axes, by up to .7 of
    /// their area, since the points do not fill their boxes there.
    pub fn covered_area(&self) -> f32 {
        self.covered_area
    }

    /// A squared radius that holds some more than k points at the density around a point.
    fn first_radius_sq(&self, center: Vec3, k: usize) -> f32 {
        let Some(mut node) = self.nodes.first() else { return 0.0 };
        loop {
            let cell = node.cell(center);
            if node.inner >> cell & 1 == 0 {
                break;
            }
            node = &self.nodes[node.child(cell) as usize];
        }
        let side = |axis: usize| node.max[axis] - node.min[axis];
        let area = Vec3::new(side(0) * side(1), side(1) * side(2), side(2) * side(0)).length();
        let first = node.first_start as usize;
        let len = self.starts[first + node.occupied.count_ones() as usize] - self.starts[first];
        let ball = FIRST_BALL * k as f32 * area / (std::f32::consts::PI * len as f32);
        ball + node.dist_sq(center)
    }
}

impl PhotonIndex for GridTree {
    fn build_with<T: Item>(len: usize, point: impl Fn(usize) -> (Vec3, T) + Sync) -> (Self, Vec<T>) {
        Self::build_from(len, point)
    }

    fn len(&self) -> usize {
        self.blocks.len()
    }

    #[inline]
    fn position(&self, place: u32) -> Vec3 {
        self.blocks.position(place)
    }

    fn bounds(&self) -> Bounds {
        self.bounds
    }

    fn memory_bytes(&self) -> usize {
        self.blocks.memory_bytes() + size_of_val(self.nodes.as_slice()) + size_of_val(self.starts.as_slice())
    }

    #[inline(always)]
    fn for_each_within(&self, center: Vec3, radius_sq: f32, mut visit: impl FnMut(u32, f32)) {
        let radius_sq = finite_bound(radius_sq);
        if radius_sq < 0.0 {
            return;
        }
        let Some(mut search) = Within::new(self, Ball::new(center, radius_sq)) else { return };
        let (mut places, mut dist_sq) = ([0; BATCH], [0.0; BATCH]);
        loop {
            let len = search.next(&mut places, &mut dist_sq);
            for (place, dist_sq) in places.iter().zip(&dist_sq).take(len) {
                visit(*place, *dist_sq);
            }
            if len + LANES <= BATCH {
                return;
            }
        }
    }

    fn nearest(
        &self,
        center: Vec3,
        max_radius_sq: f32,
        k: usize,
        measure: impl FnMut(u32, f32) -> Option<f32>,
        found: &mut NearestList,
    ) {
        found.start(k, finite_bound(max_radius_sq));
        if found.bound_sq() >= 0.0 {
            Nearest { tree: self, center, k, measure, found }.search();
        }
        found.finish();
    }
}

/// Points found at a time: what is done with them then happens in a loop of its own, which keeps its
/// sums in registers and has nothing else to mind.
const BATCH: usize = 128;

/// A search by radius, and where it stands.
struct Within<'a> {
    tree: &'a GridTree,
    ball: Ball,
    /// The node being searched, and what is left of it.
    number: u32,
    pieces: Pieces,
    /// Places that are left of a run.
    run: (u32, u32),
    /// Nodes to come back to, and what is left of them.
    stack: [(u32, Pieces); MAX_LEVELS],
    depth: usize,
}

impl<'a> Within<'a> {
    /// `None` if the ball is outside.
    #[inline(always)]
    fn new(tree: &'a GridTree, ball: Ball) -> Option<Self> {
        let root = tree.nodes.first().filter(|root| root.meets(&ball))?;
        let (pieces, stack) = (Pieces::new(root, root.cells_in(&ball)), [(0, Pieces::NONE); MAX_LEVELS]);
        Some(Self { tree, ball, number: 0, pieces, run: (0, 0), stack, depth: 0 })
    }

    /// Notes down the next points, their places and squared distances; returns how many. At the end of
    /// the search there is room left for a block.
    #[inline(never)]
    fn next(&mut self, places: &mut [u32; BATCH], dist_sq: &mut [f32; BATCH]) -> usize {
        let (tree, Ball { center, radius_sq, .. }) = (self.tree, self.ball);
        let (mut pieces, (mut start, mut end)) = (self.pieces, self.run);
        let mut node = &tree.nodes[self.number as usize];
        let mut len = 0;
        loop {
            while start < end {
                if len + LANES > BATCH {
                    (self.pieces, self.run) = (pieces, (start, end));
                    return len;
                }
                let (found, mask, next) = tree.blocks.block(start, end, center, radius_sq);
                start = next;
                if mask == 0 {
                    continue;
                }
                // Each lane is noted down, and the next one in its place if it was no hit: no branches
                // that could go wrong.
                for (lane, d) in found.into_iter().enumerate() {
                    places[len % BATCH] = next - (LANES - lane) as u32;
                    dist_sq[len % BATCH] = d;
                    len += (mask >> lane & 1) as usize;
                }
            }
            match pieces.next(node, &tree.starts) {
                Some(Piece::Run(from, to)) => (start, end) = (from, to),
                Some(Piece::Inner(cell)) => {
                    let child = node.child(cell);
                    let inside = &tree.nodes[child as usize];
                    if inside.meets(&self.ball) {
                        self.stack[self.depth] = (self.number, pieces);
                        self.depth += 1;
                        (self.number, node) = (child, inside);
                        pieces = Pieces::new(node, node.cells_in(&self.ball));
                    }
                }
                None if self.depth == 0 => {
                    (self.pieces, self.run) = (pieces, (0, 0));
                    return len;
                }
                None => {
                    self.depth -= 1;
                    (self.number, pieces) = self.stack[self.depth];
                    node = &tree.nodes[self.number as usize];
                }
            }
        }
    }
}
