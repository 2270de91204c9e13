//! Numbers that decide stand in the tolerance file of their crate.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use counterpoise_tests::workspace::{members, root, sources};

/// Files with numbers below 1e-5 that decide nothing: units, physical values, ends of axes, and a probability that follows from its neighbour.
const SMALL_NUMBERS: [&str; 14] = [
    "claims/src/structure.rs",
    "diagnose/src/library/drive.rs",
    "export/src/rounding.rs",
    "pipeline/src/reduction_views.rs",
    "project/src/resolve/loop_sensor.rs",
    "recordings/src/clock.rs",
    "recordings/src/decode/numpy.rs",
    "recordings/src/time_unit.rs",
    "recordings/src/unit/table.rs",
    "report/src/targets.rs",
    "studio/src/number_format.rs",
    "studio/src/pages/weight_plot.rs",
    "verify/src/image_motion.rs",
    "verify/src/signals/iso_road.rs",
];

/// Returns whether a line of code has a number below 1e-5.
fn has_small_number(line: &str) -> bool {
    let code = line.split("//").next().unwrap();
    code.match_indices("e-").any(|(at, _)| {
        let is_number = code[..at].ends_with(|letter: char| letter.is_ascii_digit());
        let exponent: String = code[at + 2..].chars().take_while(char::is_ascii_digit).collect();
        is_number && exponent.parse::<u32>().is_ok_and(|exponent| exponent > 5)
    })
}

/// Words of a comment that speak of a number which something is compared with.
const COMPARING_WORDS: [&str; 24] = [
    "above this",
    "above which",
    "at least this",
    "at most this",
    "below this",
    "below which",
    "beyond this",
    "beyond which",
    "by more than",
    "cannot be told",
    "counts as",
    "from which on",
    "is refused",
    "larger than this",
    "less than this",
    "may be late",
    "may differ",
    "may exceed",
    "may have",
    "more than this",
    "must be",
    "smaller than this",
    "up to which",
    "within this",
];

/// First words of a constant's name that speak of the same.
const COMPARING_NAMES: [&str; 5] = ["FEWEST_", "LARGEST_", "LEAST_", "MOST_", "SMALLEST_"];

/// A constant that reads like a tolerance and is none.
struct NoTolerance {
    file: &'static str,
    name: &'static str,
    why: NoToleranceReason,
}

/// Why a constant is no tolerance.
#[derive(Debug, Clone, Copy)]
enum NoToleranceReason {
    /// A value of a model or of a law of control: it shapes what is computed, and decides no answer.
    Model,
    /// Points or ends of a grid.
    Grid,
    /// It decides what a page shows or how it writes a number.
    Page,
}

const fn no(file: &'static str, name: &'static str, why: NoToleranceReason) -> NoTolerance {
    NoTolerance { file, name, why }
}

/// Every constant that reads like a tolerance and is none, with the reason.
const NO_TOLERANCES: [NoTolerance; 11] = [
    no("models/src/parameters/cylinder.rs", "LAMINAR_SHARE", NoToleranceReason::Model),
    no("models/src/parameters/drive_limits.rs", "FOLD_K", NoToleranceReason::Model),
    no("pipeline/src/reduction_views.rs", "SMALLEST_ERROR", NoToleranceReason::Page),
    no("pipeline/src/synth/friction_observers.rs", "BREAKAWAY_RAD", NoToleranceReason::Model),
    no("pipeline/src/tuning.rs", "HIGHEST_SHARE", NoToleranceReason::Grid),
    no("pipeline/src/tuning.rs", "MOST_LINES", NoToleranceReason::Grid),
    no("project/src/file/setting.rs", "LARGEST_PLAIN", NoToleranceReason::Page),
    no("project/src/file/setting.rs", "SMALLEST_PLAIN", NoToleranceReason::Page),
    no("synth/src/first_design/feedforwards.rs", "ROLL_OFF", NoToleranceReason::Model),
    no("synth/src/tuning/starts.rs", "CROSSOVERS", NoToleranceReason::Grid),
    no("verify/src/linear_loop/root_locus.rs", "LEAST_GAIN", NoToleranceReason::Grid),
];

/// A constant with a real value: its line, its name and what its comment says, in lower case.
struct RealConstant<'a> {
    line: usize,
    name: &'a str,
    comment: String,
}

impl RealConstant<'_> {
    /// Returns whether it reads like a number that something is compared with.
    fn reads_like_a_tolerance(&self) -> bool {
        COMPARING_WORDS.iter().any(|words| self.comment.contains(words))
            || COMPARING_NAMES.iter().any(|start| self.name.starts_with(start))
    }
}

/// Returns the constants of a source whose type has real numbers in it.
fn real_constants(code: &str) -> Vec<RealConstant<'_>> {
    let (mut found, mut comment) = (Vec::new(), String::new());
    for (number, line) in code.lines().enumerate() {
        let text = line.trim_start();
        if let Some(said) = text.strip_prefix("///") {
            comment += &said.to_lowercase();
            continue;
        }
        let is_constant = |before: &str| before.is_empty() || before.starts_with("pub");
        let after = text
            .split_once("const ")
            .filter(|(before, after)| is_constant(before) && !after.starts_with("fn "));
        if let Some((name, rest)) = after.and_then(|(_, after)| after.split_once(": "))
            && rest.split_once(" =").is_some_and(|(kind, _)| kind.contains("f64"))
        {
            found.push(RealConstant { line: number + 1, name, comment: comment.clone() });
        }
        comment.clear();
    }
    found
}

