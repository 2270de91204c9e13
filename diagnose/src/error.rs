//! What can be wrong with a request to this crate.

/// Every way in which a diagnosis can be refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Nothing to diagnose.
    #[error("no recording was given")]
    NoRecording,
    /// A channel without which there is no diagnosis.
    #[error(
        "recording {recording}: the channel {channel} is missing; a diagnosis needs demand, control and hub_rate"
    )]
    NoChannel {
        /// Name of the recording.
        recording: String,
        /// Name of the channel.
        channel: &'static str,
    },
    /// The mechanism as the project has it cannot be simulated on the recordings.
    #[error("the mechanism as the project file has it cannot be simulated on these recordings")]
    NotSimulated,
    /// The simulator refused.
    #[error(transparent)]
    Simulate(#[from] counterpoise_simulate::Error),
}
