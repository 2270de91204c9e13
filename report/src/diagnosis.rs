//! The report of a diagnosis: the answer first, then how the fit improved, the localisation, and the candidates.

use crate::wording::answer::{AnswerText, FindingText, describe_verdict, describe_warning, unit_suffix};
use crate::wording::{capitalise_first, name_in_words};
use counterpoise_diagnose::findings::answer::DiagnosisVerdict;
use counterpoise_diagnose::findings::channel_fits::PooledFits;
use counterpoise_recordings::Channel;

use counterpoise_plot::number::short_number;
use counterpoise_plot::{Axis, Colour, Figure, Panel, Series};

use crate::learned::learned_section;
use crate::localisation::localisation_section;
use counterpoise_pipeline::RedesignComparison;
use counterpoise_pipeline::recordings::DiagnosedRecordings;
use counterpoise_pipeline::recordings::tracks::{ChannelTrack, ResidualColumn, TrackColumn};

use crate::{
    FigureTile, Headline, OutcomeTone, ProvenanceEntry, Report, ReportCell, ReportColumn, ReportSection,
    ReportTable, difference, residual,
};

/// Returns the report of a diagnosis; `consequence` is what the improved model means for the project's design.
pub fn diagnosis_report(
    machine: &str,
    command: &str,
    found: &DiagnosedRecordings,
    answer: &AnswerText,
    consequence: Option<&RedesignComparison>,
) -> Report {
    let tracks = &found.tracks;
    let mut sections = vec![fit_section(answer, tracks)];
    sections.extend(answer.learned.as_ref().map(learned_section));
    sections.extend(consequence.map(difference::consequence_section));
    sections.extend(residual::residual_sections(tracks, &found.residuals));
    sections.extend([localisation_section(answer), tried_section(answer), cannot_tell(answer)]);
    Report {
        title: format!("Diagnosis of {machine}"),
        subtitle: "the residuals between recordings and simulation, and the effects that explain them"
            .to_owned(),
        headline: headline(answer),
        tiles: tiles(answer),
        verdicts: findings_table(&answer.findings),
        glance: worst_track(tracks).map(|t| comparison(t, command)).into_iter().collect(),
        sections,
        provenance: vec![
            ProvenanceEntry::new("version", env!("CARGO_PKG_VERSION")),
            ProvenanceEntry::new("command", command),
        ],
    }
}

fn headline(answer: &AnswerText) -> Headline {
    let names: Vec<String> = answer
        .findings
        .iter()
        .map(|f| format!("{} {}", f.component, name_in_words(f.effect.name())))
        .collect();
    let sentence = capitalise_first(describe_verdict(answer.verdict).sentence);
    let tone = match answer.verdict {
        DiagnosisVerdict::Consistent | DiagnosisVerdict::Named => OutcomeTone::Good,
        DiagnosisVerdict::Ambiguous | DiagnosisVerdict::Incomplete => OutcomeTone::Neutral,
        DiagnosisVerdict::Unknown => OutcomeTone::Bad,
    };
    let text = match answer.verdict {
        DiagnosisVerdict::Consistent | DiagnosisVerdict::Unknown => sentence,
        DiagnosisVerdict::Named | DiagnosisVerdict::Ambiguous | DiagnosisVerdict::Incomplete => {
            format!("{sentence}: {}", names.join(", "))
        }
    };
    let detail = answer.findings.first().map_or_else(String::new, |f| f.explanation.clone());
    Headline { tone, text, detail }
}

fn tiles(answer: &AnswerText) -> Vec<FigureTile> {
    let mut out = vec![
        FigureTile::plain(
            "residual over noise floor, before",
            format!("{:.1}", answer.fit.largest_before()),
            "",
        )
        .with_note("worst channel, all recordings"),
        FigureTile::plain(
            "residual over noise floor, after",
            format!("{:.2}", answer.fit.largest_after()),
            "",
        )
        .with_note("1 is perfect"),
        FigureTile::plain("on held-out data", format!("{:.2}", answer.fit.largest_held_out()), "")
            .with_note("worst channel"),
    ];
    if let Some(first) = answer.findings.first() {
        let probability = FigureTile::plain("probability", format!("{:.0}", 100.0 * first.probability), "%");
        out.push(probability.with_note("of the first finding"));
    }
    out
}

