//! The generalised plant in the normal form of H-infinity control: its two equations at a bound, and the central controller.

use counterpoise_linalg::{
    Mat, Outcome as Solution, Reason, care_g, inverse, singular_values, svd, sym_eigen, sym_eigenvalues,
};
use counterpoise_lti::{StateSpace, Timebase};

use crate::Error;
use crate::generalised_plant::{Blocks, GeneralisedPlant, absorb_direct_path};
use crate::tolerance::{HINF_INDEFINITE, HINF_SLOWEST};

/// The outcome of a bound.
#[derive(Clone, Copy)]
pub(crate) enum Attempt {
    /// ln rho(XY) - 2 ln g, negative if the bound is reachable.
    Margin(f64),
    /// X or Y does not exist, or is indefinite: the bound is not reachable.
    Unreachable,
    /// An equation could not be solved for another reason, which says nothing about the bound.
    Undecided,
}

/// The plant in the form D12 = \[0; I\], D21 = \[0 I\], by rotations of w and z and scalings of u and y.
pub(crate) struct NormalForm {
    P: Blocks,
    /// u = U u_normal.
    U: Mat,
    /// y_normal = Y y.
    Y: Mat,
}

impl NormalForm {
    pub(crate) fn of(plant: &GeneralisedPlant) -> Result<Self, Error> {
        let P = plant.blocks();
        let (z, U) = rotation(&P.D12)?;
        let (w, Y) = rotation(&P.D21.t())?;
        let Y = Y.t();
        let wt = w.t();
        Ok(Self {
            P: Blocks {
                B1: &P.B1 * &wt,
                B2: &P.B2 * &U,
                C1: &z * &P.C1,
                C2: &Y * &P.C2,
                D11: &z * &(&P.D11 * &wt),
                D12: &z * &(&P.D12 * &U),
                D21: &Y * &(&P.D21 * &wt),
                D22: P.D22,
                A: P.A,
                scale: P.scale,
                origins: P.origins,
            },
            U,
            Y,
        })
    }

    /// max(|[D1111 D1112]|, |[D1111; D1121]|): below it no bound can be reached.
    pub(crate) fn lower_bound(&self) -> Result<f64, Error> {
        let (z1, w1) = self.split();
        let D = &self.P.D11;
        let largest = |M: Mat| -> Result<f64, Error> {
            Ok(if M.norm_max() == 0.0 { 0.0 } else { singular_values(&M)?[0] })
        };
        Ok(largest(D.block(0, 0, z1, D.ncols()))?.max(largest(D.block(0, 0, D.nrows(), w1))?))
    }

    /// A bound to start from where D11 gives none.
    pub(crate) fn initial_bound(&self) -> f64 {
        let P = &self.P;
        // A plant of integrators has no rate but those of the two equations, of control and of measurement.
        let rate = (P.B2.norm_fro() * P.C1.norm_fro()).max(P.B1.norm_fro() * P.C2.norm_fro());
        let slowest = (HINF_SLOWEST * rate).max(f64::MIN_POSITIVE);
        let size = (P.C1.norm_fro() * P.B1.norm_fro() / P.A.norm_fro().max(slowest)).sqrt();
        if size > 0.0 && size.is_finite() { size } else { 1.0 }
    }

    /// Rows of z and columns of w that neither control nor measurement noise touches.
    fn split(&self) -> (usize, usize) {
        (self.P.D12.nrows() - self.P.D12.ncols(), self.P.D21.ncols() - self.P.D21.nrows())
    }

    /// Solves both equations at a bound.
    pub(crate) fn attempt(&self, bound: f64) -> Result<Attempt, Error> {
        let (X, Y) = match (self.regulator(bound)?, self.filter(bound)?) {
            (EquationOutcome::Found { X, .. }, EquationOutcome::Found { X: Y, .. }) => (X, Y),
            (EquationOutcome::Absent, _) | (_, EquationOutcome::Absent) => return Ok(Attempt::Unreachable),
            _ => return Ok(Attempt::Undecided),
        };
        Ok(Attempt::Margin(spectral_radius(&(&Y * &X))?.ln() - 2.0 * bound.ln()))
    }

