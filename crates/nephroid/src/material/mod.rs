//! Materials: how surfaces scatter light.
//!
//! A [`Material`] is what the scene says; [`Material::at`] reads its textures at a hit and gives a
//! [`Bsdf`], a small value of plain numbers that estimators evaluate as often as they like.

use crate::handle::Handle;
use crate::texture::Texture;

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
        eta: crate::color::Rgb,
        /// Imaginary part, relative to the outside.
        k: crate::color::Rgb,
    },
}
