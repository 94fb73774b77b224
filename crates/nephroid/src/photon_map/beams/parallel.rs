//! Beams nearly parallel to the ray: see the module's introduction.

use super::Beam;
use crate::math::{DVec3, Ray};
use crate::photon_map::Kernel;

/// A point of the ray inside a beam's cylinder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Inside {
    pub t: f32,
    pub s: f32,
    /// In 1/m: the stretch inside times the kernel of two dimensions.
    pub weight: f32,
}

/// One point of the stretch of the ray within the radius of the beam's axis, between the planes through the
/// beam's ends, and within (0, `t_max`).
///
/// Where on the stretch is decided by the beam's number alone, as multiples of the golden ratio: over many
/// beams all parts come up evenly. The middle in place of it would weigh a transmittance that falls
/// along the stretch too low. In double precision, since such pairs are rare.
pub(super) fn inside(
    ray: &Ray,
    t_max: f32,
    beam: &Beam,
    number: usize,
    radius: f32,
    kernel: Kernel,
) -> Option<Inside> {
    let (direction, axis) = (ray.direction.as_dvec3(), beam.direction.as_dvec3().normalize());
    let from = ray.origin.as_dvec3() - beam.origin.as_dvec3();
    let (radius, length) = (f64::from(radius), f64::from(beam.length));
    // At t the ray is at s = start + t cos and, seen along the beam, at across + t e.
    let (start, cos) = (from.dot(axis), direction.dot(axis));
    let (across, e) = (from - axis * start, direction - axis * cos);
    let (low, high) = within_circle(across, e, radius)?;
    let (one, other) = (-start / cos, (length - start) / cos);
    let low = low.max(one.min(other)).max(0.0);
    let high = high.min(one.max(other)).min(f64::from(t_max));
    let stretch = high - low;
    if !(stretch > 0.0 && stretch.is_finite()) {
        return None;
    }
    let t = low + stretch * part(number);
    let dist_sq = (across + e * t).length_squared();
    // Rounding to single precision must not lead out of the beam.
    let s = ((start + t * cos) as f32).clamp(f32::MIN_POSITIVE, beam.length.next_down());
    let weight = kernel.weight_2d(dist_sq as f32, (radius * radius) as f32) * stretch as f32;
    Some(Inside { t: t as f32, s, weight })
}

/// Between which t the point a + t b is within the radius of the origin.
fn within_circle(a: DVec3, b: DVec3, radius: f64) -> Option<(f64, f64)> {
    let (bb, ab, aa) = (b.length_squared(), a.dot(b), a.length_squared());
    let room = radius * radius - aa;
    let root_sq = ab * ab + bb * room;
    if bb == 0.0 {
        return (room >= 0.0).then_some((f64::NEG_INFINITY, f64::INFINITY));
    }
    (root_sq >= 0.0).then(|| ((-ab - root_sq.sqrt()) / bb, (-ab + root_sq.sqrt()) / bb))
}

/// A part in (0, 1) for each number.
fn part(number: usize) -> f64 {
    const GOLDEN: u32 = 0x9e37_79b9;
    (f64::from((number as u32).wrapping_mul(GOLDEN)) + 0.5) / 4_294_967_296.0
}
