//! Reflection and refraction at a smooth boundary, for unpolarised light.
//!
//! Born and Wolf, *Principles of Optics*, 7th ed., §1.5.2 for dielectrics and §14.2 for metals.

use crate::color::Rgb;
use crate::math::Vec3;

/// The direction on the other side of the unit normal `n`; both directions leave the surface.
#[inline]
pub(super) fn mirror(wo: Vec3, n: Vec3) -> Vec3 {
    2.0 * wo.dot(n) * n - wo
}

/// The cosine beyond a boundary by Snell's law, or `None` where light is reflected totally.
///
/// `cos_o` ∈ [0, 1] is the cosine on the near side, `eta` the index of the far side relative to the
/// near one.
#[inline]
pub(super) fn refracted_cosine(cos_o: f32, eta: f32) -> Option<f32> {
    let sin_sq = (1.0 - cos_o * cos_o).max(0.0) / (eta * eta);
    (sin_sq < 1.0).then(|| (1.0 - sin_sq).sqrt())
}

/// The unit direction beyond a boundary, given both cosines. `n` is the unit normal on the side of
/// `wo`, `eta` the index of the far side relative to the near one.
#[inline]
pub(super) fn refract(wo: Vec3, n: Vec3, cos_o: f32, cos_i: f32, eta: f32) -> Vec3 {
    ((cos_o * n - wo) / eta - cos_i * n).normalize()
}

/// The share of power reflected at the boundary of two dielectrics; one under total reflection.
///
/// `cos_o` is the cosine of the angle to the normal on the side of the light, `eta` the index of
/// the far side relative to that side.
#[inline]
pub fn fresnel_dielectric(cos_o: f32, eta: f32) -> f32 {
    let cos_o = cos_o.clamp(0.0, 1.0);
    match refracted_cosine(cos_o, eta) {
        None => 1.0,
        Some(cos_i) => dielectric_reflectance(cos_o, cos_i, eta),
    }
}

/// [`fresnel_dielectric`] where the cosine beyond the boundary is known.
#[inline]
pub(super) fn dielectric_reflectance(cos_o: f32, cos_i: f32, eta: f32) -> f32 {
    let s = (cos_o - eta * cos_i) / (cos_o + eta * cos_i);
    let p = (eta * cos_o - cos_i) / (eta * cos_o + cos_i);
    0.5 * (s * s + p * p)
}

/// The share of power reflected by a metal of complex index η + ik relative to the outside, per
/// channel; `cos_o` is the cosine of the angle to the normal.
pub fn fresnel_conductor(cos_o: f32, eta: Rgb, k: Rgb) -> Rgb {
    let cos_o = f64::from(cos_o.clamp(0.0, 1.0));
    eta.zip(k, |eta, k| conductor_reflectance(cos_o, f64::from(eta), f64::from(k)) as f32)
}

