//! The state at the start of a recording, fitted to its first moments.
//!
//! Eight numbers are unknown: hub angle, the rate of the hub, gear torque, dry friction at
//! motor and pivot, current, the torque of a hose if there is one, and by how much an elastic transmission lets the motor turn faster than
//! the hub. They are fitted by Levenberg and Marquardt's method to hub rate, motor rate and hub
//! position over the first 0.6 seconds, or the first tenth of a shorter recording, under the recorded control, with the weak
//! preference that the torques on motor and hub balance. What none of the readings shows (the angle of a balanced mechanism without a
//! resolver) stays where it was guessed. The structure is taken bent as the gear torque bends it.
//!
//! If dry friction alone can hold the hub, the teeth may be apart at the start. The fit is then tried with the teeth apart as well,
//! and the place inside the gap stands where the gear torque stood.

use super::first_motion::FirstMotion;
use super::normal_equations::{NormalEquations, squares};
use super::{Playback, Replayer, reading_floor};
use crate::ensemble::{EnsembleRun, SIDE_BY_SIDE, run_ensemble};
use crate::history::TimeHistory;
use crate::run::{MotionAtStart, Simulator, loop_sensor_input};
use crate::scenario::Scenario;
use crate::tolerance::{
    FAR, FIRST_SAMPLES, IMBALANCE, LEAST_DAMPING, START_ANGLE_STEP_RAD, START_EXPLAINED, START_FLAT,
    START_ITERATIONS, START_STUCK, START_WINDOW_S, START_WINDOW_SHARE,
};
use crate::{Error, FrictionState, PlantState};
use counterpoise_models::plant::Hose;
use counterpoise_models::plant::core::state;
use counterpoise_models::{Mesh, Parameters, Plant};
use counterpoise_recordings::Channel;

/// Number of unknowns.
pub const UNKNOWNS: usize = 8;

type Unknowns = [f64; UNKNOWNS];

/// Indices of the unknowns.
const ANGLE: usize = 0;
const RATE: usize = 1;
const MESH: usize = 2;
const MOTOR_DRY: usize = 3;
const PIVOT_DRY: usize = 4;
const CURRENT: usize = 5;
const HOSE: usize = 6;
const TWIST: usize = 7;

/// Steps of the gear's unknown from the middle of the gap to a flank while the teeth are apart: a fit finds the place to a fraction of
/// a step, and a difference of one step stays inside the gap.
const STEPS_TO_FLANK: f64 = 20.0;

/// Returns whether a mechanism's start has a freedom: hub angle, its rate, gear torque, both dry frictions, current, a hose's torque, which
/// only a mechanism with a hose has, and the rate at which the transmission winds up, which only an elastic one has.
pub fn start_has(parameters: &Parameters, freedom: usize) -> bool {
    match freedom {
        HOSE => parameters.lumped.as_ref().and_then(Hose::of).is_some(),
        TWIST => !parameters.gearbox.is_rigid(),
        _ => true,
    }
}

/// Returns the state of the plant at the first sample.
pub(crate) fn estimate(simulator: &mut Simulator, replayer: &Replayer) -> Result<PlantState, Error> {
    let mut fit = Fit::new(simulator, replayer);
    if fit.channels.is_empty() || !replayer.recording().has(Channel::Control) {
        return Ok(fit.state(&fit.guess(Mesh::Touching, None)));
    }
    let mut best: Option<(f64, PlantState)> = None;
    let commanded = fit.commanded_current();
    let places = [(Mesh::Touching, None), (Mesh::Touching, commanded), (Mesh::Free, None)];
    let places = places.into_iter().filter(|(mesh, _)| *mesh == Mesh::Touching || fit.can_be_open());
    let still = places.map(|(mesh, current)| (mesh, Bending::AtRest, fit.guess(mesh, current)));
    let in_motion = [Bending::ByAcceleration, Bending::AtRest]
        .map(|bending| (Mesh::Touching, bending, fit.guess_in_motion(commanded)));
    let bends = fit.deflections().any(|deflection| deflection != 0.0);
    let moving = in_motion.into_iter().skip(usize::from(!bends)).filter(|_| fit.motion.is_moving());
    let guesses: Vec<(Mesh, Bending, Unknowns)> = moving.chain(still).collect();
    for (mesh, bending, guess) in guesses {
        (fit.mesh, fit.bending) = (mesh, bending);
        let (cost, found) = fit.descend(guess)?;
        if best.as_ref().is_none_or(|(least, _)| cost < *least) {
            best = Some((cost, fit.state(&found)));
        }
        if fit.is_explained(cost) {
            break;
        }
    }
    Ok(best.map_or_else(|| fit.state(&fit.guess(Mesh::Touching, None)), |(_, found)| found))
}

