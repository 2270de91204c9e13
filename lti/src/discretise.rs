//! From continuous to sampled time.

use crate::error::OperationContext;
use crate::scaling::balance;
use crate::tolerance::{NARROW_UNITS, SAME_SAMPLED, SPREAD_UNITS};
use crate::zpk::match_poles_and_zeros;
use crate::{Error, Mat, StateSpace, Timebase};
use counterpoise_linalg as linalg;

/// Method by which a continuous system becomes a sampled one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Discretisation {
    /// Exact for inputs held constant over each period.
    ZeroOrderHold,
    /// Exact for inputs that are straight lines from sample to sample (the triangle hold; no delay is added).
    FirstOrderHold,
    /// Bilinear: s = (2/T) (z - 1)/(z + 1), or the slope that keeps the response at one frequency.
    Tustin {
        /// The frequency in rad/s at which continuous and sampled response are to agree.
        prewarp_rad_s: Option<f64>,
    },
    /// Poles and zeros by z = exp(s T), single input and output; zeros at infinity but one go to z = -1.
    Matched,
}

/// Returns the sampled system of period `period_s`.
///
/// # Errors
/// [`Error::Timebase`] for a system that is sampled already, [`Error::Period`], [`Error::Range`] for a prewarping
/// frequency outside (0, pi/T), [`Error::Pole`] if the bilinear map sends a pole to infinity, [`Error::NotSiso`] for
/// the matched method on more than one input or output.
pub fn c2d(g: &StateSpace, period_s: f64, method: Discretisation) -> Result<StateSpace, Error> {
    needs_continuous("c2d", g)?;
    if !(period_s > 0.0 && period_s.is_finite()) {
        return Err(Error::Period { period_s });
    }
    match method {
        Discretisation::ZeroOrderHold => zero_order_hold(g, period_s),
        Discretisation::FirstOrderHold => first_order_hold(g, period_s),
        Discretisation::Tustin { prewarp_rad_s } => tustin(g, period_s, slope(period_s, prewarp_rad_s)?),
        Discretisation::Matched => match_poles_and_zeros(g, period_s),
    }
}

/// Returns the continuous system whose Tustin discretisation is `g`.
///
/// # Errors
/// [`Error::Timebase`] for a continuous system, [`Error::Range`] for the prewarping frequency, [`Error::Pole`] for a
/// pole at z = -1.
pub fn d2c_tustin(g: &StateSpace, prewarp_rad_s: Option<f64>) -> Result<StateSpace, Error> {
    let Timebase::Discrete { period_s } = g.timebase else {
        let expected = "a discrete timebase".to_string();
        return Err(Error::Timebase { what: "d2c_tustin", found: g.timebase.to_string(), expected });
    };
    let a = slope(period_s, prewarp_rad_s)?;
    let n = g.order();
    let plus = &g.A + &Mat::eye(n);
    let refused =
        |_| Error::Pole { what: "d2c_tustin", re: -1.0, im: 0.0, problem: "has no continuous counterpart" };
    let inverse = linalg::inverse(&plus).map_err(refused)?;
    // z = (a + s)/(a - s): the same formulas with the roles of the two planes exchanged.
    let root = (2.0 * a).sqrt();
    let A = (&inverse * &(&g.A - &Mat::eye(n))).scale(a);
    let B = (&inverse * &g.B).scale(root);
    let C = (&g.C * &inverse).scale(root);
    let D = &g.D - &(&g.C * &(&inverse * &g.B));
    StateSpace::new(A, B, C, D, Timebase::Continuous)
}

/// Refuses a sampled system.
pub(crate) fn needs_continuous(what: &'static str, g: &StateSpace) -> Result<(), Error> {
    match g.timebase {
        Timebase::Continuous => Ok(()),
        Timebase::Discrete { .. } => {
            let expected = Timebase::Continuous.to_string();
            Err(Error::Timebase { what, found: g.timebase.to_string(), expected })
        }
    }
}