/// Returns the sources of the product outside of tolerance files, with their paths in the repository.
fn sources_beside_tolerances() -> Vec<(String, String)> {
    let above = ["features", "tests"];
    let folders = members().into_iter().filter(|folder| !above.contains(&folder.as_str()));
    let all = folders.flat_map(|folder| sources(&folder)).map(|(file, code)| {
        let path = file.strip_prefix(root()).unwrap().to_str().unwrap().replace('\\', "/");
        (path, code)
    });
    all.filter(|(path, _)| !path.contains("tolerance") && !path.ends_with("tests.rs")).collect()
}

#[test]
fn tolerances_stand_in_the_tolerance_file_of_their_crate() {
    let (mut wrong, mut needed) = (Vec::new(), Vec::new());
    for (path, code) in sources_beside_tolerances() {
        for constant in real_constants(&code).iter().filter(|constant| constant.reads_like_a_tolerance()) {
            let is_this = |one: &NoTolerance| (one.file, one.name) == (path.as_str(), constant.name);
            match NO_TOLERANCES.iter().position(is_this) {
                Some(at) => needed.push(at),
                None => wrong.push(format!("{path}:{}: {}", constant.line, constant.name)),
            }
        }
    }
    assert!(wrong.is_empty(), "constants that decide, outside of a tolerance file:\n{}", wrong.join("\n"));
    for (at, NoTolerance { file, name, why }) in NO_TOLERANCES.iter().enumerate() {
        assert!(needed.contains(&at), "{file}: {name} is no exception ({why:?}): leave it out of the list");
    }
}

#[test]
fn constants_that_decide_are_told_from_others() {
    let code = "/// Share below which\n/// a mode is none.\npub(crate) const SHARE: f64 = 0.1;\n\n/// Ends of the grid.\nconst ENDS: [f64; 2] = [0.1, 1.0];\nconst MOST_TILT: f64 = 0.8;\nconst COUNT: usize = 3;\n";
    let found = real_constants(code);
    let told: Vec<_> = found.iter().map(|one| (one.line, one.name, one.reads_like_a_tolerance())).collect();
    assert_eq!(told, [(3, "SHARE", true), (6, "ENDS", false), (7, "MOST_TILT", true)]);
}

#[test]
fn small_numbers_stand_in_the_tolerance_file_of_their_crate() {
    let mut wrong = Vec::new();
    for folder in members() {
        for (file, code) in sources(&folder) {
            let path = file.strip_prefix(root()).unwrap().to_str().unwrap().replace('\\', "/");
            let is_exempt = SMALL_NUMBERS.iter().any(|exempt| path.starts_with(exempt));
            if is_exempt || path.contains("tolerance") || path.ends_with("tests.rs") || folder == "tests" {
                continue;
            }
            let lines = code.lines().enumerate().filter(|(_, line)| has_small_number(line));
            wrong.extend(lines.map(|(number, line)| format!("{path}:{}: {}", number + 1, line.trim())));
        }
    }
    assert!(wrong.is_empty(), "numbers that may decide, outside of a tolerance file:\n{}", wrong.join("\n"));
}

/// Returns the number that a text begins with, as it is written; `None` if it begins with none.
fn leading_number(text: &str) -> Option<&str> {
    let is_exponent = |at: usize| text[..at].ends_with('e');
    let belongs = |(at, letter): (usize, char)| {
        letter.is_ascii_digit() || matches!(letter, '.' | '_' | 'e') || (letter == '-' && is_exponent(at))
    };
    let end = text.char_indices().find(|one| !belongs(*one)).map_or(text.len(), |(at, _)| at);
    text.starts_with(|letter: char| letter.is_ascii_digit()).then_some(&text[..end])
}

/// Returns whether a number decides rather than counts: it lies between 0 and 0.1, or it is a ratio just above 1.
fn reads_like_a_threshold(number: &str) -> bool {
    let value: f64 = number.replace('_', "").parse().unwrap_or(0.0);
    value > 0.0 && value < 0.1 || value > 1.0 && value < 1.1
}

/// Returns the numbers that a line of code compares something with and that read like a threshold.
fn compared_numbers(line: &str) -> Vec<&str> {
    let code = line.split("//").next().unwrap();
    let signs = code.match_indices(['<', '>']).filter(|(at, _)| !code[..*at].ends_with(['=', '-']));
    let after = signs.map(|(at, _)| code[at + 1..].trim_start_matches('=').trim_start());
    after.filter_map(leading_number).filter(|number| reads_like_a_threshold(number)).collect()
}

#[test]
fn compared_numbers_stand_in_the_tolerance_file_of_their_crate() {
    let mut wrong = Vec::new();
    for (path, code) in sources_beside_tolerances() {
        for (number, line) in code.lines().enumerate().filter(|(_, line)| !compared_numbers(line).is_empty())
        {
            wrong.push(format!("{path}:{}: {}", number + 1, line.trim()));
        }
    }
    assert!(wrong.is_empty(), "numbers that decide, outside of a tolerance file:\n{}", wrong.join("\n"));
}

#[test]
fn thresholds_are_told_from_counts() {
    let threshold = ["a < 1e-3 * b", "if a.abs() >= 0.01 {", "while high > 1.0001 * low"];
    assert!(threshold.iter().all(|line| !compared_numbers(line).is_empty()));
    let others =
        ["a > 0.0", "a < 1.0", "a < 0.5 * b", "\"ms\" => 1e-3,", "Vec<f64> = 0.01", "a // < 0.01", "n >= 2"];
    assert!(others.iter().all(|line| compared_numbers(line).is_empty()));
}
