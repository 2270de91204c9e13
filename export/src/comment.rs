//! Text that may stand in a comment of generated code.
//!
//! Texts of a project file, such as its name, reach the comments of C, Rust and XML. Every such text passes through
//! [`comment_text`] as the last step before it is printed.

/// Characters beside letters, digits and the space that a comment may hold.
///
/// The list has neither `*` nor `\` nor `?`: without them no text can end a block comment (`*/`), open one (`/*`), continue
/// a line comment, or form a trigraph (`??/`). It has none of `<`, `>`, `&`, `{`, `}` and `|`, so the text is harmless in
/// XML, in templates and in Markdown tables too.
const PUNCTUATION: &str = " .,:;()[]+-=_%^'#!~/@";

/// The character that stands in the place of one that a comment may not hold.
const SUBSTITUTE: char = '_';

/// Returns the text as one line that is harmless inside a comment of every generated language.
///
/// This is a whitelist: letters of the Latin, Greek and Cyrillic scripts, ASCII digits and [`PUNCTUATION`] pass. Every other
/// character, line separators included, becomes [`SUBSTITUTE`]. Spaces at the end are removed.
pub(crate) fn comment_text(text: &str) -> String {
    let harmless: String = text.chars().map(|c| if is_harmless(c) { c } else { SUBSTITUTE }).collect();
    harmless.trim_end().to_owned()
}

/// Returns whether a character may stand in a comment as it is.
fn is_harmless(c: char) -> bool {
    let letter =
        c.is_alphabetic() && matches!(u32::from(c), 0x00c0..=0x024f | 0x0370..=0x03ff | 0x0400..=0x04ff);
    c.is_ascii_alphanumeric() || PUNCTUATION.contains(c) || letter
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The sequences that could end or reopen a comment in C, C++, Rust or XML, or hide text from a reader.
    const HOSTILE: [&str; 12] =
        ["*/", "/*", "\\", "??/", "\n", "\r", "\u{2028}", "\u{2029}", "\u{85}", "-->", "\u{202e}", "\0"];

    #[test]
    fn plain_text_is_kept() {
        let plain = "project: Höhenachse 2 (m/s^2), gain = 1.5e-3: 3 % [Ω'] #1";
        assert_eq!(comment_text(plain), plain);
    }

    #[test]
    fn the_order_of_replacement_cannot_be_used() {
        // Each was turned into an end of comment by replacing one sequence after the other.
        for text in ["*\\", "*\\/", "*//", "**//", "?\\?/", "*\u{200b}/", "*/*/", "/**/"] {
            let safe = comment_text(text);
            assert!(HOSTILE.iter().all(|hostile| !safe.contains(hostile)), "{text:?} became {safe:?}");
        }
    }

    /// Every text of up to four pieces, drawn from the sequences above and their parts.
    #[test]
    fn no_combination_survives() {
        let pieces: Vec<&str> =
            HOSTILE.iter().copied().chain(["*", "/", "?", "\\", "-", ">", "x", " ", "é"]).collect();
        let n = pieces.len();
        for code in 0..n.pow(4) {
            let text: String = (0..4).map(|i| pieces[code / n.pow(i) % n]).collect();
            let safe = comment_text(&text);
            assert!(HOSTILE.iter().all(|hostile| !safe.contains(hostile)), "{text:?} became {safe:?}");
        }
    }
}
