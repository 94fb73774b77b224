use std::fmt;

use crate::color::{Rgb, srgb};
use crate::texture::Image;

/// How radiance becomes a picture for a display.
///
/// [`ToneMap::apply`] first multiplies by 2^exposure. Then one factor per pixel, found from its
/// luminance L, scales all three channels, so hues stay. The result is linear display light, which
/// is clipped to [0, 1] and encoded with a transfer curve per channel: the gamma operators bring
/// their own, `Linear` has none, and all others get the curve of sRGB.
///
/// The operators are those of the 2019 report, section 2.5, in a form that does what its text
/// says; `Linear` and `Srgb` are added.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ToneMap {
    /// min(L, value).
    Clamp {
        /// The largest luminance left, in W/(m²·sr) after exposure.
        value: f32,
    },
    /// The largest luminance becomes 1.
    Equalize(Equalization),
    /// Luminances are clamped to `value`, then the largest that is left becomes 1.
    EqualizeClamp {
        /// The largest luminance left before scaling.
        value: f32,
    },
    /// [`ToneMap::Equalize`] with v^(1/gamma) as the transfer curve. (The report takes the power
    /// of the luminance alone; as the display undoes it per channel, that would distort hues.)
    Gamma {
        /// Exponent of the display.
        gamma: f32,
    },
    /// [`ToneMap::EqualizeClamp`] with v^(1/gamma) as the transfer curve.
    ClampGamma {
        /// The largest luminance left before scaling.
        value: f32,
        /// Exponent of the display.
        gamma: f32,
    },
    /// The global operator of Reinhard, Stark, Shirley and Ferwerda, *Photographic Tone
    /// Reproduction for Digital Images* (2002), equations 2 and 4.
    Reinhard {
        /// The display luminance that the log-average is moved to.
        key: f32,
        /// What becomes white.
        white: White,
    },
    /// Clipped to [0, 1] and not encoded: the file's numbers are radiances.
    Linear,
    /// Clipped to [0, 1] and encoded with the curve of sRGB (IEC 61966-2-1).
    Srgb,
}

/// What luminance is divided by to equalise a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Equalization {
    /// The largest luminance.
    #[default]
    Maximum,
    /// As printed in the 2019 report: the largest less the smallest. The result exceeds 1 wherever
    /// nothing is black. A flat picture is divided by its luminance instead.
    Report,
}

/// The luminance that [`ToneMap::Reinhard`] shows as pure white.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum White {
    /// In scaled units: as a multiple of (log-average luminance / key).
    Manual(f32),
    /// The largest in the picture.
    #[default]
    Automatic,
}

impl Default for ToneMap {
    fn default() -> Self {
        Self::Reinhard { key: 0.18, white: White::Automatic }
    }
}

/// Why a text does not name a tone map.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ToneMapError {
    /// No operator of this name.
    #[error("there is no tone map {name:?}; there are {}", Names)]
    UnknownName {
        /// As given.
        name: String,
    },
    /// A parameter that is not a number above zero.
    #[error("{value:?} is not a parameter for a tone map: a number above zero is")]
    BadNumber {
        /// As given.
        value: String,
    },
    /// More parameters than the operator has.
    #[error("the tone map {name:?} takes at most {most} parameters")]
    TooManyNumbers {
        /// The operator.
        name: String,
        /// What it takes.
        most: usize,
    },
}

/// The list of [`ToneMap::USAGE`] in a sentence.
struct Names;

impl fmt::Display for Names {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&ToneMap::USAGE.join(", "))
    }
}

impl ToneMap {
    /// What [`ToneMap::parse`] understands, with the parameters that may follow.
    pub const USAGE: [&'static str; 9] = [
        "clamp[:VALUE]",
        "equalize",
        "equalize-report",
        "equalize-clamp[:VALUE]",
        "gamma[:GAMMA]",
        "clamp-gamma[:VALUE[,GAMMA]]",
        "reinhard[:KEY[,WHITE]]",
        "linear",
        "srgb",
    ];

