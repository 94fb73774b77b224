use std::mem;

use super::binary::{Binary, Content};
use super::stack::DEPTH;
use super::{Boxes, Child, Kind, LANES, Node, Tree};
use crate::math::Bounds;
use crate::observer::Work;

/// Expected cost of a node that is entered, and of a leaf, in the same unit. They are about alike: eight
/// boxes or eight triangles.
const NODE_COST: f32 = 1.0;
const LEAF_COST: f32 = 1.2;

/// How much sooner a leaf is entered than a node of its size where any hit will do: it answers at once.
/// Without, such rays take a fifth longer.
const LEAF_GAIN: f32 = 3.0;

/// Of as many items it is told at once that they are in their place.
const TOLD_TOGETHER: u64 = 1 << 14;

/// One item in a leaf of its own kind.
const OTHER_COST: f32 = 2.0;

impl Tree {
    /// Builds over boxes, at most 2²⁸ and none empty. `leaf` is told what to keep together and returns a
    /// number of its own for it, below 2³¹ for triangles and 2²⁹ for others. The same boxes give the same tree.
    /// Each box is counted twice as work.
    pub fn build(
        work: &Work<'_>,
        boxes: &(impl Boxes + ?Sized),
        kind: impl Fn(u32) -> Kind + Sync,
        mut leaf: impl FnMut(Kind, &[u32]) -> u32,
    ) -> Self {
        if boxes.count() == 0 {
            return Self { nodes: Vec::new(), root: Child::NONE };
        }
        let (plan, needed) = Plan::shallow(work, boxes, &kind);
        // Nodes are aligned, and what is aligned is copied when it grows or shrinks.
        let mut tree = Self { nodes: Vec::with_capacity(needed.nodes), root: Child::NONE };
        let mut untold = 0;
        let mut told = |kind, items: &[u32]| {
            untold += items.len() as u64;
            if untold >= TOLD_TOGETHER {
                work.advance(mem::take(&mut untold));
            }
            leaf(kind, items)
        };
        tree.root = tree.lay_out(&plan, 0, boxes, &mut told).0;
        work.advance(untold);
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

/// What becomes of a binary node. Packed, as there are two for each item: in the lowest bits what leaf it is where it has
/// one slot, one more than its [`Kind`], or zero for a node; above, three bits each, how many of `n` slots the left child
/// gets, from `n` = 2 on, and zero where fewer slots are as good. The last is how a node of its own is shared out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Choice(u32);

impl Choice {
    const NONE: Self = Self(0);

    fn leaf(self) -> Option<Kind> {
        match self.0 & 3 {
            0 => None,
            1 => Some(Kind::Triangles),
            2 => Some(Kind::Flats),
            _ => Some(Kind::Other),
        }
    }

    fn left(self, slots: usize) -> usize {
        (self.0 >> Self::place(slots) & 7) as usize
    }

    /// To be said once.
    fn set_leaf(&mut self, kind: Option<Kind>) {
        self.0 |= kind.map_or(0, |kind| 1 + kind as u32);
    }

    /// To be said once for each number of slots.
    fn set_left(&mut self, slots: usize, count: u8) {
        self.0 |= u32::from(count) << Self::place(slots);
    }

    fn place(slots: usize) -> usize {
        2 + 3 * (slots - 2)
    }
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
    fn new(binary: Binary, kind: &(impl Fn(u32) -> Kind + Sync)) -> Self {
        let mut choices = vec![Choice::NONE; binary.nodes.len()];
        choose(&binary, 0, SHARED, &mut choices, kind);
        Self { binary, choices }
    }

    /// For at least one box, and what it needs, which a traversal's stack can hold.
    fn shallow(
        work: &Work<'_>,
        boxes: &(impl Boxes + ?Sized),
        kind: &(impl Fn(u32) -> Kind + Sync),
    ) -> (Self, Needed) {
        let clustered = Self::new(Binary::clustered(work, boxes), kind);
        let needed = clustered.needed(0, 0);
        if needed.stack <= DEPTH {
            return (clustered, needed);
        }
        drop(clustered);
        let halved = Self::new(Binary::halved(boxes), kind);
        let needed = halved.needed(0, 0);
        (halved, needed)
    }

    fn leaf_kind(&self, at: u32) -> Option<Kind> {
        self.choices[at as usize].leaf()
    }

    /// The children of a wide node at `at`.
    fn children(&self, at: u32, slots: usize, out: &mut List) {
        let choice = self.choices[at as usize];
        let own = slots == LANES;
        let slots = if own { LANES } else { (2..=slots).rev().find(|&s| choice.left(s) > 0).unwrap_or(1) };
        match self.binary.content(at) {
            Content::Inner([left, right]) if slots > 1 => {
                let split = choice.left(slots);
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

    /// What the tree below `at` needs where a traversal's stack holds some entries already. It does not go on where those
    /// are too many.
    fn needed(&self, at: u32, held: usize) -> Needed {
        let mut all = Needed { stack: held, nodes: 0 };
        if held > DEPTH || self.leaf_kind(at).is_some() {
            return all;
        }
        let mut children = List::default();
        self.children(at, LANES, &mut children);
        all.nodes = 1;
        for &child in children.as_slice() {
            let own = self.needed(child, held + children.len - 1);
            all = Needed { stack: all.stack.max(own.stack), nodes: all.nodes + own.nodes };
        }
        all
    }
}

/// What a tree will need.
struct Needed {
    /// Entries of a traversal's stack.
    stack: usize,
    nodes: usize,
}

/// As many nodes are chosen for on one thread.
const ALONE: usize = 1 << 14;

/// Down so many levels work is shared out, and no further: a tree over boxes that are all in one place may be as deep as it
/// has items, and a thread's stack is not.
const SHARED: u32 = 32;

/// Chooses for the node at `at` and all below it, of which there are as many as there is room for. Down so many `levels`
/// both sides are chosen for at once.
fn choose(
    binary: &Binary,
    at: u32,
    levels: u32,
    choices: &mut [Choice],
    kind: &(impl Fn(u32) -> Kind + Sync),
) -> Below {
    if let ([own, below @ ..], Content::Inner([left, right])) = (&mut *choices, binary.content(at))
        && below.len() >= ALONE
        && levels > 0
    {
        let (of_left, of_right) = below.split_at_mut((right - left) as usize);
        let (of_left, of_right) = rayon::join(
            || choose(binary, left, levels - 1, of_left, kind),
            || choose(binary, right, levels - 1, of_right, kind),
        );
        return own.make(binary.area(at), &of_left, &of_right);
    }
    // What has no parent yet: a node's children come after it, the left one first.
    let mut below: Vec<Below> = Vec::new();
    for (place, choice) in choices.iter_mut().enumerate().rev() {
        let at = at + place as u32;
        let area = binary.area(at);
        let made = match binary.content(at) {
            Content::Item(item) => {
                let kind = kind(item);
                choice.set_leaf(Some(kind));
                Below { count: 1, kind: Some(kind), costs: [leaf_cost(kind) * area; LANES - 1] }
            }
            Content::Inner(_) => match (below.pop(), below.pop()) {
                (Some(left), Some(right)) => choice.make(area, &left, &right),
                _ => unreachable!("both children were before"),
            },
        };
        below.push(made);
    }
    below.pop().unwrap_or(Below { count: 0, kind: None, costs: [0.0; LANES - 1] })
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
        self.set_left(LANES, split);
        let as_node = within + NODE_COST * area;
        let as_leaf = match kind {
            Some(kind @ (Kind::Triangles | Kind::Flats)) if usize::from(count) <= LANES => {
                leaf_cost(kind) * area
            }
            _ => f32::INFINITY,
        };
        self.set_leaf(kind.filter(|_| as_leaf <= as_node));
        let mut costs = [as_leaf.min(as_node); LANES - 1];
        for slots in 2..LANES {
            costs[slots - 1] = costs[slots - 2];
            if slots > usize::from(count) {
                continue;
            }
            let (best, split) = shared(slots);
            if best < costs[slots - 1] {
                costs[slots - 1] = best;
                self.set_left(slots, split);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;

    fn on_threads<T: Send>(threads: usize, run: impl FnOnce() -> T + Send) -> T {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(run)
    }

    #[test]
    fn a_chain_is_chosen_for_without_a_deep_stack() {
        for rest_is_left in [false, true] {
            let plan = || Plan::new(Binary::chain(40_000, rest_is_left), &|_| Kind::Triangles);
            let [one, three] = [1, 3].map(|threads| on_threads(threads, plan));
            assert!(one.needed(0, 0).stack > DEPTH);
            assert!(one.choices == three.choices);
            // And as where nothing is shared out.
            let mut alone = vec![Choice::NONE; one.choices.len()];
            choose(&one.binary, 0, 0, &mut alone, &|_| Kind::Triangles);
            assert!(one.choices == alone);
        }
    }

    #[test]
    fn boxes_in_one_place_are_built_in_halves() {
        let same = Bounds { min: Vec3::ZERO, max: Vec3::ONE };
        let boxes = vec![same; 3000];
        let work = Work::silent();
        let kind = |_| Kind::Triangles;
        let clustered = Plan::new(Binary::clustered(&work, &boxes[..]), &kind);
        assert!(clustered.needed(0, 0).stack > DEPTH);
        let (_, needed) = Plan::shallow(&work, &boxes[..], &kind);
        // Of eight children seven wait, and 3000 items are less than 8⁴.
        assert!(needed.stack <= 7 * 4, "{}", needed.stack);
    }
}
