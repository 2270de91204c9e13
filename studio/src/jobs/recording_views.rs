//! Recordings read as the project maps them, and replayed on the model, as the command line does it.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use counterpoise_host::files::{self, ProjectFolder, recording_files};
use counterpoise_host::worker::CancelToken;
use counterpoise_models::Parameters;
use counterpoise_pipeline::recordings::amplitude_density::AmplitudeDensity;
use counterpoise_pipeline::recordings::controller_origin::other_export;
use counterpoise_pipeline::recordings::read::read_table_and_recordings;
use counterpoise_pipeline::recordings::tracks::{SimulatedChannel, simulate_channel};
use counterpoise_pipeline::recordings::{
    ProjectReplayer, ReadRecording, RecordingFile, ReplaySettings, ReplayedRecording,
};
use counterpoise_pipeline::results::RecordingResult;
use counterpoise_pipeline::{PipelineError, with_recorded_design};
use counterpoise_project::Project;
use counterpoise_recordings::{Channel, Recording, RecordingTable};
use counterpoise_report::wording::recordings::{
    describe_column_remark, describe_other_export, describe_played_back, describe_recordings_error,
    describe_replay,
};
use counterpoise_simulate::replay::Replay;

use crate::charts::min_max_pyramid::MinMaxPyramid;
use crate::editing::session::file_name;

/// The recordings to replay on a project's model.
#[derive(Debug, Clone)]
pub struct ReplayRequest {
    /// The project.
    pub project: Arc<Project>,
    /// The folder of the project's file.
    pub folder: PathBuf,
    /// Files and folders.
    pub paths: Vec<PathBuf>,
    /// The mechanism of a diagnosis, if there is one.
    pub improved: Option<Arc<Parameters>>,
}

/// Recordings with their replays.
#[derive(Debug, Clone)]
pub struct ReplayedFiles {
    /// The files, those of folders among them.
    pub files: Vec<PathBuf>,
    /// The recordings in them.
    pub views: Vec<RecordingView>,
}

/// A column of a recording's file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ColumnName {
    /// Name.
    pub name: String,
    /// Unit, if the file states one.
    pub unit: Option<String>,
}

/// A recording beside the model; one file may hold several.
#[derive(Debug, Clone)]
pub struct RecordingView {
    /// The file.
    pub path: PathBuf,
    /// The name of the recording.
    pub name: String,
    /// The columns of the file.
    pub columns: Vec<ColumnName>,
    /// Remarks on the recording for the user.
    pub remarks: Vec<String>,
    /// Why the recording cannot be read or replayed.
    pub errors: Vec<String>,
    /// Channels.
    pub channels: Vec<ChannelView>,
    /// Fit of the project's model, as the command line prints it; `None` if the recording cannot be replayed.
    pub fit: Option<RecordingResult>,
}

/// A channel, measured and simulated.
#[derive(Debug, Clone)]
pub struct ChannelView {
    /// The channel.
    pub channel: Channel,
    /// The recorded samples.
    pub measured: Arc<MinMaxPyramid>,
    /// Simulation by the project's model; `None` for an input of the model.
    pub model: Option<SimulatedView>,
    /// Simulation by the diagnosed model.
    pub improved: Option<SimulatedView>,
    /// Amplitude spectral density of the recorded samples; `None` if they are too few or do not move.
    pub density: Option<AmplitudeDensity>,
}

/// Simulation of a channel by a model.
#[derive(Debug, Clone)]
pub struct SimulatedView {
    /// The simulated samples.
    pub signal: Arc<MinMaxPyramid>,
    /// The residual, measured minus simulated.
    pub residual: Arc<MinMaxPyramid>,
    /// RMS of the residual over the noise floor of the project's model, if that simulates the channel.
    pub residual_over_floor: Option<f64>,
    /// Amplitude spectral density of the residual.
    pub residual_density: Option<AmplitudeDensity>,
}

/// Returns the recordings with their replays, or `None` if the job was cancelled.
pub fn replay_files(request: &ReplayRequest, token: &CancelToken) -> Option<ReplayedFiles> {
    let (files, mut views) = (recording_files(&request.paths), Vec::new());
    let decided = with_recorded_design(&request.project, &ProjectFolder(request.folder.clone()));
    let decided = decided.map(|own| own.unwrap_or_else(|| (*request.project).clone()));
    let replayer = decided.as_ref().map_err(describe_recordings_error).and_then(|project| {
        ProjectReplayer::new(project, ReplaySettings::default())
            .map_err(|error| describe_recordings_error(&error))
    });
    let note = other_export(&request.project, &ProjectFolder(request.folder.clone()));
    let note = note.as_ref().map(describe_other_export);
    for path in &files {
        match read_table(request, path) {
            Ok((table, recordings)) => {
                for recording in recordings {
                    if token.is_cancelled() {
                        return None;
                    }
                    views.extend(recording_views(
                        request,
                        &replayer,
                        FileRecording { path, table: &table, recording },
                    ));
                }
            }
            Err(why) => views.push(unreadable_view(path, why)),
        }
    }
    for view in views.iter_mut().filter(|view| view.fit.is_some()) {
        view.remarks.splice(0..0, note.clone());
    }
    Some(ReplayedFiles { files, views })
}

