use std::f32::consts::PI;

use super::conductor::Conductor;
use super::dielectric::Dielectric;
use super::fresnel::mirror;
use super::kind::{Classes, LobeKind};
use super::lambertian::Lambertian;
use super::mixture::{self, Blend, Chances, Weighed};
use super::part::Part;
use super::phong::Phong;
use super::split::Split;
use crate::color::Rgb;
use crate::math::{Frame, Vec2, Vec3};

/// What a walk carries, and so which of two adjoint scattering rules it follows (Veach 1997,
/// *Robust Monte Carlo Methods for Light Transport Simulation*, chapter 5).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Transport {
    /// Radiance, on paths from the camera: `wo` points back towards the camera. Refraction multiplies
    /// it by (η_o/η_i)², the squared ratio of the indices on the sides of `wo` and `wi`.
    Radiance,
    /// Power, on paths from a light: `wo` points back towards the light. Refraction leaves it alone;
    /// shading normals multiply it by [`Bsdf::adjoint_factor`].
    Flux,
}

impl Transport {
    /// The value of a refraction that is f for radiance carried from an index of `eta`, relative to that where it comes
    /// to, which is adjoint for power.
    #[inline]
    pub(super) fn of_refraction(self, f: f32, eta: f32) -> f32 {
        match self {
            Self::Radiance => f,
            Self::Flux => f * eta * eta,
        }
    }
}

/// A direction drawn by [`Bsdf::sample`], or one of [`Bsdf::dirac_lobes`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsdfSample {
    /// The unit direction of the next segment, leaving the surface.
    pub wi: Vec3,
    /// f·|cos θ_i| / pdf, with the cosine to the *shading* normal and all that the [`Transport`] asks
    /// for: what the walk multiplies its radiance or power by.
    pub weight: Rgb,
    /// The factor in `weight` that is no gain or loss of light, but the change of radiance between
    /// media, (η_o/η_i)²; 1 but for refracted radiance. Roulette must leave it out: it is undone
    /// where the path comes out of the medium.
    pub radiance_scale: f32,
    /// The density of `wi` per solid angle among all lobes that have one, whichever was drawn; 0 for a Dirac lobe.
    pub pdf_solid_angle: f32,
    /// The class of the lobe that was drawn.
    pub lobe: LobeKind,
    /// Whether `wi` lies on the other side of the geometry than `wo`.
    pub transmitted: bool,
}

impl BsdfSample {
    /// Whether the lobe is a Dirac.
    #[inline]
    pub fn is_dirac(&self) -> bool {
        self.lobe == LobeKind::Dirac
    }

    /// Whether the lobe is too narrow for a density to be estimated from photons.
    #[inline]
    pub fn is_specular(&self) -> bool {
        self.lobe != LobeKind::Broad
    }
}

/// Segments that a path has more behind a surface: none where it goes straight on, as through thin glass. Mitsuba's
/// `volpath` counts so.
pub(crate) fn segments_by(wo: Vec3, wi: Vec3) -> u32 {
    u32::from(wi != -wo)
}

/// How a surface scatters at one point, seen from the side of one `wo`.
///
/// `wo` and `wi` are unit directions in world space that both *leave* the surface: a photon that
/// arrives along `d` has `wi = -d` in a gather and `wo = -d` in its walk. `wo` is on the side of the
/// one that [`Material::at`](super::Material::at) was given.
///
/// [`eval`](Self::eval) has **no cosine** in it, and Dirac lobes are zero in it.
///
/// Sides are those of the geometric normal: a lobe reflects if `wo` and `wi` are on the same side of
/// it, so light does not leak through surfaces whose shading normal leans over. A direction between
/// the two tangent planes meets no lobe but the one that passes straight on, whichever of `wo` and
/// `wi` it is, so that camera paths and photons agree on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bsdf {
    ng: Vec3,
    frame: Frame,
    lobes: Lobes,
    disperses: bool,
    /// Those classes of a mixture's lobes that count.
    among: Classes,
}

