//! Numbers with as many digits as a person reads.

/// Writes a number with four significant digits at most.
pub fn format_short(value: f64) -> String {
    if !value.is_finite() {
        return if value.is_nan() { "-".to_owned() } else { "\u{221e}".to_owned() };
    }
    let size = value.abs();
    if value == 0.0 {
        "0".to_owned()
    } else if (1e-3..1e5).contains(&size) {
        let digits = (3 - size.log10().floor() as i32).clamp(0, 6) as usize;
        let text = format!("{value:.digits$}");
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
    } else {
        format!("{value:.2e}")
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;

    #[test]
    fn numbers_are_short_and_keep_four_digits() {
        let said = [0.0, 2.34567, 151.66, 0.0123, 4e-8, 123456.0, f64::INFINITY, f64::NAN].map(format_short);
        assert_eq!(said, ["0", "2.346", "151.7", "0.0123", "4.00e-8", "1.23e5", "\u{221e}", "-"]);
    }
}
