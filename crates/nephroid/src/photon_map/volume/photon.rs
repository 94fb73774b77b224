use crate::color::Rgb;
use crate::math::Vec3;

/// A photon where it was scattered in a medium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VolumePhoton {
    /// Where.
    pub position: Vec3,
    /// Power in W that is *scattered* there, the albedo multiplied in, so that nothing is ever divided by σ:
    /// Σ phase · power / volume is σ_s ∫ phase · L_i dω, the radiance scattered per length. Inside
    /// [`VolumePhotons`] as if its path were the only one emitted; from a [`VolumeMap`](super::VolumeMap) its
    /// share of the light's power, divided by the paths emitted.
    pub power: Rgb,
    /// Unit direction *back along* its flight.
    pub wi: Vec3,
    /// Segments of its path from the light to here: 1 for light that comes straight.
    pub depth: u16,
    /// The number of the light it came from.
    pub light: u32,
    /// The number of the medium it lies in.
    pub medium: u16,
}

/// The photons that a number of emitted paths left in media: like [`Photons`](crate::photon_map::Photons), which
/// see for what is divided by what.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VolumePhotons {
    photons: Vec<VolumePhoton>,
    emitted: u64,
}

impl VolumePhotons {
    /// The photons stored by `emitted` paths, all of them traced to their end.
    pub fn new(emitted: u64, photons: Vec<VolumePhoton>) -> Self {
        Self { photons, emitted }
    }

    /// Adds the photons of further paths behind these. Joining batches in the order of their paths
    /// gives the same bits however the work was shared out.
    pub fn append(&mut self, mut more: Self) {
        self.photons.append(&mut more.photons);
        self.emitted += more.emitted;
    }

    /// The photons in the order of their paths, with the power of paths emitted alone.
    pub fn as_slice(&self) -> &[VolumePhoton] {
        &self.photons
    }

    /// Paths emitted, including those that stored nothing.
    pub fn emitted(&self) -> u64 {
        self.emitted
    }

    /// Photons stored. Not what a power is divided by.
    pub fn stored(&self) -> usize {
        self.photons.len()
    }
}