fn read_table(request: &ReplayRequest, path: &Path) -> Result<(RecordingTable, Vec<Recording>), String> {
    let name = path.display().to_string();
    let bytes = files::read_file(path).map_err(|error| format!("cannot read {name}: {error}"))?;
    read_table_and_recordings(&request.project, &RecordingFile { name, bytes })
        .map_err(|error| error.to_string())
}

fn column_names(table: &RecordingTable) -> Vec<ColumnName> {
    let name = |column: &counterpoise_recordings::RecordingColumn| ColumnName {
        name: column.name.clone(),
        unit: column.unit.clone(),
    };
    table.columns.iter().map(name).collect()
}

/// Returns a view of a file that cannot be read as it is mapped. It shows the columns if there are any, so that the mapping can be
/// corrected.
fn unreadable_view(path: &Path, why: String) -> RecordingView {
    let table =
        files::read_file(path).ok().and_then(|bytes| RecordingTable::read(&bytes, &file_name(path)).ok());
    RecordingView {
        path: path.to_owned(),
        name: file_name(path),
        columns: table.as_ref().map(column_names).unwrap_or_default(),
        remarks: Vec::new(),
        errors: vec![why],
        channels: Vec::new(),
        fit: None,
    }
}

/// A recording as its file holds it.
struct FileRecording<'a> {
    path: &'a Path,
    table: &'a RecordingTable,
    recording: Recording,
}

/// Returns the parts of a recording that can be replayed, each with its replay.
fn recording_views(
    request: &ReplayRequest,
    replayer: &Result<ProjectReplayer, String>,
    FileRecording { path, table, recording }: FileRecording,
) -> Vec<RecordingView> {
    let blank = RecordingView {
        path: path.to_owned(),
        name: file_name(Path::new(&recording.name)),
        columns: column_names(table),
        remarks: Vec::new(),
        errors: Vec::new(),
        channels: Vec::new(),
        fit: None,
    };
    let refused = |error: String| vec![RecordingView { errors: vec![error], ..blank.clone() }];
    let replayer = match replayer {
        Ok(replayer) => replayer,
        Err(error) => return refused(error.clone()),
    };
    match replayer.read_recording(recording) {
        Ok(parts) => parts.iter().map(|part| replayed_view(request, replayer, part, blank.clone())).collect(),
        Err(error) => refused(describe_recordings_error(&error)),
    }
}

fn replayed_view(
    request: &ReplayRequest,
    replayer: &ProjectReplayer,
    item: &ReadRecording,
    blank: RecordingView,
) -> RecordingView {
    let mut errors = Vec::new();
    let mut kept = |made: Result<ReplayedRecording, PipelineError>| {
        made.map_err(|error| errors.push(describe_recordings_error(&error))).ok()
    };
    let modelled = replayer.replay(std::slice::from_ref(item));
    let model = kept(modelled.map(|mut made| made.remove(0)));
    let improved = request.improved.as_deref();
    let improved = improved.and_then(|plant| kept(replayer.replay_on(plant, item)));
    let demand = describe_played_back(&replayer.without_demand([item]));
    let found = model.as_ref().map_or(&item.remarks, |made| &made.remarks);
    let replays = [&model, &improved].map(|made| made.as_ref().map(|made| &made.followed.replay));
    RecordingView {
        name: file_name(Path::new(&item.file)),
        remarks: demand.into_iter().chain(found.iter().map(describe_column_remark)).collect(),
        errors,
        channels: channel_views(&item.recording, replays),
        fit: model.as_ref().map(describe_replay),
        ..blank
    }
}

/// Returns every recorded channel with what the model and the improved model make of it.
fn channel_views(recording: &Recording, replays: [Option<&Replay>; 2]) -> Vec<ChannelView> {
    let period = recording.sample_period_s;
    let pyramid = |values: &[f64]| Arc::new(MinMaxPyramid::new(over_time(values, period)));
    let view = |found: SimulatedChannel| SimulatedView {
        signal: pyramid(&found.signal),
        residual: pyramid(&found.residual),
        residual_density: AmplitudeDensity::of(&found.residual, period),
        residual_over_floor: found.residual_over_floor,
    };
    let one = |(channel, measured): (Channel, &[f64])| {
        let [model, improved] = simulate_channel(recording, channel, replays).map(|found| found.map(view));
        let density = AmplitudeDensity::of(measured, period);
        ChannelView { channel, measured: pyramid(measured), model, improved, density }
    };
    recording.channels().map(one).collect()
}

fn over_time(values: &[f64], period_s: f64) -> Vec<[f64; 2]> {
    values.iter().enumerate().map(|(k, v)| [k as f64 * period_s, *v]).collect()
}
