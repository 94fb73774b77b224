//! The geometry of the radiance estimate: which photons count at a point of a surface, and how much.

use std::f32::consts::PI;

use super::index::{NearestList, PhotonIndex};
use super::kernel::Kernel;
use super::map::PhotonMap;
use super::photon::Photon;
use crate::math::Vec3;

/// Photons whose normal has a smaller cosine with the query's lie on another surface and do not
/// count: 26°. On a sphere of radius R that lets photons in up to .45 R away. Larger values cut
/// curved surfaces short, which makes them dark; smaller ones let light around blunt edges.
pub(crate) const MIN_NORMAL_COSINE: f32 = 0.9;

/// How far off the tangent plane photons count, in radii of the gather: they fill a slice of the
/// ball and not the ball. On a sphere the chord to a photon whose normal is 26° off leaves the
/// plane at the sine of 13°, .224: at .25 the normal always decides first, and this test only keeps
/// out surfaces that run in parallel, such as the other step of a stair.
pub(crate) const MAX_THICKNESS: f32 = 0.25;

/// Photons that must be found, if k are not, for the last of them to set the radius: the fewest for
/// which the variance of 1/r² is finite.
pub(super) const ENOUGH: usize = 3;

/// Where and for what to gather photons.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Query {
    /// A point of a surface.
    pub position: Vec3,
    /// Its unit geometric normal, on the side from which the light should come. A surface that
    /// scatters light through needs a query for either side.
    pub normal: Vec3,
    /// Photons count up to this depth, see [`Photon::depth`].
    pub max_photon_depth: Option<u16>,
}

/// How wide to gather.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bandwidth {
    /// Until `k` photons are found: small radii where there are many.
    Nearest {
        /// Photons to find, including the one that sets the radius and is not counted; fewer than 2
        /// count as 2.
        k: u32,
        /// The largest radius; see [`PhotonMap::default_max_radius`].
        max_radius: f32,
    },
    /// A part of the radius at which `k` photons are found. The photons within are as many as the part of the area is of
    /// all, so the estimate stays right, and its blur becomes as small as one likes.
    Part {
        /// Photons to find, as above.
        k: u32,
        /// The largest radius of which the part is taken.
        max_radius: f32,
        /// The part, above 0 and at most 1.
        part: f32,
        /// The radius is never smaller than this.
        least: f32,
    },
    /// The same everywhere.
    Fixed {
        /// The radius.
        radius: f32,
    },
}

impl Bandwidth {
    /// With a least radius, where it is a [part](Self::Part).
    pub fn at_least(self, radius: f32) -> Self {
        match self {
            Self::Part { k, max_radius, part, .. } => Self::Part { k, max_radius, part, least: radius },
            _ => self,
        }
    }
}

/// What a gather did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gathered {
    /// The radius it came to.
    pub radius: f32,
    /// How many photons counted.
    pub count: u32,
}

