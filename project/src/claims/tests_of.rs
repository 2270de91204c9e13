//! Claims of the thesis' test procedures: triangle, and frequency responses at several amplitudes.

use counterpoise_controller::{Controller, Readings, SampledController};
use counterpoise_models::plant::Plant;
use counterpoise_models::{FrictionLaw, Parameters};
use counterpoise_simulate::{Scenario, Signal, Simulator};
use counterpoise_verify::C64;
use counterpoise_verify::signals::rms;

use super::{Bench, Claim, Finding};
use crate::pipeline::PipelineError;

/// Frequency of the amplitude tests, Hz, and full amplitudes of demand (rad/s) and control (V).
const TONE_HZ: f64 = 1.0;
const DEMAND_RAD_S: f64 = 0.1;
const CONTROL_V: f64 = 1.5;
const AMPLITUDES: [f64; 4] = [1.0, 0.5, 0.25, 0.1];
const CYCLES: f64 = 6.0;

/// A voltage that does not change.
struct Holding(f64);

impl SampledController for Holding {
    fn reset(&mut self) {}
    fn step(&mut self, _: &Readings) -> f64 {
        self.0
    }
}

/// The complex amplitude of the last half of a record that lasts whole cycles.
fn tone(y: &[f64], period_s: f64) -> C64 {
    let first = y.len() / 2;
    let angle = |k: usize| -std::f64::consts::TAU * TONE_HZ * k as f64 * period_s;
    let sum: C64 = (first..y.len()).map(|k| C64::from_polar(1.0, angle(k)) * y[k]).sum();
    sum * (2.0 / (y.len() - first) as f64)
}

fn decibels(ratio: C64) -> f64 {
    20.0 * ratio.norm().log10()
}

/// Largest less smallest.
fn spread(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::MIN, f64::max) - values.iter().copied().fold(f64::MAX, f64::min)
}

fn text(values: &[f64]) -> String {
    values.iter().map(|v| format!("{v:.1}")).collect::<Vec<_>>().join(" / ")
}

/// C18: the plant's response to the control depends on amplitude.
///
/// # Errors
/// Those of the simulator.
pub fn c18(bench: &Bench<'_>) -> Result<Claim, PipelineError> {
    let plant = &bench.designed.modelled.plant;
    let holding_v = plant.equilibrium(&bench.procedure.operating_point).control_v;
    let mut simulator = Simulator::new(plant)?;
    let mut gains = Vec::new();
    for share in AMPLITUDES {
        let injection_v = Signal::sine(share * CONTROL_V, std::f64::consts::TAU * TONE_HZ);
        let scenario = Scenario { injection_v, ..Scenario::still(CYCLES / TONE_HZ) };
        let run = simulator.run(&mut Holding(holding_v), &scenario)?;
        let input = tone(&run.readings.control_v, run.sample_period_s);
        gains.push(decibels(tone(&run.truth.hub_rate_rad_s, run.sample_period_s) / input));
    }
    Ok(Claim {
        id: "C18",
        source: "7.2.2",
        says: "the plant's frequency response depends on the input amplitude",
        measured: format!(
            "hub rate over control at {TONE_HZ} Hz and amplitudes 1 / 0.5 / 0.25 / 0.1 of {CONTROL_V} V: {} dB",
            text(&gains)
        ),
        finding: Finding::of(spread(&gains) > 3.0),
    })
}

/// C21: the observer makes the closed loop linear in amplitude.
///
/// # Errors
/// Those of the simulator.
pub fn c21(bench: &Bench<'_>) -> Result<Claim, PipelineError> {
    let without = closed_gains(bench, bench.controller())?;
    let with = closed_gains(bench, &bench.observed)?;
    Ok(Claim {
        id: "C21",
        source: "7.4.1, fig 7-13",
        says: "with the observer the closed loop is linear in amplitude; without, it is not",
        measured: format!(
            "error over demand at {TONE_HZ} Hz, amplitudes 1 / 0.5 / 0.25 / 0.1 of {DEMAND_RAD_S} rad/s: with observer {} dB, without {} dB",
            text(&with),
            text(&without)
        ),
        finding: Finding::of(spread(&with) < spread(&without)),
    })
}

