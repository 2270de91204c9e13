//! Numbers as a person reads them.

/// Returns a number with at most four significant digits and no trailing noise, for labels and tables.
pub fn short_number(value: f64) -> String {
    if value.is_nan() {
        return "\u{2013}".to_owned();
    }
    if value.is_infinite() {
        return if value > 0.0 { "\u{221E}" } else { "\u{2212}\u{221E}" }.to_owned();
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    let magnitude = value.abs().log10().floor();
    if !(-4.0..6.0).contains(&magnitude) {
        return scientific(value);
    }
    let decimals = (3.0 - magnitude).max(0.0) as usize;
    let text = format!("{value:.decimals$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    with_minus(text)
}

fn scientific(value: f64) -> String {
    let text = format!("{value:.2e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    times_power_of_ten(mantissa, exponent.parse().unwrap_or(0))
}

/// Returns `mantissa` times a power of ten, written with a raised exponent.
pub(crate) fn times_power_of_ten(mantissa: &str, exponent: i32) -> String {
    format!("{}\u{D7}10{}", with_minus(mantissa), superscript(exponent))
}

/// Returns the text with minus signs in place of hyphens, which are too short for it.
pub(crate) fn with_minus(text: &str) -> String {
    text.replace('-', "\u{2212}")
}

/// Returns an exponent in raised digits.
pub(crate) fn superscript(exponent: i32) -> String {
    let digit = |c: char| match c {
        '-' => '\u{207B}',
        '1' => '\u{B9}',
        '2' => '\u{B2}',
        '3' => '\u{B3}',
        other => char::from_u32(0x2070 + other as u32 - '0' as u32).unwrap_or(other),
    };
    exponent.to_string().chars().map(digit).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        assert_eq!(short_number(13.456_78), "13.46");
        assert_eq!(short_number(-0.5), "\u{2212}0.5");
        assert_eq!(short_number(120_000.0), "120000");
        assert_eq!(short_number(1.5e-9), "1.50\u{D7}10\u{207B}\u{2079}");
        assert_eq!(short_number(f64::INFINITY), "\u{221E}");
        assert_eq!(short_number(f64::NAN), "\u{2013}");
        assert_eq!(short_number(-0.0), "0");
    }
}
