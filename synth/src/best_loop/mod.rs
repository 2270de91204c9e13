//! The best that any linear feedback of a loop can do: convex optimisation over the Youla parameter.
//!
//! The sampled plant P is stable, so every stabilising controller is K = Q / (1 - P Q) with Q stable (Youla, Jabr and Bongiorno, IEEE
//! TAC 21 (1976) 319), and S = 1 - P Q, T = P Q and K S = Q are affine in Q. With Q in a basis of delays, real poles and the plant's own zeros,
//! orthonormal on the grid, the least residual rate under limits of |S|, |T|, |KS| and the noise gain is a second-order cone program (Boyd and
//! Barratt, Linear Controller Design, 1991), which Clarabel solves.
//!
//! The answer is verified on a finer grid than that of the program. The dual value is a lower bound for this basis; what a richer
//! basis could still gain is shown by the value with half of it.

mod basis;
pub mod problem;
mod program;
#[cfg(test)]
mod tests;

use counterpoise_linalg::C64;
use counterpoise_lti::response::Response;
use counterpoise_lti::{StateSpace, is_stable};

use crate::sampling::sampled_plant;
use crate::tolerance::{BEST_LOOP_LIMIT_KEPT, BEST_LOOP_ROUNDS};
use crate::tuning::{Clock, Density, Disturbance, LoopGrid, LoopLimits, bilinear_factor};
use crate::{DesignPlant, Error, Sampling};
use basis::Basis;
use problem::BestLoopProblem;
use program::{Program, ProgramSolution};

/// Input of the search for the best linear feedback.
#[derive(Debug, Clone, Copy)]
pub struct BestLoopTask<'a> {
    /// The plant.
    pub plant: &'a DesignPlant,
    /// Sampling of a controller.
    pub sampling: &'a Sampling,
    /// Disturbance that acts on the loop.
    pub disturbance: &'a Disturbance,
    /// The limits that the loop must keep; those of |S|, |T|, |KS|, noise gain and effort are convex and count, margins and poles are left out.
    pub limits: LoopLimits,
}

/// The best feedback that the basis holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BestLoop {
    /// Residual rate, on the fine grid, rad/s.
    pub residual_rad_s: f64,
    /// No feedback in the basis leaves less on the program's grid: the value of the dual program, rad/s.
    pub lower_bound_rad_s: f64,
    /// Residual rate with half of the basis, rad/s; absent if half of it does not keep the limits.
    pub half_basis_rad_s: Option<f64>,
    /// Largest |S| on the fine grid.
    pub max_sensitivity: f64,
    /// Largest |T| on the fine grid.
    pub max_complementary: f64,
    /// Largest |KS| on the fine grid, V s/rad.
    pub control_peak: f64,
    /// RMS control for readings with noise of unit RMS, V s/rad.
    pub noise_gain: f64,
    /// RMS control under the disturbance, V.
    pub effort_v: f64,
    /// Functions of the basis.
    pub basis: usize,
    /// Frequencies of the fine grid.
    pub frequencies: usize,
}

/// The fine grid: the longest delay of the basis makes |Q| ripple with a period of a 160th of the sample rate, which eight frequencies
/// a period resolve. With a coarser grid the answer puts peaks between its frequencies, and the value is too low.
const DENSITY: Density = Density { per_decade: 100.0, linear: 640 };
/// Every so many frequencies of the fine grid are in the program from the start.
const COARSE: usize = 4;

/// Computes the best feedback.
///
/// # Errors
/// [`Error::BestLoop`] for a plant that is not stable, limits that no feedback of the basis keeps, or a program that the solver
/// gives up; those of the plant.
pub fn best_loop(task: &BestLoopTask<'_>) -> Result<BestLoop, Error> {
    let ground = Ground::new(task)?;
    let basis = Basis::build_full(&ground)?;
    let (found, lower_bound_rad_s) = ground.solve(task, &basis)?;
    let half = ground.solve(task, &Basis::build_half(&ground)?);
    Ok(BestLoop {
        lower_bound_rad_s,
        half_basis_rad_s: half.ok().map(|found| found.0.residual_rad_s),
        ..found
    })
}

