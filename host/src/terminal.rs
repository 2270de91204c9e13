//! Text on a terminal: what a project or a file name holds cannot move the cursor, change colours or reverse the reading order.

/// Returns the text with every control character but line feed and tab, and every mark of the reading direction, written as an
/// escape such as `\u{1b}`.
pub fn harmless(text: &str) -> String {
    escaped(text, |c| c.escape_unicode().to_string())
}

/// Returns JSON with the same characters written as JSON's own escapes, such as `\u001b`: it then means the same.
pub fn harmless_json(text: &str) -> String {
    escaped(text, |c| format!("\\u{:04x}", u32::from(c)))
}

/// Returns a text with every character that a terminal may obey replaced.
fn escaped(text: &str, escape: impl Fn(char) -> String) -> String {
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

/// Writes a line to the standard error stream, harmless. Nobody can be told that this stream is lost.
pub fn tell(text: &str) {
    use std::io::Write;
    let _ = writeln!(std::io::stderr(), "{}", harmless(text));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_are_written_out() {
        assert_eq!(harmless("a\u{1b}[31mred\u{7}\r\n\tb"), "a\\u{1b}[31mred\\u{7}\\u{d}\n\tb");
        assert_eq!(harmless("\u{202e}evil \u{9b}2J"), "\\u{202e}evil \\u{9b}2J");
        assert_eq!(harmless("Höhe 1 °/s"), "Höhe 1 °/s");
    }
}
