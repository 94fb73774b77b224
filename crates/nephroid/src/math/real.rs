//! Transcendental functions from the `libm` crate: the same bits on every platform.
//!
//! The standard library calls the C library of the system, whose last bits differ from one to the
//! next; `clippy.toml` forbids it. Square roots are exact everywhere and need no wrapper.

/// Sine of an angle in radians.
#[inline]
pub fn sin(x: f32) -> f32 {
    libm::sinf(x)
}

/// Cosine of an angle in radians.
#[inline]
pub fn cos(x: f32) -> f32 {
    libm::cosf(x)
}

/// Sine and cosine of an angle in radians.
#[inline]
pub fn sin_cos(x: f32) -> (f32, f32) {
    (libm::sinf(x), libm::cosf(x))
}

/// Sine and cosine of πt/4 for t in [-1, 1], to 1.2e-7: their Taylor series. Much faster than the general
/// ones, which have to find the quadrant first.
#[inline]
pub fn sin_cos_of_quarter(t: f32) -> (f32, f32) {
    let x = t * std::f32::consts::FRAC_PI_4;
    let z = x * x;
    let sin = x * (1.0 - z * (1.0 / 6.0 - z * (1.0 / 120.0 - z * (1.0 / 5040.0 - z * (1.0 / 362_880.0)))));
    let cos = 1.0 - z * (0.5 - z * (1.0 / 24.0 - z * (1.0 / 720.0 - z * (1.0 / 40_320.0))));
    (sin, cos)
}

/// Tangent of an angle in radians.
#[inline]
pub fn tan(x: f32) -> f32 {
    libm::tanf(x)
}

/// Inverse cosine, in radians; the argument is clamped to [-1, 1].
#[inline]
pub fn acos(x: f32) -> f32 {
    libm::acosf(x.clamp(-1.0, 1.0))
}

/// Angle of the point (x, y), in radians, in (-π, π].
#[inline]
pub fn atan2(y: f32, x: f32) -> f32 {
    libm::atan2f(y, x)
}

/// Exponential function.
#[inline]
pub fn exp(x: f32) -> f32 {
    libm::expf(x)
}

/// eˣ − 1, to full precision for small x, too.
#[inline]
pub fn exp_m1(x: f32) -> f32 {
    libm::expm1f(x)
}

/// Natural logarithm.
#[inline]
pub fn ln(x: f32) -> f32 {
    libm::logf(x)
}

/// Power.
#[inline]
pub fn pow(base: f32, exponent: f32) -> f32 {
    libm::powf(base, exponent)
}

/// Cube root.
#[inline]
pub fn cbrt(x: f32) -> f32 {
    libm::cbrtf(x)
}

/// Sine of an angle in degrees, exact at multiples of a right angle.
#[inline]
pub fn sin_deg(degrees: f64) -> f64 {
    match degrees.rem_euclid(360.0) {
        0.0 | 180.0 => 0.0,
        90.0 => 1.0,
        270.0 => -1.0,
        d => libm::sin(d.to_radians()),
    }
}

/// Cosine of an angle in degrees, exact at multiples of a right angle.
#[inline]
pub fn cos_deg(degrees: f64) -> f64 {
    sin_deg(degrees + 90.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_short_series_are_as_good_as_single_precision() {
        for i in -1000..=1000 {
            let t = i as f32 / 1000.0;
            let (sin, cos) = sin_cos_of_quarter(t);
            let x = f64::from(t) * std::f64::consts::FRAC_PI_4;
            assert!(
                (f64::from(sin) - libm::sin(x)).abs() < 1.2e-7
                    && (f64::from(cos) - libm::cos(x)).abs() < 1.2e-7
            );
        }
        assert_eq!(sin_cos_of_quarter(0.0), (0.0, 1.0));
    }

    #[test]
    fn right_angles_are_exact() {
        for (degrees, sine, cosine) in
            [(0.0, 0.0, 1.0), (90.0, 1.0, 0.0), (-90.0, -1.0, 0.0), (180.0, 0.0, -1.0), (450.0, 1.0, 0.0)]
        {
            assert_eq!(sin_deg(degrees), sine);
            assert_eq!(cos_deg(degrees), cosine);
        }
        assert!((sin_deg(30.0) - 0.5).abs() < 1e-15);
        assert!((cos_deg(60.0) - 0.5).abs() < 1e-15);
    }
}
