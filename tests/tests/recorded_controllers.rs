//! Recordings made under the controllers that projects export: each replays in closed loop as closely as its noise allows, also from
//! its middle, and a recording under another controller than the project names is played back.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::TAU;
use std::fs;
use std::path::{Path, PathBuf};

use counterpoise_controller::{Controller, SampledController};
use counterpoise_diagnose::findings::answer::DiagnosisVerdict;
use counterpoise_diagnose::recording::remarks::RecordingRemark;
use counterpoise_export::Ranges;
use counterpoise_export::fixed_point::{FixedError, FixedPointController, FixedRunner, plan_fixed_point};
use counterpoise_export::targets::RANGE_MARGIN;
use counterpoise_models::Plant;
use counterpoise_pipeline::recordings::read::{control_for, recording_controller};
use counterpoise_pipeline::recordings::{self, ColumnRemark, GapTreatment, RecordingFile, ReplayLength};
use counterpoise_pipeline::{build_plant_model, reduce_plant, synthesise};
use counterpoise_pool::Serial;
use counterpoise_project::resolve::controller::RecordingController;
use counterpoise_project::{Attachments, Document, Project, SettingValue};
use counterpoise_recordings::{Channel, Recording};
use counterpoise_simulate::replay::{
    RecordedController, ReplayLoop, ReplayMode, Replayer, control_fit, reading_floor,
};
use counterpoise_simulate::signal::{Signal, Sine};
use counterpoise_simulate::{Detail, Firing, Imperfections, Initial, PlatformMotion, Scenario, Simulator};
use counterpoise_tests::exported_loop::{controller_file, document, from_file};

/// Ratio of residual to noise floor up to which a replay is that of the machine itself.
const REPLAYED: f64 = 1.5;

/// Name of the reference rig with the friction observer of one example, the schedule of another and the adaptation of a third.
const COMBINED: &str = "combined";

fn folder(name: &str) -> PathBuf {
    let name = if name == COMBINED { "reference-rig" } else { name };
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples").join(name)
}

fn project(name: &str) -> Project {
    let bytes = fs::read(folder(name).join("project.toml")).unwrap();
    let mut found = Project::from_bytes(&bytes, "project.toml").unwrap().project;
    if name == COMBINED {
        let options = |name: &str| project(name).synth.unwrap().options;
        let own = &mut found.synth.as_mut().unwrap().options;
        own.observer = own.observer.take().or_else(|| options("out-of-balance-schedule").observer);
        own.schedule = options("out-of-balance-schedule").schedule;
        own.adaptation = options("adaptation").adaptation;
        assert!(own.observer.is_some() && own.schedule.is_some() && own.adaptation.is_some());
    }
    found
}

/// The controller of the recordings, from the text of the `controller.json` that an export of it writes.
fn read_back(folder: &Path, project: &Project, controller: &Controller) -> RecordedController {
    let document = Document::from_bytes(&fs::read(folder.join("project.toml")).unwrap(), "p").unwrap();
    let found = from_file(&document, &controller_file(project, controller));
    let RecordedController::Exported(read) = &found else { panic!() };
    assert_eq!(read.controller(), controller);
    found
}

fn export_controller(project: &Project) -> (Plant, Controller) {
    let modelled = build_plant_model(project).unwrap();
    let controller = synthesise(project, &modelled, &reduce_plant(project, &modelled).unwrap())
        .unwrap()
        .sampled
        .controller;
    (Plant::from_lumped(&modelled.parameters).unwrap(), controller)
}

/// Sines of whole and odd frequencies: (amplitude, frequency in Hz, phase).
fn sines(all: &[(f64, f64, f64)]) -> Signal {
    let sine = |&(amplitude, hz, phase_rad): &(f64, f64, f64)| Sine {
        amplitude,
        frequency_rad_s: TAU * hz,
        phase_rad,
    };
    Signal::Sines(all.iter().map(sine).collect())
}

/// A recording of the machine under a controller: demand, heave and pitch together, with noise and quantisation.
fn record(plant: &Plant, controller: &mut dyn SampledController) -> Recording {
    record_with(plant, controller, 5)
}

/// A recording as [`record`] makes it, with noise of a seed.
fn record_with(plant: &Plant, controller: &mut dyn SampledController, seed: u64) -> Recording {
    let scenario = Scenario {
        duration_s: 8.0,
        demand_rad_s: sines(&[(0.06, 0.31, 0.0), (0.03, 1.7, 1.0)]),
        injection_v: Signal::ZERO,
        platform: PlatformMotion {
            pitch_rate_rad_s: sines(&[(0.05, 0.8, 0.4)]),
            heave_m_s2: sines(&[(0.8, 1.3, 0.0), (0.4, 2.9, 2.0)]),
            initial_angle_rad: 0.0,
            further: None,
        },
        imperfections: Imperfections::NoiseAndQuantisation { seed },
        initial: Initial::Rest { hub_angle_rad: 0.0 },
        detail: Detail::Recording,
        firing: Firing::Stated,
    };
    let history = Simulator::new(plant).unwrap().run(controller, &scenario).unwrap();
    history.readings.recording("run", history.sample_period_s)
}

