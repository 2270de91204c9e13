//! Two axes together: a traverse ring on the base, and the elevation axis on the ring.
//!
//! Each axis keeps its own plant, controller, sensors and integrator. Over a sample the traverse axis moves first, under a torque of the elevated
//! body that goes on as in the sample before; the elevation axis then moves on the ring's motion, and the torque that the body made is
//! compared with the one that was assumed. If they differ, the sample is taken again with the torque that was found, until it no longer changes
//! (waveform relaxation: E. Lelarasmee, A. Ruehli, A. Sangiovanni-Vincentelli, IEEE Transactions on CAD 1, 1982). Most of that torque is an
//! inertia times the acceleration that it makes, so each correction is divided by 1 + inertia x mobility of the hub. What passes between the
//! axes over a sample is a quartic.

mod base;
mod coupling;
mod quartics;

use crate::Error;
use crate::engine::filter::Filter;
use crate::engine::present_plant::Sample;
use crate::engine::stepper::{Checkpoint, Stepper, TakenStep};
use crate::firing::Firing;
use crate::history::TimeHistory;
use crate::motion::{FurtherMotion, MotionSample, PlatformMotion};
use crate::run::{HUB_ANGLE, Lap, PlantSample, Simulator};
use crate::scenario::{Detail, Initial, Scenario};
use crate::sensing::Imperfections;
use crate::signal::Signal;
use crate::tolerance::{COUPLING_PASSES, COUPLING_SHARE, LEAST_HUB_SHARE, LINEAR_ANSWER, TOLERANCE};
use base::{BaseSample, BaseTrack};
use counterpoise_controller::SampledController;
use counterpoise_models::plant::core::input;
use counterpoise_models::two_axes::{Coupling, RingMotion, TraverseGyroscope};
use counterpoise_models::{AxisKind, Mesh, Plant};
use counterpoise_recordings::{ColumnName, Signals};
use coupling::{Coupler, TraverseTorque};
use quartics::{PLACES, Trace};

pub use base::BaseMotion;

/// A run of both axes.
#[derive(Debug, Clone, PartialEq)]
pub struct TwoAxisScenario {
    /// Duration, s; the run has a sample at every whole period before it.
    pub duration_s: f64,
    /// Motion of the base.
    pub base: BaseMotion,
    /// Scenario of the elevation axis.
    pub elevation: AxisScenario,
    /// Scenario of the traverse axis.
    pub traverse: AxisScenario,
    /// Signals that are kept.
    pub detail: Detail,
    /// The shots of the machine on the elevation axis.
    pub firing: Firing,
}

/// Inputs of one axis in a run of both.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisScenario {
    /// Demanded rate, rad/s, as the controller reads it.
    pub demand_rad_s: Signal,
    /// Imperfections of sensors and converters that are simulated.
    pub imperfections: Imperfections,
    /// Initial state of the axis: at rest relative to its base, or a given state.
    pub initial: Initial,
}

impl AxisScenario {
    /// Returns an axis that starts at rest at an angle and is to hold its rate at 0, without noise and quantisation.
    pub fn at_rest(hub_angle_rad: f64) -> Self {
        Self {
            demand_rad_s: Signal::ZERO,
            imperfections: Imperfections::None,
            initial: Initial::Rest { hub_angle_rad },
        }
    }
}

/// The controllers of both axes.
pub struct Controllers<'a> {
    /// Of the elevation axis.
    pub elevation: &'a mut dyn SampledController,
    /// Of the traverse axis.
    pub traverse: &'a mut dyn SampledController,
}

/// Names the columns of what the two axes do together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SightColumn {
    /// Elevation relative to the ring, rad.
    Elevation,
    /// Inertial rate about the normal of the beam, rad/s.
    CrossElevationRate,
}

impl ColumnName for SightColumn {
    fn index(self) -> usize {
        self as usize
    }
}

/// Record of a run of both axes.
#[derive(Debug, Clone, PartialEq)]
pub struct TwoAxisHistory {
    /// The elevation axis; its platform is the ring.
    pub elevation: TimeHistory,
    /// The traverse axis; its platform is the base, and its heave the lateral specific force.
    pub traverse: TimeHistory,
    /// Signals of both axes together at each sample: an array time x signal.
    pub sight: Signals<SightColumn>,
    /// Mean number of passes per sample.
    pub passes_per_sample: f64,
    /// Samples whose torque between the axes still changed by more than the tolerance in the last pass.
    pub unconverged: usize,
}

