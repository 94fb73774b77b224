use rayon::prelude::*;

use super::index::{NearestHeap, PhotonIndex};
use crate::math::{Bounds, DVec3, Vec3};

/// Points to a leaf; at most 32, the bits of a mask. A leaf is scanned whole, eight SSE registers
/// and six cache lines, which trades steps down the tree against points tested in vain. Against 16,
/// searches by radius measured 10 to 17 % faster and those of the nearest 50 within 5 %; 8 was slower.
const LEAF: usize = 32;

/// Children to a node: the boxes of four are tested at once.
const FANOUT: usize = 4;

/// Levels of nodes over 2³² points, rounded up.
const MAX_LEVELS: usize = 16;

/// Nodes that can wait: at each level all children but the one being visited, and the last.
const STACK: usize = (FANOUT - 1) * MAX_LEVELS + 1;

/// Ranges shorter than this are arranged by one thread.
const PARALLEL: usize = 1 << 13;

/// A k-d tree over points (Bentley 1975) whose leaves are runs of 32 consecutive places.
///
/// Ranges are split across the longest side of the tight box around their points, the lower part
/// taking as many whole leaves as a power of two, so all leaves but the last are full and the tree
/// is complete: no pointers, no split planes. Instead each node holds the tight boxes of four
/// children (two levels of splits), which on photons, lying as they do on surfaces, are far smaller
/// than the cells of the planes. The boxes' distances bound those of their points in floating
/// point, too, as rounding is monotonic: no epsilon is needed.
///
/// The arrangement depends on the positions alone, not on threads: equal coordinates are ranked by
/// the number of the point. Points may all lie in one plane or in one place; positions must not be
/// NaN or infinite. Descents keep their own stack, whose size 2³² points cannot exceed.
#[derive(Clone, Debug, PartialEq)]
pub struct KdTree {
    len: usize,
    bounds: Bounds,
    covered_area: f32,
    leaves: Vec<Leaf>,
    /// Node i of level l has children 4i … 4i + 3 of level l − 1, or these leaves at level 0. The
    /// top level has one node; there is no level if there is no point.
    levels: Vec<Vec<Node>>,
}

/// The points of a leaf, coordinate by coordinate; those beyond the end of the last leaf are at infinity.
#[derive(Clone, Debug, PartialEq)]
#[repr(align(64))]
struct Leaf {
    x: [f32; LEAF],
    y: [f32; LEAF],
    z: [f32; LEAF],
}

/// The boxes of four children; a missing child's is empty.
#[derive(Clone, Debug, PartialEq)]
#[repr(align(32))]
struct Node {
    min: [[f32; FANOUT]; 3],
    max: [[f32; FANOUT]; 3],
}

/// A point while it is being arranged.
#[derive(Clone, Copy)]
struct Entry {
    position: Vec3,
    number: u32,
}

/// A leaf counts as at most so many times the area of the middle one. On an infinite plane the few
/// photons that land a hundred heights away would otherwise stand for nearly all of the area.
const FARTHEST_LEAF: f64 = 64.0;

impl KdTree {
    /// The area the points cover if they lie on surfaces, estimated from the leaves.
    ///
    /// The points of a leaf lie on a piece of a plane whose projections fill the sides of their tight
    /// box, or nearly; then the area is the length of the vector of the sides' areas. The box around
    /// n random points falls short of their cell: by (n − 1)/n in the direction of the last split,
    /// which passes between neighbouring points, and by (n − 1)/(n + 1) in the other. That is made
    /// good. Leaves that bridge a gap or an edge count too much, and so do planes at a slant to all
    /// axes, by up to .7 of their area, since leaves do not fill their boxes there.
    pub fn covered_area(&self) -> f32 {
        self.covered_area
    }

    /// Scans one leaf, calling `visit(place, dist_sq)` where `dist_sq <= radius_sq`, in order.
    #[inline]
    fn scan(&self, leaf: usize, center: Vec3, radius_sq: f32, mut visit: impl FnMut(u32, f32)) {
        let dist_sq = self.leaves[leaf].distances_sq(center);
        let mut inside = mask(&dist_sq, radius_sq);
        while inside != 0 {
            let i = inside.trailing_zeros() as usize % LEAF;
            inside &= inside - 1;
            visit((leaf * LEAF + i) as u32, dist_sq[i]);
        }
    }
}

