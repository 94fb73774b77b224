//! The transfer curve of sRGB (IEC 61966-2-1).

use crate::math::real::pow;

/// Linear value to sRGB-encoded, both nominally in [0, 1].
#[inline]
pub fn encode(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * pow(linear, 1.0 / 2.4) - 0.055 }
}

/// sRGB-encoded value to linear.
#[inline]
pub fn decode(encoded: f32) -> f32 {
    if encoded <= 0.040_45 { encoded / 12.92 } else { pow((encoded + 0.055) / 1.055, 2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curves_are_inverse() {
        for i in 0..=255 {
            let v = i as f32 / 255.0;
            assert!((encode(decode(v)) - v).abs() < 1e-5);
        }
        assert!((decode(0.5) - 0.214_041_14).abs() < 1e-6);
    }
}
