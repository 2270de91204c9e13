//! The known sizes of a machine, and the gain that an effect must have there.

use counterpoise_models::{FeedbackSignal, Parameters};
use counterpoise_recordings::Recording;

use crate::recording::measured_signals::read_signals;
use crate::tolerance::selection::TYPICAL_RATE_RAD_S;
use crate::tolerance::{GAIN_NEEDED, TEXTBOOK_GAIN_NEEDED};

/// Typical sizes of a machine's quantities.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sizes {
    /// `true` if the library's typical sizes are typical of the machine: one like the reference rig.
    pub typical: bool,
    /// Turns of the motor, as the model counts them, per turn of the machine's own motor.
    pub motor_turns: f64,
    /// Rate of the hub on the platform that nine in ten samples do not exceed, rad/s.
    pub rate_rad_s: f64,
    /// `true` if the motor's back-EMF constant is its torque constant, which in SI units they are: one value stands for both.
    pub one_motor_constant: bool,
}

impl Sizes {
    /// The sizes of a machine like the reference rig.
    pub const TYPICAL: Self =
        Self { typical: true, motor_turns: 1.0, rate_rad_s: TYPICAL_RATE_RAD_S, one_motor_constant: false };

    /// Returns the same for a motor as the project file has it.
    #[must_use]
    pub fn with_motor_of(self, base: &Parameters) -> Self {
        let motor = &base.motor;
        Self { one_motor_constant: motor.back_emf_v_s_rad == motor.torque_constant_nm_a, ..self }
    }

    /// Returns the same with the rates of recordings in a loop of what `measured` says; unchanged if they show none.
    #[must_use]
    pub fn with_rates_of(self, recordings: &[Recording], measured: FeedbackSignal) -> Self {
        let signals = recordings.iter().filter_map(|recording| read_signals(recording, measured));
        let rates = signals.flat_map(|signals| signals.relative_rate());
        let mut sizes: Vec<f64> = rates.map(f64::abs).filter(|rate| rate.is_finite()).collect();
        let place = sizes.len() * 9 / 10;
        if place >= sizes.len() {
            return self;
        }
        let (_, rate_rad_s, _) = sizes.select_nth_unstable_by(place, f64::total_cmp);
        if *rate_rad_s > 0.0 { Self { rate_rad_s: *rate_rad_s, ..self } } else { self }
    }

    /// Returns the log-likelihood that an effect must gain on held-out data.
    pub fn gain_needed(&self) -> f64 {
        if self.typical { GAIN_NEEDED } else { TEXTBOOK_GAIN_NEEDED }
    }
}