/// The data that every program of a task starts from.
pub(crate) struct Ground {
    pub grid: LoopGrid,
    /// The plant on the grid.
    pub P: Vec<C64>,
    /// Gain at zero frequency.
    pub P0: f64,
    pub period_s: f64,
    pub system: StateSpace,
    pub noise: f64,
}

impl Ground {
    fn new(task: &BestLoopTask<'_>) -> Result<Self, Error> {
        let system = sampled_plant(task.plant, task.sampling)?;
        if !is_stable(&system)? {
            return Err(Error::BestLoop(BestLoopProblem::UnstablePlant));
        }
        let period_s = task.sampling.period_s;
        let factor = bilinear_factor(task.sampling).unwrap_or(2.0 / period_s);
        let grid = LoopGrid::new(
            std::slice::from_ref(&system),
            task.disturbance,
            Clock { period_s, factor },
            DENSITY,
        )?;
        let response = Response::of(&system)?;
        let P = response.at_all(&grid.rates)?.iter().map(|H| H[(0, 0)]).collect();
        let P0 = response.at(0.0)?[(0, 0)].re;
        Ok(Self { grid, P, P0, period_s, system, noise: task.disturbance.reading_noise_rad_s })
    }

    /// The answer in a basis with its dual value.
    fn solve(&self, task: &BestLoopTask<'_>, basis: &Basis) -> Result<(BestLoop, f64), Error> {
        let count = self.grid.rates.len();
        let mut used: Vec<usize> = (0..count).step_by(COARSE).collect();
        let mut last: Option<(BestLoop, f64)> = None;
        for _ in 0..BEST_LOOP_ROUNDS {
            let solved = Program { ground: self, basis, limits: &task.limits }.solve(&used)?;
            let found = self.measure_loop(&solved, basis);
            let beyond = self.violated_frequencies(&solved, &task.limits);
            last = Some((found, solved.dual));
            let fresh: Vec<usize> = beyond.into_iter().filter(|k| !used.contains(k)).collect();
            if fresh.is_empty() {
                break;
            }
            used.extend(fresh);
            used.sort_unstable();
        }
        last.ok_or(Error::BestLoop(BestLoopProblem::NothingSolved))
    }

    /// The frequencies at which a limit is exceeded.
    fn violated_frequencies(&self, solved: &ProgramSolution, limits: &LoopLimits) -> Vec<usize> {
        let over = |value: f64, limit: f64| value > limit * (1.0 + BEST_LOOP_LIMIT_KEPT);
        let is_over = |&k: &usize| {
            let T = self.P[k] * solved.Q[k];
            over((C64::ONE - T).norm(), limits.max_sensitivity)
                || over(T.norm(), limits.max_complementary)
                || over(solved.Q[k].norm(), limits.control_peak)
        };
        (0..self.P.len()).filter(is_over).collect()
    }

    fn measure_loop(&self, solved: &ProgramSolution, basis: &Basis) -> BestLoop {
        let (mut left, mut effort, mut noise) = (0.0, 0.0, 0.0);
        let (mut ms, mut mt, mut peak) = (0.0_f64, 0.0_f64, 0.0_f64);
        for (k, Q) in solved.Q.iter().enumerate() {
            let T = self.P[k] * Q;
            let S = C64::ONE - T;
            left +=
                self.grid.power[k] * S.norm_sqr() + self.noise.powi(2) * self.grid.share[k] * T.norm_sqr();
            effort += self.grid.power[k] * Q.norm_sqr();
            noise += self.grid.share[k] * Q.norm_sqr();
            (ms, mt, peak) = (ms.max(S.norm()), mt.max(T.norm()), peak.max(Q.norm()));
        }
        BestLoop {
            residual_rad_s: left.sqrt(),
            lower_bound_rad_s: 0.0,
            half_basis_rad_s: None,
            max_sensitivity: ms,
            max_complementary: mt,
            control_peak: peak,
            noise_gain: noise.sqrt(),
            effort_v: effort.sqrt(),
            basis: basis.size(),
            frequencies: self.P.len(),
        }
    }
}
