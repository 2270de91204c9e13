//! Faults of sensors and recorder, put into the recordings of machines with and without concealed physics: each is named by column
//! and kind, nothing else is, and what can be corrected is what it was before.
//!
//! By default a third of the faults is tried, and half of the machines; `EVERY_FAULT=1`, as in `.ci/evidence`, tries all.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;
use std::path::Path;

use counterpoise_diagnose::findings::instrument_findings::{component_of, effect_of};
use counterpoise_diagnose::recording::instrument_faults::{
    ExaminedRecordings, RecorderColumn, find_instrument_faults,
};
use counterpoise_project::Project;
use counterpoise_project::resolve::controller::RecordingController;
use counterpoise_recordings::{Recording, RecordingTable};
use counterpoise_simulate::replay::ReplayLoop;
use counterpoise_tests::sealed;

const EXPERIMENTS: [&str; 4] = ["multisine", "road", "steps", "triangle"];

struct Machine {
    project: Project,
    recordings: Vec<Recording>,
}

impl Machine {
    /// A practice machine.
    fn read(name: &str) -> Self {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/practice").join(name);
        let text = fs::read(folder.join("project.toml")).unwrap();
        let project = Project::from_bytes(&text, "project.toml").unwrap().project;
        let read = |experiment: &&str| {
            let file = format!("{experiment}.parquet");
            let table = RecordingTable::read(&fs::read(folder.join(&file)).unwrap(), experiment).unwrap();
            project.recording.apply(&table).unwrap()
        };
        let recordings = EXPERIMENTS.iter().map(read).collect();
        Self { project, recordings }
    }

    fn examine_recordings(&self, recordings: &[Recording]) -> ExaminedRecordings {
        let control = self
            .project
            .recording_controller
            .as_ref()
            .and_then(RecordingController::as_proportional_integral)
            .map_or(ReplayLoop::Open, ReplayLoop::from);
        find_instrument_faults(&self.project.plant, &control, recordings)
    }

    fn with(&self, which: &[usize], fault: impl Fn(&mut Recording)) -> Vec<Recording> {
        let mut out = self.recordings.clone();
        which.iter().for_each(|r| fault(&mut out[*r]));
        out
    }
}

fn of(r: &mut Recording, column: RecorderColumn) -> &mut [f64] {
    column.of_mut(r).unwrap()
}

/// The faults that a recorder may add to a column.
#[derive(Debug, Clone, Copy)]
enum RecorderFault {
    Times(f64),
    StuckFrom(usize),
    ClippedAt(f64),
    Late(usize),
    Early(usize),
    Slow(f64),
    Steps(f64),
    Every(usize),
    Plus(f64),
}

fn spoil(series: &mut [f64], wrong: RecorderFault) {
    let was = series.to_vec();
    let mean = was.iter().sum::<f64>() / was.len() as f64;
    let top = was.iter().fold(0.0, |a: f64, v| a.max((v - mean).abs()));
    let at = |place: f64| {
        let low = (place.max(0.0) as usize).min(was.len() - 2);
        let share = place.max(0.0) - low as f64;
        was[low] * (1.0 - share) + was[low + 1] * share
    };
    for (k, value) in series.iter_mut().enumerate() {
        *value = match wrong {
            RecorderFault::Times(gain) => gain * *value,
            RecorderFault::StuckFrom(from) => was[k.min(from)],
            RecorderFault::ClippedAt(share) => (*value - mean).clamp(-share * top, share * top) + mean,
            RecorderFault::Late(samples) => was[k.saturating_sub(samples)],
            RecorderFault::Early(samples) => was[(k + samples).min(was.len() - 1)],
            RecorderFault::Slow(share) => at(k as f64 * (1.0 - share)),
            RecorderFault::Steps(step) => (*value / step).round() * step,
            RecorderFault::Every(samples) => was[k / samples * samples],
            RecorderFault::Plus(bias) => *value + bias,
        };
    }
}

const ALL: [usize; 4] = [0, 1, 2, 3];

/// Returns one of `some` cases by default, and each if all are asked for.
fn one_of(some: usize) -> usize {
    if std::env::var_os("EVERY_FAULT").is_some() { 1 } else { some }
}

