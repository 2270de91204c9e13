//! A whole design: every stage from the project file to code, and everything that is stated about the result.

use counterpoise_export::{File, FormFigures, TargetRuns, Targets};
use counterpoise_pool::{Pool, join};
use counterpoise_project::resolve::synthesis::DesignRequest;
use counterpoise_project::{Assumption, Project};
use counterpoise_verify::certificate::StabilityCertificate;
use counterpoise_verify::rejection_spectra::{HubRateSpectra, spectral_rejections};
use counterpoise_verify::{Procedure, VerifiedController};

use crate::certificates::{Certificate, certify_designs};
use crate::design_views::{DesignViews, design_views};
use crate::exchange::{ErrorBudgetResult, VerifiedLoop, error_budget_result, verified_loop};
use crate::export::target_proofs::OperationCounts;
use crate::export::{
    ExportTask, ExportedCode, HeaderWords, OmittedCode, PathForms, TargetCode, every_target, export_by,
    half_step_v, path_forms,
};
use crate::loop_view::{LoopView, loop_view};
use crate::sight_views::{SightView, view_sight};
use crate::studies::adaptation_trials::{AdaptationTrials, own_trials};
use crate::studies::advice::{KeptDesigns, WeightAdvice, advise_changes};
use crate::studies::assumptions::{AssumptionEffects, LoopSystems, assumption_effects, with_those_of_design};
use crate::studies::comparison::{DesignComparison, compare_designs};
use crate::studies::tuned_pi::{TunedPiRow, tuned_pi_row};
use crate::{
    DecidedProject, DesignedAxis, FirstDesign, PipelineError, PipelineStage, PlantModel, ProjectIdentity,
    ReducedPlant, SynthesisedDesign, TraverseCode, TwoAxisStudy, World, build_plant_model, choose_and_tune,
    export_traverse, project_procedure, reduce_plant, run_observed, studies, study_two_axes, synthesise,
    verify_on,
};

/// Results of the stages of the pipeline, from the plant to the code.
#[derive(Debug, Clone)]
pub struct DesignStages {
    /// The plant.
    pub modelled: PlantModel,
    /// The plant that the design took.
    pub reduced: ReducedPlant,
    /// The design and its sampled controller.
    pub synthesised: SynthesisedDesign,
    /// Procedure of the verification.
    pub procedure: Procedure,
    /// The controller with its verdicts.
    pub verified: VerifiedController,
    /// Stability in every regime.
    pub stability: StabilityCertificate,
    /// Code.
    pub files: Vec<File>,
    /// Code that the project asks for and cannot have.
    pub left_out: Vec<OmittedCode>,
    /// The traverse axis under this elevation axis, with its code; `None` if the project has none.
    pub traverse: Option<Box<TraverseCode>>,
}

impl DesignStages {
    /// Returns the code that the project, or that of its traverse axis, asks for and cannot have.
    pub fn all_left_out(&self) -> impl Iterator<Item = &OmittedCode> {
        self.left_out.iter().chain(self.traverse.iter().flat_map(|axis| &axis.left_out))
    }

    /// Verifies both axes together.
    fn two_axes(&self, project: &Project, world: &dyn World) -> Result<Option<TwoAxisStudy>, PipelineError> {
        let Self { modelled, synthesised, procedure, .. } = self;
        let elevation = DesignedAxis { project, plant: &modelled.plant, synthesised, procedure };
        study_two_axes(elevation, self.traverse.as_ref().map(|axis| axis.design.clone()), world)
    }

    /// Returns what to change for each requirement that fails.
    fn advise(&self, project: &Project) -> Result<Vec<WeightAdvice>, PipelineError> {
        let Self { modelled, reduced, procedure, verified, .. } = self;
        advise_changes(project, modelled, reduced, procedure, verified.verification(), KeptDesigns::Systems)
    }

    /// Returns the effect of each assumption on the design; none if the linear loop cannot be judged.
    fn assumption_effects(
        &self,
        project: &Project,
        contents: &DesignContents<'_>,
        pool: &dyn Pool,
    ) -> AssumptionEffects {
        let DesignContents { assumptions, systems, .. } = *contents;
        assumption_effects(project, &self.modelled, &self.synthesised, assumptions, systems, pool)
            .unwrap_or_default()
    }

    /// Returns the error budget of the verification.
    fn error_budget(&self, kept: KeptDesigns) -> Result<Option<ErrorBudgetResult>, PipelineError> {
        let verified = &self.verified;
        error_budget_result(verified.verification(), &self.modelled.plant, verified.controller(), kept)
    }
}

