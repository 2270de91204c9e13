//! Limit cycles on the simulator: a motion is started near each prediction, and followed until it settles or fades.
//!
//! A stable limit cycle attracts the motions beside it. Following one of them from sample to sample therefore finds the periodic
//! solution without a Newton iteration; friction with memory and a limiter would give that a derivative that jumps.

use counterpoise_controller::SampledController;
use counterpoise_simulate::{Initial, Scenario, Signal, Simulator};

use super::Prediction;
use super::floor::Subject;
use super::runs::{self, HubCycle, cycle_of};
use crate::Error;
use crate::signals::rms;
use crate::signals::statistics::subtract_mean;
use crate::tolerance::{
    BURST_PERIODS, FADED_FLOORS, LONGEST_STRETCH_S, MOVES_FLOORS, OBSERVED_S, SETTLED, SETTLING_S,
    STILL_FADES, STRETCH_PERIODS, STRETCH_S,
};

/// Course of a disturbance of the hub's rate, or of what else the loop controls, in its unit.
#[derive(Debug, Clone, PartialEq)]
pub struct Orbit {
    /// Amplitude of the hub's rate at which it started, rad/s.
    pub start_rad_s: f64,
    /// Frequency at which it started, Hz.
    pub start_hz: f64,
    /// Amplitude of the sine that is added to the control for three of its periods to start it, V.
    pub burst_v: f64,
    /// RMS of the hub's rate that stays, rad/s; 0 if the motion faded, infinite if it diverged.
    pub rms_rad_s: f64,
    /// Half the range of the hub's rate, rad/s.
    pub amplitude_rad_s: f64,
    /// Frequency, Hz; 0 if the motion faded.
    pub frequency_hz: f64,
    /// `true` if runs with noise have the same cycle; `false` also for a motion without a cycle.
    pub recurs: bool,
    /// The hub's rate about its mean over the last stretch that was followed, rad/s; empty if it diverged before one ended.
    pub rates_rad_s: Vec<f64>,
}

/// A disturbance: amplitude of the hub's rate and frequency.
#[derive(Debug, Clone, Copy)]
struct Start {
    rate_rad_s: f64,
    hz: f64,
}

/// Follows the motion from near each predicted limit cycle, and from a small and a large disturbance at the frequency that fades least.
pub(super) fn follow_orbits(subject: &Subject<'_>, prediction: &Prediction) -> Result<Vec<Orbit>, Error> {
    let floor = subject.noise_floor_rad_s();
    let slowest = prediction
        .growth
        .iter()
        .max_by(|a, b| a.growth_per_s.total_cmp(&b.growth_per_s))
        .map(|at| at.frequency_hz);
    let hz = slowest.unwrap_or(1.0);
    let large = subject.procedure.step.rate_rad_s.abs();
    let mut starts: Vec<Start> = prediction
        .cycles
        .iter()
        .map(|cycle| Start { rate_rad_s: cycle.rate_rad_s, hz: cycle.frequency_hz })
        .collect();
    let started = |amplitude| Start { rate_rad_s: subject.rate_of(amplitude, hz), hz };
    starts.extend([3.0 * floor, large].map(started));
    let mut simulator = Simulator::new(&subject.case.plant)?;
    starts.into_iter().map(|start| orbit(subject, &mut simulator, start)).collect()
}

