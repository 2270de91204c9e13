//! From results to reports.

use counterpoise_pipeline::Synthesised;
use counterpoise_pipeline::export::{project_hash, weights};
use counterpoise_pipeline::recordings::tracks::{Track, before_and_after, tracks};
use counterpoise_pipeline::recordings::{DiagnosedRecordings, ReadRecording, ReplayedRecording};
use counterpoise_pipeline::results::{DesignResult, ReplayResult, SynthResult};
use counterpoise_pipeline::studies::comparison::{Beside, beside};
use counterpoise_pipeline::studies::search::Searched;
use counterpoise_pipeline::{Consequence, Designed};
use counterpoise_report::design::{WEIGHTS, weight_section};
use counterpoise_report::diagnosis::report;
use counterpoise_report::wording::answer::AnswerText;
use counterpoise_report::{
    Cell, Column, Context, Headline, Report, Section, Table, Tile, Tone, bench, difference, html, of_design,
    trade_off,
};

use super::synth::VerifiedPoint;
use counterpoise_host::projects::Loaded;
use counterpoise_host::stages::StageTime;

/// A run of `design`, as its report tells of it.
pub struct Run {
    /// The command line.
    pub command: String,
    /// What each stage took.
    pub times: Vec<StageTime>,
    /// The controller on its targets.
    pub targets: Section,
}

/// The report of a design.
pub fn design(loaded: &Loaded, made: &Designed, run: &Run) -> anyhow::Result<String> {
    let result = DesignResult::from(made);
    let (plant, made_of) = ((&made.modelled, &made.reduced), &made.synthesised);
    let mut more = bench::sections(made_of, &beside(&loaded.project, plant, made_of)?)?;
    more.push(certificates(&result));
    more.push(run.targets.clone());
    if !made.left_out.is_empty() {
        let lines = made.left_out.iter().map(ToString::to_string);
        more.push(lines.fold(Section::new("Code that was left out"), Section::saying));
    }
    more.push(times_section(&run.times));
    let context = Context {
        title: loaded.project.plant.name.clone(),
        subtitle: "From the project file to a verified controller".to_owned(),
        more,
        provenance: vec![
            ("version".to_owned(), env!("CARGO_PKG_VERSION").to_owned()),
            ("project".to_owned(), loaded.path.display().to_string()),
            ("project hash".to_owned(), project_hash(&loaded.project)),
            ("command".to_owned(), run.command.clone()),
        ],
    };
    let mut report = of_design(made, context)?;
    let lines = loaded.project.synth.as_ref().map(weights).unwrap_or_default();
    for section in report.sections.iter_mut().filter(|section| section.heading == WEIGHTS) {
        section.text.clone_from(&lines);
    }
    reproduced_by(&mut report, &run.command);
    Ok(html(&report))
}

/// The report of `synth`: the weights, and what stands beside the design.
pub fn synth(
    loaded: &Loaded,
    (made, beside): (&Synthesised, &Beside),
    result: &SynthResult,
) -> anyhow::Result<String> {
    let command = format!("counterpoise synth {}", loaded.path.display());
    let radius = result.closed_loop_poles.iter().map(|[re, im]| re.hypot(*im)).fold(0.0, f64::max);
    let mut sections = bench::sections(made, beside)?;
    let mut weights_section = weight_section(&made.design.specification);
    weights_section.text = loaded.project.synth.as_ref().map(weights).unwrap_or_default();
    sections.push(weights_section);
    let tile = |(name, order): (&String, &usize)| Tile::plain(name, order.to_string(), "states");
    let mut report = Report {
        title: loaded.project.plant.name.clone(),
        subtitle: "The design, and what stands beside it".to_owned(),
        headline: Headline {
            tone: Tone::Neutral,
            text: format!("The sampled loop is stable: largest pole modulus {radius:.6}"),
            detail: format!("Design plant of order {}.", result.plant_order),
        },
        tiles: result.path_orders.iter().map(tile).collect(),
        verdicts: Table::new("", &[]),
        glance: Vec::new(),
        sections,
        provenance: provenance(loaded, &command),
    };
    reproduced_by(&mut report, &command);
    Ok(html(&report))
}

/// The report of a search: the trade-off curve, and the verdicts on its points.
pub fn search(loaded: &Loaded, found: &Searched, points: &[VerifiedPoint]) -> anyhow::Result<String> {
    let command = format!("counterpoise synth {} --search", loaded.path.display());
    let mut report = trade_off::report(&loaded.project.plant.name, found, &verified_table(points));
    report.provenance = provenance(loaded, &command);
    reproduced_by(&mut report, &command);
    Ok(html(&report))
}

