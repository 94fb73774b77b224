//! Vertex connection and merging (Georgiev, Křivánek, Davidovič and Slusallek 2012, doi 10.1145/2366145.2366211):
//! bidirectional path tracing whose vertices are connected and, as photons, merged, each weighted against all others.
//!
//! What media scatter towards the camera, directly or by specular surfaces, comes from maps of light in media, as in
//! progressive photon mapping. All other paths may go through media and collide there.

mod camera_paths;
mod config;
mod densities;
#[cfg(test)]
mod densities_tests;
mod grid;
mod lamp;
#[cfg(test)]
mod lamp_tests;
mod light_paths;
mod light_vertex;
mod plan;
mod reach;
#[cfg(test)]
mod reach_tests;
mod shares;
mod techniques;
#[cfg(test)]
mod techniques_tests;
mod trial;
mod weights;
#[cfg(test)]
mod weights_tests;

use crate::integrator::glances::are_worth_it;
pub(crate) use camera_paths::Camera;
pub use config::VcmConfig;
pub(crate) use grid::Grid;
pub(crate) use plan::{density, plan, plan_beside};
pub(crate) use reach::Density;
pub(crate) use trial::trial;

use self::light_paths::{LightPass, LightPaths, Splat};
use self::reach::{AtFirst, Reach};
use self::weights::Techniques;
use super::photon_mapper::{CameraPlan, Guides, Maps, PhotonMapper, PhotonMapperConfig, Turn};
use super::{Brought, MapTotals};
use crate::observer::Observer;
use crate::photon_map::{Blur, PhotonMap, Photons};
use crate::transport::{Ledger, PhotonPlan};
use crate::world::World;

/// Which iteration it is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct IterationKey {
    pub seed: u64,
    pub iteration: u64,
    /// As narrow as this iteration's are its estimates.
    pub narrowing: u64,
    /// Whether what light paths bring is taken down one by one.
    pub watched: bool,
}

impl IterationKey {
    /// That of an iteration of a render.
    pub fn new(seed: u64, iteration: u64) -> Self {
        Self { seed, iteration, narrowing: iteration, watched: false }
    }
}

/// What one iteration connects and merges with.
pub(crate) struct Iteration {
    paths: LightPaths,
    techniques: Techniques,
    /// Of light in media, and how they are read.
    maps: Maps,
    in_media: PhotonMapperConfig,
    guides: Guides,
}

impl Iteration {
    /// Traces the light paths of an iteration. `None` if the observer cancelled.
    pub fn new(
        world: &World,
        config: &VcmConfig,
        photons: &PhotonPlan,
        camera: &CameraPlan,
        density: &Density,
        IterationKey { seed, iteration, narrowing, watched }: IterationKey,
        observer: &dyn Observer,
    ) -> Option<Self> {
        let blur = Blur::of_iteration(narrowing);
        let radius = camera.merging_radius * blur.factor(2);
        let paths = photons.global.paths;
        let techniques = Techniques {
            reach: Reach { radius, paths: if config.merging { paths as f32 } else { 0.0 } },
            to_lens: paths as f32 / camera.samples_per_pixel as f32,
            connects: config.connections && paths > 0,
            correlation: config.correlation,
        };
        let pass = LightPass { seed, iteration, paths, max_depth: config.mapper.max_depth, watched };
        let paths = LightPaths::trace(
            world,
            &pass,
            &techniques,
            AtFirst { density, factor: blur.factor(2) },
            observer,
        )?;
        let turn = Turn { seed, iteration, gathers: false, blur };
        let in_media = config.in_media();
        let volumes = Maps::volumes(world, &in_media, photons, &turn, observer)?;
        let none = || PhotonMap::build(Photons::default());
        let maps = Maps::new([none(), none(), none(), none()], volumes, blur, Ledger::default());
        Some(Self { paths, techniques, maps, in_media, guides: Guides::none() })
    }

    /// What the samples of its camera do.
    pub fn camera<'a>(
        &'a self,
        world: &'a World,
        config: &'a VcmConfig,
        plan: &CameraPlan,
        density: &'a Density,
    ) -> Camera<'a> {
        let at_first = AtFirst { density, factor: self.maps.blur.factor(2) };
        let plan = CameraPlan { stride: 1, gather_rays: None, ..*plan };
        let media = PhotonMapper::new(world, &self.in_media, &self.maps, &self.guides, &plan);
        let Self { paths, techniques, .. } = self;
        let glances = are_worth_it(world);
        Camera { world, config, paths, techniques: *techniques, at_first, media, glances }
    }

    /// What its light paths bring to the camera, one by one.
    fn watched(&self) -> &[Splat] {
        &self.paths.watched
    }

    /// What its light paths bring straight to the camera.
    pub fn brought(&self, samples: u32) -> Brought<'_> {
        Brought::new(&self.paths.splats, samples, self.paths.emitted)
    }

    /// Paths emitted, photons stored and bytes of memory.
    pub fn totals(&self) -> MapTotals {
        let paths = &self.paths;
        MapTotals { paths: paths.emitted, photons: paths.photon_count(), bytes: paths.memory_bytes() }
    }

    /// Where the power of its light paths went.
    pub fn ledger(&self) -> &Ledger {
        &self.paths.ledger
    }

    /// The maps of light in media.
    pub fn maps(&self) -> &Maps {
        &self.maps
    }
}
