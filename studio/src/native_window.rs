//! The native window.

use counterpoise_host::clock::Moment;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use counterpoise_host::code_files::LibraryBuilder;
use counterpoise_host::files;

use crate::command::Command;
use crate::frame_log::FrameLog;
use crate::main_window;
use crate::offscreen::OffscreenStudio;
use crate::script::Script;
use crate::settings::UserSettings;
use crate::studio::{Studio, WindowClosing};
use crate::view::CloseTarget;

/// The edits in the project's session that are not in its file.
#[derive(Debug, Clone, Copy, PartialEq)]
enum UnsavedWork {
    Nothing,
    Changed,
    BeingSaved,
}

/// Surface on which the studio is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum DisplaySurface {
    /// In a window.
    #[default]
    Window,
    /// Nowhere: the script is carried out frame by frame, and the studio ends with it.
    Headless,
}

/// Options with which the studio is started.
#[derive(Debug, Clone, Default)]
pub struct StartOptions {
    /// The project to open.
    pub project: Option<PathBuf>,
    /// A script of commands, one JSON value a line.
    pub script: Option<PathBuf>,
    /// The file for the time of each redrawn design, as CSV.
    pub frame_log: Option<PathBuf>,
    /// Size of the window in points.
    pub size: Option<[f32; 2]>,
    /// The folder with the studio's own files; `None` for the usual one.
    pub state: Option<PathBuf>,
    /// Surface on which the studio is drawn.
    pub surface: DisplaySurface,
    /// Builds the libraries of FMI units; without it none are built.
    pub library: Option<LibraryBuilder>,
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
        /// Description of the error.
        why: String,
    },
}

/// Size of the window at the first start, points.
const SIZE: [f32; 2] = [1280.0, 800.0];
/// Smallest size of the window, points: below it the panels leave no space for plots.
const SMALLEST_SIZE: [f32; 2] = [960.0, 600.0];
/// Time between two frames while a script runs.
const SCRIPT_INTERVAL: Duration = Duration::from_millis(2);

/// Opens the window and returns when it is closed.
///
/// # Errors
/// Returns an error if the script cannot be read or no window can be opened.
pub fn run(options: StartOptions) -> Result<(), Error> {
    let script = options.script.as_deref().map(read_script).transpose()?.unwrap_or_default();
    if options.surface == DisplaySurface::Headless {
        run_headless(&options, script);
        return Ok(());
    }
    let remembered = UserSettings::load(&options.state.clone().unwrap_or_else(files::state_folder));
    let viewport = egui::ViewportBuilder::default()
        .with_title("Counterpoise")
        .with_app_id("counterpoise")
        .with_inner_size(options.size.or(remembered.window_size).unwrap_or(SIZE))
        .with_min_inner_size(SMALLEST_SIZE);
    let native = eframe::NativeOptions { viewport, ..Default::default() };
    let made = eframe::run_native(
        "counterpoise",
        native,
        Box::new(move |context| Ok(Box::new(NativeWindow::new(&context.egui_ctx, &options, script)))),
    );
    made.map_err(|error| Error::Window(reason(&error.to_string())))
}

/// Returns what the window system says, without the file and line of its source code.
fn reason(error: &str) -> String {
    let text =
        error.rsplit_once(".rs:").and_then(|(_, rest)| rest.split_once(": ")).map_or(error, |(_, text)| text);
    text.trim_end_matches('.').to_owned()
}

fn run_headless(options: &StartOptions, script: Vec<Command>) {
    let state = options.state.clone().unwrap_or_else(files::state_folder);
    let mut offscreen = OffscreenStudio::new(&state, options.size.unwrap_or(SIZE));
    prepare(&mut offscreen.studio, options);
    offscreen.run_script(script, &mut FrameLog::new(options.frame_log.as_deref()));
    offscreen.studio.close();
}

fn prepare(studio: &mut Studio, options: &StartOptions) {
    if let Some(library) = options.library {
        studio.library = library;
    }
    if let Some(project) = &options.project {
        studio.open(project);
    }
}

fn read_script(path: &Path) -> Result<Vec<Command>, Error> {
    let error = |why: String| Error::Script { path: path.to_owned(), why };
    let bytes = files::read_file(path).map_err(|e| error(e.to_string()))?;
    let text = String::from_utf8(bytes).map_err(|e| error(e.to_string()))?;
    let line = |(k, line): (usize, &str)| {
        serde_json::from_str(line).map_err(|e| error(format!("line {}: {e}", k + 1)))
    };
    text.lines().enumerate().filter(|(_, l)| !l.trim().is_empty()).map(line).collect()
}

