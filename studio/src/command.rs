//! Everything that can be done in the studio, as one closed list: menus, shortcuts, the palette, tests and logs all speak it.

use std::borrow::Cow;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};

/// A place of the road.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Place {
    /// The mechanism.
    Plant,
    /// The order of its model.
    Reduce,
    /// Weights and what follows from them.
    Design,
    /// Verdicts on the full plant, and export.
    Verify,
    /// Recordings against the model.
    Diagnose,
}

/// What the verification is looked at by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Evidence {
    /// Runs on the full plant over time.
    Histories,
    /// What is left of the platform's motion over frequency.
    Rejection,
    /// Frequency responses as an analyser measures them, amplitude by amplitude.
    Map,
    /// The requirements over many mechanisms.
    Robustness,
}

/// What of a diagnosis is looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Inquiry {
    /// Measured and simulated channels.
    Signals,
    /// Simulated less measured.
    Errors,
    /// What was found, and how the fit improved.
    Findings,
    /// Which balance departs, and with which variable.
    Map,
    /// Everything that was tried.
    Tried,
}

/// One of the designs that are kept for comparison.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Slot {
    /// The first.
    A,
    /// The second.
    B,
    /// The third.
    C,
}

/// What files and folders are looked through for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Purpose {
    /// A project to open, or a place for a new one.
    Project,
    /// A place for the project under another name.
    SaveAs,
    /// Recordings to add.
    Recordings,
    /// A folder for the exported code.
    Export,
}

/// What can be done.
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
        /// The gesture that it belongs to.
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
    /// Takes a key out of the project: it then has its usual value.
    Remove {
        /// Path of the key.
        path: String,
    },
    /// Replaces the whole text of the project.
    Replace {
        /// The text.
        text: String,
    },
    /// Takes back the last change of the project.
    Undo,
    /// Makes the change again that was taken back.
    Redo,
    /// Opens a project file, or a folder with a project.toml.
    Open {
        /// The path.
        path: PathBuf,
    },
    /// Makes a folder with a complete project file to start from, and opens it.
    New {
        /// The folder; it must not hold a project.
        folder: PathBuf,
    },
    /// Looks through files and folders.
    Browse {
        /// For what.
        purpose: Purpose,
    },
    /// Leaves the project; what was not saved comes back when it is opened again.
    Close,
    /// Writes the project to its file.
    Save,
    /// Writes the project to another file, with the files that it names, and goes on there.
    SaveAs {
        /// The file, or a folder for a project.toml.
        path: PathBuf,
    },
    /// Reads the project's file again and leaves what was not saved.
    Reload,
    /// Verifies the design on the full plant.
    Verify,
    /// Measures the frequency responses of the full plant with the controller, amplitude by amplitude.
    Measure,
    /// Tries the controller on many mechanisms that differ as the project says.
    Sweep,
    /// Looks at one kind of the verification's evidence.
    Look {
        /// Which.
        evidence: Evidence,
    },
    /// Stops what is running.
    Cancel,
    /// Writes the verified controller's code into the folder that was chosen last; `out` beside the project where none was.
    Export,
    /// Writes it into another folder.
    ExportTo {
        /// The folder; it is made where there is none.
        folder: PathBuf,
    },
    /// Drops recordings onto the diagnosis.
    Recordings {
        /// Files.
        paths: Vec<PathBuf>,
    },
    /// Looks at one part of the diagnosis.
    Inquire {
        /// Which.
        inquiry: Inquiry,
    },
    /// Diagnoses the machine from the recordings.
    Diagnose,
    /// Takes the improved mechanism of the diagnosis into the project.
    Accept,
    /// Goes to a place.
    Go {
        /// The place.
        place: Place,
    },
    /// Keeps the design as it stands for comparison.
    Keep {
        /// Where.
        slot: Slot,
    },
    /// Goes back to a kept design: its weights and its order are those of the project again.
    Return {
        /// Which.
        slot: Slot,
    },
    /// Forgets a kept design.
    Forget {
        /// Which.
        slot: Slot,
    },
    /// Tries the design at another out-of-balance, kg m, without changing the project; nothing ends the trial.
    Try {
        /// First moment of mass, kg m.
        out_of_balance_kg_m: Option<f64>,
    },
    /// Light or dark.
    ToggleTheme,
    /// Frequencies in Hz or rad/s.
    ToggleFrequency,
    /// Gains in dB or absolute.
    ToggleGain,
    /// Angles and their rates in thousandths of a radian or degrees.
    ToggleAngle,
    /// Everything larger.
    Larger,
    /// Everything smaller.
    Smaller,
    /// Opens or closes the list of commands.
    Palette,
    /// Copies the plot under the pointer (or the last one) as numbers.
    CopyCsv,
    /// Copies it as a drawing.
    CopySvg,
    /// Copies it as pixels.
    CopyPng,
}

impl Command {
    /// Whether it changes the project; only such commands are journalled and undone.
    pub fn edits(&self) -> bool {
        use Command::{Redo, Remove, Replace, Set, SetText, SetWhole, Undo};
        matches!(
            self,
            Set { .. } | SetWhole { .. } | SetText { .. } | Remove { .. } | Replace { .. } | Undo | Redo
        )
    }
}

/// A command as the palette shows it.
#[derive(Debug, Clone)]
pub struct Entry {
    /// What it says.
    pub name: Cow<'static, str>,
    /// Its shortcut, as `Ctrl+Z`; empty where it has none.
    pub shortcut: &'static str,
    /// What it does.
    pub command: Command,
}

