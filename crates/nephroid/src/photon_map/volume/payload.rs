use super::photon::VolumePhoton;
use crate::color::Rgb;
use crate::math::Vec3;
use crate::photon_map::payload::{decode_power, encode_direction, encode_power, octahedron};

/// What the index does not hold of a photon in a medium, in 12 bytes: what
/// [`Payload`](crate::photon_map::payload::Payload) keeps of one on a surface, without the normal.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct VolumePayload {
    wi: [i16; 2],
    depth: u16,
    light: u16,
    mantissas: [u8; 3],
    exponent: u8,
}

impl VolumePayload {
    /// `number` is the photon's in its pass: the key of chance, as on surfaces.
    pub fn new(photon: &VolumePhoton, share: f32, number: u32) -> Self {
        let (mantissas, exponent) = encode_power(photon.power * share, number, photon.wi);
        Self {
            wi: encode_direction(photon.wi),
            depth: photon.depth,
            light: photon.light.min(u32::from(u16::MAX)) as u16,
            mantissas,
            exponent,
        }
    }

    #[inline(always)]
    pub fn decode(&self, position: Vec3, medium: u16) -> VolumePhoton {
        VolumePhoton {
            position,
            power: self.power(),
            wi: octahedron(self.wi).normalize(),
            depth: self.depth,
            light: u32::from(self.light),
            medium,
        }
    }

    #[inline(always)]
    fn power(&self) -> Rgb {
        decode_power(self.mantissas, self.exponent)
    }

    #[inline(always)]
    pub fn depth(&self) -> u16 {
        self.depth
    }
}
