//! Scores the diagnosis on machines whose truth is concealed; one line a seed is added to a file, and seeds that are
//! in it already are passed over.
//!
//! `cargo run --release -p counterpoise-tests --bin sealed -- 1..141 target/sealed.jsonl`; seeds from 1000 on are the machines with one
//! effect each of the whole vocabulary, of a size that is easily seen. `sealed --calibrate FILE` counts anew how often each kind of answer
//! was true: the probabilities that the diagnosis states.

use std::io::Write;
use std::sync::Mutex;

use counterpoise_diagnose::{bench::Serial, diagnose};
use counterpoise_models::reference;
use counterpoise_tests::sealed::oracle::compared;
use counterpoise_tests::sealed::row::{recordings, scored};
use counterpoise_tests::sealed::truth::ALL;
use counterpoise_tests::sealed::{Row, case, case_of, controller, nominal_of, table};

fn main() -> std::io::Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let [flag, path] = arguments.as_slice()
        && flag == "--calibrate"
    {
        let known = std::fs::read_to_string(path)?;
        let rows: Vec<Row> = known.lines().filter_map(|line| serde_json::from_str(line).ok()).collect();
        println!("{}", table::calibration(&rows));
        return Ok(());
    }
    let [range, path] = arguments.as_slice() else { return usage("two arguments are needed") };
    let Some(seeds) = parsed(range) else { return usage(range) };
    let known = std::fs::read_to_string(path).unwrap_or_default();
    let mut rows: Vec<Row> = known.lines().filter_map(|line| serde_json::from_str(line).ok()).collect();
    let last = FIRST_EFFECT + ALL as u64;
    let left: Vec<u64> =
        seeds.take_while(|seed| *seed < last).filter(|seed| !rows.iter().any(|r| r.seed == *seed)).collect();
    let file = std::fs::OpenOptions::new().create(true).append(true).open(path)?;
    let file = Mutex::new(file);
    let fresh = Mutex::new(Vec::new());
    counterpoise_tests::in_parallel(left.len(), &|k| {
        let row = match row(left[k]) {
            Ok(row) => row,
            Err(error) => return eprintln!("seed {}: {error}", left[k]),
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

fn usage(wrong: &str) -> std::io::Result<()> {
    let message = format!("{wrong}; usage: sealed FIRST..END FILE, as in sealed 1..141 target/sealed.jsonl");
    Err(std::io::Error::other(message))
}

fn parsed(range: &str) -> Option<std::ops::Range<u64>> {
    let (first, end) = range.split_once("..")?;
    Some(first.parse().ok()?..end.parse().ok()?)
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
    let mut row = scored(seed, &case, &found.answer, clock.elapsed().as_secs_f64());
    row.split = compared(&nominal, &case, &found.answer)?;
    Ok(row)
}
