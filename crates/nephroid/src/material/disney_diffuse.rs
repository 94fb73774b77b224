use std::f32::consts::FRAC_1_PI;

use super::disney::schlick;
use crate::color::Rgb;
use crate::math::real;

/// The diffuse lobe and the sheen of Disney's material (Burley 2012, §5.3 and §5.5; Burley 2015, equation 4).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Base {
    /// Albedo, times the part that is neither metal nor clear.
    pub color: Rgb,
    /// Colour of the sheen, times its strength and the part that is no metal.
    pub sheen: Rgb,
    pub roughness: f32,
    pub flatness: f32,
}

impl Base {
    pub fn is_black(&self) -> bool {
        (self.color + self.sheen).is_black()
    }

    /// f, from both cosines to the normal and that to the facet between.
    pub fn eval(&self, cos_o: f32, cos_i: f32, cos_d: f32) -> Rgb {
        let (of_o, of_i) = (schlick(cos_o), schlick(cos_i));
        // Twice the roughness times cos²θ_d.
        let back = 2.0 * self.roughness * cos_d * cos_d;
        let retro = back * (of_o + of_i + of_o * of_i * (back - 1.0));
        let rough = (1.0 - 0.5 * of_o) * (1.0 - 0.5 * of_i) + retro;
        let mut shape = rough;
        if self.flatness > 0.0 {
            let towards = |weight: f32| 1.0 + (0.5 * back - 1.0) * weight;
            let flat = towards(of_o) * towards(of_i) * (1.0 / (cos_o + cos_i) - 0.5) + 0.5;
            shape += self.flatness * (1.25 * flat - rough);
        }
        self.color * (shape * FRAC_1_PI) + self.sheen * schlick(cos_d)
    }

    /// What is scattered of light that comes with a cosine, at most, of the brightest channel.
    pub fn bound(&self, cos: f32) -> f32 {
        let mut shape = self.rough_albedo(cos);
        if self.flatness > 0.0 {
            shape += self.flatness * (self.flat_bound(cos) - shape);
        }
        self.color.max_channel() * shape + self.sheen.max_channel() * sheen_bound(cos)
    }

    /// The same on average.
    pub fn share(&self, cos: f32) -> f32 {
        self.color.mean() + self.sheen.mean() * sheen_bound(cos)
    }

    /// The albedo of the rough lobe of white. With (1 + wo·wi) r for 2r cos²θ_d all integrals are of the kind
    /// 2 ∫ μ^(k+1) (1 − μ)⁵ dμ, which are 1/21, 1/84 and 1/252.
    fn rough_albedo(&self, cos: f32) -> f32 {
        const M: [f32; 3] = [1.0 / 21.0, 1.0 / 84.0, 1.0 / 252.0];
        let (r, f) = (self.roughness, schlick(cos));
        let linear = M[0] + cos * M[1];
        let squared = M[0] + 2.0 * cos * M[1] + cos * cos * M[2] + 0.5 * (1.0 - cos * cos) * (M[0] - M[2]);
        (1.0 - 0.5 * f) * (1.0 - 0.5 * M[0])
            + r * (f * (1.0 + 2.0 / 3.0 * cos) + linear)
            + f * r * (r * squared - linear)
    }

    /// A bound on the albedo of the flat lobe of white: as if light from all sides had the factor of the normal.
    fn flat_bound(&self, cos: f32) -> f32 {
        let (half, f, c) = (0.5 * self.roughness, schlick(cos), cos.max(1e-4));
        let log = real::ln((1.0 + c) / c);
        let even = 2.0 * (1.0 - c * log) - 0.5;
        let slanted = 2.0 * (0.5 - c + c * c * log) - 1.0 / 3.0;
        1.25 * ((1.0 - f + f * half) * even + f * half * c * slanted.max(0.0) + 0.5)
    }
}

/// A bound on π times the mean of (1 − cos θ_d)⁵ over light from all sides, which is 0.0885 at grazing incidence.
fn sheen_bound(cos: f32) -> f32 {
    // Close above what quadrature gives.
    let x = 1.0 - cos;
    0.09 * x * x * x.sqrt() + 0.001
}
