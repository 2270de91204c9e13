//! Solutions with `s^2 M + s D + K` of a large structure at complex frequencies.
//!
//! For `s` in the right half plane the imaginary part of the matrix is definite if the structure is damped, so its factors need no
//! pivoting (Higham, Math. Comp. 67 (1998) 1591). A solution is corrected until its residual is at rounding.

use super::analysis::Analysis;
use super::matrix::{Entry, Sparse};
use super::modes::ProgressObserver;
use super::numeric::{FactorRequest, Factors, Term, factorise};
use crate::error::Error;
use crate::mat::{C64, CMat, Mat};
use crate::tolerance::{SHIFTED_CORRECTIONS, SHIFTED_RESIDUAL, SHIFTED_RESIDUAL_LARGEST};

/// The matrices `M`, `D` and `K` of a structure, symmetric, both halves stored, with the pattern of their sum analysed.
#[derive(Debug)]
pub struct QuadraticPencil<'a> {
    /// Mass matrix.
    pub M: &'a Sparse,
    /// Damping matrix.
    pub D: &'a Sparse,
    /// Stiffness matrix.
    pub K: &'a Sparse,
    analysis: Analysis,
}

impl<'a> QuadraticPencil<'a> {
    /// Analyses the pattern.
    ///
    /// # Errors
    /// [`Error::NotSquare`], [`Error::NotSymmetric`], [`Error::Shape`] or [`Error::TooLarge`].
    pub fn of(M: &'a Sparse, D: &'a Sparse, K: &'a Sparse) -> Result<Self, Error> {
        let n = K.nrows();
        for (what, matrix) in [("the mass matrix", M), ("the damping matrix", D), ("the stiffness matrix", K)]
        {
            matrix.check_symmetric(what)?;
            let (rows, cols) = matrix.shape();
            if rows != n {
                return Err(Error::Shape { what, rows, cols, needed_rows: n, needed_cols: n });
            }
        }
        let others: Vec<Entry> = M.entries().chain(D.entries()).map(|e| Entry { value: 0.0, ..e }).collect();
        let analysis = Analysis::of(&K.plus(&others)?, &[])?;
        Ok(Self { M, D, K, analysis })
    }

    /// Returns what the factors look like.
    pub fn analysis(&self) -> &Analysis {
        &self.analysis
    }

    /// Factorises the matrix at a complex frequency.
    ///
    /// # Errors
    /// [`Error::Singular`] at an eigenvalue, [`Error::TooLarge`], or [`Error::Cancelled`].
    pub fn at(
        &self,
        s: C64,
        stage: &'static str,
        watch: &mut ProgressObserver,
    ) -> Result<ShiftedPencil<'_>, Error> {
        let factors = if s.im == 0.0 {
            Kind::Real(self.factorise([s.re * s.re, s.re, 1.0], stage, watch)?)
        } else {
            Kind::Complex(self.factorise([s * s, s, C64::new(1.0, 0.0)], stage, watch)?)
        };
        Ok(ShiftedPencil { pencil: self, s, factors })
    }

    fn factorise<T: super::numeric::Number>(
        &self,
        [of_mass, of_damping, of_stiffness]: [T; 3],
        stage: &'static str,
        watch: &mut ProgressObserver,
    ) -> Result<Factors<T>, Error> {
        let terms = [
            Term { factor: of_mass, matrix: self.M },
            Term { factor: of_damping, matrix: self.D },
            Term { factor: of_stiffness, matrix: self.K },
        ];
        factorise(&self.analysis, &terms, FactorRequest::Factors, stage, watch)
    }
}

#[derive(Debug)]
enum Kind {
    Real(Factors<f64>),
    Complex(Factors<C64>),
}

/// The factors of `s^2 M + s D + K` at one `s`.
#[derive(Debug)]
pub struct ShiftedPencil<'a> {
    pencil: &'a QuadraticPencil<'a>,
    s: C64,
    factors: Kind,
}

