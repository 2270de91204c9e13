//! Connections of systems: in series, in parallel, in feedback, as linear fractional transformations.
//!
//! The sign is in the name: [`feedback`] is negative, [`lft`] positive. Every connection is exact in its states: the
//! states of the result are those of its parts, in the order in which they are named.

use crate::tolerance::LOOP_RCOND;
use crate::{Error, Mat, StateSpace, Timebase};
use counterpoise_linalg as linalg;

/// Returns `y = h (g u)`: h after g, with the states [g; h].
///
/// # Errors
/// [`Error::Timebase`] for different timebases, [`Error::Shape`] if g has not as many outputs as h has inputs.
pub fn series(g: &StateSpace, h: &StateSpace) -> Result<StateSpace, Error> {
    let timebase = same_timebase("series", g, h)?;
    fits("series: outputs of the first, inputs of the second", g.outputs(), h.inputs())?;
    let upper = Mat::zeros(g.order(), h.order());
    let into = &h.B * &g.C;
    let A = Mat::from_blocks(&[&[&g.A, &upper], &[&into, &h.A]]);
    let B = g.B.vstack(&(&h.B * &g.D));
    let C = (&h.D * &g.C).hstack(&h.C);
    StateSpace::new(A, B, C, &h.D * &g.D, timebase)
}

/// Returns `y = g u + h u`, with the states [g; h].
///
/// # Errors
/// [`Error::Timebase`] for different timebases, [`Error::Shape`] if inputs or outputs differ in number.
pub fn parallel(g: &StateSpace, h: &StateSpace) -> Result<StateSpace, Error> {
    let timebase = same_timebase("parallel", g, h)?;
    fits("parallel: inputs", g.inputs(), h.inputs())?;
    fits("parallel: outputs", g.outputs(), h.outputs())?;
    StateSpace::new(g.A.block_diag(&h.A), g.B.vstack(&h.B), g.C.hstack(&h.C), &g.D + &h.D, timebase)
}

/// Returns `[y1; y2] = diag(g, h) [u1; u2]`: both side by side.
///
/// # Errors
/// [`Error::Timebase`] for different timebases.
pub fn append(g: &StateSpace, h: &StateSpace) -> Result<StateSpace, Error> {
    let timebase = same_timebase("append", g, h)?;
    StateSpace::new(
        g.A.block_diag(&h.A),
        g.B.block_diag(&h.B),
        g.C.block_diag(&h.C),
        g.D.block_diag(&h.D),
        timebase,
    )
}

/// Closes a loop of negative feedback
///
/// ```text
///   r --->o---> l ---+---> y         y = l (r - h y)
///        -^          |
///         +---- h <--+
/// ```
///
/// from r to y, with the states [l; h].
///
/// # Errors
/// [`Error::Timebase`], [`Error::Shape`], and [`Error::AlgebraicLoop`] if I + Dl Dh is singular.
pub fn feedback(l: &StateSpace, h: &StateSpace) -> Result<StateSpace, Error> {
    same_timebase("feedback", l, h)?;
    fits("feedback: outputs of the path, inputs of the return", l.outputs(), h.inputs())?;
    fits("feedback: outputs of the return, inputs of the path", h.outputs(), l.inputs())?;
    let P = StateSpace {
        A: l.A.clone(),
        B: l.B.hstack(&-&l.B),
        C: l.C.vstack(&l.C),
        D: Mat::from_blocks(&[&[&l.D, &-&l.D], &[&l.D, &-&l.D]]),
        timebase: l.timebase,
    };
    lft(&P, h)
}

/// Returns the lower linear fractional transformation, **positive**: `u = K y`
///
/// ```text
///   w ---> |       | ---> z         P: (w, u) -> (z, y)
///          |   P   |
///   u ---> |       | ---> y         K: y -> u
///     ^---- K <-----'
/// ```
///
/// from w to z, with the states [P; K]. The last `K.outputs()` inputs of P are u, its last `K.inputs()` outputs are y.
///
/// # Errors
/// [`Error::Timebase`], [`Error::Shape`] if P is smaller than K, [`Error::AlgebraicLoop`] if I - D22 Dk is
/// singular.
pub fn lft(P: &StateSpace, K: &StateSpace) -> Result<StateSpace, Error> {
    let both = append(P, K)?;
    if P.inputs() < K.outputs() || P.outputs() < K.inputs() {
        let (found, expected) = ((P.outputs(), P.inputs()), (K.inputs(), K.outputs()));
        return Err(Error::Shape { what: "lft: the plant is smaller than the controller", found, expected });
    }
    let (nw, nz) = (P.inputs() - K.outputs(), P.outputs() - K.inputs());
    let mut F = Mat::zeros(both.inputs(), both.outputs());
    F.set_block(nw, P.outputs(), &Mat::eye(K.outputs()));
    F.set_block(P.inputs(), nz, &Mat::eye(K.inputs()));
    let mut E = Mat::zeros(both.inputs(), nw);
    E.set_block(0, 0, &Mat::eye(nw));
    let mut S = Mat::zeros(nz, both.outputs());
    S.set_block(0, 0, &Mat::eye(nz));
    interconnect("lft", &both, &Wiring { F: &F, E: &E, S: &S })
}