    /// The central controller at a bound; `None` if there is none.
    pub(crate) fn central_controller(&self, bound: f64) -> Result<Option<StateSpace>, Error> {
        let EquationOutcome::Found { X, gain: F } = self.regulator(bound)? else { return Ok(None) };
        let EquationOutcome::Found { X: Y, gain: L } = self.filter(bound)? else { return Ok(None) };
        let Z = &Mat::eye(X.nrows()) - &(&Y * &X).scale(1.0 / (bound * bound));
        let Ok(Z) = inverse(&Z) else { return Ok(None) };
        self.assemble(bound, &F, &L.t(), &Z)
    }

    /// X and F = -R^-1 (D1.'C1 + B'X), on all inputs.
    fn regulator(&self, bound: f64) -> Result<EquationOutcome, Error> {
        let P = &self.P;
        let (B, D) = (P.B1.hstack(&P.B2), P.D11.hstack(&P.D12));
        let equation = IndefiniteEquation { A: &P.A, B: &B, C: &P.C1, D: &D, disturbed: P.B1.ncols() };
        equation.solve(bound)
    }

    /// Y and the transpose of L = -(B1 D.1' + Y C') R^-1, on all outputs: the same problem transposed.
    fn filter(&self, bound: f64) -> Result<EquationOutcome, Error> {
        let P = &self.P;
        let (C, D) = (P.C1.vstack(&P.C2), P.D11.vstack(&P.D21));
        let (A, B, C1, D) = (P.A.t(), C.t(), P.B1.t(), D.t());
        let equation = IndefiniteEquation { A: &A, B: &B, C: &C1, D: &D, disturbed: P.C1.nrows() };
        equation.solve(bound)
    }

    fn assemble(&self, bound: f64, F: &Mat, L: &Mat, Z: &Mat) -> Result<Option<StateSpace>, Error> {
        let P = &self.P;
        let ((z1, w1), n) = (self.split(), P.A.nrows());
        let (m2, p2) = (P.B2.ncols(), P.C2.nrows());
        let Some(D) = DirectPaths::of(&P.D11, z1, w1, bound)? else { return Ok(None) };
        let (F12, F2) = (F.block(w1, 0, p2, n), F.block(w1 + p2, 0, m2, n));
        let (L12, L2) = (L.block(0, z1, n, m2), L.block(0, z1 + m2, n, p2));
        let B = P.B1.hstack(&P.B2);
        let into = Z * &(&(&P.B2 + &L12) * &D.D12);
        let seen = -(&D.D21 * &(&P.C2 + &F12));
        let B1 = &(&into * &(&inverse(&D.D12)? * &D.D11)) - &(Z * &L2);
        let shaped = &inverse(&D.D21)? * &seen;
        let C1 = &F2 + &(&D.D11 * &shaped);
        let A = &(&P.A + &(&B * F)) + &(&B1 * &shaped);
        let K = StateSpace::new(
            A,
            &B1 * &self.Y,
            &self.U * &C1,
            &self.U * &(&D.D11 * &self.Y),
            Timebase::Continuous,
        );
        match K {
            Ok(K) => Ok(Some(absorb_direct_path(P.convert_to_plant_states(K), &P.D22)?)),
            Err(_) => Ok(None),
        }
    }
}

/// The direct paths of the central controller.
struct DirectPaths {
    D11: Mat,
    D12: Mat,
    D21: Mat,
}

impl DirectPaths {
    fn of(D11: &Mat, z1: usize, w1: usize, bound: f64) -> Result<Option<Self>, Error> {
        let (m2, p2) = (D11.nrows() - z1, D11.ncols() - w1);
        let (D1111, D1112) = (D11.block(0, 0, z1, w1), D11.block(0, w1, z1, p2));
        let (D1121, D1122) = (D11.block(z1, 0, m2, w1), D11.block(z1, w1, m2, p2));
        let square = bound * bound;
        let left = &Mat::eye(z1).scale(square) - &(&D1111 * &D1111.t());
        let right = &Mat::eye(w1).scale(square) - &(&D1111.t() * &D1111);
        let (Some(left), Some(right)) = (invert(&left), invert(&right)) else { return Ok(None) };
        let first = -&(&(&D1121 * &(&D1111.t() * &(&left * &D1112))) + &D1122);
        let second = &Mat::eye(m2) - &(&D1121 * &(&right * &D1121.t()));
        let third = &Mat::eye(p2) - &(&D1112.t() * &(&left * &D1112));
        let (Some(D12), Some(D21)) = (root(&second)?, root(&third)?) else { return Ok(None) };
        Ok(Some(Self { D11: first, D12, D21 }))
    }
}