/// The controller in every kind of numbers, before any compiler has seen it.
#[derive(Debug, Clone)]
pub struct TargetStudy {
    /// The closed loop in each kind of numbers.
    pub compared: Targets,
    /// The code in every language and every kind of numbers that exists.
    pub code: Vec<TargetCode>,
    /// Operations of a step.
    pub operations: OperationCounts,
    /// Sensitivity of the coefficients of each path.
    pub forms: Vec<PathForms>,
    /// The controller with its paths in every form.
    pub by_form: Vec<FormFigures>,
}

/// A whole design with everything that a report, a terminal or another program shows of it.
#[derive(Debug, Clone)]
pub struct CompletedDesign {
    /// Identity of the project that was designed.
    pub identity: ProjectIdentity,
    /// Results of the stages.
    pub stages: DesignStages,
    /// The design that the project asks for, with its weights.
    pub asked: DesignRequest,
    /// Why the weights are what they are, if the project stated none and they were chosen here.
    pub first_design: Option<FirstDesign>,
    /// Residuals and costs that certify the design.
    pub certificates: Vec<Certificate>,
    /// The design beside other methods, a lower order, other states of balance and a plant with more modes.
    pub comparison: DesignComparison,
    /// Frequency responses of plants, weights and controllers.
    pub views: DesignViews,
    /// The loop as Nyquist, Nichols and root-locus charts show it.
    pub loop_view: LoopView,
    /// The spectrum of the line of sight at each place; empty if the verification did not ask for it.
    pub sight_views: Vec<SightView>,
    /// Rejection ratios from the time histories on the road.
    pub spectra: Vec<HubRateSpectra>,
    /// The controller in double, single and fixed point.
    pub targets: TargetStudy,
    /// Loop on which the linear figures were measured.
    pub verified_loop: VerifiedLoop,
    /// The trials of the project's adaptation; `None` if it has none.
    pub adaptation: Option<AdaptationTrials>,
    /// Both axes verified together; `None` if the project has no traverse axis.
    pub two_axes: Option<TwoAxisStudy>,
    /// The changes that meet a requirement that fails.
    pub advice: Vec<WeightAdvice>,
    /// The values that the project does not state, and those that its design assumes.
    pub assumptions: Vec<Assumption>,
    /// How much each assumption matters.
    pub assumption_effects: AssumptionEffects,
    /// The error budget, with the angles of its runs if time histories are kept; `None` if there is none.
    pub error_budget: Option<ErrorBudgetResult>,
    /// The treatment of time histories that was asked for.
    pub kept: KeptDesigns,
}

/// What is computed and kept of a design beside its figures.
#[derive(Debug, Clone, Copy)]
pub struct DesignContents<'a> {
    /// The values that the project does not state.
    pub assumptions: &'a [Assumption],
    /// The treatment of the systems from which the effects of the assumptions can be recomputed.
    pub systems: LoopSystems,
    /// The treatment of the time histories, those of the error budget's runs among them.
    pub kept: KeptDesigns,
}

impl Default for DesignContents<'_> {
    fn default() -> Self {
        Self { assumptions: &[], systems: LoopSystems::LeftOut, kept: KeptDesigns::Systems }
    }
}

/// A design without its verification and code, with everything that a report, a terminal or another program shows of it.
#[derive(Debug, Clone)]
pub struct SynthesisStudy {
    /// Identity of the project that was designed.
    pub identity: ProjectIdentity,
    /// The plant.
    pub modelled: PlantModel,
    /// The plant that the design took.
    pub reduced: ReducedPlant,
    /// The design and its sampled controller.
    pub synthesised: SynthesisedDesign,
    /// The design that the project asks for, with its weights.
    pub asked: DesignRequest,
    /// Residuals and costs that certify the design.
    pub certificates: Vec<Certificate>,
    /// The design beside other methods, a lower order, other states of balance and a plant with more modes.
    pub comparison: DesignComparison,
    /// Frequency responses of plants, weights and controllers.
    pub views: DesignViews,
}

