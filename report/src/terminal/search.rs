//! What `counterpoise synth --search` prints of a search for weights.

use counterpoise_pipeline::studies::comparison::LoopFigures;
use counterpoise_pipeline::studies::search::SearchAnswer;
use counterpoise_synth::{Figures, SearchEnding};

use super::add_line;
use super::synthesis::figures_line;
use crate::results::search::SearchText;
use crate::trade_off::VerifiedPoint;

/// Returns the lines on a search, and on its points as they were verified; `chosen` is the place of the point that was taken.
pub fn search_lines(
    found: &SearchAnswer,
    result: &SearchText,
    chosen: Option<usize>,
    gain_unit: &str,
) -> Vec<String> {
    let mut lines = Vec::new();
    add_search(&mut lines, found, result, gain_unit);
    add_verified(&mut lines, &result.verified, chosen);
    lines
}

fn add_search(lines: &mut Vec<String>, found: &SearchAnswer, result: &SearchText, gain_unit: &str) {
    let ended = match found.found.ended {
        SearchEnding::Settled => "no step improves any more",
        SearchEnding::OutOfTrials => "as many as [synth.search] allows for one answer",
        SearchEnding::Stopped => "stopped",
    };
    add_line!(lines, "{} designs were tried ({ended})", result.trials);
    result.weights.iter().take(2).for_each(|line| add_line!(lines, "{line}"));
    let recovery = found.found.best.specification.feedback.loop_recovery;
    add_line!(lines, "loop recovery {recovery:.4e} V^2 s");
    for (name, figures, missed) in [
        ("on the design plant", &found.found.best.figures, result.missed),
        ("on the plant before reduction", &found.on_full_plant, result.missed_on_full_plant),
    ] {
        let verdict = if missed == 0.0 { "the requirements hold" } else { "REQUIREMENTS ARE MISSED" };
        add_line!(lines, "{name}: {verdict}");
        add_line!(lines, "  {}", searched_line(figures, gain_unit));
    }
    if !result.curve.is_empty() {
        add_line!(lines, "trade-off: limit of Ms, Ms, |S| over the band, noise gain {gain_unit}");
    }
    for point in &result.curve {
        let missed = if point.missed == 0.0 { "" } else { "  (requirements are missed)" };
        let (limit, ms) = (point.max_sensitivity_limit, point.max_sensitivity);
        add_line!(lines, "  {limit:6.3} {ms:7.3} {:8.4} {:9.3}{missed}", point.rejection, point.noise_gain);
    }
}

fn searched_line(f: &Figures, gain_unit: &str) -> String {
    let found = LoopFigures {
        gain_margin_db: f.gain_margin_db,
        phase_margin_deg: f.phase_margin_deg,
        max_sensitivity: f.ms,
        crossover_rad_s: f.crossover_rad_s,
        overshoot_percent: 100.0 * f.overshoot,
        rejection: f.rejection,
        noise_gain: f.noise_gain,
    };
    figures_line(&found, gain_unit)
}

fn add_verified(lines: &mut Vec<String>, points: &[VerifiedPoint], chosen: Option<usize>) {
    if points.is_empty() {
        return add_line!(lines, "no [verify] section: the figures are those of the linear loop alone");
    }
    add_line!(
        lines,
        "verified on the nonlinear plant, the answer first, then the points by their rejection:"
    );
    for (k, point) in points.iter().enumerate() {
        let [holds, fails, _] = point.verdicts;
        let name = point.max_sensitivity_limit.map_or("answer".to_owned(), |limit| format!("Ms <= {limit}"));
        let mark = if Some(k) == chosen { "  <- taken" } else { "" };
        add_line!(
            lines,
            "  {name:12} |S| {:.4}: {holds} requirements hold, {fails} fail{mark}",
            point.rejection
        );
        point.failing.iter().for_each(|line| add_line!(lines, "      {line}"));
    }
    if chosen.is_none() {
        add_line!(lines, "NO POINT KEEPS EVERY REQUIREMENT on the nonlinear plant");
    }
}
