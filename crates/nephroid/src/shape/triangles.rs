use super::triangle::{BEGINS, OF_CORNERS, OF_EDGE, OF_SHEAR, Triangle};
use super::{Intersection, Mesh, ShearedRay};
use crate::bvh::{LANES, Lanes, splat3};
use crate::math::{Ray, Vec3};

/// Triangles in the order of the leaves that they are in: up to eight, one after the other, which are tested at once.
///
/// A leaf has nine rows, one for each corner and axis, as long as it has triangles: nothing is kept for lanes that are not
/// used, which would be two in five. Eight numbers are read of a row all the same, and what follows it is not counted.
#[derive(Clone, Debug, Default)]
pub(crate) struct Triangles {
    rows: Vec<f32>,
    /// The shape of each triangle, and which of the shape's mesh it is.
    names: Vec<[u32; 2]>,
}

/// Where a leaf is among [`Triangles`], in 31 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct TriangleLeaf(u32);

/// Rows of a triangle.
const ROWS: usize = 9;

/// Numbers in a cache line.
const LINE: usize = 64 / size_of::<f32>();

/// What is read of a leaf, whatever it has.
type Rows = [f32; ROWS * LANES];

impl TriangleLeaf {
    /// As many triangles can be told apart.
    pub const MOST: usize = 1 << 28;

    /// Of one to eight triangles, the first of which has that number.
    fn new(first: usize, count: usize) -> Self {
        Self((first * LANES + (count - 1)) as u32)
    }

    #[inline(always)]
    fn first(self) -> usize {
        self.0 as usize / LANES
    }

    #[inline(always)]
    fn count(self) -> usize {
        self.0 as usize % LANES + 1
    }
}

impl From<TriangleLeaf> for u32 {
    fn from(leaf: TriangleLeaf) -> Self {
        leaf.0
    }
}

impl From<usize> for TriangleLeaf {
    #[inline(always)]
    fn from(number: usize) -> Self {
        Self(number as u32)
    }
}

/// Lanes of a leaf that a ray meets, and where.
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
        // What the compiler knows to be at most 2 leaves no doubt of a row's place.
        let [x, y, z] = sheared.axes;
        Self {
            axes: [x.min(2), y.min(2), z.min(2)],
            origin: splat3(sheared.axes.map(|axis| ray.origin[axis])),
            shear: splat3(sheared.shear.to_array()),
        }
    }
}

impl<L: Lanes> ShearedLanes<L> {
    /// One corner of each triangle of a leaf with so many, in the space of the ray.
    #[inline(always)]
    fn corner(&self, rows: &Rows, count: usize, corner: usize) -> [L; 3] {
        let [kx, ky, kz] = self.axes;
        let z = row::<L>(rows, count, corner, kz).minus(self.origin[2]);
        let x = row::<L>(rows, count, corner, kx).minus(self.origin[0]).minus(self.shear[0].times(z));
        let y = row::<L>(rows, count, corner, ky).minus(self.origin[1]).minus(self.shear[1].times(z));
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

impl Triangles {
    /// With room for so many.
    pub fn with_capacity(count: usize) -> Self {
        let padding = if count > 0 { ROWS * (LANES - 1) } else { 0 };
        Self { rows: Vec::with_capacity(ROWS * count + padding), names: Vec::with_capacity(count) }
    }

    /// Adds a leaf of one to eight triangles: shape, its mesh, index in the mesh.
    pub fn add<'a>(&mut self, members: impl Iterator<Item = (u32, &'a Mesh, u32)> + Clone) -> TriangleLeaf {
        let first = self.names.len();
        let members = members.take(LANES);
        self.names.extend(members.clone().map(|(shape, _, index)| [shape, index]));
        for corner in 0..3 {
            for axis in 0..3 {
                self.rows.extend(members.clone().map(|(_, mesh, index)| {
                    mesh.positions[mesh.triangles[index as usize][corner] as usize][axis]
                }));
            }
        }
        TriangleLeaf::new(first, self.names.len() - first)
    }

    /// To be called after the last leaf: of that, too, eight numbers are read of each row.
    pub fn finish(&mut self) {
        if !self.names.is_empty() {
            self.rows.resize(ROWS * (self.names.len() + LANES - 1), 0.0);
        }
    }

    pub fn is_empty(&self) -> bool {
        self.names.is_empty()
    }

    pub fn bytes(&self) -> usize {
        size_of_val(&self.rows[..]) + size_of_val(&self.names[..])
    }

    /// The shape of a triangle of a leaf, and which of its mesh it is.
    #[inline(always)]
    pub fn name(&self, leaf: TriangleLeaf, lane: usize) -> [u32; 2] {
        self.names[leaf.first() + lane]
    }

    #[inline(always)]
    fn rows(&self, leaf: TriangleLeaf) -> Option<&Rows> {
        self.rows.get(ROWS * leaf.first()..)?.first_chunk()
    }

    #[inline(always)]
    pub fn prefetch<L: Lanes>(&self, leaf: TriangleLeaf) {
        let (first, count) = (ROWS * leaf.first(), ROWS * leaf.count());
        let Some(own) = self.rows.get(first..first + count) else { return };
        // Leaves start anywhere in a cache line, so the last number may be in one more.
        own.iter().step_by(LINE).chain(own.last()).for_each(L::prefetch);
    }

