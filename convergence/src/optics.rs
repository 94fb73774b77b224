//! Closed forms that tests compare with, in double precision and without any of the renderer's code.

use std::f64::consts::{PI, TAU};

use nephroid::math::DVec3;

/// The share of unpolarised light reflected where light passes from the index 1 to the index `n` at
/// `sin_i`, the sine of the angle of incidence (Fresnel's equations). The way back at the angle of
/// refraction reflects the same share.
pub fn fresnel(sin_i: f64, n: f64) -> f64 {
    let (cos_i, cos_t) = ((1.0 - sin_i * sin_i).sqrt(), (1.0 - sin_i * sin_i / (n * n)).sqrt());
    let s = (cos_i - n * cos_t) / (cos_i + n * cos_t);
    let p = (n * cos_i - cos_t) / (n * cos_i + cos_t);
    0.5 * (s * s + p * p)
}

/// Irradiance of a polygon of radiance 1 that lies wholly above the plane through `point` with unit
/// normal `normal` (Lambert 1760): ½ Σ θᵢ n·γᵢ over the edges, θᵢ the angle an edge fills and γᵢ the
/// normal of the plane through it and the point. Its sign depends on the sense of the corners and is
/// dropped.
pub fn polygon_irradiance(corners: &[DVec3], point: DVec3, normal: DVec3) -> f64 {
    let edges = corners.iter().zip(corners.iter().cycle().skip(1));
    let sum: f64 = edges
        .map(|(&a, &b)| {
            let (a, b) = ((a - point).normalize(), (b - point).normalize());
            let cross = a.cross(b);
            let angle = libm::atan2(cross.length(), a.dot(b));
            angle * normal.dot(cross.normalize())
        })
        .sum();
    0.5 * sum.abs()
}

/// The Epanechnikov kernel of radius `r` in the plane, 2 (1 − d²/r²) / πr²; integrates to one.
pub fn epanechnikov(distance_sq: f64, r: f64) -> f64 {
    let t_sq = distance_sq / (r * r);
    if t_sq < 1.0 { 2.0 * (1.0 - t_sq) / (PI * r * r) } else { 0.0 }
}

/// The mean of `f` over the plane under the Epanechnikov kernel of radius `r` at (x, z): what a
/// density estimate of fixed radius has for its expectation where the density is `f`.
///
/// A product rule of 8 rings of equal kernel mass and 16 directions, which is exact for quadratic
/// functions up to 1 % of the *difference* that blurring makes. `f` must be smooth across the disc.
pub fn blurred(f: impl Fn(f64, f64) -> f64, x: f64, z: f64, r: f64) -> f64 {
    const RINGS: u32 = 8;
    const DIRECTIONS: u32 = 16;
    let mut sum = 0.0;
    for ring in 0..RINGS {
        // The mass within t is 2t² − t⁴, so t² = 1 − √(1 − mass).
        let mass = (f64::from(ring) + 0.5) / f64::from(RINGS);
        let d = r * (1.0 - (1.0 - mass).sqrt()).sqrt();
        for direction in 0..DIRECTIONS {
            let phi = TAU * (f64::from(direction) + 0.5) / f64::from(DIRECTIONS);
            sum += f(x + d * libm::cos(phi), z + d * libm::sin(phi));
        }
    }
    sum / f64::from(RINGS * DIRECTIONS)
}

/// A root of `f` between `a` and `b`, where it has different signs, to the last bits (bisection).
pub fn root(f: impl Fn(f64) -> f64, mut a: f64, mut b: f64) -> f64 {
    let sign = f(a) > 0.0;
    for _ in 0..100 {
        let middle = 0.5 * (a + b);
        *(if (f(middle) > 0.0) == sign { &mut a } else { &mut b }) = middle;
    }
    0.5 * (a + b)
}

/// The derivative of `f` by central differences with an error ∝ h⁴.
pub fn derivative(f: impl Fn(f64) -> f64, x: f64, h: f64) -> f64 {
    (8.0 * (f(x + h) - f(x - h)) - (f(x + 2.0 * h) - f(x - 2.0 * h))) / (12.0 * h)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fresnel_at_normal_grazing_and_brewster_angle() {
        assert!((fresnel(0.0, 1.5) - 0.04).abs() < 1e-15);
        assert!((fresnel(1.0, 1.5) - 1.0).abs() < 1e-15);
        // At tan i = n only the s half is reflected, ((1 − n²)/(1 + n²))².
        let sin_brewster = 1.5 / (1.0f64 + 2.25).sqrt();
        let s = 1.25f64 / 3.25;
        assert!((fresnel(sin_brewster, 1.5) - 0.5 * s * s).abs() < 1e-15);
    }

    /// Over the middle of a square of half side a at height h: E = 4 a / √(a² + h²) · atan(a / √(a² + h²)).
    #[test]
    fn a_square_above_a_point() {
        let corner = |x: f64, z: f64| DVec3::new(x, 2.0, z);
        let square = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
        let q = 1.0 / 5.0f64.sqrt();
        let exact = 4.0 * q * libm::atan(q);
        assert!((polygon_irradiance(&square, DVec3::ZERO, DVec3::Y) - exact).abs() < 1e-14);
    }

    /// x² has the mean r²/6 under the kernel, and blurring leaves what is linear alone.
    #[test]
    fn blurring_has_the_moments_of_the_kernel() {
        assert!((blurred(|x, z| 1.0 + x - 2.0 * z, 3.0, 1.0, 0.5) - 2.0).abs() < 1e-12);
        let second = blurred(|x, _| x * x, 0.0, 0.0, 0.5);
        assert!((second * 6.0 / 0.25 - 1.0).abs() < 0.01, "{second}");
        let steps = 2000;
        let mass: f64 = (0..steps)
            .map(|i| (f64::from(i) + 0.5) / f64::from(steps))
            .map(|t| TAU * t * epanechnikov(t * t, 1.0) / f64::from(steps))
            .sum();
        assert!((mass - 1.0).abs() < 1e-6);
    }
}
