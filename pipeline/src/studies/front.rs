//! The front of a project's designs: the kinds that may stand in the place of its feedback, each with the designs of which none is better than another in
//! every objective, on the same plant and for the same motion; and the project with one of them.

use counterpoise_pool::Pool;
use counterpoise_project::Project;
use counterpoise_project::resolve::fixed_structure::{TuningObjective, TuningOptions};
use counterpoise_project::resolve::front::FrontOptions;
use counterpoise_project::resolve::synthesis::{DesignRequest, LoopKind};
use counterpoise_synth::front::{dominates, nondominated_places};
use counterpoise_synth::tuning::measure_loop;
use counterpoise_synth::{
    Assembly, DesignFront, DesignPlant, FixedStructure, FrontMethod, FrontObjective, FrontPoint, FrontTask,
    LoopLimits, LoopMeasures, Reference, SynthesisMethod, TunedFeedback, TuningSubject, TuningTask,
    measure_controller, sampled_plant, search_front,
};

use super::designs::{
    LimitsResult, TUNED_PI, TableObjective, limits_of, own_name, pi_with_lag, structures, three_part,
    variants,
};
use super::front_edges::{PlacedFigures, best_figures, best_places};
use crate::exchange::UnitValue;
use crate::tolerance::TUNED_LIMIT_KEPT;
use crate::tuning::{
    BlockResult, LoopMeasuresResult, MeasuredLoops, TuningGround, WeightsResult, block_results,
    own_procedure, put_in_place, tune_feedback, tuning_ground, weights_result,
};
use crate::{
    PipelineError, PipelineStage, PlantModel, ProjectIdentity, ReducedPlant, World, build_plant_model,
    reduce_plant, run_observed, synthesise,
};

/// The front of a project's designs.
#[derive(Debug)]
pub struct ProjectFront {
    /// Name and hash of the project.
    pub identity: ProjectIdentity,
    /// The quantity that the loops control, and in which units their figures are.
    pub loops: MeasuredLoops,
    /// What the residual is.
    pub objective: TableObjective,
    /// Whether the residual is that of the project's own motion; otherwise of the sines of the procedure, or of a band.
    pub has_own_motion: bool,
    /// The objectives that are traded.
    pub objectives: Vec<FrontObjective>,
    /// Limits that every design keeps.
    pub limits: LimitsResult,
    /// Method of the search.
    pub method: FrontMethod,
    /// Plants on which every design was measured.
    pub plants: usize,
    /// The disturbance of the linear loop: frequency in rad/s and power of each line at the output without feedback, in the square of the
    /// unit of what the loop controls.
    pub disturbance: Vec<[f64; 2]>,
    /// RMS of the white noise of a reading.
    pub reading_noise: UnitValue<f64>,
    /// The kinds of designs, the project's own first.
    pub kinds: Vec<FrontKind>,
    /// The designs, numbered from 1 in this order: kind by kind, each by the first objective.
    pub points: Vec<KindPoint>,
    /// The best figure of any design in each objective.
    pub best: Vec<f64>,
    /// Single designs to compare with: the project's own, other methods, and the PI with a lag that is tuned under the limits which the
    /// project's own design reaches.
    pub references: Vec<ReferenceDesign>,
}

/// A kind of design.
#[derive(Debug)]
pub struct FrontKind {
    /// Name.
    pub name: String,
    /// Its part in the comparison.
    pub role: KindRole,
    /// Feedbacks that were evaluated.
    pub evaluations: usize,
    /// Whether the search went to its end.
    pub is_complete: bool,
    /// For each objective but the first one: the places among the designs of those of this kind that no other of the kind beats in it and in the first
    /// objective, by rising figure.
    pub edges: Vec<Vec<usize>>,
    /// Why there is no front; `None` if there is one.
    pub why: Option<counterpoise_synth::Error>,
}

/// Part of a kind in the comparison.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum KindRole {
    /// The project's own kind.
    Own,
    /// The PI with a lag, which every other design should beat.
    Bar,
    /// Another kind.
    Other,
}

