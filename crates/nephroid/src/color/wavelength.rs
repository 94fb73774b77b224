use std::num::NonZeroU16;

use super::Rgb;
use crate::math::real::exp;

/// Steps of a [`Wavelength`] in a nanometre.
const STEPS_PER_NM: f32 = 64.0;

/// A wavelength of light in a vacuum, to 1/64 nm.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Wavelength(NonZeroU16);

impl Wavelength {
    /// The shortest that is seen here, in nm; what lies beyond has less than 0.1 % of any channel.
    pub const SHORTEST_NM: f32 = 390.0;
    /// The longest.
    pub const LONGEST_NM: f32 = 720.0;

    /// The nearest from 1 to 1023 nm.
    pub fn from_nm(nm: f32) -> Self {
        let steps = (nm * STEPS_PER_NM).round().clamp(STEPS_PER_NM, f32::from(u16::MAX));
        Self(NonZeroU16::new(steps as u16).unwrap_or(NonZeroU16::MIN))
    }

    /// In nanometres.
    pub fn nm(self) -> f32 {
        f32::from(self.0.get()) / STEPS_PER_NM
    }

    /// In micrometres, as formulas of glass have it.
    pub fn um(self) -> f32 {
        self.nm() * 1e-3
    }
}

/// What light of one wavelength in nm and a spectral power of one adds to the linear channels of sRGB, on a scale that
/// leaves grey of any spectrum as it is only after each channel is divided by its integral.
///
/// Colours that are purer than any display shows have negative channels; those are zero here, for photons carry no negative
/// power. The observer is CIE 1931 in the fit of Wyman, Sloan and Shirley 2013, *Simple Analytic Approximations to the CIE XYZ
/// Color Matching Functions*, JCGT 2(2), listing 1.
pub fn response(nm: f32) -> Rgb {
    let lobe = |height: f32, middle: f32, below: f32, above: f32| {
        let t = (nm - middle) * if nm < middle { below } else { above };
        height * exp(-0.5 * t * t)
    };
    let x = lobe(0.362, 442.0, 0.0624, 0.0374) + lobe(1.056, 599.8, 0.0264, 0.0323)
        - lobe(0.065, 501.1, 0.0490, 0.0382);
    let y = lobe(0.821, 568.8, 0.0213, 0.0247) + lobe(0.286, 530.9, 0.0613, 0.0322);
    let z = lobe(1.217, 437.0, 0.0845, 0.0278) + lobe(0.681, 459.0, 0.0385, 0.0725);
    // IEC 61966-2-1, from XYZ to linear sRGB.
    let linear = [
        3.240_97 * x - 1.537_383 * y - 0.498_611 * z,
        -0.969_244 * x + 1.875_968 * y + 0.041_555 * z,
        0.055_63 * x - 0.203_977 * y + 1.056_972 * z,
    ];
    Rgb::from(linear.map(|channel| channel.max(0.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wavelengths_keep_their_value_to_a_step() {
        for nm in [390.0f32, 486.133, 587.562, 656.273, 720.0] {
            assert!((Wavelength::from_nm(nm).nm() - nm).abs() <= 0.5 / STEPS_PER_NM, "{nm}");
        }
        assert_eq!(Wavelength::from_nm(f32::NAN).nm(), 1.0 / STEPS_PER_NM);
    }

    #[test]
    fn hues_go_from_violet_to_red() {
        let brightest = |nm: f32| {
            let [r, g, b] = response(nm).to_array();
            if r > g && r > b {
                'r'
            } else if g > b {
                'g'
            } else {
                'b'
            }
        };
        let hues: String = [430.0, 460.0, 520.0, 550.0, 620.0, 680.0].map(brightest).iter().collect();
        assert_eq!(hues, "bbggrr");
        let luminance = |nm: f32| response(nm).luminance();
        assert!(luminance(555.0) > luminance(480.0) && luminance(555.0) > luminance(640.0));
        for nm in [Wavelength::SHORTEST_NM, Wavelength::LONGEST_NM] {
            assert!(response(nm).max_channel() < 0.03, "{nm}: {:?}", response(nm));
        }
    }
}
