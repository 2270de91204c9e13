//! The units in which the window shows frequencies, gains and angles.

use crate::tolerance::SMALLEST_MODULUS;
use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

/// The unit of frequencies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FrequencyUnit {
    /// Hz.
    #[default]
    Hertz,
    /// rad/s.
    RadPerSecond,
}

/// The unit of gains.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum GainUnit {
    /// dB.
    #[default]
    Decibel,
    /// Absolute, on a logarithmic axis.
    Absolute,
}

/// The unit of angles and their rates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum AngleUnit {
    /// mrad and mrad/s.
    #[default]
    Milliradian,
    /// Degrees and degrees per second.
    Degree,
}

/// The units that the user has chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct DisplayUnits {
    /// Frequencies.
    pub frequency: FrequencyUnit,
    /// Gains.
    pub gain: GainUnit,
    /// Angles.
    pub angle: AngleUnit,
}

/// A unit for display, with the factor from SI to it.
#[derive(Debug, Clone, PartialEq)]
pub struct DisplayUnit {
    /// The unit as it is written.
    pub name: String,
    /// Factor of a value in SI.
    pub factor: f64,
}

impl DisplayUnits {
    /// Changes between Hz and rad/s.
    pub fn toggle_frequency(&mut self) {
        self.frequency = match self.frequency {
            FrequencyUnit::Hertz => FrequencyUnit::RadPerSecond,
            FrequencyUnit::RadPerSecond => FrequencyUnit::Hertz,
        };
    }

    /// Changes between dB and absolute.
    pub fn toggle_gain(&mut self) {
        self.gain = match self.gain {
            GainUnit::Decibel => GainUnit::Absolute,
            GainUnit::Absolute => GainUnit::Decibel,
        };
    }

    /// Changes between mrad and degrees.
    pub fn toggle_angle(&mut self) {
        self.angle = match self.angle {
            AngleUnit::Milliradian => AngleUnit::Degree,
            AngleUnit::Degree => AngleUnit::Milliradian,
        };
    }

    /// Returns a frequency in rad/s as it is shown.
    pub fn display_frequency(&self, rate_rad_s: f64) -> f64 {
        match self.frequency {
            FrequencyUnit::Hertz => rate_rad_s / TAU,
            FrequencyUnit::RadPerSecond => rate_rad_s,
        }
    }

    /// Returns a shown frequency in rad/s.
    pub fn frequency_from_display(&self, shown: f64) -> f64 {
        match self.frequency {
            FrequencyUnit::Hertz => shown * TAU,
            FrequencyUnit::RadPerSecond => shown,
        }
    }

    /// Returns the label of a frequency axis.
    pub fn frequency_label(&self) -> &'static str {
        match self.frequency {
            FrequencyUnit::Hertz => "frequency, Hz",
            FrequencyUnit::RadPerSecond => "frequency, rad/s",
        }
    }

    /// Returns the unit of a frequency axis.
    pub fn frequency_unit(&self) -> &'static str {
        match self.frequency {
            FrequencyUnit::Hertz => "Hz",
            FrequencyUnit::RadPerSecond => "rad/s",
        }
    }

    /// Returns a modulus as it stands on a gain axis.
    pub fn display_gain(&self, modulus: f64) -> f64 {
        match self.gain {
            GainUnit::Decibel => 20.0 * modulus.max(SMALLEST_MODULUS).log10(),
            GainUnit::Absolute => modulus.max(SMALLEST_MODULUS),
        }
    }

    /// Returns the modulus of a value on a gain axis.
    pub fn gain_from_display(&self, shown: f64) -> f64 {
        match self.gain {
            GainUnit::Decibel => 10f64.powf(shown / 20.0),
            GainUnit::Absolute => shown,
        }
    }

    /// Returns what a rate in rad/s (or an angle in rad) is multiplied by to be shown.
    pub fn angle_factor(&self) -> f64 {
        match self.angle {
            AngleUnit::Milliradian => 1e3,
            AngleUnit::Degree => 1.0_f64.to_degrees(),
        }
    }

    /// Returns the unit of angles.
    pub fn angle_unit(&self) -> &'static str {
        match self.angle {
            AngleUnit::Milliradian => "mrad",
            AngleUnit::Degree => "deg",
        }
    }

    /// Returns the unit of angular rates.
    pub fn angular_rate_unit(&self) -> &'static str {
        match self.angle {
            AngleUnit::Milliradian => "mrad/s",
            AngleUnit::Degree => "deg/s",
        }
    }

    /// Returns how values in a unit of the project are shown: radians in the chosen unit, everything else as it is.
    pub fn display_unit(&self, unit: &str) -> DisplayUnit {
        match unit {
            "rad" => DisplayUnit { name: self.angle_unit().to_owned(), factor: self.angle_factor() },
            "rad/s" => DisplayUnit { name: self.angular_rate_unit().to_owned(), factor: self.angle_factor() },
            other => DisplayUnit { name: other.to_owned(), factor: 1.0 },
        }
    }
}
