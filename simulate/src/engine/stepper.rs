//! The steps within a sample: how long they are, and which events end them.

use super::attempt::{Attempt, Continuation, HeldInputs, Resumption};
use super::events::{Part, TriedStep};
use super::filter::Filter;
use super::joints::Transition;
use super::linear_core::{Mode, ModeOutputs};
use super::ports::{PlatformPoint, SensorPoint};
use super::present_plant::{OrdinaryState, Place, PresentPlant, Sample, StepInput};
use super::state::{Effort, PlantState};
use super::tables::{DEEPEST, LEVELS, OUTPUTS, StepTable};
use crate::Error;
use crate::firing::Firing;
use crate::tolerance::{
    BRISTLE_LEVELS, CONTACT_LEVELS, CONTACT_TOLERANCE, EVENT_BITS, FEWEST_CONTACT_LEVELS, LENGTHEN_BELOW,
    MANY_CHANGES,
};
use counterpoise_models::Plant;

/// Shortest steps in a sample period.
const TICKS: u32 = 1 << DEEPEST;

/// Steps a plant from sample to sample.
#[derive(Debug, Clone)]
pub(crate) struct Stepper {
    present: PresentPlant,
    attempt: Attempt,
    /// The outputs at the end of the step that was tried.
    ahead: ModeOutputs,
    filter: Filter,
    /// The platform at the nodes of the step that was tried.
    nodes: [PlatformPoint; 4],
    period_s: f64,
    /// `true` if any joint truly sticks.
    joints: bool,
    level: usize,
    finest: usize,
    contact: usize,
    tolerance: f64,
    effort: Effort,
}

/// The state of a run at the start of a sample.
#[derive(Debug, Clone, Default)]
pub(crate) struct Checkpoint {
    place: Place,
    resumption: Option<Resumption>,
    level: usize,
}

/// A step that is about to be taken, and the plant at its start.
pub(crate) struct TakenStep<'a> {
    pub attempt: &'a mut Attempt,
    pub table: &'a StepTable,
    /// The plant where the step begins.
    pub present: &'a PresentPlant,
    pub mode: &'a Mode,
    /// Halvings of the sample period that the step is long.
    pub level: usize,
    pub part: Part,
    /// The platform at the nodes of the step.
    pub nodes: &'a [PlatformPoint; 4],
}

/// The result of a step that was tried.
enum StepOutcome {
    Good { defect: f64 },
    Event { fraction: f64, depth: usize },
    Rough,
}

/// The way to an event that was seen: ticks to go, and the level to try after them.
#[derive(Debug, Clone, Copy, Default)]
struct Approach {
    ticks: u32,
    then: usize,
}

impl Stepper {
    /// Returns a stepper whose steps leave a defect of at most `tolerance`, relative to the ports' scales.
    pub fn new(plant: &Plant, period_s: f64, tolerance: f64) -> Result<Self, Error> {
        let present = PresentPlant::new(plant, period_s)?;
        let ports = &present.ports;
        Ok(Self {
            finest: if ports.has_bristles() { BRISTLE_LEVELS } else { LEVELS },
            joints: ports.sticks(0) || ports.sticks(1),
            present,
            attempt: Attempt::new(plant.core_order()),
            ahead: ModeOutputs::default(),
            filter: Filter::new(&plant.parameters().sensors.hub_gyro, period_s),
            nodes: [PlatformPoint::default(); 4],
            period_s,
            level: 0,
            contact: contact_levels(tolerance),
            tolerance,
            effort: Effort::default(),
        })
    }

    /// Begins a run in a state.
    pub fn restart(&mut self, start: &PlantState) {
        self.level = 0;
        self.attempt = Attempt::new(self.present.plant.core_order());
        self.effort = Effort::default();
        self.present.restart(start);
    }

    /// Returns where the plant is and what its next step continues from, if that step is a whole sample in the ordinary mode after another
    /// such step; `None` otherwise.
    pub fn smooth(&self) -> Option<(OrdinaryState<'_>, Continuation)> {
        let from = self.attempt.continuation(self.period_s).filter(|_| self.level == 0 && !self.joints)?;
        Some((self.present.ordinary_state()?, from))
    }

    /// Goes on from a whole sample in the ordinary mode.
    pub fn go_on_from(&mut self, at: &OrdinaryState, from: &Continuation) {
        self.level = 0;
        self.present.go_on_from(at);
        self.attempt.continue_from(self.period_s, from);
    }

    /// Counts steps that were taken elsewhere.
    pub fn count(&mut self, steps: usize, iterations: usize) {
        self.effort.steps += steps;
        self.effort.iterations += iterations;
    }

