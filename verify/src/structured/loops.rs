//! The uncertain parameters pulled out of a sampled loop.
//!
//! ```text
//!          .--> Delta --.                 z = M w,   w = Delta z
//!        z |            | w
//!          '---- M <----'
//! ```
//!
//! Real parameters act inside the continuous plant, each as a force or a voltage that its deviation adds; complex ones on the sampled
//! control and on the sampled reading of the hub's gyroscope. M(jw) is exact for one tone: what a real parameter sends round through
//! the aliases of that tone, which the hold and the plant weaken, is left out.

use std::collections::HashMap;

use counterpoise_controller::{COMMON_READINGS, Controller};
use counterpoise_linalg::{C64, CMat, Mat};
use counterpoise_lti::scaling::balance;
use counterpoise_lti::{Response, StateSpace, Timebase, feedback};
use counterpoise_models::ControlledQuantity;
use counterpoise_models::parameters::Parameters;
use counterpoise_models::plant::core::state;
use counterpoise_models::plant::{LinearPlant, OperatingPoint, Plant};

use super::blocks::{PerturbationBlock, PerturbationStructure};
use super::channels::{Base, Channel, build_base, channels_of};
use super::closing::linearise;
use super::factor::Factor;
use super::places::{LinearisedDryFriction, Place};
use super::taylor::{RateInterval, SchurSystem, Taylor};
use crate::Error;
use crate::linear_loop::closed_loop::resolver_use;
use crate::linear_loop::plant::port;
use crate::linear_loop::plant_response::hold_and_delay;
use crate::linear_loop::{ClosedLoop, SampledPlant};

/// Readings that the loop goes through: hub gyroscope, tachometer, resolver.
const FED_BACK: [usize; 3] = [1, 4, 5];
/// The hub gyroscope among all readings.
const HUB_GYRO: usize = 1;

/// A parameter that is off, with the places where it acts.
#[derive(Debug, Clone, PartialEq)]
pub struct UncertainParameter {
    /// Factor over the deviation.
    pub factor: Factor,
    /// Places at which it acts.
    pub places: Vec<Place>,
}

/// The linear systems of which M is made, for whoever computes M elsewhere.
#[derive(Debug, Clone, PartialEq)]
pub struct PulledLoop {
    /// The structure of Delta.
    pub structure: PerturbationStructure,
    /// The continuous mechanism: from what each deviation adds and the control to what each deviation is proportional to and the readings
    /// of hub gyroscope, tachometer and resolver before their delays.
    pub mechanism: StateSpace,
    /// From the control to all readings, as they are sampled.
    pub sampled: StateSpace,
    /// From all readings to the control.
    pub controller: StateSpace,
    /// Whole samples by which the control is late.
    pub control_delay_samples: usize,
    /// Whole samples by which each reading is late.
    pub reading_delays_samples: Vec<usize>,
    /// Relative errors at the plant's input and of the hub gyroscope's reading.
    pub errors: [f64; 2],
    /// Quantity that the loop controls.
    pub controlled: ControlledQuantity,
}

/// A loop with its uncertain parts pulled out.
pub struct UncertainLoop {
    /// The structure of Delta: the parameters in order, then the errors at the plant's input and output that are not 0.
    pub structure: PerturbationStructure,
    /// The systems that M is made of, in coordinates of their own.
    made_of: [StateSpace; 3],
    systems: Systems,
    extended: Response,
    sampled: Response,
    controller: Response,
    plant: SampledPlant,
    errors: [f64; 2],
    channels: usize,
}

/// The systems of the loop, in balanced coordinates.
struct Systems {
    extended: SchurSystem,
    /// From the readings without control to the control, the sampled loop closed; `None` if the loop is algebraically singular.
    closed: Option<SchurSystem>,
}

/// M over an interval of rates: direct + control x reading, where `reading` is the control that a tone of each channel causes in the
/// closed loop, and `control` is what a tone of the control does at each channel through the hold.
pub struct Pieces {
    /// Direct rows of the mechanism alone.
    pub direct: Vec<Vec<Taylor>>,
    /// Per channel.
    pub control: Vec<Taylor>,
    /// Per channel.
    pub reading: Vec<Taylor>,
}

