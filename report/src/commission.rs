//! A commissioning: a round after the other, predicted against measured, and what is left of the tolerances.

use counterpoise_pipeline::commission::story::{
    EffectValue, EquivalentEffect, FindingSummary, RequirementSummary, RunSummary, ValueSummary,
};
use counterpoise_pipeline::commission::{RoundSummary, StopReason};
use counterpoise_plot::number::short_number;
use counterpoise_plot::{Axis, Colour, Dash, Figure, Panel, Series};

use crate::{
    Headline, OutcomeTone, ProvenanceEntry, Report, ReportCell, ReportColumn, ReportSection, ReportTable,
};

/// Returns why a commissioning ended, in a sentence.
pub fn describe_stop(stop: &StopReason) -> String {
    match stop {
        StopReason::RequirementsMet => "every requirement holds on the machine".to_owned(),
        StopReason::ModelExplains => {
            "the model explains the recordings; the project requires nothing of the machine".to_owned()
        }
        StopReason::BeyondDesign { figures } => format!(
            "the model explains the recordings, and the design misses on it: {}. Change the weights (`counterpoise synth --search`), the requirement, or the part of the machine that \
             `counterpoise model` lists first",
            figures.join(", ")
        ),
        StopReason::NothingToLearn { figures } => format!(
            "the experiments within the limits teach nothing more, and the machine misses: {}. Raise --angle, --rate, --current or --duration, or look at what the diagnosis leaves open",
            figures.join(", ")
        ),
        StopReason::Aborted { run, why } => format!("the machine stopped during {run}: {why}"),
        StopReason::NoExperiment => {
            "no experiment keeps the limits, as the model predicts: raise --angle, --rate or --current, or lower what the project asks of its step and its motions".to_owned()
        }
        StopReason::RoundsOver => {
            "the rounds are over; the same command with more --rounds goes on from here".to_owned()
        }
    }
}

/// Returns a round as lines for a terminal.
pub fn describe_round(round: &RoundSummary) -> Vec<String> {
    let mut lines =
        vec![format!("round {}: controller {}{}", round.round, round.controller_hash, loop_text(round))];
    for run in &round.runs {
        let outside = run.channels.iter().filter(|channel| channel.outside > 0.0).map(|channel| {
            format!("{} for {} % of the time", channel.channel, short_number(100.0 * channel.outside))
        });
        let outside: Vec<String> = outside.collect();
        let band = match outside.is_empty() {
            true => "as predicted".to_owned(),
            false => format!("outside what was predicted: {}", outside.join(", ")),
        };
        lines.push(format!("  {:<16} {band}", run.name));
    }
    lines.extend(
        round.left_out.iter().map(|name| format!("  {name}: left out, its prediction leaves the limits")),
    );
    lines.extend(round.requirements.iter().map(|one| format!("  {}", requirement_text(one))));
    if let (Some(before), Some(after)) = (round.residual_before, round.residual_after) {
        lines.push(format!(
            "  residual over the noise floor: {} with the model as it was, {} with the updated one",
            short_number(before),
            short_number(after)
        ));
    }
    lines.extend(round.values.iter().map(|value| format!("  {}", value_text(value))));
    lines.extend(round.findings.iter().map(|found| {
        let (values, others) = (values_text(&found.values), equivalents_text(found));
        format!("  added to the model: {} {}: {values}{others}", found.component, found.effect)
    }));
    lines
}

fn loop_text(round: &RoundSummary) -> String {
    let mut text = String::new();
    if let Some(rate) = round.crossover_rad_s {
        text += &format!(", highest crossover {} rad/s", short_number(rate));
    }
    if let Some(margin) = round.gain_margin_db {
        text += &format!(", gain margin {} dB", short_number(margin));
    }
    text
}

fn number_or_none(value: Option<f64>) -> String {
    value.map_or("none".to_owned(), short_number)
}