/// One motion.
fn orbit(subject: &Subject<'_>, simulator: &mut Simulator, start: Start) -> Result<Orbit, Error> {
    let mut runner = subject.controller.runner();
    runner.set_out_of_balance(subject.case.out_of_balance_kg_m);
    let mut found = Orbit {
        start_rad_s: start.rate_rad_s / subject.rate_of(1.0, start.hz),
        start_hz: start.hz,
        burst_v: burst_v(subject, start),
        rms_rad_s: 0.0,
        amplitude_rad_s: 0.0,
        frequency_hz: 0.0,
        recurs: false,
        rates_rad_s: Vec::new(),
    };
    let settles = |value: Result<Stretches, Error>| match value {
        Err(Error::Simulate(counterpoise_simulate::Error::Diverged { .. })) => Ok(None),
        other => other.map(Some),
    };
    let Some(mut run) = settles(Stretches::begin(subject, simulator, &mut runner, start))? else {
        found.rms_rad_s = f64::INFINITY;
        return Ok(found);
    };
    let floor = subject.noise_floor_rad_s();
    while run.time_s < OBSERVED_S {
        let next = run.next(subject, simulator, &mut runner);
        let Some(()) = (match next {
            Err(Error::Simulate(counterpoise_simulate::Error::Diverged { .. })) => None,
            other => Some(other?),
        }) else {
            found.rms_rad_s = f64::INFINITY;
            return Ok(found);
        };
        if run.rms_rad_s < FADED_FLOORS * floor {
            found.rates_rad_s = run.rates_rad_s;
            return Ok(found);
        }
        if run.has_settled() {
            break;
        }
    }
    if !run.has_settled() && run.fades() {
        found.rates_rad_s = run.rates_rad_s;
        return Ok(found);
    }
    found.rms_rad_s = run.rms_rad_s;
    found.amplitude_rad_s = run.amplitude_rad_s;
    found.frequency_hz = run.frequency_hz;
    found.rates_rad_s = run.rates_rad_s;
    let is_cycle = found.frequency_hz > 0.0 && found.rms_rad_s > MOVES_FLOORS * floor;
    let cycle = HubCycle { amplitude_rad_s: found.amplitude_rad_s, frequency_hz: found.frequency_hz };
    found.recurs = is_cycle && runs::cycle_recurs(subject, cycle, &burst(subject, start)?)?;
    Ok(found)
}

/// A motion under way, stretch after stretch.
struct Stretches {
    state: counterpoise_simulate::PlantState,
    stretch_s: f64,
    time_s: f64,
    /// The stretches by which the motion is seen to settle or to fade, of the stretches before.
    before_rad_s: Vec<f64>,
    /// The same of the last stretch.
    settling_rms: f64,
    rms_rad_s: f64,
    amplitude_rad_s: f64,
    frequency_hz: f64,
    /// The hub's rate about its mean over the last stretch.
    rates_rad_s: Vec<f64>,
}

impl Stretches {
    /// Lets the controller settle, then shakes the mechanism by a burst of the control.
    fn begin(
        subject: &Subject<'_>,
        simulator: &mut Simulator,
        controller: &mut dyn SampledController,
        start: Start,
    ) -> Result<Self, Error> {
        let burst_s = BURST_PERIODS / start.hz;
        let scenario = Scenario {
            duration_s: SETTLING_S + burst_s,
            injection_v: burst(subject, start)?,
            initial: Initial::Rest { hub_angle_rad: subject.procedure.operating_point.hub_angle_rad },
            ..scenario_at_rest(subject, 1.0)
        };
        let run = simulator.run(controller, &scenario)?;
        Ok(Self {
            state: run.final_state,
            stretch_s: (STRETCH_PERIODS / start.hz).clamp(STRETCH_S, LONGEST_STRETCH_S),
            time_s: 0.0,
            before_rad_s: Vec::new(),
            settling_rms: f64::NAN,
            rms_rad_s: f64::NAN,
            amplitude_rad_s: 0.0,
            frequency_hz: 0.0,
            rates_rad_s: Vec::new(),
        })
    }

    fn next(
        &mut self,
        subject: &Subject<'_>,
        simulator: &mut Simulator,
        controller: &mut dyn SampledController,
    ) -> Result<(), Error> {
        let initial = Initial::State(Box::new(self.state.clone()));
        let scenario = Scenario { initial, ..scenario_at_rest(subject, self.stretch_s) };
        let run = simulator.run(controller, &scenario)?;
        let rates = subtract_mean(&subject.motion(&run.truth, 0));
        self.before_rad_s.extend(Some(self.settling_rms).filter(|rms| !rms.is_nan()));
        self.settling_rms = subject.settling_rms(&run.truth);
        self.rms_rad_s = rms(&rates);
        let cycle = cycle_of(&rates, run.sample_period_s);
        (self.amplitude_rad_s, self.frequency_hz) = (cycle.amplitude_rad_s, cycle.frequency_hz);
        self.rates_rad_s = rates;
        self.time_s += self.stretch_s;
        self.state = run.final_state;
        Ok(())
    }

