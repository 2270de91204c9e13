//! From results to reports.

use counterpoise::report::design::WEIGHTS;
use counterpoise::report::diagnosis::{Track, report};
use counterpoise::report::{Cell, Column, Context, Report, Section, Table, difference, html, of_design};
use counterpoise_project::diagnose::Diagnosis;
use counterpoise_project::diagnose::answer::{Answer, Verdict};
use counterpoise_project::pipeline::{Consequence, Designed};
use counterpoise_project::pipeline::export::{project_hash, weights};
use counterpoise_project::results::{DesignResult, ReplayResult};
use counterpoise_project::simulate::recording::{Channel, Recording};
use counterpoise_project::simulate::replay::{Loop, Replay, replay as replayed};

use super::replay::Read;
use crate::files::Loaded;
use crate::output::StageTime;

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
    let mut more = vec![certificates(&result)];
    more.push(run.targets.clone());
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
    recordings: &[Recording],
    (found, consequence): (&Diagnosis, Option<&Consequence>),
    control: &Loop,
) -> String {
    let improved = found.improved != loaded.project.plant;
    let tracks = recordings.iter().flat_map(|recording| {
        let before = replayed(&loaded.project.plant, recording, control).ok();
        let after = improved.then(|| replayed(&found.improved, recording, control).ok()).flatten();
        before.map(|before| tracks(recording, &before, after.as_ref())).unwrap_or_default()
    });
    let command = format!("counterpoise diagnose {}", loaded.path.display());
    let mut page =
        report(&loaded.project.plant.name, &command, &found.answer, &tracks.collect::<Vec<_>>());
    page.sections.splice(1..1, consequence.map(difference::consequence));
    html(&page)
}

fn tracks(recording: &Recording, before: &Replay, after: Option<&Replay>) -> Vec<Track> {
    let drawn = [Channel::Control, Channel::HubRate, Channel::MotorRate, Channel::HubPosition];
    let track = |channel: Channel| {
        Some(Track {
            recording: short(&recording.name),
            channel: channel.name(),
            unit: unit(channel),
            period_s: recording.sample_period_s,
            measured: recording.column(channel)?.to_vec(),
            before: channel.of(&before.simulated).to_vec(),
            after: after.map(|replay| channel.of(&replay.simulated).to_vec()).unwrap_or_default(),
        })
    };
    drawn.into_iter().filter_map(track).collect()
}

fn short(path: &str) -> String {
    std::path::Path::new(path)
        .file_stem()
        .map_or_else(|| path.to_owned(), |s| s.to_string_lossy().into_owned())
}

fn unit(channel: Channel) -> &'static str {
    match channel {
        Channel::Control => "V",
        Channel::HubPosition => "rad",
        Channel::PlatformAccel => "m/s^2",
        Channel::HubRate | Channel::PlatformRate | Channel::MotorRate => "rad/s",
    }
}

/// The report of a replay: measured and simulated, without a search.
pub fn replay(loaded: &Loaded, read: &[Read], replays: &[Replay], result: &ReplayResult) -> String {
    let all = read.iter().zip(replays).flat_map(|(item, replay)| tracks(&item.recording, replay, None));
    let mut fit = std::collections::BTreeMap::new();
    for recording in &result.recordings {
        for (name, channel) in &recording.channels {
            let entry = fit.entry(*name).or_insert((0.0, 0.0, 0.0));
            *entry = (entry.0 + channel.rms_error.powi(2), entry.1 + channel.floor.powi(2), entry.2 + 1.0);
        }
    }
    let answer = Answer::of_replay(fit.into_iter().map(|(name, (e, f, n))| {
        let rms = |sum: f64| (sum / n).sqrt();
        (name, counterpoise_project::diagnose::answer::ChannelFit { rms_error: rms(e), floor: rms(f) })
    }));
    let command = format!("counterpoise replay {}", loaded.path.display());
    let mut page = report(&loaded.project.plant.name, &command, &answer, &all.collect::<Vec<_>>());
    page.title = format!("Replay of {}", loaded.project.plant.name);
    page.subtitle = "what the model does under what was recorded".to_owned();
    page.headline.text = match answer.verdict {
        Verdict::Consistent => "The model fits to within 1.5 times the floor".to_owned(),
        _ => "The model does not fit: the errors are above the floor".to_owned(),
    };
    page.sections.truncate(1);
    html(&page)
}
