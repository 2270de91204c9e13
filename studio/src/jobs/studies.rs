//! The studies of a project that the command line makes by `synth --search`, `compare`, `adapt`, `verify --against`, `identify` and `experiment`.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use counterpoise_diagnose::experiment::Limits;
use counterpoise_host::files::ProjectFolder;
use counterpoise_host::progress::{CancellablePool, SharedProgress};
use counterpoise_host::projects::{self, ProjectOnDisk};
use counterpoise_host::worker::{BackgroundWorker, CancelToken, WakeWindow};
use counterpoise_pipeline::first_design::with_chosen_weights_on;
use counterpoise_pipeline::recordings::experiment::{DiagnosisFindings, demand_csv, plan_experiment};
use counterpoise_pipeline::recordings::identify;
use counterpoise_pipeline::studies::adapt::AdaptedIntervals;
use counterpoise_pipeline::studies::adaptation::study_adaptation;
use counterpoise_pipeline::studies::designs::{ComparisonRequest, design_table};
use counterpoise_pipeline::studies::front::{asked_front, project_front, project_with_point};
use counterpoise_pipeline::studies::search::{JudgedWeights, search_weights, verify_found};
use counterpoise_pipeline::studies::verification::{VerificationOptions, VerificationStudy, verify_project};
use counterpoise_pipeline::{
    PipelineError, PipelineStage, ProjectIdentity, World, build_plant_model, reduce_plant,
};
use counterpoise_pool::Pool;
use counterpoise_project::resolve::front::FrontOptions;
use counterpoise_project::{Attachments, Document, Project, Purpose};
use counterpoise_report::adaptation::adaptation_report;
use counterpoise_report::difference::changes_report;
use counterpoise_report::experiment::{PlannedMotion, experiment_report};
use counterpoise_report::front::{design_places, front_report};
use counterpoise_report::identify::identification_report;
use counterpoise_report::results::{DesignTableText, FrontText};
use counterpoise_report::trade_off::{VerifiedPoint, trade_off_report};
use counterpoise_report::wording::experiment::describe_plan;
use counterpoise_report::wording::identification::describe_identified_recordings;
use counterpoise_report::wording::recordings::describe_recordings_error;
use counterpoise_report::{Report, ReportOrigin, designs};
use counterpoise_synth::SearchTrial;

use super::error_lines::{ErrorLines, error_lines};
use crate::study_inputs::{StudyInputs, StudyKind};

/// A study that is asked for.
#[derive(Debug, Clone)]
pub struct StudyRequest {
    /// Kind of the study.
    pub kind: StudyKind,
    /// The project file.
    pub path: PathBuf,
    /// The project as it is edited.
    pub document: Document,
    /// The files that it names.
    pub attachments: Attachments,
    /// The recordings of the page Diagnose.
    pub recordings: Vec<PathBuf>,
    /// What the last diagnosis left possible; `None` without one.
    pub findings: Option<DiagnosisFindings>,
    /// What the user gave.
    pub inputs: StudyInputs,
}

/// A project that a study proposes.
#[derive(Debug, Clone, PartialEq)]
pub struct StudyProposal {
    /// Kind of the proposal; those of one kind follow each other.
    pub group: String,
    /// What it is among those of its kind.
    pub name: String,
    /// The text of the project file with it.
    pub text: String,
}

/// The result of a study.
#[derive(Debug, Clone)]
pub struct StudyResult {
    /// Kind of the study.
    pub kind: StudyKind,
    /// Its report, as the command line writes it.
    pub report: Report,
    /// Projects that can be taken over, by their numbers in the report from 1 on.
    pub proposals: Vec<StudyProposal>,
    /// Places of the proposals in the figures of the report's first screen: figure by figure, proposal by proposal.
    pub places: Vec<Vec<[f64; 2]>>,
    /// The file that was written; `None` if none was.
    pub written: Option<PathBuf>,
}

/// Answer of the worker: the result, or why there is none; `None` if the user asked to stop.
pub type StudyAnswer = Option<Result<Arc<StudyResult>, ErrorLines>>;

