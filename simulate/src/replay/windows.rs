//! Replay over short windows: at the start of each window the state of the model is fitted to the samples that follow.
//!
//! A machine that hunts, or floats in a wide gap, forgets its start: two runs that differ only in sensor noise diverge, and no model,
//! however good, can reproduce a whole recording. Over a short window a good model can. The control is the recorded one. Each window starts from where the one before ended, moved by seven numbers (hub angle and rate, motor rate, gear wind-up,
//! dry friction at motor and pivot, current) that are fitted to its first half by Levenberg and Marquardt's method; a wind-up inside
//! the gap is one of the states that the fit can find.

use super::normal_equations::{NormalEquations, squares};
use super::{Playback, Replay, ReplayLoop, Replayer, reading_floor};
use crate::firing::Firing;
use crate::run::{Simulator, holding_control};
use crate::scenario::{Detail, Initial, Scenario};
use crate::sensing::Imperfections;
use crate::signal::Signal;
use crate::tolerance::{
    EXPLAINED, LEAST_BEND_RAD, LEAST_DAMPING, LONGEST_START_FIT_S, SHORTEST_WINDOW, START_ANGLE_STEP_RAD,
    WINDOW_FITTED_SHARE, WINDOW_FLAT, WINDOW_ITERATIONS, WINDOW_STUCK,
};
use crate::{Error, PlantState, PlatformMotion};
use counterpoise_models::plant::core::state;
use counterpoise_models::{FeedbackSignal, Friction, Parameters, Plant};
use counterpoise_recordings::Channel;

/// Number of unknowns.
const UNKNOWNS: usize = 7;
/// Their order.
const ANGLE: usize = 0;
const HUB: usize = 1;
const MOTOR: usize = 2;
const WINDUP: usize = 3;
const MOTOR_DRY: usize = 4;
const PIVOT_DRY: usize = 5;
const CURRENT: usize = 6;

type Move = [f64; UNKNOWNS];

impl Replayer<'_> {
    /// Replays the recorded control over windows of a length, each from a start of its own; the platform's channels are those of
    /// the whole recording.
    ///
    /// # Errors
    /// As [`super::replay`] in open loop, and [`Error::Range`] for a window of less than 20 samples.
    pub fn replay_windowed(&self, parameters: &Parameters, window_s: f64) -> Result<Replay, Error> {
        let length = (window_s / self.recording.sample_period_s).round();
        if length.is_nan() || length < SHORTEST_WINDOW as f64 {
            return Err(Error::Range { what: "window_s", value: window_s, allowed: "at least 20 samples" });
        }
        let mut whole = self.replay(parameters, &ReplayLoop::Open)?;
        let mut windows = Windows::new(self, parameters, length as usize, &whole.start)?;
        let mut near = whole.start.clone();
        let mut from = 0;
        while from < self.samples {
            let left = self.samples - from;
            let count = if left < windows.length + SHORTEST_WINDOW { left } else { windows.length };
            let start = windows.fit_start(&near, from, count)?;
            let history = windows.run(&start, from, count)?;
            for channel in FOLLOWED {
                let found = history.readings.channel(channel);
                whole.simulated.channel_mut(channel)[from..from + count].copy_from_slice(found);
            }
            near = history.final_state;
            from += count;
        }
        whole.channels = self.fits(parameters, &ReplayLoop::Open, &whole.simulated);
        Ok(whole)
    }
}

impl Replayer<'_> {
    /// Replays the recorded control over the whole recording.
    ///
    /// The start is fitted to the first moments. Where some channel then ends up further off than noise explains, a start that is
    /// fitted to the first half of the recording (its first minute, if that is shorter) is tried as well, and taken if with it every channel is explained: a machine that
    /// nearly stalls remembers a start for longer than the first moments show it. Where it explains nothing, the model lacks
    /// something, and the start shall not hide that.
    ///
    /// # Errors
    /// As [`super::replay`] in open loop.
    pub fn replay_open(&self, parameters: &Parameters) -> Result<Replay, Error> {
        let first = self.replay(parameters, &ReplayLoop::Open)?;
        if is_explained(&first) || self.samples < SHORTEST_WINDOW {
            return Ok(first);
        }
        let mut windows = Windows::new(self, parameters, self.samples, &first.start)?;
        let longest = (LONGEST_START_FIT_S / WINDOW_FITTED_SHARE / self.recording.sample_period_s) as usize;
        let start = windows.fit_start(&first.start, 0, self.samples.min(longest))?;
        let longer = self.replay_from(parameters, &ReplayLoop::Open, &start)?;
        Ok(if is_explained(&longer) { longer } else { first })
    }
}

/// Returns whether every channel is as close as noise lets a true model be.
pub(super) fn is_explained(replay: &Replay) -> bool {
    replay.channels.iter().all(|fit| fit.rms_error < EXPLAINED * fit.floor)
}