/// The static wiring of [`interconnect`].
#[derive(Debug, Clone, Copy)]
pub struct Wiring<'a> {
    /// From the system's outputs to its inputs, m x p.
    pub F: &'a Mat,
    /// From the external inputs to the system's inputs, m x r.
    pub E: &'a Mat,
    /// From the system's outputs to the external outputs, q x p.
    pub S: &'a Mat,
}

/// Closes static wires around a system
///
/// ```text
///   u = F y + E r,   z = S y,   y = g u          from r to z
/// ```
///
/// With N = inv(I - D F): A + B F N C, B (E + F N D E), S N C, S N D E.
///
/// # Errors
/// [`Error::Shape`] if the wires do not fit, [`Error::AlgebraicLoop`] if I - D F is singular.
pub fn interconnect(what: &'static str, g: &StateSpace, wires: &Wiring) -> Result<StateSpace, Error> {
    let Wiring { F, E, S } = *wires;
    let (m, p) = (g.inputs(), g.outputs());
    for (found, expected) in [(F.shape(), (m, p)), (E.shape(), (m, E.ncols())), (S.shape(), (S.nrows(), p))] {
        if found != expected {
            return Err(Error::Shape { what, found, expected });
        }
    }
    let N = loop_inverse(what, &(&Mat::eye(p) - &(&g.D * F)))?;
    let (NC, NDE) = (&N * &g.C, &N * &(&g.D * E));
    let A = &g.A + &(&g.B * &(F * &NC));
    let B = &g.B * &(E + &(F * &NDE));
    StateSpace::new(A, B, S * &NC, S * &NDE, g.timebase)
}

/// Returns the inverse system, from y to u: A - B inv(D) C, B inv(D), -inv(D) C, inv(D).
///
/// # Errors
/// [`Error::Shape`] if D is not square, [`Error::AlgebraicLoop`] if it is singular: then the inverse is improper.
pub fn inverse(g: &StateSpace) -> Result<StateSpace, Error> {
    fits("inverse: outputs, inputs", g.outputs(), g.inputs())?;
    let Di = loop_inverse("inverse", &g.D)?;
    let BDi = &g.B * &Di;
    StateSpace::new(&g.A - &(&BDi * &g.C), BDi, -(&Di * &g.C), Di, g.timebase)
}

impl StateSpace {
    /// Returns `y = -g u`.
    pub fn negate(&self) -> Self {
        Self { C: -&self.C, D: -&self.D, ..self.clone() }
    }

    /// Returns `y = diag(outputs) g diag(inputs) u`: a change of the signals' units.
    ///
    /// # Errors
    /// [`Error::Shape`] if the factors are not one a signal, [`Error::NotFinite`].
    pub fn scale_io(&self, outputs: &[f64], inputs: &[f64]) -> Result<Self, Error> {
        fits("scale_io: outputs", outputs.len(), self.outputs())?;
        fits("scale_io: inputs", inputs.len(), self.inputs())?;
        let (L, R) = (Mat::diag(outputs), Mat::diag(inputs));
        Self::new(self.A.clone(), &self.B * &R, &L * &self.C, &L * &(&self.D * &R), self.timebase)
    }

    /// Returns the system with its states in another order.
    pub(crate) fn permute(&self, order: &[usize]) -> Self {
        let inputs: Vec<usize> = (0..self.inputs()).collect();
        let outputs: Vec<usize> = (0..self.outputs()).collect();
        let (A, B) = (self.A.select(order, order), self.B.select(order, &inputs));
        Self { A, B, C: self.C.select(&outputs, order), D: self.D.clone(), timebase: self.timebase }
    }

    /// Returns the dual system A', C', B', D'.
    pub fn dual(&self) -> Self {
        Self { A: self.A.t(), B: self.C.t(), C: self.B.t(), D: self.D.t(), timebase: self.timebase }
    }

    /// Returns the system in the coordinates x = T z: inv(T) A T, inv(T) B, C T, for a diagonal T without
    /// zeros.
    pub fn scale_states(&self, T: &[f64]) -> Self {
        let n = self.order();
        let A = Mat::from_fn(n, n, |i, j| self.A[(i, j)] * T[j] / T[i]);
        let B = Mat::from_fn(n, self.inputs(), |i, j| self.B[(i, j)] / T[i]);
        let C = Mat::from_fn(self.outputs(), n, |i, j| self.C[(i, j)] * T[j]);
        Self { A, B, C, D: self.D.clone(), timebase: self.timebase }
    }
}

