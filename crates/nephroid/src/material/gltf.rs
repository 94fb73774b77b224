use std::f32::consts::{FRAC_1_PI, TAU};

use super::albedo::of_facets;
use super::bsdf::Transport;
use super::charlie::Charlie;
use super::disney::schlick;
use super::fresnel::refracted_cosine;
use super::kind::Classes;
use super::microfacet::Microfacet;
use super::mixture::{MOST, Scatter, lobes};
use super::rough_dielectric::{facet_between, refract_at, refraction, refraction_pdf};
use crate::color::Rgb;
use crate::math::{Vec2, Vec3, warp};

/// The least index of a boundary that refracts: nearer to one the way of light does not tell its facet.
pub const LEAST_ETA: f32 = 1.001;

/// The lobes by number.
const MAIN: usize = 0;
const THROUGH: usize = 1;
const COAT: usize = 2;
const SHEEN: usize = 3;
const BASE: usize = 4;

/// The material of glTF 2.0 (specification, appendix B, and the extensions), layer by layer from the top: varnish, sheen,
/// and a mixture of metal and dielectric. What a layer leaves to those below is one less its albedo, of whichever of the
/// two directions leaves less, as `KHR_materials_sheen` has it: the formulae of the appendix, which look at one facet
/// or one direction, would reflect up to twice of what arrives at grazing incidence, or not be reciprocal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gltf {
    pub color: Rgb,
    pub metallic: f32,
    pub transmission: f32,
    /// What the dielectric reflects at normal and at grazing incidence.
    pub f0: Rgb,
    pub f90: f32,
    /// Index inside relative to outside; 1 for a thin sheet.
    pub eta: f32,
    pub facets: Microfacet,
    /// Cosine and sine of the angle from the first tangent to the direction of anisotropy.
    pub turn: Vec2,
    pub clearcoat: f32,
    pub coat_facets: Microfacet,
    pub sheen: Charlie,
}

impl Gltf {
    /// A direction in the frame of anisotropy, or back.
    fn turned(&self, w: Vec3, back: f32) -> Vec3 {
        let Vec2 { x: cos, y: sin } = self.turn;
        let sin = sin * back;
        Vec3::new(cos * w.x + sin * w.y, cos * w.y - sin * w.x, w.z)
    }

    fn clear(&self) -> f32 {
        (1.0 - self.metallic) * self.transmission
    }

    fn base(&self) -> Rgb {
        self.color * ((1.0 - self.metallic) * (1.0 - self.transmission))
    }

    /// Whether light on its way through is bent.
    pub fn refracts(&self) -> bool {
        !self.is_thin() && self.clear() > 0.0
    }

    /// The same for light of another index. What is reflected stays: it is given by colours, not by the index.
    pub fn with_eta(self, eta: f32) -> Self {
        if self.is_thin() { self } else { Self { eta: eta.max(LEAST_ETA), ..self } }
    }

    fn is_thin(&self) -> bool {
        self.eta == 1.0
    }

    fn eta_from(&self, wo: Vec3) -> f32 {
        if wo.z > 0.0 { self.eta } else { 1.0 / self.eta }
    }

    /// What a facet of the dielectric reflects of light that comes from a side with a cosine.
    fn dielectric(&self, cos: f32, outside: bool) -> Rgb {
        let cos = if outside || self.is_thin() {
            cos
        } else {
            // The same as for the way back.
            match refracted_cosine(cos, 1.0 / self.eta) {
                Some(cos) => cos,
                None => return Rgb::WHITE,
            }
        };
        self.f0 + (Rgb::splat(self.f90) - self.f0) * schlick(cos)
    }

    /// What facets reflect outside.
    fn reflected(&self, cos: f32) -> Rgb {
        let metal = self.color + (Rgb::WHITE - self.color) * schlick(cos);
        metal * self.metallic + self.dielectric(cos, true) * (1.0 - self.metallic)
    }

    /// What the dielectric's surface leaves to what is below.
    fn below_surface(&self, cos: f32) -> f32 {
        let [a, b] = of_facets(cos, self.facets.mean_alpha());
        1.0 - (self.f0.max_channel() * a + self.f90 * b).min(1.0)
    }

