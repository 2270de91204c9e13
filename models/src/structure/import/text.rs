//! Helpers that the readers share: lines that count from 1, and numbers as FORTRAN writes them.

use crate::Error;
use crate::tolerance::MOST_ROWS;

/// Returns the error for a line; line 0 stands for the text as a whole.
pub(super) fn line_error(line: usize, what: String) -> Error {
    Error::Import { line, what }
}

/// Parses a number: `1.5e3`, `1.5D+03` or, as Nastran writes it, `1.5+3`.
pub(super) fn parse_real(line: usize, text: &str) -> Result<f64, Error> {
    let fortran = || {
        let plain = text.trim().replace(['d', 'D'], "e");
        plain.parse().ok().or_else(|| with_exponent(&plain)?.parse().ok())
    };
    let value = text.trim().parse().ok().or_else(fortran);
    let finite = value.filter(|v: &f64| v.is_finite());
    finite.ok_or_else(|| line_error(line, format!("\"{}\" is not a number", text.trim())))
}

/// Returns the text with an `e` before a sign in its middle.
fn with_exponent(text: &str) -> Option<String> {
    let at = text.rfind(['+', '-']).filter(|&at| at > 0)?;
    Some(format!("{}e{}", &text[..at], &text[at..]))
}

/// Parses a whole number.
pub(super) fn integer<T: std::str::FromStr>(line: usize, text: &str) -> Result<T, Error> {
    text.trim().parse().map_err(|_| line_error(line, format!("\"{}\" is not a whole number", text.trim())))
}

/// Checks that a matrix of this size can be handled.
pub(super) fn check_size(line: usize, rows: usize, cols: usize) -> Result<(), Error> {
    if rows.max(cols) <= MOST_ROWS {
        return Ok(());
    }
    Err(line_error(
        line,
        format!("{rows} x {cols} is more than {MOST_ROWS} unknowns: condense the model first"),
    ))
}

/// Returns a piece of a line by columns; empty beyond the line's end.
pub(super) fn columns(line: &str, from: usize, to: usize) -> &str {
    let end = to.min(line.len());
    if from >= end { "" } else { line.get(from..end).unwrap_or("") }
}
