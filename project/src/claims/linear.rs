//! Claims on the linear loop: margins, step, rejection.

use counterpoise_verify::{Arrangement, Figure, LoopFigure, Model, Quantity, Source, StepFigure};

use super::{Bench, Claim, Finding};
use crate::pipeline::PipelineError;

/// C5: margins and step.
///
/// # Errors
/// None beyond the bench's.
pub fn c5(bench: &Bench<'_>) -> Result<Claim, PipelineError> {
    let step = |figure| bench.value(Figure::Step(Model::Linear, figure));
    let gain = bench.value(Figure::Loop(LoopFigure::GainMargin));
    let phase = bench.value(Figure::Loop(LoopFigure::PhaseMargin));
    let (overshoot, error) = (step(StepFigure::Overshoot), step(StepFigure::SteadyStateError));
    let holds = gain >= 12.0 && phase >= 60.0 && overshoot <= 13.0 && error < 0.1;
    Ok(Claim {
        id: "C5",
        source: "6.3.1",
        says: "gain margin 12 dB, phase margin 60 deg, step overshoot 13 %, no steady-state error",
        measured: format!("{gain:.1} dB, {phase:.1} deg, {overshoot:.1} %, steady-state error {error:.3} %"),
        finding: Finding::of(holds),
    })
}

fn hub(source: Source, arrangement: Arrangement, quantity: Quantity) -> Figure {
    Figure::Disturbance(Model::Linear, source, arrangement, quantity)
}

/// C6: pitch.
///
/// # Errors
/// None beyond the bench's.
pub fn c6(bench: &Bench<'_>) -> Result<Claim, PipelineError> {
    let peak = |arrangement| bench.value(hub(Source::Pitch, arrangement, Quantity::HubPeak));
    let (none, feedback, both) =
        (peak(Arrangement::Uncontrolled), peak(Arrangement::Feedback), peak(Arrangement::Compensated));
    let (by_feedback, by_both) = (none / feedback, feedback / both);
    let hz = bench.procedure.pitch.frequency_hz;
    let equal = frequency_of_factor(bench, 13.0);
    let why = format!(
        "the factor falls with frequency: it is 13 at {equal:.2} Hz; the thesis does not say at which its disturbance acted"
    );
    Ok(Claim {
        id: "C6",
        source: "fig 6-6(d, e)",
        says: "feedback reduces the pitch disturbance's peak 13 times; the feedforward removes most of the rest",
        measured: format!(
            "{by_feedback:.1} times by feedback at {hz} Hz, a further {by_both:.0} times by feedforward"
        ),
        finding: Finding::holds_or(by_feedback >= 10.0 && by_both >= 2.0, &why),
    })
}

/// The frequency at which feedback reduces pitch by a factor, Hz; NaN where it does nowhere.
fn frequency_of_factor(bench: &Bench<'_>, factor: f64) -> f64 {
    let curves = &bench.designed.verified.verification().evidence.curves;
    let response = |arrangement| {
        curves
            .rejection
            .iter()
            .find(|r| (r.source, r.arrangement) == (Source::Pitch, arrangement))
            .map(|r| &r.response)
    };
    let (Some(none), Some(feedback)) = (response(Arrangement::Uncontrolled), response(Arrangement::Feedback))
    else {
        return f64::NAN;
    };
    let below = (0..none.len()).find(|&k| none[k].norm() / feedback[k].norm() < factor);
    below.map_or(f64::NAN, |k| curves.frequency_hz[k])
}

/// C7: heave.
///
/// # Errors
/// None beyond the bench's.
pub fn c7(bench: &Bench<'_>) -> Result<Claim, PipelineError> {
    let rms = |arrangement| bench.value(hub(Source::Heave, arrangement, Quantity::HubRms));
    let ratio = rms(Arrangement::Feedback) / rms(Arrangement::Compensated);
    Ok(Claim {
        id: "C7",
        source: "fig 6-6(b, c)",
        says: "the heave feedforward almost removes the heave disturbance",
        measured: format!(
            "RMS hub rate {ratio:.0} times smaller with it, at {} Hz",
            bench.procedure.heave.frequency_hz
        ),
        finding: Finding::of(ratio >= 10.0),
    })
}
