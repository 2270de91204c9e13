//! A machine whose truth is concealed, diagnosed: a found name must never make data worse that was not fitted.
//!
//! `COUNTERPOISE_SEEDS=0..40 cargo test --release -p counterpoise-tests --test all sealed -- --nocapture` scores more of them.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use counterpoise_diagnose::diagnose;
use counterpoise_diagnose::findings::answer::Answer;
use counterpoise_models::{Parameters, reference};
use counterpoise_tests::Threads;
use counterpoise_tests::sealed::row::recordings;
use counterpoise_tests::sealed::table::upper_bound;
use counterpoise_tests::sealed::{MachineFamily, SealedAnswer, case, controller};

fn seeds() -> std::ops::Range<u64> {
    let asked = std::env::var("COUNTERPOISE_SEEDS").ok();
    let bounds = asked.as_deref().and_then(|text| text.split_once(".."));
    let parse = |(a, b): (&str, &str)| Some(a.parse().ok()?..b.parse().ok()?);
    bounds.and_then(parse).unwrap_or(5..6)
}

/// Returns whether every concealed effect was named and nothing else, by its name or by that of an equivalent effect.
fn right(sealed: &SealedAnswer, answer: &Answer) -> bool {
    let named = |c: &counterpoise_tests::sealed::ConcealedEffect| {
        answer.findings.iter().any(|f| {
            f.name().names() == (c.component, c.effect)
                || c.also.contains(&f.name().names())
                || f.alternatives.iter().any(|a| a.names() == (c.component, c.effect))
        })
    };
    match sealed.family {
        MachineFamily::Nothing => answer.findings.is_empty(),
        MachineFamily::Outside => answer.findings.iter().all(|f| f.effect.name() == "unknown"),
        _ => answer.findings.len() == sealed.concealed.len() && sealed.concealed.iter().all(named),
    }
}

#[test]
fn a_name_never_makes_data_worse_that_was_not_fitted() {
    let nominal: Parameters = reference::rig();
    let controller = controller();
    let (mut good, mut all) = (0, 0);
    for seed in seeds() {
        let case = case(seed, &nominal);
        let found = diagnose(&nominal, &controller, &recordings(&case), &Threads).unwrap();
        let answer = &found.answer;
        let right = right(&case.sealed, answer);
        (good, all) = (good + usize::from(right), all + 1);
        let truth: Vec<_> = case.sealed.concealed.iter().map(|c| (c.component, c.effect, c.size)).collect();
        let names: Vec<_> = answer.findings.iter().map(|f| (f.component, f.effect)).collect();
        println!(
            "seed {seed}: right {right}, {:?} {truth:?}, {:?} {names:?}",
            case.sealed.family, answer.verdict
        );
        for (channel, after) in answer.fit.held_out_after.iter() {
            let (name, before) = (channel.name(), answer.fit.held_out_before.get(channel).unwrap());
            assert!(after.rms_error < 1.05 * before.rms_error.max(before.floor), "seed {seed}, {name}");
        }
    }
    println!("{good} of {all} right");
}

#[test]
fn upper_bound_of_a_rate() {
    // none of n: 1 - 0.05^(1 / n); 2 of 49 and 1 of 15 as the beta distribution's quantiles have them
    assert!((upper_bound(0, 49) - (1.0 - 0.05f64.powf(1.0 / 49.0))).abs() < 1e-9);
    assert!((upper_bound(2, 49) - 0.122_97).abs() < 1e-4, "{}", upper_bound(2, 49));
    assert!((upper_bound(1, 15) - 0.279_4).abs() < 1e-4, "{}", upper_bound(1, 15));
    assert_eq!(upper_bound(0, 0), 1.0);
}
