use super::Beam;
use super::pieces::Piece;
use crate::bvh::{LANES, Lanes, splat3};
use crate::math::Ray;

/// Up to eight pieces of beams. A lane that is not used has a piece that nothing is in.
///
/// All that is computed of a pair comes from the beam and the ray, and from the piece only whether the
/// nearest point is in it: so it is the same in all pieces of a beam, and in exactly one of them it counts.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(32))]
pub(super) struct Block {
    origins: [[f32; LANES]; 3],
    directions: [[f32; LANES]; 3],
    starts: [f32; LANES],
    ends: [f32; LANES],
    beams: [u32; LANES],
}

/// A ray as blocks are tested against it.
#[derive(Clone, Copy)]
pub(super) struct Probe<L> {
    origin: [L; 3],
    direction: [L; 3],
    t_max: L,
    radius_sq: L,
    parallel_sq: L,
}

/// What a ray has to do with the pieces of a block.
pub(super) struct Met<L> {
    /// Whose nearest points count.
    pub found: u32,
    /// Whose beams are nearly parallel to the ray, near or not.
    pub parallel: u32,
    pub t: L,
    pub s: L,
    pub dist_sq: L,
    pub sin_sq: L,
}

impl<L: Lanes> Probe<L> {
    /// For squared sines below `parallel_sq` a pair counts as parallel.
    #[inline(always)]
    pub fn new(ray: &Ray, t_max: f32, radius_sq: f32, parallel_sq: f32) -> Self {
        Self {
            origin: splat3(ray.origin.to_array()),
            direction: splat3(ray.direction.to_array()),
            t_max: L::splat(t_max),
            radius_sq: L::splat(radius_sq),
            parallel_sq: L::splat(parallel_sq),
        }
    }
}

impl Block {
    pub fn new(beams: &[Beam], pieces: impl Iterator<Item = Piece>) -> Self {
        let mut block = Self {
            origins: [[0.0; LANES]; 3],
            directions: [[0.0; LANES]; 3],
            starts: [f32::INFINITY; LANES],
            ends: [f32::NEG_INFINITY; LANES],
            beams: [0; LANES],
        };
        for (lane, piece) in pieces.enumerate().take(LANES) {
            let beam = &beams[piece.beam as usize];
            for axis in 0..3 {
                block.origins[axis][lane] = beam.origin[axis];
                block.directions[axis][lane] = beam.direction[axis];
            }
            (block.starts[lane], block.ends[lane], block.beams[lane]) = (piece.start, piece.end, piece.beam);
        }
        block
    }

    /// The number of the beam in a lane.
    #[inline(always)]
    pub fn beam(&self, lane: usize) -> usize {
        self.beams[lane % LANES] as usize
    }

    /// Whether a distance from the origin is in the piece of a lane.
    #[inline(always)]
    pub fn holds(&self, lane: usize, s: f32) -> bool {
        self.starts[lane % LANES] <= s && s < self.ends[lane % LANES]
    }

    /// The nearest points of the lines of the ray and of the beams.
    ///
    /// Seen along the ray a beam starts at w and runs in the direction e, both perpendicular to the ray;
    /// |e| = sin θ. It comes nearest where w + s e is shortest. That loses nothing at small angles: an error
    /// of s moves the point along the beam, and its distance from the ray by sin θ as much.
    #[inline(always)]
    pub fn meet<L: Lanes>(&self, probe: &Probe<L>) -> Met<L> {
        let d = probe.direction;
        let direction = load3(&self.directions);
        let cos = dot(d, direction);
        let e = along(direction, d, L::splat(0.0).minus(cos));
        let sin_sq = dot(e, e);
        let w = minus(load3(&self.origins), probe.origin);
        let way = dot(w, d);
        let w = along(w, d, L::splat(0.0).minus(way));
        let s = L::splat(0.0).minus(dot(w, e)).over(sin_sq);
        let v = along(w, e, s);
        let dist_sq = dot(v, v);
        let t = way.plus(s.times(cos));
        let (start, end) = (L::load(&self.starts), L::load(&self.ends));
        let parallel = sin_sq.lt(probe.parallel_sq) & start.lt(end);
        let inside = start.le(s) & s.lt(end);
        let ahead = L::splat(0.0).lt(t) & t.lt(probe.t_max);
        let found = dist_sq.le(probe.radius_sq) & inside & ahead & !parallel;
        Met { found, parallel, t, s, dist_sq, sin_sq }
    }
}

#[inline(always)]
fn load3<L: Lanes>([x, y, z]: &[[f32; LANES]; 3]) -> [L; 3] {
    [L::load(x), L::load(y), L::load(z)]
}

#[inline(always)]
fn dot<L: Lanes>(a: [L; 3], b: [L; 3]) -> L {
    a[0].times(b[0]).plus(a[1].times(b[1])).plus(a[2].times(b[2]))
}

#[inline(always)]
fn minus<L: Lanes>(a: [L; 3], b: [L; 3]) -> [L; 3] {
    [a[0].minus(b[0]), a[1].minus(b[1]), a[2].minus(b[2])]
}

/// a + f b.
#[inline(always)]
fn along<L: Lanes>(a: [L; 3], b: [L; 3], f: L) -> [L; 3] {
    [a[0].plus(b[0].times(f)), a[1].plus(b[1].times(f)), a[2].plus(b[2].times(f))]
}
