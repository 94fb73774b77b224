//! Numbers as people read them.

/// Four significant digits; powers of ten where there would be many zeros.
pub fn number(value: f64) -> String {
    rounded(value, 4)
}

/// So many significant digits.
pub fn rounded(value: f64, significant: i32) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if !value.is_finite() {
        return value.to_string();
    }
    let magnitude = libm::floor(libm::log10(value.abs())) as i32;
    if (-4..7).contains(&magnitude) {
        let digits = (significant - 1 - magnitude).max(0) as usize;
        let text = format!("{value:.digits$}");
        let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
        return text.replace('-', "−");
    }
    let text = format!("{value:.2e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let mantissa = mantissa.trim_end_matches('0').trim_end_matches('.');
    format!("{} · 10{}", mantissa.replace('-', "−"), superscript(exponent))
}

/// Digits and signs, raised.
pub fn superscript(text: &str) -> String {
    let raised = |c: char| match c {
        '-' | '−' => '⁻',
        '0' => '⁰',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '4'..='9' => char::from_u32('⁴' as u32 + (c as u32 - '4' as u32)).unwrap_or(c),
        other => other,
    };
    text.chars().map(raised).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let told = [0.0, 1.0, 0.0376991, -12.5, 123_456.0, 3.2e-9, 1e12].map(number);
        assert_eq!(told, ["0", "1", "0.0377", "−12.5", "123456", "3.2 · 10⁻⁹", "1 · 10¹²"]);
    }
}
