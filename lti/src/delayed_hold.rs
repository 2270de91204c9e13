//! A continuous system behind a delay and a zero-order hold, sampled exactly, whatever share of a period the delay is.

use crate::connect::series;
use crate::delay::delay_samples;
use crate::discretise::needs_continuous;
use crate::error::OperationContext;
use crate::tolerance::WHOLE_PERIODS;
use crate::{Error, Mat, StateSpace, Timebase};
use counterpoise_linalg as linalg;

/// Returns the sampled system of `g` whose inputs are held over each period and arrive `delay_s` seconds later.
///
/// With delay = (k + f) T, 0 <= f < 1, an input acts over the last (1 - f) T of a period and the first f T of the next one
/// (Åström and Wittenmark, Computer-Controlled Systems, section 2.3):
/// x+ = exp(A T) x + exp(A (1 - f) T) H(f T) u_-  + H((1 - f) T) u, H(t) the integral of exp(A s) B over t. The previous input becomes a
/// state if f > 0, and each whole period one more for each input. A direct path passes the same delay, which takes
/// one more whole period if f > 0, because a sample sees the input that was held when it was taken.
///
/// # Errors
/// [`Error::Timebase`], [`Error::Period`], [`Error::Range`] for a delay that is negative, not finite or longer than 4096 periods.
pub fn c2d_delayed(g: &StateSpace, period_s: f64, delay_s: f64) -> Result<StateSpace, Error> {
    needs_continuous("c2d with delay", g)?;
    if !(period_s > 0.0 && period_s.is_finite()) {
        return Err(Error::Period { period_s });
    }
    if !(delay_s >= 0.0 && delay_s.is_finite()) {
        return Err(Error::Range { what: "delay_s", value: delay_s, allowed: "finite and not negative" });
    }
    let periods = delay_s / period_s;
    let nearest = periods.round();
    let is_whole = (periods - nearest).abs() <= WHOLE_PERIODS * nearest.max(1.0);
    let (whole, share) = if is_whole { (nearest, 0.0) } else { (periods.floor(), periods.fract()) };
    let sampled = partly_delayed(g, period_s, share)?;
    // A number beyond every size becomes the largest, which is refused.
    let line = delay_samples(whole as usize, period_s)?;
    let mut lines = StateSpace::gain(Mat::eye(0), sampled.timebase)?;
    for _ in 0..g.inputs() {
        lines = crate::append(&lines, &line)?;
    }
    if whole == 0.0 { Ok(sampled) } else { series(&lines, &sampled) }
}

/// Returns the same for a delay that is a share of a period.
fn partly_delayed(g: &StateSpace, period_s: f64, share: f64) -> Result<StateSpace, Error> {
    let (n, m) = (g.order(), g.inputs());
    let timebase = Timebase::Discrete { period_s };
    let during = "zero-order hold with delay";
    let (late, now) = linalg::expm_integral(&g.A, &g.B, (1.0 - share) * period_s).with_operation(during)?;
    if share == 0.0 {
        return StateSpace::new(late, now, g.C.clone(), g.D.clone(), timebase);
    }
    let (early, before) = linalg::expm_integral(&g.A, &g.B, share * period_s).with_operation(during)?;
    let none = Mat::zeros(m, m);
    let A = Mat::from_blocks(&[&[&(&late * &early), &(&late * &before)], &[&Mat::zeros(m, n), &none]]);
    let B = now.vstack(&Mat::eye(m));
    StateSpace::new(A, B, g.C.hstack(&g.D), Mat::zeros(g.outputs(), m), timebase)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::{C64, Discretisation, Zpk, c2d, response_at, step};

    fn plant() -> StateSpace {
        let poles = [C64::new(-1.0, 4.0), C64::new(-1.0, -4.0), C64::new(0.0, 0.0)];
        Zpk { zeros: vec![], poles: poles.to_vec(), gain: 3.0, timebase: Timebase::Continuous }
            .to_state_space()
            .unwrap()
    }

    #[test]
    fn whole_periods_are_a_delay_line_before_the_held_system() {
        let (g, T) = (plant(), 0.1);
        let plain = c2d(&g, T, Discretisation::ZeroOrderHold).unwrap();
        let delayed = c2d_delayed(&g, T, 3.0 * T).unwrap();
        for rate in [0.3, 2.0, 20.0] {
            let turned = response_at(&plain, rate).unwrap()[(0, 0)] * C64::from_polar(1.0, -rate * 3.0 * T);
            assert!((response_at(&delayed, rate).unwrap()[(0, 0)] / turned - 1.0).norm() < 1e-12);
        }
    }

    #[test]
    fn a_step_arrives_late_by_a_share_of_a_period() {
        // The response to a step, sampled at k T, is that of the plant at k T - delay.
        let (g, T, delay) = (plant(), 0.1, 0.17);
        let fine = c2d(&g, 0.01, Discretisation::ZeroOrderHold).unwrap();
        let exact = step(&fine, 4.0, 2).unwrap();
        let found = step(&c2d_delayed(&g, T, delay).unwrap(), 4.0, 2).unwrap();
        for k in 2..30 {
            let at = 10 * k - 17;
            let (a, b) = (found.y[(k, 0)], exact.y[(at, 0)]);
            assert!((a - b).abs() < 1e-12, "{k}: {a} {b}");
        }
    }
}
