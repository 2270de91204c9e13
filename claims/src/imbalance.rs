//! Claims on an out-of-balance that is not as designed.

use counterpoise_controller::Controller;
use counterpoise_lti::StateSpace;
use counterpoise_models::plant::OperatingPoint;
use counterpoise_models::{Configuration, Parameters};
use counterpoise_report::wording::code_header::HeaderText;
use counterpoise_verify::{Arrangement, Experiment, Model, PerformanceFigure, Quantity, Source, StepFigure};

use super::drawing::{
    ClaimCurve, frequency_axis, gain_db, hub_from, hub_panel, make_figure, make_panel, time_axis,
};
use super::tested_design::{DrawnMechanism, largest_db, rate_grid};
use super::{Claim, Criterion, TestedDesign};
use counterpoise_pipeline::{PipelineError, run_stages};
use counterpoise_plot::{Axis, Figure as Drawing, Point};

/// Band in which controllers are compared, Hz.
const BAND_HZ: [f64; 2] = [0.1, 10.0];

pub(super) fn apply_configuration(
    tested: &TestedDesign<'_>,
    name: &str,
) -> Result<Option<Parameters>, PipelineError> {
    let found: Option<&Configuration> = tested.parameters().configurations.iter().find(|c| c.name == name);
    Ok(found.map(|configuration| tested.parameters().with_configuration(configuration)).transpose()?)
}

fn moment(parameters: &Parameters) -> f64 {
    parameters.lumped.as_ref().map_or(f64::NAN, |lumped| lumped.out_of_balance_kg_m)
}

pub(super) fn rms(source: Source, arrangement: Arrangement) -> PerformanceFigure {
    PerformanceFigure::Disturbance(Model::Nonlinear, source, arrangement, Quantity::HubRms)
}

/// Table 4-1's configurations with another out-of-balance, the balanced one apart.
const CONFIGURATIONS: [&str; 3] = ["37 percent", "75 percent", "148 percent"];

fn normal_member<'a>(tested: &'a TestedDesign<'_>) -> DrawnMechanism<'a> {
    DrawnMechanism {
        name: "normal".to_owned(),
        parameters: tested.parameters().clone(),
        controller: &tested.observed,
    }
}

/// Returns row C13: other masses, the same controller.
///
/// # Errors
/// Those of the verification.
pub fn other_imbalance(tested: &TestedDesign<'_>) -> Result<Claim, PipelineError> {
    let wanted = [
        PerformanceFigure::Step(Model::Nonlinear, StepFigure::Overshoot),
        rms(Source::Both, Arrangement::Feedback),
        rms(Source::Both, Arrangement::Compensated),
    ];
    let normal = tested.figures(tested.parameters(), &tested.observed, &wanted)?;
    let plain = tested.figures(tested.parameters(), tested.controller(), &wanted[2..])?[0];
    let heave = tested.figures(
        tested.parameters(),
        &tested.observed,
        &[rms(Source::Heave, Arrangement::Feedback)],
    )?[0];
    let (mut words, mut criteria) = (Vec::new(), Vec::new());
    let mut members = vec![normal_member(tested)];
    for name in CONFIGURATIONS {
        let Some(parameters) = apply_configuration(tested, name)? else { continue };
        members.push(DrawnMechanism {
            name: name.to_owned(),
            parameters: parameters.clone(),
            controller: &tested.observed,
        });
        let found = tested.figures(&parameters, &tested.observed, &wanted)?;
        let share = moment(&parameters) / moment(tested.parameters());
        let expected = predicted_growth(share, heave, normal[2]);
        let thesis = GROWS[usize::from(share < 1.0)];
        criteria.extend(imbalance_criteria(
            name,
            thesis,
            expected,
            [found[0] - normal[0], found[2] / normal[2]],
        ));
        let (feedback, both) = (found[1] / normal[1], found[2] / normal[2]);
        let without = tested.figures(&parameters, tested.controller(), &wanted[2..])?[0] / plain;
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
        criteria,
        why: format!(
            "what the feedforward of the normal configuration leaves is the changed part of the heave torque, which the feedback alone would leave at {:.2} mrad/s; beside it, what is left in the normal configuration is small here ({:.2} mrad/s), so that the same change of torque is a larger multiple of it",
            1e3 * heave,
            1e3 * normal[2]
        ),
        drawings: other_imbalance_figures(tested, &members)?,
    })
}

