//! Free functions through the simulator: machines with physics that the library does not have are modelled, and the curves are read.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::common;

use common::controller;
use counterpoise_controller::{ProportionalIntegral, Readings, SampledController};
use counterpoise_diagnose::fitting::score::assess_recordings;
use counterpoise_diagnose::learning::reading::CurveForm;
use counterpoise_diagnose::learning::visited_ranges::VisitedRanges;
use counterpoise_diagnose::learning::{LearnedModel, LearningTask, learn_functions};
use counterpoise_diagnose::library::Component;
use counterpoise_diagnose::selection::searcher::Searcher;
use counterpoise_diagnose::selection::sizes::Sizes;
use counterpoise_diagnose::simulator_access::SimulatorAccess;
use counterpoise_diagnose::simulator_access::objective::{PreparedRecordings, RecordingReplays};
use counterpoise_models::{LearnedElement, LearnedPlace, LearnedQuantity, RegimeVariable};
use counterpoise_models::{Parameters, Plant, reference};
use counterpoise_pool::Serial;
use counterpoise_recordings::{Channel, Recording};
use counterpoise_simulate::replay::ReplayLoop;
use counterpoise_simulate::{Detail, Imperfections, Scenario, Signal, Simulator};

/// Control that holds the rig's weight, V.
const BIAS_V: f64 = 2.88;

/// A function of the relative angle on many points, which those of a fit do not meet.
fn over_angle(quantity: LearnedQuantity, of: impl Fn(f64) -> f64) -> LearnedElement {
    let points: Vec<f64> = (0..201).map(|k| 0.15 * (f64::from(k) / 100.0 - 1.0)).collect();
    let values = points.iter().map(|x| of(*x)).collect();
    let element = LearnedElement::neutral(LearnedPlace::Pivot, quantity, RegimeVariable::Angle, points);
    LearnedElement { values, ..element }
}

/// Triangle waves of two periods, and a slower one of another size, from rest.
fn recordings(machine: &Parameters) -> Vec<Recording> {
    let one = |(k, (amplitude, period_s)): (usize, (f64, f64))| {
        let mut simulator = Simulator::new(&Plant::from_lumped(machine).unwrap()).unwrap();
        let scenario = Scenario {
            demand_rad_s: Signal::Triangle { amplitude, period_s },
            imperfections: Imperfections::NoiseAndQuantisation { seed: 11 + k as u64 },
            detail: Detail::Recording,
            ..Scenario::at_rest(4.0)
        };
        let history = simulator.run(&mut controller(BIAS_V), &scenario).unwrap();
        history.readings.recording("triangle", 1e-3)
    };
    [(0.15, 2.0), (0.12, 1.3), (0.08, 2.6)].into_iter().enumerate().map(one).collect()
}

fn learn_model(machine: &Parameters) -> Option<(LearnedModel, Parameters)> {
    learn_from(&recordings(machine), Component::Pivot)
}

/// Models what the reference rig lacks of recordings, located at a component.
fn learn_from(recordings: &[Recording], located: Component) -> Option<(LearnedModel, Parameters)> {
    let base = reference::rig();
    let prepared = PreparedRecordings::new(recordings, &base);
    let simulator = RecordingReplays::new(&base, &ReplayLoop::from(&controller(BIAS_V)), &prepared).unwrap();
    let searcher = Searcher {
        simulator: &simulator,
        pool: &Serial,
        base: &base,
        effects: Vec::new(),
        seeds: Vec::new(),
        sizes: Sizes::TYPICAL,
    };
    let before = assess_recordings(&simulator, &Serial, &base).unwrap();
    let signals: Vec<_> = (0..recordings.len()).filter_map(|r| simulator.measured_signals(r)).collect();
    let visited = VisitedRanges::of(&base, &signals);
    let components = [located];
    learn_functions(&LearningTask {
        searcher: &searcher,
        base: &base,
        before: &before,
        map: &[],
        components: &components,
        visited: &visited,
    })
}

#[test]
fn a_tight_spot_is_modelled_to_the_noise_and_read_with_its_place() {
    let (height, centre, width) = (0.8, 0.02, 0.02);
    let bump = |x: f64| 1.0 + height * (-((x - centre) / width).powi(2)).exp();
    let mut machine = reference::rig();
    machine.learned.push(over_angle(LearnedQuantity::FrictionLevel, bump));
    let (model, improved) = learn_model(&machine).unwrap();
    let part = &model.parts[0];
    let element = &part.element;
    println!("held out {:?}, power left {:.4}, {element:?}", model.worst_held_out, model.power_left);
    assert_eq!((element.place, element.quantity), (LearnedPlace::Pivot, LearnedQuantity::FrictionLevel));
    assert_eq!(element.variable, RegimeVariable::Angle);
    assert!(model.worst_held_out[0] > 2.0 && model.worst_held_out[1] < 1.5, "{:?}", model.worst_held_out);
    let reading = part.reading.as_ref().unwrap();
    println!("{reading:?}");
    assert_eq!(reading.form, CurveForm::Bump);
    assert!((reading.value("centre") - centre).abs() < 0.004, "{reading:?}");
    assert!((reading.value("height") - height).abs() < 0.2 * height, "{reading:?}");
    // the function is part of the machine that is saved
    assert_eq!(improved.learned.len(), model.parts.len());
    assert_eq!(improved.learned[0].values, element.values);
}

