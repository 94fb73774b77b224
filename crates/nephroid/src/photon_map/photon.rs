use crate::color::Rgb;
use crate::math::Vec3;

/// A photon where it met a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Photon {
    /// Where.
    pub position: Vec3,
    /// Power in W. Inside [`Photons`] as if its path were the only one emitted; from a
    /// [`PhotonMap`](super::PhotonMap) its share of the light's power, divided by the paths emitted.
    pub power: Rgb,
    /// Unit direction *back along* its flight, so that `bsdf.eval(wo, photon.wi)` needs no sign.
    pub wi: Vec3,
    /// Unit geometric normal of the surface, on the side at which the photon arrived.
    pub normal: Vec3,
    /// Segments of its path from the light to here: 1 for light that comes straight.
    pub depth: u16,
    /// The number of the light it came from.
    pub light: u32,
}

/// The photons of a number of emitted paths: what a photon pass returns.
///
/// Powers in here are those of paths emitted alone, and [`PhotonMap::build`](super::PhotonMap::build)
/// is the one place that divides by the paths emitted; behind it every power is final. The number of
/// paths is fixed before the first is traced and does not depend on what they hit: stopping once
/// enough photons are stored, and dividing by the paths it took, would be biased.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Photons {
    photons: Vec<Photon>,
    emitted: u64,
}

impl Photons {
    /// The photons stored by `emitted` paths, all of them traced to their end.
    pub fn new(emitted: u64, photons: Vec<Photon>) -> Self {
        Self { photons, emitted }
    }

    /// Adds the photons of further paths behind these. Joining batches in the order of their paths
    /// gives the same bits however the work was shared out.
    pub fn append(&mut self, mut more: Self) {
        self.photons.append(&mut more.photons);
        self.emitted += more.emitted;
    }

    /// The photons in the order of their paths, with the power of paths emitted alone.
    pub fn as_slice(&self) -> &[Photon] {
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
