//! How the integrator's error falls with its step, against a second method.
//!
//! [`study`] moves a plant under a constant control on a platform that pitches steadily and heaves, with steps of one
//! length only, and compares the hub rate at the end of every longest step with the classical Runge-Kutta method on the plant's right-hand
//! side ([`counterpoise_models::Plant::derivative`]) by far shorter steps: another method, on another form of the
//! equations. Where friction reverses or teeth meet, no method keeps its order; the integrator finds those instants, which
//! [`Convergence::finding_events`] tells.

use crate::run::Simulator;
use crate::{Detail, Error, Initial, PlatformMotion, Playback, Scenario, Signal};
use counterpoise_models::{Excitation, Parameters, Plant};

/// Duration of a study, s.
const DURATION_S: f64 = 0.128;
/// Longest step, s; the others are its halves.
const LONGEST_S: f64 = 8e-3;
/// Steps of the second method in a longest one.
const SECOND_STEPS: usize = 4000;
/// Tolerance with which every step is taken as it is.
const WHATEVER: f64 = 1e9;
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
    /// Observed order: slope of the logarithm of the error over that of the step, between the longest step and the
    /// shortest whose error is still ten times that of the second method.
    pub fn order(&self) -> f64 {
        let clear: Vec<usize> =
            (0..self.error.len()).filter(|&k| self.error[k] > 10.0 * self.second_method).collect();
        match (clear.first(), clear.last()) {
            (Some(&a), Some(&b)) if a < b => {
                (self.error[a] / self.error[b]).ln() / (self.step_s[a] / self.step_s[b]).ln()
            }
            _ => f64::NAN,
        }
    }
}

/// The errors of a lumped mechanism under a constant control, V, added to the one that holds it, with so many lengths of steps.
///
/// # Errors
/// A mechanism that cannot be simulated, and laws that the second method does not have (bristles).
pub fn study(parameters: &Parameters, control_v: f64, lengths: usize) -> Result<Convergence, Error> {
    let fine = runge_kutta(parameters, control_v, SECOND_STEPS)?;
    let coarse = runge_kutta(parameters, control_v, SECOND_STEPS / 2)?;
    let step_s: Vec<f64> = (0..lengths).map(|k| LONGEST_S * 0.5_f64.powi(k as i32)).collect();
    let errors = |tolerance: f64| -> Result<Vec<f64>, Error> {
        step_s
            .iter()
            .map(|&step| Ok(distance(&rates(parameters, control_v, step, tolerance)?, &fine)))
            .collect()
    };
    Ok(Convergence {
        error: errors(WHATEVER)?,
        finding_events: errors(crate::run::TOLERANCE)?,
        second_method: distance(&coarse, &fine),
        step_s,
    })
}

fn distance(found: &[f64], expected: &[f64]) -> f64 {
    let largest = expected.iter().fold(f64::MIN_POSITIVE, |a, b| a.max(b.abs()));
    found.iter().zip(expected).fold(0.0_f64, |a, (f, e)| a.max((f - e).abs())) / largest
}

fn platform() -> PlatformMotion {
    let (rate, heave, frequency) = PLATFORM;
    PlatformMotion {
        pitch_rate_rad_s: Signal::Constant(rate),
        heave_m_s2: Signal::sine(heave, frequency),
        ..PlatformMotion::STILL
    }
}

/// The plant and the control that holds it, and a little more.
fn ready(parameters: &Parameters, control_v: f64) -> Result<(Plant, f64), Error> {
    let mut parameters = parameters.clone();
    parameters.interface.output_delay_samples = 0;
    let plant = Plant::lumped(&parameters)?;
    let held = plant.equilibrium(&counterpoise_models::OperatingPoint::default()).control_v;
    Ok((plant, held + control_v))
}

/// Hub rates at the ends of the longest steps, with sample periods of one step.
fn rates(parameters: &Parameters, control_v: f64, step_s: f64, tolerance: f64) -> Result<Vec<f64>, Error> {
    let mut parameters = parameters.clone();
    parameters.interface.sample_period_s = step_s;
    let (plant, control) = ready(&parameters, control_v)?;
    let every = (LONGEST_S / step_s).round() as usize;
    let simulator = Simulator::new(&plant)?;
    let start = simulator.rest(0.0, 0.0, PLATFORM.0);
    let scenario = Scenario {
        platform: platform(),
        initial: Initial::State(Box::new(start)),
        detail: Detail::Everything,
        ..Scenario::still(DURATION_S + step_s)
    };
    let history =
        Simulator::with_tolerance(&plant, tolerance)?.run(&mut Playback::new(&[control]), &scenario)?;
    Ok(history.truth.hub_rate_rad_s.iter().step_by(every).skip(1).copied().collect())
}

/// The same by the classical Runge-Kutta method with so many steps in a longest one.
fn runge_kutta(parameters: &Parameters, control_v: f64, substeps: usize) -> Result<Vec<f64>, Error> {
    let (plant, control) = ready(parameters, control_v)?;
    let start = Simulator::new(&plant)?.rest(0.0, 0.0, PLATFORM.0);
    let mut x = start.core;
    x.extend([0.0, 0.0]);
    let h = LONGEST_S / substeps as f64;
    let row = plant.hub_rate_row();
    let mut rates = Vec::new();
    let steps = (DURATION_S / h).round() as usize;
    for step in 0..steps {
        classical(&plant, control, step as f64 * h, h, &mut x);
        if (step + 1).is_multiple_of(substeps) {
            rates.push(row.iter().zip(&x).map(|(c, v)| c * v).sum());
        }
    }
    Ok(rates)
}

/// One step of the classical Runge-Kutta method.
fn classical(plant: &Plant, control_v: f64, time_s: f64, h: f64, x: &mut [f64]) {
    let mut slopes = [0; 4].map(|_| vec![0.0; x.len()]);
    let (rate, heave, frequency) = PLATFORM;
    for (stage, part) in [0.0, 0.5, 0.5, 1.0].into_iter().enumerate() {
        let time = time_s + part * h;
        let at = Excitation {
            time_s: time,
            control_v,
            heave_m_s2: heave * (frequency * time).sin(),
            platform_angle_rad: rate * time,
            platform_rate_rad_s: rate,
        };
        let mut here = x.to_vec();
        if stage > 0 {
            here.iter_mut().zip(&slopes[stage - 1]).for_each(|(x, d)| *x += part * h * d);
        }
        plant.derivative(&here, &at, &mut slopes[stage]);
    }
    for (i, x) in x.iter_mut().enumerate() {
        *x += h / 6.0 * (slopes[0][i] + 2.0 * (slopes[1][i] + slopes[2][i]) + slopes[3][i]);
    }
}
