use std::f32::consts::FRAC_1_PI;

use super::bsdf::Transport;
use super::fresnel::fresnel_dielectric;
use super::kind::Classes;
use super::microfacet::Microfacet;
use super::mixture::{MOST, Scatter, lobes};
use super::plastic_coat::PlasticCoat;
use super::split::Split;
use crate::color::Rgb;
use crate::math::{Vec2, Vec3, warp};

/// The lobes by number: what the coat reflects, and what comes out of it.
const COAT: usize = 0;

/// A diffuse base under a dielectric coat, as Mitsuba's `plastic` and `roughplastic`: what passes the boundary on the way
/// in and out, with all that is reflected between boundary and base.
///
/// f = T(wo) T(wi) / (π η²) · ρ/(1 − R ρ), R the mean share that the coat reflects inside. With a white base below a
/// smooth coat all that arrives comes out again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plastic {
    coat: PlasticCoat,
    facets: Option<Microfacet>,
    specular: Rgb,
    /// ρ/(1 − R ρ)/(π η²).
    base: Rgb,
}

impl Plastic {
    pub fn new(eta: f32, diffuse: Rgb, specular: Rgb, nonlinear: bool, facets: Option<Microfacet>) -> Self {
        let coat = PlasticCoat::new(eta, facets.map(|facets| (facets.distribution(), facets.mean_alpha())));
        let inside = coat.inside();
        let series = |rho: f32| 1.0 / (1.0 - inside * if nonlinear { rho } else { 1.0 });
        let base = diffuse.map(|rho| rho * series(rho) * FRAC_1_PI / (eta * eta));
        Self { coat, facets, specular, base }
    }

    fn coat_class(&self) -> Classes {
        self.facets.map_or(Classes::DIRAC, |facets| facets.class())
    }
}

impl Scatter for Plastic {
    fn classes(&self) -> [Classes; MOST] {
        let of = |color: Rgb, class| if color.is_black() { Classes::NONE } else { class };
        lobes([of(self.specular, self.coat_class()), of(self.base, Classes::DIFFUSE)])
    }

    fn shares(&self, wo: Vec3) -> [f32; MOST] {
        if wo.z <= 0.0 {
            return [0.0; MOST];
        }
        let reflected = fresnel_dielectric(wo.z, self.coat.eta);
        // As if a tenth of light from everywhere were reflected.
        let base = self.coat.passed(wo.z) * 0.9 / FRAC_1_PI;
        lobes([(reflected * self.specular.mean()).max(1e-6), (base * self.base.mean()).max(1e-6)])
    }

    fn eval(&self, among: Classes, wo: Vec3, wi: Vec3, _: Transport) -> Rgb {
        if !(wo.z > 0.0 && wi.z > 0.0) {
            return Rgb::BLACK;
        }
        let mut sum = Rgb::BLACK;
        if among.meets(Classes::DIFFUSE) {
            sum += self.base * (self.coat.passed(wo.z) * self.coat.passed(wi.z));
        }
        if let Some(facets) = self.facets
            && among.meets(facets.class())
        {
            let m = (wo + wi).normalize();
            sum +=
                self.specular * (fresnel_dielectric(wo.dot(m), self.coat.eta) * facets.reflection(wo, wi, m));
        }
        sum
    }

    fn pdf(&self, lobe: usize, wo: Vec3, wi: Vec3) -> f32 {
        if !(wo.z > 0.0 && wi.z > 0.0) {
            return 0.0;
        }
        match self.facets {
            Some(facets) if lobe == COAT => facets.reflection_pdf(wo, (wo + wi).normalize()),
            _ if lobe == COAT => 0.0,
            _ => wi.z * FRAC_1_PI,
        }
    }

    fn sample(&self, lobe: usize, wo: Vec3, u: Vec2, _: f32) -> Option<Vec3> {
        match self.facets {
            Some(facets) if lobe == COAT => Some(facets.sample_reflection(wo, u)),
            _ if lobe == COAT => None,
            _ => Some(warp::square_to_cosine_hemisphere(u)),
        }
    }

    fn split(&self, wo: Vec3) -> Option<Split> {
        let smooth = self.facets.is_none() && wo.z > 0.0 && !self.specular.is_black();
        smooth.then(|| Split::mirror(self.specular * fresnel_dielectric(wo.z, self.coat.eta)))
    }
}
