//! Balanced truncation and its singular perturbation, on the stable part.

use crate::error::StepContext;
use crate::measure::error_norm;
use crate::reduction::{bound, choose, count_above_rounding};
use crate::split::split_stable;
use crate::{Error, Method, Order, Reduction};
use counterpoise_linalg as linalg;
use counterpoise_linalg::Mat;
use counterpoise_lti::scaling::balance;
use counterpoise_lti::{StateSpace, Timebase, gramian_factors, parallel};

/// A stable system with the factors of its Gramians P = R R', Q = L L' and the decomposition L'R = U S V'.
#[derive(Debug, Clone)]
pub struct BalancedSystem {
    system: StateSpace,
    R: Mat,
    L: Mat,
    U: Mat,
    V: Mat,
    values: Vec<f64>,
}

impl BalancedSystem {
    /// Prepares a stable system: two factored Lyapunov equations and a singular value decomposition.
    ///
    /// # Errors
    /// [`Error::System`] with the pole where the system is not stable.
    pub fn of(g: &StateSpace) -> Result<Self, Error> {
        let (system, _) = balance(g);
        let (R, L) = gramian_factors(&system)?;
        Self::from_factors(system, R, L)
    }

    /// Prepares a system with factors of its own, of weighted Gramians say; each has a row a state.
    ///
    /// # Errors
    /// [`Error::Matrix`] if the decomposition fails.
    pub fn from_factors(system: StateSpace, R: Mat, L: Mat) -> Result<Self, Error> {
        if ![&system.A, &system.B, &system.C, &system.D, &R, &L].iter().all(|matrix| matrix.is_finite()) {
            return Err(counterpoise_lti::Error::NotFinite { what: "the system to be reduced" }.into());
        }
        let parts = linalg::svd(&(&L.t() * &R)).with_step("balancing")?;
        let mut values = parts.s;
        values.truncate(system.order());
        Ok(Self { system, R, L, U: parts.U, V: parts.V, values })
    }

    /// Returns the Hankel values, largest first.
    pub fn hankel(&self) -> &[f64] {
        &self.values
    }

    /// Returns the number of Hankel values above rounding: the largest order that can be asked for.
    pub fn numerical_order(&self) -> usize {
        count_above_rounding(&self.values)
    }

    /// Returns the system of order `r` by the given method; r at most [`BalancedSystem::numerical_order`].
    ///
    /// # Errors
    /// [`Error::Rounding`] if r is larger; [`Error::Matrix`] if the projection is singular.
    pub fn reduce(&self, r: usize, method: Method) -> Result<StateSpace, Error> {
        let largest = self.numerical_order();
        if r > largest {
            return Err(Error::Rounding { wanted: r, largest });
        }
        match method {
            Method::SquareRoot => self.square_root(r),
            Method::BalancingFree => self.balancing_free(r),
            Method::MatchDc => residualise(&self.square_root(largest)?, r),
        }
    }

    /// Right and left projections R V and L U on the first r directions.
    fn directions(&self, r: usize) -> (Mat, Mat) {
        let first = |M: &Mat| M.block(0, 0, M.nrows(), r);
        (&self.R * &first(&self.V), &self.L * &first(&self.U))
    }

    fn square_root(&self, r: usize) -> Result<StateSpace, Error> {
        let scale: Vec<f64> = self.values[..r].iter().map(|s| 1.0 / s.sqrt()).collect();
        let scale = Mat::diag(&scale);
        let (T, W) = self.directions(r);
        self.project(&(&T * &scale), &(&W * &scale).t())
    }

    /// Orthonormal bases of the same subspaces; the coordinates are not balanced, the response is the same.
    fn balancing_free(&self, r: usize) -> Result<StateSpace, Error> {
        let (T, W) = self.directions(r);
        let X = linalg::qr(&T).with_step("balancing-free projection")?.Q;
        let Y = linalg::qr(&W).with_step("balancing-free projection")?.Q;
        let W = linalg::solve(&(&Y.t() * &X), &Y.t()).with_step("balancing-free projection")?;
        self.project(&X, &W)
    }

    fn project(&self, T: &Mat, W: &Mat) -> Result<StateSpace, Error> {
        let g = &self.system;
        Ok(StateSpace::new(W * &(&g.A * T), W * &g.B, &g.C * T, g.D.clone(), g.timebase)?)
    }
}

/// Returns the first r states, the others at their equilibrium: x2 = -inv(A22) (A21 x1 + B2 u), A22 - I where
/// sampled.
fn residualise(g: &StateSpace, r: usize) -> Result<StateSpace, Error> {
    let (n, m, p) = (g.order(), g.inputs(), g.outputs());
    let s = n - r;
    if s == 0 {
        return Ok(g.clone());
    }
    let mut A22 = g.A.block(r, r, s, s);
    if g.timebase != Timebase::Continuous {
        A22 = &A22 - &Mat::eye(s);
    }
    let driven = g.A.block(r, 0, s, r).hstack(&g.B.block(r, 0, s, m));
    let held = linalg::solve(&A22, &driven).with_step("singular perturbation")?;
    let (X, U) = (held.block(0, 0, s, r), held.block(0, r, s, m));
    let (A12, C2) = (g.A.block(0, r, r, s), g.C.block(0, r, p, s));
    Ok(StateSpace::new(
        &g.A.block(0, 0, r, r) - &(&A12 * &X),
        &g.B.block(0, 0, r, m) - &(&A12 * &U),
        &g.C.block(0, 0, p, r) - &(&C2 * &X),
        &g.D - &(&C2 * &U),
        g.timebase,
    )?)
}

/// Returns the balanced reduction of any system: integrators, poles on the border and unstable poles are kept, the stable part is
/// reduced.
///
/// The H-infinity error is at most twice the sum of the Hankel values dropped. O(n^3).
///
/// # Errors
/// [`Error::Order`] if fewer states are asked for than must be kept, [`Error::Range`], [`Error::Matrix`].
pub fn balred(g: &StateSpace, order: Order, method: Method) -> Result<Reduction, Error> {
    let parts = split_stable(g)?;
    let untouched = parts.second.order();
    let balanced = BalancedSystem::of(&parts.first)?;
    let hankel = balanced.hankel().to_vec();
    let (kept, mut warnings) = choose(&hankel, order, untouched)?;
    let reduced = balanced.reduce(kept, method)?;
    let (measured_error, grid) = error_norm(&parts.first, &reduced)?;
    warnings.extend(grid);
    let system = parallel(&reduced, &parts.second)?;
    Ok(Reduction {
        system,
        bound: Some(bound(&hankel, kept)),
        measured_error,
        hankel,
        kept,
        untouched,
        warnings,
    })
}
