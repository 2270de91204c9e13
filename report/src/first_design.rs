//! Why chosen weights are what they are: the bandwidth that was reached, and what limits it.

use std::f64::consts::TAU;

use counterpoise_pipeline::FirstDesignResult;
use counterpoise_pipeline::first_design::LimitRow;
use counterpoise_plot::number::short_number;
use counterpoise_synth::{LimitKind, Unknown};

use crate::page::{ReportCell, ReportColumn, ReportSection, ReportTable};
use crate::wording::design_findings::{
    describe_design_finding, describe_limit, describe_unknown, join_limits,
};

/// Returns the section on weights that were chosen because the project file states none.
pub fn first_design_section(first: &FirstDesignResult) -> ReportSection {
    let columns = [
        ReportColumn::Text("limit"),
        ReportColumn::Number("the loop uses [%]"),
        ReportColumn::Number("allows alone [rad/s]"),
        ReportColumn::Number("over what is reached"),
        ReportColumn::Number("bandwidth without it [rad/s]"),
    ];
    let mut table = ReportTable::new(
        "How much of each limit the loop uses up, what it alone would allow, and the bandwidth without it",
        &columns,
    );
    table.rows = first.limits.iter().map(row).collect();
    sentences(first)
        .into_iter()
        .fold(ReportSection::new("First design"), ReportSection::with_text)
        .with_table(table)
}

fn row(limit: &LimitRow) -> Vec<ReportCell> {
    let number =
        |value: Option<f64>| value.map_or_else(|| ReportCell::text("does not limit"), ReportCell::number);
    let lifted = limit.lifted_rad_s.map_or_else(|| ReportCell::text("no higher"), ReportCell::number);
    vec![
        ReportCell::text(describe_limit(limit.limit)),
        limit.used.map_or_else(|| ReportCell::text("not known"), |used| ReportCell::number(100.0 * used)),
        number(limit.bandwidth_rad_s),
        number(limit.over_reached),
        lifted,
    ]
}

/// Returns what limits the bandwidth and by how much, as a clause. A limit that alone would allow more is kept by other loops than those that
/// keep all limits.
pub fn describe_limitation(first: &FirstDesignResult) -> String {
    let limit = first.limits.first();
    let beside = match limit.filter(|limit| limit.allows_more()).and_then(|limit| limit.bandwidth_rad_s) {
        Some(alone) => format!(
            " beside the other limits (a loop that keeps it and misses others would reach {} rad/s)",
            short_number(alone)
        ),
        None => String::new(),
    };
    match limit.and_then(|limit| Some((limit.lifted_rad_s?, first.gain_of_lifting(limit)?))) {
        Some((rate, times)) => format!(
            "{}{beside}; without this limit it would be {} rad/s, {:.2} times as high",
            join_limits(&first.limited_by),
            short_number(rate),
            times
        ),
        None => format!("{}; lifting one limit alone does not raise it", join_limits(&first.limited_by)),
    }
}

/// Where a reader finds what a file leaves open, if that limits the bandwidth; without a full stop.
pub const WHERE_OPEN_VALUES_STAND: &str =
    "`counterpoise check PROJECT` lists what the file leaves open, the most important first";

/// Returns where the noise comes from that limits the bandwidth, if the file states none, as a clause.
pub fn describe_usual_noise(first: &FirstDesignResult) -> Option<&'static str> {
    let is_assumed = first.limited_by.contains(&LimitKind::Noise) && first.unknown.contains(&Unknown::Noise);
    is_assumed.then_some(
        "the noise is assumed, that of a usual gyroscope: 0.01 deg/s per root hertz; state `noise` of the sensor",
    )
}

fn sentences(first: &FirstDesignResult) -> Vec<String> {
    let mut lines = vec![format!(
        "The project file states no weights, so they are chosen for the highest bandwidth (the lowest frequency at which the loop's gain falls to 1). \
         The bandwidth is {} rad/s ({} Hz), limited by: {}.",
        short_number(first.bandwidth_rad_s),
        short_number(first.bandwidth_rad_s / TAU),
        describe_limitation(first)
    )];
    if first.limited_by.contains(&LimitKind::UsualRanges) {
        lines.push(format!("{WHERE_OPEN_VALUES_STAND}."));
    }
    if let Some(noise) = describe_usual_noise(first) {
        lines.push(format!("Here {noise}."));
    }
    if let Some(asked) = first.missed_rad_s() {
        lines.push(format!("{} rad/s are asked for and cannot be reached.", short_number(asked)));
    }
    lines.push(format!(
        "The margins are {:.1} dB and {:.1} deg, and the largest sensitivity is {:.2}; with every lightly damped mode off by 15 % it is {:.2}.",
        first.gain_margin_db, first.phase_margin_deg, first.max_sensitivity, first.max_sensitivity_modes_shifted
    ));
    if !first.unknown.is_empty() {
        lines.push(format!(
            "Not known, and each lowers the highest bandwidth by 3 dB: {}.",
            first.unknown.iter().map(|fact| describe_unknown(*fact)).collect::<Vec<_>>().join("; ")
        ));
    }
    let left_out = first.left_out.iter().map(describe_design_finding);
    lines.extend(left_out.map(|reason| format!("No feedforward: {reason}.")));
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use counterpoise_pipeline::first_design::RequiredMarginsResult;

    #[test]
    fn every_limit_is_told_with_what_it_would_allow() {
        let limit = |limit: LimitKind, bandwidth_rad_s: Option<f64>| LimitRow {
            limit,
            bandwidth_rad_s,
            over_reached: bandwidth_rad_s.map(|rate| rate / 20.0),
            used: Some(0.98),
            lifted_rad_s: (limit == LimitKind::Resonance).then_some(25.0),
            shown_by: None,
            lifted_shown_by: None,
        };
        let first = FirstDesignResult {
            bandwidth_rad_s: 20.0,
            asked_rad_s: Some(30.0),
            limited_by: vec![LimitKind::Resonance],
            limits: vec![limit(LimitKind::Resonance, Some(20.0)), limit(LimitKind::Noise, None)],
            required: RequiredMarginsResult {
                gain_margin_db: 6.0,
                phase_margin_deg: 40.0,
                max_sensitivity: 1.7,
            },
            sample_period_s: 1e-3,
            unknown: vec![Unknown::Sensor],
            gain_margin_db: 8.0,
            phase_margin_deg: 50.0,
            max_sensitivity: 1.5,
            max_sensitivity_modes_shifted: 1.9,
            loops: Vec::new(),
            left_out: Vec::new(),
        };
        let section = first_design_section(&first);
        let text = section.text.join(" ");
        for said in [
            "20 rad/s (3.183 Hz)",
            "limited by: resonance; without this limit it would be 25 rad/s, 1.25 times as high",
            "30 rad/s are asked for",
            "the lag of the sensor",
        ] {
            assert!(text.contains(said), "{said}: {text}");
        }
        let rows = &section.tables[0].rows;
        assert_eq!((rows.len(), &rows[1][2]), (2, &ReportCell::text("does not limit")));
        assert_eq!((&rows[0][4], &rows[1][4]), (&ReportCell::number(25.0), &ReportCell::text("no higher")));
    }
}
