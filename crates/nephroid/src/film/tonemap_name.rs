use std::fmt;

use super::{Equalization, ToneMap, White};

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
}

/// Comma-separated numbers above zero; none in an empty text.
fn parse_numbers(text: &str) -> Result<Vec<f32>, ToneMapError> {
    let number = |part: &str| match part.trim().parse::<f32>() {
        Ok(v) if v.is_finite() && v > 0.0 => Ok(v),
        _ => Err(ToneMapError::BadNumber { value: part.to_owned() }),
    };
    if text.is_empty() { Ok(Vec::new()) } else { text.split(',').map(number).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

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
