use super::Metal;
use super::bsdf::Transport;
use super::conductor::metal_reflectance;
use super::kind::Classes;
use super::microfacet::Microfacet;
use super::mixture::{MOST, Scatter, lobes};
use crate::color::Rgb;
use crate::math::{Vec2, Vec3};

/// A rough metal (Walter et al. 2007, equation 20).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoughConductor {
    pub metal: Metal,
    pub reflectance: Rgb,
    pub facets: Microfacet,
}

impl Scatter for RoughConductor {
    fn classes(&self) -> [Classes; MOST] {
        lobes([self.facets.class()])
    }

    fn shares(&self, wo: Vec3) -> [f32; MOST] {
        lobes([if wo.z > 0.0 { 1.0 } else { 0.0 }])
    }

    fn eval(&self, among: Classes, wo: Vec3, wi: Vec3, _: Transport) -> Rgb {
        if !(among.meets(self.facets.class()) && wo.z > 0.0 && wi.z > 0.0) {
            return Rgb::BLACK;
        }
        let m = (wo + wi).normalize();
        let fresnel = metal_reflectance(&self.metal, wo.dot(m));
        fresnel * self.reflectance * self.facets.reflection(wo, wi, m)
    }

    fn pdf(&self, _: usize, wo: Vec3, wi: Vec3) -> f32 {
        if wo.z > 0.0 && wi.z > 0.0 { self.facets.reflection_pdf(wo, (wo + wi).normalize()) } else { 0.0 }
    }

    fn sample(&self, _: usize, wo: Vec3, u: Vec2, _: f32) -> Option<Vec3> {
        Some(self.facets.sample_reflection(wo, u))
    }
}
