//! Spectra and the colours they become.

use nephroid::color::Rgb;

use super::cie1931::{D65, FIRST_NM, OBSERVER, STEP_NM};
use crate::log::shortened;
use crate::number::{float, floats, words};

/// Width of the steps in which a spectrum is integrated.
const INTEGRATION_STEP_NM: f64 = 0.5;
/// XYZ to linear RGB with the primaries and the white of sRGB (IEC 61966-2-1).
const XYZ_TO_RGB: [[f64; 3]; 3] = [
    [3.240_479, -1.537_150, -0.498_535],
    [-0.969_256, 1.875_991, 0.041_556],
    [0.055_648, -0.204_043, 1.057_311],
];

/// What a colour is for. It decides how a spectrum turns into RGB.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Role {
    /// Multiplies light: seen under D65, and clamped to [0, 1].
    Reflectance,
    /// Is light: seen as it is.
    Emission,
    /// An index of refraction: seen under D65, and not clamped from above.
    Index,
    /// A number of a texture, such as a height: also below zero.
    Number,
}

/// A value for each wavelength.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Spectrum {
    /// The same for all.
    Uniform(f64),
    /// Linear between at least two (wavelength in nm, value), and zero outside.
    Samples(Vec<(f64, f64)>),
}

impl Spectrum {
    /// From an attribute: one number, or `wavelength:value` pairs.
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        if !text.contains(':') {
            return match floats(text)?.as_slice() {
                [value] => Ok(Self::Uniform(*value)),
                [_, _, _] => Err(format!(
                    "three numbers are not a spectrum; write <rgb … value=\"{}\"/>",
                    shortened(text.trim())
                )),
                list => Err(format!(
                    "expected one number or wavelength:value pairs, found {} numbers",
                    list.len()
                )),
            };
        }
        let pairs = words(text)
            .map(|word| match word.split_once(':') {
                Some((wavelength, value)) => Ok((float(wavelength)?, float(value)?)),
                None => Err(format!("\"{}\" is not a wavelength:value pair", shortened(word))),
            })
            .collect::<Result<Vec<_>, _>>()?;
        Self::samples(pairs)
    }

    /// From the text of a `.spd` file: a wavelength and a value in each line, `#` for comments.
    pub(crate) fn parse_file(text: &str) -> Result<Self, String> {
        let mut pairs = Vec::new();
        for (number, line) in (1..).zip(text.lines()) {
            let line = line.split('#').next().unwrap_or_default();
            let list = floats(line).map_err(|e| format!("line {number}: {e}"))?;
            match list.as_slice() {
                [] => {}
                [wavelength, value] => pairs.push((*wavelength, *value)),
                _ => return Err(format!("line {number}: expected a wavelength and a value")),
            }
        }
        Self::samples(pairs)
    }

    /// The colour of it as light whose luminance is one; `None` if it has none.
    pub(crate) fn colour_of_light(&self) -> Option<Rgb> {
        let xyz = match self {
            Self::Uniform(value) => [*value; 3],
            Self::Samples(pairs) => integrate(pairs, false),
        };
        let rgb = xyz_to_rgb(xyz).map(|v| (v / xyz[1]).max(0.0) as f32);
        (xyz[1] > 0.0).then(|| Rgb::from(rgb)).filter(|rgb| rgb.is_finite())
    }

    /// Linear between pairs of a wavelength in nm and a value.
    pub(crate) fn samples(pairs: Vec<(f64, f64)>) -> Result<Self, String> {
        if pairs.len() < 2 {
            return Err("a spectrum needs at least two wavelengths".to_string());
        }
        if let Some(pair) = pairs.windows(2).find(|pair| pair[1].0 <= pair[0].0) {
            return Err(format!("wavelength {} stands after {}; they must increase", pair[1].0, pair[0].0));
        }
        Ok(Self::Samples(pairs))
    }

    /// The colour that the standard observer sees, normalised so that a value of one everywhere has
    /// luminance one. As Mitsuba does in its RGB modes, light is taken as it is (equal energy is
    /// slightly red), and what multiplies light is seen under D65 (equal reflection is white).
    pub(crate) fn to_rgb(&self, role: Role) -> Rgb {
        let xyz = match (self, role) {
            (Self::Uniform(value), Role::Emission) => [*value; 3],
            (Self::Uniform(value), _) => return Rgb::splat(*value as f32),
            (Self::Samples(pairs), _) => integrate(pairs, role != Role::Emission),
        };
        let rgb = Rgb::from(xyz_to_rgb(xyz).map(|v| v.max(0.0) as f32));
        if role == Role::Reflectance { rgb.map(|v| v.min(1.0)) } else { rgb }
    }
}

