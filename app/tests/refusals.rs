//! Weights without a controller, each written into the reference rig's project file and refused by the command line before
//! anything is solved: what is said names the weight, the frequency and what helps, and the exit code is 2.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::path::Path;
use std::process::Command;

const RIG: &str = include_str!("../../examples/reference-rig/project.toml");

const FB_ERROR: &str = "[synth.feedback.error]";
const FB_CONTROL: &str = "[synth.feedback.control]";
const HEAVE_ERROR: &str = "[synth.heave.error]";
const HEAVE_CONTROL: &str = "[synth.heave.control]";
const HEAVE_GENERATOR: &str = "[synth.heave.generator]";
const PITCH_ERROR: &str = "[synth.pitch.error]";
const PITCH_CONTROL: &str = "[synth.pitch.control]";
const PITCH_GENERATOR: &str = "[synth.pitch.generator]";

const LAG: &str = "form = 'lag'\ngain = 1.0\ntime = 0.1";
const LEAD: &str = "form = 'lead'\ngain = 1.0\ntime = 0.1";
const INTEGRAL: &str = "form = 'integral'\ngain = 1.0\ntime = 1.0";
const CONSTANT: &str = "form = 'constant'\ngain = 1.0";
const FREE_FOR_EVER: &str =
    "form = 'zero-pole-gain'\nzeros = [[-1.0, 0.0]]\npoles = [[0.0, 0.0]]\ngain = 1.0";
const UNSTABLE: &str = "form = 'zero-pole-gain'\npoles = [[0.5, 0.0], [-20.0, 0.0]]\ngain = 400.0";
/// Infinite, and zero, at the hub's antiresonance sqrt(3.305e6 / 271.6) of the undamped structure.
const RESONANT: &str = "form = 'zero-pole-gain'\npoles = [[0.0, 110.31151498702857], [0.0, -110.31151498702857]]\nzeros = [[-1.0, 0.0]]\ngain = 100.0";
const NOTCHED: &str =
    "form = 'zero-pole-gain'\nzeros = [[0.0, 110.31151498702857], [0.0, -110.31151498702857]]\ngain = 1e-4";

const HIGH: &str = "at high frequency";
const ZERO: &str = "at zero frequency";
const ANTIRESONANCE: &str = "at 110.3115 rad/s";

/// The table that is given another weight, the weight, and what must be said: the weight's place, the frequency, the
/// suggestion.
const WEIGHTS: [(&str, &str, [&str; 3]); 15] = [
    (FB_CONTROL, LAG, ["feedback, control weight 1 / (0.1 s + 1)", HIGH, "as many zeros as poles"]),
    (HEAVE_CONTROL, LAG, ["heave feedforward, control weight", HIGH, "as many zeros as poles"]),
    (PITCH_CONTROL, LAG, ["pitch feedforward, control weight", HIGH, "as many zeros as poles"]),
    (FB_ERROR, LEAD, ["feedback, error weight 1 (0.1 s + 1)", HIGH, "as many poles as zeros"]),
    (HEAVE_ERROR, LEAD, ["heave feedforward, error weight", HIGH, "as many poles as zeros"]),
    (PITCH_ERROR, LEAD, ["pitch feedforward, error weight", HIGH, "as many poles as zeros"]),
    (FB_CONTROL, FREE_FOR_EVER, ["feedback, control weight", ZERO, "keep one of the two finite"]),
    (FB_ERROR, RESONANT, ["feedback, error weight", ANTIRESONANCE, "use K / (a s + 1)"]),
    (FB_CONTROL, NOTCHED, ["feedback, control weight", ANTIRESONANCE, "not zero there"]),
    (HEAVE_CONTROL, NOTCHED, ["heave feedforward, control weight", ANTIRESONANCE, "not zero there"]),
    (HEAVE_GENERATOR, CONSTANT, ["heave feedforward, generator 1", HIGH, "more poles than zeros"]),
    (
        PITCH_GENERATOR,
        INTEGRAL,
        ["pitch feedforward, generator", ZERO, "move the pole into the left half plane"],
    ),
    (
        HEAVE_GENERATOR,
        UNSTABLE,
        ["heave feedforward, generator", ZERO, "move the pole into the left half plane"],
    ),
    (HEAVE_ERROR, INTEGRAL, ["heave feedforward, error weight 1 / (1 s)", ZERO, "finite at that frequency"]),
    (PITCH_ERROR, INTEGRAL, ["pitch feedforward, error weight 1 / (1 s)", ZERO, "finite at that frequency"]),
];

/// Replacements in the example, and what the refusal has to say.
type Line = (&'static [(&'static str, &'static str)], [&'static str; 2]);

/// Lines in the place of lines, where no one frequency is to blame.
const LINES: [Line; 2] = [
    (
        &[
            ("reference = \"error\"", "reference = \"weight-only\""),
            ("form = \"proportional-integral\"", "form = \"constant\""),
            ("corner = 13.0 ", "# "),
        ],
        ["feedback, error weight 25", "use an error weight with a pole"],
    ),
    (
        &[("[synth.heave]\nmeasurement_noise = 2.5e-8 ", "[synth.heave]\nknowledge = \"exact\" # ")],
        ["heave feedforward, generator", "use a generator of that order"],
    ),
];

/// Returns the file with the body of a table in the place of another, on the undamped structure.
fn with_weight(header: &str, body: &str) -> String {
    let text = RIG.replacen("damping = 277.0 ", "damping = 0.0 ", 1);
    let from = text.find(header).unwrap_or_else(|| panic!("{header}")) + header.len();
    let to = text[from..].find("\n[").map_or(text.len(), |k| from + k);
    format!("{}\n{body}\n{}", &text[..from], &text[to..])
}

fn with_lines(lines: &[(&str, &str)]) -> String {
    lines.iter().fold(RIG.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "the rig's file has no {from}");
        text.replacen(from, to, 1)
    })
}

/// Returns what is wrong with the answer to a file; empty if it is refused in all these words.
fn mistakes_of_answer(name: &str, text: &str, words: &[&str]) -> String {
    let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::write(&file, text).unwrap();
    let run = Command::new(env!("CARGO_BIN_EXE_counterpoise")).arg("synth").arg(&file).output().unwrap();
    let said = String::from_utf8_lossy(&run.stderr).into_owned();
    let missing: Vec<&&str> = words.iter().filter(|word| !said.contains(**word)).collect();
    if run.status.code() == Some(2) && missing.is_empty() {
        return String::new();
    }
    format!("{name}: code {:?}, without {missing:?}:\n{said}\n", run.status.code())
}

#[test]
fn weights_without_a_controller_are_refused_in_words() {
    let of_weights = WEIGHTS.iter().enumerate().map(|(k, (header, body, words))| {
        mistakes_of_answer(&format!("refused-weight-{k}.toml"), &with_weight(header, body), words)
    });
    let of_lines = LINES.iter().enumerate().map(|(k, (lines, words))| {
        mistakes_of_answer(&format!("refused-lines-{k}.toml"), &with_lines(lines), words)
    });
    let wrong: String = of_weights.chain(of_lines).collect();
    assert!(wrong.is_empty(), "{wrong}");
}
