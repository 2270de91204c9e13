//! The `[verify]` section: what is done to the loop, and the limits that its figures must keep.

use counterpoise_models::{AxisKind, ControlledQuantity};
use counterpoise_verify::{
    Coincidence, Limit as Bound, LineOfSight, LoopFigure, Optics, PerformanceFigure, Procedure, Requirement,
    Sine, Step, Triangle,
};

use super::figure_names::figure_hint;
use super::model::PlantSelection;
use super::platform::{self, PlatformSource};
use super::seed::seed;
use crate::file::field::{Field, NumberRange, TableField};
use crate::file::visit::{Count, Visit, list, maybe_number, table, visit_optional};
use crate::tolerance::MOST_UNSTATED_SAMPLES;

/// Procedure and requirements of a verification.
#[derive(Debug, Clone, PartialEq)]
pub struct VerificationOptions {
    /// The procedure; operating point and friction are those of the model, and the road is still to be read.
    pub procedure: Procedure,
    /// Source of the size of the step of the demand.
    pub step_size: StepSize,
    /// Source of the platform's motion on a road.
    pub road: Option<PlatformSource>,
    /// Figures with their limits.
    pub requirements: Vec<Requirement>,
}

/// Source of the size of the step of the demand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StepSize {
    /// The file states it: a first design takes such a step within the control's limit.
    Stated,
    /// The file states none: it is the usual one, which limits no first design.
    Usual,
}

const ABOVE_0: NumberRange = NumberRange::Above(0.0);
const AT_LEAST_0: NumberRange = NumberRange::AtLeast(0.0);

/// Returns the usual procedure of a loop with a sample period: shorter runs if the samples are quick.
fn usual_procedure(sample_period_s: f64) -> Procedure {
    let usual = Procedure::default();
    let share = (MOST_UNSTATED_SAMPLES * sample_period_s / usual.duration_s).min(1.0);
    Procedure {
        duration_s: share * usual.duration_s,
        settle_s: share * usual.settle_s,
        step: Step { duration_s: share * usual.step.duration_s, ..usual.step },
        ..usual
    }
}

/// Returns a verification of which nothing is written: the usual procedure without requirements.
pub(crate) fn blank_options(sample_period_s: f64) -> VerificationOptions {
    VerificationOptions {
        procedure: usual_procedure(sample_period_s),
        step_size: StepSize::Usual,
        road: None,
        requirements: Vec::new(),
    }
}

/// Returns what is verified where a file has no section for it: the usual procedure where the model stands.
pub(crate) fn usual_verification(model: &PlantSelection, sample_period_s: f64) -> VerificationOptions {
    let mut verification = blank_options(sample_period_s);
    verification.procedure.operating_point = model.operating_point;
    verification.procedure.friction = model.friction;
    verification
}

/// Reads or lists the verification of a loop.
pub(crate) fn verify(
    v: &mut dyn Visit,
    verification: &mut VerificationOptions,
    controlled: ControlledQuantity,
    axis: AxisKind,
    sample_period_s: f64,
) {
    let usual = usual_procedure(sample_period_s);
    let procedure = &mut verification.procedure;
    let duration =
        Field::new("duration", "length of the runs with heave and with pitch").unit("s").limit(ABOVE_0);
    v.number(&duration.or(usual.duration_s).show_default(), &mut procedure.duration_s);
    let settle = Field::new("settle", "time at the beginning that is left out of statistics")
        .unit("s")
        .limit(AT_LEAST_0);
    v.number(&settle.or(usual.settle_s).show_default(), &mut procedure.settle_s);
    if procedure.settle_s >= procedure.duration_s {
        v.complain("settle", &format!("must be below the duration of {} s", procedure.duration_s), None);
    }
    seed(v, "seed of the sensor noise", &mut procedure.seed);
    rejection(v, &mut procedure.rejection_hz);
    let step_size = &mut verification.step_size;
    table(v, &TableField::optional("step", "a step of the demand"), &mut procedure.step, |v, s| {
        step(v, s, step_size, StepDefaults { unit: controlled.unit(), usual: usual.step })
    });
    visit_optional(
        v,
        &TableField::optional("triangle", "a triangle of the demand, which shows friction at its reversals"),
        &mut procedure.triangle,
        TRIANGLE,
        |v, t| triangle(v, t, controlled.unit()),
    );
    table(v, &TableField::optional("heave", "sine of heave"), &mut procedure.heave, |v, s| {
        sine(v, s, usual.heave, "m/s^2")
    });
    table(v, &TableField::optional("pitch", meaning_of_pitch(axis)), &mut procedure.pitch, |v, s| {
        sine(v, s, usual.pitch, axis.unit("rad/s"))
    });
    visit_optional(
        v,
        &TableField::optional(
            "road",
            "motion of the platform: recorded, from a spectrum, on a motion simulator, or over a road",
        ),
        &mut verification.road,
        platform::blank_source(),
        platform::platform,
    );
    visit_optional(
        v,
        &TableField::optional("line_of_sight", "error of the line of sight and what it is made of"),
        &mut verification.procedure.line_of_sight,
        LineOfSight::default(),
        line_of_sight,
    );
    requirements(v, &mut verification.requirements, controlled);
}

