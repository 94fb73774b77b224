use super::triangle::{BEGINS, OF_CORNERS, OF_EDGE, OF_SHEAR, Triangle};
use super::{Intersection, Mesh, ShearedRay};
use crate::bvh::{LANES, Lanes, splat3};
use crate::math::{Ray, Vec3};

/// Up to eight triangles, tested at once.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(crate) struct TriangleBlock {
    /// By vertex and axis. Lanes that are not used are not numbers.
    p: [[[f32; LANES]; 3]; 3],
    /// The shape of each.
    pub shape: [u32; LANES],
    /// Which triangle of the shape's mesh.
    pub index: [u32; LANES],
}

/// Lanes of a block that a ray meets, and where.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hits {
    pub mask: u32,
    t: [f32; LANES],
    u: [f32; LANES],
    v: [f32; LANES],
}

impl Hits {
    pub const NONE: Self = Self { mask: 0, t: [0.0; LANES], u: [0.0; LANES], v: [0.0; LANES] };

    #[inline(always)]
    pub fn new<L: Lanes>(mask: u32, t: L, u: L, v: L) -> Self {
        Self { mask, t: t.store(), u: u.store(), v: v.store() }
    }

    /// Takes the next lane off the mask.
    #[inline(always)]
    pub fn next(&mut self) -> Option<(usize, Intersection)> {
        if self.mask == 0 {
            return None;
        }
        let i = self.mask.trailing_zeros() as usize % LANES;
        self.mask &= self.mask - 1;
        Some((i, Intersection { t: self.t[i], u: self.u[i], v: self.v[i] }))
    }
}

/// A sheared ray in all lanes.
pub(crate) struct ShearedLanes<L> {
    axes: [usize; 3],
    origin: [L; 3],
    shear: [L; 3],
}

impl<L: Lanes> ShearedLanes<L> {
    #[inline(always)]
    pub fn new(ray: &Ray, sheared: &ShearedRay) -> Self {
        Self {
            axes: sheared.axes,
            origin: splat3(sheared.axes.map(|axis| ray.origin[axis])),
            shear: splat3(sheared.shear.to_array()),
        }
    }
}

impl<L: Lanes> ShearedLanes<L> {
    /// One corner of each triangle, in the space of the ray.
    #[inline(always)]
    fn corner(&self, p: &[[f32; LANES]; 3]) -> [L; 3] {
        let [kx, ky, kz] = self.axes;
        let z = L::load(&p[kz]).minus(self.origin[2]);
        let x = L::load(&p[kx]).minus(self.origin[0]).minus(self.shear[0].times(z));
        let y = L::load(&p[ky]).minus(self.origin[1]).minus(self.shear[1].times(z));
        [x, y, z]
    }
}

/// On which side of an edge the ray passes; of the edge the other way round exactly the negative.
#[inline(always)]
fn edge<L: Lanes>(a: &[L; 3], b: &[L; 3]) -> L {
    a[0].times(b[1]).minus(a[1].times(b[0]))
}

/// What Σ w z may be off by, and the depth of the farthest corner: beside a ray's origin nothing nearer is a hit.
#[inline(always)]
fn error_of_sum<L: Lanes>(q: &[[L; 3]; 3], w: &[L; 3]) -> (L, L) {
    let [x, y, z] = [0, 1, 2].map(|axis| q[0][axis].abs().larger(q[1][axis].abs()).larger(q[2][axis].abs()));
    let edge = w[0].abs().larger(w[1].abs()).larger(w[2].abs());
    let of_edge = L::splat(OF_EDGE).times(edge);
    let of_corners = L::splat(OF_CORNERS).times(x.times(y));
    let of_shear = L::splat(OF_SHEAR).times(z.times(x.plus(y)));
    (z.times(of_edge.plus(of_corners).plus(of_shear)), z)
}

impl TriangleBlock {
    /// Of at most eight triangles: shape, its mesh, index in the mesh.
    pub fn new<'a>(triangles: impl Iterator<Item = (u32, &'a Mesh, u32)>) -> Self {
        let mut block =
            Self { p: [[[f32::NAN; LANES]; 3]; 3], shape: [u32::MAX; LANES], index: [u32::MAX; LANES] };
        for (lane, (shape, mesh, index)) in triangles.take(LANES).enumerate() {
            let corners = mesh.triangles[index as usize].map(|i| mesh.positions[i as usize]);
            for (vertex, p) in corners.iter().enumerate() {
                for axis in 0..3 {
                    block.p[vertex][axis][lane] = p[axis];
                }
            }
            block.shape[lane] = shape;
            block.index[lane] = index;
        }
        block
    }

    /// What [`Triangle::intersect`] gives for each, to the bit.
    #[inline(always)]
    pub fn intersect<L: Lanes>(
        &self,
        ray: &Ray,
        sheared: &ShearedRay,
        lanes: &ShearedLanes<L>,
        t_max: f32,
    ) -> Hits {
        let q = [lanes.corner(&self.p[0]), lanes.corner(&self.p[1]), lanes.corner(&self.p[2])];
        let w = [edge(&q[2], &q[1]), edge(&q[0], &q[2]), edge(&q[1], &q[0])];
        let zero = L::splat(0.0);
        let least = w[0].smaller(w[1]).smaller(w[2]);
        let most = w[0].larger(w[1]).larger(w[2]);
        let inside = zero.le(least) | most.le(zero);
        if inside == 0 {
            return Hits::NONE;
        }
        let on_edge = inside & (w[0].eq(zero) | w[1].eq(zero) | w[2].eq(zero));
        let determinant = w[0].plus(w[1]).plus(w[2]);
        let sum = w[0].times(q[0][2]).plus(w[1].times(q[1][2])).plus(w[2].times(q[2][2]));
        let scaled = sum.times(lanes.shear[2]);
        let inverse = L::splat(1.0).over(determinant);
        let t = scaled.times(inverse);
        let mut mask = inside & !on_edge & zero.lt(t) & t.lt(L::splat(t_max));
        if mask | on_edge == 0 {
            return Hits::NONE;
        }
        if mask != 0 {
            let (error, depth) = error_of_sum(&q, &w);
            let begins = t.times(L::splat(BEGINS)).lt(depth.times(lanes.shear[2].abs()));
            mask &= error.lt(sum.abs()) | !begins;
        }
        let mut hits = Hits::new(mask, t, w[1].times(inverse), w[2].times(inverse));
        if on_edge != 0 {
            self.settle(on_edge, &Ray { t_max, ..*ray }, sheared, &mut hits);
        }
        hits
    }

    /// Lanes where an edge function is zero, one by one.
    #[cold]
    fn settle(&self, mut lanes: u32, ray: &Ray, sheared: &ShearedRay, hits: &mut Hits) {
        while lanes != 0 {
            let i = lanes.trailing_zeros() as usize % LANES;
            lanes &= lanes - 1;
            let p = [0, 1, 2].map(|v| Vec3::from_array([0, 1, 2].map(|axis| self.p[v][axis][i])));
            if let Some(hit) = Triangle::meet(&p, ray, sheared) {
                hits.mask |= 1 << i;
                (hits.t[i], hits.u[i], hits.v[i]) = (hit.t, hit.u, hit.v);
            }
        }
    }
}
