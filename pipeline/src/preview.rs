//! A design with its linear consequences, made in a few milliseconds: margins, frequency responses, step and platform motion.
//!
//! The plant of the last request is kept in a [`PreviewCache`], so that a change of a weight costs the design and its responses only.

use std::f64::consts::TAU;
use std::sync::Arc;

use counterpoise_diagnose::learning::reading::{ReadElement, read_elements};
use counterpoise_lti::{Margins, StateSpace, provisional_margins};
use counterpoise_pool::{Pool, map};
use counterpoise_project::Project;
use counterpoise_verify::linear_loop::closed_loop::resolver_use;
use counterpoise_verify::linear_loop::frequency::grid_hz;
use counterpoise_verify::linear_loop::plant::Resolver;
use counterpoise_verify::linear_loop::{
    self, ArrangedLoop, ClosedLoop, Curves, PlantResponse, SampledPlant, arrange_controller,
};
use counterpoise_verify::{
    ARRANGEMENTS, Arrangement, Experiment, History, Procedure, Requirement, Source, Step,
};

use crate::design_views::FrequencyResponse;
use crate::first_design::leaves_weights_open;
use crate::loop_view::{LoopPlane, LoopView};
use crate::{
    PipelineError, PlantModel, ReducedPlant, SynthesisedDesign, build_plant_model, choose_weights,
    reduce_plant, synthesise, with_chosen_weights,
};

/// Duration of the responses to heave and pitch, s: long enough for two periods of the slowest usual motion, short enough to drag.
const MOTION_S: f64 = 2.0;
/// Duration of the response to a step of the demand, s.
const STEP_S: f64 = 1.0;

/// The design that is asked for.
#[derive(Debug, Clone)]
pub struct PreviewRequest {
    /// The project.
    pub project: Arc<Project>,
    /// The first moment of mass to design for instead of the project's, kg m.
    pub out_of_balance_kg_m: Option<f64>,
}

/// The plant of a request.
#[derive(Debug, Clone)]
pub struct PlantPreview {
    /// The full plant.
    pub modelled: Arc<PlantModel>,
    /// The reduced plant.
    pub reduced: Arc<ReducedPlant>,
    /// The free functions of the plant, with their bands and the recordings' coverage.
    pub learned: Vec<ReadElement>,
}

/// A design with its linear consequences.
#[derive(Debug, Clone)]
pub struct DesignPreview {
    /// The project that the design was made from.
    pub project: Arc<Project>,
    /// The full plant.
    pub modelled: Arc<PlantModel>,
    /// The reduced plant that the synthesis used.
    pub reduced: Arc<ReducedPlant>,
    /// The controller.
    pub synthesised: SynthesisedDesign,
    /// The loop broken at the plant's input, for negative feedback.
    pub broken: StateSpace,
    /// All margins of the feedback loop, as [`provisional_margins`] gives them.
    pub margins: Margins,
    /// Frequency responses.
    pub curves: Curves,
    /// The loop over frequency, as a Bode diagram shows it.
    pub loop_response: FrequencyResponse,
    /// The loop in the complex plane, at the frequencies of the other responses.
    pub plane: LoopPlane,
    /// The response to a step of the demand.
    pub step: History,
    /// The responses to heave, then to pitch, in each arrangement of the controller.
    pub motions: Vec<History>,
    /// The first moment of mass that was tried instead of the project's, kg m.
    pub trial_moment_kg_m: Option<f64>,
}

impl DesignPreview {
    /// Returns the response to a motion of the platform in an arrangement of the controller.
    pub fn motion(&self, source: Source, arrangement: Arrangement) -> Option<&History> {
        let wanted = Experiment::Disturbance(source, arrangement);
        self.motions.iter().find(|history| history.experiment == wanted)
    }

    /// Returns the overshoot of the response to a step of the demand, percent of the demand; 0 without overshoot.
    pub fn overshoot_percent(&self) -> f64 {
        let demand = self.step.demand_rad_s().iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        let top = self.step.hub_rate_rad_s().iter().copied().fold(0.0, f64::max);
        (100.0 * (top / demand - 1.0)).max(0.0)
    }

    /// Returns the control of a response about the value that holds the weight of the mechanism, V.
    pub fn control_about_holding_v(&self, response: &History) -> Vec<f64> {
        let holding_v = self.modelled.linear.equilibrium.control_v;
        response.control_v().iter().map(|control_v| control_v - holding_v).collect()
    }

