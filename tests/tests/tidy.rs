//! The code stays tidy: short functions, names of functions, types and modules that say what is done and what is there, `lib.rs` pages that list their modules, no dependency that is not used.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use counterpoise_tests::workspace::{manifest, members, root, rust_files, sources};

/// A function has fewer lines than this, its signature and braces included.
const TOO_LONG_FUNCTION: usize = 60;

/// Returns the indent of a line on which a function with a body begins, whatever its visibility.
fn function_indent<'a>(lines: &[&'a str], start: usize) -> Option<&'a str> {
    let line = lines[start];
    let indent = &line[..line.len() - line.trim_start().len()];
    let mut words = line.split_whitespace().take(6).take_while(|word| !word.starts_with("//"));
    let ends_at_once = line.trim_end().ends_with([';', '}']);
    (words.any(|word| word == "fn") && !ends_at_once).then_some(indent)
}

/// Returns the lines of the function that begins on a line; `None` if it has no body.
fn function_length(lines: &[&str], start: usize) -> Option<usize> {
    let indent = function_indent(lines, start)?;
    let (close, declared) = (format!("{indent}}}"), format!("{indent})"));
    for (count, line) in lines[start..].iter().enumerate() {
        if *line == close {
            return Some(count + 1);
        }
        if line.starts_with(&declared) && line.trim_end().ends_with(';') {
            return None;
        }
    }
    None
}

#[test]
fn functions_are_short() {
    let mut long = Vec::new();
    for folder in members() {
        for file in rust_files(&root().join(&folder)) {
            let text = fs::read_to_string(&file).unwrap();
            let lines: Vec<&str> = text.lines().collect();
            for start in 0..lines.len() {
                if let Some(length) = function_length(&lines, start).filter(|n| *n >= TOO_LONG_FUNCTION) {
                    long.push(format!("{}:{}: {length} lines", file.display(), start + 1));
                }
            }
        }
    }
    assert!(long.is_empty(), "functions of {TOO_LONG_FUNCTION} lines or more:\n{}", long.join("\n"));
}

/// A function that takes a `bool` or a tuple and may.
struct Exception {
    file: &'static str,
    function: &'static str,
    why: ExceptionReason,
}

/// Why a function may take a `bool` or a tuple.
#[derive(Debug, Clone, Copy)]
enum ExceptionReason {
    /// A trait of another crate says what it takes.
    Trait,
    /// It makes a named type of a tuple.
    Conversion,
    /// It takes the lines of a file with their numbers, as `enumerate` gives them.
    NumberedLines,
}

const fn may(file: &'static str, function: &'static str, why: ExceptionReason) -> Exception {
    Exception { file, function, why }
}

/// Every function that takes a `bool` or a tuple and may, with the reason.
const EXCEPTIONS: [Exception; 15] = [
    may("host/src/json.rs", "begin_object_key", ExceptionReason::Trait),
    may("host/src/json.rs", "begin_array_value", ExceptionReason::Trait),
    may("linalg/src/mat.rs", "index", ExceptionReason::Trait),
    may("linalg/src/mat.rs", "index_mut", ExceptionReason::Trait),
    may("models/src/structure/import/matrix_market.rs", "coordinate", ExceptionReason::NumberedLines),
    may("models/src/structure/import/matrix_market.rs", "array", ExceptionReason::NumberedLines),
    may("models/src/structure/import/op4.rs", "one", ExceptionReason::NumberedLines),
    may("plot/src/bitmap.rs", "draw_rect", ExceptionReason::Trait),
    may("plot/src/bitmap.rs", "draw_circle", ExceptionReason::Trait),
    may("plot/src/figure.rs", "from", ExceptionReason::Conversion),
    may("plot/src/ruler.rs", "map", ExceptionReason::Trait),
    may("plot/src/svg.rs", "draw_rect", ExceptionReason::Trait),
    may("plot/src/svg.rs", "draw_circle", ExceptionReason::Trait),
    may("plot/src/svg.rs", "blit_bitmap", ExceptionReason::Trait),
    may("project/src/file/visit.rs", "from", ExceptionReason::Conversion),
];

