use super::stack::Stack;
use super::{Child, Kind, LANES, Lanes, Node, Tree, splat3};
use crate::math::{Ray, Vec3, gamma};

/// What widens the far end of an interval of distances by more than their rounding, so that nothing is
/// lost (Ize 2013, *Robust BVH Ray Traversal*, JCGT 2(2)).
const SLACK: f32 = 1.0 + 2.0 * gamma(3);

/// A ray as boxes are tested against it.
struct Slabs<L> {
    origin: [L; 3],
    inverse: [L; 3],
    /// For each axis whether the upper side of a box is the nearer.
    upper_first: [usize; 3],
}

impl<L: Lanes> Slabs<L> {
    #[inline(always)]
    fn new(ray: &Ray) -> Self {
        let inverse = (Vec3::ONE / ray.direction).to_array();
        Self {
            origin: splat3(ray.origin.to_array()),
            inverse: splat3(inverse),
            upper_first: inverse.map(|i| usize::from(i.is_sign_negative())),
        }
    }

    /// Where the ray comes to a side of the boxes.
    #[inline(always)]
    fn side(&self, node: &Node, axis: usize, upper: usize) -> L {
        L::load(&node.sides[axis][upper & 1]).minus(self.origin[axis]).times(self.inverse[axis])
    }

    /// Which boxes the ray meets before `t_max`, and where it enters each.
    #[inline(always)]
    fn meet(&self, node: &Node, t_max: f32) -> (u32, L) {
        // Where a ray runs inside the plane of a face, 0 · ∞ is not a number, and the other counts.
        let (mut near, mut far) = (L::splat(0.0), L::splat(t_max));
        for axis in 0..3 {
            near = self.side(node, axis, self.upper_first[axis]).larger(near);
            far = self.side(node, axis, 1 - self.upper_first[axis]).smaller(far);
        }
        (near.le(far.times(L::splat(SLACK))), near)
    }
}

/// An entry of the stack: where the ray enters above, which child below. As distances are not negative,
/// entries are in the order of the distances.
#[inline(always)]
fn entry(near: f32, child: Child) -> u64 {
    u64::from(near.to_bits()) << 32 | u64::from(child.0)
}

/// Who goes through a tree.
pub(crate) trait Visitor {
    /// Takes the kind and number of a leaf and the end of the ray, which it may bring nearer; ends the
    /// traversal by returning true.
    fn visit(&mut self, kind: Kind, number: usize, t_max: &mut f32) -> bool;

    /// Has a leaf brought from memory that may be visited soon.
    fn prefetch(&self, kind: Kind, number: usize);
}

impl Tree {
    #[inline(always)]
    fn prefetch<L: Lanes>(&self, child: Child, visitor: &impl Visitor) {
        match child.unpack() {
            (Some(kind), number) => visitor.prefetch(kind, number),
            (None, number) => {
                if let Some(node) = self.nodes.get(number) {
                    L::prefetch(node);
                }
            }
        }
    }

    /// Visits the leaves whose boxes the ray meets, near ones first unless `ANY` leaf may come first.
    /// Returns whether the visitor ended the traversal.
    #[inline(always)]
    pub fn traverse<L: Lanes, const ANY: bool>(
        &self,
        ray: &Ray,
        t_max: &mut f32,
        visitor: &mut impl Visitor,
    ) -> bool {
        // Of numbers that are none, or infinite, comes nothing; lanes without a child would be entered.
        if self.root == Child::NONE || !ray.origin.is_finite() || !ray.direction.is_finite() {
            return false;
        }
        let slabs = Slabs::<L>::new(ray);
        let mut stack = Stack::new();
        let mut at = self.root;
        loop {
            let (kind, number) = at.unpack();
            if let Some(kind) = kind {
                if visitor.visit(kind, number, t_max) {
                    return true;
                }
            } else {
                let node = &self.nodes[number];
                let (mut mask, near) = slabs.meet(node, *t_max);
                if mask != 0 {
                    let first = mask.trailing_zeros() as usize % LANES;
                    mask &= mask - 1;
                    if mask == 0 {
                        at = node.children[first];
                        continue;
                    }
                    if ANY {
                        // Large boxes and leaves come first in a node: what is in them stops the ray soonest.
                        at = node.children[first];
                        while mask != 0 {
                            let lane = mask.ilog2() as usize % LANES;
                            mask ^= 1 << lane;
                            self.prefetch::<L>(node.children[lane], visitor);
                            stack.push(entry(0.0, node.children[lane]));
                        }
                        continue;
                    }
                    let near = near.store();
                    let bottom = stack.held();
                    let mut nearest = entry(near[first], node.children[first]);
                    while mask != 0 {
                        let lane = mask.trailing_zeros() as usize % LANES;
                        mask &= mask - 1;
                        self.prefetch::<L>(node.children[lane], visitor);
                        let mut other = entry(near[lane], node.children[lane]);
                        if other < nearest {
                            std::mem::swap(&mut other, &mut nearest);
                        }
                        stack.insert(bottom, other);
                    }
                    at = Child(nearest as u32);
                    continue;
                }
            }
            loop {
                let Some(next) = stack.pop() else { return false };
                if f32::from_bits((next >> 32) as u32) <= *t_max * SLACK {
                    at = Child(next as u32);
                    break;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Boxes, Simd, Work};
    use super::*;
    use crate::math::{Bounds, warp};
    use crate::observer;
    use crate::sampling::{Key, Sampler, Sequence, Stream};

    fn sampler(i: u64) -> Sampler {
        Sampler::new(Sequence::Independent, Key::new(4, 0, Stream::Camera), i)
    }

    /// The items of all leaves that a ray comes to.
    struct Visited<'a>(&'a Tree, &'a [Vec<u32>], Ray);

    struct Found<'a>(&'a [Vec<u32>], Vec<u32>);

    impl Visitor for Found<'_> {
        fn visit(&mut self, _: Kind, leaf: usize, _: &mut f32) -> bool {
            self.1.extend(&self.0[leaf]);
            false
        }

        fn prefetch(&self, _: Kind, _: usize) {}
    }

    impl Work for Visited<'_> {
        type Output = Vec<u32>;
        #[inline(always)]
        fn run<L: Lanes>(self) -> Vec<u32> {
            let mut found = Found(self.1, Vec::new());
            self.0.traverse::<L, false>(&self.2, &mut self.2.t_max.clone(), &mut found);
            found.1
        }
    }

