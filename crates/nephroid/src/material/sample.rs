//! Directions drawn from a BSDF.

use super::bsdf::{Bsdf, Lobes, Transport};
use super::kind::{Classes, LobeKind};
use super::lambertian::Lambertian;
use super::mixture::{self, Chances};
use crate::color::Rgb;
use crate::math::{Vec2, Vec3};

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

impl Bsdf {
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
}
