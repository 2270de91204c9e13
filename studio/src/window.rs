//! The native window.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::command::Command;
use crate::files;
use crate::shell;
use crate::studio::Studio;

/// How the studio is started.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// The project to open.
    pub project: Option<PathBuf>,
    /// A log of commands to replay, one JSON value a line: the next one when the one before has had its consequences.
    pub script: Option<PathBuf>,
    /// Where to write what each frame took, as CSV.
    pub frame_log: Option<PathBuf>,
    /// Size of the window in points.
    pub size: Option<[f32; 2]>,
    /// Where the studio keeps its own files; the usual place where none is given.
    pub state: Option<PathBuf>,
}

/// Why the studio could not be run.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// There is no window system, or no way to draw.
    #[error(
        "no window can be opened: {0}. The command line does everything the studio does: counterpoise --help"
    )]
    Window(String),
    /// The script cannot be read.
    #[error("the script {path}: {why}")]
    Script {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        why: String,
    },
}

const SIZE: [f32; 2] = [1280.0, 800.0];

/// Opens the window and returns when it is closed.
///
/// # Errors
/// A script that cannot be read; a machine without a window system.
pub fn run(options: Options) -> Result<(), Error> {
    let script = options.script.as_deref().map(read_script).transpose()?.unwrap_or_default();
    let viewport = egui::ViewportBuilder::default()
        .with_title("Counterpoise")
        .with_app_id("counterpoise")
        .with_inner_size(options.size.unwrap_or(SIZE))
        .with_min_inner_size([960.0, 600.0]);
    let native = eframe::NativeOptions { viewport, ..Default::default() };
    let made = eframe::run_native(
        "counterpoise",
        native,
        Box::new(move |context| Ok(Box::new(Window::new(&context.egui_ctx, &options, script)))),
    );
    made.map_err(|error| Error::Window(reason(&error.to_string())))
}

/// What the window system says, without the file and line of its source that it says it at.
fn reason(error: &str) -> String {
    let said =
        error.rsplit_once(".rs:").and_then(|(_, rest)| rest.split_once(": ")).map_or(error, |(_, said)| said);
    said.trim_end_matches('.').to_owned()
}

fn read_script(path: &Path) -> Result<Vec<Command>, Error> {
    let bad = |why: String| Error::Script { path: path.to_owned(), why };
    let text = std::fs::read_to_string(path).map_err(|error| bad(error.to_string()))?;
    let line = |(k, line): (usize, &str)| {
        serde_json::from_str(line).map_err(|e| bad(format!("line {}: {e}", k + 1)))
    };
    text.lines().enumerate().filter(|(_, l)| !l.trim().is_empty()).map(line).collect()
}

/// The window with its studio.
struct Window {
    studio: Studio,
    script: std::vec::IntoIter<Command>,
    log: Option<std::fs::File>,
    drawn_revision: Option<u64>,
    changed: Instant,
    themed: Option<crate::theme::Theme>,
}

impl Window {
    fn new(ctx: &egui::Context, options: &Options, script: Vec<Command>) -> Self {
        let waking = ctx.clone();
        let wake = Arc::new(move || waking.request_repaint());
        let state = options.state.clone().unwrap_or_else(files::state_folder);
        let mut studio = Studio::new(&state, wake);
        if let Some(project) = &options.project {
            studio.open(project);
        }
        let mut log = options.frame_log.as_ref().and_then(|path| std::fs::File::create(path).ok());
        if let Some(log) = &mut log {
            let _ = writeln!(log, "revision,pipeline_ms,change_to_drawn_ms,frame_ms");
        }
        Self {
            studio,
            script: script.into_iter(),
            log,
            drawn_revision: None,
            changed: Instant::now(),
            themed: None,
        }
    }

    /// The next command of the script, when the last one is done.
    fn follow_script(&mut self) {
        let drawn = self.studio.results.live.as_ref().map(|of| of.revision);
        let now = self.studio.opened.as_ref().map(|o| o.session.revision());
        let busy = self.studio.results.designing || (drawn != now && self.studio.results.no_design.is_none());
        if busy && now.is_some() {
            return;
        }
        if let Some(command) = self.script.next() {
            self.changed = Instant::now();
            self.studio.run(&command);
        }
    }

    /// Notes what a redrawn design took, from the change to the end of the frame that shows it.
    fn note_frame(&mut self, begun: Instant) {
        let Some(of) = &self.studio.results.live else { return };
        if self.drawn_revision == Some(of.revision) {
            return;
        }
        self.drawn_revision = Some(of.revision);
        let ms = |d: Duration| d.as_secs_f64() * 1e3;
        if let Some(log) = &mut self.log {
            let took = [ms(of.value.took), ms(self.changed.elapsed()), ms(begun.elapsed())];
            let _ = writeln!(log, "{},{:.2},{:.2},{:.2}", of.revision, took[0], took[1], took[2]);
        }
    }
}

impl eframe::App for Window {
    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        let begun = Instant::now();
        if self.themed != Some(self.studio.view.theme) {
            self.studio.view.theme.apply(ui.ctx());
            self.themed = Some(self.studio.view.theme);
        }
        self.studio.tick();
        shell::show(&mut self.studio, ui);
        self.note_frame(begun);
        self.follow_script();
        self.studio.tick();
        let busy = self.script.len() > 0;
        ui.ctx().request_repaint_after(if busy {
            Duration::from_millis(2)
        } else {
            self.studio.wakes_after()
        });
    }

    fn on_exit(&mut self, _: Option<&eframe::glow::Context>) {
        self.studio.close();
    }
}
