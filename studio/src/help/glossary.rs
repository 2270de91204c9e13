//! The terms of the glossary, which document and window share.

use std::sync::OnceLock;

use crate::tolerance::SHORTEST_TERM;

/// The glossary of the manual.
const PAGE: &str = include_str!("../../../docs/glossary.md");
/// The heading from which the page speaks of keys and names of code.
const END: &str = "### Keys of JSON results";

/// A term of the glossary, with the words for it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GlossaryTerm {
    /// The term as the glossary writes it.
    pub term: String,
    /// The words for it, in small letters.
    pub names: Vec<String>,
    /// The meaning.
    pub meaning: String,
}

/// Returns every term, in the order of the glossary.
pub fn glossary_terms() -> &'static [GlossaryTerm] {
    static TERMS: OnceLock<Vec<GlossaryTerm>> = OnceLock::new();
    TERMS.get_or_init(|| read_tables(PAGE.split(END).next().unwrap_or_default()))
}

fn read_tables(page: &str) -> Vec<GlossaryTerm> {
    let rows = page.lines().filter(|line| line.starts_with("| ") && !line.starts_with("| term |"));
    let term = |line: &str| {
        let mut cells = line.trim_matches('|').split('|').map(str::trim);
        let (term, meaning) = (cells.next()?.to_owned(), cells.next()?.to_owned());
        (!meaning.is_empty()).then(|| GlossaryTerm { names: names_of(&term), term, meaning })
    };
    rows.filter_map(term).collect()
}

/// Returns the words of a term, as in "line of sight (LOS)" or "base motion: heave, surge".
fn names_of(term: &str) -> Vec<String> {
    let parts = term.to_lowercase();
    let parts = parts.split([',', ':', '(', ')']).map(str::trim).filter(|part| part.len() >= SHORTEST_TERM);
    parts.map(str::to_owned).collect()
}

/// Returns the terms that a text uses. Of two that stand at one place it is the longer one, as "loop gain" rather than "loop".
pub fn find_terms(text: &str) -> Vec<&'static GlossaryTerm> {
    let text = text.to_lowercase();
    let mut found: Vec<FoundTerm> = Vec::new();
    for term in glossary_terms() {
        for name in &term.names {
            found.extend(word_places(&text, name).map(|start| FoundTerm {
                start,
                end: start + name.len(),
                term,
            }));
        }
    }
    let is_inside = |a: &FoundTerm, b: &FoundTerm| {
        b.start <= a.start && a.end <= b.end && b.end - b.start > a.end - a.start
    };
    let mut kept: Vec<&FoundTerm> = found.iter().filter(|a| !found.iter().any(|b| is_inside(a, b))).collect();
    kept.sort_by_key(|one| one.start);
    let mut terms: Vec<&'static GlossaryTerm> = Vec::new();
    for one in kept {
        if !terms.contains(&one.term) {
            terms.push(one.term);
        }
    }
    terms
}

/// A term at a place of a text.
struct FoundTerm {
    start: usize,
    end: usize,
    term: &'static GlossaryTerm,
}

/// Returns the bytes at which a name stands as whole words, also in the plural.
fn word_places<'a>(text: &'a str, name: &'a str) -> impl Iterator<Item = usize> + 'a {
    let is_letter = |c: Option<char>| c.is_some_and(char::is_alphanumeric);
    text.match_indices(name).map(|(start, _)| start).filter(move |start| {
        let after = text[start + name.len()..].trim_start_matches('s');
        !is_letter(text[..*start].chars().next_back()) && !is_letter(after.chars().next())
    })
}

/// Returns what the glossary says about a text, a line for each term; `None` if it uses none.
pub fn describe_terms(text: &str) -> Option<String> {
    let lines: Vec<String> =
        find_terms(text).iter().map(|one| format!("{}: {}", one.term, one.meaning)).collect();
    (!lines.is_empty()).then(|| lines.join("\n"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn terms_are_found_as_whole_words_and_the_longer_one_wins() {
        let names = |text| find_terms(text).iter().map(|one| one.term.as_str()).collect::<Vec<_>>();
        assert!(glossary_terms().len() > 60, "{}", glossary_terms().len());
        assert_eq!(names("Loop gain"), ["loop gain"]);
        assert_eq!(names("the residuals over their noise floors"), ["residual", "noise floor"]);
        assert!(names("DRR of the plan").contains(&"disturbance rejection ratio (DRR)"));
        assert!(!names("a planter").contains(&"plant"));
        assert!(describe_terms("phase margin").is_some_and(|text| text.contains("lag")));
        assert_eq!(describe_terms("zzz"), None);
    }
}
