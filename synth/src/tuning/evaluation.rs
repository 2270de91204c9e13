//! Objective and limits of a loop at a point, each with its slopes.

use counterpoise_linalg::C64;

use super::crossings::crossings;
use super::family::GridResponse;
use super::grid::LoopPlant;
use super::limits::{decay_rates, pole_region};
use super::loop_response::{Row, TuningResponse};
use super::problem::Problem;
use crate::Error;
use crate::tolerance::{FAR_BELOW_LIMIT, POLE_STEP};

/// A loop at a point.
#[derive(Debug, Clone)]
pub(crate) struct Evaluation {
    /// ln of the residual rate, on each plant.
    pub objectives: Vec<Row>,
    /// Relative excess over each limit; at most 0 if it is kept. Each peak near its limit has a row.
    pub limits: Vec<Row>,
    /// The second-order part of the objective on the worst plant (Gauss and Newton's), row by row.
    pub curvature: Vec<Vec<f64>>,
}

impl Evaluation {
    /// Returns the objective on the worst plant.
    pub fn objective(&self) -> f64 {
        self.objectives.iter().map(|row| row.value).fold(f64::NEG_INFINITY, f64::max)
    }

    /// Returns what the worst limit is exceeded by; 0 if all are kept.
    pub fn worst_exceedance(&self) -> f64 {
        self.limits.iter().map(|row| row.value).fold(0.0, f64::max)
    }
}

/// Poles with a row of their own: as many as have been seen to share a limit, and one more.
const SLOWEST: usize = 5;