/// A design of the front.
#[derive(Debug)]
pub struct KindPoint {
    /// Place of its kind.
    pub kind: usize,
    /// The design.
    pub point: FrontPoint,
    /// Figures of the loop on the nominal plant.
    pub linear: Option<LoopMeasuresResult>,
    /// The blocks of a structure.
    pub blocks: Vec<BlockResult>,
    /// The weights of an H2 feedback.
    pub weights: Option<WeightsResult>,
    /// Whether no other design of any kind is better in every objective.
    pub is_nondominated: bool,
    /// Whether no PI with a lag is better in every objective.
    pub clears_bar: bool,
}

/// A single design to compare with.
#[derive(Debug)]
pub struct ReferenceDesign {
    /// Name.
    pub name: String,
    /// Figures of the loop on the nominal plant.
    pub linear: LoopMeasuresResult,
    /// The figure of each objective on the worst plant.
    pub figures: Vec<f64>,
}

/// Rounds in which the mechanism of a sweep that is the worst of most designs joins the plants of the search.
const WORST_ROUNDS: usize = 2;

/// Searches the front of every kind of design that suits the project.
///
/// # Errors
/// Those of the plant, of the project's own design and of the disturbance; [`PipelineError::NoFront`] if no kind has a design within the limits.
pub fn project_front(
    project: &Project,
    options: &FrontOptions,
    world: &dyn World,
) -> Result<ProjectFront, PipelineError> {
    let modelled = build_plant_model(project)?;
    let reduced = reduce_plant(project, &modelled)?;
    let asked = project.synth.clone().unwrap_or_default();
    let wanted = asked.options.tuning.clone().unwrap_or_default();
    let ground = tuning_ground(project, &modelled, &reduced, &wanted, world)?;
    let stage =
        FrontStage { project, asked: &asked, modelled: &modelled, reduced: &reduced, ground: &ground, world };
    let own = stage.own_designs(&options.objectives)?;
    let mut limits = options.limits;
    if limits.decay_rad_s == 0.0 {
        // A slow pole costs little under a motion and shows in every step.
        limits.decay_rad_s = own[0].linear.decay_rad_s.max(0.0);
    }
    let options = FrontOptions { limits, ..options.clone() };
    let KindFronts { mut kinds, mut points } = stage.search_kinds(&options)?;
    if points.is_empty() {
        let LoopLimits { max_sensitivity: ms, max_complementary: mt, decay_rad_s, .. } = limits;
        let why = kinds.iter_mut().find_map(|kind| kind.why.take()).map(Box::new);
        return Err(PipelineError::NoFront { ms, mt, decay_rad_s, why });
    }
    rate_points(&mut points, &kinds, &options.objectives);
    for (k, kind) in kinds.iter_mut().enumerate() {
        kind.edges = best_places(&placed_figures(&points, |point| point.kind == k), &options.objectives);
    }
    let mut references = own;
    references.extend(stage.tuned_bar(&references[0], &wanted, &options.objectives));
    let controlled = project.plant.controlled_quantity();
    Ok(ProjectFront {
        identity: ProjectIdentity::of(project, world),
        loops: ground.measured_loops(controlled),
        objective: match ground.objective {
            TuningObjective::Motion => TableObjective::Motion,
            TuningObjective::Band => TableObjective::Band(wanted.band_rad_s),
        },
        has_own_motion: own_procedure(project, world)?.road.is_some(),
        best: best_figures(&placed_figures(&points, |_| true), &options.objectives),
        points,
        objectives: options.objectives,
        limits: LimitsResult::from(&limits),
        method: options.method,
        plants: ground.plants.len() + ground.mechanisms.len(),
        disturbance: ground.disturbance.lines.clone(),
        reading_noise: UnitValue::new("reading_noise", controlled, ground.disturbance.reading_noise_rad_s),
        kinds,
        references,
    })
}

/// Returns the figures of the designs that are chosen, with their places among all.
fn placed_figures(points: &[KindPoint], is_chosen: impl Fn(&KindPoint) -> bool) -> Vec<PlacedFigures<'_>> {
    let chosen = points.iter().enumerate().filter(|(_, point)| is_chosen(point));
    chosen.map(|(place, point)| PlacedFigures { place, figures: &point.point.figures }).collect()
}

