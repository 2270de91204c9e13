//! The states of several mechanisms between samples, side by side.

use super::number::{LANES, Lanes};
use super::table::SEEN;
use crate::engine::tables::STAGES;

/// The states of mechanisms that take whole samples as steps, and what their next step continues from.
#[derive(Debug, Clone)]
pub(crate) struct LaneState {
    /// The cores in their coordinates.
    pub core: Vec<Lanes>,
    /// Observed signals: outputs, voltage, rate of the tip.
    pub seen: [Lanes; SEEN],
    /// Dry friction at motor and pivot.
    pub friction: [Lanes; 2],
    /// Angles of motor and pivot to which friction has travelled, rad.
    pub travelled: [Lanes; 2],
    /// Readings of the loop's sensors, and the derivative.
    pub gyro: [Lanes; 2],
    /// Torques at the stages of the step before.
    pub before: [[Lanes; 2]; STAGES],
    /// Factors from the change in one iteration to that in the next.
    pub contraction: Lanes,
    /// Angles whose sine and cosine are known, and these.
    pub about: [Lanes; 3],
    /// Torques of half the gap, N m.
    pub offset_nm: Lanes,
    /// Dry friction torques at motor and pivot at the start of the last step, N m.
    pub dry_nm: [Lanes; 2],
    /// Iterations of the last step.
    pub iterations: Lanes,
}

/// The state of one mechanism: a lane of [`LaneState`].
#[derive(Debug, Clone, Copy)]
pub(crate) struct SmoothState<'a> {
    pub core: &'a [f64],
    pub seen: [f64; SEEN],
    pub friction: [f64; 2],
    pub travelled: [f64; 2],
    pub gyro: [f64; 2],
    pub before: [[f64; 2]; STAGES],
    pub contraction: f64,
    pub about: [f64; 3],
    pub offset_nm: f64,
}

impl LaneState {
    /// Returns mechanisms of an order with everything at 0.
    pub fn new(order: usize) -> Self {
        let zero = [0.0; LANES];
        Self {
            core: vec![zero; order],
            seen: [zero; SEEN],
            friction: [zero; 2],
            travelled: [zero; 2],
            gyro: [zero; 2],
            before: [[zero; 2]; STAGES],
            contraction: zero,
            about: [zero; 3],
            offset_nm: zero,
            dry_nm: [zero; 2],
            iterations: zero,
        }
    }

    /// Puts a mechanism into a lane.
    pub fn put(&mut self, lane: usize, state: &SmoothState) {
        self.core.iter_mut().zip(state.core).for_each(|(place, value)| place[lane] = *value);
        put_each(&mut self.seen, lane, &state.seen);
        put_each(&mut self.friction, lane, &state.friction);
        put_each(&mut self.travelled, lane, &state.travelled);
        put_each(&mut self.gyro, lane, &state.gyro);
        for (places, values) in self.before.iter_mut().zip(&state.before) {
            put_each(places, lane, values);
        }
        self.contraction[lane] = state.contraction;
        put_each(&mut self.about, lane, &state.about);
        self.offset_nm[lane] = state.offset_nm;
    }

    /// Returns the mechanism of a lane, with its core written to `core`.
    pub fn take<'a>(&self, lane: usize, core: &'a mut [f64]) -> SmoothState<'a> {
        core.iter_mut().zip(&self.core).for_each(|(value, place)| *value = place[lane]);
        SmoothState {
            core,
            seen: self.seen.map(|place| place[lane]),
            friction: self.friction.map(|place| place[lane]),
            travelled: self.travelled.map(|place| place[lane]),
            gyro: self.gyro.map(|place| place[lane]),
            before: self.before.map(|torques| torques.map(|place| place[lane])),
            contraction: self.contraction[lane],
            about: self.about.map(|place| place[lane]),
            offset_nm: self.offset_nm[lane],
        }
    }
}

fn put_each<const N: usize>(places: &mut [Lanes; N], lane: usize, values: &[f64; N]) {
    places.iter_mut().zip(values).for_each(|(place, value)| place[lane] = *value);
}
