//! The guard of a fixed-point controller: the integers' form of what the controller's own guard does.
//!
//! Integers know no subnormal numbers, and states saturate. One integer, the lowest of 32 bits, stands for a reading that is no
//! number. What remains is to replace that one and readings beyond their limits, and to hand over to feedback alone.
//!
//! A format may be narrower than the limit of its reading, because it was made for the motion that was simulated. A reading
//! beyond such a format saturates and is used: it has the right sign, so that the control still brakes a machine that a lost
//! reading has left faster than any simulated one. The last good reading would let it run for ever.

use counterpoise_controller::guard::{ALONE, STICKY};
use counterpoise_controller::signal::{DEMAND, HUB_RATE};
use counterpoise_controller::{GuardSettings, READINGS, SensorUse, Status};

use crate::fixed_point::format::to_integer;
use crate::fixed_point::{FULL, FixedPointController, round_and_limit};

/// Fraction bits of the share of the other sensors.
pub(crate) const SHARE_BITS: u32 = 30;
/// Fraction bits from which on a reading's format holds nothing that a sensor gives: the runs never moved it.
const UNMOVED_BITS: i32 = 60;

/// The numbers of a guard, as integers.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FixedSettings {
    /// Largest magnitude of each reading in its format, or the end of the format where that is smaller.
    pub limits: [i64; READINGS],
    /// Number of readings that the controller takes.
    pub readings: usize,
    /// Samples after which a reading counts as unchanged.
    pub unchanged_samples: u32,
    /// Change a sample of the share of the other sensors.
    pub share_step: i64,
}

impl FixedSettings {
    /// Returns the settings of a controller.
    pub fn of(fixed: &FixedPointController) -> Self {
        let settings = GuardSettings::of(fixed.controller.parts());
        let bits = &fixed.step.inputs;
        let limit = |i: usize| match bits.get(i).copied().unwrap_or(UNMOVED_BITS) {
            unmoved if unmoved >= UNMOVED_BITS => FULL,
            bits => to_integer(settings.limits[i], bits),
        };
        let whole = f64::from(SHARE_BITS).exp2();
        Self {
            limits: std::array::from_fn(limit),
            readings: bits.len(),
            unchanged_samples: settings.unchanged_samples,
            share_step: ((settings.share_step * whole) as i64).min((1 << SHARE_BITS) - 1),
        }
    }
}

/// A guard that runs.
#[derive(Debug, Clone)]
pub(crate) struct FixedGuard {
    settings: FixedSettings,
    good: [i64; READINGS],
    unchanged: [u32; READINGS],
    share: i64,
    status: Status,
}

impl FixedGuard {
    /// Returns the guard at its start.
    pub fn new(fixed: &FixedPointController) -> Self {
        Self {
            settings: FixedSettings::of(fixed),
            good: [0; READINGS],
            unchanged: [0; READINGS],
            share: 1 << SHARE_BITS,
            status: Status::default(),
        }
    }

    /// Forgets all faults; which sensors are used stays as it was.
    pub fn reset(&mut self) {
        (self.good, self.unchanged) = ([0; READINGS], [0; READINGS]);
        self.status = Status { flags: self.status.flags & ALONE, replaced: 0 };
        self.share = if self.status.flags == 0 { 1 << SHARE_BITS } else { 0 };
    }

    /// Returns what is to be said.
    pub fn status(&self) -> Status {
        self.status
    }

    /// Sets which sensors are used.
    pub fn use_sensors(&mut self, sensors: SensorUse) {
        match sensors {
            SensorUse::All => self.status.flags &= !ALONE,
            SensorUse::FeedbackAlone => self.status.flags |= ALONE,
        }
    }

    /// Returns the readings that the step uses.
    pub fn take(&mut self, readings: &[i64; READINGS]) -> [i64; READINGS] {
        self.status.flags &= STICKY;
        let step = self.settings.share_step;
        let moved = self.share + if self.status.flags & ALONE != 0 { -step } else { step };
        self.share = moved.clamp(0, 1 << SHARE_BITS);
        std::array::from_fn(|i| {
            if i >= self.settings.readings {
                return 0;
            }
            let taken = self.reading(i, readings[i]);
            if i == DEMAND || i == HUB_RATE { taken } else { round_and_limit(self.share * taken, SHARE_BITS) }
        })
    }

    fn reading(&mut self, i: usize, value: i64) -> i64 {
        let (limit, most) = (self.settings.limits[i], self.settings.unchanged_samples);
        let is_good = (-limit..=limit).contains(&value);
        let taken = if is_good { value } else { self.good[i] };
        self.unchanged[i] = if taken == self.good[i] { (self.unchanged[i] + 1).min(most) } else { 0 };
        if !is_good {
            self.status.flags |= 1 << i;
            self.status.replaced = self.status.replaced.saturating_add(1);
        }
        if self.unchanged[i] >= most {
            self.status.flags |= 0x100 << i;
        }
        self.good[i] = taken;
        taken
    }
}