/// One channel. With the complex w = a + ib, w² = (η + ik)² − sin²θ, the normal component of the
/// wave vector in the metal, the amplitudes are r_s = (cos θ − w)/(cos θ + w) and
/// r_p = r_s · (w cos θ − sin²θ)/(w cos θ + sin²θ).
fn conductor_reflectance(cos: f64, eta: f64, k: f64) -> f64 {
    let (cos_sq, sin_sq) = (cos * cos, 1.0 - cos * cos);
    let real = eta * eta - k * k - sin_sq;
    let imaginary = 2.0 * eta * k;
    let modulus = (real * real + imaginary * imaginary).sqrt();
    let a = (0.5 * (modulus + real)).max(0.0).sqrt();
    let s = (cos_sq - 2.0 * a * cos + modulus) / (cos_sq + 2.0 * a * cos + modulus);
    let even = modulus * cos_sq + sin_sq * sin_sq;
    let odd = 2.0 * a * cos * sin_sq;
    let p = if even + odd > 0.0 { s * (even - odd) / (even + odd) } else { s };
    0.5 * (s + p)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::real;

    fn close(a: f32, b: f32) {
        assert!((a - b).abs() < 2e-6, "{a} is not {b}");
    }

    #[test]
    fn glass_has_the_values_of_the_textbook() {
        close(fresnel_dielectric(1.0, 1.5), 0.04);
        close(fresnel_dielectric(1.0, 1.0 / 1.5), 0.04);
        close(fresnel_dielectric(0.0, 1.5), 1.0);
        // 45° into 1.5: r_s = −0.303337, r_p = 0.092013, by hand.
        close(fresnel_dielectric(0.5f32.sqrt(), 1.5), 0.5 * (0.303_337f32.powi(2) + 0.092_013f32.powi(2)));
        for cos in [0.01, 0.3, 0.7, 1.0] {
            close(fresnel_dielectric(cos, 1.0), 0.0);
        }
    }

    #[test]
    fn at_brewsters_angle_only_s_is_reflected() {
        // tan θ = η, where r_p = 0 and r_s = (1 − η²)/(1 + η²).
        let eta = 1.5f32;
        let cos = 1.0 / (1.0 + eta * eta).sqrt();
        let s = (1.0 - eta * eta) / (1.0 + eta * eta);
        close(fresnel_dielectric(cos, eta), 0.5 * s * s);
    }

    #[test]
    fn reflection_is_total_beyond_the_critical_angle_only() {
        let critical = (1.0f32 - 1.0 / 2.25).sqrt();
        assert_eq!(fresnel_dielectric(critical - 1e-4, 1.0 / 1.5), 1.0);
        assert!(fresnel_dielectric(critical + 1e-4, 1.0 / 1.5) < 0.98);
    }

    #[test]
    fn both_ways_through_a_boundary_reflect_the_same() {
        for i in 1..100 {
            let (cos_o, eta) = (i as f32 / 100.0, 1.7);
            let cos_i = refracted_cosine(cos_o, eta).unwrap();
            let (into, out) = (fresnel_dielectric(cos_o, eta), fresnel_dielectric(cos_i, 1.0 / eta));
            // Going back doubles the rounding of a cosine of 0.01.
            assert!((into - out).abs() < 1e-4, "{cos_o}: {into} and {out}");
        }
    }

    #[test]
    fn refraction_obeys_snell() {
        let eta = 1.33f32;
        for i in 0..90 {
            let (sin, cos) = real::sin_cos((i as f32).to_radians());
            let wo = Vec3::new(sin, 0.0, cos);
            let cos_i = refracted_cosine(cos, eta).unwrap();
            let wi = refract(wo, Vec3::Z, cos, cos_i, eta);
            close(wi.length(), 1.0);
            close(-wi.x * eta, sin);
            assert!(wi.z < 0.0 && wi.x <= 0.0);
        }
    }

    #[test]
    fn gold_has_the_value_worked_out_by_hand() {
        // η = 0.43, k = 2.46 at normal incidence: ((η−1)² + k²)/((η+1)² + k²) = 6.3765/8.0965.
        let gold = |cos| fresnel_conductor(cos, Rgb::splat(0.43), Rgb::splat(2.46)).r;
        close(gold(1.0), 6.3765 / 8.0965);
        close(gold(0.0), 1.0);
    }

    #[test]
    fn metals_match_complex_arithmetic() {
        for (eta, k) in [(0.2f64, 3.9f64), (1.5, 7.6), (2.9, 3.1), (0.001, 5.0), (1.3, 0.0)] {
            for i in 1..=20 {
                let cos = f64::from(i) / 20.0;
                let expected = amplitudes_squared(cos, (eta, k));
                assert!((conductor_reflectance(cos, eta, k) - expected).abs() < 1e-9, "{eta} {k} {cos}");
            }
        }
    }

    #[test]
    fn a_metal_that_does_not_absorb_is_a_dielectric() {
        for i in 0..=20 {
            let cos = i as f32 / 20.0;
            let metal = fresnel_conductor(cos, Rgb::splat(1.5), Rgb::BLACK).r;
            close(metal, fresnel_dielectric(cos, 1.5));
        }
    }

    /// Reflectance by Fresnel's amplitudes with complex numbers (re, im) and the refracted cosine,
    /// another way round than the code's.
    fn amplitudes_squared(cos: f64, m: (f64, f64)) -> f64 {
        let mul = |a: (f64, f64), b: (f64, f64)| (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0);
        let norm = |a: (f64, f64)| a.0 * a.0 + a.1 * a.1;
        let sub = |a: (f64, f64), b: (f64, f64)| (a.0 - b.0, a.1 - b.1);
        let add = |a: (f64, f64), b: (f64, f64)| (a.0 + b.0, a.1 + b.1);
        let inverse = |a: (f64, f64)| (a.0 / norm(a), -a.1 / norm(a));
        let root = |a: (f64, f64)| {
            let angle = 0.5 * libm::atan2(a.1, a.0);
            let length = norm(a).sqrt().sqrt();
            (length * libm::cos(angle), length * libm::sin(angle))
        };
        let sin = ((1.0 - cos * cos).sqrt(), 0.0);
        let sin_t = mul(sin, inverse(m));
        let cos_t = root(sub((1.0, 0.0), mul(sin_t, sin_t)));
        let cos = (cos, 0.0);
        let ratio = |a, b| norm(sub(a, b)) / norm(add(a, b));
        0.5 * (ratio(cos, mul(m, cos_t)) + ratio(mul(m, cos), cos_t))
    }
}
