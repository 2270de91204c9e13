//! Free functions through the simulator: machines with physics that the library does not have are modelled, and the curves are read.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::common;

use common::controller;
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
use counterpoise_recordings::Recording;
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
    let base = reference::rig();
    let recordings = recordings(machine);
    let prepared = PreparedRecordings::new(&recordings, &base);
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
    let components = [Component::Pivot];
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

#[test]
fn a_machine_as_modelled_is_given_no_function() {
    assert_eq!(learn_model(&reference::rig()), None);
}
