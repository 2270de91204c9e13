//! The analyser's map against two linear models, and the same instrument on a run of itself.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use counterpoise_pipeline::studies::fra::{Analyser, LoopController, LoopUnderTest, MeasurementPlan};
use counterpoise_pipeline::studies::fra_plan::usual_frequencies_hz;
use counterpoise_pipeline::studies::fra_points::ResponseMapPoint;
use counterpoise_pipeline::{build_plant_model, with_chosen_weights};
use counterpoise_pool::Serial;
use counterpoise_project::{Attachments, Document, Project, Purpose};
use counterpoise_recordings::{Channel, Recording};

fn rig() -> Project {
    Project::parse(include_str!("../../project/tests/data/rig.toml"), "rig.toml").unwrap().project
}

fn db(h: [f64; 2]) -> f64 {
    20.0 * h[0].hypot(h[1]).log10()
}

fn map_response(around: LoopUnderTest, amplitudes: &[f64], frequencies_hz: &[f64]) -> Vec<ResponseMapPoint> {
    let project = rig();
    let modelled = build_plant_model(&project).unwrap();
    let plan = MeasurementPlan {
        around,
        amplitudes: amplitudes.to_vec(),
        frequencies_hz: frequencies_hz.to_vec(),
        offset_m: 0.0,
    };
    let analyser = Analyser::new(&project, &modelled, &plan, LoopController::Simulation).unwrap();
    analyser.compare(&analyser.measure(&plan, &Serial).unwrap(), &Serial).unwrap().points.iter().collect()
}

#[test]
fn the_describing_function_explains_what_the_linear_model_does_not() {
    for p in map_response(LoopUnderTest::Plant, &[0.5, 1.0], &[4.5, 9.5]) {
        let described = (db(p.describing.unwrap()) - p.gain_db).abs();
        assert!(p.settled && described < 0.1, "{} V, {} Hz: {described} dB", p.amplitude, p.frequency_hz);
        assert!((db(p.linear) - p.gain_db).abs() > 5.0 * described, "{} V", p.amplitude);
    }
}

