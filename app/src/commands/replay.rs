//! `counterpoise replay`: simulate what was recorded, and say how well it fits.

use anyhow::Error;
use counterpoise_host::projects;
use counterpoise_pipeline::recordings::read::{control_for, without_demand};
use counterpoise_pipeline::recordings::{Gaps, ReadRecording, ReplayLength, read, replay};
use counterpoise_pipeline::results::ReplayResult;
use counterpoise_project::{Project, Purpose};
use counterpoise_report::wording::recordings::{
    describe_missing_demand, describe_recordings_error, describe_replay,
};
use counterpoise_simulate::replay::Loop;

use super::{Done, verdict_code};
use crate::arguments::ReplayOptions;
use crate::output::{self, say};

/// Runs the command.
pub fn run(options: &ReplayOptions) -> Done {
    let open = options.open_loop || matches!(options.windows, ReplayLength::Windows { .. });
    let loaded = projects::load(&options.project, if open { Purpose::Model } else { Purpose::Replay })?;
    output::warnings(&loaded, options.results.quiet);
    let files = projects::recordings(&options.recordings)?;
    let read = read(&loaded.project, &files, Gaps::Repaired).map_err(refused)?;
    let control = if options.open_loop { Loop::Open } else { closed_loop(&loaded.project, &read) };
    let replayed = replay(&loaded.project, &read, &control, options.windows)?;
    let result = ReplayResult { recordings: replayed.iter().map(describe_replay).collect() };
    if let Some(path) = &options.report {
        let page = super::pages::replay(&loaded, &read, &replayed, &result);
        projects::write(path, page.as_bytes())?;
    }
    if !output::json(&options.results, &result)? {
        print(&result);
    }
    Ok(verdict_code(true))
}

/// Returns the loop in which the recordings are replayed; says so if the demand is missing.
fn closed_loop(project: &Project, read: &[ReadRecording]) -> Loop {
    let missing = without_demand(project, read.iter().map(|item| (item.file.as_str(), &item.recording)));
    if let Some(remark) = describe_missing_demand(&missing) {
        eprintln!("note: {remark}");
    }
    control_for(project, read.iter().map(|item| &item.recording))
}

fn refused(error: counterpoise_pipeline::PipelineError) -> Error {
    Error::msg(describe_recordings_error(&error))
}

fn print(result: &ReplayResult) {
    for recording in &result.recordings {
        say!("{}", recording.file);
        say!("  followed {}", recording.way());
        recording.remarks.iter().for_each(|remark| say!("  {remark}"));
        say!("  {:<16} {:>12} {:>12} {:>8} {:>10}", "channel", "RMS error", "floor", "ratio", "VAF %");
        for (name, c) in &recording.channels {
            let ratio = c.rms_error / c.floor;
            say!("  {name:<16} {:12.4e} {:12.4e} {ratio:8.2} {:10.4}", c.rms_error, c.floor, c.vaf);
        }
    }
}
