//! What can be wrong with a request to this crate.

use counterpoise_models::{ControlledQuantity, QuantityKind};

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
        "recording {recording}: the channel {channel} is missing; a diagnosis needs demand, control and hub_rate (or \
         hub_position in a loop of position)"
    )]
    NoChannel {
        /// Name of the recording.
        recording: String,
        /// Name of the channel.
        channel: &'static str,
    },
    /// A channel without which nothing is identified.
    #[error(
        "recording {recording}: the channel {channel} is missing; identification of this machine needs {}",
        needed_channels(*controlled)
    )]
    NotIdentifiable {
        /// What the loop of the machine controls.
        controlled: ControlledQuantity,
        /// Name of the recording.
        recording: String,
        /// Name of the channel.
        channel: &'static str,
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
        "weight, friction, rate and acceleration cannot be told apart in these recordings: they need both directions, \
         several rates and several accelerations, as a triangle wave of rate has"
    )]
    NotTold,
    /// The mechanism as the project has it cannot be simulated on the recordings.
    #[error("the mechanism as the project file has it cannot be simulated on these recordings")]
    NotSimulated,
    /// Nothing of the recordings can be replayed.
    #[error("nothing of these recordings can be replayed")]
    Unusable {
        /// What was found wrong with them.
        remarks: Vec<RecordingRemark>,
    },
    /// The user asked to stop.
    #[error("cancelled: nothing was found or written")]
    Cancelled,
    /// The simulator refused.
    #[error(transparent)]
    Simulate(#[from] counterpoise_simulate::Error),
}

/// Returns the channels that identification needs: those that show the motion, and the control.
fn needed_channels(controlled: ControlledQuantity) -> String {
    let name = controlled.name();
    match controlled.kind {
        QuantityKind::Rate => format!("control and hub_rate (the {name})"),
        QuantityKind::Position => {
            format!("control and hub_rate (the {name}, which may be recorded as hub_position)")
        }
        QuantityKind::Effort | QuantityKind::Current => {
            format!("control, hub_rate (the {name}) and motor_rate, which alone shows the motion")
        }
    }
}
