//! The quality of models of physics without a name: machines whose shapes the library does not have, recorded by the independent simulator.
//!
//! `cargo run --release -p counterpoise-tests --bin unnamed -- 1..41` diagnoses the machines of a range of seeds, one line each, and prints
//! the summary; every fourth machine conceals nothing. Single seeds are given as `7`.

use std::sync::Mutex;

use counterpoise_diagnose::diagnose;
use counterpoise_diagnose::findings::answer::{Answer, DiagnosisVerdict};
use counterpoise_diagnose::findings::channel_fits::PooledFits;
use counterpoise_models::reference;
use counterpoise_pool::Serial;
use counterpoise_report::wording::learned::describe_learned;
use counterpoise_tests::sealed::controller;
use counterpoise_tests::sealed::row::recording_of;
use counterpoise_tests::sealed::unnamed_machines::{NOTHING, record_unnamed};

/// Noise floors at which a machine counts as modelled.
const MODELLED: f64 = 1.5;
/// Share of the residual's power that may be left if it is not.
const POWER_LEFT: f64 = 0.05;

/// One machine's score.
struct Score {
    shape: &'static str,
    /// `true` if something was claimed.
    claimed: bool,
    modelled: bool,
    before: f64,
    after: f64,
    seconds: f64,
}

#[allow(clippy::unwrap_used)] // a poisoned lock means that a diagnosis panicked
fn main() {
    let seeds: Vec<u64> = std::env::args().skip(1).flat_map(|text| parse_seeds(&text)).collect();
    let scores = Mutex::new(Vec::new());
    counterpoise_tests::run_in_parallel(seeds.len(), &|k| {
        let score = score_seed(seeds[k]);
        scores.lock().unwrap().extend(score);
    });
    print_summary(&scores.into_inner().unwrap());
}

/// A seed, or a range of seeds.
fn parse_seeds(text: &str) -> Vec<u64> {
    if let Some((Ok(from), Ok(to))) = text.split_once("..").map(|(from, to)| (from.parse(), to.parse())) {
        return (from..to).collect();
    }
    if let Ok(seed) = text.parse() {
        return vec![seed];
    }
    eprintln!("{text} is neither a seed nor a range of seeds, as 1..41");
    Vec::new()
}

fn score_seed(seed: u64) -> Option<Score> {
    let nominal = reference::rig();
    let case = record_unnamed(seed, &nominal);
    let recordings: Vec<_> =
        case.recordings.iter().enumerate().map(|(k, written)| recording_of(k, written)).collect();
    let clock = std::time::Instant::now();
    let found = match diagnose(&nominal, &controller(), &recordings, &Serial) {
        Ok(found) => found,
        Err(error) => {
            println!("{seed}: {}: {error}", case.shape);
            return None;
        }
    };
    let seconds = clock.elapsed().as_secs_f64();
    let score = of(case.shape, &found.answer, seconds);
    let names: Vec<String> =
        found.answer.findings.iter().map(|f| format!("{} {}", f.component, f.effect)).collect();
    println!(
        "{seed}: {}: {:?} [{}] held out {:.2} -> {:.2}, {seconds:.1} s",
        case.shape,
        found.answer.verdict,
        names.join(", "),
        score.before,
        score.after
    );
    for function in found.answer.learned.iter().flat_map(|model| describe_learned(model).functions) {
        println!("    {}; {}", function.reading, function.range);
    }
    Some(score)
}

fn of(shape: &'static str, answer: &Answer, seconds: f64) -> Score {
    let worst = |table: &PooledFits| table.values().map(|c| c.rms_error / c.floor).fold(0.0, f64::max);
    let [before, after] = answer.learned.as_ref().map_or_else(
        || [worst(&answer.fit.held_out_before), worst(&answer.fit.held_out_after)],
        |l| l.worst_held_out,
    );
    let little = answer.learned.as_ref().is_some_and(|l| l.power_left <= POWER_LEFT);
    Score {
        shape,
        claimed: answer.verdict != DiagnosisVerdict::Consistent || answer.learned.is_some(),
        modelled: after <= MODELLED || little,
        before,
        after,
        seconds,
    }
}

fn print_summary(scores: &[Score]) {
    let nothing: Vec<&Score> = scores.iter().filter(|s| s.shape == NOTHING).collect();
    let hidden: Vec<&Score> = scores.iter().filter(|s| s.shape != NOTHING).collect();
    let mut seconds: Vec<f64> = scores.iter().map(|s| s.seconds).collect();
    seconds.sort_by(f64::total_cmp);
    println!(
        "nothing concealed: {} machines, {} false alarms",
        nothing.len(),
        nothing.iter().filter(|s| s.claimed).count()
    );
    println!(
        "concealed: {} machines, modelled to {MODELLED} floors or {:.0} % of the power: {}",
        hidden.len(),
        100.0 * (1.0 - POWER_LEFT),
        hidden.iter().filter(|s| s.modelled).count()
    );
    let mean = |of: &dyn Fn(&Score) -> f64| {
        hidden.iter().map(|s| of(s).ln()).sum::<f64>() / hidden.len().max(1) as f64
    };
    println!(
        "held out, geometric mean of the worst channel: {:.2} floors before, {:.2} after; median time {:.1} s",
        mean(&|s| s.before).exp(),
        mean(&|s| s.after).exp(),
        seconds.get(seconds.len() / 2).copied().unwrap_or(0.0)
    );
}
