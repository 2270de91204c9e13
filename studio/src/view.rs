//! What the window shows of it all: neither the project nor a result, and never undone.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use crate::browser::Browser;
use crate::chart::Chart;
use crate::command::{Command, Evidence, Inquiry, Place, Slot};
use crate::live::Live;
use crate::theme::{DARK, LIGHT, Theme};

/// How frequencies are shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FrequencyUnit {
    /// Hz.
    Hertz,
    /// rad/s.
    Radians,
}

/// How gains are shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GainUnit {
    /// dB.
    Decibel,
    /// As they are, by decades.
    Absolute,
}

/// How angles and their rates are shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AngleUnit {
    /// mrad and mrad/s.
    Milliradian,
    /// Degrees and degrees/s.
    Degree,
}

/// Which part of the design the weights are shown of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// The feedback.
    Feedback,
    /// The feedforward from heave.
    Heave,
    /// The feedforward from pitch.
    Pitch,
}

/// A message with its kind.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Notice {
    /// What is said.
    pub text: String,
    /// Whether something went wrong.
    pub tone: Tone,
}

/// The kind of a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tone {
    /// Something was done.
    Plain,
    /// Something went wrong.
    Wrong,
}

/// The state of the window.
pub struct View {
    /// Where the user is.
    pub place: Place,
    /// Colours.
    pub theme: Theme,
    /// Unit of frequencies.
    pub frequency: FrequencyUnit,
    /// Unit of gains.
    pub gain: GainUnit,
    /// Unit of angles.
    pub angle: AngleUnit,
    /// What the verification is looked at by.
    pub evidence: Evidence,
    /// Whose weights are shown.
    pub part: Part,
    /// Designs kept for comparison.
    pub kept: BTreeMap<&'static str, Arc<Live>>,
    /// Out-of-balance that is tried, kg m.
    pub tried_kg_m: Option<f64>,
    /// Number of the last gesture.
    pub gesture: u64,
    /// Whether a handle is being dragged.
    pub dragging: bool,
    /// What is said at the foot of the window.
    pub notice: Option<Notice>,
    /// The list of commands, while it is open: what was typed, and which entry is chosen.
    pub palette: Option<(String, usize)>,
    /// Which recording is shown.
    pub recording: usize,
    /// What of the diagnosis is shown.
    pub inquiry: Inquiry,
    /// Files and folders, while they are looked through.
    pub browser: Option<Browser>,
    /// Where code is exported to, where another folder than the usual one was chosen.
    pub out: Option<PathBuf>,
    /// The plot that was under the pointer last.
    pub chart: Option<Chart>,
    /// Which mode of the mechanism moves.
    pub mode: usize,
    /// Which requirement's figure is shown.
    pub verdict: usize,
    /// The section of parameters that is open.
    pub section: usize,
}

impl Default for View {
    fn default() -> Self {
        Self {
            place: Place::Design,
            theme: DARK,
            frequency: FrequencyUnit::Hertz,
            gain: GainUnit::Decibel,
            angle: AngleUnit::Milliradian,
            evidence: Evidence::Histories,
            part: Part::Feedback,
            kept: BTreeMap::new(),
            tried_kg_m: None,
            gesture: 0,
            dragging: false,
            notice: None,
            palette: None,
            recording: 0,
            inquiry: Inquiry::Signals,
            browser: None,
            out: None,
            chart: None,
            mode: 0,
            verdict: 0,
            section: 0,
        }
    }
}

