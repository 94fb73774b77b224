use std::f32::consts::FRAC_1_PI;

use super::albedo::of_facets;
use super::bsdf::Transport;
use super::disney_diffuse::Base;
use super::fresnel::fresnel_dielectric;
use super::kind::Classes;
use super::microfacet::Microfacet;
use super::mixture::{MOST, Scatter, lobes};
use super::rough_dielectric::{facet_between, reflected_between, refract_at, refraction, refraction_pdf};
use super::roughness::Distribution;
use crate::color::Rgb;
use crate::math::{Vec2, Vec3, real, warp};

/// The lobes by number.
const MAIN: usize = 0;
const THROUGH: usize = 1;
const COAT: usize = 2;
const BASE: usize = 3;

/// The coat's strength at most.
const COAT_STRENGTH: f32 = 0.25;

/// The α of the coat's masking.
const COAT_MASKING: f32 = 0.25;

/// Disney's material by Mitsuba's formulae (Burley 2012 and 2015), but where it would reflect more than arrives: there
/// it is scaled down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disney {
    pub color: Rgb,
    pub eta: f32,
    pub metallic: f32,
    pub spec_trans: f32,
    pub spec_tint: f32,
    /// 0.25 of the parameter.
    pub clearcoat: f32,
    /// α of the coat's distribution.
    pub coat_alpha: f32,
    pub base: Base,
    pub facets: Microfacet,
}

/// (1 − c)⁵.
#[inline]
pub(super) fn schlick(cos: f32) -> f32 {
    let x = (1.0 - cos).clamp(0.0, 1.0);
    let x_sq = x * x;
    x_sq * x_sq * x
}

impl Disney {
    /// The facets of a root of α and an anisotropy.
    pub fn facets(roughness: f32, anisotropic: f32) -> Microfacet {
        let aspect = (1.0 - 0.9 * anisotropic).sqrt();
        let alpha = roughness * roughness;
        Microfacet::new(Distribution::Ggx, (alpha / aspect).max(1e-3), (alpha * aspect).max(1e-3))
    }

    /// Strengths of 0 to 1 become those of the lobes.
    pub fn coat(clearcoat: f32, gloss: f32) -> (f32, f32) {
        (COAT_STRENGTH * clearcoat, 0.1 + (1e-3 - 0.1) * gloss)
    }

    /// What is light to go through of what is not reflected.
    fn clear(&self) -> f32 {
        (1.0 - self.metallic) * self.spec_trans
    }

    fn tint(&self) -> Rgb {
        let luminance = self.color.luminance();
        if luminance > 0.0 { self.color / luminance } else { Rgb::WHITE }
    }

    /// What a facet of the main lobe reflects, seen from outside.
    fn reflected(&self, cos: f32) -> Rgb {
        let weight = schlick(cos);
        let towards_white = |f0: Rgb| f0 + (Rgb::WHITE - f0) * weight;
        let mut sum =
            Rgb::splat((1.0 - self.metallic) * (1.0 - self.spec_tint) * fresnel_dielectric(cos, self.eta));
        sum += towards_white(self.color) * self.metallic;
        if self.spec_tint > 0.0 {
            sum += towards_white(self.tint() * self.f0()) * ((1.0 - self.metallic) * self.spec_tint);
        }
        sum
    }

    fn f0(&self) -> f32 {
        fresnel_dielectric(1.0, self.eta)
    }

    /// The coat's value (GTR of exponent 1; Burley 2012, §5.5).
    fn coat_value(&self, wo: Vec3, wi: Vec3, m: Vec3) -> f32 {
        let masking = Microfacet::new(Distribution::Ggx, COAT_MASKING, COAT_MASKING);
        let fresnel = 0.04 + 0.96 * schlick(wo.dot(m));
        self.clearcoat * fresnel * self.coat_density(m) * masking.masking_of_refraction(wo, wi)
    }

    fn coat_density(&self, m: Vec3) -> f32 {
        let alpha_sq = self.coat_alpha * self.coat_alpha;
        // With the squared sine, which keeps its digits near the normal.
        let under = alpha_sq * m.z * m.z + m.x * m.x + m.y * m.y;
        (1.0 - alpha_sq) * FRAC_1_PI / (-real::ln(alpha_sq) * under)
    }

    fn coat_facet(&self, u: Vec2) -> Vec3 {
        let alpha_sq = self.coat_alpha * self.coat_alpha;
        let sin_sq =
            (alpha_sq * real::exp_m1(-real::ln(alpha_sq) * (1.0 - u.x)) / (1.0 - alpha_sq)).clamp(0.0, 1.0);
        let (sin_phi, cos_phi) = real::sin_cos(std::f32::consts::TAU * u.y);
        let sin = sin_sq.sqrt();
        Vec3::new(sin * cos_phi, sin * sin_phi, (1.0 - sin_sq).sqrt())
    }

    /// A bound on what is scattered of light from above: above one, all is scaled down.
    fn bound(&self, cos: f32) -> f32 {
        let [a, b] = of_facets(cos, self.facets.mean_alpha());
        let normal = (1.0 - self.metallic)
            * (self.f0() * (1.0 - self.spec_tint) + self.spec_tint * (self.tint() * self.f0()).max_channel())
            + self.metallic * self.color.max_channel();
        let main = (normal * a + b).min(1.0);
        // By how much Fresnel's formulae are above Schlick's at middle angles.
        let more = 0.012 * (1.0 - self.metallic);
        let through = self.clear() * self.color.max_channel().sqrt() * (1.0 - main);
        // Close above what quadrature gives for all glosses; its masking takes what Fresnel's formulae add at grazing angles.
        let coat = self.clearcoat * (0.035 + 0.115 * cos * cos);
        main + more + through + coat + self.base.bound(cos)
    }