/// Returns the state at the first sample, sought from that of a plant nearby.
pub(crate) fn refine(
    simulator: &mut Simulator,
    replayer: &Replayer,
    near: &PlantState,
) -> Result<PlantState, Error> {
    let mut fit = Fit::new(simulator, replayer);
    if fit.channels.is_empty() || !replayer.recording().has(Channel::Control) {
        return Ok(fit.state(&fit.guess(Mesh::Touching, None)));
    }
    fit.mesh = fit.mesh_of(near);
    fit.bending = fit.bending_of(near);
    let (_, found) = fit.descend(fit.unknowns(near))?;
    Ok(fit.state(&found))
}

/// Returns a start with each of its unknowns moved by a number of its steps.
pub(crate) fn nudge_start(
    simulator: &mut Simulator,
    replayer: &Replayer,
    near: &PlantState,
    steps: &[f64; UNKNOWNS],
) -> PlantState {
    let mut fit = Fit::new(simulator, replayer);
    fit.mesh = fit.mesh_of(near);
    fit.bending = fit.bending_of(near);
    let mut moved = fit.unknowns(near);
    (0..UNKNOWNS).for_each(|k| moved[k] += steps[k] * fit.steps[k]);
    fit.state(&fit.bound_unknowns(moved))
}

/// Returns a start moved as far as its readings leave it open: a draw of one standard deviation in each direction that they tell apart.
pub(crate) fn redraw_start(
    simulator: &mut Simulator,
    replayer: &Replayer,
    at: &PlantState,
) -> Result<PlantState, Error> {
    let mut fit = Fit::new(simulator, replayer);
    if fit.channels.is_empty() || !replayer.recording().has(Channel::Control) {
        return Ok(at.clone());
    }
    fit.mesh = fit.mesh_of(at);
    fit.bending = fit.bending_of(at);
    let now = fit.bound_unknowns(fit.unknowns(at));
    fit.anchor = now;
    let residuals = fit.residuals(&now)?;
    let step = fit.normal_equations(&now, &residuals)?.draw(&DRAWN);
    let mut moved = now;
    (0..UNKNOWNS).for_each(|k| moved[k] += step[k] * fit.steps[k]);
    Ok(fit.state(&fit.bound_unknowns(moved)))
}

/// The signs of a draw.
const DRAWN: Unknowns = [1.0, -1.0, 1.0, 1.0, -1.0, 1.0, -1.0, 1.0];

struct Fit<'a, 'b> {
    simulator: &'a mut Simulator,
    /// Copies of it for runs side by side, made when they are needed.
    beside: Vec<Simulator>,
    replayer: &'a Replayer<'b>,
    plant: Plant,
    platform_rate: f64,
    samples: usize,
    /// Channels that are fitted, with their floors.
    channels: Vec<(Channel, f64)>,
    /// Sizes of the unknowns' steps.
    steps: Unknowns,
    /// The start of the fit.
    anchor: Unknowns,
    /// The contact of the teeth at the start; if they do not touch, the gear's unknown is the place inside the gap.
    mesh: Mesh,
    /// The motion that the loop's sensor shows at the start.
    motion: FirstMotion,
    /// The bending of the structure at the start.
    bending: Bending,
}

/// Bending of the structure at the start.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Bending {
    /// As at rest: the acceleration that the first readings show is that of the structure's own vibration, or there is none.
    AtRest,
    /// As the acceleration bends it that the first readings show.
    ByAcceleration,
}

