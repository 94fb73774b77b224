use std::f32::consts::FRAC_1_PI;

use crate::color::Rgb;
use crate::math::{Frame, Vec2, Vec3, warp};

/// Reflects the same radiance into every direction above the surface: f = ρ/π.
///
/// The lobe functions of this folder take directions above the surface; [`Bsdf`](super::Bsdf) has
/// looked at the sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lambertian {
    /// The albedo ρ.
    pub albedo: Rgb,
}

impl Lambertian {
    #[inline]
    pub fn eval(&self) -> Rgb {
        self.albedo * FRAC_1_PI
    }

    /// Per solid angle.
    #[inline]
    pub fn pdf(n: Vec3, wi: Vec3) -> f32 {
        wi.dot(n).max(0.0) * FRAC_1_PI
    }

    #[inline]
    pub fn sample(frame: &Frame, u: Vec2) -> Vec3 {
        frame.to_world(warp::square_to_cosine_hemisphere(u))
    }
}