impl TwoAxisHistory {
    /// Returns the elevation relative to the ring, rad.
    pub fn elevation_rad(&self) -> &[f64] {
        self.sight.column(SightColumn::Elevation)
    }

    /// Returns the inertial rate about the normal of the beam, rad/s.
    pub fn cross_elevation_rate_rad_s(&self) -> &[f64] {
        self.sight.column(SightColumn::CrossElevationRate)
    }
}

/// Two plants ready to run together.
#[derive(Debug, Clone)]
pub struct TwoAxisSimulator {
    elevation: Simulator,
    traverse: Simulator,
    coupling: Coupling,
}

impl TwoAxisSimulator {
    /// Returns a simulator with the usual tolerance.
    ///
    /// # Errors
    /// A linear axis, sample periods that differ, gravity about the traverse axis, and as [`crate::run()`].
    pub fn new(elevation: &Plant, traverse: &Plant, coupling: Coupling) -> Result<Self, Error> {
        Self::with_tolerance(elevation, traverse, coupling, TOLERANCE)
    }

    /// Returns a simulator with a tolerance of its own.
    ///
    /// # Errors
    /// As [`TwoAxisSimulator::new`], and a tolerance that is not positive.
    pub fn with_tolerance(
        elevation: &Plant,
        traverse: &Plant,
        coupling: Coupling,
        tolerance: f64,
    ) -> Result<Self, Error> {
        check(elevation, traverse)?;
        Ok(Self {
            elevation: Simulator::with_tolerance(elevation, tolerance)?,
            traverse: Simulator::with_tolerance(traverse, tolerance)?,
            coupling,
        })
    }

    /// Runs a scenario from its start. The controllers are used as they are handed in.
    ///
    /// # Errors
    /// As [`crate::run()`].
    pub fn run(
        &mut self,
        controllers: &mut Controllers,
        scenario: &TwoAxisScenario,
    ) -> Result<TwoAxisHistory, Error> {
        let starts = Starts::new(self, scenario);
        let (elevation, stepper, _) = self.elevation.parts();
        let upper = Side::new(elevation, stepper, &starts.elevation)?;
        let (traverse, stepper, _) = self.traverse.parts();
        let lower = Side::new(traverse, stepper, &starts.traverse)?;
        let mut run = Run::new(self.coupling, upper, lower);
        let mut track = BaseTrack::new(&scenario.base, run.lower.period_s());
        for k in 0..run.upper.lap.samples {
            run.sample(k, &track.sample(), controllers)?;
        }
        Ok(run.history())
    }
}

fn check(elevation: &Plant, traverse: &Plant) -> Result<(), Error> {
    let period_s = |plant: &Plant| plant.parameters().interface.sample_period_s;
    let gravity = traverse.parameters().gravity_m_s2;
    if [elevation, traverse].iter().any(|plant| plant.parameters().axis == AxisKind::Linear) {
        return Err(Error::Range {
            what: "the number of linear axes",
            value: 1.0,
            allowed: "0: both axes turn",
        });
    }
    if period_s(elevation) != period_s(traverse) {
        let allowed = "that of the elevation axis";
        return Err(Error::Range {
            what: "the sample period of the traverse axis",
            value: period_s(traverse),
            allowed,
        });
    }
    if gravity != 0.0 {
        let allowed = "0: its axis is upright, and the tilt of the base is part of the base's motion";
        return Err(Error::Range { what: "the gravity of the traverse axis", value: gravity, allowed });
    }
    Ok(())
}

/// The scenario of each axis as far as one axis has one: its start and its demand.
struct Starts {
    elevation: Scenario,
    traverse: Scenario,
}

impl Starts {
    fn new(of: &TwoAxisSimulator, scenario: &TwoAxisScenario) -> Self {
        let period_s = of.traverse.plant().parameters().interface.sample_period_s;
        let mut coupler = Coupler::new(of.coupling.body, of.elevation.plant(), period_s);
        let base = BaseTrack::new(&scenario.base, period_s).sample();
        let traverse = coupler.traverse_motion(&base, 0.0);
        let rate_rad_s = [base.places[0].rate[2]; PLACES];
        let angle_rad = [initial_angle_rad(of.traverse.plant(), &scenario.traverse.initial); PLACES];
        let trace = Trace { angle_rad, rate_rad_s, ..Trace::default() };
        let ring = coupler.ring_motion(&base, &traverse, &trace);
        let pitch = scenario.base.initial_pitch_rad;
        let elevation = coupler.elevation_motion(&ring, pitch, &[0.0; PLACES]);
        let of_axis = |axis: &AxisScenario, motion: &MotionSample, firing: Firing| Scenario {
            duration_s: scenario.duration_s,
            demand_rad_s: axis.demand_rad_s.clone(),
            platform: at_start(motion),
            imperfections: axis.imperfections,
            initial: axis.initial.clone(),
            detail: scenario.detail,
            firing,
            ..Scenario::at_rest(scenario.duration_s)
        };
        Self {
            elevation: of_axis(&scenario.elevation, &elevation, scenario.firing),
            traverse: of_axis(&scenario.traverse, &traverse, Firing::Silent),
        }
    }
}

