//! The pages of a robustness campaign.

use crate::wording::figures::describe_figure;
use counterpoise_pipeline::studies::sweep::{CampaignResult, RobustnessLimit};
use counterpoise_verify::robustness::{MemberDifference, Sense, Summary, WorstMechanism};
use counterpoise_verify::{Limit, Requirement, Value, Verification};

use serde::Serialize;

use crate::certificate;
use crate::verification::VerificationContext;
use crate::wording::capitalise_first;
use crate::{
    Headline, OutcomeTone, Report, ReportCell, ReportColumn, ReportSection, ReportTable, robustness, summary,
};
use counterpoise_plot::number::short_number;
use counterpoise_plot::{Axis, Colour, Figure, Mark, Panel, Series};

/// Returns the report: shares of the campaign on the first screen. `project` is the project as the command line names it.
pub fn campaign_report(
    nominal: &Verification,
    found: &CampaignResult,
    project: &str,
    context: VerificationContext,
) -> Report {
    let (good, all) = (found.passing, found.samples());
    let tone = if good == all { OutcomeTone::Good } else { OutcomeTone::Bad };
    let text = format!("{good} of {all} mechanisms meet every requirement");
    let detail = format!(
        "The nominal design: {}.{}",
        summary::summarise_verdicts(nominal).text.to_lowercase(),
        outside_samples(found)
    );
    let mut sections = vec![worst_cases(found, project)];
    sections.extend(found.stability.as_ref().map(robustness::robustness_section));
    sections.extend(certificate::robustness_of_regimes(&found.regimes));
    sections.extend(statistics(found));
    sections.extend(context.more);
    Report {
        title: format!("{}: robustness", context.title),
        subtitle: context.subtitle,
        headline: Headline { tone, text, detail },
        tiles: Vec::new(),
        verdicts: shares(found),
        glance: Vec::new(),
        sections,
        provenance: context.provenance,
    }
}

/// Distributions, sensitivities and families.
fn statistics(found: &CampaignResult) -> Vec<ReportSection> {
    let count = found.requirements.len();
    let distributions = ReportSection::new("Distributions")
        .with_text("How many mechanisms lie below a value; the dotted line is the limit.")
        .with_figures((0..count).map(|k| distribution(found, k)));
    let sensitivity = ReportSection::new("What matters")
        .with_text(format!(
            "Spearman's rank correlation between each factor and each figure: \u{2212}1 or 1 is strict order, 0 is none. \
             \"Either way\" compares the factor's distance from 1, where that says more. Left out is what chance alone would often give: less than {:.2}, two over the root of the number of mechanisms.",
            found.chance_correlation()
        ))
        .with_table(sensitivity(found));
    let members = ReportSection::new("One at a time, and each configuration")
        .with_table(member_summary(found))
        .with_table(member_table(found));
    vec![distributions, sensitivity, members]
}

/// Returns what is known outside the samples, for the headline: the worst cases, and how far the linear loop is from
/// its limit.
fn outside_samples(found: &CampaignResult) -> String {
    let both = found.requirements.iter().zip(&found.worst);
    let fails = both.filter(|(requirement, worst)| {
        worst.as_ref().is_some_and(|worst| requirement.limit.distance_to_limit(worst.value) < 0.0)
    });
    let fails = fails.count();
    let searched = match fails {
        0 => " The search for worst cases finds none that fails.".to_owned(),
        some => format!(" In its worst case {some} of {} requirements fail.", found.worst.len()),
    };
    let stable = found
        .least_robust()
        .map_or(String::new(), |least| format!(" {}.", capitalise_first(&robustness_limit(least))));
    searched + &stable
}

/// Returns how far the ranges of a campaign may be widened in the case and regime where they may least.
pub fn robustness_limit(least: RobustnessLimit<'_>) -> String {
    let place = name_limit(least);
    match least.factor {
        0.0 => format!("the linear loop is unstable without any deviation: {place}"),
        factor if factor < 1.0 => format!(
            "the linear loop is NOT stable for every mechanism in the stated ranges, only within {} times the ranges: {place}",
            short_number(factor)
        ),
        factor => format!(
            "the linear loop is stable within {} times the stated ranges in every case and regime, least in: {place}",
            short_number(factor)
        ),
    }
}

