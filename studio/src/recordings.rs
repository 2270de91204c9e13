//! Recordings in the studio: found, read as the project maps them, and laid beside what the model does.

use counterpoise_report::wording::recordings::describe_anomaly;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use counterpoise_diagnose::recording::measured_signals::measured;
use counterpoise_diagnose::recording::sanity_checks::check_signals;
use counterpoise_models::Parameters;
use counterpoise_project::Project;
use counterpoise_project::recording::{self, Mapping, Record, Table};
use counterpoise_simulate::recording::{Channel, Recording};
use counterpoise_simulate::replay::{Loop, Replay, replay};

use counterpoise_host::files::recording_files;

use crate::pyramid::Pyramid;
use counterpoise_host::worker::Token;

/// What is asked: the recordings beside a project's model.
#[derive(Debug, Clone)]
pub struct LookAsk {
    /// The project.
    pub project: Arc<Project>,
    /// Files and folders.
    pub paths: Vec<PathBuf>,
    /// The mechanism of a diagnosis, where there is one.
    pub improved: Option<Arc<Parameters>>,
}

/// Recordings beside the model.
#[derive(Debug, Clone)]
pub struct Looked {
    /// The files, those of folders among them.
    pub files: Vec<PathBuf>,
    /// What is in them.
    pub seen: Vec<Seen>,
}

/// A recording beside the model; one file may hold several.
#[derive(Debug, Clone)]
pub struct Seen {
    /// The file.
    pub path: PathBuf,
    /// What it is called.
    pub name: String,
    /// Columns of the file with their units.
    pub columns: Vec<(String, Option<String>)>,
    /// What its reader should know.
    pub remarks: Vec<String>,
    /// Why it cannot be read or replayed.
    pub trouble: Vec<String>,
    /// Channels.
    pub tracks: Vec<Track>,
}

/// A channel, measured and simulated.
#[derive(Debug, Clone)]
pub struct Track {
    /// Its name in the project file.
    pub channel: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// As recorded.
    pub measured: Arc<Pyramid>,
    /// The model of the project; none for a channel that is given to it.
    pub model: Option<Simulated>,
    /// The model with the diagnosis.
    pub improved: Option<Simulated>,
    /// RMS error that a perfect model would leave.
    pub floor: Option<f64>,
}

/// What a model makes of a channel.
#[derive(Debug, Clone)]
pub struct Simulated {
    /// The channel.
    pub signal: Arc<Pyramid>,
    /// Simulated less measured.
    pub error: Arc<Pyramid>,
    /// RMS of that.
    pub rms: f64,
}

/// Reads a file as the project maps it; one that has no clock takes the interface's.
///
/// # Errors
/// What is wrong with it, in words.
pub fn read(project: &Project, path: &Path) -> Result<(Table, Vec<Record>), String> {
    let name = path.display().to_string();
    let bytes = std::fs::read(path).map_err(|error| format!("cannot read {name}: {error}"))?;
    let table = Table::read(&bytes, &name).map_err(|error| error.to_string())?;
    let clock = project.recording.sample_period_s.or(Some(project.plant.interface.sample_period_s));
    let mapping = Mapping { sample_period_s: clock, ..project.recording.clone() };
    let records = mapping.records(&table).map_err(|error| error.to_string())?;
    Ok((table, records))
}

/// The recordings beside the model; None where it was stopped.
pub fn look(ask: &LookAsk, token: &Token) -> Option<Looked> {
    let (files, mut all) = (recording_files(&ask.paths), Vec::new());
    for path in &files {
        match read(&ask.project, path) {
            Ok((table, records)) => {
                for record in &records {
                    if token.is_cancelled() {
                        return None;
                    }
                    all.push(seen(ask, path, &table, record));
                }
            }
            Err(why) => all.push(unread(path, why)),
        }
    }
    Some(Looked { files, seen: all })
}

fn stem(path: &Path) -> String {
    path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned())
}

fn columns(table: &Table) -> Vec<(String, Option<String>)> {
    table.columns.iter().map(|column| (column.name.clone(), column.unit.clone())).collect()
}

/// A file that could not be read as it is mapped: its columns are shown where it has some, so that the mapping can be mended.
fn unread(path: &Path, why: String) -> Seen {
    let table = std::fs::read(path).ok().and_then(|bytes| Table::read(&bytes, &stem(path)).ok());
    Seen {
        path: path.to_owned(),
        name: stem(path),
        columns: table.as_ref().map(columns).unwrap_or_default(),
        remarks: Vec::new(),
        trouble: vec![why],
        tracks: Vec::new(),
    }
}

fn seen(ask: &LookAsk, path: &Path, table: &Table, record: &Record) -> Seen {
    let recording = record.recording();
    let control = ask.project.recording_controller.as_ref().map_or(Loop::Open, Loop::from);
    let mut trouble = Vec::new();
    let mut run = |plant: &Parameters| match replay(plant, &recording, &control) {
        Ok(made) => Some(made),
        Err(error) => {
            trouble.push(format!("it cannot be replayed: {error}"));
            None
        }
    };
    let model = run(&ask.project.plant);
    let improved = ask.improved.as_deref().and_then(run);
    let ratio = ask.project.plant.gearbox.ratio;
    let faults = measured(&recording).map(|m| check_signals(&recording.name, &m, ratio)).unwrap_or_default();
    let remarks = record.findings.iter().map(ToString::to_string);
    Seen {
        path: path.to_owned(),
        name: stem(Path::new(&record.name)),
        columns: columns(table),
        remarks: remarks
            .chain(faults.iter().map(|r| format!("{}: {}", r.channel, describe_anomaly(&r.anomaly))))
            .collect(),
        trouble,
        tracks: tracks(record, &recording, (model.as_ref(), improved.as_ref())),
    }
}

fn tracks(record: &Record, recording: &Recording, replays: (Option<&Replay>, Option<&Replay>)) -> Vec<Track> {
    let period = record.sample_period_s;
    let one = |(channel, values): &(recording::Channel, Vec<f64>)| {
        let simulated = Channel::ALL.into_iter().find(|c| c.name() == channel.name());
        let of = |replay: Option<&Replay>| {
            let (channel, replay) = (simulated?, replay?);
            replay.channels.iter().find(|fit| fit.channel == channel)?;
            Some(against(values, channel.of(&replay.simulated), period))
        };
        let fit = replays.0.and_then(|r| r.channels.iter().find(|fit| Some(fit.channel) == simulated));
        Track {
            channel: channel.name(),
            unit: channel.unit(),
            measured: Arc::new(Pyramid::new(timed(values.iter().copied(), period))),
            model: of(replays.0),
            improved: of(replays.1),
            floor: fit.map(|fit| fit.floor),
        }
    };
    debug_assert!(recording.sample_period_s == period);
    record.channels.iter().map(one).collect()
}

fn timed(values: impl Iterator<Item = f64>, period: f64) -> Vec<[f64; 2]> {
    values.enumerate().map(|(k, v)| [k as f64 * period, v]).collect()
}

fn against(measured: &[f64], simulated: &[f64], period: f64) -> Simulated {
    let error: Vec<f64> = simulated.iter().zip(measured).map(|(s, m)| s - m).collect();
    let (sum, count) = error
        .iter()
        .filter(|e| e.is_finite())
        .fold((0.0, 0_usize), |(sum, count), e| (sum + e * e, count + 1));
    Simulated {
        signal: Arc::new(Pyramid::new(timed(simulated.iter().copied(), period))),
        error: Arc::new(Pyramid::new(timed(error.iter().copied(), period))),
        rms: (sum / count.max(1) as f64).sqrt(),
    }
}