/// Returns what is asked of a configuration: the change of the overshoot, in percentage points, and the growth of the compensated error.
fn imbalance_criteria(
    name: &str,
    thesis: f64,
    expected: f64,
    [overshoot, growth]: [f64; 2],
) -> [Criterion; 2] {
    [
        Criterion::at_most(
            &format!("{name}: change of the overshoot, percentage points"),
            "leaves the step alone",
            overshoot.abs(),
            3.0,
            "the masses also change the inertia by up to a tenth",
        ),
        Criterion::with_range(
            &format!("{name}: compensated error over the normal"),
            &format!("{thesis}"),
            growth,
            [0.5 * thesis, 2.0 * thesis],
            "a factor of two: the ratio has the rig's own normal error below it",
        )
        .with_explained_range(0.7 * expected, 1.3 * expected),
    ]
}

/// By how much the thesis' compensated error grows at more and at less out-of-balance.
const GROWS: [f64; 2] = [5.0, 4.0];

/// Returns the compensated error of a configuration, as predicted: the heave feedforward of the normal out-of-balance leaves the part of
/// the heave torque that has changed to the feedback, which adds to what is left in the normal configuration.
fn predicted_growth(share: f64, heave_by_feedback: f64, normal: f64) -> f64 {
    (1.0 + ((share - 1.0) * heave_by_feedback / normal).powi(2)).sqrt()
}

/// Row C14: all conditions together, and the out-of-balance alone.
struct RedesignRow {
    words: String,
    factor: f64,
    controller: Controller,
    criteria: Vec<Criterion>,
}

