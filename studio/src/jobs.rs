//! What runs off the window's thread: the live design, the verification, the diagnosis.

use std::path::PathBuf;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use counterpoise_host::projects;
use counterpoise_models::Parameters;
use counterpoise_models::parameters::Beam;
use counterpoise_pipeline::recordings::diagnose;
use counterpoise_pipeline::studies::trade_off::{EffortPoint, effort};
use counterpoise_pipeline::{self as pipeline, World};
use counterpoise_project::{Document, Project};
use counterpoise_report::wording::answer::{DescribedDiagnosis, describe_diagnosed_recordings};
use counterpoise_report::wording::recordings::describe_recordings_error;
use counterpoise_verify::{Verification, VerifiedController};

use crate::browser::{Listing, list};
use crate::chart::Chart;
use crate::command::Purpose;
use crate::errands::{Desk, Done, Errand, Glance, Glanced, glance};
use crate::exporting::{ExportAsk, Written, export};
use crate::live::{Ask, Cache, Live, live, reasons};
use crate::measure::{MeasureAnswer, MeasureAsk, SoFar, measure};
use crate::portrait::{Portrait, Swinging};
use crate::recordings::{LookAsk, Looked, Seen, look};
use crate::results::Of;
use counterpoise_host::files::Folder;
use counterpoise_host::progress::{Progress, Watch};
use counterpoise_host::worker::{Token, Wake, Worker};

/// What is asked of the verification.
#[derive(Debug, Clone)]
pub struct VerifyAsk {
    /// The design.
    pub live: Arc<Live>,
    /// Where the project's files are.
    pub folder: Folder,
}

/// What is asked of the diagnosis.
#[derive(Debug, Clone)]
pub struct DiagnoseAsk {
    /// The project.
    pub project: Arc<Project>,
    /// The recordings.
    pub paths: Vec<PathBuf>,
}

/// What is asked of the trade-off.
#[derive(Debug, Clone)]
pub struct EffortAsk {
    /// The design around which error and effort are traded.
    pub live: Arc<Live>,
}

/// Why there is no result, one reason a line.
pub type Reasons = Vec<String>;

/// What a running verification has found so far, with its revision.
pub type Partial = Arc<Mutex<Option<(u64, Arc<Verification>)>>>;

/// The workers.
pub struct Jobs {
    /// Makes the live design.
    pub live: Worker<Ask, Result<Box<Live>, Reasons>>,
    /// Verifies.
    pub verify: Worker<(u64, VerifyAsk), Result<Option<VerifiedController>, Reasons>>,
    /// Trades error against effort.
    pub effort: Worker<EffortAsk, Option<Vec<EffortPoint>>>,
    /// Measures.
    pub measure: Worker<MeasureAsk, MeasureAnswer>,
    /// Exports.
    pub export: Worker<ExportAsk, Result<Option<Written>, String>>,
    /// Diagnoses.
    pub diagnose: Worker<DiagnoseAsk, Result<DescribedDiagnosis, Reasons>>,
    /// Lays recordings beside the model.
    pub look: Worker<LookAsk, Option<Looked>>,
    /// Lists folders.
    pub list: Worker<(PathBuf, Purpose), Listing>,
    /// Reads and writes projects.
    pub file: Worker<Errand, Done>,
    /// Looks whether somebody else wrote the project file.
    pub glance: Worker<Glance, Glanced>,
    /// Draws up what is shown of a plant.
    pub portrait: Worker<Arc<Live>, Portrait>,
    /// Finds the modes of a beam.
    pub swing: Worker<Beam, Swinging>,
    /// Writes a plot for the clipboard.
    pub copy: Worker<(Chart, Form), Copied>,
    /// Recordings beside the project, to offer.
    pub beside: Vec<PathBuf>,
    /// The recordings to diagnose.
    pub recordings: Vec<PathBuf>,
    /// The recordings beside the model, of a revision of the project.
    pub seen: Option<Of<Vec<Seen>>>,
    /// The last diagnosis, or why there is none.
    pub diagnosed: Option<Result<DescribedDiagnosis, Reasons>>,
    /// The mechanism that was diagnosed.
    pub diagnosed_plant: Option<Parameters>,
    /// What a running verification has found so far.
    pub partial: Partial,
    /// What a running campaign has found so far.
    pub so_far: SoFar,
    diagnosing: Progress,
    measuring: Progress,
}

