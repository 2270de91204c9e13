//! What a dragged weight shows at once: the design, its loop, and the linear responses, from the pipeline that the command line runs.

use std::sync::Arc;
use std::time::{Duration, Instant};

use counterpoise_lti::{Margins, margins};
use counterpoise_models::Parameters;
use counterpoise_pipeline::{self as pipeline, Modelled, PipelineError, Reduced, Synthesised};
use counterpoise_project::{Modelling, Project, Reduction};
use counterpoise_verify::linear::closed::resolver_use;
use counterpoise_verify::linear::frequency::grid_hz;
use counterpoise_verify::linear::plant::Resolver;
use counterpoise_verify::linear::{self, Closed, Curves, PlantResponse, SampledPlant, arranged};
use counterpoise_verify::{ARRANGEMENTS, Arrangement, History, Procedure, Source, Step};

/// Seconds of heave and pitch that are shown while a weight is dragged.
const SHOWN_S: f64 = 2.0;
/// Seconds of the step.
const STEP_S: f64 = 1.0;

/// What is asked of the live road.
#[derive(Debug, Clone)]
pub struct Ask {
    /// The project.
    pub project: Arc<Project>,
    /// The design at another out-of-balance than the project's, kg m.
    pub out_of_balance_kg_m: Option<f64>,
}

/// A design with its linear consequences.
#[derive(Debug, Clone)]
pub struct Live {
    /// The project that it was made from.
    pub project: Arc<Project>,
    /// The plant.
    pub modelled: Arc<Modelled>,
    /// The plant that the design took.
    pub reduced: Arc<Reduced>,
    /// The design.
    pub synthesised: Synthesised,
    /// All margins of the loop.
    pub margins: Margins,
    /// Frequency responses.
    pub curves: Curves,
    /// The response to a step of the demand.
    pub step: History,
    /// The responses to heave, then to pitch, in each arrangement.
    pub motions: Vec<History>,
    /// What it took.
    pub took: Duration,
    /// The out-of-balance that was tried, kg m.
    pub tried_kg_m: Option<f64>,
}

/// What stays the same while weights change.
#[derive(Default)]
pub struct Cache {
    kept: Option<Kept>,
}

type Key = (Parameters, Modelling, Reduction, Option<f64>);

struct Kept {
    key: Key,
    modelled: Arc<Modelled>,
    reduced: Arc<Reduced>,
    sensed: Option<Sensed>,
}

/// The plant as the controller sees it, with what it alone contributes to the pictures.
struct Sensed {
    resolver: Resolver,
    sampled: SampledPlant,
    response: PlantResponse,
    open: Closed,
}

impl Cache {
    /// The plant of a request, made anew only where it differs from the last one.
    fn plant(&mut self, ask: &Ask) -> Result<&mut Kept, PipelineError> {
        let p = &ask.project;
        let key = (p.plant.clone(), p.model.clone(), p.reduce, ask.out_of_balance_kg_m);
        if self.kept.as_ref().is_none_or(|kept| kept.key != key) {
            self.kept = None;
            self.kept = Some(Kept::new(ask, key)?);
        }
        self.kept.as_mut().ok_or(PipelineError::Missing { section: "plant", needed_by: "the design" })
    }
}

impl Kept {
    fn new(ask: &Ask, key: Key) -> Result<Self, PipelineError> {
        let modelled = modelled(ask)?;
        let reduced = pipeline::reduce(&ask.project, &modelled)?;
        Ok(Self { key, modelled: Arc::new(modelled), reduced: Arc::new(reduced), sensed: None })
    }

    fn sensed(&mut self, resolver: Resolver) -> Result<&Sensed, PipelineError> {
        match self.sensed.take() {
            Some(kept) if kept.resolver == resolver => Ok(self.sensed.insert(kept)),
            _ => Ok(self.sensed.insert(Sensed::new(&self.modelled, resolver)?)),
        }
    }
}

impl Sensed {
    fn new(modelled: &Modelled, resolver: Resolver) -> Result<Self, PipelineError> {
        let sampled = SampledPlant::new(&modelled.linear, &modelled.parameters, resolver)?;
        let response = PlantResponse::of(&sampled, grid_hz(sampled.sample_period_s))?;
        let open = Closed::new(&sampled, None, modelled.plant.body().out_of_balance_kg_m)?;
        Ok(Self { resolver, sampled, response, open })
    }
}

