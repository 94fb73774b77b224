use std::f32::consts::TAU;

use super::fresnel::mirror;
use super::lambertian::Lambertian;
use crate::color::Rgb;
use crate::math::{Frame, Vec2, Vec3, real, warp};

/// The modified Phong model (Lafortune and Willems 1994, *Using the Modified Phong Reflectance
/// Model for Physically Based Rendering*, KU Leuven CW 197):
/// f = k_d/π + k_s (n+2)/2π cosⁿα, α the angle between `wi` and the mirror direction of `wo`.
///
/// Reciprocal, and reflects at most what arrives if k_d + k_s ≤ 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phong {
    /// k_d.
    pub diffuse: Rgb,
    /// k_s.
    pub specular: Rgb,
    /// n.
    pub exponent: f32,
}

impl Phong {
    #[inline]
    pub fn eval(&self, n: Vec3, wo: Vec3, wi: Vec3) -> Rgb {
        let lobe = (self.exponent + 2.0) / TAU * self.cosine_power(mirror(wo, n), wi);
        Lambertian { albedo: self.diffuse }.eval() + self.specular * lobe
    }

    /// Per solid angle: the mixture of both lobes that [`sample`](Self::sample) draws from. It has a
    /// share below the surface, which `sample` does not avoid.
    #[inline]
    pub fn pdf(&self, n: Vec3, wo: Vec3, wi: Vec3) -> f32 {
        let p = self.specular_probability();
        let lobe = (self.exponent + 1.0) / TAU * self.cosine_power(mirror(wo, n), wi);
        (1.0 - p) * Lambertian::pdf(n, wi) + p * lobe
    }

    #[inline]
    pub fn sample(&self, frame: &Frame, wo: Vec3, u: Vec2, u_lobe: f32) -> Vec3 {
        if u_lobe < self.specular_probability() {
            let about = Frame::from_normal(mirror(wo, frame.n).normalize());
            about.to_world(warp::square_to_cosine_power(u, self.exponent))
        } else {
            Lambertian::sample(frame, u)
        }
    }

    /// The share of samples that the cosⁿ lobe gets.
    #[inline]
    fn specular_probability(&self) -> f32 {
        let (d, s) = (self.diffuse.mean(), self.specular.mean());
        s / (d + s)
    }

    /// cosⁿ of the angle between two unit vectors, zero beyond a right angle.
    ///
    /// From the chord |a − b|² = 2(1 − cos α), which keeps the digits that the scalar product loses
    /// near α = 0, where a large exponent needs them.
    #[inline]
    fn cosine_power(&self, a: Vec3, b: Vec3) -> f32 {
        let one_minus_cos = 0.5 * (a - b).length_squared();
        if one_minus_cos < 1.0 { real::exp(self.exponent * libm::log1pf(-one_minus_cos)) } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lobe(exponent: f32) -> Phong {
        Phong { diffuse: Rgb::BLACK, specular: Rgb::WHITE, exponent }
    }

    #[test]
    fn the_lobe_has_the_value_of_the_formula() {
        let phong = Phong { diffuse: Rgb::splat(0.5), specular: Rgb::splat(0.25), exponent: 3.0 };
        // wo at 30°, wi at 60° on the other side: 30° off the mirror direction.
        let wo = Vec3::new(-0.5, 0.0, 0.75f32.sqrt());
        let wi = Vec3::new(0.75f32.sqrt(), 0.0, 0.5);
        let expected = 0.5 / std::f32::consts::PI + 0.25 * 5.0 / TAU * 0.75f32.powi(3).sqrt();
        assert!((phong.eval(Vec3::Z, wo, wi).g - expected).abs() < 1e-6);
    }

    #[test]
    fn large_exponents_keep_their_digits() {
        let phong = lobe(1e6);
        let alpha = 1e-3f64;
        let tilted = Vec3::new(libm::sin(alpha) as f32, 0.0, libm::cos(alpha) as f32);
        let expected = libm::pow(libm::cos(alpha), 1e6);
        assert!((f64::from(phong.cosine_power(Vec3::Z, tilted)) / expected - 1.0).abs() < 1e-4);
    }

    #[test]
    fn exponent_zero_is_a_hemisphere_about_the_mirror_direction() {
        let phong = lobe(0.0);
        assert_eq!(phong.cosine_power(Vec3::Z, Vec3::new(0.6, 0.0, 0.8)), 1.0);
        assert_eq!(phong.cosine_power(Vec3::Z, Vec3::X), 0.0);
        assert_eq!(phong.cosine_power(Vec3::Z, -Vec3::Z), 0.0);
    }
}