    /// Makes the matrices of a whole sample in the ordinary mode, if they are not there yet.
    pub fn prepare_ordinary(&mut self) {
        self.present.prepare_ordinary();
    }

    /// Returns the plant where it is, with its cores and nonlinear parts.
    pub fn present_plant(&self) -> &PresentPlant {
        &self.present
    }

    /// Returns the filter of the loop's sensor.
    pub fn filter(&self) -> &Filter {
        &self.filter
    }

    /// Returns the sample period, s.
    pub fn period_s(&self) -> f64 {
        self.period_s
    }

    /// Returns the defect that a step may leave, relative to the ports' scales.
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// Lets a machine that recoils fire, or not, in the runs that follow.
    pub fn fire(&mut self, firing: Firing) {
        let PresentPlant { plant, ports, .. } = &mut self.present;
        if plant.loads().is_some() {
            ports.fire(plant, firing);
        }
    }

    /// Sets the lowest and the highest current that the drive gives, A.
    pub fn limit_current(&mut self, range_a: Option<[f64; 2]>) {
        self.present.ports.limit_current(range_a);
    }

    /// Returns the state of the plant.
    pub fn state(&self) -> PlantState {
        self.present.state()
    }

    /// Returns the work of the run so far.
    pub fn effort(&self) -> Effort {
        Effort { changes: self.present.changes, ..self.effort }
    }

    /// Returns the motor state, wind-up, hub angle, hub rate, current.
    pub fn outputs(&self) -> &[f64; OUTPUTS] {
        self.present.outputs()
    }

    /// Returns the voltage of the amplifier and rate of the tip.
    pub fn voltage_and_tip(&self) -> [f64; 2] {
        self.present.voltage_and_tip()
    }

    /// Returns what the loop's sensor shows, and its derivative.
    pub fn hub_gyro(&self) -> &[f64; 2] {
        &self.present.hub_gyro
    }

    /// Returns the torque against which an error of the hub's nonlinear parts is small, N m.
    pub fn hub_scale_nm(&self) -> f64 {
        self.present.ports.scales[1]
    }

    /// Returns whether the motion is still finite.
    pub fn is_finite(&self) -> bool {
        self.present.is_finite()
    }

    /// Returns the dry friction torques at the motor and at the pivot at the beginning of a sample, N m.
    pub fn dry_torques(&mut self, sample: &Sample) -> [f64; 2] {
        let present = &mut self.present;
        present.settle_joints(sample);
        let mode = present.mode(sample.drive_v);
        present.enter(&mode, self.level);
        let at = present.instant(sample, 0.0, &mode);
        let mut torques = present.dry_torques(&at);
        for joint in [0, 1] {
            if present.ports.sticks(joint) && present.friction().get(joint) == 0.0 {
                torques[joint] = present.load(joint, present.core(), &present.ports_at(&at), &at).torque_nm;
            }
        }
        torques
    }

    /// Moves the state over one sample period.
    pub fn advance(&mut self, sample: &Sample) {
        self.advance_observed(sample, &mut |_| {});
    }

    /// Adds the answer to a further torque on the hub over the sample that one step has just taken, which is the cubic through its values at the nodes.
    /// Dry friction is left as it is: the torque is to be so small that its motion within the sample changes nothing.
    pub fn add_hub_torque(&mut self, torque_nm: &[f64; 4]) {
        self.present.add_hub_torque(torque_nm);
    }

    /// Returns where the run is, so that its next sample can be taken again.
    pub fn checkpoint(&self, to: &mut Checkpoint) {
        self.present.save(&mut to.place);
        to.resumption = Some(self.attempt.resumption());
        to.level = self.level;
    }

    /// Goes back to a checkpoint of this run. The effort is not taken back.
    pub fn go_back(&mut self, to: &Checkpoint) {
        self.present.restore(&to.place);
        if let Some(resumption) = &to.resumption {
            self.attempt.resume(resumption);
        }
        self.level = to.level;
    }

    /// Moves the state over one sample period; `observer` sees every step that is taken, and which part of the sample it is.
    #[inline]
    pub fn advance_observed(&mut self, sample: &Sample, observer: &mut impl FnMut(TakenStep)) {
        self.present.settle_joints(sample);
        let before = self.present.changes;
        let (mut tick, mut approach) = (0, Approach::default());
        while tick < TICKS {
            if approach.ticks > 0 {
                self.level = level_within(approach.ticks);
            }
            while (TICKS >> self.level) > TICKS - tick {
                self.level += 1;
            }
            let mode = self.present.mode(sample.drive_v);
            self.present.enter(&mode, self.level);
            let deepest = if self.present.changes - before > MANY_CHANGES { LEVELS } else { DEEPEST };
            match self.try_step(sample, tick, &mode, deepest) {
                StepOutcome::Good { defect } => {
                    self.show_step(tick, &mode, observer);
                    self.take_step(&mode);
                    tick += TICKS >> self.level;
                    match self.transition(sample, tick, &mode) {
                        Transition::Changed => (approach, self.level) = (Approach::default(), 0),
                        Transition::None => self.choose_level(&mut approach, defect),
                    }
                }
                StepOutcome::Event { fraction, depth } => approach = self.approach(fraction, depth),
                StepOutcome::Rough => {
                    approach = Approach::default();
                    self.level += 1;
                    self.effort.rejected += 1;
                }
            }
        }
    }

