//! What the tests of this module share.

use rand_pcg::Pcg32;
use rand_pcg::rand_core::{Rng as _, SeedableRng as _};

use super::Photon;
use crate::color::Rgb;
use crate::math::Vec3;

/// Uniform numbers on [0, 1).
pub struct Rng(Pcg32);

impl Rng {
    pub fn new(seed: u64) -> Self {
        Self(Pcg32::seed_from_u64(seed))
    }

    pub fn next(&mut self) -> f32 {
        (self.0.next_u32() >> 8) as f32 / 16_777_216.0
    }

    pub fn point(&mut self) -> Vec3 {
        Vec3::new(self.next(), self.next(), self.next())
    }
}

/// A photon of one watt that fell straight onto a surface.
pub fn photon_at(position: Vec3, normal: Vec3) -> Photon {
    Photon { position, power: Rgb::WHITE, wi: normal, normal, depth: 1, light: 0 }
}
