//! The density of photons at a point.

use super::cloud::Cloud;
use super::map::VolumeMap;
use super::photon::VolumePhoton;
use crate::math::Vec3;
use crate::photon_map::estimate::{ENOUGH, before_a_gap};
use crate::photon_map::{Bandwidth, Gathered, Kernel, NearestList, PhotonIndex};

/// Where and for what to gather photons in a medium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VolumeQuery {
    /// A point in the medium.
    pub position: Vec3,
    /// Photons of this medium count.
    pub medium: u16,
    /// Photons count up to this depth, see [`VolumePhoton::depth`].
    pub max_photon_depth: Option<u16>,
}

impl VolumeMap {
    /// Calls `visit(photon, weight)` for each photon that counts at a point of a medium. With a weight in 1/m³,
    /// Σ phase · power · weight is the radiance scattered per length, in W/(m³·sr). `neighbors` only lends
    /// its memory.
    ///
    /// **The k-th photon** sets the radius and is not counted, for the reason that
    /// [`gather`](crate::photon_map::gather) gives, with volumes in place of areas: up to the k-th photon the
    /// expected number in the ball, λ 4/3 πr³, is distributed as Gamma(k), and 1/(k − 1) is the mean of its
    /// reciprocal. With fewer than k within the largest radius R, the last of the n found takes its place:
    /// given n, r³/R³ has the density n xⁿ⁻¹ on [0, 1], so the mean of (n − 1)/r³ is n/R³. One or two
    /// photons take R and count in full, as below three the variance of 1/r³ is not finite. What follows a gap
    /// lies in another part of the medium, as on another surface there.
    ///
    /// The order of calls is fixed: by place for a fixed radius, by distance and place otherwise.
    pub fn at(
        &self,
        query: &VolumeQuery,
        kernel: Kernel,
        bandwidth: Bandwidth,
        neighbors: &mut NearestList,
        mut visit: impl FnMut(&VolumePhoton, f32),
    ) -> Gathered {
        let (k, max_radius, part, least) = match bandwidth {
            Bandwidth::Nearest { k, max_radius } => (k.max(2) as usize, max_radius, 1.0, 0.0),
            Bandwidth::Part { k, max_radius, part, least } => (k.max(2) as usize, max_radius, part, least),
            Bandwidth::Fixed { radius } => (0, radius, 1.0, 0.0),
        };
        let narrowed = |radius: f32| (radius * part).max(least);
        let Some(cloud) = self.cloud(query.medium) else {
            return Gathered { radius: max_radius, count: 0 };
        };
        if k == 0 || max_radius.is_nan() || max_radius <= 0.0 {
            return within(cloud, query, kernel, max_radius, visit);
        }
        let counts = |place: u32| counts(cloud, query, place);
        let measure = |place, dist_sq| counts(place).then_some(dist_sq);
        cloud.index.nearest(query.position, max_radius * max_radius, k, measure, neighbors);
        let volume = |radius_sq: f64| radius_sq * radius_sq.sqrt();
        let found = before_a_gap(neighbors, volume);
        if found < k.min(ENOUGH) {
            return within(cloud, query, kernel, narrowed(max_radius), visit);
        }
        let count = found.min(k) - 1;
        let whole = neighbors.get(count).map_or(max_radius, |last| last.dist_sq.sqrt());
        let radius = narrowed(whole);
        let spread = Spread3::new(kernel, radius).filter(|_| radius <= whole);
        let Some(spread) = spread else {
            let radius = if whole > 0.0 { radius } else { narrowed(max_radius) };
            return within(cloud, query, kernel, radius, visit);
        };
        let mut inside = 0;
        for neighbor in neighbors.iter().take(count).filter(|n| part == 1.0 || n.dist_sq <= radius * radius) {
            visit(&cloud.photon(neighbor.place), spread.weight(neighbor.dist_sq));
            inside += 1;
        }
        Gathered { radius, count: inside }
    }
}

#[inline(always)]
fn counts(cloud: &Cloud, query: &VolumeQuery, place: u32) -> bool {
    query.max_photon_depth.is_none_or(|max| cloud.payloads[place as usize].depth() <= max)
}

fn within(
    cloud: &Cloud,
    query: &VolumeQuery,
    kernel: Kernel,
    radius: f32,
    mut visit: impl FnMut(&VolumePhoton, f32),
) -> Gathered {
    let mut count = 0;
    if let Some(spread) = Spread3::new(kernel, radius) {
        cloud.index.for_each_within(query.position, radius * radius, |place, dist_sq| {
            if counts(cloud, query, place) {
                visit(&cloud.photon(place), spread.weight(dist_sq));
                count += 1;
            }
        });
    }
    Gathered { radius, count }
}

/// A kernel in space at a radius, its constants multiplied.
struct Spread3 {
    kernel: Kernel,
    per_radius_sq: f32,
    per_volume: f32,
}

impl Spread3 {
    /// `None` unless the radius is positive, and its square and one over its volume are numbers.
    #[inline]
    fn new(kernel: Kernel, radius: f32) -> Option<Self> {
        const PER_UNIT_BALL: f32 = 0.75 * std::f32::consts::FRAC_1_PI;
        let per_radius_sq = 1.0 / (radius * radius);
        let per_volume = kernel.norm_3d() * PER_UNIT_BALL * per_radius_sq / radius;
        (radius > 0.0 && per_volume > 0.0 && per_volume.is_finite()).then_some(Self {
            kernel,
            per_radius_sq,
            per_volume,
        })
    }

    /// Weight in 1/m³ at a squared distance within the radius, or at it up to rounding.
    #[inline(always)]
    fn weight(&self, dist_sq: f32) -> f32 {
        self.per_volume * self.kernel.shape((dist_sq * self.per_radius_sq).min(1.0))
    }
}
