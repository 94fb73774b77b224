use crate::color::Rgb;
use crate::math::Vec3;

/// How a surface with Dirac lobes divides light between mirror direction and refraction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Split {
    /// Share of the power reflected.
    pub reflectance: Rgb,
    /// Where the rest goes, if anywhere.
    pub refraction: Option<Refraction>,
    /// The share of samples that are reflected.
    pub reflect_probability: f32,
}

/// The transmitted part of a [`Split`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refraction {
    /// Unit direction leaving the surface on the far side.
    pub wi: Vec3,
    /// Share of the power transmitted.
    pub transmittance: Rgb,
    /// What radiance is multiplied with besides: (η_o/η_i)², the squared ratio of the indices on the
    /// sides of `wo` and `wi` (Veach 1997, §5.2). Power is not.
    pub radiance_scale: f32,
}

impl Split {
    /// A mirror.
    pub fn mirror(reflectance: Rgb) -> Self {
        Self { reflectance, refraction: None, reflect_probability: 1.0 }
    }

    /// Everything passes straight on.
    pub fn pass(wo: Vec3, transmittance: Rgb) -> Self {
        let refraction = Some(Refraction { wi: -wo, transmittance, radiance_scale: 1.0 });
        Self { reflectance: Rgb::BLACK, refraction, reflect_probability: 0.0 }
    }
}
