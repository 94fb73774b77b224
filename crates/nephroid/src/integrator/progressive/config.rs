use crate::integrator::PhotonMapperConfig;
use crate::transport::{MapPlan, PhotonPlan};

/// Photons of an estimate in the first iteration where that has [`PHOTONS`] in a map.
const NEIGHBOURS: f64 = 50.0;

/// See [`NEIGHBOURS`].
const PHOTONS: f64 = 200_000.0;

/// Settings of progressive photon mapping. No radius and no number of photons has to be chosen.
#[derive(Clone, Debug, PartialEq)]
pub struct PpmConfig {
    /// What the light of each iteration is and how it is estimated.
    pub mapper: PhotonMapperConfig,
    /// Whether as many photons are emitted as a pilot finds best, and not those that `mapper` wants.
    pub plan_photons: bool,
    /// Whether the neighbours of an estimate follow from the number of photons, and not from `mapper`.
    pub plan_neighbours: bool,
    /// Camera samples of each pixel in an iteration, up to 65 536, if not as many as a pilot finds best.
    pub samples_per_pixel: Option<u32>,
}

impl PpmConfig {
    /// Photons of an estimate from the global and from the caustic map in the first iteration.
    ///
    /// What matters in the end is the radius once so many photons have been emitted in all, be it in few large
    /// iterations or in many small ones. With r² ∝ i^(−1/3) that asks for k ∝ P^(2/3) of P photons to an iteration.
    pub(super) fn neighbours(&self, plan: &PhotonPlan) -> [u32; 2] {
        [plan.global, plan.caustic].map(|MapPlan { expected_photons, .. }| {
            if !self.plan_neighbours || expected_photons == 0 {
                return self.mapper.neighbours;
            }
            let photons = expected_photons as f64 / PHOTONS;
            (NEIGHBOURS * libm::cbrt(photons * photons)).round().clamp(4.0, 1e4) as u32
        })
    }
}

impl Default for PpmConfig {
    fn default() -> Self {
        Self {
            mapper: PhotonMapperConfig::default(),
            plan_photons: true,
            plan_neighbours: true,
            samples_per_pixel: None,
        }
    }
}
