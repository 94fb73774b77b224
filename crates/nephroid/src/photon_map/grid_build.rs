//! How a [`GridTree`] is built: points are sorted by cell, node by node, from the root down.

use rayon::prelude::*;

use super::block::Blocks;
use super::grid_tree::{GridTree, MAX_LEVELS, Node};
use super::index::Item;
use crate::math::{Bounds, DVec3, Vec3};

/// The most points to a cell without a node of its own.
const CELL: usize = 24;

/// Points to a cell that a grid aims at.
const AIM: usize = 8;

/// A word has a bit for each of 2⁶ cells.
const MAX_BITS: u32 = 6;

/// Nodes with fewer points are arranged by one thread, with all that lies in them.
const PARALLEL: usize = 1 << 14;

/// Points that one thread sorts at a time where several sort those of a node.
const CHUNK: usize = 1 << 15;

/// A cell counts as at most so many times the area that the middle one has for each of its points. On an
/// infinite plane the few photons that land a hundred heights away would otherwise stand for nearly
/// all of the area.
const FARTHEST_CELL: f64 = 64.0;

/// A point while it is being arranged, with what goes with it: that is then read and written in long rows
/// only, and never fetched from all over memory.
#[derive(Clone, Copy, Default)]
struct Entry<T> {
    position: Vec3,
    item: T,
}

/// A part of a tree. Its indices are those of its own lists, its places those of the whole.
#[derive(Default)]
struct Part {
    nodes: Vec<Node>,
    starts: Vec<u32>,
    /// The points in each cell that has no node, and their area.
    cells: Vec<(u32, f64)>,
    /// The cell of each point of the node being sorted.
    cell_of: Vec<u8>,
}

impl GridTree {
    pub(super) fn build_from<T: Item>(
        len: usize,
        point: impl Fn(usize) -> (Vec3, T) + Sync,
    ) -> (Self, Vec<T>) {
        assert!(u32::try_from(len).is_ok(), "an index holds fewer than 2^32 photons, not {len}");
        let entry = |i: usize| {
            let (position, item) = point(i);
            Entry { position, item }
        };
        let mut given: Vec<_> = (0..len).into_par_iter().map(entry).collect();
        let chunks: Vec<_> = given.par_chunks(CHUNK).map(bounds).collect();
        let bounds = chunks.into_iter().fold(Bounds::EMPTY, Bounds::union);
        let mut sorted: Vec<_> = (0..len).into_par_iter().map(|_| Entry::default()).collect();
        let mut part = Part::default();
        if len > 0 {
            part.nodes.push(grid(bounds, len));
            part.arrange(0, &mut given, &mut sorted, false, 0, 1);
        }
        drop(given);
        let tree = Self {
            bounds,
            covered_area: covered_area(part.cells),
            blocks: Blocks::new(len, |place| sorted[place].position),
            nodes: part.nodes,
            starts: part.starts,
        };
        (tree, sorted.par_iter().map(|e| e.item).collect())
    }
}

impl Part {
    /// Sorts the points of a node, which come to the places from `place` on, and makes the nodes in it.
    /// The points are in `from`; they end in `to`, or if `back` in `from`.
    fn arrange<T: Item>(
        &mut self,
        number: usize,
        from: &mut [Entry<T>],
        to: &mut [Entry<T>],
        back: bool,
        place: u32,
        level: usize,
    ) {
        let alone = from.len() < PARALLEL;
        let mut node = self.nodes[number];
        let counts = if alone { self.sort(&node, from, to) } else { sort_together(&node, from, to) };
        let runs = split(to, from, &counts);
        let boxes: Vec<_> = if alone {
            runs.iter().map(|run| bounds(run.sorted)).collect()
        } else {
            runs.par_iter().map(|run| bounds(run.sorted)).collect()
        };
        node.first_start = self.starts.len() as u32;
        node.first_child = self.nodes.len() as u32;
        let mut inner = Vec::new();
        for (run, bounds) in runs.into_iter().zip(boxes) {
            let len = run.sorted.len();
            let below = grid(bounds, len);
            node.occupied |= 1 << run.cell;
            self.starts.push(place + run.first);
            if len > CELL && below.bits != [0; 3] && level < MAX_LEVELS {
                node.inner |= 1 << run.cell;
                self.nodes.push(below);
                inner.push(run);
            } else {
                self.cells.push((len as u32, area(bounds, len)));
                if back {
                    run.spare.copy_from_slice(run.sorted);
                }
            }
        }
        self.starts.push(place + counts.iter().sum::<u32>());
        self.nodes[number] = node;
        let first = node.first_child as usize;
        if alone {
            for (i, run) in inner.into_iter().enumerate() {
                self.arrange(first + i, run.sorted, run.spare, !back, place + run.first, level + 1);
            }
        } else {
            let nodes = &self.nodes;
            let part = |(i, run): (usize, Run<T>)| {
                let mut part = Self { nodes: vec![nodes[first + i]], ..Self::default() };
                part.arrange(0, run.sorted, run.spare, !back, place + run.first, level + 1);
                part
            };
            let parts: Vec<_> = inner.into_par_iter().enumerate().map(part).collect();
            for (i, part) in parts.into_iter().enumerate() {
                self.join(first + i, part);
            }
        }
    }

    /// Puts a part in the place of a node, which is the part's first.
    fn join(&mut self, number: usize, part: Self) {
        let (nodes, starts) = (self.nodes.len() as u32 - 1, self.starts.len() as u32);
        let moved = |node: &Node| Node {
            first_start: node.first_start + starts,
            first_child: node.first_child + nodes,
            ..*node
        };
        let mut all = part.nodes.iter().map(moved);
        self.nodes[number] = all.next().expect("the first node of a part is its root");
        self.nodes.extend(all);
        self.starts.extend(part.starts);
        self.cells.extend(part.cells);
    }

