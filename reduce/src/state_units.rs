//! States, inputs and outputs in units that do not depend on those in which a system is given.
//!
//! First the units for which the logarithms of the couplings have the least squares (A. Curtis and J. Reid, IMA J. Appl. Math. 10, 1972): whoever changes a
//! unit gets the same couplings again. From there, rows and columns get the same norm, inputs and outputs that of the fastest rate (E. Osborne, J. ACM 7,
//! 1960), because the large couplings say more of a state than those that are small.

use counterpoise_linalg as linalg;
use counterpoise_linalg::Mat;
use counterpoise_lti::StateSpace;

use crate::Error;
use crate::error::StepContext;
use crate::tolerance::{FREE_UNIT, UNIT_GAIN, UNIT_SWEEPS};

/// A system in other units, and the factors of these.
pub(crate) struct ScaledSystem {
    /// The system.
    pub(crate) system: StateSpace,
    /// The diagonal of T, x = T z, powers of two.
    pub(crate) states: Vec<f64>,
    /// Factor by which each column of B was multiplied.
    inputs: Vec<f64>,
    /// Factor by which each row of C was multiplied.
    outputs: Vec<f64>,
}

impl ScaledSystem {
    /// Returns a system, every state of which is reached from an input and seen by an output, in units of its own.
    pub(crate) fn of(g: &StateSpace) -> Result<Self, Error> {
        let (n, m, p) = (g.order(), g.inputs(), g.outputs());
        let mut scaled =
            Self { system: g.clone(), states: vec![1.0; n], inputs: vec![1.0; m], outputs: vec![1.0; p] };
        let exponents = least_squares(g)?;
        let power = |k: usize| exponents[(k, 0)].round().exp2();
        (0..n).for_each(|i| scaled.scale_state(i, power(i)));
        (0..m).for_each(|k| scaled.scale_input(k, power(n + k)));
        (0..p).for_each(|k| scaled.scale_output(k, power(n + m + k)));
        for _ in 0..UNIT_SWEEPS {
            let size = scaled.fastest_rate();
            if !(scaled.sweep_states() | scaled.sweep_signals(size)) {
                break;
            }
        }
        Ok(scaled)
    }

    /// Returns the rate of each state: that of its own decay, or of its oscillation with another state, whatever the units; zero for an integrator.
    pub(crate) fn rates(&self) -> Vec<f64> {
        let A = &self.system.A;
        let cycle = |i: usize, j: usize| (A[(i, j)].abs() * A[(j, i)].abs()).sqrt();
        let rate = |i: usize| (0..A.nrows()).map(|j| cycle(i, j)).fold(0.0, f64::max);
        (0..A.nrows()).map(rate).collect()
    }

    /// Returns the rate of the fastest state; of integrators alone their largest coupling.
    pub(crate) fn fastest_rate(&self) -> f64 {
        let fastest = self.rates().into_iter().fold(0.0, f64::max);
        if fastest > 0.0 {
            fastest
        } else {
            Some(self.system.A.norm_max()).filter(|a| *a > 0.0).unwrap_or(1.0)
        }
    }

    /// Returns a system in the units of this one with the inputs and outputs that were given.
    pub(crate) fn restore_signals(&self, mut g: StateSpace) -> StateSpace {
        g.B = Mat::from_fn(g.B.nrows(), g.B.ncols(), |i, k| g.B[(i, k)] / self.inputs[k]);
        g.C = Mat::from_fn(g.C.nrows(), g.C.ncols(), |k, j| g.C[(k, j)] / self.outputs[k]);
        g
    }

    /// Gives every state's row and column the same norm; returns whether anything changed.
    fn sweep_states(&mut self) -> bool {
        let mut changed = false;
        for i in 0..self.states.len() {
            let StateSpace { A, B, C, .. } = &self.system;
            let others = || (0..A.nrows()).filter(|&j| j != i);
            let norm = |entries: &mut dyn Iterator<Item = f64>| entries.fold(0.0_f64, f64::hypot);
            let column = norm(&mut others().map(|j| A[(j, i)]).chain(C.column(i).iter().copied()));
            let row = norm(&mut others().map(|j| A[(i, j)]).chain((0..B.ncols()).map(|k| B[(i, k)])));
            let factor = (0.5 * (row / column).log2()).round().exp2();
            let gain = (column * factor).hypot(row / factor) < UNIT_GAIN * column.hypot(row);
            if factor != 1.0 && factor.is_normal() && gain {
                self.scale_state(i, factor);
                changed = true;
            }
        }
        changed
    }

    /// Gives the columns of B and the rows of C a norm of `size`; returns whether anything changed.
    fn sweep_signals(&mut self, size: f64) -> bool {
        let norm = |entries: &mut dyn Iterator<Item = f64>| entries.fold(0.0_f64, f64::hypot);
        let power =
            |norm: f64| Some((size / norm).log2().round().exp2()).filter(|f| f.is_normal()).unwrap_or(1.0);
        let mut changed = false;
        for k in 0..self.inputs.len() {
            let factor = power(norm(&mut self.system.B.column(k).iter().copied()));
            changed |= factor != 1.0;
            self.scale_input(k, factor);
        }
        for k in 0..self.outputs.len() {
            let factor = power(norm(&mut (0..self.states.len()).map(|j| self.system.C[(k, j)])));
            changed |= factor != 1.0;
            self.scale_output(k, factor);
        }
        changed
    }

    fn scale_state(&mut self, i: usize, factor: f64) {
        let StateSpace { A, B, C, .. } = &mut self.system;
        for j in (0..A.nrows()).filter(|&j| j != i) {
            A[(j, i)] *= factor;
            A[(i, j)] /= factor;
        }
        (0..B.ncols()).for_each(|k| B[(i, k)] /= factor);
        C.column_mut(i).iter_mut().for_each(|c| *c *= factor);
        self.states[i] *= factor;
    }

    fn scale_input(&mut self, k: usize, factor: f64) {
        self.system.B.column_mut(k).iter_mut().for_each(|b| *b *= factor);
        self.inputs[k] *= factor;
    }

    fn scale_output(&mut self, k: usize, factor: f64) {
        (0..self.states.len()).for_each(|j| self.system.C[(k, j)] *= factor);
        self.outputs[k] *= factor;
    }
}

/// Returns the binary logarithms of the factors of states, inputs and outputs for which those of the couplings have the least squares. A factor that is free
/// is one.
fn least_squares(g: &StateSpace) -> Result<Mat, Error> {
    let (n, m, p) = (g.order(), g.inputs(), g.outputs());
    let mut normal = Mat::eye(n + m + p).scale(FREE_UNIT);
    let mut right = Mat::zeros(n + m + p, 1);
    // The logarithm l + f(plus) +- f(minus) of an entry: a state's factor divides its row.
    let mut add = |entry: f64, plus: usize, other: usize, sign: f64| {
        if entry == 0.0 || plus == other {
            return;
        }
        let l = entry.abs().log2();
        normal[(plus, plus)] += 1.0;
        normal[(other, other)] += 1.0;
        normal[(plus, other)] += sign;
        normal[(other, plus)] += sign;
        right[(plus, 0)] -= l;
        right[(other, 0)] -= sign * l;
    };
    for j in 0..n {
        (0..n).for_each(|i| add(g.A[(i, j)], j, i, -1.0));
        (0..p).for_each(|k| add(g.C[(k, j)], j, n + m + k, 1.0));
        (0..m).for_each(|k| add(g.B[(j, k)], n + k, j, -1.0));
    }
    linalg::solve(&normal, &right).with_step("scaling of states")
}
