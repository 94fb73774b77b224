use super::binary::{Binary, Content};
use super::stack::DEPTH;
use super::{Boxes, Child, Kind, LANES, Node, Tree};
use crate::math::Bounds;

/// Expected cost of a node that is entered, and of a leaf, in the same unit. They are about alike: eight
/// boxes or eight triangles.
const NODE_COST: f32 = 1.0;
const LEAF_COST: f32 = 1.2;

/// How much sooner a leaf is entered than a node of its size where any hit will do: it answers at once.
/// Without, such rays take a fifth longer.
const LEAF_GAIN: f32 = 3.0;

/// One item in a leaf of its own kind.
const OTHER_COST: f32 = 2.0;

impl Tree {
    /// Builds over boxes, none of which may be empty. `leaf` is told what to keep together and returns a
    /// number of its own for it, below 2³⁰. The same boxes give the same tree.
    pub fn build(
        boxes: &(impl Boxes + ?Sized),
        kind: impl Fn(u32) -> Kind,
        mut leaf: impl FnMut(Kind, &[u32]) -> u32,
    ) -> Self {
        if boxes.count() == 0 {
            return Self { nodes: Vec::new(), root: Child::NONE };
        }
        let mut plan = Plan::new(Binary::clustered(boxes), &kind);
        if plan.stack_needed(0, 0) > DEPTH {
            plan = Plan::new(Binary::halved(boxes), &kind);
        }
        let mut tree = Self { nodes: Vec::with_capacity(boxes.count() as usize / 7), root: Child::NONE };
        tree.root = tree.lay_out(&plan, 0, boxes, &mut leaf).0;
        tree.nodes.shrink_to_fit();
        tree
    }

    /// Adds what the plan makes of a binary node, depth first, and returns it with its bounds.
    fn lay_out(
        &mut self,
        plan: &Plan,
        at: u32,
        boxes: &(impl Boxes + ?Sized),
        leaf: &mut impl FnMut(Kind, &[u32]) -> u32,
    ) -> (Child, Bounds) {
        let mut list = List::default();
        if let Some(kind) = plan.leaf_kind(at) {
            plan.items(at, &mut list);
            let bounds = list.as_slice().iter().fold(Bounds::EMPTY, |b, &i| b.union(boxes.get(i)));
            return (Child::leaf(kind, leaf(kind, list.as_slice())), bounds);
        }
        plan.children(at, LANES, &mut list);
        // What stops a ray soonest first: see `Tree::traverse`.
        let leaf_gain = |at: u32| if plan.leaf_kind(at).is_some() { LEAF_GAIN } else { 1.0 };
        let weight = |at: u32| plan.binary.area(at) * leaf_gain(at);
        list.as_mut_slice().sort_by(|&a, &b| weight(b).total_cmp(&weight(a)));
        let number = self.nodes.len();
        self.nodes.push(Node::EMPTY);
        let mut all = Bounds::EMPTY;
        for (lane, &child) in list.as_slice().iter().enumerate() {
            let (content, bounds) = self.lay_out(plan, child, boxes, leaf);
            all = all.union(bounds);
            let node = &mut self.nodes[number];
            node.children[lane] = content;
            for axis in 0..3 {
                node.sides[axis][0][lane] = bounds.min[axis];
                node.sides[axis][1][lane] = bounds.max[axis];
            }
        }
        (Child::node(number), all)
    }
}

/// Up to eight numbers.
#[derive(Default)]
struct List {
    numbers: [u32; LANES],
    len: usize,
}

impl List {
    fn push(&mut self, number: u32) {
        self.numbers[self.len] = number;
        self.len += 1;
    }

    fn as_slice(&self) -> &[u32] {
        &self.numbers[..self.len]
    }

