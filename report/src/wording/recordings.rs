//! Faults of recordings, in sentences.

use counterpoise_controller::AntiWindup;
use counterpoise_diagnose::Error;
use counterpoise_diagnose::recording::gap_repair::Repair;
use counterpoise_diagnose::recording::instrument_faults::{
    FaultKind, InstrumentFault, Treatment, UnitMistake,
};
use counterpoise_diagnose::recording::remarks::{ComparisonState, HeaveTreatment, RecordingRemark};
use counterpoise_diagnose::recording::sanity_checks::{Anomaly, ControlMismatch, Meaning, Standstill};
use counterpoise_pipeline::PipelineError;
use counterpoise_pipeline::recordings::column_remarks::BeyondRange;
use counterpoise_pipeline::recordings::controller_origin::OtherExport;
use counterpoise_pipeline::recordings::{ColumnRemark, ReplayedRecording, UnusedColumn};
use counterpoise_pipeline::results::RecordingResult;
use counterpoise_pipeline::studies::fra::{MapRemark, RecordedMap, ResponseMap};
use counterpoise_plot::number::short_number;

use super::errors::describe_pipeline_error;
use super::file_remarks::describe_file_remark;
use super::learned::describe_beyond;

/// Describes something found about the columns of a recording: its channel, and what is wrong or was done.
pub fn describe_column_remark(remark: &ColumnRemark) -> String {
    match remark {
        ColumnRemark::File(finding) => describe_file_remark(finding),
        ColumnRemark::BeyondRange { channel, found } => {
            format!("{}: {}", channel.name(), describe_beyond_range(found, channel.unit()))
        }
        ColumnRemark::Repair { part, repair } => format!("{}: {}", part.name(), describe_repair(repair)),
        ColumnRemark::Controller(mismatch) => format!("control: {}", describe_control_mismatch(mismatch)),
        ColumnRemark::Anomaly { channel, anomaly } => {
            format!("{}: {}", channel.name(), describe_anomaly(anomaly))
        }
        ColumnRemark::RangeExceeded(beyond) => describe_beyond(beyond),
    }
}

/// Describes readings beyond the range of a converter, and what to do.
fn describe_beyond_range(found: &BeyondRange, unit: &str) -> String {
    let BeyondRange { samples, missing, first_row, value, limit } = found;
    let missing = match missing {
        0 => String::new(),
        _ => format!("; {missing} of them lie beyond twice the range and count as missing"),
    };
    format!(
        "{samples} readings are beyond the converter's range of +/- {limit:.6} {unit}, the first in row {first_row} ({value:.6} {unit}){missing}: \
         check the recorder, or the sensor's scale in the project file"
    )
}

/// Describes that the project's recording controller could not be run; returns `None` if no recording lacks the demand.
pub fn describe_missing_demand(files: &[String]) -> Option<String> {
    without_demand(files, "everything is replayed")
}

/// Describes that recordings lack the demand, and that each of these is replayed under its recorded control.
pub fn describe_played_back(files: &[String]) -> Option<String> {
    without_demand(files, "replayed")
}

fn without_demand(files: &[String], replayed: &str) -> Option<String> {
    let names = files.join(", ");
    let instead = "under the recorded control instead of by the recorded controller";
    (!files.is_empty()).then(|| format!("demand was not recorded in {names}: {replayed} {instead}"))
}

/// Returns the map of a recording, with what was found about its columns among its remarks.
pub fn describe_recorded_map(found: RecordedMap) -> ResponseMap {
    let RecordedMap { map, columns } = found;
    let mut map = describe_map(map);
    map.remarks.extend(columns.iter().map(describe_column_remark));
    map
}

/// Returns a map with its remarks in sentences.
pub fn describe_map(map: ResponseMap<MapRemark>) -> ResponseMap {
    let ResponseMap { name, around, signals, recording, points, summary, histories, simulated_s, remarks } =
        map;
    let remarks = remarks.into_iter().map(describe_map_remark).collect();
    ResponseMap { name, around, signals, recording, points, summary, histories, simulated_s, remarks }
}

fn describe_map_remark(remark: MapRemark) -> String {
    match remark {
        MapRemark::RecordingController => "the loop is closed by the controller of the recordings".to_owned(),
        MapRemark::TakenAsBalanced { out_of_balance_kg_m } => format!(
            "the mechanism is taken as balanced: with the motor disconnected nothing holds its {out_of_balance_kg_m:.2} kg m"
        ),
    }
}

