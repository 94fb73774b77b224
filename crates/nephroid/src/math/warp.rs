//! Maps from the unit square to other domains, with their densities: `square_to_x`, `x_to_square`
//! (the inverse) and `square_to_x_pdf` (with respect to area or solid angle of the target).

use std::f32::consts::{FRAC_1_SQRT_2, FRAC_PI_2, FRAC_PI_4, PI};

use super::real::{atan2, cos, exp_m1, ln, pow, sin_cos, sin_cos_of_quarter};
use super::{Vec2, Vec3};

/// Uniform on the unit disk, by concentric squares (Shirley and Chiu 1997).
#[inline]
pub fn square_to_disk(u: Vec2) -> Vec2 {
    let v = 2.0 * u - Vec2::ONE;
    if v == Vec2::ZERO {
        return Vec2::ZERO;
    }
    if v.x.abs() > v.y.abs() {
        let (sin, cos) = sin_cos_of_quarter(v.y / v.x);
        Vec2::new(v.x * cos, v.x * sin)
    } else {
        // The angle is counted from the other axis.
        let (sin, cos) = sin_cos_of_quarter(v.x / v.y);
        Vec2::new(v.y * sin, v.y * cos)
    }
}

/// Inverse of [`square_to_disk`].
#[inline]
pub fn disk_to_square(p: Vec2) -> Vec2 {
    let r = p.length();
    if r == 0.0 {
        return Vec2::splat(0.5);
    }
    let v = if p.x.abs() > p.y.abs() {
        // The quarter that a sign of the radius tells from the opposite one.
        let signed = r.copysign(p.x);
        Vec2::new(signed, signed * atan2(p.y / signed, p.x / signed) / FRAC_PI_4)
    } else {
        let signed = r.copysign(p.y);
        Vec2::new(signed * (FRAC_PI_2 - atan2(p.y / signed, p.x / signed)) / FRAC_PI_4, signed)
    };
    (v + Vec2::ONE) * 0.5
}

/// Density of [`square_to_disk`] per unit area.
#[inline]
pub fn square_to_disk_pdf(p: Vec2) -> f32 {
    if p.length_squared() <= 1.0 { 1.0 / PI } else { 0.0 }
}

/// Uniform on the unit sphere: `z = 1 − 2u`, the *solid-angle sampling* of the 2019 report in the
/// form whose density is 1/4π everywhere (its latitude is `asin`, its range corrected).
#[inline]
pub fn square_to_sphere(u: Vec2) -> Vec3 {
    let z = 1.0 - 2.0 * u.x;
    let r = (1.0 - z * z).max(0.0).sqrt();
    let (sin, cos) = sin_cos(2.0 * PI * u.y);
    Vec3::new(r * cos, r * sin, z)
}

/// Density of [`square_to_sphere`] per unit solid angle.
pub const SPHERE_PDF: f32 = 0.25 / PI;

/// Inverse of [`square_to_sphere`].
#[inline]
pub fn sphere_to_square(w: Vec3) -> Vec2 {
    let phi = atan2(w.y, w.x) / (2.0 * PI);
    Vec2::new((1.0 - w.z) * 0.5, if phi < 0.0 { phi + 1.0 } else { phi })
}

/// Uniform on the unit sphere, and continuous across all but the edges of the square, which are folded: the middle is +z and
/// all corners are −z, each quarter of the square is a quarter of the sphere, and the corner triangles of these lie behind
/// (Clarberg 2008, *Fast Equal-Area Mapping of the (Hemi)Sphere using SIMD*, doi 10.1080/2151237X.2008.10129263).
#[inline]
pub fn square_to_equal_area_sphere(u: Vec2) -> Vec3 {
    let p = 2.0 * u - Vec2::ONE;
    let a = p.abs();
    // From the middle 0 to the diagonal 1, and on to the corner 0.
    let ahead = 1.0 - (a.x + a.y);
    let r = 1.0 - ahead.abs();
    // The angle is within 45° of the diagonal.
    let (sin, cos) = if r == 0.0 { (0.0, 1.0) } else { sin_cos_of_quarter((a.y - a.x) / r) };
    let (sin, cos) = (FRAC_1_SQRT_2 * (cos + sin), FRAC_1_SQRT_2 * (cos - sin));
    let rho = r * (2.0 - r * r).max(0.0).sqrt();
    Vec3::new((rho * cos).copysign(p.x), (rho * sin).copysign(p.y), (1.0 - r * r).copysign(ahead))
}

