//! What glows because it is hot.

use super::Spectrum;
use super::cie1931::LAST_NM;

/// Second radiation constant h·c/k, in m·K (CODATA 2018).
const SECOND_CONSTANT: f64 = 1.438_776_877e-2;

/// First radiation constant of radiance, 2·h·c², in W·m²/sr (CODATA 2018).
const FIRST_CONSTANT: f64 = 1.191_042_972e-16;

/// The relative spectrum of a black body at `kelvin`, by Planck's law (1900).
pub(crate) fn blackbody(kelvin: f64) -> Spectrum {
    let exponent = |nm: f64| SECOND_CONSTANT / (nm * 1e-9 * kelvin);
    // Relative to the longest, for at low temperatures all is below what a number can be.
    let at_red = exponent(LAST_NM);
    let radiance = |nm: f64| {
        let (own, red) = (exponent(nm), libm::expm1(-at_red) / libm::expm1(-exponent(nm)));
        red * libm::exp(at_red - own) / libm::pow(nm / LAST_NM, 5.0)
    };
    let pairs = (0..=94).map(|i| 360.0 + 5.0 * f64::from(i)).map(|nm| (nm, radiance(nm))).collect();
    Spectrum::Samples(pairs)
}

/// What a black body at `kelvin` radiates from one wavelength in nm to another, in W/(m²·sr·nm), by Planck's law.
pub(crate) fn thermal_radiance(kelvin: f64, [from, to]: [f64; 2]) -> Spectrum {
    let radiance = |nm: f64| {
        let metres = nm * 1e-9;
        1e-9 * FIRST_CONSTANT / (libm::pow(metres, 5.0) * libm::expm1(SECOND_CONSTANT / (metres * kelvin)))
    };
    let place = |i: u32| from + (to - from) * f64::from(i) / 94.0;
    Spectrum::Samples((0..=94).map(place).map(|nm| (nm, radiance(nm))).collect())
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

    /// Wien: the most at 2897.77 µm·K over the temperature; Stefan and Boltzmann: σT⁴/π of all wavelengths.
    #[test]
    fn hot_bodies_radiate_as_laws_have_it() {
        let total = |kelvin: f64| {
            let mut sum = 0.0;
            for k in 0..400 {
                let edge = |i: i32| 20.0 * libm::exp2(f64::from(i) / 20.0);
                let Spectrum::Samples(pairs) = thermal_radiance(kelvin, [edge(k), edge(k + 1)]) else {
                    panic!("no samples");
                };
                sum += pairs.windows(2).map(|w| 0.5 * (w[0].1 + w[1].1) * (w[1].0 - w[0].0)).sum::<f64>();
            }
            sum
        };
        for kelvin in [1000.0, 5000.0, 20_000.0] {
            let law = 5.670_374_419e-8 * kelvin * kelvin * kelvin * kelvin / std::f64::consts::PI;
            assert!((total(kelvin) / law - 1.0).abs() < 1e-4, "{kelvin}: {} of {law}", total(kelvin));
        }
        let Spectrum::Samples(pairs) = thermal_radiance(5000.0, [360.0, 830.0]) else { panic!("no samples") };
        let brightest = pairs.iter().fold((0.0, 0.0), |a, b| if b.1 > a.1 { *b } else { a });
        assert!((brightest.0 - 579.55).abs() <= 2.5, "{brightest:?}");
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