/// Makes studies.
pub type StudyWorker = BackgroundWorker<StudyRequest, (StudyKind, StudyAnswer)>;

/// Returns a worker that makes studies and says its progress.
pub fn study_worker(wake: &WakeWindow, progress: &SharedProgress) -> StudyWorker {
    let (progress, own_wake) = (progress.clone(), Arc::clone(wake));
    BackgroundWorker::new(Arc::clone(wake), move |request: StudyRequest, token: &CancelToken| {
        let pool = CancellablePool { token, progress: &progress, wake: &own_wake };
        pool.progress.begin();
        let made = make_study(&request, &pool);
        (request.kind, (!token.is_cancelled()).then(|| made.map(Arc::new)))
    })
}

/// The files beside a project, and processors that stop when they are told to.
struct StudyWorld<'a> {
    folder: ProjectFolder,
    pool: &'a CancellablePool<'a>,
}

impl World for StudyWorld<'_> {
    fn read(&self, name: &str) -> Result<Vec<u8>, String> {
        self.folder.read(name)
    }

    fn pool(&self) -> &dyn Pool {
        self.pool
    }

    fn begins(&self, step: PipelineStage) {
        self.pool.progress.say(step.name().to_owned());
        (self.pool.wake)();
    }
}

/// A project as it is edited, with its folder and the processors.
struct StudyGround<'a> {
    loaded: ProjectOnDisk,
    world: StudyWorld<'a>,
}

impl StudyGround<'_> {
    fn of<'a>(
        request: &StudyRequest,
        purpose: Purpose,
        pool: &'a CancellablePool<'a>,
    ) -> Result<StudyGround<'a>, ErrorLines> {
        let path = request.path.clone();
        let loaded = projects::load_document(path, request.document.clone(), &request.attachments, purpose);
        let loaded = loaded.map_err(|error| lines_of(&error))?;
        let folder = loaded.project_folder();
        Ok(StudyGround { loaded, world: StudyWorld { folder, pool } })
    }

    fn name(&self) -> &str {
        &self.loaded.project.plant.name
    }

    /// Returns the command line that does the same.
    fn command(&self, verb: &str) -> String {
        format!("counterpoise {verb} {}", self.loaded.path.display())
    }

    fn origin(&self, verb: &str, option: &str) -> ReportOrigin {
        let project = self.loaded.path.display().to_string();
        ReportOrigin { command: format!("{}{option}", self.command(verb)), project }
    }

    fn propose(&self, group: &str, name: String, project: &Project) -> Option<StudyProposal> {
        let updated = project.update(&self.loaded.document, &self.loaded.stated).ok()?;
        Some(StudyProposal { group: group.to_owned(), name, text: updated.text().to_owned() })
    }
}

fn lines_of(error: &anyhow::Error) -> ErrorLines {
    match error.downcast_ref::<PipelineError>() {
        Some(why) => error_lines(why),
        None => format!("{error:#}").lines().map(str::to_owned).collect(),
    }
}

fn refusal_lines(error: PipelineError) -> ErrorLines {
    error_lines(&error)
}

fn make_study(request: &StudyRequest, pool: &CancellablePool) -> Result<StudyResult, ErrorLines> {
    match request.kind {
        StudyKind::Search => search_designs(request, pool),
        StudyKind::Compare => compare_designs(request, pool),
        StudyKind::Adapt => test_adaptation(request, pool),
        StudyKind::Against => compare_projects(request, pool),
        StudyKind::Identify => identify_values(request, pool),
        StudyKind::Experiment => plan_next(request, pool),
    }
}

/// Returns a result without proposals.
fn plain_result(kind: StudyKind, report: Report) -> StudyResult {
    StudyResult { kind, report, proposals: Vec::new(), places: Vec::new(), written: None }
}

fn search_designs(request: &StudyRequest, pool: &CancellablePool) -> Result<StudyResult, ErrorLines> {
    let ground = StudyGround::of(request, Purpose::Front, pool)?;
    match asked_front(&ground.loaded.project) {
        Some(options) => search_front(&ground, &options),
        None => search_for_requirements(request, pool),
    }
}

