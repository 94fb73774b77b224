use super::flat::{Flat, Region};
use super::triangles::Hits;
use crate::bvh::{LANES, Lanes, splat3};
use crate::math::{Ray, Vec3};

/// Up to eight parallelograms and ellipses, tested at once.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(crate) struct FlatBlock {
    center: [[f32; LANES]; 3],
    normal: [[f32; LANES]; 3],
    dual_x: [[f32; LANES]; 3],
    dual_y: [[f32; LANES]; 3],
    limit: [f32; LANES],
    /// Lanes that are ellipses.
    disks: u32,
    /// Which primitive each is.
    pub index: [u32; LANES],
}

impl FlatBlock {
    /// Of at most eight finite flat shapes, each with its number among the primitives.
    pub fn new<'a>(flats: impl Iterator<Item = (u32, &'a Flat)>) -> Self {
        let nothing = [[f32::NAN; LANES]; 3];
        let mut block = Self {
            center: nothing,
            normal: nothing,
            dual_x: nothing,
            dual_y: nothing,
            limit: [f32::NAN; LANES],
            disks: 0,
            index: [u32::MAX; LANES],
        };
        for (lane, (index, flat)) in flats.take(LANES).enumerate() {
            let set = |to: &mut [[f32; LANES]; 3], v: Vec3| {
                for axis in 0..3 {
                    to[axis][lane] = v[axis];
                }
            };
            set(&mut block.center, flat.center);
            set(&mut block.normal, flat.normal);
            set(&mut block.dual_x, flat.dual_x);
            set(&mut block.dual_y, flat.dual_y);
            block.limit[lane] = flat.limit;
            block.disks |= u32::from(flat.region == Region::Disk) << lane;
            block.index[lane] = index;
        }
        block
    }

    /// What [`Flat::intersect`] gives for each, to the bit.
    #[inline(always)]
    pub fn intersect<L: Lanes>(&self, ray: &Ray, t_max: f32) -> Hits {
        let origin = splat3::<L>(ray.origin.to_array());
        let direction = splat3::<L>(ray.direction.to_array());
        let (center, normal) = (three(&self.center), three(&self.normal));
        let t = dot(&minus(&center, &origin), &normal).over(dot(&direction, &normal));
        let ahead = L::splat(0.0).lt(t) & t.lt(L::splat(t_max));
        if ahead == 0 {
            return Hits::NONE;
        }
        let [o, d] = [&origin, &direction];
        let at = [o[0].plus(d[0].times(t)), o[1].plus(d[1].times(t)), o[2].plus(d[2].times(t))];
        let q = minus(&at, &center);
        let (x, y) = (dot(&q, &three(&self.dual_x)), dot(&q, &three(&self.dual_y)));
        let limit = L::load(&self.limit);
        let mut inside = x.abs().le(limit) & y.abs().le(limit);
        if self.disks != 0 {
            let round = x.times(x).plus(y.times(y)).le(limit.times(limit));
            inside = inside & !self.disks | round & self.disks;
        }
        let mask = ahead & inside;
        if mask == 0 { Hits::NONE } else { Hits::new(mask, t, x, y) }
    }
}

#[inline(always)]
fn three<L: Lanes>(v: &[[f32; LANES]; 3]) -> [L; 3] {
    [L::load(&v[0]), L::load(&v[1]), L::load(&v[2])]
}

#[inline(always)]
fn dot<L: Lanes>(a: &[L; 3], b: &[L; 3]) -> L {
    a[0].times(b[0]).plus(a[1].times(b[1])).plus(a[2].times(b[2]))
}

#[inline(always)]
fn minus<L: Lanes>(a: &[L; 3], b: &[L; 3]) -> [L; 3] {
    [a[0].minus(b[0]), a[1].minus(b[1]), a[2].minus(b[2])]
}
