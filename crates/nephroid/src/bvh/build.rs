use super::{Bvh, Node};
use crate::math::{Bounds, Vec3};

const BINS: usize = 16;
const MAX_LEAF: usize = 4;
/// Beyond this depth nodes are split in halves by count, which ends after 32 more.
const MAX_HEURISTIC_DEPTH: usize = 64;
/// Cost of visiting a node relative to testing an item.
const NODE_COST: f32 = 1.0;

/// Deepest possible tree: what a traversal's stack must hold.
pub(super) const MAX_DEPTH: usize = MAX_HEURISTIC_DEPTH + 33;

struct Item {
    bounds: Bounds,
    center: Vec3,
    index: u32,
}

impl Bvh {
    /// Builds over boxes, none of which may be empty; also gives the order in which the owner must
    /// keep its items.
    pub fn build(boxes: &[Bounds]) -> (Self, Vec<u32>) {
        let mut items: Vec<Item> = (0u32..)
            .zip(boxes)
            .map(|(index, &bounds)| Item { bounds, center: bounds.center(), index })
            .collect();
        let mut nodes = Vec::with_capacity(boxes.len());
        if !items.is_empty() {
            grow(&mut nodes, &mut items, 0, 0);
        }
        (Self { nodes }, items.iter().map(|i| i.index).collect())
    }
}

/// Adds the tree over `items`, the first of which is number `first` of all.
fn grow(nodes: &mut Vec<Node>, items: &mut [Item], first: usize, depth: usize) {
    let bounds = items.iter().fold(Bounds::EMPTY, |b, i| b.union(i.bounds));
    let at = nodes.len();
    nodes.push(Node {
        min: bounds.min,
        max: bounds.max,
        first: first as u32,
        count: items.len() as u16,
        axis: 0,
    });
    let Some((axis, middle)) = split(items, &bounds, depth) else { return };
    let (left, right) = items.split_at_mut(middle);
    grow(nodes, left, first, depth + 1);
    let right_child = nodes.len() as u32;
    grow(nodes, right, first + middle, depth + 1);
    let node = &mut nodes[at];
    (node.first, node.count, node.axis) = (right_child, 0, axis as u16);
}

/// Reorders the items and says where to cut them, and along which axis; `None` for a leaf.
fn split(items: &mut [Item], bounds: &Bounds, depth: usize) -> Option<(usize, usize)> {
    if items.len() <= 1 {
        return None;
    }
    let centers = Bounds::of(items.iter().map(|i| i.center));
    let extent = centers.extent();
    let widest = (0..3).max_by(|&a, &b| extent[a].total_cmp(&extent[b])).unwrap_or(0);
    let halves = |items: &mut [Item]| {
        let middle = items.len() / 2;
        items.select_nth_unstable_by(middle, |a, b| {
            a.center[widest].total_cmp(&b.center[widest]).then(a.index.cmp(&b.index))
        });
        Some((widest, middle))
    };
    let spread = extent[widest] > 0.0 && extent[widest].is_finite();
    if !spread || depth >= MAX_HEURISTIC_DEPTH {
        return if items.len() <= MAX_LEAF { None } else { halves(items) };
    }
    let (axis, boundary, cost) = best_cut(items, &centers, bounds.area());
    if items.len() <= MAX_LEAF && cost >= items.len() as f32 {
        return None;
    }
    let mut middle = 0;
    for i in 0..items.len() {
        if bin(items[i].center[axis], axis, &centers) < boundary {
            items.swap(i, middle);
            middle += 1;
        }
    }
    if middle == 0 || middle == items.len() { halves(items) } else { Some((axis, middle)) }
}

fn bin(center: f32, axis: usize, centers: &Bounds) -> usize {
    let x = (center - centers.min[axis]) / (centers.max[axis] - centers.min[axis]);
    ((x * BINS as f32) as usize).min(BINS - 1)
}

/// The axis and bin boundary of least expected cost, in units of one item's test.
fn best_cut(items: &[Item], centers: &Bounds, area: f32) -> (usize, usize, f32) {
    let mut best = (0, BINS / 2, f32::INFINITY);
    for axis in 0..3 {
        let extent = centers.max[axis] - centers.min[axis];
        if !(extent > 0.0 && extent.is_finite()) {
            continue;
        }
        let mut bins = [(Bounds::EMPTY, 0usize); BINS];
        for item in items {
            let b = &mut bins[bin(item.center[axis], axis, centers)];
            *b = (b.0.union(item.bounds), b.1 + 1);
        }
        let mut right = [0.0; BINS];
        let (mut b, mut n) = (Bounds::EMPTY, 0);
        for i in (1..BINS).rev() {
            (b, n) = (b.union(bins[i].0), n + bins[i].1);
            right[i] = b.area() * n as f32;
        }
        let (mut b, mut n) = (Bounds::EMPTY, 0);
        for boundary in 1..BINS {
            (b, n) = (b.union(bins[boundary - 1].0), n + bins[boundary - 1].1);
            if n == 0 || n == items.len() {
                continue;
            }
            let cost = NODE_COST + (b.area() * n as f32 + right[boundary]) / area;
            if cost < best.2 {
                best = (axis, boundary, cost);
            }
        }
    }
    best
}
