//! Trials of the default adaptation on random mechanisms, as a table in Markdown.
//!
//! `cargo run --release -p counterpoise-tests --bin adaptation -- 0..12 [NOISE]`: with a number, the sensors' noise of the trials has another seed than
//! that of the trials by which the default was chosen.

use std::process::ExitCode;
use std::sync::{Mutex, PoisonError};

use counterpoise_tests::adaptation::{AdaptationCase, trial};
use counterpoise_tests::run_in_parallel;

fn main() -> ExitCode {
    let range = std::env::args().nth(1).unwrap_or_else(|| "0..12".to_owned());
    let ends = range
        .split_once("..")
        .and_then(|(from, to)| Some((from.parse::<u64>().ok()?, to.parse::<u64>().ok()?)));
    let Some((from, to)) = ends else {
        eprintln!("{range}: write FROM..TO, for example 0..12");
        return ExitCode::from(2);
    };
    let noise = std::env::args().nth(2).and_then(|word| word.parse::<u64>().ok()).unwrap_or(0);
    let cases = Mutex::new(Vec::new());
    run_in_parallel(to.saturating_sub(from) as usize, &|k| {
        if let Some(case) = trial(from + k as u64, noise) {
            cases.lock().unwrap_or_else(PoisonError::into_inner).push(case);
        }
    });
    let mut cases = cases.into_inner().unwrap_or_else(PoisonError::into_inner);
    cases.sort_by_key(|case| case.seed);
    print(&cases);
    ExitCode::SUCCESS
}

fn print(cases: &[AdaptationCase]) {
    let is_detailed = std::env::var_os("COUNTERPOISE_EVERY_TRIAL").is_some();
    println!(
        "| seed | mechanism | acts | hub rate over that without adaptation, worst trial | least share removed | refused |"
    );
    println!("|---|---|---|---|---|---|");
    for case in cases {
        let worst = case.worst_trial().map_or(String::new(), |row| {
            format!(
                "{:.4} ({:?}, {:?}; told {:.4})",
                row.ratio(),
                row.motion,
                row.load,
                row.told_rad_s / row.without_rad_s
            )
        });
        let acts = case.bands.map_or("nowhere".to_owned(), |bands| {
            format!("above {:.2} m/s^2, beyond {:.1} %", bands.dead_band_m_s2, 100.0 * bands.hold_band)
        });
        let removed = case
            .least_removed()
            .map_or("the load adds too little".to_owned(), |share| format!("{:.0} %", 100.0 * share));
        println!(
            "| {} | {} | {acts} | {worst} | {removed} | {} |",
            case.seed,
            case.drawn,
            if case.is_refused { "yes" } else { "no" }
        );
        for row in case.rows.iter().filter(|_| is_detailed) {
            let [without, with, told] =
                [row.without_rad_s, row.with_rad_s, row.told_rad_s].map(|rate| 1e3 * rate);
            println!(
                "    {:?} {:?}: none {without:.3}, adapted {with:.3}, told {told:.3}, removed {:.2?}",
                row.motion,
                row.load,
                row.removed_share()
            );
        }
    }
    let count = |what: &dyn Fn(&&AdaptationCase) -> bool| cases.iter().filter(what).count();
    println!(
        "\n{} mechanisms, {} with adaptation; never worse than none: {}; at least 80 % removed: {}; refused: {}",
        cases.len(),
        count(&|case| case.bands.is_some()),
        count(&|case| case.is_never_worse()),
        count(&|case| case.removes_enough()),
        count(&|case| case.is_refused)
    );
}
