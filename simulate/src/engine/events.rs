//! The events within a step that was tried: teeth part or meet, the voltage reaches its limit, a joint rests or breaks away.

use super::attempt::Attempt;
use super::crossing::{Margin, crossing, first_crossing, first_dip};
use super::linear_core::{Mode, ModeOutputs, VOLTAGE};
use super::moments::NODES;
use super::present_plant::{PresentPlant, Sample};
use counterpoise_models::Mesh;

/// A part of a sample.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Part {
    /// Start, as a fraction of the sample.
    pub start: f64,
    /// Length, as a fraction of the sample.
    pub share: f64,
}

/// A step that was tried, and what is seen at its ends.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TriedStep<'a> {
    pub present: &'a PresentPlant,
    pub attempt: &'a Attempt,
    /// Observed signals at the end of the step.
    pub ahead: &'a ModeOutputs,
    pub sample: &'a Sample<'a>,
    pub part: Part,
    pub mode: &'a Mode,
    /// Halvings of the sample period that the step is long.
    pub level: usize,
}

impl TriedStep<'_> {
    /// Returns the fraction of the step at which the teeth part or meet, or the voltage reaches or leaves its limit; infinite if
    /// nothing of that happens.
    pub fn contact_event(&self) -> f64 {
        self.mesh_event().min(self.bus_event())
    }

    /// Returns the fraction of the step at which the teeth part or meet; infinite if they do not.
    fn mesh_event(&self) -> f64 {
        let half = 0.5 * self.present.plant.parameters().gearbox.backlash_rad;
        if half == 0.0 {
            return f64::INFINITY;
        }
        // positive while the mode holds
        first_crossing(&self.attempt.wind_up_margins(|wind_up| match self.mode.mesh {
            Mesh::Free => half - wind_up.abs(),
            Mesh::Touching => -self.mode.offset.signum() * wind_up - half,
        }))
    }

    /// Returns the fraction of the step at which the voltage reaches or leaves the bus limit; infinite if it does not.
    fn bus_event(&self) -> f64 {
        let bus = self.present.bus_voltage_v();
        let holds = |seen: &ModeOutputs| {
            if self.mode.held == 0.0 {
                bus - seen[VOLTAGE].abs()
            } else {
                self.mode.held * self.present.voltage_push(seen, self.sample.drive_v)
            }
        };
        let after = holds(self.ahead);
        if after >= 0.0 {
            return f64::INFINITY;
        }
        let before = Margin { part: 0.0, value: holds(self.present.all_outputs()) };
        crossing(before, Margin { part: 1.0, value: after })
    }

    /// Returns the fraction of the step at which a joint comes to rest, breaks away or leaves its band; infinite if none does.
    pub fn joint_event(&self) -> f64 {
        let sticking = [0, 1].into_iter().filter(|&joint| self.present.ports.sticks(joint));
        sticking.fold(f64::INFINITY, |event, joint| {
            event.min(if self.mode.stuck[joint] { self.break_event(joint) } else { self.rest_event(joint) })
        })
    }

    /// Returns the fraction of the step at which a sliding joint comes to rest or leaves its band.
    fn rest_event(&self, joint: usize) -> f64 {
        let nodes = self.sample.motion.span(self.part.start, self.part.share).nodes;
        let rates: [f64; 4] = std::array::from_fn(|k| {
            self.present.ports.rates(&self.attempt.outputs()[k], nodes[k].rate)[joint]
        });
        let margins = self.present.sliding_margins(joint, &rates);
        let along: [Margin; 4] = std::array::from_fn(|k| Margin { part: NODES[k], value: margins[k] });
        first_crossing(&along).min(first_dip(&along))
    }

    /// Returns the fraction of the step at which a joint at rest breaks away.
    fn break_event(&self, joint: usize) -> f64 {
        let Some(hold) = self.present.linear().table(self.level).and_then(|table| table.hold.as_ref()) else {
            return f64::INFINITY;
        };
        let instant = |part: f64| {
            self.present.instant(self.sample, self.part.start + part * self.part.share, self.mode)
        };
        let margins = self.present.rest_margins(self.attempt, joint, hold, instant);
        first_crossing(&margins).min(first_dip(&margins))
    }
}