/// The largest ratio of residual to noise floor of a closed-loop replay, with its channel.
fn largest_ratio(plant: &Plant, recording: &Recording, control: &ReplayLoop) -> (f64, Channel) {
    let replay = Replayer::new(plant.parameters(), recording).unwrap().replay_plant(plant, control).unwrap();
    let ratio = |fit: &counterpoise_simulate::replay::ChannelFit| (fit.residual_over_floor(), fit.channel);
    replay.channels.iter().map(ratio).max_by(|a, b| a.0.total_cmp(&b.0)).unwrap()
}

#[test]
fn every_exported_controller_replays_its_own_recordings() {
    for name in EXAMPLES {
        let project = project(name);
        let (plant, controller) = export_controller(&project);
        let recording = record(&plant, &mut controller.runner());
        let exported = read_back(&folder(name), &project, &controller);
        let (fit, _) = control_fit(plant.parameters(), &recording, &exported).unwrap();
        assert!(
            fit.rms_error < 2.0 * fit.floor,
            "{name}: control off by {} floors",
            fit.residual_over_floor()
        );
        let control = ReplayLoop::from(exported);
        let (ratio, channel) = largest_ratio(&plant, &recording, &control);
        assert!(ratio < REPLAYED, "{name}: {ratio} floors in {}", channel.name());
        let middle = recording.part(2500..recording.len());
        if project.synth.unwrap().options.adaptation.is_some() {
            // what an estimator has gathered in its present window does not show in the control before the window ends
            continue;
        }
        let (ratio, channel) = largest_ratio(&plant, &middle, &control);
        assert!(ratio < REPLAYED, "{name} from its middle: {ratio} floors in {}", channel.name());
    }
}

#[test]
fn recordings_under_single_and_fixed_point_code_are_replayed_by_the_controller_of_the_file() {
    for name in EXAMPLES {
        let project = project(name);
        let (plant, controller) = export_controller(&project);
        let control = ReplayLoop::from(read_back(&folder(name), &project, &controller));
        let single = record(&plant, &mut controller.runner_in::<f32>());
        let (ratio, channel) = largest_ratio(&plant, &single, &control);
        assert!(ratio < REPLAYED, "{name} in single precision: {ratio} floors in {}", channel.name());
        let Ok(fixed) = fixed_point(&plant, &controller) else { continue };
        let recording = record(&plant, &mut FixedRunner::new(&fixed));
        let (ratio, channel) = largest_ratio(&plant, &recording, &control);
        assert!(ratio < REPLAYED, "{name} in fixed point: {ratio} floors in {}", channel.name());
    }
}

/// The controller's fixed-point form for the readings of its own recording.
fn fixed_point(plant: &Plant, controller: &Controller) -> Result<FixedPointController, FixedError> {
    let recording = record(plant, &mut controller.runner());
    let channels = [
        Channel::Demand,
        Channel::HubRate,
        Channel::PlatformRate,
        Channel::PlatformAccel,
        Channel::MotorRate,
        Channel::HubPosition,
    ];
    let columns = channels.map(|channel| recording.samples(channel).unwrap());
    // no machine of these has an accelerometer of surge, the seventh reading
    let row = |k: usize| std::array::from_fn(|i| columns.get(i).map_or(0.0, |column| column[k]));
    let readings = (0..recording.len()).map(row).collect::<Vec<_>>();
    let ranges = Ranges::from_readings(controller, &[readings], RANGE_MARGIN);
    let half_step_v = 10.0 / f64::from(plant.parameters().interface.output_bits).exp2();
    plan_fixed_point(controller, &ranges, half_step_v, recording.len())
}

#[test]
fn a_file_that_is_no_controller_of_the_recordings_is_refused_with_what_is_wrong() {
    let project = project("reference-rig");
    let (_, controller) = export_controller(&project);
    let document = document(None);
    let named = |hash: &str| {
        let text = |value: &str| SettingValue::Text(value.to_owned());
        let set = |it: Document, key: &str, value: &str| it.set(key, &text(value)).unwrap();
        let it = set(document.clone(), "recording_controller.kind", "exported");
        set(set(it, "recording_controller.file", "controller.json"), "recording_controller.hash", hash)
    };
    let errors = |hash: &str, text: &str| -> String {
        let files = Attachments::none().with("controller.json", text.as_bytes().to_vec());
        let found = Project::resolve(&named(hash), &files).err().unwrap_or_default();
        found.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
    };
    let text = controller_file(&project, &controller);
    assert_eq!(errors("", &text), "");
    assert_eq!(errors("0123", &text), "");
    let said = errors("4567", &text);
    assert!(said.contains("recording_controller.hash") && said.contains("0123"), "{said}");
    let cases = [
        (text.replace("\"limit_v\"", "\"limit\""), "missing field `limit_v`"),
        (text.replace("counterpoise.results/", "other/"), "the schema is \"other/"),
        (text.replace("\"sample_time_s\":0.001", "\"sample_time_s\":0.002"), "0.001 s"),
        (text.replace("rate_error_rad_s", "rate"), "unknown variant `rate`"),
        (text[..text.len() / 2].to_owned(), "EOF"),
        ("{}".to_owned(), "missing field"),
    ];
    for (text, expected) in cases {
        let said = errors("", &text);
        assert!(said.contains("recording_controller.file") && said.contains(expected), "{said}");
    }
}

