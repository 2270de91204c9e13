//! The errors of a request to this crate.

use counterpoise_models::{ControlledQuantity, QuantityKind};
use counterpoise_recordings::Channel;

use crate::recording::remarks::RecordingRemark;

/// Every way in which a diagnosis can be refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Nothing to diagnose.
    #[error("no recording was given")]
    NoRecording,
    /// A channel without which there is no diagnosis.
    #[error(
        "recording {recording}: the channel {} is missing; a diagnosis of this machine needs {}{}",
        channel.name(),
        if *replays_control { "" } else { "demand, " },
        shown_channels(*controlled)
    )]
    NoChannel {
        /// The quantity that the loop of the machine controls.
        controlled: ControlledQuantity,
        /// `true` if the recorded control is replayed, which needs no demand.
        replays_control: bool,
        /// Name of the recording.
        recording: String,
        /// The channel that is missing.
        channel: Channel,
    },
    /// A channel without which nothing is identified.
    #[error(
        "recording {recording}: the channel {} is missing; identification of this machine needs {}",
        channel.name(),
        identifying_channels(*controlled)
    )]
    NotIdentifiable {
        /// The quantity that the loop of the machine controls.
        controlled: ControlledQuantity,
        /// Name of the recording.
        recording: String,
        /// The channel that is missing.
        channel: Channel,
    },
    /// Too little sliding to identify anything.
    #[error(
        "the joint slides for {sliding_s:.2} s in these recordings, away from reversals and limits; {needed_s:.2} s are \
         needed. Demand a triangle wave of rate, several times the presliding distance in each direction"
    )]
    TooLittleSliding {
        /// Time that the joint slides, s.
        sliding_s: f64,
        /// Time that is needed, s.
        needed_s: f64,
    },
    /// Motions that cannot be told apart.
    #[error(
        "weight, friction, rate and acceleration cannot be separated in these recordings: they need both directions, \
         several rates and several accelerations, as a triangle wave of rate has"
    )]
    NotTold,
    /// The mechanism as the project has it cannot be simulated on the recordings.
    #[error("the mechanism as the project file has it cannot be simulated on these recordings")]
    NotSimulated,
    /// Nothing of the recordings can be replayed.
    #[error("nothing of these recordings can be replayed")]
    Unusable {
        /// The faults that were found in them.
        remarks: Vec<RecordingRemark>,
    },
    /// The user asked to stop.
    #[error("cancelled: nothing was found or written")]
    Cancelled,
    /// The simulator refused.
    #[error(transparent)]
    Simulate(#[from] counterpoise_simulate::Error),
}

/// Returns the channels of the control and of what the loop controls.
fn shown_channels(controlled: ControlledQuantity) -> String {
    let name = controlled.name();
    match controlled.kind {
        QuantityKind::Position => {
            format!("control and hub_rate (the {name}, which may be recorded as hub_position)")
        }
        _ => format!("control and hub_rate (the {name})"),
    }
}

/// Returns the channels that identification needs: those that show the motion, and the control.
fn identifying_channels(controlled: ControlledQuantity) -> String {
    match controlled.kind {
        QuantityKind::Rate | QuantityKind::Position => shown_channels(controlled),
        QuantityKind::Effort | QuantityKind::Current => {
            format!(
                "control, hub_rate (the {}) and motor_rate, which alone shows the motion",
                controlled.name()
            )
        }
    }
}

#[cfg(test)]
mod tests {
    use counterpoise_models::parameters::AxisKind;

    use super::*;

    #[test]
    fn a_missing_channel_is_told_in_the_words_of_the_machine() {
        let told = |kind, axis, replays_control| {
            let controlled = ControlledQuantity { kind, axis, ..ControlledQuantity::RATE };
            let recording = "run 3".to_owned();
            Error::NoChannel { controlled, replays_control, recording, channel: Channel::HubRate }.to_string()
        };
        assert_eq!(
            told(QuantityKind::Rate, AxisKind::Linear, false),
            "recording run 3: the channel hub_rate is missing; a diagnosis of this machine needs demand, control and hub_rate (the slide speed)"
        );
        let position = told(QuantityKind::Position, AxisKind::Rotary, true);
        assert!(
            position.ends_with(
                "needs control and hub_rate (the hub angle, which may be recorded as hub_position)"
            ),
            "{position}"
        );
        let identified = Error::NotIdentifiable {
            controlled: ControlledQuantity { kind: QuantityKind::Effort, ..ControlledQuantity::RATE },
            recording: "run 3".to_owned(),
            channel: Channel::MotorRate,
        };
        assert!(
            identified.to_string().contains("hub_rate (the transmitted torque) and motor_rate"),
            "{identified}"
        );
    }
}
