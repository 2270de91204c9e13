//! A controller that an example exports replays its own recordings, as `counterpoise replay` does: made by the simulator with noise and
//! converters under the controller in double, single and fixed point, read with a project that names the controller's file.

use std::f64::consts::TAU;
use std::path::Path;
use std::sync::Mutex;

use counterpoise_controller::{Controller, READINGS, Readings, SampledController};
use counterpoise_export::Ranges;
use counterpoise_export::fixed_point::{FixedRunner, plan_fixed_point};
use counterpoise_export::targets::RANGE_MARGIN;
use counterpoise_models::Plant;
use counterpoise_pipeline::recordings::read::{control_for, read_recording, recording_controller};
use counterpoise_pipeline::recordings::{GapTreatment, ReplayLength, ReplayedRecording, replay};
use counterpoise_project::{Attachments, Document, Project, Purpose, SettingValue, StructureChoice};
use counterpoise_recordings::Recording;
use counterpoise_simulate::signal::{Signal, Sine};
use counterpoise_simulate::{Detail, Firing, Imperfections, Initial, PlatformMotion, Scenario, Simulator};
use counterpoise_tests::examples::{self, DesignedExample};
use counterpoise_tests::exported_loop::controller_file;

/// Ratio of residual to noise floor up to which a replay is that of the machine itself.
const REPLAYED: f64 = 1.5;
/// Length of a recording, s; machines that are sampled fast have this many samples.
const LENGTH_S: f64 = 8.0;
const SAMPLES: f64 = 8000.0;

/// Examples that replay their recordings in single precision and in fixed point too, if not every one is asked for.
const IN_EVERY_NUMBERS: [&str; 2] = ["reference-rig_project", "servo-pendulum_project"];

/// Sines of amplitude and frequency in Hz.
fn sines(all: &[(f64, f64)]) -> Signal {
    let sine =
        |&(amplitude, hz): &(f64, f64)| Sine { amplitude, frequency_rad_s: TAU * hz, phase_rad: 0.4 * hz };
    Signal::Sines(all.iter().map(sine).collect())
}

/// The machine with a recorder's converters and noise where its file states ideal ones.
fn recorded_plant(designed: &DesignedExample, step: f64) -> Plant {
    let mut parameters = designed.modelled.parameters.clone();
    parameters.interface.output_bits = parameters.interface.output_bits.min(16);
    let sensor = &mut parameters.sensors.hub_gyro;
    if sensor.resolution == 0.0 && sensor.noise_rms == 0.0 {
        sensor.noise_rms = 1e-3 * step;
    }
    // the machine has the flexible modes of its finite elements, if it is modelled by them
    match designed.project.model.structure {
        StructureChoice::Lumped => Plant::from_lumped(&parameters).unwrap(),
        _ => Plant::with_body(&parameters, designed.modelled.plant.body().clone()).unwrap(),
    }
}

/// A recording under a controller: demand, heave and pitch together, as large as the example's own experiments make them.
fn record(designed: &DesignedExample, plant: &Plant, controller: &mut dyn SampledController) -> Recording {
    let procedure = designed.project.verify.as_ref().map(|verify| &verify.procedure);
    let step = procedure.map_or(0.1, |procedure| procedure.step.rate_rad_s.abs());
    let size = |of: f64| [(0.4 * of, 0.8), (0.2 * of, 2.9)];
    let moves = |amplitude: Option<f64>| sines(&size(amplitude.unwrap_or(0.0)));
    let sensors = &plant.parameters().sensors;
    let carried = |is_fitted: bool, amplitude: Option<f64>| moves(amplitude.filter(|_| is_fitted));
    let platform = PlatformMotion {
        pitch_rate_rad_s: carried(sensors.platform_gyro.is_fitted(), procedure.map(|p| p.pitch.amplitude)),
        heave_m_s2: carried(sensors.platform_accelerometer.is_fitted(), procedure.map(|p| p.heave.amplitude)),
        initial_angle_rad: 0.0,
        further: None,
    };
    let period_s = plant.parameters().interface.sample_period_s;
    let scenario = Scenario {
        duration_s: LENGTH_S.min(SAMPLES * period_s),
        demand_rad_s: sines(&[(0.4 * step, 0.31), (0.15 * step, 1.7)]),
        injection_v: Signal::ZERO,
        platform,
        imperfections: Imperfections::NoiseAndQuantisation { seed: 5 },
        initial: Initial::Rest { hub_angle_rad: designed.project.model.operating_point.hub_angle_rad },
        detail: Detail::Recording,
        firing: Firing::Stated,
    };
    let history = Simulator::new(plant).unwrap().run(controller, &scenario).unwrap();
    history.readings.recording("run", history.sample_period_s)
}

