//! What runs off the window's thread: the live design, the verification, the diagnosis.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use counterpoise_project::diagnose::bench::Pool;
use counterpoise_project::diagnose::{Diagnosis, diagnose};
use counterpoise_project::pipeline;
use counterpoise_project::recording::Table;
use counterpoise_project::simulate::recording::Recording;
use counterpoise_project::simulate::replay::Loop;
use counterpoise_project::verify::VerifiedController;
use counterpoise_project::{Document, Project};

use crate::files::{self, Folder};
use crate::live::{Ask, Cache, Live, live, reasons};
use crate::worker::{Token, Wake, Worker};

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

type Reasons = Vec<String>;

/// The workers.
pub struct Jobs {
    /// Makes the live design.
    pub live: Worker<Ask, Result<Box<Live>, Reasons>>,
    /// Verifies.
    pub verify: Worker<VerifyAsk, Result<VerifiedController, Reasons>>,
    /// Diagnoses.
    pub diagnose: Worker<DiagnoseAsk, Result<Diagnosis, Reasons>>,
    /// The recordings to diagnose.
    pub recordings: Vec<PathBuf>,
    /// The last diagnosis, or why there is none.
    pub diagnosed: Option<Result<Diagnosis, Reasons>>,
    progress: Arc<Mutex<String>>,
}

impl Jobs {
    /// Workers that wait.
    pub fn new(wake: &Wake) -> Self {
        let mut cache = Cache::default();
        let progress = Arc::new(Mutex::new(String::new()));
        let (said, woken) = (Arc::clone(&progress), Arc::clone(wake));
        Self {
            live: Worker::new(Arc::clone(wake), move |ask, _| {
                live(&ask, &mut cache).map(Box::new).map_err(|error| reasons(&error))
            }),
            verify: Worker::new(Arc::clone(wake), |ask: VerifyAsk, _| {
                let live = &ask.live;
                pipeline::verify(&live.project, &live.modelled, &live.synthesised, &ask.folder)
                    .map_err(|error| reasons(&error))
            }),
            diagnose: Worker::new(Arc::clone(wake), move |ask, token| {
                let watch = Watch { token, said: &said, wake: &woken };
                diagnosis(&ask, &watch)
            }),
            recordings: Vec::new(),
            diagnosed: None,
            progress,
        }
    }

    /// Stops everything.
    pub fn cancel(&self) {
        self.live.cancel();
        self.verify.cancel();
        self.diagnose.cancel();
    }

    /// Whether anything runs.
    pub fn is_busy(&self) -> bool {
        self.live.is_busy() || self.verify.is_busy() || self.diagnose.is_busy()
    }

    /// How far the diagnosis is.
    pub fn progress(&self) -> String {
        self.progress.lock().map(|text| text.clone()).unwrap_or_default()
    }

    /// Takes a diagnosis that has come.
    pub fn take_diagnosis(&mut self) {
        if let Some((_, answer)) = self.diagnose.take() {
            self.diagnosed = Some(answer);
        }
    }

    /// The project's text with the diagnosed mechanism, where there is one.
    pub fn improved(&self, text: &str, project: &Project) -> Option<Result<String, String>> {
        let found = self.diagnosed.as_ref()?.as_ref().ok()?;
        let improved = Project { plant: found.improved.clone(), ..project.clone() };
        let document = Document::parse(text, "project.toml");
        let updated = improved.update(&document, project);
        Some(updated.map(|d| d.text().to_owned()).map_err(|error| error.to_string()))
    }
}

/// Processors of the diagnosis: it takes all but the window's, and stops when it is told to.
struct Watch<'a> {
    token: &'a Token,
    said: &'a Mutex<String>,
    wake: &'a Wake,
}

impl Pool for Watch<'_> {
    fn run(&self, count: usize, job: &(dyn Fn(usize) + Sync)) {
        let next = std::sync::atomic::AtomicUsize::new(0);
        let work = || {
            loop {
                let k = next.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
                if k >= count {
                    break;
                }
                job(k);
            }
        };
        let threads = std::thread::available_parallelism().map_or(1, usize::from).min(count.max(1));
        std::thread::scope(|scope| (0..threads).for_each(|_| drop(scope.spawn(work))));
    }

    fn cancelled(&self) -> bool {
        self.token.is_cancelled()
    }

    fn progress(&self, stage: &str, done: usize, of: usize) {
        if let Ok(mut said) = self.said.lock() {
            *said = format!("{stage} {}/{of}", done + 1);
        }
        (self.wake)();
    }
}

fn diagnosis(ask: &DiagnoseAsk, watch: &Watch) -> Result<Diagnosis, Reasons> {
    let recordings: Vec<Recording> =
        ask.paths.iter().map(|path| recording(&ask.project, path)).collect::<Result<_, _>>()?;
    let control = ask.project.recording_controller.as_ref().map_or(Loop::Open, Loop::from);
    diagnose(&ask.project.plant, control, &recordings, watch).map_err(|error| vec![error.to_string()])
}

/// Reads a recording as the project maps it.
///
/// # Errors
/// What is wrong with it, in words.
pub fn recording(project: &Project, path: &Path) -> Result<Recording, Reasons> {
    let name = path.display().to_string();
    let bytes = std::fs::read(path).map_err(|error| vec![format!("cannot read {name}: {error}")])?;
    let table = Table::read(&bytes, &name).map_err(|error| vec![error.to_string()])?;
    let record = project.recording.apply(&table).map_err(|error| vec![format!("{name}: {error}")])?;
    Ok(record.recording())
}

/// Writes the verified controller's code; gives the names of the files.
///
/// # Errors
/// Why it could not be made or written.
pub fn export(ask: &VerifyAsk, verified: &VerifiedController, out: &Path) -> Result<Vec<String>, String> {
    let made = pipeline::export(&ask.live.project, &ask.live.modelled, verified, &ask.folder)
        .map_err(|error| error.to_string())?;
    for file in &made {
        files::write(&out.join(&file.name), file.text.as_bytes())
            .map_err(|error| format!("{} cannot be written: {error}", out.join(&file.name).display()))?;
    }
    Ok(made.into_iter().map(|file| file.name).collect())
}
