//! The readings of a controller in a recording.

use counterpoise_controller::{READINGS, Readings};
use counterpoise_recordings::{Channel, Recording};

/// The recorded channels behind a controller's readings, in the order of [`counterpoise_controller::READING_NAMES`].
pub(super) const READ: [Channel; READINGS] = [
    Channel::Demand,
    Channel::HubRate,
    Channel::PlatformRate,
    Channel::PlatformAccel,
    Channel::MotorRate,
    Channel::HubPosition,
    Channel::PlatformSurge,
];

/// Returns the recorded readings of every sample; a channel that was not recorded reads 0, and a missing sample repeats the one before.
pub(crate) fn recorded_readings(recording: &Recording) -> Option<Vec<Readings>> {
    let columns = READ.map(|channel| recording.samples(channel));
    columns[0]?;
    columns[1]?;
    let mut last = [0.0; READINGS];
    let mut at = |k: usize| {
        for (value, column) in last.iter_mut().zip(&columns) {
            let recorded = column.and_then(|c| c.get(k)).copied().filter(|v| v.is_finite());
            *value = recorded.unwrap_or(*value);
        }
        Readings::from_array(last)
    };
    Some((0..recording.len()).map(&mut at).collect())
}