    /// Whether the ray meets a box, in double precision.
    fn meets(b: &Bounds, ray: &Ray) -> bool {
        let (mut near, mut far) = (0.0f64, f64::INFINITY);
        for axis in 0..3 {
            let (o, d) = (f64::from(ray.origin[axis]), f64::from(ray.direction[axis]));
            let (min, max) = (f64::from(b.min[axis]), f64::from(b.max[axis]));
            if d == 0.0 {
                if o < min || o > max {
                    return false;
                }
                continue;
            }
            let (x, y) = ((min - o) / d, (max - o) / d);
            (near, far) = (near.max(x.min(y)), far.min(x.max(y)));
        }
        near <= far
    }

    impl Boxes for [Bounds] {
        fn count(&self) -> u32 {
            self.len() as u32
        }

        fn get(&self, number: u32) -> Bounds {
            self[number as usize]
        }
    }

    fn check(boxes: &[Bounds], kind: Kind) {
        let mut leaves: Vec<Vec<u32>> = Vec::new();
        let tree = Tree::build(
            &observer::Work::silent(),
            boxes,
            |_| kind,
            |_, items| {
                leaves.push(items.to_vec());
                leaves.len() as u32 - 1
            },
        );
        let mut seen: Vec<u32> = leaves.concat();
        seen.sort_unstable();
        assert!(seen.iter().copied().eq(0..boxes.len() as u32), "every item once");
        for i in 0..300 {
            let mut s = sampler(i);
            let origin = warp::square_to_sphere(s.next_2d()) * 3.0 * s.next_1d();
            let mut direction = warp::square_to_sphere(s.next_2d());
            if i % 5 == 0 {
                direction = Vec3::X;
            }
            let ray = Ray::new(origin, direction);
            for simd in [Simd::Portable, Simd::detect()] {
                let mut found = simd.run(Visited(&tree, &leaves, ray));
                found.sort_unstable();
                for (k, b) in boxes.iter().enumerate() {
                    if meets(b, &ray) {
                        assert!(found.binary_search(&(k as u32)).is_ok(), "{simd:?} missed box {k}");
                    }
                }
            }
        }
    }

    #[test]
    fn every_box_a_ray_meets_is_visited() {
        let random = |n: u64, size: f32| -> Vec<Bounds> {
            (0..n)
                .map(|i| {
                    let mut s = sampler(1000 + i);
                    let p = warp::square_to_sphere(s.next_2d()) * s.next_1d();
                    Bounds { min: p, max: p + Vec3::splat(size * s.next_1d()) }
                })
                .collect()
        };
        let flat = Bounds { min: Vec3::new(-1.0, 0.0, -1.0), max: Vec3::new(1.0, 0.0, 1.0) };
        // Sizes that halve: the deepest tree that a heuristic can be led to.
        let nested = |n: i32| -> Vec<Bounds> {
            (0..n)
                .map(|i| {
                    let x = 0.5f32.powi(i);
                    Bounds { min: Vec3::splat(x * 0.5), max: Vec3::splat(x) }
                })
                .collect()
        };
        for kind in [Kind::Triangles, Kind::Other] {
            check(&[], kind);
            check(&random(1, 0.1), kind);
            check(&random(9, 0.1), kind);
            check(&random(300, 0.2), kind);
            check(&random(300, 0.0), kind);
            check(&vec![flat; 100], kind);
            check(&nested(120), kind);
            check(&nested(120).repeat(4), kind);
        }
    }
}
