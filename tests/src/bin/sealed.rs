//! Scores the diagnosis on machines whose truth is concealed; one line a seed is added to a file, and seeds that are
//! in it already are passed over.
//!
//! `cargo run --release -p counterpoise-tests --bin sealed -- 1..141 target/sealed.jsonl`; seeds from 1000 on are the machines with one
//! effect each of the whole vocabulary, of a size that is easily seen. Instead of one range there may be several and single seeds, as in
//! `16,33,141..201`. `sealed --nothing 601..801 FILE` runs those machines of a range only that have nothing concealed: false alarms are
//! counted five times as fast. `sealed --calibrate FILE` counts how often each kind of answer was true: the probabilities that the
//! diagnosis states.

use std::io::Write;
use std::sync::Mutex;

use counterpoise_diagnose::diagnose;
use counterpoise_models::reference;
use counterpoise_pool::Serial;
use counterpoise_tests::sealed::oracle::compare_fits;
use counterpoise_tests::sealed::row::{recordings, score};
use counterpoise_tests::sealed::truth::{ALL, conceal, machine};
use counterpoise_tests::sealed::{MachineFamily, Row, case, case_of, controller, nominal_of, table};

fn main() -> std::io::Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words.as_slice() {
        ["--calibrate", path] => {
            println!("{}", table::calibration(&read_scores(path)?));
            Ok(())
        }
        ["--nothing", seeds, path] => match parse_seeds(seeds) {
            Some(seeds) => run(seeds.into_iter().filter(|s| has_nothing(*s)).collect(), path),
            None => usage(seeds),
        },
        [seeds, path] => parse_seeds(seeds).map_or_else(|| usage(seeds), |seeds| run(seeds, path)),
        _ => usage("two arguments are needed"),
    }
}

/// Diagnoses the machines that are not in the file yet, adds a line each to it, and prints the page of all that are.
fn run(mut seeds: Vec<u64>, path: &str) -> std::io::Result<()> {
    let mut rows = if std::path::Path::new(path).exists() { read_scores(path)? } else { Vec::new() };
    seeds.retain(|seed| *seed < FIRST_EFFECT + ALL as u64 && !rows.iter().any(|r| r.seed == *seed));
    let file = std::fs::OpenOptions::new().create(true).append(true).open(path)?;
    let file = Mutex::new(file);
    let fresh = Mutex::new(Vec::new());
    counterpoise_tests::run_in_parallel(seeds.len(), &|k| {
        let row = match row(seeds[k]) {
            Ok(row) => row,
            Err(error) => return eprintln!("seed {}: {error}", seeds[k]),
        };
        let line = serde_json::to_string(&row).unwrap_or_default();
        println!("{line}");
        if let (Ok(mut file), Ok(mut fresh)) = (file.lock(), fresh.lock()) {
            match writeln!(file, "{line}") {
                Ok(()) => fresh.push(row),
                Err(error) => eprintln!("{path}: {error}"),
            }
        }
    });
    rows.extend(fresh.into_inner().unwrap_or_default());
    rows.sort_by_key(|row| row.seed);
    println!("{}", table::page(&rows));
    Ok(())
}

/// The scores in a file.
fn read_scores(path: &str) -> std::io::Result<Vec<Row>> {
    let text = std::fs::read_to_string(path)?;
    Ok(text.lines().filter_map(|line| serde_json::from_str(line).ok()).collect())
}

fn usage(wrong: &str) -> std::io::Result<()> {
    let message = format!(
        "{wrong}; usage: sealed [--nothing] SEEDS FILE, as in sealed 1..141 target/sealed.jsonl or sealed 16,33,141..201 FILE \
         (--nothing: only the machines of these seeds with nothing concealed); or: sealed --calibrate FILE"
    );
    Err(std::io::Error::other(message))
}

/// Seeds and ranges of seeds, parted by commas.
fn parse_seeds(seeds: &str) -> Option<Vec<u64>> {
    let one = |part: &str| -> Option<std::ops::Range<u64>> {
        let Some((first, end)) = part.split_once("..") else {
            let seed: u64 = part.parse().ok()?;
            return Some(seed..seed + 1);
        };
        Some(first.parse().ok()?..end.parse().ok()?)
    };
    let last = FIRST_EFFECT + ALL as u64;
    let ranges = seeds.split(',').map(one).collect::<Option<Vec<_>>>()?;
    Some(ranges.into_iter().flat_map(|range| range.start..range.end.min(last)).collect())
}

/// Returns whether the machine of a seed has nothing concealed.
fn has_nothing(seed: u64) -> bool {
    seed < FIRST_EFFECT && conceal(seed, &mut machine(&reference::rig())).0.family == MachineFamily::Nothing
}

/// The seed of the machine with the first effect of the vocabulary alone.
const FIRST_EFFECT: u64 = 1_000;
/// Size of those effects.
const EASILY_SEEN: f64 = 0.7;

fn row(seed: u64) -> Result<Row, counterpoise_diagnose::Error> {
    let effect = seed.checked_sub(FIRST_EFFECT).map(|effect| effect as usize);
    let nominal = effect.map_or_else(reference::rig, nominal_of);
    let case = match effect {
        Some(effect) => case_of(effect, EASILY_SEEN, &nominal),
        None => case(seed, &nominal),
    };
    let clock = std::time::Instant::now();
    let found = diagnose(&nominal, &controller(), &recordings(&case), &Serial)?;
    let mut row = score(seed, &case, &found.answer, clock.elapsed().as_secs_f64());
    if case.sealed.family != MachineFamily::Nothing {
        row.split = compare_fits(&nominal, &case, &found.answer)?;
    }
    Ok(row)
}