    fn as_mut_slice(&mut self) -> &mut [u32] {
        &mut self.numbers[..self.len]
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
    choices: Vec<Choice>,
}

/// What becomes of a binary node.
#[derive(Clone, Copy)]
struct Choice {
    /// What leaf it is where it has one slot; `None` for a node.
    leaf: Option<Kind>,
    /// How many of `n` slots the left child gets, at `n - 2`; zero where fewer slots are as good. The last
    /// is how a node of its own is shared out.
    left: [u8; LANES - 1],
}

/// What is below a binary node.
#[derive(Clone, Copy)]
struct Below {
    /// How many items, up to 255.
    count: u8,
    /// Their kind if it is one.
    kind: Option<Kind>,
    /// The costs for one slot to seven.
    costs: [f32; LANES - 1],
}

impl Plan {
    fn new(binary: Binary, kind: &impl Fn(u32) -> Kind) -> Self {
        let n = binary.nodes.len();
        let mut choices = vec![Choice { leaf: None, left: [0; LANES - 1] }; n];
        // What has no parent yet: a node's children come after it, the left one first.
        let mut below: Vec<Below> = Vec::new();
        for at in (0..n as u32).rev() {
            let area = binary.area(at);
            let choice = &mut choices[at as usize];
            let made = match binary.content(at) {
                Content::Item(item) => {
                    let kind = kind(item);
                    choice.leaf = Some(kind);
                    Below { count: 1, kind: Some(kind), costs: [leaf_cost(kind) * area; LANES - 1] }
                }
                Content::Inner(_) => match (below.pop(), below.pop()) {
                    (Some(left), Some(right)) => choice.make(area, &left, &right),
                    _ => unreachable!("both children were before"),
                },
            };
            below.push(made);
        }
        Self { binary, choices }
    }

    fn leaf_kind(&self, at: u32) -> Option<Kind> {
        self.choices[at as usize].leaf
    }

    /// The children of a wide node at `at`.
    fn children(&self, at: u32, slots: usize, out: &mut List) {
        let left_of = &self.choices[at as usize].left;
        let own = slots == LANES;
        let slots = if own { LANES } else { (2..=slots).rev().find(|&s| left_of[s - 2] > 0).unwrap_or(1) };
        match self.binary.content(at) {
            Content::Inner([left, right]) if slots > 1 => {
                let split = usize::from(left_of[slots - 2]);
                self.children(left, split.min(7), out);
                self.children(right, (slots - split).min(7), out);
            }
            _ => out.push(at),
        }
    }

    /// The items below `at`.
    fn items(&self, at: u32, out: &mut List) {
        match self.binary.content(at) {
            Content::Item(item) => out.push(item),
            Content::Inner(children) => children.iter().for_each(|&c| self.items(c, out)),
        }
    }

    /// Entries that a traversal's stack must hold below `at` where it holds some already; not to the end
    /// where they are too many.
    fn stack_needed(&self, at: u32, held: usize) -> usize {
        if held > DEPTH || self.leaf_kind(at).is_some() {
            return held;
        }
        let mut children = List::default();
        self.children(at, LANES, &mut children);
        let held = held + children.len - 1;
        children.as_slice().iter().map(|&c| self.stack_needed(c, held)).max().unwrap_or(held)
    }
}

impl Choice {
    /// Chooses for a node of this area over two children.
    fn make(&mut self, area: f32, left: &Below, right: &Below) -> Below {
        let kind = left.kind.filter(|_| left.kind == right.kind);
        let count = left.count.saturating_add(right.count);
        let [most_left, most_right] = [left, right].map(|side| usize::from(side.count).min(LANES - 1));
        // More slots than items change nothing.
        let shared = |slots: usize| {
            let slots = slots.min(most_left + most_right);
            let mut best = (f32::INFINITY, 1);
            for k in slots.saturating_sub(most_right).max(1)..=most_left.min(slots - 1) {
                let cost = left.costs[k - 1] + right.costs[slots - k - 1];
                if cost < best.0 {
                    best = (cost, k as u8);
                }
            }
            best
        };
        let (within, split) = shared(LANES);
        self.left[LANES - 2] = split;
        let as_node = within + NODE_COST * area;
        let as_leaf = match kind {
            Some(kind @ (Kind::Triangles | Kind::Flats)) if usize::from(count) <= LANES => {
                leaf_cost(kind) * area
            }
            _ => f32::INFINITY,
        };
        self.leaf = kind.filter(|_| as_leaf <= as_node);
        let mut costs = [as_leaf.min(as_node); LANES - 1];
        for slots in 2..LANES {
            costs[slots - 1] = costs[slots - 2];
            if slots > usize::from(count) {
                continue;
            }
            let (best, split) = shared(slots);
            if best < costs[slots - 1] {
                costs[slots - 1] = best;
                self.left[slots - 2] = split;
            }
        }
        Below { count, kind, costs }
    }
}

fn leaf_cost(kind: Kind) -> f32 {
    match kind {
        Kind::Triangles | Kind::Flats => LEAF_COST,
        Kind::Other => OTHER_COST,
    }
}
