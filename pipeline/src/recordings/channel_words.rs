//! Names and units of recorded channels as a machine has them: the channel of the loop's reading is named after a hub's rate, and may be an angle, a
//! torque or the place of a slide.

use counterpoise_models::{AxisKind, FeedbackSignal, Parameters};
use counterpoise_recordings::Channel;

/// Name and unit of what a channel holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ChannelWords {
    /// Name, in the form of the names of channels.
    pub name: &'static str,
    /// Unit.
    pub unit: &'static str,
}

/// Returns the words for a channel of recordings of a machine.
pub fn channel_words(plant: &Parameters, channel: Channel) -> ChannelWords {
    let (measured, slides) = (plant.sensors.measured, plant.axis == AxisKind::Linear);
    let words = |name, unit| ChannelWords { name, unit };
    let of_axis = |rotary: ChannelWords, linear: ChannelWords| if slides { linear } else { rotary };
    let rate = || of_axis(words("hub_rate", "rad/s"), words("slide_speed", "m/s"));
    let position = || of_axis(words("hub_position", "rad"), words("slide_position", "m"));
    match (channel, measured) {
        (Channel::HubRate, FeedbackSignal::HubPosition | FeedbackSignal::MotorPosition)
        | (Channel::HubPosition, _) => position(),
        (Channel::HubRate, FeedbackSignal::Torque) => of_axis(words("torque", "N m"), words("force", "N")),
        (Channel::HubRate, FeedbackSignal::Current) => words("motor_current", "A"),
        (Channel::HubRate, _) => rate(),
        (Channel::Demand, _) => words(Channel::Demand.name(), channel_words(plant, Channel::HubRate).unit),
        _ => words(channel.name(), channel.unit()),
    }
}

/// Returns the name of a channel, given as results have it, as recordings of a machine show it.
pub fn channel_label<'n>(plant: &Parameters, name: &'n str) -> &'n str {
    Channel::ALL
        .into_iter()
        .find(|channel| channel.name() == name)
        .map_or(name, |channel| channel_words(plant, channel).name)
}

#[cfg(test)]
mod tests {
    use counterpoise_models::reference;

    use super::*;

    #[test]
    fn the_channel_of_the_reading_is_named_after_what_the_loop_measures() {
        let mut plant = reference::rig();
        let words = |plant: &Parameters| {
            let found = channel_words(plant, Channel::HubRate);
            (found.name, found.unit)
        };
        assert_eq!(words(&plant), ("hub_rate", "rad/s"));
        plant.sensors.measured = FeedbackSignal::MotorPosition;
        assert_eq!(words(&plant), ("hub_position", "rad"));
        plant.sensors.measured = FeedbackSignal::Torque;
        assert_eq!(words(&plant), ("torque", "N m"));
        plant.axis = AxisKind::Linear;
        assert_eq!(words(&plant), ("force", "N"));
        plant.sensors.measured = FeedbackSignal::HubPosition;
        assert_eq!(words(&plant), ("slide_position", "m"));
        assert_eq!(channel_words(&plant, Channel::Demand).unit, "m");
        assert_eq!(channel_label(&plant, "hub_rate"), "slide_position");
        assert_eq!(channel_label(&plant, "control"), "control");
    }
}
