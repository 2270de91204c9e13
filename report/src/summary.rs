//! The first screen of a verification's report.

use crate::wording::acceptance::AcceptanceSource;
use crate::wording::figures::{describe_figure, describe_unmeasured};
use counterpoise_verify::verification::WorseFeedforward;
use counterpoise_verify::{
    Arrangement, CertificateFigure, Experiment, Limit, LoopFigure, Model, PerformanceFigure, Quantity,
    Requirement, Source, StepFigure, Verdict, Verification,
};

use crate::certificate::name_regime;
use crate::evidence::{disturbance_figure, step_figure};
use crate::wording::capitalise_first;
use crate::{FigureTile, Headline, OutcomeTone, ReportCell, ReportColumn, ReportSection, ReportTable};
use counterpoise_plot::number::short_number;

/// Returns the answer.
pub fn summarise_verdicts(found: &Verification) -> Headline {
    let (holds, fails, open) = found.counts();
    let all = holds + fails + open;
    let stable = found.evidence.margins.closed_loop_stable;
    let first = found.verdicts.iter().find_map(|(requirement, verdict)| failure(found, requirement, verdict));
    let detail = match (stable, first) {
        (false, _) => "The closed loop is unstable.".to_owned(),
        (true, Some(text)) => text,
        (true, None) if open > 0 => format!("{open} could not be judged: see the table."),
        _ => String::new(),
    };
    let detail = format!("{detail} {}", not_quiet(found).unwrap_or_default()).trim().to_owned();
    let (tone, text) = match (all, fails) {
        _ if !stable => (OutcomeTone::Bad, "The design does not work".to_owned()),
        (0, _) => (OutcomeTone::Neutral, "Nothing was required".to_owned()),
        (_, 0) if not_quiet(found).is_some() => {
            (OutcomeTone::Bad, format!("{holds} of {all} requirements hold, but the loop is not quiet"))
        }
        (_, 0) if open == 0 => (OutcomeTone::Good, format!("All {all} requirements hold")),
        (_, 0) => (OutcomeTone::Neutral, format!("{holds} of {all} requirements hold")),
        _ => (
            OutcomeTone::Bad,
            format!("{fails} of {all} requirements {}", if fails == 1 { "fails" } else { "fail" }),
        ),
    };
    Headline { tone, text, detail }
}

/// Returns what the stability certificate says against the loop, where no requirement on it was judged; `None` if nothing moves by itself.
pub fn not_quiet(found: &Verification) -> Option<String> {
    let figure = PerformanceFigure::Certificate(CertificateFigure::LimitCyclePeak);
    let is_judged = found.verdicts.iter().any(|(requirement, _)| requirement.figure == figure);
    let amplitude = found.value(figure).filter(|amplitude| *amplitude > 0.0 && !is_judged)?;
    let unit = figure.unit(found.controlled_quantity());
    Some(match amplitude.is_finite() {
        true => format!(
            "A limit cycle of {} {unit} stays, in the nonlinear simulation: see the stability of the exported controller.",
            short_number(amplitude)
        ),
        false => {
            "The motion grows by itself, in a regime of the certificate: see the stability of the exported controller.".to_owned()
        }
    })
}

fn failure(found: &Verification, requirement: &Requirement, verdict: &Verdict) -> Option<String> {
    let Verdict::Fails { value, limit, .. } = verdict else { return None };
    let unit = requirement.figure.unit(found.controlled_quantity());
    Some(format!(
        "{}: {} {unit} where {} {unit} is asked ({}).",
        capitalise_first(&describe_figure(requirement.figure, found.controlled_quantity())),
        short_number(*value),
        words_of(*limit),
        found.acceptance(&requirement.figure).basis
    ))
}

/// `\u{2265} 12`.
fn sign_of(limit: Limit) -> String {
    match limit {
        Limit::AtLeast(value) => format!("\u{2265} {}", short_number(value)),
        Limit::AtMost(value) => format!("\u{2264} {}", short_number(value)),
    }
}

/// Returns the words of a limit, such as `at least 12`.
pub fn words_of(limit: Limit) -> String {
    match limit {
        Limit::AtLeast(value) => format!("at least {}", short_number(value)),
        Limit::AtMost(value) => format!("at most {}", short_number(value)),
    }
}

/// Returns every requirement with what was measured.
pub fn verdict_table(found: &Verification) -> ReportTable {
    let columns = [
        ReportColumn::Text("requirement"),
        ReportColumn::Text("linear, or nonlinear at"),
        ReportColumn::Number("measured"),
        ReportColumn::Number("limit"),
        ReportColumn::Text("room"),
        ReportColumn::Text("verdict"),
    ];
    let mut table = ReportTable::new("Requirements", &columns);
    table.rows = found
        .verdicts
        .iter()
        .map(|(requirement, verdict)| verdict_row(found, requirement, verdict))
        .collect();
    table
}