/// Returns the place in the list of the exception that a function of a file is.
fn exception_of(file: &Path, name: &str) -> Option<usize> {
    let path = file.strip_prefix(root()).unwrap().to_str().unwrap().replace('\\', "/");
    EXCEPTIONS.iter().position(|exception| (exception.file, exception.function) == (path.as_str(), name))
}

/// Returns the declared functions of a source: line number, name and the types of its arguments.
fn declared_functions(code: &str) -> Vec<DeclaredFunction<'_>> {
    let mut found = Vec::new();
    let mut offset = 0;
    for (number, line) in code.lines().enumerate() {
        let start = offset;
        offset += line.len() + 1;
        let words: Vec<&str> = line.split_whitespace().take_while(|word| !word.starts_with("//")).collect();
        let Some(place) = words.iter().take(5).position(|word| *word == "fn") else { continue };
        let name = words.get(place + 1).map_or("", |word| word.split(['(', '<']).next().unwrap_or(word));
        let rest = &code[start + line.find("fn ").unwrap_or(0)..];
        found.push(DeclaredFunction { line: number + 1, name, types: argument_types(rest) });
    }
    found
}

/// A function's name and the types of its arguments.
struct DeclaredFunction<'a> {
    line: usize,
    name: &'a str,
    types: Vec<&'a str>,
}

/// Returns the types of the arguments of a declaration that begins with `fn`, after its bounds.
fn argument_types(declaration: &str) -> Vec<&str> {
    let (mut depth, mut start, mut types, mut before) = (0, None, Vec::new(), ' ');
    for (at, letter) in declaration.char_indices() {
        match letter {
            '(' | '[' | '<' => depth += 1,
            ')' | ']' => depth -= 1,
            '>' if before != '-' => depth -= 1,
            _ => {}
        }
        before = letter;
        let is_open = letter == '(' && depth == 1 && start.is_none();
        let ends = matches!(letter, ',') && depth == 1 || letter == ')' && depth == 0;
        if let (true, Some(from)) = (ends, start) {
            types.extend(declaration[from..at].split_once(": ").map(|(_, kind)| kind.trim()));
            start = Some(at + 1);
        }
        if is_open {
            types.push(&declaration[..at]);
            start = Some(at + 1);
        }
        if letter == ')' && depth == 0 {
            break;
        }
    }
    types
}

/// Returns whether a tuple stands anywhere in a type, as in `&[(A, B)]` or `impl Iterator<Item = (A, B)>`, but for what a closure takes.
/// `(T)` and `(T + U)` are no tuples.
fn holds_tuple(kind: &str) -> bool {
    let mut rest = kind;
    while let Some(at) = rest.find('(') {
        let takes = ["Fn", "FnMut", "FnOnce", "fn"].iter().any(|closure| rest[..at].ends_with(closure));
        if !takes && has_comma(&rest[at..]) {
            return true;
        }
        rest = &rest[if takes { at + bracket_length(&rest[at..]) } else { at + 1 }..];
    }
    false
}

/// Returns the length of the bracket that a text begins with, both ends included.
fn bracket_length(text: &str) -> usize {
    let mut depth = 0;
    for (at, letter) in text.char_indices() {
        match letter {
            '(' => depth += 1,
            ')' => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return at + letter.len_utf8();
        }
    }
    text.len()
}

/// Returns whether the bracket that a type begins with holds a comma of its own.
fn has_comma(kind: &str) -> bool {
    let (mut depth, mut before) = (0, ' ');
    for letter in kind.chars() {
        match letter {
            '(' | '[' | '<' => depth += 1,
            ')' | ']' => depth -= 1,
            '>' if before != '-' => depth -= 1,
            ',' if depth == 1 => return true,
            _ => {}
        }
        before = letter;
        if depth == 0 {
            return false;
        }
    }
    false
}