fn requirement_text(one: &RequirementSummary) -> String {
    let verdict = if one.holds { "holds" } else { "FAILS" };
    let measured = match one.measured {
        Some(value) => format!("measured {}", short_number(value)),
        None => "no experiment shows it".to_owned(),
    };
    let predicted = number_or_none(one.predicted);
    format!(
        "{verdict} {} {} {}: predicted {predicted}, {measured}",
        one.figure,
        one.side,
        short_number(one.limit)
    )
}

fn values_text(values: &[EffectValue]) -> String {
    let one = |value: &EffectValue| {
        let number = short_number(value.value);
        format!("{} {number} {}", value.name.replace('_', " "), value.unit).trim_end().to_owned()
    };
    values.iter().map(one).collect::<Vec<_>>().join(", ")
}

/// Returns which other effects the recordings cannot tell from one; empty if there is none.
pub fn equivalents_text(found: &FindingSummary) -> String {
    if found.equivalents.is_empty() {
        return String::new();
    }
    let one = |other: &EquivalentEffect| format!("{} {}", other.component, other.effect).replace('_', " ");
    let names: Vec<String> = found.equivalents.iter().map(one).collect();
    format!("; the recordings cannot tell it from: {}", names.join(", "))
}

fn value_text(value: &ValueSummary) -> String {
    let unit = if value.unit.is_empty() { String::new() } else { format!(" {}", value.unit) };
    format!(
        "{}: {} \u{b1} {}{unit} becomes {} \u{b1} {}{unit}",
        value.key,
        short_number(value.before),
        short_number(value.half_width_before),
        short_number(value.after),
        short_number(value.half_width_after)
    )
}

/// Returns the report of a commissioning of a project, in whose experiments the machine ran for so many seconds.
pub fn commission_report(project: &str, rounds: &[RoundSummary], machine_time_s: f64) -> Report {
    let stop = rounds.last().and_then(|round| round.stop.as_ref());
    let is_met = matches!(stop, Some(StopReason::RequirementsMet | StopReason::ModelExplains));
    let tone = if is_met { OutcomeTone::Good } else { OutcomeTone::Bad };
    let machine_time = short_number(machine_time_s);
    let detail = format!("{} rounds, {machine_time} s of machine time.", rounds.len());
    let mut sections = Vec::new();
    sections.extend(tolerances_section(rounds));
    sections.extend(rounds.iter().map(round_section));
    Report {
        title: "Commissioning".to_owned(),
        subtitle: project.to_owned(),
        headline: Headline { tone, text: stop.map_or(String::new(), describe_stop), detail },
        tiles: Vec::new(),
        verdicts: verdict_table(rounds),
        glance: Vec::new(),
        sections,
        provenance: vec![ProvenanceEntry::new("project", project)],
    }
}

/// Each requirement of each round.
fn verdict_table(rounds: &[RoundSummary]) -> ReportTable {
    let columns = [
        ReportColumn::Number("round"),
        ReportColumn::Text("figure"),
        ReportColumn::Text("limit"),
        ReportColumn::Number("predicted"),
        ReportColumn::Number("measured"),
        ReportColumn::Text("verdict"),
    ];
    let mut table = ReportTable::new("Requirements, round by round", &columns);
    for round in rounds {
        for one in &round.requirements {
            let (tone, word) =
                if one.holds { (OutcomeTone::Good, "holds") } else { (OutcomeTone::Bad, "fails") };
            table.rows.push(vec![
                ReportCell::text(round.round.to_string()),
                ReportCell::text(&one.figure),
                ReportCell::text(format!("{} {}", one.side, short_number(one.limit))),
                ReportCell::text(number_or_none(one.predicted)),
                ReportCell::text(number_or_none(one.measured)),
                ReportCell::Verdict(tone, word.to_owned()),
            ]);
        }
    }
    table
}

/// Returns the section on how the tolerances shrink; nothing if no value has one.
fn tolerances_section(rounds: &[RoundSummary]) -> Option<ReportSection> {
    let first = rounds.iter().find(|round| !round.values.is_empty())?;
    let figures = first.values.iter().map(|value| tolerance_figure(&value.key, rounds));
    Some(
        ReportSection::new("What is left of the tolerances")
            .with_text("Each value with its tolerance before and after the recordings of each round: the dotted lines are two standard deviations, and no wider than the tolerance of the file.")
            .with_figures(figures),
    )
}