impl UncertainLoop {
    /// Pulls the uncertain parameters out of the loop of `nominal` (whose dry friction does not act, `dry` being in its place) and `controller`; `errors` are the
    /// relative errors of any phase at the plant's input and at the hub gyroscope's reading.
    ///
    /// # Errors
    /// Those of the models, of the sampling and of the connection.
    pub fn new(
        nominal: &Parameters,
        dry: LinearisedDryFriction,
        controller: &Controller,
        at: &OperatingPoint,
        uncertain: &[UncertainParameter],
        errors: [f64; 2],
    ) -> Result<Self, Error> {
        let body = Plant::from_lumped(nominal)?;
        let linear = linearise(&body, at, &dry)?;
        let body = body.local_at(&linear.equilibrium);
        let plant = SampledPlant::new(&linear, nominal, resolver_use(controller))?;
        let moment = controller.parts().design_out_of_balance_kg_m;
        let closed = ClosedLoop::new(&plant, Some(controller), moment)?;
        let K = closed.controller.ok_or(Error::NoController)?;
        let base = build_base(&body, drive_slope(&body, &linear), resolver_use(controller), dry.springs);
        let mut structure = PerturbationStructure::default();
        let mut channels = Vec::new();
        for one in uncertain {
            let own: Vec<Channel> =
                one.places.iter().flat_map(|place| channels_of(*place, &body, &base, &dry)).collect();
            if !own.is_empty() {
                structure.blocks.push(PerturbationBlock::Real { repeated: own.len() });
            }
            channels.extend(own.into_iter().map(|channel| UncertainChannel { channel, factor: one.factor }));
        }
        structure
            .blocks
            .extend(errors.iter().filter(|error| **error > 0.0).map(|_| PerturbationBlock::Complex));
        let readings: Vec<usize> = (port::FIRST_READING..plant.sampled.outputs()).collect();
        let extended = extended_system(&base, &channels)?;
        let sampled = plant.sampled.select(&readings, &[port::CONTROL]);
        let evaluated = |system: &StateSpace| SchurSystem::of(&balance(system).0);
        Ok(Self {
            structure,
            extended: Response::of(&extended)?,
            sampled: Response::of(&sampled)?,
            controller: Response::of(&K)?,
            systems: Systems {
                extended: evaluated(&extended)?,
                closed: feedback(&K, &sampled.negate()).ok().as_ref().map(evaluated).transpose()?,
            },
            made_of: [extended, sampled, K],
            plant,
            errors,
            channels: channels.len(),
        })
    }

    /// Returns the systems of which M is made.
    pub fn pulled_loop(&self) -> PulledLoop {
        let [mechanism, sampled, controller] = self.made_of.clone();
        PulledLoop {
            structure: self.structure.clone(),
            mechanism,
            sampled,
            controller,
            control_delay_samples: self.plant.delays.control,
            reading_delays_samples: self.plant.reading_delays_samples(),
            errors: self.errors,
            controlled: self.plant.controlled,
        }
    }

    /// Returns the sample period, s.
    pub fn sample_period_s(&self) -> f64 {
        self.plant.sample_period_s
    }

    /// Returns the parts of M over an interval of rates, for a loop without errors at the plant's input and output; `None` if a pole
    /// is in the middle of the interval, or if the loop is algebraically singular.
    pub fn pieces_over(&self, interval: RateInterval) -> Option<Pieces> {
        let m = self.channels;
        let G = self.systems.extended.evaluate_over(interval)?;
        let K = self.systems.closed.as_ref()?.evaluate_over(interval)?;
        let none = Taylor::constant(C64::new(0.0, 0.0), interval);
        let period_s = self.plant.sample_period_s;
        let control_s = period_s * self.plant.delays.control as f64;
        let held = Taylor::hold(period_s, interval) * Taylor::delay(control_s, interval);
        let read = |j: usize| {
            FED_BACK.iter().enumerate().fold(none, |sum, (row, &i)| {
                let late = Taylor::delay(period_s * self.plant.delays.readings[i].samples as f64, interval);
                sum + K[0][i] * G[m + row][j] * late
            })
        };
        Some(Pieces {
            direct: (0..m).map(|i| G[i][..m].to_vec()).collect(),
            control: (0..m).map(|i| G[i][m] * held).collect(),
            reading: (0..m).map(read).collect(),
        })
    }