    /// Returns the largest change of the control in the response to a step of the demand, V.
    pub fn step_control_v(&self) -> f64 {
        let control_v = self.step.control_v();
        let first = control_v.first().copied().unwrap_or_default();
        control_v.iter().map(|v| (v - first).abs()).fold(0.0, f64::max)
    }

    /// Returns the largest hub rate in the second half of a motion of the platform with the whole controller, rad/s. The first half
    /// is left out because it contains the transient of the start.
    pub fn residual_hub_rate_rad_s(&self, source: Source) -> f64 {
        let history = self.motion(source, Arrangement::Compensated);
        let hub = history.map_or(&[][..], History::hub_rate_rad_s);
        hub.iter().skip(hub.len() / 2).map(|v| v.abs()).fold(0.0, f64::max)
    }

    /// Returns the highest frequency at which the loop gain crosses 1, Hz; 0 if it never does.
    pub fn crossover_hz(&self) -> f64 {
        self.margins.phase.iter().map(|p| p.rate_rad_s).fold(0.0, f64::max) / TAU
    }
}

/// Values that the last request computed and the next one may reuse: its plant, with what that alone contributes to the responses, and the
/// weights that were chosen.
#[derive(Default)]
pub struct PreviewCache {
    kept: Option<CachedPlant>,
    choice: Option<CachedChoice>,
}

struct CachedPlant {
    project: Arc<Project>,
    out_of_balance_kg_m: Option<f64>,
    modelled: Arc<PlantModel>,
    reduced: Arc<ReducedPlant>,
    sampled: Option<SampledViews>,
}

/// A project that states no weights, and what was decided for it: its weights, and the step of the demand.
struct CachedChoice {
    project: Arc<Project>,
    decided: Project,
}

/// The sampled plant as the controller sees it, with its own response and the loop without a controller.
struct SampledViews {
    resolver: Resolver,
    plant: SampledPlant,
    response: PlantResponse,
    uncontrolled: ClosedLoop,
}

impl PreviewCache {
    /// Returns the plant of a request; it is made again only if it differs from the last one.
    fn plant(&mut self, request: &PreviewRequest) -> Result<&mut CachedPlant, PipelineError> {
        let is_kept = |kept: &CachedPlant| {
            kept.out_of_balance_kg_m == request.out_of_balance_kg_m
                && has_same_plant(&kept.project, &request.project)
        };
        if !self.kept.as_ref().is_some_and(is_kept) {
            self.kept = None;
            self.kept = Some(CachedPlant::new(request)?);
        }
        self.kept.as_mut().ok_or(PipelineError::Missing { section: "plant", needed_by: "the design" })
    }

    /// Returns the project of a request with its weights; they are chosen again only if something changed that the choice depends on.
    fn with_weights(&mut self, request: &PreviewRequest) -> Result<Arc<Project>, PipelineError> {
        let asked = &request.project;
        if !leaves_weights_open(asked) {
            return Ok(Arc::clone(asked));
        }
        let is_kept = |kept: &CachedChoice| {
            has_same_plant(&kept.project, asked)
                && kept.project.synth == asked.synth
                && kept.project.verify == asked.verify
        };
        if !self.choice.as_ref().is_some_and(is_kept) {
            self.choice = None;
            let decided = self.choose(request)?;
            self.choice = Some(CachedChoice { project: Arc::clone(asked), decided });
        }
        let Some(CachedChoice { decided, .. }) = &self.choice else { return Ok(Arc::clone(asked)) };
        let (synth, verify) = (decided.synth.clone(), decided.verify.clone());
        Ok(Arc::new(Project { synth, verify, ..Project::clone(asked) }))
    }

    /// Chooses the weights for the project's own plant, which is the request's if no other moment of mass is tried.
    fn choose(&mut self, request: &PreviewRequest) -> Result<Project, PipelineError> {
        if request.out_of_balance_kg_m.is_some() {
            let chosen = with_chosen_weights(&request.project)?;
            return Ok(chosen.map_or_else(|| Project::clone(&request.project), |chosen| chosen.project));
        }
        let kept = self.plant(request)?;
        Ok(choose_weights(&request.project, &kept.modelled, &kept.reduced)?.project)
    }
}

