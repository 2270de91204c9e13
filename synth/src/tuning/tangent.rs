//! The tangent program of a step: every objective and every limit by its line, in a box.
//!
//! ```text
//!     least   t + penalty s + h' B h / 2
//!     under   f_p + g_p' h <= t,    v_i + g_i' h <= s,    s >= 0,    low <= h <= high
//! ```

use counterpoise_linalg::{Cone, ConeFailure, ConeProgram};

use super::evaluation::Evaluation;
use super::loop_response::Row;
use crate::Error;
use crate::tolerance::TANGENT_RIDGE;

/// Weight of the worst limit that is exceeded against the objective: the penalty is exact if it is above the sum of the multipliers, which
/// for relative limits and a relative objective are of the order of 1.
pub(crate) const PENALTY: f64 = 30.0;
/// A step with what it promises.
pub(crate) struct Step {
    pub h: Vec<f64>,
    /// The merit that the lines predict.
    pub predicted: f64,
}

/// The merit of a loop: objective and penalty.
pub(crate) fn merit(found: &Evaluation) -> f64 {
    found.objective() + PENALTY * found.worst_exceedance()
}

/// Solves the tangent program; `None` if the solver gives up.
///
/// # Errors
/// [`Error::System`] if the program cannot be set up.
pub(crate) fn tangent_step(found: &Evaluation, low: &[f64], high: &[f64]) -> Result<Option<Step>, Error> {
    let n = low.len();
    let base = found.objective();
    let mut rows: Vec<Vec<f64>> = Vec::new();
    let mut bound = Vec::new();
    let mut line = |row: &Row, slack: usize, value: f64| {
        let mut entries = row.slope.clone();
        entries.resize(n + 2, 0.0);
        entries[n + slack] = -1.0;
        rows.push(entries);
        bound.push(-value);
    };
    found.objectives.iter().for_each(|row| line(row, 0, row.value - base));
    found.limits.iter().for_each(|row| line(row, 1, row.value));
    let unit = |index: usize, sign: f64| (0..n + 2).map(|k| if k == index { sign } else { 0.0 }).collect();
    rows.push(unit(n + 1, -1.0));
    bound.push(0.0);
    for k in 0..n {
        rows.extend([unit(k, 1.0), unit(k, -1.0)]);
        bound.extend([high[k], -low[k]]);
    }
    let mut P = vec![vec![0.0; n + 2]; n + 2];
    for (i, row) in found.curvature.iter().enumerate() {
        // The solver takes the upper triangle.
        for j in i..n {
            P[i][j] = row[j] + if i == j { TANGENT_RIDGE } else { 0.0 };
        }
    }
    let mut cost = vec![0.0; n + 2];
    (cost[n], cost[n + 1]) = (1.0, PENALTY);
    let mut program = ConeProgram::new(cost).with_quadratic(P);
    program.push(rows, bound, Cone::Nonnegative);
    let h = match program.solve() {
        Ok(found) => found.x[..n].to_vec(),
        Err(ConeFailure::Malformed) => {
            return Err(Error::System { what: "tuning", problem: "the tangent program could not be set up" });
        }
        Err(_) => return Ok(None),
    };
    let along = |row: &Row| row.value + row.slope.iter().zip(&h).map(|(g, h)| g * h).sum::<f64>();
    let objective = found.objectives.iter().map(along).fold(f64::NEG_INFINITY, f64::max);
    let exceeded = found.limits.iter().map(along).fold(0.0, f64::max);
    let bend = |i: usize| found.curvature[i].iter().zip(&h).map(|(b, h)| b * h).sum::<f64>();
    let curved: f64 = (0..n).map(|i| 0.5 * h[i] * bend(i)).sum();
    Ok(Some(Step { predicted: objective + PENALTY * exceeded + curved, h }))
}