    /// What varnish leaves to what is below.
    fn below_coat(&self, cos: f32) -> f32 {
        if self.clearcoat == 0.0 {
            return 1.0;
        }
        let [a, b] = of_facets(cos, self.coat_facets.mean_alpha());
        1.0 - self.clearcoat * (0.04 * a + b)
    }

    /// What all layers above leave of light on its way between two directions, of which those below pass none.
    fn below_layers(&self, wo: Vec3, wi: Vec3) -> f32 {
        let least = |of: &dyn Fn(f32) -> f32| {
            let of = |w: Vec3| if w.z > 0.0 { of(w.z) } else { 1.0 };
            of(wo).min(of(wi))
        };
        let sheen = if self.sheen.is_black() { 1.0 } else { least(&|cos| 1.0 - self.sheen.albedo(cos)) };
        sheen * if self.clearcoat > 0.0 { least(&|cos| self.below_coat(cos)) } else { 1.0 }
    }
}

impl Scatter for Gltf {
    fn classes(&self) -> [Classes; MOST] {
        let of = |is_there, class| if is_there { class } else { Classes::NONE };
        lobes([
            self.facets.class(),
            of(self.clear() > 0.0 && !self.color.is_black(), self.facets.class()),
            of(self.clearcoat > 0.0, self.coat_facets.class()),
            of(!self.sheen.is_black(), Classes::DIFFUSE),
            of(!self.base().is_black(), Classes::DIFFUSE),
        ])
    }

    fn shares(&self, wo: Vec3) -> [f32; MOST] {
        let (cos, clear) = (wo.z.abs(), self.clear());
        if wo.z < 0.0 {
            let reflected = self.dielectric(cos, false).mean();
            let through = clear * (1.0 - reflected).max(0.02) * self.color.mean();
            return lobes([clear * reflected.max(0.02), through]);
        }
        let below = self.below_coat(cos);
        let left = below * self.below_surface(cos);
        lobes([
            (below * self.reflected(cos).mean()).max(1e-3),
            (left * clear).max(0.02 * clear) * self.color.mean(),
            (1.0 - below).max(0.02 * self.clearcoat),
            self.sheen.share(cos),
            left.max(0.02) * self.base().mean(),
        ])
    }

    fn transmits(&self) -> bool {
        self.clear() > 0.0 && !self.color.is_black()
    }

    fn eval(&self, among: Classes, wo: Vec3, wi: Vec3, transport: Transport) -> Rgb {
        let (outside, same) = (wo.z > 0.0, wo.z * wi.z > 0.0);
        let is_main = among.meets(self.facets.class());
        if !same || !outside {
            if !is_main || self.clear() == 0.0 {
                return Rgb::BLACK;
            }
            let (o, i) = (self.turned(wo, 1.0), self.turned(wi, 1.0));
            let eta = self.eta_from(wo);
            let i = if self.is_thin() && !same { Vec3::new(i.x, i.y, -i.z) } else { i };
            let Some(m) = facet_between(o, i, eta) else { return Rgb::BLACK };
            // Where light goes through, by the cosine outside on both ways.
            let cos = if same || outside { o.dot(m).abs() } else { i.dot(m).abs() };
            let fresnel = self.dielectric(cos, outside || !same);
            if same {
                return fresnel * (self.clear() * self.facets.reflection(o, i, m));
            }
            let f = if self.is_thin() {
                self.facets.reflection(o, i, m)
            } else {
                transport.of_refraction(refraction(&self.facets, o, i, m, eta), eta)
            };
            let left = (Rgb::WHITE - fresnel) * self.color;
            return left * (f * self.clear() * self.below_layers(wo, wi));
        }
        let mut sum = Rgb::BLACK;
        if is_main {
            let (o, i) = (self.turned(wo, 1.0), self.turned(wi, 1.0));
            let m = (o + i).normalize();
            sum += self.reflected(o.dot(m)) * self.facets.reflection(o, i, m);
        }
        if among.meets(Classes::DIFFUSE) {
            sum += self.base() * (FRAC_1_PI * self.below_surface(wo.z).min(self.below_surface(wi.z)));
        }
        if !sum.is_black() {
            sum *= self.below_layers(wo, wi);
        }
        if !self.sheen.is_black() && among.meets(Classes::DIFFUSE) {
            sum += self.sheen.eval(wo, wi) * self.below_coat(wo.z).min(self.below_coat(wi.z));
        }
        if self.clearcoat > 0.0 && among.meets(self.coat_facets.class()) {
            let m = (wo + wi).normalize();
            let fresnel = self.clearcoat * (0.04 + 0.96 * schlick(wo.dot(m)));
            sum += Rgb::splat(fresnel * self.coat_facets.reflection(wo, wi, m));
        }
        sum
    }