impl Problem<'_> {
    /// Evaluates the loop at a point; whether it is stable is another question.
    pub fn evaluate(&self, at: &[f64]) -> Result<Evaluation, Error> {
        let GridResponse { K, slopes } = self.family.response(at, &self.grid)?;
        let (mut objectives, mut limits) = (Vec::new(), Vec::new());
        let mut curvature = (f64::NEG_INFINITY, Vec::new());
        for plant in &self.plants {
            let response = respond(self, plant, &K, &slopes);
            let objective = self.residual(&response);
            if objective.value > curvature.0 {
                curvature = (objective.value, self.curvature(&response));
            }
            objectives.push(objective);
            limits.extend(self.peaks(&response));
            limits.extend(self.mean_squares(&response));
            limits.extend(crossings(&response, &self.limits));
        }
        limits.extend(self.poles(at)?);
        Ok(Evaluation { objectives, limits, curvature: curvature.1 })
    }

    /// ln of the residual rate.
    fn residual(&self, response: &TuningResponse<'_>) -> Row {
        let noise = self.task.disturbance.reading_noise_rad_s.powi(2);
        let (mut sum, mut slope) = (0.0, vec![0.0; self.family.ranges().len()]);
        for k in 0..response.S.len() {
            let (S, T) = (response.S[k], response.L[k] * response.S[k]);
            let (left, of_noise) =
                (self.grid.power[k] * S.norm_sqr(), noise * self.grid.share[k] * T.norm_sqr());
            sum += left + of_noise;
            for (total, D) in slope.iter_mut().zip(&response.slopes[k]) {
                *total += left * -(T * D).re + of_noise * (S * D).re;
            }
        }
        slope.iter_mut().for_each(|each| *each /= sum);
        Row { value: 0.5 * sum.ln(), slope }
    }

    /// sum power |dS|^2 / sum power |S|^2.
    fn curvature(&self, response: &TuningResponse<'_>) -> Vec<Vec<f64>> {
        let n = self.family.ranges().len();
        let (mut sum, mut all) = (0.0, vec![vec![0.0; n]; n]);
        for k in 0..response.S.len() {
            let power = self.grid.power[k];
            if power == 0.0 {
                continue;
            }
            let S = response.S[k];
            sum += power * S.norm_sqr();
            let moved: Vec<C64> = response.slopes[k].iter().map(|D| S * response.L[k] * S * D).collect();
            for i in 0..n {
                for j in 0..n {
                    all[i][j] += power * (moved[i].conj() * moved[j]).re;
                }
            }
        }
        all.iter_mut().flatten().for_each(|each| *each /= sum);
        all
    }

    /// A row for each peak of |S|, |T| and |KS| that is near its limit.
    fn peaks(&self, response: &TuningResponse<'_>) -> Vec<Row> {
        let count = response.S.len();
        let limits = [self.limits.max_sensitivity, self.limits.max_complementary, self.limits.control_peak];
        let mut rows = Vec::new();
        for (which, limit) in limits.into_iter().enumerate().filter(|(_, limit)| limit.is_finite()) {
            let size = |k: usize| match which {
                0 => response.S[k].norm(),
                1 => (response.L[k] * response.S[k]).norm(),
                _ => response.effort[k],
            };
            let sizes: Vec<f64> = (0..count).map(size).collect();
            for k in 0..count {
                let is_peak =
                    (k == 0 || sizes[k] >= sizes[k - 1]) && (k + 1 == count || sizes[k] >= sizes[k + 1]);
                let value = (sizes[k] / limit).ln();
                if !is_peak || value < FAR_BELOW_LIMIT {
                    continue;
                }
                let factor = if which == 0 { -response.L[k] * response.S[k] } else { response.S[k] };
                let slope = response.slopes[k].iter().map(|D| (factor * D).re).collect();
                rows.push(Row { value, slope });
            }
        }
        rows
    }

    /// Noise gain and effort.
    fn mean_squares(&self, response: &TuningResponse<'_>) -> Vec<Row> {
        let pairs = [(self.limits.noise_gain, &self.grid.share), (self.limits.effort_v, &self.grid.power)];
        let mut rows = Vec::new();
        for (limit, weights) in pairs.into_iter().filter(|(limit, _)| limit.is_finite()) {
            let (mut sum, mut slope) = (0.0, vec![0.0; self.family.ranges().len()]);
            for (k, weight) in weights.iter().enumerate() {
                let part = weight * response.effort[k].powi(2);
                sum += part;
                for (total, D) in slope.iter_mut().zip(&response.slopes[k]) {
                    *total += part * (response.S[k] * D).re;
                }
            }
            slope.iter_mut().for_each(|each| *each /= sum);
            rows.push(Row { value: 0.5 * sum.ln() - limit.ln(), slope });
        }
        rows
    }

    /// Decays of the slowest poles of the closed loop and its damping, with slopes from differences: a pole moves smoothly unless two meet.
    /// Several poles have a row each, because at the answer they often share the limit.
    fn poles(&self, at: &[f64]) -> Result<Vec<Row>, Error> {
        let asked = [self.limits.decay_rad_s, self.limits.damping];
        if asked.iter().all(|limit| *limit <= 0.0) {
            return Ok(Vec::new());
        }
        let missing = |at: &[f64]| -> Result<[f64; SLOWEST + 1], Error> {
            let crossover_rad_s = if asked[1] > 0.0 { self.crossover(at)? } else { 0.0 };
            let (mut worst, mut damped) = (Vec::new(), f64::NEG_INFINITY);
            for (poles, plant) in
                self.closed_poles(&self.family.unchecked_feedback(at)?)?.iter().zip(&self.plants)
            {
                let (_, damping) = pole_region(poles, &plant.system, crossover_rad_s);
                damped = damped.max(1.0 - damping / asked[1]);
                worst.extend(
                    decay_rates(poles, &plant.system).into_iter().map(|decay| 1.0 - decay / asked[0]),
                );
            }
            worst.sort_by(|a, b| b.total_cmp(a));
            let mut all = [f64::NEG_INFINITY; SLOWEST + 1];
            if asked[0] > 0.0 {
                all.iter_mut().take(SLOWEST).zip(worst).for_each(|(row, missed)| *row = missed);
            }
            if asked[1] > 0.0 {
                all[SLOWEST] = damped;
            }
            Ok(all)
        };
        let here = missing(at)?;
        let mut rows: Vec<Row> = here.map(|value| Row { value, slope: Vec::new() }).into();
        for k in 0..at.len() {
            let mut moved = at.to_vec();
            moved[k] += POLE_STEP;
            let next = missing(&moved)?;
            rows.iter_mut().zip(next).for_each(|(row, next)| row.slope.push((next - row.value) / POLE_STEP));
        }
        rows.retain(|row| row.value.is_finite() && row.slope.iter().all(|slope| slope.is_finite()));
        Ok(rows)
    }

    /// The highest frequency of the grid at which the nominal loop's gain is above 1, rad/s.
    fn crossover(&self, at: &[f64]) -> Result<f64, Error> {
        let K = self.family.gain(at, &self.grid)?;
        let above = |k: &usize| (K[*k] * self.plants[0].response[*k]).norm() > 1.0;
        Ok((0..K.len()).rev().find(above).map_or(0.0, |k| self.grid.rates[k]))
    }
}

fn respond<'a>(
    problem: &'a Problem<'_>,
    plant: &LoopPlant,
    K: &[C64],
    slopes: &'a [Vec<C64>],
) -> TuningResponse<'a> {
    let L: Vec<C64> = plant.response.iter().zip(K).map(|(P, K)| P * K).collect();
    let S: Vec<C64> = L.iter().map(|L| (C64::ONE + L).inv()).collect();
    let effort = K.iter().zip(&S).map(|(K, S)| (K * S).norm()).collect();
    TuningResponse { rates: &problem.grid.rates, L, S, effort, slopes }
}