fn initial_angle_rad(plant: &Plant, initial: &Initial) -> f64 {
    match initial {
        Initial::Rest { hub_angle_rad } => *hub_angle_rad,
        Initial::State(state) => plant.hub_angle_row().iter().zip(&state.core).map(|(c, x)| c * x).sum(),
    }
}

/// Returns a platform that goes on as it starts: what sensors and state of rest are settled on.
fn at_start(motion: &MotionSample) -> PlatformMotion {
    let start = motion.at(0.0);
    let further = motion.further_at(0.0).unwrap_or_default();
    PlatformMotion {
        pitch_rate_rad_s: Signal::Constant(start.rate),
        heave_m_s2: Signal::Constant(start.heave),
        initial_angle_rad: start.angle,
        further: Some(FurtherMotion {
            surge_m_s2: Signal::Constant(further.surge),
            roll_rate_rad_s: Signal::Constant(further.rates[0]),
            yaw_rate_rad_s: Signal::Constant(further.rates[1]),
        }),
    }
}

/// One axis under way.
struct Side<'a> {
    lap: Lap<'a>,
    stepper: &'a mut Stepper,
    start: Checkpoint,
    trace: Trace,
    drive_v: f64,
    before_a: f64,
    is_detailed: bool,
    motion: MotionSample,
}

impl<'a> Side<'a> {
    fn new(plant: &'a Plant, stepper: &'a mut Stepper, scenario: &'a Scenario) -> Result<Self, Error> {
        let mut lap = Lap::new(plant, scenario, stepper, None)?;
        let motion = lap.track.sample(lap.angle);
        Ok(Self {
            lap,
            stepper,
            start: Checkpoint::default(),
            trace: Trace::default(),
            drive_v: 0.0,
            before_a: 0.0,
            is_detailed: scenario.detail == Detail::Everything,
            motion,
        })
    }

    fn period_s(&self) -> f64 {
        self.stepper.period_s()
    }

    /// Reads, controls and logs at sample k on a motion of the base.
    fn read(
        &mut self,
        k: usize,
        controller: &mut dyn SampledController,
        motion: MotionSample,
        shown: Option<f64>,
    ) {
        self.motion = motion;
        let seen = PlantSample::of(self.stepper);
        let shown = PlantSample { hub_gyro: shown.unwrap_or(seen.hub_gyro), ..seen };
        self.drive_v = self.lap.sample(k, controller, &self.motion, &shown);
        self.lap.limit_current(self.stepper);
        if self.is_detailed {
            let sample = Sample { drive_v: self.drive_v, start_s: self.lap.time(k), motion: &self.motion };
            self.lap.log_friction(self.stepper.dry_torques(&sample));
        }
        self.before_a = self.lap.current_a(&self.motion, self.stepper);
        self.stepper.checkpoint(&mut self.start);
    }

    /// Moves over sample k.
    fn advance(&mut self, k: usize) {
        let Self { stepper, trace, motion, drive_v, lap, .. } = self;
        let sample = Sample { drive_v: *drive_v, start_s: lap.time(k), motion };
        stepper.advance_observed(&sample, &mut |TakenStep { attempt, table, part, .. }| {
            attempt.accept_torque(sample.motion.other_torques(part.start, part.share));
            trace.add(attempt, table, part);
        });
    }

    /// Moves over sample k once more, on a motion of the base.
    fn repeat(&mut self, k: usize, motion: MotionSample) {
        self.motion = motion;
        self.stepper.go_back(&self.start);
        self.advance(k);
    }

    fn finish(&mut self, k: usize) -> Result<(), Error> {
        self.lap.finish_sample(&self.motion, self.stepper.outputs()[HUB_ANGLE]);
        self.lap.heat(self.before_a, &self.motion, self.stepper);
        self.lap.check(k, self.stepper)
    }
}