    /// Returns whether the last two stretches moved alike.
    fn has_settled(&self) -> bool {
        let [.., earlier, last] = self.before_rad_s[..] else { return false };
        [earlier, last].iter().all(|before| (self.settling_rms / before - 1.0).abs() < SETTLED)
    }

    /// Returns whether the motion has fallen distinctly since half as many stretches ago.
    fn fades(&self) -> bool {
        let earlier = self.before_rad_s.get(self.before_rad_s.len() / 2);
        earlier.is_some_and(|before| self.settling_rms < STILL_FADES * before)
    }
}

fn scenario_at_rest(subject: &Subject<'_>, duration_s: f64) -> Scenario {
    let angle = subject.procedure.operating_point.platform_angle_rad;
    let mut scenario = Scenario::at_rest(duration_s);
    scenario.platform.initial_angle_rad = angle;
    scenario
}

/// A burst of a sine after the settling time, as large as the sliding plant needs for the wanted rate, within a tenth of the
/// controller's limit at most.
fn burst(subject: &Subject<'_>, start: Start) -> Result<Signal, Error> {
    let period_s = subject.case.plant.parameters().interface.sample_period_s;
    let rate = std::f64::consts::TAU * start.hz;
    let volts = burst_v(subject, start);
    let first = (SETTLING_S / period_s) as usize;
    let count = (BURST_PERIODS / start.hz / period_s).ceil() as usize;
    let mut values = vec![0.0; first];
    values.extend((0..count).map(|k| volts * (rate * period_s * k as f64).sin()));
    values.push(0.0);
    Ok(Signal::Held { period_s, values })
}

/// Amplitude of that sine, V; a cylinder takes the flow that its piston displaces at that rate.
fn burst_v(subject: &Subject<'_>, start: Start) -> f64 {
    let parameters = subject.case.plant.parameters();
    let rate = std::f64::consts::TAU * start.hz;
    let (volts_per_nm, inertia) = volts(subject);
    let wanted = volts_per_nm
        * (inertia * rate * start.rate_rad_s
            + parameters.pivot_friction.coulomb_nm().min(stiffness(subject) * start.rate_rad_s / rate));
    // oil hardly yields: the valve must pass what the piston displaces
    let displaced = parameters.gearbox.ratio * parameters.motor.back_emf_v_s_rad * start.rate_rad_s;
    let by_flow = parameters.cylinder.as_ref().map_or(0.0, |_| displaced / parameters.amplifier.gain);
    wanted.max(by_flow).min(0.3 * subject.controller.limit_v())
}

/// Volts for one N m at the hub, and the inertia that they move, kg m^2.
fn volts(subject: &Subject<'_>) -> (f64, f64) {
    let parameters = subject.case.plant.parameters();
    let (ratio, motor) = (parameters.gearbox.ratio, &parameters.motor);
    let stall = ratio * motor.torque_constant_nm_a * parameters.amplifier.stall_gain_a_v(motor);
    let inertia = subject.case.plant.body().inertia_kg_m2 + motor.inertia_kg_m2 * ratio * ratio;
    (1.0 / stall, inertia)
}

/// Presliding stiffness of pivot and motor together at the hub, N m/rad; the gear's where a joint truly sticks.
fn stiffness(subject: &Subject<'_>) -> f64 {
    let parameters = subject.case.plant.parameters();
    let (gear, ratio) = (parameters.gearbox.stiffness_nm_rad, parameters.gearbox.ratio);
    let pivot = parameters.pivot_friction.presliding_stiffness_nm_rad().unwrap_or(gear);
    let motor = parameters.motor_friction.presliding_stiffness_nm_rad().map_or(gear, |k| k * ratio * ratio);
    pivot + motor
}