#[test]
fn a_recording_under_another_controller_is_played_back_and_diagnosed() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/practice/p08");
    let mut project =
        Project::from_bytes(&fs::read(folder.join("project.toml")).unwrap(), "p").unwrap().project;
    let Some(RecordingController::ProportionalIntegral(pi)) = &mut project.recording_controller else {
        panic!()
    };
    pi.kp_v_s_rad *= 0.7;
    let bytes = fs::read(folder.join("triangle.parquet")).unwrap();
    let files = [RecordingFile { name: "triangle.parquet".to_owned(), bytes }];
    let controller = recording_controller(&project).unwrap();
    let read = recordings::read_files(&project, controller.as_ref(), &files, GapTreatment::Repaired).unwrap();
    let control = control_for(&project, controller.as_ref(), read.iter().map(|item| &item.recording));
    assert!(matches!(control, ReplayLoop::Closed(_)));
    let replayed = recordings::replay(&project, &read, &control, ReplayLength::Automatic).unwrap();
    let fits = &replayed[0].followed.replay.channels;
    assert!(fits.iter().all(|fit| fit.channel != Channel::Control && fit.rms_error < REPLAYED * fit.floor));
    assert!(replayed[0].remarks.iter().any(|remark| matches!(remark, ColumnRemark::Controller(_))));
    let diagnosed = recordings::diagnose(&project, &files, &Serial).unwrap();
    assert_eq!(diagnosed.control, ReplayLoop::Open);
    assert_eq!(diagnosed.diagnosis.answer.verdict, DiagnosisVerdict::Consistent);
    let said = |remark: &RecordingRemark| matches!(remark, RecordingRemark::OtherController { .. });
    assert!(diagnosed.diagnosis.answer.remarks.iter().any(said));
}

/// Examples whose controllers differ in their blocks: three parts, a friction observer, a schedule, an estimator, and these together.
const EXAMPLES: [&str; 6] =
    ["reference-rig", "out-of-balance-schedule", "adaptation", "lqg-ltr-and-hinf", "tip-control", COMBINED];

/// The largest difference of two recordings of one machine, over the noise floors of both, with its channel.
fn largest_difference(plant: &Plant, one: &Recording, other: &Recording) -> f64 {
    let sensors = &plant.parameters().sensors;
    let floors = [
        (Channel::HubRate, reading_floor(&sensors.hub_gyro, &plant.parameters().interface)),
        (
            Channel::MotorRate,
            reading_floor(sensors.motor_tachometer.as_ref().unwrap(), &plant.parameters().interface),
        ),
    ];
    let ratio = |(channel, floor): (Channel, f64)| {
        let pairs = one.samples(channel).unwrap().iter().zip(other.samples(channel).unwrap());
        let sum: f64 = pairs.map(|(a, b)| (a - b) * (a - b)).sum();
        (0.5 * sum / one.len() as f64).sqrt() / floor
    };
    floors.into_iter().map(ratio).fold(0.0, f64::max)
}

#[test]
fn a_machine_that_floats_in_its_gap_is_replayed_in_windows_and_freely_as_closely_as_it_repeats_itself() {
    let project = project("azimuth");
    let (plant, controller) = export_controller(&project);
    let recording = record(&plant, &mut controller.runner());
    let again = record_with(&plant, &mut controller.runner(), 6);
    let control = ReplayLoop::from(read_back(&folder("azimuth"), &project, &controller));
    // two runs of the machine that differ in noise alone already part: no free replay is closer than they are
    let own = largest_difference(&plant, &recording, &again);
    assert!(own > 2.0 * REPLAYED, "{own}");
    let (free, channel) = largest_ratio(&plant, &recording, &control);
    assert!(free < own, "{free} floors in {}, two runs of the machine {own}", channel.name());
    for recording in [&recording, &recording.part(2500..recording.len())] {
        let replayer = Replayer::new(plant.parameters(), recording).unwrap();
        let selected = replayer.replay_free_or_windowed(plant.parameters(), &control).unwrap();
        assert!(matches!(selected.mode, ReplayMode::Windowed { .. }));
        // what the estimator has gathered before the first sample does not show in the control at once
        let is_whole = recording.len() == 8000;
        for fit in selected.replay.channels.iter().filter(|fit| is_whole || fit.channel != Channel::Control) {
            let ratio = fit.residual_over_floor();
            assert!(ratio < REPLAYED, "{ratio} floors in {}", fit.channel.name());
        }
    }
}