/// The channels that say what the plant does.
const FOLLOWED: [Channel; 3] = [Channel::HubRate, Channel::MotorRate, Channel::HubPosition];

/// A move of the start of a window, and what it leaves.
struct Trial<'a> {
    now: Move,
    residuals: &'a [f64],
}

struct Windows<'a, 'b> {
    replayer: &'a Replayer<'b>,
    simulator: Simulator,
    plant: Plant,
    length: usize,
    /// The control as it acts: recorded, missing values filled, held back by the interface's delay; before the first arrives it is
    /// the one that holds the start.
    control_v: Vec<f64>,
    /// The platform's angle at each sample.
    platform_rad: Vec<f64>,
    channels: Vec<(Channel, f64)>,
    steps: Move,
    /// The uncertainty of the seven at the end of a window, as the fit expects.
    spread: Move,
}

impl<'a, 'b> Windows<'a, 'b> {
    fn new(
        replayer: &'a Replayer<'b>,
        parameters: &Parameters,
        length: usize,
        start: &PlantState,
    ) -> Result<Self, Error> {
        let mut prompt = parameters.clone();
        let delay = std::mem::take(&mut prompt.interface.output_delay_samples);
        let plant = replayer.plant(&prompt)?;
        let held = holding_control(&plant, &start.core);
        let mut control_v = vec![held; delay];
        control_v.extend(Playback::fill_missing(replayer.recording)?);
        let sensors = &parameters.sensors;
        let candidates = [
            (Channel::HubRate, Some(&sensors.hub_gyro)),
            (Channel::MotorRate, sensors.motor_tachometer.as_ref()),
            (Channel::HubPosition, sensors.hub_resolver.as_ref()),
        ];
        let channels = candidates
            .into_iter()
            .filter(|(channel, _)| replayer.recording.has(*channel))
            .filter_map(|(channel, sensor)| Some((channel, reading_floor(sensor?, &parameters.interface))));
        let (motor, pivot) =
            (parameters.motor_friction.breakaway_nm(), parameters.pivot_friction.breakaway_nm());
        let gearbox = &parameters.gearbox;
        let bent = (pivot / gearbox.stiffness_nm_rad).max(LEAST_BEND_RAD);
        Ok(Self {
            channels: channels.collect(),
            platform_rad: angles(replayer),
            simulator: Simulator::new(&plant)?,
            plant,
            replayer,
            length,
            control_v,
            steps: [
                START_ANGLE_STEP_RAD,
                1e-4,
                1e-4 * gearbox.ratio,
                0.01 * bent,
                0.01 * motor.max(1e-4),
                0.01 * pivot.max(1e-2),
                1e-2,
            ],
            spread: [
                1e-3,
                1e-1,
                1e-1 * gearbox.ratio,
                bent + gearbox.backlash_rad,
                motor.max(1e-4),
                pivot.max(1e-2),
                1.0,
            ],
        })
    }

    /// Runs `count` samples from a state at sample `from`.
    fn run(&mut self, start: &PlantState, from: usize, count: usize) -> Result<crate::TimeHistory, Error> {
        let period = self.replayer.recording.sample_period_s;
        let platform = PlatformMotion {
            pitch_rate_rad_s: self.replayer.platform.pitch_rate_rad_s.part(from..from + count),
            heave_m_s2: self.replayer.platform.heave_m_s2.part(from..from + count),
            initial_angle_rad: self.platform_rad[from],
            further: self.replayer.platform.further.as_ref().map(|further| further.part(from..from + count)),
        };
        let scenario = Scenario {
            duration_s: count as f64 * period,
            demand_rad_s: Signal::ZERO,
            injection_v: Signal::ZERO,
            platform,
            imperfections: Imperfections::None,
            initial: Initial::State(Box::new(start.clone())),
            detail: Detail::Recording,
            firing: Firing::Stated,
        };
        self.simulator.run(&mut Playback::new(&self.control_v[from..]), &scenario)
    }

    /// Returns the start of a window, fitted near a state.
    fn fit_start(&mut self, near: &PlantState, from: usize, count: usize) -> Result<PlantState, Error> {
        let seen = ((count as f64 * WINDOW_FITTED_SHARE) as usize).max(SHORTEST_WINDOW).min(count);
        if self.channels.is_empty() {
            return Ok(near.clone());
        }
        let mut now: Move = [0.0; UNKNOWNS];
        let mut residuals = self.residuals(near, &now, from, seen)?;
        let mut cost = squares(&residuals);
        let mut damping = 1e-3;
        let mut normal = self.normal(near, &Trial { now, residuals: &residuals }, from, seen)?;
        for _ in 0..WINDOW_ITERATIONS {
            let step = normal.solve(damping);
            let next: Move = std::array::from_fn(|k| now[k] + step[k] * self.steps[k]);
            let tried = self.residuals(near, &next, from, seen)?;
            let new_cost = squares(&tried);
            if new_cost < cost {
                let fall = (cost - new_cost) / cost;
                (now, residuals, cost) = (next, tried, new_cost);
                damping = (damping * 0.2_f64).max(LEAST_DAMPING);
                if fall < WINDOW_FLAT {
                    break;
                }
                normal = self.normal(near, &Trial { now, residuals: &residuals }, from, seen)?;
            } else if damping > WINDOW_STUCK {
                break;
            } else {
                damping *= 10.0;
            }
        }
        Ok(self.move_state(near, &now))
    }

