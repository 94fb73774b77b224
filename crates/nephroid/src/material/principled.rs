//! The parameters of a principled material.

use crate::color::Rgb;
use crate::handle::Handle;
use crate::texture::{Texture, Textures};

/// The parameters of Disney's material (Burley 2012, *Physically Based Shading at Disney*; Burley 2015, *Extending the
/// Disney BRDF to a BSDF with Integrated Subsurface Scattering*), by the names and with the meanings that Mitsuba 3's
/// `principled` gives them.
///
/// All textures but the first are scalars in [0, 1], which count by the mean of their channels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Principled {
    /// Albedo of the diffuse part, and of the metal at normal incidence.
    pub base_color: Handle<Texture>,
    /// The root of the α of the main lobe.
    pub roughness: Handle<Texture>,
    /// How much longer highlights are along the first tangent than across.
    pub anisotropic: Handle<Texture>,
    /// The part that is metal.
    pub metallic: Handle<Texture>,
    /// The part of what is no metal that light goes through.
    pub spec_trans: Handle<Texture>,
    /// Index of refraction inside relative to outside, at least 1.
    pub eta: f32,
    /// How much of the base's hue the reflection of what is no metal has.
    pub spec_tint: Handle<Texture>,
    /// Strength of the sheen of cloth at grazing incidence.
    pub sheen: Handle<Texture>,
    /// How much of the base's hue the sheen has.
    pub sheen_tint: Handle<Texture>,
    /// The part of the diffuse lobe that is as flat as that of light scattered below the surface.
    pub flatness: Handle<Texture>,
    /// Strength of a second, colourless lobe on top.
    pub clearcoat: Handle<Texture>,
    /// How sharp that lobe is.
    pub clearcoat_gloss: Handle<Texture>,
}

impl Principled {
    /// A grey of 0.5 and a roughness of 0.5, an index of 1.5, and nothing else.
    pub fn plain(textures: &mut Textures) -> Self {
        let none = textures.constant(Rgb::BLACK);
        let half = textures.constant(Rgb::splat(0.5));
        Self {
            base_color: half,
            roughness: half,
            anisotropic: none,
            metallic: none,
            spec_trans: none,
            eta: 1.5,
            spec_tint: none,
            sheen: none,
            sheen_tint: none,
            flatness: none,
            clearcoat: none,
            clearcoat_gloss: none,
        }
    }

    /// The textures that are scalars, with their names.
    pub(super) fn scalars(&self) -> [(&'static str, Handle<Texture>); 10] {
        [
            ("roughness", self.roughness),
            ("anisotropic", self.anisotropic),
            ("metallic", self.metallic),
            ("spec_trans", self.spec_trans),
            ("spec_tint", self.spec_tint),
            ("sheen", self.sheen),
            ("sheen_tint", self.sheen_tint),
            ("flatness", self.flatness),
            ("clearcoat", self.clearcoat),
            ("clearcoat_gloss", self.clearcoat_gloss),
        ]
    }
}