fn verified_table(points: &[VerifiedPoint]) -> Table {
    let columns = [
        Column::Text("weights"),
        Column::Number("|S| over the band"),
        Column::Number("hold"),
        Column::Number("fail"),
        Column::Text("verdict"),
        Column::Text("what fails"),
    ];
    let mut table = Table::new("Verified on the full nonlinear plant", &columns);
    for point in points {
        let name = point
            .max_sensitivity_limit
            .map_or("the answer".to_owned(), |limit| format!("Ms at most {limit}"));
        let verdict = if point.holds {
            Cell::Verdict(Tone::Good, "holds".to_owned())
        } else {
            Cell::Verdict(Tone::Bad, "fails".to_owned())
        };
        table.rows.push(vec![
            Cell::text(name),
            Cell::number(point.rejection),
            Cell::text(point.verdicts[0].to_string()),
            Cell::text(point.verdicts[1].to_string()),
            verdict,
            Cell::text(point.failing.join("; ")),
        ]);
    }
    table
}

fn provenance(loaded: &Loaded, command: &str) -> Vec<(String, String)> {
    vec![
        ("version".to_owned(), env!("CARGO_PKG_VERSION").to_owned()),
        ("project".to_owned(), loaded.path.display().to_string()),
        ("project hash".to_owned(), project_hash(&loaded.project)),
        ("command".to_owned(), command.to_owned()),
    ]
}

/// Writes under every figure of the evidence the command that reproduces it.
pub fn reproduced_by(report: &mut Report, command: &str) {
    let figures = report.sections.iter_mut().flat_map(|section| &mut section.figures);
    figures.filter(|figure| figure.command.is_empty()).for_each(|figure| figure.command = command.to_owned());
}

fn certificates(result: &DesignResult) -> Section {
    let mut table = Table::new("", &[Column::Text("certificate"), Column::Number("value")]);
    let mut row = |name: &str, value: String| table.rows.push(vec![Cell::text(name), Cell::text(value)]);
    row("order of the plant", result.model.order.to_string());
    row("order of the design plant, sensors and delay included", result.synth.plant_order.to_string());
    for (name, order) in &result.synth.path_orders {
        row(&format!("states of the {name} path"), order.to_string());
    }
    let radius = result.synth.closed_loop_poles.iter().map(|[re, im]| re.hypot(*im)).fold(0.0, f64::max);
    row("largest modulus of a pole of the closed sampled loop", format!("{radius:.6}"));
    if let Some(difference) = result.synth.cost_difference {
        row("predicted cost against cost of the assembled loop, relative", format!("{difference:.1e}"));
    }
    let section = Section::new("Orders").listing(table);
    let remarks = result.synth.warnings.iter().chain(&result.reduce.warnings);
    remarks.fold(section, |section, warning| section.saying(format!("Warning: {warning}")))
}

fn times_section(times: &[StageTime]) -> Section {
    let mut table = Table::new("", &[Column::Text("stage"), Column::Number("time [ms]")]);
    for time in times {
        table.rows.push(vec![Cell::text(time.name.clone()), Cell::text(format!("{:.1}", time.milliseconds))]);
    }
    Section::new("What each stage took").listing(table)
}

/// The report of a diagnosis.
pub fn diagnosis(
    loaded: &Loaded,
    (found, answer): (&DiagnosedRecordings, &AnswerText),
    consequence: Option<&Consequence>,
) -> String {
    let (project, diagnosis) = (&loaded.project, &found.diagnosis);
    let recordings = found.repaired(project);
    let tracks = before_and_after(&recordings, &found.control, &project.plant, &diagnosis.improved);
    let command = format!("counterpoise diagnose {}", loaded.path.display());
    let mut page = report(&project.plant.name, &command, answer, &tracks);
    page.sections.splice(1..1, consequence.map(difference::consequence));
    html(&page)
}

/// The report of a replay: measured and simulated, without a search.
pub fn replay(
    loaded: &Loaded,
    read: &[ReadRecording],
    replayed: &[ReplayedRecording],
    result: &ReplayResult,
) -> String {
    let pairs = read.iter().zip(replayed);
    let all: Vec<Vec<Track>> =
        pairs.map(|(item, replay)| tracks(&item.recording, &replay.followed.replay, None)).collect();
    let command = format!("counterpoise replay {}", loaded.path.display());
    let title = format!("Replay of {}", loaded.project.plant.name);
    html(&counterpoise_report::replay::report(&title, &command, result, &all))
}
