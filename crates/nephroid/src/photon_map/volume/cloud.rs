use super::balls::Balls;
use super::payload::VolumePayload;
use super::photon::VolumePhoton;
use super::radii::Radii;
use crate::math::Vec3;
use crate::photon_map::{GridTree, PhotonIndex};

/// The photons of one medium.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Cloud {
    pub medium: u16,
    pub index: GridTree,
    pub payloads: Vec<VolumePayload>,
    pub radii: Radii,
    pub balls: Balls,
}

impl Cloud {
    /// Of at least one photon. `k` and `factor`: see [`VolumeMap::build`](super::VolumeMap::build).
    pub fn build(
        medium: u16,
        len: usize,
        point: impl Fn(usize) -> (Vec3, VolumePayload) + Sync,
        k: u32,
        factor: f32,
    ) -> Self {
        let (index, payloads) = GridTree::build_with(len, point);
        let radii = Radii::new(&index, k, factor);
        let balls = Balls::build(&index.blocks, &radii);
        Self { medium, index, payloads, radii, balls }
    }

    #[inline(always)]
    pub fn photon(&self, place: u32) -> VolumePhoton {
        self.payloads[place as usize].decode(self.index.position(place), self.medium)
    }

    pub fn memory_bytes(&self) -> usize {
        self.index.memory_bytes()
            + size_of_val(self.payloads.as_slice())
            + self.radii.memory_bytes()
            + self.balls.memory_bytes()
    }
}