    /// Returns a state moved by the seven, friction within its levels.
    fn move_state(&self, near: &PlantState, by: &Move) -> PlantState {
        let parameters = self.plant.parameters();
        let mut out = near.clone();
        out.core[state::ANGLE] += by[ANGLE];
        out.core[state::RATE] += by[HUB];
        let of_states = [(state::MOTOR, MOTOR), (state::WINDUP, WINDUP), (state::CURRENT, CURRENT)];
        for (index, moved) in
            of_states.into_iter().filter(|(index, _)| self.plant.has_mechanism_state(*index))
        {
            out.core[index] += by[moved];
        }
        out.hub_gyro[0] += self.shown_by_loop_sensor(by);
        let dry = |friction: &Friction, old: f64, by: f64| {
            let most = friction.breakaway_nm();
            friction.state_at_torque((friction.torque_at_state_nm(old) + by).clamp(-most, most))
        };
        out.friction.motor = dry(&parameters.motor_friction, near.friction.motor, by[MOTOR_DRY]);
        out.friction.pivot = dry(&parameters.pivot_friction, near.friction.pivot, by[PIVOT_DRY]);
        out
    }

    /// Returns by how much a move of the state changes what the loop's sensor is given.
    fn shown_by_loop_sensor(&self, by: &Move) -> f64 {
        let parameters = self.plant.parameters();
        match parameters.sensors.measured {
            FeedbackSignal::HubRate | FeedbackSignal::RelativeRate => by[HUB],
            FeedbackSignal::MotorRate if parameters.gearbox.is_rigid() => by[HUB],
            FeedbackSignal::MotorRate => by[MOTOR] / parameters.gearbox.ratio,
            FeedbackSignal::HubPosition => by[ANGLE],
            FeedbackSignal::MotorPosition if parameters.gearbox.is_rigid() => by[ANGLE],
            FeedbackSignal::MotorPosition => by[ANGLE] + by[WINDUP],
            FeedbackSignal::Torque | FeedbackSignal::Current => 0.0,
        }
    }

    fn residuals(
        &mut self,
        near: &PlantState,
        by: &Move,
        from: usize,
        seen: usize,
    ) -> Result<Vec<f64>, Error> {
        let history = self.run(&self.move_state(near, by), from, seen)?;
        let mut out = Vec::with_capacity(seen * self.channels.len() + UNKNOWNS);
        for &(channel, floor) in &self.channels {
            let recorded = self.replayer.recording.samples(channel).unwrap_or(&[]);
            let pairs = history.readings.channel(channel).iter().zip(&recorded[from..]);
            out.extend(pairs.map(|(s, r)| if r.is_finite() { (r - s) / floor } else { 0.0 }));
        }
        out.extend(by.iter().zip(&self.spread).map(|(b, s)| b / s));
        Ok(out)
    }

    /// Returns the normal equations by forward differences; friction is moved inwards.
    fn normal(
        &mut self,
        near: &PlantState,
        trial: &Trial,
        from: usize,
        seen: usize,
    ) -> Result<NormalEquations<UNKNOWNS>, Error> {
        let mut columns: Vec<Vec<f64>> = Vec::with_capacity(UNKNOWNS);
        for k in 0..UNKNOWNS {
            let inwards = match k {
                MOTOR_DRY => near.friction.motor + trial.now[k] > 0.0,
                PIVOT_DRY => near.friction.pivot + trial.now[k] > 0.0,
                _ => false,
            };
            let sign = if inwards { -1.0 } else { 1.0 };
            let mut moved = trial.now;
            moved[k] += sign * self.steps[k];
            let shifted = self.residuals(near, &moved, from, seen)?;
            columns.push(shifted.iter().zip(trial.residuals).map(|(a, b)| sign * (a - b)).collect());
        }
        Ok(NormalEquations::of(&columns, trial.residuals))
    }
}

/// Returns the angle of the platform at each sample, from its rate: Simpson's rule between samples.
fn angles(replayer: &Replayer) -> Vec<f64> {
    let (period, rate) = (replayer.recording.sample_period_s, &replayer.platform.pitch_rate_rad_s);
    let mut angle = replayer.platform.initial_angle_rad;
    let mut out = Vec::with_capacity(replayer.samples);
    for k in 0..replayer.samples {
        out.push(angle);
        let at = |part: f64| rate.at((k as f64 + part) * period);
        angle += period / 6.0 * (at(0.0) + 4.0 * at(0.5) + at(1.0));
    }
    out
}