    /// Shows the step that is taken from a tick on to an observer.
    #[inline]
    fn show_step(&mut self, tick: u32, mode: &Mode, observer: &mut impl FnMut(TakenStep)) {
        let Self { present, attempt, level, nodes, .. } = self;
        let Some(table) = present.linear().table(*level) else { return };
        let part = Part { start: fraction(tick), share: fraction(TICKS >> *level) };
        observer(TakenStep { attempt, table, present, mode, level: *level, part, nodes });
    }

    /// Carries out what the step that ended at a tick leads to: a change of the mesh, or of a joint.
    fn transition(&mut self, sample: &Sample, tick: u32, mode: &Mode) -> Transition {
        let mesh = self.present.plant.mesh(self.present.outputs()[1]).0;
        let mut transition = if mesh == mode.mesh { Transition::None } else { Transition::Changed };
        if self.joints {
            let at = self.present.instant(sample, fraction(tick), mode);
            if self.present.make_transitions(&at) == Transition::Changed {
                transition = Transition::Changed;
            }
        }
        transition
    }

    fn choose_level(&mut self, approach: &mut Approach, defect: f64) {
        if approach.ticks > 0 {
            approach.ticks = approach.ticks.saturating_sub(TICKS >> self.level);
            if approach.ticks == 0 {
                self.level = approach.then;
            }
        } else if defect < LENGTHEN_BELOW * self.tolerance && self.level > 0 {
            self.level -= 1;
        }
    }

    fn try_step(&mut self, sample: &Sample, tick: u32, mode: &Mode, deepest: usize) -> StepOutcome {
        let linear = self.present.linear();
        let Some(table) = linear.table(self.level) else { return StepOutcome::Rough };
        let part = Part { start: fraction(tick), share: fraction(TICKS >> self.level) };
        let platform = sample.motion.span(part.start, part.share);
        let step = StepInput {
            held: HeldInputs { drive_v: sample.drive_v, offset_nm: mode.offset },
            platform: &platform,
            time_s: sample.start_s + part.start * self.period_s,
            tolerance: self.tolerance,
        };
        let given = self.present.start_step(table, &step);
        let converged = self.attempt.solve(&given);
        self.nodes = platform.nodes;
        self.effort.iterations += self.attempt.iterations;
        self.ahead = linear.outputs_at(self.attempt.end());
        let defect = if self.attempt.predicted { 0.0 } else { self.attempt.defect(&given) * part.share };
        let finest = self.level >= self.finest;
        let fine = converged && defect <= self.tolerance;
        if !(finest || converged) {
            return StepOutcome::Rough;
        }
        if let Some(event) = self.event(sample, part, mode, deepest) {
            return event;
        }
        self.effort.forced += usize::from(finest && !fine);
        if finest || fine { StepOutcome::Good { defect } } else { StepOutcome::Rough }
    }

    /// Returns the first event of the step that was tried, if its instant is still to be found more closely.
    fn event(&self, sample: &Sample, part: Part, mode: &Mode, deepest: usize) -> Option<StepOutcome> {
        let tried = TriedStep {
            present: &self.present,
            attempt: &self.attempt,
            ahead: &self.ahead,
            sample,
            part,
            mode,
            level: self.level,
        };
        if self.joints && self.level < deepest {
            let fraction = tried.joint_event();
            if fraction <= 1.0 {
                return Some(StepOutcome::Event { fraction, depth: deepest });
            }
        }
        if self.level < self.contact {
            let fraction = tried.contact_event();
            if fraction <= 1.0 {
                return Some(StepOutcome::Event { fraction, depth: self.contact });
            }
        }
        None
    }

    /// Takes the step that was tried last.
    fn take_step(&mut self, mode: &Mode) {
        let (outputs, hysteresis) =
            (self.attempt.outputs(), self.attempt.gear_hysteresis(self.present.friction()));
        self.present.take(&self.attempt, &self.ahead, mode);
        let felt = std::array::from_fn(|k| {
            let at = SensorPoint {
                outputs: &outputs[k],
                platform: &self.nodes[k],
                gear_hysteresis_nm: hysteresis[k],
            };
            self.present.ports.sensor_reading(&self.present.plant, &at)
        });
        self.filter.advance(self.level, &mut self.present.hub_gyro, &felt);
        self.attempt.accept(self.period_s * fraction(TICKS >> self.level));
        self.effort.steps += 1;
    }

