//! What is kept of light paths: vertices to be connected to, and photons to be merged with.

use super::densities::Place;
use crate::color::Rgb;
use crate::light::Source;
use crate::material::Bsdf;
use crate::math::Vec3;
use crate::medium::Phase;
use crate::transport::{Lit, Scatterer};
use crate::world::{Hit, Surroundings, World};

/// A vertex of a light path, to be connected to.
#[derive(Clone, Copy, Debug)]
pub(super) struct LightVertex {
    pub surface: Option<Hit>,
    pub position: Vec3,
    pub phase: Phase,
    pub wo: Vec3,
    pub inside: Surroundings,
    pub place: Place,
    /// W that land here, those that a mask lets pass left out.
    pub power: Rgb,
    /// Segments up to here.
    pub depth: u32,
    /// See [`Trail::back`].
    pub back: f32,
    /// Where its part of the path begins and ends in a list of vertices.
    pub nodes: [u32; 2],
}

impl LightVertex {
    pub fn new(lit: &Lit<'_>, place: Place, power: Rgb, depth: u32, back: f32) -> Self {
        let (surface, position, phase) = match lit.scatterer {
            Scatterer::Surface { hit, .. } => (Some(*hit), hit.point.position, Phase::Isotropic),
            Scatterer::Medium { position, phase } => (None, position, phase),
        };
        let (wo, inside) = (lit.wo, lit.inside);
        Self { surface, position, phase, wo, inside, place, power, depth, back, nodes: [0; 2] }
    }

    /// How its surface scatters, if it is on one. It is not kept: that would take more memory than all else of the vertex,
    /// and about as long to read as to find again.
    pub fn bsdf(&self, world: &World) -> Option<Bsdf> {
        self.surface.as_ref().map(|hit| world.bsdf_within(hit, self.wo, &self.inside))
    }

    /// `bsdf` is that of [`bsdf`](Self::bsdf).
    pub fn lit<'a>(&'a self, bsdf: Option<&'a Bsdf>) -> Lit<'a> {
        let scatterer = match self.surface.as_ref().zip(bsdf) {
            Some((hit, bsdf)) => Scatterer::Surface { hit, bsdf },
            None => Scatterer::Medium { position: self.position, phase: self.phase },
        };
        Lit { scatterer, wo: self.wo, inside: self.inside }
    }

    /// What rays that are sent to it end at.
    pub fn source(&self) -> Source {
        match &self.surface {
            Some(hit) => Source::Surface(hit.point),
            None => Source::Point(self.position),
        }
    }
}

/// A photon of a light path, to be merged with a path from the camera.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LightPhoton {
    /// W of its path.
    pub power: Rgb,
    pub wi: Vec3,
    /// The geometric one, on the side that it came from.
    pub normal: Vec3,
    /// See [`Trail::back`].
    pub back: f32,
    /// Segments up to here.
    pub depth: u32,
    /// Whether it met nothing but specular surfaces.
    pub caustic: bool,
    /// Where its part of the path begins and ends in a list of vertices.
    pub nodes: [u32; 2],
}

/// Where a vertex that scatters light lies.
pub(super) fn place_of(world: &World, lit: &Lit<'_>) -> (Place, Vec3) {
    match lit.scatterer {
        Scatterer::Surface { hit, .. } => {
            let (position, ng) = (hit.point.position, hit.point.ng);
            (Place::Surface { position, ng }, position)
        }
        Scatterer::Medium { position, .. } => {
            let sigma_t = world.matter(lit.inside).map_or(0.0, |matter| matter.sigma_t(position).mean());
            (Place::Medium { position, sigma_t }, position)
        }
    }
}
