use obvhs::aabb::Aabb;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};

use crate::math::Bounds;

/// A binary tree with one item to a leaf.
pub(super) struct Binary {
    /// The root first; a parent before its children.
    pub nodes: Vec<BinaryNode>,
}

pub(super) struct BinaryNode {
    pub bounds: Bounds,
    /// Its surface area in units in which the whole is about 1.
    pub area: f32,
    pub content: Content,
}

#[derive(Clone, Copy)]
pub(super) enum Content {
    /// The children, both further on in the list.
    Inner([u32; 2]),
    Item(u32),
}

/// Part of the nodes that are looked at again for a better place. More costs time when building and
/// saves little when tracing.
const REINSERTION: f32 = 0.02;

/// The part of these that each round takes.
const ROUNDS: [f32; 6] = [1.0, 1.0 / 3.0, 1.0 / 5.0, 1.0 / 9.0, 1.0 / 17.0, 1.0 / 31.0];

impl Binary {
    /// By locally ordered clustering, then reinsertion, as `obvhs` does them on one thread. There must
    /// be at least one box, and none may be empty.
    pub fn clustered(boxes: &[Bounds]) -> Self {
        let scale = unit_scale(boxes);
        let aabb = |b: &Bounds| Aabb::new((b.min * scale).into(), (b.max * scale).into());
        let scaled: Vec<Aabb> = boxes.iter().map(aabb).collect();
        let indices = (0..boxes.len() as u32).collect();
        let mut tree =
            PlocBuilder::new().build(PlocSearchDistance::Low, &scaled, indices, SortPrecision::U64, 2);
        ReinsertionOptimizer::default().run(&mut tree, REINSERTION, Some(ROUNDS.to_vec()));

        let mut nodes = Vec::with_capacity(tree.nodes.len());
        // Where the parent waits for the number of this child.
        let mut waiting = vec![(0u32, None::<(usize, usize)>)];
        while let Some((old, parent)) = waiting.pop() {
            let at = nodes.len();
            if let Some((parent, side)) = parent
                && let BinaryNode { content: Content::Inner(children), .. } = &mut nodes[parent]
            {
                children[side] = at as u32;
            }
            let node = &tree.nodes[old as usize];
            if node.is_leaf() {
                let item = tree.primitive_indices[node.first_index as usize];
                nodes.push(BinaryNode::new(boxes[item as usize], scale, Content::Item(item)));
            } else {
                let area = 2.0 * node.aabb().half_area();
                nodes.push(BinaryNode { bounds: Bounds::EMPTY, area, content: Content::Inner([0; 2]) });
                waiting.push((node.first_index + 1, Some((at, 1))));
                waiting.push((node.first_index, Some((at, 0))));
            }
        }
        // From the boxes themselves, as scaled ones may have been rounded.
        for at in (0..nodes.len()).rev() {
            if let Content::Inner([left, right]) = nodes[at].content {
                nodes[at].bounds = nodes[left as usize].bounds.union(nodes[right as usize].bounds);
            }
        }
        Self { nodes }
    }

    /// In halves by count: never deep, and no more.
    pub fn halved(boxes: &[Bounds]) -> Self {
        let mut items: Vec<u32> = (0..boxes.len() as u32).collect();
        let mut nodes = Vec::with_capacity(2 * boxes.len());
        halve(boxes, unit_scale(boxes), &mut items, &mut nodes);
        Self { nodes }
    }
}

fn halve(boxes: &[Bounds], scale: f32, items: &mut [u32], nodes: &mut Vec<BinaryNode>) -> u32 {
    let at = nodes.len();
    let bounds = items.iter().fold(Bounds::EMPTY, |b, &i| b.union(boxes[i as usize]));
    nodes.push(BinaryNode::new(bounds, scale, Content::Item(items[0])));
    if items.len() > 1 {
        let e = bounds.extent();
        let axis = (0..3).max_by(|&a, &b| e[a].total_cmp(&e[b])).unwrap_or(0);
        let center = |i: u32| boxes[i as usize].min[axis] + boxes[i as usize].max[axis];
        let middle = items.len() / 2;
        items.select_nth_unstable_by(middle, |&a, &b| center(a).total_cmp(&center(b)).then(a.cmp(&b)));
        let (left, right) = items.split_at_mut(middle);
        let children = [halve(boxes, scale, left, nodes), halve(boxes, scale, right, nodes)];
        nodes[at].content = Content::Inner(children);
    }
    at as u32
}

impl BinaryNode {
    fn new(bounds: Bounds, scale: f32, content: Content) -> Self {
        let area = Bounds { min: bounds.min * scale, max: bounds.max * scale }.area();
        Self { bounds, area, content }
    }
}

/// A power of two that brings coordinates to about 1: areas then neither vanish nor overflow, and the
/// same scene in other units has the same tree.
fn unit_scale(boxes: &[Bounds]) -> f32 {
    let reach =
        boxes.iter().fold(0.0f32, |r, b| r.max(b.min.abs().max_element()).max(b.max.abs().max_element()));
    // The exponent of the inverse, kept within what a normal number can have.
    let exponent = 127 - ((reach.to_bits() >> 23) as i32 - 127);
    f32::from_bits((exponent.clamp(1, 254) as u32) << 23)
}