/// A run of both axes under way.
struct Run<'a> {
    upper: Side<'a>,
    lower: Side<'a>,
    coupler: Coupler,
    gyroscope: CrossGyroscope,
    /// Torque of the elevated body at the places of the sample before.
    torque_nm: [f64; PLACES],
    /// Mean over that sample less the one that acted: what the next sample makes up for, so that errors of the impulse do not add up.
    carried_nm: f64,
    /// Elevation relative to the ring there, rad.
    elevation_rad: [f64; PLACES],
    /// Acceleration of the traverse hub per torque on it, 1/(kg m^2).
    mobility: f64,
    /// Changes of the torques that end the relaxation: of the traverse axis and of the elevation axis, N m.
    allowed_nm: [f64; 2],
    passes: usize,
    unconverged: usize,
    sight: Signals<SightColumn>,
}

impl<'a> Run<'a> {
    fn new(coupling: Coupling, upper: Side<'a>, lower: Side<'a>) -> Self {
        let allowed = |side: &Side| COUPLING_SHARE * side.stepper.tolerance() * side.stepper.hub_scale_nm();
        let plant = &lower.stepper.present_plant().plant;
        let mobility: f64 = plant
            .hub_rate_row()
            .iter()
            .zip(plant.core(Mesh::Touching).B.column(input::HUB_TORQUE))
            .map(|(c, b)| c * b)
            .sum();
        let filter = Filter::new(&plant.parameters().sensors.hub_gyro, lower.period_s());
        let coupler = Coupler::new(coupling.body, &upper.stepper.present_plant().plant, lower.period_s());
        Self {
            allowed_nm: [allowed(&lower), allowed(&upper)],
            coupler,
            mobility,
            gyroscope: CrossGyroscope { place: coupling.gyroscope, filter, shown: None },
            torque_nm: [0.0; PLACES],
            carried_nm: 0.0,
            elevation_rad: [0.0; PLACES],
            passes: 0,
            unconverged: 0,
            sight: Signals::with_room(lower.lap.samples, SightColumn::CrossElevationRate as usize + 1),
            upper,
            lower,
        }
    }

    /// Takes sample k of both axes.
    fn sample(&mut self, k: usize, base: &BaseSample, controllers: &mut Controllers) -> Result<(), Error> {
        let angle = self.lower.lap.angle;
        let below = self.coupler.traverse_motion(base, angle);
        let carried = self.carried_nm;
        let mut torque = self.coupler.quartics.extrapolate(&self.torque_nm).map(|torque| torque + carried);
        let mut elevation = self.coupler.quartics.extrapolate(&self.elevation_rad);
        if k == 0 {
            self.settle_gyroscope(base, &below);
        }
        let shown = self.gyroscope.shown.map(|shown| shown[0]);
        self.lower.read(k, controllers.traverse, self.motion_under(&below, &torque), shown);
        self.lower.advance(k);
        for pass in 1.. {
            let ring = self.coupler.ring_motion(base, &self.lower.motion, &self.lower.trace);
            let changed = self.move_elevation(k, pass, &ring, &mut elevation, controllers);
            let found = self.coupler.torque(&ring, &elevation, &self.upper.trace);
            let (mut error, mut change) = ([0.0; PLACES], 0.0_f64);
            for (place, error) in error.iter_mut().enumerate() {
                *error = found.torque_nm[place] + carried - torque[place];
                change = if error.abs() <= change { change } else { error.abs() };
            }
            let held = self.held_shares(&found)?;
            let step: [f64; PLACES] = std::array::from_fn(|place| error[place] / held[place]);
            let is_small = change <= LINEAR_ANSWER * self.allowed_nm[0] && !changed;
            if is_small && self.lower.trace.is_whole {
                // so little is answered linearly, without taking the sample again
                self.lower.stepper.add_hub_torque(&[step[0], step[1], step[3], step[4]]);
                self.passes += pass;
                self.carried_nm = 0.0;
                self.keep(&ring, std::array::from_fn(|place| torque[place] + step[place]), elevation);
                break;
            }
            // between events the next sample makes up for the impulse of so little
            let is_done = is_small || (change <= self.allowed_nm[0] && !changed);
            if is_done || pass == COUPLING_PASSES || !change.is_finite() {
                self.unconverged += usize::from(!is_done);
                self.passes += pass;
                self.carried_nm = self.coupler.quartics.mean(&error);
                self.keep(&ring, found.torque_nm, elevation);
                break;
            }
            for place in 0..PLACES {
                torque[place] += step[place];
            }
            let motion = self.motion_under(&below, &torque);
            self.lower.repeat(k, motion);
        }
        self.upper.finish(k)?;
        self.lower.finish(k)
    }

