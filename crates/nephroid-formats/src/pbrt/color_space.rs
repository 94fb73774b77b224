//! The colour spaces that numbers of a colour can be in.

use nephroid::color::Rgb;
use nephroid::math::{DMat3, DVec3};

use crate::spectra::xyz_to_rgb;

/// Primaries and white of a colour.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum ColorSpace {
    /// IEC 61966-2-1.
    #[default]
    Srgb,
    /// SMPTE RP 431-2 with the white D65.
    DciP3,
    /// ITU-R BT.2020.
    Rec2020,
    /// SMPTE ST 2065-1.
    Aces,
}

/// Every space by its name.
pub(super) const COLOR_SPACES: [(&str, ColorSpace); 4] = [
    ("srgb", ColorSpace::Srgb),
    ("dci-p3", ColorSpace::DciP3),
    ("rec2020", ColorSpace::Rec2020),
    ("aces2065-1", ColorSpace::Aces),
];

/// XYZ of chromaticities, at luminance one.
pub(super) fn xyz_of([x, y]: [f64; 2]) -> DVec3 {
    DVec3::new(x / y, 1.0, (1.0 - x - y) / y)
}

impl ColorSpace {
    /// The chromaticities of red, green, blue and white.
    fn chromaticities(self) -> [[f64; 2]; 4] {
        const D65: [f64; 2] = [0.3127, 0.3290];
        match self {
            Self::Srgb => [[0.64, 0.33], [0.30, 0.60], [0.15, 0.06], D65],
            Self::DciP3 => [[0.680, 0.320], [0.265, 0.690], [0.150, 0.060], D65],
            Self::Rec2020 => [[0.708, 0.292], [0.170, 0.797], [0.131, 0.046], D65],
            Self::Aces => [[0.7347, 0.2653], [0.0, 1.0], [0.0001, -0.077], [0.32168, 0.33767]],
        }
    }

    /// The same colour in linear sRGB; what that cannot show is cut off at zero.
    pub(super) fn to_srgb(self, rgb: [f64; 3]) -> Rgb {
        if self == Self::Srgb {
            return Rgb::from(rgb.map(|v| v as f32));
        }
        let [r, g, b, white] = self.chromaticities().map(xyz_of);
        let primaries = DMat3::from_cols(r, g, b);
        // Luminances of the primaries, so that (1, 1, 1) is white.
        let weights = primaries.inverse() * white;
        let xyz = primaries * (weights * DVec3::from(rgb));
        Rgb::from(xyz_to_rgb(xyz.to_array()).map(|v| v.max(0.0) as f32))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_of_d65_is_white_and_wide_colours_are_cut() {
        for space in [ColorSpace::DciP3, ColorSpace::Rec2020] {
            let white = space.to_srgb([1.0; 3]);
            assert!((white - Rgb::WHITE).map(f32::abs).max_channel() < 2e-3, "{space:?}: {white:?}");
        }
        let red = ColorSpace::Rec2020.to_srgb([1.0, 0.0, 0.0]);
        assert!(red.r > 1.5 && red.g == 0.0, "{red:?}");
        // The white of ACES, D60, is warmer than D65.
        let white = ColorSpace::Aces.to_srgb([1.0; 3]);
        assert!(white.r > 1.02 && white.b < 0.93, "{white:?}");
    }
}
