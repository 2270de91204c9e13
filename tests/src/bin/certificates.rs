//! Certificates of random mechanisms and controllers against an independent simulator, as a table in Markdown.
//!
//! `cargo run --release -p counterpoise-tests --bin certificates -- 0..300`

use std::process::ExitCode;
use std::sync::{Mutex, PoisonError};

use counterpoise_project::Project;
use counterpoise_tests::certificates::{CertificateRow, scheduled_trials, trial};
use counterpoise_tests::run_in_parallel;
use counterpoise_verify::certificate::Stability;

fn main() -> ExitCode {
    let range = std::env::args().nth(1).unwrap_or_else(|| "0..300".to_owned());
    match certify(&range) {
        Ok(rows) => {
            print(&rows);
            ExitCode::SUCCESS
        }
        Err(why) => {
            eprintln!("{why}");
            ExitCode::from(2)
        }
    }
}

fn certify(range: &str) -> Result<Vec<CertificateRow>, String> {
    let usage = || format!("{range}: write FROM..TO, for example 0..300");
    let (from, to) = range.split_once("..").ok_or_else(usage)?;
    let number = |text: &str| text.parse::<u64>().map_err(|_| usage());
    let (from, to) = (number(from)?, number(to)?);
    let path = "examples/reference-rig/project.toml";
    let text = std::fs::read_to_string(path)
        .map_err(|why| format!("{path}: {why}; run this from the repository's root"))?;
    let base = Project::parse(&text, "project.toml").map_err(|errors| format!("{path}: {errors:?}"))?.project;
    let rows = Mutex::new(Vec::new());
    run_in_parallel(to.saturating_sub(from) as usize, &|k| {
        let seed = from + k as u64;
        let found = trial(seed, &base).into_iter().chain(scheduled_trials(seed, &base));
        let found: Vec<CertificateRow> = found.collect();
        rows.lock().unwrap_or_else(PoisonError::into_inner).extend(found);
    });
    let mut rows = rows.into_inner().unwrap_or_else(PoisonError::into_inner);
    rows.sort_by_key(|row| row.seed);
    Ok(rows)
}

fn print(rows: &[CertificateRow]) {
    println!(
        "| seed | blocks | certificate | rest, noise floors | growth in motion | rest, run | cycle, certificate | cycle, run set moving at its amplitude | proof | worst regime |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    for row in rows {
        let found = &row.certificate;
        let word = match found.stability {
            Stability::Stable => "stable",
            Stability::LimitCycle { .. } => "limit cycle",
            Stability::Unstable => "unstable",
            Stability::NotPredicted => "not predicted",
        };
        let cycle = match found.stability {
            Stability::LimitCycle { amplitude_rad_s, frequency_hz } => {
                format!("{:.3} mrad/s, {frequency_hz:.2} Hz", 1e3 * amplitude_rad_s)
            }
            _ => String::new(),
        };
        let balance: Vec<String> = found
            .prediction
            .cycles
            .iter()
            .map(|c| {
                format!(
                    "{:.3} mrad/s, {:.2} Hz, 3rd {:.2}",
                    1e3 * c.rate_rad_s,
                    c.frequency_hz,
                    c.third_harmonic
                )
            })
            .collect();
        let worst = found.worst_regime().map_or(String::new(), |at| {
            format!("{} {:.6} ({:.2} Hz)", at.regime.key(), at.pole_radius, at.frequency_hz)
        });
        println!(
            "| {} | {} | {word}{}{} | {:.2} (own {:.2}) | {:.2} (own {:.2}) | {:.3} mrad/s, {:.2} Hz | {cycle}; balance: {} | {} | {} | {worst} |",
            row.seed,
            row.blocks,
            if row.certificate.is_proved() { ", proved" } else { "" },
            if row.contradicts() { " CONTRADICTION" } else { "" },
            row.rest.rms / found.noise_floor_rad_s,
            found.rest.rms_rad_s / found.noise_floor_rad_s,
            row.motion.growth,
            found.motion.second_half_rad_s / found.motion.first_half_rad_s,
            1e3 * row.rest.amplitude,
            row.rest.hz,
            balance.join("; "),
            row.kicked.map_or(String::new(), |seen| {
                format!("{:.3} mrad/s, {:.2} Hz", 1e3 * seen.amplitude, seen.hz)
            }),
            row.certificate.sector.as_ref().map_or("none applies".to_owned(), |proof| {
                let word = if proof.holds() { "holds" } else { "fails" };
                format!("{} {word} {:.1e}, aliases {:.1e}", proof.criterion.key(), proof.least, proof.aliases)
            }),
        );
    }
    summary(rows);
}

fn summary(rows: &[CertificateRow]) {
    let count = |what: &dyn Fn(&&CertificateRow) -> bool| rows.iter().filter(what).count();
    let quiet = count(&|row| row.is_quiet());
    let stable = count(&|row| row.is_quiet() && row.is_stable());
    println!("\n{} mechanisms, {} contradictions", rows.len(), count(&|row| row.contradicts()));
    println!(
        "quiet: {quiet}, of which called stable: {stable} ({:.1} %)",
        100.0 * stable as f64 / quiet as f64
    );
    let cycles: Vec<[f64; 2]> = rows.iter().filter_map(CertificateRow::cycle_errors).collect();
    let within = cycles.iter().filter(|[a, f]| a.abs() <= 0.2 && f.abs() <= 0.05).count();
    let certified = count(&|row| row.kicked.is_some());
    let confirmed = count(&|row| row.is_confirmed() == Some(true));
    println!("limit cycles certified: {certified}, of which stay in the independent simulator: {confirmed}");
    println!("limit cycles in both: {}, within 20 % and 5 %: {within}", cycles.len());
    println!("proved: {}", count(&|row| row.certificate.is_proved()));
}
