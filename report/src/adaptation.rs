//! The runs of the adaptation: out-of-balance and estimate, control and hub rate over time, and what each interval came to.

use counterpoise_models::ControlledQuantity;
use counterpoise_models::parameters::AxisKind;
use counterpoise_pipeline::studies::adapt::{AdaptRun, AdaptedIntervals, TraceColumn};

use counterpoise_pipeline::studies::adaptation_trials::{
    AdaptationTrials, HoldBands, METHODS, MethodRefusal, TrialExtremes, TrialLoad, TrialMotion, TrialRow,
};

use crate::wording::adaptation::describe_run;
use crate::{
    FigureTile, Headline, OutcomeTone, ProvenanceEntry, Report, ReportCell, ReportColumn, ReportSection,
    ReportTable,
};
use counterpoise_plot::number::short_number;
use counterpoise_plot::{Axis as PlotAxis, Colour, Figure, Panel, Series};

/// Returns the trials of the methods in lines, for a terminal.
pub fn trial_lines(tried: &AdaptationTrials) -> Vec<String> {
    let mut lines = vec![format!(
        "trials on motions that no window fits ({} in {} RMS):",
        rate_of(&tried.rows).name(),
        rate_of(&tried.rows).milli_unit()
    )];
    lines.extend(tried.rows.iter().map(|row| {
        let removed = row
            .removed_share()
            .map_or(String::new(), |share| format!(", {:.0} % of the added rate removed", 100.0 * share));
        format!(
            "    {:13} {:9} {:20} without {:.3}, with {:.3}, load known {:.3}{removed}",
            row.method,
            motion(row.motion),
            load(row.load),
            1e3 * row.without_rad_s,
            1e3 * row.with_rad_s,
            1e3 * row.told_rad_s
        )
    }));
    lines.extend(describe_action(tried));
    lines.extend(tried.refused.iter().map(describe_refusal));
    let refused = |name: &str| tried.refused.iter().any(|refused| refused.worst.method == name);
    let tried_once = |name: &str| tried.rows.iter().any(|row| row.method == name);
    let good = |name: &&str| tried_once(name) && !refused(name);
    let good: Vec<&str> = METHODS.iter().map(|one| one.key).filter(good).collect();
    lines.push(if good.is_empty() {
        "no method is fit for this project: leave [synth.adaptation] out".to_owned()
    } else {
        format!("fit for this project: {}", good.join(", "))
    });
    lines
}

/// Returns the trials of a project's own method as a section of a report.
pub fn trial_section(tried: &AdaptationTrials) -> ReportSection {
    let columns = [
        ReportColumn::Text("motion"),
        ReportColumn::Text("load"),
        ReportColumn::Number("without"),
        ReportColumn::Number("with adaptation"),
        ReportColumn::Number("load known"),
        ReportColumn::Number("with over without"),
    ];
    let rate = rate_of(&tried.rows);
    let mut table = ReportTable::new(&format!("RMS of the {}, {}", rate.name(), rate.milli_unit()), &columns);
    let row = |row: &TrialRow| {
        vec![
            ReportCell::text(motion(row.motion)),
            ReportCell::text(load(row.load)),
            ReportCell::number(1e3 * row.without_rad_s),
            ReportCell::number(1e3 * row.with_rad_s),
            ReportCell::number(1e3 * row.told_rad_s),
            ReportCell::number(row.ratio()),
        ]
    };
    table.rows = tried.rows.iter().map(row).collect();
    let mut section = ReportSection::new("Trials of the adaptation").with_table(table);
    section.text = describe_action(tried).into_iter().collect();
    section.text.extend(tried.refused.iter().map(describe_refusal));
    section
}

/// Why an adaptation that the project asks for is not exported, before its trials are shown.
pub const LEFT_OUT_BY_TRIALS: &str = "the controller is exported without adaptation: on each motion some trial is worse with it than without, or the mechanism has no gravity \
     and a changed load adds nothing that could be removed (`counterpoise adapt` shows the trials)";

/// The way to export an adaptation that trials leave out.
pub const EXPORTED_BY_BANDS: &str =
    "state `dead_band` or `hold_band` in [synth.adaptation] to export it with those";

/// Returns where recursive least squares act, or why the exported controller does not adapt; `None` for other methods.
pub fn describe_action(tried: &AdaptationTrials) -> Option<String> {
    let HoldBands { dead_band_m_s2, hold_band, is_exported } = tried.bands?;
    if !is_exported {
        return Some(describe_left_out(&tried.extremes, rate_of(&tried.rows)));
    }
    Some(format!(
        "the estimate is followed where the platform's acceleration exceeds {} m/s^2 RMS and the estimate is off by more than {} % of the design's out-of-balance",
        short_number(dead_band_m_s2),
        short_number(100.0 * hold_band)
    ))
}

