//! Two axes verified together: a traverse ring under the elevation axis, each with its own controller, on the base's motion and on steps of the
//! demand; beside each run, what each axis does alone.
//!
//! Alone, the elevation axis stands on a ring that does not turn, and the traverse axis carries the body at the elevation that its parameters
//! include. The error of the line of sight is the integral of rate less demand about its mean, as in [`crate::line_of_sight`].

use counterpoise_controller::Controller;
use counterpoise_models::Plant;
use counterpoise_models::base_motion::{
    BaseState, FeltMotion, Level, Traverse, motion_at_elevation_axis, motion_at_traverse_axis,
};
use counterpoise_models::two_axes::{Coupling, TraverseGyroscope};
use counterpoise_simulate::{
    AxisScenario, BaseMotion, Controllers, Detail, Firing, FurtherMotion, Imperfections, Initial,
    PlatformMotion, Scenario, Signal, Simulator, TwoAxisHistory, TwoAxisScenario, TwoAxisSimulator,
};

use crate::history::integrate;
use crate::signals::rms;
use crate::signals::statistics::subtract_mean;
use crate::{Error, Limit, Step, Verdict};

/// Procedure of both axes.
#[derive(Debug, Clone, PartialEq)]
pub struct JointProcedure {
    /// Motion of the base on the ring's axis.
    pub base: Vec<BaseState>,
    /// Period of its samples, s.
    pub base_period_s: f64,
    /// Length of the run on that motion, s.
    pub duration_s: f64,
    /// Time at the beginning that is left out of statistics, and after which steps come, s.
    pub settle_s: f64,
    /// Step of the demand of each axis.
    pub steps: AxisPair<Step>,
    /// Angle of each axis at the start, rad: the elevation's inertial, the ring's on the base.
    pub start_rad: AxisPair<f64>,
    /// Seed of the noise of each axis' sensors.
    pub seeds: AxisPair<u64>,
}

/// One thing of each axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisPair<T> {
    /// Of the elevation axis.
    pub elevation: T,
    /// Of the traverse axis.
    pub traverse: T,
}

/// A run of both axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JointExperiment {
    /// A step of the elevation's demand while the traverse axis holds its rate.
    ElevationStep,
    /// A step of the traverse axis' demand while the elevation holds its rate.
    TraverseStep,
    /// Both steps at once.
    BothSteps,
    /// The motion of the base, while both hold their rates.
    Motion,
}

/// Quantity that is measured in a run of both axes: RMS from the settling time on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JointQuantity {
    /// Rate of the elevation axis less its demand, rad/s.
    ElevationRate,
    /// Rate that the gyroscope of the traverse axis stands for, less its demand, rad/s.
    TraverseRate,
    /// Angle of the line of sight in elevation, rad.
    ElevationSight,
    /// Angle of the line of sight in cross-elevation, rad.
    CrossElevationSight,
    /// Angle of the line of sight: both together, rad.
    Sight,
}

/// A figure of both axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct JointFigure {
    /// In which run.
    pub experiment: JointExperiment,
    /// The part of it.
    pub quantity: JointQuantity,
}

impl JointExperiment {
    /// Every run, in the order of reports.
    pub const ALL: [Self; 4] = [Self::ElevationStep, Self::TraverseStep, Self::BothSteps, Self::Motion];

    /// Returns the beginning of its figures' keys.
    pub fn key(self) -> &'static str {
        match self {
            Self::ElevationStep => "elevation_step",
            Self::TraverseStep => "traverse_step",
            Self::BothSteps => "both_steps",
            Self::Motion => "motion",
        }
    }

    fn has_step(self) -> AxisPair<bool> {
        AxisPair {
            elevation: matches!(self, Self::ElevationStep | Self::BothSteps),
            traverse: matches!(self, Self::TraverseStep | Self::BothSteps),
        }
    }
}

impl JointQuantity {
    /// Every quantity, in the order of reports.
    pub const ALL: [Self; 5] = [
        Self::ElevationRate,
        Self::TraverseRate,
        Self::ElevationSight,
        Self::CrossElevationSight,
        Self::Sight,
    ];

    /// Returns the end of its figures' keys.
    pub fn key(self) -> &'static str {
        match self {
            Self::ElevationRate => "elevation_rate_rms_rad_s",
            Self::TraverseRate => "traverse_rate_rms_rad_s",
            Self::ElevationSight => "elevation_sight_rms_rad",
            Self::CrossElevationSight => "cross_elevation_sight_rms_rad",
            Self::Sight => "sight_rms_rad",
        }
    }

    /// Returns its unit.
    pub fn unit(self) -> &'static str {
        match self {
            Self::ElevationRate | Self::TraverseRate => "rad/s",
            _ => "rad",
        }
    }
}

