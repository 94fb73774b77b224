use super::Metal;
use super::fresnel::fresnel_conductor;
use super::split::Split;
use crate::color::Rgb;

/// A smooth metal: a mirror lobe and nothing else.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conductor {
    pub metal: Metal,
    pub reflectance: Rgb,
}

impl Conductor {
    /// `cos_o` is the cosine of `wo` to the normal.
    pub fn split(&self, cos_o: f32) -> Split {
        let fresnel = metal_reflectance(&self.metal, cos_o);
        Split { reflectance: fresnel * self.reflectance, refraction: None, reflect_probability: 1.0 }
    }
}

/// What a metal reflects of light that comes with this cosine to its normal.
pub(super) fn metal_reflectance(metal: &Metal, cos_o: f32) -> Rgb {
    match metal {
        Metal::PerfectMirror => Rgb::WHITE,
        Metal::Index { eta, k } => fresnel_conductor(cos_o, *eta, *k),
    }
}
