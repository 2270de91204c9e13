//! The frequency response analyser, on the nonlinear simulation and on recordings.
//!
//! A sine of one frequency and amplitude is put in, the motion is let settle, and input and output are compared at the
//! fundamental over whole cycles, as a bench instrument does; mean and harmonics are returned as well. [`measure_point`] does
//! one point: a map of amplitudes and frequencies is as many independent calls. [`analyser::cycle_response`] does the same
//! on the columns of a recording.
//!
//! Sampled columns are compared: the response from the control or the demand includes the converter's hold, that
//! between the gyroscopes has both sensors in it.

pub mod analyser;

pub use analyser::{HarmonicSpectrum, MeasuredResponse, cycle_response, harmonic_spectrum};

use crate::ensemble::{EnsembleRun, RunObserver, run_ensemble};
use crate::fra::analyser::Analyser;
use crate::history::{ReadingColumns, TimeHistory};
use crate::run::Simulator;
use crate::tolerance::MOST_SAMPLES;
use crate::{Detail, Error, Imperfections, Initial, PlatformMotion, Scenario, Signal, Sine};
use counterpoise_controller::{Readings, SampledController};
use counterpoise_models::{OperatingPoint, Parameters, Plant};
use std::f64::consts::TAU;

/// Loop that a frequency response test excites and measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Test {
    /// From the control (V) to the hub gyroscope (rad/s), without a controller: a constant control holds the weight.
    Plant,
    /// From the demand to the hub gyroscope, with the controller (rad/s over rad/s).
    ClosedLoop,
    /// From the platform gyroscope to the hub gyroscope, with the controller: the disturbance rejection ratio.
    PlatformToHub,
}

impl Test {
    /// Returns what is excited.
    fn input(self, columns: &ReadingColumns) -> &[f64] {
        match self {
            Self::Plant => columns.control_v(),
            Self::ClosedLoop => columns.demand_rad_s(),
            Self::PlatformToHub => columns.platform_rate_rad_s(),
        }
    }
}

/// The settings of the instrument.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Least number of cycles in a measurement.
    pub cycles: usize,
    /// Least duration of a measurement, s: at high frequencies more cycles are taken.
    pub least_duration_s: f64,
    /// Change of the response from one window to the next, relative to it, below which the motion has settled.
    pub settled_below: f64,
    /// Most windows that are waited for.
    pub most_windows: usize,
    /// Imperfections of sensors and converters that are simulated.
    pub imperfections: Imperfections,
    /// Angle of the mechanism, rad.
    pub hub_angle_rad: f64,
    /// Heave per pitch acceleration, m: a mechanism mounted that far in front of the simulator's axis.
    pub offset_m: f64,
    /// Whether a measurement keeps its signals.
    pub keeps_signals: bool,
}

impl Default for Settings {
    /// Two cycles and half a second a window, settled to 0.2 percent within 16 windows, noiseless, level, on the axis.
    fn default() -> Self {
        Self {
            cycles: 2,
            least_duration_s: 0.5,
            settled_below: 2e-3,
            most_windows: 16,
            imperfections: Imperfections::None,
            hub_angle_rad: 0.0,
            offset_m: 0.0,
            keeps_signals: false,
        }
    }
}

/// The sine of one measurement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TestSine {
    /// Angular frequency, rad/s.
    pub frequency_rad_s: f64,
    /// Amplitude: V for the plant, rad/s otherwise.
    pub amplitude: f64,
}

/// A point of a frequency response.
#[derive(Debug, Clone, PartialEq)]
pub struct Measurement {
    /// Amplitude of the excitation: V for the plant, rad/s otherwise.
    pub amplitude: f64,
    /// The response over the last window.
    pub response: MeasuredResponse,
    /// Relative change of the response from the window before.
    pub last_change: f64,
    /// `true` if that is below what the settings ask for; if not, the motion had not settled when the windows ran out.
    pub settled: bool,
    /// Simulated time for this point, s, until the mechanism had settled.
    pub simulated_s: f64,
    /// The signals over the last two windows; `None` unless they were asked for.
    pub signals: Option<MeasurementSignals>,
}

