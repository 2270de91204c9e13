//! The commands that need no argument of the user, with their names and shortcuts.

use std::borrow::Cow;

use super::{BrowsePurpose, Command, DesignSlot, DesignTab, DiagnosisTab, Page, VerificationTab};
use crate::study_inputs::StudyKind;

/// A command as menus and the command palette show it.
#[derive(Debug, Clone)]
pub struct CommandEntry {
    /// Name.
    pub name: Cow<'static, str>,
    /// Shortcut, as `Ctrl+Z`; empty if it has none.
    pub shortcut: &'static str,
    /// The command.
    pub command: Command,
}

fn entry(name: &'static str, shortcut: &'static str, command: Command) -> CommandEntry {
    CommandEntry { name: name.into(), shortcut, command }
}

/// Returns every command that needs no argument, in the order of the command palette.
pub fn list_commands() -> Vec<CommandEntry> {
    [page_commands(), file_commands(), work_commands(), study_commands(), design_commands(), view_commands()]
        .concat()
}

fn page_commands() -> Vec<CommandEntry> {
    let page = |page| Command::Go { page };
    let verification = |tab| Command::ShowVerification { tab };
    let diagnosis = |tab| Command::ShowDiagnosis { tab };
    vec![
        entry("Go to Plant", "Ctrl+1", page(Page::Plant)),
        entry("Go to Reduce", "Ctrl+2", page(Page::Reduce)),
        entry("Go to Design", "Ctrl+3", page(Page::Design)),
        entry("Go to Verify", "Ctrl+4", page(Page::Verify)),
        entry("Go to Diagnose", "Ctrl+5", page(Page::Diagnose)),
        entry("Go to Commission", "Ctrl+6", page(Page::Commission)),
        entry("Go to Text", "Ctrl+7", page(Page::Text)),
        entry("Go to Studies", "Ctrl+8", page(Page::Studies)),
        entry(
            "Show the consequences of the design",
            "",
            Command::ShowDesign { tab: DesignTab::Consequences },
        ),
        entry(
            "Show the loop: Nichols, Nyquist, root locus",
            "",
            Command::ShowDesign { tab: DesignTab::Loop },
        ),
        entry("Show the history of designs", "", Command::ShowDesign { tab: DesignTab::History }),
        entry("Show the time histories", "", verification(VerificationTab::Histories)),
        entry("Show the disturbance rejection", "", verification(VerificationTab::Rejection)),
        entry("Show the analyser's map", "", verification(VerificationTab::Map)),
        entry("Show the robustness", "", verification(VerificationTab::Robustness)),
        entry("Show measured and simulated channels", "", diagnosis(DiagnosisTab::Signals)),
        entry("Show one channel against another", "", diagnosis(DiagnosisTab::CrossPlot)),
        entry("Show the residuals of the model", "", diagnosis(DiagnosisTab::Errors)),
        entry("Show the spectra of channels and residuals", "", diagnosis(DiagnosisTab::Spectra)),
        entry("Show the findings of the diagnosis", "", diagnosis(DiagnosisTab::Findings)),
        entry("Show the localisation map", "", diagnosis(DiagnosisTab::Map)),
        entry("Show the hypotheses of the diagnosis", "", diagnosis(DiagnosisTab::Tried)),
    ]
}

fn file_commands() -> Vec<CommandEntry> {
    let browse = |purpose| Command::Browse { purpose };
    vec![
        entry("Undo", "Ctrl+Z", Command::Undo),
        entry("Redo", "Ctrl+Y", Command::Redo),
        entry("Open or make a project", "Ctrl+O", browse(BrowsePurpose::Project)),
        entry("Save the project", "Ctrl+S", Command::Save),
        entry("Save the project as", "Ctrl+Shift+S", browse(BrowsePurpose::SaveAs)),
        entry("Read the file again", "", Command::Reload),
        entry("Find in the project's text", "", Command::FindText),
        entry("Go to the next error of the project's text", "Shift+F8", Command::NextError),
        entry("Close the project", "Ctrl+W", Command::AskClose),
    ]
}

