use super::Material;
use crate::color::Rgb;
use crate::handle::{Arena, Handle};
use crate::texture::{TexturePoint, Textures};

impl Material {
    /// The material inside all masks, and of dispersive glass the glass.
    pub fn unmasked(materials: &Arena<Self>, material: Handle<Self>) -> Handle<Self> {
        let mut material = material;
        while let Self::Mask { inside, .. } | Self::Dispersive { inside, .. } = materials[material] {
            material = inside;
        }
        material
    }

    /// Whether the surface is there by chance.
    pub fn is_masked(materials: &Arena<Self>, material: Handle<Self>) -> bool {
        matches!(materials[material], Self::Mask { .. })
    }

    /// The probability, in [0, 1], that the surface is there at a point: the product over its masks, and 1
    /// without any. Colours count by their luminance, grey by its value to the bit.
    pub fn opacity(
        materials: &Arena<Self>,
        material: Handle<Self>,
        textures: &Textures,
        at: impl Into<TexturePoint>,
    ) -> f32 {
        let at = at.into();
        let mut product = 1.0;
        let mut material = material;
        while let Self::Mask { opacity, inside } = materials[material] {
            let value @ Rgb { r, g, b } = textures.eval(opacity, at);
            let grey = if r == g && g == b { r } else { value.luminance() };
            // What is not a number is not there.
            product *= if grey > 0.0 { grey.min(1.0) } else { 0.0 };
            material = inside;
        }
        product
    }
}
