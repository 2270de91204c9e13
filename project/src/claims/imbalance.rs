//! Claims on an out-of-balance that is not as designed.

use counterpoise_controller::Controller;
use counterpoise_lti::StateSpace;
use counterpoise_models::{Configuration, Parameters};
use counterpoise_verify::linear::closed::is_feedforward;
use counterpoise_verify::{Arrangement, Figure, Model, Quantity, Source, StepFigure};

use super::bench::largest_db;
use super::{Bench, Claim, Finding};
use crate::pipeline::PipelineError;

/// Band in which controllers are compared, Hz.
const BAND_HZ: (f64, f64) = (0.1, 10.0);

fn configured(bench: &Bench<'_>, name: &str) -> Result<Option<Parameters>, PipelineError> {
    let found: Option<&Configuration> = bench.parameters().configurations.iter().find(|c| c.name == name);
    Ok(found.map(|configuration| bench.parameters().configured(configuration)).transpose()?)
}

fn moment(parameters: &Parameters) -> f64 {
    parameters.lumped.as_ref().map_or(f64::NAN, |lumped| lumped.out_of_balance_kg_m)
}

fn rms(source: Source, arrangement: Arrangement) -> Figure {
    Figure::Disturbance(Model::Nonlinear, source, arrangement, Quantity::HubRms)
}

/// C13: other masses, the same controller.
///
/// # Errors
/// Those of the verification.
pub fn c13(bench: &Bench<'_>) -> Result<Claim, PipelineError> {
    let wanted = [
        Figure::Step(Model::Nonlinear, StepFigure::Overshoot),
        rms(Source::Heave, Arrangement::Feedback),
        rms(Source::Heave, Arrangement::Compensated),
    ];
    let normal = bench.figures(bench.parameters(), &bench.observed, &wanted)?;
    let (mut words, mut step_same, mut degraded) = (Vec::new(), true, true);
    for name in ["37 percent", "75 percent", "148 percent"] {
        let Some(parameters) = configured(bench, name)? else { continue };
        let found = bench.figures(&parameters, &bench.observed, &wanted)?;
        step_same &= (found[0] - normal[0]).abs() < 3.0;
        degraded &= found[2] > 2.0 * normal[2];
        let (feedback, both) = (found[1] / normal[1], found[2] / normal[2]);
        words.push(format!(
            "{name}: overshoot {:.1} %, error x{feedback:.2} by feedback, x{both:.1} compensated",
            found[0]
        ));
    }
    Ok(Claim {
        id: "C13",
        source: "fig 6-9(j-l)",
        says: "a changed out-of-balance leaves the step alone, scales the error without feedforward, degrades the compensated error 5 times (more) and 4 times (less)",
        measured: format!("normal: overshoot {:.1} %; {}", normal[0], words.join("; ")),
        finding: match (step_same, degraded) {
            (true, true) => Finding::Holds,
            (false, true) => Finding::Differs {
                why: "the masses also change the inertia, and with it the overshoot".to_owned(),
            },
            (_, false) => Finding::Differs {
                why: "friction, not the heave torque, sets the compensated error of some configurations"
                    .to_owned(),
            },
        },
    })
}