    /// Returns how to come near an event at a fraction of the step that was tried.
    fn approach(&mut self, fraction: f64, depth: usize) -> Approach {
        self.effort.rejected += 1;
        let grain = TICKS >> depth;
        let ticks = (f64::from(TICKS >> self.level) * fraction) as u32 / grain * grain;
        if ticks == 0 {
            self.level = depth.max(self.level + 1).min(DEEPEST);
            return Approach::default();
        }
        let spare = (32 - ticks.leading_zeros()).saturating_sub(EVENT_BITS);
        let then = level_within((ticks >> EVENT_BITS).max(grain)).saturating_sub(1).max(self.level + 1);
        Approach { ticks: ticks >> spare << spare, then: then.min(depth) }
    }
}

/// Returns the halvings with which the instants of contact are found.
fn contact_levels(tolerance: f64) -> usize {
    let wanted = CONTACT_LEVELS + (CONTACT_TOLERANCE / tolerance).log2();
    (wanted.round() as usize).clamp(FEWEST_CONTACT_LEVELS, DEEPEST)
}

/// Returns the level of the longest step that has at most `ticks` ticks.
fn level_within(ticks: u32) -> usize {
    DEEPEST.saturating_sub(31 - ticks.max(1).leading_zeros() as usize)
}

/// Returns the ticks as a fraction of a sample.
fn fraction(ticks: u32) -> f64 {
    f64::from(ticks) / f64::from(TICKS)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::{PlatformMotion, Signal, Simulator};
    use counterpoise_models::reference;

    /// Returns the state after a few samples with every step of one level.
    fn state_after(finest: usize, volts: f64) -> Vec<f64> {
        let plant = Plant::from_lumped(&reference::rig()).unwrap();
        let start = Simulator::new(&plant).unwrap().rest(0.01, 0.0, 0.0);
        let mut stepper = Stepper::new(&plant, 1e-3, if finest == 0 { 1e9 } else { 1e-30 }).unwrap();
        stepper.finest = finest;
        stepper.restart(&start);
        let platform = PlatformMotion { pitch_rate_rad_s: Signal::sine(0.1, 8.0), ..PlatformMotion::STILL };
        let mut angle = 0.0;
        for k in 0..4 {
            let motion = platform.sample(f64::from(k) * 1e-3, 1e-3, angle);
            angle = motion.at(1.0).angle;
            stepper.advance(&Sample { drive_v: volts, start_s: f64::from(k) * 1e-3, motion: &motion });
        }
        stepper.state().core
    }

    #[test]
    fn the_deepest_steps_go_where_whole_samples_go() {
        let whole = state_after(0, 5.0);
        for level in [4, 8, 9, 12, 14] {
            let found = state_after(level, 5.0);
            for (a, b) in found.iter().zip(&whole) {
                assert!((a - b).abs() < 1e-7 * (1.0 + b.abs()), "{level}: {found:?} {whole:?}");
            }
        }
    }

    #[test]
    fn a_step_has_the_same_bits_in_registers_of_every_width() {
        let plant = Plant::from_lumped(&reference::rig()).unwrap();
        let mut present = PresentPlant::new(&plant, 1e-3).unwrap();
        present.restart(&Simulator::new(&plant).unwrap().rest(0.01, 0.0, 0.0));
        let platform = PlatformMotion { pitch_rate_rad_s: Signal::sine(0.1, 8.0), ..PlatformMotion::STILL };
        for level in [0, 5] {
            let mode = present.mode(5.0);
            present.enter(&mode, level);
            let span = platform.sample(0.0, 1e-3, 0.0).span(0.0, fraction(TICKS >> level));
            let held = HeldInputs { drive_v: 5.0, offset_nm: mode.offset };
            let step = StepInput { held, platform: &span, time_s: 0.0, tolerance: 1e-5 };
            let given = present.start_step(present.linear().table(level).unwrap(), &step);
            let (mut wide, mut narrow) = (Attempt::new(plant.core_order()), Attempt::new(plant.core_order()));
            assert_eq!(wide.solve(&given), narrow.solve_inline(&given));
            let bits = |of: &[f64]| of.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(wide.end()), bits(narrow.end()));
            assert_eq!(bits(&wide.end_ports()), bits(&narrow.end_ports()));
            assert_eq!(wide.friction(), narrow.friction());
        }
    }
}
