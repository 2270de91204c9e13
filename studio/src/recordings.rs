//! Recordings in the studio: found, read as the project maps them, and laid beside what the model does.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use counterpoise_host::files::recording_files;
use counterpoise_host::worker::Token;
use counterpoise_models::Parameters;
use counterpoise_pipeline::recordings::read::{control_for, read_recording, tabulate, without_demand};
use counterpoise_pipeline::recordings::replay::replay_one;
use counterpoise_pipeline::recordings::{Gaps, ReadRecording, RecordingFile, ReplayLength};
use counterpoise_pipeline::results::RecordingResult;
use counterpoise_project::Project;
use counterpoise_recordings::{Channel, Recording, Table};
use counterpoise_report::wording::recordings::{
    describe_column_remark, describe_missing_demand, describe_recordings_error, describe_replay,
};
use counterpoise_simulate::replay::Replay;

use crate::pyramid::Pyramid;

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
    /// How well the project's model fits, as the command line prints it; `None` if it cannot be replayed.
    pub fit: Option<RecordingResult>,
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

/// Returns the recordings beside the model, or `None` if the job was cancelled.
pub fn look(ask: &LookAsk, token: &Token) -> Option<Looked> {
    let (files, mut all) = (recording_files(&ask.paths), Vec::new());
    for path in &files {
        match opened(ask, path) {
            Ok((table, recordings)) => {
                for recording in recordings {
                    if token.is_cancelled() {
                        return None;
                    }
                    all.extend(seen(ask, path, &table, recording));
                }
            }
            Err(why) => all.push(unread(path, why)),
        }
    }
    Some(Looked { files, seen: all })
}

fn opened(ask: &LookAsk, path: &Path) -> Result<(Table, Vec<Recording>), String> {
    let name = path.display().to_string();
    let bytes = std::fs::read(path).map_err(|error| format!("cannot read {name}: {error}"))?;
    tabulate(&ask.project, &RecordingFile { name, bytes }).map_err(|error| error.to_string())
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
        fit: None,
    }
}

/// Returns the parts of a recording that can be replayed, each beside the model, as the command line replays them.
fn seen(ask: &LookAsk, path: &Path, table: &Table, recording: Recording) -> Vec<Seen> {
    let blank = Seen {
        path: path.to_owned(),
        name: stem(Path::new(&recording.name)),
        columns: columns(table),
        remarks: Vec::new(),
        trouble: Vec::new(),
        tracks: Vec::new(),
        fit: None,
    };
    match read_recording(&ask.project, recording, Gaps::Repaired) {
        Ok(parts) => {
            let beside = |part: &ReadRecording| beside_model(ask, part, blank.clone());
            parts.iter().map(beside).collect()
        }
        Err(error) => vec![Seen { trouble: vec![describe_recordings_error(&error)], ..blank }],
    }
}

fn beside_model(ask: &LookAsk, item: &ReadRecording, blank: Seen) -> Seen {
    let control = control_for(&ask.project, [&item.recording]);
    let mut trouble = Vec::new();
    let mut run = |plant: &Parameters| match replay_one(plant, item, &control, ReplayLength::Automatic) {
        Ok(made) => Some(made),
        Err(error) => {
            trouble.push(describe_recordings_error(&error));
            None
        }
    };
    let model = run(&ask.project.plant);
    let improved = ask.improved.as_deref().and_then(run);
    let demand =
        describe_missing_demand(&without_demand(&ask.project, [(item.file.as_str(), &item.recording)]));
    let found = model.as_ref().map_or(&item.remarks, |made| &made.remarks);
    let replays = [&model, &improved].map(|made| made.as_ref().map(|made| &made.followed.replay));
    Seen {
        name: stem(Path::new(&item.file)),
        remarks: demand.into_iter().chain(found.iter().map(describe_column_remark)).collect(),
        trouble,
        tracks: tracks(&item.recording, replays),
        fit: model.as_ref().map(describe_replay),
        ..blank
    }
}

/// Returns every recorded channel with what the model and the improved model make of it.
fn tracks(recording: &Recording, [model, improved]: [Option<&Replay>; 2]) -> Vec<Track> {
    let period = recording.sample_period_s;
    let one = |(channel, measured): (Channel, &[f64])| {
        let floor_of =
            |replay: &Replay| replay.channels.iter().find(|fit| fit.channel == channel).map(|f| f.floor);
        let of = |replay: Option<&Replay>| {
            floor_of(replay?)?;
            Some(against(measured, replay?.simulated.channel(channel), period))
        };
        Track {
            channel: channel.name(),
            unit: channel.unit(),
            measured: Arc::new(Pyramid::new(timed(measured.iter().copied(), period))),
            model: of(model),
            improved: of(improved),
            floor: model.and_then(floor_of),
        }
    };
    recording.channels().map(one).collect()
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
