//! Comments say what is done or returned, and under which condition.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;

use counterpoise_tests::workspace::{members, root, rust_files, sources};

/// Verbs with which the comment of a public function may begin. A verb that is missing here is added; nouns and participles are not.
const FIRST_VERBS: &str = "\
    Activates Adds Analyses Appends Applies Asks Assesses Averages Begins Bounds Brings Builds Cancels \
    Carries Certifies Changes Checks Chooses Clears Closes Compares Compiles Computes Connects Continues \
    Converts Corrects Counts Declares Derives Descends Describes Designs Diagnoses Divides Does Draws \
    Drops Ends Evaluates Examines Factorises Finds Fits Forgets Forms Gives Goes Groups Hands Heats \
    Holds Identifies Installs Judges Keeps Lays Leaves Lets Lists Locks Logs Low-passes Makes Marks \
    Measures Moves Multiplies Notes Opens Orders Plans Prepares Prints Pulls Puts Queues Ranks Reads \
    Realises Reconstructs Records Reduces Refuses Removes Repairs Replaces Replays Reports Resolves \
    Returns Rounds Runs Says Scales Scores Screens Searches Selects Sets Shows Silences Solves Starts \
    Steps Stores Studies Takes Tells Tests Ticks Tightens Transforms Tries Tunes Verifies Waits Writes";

/// Returns whether a word is one of them.
fn is_first_verb(word: &str) -> bool {
    FIRST_VERBS.split_whitespace().any(|verb| verb == word)
}

/// Returns the first words of the comments of a source's public functions, with the lines and names of these.
fn first_words(code: &str) -> Vec<(usize, &str, &str)> {
    let (mut found, mut first) = (Vec::new(), None);
    for (number, line) in code.lines().enumerate() {
        let text = line.trim_start();
        if let Some(said) = text.strip_prefix("///") {
            first = first.or_else(|| said.split_whitespace().next());
            continue;
        }
        let is_public =
            ["pub fn ", "pub const fn ", "pub unsafe fn "].iter().any(|start| text.starts_with(start));
        let name = text.split("fn ").nth(1).and_then(|rest| rest.split(['(', '<']).next());
        if let (true, Some(word), Some(name)) = (is_public, first, name) {
            found.push((number + 1, name, word.trim_end_matches([',', '.', ':', ';'])));
        }
        if !text.starts_with("#[") {
            first = None;
        }
    }
    found
}

#[test]
fn comments_of_public_functions_begin_with_a_verb() {
    let mut wrong = Vec::new();
    for folder in members() {
        for (file, code) in sources(&folder) {
            let others = first_words(&code).into_iter().filter(|(_, _, word)| !is_first_verb(word));
            wrong.extend(
                others.map(|(line, name, word)| format!("{}:{line}: {name}: {word} ...", file.display())),
            );
        }
    }
    assert!(
        wrong.is_empty(),
        "say what the function does or returns, as in \"Returns the transpose.\":\n{}",
        wrong.join("\n")
    );
}

#[test]
fn first_words_of_comments_are_read() {
    let code = "/// Returns one.\n///\n/// # Errors\n#[must_use]\npub fn one() {\n}\n/// The number.\npub const NUMBER: u8 = 2;\npub fn bare() {\n/// The two.\npub const fn two<T>() {\n";
    assert_eq!(first_words(code), [(5, "one", "Returns"), (11, "two", "The")]);
}

/// Words that state what is returned under a condition, which `if` begins and not `where`.
const CONDITIONAL: [&str; 12] =
    ["None`", "None", "NaN", "infinite", "infinity", "empty", "nothing", "absent", "false", "true", "0", "1"];

/// Returns the comments of a source, the lines of each joined, with their first lines.
fn joined_comments(text: &str) -> Vec<(usize, String)> {
    let mut found: Vec<(usize, String)> = Vec::new();
    let mut last = None;
    for (number, line) in text.lines().enumerate() {
        let Some(said) = line.trim_start().strip_prefix("//") else { continue };
        let said = said.trim_start_matches(['/', '!']).trim();
        match found.last_mut().filter(|_| last.is_some_and(|last| last + 1 == number)) {
            Some((_, comment)) => {
                comment.push(' ');
                comment.push_str(said);
            }
            None => found.push((number + 1, said.to_owned())),
        }
        last = Some(number);
    }
    found
}

/// Returns the first place of a comment where a value or an error is stated, and its condition begins with `where`.
fn condition_with_where(comment: &str) -> Option<&str> {
    let is_wrong = |at: &usize| {
        let before = &comment[..*at];
        let word = before.rsplit([' ', '(', '`']).find(|word| !word.is_empty()).unwrap_or_default();
        let is_value = CONDITIONAL.iter().any(|value| word.eq_ignore_ascii_case(value.trim_matches('`')));
        let is_error =
            before.ends_with(']') && before.rsplit("[`").next().is_some_and(|path| path.contains("Error"));
        let is_reason =
            before.ends_with(']') && before.rsplit("[`").next().is_some_and(|path| path.contains("Reason::"));
        is_value || is_error || is_reason
    };
    let mut places = comment.match_indices(" where ").map(|(at, _)| at);
    places.find(is_wrong).map(|at| &comment[..at + 6])
}

#[test]
fn comments_say_if_and_not_where_for_a_condition() {
    let mut wrong = Vec::new();
    for folder in members() {
        for file in rust_files(&root().join(folder).join("src")) {
            let text = fs::read_to_string(&file).unwrap();
            for (line, comment) in joined_comments(&text) {
                let said = condition_with_where(&comment)
                    .map(|said| format!("{}:{line}: ...{said}", file.display()));
                wrong.extend(said);
            }
        }
    }
    assert!(wrong.is_empty(), "write \"returns `None` if\":\n{}", wrong.join("\n"));
}

#[test]
fn conditions_with_where_are_found() {
    let wrong =
        ["infinite where it diverges", "`None` where nothing is", "[`Error::Shape`] where it does not fit"];
    assert!(wrong.iter().all(|comment| condition_with_where(comment).is_some()));
    let right = [
        "the place where it is least",
        "`None` if there is none",
        "G X where no input is known",
        "below 10 where it grows",
    ];
    assert!(right.iter().all(|comment| condition_with_where(comment).is_none()));
    let comments = joined_comments("/// Returns nothing\n/// where it fails.\nfn one() {}\n// two\n");
    assert_eq!(comments, [(1, "Returns nothing where it fails.".to_owned()), (4, "two".to_owned())]);
}
