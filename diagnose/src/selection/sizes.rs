//! The known sizes of a machine, and the gain that an effect must have there.

use crate::tolerance::{GAIN_NEEDED, TEXTBOOK_GAIN_NEEDED};

/// Typical sizes of a machine's quantities.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sizes {
    /// `true` if the library's typical sizes are typical of the machine: one like the reference rig.
    pub typical: bool,
    /// Turns of the motor, as the model counts them, per turn of the machine's own motor.
    pub motor_turns: f64,
}

impl Sizes {
    /// The sizes of a machine like the reference rig.
    pub const TYPICAL: Self = Self { typical: true, motor_turns: 1.0 };

    /// Returns the log-likelihood that an effect must gain on held-out data.
    pub fn gain_needed(&self) -> f64 {
        if self.typical { GAIN_NEEDED } else { TEXTBOOK_GAIN_NEEDED }
    }
}
