//! The Dirac lobes of a BSDF: mirrors, and the smooth boundaries of glass.

use super::bsdf::{Bsdf, Lobes, Transport};
use super::fresnel::mirror;
use super::kind::{Classes, LobeKind};
use super::mixture;
use super::sample::BsdfSample;
use super::split::Split;
use crate::color::Rgb;
use crate::math::Vec3;

impl Bsdf {
    /// The Dirac lobes, reflection first and then transmission, each with its full weight: following
    /// both is what [`sample`](Self::sample) does on average.
    pub fn dirac_lobes(&self, wo: Vec3, transport: Transport) -> [Option<BsdfSample>; 2] {
        match self.split(wo) {
            None => [None, None],
            Some(split) => [self.reflection(wo, &split, transport), self.transmission(wo, &split, transport)],
        }
    }

    /// The Dirac lobes as seen from `wo`, if there are any.
    fn split(&self, wo: Vec3) -> Option<Split> {
        let outside = wo.dot(self.ng) > 0.0;
        let n = self.facing(self.frame.n, wo);
        match &self.lobes {
            Lobes::Null => Some(Split::pass(wo, Rgb::WHITE)),
            Lobes::Conductor(conductor) if outside => Some(conductor.split(wo.dot(n))),
            Lobes::Dielectric(dielectric) => Some(dielectric.split(wo, n, outside)),
            Lobes::ThinDielectric(thin) => Some(thin.split_thin(wo, wo.dot(n))),
            Lobes::One(_) | Lobes::Blend(_) if self.among.meets(Classes::DIRAC) => self.split_mixture(wo),
            _ => None,
        }
    }

    fn split_mixture(&self, wo: Vec3) -> Option<Split> {
        let local = self.frame.to_local(wo);
        let mut split = mixture::split(self.lobes.parts(), local)?;
        if let Some(refraction) = &mut split.refraction {
            let straight = refraction.wi == -local;
            refraction.wi = if straight { -wo } else { self.frame.to_world(refraction.wi).normalize() };
        }
        Some(split)
    }

    pub(super) fn sample_dirac(&self, wo: Vec3, u_lobe: f32, transport: Transport) -> Option<BsdfSample> {
        let split = self.split(wo)?;
        let reflect = u_lobe < split.reflect_probability;
        let (lobe, probability) = if reflect {
            (self.reflection(wo, &split, transport), split.reflect_probability)
        } else {
            (self.transmission(wo, &split, transport), 1.0 - split.reflect_probability)
        };
        lobe.map(|sample| BsdfSample { weight: sample.weight / probability, ..sample })
    }

    fn reflection(&self, wo: Vec3, split: &Split, transport: Transport) -> Option<BsdfSample> {
        let n = self.facing(self.frame.n, wo);
        let wi = mirror(wo, n).normalize();
        let ng = self.facing(self.ng, wo);
        let seen = wo.dot(n) > 0.0 && wi.dot(n) > 0.0 && wi.dot(ng) > 0.0;
        if !seen || split.reflectance.is_black() {
            return None;
        }
        let weight = split.reflectance * self.carried(wo, wi, transport);
        let (lobe, transmitted) = (LobeKind::Dirac, false);
        Some(BsdfSample { wi, weight, radiance_scale: 1.0, pdf_solid_angle: 0.0, lobe, transmitted })
    }

    fn transmission(&self, wo: Vec3, split: &Split, transport: Transport) -> Option<BsdfSample> {
        let refraction = split.refraction?;
        let wi = refraction.wi;
        let (n, ng) = (self.facing(self.frame.n, wo), self.facing(self.ng, wo));
        let seen = wi == -wo || (wo.dot(n) > 0.0 && wi.dot(n) < 0.0 && wi.dot(ng) < 0.0);
        if !seen || refraction.transmittance.is_black() {
            return None;
        }
        let radiance_scale = match transport {
            Transport::Radiance => refraction.radiance_scale,
            Transport::Flux => 1.0,
        };
        let weight = refraction.transmittance * (radiance_scale * self.carried(wo, wi, transport));
        let (lobe, transmitted) = (LobeKind::Dirac, true);
        Some(BsdfSample { wi, weight, radiance_scale, pdf_solid_angle: 0.0, lobe, transmitted })
    }

    /// A normal of the surface, turned to the side of `wo`.
    #[inline]
    fn facing(&self, normal: Vec3, wo: Vec3) -> Vec3 {
        if wo.dot(self.ng) > 0.0 { normal } else { -normal }
    }
}