/// A requirement over a campaign, for another program.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SweepFigure {
    /// Key of the figure.
    pub figure: String,
    /// Which side of the limit is required: `at least` or `at most`.
    pub side: &'static str,
    /// Limit of the requirement.
    pub limit: f64,
    /// Share of the mechanisms that meet the requirement.
    pub share: f64,
    /// The share's 95 % interval.
    pub interval: (f64, f64),
    /// 5 % quantile of the figure.
    pub q05: f64,
    /// Median of the figure.
    pub median: f64,
    /// 95 % quantile of the figure.
    pub q95: f64,
    /// The sample with the least room; `None` if none could be judged.
    pub worst_sample: Option<usize>,
    /// The worst case that a search found from there.
    pub worst_case: Option<WorstCase>,
}

/// The worst case that was found from the worst sample, and how to run it again.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WorstCase {
    /// The figure.
    pub value: f64,
    /// `true` if it meets the requirement.
    pub meets: bool,
    /// The sample from which the search started, whose noise it kept.
    pub sample: usize,
    /// Factor of every parameter that varies.
    pub factors: Vec<(&'static str, f64)>,
    /// Options of `counterpoise sweep` that run it again.
    pub options: String,
    /// Number of mechanisms that were tried.
    pub tried: usize,
    /// `true` if the search ended because its steps grew small, not because of its limit.
    pub converged: bool,
}

fn name_limit(limit: RobustnessLimit<'_>) -> String {
    limit.at.map_or("design".to_owned(), certificate::name_robust_regime)
}

/// Returns every requirement of a campaign as plain data.
pub fn sweep_figures(found: &CampaignResult) -> Vec<SweepFigure> {
    let row = |(k, over): (usize, &Summary)| SweepFigure {
        figure: found.requirements[k].figure.key_in(found.controlled),
        side: found.requirements[k].limit.side(),
        limit: found.requirements[k].limit.value(),
        share: over.share,
        interval: over.interval,
        q05: over.q05,
        median: over.median,
        q95: over.q95,
        worst_sample: over.worst,
        worst_case: found.worst[k].as_ref().map(|worst| worst_of(found, k, worst)),
    };
    found.summaries.iter().enumerate().map(row).collect()
}

fn worst_of(found: &CampaignResult, requirement: usize, worst: &WorstMechanism) -> WorstCase {
    let keys = found.variations.iter().map(|variation| variation.parameter.key());
    WorstCase {
        value: worst.value,
        meets: found.requirements[requirement].limit.distance_to_limit(worst.value) >= 0.0,
        sample: worst.sample,
        factors: keys.zip(worst.factors.iter().copied()).collect(),
        options: rerun_options(found, worst),
        tried: worst.tried,
        converged: worst.converged,
    }
}

/// Returns the options of `counterpoise sweep` that run a worst case again.
pub fn rerun_options(found: &CampaignResult, worst: &WorstMechanism) -> String {
    let both = found.variations.iter().zip(&worst.factors);
    let words: Vec<String> =
        both.map(|(variation, factor)| format!("{}={factor:.6}", variation.parameter.key())).collect();
    format!("--sample {} --factors {}", worst.sample, words.join(","))
}

/// Returns the worst case of each requirement beside its worst sample, with the factors that matter most for
/// it.
fn worst_cases(found: &CampaignResult, project: &str) -> ReportSection {
    let columns = [
        ReportColumn::Text("requirement"),
        ReportColumn::Number("worst sample"),
        ReportColumn::Number("worst case"),
        ReportColumn::Text("verdict"),
        ReportColumn::Text("what matters most"),
        ReportColumn::Text("factors of the worst case"),
    ];
    let mut table = ReportTable::new("", &columns);
    for (k, worst) in found.worst.iter().enumerate() {
        let Some(worst) = worst else { continue };
        let limit = found.requirements[k].limit;
        let verdict = match limit.distance_to_limit(worst.value) {
            room if room >= 0.0 => ReportCell::Verdict(OutcomeTone::Good, "holds".to_owned()),
            room => ReportCell::Verdict(OutcomeTone::Bad, format!("fails by {}", short_number(-room))),
        };
        let both = found.variations.iter().zip(&worst.factors);
        let words: Vec<String> = both
            .map(|(variation, factor)| format!("{} {}", variation.parameter.key(), short_number(*factor)))
            .collect();
        table.rows.push(vec![
            ReportCell::text(format!("{} {}", name(found, k), bound(limit))),
            ReportCell::number(worst.start),
            ReportCell::number(worst.value),
            verdict,
            ReportCell::text(matters(found, k, MOST_NAMED)),
            ReportCell::text(words.join(", ")),
        ]);
    }
    let first = found.worst.iter().flatten().next().map(|worst| rerun_options(found, worst));
    let section = ReportSection::new("Worst cases")
        .with_text(
            "From the worst sample of each requirement a compass search goes on inside the stated ranges, with that sample's sensor noise. \
             What it finds is at least as bad as the sample; something worse may exist. What matters most is by rank correlation over the \
             samples, strongest first: + where a larger factor raises the figure; \"either way\" where its distance from 1 does.",
        )
        .with_table(table);
    match first {
        Some(options) => section
            .with_text(format!("One is run again by, for example: counterpoise sweep {project} {options}")),
        None => section,
    }
}