/// Returns why the exported controller does not adapt, by its trials with the usual bands, and what to do.
fn describe_left_out(extremes: &TrialExtremes, rate: ControlledQuantity) -> String {
    let harms = extremes.worst.as_ref().map_or("no trial with the usual bands is worse with it".to_owned(), |row| {
        format!(
            "with the usual bands it makes the {} {:.3} times that without, {}: {:.3} against {:.3} {} RMS",
            row.rate.name(),
            row.ratio(),
            trial(row),
            1e3 * row.with_rad_s,
            1e3 * row.without_rad_s,
            row.rate.milli_unit()
        )
    });
    let nothing = || format!("no load of the trials adds to the {}", rate.name());
    let gains = extremes.most_added.as_ref().map_or_else(nothing, |row| {
        format!(
            "most that an unknown load adds is {} %, {}",
            short_number(100.0 * row.added_share()),
            trial(row)
        )
    });
    format!("the controller is exported without adaptation: {harms}; {gains}; {EXPORTED_BY_BANDS}")
}

/// Returns the rate that trials measure.
fn rate_of(rows: &[TrialRow]) -> ControlledQuantity {
    rows.first().map_or(ControlledQuantity::RATE, |row| row.rate)
}

/// Returns the motion and the load of a trial.
fn trial(row: &TrialRow) -> String {
    format!("on {} ({})", motion(row.motion), load(row.load))
}

/// Returns the reason why a method is refused.
pub fn describe_refusal(refused: &MethodRefusal) -> String {
    let TrialRow { rate, method, without_rad_s, with_rad_s, .. } = refused.worst;
    format!(
        "REFUSED: {method} makes the {} worse than no adaptation does, {:.2} times {}: {:.3} against {:.3} {} RMS",
        rate.name(),
        refused.ratio,
        trial(&refused.worst),
        1e3 * with_rad_s,
        1e3 * without_rad_s,
        rate.milli_unit()
    )
}

fn motion(motion: TrialMotion) -> &'static str {
    match motion {
        TrialMotion::Sines => "sines",
        TrialMotion::Road => "road",
        TrialMotion::Multisine => "multisine",
    }
}

fn load(load: TrialLoad) -> &'static str {
    match load {
        TrialLoad::Nominal => "load as designed",
        TrialLoad::WrongStart => "estimate 30 % low",
        TrialLoad::Sudden => "30 % more, sudden",
        TrialLoad::Slow => "30 % more, slow",
        TrialLoad::Lower => "30 % less, sudden",
        TrialLoad::Returned => "30 % more, and back",
    }
}

/// Returns the report.
pub fn adaptation_report(
    machine: &str,
    command: &str,
    runs: &[AdaptRun],
    adapted: AdaptedIntervals,
) -> Report {
    let tone = if adapted.returned == adapted.intervals { OutcomeTone::Good } else { OutcomeTone::Bad };
    let text = format!(
        "{} of {} adapted intervals come back to within 10 % of run (a)",
        adapted.returned, adapted.intervals
    );
    let rate = rate_of_runs(runs);
    let detail = format!(
        "RMS of the {} in the later part of each interval, over that of run (a) in the same time.",
        rate.name()
    );
    Report {
        title: format!("Adaptation of {machine}"),
        subtitle: "an out-of-balance that steps while the platform moves, in the nonlinear closed loop"
            .to_owned(),
        headline: Headline { tone, text, detail },
        tiles: vec![
            FigureTile::plain(
                "worst adapted interval",
                short_number(adapted.largest_over_default),
                "of run (a)",
            ),
            FigureTile::plain(
                "largest error of the estimate",
                short_number(adapted.largest_estimate_error_kg_m),
                rate.axis.unit("kg m"),
            )
            .with_note("at the end of an interval"),
        ],
        verdicts: table(runs),
        glance: Vec::new(),
        sections: runs.iter().map(|run| section(run, command)).collect(),
        provenance: vec![
            ProvenanceEntry::new("version", env!("CARGO_PKG_VERSION")),
            ProvenanceEntry::new("command", command),
        ],
    }
}

/// Returns the rate that runs measure.
fn rate_of_runs(runs: &[AdaptRun]) -> ControlledQuantity {
    let first = runs.iter().flat_map(|run| &run.intervals).next();
    first.map_or(ControlledQuantity::RATE, |interval| interval.rate)
}

/// Returns the heads of the columns with out-of-balance and rate, in the units of the axis.
fn unit_columns(rate: ControlledQuantity) -> [ReportColumn; 3] {
    match rate.axis {
        AxisKind::Rotary => [
            ReportColumn::Number("out-of-balance [kg m]"),
            ReportColumn::Number("controller uses [kg m]"),
            ReportColumn::Number("hub rate [mrad/s RMS]"),
        ],
        AxisKind::Linear => [
            ReportColumn::Number("weight along the axis [kg]"),
            ReportColumn::Number("controller uses [kg]"),
            ReportColumn::Number("slide speed [mm/s RMS]"),
        ],
    }
}

