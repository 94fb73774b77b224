//! Overlapping shapes with priorities (Schmidt and Budge 2002, *Simple Nested Dielectrics in Ray Traced Images*,
//! doi 10.1080/10867651.2002.10487555): of those that a point is inside, the highest is what is there.
//!
//! A path keeps a list of the ranked shapes that it is inside. Where it crosses the surface of one inside of a
//! higher one, there is no surface and only the list changes. Of equal priorities the shape that stands first in the
//! scene is the higher one, so that what is where depends on no path.

use super::{Hit, Surfaced, Surroundings, World};
use crate::color::Wavelength;
use crate::handle::Handle;
use crate::material::{Bsdf, Dispersion, Material};
use crate::math::Vec3;
use crate::medium::Medium;
use crate::scene::Scene;

/// How many ranked shapes a path may be inside of and know of them all. Of more, the lowest is forgotten.
const MOST: usize = 6;

/// A place among the shapes that have a priority, from 1 upwards; 0 is none.
pub(super) type Rank = u32;

/// The ranked shapes that a point is inside, the highest first. A shape that is there by several instances may be in
/// it several times.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Nest([Rank; MOST]);

impl Nest {
    /// The rank of what is there; 0 inside of none.
    #[inline]
    pub fn top(&self) -> Rank {
        self.0[0]
    }

    pub fn with(mut self, rank: Rank) -> Self {
        let at = self.0.iter().position(|&other| other < rank).unwrap_or(MOST);
        if at < MOST {
            self.0.copy_within(at..MOST - 1, at + 1);
            self.0[at] = rank;
        }
        self
    }

    pub fn without(mut self, rank: Rank) -> Self {
        if let Some(at) = self.0.iter().position(|&other| other == rank) {
            self.0.copy_within(at + 1.., at);
            self.0[MOST - 1] = 0;
        }
        self
    }
}

/// What is known of a shape with a priority.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ranked {
    pub shape: u32,
    /// Its index of refraction, if it has one.
    ior: Option<f32>,
    dispersion: Option<Dispersion>,
    pub interior: Option<Handle<Medium>>,
}

/// The shapes that have a priority, the lowest first: rank 1 is the first of them.
pub(super) fn ranks(scene: &Scene) -> Vec<Ranked> {
    let mut order: Vec<_> =
        (0u32..).zip(scene.all_shapes()).filter_map(|(i, s)| Some((s.boundary.priority?, i, s))).collect();
    order.sort_by_key(|&(priority, i, _)| (priority, std::cmp::Reverse(i)));
    let ranked = order.into_iter().map(|(_, shape, described)| Ranked {
        shape,
        ior: match scene.materials[Material::boundary(&scene.materials, described.material)] {
            Material::Dielectric { int_ior, .. } => Some(int_ior),
            _ => None,
        },
        dispersion: Material::dispersion(&scene.materials, described.material),
        interior: described.boundary.interior,
    });
    ranked.collect()
}

impl Ranked {
    /// Its index of refraction for a path of this wavelength, or of all, if it has one.
    fn ior(&self, wavelength: Option<Wavelength>) -> Option<f32> {
        match (self.dispersion, wavelength) {
            (Some(dispersion), Some(wavelength)) => Some(dispersion.ior(wavelength)),
            _ => self.ior,
        }
    }
}

impl World {
    /// Whether shapes may overlap.
    pub(super) fn has_ranks(&self) -> bool {
        !self.ranked.is_empty()
    }

    pub(super) fn ranked(&self, rank: Rank) -> Option<&Ranked> {
        self.ranked.get((rank as usize).checked_sub(1)?)
    }

    /// How the surface scatters, seen from the side of `wo` by a path that is `inside`: as [`World::bsdf`] says, but
    /// not at all inside of a shape of higher priority, and against the index of refraction of a lower one.
    #[inline]
    pub(crate) fn bsdf_within(&self, hit: &Hit, wo: Vec3, inside: &Surroundings) -> Bsdf {
        let Surfaced { rank, disperses, .. } = self.surfaces[hit.shape as usize];
        if rank == 0 && !disperses {
            return self.bsdf(hit, wo);
        }
        let bsdf = self.bsdf(hit, wo);
        if rank == 0 {
            return self.dispersive_bsdf(bsdf, hit, inside.wavelength);
        }
        self.ranked_bsdf(bsdf, rank, self.beside(rank, hit, -wo, inside), inside.wavelength)
    }

