use super::bsdf::Transport;
use super::fresnel::{dielectric_reflectance, fresnel_dielectric, mirror, refract, refracted_cosine};
use super::kind::Classes;
use super::microfacet::Microfacet;
use super::mixture::{MOST, Scatter, lobes};
use crate::color::Rgb;
use crate::math::{Vec2, Vec3};

/// The rough boundary of two dielectrics (Walter et al. 2007, equations 20 and 21). Seen from either side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoughDielectric {
    /// Index below the surface relative to that above, not 1.
    pub eta: f32,
    pub reflectance: Rgb,
    pub transmittance: Rgb,
    pub facets: Microfacet,
}

impl RoughDielectric {
    fn eta_from(&self, wo: Vec3) -> f32 {
        if wo.z > 0.0 { self.eta } else { 1.0 / self.eta }
    }

    /// The share of samples that are reflected at a facet that reflects so much.
    fn reflect_probability(&self, fresnel: f32) -> f32 {
        let (r, t) = (fresnel * self.reflectance.mean(), (1.0 - fresnel) * self.transmittance.mean());
        if r > 0.0 { r / (r + t) } else { 0.0 }
    }
}

/// The facet that reflects or refracts one direction into the other, on the upper side; `None` where its far side
/// would have to. `eta` is the index of the far side of `wo` relative to its own.
#[inline]
pub(super) fn facet_between(wo: Vec3, wi: Vec3, eta: f32) -> Option<Vec3> {
    let sum = if wo.z * wi.z > 0.0 { wo + wi } else { wo + eta * wi };
    let m = sum.try_normalize()?;
    let m = if m.z < 0.0 { -m } else { m };
    (wo.dot(m) * wo.z > 0.0 && wi.dot(m) * wi.z > 0.0).then_some(m)
}

/// What the facet between two directions reflects. From both cosines where light goes through: one of them alone has too
/// few digits near the critical angle.
#[inline]
pub(super) fn reflected_between(wo: Vec3, wi: Vec3, m: Vec3, eta: f32) -> f32 {
    let (cos_o, cos_i) = (wo.dot(m).abs(), wi.dot(m).abs());
    if wo.z * wi.z > 0.0 { fresnel_dielectric(cos_o, eta) } else { dielectric_reflectance(cos_o, cos_i, eta) }
}

/// f of refraction without Fresnel's share, for radiance that is carried towards `wo`.
#[inline]
pub(super) fn refraction(facets: &Microfacet, wo: Vec3, wi: Vec3, m: Vec3, eta: f32) -> f32 {
    let (o, i) = (wo.dot(m), wi.dot(m));
    let under = o + eta * i;
    let geometry = facets.density(m) * facets.masking_of_refraction(wo, wi);
    geometry * (o * i / (wo.z * wi.z * under * under)).abs()
}

/// Density per solid angle with which a visible facet refracts `wo` to `wi`.
#[inline]
pub(super) fn refraction_pdf(facets: &Microfacet, wo: Vec3, wi: Vec3, m: Vec3, eta: f32) -> f32 {
    let (o, i) = (wo.dot(m), wi.dot(m));
    let under = o + eta * i;
    facets.density(m) * facets.masking(wo) * (o / wo.z).abs() * (eta * eta * i).abs() / (under * under)
}

/// Refracts `wo` at a facet on the upper side; `None` where it is reflected totally.
#[inline]
pub(super) fn refract_at(wo: Vec3, m: Vec3, eta: f32) -> Option<Vec3> {
    let m = if wo.z > 0.0 { m } else { -m };
    let cos_o = wo.dot(m).clamp(0.0, 1.0);
    Some(refract(wo, m, cos_o, refracted_cosine(cos_o, eta)?, eta))
}

impl Scatter for RoughDielectric {
    fn classes(&self) -> [Classes; MOST] {
        lobes([self.facets.class()])
    }

    fn shares(&self, _: Vec3) -> [f32; MOST] {
        lobes([1.0])
    }

    fn transmits(&self) -> bool {
        true
    }

    fn eval(&self, among: Classes, wo: Vec3, wi: Vec3, transport: Transport) -> Rgb {
        let eta = self.eta_from(wo);
        let Some(m) = facet_between(wo, wi, eta).filter(|_| among.meets(self.facets.class())) else {
            return Rgb::BLACK;
        };
        let fresnel = reflected_between(wo, wi, m, eta);
        if wo.z * wi.z > 0.0 {
            self.reflectance * (fresnel * self.facets.reflection(wo, wi, m))
        } else {
            let f = (1.0 - fresnel) * refraction(&self.facets, wo, wi, m, eta);
            self.transmittance * transport.of_refraction(f, eta)
        }
    }

    fn pdf(&self, _: usize, wo: Vec3, wi: Vec3) -> f32 {
        let eta = self.eta_from(wo);
        let Some(m) = facet_between(wo, wi, eta) else { return 0.0 };
        let reflect = self.reflect_probability(reflected_between(wo, wi, m, eta));
        if wo.z * wi.z > 0.0 {
            let upward = |w: Vec3| if wo.z > 0.0 { w } else { -w };
            reflect * self.facets.reflection_pdf(upward(wo), m)
        } else {
            (1.0 - reflect) * refraction_pdf(&self.facets, wo, wi, m, eta)
        }
    }

    fn sample(&self, _: usize, wo: Vec3, u: Vec2, u_lobe: f32) -> Option<Vec3> {
        let eta = self.eta_from(wo);
        let m =
            if wo.z > 0.0 { self.facets.sample_visible(wo, u) } else { -self.facets.sample_visible(-wo, u) };
        let cos_o = wo.dot(m).clamp(0.0, 1.0);
        let Some(cos_i) = refracted_cosine(cos_o, eta) else {
            return Some(mirror(wo, m)).filter(|wi| wi.z * wo.z > 0.0);
        };
        if u_lobe < self.reflect_probability(dielectric_reflectance(cos_o, cos_i, eta)) {
            return Some(mirror(wo, m)).filter(|wi| wi.z * wo.z > 0.0);
        }
        Some(refract(wo, m, cos_o, cos_i, eta)).filter(|wi| wi.z * wo.z < 0.0)
    }

    fn radiance_scale(&self, _: usize, wo: Vec3, wi: Vec3) -> f32 {
        let eta = self.eta_from(wo);
        if wo.z * wi.z < 0.0 { 1.0 / (eta * eta) } else { 1.0 }
    }
}