fn zero_order_hold(g: &StateSpace, period_s: f64) -> Result<StateSpace, Error> {
    let (F, G) = linalg::expm_integral(&g.A, &g.B, period_s).with_operation("zero-order hold")?;
    StateSpace::new(F, G, g.C.clone(), g.D.clone(), Timebase::Discrete { period_s })
}

/// exp of [A T, B T, 0; 0, 0, I; 0, 0, 0] = [F, G1, G2; ...]: x+ = F x + (G1 - G2) u + G2 u+, and the input ahead is
/// taken into the state x - G2 u.
fn first_order_hold(g: &StateSpace, period_s: f64) -> Result<StateSpace, Error> {
    let (n, m) = (g.order(), g.inputs());
    let mut augmented = Mat::zeros(n + 2 * m, n + 2 * m);
    augmented.set_block(0, 0, &g.A.scale(period_s));
    augmented.set_block(0, n, &g.B.scale(period_s));
    augmented.set_block(n, n + m, &Mat::eye(m));
    let E = linalg::expm(&augmented).with_operation("first-order hold")?;
    let F = E.block(0, 0, n, n);
    let (G1, G2) = (E.block(0, n, n, m), E.block(0, n + m, n, m));
    let B = &(&G1 - &G2) + &(&F * &G2);
    let D = &g.D + &(&g.C * &G2);
    StateSpace::new(F, B, g.C.clone(), D, Timebase::Discrete { period_s })
}

/// Returns the a of s = a (z - 1)/(z + 1).
fn slope(period_s: f64, prewarp_rad_s: Option<f64>) -> Result<f64, Error> {
    match prewarp_rad_s {
        None => Ok(2.0 / period_s),
        Some(rate) if rate > 0.0 && rate * period_s < std::f64::consts::PI => {
            Ok(rate / (0.5 * rate * period_s).tan())
        }
        Some(value) => {
            Err(Error::Range { what: "prewarp_rad_s", value, allowed: "between 0 and pi / period_s" })
        }
    }
}

/// With M the inverse of a I - A: 2a M - I = M (a I + A), sqrt(2a) M B, sqrt(2a) C M, D + C M B. The Gramians keep their values.
/// The states of a system whose units differ by many decades are scaled first, because the linear equations keep their digits beside the
/// norm of A only.
fn tustin(g: &StateSpace, period_s: f64, a: f64) -> Result<StateSpace, Error> {
    let (scaled, T) = balance(g);
    let (low, high) = T.iter().fold((1.0_f64, 1.0_f64), |(low, high), &t| (low.min(t), high.max(t)));
    if high <= NARROW_UNITS * low {
        return bilinear(g, period_s, a);
    }
    let careful = bilinear(&scaled, period_s, a)?;
    if high <= SPREAD_UNITS * low {
        let plain = bilinear(g, period_s, a)?;
        if is_same_system(&plain.scale_states(&T), &careful) {
            return Ok(plain);
        }
    }
    let back: Vec<f64> = T.iter().map(|t| 1.0 / t).collect();
    Ok(careful.scale_states(&back))
}

/// Returns whether the matrices of two systems differ by rounding only, each relative to its largest entry.
fn is_same_system(g: &StateSpace, h: &StateSpace) -> bool {
    let is_same = |M: &Mat, N: &Mat| (M - N).norm_max() <= SAME_SAMPLED * N.norm_max();
    is_same(&g.A, &h.A) && is_same(&g.B, &h.B) && is_same(&g.C, &h.C) && is_same(&g.D, &h.D)
}

fn bilinear(g: &StateSpace, period_s: f64, a: f64) -> Result<StateSpace, Error> {
    let n = g.order();
    let pole = |_| Error::Pole {
        what: "Tustin",
        re: a,
        im: 0.0,
        problem: "is mapped to infinity: use another period",
    };
    // One solution a column: the explicit inverse loses a digit on flexible structures.
    let M = linalg::solve(&(&Mat::eye(n).scale(a) - &g.A), &Mat::eye(n)).map_err(pole)?;
    let (MB, root) = (&M * &g.B, (2.0 * a).sqrt());
    let D = &g.D + &(&g.C * &MB);
    let A = &M.scale(2.0 * a) - &Mat::eye(n);
    StateSpace::new(A, MB.scale(root), (&g.C * &M).scale(root), D, Timebase::Discrete { period_s })
}