    /// The operator of that name, as in `reinhard`, `gamma:2.4` or `clamp-gamma:10,2.2`. Values
    /// are 1, gammas 2.2 and the key 0.18 unless given; without WHITE it is automatic.
    pub fn parse(text: &str) -> Result<Self, ToneMapError> {
        let (name, parameters) = text.split_once(':').unwrap_or((text, ""));
        let numbers = parse_numbers(parameters)?;
        let number = |i: usize, default: f32| numbers.get(i).copied().unwrap_or(default);
        let (operator, most) = match name {
            "clamp" => (Self::Clamp { value: number(0, 1.0) }, 1),
            "equalize" => (Self::Equalize(Equalization::Maximum), 0),
            "equalize-report" => (Self::Equalize(Equalization::Report), 0),
            "equalize-clamp" => (Self::EqualizeClamp { value: number(0, 1.0) }, 1),
            "gamma" => (Self::Gamma { gamma: number(0, 2.2) }, 1),
            "clamp-gamma" => (Self::ClampGamma { value: number(0, 1.0), gamma: number(1, 2.2) }, 2),
            "reinhard" => {
                let white = numbers.get(1).map_or(White::Automatic, |&w| White::Manual(w));
                (Self::Reinhard { key: number(0, 0.18), white }, 2)
            }
            "linear" => (Self::Linear, 0),
            "srgb" => (Self::Srgb, 0),
            _ => return Err(ToneMapError::UnknownName { name: name.to_owned() }),
        };
        if numbers.len() > most {
            return Err(ToneMapError::TooManyNumbers { name: name.to_owned(), most });
        }
        Ok(operator)
    }

    /// The picture of `image`, brightened by `exposure_stops`, as encoded display values in [0, 1].
    ///
    /// NaN becomes black and infinity white; neither counts in a picture's maximum or average.
    pub fn apply(&self, image: &Image, exposure_stops: f32) -> Image {
        let exposure = libm::exp2(f64::from(exposure_stops));
        let luminance = |p: Rgb| (f64::from(p.luminance()) * exposure).max(0.0);
        let scale = self.scale(&Luminances::of(image.pixels.iter().map(|&p| luminance(p))));
        let curve = self.curve();
        let pixels = image.pixels.iter().map(|&p| {
            let factor = scale.at(luminance(p)) * exposure;
            p.map(|v| curve.encode(clip(f64::from(v) * factor)))
        });
        Image { width: image.width, height: image.height, pixels: pixels.collect() }
    }

    fn scale(&self, l: &Luminances) -> Scale {
        let reciprocal = |l: f64| if l > 0.0 { 1.0 / l } else { 1.0 };
        let clamped = |value: f32| {
            let value = f64::from(value);
            Scale::Clamped { value, factor: reciprocal(l.max.min(value)) }
        };
        match *self {
            Self::Linear | Self::Srgb => Scale::Constant(1.0),
            Self::Clamp { value } => Scale::Clamped { value: f64::from(value), factor: 1.0 },
            Self::Equalize(Equalization::Report) if l.max > l.min => {
                Scale::Constant(reciprocal(l.max - l.min))
            }
            Self::Equalize(_) | Self::Gamma { .. } => Scale::Constant(reciprocal(l.max)),
            Self::EqualizeClamp { value } | Self::ClampGamma { value, .. } => clamped(value),
            Self::Reinhard { key, white } => {
                let to_scaled = f64::from(key) * reciprocal(l.log_average);
                let white = match white {
                    White::Manual(white) => f64::from(white),
                    White::Automatic => l.max * to_scaled,
                };
                Scale::Reinhard { to_scaled, per_white_sq: reciprocal(white * white) }
            }
        }
    }

    fn curve(&self) -> Curve {
        match *self {
            Self::Linear => Curve::None,
            Self::Gamma { gamma } | Self::ClampGamma { gamma, .. } => Curve::Power(1.0 / gamma),
            _ => Curve::Srgb,
        }
    }
}