#[test]
fn a_drag_with_the_cube_of_the_rate_is_held_to_its_form_and_goes_on_beyond_the_recordings() {
    let drag = |rate: f64| -30.0 * (rate / 0.15).powi(3);
    let points: Vec<f64> = (0..201).map(|k| 0.4 * (f64::from(k) / 100.0 - 1.0)).collect();
    let values = points.iter().map(|x| drag(*x)).collect();
    let torque = LearnedQuantity::Torque;
    let element = LearnedElement::neutral(LearnedPlace::Pivot, torque, RegimeVariable::Rate, points);
    let mut machine = reference::rig();
    machine.learned.push(LearnedElement { values, ..element });
    let (model, improved) = learn_model(&machine).unwrap();
    let part = &model.parts[0];
    println!("{:?}, held out {:?}", part.reading, model.worst_held_out);
    assert_eq!(model.parts.len(), 1);
    assert!(model.worst_held_out[0] > 3.0 && model.worst_held_out[1] < 1.5, "{:?}", model.worst_held_out);
    let reading = part.reading.as_ref().unwrap();
    assert_eq!(reading.form, CurveForm::Cubic);
    let found = &improved.learned[0];
    assert_eq!(found, &part.element);
    let [visited, beyond] = [0.1, 0.2].map(|rate| {
        let at = found.points.iter().position(|x| *x >= rate).expect("a point beyond the recordings");
        (found.values[at] / drag(found.points[at]), found.coverage[at])
    });
    println!("{visited:?} {beyond:?}");
    assert!((visited.0 - 1.0).abs() < 0.05 && (beyond.0 - 1.0).abs() < 0.1);
    assert!(visited.1 > 0.0 && beyond.1 == 0.0);
}

/// A loop whose gyroscope shows nothing within a band about zero, and beyond it lacks the band; its noise comes after.
struct DeadBandLoop {
    inner: ProportionalIntegral,
    band_rad_s: f64,
    shown: Vec<f64>,
    noise: u64,
}

impl DeadBandLoop {
    /// Returns noise of unit variance: the sum of twelve uniform numbers of a linear congruence less their mean.
    fn noise(&mut self) -> f64 {
        let mut uniform = || {
            self.noise =
                self.noise.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.noise >> 11) as f64 / (1u64 << 53) as f64
        };
        (0..12).map(|_| uniform()).sum::<f64>() - 6.0
    }
}

impl SampledController for DeadBandLoop {
    fn reset(&mut self) {
        self.inner.reset();
    }

    fn step(&mut self, readings: &Readings) -> f64 {
        let rate = readings.hub_rate_rad_s;
        let passed = (rate.abs() - self.band_rad_s).max(0.0).copysign(rate);
        let step = 20.0 / 65536.0 / 10.0;
        let shown = ((passed + 2e-4 * self.noise()) / step).round() * step;
        self.shown.push(shown);
        self.inner.step(&Readings { hub_rate_rad_s: shown, ..*readings })
    }
}

#[test]
fn a_dead_band_of_the_gyroscope_is_located_modelled_and_read_with_its_width() {
    let band_rad_s = 4e-3;
    let mut machine = reference::rig();
    machine.sensors.hub_gyro.noise_rms = 0.0;
    let one = |(k, (amplitude, period_s)): (u64, (f64, f64))| {
        let mut simulator = Simulator::new(&Plant::from_lumped(&machine).unwrap()).unwrap();
        let scenario = Scenario {
            demand_rad_s: Signal::Triangle { amplitude, period_s },
            imperfections: Imperfections::NoiseAndQuantisation { seed: 31 + k },
            detail: Detail::Recording,
            ..Scenario::at_rest(4.0)
        };
        let mut control =
            DeadBandLoop { inner: controller(BIAS_V), band_rad_s, shown: Vec::new(), noise: 7 + k };
        let history = simulator.run(&mut control, &scenario).unwrap();
        let mut recording = history.readings.recording("triangle", 1e-3);
        recording.samples_mut(Channel::HubRate).unwrap().copy_from_slice(&control.shown);
        recording
    };
    let recordings: Vec<Recording> = (0..).zip([(0.12, 2.0), (0.08, 1.3), (0.03, 2.6)]).map(one).collect();
    let (model, improved) = learn_from(&recordings, Component::HubGyro).unwrap();
    let part = &model.parts[0];
    println!("{:?}, held out {:?}, {:?}", part.reading, model.worst_held_out, part.element);
    assert_eq!(
        (part.element.place, part.element.quantity),
        (LearnedPlace::LoopSensor, LearnedQuantity::Error)
    );
    assert!(model.worst_held_out[0] > 5.0 && model.worst_held_out[1] < 1.5, "{:?}", model.worst_held_out);
    let reading = part.reading.as_ref().unwrap();
    assert_eq!(reading.form, CurveForm::DeadBand);
    assert!((reading.value("distance") - band_rad_s).abs() < 0.05 * band_rad_s, "{reading:?}");
    assert!((reading.value("slope") + 1.0).abs() < 0.1, "{reading:?}");
    assert_eq!(improved.learned[0].values, part.element.values);
}

#[test]
fn a_machine_as_modelled_is_given_no_function() {
    assert_eq!(learn_model(&reference::rig()), None);
}