impl PhotonIndex for KdTree {
    fn build(len: usize, position: impl Fn(usize) -> Vec3 + Sync) -> (Self, Vec<u32>) {
        assert!(u32::try_from(len).is_ok(), "an index holds fewer than 2^32 photons, not {len}");
        let entry = |i: usize| Entry { position: position(i), number: i as u32 };
        let mut entries: Vec<_> = (0..len).into_par_iter().map(entry).collect();
        let slots = len.div_ceil(LEAF).next_power_of_two() * LEAF;
        arrange(&mut entries, slots);
        let leaves = entries.par_chunks(LEAF).map(Leaf::of).collect();
        let boxes: Vec<_> =
            entries.par_chunks(LEAF).map(|run| Bounds::of(run.iter().map(|e| e.position))).collect();
        let bounds = boxes.iter().copied().fold(Bounds::EMPTY, Bounds::union);
        let order = entries.par_iter().map(|e| e.number).collect();
        let covered_area = covered_area(&boxes, len);
        (Self { len, bounds, covered_area, leaves, levels: levels_over(boxes) }, order)
    }

    fn len(&self) -> usize {
        self.len
    }

    #[inline]
    fn position(&self, place: u32) -> Vec3 {
        self.leaves[place as usize / LEAF].position(place as usize % LEAF)
    }

    fn bounds(&self) -> Bounds {
        self.bounds
    }

    fn memory_bytes(&self) -> usize {
        let nodes: usize = self.levels.iter().map(|level| size_of_val(level.as_slice())).sum();
        size_of_val(self.leaves.as_slice()) + nodes
    }

    fn for_each_within(&self, center: Vec3, radius_sq: f32, mut visit: impl FnMut(u32, f32)) {
        let radius_sq = finite_bound(radius_sq);
        let mut stack = [(0u32, 0u32); STACK];
        let mut waiting = usize::from(!self.levels.is_empty());
        stack[0] = (self.levels.len().wrapping_sub(1) as u32, 0);
        while waiting > 0 {
            waiting -= 1;
            let (level, node) = stack[waiting];
            let mut near = mask(&self.levels[level as usize][node as usize].distances_sq(center), radius_sq);
            let first = node as usize * FANOUT;
            if level == 0 {
                while near != 0 {
                    self.scan(first + near.trailing_zeros() as usize, center, radius_sq, &mut visit);
                    near &= near - 1;
                }
            } else {
                // The last child is pushed first, so that places come in increasing order.
                while near != 0 {
                    let last = near.ilog2();
                    near ^= 1 << last;
                    stack[waiting] = (level - 1, first as u32 + last);
                    waiting += 1;
                }
            }
        }
    }

    fn nearest(
        &self,
        center: Vec3,
        max_radius_sq: f32,
        k: usize,
        mut measure: impl FnMut(u32, f32) -> Option<f32>,
        found: &mut NearestHeap,
    ) {
        found.start(k, finite_bound(max_radius_sq));
        // Squared distance of the box, level, number of the node.
        let mut stack = [(0.0f32, 0u32, 0u32); STACK];
        let mut waiting = usize::from(!self.levels.is_empty());
        stack[0] = (0.0, self.levels.len().wrapping_sub(1) as u32, 0);
        while waiting > 0 {
            waiting -= 1;
            let (dist_sq, level, node) = stack[waiting];
            // A box just as far as the bound may hold an equal of lower place.
            if dist_sq > found.bound_sq() {
                continue;
            }
            let children = self.levels[level as usize][node as usize].by_distance(center);
            let first = node * FANOUT as u32;
            if level == 0 {
                for (dist_sq, child) in children {
                    let bound_sq = found.bound_sq();
                    if dist_sq > bound_sq {
                        break;
                    }
                    self.scan((first + child) as usize, center, bound_sq, |place, dist_sq| {
                        if dist_sq <= found.bound_sq()
                            && let Some(d) = measure(place, dist_sq)
                            && d <= found.bound_sq()
                        {
                            found.offer(place, d);
                        }
                    });
                }
            } else {
                for (dist_sq, child) in children.into_iter().rev() {
                    if dist_sq <= found.bound_sq() {
                        stack[waiting] = (dist_sq, level - 1, first + child);
                        waiting += 1;
                    }
                }
            }
        }
        found.finish();
    }
}

impl Leaf {
    fn of(run: &[Entry]) -> Self {
        let mut leaf = Self { x: [f32::INFINITY; LEAF], y: [f32::INFINITY; LEAF], z: [f32::INFINITY; LEAF] };
        for (i, entry) in run.iter().enumerate() {
            [leaf.x[i], leaf.y[i], leaf.z[i]] = entry.position.to_array();
        }
        leaf
    }

    #[inline]
    fn position(&self, i: usize) -> Vec3 {
        Vec3::new(self.x[i], self.y[i], self.z[i])
    }

    #[inline]
    fn distances_sq(&self, center: Vec3) -> [f32; LEAF] {
        let mut dist_sq = [0.0; LEAF];
        for (i, d) in dist_sq.iter_mut().enumerate() {
            let (x, y, z) = (self.x[i] - center.x, self.y[i] - center.y, self.z[i] - center.z);
            *d = x * x + y * y + z * z;
        }
        dist_sq
    }
}

