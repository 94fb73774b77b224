//! Distances along a ray with the density of what a medium scatters back from there.

use super::profile::Profile;
use crate::math::real;

/// Halvings of a piece of a profile in search of an optical depth.
const HALVINGS: u32 = 12;

impl Profile {
    /// Samples a distance between two, of which the farther may be infinite, by extinction times transmittance of the
    /// mean channel; evenly where there is no extinction.
    pub fn sample(&self, u: f32, from: f32, to: f32) -> f32 {
        let (near, far) = (self.mean_depth(from), self.mean_depth(to));
        let stopped = -real::exp_m1(near - far);
        if stopped <= 0.0 {
            return from + u * (to - from);
        }
        // The optical depth beyond which is the rest of what is stopped.
        let wanted = near - real::ln(1.0 - u * stopped);
        let t = match self.uniform() {
            Some(sigma_t) => wanted / sigma_t.mean(),
            None => self.at_depth(wanted),
        };
        t.clamp(from, to)
    }

    /// The density of [`Self::sample`] per length.
    pub fn pdf(&self, t: f32, from: f32, to: f32) -> f32 {
        let (near, far) = (self.mean_depth(from), self.mean_depth(to));
        let stopped = -real::exp_m1(near - far);
        if stopped <= 0.0 {
            return 1.0 / (to - from);
        }
        self.mean_extinction(t) * real::exp(near - self.mean_depth(t)) / stopped
    }

    fn mean_depth(&self, t: f32) -> f32 {
        match self.uniform() {
            Some(sigma_t) => {
                let sigma = sigma_t.mean();
                if sigma > 0.0 { sigma * t } else { 0.0 }
            }
            None => self.depth_in_pieces(t).mean(),
        }
    }

    /// Where the mean channel has an optical depth that it reaches.
    fn at_depth(&self, depth: f32) -> f32 {
        let (mut low, mut high) = self.piece_of_depth(depth);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if self.mean_depth(middle) < depth {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    }
}

/// The integral of the transmittance up to t: (1 − e^(−σt)) / σ, and t where there is nothing.
pub(super) fn lit_length(sigma_t: f32, t: f32) -> f32 {
    if sigma_t > 0.0 { -real::exp_m1(-sigma_t * t) / sigma_t } else { t }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Rgb;
    use crate::handle::Arena;
    use crate::math::{Ray, Transform, Vec3};
    use crate::medium::uniform::attenuation;
    use crate::medium::{Coefficient, Grid, GridValues, Matter, Medium, Phase};

    fn cloud() -> Matter {
        let mut grids = Arena::default();
        let values = (0..64).map(|i| ((i * 7) % 11) as f32 * 0.4).collect();
        let grid = grids.push(Grid { name: "g".into(), size: [4; 3], values: GridValues::Grey(values) });
        let sigma_t = Coefficient::Grid { grid, to_world: Transform::IDENTITY, scale: 3.0 };
        let medium = Medium { sigma_t, ..Medium::homogeneous("m", Rgb::BLACK, Rgb::WHITE, Phase::Isotropic) };
        Matter::new(&medium, &grids)
    }

    /// Sampling at evenly spread numbers puts as much into each part as the density says.
    #[test]
    fn samples_have_their_density_and_stay_between_the_ends() {
        let uniform = |sigma_t| {
            Matter::new(&Medium::homogeneous("m", sigma_t, Rgb::WHITE, Phase::Isotropic), &Arena::default())
        };
        let ray = Ray::new(Vec3::new(-0.5, 0.1, 0.2), Vec3::new(1.0, 0.3, 0.4).normalize());
        for (matter, from, to) in [
            (uniform(Rgb::new(0.5, 1.0, 3.0)), 0.3, 2.0),
            (uniform(Rgb::splat(2.0)), 0.0, f32::INFINITY),
            (uniform(Rgb::BLACK), 0.5, 2.0),
            (cloud(), 0.0, f32::INFINITY),
            (cloud(), 0.8, 1.2),
        ] {
            let profile = matter.profile(&ray, to);
            let n = 20_000;
            let samples: Vec<f32> =
                (0..n).map(|i| profile.sample((i as f32 + 0.5) / n as f32, from, to)).collect();
            assert!(samples.iter().all(|t| (from..=to).contains(t)));
            // The cumulative distribution at a few places, by the trapezoidal rule.
            let most = if to.is_finite() { to } else { from + 4.0 };
            let steps = 20_000;
            let mut cdf = 0.0f64;
            for k in 0..steps {
                let (a, b) = (k as f32 / steps as f32, (k + 1) as f32 / steps as f32);
                let at = |x: f32| from + (most - from) * x;
                let mean = 0.5 * (profile.pdf(at(a), from, to) + profile.pdf(at(b), from, to));
                cdf += f64::from(mean * (at(b) - at(a)));
                if k % 2500 == 2499 {
                    let below = samples.iter().filter(|&&t| t <= at(b)).count() as f64 / f64::from(n);
                    assert!((below - cdf).abs() < 2e-3, "{below} is not {cdf} at {}", at(b));
                }
            }
        }
    }

    #[test]
    fn the_lit_length_is_the_integral_of_the_transmittance() {
        assert_eq!(lit_length(0.0, 3.0), 3.0);
        assert!((lit_length(1e-6, 3.0) - 3.0).abs() < 1e-4);
        assert_eq!(lit_length(2.0, f32::INFINITY), 0.5);
        assert_eq!(attenuation(Rgb::splat(2.0), f32::INFINITY), Rgb::BLACK);
    }
}
