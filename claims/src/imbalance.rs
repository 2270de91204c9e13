//! Claims on an out-of-balance that is not as designed.

use counterpoise_controller::Controller;
use counterpoise_lti::StateSpace;
use counterpoise_models::{Configuration, Parameters};
use counterpoise_verify::{Arrangement, Experiment, Figure, Model, Quantity, Source, StepFigure};

use super::bench::{Member, largest_db, rates};
use super::picture::{Axis, Curve, Panel, Picture, gain_db, hub_from, hub_panel};
use super::{Bench, Claim, Finding};
use counterpoise_pipeline::PipelineError;

/// Band in which controllers are compared, Hz.
const BAND_HZ: (f64, f64) = (0.1, 10.0);

pub(super) fn configured(bench: &Bench<'_>, name: &str) -> Result<Option<Parameters>, PipelineError> {
    let found: Option<&Configuration> = bench.parameters().configurations.iter().find(|c| c.name == name);
    Ok(found.map(|configuration| bench.parameters().configured(configuration)).transpose()?)
}

fn moment(parameters: &Parameters) -> f64 {
    parameters.lumped.as_ref().map_or(f64::NAN, |lumped| lumped.out_of_balance_kg_m)
}

pub(super) fn rms(source: Source, arrangement: Arrangement) -> Figure {
    Figure::Disturbance(Model::Nonlinear, source, arrangement, Quantity::HubRms)
}

/// Table 4-1's configurations with another out-of-balance, the balanced one apart.
const CONFIGURATIONS: [&str; 3] = ["37 percent", "75 percent", "148 percent"];

fn normal_member<'a>(bench: &'a Bench<'_>) -> Member<'a> {
    Member { name: "normal".to_owned(), parameters: bench.parameters().clone(), controller: &bench.observed }
}

/// C13: other masses, the same controller.
///
/// # Errors
/// Those of the verification.
pub fn c13(bench: &Bench<'_>) -> Result<Claim, PipelineError> {
    let wanted = [
        Figure::Step(Model::Nonlinear, StepFigure::Overshoot),
        rms(Source::Both, Arrangement::Feedback),
        rms(Source::Both, Arrangement::Compensated),
    ];
    let normal = bench.figures(bench.parameters(), &bench.observed, &wanted)?;
    let plain = bench.figures(bench.parameters(), bench.controller(), &wanted[2..])?[0];
    let (mut words, mut step_same, mut degraded) = (Vec::new(), true, Vec::new());
    let mut members = vec![normal_member(bench)];
    for name in CONFIGURATIONS {
        let Some(parameters) = configured(bench, name)? else { continue };
        members.push(Member {
            name: name.to_owned(),
            parameters: parameters.clone(),
            controller: &bench.observed,
        });
        let found = bench.figures(&parameters, &bench.observed, &wanted)?;
        step_same &= (found[0] - normal[0]).abs() < 3.0;
        degraded.push(found[2] / normal[2]);
        let (feedback, both) = (found[1] / normal[1], found[2] / normal[2]);
        let without = bench.figures(&parameters, bench.controller(), &wanted[2..])?[0] / plain;
        words.push(format!(
            "{name}: overshoot {:.1} %, error x{feedback:.2} by feedback, x{both:.1} compensated (x{without:.1} without friction observer)",
            found[0]
        ));
    }
    Ok(Claim {
        id: "C13",
        title: "another out-of-balance",
        source: "fig 6-9(j-l)",
        says: "a changed out-of-balance leaves the step alone, scales the error without feedforward, degrades the compensated error 5 times (more) and 4 times (less)",
        measured: format!(
            "normal: overshoot {:.1} %, compensated error {:.2} mrad/s; {}",
            normal[0],
            1e3 * normal[2],
            words.join("; ")
        ),
        finding: c13_finding(bench, (step_same, &degraded), 1e3 * normal[2]),
        pictures: c13_pictures(bench, &members)?,
    })
}

/// By how much the thesis' compensated error grows, at the most; a rig's grows as much where it is within twice that.
const GROWS: f64 = 5.0;

