//! The history of designs as the window shows it, and the designs that are drawn over the current one: A, B and C of this window, and
//! named ones of the project.

use std::collections::BTreeMap;
use std::sync::Arc;

use counterpoise_pipeline::preview::DesignPreview;
use counterpoise_verify::Verification;
use egui::Color32;

use crate::command::DesignSlot;
use crate::editing::design_history::{DeletedDesign, DesignHistory};

/// Most named designs that are drawn at once: as many as there are colours for them.
pub const MOST_OVERLAYS: usize = 5;

/// Most letters of a name in a legend: longer ones would leave no room for the others.
const LEGEND_LETTERS: usize = 14;

/// The name of a design that is drawn over the current one.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum OverlayName {
    /// A, B or C.
    Slot(DesignSlot),
    /// A design of the history.
    Named(String),
}

impl OverlayName {
    /// Returns the name as legends show it; a long one is cut.
    pub fn label(&self) -> String {
        let name = match self {
            OverlayName::Slot(slot) => slot.name(),
            OverlayName::Named(name) => name,
        };
        let is_long = name.chars().count() > LEGEND_LETTERS;
        let cut =
            |name: &str| name.chars().take(LEGEND_LETTERS - 1).collect::<String>().trim_end().to_owned();
        if is_long { format!("{}\u{2026}", cut(name)) } else { name.to_owned() }
    }
}

/// A design that is drawn over the current one.
#[derive(Debug, Clone)]
pub struct OverlaidDesign {
    /// The name.
    pub name: OverlayName,
    /// The colour of its curves.
    pub colour: Color32,
    /// The design.
    pub design: Arc<DesignPreview>,
}

/// The runs of a design on the full plant.
#[derive(Debug, Clone)]
pub struct OverlayRuns {
    /// The design.
    pub design: Arc<DesignPreview>,
    /// The verification; `None` if there is none for this design.
    pub found: Option<Arc<Verification>>,
}

/// The state of the file with the history.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum HistoryFileState {
    /// It is being read.
    #[default]
    Unread,
    /// It can be read, or there is none.
    Readable,
    /// It cannot be read, for this reason.
    Damaged(String),
}

/// A design that gets another name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DesignRenaming {
    /// The name.
    pub name: String,
    /// The other name, as far as it is typed.
    pub typed: String,
    /// `true` if the field is to get the keyboard.
    pub takes_focus: bool,
}

/// A kept design whose verification is still running.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AwaitedVerification {
    /// The revision of the project that was kept.
    pub revision: u64,
    /// The name of the design.
    pub name: String,
}

/// The history of the open project.
#[derive(Debug, Clone, Default)]
pub struct HistoryState {
    /// The designs.
    pub designs: DesignHistory,
    /// The state of their file.
    pub file: HistoryFileState,
    /// The contents of the file that this window has read, or has asked to write since.
    pub known: Vec<String>,
    /// The name that is typed for a new design.
    pub typed: String,
    /// `true` if the field of this name is to get the keyboard.
    pub focuses_name: bool,
    /// The design that gets another name.
    pub renaming: Option<DesignRenaming>,
    /// The design that was deleted last.
    pub deleted: Option<DeletedDesign>,
    /// The design whose figures follow when it is verified.
    pub awaited: Option<AwaitedVerification>,
    /// The names of the designs that are drawn, by the place of their colour.
    pub shown: BTreeMap<usize, String>,
    /// These designs, as far as they are computed.
    pub previews: BTreeMap<String, Arc<DesignPreview>>,
    /// Why a design cannot be computed.
    pub failures: BTreeMap<String, String>,
    /// The runs of the drawn designs on the full plant.
    pub runs: BTreeMap<OverlayName, OverlayRuns>,
    /// `true` if the user has stopped these runs.
    pub are_runs_stopped: bool,
    /// The project without the sections of its design, on which the designs were computed.
    pub mechanism_text: String,
    /// Revision of the project in which this text was compared last.
    pub compared_revision: Option<u64>,
    /// Number of such texts so far, by which a late answer is recognised.
    pub generation: u64,
}

impl HistoryState {
    /// Returns the first free name of the kind "design 1".
    pub fn free_name(&self) -> String {
        let names = (1..).map(|k| format!("design {k}"));
        names.into_iter().find(|name| self.designs.find(name).is_none()).unwrap_or_default()
    }

    /// Returns the place of the colour of a drawn design; `None` if it is not drawn.
    pub fn colour_place(&self, name: &str) -> Option<usize> {
        self.shown.iter().find(|(_, shown)| *shown == name).map(|(place, _)| *place)
    }

    /// Draws a design or draws it no longer.
    ///
    /// # Errors
    /// Returns why it cannot be drawn.
    pub fn toggle_overlay(&mut self, name: &str) -> Result<(), String> {
        self.are_runs_stopped = false;
        if let Some(place) = self.colour_place(name) {
            self.shown.remove(&place);
            return Ok(());
        }
        let free = (0..MOST_OVERLAYS).find(|place| !self.shown.contains_key(place));
        let place = free.ok_or_else(|| {
            format!("{MOST_OVERLAYS} named designs are drawn, which is the most: take another one out first")
        })?;
        self.failures.remove(name);
        self.shown.insert(place, name.to_owned());
        Ok(())
    }

    /// Returns the runs of a drawn design on the full plant, if they were made.
    pub fn runs_of(&self, overlaid: &OverlaidDesign) -> Option<&Verification> {
        let runs =
            self.runs.get(&overlaid.name).filter(|runs| Arc::ptr_eq(&runs.design, &overlaid.design))?;
        runs.found.as_deref()
    }

    /// Forgets what was computed of a design.
    pub fn forget_design(&mut self, name: &str) {
        self.previews.remove(name);
        self.failures.remove(name);
        self.runs.remove(&OverlayName::Named(name.to_owned()));
    }

    /// Gives everything that belongs to a design to its new name.
    pub fn move_design(&mut self, name: &str, new_name: &str) {
        if let Some(place) = self.colour_place(name) {
            self.shown.insert(place, new_name.to_owned());
        }
        if let Some(preview) = self.previews.remove(name) {
            self.previews.insert(new_name.to_owned(), preview);
        }
        if let Some(runs) = self.runs.remove(&OverlayName::Named(name.to_owned())) {
            self.runs.insert(OverlayName::Named(new_name.to_owned()), runs);
        }
        if let Some(awaited) = self.awaited.as_mut().filter(|awaited| awaited.name == name) {
            new_name.clone_into(&mut awaited.name);
        }
    }
}
