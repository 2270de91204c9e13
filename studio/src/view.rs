//! The view of the window: neither the project nor a result, and never undone.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use counterpoise_pipeline::preview::DesignPreview;
use serde::{Deserialize, Serialize};

use crate::browser::Browser;
use crate::charts::chart::Chart;
use crate::command::{Command, DesignSlot, DesignTab, DiagnosisTab, Page, VerificationTab};
use crate::commissioning_inputs::CommissioningInputs;
use crate::design_overlays::{HistoryState, OverlaidDesign, OverlayName};
use crate::help::page_texts::page_topic;
use crate::help::topics::HelpState;
use crate::study_inputs::{StudyInputs, StudyKind};
use crate::theme::{DARK, LIGHT, WindowTheme};
use crate::tile_layout::{PlotTiles, TilePlace};
use crate::units::DisplayUnits;

/// The part of the controller whose weights are shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ControllerPart {
    /// The feedback.
    Feedback,
    /// The feedforward from heave.
    Heave,
    /// The feedforward from pitch.
    Pitch,
}

/// A message at the foot of the window.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StatusNotice {
    /// The message.
    pub text: String,
    /// Kind.
    pub severity: NoticeKind,
}

/// The kind of a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoticeKind {
    /// Something was done.
    Info,
    /// Something went wrong.
    Error,
}

/// The state of the command palette.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct PaletteState {
    /// The typed text.
    pub typed: String,
    /// The selected entry.
    pub selected: usize,
}

/// Target of the question about unsaved edits: the project or the window.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CloseTarget {
    /// The project.
    Project,
    /// The window.
    Window,
}

/// The page Text as it is used.
#[derive(Debug, Clone, Default)]
pub struct TextViewState {
    /// The text that was shown last: if another stands in the project, its change is shown.
    pub shown: String,
    /// A place to be shown: line and column from 1.
    pub go_to: Option<TextPlace>,
    /// `true` if the text is to get the keyboard when the place is shown.
    pub focuses_editor: bool,
    /// `true` if the next error is to be shown.
    pub goes_to_error: bool,
    /// The word that is looked for.
    pub find: String,
    /// `true` if the field of this word is to get the keyboard.
    pub focuses_find: bool,
    /// Time and line of what was typed last, by which a new step of undo begins.
    pub typed: Option<TypedPlace>,
}

/// The tab X-Y of the page Diagnose.
#[derive(Debug, Clone, Default)]
pub struct CrossPlotState {
    /// Name of the horizontal channel; empty for the usual one.
    pub x: String,
    /// Name of the vertical channel; empty for the usual one.
    pub y: String,
    /// The window of time, s; `None` for the whole recording.
    pub window_s: Option<[f64; 2]>,
    /// The paths that were drawn last.
    pub paths: Option<Arc<CrossPlotPaths>>,
}

/// Paths of one channel against another.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CrossPlotPaths {
    /// Recording, channels and window that the paths belong to.
    pub key: String,
    /// As measured.
    pub measured: Vec<[f64; 2]>,
    /// As the project's model simulates it.
    pub model: Option<Vec<[f64; 2]>>,
    /// As the diagnosed model simulates it.
    pub improved: Option<Vec<[f64; 2]>>,
}

/// A place in the project's text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TextPlace {
    /// The line, from 1.
    pub line: usize,
    /// The character in it, from 1.
    pub column: usize,
}

/// Time and place of what was typed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TypedPlace {
    /// Time of the window, s.
    pub time_s: f64,
    /// The line, from 1.
    pub line: usize,
}

/// Outcome of a command of the view.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ViewCommand {
    /// The command concerned the view and was carried out.
    Applied,
    /// The command concerns something else.
    NotOfView,
}

