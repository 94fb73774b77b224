use obvhs::aabb::Aabb;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};

use rayon::prelude::*;

use super::Boxes;
use super::part::part;
use crate::math::Bounds;

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
    /// be at least one box, and none may be empty. Many boxes are parted first, and the parts clustered on all threads:
    /// what is needed for it is as much memory as a part has for each thread.
    pub fn clustered(boxes: &(impl Boxes + ?Sized)) -> Self {
        let scale = unit_scale(boxes);
        let mut items: Vec<u32> = (0..boxes.count()).collect();
        if items.len() <= TOGETHER {
            return Self { nodes: clustered(boxes, scale, &items) };
        }
        let whole = part(boxes, scale, &mut items, PART);
        let parts: Vec<Vec<BinaryNode>> =
            whole.parts.par_iter().map(|own| clustered(boxes, scale, &items[own.clone()])).collect();
        drop(items);
        let mut nodes = Vec::with_capacity(parts.iter().map(Vec::len).sum::<usize>() + parts.len());
        let mut parts = parts.into_iter();
        // Inner nodes whose right child is to come.
        let mut waiting = Vec::new();
        for area in whole.areas {
            match area {
                Some(area) => {
                    waiting.push(nodes.len());
                    nodes.push(BinaryNode { area, link: 0 });
                }
                None => {
                    let first = nodes.len() as u32;
                    nodes.extend(parts.next().into_iter().flatten().map(|node| node.moved(first)));
                    if let Some(parent) = waiting.pop() {
                        nodes[parent].link = nodes.len() as u32;
                    }
                }
            }
        }
        Self { nodes }
    }

    /// In halves by count: never deep, and no more.
    pub fn halved(boxes: &(impl Boxes + ?Sized)) -> Self {
        let mut items: Vec<u32> = (0..boxes.count()).collect();
        let mut nodes = Vec::with_capacity(2 * items.len());
        halve(boxes, unit_scale(boxes), &mut items, &mut nodes);
        Self { nodes }
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

/// A tree over some of the boxes, laid out as [`Binary::nodes`].
fn clustered(boxes: &(impl Boxes + ?Sized), scale: f32, items: &[u32]) -> Vec<BinaryNode> {
    let aabb = |b: Bounds| Aabb::new((b.min * scale).into(), (b.max * scale).into());
    let scaled: Vec<Aabb> = items.iter().map(|&i| aabb(boxes.get(i))).collect();
    let indices = (0..items.len() as u32).collect();
    let mut tree = PlocBuilder::new().build(PlocSearchDistance::Low, &scaled, indices, SortPrecision::U64, 3);
    drop(scaled);
    ReinsertionOptimizer::default().run(&mut tree, REINSERTION, Some(ROUNDS.to_vec()));

    let mut nodes: Vec<BinaryNode> = Vec::with_capacity(tree.nodes.len());
    let mut next = Some(0u32);
    // Nodes whose right child is to come, with its place in `tree`.
    let mut waiting: Vec<(u32, u32)> = Vec::new();
    while let Some(old) = next {
        let node = &tree.nodes[old as usize];
        let area = 2.0 * node.aabb().half_area();
        if node.is_leaf() {
            let own = tree.primitive_indices[node.first_index as usize];
            nodes.push(BinaryNode::item(area, items[own as usize]));
            next = waiting.pop().map(|(parent, right)| {
                nodes[parent as usize].link = nodes.len() as u32;
                right
            });
        } else {
            waiting.push((nodes.len() as u32, node.first_index + 1));
            nodes.push(BinaryNode { area, link: 0 });
            next = Some(node.first_index);
        }
    }
    nodes
}

impl BinaryNode {
    /// As one of nodes that follow so many others.
    fn moved(self, by: u32) -> Self {
        Self { link: if self.link & LEAF != 0 { self.link } else { self.link + by }, ..self }
    }

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
