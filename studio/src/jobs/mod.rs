//! The work outside the window's thread: each kind of work has a worker of its own, and no frame waits for one.
//!
//! Modules in reading order: [`error_lines`], [`live_design`], [`verification`], [`measurements`], [`code_export`],
//! [`report_job`], [`kept_designs`], [`plant_pictures`], [`assumption_ranking`],
//! [`overlay_runs`], [`history_file`], [`plot_copy`], [`recording_views`], [`diagnosis`], [`commissioning`], [`studies`], [`folder_listing`], [`file_jobs`].

pub mod assumption_ranking;
pub mod code_export;
pub mod commissioning;
pub mod diagnosis;
pub mod error_lines;
pub mod file_jobs;
pub mod folder_listing;
pub mod history_file;
pub mod kept_designs;
pub mod live_design;
pub mod measurements;
pub mod overlay_runs;
pub mod plant_pictures;
pub mod plot_copy;
pub mod recording_views;
pub mod report_job;
pub mod studies;
pub mod verification;

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use counterpoise_host::change_watcher::ChangeWatcher;
use counterpoise_host::file_check::{FileCheck, FileCheckResult, check_file};
use counterpoise_host::progress::{CancellablePool, SharedProgress};
use counterpoise_host::worker::{BackgroundWorker, CancelToken, WakeWindow};
use counterpoise_models::Parameters;
use counterpoise_models::parameters::Beam;
use counterpoise_pipeline::check::RankedAssumptions;
use counterpoise_pipeline::preview::{PlantPreview, PreviewCache, PreviewRequest};
use counterpoise_project::Project;
use counterpoise_report::wording::answer::DescribedDiagnosis;

use crate::editing::session::Session;
use crate::settings::{SettingsFile, write_settings};
use crate::study_inputs::StudyKind;
use crate::versioned_results::VersionedResult;
use assumption_ranking::{RankingRequest, answer_ranking};
use code_export::{ExportRequest, WrittenCode, export_code};
use commissioning::{CommissioningView, CommissioningWorker, commissioning_worker};
use diagnosis::{DiagnosisWorker, diagnosis_worker};
use error_lines::ErrorLines;
use file_jobs::{FileJob, FileJobResult, ProjectStore};
use folder_listing::{FolderListing, ListingRequest, list_folder};
use history_file::{HistoryWorker, history_worker};
use kept_designs::{KeptDesignWorker, kept_design_worker};
use live_design::{TimedPreview, preview_timed};
use measurements::{MeasurementWorker, PartialCampaign, measurement_worker};
use overlay_runs::{OverlayRunWorker, overlay_run_worker};
use plant_pictures::{BeamModes, ReductionPicture};
use plot_copy::{CopiedPlot, CopyRequest, copy_plot};
use recording_views::{RecordingView, ReplayRequest, ReplayedFiles, replay_files};
use report_job::{ReportRequest, write_report};
use studies::{StudyResult, StudyWorker, study_worker};
use verification::{
    LoopViewWorker, PartialVerification, TradeOffWorker, VerificationWorker, loop_view_worker,
    trade_off_worker, verification_worker,
};

