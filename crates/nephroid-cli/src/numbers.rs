//! Numbers in sentences and tables.

/// Digits in groups of three.
pub fn grouped(n: u64) -> String {
    let digits = n.to_string();
    let mut out = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push(',');
        }
        out.push(digit);
    }
    out
}

/// Six digits, and zero as zero.
pub fn power(watts: f64) -> String {
    match watts.abs() {
        0.0 => "0".to_owned(),
        size if (1e-3..1e6).contains(&size) => format!("{watts:.6}").chars().take(9).collect(),
        _ => format!("{watts:.3e}"),
    }
}

/// Three digits, without zeros at the end.
pub fn three_digits(value: f64) -> String {
    // A number that was written is one to read.
    format!("{value:.2e}").parse().unwrap_or(value).to_string()
}

/// A number of things.
pub fn plural(n: u64, noun: &str) -> String {
    match (n, noun) {
        (1, _) => format!("1 {noun}"),
        (_, "pass") => format!("{n} passes"),
        _ => format!("{n} {noun}s"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_easy_to_read() {
        assert_eq!([0, 999, 1000, 1_234_567].map(grouped), ["0", "999", "1,000", "1,234,567"]);
        assert_eq!([0.0, 12.5, -1e-9].map(power), ["0", "12.500000", "-1.000e-9"]);
        assert_eq!([0.012_345, 0.5, 1234.0].map(three_digits), ["0.0123", "0.5", "1230"]);
        assert_eq!(
            [plural(1, "pass"), plural(2, "pass"), plural(3, "thread")],
            ["1 pass", "2 passes", "3 threads"]
        );
    }
}
