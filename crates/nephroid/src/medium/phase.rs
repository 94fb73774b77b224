use std::f32::consts::PI;

use crate::math::{Frame, Vec2, Vec3, real, warp};

/// The distribution of directions in which a medium scatters light. Of `wo` and `wi`, both point away
/// from where it is scattered: light that goes straight on has `wi = -wo`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Phase {
    /// The same in all directions.
    #[default]
    Isotropic,
    /// Henyey and Greenstein 1941, doi 10.1086/144246.
    HenyeyGreenstein {
        /// Mean cosine between the directions before and after, in (−1, 1); positive is forward.
        g: f32,
    },
    /// Scattering by what is much smaller than a wavelength.
    Rayleigh,
}

/// A direction sampled from a phase function, whose density per solid angle is its value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhaseSample {
    /// Where the light comes from, or goes to.
    pub wi: Vec3,
    /// Density per solid angle, in 1/sr.
    pub pdf_solid_angle: f32,
}

impl Phase {
    /// Its value, in 1/sr, and so the density with which [`Self::sample`] chooses `wi`.
    #[inline]
    pub fn eval(&self, wo: Vec3, wi: Vec3) -> f32 {
        match *self {
            Self::Isotropic => warp::SPHERE_PDF,
            Self::HenyeyGreenstein { g } => {
                // Half of the square of a difference of unit vectors: one minus the cosine to the lobe's
                // axis, to full precision in the middle of the lobe, too.
                let one_minus_cos = 0.5 * (wi - axis(wo, g)).length_squared();
                let distance_sq = (1.0 - g.abs()) * (1.0 - g.abs()) + 2.0 * g.abs() * one_minus_cos;
                warp::SPHERE_PDF * (1.0 - g) * (1.0 + g) / (distance_sq * distance_sq.sqrt())
            }
            Self::Rayleigh => {
                let cos = wo.dot(wi);
                3.0 / (16.0 * PI) * (1.0 + cos * cos)
            }
        }
    }

    /// Samples a direction.
    #[inline]
    pub fn sample(&self, wo: Vec3, u: Vec2) -> PhaseSample {
        let wi = match *self {
            Self::Isotropic => warp::square_to_sphere(u),
            Self::HenyeyGreenstein { g } => around(axis(wo, g), henyey_greenstein(g.abs(), u.x), u.y),
            Self::Rayleigh => around(-wo, rayleigh(u.x), u.y),
        };
        PhaseSample { wi, pdf_solid_angle: self.eval(wo, wi) }
    }
}

/// The middle of the lobe.
fn axis(wo: Vec3, g: f32) -> Vec3 {
    if g < 0.0 { wo } else { -wo }
}

/// One minus the cosine to the axis of the lobe with `g` in [0, 1).
///
/// Henyey and Greenstein's inverse, cos θ = (1 + g² − s²)/(2g) with s = (1 − g²)/(1 − g + 2gu), with
/// s² − (1 − g)² taken apart: the g below cancels, and no two numbers that are close are subtracted.
fn henyey_greenstein(g: f32, u: f32) -> f32 {
    let q = (1.0 - g) / (1.0 - g + 2.0 * g * u);
    2.0 * (1.0 - u) * (1.0 + g * u) * q * q
}

/// One minus the cosine to the axis. The cosine c solves c³ + 3c = 2z with z = 4u − 2, by Cardano's formula
/// (Frisvad 2011, doi 10.1364/JOSAA.28.002436); for −z it is −c, which spares a difference.
fn rayleigh(u: f32) -> f32 {
    let z = 4.0 * u - 2.0;
    let a = real::cbrt(z.abs() + (z * z + 1.0).sqrt());
    1.0 - (a - 1.0 / a).min(1.0).copysign(z)
}

/// The direction at an angle to `axis`, and at the angle 2πu about it.
fn around(axis: Vec3, one_minus_cos: f32, u: f32) -> Vec3 {
    let sin = (one_minus_cos * (2.0 - one_minus_cos)).max(0.0).sqrt();
    let (sin_phi, cos_phi) = real::sin_cos(2.0 * PI * u);
    Frame::from_normal(axis).to_world(Vec3::new(sin * cos_phi, sin * sin_phi, 1.0 - one_minus_cos))
}

#[cfg(test)]
mod tests {
    use nephroid_testkit::{ALPHA, MeanTest, Pcg32, SphereTest, Tolerance, integrate, sidak};

    use super::*;

    const ALL: [Phase; 11] = [
        Phase::Isotropic,
        Phase::HenyeyGreenstein { g: -0.95 },
        Phase::HenyeyGreenstein { g: -0.8 },
        Phase::HenyeyGreenstein { g: -0.3 },
        Phase::HenyeyGreenstein { g: 0.0 },
        Phase::HenyeyGreenstein { g: 1e-4 },
        Phase::HenyeyGreenstein { g: 0.3 },
        Phase::HenyeyGreenstein { g: 0.8 },
        Phase::HenyeyGreenstein { g: 0.95 },
        Phase::HenyeyGreenstein { g: 0.999 },
        Phase::Rayleigh,
    ];