/// Marks which designs stand against those of every kind, and which against the bar.
fn rate_points(points: &mut [KindPoint], kinds: &[FrontKind], objectives: &[FrontObjective]) {
    let costs: Vec<Vec<f64>> = points.iter().map(|each| each.point.costs(objectives)).collect();
    let stands = nondominated_places(&costs);
    let of_bar: Vec<usize> =
        (0..points.len()).filter(|&k| kinds[points[k].kind].role == KindRole::Bar).collect();
    for (k, each) in points.iter_mut().enumerate() {
        each.is_nondominated = stands.contains(&k);
        each.clears_bar = !of_bar.iter().any(|&bar| dominates(&costs[bar], &costs[k]));
    }
}

/// Returns the front that a project asks for, the usual one if its file says nothing of a search; `None` if it states requirements of a search for
/// weights and no front.
pub fn asked_front(project: &Project) -> Option<FrontOptions> {
    let stated = project.synth.as_ref().map(|synth| &synth.options);
    match stated.and_then(|stated| stated.front.clone()) {
        Some(front) => Some(front),
        None => stated.is_none_or(|stated| stated.search.is_none()).then(FrontOptions::default),
    }
}

/// Returns the project with a design of its front in the place of its feedback; `None` if there is no design of this number.
pub fn project_with_point(project: &Project, front: &ProjectFront, number: usize) -> Option<Project> {
    let chosen = front.points.get(number.checked_sub(1)?)?;
    let mut synthesis = project.synth.clone().unwrap_or_default();
    put_feedback_in_place(&chosen.point.feedback, &mut synthesis);
    Some(Project { synth: Some(synthesis), ..project.clone() })
}

fn put_feedback_in_place(feedback: &TunedFeedback, synthesis: &mut DesignRequest) {
    synthesis.options.remove_fixed_feedback();
    put_in_place(feedback, synthesis);
    synthesis.options.method = SynthesisMethod::ThreePart;
    synthesis.options.controller_order = None;
    if synthesis.specification.assembly == Assembly::Joint {
        synthesis.specification.assembly = Assembly::SimpleAdd;
    }
    synthesis.specification.reference = Reference::Error;
}

/// The processors for one of several kinds of designs, whose progress is a part of that of all.
struct KindPool<'a> {
    pool: &'a dyn Pool,
    place: usize,
    count: usize,
}

impl Pool for KindPool<'_> {
    fn run(&self, count: usize, job: &(dyn Fn(usize) + Sync)) {
        self.pool.run(count, job);
    }

    fn processors(&self) -> usize {
        self.pool.processors()
    }

    fn is_cancelled(&self) -> bool {
        self.pool.is_cancelled()
    }

    fn progress(&self, stage: &str, done: usize, of: usize) {
        self.pool.progress(stage, self.place * of + done, self.count * of);
    }
}

/// The kinds of a front and their designs, before they are compared.
struct KindFronts {
    kinds: Vec<FrontKind>,
    points: Vec<KindPoint>,
}

fn feedback_blocks(feedback: &TunedFeedback) -> Vec<BlockResult> {
    match feedback {
        TunedFeedback::Structure(structure) => block_results(structure),
        TunedFeedback::Weights(_) => Vec::new(),
    }
}

/// What every kind of a front has in common.
struct FrontStage<'a> {
    project: &'a Project,
    asked: &'a DesignRequest,
    modelled: &'a PlantModel,
    reduced: &'a ReducedPlant,
    ground: &'a TuningGround,
    world: &'a dyn World,
}