    /// Lets a gyroscope on the elevated mass show what it would after a long time in the motion at the start.
    fn settle_gyroscope(&mut self, base: &BaseSample, below: &MotionSample) {
        let outputs = self.lower.stepper.outputs();
        let trace = Trace {
            angle_rad: [outputs[HUB_ANGLE]; PLACES],
            rate_rad_s: [outputs[HUB_ANGLE + 1]; PLACES],
            ..Trace::default()
        };
        let ring = self.coupler.ring_motion(base, below, &trace);
        let elevation = self.upper.stepper.outputs()[HUB_ANGLE] - self.upper.lap.angle;
        let [cross, ..] = self.coupler.cross_rates(&ring, &[elevation; PLACES]);
        if self.gyroscope.place == TraverseGyroscope::ElevatedMass {
            self.gyroscope.shown = Some([cross, 0.0]);
        }
    }

    /// Returns the inertia of the traverse hub with the elevated body where it is, over that in the parameters of the axis.
    fn held_shares(&self, found: &TraverseTorque) -> Result<[f64; PLACES], Error> {
        let held = found.added_kg_m2.map(|added| 1.0 + self.mobility * added);
        match held.iter().find(|share| **share < LEAST_HUB_SHARE) {
            Some(share) => Err(Error::Range {
                what: "the inertia of the traverse hub with the elevated body where it is, over that in the parameters of the axis,",
                value: *share,
                allowed: "0.05 or more: the inertia at the hub of the traverse axis must include the elevated body",
            }),
            None => Ok(held),
        }
    }

    /// Moves the elevation axis over sample k, if it has not moved on the same motion of the ring; says whether that motion may still change by
    /// what the axis did.
    fn move_elevation(
        &mut self,
        k: usize,
        pass: usize,
        ring: &[RingMotion; PLACES],
        elevation: &mut [f64; PLACES],
        controllers: &mut Controllers,
    ) -> bool {
        let motion = self.coupler.elevation_motion(ring, self.upper.lap.angle, elevation);
        if pass == 1 {
            self.upper.read(k, controllers.elevation, motion, None);
            self.upper.advance(k);
        } else if self.coupler.difference_nm(&motion, &self.upper.motion) > self.allowed_nm[1] {
            self.upper.repeat(k, motion);
        }
        *elevation = self.coupler.elevation_rad(&self.upper.motion, &self.upper.trace);
        if self.coupler.is_slender() {
            return false;
        }
        let motion = self.coupler.elevation_motion(ring, self.upper.lap.angle, elevation);
        self.coupler.difference_nm(&motion, &self.upper.motion) > self.allowed_nm[1]
    }

    /// Returns what the traverse axis feels with a torque of the elevated body.
    fn motion_under(&self, below: &MotionSample, torque_nm: &[f64; PLACES]) -> MotionSample {
        let mut motion = *below;
        if let Some(further) = &mut motion.further {
            further[3] = self.coupler.quartics.interpolate(torque_nm);
        }
        motion
    }

    /// Keeps what the next sample starts from, and logs.
    fn keep(&mut self, ring: &[RingMotion; PLACES], torque: [f64; PLACES], elevation: [f64; PLACES]) {
        (self.torque_nm, self.elevation_rad) = (torque, elevation);
        let cross = self.coupler.cross_rates(ring, &elevation);
        self.sight.push([elevation[0], cross[0]]);
        self.gyroscope.advance(&cross);
    }

    fn history(mut self) -> TwoAxisHistory {
        let samples = self.sight.len().max(1);
        TwoAxisHistory {
            elevation: self.upper.lap.history(self.upper.stepper),
            traverse: self.lower.lap.history(self.lower.stepper),
            sight: self.sight,
            passes_per_sample: self.passes as f64 / samples as f64,
            unconverged: self.unconverged,
        }
    }
}

/// The gyroscope of the traverse axis on the elevated mass.
struct CrossGyroscope {
    place: TraverseGyroscope,
    filter: Filter,
    /// The value that it shows, and its derivative; `None` on the ring, where the traverse axis has its own.
    shown: Option<[f64; 2]>,
}

impl CrossGyroscope {
    fn advance(&mut self, rates: &[f64; PLACES]) {
        if self.place == TraverseGyroscope::Ring {
            return;
        }
        let shown = self.shown.get_or_insert([rates[0], 0.0]);
        self.filter.advance(0, shown, &[rates[0], rates[1], rates[3], rates[4]]);
    }
}
