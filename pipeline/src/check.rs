//! The reading of a project file, and the values that are assumed.

use counterpoise_diagnose::learning::reading::{ReadElement, read_elements};
use counterpoise_lti::poles;
use counterpoise_models::AxisKind;
use counterpoise_models::parameters::Transmission;
use counterpoise_pool::Serial;
use counterpoise_project::{
    Assumption, Diagnostic, Document, KeyTolerance, ParsedProject, Project, Purpose, SectionStatement,
};
use counterpoise_synth::tolerance::{CAUTION, LIGHTLY_DAMPED};
use counterpoise_synth::{LimitKind, Unknown};
use serde::Serialize;

use crate::check_problem::CheckProblem;
use crate::exchange::VerifiedLoop;
use crate::first_design::{ChosenWeights, leaves_weights_open, unknown_key};
use crate::studies::assumptions::{AssumptionEffect, LoopSystems, assumption_effects, with_those_of_design};
use crate::studies::sweep::campaign_is_stated;
use crate::{PipelineError, PlantModel, build_plant_model, choose_weights, reduce_plant, synthesise};

/// The reading of a project file, and the values that are assumed. What is in the way is a [`CheckProblem`], or a sentence about it, which a
/// result file has.
#[derive(Debug, Serialize)]
pub struct CheckResult<Problem = CheckProblem> {
    /// The file.
    pub file: String,
    /// The format that it states; `None` if it states none.
    pub format: Option<u32>,
    /// The parts that it includes.
    pub parts: Vec<String>,
    /// Name of the machine.
    pub machine: String,
    /// The plant in a few numbers; `None` if it cannot be built.
    pub plant: Option<PlantOverview>,
    /// Every section with what the file states in it and with what is taken beside that, in the units of the keys.
    pub sections: Vec<SectionStatement>,
    /// Values with tolerances.
    pub tolerances: Vec<KeyTolerance>,
    /// The values that are assumed because the file does not state it.
    pub assumptions: Vec<Assumption>,
    /// The effects of the assumptions with a usual range, the largest effect first; empty without a design.
    pub effects: Vec<AssumptionEffect>,
    /// The facts that are not known and lower the ceiling of the bandwidth of a first design; empty without one.
    pub open_facts: Vec<OpenFact>,
    /// Why the plant cannot be built, or why there is no design by which assumptions could be judged.
    pub problems: Vec<Problem>,
    /// The entries that are allowed but likely to be mistakes.
    pub warnings: Vec<Diagnostic>,
    /// The commands for which the file has all sections.
    pub commands: Vec<&'static str>,
}

impl CheckResult {
    /// Returns the result with what `describe` says of each problem.
    pub fn map_problems<Said>(self, describe: impl Fn(&CheckProblem) -> Said) -> CheckResult<Said> {
        CheckResult {
            file: self.file,
            format: self.format,
            parts: self.parts,
            machine: self.machine,
            plant: self.plant,
            sections: self.sections,
            tolerances: self.tolerances,
            assumptions: self.assumptions,
            effects: self.effects,
            open_facts: self.open_facts,
            problems: self.problems.iter().map(describe).collect(),
            warnings: self.warnings,
            commands: self.commands,
        }
    }
}

/// The plant in a few numbers.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlantOverview {
    /// `true` if it slides: it then has kg for kg m^2 and for kg m.
    #[serde(skip)]
    pub is_sliding: bool,
    /// Order of the linear plant.
    pub order: usize,
    /// Moment of inertia of the structure about the pivot, kg m^2.
    pub inertia_kg_m2: f64,
    /// First moment of mass about the pivot, kg m.
    pub out_of_balance_kg_m: f64,
    /// Frequency of the first flexible mode of the structure, pinned at the hub, Hz; `None` for a rigid one.
    pub first_mode_hz: Option<f64>,
    /// Frequency of the first flexible mode of the machine with the transmission's own, Hz; `None` if the transmission is rigid.
    pub transmission_mode_hz: Option<f64>,
    /// The transmission, as a word.
    #[serde(skip)]
    pub transmission: &'static str,
    /// Control that holds the mechanism where it stands, V.
    pub holding_v: f64,
    /// Rate at which the controller runs, Hz.
    pub sample_rate_hz: f64,
    /// The free functions of the plant.
    #[serde(skip)]
    pub learned: Vec<ReadElement>,
}

