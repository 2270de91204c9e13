//! The choices of commands: pages, tabs, slots and purposes.

use serde::{Deserialize, Serialize};

/// A page of the window.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Page {
    /// The mechanism.
    Plant,
    /// The order of its model.
    Reduce,
    /// Weights and their consequences.
    Design,
    /// Verdicts on the full plant, and export.
    Verify,
    /// Recordings against the model.
    Diagnose,
    /// Rounds of design, experiment and redesign on a machine.
    Commission,
    /// Studies of the project: searches, comparisons, identification, experiments.
    Studies,
    /// The project file as text, with its errors in place.
    Text,
}

/// A tab of the page Design.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DesignTab {
    /// The weights, and the consequences of a design over time and frequency.
    Consequences,
    /// The loop in the complex plane: phase, Nichols, Nyquist, root locus, and the responses of the closed loop.
    Loop,
    /// The history of designs, each with its name.
    History,
}

/// A tab of the page Verify.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum VerificationTab {
    /// Runs on the full plant over time.
    Histories,
    /// Disturbance rejection over frequency.
    Rejection,
    /// Frequency responses as an analyser measures them, amplitude by amplitude.
    Map,
    /// The requirements over many mechanisms.
    Robustness,
}

/// A tab of the page Diagnose.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DiagnosisTab {
    /// Measured and simulated channels.
    Signals,
    /// One channel against another.
    CrossPlot,
    /// Residuals.
    Errors,
    /// Spectra of the channels and of their residuals.
    Spectra,
    /// The findings, and how the fit improved.
    Findings,
    /// The localisation map.
    Map,
    /// All hypotheses that were fitted.
    Tried,
}

/// A slot for a design that is kept for comparison.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum DesignSlot {
    /// The first.
    A,
    /// The second.
    B,
    /// The third.
    C,
}

/// Kind of file or folder that the user is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BrowsePurpose {
    /// A project to open, or a place for a new one.
    Project,
    /// A place for the project under another name.
    SaveAs,
    /// Recordings to add.
    Recordings,
    /// A folder for the exported code.
    Export,
    /// A file for the plot.
    PlotFile,
    /// A file for the report.
    Report,
}

impl Page {
    /// All pages, in the order of the work.
    pub const ALL: [Page; 8] = [
        Page::Plant,
        Page::Reduce,
        Page::Design,
        Page::Verify,
        Page::Diagnose,
        Page::Commission,
        Page::Text,
        Page::Studies,
    ];

    /// Returns the page's name.
    pub fn name(self) -> &'static str {
        match self {
            Page::Plant => "Plant",
            Page::Reduce => "Reduce",
            Page::Design => "Design",
            Page::Verify => "Verify",
            Page::Diagnose => "Diagnose",
            Page::Commission => "Commission",
            Page::Studies => "Studies",
            Page::Text => "Text",
        }
    }
}

impl DesignTab {
    /// All tabs.
    pub const ALL: [DesignTab; 3] = [DesignTab::Consequences, DesignTab::Loop, DesignTab::History];

    /// Returns the tab's name.
    pub fn name(self) -> &'static str {
        match self {
            DesignTab::Consequences => "Consequences",
            DesignTab::Loop => "Loop",
            DesignTab::History => "History",
        }
    }
}

impl VerificationTab {
    /// All tabs.
    pub const ALL: [VerificationTab; 4] = [
        VerificationTab::Histories,
        VerificationTab::Rejection,
        VerificationTab::Map,
        VerificationTab::Robustness,
    ];

    /// Returns the tab's name.
    pub fn name(self) -> &'static str {
        match self {
            VerificationTab::Histories => "Histories",
            VerificationTab::Rejection => "Rejection",
            VerificationTab::Map => "Analyser",
            VerificationTab::Robustness => "Robustness",
        }
    }
}

impl DiagnosisTab {
    /// All tabs.
    pub const ALL: [DiagnosisTab; 7] = [
        DiagnosisTab::Signals,
        DiagnosisTab::CrossPlot,
        DiagnosisTab::Errors,
        DiagnosisTab::Spectra,
        DiagnosisTab::Findings,
        DiagnosisTab::Map,
        DiagnosisTab::Tried,
    ];

    /// Returns the tab's name.
    pub fn name(self) -> &'static str {
        match self {
            DiagnosisTab::Signals => "Signals",
            DiagnosisTab::CrossPlot => "X-Y",
            DiagnosisTab::Errors => "Residuals",
            DiagnosisTab::Spectra => "Spectra",
            DiagnosisTab::Findings => "Findings",
            DiagnosisTab::Map => "Localisation",
            DiagnosisTab::Tried => "Hypotheses",
        }
    }
}

impl DesignSlot {
    /// All slots.
    pub const ALL: [DesignSlot; 3] = [DesignSlot::A, DesignSlot::B, DesignSlot::C];

    /// Returns the slot's letter.
    pub fn name(self) -> &'static str {
        match self {
            DesignSlot::A => "A",
            DesignSlot::B => "B",
            DesignSlot::C => "C",
        }
    }
}