/// To [0, 1]; NaN to 0.
fn clip(v: f64) -> f32 {
    if v > 0.0 { v.min(1.0) as f32 } else { 0.0 }
}

/// Comma-separated numbers above zero; none in an empty text.
fn parse_numbers(text: &str) -> Result<Vec<f32>, ToneMapError> {
    let number = |part: &str| match part.trim().parse::<f32>() {
        Ok(v) if v.is_finite() && v > 0.0 => Ok(v),
        _ => Err(ToneMapError::BadNumber { value: part.to_owned() }),
    };
    if text.is_empty() { Ok(Vec::new()) } else { text.split(',').map(number).collect() }
}

/// What an operator needs to know of the whole picture. All zero for one without finite pixels.
#[derive(Debug, Default)]
struct Luminances {
    min: f64,
    max: f64,
    /// exp of the mean logarithm. The paper's δ against log 0 is 1e-6 of the maximum, so that the
    /// average scales with the picture.
    log_average: f64,
}

impl Luminances {
    fn of(luminances: impl Iterator<Item = f64> + Clone) -> Self {
        let finite = luminances.filter(|l| l.is_finite());
        let (min, max) = finite.clone().fold((f64::INFINITY, 0.0f64), |(a, b), l| (a.min(l), b.max(l)));
        if max <= 0.0 {
            return Self::default();
        }
        let (mut sum, mut count) = (0.0, 0.0);
        for l in finite {
            sum += libm::log(1e-6 * max + l);
            count += 1.0;
        }
        Self { min, max, log_average: libm::exp(sum / count) }
    }
}

/// The factor for a pixel as a function of its luminance.
enum Scale {
    Constant(f64),
    /// factor · min(L, value) / L.
    Clamped {
        value: f64,
        factor: f64,
    },
    /// With s = to_scaled · L: to_scaled · (1 + s·per_white_sq) / (1 + s).
    Reinhard {
        to_scaled: f64,
        per_white_sq: f64,
    },
}

impl Scale {
    fn at(&self, luminance: f64) -> f64 {
        match *self {
            Self::Constant(factor) => factor,
            // An infinite luminance stays one, and is clipped to white.
            _ if luminance.is_infinite() => 1.0,
            Self::Clamped { value, factor } => {
                if luminance > value {
                    factor * value / luminance
                } else {
                    factor
                }
            }
            Self::Reinhard { to_scaled, per_white_sq } => {
                let scaled = luminance * to_scaled;
                to_scaled * (1.0 + scaled * per_white_sq) / (1.0 + scaled)
            }
        }
    }
}

/// The transfer curve of a display, from linear light in [0, 1].
enum Curve {
    None,
    Power(f32),
    Srgb,
}

