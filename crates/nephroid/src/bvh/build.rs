use super::binary::{Binary, BinaryNode, Content};
use super::traverse::STACK;
use super::{Child, Kind, LANES, Node, Tree};
use crate::math::Bounds;

/// Expected cost of a node that is entered, and of a leaf, in the same unit. They are about alike: eight
/// boxes or eight triangles.
const NODE_COST: f32 = 1.0;
const LEAF_COST: f32 = 1.2;

/// One item in a leaf of its own kind.
const OTHER_COST: f32 = 2.0;

impl Tree {
    /// Builds over boxes, none of which may be empty. `leaf` is told what to keep together and returns a
    /// number of its own for it, below 2³⁰. The same boxes give the same tree.
    pub fn build(
        boxes: &[Bounds],
        kind: impl Fn(u32) -> Kind,
        mut leaf: impl FnMut(Kind, &[u32]) -> u32,
    ) -> Self {
        if boxes.is_empty() {
            return Self { nodes: Vec::new(), root: Child::NONE };
        }
        let mut plan = Plan::new(Binary::clustered(boxes), &kind);
        if plan.stack_needed(0, 0) > STACK {
            plan = Plan::new(Binary::halved(boxes), &kind);
        }
        let mut tree = Self { nodes: Vec::new(), root: Child::NONE };
        tree.root = tree.lay_out(&plan, 0, &mut leaf);
        tree
    }

    /// Adds what the plan makes of a binary node, depth first.
    fn lay_out(&mut self, plan: &Plan, at: u32, leaf: &mut impl FnMut(Kind, &[u32]) -> u32) -> Child {
        if let Some(kind) = plan.leaf_kind(at) {
            let mut items = Vec::with_capacity(LANES);
            plan.items(at, &mut items);
            return Child::leaf(kind, leaf(kind, &items));
        }
        let mut children = Vec::with_capacity(LANES);
        plan.children(at, LANES, &mut children);
        // Large ones first: see `Tree::traverse`.
        let area = |&child: &u32| plan.binary.nodes[child as usize].area;
        children.sort_by(|a, b| area(b).total_cmp(&area(a)));
        let number = self.nodes.len();
        self.nodes.push(Node::EMPTY);
        for (lane, &child) in children.iter().enumerate() {
            let bounds = plan.binary.nodes[child as usize].bounds;
            let content = self.lay_out(plan, child, leaf);
            let node = &mut self.nodes[number];
            node.children[lane] = content;
            for axis in 0..3 {
                node.sides[axis][0][lane] = bounds.min[axis];
                node.sides[axis][1][lane] = bounds.max[axis];
            }
        }
        Child::node(number)
    }
}

impl Node {
    pub(super) const EMPTY: Self = Self {
        sides: [[[f32::INFINITY; LANES], [f32::NEG_INFINITY; LANES]]; 3],
        children: [Child::NONE; LANES],
    };
}

/// How a binary tree is best made into one with up to eight children a node: for every binary node and
/// number of slots the least cost of representing it as that many subtrees, from the bottom up
/// (Ylitie, Karras and Laine 2017, *Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide
/// BVHs*, §3.1).
struct Plan {
    binary: Binary,
    /// Of each binary node how many items there are, up to 255, and their kind if it is one kind.
    counts: Vec<(u8, Option<Kind>)>,
    /// How many of `n` slots the left child gets, at `n - 1`; zero where fewer slots are as good. At 0
    /// one where a leaf is made, at 7 how a node of its own is shared out.
    choices: Vec<[u8; LANES]>,
}

impl Plan {
    fn new(binary: Binary, kind: &impl Fn(u32) -> Kind) -> Self {
        let n = binary.nodes.len();
        let mut counts = vec![(0u8, None); n];
        let mut choices = vec![[0; LANES]; n];
        // Costs for one slot to seven.
        let mut costs = vec![[f32::INFINITY; LANES - 1]; n];
        for at in (0..n).rev() {
            let area = binary.nodes[at].area;
            let [left, right] = match binary.nodes[at].content {
                Content::Item(item) => {
                    let kind = kind(item);
                    counts[at] = (1, Some(kind));
                    choices[at][0] = 1;
                    costs[at] = [leaf_cost(kind) * area; LANES - 1];
                    continue;
                }
                Content::Inner(children) => children.map(|c| c as usize),
            };
            let one_kind = counts[left].1.filter(|_| counts[left].1 == counts[right].1);
            let count = counts[left].0.saturating_add(counts[right].0);
            counts[at] = (count, one_kind);
            let shared = |slots: usize| {
                (1..slots)
                    .map(|k| (costs[left][k.min(7) - 1] + costs[right][(slots - k).min(7) - 1], k as u8))
                    .fold((f32::INFINITY, 1), |best, x| if x.0 < best.0 { x } else { best })
            };
            let (below, split) = shared(LANES);
            let as_node = below + NODE_COST * area;
            choices[at][LANES - 1] = split;
            let as_leaf = match one_kind {
                Some(kind @ (Kind::Triangles | Kind::Flats)) if usize::from(count) <= LANES => {
                    leaf_cost(kind) * area
                }
                _ => f32::INFINITY,
            };
            choices[at][0] = u8::from(as_leaf <= as_node);
            let mut cost = [as_leaf.min(as_node); LANES - 1];
            for slots in 2..LANES {
                let (best, split) = shared(slots);
                cost[slots - 1] = cost[slots - 2];
                if best < cost[slots - 2] {
                    cost[slots - 1] = best;
                    choices[at][slots - 1] = split;
                }
            }
            costs[at] = cost;
        }
        Self { binary, counts, choices }
    }

    fn leaf_kind(&self, at: u32) -> Option<Kind> {
        self.counts[at as usize].1.filter(|_| self.choices[at as usize][0] == 1)
    }

    fn node(&self, at: u32) -> &BinaryNode {
        &self.binary.nodes[at as usize]
    }

    /// The children of a wide node at `at`.
    fn children(&self, at: u32, slots: usize, out: &mut Vec<u32>) {
        let choice = &self.choices[at as usize];
        let own = slots == LANES;
        let slots = if own { LANES } else { (2..=slots).rev().find(|&s| choice[s - 1] > 0).unwrap_or(1) };
        match self.node(at).content {
            Content::Inner([left, right]) if slots > 1 => {
                let split = usize::from(choice[slots - 1]);
                self.children(left, split.min(7), out);
                self.children(right, (slots - split).min(7), out);
            }
            _ => out.push(at),
        }
    }

    /// The items below `at`.
    fn items(&self, at: u32, out: &mut Vec<u32>) {
        match self.node(at).content {
            Content::Item(item) => out.push(item),
            Content::Inner(children) => children.iter().for_each(|&c| self.items(c, out)),
        }
    }

    /// Entries that a traversal's stack must hold below `at` where it holds some already; not to the end
    /// where they are too many.
    fn stack_needed(&self, at: u32, held: usize) -> usize {
        if held > STACK || self.leaf_kind(at).is_some() {
            return held;
        }
        let mut children = Vec::with_capacity(LANES);
        self.children(at, LANES, &mut children);
        let held = held + children.len() - 1;
        children.iter().map(|&c| self.stack_needed(c, held)).max().unwrap_or(held)
    }
}

fn leaf_cost(kind: Kind) -> f32 {
    match kind {
        Kind::Triangles | Kind::Flats => LEAF_COST,
        Kind::Other => OTHER_COST,
    }
}
