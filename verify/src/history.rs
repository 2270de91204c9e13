//! Time histories as plain data.

use crate::tolerance::SAME_INSTANT_S;
use crate::{Arrangement, Model, Source};

/// What was done to the mechanism.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Experiment {
    /// A step of the demand, with the whole controller.
    Step,
    /// A triangle of the demand, with the whole controller.
    Triangle,
    /// The platform moves.
    Disturbance(Source, Arrangement),
    /// Nothing, with the whole controller.
    Rest,
}

/// What happened: one entry a sample in every column; a column that was not computed is empty.
#[derive(Debug, Clone, PartialEq)]
pub struct History {
    /// On which plant.
    pub model: Model,
    /// What was done.
    pub experiment: Experiment,
    /// Time, s.
    pub time_s: Vec<f64>,
    /// Demanded hub rate, rad/s.
    pub demand_rad_s: Vec<f64>,
    /// Heave, m/s^2.
    pub heave_m_s2: Vec<f64>,
    /// Platform pitch rate, rad/s.
    pub pitch_rate_rad_s: Vec<f64>,
    /// Hub rate (inertial), rad/s.
    pub hub_rate_rad_s: Vec<f64>,
    /// Tip rate (inertial), rad/s.
    pub tip_rate_rad_s: Vec<f64>,
    /// Control with the voltage that holds the out-of-balance, V.
    pub control_v: Vec<f64>,
    /// Motor current, A; about its value at rest on the linear plant.
    pub current_a: Vec<f64>,
    /// Hub angle relative to the platform from its start, rad.
    pub travel_rad: Vec<f64>,
    /// Whether the gear teeth touch: 1 or 0; empty on the linear plant.
    pub contact: Vec<f64>,
}

impl History {
    /// Returns the demanded less the actual hub rate, rad/s.
    pub fn tracking_error_rad_s(&self) -> Vec<f64> {
        self.demand_rad_s.iter().zip(&self.hub_rate_rad_s).map(|(demand, rate)| demand - rate).collect()
    }

    /// Returns the first sample at or after a time; the number of samples where there is none.
    pub fn index_at(&self, time_s: f64) -> usize {
        self.time_s.partition_point(|t| *t < time_s)
    }

    /// Returns the largest size of the platform's motion: its acceleration in m/s^2 if it heaves alone, its pitch rate in rad/s otherwise;
    /// `None` if the platform stands still.
    pub fn motion_amplitude(&self) -> Option<f64> {
        let Experiment::Disturbance(source, _) = self.experiment else { return None };
        let column = if source == Source::Heave { &self.heave_m_s2 } else { &self.pitch_rate_rad_s };
        Some(crate::signals::peak(column)).filter(|amplitude| *amplitude > 0.0)
    }

    /// Returns the history from a time on, its clock and its travel starting there.
    pub fn from_time(mut self, time_s: f64) -> Self {
        let first = self.index_at(time_s - SAME_INSTANT_S);
        let (start_s, start_rad) = (self.time_s.get(first).copied(), self.travel_rad.get(first).copied());
        for column in [
            &mut self.time_s,
            &mut self.demand_rad_s,
            &mut self.heave_m_s2,
            &mut self.pitch_rate_rad_s,
            &mut self.hub_rate_rad_s,
            &mut self.tip_rate_rad_s,
            &mut self.control_v,
            &mut self.current_a,
            &mut self.travel_rad,
            &mut self.contact,
        ] {
            column.drain(..first.min(column.len()));
        }
        self.time_s.iter_mut().for_each(|t| *t -= start_s.unwrap_or(0.0));
        self.travel_rad.iter_mut().for_each(|angle| *angle -= start_rad.unwrap_or(0.0));
        self
    }
}

/// The integral of a rate by the trapezoidal rule, from 0.
pub(crate) fn integrate(rates: impl Iterator<Item = f64>, period_s: f64) -> Vec<f64> {
    let (mut sum, mut before) = (0.0, None);
    let mut next = |rate: f64| {
        sum += before.map_or(0.0, |last: f64| 0.5 * period_s * (last + rate));
        before = Some(rate);
        sum
    };
    rates.map(&mut next).collect()
}
