use obvhs::aabb::Aabb;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};

use rayon::prelude::*;

use super::Boxes;
use super::part::part;
use crate::math::Bounds;
use crate::observer::Work;

/// A binary tree with one item to a leaf.
pub(super) struct Binary {
    /// The root first, then what is left of it, then what is right, and so on in each.
    pub nodes: Vec<BinaryNode>,
}

#[derive(Clone, Copy)]
pub(super) struct BinaryNode {
    /// Its surface area in units in which the whole is about 1.
    pub area: f32,
    /// Its number with [`LEAF`] set if it is an item, else the right child. The left one comes next.
    link: u32,
}

#[derive(Clone, Copy)]
pub(super) enum Content {
    /// The children.
    Inner([u32; 2]),
    Item(u32),
}

const LEAF: u32 = 1 << 31;

/// As many boxes are clustered together at most.
const TOGETHER: usize = 1 << 18;

/// And where there are more, as many in each part.
const PART: usize = 1 << 16;

/// Part of the nodes that are looked at again for a better place. More costs time when building and
/// saves little when tracing.
const REINSERTION: f32 = 0.02;

/// The part of these that each round takes.
const ROUNDS: [f32; 6] = [1.0, 1.0 / 3.0, 1.0 / 5.0, 1.0 / 9.0, 1.0 / 17.0, 1.0 / 31.0];

impl Binary {
    /// By locally ordered clustering, then reinsertion, as `obvhs` does them on one thread. There must
    /// be at least one box, and none may be empty. Many boxes are parted first, and the parts clustered on all threads,
    /// each into its place: what is needed besides is as much memory as a part takes, for each thread.
    pub fn clustered(work: &Work<'_>, boxes: &(impl Boxes + ?Sized)) -> Self {
        let scale = unit_scale(boxes);
        let mut items: Vec<u32> = (0..boxes.count()).collect();
        let mut nodes = vec![BinaryNode { area: 0.0, link: 0 }; 2 * items.len() - 1];
        if items.len() <= TOGETHER {
            cluster(boxes, scale, &items, 0, &mut nodes);
            work.advance(items.len() as u64);
            return Self { nodes };
        }
        let whole = part(boxes, scale, &mut items, PART);
        let mut parts = whole.parts.into_iter();
        let mut places = Vec::new();
        let (mut rest, mut next) = (&mut nodes[..], 0);
        // Inner nodes whose right child is to come.
        let mut waiting: Vec<&mut BinaryNode> = Vec::new();
        for area in whole.areas {
            let own = if area.is_some() { None } else { parts.next() };
            let count = own.as_ref().map_or(1, |own| 2 * own.len() - 1);
            let (place, after) = rest.split_at_mut(count);
            rest = after;
            match (area, own) {
                (Some(area), _) => {
                    place[0].area = area;
                    waiting.extend(place);
                }
                (None, own) => {
                    places.push((own.unwrap_or_default(), next, place));
                    if let Some(parent) = waiting.pop() {
                        parent.link = (next + count) as u32;
                    }
                }
            }
            next += count;
        }
        places.into_par_iter().for_each(|(own, first, place)| {
            let count = own.len() as u64;
            cluster(boxes, scale, &items[own], first as u32, place);
            work.advance(count);
        });
        Self { nodes }
    }

    /// In halves by count: never deep, and no more.
    pub fn halved(boxes: &(impl Boxes + ?Sized)) -> Self {
        let mut items: Vec<u32> = (0..boxes.count()).collect();
        let mut nodes = Vec::with_capacity(2 * items.len());
        halve(boxes, unit_scale(boxes), &mut items, &mut nodes);
        Self { nodes }
    }

    /// As deep as there can be: each node has an item, and all the rest on the other side.
    #[cfg(test)]
    pub fn chain(count: u32, rest_is_left: bool) -> Self {
        let last = 2 * count - 2;
        let node = |at: u32| match rest_is_left {
            true if at < count - 1 => last - at,
            true => LEAF | (at - (count - 1)),
            false if at.is_multiple_of(2) && at < last => at + 2,
            false => LEAF | at.div_ceil(2).min(count - 1),
        };
        Self { nodes: (0..=last).map(|at| BinaryNode { area: 1.0, link: node(at) }).collect() }
    }

