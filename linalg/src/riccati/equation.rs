//! The residuals of the three Riccati equations, in twice the working precision.
//!
//! With a gain `K` that is right to working precision, the completed square
//! `(A-BK)'X + X(A-BK) + Q - SK - K'S' + K'RK` differs from the residual by `(K-K*)'R(K-K*)` only, so that no inverse is
//! needed in more than working precision. The same holds in discrete time.

use crate::decomposition::rcond_one;
use crate::dense::solve;
use crate::extended_precision::{ExtendedMatrix, exact_product};
use crate::long_matrix::LongMatrix;
use crate::mat::Mat;
use crate::sylvester::Kind;
use crate::tolerance::{EPS, EXTENDED_ERROR, GAIN_CORRECTIONS, GAIN_KNOWN, PRECISE_STATES, RICCATI_REGULAR};

use super::long_solution::{LinearisedEquation, PreciseEquation};
use super::newton::{Change, Equation, Evaluation};
use super::scaling::{ScaledProblem, rescale};

/// Plant and weights in scaled coordinates; `S` may be all zero.
pub(super) struct Data {
    pub(super) A: Mat,
    pub(super) B: Mat,
    pub(super) Q: Mat,
    pub(super) R: Mat,
    pub(super) S: Option<Mat>,
}

impl Data {
    /// Converts plant and weights to the units of a scaled problem.
    pub(super) fn convert(
        units: &ScaledProblem,
        A: &Mat,
        B: &Mat,
        Q: &Mat,
        R: &Mat,
        S: Option<&Mat>,
    ) -> Self {
        let (d, back, ones) = (&units.scale, units.inverse(), vec![1.0; R.nrows()]);
        Self {
            A: rescale(A, &back, d),
            B: rescale(B, &back, &ones),
            Q: rescale(Q, d, d),
            R: R.clone(),
            S: S.map(|S| rescale(S, d, &ones)),
        }
    }

    /// `K'RK - SK - K'S'`, which both equations share, and `Q`; from `RK`.
    fn weights(&self, K: &Mat, RK: &ExtendedMatrix) -> ExtendedMatrix {
        let mut sum = ExtendedMatrix::from(self.Q.clone());
        sum = sum.add(&ExtendedMatrix::from(K.t()).times(RK));
        if let Some(S) = &self.S {
            let cross = exact_product(S, K).neg();
            sum = sum.add(&cross).add(&cross.t());
        }
        sum
    }

    /// `Q + K'RK - SK - K'S'` in 32 digits.
    fn precise_weights(&self, K: &LongMatrix) -> LongMatrix {
        let mut sum = LongMatrix::from(&self.Q).plus(&K.t().times(&LongMatrix::from(&self.R).times(K)));
        if let Some(S) = &self.S {
            let cross = LongMatrix::from(S).times(K);
            sum = sum.difference(&cross).difference(&cross.t());
        }
        sum
    }

    /// `M + S'` in 32 digits.
    fn with_cross(&self, M: LongMatrix) -> LongMatrix {
        match &self.S {
            None => M,
            Some(S) => M.plus(&LongMatrix::from(&S.t())),
        }
    }

    /// `A - B K` in 32 digits.
    fn precise_closed(&self, K: &LongMatrix) -> LongMatrix {
        LongMatrix::from(&self.A).difference(&LongMatrix::from(&self.B).times(K))
    }

    /// `A - B R^-1 S'`, `B R^-1 B'`, `Q - S R^-1 S'` in 32 digits; `None` for a singular `R`.
    fn fold_precisely(
        &self,
        Q: &LongMatrix,
        R: &LongMatrix,
        S: Option<&LongMatrix>,
    ) -> Option<[LongMatrix; 3]> {
        let (A, B) = (LongMatrix::from(&self.A), LongMatrix::from(&self.B));
        let G = B.times(&R.solve(&B.t())?).symmetric_part();
        let Some(S) = S else { return Some([A, G, Q.clone()]) };
        let K = R.solve(&S.t())?;
        Some([A.difference(&B.times(&K)), G, Q.difference(&S.times(&K)).symmetric_part()])
    }

    /// `|Q| + |K|'|R||K| + |S||K| + |K|'|S|'`
    fn weight_moduli(&self, K: &Mat) -> Mat {
        let k = moduli(K);
        let sum = moduli(&self.Q) + k.t() * &moduli(&self.R) * &k;
        match &self.S {
            None => sum,
            Some(S) => {
                let cross = moduli(S) * &k;
                sum + &cross + cross.t()
            }
        }
    }