    fn mean_cosine(phase: Phase) -> f64 {
        if let Phase::HenyeyGreenstein { g } = phase { f64::from(g) } else { 0.0 }
    }

    /// The value at an angle to the direction of flight.
    fn at_cosine(phase: Phase, cos: f64) -> f64 {
        let wi = Vec3::new((1.0 - cos * cos).max(0.0).sqrt() as f32, 0.0, cos as f32);
        f64::from(phase.eval(-Vec3::Z, wi))
    }

    /// On seeds chosen afresh one of the tests would fail with probability 1 %.
    #[test]
    fn directions_follow_the_density() {
        let wo = Vec3::new(0.3, -0.5, 0.7).normalize();
        for (seed, phase) in (1..).zip(ALL) {
            let mut rng = Pcg32::new(seed);
            let sample =
                || Some(phase.sample(wo, Vec2::from_array(rng.vec2_f32())).wi.to_array().map(f64::from));
            let density =
                |w: [f64; 3]| f64::from(phase.eval(wo, Vec3::from_array(w.map(|c| c as f32)).normalize()));
            let test = SphereTest { samples: 100_000, resolution: [10, 16], ..Default::default() };
            let outcome = test.run(sample, density);
            assert!(outcome.passes(sidak(ALPHA, ALL.len())), "{phase:?}: {outcome}");
        }
    }

    #[test]
    fn they_integrate_to_one_and_have_the_mean_cosine() {
        for phase in ALL {
            // In the angle, and not in its cosine: a narrow lobe is wide there.
            let integral = |weight: &dyn Fn(f64) -> f64| {
                let f = |theta: f64| {
                    let cos = libm::cos(theta);
                    std::f64::consts::TAU * libm::sin(theta) * at_cosine(phase, cos) * weight(cos)
                };
                let breaks = [0.0, 0.001, 0.01, 0.1, 1.0, 2.0, 3.0, 3.13, std::f64::consts::PI];
                integrate(f, &breaks, Tolerance::relative(1e-5)).value
            };
            assert!((integral(&|_| 1.0) - 1.0).abs() < 2e-4, "{phase:?}: {}", integral(&|_| 1.0));
            assert!((integral(&|cos| cos) - mean_cosine(phase)).abs() < 2e-4, "{phase:?}");
        }
    }

    /// On seeds chosen afresh one of the tests would fail with probability 1 %.
    #[test]
    fn samples_are_unit_vectors_with_the_mean_cosine_and_the_density_of_eval() {
        let wo = Vec3::new(-0.6, 0.0, -0.8);
        for (seed, phase) in (20..).zip(ALL) {
            let mut rng = Pcg32::new(seed);
            let mut cosines = MeanTest::new();
            for _ in 0..50_000 {
                let sample = phase.sample(wo, Vec2::from_array(rng.vec2_f32()));
                assert!((sample.wi.length() - 1.0).abs() < 1e-6);
                assert_eq!(sample.pdf_solid_angle, phase.eval(wo, sample.wi));
                cosines.push(f64::from(-wo.dot(sample.wi)));
            }
            let outcome = cosines.within(mean_cosine(phase), 1e-6);
            assert!(outcome.passes(sidak(ALPHA, ALL.len())), "{phase:?}: {outcome}");
        }
    }

    #[test]
    fn positive_g_is_forward() {
        let forward = Phase::HenyeyGreenstein { g: 0.5 };
        // (1 − g²)/(4π(1 ∓ g)³) ahead and behind.
        assert!((forward.eval(-Vec3::Z, Vec3::Z) - 0.75 / 0.125 * warp::SPHERE_PDF).abs() < 1e-6);
        assert!((forward.eval(-Vec3::Z, -Vec3::Z) - 0.75 / 3.375 * warp::SPHERE_PDF).abs() < 1e-7);
    }

    #[test]
    fn corners_of_the_square_give_directions() {
        let last = 1.0 - f32::EPSILON / 2.0;
        let sharpest = 1.0 - f32::EPSILON / 2.0;
        let extreme = [-sharpest, sharpest, f32::MIN_POSITIVE, -1e-30].map(|g| Phase::HenyeyGreenstein { g });
        for phase in ALL.into_iter().chain(extreme) {
            for u in [Vec2::ZERO, Vec2::new(last, last), Vec2::new(0.5, 0.0), Vec2::new(0.0, last)] {
                let sample = phase.sample(Vec3::Y, u);
                assert!((sample.wi.length() - 1.0).abs() < 1e-6, "{phase:?} {u}: {}", sample.wi);
                assert!(sample.pdf_solid_angle.is_finite() && sample.pdf_solid_angle >= 0.0, "{phase:?}");
            }
        }
    }
}