/// A voice-coil stage without friction, in a loop of position on a sliding axis.
const STAGE: &str = "format = 2
    plant.axis = \"linear\"
    plant.mass = 0.35
    plant.motor = { torque_constant = 12.0 }
    plant.drive = { kind = \"current\", limit = 4.0 }
    plant.sensors.encoder = { resolution = 5e-8 }
    plant.interface = { sample_period = 1e-3 }";

#[test]
fn a_linear_loop_of_position_is_measured_as_its_model_says() {
    let document = Document::parse(STAGE, "stage.toml");
    let read = Project::resolve_for(&document, &Attachments::none(), Purpose::Design).unwrap();
    let project = with_chosen_weights(&read.project).unwrap().unwrap().project;
    let modelled = build_plant_model(&project).unwrap();
    let plan = MeasurementPlan {
        around: LoopUnderTest::Closed,
        amplitudes: vec![1e-4],
        frequencies_hz: vec![1.0, 3.0, 10.0],
        offset_m: 0.0,
    };
    let analyser = Analyser::new(&project, &modelled, &plan, LoopController::Simulation).unwrap();
    let points = analyser.compare(&analyser.measure(&plan, &Serial).unwrap(), &Serial).unwrap().points;
    for p in points.iter() {
        let off = (db(p.linear) - p.gain_db).abs();
        assert!(
            p.settled && off < 0.02,
            "{} Hz: {} dB, linear {} dB",
            p.frequency_hz,
            p.gain_db,
            db(p.linear)
        );
    }
}

/// A mass that nothing holds, in a loop of position.
const FREE: &str = "format = 2
    plant.inertia = 0.02
    plant.drive = { limit = 6.0 }
    plant.sensors.resolver = { noise = \"2 arcsec\" }
    plant.interface = { sample_period = 0.5e-3 }";

/// A hanging pendulum: about the horizontal it is another machine than about its rest.
const PENDULUM: &str = "format = 2
    model.hub_angle = -1.5707963
    plant.lumped = { hub_inertia = 0.007, out_of_balance = 0.05 }
    plant.motor = { inertia = 0.012, torque_constant = 1.6, resistance = 4.0 }
    plant.drive = { kind = \"voltage\", limit = 12.0 }
    plant.friction.pivot = { viscous = 0.012 }
    plant.sensors.encoder = { counts = 65536 }
    plant.interface = { sample_period = 2e-3 }";

fn design_project(text: &str) -> Project {
    let document = Document::parse(text, "project.toml");
    let read = Project::resolve_for(&document, &Attachments::none(), Purpose::Design).unwrap();
    with_chosen_weights(&read.project).unwrap().unwrap().project
}

fn mapped_of(project: &Project, around: LoopUnderTest, frequencies_hz: &[f64]) -> Vec<ResponseMapPoint> {
    let modelled = build_plant_model(project).unwrap();
    let amplitudes = vec![around.usual_amplitudes(project)[0]];
    let plan = MeasurementPlan { around, amplitudes, frequencies_hz: frequencies_hz.to_vec(), offset_m: 0.0 };
    let analyser = Analyser::new(project, &modelled, &plan, LoopController::Simulation).unwrap();
    analyser.compare(&analyser.measure(&plan, &Serial).unwrap(), &Serial).unwrap().points.iter().collect()
}

#[test]
fn a_mass_that_nothing_holds_does_not_drift_out_of_its_response() {
    let project = design_project(FREE);
    let torque_per_v = 6.0 / 10.0;
    for p in mapped_of(&project, LoopUnderTest::Plant, &[0.5, 2.0, 10.0]) {
        let rate = std::f64::consts::TAU * p.frequency_hz;
        let closed_form = 20.0 * (torque_per_v / (0.02 * rate * rate)).log10();
        let off = (p.gain_db - closed_form).abs();
        assert!(p.settled && off < 0.01, "{} Hz: {} dB, {closed_form} dB", p.frequency_hz, p.gain_db);
        assert!(p.distortion < 1e-3, "{}", p.distortion);
    }
}

#[test]
fn a_loop_of_position_is_measured_where_the_machine_rests() {
    let project = design_project(PENDULUM);
    for p in mapped_of(&project, LoopUnderTest::Closed, &[0.5, 2.0]) {
        let off = (db(p.linear) - p.gain_db).abs();
        assert!(off < 0.02, "{} Hz: {} dB, linear {} dB", p.frequency_hz, p.gain_db, db(p.linear));
        assert!((p.mean_rad_s + std::f64::consts::FRAC_PI_2).abs() < 1e-3, "{}", p.mean_rad_s);
    }
}

#[test]
fn usual_points_suit_the_machine() {
    let mut project = design_project(FREE);
    assert_eq!(LoopUnderTest::usual_of(&project), LoopUnderTest::Closed);
    assert_eq!(LoopUnderTest::usual_of(&rig()), LoopUnderTest::Disturbance);
    let step = project.verify.as_ref().unwrap().procedure.step.rate_rad_s;
    let demanded = LoopUnderTest::Closed.usual_amplitudes(&project);
    assert!((demanded[3] / step - 1.0).abs() < 1e-12, "{demanded:?}");
    project.plant.interface.sample_period_s = 0.05;
    let highest = usual_frequencies_hz(&project).into_iter().fold(0.0, f64::max);
    assert!(highest < 10.0 && highest > 5.0, "{highest} Hz at 20 Hz");
}

#[test]
fn a_map_has_arrays_of_frequency_and_amplitude_and_its_json_a_list_of_points() {
    let project = rig();
    let modelled = build_plant_model(&project).unwrap();
    let (amplitudes, frequencies_hz) = (vec![0.5, 1.0], vec![4.5, 9.5, 12.0]);
    let plan = MeasurementPlan { around: LoopUnderTest::Plant, amplitudes, frequencies_hz, offset_m: 0.0 };
    let analyser = Analyser::new(&project, &modelled, &plan, LoopController::Simulation).unwrap();
    let map = analyser.compare(&analyser.measure(&plan, &Serial).unwrap(), &Serial).unwrap();
    assert_eq!(map.points.response.dim(), (3, 2));
    assert_eq!(map.points.amplitude.column(1).to_vec(), [1.0; 3]);
    let in_json = serde_json::to_value(&map.points).unwrap();
    let places: Vec<_> =
        in_json.as_array().unwrap().iter().map(|p| p["amplitude"].as_f64().unwrap()).collect();
    assert_eq!(places, [0.5, 0.5, 0.5, 1.0, 1.0, 1.0]);
    assert_eq!(in_json[4]["gain_db"].as_f64().unwrap(), map.points.gain_db()[(1, 1)]);
}

#[test]
fn friction_carries_the_disconnected_mechanism_at_small_amplitudes() {
    let points = map_response(LoopUnderTest::Disconnected, &[0.002, 0.5], &[1.0]);
    assert!(points[0].gain_db > points[1].gain_db + 1.0, "{} {}", points[0].gain_db, points[1].gain_db);
}

#[test]
fn a_recording_without_a_line_is_told_and_a_missing_channel_refused() {
    let project = rig();
    let modelled = build_plant_model(&project).unwrap();
    let plan = MeasurementPlan {
        around: LoopUnderTest::Plant,
        amplitudes: Vec::new(),
        frequencies_hz: Vec::new(),
        offset_m: 0.0,
    };
    let analyser = Analyser::new(&project, &modelled, &plan, LoopController::Recording).unwrap();
    let tone = |k: u32, hz: f64| (std::f64::consts::TAU * hz * f64::from(k) * 1e-3).sin();
    let tones = |gain: f64| (0..5000).map(|k| gain * tone(k, 5.0)).collect::<Vec<f64>>();
    let mut recording =
        Recording::new("tone", 1e-3).with(Channel::Control, tones(1.0)).with(Channel::HubRate, tones(0.02));
    let points = analyser.measure_recording(&recording, &[5.0, 8.0]).unwrap().points;
    assert!(points.settled[(0, 0)] && (points.at(0, 0).gain_db - 20.0 * 0.02_f64.log10()).abs() < 1e-6);
    assert!(!points.settled[(1, 0)]);
    recording.remove(Channel::Control);
    let refused = analyser.measure_recording(&recording, &[5.0]).unwrap_err().to_string();
    assert!(refused.contains("tone") && refused.contains("control"), "{refused}");
}