impl<'a, 'b> Fit<'a, 'b> {
    fn new(simulator: &'a mut Simulator, replayer: &'a Replayer<'b>) -> Self {
        let plant = simulator.plant().clone();
        let parameters = plant.parameters();
        let sensors = &parameters.sensors;
        let candidates = [
            (Channel::HubRate, Some(&sensors.hub_gyro)),
            (Channel::MotorRate, sensors.motor_tachometer.as_ref()),
            (Channel::HubPosition, sensors.hub_resolver.as_ref()),
        ];
        let channels = candidates
            .into_iter()
            .filter(|(channel, _)| replayer.recording().has(*channel))
            .filter_map(|(channel, sensor)| Some((channel, reading_floor(sensor?, &parameters.interface))))
            .collect();
        let recording = replayer.recording();
        let samples = (START_WINDOW_S / recording.sample_period_s)
            .round()
            .min(START_WINDOW_SHARE * recording.len() as f64) as usize;
        let steps = [
            START_ANGLE_STEP_RAD,
            1e-4,
            0.01 * parameters.pivot_friction.breakaway_nm().max(1.0),
            0.01 * parameters.motor_friction.breakaway_nm().max(1e-4),
            0.01 * parameters.pivot_friction.breakaway_nm().max(1e-2),
            1e-2,
            0.01 * plant.hose().map_or(0.0, |hose| hose.level_nm).max(1e-2),
            1e-4,
        ];
        let platform_rate = replayer.platform().pitch_rate_rad_s.at(0.0);
        Self {
            motion: FirstMotion::of(parameters, recording, platform_rate),
            bending: Bending::AtRest,
            platform_rate,
            samples: samples.clamp(1, replayer.samples),
            simulator,
            beside: Vec::new(),
            replayer,
            plant,
            channels,
            steps,
            anchor: [0.0; UNKNOWNS],
            mesh: Mesh::Touching,
        }
    }

    /// Returns half the gap, rad.
    fn half_gap(&self) -> f64 {
        0.5 * self.plant.parameters().gearbox.backlash_rad
    }

    /// Returns whether the teeth may be apart at the start: there is a gap, and dry friction alone can hold the hub.
    fn can_be_open(&self) -> bool {
        let weight = self.weight_nm(self.first_mean(Channel::HubPosition));
        self.half_gap() > 0.0 && weight.abs() <= self.plant.parameters().pivot_friction.breakaway_nm()
    }

    /// Returns whether the teeth touch in a state.
    fn mesh_of(&self, state: &PlantState) -> Mesh {
        if state.core[state::WINDUP].abs() < self.half_gap() { Mesh::Free } else { Mesh::Touching }
    }

    /// Returns the torque that the gear passes at the start, N m.
    fn mesh_torque_nm(&self, u: &Unknowns) -> f64 {
        if self.mesh == Mesh::Free { 0.0 } else { u[MESH] }
    }

    /// Returns the wind-up at the start, rad.
    fn windup_rad(&self, u: &Unknowns) -> f64 {
        match self.mesh {
            Mesh::Free => self.half_gap() * (u[MESH] / (STEPS_TO_FLANK * self.steps[MESH])).clamp(-1.0, 1.0),
            Mesh::Touching => {
                u[MESH] / self.plant.parameters().gearbox.stiffness_nm_rad
                    + self.half_gap() * u[MESH].signum()
            }
        }
    }

    /// Returns the mean of the first readings of a channel; 0 if there are none.
    fn first_mean(&self, channel: Channel) -> f64 {
        let column = self.replayer.recording().samples(channel).unwrap_or(&[]);
        let values: Vec<f64> = column.iter().take(FIRST_SAMPLES).copied().filter(|v| v.is_finite()).collect();
        if values.is_empty() { 0.0 } else { values.iter().sum::<f64>() / values.len() as f64 }
    }

    /// Returns the current that the first recorded control commands.
    fn commanded_current(&self) -> Option<f64> {
        let control = *self.replayer.recording().samples(Channel::Control)?.first()?;
        let (amplifier, motor) = (&self.plant.parameters().amplifier, &self.plant.parameters().motor);
        let current = amplifier.drive_v(control, motor) * amplifier.stall_gain_a_v(motor);
        current.is_finite().then_some(current)
    }

    /// Returns the hub angle that the first readings show; 0 if none does.
    fn first_angle(&self) -> f64 {
        self.motion.angle_rad.unwrap_or_else(|| self.first_mean(Channel::HubPosition))
    }

    /// Returns the hub's rate on the platform that the first readings show.
    fn first_rate(&self) -> f64 {
        if self.replayer.recording().has(Channel::MotorRate) {
            self.first_mean(Channel::MotorRate) / self.plant.parameters().gearbox.ratio
        } else if self.motion.is_moving() {
            self.motion.rate_rad_s
        } else {
            0.0
        }
    }

