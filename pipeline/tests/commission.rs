//! A commissioning: tolerances shrink to what recordings of a machine leave of them, and the rounds end for a reason.

use std::fmt::Write as _;
use std::sync::Arc;

use crate::bare_header::BareHeader;
use counterpoise_diagnose::experiment::Limits;
use counterpoise_pipeline::commission::acceptance::FigureSource;
use counterpoise_pipeline::commission::story::RunSummary;
use counterpoise_pipeline::commission::{
    PlannedRun, RecordedRun, ReplayUse, StopReason, assign_controller, judge_requirements, judge_run,
    plan_runs, simulate_run, stop_before_update, update_model,
};
use counterpoise_pipeline::first_design::with_chosen_weights;
use counterpoise_pipeline::recordings::RecordingFile;
use counterpoise_pipeline::{DesignStages, World, build_plant_model, run_stages};
use counterpoise_pool::Serial;
use counterpoise_project::Project;
use counterpoise_project::resolve::controller_file::ControllerContent;
use counterpoise_recordings::{Channel, Recording};

/// No file beside the project.
struct NoFiles;

impl World for NoFiles {
    fn read(&self, name: &str) -> Result<Vec<u8>, String> {
        Err(format!("{name} is not there"))
    }
}

/// A sight as drawn.
const DRAWN: &str = include_str!("data/drawn_sight.toml");

/// What its machine must reach besides.
const QUIET_AT_REST: &str = r#"[[verify.requirement]]
figure = "rest_hub_rms_rad_s"
at_most = 0.001
"#;

const LIMITS: Limits = Limits { angle_rad: 1.0, rate_rad_s: 1.0, current_a: f64::INFINITY, duration_s: 4.0 };

/// A round on the machine as drawn, and what a machine with other values leaves of it.
struct PlayedRound {
    project: Project,
    stages: DesignStages,
    content: Arc<ControllerContent>,
    recorded: Vec<RecordedRun>,
}

fn drawn() -> String {
    format!("{DRAWN}{QUIET_AT_REST}")
}

fn project(text: &str) -> Project {
    Project::parse(text, "project.toml").unwrap().project
}

fn play_round(machine: &str) -> PlayedRound {
    let stated = project(&drawn());
    let chosen = with_chosen_weights(&stated).unwrap().unwrap().project;
    let stages = run_stages(&chosen, &BareHeader, &NoFiles).unwrap();
    let content = Arc::new(ControllerContent {
        controller: stages.verified.controller().clone(),
        project_hash: "drawn".to_owned(),
    });
    let planned = plan_runs(&assign_controller(&chosen, &content), &stages, LIMITS, &Serial).unwrap();
    assert!(planned.left_out.is_empty());
    let plant = build_plant_model(&project(machine)).unwrap().plant;
    let record = |(seed, run): (usize, PlannedRun)| {
        let made = simulate_run(&plant, &mut content.controller.runner(), &run.request, seed as u64);
        RecordedRun { run, recording: made.unwrap().recording }
    };
    let recorded = planned.runs.into_iter().enumerate().map(|(k, run)| record((k + 5, run))).collect();
    PlayedRound { project: stated, stages, content, recorded }
}

fn recording_file(recording: &Recording, name: &str) -> RecordingFile {
    let channels: Vec<Channel> = Channel::ALL.into_iter().filter(|one| recording.has(*one)).collect();
    let names: Vec<&str> = channels.iter().map(|channel| channel.name()).collect();
    let mut text = format!("time [s],{}\n", names.join(","));
    for k in 0..recording.len() {
        write!(text, "{:.9e}", k as f64 * recording.sample_period_s).unwrap();
        for channel in &channels {
            write!(text, ",{:.17e}", recording.samples(*channel).unwrap()[k]).unwrap();
        }
        text.push('\n');
    }
    RecordingFile { name: format!("{name}.csv"), bytes: text.into_bytes() }
}

fn files(round: &PlayedRound) -> Vec<RecordingFile> {
    let replayed = round.recorded.iter().filter(|one| one.run.replay == ReplayUse::Replayed);
    replayed.map(|one| recording_file(&one.recording, one.run.name)).collect()
}

