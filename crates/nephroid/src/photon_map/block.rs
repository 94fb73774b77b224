use rayon::prelude::*;

use crate::math::Vec3;

/// Points to a block.
pub(super) const LANES: usize = 8;

/// Positions in blocks of eight, coordinate by coordinate, 12 bytes a point: what lies together is read
/// together, and one instruction computes with several of them.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Blocks {
    blocks: Vec<Block>,
    len: usize,
}

/// Beyond the end of the last block are zeros, which no run contains.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(32))]
struct Block {
    x: [f32; LANES],
    y: [f32; LANES],
    z: [f32; LANES],
}

/// Points of one block that a search hit.
#[derive(Clone, Copy)]
pub(super) struct Hits<'a> {
    first: u32,
    mask: u32,
    dist_sq: &'a [f32; LANES],
}

impl Hits<'_> {
    /// Calls `visit(place, dist_sq)` for each, by increasing place.
    #[inline(always)]
    pub fn for_each(self, mut visit: impl FnMut(u32, f32)) {
        let mut mask = self.mask;
        while mask != 0 {
            let i = mask.trailing_zeros();
            mask &= mask - 1;
            visit(self.first + i, self.dist_sq[i as usize % LANES]);
        }
    }
}

impl Blocks {
    pub fn new(len: usize, position: impl Fn(usize) -> Vec3 + Sync) -> Self {
        let block = |number: usize| {
            let mut block = Block { x: [0.0; LANES], y: [0.0; LANES], z: [0.0; LANES] };
            for (lane, place) in (number * LANES..len.min((number + 1) * LANES)).enumerate() {
                [block.x[lane], block.y[lane], block.z[lane]] = position(place).to_array();
            }
            block
        };
        Self { blocks: (0..len.div_ceil(LANES)).into_par_iter().map(block).collect(), len }
    }

    pub fn len(&self) -> usize {
        self.len
    }

    #[inline(always)]
    pub fn position(&self, place: u32) -> Vec3 {
        let (block, lane) = (&self.blocks[place as usize / LANES], place as usize % LANES);
        Vec3::new(block.x[lane], block.y[lane], block.z[lane])
    }

    pub fn memory_bytes(&self) -> usize {
        size_of_val(self.blocks.as_slice())
    }

    /// Calls `visit` with the points at the places from `start` to before `end` whose squared distance
    /// is at most `radius_sq`, by increasing place.
    #[inline(always)]
    pub fn scan(&self, start: u32, end: u32, center: Vec3, radius_sq: f32, mut visit: impl FnMut(Hits)) {
        let (first, last) = (start as usize / LANES, (end as usize).div_ceil(LANES));
        for (number, block) in (first..last).zip(&self.blocks[first..last]) {
            let mut dist_sq = [0.0; LANES];
            for (i, d) in dist_sq.iter_mut().enumerate() {
                let (x, y, z) = (block.x[i] - center.x, block.y[i] - center.y, block.z[i] - center.z);
                *d = x * x + y * y + z * z;
            }
            let mut mask = 0;
            for (i, d) in dist_sq.iter().enumerate() {
                mask |= u32::from(*d <= radius_sq) << i;
            }
            let place = (number * LANES) as u32;
            if place < start {
                mask &= u32::MAX << (start - place);
            }
            if end - place < LANES as u32 {
                mask &= (1 << (end - place)) - 1;
            }
            if mask != 0 {
                visit(Hits { first: place, mask, dist_sq: &dist_sq });
            }
        }
    }
}