    fn ranked_bsdf(&self, bsdf: Bsdf, rank: Rank, beside: Rank, wavelength: Option<Wavelength>) -> Bsdf {
        if beside >= rank {
            return bsdf.nulled();
        }
        let [own, other] = [rank, beside].map(|rank| self.ranked(rank));
        let disperses = |ranked: Option<&Ranked>| ranked.is_some_and(|r| r.dispersion.is_some());
        let ior = |ranked: Option<&Ranked>| ranked.and_then(|ranked| ranked.ior(wavelength));
        let bsdf = match (own, ior(own), ior(other)) {
            (_, Some(own), Some(other)) => bsdf.with_eta(own / other),
            (Some(ranked), Some(n), None) if ranked.dispersion.is_some() => {
                bsdf.with_eta(n / self.ext_ior(ranked.shape))
            }
            _ => bsdf,
        };
        if wavelength.is_none() && (disperses(own) || disperses(other)) { bsdf.dispersing() } else { bsdf }
    }

    /// The boundary of a glass without a priority that takes light apart.
    fn dispersive_bsdf(&self, bsdf: Bsdf, hit: &Hit, wavelength: Option<Wavelength>) -> Bsdf {
        let material = self.surfaces[hit.shape as usize].material;
        match (Material::dispersion(&self.scene.materials, material), wavelength) {
            (Some(dispersion), Some(wavelength)) => {
                bsdf.with_eta(dispersion.ior(wavelength) / self.ext_ior(hit.shape))
            }
            (Some(_), None) => bsdf.dispersing(),
            (None, _) => bsdf,
        }
    }

    /// The index of refraction outside of a shape, as its material has it.
    fn ext_ior(&self, shape: u32) -> f32 {
        match *self.material_of(shape) {
            Material::Dielectric { ext_ior, .. } | Material::RoughDielectric { ext_ior, .. } => ext_ior,
            _ => 1.0,
        }
    }

    /// Whether there is no surface where a ray along `direction` meets a shape.
    #[inline]
    pub(super) fn is_hidden(&self, hit: &Hit, direction: Vec3, inside: &Surroundings) -> bool {
        let rank = self.surfaces[hit.shape as usize].rank;
        rank != 0 && self.beside(rank, hit, direction, inside) >= rank
    }

    /// The highest of the shapes that a path is inside where it meets the surface of one of this rank, that one left
    /// out.
    fn beside(&self, rank: Rank, hit: &Hit, direction: Vec3, inside: &Surroundings) -> Rank {
        let leaves = direction.dot(hit.point.ng) > 0.0;
        if leaves { inside.nest.without(rank).top() } else { inside.nest.top() }
    }

    /// What a path is in that has crossed the surface of a ranked shape to the side on which `ahead`, the cosine to
    /// its normal, is positive or negative.
    pub(super) fn cross_ranked(
        &self,
        inside: Surroundings,
        shape: u32,
        rank: Rank,
        ahead: f32,
    ) -> Surroundings {
        let leaves = ahead > 0.0;
        let before = if leaves { inside.nest.without(rank) } else { inside.nest };
        let nest = if leaves { before } else { before.with(rank) };
        if inside.blind || before.top() >= rank {
            return Surroundings { nest, ..inside };
        }
        let outside = if inside.nest.top() == 0 { inside.medium } else { inside.outside };
        let medium = match (self.ranked(nest.top()), &self.surfaces[shape as usize].boundary) {
            (Some(there), _) => there.interior,
            (None, Some(boundary)) => boundary.exterior,
            (None, None) => outside,
        };
        Surroundings { medium, outside, nest, ..inside }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_nest_keeps_the_highest_on_top_and_forgets_the_lowest() {
        let of = |ranks: &[Rank]| ranks.iter().fold(Nest::default(), |nest, &rank| nest.with(rank));
        assert_eq!(of(&[2, 5, 3, 5]).0, [5, 5, 3, 2, 0, 0]);
        assert_eq!(of(&[2, 5, 3, 5]).without(5), of(&[5, 3, 2]));
        assert_eq!(of(&[2]).without(7), of(&[2]));
        assert_eq!(of(&[1, 2, 3, 4, 5, 6, 7]).0, [7, 6, 5, 4, 3, 2]);
        assert_eq!(of(&[7, 6, 5, 4, 3, 2, 1]).0, [7, 6, 5, 4, 3, 2]);
        assert_eq!(of(&[7, 6, 5, 4, 3, 2]).without(2).without(7), of(&[6, 5, 4, 3]));
        assert_eq!(of(&[1]).without(1), Nest::default());
    }
}