/// Inverse of [`square_to_equal_area_sphere`].
#[inline]
pub fn equal_area_sphere_to_square(w: Vec3) -> Vec2 {
    let a = w.abs();
    // √(1 − |z|), which next to the poles only the others tell.
    let r = ((a.x * a.x + a.y * a.y) / (1.0 + a.z)).sqrt();
    let v = r * (atan2(a.y, a.x) / FRAC_PI_2);
    let p = Vec2::new(r - v, v);
    let p = if w.z < 0.0 { Vec2::new(1.0 - p.y, 1.0 - p.x) } else { p };
    (Vec2::new(p.x.copysign(w.x), p.y.copysign(w.y)) + Vec2::ONE) * 0.5
}

/// Cosine-weighted on the hemisphere about `+z` (Malley's method).
#[inline]
pub fn square_to_cosine_hemisphere(u: Vec2) -> Vec3 {
    let d = square_to_disk(u);
    Vec3::new(d.x, d.y, (1.0 - d.length_squared()).max(0.0).sqrt())
}

/// Density of [`square_to_cosine_hemisphere`] per unit solid angle, for a local direction.
#[inline]
pub fn square_to_cosine_hemisphere_pdf(w: Vec3) -> f32 {
    w.z.max(0.0) / PI
}

/// Uniform in the cone of directions within an angle θ of `+z`, given by 1 − cos θ: the cosine itself
/// would lose narrow cones, and below .02° it is one. See [`one_minus_cos`].
#[inline]
pub fn square_to_cone(u: Vec2, one_minus_cos_max: f32) -> Vec3 {
    let one_minus_cos = u.x * one_minus_cos_max;
    let z = 1.0 - one_minus_cos;
    let r = (one_minus_cos * (2.0 - one_minus_cos)).max(0.0).sqrt();
    let (sin, cos) = sin_cos(2.0 * PI * u.y);
    Vec3::new(r * cos, r * sin, z)
}

/// Density of [`square_to_cone`] per unit solid angle inside the cone.
#[inline]
pub fn square_to_cone_pdf(one_minus_cos_max: f32) -> f32 {
    1.0 / (2.0 * PI * one_minus_cos_max)
}

/// 1 − cos θ = 2 sin²(θ/2), to full precision for small angles, too.
#[inline]
pub fn one_minus_cos(theta: f32) -> f32 {
    let sin = sin_cos(0.5 * theta).0;
    2.0 * sin * sin
}

/// Density ∝ cosⁿ about `+z` on the hemisphere (Lafortune and Willems 1994).
#[inline]
pub fn square_to_cosine_power(u: Vec2, exponent: f32) -> Vec3 {
    let z = pow(u.x, 1.0 / (exponent + 1.0));
    // The subtraction leaves a narrow lobe's radius few digits, and above 10⁷ none.
    let r_sq = if exponent > 1e4 { -exp_m1(2.0 * ln(u.x) / (exponent + 1.0)) } else { 1.0 - z * z };
    let r = r_sq.max(0.0).sqrt();
    let phi = 2.0 * PI * u.y;
    Vec3::new(r * cos(phi), r * cos(phi - FRAC_PI_2), z)
}

/// Density of [`square_to_cosine_power`] per unit solid angle, for a local direction.
#[inline]
pub fn square_to_cosine_power_pdf(cos_theta: f32, exponent: f32) -> f32 {
    if cos_theta <= 0.0 {
        return 0.0;
    }
    (exponent + 1.0) / (2.0 * PI) * pow(cos_theta, exponent)
}

/// Uniform on a triangle: barycentric weights of its second and third vertex (Heitz 2019,
/// *A Low-Distortion Map Between Triangle and Square*).
#[inline]
pub fn square_to_triangle(u: Vec2) -> Vec2 {
    if u.y > u.x {
        let x = u.x * 0.5;
        Vec2::new(x, u.y - x)
    } else {
        let y = u.y * 0.5;
        Vec2::new(u.x - y, y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverses_lead_back() {
        for i in 0..40 {
            for j in 0..40 {
                let u = Vec2::new((i as f32 + 0.3) / 40.0, (j as f32 + 0.6) / 40.0);
                assert!((disk_to_square(square_to_disk(u)) - u).length() < 1e-5, "{u}");
                assert!((sphere_to_square(square_to_sphere(u)) - u).length() < 1e-5, "{u}");
                let back = equal_area_sphere_to_square(square_to_equal_area_sphere(u));
                assert!((back - u).length() < 1e-5, "{u} {back}");
            }
        }
    }
}
