//! The amplifier's gain curve: a piecewise linear change of its map among the unknowns.

use counterpoise_models::Parameters;
use counterpoise_recordings::Recording;

use super::outcome::{GainCurveObstacle, GainPoint, IdentifiedAmplifier};
use super::problem::IdentificationProblem;
use super::regression::RegressionFit;
use crate::Error;
use crate::tolerance::identification::*;

/// The amplifier, and the problem with its curve if the curve differs from the project's.
pub struct GainCurve {
    /// Result of the recordings for it.
    pub amplifier: IdentifiedAmplifier,
    /// The problem and its solution with the curve.
    pub curved: Option<(IdentificationProblem, RegressionFit)>,
}

/// Identifies the curve.
pub fn identify_amplifier(
    p: &Parameters,
    states: &[&[Recording]],
    plain: &IdentificationProblem,
    linear: &RegressionFit,
) -> Result<GainCurve, Error> {
    let unseen =
        |reason| Ok(GainCurve { amplifier: IdentifiedAmplifier::NotIdentifiable { reason }, curved: None });
    let knots = knots(p, plain);
    if knots.len() < LEAST_POINTS + 2 {
        return unseen(GainCurveObstacle::ControlStaysLarge);
    }
    let problem = IdentificationProblem::new(p, states, &knots)?.with_held_viscous(plain.held_viscous);
    let Some(fit) = problem.fit() else {
        return unseen(GainCurveObstacle::ConfusedWithFriction);
    };
    let points = points(p, &problem, &fit, &knots);
    if points.len() < LEAST_POINTS {
        return unseen(GainCurveObstacle::TooUncertain);
    }
    let differs = points.iter().any(|q| {
        let apart = (q.current_a - q.linear_a).abs();
        apart > CURVE_DEPARTURE * q.linear_a && apart > q.current_a - q.ci95_a[0]
    });
    if differs && fit.residual_rms.powi(2) < CURVE_WORTH * linear.residual_rms.powi(2) {
        return Ok(GainCurve {
            amplifier: IdentifiedAmplifier::Curve { points },
            curved: Some((problem, fit)),
        });
    }
    Ok(GainCurve { amplifier: IdentifiedAmplifier::AsInProject { points }, curved: None })
}

/// Returns the knots that the control was near for long enough, with 0 and the start of the linear range.
fn knots(p: &Parameters, plain: &IdentificationProblem) -> Vec<f64> {
    let top = LINEAR_FROM_SHARE * p.amplifier.input_limit_v;
    let spacing = top / KNOTS as f64;
    let time = |knot: f64| -> f64 {
        let near = |part: &super::problem::RecordingRows| {
            let rows = part.rows.control_v().iter().zip(&part.rows.sliding);
            let count = rows.filter(|(u, s)| **s && (u.abs() - knot).abs() < 0.5 * spacing).count();
            count as f64 * part.rows.period_s
        };
        plain.parts.iter().map(near).sum()
    };
    let inner = (1..KNOTS).map(|k| top * k as f64 / KNOTS as f64).filter(|v| time(*v) >= LEAST_AT_KNOT_S);
    let mut out = vec![0.0];
    out.extend(inner);
    out.push(top);
    out
}

/// Returns the points that are known well enough to be reported.
fn points(
    p: &Parameters,
    problem: &IdentificationProblem,
    fit: &RegressionFit,
    knots: &[f64],
) -> Vec<GainPoint> {
    let gain = p.amplifier.stall_gain_a_v(&p.motor);
    let point = |k: usize| {
        let (input_v, unknown) = (knots[k + 1], problem.layout.knot(k));
        let linear_a = gain * p.amplifier.drive_v(input_v, &p.motor);
        let current_a = linear_a + gain * fit.value[unknown];
        let half = gain * fit.half_width[unknown];
        let ci95_a = [current_a - half, current_a + half];
        let width = 0.5 * (knots[k + 2] - knots[k]);
        let scatter_a = scatter(p, problem, &fit.value, [input_v - width, input_v + width]);
        GainPoint { input_v, current_a, ci95_a, linear_a, scatter_a }
    };
    let sure = |q: &GainPoint| q.current_a - q.ci95_a[0] < CURVE_DOUBT * q.linear_a.abs();
    (0..knots.len() - 2).map(point).filter(sure).collect()
}

/// Returns the RMS of the balance's residual, as current, over a range of the control's size.
fn scatter(p: &Parameters, problem: &IdentificationProblem, value: &[f64], range_v: [f64; 2]) -> f64 {
    let (mut power, mut count) = (0.0, 0.0_f64);
    for (index, part) in problem.parts.iter().enumerate() {
        let residual = problem.residual(index, value);
        let (sliding, control_v) = (&part.rows.sliding, part.rows.smooth_control_v());
        for k in (0..residual.len()).filter(|k| sliding[*k]) {
            let size = control_v[k].abs();
            if range_v[0] <= size && size < range_v[1] {
                power += residual[k] * residual[k];
                count += 1.0;
            }
        }
    }
    (power / count.max(1.0)).sqrt() / (p.gearbox.ratio * p.motor.torque_constant_nm_a)
}
