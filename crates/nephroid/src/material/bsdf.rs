use super::conductor::Conductor;
use super::dielectric::Dielectric;
use super::fresnel::mirror;
use super::kind::LobeKind;
use super::lambertian::Lambertian;
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
    /// The density of `wi` per solid angle; 0 for a Dirac lobe, which has none.
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
}

/// The kinds of scattering; one file each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Lobes {
    Black,
    Null,
    Diffuse(Lambertian),
    Phong(Phong),
    Conductor(Conductor),
    Dielectric(Dielectric),
    ThinDielectric(Dielectric),
}

impl Bsdf {
    pub(super) fn new(ng: Vec3, frame: Frame, lobes: Lobes) -> Self {
        Self { ng, frame, lobes, disperses: false }
    }

    /// The same place with no surface.
    pub(crate) fn nulled(self) -> Self {
        Self { lobes: Lobes::Null, ..self }
    }

    /// The same, the boundary of two dielectrics with another index of refraction on the inner side relative to the
    /// outer one.
    pub(crate) fn with_eta(self, eta: f32) -> Self {
        match self.lobes {
            Lobes::Dielectric(own) => Self { lobes: Lobes::Dielectric(Dielectric { eta, ..own }), ..self },
            _ => self,
        }
    }

    /// The same, the boundary of a glass that takes light apart, met by a path of all wavelengths.
    pub(crate) fn dispersing(self) -> Self {
        Self { disperses: matches!(self.lobes, Lobes::Dielectric(_)), ..self }
    }

    /// Whether other wavelengths are refracted another way, so that a path must be of a single one.
    #[inline]
    pub(crate) fn disperses(&self) -> bool {
        self.disperses
    }

    /// Whether all scattering is in Dirac lobes, so that there is no density to estimate here.
    #[inline]
    pub fn is_dirac(&self) -> bool {
        !matches!(self.lobes, Lobes::Black | Lobes::Diffuse(_) | Lobes::Phong(_))
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
        match kind {
            LobeKind::Dirac => self.is_dirac(),
            LobeKind::Sharp => false,
            LobeKind::Broad => !self.is_dirac() && !self.is_black(),
        }
    }

    /// The lobes of one class alone. The three parts add up to the whole.
    pub fn part(&self, kind: LobeKind) -> Self {
        if self.has(kind) { *self } else { Self { lobes: Lobes::Black, ..*self } }
    }

    /// All lobes but the broad ones.
    pub fn without_broad(&self) -> Self {
        if self.has(LobeKind::Broad) { Self { lobes: Lobes::Black, ..*self } } else { *self }
    }

    /// Whether there are lobes that are too narrow for a density to be estimated from photons.
    #[inline]
    pub fn has_specular(&self) -> bool {
        self.has(LobeKind::Dirac) || self.has(LobeKind::Sharp)
    }

    /// Whether [`eval`](Self::eval) may be above zero for directions on opposite sides.
    #[inline]
    pub fn transmits(&self) -> bool {
        false
    }

    /// Whether there is a Phong lobe of a weight above zero.
    #[inline]
    pub fn has_glossy_lobe(&self) -> bool {
        !self.glossy_albedo().is_black()
    }

    /// The albedo of the Lambertian lobe.
    #[inline]
    pub fn diffuse_albedo(&self) -> Rgb {
        match &self.lobes {
            Lobes::Diffuse(lambertian) => lambertian.albedo,
            Lobes::Phong(phong) => phong.diffuse,
            _ => Rgb::BLACK,
        }
    }

    /// The weight of the Phong lobe: the most it reflects, which it does at normal incidence.
    #[inline]
    pub fn glossy_albedo(&self) -> Rgb {
        if let Lobes::Phong(phong) = &self.lobes { phong.specular } else { Rgb::BLACK }
    }

    /// The Lambertian lobe alone. With [`glossy_part`](Self::glossy_part) it adds up to the whole.
    pub fn diffuse_part(&self) -> Self {
        let albedo = self.diffuse_albedo();
        let lobes = if albedo.is_black() { Lobes::Black } else { Lobes::Diffuse(Lambertian { albedo }) };
        Self { lobes, ..*self }
    }

    /// The Phong lobe alone.
    pub fn glossy_part(&self) -> Self {
        let lobes = match self.lobes {
            Lobes::Phong(phong) if !phong.specular.is_black() => {
                Lobes::Phong(Phong { diffuse: Rgb::BLACK, ..phong })
            }
            _ => Lobes::Black,
        };
        Self { lobes, ..*self }
    }

    /// The cosine to the shading normal that [`eval`](Self::eval) leaves out.
    #[inline]
    pub fn cosine(&self, w: Vec3) -> f32 {
        w.dot(self.frame.n).abs()
    }

    /// f(wo, wi) in 1/sr, without a cosine and without Dirac lobes. It is symmetric, whatever is
    /// carried; a connection of a photon's path multiplies it by
    /// [`adjoint_factor`](Self::adjoint_factor).
    #[inline]
    pub fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
        match &self.lobes {
            Lobes::Diffuse(lambertian) if self.both_above(wo, wi) => lambertian.eval(),
            Lobes::Phong(phong) if self.both_above(wo, wi) => phong.eval(self.frame.n, wo, wi),
            _ => Rgb::BLACK,
        }
    }

    /// The density per solid angle with which [`sample`](Self::sample) returns `wi`, without Dirac
    /// lobes. Its integral falls short of one by the chance that `sample` returns nothing.
    #[inline]
    pub fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        match &self.lobes {
            Lobes::Diffuse(_) if self.both_above(wo, wi) => Lambertian::pdf(self.frame.n, wi),
            Lobes::Phong(phong) if self.both_above(wo, wi) => phong.pdf(self.frame.n, wo, wi),
            _ => 0.0,
        }
    }

    /// Draws a direction from uniform numbers in [0, 1), `u_lobe` choosing between lobes. `None` where
    /// the walk ends: the surface is black or the direction drawn is on the wrong side.
    #[inline]
    pub fn sample(&self, wo: Vec3, u: Vec2, u_lobe: f32, transport: Transport) -> Option<BsdfSample> {
        let wi = match &self.lobes {
            Lobes::Diffuse(lambertian) => return self.sample_diffuse(lambertian, wo, u, transport),
            Lobes::Phong(phong) => phong.sample(&self.frame, wo, u, u_lobe),
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
            _ => None,
        }
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
