//! Readings beyond the range of the converter that they passed, as the project describes it.

use counterpoise_models::{CONVERTER_RANGE_V, FeedbackSignal, Parameters, Sensor};
use counterpoise_recordings::{Channel, Recording};
use counterpoise_simulate::replay::sensor_of;

use super::column_remarks::BeyondRange;
use crate::tolerance::{CONVERTER_RANGE_MARGIN, IMPOSSIBLE_READING};

/// Makes impossible readings of a recording missing ones, and returns what was found, by channel.
pub(super) fn remove_impossible(
    plant: &Parameters,
    recording: &mut Recording,
) -> Vec<(Channel, BeyondRange)> {
    let with_limit = Channel::ALL.into_iter().filter_map(|channel| Some((channel, limit(plant, channel)?)));
    let one = |(channel, limit): (Channel, f64)| {
        let found = remove_values_beyond(recording.samples_mut(channel)?, limit)?;
        Some((channel, found))
    };
    with_limit.filter_map(one).collect()
}

fn remove_values_beyond(values: &mut [f64], limit: f64) -> Option<BeyondRange> {
    let is_beyond = |value: &f64| value.abs() > (1.0 + CONVERTER_RANGE_MARGIN) * limit;
    let first = values.iter().position(is_beyond)?;
    let samples = values.iter().filter(|value| is_beyond(value)).count();
    let value = values[first];
    let mut missing = 0;
    for value in values.iter_mut().filter(|value| value.abs() > IMPOSSIBLE_READING * limit) {
        *value = f64::NAN;
        missing += 1;
    }
    Some(BeyondRange { samples, missing, first_row: first + 1, value, limit })
}

/// Returns the largest reading that the converter of a channel gives, in the channel's unit; `None` if the project describes none.
fn limit(plant: &Parameters, channel: Channel) -> Option<f64> {
    let sensor = match channel {
        Channel::Control => return (plant.interface.output_bits > 0).then_some(CONVERTER_RANGE_V),
        Channel::Demand | Channel::HubRate if plant.sensors.measured != FeedbackSignal::HubRate => {
            return None;
        }
        Channel::Demand => sensor_of(plant, Channel::HubRate)?,
        read => sensor_of(plant, read)?,
    };
    analogue(sensor).filter(|_| plant.interface.input_bits > 0)
}

/// Returns the range of a sensor's reading; `None` if it passes no analogue converter.
fn analogue(sensor: &Sensor) -> Option<f64> {
    let is_analogue = sensor.scale_v_unit != 0.0 && sensor.resolution == 0.0;
    is_analogue.then(|| CONVERTER_RANGE_V / sensor.scale_v_unit.abs())
}

#[cfg(test)]
mod tests {
    use super::*;
    use counterpoise_models::reference;

    #[test]
    fn readings_beyond_the_converter_are_counted_and_impossible_ones_removed() {
        let plant = reference::rig();
        let full = CONVERTER_RANGE_V / plant.sensors.hub_gyro.scale_v_unit;
        let values = vec![0.0, full, 1.5 * full, -9999.0, 0.1];
        let mut recording = Recording::new("run", 1e-3).with(Channel::HubRate, values);
        let found = remove_impossible(&plant, &mut recording);
        let wanted = BeyondRange { samples: 2, missing: 1, first_row: 3, value: 1.5 * full, limit: full };
        assert_eq!(found, [(Channel::HubRate, wanted)]);
        let kept = recording.samples(Channel::HubRate).unwrap_or_default();
        assert!(kept[3].is_nan() && kept[2] > full);
    }
}
