use super::bsdf::Transport;
use super::coated_conductor::CoatedConductor;
use super::conductor::Conductor;
use super::dielectric::Dielectric;
use super::diffuse_transmission::DiffuseTransmission;
use super::disney::Disney;
use super::gltf::Gltf;
use super::kind::Classes;
use super::lambertian::Lambertian;
use super::mixture::{MOST, Scatter};
use super::phong::Phong;
use super::plastic::Plastic;
use super::rough_conductor::RoughConductor;
use super::rough_dielectric::RoughDielectric;
use super::simple::{Clear, Pass, Thin};
use super::split::Split;
use crate::color::Rgb;
use crate::math::{Vec2, Vec3};

/// A material that is no mixture of others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Part {
    Diffuse(Lambertian),
    Phong(Phong),
    Conductor(Conductor),
    Dielectric(Clear),
    ThinDielectric(Thin),
    Null(Pass),
    RoughConductor(RoughConductor),
    RoughDielectric(RoughDielectric),
    Plastic(Plastic),
    CoatedConductor(CoatedConductor),
    DiffuseTransmission(DiffuseTransmission),
    Principled(Disney),
    MetallicRoughness(Gltf),
}

/// Calls a method of whatever a part is.
macro_rules! each {
    ($part:expr, $own:ident => $call:expr) => {
        match $part {
            Part::Diffuse($own) => $call,
            Part::Phong($own) => $call,
            Part::Conductor($own) => $call,
            Part::Dielectric($own) => $call,
            Part::ThinDielectric($own) => $call,
            Part::Null($own) => $call,
            Part::RoughConductor($own) => $call,
            Part::RoughDielectric($own) => $call,
            Part::Plastic($own) => $call,
            Part::CoatedConductor($own) => $call,
            Part::DiffuseTransmission($own) => $call,
            Part::Principled($own) => $call,
            Part::MetallicRoughness($own) => $call,
        }
    };
}

impl Part {
    /// The same with another index inside relative to outside, if it is the boundary of two dielectrics.
    pub fn with_eta(self, eta: f32) -> Self {
        match self {
            Self::Dielectric(Clear(own)) => Self::Dielectric(Clear(Dielectric { eta, ..own })),
            Self::RoughDielectric(own) if eta == 1.0 => Self::Dielectric(Clear(Dielectric {
                eta,
                reflectance: own.reflectance,
                transmittance: own.transmittance,
            })),
            Self::RoughDielectric(own) => Self::RoughDielectric(RoughDielectric { eta, ..own }),
            Self::MetallicRoughness(own) => Self::MetallicRoughness(own.with_eta(eta)),
            _ => self,
        }
    }

    /// Whether it is rough, and bends light by its index.
    pub fn is_rough_lens(&self) -> bool {
        match self {
            Self::RoughDielectric(_) => true,
            Self::MetallicRoughness(own) => own.refracts(),
            _ => false,
        }
    }
}

impl Scatter for Part {
    fn classes(&self) -> [Classes; MOST] {
        each!(self, own => Scatter::classes(own))
    }

    fn shares(&self, wo: Vec3) -> [f32; MOST] {
        each!(self, own => Scatter::shares(own, wo))
    }

    fn eval(&self, among: Classes, wo: Vec3, wi: Vec3, transport: Transport) -> Rgb {
        each!(self, own => Scatter::eval(own, among, wo, wi, transport))
    }

    fn pdf(&self, lobe: usize, wo: Vec3, wi: Vec3) -> f32 {
        each!(self, own => Scatter::pdf(own, lobe, wo, wi))
    }

    fn sample(&self, lobe: usize, wo: Vec3, u: Vec2, u_lobe: f32) -> Option<Vec3> {
        each!(self, own => Scatter::sample(own, lobe, wo, u, u_lobe))
    }

    fn radiance_scale(&self, lobe: usize, wo: Vec3, wi: Vec3) -> f32 {
        each!(self, own => Scatter::radiance_scale(own, lobe, wo, wi))
    }

    fn transmits(&self) -> bool {
        each!(self, own => Scatter::transmits(own))
    }

    fn split(&self, wo: Vec3) -> Option<Split> {
        each!(self, own => Scatter::split(own, wo))
    }
}
