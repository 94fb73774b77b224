//! Materials: how surfaces scatter light.
//!
//! A [`Material`] is what the scene says; [`Material::at`] reads its textures at a hit and gives a
//! [`Bsdf`], a small value of plain numbers that estimators evaluate as often as they like.

mod bsdf;
mod check;
mod conductor;
mod dielectric;
mod fresnel;
mod lambertian;
mod mask;
mod phong;
mod split;
mod surface;

pub(crate) use bsdf::segments_by;
pub use bsdf::{Bsdf, BsdfSample, Transport};
pub use check::check;
pub use fresnel::{fresnel_conductor, fresnel_dielectric};
pub use surface::Surface;

use self::bsdf::Lobes;
use self::conductor::Conductor;
use self::dielectric::Dielectric;
use self::lambertian::Lambertian;
use self::phong::Phong;
use crate::color::Rgb;
use crate::handle::{Arena, Handle};
use crate::math::Vec3;
use crate::texture::{Texture, Textures};

/// How a surface scatters light, as a scene describes it.
///
/// A material refers only to materials stored before it.
#[derive(Clone, Debug, PartialEq)]
pub enum Material {
    /// The same radiance in every direction (Lambert). One-sided: black from behind.
    Diffuse {
        /// Albedo, in [0, 1].
        reflectance: Handle<Texture>,
    },
    /// Lambert plus a cosⁿ lobe about the mirror direction, the modified model of Lafortune and
    /// Willems (1994), whose lobe carries (n+2)/2π. One-sided.
    Phong {
        /// Albedo of the Lambertian part.
        diffuse_reflectance: Handle<Texture>,
        /// Weight of the lobe.
        specular_reflectance: Handle<Texture>,
        /// The exponent n ≥ 0.
        exponent: f32,
    },
    /// A smooth metal, or a perfect mirror. One-sided.
    Conductor {
        /// The metal.
        metal: Metal,
        /// Multiplies what Fresnel's equations give.
        specular_reflectance: Handle<Texture>,
    },
    /// A smooth boundary of two transparent media, such as glass in air.
    Dielectric {
        /// Index of refraction on the side the normal points away from.
        int_ior: f32,
        /// Index of refraction on the side the normal points to.
        ext_ior: f32,
        /// Multiplies what is reflected.
        specular_reflectance: Handle<Texture>,
        /// Multiplies what is transmitted.
        specular_transmittance: Handle<Texture>,
    },
    /// Two parallel dielectric boundaries so close that light passes straight on, all orders of
    /// reflection between them summed.
    ThinDielectric {
        /// Index of refraction between the boundaries.
        int_ior: f32,
        /// Index of refraction outside.
        ext_ior: f32,
        /// Multiplies what is reflected.
        specular_reflectance: Handle<Texture>,
        /// Multiplies what is transmitted.
        specular_transmittance: Handle<Texture>,
    },
    /// Gives one-sided materials to both sides.
    TwoSided {
        /// On the side the normal points to.
        front: Handle<Material>,
        /// On the other.
        back: Handle<Material>,
    },
    /// A material that is there with a probability, decided for each ray: a leaf cut out of a rectangle,
    /// a veil. It scatters as what is inside, and [`Material::at`] sees nothing else.
    Mask {
        /// The probability, in [0, 1], that a ray meets the surface; else it passes. Colours count by
        /// their luminance.
        opacity: Handle<Texture>,
        /// How the surface scatters where it is there.
        inside: Handle<Material>,
    },
    /// Nothing: light passes as if the surface were not there.
    Null,
}

/// What a smooth conductor reflects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Metal {
    /// Everything, at every angle.
    PerfectMirror,
    /// By Fresnel's equations with the complex index η + ik, per channel.
    Index {
        /// Real part, relative to the outside.
        eta: Rgb,
        /// Imaginary part, relative to the outside.
        k: Rgb,
    },
}

impl Material {
    /// How the material scatters at a point, seen from the side of `wo`: textures are read here and
    /// nowhere else. Values of textures are brought into [0, 1], and Phong's two weights scaled down
    /// where they add up to more than one, so that no image makes a surface reflect more than arrives.
    ///
    /// One-sided materials are black from behind. Two-sided ones turn the surface over, so that `wo` is
    /// always in front of them.
    ///
    /// # Panics
    ///
    /// If a handle is not of these arenas. A two-sided material that contains itself never returns.
    /// [`check()`] finds both.
    pub fn at(
        materials: &Arena<Self>,
        material: Handle<Self>,
        textures: &Textures,
        surface: &Surface,
        wo: Vec3,
    ) -> Bsdf {
        let mut surface = *surface;
        let mut side = Self::unmasked(materials, material);
        while let Self::TwoSided { front, back } = materials[side] {
            if wo.dot(surface.ng) < 0.0 {
                surface = surface.flipped();
                side = back;
            } else {
                side = front;
            }
        }
        let lobes = materials[side].lobes(textures, &surface, wo.dot(surface.ng) > 0.0);
        Bsdf::new(surface.ng, surface.frame, lobes)
    }

    /// The lobes seen from the side the normal points to, or from the other one.
    fn lobes(&self, textures: &Textures, surface: &Surface, in_front: bool) -> Lobes {
        let read = |texture: Handle<Texture>| {
            textures.eval(texture, surface.at).map(|v| if v > 0.0 { v.min(1.0) } else { 0.0 })
        };
        match *self {
            Self::Null => Lobes::Null,
            Self::Dielectric { int_ior, ext_ior, specular_reflectance, specular_transmittance }
            | Self::ThinDielectric { int_ior, ext_ior, specular_reflectance, specular_transmittance } => {
                let dielectric = Dielectric {
                    eta: int_ior / ext_ior,
                    reflectance: read(specular_reflectance),
                    transmittance: read(specular_transmittance),
                };
                if (dielectric.reflectance + dielectric.transmittance).is_black() {
                    Lobes::Black
                } else if matches!(self, Self::Dielectric { .. }) {
                    Lobes::Dielectric(dielectric)
                } else {
                    Lobes::ThinDielectric(dielectric)
                }
            }
            Self::Diffuse { reflectance } if in_front => {
                let albedo = read(reflectance);
                if albedo.is_black() { Lobes::Black } else { Lobes::Diffuse(Lambertian { albedo }) }
            }
            Self::Phong { diffuse_reflectance, specular_reflectance, exponent } if in_front => {
                let (diffuse, specular) = (read(diffuse_reflectance), read(specular_reflectance));
                if (diffuse + specular).is_black() {
                    return Lobes::Black;
                }
                let scale = (diffuse + specular).map(|sum| 1.0 / sum.max(1.0));
                Lobes::Phong(Phong { diffuse: diffuse * scale, specular: specular * scale, exponent })
            }
            Self::Conductor { metal, specular_reflectance } if in_front => {
                let reflectance = read(specular_reflectance);
                if reflectance.is_black() {
                    Lobes::Black
                } else {
                    Lobes::Conductor(Conductor { metal, reflectance })
                }
            }
            Self::Diffuse { .. }
            | Self::Phong { .. }
            | Self::Conductor { .. }
            | Self::TwoSided { .. }
            | Self::Mask { .. } => Lobes::Black,
        }
    }
}