const PURPOSES: [Purpose; 10] = [
    Purpose::Model,
    Purpose::Reduce,
    Purpose::Synth,
    Purpose::Verify,
    Purpose::Design,
    Purpose::Export,
    Purpose::Sweep,
    Purpose::Identify,
    Purpose::Replay,
    Purpose::Diagnose,
];

/// The thing that commands lack on a file, the least first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Lacks {
    Nothing,
    Design,
    Plant,
}

fn what_lacks(problem: &CheckProblem) -> Lacks {
    match problem {
        CheckProblem::NoDesign { .. } => Lacks::Design,
        CheckProblem::NoPlant { .. } => Lacks::Plant,
    }
}

/// Returns how a file was read and which values are assumed. The design is computed, if there is one, to rank the assumptions.
pub fn check_project(document: &Document, parsed: &ParsedProject, systems: LoopSystems) -> CheckResult {
    let project = &parsed.project;
    let mut problems = Vec::new();
    let (plant, ranked) = match build_plant_model(project) {
        Err(error) => {
            problems.push(CheckProblem::NoPlant { cause: error });
            let assumptions = parsed.assumptions.clone();
            (None, RankedAssumptions { assumptions, ..RankedAssumptions::default() })
        }
        Ok(modelled) => {
            let ranked = rank_assumptions(project, &modelled, &parsed.assumptions, systems);
            let ranked = ranked.unwrap_or_else(|error| {
                problems.push(CheckProblem::NoDesign { cause: error });
                RankedAssumptions { assumptions: parsed.assumptions.clone(), ..RankedAssumptions::default() }
            });
            (Some(overview(&modelled)), ranked)
        }
    };
    let lacks = problems.iter().map(what_lacks).max().unwrap_or(Lacks::Nothing);
    let can = |purpose: &Purpose| {
        let has_what_it_needs = match purpose {
            Purpose::Replay | Purpose::Diagnose | Purpose::Identify => true,
            Purpose::Model | Purpose::Reduce => lacks < Lacks::Plant,
            _ => lacks == Lacks::Nothing,
        };
        let varies = *purpose != Purpose::Sweep || campaign_is_stated(project).is_ok();
        has_what_it_needs && varies && project.supports(document, *purpose)
    };
    CheckResult {
        file: document.name().to_owned(),
        format: document.format(),
        parts: document.parts().to_vec(),
        machine: project.plant.name.clone(),
        plant,
        sections: project.statements_of(document),
        tolerances: project.tolerances.clone(),
        assumptions: ranked.assumptions,
        effects: ranked.effects,
        open_facts: ranked.open_facts,
        problems,
        warnings: parsed.warnings.clone(),
        commands: PURPOSES.iter().filter(|purpose| can(purpose)).map(|purpose| purpose.name()).collect(),
    }
}

/// A fact of the loop that is not known and lowers the ceiling of the bandwidth of a first design.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OpenFact {
    /// Path of the key that states it.
    pub key: String,
    /// The ceiling with it known, rad/s: other limits may be lower.
    pub ceiling_if_known_rad_s: f64,
}

/// The values that a file leaves open, and how much they matter.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RankedAssumptions {
    /// All assumptions, those of the design included.
    pub assumptions: Vec<Assumption>,
    /// The effects of those of the plant that have a usual range, the largest effect first: what is first is worth measuring next.
    pub effects: Vec<AssumptionEffect>,
    /// The facts that are not known and lower the ceiling of the bandwidth, if the weights are chosen.
    pub open_facts: Vec<OpenFact>,
    /// The loop at the assumed values, from which effects are counted; `None` without effects, or if the systems are left out.
    pub assumed_loop: Option<VerifiedLoop>,
}

