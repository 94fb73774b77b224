//! A tree of boxes, eight children to a node, over items that its owner keeps.
//!
//! Built as a binary tree by the crate `obvhs`, then collapsed so that the expected cost of a ray is
//! least. Knows no shape.

mod binary;
mod build;
mod lanes;
mod part;
#[expect(unsafe_code, reason = "a stack that is not filled in advance")]
mod stack;
mod traverse;

use crate::math::Bounds;

pub(crate) use lanes::{LANES, Lanes, Simd, Work, splat3};
pub(crate) use traverse::Visitor;

/// A tree over items that the owner keeps in leaves as [`Tree::build`] asks for them.
#[derive(Clone, Debug)]
pub(crate) struct Tree {
    nodes: Vec<Node>,
    root: Child,
}

/// Eight boxes and what is in them. A lane that is not used has a box which no ray meets.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
struct Node {
    /// For each axis the lower sides, then the upper.
    sides: [[[f32; LANES]; 2]; 3],
    children: [Child; LANES],
}

/// What a tree is built over: boxes, counted from zero.
pub(crate) trait Boxes: Sync {
    fn count(&self) -> u32;
    fn get(&self, number: u32) -> Bounds;
}

/// What items can be kept together in a leaf.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Up to eight triangles.
    Triangles,
    /// Up to eight flat shapes.
    Flats,
    /// One item of any other kind.
    Other,
}

/// A node, or a leaf. The highest bit tells a leaf of triangles, whose number has the 31 others; then two bits what else it
/// is, where a node has one bit more for its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Child(u32);

const TRIANGLES: u32 = 1 << 31;
const NODE_BITS: u32 = 30;
const LEAF_BITS: u32 = 29;

impl Child {
    /// Nothing at all, as a root.
    const NONE: Self = Self(u32::MAX);

    fn node(number: usize) -> Self {
        Self(number as u32)
    }

    fn leaf(kind: Kind, number: u32) -> Self {
        Self(match kind {
            Kind::Triangles => TRIANGLES | number,
            Kind::Flats => 2 << LEAF_BITS | number,
            Kind::Other => 3 << LEAF_BITS | number,
        })
    }

    #[inline(always)]
    fn unpack(self) -> (Option<Kind>, usize) {
        let (kind, bits) = match self.0 >> LEAF_BITS {
            0 | 1 => (None, NODE_BITS),
            2 => (Some(Kind::Flats), LEAF_BITS),
            3 => (Some(Kind::Other), LEAF_BITS),
            _ => (Some(Kind::Triangles), 31),
        };
        (kind, (self.0 & ((1 << bits) - 1)) as usize)
    }
}

impl Tree {
    /// Bytes that it takes, without what the leaves hold.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.nodes[..])
    }
}
