use std::f32::consts::PI;

use super::conductor::Conductor;
use super::dielectric::Dielectric;
use super::kind::{Classes, LobeKind};
use super::lambertian::Lambertian;
use super::mixture::{self, Blend, Chances, Weighed};
use super::phong::Phong;
use crate::color::Rgb;
use crate::math::{Frame, Vec3};

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
    pub(super) ng: Vec3,
    pub(super) frame: Frame,
    pub(super) lobes: Lobes,
    disperses: bool,
    /// Those classes of a mixture's lobes that count.
    pub(super) among: Classes,
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
    pub fn parts(&self) -> &[Weighed] {
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
    pub(super) fn local(&self, w: Vec3) -> Option<Vec3> {
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
    pub(super) fn both_above(&self, wo: Vec3, wi: Vec3) -> bool {
        let above = |w: Vec3| w.dot(self.ng) > 0.0 && w.dot(self.frame.n) > 0.0;
        above(wo) && above(wi)
    }

    /// The factor on f cos/pdf that depends on what is carried, refraction's aside.
    #[inline]
    pub(super) fn carried(&self, wo: Vec3, wi: Vec3, transport: Transport) -> f32 {
        match transport {
            Transport::Radiance => 1.0,
            Transport::Flux => self.adjoint_factor(wo, wi),
        }
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