/// Returns the names of the types of a source that are other words for a tuple or for a collection of tuples.
fn tuple_aliases(code: &str) -> Vec<&str> {
    let alias = |line: &str, at: usize| {
        let (name, kind) = code[at + line.find("type ")? + 5..].split(';').next()?.split_once(" =")?;
        holds_tuple(kind).then(|| name.split('<').next().unwrap_or(name))
    };
    let starts = code.lines().scan(0, |offset, line| {
        let at = *offset;
        *offset += line.len() + 1;
        Some((line, at))
    });
    let is_alias = |line: &str| {
        ["type ", "pub type ", "pub(crate) type ", "pub(super) type "]
            .iter()
            .any(|words| line.starts_with(words))
    };
    starts.filter(|(line, _)| is_alias(line)).filter_map(|(line, at)| alias(line, at)).collect()
}

/// Returns whether a type mentions a name.
fn mentions(kind: &str, name: &str) -> bool {
    kind.split(|letter: char| !letter.is_alphanumeric() && letter != '_').any(|word| word == name)
}

/// Returns what is wrong with the arguments of a function: `aliases` are names of tuples that its file knows.
fn wrong_arguments(found: &DeclaredFunction<'_>, aliases: &[&str]) -> Vec<&'static str> {
    let is_alias = |kind: &str| aliases.iter().any(|name| mentions(kind, name));
    let mut wrong = Vec::new();
    if found.types.contains(&"bool") {
        wrong.push("a bare bool: an enum says what it means");
    }
    if found.types.iter().any(|kind| holds_tuple(kind) || is_alias(kind)) {
        wrong.push("a tuple, or a collection of tuples: a struct or arguments of their own have names");
    }
    wrong
}

#[test]
fn arguments_have_names_for_their_values() {
    let (mut wrong, mut needed) = (Vec::new(), Vec::new());
    for folder in members() {
        for (file, code) in sources(&folder) {
            let aliases = tuple_aliases(&code);
            for found in declared_functions(&code) {
                let wrong_here = wrong_arguments(&found, &aliases);
                let place = |what| format!("{}:{}: {} takes {what}", file.display(), found.line, found.name);
                match exception_of(&file, found.name) {
                    Some(at) if !wrong_here.is_empty() => needed.push(at),
                    Some(_) => {}
                    None => wrong.extend(wrong_here.into_iter().map(place)),
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    for (at, Exception { file, function, why }) in EXCEPTIONS.iter().enumerate() {
        assert!(
            needed.contains(&at),
            "{file}: {function} is no exception ({why:?}): leave it out of the list"
        );
    }
}

#[test]
fn arguments_are_read_from_declarations() {
    let code = "pub fn one<T: Fn(f64) -> bool>(\n    a: &(f64, f64),\n    is_b: bool,\n) -> bool {\n}\n    fn two(&self, c: [f64; 2]) {}\n";
    let found = declared_functions(code);
    assert_eq!((found[0].name, found[0].line), ("one", 1));
    assert_eq!(found[0].types, ["fn one<T: Fn(f64) -> bool>", "&(f64, f64)", "bool"]);
    assert_eq!((found[1].name, found[1].line), ("two", 6));
    assert_eq!(found[1].types, ["fn two", "[f64; 2]"]);
}

#[test]
fn other_words_for_tuples_are_seen() {
    let code = "type Pair = (A, B);\npub(crate) type Table<T> =\n    Vec<(A, T)>;\ntype Callback = fn(A, B);\ntype Row = Vec<A>;\n";
    assert_eq!(tuple_aliases(code), ["Pair", "Table"]);
    assert!(mentions("&[Table<A>]", "Table") && !mentions("&Tables", "Table"));
    let one = DeclaredFunction { line: 1, name: "one", types: vec!["&[Pair]", "bool"] };
    assert_eq!(wrong_arguments(&one, &["Pair"]).len(), 2);
    assert!(wrong_arguments(&one, &[])[0].starts_with("a bare bool"));
}

#[test]
fn tuples_are_told_from_bounds() {
    let tuples = [
        "(f64, f64)",
        "&mut (A, Vec<B>)",
        "&'a (A, B)",
        "Option<(f64, u32)>",
        "Option<&(A, B)>",
        "(impl A, B)",
        "&[(A, B)]",
        "Vec<(A, B)>",
        "impl Iterator<Item = (A, B)>",
        "impl Fn(A) -> (B, C)",
    ];
    assert!(tuples.iter().all(|kind| holds_tuple(kind)));
    let others = [
        "()",
        "&(dyn Fn(A, B) + Sync)",
        "&(impl A<B, C> + D)",
        "Option<Box<A>>",
        "impl Fn(A, B)",
        "&dyn Fn((A, B)) -> C",
        "fn(&mut A, B)",
        "(A)",
    ];
    assert!(!others.iter().any(|kind| holds_tuple(kind)));
}

/// Words that are no names of functions: where or when something is, not what is done or returned.
const PREPOSITIONS_AND_ADVERBS: [&str; 46] = [
    "about", "above", "across", "after", "against", "ahead", "along", "among", "apart", "around", "away",
    "back", "before", "behind", "below", "beneath", "beside", "between", "beyond", "by", "down", "during",
    "for", "here", "in", "inside", "near", "on", "onto", "out", "outside", "over", "past", "per", "since",
    "still", "than", "there", "through", "toward", "towards", "under", "until", "up", "upon", "within",
];

/// Participles that do not end in `ed`. Those that are spelt as their verb are not here: `cut`, `put`, `read`, `run`, `set`, `split`.
const IRREGULAR_PARTICIPLES: [&str; 43] = [
    "begun", "bent", "broken", "brought", "built", "chosen", "done", "drawn", "driven", "fallen", "felt",
    "found", "given", "gone", "grown", "heard", "held", "hidden", "kept", "known", "laid", "left", "lost",
    "made", "meant", "met", "said", "seen", "sent", "shown", "sought", "spent", "stuck", "swept", "taken",
    "taught", "thought", "thrown", "told", "undone", "won", "worn", "written",
];

/// Verbs and nouns in `ed`.
const NO_PARTICIPLES: [&str; 7] = ["bed", "embed", "exceed", "feed", "need", "seed", "speed"];

/// Returns whether a word is a participle.
fn is_participle(word: &str) -> bool {
    (word.ends_with("ed") && !NO_PARTICIPLES.contains(&word)) || IRREGULAR_PARTICIPLES.contains(&word)
}

/// A name that the law on names does not let pass and that may stay.
struct AllowedName {
    name: &'static str,
    why: NameReason,
}

/// Why a function may be called so.
#[derive(Debug, Clone, Copy, PartialEq)]
enum NameReason {
    /// Toolboxes for control have a function of this name.
    Toolbox,
    /// The standard library calls it so: `Instant::elapsed`.
    StandardLibrary,
}

/// Every function whose name looks like a participle or a preposition and may, with the reason.
const ALLOWED_NAMES: [AllowedName; 2] = [
    AllowedName { name: "balred", why: NameReason::Toolbox },
    AllowedName { name: "elapsed", why: NameReason::StandardLibrary },
];

/// Returns what is wrong with the name of a public function: a participle says neither what is done nor what is returned, and a preposition less.
/// `at`, `from`, `into`, `of`, `to`, `with` and `without` are idioms of Rust, alone and as first words.
fn wrong_name(name: &str) -> Option<&'static str> {
    let first = name.split('_').next().unwrap_or(name);
    if first == name && is_participle(name) {
        return Some("a bare participle");
    }
    PREPOSITIONS_AND_ADVERBS.contains(&first).then_some("a preposition or an adverb, or begins with one")
}

/// Returns what is wrong with the name of a private function, which is read beside its body: only one word that is a participle, a preposition or
/// an adverb is refused.
fn wrong_private_name(name: &str) -> Option<&'static str> {
    wrong_name(name).filter(|_| !name.contains('_'))
}

/// Returns the names of the public functions of a source, and of the functions of its traits, with their lines.
fn public_functions(code: &str) -> Vec<DeclaredFunction<'_>> {
    let mut is_in_trait = false;
    let is_public: Vec<bool> = code
        .lines()
        .map(|line| {
            let words = ["pub trait ", "pub(crate) trait ", "pub(super) trait "];
            is_in_trait = (is_in_trait && line != "}") || words.iter().any(|start| line.starts_with(start));
            is_in_trait || line.trim_start().starts_with("pub")
        })
        .collect();
    declared_functions(code).into_iter().filter(|found| is_public[found.line - 1]).collect()
}

#[test]
fn functions_are_not_named_by_participles_or_prepositions() {
    let (mut wrong, mut needed) = (Vec::new(), Vec::new());
    for folder in members() {
        for (file, code) in sources(&folder) {
            let public: Vec<usize> = public_functions(&code).iter().map(|found| found.line).collect();
            for found in declared_functions(&code) {
                let is_public = public.contains(&found.line);
                let what = if is_public { wrong_name(found.name) } else { wrong_private_name(found.name) };
                let Some(what) = what else { continue };
                match ALLOWED_NAMES.iter().position(|allowed| allowed.name == found.name) {
                    Some(at) => needed.push(at),
                    None => {
                        wrong.push(format!("{}:{}: {} is {what}", file.display(), found.line, found.name));
                    }
                }
            }
        }
    }
    assert!(wrong.is_empty(), "name what is done (a verb) or returned (a noun):\n{}", wrong.join("\n"));
    for (at, AllowedName { name, why }) in ALLOWED_NAMES.iter().enumerate() {
        assert!(needed.contains(&at), "no function is called {name} ({why:?}): leave it out of the list");
    }
}

/// Adjectives, adverbs, pronouns and verbs that stood alone as names of types and modules. `sparse` and `dense` are not here: textbooks call such a
/// matrix so.
const NO_NOUNS: [&str; 70] = [
    "absent",
    "acting",
    "adaptive",
    "adjustable",
    "begin",
    "best",
    "compact",
    "continuous",
    "counting",
    "decide",
    "destabilising",
    "discrete",
    "double",
    "doubtful",
    "dry",
    "elsewhere",
    "entrywise",
    "faulty",
    "flat",
    "highest",
    "holding",
    "idle",
    "improve",
    "indefinite",
    "lagging",
    "linear",
    "local",
    "long",
    "lower",
    "minimal",
    "modal",
    "nearest",
    "nonlinear",
    "normal",
    "nothing",
    "now",
    "nowhere",
    "observe",
    "once",
    "one",
    "ordinary",
    "outermost",
    "own",
    "periodic",
    "plausible",
    "precise",
    "predict",
    "present",
    "quick",
    "random",
    "rational",
    "realise",
    "recoiling",
    "recursive",
    "robust",
    "single",
    "slow",
    "spectral",
    "standing",
    "tell",
    "telling",
    "thin",
    "traceable",
    "turning",
    "uncertain",
    "unidentifiable",
    "upper",
    "upward",
    "worst",
    "wrong",
];

/// Returns whether a word names nothing: a participle, a preposition, or one of the words in the list above.
fn is_no_noun(word: &str) -> bool {
    let idioms = ["at", "from", "of", "with", "which", "whole", "why"];
    is_participle(word) || [&PREPOSITIONS_AND_ADVERBS[..], &NO_NOUNS, &idioms].concat().contains(&word)
}

/// A module whose name is no noun and that may be called so.
struct AllowedModule {
    folder: &'static str,
    name: &'static str,
    why: ModuleReason,
}

/// Why a module may be called so.
#[derive(Debug, Clone, Copy)]
enum ModuleReason {
    /// The term of the textbooks begins with it: the structured singular value.
    Term,
    /// It presents a section of the project file that has this name.
    Section,
    /// The evidence speaks of what it has by this name alone.
    Evidence,
}

/// Every module whose name is no noun and that may be called so, with the reason.
const ALLOWED_MODULES: [AllowedModule; 3] = [
    AllowedModule { folder: "report", name: "learned", why: ModuleReason::Section },
    AllowedModule { folder: "tests", name: "sealed", why: ModuleReason::Evidence },
    AllowedModule { folder: "verify", name: "structured", why: ModuleReason::Term },
];

/// Returns whether the name of a module is no noun: a word that is none, or several words of which the last one is a preposition, as in `held_out`.
fn is_wrong_module_name(name: &str) -> bool {
    let last = name.rsplit('_').next().unwrap_or(name);
    is_no_noun(name) || PREPOSITIONS_AND_ADVERBS.contains(&last)
}

/// Returns the names of the modules that a source declares, with their lines.
fn declared_modules(code: &str) -> impl Iterator<Item = (usize, &str)> {
    code.lines().enumerate().filter_map(|(number, line)| {
        let (before, name) = line.strip_suffix(';')?.split_once("mod ")?;
        (before.is_empty() || before.starts_with("pub")).then_some((number + 1, name))
    })
}

#[test]
fn modules_are_called_by_nouns() {
    let (mut wrong, mut needed) = (Vec::new(), Vec::new());
    for folder in members() {
        for (file, code) in sources(&folder) {
            for (line, name) in declared_modules(&code).filter(|(_, name)| is_wrong_module_name(name)) {
                let is_this = |one: &AllowedModule| (one.folder, one.name) == (folder.as_str(), name);
                match ALLOWED_MODULES.iter().position(is_this) {
                    Some(at) => needed.push(at),
                    None => wrong.push(format!("{}:{line}: {name}", file.display())),
                }
            }
        }
    }
    assert!(wrong.is_empty(), "name what the module has, by a noun:\n{}", wrong.join("\n"));
    for (at, AllowedModule { folder, name, why }) in ALLOWED_MODULES.iter().enumerate() {
        assert!(
            needed.contains(&at),
            "no module of {folder} is called {name} ({why:?}): leave it out of the list"
        );
    }
}

/// A type whose name is no noun and that may be called so.
struct AllowedType {
    name: &'static str,
    why: TypeReason,
}

/// Why a type may be called so.
#[derive(Debug, Clone, Copy)]
enum TypeReason {
    /// Its name is part of the hash of every project that has such a value: another name would change the provenance of code that was exported.
    Hash,
    /// The package for Python has a class of this name.
    Python,
}

/// Every type whose name is no noun and that may be called so, with the reason.
const ALLOWED_TYPES: [AllowedType; 2] = [
    AllowedType { name: "Imported", why: TypeReason::Hash },
    AllowedType { name: "Kept", why: TypeReason::Python },
];

/// Returns the types that a source declares, private ones too: their lines and names.
fn declared_types(code: &str) -> impl Iterator<Item = (usize, &str)> {
    code.lines().enumerate().filter_map(|(number, line)| {
        let words: Vec<&str> = line.split_whitespace().take_while(|word| !word.starts_with("//")).collect();
        let kinds = ["struct", "enum", "trait", "type", "union"];
        let place = words.iter().take(4).position(|word| kinds.contains(word))?;
        let is_declared = words[..place].iter().all(|word| word.starts_with("pub") || word.ends_with(')'));
        let name = words.get(place + 1)?.split(['<', '(', '{', ';', ':']).next()?;
        let is_type = name.starts_with(|letter: char| letter.is_ascii_uppercase());
        (is_declared && is_type).then_some((number + 1, name))
    })
}

/// Returns the last word of the name of a type, in lower case, and whether it is the only one.
fn last_word(name: &str) -> (String, bool) {
    let at = name.rfind(|letter: char| letter.is_ascii_uppercase()).unwrap_or(0);
    (name[at..].to_ascii_lowercase(), at == 0)
}

/// Returns whether the name of a type is no noun: a single word that is none, or several words of which the last one is a participle or a
/// preposition.
fn is_wrong_type_name(name: &str) -> bool {
    let (word, is_alone) = last_word(name);
    if is_alone {
        return is_no_noun(&word);
    }
    let ends = ["at", "from", "now", "of", "with"];
    is_participle(&word) || PREPOSITIONS_AND_ADVERBS.contains(&word.as_str()) || ends.contains(&word.as_str())
}

#[test]
fn types_are_called_by_nouns() {
    let (mut wrong, mut needed) = (Vec::new(), Vec::new());
    for folder in members() {
        for (file, code) in sources(&folder) {
            for (line, name) in declared_types(&code).filter(|(_, name)| is_wrong_type_name(name)) {
                match ALLOWED_TYPES.iter().position(|allowed| allowed.name == name) {
                    Some(at) => needed.push(at),
                    None => wrong.push(format!("{}:{line}: {name}", file.display())),
                }
            }
        }
    }
    assert!(wrong.is_empty(), "name what a value of the type is, by a noun:\n{}", wrong.join("\n"));
    for (at, AllowedType { name, why }) in ALLOWED_TYPES.iter().enumerate() {
        assert!(needed.contains(&at), "no type is called {name} ({why:?}): leave it out of the list");
    }
}

/// Returns the types that a source declares for other modules: their lines and names.
fn public_types(code: &str) -> impl Iterator<Item = (usize, &str)> {
    let lines: Vec<&str> = code.lines().collect();
    declared_types(code).filter(move |(line, _)| lines[line - 1].trim_start().starts_with("pub "))
}

#[test]
fn no_two_public_types_of_a_crate_share_a_name() {
    let mut wrong = Vec::new();
    for folder in members() {
        let mut known: BTreeMap<String, String> = BTreeMap::new();
        for (file, code) in sources(&folder) {
            for (line, name) in public_types(&code) {
                let place = format!("{}:{line}", file.display());
                if let Some(other) = known.insert(name.to_owned(), place.clone()) {
                    wrong.push(format!("{name}: {other} and {place}"));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "two concepts never share a name:\n{}", wrong.join("\n"));
    let code = "pub struct One;\npub(crate) struct Two;\nstruct Three;\n";
    assert_eq!(public_types(code).collect::<Vec<_>>(), [(1, "One")]);
}

#[test]
fn nouns_are_told_from_other_words() {
    assert!(["linear", "held", "held_out"].iter().all(|name| is_wrong_module_name(name)));
    assert!(!["linear_loop", "feed", "held_out_recordings"].iter().any(|name| is_wrong_module_name(name)));
    let wrong = ["Held", "Nearest", "With", "DesignAt", "HiddenFrom", "NotExcited", "TimeLeft", "Tried"];
    assert!(wrong.iter().all(|name| is_wrong_type_name(name)));
    let right = ["Feed", "HeldOutRecording", "Mat", "Sparse", "RemainingTime", "Speed", "C64", "NearbyAngle"];
    assert!(!right.iter().any(|name| is_wrong_type_name(name)));
    let code = "pub(crate) struct One<T> {\n}\nstruct Two(f64);\n// struct Three\nlet type_of = 1;\npub type Four = f64;\n";
    let names: Vec<&str> = declared_types(code).map(|(_, name)| name).collect();
    assert_eq!(names, ["One", "Two", "Four"]);
}

#[test]
fn participles_and_prepositions_are_told_from_verbs_and_nouns() {
    let wrong = ["held", "measured", "over", "by_name", "in_si", "still"];
    assert!(wrong.iter().all(|name| wrong_name(name).is_some()));
    assert!(wrong_private_name("held").is_some() && wrong_private_name("by_name").is_none());
    let right = ["hold", "read", "at_rest", "of", "with_range", "measured_plant", "speed", "is_cancelled"];
    assert!(right.iter().all(|name| wrong_name(name).is_none()));
    let code =
        "pub trait A {\n    fn one(&self);\n}\nimpl B {\n    fn two() {\n    }\n    pub fn three() {}\n}\n";
    let names: Vec<&str> = public_functions(code).iter().map(|found| found.name).collect();
    assert_eq!(names, ["one", "three"]);
}

#[test]
fn every_crate_lists_its_modules_on_its_first_page() {
    for folder in members().iter().filter(|folder| *folder != "tests") {
        let Ok(text) = fs::read_to_string(root().join(folder).join("src/lib.rs")) else { continue };
        let page: String = text.lines().filter(|line| line.starts_with("//!")).collect();
        for module in text.lines().filter_map(|line| line.strip_prefix("pub mod ")?.strip_suffix(';')) {
            let forms = [format!("[`{module}`]"), format!("[`mod@{module}`]"), format!("(mod@{module})")];
            assert!(
                forms.iter().any(|form| page.contains(form)),
                "{folder}/src/lib.rs does not list {module}"
            );
        }
    }
}

#[test]
fn every_dependency_is_used() {
    // `features` depends on packages for their features alone
    for folder in members().iter().filter(|folder| !["tests", "features"].contains(&folder.as_str())) {
        let manifest = manifest(folder);
        let Some(dependencies) = manifest.get("dependencies") else { continue };
        let sources: String = rust_files(&root().join(folder).join("src"))
            .iter()
            .map(|file| fs::read_to_string(file).unwrap())
            .collect();
        for name in dependencies.as_table().unwrap().keys().filter(|name| *name != "counterpoise-features") {
            assert!(sources.contains(&name.replace('-', "_")), "{folder} does not use {name}");
        }
    }
}

#[test]
fn crates_that_run_no_unit_tests_have_none() {
    for folder in members() {
        let manifest = manifest(&folder);
        let runs = manifest
            .get("lib")
            .and_then(|lib| lib.get("test"))
            .is_none_or(|test| test.as_bool() != Some(false));
        if runs {
            continue;
        }
        for file in rust_files(&root().join(&folder).join("src")) {
            let text = fs::read_to_string(&file).unwrap();
            let has_tests = text.lines().any(|line| line.trim_start().starts_with("#[cfg(test)]"));
            assert!(
                !has_tests,
                "{}: [lib] test = false in {folder}/Cargo.toml: its tests would not run",
                file.display()
            );
        }
    }
}

/// Returns the names and texts of a crate's test programs beside the one of all suites: evidence with features of its own.
fn programs_apart(folder: &str) -> Vec<(String, String)> {
    let manifest = manifest(folder);
    let programs = manifest.get("test").and_then(|tests| tests.as_array()).cloned().unwrap_or_default();
    let names = programs.iter().map(|program| program["name"].as_str().unwrap().to_owned());
    names
        .filter(|name| name != "all")
        .map(|name| {
            let code = fs::read_to_string(root().join(folder).join(format!("tests/{name}.rs"))).unwrap();
            (name, code)
        })
        .collect()
}

/// Returns whether a Rust file, or one in a folder, has a test.
fn holds_tests(path: &Path) -> bool {
    if path.is_dir() {
        return rust_files(path).iter().any(|file| holds_tests(file));
    }
    let is_rust = path.extension().is_some_and(|ending| ending == "rs");
    is_rust && fs::read_to_string(path).unwrap().contains("#[test]")
}

#[test]
fn every_suite_is_in_the_program_of_its_crate() {
    for folder in members() {
        let Ok(listed) = fs::read_to_string(root().join(&folder).join("tests/all.rs")) else { continue };
        let apart = programs_apart(&folder);
        for entry in fs::read_dir(root().join(&folder).join("tests")).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_stem().unwrap().to_str().unwrap();
            let is_suite = name != "all" && holds_tests(&path);
            let is_apart =
                apart.iter().any(|(program, code)| program == name || code.contains(&format!("mod {name};")));
            assert!(
                !is_suite || is_apart || listed.contains(&format!("mod {name};")),
                "{folder}/tests/all.rs does not list {name}: its tests would not run"
            );
        }
    }
}

#[test]
fn no_crate_passes_on_the_items_of_another() {
    for folder in members() {
        for (file, code) in sources(&folder) {
            let passed_on = code.lines().find(|line| {
                let line = line.trim_start();
                line.starts_with("pub use counterpoise_") || line.starts_with("pub use faer")
            });
            assert!(passed_on.is_none(), "{}: {}", file.display(), passed_on.unwrap_or_default());
        }
    }
}