/// Error over demand in dB at each amplitude.
fn closed_gains(bench: &Bench<'_>, controller: &Controller) -> Result<Vec<f64>, PipelineError> {
    let mut simulator = Simulator::new(&bench.designed.modelled.plant)?;
    let mut gains = Vec::new();
    for share in AMPLITUDES {
        let demand_rad_s = Signal::sine(share * DEMAND_RAD_S, std::f64::consts::TAU * TONE_HZ);
        let scenario = Scenario { demand_rad_s, ..Scenario::still(CYCLES / TONE_HZ) };
        let run = simulator.run(&mut controller.runner(), &scenario)?;
        let demand = tone(&run.readings.demand_rad_s, run.sample_period_s);
        let hub = tone(&run.truth.hub_rate_rad_s, run.sample_period_s);
        gains.push(decibels((demand - hub) / demand));
    }
    Ok(gains)
}

/// C17: where friction sits shows in the triangle test.
///
/// # Errors
/// Those of the simulator.
pub fn c17(bench: &Bench<'_>) -> Result<Claim, PipelineError> {
    let truth = triangle(bench, bench.parameters())?;
    let (motor, pivot) = levels(bench.parameters());
    let total = motor + pivot;
    let mut found = Vec::new();
    for share in [0.0, 1.0, 0.5, 0.3, 0.1] {
        let control = triangle(bench, &split(bench.parameters(), share * total, (1.0 - share) * total))?;
        let difference: Vec<f64> = control.iter().zip(&truth).map(|(a, b)| a - b).collect();
        found.push((share, 1e3 * rms(&difference)));
    }
    let words: Vec<String> = found
        .iter()
        .map(|(share, error)| format!("{:.0}:{:.0} {error:.0}", 100.0 * share, 100.0 - 100.0 * share))
        .collect();
    let best = found.iter().min_by(|a, b| a.1.total_cmp(&b.1)).map_or(f64::NAN, |row| row.0);
    let ends = found[0].1.min(found[1].1);
    Ok(Claim {
        id: "C17",
        source: "7.2.1",
        says: "friction at one end of the gearbox alone reproduces the triangle test badly; split between motor and load it fits",
        measured: format!(
            "RMS difference of the control in mV from the rig ({:.0}:{:.0}), motor:load: {}",
            100.0 * motor / total,
            100.0 * pivot / total,
            words.join(", ")
        ),
        finding: Finding::of(best > 0.0 && best < 1.0 && ends > 2.0 * found[4].1),
    })
}

/// Coulomb levels at the output: of the motor through the gear, and of the pivot.
fn levels(parameters: &Parameters) -> (f64, f64) {
    (
        parameters.gearbox.ratio * parameters.motor_friction.coulomb_nm(),
        parameters.pivot_friction.coulomb_nm(),
    )
}

fn split(parameters: &Parameters, motor_nm: f64, pivot_nm: f64) -> Parameters {
    let mut out = parameters.clone();
    let ratio = out.gearbox.ratio;
    set_level(&mut out.motor_friction.law, motor_nm / ratio);
    set_level(&mut out.pivot_friction.law, pivot_nm);
    out
}

/// A Dahl law at another level, with the same deflection at breakaway; none where the level is 0.
fn set_level(law: &mut FrictionLaw, level_nm: f64) {
    if let FrictionLaw::Dahl { coulomb_nm, rest_stiffness_nm_rad, .. } = law {
        if level_nm == 0.0 {
            *law = FrictionLaw::None;
        } else {
            *rest_stiffness_nm_rad *= level_nm / *coulomb_nm;
            *coulomb_nm = level_nm;
        }
    }
}

/// The control of the recording's controller, or the design's, while the demand is a triangle.
fn triangle(bench: &Bench<'_>, parameters: &Parameters) -> Result<Vec<f64>, PipelineError> {
    let demand_rad_s = Signal::Triangle { amplitude: DEMAND_RAD_S, period_s: 4.0 };
    let scenario = Scenario { demand_rad_s, ..Scenario::still(8.0) };
    let run =
        Simulator::new(&Plant::lumped(parameters)?)?.run(&mut bench.controller().runner(), &scenario)?;
    Ok(run.readings.control_v)
}
