//! Claims on the choice of weights.

use counterpoise_lti::{margins, series};
use counterpoise_synth::{Alternative, Method, Outcome, Weight, alternative};
use counterpoise_verify::{Figure, LoopFigure, Model, StepFigure};

use super::{Bench, Claim, Finding};
use crate::pipeline::{Designed, PipelineError};

/// Corner of the error weight without integral action, s: where the integrating design's own weight levels off.
const CORNER_S: f64 = 1.0 / 1.8;

/// C26: with and without integral action.
///
/// # Errors
/// Those of the pipeline.
pub fn c26(bench: &Bench<'_>) -> Result<Claim, PipelineError> {
    let integral = with_error(bench, Weight::Integral { gain: 200.0, time_s: 1.0 })?;
    let lag = with_error(bench, Weight::Lag { gain: 200.0 * CORNER_S, time_s: CORNER_S })?;
    let (a, b) = (figures(&integral), figures(&lag));
    let text = |f: &[f64; 4]| {
        format!(
            "steady-state error {:.2} %, overshoot {:.1} %, Ms {:.2}, phase margin {:.0} deg",
            f[0], f[1], f[2], f[3]
        )
    };
    let (no_error, calmer) = (a[0] < 0.1 && b[0] > 1.0, a[1] <= b[1] && a[2] <= b[2]);
    Ok(Claim {
        id: "C26",
        source: "app. 5",
        says: "weights K1/(a1 s) and K2(a2 s + 1) give no steady-state error and less oscillation than K7/(a7 s + 1) and K8(a8 s + 1)",
        measured: format!("integral: {}; without: {}", text(&a), text(&b)),
        finding: match (no_error, calmer) {
            (true, true) => Finding::Holds,
            (true, false) => Finding::Differs {
                why: "the steady state is as claimed; which of the two oscillates less depends on the gains, which the thesis does not print".to_owned(),
            },
            _ => Finding::Fails,
        },
    })
}

/// The thesis' form of the feedback weights with another error weight.
fn with_error(bench: &Bench<'_>, error: Weight) -> Result<Designed, PipelineError> {
    bench.redesign(|project| {
        project.verify.iter_mut().for_each(|verify| verify.road = None);
        if let Some(synthesis) = &mut project.synth {
            synthesis.specification.feedback.error = error;
            synthesis.specification.feedback.control = Weight::Lead { gain: 1.0, time_s: 0.005 };
        }
    })
}

fn figures(designed: &Designed) -> [f64; 4] {
    let wanted = [
        Figure::Step(Model::Linear, StepFigure::SteadyStateError),
        Figure::Step(Model::Linear, StepFigure::Overshoot),
        Figure::Loop(LoopFigure::MaxSensitivity),
        Figure::Loop(LoopFigure::PhaseMargin),
    ];
    wanted.map(|figure| designed.verified.verification().value(figure).unwrap_or(f64::NAN))
}

/// C27: three methods on one plant and one pair of weights.
///
/// # Errors
/// Those of the design and the margins.
pub fn c27(bench: &Bench<'_>) -> Result<Claim, PipelineError> {
    let design = &bench.designed.synthesised.design;
    let (mut words, mut stable) = (Vec::new(), true);
    for (method, name) in
        [(Method::ThreePart, "H2"), (Method::LqgLtr, "LQG/LTR"), (Method::HInfinity, "H-infinity")]
    {
        match alternative(&design.plant, &design.specification.feedback, method)? {
            Outcome::Solved(part) => {
                let (text, closed) = loop_words(bench, &part)?;
                stable &= closed;
                words.push(format!("{name}: {text}"));
            }
            Outcome::Infeasible(_) => {
                stable = false;
                words.push(format!("{name}: no solution"));
            }
        }
    }
    Ok(Claim {
        id: "C27",
        source: "app. 2",
        says: "LQG/LTR, H2 and H-infinity as alternatives on the same plant",
        measured: words.join("; "),
        finding: Finding::of(stable),
    })
}

/// Margins of a continuous design on the design plant, in words, and whether its loop is stable.
fn loop_words(bench: &Bench<'_>, part: &Alternative) -> Result<(String, bool), PipelineError> {
    let plant = &bench.designed.synthesised.design.plant;
    let seen = plant.measured()?.select(&[0], &[plant.control]);
    let found = margins(&series(&part.controller.select(&[0], &[0]), &seen)?)?;
    let phase = found.phase_margin().map_or(f64::INFINITY, |phase| phase.deg);
    let gain = found.gain_margin_db();
    let text = format!("gain margin {gain:.1} dB, phase margin {phase:.0} deg, Ms {:.2}", found.ms.value);
    Ok((text, found.closed_loop_stable))
}
