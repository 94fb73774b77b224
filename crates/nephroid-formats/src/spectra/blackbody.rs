//! What glows because it is hot.

use super::Spectrum;

/// Second radiation constant h·c/k, in m·K (CODATA 2018).
const SECOND_CONSTANT: f64 = 1.438_776_877e-2;

/// The longest wavelength of the samples.
const LONGEST_NM: f64 = 830.0;

/// The relative spectrum of a black body at `kelvin`, by Planck's law (1900).
pub(crate) fn blackbody(kelvin: f64) -> Spectrum {
    let exponent = |nm: f64| SECOND_CONSTANT / (nm * 1e-9 * kelvin);
    // Relative to the longest, for at low temperatures all is below what a number can be.
    let at_red = exponent(LONGEST_NM);
    let radiance = |nm: f64| {
        let (own, red) = (exponent(nm), libm::expm1(-at_red) / libm::expm1(-exponent(nm)));
        red * libm::exp(at_red - own) / libm::pow(nm / LONGEST_NM, 5.0)
    };
    let pairs = (0..=94).map(|i| 360.0 + 5.0 * f64::from(i)).map(|nm| (nm, radiance(nm))).collect();
    Spectrum::Samples(pairs)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Chromaticities of the Planckian locus (CIE 015:2018; 2856 K is illuminant A: x = 0.4476, y = 0.4074).
    #[test]
    fn illuminant_a_is_a_black_body() {
        let rgb = blackbody(2856.0).colour_of_light().unwrap();
        let (x, y) = (0.4476, 0.4074);
        let expected = super::super::xyz_to_rgb([x / y, 1.0, (1.0 - x - y) / y]);
        for (found, expected) in rgb.to_array().into_iter().zip(expected) {
            assert!((f64::from(found) - expected).abs() < 2e-3, "{rgb:?} {expected:?}");
        }
    }

    #[test]
    fn all_temperatures_have_a_colour() {
        for kelvin in [1.0, 300.0, 1000.0, 6500.0, 1e5, 1e9] {
            let rgb = blackbody(kelvin).colour_of_light().unwrap();
            let luminance = 0.2126 * rgb.r + 0.7152 * rgb.g + 0.0722 * rgb.b;
            assert!(luminance > 0.99 && luminance < 4.0, "{kelvin}: {rgb:?}");
        }
    }
}
