//! The motion of the base under a traverse ring, sample by sample.

use super::quartics::{AT, PLACES};
use crate::motion::{SignalFollower, quartic, slope};
use crate::signal::Signal;

/// Motion of the base under a traverse ring, in axes fixed to the base: x forward, y to the left, z up.
#[derive(Debug, Clone, PartialEq)]
pub struct BaseMotion {
    /// Specific force on the ring's axis at the height of the elevation pivot, m/s^2.
    pub specific_force_m_s2: [Signal; 3],
    /// Inertial rates about x, y and z, rad/s.
    pub rate_rad_s: [Signal; 3],
    /// Pitch angle at the start, rad, nose up.
    pub initial_pitch_rad: f64,
}

impl BaseMotion {
    /// Returns a base at rest and level.
    pub fn at_rest(gravity_m_s2: f64) -> Self {
        let force = [0.0, 0.0, gravity_m_s2].map(Signal::Constant);
        Self {
            specific_force_m_s2: force,
            rate_rad_s: [Signal::ZERO, Signal::ZERO, Signal::ZERO],
            initial_pitch_rad: 0.0,
        }
    }
}

/// The base over one sample: values at the places.
#[derive(Debug, Clone, Copy)]
pub(super) struct BaseSample {
    /// Yaw rate as a quartic in the fraction of the sample.
    pub yaw: [f64; 5],
    pub places: [BasePoint; PLACES],
}

/// The base at one instant.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct BasePoint {
    pub force: [f64; 3],
    pub rate: [f64; 3],
    /// Derivatives of the rates, rad/s^2.
    pub turn: [f64; 3],
}

/// A base that is followed from sample to sample.
#[derive(Debug, Clone)]
pub(super) struct BaseTrack<'a> {
    period_s: f64,
    next: usize,
    force: [SignalFollower<'a>; 3],
    rate: [SignalFollower<'a>; 3],
}

impl<'a> BaseTrack<'a> {
    pub fn new(base: &'a BaseMotion, period_s: f64) -> Self {
        let follow = |signal: &'a Signal| SignalFollower::new(signal, period_s);
        Self {
            period_s,
            next: 0,
            force: base.specific_force_m_s2.each_ref().map(follow),
            rate: base.rate_rad_s.each_ref().map(follow),
        }
    }

    /// Returns the base over the next sample.
    #[inline]
    pub fn sample(&mut self) -> BaseSample {
        let (k, period_s) = (self.next, self.period_s);
        self.next += 1;
        let start_s = k as f64 * period_s;
        let force = self.force.each_mut().map(|signal| signal.next(k, start_s, period_s));
        let rate = self.rate.each_mut().map(|signal| signal.next(k, start_s, period_s));
        let mut places = [BasePoint::default(); PLACES];
        let per_s = 1.0 / period_s;
        for (place, s) in places.iter_mut().zip(AT) {
            for axis in 0..3 {
                place.force[axis] = quartic(&force[axis], s);
                place.rate[axis] = quartic(&rate[axis], s);
                place.turn[axis] = slope(&rate[axis], s) * per_s;
            }
        }
        BaseSample { yaw: rate[2], places }
    }
}