/// The signals between which a response is measured, over the last two windows.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasurementSignals {
    /// Sample period, s.
    pub period_s: f64,
    /// What is excited.
    pub input: Vec<f64>,
    /// What is measured.
    pub output: Vec<f64>,
}

/// Measures one point. The frequency is moved to the nearest one of which whole cycles fill whole samples: by less
/// than a sample in a window.
///
/// # Errors
/// An amplitude or frequency that is not positive, a frequency above the Nyquist frequency, and what
/// [`crate::run()`] refuses.
pub fn measure_point(
    plant: &Plant,
    controller: &mut dyn SampledController,
    test: Test,
    at: TestSine,
    settings: &Settings,
) -> Result<Measurement, Error> {
    let point = PlannedPoint { controller, at };
    let mut found = measure_each(plant, test, &mut [point], settings);
    found.pop().unwrap_or(Err(Error::Length { what: "the points", found: 0, expected: 1 }))
}

/// A point that is to be measured.
pub struct PlannedPoint<'a> {
    /// The controller in the loop; it is reset.
    pub controller: &'a mut dyn SampledController,
    /// The sine.
    pub at: TestSine,
}

/// Measures several points of one plant side by side: the same bytes as one after the other. Neighbours whose windows are of similar
/// length take the least time.
///
/// # Errors
/// Point by point, as [`measure_point`].
pub fn measure_each(
    plant: &Plant,
    test: Test,
    points: &mut [PlannedPoint],
    settings: &Settings,
) -> Vec<Result<Measurement, Error>> {
    let tests = points.iter().map(|point| TestRun::new(plant, test, point.at, settings));
    let mut tests: Vec<Result<TestRun, Error>> = tests.collect();
    let mut variants = Vec::with_capacity(points.len());
    for (test, point) in tests.iter_mut().zip(points) {
        let Ok(test) = test else { continue };
        point.controller.reset();
        variants.push(test.variant(&mut *point.controller));
    }
    let mut histories = run_ensemble(&mut variants).into_iter();
    drop(variants);
    let measurement = |test: Result<TestRun, Error>| {
        let test = test?;
        let missing = Error::Length { what: "the points", found: 0, expected: 1 };
        test.measurement(&histories.next().unwrap_or(Err(missing))?)
    };
    tests.into_iter().map(measurement).collect()
}

/// The run of one point.
struct TestRun {
    test: Test,
    at: TestSine,
    window: Window,
    scenario: Scenario,
    simulator: Simulator,
    settled_below: f64,
    keeps_signals: bool,
    /// The source that acts in place of the controller if there is none.
    holding: Option<ConstantControl>,
}

impl TestRun {
    fn new(plant: &Plant, test: Test, at: TestSine, settings: &Settings) -> Result<Self, Error> {
        let TestSine { frequency_rad_s, amplitude } = at;
        if !(amplitude > 0.0 && amplitude.is_finite()) {
            return Err(Error::Range { what: "amplitude", value: amplitude, allowed: "positive and finite" });
        }
        let period = plant.parameters().interface.sample_period_s;
        let window = Window::new(frequency_rad_s, period, settings)?;
        let most = settings.most_windows.max(3);
        let simulator = Simulator::new(plant)?;
        let sine = TestSine { frequency_rad_s: window.frequency_rad_s, amplitude };
        let scenario = Scenario {
            duration_s: (most * window.samples) as f64 * period,
            ..scenario_of(test, sine, &simulator, settings)
        };
        let point = OperatingPoint { hub_angle_rad: settings.hub_angle_rad, platform_angle_rad: 0.0 };
        let holding = (test == Test::Plant).then(|| ConstantControl(plant.equilibrium(&point).control_v));
        let &Settings { settled_below, keeps_signals, .. } = settings;
        Ok(Self { test, at, window, scenario, simulator, settled_below, keeps_signals, holding })
    }

