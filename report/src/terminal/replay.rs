//! What `counterpoise replay` prints, and what `counterpoise diagnose` prints of the project that it saved: how well a model fits recordings.

use counterpoise_pipeline::results::{RecordingResult, ReplayResult};

use super::add_line;
use crate::wording::recordings::describe_replay_mode;

/// Returns the lines on a replay, with the error of every channel.
pub fn replay_lines(result: &ReplayResult) -> Vec<String> {
    let mut all = Vec::new();
    let lines = &mut all;
    for recording in &result.recordings {
        add_line!(lines, "{}", recording.file);
        add_line!(lines, "  followed {}", describe_replay_mode(recording));
        recording.remarks.iter().for_each(|remark| add_line!(lines, "  {remark}"));
        add_line!(
            lines,
            "  {:<16} {:>12} {:>12} {:>8} {:>10}",
            "channel",
            "RMS error",
            "floor",
            "ratio",
            "VAF %"
        );
        for (name, c) in &recording.channels {
            let ratio = c.residual_over_floor;
            add_line!(
                lines,
                "  {name:<16} {:12.4e} {:12.4e} {ratio:8.2} {:10.4}",
                c.rms_error,
                c.floor,
                c.vaf
            );
        }
    }
    all
}

/// Returns the lines on the replay of a project that was saved; none if nothing was replayed. `label` gives a channel's name in the words of the machine.
pub fn saved_project_lines<'n>(
    replayed: &'n [RecordingResult],
    label: impl Fn(&'n str) -> &'n str,
) -> Vec<String> {
    let mut lines = Vec::new();
    if replayed.is_empty() {
        return lines;
    }
    add_line!(lines, "replay of the project that was saved, over whole recordings:");
    for recording in replayed {
        let channels = recording.channels.iter().map(|(name, c)| {
            format!("{} {:.4e} ({:.2} noise floors)", label(name), c.rms_error, c.residual_over_floor)
        });
        let ratios: Vec<String> = channels.collect();
        add_line!(lines, "  {}: {}", recording.file, ratios.join(", "));
    }
    lines
}