#[test]
fn a_machine_as_drawn_runs_as_predicted_and_meets_its_requirements() {
    let machine = drawn().replace("{ value = 2.0, tolerance = 0.3 }", "2.0");
    let round = play_round(&machine.replace("{ value = 1.0, tolerance = 0.5 }", "1.0"));
    for one in &round.recorded {
        assert!(!judge_run(&one.run, &one.recording).leaves_band(), "{}", one.run.name);
        // A sample that was not recorded leaves the figures of the others.
        let mut gap = one.recording.clone();
        gap.samples_mut(Channel::HubRate).unwrap()[7] = f64::NAN;
        let judged = judge_run(&one.run, &gap);
        let is_number = |value: Option<f64>| value.is_some_and(f64::is_finite);
        assert!(judged.channels.iter().all(|one| is_number(one.recorded_rms) && is_number(one.error_rms)));
    }
    let verdicts = judge_requirements(&round.project, &round.stages, &round.recorded);
    assert!(verdicts.iter().all(|verdict| verdict.measured.is_some()));
    assert_eq!(stop_before_update(&verdicts, &[]), Some(StopReason::RequirementsMet));
    // A figure that no run shows is the model's, which counts for nothing once a run has left its prediction.
    let all_but_step: Vec<RecordedRun> =
        round.recorded.iter().filter(|one| one.run.name != "step").cloned().collect();
    let by_model = judge_requirements(&round.project, &round.stages, &all_but_step);
    assert!(by_model.iter().any(|verdict| verdict.source == FigureSource::NotShown));
    let left = |leaves_band: bool| RunSummary {
        name: "rest".to_owned(),
        duration_s: 1.0,
        channels: Vec::new(),
        leaves_band,
    };
    assert_eq!(stop_before_update(&by_model, &[left(false)]), Some(StopReason::RequirementsMet));
    assert_eq!(stop_before_update(&by_model, &[left(true)]), None);
}

#[test]
fn values_off_within_their_tolerances_are_found_and_the_tolerances_shrink() {
    let machine = drawn().replace("{ value = 2.0, tolerance = 0.3 }", "2.4");
    let round = play_round(&machine.replace("{ value = 1.0, tolerance = 0.5 }", "1.3"));
    let update = update_model(&round.project, &round.content, &files(&round), &Serial).unwrap();
    assert!(update.explains(), "{}", update.residual);
    assert!(update.posterior.residual_before > 10.0);
    for (value, truth) in update.posterior.values.iter().zip([2.4, 1.3]) {
        assert!((value.value - truth).abs() <= value.half_width, "{value:?}");
        assert!(value.half_width < 0.1 * value.half_width_before, "{value:?}");
    }
    // The file keeps its form: a value with a smaller tolerance.
    let document = counterpoise_project::Document::parse(&drawn(), "project.toml");
    let next = update.project.update(&document, &round.project).unwrap();
    let read = project(next.text());
    assert_eq!(read.tolerances.len(), 2);
    assert!(read.tolerances[0].half_width < 0.05 * read.tolerances[0].value);
}

#[test]
fn what_the_model_lacks_is_found_beside_values_that_are_off() {
    let machine = drawn()
        .replace("{ value = 2.0, tolerance = 0.3 }", "2.4")
        .replace("{ value = 1.0, tolerance = 0.5 }", "1.3")
        .replace("natural_frequency = \"80 Hz\"", "natural_frequency = \"80 Hz\", delay = 4e-3");
    let round = play_round(&machine);
    let update = update_model(&round.project, &round.content, &files(&round), &Serial).unwrap();
    assert!(update.explains(), "{}", update.residual);
    let found = update.project.plant.sensors.hub_gyro.delay_s;
    assert!((found - 4e-3).abs() < 4e-4, "delay of {found} s");
    for (value, truth) in update.posterior.values.iter().zip([2.4, 1.3]) {
        assert!((value.value / truth - 1.0).abs() < 0.05, "{value:?}");
    }
    // A model that explains its recordings asks for no caution.
    let requirements = |project: &Project| project.verify.as_ref().unwrap().requirements.len();
    assert_eq!(requirements(&update.project), requirements(&round.project));
}