impl CachedPlant {
    fn new(request: &PreviewRequest) -> Result<Self, PipelineError> {
        let modelled = modelled_for(request)?;
        let reduced = reduce_plant(&request.project, &modelled)?;
        Ok(Self {
            project: Arc::clone(&request.project),
            out_of_balance_kg_m: request.out_of_balance_kg_m,
            modelled: Arc::new(modelled),
            reduced: Arc::new(reduced),
            sampled: None,
        })
    }

    fn sampled_views(&mut self, resolver: Resolver) -> Result<&SampledViews, PipelineError> {
        match self.sampled.take() {
            Some(kept) if kept.resolver == resolver => Ok(self.sampled.insert(kept)),
            _ => Ok(self.sampled.insert(SampledViews::new(&self.modelled, resolver)?)),
        }
    }
}

impl SampledViews {
    fn new(modelled: &PlantModel, resolver: Resolver) -> Result<Self, PipelineError> {
        let plant = SampledPlant::new(&modelled.linear, &modelled.parameters, resolver)?;
        let response = PlantResponse::of(&plant, grid_hz(plant.sample_period_s))?;
        let uncontrolled = ClosedLoop::new(&plant, None, modelled.plant.body().out_of_balance_kg_m)?;
        Ok(Self { resolver, plant, response, uncontrolled })
    }
}

/// Returns whether the plants of two projects are the same.
fn has_same_plant(a: &Arc<Project>, b: &Arc<Project>) -> bool {
    Arc::ptr_eq(a, b)
        || (a.plant == b.plant && a.import == b.import && a.model == b.model && a.reduce == b.reduce)
}

/// Returns the full plant, at the first moment of mass that is tried if there is one.
fn modelled_for(request: &PreviewRequest) -> Result<PlantModel, PipelineError> {
    let made = build_plant_model(&request.project)?;
    let Some(moment) = request.out_of_balance_kg_m else { return Ok(made) };
    let mut tried = Project::clone(&request.project);
    tried.plant = made.parameters;
    tried.model.configuration = None;
    if let Some(lumped) = &mut tried.plant.lumped {
        lumped.out_of_balance_kg_m = moment;
    }
    build_plant_model(&tried)
}

/// Returns the plant of a request, which needs no controller.
///
/// # Errors
/// Returns the errors of the model and of its reduction.
pub fn preview_plant(
    request: &PreviewRequest,
    cache: &mut PreviewCache,
) -> Result<PlantPreview, PipelineError> {
    let kept = cache.plant(request)?;
    let learned = read_elements(&kept.modelled.parameters.learned);
    Ok(PlantPreview { modelled: Arc::clone(&kept.modelled), reduced: Arc::clone(&kept.reduced), learned })
}

/// Designs the controller and computes its linear consequences. Weights that the project does not state are chosen. `pool` runs the two independent halves side by side.
///
/// # Errors
/// Returns the errors of the pipeline, among them every reason why there is no controller.
pub fn preview_design(
    request: &PreviewRequest,
    cache: &mut PreviewCache,
    pool: &dyn Pool,
) -> Result<DesignPreview, PipelineError> {
    let project = cache.with_weights(request)?;
    let kept = cache.plant(request)?;
    let synthesised = synthesise(&project, &kept.modelled, &kept.reduced)?;
    let (modelled, reduced) = (Arc::clone(&kept.modelled), Arc::clone(&kept.reduced));
    let sampled = kept.sampled_views(resolver_use(&synthesised.sampled.controller))?;
    let loops = close_loops(sampled, &synthesised, &modelled)?;
    let responses = Responses { project: &project, sampled, loops: &loops };
    let LinearResponses { margins, curves, step, motions } = responses.compute(pool)?;
    let broken = responses.feedback()?.1.clone();
    let response = &curves.broken.response;
    Ok(DesignPreview {
        loop_response: FrequencyResponse::of("L", &curves.frequency_hz, response),
        plane: LoopPlane::new(response, &margins, required_of(&project)),
        project,
        modelled,
        reduced,
        synthesised,
        broken,
        margins,
        curves,
        step,
        motions,
        trial_moment_kg_m: request.out_of_balance_kg_m,
    })
}

/// Returns the charts of the loop of a design, with points close enough for a plane, and its root locus.
///
/// # Errors
/// A frequency response that does not exist, or eigenvalues that were not found.
pub fn preview_loop(design: &DesignPreview) -> Result<LoopView, PipelineError> {
    let sample_period_s = design.modelled.parameters.interface.sample_period_s;
    let shape = linear_loop::loop_shape(&design.broken, &design.curves, sample_period_s)?;
    Ok(LoopView::new(&shape, &design.margins, required_of(&design.project)))
}

