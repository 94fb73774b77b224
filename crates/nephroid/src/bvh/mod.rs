//! A tree of boxes over primitives.
//!
//! Binary, built by the surface area heuristic over binned centroids (Wald 2007, *On fast
//! Construction of SAH-based Bounding Volume Hierarchies*).

mod build;
mod traverse;

use crate::math::Vec3;

/// A tree over `n` items that the owner keeps in the order [`Bvh::build`] returns.
#[derive(Clone, Debug, Default)]
pub(crate) struct Bvh {
    /// Depth first: the left child of an inner node follows it.
    nodes: Vec<Node>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    min: Vec3,
    /// Leaf: first item. Inner node: index of the right child.
    first: u32,
    max: Vec3,
    /// Leaf: number of items. Inner node: 0.
    count: u16,
    /// Inner node: the axis its children are split along.
    axis: u16,
}