/// The workers, and what the recordings' workers have found.
pub struct BackgroundJobs {
    /// Makes the design that follows a dragged weight.
    pub design: BackgroundWorker<PreviewRequest, Result<TimedPreview, ErrorLines>>,
    /// Verifies.
    pub verify: VerificationWorker,
    /// Computes error against effort.
    pub effort: TradeOffWorker,
    /// Computes the loop for charts of the plane.
    pub loop_view: LoopViewWorker,
    /// Measures.
    pub measure: MeasurementWorker,
    /// Exports.
    pub export: BackgroundWorker<ExportRequest, Result<Option<WrittenCode>, String>>,
    /// Writes reports.
    pub report: BackgroundWorker<ReportRequest, Result<PathBuf, String>>,
    /// Computes the kept designs of a project that was opened.
    pub restore: KeptDesignWorker,
    /// Computes the named designs that are drawn.
    pub overlays: KeptDesignWorker,
    /// Runs the drawn designs on the full plant.
    pub overlay_runs: OverlayRunWorker,
    /// Reads and writes the history of designs.
    pub history: HistoryWorker,
    /// Writes settings.
    pub settings: BackgroundWorker<Vec<SettingsFile>, ()>,
    /// Diagnoses.
    pub diagnose: DiagnosisWorker,
    /// Reads and runs rounds of a commissioning.
    pub commission: CommissioningWorker,
    /// Makes studies.
    pub study: StudyWorker,
    /// Replays recordings on the model.
    pub replay: BackgroundWorker<ReplayRequest, Option<ReplayedFiles>>,
    /// Lists folders.
    pub list: BackgroundWorker<ListingRequest, FolderListing>,
    /// Reads and writes projects.
    pub file: BackgroundWorker<FileJob, FileJobResult>,
    /// Checks whether another program wrote the project file.
    pub file_check: BackgroundWorker<FileCheck, FileCheckResult>,
    /// Sees changes of files while the window rests.
    pub watcher: ChangeWatcher,
    /// Compares a plant with its reduction.
    pub reduction: BackgroundWorker<PlantPreview, ReductionPicture>,
    /// Ranks what the project file leaves open.
    pub ranking: BackgroundWorker<RankingRequest, RankedAssumptions>,
    /// Computes the modes of a beam.
    pub beam_modes: BackgroundWorker<Beam, BeamModes>,
    /// Writes a plot for the clipboard.
    pub copy: BackgroundWorker<CopyRequest, CopiedPlot>,
    /// Recordings in the project's folder, to offer.
    pub nearby_recordings: Vec<PathBuf>,
    /// The recordings to diagnose.
    pub recordings: Vec<PathBuf>,
    /// The recordings with their replays, of a revision of the project.
    pub recording_views: Option<VersionedResult<Vec<RecordingView>>>,
    /// The last diagnosis, or why there is none.
    pub diagnosis: Option<Result<DescribedDiagnosis, ErrorLines>>,
    /// The mechanism that was diagnosed.
    pub diagnosed_plant: Option<Parameters>,
    /// Results of a running verification so far.
    pub partial: PartialVerification,
    /// Results of a running campaign so far.
    pub partial_campaign: PartialCampaign,
    /// The rounds of the commissioning, or why there are none.
    pub commissioning: Option<Result<CommissioningView, String>>,
    /// The last result of each study, or why there is none.
    pub studies: BTreeMap<StudyKind, VersionedResult<Result<Arc<StudyResult>, ErrorLines>>>,
    /// The study that was asked for last.
    pub asked_study: StudyKind,
    progress: JobProgress,
}

/// How far the long jobs are.
#[derive(Default)]
struct JobProgress {
    diagnosis: SharedProgress,
    measurement: SharedProgress,
    commissioning: SharedProgress,
    study: SharedProgress,
}

/// Event of a diagnosis since the last frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DiagnosisNews {
    /// Nothing.
    None,
    /// The diagnosis has ended.
    Ended,
}

impl BackgroundJobs {
    /// Starts the workers; they wait for work.
    pub fn new(wake: &WakeWindow, store: ProjectStore) -> Self {
        let disk = Arc::clone(&store.disk);
        let progress = JobProgress::default();
        let (partial, partial_campaign) = (PartialVerification::default(), PartialCampaign::default());
        Self {
            design: design_worker(wake),
            verify: verification_worker(wake, &partial),
            effort: trade_off_worker(wake),
            loop_view: loop_view_worker(wake),
            measure: measurement_worker(wake, &progress.measurement, &partial_campaign),
            export: BackgroundWorker::new(Arc::clone(wake), |request: ExportRequest, token: &CancelToken| {
                export_code(&request, token)
            }),
            report: BackgroundWorker::new(Arc::clone(wake), |request: ReportRequest, _: &CancelToken| {
                write_report(&request)
            }),
            restore: kept_design_worker(wake),
            overlays: kept_design_worker(wake),
            overlay_runs: overlay_run_worker(wake),
            history: history_worker(wake, Arc::clone(&store.disk)),
            settings: BackgroundWorker::new(Arc::clone(wake), |files: Vec<SettingsFile>, _: &CancelToken| {
                write_settings(&files);
            }),
            diagnose: diagnosis_worker(wake, &progress.diagnosis),
            commission: commissioning_worker(wake, &progress.commissioning),
            study: study_worker(wake, &progress.study),
            replay: BackgroundWorker::new(Arc::clone(wake), |request: ReplayRequest, token: &CancelToken| {
                replay_files(&request, token)
            }),
            list: BackgroundWorker::new(Arc::clone(wake), |request: ListingRequest, _: &CancelToken| {
                list_folder(request)
            }),
            file: BackgroundWorker::new(Arc::clone(wake), move |job, _: &CancelToken| store.run(job)),
            file_check: BackgroundWorker::new(Arc::clone(wake), move |check, _: &CancelToken| {
                check_file(check, disk.as_ref())
            }),
            watcher: ChangeWatcher::new(Arc::clone(wake)),
            reduction: BackgroundWorker::new(Arc::clone(wake), |plant: PlantPreview, _: &CancelToken| {
                ReductionPicture::new(&plant)
            }),
            ranking: BackgroundWorker::new(Arc::clone(wake), |request: RankingRequest, _: &CancelToken| {
                answer_ranking(request)
            }),
            beam_modes: BackgroundWorker::new(Arc::clone(wake), |beam, _: &CancelToken| BeamModes::new(beam)),
            copy: BackgroundWorker::new(Arc::clone(wake), |request, _: &CancelToken| copy_plot(request)),
            nearby_recordings: Vec::new(),
            recordings: Vec::new(),
            recording_views: None,
            diagnosis: None,
            diagnosed_plant: None,
            partial,
            partial_campaign,
            commissioning: None,
            studies: BTreeMap::new(),
            asked_study: StudyKind::Search,
            progress,
        }
    }