/// Every command that needs no further word, in the order of the palette.
pub fn entries() -> Vec<Entry> {
    let entry = |name: &'static str, shortcut, command| Entry { name: name.into(), shortcut, command };
    let go = |place| Command::Go { place };
    let look = |evidence| Command::Look { evidence };
    let inquire = |inquiry| Command::Inquire { inquiry };
    let browse = |purpose| Command::Browse { purpose };
    vec![
        entry("Go to Plant", "Ctrl+1", go(Place::Plant)),
        entry("Go to Reduce", "Ctrl+2", go(Place::Reduce)),
        entry("Go to Design", "Ctrl+3", go(Place::Design)),
        entry("Go to Verify", "Ctrl+4", go(Place::Verify)),
        entry("Go to Diagnose", "Ctrl+5", go(Place::Diagnose)),
        entry("Undo", "Ctrl+Z", Command::Undo),
        entry("Redo", "Ctrl+Y", Command::Redo),
        entry("Open or make a project", "Ctrl+O", browse(Purpose::Project)),
        entry("Save the project", "Ctrl+S", Command::Save),
        entry("Save the project as", "Ctrl+Shift+S", browse(Purpose::SaveAs)),
        entry("Read the file again, leaving what was not saved", "", Command::Reload),
        entry("Close the project", "Ctrl+W", Command::Close),
        entry("Verify on the full plant", "F5", Command::Verify),
        entry("Look at the time histories", "", look(Evidence::Histories)),
        entry("Look at the rejection of disturbances", "", look(Evidence::Rejection)),
        entry("Look at the analyser's map", "", look(Evidence::Map)),
        entry("Look at the robustness", "", look(Evidence::Robustness)),
        entry("Measure the frequency responses, amplitude by amplitude", "F7", Command::Measure),
        entry("Try the controller on many mechanisms", "F8", Command::Sweep),
        entry("Stop what is running", "Esc", Command::Cancel),
        entry("Export the verified controller's code", "Ctrl+E", Command::Export),
        entry("Export into another folder", "Ctrl+Shift+E", browse(Purpose::Export)),
        entry("Add recordings", "Ctrl+R", browse(Purpose::Recordings)),
        entry("Look at measured and simulated channels", "", inquire(Inquiry::Signals)),
        entry("Look at the errors of the model", "", inquire(Inquiry::Errors)),
        entry("Look at what the diagnosis found", "", inquire(Inquiry::Findings)),
        entry("Look at where and when the model departs", "", inquire(Inquiry::Map)),
        entry("Look at what the diagnosis tried", "", inquire(Inquiry::Tried)),
        entry("Diagnose the recordings", "F6", Command::Diagnose),
        entry("Accept the diagnosis into the project", "", Command::Accept),
        entry("Keep this design as A", "Ctrl+Shift+1", Command::Keep { slot: Slot::A }),
        entry("Keep this design as B", "Ctrl+Shift+2", Command::Keep { slot: Slot::B }),
        entry("Keep this design as C", "Ctrl+Shift+3", Command::Keep { slot: Slot::C }),
        entry("Go back to design A", "", Command::Return { slot: Slot::A }),
        entry("Go back to design B", "", Command::Return { slot: Slot::B }),
        entry("Go back to design C", "", Command::Return { slot: Slot::C }),
        entry("Forget design A", "", Command::Forget { slot: Slot::A }),
        entry("Forget design B", "", Command::Forget { slot: Slot::B }),
        entry("Forget design C", "", Command::Forget { slot: Slot::C }),
        entry("End the trial of another out-of-balance", "", Command::Try { out_of_balance_kg_m: None }),
        entry("Light or dark", "Ctrl+T", Command::ToggleTheme),
        entry("Frequencies in Hz or rad/s", "Ctrl+H", Command::ToggleFrequency),
        entry("Gains in dB or absolute", "Ctrl+B", Command::ToggleGain),
        entry("Angles in mrad or degrees", "Ctrl+G", Command::ToggleAngle),
        entry("Copy plot as CSV", "Ctrl+Shift+C", Command::CopyCsv),
        entry("Copy plot as SVG", "", Command::CopySvg),
        entry("Copy plot as PNG", "", Command::CopyPng),
        entry("Everything larger", "Ctrl+Plus", Command::Larger),
        entry("Everything smaller", "Ctrl+Minus", Command::Smaller),
        entry("All commands", "Ctrl+K", Command::Palette),
    ]
}

impl Place {
    /// All places, along the road.
    pub const ALL: [Place; 5] = [Place::Plant, Place::Reduce, Place::Design, Place::Verify, Place::Diagnose];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Place::Plant => "Plant",
            Place::Reduce => "Reduce",
            Place::Design => "Design",
            Place::Verify => "Verify",
            Place::Diagnose => "Diagnose",
        }
    }
}

impl Evidence {
    /// All kinds.
    pub const ALL: [Evidence; 4] =
        [Evidence::Histories, Evidence::Rejection, Evidence::Map, Evidence::Robustness];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Evidence::Histories => "Histories",
            Evidence::Rejection => "Rejection",
            Evidence::Map => "Analyser",
            Evidence::Robustness => "Robustness",
        }
    }
}

impl Inquiry {
    /// All parts.
    pub const ALL: [Inquiry; 5] =
        [Inquiry::Signals, Inquiry::Errors, Inquiry::Findings, Inquiry::Map, Inquiry::Tried];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Inquiry::Signals => "Signals",
            Inquiry::Errors => "Errors",
            Inquiry::Findings => "Findings",
            Inquiry::Map => "Where and when",
            Inquiry::Tried => "Tried",
        }
    }
}

impl Slot {
    /// All slots.
    pub const ALL: [Slot; 3] = [Slot::A, Slot::B, Slot::C];

    /// Its letter.
    pub fn name(self) -> &'static str {
        match self {
            Slot::A => "A",
            Slot::B => "B",
            Slot::C => "C",
        }
    }
}