impl JointFigure {
    /// Returns every figure.
    pub fn all() -> impl Iterator<Item = Self> {
        JointExperiment::ALL.into_iter().flat_map(|experiment| {
            JointQuantity::ALL.into_iter().map(move |quantity| Self { experiment, quantity })
        })
    }

    /// Returns its key in project files and results.
    pub fn key(&self) -> String {
        format!("{}_{}", self.experiment.key(), self.quantity.key())
    }

    /// Returns the figure of a key; `None` if there is none.
    pub fn from_key(key: &str) -> Option<Self> {
        Self::all().find(|figure| figure.key() == key)
    }
}

/// A figure of both axes and its limit.
#[derive(Debug, Clone, PartialEq)]
pub struct JointRequirement {
    /// Figure.
    pub figure: JointFigure,
    /// Limit, in the figure's unit.
    pub limit: Limit,
    /// Source of the requirement; empty if it is not stated.
    pub source: String,
}

/// A figure with its value with both axes, and with each axis alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointValue {
    /// Figure.
    pub figure: JointFigure,
    /// With both axes.
    pub together: f64,
    /// With each axis alone.
    pub alone: f64,
}

/// A run of both axes in samples.
#[derive(Debug, Clone, PartialEq)]
pub struct JointRun {
    /// Run.
    pub experiment: JointExperiment,
    /// Everything that the simulator keeps.
    pub history: TwoAxisHistory,
    /// The inertial rates of the axes if each is alone in the same run, rad/s.
    pub rates_alone: AxisPair<Vec<f64>>,
}

/// Both axes verified together.
#[derive(Debug, Clone, PartialEq)]
pub struct JointVerification {
    /// Every figure.
    pub values: Vec<JointValue>,
    /// Verdicts, in the order of the requirements.
    pub verdicts: Vec<(JointRequirement, Verdict)>,
    /// The runs of both axes.
    pub runs: Vec<JointRun>,
    /// Settling time from which on the figures are taken, s.
    pub settle_s: f64,
    /// The rate in cross-elevation over that of the ring, where the gyroscope of the traverse axis is on the ring; `None` if it is on the elevated mass.
    pub ring_to_sight: Option<f64>,
}

impl JointVerification {
    /// Returns whether no requirement fails.
    pub fn passes(&self) -> bool {
        !self.verdicts.iter().any(|(_, verdict)| matches!(verdict, Verdict::Fails { .. }))
    }
}

/// The axes with their controllers.
#[derive(Debug, Clone, Copy)]
pub struct JointMachine<'a> {
    /// The plants.
    pub plants: AxisPair<&'a Plant>,
    /// Their controllers.
    pub controllers: AxisPair<&'a Controller>,
    /// Coupling of the axes.
    pub coupling: Coupling,
}

impl JointMachine<'_> {
    /// Returns the rate in cross-elevation over that of the ring, where the gyroscope of the traverse axis is on the ring; `None` if it is on the
    /// elevated mass.
    fn ring_to_sight(&self) -> Option<f64> {
        match self.coupling.gyroscope {
            TraverseGyroscope::Ring => Some(self.coupling.body.included_at.cos),
            TraverseGyroscope::ElevatedMass => None,
        }
    }
}

/// Runs both axes together and each alone through a procedure, and judges requirements.
///
/// # Errors
/// [`Error::Simulate`], with a divergence of the motion among its kinds.
pub fn verify_two_axes(
    machine: &JointMachine,
    procedure: &JointProcedure,
    requirements: &[JointRequirement],
) -> Result<JointVerification, Error> {
    let AxisPair { elevation, traverse } = machine.plants;
    let mut both = TwoAxisSimulator::new(elevation, traverse, machine.coupling)?;
    let mut alone = AxisPair { elevation: Simulator::new(elevation)?, traverse: Simulator::new(traverse)? };
    let (mut values, mut runs) = (Vec::new(), Vec::new());
    for experiment in JointExperiment::ALL {
        let run = Run { machine, procedure, experiment };
        let history = run.run_together(&mut both)?;
        let (together, rates_alone) = (run.errors_of(&history), run.run_alone(&mut alone)?);
        let apart = run.errors_alone(&history, &rates_alone);
        values.extend(JointQuantity::ALL.into_iter().map(|quantity| JointValue {
            figure: JointFigure { experiment, quantity },
            together: together.value(quantity),
            alone: apart.value(quantity),
        }));
        runs.push(JointRun { experiment, history, rates_alone });
    }
    let judge = |requirement: &JointRequirement| {
        let value = values.iter().find(|value| value.figure == requirement.figure);
        let verdict = requirement.limit.judge(value.map_or(f64::NAN, |value| value.together));
        (requirement.clone(), verdict)
    };
    let verdicts = requirements.iter().map(judge).collect();
    let ring_to_sight = machine.ring_to_sight();
    Ok(JointVerification { verdicts, values, runs, settle_s: procedure.settle_s, ring_to_sight })
}

