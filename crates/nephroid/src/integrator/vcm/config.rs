use crate::integrator::PhotonMapperConfig;

/// Settings of vertex connection and merging. Nothing has to be chosen.
#[derive(Clone, Debug, PartialEq)]
pub struct VcmConfig {
    /// What is the same as in photon mapping: the longest path, and how light is estimated that media scatter to the camera.
    /// The rest counts for nothing.
    pub mapper: PhotonMapperConfig,
    /// Light paths of each iteration, if not a quarter as many as there are pixels, 20 000 at least and a million at most.
    pub light_paths: Option<u64>,
    /// Whether vertices of light paths are connected to those of camera paths.
    pub connections: bool,
    /// Whether photons are merged with camera paths. Without, what is seen in glass and mirrors of light that came by
    /// such surfaces stays black.
    pub merging: bool,
    /// Whether the weight of merging follows what its photons have in common; else they count as independent.
    pub correlation: bool,
}

impl VcmConfig {
    /// What counts of [`Self::mapper`].
    pub(super) fn in_media(&self) -> PhotonMapperConfig {
        let given = &self.mapper;
        PhotonMapperConfig {
            max_depth: given.max_depth,
            emit_max: given.emit_max,
            volume_photons: given.volume_photons,
            volume_kind: given.volume_kind,
            volume_estimate: given.volume_estimate,
            volume_neighbours: given.volume_neighbours,
            beam_crossings: given.beam_crossings,
            march_step: given.march_step,
            single_scatter: given.single_scatter,
            ..PhotonMapperConfig::default()
        }
    }
}

impl Default for VcmConfig {
    fn default() -> Self {
        Self {
            mapper: PhotonMapperConfig::default(),
            light_paths: None,
            connections: true,
            merging: true,
            correlation: false,
        }
    }
}