/// As what a plot is copied.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// Numbers.
    Csv,
    /// A drawing.
    Svg,
    /// Pixels.
    Png,
}

/// A plot for the clipboard.
#[derive(Debug, Clone, PartialEq)]
pub enum Copy {
    /// Numbers or a drawing.
    Text(String),
    /// Pixels.
    Pixels(Arc<egui::ColorImage>),
}

/// A copied plot: its form, its title, and what goes into the clipboard, or why there is nothing.
pub type Copied = (Form, String, Result<Copy, String>);

/// Writes a plot in a form.
fn written((chart, form): (Chart, Form), _: &Token) -> Copied {
    let copy = match form {
        Form::Csv => Ok(Copy::Text(chart.csv())),
        Form::Svg => Ok(Copy::Text(chart.svg())),
        Form::Png => crate::picture::pixels(&chart).map_err(|error| error.to_string()).map(|picture| {
            let size = [picture.width, picture.height];
            Copy::Pixels(Arc::new(egui::ColorImage::from_rgb(size, &picture.rgb)))
        }),
    };
    (form, chart.title, copy)
}

/// Factors on the error weight at which error is traded against effort.
fn factors() -> Vec<f64> {
    (-6..=6).map(|k| 2f64.powf(0.5 * f64::from(k))).collect()
}

/// Between two looks at a running verification.
const LOOK_EVERY: Duration = Duration::from_millis(60);

impl Jobs {
    /// Workers that wait.
    pub fn new(wake: &Wake, desk: Desk) -> Self {
        let disk = Arc::clone(&desk.disk);
        let mut cache = Cache::default();
        let (diagnosing, measuring) = (Progress::default(), Progress::default());
        let (partial, so_far) = (Partial::default(), SoFar::default());
        Self {
            live: Worker::new(Arc::clone(wake), move |ask, _| {
                live(&ask, &mut cache).map(Box::new).map_err(|error| reasons(&error))
            }),
            verify: verifier(wake, &partial),
            effort: Worker::new(Arc::clone(wake), |ask: EffortAsk, token: &Token| {
                let d = &ask.live;
                effort(&d.project, (&d.modelled, &d.reduced), &factors(), &|| !token.is_cancelled()).ok()?
            }),
            measure: measurer(wake, &measuring, &so_far),
            export: Worker::new(Arc::clone(wake), |ask: ExportAsk, token: &Token| export(&ask, token)),
            diagnose: diagnoser(wake, &diagnosing),
            look: Worker::new(Arc::clone(wake), |ask: LookAsk, token: &Token| look(&ask, token)),
            list: Worker::new(Arc::clone(wake), |(folder, purpose): (PathBuf, Purpose), _: &Token| {
                list(&folder, purpose)
            }),
            file: Worker::new(Arc::clone(wake), move |errand, _: &Token| desk.carry_out(errand)),
            glance: Worker::new(Arc::clone(wake), move |ask, _: &Token| glance(ask, disk.as_ref())),
            portrait: Worker::new(Arc::clone(wake), |live: Arc<Live>, _: &Token| Portrait::of(&live)),
            swing: Worker::new(Arc::clone(wake), |beam, _: &Token| Swinging::of(beam)),
            copy: Worker::new(Arc::clone(wake), written),
            beside: Vec::new(),
            recordings: Vec::new(),
            seen: None,
            diagnosed: None,
            diagnosed_plant: None,
            partial,
            so_far,
            diagnosing,
            measuring,
        }
    }

    /// Stops everything.
    pub fn cancel(&self) {
        self.live.cancel();
        self.verify.cancel();
        self.effort.cancel();
        self.measure.cancel();
        self.export.cancel();
        self.diagnose.cancel();
        self.look.cancel();
    }

    /// Whether anything runs, or has an answer that was not yet taken.
    pub fn is_busy(&self) -> bool {
        self.live.is_pending()
            || self.verify.is_pending()
            || self.effort.is_pending()
            || self.measure.is_pending()
            || self.export.is_pending()
            || self.diagnose.is_pending()
            || self.look.is_pending()
    }

