//! What merging is worth where its photons have much of their path in common.

use std::f64::consts::PI;

use super::densities::Kind;
use super::weights::Whole;

/// Vertices that are looked at; what lies beyond is so unlikely that it does not matter.
const MOST: usize = 24;

/// For each vertex of a path the share of photons merged there that count as independent: the correlation-aware heuristic
/// of Grittmann, Georgiev and Slusallek (2021, doi 10.1111/cgf.142628). All photons around a vertex share the camera's
/// way to it. Where walks from the camera come there less often than those from the lamp, that way is what makes the noise,
/// and many photons are no better than few. With p and q for the chances that walks from the camera and from the lamp
/// come as near to all vertices of the path as photons are merged, the share is p / (p + q − p q).
pub(super) struct Shares {
    of: [f64; MOST],
    first: usize,
}

impl Shares {
    pub fn new(path: &Whole<'_>, first: usize, area: f32) -> Self {
        let (count, area) = (path.len().min(MOST), f64::from(area));
        // As far around a collision is a ball. Where at a lamp light starts is left out: that is an area, a point or a
        // direction, and the share must not depend on the unit of length.
        let ball = 4.0 / 3.0 * area * (area / PI).sqrt();
        let near = |i: usize, from: usize| match path.kind(i) {
            Kind::Lamp { .. } => 1.0,
            Kind::Medium => (path.densities(i)[from] * ball).min(1.0),
            Kind::Surface | Kind::Specular => (path.densities(i)[from] * area).min(1.0),
        };
        let mut of = [1.0; MOST];
        let mut light = 1.0;
        for (i, share) in of.iter_mut().enumerate().take(count) {
            light *= near(i, 0);
            *share = light;
        }
        let mut camera = 1.0;
        for i in (0..first.min(count)).rev() {
            camera *= near(i, 1);
            let (p, q) = (camera, of[i]);
            of[i] = if p + q > 0.0 { p / (p + q - p * q) } else { 1.0 };
        }
        Self { of, first }
    }

    /// At a vertex; the first that the camera sees has one way to it in any case.
    pub fn at(&self, vertex: usize) -> f64 {
        if vertex >= self.first.min(MOST) { 1.0 } else { self.of[vertex] }
    }
}
