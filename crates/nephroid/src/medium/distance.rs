//! Distances along a ray with the density of what a medium scatters back from there.

use super::profile::Profile;
use super::uniform::is_grey;
use crate::color::Rgb;
use crate::math::real;

/// Halvings of a piece of a profile in search of an optical depth.
const HALVINGS: u32 = 12;

impl Profile {
    /// Samples a distance between two, of which the farther may be infinite, by extinction times transmittance of a
    /// channel, which is chosen evenly of those that are stopped at all: a thin channel is seen far beyond where a thick
    /// one ends. Evenly where there is no extinction.
    pub fn sample(&self, u: f32, from: f32, to: f32) -> f32 {
        let (near, stopped) = self.stopped(from, to);
        let channels = (0..3).filter(|&c| stopped[c] > 0.0).count();
        if channels == 0 {
            return from + u * (to - from);
        }
        // Of channels that are all alike the first will do.
        let scaled = if self.uniform().is_some_and(is_grey) { u } else { u * channels as f32 };
        let chosen = (scaled as usize).min(channels - 1);
        let channel = (0..3).filter(|&c| stopped[c] > 0.0).nth(chosen).unwrap_or(0);
        let u = (scaled - chosen as f32).min(1.0 - f32::EPSILON);
        // The optical depth beyond which is the rest of what is stopped.
        let wanted = near[channel] - real::ln(1.0 - u * stopped[channel]);
        let t = match self.uniform() {
            Some(sigma_t) => wanted / sigma_t[channel],
            None => self.at_depth(channel, wanted),
        };
        t.clamp(from, to)
    }

    /// The density of [`Self::sample`] per length.
    pub fn pdf(&self, t: f32, from: f32, to: f32) -> f32 {
        let (near, stopped) = self.stopped(from, to);
        let (extinction, depth) = (self.extinction(t), self.depth(t));
        let (mut sum, mut channels) = (0.0, 0);
        for c in (0..3).filter(|&c| stopped[c] > 0.0) {
            sum += extinction[c] * real::exp(near[c] - depth[c]) / stopped[c];
            channels += 1;
        }
        if channels == 0 { 1.0 / (to - from) } else { sum / channels as f32 }
    }

    /// The optical depth at the nearer of two distances, and what is stopped between them of what comes there.
    fn stopped(&self, from: f32, to: f32) -> (Rgb, Rgb) {
        let (near, far) = (self.depth(from), self.depth(to));
        (near, near.zip(far, |near, far| -real::exp_m1(near - far)))
    }

    fn depth(&self, t: f32) -> Rgb {
        match self.uniform() {
            Some(sigma_t) => sigma_t.map(|sigma| if sigma > 0.0 { sigma * t } else { 0.0 }),
            None => self.depth_in_pieces(t),
        }
    }

    /// Where a channel has an optical depth that it reaches.
    fn at_depth(&self, channel: usize, depth: f32) -> f32 {
        let (mut low, mut high) = self.piece_of_depth(channel, depth);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if self.depth(middle)[channel] < depth {
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
            (uniform(Rgb::new(1.0, 0.5, 2.0)), 0.0, f32::INFINITY),
            (uniform(Rgb::BLACK), 0.5, 2.0),
            (uniform(Rgb::new(0.0, 4.0, 0.05)), 0.2, f32::INFINITY),
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