    /// Returns the run for an ensemble.
    fn variant<'a>(&'a mut self, controller: &'a mut dyn SampledController) -> EnsembleRun<'a> {
        let Self { test, window, scenario, simulator, settled_below, holding, .. } = self;
        let every = window.samples;
        let mut settling = Settling { test: *test, window, allowed: *settled_below, last: None };
        let goes_on = Box::new(move |readings: &ReadingColumns| settling.goes_on(readings));
        let controller = match holding {
            Some(holding) => holding as &mut dyn SampledController,
            None => controller,
        };
        EnsembleRun { simulator, controller, scenario, watch: Some(RunObserver { every, goes_on }) }
    }

    fn measurement(self, history: &TimeHistory) -> Result<Measurement, Error> {
        let Self { test, window, .. } = self;
        let windows = history.len() / window.samples;
        let last = window.response(test, &history.readings, windows - 1)?;
        let before = window.response(test, &history.readings, windows - 2)?;
        let last_change = (last.value - before.value).norm() / last.value.norm();
        Ok(Measurement {
            amplitude: self.at.amplitude,
            response: last,
            last_change,
            settled: last_change <= self.settled_below,
            simulated_s: history.len() as f64 * history.sample_period_s,
            signals: self.keeps_signals.then(|| MeasurementSignals {
                period_s: history.sample_period_s,
                input: test.input(&history.readings)[(windows - 2) * window.samples..].to_vec(),
                output: history.readings.hub_rate_rad_s()[(windows - 2) * window.samples..].to_vec(),
            }),
        })
    }
}

/// The test that the motion has settled, asked at the end of every window: one run serves them all.
struct Settling<'a> {
    test: Test,
    window: &'a Window,
    allowed: f64,
    last: Option<MeasuredResponse>,
}

impl Settling<'_> {
    fn goes_on(&mut self, readings: &ReadingColumns) -> bool {
        let windows = readings.control_v().len() / self.window.samples;
        let found = self.window.response(self.test, readings, windows - 1).ok();
        let change = match (&found, &self.last) {
            (Some(now), Some(before)) if windows >= 3 => (now.value - before.value).norm() / now.value.norm(),
            _ => f64::INFINITY,
        };
        self.last = found;
        change.is_nan() || change > self.allowed
    }
}

/// Returns the mechanism with its motor disconnected from the amplifier: no current flows. For the platform-to-hub test, on a
/// balanced mechanism: an unbalanced one falls.
///
/// # Errors
/// A mechanism with lumped inertias that is out of balance.
pub fn disconnect_motor(parameters: &Parameters) -> Result<Parameters, Error> {
    let mut open = parameters.clone();
    if let Some(lumped) = &open.lumped
        && (lumped.out_of_balance_kg_m, lumped.vertical_offset_kg_m) != (0.0, 0.0)
    {
        let allowed = "0 with the motor disconnected: nothing holds the weight";
        return Err(Error::Range { what: "out_of_balance_kg_m", value: lumped.out_of_balance_kg_m, allowed });
    }
    open.motor.torque_constant_nm_a = f64::MIN_POSITIVE;
    open.motor.back_emf_v_s_rad = 0.0;
    Ok(open)
}

/// A window of whole cycles and whole samples.
struct Window {
    samples: usize,
    frequency_rad_s: f64,
    analyser: Analyser,
}