impl FrontStage<'_> {
    /// The kinds with their names and structures; the weights of the H2 feedback have none. Blocks whose parameters all have values are one design and
    /// no kind.
    fn kinds(&self) -> Vec<(String, KindRole, Option<FixedStructure>)> {
        let own = &self.asked.options.structure;
        let kinds_of = |structure: &FixedStructure| -> Vec<_> {
            structure.blocks.iter().map(|block| block.kind).collect()
        };
        let mut all = Vec::new();
        if own.blocks.is_empty() {
            all.push(("H2, weights".to_owned(), KindRole::Own, None));
        } else if own.is_open() {
            all.push((own.name(), KindRole::Own, Some(own.clone())));
        }
        if self.asked.loop_kind == LoopKind::Cascade {
            // A feedback of blocks has no inner loop.
            return all;
        }
        let roles = [KindRole::Bar, KindRole::Other];
        for ((name, structure), role) in structures().into_iter().zip(roles) {
            let name = name.trim_start_matches("tuned ").to_owned();
            // An open structure of the file with the same blocks has its ranges, and takes the place of this one.
            if !own.is_open() || kinds_of(&structure) != kinds_of(own) {
                all.push((name, role, Some(structure)));
            } else if role == KindRole::Bar {
                all[0].1 = role;
            }
        }
        all
    }

    /// The front of each kind. A kind that cannot be searched says why.
    fn search_kinds(&self, options: &FrontOptions) -> Result<KindFronts, PipelineError> {
        let from = three_part(self.asked);
        let (mut kinds, mut points) = (Vec::new(), Vec::new());
        let all = self.kinds();
        let count = all.len();
        for (place, (name, role, structure)) in all.into_iter().enumerate() {
            let pool = KindPool { pool: self.world.pool(), place, count };
            let subject = structure.as_ref().map_or(TuningSubject::Weights(&from), TuningSubject::Structure);
            let found = run_observed(self.world, PipelineStage::Synthesise, || {
                self.kind_front(subject, options, &pool)
            });
            let (front, why) = match found {
                Ok(front) => (front, None),
                Err(PipelineError::Synth(why)) => {
                    (DesignFront { points: vec![], evaluations: 0, is_complete: true }, Some(why))
                }
                Err(other) => return Err(other),
            };
            let kind = kinds.len();
            let DesignFront { points: found, evaluations, is_complete } = front;
            kinds.push(FrontKind { name, role, evaluations, is_complete, edges: Vec::new(), why });
            let loops = self.ground.measured_loops(self.project.plant.controlled_quantity());
            let of_kind = |point: FrontPoint| KindPoint {
                kind,
                linear: point.measures.first().map(|first| LoopMeasuresResult::of(first, loops)),
                blocks: feedback_blocks(&point.feedback),
                weights: weights_result(&point.feedback),
                point,
                is_nondominated: false,
                clears_bar: false,
            };
            points.extend(found.into_iter().map(of_kind));
        }
        Ok(KindFronts { kinds, points })
    }

    /// The front of one kind, by its figures on every plant.
    fn kind_front(
        &self,
        subject: TuningSubject<'_>,
        options: &FrontOptions,
        pool: &KindPool<'_>,
    ) -> Result<DesignFront, PipelineError> {
        let mut plants = self.ground.plants.clone();
        let mut evaluations = 0;
        let mut round = 0;
        loop {
            let mut found = self.search(subject, &plants, options, pool)?;
            evaluations += found.evaluations;
            found.evaluations = evaluations;
            if self.ground.mechanisms.is_empty() {
                return Ok(found);
            }
            let worst = self.measure_mechanisms(&mut found, options)?;
            let further = worst.map(|worst| &self.ground.mechanisms[worst]);
            let further = further.filter(|_| round < WORST_ROUNDS && found.is_complete);
            match further.filter(|plant| !plants.contains(plant)) {
                Some(plant) => plants.push(plant.clone()),
                None => return Ok(found),
            }
            round += 1;
        }
    }

    fn search(
        &self,
        subject: TuningSubject<'_>,
        plants: &[DesignPlant],
        options: &FrontOptions,
        pool: &KindPool<'_>,
    ) -> Result<DesignFront, PipelineError> {
        let tuning = TuningTask {
            subject,
            plants,
            held: &self.ground.held,
            sampling: &self.ground.sampling,
            disturbance: &self.ground.disturbance,
            limits: options.limits,
            starts: 1,
            seed: u64::from(options.seed),
        };
        let task = FrontTask {
            tuning,
            objectives: &options.objectives,
            method: options.method,
            evaluations: options.evaluations,
            points: options.points,
        };
        Ok(search_front(&task, pool)?)
    }

    /// Measures the designs of a front on every mechanism of the sweep, and leaves out those that miss a limit there or are dominated; returns the
    /// mechanism that is the worst of most designs.
    fn measure_mechanisms(
        &self,
        front: &mut DesignFront,
        options: &FrontOptions,
    ) -> Result<Option<usize>, PipelineError> {
        let systems = self
            .ground
            .mechanisms
            .iter()
            .map(|plant| sampled_plant(plant, &self.ground.sampling))
            .collect::<Result<Vec<_>, _>>()?;
        let nominal = self.ground.plants.len();
        let mut votes = vec![0_usize; systems.len()];
        let measured = counterpoise_pool::map_all(self.world.pool(), front.points.len(), |k| {
            let sampled = &front.points[k].sampled;
            let measure = |system| measure_loop(system, sampled, &self.ground.disturbance);
            systems.iter().map(measure).collect::<Result<Vec<LoopMeasures>, _>>()
        });
        let mut kept = Vec::new();
        for (point, measures) in front.points.drain(..).zip(measured) {
            let measures = measures?;
            for objective in &options.objectives {
                let cost = |k: &usize| objective.cost(objective.figure(&measures[*k]));
                let worst = (0..measures.len()).max_by(|a, b| cost(a).total_cmp(&cost(b)));
                worst.into_iter().for_each(|k| votes[k] += 1);
            }
            let all: Vec<LoopMeasures> = [&point.measures[..nominal], &measures].concat();
            let holds = |m: &LoopMeasures| {
                m.decay_rad_s > 0.0 && options.limits.worst_shortfall(m) <= TUNED_LIMIT_KEPT
            };
            if all.iter().all(holds) {
                let figures = options.objectives.iter().map(|each| each.worst_figure(&all)).collect();
                kept.push(FrontPoint { figures, measures: all, ..point });
            }
        }
        let costs: Vec<Vec<f64>> = kept.iter().map(|point| point.costs(&options.objectives)).collect();
        let places = nondominated_places(&costs);
        front.points = places.into_iter().map(|k| kept[k].clone()).collect();
        Ok((0..votes.len()).max_by_key(|&k| (votes[k], usize::MAX - k)).filter(|&k| votes[k] > 0))
    }

    /// The project's own design and the methods that it did not choose. A method without a design is left out.
    fn own_designs(&self, objectives: &[FrontObjective]) -> Result<Vec<ReferenceDesign>, PipelineError> {
        let mut own = self.asked.clone();
        if own.options.structure.is_open() {
            own.options.remove_fixed_feedback();
        }
        let mut all = vec![self.reference(&own_name(&own), &own, objectives)?];
        for (name, synthesis) in variants(self.asked) {
            all.extend(self.reference(name, &synthesis, objectives).ok());
        }
        Ok(all)
    }

    /// The PI with a lag that is tuned under the limits which the project's own design reaches; `None` if no such PI has a stable loop.
    fn tuned_bar(
        &self,
        own: &ReferenceDesign,
        wanted: &TuningOptions,
        objectives: &[FrontObjective],
    ) -> Option<ReferenceDesign> {
        let limits = limits_of(&own.linear, wanted);
        let structure = pi_with_lag();
        let subject = TuningSubject::Structure(&structure);
        let wanted = TuningOptions { limits, ..wanted.clone() };
        let (tuned, _) = tune_feedback(subject, self.ground, &wanted).ok()?;
        let mut synthesis = self.asked.clone();
        put_feedback_in_place(&tuned.feedback, &mut synthesis);
        self.reference(TUNED_PI, &synthesis, objectives).ok()
    }

    fn reference(
        &self,
        name: &str,
        synthesis: &DesignRequest,
        objectives: &[FrontObjective],
    ) -> Result<ReferenceDesign, PipelineError> {
        let project = Project { synth: Some(synthesis.clone()), ..self.project.clone() };
        let made = synthesise(&project, self.modelled, self.reduced)?;
        let controller = &made.sampled.controller;
        let measure = |plant: &DesignPlant| {
            measure_controller(plant, controller, &self.ground.sampling, &self.ground.disturbance)
        };
        let plants = self.ground.plants.iter().chain(&self.ground.mechanisms);
        let measures = plants.map(measure).collect::<Result<Vec<_>, _>>()?;
        let figures = objectives.iter().map(|each| each.worst_figure(&measures)).collect();
        let linear = LoopMeasuresResult::of(
            &measures[0],
            self.ground.measured_loops(self.project.plant.controlled_quantity()),
        );
        Ok(ReferenceDesign { name: name.to_owned(), linear, figures })
    }
}
