//! The shots of a machine that recoils, in a run.

/// State of a recoiling machine: firing or not.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Firing {
    /// At the instants that its parameters state: on duty, and in recordings.
    Stated,
    /// Not at all: what is measured of rest, steps and limit cycles is that of the machine that does not fire.
    #[default]
    Silent,
}