impl Window {
    fn new(frequency_rad_s: f64, period_s: f64, settings: &Settings) -> Result<Self, Error> {
        let nyquist = 0.5 * TAU / period_s;
        if !(frequency_rad_s > 0.0 && frequency_rad_s < nyquist) {
            let allowed = "above 0 and below the Nyquist frequency";
            return Err(Error::Range { what: "frequency_rad_s", value: frequency_rad_s, allowed });
        }
        let wanted = settings.least_duration_s * frequency_rad_s / TAU;
        let cycles = wanted.ceil().max(settings.cycles.max(1) as f64);
        let samples = (cycles * TAU / (frequency_rad_s * period_s)).round();
        let most = settings.most_windows.max(3) as f64 * samples;
        if most > MOST_SAMPLES {
            let allowed = "up to 1e8 samples";
            return Err(Error::Range { what: "duration_s", value: most * period_s, allowed });
        }
        let (frequency_rad_s, samples) = (cycles * TAU / (samples * period_s), samples as usize);
        let analyser = Analyser::new(samples, period_s, frequency_rad_s, usize::MAX)?;
        Ok(Self { samples, frequency_rad_s, analyser })
    }

    fn response(
        &self,
        test: Test,
        columns: &ReadingColumns,
        index: usize,
    ) -> Result<MeasuredResponse, Error> {
        let input = test.input(columns);
        let range = index * self.samples..(index + 1) * self.samples;
        self.analyser.response(&input[range.clone()], &columns.hub_rate_rad_s()[range])
    }
}

/// Returns the run of a sine about the machine at rest.
fn scenario_of(test: Test, sine: TestSine, simulator: &Simulator, settings: &Settings) -> Scenario {
    let TestSine { frequency_rad_s, amplitude } = sine;
    let held = held_demand(simulator, settings);
    let mut scenario = Scenario {
        demand_rad_s: held.clone(),
        imperfections: settings.imperfections,
        initial: Initial::Rest { hub_angle_rad: settings.hub_angle_rad },
        detail: Detail::Recording,
        ..Scenario::at_rest(1.0)
    };
    match test {
        Test::Plant => scenario.injection_v = Signal::Sines(vec![without_drift(sine, simulator.plant())]),
        Test::ClosedLoop => {
            let moved = Signal::sine(amplitude, frequency_rad_s);
            scenario.demand_rad_s = if held.is_zero() { moved } else { Signal::Sum(vec![held, moved]) };
        }
        Test::PlatformToHub => {
            // the rate starts at zero, its angle at the end of its swing
            let angle =
                Sine { amplitude: amplitude / frequency_rad_s, frequency_rad_s, phase_rad: -0.25 * TAU };
            scenario.platform = PlatformMotion::pitch_simulator(&[angle], settings.offset_m);
        }
    }
    scenario
}

/// Returns the demand that holds the machine where it rests: what the loop's sensor shows there if it measures a position, a torque or a
/// current, and no rate.
fn held_demand(simulator: &Simulator, settings: &Settings) -> Signal {
    let at_rest = simulator.rest(settings.hub_angle_rad, 0.0, 0.0).hub_gyro[0];
    if at_rest == 0.0 { Signal::ZERO } else { Signal::Constant(at_rest) }
}

/// Returns the sine of the control of which a mass that nothing holds does not drift away.
///
/// A control that starts as a sine leaves a double integrator with the mean rate A b / w, so its position runs away and
/// hides the swing A b / w^2. With the phase of a cosine half a sample early the held control has no part at zero frequency: the z-transform of
/// cos(w (k + 1/2) T) has a zero at z = 1, which cancels one of the two integrators. A machine whose loop measures no position keeps the
/// sine.
fn without_drift(sine: TestSine, plant: &Plant) -> Sine {
    let parameters = plant.parameters();
    let early = 0.25 * TAU + 0.5 * sine.frequency_rad_s * parameters.interface.sample_period_s;
    let phase_rad = if parameters.sensors.measured.is_position() { early } else { 0.0 };
    Sine { amplitude: sine.amplitude, frequency_rad_s: sine.frequency_rad_s, phase_rad }
}

/// A constant control.
struct ConstantControl(f64);

impl SampledController for ConstantControl {
    fn reset(&mut self) {}

    fn step(&mut self, _readings: &Readings) -> f64 {
        self.0
    }
}
