//! `counterpoise replay`: simulate what was recorded, and say how well it fits.

use anyhow::Error;
use clap::Args;
use counterpoise_host::large_recordings::{
    BySize, LargeRecording, READ_AT_ONCE, ROWS_OF_A_PART, split_by_size,
};
use counterpoise_host::projects::{self, ProjectOnDisk};
use counterpoise_host::terminal::print_message;
use counterpoise_host::workers::{QuietPool, try_map_stream};
use counterpoise_pipeline::PipelineError;
use counterpoise_pipeline::exchange::{RunHistory, WithHistories};
use counterpoise_pipeline::recordings::controller_origin::other_export;
use counterpoise_pipeline::recordings::tracks::ChannelTrack;
use counterpoise_pipeline::recordings::{ProjectReplayer, ReplayControl, ReplayLength, ReplaySettings};
use counterpoise_pipeline::results::{RecordingResult, ReplayResult};
use counterpoise_pool::Pool;
use counterpoise_project::Purpose;
use counterpoise_report::terminal::replay::replay_lines;
use counterpoise_report::wording::recordings::{
    describe_other_export, describe_played_back, describe_recordings_error, describe_replay,
};
use indicatif::ProgressBar;
use std::path::{Path, PathBuf};

use crate::exit::{CommandResult, ExitStatus};
use crate::options::{CommandOutputs, WRITTEN};
use crate::output;

/// Arguments of `replay`.
#[derive(Args)]
pub struct ReplayOptions {
    /// Project file, or a folder with a project.toml
    pub project: PathBuf,
    /// Recordings of one machine: CSV, Parquet, MATLAB, HDF5 or NumPy files, or folders of them
    #[arg(required = true)]
    pub recordings: Vec<PathBuf>,
    /// Drive the plant with the recorded control instead of the recording's controller
    #[arg(long)]
    pub open_loop: bool,
    /// Length of the windows over which the model follows the recording, under the recorded control and each from a fitted state:
    /// SECONDS; `none` follows it from start to end; `auto` uses half a second, or a half or a quarter of that, if the machine hunts, otherwise `none`
    #[arg(long, value_name = "auto|none|SECONDS", default_value = "auto", value_parser = windows)]
    pub windows: ReplayLength,
    /// With --json or --data: also what was recorded beside what the model gives, from which the errors can be recomputed
    #[arg(long, requires = WRITTEN)]
    pub histories: bool,
    /// The destinations of report and results.
    #[command(flatten)]
    pub outputs: CommandOutputs,
}

/// Returns channels of recordings beside what models simulate as plain data.
pub(super) fn track_histories<'t>(tracks: impl IntoIterator<Item = &'t ChannelTrack>) -> Vec<RunHistory> {
    tracks.into_iter().map(ChannelTrack::history).collect()
}

/// `auto`, `none` or a length in seconds.
fn windows(text: &str) -> Result<ReplayLength, String> {
    match text {
        "auto" => Ok(ReplayLength::Automatic),
        "none" => Ok(ReplayLength::Whole),
        _ => match text.parse::<f64>() {
            Ok(window_s) if window_s > 0.0 && window_s.is_finite() => Ok(ReplayLength::Windows { window_s }),
            _ => Err("must be `auto`, `none` or a length in seconds, such as 0.5".to_owned()),
        },
    }
}

/// Runs the command.
pub fn run(options: &ReplayOptions) -> CommandResult {
    let open = options.open_loop || matches!(options.windows, ReplayLength::Windows { .. });
    let loaded =
        projects::load_project(&options.project, if open { Purpose::Model } else { Purpose::Replay })?;
    output::print_warnings(&loaded, options.outputs.results.progress());
    if !options.open_loop {
        tell_other_export(&loaded);
    }
    let BySize { whole, in_parts } = split_by_size(&options.recordings, READ_AT_ONCE);
    let files = if whole.is_empty() { Vec::new() } else { projects::read_recordings(&whole)? };
    let control =
        if options.open_loop { ReplayControl::RecordedControl } else { ReplayControl::RecordingController };
    let settings = ReplaySettings { control, length: options.windows };
    let replayer = ProjectReplayer::new(&loaded.project, settings).map_err(recordings_error)?;
    let read = replayer.read_files(&files).map_err(recordings_error)?;
    tell_missing_demand(&replayer.without_demand(&read));
    let replayed = replayer.replay(&read).map_err(recordings_error)?;
    let mut result = ReplayResult { recordings: replayed.iter().map(describe_replay).collect() };
    for path in &in_parts {
        result.recordings.extend(replay_in_parts(&replayer, path, options)?);
    }
    let shown = result.label_channels(&loaded.project.plant);
    if let Some(path) = &options.outputs.report {
        let command = format!("counterpoise replay {}", loaded.path.display());
        let title = format!("Replay of {}", loaded.project.plant.name);
        let page = counterpoise_report::replay::replay_report(&title, &command, &shown, &replayed);
        output::write_report(path, &options.outputs.results, &page)?;
    }
    output::write_tracks(&options.outputs.results, replayed.iter().flat_map(|one| &one.tracks))?;
    let histories = if options.histories {
        track_histories(replayed.iter().flat_map(|one| &one.tracks))
    } else {
        Vec::new()
    };
    if !output::write_result(&options.outputs.results, &WithHistories { result: &result, histories })? {
        output::print_lines(&replay_lines(&shown));
    }
    Ok(ExitStatus::SUCCESS)
}

/// Most parts in memory at once, a hundred megabytes each.
const PARTS_AT_ONCE: usize = 8;

/// Replays a recording that is too large to be read at once: as many parts at a time as there are processors, of which the figures
/// alone are kept. Every part starts from states of its own, as the parts of a recording with gaps do.
fn replay_in_parts(
    replayer: &ProjectReplayer,
    path: &Path,
    options: &ReplayOptions,
) -> anyhow::Result<Vec<RecordingResult>> {
    if options.outputs.report.is_some() {
        let shown = path.display();
        print_message(&format!(
            "note: {shown} is replayed in parts: its figures are printed, and not drawn in the report"
        ));
    }
    let bar = if options.outputs.results.quiet { ProgressBar::hidden() } else { ProgressBar::new(0) };
    let parts = LargeRecording::open(path, ROWS_OF_A_PART, bar)?;
    let one = |table| -> anyhow::Result<Vec<RecordingResult>> {
        let replayed = replayer.replay_table(table).map_err(recordings_error)?;
        Ok(replayed.iter().map(describe_replay).collect())
    };
    // While one processor reads the next part, the others replay those before it.
    let processors = QuietPool.processors().min(PARTS_AT_ONCE);
    let done = try_map_stream(processors, parts, |table| one(table?))?;
    Ok(done.into_iter().flatten().collect())
}

/// Says so if the controller of the recordings was exported from another state of the project.
pub(super) fn tell_other_export(loaded: &ProjectOnDisk) {
    if let Some(other) = other_export(&loaded.project, &loaded.project_folder()) {
        print_message(&format!("note: {}", describe_other_export(&other)));
    }
}

/// Says which recordings are replayed under their recorded control because the demand is missing.
fn tell_missing_demand(missing: &[String]) {
    if let Some(remark) = describe_played_back(missing) {
        print_message(&format!("note: {remark}"));
    }
}

fn recordings_error(error: PipelineError) -> Error {
    Error::msg(describe_recordings_error(&error))
}