    /// Returns a start at rest or in steady motion, with the current given or as the weight needs it: friction carries what is left.
    fn guess(&self, mesh: Mesh, current: Option<f64>) -> Unknowns {
        let parameters = self.plant.parameters();
        let (angle, rate) = (self.first_angle(), self.first_rate());
        let weight = self.weight_nm(angle);
        let (ratio, constant) = (parameters.gearbox.ratio, parameters.motor.torque_constant_nm_a);
        if mesh == Mesh::Free {
            return [angle, rate, 0.0, 0.0, -weight, 0.0, 0.0, 0.0];
        }
        let (motor, pivot) =
            (parameters.motor_friction.breakaway_nm(), parameters.pivot_friction.breakaway_nm());
        let current = current.unwrap_or(weight / (ratio * constant));
        // the surplus of the motor is shared by the two frictions in proportion to their levels
        let surplus = ratio * constant * current - weight;
        let share = surplus / (ratio * motor + pivot).max(f64::MIN_POSITIVE);
        let share = share.clamp(-1.0, 1.0);
        let mesh = weight + pivot * share;
        [angle, rate, mesh, motor * share, pivot * share, current, 0.0, 0.0]
    }

    /// Returns a start in motion: both frictions act against it, and the gear passes what accelerates the hub.
    fn guess_in_motion(&self, current: Option<f64>) -> Unknowns {
        let (angle, rate) = (self.first_angle(), self.first_rate());
        let parameters = self.plant.parameters();
        let sense = rate.signum();
        let (motor, pivot) = (
            sense * parameters.motor_friction.breakaway_nm(),
            sense * parameters.pivot_friction.breakaway_nm(),
        );
        let (ratio, constant) = (parameters.gearbox.ratio, parameters.motor.torque_constant_nm_a);
        let acceleration = self.motion.acceleration_rad_s2;
        let mesh = self.weight_nm(angle)
            + pivot
            + parameters.pivot_friction.viscous_nm_s_rad * rate
            + self.plant.body().inertia_kg_m2 * acceleration;
        let at_the_motor = mesh / ratio
            + motor
            + ratio
                * (parameters.motor_friction.viscous_nm_s_rad * rate
                    + parameters.motor.inertia_kg_m2 * acceleration);
        [angle, rate, mesh, motor, pivot, current.unwrap_or(at_the_motor / constant), 0.0, 0.0]
    }

    /// Returns the torque of weight and spring that the gear must pass, N m.
    fn weight_nm(&self, angle: f64) -> f64 {
        let body = self.plant.body();
        let (sin, cos) = self.plant.tilt(angle);
        let gravity = self.plant.parameters().gravity_m_s2 + self.replayer.platform().heave_m_s2.at(0.0);
        gravity * (body.out_of_balance_kg_m * cos - body.vertical_offset_kg_m * sin)
            - self.plant.support_torque_nm(angle)
    }

    /// Returns the state of the plant that the unknowns describe.
    fn state(&self, u: &Unknowns) -> PlantState {
        let parameters = self.plant.parameters();
        let mut start = self.simulator.rest(u[ANGLE], 0.0, self.platform_rate + u[RATE]);
        let motor_rate = parameters.gearbox.ratio * (u[RATE] + u[TWIST]);
        let motor = &parameters.motor;
        let voltage_v = motor.resistance_ohm * u[CURRENT] + motor.back_emf_v_s_rad * motor_rate;
        let of_states = [
            (state::MOTOR, motor_rate + motor.platform_coupling * self.platform_rate),
            (state::WINDUP, self.windup_rad(u)),
            (state::CURRENT, u[CURRENT]),
            (
                state::VOLTAGE,
                parameters.cylinder.as_ref().map_or(voltage_v, |one| one.opening_l_s(voltage_v, u[CURRENT])),
            ),
        ];
        for (index, value) in
            of_states.into_iter().filter(|(index, _)| self.plant.has_mechanism_state(*index))
        {
            start.core[index] = value;
        }
        if self.bending == Bending::ByAcceleration {
            for (k, deflection) in self.deflections().enumerate() {
                start.core[state::MODES + 2 * k] += deflection;
            }
        }
        start.friction = FrictionState {
            motor: parameters.motor_friction.state_at_torque(u[MOTOR_DRY]),
            pivot: parameters.pivot_friction.state_at_torque(u[PIVOT_DRY]),
            hose: u[HOSE],
            gear: 0.0,
        };
        let platform = MotionAtStart { angle_rad: 0.0, rate_rad_s: self.platform_rate };
        start.hub_gyro = self.motion.sensor_state(
            loop_sensor_input(&self.plant, &start.core, platform),
            &parameters.sensors.hub_gyro,
        );
        start
    }

