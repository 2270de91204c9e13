//! The response of a running controller to readings, settings and states that cannot be right.
//!
//! A reading that is not a number, or beyond its limit, is replaced by the last good one. A reading or state too small to
//! matter becomes 0, so that no step is slowed down by subnormal numbers. If the states leave every plausible size, they
//! go back to their start. Good readings pass unchanged, to the last bit.
//!
//! The printed code carries out the same operations in the same order.

use crate::program::{StateGroup, StateLimits};
use crate::signal::{DEMAND, HUB_POSITION, HUB_RATE};
use crate::tolerance::{FARTHEST_ANGLE_RAD, HANDOVER_S, MOST_STATES, UNCHANGED_S};
use crate::{Number, Parts, READINGS};

/// Flag of the first reading: bit i says that reading i was replaced at the last sample.
pub const REPLACED: u32 = 0x3f;
/// Bit 8 + i says that reading i has not changed for a second. A controller that takes a seventh reading has one more bit in both masks:
/// [`GuardSettings::replaced_mask`] and [`GuardSettings::unchanged_mask`].
pub const UNCHANGED: u32 = 0x3f00;
/// The states left every plausible size and were put back to their start; kept until a reset.
pub const RESTARTED: u32 = 0x1_0000;
/// A setting of the out-of-balance was refused, because it was not a finite number; kept until a reset.
pub const REFUSED: u32 = 0x2_0000;
/// Feedback works alone: the other sensors are not used.
pub const ALONE: u32 = 0x4_0000;
/// Bits that one sample leaves to the next.
pub const STICKY: u32 = RESTARTED | REFUSED | ALONE;

/// Sensors that a controller uses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SensorUse {
    /// All that it was designed with.
    All,
    /// The demand and the hub gyroscope alone.
    FeedbackAlone,
}

/// State of a running controller as its guard reports it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Status {
    /// Flags: [`REPLACED`], [`UNCHANGED`], [`RESTARTED`], [`REFUSED`], [`ALONE`].
    pub flags: u32,
    /// Number of readings that were replaced since the start or the last reset.
    pub replaced: u32,
}

/// The numbers that decide in a guard, as every back end writes them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GuardSettings {
    /// Largest magnitude of each reading, in its unit.
    pub limits: [f64; READINGS],
    /// Number of readings that the controller takes.
    pub readings: usize,
    /// Samples after which a reading counts as unchanged.
    pub unchanged_samples: u32,
    /// Change a sample of the share of the other sensors, when feedback takes over or gives back.
    pub share_step: f64,
}

impl GuardSettings {
    /// Returns the settings of a controller.
    pub fn of(parts: &Parts) -> Self {
        let period_s = parts.sample_period_s;
        let unchanged_samples = (UNCHANGED_S / period_s).round().clamp(1.0, f64::from(u32::MAX / 2));
        let mut limits = parts.reading_limits;
        let projected =
            parts.projection.is_some_and(|projection| projection.angle_reading == Some(HUB_POSITION));
        if projected || parts.estimator.as_ref().is_some_and(|estimator| estimator.gravity_m_s2 != 0.0) {
            limits[HUB_POSITION] = limits[HUB_POSITION].min(FARTHEST_ANGLE_RAD);
        }
        Self {
            limits,
            readings: parts.reading_count(),
            unchanged_samples: unchanged_samples as u32,
            share_step: period_s / HANDOVER_S.max(period_s),
        }
    }

    /// Returns the mask of the flags of replaced readings.
    pub fn replaced_mask(&self) -> u32 {
        (1 << self.readings) - 1
    }

    /// Returns the mask of the flags of unchanged readings.
    pub fn unchanged_mask(&self) -> u32 {
        self.replaced_mask() << 8
    }
}

/// The guard of a running controller, in the numbers N.
#[derive(Debug, Clone)]
pub(crate) struct Guard<N> {
    limits: [N; READINGS],
    readings: usize,
    unchanged_samples: u32,
    share_step: N,
    good: [N; READINGS],
    unchanged: [u32; READINGS],
    share: N,
    control: N,
    status: Status,
}

impl<N: Number> Guard<N> {
    /// Returns the guard at its start.
    pub fn new(parts: &Parts) -> Self {
        let settings = GuardSettings::of(parts);
        let zero = || N::from_f64(0.0);
        Self {
            limits: settings.limits.map(N::from_f64),
            readings: settings.readings,
            unchanged_samples: settings.unchanged_samples,
            share_step: N::from_f64(settings.share_step),
            good: std::array::from_fn(|_| zero()),
            unchanged: [0; READINGS],
            share: N::from_f64(1.0),
            control: zero(),
            status: Status::default(),
        }
    }