    /// What [`Triangle::intersect`] gives for each, to the bit.
    #[inline(always)]
    pub fn intersect<L: Lanes>(
        &self,
        leaf: TriangleLeaf,
        ray: &Ray,
        sheared: &ShearedRay,
        lanes: &ShearedLanes<L>,
        t_max: f32,
    ) -> Hits {
        let Some(rows) = self.rows(leaf) else { return Hits::NONE };
        let count = leaf.count();
        let q = [lanes.corner(rows, count, 0), lanes.corner(rows, count, 1), lanes.corner(rows, count, 2)];
        let w = [edge(&q[2], &q[1]), edge(&q[0], &q[2]), edge(&q[1], &q[0])];
        let zero = L::splat(0.0);
        let least = w[0].smaller(w[1]).smaller(w[2]);
        let most = w[0].larger(w[1]).larger(w[2]);
        let inside = (zero.le(least) | most.le(zero)) & (u32::from(u8::MAX) >> (LANES - count));
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
            settle((rows, count), on_edge, &Ray { t_max, ..*ray }, sheared, &mut hits);
        }
        hits
    }
}

/// A coordinate of one corner of each triangle of a leaf with so many.
#[inline(always)]
fn row<L: Lanes>(rows: &Rows, count: usize, corner: usize, axis: usize) -> L {
    L::load(rows[(3 * corner + axis) * count..].first_chunk().unwrap_or(&[f32::NAN; LANES]))
}

/// Lanes of a leaf where an edge function is zero, one by one.
#[cold]
fn settle((rows, count): (&Rows, usize), mut lanes: u32, ray: &Ray, sheared: &ShearedRay, hits: &mut Hits) {
    while lanes != 0 {
        let i = lanes.trailing_zeros() as usize % LANES;
        lanes &= lanes - 1;
        let p = [0, 1, 2].map(|v| Vec3::from_array([0, 1, 2].map(|axis| rows[(3 * v + axis) * count + i])));
        if let Some(hit) = Triangle::meet(&p, ray, sheared) {
            hits.mask |= 1 << i;
            (hits.t[i], hits.u[i], hits.v[i]) = (hit.t, hit.u, hit.v);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::{Simd, Work};
    use crate::math::warp;
    use crate::sampling::{Key, Sampler, Sequence, Stream};

    /// The hits of a leaf, lane by lane.
    struct All<'a>(&'a Triangles, TriangleLeaf, Ray);

    impl Work for All<'_> {
        type Output = Vec<(usize, Intersection)>;
        #[inline(always)]
        fn run<L: Lanes>(self) -> Self::Output {
            let sheared = ShearedRay::new(self.2.direction);
            let lanes = ShearedLanes::<L>::new(&self.2, &sheared);
            let mut hits = self.0.intersect(self.1, &self.2, &sheared, &lanes, self.2.t_max);
            let mut list = Vec::new();
            while let Some(hit) = hits.next() {
                list.push(hit);
            }
            list
        }
    }

    #[test]
    fn leaves_of_any_size_meet_what_their_triangles_meet() {
        let sampler = |i| Sampler::new(Sequence::Independent, Key::new(7, 0, Stream::Camera), i);
        let mut corners = sampler(0);
        // Triangles as large as what they are in, so that rays meet many, and what is beside a leaf is met, too.
        let positions: Vec<Vec3> =
            (0..3 * 36).map(|_| warp::square_to_sphere(corners.next_2d()) * corners.next_1d()).collect();
        let mesh = Mesh {
            positions,
            triangles: (0..36).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
            ..Mesh::default()
        };
        let mut all = Triangles::with_capacity(36);
        let mut leaves = Vec::new();
        let mut next = 0;
        for count in [3, 8, 1, 5, 2, 7, 4, 6] {
            leaves.push((next, all.add((next..next + count).map(|index| (5, &mesh, index)))));
            next += count;
        }
        all.finish();
        // 44 bytes a triangle, and what is read beyond the last.
        assert_eq!((next, all.bytes()), (36, 36 * 44 + 7 * 36));
        let mut met = 0;
        for i in 1..500 {
            let mut s = sampler(i);
            let origin = warp::square_to_sphere(s.next_2d()) * 2.0;
            let to = warp::square_to_sphere(s.next_2d()) * s.next_1d();
            let ray = Ray::new(origin, (to - origin).normalize());
            let sheared = ShearedRay::new(ray.direction);
            for (number, &(first, leaf)) in leaves.iter().enumerate() {
                let count = leaf.count() as u32;
                let expected: Vec<(usize, Intersection)> = (0..count)
                    .filter_map(|k| {
                        let hit = Triangle::new(&mesh, 0, first + k).intersect(&ray, &sheared)?;
                        assert_eq!(all.name(leaf, k as usize), [5, first + k]);
                        Some((k as usize, hit))
                    })
                    .collect();
                for simd in [Simd::Portable, Simd::detect()] {
                    assert_eq!(simd.run(All(&all, leaf, ray)), expected, "leaf {number}, {simd:?}");
                }
                met += expected.len();
            }
        }
        assert!(met > 500, "{met}");
    }
}