fn c13_finding(bench: &Bench<'_>, (step_same, degraded): (bool, &[f64]), normal_mrad_s: f64) -> Finding {
    let linear = Figure::Disturbance(Model::Linear, Source::Both, Arrangement::Compensated, Quantity::HubRms);
    let least = degraded.iter().copied().fold(f64::INFINITY, f64::min);
    let most = degraded.iter().copied().fold(0.0, f64::max);
    let why = match (step_same, least > 2.0) {
        (false, _) => "the masses also change the inertia, and with it the overshoot".to_owned(),
        (true, false) => {
            "friction, not the heave torque, sets the compensated error of some configurations".to_owned()
        }
        (true, true) if most <= 2.0 * GROWS => return Finding::Holds,
        (true, true) => format!(
            "the step stays, the error by feedback scales and the compensated error grows, as claimed, but by more than 5 times: what is left in the normal configuration is smaller here ({normal_mrad_s:.2} mrad/s, {:.2} on the linear plant), so the same change of torque is a larger multiple of it",
            1e3 * bench.value(linear)
        ),
    };
    Finding::Differs { why }
}

/// The step, and heave and pitch by feedback alone and with both feedforwards, in every configuration.
fn c13_pictures(bench: &Bench<'_>, members: &[Member<'_>]) -> Result<Vec<Picture>, PipelineError> {
    let mut panels = Vec::new();
    for arrangement in [Arrangement::Feedback, Arrangement::Compensated] {
        let mut curves = Vec::new();
        for member in members {
            let experiment = Experiment::Disturbance(Source::Both, arrangement);
            let history = bench.history(&member.parameters, member.controller, experiment)?;
            curves.push(Curve::line(member.name.clone(), hub_from(&history, bench.procedure.settle_s)));
        }
        panels.push(hub_panel(curves));
    }
    let heave = Picture::new("Heave and pitch in each configuration", Axis::time(), panels)
        .captioned("Above by feedback alone, below with the feedforwards of the normal configuration.");
    let mut all = bench.family_pictures("each configuration", members)?;
    all.truncate(1);
    all.push(heave);
    Ok(all)
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
    let mut designs = vec![(1.0, bench.controller().clone())];
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
        designs.push((factor, controller.clone()));
    }
    Ok(Claim {
        id: "C14",
        title: "redesign for each",
        source: "fig 6-10",
        says: "redesigning for each out-of-balance changes the heave feedforward's gain alone, and restores the error",
        measured: words.join("; "),
        finding: Finding::of(holds),
        pictures: vec![controllers(&designs)?],
    })
}

/// The three paths of each design over frequency.
fn controllers(designs: &[(f64, Controller)]) -> Result<Picture, PipelineError> {
    let drawn = rates((0.1, 50.0));
    let mut panels = Vec::new();
    for (input, name) in [(1, "feedback"), (3, "heave feedforward"), (2, "pitch feedforward")] {
        let mut curves = Vec::new();
        for (factor, controller) in designs {
            let points = gain_db(&linear(controller)?, (0, input), &drawn)?;
            curves.push(Curve::line(format!("out-of-balance x{factor}"), points));
        }
        panels.push(Panel::of(Axis::even(name, "dB"), curves));
    }
    Ok(Picture::new("Redesigned for each out-of-balance", Axis::frequency(), panels)
        .captioned("Curves that cannot be told apart lie on each other."))
}

fn linear(c: &Controller) -> Result<StateSpace, PipelineError> {
    Ok(c.linear(c.parts().design_out_of_balance_kg_m).map_err(counterpoise_verify::Error::from)?)
}

/// Largest change in dB of the paths from hub gyro, accelerometer and platform gyro.
fn three_changes(a: &Controller, b: &Controller) -> Result<[f64; 3], PipelineError> {
    let (x, y) = (linear(a)?, linear(b)?);
    Ok([largest_db(&x, &y, 1, BAND_HZ)?, largest_db(&x, &y, 3, BAND_HZ)?, largest_db(&x, &y, 2, BAND_HZ)?])
}