impl View {
    /// Carries out a command that concerns the view alone; says whether it was one.
    pub fn apply(&mut self, command: &Command) -> bool {
        match command {
            Command::Go { place } => self.place = *place,
            Command::Forget { slot } => {
                self.kept.remove(slot.name());
            }
            Command::Try { out_of_balance_kg_m } => self.tried_kg_m = *out_of_balance_kg_m,
            Command::ToggleTheme => self.theme = if self.theme == DARK { LIGHT } else { DARK },
            Command::ToggleFrequency => {
                self.frequency = match self.frequency {
                    FrequencyUnit::Hertz => FrequencyUnit::Radians,
                    FrequencyUnit::Radians => FrequencyUnit::Hertz,
                }
            }
            Command::ToggleGain => {
                self.gain = match self.gain {
                    GainUnit::Decibel => GainUnit::Absolute,
                    GainUnit::Absolute => GainUnit::Decibel,
                }
            }
            Command::ToggleAngle => {
                self.angle = match self.angle {
                    AngleUnit::Milliradian => AngleUnit::Degree,
                    AngleUnit::Degree => AngleUnit::Milliradian,
                }
            }
            Command::Look { evidence } => {
                (self.place, self.evidence) = (Place::Verify, *evidence);
            }
            Command::Inquire { inquiry } => {
                (self.place, self.inquiry) = (Place::Diagnose, *inquiry);
            }
            Command::Palette => {
                self.palette = if self.palette.is_some() { None } else { Some((String::new(), 0)) }
            }
            _ => return false,
        }
        true
    }

    /// Keeps a design.
    pub fn keep(&mut self, slot: Slot, live: &Arc<Live>) {
        self.kept.insert(slot.name(), Arc::clone(live));
    }

    /// Says something at the foot of the window.
    pub fn say(&mut self, text: impl Into<String>) {
        self.notice = Some(Notice { text: text.into(), tone: Tone::Plain });
    }

    /// Says what went wrong.
    pub fn warn(&mut self, text: impl Into<String>) {
        self.notice = Some(Notice { text: text.into(), tone: Tone::Wrong });
    }

    /// A frequency in the unit that is shown.
    pub fn rate(&self, rate_rad_s: f64) -> f64 {
        match self.frequency {
            FrequencyUnit::Hertz => rate_rad_s / std::f64::consts::TAU,
            FrequencyUnit::Radians => rate_rad_s,
        }
    }

    /// A frequency as shown, in rad/s.
    pub fn rad_s(&self, shown: f64) -> f64 {
        match self.frequency {
            FrequencyUnit::Hertz => shown * std::f64::consts::TAU,
            FrequencyUnit::Radians => shown,
        }
    }

    /// What a rate in rad/s (or an angle in rad) is multiplied by to be shown.
    pub fn angular(&self) -> f64 {
        match self.angle {
            AngleUnit::Milliradian => 1e3,
            AngleUnit::Degree => 1.0_f64.to_degrees(),
        }
    }

    /// A unit of the project's, with radians as they are shown, and what a value in it is multiplied by.
    pub fn shown_unit(&self, unit: &str) -> (String, f64) {
        let radian = match self.angle {
            AngleUnit::Milliradian => "mrad",
            AngleUnit::Degree => "deg",
        };
        match unit {
            "rad" => (radian.to_owned(), self.angular()),
            "rad/s" => (self.angular_rate_unit().to_owned(), self.angular()),
            other => (other.to_owned(), 1.0),
        }
    }

    /// The unit in which rates are shown.
    pub fn angular_rate_unit(&self) -> &'static str {
        match self.angle {
            AngleUnit::Milliradian => "mrad/s",
            AngleUnit::Degree => "deg/s",
        }
    }

    /// The label of a frequency axis.
    pub fn rate_label(&self) -> &'static str {
        match self.frequency {
            FrequencyUnit::Hertz => "frequency, Hz",
            FrequencyUnit::Radians => "frequency, rad/s",
        }
    }

    /// A modulus as shown on an axis.
    pub fn level(&self, modulus: f64) -> f64 {
        match self.gain {
            GainUnit::Decibel => 20.0 * modulus.max(1e-30).log10(),
            GainUnit::Absolute => modulus.max(1e-30),
        }
    }

    /// What stands on an axis of gains, as a modulus.
    pub fn modulus(&self, shown: f64) -> f64 {
        match self.gain {
            GainUnit::Decibel => 10f64.powf(shown / 20.0),
            GainUnit::Absolute => shown,
        }
    }
}
