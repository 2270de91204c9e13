//! `counterpoise replay`: simulate what was recorded, and say how well it fits.

use crate::output::say;
use anyhow::{Context, Result, bail};
use counterpoise_diagnose::recording::gap_repair::repair_gaps;
use counterpoise_diagnose::recording::measured_signals::measured;
use counterpoise_diagnose::recording::sanity_checks::{check_control, check_signals};
use counterpoise_models::Parameters;
use counterpoise_pipeline::results::{RecordingResult, ReplayResult};
use counterpoise_project::Purpose;
use counterpoise_project::recording::{Mapping, Record, Table};
use counterpoise_report::wording::recordings::{
    describe_anomaly, describe_control_mismatch, describe_repair,
};
use counterpoise_simulate::recording::{Channel, Recording};
use counterpoise_simulate::replay::{Followed, Loop, Replayer, Way};

use super::{Done, verdict_code};
use crate::arguments::{ReplayOptions, Windows};
use crate::output;
use counterpoise_host::projects::{self, Loaded};

/// A recording read, with what was found on the way.
pub struct Read {
    /// Name of the file.
    pub file: String,
    /// The recording.
    pub recording: Recording,
    /// What was found.
    pub remarks: Vec<String>,
    /// Whether demand, control and hub rate are the samples that were written.
    pub kept: bool,
}

/// Reads recordings as the project maps them, their holes mended.
pub fn read(loaded: &Loaded, paths: &[std::path::PathBuf]) -> Result<Vec<Read>> {
    let mut out = Vec::new();
    for record in &records(loaded, paths)? {
        let kept = loaded.project.recording.keeps_samples(record);
        out.extend(Read::of(record, kept, loaded.project.plant.gearbox.ratio)?);
    }
    out.iter_mut().for_each(|item| item.hear(loaded));
    Ok(out)
}

/// Reads recordings as the project maps them, with their holes and faults as they were written.
pub fn read_as_written(loaded: &Loaded, paths: &[std::path::PathBuf]) -> Result<Vec<Read>> {
    let one = |record: &Record| Read {
        file: record.name.clone(),
        recording: record.recording(),
        remarks: record.findings.iter().map(ToString::to_string).collect(),
        kept: loaded.project.recording.keeps_samples(record),
    };
    let mut out: Vec<Read> = records(loaded, paths)?.iter().map(one).collect();
    out.iter_mut().for_each(|item| item.hear(loaded));
    Ok(out)
}

fn records(loaded: &Loaded, paths: &[std::path::PathBuf]) -> Result<Vec<Record>> {
    let clock = loaded.project.recording.sample_period_s;
    let mapping = Mapping {
        sample_period_s: clock.or(Some(loaded.project.plant.interface.sample_period_s)),
        ..loaded.project.recording.clone()
    };
    let mut out = Vec::new();
    for (file, bytes) in projects::recordings(paths)? {
        out.extend(mapping.records(&Table::read(&bytes, &file)?)?);
    }
    Ok(out)
}

impl Read {
    /// The parts of a record that can be replayed; what was found stands with the first.
    fn of(record: &Record, kept: bool, ratio: f64) -> Result<Vec<Self>> {
        let repaired = repair_gaps(&record.recording(), ratio);
        let done = repaired
            .repairs
            .iter()
            .map(|(channel, repair)| format!("{channel}: {}", describe_repair(repair)));
        let mut remarks: Vec<String> = record.findings.iter().map(ToString::to_string).chain(done).collect();
        if repaired.parts.is_empty() {
            bail!("nothing of {} can be replayed: {}", record.name, remarks.join("; "));
        }
        let part = |recording: Recording| Self {
            file: recording.name.clone(),
            recording,
            remarks: std::mem::take(&mut remarks),
            kept,
        };
        Ok(repaired.parts.into_iter().map(part).collect())
    }

    /// Says first where the control is not what the project's controller makes of what it read.
    fn hear(&mut self, loaded: &Loaded) {
        let Some(controller) = loaded.project.recording_controller.as_ref().filter(|_| self.kept) else {
            return;
        };
        let foreign = check_control(&loaded.project.plant, &self.recording, &Loop::from(controller));
        self.remarks.splice(
            0..0,
            foreign.map(|mismatch| format!("control: {}", describe_control_mismatch(&mismatch))),
        );
    }
}

/// Runs the command.
pub fn run(options: &ReplayOptions) -> Done {
    let open = options.open_loop || matches!(options.windows, Windows::Every { .. });
    let loaded = projects::load(&options.project, if open { Purpose::Model } else { Purpose::Replay })?;
    output::warnings(&loaded, options.results.quiet);
    let control = match (&loaded.project.recording_controller, options.open_loop) {
        (Some(controller), false) => Loop::Closed(controller.clone()),
        _ => Loop::Open,
    };
    let read = read(&loaded, &options.recordings)?;
    let mut result = ReplayResult { recordings: Vec::new() };
    let mut replays = Vec::new();
    for item in &read {
        let plant = &loaded.project.plant;
        let followed =
            Replayer::new(plant, &item.recording).and_then(|r| follow(&r, plant, &control, options.windows));
        let mut followed = followed.with_context(|| format!("cannot replay {}", item.file))?;
        if followed.way != Way::Free && !item.kept {
            // made from other columns, the measurements are not those that the controller read
            followed.replay.channels.retain(|fit| fit.channel != Channel::Control);
        }
        let remarks = item.remarks.iter().cloned().chain(faults(&loaded, &item.recording)).collect();
        result.recordings.push(RecordingResult::new(&item.file, &followed, remarks));
        replays.push(followed.replay);
    }
    if let Some(path) = &options.report {
        let page = super::pages::replay(&loaded, &read, &replays, &result);
        projects::write(path, page.as_bytes())?;
    }
    if !output::json(&options.results, &result)? {
        print(&result);
    }
    Ok(verdict_code(true))
}

/// Follows a recording as it was asked for.
fn follow(
    replayer: &Replayer,
    plant: &Parameters,
    control: &Loop,
    windows: Windows,
) -> Result<Followed, counterpoise_simulate::Error> {
    let (replay, way) = match (windows, control) {
        (Windows::Auto, _) => return replayer.follow(plant, control),
        (Windows::None, Loop::Open) => (replayer.replay_open(plant)?, Way::Free),
        (Windows::None, _) => (replayer.replay(plant, control)?, Way::Free),
        (Windows::Every { window_s }, Loop::Open) => {
            (replayer.replay_windows(plant, window_s)?, Way::Windows { window_s, free: Vec::new() })
        }
        (Windows::Every { window_s }, Loop::Closed(controller)) => {
            let replay = replayer.replay_horizons(plant, window_s, controller)?;
            (replay, Way::Windows { window_s, free: Vec::new() })
        }
    };
    Ok(Followed { replay, way, parting: None })
}

/// What is wrong with a recording itself: told before the fit is.
fn faults(loaded: &Loaded, recording: &Recording) -> Vec<String> {
    let ratio = loaded.project.plant.gearbox.ratio;
    let remarks = measured(recording).map(|m| check_signals(&recording.name, &m, ratio)).unwrap_or_default();
    remarks.into_iter().map(|r| format!("{}: {}", r.channel, describe_anomaly(&r.anomaly))).collect()
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
