//! What is printed: results for a person or a machine, errors with their cause, times of stages.

use std::io::Write;
use std::path::Path;

use anyhow::{Context, Result};
use serde::Serialize;

use crate::arguments::Results;
use counterpoise_host::projects::{self, Loaded};

/// Writes to standard output. A reader that has gone away, as in `| head`, ends the program and is no error of it.
pub fn put(text: &str) {
    let mut out = std::io::stdout().lock();
    if out.write_all(text.as_bytes()).and_then(|()| out.flush()).is_err() {
        std::process::exit(0);
    }
}

/// `println!` for results: see [`put`].
macro_rules! say {
    () => { $crate::output::put("\n") };
    ($($text:tt)*) => { $crate::output::put(&(format!($($text)*) + "\n")) };
}
pub(crate) use say;

/// An error and its causes, one below the other; a cause that the line above it quotes is not said twice.
pub fn explained(error: &anyhow::Error) -> String {
    let mut lines = vec![format!("error: {error}")];
    for cause in error.chain().skip(1).map(ToString::to_string) {
        if !lines.iter().any(|line| line.contains(&cause)) {
            lines.push(format!("  because: {cause}"));
        }
    }
    lines.join("\n")
}

/// A number of a printed line: five significant digits, a plain minus sign, and a word for what has no bound.
pub fn figure(value: f64) -> String {
    if !value.is_finite() {
        let sign = if value < 0.0 { "minus " } else { "" };
        return format!("{sign}infinite");
    }
    let magnitude = if value == 0.0 { 0.0 } else { value.abs().log10().floor() };
    if !(-4.0..7.0).contains(&magnitude) {
        return format!("{value:.4e}");
    }
    let decimals = (4.0 - magnitude).clamp(0.0, 8.0) as usize;
    format!("{value:.decimals$}")
}

/// Prints a result as JSON where that was asked for; says whether it went to standard output.
pub fn json<T: Serialize>(results: &Results, result: &T) -> Result<bool> {
    let Some(target) = &results.json else { return Ok(false) };
    let mut text = serde_json::to_string_pretty(result).context("cannot write the result as JSON")?;
    text.push('\n');
    if target == Path::new("-") {
        put(&text);
        return Ok(true);
    }
    projects::write(target, text.as_bytes())?;
    Ok(false)
}

/// Prints what is suspicious in a project file.
pub fn warnings(loaded: &Loaded, quiet: bool) {
    if !quiet {
        loaded.warnings.iter().for_each(|warning| eprintln!("{warning}"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn printed_figures_keep_their_digits_at_every_size() {
        let texts: Vec<String> =
            [14.49204, -0.000_123_456, 0.0, 151_670.4, 2.5e9, f64::INFINITY].map(figure).into();
        assert_eq!(texts, ["14.492", "-0.00012346", "0.0000", "151670", "2.5000e9", "infinite"]);
    }

    #[test]
    fn a_cause_that_was_quoted_is_not_said_twice() {
        let cause = anyhow::anyhow!("the matrix is singular");
        assert_eq!(
            explained(&cause.context("design: the matrix is singular")),
            "error: design: the matrix is singular"
        );
        let cause = anyhow::anyhow!("no space left");
        assert_eq!(
            explained(&cause.context("cannot write a.c")),
            "error: cannot write a.c\n  because: no space left"
        );
    }
}