fn table(runs: &[AdaptRun]) -> ReportTable {
    let [balance, used, rate] = unit_columns(rate_of_runs(runs));
    let columns = [
        ReportColumn::Text("run"),
        ReportColumn::Number("from [s]"),
        ReportColumn::Number("to [s]"),
        balance,
        used,
        rate,
        ReportColumn::Number("over (a)"),
        ReportColumn::Text("verdict"),
    ];
    let mut table = ReportTable::new("Intervals between changes", &columns);
    for (run, i) in runs.iter().flat_map(|run| run.intervals.iter().map(move |i| (run, i))) {
        let verdict = match (i.adapted, i.has_returned()) {
            (false, _) => ReportCell::text(""),
            (true, true) => ReportCell::Verdict(OutcomeTone::Good, "holds".to_owned()),
            (true, false) => ReportCell::Verdict(OutcomeTone::Bad, "fails".to_owned()),
        };
        table.rows.push(vec![
            ReportCell::text(format!("({})", run.kind.letter())),
            ReportCell::text(format!("{:.1}", i.from_to_s[0])),
            ReportCell::text(format!("{:.1}", i.from_to_s[1])),
            ReportCell::text(format!("{:.2}", i.out_of_balance_kg_m)),
            ReportCell::text(format!("{:.2}", i.used_kg_m)),
            ReportCell::text(format!("{:.3}", 1e3 * i.hub_rms_rad_s)),
            ReportCell::text(format!("{:.3}", i.over_default)),
            verdict,
        ]);
    }
    table
}

fn section(run: &AdaptRun, command: &str) -> ReportSection {
    let over = |column: TraceColumn, scale: f64| {
        let (time_s, values) = (run.trace.column(TraceColumn::Time), run.trace.column(column));
        time_s.iter().zip(values).map(|(t, value)| (*t, scale * value)).collect::<Vec<_>>()
    };
    let balance = vec![
        Series::solid_line("true", Colour::Second, over(TraceColumn::OutOfBalance, 1.0)),
        Series::dashed_line("controller uses", Colour::First, over(TraceColumn::UsedOutOfBalance, 1.0)),
    ];
    let rate = rate_of_runs(std::slice::from_ref(run));
    let panels = vec![
        Panel::new(PlotAxis::linear("out-of-balance", rate.axis.unit("kg m")), balance).with_height(120.0),
        Panel::new(
            PlotAxis::linear("control", "V"),
            vec![Series::solid_line("", Colour::Muted, over(TraceColumn::Control, 1.0))],
        )
        .with_height(110.0),
        Panel::new(
            PlotAxis::linear(rate.name(), rate.milli_unit()),
            vec![Series::solid_line("", Colour::First, over(TraceColumn::HubRate, 1e3))],
        )
        .with_height(150.0),
    ];
    let figure = Figure::new(&format!("Run ({})", run.kind.letter()), PlotAxis::linear("time", "s"), panels);
    let figure = Figure { command: command.to_owned(), ..figure };
    ReportSection::new(&format!("({}) {}", run.kind.letter(), describe_run(run.kind))).with_figures([figure])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(motion: TrialMotion, load: TrialLoad, [without, with, told]: [f64; 3]) -> TrialRow {
        TrialRow {
            rate: ControlledQuantity::RATE,
            method: "recursive",
            motion,
            load,
            without_rad_s: 1e-3 * without,
            with_rad_s: 1e-3 * with,
            told_rad_s: 1e-3 * told,
            spread_rad_s: 0.0,
        }
    }

    fn describe_trials(rows: &[TrialRow]) -> String {
        describe_left_out(&TrialExtremes::of(rows), ControlledQuantity::RATE)
    }

    #[test]
    fn what_is_left_out_says_by_how_much_it_is_worse_and_what_there_was_to_gain() {
        let rows = [
            row(TrialMotion::Sines, TrialLoad::Nominal, [2.0, 2.1, 2.0]),
            row(TrialMotion::Road, TrialLoad::Sudden, [4.0, 4.04, 3.2]),
        ];
        let text = describe_trials(&rows);
        assert!(
            text.contains(
                "1.050 times that without, on sines (load as designed): 2.100 against 2.000 mrad/s RMS"
            ),
            "{text}"
        );
        assert!(text.contains("adds is 25 %, on road (30 % more, sudden)"), "{text}");
        // a motion that diverges with every controller adds no number
        let diverged = row(TrialMotion::Multisine, TrialLoad::Slow, [f64::INFINITY; 3]);
        let text = describe_trials(&[rows[1], diverged]);
        assert!(text.contains("adds is 25 %, on road"), "{text}");
        let still = describe_trials(&[row(TrialMotion::Road, TrialLoad::Nominal, [2.0, 2.0, 2.0])]);
        assert!(
            still.contains("no trial with the usual bands is worse")
                && still.contains("no load of the trials adds"),
            "{still}"
        );
    }
}
