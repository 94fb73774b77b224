//! Materials: how surfaces scatter light.
//!
//! A [`Material`] is what the scene says; [`Material::at`] reads its textures at a hit and gives a
//! [`Bsdf`], a small value of plain numbers that estimators evaluate as often as they like.

mod albedo;
mod albedo_tables;
mod at;
mod bsdf;
mod charlie;
mod check;
mod coated_conductor;
mod conductor;
mod dielectric;
mod diffuse_transmission;
mod dirac;
mod disney;
mod disney_diffuse;
mod dispersion;
mod fresnel;
mod gltf;
mod kind;
mod lambertian;
mod mask;
mod metallic_roughness;
mod microfacet;
mod mixture;
mod nature;
mod part;
mod phong;
mod plastic;
mod plastic_coat;
mod plastic_tables;
mod principled;
mod rough_conductor;
mod rough_dielectric;
mod roughness;
mod sample;
mod simple;
mod split;
mod surface;
mod tilt;
#[cfg(test)]
mod tilt_tests;

pub(crate) use bsdf::segments_by;
pub use bsdf::{Bsdf, Transport};
pub use check::check;
pub use dispersion::Dispersion;
pub use fresnel::{fresnel_conductor, fresnel_dielectric};
pub use kind::LobeKind;
pub use metallic_roughness::MetallicRoughness;
pub use principled::Principled;
pub use roughness::{Distribution, Roughness};
pub use sample::BsdfSample;
pub use surface::Surface;

use crate::color::Rgb;
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
    /// A material that is there with a probability, decided for each ray: a leaf cut out of a rectangle,
    /// a veil. It scatters as what is inside, and [`Material::at`] sees nothing else.
    Mask {
        /// The probability, in [0, 1], that a ray meets the surface; else it passes. Colours count by
        /// their luminance.
        opacity: Handle<Texture>,
        /// How the surface scatters where it is there.
        inside: Handle<Material>,
    },
    /// Glass that takes light apart: its index of refraction is the [`Dispersion`]'s, for paths of one wavelength; where there is
    /// none yet, and for whoever asks for the index, it is as it says.
    Dispersive {
        /// The index of refraction on the side the normal points away from.
        dispersion: Dispersion,
        /// A smooth or rough dielectric, or a metallic-roughness material that is not thin.
        inside: Handle<Material>,
    },
    /// A metal with a rough surface. One-sided.
    RoughConductor {
        /// The metal.
        metal: Metal,
        /// Multiplies what Fresnel's equations give.
        specular_reflectance: Handle<Texture>,
        /// How rough it is.
        roughness: Roughness,
    },
    /// A rough boundary of two transparent media, such as frosted glass (Walter et al. 2007).
    RoughDielectric {
        /// Index of refraction on the side the normal points away from.
        int_ior: f32,
        /// Index of refraction on the side the normal points to.
        ext_ior: f32,
        /// Multiplies what is reflected.
        specular_reflectance: Handle<Texture>,
        /// Multiplies what is transmitted.
        specular_transmittance: Handle<Texture>,
        /// How rough it is.
        roughness: Roughness,
    },
    /// A diffuse base under a dielectric coat, with all that is reflected between them. One-sided.
    Plastic {
        /// Index of refraction of the coat.
        int_ior: f32,
        /// Index of refraction outside.
        ext_ior: f32,
        /// Albedo of the base.
        diffuse_reflectance: Handle<Texture>,
        /// Multiplies what the coat reflects outside.
        specular_reflectance: Handle<Texture>,
        /// Whether light that is reflected several times below the coat takes on the base's colour each time.
        nonlinear: bool,
        /// How rough the coat is; smooth if `None`.
        roughness: Option<Roughness>,
    },
    /// A metal under a dielectric coat that absorbs nothing. One-sided.
    CoatedConductor {
        /// The metal, relative to what is outside of the coat.
        metal: Metal,
        /// Multiplies what Fresnel's equations give for the metal.
        specular_reflectance: Handle<Texture>,
        /// How rough the metal is; smooth if `None`.
        roughness: Option<Roughness>,
        /// Index of refraction of the coat relative to what is outside.
        coat_ior: f32,
        /// How rough the coat is; smooth if `None`.
        coat_roughness: Option<Roughness>,
    },
    /// Lambert on both sides, and light goes through and is spread there as well: paper, leaves.
    DiffuseTransmission {
        /// Albedo for what stays on its side.
        reflectance: Handle<Texture>,
        /// The share that goes through.
        transmittance: Handle<Texture>,
    },
    /// Disney's material. One-sided but for what light goes through.
    Principled(Box<Principled>),
    /// The material of glTF 2.0. One-sided but for what light goes through.
    MetallicRoughness(Box<MetallicRoughness>),
    /// A mixture of two materials.
    Blend {
        /// The part of the second, in [0, 1]: the mean of the channels.
        weight: Handle<Texture>,
        /// The first.
        first: Handle<Material>,
        /// The second.
        second: Handle<Material>,
    },
    /// A material whose normal an image tilts.
    NormalMap {
        /// The normal in the shading frame: colours in [0, 1] stand for coordinates in [−1, 1]. Raw, not sRGB.
        normals: Handle<Texture>,
        /// Multiplies the first two coordinates.
        scale: f32,
        /// Whether the second coordinate goes towards smaller `v` also where texture coordinates are mirrored, as in
        /// glTF. Else it is square to the first and counter-clockwise of it, as in Mitsuba and pbrt.
        against_v: bool,
        /// The material.
        inside: Handle<Material>,
    },
    /// A material whose normal is that of the surface raised by heights.
    BumpMap {
        /// Heights, in units of length.
        heights: Handle<Texture>,
        /// Multiplies them.
        scale: f32,
        /// The material.
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
