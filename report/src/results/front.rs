//! The front of a project's designs as a result file has it.

use counterpoise_pipeline::exchange::UnitValue;
use counterpoise_pipeline::studies::designs::{LimitsResult, TableMotion};
use counterpoise_pipeline::studies::front::{KindPoint, KindRole, ProjectFront};
use counterpoise_pipeline::tuning::{BlockResult, LoopMeasuresResult, MeasuredLoops, WeightsResult};
use counterpoise_synth::{FrontMethod, FrontObjective};
use counterpoise_verify::{Verdict, Verification};
use serde::Serialize;

use crate::wording::designs::describe_objective;
use crate::wording::figures::{describe_figure, format_figure};

/// The designs of a project of which none is better than another of its kind in every objective.
#[derive(Debug, Serialize)]
pub struct FrontText {
    /// Name of the mechanism.
    pub name: String,
    /// Hash of the project.
    pub hash: String,
    /// The quantity that the loops control, and in which units their figures are.
    #[serde(skip)]
    pub loops: MeasuredLoops,
    /// What the residual is.
    pub objective: String,
    /// The objectives that are traded, in the order of `figures`.
    #[serde(serialize_with = "write_names")]
    pub objectives: Vec<FrontObjective>,
    /// Limits that every design keeps.
    pub limits: LimitsResult,
    /// Method of the search.
    pub method: &'static str,
    /// Plants on which every design was measured.
    pub plants: usize,
    /// The disturbance of the linear loop: frequency in rad/s and power of each line at the output without feedback, in the square of the
    /// unit of what the loop controls.
    pub disturbance: Vec<[f64; 2]>,
    /// RMS of the white noise of a reading.
    #[serde(flatten)]
    pub reading_noise: UnitValue<f64>,
    /// The kinds of designs, the project's own first.
    pub kinds: Vec<KindText>,
    /// The designs, by their numbers.
    pub designs: Vec<FrontDesign>,
    /// The best figure of any design in each objective.
    #[serde(skip)]
    pub best: Vec<f64>,
    /// Single designs to compare with.
    pub references: Vec<ReferenceText>,
    /// Number of the design that was chosen; absent without a choice.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub chosen: Option<usize>,
    /// Verdicts on the chosen design; absent without a choice, or if the project states no requirements.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub verified: Option<VerdictSummary>,
}

/// The verdicts on a design.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct VerdictSummary {
    /// Verdicts that hold, that fail, and that do not apply.
    pub verdicts: [usize; 3],
    /// Requirements that fail, with their values.
    pub failing: Vec<String>,
    /// `true` if everything holds.
    pub holds: bool,
}

impl From<&Verification> for VerdictSummary {
    fn from(found: &Verification) -> Self {
        let (holds, fails, open) = found.counts();
        let failing = found.verdicts.iter().filter_map(|(requirement, verdict)| match verdict {
            Verdict::Fails { value, limit, .. } => Some(format!(
                "{}: {} against {}",
                describe_figure(requirement.figure, found.controlled_quantity()),
                format_figure(*value),
                limit.value()
            )),
            _ => None,
        });
        Self { verdicts: [holds, fails, open], failing: failing.collect(), holds: found.passes() }
    }
}

/// A kind of design.
#[derive(Debug, Serialize)]
pub struct KindText {
    /// Name.
    pub name: String,
    /// `own`, `bar` or `other`.
    pub role: &'static str,
    /// Feedbacks that were evaluated.
    pub evaluations: usize,
    /// `false` if the search was stopped.
    pub complete: bool,
    /// Designs of this kind.
    pub designs: usize,
    /// Designs of this kind that no design of any kind beats in every objective.
    pub nondominated: usize,
    /// For each objective but the first one: the places among the designs of those that no other of the kind beats in both.
    #[serde(skip)]
    pub edges: Vec<Vec<usize>>,
    /// Why there is no front; absent if there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub why: Option<String>,
}