/// The sampled cost of a continuous quadratic one.
#[derive(Debug, Clone, PartialEq)]
pub struct SampledCost {
    /// exp(A T).
    pub A: Mat,
    /// Input matrix under zero-order hold.
    pub B: Mat,
    /// State weight, n x n.
    pub Q: Mat,
    /// Input weight, m x m.
    pub R: Mat,
    /// Cross weight, n x m.
    pub S: Mat,
}

/// A continuous quadratic cost on [x; u].
#[derive(Debug, Clone, Copy)]
pub struct QuadraticCost<'a> {
    /// State weight, n x n, symmetric.
    pub Q: &'a Mat,
    /// Input weight, m x m, symmetric.
    pub R: &'a Mat,
    /// Cross weight, n x m.
    pub S: &'a Mat,
}

/// Returns the exact cost of one period under a held input (Van Loan, IEEE TAC 23 (1978) 395)
///
/// ```text
///   integral over T of [x; u]' [Q S; S' R] [x; u] dt  =  [x0; u]' [Qd Sd; Sd' Rd] [x0; u]
/// ```
///
/// with x' = A x + B u, from one exponential of size 2 (n + m).
///
/// # Errors
/// [`Error::Shape`], [`Error::Period`], [`Error::Matrix`].
pub fn sampled_cost(A: &Mat, B: &Mat, cost: QuadraticCost, period_s: f64) -> Result<SampledCost, Error> {
    if !(period_s > 0.0 && period_s.is_finite()) {
        return Err(Error::Period { period_s });
    }
    let (n, m) = B.shape();
    check_cost(A, B, &cost)?;
    let zero = Mat::zeros(m, n + m);
    let F = A.hstack(B).vstack(&zero);
    let W = Mat::from_blocks(&[&[cost.Q, cost.S], &[&cost.S.t(), cost.R]]);
    let (E, W) = linalg::van_loan_cost(&F, &W, period_s).with_operation("sampled cost")?;
    Ok(SampledCost {
        A: E.block(0, 0, n, n),
        B: E.block(0, n, n, m),
        Q: W.block(0, 0, n, n),
        R: W.block(n, n, m, m),
        S: W.block(0, n, n, m),
    })
}

