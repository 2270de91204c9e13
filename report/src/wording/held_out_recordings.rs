//! Held-out recordings before and after, as plain data and in one sentence.

use std::collections::BTreeMap;

use counterpoise_pipeline::recordings::HeldOutRecording;
use counterpoise_pipeline::recordings::held_out_recordings::{HeldOutComparison, HeldOutFit, HeldOutOutcome};
use serde::Serialize;

use super::recordings::describe_column_remark;

/// One held-out recording.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HeldOutText {
    /// Name of the recording.
    pub file: String,
    /// Channels.
    pub channels: BTreeMap<&'static str, HeldOutChannel>,
    /// Length of the windows over which it was replayed, s; absent from start to end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub window_s: Option<f64>,
    /// Share of the residual's power that the improved model removes, mean over the channels that were above their noise floor.
    pub power_removed: f64,
    /// The improvement of the fit by the improved model, and what was found about the recording.
    pub remarks: Vec<String>,
}

/// One channel of a held-out recording.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct HeldOutChannel {
    /// Noise floor, in the channel's unit.
    pub floor: f64,
    /// RMS of the residual of the model as it was.
    pub before: f64,
    /// RMS of the residual of the improved model.
    pub after: f64,
    /// The same over the noise floor; not part of the JSON, whose reader divides.
    #[serde(skip)]
    pub after_over_floor: f64,
}

/// Describes held-out recordings.
pub fn describe_held_out(recordings: &[HeldOutRecording]) -> Vec<HeldOutText> {
    recordings.iter().map(describe).collect()
}

fn describe(recording: &HeldOutRecording) -> HeldOutText {
    let channel = |fit: HeldOutFit| {
        let [_, after_over_floor] = fit.residuals_over_floor();
        (
            fit.channel.name(),
            HeldOutChannel { floor: fit.floor, before: fit.before, after: fit.after, after_over_floor },
        )
    };
    let comparison = recording.comparison();
    let remarks = recording.remarks.iter().map(describe_column_remark);
    HeldOutText {
        file: recording.file.clone(),
        channels: recording.judged_channels().into_iter().map(channel).collect(),
        window_s: recording.window_s,
        power_removed: comparison.power_removed,
        remarks: std::iter::once(describe_comparison(&comparison)).chain(remarks).collect(),
    }
}

fn describe_comparison(comparison: &HeldOutComparison) -> String {
    let HeldOutComparison { before, after, power_removed, outcome } = comparison;
    match outcome {
        HeldOutOutcome::ExplainedBefore => format!(
            "the model as it was already explains it: {before:.2} noise floors before, {after:.2} after"
        ),
        HeldOutOutcome::Improved => format!(
            "the fit improves: from {before:.2} to {after:.2} noise floors in the worst channel, {:.0} % of the residual's power removed",
            100.0 * power_removed
        ),
        HeldOutOutcome::NotImproved => {
            format!("the fit does not improve: {before:.2} noise floors before, {after:.2} after")
        }
    }
}
