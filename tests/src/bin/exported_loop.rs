//! Scores the diagnosis of the eight practice effects in recordings under the controller that the reference rig exports, as a table.
//!
//! `cargo run --release -p counterpoise-tests --bin exported_loop` prints one row an effect: replayed with the controller read from its
//! own `controller.json`, with the recorded control played back, and, for comparison, recorded under and replayed with a
//! proportional-integral controller. `exported_loop 3` takes the effect of that number alone, from 1. It fails if an effect is missed.

use counterpoise_diagnose::findings::answer::DiagnosisVerdict;
use counterpoise_tests::Threads;
use counterpoise_tests::exported_loop::{CheckedDiagnosis, RecordedLoop, record_and_diagnose};
use counterpoise_tests::sealed::PRACTICE;

fn main() {
    let only: Option<usize> = std::env::args().nth(1).and_then(|number| number.parse().ok());
    println!(
        "| effect | exported, closed loop | exported, played back | proportional-integral |\n|---|---|---|---|"
    );
    let mut missed = 0;
    for (k, effect) in PRACTICE.iter().enumerate().filter(|(k, _)| only.is_none_or(|only| only == k + 1)) {
        let clock = std::time::Instant::now();
        let all = RecordedLoop::ALL.map(|way| record_and_diagnose(effect, way, &Threads));
        missed += all.iter().filter(|one| !one.is_right).count();
        let cells = all.iter().map(cell).collect::<Vec<_>>().join(" | ");
        println!("| {} | {cells} |", effect.name);
        eprintln!("effect {}: {:.0} s", k + 1, clock.elapsed().as_secs_f64());
    }
    println!("\n{missed} missed");
    std::process::exit(i32::from(missed > 0));
}

/// The verdict, what was found with its parameters, and whether it is right.
fn cell(one: &CheckedDiagnosis) -> String {
    let answer = &one.answer;
    let found = answer.findings.iter().map(|finding| {
        let (component, effect) = finding.name().names();
        let parameters = finding.parameters.iter().map(|p| format!("{} {:.4}", p.name, p.value));
        let alternatives = finding.alternatives.iter().map(|name| name.names().1).collect::<Vec<_>>();
        let or =
            if alternatives.is_empty() { String::new() } else { format!(" or {}", alternatives.join(", ")) };
        format!("{component} {effect} ({}){or}", parameters.collect::<Vec<_>>().join(", "))
    });
    let verdict = match answer.verdict {
        DiagnosisVerdict::Consistent => "consistent".to_owned(),
        _ => format!("{:?}: {}", answer.verdict, found.collect::<Vec<_>>().join("; ")),
    };
    if one.is_right { verdict } else { format!("**missed**: {verdict}") }
}
