//! Words that the glossary rules out reach no reader: neither in texts of the program nor in documents nor in public names.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;
use std::path::{Path, PathBuf};

use counterpoise_tests::workspace::{members, root, sources};

/// Words of the column "do not write" that have another meaning, too, in which they may stand: `start`, `chance`, "left of the axis". Readers judge them.
const ORDINARY: [&str; 13] = [
    "error",
    "distance",
    "departure",
    "look",
    "start",
    "chance",
    "weighing",
    "simpler",
    "around",
    "effort",
    "left",
    "qualification",
    "the road",
];

/// Other forms of words of the column.
const FORMS: [&str; 8] =
    ["mend", "mends", "mended", "departs", "departed", "misfits", "suspects", "move alike"];

/// Returns the words that the glossary rules out: the column "do not write", without those that are ruled out only where they stand alone or in
/// one sense.
fn forbidden_words() -> Vec<String> {
    let page = fs::read_to_string(root().join("docs/glossary.md")).unwrap();
    let rows = page.lines().filter_map(|line| line.strip_prefix('|')?.strip_suffix('|'));
    let cells = rows.filter_map(|row| row.split('|').nth(2)).map(str::trim);
    let words = cells.flat_map(|cell| cell.split([',', ';'])).map(str::trim);
    let is_unconditional = |word: &&str| {
        let is_conditional = word.ends_with(" alone") || word.contains(" where ") || word.contains(" for ");
        !is_conditional && !["in prose", "do not write", "---"].contains(word)
    };
    let mut all: Vec<String> = words
        .filter(is_unconditional)
        .map(|word| word.trim_matches('"').trim_start_matches("the ").to_lowercase())
        .filter(|word| !word.is_empty() && !ORDINARY.iter().any(|one| one.trim_start_matches("the ") == word))
        .collect();
    all.extend(FORMS.map(str::to_owned));
    all
}

/// Returns whether a text has a word or a phrase between other letters than those of names and paths.
fn holds_phrase(text: &str, phrase: &str) -> bool {
    let is_part = |letter: char| letter.is_alphanumeric() || "_/-`".contains(letter);
    text.match_indices(phrase)
        .any(|(at, _)| !text[..at].ends_with(is_part) && !text[at + phrase.len()..].starts_with(is_part))
}

/// Returns the texts of a source in quotes, each with its line. Escapes stay as they are written.
fn quoted_texts(code: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    let mut open: Option<(usize, String)> = None;
    for (number, line) in code.lines().enumerate() {
        if open.is_none() && line.trim_start().starts_with("//") {
            continue;
        }
        let (mut before, mut letters) = (' ', line.chars().peekable());
        while let Some(letter) = letters.next() {
            let is_letter_itself = before == '\'' && letters.peek() == Some(&'\'');
            match (letter, &mut open) {
                ('"', _) if before == '\\' || is_letter_itself => {}
                ('"', Some(_)) => found.extend(open.take()),
                ('"', None) => open = Some((number + 1, String::new())),
                (_, Some((_, text))) => text.push(letter),
                _ => {}
            }
            before = if before == '\\' && letter == '\\' { ' ' } else { letter };
        }
        if let Some((_, text)) = &mut open {
            *text = text.trim_end_matches('\\').trim_end().to_owned() + " ";
        }
    }
    found
}

/// Returns the documents of the repository: every page beside the glossary, which lists the words.
fn documents() -> Vec<PathBuf> {
    fn add(folder: &Path, all: &mut Vec<PathBuf>) {
        for entry in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
            let name = entry.file_name().unwrap().to_str().unwrap().to_owned();
            let is_built = ["target", "node_modules"].contains(&name.as_str()) || name.starts_with('.');
            if entry.is_dir() && !is_built {
                add(&entry, all);
            } else if name.ends_with(".md") && name != "glossary.md" {
                all.push(entry);
            }
        }
    }
    let mut all = Vec::new();
    add(&root(), &mut all);
    all
}

#[test]
fn words_that_the_glossary_rules_out_reach_no_reader() {
    let forbidden = forbidden_words();
    assert!(forbidden.len() > 15, "{forbidden:?}");
    let wrong_word = |text: &str| forbidden.iter().find(|word| holds_phrase(&text.to_lowercase(), word));
    let mut wrong = Vec::new();
    for folder in members() {
        for (file, code) in sources(&folder) {
            for (line, text) in quoted_texts(&code) {
                let word = wrong_word(&text);
                wrong.extend(word.map(|word| format!("{}:{line}: {word}: {text}", file.display())));
            }
        }
    }
    for file in documents() {
        for (number, line) in fs::read_to_string(&file).unwrap().lines().enumerate() {
            let word = wrong_word(line);
            wrong.extend(word.map(|word| format!("{}:{}: {word}: {line}", file.display(), number + 1)));
        }
    }
    assert!(wrong.is_empty(), "docs/glossary.md has the word to write instead:\n{}", wrong.join("\n"));
}

#[test]
fn public_names_hold_no_word_that_the_glossary_rules_out() {
    let single: Vec<String> = forbidden_words().into_iter().filter(|word| !word.contains(' ')).collect();
    let mut wrong = Vec::new();
    for folder in members() {
        for (file, code) in sources(&folder) {
            for (number, line) in code.lines().enumerate() {
                let Some(item) = line.trim_start().strip_prefix("pub ") else { continue };
                let name = item.split(['(', '<', ':', ';', '{', '=']).next().unwrap();
                let name = name.split_whitespace().last().unwrap_or_default();
                let word = words_of_name(name).into_iter().find(|word| single.contains(word));
                wrong.extend(word.map(|word| format!("{}:{}: {name}: {word}", file.display(), number + 1)));
            }
        }
    }
    assert!(wrong.is_empty(), "docs/glossary.md has the word to use instead:\n{}", wrong.join("\n"));
}

/// Returns the words of a name in either style, in lower case.
fn words_of_name(name: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    for letter in name.chars() {
        if letter == '_' || letter.is_uppercase() {
            words.push(String::new());
        }
        words.last_mut().unwrap().extend(letter.to_lowercase().filter(|letter| *letter != '_'));
    }
    words
}

#[test]
fn texts_and_phrases_are_found() {
    let code = "// \"none\"\nlet a = (\"one \\\"two\\\"\", '\"', \"three \\\n    four\");\n";
    let texts: Vec<String> = quoted_texts(code).into_iter().map(|(_, text)| text).collect();
    assert_eq!(texts.len(), 2, "{texts:?}");
    assert!(texts[0].contains("two") && texts[1].contains("three") && texts[1].contains("four"));
    assert!(holds_phrase("a misfit of two", "misfit") && !holds_phrase("the folder a/unseen", "unseen"));
    assert_eq!(words_of_name("MendedGap"), ["", "mended", "gap"]);
    assert_eq!(words_of_name("first_look"), ["first", "look"]);
}
