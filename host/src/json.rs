//! Results as text for other programs and for people who read files: one layout of JSON wherever a result is written.

use std::io::Write;

use serde::Serialize;

use crate::terminal::harmless_json;

/// Returns a result as JSON: a key a line, a list of numbers in one line, so that a matrix can be read. Characters that a terminal may
/// obey are escaped.
pub fn json_text<T: Serialize>(result: &T) -> serde_json::Result<String> {
    let mut bytes = Vec::new();
    let mut serializer =
        serde_json::Serializer::with_formatter(&mut bytes, KeyALine { depth: 0, empty: true });
    result.serialize(&mut serializer)?;
    bytes.push(b'\n');
    Ok(harmless_json(&String::from_utf8_lossy(&bytes)))
}

/// Indents the keys of objects and leaves lists in one line.
struct KeyALine {
    depth: usize,
    empty: bool,
}

impl KeyALine {
    fn new_line<W: ?Sized + Write>(&self, writer: &mut W) -> std::io::Result<()> {
        writer.write_all(b"\n")?;
        (0..self.depth).try_for_each(|_| writer.write_all(b"  "))
    }
}

impl serde_json::ser::Formatter for KeyALine {
    fn begin_object<W: ?Sized + Write>(&mut self, writer: &mut W) -> std::io::Result<()> {
        (self.depth, self.empty) = (self.depth + 1, true);
        writer.write_all(b"{")
    }

    fn end_object<W: ?Sized + Write>(&mut self, writer: &mut W) -> std::io::Result<()> {
        self.depth -= 1;
        if !self.empty {
            self.new_line(writer)?;
        }
        self.empty = false;
        writer.write_all(b"}")
    }

    fn begin_object_key<W: ?Sized + Write>(&mut self, writer: &mut W, first: bool) -> std::io::Result<()> {
        if !first {
            writer.write_all(b",")?;
        }
        self.empty = false;
        self.new_line(writer)
    }

    fn begin_object_value<W: ?Sized + Write>(&mut self, writer: &mut W) -> std::io::Result<()> {
        writer.write_all(b": ")
    }

    fn begin_array_value<W: ?Sized + Write>(&mut self, writer: &mut W, first: bool) -> std::io::Result<()> {
        if first { Ok(()) } else { writer.write_all(b", ") }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn json_has_a_key_a_line_and_a_list_in_one() {
        let value = serde_json::json!({"A": [[1.0, 2.5], [0.0, -1.0]], "b": {}, "c": [{"d": null}]});
        let text = json_text(&value).unwrap();
        assert_eq!(
            text,
            "{\n  \"A\": [[1.0, 2.5], [0.0, -1.0]],\n  \"b\": {},\n  \"c\": [{\n    \"d\": null\n  }]\n}\n"
        );
        assert_eq!(serde_json::from_str::<serde_json::Value>(&text).unwrap(), value);
    }

    #[test]
    fn json_on_a_terminal_keeps_its_meaning() {
        let value = serde_json::json!({"a": "\u{1b}[2J \u{7f}\u{9b}\u{202e}evil Höhe"});
        let text = json_text(&value).unwrap();
        assert!(text.chars().all(|c| c == '\n' || !(c.is_control() || c == '\u{202e}')), "{text}");
        assert_eq!(serde_json::from_str::<serde_json::Value>(&text).unwrap(), value);
    }
}