    fn pdf(&self, lobe: usize, wo: Vec3, wi: Vec3) -> f32 {
        let (outside, same) = (wo.z > 0.0, wo.z * wi.z > 0.0);
        let up = |w: Vec3| if outside { w } else { -w };
        match (lobe, same) {
            (MAIN, true) => {
                let (o, i) = (up(self.turned(wo, 1.0)), up(self.turned(wi, 1.0)));
                self.facets.reflection_pdf(o, (o + i).normalize())
            }
            (THROUGH, false) => {
                let (o, i, eta) = (self.turned(wo, 1.0), self.turned(wi, 1.0), self.eta_from(wo));
                if self.is_thin() {
                    let (o, i) = (up(o), up(Vec3::new(i.x, i.y, -i.z)));
                    return self.facets.reflection_pdf(o, (o + i).normalize());
                }
                facet_between(o, i, eta).map_or(0.0, |m| refraction_pdf(&self.facets, o, i, m, eta))
            }
            (COAT, true) if outside => self.coat_facets.reflection_pdf(wo, (wo + wi).normalize()),
            (SHEEN, true) if outside => 1.0 / TAU,
            (BASE, true) if outside => wi.z * FRAC_1_PI,
            _ => 0.0,
        }
    }

    fn sample(&self, lobe: usize, wo: Vec3, u: Vec2, _: f32) -> Option<Vec3> {
        let outside = wo.z > 0.0;
        let up = |w: Vec3| if outside { w } else { -w };
        let o = self.turned(wo, 1.0);
        let reflect = || Some(up(self.facets.sample_reflection(up(o), u))).filter(|wi| wi.z * wo.z > 0.0);
        match lobe {
            MAIN => reflect().map(|wi| self.turned(wi, -1.0)),
            THROUGH if self.is_thin() => reflect().map(|wi| self.turned(Vec3::new(wi.x, wi.y, -wi.z), -1.0)),
            THROUGH => refract_at(o, self.facets.sample_visible(up(o), u), self.eta_from(wo))
                .filter(|wi| wi.z * wo.z < 0.0)
                .map(|wi| self.turned(wi, -1.0)),
            COAT => Some(self.coat_facets.sample_reflection(wo, u)),
            SHEEN => Some(warp::square_to_cone(u, 1.0)),
            _ => Some(warp::square_to_cosine_hemisphere(u)),
        }
    }

    fn radiance_scale(&self, lobe: usize, wo: Vec3, _: Vec3) -> f32 {
        let eta = self.eta_from(wo);
        if lobe == THROUGH { 1.0 / (eta * eta) } else { 1.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Distribution;
    use super::*;

    #[test]
    fn light_of_another_index_is_refracted_by_it() {
        let smooth = Microfacet::new(Distribution::Ggx, 0.0, 0.0);
        let glass = Gltf {
            color: Rgb::WHITE,
            metallic: 0.0,
            transmission: 1.0,
            f0: Rgb::splat(0.04),
            f90: 1.0,
            eta: 1.5,
            facets: smooth,
            turn: Vec2::X,
            clearcoat: 0.0,
            coat_facets: smooth,
            sheen: Charlie::new(Rgb::BLACK, 0.0),
        };
        assert!(glass.refracts());
        for eta in [1.5, 1.7, 1.0] {
            let wi = glass.with_eta(eta).sample(THROUGH, Vec3::new(0.6, 0.0, 0.8), Vec2::splat(0.5), 0.5);
            let wi = wi.expect("nothing is reflected totally on the way in");
            // Facets lean by about their α.
            assert!((wi.x + 0.6 / eta).abs() < 0.01 && wi.z < 0.0, "{eta}: {wi}");
        }
        let sheet = Gltf { eta: 1.0, ..glass };
        assert!(!sheet.refracts() && sheet.with_eta(1.7) == sheet);
    }
}
