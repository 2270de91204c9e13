//! How much of the recordings is replayed some thousand times: their first parts, and more of them where these show little of what the whole does.

use counterpoise_models::Parameters;
use counterpoise_pool::Pool;
use counterpoise_recordings::Recording;
use counterpoise_simulate::replay::ReplayLoop;

use crate::fitting::score::assess_recordings;
use crate::recording::remarks::RecordingRemark;
use crate::simulator_access::Assessment;
use crate::simulator_access::objective::{PreparedRecordings, RecordingReplays};
use crate::tolerance::{LATE_MISMATCH, TEXTBOOK_SAMPLES_AT_MOST};

/// Returns how many samples of a machine with textbook values are replayed: twice as many as usual if a recording misses the model much more after
/// its first part, because what the model lacks shows there.
pub(crate) fn textbook_samples(
    base: &Parameters,
    control: &ReplayLoop,
    recordings: &[Recording],
    pool: &dyn Pool,
) -> usize {
    let lengths = |most: usize| {
        let mut shortened = recordings.to_vec();
        shorten(&mut shortened, most, &mut Vec::new());
        shortened
    };
    let (usual, longer) = (lengths(TEXTBOOK_SAMPLES_AT_MOST), lengths(2 * TEXTBOOK_SAMPLES_AT_MOST));
    if longer.iter().zip(&usual).all(|(long, short)| long.len() == short.len()) {
        return TEXTBOOK_SAMPLES_AT_MOST;
    }
    let prepared = PreparedRecordings::new(&longer, base);
    let simulator = RecordingReplays::new(base, control, &prepared).ok();
    let judged = simulator.and_then(|simulator| assess_recordings(&simulator, pool, base));
    let is_late = |(judged, first): (&Assessment, &Recording)| {
        judged.channels.iter().any(|channel| {
            let (first, rest) = channel.residual.split_at(first.len().min(channel.residual.len()));
            mean_square(rest) > LATE_MISMATCH * mean_square(first).max(1.0)
        })
    };
    match judged.is_some_and(|judged| judged.iter().zip(&usual).any(is_late)) {
        true => 2 * TEXTBOOK_SAMPLES_AT_MOST,
        false => TEXTBOOK_SAMPLES_AT_MOST,
    }
}

/// Returns the mean square of some numbers; 0 for none.
fn mean_square(of: &[f64]) -> f64 {
    of.iter().map(|x| x * x).sum::<f64>() / of.len().max(1) as f64
}

/// Shortens recordings to what a diagnosis can replay some thousand times: the first part of each, with an equal share of the
/// samples that the short ones leave.
pub(crate) fn shorten(recordings: &mut [Recording], most: usize, told: &mut Vec<RecordingRemark>) {
    let mut order: Vec<usize> = (0..recordings.len()).collect();
    order.sort_by_key(|&r| recordings[r].len());
    let mut left = most;
    for (k, &r) in order.iter().enumerate() {
        let share = left / (order.len() - k);
        let recording = &mut recordings[r];
        if recording.len() > share {
            let period = recording.sample_period_s;
            told.push(RecordingRemark::Shortened {
                recording: recording.name.clone(),
                used_s: share as f64 * period,
                length_s: recording.len() as f64 * period,
                most_samples: most,
            });
            *recording = recording.part(0..share);
        }
        left -= recording.len();
    }
}