/// C14: a design for each out-of-balance.
///
/// # Errors
/// Those of the pipeline.
pub fn c14(bench: &Bench<'_>) -> Result<Claim, PipelineError> {
    let nominal = moment(bench.parameters());
    let residual = rms(Source::Heave, Arrangement::Compensated);
    let standard = bench.figures(bench.parameters(), bench.controller(), &[residual])?[0];
    let (mut words, mut holds) = (Vec::new(), true);
    for factor in [0.37, 1.48] {
        let mut parameters = bench.parameters().clone();
        parameters.lumped.iter_mut().for_each(|lumped| lumped.out_of_balance_kg_m = factor * nominal);
        let other = bench.redesign(|project| {
            project.plant = parameters.clone();
            project.model.configuration = None;
        })?;
        let controller = other.verified.controller();
        let changes = three_changes(bench.controller(), controller)?;
        let after = bench.figures(&parameters, controller, &[residual])?[0] / standard;
        let law = 20.0 * factor.log10().abs();
        holds &= changes[0] < 0.5 && changes[2] < 0.5 && (changes[1] - law).abs() < 0.5 && after < 1.5;
        words.push(format!(
            "at {factor}x: feedback {:.2} dB, pitch {:.2} dB, heave {:.2} dB (its gain law says {law:.2}), error x{after:.2}",
            changes[0], changes[2], changes[1]
        ));
    }
    Ok(Claim {
        id: "C14",
        source: "fig 6-10",
        says: "redesigning for each out-of-balance changes the heave feedforward's gain alone, and restores the error",
        measured: words.join("; "),
        finding: Finding::of(holds),
    })
}

/// Largest change in dB of the paths from hub gyro, accelerometer and platform gyro.
fn three_changes(a: &Controller, b: &Controller) -> Result<[f64; 3], PipelineError> {
    let linear = |c: &Controller| -> Result<StateSpace, PipelineError> {
        Ok(c.linear(c.parts().design_out_of_balance_kg_m).map_err(counterpoise_verify::Error::from)?)
    };
    let (x, y) = (linear(a)?, linear(b)?);
    Ok([largest_db(&x, &y, 1, BAND_HZ)?, largest_db(&x, &y, 3, BAND_HZ)?, largest_db(&x, &y, 2, BAND_HZ)?])
}

/// C22: out of balance with feedforward is as good as balanced.
///
/// # Errors
/// Those of the verification.
pub fn c22(bench: &Bench<'_>) -> Result<Claim, PipelineError> {
    let source = if bench.procedure.road.is_some() { Source::Road } else { Source::Both };
    let residual = [rms(source, Arrangement::Compensated)];
    let says = "out of balance with both feedforwards is stabilised as well as balanced; on the balanced plant that heave feedforward makes things worse";
    let Some(balanced) = configured(bench, "balanced")? else {
        let finding = Finding::NotMeasured { why: "the project has no configuration \"balanced\"" };
        return Ok(Claim {
            id: "C22",
            source: "7.4.2, figs 7-15, 7-16",
            says,
            measured: String::new(),
            finding,
        });
    };
    let pitch_only = without_heave(&bench.observed)?;
    let out_of_balance = 1e3 * bench.figures(bench.parameters(), &bench.observed, &residual)?[0];
    let alone = 1e3 * bench.figures(bench.parameters(), &pitch_only, &residual)?[0];
    let level = 1e3 * bench.figures(&balanced, &pitch_only, &residual)?[0];
    let wrong = 1e3 * bench.figures(&balanced, &bench.observed, &residual)?[0];
    let (as_well, worse) = (out_of_balance < 1.3 * level, wrong > 1.1 * level);
    Ok(Claim {
        id: "C22",
        source: "7.4.2, figs 7-15, 7-16",
        says,
        measured: format!(
            "RMS hub rate on the {}: out of balance {out_of_balance:.2} mrad/s with both ({alone:.2} with pitch alone); balanced {level:.2} with pitch alone, {wrong:.2} with both",
            if source == Source::Road { "road" } else { "sines" }
        ),
        finding: match (as_well, worse) {
            (true, true) => Finding::Holds,
            (false, true) => {
                Finding::Differs { why: "the balanced plant is quieter; the rest is as claimed".to_owned() }
            }
            _ => Finding::Fails,
        },
    })
}

/// The controller without the path that sees the accelerometer.
fn without_heave(controller: &Controller) -> Result<Controller, PipelineError> {
    let heave = counterpoise_controller::Signal::PlatformAcceleration;
    let kept = controller
        .with(|parts| parts.paths.retain(|path| !(is_feedforward(path) && path.inputs.contains(&heave))));
    Ok(kept.map_err(counterpoise_verify::Error::from)?)
}