fn findings_table(findings: &[FindingText]) -> ReportTable {
    let columns = [
        ReportColumn::Text("component"),
        ReportColumn::Text("effect"),
        ReportColumn::Number("probability"),
        ReportColumn::Text("parameters (95 % interval)"),
        ReportColumn::Text("equivalent effects"),
    ];
    let mut table = ReportTable::new("Findings, most important first", &columns);
    for finding in findings {
        let parameters = finding.parameters.iter().take(6).map(|p| {
            format!(
                "{} = {:.4}{} [{:.4}, {:.4}], was {:.4}",
                p.name,
                p.value,
                unit_suffix(p),
                p.ci95[0],
                p.ci95[1],
                p.before
            )
        });
        let others = finding
            .alternatives
            .iter()
            .map(|a| format!("{} {}", a.component, name_in_words(a.effect.name())));
        table.rows.push(vec![
            ReportCell::text(finding.component.name()),
            ReportCell::text(name_in_words(finding.effect.name())),
            ReportCell::text(format!("{:.0} %", 100.0 * finding.probability)),
            ReportCell::text(parameters.collect::<Vec<_>>().join("; ")),
            ReportCell::text(others.collect::<Vec<_>>().join(", ")),
        ]);
    }
    table
}

fn fit_section(answer: &AnswerText, tracks: &[ChannelTrack]) -> ReportSection {
    let columns = [
        ReportColumn::Text("channel"),
        ReportColumn::Number("floor"),
        ReportColumn::Number("before"),
        ReportColumn::Number("after"),
        ReportColumn::Number("held out, before"),
        ReportColumn::Number("held out, after"),
    ];
    let mut table =
        ReportTable::new("RMS error per channel over all recordings, and on held-out data", &columns);
    for (channel, before) in answer.fit.before.iter() {
        let number = |channels: &PooledFits| {
            channels.get(channel).map_or_else(|| ReportCell::text(""), |c| ReportCell::number(c.rms_error))
        };
        table.rows.push(vec![
            ReportCell::text(track_words(tracks, channel)),
            ReportCell::number(before.floor),
            ReportCell::number(before.rms_error),
            number(&answer.fit.after),
            number(&answer.fit.held_out_before),
            number(&answer.fit.held_out_after),
        ]);
    }
    let figures = tracks.iter().filter(|t| matches!(t.channel, Channel::Control | Channel::HubRate));
    ReportSection::new("How the fit improved")
        .with_table(table)
        .with_figures(figures.map(|t| comparison(t, "")))
}

fn tried_section(answer: &AnswerText) -> ReportSection {
    let columns = [
        ReportColumn::Number("stage"),
        ReportColumn::Text("component"),
        ReportColumn::Text("effect"),
        ReportColumn::Text("beside"),
        ReportColumn::Number("gain in log-likelihood, held-out data"),
        ReportColumn::Number("mean ln(error / floor)"),
        ReportColumn::Number("worst error / floor"),
        ReportColumn::Text(""),
    ];
    let mut table = ReportTable::new("Every hypothesis that was fitted in the simulator", &columns);
    for h in &answer.hypotheses {
        let beside: Vec<String> =
            h.beside.iter().map(|b| format!("{} {}", b.component, name_in_words(b.effect.name()))).collect();
        let verdict = if h.accepted {
            ReportCell::Verdict(OutcomeTone::Good, "accepted".to_owned())
        } else {
            ReportCell::text("")
        };
        table.rows.push(vec![
            ReportCell::text(h.stage.to_string()),
            ReportCell::text(h.component.name()),
            ReportCell::text(name_in_words(h.effect.name())),
            ReportCell::text(beside.join(", ")),
            ReportCell::number(h.log_likelihood_gain),
            ReportCell::text(format!("{:.3}", h.distance)),
            ReportCell::text(format!("{:.2}", h.worst)),
            verdict,
        ]);
    }
    ReportSection::new("What was tried").with_table(table)
}

