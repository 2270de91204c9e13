//! Transfer functions as quotients of polynomials: for reading and writing, never for computing.

use crate::root_order::sort_roots;
use crate::roots::{poles, zeros};
use crate::zpk::needs_siso;
use crate::{C64, Error, Mat, StateSpace, Timebase, Zpk};
use counterpoise_linalg as linalg;

/// numerator / denominator, coefficients by falling powers of s or z.
#[derive(Debug, Clone, PartialEq)]
pub struct TransferFunction {
    /// Coefficients of the numerator, highest power first.
    pub numerator: Vec<f64>,
    /// Coefficients of the denominator, highest power first.
    pub denominator: Vec<f64>,
    /// Continuous (powers of s) or discrete (of z).
    pub timebase: Timebase,
}

impl TransferFunction {
    /// Returns the quotient, leading zeros taken off.
    ///
    /// # Errors
    /// [`Error::Rational`] for a denominator of zero or a numerator of higher degree, [`Error::NotFinite`].
    pub fn new(numerator: &[f64], denominator: &[f64], timebase: Timebase) -> Result<Self, Error> {
        if !numerator.iter().chain(denominator).all(|c| c.is_finite()) {
            return Err(Error::NotFinite { what: "coefficients" });
        }
        let strip = |c: &[f64]| c.iter().copied().skip_while(|&c| c == 0.0).collect::<Vec<f64>>();
        let (numerator, denominator) = (strip(numerator), strip(denominator));
        if denominator.is_empty() {
            return Err(Error::Rational { what: "transfer function", problem: "the denominator is zero" });
        }
        if numerator.len() > denominator.len() {
            let problem =
                "the numerator is of higher degree than the denominator: no state space has this response";
            return Err(Error::Rational { what: "transfer function", problem });
        }
        Ok(Self { numerator, denominator, timebase })
    }

    /// Returns the value at a point, by Horner's rule.
    pub fn at(&self, s: C64) -> C64 {
        let value = |c: &[f64]| c.iter().fold(C64::new(0.0, 0.0), |sum, &c| sum * s + c);
        value(&self.numerator) / value(&self.denominator)
    }

    /// Returns zeros, poles and gain: eigenvalues of the scaled companion matrices.
    ///
    /// # Errors
    /// [`Error::Matrix`].
    pub fn to_zpk(&self) -> Result<Zpk, Error> {
        let gain = self.numerator.first().map_or(0.0, |c| c / self.denominator[0]);
        Ok(Zpk {
            zeros: roots(&self.numerator)?,
            poles: roots(&self.denominator)?,
            gain,
            timebase: self.timebase,
        })
    }

    /// Returns the controllable companion form with its states scaled by powers of two; minimal where the
    /// quotient is.
    ///
    /// # Errors
    /// As [`StateSpace::new`].
    pub fn to_state_space(&self) -> Result<StateSpace, Error> {
        let n = self.denominator.len() - 1;
        let lead = self.denominator[0];
        let a: Vec<f64> = self.denominator[1..].iter().map(|c| c / lead).collect();
        let mut b = vec![0.0; n + 1 - self.numerator.len()];
        b.extend(self.numerator.iter().map(|c| c / lead));
        let A = companion(&a);
        let B = Mat::from_fn(n, 1, |i, _| if i == 0 { 1.0 } else { 0.0 });
        let C = Mat::from_fn(1, n, |_, j| b[j + 1] - b[0] * a[j]);
        let g = StateSpace::new(A, B, C, Mat::row(&[b[0]]), self.timebase)?;
        Ok(crate::scaling::balance(&g).0)
    }

    /// Returns the expanded quotient of a system, for display: coefficients of a high order are worth few
    /// digits.
    ///
    /// # Errors
    /// [`Error::NotSiso`], [`Error::Matrix`].
    pub fn of(g: &StateSpace) -> Result<Self, Error> {
        needs_siso("transfer function", g)?;
        let zpk = Zpk::of(g)?;
        let numerator: Vec<f64> = expand(&zeros(g)?).iter().map(|c| c * zpk.gain).collect();
        Self::new(&numerator, &expand(&poles(g)?), g.timebase)
    }
}

/// [-a; 1 0; ...].
fn companion(a: &[f64]) -> Mat {
    let n = a.len();
    Mat::from_fn(n, n, |i, j| if i == 0 { -a[j] } else { f64::from(u8::from(i == j + 1)) })
}

/// Returns roots of a polynomial, sorted; trailing zeros of the coefficients are roots at exactly zero.
fn roots(coefficients: &[f64]) -> Result<Vec<C64>, Error> {
    let at_zero = coefficients
        .iter()
        .rev()
        .take_while(|&&c| c == 0.0)
        .count()
        .min(coefficients.len().saturating_sub(1));
    let rest = &coefficients[..coefficients.len() - at_zero];
    let mut roots = vec![C64::new(0.0, 0.0); at_zero];
    if rest.len() > 1 {
        let a: Vec<f64> = rest[1..].iter().map(|c| c / rest[0]).collect();
        let failed = |source| Error::Matrix { what: "roots", source };
        roots.extend(linalg::eigenvalues(&companion(&a)).map_err(failed)?);
    }
    sort_roots(&mut roots);
    Ok(roots)
}

/// Returns the monic polynomial with the given roots.
fn expand(roots: &[C64]) -> Vec<f64> {
    let mut c = vec![C64::new(1.0, 0.0)];
    for root in roots {
        c.push(C64::new(0.0, 0.0));
        for k in (1..c.len()).rev() {
            let before = c[k - 1];
            c[k] -= before * root;
        }
    }
    c.iter().map(|c| c.re).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::Response;

    #[test]
    fn all_three_forms_have_one_response() {
        let tf =
            TransferFunction::new(&[2.0, 3.0, 50.0], &[1.0, 1001.0, 2000.0, 1e6, 0.0], Timebase::Continuous)
                .unwrap();
        let (zpk, g) = (tf.to_zpk().unwrap(), tf.to_state_space().unwrap());
        assert!(zpk.poles.contains(&C64::new(0.0, 0.0)));
        let response = Response::of(&g).unwrap();
        for s in [C64::new(0.0, 0.1), C64::new(0.0, 31.0), C64::new(1.0, 400.0)] {
            let expected = tf.at(s);
            assert!((zpk.at(s) - expected).norm() < 1e-11 * expected.norm());
            assert!(
                (response.at_points(&[s]).unwrap()[0][(0, 0)] - expected).norm() < 1e-11 * expected.norm()
            );
        }
        let back = TransferFunction::of(&g).unwrap();
        for (a, b) in back.denominator.iter().zip(&tf.denominator) {
            assert!((a - b).abs() < 1e-9 * b.abs().max(1.0), "{back:?}");
        }
        assert_eq!(back.numerator.len(), 3);
    }

    #[test]
    fn improper_and_empty_quotients_are_refused() {
        assert!(TransferFunction::new(&[1.0, 0.0], &[1.0], Timebase::Continuous).is_err());
        assert!(TransferFunction::new(&[1.0], &[0.0, 0.0], Timebase::Continuous).is_err());
        assert!(TransferFunction::new(&[f64::NAN], &[1.0], Timebase::Continuous).is_err());
        let zero = TransferFunction::new(&[0.0], &[1.0, 1.0], Timebase::Continuous).unwrap();
        assert_eq!(zero.to_state_space().unwrap().C[(0, 0)], 0.0);
        assert_eq!(zero.to_zpk().unwrap().gain, 0.0);
    }
}
