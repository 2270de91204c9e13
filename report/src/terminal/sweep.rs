//! What `counterpoise sweep` prints of a campaign.

use counterpoise_pipeline::studies::sweep::CampaignResult;

use super::add_line;
use crate::sweep::{SweepFigure, robustness_limit};
use crate::wording::figures::format_figure;
use crate::{certificate, robustness};

/// Returns the lines on a campaign: the share of mechanisms that meet each requirement, and the linear worst case.
pub fn sweep_lines(found: &CampaignResult, rows: &[SweepFigure]) -> Vec<String> {
    let mut lines = Vec::new();
    add_shares(&mut lines, found, rows);
    add_stability(&mut lines, found);
    lines
}

fn add_shares(lines: &mut Vec<String>, found: &CampaignResult, rows: &[SweepFigure]) {
    for row in rows {
        let (low, high) = (100.0 * row.interval.0, 100.0 * row.interval.1);
        let worst = row.worst_sample.map_or(String::new(), |k| format!(", worst: --sample {k}"));
        add_line!(
            lines,
            "{:6.2} % ({low:.1} to {high:.1})  {}: 5 % {}, median {}, 95 % {}{worst}",
            100.0 * row.share,
            row.figure,
            format_figure(row.q05),
            format_figure(row.median),
            format_figure(row.q95)
        );
        if let Some(worst) = &row.worst_case {
            let word = if worst.meets { "still meets it" } else { "fails" };
            add_line!(
                lines,
                "           worst case {} ({word}): {}",
                format_figure(worst.value),
                worst.options
            );
        }
    }
    let all = found.samples();
    add_line!(
        lines,
        "shares are of {all} mechanisms; worst cases come from a search from the worst sample inside the ranges"
    );
}

fn add_stability(lines: &mut Vec<String>, found: &CampaignResult) {
    if let Some(least) = found.least_robust() {
        add_line!(lines, "linear: {}", robustness_limit(least));
    }
    match &found.stability {
        Some(own) => {
            let heading = certificate::worst_case_heading(found.own_joints());
            let own = robustness::robustness_lines(own);
            own.iter().for_each(|line| add_line!(lines, "{heading}: {line}"));
        }
        None if !found.regimes.is_empty() => {}
        None => add_line!(
            lines,
            "linear: no worst case, for nothing that enters the linear loop varies, or it is unstable as it is"
        ),
    }
    let others = certificate::robustness_lines(&found.regimes);
    others.iter().for_each(|line| add_line!(lines, "linear: {line}"));
}
