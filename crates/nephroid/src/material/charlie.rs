use std::f32::consts::TAU;

use super::albedo::of_sheen;
use crate::color::Rgb;
use crate::math::{Vec3, real};

/// The least α: below it reflects next to nothing but at grazing incidence.
const LEAST: f32 = 0.01;

/// The sheen of cloth (Estevez and Kulla 2017, *Production Friendly Microfacet Sheen BRDF*, known as Charlie; as
/// `KHR_materials_sheen` has it), scaled down in directions in which it would reflect more than arrives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Charlie {
    pub color: Rgb,
    alpha: f32,
}

impl Charlie {
    pub fn new(color: Rgb, roughness: f32) -> Self {
        Self { color, alpha: (roughness * roughness).max(LEAST) }
    }

    pub fn is_black(&self) -> bool {
        self.color.is_black()
    }

    /// At most what is reflected, in the brightest channel.
    pub fn albedo(&self, cos: f32) -> f32 {
        // What the table may miss of its steepest parts.
        (1.03 * self.color.max_channel() * of_sheen(cos, self.alpha)).min(1.0)
    }

    /// What is reflected, roughly.
    pub fn share(&self, cos: f32) -> f32 {
        self.color.mean() * (0.05 + of_sheen(cos, self.alpha).min(1.0))
    }

    pub fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
        let m = (wo + wi).normalize();
        let sin_sq = m.x * m.x + m.y * m.y;
        let power = 1.0 / self.alpha;
        let density = (2.0 + power) / TAU * real::pow(sin_sq, 0.5 * power);
        let visible = 1.0 / (1.0 + self.lambda(wo.z) + self.lambda(wi.z));
        let over = |cos| (1.03 * self.color.max_channel() * of_sheen(cos, self.alpha)).max(1.0);
        let scale = over(wo.z).max(over(wi.z));
        self.color * (density * visible / (4.0 * wo.z * wi.z * scale))
    }

    /// Λ by the fit of Estevez and Kulla (equation 3), mirrored at a cosine of one half.
    fn lambda(&self, cos: f32) -> f32 {
        let fit = |x| self.fit(x);
        real::exp(if cos < 0.5 { fit(cos) } else { 2.0 * fit(0.5) - fit(1.0 - cos) })
    }

    fn fit(&self, x: f32) -> f32 {
        let weight = (1.0 - self.alpha) * (1.0 - self.alpha);
        let [a, b, c, d, e] = [
            (25.3245, 21.5473),
            (3.32435, 3.82987),
            (0.16801, 0.19823),
            (-1.27393, -1.97760),
            (-4.85967, -4.32054),
        ]
        .map(|(smooth, rough)| rough + (smooth - rough) * weight);
        a / (1.0 + b * real::pow(x.max(0.0), c)) + d * x + e
    }
}
