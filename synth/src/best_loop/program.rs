//! The second-order cone program of the best feedback.
//!
//! ```text
//!     least t   under   || residual(x) || <= t,   || noise gain(x) || <= limit,   || effort(x) || <= limit,
//!                       |1 - P Q_k| <= Ms,  |P Q_k| <= Mt,  |Q_k| <= KS  at the used frequencies,   P(0) Q(0) = 1
//! ```

use counterpoise_linalg::{C64, Cone, ConeFailure, ConeProgram, Mat, qr_r};

use super::Ground;
use super::basis::Basis;
use super::problem::BestLoopProblem;
use crate::Error;
use crate::tuning::LoopLimits;

/// A program on some frequencies of the grid.
pub(crate) struct Program<'a> {
    pub ground: &'a Ground,
    pub basis: &'a Basis,
    pub limits: &'a LoopLimits,
}

/// Its answer.
pub(crate) struct ProgramSolution {
    /// Q on the whole grid.
    pub Q: Vec<C64>,
    /// Value of the dual program.
    pub dual: f64,
}

impl Program<'_> {
    /// Solves the program with the limits of |S|, |T| and |KS| at the given frequencies.
    pub fn solve(&self, used: &[usize]) -> Result<ProgramSolution, Error> {
        let n = self.basis.size();
        // The residual is scaled to the order of 1, by what would be left without feedback.
        let scale = self.ground.grid.power.iter().sum::<f64>().sqrt();
        let mut cost = vec![0.0; n + 1];
        cost[n] = 1.0;
        let mut cones = ConeProgram::new(cost);
        self.integral(&mut cones);
        self.residual(&mut cones, scale)?;
        self.mean_square(&mut cones, self.limits.noise_gain, &self.ground.grid.share)?;
        self.mean_square(&mut cones, self.limits.effort_v, &self.ground.grid.power)?;
        for &k in used {
            self.peaks(&mut cones, k);
        }
        let found = cones.solve().map_err(refusal)?;
        let at = |k: usize| (0..n).map(|j| self.basis.columns[j][k] * found.x[j]).sum();
        Ok(ProgramSolution { Q: (0..self.ground.P.len()).map(at).collect(), dual: found.dual * scale })
    }

    /// P(0) Q(0) = 1: no steady error.
    fn integral(&self, cones: &mut ConeProgram) {
        let mut row: Vec<f64> = self.basis.at_zero.iter().map(|value| self.ground.P0 * value).collect();
        row.push(0.0);
        cones.push(vec![row], vec![1.0], Cone::Zero);
    }

    /// || residual || <= t, by a triangular factor of its rows.
    fn residual(&self, cones: &mut ConeProgram, scale: f64) -> Result<(), Error> {
        let (grid, P) = (&self.ground.grid, &self.ground.P);
        let mut rows: Vec<(usize, f64, f64)> = Vec::new();
        for k in 0..P.len() {
            let (power, noise) =
                (grid.power[k].sqrt() / scale, self.ground.noise * grid.share[k].sqrt() / scale);
            rows.extend((power > 0.0).then_some((k, power, 1.0)));
            rows.extend((noise > 0.0).then_some((k, noise, 0.0)));
        }
        // The rows of weight (S or T): S = 1 - P Q has the constant 1.
        let of = |(k, weight, constant): (usize, f64, f64)| {
            let column = move |j: usize| P[k] * self.basis.columns[j][k] * weight;
            (column, constant * weight)
        };
        let mut stacked = Vec::new();
        for row in rows {
            let (column, constant) = of(row);
            stacked
                .push((0..self.basis.size()).map(|j| column(j).re).chain([constant]).collect::<Vec<f64>>());
            stacked.push((0..self.basis.size()).map(|j| column(j).im).chain([0.0]).collect());
        }
        let R = triangular(&stacked)?;
        let n = self.basis.size();
        // || R [x; -1] || <= t.
        let mut entries = vec![[vec![0.0; n], vec![-1.0]].concat()];
        let mut bound = vec![0.0];
        for i in 0..R.nrows() {
            entries.push((0..n).map(|j| -R[(i, j)]).chain([0.0]).collect());
            bound.push(-R[(i, n)]);
        }
        cones.push(entries, bound, Cone::SecondOrder);
        Ok(())
    }

    /// sqrt(sum weight |Q|^2) <= limit; nothing for an infinite limit.
    fn mean_square(&self, cones: &mut ConeProgram, limit: f64, weights: &[f64]) -> Result<(), Error> {
        if !limit.is_finite() {
            return Ok(());
        }
        let n = self.basis.size();
        let mut stacked = Vec::new();
        for (k, weight) in weights.iter().enumerate().filter(|(_, weight)| **weight > 0.0) {
            let value = |j: usize| self.basis.columns[j][k] * (weight.sqrt() / limit);
            stacked.push((0..n).map(|j| value(j).re).collect::<Vec<f64>>());
            stacked.push((0..n).map(|j| value(j).im).collect());
        }
        let R = triangular(&stacked)?;
        let mut entries = vec![vec![0.0; n + 1]];
        let mut bound = vec![1.0];
        for i in 0..R.nrows() {
            entries.push((0..n).map(|j| -R[(i, j)]).chain([0.0]).collect());
            bound.push(0.0);
        }
        cones.push(entries, bound, Cone::SecondOrder);
        Ok(())
    }

    /// |1 - P Q|, |P Q| and |Q| at a frequency, each over its limit.
    fn peaks(&self, cones: &mut ConeProgram, k: usize) {
        let limits = [
            (self.limits.max_sensitivity, self.ground.P[k], 1.0),
            (self.limits.max_complementary, self.ground.P[k], 0.0),
            (self.limits.control_peak, C64::ONE, 0.0),
        ];
        for (limit, factor, constant) in limits.into_iter().filter(|(limit, ..)| limit.is_finite()) {
            let value = |j: usize| factor * self.basis.columns[j][k] / limit;
            let n = self.basis.size();
            let re = (0..n).map(|j| value(j).re).chain([0.0]).collect();
            let im = (0..n).map(|j| value(j).im).chain([0.0]).collect();
            let rows = vec![vec![0.0; n + 1], re, im];
            cones.push(rows, vec![1.0, constant / limit, 0.0], Cone::SecondOrder);
        }
    }
}

/// The triangular factor of stacked rows: the same norm with few rows.
fn triangular(rows: &[Vec<f64>]) -> Result<Mat, Error> {
    let columns = rows.first().map_or(0, Vec::len);
    let M = Mat::from_fn(rows.len().max(columns), columns, |i, j| rows.get(i).map_or(0.0, |row| row[j]));
    Ok(qr_r(&M)?)
}

/// Why there is no best feedback.
fn refusal(why: ConeFailure) -> Error {
    Error::BestLoop(match why {
        ConeFailure::Malformed => BestLoopProblem::Malformed,
        ConeFailure::Infeasible => BestLoopProblem::Infeasible,
        ConeFailure::NotConverged => BestLoopProblem::NotConverged,
    })
}
