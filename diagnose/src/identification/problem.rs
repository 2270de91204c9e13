//! The unknowns and the rows of all recordings, put together.

use counterpoise_models::Parameters;
use counterpoise_recordings::Recording;

use super::outcome::BalanceUnknown;
use super::regression::{Block, RegressionFit, fit_rows};
use super::rows::{Maker, RowColumn, Rows};
use crate::Error;
use crate::tolerance::identification::{LOW_PASS_S, MEMORY_S};

/// Places of the unknowns: moments of all states, inertias of all states, Coulomb, viscous, knots, the accelerometer's lever arm.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Layout {
    states: usize,
    knots: usize,
    lever_arm: LeverArm,
}

/// State of the lever arm of the platform's accelerometer: known or unknown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LeverArm {
    /// The lever arm is taken as the project has it.
    Known,
    /// The lever arm is identified.
    Unknown,
}

impl Layout {
    /// Returns the place of the first moment of a state.
    pub fn moment(self, state: usize) -> usize {
        state
    }

    /// Returns the place of the inertia of a state.
    pub fn inertia(self, state: usize) -> usize {
        self.states + state
    }

    /// Returns the place of the Coulomb friction.
    pub fn coulomb(self) -> usize {
        2 * self.states
    }

    /// Returns the place of the viscous friction.
    pub fn viscous(self) -> usize {
        2 * self.states + 1
    }

    /// Returns the place of the change of the amplifier's map at a knot.
    pub fn knot(self, index: usize) -> usize {
        2 * self.states + 2 + index
    }

    /// Returns the place of the change of the lever arm; `None` if it is taken as known.
    pub fn lever_arm(self) -> Option<usize> {
        (self.lever_arm == LeverArm::Unknown).then_some(2 * self.states + 2 + self.knots)
    }

    fn count(self) -> usize {
        2 * self.states + 2 + self.knots + usize::from(self.lever_arm == LeverArm::Unknown)
    }
}

/// One recording's rows.
pub struct RecordingRows {
    /// Name of the recording.
    pub name: String,
    /// State of balance.
    pub state: usize,
    /// Rows.
    pub rows: Rows,
}

/// All rows.
pub struct IdentificationProblem {
    /// Places of the unknowns.
    pub layout: Layout,
    /// The recordings.
    pub parts: Vec<RecordingRows>,
    /// Knots of the amplifier's map with both ends, V; empty if its change is no unknown.
    pub knots_v: Vec<f64>,
    /// The viscous friction if it is no unknown, N m s/rad at the output.
    pub held_viscous: Option<f64>,
}

impl IdentificationProblem {
    /// Returns the problem with the usual low-pass; `knots_v` holds the ends as well, or nothing.
    pub fn new(p: &Parameters, states: &[&[Recording]], knots_v: &[f64]) -> Result<Self, Error> {
        Self::with_low_pass(p, states, knots_v, LOW_PASS_S)
    }

    /// Returns the problem through a low-pass of a standard deviation, s.
    pub fn with_low_pass(
        p: &Parameters,
        states: &[&[Recording]],
        knots_v: &[f64],
        deviation_s: f64,
    ) -> Result<Self, Error> {
        let maker = Maker { p, deviation_s, knots_v };
        let mut parts = Vec::new();
        for (state, recordings) in states.iter().enumerate() {
            for recording in *recordings {
                let rows = maker.rows(recording)?;
                parts.push(RecordingRows { name: recording.name.clone(), state, rows });
            }
        }
        // with several states each has a moment of its own on which the arm's torque depends
        let shows =
            states.len() == 1 && parts.iter().any(|part: &RecordingRows| part.rows.lever_arm.is_some());
        let lever_arm = if shows { LeverArm::Unknown } else { LeverArm::Known };
        let layout = Layout { states: states.len(), knots: knots_v.len().saturating_sub(2), lever_arm };
        Ok(Self { layout, parts, knots_v: knots_v.to_vec(), held_viscous: None })
    }

