//! Text on a terminal: what a project or a file name holds cannot move the cursor, change colours or reverse the reading order.

/// Returns the text with every control character but line feed and tab, and every mark of the reading direction, written as an
/// escape such as `\u{1b}`.
pub fn escape_controls(text: &str) -> String {
    escape_characters(text, |c| c.escape_unicode().to_string())
}

/// Returns JSON with the same characters written as JSON's own escapes, such as `\u001b`: it then means the same.
pub fn harmless_json(text: &str) -> String {
    escape_characters(text, |c| format!("\\u{:04x}", u32::from(c)))
}

/// Returns a text with every character that a terminal may obey replaced.
fn escape_characters(text: &str, escape: impl Fn(char) -> String) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        let direction = matches!(u32::from(c), 0x061c | 0x200e | 0x200f | 0x2028..=0x202e | 0x2066..=0x2069);
        if (c.is_control() && c != '\n' && c != '\t') || direction {
            out.push_str(&escape(c));
        } else {
            out.push(c);
        }
    }
    out
}

/// Returns what an error and its causes say, the error first; a cause that a line before it quotes is left out. `describe` says what each is.
pub fn error_causes(
    error: &anyhow::Error,
    describe: impl Fn(&(dyn std::error::Error + 'static)) -> String,
) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for cause in error.chain().map(describe) {
        if !lines.iter().any(|line| line.contains(&cause)) {
            lines.push(cause);
        }
    }
    lines
}

/// Writes lines to the standard error stream, harmless, each cut at `LONGEST_LINE`. An error of this stream is ignored, because no other stream is left for it.
pub fn print_message(text: &str) {
    use std::io::Write;
    let lines: Vec<String> = text.split('\n').map(cut).collect();
    let _ = writeln!(std::io::stderr(), "{}", escape_controls(&lines.join("\n")));
}

/// Longest line of a message, in characters: what a file holds may be quoted in it.
const LONGEST_LINE: usize = 2000;

/// Returns a line, cut if it is very long.
fn cut(line: &str) -> String {
    match line.char_indices().nth(LONGEST_LINE) {
        Some((end, _)) => format!("{} ... (cut)", &line[..end]),
        None => line.to_owned(),
    }
}

/// Silences decoders of other people's making: from here on, a panic of one, which is caught and becomes an error of the file, prints nothing.
pub fn quiet_decoders() {
    let usual = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        let is_decoder = |file: &str| {
            ["/parquet-", "/hdf5-pure-", "/brotli", "/lz4_flex-", "/snap-"]
                .iter()
                .any(|name| file.contains(name))
        };
        if !panic.location().is_some_and(|place| is_decoder(place.file())) {
            usual(panic);
        }
    }));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_are_written_out() {
        assert_eq!(escape_controls("a\u{1b}[31mred\u{7}\r\n\tb"), "a\\u{1b}[31mred\\u{7}\\u{d}\n\tb");
        assert_eq!(escape_controls("\u{202e}evil \u{9b}2J"), "\\u{202e}evil \\u{9b}2J");
        assert_eq!(escape_controls("Höhe 1 °/s"), "Höhe 1 °/s");
    }

    #[test]
    fn long_lines_are_cut() {
        let line = "ä".repeat(3000);
        assert_eq!(cut(&line).chars().count(), LONGEST_LINE + " ... (cut)".len());
        assert_eq!(cut("short"), "short");
    }
}