/// Searches the front of a project's designs.
fn search_front(ground: &StudyGround, options: &FrontOptions) -> Result<StudyResult, ErrorLines> {
    let chosen =
        with_chosen_weights_on(&ground.loaded.project, ground.world.pool()).map_err(refusal_lines)?;
    let project = chosen.map_or_else(|| ground.loaded.project.clone(), |chosen| chosen.project);
    let found = project_front(&project, options, &ground.world).map_err(refusal_lines)?;
    let text = FrontText::from(&found);
    let propose = |number: usize| {
        let kind = &text.designs.get(number - 1)?.kind;
        ground.propose(kind, format!("design {number}"), &project_with_point(&project, &found, number)?)
    };
    let proposals = (1..=found.points.len()).map(propose).collect::<Option<Vec<_>>>();
    Ok(StudyResult {
        proposals: proposals.unwrap_or_default(),
        places: design_places(&text),
        ..plain_result(StudyKind::Search, front_report(&text, &ground.origin("synth", " --search")))
    })
}

/// Searches weights for the requirements of a project, and verifies what was found.
fn search_for_requirements(
    request: &StudyRequest,
    pool: &CancellablePool,
) -> Result<StudyResult, ErrorLines> {
    let ground = StudyGround::of(request, Purpose::Synth, pool)?;
    let project = &ground.loaded.project;
    let modelled = build_plant_model(project).map_err(refusal_lines)?;
    let reduced = reduce_plant(project, &modelled).map_err(refusal_lines)?;
    let mut trials = 0_usize;
    let mut go_on = |_: &SearchTrial| {
        trials += 1;
        pool.progress.say(format!("{trials} designs tried"));
        (pool.wake)();
        !pool.is_cancelled()
    };
    let found = search_weights(project, &modelled, &reduced, &mut go_on).map_err(refusal_lines)?;
    let judged = match project.verify {
        Some(_) => verify_found(&found, &modelled, &reduced, &ground.world, &mut || !pool.is_cancelled())
            .map_err(refusal_lines)?,
        None => Vec::new(),
    };
    let points: Vec<VerifiedPoint> = judged.iter().map(VerifiedPoint::from).collect();
    let identity = ProjectIdentity::of(project, &ground.world.folder);
    let report = trade_off_report(&identity, &found, &points, &ground.origin("synth", " --search"));
    let name_of = |point: &JudgedWeights| match point.ms_limit {
        Some(limit) => format!("under Ms {limit:.2}"),
        None => "of the answer".to_owned(),
    };
    let mut proposals: Vec<StudyProposal> =
        judged.iter().filter_map(|point| ground.propose("weights", name_of(point), &point.project)).collect();
    if proposals.is_empty() {
        proposals.extend(ground.propose("weights", "of the answer".to_owned(), &found.project));
    }
    Ok(StudyResult { proposals, ..plain_result(StudyKind::Search, report) })
}

fn compare_designs(request: &StudyRequest, pool: &CancellablePool) -> Result<StudyResult, ErrorLines> {
    let ground = StudyGround::of(request, Purpose::Compare, pool)?;
    let asked = ComparisonRequest { further: Vec::new(), keeps_histories: false };
    let found = design_table(&ground.loaded.project, &asked, &ground.world).map_err(refusal_lines)?;
    let table = DesignTableText::from(found);
    let report = designs::comparison_report(&table, &[], &ground.origin("compare", ""));
    Ok(plain_result(StudyKind::Compare, report))
}

fn test_adaptation(request: &StudyRequest, pool: &CancellablePool) -> Result<StudyResult, ErrorLines> {
    let ground = StudyGround::of(request, Purpose::Verify, pool)?;
    let found = study_adaptation(&ground.loaded.project, &ground.world).map_err(refusal_lines)?;
    let intervals = AdaptedIntervals::of(&found.runs);
    let report = adaptation_report(ground.name(), &ground.command("adapt"), &found.runs, intervals);
    Ok(plain_result(StudyKind::Adapt, report))
}