impl Curve {
    fn encode(&self, linear: f32) -> f32 {
        match *self {
            Self::None => linear,
            Self::Power(exponent) => crate::math::real::pow(linear, exponent),
            // In single precision 1.055 − 0.055 is less than 1.
            Self::Srgb if linear >= 1.0 => 1.0,
            Self::Srgb => srgb::encode(linear),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn greys(values: &[f32]) -> Image {
        let pixels = values.iter().map(|&v| Rgb::splat(v)).collect();
        Image { width: values.len() as u32, height: 1, pixels }
    }

    /// The linear display values for grey pixels.
    fn display(operator: ToneMap, values: &[f32]) -> Vec<f32> {
        let out = operator.apply(&greys(values), 0.0);
        out.pixels.iter().map(|p| srgb::decode(p.g)).collect()
    }

    #[track_caller]
    fn assert_close(found: &[f32], expected: &[f32]) {
        assert_eq!(found.len(), expected.len());
        for (f, e) in found.iter().zip(expected) {
            assert!((f - e).abs() < 2e-5, "{found:?} is not {expected:?}");
        }
    }

    /// Every operator with parameters of its own.
    fn operators() -> [ToneMap; 10] {
        [
            ToneMap::Clamp { value: 0.5 },
            ToneMap::Equalize(Equalization::Maximum),
            ToneMap::Equalize(Equalization::Report),
            ToneMap::EqualizeClamp { value: 2.0 },
            ToneMap::Gamma { gamma: 2.2 },
            ToneMap::ClampGamma { value: 2.0, gamma: 2.2 },
            ToneMap::Reinhard { key: 0.18, white: White::Automatic },
            ToneMap::Reinhard { key: 0.5, white: White::Manual(1.5) },
            ToneMap::Linear,
            ToneMap::Srgb,
        ]
    }

    #[test]
    fn clamping_and_equalising() {
        assert_close(&display(ToneMap::Clamp { value: 0.5 }, &[0.25, 0.75]), &[0.25, 0.5]);
        let equalize = |e| ToneMap::Equalize(e);
        assert_close(&display(equalize(Equalization::Maximum), &[1.0, 2.0, 5.0]), &[0.2, 0.4, 1.0]);
        // The printed formula divides by 5 − 1, so that 5 would become 1.25.
        assert_close(&display(equalize(Equalization::Report), &[1.0, 2.0, 5.0]), &[0.25, 0.5, 1.0]);
        let both = ToneMap::EqualizeClamp { value: 2.0 };
        assert_close(&display(both, &[0.5, 1.0, 9.0]), &[0.25, 0.5, 1.0]);
        assert_close(&display(both, &[0.5, 1.0]), &[0.5, 1.0]);
    }

    #[test]
    fn gamma_is_the_curve() {
        let out = ToneMap::Gamma { gamma: 2.0 }.apply(&greys(&[1.0, 4.0]), 0.0);
        assert_close(&[out.pixels[0].r, out.pixels[1].r], &[0.5, 1.0]);
        let out = ToneMap::ClampGamma { value: 4.0, gamma: 2.0 }.apply(&greys(&[1.0, 40.0]), 0.0);
        assert_close(&[out.pixels[0].r, out.pixels[1].r], &[0.5, 1.0]);
    }

    #[test]
    fn reinhard_with_hand_computed_numbers() {
        // The log-average of 1, 2 and 4 is 2 (the printed formula gives 8/3); key 0.5 scales them
        // to 0.25, 0.5 and 1. With white 2: s(1 + s/4)/(1 + s) = 0.2125, 0.375, 0.625.
        let manual = ToneMap::Reinhard { key: 0.5, white: White::Manual(2.0) };
        assert_close(&display(manual, &[1.0, 2.0, 4.0]), &[0.2125, 0.375, 0.625]);
        // Automatically white is 1: 0.25, 0.5 and 1.
        let automatic = ToneMap::Reinhard { key: 0.5, white: White::Automatic };
        assert_close(&display(automatic, &[1.0, 2.0, 4.0]), &[0.25, 0.5, 1.0]);
    }

    #[test]
    fn reinhard_depends_neither_on_the_number_of_pixels_nor_on_the_unit() {
        let operator = ToneMap::default();
        let values = [0.0, 0.1, 3.0, 7.0];
        let once = display(operator, &values);
        let twice = display(operator, &[0.0, 0.1, 3.0, 7.0, 0.0, 0.1, 3.0, 7.0]);
        assert_close(&twice[..4], &once);
        for unit in [1e-20, 1e20] {
            assert_close(&display(operator, &values.map(|v| v * unit)), &once);
        }
    }

    #[test]
    fn luminance_is_mapped_and_hue_is_kept() {
        let pixels = vec![Rgb::new(0.2, 0.05, 0.1), Rgb::splat(0.4)];
        let image = Image { width: 2, height: 1, pixels };
        for operator in operators() {
            let out = operator.apply(&image, 0.0).pixels[0];
            let linear = match operator {
                ToneMap::Linear => out,
                ToneMap::Gamma { gamma } | ToneMap::ClampGamma { gamma, .. } => {
                    out.map(|v| crate::math::real::pow(v, gamma))
                }
                _ => out.map(srgb::decode),
            };
            assert!((linear.r / linear.g - 4.0).abs() < 1e-3, "{operator:?}: {linear:?}");
            assert!((linear.b / linear.g - 2.0).abs() < 1e-3, "{operator:?}: {linear:?}");
        }
    }

    #[test]
    fn exposure_doubles_light_per_stop() {
        let out = ToneMap::Linear.apply(&greys(&[0.1]), 2.0);
        assert_close(&[out.pixels[0].r], &[0.4]);
        let clamped = ToneMap::Clamp { value: 0.5 }.apply(&greys(&[0.1, 0.2]), 2.0);
        assert_close(&clamped.pixels.iter().map(|p| srgb::decode(p.r)).collect::<Vec<_>>(), &[0.4, 0.5]);
    }

    #[test]
    fn every_operator_is_monotonic_in_luminance_and_stays_in_range() {
        let values: Vec<f32> = (0..400).map(|i| 0.01 * i as f32).collect();
        for operator in operators() {
            let out = operator.apply(&greys(&values), 0.5);
            // Where clamping makes a plateau, rounding may ripple it.
            assert!(out.pixels.windows(2).all(|w| w[0].g <= w[1].g + 2e-7), "{operator:?}");
            assert!(out.pixels.iter().all(|p| p.min_channel() >= 0.0 && p.max_channel() <= 1.0));
            assert!(out.pixels[399].g > 0.7, "{operator:?}: {:?}", out.pixels[399]);
        }
    }

    #[test]
    fn black_flat_and_broken_pictures_are_shown() {
        for operator in operators() {
            for values in [&[][..], &[0.0, 0.0], &[-1.0], &[f32::NAN, 0.0]] {
                let out = operator.apply(&greys(values), 0.0);
                assert!(out.pixels.iter().all(|p| p.is_black()), "{operator:?} of {values:?}");
            }
            let flat = operator.apply(&greys(&[3.0, 3.0]), 0.0).pixels[0];
            assert!(flat.g > 0.1 && flat.g <= 1.0, "{operator:?}: {flat:?}");
            let infinite = operator.apply(&greys(&[0.0, 3.0, f32::INFINITY]), 0.0);
            assert_eq!(infinite.pixels[2], Rgb::WHITE, "{operator:?}");
            assert_eq!(infinite.pixels[1], operator.apply(&greys(&[0.0, 3.0]), 0.0).pixels[1]);
        }
        assert_close(&display(ToneMap::Equalize(Equalization::Report), &[3.0, 3.0]), &[1.0, 1.0]);
    }

    #[test]
    fn names_and_parameters() {
        for usage in ToneMap::USAGE {
            let name = usage.split('[').next().unwrap();
            assert!(ToneMap::parse(name).is_ok(), "{name}");
        }
        assert_eq!(ToneMap::parse("reinhard"), Ok(ToneMap::default()));
        let manual = ToneMap::Reinhard { key: 0.2, white: White::Manual(1.5) };
        assert_eq!(ToneMap::parse("reinhard:0.2,1.5"), Ok(manual));
        assert_eq!(ToneMap::parse("clamp-gamma:4"), Ok(ToneMap::ClampGamma { value: 4.0, gamma: 2.2 }));
        let message = |text: &str| ToneMap::parse(text).unwrap_err().to_string();
        assert!(message("filmic").starts_with("there is no tone map \"filmic\"; there are clamp[:VALUE], "));
        assert!(message("gamma:0").starts_with("\"0\" is not a parameter"));
        assert!(message("clamp:NaN").contains("NaN"));
        assert_eq!(message("srgb:1"), "the tone map \"srgb\" takes at most 0 parameters");
    }
}