/// XYZ to linear sRGB; what that cannot show has a negative channel.
pub(crate) fn xyz_to_rgb(xyz: [f64; 3]) -> [f64; 3] {
    XYZ_TO_RGB.map(|row| row[0] * xyz[0] + row[1] * xyz[1] + row[2] * xyz[2])
}

/// XYZ of samples, by the trapezoidal rule.
fn integrate(pairs: &[(f64, f64)], under_d65: bool) -> [f64; 3] {
    let light = |wavelength: f64| if under_d65 { lookup(&D65, wavelength, |v| *v) } else { 1.0 };
    let last_nm = FIRST_NM + STEP_NM * (OBSERVER.len() - 1) as f64;
    let steps = ((last_nm - FIRST_NM) / INTEGRATION_STEP_NM) as usize;
    let (mut sum, mut white) = ([0.0; 3], 0.0);
    let mut interval = 0;
    for step in 0..=steps {
        let wavelength = FIRST_NM + step as f64 * INTEGRATION_STEP_NM;
        let weight = light(wavelength) * if step == 0 || step == steps { 0.5 } else { 1.0 };
        let observer = [0, 1, 2].map(|i| weight * lookup(&OBSERVER, wavelength, |v| v[i]));
        white += observer[1];
        if wavelength < pairs[0].0 || wavelength > pairs[pairs.len() - 1].0 {
            continue;
        }
        while interval + 2 < pairs.len() && wavelength > pairs[interval + 1].0 {
            interval += 1;
        }
        let ((x0, y0), (x1, y1)) = (pairs[interval], pairs[interval + 1]);
        let value = y0 + (y1 - y0) * ((wavelength - x0) / (x1 - x0));
        for i in 0..3 {
            sum[i] += observer[i] * value;
        }
    }
    sum.map(|v| v / white)
}

/// Linear in a table, zero outside.
fn lookup<T>(table: &[T], wavelength: f64, value: impl Fn(&T) -> f64) -> f64 {
    let place = (wavelength - FIRST_NM) / STEP_NM;
    let last = (table.len() - 1) as f64;
    if !(0.0..=last).contains(&place) {
        return 0.0;
    }
    let index = (place as usize).min(table.len() - 2);
    let t = place - index as f64;
    value(&table[index]) * (1.0 - t) + value(&table[index + 1]) * t
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(spectrum: &str, role: Role, expected: [f32; 3], tolerance: f32) {
        let rgb = Spectrum::parse(spectrum).unwrap().to_rgb(role).to_array();
        for (value, expected) in rgb.iter().zip(expected) {
            assert!((value - expected).abs() <= tolerance, "{spectrum}: {rgb:?}");
        }
    }

    #[test]
    fn light_and_reflectance_as_mitsuba_has_them() {
        let lamp = "400:0, 500:8, 600:15.6, 700:18.4";
        near(lamp, Role::Emission, [20.71, 10.85, 2.77], 0.006);
        near("400:0, 500:2, 600:3.9, 700:4.6", Role::Emission, [5.178, 2.714, 0.693], 0.001);
        // Mitsuba's constant for D65 is a thousandth too large; here equal reflection keeps its value.
        let white = "400:0.78, 500:0.78, 600:0.78, 700:0.78";
        near(white, Role::Reflectance, [0.776, 0.780, 0.776], 0.0015);
    }

    #[test]
    fn equal_energy_is_reddish_and_equal_reflection_is_not() {
        near("1", Role::Emission, [1.2048, 0.9483, 0.9089], 1e-3);
        near("300:1 900:1", Role::Emission, [1.2048, 0.9483, 0.9089], 1e-3);
        near("0.5", Role::Reflectance, [0.5; 3], 0.0);
        near("300:2 900:2", Role::Reflectance, [1.0; 3], 0.0);
        near("300:2 900:2", Role::Index, [2.0; 3], 2e-3);
    }

    #[test]
    fn what_is_no_spectrum() {
        assert!(Spectrum::parse("1, 2, 3").unwrap_err().contains("<rgb"));
        assert!(Spectrum::parse("500:1, 400:1").unwrap_err().contains("must increase"));
        assert!(Spectrum::parse("500:1").is_err());
        assert!(Spectrum::parse("500:1 600").is_err());
        assert_eq!(
            Spectrum::parse_file("# nm\n400 1\n\n500\t2 # b\r\n").unwrap(),
            Spectrum::Samples(vec![(400.0, 1.0), (500.0, 2.0)])
        );
        assert!(Spectrum::parse_file("400 1\n500").unwrap_err().starts_with("line 2"));
    }
}
