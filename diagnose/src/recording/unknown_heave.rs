//! Recordings of a moving platform without its acceleration.

use crate::tolerance::recording::PLATFORM_MOVES_RAD_S;
use counterpoise_recordings::{Channel, Recording};

use crate::recording::remarks::{HeaveTreatment, RecordingRemark};
use crate::recording::series::rms;

/// Leaves out the recordings in which the platform moves and its heave was not recorded: an out-of-balance mechanism responds to
/// the heave, and an effect of that size would be found. If that holds for all recordings, all are kept. Returns the recordings and
/// the remarks on them.
pub(crate) fn drop_unknown_heave(recordings: Vec<Recording>) -> (Vec<Recording>, Vec<RecordingRemark>) {
    let all = recordings.iter().all(is_unknown);
    let treatment = if all { HeaveTreatment::TakenAsNone } else { HeaveTreatment::LeftOut };
    let remark = |r: &Recording| RecordingRemark::UnknownHeave { recording: r.name.clone(), treatment };
    let remarks = recordings.iter().filter(|r| is_unknown(r)).map(remark).collect();
    let kept = recordings.into_iter().filter(|r| all || !is_unknown(r)).collect();
    (kept, remarks)
}

fn is_unknown(recording: &Recording) -> bool {
    let rate = recording.samples(Channel::PlatformRate).unwrap_or_default().iter().copied();
    let rate: Vec<f64> = rate.filter(|w| w.is_finite()).collect();
    !recording.has(Channel::PlatformAccel) && rms(&rate) > PLATFORM_MOVES_RAD_S
}

#[cfg(test)]
mod tests {
    use super::*;

    fn recording(name: &str, rate: f64, heave: Option<f64>) -> Recording {
        let rate = vec![rate, -rate, rate, f64::NAN];
        let recording = Recording::new(name, 1e-3).with(Channel::PlatformRate, rate);
        match heave {
            Some(heave) => recording.with(Channel::PlatformAccel, vec![heave; 4]),
            None => recording,
        }
    }

    #[test]
    fn only_a_moving_platform_without_acceleration_is_left_out() {
        let road = recording("road", 0.1, None);
        let (kept, remarks) = drop_unknown_heave(vec![
            recording("steps", 1e-4, None),
            road.clone(),
            recording("track", 0.1, Some(0.3)),
        ]);
        let names: Vec<&str> = kept.iter().map(|r| r.name.as_str()).collect();
        assert_eq!(names, ["steps", "track"]);
        assert_eq!(remarks.len(), 1);
        let treatment = HeaveTreatment::LeftOut;
        assert_eq!(remarks[0], RecordingRemark::UnknownHeave { recording: "road".to_owned(), treatment });
        let (kept, remarks) = drop_unknown_heave(vec![road]);
        assert_eq!(kept.len(), 1);
        assert!(matches!(
            remarks[0],
            RecordingRemark::UnknownHeave { treatment: HeaveTreatment::TakenAsNone, .. }
        ));
    }
}
