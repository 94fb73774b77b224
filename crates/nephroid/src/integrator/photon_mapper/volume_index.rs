use super::config::PhotonMapperConfig;
use crate::photon_map::{BeamMap, BeamWidth, Blur, VolumeMap};
use crate::transport::InMedia;

/// Light in media, as the camera pass looks it up.
pub(crate) enum VolumeIndex {
    Points(VolumeMap),
    Beams(BeamMap),
}

impl VolumeIndex {
    pub fn build(photons: InMedia, config: &PhotonMapperConfig, blur: Blur) -> Self {
        match photons {
            InMedia::Points(points) => {
                Self::Points(VolumeMap::build_narrow(points, config.volume_neighbours(), blur))
            }
            InMedia::Beams(beams) => {
                let width = BeamWidth::Crossing { k: config.beam_crossings };
                Self::Beams(BeamMap::build_narrow(beams, width, blur))
            }
        }
    }

    /// Photons, or beams.
    pub fn len(&self) -> usize {
        match self {
            Self::Points(map) => map.len(),
            Self::Beams(map) => map.len(),
        }
    }

    /// Paths emitted for it.
    pub fn emitted(&self) -> u64 {
        match self {
            Self::Points(map) => map.emitted(),
            Self::Beams(map) => map.emitted(),
        }
    }

    pub fn memory_bytes(&self) -> usize {
        match self {
            Self::Points(map) => map.memory_bytes(),
            Self::Beams(map) => map.memory_bytes(),
        }
    }
}
