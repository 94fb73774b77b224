use super::build::MAX_DEPTH;
use super::{Bvh, Node};
use crate::math::{Ray, Vec3, gamma};

impl Bvh {
    /// Visits the items whose boxes the ray meets, near ones first. `visit` takes the range of items
    /// of a leaf and the ray, may shorten the ray, and ends the traversal by returning true.
    #[inline]
    pub fn traverse(&self, ray: &mut Ray, mut visit: impl FnMut(std::ops::Range<usize>, &mut Ray) -> bool) {
        if self.nodes.is_empty() {
            return;
        }
        let inverse = Vec3::ONE / ray.direction;
        let mut stack = [0u32; MAX_DEPTH];
        let mut depth = 0;
        let mut at = 0usize;
        loop {
            let node = &self.nodes[at];
            if node.meets(ray, inverse) {
                if node.count == 0 {
                    let (near, far) = if ray.direction[usize::from(node.axis)] < 0.0 {
                        (node.first as usize, at + 1)
                    } else {
                        (at + 1, node.first as usize)
                    };
                    stack[depth] = far as u32;
                    depth += 1;
                    at = near;
                    continue;
                }
                let first = node.first as usize;
                if visit(first..first + usize::from(node.count), ray) {
                    return;
                }
            }
            if depth == 0 {
                return;
            }
            depth -= 1;
            at = stack[depth] as usize;
        }
    }
}

impl Node {
    /// Slab test, widened by the rounding of the distances so that nothing is lost
    /// (Ize 2013, *Robust BVH Ray Traversal*, JCGT 2(2)).
    #[inline]
    fn meets(&self, ray: &Ray, inverse: Vec3) -> bool {
        let a = (self.min - ray.origin) * inverse;
        let b = (self.max - ray.origin) * inverse;
        // `f32::min` and `max` prefer the number where the other is NaN (0 · ∞): a ray inside the
        // plane of a face then counts as between the faces.
        let near = a.x.min(b.x).max(a.y.min(b.y)).max(a.z.min(b.z)).max(0.0);
        let far = a.x.max(b.x).min(a.y.max(b.y)).min(a.z.max(b.z)).min(ray.t_max);
        near <= far * (1.0 + 2.0 * gamma(3))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Bounds, warp};
    use crate::sampling::{Key, Sampler, Sequence, Stream};

    fn sampler(i: u64) -> Sampler {
        Sampler::new(Sequence::Independent, Key::new(4, 0, Stream::Camera), i)
    }

    fn check(boxes: &[Bounds]) {
        let (bvh, order) = Bvh::build(boxes);
        let mut seen = order.clone();
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
            let mut found = Vec::new();
            bvh.traverse(&mut { ray }, |range, _| {
                found.extend(range.map(|k| order[k]));
                false
            });
            found.sort_unstable();
            for (k, b) in boxes.iter().enumerate() {
                let node = Node { min: b.min, max: b.max, first: 0, count: 1, axis: 0 };
                if node.meets(&ray, Vec3::ONE / direction) {
                    assert!(found.binary_search(&(k as u32)).is_ok(), "box {k} was missed");
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
        check(&[]);
        check(&random(1, 0.1));
        check(&random(300, 0.2));
        check(&random(300, 0.0));
        let flat = Bounds { min: Vec3::new(-1.0, 0.0, -1.0), max: Vec3::new(1.0, 0.0, 1.0) };
        check(&vec![flat; 100]);
        // Sizes that halve: the deepest tree that a heuristic can be led to.
        let nested: Vec<_> = (0..120)
            .map(|i| {
                let x = 0.5f32.powi(i);
                Bounds { min: Vec3::splat(x * 0.5), max: Vec3::splat(x) }
            })
            .collect();
        check(&nested);
    }
}
