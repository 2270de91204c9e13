//! The fall of the integrator's error with its step, against a second method.
//!
//! [`study_convergence`] moves a plant under a constant control on a platform that pitches steadily and heaves, with steps of one
//! length only, and compares the hub rate at the end of every longest step with the classical Runge-Kutta method by far shorter
//! steps: another method, on another form of the equations, that finds the instants at which something switches by halving its own
//! steps. Where friction reverses or teeth meet inside a step, no method keeps its order; the integrator finds those instants,
//! which [`Convergence::finding_events`] tells. [`convergence_cases`] has every law of friction, and contact.

mod cases;
mod second_method;

pub use cases::{Case, convergence_cases};

use crate::run::Simulator;
use crate::tolerance::{ANY_DEFECT, CLEAR, EVENT_ROUNDING, TOLERANCE};
use crate::{Detail, Error, Initial, PlatformMotion, Playback, Scenario, Signal};
use counterpoise_models::Plant;

/// Longest steps in a study.
const STEPS: usize = 16;
/// Sample periods of the machine in a longest step; the others are its halves.
const LONGEST_PERIODS: f64 = 8.0;
/// Steps of the second method in a longest one.
const SECOND_STEPS: usize = 1000;
/// Rate of the platform, rad/s, and heave of the pivot, m/s^2 and rad/s.
const PLATFORM: (f64, f64, f64) = (-0.05, 0.5, 13.0);

/// The errors of one plant.
#[derive(Debug, Clone, PartialEq)]
pub struct Convergence {
    /// Lengths of the steps, s, from the longest.
    pub step_s: Vec<f64>,
    /// Largest error of the hub rate at the common instants with steps of that length only, relative to the largest rate.
    pub error: Vec<f64>,
    /// The same with the steps that the integrator chooses, by the sample period and the usual tolerance.
    pub finding_events: Vec<f64>,
    /// Estimated error of the second method: its change when its steps are doubled.
    pub second_method: f64,
}

impl Convergence {
    /// Returns the observed order: slope of the logarithm of the error over that of the step, between the longest step and the
    /// shortest whose error is still ten times that of the second method and above 1e-9; not a number if there are no two of them.
    pub fn order(&self) -> f64 {
        self.slope(&self.error)
    }

    /// Returns the same for [`Convergence::finding_events`].
    pub fn order_finding_events(&self) -> f64 {
        self.slope(&self.finding_events)
    }

    fn slope(&self, error: &[f64]) -> f64 {
        let least = EVENT_ROUNDING.max(CLEAR * self.second_method);
        let clear: Vec<usize> = (0..error.len()).filter(|&k| error[k] > least).collect();
        match (clear.first(), clear.last()) {
            (Some(&a), Some(&b)) if a < b => {
                (error[a] / error[b]).ln() / (self.step_s[a] / self.step_s[b]).ln()
            }
            _ => f64::NAN,
        }
    }
}

/// Returns the errors of a mechanism under a constant control, V, added to the one that holds it, with steps of `lengths` lengths, each half the one before.
///
/// # Errors
/// A mechanism that cannot be simulated.
pub fn study_convergence(plant: &Plant, control_v: f64, lengths: usize) -> Result<Convergence, Error> {
    let longest_s = LONGEST_PERIODS * plant.parameters().interface.sample_period_s;
    let second = |steps: usize| -> Result<Vec<f64>, Error> {
        let (plant, control) = prepare_plant(plant, control_v, longest_s)?;
        let start = Simulator::new(&plant)?.rest(0.0, 0.0, PLATFORM.0);
        second_method::hub_rates(&plant, control, &start.core, longest_s, steps)
    };
    let fine = second(SECOND_STEPS)?;
    let coarse = second(SECOND_STEPS / 2)?;
    let step_s: Vec<f64> = (0..lengths).map(|k| longest_s * 0.5_f64.powi(k as i32)).collect();
    let errors = |tolerance: f64| -> Result<Vec<f64>, Error> {
        let one = |(k, step): (usize, &f64)| {
            let (plant, control) = prepare_plant(plant, control_v, *step)?;
            Ok(distance(&rates(&plant, control, 1 << k, tolerance)?, &fine))
        };
        step_s.iter().enumerate().map(one).collect()
    };
    Ok(Convergence {
        error: errors(ANY_DEFECT)?,
        finding_events: errors(TOLERANCE)?,
        second_method: distance(&coarse, &fine),
        step_s,
    })
}

fn distance(found: &[f64], expected: &[f64]) -> f64 {
    let largest = expected.iter().fold(f64::MIN_POSITIVE, |a, b| a.max(b.abs()));
    let worst = |a: f64, (f, e): (&f64, &f64)| {
        let off = (f - e).abs();
        if off <= a { a } else { off }
    };
    found.iter().zip(expected).fold(0.0, worst) / largest
}

fn platform() -> PlatformMotion {
    let (rate, heave, frequency) = PLATFORM;
    PlatformMotion {
        pitch_rate_rad_s: Signal::Constant(rate),
        heave_m_s2: Signal::sine(heave, frequency),
        ..PlatformMotion::STILL
    }
}

/// Returns the plant with another sample period and no delay, and the control that holds it and a little more.
fn prepare_plant(plant: &Plant, control_v: f64, period_s: f64) -> Result<(Plant, f64), Error> {
    let mut parameters = plant.parameters().clone();
    parameters.interface.output_delay_samples = 0;
    parameters.interface.sample_period_s = period_s;
    let plant = Plant::with_whole_body(&parameters, plant.body().clone())?;
    let held = plant.equilibrium(&counterpoise_models::OperatingPoint::default()).control_v;
    Ok((plant, held + control_v))
}

/// Returns the hub rates at the ends of the longest steps, `every` samples each.
fn rates(plant: &Plant, control: f64, every: usize, tolerance: f64) -> Result<Vec<f64>, Error> {
    let simulator = Simulator::new(plant)?;
    let start = simulator.rest(0.0, 0.0, PLATFORM.0);
    let samples = (STEPS * every + 1) as f64;
    let scenario = Scenario {
        platform: platform(),
        initial: Initial::State(Box::new(start)),
        detail: Detail::Everything,
        ..Scenario::at_rest(samples * plant.parameters().interface.sample_period_s)
    };
    let history =
        Simulator::with_tolerance(plant, tolerance)?.run(&mut Playback::new(&[control]), &scenario)?;
    Ok(history.truth.hub_rate_rad_s().iter().step_by(every).skip(1).copied().collect())
}