    /// `A - B K`
    pub(super) fn closed_matrix(&self, K: &Mat) -> Mat {
        &self.A - &(&self.B * K)
    }
}

/// `A'X + XA - (XB+S) R^-1 (B'X+S') + Q = 0`
pub(super) struct ContinuousRiccati(pub(super) Data);

impl ContinuousRiccati {
    /// `R^-1 (B'X + S')` from `B'X`
    fn gain_of(&self, BX: &ExtendedMatrix) -> Option<Mat> {
        let right = match &self.0.S {
            None => BX.to_double(),
            Some(S) => BX.add(&S.t().into()).to_double(),
        };
        solve(&self.0.R, &right).ok()
    }
}

impl Equation for ContinuousRiccati {
    fn evaluate(&self, X: &ExtendedMatrix) -> Option<Evaluation> {
        let data = &self.0;
        let AX = ExtendedMatrix::from(data.A.t()).times(X);
        let BX = ExtendedMatrix::from(data.B.t()).times(X);
        let gain = self.gain_of(&BX)?;
        let KBX = ExtendedMatrix::from(gain.t()).times(&BX).neg();
        let terms = 2.0 * AX.high.norm_fro() + KBX.high.norm_fro() + data.Q.norm_fro();
        let half = AX.add(&KBX);
        let total = half.add(&half.t()).add(&data.weights(&gain, &exact_product(&data.R, &gain)));
        Some(Evaluation { residual: total.to_double().symmetric_part(), terms, gain })
    }

    fn change(&self, before: &Evaluation, E: &Mat, _: &Mat) -> Option<Change> {
        let half = E * self.0.closed_matrix(&before.gain);
        let driven = self.0.B.t() * E;
        let gain = solve(&self.0.R, &driven).ok()?;
        let residual = &half + &half.t() - driven.t() * &gain;
        Some(Change { gain, residual })
    }

    fn closed_loop(&self, K: &Mat) -> Mat {
        self.0.closed_matrix(K)
    }

    fn residual_error(&self, K: &Mat, _: &Mat) -> f64 {
        (EPS * K.norm_fro()).powi(2) * self.0.R.norm_fro()
    }

    fn kind(&self) -> Kind {
        Kind::Continuous
    }
}

impl PreciseEquation for ContinuousRiccati {
    fn linearise(&self, X: &LongMatrix) -> Option<LinearisedEquation> {
        let data = &self.0;
        let right = data.with_cross(LongMatrix::from(&data.B.t()).times(X));
        let gain = LongMatrix::from(&data.R).solve(&right)?;
        let closed = data.precise_closed(&gain);
        let half = X.times(&closed);
        let residual = half.plus(&half.t()).plus(&data.precise_weights(&gain)).symmetric_part();
        Some(LinearisedEquation { residual, closed, gain })
    }

    fn moduli(&self, K: &Mat, X: &Mat) -> Mat {
        let half = moduli(&self.0.A.t()) * &moduli(X);
        half.t() + half + self.0.weight_moduli(K)
    }

    fn fold_shift(&self, _: f64) -> Option<[LongMatrix; 3]> {
        let data = &self.0;
        let cross = data.S.as_ref().map(LongMatrix::from);
        data.fold_precisely(&LongMatrix::from(&data.Q), &LongMatrix::from(&data.R), cross.as_ref())
    }

    fn shifts(&self) -> Vec<f64> {
        vec![0.0]
    }

    fn kind(&self) -> Kind {
        Kind::Continuous
    }
}

/// `A'X + XA - XGX + Q = 0`, `G` of any sign.
pub(super) struct Quadratic {
    pub(super) A: Mat,
    pub(super) G: Mat,
    pub(super) Q: Mat,
}

impl Equation for Quadratic {
    fn evaluate(&self, X: &ExtendedMatrix) -> Option<Evaluation> {
        let AX = ExtendedMatrix::from(self.A.t()).times(X);
        let GX = ExtendedMatrix::from(self.G.clone()).times(X);
        let square = X.times(&GX).neg();
        let terms = 2.0 * AX.high.norm_fro() + square.high.norm_fro() + self.Q.norm_fro();
        let total = AX.add(&AX.t()).add(&square).add(&self.Q.clone().into());
        Some(Evaluation { residual: total.to_double().symmetric_part(), terms, gain: GX.to_double() })
    }