/// Runs every stage from the project to its code, whose headers are worded by `words`.
///
/// # Errors
/// [`PipelineError`]: what is missing in the project, what cannot be built, and every reason why there is no controller.
/// A requirement that is not met is no error: it is a verdict in [`DesignStages::verified`].
pub fn run_stages(
    project: &Project,
    words: &dyn HeaderWords,
    world: &dyn World,
) -> Result<DesignStages, PipelineError> {
    let made = SampledDesign::of(project, world)?;
    let (verified, stability) = run_observed(world, PipelineStage::Verify, || {
        join(world.pool(), || made.verify(project), || made.certify(project))
    });
    made.export(&CodeOrigin { project, words, world }, verified?, stability?)
}

/// The project whose code is written, who words its headers, and the surroundings.
#[derive(Clone, Copy)]
struct CodeOrigin<'a> {
    project: &'a Project,
    words: &'a dyn HeaderWords,
    world: &'a dyn World,
}

/// The results of the stages up to the sampled controller, and what its verification will do to the mechanism.
struct SampledDesign {
    modelled: PlantModel,
    reduced: ReducedPlant,
    synthesised: SynthesisedDesign,
    procedure: Procedure,
}

impl SampledDesign {
    fn of(project: &Project, world: &dyn World) -> Result<Self, PipelineError> {
        let modelled = run_observed(world, PipelineStage::Model, || build_plant_model(project))?;
        let reduced = run_observed(world, PipelineStage::Reduce, || reduce_plant(project, &modelled))?;
        let synthesised =
            run_observed(world, PipelineStage::Synthesise, || synthesise(project, &modelled, &reduced))?;
        let procedure = project_procedure(project, world)?;
        Ok(Self { modelled, reduced, synthesised, procedure })
    }

    fn verify(&self, project: &Project) -> Result<VerifiedController, PipelineError> {
        verify_on(project, &self.modelled.plant, &self.synthesised, &self.procedure)
    }

    fn certify(&self, project: &Project) -> Result<StabilityCertificate, PipelineError> {
        studies::certificate::certify_controller(project, &self.modelled, &self.synthesised, &self.procedure)
    }

    /// Verifies and certifies the controller, runs it in every kind of numbers and compares it with other designs, side by side on the
    /// processors at hand.
    fn study(
        &self,
        project: &Project,
        tuned_pi: Option<&TunedPiRow>,
        pool: &dyn Pool,
    ) -> Result<StudiedDesign, PipelineError> {
        let verified = || {
            let verified = self.verify(project)?;
            let (targets, loop_view) =
                join(pool, || self.study_target_runs(&verified, pool), || loop_view(verified.verification()));
            Ok::<_, PipelineError>((targets?, loop_view?, verified))
        };
        let beside = || {
            let compare = || compare_designs(project, &self.modelled, &self.synthesised, tuned_pi);
            join(pool, || self.certify(project), compare)
        };
        let (verified, (stability, comparison)) = join(pool, verified, beside);
        let (targets, loop_view, verified) = verified?;
        Ok(StudiedDesign { verified, stability: stability?, targets, comparison: comparison?, loop_view })
    }

    /// Runs the controller in every kind of numbers.
    fn study_target_runs(
        &self,
        verified: &VerifiedController,
        pool: &dyn Pool,
    ) -> Result<StudiedTargets, PipelineError> {
        let runs = TargetRuns::record(verified, &self.modelled.plant, &self.procedure, pool)?;
        let allowed_v = half_step_v(&self.modelled.plant);
        let (fixed, (single, by_form)) = join(
            pool,
            || runs.fixed_point_form(allowed_v),
            || join(pool, || runs.single(), || runs.figures_by_form()),
        );
        Ok(StudiedTargets { compared: Targets::of(&runs, single?, fixed?), by_form })
    }

    /// Writes the code.
    fn export(
        self,
        origin: &CodeOrigin<'_>,
        mut verified: VerifiedController,
        stability: StabilityCertificate,
    ) -> Result<DesignStages, PipelineError> {
        let Self { modelled, reduced, synthesised, procedure } = self;
        verified.take_certificate(&stability);
        let CodeOrigin { project, words, world } = *origin;
        let task = ExportTask { project, modelled: &modelled, verified: &verified, procedure: &procedure };
        let ExportedCode { files, left_out } =
            run_observed(world, PipelineStage::Export, || export_by(&task, words, world))?;
        let traverse = export_traverse(project, words, world)?.map(Box::new);
        Ok(DesignStages {
            modelled,
            reduced,
            synthesised,
            procedure,
            verified,
            stability,
            files,
            left_out,
            traverse,
        })
    }
}

/// The results that are computed of a sampled design side by side.
struct StudiedDesign {
    verified: VerifiedController,
    stability: StabilityCertificate,
    targets: StudiedTargets,
    comparison: DesignComparison,
    loop_view: LoopView,
}

