//! Both axes verified together, in words and tables.

use crate::wording::figures::{
    describe_joint_experiment, describe_joint_figure, describe_joint_quantity, describe_unmeasured,
};
use counterpoise_pipeline::TwoAxisStudy;
use counterpoise_plot::number::short_number;
use counterpoise_verify::{JointExperiment, JointQuantity, JointRequirement, JointValue, Verdict};

use crate::{ReportCell, ReportColumn, ReportSection, ReportTable};

/// Milliradians in a radian.
const MILLI: f64 = 1e3;

/// Returns the section on both axes.
pub fn two_axes_section(study: &TwoAxisStudy) -> ReportSection {
    let name = &study.traverse.project.plant.name;
    let mut section = ReportSection::new("Two axes together")
        .with_text(format!(
            "The traverse axis \"{name}\" under this elevation axis has its own design. Both axes are simulated together: the ring's motion is the base's motion \
             to the elevation axis, and the elevated body's inertia, out-of-balance and angular momentum act on the ring."
        ))
        .with_text(
            "Alone, the elevation axis stands on a ring that does not turn, and the traverse axis carries the body at the elevation that its parameters include. \
             Values are RMS from the settling time on; the angle of the line of sight is about its mean.",
        );
    for line in verdict_lines(study) {
        section = section.with_text(format!("{line}."));
    }
    section.with_table(table(&study.joint.values))
}

fn table(values: &[JointValue]) -> ReportTable {
    let columns = [
        ReportColumn::Text("run"),
        ReportColumn::Text("figure"),
        ReportColumn::Number("together"),
        ReportColumn::Number("each axis alone"),
        ReportColumn::Text("unit"),
    ];
    let mut table = ReportTable::new("RMS of both axes", &columns);
    for value in values {
        let quantity = value.figure.quantity;
        table.rows.push(vec![
            ReportCell::text(describe_joint_experiment(value.figure.experiment)),
            ReportCell::text(describe_joint_quantity(quantity)),
            ReportCell::number(MILLI * value.together),
            ReportCell::number(MILLI * value.alone),
            ReportCell::text(format!("m{}", quantity.unit())),
        ]);
    }
    table
}

/// Returns both axes in lines, for a terminal: the verdicts, then the line of sight and the rates of each run.
pub fn two_axes_lines(study: &TwoAxisStudy) -> Vec<String> {
    let mut lines = verdict_lines(study);
    lines.extend(JointExperiment::ALL.into_iter().map(|experiment| {
        let found = |quantity: JointQuantity| {
            let values = &study.joint.values;
            let value = values.iter().find(|value| {
                value.figure.experiment == experiment && value.figure.quantity == quantity
            });
            let milli = |of: fn(&JointValue) -> f64| short_number(value.map_or(f64::NAN, |v| MILLI * of(v)));
            format!("{} ({} alone)", milli(|v| v.together), milli(|v| v.alone))
        };
        format!(
            "{}: line of sight {} mrad RMS, in elevation {}, in cross-elevation {}; rate errors {} and {} mrad/s",
            describe_joint_experiment(experiment),
            found(JointQuantity::Sight),
            found(JointQuantity::ElevationSight),
            found(JointQuantity::CrossElevationSight),
            found(JointQuantity::ElevationRate),
            found(JointQuantity::TraverseRate)
        )
    }));
    lines
}

fn verdict_lines(study: &TwoAxisStudy) -> Vec<String> {
    let (holds, fails, _) = study.traverse.verified.verification().counts();
    let mut lines = vec![format!("traverse axis alone: {holds} requirements hold, {fails} fail")];
    lines.extend(study.joint.verdicts.iter().map(|(asked, verdict)| verdict_line(asked, verdict)));
    lines
}

fn verdict_line(requirement: &JointRequirement, verdict: &Verdict) -> String {
    let (figure, unit) = (describe_joint_figure(requirement.figure), requirement.figure.quantity.unit());
    let side = requirement.limit.side();
    let limit = short_number(requirement.limit.value());
    match verdict {
        Verdict::Holds { value, .. } => {
            format!("holds: {figure}, {} {unit} ({side} {limit})", short_number(*value))
        }
        Verdict::Fails { value, by, .. } => {
            let (value, by) = (short_number(*value), short_number(*by));
            format!("FAILS: {figure}, {value} {unit} ({side} {limit}), by {by}")
        }
        Verdict::NotApplicable { why } => {
            format!("not applicable: {figure}, {}", describe_unmeasured(why))
        }
    }
}
