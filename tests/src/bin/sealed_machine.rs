//! The answer of the diagnosis on one sealed machine, with everything that it tried, beside the truth.
//!
//! `cargo run --release -p counterpoise-tests --bin sealed_machine -- 13`; `e12:0.7` is the machine with the effect numbered 12 alone, of
//! size 0.7.

use counterpoise_diagnose::diagnose;
use counterpoise_diagnose::findings::answer::Answer;
use counterpoise_models::{Parameters, reference};
use counterpoise_tests::Threads;
use counterpoise_tests::sealed::oracle::compare_fits;
use counterpoise_tests::sealed::row::{recordings, score};
use counterpoise_tests::sealed::truth::ALL;
use counterpoise_tests::sealed::{Case, case, case_of, controller, nominal_of};

fn main() {
    for text in std::env::args().skip(1) {
        let Some((seed, nominal, case)) = parse_machine(&text) else {
            println!("{text} is neither a seed nor an effect, as e12:0.7");
            continue;
        };
        let clock = std::time::Instant::now();
        match diagnose(&nominal, &controller(), &recordings(&case), &Threads) {
            Ok(found) => print(seed, &nominal, &case, &found.answer, clock.elapsed().as_secs_f64()),
            Err(error) => println!("seed {seed}: {error}"),
        }
    }
}

/// The machine that an argument asks for.
fn parse_machine(text: &str) -> Option<(u64, Parameters, Case)> {
    let Some(effect) = text.strip_prefix('e') else {
        let (seed, nominal) = (text.parse().ok()?, reference::rig());
        let case = case(seed, &nominal);
        return Some((seed, nominal, case));
    };
    let (which, size) = effect.split_once(':').unwrap_or((effect, "1"));
    let which: usize = which.parse().ok().filter(|w| *w < ALL)?;
    let nominal = nominal_of(which);
    let case = case_of(which, size.parse().ok()?, &nominal);
    Some((1_000 + which as u64, nominal, case))
}

fn print(seed: u64, nominal: &Parameters, case: &Case, answer: &Answer, seconds: f64) {
    println!("seed {seed}, noise {}, {seconds:.1} s", case.sealed.noise);
    for concealed in &case.sealed.concealed {
        println!("  {concealed:?}");
    }
    println!("  {:?}", answer.verdict);
    for finding in &answer.findings {
        println!("  {} {} {:.3}", finding.component, finding.effect, finding.probability);
        finding.parameters.iter().for_each(|p| println!("    {} {} {:?}", p.name, p.value, p.ci95));
        finding.alternatives.iter().for_each(|a| println!("    or {} {}", a.component, a.effect));
    }
    for (channel, before) in answer.fit.before.iter() {
        let name = channel.name();
        let after = answer.fit.after.get(channel).map_or(f64::NAN, |c| c.rms_error / c.floor);
        println!("  {name}: {:.3} floors before, {after:.3} after", before.rms_error / before.floor);
    }
    for h in &answer.hypotheses {
        let beside: Vec<String> = h.beside.iter().map(|n| format!("{} {}", n.component, n.effect)).collect();
        let mark = if h.accepted { "*" } else { " " };
        println!(
            "  {mark} stage {} {:<40} gain {:9.1} distance {:.4} worst {:.3} beside {}",
            h.stage,
            format!("{} {}", h.component, h.effect),
            h.log_likelihood_gain,
            h.distance,
            h.worst,
            beside.join(", ")
        );
    }
    let row = score(seed, case, answer, seconds);
    println!("  sizes {:.2?}, errors {:.2?}", row.sizes, row.errors);
    match compare_fits(nominal, case, answer) {
        Ok(split) => println!("  nominal, refitted, found, truth: {split:.4?}"),
        Err(error) => println!("  {error}"),
    }
}
