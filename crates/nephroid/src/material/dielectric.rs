use super::fresnel::{dielectric_reflectance, fresnel_dielectric, refract, refracted_cosine};
use super::split::{Refraction, Split};
use crate::color::Rgb;
use crate::math::Vec3;

/// The smooth boundary of two dielectrics, or a thin slab of one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dielectric {
    /// Index on the inner side (of a slab, between its boundaries) relative to the outer one.
    pub eta: f32,
    pub reflectance: Rgb,
    pub transmittance: Rgb,
}

impl Dielectric {
    /// `n` is the shading normal on the side of `wo`, which is the outer one if `outside`.
    pub fn split(&self, wo: Vec3, n: Vec3, outside: bool) -> Split {
        if self.eta == 1.0 {
            return Split::pass(wo, self.transmittance);
        }
        let eta = if outside { self.eta } else { 1.0 / self.eta };
        let cos_o = wo.dot(n).clamp(0.0, 1.0);
        let Some(cos_i) = refracted_cosine(cos_o, eta) else {
            return Split { reflectance: self.reflectance, refraction: None, reflect_probability: 1.0 };
        };
        let fresnel = dielectric_reflectance(cos_o, cos_i, eta);
        let refraction = Refraction {
            wi: refract(wo, n, cos_o, cos_i, eta),
            transmittance: self.transmittance * (1.0 - fresnel),
            radiance_scale: 1.0 / (eta * eta),
        };
        Split {
            reflectance: self.reflectance * fresnel,
            refraction: Some(refraction),
            reflect_probability: fresnel,
        }
    }

    /// Two parallel boundaries at no distance, `eta` between them: light goes straight on or is mirrored.
    /// `cos_o` is the cosine of `wo` to the normal, whatever its sign.
    pub fn split_thin(&self, wo: Vec3, cos_o: f32) -> Split {
        if self.eta == 1.0 {
            return Split::pass(wo, self.transmittance);
        }
        let fresnel = slab_reflectance(fresnel_dielectric(cos_o.abs(), self.eta));
        let pass = Split::pass(wo, self.transmittance * (1.0 - fresnel));
        Split { reflectance: self.reflectance * fresnel, reflect_probability: fresnel, ..pass }
    }
}

/// What a slab reflects if one of its boundaries reflects `r`: the sum over all inner reflections,
/// r + (1−r)² r (1 + r² + r⁴ + …) = 2r/(1 + r).
fn slab_reflectance(r: f32) -> f32 {
    2.0 * r / (1.0 + r)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slab_sums_all_orders_of_reflection() {
        for r in [0.0f32, 0.04, 0.3, 0.9] {
            let orders: f32 = (0..400).map(|order| (1.0 - r) * (1.0 - r) * r.powi(2 * order + 1)).sum();
            assert!((slab_reflectance(r) - (r + orders)).abs() < 1e-5, "{r}");
        }
        assert_eq!(slab_reflectance(1.0), 1.0);
    }

    #[test]
    fn equal_indices_pass_the_very_direction() {
        let glass = Dielectric { eta: 1.0, reflectance: Rgb::WHITE, transmittance: Rgb::WHITE };
        let wo = Vec3::new(0.123, -0.456, 0.789).normalize();
        let split = glass.split(wo, Vec3::Z, true);
        assert_eq!(split.refraction.map(|r| (r.wi, r.transmittance)), Some((-wo, Rgb::WHITE)));
        assert!(split.reflectance.is_black());
    }
}