/// The state of the window.
pub struct StudioView {
    /// The page.
    pub page: Page,
    /// Colours.
    pub theme: WindowTheme,
    /// Units.
    pub units: DisplayUnits,
    /// The tab of the page Design.
    pub design_tab: DesignTab,
    /// The tab of the page Verify.
    pub verification_tab: VerificationTab,
    /// The tab of the page Diagnose.
    pub diagnosis_tab: DiagnosisTab,
    /// The part of the controller whose weights are shown.
    pub part: ControllerPart,
    /// Designs kept for comparison.
    pub kept: BTreeMap<DesignSlot, Arc<DesignPreview>>,
    /// The texts of the projects whose designs are kept, by which they are restored.
    pub kept_texts: BTreeMap<DesignSlot, String>,
    /// The layouts of the plots.
    pub tiles: PlotTiles,
    /// The history of designs.
    pub history: HistoryState,
    /// Out-of-balance that is tried, kg m.
    pub trial_moment_kg_m: Option<f64>,
    /// Number of the last gesture.
    pub gesture: u64,
    /// `true` if a handle is being dragged.
    pub dragging: bool,
    /// `true` if a widget had the keyboard focus at the end of the last frame: Esc then belongs to it.
    pub had_keyboard_focus: bool,
    /// The message at the foot of the window.
    pub notice: Option<StatusNotice>,
    /// The command palette, while it is open.
    pub palette: Option<PaletteState>,
    /// The question about unsaved edits, while it is asked.
    pub close_question: Option<CloseTarget>,
    /// `true` if the difference to the file on disk is shown.
    pub shows_difference: bool,
    /// The recording that is shown.
    pub recording: usize,
    /// The file browser, while it is open.
    pub browser: Option<Browser>,
    /// The folder for exported code, if another than the default was chosen.
    pub output_folder: Option<PathBuf>,
    /// The plot that was under the pointer last.
    pub chart: Option<Chart>,
    /// The title of the plot that is to show its whole content.
    pub fit_request: Option<String>,
    /// `true` if the second cursor of the plot under the pointer is to be set or taken away.
    pub is_second_cursor_asked: bool,
    /// Key of the limits of plots beside their axes: the project and the part that is shown.
    pub limits_scope: String,
    /// The mode of the mechanism that is animated; 0 for none.
    pub mode: usize,
    /// The requirement that is selected.
    pub requirement: usize,
    /// The section of parameters that is open.
    pub section: usize,
    /// Inputs of the page Commission.
    pub commissioning: CommissioningInputs,
    /// The time at which the mechanism is drawn.
    pub motion: MotionState,
    /// The study of the page Studies.
    pub study: StudyKind,
    /// What the user gives the studies.
    pub study_inputs: StudyInputs,
    /// The page Text.
    pub text: TextViewState,
    /// The tab X-Y of the page Diagnose.
    pub cross_plot: CrossPlotState,
    /// Help.
    pub help: HelpState,
    /// `true` until the hint on what can be dragged was closed.
    pub shows_hint: bool,
}

/// The time of a run at which its mechanism is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MotionState {
    /// Time, s.
    pub time_s: f64,
    /// `true` while it runs on.
    pub is_running: bool,
}

impl Default for StudioView {
    fn default() -> Self {
        Self {
            page: Page::Design,
            theme: DARK,
            units: DisplayUnits::default(),
            design_tab: DesignTab::Consequences,
            verification_tab: VerificationTab::Histories,
            diagnosis_tab: DiagnosisTab::Signals,
            part: ControllerPart::Feedback,
            kept: BTreeMap::new(),
            kept_texts: BTreeMap::new(),
            tiles: PlotTiles::default(),
            history: HistoryState::default(),
            trial_moment_kg_m: None,
            gesture: 0,
            dragging: false,
            had_keyboard_focus: false,
            notice: None,
            palette: None,
            close_question: None,
            shows_difference: false,
            recording: 0,
            browser: None,
            output_folder: None,
            chart: None,
            fit_request: None,
            is_second_cursor_asked: false,
            limits_scope: String::new(),
            mode: 0,
            requirement: 0,
            section: 0,
            commissioning: CommissioningInputs::default(),
            motion: MotionState::default(),
            study: StudyKind::Search,
            study_inputs: StudyInputs::default(),
            text: TextViewState::default(),
            cross_plot: CrossPlotState::default(),
            help: HelpState::default(),
            shows_hint: true,
        }
    }
}

