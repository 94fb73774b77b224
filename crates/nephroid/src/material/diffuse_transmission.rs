use std::f32::consts::FRAC_1_PI;

use super::bsdf::Transport;
use super::kind::Classes;
use super::mixture::{MOST, Scatter, lobes};
use crate::color::Rgb;
use crate::math::{Vec2, Vec3, warp};

/// The same radiance in all directions of each side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiffuseTransmission {
    pub reflectance: Rgb,
    pub transmittance: Rgb,
}

impl Scatter for DiffuseTransmission {
    fn classes(&self) -> [Classes; MOST] {
        let of = |albedo: Rgb| if albedo.is_black() { Classes::NONE } else { Classes::DIFFUSE };
        lobes([of(self.reflectance), of(self.transmittance)])
    }

    fn shares(&self, _: Vec3) -> [f32; MOST] {
        lobes([self.reflectance.mean(), self.transmittance.mean()])
    }

    fn transmits(&self) -> bool {
        !self.transmittance.is_black()
    }

    fn eval(&self, among: Classes, wo: Vec3, wi: Vec3, _: Transport) -> Rgb {
        if !among.meets(Classes::DIFFUSE) {
            return Rgb::BLACK;
        }
        (if wo.z * wi.z > 0.0 { self.reflectance } else { self.transmittance }) * FRAC_1_PI
    }

    fn pdf(&self, lobe: usize, wo: Vec3, wi: Vec3) -> f32 {
        if (wo.z * wi.z > 0.0) == (lobe == 0) { wi.z.abs() * FRAC_1_PI } else { 0.0 }
    }

    fn sample(&self, lobe: usize, wo: Vec3, u: Vec2, _: f32) -> Option<Vec3> {
        let up = warp::square_to_cosine_hemisphere(u);
        Some(if (wo.z > 0.0) == (lobe == 0) { up } else { -up })
    }
}
