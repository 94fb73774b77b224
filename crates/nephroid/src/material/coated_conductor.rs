use super::Metal;
use super::albedo::Coat;
use super::bsdf::Transport;
use super::conductor::metal_reflectance;
use super::fresnel::{fresnel_dielectric, mirror};
use super::kind::Classes;
use super::microfacet::Microfacet;
use super::mixture::{MOST, Scatter, lobes};
use super::split::Split;
use crate::color::Rgb;
use crate::math::{Vec2, Vec3};

/// The lobes by number: what the coat reflects, and what the metal does below it.
const COAT: usize = 0;

/// A metal under a dielectric coat without absorption (after Weidlich and Wilkie 2007, *Arbitrarily Layered Micro-Facet
/// Surfaces*): light is refracted at the mean surface of the coat, reflected at a facet of the metal and refracted again.
/// What goes to and fro between them is the geometric series of the facet, exact where both are smooth.
///
/// A rough coat is smooth for refraction, and the facets of the metal are the rougher: a slope s of the coat, passed
/// twice, turns light as one of s (η−1)/(√2 η) of the metal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoatedConductor {
    coat: Coat,
    coat_facets: Option<Microfacet>,
    /// Relative to the coat.
    metal: Metal,
    reflectance: Rgb,
    facets: Option<Microfacet>,
}

impl CoatedConductor {
    pub fn new(
        metal: Metal,
        reflectance: Rgb,
        facets: Option<Microfacet>,
        coat_eta: f32,
        coat_facets: Option<Microfacet>,
    ) -> Self {
        let metal = match metal {
            Metal::PerfectMirror => metal,
            Metal::Index { eta, k } => Metal::Index { eta: eta / coat_eta, k: k / coat_eta },
        };
        let coat_alpha = coat_facets.map_or(0.0, |facets| facets.mean_alpha());
        let turned = coat_alpha * (coat_eta - 1.0) / (2.0f32.sqrt() * coat_eta);
        let facets = match (facets, coat_facets) {
            (Some(own), _) => Some(own.with_alphas(|alpha| (alpha * alpha + turned * turned).sqrt())),
            (None, Some(coat)) => Some(coat.with_alphas(|_| turned)),
            (None, None) => None,
        };
        Self { coat: Coat::new(coat_eta, coat_alpha), coat_facets, metal, reflectance, facets }
    }

    /// The direction inside the coat.
    fn inside(&self, w: Vec3) -> Vec3 {
        let (x, y) = (w.x / self.coat.eta, w.y / self.coat.eta);
        Vec3::new(x, y, (1.0 - x * x - y * y).max(0.0).sqrt())
    }

    /// What the metal reflects at a facet, and what comes back to it from the coat.
    fn series(&self, cos: f32) -> Rgb {
        let metal = metal_reflectance(&self.metal, cos) * self.reflectance;
        let back = fresnel_dielectric(cos, 1.0 / self.coat.eta);
        metal.map(|metal| if back * metal < 1.0 { metal / (1.0 - back * metal) } else { 0.0 })
    }

    fn class_of(facets: Option<Microfacet>) -> Classes {
        facets.map_or(Classes::DIRAC, |facets| facets.class())
    }
}

impl Scatter for CoatedConductor {
    fn classes(&self) -> [Classes; MOST] {
        lobes([
            if self.coat.eta > 1.0 { Self::class_of(self.coat_facets) } else { Classes::NONE },
            if self.reflectance.is_black() { Classes::NONE } else { Self::class_of(self.facets) },
        ])
    }

    fn shares(&self, wo: Vec3) -> [f32; MOST] {
        if wo.z <= 0.0 {
            return [0.0; MOST];
        }
        let reflected = self.coat.reflected(wo.z);
        let metal = (1.0 - reflected) * self.series(self.inside(wo).z).mean();
        lobes([reflected.max(1e-6), metal.max(1e-6)])
    }

    fn eval(&self, among: Classes, wo: Vec3, wi: Vec3, _: Transport) -> Rgb {
        if !(wo.z > 0.0 && wi.z > 0.0) {
            return Rgb::BLACK;
        }
        let mut sum = Rgb::BLACK;
        if let Some(facets) = self.coat_facets
            && among.meets(facets.class())
        {
            let m = (wo + wi).normalize();
            let fresnel = fresnel_dielectric(wo.dot(m), self.coat.eta);
            sum += Rgb::splat(fresnel * facets.reflection(wo, wi, m));
        }
        if let Some(facets) = self.facets
            && among.meets(facets.class())
        {
            let (o, i) = (self.inside(wo), self.inside(wi));
            let m = (o + i).normalize();
            let passed = self.coat.passed(wo.z) * self.coat.passed(wi.z) / (self.coat.eta * self.coat.eta);
            sum += self.series(o.dot(m)) * (passed * facets.reflection(o, i, m));
        }
        sum
    }

    fn pdf(&self, lobe: usize, wo: Vec3, wi: Vec3) -> f32 {
        if !(wo.z > 0.0 && wi.z > 0.0) {
            return 0.0;
        }
        if lobe == COAT {
            return self.coat_facets.map_or(0.0, |facets| facets.reflection_pdf(wo, (wo + wi).normalize()));
        }
        self.facets.map_or(0.0, |facets| {
            let (o, i) = (self.inside(wo), self.inside(wi));
            let spread = wi.z / (self.coat.eta * self.coat.eta * i.z);
            facets.reflection_pdf(o, (o + i).normalize()) * spread
        })
    }

    fn sample(&self, lobe: usize, wo: Vec3, u: Vec2, _: f32) -> Option<Vec3> {
        if lobe == COAT {
            return self.coat_facets.map(|facets| facets.sample_reflection(wo, u));
        }
        let o = self.inside(wo);
        let i = mirror(o, self.facets?.sample_visible(o, u));
        let (x, y) = (i.x * self.coat.eta, i.y * self.coat.eta);
        let z_sq = 1.0 - x * x - y * y;
        (i.z > 0.0 && z_sq > 0.0).then(|| Vec3::new(x, y, z_sq.sqrt()))
    }

    fn split(&self, wo: Vec3) -> Option<Split> {
        if wo.z <= 0.0 || (self.coat_facets.is_some() && self.facets.is_some()) {
            return None;
        }
        let fresnel = self.coat.reflected(wo.z);
        let mut reflectance = Rgb::BLACK;
        if self.coat_facets.is_none() {
            reflectance += Rgb::splat(fresnel);
        }
        if self.facets.is_none() {
            reflectance += self.series(self.inside(wo).z) * ((1.0 - fresnel) * (1.0 - fresnel));
        }
        Some(Split::mirror(reflectance))
    }
}
