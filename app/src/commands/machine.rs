//! `counterpoise machine`: a project in the place of the true machine, for one experiment of a commissioning.

use std::path::PathBuf;

use anyhow::{Context, bail};
use clap::Args;
use counterpoise_host::compilers::controller_program::ControllerProgram;
use counterpoise_host::files::whole_path;
use counterpoise_host::machine_program::{
    MachineRequest, RunEnd, answer_of, read_request, read_run, write_answer,
};
use counterpoise_host::projects;
use counterpoise_pipeline::build_plant_model;
use counterpoise_pipeline::commission::{MachineRun, simulate_run};
use counterpoise_project::Purpose;

use crate::exit::{CommandResult, ExitStatus};

/// Arguments of `machine`.
#[derive(Args)]
pub struct MachineOptions {
    /// Project that stands for the true machine
    pub project: PathBuf,
    /// Folder of the experiment, as `counterpoise commission` wrote it
    pub folder: PathBuf,
    /// Seed of the sensors' noise
    #[arg(long, value_name = "SEED", default_value = "7")]
    pub seed: u64,
}

/// Runs the command.
pub fn run(options: &MachineOptions) -> CommandResult {
    let loaded = projects::load_project(&options.project, Purpose::Model)?;
    let request = read_request(&options.folder)?;
    let plant = build_plant_model(&loaded.project)?.plant;
    let period_s = plant.parameters().interface.sample_period_s;
    if period_s != request.sample_period_s {
        bail!(
            "{} samples at {period_s} s, the request at {} s",
            options.project.display(),
            request.sample_period_s
        );
    }
    let experiment = read_run(&options.folder, &request)?;
    let parent = whole_path(&options.folder)?.parent().map(|parent| parent.join("controller"));
    let mut controller = ControllerProgram::start(&parent.context("the folder has none above it")?)?;
    // Each run of a round has noise of its own, and the same when it is repeated.
    let seed = request.run.bytes().fold(options.seed + 1000 * request.round as u64, |seed, byte| {
        seed.wrapping_mul(31).wrapping_add(u64::from(byte))
    });
    let run = simulate_run(&plant, &mut controller, &experiment, seed)?;
    if controller.has_failed() {
        bail!("the compiled controller of {} ended before the run did", options.folder.display());
    }
    let reason = passed_limit(&run, &request);
    let ended = if reason.is_empty() { RunEnd::Complete } else { RunEnd::Aborted };
    write_answer(&options.folder, &run.recording, &answer_of(&request, ended, &reason))?;
    Ok(ExitStatus::SUCCESS)
}

/// Returns which limit a run passes, with what it reached; nothing if it keeps all.
fn passed_limit(run: &MachineRun, request: &MachineRequest) -> String {
    let limits = &request.limits;
    let all = [
        ("angle", run.reached.angle_rad, limits.angle_rad, "rad"),
        ("rate", run.reached.rate_rad_s, limits.rate_rad_s, "rad/s"),
        ("current", run.reached.current_a, limits.current_a.unwrap_or(f64::INFINITY), "A"),
    ];
    let passed = all.into_iter().find(|(_, reached, limit, _)| reached > limit);
    passed.map_or(String::new(), |(name, reached, limit, unit)| {
        format!("the {name} reached {reached:.4} {unit}, beyond its limit of {limit:.4} {unit}")
    })
}