fn compare_projects(request: &StudyRequest, pool: &CancellablePool) -> Result<StudyResult, ErrorLines> {
    let ground = StudyGround::of(request, Purpose::Verify, pool)?;
    let other = ground.world.folder.0.join(request.inputs.against.trim());
    if request.inputs.against.trim().is_empty() {
        return Err(vec!["name the other project: its file or its folder".to_owned()]);
    }
    let verify = |loaded: &ProjectOnDisk| -> Result<VerificationStudy, ErrorLines> {
        let world = StudyWorld { folder: loaded.project_folder(), pool };
        verify_project(&loaded.project, &VerificationOptions::of_project(), &world).map_err(refusal_lines)
    };
    let before = projects::load_project(&other, Purpose::Verify).map_err(|error| lines_of(&error))?;
    let before = verify(&before)?;
    if pool.is_cancelled() {
        return Err(Vec::new());
    }
    let changes = verify(&ground.loaded)?.list_changes_from(&before);
    let command = format!("{} --against {}", ground.command("verify"), other.display());
    let report = changes_report(ground.name(), &other.display().to_string(), &command, &changes);
    Ok(plain_result(StudyKind::Against, report))
}

fn identify_values(request: &StudyRequest, pool: &CancellablePool) -> Result<StudyResult, ErrorLines> {
    let ground = StudyGround::of(request, Purpose::Model, pool)?;
    if request.recordings.is_empty() {
        return Err(vec!["add the recordings on the page Diagnose (Ctrl+R)".to_owned()]);
    }
    let files = projects::read_recordings(&request.recordings).map_err(|error| lines_of(&error))?;
    let told = |error| vec![describe_recordings_error(&error)];
    let found = identify(&ground.loaded.project, &[&files]).map_err(told)?;
    let text = describe_identified_recordings(&found);
    let report = identification_report(ground.name(), &ground.command("identify"), &text, &found.units);
    let improved = Project { plant: found.improved.clone(), ..ground.loaded.project.clone() };
    let proposals = ground.propose("plant", "the identified values".to_owned(), &improved);
    Ok(StudyResult {
        proposals: proposals.into_iter().collect(),
        ..plain_result(StudyKind::Identify, report)
    })
}

fn plan_next(request: &StudyRequest, pool: &CancellablePool) -> Result<StudyResult, ErrorLines> {
    let ground = StudyGround::of(request, Purpose::Experiment, pool)?;
    let inputs = &request.inputs;
    let limits = Limits {
        angle_rad: inputs.angle_rad,
        rate_rad_s: inputs.rate_rad_s,
        current_a: if inputs.current_a > 0.0 { inputs.current_a } else { f64::INFINITY },
        duration_s: inputs.duration_s,
    };
    let project = &ground.loaded.project;
    let planned = plan_experiment(project, request.findings.as_ref(), limits, pool)
        .map_err(|error| vec![describe_recordings_error(&error)])?;
    if pool.is_cancelled() {
        return Err(Vec::new());
    }
    let (text, controlled) = (describe_plan(&planned), project.plant.controlled_quantity());
    let motion = PlannedMotion { plan: &planned, controlled };
    let report = experiment_report(ground.name(), &ground.command("experiment"), &text, motion);
    let mut result = plain_result(StudyKind::Experiment, report);
    if let Some(best) = planned.experiments.first() {
        let file = write_demand(&ground.world.folder.0, inputs, &best.demand, project)?;
        result.written = Some(file);
    }
    Ok(result)
}

/// Writes the demand of an experiment beside the project; returns the file.
fn write_demand(
    folder: &Path,
    inputs: &StudyInputs,
    demand: &[f64],
    project: &Project,
) -> Result<PathBuf, ErrorLines> {
    let name = if inputs.demand_file.trim().is_empty() { "demand.csv" } else { inputs.demand_file.trim() };
    let file = folder.join(name);
    let text = demand_csv(demand, project.plant.interface.sample_period_s);
    projects::write_file(&file, text.as_bytes()).map_err(|error| lines_of(&error))?;
    Ok(file)
}