/// The window with its studio.
struct NativeWindow {
    studio: Studio,
    script: Script,
    log: FrameLog,
    theme: Option<crate::theme::WindowTheme>,
    /// `true` if the window closes as soon as everything is saved.
    closes_after_save: bool,
    title: String,
}

impl NativeWindow {
    fn new(ctx: &egui::Context, options: &StartOptions, script: Vec<Command>) -> Self {
        let waking = ctx.clone();
        let wake = Arc::new(move || waking.request_repaint());
        let state = options.state.clone().unwrap_or_else(files::state_folder);
        let mut studio = Studio::new(&state, wake);
        if let Some(zoom) = studio.user_settings.zoom {
            ctx.set_zoom_factor(zoom);
        }
        prepare(&mut studio, options);
        let log = FrameLog::new(options.frame_log.as_deref());
        let script = Script::new(script);
        Self { studio, script, log, theme: None, closes_after_save: false, title: String::new() }
    }

    /// Sets the window's title: the project with its folder, and a star if it is not saved.
    fn set_title(&mut self, ctx: &egui::Context) {
        let title = self.studio.opened.as_ref().map_or_else(
            || "Counterpoise".to_owned(),
            |o| {
                let name = o.session.project().map_or("project", |p| p.plant.name.as_str());
                let folder = o.path.parent().unwrap_or(Path::new(".")).display().to_string();
                let star = if o.session.is_changed() { "*" } else { "" };
                format!("{star}{name} - {folder} - Counterpoise")
            },
        );
        if title != self.title {
            ctx.send_viewport_cmd(egui::ViewportCommand::Title(title.clone()));
            self.title = title;
        }
    }

    /// Closes the window if nothing is unsaved; otherwise asks first, or waits until everything is saved.
    fn handle_close_request(&mut self, ctx: &egui::Context) {
        let studio = &mut self.studio;
        let is_changed = studio.opened.as_ref().is_some_and(|o| o.session.is_changed() && !o.is_read_only());
        let unsaved = match (studio.file_queue.is_saving(), is_changed) {
            (true, _) => UnsavedWork::BeingSaved,
            (false, true) => UnsavedWork::Changed,
            (false, false) => UnsavedWork::Nothing,
        };
        if ctx.input(|i| i.viewport().close_requested()) && unsaved != UnsavedWork::Nothing {
            self.ask_before_closing(unsaved);
            ctx.send_viewport_cmd(egui::ViewportCommand::CancelClose);
        }
        let studio = &mut self.studio;
        let is_project_closed = studio.window_closing == WindowClosing::WhenProjectIsClosed
            && studio.opened.is_none()
            && !studio.file_queue.is_busy();
        if is_project_closed || (self.closes_after_save && unsaved == UnsavedWork::Nothing) {
            ctx.send_viewport_cmd(egui::ViewportCommand::Close);
        }
        self.closes_after_save &= unsaved == UnsavedWork::BeingSaved;
    }

    fn ask_before_closing(&mut self, unsaved: UnsavedWork) {
        match unsaved {
            UnsavedWork::BeingSaved => {
                self.closes_after_save = true;
                self.studio.view.show_message("the window closes when the project is saved");
            }
            UnsavedWork::Changed => self.studio.view.close_question = Some(CloseTarget::Window),
            UnsavedWork::Nothing => {}
        }
    }

    /// Remembers zoom and size for the next start.
    fn remember_window(&mut self, ctx: &egui::Context) {
        let settings = &mut self.studio.user_settings;
        settings.zoom = Some(ctx.zoom_factor());
        let size = ctx.input(|i| i.viewport().inner_rect).map(|rect| rect.size());
        settings.window_size = size.map(|size| [size.x, size.y]).or(settings.window_size);
    }

    /// Runs the next command of the script when the last one is done.
    fn follow_script(&mut self) {
        if let Some(command) = self.script.next_command(&self.studio) {
            self.log.mark_change();
            self.studio.run(&command);
        }
    }
}

impl eframe::App for NativeWindow {
    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        let begun = Moment::now();
        if self.theme != Some(self.studio.view.theme) {
            self.studio.view.theme.apply(ui.ctx());
            self.theme = Some(self.studio.view.theme);
        }
        self.studio.update();
        main_window::show(&mut self.studio, ui);
        self.log.record_frame(&self.studio, begun);
        self.follow_script();
        self.remember_window(ui.ctx());
        self.studio.update();
        self.handle_close_request(ui.ctx());
        self.set_title(ui.ctx());
        if !self.script.is_done() {
            ui.ctx().request_repaint_after(SCRIPT_INTERVAL);
        } else if let Some(wait) = self.studio.next_wake_after() {
            ui.ctx().request_repaint_after(wait);
        }
    }

    fn on_exit(&mut self, _: Option<&eframe::glow::Context>) {
        self.studio.close();
    }
}
