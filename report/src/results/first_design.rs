//! Why chosen weights are what they are, as a result file has it.

use counterpoise_pipeline::FirstDesignResult;
use counterpoise_pipeline::exchange::SystemResult;
use counterpoise_pipeline::first_design::{LimitRow, RequiredMarginsResult};
use serde::Serialize;

use crate::wording::design_findings::{
    describe_design_finding, describe_limit, describe_unknown, join_limits,
};

/// A first design.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FirstDesignText {
    /// Bandwidth that was reached (lowest frequency at which the loop's gain falls to 1), rad/s.
    pub bandwidth_rad_s: f64,
    /// Bandwidth that was asked for, rad/s.
    pub asked_rad_s: Option<f64>,
    /// The limits of it: what raises the bandwidth most when it alone is lifted, or, if none does, those of which the loop uses up nearly all.
    pub limited_by: String,
    /// Every limit with the highest bandwidth that it alone would allow, and the bandwidth without it.
    pub limits: Vec<LimitRow<&'static str>>,
    /// The margins that the loop had to keep.
    pub required: RequiredMarginsResult,
    /// Sample period of the controller, s.
    pub sample_period_s: f64,
    /// The unknown values that lowered the ceiling.
    pub unknown: Vec<&'static str>,
    /// Gain margin, dB.
    pub gain_margin_db: f64,
    /// Phase margin, degrees.
    pub phase_margin_deg: f64,
    /// Largest sensitivity.
    pub max_sensitivity: f64,
    /// Largest sensitivity with every lightly damped mode off by 15 %.
    pub max_sensitivity_modes_shifted: f64,
    /// The sampled loops that were judged, broken at the control: that of the plant, then those of the plants with shifted modes.
    pub loops: Vec<SystemResult>,
    /// Feedforwards that could not be had, with the reason.
    pub left_out: Vec<String>,
}

impl From<FirstDesignResult> for FirstDesignText {
    fn from(found: FirstDesignResult) -> Self {
        Self {
            bandwidth_rad_s: found.bandwidth_rad_s,
            asked_rad_s: found.asked_rad_s,
            limited_by: join_limits(&found.limited_by),
            limits: found.limits.iter().map(|row| row.name_limit(describe_limit)).collect(),
            required: found.required,
            sample_period_s: found.sample_period_s,
            unknown: found.unknown.iter().map(|fact| describe_unknown(*fact)).collect(),
            gain_margin_db: found.gain_margin_db,
            phase_margin_deg: found.phase_margin_deg,
            max_sensitivity: found.max_sensitivity,
            max_sensitivity_modes_shifted: found.max_sensitivity_modes_shifted,
            loops: found.loops,
            left_out: found.left_out.iter().map(describe_design_finding).collect(),
        }
    }
}
