//! The native window.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::command::Command;
use crate::replay::{FrameLog, Offscreen, Script};
use crate::shell;
use crate::studio::Studio;
use counterpoise_host::code_files::Library;
use counterpoise_host::files;

/// What the studio is seen on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Surface {
    /// A window.
    #[default]
    Window,
    /// Nothing: the script is carried out frame by frame and the studio ends with it.
    Nothing,
}

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
    /// What it is seen on.
    pub surface: Surface,
    /// Makes the libraries of FMI units; none are made where nobody says how.
    pub library: Option<Library>,
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
    if options.surface == Surface::Nothing {
        unseen(&options, script);
        return Ok(());
    }
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

/// Carries out the script without a window.
fn unseen(options: &Options, script: Vec<Command>) {
    let state = options.state.clone().unwrap_or_else(files::state_folder);
    let mut offscreen = Offscreen::new(&state, options.size.unwrap_or(SIZE));
    prepare(&mut offscreen.studio, options);
    offscreen.play(script, &mut FrameLog::new(options.frame_log.as_deref()));
    offscreen.studio.close();
}

fn prepare(studio: &mut Studio, options: &Options) {
    if let Some(library) = options.library {
        studio.library = library;
    }
    if let Some(project) = &options.project {
        studio.open(project);
    }
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
    script: Script,
    log: FrameLog,
    themed: Option<crate::theme::Theme>,
    /// Whether the window closes as soon as everything is saved.
    closing: bool,
    /// What stands in its title.
    titled: String,
}

impl Window {
    fn new(ctx: &egui::Context, options: &Options, script: Vec<Command>) -> Self {
        let waking = ctx.clone();
        let wake = Arc::new(move || waking.request_repaint());
        let state = options.state.clone().unwrap_or_else(files::state_folder);
        let mut studio = Studio::new(&state, wake);
        prepare(&mut studio, options);
        let log = FrameLog::new(options.frame_log.as_deref());
        Self { studio, script: Script::new(script), log, themed: None, closing: false, titled: String::new() }
    }

    /// Names the project in the window's title, with a star where it is not saved.
    fn entitle(&mut self, ctx: &egui::Context) {
        let title = self.studio.opened.as_ref().map_or_else(
            || "Counterpoise".to_owned(),
            |o| {
                let name = o.session.project().map_or("project", |p| p.plant.name.as_str());
                format!("{}{name} - Counterpoise", if o.session.is_changed() { "*" } else { "" })
            },
        );
        if title != self.titled {
            ctx.send_viewport_cmd(egui::ViewportCommand::Title(title.clone()));
            self.titled = title;
        }
    }

    /// Closes when everything is saved that was to be; stays where something could not be saved.
    fn close_when_saved(&mut self, ctx: &egui::Context) {
        let is_saving = self.studio.filing.is_saving();
        if ctx.input(|i| i.viewport().close_requested()) && is_saving && !self.closing {
            ctx.send_viewport_cmd(egui::ViewportCommand::CancelClose);
            self.closing = true;
            self.studio.view.say("the window closes when the project is saved");
        }
        if self.closing && !is_saving {
            self.closing = false;
            if !self.studio.opened.as_ref().is_some_and(|o| o.session.is_changed()) {
                ctx.send_viewport_cmd(egui::ViewportCommand::Close);
            }
        }
    }

    /// The next command of the script, when the last one is done.
    fn follow_script(&mut self) {
        if let Some(command) = self.script.next(&self.studio) {
            self.log.changes();
            self.studio.run(&command);
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
        self.log.frame(&self.studio, begun);
        self.follow_script();
        self.studio.tick();
        self.close_when_saved(ui.ctx());
        self.entitle(ui.ctx());
        let busy = !self.script.is_done();
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
