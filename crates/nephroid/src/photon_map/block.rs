use rayon::prelude::*;
use wide::f32x8;

use crate::bvh::{LANES, Lanes};
use crate::math::Vec3;

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
        let mut from = start;
        while from < end {
            let (dist_sq, mask, next) = self.block(from, end, center, radius_sq);
            if mask != 0 {
                visit(Hits { first: next - LANES as u32, mask, dist_sq: &dist_sq });
            }
            from = next;
        }
    }

    /// The squared distances of the points in the block of a place, the bits of those from there to
    /// before `end` that are within the radius, and the first place of the next block.
    #[inline(always)]
    pub fn block(&self, start: u32, end: u32, center: Vec3, radius_sq: f32) -> ([f32; LANES], u32, u32) {
        let number = start / LANES as u32;
        let block = &self.blocks[number as usize];
        let away = |coordinates, center| {
            let d = f32x8::new(coordinates) - f32x8::splat(center);
            d * d
        };
        let dist_sq = away(block.x, center.x) + away(block.y, center.y) + away(block.z, center.z);
        let mut mask = dist_sq.simd_le(f32x8::splat(radius_sq)).to_bitmask();
        let place = number * LANES as u32;
        mask &= u32::MAX << (start - place);
        mask &= u32::MAX >> (31 - (end - 1 - place).min(31));
        (dist_sq.to_array(), mask, place + LANES as u32)
    }

    /// The squared distances of the points in a block.
    #[inline(always)]
    pub fn dist_sq<L: Lanes>(&self, number: usize, [x, y, z]: [L; 3]) -> L {
        let block = &self.blocks[number];
        let (x, y, z) = (L::load(&block.x).minus(x), L::load(&block.y).minus(y), L::load(&block.z).minus(z));
        x.times(x).plus(y.times(y)).plus(z.times(z))
    }

    /// The coordinates of the points in a block.
    #[inline(always)]
    pub fn coordinates<L: Lanes>(&self, number: usize) -> [L; 3] {
        let block = &self.blocks[number];
        [L::load(&block.x), L::load(&block.y), L::load(&block.z)]
    }

    /// Has the coordinates of a block brought from memory.
    #[inline(always)]
    pub fn prefetch<L: Lanes>(&self, number: usize) {
        if let Some(block) = self.blocks.get(number) {
            L::prefetch(block);
        }
    }
}
