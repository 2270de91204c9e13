//! Recordings of real machines: what the diagnosis added explains data that it was not fitted to.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;
use std::path::{Path, PathBuf};

use counterpoise_project::Project;
use counterpoise_project::recording::{Mapping, Record, Table};
use counterpoise_simulate::replay::{Loop, replay};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// A recording of a real machine; none, with a message, where it is not here.
fn recording(file: &str) -> Option<Table> {
    let path = root().join("../shared/recordings/real").join(file);
    let bytes = fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    Some(Table::read(&bytes, file).unwrap())
}

fn project(machine: &str, file: &str) -> Project {
    let path = root().join("examples/real-recordings").join(machine).join(file);
    Project::from_bytes(&fs::read(path).unwrap(), file).unwrap().project
}

/// RMS error over the channel's RMS, of one window of a recording replayed by a project.
fn relative_error(project: &Project, table: &Table, window_s: [f64; 2], channel: &str) -> f64 {
    let mapping = Mapping { windows_s: vec![window_s], ..project.recording.clone() };
    let record: Record = mapping.records(table).unwrap().remove(0);
    let recording = record.recording();
    let control = project.recording_controller.as_ref().map_or(Loop::Open, Loop::from);
    let replayed = replay(&project.plant, &recording, &control).unwrap();
    let fit = replayed.channels.iter().find(|c| c.channel.name() == channel).unwrap();
    let series = recording.column(fit.channel).unwrap();
    let power = series.iter().map(|v| v * v).sum::<f64>() / series.len() as f64;
    fit.rms_error / power.sqrt()
}

/// The errors on data that was not fitted, by the plain model and by the improved one.
fn errors(machine: &str, file: &str, window_s: [f64; 2], channel: &str) -> Option<(f64, f64)> {
    let table = recording(&format!("{machine}/{file}"))?;
    let of = |name: &str| relative_error(&project(machine, name), &table, window_s, channel);
    let found = (of("project.toml"), of("improved.toml"));
    println!("{machine}/{file} {channel}: {:.2} % before, {:.2} % after", 100.0 * found.0, 100.0 * found.1);
    Some(found)
}

#[test]
fn friction_of_the_emps_axis_differs_between_the_directions() {
    // fitted to `estimation`; `pulses` is the published test
    let Some((before, after)) = errors("emps", "pulses.parquet", [0.0, 24.8], "control") else { return };
    assert!(
        after < 0.9 * before && after < 0.0894,
        "{before} {after}: both with the emulated controller, so not to be compared with published figures"
    );
}

#[test]
fn the_flexible_link_has_dry_friction_in_its_drive_and_carries_more_than_its_own_inertia() {
    for channel in ["hub_rate", "motor_rate"] {
        let Some((before, after)) = errors("flexible-link", "lqr.parquet", [9.0, 19.0], channel) else {
            return;
        };
        assert!(after < 0.55 * before, "{channel}: {before} {after}");
    }
}

#[test]
fn the_brushless_motor_cogs() {
    for file in ["nocomp_1.parquet", "comp_0.parquet", "comp_1.parquet"] {
        let Some((before, after)) = errors("cogging", file, [1.2, 9.7], "control") else { return };
        assert!(after < 0.4 * before, "{file}: {before} {after}");
    }
}
