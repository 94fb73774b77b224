use super::estimate::Bandwidth;

/// How much narrower the estimates of an iteration are than those of the first. Estimates of many iterations converge
/// if each blurs less than the one before, though none knows of another: the memoryless form of progressive photon
/// mapping (Knaus and Zwicker 2011, *Progressive Photon Mapping: A Probabilistic Approach*,
/// doi 10.1145/1966394.1966404).
///
/// With radii ∝ i^(−β), estimates that blur d dimensions have a variance ∝ i^(dβ), so that of the mean of N is
/// ∝ N^(dβ−1), and a bias ∝ N^(−2β), whose square is ∝ N^(−4β). Both fall at the same pace for β = 1/(4 + d), which
/// makes the error N^(−4/(4+d)) (Kaplanyan and Dachsbacher 2013, doi 10.1145/2487228.2487233): on surfaces β = 1/6, the
/// α = 2/3 of the paper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blur {
    iteration: Option<u64>,
}

impl Blur {
    /// That of estimates which are no part of a series.
    pub const WHOLE: Self = Self { iteration: None };

    /// That of an iteration, from 0.
    pub fn of_iteration(iteration: u64) -> Self {
        Self { iteration: Some(iteration) }
    }

    /// What a radius is multiplied by where so many dimensions are blurred.
    pub fn factor(self, dimensions: u32) -> f32 {
        let Some(iteration) = self.iteration else { return 1.0 };
        libm::pow(iteration as f64 + 1.0, -1.0 / (4.0 + f64::from(dimensions))) as f32
    }

    /// A bandwidth of the first iteration, narrower; that of no series stays as it is.
    ///
    /// Estimates look for fewer photons, in the same proportion as their area or volume, and from some on take a part
    /// of the radius at which these lie.
    pub fn narrow(self, bandwidth: Bandwidth, dimensions: u32) -> Bandwidth {
        let factor = self.factor(dimensions);
        match bandwidth {
            _ if self == Self::WHOLE => bandwidth,
            Bandwidth::Fixed { radius } => Bandwidth::Fixed { radius: radius * factor },
            Bandwidth::Nearest { k, max_radius } => {
                let wanted = k as f32 * factor.powi(dimensions as i32);
                let k = (wanted.ceil() as u32).clamp(FEWEST.min(k), k);
                let part = (wanted / k as f32).min(1.0);
                let part = if dimensions == 3 { libm::cbrtf(part) } else { part.sqrt() };
                // The part is taken of the largest radius, too.
                Bandwidth::Part { k, max_radius: max_radius * factor / part, part, least: 0.0 }
            }
            Bandwidth::Part { k, max_radius, part, least } => {
                Bandwidth::Part { k, max_radius, part: part * factor, least: least * factor }
            }
        }
    }
}

/// Photons that are looked for at least: the radius at which fewer lie says little about their density.
const FEWEST: u32 = 10;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn radii_shrink_at_the_pace_that_balances_noise_and_blur() {
        for (dimensions, beta) in [(1, 0.2), (2, 1.0 / 6.0), (3, 1.0 / 7.0)] {
            let ratio = Blur::of_iteration(63).factor(dimensions) / Blur::of_iteration(0).factor(dimensions);
            assert!((libm::log2(f64::from(ratio)) + 6.0 * beta).abs() < 1e-6);
        }
        assert_eq!([Blur::WHOLE, Blur::of_iteration(0)].map(|blur| blur.factor(2)), [1.0, 1.0]);
    }

    #[test]
    fn fewer_photons_are_looked_for_down_to_a_few() {
        let nearest = Bandwidth::Nearest { k: 64, max_radius: 2.0 };
        assert_eq!(Blur::WHOLE.narrow(nearest, 2), nearest);
        for (iteration, dimensions) in [(0, 2), (1, 2), (7, 2), (7, 3), (300, 2), (100_000, 2), (100_000, 3)]
        {
            let blur = Blur::of_iteration(iteration);
            let factor = blur.factor(dimensions);
            let Bandwidth::Part { k, max_radius, part, .. } = blur.narrow(nearest, dimensions) else {
                panic!("a part is taken")
            };
            assert!((FEWEST..=64).contains(&k) && part <= 1.0);
            // The radius of k photons, and the part of it, are those of the first iteration times the factor.
            let of_k = libm::powf(k as f32 / 64.0, 1.0 / dimensions as f32) * part;
            assert!((of_k / factor - 1.0).abs() < 1e-5, "{of_k} {factor}");
            assert!((max_radius * part / (2.0 * factor) - 1.0).abs() < 1e-5);
        }
    }
}
