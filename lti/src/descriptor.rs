//! Descriptor systems, brought to state space: circuits, constrained mechanisms and other models whose E is singular.

use crate::error::OperationContext;
use crate::tolerance::{DESCRIPTOR_SWEEPS, IMPROPER};
use crate::tracked_matrix::{Pivot, TrackedMatrix, eliminate, solve_pivots};
use crate::{Error, Mat, StateSpace};
use counterpoise_linalg as linalg;

/// A system with an E that may be singular,
///
/// ```text
///     E x' (or E x[k+1]) = A x + B u        E, A: n x n, B: n x m
///     y                  = C x + D u        C: p x n, D: p x m
/// ```
///
/// The pencil s E - A must be regular (its determinant is not zero for all s).
#[derive(Debug, Clone, PartialEq)]
pub struct Descriptor {
    /// Multiplies the derivative, n x n.
    pub E: Mat,
    /// The other matrices and the timebase.
    pub system: StateSpace,
}

/// A descriptor system without its infinite modes: `y = system u + derivatives[0] u' + derivatives[1] u'' + ...`
/// (where sampled: u\[k+1\], u\[k+2\], ...).
#[derive(Debug, Clone, PartialEq)]
pub struct ReducedDescriptor {
    /// The finite modes and the direct path.
    pub system: StateSpace,
    /// Contributions of the input's derivatives, each p x m; empty if the system is proper.
    pub derivatives: Vec<Mat>,
    /// Number of rounds of constraints that were eliminated: zero if E is invertible, one for an index of one.
    pub rounds: usize,
}

impl Descriptor {
    /// Returns the system with the given matrices.
    ///
    /// # Errors
    /// [`Error::Shape`] if E is not of the shape of A, [`Error::NotFinite`].
    pub fn new(E: Mat, system: StateSpace) -> Result<Self, Error> {
        if E.shape() != system.A.shape() {
            return Err(Error::Shape { what: "E", found: E.shape(), expected: system.A.shape() });
        }
        if !E.is_finite() {
            return Err(Error::NotFinite { what: "E" });
        }
        Ok(Self { E, system })
    }

    /// Returns the finite modes as a state-space system, and what the input's derivatives contribute.
    ///
    /// Scaled by powers of two, then in rounds: E is brought to echelon form; rows without E are constraints
    /// `0 = R x + b u + b1 u' ...`; as many variables as there are constraints are expressed by the others and vanish;
    /// until E is invertible. Complete pivoting throughout, and an entry is zero if it cancelled to 1e-11 of what
    /// was summed to it, so that ranks are decided entry by entry: time constants eleven decades apart do not blur
    /// them as they blur singular values. O(n^3) a round.
    ///
    /// # Errors
    /// [`Error::SingularPencil`] if the constraints do not determine the variables: there is no transfer function.
    pub fn reduce_index(&self) -> Result<ReducedDescriptor, Error> {
        let (mut pencil, rate) = Pencil::scale_system(self);
        let mut rounds = 0;
        while pencil.round()? {
            rounds += 1;
        }
        pencil.finish(self, rate, rounds)
    }

    /// Returns the proper system with this transfer function.
    ///
    /// # Errors
    /// As [`Descriptor::reduce_index`]; [`Error::Improper`] if an output contains a derivative of an input.
    pub fn to_state_space(&self) -> Result<StateSpace, Error> {
        let reduced = self.reduce_index()?;
        for (k, gain) in reduced.derivatives.iter().enumerate().rev() {
            for (input, output) in (0..gain.ncols()).flat_map(|j| (0..gain.nrows()).map(move |i| (j, i))) {
                if gain[(output, input)] != 0.0 {
                    return Err(Error::Improper { output, input, derivative: k + 1 });
                }
            }
        }
        Ok(reduced.system)
    }
}

/// The rest of the system: E x' = A x + B\[0\] u + B\[1\] u' + ..., y = C x + D\[0\] u + D\[1\] u' + ...
struct Pencil {
    E: TrackedMatrix,
    A: TrackedMatrix,
    B: Vec<TrackedMatrix>,
    C: TrackedMatrix,
    D: Vec<TrackedMatrix>,
}