fn name(found: &CampaignResult, requirement: usize) -> String {
    let figure = found.requirements[requirement].figure;
    let (name, unit) = (describe_figure(figure, found.controlled), figure.unit(found.controlled));
    if unit.is_empty() { name } else { format!("{name} [{unit}]") }
}

fn shares(found: &CampaignResult) -> ReportTable {
    let columns = [
        ReportColumn::Text("requirement"),
        ReportColumn::Number("met by"),
        ReportColumn::Number("95 % interval"),
        ReportColumn::Number("5 %"),
        ReportColumn::Number("median"),
        ReportColumn::Number("95 %"),
        ReportColumn::Number("worst sample"),
    ];
    let mut table = ReportTable::new("Requirements over the campaign", &columns);
    for k in 0..found.requirements.len() {
        let over = &found.summaries[k];
        let tone = if over.share >= 1.0 { OutcomeTone::Good } else { OutcomeTone::Bad };
        let sign = bound(found.requirements[k].limit);
        table.rows.push(vec![
            ReportCell::text(format!("{} {sign}", name(found, k))),
            ReportCell::Verdict(tone, format!("{:.1} %", 100.0 * over.share)),
            ReportCell::text(format!("{:.1} to {:.1}", 100.0 * over.interval.0, 100.0 * over.interval.1)),
            ReportCell::number(over.q05),
            ReportCell::number(over.median),
            ReportCell::number(over.q95),
            ReportCell::text(over.worst.map_or(String::new(), |index| index.to_string())),
        ]);
    }
    table
}

/// Returns the share of mechanisms below each value.
fn distribution(found: &CampaignResult, requirement: usize) -> Figure {
    let distribution = &found.distributions[requirement];
    let figure = found.requirements[requirement].figure;
    let name = describe_figure(figure, found.controlled);
    let limit = found.requirements[requirement].limit.value();
    let marks = vec![Mark::Instant { x: limit, text: format!("limit {}", short_number(limit)) }];
    let panel = Panel::new(
        Axis::linear("mechanisms below", "%").with_range(0.0, 100.0),
        vec![Series::solid_line(
            "",
            Colour::First,
            distribution.iter().map(|[value, share]| (*value, *share)),
        )],
    );
    let (low, high) = (
        distribution.first().map_or(limit, |[value, _]| *value),
        distribution.last().map_or(limit, |[value, _]| *value),
    );
    let span = high.max(limit) - low.min(limit);
    let span = if span > 0.0 { span } else { limit.abs().max(1.0) };
    let room = 0.03 * span;
    let axis = Axis::linear(&name, figure.unit(found.controlled))
        .with_range(low.min(limit) - room, high.max(limit) + room);
    Figure::new(&name, axis, vec![panel.with_marks(marks).with_height(150.0)])
}

fn sensitivity(found: &CampaignResult) -> ReportTable {
    let mut table =
        ReportTable::new("", &[ReportColumn::Text("figure"), ReportColumn::Text("strongest first")]);
    for k in 0..found.requirements.len() {
        let words = matters(found, k, found.variations.len());
        table.rows.push(vec![ReportCell::text(name(found, k)), ReportCell::text(words)]);
    }
    table
}

/// Factors named beside a worst case.
const MOST_NAMED: usize = 3;