    /// Returns what the acceleration at the start adds to the deflection of each mode of the structure at rest: w^2 q = phi J a.
    fn deflections(&self) -> impl Iterator<Item = f64> + '_ {
        let body = self.plant.body();
        let turned_nm = body.inertia_kg_m2 * self.motion.acceleration_rad_s2;
        body.modes.iter().map(move |mode| mode.hub_shape * turned_nm / mode.frequency_rad_s.powi(2))
    }

    /// Returns the bending of a state: the one whose deflection of the first mode is nearer.
    fn bending_of(&self, near: &PlantState) -> Bending {
        let rest = self.simulator.rest(near.core[state::ANGLE], 0.0, near.core[state::RATE]);
        let Some(deflection) = self.deflections().next() else { return Bending::AtRest };
        let found = near.core[state::MODES] - rest.core[state::MODES];
        if found.abs() > 0.5 * deflection.abs() { Bending::ByAcceleration } else { Bending::AtRest }
    }

    /// Returns the unknowns of a state.
    fn unknowns(&self, state: &PlantState) -> Unknowns {
        let parameters = self.plant.parameters();
        let windup = state.core[state::WINDUP];
        let half_gap = self.half_gap().min(windup.abs()) * windup.signum();
        [
            state.core[state::ANGLE],
            state.core[state::RATE] - self.platform_rate,
            if parameters.gearbox.is_rigid() {
                self.weight_nm(state.core[state::ANGLE])
            } else if self.mesh == Mesh::Free {
                STEPS_TO_FLANK * self.steps[MESH] * windup / self.half_gap()
            } else {
                parameters.gearbox.stiffness_nm_rad * (windup - half_gap)
            },
            parameters.motor_friction.torque_at_state_nm(state.friction.motor),
            parameters.pivot_friction.torque_at_state_nm(state.friction.pivot),
            state.core[state::CURRENT],
            state.friction.hose,
            if start_has(parameters, TWIST) {
                let of_platform = parameters.motor.platform_coupling * self.platform_rate;
                (state.core[state::MOTOR] - of_platform) / parameters.gearbox.ratio
                    - (state.core[state::RATE] - self.platform_rate)
            } else {
                0.0
            },
        ]
    }

    /// Returns whether noise alone explains a cost.
    fn is_explained(&self, cost: f64) -> bool {
        cost < START_EXPLAINED * (self.samples * self.channels.len()) as f64
    }

    /// Weighted residuals over the window, and those of the balance of torques.
    fn residuals(&mut self, u: &Unknowns) -> Result<Vec<f64>, Error> {
        let start = self.state(u);
        let scenario = self.replayer.scenario(self.samples, &start);
        let history = self.simulator.run(&mut self.replayer.playback()?, &scenario)?;
        Ok(self.residuals_in(u, &history))
    }

    /// Returns the residuals of several starts, which run side by side.
    fn residuals_of_each(&mut self, all: &[Unknowns]) -> Result<Vec<Vec<f64>>, Error> {
        let mut residuals = Vec::with_capacity(all.len());
        for few in all.chunks(SIDE_BY_SIDE) {
            while self.beside.len() + 1 < few.len() {
                self.beside.push(self.simulator.clone());
            }
            let scenario = |u: &Unknowns| self.replayer.scenario(self.samples, &self.state(u));
            let scenarios: Vec<Scenario> = few.iter().map(scenario).collect();
            let controls = few.iter().map(|_| self.replayer.playback());
            let mut controls: Vec<Playback> = controls.collect::<Result<_, _>>()?;
            let simulators = std::iter::once(&mut *self.simulator).chain(&mut self.beside);
            let runs = simulators.zip(&mut controls).zip(&scenarios);
            let mut variants: Vec<EnsembleRun> = runs
                .map(|((simulator, controller), scenario)| EnsembleRun {
                    simulator,
                    controller,
                    scenario,
                    watch: None,
                })
                .collect();
            let histories = run_ensemble(&mut variants);
            drop(variants);
            for (u, history) in few.iter().zip(histories) {
                residuals.push(self.residuals_in(u, &history?));
            }
        }
        Ok(residuals)
    }

    /// Returns the residuals of a run.
    fn residuals_in(&self, u: &Unknowns, history: &TimeHistory) -> Vec<f64> {
        let mut residuals = Vec::with_capacity(self.samples * self.channels.len() + 2);
        for &(channel, floor) in &self.channels {
            let recorded = self.replayer.recording().samples(channel).unwrap_or(&[]);
            let pairs = history.readings.channel(channel).iter().zip(recorded);
            residuals.extend(pairs.map(|(s, r)| if r.is_finite() { (r - s) / floor } else { 0.0 }));
        }
        residuals.extend(self.imbalance(u));
        residuals.extend((0..UNKNOWNS).map(|k| (u[k] - self.anchor[k]) / (FAR * self.steps[k])));
        residuals
    }

    fn imbalance(&self, u: &Unknowns) -> [f64; 2] {
        let parameters = self.plant.parameters();
        // what accelerates at the start is in no balance of the torques
        let acceleration = self.motion.acceleration_rad_s2;
        let of_motor = parameters.motor.inertia_kg_m2 * parameters.gearbox.ratio * acceleration;
        let of_hub = self.plant.body().inertia_kg_m2 * acceleration;
        let motor_scale = (IMBALANCE * parameters.motor_friction.breakaway_nm().max(1e-3)).hypot(of_motor);
        let pivot_scale = (IMBALANCE * parameters.pivot_friction.breakaway_nm().max(1.0)).hypot(of_hub);
        let motor = parameters.motor.torque_constant_nm_a * u[CURRENT]
            - u[MOTOR_DRY]
            - parameters.motor_friction.viscous_nm_s_rad * parameters.gearbox.ratio * u[RATE]
            - self.mesh_torque_nm(u) / parameters.gearbox.ratio;
        let hub = self.mesh_torque_nm(u)
            - u[PIVOT_DRY]
            - u[HOSE]
            - parameters.pivot_friction.viscous_nm_s_rad * u[RATE]
            - self.weight_nm(u[ANGLE]);
        [motor / motor_scale, hub / pivot_scale]
    }

    /// Levenberg and Marquardt from a guess: the cost and the unknowns.
    fn descend(&mut self, guess: Unknowns) -> Result<(f64, Unknowns), Error> {
        let mut now = self.bound_unknowns(guess);
        self.anchor = now;
        let mut residuals = self.residuals(&now)?;
        let mut cost = squares(&residuals);
        let mut damping = 1e-3;
        let mut normal = self.normal_equations(&now, &residuals)?;
        for _ in 0..START_ITERATIONS {
            let mut next = now;
            let step = normal.solve(damping);
            (0..UNKNOWNS).for_each(|k| next[k] += step[k] * self.steps[k]);
            let next = self.bound_unknowns(next);
            let tried = self.residuals(&next)?;
            let new_cost = squares(&tried);
            if new_cost < cost {
                let fall = (cost - new_cost) / cost;
                (now, residuals, cost) = (next, tried, new_cost);
                damping = (damping * 0.2).max(LEAST_DAMPING);
                if fall < START_FLAT {
                    break;
                }
                normal = self.normal_equations(&now, &residuals)?;
            } else if damping > START_STUCK {
                break;
            } else {
                damping *= 10.0;
            }
        }
        Ok((cost, now))
    }

    /// Friction and a hose within their levels.
    fn bound_unknowns(&self, mut u: Unknowns) -> Unknowns {
        let parameters = self.plant.parameters();
        let (motor, pivot) =
            (parameters.motor_friction.breakaway_nm(), parameters.pivot_friction.breakaway_nm());
        u[MOTOR_DRY] = u[MOTOR_DRY].clamp(-motor, motor);
        u[PIVOT_DRY] = u[PIVOT_DRY].clamp(-pivot, pivot);
        let hose = self.plant.hose().map_or(0.0, |hose| hose.level_nm);
        u[HOSE] = u[HOSE].clamp(-hose, hose);
        u
    }

    /// Returns the normal equations by forward differences, taken inwards when friction is at its level.
    fn normal_equations(
        &mut self,
        at: &Unknowns,
        residuals: &[f64],
    ) -> Result<NormalEquations<UNKNOWNS>, Error> {
        let free: Vec<usize> = (0..UNKNOWNS).filter(|&k| start_has(self.plant.parameters(), k)).collect();
        let sign = |k: usize| {
            let inwards = matches!(k, MOTOR_DRY | PIVOT_DRY | HOSE) && at[k] > 0.0;
            if inwards { -1.0 } else { 1.0 }
        };
        let moved = |k: &usize| {
            let mut moved = *at;
            moved[*k] += sign(*k) * self.steps[*k];
            moved
        };
        let moved: Vec<Unknowns> = free.iter().map(moved).collect();
        let mut columns = vec![vec![0.0; residuals.len()]; UNKNOWNS];
        for (k, shifted) in free.into_iter().zip(self.residuals_of_each(&moved)?) {
            columns[k] = shifted.iter().zip(residuals).map(|(a, b)| sign(k) * (a - b)).collect();
        }
        Ok(NormalEquations::of(&columns, residuals))
    }
}
