//! Machine programs: the folder of a run, the program that is started with it, and what it leaves there.
//!
//! `docs/reference/machine.md` is the protocol.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};
use counterpoise_export::File;
use counterpoise_pipeline::commission::{PlannedRun, RunRequest};
use counterpoise_pipeline::recordings::RecordingFile;
use counterpoise_recordings::{Channel, Mapping, Recording, RecordingTable};
use serde::{Deserialize, Serialize};

use crate::files;
use crate::json::json_text;
use crate::tolerance::{READING_MARGIN, SAMPLES_BEYOND};

/// Version of the protocol.
const PROTOCOL: u32 = 1;
/// Names of the files of a run.
const REQUEST: &str = "request.json";
const DEMAND: &str = "demand.csv";
const MOTION: &str = "motion.csv";
const PREDICTED: &str = "predicted.csv";
const RECORDING: &str = "recording.csv";
const ANSWER: &str = "answer.json";

/// Limits of a run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct RunLimits {
    /// Largest angle from the start, rad.
    pub angle_rad: f64,
    /// Largest rate, rad/s.
    pub rate_rad_s: f64,
    /// Largest current, A; `None` for no limit.
    pub current_a: Option<f64>,
}

/// The request to a machine program, as `request.json` holds it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MachineRequest {
    /// Version of the protocol.
    pub protocol: u32,
    /// Number of the round.
    pub round: usize,
    /// Name of the run.
    pub run: String,
    /// Sample period, s.
    pub sample_period_s: f64,
    /// Number of samples.
    pub samples: usize,
    /// Hub angle at the start, rad.
    pub start_angle_rad: f64,
    /// Limits of the run.
    pub limits: RunLimits,
    /// Hash of the controller that must run.
    pub controller_hash: String,
    /// Columns that the model records.
    pub columns: Vec<String>,
}

/// The answer of a machine program, as `answer.json` holds it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MachineAnswer {
    /// Version of the protocol.
    pub protocol: u32,
    /// Hash of the controller that ran.
    pub controller_hash: String,
    /// The end of the run.
    pub ended: RunEnd,
    /// Why, if it did not come to its end.
    #[serde(default)]
    pub reason: String,
}

/// The end of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum RunEnd {
    /// At its last sample.
    Complete,
    /// The machine stopped before.
    Aborted,
}

/// Writes what a machine program finds in the folder of a run.
///
/// # Errors
/// A file that cannot be written.
pub fn write_request(folder: &Path, request: &MachineRequest, run: &PlannedRun) -> Result<()> {
    let asked = &run.request;
    let text = |columns: &[TextColumn<'_>]| columns_text(asked.sample_period_s, columns, ALL_DIGITS);
    let demand = text(&[TextColumn::new("demand", &asked.demand)]);
    let mut texts = vec![
        File { name: DEMAND.to_owned(), text: demand },
        File { name: PREDICTED.to_owned(), text: predicted_text(run) },
    ];
    if asked.moves_base() {
        let motion = text(&[
            TextColumn::new("platform_rate", &asked.platform_rate_rad_s),
            TextColumn::new("platform_accel", &asked.platform_accel_m_s2),
        ]);
        texts.push(File { name: MOTION.to_owned(), text: motion });
    }
    // The request stands last: a folder with one is whole.
    texts.push(File { name: REQUEST.to_owned(), text: json_text(request)? });
    for file in texts {
        let path = folder.join(&file.name);
        files::write_file(&path, file.text.as_bytes())
            .with_context(|| format!("cannot write {}", path.display()))?;
    }
    Ok(())
}

/// Returns a request of this version of the protocol.
pub fn request_of(
    run: &PlannedRun,
    round: usize,
    limits: RunLimits,
    controller_hash: &str,
) -> MachineRequest {
    MachineRequest {
        protocol: PROTOCOL,
        round,
        run: run.name.to_owned(),
        sample_period_s: run.request.sample_period_s,
        samples: run.request.demand.len(),
        start_angle_rad: run.request.start_angle_rad,
        limits,
        controller_hash: controller_hash.to_owned(),
        columns: run.predicted.iter().map(|channel| channel.channel.name().to_owned()).collect(),
    }
}

/// A column of a text.
struct TextColumn<'a> {
    name: String,
    values: &'a [f64],
}