impl ShiftedPencil<'_> {
    /// Returns the solutions for the given right-hand sides.
    ///
    /// # Errors
    /// [`Error::Singular`] if the residual stays large, because `s` is nearly an eigenvalue.
    pub fn solve(&self, B: &CMat) -> Result<CMat, Error> {
        let mut X = self.raw(B);
        let size = B.norm_fro();
        let mut last = f64::INFINITY;
        for _ in 0..SHIFTED_CORRECTIONS {
            let residual = B - &self.times(&X);
            let relative = if size > 0.0 { residual.norm_fro() / size } else { 0.0 };
            if relative <= SHIFTED_RESIDUAL || relative >= 0.5 * last {
                last = last.min(relative);
                break;
            }
            last = relative;
            X += &self.raw(&residual);
        }
        if last.is_nan() || last > SHIFTED_RESIDUAL_LARGEST {
            return Err(Error::Singular {
                what: "the structure at a complex frequency",
                rcond: f64::EPSILON / last,
            });
        }
        Ok(X)
    }

    fn raw(&self, B: &CMat) -> CMat {
        let (n, columns) = B.shape();
        let mut X = B.clone();
        if n == 0 || columns == 0 {
            return X;
        }
        match &self.factors {
            Kind::Complex(factors) => factors.solve(&self.pencil.analysis, X.as_mut_slice(), columns),
            Kind::Real(factors) => {
                let mut parts = B.map(|b| b.re).hstack(&B.map(|b| b.im));
                factors.solve(&self.pencil.analysis, parts.as_mut_slice(), 2 * columns);
                X = join_parts(&parts.block(0, 0, n, columns), &parts.block(0, columns, n, columns));
            }
        }
        X
    }

    /// The product `(s^2 M + s D + K) X`.
    fn times(&self, X: &CMat) -> CMat {
        let (re, im) = (X.map(|x| x.re), X.map(|x| x.im));
        let mut out = CMat::zeros(X.nrows(), X.ncols());
        let terms =
            [(self.s * self.s, self.pencil.M), (self.s, self.pencil.D), (C64::new(1.0, 0.0), self.pencil.K)];
        for (factor, matrix) in terms {
            out += &join_parts(&matrix.times(&re), &matrix.times(&im)).scale(factor);
        }
        out
    }
}

fn join_parts(re: &Mat, im: &Mat) -> CMat {
    CMat::from_fn(re.nrows(), re.ncols(), |i, j| C64::new(re[(i, j)], im[(i, j)]))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use std::ops::ControlFlow;

    #[test]
    fn solutions_at_complex_frequencies_satisfy_their_equation() {
        let n = 150;
        let chain = |value: f64, coupling: f64| {
            let mut list: Vec<Entry> =
                (0..n).map(|i| Entry { row: i, col: i, value: value * (1.0 + i as f64 / 40.0) }).collect();
            for i in 1..n {
                for j in [i - 1, i / 2].into_iter().filter(|&j| j < i) {
                    list.extend([(i, j), (j, i)].map(|(row, col)| Entry { row, col, value: coupling }));
                }
            }
            Sparse::from_entries(n, n, &list).unwrap()
        };
        let (M, D, K) = (chain(1.0, 0.0), chain(0.01, 0.0), chain(900.0, -90.0));
        let pencil = QuadraticPencil::of(&M, &D, &K).unwrap();
        let B = Mat::from_fn(n, 2, |i, j| ((i * 5 + 3 * j) % 7) as f64 - 3.0).to_complex();
        for s in [C64::new(0.15, 31.0), C64::new(0.001, 40.0), C64::new(3.0, 0.0), C64::new(0.0, 25.0)] {
            let shifted = pencil.at(s, "factors", &mut |_| ControlFlow::Continue(())).unwrap();
            let X = shifted.solve(&B).unwrap();
            assert!((&B - &shifted.times(&X)).norm_fro() < 1e-12 * B.norm_fro(), "{s}");
        }
        let answer = pencil.at(C64::new(1.0, 1.0), "factors", &mut |_| ControlFlow::Break(()));
        assert!(matches!(answer, Err(Error::Cancelled { .. })));
    }
}
