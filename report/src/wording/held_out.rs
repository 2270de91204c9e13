//! Held-out recordings before and after, as plain data and in one sentence.

use std::collections::BTreeMap;

use counterpoise_pipeline::recordings::HeldOutRecording;
use counterpoise_pipeline::recordings::held_out::HeldOutFit;
use serde::Serialize;

use super::recordings::describe_column_remark;
use crate::tolerance::ABOVE_FLOOR;

/// One held-out recording.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HeldOutText {
    /// Name of the recording.
    pub file: String,
    /// Its channels.
    pub channels: BTreeMap<&'static str, HeldOutChannel>,
    /// Length of the windows over which it was replayed, s; absent from start to end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub window_s: Option<f64>,
    /// Share of the residual's power that the improved model removes, mean over the channels that were above their noise floor.
    pub power_removed: f64,
    /// Whether and how much the improved model fits better, and what was found about the recording.
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
}

/// Describes held-out recordings.
pub fn describe_held_out(recordings: &[HeldOutRecording]) -> Vec<HeldOutText> {
    recordings.iter().map(describe).collect()
}

fn describe(recording: &HeldOutRecording) -> HeldOutText {
    let channel = |fit: &HeldOutFit| {
        (fit.channel, HeldOutChannel { floor: fit.floor, before: fit.before, after: fit.after })
    };
    // the platform's channels drive the model: they are the same in every replay
    let compared = recording.channels.iter().filter(|fit| !fit.channel.starts_with("platform"));
    let channels: BTreeMap<_, _> = compared.map(channel).collect();
    let worst =
        |of: fn(&HeldOutChannel) -> f64| channels.values().map(|c| of(c) / c.floor).fold(0.0, f64::max);
    let [before, after] = [worst(|c| c.before), worst(|c| c.after)];
    let removed: Vec<f64> = channels
        .values()
        .filter(|c| c.before > ABOVE_FLOOR * c.floor)
        .map(|c| 1.0 - (c.after / c.before).powi(2))
        .collect();
    let power_removed =
        if removed.is_empty() { 0.0 } else { removed.iter().sum::<f64>() / removed.len() as f64 };
    let verdict = match (removed.is_empty(), after < before) {
        (true, _) => format!(
            "the model as it was already explains it: {before:.2} noise floors before, {after:.2} after"
        ),
        (_, true) => format!(
            "the fit improves: from {before:.2} to {after:.2} noise floors in the worst channel, {:.0} % of the residual's power removed",
            100.0 * power_removed
        ),
        (_, false) => format!("the fit does not improve: {before:.2} noise floors before, {after:.2} after"),
    };
    let remarks =
        std::iter::once(verdict).chain(recording.remarks.iter().map(describe_column_remark)).collect();
    HeldOutText {
        file: recording.file.clone(),
        channels,
        window_s: recording.window_s,
        power_removed,
        remarks,
    }
}