    #[inline]
    pub fn content(&self, at: u32) -> Content {
        let link = self.nodes[at as usize].link;
        if link & LEAF != 0 { Content::Item(link ^ LEAF) } else { Content::Inner([at + 1, link]) }
    }

    #[inline]
    pub fn area(&self, at: u32) -> f32 {
        self.nodes[at as usize].area
    }
}

/// Lays out a tree over some of the boxes as [`Binary::nodes`], from the number `first` on.
fn cluster(boxes: &(impl Boxes + ?Sized), scale: f32, items: &[u32], first: u32, nodes: &mut [BinaryNode]) {
    let aabb = |b: Bounds| Aabb::new((b.min * scale).into(), (b.max * scale).into());
    let scaled: Vec<Aabb> = items.iter().map(|&i| aabb(boxes.get(i))).collect();
    let indices = (0..items.len() as u32).collect();
    let mut tree = PlocBuilder::new().build(PlocSearchDistance::Low, &scaled, indices, SortPrecision::U64, 3);
    drop(scaled);
    ReinsertionOptimizer::default().run(&mut tree, REINSERTION, Some(ROUNDS.to_vec()));

    let mut next = Some(0u32);
    // Nodes whose right child is to come, with its place in `tree`.
    let mut waiting: Vec<(usize, u32)> = Vec::new();
    for at in 0..nodes.len() {
        let Some(old) = next else { break };
        let node = &tree.nodes[old as usize];
        let area = 2.0 * node.aabb().half_area();
        if node.is_leaf() {
            let own = tree.primitive_indices[node.first_index as usize];
            nodes[at] = BinaryNode::item(area, items[own as usize]);
            next = waiting.pop().map(|(parent, right)| {
                nodes[parent].link = first + at as u32 + 1;
                right
            });
        } else {
            waiting.push((at, node.first_index + 1));
            nodes[at] = BinaryNode { area, link: 0 };
            next = Some(node.first_index);
        }
    }
}

impl BinaryNode {
    fn item(area: f32, item: u32) -> Self {
        Self { area, link: item | LEAF }
    }
}

fn halve(boxes: &(impl Boxes + ?Sized), scale: f32, items: &mut [u32], nodes: &mut Vec<BinaryNode>) {
    let at = nodes.len();
    let bounds = items.iter().fold(Bounds::EMPTY, |b, &i| b.union(boxes.get(i)));
    let area = Bounds { min: bounds.min * scale, max: bounds.max * scale }.area();
    nodes.push(BinaryNode::item(area, items[0]));
    if items.len() > 1 {
        let e = bounds.extent();
        let axis = (0..3).max_by(|&a, &b| e[a].total_cmp(&e[b])).unwrap_or(0);
        let center = |i: u32| boxes.get(i).min[axis] + boxes.get(i).max[axis];
        let middle = items.len() / 2;
        items.select_nth_unstable_by(middle, |&a, &b| center(a).total_cmp(&center(b)).then(a.cmp(&b)));
        let (left, right) = items.split_at_mut(middle);
        halve(boxes, scale, left, nodes);
        nodes[at].link = nodes.len() as u32;
        halve(boxes, scale, right, nodes);
    }
}

/// A power of two that brings coordinates to about 1: areas then neither vanish nor overflow, and the
/// same scene in other units has the same tree.
fn unit_scale(boxes: &(impl Boxes + ?Sized)) -> f32 {
    let all = (0..boxes.count()).fold(Bounds::EMPTY, |all, i| all.union(boxes.get(i)));
    let reach = all.min.abs().max_element().max(all.max.abs().max_element());
    // The exponent of the inverse, kept within what a normal number can have.
    let exponent = 127 - ((reach.to_bits() >> 23) as i32 - 127);
    f32::from_bits((exponent.clamp(1, 254) as u32) << 23)
}
