//! A change of the project's text: the stretch that is replaced, and what replaces it.

use std::ops::Range;

/// A change of a text. It is as long as what was typed, so that a journal of keystrokes stays small.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TextChange {
    /// The bytes that are replaced.
    pub replaced: Range<usize>,
    /// The text that replaces them.
    pub inserted: String,
}

impl TextChange {
    /// Returns the smallest change from one text to another; `None` if they are equal.
    pub fn from_texts(old: &str, new: &str) -> Option<Self> {
        if old == new {
            return None;
        }
        let start = common_start(old, new);
        let (old_rest, new_rest) = (&old[start..], &new[start..]);
        let end = common_end(old_rest, new_rest);
        let replaced = start..old.len() - end;
        Some(Self { replaced, inserted: new_rest[..new_rest.len() - end].to_owned() })
    }

    /// Returns the changed text; `None` if the text has no such stretch, because the change was made to another text.
    pub fn apply(&self, text: &str) -> Option<String> {
        let (before, after) = (text.get(..self.replaced.start)?, text.get(self.replaced.end..)?);
        (self.replaced.start <= self.replaced.end).then(|| format!("{before}{}{after}", self.inserted))
    }
}

/// Returns the length of the longest common beginning, in bytes of whole characters.
fn common_start(a: &str, b: &str) -> usize {
    let same = a.chars().zip(b.chars()).take_while(|(x, y)| x == y);
    same.map(|(x, _)| x.len_utf8()).sum()
}

/// Returns the length of the longest common end, in bytes of whole characters.
fn common_end(a: &str, b: &str) -> usize {
    let same = a.chars().rev().zip(b.chars().rev()).take_while(|(x, y)| x == y);
    same.map(|(x, _)| x.len_utf8()).sum()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;

    #[test]
    fn a_change_leads_from_one_text_to_the_other_and_is_no_longer_than_what_differs() {
        let pairs = [("", "a"), ("a", ""), ("gain = 1", "gain = 11"), ("aaa", "aa"), ("\u{e9}x", "\u{e8}x")];
        for (old, new) in pairs {
            let change = TextChange::from_texts(old, new).unwrap();
            assert_eq!(change.apply(old).unwrap(), new);
            assert!(change.replaced.len() + change.inserted.len() <= 4, "{change:?}");
        }
        assert_eq!(TextChange::from_texts("same", "same"), None);
    }

    #[test]
    fn a_change_of_another_text_changes_nothing() {
        let inside_a_letter = TextChange { replaced: 1..2, inserted: String::new() };
        assert_eq!(inside_a_letter.apply("\u{e9}"), None);
        assert_eq!(TextChange { replaced: 3..9, inserted: String::new() }.apply("four"), None);
        assert_eq!(
            TextChange { replaced: Range { start: 3, end: 1 }, inserted: String::new() }.apply("four"),
            None
        );
    }
}
