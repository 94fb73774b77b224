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
        let fresnel = match self.metal {
            Metal::PerfectMirror => Rgb::WHITE,
            Metal::Index { eta, k } => fresnel_conductor(cos_o, eta, k),
        };
        Split { reflectance: fresnel * self.reflectance, refraction: None, reflect_probability: 1.0 }
    }
}
