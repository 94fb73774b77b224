use crate::color::Rgb;
use crate::math::Vec3;

/// The way of a photon through a medium, from where it set out to where it meets a surface or collides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beam {
    /// Where it sets out.
    pub origin: Vec3,
    /// Unit direction of the flight.
    pub direction: Vec3,
    /// How far it goes; finite and above 0.
    pub length: f32,
    /// Power in W at the origin. Inside [`Beams`] as if its path were the only one emitted; from a
    /// [`BeamMap`](super::BeamMap) divided by the paths emitted.
    pub power: Rgb,
    /// Segments of its path from the light up to and including this one.
    pub depth: u16,
    /// The number of the light it came from.
    pub light: u32,
    /// The number of the medium it passes through.
    pub medium: u16,
    /// Whether its power has still to be multiplied by the transmittance along the beam: then it goes on
    /// to the next surface, and else to where the photon collided. Passed on as it is.
    pub long: bool,
}

impl Beam {
    /// The point at a distance from the origin.
    #[inline]
    pub fn at(&self, s: f32) -> Vec3 {
        self.origin + self.direction * s
    }

    /// Whether it can be found: all of it is finite and it has a length and a direction.
    pub(super) fn is_proper(&self) -> bool {
        self.length > 0.0
            && self.direction != Vec3::ZERO
            && self.origin.is_finite()
            && self.direction.is_finite()
            && self.at(self.length).is_finite()
    }
}

/// The beams of a number of emitted paths, with the power of paths emitted alone.
///
/// [`BeamMap::build`](super::BeamMap::build) is the one place that divides by the paths emitted, as it is
/// with [`Photons`](super::super::Photons).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Beams {
    beams: Vec<Beam>,
    emitted: u64,
}

impl Beams {
    /// The beams stored by `emitted` paths, all of them traced to their end.
    pub fn new(emitted: u64, beams: Vec<Beam>) -> Self {
        Self { beams, emitted }
    }

    /// Adds the beams of further paths behind these. Joining batches in the order of their paths gives
    /// the same bits however the work was shared out.
    pub fn append(&mut self, mut more: Self) {
        self.beams.append(&mut more.beams);
        self.emitted += more.emitted;
    }

    /// The beams in the order of their paths.
    pub fn as_slice(&self) -> &[Beam] {
        &self.beams
    }

    /// Paths emitted, including those that stored nothing.
    pub fn emitted(&self) -> u64 {
        self.emitted
    }

    /// Beams stored. Not what a power is divided by.
    pub fn stored(&self) -> usize {
        self.beams.len()
    }

    /// The beams, each with its share of the light's power.
    pub(super) fn into_shares(self) -> Vec<Beam> {
        let share = (1.0 / self.emitted.max(1) as f64) as f32;
        let mut beams = self.beams;
        beams.iter_mut().for_each(|beam| beam.power *= share);
        beams.shrink_to_fit();
        beams
    }
}
