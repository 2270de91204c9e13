//! The choice: every demand of the menu is simulated with every machine that is left, and the one stands first that separates the two
//! machines best that are hardest to tell apart.

use counterpoise_models::{Parameters, Plant};
use counterpoise_recordings::Channel;
use counterpoise_simulate::replay::{RecordedController, reading_floor};
use counterpoise_simulate::{
    Detail, Firing, Imperfections, Initial, PlatformMotion, Scenario, Signal, Simulator, TimeHistory,
};

use super::menu::{Demand, DemandShape, Limits, list_demands};
use super::separation::{ExpectedSignals, PossibleMachine, Separation, separation};
use crate::library::EffectParameter;
use crate::tolerance::FIT_STEP;
use crate::tolerance::experiment::{LEAST_FLOOR, OVERSHOOT, STEPS_PER_SAMPLE};
use counterpoise_pool::{Pool, map};

/// Input of the planning of an experiment.
pub struct ExperimentRequest<'a> {
    /// The machines that are left, the likeliest first.
    pub machines: &'a [PossibleMachine],
    /// The controller in the loop.
    pub controller: &'a RecordedController,
    /// Hub angle at the start, rad.
    pub start_angle_rad: f64,
    /// Limits.
    pub limits: Limits,
}

/// Largest angle, rate and current of all machines in an experiment.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ExperimentExtremes {
    /// Angle from the start, rad.
    pub angle_rad: f64,
    /// Rate, rad/s.
    pub rate_rad_s: f64,
    /// Current, A.
    pub current_a: f64,
}

impl ExperimentExtremes {
    /// Returns the larger of each two values.
    #[must_use]
    pub fn larger_of(&self, other: &Self) -> Self {
        Self {
            angle_rad: self.angle_rad.max(other.angle_rad),
            rate_rad_s: self.rate_rad_s.max(other.rate_rad_s),
            current_a: self.current_a.max(other.current_a),
        }
    }
}

/// An experiment of the menu that keeps the limits.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedExperiment {
    /// The demand's shape.
    pub shape: DemandShape,
    /// The demand as the controller reads it: a rate, or an angle if the loop controls that.
    pub demand: Vec<f64>,
    /// Separation of each two machines.
    pub separations: Vec<Separation>,
    /// Largest values that the machines reach.
    pub reached: ExperimentExtremes,
}

impl PlannedExperiment {
    /// Returns the separation of the two machines that are hardest to tell apart.
    pub fn weakest_separation(&self) -> Option<&Separation> {
        self.separations.iter().min_by(|a, b| a.log_likelihood_ratio.total_cmp(&b.log_likelihood_ratio))
    }
}

/// The experiments that keep the limits, with the machines that they separate.
#[derive(Debug, Clone, Default)]
pub struct ExperimentPlan {
    /// The machines that keep the limits with at least one demand: separations refer to them by their places.
    pub machines: Vec<PossibleMachine>,
    /// The experiments, the one first that separates best.
    pub experiments: Vec<PlannedExperiment>,
    /// The motion of every machine in the best experiment.
    pub motions: Vec<MachineMotion>,
}

/// The motion of a machine in an experiment, sample by sample.
#[derive(Debug, Clone, PartialEq)]
pub struct MachineMotion {
    /// Sample period, s.
    pub period_s: f64,
    /// Angle from the start, rad.
    pub angle_rad: Vec<f64>,
    /// Rate, rad/s.
    pub rate_rad_s: Vec<f64>,
    /// Current, A.
    pub current_a: Vec<f64>,
}