impl StudioView {
    /// Carries out a command that concerns the view alone.
    pub fn apply(&mut self, command: &Command) -> ViewCommand {
        match command {
            Command::Go { page } => self.page = *page,
            Command::Forget { slot } => {
                self.kept.remove(slot);
                self.kept_texts.remove(slot);
            }
            Command::NameDesign => {
                (self.page, self.design_tab) = (Page::Design, DesignTab::History);
                (self.history.typed, self.history.focuses_name) = (self.history.free_name(), true);
            }
            Command::OverlayDesign { name } => {
                if let Err(why) = self.history.toggle_overlay(name) {
                    self.show_error(why);
                }
            }
            Command::Try { out_of_balance_kg_m } => self.trial_moment_kg_m = *out_of_balance_kg_m,
            Command::ToggleTheme => self.theme = if self.theme == DARK { LIGHT } else { DARK },
            Command::ToggleFrequency => self.units.toggle_frequency(),
            Command::ToggleGain => self.units.toggle_gain(),
            Command::ToggleAngle => self.units.toggle_angle(),
            Command::ShowDesign { tab } => (self.page, self.design_tab) = (Page::Design, *tab),
            Command::ShowVerification { tab } => (self.page, self.verification_tab) = (Page::Verify, *tab),
            Command::SetCommissioning { inputs } => self.commissioning = inputs.clone(),
            Command::ShowStudy { study } => (self.page, self.study) = (Page::Studies, *study),
            Command::SetStudyInputs { inputs } => self.study_inputs = inputs.clone(),
            Command::SetCrossPlot { x, y, window_s } => {
                let plot = &mut self.cross_plot;
                (plot.x, plot.y, plot.window_s) = (x.clone(), y.clone(), *window_s);
            }
            Command::ShowLine { line, column } => {
                (self.page, self.text.focuses_editor) = (Page::Text, true);
                self.text.go_to = Some(TextPlace { line: *line, column: *column });
            }
            Command::NextError => (self.page, self.text.goes_to_error) = (Page::Text, true),
            Command::FindText => (self.page, self.text.focuses_find) = (Page::Text, true),
            Command::ShowDiagnosis { tab } => (self.page, self.diagnosis_tab) = (Page::Diagnose, *tab),
            Command::Help => self.help.toggle(page_topic(self.page)),
            Command::CloseHint => self.shows_hint = false,
            Command::ToggleSecondCursor => self.is_second_cursor_asked = true,
            Command::MaximisePlot | Command::HidePlot | Command::ShowPlot { .. } | Command::ResetPlots => {
                self.arrange_plots(command);
            }
            Command::Palette => {
                self.palette = if self.palette.is_some() { None } else { Some(PaletteState::default()) };
            }
            _ => return ViewCommand::NotOfView,
        }
        ViewCommand::Applied
    }

    /// Returns the place whose plots are tiles, if one is shown.
    pub fn shown_tiles(&self) -> Option<TilePlace> {
        TilePlace::find(self.page, self.design_tab, self.verification_tab)
    }

    fn arrange_plots(&mut self, command: &Command) {
        let Some(place) = self.shown_tiles() else { return };
        let tiles = &mut self.tiles;
        let pointed = tiles.pointed.clone().unwrap_or_default();
        match command {
            Command::MaximisePlot => tiles.toggle_maximised(place, &pointed),
            Command::HidePlot => tiles.hide_plot(place, &pointed),
            Command::ShowPlot { plot } => tiles.show_plot(place, plot),
            _ => tiles.reset(place),
        }
    }

    /// Returns the designs that are drawn over the current one: A, B and C, then the named ones.
    pub fn overlaid_designs(&self) -> Vec<OverlaidDesign> {
        let slots = self.kept.iter().map(|(slot, design)| OverlaidDesign {
            name: OverlayName::Slot(*slot),
            colour: self.theme.kept_colour(*slot),
            design: Arc::clone(design),
        });
        let named = self.history.shown.iter().filter_map(|(place, name)| {
            Some(OverlaidDesign {
                name: OverlayName::Named(name.clone()),
                colour: *self.theme.overlays.get(*place)?,
                design: Arc::clone(self.history.previews.get(name)?),
            })
        });
        slots.chain(named).collect()
    }

    /// Shows a message at the foot of the window.
    pub fn show_message(&mut self, text: impl Into<String>) {
        self.notice = Some(StatusNotice { text: text.into(), severity: NoticeKind::Info });
    }

    /// Shows what went wrong at the foot of the window.
    pub fn show_error(&mut self, text: impl Into<String>) {
        self.notice = Some(StatusNotice { text: text.into(), severity: NoticeKind::Error });
    }
}