/// Describes that the recordings' controller was exported from another state of the project.
pub fn describe_other_export(other: &OtherExport) -> String {
    format!(
        "the controller in {} was exported from project {}; this project is now {}: the recordings are replayed with the controller in the file",
        other.file, other.file_hash, other.project_hash
    )
}

/// Returns the fit of a replayed recording as plain data, its remarks in sentences.
pub fn describe_replay(replayed: &ReplayedRecording) -> RecordingResult {
    let remarks = replayed.remarks.iter().map(describe_column_remark).collect();
    replayed.result(remarks)
}

/// Describes how a recording was replayed, in a line.
pub fn describe_replay_mode(result: &RecordingResult) -> String {
    let Some(window_s) = result.window_s else {
        return "from start to end".to_owned();
    };
    let by = format!("over windows of {window_s} s, each from a state fitted to its first half");
    let Some(divergence) = &result.parting else { return by };
    let of_machine = result.free.iter().filter(|(name, _)| !name.starts_with("platform"));
    let left: Vec<String> =
        of_machine.map(|(name, c)| format!("{name} {:.2}", c.residual_over_floor)).collect();
    format!(
        "{by}: the machine hunts, and two runs of the model itself diverge by {:.1} noise floors in {}; from start to end the residual over the noise floor is {}",
        divergence.floors,
        divergence.channel,
        left.join(", ")
    )
}

/// Describes why recordings were refused, with what was found in them.
pub fn describe_recordings_error(error: &PipelineError) -> String {
    match error {
        PipelineError::Diagnosis { cause, unused } => {
            describe_refusal(cause) + &describe_unused_columns(unused)
        }
        PipelineError::NothingToReplay { remarks, .. } => {
            let remarks: Vec<String> = remarks.iter().map(describe_column_remark).collect();
            format!("{error}: {}", remarks.join("; "))
        }
        PipelineError::CannotReplay { cause, unused, .. } => {
            format!("{error}: {cause}{}", describe_unused_columns(unused))
        }
        _ => describe_pipeline_error(error),
    }
}

/// Describes columns that were not used, to follow the description of what is missing; empty if there are none.
fn describe_unused_columns(unused: &[UnusedColumn]) -> String {
    unused
        .iter()
        .map(|column| format!("; {}: {}", column.recording, describe_file_remark(&column.remark)))
        .collect()
}

/// Describes something to be reported about the recordings.
pub fn describe_remark(remark: &RecordingRemark) -> String {
    match remark {
        RecordingRemark::UnknownHeave { recording, treatment } => {
            let done = match treatment {
                HeaveTreatment::TakenAsNone => "it is taken as none",
                HeaveTreatment::LeftOut => "the recording is left out",
            };
            format!(
                "{recording}: the platform moves, but platform_accel was not recorded: {done}, for what an unknown heave does might be \
                 named as something else; record the acceleration"
            )
        }
        RecordingRemark::OtherController { recording, mismatch } => {
            format!("{recording}: control: {}", describe_control_mismatch(mismatch))
        }
        RecordingRemark::Fault(fault) => describe_fault(fault),
        RecordingRemark::Repaired { recording, part, repair } => {
            format!("{recording}: {}: {}", part.name(), describe_repair(repair))
        }
        RecordingRemark::Checked { remark, comparison } => {
            let end = match comparison {
                ComparisonState::Compared => "",
                ComparisonState::NotCompared => "; it is not compared",
            };
            format!(
                "{}: {}: {}{end}",
                remark.recording,
                remark.channel.name(),
                describe_anomaly(&remark.anomaly)
            )
        }
        RecordingRemark::Shortened { recording, used_s, length_s, most_samples } => format!(
            "{recording}: the first {used_s:.4} s of {length_s:.4} s are used, because a replay has at most {most_samples} samples in all"
        ),
    }
}

/// Describes why a diagnosis was refused.
pub fn describe_refusal(error: &Error) -> String {
    match error {
        Error::Unusable { remarks } => {
            let remarks: Vec<String> = remarks.iter().map(describe_remark).collect();
            format!("{error}: {}", remarks.join("; "))
        }
        _ => error.to_string(),
    }
}

