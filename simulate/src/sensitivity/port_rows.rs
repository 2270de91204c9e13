//! The ports at the nodes of a step as rows over the outputs there and over what is given at its start.
//!
//! Friction goes from node to node, so that a port depends on the motion at its own node and at all before it.

use super::friction_slopes::JointSlopes;
use super::machine_slopes::{Node, PartSlopes};
use crate::engine::tables::{OUTPUTS, PORTS, STAGES};
use counterpoise_models::Plant;

/// Outputs at the stages.
pub(crate) const STAGE_OUTPUTS: usize = STAGES * OUTPUTS;
/// Ports at the stages.
pub(crate) const UNKNOWNS: usize = STAGES * PORTS;

const MOTOR: usize = 0;
const WINDUP: usize = 1;
const HUB_ANGLE: usize = 2;
const HUB_RATE: usize = 3;
const CURRENT: usize = 4;

/// The quantities given at the start of a step beside the state of the core, in the order of their rows.
pub(crate) mod given {
    /// Drive of the amplifier.
    pub const DRIVE: usize = 0;
    /// Torque of half the gap.
    pub const GAP: usize = 1;
    /// The ports at the start.
    pub const PORTS: usize = 2;
    /// The joints' rates at the start.
    pub const RATES: usize = 5;
    /// The angles to which friction has travelled.
    pub const ANGLES: usize = 7;
    /// The states of friction.
    pub const FRICTION: usize = 9;
    /// Parameters: the motor's share of the platform's rate, the ratio, the current per drive and per platform rate.
    pub const COUPLING: usize = 11;
    pub const RATIO: usize = 12;
    pub const CURRENT: usize = 13;
    /// Number of rows.
    pub const COUNT: usize = 15;
}

/// A quantity as a row over the outputs at the stages and over what is given.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Row {
    pub outputs: [f64; STAGE_OUTPUTS],
    pub given: [f64; given::COUNT],
}

impl Row {
    /// Nothing.
    pub const ZERO: Self = Self { outputs: [0.0; STAGE_OUTPUTS], given: [0.0; given::COUNT] };

    #[inline(always)]
    fn add(&mut self, factor: f64, other: &Self) {
        for k in 0..STAGE_OUTPUTS {
            self.outputs[k] += factor * other.outputs[k];
        }
        for k in 0..given::COUNT {
            self.given[k] += factor * other.given[k];
        }
    }

    #[inline(always)]
    fn scale(&mut self, factor: f64) {
        for k in 0..STAGE_OUTPUTS {
            self.outputs[k] *= factor;
        }
        for k in 0..given::COUNT {
            self.given[k] *= factor;
        }
    }

    /// Adds a multiple of a joint's rate at a node; at the start it is given.
    #[inline(always)]
    fn add_rate(&mut self, factor: f64, joint: usize, at: &Place) {
        match at.stage {
            None => self.given[given::RATES + joint] += factor,
            Some(stage) => {
                self.outputs[stage * OUTPUTS + [MOTOR, HUB_RATE][joint]] += factor;
                if joint == 0 {
                    self.given[given::COUPLING] -= factor * at.node.platform.rate;
                }
            }
        }
    }

    /// Adds a multiple of a joint's angle at a node.
    #[inline(always)]
    fn add_angle(&mut self, factor: f64, joint: usize, at: &Place) {
        let Some(stage) = at.stage else {
            self.given[given::ANGLES + joint] += factor;
            return;
        };
        let first = stage * OUTPUTS;
        if joint == 0 {
            self.outputs[first + WINDUP] += factor * at.ratio;
            self.outputs[first + HUB_ANGLE] += factor * at.ratio;
            self.given[given::RATIO] += factor * (at.node.wind_up_rad + at.node.pivot_angle_rad);
        } else {
            self.outputs[first + HUB_ANGLE] += factor;
        }
    }
}

/// A node of a step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place<'a> {
    /// `None` at the start.
    pub stage: Option<usize>,
    pub node: &'a Node,
    pub ratio: f64,
}

/// The rows of friction's states, followed from node to node.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FrictionRows(pub [Row; 2]);

impl FrictionRows {
    /// Returns the rows at the start.
    pub fn at_start() -> Self {
        let mut rows = [Row::ZERO; 2];
        for (joint, row) in rows.iter_mut().enumerate() {
            row.given[given::FRICTION + joint] = 1.0;
        }
        Self(rows)
    }

    /// Moves the state of a joint from one node to the next.
    #[inline(always)]
    pub fn advance(&mut self, joint: usize, slopes: &JointSlopes, before: &Place, after: &Place) {
        let [by_before, by_after, by_travel, by_state] = slopes.state;
        let row = &mut self.0[joint];
        row.scale(by_state);
        row.add_rate(by_before, joint, before);
        row.add_rate(by_after, joint, after);
        row.add_angle(by_travel, joint, after);
        row.add_angle(-by_travel, joint, before);
    }

    /// Returns the rows of the ports at a stage.
    #[inline(always)]
    pub fn ports(&self, plant: &Plant, at: &Place, stage: usize, torques: [[f64; 2]; 2]) -> [Row; PORTS] {
        let PartSlopes { motor, hub, load } = at.node.slopes(plant);
        let mut rows = [Row::ZERO; PORTS];
        for joint in 0..2 {
            let [by_rate, by_state] = torques[joint];
            rows[joint].add(-by_state, &self.0[joint]);
            rows[joint].add_rate(-by_rate, joint, at);
        }
        let [by_current, by_angle, by_rate] = motor;
        rows[0].outputs[stage * OUTPUTS + CURRENT] += by_current;
        rows[0].given[given::DRIVE] += by_current * plant.direct_current_a(1.0, 0.0);
        rows[0].given[given::CURRENT] += by_current * at.node.drive_v;
        rows[0].given[given::CURRENT + 1] += by_current * at.node.platform.rate;
        rows[0].add_angle(by_angle, 0, at);
        rows[0].add_rate(by_rate, 0, at);
        let [by_angle, by_motor, by_rate] = hub;
        rows[1].outputs[stage * OUTPUTS + HUB_ANGLE] += by_angle;
        rows[1].add_angle(by_motor, 0, at);
        rows[1].add_rate(by_rate, 1, at);
        rows[2].outputs[stage * OUTPUTS + HUB_ANGLE] += load;
        rows
    }
}