/// Calls `add(photon, weight)` for each photon that counts at a point of a surface. With a weight in
/// 1/m², Σ f·Φ·weight over the photons is reflected radiance in W/(m²·sr), and Σ Φ·weight is
/// irradiance. `scratch` only lends its memory.
///
/// **Which photons.** Those within the radius that arrived on the query's side of a surface of
/// nearly its normal, near its tangent plane, and at a depth that fits. All others are refused
/// *within* the search, so they do not shrink the radius of the nearest k.
///
/// **The distance** is the Euclidean one, not that in the tangent plane: a ball about a point of a
/// sphere cuts out an area of exactly πr², while a disc in the tangent plane has more surface above
/// it the larger it is. To it comes the condition |d·n| ≤ r/4. Both are one metric,
/// max(|d|, 4 |d·n|), whose ball is the slice of a ball; it ranks the nearest k, sets the radius and
/// enters the kernel, so the three agree. On a plane it is the distance in the plane. Near edges a
/// part of the slice holds no surface and the estimate is too low, as with all estimates of this
/// kind.
///
/// **The k-th photon** sets the radius and is not counted: (k − 1)/(πr²) has the expectation of the
/// density where that is uniform, k/(πr²) exceeds it by k/(k − 1) (García, Ureña, Revelles and Sbert
/// 2011, *Unreported Intrinsic Bias…*, CGF 30). With fewer than k within the largest radius R, the last
/// of the n found takes its place: given n, r² / R² has the density n xⁿ⁻¹ on [0, 1], hence the mean of
/// (n − 1)/(πr²) is n/(πR²), which is right. On a small ball, where the photons that count end with
/// the cap of about the query's normal, r ends there, too, and the estimate stays right; with R it
/// would be dark. One or two photons take R and count in full.
/// So it does if the last coincides with the query, and its distance says nothing.
///
/// Nothing counts within a radius that is not positive and finite.
///
/// The order of calls is fixed: by place for a fixed radius, by distance and place otherwise.
pub fn gather<I: PhotonIndex>(
    map: &PhotonMap<I>,
    query: &Query,
    kernel: Kernel,
    bandwidth: Bandwidth,
    scratch: &mut NearestList,
    mut add: impl FnMut(&Photon, f32),
) -> Gathered {
    gather_both(map, query, kernel, bandwidth, scratch, |photon, weights| add(photon, weights.whole))
}

/// What a photon counts in an estimate, in 1/m².
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights {
    /// In the estimate.
    pub whole: f32,
    /// In one with half of its squared radius, from the same photons.
    pub half: f32,
}

/// [`gather`], with what each photon would count if the squared radius were half as large: estimates from the same photons
/// that have half of the blur. Both are right in the mean where light is uniform, as a part of the radius of the k-th
/// photon is as good as all of it.
pub fn gather_both<I: PhotonIndex>(
    map: &PhotonMap<I>,
    query: &Query,
    kernel: Kernel,
    bandwidth: Bandwidth,
    scratch: &mut NearestList,
    mut add: impl FnMut(&Photon, Weights),
) -> Gathered {
    let (k, max_radius, part, least) = match bandwidth {
        Bandwidth::Nearest { k, max_radius } if max_radius > 0.0 => (k.max(2) as usize, max_radius, 1.0, 0.0),
        Bandwidth::Part { k, max_radius, part, least } if max_radius > 0.0 => {
            (k.max(2) as usize, max_radius, part, least)
        }
        Bandwidth::Nearest { max_radius: radius, .. }
        | Bandwidth::Part { max_radius: radius, .. }
        | Bandwidth::Fixed { radius } => {
            return gather_within(map, query, kernel, radius, add);
        }
    };
    let narrowed = |radius: f32| (radius * part).max(least);
    map.index().nearest(
        query.position,
        max_radius * max_radius,
        k,
        #[inline(always)]
        |place, dist_sq| distance_sq(map, query, place, dist_sq),
        scratch,
    );
    let found = before_a_gap(scratch, |d_sq| d_sq);
    if found < k.min(ENOUGH) {
        return gather_within(map, query, kernel, narrowed(max_radius), add);
    }
    let count = found.min(k) - 1;
    let whole = scratch.get(count).map_or(max_radius, |last| last.dist_sq.sqrt());
    let radius = narrowed(whole);
    let spread = Spread::new(kernel, radius).filter(|_| radius <= whole);
    let Some(spread) = spread else {
        return gather_within(
            map,
            query,
            kernel,
            if whole > 0.0 { radius } else { narrowed(max_radius) },
            add,
        );
    };
    let mut within = 0;
    // All of them if it is the whole radius.
    for neighbor in scratch.iter().take(count).filter(|n| part == 1.0 || n.dist_sq <= radius * radius) {
        add(&map.photon(neighbor.place), spread.weights(neighbor.dist_sq));
        within += 1;
    }
    Gathered { radius, count: within }
}