/// At most so many factors that stand out from chance, with their rank correlation.
fn matters(found: &CampaignResult, requirement: usize, most: usize) -> String {
    let words = found.clear_rankings(requirement).take(most).map(|one| {
        let key = found.variations[one.variation].parameter.key();
        let either = if one.sense == Sense::EitherWay { "either way " } else { "" };
        format!("{key} {either}{:+.2}", one.correlation).replace('-', "\u{2212}")
    });
    let words = words.collect::<Vec<_>>().join(",  ");
    if words.is_empty() { "nothing that stands out".to_owned() } else { words }
}

/// Returns what a mechanism of a family is, for example `backlash x 2` or a configuration's name.
fn member_name(difference: &MemberDifference) -> String {
    match difference {
        MemberDifference::Scaled { parameter, factor } => format!("{} x {factor}", parameter.key()),
        MemberDifference::Configuration(name) => name.clone(),
    }
}

/// Returns a mechanism a row: how many requirements hold, and what fails.
fn member_summary(found: &CampaignResult) -> ReportTable {
    let columns = [
        ReportColumn::Text("mechanism"),
        ReportColumn::Text("requirements"),
        ReportColumn::Text("what fails"),
    ];
    let mut table = ReportTable::new("Verdicts", &columns);
    for member in &found.families {
        let both = found.requirements.iter().zip(&member.values);
        let judged: Vec<_> =
            both.map(|(requirement, value)| (requirement, judge_figure(requirement, value))).collect();
        let all = judged.iter().filter(|(_, (_, room))| !room.is_nan()).count();
        let failed: Vec<String> = judged
            .iter()
            .filter(|(_, (_, room))| *room < 0.0)
            .map(|(requirement, (value, _))| failure(found, requirement, *value))
            .collect();
        let verdict = match failed.len() {
            0 => ReportCell::Verdict(OutcomeTone::Good, format!("all {all} hold")),
            some => ReportCell::Verdict(OutcomeTone::Bad, format!("{some} of {all} fail")),
        };
        table.rows.push(vec![
            ReportCell::text(member_name(&member.difference)),
            verdict,
            ReportCell::text(failed.join("; ")),
        ]);
    }
    table
}

fn failure(found: &CampaignResult, requirement: &Requirement, value: f64) -> String {
    let figure = requirement.figure;
    let value = format!("{} {}", short_number(value), figure.unit(found.controlled));
    format!(
        "{}: {} ({})",
        describe_figure(figure, found.controlled),
        value.trim_end(),
        bound(requirement.limit)
    )
}

/// Returns a limit with its sign.
fn bound(limit: Limit) -> String {
    match limit {
        Limit::AtLeast(limit) => format!("\u{2265} {}", short_number(limit)),
        Limit::AtMost(limit) => format!("\u{2264} {}", short_number(limit)),
    }
}

/// Returns a figure and its room; NaN if it could not be measured.
fn judge_figure(requirement: &Requirement, value: &Value) -> (f64, f64) {
    match value {
        Value::Is(number) => (*number, requirement.limit.distance_to_limit(*number)),
        Value::Absent { .. } => (f64::NAN, f64::NAN),
    }
}

/// Mechanisms down, requirements as text: their number varies, columns are fixed.
fn member_table(found: &CampaignResult) -> ReportTable {
    let columns = [
        ReportColumn::Text("mechanism"),
        ReportColumn::Text("figure"),
        ReportColumn::Number("value"),
        ReportColumn::Text("verdict"),
    ];
    let mut table = ReportTable::new("Every figure", &columns);
    for member in &found.families {
        for (k, (requirement, value)) in found.requirements.iter().zip(&member.values).enumerate() {
            let (number, room) = judge_figure(requirement, value);
            let (tone, word) = match room {
                r if r.is_nan() => (OutcomeTone::Neutral, "not applicable".to_owned()),
                r if r >= 0.0 => (OutcomeTone::Good, "holds".to_owned()),
                r => (OutcomeTone::Bad, format!("fails by {}", short_number(-r))),
            };
            table.rows.push(vec![
                ReportCell::text(member_name(&member.difference)),
                ReportCell::text(name(found, k)),
                ReportCell::number(number),
                ReportCell::Verdict(tone, word),
            ]);
        }
    }
    table
}
