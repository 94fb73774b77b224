//! What the blur of photon look-ups does to a camera sample.

use super::{LookUp, Probe};
use crate::color::Rgb;
use crate::photon_map::{Gathered, Photon};

/// Sums over all look-ups on surfaces what they find less what they would find with half of their squared radius.
///
/// The error of an estimate of radius r is ∝ r² where light varies smoothly (Silverman 1986, *Density Estimation*,
/// §4.3), so half of it is left with half of r²: the expectation of the sum is half of the sample's bias. Both
/// estimates are from the same photons, so most of their noise is not in the difference.
///
/// What maps in media blur is left out.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BlurProbe {
    base: Rgb,
    throughput: Rgb,
    /// Of the look-up that is going on: other light, and direct light.
    found: [Rgb; 2],
    sum: Rgb,
}

impl BlurProbe {
    pub fn new() -> Self {
        Self { base: Rgb::WHITE, throughput: Rgb::WHITE, found: [Rgb::BLACK; 2], sum: Rgb::BLACK }
    }

    /// The sum, of luminances in W/(m²·sr).
    pub fn finish(self) -> f32 {
        self.sum.luminance()
    }
}

impl Probe for BlurProbe {
    fn begin(&mut self, _: Option<u64>, base: Rgb) {
        (self.base, self.throughput) = (base, Rgb::WHITE);
    }

    #[inline]
    fn carry(&mut self, throughput: Rgb) {
        self.throughput = throughput;
    }

    #[inline]
    fn photon(&mut self, _: &Photon, is_direct: bool, radiance: Rgb, of_half: Rgb) {
        self.found[usize::from(is_direct)] += radiance - of_half;
    }

    #[inline]
    fn blur(&mut self, radiance: Rgb) {
        self.sum += radiance;
    }

    fn look_up(&mut self, look_up: &LookUp, _: Gathered) {
        let [other, direct] = std::mem::replace(&mut self.found, [Rgb::BLACK; 2]);
        for (part, found) in [(look_up.other, other), (look_up.direct, direct)] {
            if part.is_some() {
                self.sum += self.base * self.throughput * found;
            }
        }
    }
}
