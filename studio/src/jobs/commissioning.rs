//! Rounds of a commissioning: those that are finished are read, the next one is run.

use std::path::PathBuf;
use std::sync::Arc;

use counterpoise_host::commissioning::{
    Commissioning, CommissioningSetup, RoundTools, read_newest_model, read_rounds, write_story,
};
use counterpoise_host::progress::{CancellablePool, SharedProgress};
use counterpoise_host::stages::ProgressDisplay;
use counterpoise_host::worker::{BackgroundWorker, CancelToken, WakeWindow};
use counterpoise_pipeline::PipelineError;
use counterpoise_pipeline::commission::{RoundSummary, machine_time_s};
use counterpoise_report::commission::commission_report;
use counterpoise_report::html_page;
use counterpoise_report::wording::code_header::HeaderText;
use counterpoise_report::wording::recordings::describe_recordings_error;

/// Kind and input of work on a commissioning.
#[derive(Debug, Clone)]
pub enum CommissioningRequest {
    /// Reads the finished rounds of a folder.
    Read {
        /// The folder.
        folder: PathBuf,
    },
    /// Runs the next round.
    Run(CommissioningSetup),
}

/// The rounds of a folder.
#[derive(Debug, Clone, Default)]
pub struct CommissioningView {
    /// The folder.
    pub folder: PathBuf,
    /// The finished rounds.
    pub rounds: Vec<RoundSummary>,
    /// The text of the newest model that the rounds left; `None` if they left none.
    pub model: Option<String>,
}

/// Reads and runs rounds.
pub type CommissioningWorker = BackgroundWorker<CommissioningRequest, Result<CommissioningView, String>>;

/// Returns a worker that reads and runs rounds, and says its progress.
pub fn commissioning_worker(wake: &WakeWindow, progress: &SharedProgress) -> CommissioningWorker {
    let (progress, own_wake) = (progress.clone(), Arc::clone(wake));
    BackgroundWorker::new(Arc::clone(wake), move |request: CommissioningRequest, token: &CancelToken| {
        let watch = CancellablePool { token, progress: &progress, wake: &own_wake };
        watch.progress.begin();
        let answer = match request {
            CommissioningRequest::Read { folder } => view_of(folder),
            CommissioningRequest::Run(setup) => run_round(setup, &watch),
        };
        answer.map_err(|error| match error.downcast_ref::<PipelineError>() {
            Some(refused) => describe_recordings_error(refused),
            None => format!("{error:#}"),
        })
    })
}

fn view_of(folder: PathBuf) -> anyhow::Result<CommissioningView> {
    let rounds = read_rounds(&folder)?;
    let model = read_newest_model(&folder, rounds.len());
    Ok(CommissioningView { folder, rounds, model })
}

/// Runs the next round, and writes the page of the whole story.
fn run_round(setup: CommissioningSetup, watch: &CancellablePool) -> anyhow::Result<CommissioningView> {
    let (folder, project) = (setup.folder.clone(), setup.project.display().to_string());
    let commissioning = Commissioning::open(setup)?;
    let finished = commissioning.finished_rounds()?;
    if finished.last().is_none_or(|round| round.stop.is_none()) {
        let tools = RoundTools { pool: watch, stages: ProgressDisplay::Quiet, words: &HeaderText };
        commissioning.run_round(finished.len() + 1, tools)?;
    }
    let view = view_of(folder)?;
    let page = commission_report(&project, &view.rounds, machine_time_s(&view.rounds));
    write_story(&view.folder, &html_page(&page))?;
    Ok(view)
}
