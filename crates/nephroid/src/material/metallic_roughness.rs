//! The parameters of a glTF material.

use crate::color::Rgb;
use crate::handle::Handle;
use crate::texture::{Texture, Textures};

/// The metallic-roughness material of glTF 2.0 (specification, appendix B) with its extensions `KHR_materials_ior`,
/// `_specular`, `_clearcoat`, `_transmission`, `_volume` (the boundary of it), `_sheen` and `_anisotropy`. Factors are
/// multiplied into the textures. One-sided but for what light goes through.
///
/// Where nothing else is said textures are scalars in [0, 1], which count by the mean of their channels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MetallicRoughness {
    /// Albedo of what is no metal, what metal reflects at normal incidence, and the tint of what goes through.
    pub base_color: Handle<Texture>,
    /// The part that is metal.
    pub metallic: Handle<Texture>,
    /// The root of α.
    pub roughness: Handle<Texture>,
    /// Index of refraction inside relative to outside, at least 1; 0 stands for a boundary that reflects all.
    pub ior: f32,
    /// Strength of the reflection of what is no metal.
    pub specular: Handle<Texture>,
    /// Its colour at normal incidence, a factor on what the index gives. It may be above one.
    pub specular_color: Handle<Texture>,
    /// Strength of a coat of clear varnish.
    pub clearcoat: Handle<Texture>,
    /// The root of the α of the coat.
    pub clearcoat_roughness: Handle<Texture>,
    /// The part of what is no metal that light goes through.
    pub transmission: Handle<Texture>,
    /// Whether light goes through as through a thin sheet, straight on but for roughness: a mesh without a volume.
    /// Else it is refracted into what is inside.
    pub thin: bool,
    /// Colour of the sheen of cloth.
    pub sheen_color: Handle<Texture>,
    /// The root of the α of the sheen.
    pub sheen_roughness: Handle<Texture>,
    /// Strength of anisotropy: α along its direction is raised towards one by the square of it.
    pub anisotropy: Handle<Texture>,
    /// The angle from the first tangent to the direction along which highlights are long, counter-clockwise, in radians.
    pub anisotropy_rotation: f32,
    /// A direction in red and green, of which 0 stands for −1, that the rotation turns; the first tangent if `None`.
    pub anisotropy_direction: Option<Handle<Texture>>,
}

impl MetallicRoughness {
    /// What an empty glTF material is, but no metal: white, of roughness 1 and index 1.5.
    pub fn plain(textures: &mut Textures) -> Self {
        let none = textures.constant(Rgb::BLACK);
        let all = textures.constant(Rgb::WHITE);
        Self {
            base_color: all,
            metallic: none,
            roughness: all,
            ior: 1.5,
            specular: all,
            specular_color: all,
            clearcoat: none,
            clearcoat_roughness: none,
            transmission: none,
            thin: true,
            sheen_color: none,
            sheen_roughness: none,
            anisotropy: none,
            anisotropy_rotation: 0.0,
            anisotropy_direction: None,
        }
    }

    /// The textures whose values are in [0, 1], with their names, but for the base's colour.
    pub(super) fn bounded(&self) -> [(&'static str, Handle<Texture>); 9] {
        [
            ("metallic", self.metallic),
            ("roughness", self.roughness),
            ("specular", self.specular),
            ("clearcoat", self.clearcoat),
            ("clearcoat_roughness", self.clearcoat_roughness),
            ("transmission", self.transmission),
            ("sheen_color", self.sheen_color),
            ("sheen_roughness", self.sheen_roughness),
            ("anisotropy", self.anisotropy),
        ]
    }
}