fn meaning_of_pitch(axis: AxisKind) -> &'static str {
    match axis {
        AxisKind::Rotary => "sine of the pitch rate",
        AxisKind::Linear => "sine of the speed of the base along the slide",
    }
}

fn line_of_sight(v: &mut dyn Visit, sight: &mut LineOfSight) {
    let exposure = Field::new("exposure", "length of one exposure, within which jitter blurs").unit("s");
    v.number(
        &exposure.limit(ABOVE_0).or(LineOfSight::default().exposure_s).show_default(),
        &mut sight.exposure_s,
    );
    let settle = "time at the beginning that the line of sight leaves out; that of [verify] if absent";
    maybe_number(v, &Field::new("settle", settle).unit("s").limit(AT_LEAST_0), &mut sight.settle_s);
    visit_optional(
        v,
        &TableField::optional("coincidence", "window within which a shot is released, and its target"),
        &mut sight.coincidence,
        Coincidence::default(),
        coincidence,
    );
    visit_optional(
        v,
        &TableField::optional("optics", "sight whose image the motion blurs"),
        &mut sight.optics,
        Optics::default(),
        optics,
    );
}

fn coincidence(v: &mut dyn Visit, asked: &mut Coincidence) {
    let window = Field::new("window", "largest error of the hub at which a shot is released").unit("rad");
    v.number(&window.limit(ABOVE_0), &mut asked.window_rad);
    let delay = Field::new("delay", "time from the release to the instant at which the shot leaves the tip");
    v.number(&delay.unit("s").limit(AT_LEAST_0).or(0.0).show_default(), &mut asked.delay_s);
    let target = Field::new(
        "target",
        "largest error of the tip that hits: half the target's height over its distance",
    );
    v.number(&target.unit("rad").limit(ABOVE_0), &mut asked.target_rad);
    let dispersion = Field::new("dispersion", "RMS angle of the rounds about the direction of the tip");
    v.number(&dispersion.unit("rad").limit(AT_LEAST_0).or(0.0).show_default(), &mut asked.dispersion_rad);
}

fn optics(v: &mut dyn Visit, optics: &mut Optics) {
    v.number(
        &Field::new("focal_length", "focal length").unit("m").limit(ABOVE_0),
        &mut optics.focal_length_m,
    );
    let detail = "spatial frequency in the image at which the loss is stated, in periods; 1/2 over the pitch of the pixels is the finest that they resolve";
    v.number(
        &Field::new("spatial_frequency", detail).unit("1/m").limit(ABOVE_0),
        &mut optics.spatial_frequency_m,
    );
}

fn rejection(v: &mut dyn Visit, frequencies: &mut Vec<f64>) {
    let field = Field::new("rejection_frequencies", "frequencies at which the rejection ratio is tabulated")
        .unit("Hz")
        .limit(ABOVE_0);
    v.numbers(&field.or_empty(), Count::AtLeastOne, frequencies);
    if frequencies.is_empty() {
        *frequencies = Procedure::default().rejection_hz;
    }
}

/// The step if nothing is written.
struct StepDefaults {
    /// Unit of what the loop controls.
    unit: &'static str,
    usual: Step,
}

fn step(v: &mut dyn Visit, step: &mut Step, size: &mut StepSize, defaults: StepDefaults) {
    let StepDefaults { unit, usual } = defaults;
    let mut stated = (*size == StepSize::Stated).then_some(step.rate_rad_s);
    let what = "size of the step, in the unit of what the loop controls; if absent 0.1, or what the control's limit lets a first design take at once if that is less";
    maybe_number(v, &Field::new("rate", what).unit(unit).limit(NumberRange::Not0), &mut stated);
    *size = stated.map_or(StepSize::Usual, |_| StepSize::Stated);
    step.rate_rad_s = stated.unwrap_or(usual.rate_rad_s);
    v.number(
        &Field::new("duration", "length of the record")
            .unit("s")
            .limit(ABOVE_0)
            .or(usual.duration_s)
            .show_default(),
        &mut step.duration_s,
    );
}

/// The triangle if nothing more is written.
const TRIANGLE: Triangle = Triangle { rate_rad_s: 0.1, period_s: 4.0 };