fn check_cost(A: &Mat, B: &Mat, cost: &QuadraticCost) -> Result<(), Error> {
    let (n, m) = B.shape();
    let checks = [("A", A, (n, n)), ("Q", cost.Q, (n, n)), ("R", cost.R, (m, m)), ("S", cost.S, (n, m))];
    for (what, matrix, expected) in checks {
        if matrix.shape() != expected {
            return Err(Error::Shape { what, found: matrix.shape(), expected });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::{C64, Zpk, frequency_response, response_at};

    fn plant() -> StateSpace {
        let c = C64::new;
        let poles = vec![c(-1.0, 20.0), c(-1.0, -20.0), c(-4.0, 0.0)];
        Zpk { zeros: vec![c(-9.0, 0.0)], poles, gain: 180.0, timebase: Timebase::Continuous }
            .to_state_space()
            .unwrap()
    }

    fn first_order() -> StateSpace {
        StateSpace::new(
            Mat::row(&[-2.0]),
            Mat::eye(1),
            Mat::row(&[3.0]),
            Mat::zeros(1, 1),
            Timebase::Continuous,
        )
        .unwrap()
    }

    #[test]
    fn zero_order_hold_of_a_first_order_lag_is_the_closed_form() {
        let g = c2d(&first_order(), 0.1, Discretisation::ZeroOrderHold).unwrap();
        let a = (-0.2_f64).exp();
        let ulp = f64::EPSILON;
        assert!((g.A[(0, 0)] - a).abs() < ulp && (g.B[(0, 0)] - (1.0 - a) / 2.0).abs() < ulp);
    }

    #[test]
    fn first_order_hold_follows_a_ramp_exactly() {
        let g = c2d(&first_order(), 0.1, Discretisation::FirstOrderHold).unwrap();
        let ramp = Mat::from_fn(30, 1, |k, _| k as f64 * 0.1);
        let y = crate::lsim(&g, &ramp, None).unwrap();
        for k in 0..30 {
            // y of 3/(s+2) to a ramp: 3 (t/2 - 1/4 + exp(-2t)/4).
            let t = k as f64 * 0.1;
            let expected = 3.0 * (t / 2.0 - 0.25 + (-2.0 * t).exp() / 4.0);
            assert!((y[(k, 0)] - expected).abs() < 1e-14, "{k}");
        }
    }

    #[test]
    fn tustin_is_the_bilinear_map_and_prewarping_keeps_one_frequency() {
        let g = plant();
        let plain = c2d(&g, 0.05, Discretisation::Tustin { prewarp_rad_s: None }).unwrap();
        let rate = 2.0 / 0.05 * (0.5_f64 * 12.0 * 0.05).tan();
        let (a, b) = (response_at(&plain, 12.0).unwrap(), response_at(&g, rate).unwrap());
        assert!((a[(0, 0)] - b[(0, 0)]).norm() < 1e-13);
        let warped = c2d(&g, 0.05, Discretisation::Tustin { prewarp_rad_s: Some(20.0) }).unwrap();
        let (a, b) = (response_at(&warped, 20.0).unwrap(), response_at(&g, 20.0).unwrap());
        assert!((a[(0, 0)] - b[(0, 0)]).norm() < 1e-12);
        let back = d2c_tustin(&warped, Some(20.0)).unwrap();
        assert!((&back.A - &g.A).norm_max() < 1e-12 * g.A.norm_max());
    }

    #[test]
    fn matched_maps_roots_and_keeps_the_static_gain() {
        let g = c2d(&plant(), 0.01, Discretisation::Matched).unwrap();
        let fast = crate::poles(&g).unwrap();
        assert!(fast.iter().any(|p| (p - C64::new(-0.04, 0.0).exp()).norm() < 1e-12), "{fast:?}");
        let (a, b) = (crate::dcgain(&g).unwrap(), crate::dcgain(&plant()).unwrap());
        assert!((a[(0, 0)] / b[(0, 0)] - 1.0).abs() < 1e-12, "{a:?} {b:?}");
        let near =
            frequency_response(&g, &[5.0]).unwrap()[0][(0, 0)] / response_at(&plant(), 5.0).unwrap()[(0, 0)];
        assert!((near - 1.0).norm() < 0.05, "{near}");
    }

    #[test]
    fn sampled_cost_agrees_with_quadrature() {
        let g = plant();
        let (n, T) = (3, 0.07);
        let (Q, R, S) = (&g.C.t() * &g.C, Mat::eye(1).scale(2.0), g.C.t().scale(0.3));
        let exact = sampled_cost(&g.A, &g.B, QuadraticCost { Q: &Q, R: &R, S: &S }, T).unwrap();
        let start = Mat::col(&[0.3, -1.0, 0.7]);
        let u = 0.9;
        // Simpson's rule on 200 panels, exact states at the nodes.
        let fine = c2d(&g, T / 400.0, Discretisation::ZeroOrderHold).unwrap();
        let (mut x, mut sum) = (start.clone(), 0.0);
        for k in 0..=400 {
            let value = (&x.t() * &(&Q * &x))[(0, 0)] + 2.0 * u * (&x.t() * &S)[(0, 0)] + 2.0 * u * u;
            sum += value
                * if k == 0 || k == 400 {
                    1.0
                } else if k % 2 == 1 {
                    4.0
                } else {
                    2.0
                };
            x = &(&fine.A * &x) + &fine.B.scale(u);
        }
        let expected = sum * T / 1200.0;
        let found = (&start.t() * &(&exact.Q * &start))[(0, 0)]
            + 2.0 * u * (&start.t() * &exact.S)[(0, 0)]
            + exact.R[(0, 0)] * u * u;
        assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
        assert_eq!(exact.A.shape(), (n, n));
    }
}