    /// Forgets all faults; which sensors are used stays as it was.
    pub fn reset(&mut self) {
        self.good = std::array::from_fn(|_| N::from_f64(0.0));
        self.unchanged = [0; READINGS];
        self.control = N::from_f64(0.0);
        self.share = N::from_f64(if self.is_alone() { 0.0 } else { 1.0 });
        self.status = Status { flags: self.status.flags & ALONE, replaced: 0 };
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

    /// Returns whether an out-of-balance may be set; notes a refusal.
    pub fn admits(&mut self, out_of_balance: &N) -> bool {
        let value = out_of_balance.to_f64();
        let most = N::from_f64(MOST_STATES).to_f64();
        let admitted = (-most..=most).contains(&value);
        if !admitted {
            self.status.flags |= REFUSED;
        }
        admitted
    }

    /// Returns the readings that the step uses.
    pub fn take(&mut self, readings: &[N; READINGS]) -> [N; READINGS] {
        self.status.flags &= STICKY;
        let step =
            if self.is_alone() { N::from_f64(-1.0).times(&self.share_step) } else { self.share_step.clone() };
        self.share = self.share.plus(&step).clamp_to(&N::from_f64(0.0), &N::from_f64(1.0));
        std::array::from_fn(|i| {
            if i >= self.readings {
                return N::from_f64(0.0);
            }
            let taken = self.reading(i, &readings[i]);
            if i == DEMAND || i == HUB_RATE { taken } else { self.share.times(&taken) }
        })
    }

    /// Returns a reading, or the last good one in its place.
    fn reading(&mut self, i: usize, value: &N) -> N {
        let (number, limit, before) = (value.to_f64(), self.limits[i].to_f64(), self.good[i].to_f64());
        let is_good = number >= -limit && number <= limit;
        let taken = if is_good { value.clone() } else { self.good[i].clone() };
        let is_same = taken.to_f64() >= before && taken.to_f64() <= before;
        self.unchanged[i] = if is_same { (self.unchanged[i] + 1).min(self.unchanged_samples) } else { 0 };
        if !is_good {
            self.status.flags |= 1 << i;
            self.status.replaced = self.status.replaced.saturating_add(1);
        }
        if self.unchanged[i] >= self.unchanged_samples {
            self.status.flags |= 0x100 << i;
        }
        self.good[i] = taken.clone();
        taken.flush()
    }

    /// Takes the control that the step gave and whether its states are plausible; returns the control to put out. When
    /// states were put back to their start, that is the control of the sample before.
    pub fn select_control(&mut self, control: N, states: StatePlausibility) -> N {
        match states {
            StatePlausibility::Yes => self.control = control,
            StatePlausibility::No => self.status.flags |= RESTARTED,
        }
        self.control.clone()
    }

    fn is_alone(&self) -> bool {
        self.status.flags & ALONE != 0
    }
}

/// The plausibility of the sizes of a controller's states.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum StatePlausibility {
    /// They are plausible.
    Yes,
    /// They are not plausible.
    No,
}

/// A state that is kept within limits, in the numbers N.
#[derive(Debug, Clone)]
pub(crate) struct StateLimit<N> {
    place: usize,
    low: N,
    high: N,
}

/// Returns the states of a controller that are kept within limits.
pub(crate) fn kept_states<N: Number>(groups: &[StateGroup]) -> Vec<StateLimit<N>> {
    let limited = groups.iter().filter_map(|group| Some((group, group.limits?)));
    let kept = |(group, StateLimits { low, high }): (&StateGroup, StateLimits)| {
        let places = group.first..group.first + group.initial.len();
        places
            .map(move |place| StateLimit { place, low: N::from_f64(low), high: N::from_f64(high) })
            .collect::<Vec<_>>()
    };
    limited.flat_map(kept).collect()
}

/// Flushes states that are too small to matter, keeps estimates within their limits, and says whether all states together
/// have a plausible size.
pub(crate) fn limit_states<N: Number>(states: &mut [N], kept: &[StateLimit<N>]) -> StatePlausibility {
    let mut total = N::from_f64(0.0);
    for state in states.iter_mut() {
        total = total.plus(&state.magnitude());
        *state = state.flush();
    }
    for each in kept {
        states[each.place] = states[each.place].clamp_to(&each.low, &each.high);
    }
    assess_states(&total)
}

/// Returns whether a sum of magnitudes is a plausible size of states.
pub(crate) fn assess_states<N: Number>(total: &N) -> StatePlausibility {
    if total.to_f64() <= N::from_f64(MOST_STATES).to_f64() {
        StatePlausibility::Yes
    } else {
        StatePlausibility::No
    }
}