fn tolerance_figure(key: &str, rounds: &[RoundSummary]) -> Figure {
    let known: Vec<(f64, &ValueSummary)> = rounds
        .iter()
        .filter_map(|round| Some((round.round as f64, round.values.iter().find(|value| value.key == key)?)))
        .collect();
    let curve = |at: fn(&ValueSummary) -> [f64; 2]| -> Vec<(f64, f64)> {
        let first = known.first().map(|(round, value)| (round - 1.0, at(value)[0]));
        first.into_iter().chain(known.iter().map(|(round, value)| (*round, at(value)[1]))).collect()
    };
    let unit = known.first().map_or("", |(_, value)| value.unit.as_str());
    let line = |name: &str, dash: Dash, points: Vec<(f64, f64)>| Series {
        dash,
        ..Series::solid_line(name, Colour::First, points)
    };
    let series = vec![
        line("", Dash::Solid, curve(|value| [value.before, value.after])),
        line("", Dash::Dotted, curve(|v| [v.before - v.half_width_before, v.after - v.half_width_after])),
        line("", Dash::Dotted, curve(|v| [v.before + v.half_width_before, v.after + v.half_width_after])),
    ];
    let last = known.last().map_or(1.0, |(round, _)| *round);
    let axis = Axis::linear("round", "").with_range(0.0, last.max(1.0));
    Figure::new(key, axis, vec![Panel::new(Axis::linear("value", unit), series).with_height(140.0)])
}

fn round_section(round: &RoundSummary) -> ReportSection {
    let mut section = ReportSection::new(&format!("Round {}", round.round))
        .with_text(format!("Controller {}{}.", round.controller_hash, loop_text(round)))
        .with_table(run_table(&round.runs));
    if let (Some(before), Some(after)) = (round.residual_before, round.residual_after) {
        section = section.with_text(format!(
            "The largest residual of a channel is {} noise floors with the model at the start of the round, and {} with the updated one.",
            short_number(before),
            short_number(after)
        ));
    }
    if !round.findings.is_empty() {
        let columns =
            [ReportColumn::Text("component"), ReportColumn::Text("effect"), ReportColumn::Text("values")];
        let mut table = ReportTable::new("What no value within its tolerance explains", &columns);
        table.rows.extend(round.findings.iter().map(|found| {
            vec![
                ReportCell::text(&found.component),
                ReportCell::text(&found.effect),
                ReportCell::text(values_text(&found.values) + &equivalents_text(found)),
            ]
        }));
        section = section.with_table(table);
    }
    match &round.stop {
        Some(stop) => section.with_text(format!("The commissioning ends here: {}.", describe_stop(stop))),
        None => section.with_text(
            "The next round runs the same kinds of experiment: its model, its tolerances and its controller are others.",
        ),
    }
}

fn run_table(runs: &[RunSummary]) -> ReportTable {
    let columns = [
        ReportColumn::Text("experiment"),
        ReportColumn::Number("duration [s]"),
        ReportColumn::Text("channel"),
        ReportColumn::Number("recorded, RMS"),
        ReportColumn::Number("recorded less predicted, RMS"),
        ReportColumn::Number("outside the predicted band [%]"),
    ];
    let mut table = ReportTable::new("Predicted against measured", &columns);
    for run in runs {
        table.rows.extend(run.channels.iter().map(|channel| {
            vec![
                ReportCell::text(&run.name),
                ReportCell::text(short_number(run.duration_s)),
                ReportCell::text(&channel.channel),
                ReportCell::text(number_or_none(channel.recorded_rms)),
                ReportCell::text(number_or_none(channel.error_rms)),
                ReportCell::text(short_number(100.0 * channel.outside)),
            ]
        }));
    }
    table
}