/// The controller in every kind of numbers and in every form, in the runs of its verification.
struct StudiedTargets {
    compared: Targets,
    by_form: Vec<FormFigures>,
}

/// Runs every stage and computes everything that is stated about the design; whoever shows the result computes nothing.
///
/// # Errors
/// As [`run_stages`], and those of the comparison and of the runs in each kind of numbers.
pub fn design_project(
    project: &Project,
    contents: &DesignContents<'_>,
    words: &dyn HeaderWords,
    world: &dyn World,
) -> Result<CompletedDesign, PipelineError> {
    let DecidedProject { project, first, .. } = choose_and_tune(project, world)?;
    let project = &project;
    let made = SampledDesign::of(project, world)?;
    let tuned_pi = tuned_pi_row(project, &made.modelled, &made.reduced, &made.synthesised, world)?;
    let studied =
        run_observed(world, PipelineStage::Verify, || made.study(project, tuned_pi.as_ref(), world.pool()))?;
    let StudiedDesign { verified, stability, targets, comparison, loop_view } = studied;
    let origin = CodeOrigin { project, words, world };
    let stages = made.export(&origin, verified, stability)?;
    Ok(CompletedDesign {
        identity: ProjectIdentity::of(project, world),
        asked: design_request(project)?,
        certificates: certify_designs(&stages.synthesised, Some(stages.verified.verification())),
        comparison,
        views: design_views(&stages.modelled, &stages.reduced, &stages.synthesised)?,
        loop_view,
        sight_views: view_sight(stages.verified.verification()),
        spectra: spectral_rejections(stages.verified.verification()),
        targets: study_targets(&origin, &stages, targets)?,
        first_design: first,
        verified_loop: verified_loop(
            &stages.modelled.plant,
            stages.verified.controller(),
            &stages.procedure,
        )?,
        adaptation: own_trials(project, &stages.modelled, &stages.synthesised, &stages.procedure)?,
        two_axes: stages.two_axes(project, world)?,
        advice: stages.advise(project)?,
        assumptions: with_those_of_design(contents.assumptions, &stages.synthesised),
        assumption_effects: stages.assumption_effects(project, contents, world.pool()),
        error_budget: stages.error_budget(contents.kept)?,
        kept: contents.kept,
        stages,
    })
}

/// Runs the stages up to the synthesis and computes everything that is stated about the design.
///
/// # Errors
/// Those of the plant, the reduction, the design and the comparison.
pub fn study_synthesis(project: &Project, world: &dyn World) -> Result<SynthesisStudy, PipelineError> {
    let project = &choose_and_tune(project, world)?.project;
    let modelled = build_plant_model(project)?;
    let reduced = reduce_plant(project, &modelled)?;
    let synthesised = synthesise(project, &modelled, &reduced)?;
    let tuned_pi = tuned_pi_row(project, &modelled, &reduced, &synthesised, world)?;
    Ok(SynthesisStudy {
        identity: ProjectIdentity::of(project, world),
        asked: design_request(project)?,
        certificates: certify_designs(&synthesised, None),
        comparison: compare_designs(project, &modelled, &synthesised, tuned_pi.as_ref())?,
        views: design_views(&modelled, &reduced, &synthesised)?,
        modelled,
        reduced,
        synthesised,
    })
}

/// Returns the design that a project asks for; every project that was designed has one.
fn design_request(project: &Project) -> Result<DesignRequest, PipelineError> {
    let missing = PipelineError::Missing { section: "synth", needed_by: "the design" };
    project.synth.clone().ok_or(missing)
}

/// Writes the code in each kind of numbers and puts it beside what was found of them.
///
/// # Errors
/// Those of the realisations.
fn study_targets(
    origin: &CodeOrigin<'_>,
    stages: &DesignStages,
    studied: StudiedTargets,
) -> Result<TargetStudy, PipelineError> {
    let CodeOrigin { project, words, world } = *origin;
    let StudiedTargets { compared, by_form } = studied;
    let programs = stages.verified.controller().programs();
    Ok(TargetStudy {
        code: every_target(project, &stages.verified, &compared, words, world)?,
        operations: OperationCounts {
            multiplications: programs.step.multiplications(),
            additions: programs.step.additions(),
            states: programs.state_count(),
        },
        forms: path_forms(&stages.verified)?,
        by_form,
        compared,
    })
}