fn verdict_row(found: &Verification, requirement: &Requirement, verdict: &Verdict) -> Vec<ReportCell> {
    let unit = requirement.figure.unit(found.controlled_quantity());
    let name = if unit.is_empty() {
        describe_figure(requirement.figure, found.controlled_quantity())
    } else {
        format!("{} [{unit}]", describe_figure(requirement.figure, found.controlled_quantity()))
    };
    let part = verdict.relative_distance().unwrap_or(0.0);
    let (measured, room, verdict) = match verdict {
        Verdict::Holds { value, margin, .. } => (
            short_number(*value),
            ReportCell::Room(OutcomeTone::Good, part, short_number(*margin)),
            ReportCell::Verdict(OutcomeTone::Good, "holds".to_owned()),
        ),
        Verdict::Fails { value, by, .. } => (
            short_number(*value),
            ReportCell::Room(OutcomeTone::Bad, part, short_number(-by)),
            ReportCell::Verdict(OutcomeTone::Bad, "fails".to_owned()),
        ),
        Verdict::NotApplicable { why } => (
            "\u{2013}".to_owned(),
            ReportCell::text(""),
            ReportCell::Verdict(OutcomeTone::Neutral, describe_unmeasured(why)),
        ),
    };
    let basis = ReportCell::text(found.acceptance(&requirement.figure).basis);
    vec![
        ReportCell::text(name),
        basis,
        ReportCell::text(measured),
        ReportCell::text(sign_of(requirement.limit)),
        room,
        verdict,
    ]
}

/// Returns every requirement with its source, the run that judged it, and the test on the machine that would; `None` without requirements.
pub fn traceability_section(found: &Verification) -> Option<ReportSection> {
    let columns = [
        ReportColumn::Text("requirement"),
        ReportColumn::Text("source"),
        ReportColumn::Text("judged by"),
        ReportColumn::Text("acceptance test on the machine"),
    ];
    let mut table = ReportTable::new("Requirements traced", &columns);
    let row = |requirement: &Requirement| {
        let figure = &requirement.figure;
        let acceptance = found.acceptance(figure);
        let source = if requirement.source.is_empty() { "not stated" } else { requirement.source.as_str() };
        vec![
            ReportCell::text(format!(
                "{}, {}",
                describe_figure(*figure, found.controlled_quantity()),
                sign_of(requirement.limit)
            )),
            ReportCell::text(source),
            ReportCell::text(acceptance.judged_by),
            ReportCell::text(acceptance.test),
        ]
    };
    table.rows = found.verdicts.iter().map(|(requirement, _)| row(requirement)).collect();
    let says = "Where each requirement comes from, and what would show on the machine that it holds.";
    (!table.rows.is_empty()).then(|| ReportSection::new("Traceability").with_text(says).with_table(table))
}

/// Returns the numbers that a reader wants first.
pub fn summary_tiles(found: &Verification) -> Vec<FigureTile> {
    let model = nonlinear_if_run(found);
    let hub =
        |source| PerformanceFigure::Disturbance(model, source, Arrangement::Compensated, Quantity::HubRms);
    let drr =
        |source| PerformanceFigure::Disturbance(model, source, Arrangement::Compensated, Quantity::Rejection);
    let on_road = format!("{} on the road", found.controlled_quantity().name());
    let wanted = [
        ("gain margin", PerformanceFigure::Loop(LoopFigure::GainMargin)),
        ("phase margin", PerformanceFigure::Loop(LoopFigure::PhaseMargin)),
        ("sensitivity Ms", PerformanceFigure::Loop(LoopFigure::MaxSensitivity)),
        ("gain margin, worst regime", PerformanceFigure::Certificate(CertificateFigure::GainMargin)),
        ("step overshoot", PerformanceFigure::Step(model, StepFigure::Overshoot)),
        ("DRR pitch", drr(Source::Pitch)),
        ("DRR heave", drr(Source::Heave)),
        (on_road.as_str(), hub(Source::Road)),
    ];
    wanted.into_iter().filter_map(|(label, figure)| tile(found, label, figure)).collect()
}

/// Returns the nonlinear plant where it was simulated, otherwise the linear one.
pub fn nonlinear_if_run(found: &Verification) -> Model {
    if found.history(Model::Nonlinear, Experiment::Step).is_some() { Model::Nonlinear } else { Model::Linear }
}