impl Pencil {
    /// Returns rows and columns of like size, time in units of the returned rate.
    fn scale_system(g: &Descriptor) -> (Self, f64) {
        let (E, A) = (&g.E, &g.system.A);
        let rate = match (mean_log(A), mean_log(E)) {
            (Some(a), Some(e)) => (a - e).round().exp2(),
            _ => 1.0,
        };
        let sizes = Mat::from_fn(A.nrows(), A.ncols(), |i, j| A[(i, j)].abs() + rate * E[(i, j)].abs());
        let (r, c) = equilibrate(sizes);
        let rows = |M: &Mat| Mat::from_fn(M.nrows(), M.ncols(), |i, j| r[i] * M[(i, j)]);
        let cols = |M: &Mat| Mat::from_fn(M.nrows(), M.ncols(), |i, j| M[(i, j)] * c[j]);
        let pencil = Self {
            E: TrackedMatrix::of(cols(&rows(&E.scale(rate)))),
            A: TrackedMatrix::of(cols(&rows(A))),
            B: vec![TrackedMatrix::of(rows(&g.system.B))],
            C: TrackedMatrix::of(cols(&g.system.C)),
            D: vec![TrackedMatrix::of(g.system.D.clone())],
        };
        (pencil, rate)
    }

    /// Carries out one round of the reduction; returns `false` if E is invertible, so that nothing is left to do.
    fn round(&mut self) -> Result<bool, Error> {
        let n = self.A.value.nrows();
        let (mut free, mut cols): (Vec<usize>, Vec<usize>) = ((0..n).collect(), (0..n).collect());
        let mut others: Vec<&mut TrackedMatrix> = vec![&mut self.A];
        others.extend(self.B.iter_mut());
        eliminate(&mut self.E, &mut others, &mut free, &mut cols);
        if free.is_empty() {
            return Ok(false);
        }
        free.sort_unstable();
        let pivots = self.solve_constraints(&free)?;
        self.substitute(&free, &pivots)?;
        Ok(true)
    }

    /// Returns which variable each constraint determines: those without E first, a derivative only where it
    /// must be.
    fn solve_constraints(&mut self, free: &[usize]) -> Result<Vec<Pivot>, Error> {
        let (mut static_, mut dynamic): (Vec<usize>, Vec<usize>) =
            (0..self.A.value.ncols()).partition(|&j| self.E.column_is_zero(j));
        let mut rows = free.to_vec();
        let mut others: Vec<&mut TrackedMatrix> = self.B.iter_mut().collect();
        let mut pivots = eliminate(&mut self.A, &mut others, &mut rows, &mut static_);
        pivots.extend(eliminate(&mut self.A, &mut others, &mut rows, &mut dynamic));
        if rows.is_empty() { Ok(pivots) } else { Err(Error::SingularPencil { equations: rows.len() }) }
    }

    /// Expresses the pivots' variables by the others, x_p = -X x - Y\[0\] u - Y\[1\] u' ..., wherever they stand.
    fn substitute(&mut self, free: &[usize], pivots: &[Pivot]) -> Result<(), Error> {
        let n = self.A.value.nrows();
        let gone: Vec<usize> = pivots.iter().map(|pivot| pivot.column).collect();
        let rest: Vec<usize> = (0..n).filter(|j| !gone.contains(j)).collect();
        let rows: Vec<usize> = (0..n).filter(|i| free.binary_search(i).is_err()).collect();
        let all = |M: &TrackedMatrix| (0..M.value.nrows()).collect::<Vec<_>>();
        let right = self.A.value.select(&all(&self.A), &rest);
        let X = solve_pivots(&self.A.value, pivots, &right).with_operation("index reduction")?;
        let mut inputs = Vec::new();
        for b in &self.B {
            inputs.push(solve_pivots(&self.A.value, pivots, &b.value).with_operation("index reduction")?);
        }
        let (Ep, Ap) = (self.E.select(&rows, &gone), self.A.select(&rows, &gone));
        let outputs = all(&self.C);
        let Cp = self.C.select(&outputs, &gone);
        self.E = self.E.select(&rows, &rest).minus_product(&Ep, &X);
        self.A = self.A.select(&rows, &rest).minus_product(&Ap, &X);
        self.C = self.C.select(&outputs, &rest).minus_product(&Cp, &X);
        let ports: Vec<usize> = (0..self.B[0].value.ncols()).collect();
        self.B = self.B.iter().map(|b| b.select(&rows, &ports)).collect();
        for (k, Y) in inputs.iter().enumerate() {
            self.add_input(k, &Ap, Y);
            self.add_input(k + 1, &Ep, &-Y);
            self.add_output(k, &Cp, Y);
        }
        Ok(())
    }

