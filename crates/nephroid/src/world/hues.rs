//! Light that glass takes apart: paths of one wavelength.

use super::{Hit, Surroundings, World};
use crate::color::{Rgb, Wavelength, response};
use crate::material::Bsdf;
use crate::math::Vec3;
use crate::sampling::{Discrete, Sampler};

/// The wavelengths that paths of all colours are turned into, each for as much of the three channels as it is.
#[derive(Clone, Debug)]
pub(super) struct Hues {
    cells: Discrete,
    /// What a path of a wavelength in each cell stands for; in the mean over all it is white.
    weights: Vec<Rgb>,
}

impl Hues {
    /// Cells of one nanometre, chosen for their mean share of the channels.
    pub fn new() -> Option<Self> {
        let (first, last) = (Wavelength::SHORTEST_NM as usize, Wavelength::LONGEST_NM as usize);
        let responses: Vec<Rgb> = (first..last).map(|nm| response(nm as f32 + 0.5)).collect();
        let total: Rgb = responses.iter().copied().sum();
        let shares = responses.iter().map(|response| response.zip(total, |part, whole| part / whole));
        let shares: Vec<Rgb> = shares.collect();
        let cells = Discrete::new(shares.iter().map(|share| f64::from(share.mean())))?;
        let weights = shares.into_iter().map(|share| share / share.mean()).collect();
        Some(Self { cells, weights })
    }

    fn sample(&self, u: f32) -> (Wavelength, Rgb) {
        let (cell, _, rest) = self.cells.sample(u);
        (Wavelength::from_nm(Wavelength::SHORTEST_NM + cell as f32 + rest), self.weights[cell])
    }
}

impl World {
    /// How the surface scatters, as [`World::bsdf_within`] says, on a path that carries `throughput`: where glass takes light
    /// of all wavelengths apart, one of them is chosen for the rest of the path, and what it carries is coloured. In the mean
    /// nothing is gained or lost in any channel.
    ///
    /// A path that is met by another one which was taken apart, too, is as if each of them had been so by itself: light that
    /// one prism spreads and that is looked at through another is too soft.
    #[inline]
    pub(crate) fn meet(
        &self,
        hit: &Hit,
        wo: Vec3,
        inside: &mut Surroundings,
        throughput: &mut Rgb,
        sampler: &mut Sampler,
    ) -> Bsdf {
        let Some(hues) = &self.hues else { return self.bsdf_within(hit, wo, inside) };
        let bsdf = self.bsdf_within(hit, wo, inside);
        if !bsdf.disperses() {
            return bsdf;
        }
        let (wavelength, weight) = hues.sample(sampler.next_1d());
        inside.wavelength = Some(wavelength);
        *throughput *= weight;
        self.bsdf_within(hit, wo, inside)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_hues_together_are_white() {
        let hues = Hues::new().expect("light is seen");
        let count = 1 << 20;
        let mut sum = [0.0f64; 3];
        for i in 0..count {
            let (wavelength, weight) = hues.sample((i as f32 + 0.5) / count as f32);
            assert!((Wavelength::SHORTEST_NM..=Wavelength::LONGEST_NM).contains(&wavelength.nm()));
            for (s, w) in sum.iter_mut().zip(weight.to_array()) {
                *s += f64::from(w) / f64::from(count);
            }
        }
        assert!(sum.iter().all(|s| (s - 1.0).abs() < 1e-4), "{sum:?}");
    }
}