    /// Returns M at each rate in rad/s.
    ///
    /// # Errors
    /// A response that does not exist because of a pole.
    pub fn at(&self, rates_rad_s: &[f64]) -> Result<Vec<CMat>, Error> {
        let G = self.extended.at_all(rates_rad_s)?;
        let P = self.sampled.at_all(rates_rad_s)?;
        let K = self.controller.at_all(rates_rad_s)?;
        Ok((0..rates_rad_s.len())
            .map(|k| self.closed_response(rates_rad_s[k], &G[k], &P[k], &K[k]))
            .collect())
    }

    /// With the computed control u, the tones of the readings y = P (u + w_u) + R w + e w_y, and u = K y.
    fn closed_response(&self, rate: f64, G: &CMat, P: &CMat, K: &CMat) -> CMat {
        let m = self.channels;
        let zero = C64::new(0.0, 0.0);
        let KP: C64 = (0..COMMON_READINGS).map(|i| K[(0, i)] * P[(i, 0)]).sum();
        let open = C64::new(1.0, 0.0) / (C64::new(1.0, 0.0) - KP);
        let late = |i: usize| {
            let samples = self.plant.delays.readings[i].samples as f64;
            C64::from_polar(1.0, -rate * self.plant.sample_period_s * samples)
        };
        // the tone of reading i for input j of the continuous plant
        let tone = |i: usize, j: usize| {
            FED_BACK.iter().position(|fed| *fed == i).map_or(zero, |row| G[(m + row, j)] * late(i))
        };
        let held = hold_and_delay(&self.plant, rate);
        let kinds: Vec<usize> = (0..2).filter(|k| self.errors[*k] > 0.0).collect();
        let size = m + kinds.len();
        let mut M = CMat::zeros(size, size);
        for j in 0..size {
            let error = (j >= m).then(|| kinds[j - m]);
            let computed = open
                * match error {
                    None => (0..COMMON_READINGS).map(|i| K[(0, i)] * tone(i, j)).sum::<C64>(),
                    Some(0) => KP,
                    Some(_) => K[(0, HUB_GYRO)],
                };
            let applied = computed + if error == Some(0) { C64::new(1.0, 0.0) } else { zero };
            for i in 0..m {
                let direct = if error.is_none() { G[(i, j)] } else { zero };
                M[(i, j)] = direct + G[(i, m)] * held * applied;
            }
            for (row, kind) in kinds.iter().enumerate() {
                let felt =
                    P[(HUB_GYRO, 0)] * applied + if error.is_none() { tone(HUB_GYRO, j) } else { zero };
                M[(m + row, j)] = if *kind == 0 { computed } else { felt } * self.errors[*kind];
            }
        }
        M
    }
}

/// A channel by which a parameter enters, with the factor of the parameter.
struct UncertainChannel {
    channel: Channel,
    factor: Factor,
}

/// (w, control) -> (z, readings). Parameters at one place multiply; a factor (1 + a d) / (1 + b d) turns w = (f - 1) z into
/// w = d ((a - b) z - b w).
fn extended_system(base: &Base, channels: &[UncertainChannel]) -> Result<StateSpace, Error> {
    let (n, m) = (base.A.nrows(), channels.len());
    let B = Mat::from_fn(n, m + 1, |i, j| channels.get(j).map_or(base.control[i], |c| c.channel.column[i]));
    let mut C = Mat::zeros(m + base.readings.len(), n);
    let mut D = Mat::zeros(m + base.readings.len(), m + 1);
    let mut before: HashMap<(usize, usize), Vec<usize>> = HashMap::new();
    for (k, UncertainChannel { channel, factor }) in channels.iter().enumerate() {
        let d = Mat::row(&channel.derivative);
        let (state, direct) = (&d * &base.A, &d * &B);
        (0..n).for_each(|j| C[(k, j)] = channel.row[j] + state[(0, j)]);
        (0..=m).for_each(|j| D[(k, j)] = direct[(0, j)]);
        let same = before.entry((channel.place.0 as usize, channel.place.1)).or_default();
        same.iter().for_each(|&other| D[(k, other)] += 1.0);
        same.push(k);
        let slope = factor.a - factor.b;
        (0..n).for_each(|j| C[(k, j)] *= slope);
        (0..=m).for_each(|j| D[(k, j)] *= slope);
        D[(k, k)] -= factor.b;
    }
    for (k, row) in base.readings.iter().enumerate() {
        (0..n).for_each(|j| C[(m + k, j)] = row[j]);
    }
    let kept: Vec<usize> = (0..n).filter(|&s| s != state::ANGLE && has_dynamics(base, s)).collect();
    let all_rows: Vec<usize> = (0..C.nrows()).collect();
    let all_columns: Vec<usize> = (0..=m).collect();
    let (A, B) = (base.A.select(&kept, &kept), B.select(&kept, &all_columns));
    Ok(StateSpace::new(A, B, C.select(&all_rows, &kept), D, Timebase::Continuous)?)
}