/// Describes what was done to repair a channel or a recording.
pub fn describe_repair(repair: &Repair) -> String {
    match repair {
        Repair::StuckReadings { value, samples, first } => format!(
            "stuck or clipped at {value:.6} while the mechanism moved: {samples} samples from sample {first} on are not compared"
        ),
        Repair::NoSamples => "not one sample: taken as not recorded".to_owned(),
        Repair::Filled { samples } => format!("{samples} missing samples filled in on straight lines"),
        Repair::Split { gaps, missing_s, first_s, parts } => {
            let many = if *gaps == 1 { "a gap".to_owned() } else { format!("{gaps} gaps") };
            let kept = match parts {
                0 => "no part that remains is long enough to be".to_owned(),
                1 => "the longest stretch is".to_owned(),
                n => format!("{n} stretches are, each by itself,"),
            };
            format!(
                "{many} of {missing_s:.3} s in all in what drives the replay, the first after {first_s:.3} s: {kept} replayed"
            )
        }
    }
}

/// Describes what is unusual about a channel.
pub fn describe_anomaly(anomaly: &Anomaly) -> String {
    match *anomaly {
        Anomaly::Missing { missing, samples } => {
            format!("{missing} of {samples} samples are missing or not numbers")
        }
        Anomaly::StuckThroughout { value } => format!("stuck at {value} throughout"),
        Anomaly::FlatTops { limit, samples } => {
            format!("clipped at {limit}: {samples} samples lie there in flat tops")
        }
        Anomaly::LongRun { standstill, value, samples, first } => {
            let word = match standstill {
                Standstill::Clipped => "clipped",
                Standstill::Stuck => "stuck",
            };
            format!("{word} at {value} for {samples} samples from sample {first}")
        }
        Anomaly::Coarse { steps } => format!("only {steps:.0} steps over its range"),
        Anomaly::GyroscopesDisagree { ratio, meaning } => format!(
            "the gyroscopes give {ratio:.3} times what motor and resolver say: {}",
            describe_meaning(meaning)
        ),
        Anomaly::Disagrees { ratio, meaning } => {
            format!("{ratio:.3} times what the gyroscopes say: {}", describe_meaning(meaning))
        }
        Anomaly::ClockOffset { late_s } => {
            let word = if late_s > 0.0 { "later" } else { "earlier" };
            format!("{:.0} ms {word} than the gyroscopes: its clock has an offset", 1e3 * late_s.abs())
        }
        Anomaly::ClockDrift { start_s, end_s, slow } => {
            let word = if slow > 0.0 { "slow" } else { "fast" };
            format!(
                "{:.0} ms off the gyroscopes at the start, {:.0} ms at the end: its clock runs {:.2} % {word}",
                1e3 * start_s,
                1e3 * end_s,
                100.0 * slow.abs()
            )
        }
    }
}

fn describe_meaning(meaning: Meaning) -> &'static str {
    match meaning {
        Meaning::SignSwapped => "its sign is swapped",
        Meaning::InDegrees => "it is in degrees",
        Meaning::MixedDegreesAndRadians => "one is in degrees where the other is in radians",
        Meaning::InThousandths => "it is in thousandths",
        Meaning::WrongScaleOrRatio => "a scale or the gear ratio is wrong",
    }
}

/// Describes a recorded control that the project's controller does not make.
pub fn describe_control_mismatch(mismatch: &ControlMismatch) -> String {
    if let Some(rule) = mismatch.with_anti_windup {
        return format!(
            "it is not what the project's recording controller makes of the recorded readings, but {} V RMS off; with \
             {} in [recording_controller] it is: the integral waited while the control was limited. The recorded control is \
             played back until the file says so",
            short_number(mismatch.rms_v),
            key_of_anti_windup(rule)
        );
    }
    format!(
        "it is not what the project's recording controller makes of the recorded readings, but {} V RMS off, {} times what \
         rounding leaves: another controller was in the loop, or a column is not what it read or gave. The recorded control is \
         played back",
        short_number(mismatch.rms_v),
        short_number(mismatch.ratio)
    )
}

/// Returns a rule against windup as the project file states it.
fn key_of_anti_windup(rule: AntiWindup) -> String {
    let (name, limit) = match rule {
        AntiWindup::None => return "`anti_windup = \"none\"`".to_owned(),
        AntiWindup::Hold(limit) => ("hold", limit),
        AntiWindup::HoldOutward(limit) => ("hold-outward", limit),
        AntiWindup::Clamp(limit) => ("clamp", limit),
    };
    format!("`anti_windup = \"{name}\"` and `limit = {limit}`")
}