/// Returns the requirements that a project states.
fn required_of(project: &Project) -> &[Requirement] {
    project.verify.as_ref().map_or(&[], |verify| &verify.requirements)
}

/// Returns the loop in each arrangement of the controller; the feedback alone stands before the whole controller.
fn close_loops(
    sampled: &SampledViews,
    synthesised: &SynthesisedDesign,
    modelled: &PlantModel,
) -> Result<Vec<ArrangedLoop>, PipelineError> {
    let (controller, moment) = (&synthesised.sampled.controller, modelled.plant.body().out_of_balance_kg_m);
    let uncontrolled = sampled.uncontrolled.clone();
    let mut loops = vec![ArrangedLoop { arrangement: Arrangement::Uncontrolled, closed: uncontrolled }];
    for arrangement in ARRANGEMENTS.into_iter().skip(1) {
        let acting = arrange_controller(controller, arrangement)?;
        let closed = ClosedLoop::new(&sampled.plant, acting.as_ref(), moment)?;
        loops.push(ArrangedLoop { arrangement, closed });
    }
    Ok(loops)
}

/// The systems that the responses are computed from.
struct Responses<'a> {
    project: &'a Project,
    sampled: &'a SampledViews,
    loops: &'a [ArrangedLoop],
}

/// The linear consequences of a design.
struct LinearResponses {
    margins: Margins,
    curves: Curves,
    step: History,
    motions: Vec<History>,
}

/// One of the two halves of the computation.
enum Half {
    Loop(Box<(Margins, Curves, History)>),
    Motions(Vec<History>),
}

fn missing_loop() -> PipelineError {
    PipelineError::Missing { section: "synth", needed_by: "the loop" }
}

impl Responses<'_> {
    fn compute(&self, pool: &dyn Pool) -> Result<LinearResponses, PipelineError> {
        let halves = map(pool, 2, |k| if k == 0 { self.platform_motions() } else { self.loop_responses() });
        let mut halves = halves.into_iter();
        match (halves.next().transpose()?, halves.next().transpose()?) {
            (Some(Half::Motions(motions)), Some(Half::Loop(parts))) => {
                let (margins, curves, step) = *parts;
                Ok(LinearResponses { margins, curves, step, motions })
            }
            _ => Err(missing_loop()),
        }
    }

    fn procedure(&self) -> Procedure {
        self.project.verify.as_ref().map_or_else(Procedure::default, |v| v.procedure.clone())
    }

    fn platform_motions(&self) -> Result<Half, PipelineError> {
        let procedure = self.procedure();
        let mut motions = Vec::new();
        for source in [Source::Heave, Source::Pitch] {
            for ArrangedLoop { arrangement, closed } in self.loops {
                let motion = |time_s: f64| procedure.motion(source, time_s);
                let plant = &self.sampled.plant;
                motions.push(linear_loop::simulate_disturbance(
                    plant,
                    closed,
                    source,
                    *arrangement,
                    MOTION_S,
                    motion,
                )?);
            }
        }
        Ok(Half::Motions(motions))
    }

    /// Returns the loop of the feedback alone, closed and broken at the plant's input.
    fn feedback(&self) -> Result<(&ClosedLoop, &StateSpace), PipelineError> {
        let [.., ArrangedLoop { closed: feedback, .. }, _] = self.loops else { return Err(missing_loop()) };
        Ok((feedback, feedback.broken.as_ref().ok_or_else(missing_loop)?))
    }

    /// Computes margins, frequency responses and the step. Paths that see the platform alone are at rest in a step and outside the
    /// loop's return path, so the margins and the step are those of the feedback alone.
    fn loop_responses(&self) -> Result<Half, PipelineError> {
        let (feedback, broken) = self.feedback()?;
        let [.., ArrangedLoop { closed: whole, .. }] = self.loops else { return Err(missing_loop()) };
        let mut margins = provisional_margins(broken)?;
        margins.closed_loop_stable &= whole.pole_radius() < 1.0;
        let plant = &self.sampled.plant;
        let curves = Curves::with(plant, &self.sampled.response, self.loops)?;
        let step = linear_loop::simulate_step(
            plant,
            feedback,
            Step { duration_s: STEP_S, ..self.procedure().step },
        )?;
        Ok(Half::Loop(Box::new((margins, curves, step))))
    }
}