impl Node {
    fn of(boxes: &[Bounds]) -> Self {
        let mut node = Self { min: [[f32::INFINITY; FANOUT]; 3], max: [[f32::NEG_INFINITY; FANOUT]; 3] };
        for (i, b) in boxes.iter().enumerate() {
            for axis in 0..3 {
                node.min[axis][i] = b.min[axis];
                node.max[axis][i] = b.max[axis];
            }
        }
        node
    }

    /// Squared distances to the children's boxes; infinite for a missing one.
    #[inline]
    fn distances_sq(&self, center: Vec3) -> [f32; FANOUT] {
        // Comparisons instead of `f32::max`, whose rule for NaN costs instructions.
        let larger = |a: f32, b: f32| if a > b { a } else { b };
        let mut dist_sq = [0.0; FANOUT];
        for (axis, c) in center.to_array().into_iter().enumerate() {
            for (i, d) in dist_sq.iter_mut().enumerate() {
                let outside = larger(larger(self.min[axis][i] - c, c - self.max[axis][i]), 0.0);
                *d += outside * outside;
            }
        }
        dist_sq
    }

    /// Squared distances and numbers of the children, nearest first.
    #[inline]
    fn by_distance(&self, center: Vec3) -> [(f32, u32); FANOUT] {
        let [a, b, c, d] = self.distances_sq(center);
        let mut children = [(a, 0), (b, 1), (c, 2), (d, 3)];
        // A sorting network.
        for (i, j) in [(0, 1), (2, 3), (0, 2), (1, 3), (1, 2)] {
            if children[j].0 < children[i].0 {
                children.swap(i, j);
            }
        }
        children
    }
}

/// The bits of the distances at most `radius_sq`.
#[inline]
fn mask<const N: usize>(dist_sq: &[f32; N], radius_sq: f32) -> u32 {
    dist_sq.iter().enumerate().fold(0, |mask, (i, d)| mask | u32::from(*d <= radius_sq) << i)
}

/// The bound of a search: finite, to keep out what lies at infinity, and negative in place of NaN.
#[inline]
fn finite_bound(radius_sq: f32) -> f32 {
    if radius_sq.is_nan() { -1.0 } else { radius_sq.min(f32::MAX) }
}

/// Brings the entries of a subtree of `slots` places (leaves times a power of two) into leaf order.
fn arrange(entries: &mut [Entry], slots: usize) {
    if entries.len() <= LEAF {
        entries.sort_unstable_by_key(|e| e.number);
        return;
    }
    let half = slots / 2;
    if entries.len() <= half {
        return arrange(entries, half);
    }
    let extent = Bounds::of(entries.iter().map(|e| e.position)).extent();
    let axis = extent.max_position();
    entries.select_nth_unstable_by(half, |a, b| {
        a.position[axis].total_cmp(&b.position[axis]).then(a.number.cmp(&b.number))
    });
    let (low, high) = entries.split_at_mut(half);
    if low.len() + high.len() < PARALLEL {
        arrange(low, half);
        arrange(high, half);
    } else {
        rayon::join(|| arrange(low, half), || arrange(high, half));
    }
}

/// See [`KdTree::covered_area`].
fn covered_area(boxes: &[Bounds], len: usize) -> f32 {
    let areas: Vec<f64> = boxes
        .iter()
        .enumerate()
        .map(|(i, b)| {
            let n = (len - i * LEAF).min(LEAF) as f64;
            let inner = (n - 1.0).max(1.0);
            let e = b.extent().as_dvec3();
            (e * DVec3::new(e.y, e.z, e.x)).length() * n * (n + 1.0) / (inner * inner)
        })
        .collect();
    let mut sorted = areas.clone();
    sorted.sort_unstable_by(f64::total_cmp);
    let Some(median) = sorted.get(sorted.len() / 2) else { return 0.0 };
    let most = if *median > 0.0 { median * FARTHEST_LEAF } else { f64::INFINITY };
    areas.iter().map(|a| a.min(most)).sum::<f64>() as f32
}

/// The nodes over the leaves' boxes, from the lowest level to the top.
fn levels_over(mut boxes: Vec<Bounds>) -> Vec<Vec<Node>> {
    let mut levels = Vec::new();
    while !boxes.is_empty() {
        levels.push(boxes.chunks(FANOUT).map(Node::of).collect());
        if boxes.len() <= FANOUT {
            break;
        }
        let union = |group: &[Bounds]| group.iter().copied().fold(Bounds::EMPTY, Bounds::union);
        boxes = boxes.chunks(FANOUT).map(union).collect();
    }
    levels
}
