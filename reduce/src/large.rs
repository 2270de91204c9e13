//! Balanced truncation of large damped structures with sparse matrices, from low-rank Gramians.

use counterpoise_linalg as linalg;
use counterpoise_linalg::{
    C64, CMat, Mat, Sparse,
    sparse::{
        BalancedDirections, GramianAccuracy, ProgressObserver, QuadraticPencil, StageProgress,
        StructurePorts, low_rank_gramians,
    },
};
use counterpoise_lti::{StateSpace, Timebase, is_stable, response_at};

use crate::error::StepContext;
use crate::reduction::{bound, choose};
use crate::tolerance::{IDLE_CONTRIBUTION, MOST_STEPS};
use crate::{Error, Order, Warning};

/// A large structure
///
/// ```text
///   M x'' + C x' + K x = F u,     y = P x + V x'     M, C, K: sparse, symmetric, K > 0, every mode damped; F: n x m; P, V: p x n
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct LargeStructure {
    /// Mass, symmetric.
    pub M: Sparse,
    /// Damping, symmetric.
    pub C: Sparse,
    /// Stiffness, symmetric positive definite: the structure is held.
    pub K: Sparse,
    /// Directions of the input forces.
    pub F: Mat,
    /// Output rows of the positions.
    pub P: Mat,
    /// Output rows of the velocities.
    pub V: Mat,
}

/// A reduced large structure.
#[derive(Debug, Clone, PartialEq)]
pub struct LargeReduction {
    /// The reduced system in first-order form.
    pub system: StateSpace,
    /// Hankel values, largest first, from below: the factors hold parts of the Gramians.
    pub hankel: Vec<f64>,
    /// Twice the sum of the values dropped. It *estimates* a bound on the H-infinity error and proves none, because values that the factors miss
    /// are not in the sum.
    pub estimated_bound: f64,
    /// States kept.
    pub kept: usize,
    /// Factorisations that the Gramians took.
    pub steps: usize,
    /// Warnings for the user.
    pub warnings: Vec<Warning>,
}

/// Returns the balanced truncation of a large structure.
///
/// `watch` is told how far the iteration is, and may stop it.
///
/// # Errors
/// [`Error::Matrix`] if the structure is not held, a mode is not damped, memory does not suffice or `watch` asks to stop; [`Error::Range`].
pub fn balred_large(
    structure: &LargeStructure,
    order: Order,
    watch: &mut ProgressObserver,
) -> Result<LargeReduction, Error> {
    if let Some(value) = structure.M.diagonal().into_iter().find(|mass| mass.is_nan() || *mass <= 0.0) {
        let what = "a diagonal entry of the mass matrix";
        return Err(Error::Range { what, value, allowed: "positive: eliminate massless unknowns first" });
    }
    let pencil = QuadraticPencil::of(&structure.M, &structure.C, &structure.K).with_step("balancing")?;
    let ports = StructurePorts { F: &structure.F, P: &structure.P, V: &structure.V };
    let accuracy = GramianAccuracy { contribution: IDLE_CONTRIBUTION, steps: MOST_STEPS };
    let gramians = low_rank_gramians(&pencil, &ports, accuracy, watch).with_step("balancing")?;
    let directions = gramians.balanced_directions(&pencil).with_step("balancing")?;
    let (kept, mut warnings) = choose(&directions.values, order, 0)?;
    if gramians.last_contribution > IDLE_CONTRIBUTION {
        warnings.push(Warning::GramiansUnfinished { share: gramians.last_contribution });
    }
    let system = project_structure(structure, &directions, kept)?;
    if let Some(pole) = unstable_pole(&system)? {
        return Err(Error::Unstable { what: "the reduced structure", re: pole.re, im: pole.im });
    }
    Ok(LargeReduction {
        system,
        estimated_bound: bound(&directions.values, kept),
        hankel: directions.values,
        kept,
        steps: gramians.shifts.len(),
        warnings,
    })
}

fn unstable_pole(system: &StateSpace) -> Result<Option<C64>, Error> {
    if is_stable(system)? {
        return Ok(None);
    }
    Ok(counterpoise_lti::poles(system)?.into_iter().max_by(|a, b| a.re.total_cmp(&b.re)))
}

/// Returns the structure in the first balanced directions.
fn project_structure(
    g: &LargeStructure,
    directions: &BalancedDirections,
    kept: usize,
) -> Result<StateSpace, Error> {
    let n = g.M.nrows();
    let scale = Mat::diag(&directions.values[..kept].iter().map(|s| 1.0 / s.sqrt()).collect::<Vec<f64>>());
    let half = |A: &Mat, top: usize| &A.block(top, 0, n, kept) * &scale;
    let (position, velocity) = (half(&directions.right, 0), half(&directions.right, n));
    let (of_position, of_force) = (half(&directions.left, 0), half(&directions.left, n));
    let force = -&(&g.K.times(&position) + &g.C.times(&velocity));
    let onto = |W: &Mat, X: &Mat| linalg::transpose_times(W, X).with_step("projecting the structure");
    let A = &onto(&of_position, &velocity)? + &onto(&of_force, &force)?;
    let B = onto(&of_force, &g.F)?;
    let C = &(&g.P * &position) + &(&g.V * &velocity);
    Ok(StateSpace::new(A, B, C, Mat::zeros(g.P.nrows(), g.F.ncols()), Timebase::Continuous)?)
}

/// Returns the largest gain of the error of a reduced structure at one frequency, from a factorisation of the whole structure there.
///
/// # Errors
/// [`Error::Matrix`] at an undamped mode's frequency, or if memory does not suffice; [`Error::System`]; [`Error::Shape`].
pub fn error_at(g: &LargeStructure, reduced: &StateSpace, rate_rad_s: f64) -> Result<f64, Error> {
    let (n, m, p) = (g.M.nrows(), reduced.inputs(), reduced.outputs());
    for (what, found, expected) in
        [("F", g.F.shape(), (n, m)), ("P", g.P.shape(), (p, n)), ("V", g.V.shape(), (p, n))]
    {
        if found != expected {
            return Err(Error::Shape { what, found, expected });
        }
    }
    let pencil = QuadraticPencil::of(&g.M, &g.C, &g.K).with_step("the response of the structure")?;
    let s = C64::new(0.0, rate_rad_s);
    let quiet = &mut |_: StageProgress| std::ops::ControlFlow::Continue(());
    let factors =
        pencil.at(s, "the response of the structure", quiet).with_step("the response of the structure")?;
    let x = factors.solve(&g.F.to_complex()).with_step("the response of the structure")?;
    let exact: CMat = &g.P.to_complex() * &x + (&g.V.to_complex() * &x).scale(s);
    let error = &exact - &response_at(reduced, rate_rad_s)?;
    let values = linalg::csingular_values(&error).with_step("the response of the structure")?;
    Ok(values.into_iter().fold(0.0, f64::max))
}
