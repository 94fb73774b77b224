use crate::integrator::PhotonMapperConfig;

/// Settings of progressive photon mapping. No radius and no number of photons has to be chosen.
#[derive(Clone, Debug, PartialEq)]
pub struct PpmConfig {
    /// What the light of each iteration is and how it is estimated.
    pub mapper: PhotonMapperConfig,
    /// Whether as many photons are emitted as a pilot finds best, and not those that `mapper` wants.
    pub plan_photons: bool,
    /// Whether the neighbours of an estimate follow from the number of photons, and not from `mapper`.
    pub plan_neighbours: bool,
    /// Camera samples of each pixel in an iteration, if not as many as a pilot finds best.
    pub samples_per_pixel: Option<u32>,
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