    /// Returns the problem with a viscous friction that is no unknown, N m s/rad at the output, if there is one to hold.
    #[must_use]
    pub fn with_held_viscous(mut self, held: Option<f64>) -> Self {
        let Some(viscous) = held else { return self };
        for Rows { signals, noise, noise_in_torque, .. } in self.parts.iter_mut().map(|part| &mut part.rows) {
            let rates = signals.column(RowColumn::Rate).to_vec();
            let torques = signals.column_mut(RowColumn::Torque);
            torques.iter_mut().zip(rates).for_each(|(torque, rate)| *torque -= viscous * rate);
            signals.column_mut(RowColumn::Rate).fill(0.0);
            (noise[0], noise_in_torque[0]) = (0.0, 0.0);
        }
        self.held_viscous = held;
        self
    }

    /// Returns the time that the joint slides, s.
    pub fn sliding_s(&self) -> f64 {
        let of = |part: &RecordingRows| {
            part.rows.sliding.iter().filter(|s| **s).count() as f64 * part.rows.period_s
        };
        self.parts.iter().map(of).sum()
    }

    /// Returns the unknowns in their places.
    pub fn unknowns(&self) -> Vec<BalanceUnknown> {
        let Layout { states, knots, .. } = self.layout;
        let moments = (0..states).map(BalanceUnknown::OutOfBalance);
        let inertias = (0..states).map(BalanceUnknown::Inertia);
        let friction = [BalanceUnknown::Coulomb, BalanceUnknown::Viscous];
        let curve = self.knots_v.iter().skip(1).take(knots).map(|knot| BalanceUnknown::AmplifierCurve(*knot));
        let lever_arm = self.layout.lever_arm().map(|_| BalanceUnknown::LeverArm);
        moments.chain(inertias).chain(friction).chain(curve).chain(lever_arm).collect()
    }

    /// Solves the least squares; returns `None` if the unknowns cannot be told apart.
    pub fn fit(&self) -> Option<RegressionFit> {
        let blocks: Vec<Block> = self.parts.iter().map(|part| self.block(part)).collect();
        fit_rows(&blocks)
    }

    /// Returns the residual of a recording's balance at every row, N m, sliding or not.
    pub fn residual(&self, part: usize, value: &[f64]) -> Vec<f64> {
        let block = self.block(&self.parts[part]);
        let sum = |k: usize| -> f64 {
            let part =
                |(c, b): (&Option<&[f64]>, &f64)| c.filter(|_| b.is_finite()).map_or(0.0, |c| b * c[k]);
            block.columns.iter().zip(value).map(part).sum()
        };
        (0..block.target.len()).map(|k| block.target[k] - sum(k)).collect()
    }

    fn block<'a>(&self, part: &'a RecordingRows) -> Block<'a> {
        let (layout, rows) = (self.layout, &part.rows);
        let mut columns: Vec<Option<&[f64]>> = vec![None; layout.count()];
        let (mut noise, mut shared) = (vec![0.0; layout.count()], vec![0.0; layout.count()]);
        columns[layout.moment(part.state)] = Some(rows.signals.column(RowColumn::Weight));
        columns[layout.coulomb()] = Some(rows.signals.column(RowColumn::Sign));
        columns[layout.viscous()] = Some(rows.signals.column(RowColumn::Rate));
        columns[layout.inertia(part.state)] = Some(rows.signals.column(RowColumn::Acceleration));
        (noise[layout.viscous()], noise[layout.inertia(part.state)]) = (rows.noise[0], rows.noise[1]);
        let [of_rate, of_acceleration] = rows.noise_in_torque;
        (shared[layout.viscous()], shared[layout.inertia(part.state)]) = (of_rate, of_acceleration);
        // the columns carry a minus: torque (old map) = mechanism - sum of change x hat
        for knot in 0..layout.knots {
            columns[layout.knot(knot)] = Some(rows.signals.column(RowColumn::Knot(knot)));
        }
        if let (Some(place), Some(arm)) = (layout.lever_arm(), &rows.lever_arm) {
            (columns[place], noise[place]) = (Some(arm.torque_per_metre.as_slice()), arm.noise);
        }
        let memory = ((MEMORY_S / rows.period_s) as usize).max(1);
        Block { columns, target: rows.torque(), counts: &rows.sliding, noise, shared, memory }
    }
}