/// The faults, each in all recordings or in some, with the component and effect that must be named.
fn cases() -> Vec<(RecorderColumn, RecorderFault, Vec<usize>, &'static str, &'static str)> {
    use RecorderColumn::*;
    use RecorderFault::*;
    let degrees = 180.0 / std::f64::consts::PI;
    let mut out = Vec::new();
    let mut case = |column: RecorderColumn, wrong, effect| {
        out.push((column, wrong, ALL.to_vec(), component_of(column).name(), effect));
    };
    for column in [Demand, Control, HubRate, PlatformRate, MotorRate, HubPosition] {
        case(column, Times(-1.0), "scale");
        case(column, Times(1e3), "scale");
    }
    for column in [Demand, HubRate, PlatformRate, MotorRate, HubPosition] {
        case(column, Times(degrees), "scale");
    }
    for column in [Demand, Control, HubRate, MotorRate, HubPosition] {
        case(column, Times(1.03), "scale");
    }
    case(PlatformAccel, Times(1.0 / 9.80665), "scale");
    case(PlatformAccel, Times(-1.0), "scale");
    for column in [Control, HubRate, PlatformRate, PlatformAccel, MotorRate, HubPosition] {
        case(column, StuckFrom(4000), "stuck");
    }
    for column in [HubRate, MotorRate, HubPosition] {
        case(column, ClippedAt(0.5), "clipped");
    }
    for column in [Control, HubRate, MotorRate, HubPosition] {
        case(column, Late(3), "clock_offset");
        case(column, Late(20), "clock_offset");
    }
    case(MotorRate, Early(20), "clock_offset");
    case(HubPosition, Early(20), "clock_offset");
    case(MotorRate, Slow(1e-3), "clock_drift");
    case(HubPosition, Slow(1e-3), "clock_drift");
    case(HubPosition, Slow(2e-4), "clock_drift");
    for column in [HubRate, PlatformRate] {
        case(column, Steps(5e-3), "quantisation");
    }
    case(MotorRate, Steps(0.5), "quantisation");
    case(HubPosition, Steps(1e-3), "quantisation");
    for column in [HubRate, PlatformRate, MotorRate, HubPosition] {
        case(column, Every(10), "sample_rate");
    }
    case(MotorRate, Plus(0.5), "bias");
    out.push((MotorRate, Times(-1.0), vec![2], "motor_tachometer", "scale"));
    out.push((HubPosition, Times(degrees), vec![1], "hub_resolver", "scale"));
    out.push((HubRate, StuckFrom(4000), vec![3], "hub_gyro", "stuck"));
    out
}

fn described_faults(examined: &ExaminedRecordings) -> Vec<(&'static str, &'static str)> {
    examined.faults.iter().map(|f| (component_of(f.column).name(), effect_of(&f.kind).name())).collect()
}

#[test]
fn machines_with_any_concealed_physics_have_no_fault_of_the_recorder() {
    for name in ["p01", "p02", "p03", "p04", "p05", "p06", "p07", "p08"] {
        let machine = Machine::read(name);
        let examined = machine.examine_recordings(&machine.recordings);
        assert!(examined.faults.is_empty(), "{name}: {:?}", examined.faults);
        assert!(examined.recordings == machine.recordings, "{name}");
    }
}

#[test]
fn each_fault_is_named_and_nothing_else_is() {
    let mut wrong = Vec::new();
    for name in ["p08", "p04", "p05"] {
        let machine = Machine::read(name);
        // every case on the machine with nothing concealed, every eighth beside concealed physics; by default a third of these
        let step = one_of(3) * if name == "p08" { 1 } else { 8 };
        for (column, fault, which, component, effect) in cases().into_iter().step_by(step) {
            let spoilt = machine.with(&which, |r| spoil(of(r, column), fault));
            let examined = machine.examine_recordings(&spoilt);
            if described_faults(&examined) != [(component, effect)] {
                wrong.push(format!("{name} {} {fault:?} {which:?}: {:?}", column.name(), examined.faults));
            }
        }
    }
    assert!(wrong.is_empty(), "{} wrong:\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn exchanged_columns_are_named_and_put_back() {
    use RecorderColumn::*;
    for name in ["p08", "p05"].into_iter().step_by(one_of(2)) {
        let machine = Machine::read(name);
        let pairs = [
            (HubRate, PlatformRate),
            (HubRate, Demand),
            (HubRate, MotorRate),
            (MotorRate, HubPosition),
            (Demand, Control),
            (Control, HubRate),
            (PlatformRate, PlatformAccel),
        ];
        for (one, other) in pairs {
            let exchanged = machine.with(&ALL, |r| {
                let [first, second] = [one, other].map(|column| r.remove(column.channel()).unwrap());
                r.set(other.channel(), first);
                r.set(one.channel(), second);
            });
            let examined = machine.examine_recordings(&exchanged);
            let pair = [(component_of(one).name(), "exchanged"), (component_of(other).name(), "exchanged")];
            let told = described_faults(&examined);
            assert!(
                told.len() == 1 && pair.contains(&told[0]),
                "{name} {one:?} {other:?}: {:?}",
                examined.faults
            );
            let back = examined.recordings == machine.recordings;
            assert!(back, "{name} {one:?} {other:?}: {:?}", examined.faults);
        }
    }
}

/// Machines of the other simulator, with concealed effects of every family, faults of gyroscopes and accelerometer among them, in three
/// noise levels and three sets of sensors: what the library of physics names is no fault of the recorder.
#[test]
fn sealed_machines_have_no_fault_of_the_recorder() {
    let nominal = counterpoise_models::reference::rig();
    let control = ReplayLoop::from(&sealed::controller());
    let seeds: Vec<u64> = SEEDS.into_iter().step_by(one_of(2)).collect();
    let wrong = std::sync::Mutex::new(Vec::new());
    counterpoise_tests::run_in_parallel(seeds.len(), &|k| {
        let case = sealed::case(seeds[k], &nominal);
        let examined = find_instrument_faults(&nominal, &control, &sealed::row::recordings(&case));
        if !examined.faults.is_empty() {
            let line = format!("{} {:?}: {:?}", seeds[k], case.sealed.concealed, examined.faults);
            wrong.lock().unwrap().push(line);
        }
    });
    let wrong = wrong.into_inner().unwrap();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Seeds that are looked at: those that are nearest to a fault of the recorder of the 200 on which the diagnosis was developed, and a few.
const SEEDS: [u64; 12] = [1, 2, 3, 4, 41, 62, 109, 160, 169, 171, 180, 194];