/// The kinds of scattering; one file each.
#[expect(clippy::large_enum_variant, reason = "a value is copied where it is made, and without allocation")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Lobes {
    Black,
    Null,
    Diffuse(Lambertian),
    Phong(Phong),
    Conductor(Conductor),
    Dielectric(Dielectric),
    ThinDielectric(Dielectric),
    One(Weighed),
    Blend(Blend),
}

impl Lobes {
    /// What mixtures are made of; nothing of simple ones.
    #[inline]
    fn parts(&self) -> &[Weighed] {
        match self {
            Self::One(one) => std::slice::from_ref(one),
            Self::Blend(blend) => blend.parts(),
            _ => &[],
        }
    }
}

impl Bsdf {
    #[inline(always)]
    pub(super) fn new(ng: Vec3, frame: Frame, lobes: Lobes) -> Self {
        let among = match &lobes {
            Lobes::Black => Classes::NONE,
            Lobes::Diffuse(_) => Classes::DIFFUSE,
            Lobes::Phong(phong) => {
                mixture::Scatter::classes(phong).into_iter().fold(Classes::NONE, Classes::or)
            }
            Lobes::One(_) | Lobes::Blend(_) => mixture::classes(lobes.parts()),
            _ => Classes::DIRAC,
        };
        Self { ng, frame, lobes, among, disperses: false }
    }

    /// The same place with no surface.
    pub(crate) fn nulled(self) -> Self {
        Self { lobes: Lobes::Null, among: Classes::DIRAC, ..self }
    }

    /// The same, the boundary of two dielectrics with another index of refraction on the inner side relative to the
    /// outer one.
    pub(crate) fn with_eta(self, eta: f32) -> Self {
        match self.lobes {
            Lobes::Dielectric(own) => Self { lobes: Lobes::Dielectric(Dielectric { eta, ..own }), ..self },
            Lobes::One(own) => {
                let lobes = Lobes::One(Weighed { part: own.part.with_eta(eta), ..own });
                Self::new(self.ng, self.frame, lobes)
            }
            _ => self,
        }
    }

    /// The same, the boundary of a glass that takes light apart, met by a path of all wavelengths.
    pub(crate) fn dispersing(self) -> Self {
        let disperses = match &self.lobes {
            Lobes::Dielectric(_) => true,
            Lobes::One(one) => one.part.is_rough_lens(),
            _ => false,
        };
        Self { disperses, ..self }
    }

    /// Whether other wavelengths are refracted another way, so that a path must be of a single one.
    #[inline]
    pub(crate) fn disperses(&self) -> bool {
        self.disperses
    }

    /// Whether all scattering is in Dirac lobes, so that there is no density to estimate here.
    #[inline]
    pub fn is_dirac(&self) -> bool {
        self.among == Classes::DIRAC
    }

    /// Whether light passes as if there were no surface.
    #[inline]
    pub fn is_null(&self) -> bool {
        matches!(self.lobes, Lobes::Null)
    }

    /// Whether nothing is scattered.
    #[inline]
    pub fn is_black(&self) -> bool {
        matches!(self.lobes, Lobes::Black)
    }

    /// Whether there are lobes of a class.
    #[inline]
    pub fn has(&self, kind: LobeKind) -> bool {
        self.among.meets(Classes::of(kind))
    }

    /// The lobes of one class alone. The three parts add up to the whole.
    pub fn part(&self, kind: LobeKind) -> Self {
        self.of(Classes::of(kind))
    }

    /// The lobes of some classes alone.
    fn of(&self, classes: Classes) -> Self {
        let among = self.among.and(classes);
        let lobes = match self.lobes {
            _ if among.is_none() => Lobes::Black,
            Lobes::Phong(phong) if among == Classes::DIFFUSE => {
                Lobes::Diffuse(Lambertian { albedo: phong.diffuse })
            }
            Lobes::Phong(phong) if among == Classes::GLOSSY => {
                Lobes::Phong(Phong { diffuse: Rgb::BLACK, ..phong })
            }
            lobes => lobes,
        };
        Self { lobes, among, ..*self }
    }

    /// All lobes but the broad ones.
    pub fn without_broad(&self) -> Self {
        self.of(Classes::DIRAC.or(Classes::SHARP))
    }

    /// Whether there are lobes that are too narrow for a density to be estimated from photons.
    #[inline]
    pub fn has_specular(&self) -> bool {
        self.has(LobeKind::Dirac) || self.has(LobeKind::Sharp)
    }

