//! Numbers and lists of numbers as scenes write them.

use crate::log::shortened;

/// A finite number that fits a single-precision float.
pub(crate) fn float(text: &str) -> Result<f64, String> {
    let text = text.trim();
    let value: f64 = text.parse().map_err(|_| {
        if text.is_empty() {
            "expected a number, found nothing".to_string()
        } else if text.contains(',') && text.replacen(',', ".", 1).parse::<f64>().is_ok() {
            format!("\"{}\" is not a number: the decimal sign is a point", shortened(text))
        } else {
            format!("\"{}\" is not a number", shortened(text))
        }
    })?;
    if value.is_finite() && (value as f32).is_finite() {
        Ok(value)
    } else {
        Err(format!("\"{}\" is not a finite number of single precision", shortened(text)))
    }
}

/// A whole number.
pub(crate) fn integer(text: &str) -> Result<i64, String> {
    let text = text.trim();
    text.parse().map_err(|_| format!("\"{}\" is not a whole number", shortened(text)))
}

/// `true` or `false`.
pub(crate) fn boolean(text: &str) -> Result<bool, String> {
    match text.trim().to_ascii_lowercase().as_str() {
        "true" => Ok(true),
        "false" => Ok(false),
        _ => Err(format!("\"{}\" is neither true nor false", shortened(text))),
    }
}

/// The words of a list separated by commas or blanks.
pub(crate) fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| c == ',' || c.is_whitespace()).filter(|word| !word.is_empty())
}

/// A list of numbers separated by commas or blanks.
pub(crate) fn floats(text: &str) -> Result<Vec<f64>, String> {
    words(text).map(float).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spellings_of_numbers() {
        assert_eq!(float(" 4.37114e-008 "), Ok(4.37114e-8));
        assert_eq!(float(".2"), Ok(0.2));
        assert_eq!(float("1,5"), Err("\"1,5\" is not a number: the decimal sign is a point".into()));
        assert!(float("nan").is_err() && float("inf").is_err() && float("1e39").is_err());
        assert!(integer("1.0").is_err() && integer("99999999999999999999").is_err());
        assert_eq!(integer("-3"), Ok(-3));
        assert_eq!(floats("1, 2 3,\n4"), Ok(vec![1.0, 2.0, 3.0, 4.0]));
    }
}
