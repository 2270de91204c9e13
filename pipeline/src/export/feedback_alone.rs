//! What is certified of the loop that remains when the exported code hands over to feedback alone.

use counterpoise_verify::{
    Figure, Limit, Procedure, Verdict, Verification, VerifiedController, verify_linear,
};

use crate::{Modelled, PipelineError};
use counterpoise_project::Project;

/// Returns the lines of the header: whether the degraded loop is stable, its loop figures, and the verdict on each linear
/// requirement. The loop is that of the exported controller itself, with every sensor other than the hub gyroscope reading 0.
/// A loop that cannot be verified says so instead.
pub(super) fn certificate(
    project: &Project,
    modelled: &Modelled,
    verified: &VerifiedController,
    procedure: &Procedure,
) -> Vec<String> {
    match degraded(project, modelled, verified, procedure) {
        Ok(found) => lines(&found),
        Err(why) => vec![format!("not certified: {why}")],
    }
}

fn degraded(
    project: &Project,
    modelled: &Modelled,
    verified: &VerifiedController,
    procedure: &Procedure,
) -> Result<Verification, PipelineError> {
    let controller = verified.controller().feedback_alone().map_err(counterpoise_verify::Error::from)?;
    let requirements = project.verify.as_ref().map_or(&[][..], |asked| &asked.requirements);
    Ok(verify_linear(&modelled.plant, &controller, procedure, requirements)?)
}

fn lines(found: &Verification) -> Vec<String> {
    let stable = found.evidence.margins.closed_loop_stable;
    let mut lines =
        vec![if stable { "the linear loop is stable" } else { "the linear loop is UNSTABLE" }.to_owned()];
    let of = found.controlled_quantity();
    let loops = found.figures.iter().map(|measured| measured.figure);
    let loops = loops.filter(|figure| matches!(figure, Figure::Loop(_)));
    let said = loops.filter_map(|figure| Some((figure, found.value(figure)?)));
    lines.extend(said.map(|(figure, value)| format!("{}: {value:.4} {}", figure.name(of), figure.unit(of))));
    lines.extend(found.verdicts.iter().filter_map(|(requirement, verdict)| {
        let asked = |limit: &Limit| match limit {
            Limit::AtLeast(value) => format!("at least {value}"),
            Limit::AtMost(value) => format!("at most {value}"),
        };
        let (figure, unit) = (requirement.figure.name(of), requirement.figure.unit(of));
        let said = |value: f64, limit: &Limit, word: &str| {
            format!("requirement {figure}: {value:.4} {unit} ({}): {word}", asked(limit))
        };
        match verdict {
            Verdict::Holds { value, limit, .. } => Some(said(*value, limit, "holds")),
            Verdict::Fails { value, limit, .. } => Some(said(*value, limit, "FAILS")),
            Verdict::NotApplicable { .. } => None,
        }
    }));
    lines
}