fn work_commands() -> Vec<CommandEntry> {
    let browse = |purpose| Command::Browse { purpose };
    vec![
        entry("Verify on the full plant", "F5", Command::Verify),
        entry("Measure the frequency responses, amplitude by amplitude", "F7", Command::Measure),
        entry("Run the robustness campaign", "F8", Command::Sweep),
        entry("Stop what is running", "Esc", Command::Cancel),
        entry("Export the verified controller's code", "Ctrl+E", Command::Export),
        entry("Export into another folder", "Ctrl+Shift+E", browse(BrowsePurpose::Export)),
        entry("Write the report", "Ctrl+Shift+R", browse(BrowsePurpose::Report)),
        entry("Add recordings", "Ctrl+R", browse(BrowsePurpose::Recordings)),
        entry("Diagnose the recordings", "F6", Command::Diagnose),
        entry("Accept the diagnosis into the project", "", Command::Accept),
        entry("Read the rounds of the commissioning", "", Command::ReadRounds),
        entry("Run the next round of the commissioning", "F9", Command::RunRound),
        entry("Take the newest model of the rounds into the project", "", Command::AcceptRound),
    ]
}

fn study_commands() -> Vec<CommandEntry> {
    let run = |study: StudyKind| entry(study.name(), "", Command::RunStudy { study });
    let mut all: Vec<CommandEntry> = StudyKind::ALL.into_iter().map(run).collect();
    all.push(entry("Run the study that is shown", "F10", Command::RunShownStudy));
    all
}

fn design_commands() -> Vec<CommandEntry> {
    let [a, b, c] = DesignSlot::ALL;
    vec![
        entry("Keep this design with a name", "Ctrl+D", Command::NameDesign),
        entry("Put the deleted design back", "", Command::PutDesignBack),
        entry("Keep this design as A", "Ctrl+Shift+1", Command::Keep { slot: a }),
        entry("Keep this design as B", "Ctrl+Shift+2", Command::Keep { slot: b }),
        entry("Keep this design as C", "Ctrl+Shift+3", Command::Keep { slot: c }),
        entry("Go back to design A", "", Command::Return { slot: a }),
        entry("Go back to design B", "", Command::Return { slot: b }),
        entry("Go back to design C", "", Command::Return { slot: c }),
        entry("Clear design A", "", Command::Forget { slot: a }),
        entry("Clear design B", "", Command::Forget { slot: b }),
        entry("Clear design C", "", Command::Forget { slot: c }),
        entry("End the trial of another out-of-balance", "", Command::Try { out_of_balance_kg_m: None }),
    ]
}

fn view_commands() -> Vec<CommandEntry> {
    vec![
        entry("Light or dark", "Ctrl+T", Command::ToggleTheme),
        entry("Frequencies in Hz or rad/s", "Ctrl+H", Command::ToggleFrequency),
        entry("Gains in dB or absolute", "Ctrl+B", Command::ToggleGain),
        entry("Angles in mrad or degrees", "Ctrl+G", Command::ToggleAngle),
        entry("Fit the plot", "Ctrl+F", Command::FitPlot),
        entry("Measure differences from the cursor, or no more", "Ctrl+J", Command::ToggleSecondCursor),
        entry("Maximise the plot, or show all again", "Ctrl+M", Command::MaximisePlot),
        entry("Hide the plot", "", Command::HidePlot),
        entry("Usual layout of the plots", "", Command::ResetPlots),
        entry("Copy plot as CSV", "Ctrl+Shift+C", Command::CopyCsv),
        entry("Copy plot as SVG", "", Command::CopySvg),
        entry("Copy plot as PNG", "", Command::CopyPng),
        entry("Save plot as a file", "Ctrl+Shift+G", Command::Browse { purpose: BrowsePurpose::PlotFile }),
        entry("Everything larger", "Ctrl+Plus", Command::Larger),
        entry("Everything smaller", "Ctrl+Minus", Command::Smaller),
        entry("Help on what is under the pointer", "F1", Command::Help),
        entry("All commands", "Ctrl+K", Command::Palette),
    ]
}