/// The project of an example that says that its recordings were made under the controller of a file.
fn replaying(path: &Path, designed: &DesignedExample, plant: &Plant) -> Project {
    let text = |value: &str| SettingValue::Text(value.to_owned());
    let name = path.file_name().unwrap().to_str().unwrap();
    let document = Document::from_bytes(&std::fs::read(path).unwrap(), name).unwrap();
    let document = document
        .set("recording_controller.kind", &text("exported"))
        .and_then(|it| it.set("recording_controller.file", &text("controller.json")))
        .unwrap();
    let file = controller_file(&designed.project, &designed.made.sampled.controller);
    let folder = path.parent().unwrap();
    let attach = |all: Attachments, name: String| match std::fs::read(folder.join(&name)) {
        Ok(bytes) => all.with(&name, bytes),
        Err(_) => all,
    };
    let attached = document.attachments().into_iter().fold(Attachments::none(), attach);
    let attached = attached.with("controller.json", file.into_bytes());
    let mut project = Project::resolve_for(&document, &attached, Purpose::Replay).unwrap().project;
    let recorded = plant.parameters();
    (project.plant.interface, project.plant.sensors) = (recorded.interface.clone(), recorded.sensors.clone());
    project
}

fn replay_recording(project: &Project, recording: Recording) -> ReplayedRecording {
    let controller = recording_controller(project).unwrap();
    let read = read_recording(project, controller.as_ref(), recording, GapTreatment::Repaired).unwrap();
    let control = control_for(project, controller.as_ref(), read.iter().map(|item| &item.recording));
    assert!(read.iter().all(|item| !item.has_other_controller()), "{:?}", read[0].remarks);
    replay(project, &read, &control, ReplayLength::Automatic).unwrap().remove(0)
}

/// A controller that keeps what it read.
struct ReadingRecorder<C> {
    controller: C,
    readings: Vec<[f64; READINGS]>,
}

impl<C: SampledController> SampledController for ReadingRecorder<C> {
    fn reset(&mut self) {
        self.controller.reset();
        self.readings.clear();
    }

    fn step(&mut self, readings: &Readings) -> f64 {
        self.readings.push(readings.to_array());
        self.controller.step(readings)
    }
}

/// A recording under the fixed-point form of a controller that read so; `None` if it has none.
fn in_fixed_point(
    designed: &DesignedExample,
    plant: &Plant,
    readings: Vec<[f64; READINGS]>,
) -> Option<Recording> {
    let controller: &Controller = &designed.made.sampled.controller;
    let length = readings.len();
    let ranges = Ranges::from_readings(controller, &[readings], RANGE_MARGIN);
    let half_step_v = 10.0 / f64::from(plant.parameters().interface.output_bits).exp2();
    let fixed = plan_fixed_point(controller, &ranges, half_step_v, length).ok()?;
    Some(record(designed, plant, &mut FixedRunner::new(&fixed)))
}

/// Returns what is wrong with the replays of an example's recordings; `None` if it designs no controller.
fn wrong(path: &Path) -> Option<Vec<String>> {
    let designed = examples::design_example(path)?;
    let procedure = designed.project.verify.as_ref().map(|verify| verify.procedure.step.rate_rad_s.abs());
    let plant = recorded_plant(&designed, procedure.unwrap_or(0.1));
    let project = replaying(path, &designed, &plant);
    let controller = &designed.made.sampled.controller;
    let mut kept = ReadingRecorder { controller: controller.runner(), readings: Vec::new() };
    let double = record(&designed, &plant, &mut kept);
    let name = examples::name(path);
    let mut recordings = vec![("double", double)];
    if IN_EVERY_NUMBERS.contains(&name.as_str()) || examples::every_one_is_asked_for() {
        let fixed = in_fixed_point(&designed, &plant, kept.readings);
        recordings.extend(fixed.map(|fixed| ("fixed point", fixed)));
        recordings.push(("single", record(&designed, &plant, &mut controller.runner_in::<f32>())));
    }
    let mut wrong = Vec::new();
    for (numbers, recording) in recordings {
        let found = replay_recording(&project, recording);
        for fit in &found.followed.replay.channels {
            let ratio = fit.rms_error / fit.floor;
            if ratio.is_nan() || ratio > REPLAYED {
                let channel = fit.channel.name();
                wrong.push(format!(
                    "{name}, {numbers}: {ratio:.2} floors in {channel}, {:?}",
                    found.followed.mode
                ));
            }
        }
    }
    Some(wrong)
}

#[test]
fn examples_replay_their_own_recordings() {
    let files = examples::chosen_files();
    let found = Mutex::new(Vec::new());
    counterpoise_tests::run_in_parallel(files.len(), &|k| found.lock().unwrap().extend(wrong(&files[k])));
    let found = found.into_inner().unwrap();
    assert!(found.len() >= 8, "{} examples design a controller", found.len());
    assert!(found.iter().all(Vec::is_empty), "{}", found.concat().join("\n"));
}