fn cannot_tell(answer: &AnswerText) -> ReportSection {
    let columns = [
        ReportColumn::Text("component"),
        ReportColumn::Text("effect"),
        ReportColumn::Text("smallest that would show"),
    ];
    let mut table =
        ReportTable::new("Effects of which these recordings cannot say whether they are there", &columns);
    for n in &answer.not_excited {
        let size = match n.smallest_detectable {
            Some(size) => format!("{} {} {}", n.parameter, short_number(size), n.unit),
            None => "nothing: it does not move them".to_owned(),
        };
        table.rows.push(vec![
            ReportCell::text(n.component.name()),
            ReportCell::text(name_in_words(n.effect.name())),
            ReportCell::text(size),
        ]);
    }
    let section = ReportSection::new("What these recordings cannot tell").with_table(table);
    let section = match &answer.next_experiment {
        Some(next) => section.with_text(format!("Next experiment: {}. It {}.", next.what, next.why)),
        None => section,
    };
    let warnings = answer.warnings.iter().map(|warning| -> &str { describe_warning(*warning) });
    let remarks = answer.qualification.iter().map(String::as_str).chain(warnings);
    remarks.fold(section, ReportSection::with_text)
}

/// Returns the track of control or hub rate whose residual was largest against the measurement.
pub(super) fn worst_track<'a>(
    tracks: impl IntoIterator<Item = &'a ChannelTrack>,
) -> Option<&'a ChannelTrack> {
    let drawn = tracks.into_iter().filter(|t| matches!(t.channel, Channel::Control | Channel::HubRate));
    drawn.max_by(|a, b| a.relative_residual_power.total_cmp(&b.relative_residual_power))
}

/// Measured and simulated above, the residuals below.
pub(super) fn comparison(track: &ChannelTrack, command: &str) -> Figure {
    let points = |series: &[f64]| -> Vec<(f64, f64)> {
        series.iter().enumerate().map(|(k, v)| (k as f64 * track.period_s, *v)).collect()
    };
    let name = if track.signals.column(TrackColumn::After).is_empty() { "model" } else { "model as it was" };
    let mut signals = vec![
        Series::solid_line("measured", Colour::Muted, points(track.signals.column(TrackColumn::Measured))),
        Series::solid_line(name, Colour::Second, points(track.signals.column(TrackColumn::Before))),
    ];
    let residual = |run| points(track.residuals.column(run));
    let mut residuals = vec![Series::solid_line(name, Colour::Second, residual(ResidualColumn::Before))];
    if !track.signals.column(TrackColumn::After).is_empty() {
        signals.push(Series::solid_line(
            "improved model",
            Colour::First,
            points(track.signals.column(TrackColumn::After)),
        ));
        residuals.push(Series::solid_line("improved model", Colour::First, residual(ResidualColumn::After)));
    }
    let panels = vec![
        Panel::new(Axis::linear(track.words.name, track.words.unit), signals).with_height(190.0),
        Panel::new(Axis::linear("residual", track.words.unit), residuals).with_height(120.0),
    ];
    let title = format!("{}: {}", track.recording, track.words.name.replace('_', " "));
    let figure = Figure::new(&title, Axis::linear("time", "s"), panels);
    Figure { command: command.to_owned(), ..figure }
}
/// Returns the name of a channel as a machine has it, or that of the channel if it was not drawn.
fn track_words(tracks: &[ChannelTrack], channel: Channel) -> &'static str {
    tracks.iter().find(|track| track.channel == channel).map_or(channel.name(), |track| track.words.name)
}