/// Describes a fault of an instrument: what is wrong in which recordings, and what was done.
pub fn describe_fault(fault: &InstrumentFault) -> String {
    let place =
        if fault.everywhere { String::new() } else { format!(" (in {})", fault.recordings.join(", ")) };
    let others: Vec<&str> = fault.or.iter().map(|column| column.name()).collect();
    let others = match others.len() {
        0 => String::new(),
        _ => format!("; these recordings cannot distinguish it from a fault of {}", others.join(" or ")),
    };
    let kind = describe_fault_kind(&fault.kind);
    format!("{} {kind}{place}{others}; {}", fault.column.name(), describe_treatment(fault.treatment))
}

/// Returns what is wrong with a column, to follow the column's name.
fn describe_fault_kind(kind: &FaultKind) -> String {
    match kind {
        FaultKind::Scale { gain, .. } => describe_scale(*gain, kind.unit_mistake()),
        FaultKind::ClockOffset { late_s, .. } => {
            let word = if *late_s > 0.0 { "late" } else { "early" };
            format!("is {:.1} ms {word}: its clock has an offset", 1e3 * late_s.abs())
        }
        FaultKind::ClockDrift { slow, .. } => {
            let word = if *slow > 0.0 { "slow" } else { "fast" };
            format!("is on a clock that runs {:.0} ppm {word}", 1e6 * slow.abs())
        }
        FaultKind::Bias { bias, .. } => format!("has {bias:.4} added to it"),
        FaultKind::Stuck { from_s, for_s, value } => {
            format!("is stuck at {value:.6} from {from_s:.3} s on, for {for_s:.3} s in all")
        }
        FaultKind::Clipped { limit, share } => {
            format!("is clipped at {limit:.6}: {:.1} % of its samples lie there", 100.0 * share)
        }
        FaultKind::Coarse { step, .. } => format!(
            "moves in steps of {step:.3e}, {:.0} times the step of the project's converter",
            kind.step_ratio().unwrap_or(f64::NAN)
        ),
        FaultKind::Held { samples } => {
            format!("changes only every {samples} samples: it was recorded at a lower rate and held")
        }
        FaultKind::Exchanged { with } => format!("and {} stand in each other's place", with.name()),
    }
}

fn describe_scale(gain: f64, mistake: Option<UnitMistake>) -> String {
    let unit = mistake.map(|mistake| match mistake {
        UnitMistake::Degrees => "in degrees instead of radians",
        UnitMistake::RadiansTwice => "divided by 57.3, as if degrees were turned to radians twice",
        UnitMistake::Thousandths => "in thousandths",
        UnitMistake::Thousands => "in thousands",
        UnitMistake::StandardGravityTwice => "multiplied by 9.80665, as if g were turned to m/s^2 twice",
        UnitMistake::StandardGravity => "in g instead of m/s^2",
    });
    match (unit, gain < 0.0) {
        (Some(unit), false) => format!("is {unit}"),
        (Some(unit), true) => format!("is {unit}, and its sign is swapped"),
        (None, true) if gain == -1.0 => "has its sign swapped".to_owned(),
        (None, true) => format!("is {gain:.4} times what it should be: its sign is swapped, too"),
        (None, false) => format!("is {gain:.4} times what it should be"),
    }
}

fn describe_treatment(treatment: Treatment) -> &'static str {
    match treatment {
        Treatment::UsedAsItIs => "it is used as it is",
        Treatment::ControlRecomputed => {
            "the control there is recomputed from demand and hub_rate by the recording controller"
        }
        Treatment::Interpolated => "straight lines are drawn between its readings",
        Treatment::StretchesLeftOut => "the recording is used without these stretches",
        Treatment::SamplesNotCompared => "these samples are not compared",
        Treatment::NotCompared => "it is not compared",
        Treatment::ExchangedBack => "they are taken as the other one",
        Treatment::DividedByGain => "it is divided by that",
        Treatment::ShiftedBack => "it is shifted back by that",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn repairs_and_anomalies_are_described_with_their_numbers() {
        let split = Repair::Split { gaps: 1, missing_s: 0.5, first_s: 2.0, parts: 2 };
        assert!(describe_repair(&split).starts_with("a gap of 0.500 s in all"));
        let late = Anomaly::ClockOffset { late_s: 0.03 };
        assert_eq!(describe_anomaly(&late), "30 ms later than the gyroscopes: its clock has an offset");
        let missing = Anomaly::Missing { missing: 1, samples: 5000 };
        assert!(describe_anomaly(&missing).starts_with("1 of 5000"));
    }
}
