//! Everything that can be done in the studio, as one closed list: menus, shortcuts, the command palette, tests and scripts use it.
//!
//! Modules in reading order: [`choices`] (what commands choose from), [`list`] (names and shortcuts).

pub mod choices;
pub mod list;

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

pub use choices::{BrowsePurpose, DesignSlot, DesignTab, DiagnosisTab, Page, VerificationTab};
pub use list::{CommandEntry, list_commands};

use crate::commissioning_inputs::CommissioningInputs;
use crate::study_inputs::{StudyInputs, StudyKind};

/// Action of the user.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Command {
    /// Sets a number of the project. Sets that share a gesture (a drag) are one step of undo.
    Set {
        /// Path of the key, as in `synth.feedback.error.gain`.
        path: String,
        /// Value, SI.
        value: f64,
        /// The gesture that the command belongs to.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        gesture: Option<u64>,
    },
    /// Sets a whole number of the project.
    SetWhole {
        /// Path of the key.
        path: String,
        /// Value.
        value: i64,
    },
    /// Sets a text or a choice of the project.
    SetText {
        /// Path of the key.
        path: String,
        /// Value.
        value: String,
    },
    /// Removes a key from the project, which then has its default.
    Remove {
        /// Path of the key.
        path: String,
    },
    /// Replaces the whole text of the project.
    Replace {
        /// The text.
        text: String,
    },
    /// Replaces a stretch of the project's text, as it is typed. Changes that share a gesture are one step of undo.
    SpliceText {
        /// First byte of the stretch.
        from: usize,
        /// Byte behind its last.
        to: usize,
        /// The text that replaces it.
        inserted: String,
        /// The gesture that the command belongs to.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        gesture: Option<u64>,
    },
    /// Undoes the last change of the project.
    Undo,
    /// Redoes the change that was undone last.
    Redo,
    /// Opens a project file, or a folder with a project.toml.
    Open {
        /// The path.
        path: PathBuf,
    },
    /// Makes a folder with a project file to start from, and opens it.
    New {
        /// The folder; it must not hold a project.
        folder: PathBuf,
        /// Name of the kind of machine that the file describes in a few lines; `None` for a complete file.
        #[serde(default)]
        like: Option<String>,
    },
    /// Writes a copy of an example into a folder of its name, and opens it.
    CopyExample {
        /// The name of the example.
        example: String,
        /// The folder in which the folder of the copy is made.
        folder: PathBuf,
    },
    /// Shows files and folders to choose from.
    Browse {
        /// Kind of file or folder that the user is asked for.
        purpose: BrowsePurpose,
    },
    /// Closes the project; unsaved edits are restored when it is opened again.
    Close,
    /// Closes the project, and asks first if there are unsaved edits.
    AskClose,
    /// Closes the project and discards unsaved edits.
    DiscardAndClose,
    /// Writes the project to its file, unless another program has changed the file.
    Save,
    /// Writes the project to its file, even if another program has changed the file.
    Overwrite,
    /// Writes the project to another file, with the files that it names, and continues there.
    SaveAs {
        /// The file, or a folder for a project.toml.
        path: PathBuf,
    },
    /// Replaces the project by the content of its file; one step of undo restores the edits.
    Reload,
    /// Verifies the design on the full plant.
    Verify,
    /// Measures the frequency responses of the full plant with the controller, amplitude by amplitude.
    Measure,
    /// Simulates the controller on many mechanisms that differ as the project says.
    Sweep,
    /// Shows a study and what it found.
    ShowStudy {
        /// The study.
        study: StudyKind,
    },
    /// Makes a study of the project as it stands.
    RunStudy {
        /// The study.
        study: StudyKind,
    },
    /// Makes the study that is shown.
    RunShownStudy,
    /// Sets what the user gives the studies.
    SetStudyInputs {
        /// The inputs.
        inputs: StudyInputs,
    },
    /// Takes a proposal of the study that is shown into the project; one step of undo removes it again.
    TakeProposal {
        /// Its number, from 1.
        number: usize,
    },
    /// Shows one tab of the design.
    #[serde(rename = "look-at-design")]
    ShowDesign {
        /// The tab.
        tab: DesignTab,
    },
    /// Shows one tab of the verification.
    #[serde(rename = "look")]
    ShowVerification {
        /// The tab.
        #[serde(rename = "evidence")]
        tab: VerificationTab,
    },
    /// Cancels what is running.
    Cancel,
    /// Writes the verified controller's code into the folder that was chosen last; `out` in the project's folder if none was.
    Export,
    /// Writes the code into another folder.
    ExportTo {
        /// The folder; it is made if it does not exist.
        folder: PathBuf,
    },
    /// Gives recordings to the diagnosis.
    Recordings {
        /// Files.
        paths: Vec<PathBuf>,
    },
    /// Shows one tab of the diagnosis.
    #[serde(rename = "inquire")]
    ShowDiagnosis {
        /// The tab.
        #[serde(rename = "inquiry")]
        tab: DiagnosisTab,
    },
    /// Chooses what the tab X-Y draws.
    SetCrossPlot {
        /// Name of the horizontal channel.
        x: String,
        /// Name of the vertical channel.
        y: String,
        /// Start and end of the window of time, s; none for the whole recording.
        #[serde(default)]
        window_s: Option<[f64; 2]>,
    },
    /// Diagnoses the machine from the recordings.
    Diagnose,
    /// Puts the improved mechanism of the diagnosis into the project.
    Accept,
    /// Sets machine program, limits and folder of a commissioning.
    SetCommissioning {
        /// The inputs of the page Commission.
        inputs: CommissioningInputs,
    },
    /// Reads the finished rounds of the commissioning.
    ReadRounds,
    /// Runs the next round of the commissioning.
    RunRound,
    /// Puts the newest model that the rounds left into the project.
    AcceptRound,
    /// Shows a page.
    Go {
        /// The page.
        #[serde(rename = "place")]
        page: Page,
    },
    /// Shows a line of the project's text on the page Text.
    ShowLine {
        /// The line, from 1.
        line: usize,
        /// The character in it, from 1.
        column: usize,
    },
    /// Shows the next error of the project's text, below the cursor or again from the top.
    NextError,
    /// Looks for a word in the project's text.
    FindText,
    /// Keeps the design as it stands for comparison.
    Keep {
        /// The slot.
        slot: DesignSlot,
    },
    /// Puts the weights and the order of a kept design back into the project.
    Return {
        /// The slot.
        slot: DesignSlot,
    },
    /// Clears a kept design.
    Forget {
        /// The slot.
        slot: DesignSlot,
    },
    /// Asks for the name of the design as it stands, to keep it in the project's history of designs.
    NameDesign,
    /// Keeps the design as it stands in the history.
    KeepDesign {
        /// The name.
        name: String,
    },
    /// Puts the weights and the order of a design of the history back into the project.
    RestoreDesign {
        /// The name.
        name: String,
    },
    /// Draws a design of the history over the current one, or draws it no longer.
    OverlayDesign {
        /// The name.
        name: String,
    },
    /// Gives a design of the history another name.
    RenameDesign {
        /// The name.
        name: String,
        /// The other name.
        new_name: String,
    },
    /// Deletes a design of the history.
    DeleteDesign {
        /// The name.
        name: String,
    },
    /// Puts the design of the history that was deleted last back.
    PutDesignBack,
    /// Designs for another out-of-balance without changing the project; no value ends the trial.
    Try {
        /// First moment of mass, kg m.
        out_of_balance_kg_m: Option<f64>,
    },
    /// Changes between light and dark.
    ToggleTheme,
    /// Changes between frequencies in Hz and rad/s.
    ToggleFrequency,
    /// Changes between gains in dB and absolute.
    ToggleGain,
    /// Changes between angles in mrad and degrees.
    ToggleAngle,
    /// Makes everything larger.
    Larger,
    /// Makes everything smaller.
    Smaller,
    /// Explains what is under the pointer or has the focus, or the page.
    Help,
    /// Closes the hint on what can be dragged, for good.
    CloseHint,
    /// Opens or closes the command palette.
    Palette,
    /// Lets the plot under the pointer (or the last one) fill its page, or shows all plots again.
    MaximisePlot,
    /// Hides that plot.
    HidePlot,
    /// Shows a hidden plot of the page.
    ShowPlot {
        /// The key of the plot, as in `loop-gain`.
        plot: String,
    },
    /// Gives the plots of the page their usual layout.
    ResetPlots,
    /// Shows the whole content of the plot under the pointer (or of the last one).
    FitPlot,
    /// Sets the second cursor of the plot under the pointer there, from which differences are measured; takes it away if it is set.
    ToggleSecondCursor,
    /// Copies that plot as numbers.
    CopyCsv,
    /// Copies it as a drawing.
    CopySvg,
    /// Copies it as pixels.
    CopyPng,
    /// Writes the HTML report of the verified design.
    WriteReport {
        /// The file.
        path: PathBuf,
    },
    /// Writes that plot to a file; the ending (.svg, .png or .csv) says in which format.
    SavePlot {
        /// The file.
        path: PathBuf,
    },
}

impl Command {
    /// Returns whether the command changes the project; only such commands are in the journal and can be undone.
    pub fn is_edit(&self) -> bool {
        use Command::{Redo, Remove, Replace, Set, SetText, SetWhole, SpliceText, Undo};
        matches!(
            self,
            Set { .. }
                | SetWhole { .. }
                | SetText { .. }
                | Remove { .. }
                | Replace { .. }
                | SpliceText { .. }
                | Undo
                | Redo
        )
    }
}