    /// What both directions are scaled by, so that neither gets more than there is.
    fn scale(&self, wo: Vec3, wi: Vec3) -> f32 {
        let of = |w: Vec3| if w.z > 0.0 { self.bound(w.z) } else { 1.0 };
        1.0 / of(wo).max(of(wi)).max(1.0)
    }
}

impl Scatter for Disney {
    fn classes(&self) -> [Classes; MOST] {
        let of = |is_there, class| if is_there { class } else { Classes::NONE };
        let coat = if self.coat_alpha < 0.1 { Classes::SHARP } else { Classes::GLOSSY };
        lobes([
            self.facets.class(),
            of(self.clear() > 0.0 && !self.color.is_black(), self.facets.class()),
            of(self.clearcoat > 0.0, coat),
            of(!self.base.is_black(), Classes::DIFFUSE),
        ])
    }

    fn shares(&self, wo: Vec3) -> [f32; MOST] {
        let cos = wo.z.abs();
        if wo.z < 0.0 {
            let fresnel = fresnel_dielectric(cos, 1.0 / self.eta);
            let clear = self.clear();
            return lobes([
                clear * fresnel.max(0.02),
                clear * (1.0 - fresnel).max(0.02) * self.color.mean().sqrt(),
            ]);
        }
        let main = self.reflected(cos).mean();
        let coat = self.clearcoat * (0.05 + 0.95 * schlick(cos));
        let through = self.clear() * (1.0 - fresnel_dielectric(cos, self.eta)).max(0.02);
        lobes([main.max(1e-3), through * self.color.mean().sqrt(), coat, self.base.share(cos)])
    }

    fn transmits(&self) -> bool {
        self.clear() > 0.0 && !self.color.is_black()
    }

    fn eval(&self, among: Classes, wo: Vec3, wi: Vec3, transport: Transport) -> Rgb {
        let outside = wo.z > 0.0;
        let eta = if outside { self.eta } else { 1.0 / self.eta };
        let Some(m) = facet_between(wo, wi, eta) else { return Rgb::BLACK };
        let cos = wo.dot(m).abs();
        let is_main = among.meets(self.facets.class());
        if wo.z * wi.z < 0.0 {
            if !is_main || self.clear() <= 0.0 {
                return Rgb::BLACK;
            }
            let f = self.clear() * (1.0 - reflected_between(wo, wi, m, eta));
            let f = f * refraction(&self.facets, wo, wi, m, eta) * self.scale(wo, wi);
            return self.color.sqrt() * transport.of_refraction(f, eta);
        }
        if !outside {
            let fresnel = self.clear() * fresnel_dielectric(cos, eta);
            let f = if is_main { fresnel * self.facets.reflection(wo, wi, m) } else { 0.0 };
            return Rgb::splat(f);
        }
        let mut sum = Rgb::BLACK;
        if is_main {
            sum += self.reflected(cos) * self.facets.reflection(wo, wi, m);
        }
        if self.clearcoat > 0.0 && among.meets(self.classes()[COAT]) {
            sum += Rgb::splat(self.coat_value(wo, wi, m));
        }
        if among.meets(Classes::DIFFUSE) {
            sum += self.base.eval(wo.z, wi.z, cos);
        }
        sum * self.scale(wo, wi)
    }

    fn pdf(&self, lobe: usize, wo: Vec3, wi: Vec3) -> f32 {
        let outside = wo.z > 0.0;
        let eta = if outside { self.eta } else { 1.0 / self.eta };
        let Some(m) = facet_between(wo, wi, eta) else { return 0.0 };
        let up = if outside { wo } else { -wo };
        match (lobe, wo.z * wi.z > 0.0) {
            (MAIN, true) => self.facets.reflection_pdf(up, m),
            (THROUGH, false) => refraction_pdf(&self.facets, wo, wi, m, eta),
            (COAT, true) if outside => self.coat_density(m) * m.z / (4.0 * wo.dot(m)),
            (BASE, true) if outside => wi.z * FRAC_1_PI,
            _ => 0.0,
        }
    }

    fn sample(&self, lobe: usize, wo: Vec3, u: Vec2, _: f32) -> Option<Vec3> {
        let outside = wo.z > 0.0;
        let (up, eta) = if outside { (wo, self.eta) } else { (-wo, 1.0 / self.eta) };
        let same_side = |wi: Vec3| (wi.z > 0.0).then_some(if outside { wi } else { -wi });
        match lobe {
            MAIN => same_side(self.facets.sample_reflection(up, u)),
            THROUGH => refract_at(wo, self.facets.sample_visible(up, u), eta).filter(|wi| wi.z * wo.z < 0.0),
            COAT => same_side(super::fresnel::mirror(wo, self.coat_facet(u))),
            _ => same_side(warp::square_to_cosine_hemisphere(u)),
        }
    }

    fn radiance_scale(&self, lobe: usize, wo: Vec3, _: Vec3) -> f32 {
        let eta = if wo.z > 0.0 { self.eta } else { 1.0 / self.eta };
        if lobe == THROUGH { 1.0 / (eta * eta) } else { 1.0 }
    }
}
