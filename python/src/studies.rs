//! Studies of a project: robustness, frequency response maps, adaptation, identification.

use std::path::PathBuf;

use anyhow::{Context, ensure};
use counterpoise_host::projects;
use counterpoise_pipeline::recordings::identify;
use counterpoise_pipeline::results::RobustnessResult;
use counterpoise_pipeline::studies::adaptation::study_adaptation;
use counterpoise_pipeline::studies::certificate::other_robust_regimes;
use counterpoise_pipeline::studies::fra::{
    Analyser, LoopController, LoopUnderTest, MeasurementPlan, ResponseMap, map_recordings,
};
use counterpoise_pipeline::studies::sweep::{
    BesideSamples, CampaignResult, MechanismColumns, campaign_is_stated, worst_cases,
};
use counterpoise_pipeline::{
    self as pipeline, prepare_campaign, robust_stability, run_stages, vary_families,
};
use counterpoise_pool::{Pool, map_with_progress};
use counterpoise_project::Purpose;
use counterpoise_report::results::AdaptText;
use counterpoise_report::sweep::{SweepFigure, sweep_figures};
use counterpoise_report::wording::code_header::HeaderText;
use counterpoise_report::wording::identification::describe_identified_recordings;
use counterpoise_report::wording::recordings::{
    describe_map, describe_recorded_map, describe_recordings_error,
};
use counterpoise_verify::robustness::Sample;
use pyo3::prelude::*;
use serde::Serialize;

use crate::background::{self, BackgroundWorld};
use crate::failures::CounterpoiseError;
use crate::project::NativeProject;

/// A campaign: every requirement over it, and its samples as columns.
#[derive(Serialize)]
struct CampaignColumns {
    passing: usize,
    figures: Vec<SweepFigure>,
    robustness: Vec<RobustnessResult>,
    samples: MechanismColumns,
}

/// A list of maps under a key, as the command line writes it.
#[derive(Serialize)]
struct Maps {
    maps: Vec<ResponseMap>,
}

/// Runs the project's campaign: every requirement over all mechanisms with its worst case, and the samples.
#[pyfunction]
pub fn sweep(
    py: Python<'_>,
    project: &NativeProject,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<String> {
    project.json(py, progress, run_sweep)
}

fn run_sweep(project: &NativeProject, world: &BackgroundWorld) -> anyhow::Result<CampaignColumns> {
    let loaded = project.load_for(Purpose::Sweep)?;
    let project = &loaded.project;
    campaign_is_stated(project)?;
    let made = run_stages(project, &HeaderText, world)?;
    let (modelled, verified) = (&made.modelled, &made.verified);
    let campaign = prepare_campaign(project, modelled, verified, world)?;
    let run = map_with_progress(world, "sample", campaign.len(), |index| campaign.run(index));
    ensure!(!world.is_cancelled(), "stopped");
    let samples: Vec<Sample> = run.into_iter().collect::<Result<_, _>>()?;
    let others = BesideSamples {
        worst: worst_cases(&campaign, &samples, world)?,
        families: vary_families(project, modelled, verified, world)?,
        stability: robust_stability(project, modelled, verified.controller(), world)?,
        regimes: other_robust_regimes(project, modelled, &made.synthesised, &made.procedure)?,
    };
    let found = CampaignResult::new(&campaign, &samples, others);
    Ok(CampaignColumns {
        passing: found.passing,
        figures: sweep_figures(&found),
        robustness: RobustnessResult::list(found.stability.as_ref(), found.own_joints(), &found.regimes),
        samples: (&found).into(),
    })
}

/// Puts every method of adaptation to the test in the nonlinear closed loop.
#[pyfunction(name = "adapt")]
pub fn adaptation(
    py: Python<'_>,
    project: &NativeProject,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<String> {
    project.json(py, progress, |project, world| {
        let loaded = project.load_for(Purpose::Verify)?;
        let mut found = study_adaptation(&loaded.project, world)?;
        found.leave_histories_out();
        Ok(AdaptText::from(&found))
    })
}

/// Measures frequency responses on the simulated machine, or on recordings.
#[pyfunction]
pub fn frequency_response_map(
    py: Python<'_>,
    project: &NativeProject,
    around: &str,
    amplitudes: Vec<f64>,
    frequencies_hz: Vec<f64>,
    offset_m: f64,
    recordings: Vec<PathBuf>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<String> {
    let around = match around {
        "plant" => LoopUnderTest::Plant,
        "closed" => LoopUnderTest::Closed,
        "disturbance" => LoopUnderTest::Disturbance,
        "disconnected" => LoopUnderTest::Disconnected,
        other => {
            return Err(CounterpoiseError::new_err(format!(
                "\"{other}\" is no loop; there are plant, closed, disturbance, disconnected"
            )));
        }
    };
    let plan = MeasurementPlan { around, amplitudes, frequencies_hz, offset_m };
    project.json(py, progress, move |project, world| {
        let positive = |values: &[f64]| {
            !values.is_empty() && values.iter().all(|value| value.is_finite() && *value > 0.0)
        };
        ensure!(positive(&plan.frequencies_hz), "frequencies_hz must be positive numbers, at least one");
        let loaded = project.load_for(Purpose::Model)?;
        let modelled = pipeline::build_plant_model(&loaded.project)?;
        if !recordings.is_empty() {
            let files = projects::read_recordings(&recordings)?;
            let found = map_recordings(&loaded.project, &modelled, &plan, &files)
                .map_err(|error| anyhow::Error::msg(describe_recordings_error(&error)))?;
            return Ok(Maps { maps: found.into_iter().map(describe_recorded_map).collect() });
        }
        ensure!(positive(&plan.amplitudes), "amplitudes must be positive numbers, at least one");
        let analyser = Analyser::new(&loaded.project, &modelled, &plan, LoopController::Simulation)?;
        let measured = analyser.measure(&plan, world)?;
        ensure!(!world.is_cancelled(), "stopped");
        Ok(Maps { maps: vec![describe_map(analyser.compare(&measured, world)?)] })
    })
}

/// Identifies the machine from recordings of triangle waves, in one or two states of balance: what was found as JSON, and the project
/// with it.
#[pyfunction(name = "identify")]
pub fn identification(
    py: Python<'_>,
    project: &NativeProject,
    recordings: Vec<PathBuf>,
    other: Vec<PathBuf>,
) -> PyResult<(String, NativeProject)> {
    let kept = project.clone();
    background::run(py, project.folder(), None, move |_| {
        let loaded = kept.load_for(Purpose::Model)?;
        let (first, second) = (projects::read_recordings(&recordings)?, projects::read_recordings(&other)?);
        let identified = identify(&loaded.project, &[&first, &second])
            .map_err(|error| anyhow::Error::msg(describe_recordings_error(&error)))?;
        let found = describe_identified_recordings(&identified);
        let json = serde_json::to_string(&found).context("cannot write the result as JSON")?;
        Ok((json, kept.with_document(projects::improved_document(&loaded, &identified.improved)?)))
    })
}
