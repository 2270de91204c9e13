//! Scaling of the states by powers of two: exact, and the difference between eight digits and none on a plant in
//! physical units.

use crate::StateSpace;
use crate::tolerance::{SCALING_GAIN, SCALING_SWEEPS};

/// Returns the system in the coordinates x = T z, T a diagonal of powers of two, and the diagonal of T.
///
/// Rows and columns of A get norms of like size (Osborne's method with Parlett and Reinsch's powers of two; B and C
/// stand in, at the size of A, for a row or column of zeros). No rounding error is made, short of overflow.
pub fn balance(g: &StateSpace) -> (StateSpace, Vec<f64>) {
    let n = g.order();
    let mut T = vec![1.0; n];
    let mut scaled = g.clone();
    let weight = |norm: f64| if norm > 0.0 { g.A.norm_max() / norm } else { 0.0 };
    let (of_inputs, of_outputs) = (weight(g.B.norm_max()), weight(g.C.norm_max()));
    for _ in 0..SCALING_SWEEPS {
        let step: Vec<f64> = sweep(&mut scaled, of_inputs, of_outputs);
        if step.iter().all(|&f| f == 1.0) {
            break;
        }
        T.iter_mut().zip(&step).for_each(|(t, f)| *t *= f);
    }
    (scaled, T)
}

/// Carries out one sweep of scaling in place, with the weights of the input matrix B and of the output matrix C; returns each state's factor.
fn sweep(g: &mut StateSpace, of_inputs: f64, of_outputs: f64) -> Vec<f64> {
    let n = g.order();
    let mut factors = vec![1.0; n];
    for i in 0..n {
        let (mut column, mut row) = (0.0, 0.0);
        for j in (0..n).filter(|&j| j != i) {
            column += g.A[(j, i)].abs();
            row += g.A[(i, j)].abs();
        }
        if column == 0.0 {
            column = of_outputs * g.C.column(i).iter().map(|x| x.abs()).sum::<f64>();
        }
        if row == 0.0 {
            row = of_inputs * (0..g.inputs()).map(|j| g.B[(i, j)].abs()).sum::<f64>();
        }
        let own = g.A[(i, i)].abs();
        let f = factor(column, row, own);
        if f != 1.0 {
            scale_one(g, i, f);
            factors[i] = f;
        }
    }
    factors
}

/// Returns the power of two by which a state's column is to be multiplied.
///
/// The diagonal entry counts in both: a coupling that is rounding error beside it must not be scaled up (James, Langou
/// and Lowery 2014).
fn factor(column: f64, row: f64, own: f64) -> f64 {
    if column == 0.0 || row == 0.0 {
        return 1.0;
    }
    let (column, row) = (column + own, row + own);
    if !(column / row).is_normal() {
        return 1.0;
    }
    let f = (0.5 * (row / column).log2()).round().exp2();
    if column * f + row / f < SCALING_GAIN * (column + row) { f } else { 1.0 }
}

fn scale_one(g: &mut StateSpace, i: usize, f: f64) {
    for j in (0..g.order()).filter(|&j| j != i) {
        g.A[(j, i)] *= f;
        g.A[(i, j)] /= f;
    }
    (0..g.outputs()).for_each(|k| g.C[(k, i)] *= f);
    (0..g.inputs()).for_each(|k| g.B[(i, k)] /= f);
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::{Mat, Timebase};

    #[test]
    fn a_resonance_in_physical_units_becomes_normal_and_stays_the_same_system() {
        let A = Mat::from_rows(&[&[0.0, 1.0], &[-1e10, -3.0]]);
        let (B, C) = (Mat::col(&[0.0, 7.0]), Mat::row(&[1e3, 0.0]));
        let g = StateSpace::new(A, B, C, Mat::zeros(1, 1), Timebase::Continuous).unwrap();
        let (scaled, T) = balance(&g);
        let ratio = scaled.A[(0, 1)] / -scaled.A[(1, 0)];
        assert!(ratio > 0.25 && ratio < 4.0, "{ratio}");
        assert_eq!(g.scale_states(&T), scaled);
    }
}