/// Returns what the drive's states receive of the control, or the slope of the amplifier's map if it has none.
fn drive_slope(plant: &Plant, linear: &LinearPlant) -> f64 {
    match plant.drive_states().count() {
        0 => plant.drive_slope(&linear.equilibrium),
        // the states of the drive come first
        count => (0..count).rev().map(|k| linear.system.B[(k, 0)]).sum(),
    }
}

/// Returns whether a state has dynamics: the places of sensors that are not there stay empty.
fn has_dynamics(base: &Base, s: usize) -> bool {
    (0..base.A.nrows()).any(|j| base.A[(s, j)] != 0.0 || base.A[(j, s)] != 0.0)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::linear_loop::plant::Resolver;
    use crate::robustness::{Distribution, VariedParameter, varied_parameters};
    use crate::structured::places::parameter_places;
    use counterpoise_models::plant::{Angles, FrictionLinearisation};

    /// Hub gyroscope's reading over the control of the mechanism with the given factor, straight from its linearisation.
    fn direct(parameters: &Parameters, rate: f64) -> C64 {
        let body = Plant::from_lumped(parameters).unwrap();
        let at = body.equilibrium(&OperatingPoint::default());
        let linear = body.linearise(&at, FrictionLinearisation::Viscous, Angles::Drop).unwrap();
        let plant = SampledPlant::new(&linear, parameters, Resolver::Unread).unwrap();
        let G = Response::of(&plant.continuous).unwrap().at(rate).unwrap();
        G[(port::CURRENT + HUB_GYRO, 0)]
    }

    /// The same with the deviation closed around the extended plant.
    fn pulled_out(
        parameters: &Parameters,
        varied: VariedParameter,
        factor: Factor,
        delta: f64,
        rate: f64,
    ) -> C64 {
        let body = Plant::from_lumped(parameters).unwrap();
        let at = body.equilibrium(&OperatingPoint::default());
        let linear = body.linearise(&at, FrictionLinearisation::Viscous, Angles::Drop).unwrap();
        let slope = linear.system.B[(state::CURRENT, 0)] + linear.system.B[(state::VOLTAGE, 0)];
        let base = build_base(&body, slope, Resolver::Unread, [0.0; 2]);
        let channels: Vec<UncertainChannel> = parameter_places(varied)
            .iter()
            .flat_map(|place| channels_of(*place, &body, &base, &LinearisedDryFriction::default()))
            .map(|channel| UncertainChannel { channel, factor })
            .collect();
        let m = channels.len();
        let G = Response::of(&extended_system(&base, &channels).unwrap()).unwrap().at(rate).unwrap();
        let rows: Vec<usize> = (0..m).collect();
        let d = C64::new(delta, 0.0);
        let loop_matrix = &CMat::eye(m) - &G.select(&rows, &rows).scale(d);
        let z = counterpoise_linalg::csolve(&loop_matrix, &G.select(&rows, &[m])).unwrap();
        G[(m, m)] + (&G.select(&[m], &rows) * &z)[(0, 0)] * d
    }

    #[test]
    fn a_deviation_closed_around_the_plant_is_the_plant_that_deviates() {
        let rig = counterpoise_models::reference::rig();
        let factor = Factor::of(Distribution::Uniform { low: 0.6, high: 1.9 });
        let of_sliding_plant = |varied: &VariedParameter| !varied.is_of_controller();
        for (varied, key) in varied_parameters::ALL.into_iter().filter(|(varied, _)| of_sliding_plant(varied))
        {
            for delta in [0.0, 0.8, -0.9] {
                let mut parameters = rig.clone();
                varied.scale(&mut parameters, factor.at(delta)).unwrap();
                for rate in [1.0, 60.0, 280.0, 900.0] {
                    let (found, told) =
                        (pulled_out(&rig, varied, factor, delta, rate), direct(&parameters, rate));
                    assert!(
                        (found - told).norm() < 1e-6 * told.norm(),
                        "{key} {delta} {rate}: {found} {told}"
                    );
                }
            }
        }
    }
}