    /// Cancels everything that the user can stop.
    pub fn cancel(&self) {
        self.design.cancel();
        self.verify.cancel();
        self.effort.cancel();
        self.measure.cancel();
        self.export.cancel();
        self.report.cancel();
        self.diagnose.cancel();
        self.commission.cancel();
        self.study.cancel();
        self.replay.cancel();
        self.overlay_runs.cancel();
    }

    /// Returns whether anything that the user can stop runs, or has an answer that was not yet taken.
    pub fn is_busy(&self) -> bool {
        self.design.is_pending()
            || self.verify.is_pending()
            || self.effort.is_pending()
            || self.measure.is_pending()
            || self.export.is_pending()
            || self.report.is_pending()
            || self.diagnose.is_pending()
            || self.commission.is_pending()
            || self.study.is_pending()
            || self.replay.is_pending()
    }

    /// Returns whether small work runs that is not shown: files, pictures of a plant, copies.
    pub fn has_background_work(&self) -> bool {
        self.file.is_pending()
            || self.file_check.is_pending()
            || self.reduction.is_pending()
            || self.beam_modes.is_pending()
            || self.ranking.is_pending()
            || self.restore.is_pending()
            || self.overlays.is_pending()
            || self.overlay_runs.is_pending()
            || self.history.is_pending()
            || self.copy.is_pending()
            || self.loop_view.is_pending()
    }

    /// Returns how far the diagnosis is, in words.
    pub fn diagnosis_progress(&self) -> String {
        self.progress.diagnosis.last_message()
    }

    /// Returns how far the round of a commissioning is, in words.
    pub fn commissioning_progress(&self) -> String {
        self.progress.commissioning.last_message()
    }

    /// Returns how far the study is, in words.
    pub fn study_progress(&self) -> String {
        self.progress.study.last_message()
    }

    /// Returns how far the measurement is, in words.
    pub fn measurement_progress(&self) -> String {
        self.progress.measurement.last_message()
    }

    /// Takes the answers about recordings.
    pub fn take_diagnosis(&mut self) -> DiagnosisNews {
        if let Some((revision, Some(replayed))) = self.replay.take() {
            self.recordings = replayed.files;
            self.recording_views = Some(VersionedResult { revision, value: replayed.views });
        }
        match self.diagnose.take() {
            Some((_, answer)) => {
                self.diagnosis = Some(answer);
                DiagnosisNews::Ended
            }
            None => DiagnosisNews::None,
        }
    }

    /// Clears recordings and diagnoses, because another project is opened.
    pub fn clear(&mut self) {
        self.cancel();
        self.restore.cancel();
        self.overlays.cancel();
        (self.recording_views, self.diagnosis, self.diagnosed_plant) = (None, None, None);
        self.commissioning = None;
        self.studies.clear();
        self.recordings.clear();
    }

    /// Returns the project's text with the diagnosed mechanism, or `None` if there is no diagnosis. The inner error says why the
    /// text cannot be written.
    pub fn improved_text(&self, session: &Session) -> Option<Result<String, String>> {
        let (found, project) = (self.diagnosis.as_ref()?.as_ref().ok()?, session.project()?);
        let improved = Project { plant: found.diagnosis.improved.clone(), ..Project::clone(project) };
        let updated = improved.update(session.document(), project);
        Some(updated.map(|d| d.text().to_owned()).map_err(|error| error.to_string()))
    }
}

fn design_worker(wake: &WakeWindow) -> BackgroundWorker<PreviewRequest, Result<TimedPreview, ErrorLines>> {
    let (mut cache, own_wake, progress) =
        (PreviewCache::default(), Arc::clone(wake), SharedProgress::default());
    BackgroundWorker::new(Arc::clone(wake), move |request: PreviewRequest, token: &CancelToken| {
        let pool = CancellablePool { token, progress: &progress, wake: &own_wake };
        preview_timed(&request, &mut cache, &pool)
    })
}
