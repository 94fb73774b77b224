use std::f64::consts::PI;

use super::Beam;
use crate::math::Bounds;

/// How far beams are blurred to either side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BeamWidth {
    /// All by the same.
    Fixed {
        /// The radius.
        radius: f32,
    },
    /// All by the same, so that a typical ray through where the beams are has about `k` of them within the radius.
    ///
    /// Rays of all directions meet a strip of length L and width 2r at a mean sine of π/4, so in a unit
    /// of length λ 2r π/4 beams are within r, λ being their length in a unit of volume; and a ray stays
    /// in a convex volume V of surface A for 4V/A on the mean (Cauchy). With all their length Λ = λ V this
    /// makes k = 2π r Λ / A: the volume drops out. A is the surface of the box around the beams.
    ///
    /// The radius is at most an eighth of that of the sphere around all beams, which it also is where the
    /// box has no surface: a few beams are not spread over the whole scene for want of others.
    Crossing {
        /// Beams within the radius.
        k: f32,
    },
}

/// The largest radius of [`BeamWidth::Crossing`], in radii of the sphere around all beams.
const LARGEST: f64 = 0.125;

impl BeamWidth {
    /// The radius for these beams; 0 where there is none, or none that is finite.
    pub(super) fn radius(self, beams: &[Beam]) -> f32 {
        let radius = match self {
            Self::Fixed { radius } => radius,
            Self::Crossing { k } => crossing(beams, f64::from(k)),
        };
        if radius.is_finite() { radius.max(0.0) } else { 0.0 }
    }
}

fn crossing(beams: &[Beam], k: f64) -> f32 {
    let proper = || beams.iter().filter(|beam| beam.is_proper());
    let bounds = Bounds::of(proper().flat_map(|beam| [beam.origin, beam.at(beam.length)]));
    if bounds.is_empty() {
        return 0.0;
    }
    let length: f64 = proper().map(|beam| f64::from(beam.length)).sum();
    let [x, y, z] = (bounds.max.as_dvec3() - bounds.min.as_dvec3()).to_array();
    let most = LARGEST * 0.5 * (x * x + y * y + z * z).sqrt();
    let radius = k * 2.0 * (x * y + y * z + z * x) / (2.0 * PI * length);
    (if radius > 0.0 { radius.min(most) } else { most }) as f32
}