/// The plant, at the out-of-balance that is tried where one is.
fn modelled(ask: &Ask) -> Result<Modelled, PipelineError> {
    let made = pipeline::model(&ask.project)?;
    let Some(moment) = ask.out_of_balance_kg_m else { return Ok(made) };
    let mut tried = Project::clone(&ask.project);
    tried.plant = made.parameters;
    tried.model.configuration = None;
    if let Some(lumped) = &mut tried.plant.lumped {
        lumped.out_of_balance_kg_m = moment;
    }
    pipeline::model(&tried)
}

/// The design and its linear consequences.
///
/// # Errors
/// Those of the pipeline, with every reason why there is no controller.
pub fn live(ask: &Ask, cache: &mut Cache) -> Result<Live, PipelineError> {
    let begun = Instant::now();
    let kept = cache.plant(ask)?;
    let synthesised = pipeline::synthesise(&ask.project, &kept.modelled, &kept.reduced)?;
    let (modelled, reduced) = (Arc::clone(&kept.modelled), Arc::clone(&kept.reduced));
    let sensed = kept.sensed(resolver_use(&synthesised.sampled.controller))?;
    let loops = loops(sensed, &synthesised, &modelled)?;
    let shown = consequences(&ask.project, sensed, &loops)?;
    Ok(Live {
        project: Arc::clone(&ask.project),
        modelled,
        reduced,
        margins: shown.margins,
        curves: shown.curves,
        step: shown.step,
        motions: shown.motions,
        synthesised,
        took: begun.elapsed(),
        tried_kg_m: ask.out_of_balance_kg_m,
    })
}

type Loops = [(Arrangement, Closed)];

/// The loop in each arrangement; the feedback alone stands before the whole controller.
fn loops(
    sensed: &Sensed,
    synthesised: &Synthesised,
    modelled: &Modelled,
) -> Result<Vec<(Arrangement, Closed)>, PipelineError> {
    let (controller, moment) = (&synthesised.sampled.controller, modelled.plant.body().out_of_balance_kg_m);
    let mut loops = vec![(Arrangement::Uncontrolled, sensed.open.clone())];
    for arrangement in ARRANGEMENTS.into_iter().skip(1) {
        let acting = arranged(controller, arrangement)?;
        loops.push((arrangement, Closed::new(&sensed.sampled, acting.as_ref(), moment)?));
    }
    Ok(loops)
}

struct Shown {
    margins: Margins,
    curves: Curves,
    step: History,
    motions: Vec<History>,
}

/// What the loops do. Paths that see the platform alone are at rest in a step and outside the loop's return path, so the
/// margins and the step are those of the feedback alone.
fn consequences(project: &Project, sensed: &Sensed, loops: &Loops) -> Result<Shown, PipelineError> {
    let none = || PipelineError::Missing { section: "synth", needed_by: "the loop" };
    let ([.., (_, feedback), (_, whole)], sampled) = (loops, &sensed.sampled) else { return Err(none()) };
    let procedure = project.verify.as_ref().map_or_else(Procedure::default, |v| v.procedure.clone());
    let motions = |source: Source| -> Result<Vec<History>, PipelineError> {
        let motion = |time_s: f64| procedure.motion(source, time_s);
        let one = |(arrangement, closed): &(Arrangement, Closed)| {
            Ok(linear::disturbance(sampled, closed, (source, *arrangement), SHOWN_S, motion)?)
        };
        loops.iter().map(one).collect()
    };
    std::thread::scope(|scope| {
        let moved = scope.spawn(|| Ok([motions(Source::Heave)?, motions(Source::Pitch)?].concat()));
        let mut margins = margins(feedback.broken.as_ref().ok_or_else(none)?)?;
        margins.closed_loop_stable &= whole.pole_radius() < 1.0;
        let curves = Curves::with(sampled, &sensed.response, loops)?;
        let step = linear::step(sampled, feedback, Step { duration_s: STEP_S, ..procedure.step })?;
        let motions = moved.join().unwrap_or_else(|_| Err(none()))?;
        Ok(Shown { margins, curves, step, motions })
    })
}

/// Every reason in an error, one a line.
pub fn reasons(error: &PipelineError) -> Vec<String> {
    match error {
        PipelineError::NoController(findings) => findings.iter().map(ToString::to_string).collect(),
        other => vec![other.to_string()],
    }
}