fn triangle(v: &mut dyn Visit, triangle: &mut Triangle, controlled: &'static str) {
    let rate = Field::new("rate", "peak of the triangle, in the unit of what the loop controls")
        .unit(controlled)
        .limit(NumberRange::Not0);
    v.number(&rate.or(TRIANGLE.rate_rad_s).show_default(), &mut triangle.rate_rad_s);
    let period = Field::new("period", "period of the triangle").unit("s").limit(ABOVE_0);
    v.number(&period.or(TRIANGLE.period_s).show_default(), &mut triangle.period_s);
}

fn sine(v: &mut dyn Visit, sine: &mut Sine, usual: Sine, unit: &'static str) {
    v.number(
        &Field::new("amplitude", "amplitude of the sine").unit(unit).or(usual.amplitude).show_default(),
        &mut sine.amplitude,
    );
    v.number(
        &Field::new("frequency", "frequency of the sine")
            .unit("Hz")
            .limit(ABOVE_0)
            .or(usual.frequency_hz)
            .show_default(),
        &mut sine.frequency_hz,
    );
}

/// A requirement as the file has it: either limit, or both.
#[derive(Debug, Clone)]
struct StatedRequirement {
    figure: String,
    at_least: Option<f64>,
    at_most: Option<f64>,
    source: String,
}

fn requirements(v: &mut dyn Visit, requirements: &mut Vec<Requirement>, controlled: ControlledQuantity) {
    let mut asked: Vec<StatedRequirement> =
        requirements.iter().map(|one| asked_of(one, controlled)).collect();
    let blank =
        StatedRequirement { figure: String::new(), at_least: None, at_most: None, source: String::new() };
    list(v, &TableField::optional("requirement", "a figure and its limit"), &mut asked, blank, |v, asked| {
        requirement(v, asked, controlled)
    });
    *requirements = asked.iter().flat_map(|one| resolve_requirements(one, controlled)).collect();
}

fn asked_of(requirement: &Requirement, controlled: ControlledQuantity) -> StatedRequirement {
    let (at_least, at_most) = match requirement.limit {
        Bound::AtLeast(value) => (Some(value), None),
        Bound::AtMost(value) => (None, Some(value)),
    };
    let figure = requirement.figure.key_in(controlled);
    StatedRequirement { figure, at_least, at_most, source: requirement.source.clone() }
}

fn resolve_requirements(asked: &StatedRequirement, controlled: ControlledQuantity) -> Vec<Requirement> {
    let Ok(figure) = PerformanceFigure::from_key_in(controlled, &asked.figure) else { return Vec::new() };
    let limits = [asked.at_least.map(Bound::AtLeast), asked.at_most.map(Bound::AtMost)];
    let requirement =
        |limit| Requirement::new(figure, limit).ok().map(|found| found.with_source(&asked.source));
    limits.into_iter().flatten().filter_map(requirement).collect()
}

/// The ranges of the lower and of the upper limit of a figure, outside of which no loop can meet them: a phase margin is an angle up to half a turn, the disk
/// margin of a loop without skew is at most 2, and the largest sensitivity is never below 1.
fn ranges_of_limits(figure: Option<PerformanceFigure>) -> [NumberRange; 2] {
    match figure {
        Some(PerformanceFigure::Loop(LoopFigure::PhaseMargin)) => {
            [NumberRange::Between(-180.0, 180.0), NumberRange::Any]
        }
        Some(PerformanceFigure::Loop(LoopFigure::DiskMargin)) => {
            [NumberRange::Between(0.0, 2.0), NumberRange::Any]
        }
        Some(PerformanceFigure::Loop(LoopFigure::MaxSensitivity)) => {
            [NumberRange::Any, NumberRange::Above(1.0)]
        }
        _ => [NumberRange::Any; 2],
    }
}

fn requirement(v: &mut dyn Visit, asked: &mut StatedRequirement, controlled: ControlledQuantity) {
    v.text(&Field::new("figure", "name of the figure that is limited"), &mut asked.figure);
    let known = PerformanceFigure::from_key_in(controlled, &asked.figure);
    if known.is_err() && !asked.figure.is_empty() {
        let hint = Some(figure_hint(&asked.figure, controlled));
        v.complain("figure", "there is no such figure", hint);
    }
    let [lower, upper] = ranges_of_limits(known.as_ref().ok().copied());
    let unit = known.map_or("", |figure| figure.unit(controlled));
    maybe_number(v, &Field::new("at_least", "lower limit").unit(unit).limit(lower), &mut asked.at_least);
    maybe_number(v, &Field::new("at_most", "upper limit").unit(unit).limit(upper), &mut asked.at_most);
    let source = "where the requirement comes from, for example the clause of a specification";
    v.text(&Field::new("source", source).or_text(""), &mut asked.source);
    if asked.at_least.is_none() && asked.at_most.is_none() {
        v.complain("figure", "has no limit: give at_least, at_most or both", None);
    }
    if let (Some(low), Some(high)) = (asked.at_least, asked.at_most)
        && low > high
    {
        v.complain("at_most", &format!("is below at_least = {low}"), None);
    }
}
