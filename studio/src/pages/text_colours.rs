//! The colours of a project's text: headings, keys, texts, numbers and comments, also of a text that is not TOML yet.

use std::ops::Range;

use egui::text::{LayoutJob, TextFormat};
use egui::{Color32, FontId};

use crate::editing::key_path::{key_name, section_name};
use crate::theme::WindowTheme;

/// Size of the letters, points.
pub const LETTER_SIZE: f32 = 13.0;
/// Height of a line, points.
pub const LINE_HEIGHT: f32 = 18.0;

/// Delimiters of texts of several lines.
const LONG_QUOTES: [&str; 2] = ["\"\"\"", "'''"];

/// A stretch of a line in one colour.
struct Token {
    bytes: Range<usize>,
    kind: TokenKind,
}

/// The kind of a stretch.
#[derive(Clone, Copy, PartialEq, Eq)]
enum TokenKind {
    Heading,
    Key,
    Text,
    Number,
    Comment,
}

impl TokenKind {
    fn colour(self, theme: &WindowTheme) -> Color32 {
        match self {
            Self::Heading => theme.accent,
            Self::Key => theme.text,
            Self::Text => theme.curves[2],
            Self::Number => theme.curves[1],
            Self::Comment => theme.weak,
        }
    }
}

/// Returns a text in its colours. No line is broken, so that each has one row.
pub fn coloured_text(text: &str, theme: &WindowTheme) -> LayoutJob {
    let mut job = LayoutJob::default();
    let mut open_quote = None;
    for line in text.split_inclusive('\n') {
        for Token { bytes, kind } in line_tokens(line, &mut open_quote) {
            let mut format = TextFormat::simple(FontId::monospace(LETTER_SIZE), kind.colour(theme));
            format.line_height = Some(LINE_HEIGHT);
            job.append(&line[bytes], 0.0, format);
        }
    }
    if job.sections.is_empty() {
        let format = TextFormat::simple(FontId::monospace(LETTER_SIZE), theme.text);
        job.append("", 0.0, TextFormat { line_height: Some(LINE_HEIGHT), ..format });
    }
    job.wrap.max_width = f32::INFINITY;
    job.keep_trailing_whitespace = true;
    job
}

/// Returns the stretches of a line, which together are the line; `open_quote` is the delimiter of a text that began on a line before.
fn line_tokens(line: &str, open_quote: &mut Option<&'static str>) -> Vec<Token> {
    let mut tokens = Vec::new();
    let mut at = 0;
    if open_quote.is_none() {
        let is_heading = section_name(line).is_some();
        if is_heading || key_name(line).is_some() {
            at = if is_heading { line.find('#').unwrap_or(line.len()) } else { line.find('=').unwrap_or(0) };
            let kind = if is_heading { TokenKind::Heading } else { TokenKind::Key };
            tokens.push(Token { bytes: 0..at, kind });
        }
    }
    while at < line.len() {
        let token = next_token(line, at, open_quote);
        at = token.bytes.end;
        tokens.push(token);
    }
    tokens
}

/// Returns the stretch that begins at a byte of a line.
fn next_token(line: &str, at: usize, open_quote: &mut Option<&'static str>) -> Token {
    let rest = &line[at..];
    let token = |length: usize, kind| Token { bytes: at..at + length, kind };
    if let Some(quote) = *open_quote {
        let end = rest.find(quote).map(|end| end + quote.len());
        *open_quote = if end.is_some() { None } else { Some(quote) };
        return token(end.unwrap_or(rest.len()), TokenKind::Text);
    }
    if let Some(quote) = LONG_QUOTES.into_iter().find(|quote| rest.starts_with(quote)) {
        let end = rest[quote.len()..].find(quote).map(|end| end + 2 * quote.len());
        *open_quote = if end.is_some() { None } else { Some(quote) };
        return token(end.unwrap_or(rest.len()), TokenKind::Text);
    }
    match rest.chars().next() {
        Some('#') => token(rest.len(), TokenKind::Comment),
        Some(quote @ ('"' | '\'')) => token(quoted_length(rest, quote), TokenKind::Text),
        _ => token(rest.find(['#', '"', '\'']).unwrap_or(rest.len()), TokenKind::Number),
    }
}

/// Returns the length of a text in quotes; without a second quote it is the rest of the line.
fn quoted_length(rest: &str, quote: char) -> usize {
    let mut is_escaped = false;
    for (at, c) in rest.char_indices().skip(1) {
        if c == quote && !is_escaped {
            return at + c.len_utf8();
        }
        is_escaped = c == '\\' && quote == '"' && !is_escaped;
    }
    rest.len()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::theme::DARK;

    #[test]
    fn every_letter_has_a_colour_and_stands_where_it_stood() {
        let texts = [
            "",
            "\n",
            "[a]\nb = \"c # d\" # e = f\n",
            "x = \"\"\"one\ntwo\"\"\" # three",
            "q = \"open\n\u{e9} = 'a\\'\n",
        ];
        for text in texts {
            assert_eq!(coloured_text(text, &DARK).text, text);
        }
    }

    #[test]
    fn comments_and_texts_are_told_apart() {
        let mut open = None;
        let line = "name = \"a # b\" # c";
        let tokens = line_tokens(line, &mut open);
        let texts = tokens.iter().filter(|t| t.kind == TokenKind::Text).map(|t| &line[t.bytes.clone()]);
        assert_eq!(texts.collect::<Vec<_>>(), ["\"a # b\""]);
        let comments = tokens.iter().filter(|t| t.kind == TokenKind::Comment).map(|t| &line[t.bytes.clone()]);
        assert_eq!(comments.collect::<Vec<_>>(), ["# c"]);
    }
}
