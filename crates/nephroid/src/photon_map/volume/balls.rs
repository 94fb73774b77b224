//! Balls around the photons of a cloud, in the order of its places.

use rayon::prelude::*;

use super::radii::Radii;
use crate::bvh::{LANES, Lanes};
use crate::math::{Bounds, Vec3};
use crate::photon_map::block::Blocks;

/// What a computed distance to a ray can be off by, relative to the distances that enter it, more than
/// twice over: a difference, a dot product, a product and again a difference.
const SLACK: f32 = 16.0 * f32::EPSILON;

/// What a computed radius grows by, so that its rounding loses nothing.
const GROWN: f32 = 1.0 + 4.0 * f32::EPSILON;

/// A hierarchy of balls, eight to a node: those of the lowest level are around a block of eight photons with
/// their radii, those above around a node. Nothing is pointed to, as the nodes of a level lie side by
/// side. Consecutive places lie near each other, so balls in their order are nearly as small as any.
///
/// Balls and not boxes: what is sought are balls around photons, most of them larger than what
/// eight photons span, and a ray meets a box around a few balls half as often again as a ball.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Balls {
    /// The lowest level first; the last has one node. None if there is no photon.
    levels: Vec<Vec<Node>>,
}

/// Eight balls. A lane that is not used reaches to -∞, so it lies behind every ray.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub(super) struct Node {
    center: [[f32; LANES]; 3],
    /// How far photons and their radii reach from the centre.
    reach: [f32; LANES],
}

/// The ray that balls and photons are tested against.
#[derive(Clone, Copy)]
pub(super) struct Beam<L> {
    origin: [L; 3],
    direction: [L; 3],
    t_max: L,
}

/// A ball and what is in it.
#[derive(Clone, Copy)]
struct Ball {
    center: Vec3,
    reach: f32,
    bounds: Bounds,
    /// The largest radius of a photon.
    radius: f32,
}

impl Balls {
    pub fn build(blocks: &Blocks, radii: &Radii) -> Self {
        let around = |number: usize| Ball::around_photons(blocks, number, radii.of_block(number));
        let mut balls: Vec<Ball> = (0..blocks.len().div_ceil(LANES)).into_par_iter().map(around).collect();
        let mut levels = Vec::new();
        while !balls.is_empty() {
            levels.push(balls.par_chunks(LANES).map(Node::new).collect::<Vec<_>>());
            if balls.len() <= LANES {
                break;
            }
            balls = balls.par_chunks(LANES).map(Ball::around).collect();
        }
        Self { levels }
    }

    pub fn memory_bytes(&self) -> usize {
        self.levels.iter().map(|level| size_of_val(level.as_slice())).sum()
    }

    /// How many levels.
    pub fn height(&self) -> usize {
        self.levels.len()
    }

    /// A node of a level, which is there.
    #[inline(always)]
    pub fn node(&self, level: usize, number: usize) -> &Node {
        &self.levels[level][number]
    }

    /// Has a node brought from memory.
    #[inline(always)]
    pub fn prefetch<L: Lanes>(&self, level: usize, number: usize) {
        if let Some(node) = self.levels[level].get(number) {
            L::prefetch(node);
        }
    }
}

impl Ball {
    fn around_photons(blocks: &Blocks, number: usize, radius: f32) -> Self {
        let places = number * LANES..blocks.len().min((number + 1) * LANES);
        let positions = places.map(|place| blocks.position(place as u32));
        let bounds = Bounds::of(positions.clone());
        let center = bounds.center();
        let farthest = positions.map(|p| p.distance(center)).fold(0.0, f32::max);
        let radius = radius.max(0.0);
        Self { center, reach: (farthest + radius) * GROWN, bounds, radius }
    }

    /// The better of two: around the balls, or around the box of the photons and the largest radius.
    fn around(balls: &[Self]) -> Self {
        let bounds = balls.iter().fold(Bounds::EMPTY, |all, ball| all.union(ball.bounds));
        let center = bounds.center();
        let radius = balls.iter().map(|ball| ball.radius).fold(0.0, f32::max);
        let reach = balls.iter().map(|ball| ball.center.distance(center) + ball.reach).fold(0.0, f32::max);
        let reach = reach.min(0.5 * bounds.extent().length() + radius) * GROWN;
        Self { center, reach, bounds, radius }
    }
}

impl Node {
    /// Of at most eight balls.
    fn new(balls: &[Ball]) -> Self {
        let mut node = Self { center: [[0.0; LANES]; 3], reach: [f32::NEG_INFINITY; LANES] };
        for (lane, ball) in balls.iter().enumerate().take(LANES) {
            for axis in 0..3 {
                node.center[axis][lane] = ball.center[axis];
            }
            node.reach[lane] = ball.reach;
        }
        node
    }
}

impl<L: Lanes> Beam<L> {
    #[inline(always)]
    pub fn new(origin: Vec3, direction: Vec3, t_max: f32) -> Self {
        let splat = |v: Vec3| crate::bvh::splat3(v.to_array());
        Self { origin: splat(origin), direction: splat(direction), t_max: L::splat(t_max) }
    }

    /// Where along the ray points are projected to, and their squared distances from it. Those are of the
    /// vector from the ray to the point: the difference of two squares would be off by much more.
    #[inline(always)]
    pub fn project(&self, points: [L; 3]) -> (L, L) {
        let [x, y, z] = [0, 1, 2].map(|axis| points[axis].minus(self.origin[axis]));
        let [dx, dy, dz] = self.direction;
        let t = x.times(dx).plus(y.times(dy)).plus(z.times(dz));
        let (x, y, z) = (x.minus(t.times(dx)), y.minus(t.times(dy)), z.minus(t.times(dz)));
        (t, x.times(x).plus(y.times(y)).plus(z.times(z)))
    }

    /// Which of a node's balls it meets, with room for the rounding of whatever is inside.
    #[inline(always)]
    pub fn meet(&self, node: &Node) -> u32 {
        let center = [L::load(&node.center[0]), L::load(&node.center[1]), L::load(&node.center[2])];
        let (t, dist_sq) = self.project(center);
        let reach = L::load(&node.reach);
        let reach = reach.plus(t.abs().plus(reach).times(L::splat(SLACK)));
        let not_behind = L::splat(0.0).le(t.plus(reach));
        let not_beyond = t.minus(reach).le(self.t_max);
        dist_sq.le(reach.times(reach)) & not_behind & not_beyond
    }

    /// Which points, within a squared radius, are projected to the inside of the ray.
    #[inline(always)]
    pub fn passes(&self, t: L, dist_sq: L, radius_sq: L) -> u32 {
        dist_sq.le(radius_sq) & L::splat(0.0).lt(t) & t.lt(self.t_max)
    }
}