impl<'a> TextColumn<'a> {
    fn new(name: impl Into<String>, values: &'a [f64]) -> Self {
        Self { name: name.into(), values }
    }
}

/// Returns columns on one clock as CSV, with as many digits behind the point as are asked for.
fn columns_text(sample_period_s: f64, columns: &[TextColumn<'_>], digits: usize) -> String {
    let names: Vec<&str> = columns.iter().map(|column| column.name.as_str()).collect();
    let mut text = format!("time [s],{}\n", names.join(","));
    for k in 0..columns.first().map_or(0, |first| first.values.len()) {
        let _ = write!(text, "{:.9e}", k as f64 * sample_period_s);
        for column in columns {
            let _ = write!(text, ",{:.digits$e}", column.values.get(k).copied().unwrap_or(f64::NAN));
        }
        text.push('\n');
    }
    text
}

/// Digits behind the point of a number that is read back as it was.
const ALL_DIGITS: usize = 17;
/// Those of a prediction.
const SHOWN_DIGITS: usize = 9;

fn predicted_text(run: &PlannedRun) -> String {
    let columns: Vec<TextColumn<'_>> = run
        .predicted
        .iter()
        .flat_map(|channel| {
            let name = channel.channel.name();
            [
                TextColumn::new(name, &channel.values),
                TextColumn::new(format!("{name}_low"), &channel.low),
                TextColumn::new(format!("{name}_high"), &channel.high),
            ]
        })
        .collect();
    columns_text(run.request.sample_period_s, &columns, SHOWN_DIGITS)
}

/// Returns whether a machine program has answered in a folder.
pub fn has_answer(folder: &Path) -> bool {
    folder.join(ANSWER).is_file()
}

/// Checks that a run which was answered before kept to the limits of today.
///
/// # Errors
/// The run's request has other limits, or cannot be read.
pub fn check_same_limits(folder: &Path, request: &MachineRequest) -> Result<()> {
    let before = read_request(folder)?.limits;
    if before != request.limits {
        let current =
            before.current_a.map_or_else(String::new, |current_a| format!(" --current {current_a}"));
        bail!(
            "{} was run with --angle {} --rate {}{current}: give the same limits to go on, or -o with another folder \
             to begin anew",
            folder.display(),
            before.angle_rad,
            before.rate_rad_s
        );
    }
    Ok(())
}

/// Checks that a recording of a complete run shows no angle, rate or current beyond the limits of the run.
///
/// Angle and rate count from the base. A reading passes a limit where it is more than a tenth beyond it in three samples
/// one after another: less may be noise of the sensor.
///
/// # Errors
/// A quantity that passes its limit.
pub fn check_within_limits(recording: &Recording, asked: &RunRequest, limits: &RunLimits) -> Result<()> {
    let samples = |channel| recording.samples(channel).unwrap_or_default();
    let angle = samples(Channel::HubPosition);
    let start = angle.first().copied().unwrap_or(0.0);
    let (hub_rate, base_rate) = (samples(Channel::HubRate), samples(Channel::PlatformRate));
    let rate: Vec<f64> = match (asked.moves_base(), base_rate.is_empty()) {
        (true, false) => hub_rate.iter().zip(base_rate).map(|(hub, base)| hub - base).collect(),
        (true, true) => Vec::new(),
        (false, _) => hub_rate.to_vec(),
    };
    let angle: Vec<f64> = angle.iter().map(|angle| angle - start).collect();
    let current_limit = limits.current_a.unwrap_or(f64::INFINITY);
    for (name, values, limit, unit) in [
        ("angle from the start", angle.as_slice(), limits.angle_rad, "rad"),
        ("rate", &rate, limits.rate_rad_s, "rad/s"),
        ("current", samples(Channel::MotorCurrent), current_limit, "A"),
    ] {
        // A sample that is missing reaches nothing.
        let size = |value: &f64| if value.is_nan() { 0.0 } else { value.abs() };
        let reached = values
            .windows(SAMPLES_BEYOND)
            .map(|window| window.iter().fold(f64::INFINITY, |least: f64, value| least.min(size(value))))
            .fold(0.0, f64::max);
        if reached > READING_MARGIN * limit {
            bail!(
                "{}: the {name} reached {reached:.4} {unit}, its limit is {limit} {unit}, and the machine program \
                 answered that the run is complete: correct the program, remove {RECORDING} and {ANSWER} of this run, and \
                 go on",
                recording.name
            );
        }
    }
    Ok(())
}

/// Starts a machine program on a folder, through the shell, and waits until it ends.
///
/// # Errors
/// The shell cannot be started, or the program exits with anything but 0.
pub fn run_machine(command: &str, folder: &Path) -> Result<()> {
    let mut shell = if cfg!(windows) {
        let mut shell = Command::new("cmd");
        shell.arg("/C").arg(format!("{command} \"{}\"", folder.display()));
        shell
    } else {
        let mut shell = Command::new("sh");
        shell.arg("-c").arg(format!("{command} \"$1\"")).arg("machine").arg(folder);
        shell
    };
    let status = shell.status().with_context(|| format!("cannot start the machine program `{command}`"))?;
    if !status.success() {
        bail!("the machine program `{command}` failed on {} ({status})", folder.display());
    }
    Ok(())
}

/// Reads a request as a machine program does.
///
/// # Errors
/// The file cannot be read, is none, or is of another version.
pub fn read_request(folder: &Path) -> Result<MachineRequest> {
    let request: MachineRequest = read_json(&folder.join(REQUEST))?;
    if request.protocol != PROTOCOL {
        bail!("{} is of protocol {}, this program knows {PROTOCOL}", folder.display(), request.protocol);
    }
    Ok(request)
}

/// Reads the demand and the motion of a run as a machine program does.
///
/// # Errors
/// A file that cannot be read, or has other columns.
pub fn read_run(folder: &Path, request: &MachineRequest) -> Result<RunRequest> {
    let demand = read_columns(&folder.join(DEMAND))?;
    let motion = folder.join(MOTION);
    let moved = if motion.is_file() { Some(read_columns(&motion)?) } else { None };
    let column = |recording: &Option<Recording>, channel: Channel| {
        recording.as_ref().and_then(|found| found.samples(channel)).unwrap_or_default().to_vec()
    };
    let demand = column(&Some(demand), Channel::Demand);
    if demand.len() != request.samples {
        bail!(
            "{} has {} samples of a demand, the request {}",
            folder.display(),
            demand.len(),
            request.samples
        );
    }
    Ok(RunRequest {
        sample_period_s: request.sample_period_s,
        demand,
        platform_rate_rad_s: column(&moved, Channel::PlatformRate),
        platform_accel_m_s2: column(&moved, Channel::PlatformAccel),
        start_angle_rad: request.start_angle_rad,
    })
}

fn read_columns(path: &Path) -> Result<Recording> {
    let name = path.display().to_string();
    let bytes = files::read_file(path).with_context(|| format!("cannot read {name}"))?;
    let table = RecordingTable::read(&bytes, &name)?;
    let recordings = Mapping::default().recordings(&table)?;
    recordings.into_iter().next().with_context(|| format!("{name} holds no samples"))
}

/// Writes a recording and then the answer, as a machine program does.
///
/// # Errors
/// A file that cannot be written.
pub fn write_answer(folder: &Path, recording: &Recording, answer: &MachineAnswer) -> Result<()> {
    let column = |channel: Channel| Some(TextColumn::new(channel.name(), recording.samples(channel)?));
    let columns: Vec<TextColumn<'_>> = Channel::ALL.into_iter().filter_map(column).collect();
    let text = columns_text(recording.sample_period_s, &columns, ALL_DIGITS);
    for (name, text) in [(RECORDING, text), (ANSWER, json_text(answer)?)] {
        let path = folder.join(name);
        files::write_file(&path, text.as_bytes())
            .with_context(|| format!("cannot write {}", path.display()))?;
    }
    Ok(())
}

/// Returns the answer of this version of the protocol.
pub fn answer_of(request: &MachineRequest, ended: RunEnd, reason: &str) -> MachineAnswer {
    MachineAnswer {
        protocol: PROTOCOL,
        controller_hash: request.controller_hash.clone(),
        ended,
        reason: reason.to_owned(),
    }
}

/// Reads what a machine program answered, and checks that the controller of the request ran.
///
/// # Errors
/// There is no answer, it is none, or another controller ran.
pub fn read_answer(folder: &Path, request: &MachineRequest) -> Result<MachineAnswer> {
    let answer: MachineAnswer = read_json(&folder.join(ANSWER))?;
    if answer.protocol != PROTOCOL {
        bail!("{}: the answer is of protocol {}, not {PROTOCOL}", folder.display(), answer.protocol);
    }
    if answer.controller_hash != request.controller_hash {
        bail!(
            "{}: controller {} ran, and {} was asked for; nothing of this recording is used",
            folder.display(),
            answer.controller_hash,
            request.controller_hash
        );
    }
    Ok(answer)
}

/// Returns the file of a recording.
///
/// # Errors
/// It cannot be read.
pub fn read_recording_file(folder: &Path) -> Result<RecordingFile> {
    let path: PathBuf = folder.join(RECORDING);
    let bytes = files::read_file(&path).with_context(|| format!("cannot read {}", path.display()))?;
    Ok(RecordingFile { name: path.display().to_string(), bytes })
}

fn read_json<T: for<'a> Deserialize<'a>>(path: &Path) -> Result<T> {
    let bytes = files::read_file(path).with_context(|| format!("cannot read {}", path.display()))?;
    serde_json::from_slice(&bytes)
        .with_context(|| format!("{} is not what the protocol describes", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: RunLimits = RunLimits { angle_rad: 1.0, rate_rad_s: 0.5, current_a: None };

    fn refusal(recording: &Recording, platform_rate_rad_s: &[f64]) -> String {
        let asked = RunRequest {
            sample_period_s: recording.sample_period_s,
            demand: vec![0.0; recording.len()],
            platform_rate_rad_s: platform_rate_rad_s.to_vec(),
            platform_accel_m_s2: vec![0.0; platform_rate_rad_s.len()],
            start_angle_rad: 0.0,
        };
        let checked = check_within_limits(recording, &asked, &LIMITS);
        checked.err().map_or_else(String::new, |error| error.to_string())
    }

    #[test]
    fn a_recording_beyond_a_limit_is_refused_and_one_outlier_is_not() {
        let plain = Recording::new("step", 0.01);
        let outlier = plain.clone().with(Channel::HubRate, vec![0.0, 9.0, f64::NAN, 0.1, 0.54, 0.54, 0.54]);
        assert_eq!(refusal(&outlier, &[]), "");
        let beyond = plain.clone().with(Channel::HubRate, vec![0.0, -0.6, -0.7, -0.65, 0.0]);
        assert!(refusal(&beyond, &[]).contains("the rate reached 0.6000 rad/s, its limit is 0.5 rad/s"));
        let turned = plain.with(Channel::HubPosition, vec![3.0, 3.5, 4.5, 4.5, 4.5]);
        assert!(refusal(&turned, &[]).contains("the angle from the start reached 1.5000 rad"));
    }

    #[test]
    fn the_rate_of_a_moving_base_is_taken_from_that_of_the_hub() {
        let follows = Recording::new("pitch", 0.01)
            .with(Channel::HubRate, vec![0.9; 4])
            .with(Channel::PlatformRate, vec![0.8; 4]);
        assert_eq!(refusal(&follows, &[0.8; 4]), "");
        assert!(refusal(&follows, &[]).contains("the rate reached 0.9000 rad/s"));
    }

    #[test]
    fn a_run_of_other_limits_is_no_part_of_the_round() -> Result<()> {
        let folder = tempfile::tempdir()?;
        let request = MachineRequest {
            protocol: PROTOCOL,
            round: 1,
            run: "step".to_owned(),
            sample_period_s: 0.01,
            samples: 4,
            start_angle_rad: 0.0,
            limits: LIMITS,
            controller_hash: String::new(),
            columns: Vec::new(),
        };
        files::write_file(&folder.path().join(REQUEST), json_text(&request)?.as_bytes())?;
        check_same_limits(folder.path(), &request)?;
        let narrower = MachineRequest { limits: RunLimits { angle_rad: 0.2, ..LIMITS }, ..request };
        let refused = check_same_limits(folder.path(), &narrower);
        assert!(refused.is_err_and(|error| error.to_string().contains("was run with --angle 1 --rate 0.5")));
        Ok(())
    }
}