/// Returns the step, and heave and pitch by feedback alone and with both feedforwards, in every
/// configuration.
fn other_imbalance_figures(
    tested: &TestedDesign<'_>,
    members: &[DrawnMechanism<'_>],
) -> Result<Vec<Drawing>, PipelineError> {
    let mut panels = Vec::new();
    for arrangement in [Arrangement::Feedback, Arrangement::Compensated] {
        let mut curves = Vec::new();
        for member in members {
            let experiment = Experiment::Disturbance(Source::Both, arrangement);
            let history = tested.history(&member.parameters, member.controller, experiment)?;
            curves.push(ClaimCurve::line(member.name.clone(), hub_from(&history, tested.procedure.settle_s)));
        }
        panels.push(hub_panel(curves));
    }
    let heave = make_figure("Heave and pitch in each configuration", time_axis(), panels)
        .with_caption("Above by feedback alone, below with the feedforwards of the normal configuration.");
    let mut all = tested.family_drawings("each configuration", members)?;
    all.truncate(1);
    all.push(heave);
    Ok(all)
}

/// Returns row C14: a design for each out-of-balance.
///
/// # Errors
/// Those of the pipeline.
pub fn redesigned_for_imbalance(tested: &TestedDesign<'_>) -> Result<Claim, PipelineError> {
    let mut all = Vec::new();
    for factor in [0.37, 1.48] {
        let mut parameters = tested.parameters().clone();
        parameters.lumped.iter_mut().for_each(|lumped| lumped.out_of_balance_kg_m *= factor);
        all.push(redesign_for(
            tested,
            &format!("out-of-balance x{factor} alone"),
            &parameters,
            Source::Heave,
        )?);
    }
    for name in CONFIGURATIONS {
        let Some(parameters) = apply_configuration(tested, name)? else { continue };
        all.push(redesign_for(tested, name, &parameters, Source::Both)?);
    }
    let words: Vec<&str> = all.iter().map(|one| one.words.as_str()).collect();
    let mut designs = vec![UnbalancedDesign { factor: 1.0, controller: tested.observed.clone() }];
    designs.extend(
        all.iter().map(|one| UnbalancedDesign { factor: one.factor, controller: one.controller.clone() }),
    );
    Ok(Claim {
        id: "C14",
        title: "redesign for each",
        source: "fig 6-10",
        says: "redesigning for each out-of-balance changes the heave feedforward's gain alone, and restores the error",
        measured: words.join("; "),
        drawings: vec![controllers(&designs)?],
        criteria: all.into_iter().flat_map(|one| one.criteria).collect(),
        why: "the masses of a configuration also change the inertia, which feedback and pitch feedforward follow in proportion; with the out-of-balance changed alone they stay".to_owned(),
    })
}

/// Returns a design for another mechanism, beside the normal one.
fn redesign_for(
    tested: &TestedDesign<'_>,
    name: &str,
    parameters: &Parameters,
    source: Source,
) -> Result<RedesignRow, PipelineError> {
    let mut project = tested.observing_project.clone();
    project.plant = parameters.clone();
    project.model.configuration = None;
    project.verify.iter_mut().for_each(|verify| verify.road = None);
    let other = run_stages(&project, &HeaderText, tested.world)?;
    let controller = other.verified.controller();
    let changes = three_changes(&tested.observed, controller)?;
    let residual = [rms(source, Arrangement::Compensated)];
    let standard = tested.figures(tested.parameters(), &tested.observed, &residual)?[0];
    let after = tested.figures(parameters, controller, &residual)?[0] / standard;
    let factor = moment(parameters) / moment(tested.parameters());
    let inertia =
        |p: &Parameters| p.lumped.as_ref().map_or(f64::NAN, |l| l.hub_inertia_kg_m2 + l.beam_inertia_kg_m2);
    let law = 20.0 * factor.log10().abs();
    let by_inertia = 20.0 * (inertia(parameters) / inertia(tested.parameters())).log10().abs();
    let stays = |what: &str, db: f64| {
        Criterion::at_most(
            &format!("{name}: change of the {what}, dB"),
            "unchanged",
            db,
            0.5,
            "half a decibel cannot be seen in the figure",
        )
        .with_explained_range(0.5, 2.0 * by_inertia + 0.5)
    };
    let criteria = vec![
        stays("feedback", changes[0]),
        stays("pitch feedforward", changes[2]),
        Criterion::with_range(
            &format!("{name}: change of the heave feedforward, dB"),
            &format!("{law:.2} by the gain law"),
            changes[1],
            [law - 0.5, law + 0.5],
            "half a decibel cannot be seen in the figure",
        )
        .with_explained_range(law - 2.0 * by_inertia - 0.5, law + 2.0 * by_inertia + 0.5),
        Criterion::at_most(
            &format!("{name}: error after the redesign over the normal"),
            "restored",
            after,
            1.5,
            "less than half more is left",
        ),
    ];
    let words = format!(
        "{name}: feedback {:.2} dB, pitch {:.2} dB, heave {:.2} dB (its gain law says {law:.2}), error x{after:.2}",
        changes[0], changes[2], changes[1]
    );
    Ok(RedesignRow { words, factor, controller: controller.clone(), criteria })
}

/// The controller that was designed for an out-of-balance.
struct UnbalancedDesign {
    /// The out-of-balance over its normal value.
    factor: f64,
    controller: Controller,
}

/// Returns the three paths of each design over frequency.
fn controllers(designs: &[UnbalancedDesign]) -> Result<Drawing, PipelineError> {
    let drawn = rate_grid([0.1, 50.0]);
    let mut panels = Vec::new();
    for (input, name) in [(1, "feedback"), (3, "heave feedforward"), (2, "pitch feedforward")] {
        let mut curves = Vec::new();
        for UnbalancedDesign { factor, controller } in designs {
            let points = gain_db(&linear(controller)?, input, &drawn)?;
            curves.push(ClaimCurve::line(format!("out-of-balance x{factor}"), points));
        }
        panels.push(make_panel(Axis::linear(name, "dB"), curves));
    }
    Ok(make_figure("Redesigned for each out-of-balance", frequency_axis(), panels)
        .with_caption("Curves that cannot be distinguished lie on each other."))
}

fn linear(c: &Controller) -> Result<StateSpace, PipelineError> {
    Ok(c.linear(c.parts().design_out_of_balance_kg_m).map_err(counterpoise_verify::Error::from)?)
}

/// Returns the largest change in dB of the paths from hub gyro, accelerometer and platform gyro.
fn three_changes(a: &Controller, b: &Controller) -> Result<[f64; 3], PipelineError> {
    let (x, y) = (linear(a)?, linear(b)?);
    Ok([largest_db(&x, &y, 1, BAND_HZ)?, largest_db(&x, &y, 3, BAND_HZ)?, largest_db(&x, &y, 2, BAND_HZ)?])
}

/// Angles of the hub at which the holding control is compared with its law, degrees.
const ELEVATIONS_DEG: [f64; 5] = [0.0, 15.0, 30.0, 45.0, 60.0];

/// Returns row C31: the weight over elevation.
///
/// # Errors
/// A plant that does not exist.
pub fn gravity_over_elevation(tested: &TestedDesign<'_>) -> Result<Claim, PipelineError> {
    let plant = &tested.designed.modelled.plant;
    let at = |deg: f64| {
        let point = OperatingPoint { hub_angle_rad: deg.to_radians(), ..tested.procedure.operating_point };
        plant.equilibrium(&point).drive_v
    };
    let level = at(0.0);
    let parameters = plant.parameters();
    let above = parameters
        .lumped
        .as_ref()
        .map_or(0.0, |lumped| lumped.vertical_offset_kg_m / lumped.out_of_balance_kg_m);
    let law = |deg: f64| deg.to_radians().cos() - above * deg.to_radians().sin();
    let off = |deg: &f64| (at(*deg) / level - law(*deg)).abs();
    let worst = ELEVATIONS_DEG.iter().map(off).fold(0.0, f64::max);
    let words: Vec<String> =
        ELEVATIONS_DEG.iter().map(|deg| format!("{deg} deg {:.3} V", at(*deg))).collect();
    let curves = vec![
        ClaimCurve::points("plant", ELEVATIONS_DEG.iter().map(|deg| Point::new(*deg, at(*deg))).collect()),
        ClaimCurve::reference(
            "cosine law",
            (0..=60).map(|deg| Point::new(f64::from(deg), level * law(f64::from(deg)))).collect(),
        ),
    ];
    Ok(Claim {
        id: "C31",
        title: "gravity over elevation",
        source: "5.2, 9.2",
        says: "the torque of gravity on the out-of-balance follows the cosine of the elevation, so that the holding control can be scheduled over it",
        measured: format!(
            "drive that holds the weight: {}; off from the law by {worst:.1e} of its value at level",
            words.join(", ")
        ),
        criteria: vec![
            Criterion::at_most(
                "largest deviation from the cosine law, relative",
                "cosine",
                worst,
                1e-3,
                "a plane mechanism with its centre of mass on the beam has no other term",
            ),
            Criterion::with_range(
                "holding drive at 60 deg over that at level",
                "0.5",
                at(60.0) / level,
                [0.45, 0.55],
                "the cosine of 60 degrees, with a tenth for the height of the centre of mass",
            ),
        ],
        why: String::new(),
        drawings: vec![make_figure(
            "Drive that holds the weight",
            Axis::linear("elevation", "deg"),
            vec![make_panel(Axis::linear("drive", "V"), curves)],
        )],
    })
}