/// Returns all assumptions, those of the design included, and how much those of the plant matter. The design is the project's, or the
/// first design if its weights are left open; none is computed if no assumption has a usual range.
///
/// # Errors
/// There is no design, or its loop cannot be judged.
pub fn rank_assumptions(
    project: &Project,
    modelled: &PlantModel,
    assumptions: &[Assumption],
    systems: LoopSystems,
) -> Result<RankedAssumptions, PipelineError> {
    let has_usual = assumptions.iter().any(|assumption| assumption.usual.is_some());
    if !has_usual && !modelled.parameters.sensors.measured.is_position() {
        return Ok(RankedAssumptions { assumptions: assumptions.to_vec(), ..RankedAssumptions::default() });
    }
    let reduced = reduce_plant(project, modelled)?;
    let usual = project.clone().with_usual_verification();
    let chosen = match leaves_weights_open(project) {
        true => Some(choose_weights(&usual, modelled, &reduced)?),
        false => None,
    };
    let project = chosen.as_ref().map_or(project, |chosen| &chosen.project);
    let synthesised = synthesise(project, modelled, &reduced)?;
    let found = assumption_effects(project, modelled, &synthesised, assumptions, systems, &Serial)?;
    let assumptions = with_those_of_design(assumptions, &synthesised);
    let open_facts = chosen.as_ref().map_or_else(Vec::new, |chosen| list_open_facts(project, chosen));
    Ok(RankedAssumptions {
        assumptions,
        effects: found.effects,
        open_facts,
        assumed_loop: found.assumed_loop,
    })
}

/// Returns the facts that are not known and lower the ceiling of the bandwidth of chosen weights.
fn list_open_facts(project: &Project, chosen: &ChosenWeights) -> Vec<OpenFact> {
    let bandwidth = &chosen.first.bandwidth;
    let ceiling = bandwidth.limits.iter().find(|limit| limit.kind == LimitKind::SampleRate);
    let Some(ceiling) = ceiling.map(|limit| limit.bandwidth_rad_s) else { return Vec::new() };
    let fact = |fact: &Unknown| OpenFact {
        key: unknown_key(project, *fact),
        ceiling_if_known_rad_s: ceiling / CAUTION,
    };
    bandwidth.unknown.iter().map(fact).collect()
}

/// Returns the frequency of the first flexible mode of the whole plant, Hz; `None` if it has none.
fn first_mode_of_plant(modelled: &PlantModel) -> Option<f64> {
    let found = poles(&modelled.linear.system).ok()?;
    let light = found.iter().filter(|pole| pole.im > 0.0 && pole.re.abs() < LIGHTLY_DAMPED * pole.norm());
    let slowest = light.map(|pole| pole.norm()).reduce(f64::min)?;
    Some(slowest / std::f64::consts::TAU)
}

/// Returns the word for a transmission.
fn transmission_word(kind: Transmission) -> &'static str {
    match kind {
        Transmission::Direct => "drive",
        Transmission::Gearbox => "gearbox",
        Transmission::Belt => "belt",
        Transmission::Cable => "cable",
        Transmission::HarmonicDrive => "harmonic drive",
        Transmission::BallScrew { .. } => "ball screw",
    }
}

fn overview(modelled: &PlantModel) -> PlantOverview {
    let body = modelled.plant.body();
    let gearbox = &modelled.parameters.gearbox;
    let transmission_mode_hz = match gearbox.is_rigid() || modelled.parameters.cylinder.is_some() {
        true => None,
        false => first_mode_of_plant(modelled),
    };
    PlantOverview {
        transmission: transmission_word(gearbox.kind),
        transmission_mode_hz,
        is_sliding: modelled.parameters.axis == AxisKind::Linear,
        order: modelled.linear.system.order(),
        inertia_kg_m2: body.inertia_kg_m2,
        out_of_balance_kg_m: body.out_of_balance_kg_m,
        first_mode_hz: body.modes.first().map(|mode| mode.frequency_rad_s / std::f64::consts::TAU),
        holding_v: modelled.linear.equilibrium.control_v,
        sample_rate_hz: 1.0 / modelled.parameters.interface.sample_period_s,
        learned: read_elements(&modelled.parameters.learned),
    }
}