    fn change(&self, before: &Evaluation, E: &Mat, _: &Mat) -> Option<Change> {
        let half = E * (&self.A - &before.gain);
        let gain = &self.G * E;
        let residual = &half + &half.t() - E * &gain;
        Some(Change { gain, residual })
    }

    fn closed_loop(&self, K: &Mat) -> Mat {
        &self.A - K
    }

    fn residual_error(&self, _: &Mat, _: &Mat) -> f64 {
        0.0
    }

    fn kind(&self) -> Kind {
        Kind::Continuous
    }
}

impl PreciseEquation for Quadratic {
    fn linearise(&self, X: &LongMatrix) -> Option<LinearisedEquation> {
        let gain = LongMatrix::from(&self.G).times(X);
        let closed = LongMatrix::from(&self.A).difference(&gain);
        let half = X.times(&closed);
        let square = X.times(&gain);
        let residual = half.plus(&half.t()).plus(&square).plus(&LongMatrix::from(&self.Q)).symmetric_part();
        Some(LinearisedEquation { residual, closed, gain })
    }

    fn moduli(&self, _: &Mat, X: &Mat) -> Mat {
        let x = moduli(X);
        let half = moduli(&self.A.t()) * &x;
        half.t() + half + moduli(&self.Q) + &x * &moduli(&self.G) * &x
    }

    fn fold_shift(&self, _: f64) -> Option<[LongMatrix; 3]> {
        Some([&self.A, &self.G, &self.Q].map(LongMatrix::from))
    }

    fn shifts(&self) -> Vec<f64> {
        vec![0.0]
    }

    fn kind(&self) -> Kind {
        Kind::Continuous
    }
}

/// `A'XA - X - (A'XB+S)(R+B'XB)^-1(B'XA+S') + Q = 0`
pub(super) struct DiscreteRiccati(pub(super) Data);

/// The closed loop of the discrete equation with some gain.
struct Loop {
    gain: Mat,
    /// `A - B K`
    closed: ExtendedMatrix,
    /// `X (A - B K)`
    moved: ExtendedMatrix,
    /// `R K`
    weighted: ExtendedMatrix,
    /// The gain that belongs to `X` less this one.
    correction: Mat,
}

impl DiscreteRiccati {
    /// `(R + B'XB)^-1 (B'XA + S')` in working precision.
    fn first_gain(&self, X: &Mat, weight: &Mat) -> Option<Mat> {
        let data = &self.0;
        let BXA = &(data.B.t() * X) * &data.A;
        solve(weight, &data.S.as_ref().map_or(BXA.clone(), |S| BXA + S.t())).ok()
    }

    /// `R + B'XB`
    fn weight(&self, X: &Mat) -> Mat {
        self.0.B.t() * X * &self.0.B + &self.0.R
    }

    /// The loop with `gain`; its correction solves `W dK = B'X(A - BK) + S' - RK`, which is small and computed in twice the working
    /// precision.
    fn close(&self, X: &ExtendedMatrix, weight: &Mat, gain: Mat) -> Option<Loop> {
        let data = &self.0;
        let closed = exact_product(&data.B, &gain).neg().add(&data.A.clone().into());
        let moved = X.times(&closed);
        let weighted = exact_product(&data.R, &gain);
        let mut rest = ExtendedMatrix::from(data.B.t()).times(&moved).add(&weighted.neg());
        if let Some(S) = &data.S {
            rest = rest.add(&S.t().into());
        }
        let correction = solve(weight, &rest.to_double()).ok()?;
        Some(Loop { gain, closed, moved, weighted, correction })
    }
}

impl Equation for DiscreteRiccati {
    /// A gain `K` that is not quite that of `X` leaves `dK'W dK` more than the residual, `dK` being its correction.
    fn evaluate(&self, X: &ExtendedMatrix) -> Option<Evaluation> {
        let data = &self.0;
        let weight = self.weight(&X.high);
        let mut at = self.close(X, &weight, self.first_gain(&X.high, &weight)?)?;
        for _ in 0..GAIN_CORRECTIONS {
            if at.correction.norm_fro() <= GAIN_KNOWN * at.gain.norm_fro() {
                break;
            }
            at = self.close(X, &weight, &at.gain + &at.correction)?;
        }
        let moved = at.closed.t().symmetric_times(&at.moved);
        let AXA = data.A.t() * &X.high * &data.A;
        let terms = AXA.norm_fro() + X.high.norm_fro() + data.Q.norm_fro() + (&AXA - &moved.high).norm_fro();
        let excess = at.correction.t() * &(&weight * &at.correction);
        let total =
            moved.add(&X.neg()).add(&data.weights(&at.gain, &at.weighted)).add(&excess.scale(-1.0).into());
        let gain = &at.gain + &at.correction;
        Some(Evaluation { residual: total.to_double().symmetric_part(), terms, gain })
    }