    /// B\[k\] -= left right; a derivative of the input that appears for the first time is appended.
    fn add_input(&mut self, k: usize, left: &TrackedMatrix, right: &Mat) {
        let product = TrackedMatrix::of(Mat::zeros(left.value.nrows(), right.ncols()));
        if k == self.B.len() {
            self.B.push(product);
        }
        self.B[k] = self.B[k].minus_product(left, right);
    }

    /// D\[k\] -= left right, as [`Pencil::add_input`].
    fn add_output(&mut self, k: usize, left: &TrackedMatrix, right: &Mat) {
        if k == self.D.len() {
            self.D.push(TrackedMatrix::of(Mat::zeros(left.value.nrows(), right.ncols())));
        }
        self.D[k] = self.D[k].minus_product(left, right);
    }

    /// Divides by E and moves the derivatives of the input to the output: x = z + M u^(k-1) takes u^(k) out of z'.
    fn finish(mut self, g: &Descriptor, rate: f64, rounds: usize) -> Result<ReducedDescriptor, Error> {
        let by_E = |M: &Mat| {
            if M.nrows() == 0 {
                Ok(M.clone())
            } else {
                linalg::solve(&self.E.value, M).with_operation("index reduction")
            }
        };
        let A = TrackedMatrix::of(by_E(&self.A.value)?);
        let mut B = Vec::new();
        for b in &self.B {
            B.push(TrackedMatrix::of(by_E(&b.value)?));
        }
        while B.len() > 1 {
            let k = B.len() - 1;
            let M = -&B.remove(k).value;
            B[k - 1] = B[k - 1].minus_product(&A, &M);
            let C = self.C.clone();
            self.add_output(k - 1, &C, &M);
        }
        let system = StateSpace::new(
            A.value.scale(rate),
            B[0].value.scale(rate),
            self.C.value,
            self.D[0].value.clone(),
            g.system.timebase,
        )?;
        Ok(ReducedDescriptor { system, derivatives: derivatives(&self.D, rate), rounds })
    }
}

/// Returns the gains of the derivatives in units of time, up to the last that is not rounding error.
fn derivatives(D: &[TrackedMatrix], rate: f64) -> Vec<Mat> {
    let largest = D.iter().map(|gain| gain.value.norm_max()).fold(0.0, f64::max);
    let clean = |value: f64| if value.abs() > IMPROPER * IMPROPER * largest { value } else { 0.0 };
    let mut found: Vec<Mat> =
        (1..D.len()).map(|k| D[k].value.map(|value| clean(value) / rate.powi(k as i32))).collect();
    while found.last().is_some_and(|gain| gain.norm_max() == 0.0) {
        found.pop();
    }
    found
}

/// Returns the mean binary logarithm of the entries that are not zero.
fn mean_log(M: &Mat) -> Option<f64> {
    let logs: Vec<f64> = M.as_slice().iter().filter(|&&x| x != 0.0).map(|x| x.abs().log2()).collect();
    (!logs.is_empty()).then(|| logs.iter().sum::<f64>() / logs.len() as f64)
}

/// Powers of two for rows and columns that bring the largest entry of each near one (Ruiz 2001).
fn equilibrate(mut M: Mat) -> (Vec<f64>, Vec<f64>) {
    let n = M.nrows();
    let (mut r, mut c) = (vec![1.0; n], vec![1.0; n]);
    let factor = |largest: f64| if largest > 0.0 { (-0.5 * largest.log2()).round().exp2() } else { 1.0 };
    for _ in 0..DESCRIPTOR_SWEEPS {
        let rows: Vec<f64> = (0..n).map(|i| factor((0..n).map(|j| M[(i, j)]).fold(0.0, f64::max))).collect();
        let cols: Vec<f64> =
            (0..n).map(|j| factor(M.column(j).iter().copied().fold(0.0, f64::max))).collect();
        for j in 0..n {
            M.column_mut(j).iter_mut().zip(&rows).for_each(|(entry, f)| *entry *= f * cols[j]);
            (r[j], c[j]) = (r[j] * rows[j], c[j] * cols[j]);
        }
    }
    (r, c)
}