/// Returns the plan within the limits; it has no experiments if fewer than two machines keep them.
pub fn choose_experiment(request: &ExperimentRequest, pool: &dyn Pool) -> ExperimentPlan {
    let Some(first) = request.machines.first() else { return ExperimentPlan::default() };
    let demands = list_demands(&request.limits, first.parameters.interface.sample_period_s);
    let machines = request.that_keep_limits(&demands, pool);
    if machines.len() < 2 {
        return ExperimentPlan { machines, ..ExperimentPlan::default() };
    }
    let request = ExperimentRequest { machines: &machines, ..*request };
    let count = demands.len();
    let tried = map(pool, count, |k| {
        pool.progress("planning", k, count);
        request.try_demand(&demands[k])
    });
    let mut experiments: Vec<PlannedExperiment> = tried.into_iter().flatten().collect();
    let weakest = |e: &PlannedExperiment| e.weakest_separation().map_or(0.0, |s| s.log_likelihood_ratio);
    experiments.sort_by(|a, b| weakest(b).total_cmp(&weakest(a)));
    let motions = experiments.first().map_or_else(Vec::new, |best| request.motions(&best.demand));
    ExperimentPlan { machines, experiments, motions }
}

impl ExperimentRequest<'_> {
    /// Returns the machines that keep the limits with at least one demand; a machine that keeps them with none cannot be the one whose
    /// recordings were made in this loop.
    fn that_keep_limits(&self, demands: &[Demand], pool: &dyn Pool) -> Vec<PossibleMachine> {
        let keeps = map(pool, self.machines.len(), |k| {
            let bare = PossibleMachine { free: Vec::new(), ..self.machines[k].clone() };
            demands
                .iter()
                .rev()
                .any(|demand| self.expected_recording(&bare, &self.demand_readings(demand)).is_some())
        });
        let kept = self.machines.iter().zip(keeps).filter(|(_, keeps)| *keeps);
        kept.map(|(machine, _)| machine.clone()).collect()
    }

    /// Returns a demand as the controller reads it.
    fn demand_readings(&self, demand: &Demand) -> Vec<f64> {
        let machine = &self.machines[0].parameters;
        if self.controller.demands_position() || machine.sensors.measured.is_position() {
            demand.angle_rad.iter().map(|angle| self.start_angle_rad + angle).collect()
        } else {
            demand.rate_rad_s.clone()
        }
    }

    /// Simulates a demand with every machine; `None` if one of them leaves the limits or cannot be simulated.
    fn try_demand(&self, demand: &Demand) -> Option<PlannedExperiment> {
        let demanded = self.demand_readings(demand);
        let mut reached = ExperimentExtremes::default();
        let mut expected = Vec::new();
        for possible in self.machines {
            let (one, farthest) = self.expected_recording(possible, &demanded)?;
            reached.angle_rad = reached.angle_rad.max(farthest.angle_rad);
            reached.rate_rad_s = reached.rate_rad_s.max(farthest.rate_rad_s);
            reached.current_a = reached.current_a.max(farthest.current_a);
            expected.push(one);
        }
        let pairs = (0..expected.len()).flat_map(|i| (i + 1..expected.len()).map(move |j| [i, j]));
        let separations = pairs.map(|[i, j]| separation([i, j], &expected[i], &expected[j])).collect();
        Some(PlannedExperiment { shape: demand.shape, demand: demanded, separations, reached })
    }

    /// Returns what a machine would record and what it reaches; `None` if it leaves the limits.
    fn expected_recording(
        &self,
        machine: &PossibleMachine,
        demand: &[f64],
    ) -> Option<(ExpectedSignals, ExperimentExtremes)> {
        let history = self.simulate_machine(&machine.parameters, demand)?;
        let reached = self.reached_limits(&history);
        let limits = &self.limits;
        let within = reached.angle_rad <= OVERSHOOT * limits.angle_rad
            && reached.rate_rad_s <= OVERSHOOT * limits.rate_rad_s
            && reached.current_a <= limits.current_a;
        if !within {
            return None;
        }
        let signals = self.over_floors(&machine.parameters, &history);
        let slope = |parameter: &&'static EffectParameter| {
            let step = move_parameter(parameter, &machine.parameters);
            let again = self.simulate_machine(&step, demand)?;
            let changed = self.over_floors(&machine.parameters, &again);
            Some(changed.iter().zip(&signals).map(|(a, b)| a - b).collect::<Vec<f64>>())
        };
        let slopes = machine.free.iter().filter_map(slope).collect();
        Some((ExpectedSignals { signals, slopes }, reached))
    }

    fn simulate_machine(&self, parameters: &Parameters, demand: &[f64]) -> Option<TimeHistory> {
        let plant = Plant::from_lumped(parameters).ok()?;
        let mut simulator = Simulator::new(&plant).ok()?.with_step_bound(STEPS_PER_SAMPLE);
        let period_s = parameters.interface.sample_period_s;
        let scenario = Scenario {
            duration_s: demand.len() as f64 * period_s,
            demand_rad_s: Signal::Held { period_s, values: demand.to_vec() },
            injection_v: Signal::ZERO,
            platform: PlatformMotion::STILL,
            imperfections: Imperfections::None,
            initial: Initial::Rest { hub_angle_rad: self.start_angle_rad },
            detail: Detail::Everything,
            firing: Firing::Stated,
        };
        simulator.run(self.controller.at_rest().as_mut(), &scenario).ok()
    }

    /// Returns the motion of every machine under a demand.
    fn motions(&self, demand: &[f64]) -> Vec<MachineMotion> {
        let of = |possible: &PossibleMachine| {
            let history = self.simulate_machine(&possible.parameters, demand)?;
            let angle = history.truth.hub_angle_rad().iter().map(|angle| angle - self.start_angle_rad);
            Some(MachineMotion {
                period_s: history.sample_period_s,
                angle_rad: angle.collect(),
                rate_rad_s: history.truth.hub_rate_rad_s().to_vec(),
                current_a: history.truth.current_a().to_vec(),
            })
        };
        self.machines.iter().filter_map(of).collect()
    }

    fn reached_limits(&self, history: &TimeHistory) -> ExperimentExtremes {
        let peak =
            |series: &[f64], from: f64| series.iter().fold(0.0, |most: f64, v| most.max((v - from).abs()));
        ExperimentExtremes {
            angle_rad: peak(history.truth.hub_angle_rad(), self.start_angle_rad),
            rate_rad_s: peak(history.truth.hub_rate_rad_s(), 0.0),
            current_a: peak(history.truth.current_a(), 0.0),
        }
    }

    /// Returns the recorded channels, one behind the other, each over its noise floor.
    fn over_floors(&self, parameters: &Parameters, history: &TimeHistory) -> Vec<f64> {
        let (sensors, interface) = (&parameters.sensors, &parameters.interface);
        let floor = |sensor| reading_floor(sensor, interface);
        let channels = [
            (Channel::Control, Some(self.controller.control_floor(parameters))),
            (Channel::HubRate, Some(floor(&sensors.hub_gyro))),
            (Channel::MotorRate, sensors.motor_tachometer.as_ref().map(floor)),
            (Channel::HubPosition, sensors.hub_resolver.as_ref().map(floor)),
        ];
        let known = channels.into_iter().filter_map(|(channel, floor)| Some((channel, floor?)));
        let over = |(channel, floor): (Channel, f64)| {
            let floor = floor.max(LEAST_FLOOR);
            history.readings.channel(channel).iter().map(|value| value / floor).collect::<Vec<f64>>()
        };
        known.flat_map(over).collect()
    }
}

/// Returns a mechanism with one parameter moved by a part of its typical size, inside its bounds.
fn move_parameter(parameter: &EffectParameter, of: &Parameters) -> Parameters {
    let value = parameter.read(of);
    let step = FIT_STEP * parameter.size;
    let up = value + step;
    let mut changed = of.clone();
    parameter.write(&mut changed, if up <= parameter.bounds[1] { up } else { value - step });
    changed
}