    /// Whether [`eval`](Self::eval) may be above zero for directions on opposite sides.
    #[inline]
    pub fn transmits(&self) -> bool {
        self.among.meets(Classes::DENSE)
            && self.lobes.parts().iter().any(|w| mixture::Scatter::transmits(&w.part))
    }

    /// Whether there are lobes with a density that are brighter about some direction.
    #[inline]
    pub fn has_glossy_lobe(&self) -> bool {
        self.among.meets(Classes::SHARP.or(Classes::GLOSSY))
    }

    /// The albedo of the Lambertian lobe; of what else is alike in all directions about that.
    #[inline]
    pub fn diffuse_albedo(&self) -> Rgb {
        match &self.lobes {
            Lobes::Diffuse(lambertian) => lambertian.albedo,
            Lobes::Phong(phong) => phong.diffuse,
            Lobes::One(_) | Lobes::Blend(_) => {
                let among = self.among.and(Classes::DIFFUSE);
                mixture::eval(self.lobes.parts(), among, Vec3::Z, Vec3::Z, Transport::Radiance) * PI
            }
            _ => Rgb::BLACK,
        }
    }

    /// The weight of the Phong lobe: the most it reflects, which it does at normal incidence. Of other lobes that are
    /// brighter about some direction about that.
    #[inline]
    pub fn glossy_albedo(&self) -> Rgb {
        match &self.lobes {
            Lobes::Phong(phong) => phong.specular,
            Lobes::One(_) | Lobes::Blend(_) => {
                let glossy = Classes::SHARP.or(Classes::GLOSSY);
                Rgb::splat(mixture::share(self.lobes.parts(), self.among.and(glossy), Vec3::Z).min(1.0))
            }
            _ => Rgb::BLACK,
        }
    }

    /// What both reflect together, about.
    pub fn albedo(&self) -> Rgb {
        self.diffuse_albedo() + self.glossy_albedo()
    }

    /// The lobes that are much the same in all directions. With [`glossy_part`](Self::glossy_part) they add up to all
    /// that have a density.
    pub fn diffuse_part(&self) -> Self {
        self.of(Classes::DIFFUSE)
    }

    /// The lobes with a density that are brighter about some direction.
    pub fn glossy_part(&self) -> Self {
        self.of(Classes::SHARP.or(Classes::GLOSSY))
    }

    /// The cosine to the shading normal that [`eval`](Self::eval) leaves out.
    #[inline]
    pub fn cosine(&self, w: Vec3) -> f32 {
        w.dot(self.frame.n).abs()
    }