/// A design of the front.
#[derive(Debug, Serialize)]
pub struct FrontDesign {
    /// Number, for `--choose`.
    pub number: usize,
    /// Kind.
    pub kind: String,
    /// The figure of each objective on the worst plant, in SI units; `null` for an infinite margin.
    #[serde(serialize_with = "write_figures")]
    pub figures: Vec<f64>,
    /// Whether no design of any kind is better in every objective.
    pub nondominated: bool,
    /// Whether no PI with a lag is better in every objective.
    pub clears_bar: bool,
    /// Figures of the loop on the nominal plant.
    pub linear: Option<LoopMeasuresResult>,
    /// The blocks of a structure.
    pub blocks: Vec<BlockResult>,
    /// The weights of an H2 feedback.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub weights: Option<WeightsResult>,
}

/// A single design to compare with.
#[derive(Debug, Serialize)]
pub struct ReferenceText {
    /// Name.
    pub name: String,
    /// The figure of each objective on the worst plant, in SI units; `null` for an infinite margin.
    #[serde(serialize_with = "write_figures")]
    pub figures: Vec<f64>,
    /// Figures of the loop on the nominal plant.
    pub linear: LoopMeasuresResult,
}

fn write_names<S: serde::Serializer>(objectives: &[FrontObjective], to: S) -> Result<S::Ok, S::Error> {
    to.collect_seq(objectives.iter().map(|each| each.name()))
}

fn write_figures<S: serde::Serializer>(figures: &[f64], to: S) -> Result<S::Ok, S::Error> {
    to.collect_seq(figures.iter().map(|figure| Some(*figure).filter(|figure| figure.is_finite())))
}

impl From<&ProjectFront> for FrontText {
    fn from(found: &ProjectFront) -> Self {
        let kinds = found.kinds.iter().enumerate().map(|(k, kind)| KindText {
            name: kind.name.clone(),
            role: role_name(kind.role),
            evaluations: kind.evaluations,
            complete: kind.is_complete,
            designs: count(found, k, |_| true),
            nondominated: count(found, k, |point| point.is_nondominated),
            edges: kind.edges.clone(),
            why: kind.why.as_ref().map(ToString::to_string),
        });
        let designs = found.points.iter().enumerate().map(|(k, each)| FrontDesign {
            number: k + 1,
            kind: found.kinds[each.kind].name.clone(),
            figures: each.point.figures.clone(),
            nondominated: each.is_nondominated,
            clears_bar: each.clears_bar,
            linear: each.linear,
            blocks: each.blocks.clone(),
            weights: each.weights.clone(),
        });
        let references = found.references.iter().map(|each| ReferenceText {
            name: each.name.clone(),
            figures: each.figures.clone(),
            linear: each.linear,
        });
        let motion = if found.has_own_motion { TableMotion::Own } else { TableMotion::Sines };
        Self {
            name: found.identity.name.clone(),
            hash: found.identity.hash.clone(),
            loops: found.loops,
            objective: describe_objective(found.objective, found.loops.controlled, motion),
            objectives: found.objectives.clone(),
            limits: found.limits,
            method: match found.method {
                FrontMethod::Evolution => "evolution",
                FrontMethod::Random => "random",
            },
            plants: found.plants,
            disturbance: found.disturbance.clone(),
            reading_noise: found.reading_noise,
            kinds: kinds.collect(),
            designs: designs.collect(),
            best: found.best.clone(),
            references: references.collect(),
            chosen: None,
            verified: None,
        }
    }
}

fn count(found: &ProjectFront, kind: usize, is_counted: fn(&KindPoint) -> bool) -> usize {
    found.points.iter().filter(|point| point.kind == kind && is_counted(point)).count()
}

fn role_name(role: KindRole) -> &'static str {
    match role {
        KindRole::Own => "own",
        KindRole::Bar => "bar",
        KindRole::Other => "other",
    }
}
