//! The programs that replay recorded readings through the generated code on this machine: programs and command lines; nothing is run
//! here.
//!
//! Code that answers every reading of a closed loop's run as its model does moves the plant as the model does: the first
//! control is the same, so is the next reading, and so on.

use counterpoise_controller::{READING_NAMES, READINGS};

use crate::fixed_point::{FixedPointController, to_integer, unit};
use crate::targets::Record;
use crate::{File, Numbers};

/// The C compiler.
pub const C_COMPILER: &str = "cc";
/// Its flags, up to the sources: without a warning, and no product contracted with a sum. Generated files lie in
/// [`CODE_FOLDER`].
pub const C_FLAGS: [&str; 9] = [
    "-std=c99",
    "-O1",
    "-ffp-contract=off",
    "-Wall",
    "-Wextra",
    "-pedantic",
    "-Werror",
    "-iquote",
    CODE_FOLDER,
];
/// Folder that generated C code is written to before it is compiled. The name of a generated file is a project's own, so
/// it never stands on a command line: a program of a fixed name includes it ([`including_file`]).
pub const CODE_FOLDER: &str = "code";
/// Name under which the generated Rust crate is compiled, whatever the project calls it.
pub const RUST_CRATE: &str = "generated";
/// The Rust compiler.
pub const RUST_COMPILER: &str = "rustc";
/// Its flags for the generated crate, up to the source.
pub const RUST_LIBRARY: [&str; 4] = ["--edition=2021", "-O", "--crate-type=lib", "-Dwarnings"];
/// Its flags for the program that replays, up to the source.
pub const RUST_PROGRAM: [&str; 6] = ["--edition=2021", "-O", "-L.", "-Dwarnings", "-o", "replay"];

/// Returns the program that replays readings through C code of a name: `replay.c`.
pub fn c_replay(name: &str, numbers: Numbers) -> File {
    let fixed = if numbers == Numbers::Fixed { "#define AXIS_FIXED\n" } else { "" };
    let text = format!("{fixed}{}", include_str!("../target/replay.c"));
    File { name: "replay.c".into(), text: text.replace("axis", name).replace("AXIS", &name.to_uppercase()) }
}

/// Returns one interface before the C code of a name, for machines that run it: `machine_step.c`.
pub fn machine_step(name: &str) -> File {
    let text = include_str!("../target/machine_step.c");
    File { name: "machine_step.c".into(), text: text.replace("axis", name) }
}

/// Returns the program that replays readings through the Rust crate compiled as [`RUST_CRATE`]: `replay.rs`, for a controller that takes so many
/// readings.
pub fn rust_replay(readings: usize) -> File {
    let not_taken = |line: &&str| READING_NAMES[readings..].iter().any(|name| line.contains(name));
    let lines = include_str!("../target/replay.rs").lines().filter(|line| !not_taken(line));
    let text: String = lines.flat_map(|line| [line, "\n"]).collect();
    File { name: "replay.rs".into(), text: text.replace("axis", RUST_CRATE) }
}

/// Returns a C file of a fixed name that is nothing but the generated file `included`, given with its folder: a project may call its
/// code by the fixed name itself, and a file must not include itself.
pub fn including_file(name: &str, included: &str) -> File {
    File { name: name.to_owned(), text: format!("#include \"{included}\"\n") }
}

/// Returns samples as bytes for the replaying programs: every record begins with a sample of no numbers. In fixed point the
/// readings are integers in their formats.
pub fn encode_requests(records: &[Record], fixed: Option<&FixedPointController>) -> Vec<u8> {
    let number = |value: f64, i: usize| match fixed {
        None => value,
        Some(fixed) => fixed.step.inputs.get(i).map_or(0.0, |bits| to_integer(value, *bits) as f64),
    };
    let mut bytes = Vec::new();
    for record in records {
        bytes.extend([f64::NAN; READINGS].iter().flat_map(|value| value.to_ne_bytes()));
        for readings in &record.readings {
            bytes.extend(readings.iter().enumerate().flat_map(|(i, value)| number(*value, i).to_ne_bytes()));
        }
    }
    bytes
}

/// Returns the number of samples and how many of the answers differ from the records. Returns `None` if answers are missing.
pub fn count_differing(
    records: &[Record],
    fixed: Option<&FixedPointController>,
    answers: &[u8],
) -> Option<(usize, usize)> {
    let scale = fixed.map_or(1.0, |fixed| unit(fixed.control_bits()));
    let mut values =
        answers.chunks_exact(8).map(|chunk| f64::from_ne_bytes(chunk.try_into().unwrap_or([0; 8])));
    let (mut samples, mut wrong) = (0, 0);
    for record in records {
        values.next()?;
        for control_v in &record.controls_v {
            samples += 1;
            wrong += usize::from((values.next()? * scale).to_bits() != control_v.to_bits());
        }
    }
    Some((samples, wrong))
}
