//! What can be told of a material without looking at a surface.

use super::microfacet::SHARP;
use super::{Material, Roughness};
use crate::color::Rgb;
use crate::handle::{Arena, Handle};
use crate::texture::{Texture, Textures};

impl Material {
    /// Whether either side of a material has a mirror direction or refraction as its own, null ones aside.
    pub(crate) fn has_dirac(materials: &Arena<Self>, material: Handle<Self>) -> bool {
        match &materials[material] {
            Self::Conductor { .. } | Self::Dielectric { .. } | Self::ThinDielectric { .. } => true,
            Self::Plastic { roughness, .. } => roughness.is_none(),
            Self::CoatedConductor { roughness, coat_roughness, .. } => {
                roughness.is_none() || coat_roughness.is_none()
            }
            Self::TwoSided { front, back } => {
                Self::has_dirac(materials, *front) || Self::has_dirac(materials, *back)
            }
            // Beside other materials nothing is a lobe that light goes straight on by.
            Self::Blend { first, second, .. } => [*first, *second]
                .into_iter()
                .any(|part| materials[part] == Self::Null || Self::has_dirac(materials, part)),
            Self::RoughDielectric { int_ior, ext_ior, .. } => int_ior == ext_ior,
            Self::Mask { inside, .. }
            | Self::Dispersive { inside, .. }
            | Self::NormalMap { inside, .. }
            | Self::BumpMap { inside, .. } => Self::has_dirac(materials, *inside),
            Self::Diffuse { .. }
            | Self::Phong { .. }
            | Self::RoughConductor { .. }
            | Self::DiffuseTransmission { .. }
            | Self::Principled(_)
            | Self::MetallicRoughness(_)
            | Self::Null => false,
        }
    }

    /// Whether a material may have lobes that are specular: Diracs and those nearly as narrow, which caustics are made by.
    pub(crate) fn may_be_specular(
        materials: &Arena<Self>,
        material: Handle<Self>,
        textures: &Textures,
    ) -> bool {
        // A texture may be anything somewhere.
        let least = |texture: Handle<Texture>| match textures.list[texture] {
            Texture::Constant(value) => value.mean(),
            _ => 0.0,
        };
        let sharp = |r: &Roughness| least(r.alpha_u) < SHARP && least(r.alpha_v) < SHARP;
        let of_root = |root: Handle<Texture>| least(root) * least(root) < SHARP;
        let is_none = |texture: Handle<Texture>| textures.list[texture] == Texture::Constant(Rgb::BLACK);
        let part = |part: Handle<Self>| Self::may_be_specular(materials, part, textures);
        Self::has_dirac(materials, material)
            || match &materials[material] {
                Self::RoughConductor { roughness, .. } | Self::RoughDielectric { roughness, .. } => {
                    sharp(roughness)
                }
                Self::Plastic { roughness, .. } => roughness.as_ref().is_some_and(sharp),
                Self::CoatedConductor { roughness, coat_roughness, .. } => {
                    [roughness, coat_roughness].into_iter().flatten().any(sharp)
                }
                Self::Principled(p) => of_root(p.roughness) || !is_none(p.clearcoat),
                Self::MetallicRoughness(m) => {
                    of_root(m.roughness) || (!is_none(m.clearcoat) && of_root(m.clearcoat_roughness))
                }
                Self::TwoSided { front: first, back: second } | Self::Blend { first, second, .. } => {
                    part(*first) || part(*second)
                }
                Self::Mask { inside, .. }
                | Self::Dispersive { inside, .. }
                | Self::NormalMap { inside, .. }
                | Self::BumpMap { inside, .. } => part(*inside),
                _ => false,
            }
    }

    /// A material without what changes its normals, or whether or how it is there: what kind of boundary it is.
    pub(crate) fn boundary(materials: &Arena<Self>, material: Handle<Self>) -> Handle<Self> {
        let mut material = material;
        while let Self::Mask { inside, .. }
        | Self::Dispersive { inside, .. }
        | Self::NormalMap { inside, .. }
        | Self::BumpMap { inside, .. } = materials[material]
        {
            material = inside;
        }
        material
    }

    /// Whether a material asks in which directions the texture coordinates of a surface go.
    pub(crate) fn is_oriented(materials: &Arena<Self>, material: Handle<Self>, textures: &Textures) -> bool {
        let differs = |r: &Roughness| r.alpha_u != r.alpha_v;
        let is_none = |texture: Handle<Texture>| textures.list[texture] == Texture::Constant(Rgb::BLACK);
        let part = |part: Handle<Self>| Self::is_oriented(materials, part, textures);
        match &materials[material] {
            Self::NormalMap { .. } | Self::BumpMap { .. } => true,
            Self::RoughConductor { roughness, .. } | Self::RoughDielectric { roughness, .. } => {
                differs(roughness)
            }
            Self::Plastic { roughness, .. } => roughness.as_ref().is_some_and(differs),
            Self::CoatedConductor { roughness, coat_roughness, .. } => {
                [roughness, coat_roughness].into_iter().flatten().any(differs)
            }
            Self::Principled(principled) => !is_none(principled.anisotropic),
            Self::MetallicRoughness(gltf) => !is_none(gltf.anisotropy),
            Self::TwoSided { front: first, back: second } | Self::Blend { first, second, .. } => {
                part(*first) || part(*second)
            }
            Self::Mask { inside, .. } | Self::Dispersive { inside, .. } => part(*inside),
            Self::Diffuse { .. }
            | Self::Phong { .. }
            | Self::Conductor { .. }
            | Self::Dielectric { .. }
            | Self::ThinDielectric { .. }
            | Self::DiffuseTransmission { .. }
            | Self::Null => false,
        }
    }

    /// Whether light may go through, masks aside.
    pub(crate) fn is_clear(&self, materials: &Arena<Self>, textures: &Textures) -> bool {
        let is_nothing = |texture| textures.list[texture] == Texture::Constant(Rgb::BLACK);
        match self {
            Self::Dielectric { .. }
            | Self::ThinDielectric { .. }
            | Self::RoughDielectric { .. }
            | Self::DiffuseTransmission { .. }
            | Self::Null => true,
            Self::Principled(principled) => !is_nothing(principled.spec_trans),
            Self::MetallicRoughness(gltf) => !is_nothing(gltf.transmission),
            Self::Blend { first, second, .. } => {
                materials[*first].is_clear(materials, textures)
                    || materials[*second].is_clear(materials, textures)
            }
            Self::Mask { inside, .. }
            | Self::Dispersive { inside, .. }
            | Self::NormalMap { inside, .. }
            | Self::BumpMap { inside, .. } => materials[*inside].is_clear(materials, textures),
            Self::Diffuse { .. }
            | Self::Phong { .. }
            | Self::Conductor { .. }
            | Self::RoughConductor { .. }
            | Self::Plastic { .. }
            | Self::CoatedConductor { .. }
            | Self::TwoSided { .. } => false,
        }
    }
}