/// Returns the timebase that both systems have.
///
/// # Errors
/// [`Error::Timebase`] if they differ.
pub(crate) fn same_timebase(what: &'static str, g: &StateSpace, h: &StateSpace) -> Result<Timebase, Error> {
    if g.timebase == h.timebase {
        return Ok(g.timebase);
    }
    Err(Error::Timebase { what, found: h.timebase.to_string(), expected: g.timebase.to_string() })
}

fn fits(what: &'static str, found: usize, expected: usize) -> Result<(), Error> {
    if found == expected {
        Ok(())
    } else {
        Err(Error::Shape { what, found: (found, 1), expected: (expected, 1) })
    }
}

/// inv(M), refused where M is singular to working precision.
fn loop_inverse(what: &'static str, M: &Mat) -> Result<Mat, Error> {
    if *M == Mat::eye(M.nrows()) {
        return Ok(M.clone());
    }
    let inverse = linalg::inverse(M).map_err(|_| Error::AlgebraicLoop { what, rcond: 0.0 })?;
    let rcond = 1.0 / least_condition(what, M, &inverse)?;
    if rcond > LOOP_RCOND { Ok(inverse) } else { Err(Error::AlgebraicLoop { what, rcond }) }
}

/// Returns the smallest condition number that scaling of rows and columns can give a matrix, the spectral radius of
/// `|M^-1| |M|` (Bauer, Numerische Mathematik 5 (1963) 73): it does not depend on the units of the signals.
fn least_condition(what: &'static str, M: &Mat, inverse: &Mat) -> Result<f64, Error> {
    let sizes = |M: &Mat| Mat::from_fn(M.nrows(), M.ncols(), |i, j| M[(i, j)].abs());
    let product = &sizes(inverse) * &sizes(M);
    if product.as_slice().iter().any(|value| !value.is_finite()) {
        return Ok(f64::INFINITY);
    }
    let values = linalg::eigenvalues(&product).map_err(|_| Error::AlgebraicLoop { what, rcond: 0.0 })?;
    Ok(values.iter().map(|value| value.norm()).fold(0.0, f64::max))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::response::response_at;
    use crate::{C64, CMat};

    fn first_order(pole: f64, gain: f64, direct: f64) -> StateSpace {
        let one = |x: f64| Mat::from_rows(&[&[x]]);
        StateSpace::new(one(pole), one(gain), one(1.0), one(direct), Timebase::Continuous).unwrap()
    }

    fn at(g: &StateSpace) -> C64 {
        response_at(g, 0.7).unwrap()[(0, 0)]
    }

    #[test]
    fn connections_are_what_they_say_at_a_frequency() {
        let (g, h) = (first_order(-1.0, 2.0, 0.5), first_order(-3.0, 1.0, -0.2));
        let (a, b) = (at(&g), at(&h));
        let close =
            |found: C64, expected: C64| assert!((found - expected).norm() < 1e-14, "{found} {expected}");
        close(at(&series(&g, &h).unwrap()), a * b);
        close(at(&parallel(&g, &h).unwrap()), a + b);
        close(at(&feedback(&g, &h).unwrap()), a / (1.0 + a * b));
        close(at(&inverse(&g).unwrap()), 1.0 / a);
        close(at(&g.negate()), -a);
        close(at(&g.scale_io(&[3.0], &[2.0]).unwrap()), a * 6.0);
    }

    #[test]
    fn lft_is_p11_plus_p12_k_inv_1_minus_p22_k_p21() {
        let P = StateSpace::new(
            Mat::from_rows(&[&[-1.0, 2.0], &[0.0, -3.0]]),
            Mat::from_rows(&[&[1.0, 0.5], &[-1.0, 2.0]]),
            Mat::from_rows(&[&[1.0, 0.0], &[0.3, 1.0]]),
            Mat::from_rows(&[&[0.1, 0.2], &[0.4, -0.3]]),
            Timebase::Continuous,
        )
        .unwrap();
        let K = first_order(-2.0, 1.5, 0.7);
        let p: CMat = response_at(&P, 0.7).unwrap();
        let k = at(&K);
        let expected = p[(0, 0)] + p[(0, 1)] * k / (1.0 - p[(1, 1)] * k) * p[(1, 0)];
        assert!((at(&lft(&P, &K).unwrap()) - expected).norm() < 1e-14);
    }

    #[test]
    fn a_singular_loop_and_a_mixed_timebase_are_refused() {
        let unit = StateSpace::gain(Mat::eye(1), Timebase::Continuous).unwrap();
        let refused = feedback(&unit, &unit.negate());
        assert!(matches!(refused, Err(Error::AlgebraicLoop { .. })));
        let sampled = StateSpace::gain(Mat::eye(1), Timebase::Discrete { period_s: 0.1 }).unwrap();
        assert!(matches!(series(&unit, &sampled), Err(Error::Timebase { .. })));
    }
}