fn invert(M: &Mat) -> Option<Mat> {
    if M.nrows() == 0 { Some(M.clone()) } else { inverse(M).ok() }
}

/// The symmetric root of a positive definite matrix; `None` for another.
fn root(M: &Mat) -> Result<Option<Mat>, Error> {
    let (values, V) = sym_eigen(&M.symmetric_part())?;
    if values.iter().any(|value| *value <= 0.0) {
        return Ok(None);
    }
    let roots: Vec<f64> = values.iter().map(|value| value.sqrt()).collect();
    Ok(Some(&V * &(&Mat::diag(&roots) * &V.t())))
}

/// The outcome of one of the two equations.
enum EquationOutcome {
    /// The solution, and F = -R^-1 (D'C + B'X).
    Found { X: Mat, gain: Mat },
    /// There is certainly no positive semidefinite stabilising solution.
    Absent,
    /// None was found, for a reason that says nothing about the bound.
    Undecided,
}

/// A'X + XA + C'C - (XB + C'D) R^-1 (B'X + D'C) = 0 with R = D'D - diag(g^2 I, 0).
struct IndefiniteEquation<'a> {
    A: &'a Mat,
    B: &'a Mat,
    C: &'a Mat,
    D: &'a Mat,
    /// Number of inputs, the first ones, that disturb.
    disturbed: usize,
}

impl IndefiniteEquation<'_> {
    /// The stabilising solution at a bound g.
    fn solve(&self, bound: f64) -> Result<EquationOutcome, Error> {
        let Self { A, B, C, D, disturbed } = *self;
        let mut R = &D.t() * D;
        for i in 0..disturbed {
            R[(i, i)] -= bound * bound;
        }
        let Ok(R_inverse) = inverse(&R) else { return Ok(EquationOutcome::Undecided) };
        let cross = &D.t() * C;
        let folded = A - &(B * &(&R_inverse * &cross));
        let G = (B * &(&R_inverse * &B.t())).symmetric_part();
        let Q = (&(&C.t() * C) - &(&cross.t() * &(&R_inverse * &cross))).symmetric_part();
        let solution = match care_g(&folded, &G, &Q)? {
            Solution::Solved(solution) => solution,
            Solution::Infeasible(Reason::OnBoundary { .. } | Reason::NoGraph) => {
                return Ok(EquationOutcome::Absent);
            }
            Solution::Infeasible(_) => return Ok(EquationOutcome::Undecided),
        };
        // What is negligible beside A in A - GX is rounding, whatever its sign.
        let negligible = HINF_INDEFINITE * folded.norm_fro() / G.norm_fro().max(f64::MIN_POSITIVE);
        let values = sym_eigenvalues(&solution.X.symmetric_part())?;
        let largest = values.iter().copied().fold(0.0, |a: f64, b| a.max(b.abs()));
        if values.iter().any(|value| *value < -(HINF_INDEFINITE * largest).max(negligible)) {
            return Ok(EquationOutcome::Absent);
        }
        let gain = -&(&R_inverse * &(&cross + &(&B.t() * &solution.X)));
        Ok(EquationOutcome::Found { X: solution.X, gain })
    }
}

/// z (orthogonal) and U with z D U = \[0; I\], for D of full column rank.
fn rotation(D: &Mat) -> Result<(Mat, Mat), Error> {
    let (rows, columns) = D.shape();
    let parts = svd(D)?;
    let full = full_basis(&parts.U, rows)?;
    let order: Vec<usize> = (columns..rows).chain(0..columns).collect();
    let all: Vec<usize> = (0..rows).collect();
    let z = full.select(&all, &order).t();
    let inverse: Vec<f64> = parts.s.iter().map(|value| 1.0 / value).collect();
    Ok((z, &parts.V * &Mat::diag(&inverse)))
}

/// The columns of U followed by an orthonormal basis of what they leave out.
fn full_basis(U: &Mat, rows: usize) -> Result<Mat, Error> {
    if U.ncols() == rows {
        return Ok(U.clone());
    }
    let columns = U.ncols();
    let rest = &Mat::eye(rows) - &(U * &U.t());
    let complement = svd(&rest)?.U;
    Ok(U.hstack(&complement.block(0, 0, rows, rows - columns)))
}

fn spectral_radius(M: &Mat) -> Result<f64, Error> {
    let values = counterpoise_linalg::eigenvalues(M)?;
    Ok(values.iter().map(|value| value.norm()).fold(0.0, f64::max))
}
