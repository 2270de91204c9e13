//! The recordings' initial states, fitted together with the parameters: an initial state is a nuisance parameter of its own
//! recording, and what it could do in place of a parameter is removed from that parameter's column (the Schur complement of the
//! initial states in the normal equations).

use crate::tolerance::fitting::{INITIAL_STATE_PREFERENCE, INITIAL_STATE_RIDGE};
use counterpoise_linalg::{Mat, solve};
use counterpoise_simulate::replay::START_FREEDOMS;

use crate::recording::series::dot;
use crate::simulator_access::StartShift;

/// The effects of the degrees of freedom of one recording's initial state on its residuals.
pub(crate) struct StartColumns {
    columns: Vec<Option<Vec<f64>>>,
    normal: Mat,
}

impl StartColumns {
    /// Takes one column for each degree of freedom; `None` for one that changes nothing.
    pub fn new(columns: Vec<Option<Vec<f64>>>) -> Self {
        let entry = |i: usize, j: usize| match (&columns[i], &columns[j]) {
            (Some(a), Some(b)) => dot(a, b),
            _ => 0.0,
        };
        let mut normal = Mat::from_fn(columns.len(), columns.len(), entry);
        for i in 0..columns.len() {
            normal[(i, i)] = normal[(i, i)] * (1.0 + INITIAL_STATE_RIDGE) + INITIAL_STATE_PREFERENCE;
        }
        Self { columns, normal }
    }

    /// Returns the shift of the initial state that reproduces a series best, in least squares.
    pub fn fit_shift(&self, series: &[f64]) -> StartShift {
        let right: Vec<f64> =
            self.columns.iter().map(|c| c.as_ref().map_or(0.0, |c| dot(c, series))).collect();
        let found = solve(&self.normal, &Mat::col(&right)).ok().filter(Mat::is_finite);
        let shift = |k: usize| found.as_ref().map_or(0.0, |f| f.as_slice().get(k).copied().unwrap_or(0.0));
        let mut out = [0.0; START_FREEDOMS];
        out.iter_mut().enumerate().for_each(|(k, o)| *o = shift(k));
        out
    }

    /// Returns what is left of a series after a shift of the initial state is removed.
    pub fn subtract_shift(&self, series: &[f64], shift: &StartShift) -> Vec<f64> {
        let mut out = series.to_vec();
        for (column, s) in self.columns.iter().zip(shift) {
            for (o, c) in out.iter_mut().zip(column.as_deref().unwrap_or(&[])) {
                *o -= s * c;
            }
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_start_can_do_is_taken_off() {
        let one: Vec<f64> = (0..200).map(|k| 3.0 * (-0.05 * f64::from(k)).exp()).collect();
        let other: Vec<f64> = (0..200).map(|k| (0.03 * f64::from(k)).sin()).collect();
        let columns = vec![Some(one.clone()), None, Some(other.clone()), None, None, None];
        let starts = StartColumns::new(columns);
        let series: Vec<f64> = one.iter().zip(&other).map(|(a, b)| 2.0 * a - b).collect();
        let shift = starts.fit_shift(&series);
        assert!((shift[0] - 2.0).abs() < 0.01 && (shift[2] + 1.0).abs() < 0.01, "{shift:?}");
        let left = starts.subtract_shift(&series, &shift);
        assert!(dot(&left, &left) < 1e-4 * dot(&series, &series));
    }
}