    /// Whether anything small runs that needs no word: files, portraits, copies.
    pub fn is_tidying(&self) -> bool {
        self.file.is_pending()
            || self.glance.is_pending()
            || self.portrait.is_pending()
            || self.swing.is_pending()
            || self.copy.is_pending()
    }

    /// How far the diagnosis is.
    pub fn progress(&self) -> String {
        self.diagnosing.said()
    }

    /// How far the measurement is.
    pub fn measuring(&self) -> String {
        self.measuring.said()
    }

    /// Takes what has come of recordings and diagnoses; says whether there is a new diagnosis.
    pub fn take_diagnosis(&mut self) -> bool {
        if let Some((revision, Some(looked))) = self.look.take() {
            self.recordings = looked.files;
            self.seen = Some(Of { revision, value: looked.seen });
        }
        let answer = self.diagnose.take();
        let came = answer.is_some();
        if let Some((_, answer)) = answer {
            self.diagnosed = Some(answer);
        }
        came
    }

    /// Forgets recordings and diagnoses: another project is opened.
    pub fn forget(&mut self) {
        self.cancel();
        (self.seen, self.diagnosed, self.diagnosed_plant) = (None, None, None);
        self.recordings.clear();
    }

    /// The project's text with the diagnosed mechanism, where there is one.
    pub fn improved(&self, text: &str, project: &Project) -> Option<Result<String, String>> {
        let found = self.diagnosed.as_ref()?.as_ref().ok()?;
        let improved = Project { plant: found.diagnosis.improved.clone(), ..project.clone() };
        let document = Document::parse(text, "project.toml");
        let updated = improved.update(&document, project);
        Some(updated.map(|d| d.text().to_owned()).map_err(|error| error.to_string()))
    }
}

fn verifier(
    wake: &Wake,
    partial: &Partial,
) -> Worker<(u64, VerifyAsk), Result<Option<VerifiedController>, Reasons>> {
    let (partial, woken) = (Arc::clone(partial), Arc::clone(wake));
    Worker::new(Arc::clone(wake), move |(revision, ask): (u64, VerifyAsk), token: &Token| {
        let (live, mut looked) = (&ask.live, None::<Instant>);
        let mut watch = |found: &Verification| {
            if looked.is_none_or(|at| at.elapsed() > LOOK_EVERY) {
                if let Ok(mut kept) = partial.lock() {
                    *kept = Some((revision, Arc::new(found.clone())));
                }
                looked = Some(Instant::now());
                woken();
            }
            !token.is_cancelled()
        };
        let seen = (&ask.folder as &dyn World, &mut watch as &mut dyn FnMut(&Verification) -> bool);
        pipeline::verify_watched(&live.project, &live.modelled, &live.synthesised, seen)
            .map_err(|error| reasons(&error))
    })
}

fn measurer(wake: &Wake, progress: &Progress, so_far: &SoFar) -> Worker<MeasureAsk, MeasureAnswer> {
    let (progress, woken, so_far) = (progress.clone(), Arc::clone(wake), Arc::clone(so_far));
    Worker::new(Arc::clone(wake), move |ask: MeasureAsk, token: &Token| {
        measure(&ask, &so_far, &Watch { token, progress: &progress, wake: &woken })
    })
}

fn diagnoser(wake: &Wake, progress: &Progress) -> Worker<DiagnoseAsk, Result<DescribedDiagnosis, Reasons>> {
    let (progress, woken) = (progress.clone(), Arc::clone(wake));
    Worker::new(Arc::clone(wake), move |ask: DiagnoseAsk, token: &Token| {
        diagnosis(&ask, &Watch { token, progress: &progress, wake: &woken })
    })
}

fn diagnosis(ask: &DiagnoseAsk, watch: &Watch) -> Result<DescribedDiagnosis, Reasons> {
    let files = projects::recordings(&ask.paths).map_err(|error| vec![format!("{error:#}")])?;
    let found =
        diagnose(&ask.project, &files, watch).map_err(|error| vec![describe_recordings_error(&error)])?;
    Ok(describe_diagnosed_recordings(&found))
}