fn tile(found: &Verification, label: &str, figure: PerformanceFigure) -> Option<FigureTile> {
    let value = found.value(figure)?;
    let judged = found.verdicts.iter().find(|(requirement, _)| requirement.figure == figure);
    let tone = judged.map_or(OutcomeTone::Neutral, |(_, verdict)| tone_of(verdict));
    let controlled = found.controlled_quantity();
    let unit = figure.unit(controlled);
    let (scale, unit) = if unit == controlled.unit() { (1e3, controlled.milli_unit()) } else { (1.0, unit) };
    let limit = judged.map(|(requirement, _)| words_of(scale_limit(requirement.limit, scale)));
    let value = scale * value;
    let basis = rejection_note(found, figure).unwrap_or_else(|| tile_basis(found, figure));
    let note = limit.map_or_else(|| basis.clone(), |limit| format!("{limit}; {basis}"));
    Some(FigureTile {
        label: label.to_owned(),
        value: short_number(value),
        unit: unit.to_owned(),
        note,
        tone,
    })
}

/// Returns on what a figure rests: linear, or nonlinear at which amplitude; a figure of the certificate in which regime.
fn tile_basis(found: &Verification, figure: PerformanceFigure) -> String {
    let basis = found.acceptance(&figure).basis;
    match (figure, &found.worst_regime) {
        (PerformanceFigure::Certificate(_), Some(worst)) => {
            format!("linear, {} ({})", name_regime(worst.regime), worst.case)
        }
        (PerformanceFigure::Disturbance(..), _) => format!("RMS, all feedforwards, {basis}"),
        _ => basis,
    }
}

/// At which amplitude a rejection ratio holds, with the linear one beside the nonlinear one; `None` for any other figure.
fn rejection_note(found: &Verification, figure: PerformanceFigure) -> Option<String> {
    let PerformanceFigure::Disturbance(model, source, arrangement, Quantity::Rejection) = figure else {
        return None;
    };
    let history = found.history(model, Experiment::Disturbance(source, arrangement))?;
    let unit = if source == Source::Heave { "m/s\u{B2}" } else { "rad/s" };
    if model == Model::Linear {
        return Some("linear, at any amplitude".to_owned());
    }
    let beside = PerformanceFigure::Disturbance(Model::Linear, source, arrangement, Quantity::Rejection);
    let linear = found.value(beside).map_or(String::new(), |db| format!("; linear {} dB", short_number(db)));
    Some(format!("nonlinear, at {} {unit}{linear}", short_number(history.motion_amplitude()?)))
}

/// Returns a sentence for each motion of the platform under which the feedforwards make the hub rate worse.
pub fn worse_feedforwards(found: &Verification) -> Vec<String> {
    let (controlled, unit) = (found.controlled_quantity().name(), found.controlled_quantity().milli_unit());
    let line = |worse: WorseFeedforward| {
        let plant = if worse.model == Model::Nonlinear { "nonlinear" } else { "linear" };
        let name = match worse.source {
            Source::Heave => "heave",
            Source::Pitch => "pitch",
            Source::Road => "the road",
            Source::Both => "heave and pitch",
        };
        format!(
            "On the {plant} plant the feedforwards make the residual {controlled} under {name} worse: {} {unit} RMS with them, {} without",
            short_number(1e3 * worse.with),
            short_number(1e3 * worse.without)
        )
    };
    found.worse_feedforwards().into_iter().map(line).collect()
}

fn scale_limit(limit: Limit, scale: f64) -> Limit {
    match limit {
        Limit::AtLeast(value) => Limit::AtLeast(scale * value),
        Limit::AtMost(value) => Limit::AtMost(scale * value),
    }
}

fn tone_of(verdict: &Verdict) -> OutcomeTone {
    match verdict {
        Verdict::Holds { .. } => OutcomeTone::Good,
        Verdict::Fails { .. } => OutcomeTone::Bad,
        Verdict::NotApplicable { .. } => OutcomeTone::Neutral,
    }
}

/// Returns the two pictures beside the verdicts: the step, and the liveliest disturbance.
pub fn summary_figures(found: &Verification) -> Vec<counterpoise_plot::Figure> {
    let model = nonlinear_if_run(found);
    let source = if found
        .value(PerformanceFigure::Disturbance(model, Source::Road, Arrangement::Feedback, Quantity::HubRms))
        .is_some()
    {
        Source::Road
    } else {
        Source::Both
    };
    let both = [step_figure(found, 120.0), disturbance_figure(found, model, source, 120.0)];
    both.into_iter().flatten().collect()
}
