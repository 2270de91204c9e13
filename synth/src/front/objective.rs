//! The objectives of a front: figures of the sampled loop that each design trades against the others.

use crate::LoopMeasures;
use crate::tolerance::{LARGEST_MARGIN_DB, LARGEST_MARGIN_DEG, LARGEST_MARGIN_S, LEAST_FIGURE};

/// A figure of the loop that a front makes small, or large if it is a margin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FrontObjective {
    /// What the disturbance leaves of what the loop controls, RMS.
    Residual,
    /// RMS control under the disturbance.
    Effort,
    /// RMS control for readings with noise of unit RMS.
    NoiseGain,
    /// Largest |S|.
    MaxSensitivity,
    /// Largest |T|.
    MaxComplementary,
    /// Largest |KS|.
    ControlPeak,
    /// Gain margin, dB.
    GainMargin,
    /// Phase margin, degrees.
    PhaseMargin,
    /// Delay margin, s.
    DelayMargin,
}

impl FrontObjective {
    /// Every objective with its key in a project file and on the command line.
    pub const NAMES: &'static [(&'static str, Self)] = &[
        ("residual", Self::Residual),
        ("effort", Self::Effort),
        ("noise-gain", Self::NoiseGain),
        ("max-sensitivity", Self::MaxSensitivity),
        ("max-complementary", Self::MaxComplementary),
        ("control-peak", Self::ControlPeak),
        ("gain-margin", Self::GainMargin),
        ("phase-margin", Self::PhaseMargin),
        ("delay-margin", Self::DelayMargin),
    ];

    /// Returns the key of the objective.
    pub fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(_, each)| *each == self).map_or("", |(name, _)| name)
    }

    /// Returns whether more of the figure is better.
    pub fn is_margin(self) -> bool {
        matches!(self, Self::GainMargin | Self::PhaseMargin | Self::DelayMargin)
    }

    /// Returns the figure of a loop.
    pub fn figure(self, found: &LoopMeasures) -> f64 {
        match self {
            Self::Residual => found.residual_rad_s,
            Self::Effort => found.effort_v,
            Self::NoiseGain => found.noise_gain,
            Self::MaxSensitivity => found.max_sensitivity,
            Self::MaxComplementary => found.max_complementary,
            Self::ControlPeak => found.control_peak,
            Self::GainMargin => found.gain_margin_db,
            Self::PhaseMargin => found.phase_margin_deg,
            Self::DelayMargin => found.delay_margin_s,
        }
    }

    /// Returns the figure of the worst of several loops; NaN without any.
    pub fn worst_figure(self, found: &[LoopMeasures]) -> f64 {
        let all = found.iter().map(|each| self.figure(each));
        if self.is_margin() { all.fold(f64::NAN, f64::min) } else { all.fold(f64::NAN, f64::max) }
    }

    /// Returns what the front makes least: the logarithm of a figure, or a margin with its sign turned. A margin beyond every use counts as
    /// the largest one that is told apart, so that an infinite margin does not hide the other objectives.
    pub fn cost(self, figure: f64) -> f64 {
        match self {
            Self::GainMargin => -figure.min(LARGEST_MARGIN_DB),
            Self::PhaseMargin => -figure.min(LARGEST_MARGIN_DEG),
            Self::DelayMargin => -figure.min(LARGEST_MARGIN_S),
            _ => figure.max(LEAST_FIGURE).ln(),
        }
    }
}