/// How many of the photons found lie before a gap: a ring much larger than the disc within, and not one
/// photon in it. There the surface ends, and what follows lies on another that happens to look the same
/// way, such as the next ball. In uniform light i photons are followed by a disc a times as large, empty
/// but for them, with the chance a^-i; a gap is what has a chance below one in 4¹² = 17 million, for a
/// picture asks millions of times, and each gap that is none makes a white speck. `measure` is what a squared
/// distance encloses, in any unit: an area or, in space, a volume.
pub(super) fn before_a_gap(found: &NearestList, measure: impl Fn(f64) -> f64) -> usize {
    /// The ratio of the measures that makes a gap after so many photons, at most the last.
    const GAPS: [f64; 13] = [
        f64::INFINITY,
        f64::INFINITY,
        f64::INFINITY,
        256.0,
        64.0,
        27.9,
        16.0,
        10.8,
        8.0,
        6.35,
        5.28,
        4.54,
        4.0,
    ];
    let within = |i: usize| found.get(i).map_or(0.0, |n| measure(f64::from(n.dist_sq)));
    let ends = |&i: &usize| within(i) > GAPS[i.min(12)] * within(i - 1);
    (ENOUGH..found.len()).find(ends).unwrap_or(found.len())
}

fn gather_within<I: PhotonIndex>(
    map: &PhotonMap<I>,
    query: &Query,
    kernel: Kernel,
    radius: f32,
    mut add: impl FnMut(&Photon, Weights),
) -> Gathered {
    let mut count = 0;
    if let Some(spread) = Spread::new(kernel, radius) {
        let radius_sq = radius * radius;
        map.index().for_each_within(
            query.position,
            radius_sq,
            #[inline(always)]
            |place, dist_sq| {
                if let Some(d) = distance_sq(map, query, place, dist_sq)
                    && d <= radius_sq
                {
                    add(&map.photon(place), spread.weights(d));
                    count += 1;
                }
            },
        );
    }
    Gathered { radius, count }
}

/// A kernel at a radius, its constants multiplied.
pub(super) struct Spread {
    kernel: Kernel,
    per_radius_sq: f32,
    per_area: f32,
}

impl Spread {
    /// `None` unless the radius is positive and its square, and one over that, are numbers.
    #[inline]
    pub fn new(kernel: Kernel, radius: f32) -> Option<Self> {
        let per_radius_sq = 1.0 / (radius * radius);
        let per_area = kernel.norm_2d() * per_radius_sq / PI;
        (radius > 0.0 && per_radius_sq > 0.0 && per_area.is_finite()).then_some(Self {
            kernel,
            per_radius_sq,
            per_area,
        })
    }

    /// Weight in 1/m² at a squared distance within the radius, or at it up to rounding.
    #[inline(always)]
    pub fn weight(&self, dist_sq: f32) -> f32 {
        self.per_area * self.kernel.shape((dist_sq * self.per_radius_sq).min(1.0))
    }

    /// That weight, and the one at the radius over √2.
    #[inline(always)]
    fn weights(&self, dist_sq: f32) -> Weights {
        let of_half = 2.0 * dist_sq * self.per_radius_sq;
        let half = if of_half <= 1.0 { 2.0 * self.per_area * self.kernel.shape(of_half) } else { 0.0 };
        Weights { whole: self.weight(dist_sq), half }
    }
}

/// The squared distance of the metric in [`gather`]; `None` for a photon that does not count.
#[inline(always)]
fn distance_sq<I: PhotonIndex>(map: &PhotonMap<I>, query: &Query, place: u32, dist_sq: f32) -> Option<f32> {
    let payload = map.payload(place);
    if query.max_photon_depth.is_some_and(|max| payload.depth() > max) {
        return None;
    }
    // The cosine, without the root and division that would make the normal a unit vector.
    let normal = payload.scaled_normal();
    let cosine = normal.dot(query.normal);
    if cosine <= 0.0 || cosine * cosine < MIN_NORMAL_COSINE * MIN_NORMAL_COSINE * normal.length_squared() {
        return None;
    }
    let height = (map.index().position(place) - query.position).dot(query.normal) * (1.0 / MAX_THICKNESS);
    Some(dist_sq.max(height * height))
}