    /// Sorts points by cell, those of a cell in the order they had; returns how many each holds.
    fn sort<T: Item>(&mut self, node: &Node, from: &[Entry<T>], to: &mut [Entry<T>]) -> [u32; 64] {
        let mut counts = [0; 64];
        self.cell_of.clear();
        self.cell_of.extend(from.iter().map(|entry| {
            let cell = node.cell(entry.position);
            counts[cell as usize % 64] += 1;
            cell as u8
        }));
        let mut next = firsts(&counts);
        for (entry, cell) in from.iter().zip(&self.cell_of) {
            let next = &mut next[usize::from(*cell) % 64];
            to[*next as usize] = *entry;
            *next += 1;
        }
        counts
    }
}

/// As [`Part::sort`], by several threads, each of which sorts chunks of the points.
fn sort_together<T: Item>(node: &Node, from: &[Entry<T>], to: &mut [Entry<T>]) -> [u32; 64] {
    let count = |chunk: &[Entry<T>]| {
        let mut counts = [0u32; 64];
        chunk.iter().for_each(|entry| counts[node.cell(entry.position) as usize % 64] += 1);
        counts
    };
    let counts: Vec<_> = from.par_chunks(CHUNK).map(count).collect();
    // Where the points of each chunk go: cell by cell, and within a cell chunk by chunk.
    let mut targets: Vec<Vec<&mut [Entry<T>]>> = counts.iter().map(|_| Vec::with_capacity(64)).collect();
    let mut rest = to;
    for cell in 0..64 {
        for (targets, counts) in targets.iter_mut().zip(&counts) {
            let target;
            (target, rest) = rest.split_at_mut(counts[cell] as usize);
            targets.push(target);
        }
    }
    from.par_chunks(CHUNK).zip(targets).for_each(|(chunk, mut targets)| {
        let mut next = [0; 64];
        for entry in chunk {
            let cell = node.cell(entry.position) as usize % 64;
            targets[cell][next[cell]] = *entry;
            next[cell] += 1;
        }
    });
    std::array::from_fn(|cell| counts.iter().map(|counts| counts[cell]).sum())
}

/// The points of a cell, and as much memory beside them.
struct Run<'a, T> {
    cell: usize,
    first: u32,
    sorted: &'a mut [Entry<T>],
    spare: &'a mut [Entry<T>],
}

/// The cells that hold points.
fn split<'a, T>(
    mut sorted: &'a mut [Entry<T>],
    mut spare: &'a mut [Entry<T>],
    counts: &[u32; 64],
) -> Vec<Run<'a, T>> {
    let mut runs = Vec::with_capacity(64);
    for (cell, (&first, &count)) in firsts(counts).iter().zip(counts).enumerate().filter(|(_, c)| *c.1 > 0) {
        let (mine, lent);
        (mine, sorted) = sorted.split_at_mut(count as usize);
        (lent, spare) = spare.split_at_mut(count as usize);
        runs.push(Run { cell, first, sorted: mine, spare: lent });
    }
    runs
}

/// Where each cell's points begin.
fn firsts(counts: &[u32; 64]) -> [u32; 64] {
    let mut sum = 0;
    counts.map(|count| {
        let first = sum;
        sum += count;
        first
    })
}

fn bounds<T>(entries: &[Entry<T>]) -> Bounds {
    Bounds::of(entries.iter().map(|e| e.position))
}

/// An empty grid over a box: the longest side of the cells is halved until there are enough of them.
/// There is one cell if the box is a point.
fn grid(bounds: Bounds, len: usize) -> Node {
    let extent = bounds.extent();
    let mut bits = [0u8; 3];
    let mut side = extent;
    let wanted = len.div_ceil(AIM).next_power_of_two().ilog2().clamp(1, MAX_BITS);
    for _ in 0..wanted {
        let axis = side.max_position();
        if side[axis] <= 64.0 * f32::MIN_POSITIVE {
            break;
        }
        bits[axis] += 1;
        side[axis] *= 0.5;
    }
    let per_length =
        |axis: usize| if bits[axis] == 0 { 0.0 } else { f32::from(1u8 << bits[axis]) / extent[axis] };
    Node {
        min: bounds.min.to_array(),
        max: bounds.max.to_array(),
        per_length: [per_length(0), per_length(1), per_length(2)],
        bits,
        occupied: 0,
        inner: 0,
        first_start: 0,
        first_child: 0,
    }
}

/// The area of the points in a cell, see [`GridTree::covered_area`].
fn area(bounds: Bounds, len: usize) -> f64 {
    let e = bounds.extent().as_dvec3();
    let n = len as f64;
    (e * DVec3::new(e.y, e.z, e.x)).length() * ((n + 1.0) / (n - 1.0).max(1.0)).powi(2)
}

/// See [`GridTree::covered_area`].
fn covered_area(cells: Vec<(u32, f64)>) -> f32 {
    let told: Vec<_> = cells.iter().copied().filter(|(n, _)| *n > 1).collect();
    let mut for_each: Vec<f64> = told.iter().map(|(n, area)| area / f64::from(*n)).collect();
    let middle = for_each.len() / 2;
    if for_each.is_empty() {
        return 0.0;
    }
    let median = *for_each.select_nth_unstable_by(middle, f64::total_cmp).1;
    let most = if median > 0.0 { median * FARTHEST_CELL } else { f64::INFINITY };
    let area: f64 = told.iter().map(|(n, area)| area.min(most * f64::from(*n))).sum();
    let points = |cells: &[(u32, f64)]| cells.iter().map(|(n, _)| f64::from(*n)).sum::<f64>();
    (area * points(&cells) / points(&told)) as f32
}