    /// f(wo, wi) in 1/sr, without a cosine and without Dirac lobes, for radiance that comes from `wi` and is seen from
    /// `wo`. It is symmetric but for refraction, of which f(wo, wi) η_i² is, η_i the index on the side of `wi`.
    #[inline]
    pub fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
        match &self.lobes {
            Lobes::Diffuse(lambertian) if self.both_above(wo, wi) => lambertian.eval(),
            Lobes::Phong(phong) if self.both_above(wo, wi) => phong.eval(self.frame.n, wo, wi),
            Lobes::One(_) | Lobes::Blend(_) => self.eval_mixture(wo, wi, Transport::Radiance),
            _ => Rgb::BLACK,
        }
    }

    /// The same for power that comes from `wo` and leaves along `wi`: f(wi, wo). A connection of a photon's path
    /// multiplies it by [`adjoint_factor`](Self::adjoint_factor).
    #[inline]
    pub fn eval_flux(&self, wo: Vec3, wi: Vec3) -> Rgb {
        match &self.lobes {
            Lobes::One(_) | Lobes::Blend(_) => self.eval_mixture(wo, wi, Transport::Flux),
            _ => self.eval(wo, wi),
        }
    }

    fn eval_mixture(&self, wo: Vec3, wi: Vec3, transport: Transport) -> Rgb {
        match (self.local(wo), self.local(wi)) {
            (Some(o), Some(i)) => {
                mixture::eval(self.lobes.parts(), self.among.and(Classes::DENSE), o, i, transport)
            }
            _ => Rgb::BLACK,
        }
    }

    /// A direction in the shading frame; `None` between the two tangent planes.
    #[inline]
    fn local(&self, w: Vec3) -> Option<Vec3> {
        let local = self.frame.to_local(w);
        (local.z * w.dot(self.ng) > 0.0).then_some(local)
    }

    /// The density per solid angle with which [`sample`](Self::sample) returns `wi`, without Dirac
    /// lobes. Its integral falls short of one by the chance that `sample` returns nothing.
    #[inline]
    pub fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        match &self.lobes {
            Lobes::Diffuse(_) if self.both_above(wo, wi) => Lambertian::pdf(self.frame.n, wi),
            Lobes::Phong(phong) if self.both_above(wo, wi) => phong.pdf(self.frame.n, wo, wi),
            Lobes::One(_) | Lobes::Blend(_) => self.pdf_of_mixture(wo, wi),
            _ => 0.0,
        }
    }

    fn pdf_of_mixture(&self, wo: Vec3, wi: Vec3) -> f32 {
        let (Some(o), Some(i)) = (self.local(wo), self.local(wi)) else { return 0.0 };
        let parts = self.lobes.parts();
        Chances::new(parts, self.among, o).map_or(0.0, |chances| {
            chances.pdf(parts, Classes::of(LobeKind::Sharp), o, i)
                + chances.pdf(parts, Classes::of(LobeKind::Broad), o, i)
        })
    }

    /// Draws a direction from uniform numbers in [0, 1), `u_lobe` choosing between lobes. `None` where
    /// the walk ends: the surface is black or the direction drawn is on the wrong side.
    #[inline]
    pub fn sample(&self, wo: Vec3, u: Vec2, u_lobe: f32, transport: Transport) -> Option<BsdfSample> {
        let wi = match &self.lobes {
            Lobes::Diffuse(lambertian) => return self.sample_diffuse(lambertian, wo, u, transport),
            Lobes::Phong(phong) => phong.sample(&self.frame, wo, u, u_lobe),
            Lobes::One(_) | Lobes::Blend(_) => return self.sample_mixture(wo, u, u_lobe, transport),
            _ => return self.sample_dirac(wo, u_lobe, transport),
        };
        let wi = wi.normalize();
        let pdf_solid_angle = self.pdf(wo, wi);
        if pdf_solid_angle > 0.0 {
            let weight = self.eval(wo, wi) * (self.cosine(wi) / pdf_solid_angle);
            let weight = weight * self.carried(wo, wi, transport);
            let (lobe, transmitted) = (LobeKind::Broad, false);
            Some(BsdfSample { wi, weight, radiance_scale: 1.0, pdf_solid_angle, lobe, transmitted })
        } else {
            None
        }
    }

    /// The cosine and the density cancel to the albedo.
    #[inline]
    fn sample_diffuse(
        &self,
        lambertian: &Lambertian,
        wo: Vec3,
        u: Vec2,
        transport: Transport,
    ) -> Option<BsdfSample> {
        let wi = Lambertian::sample(&self.frame, u).normalize();
        let pdf_solid_angle = Lambertian::pdf(self.frame.n, wi);
        if pdf_solid_angle == 0.0 || !self.both_above(wo, wi) {
            return None;
        }
        let weight = lambertian.albedo * self.carried(wo, wi, transport);
        let (lobe, transmitted) = (LobeKind::Broad, false);
        Some(BsdfSample { wi, weight, radiance_scale: 1.0, pdf_solid_angle, lobe, transmitted })
    }

    /// A class is chosen first, in proportion to what it scatters, and then a direction by that class alone: its f·cos
    /// over its own density is the weight.
    fn sample_mixture(&self, wo: Vec3, u: Vec2, u_lobe: f32, transport: Transport) -> Option<BsdfSample> {
        let parts = self.lobes.parts();
        let Some(o) = self.local(wo) else {
            // Only what goes straight on is there.
            return self.sample_dirac(wo, u_lobe, transport);
        };
        let chances = Chances::new(parts, self.among, o)?;
        let drawn = chances.draw(u_lobe);
        if drawn.class == Classes::DIRAC {
            let chance = chances.of_classes(Classes::DIRAC);
            let sample = self.sample_dirac(wo, drawn.u_lobe, transport)?;
            return Some(BsdfSample { weight: sample.weight / chance, ..sample });
        }
        let wi = self.frame.to_world(drawn.sample(parts, o, u)?).normalize();
        let i = self.local(wi)?;
        let lobe = drawn.class.kind();
        let [sharp, broad] =
            [LobeKind::Sharp, LobeKind::Broad].map(|kind| chances.pdf(parts, Classes::of(kind), o, i));
        let own = if lobe == LobeKind::Sharp { sharp } else { broad };
        let f = mixture::eval(parts, self.among.and(Classes::of(lobe)), o, i, transport);
        if !(own > 0.0 && own.is_finite()) || f.is_black() {
            return None;
        }
        let weight = f * (self.cosine(wi) / own * self.carried(wo, wi, transport));
        let radiance_scale = match transport {
            Transport::Radiance => drawn.radiance_scale(parts, o, i),
            Transport::Flux => 1.0,
        };
        let transmitted = o.z * i.z < 0.0;
        Some(BsdfSample { wi, weight, radiance_scale, pdf_solid_angle: sharp + broad, lobe, transmitted })
    }

    /// The Dirac lobes, reflection first and then transmission, each with its full weight: following
    /// both is what [`sample`](Self::sample) does on average.
    pub fn dirac_lobes(&self, wo: Vec3, transport: Transport) -> [Option<BsdfSample>; 2] {
        match self.split(wo) {
            None => [None, None],
            Some(split) => [self.reflection(wo, &split, transport), self.transmission(wo, &split, transport)],
        }
    }

    /// What makes power of radiance's rule where shading normals differ from geometric ones:
    /// |wo·ns| |wi·ng| / (|wo·ng| |wi·ns|), `wo` towards the light and `wi` along the photon's way.
    ///
    /// Radiance gathers f |wi·ns| of what arrives per solid angle, that is the true BSDF
    /// f |wi·ns| / |wi·ng| with the true cosine. A photon goes through the same with the directions
    /// exchanged: f |wo·ns| / |wo·ng| · |wi·ng|. The factor is the second over f |wi·ns| (Veach 1997,
    /// eq. 5.19).
    #[inline]
    pub fn adjoint_factor(&self, wo: Vec3, wi: Vec3) -> f32 {
        let Self { ng, frame: Frame { n: ns, .. }, .. } = self;
        if ng == ns {
            return 1.0;
        }
        let over = wo.dot(*ns) * wi.dot(*ng);
        let under = wo.dot(*ng) * wi.dot(*ns);
        normals_ratio(over, under)
    }

    /// What [`eval`](Self::eval) is multiplied by in a density estimate, |wi·ns| / |wi·ng|: photons
    /// on a surface count irradiance by its geometry, and radiance gathers it by the shading normal.
    #[inline]
    pub fn density_factor(&self, wi: Vec3) -> f32 {
        normals_ratio(wi.dot(self.frame.n), wi.dot(self.ng))
    }

    /// Whether both directions are above the surface, by either normal.
    #[inline]
    fn both_above(&self, wo: Vec3, wi: Vec3) -> bool {
        let above = |w: Vec3| w.dot(self.ng) > 0.0 && w.dot(self.frame.n) > 0.0;
        above(wo) && above(wi)
    }

    /// The factor on f cos/pdf that depends on what is carried, refraction's aside.
    #[inline]
    fn carried(&self, wo: Vec3, wi: Vec3, transport: Transport) -> f32 {
        match transport {
            Transport::Radiance => 1.0,
            Transport::Flux => self.adjoint_factor(wo, wi),
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

    fn sample_dirac(&self, wo: Vec3, u_lobe: f32, transport: Transport) -> Option<BsdfSample> {
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

/// |over / under|: exactly one where the normals agree or a line goes straight on, even at grazing
/// incidence, and zero in place of infinity, where every lobe is zero.
#[inline]
fn normals_ratio(over: f32, under: f32) -> f32 {
    if over == under {
        1.0
    } else if under.is_normal() {
        (over / under).abs()
    } else {
        0.0
    }
}