/// RMS values of a run.
#[derive(Debug, Clone, Copy)]
struct Errors {
    elevation_rate: f64,
    traverse_rate: f64,
    elevation: f64,
    cross: f64,
}

impl Errors {
    fn value(&self, quantity: JointQuantity) -> f64 {
        match quantity {
            JointQuantity::ElevationRate => self.elevation_rate,
            JointQuantity::TraverseRate => self.traverse_rate,
            JointQuantity::ElevationSight => self.elevation,
            JointQuantity::CrossElevationSight => self.cross,
            JointQuantity::Sight => self.elevation.hypot(self.cross),
        }
    }
}

/// A run to be made.
struct Run<'a> {
    machine: &'a JointMachine<'a>,
    procedure: &'a JointProcedure,
    experiment: JointExperiment,
}

impl Run<'_> {
    fn duration_s(&self) -> f64 {
        let (stepped, steps) = (self.experiment.has_step(), &self.procedure.steps);
        let longest = [(stepped.elevation, &steps.elevation), (stepped.traverse, &steps.traverse)]
            .into_iter()
            .filter(|(stepped, _)| *stepped)
            .map(|(_, step)| self.procedure.settle_s + step.duration_s)
            .fold(0.0, f64::max);
        if longest > 0.0 { longest } else { self.procedure.duration_s }
    }

    fn demands(&self) -> AxisPair<Signal> {
        let demand = |stepped: bool, step: &Step| match stepped {
            true => Signal::step(self.procedure.settle_s, step.rate_rad_s),
            false => Signal::ZERO,
        };
        let (stepped, steps) = (self.experiment.has_step(), &self.procedure.steps);
        AxisPair {
            elevation: demand(stepped.elevation, &steps.elevation),
            traverse: demand(stepped.traverse, &steps.traverse),
        }
    }

    fn moves(&self) -> bool {
        self.experiment == JointExperiment::Motion
    }

    fn gravity_m_s2(&self) -> f64 {
        self.machine.plants.elevation.parameters().gravity_m_s2
    }

    fn run_together(&self, simulator: &mut TwoAxisSimulator) -> Result<TwoAxisHistory, Error> {
        let (demands, start, seeds) = (self.demands(), &self.procedure.start_rad, &self.procedure.seeds);
        let axis = |demand_rad_s, hub_angle_rad, seed| AxisScenario {
            demand_rad_s,
            imperfections: Imperfections::NoiseAndQuantisation { seed },
            initial: Initial::Rest { hub_angle_rad },
        };
        let scenario = TwoAxisScenario {
            duration_s: self.duration_s(),
            base: if self.moves() { self.base() } else { BaseMotion::at_rest(self.gravity_m_s2()) },
            elevation: axis(demands.elevation, start.elevation, seeds.elevation),
            traverse: axis(demands.traverse, start.traverse, seeds.traverse),
            detail: Detail::Everything,
            firing: Firing::Silent,
        };
        let AxisPair { elevation, traverse } = self.machine.controllers;
        let (mut elevation, mut traverse) = (elevation.runner(), traverse.runner());
        let mut controllers = Controllers { elevation: &mut elevation, traverse: &mut traverse };
        Ok(simulator.run(&mut controllers, &scenario)?)
    }

    fn base(&self) -> BaseMotion {
        let samples = |of: &dyn Fn(&BaseState) -> f64| Signal::Samples {
            period_s: self.procedure.base_period_s,
            values: self.procedure.base.iter().map(of).collect(),
        };
        BaseMotion {
            specific_force_m_s2: [0, 1, 2].map(|axis| samples(&|state| state.specific_force_m_s2[axis])),
            rate_rad_s: [0, 1, 2].map(|axis| samples(&|state| state.rate_rad_s[axis])),
            initial_pitch_rad: 0.0,
        }
    }

    fn run_alone(&self, simulators: &mut AxisPair<Simulator>) -> Result<AxisPair<Vec<f64>>, Error> {
        let (demands, procedure) = (self.demands(), self.procedure);
        let (start, seeds, period_s) = (&procedure.start_rad, &procedure.seeds, procedure.base_period_s);
        let ring = Traverse { angle_rad: start.traverse, rate_rad_s: 0.0 };
        let gravity = self.gravity_m_s2();
        let above = self
            .moves()
            .then(|| motion_at_elevation_axis(&procedure.base, period_s, ring, gravity, Level::Known));
        let below = self.moves().then(|| motion_at_traverse_axis(&procedure.base, period_s));
        let scenario = |demand_rad_s, hub_angle_rad, seed, felt: Option<Vec<FeltMotion>>| Scenario {
            demand_rad_s,
            platform: felt.map_or(PlatformMotion::STILL, |felt| platform(&felt, period_s)),
            imperfections: Imperfections::NoiseAndQuantisation { seed },
            initial: Initial::Rest { hub_angle_rad },
            ..Scenario::at_rest(self.duration_s())
        };
        let elevation = simulators.elevation.run(
            &mut self.machine.controllers.elevation.runner(),
            &scenario(demands.elevation, start.elevation, seeds.elevation, above),
        )?;
        let traverse = simulators.traverse.run(
            &mut self.machine.controllers.traverse.runner(),
            &scenario(demands.traverse, start.traverse, seeds.traverse, below),
        )?;
        Ok(AxisPair {
            elevation: elevation.truth.hub_rate_rad_s().to_vec(),
            traverse: traverse.truth.hub_rate_rad_s().to_vec(),
        })
    }

    /// Returns the errors of axes that are alone, under the demands of a run of both.
    fn errors_alone(&self, both: &TwoAxisHistory, rates_rad_s: &AxisPair<Vec<f64>>) -> Errors {
        let above = difference(&rates_rad_s.elevation, both.elevation.readings.demand_rad_s());
        let below = difference(&rates_rad_s.traverse, both.traverse.readings.demand_rad_s());
        let to_sight = self.machine.ring_to_sight().unwrap_or(1.0);
        let cross: Vec<f64> = below.iter().map(|rate| to_sight * rate).collect();
        self.errors(&above, &below, &cross)
    }

    fn errors_of(&self, history: &TwoAxisHistory) -> Errors {
        let TwoAxisHistory { elevation, traverse, .. } = history;
        let above = difference(elevation.truth.hub_rate_rad_s(), elevation.readings.demand_rad_s());
        let (demand, cross) = (traverse.readings.demand_rad_s(), history.cross_elevation_rate_rad_s());
        match self.machine.coupling.gyroscope {
            TraverseGyroscope::ElevatedMass => {
                let below = difference(cross, demand);
                self.errors(&above, &below, &below)
            }
            TraverseGyroscope::Ring => {
                let below = difference(traverse.truth.hub_rate_rad_s(), demand);
                let turned =
                    demand.iter().zip(history.elevation_rad()).map(|(rate, angle)| rate * angle.cos());
                let wanted: Vec<f64> = turned.collect();
                self.errors(&above, &below, &difference(cross, &wanted))
            }
        }
    }

    /// Returns the RMS values of rate errors, from the settling time on.
    fn errors(&self, elevation: &[f64], traverse: &[f64], cross: &[f64]) -> Errors {
        let period_s = self.machine.plants.elevation.parameters().interface.sample_period_s;
        let first = (self.procedure.settle_s / period_s).round() as usize;
        let settled = |rates: &[f64]| rates[first.min(rates.len())..].to_vec();
        let angle = |rates: &[f64]| rms(&subtract_mean(&integrate(settled(rates).into_iter(), period_s)));
        Errors {
            elevation_rate: rms(&settled(elevation)),
            traverse_rate: rms(&settled(traverse)),
            elevation: angle(elevation),
            cross: angle(cross),
        }
    }
}

fn difference(rates: &[f64], demands: &[f64]) -> Vec<f64> {
    rates.iter().zip(demands).map(|(rate, demand)| rate - demand).collect()
}

/// Returns the platform of an axis that feels a motion.
fn platform(felt: &[FeltMotion], period_s: f64) -> PlatformMotion {
    let samples =
        |of: fn(&FeltMotion) -> f64| Signal::Samples { period_s, values: felt.iter().map(of).collect() };
    PlatformMotion {
        pitch_rate_rad_s: samples(|at| at.pitch_rate_rad_s),
        heave_m_s2: samples(|at| at.heave_m_s2),
        initial_angle_rad: 0.0,
        further: Some(FurtherMotion {
            surge_m_s2: samples(|at| at.surge_m_s2),
            roll_rate_rad_s: samples(|at| at.roll_rate_rad_s),
            yaw_rate_rad_s: samples(|at| at.yaw_rate_rad_s),
        }),
    }
}
