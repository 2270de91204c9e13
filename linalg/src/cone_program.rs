//! Convex programs: a linear or quadratic cost under linear equations, inequalities and second-order cones.
//!
//! ```text
//!     least   x' P x / 2 + cost' x   under   rows x + slack = bound,   the slack of each group of rows in its cone
//! ```
//!
//! The interior-point method is Clarabel's (Goulart and Chen, "Clarabel: an interior-point solver for conic programs with quadratic
//! objectives", 2024). It is called here alone, so that it is compiled once.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettingsBuilder, DefaultSolver, IPSolver, SolverStatus, SupportedConeT};

use crate::tolerance::CONE_PROGRAM_STEPS;

/// Cone in which the slacks of a group of rows lie.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cone {
    /// Zero: each row is an equation.
    Zero,
    /// Not negative: each row is an upper bound.
    Nonnegative,
    /// The first is at least the Euclidean norm of the others.
    SecondOrder,
}

/// A convex program, built row by row.
#[derive(Debug, Clone, Default)]
pub struct ConeProgram {
    quadratic: Option<Vec<Vec<f64>>>,
    cost: Vec<f64>,
    rows: Vec<Vec<f64>>,
    bound: Vec<f64>,
    cones: Vec<SupportedConeT<f64>>,
}

/// Why a program has no solution.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ConeFailure {
    /// The program is not well formed: rows of different lengths, or fewer bounds than rows.
    Malformed,
    /// No point keeps every row.
    Infeasible,
    /// The method did not converge, or the cost has no least value.
    NotConverged,
}

/// The solution of a program.
#[derive(Debug, Clone, PartialEq)]
pub struct ConeSolution {
    /// The variables.
    pub x: Vec<f64>,
    /// Price of each row, in the order in which they were added: by how much the least cost falls for each unit by which its bound rises.
    pub prices: Vec<f64>,
    /// Value of the dual program: no point that keeps every row costs less, up to the accuracy of the method.
    pub dual: f64,
}

impl ConeProgram {
    /// Returns a program with a linear cost and no rows; the length of the cost is the number of variables.
    pub fn new(cost: Vec<f64>) -> Self {
        Self { cost, ..Self::default() }
    }

    /// Returns the program with a quadratic cost besides, of which the upper triangle is read.
    pub fn with_quadratic(self, upper: Vec<Vec<f64>>) -> Self {
        Self { quadratic: Some(upper), ..self }
    }

    /// Returns the number of variables.
    pub fn variables(&self) -> usize {
        self.cost.len()
    }

    /// Returns the number of rows.
    pub fn rows(&self) -> usize {
        self.rows.len()
    }

    /// Adds a group of rows whose slacks are in one cone.
    pub fn push(&mut self, rows: Vec<Vec<f64>>, bound: Vec<f64>, cone: Cone) {
        let size = bound.len();
        self.rows.extend(rows);
        self.bound.extend(bound);
        self.cones.push(match cone {
            Cone::Zero => SupportedConeT::ZeroConeT(size),
            Cone::Nonnegative => SupportedConeT::NonnegativeConeT(size),
            Cone::SecondOrder => SupportedConeT::SecondOrderConeT(size),
        });
    }

    /// Solves the program.
    ///
    /// # Errors
    /// [`ConeFailure`]: why there is no solution.
    pub fn solve(&self) -> Result<ConeSolution, ConeFailure> {
        let n = self.variables();
        let has_shape = self.rows.len() == self.bound.len() && self.rows.iter().all(|row| row.len() == n);
        if !has_shape {
            return Err(ConeFailure::Malformed);
        }
        let settings = DefaultSettingsBuilder::default().verbose(false).max_iter(CONE_PROGRAM_STEPS).build();
        let settings = settings.map_err(|_| ConeFailure::Malformed)?;
        let P = self.quadratic.as_ref().map_or_else(|| CscMatrix::zeros((n, n)), CscMatrix::from);
        let A = CscMatrix::from(&self.rows);
        let set_up = DefaultSolver::new(&P, &self.cost, &A, &self.bound, &self.cones, settings);
        let mut solver = set_up.map_err(|_| ConeFailure::Malformed)?;
        solver.solve();
        match solver.solution.status {
            SolverStatus::Solved | SolverStatus::AlmostSolved => {
                let found = &solver.solution;
                Ok(ConeSolution { x: found.x.clone(), prices: found.z.clone(), dual: found.obj_val_dual })
            }
            SolverStatus::PrimalInfeasible | SolverStatus::AlmostPrimalInfeasible => {
                Err(ConeFailure::Infeasible)
            }
            _ => Err(ConeFailure::NotConverged),
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// The point of the unit disc nearest to (3, 4) is (0.6, 0.8), at the distance 4.
    #[test]
    fn the_nearest_point_of_a_disc_is_found_by_either_form_of_the_cost() {
        let disc = |program: &mut ConeProgram, n: usize| {
            let unit = |k: usize| (0..n).map(|j| if j == k { -1.0 } else { 0.0 }).collect::<Vec<f64>>();
            program.push(vec![vec![0.0; n], unit(0), unit(1)], vec![1.0, 0.0, 0.0], Cone::SecondOrder);
        };
        let mut quadratic =
            ConeProgram::new(vec![-3.0, -4.0]).with_quadratic(vec![vec![1.0, 0.0], vec![0.0, 1.0]]);
        disc(&mut quadratic, 2);
        let found = quadratic.solve().unwrap();
        assert!((found.x[0] - 0.6).abs() < 1e-6 && (found.x[1] - 0.8).abs() < 1e-6, "{found:?}");
        let mut linear = ConeProgram::new(vec![0.0, 0.0, 1.0]);
        disc(&mut linear, 3);
        let rows = vec![vec![0.0, 0.0, -1.0], vec![1.0, 0.0, 0.0], vec![0.0, 1.0, 0.0]];
        linear.push(rows, vec![0.0, 3.0, 4.0], Cone::SecondOrder);
        let found = linear.solve().unwrap();
        assert!((found.prices[0] - 1.0).abs() < 1e-6, "a disc larger by d is nearer by d: {found:?}");
        assert!((found.x[2] - 4.0).abs() < 1e-6 && (found.dual - 4.0).abs() < 1e-6, "{found:?}");
    }

    #[test]
    fn a_program_without_a_solution_says_why() {
        let mut program = ConeProgram::new(vec![1.0]);
        program.push(vec![vec![1.0]], vec![-1.0], Cone::Nonnegative);
        assert_eq!(program.solve(), Err(ConeFailure::NotConverged), "x <= -1 has no least value");
        program.push(vec![vec![-1.0]], vec![0.0], Cone::Nonnegative);
        assert_eq!(program.solve(), Err(ConeFailure::Infeasible), "x >= 0 as well");
        program.push(vec![vec![1.0, 0.0]], vec![0.0], Cone::Zero);
        assert_eq!(program.solve(), Err(ConeFailure::Malformed));
    }
}
