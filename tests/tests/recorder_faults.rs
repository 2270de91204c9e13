//! Faults of the recorder, put into a recording of an independent simulator: each is named by the sanity checks, and none
//! keeps the rest of the recording from being replayed.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;
use std::path::Path;

use counterpoise_diagnose::recording::gap_repair::repair_gaps;
use counterpoise_diagnose::recording::measured_signals::read_signals;
use counterpoise_diagnose::recording::sanity_checks::check_signals;
use counterpoise_models::FeedbackSignal;
use counterpoise_project::Project;
use counterpoise_project::resolve::controller::RecordingController;
use counterpoise_recordings::Recording;
use counterpoise_recordings::{RecordingColumn, RecordingTable};
use counterpoise_report::wording::file_remarks::describe_file_remark;
use counterpoise_report::wording::recordings::{describe_anomaly, describe_repair};
use counterpoise_simulate::replay::{ReplayLoop, replay};

/// The description of what a recorder made of a table, and its parts that can be replayed.
struct RecorderFindings {
    remarks: Vec<String>,
    parts: Vec<Recording>,
    project: Project,
}

impl RecorderFindings {
    fn says(&self, what: &str) -> bool {
        self.remarks.iter().any(|remark| remark.contains(what))
    }

    /// The largest RMS error over its floor of every part in closed loop.
    fn largest_ratio(&self) -> f64 {
        let control = ReplayLoop::from(
            self.project
                .recording_controller
                .as_ref()
                .and_then(RecordingController::as_proportional_integral)
                .unwrap(),
        );
        let fits =
            self.parts.iter().flat_map(|part| replay(&self.project.plant, part, &control).unwrap().channels);
        fits.map(|c| c.rms_error / c.floor).fold(0.0, f64::max)
    }
}

/// The triangle of a machine as modelled with a fault put in.
fn with(fault: impl Fn(&mut RecordingTable)) -> RecorderFindings {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/practice/p08");
    let bytes = fs::read(folder.join("triangle.parquet")).unwrap();
    let project =
        Project::from_bytes(&fs::read(folder.join("project.toml")).unwrap(), "project.toml").unwrap().project;
    let mut table = RecordingTable::read(&bytes, "triangle.parquet").unwrap();
    fault(&mut table);
    let record = project.recording.apply(&table).unwrap();
    let ratio = project.plant.gearbox.ratio;
    let repaired = repair_gaps(&record, ratio);
    let mut remarks: Vec<String> = record.remarks.iter().map(describe_file_remark).collect();
    remarks.extend(
        repaired.repairs.iter().map(|(part, repair)| format!("{}: {}", part.name(), describe_repair(repair))),
    );
    for part in &repaired.parts {
        let here = check_signals(&part.name, &read_signals(part, FeedbackSignal::HubRate).unwrap(), ratio);
        remarks.extend(
            here.into_iter().map(|r| format!("{}: {}", r.channel.name(), describe_anomaly(&r.anomaly))),
        );
    }
    RecorderFindings { remarks, parts: repaired.parts, project }
}

fn column<'a>(table: &'a mut RecordingTable, name: &str) -> &'a mut RecordingColumn {
    table.columns.iter_mut().find(|c| c.name == name).unwrap()
}

fn change_column(table: &mut RecordingTable, name: &str, change: impl Fn(usize, f64) -> f64) {
    let values = &mut column(table, name).values;
    *values = values.iter().enumerate().map(|(k, v)| change(k, *v)).collect();
}

#[test]
fn a_sound_recording_has_nothing_wrong() {
    let told = with(|_| ());
    assert!(told.remarks.is_empty(), "{:?}", told.remarks);
    assert!(told.largest_ratio() < 1.5);
}

#[test]
fn a_gap_in_time_parts_the_recording_and_both_parts_replay() {
    let told = with(|table| {
        for column in &mut table.columns {
            let kept = column.values.iter().enumerate().filter(|(k, _)| !(4000..4700).contains(k));
            column.values = kept.map(|(_, v)| *v).collect();
        }
    });
    assert!(
        told.says("700 samples are missing after row") && told.says("time: a gap of 0.70"),
        "{:?}",
        told.remarks
    );
    assert_eq!(told.parts.len(), 2);
    assert!(told.largest_ratio() < 1.6, "{}", told.largest_ratio());
}

#[test]
fn missing_stuck_and_clipped_readings_are_named_without_a_false_scale() {
    let missing =
        with(|table| change_column(table, "motor_rate", |k, v| if k % 50 < 5 { f64::NAN } else { v }));
    assert!(missing.says("motor_rate: "), "{:?}", missing.remarks);
    let stuck = with(|table| {
        let held = column(table, "motor_rate").values[3000];
        change_column(table, "motor_rate", |k, v| if (3000..4500).contains(&k) { held } else { v });
    });
    assert!(stuck.says("motor_rate: stuck or clipped"), "{:?}", stuck.remarks);
    let clipped = with(|table| {
        let top = 0.5 * column(table, "motor_rate").values.iter().fold(0.0, |a: f64, v| a.max(v.abs()));
        change_column(table, "motor_rate", |_, v| v.clamp(-top, top));
    });
    assert!(clipped.says("motor_rate: ") && clipped.says("clipped at"), "{:?}", clipped.remarks);
    for told in [missing, stuck, clipped] {
        assert!(!told.says("gear ratio"), "{:?}", told.remarks);
        assert!(told.largest_ratio() < 1.5, "{}, {:?}", told.largest_ratio(), told.remarks);
    }
}

#[test]
fn a_swapped_sign_and_a_wrong_unit_are_named() {
    let swapped = with(|table| change_column(table, "motor_rate", |_, v| -v));
    assert!(swapped.says("times what the gyroscopes say: its sign is swapped"), "{:?}", swapped.remarks);
    let degrees = with(|table| change_column(table, "hub_position", |_, v| v.to_degrees()));
    assert!(degrees.says("hub_position: 57.") && degrees.says("it is in degrees"), "{:?}", degrees.remarks);
    let gyro = with(|table| change_column(table, "hub_rate", |_, v| -v));
    assert!(gyro.says("hub_rate: the gyroscopes give -1.0"), "{:?}", gyro.remarks);
}

#[test]
fn a_clock_that_is_late_or_drifts_is_named_with_its_figure() {
    let late = with(|table| {
        let was = column(table, "motor_rate").values.clone();
        change_column(table, "motor_rate", |k, _| was[k.saturating_sub(25)]);
    });
    assert!(late.says("motor_rate: 2") && late.says("its clock has an offset"), "{:?}", late.remarks);
    let slow = with(|table| {
        let was = column(table, "motor_rate").values.clone();
        change_column(table, "motor_rate", |k, _| was[k - k / 200]);
    });
    assert!(slow.says("motor_rate: ") && slow.says("its clock runs 0.5"), "{:?}", slow.remarks);
}
