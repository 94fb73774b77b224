//! Surfaces that are there in part only: masks.
//!
//! A ray either meets a masked surface or passes it, with the opacity at the place as the probability of
//! the former (stochastic alpha, after Enderton, Sintorn, Shirley and Luebke 2010, *Stochastic
//! Transparency*; per ray as in Pharr, Jakob and Humphreys 2023, §7.1.1). What decides is a hash of the
//! ray and the candidate, not a sampler: closest hits, shadow rays and photons need no other code and no
//! random numbers, and a ray traced twice finds the same.

use super::{Hit, RayHit, World};
use crate::material::Material;
use crate::math::Ray;
use crate::sampling::{Key, Stream};

impl World {
    /// Whether the shape is there at a hit; asked during the search, in worlds with `cutouts` only. The mean
    /// over rays is the opacity; 0 and 1 are certain.
    pub(super) fn is_there(&self, ray: &Ray, hit: &RayHit) -> bool {
        let surface = &self.surfaces[hit.shape as usize];
        if !surface.masked {
            return true;
        }
        let met = Hit::new(hit, self.surface(ray, hit));
        // A sphere or a cylinder is met from either side.
        let side = u64::from(met.point.ng.dot(ray.direction) > 0.0);
        let instance = hit.instance.map_or(0, |i| u64::from(i) + 1);
        let candidate = [u64::from(hit.shape) << 32 | u64::from(hit.primitive), instance << 1 | side];
        chance(ray, candidate) < f64::from(self.opacity_there(&met))
    }

    /// The opacity of the surface that a ray has met: 1 without a mask. Fewer photons land on a masked
    /// surface by as much, and each stands for as many more.
    pub(crate) fn opacity(&self, hit: &Hit) -> f32 {
        if self.surfaces[hit.shape as usize].masked { self.opacity_there(hit) } else { 1.0 }
    }

    fn opacity_there(&self, hit: &Hit) -> f32 {
        let material = self.surfaces[hit.shape as usize].material;
        let at = self.texture_point(hit);
        Material::opacity(&self.scene.materials, material, &self.scene.textures, at)
    }
}

/// A number in [0, 1) for a ray and one of the candidates it meets: independent from one candidate to
/// the next, and from one ray to the next.
///
/// Exponents are left out, so that a scene scaled by a power of two keeps its picture.
pub(super) fn chance(ray: &Ray, candidate: [u64; 2]) -> f64 {
    const KEY: Key = Key::new(0, 0, Stream::Masks);
    let bits = |v: f32| u64::from(v.to_bits() & 0x807f_ffff);
    let (o, d) = (ray.origin, ray.direction);
    let key = KEY
        .with(bits(o.x) << 32 | bits(o.y))
        .with(bits(o.z) << 32 | bits(d.x))
        .with(bits(d.y) << 32 | bits(d.z))
        .with(candidate[0])
        .with(candidate[1]);
    (key.hash() >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
}