    fn change(&self, before: &Evaluation, E: &Mat, X: &Mat) -> Option<Change> {
        let closed = self.0.closed_matrix(&before.gain);
        let moved = E * &closed;
        let driven = self.0.B.t() * &moved;
        let gain = solve(&self.weight(X), &driven).ok()?;
        let residual = closed.t() * &moved - E - driven.t() * &gain;
        Some(Change { gain, residual })
    }

    fn closed_loop(&self, K: &Mat) -> Mat {
        self.0.closed_matrix(K)
    }

    fn residual_error(&self, K: &Mat, X: &Mat) -> f64 {
        let weight = self.weight(X);
        let products = EXTENDED_ERROR * self.0.closed_matrix(K).norm_fro().powi(2) * X.norm_fro();
        products + (EPS * K.norm_fro()).powi(2) * weight.norm_fro()
    }

    fn kind(&self) -> Kind {
        Kind::Discrete
    }
}

impl PreciseEquation for DiscreteRiccati {
    fn linearise(&self, X: &LongMatrix) -> Option<LinearisedEquation> {
        let data = &self.0;
        let BX = LongMatrix::from(&data.B.t()).times(X);
        let weight = BX.times(&LongMatrix::from(&data.B)).plus(&LongMatrix::from(&data.R));
        let gain = weight.solve(&data.with_cross(BX.times(&LongMatrix::from(&data.A))))?;
        let closed = data.precise_closed(&gain);
        let moved = closed.t().times(&X.times(&closed));
        let residual = moved.difference(X).plus(&data.precise_weights(&gain)).symmetric_part();
        Some(LinearisedEquation { residual, closed, gain })
    }

    fn moduli(&self, K: &Mat, X: &Mat) -> Mat {
        let data = &self.0;
        let inner = moduli(&data.A) + moduli(&data.B) * &moduli(K);
        let half = moduli(&data.closed_matrix(K)).t() * &moduli(X) * &inner;
        half.t() + half + data.weight_moduli(K)
    }

    fn fold_shift(&self, shift: f64) -> Option<[LongMatrix; 3]> {
        let data = &self.0;
        let (A, B) = (LongMatrix::from(&data.A), LongMatrix::from(&data.B));
        let (mut Q, mut R) = (LongMatrix::from(&data.Q), LongMatrix::from(&data.R));
        if shift == 0.0 {
            let cross = data.S.as_ref().map(LongMatrix::from);
            return data.fold_precisely(&Q, &R, cross.as_ref());
        }
        let scaled = LongMatrix::identity(data.A.nrows(), shift);
        Q = Q.plus(&A.t().times(&scaled.times(&A))).difference(&scaled).symmetric_part();
        R = R.plus(&B.t().times(&scaled.times(&B))).symmetric_part();
        let cross = data.with_cross(B.t().times(&scaled.times(&A))).t();
        data.fold_precisely(&Q, &R, Some(&cross))
    }

    /// None at first if `R` is regular, and sizes that make `R + s B'B` so. A large problem gets few, because its refusal must not take
    /// many times as long as a solution.
    fn shifts(&self) -> Vec<f64> {
        let Data { B, Q, R, .. } = &self.0;
        let square = B.norm_fro().powi(2).max(f64::MIN_POSITIVE);
        let size = (Q.norm_fro() + R.norm_fro() / square).max(f64::MIN_POSITIVE);
        let regular = rcond_one(R) > RICCATI_REGULAR;
        let mut list = vec![size, -size, 0.03 * size, 30.0 * size];
        list.insert(if regular { 0 } else { list.len() }, 0.0);
        if R.nrows().max(Q.nrows()) > PRECISE_STATES {
            list.truncate(if regular { 1 } else { 2 });
        }
        list
    }

    fn kind(&self) -> Kind {
        Kind::Discrete
    }
}

/// The matrix of moduli.
fn moduli(M: &Mat) -> Mat {
    M.map(f64::abs)
}
