//! Surfaces that are there in part only: masks.
//!
//! A ray either meets a masked surface or passes it, with the opacity at the place as the probability of
//! the former (stochastic alpha, after Enderton, Sintorn, Shirley and Luebke 2010, *Stochastic
//! Transparency*; per ray as in Pharr, Jakob and Humphreys 2023, §7.1.1). What decides is a hash of the
//! ray and the candidate, not a sampler: closest hits, shadow rays and photons need no other code and no
//! random numbers, and a ray traced twice finds the same.

use super::{Hit, World, leave};
use crate::material::Material;
use crate::math::Ray;
use crate::sampling::{Key, Stream};
use crate::shape::{Intersection, Primitive, ShearedRay};

/// Which of the places where a ray meets one primitive is meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    /// The nearest.
    Near = 0,
    /// The other side of a sphere or cylinder.
    Far = 1,
}

impl World {
    /// The nearest place where a ray meets a primitive that is there.
    #[inline]
    pub(super) fn meet(&self, primitive: usize, ray: &Ray, sheared: &ShearedRay) -> Option<Intersection> {
        let hit = self.primitives[primitive].intersect(ray, sheared)?;
        if self.masked.is_empty() || !self.masked[self.owner[primitive] as usize] {
            return Some(hit);
        }
        if self.is_there(ray, primitive, &hit, Side::Near) {
            return Some(hit);
        }
        let far = self.far_side(primitive, ray, &hit, sheared)?;
        self.is_there(ray, primitive, &far, Side::Far).then_some(far)
    }

    /// Whether the surface of a masked shape is there for a ray that meets it. The mean over rays is the
    /// opacity; 0 and 1 are certain.
    pub(super) fn is_there(&self, ray: &Ray, primitive: usize, hit: &Intersection, side: Side) -> bool {
        let uv = self.primitives[primitive].surface(ray, hit, &self.meshes).uv;
        let material = self.scene.shapes[self.owner[primitive] as usize].material;
        let opacity = Material::opacity(&self.scene.materials, material, &self.scene.textures, uv);
        chance(ray, primitive as u64 * 2 + side as u64) < f64::from(opacity)
    }

    /// The opacity of the surface that a ray has met: 1 without a mask. Fewer photons land on a masked
    /// surface by as much, and each stands for as many more.
    pub(crate) fn opacity(&self, hit: &Hit) -> f32 {
        if self.masked.is_empty() || !self.masked[hit.shape as usize] {
            return 1.0;
        }
        let material = self.scene.shapes[hit.shape as usize].material;
        Material::opacity(&self.scene.materials, material, &self.scene.textures, hit.point.uv)
    }

    /// Where a ray that was let through one side of a curved primitive meets the other.
    #[cold]
    fn far_side(
        &self,
        primitive: usize,
        ray: &Ray,
        near: &Intersection,
        sheared: &ShearedRay,
    ) -> Option<Intersection> {
        let piece = &self.primitives[primitive];
        if !matches!(piece, Primitive::Sphere(_) | Primitive::Cylinder(_)) {
            return None;
        }
        let onward = leave(&piece.surface(ray, near, &self.meshes), ray.direction);
        let far = piece.intersect(&onward, sheared)?;
        let t = near.t + far.t;
        (t < ray.t_max).then_some(Intersection { t, ..far })
    }
}

/// A number in [0, 1) for a ray and one of the candidates it meets: independent from one candidate to
/// the next, and from one ray to the next.
///
/// Exponents are left out, so that a scene scaled by a power of two keeps its picture.
pub(super) fn chance(ray: &Ray, candidate: u64) -> f64 {
    const KEY: Key = Key::new(0, 0, Stream::Masks);
    let bits = |v: f32| u64::from(v.to_bits() & 0x807f_ffff);
    let (o, d) = (ray.origin, ray.direction);
    let key = KEY
        .with(bits(o.x) << 32 | bits(o.y))
        .with(bits(o.z) << 32 | bits(d.x))
        .with(bits(d.y) << 32 | bits(d.z))
        .with(candidate);
    (key.hash() >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
}
