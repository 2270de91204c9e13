//! Time histories: arrays of signals over time.

use counterpoise_models::FeedbackSignal;
use counterpoise_recordings::{Channel, ColumnName, Recording, Signals};

use crate::tolerance::SAME_INSTANT_S;
use crate::{Arrangement, Model, PerformanceFigure, Source};

/// Experiment on the mechanism.
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

impl Experiment {
    /// Returns the run with the whole controller that shows a figure: that of its platform motion, or the step of the demand for a figure of the
    /// loop or the line of sight.
    pub fn from_figure(figure: PerformanceFigure) -> Self {
        match figure {
            PerformanceFigure::Disturbance(_, source, ..) | PerformanceFigure::Rejection { source, .. } => {
                Self::Disturbance(source, Arrangement::Compensated)
            }
            PerformanceFigure::Rest(_) | PerformanceFigure::Certificate(_) => Self::Rest,
            PerformanceFigure::Triangle(..) => Self::Triangle,
            PerformanceFigure::Step(..) | PerformanceFigure::Loop(_) | PerformanceFigure::Sight(_) => {
                Self::Step
            }
        }
    }
}

/// A signal of a [`History`]: a column of its array.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HistoryColumn {
    /// Time, s.
    Time,
    /// Demanded hub rate, rad/s.
    Demand,
    /// Heave, m/s^2.
    Heave,
    /// Platform pitch rate, rad/s.
    PitchRate,
    /// Hub rate (inertial), rad/s.
    HubRate,
    /// Tip rate (inertial), rad/s.
    TipRate,
    /// Control with the voltage that holds the out-of-balance, V.
    Control,
    /// Motor current, A; about its value at rest on the linear plant.
    Current,
    /// Hub angle relative to the platform from its start, rad.
    Travel,
    /// Contact of the gear teeth: 1 or 0; the linear plant has no such column, which is why it stands last.
    Contact,
}

impl ColumnName for HistoryColumn {
    fn index(self) -> usize {
        self as usize
    }
}

/// Record of a run: an array time x signal, with a named column for each signal.
///
/// A loop of a position, a torque or a current has that quantity in the columns of demand and hub rate, in its unit.
#[derive(Debug, Clone, PartialEq)]
pub struct History {
    /// On which plant.
    pub model: Model,
    /// The procedure.
    pub experiment: Experiment,
    /// The signals; those of the linear plant end before [`HistoryColumn::Contact`].
    pub signals: Signals<HistoryColumn>,
}

impl History {
    /// Returns the platform's pitch angle from the start of the run, rad: the integral of its rate by the trapezoidal rule.
    pub fn platform_angles_rad(&self) -> Vec<f64> {
        let (times, rates) =
            (self.signals.column(HistoryColumn::Time), self.signals.column(HistoryColumn::PitchRate));
        let mut angle = 0.0;
        let steps = times.windows(2).zip(rates.windows(2)).map(|(time, rate)| {
            angle += 0.5 * (time[1] - time[0]) * (rate[0] + rate[1]);
            angle
        });
        let first = (!times.is_empty()).then_some(0.0);
        first.into_iter().chain(steps).collect()
    }

    /// Returns a history whose signals are all 0.
    pub(crate) fn zeros(model: Model, experiment: Experiment, samples: usize) -> Self {
        let columns = match model {
            Model::Linear => HistoryColumn::Contact as usize,
            Model::Nonlinear => HistoryColumn::Contact as usize + 1,
        };
        Self { model, experiment, signals: Signals::zeros(samples, columns) }
    }

    /// Returns the history with the samples of a column, which it must have.
    pub(crate) fn with(mut self, column: HistoryColumn, samples: impl IntoIterator<Item = f64>) -> Self {
        self.signals.column_mut(column).iter_mut().zip(samples).for_each(|(value, sample)| *value = sample);
        self
    }

    /// Returns the history that the sensors of a machine show in a recording of a run; `None` if demand, control or the reading of the loop's sensor were not
    /// recorded. A loop of a position counts from where it started. What no sensor reads is 0; the travel is that of the resolver, or the integral of
    /// the hub's rate on the platform.
    pub fn of_recording(
        experiment: Experiment,
        recording: &Recording,
        measured: FeedbackSignal,
    ) -> Option<Self> {
        let hub = recording.samples(Channel::HubRate)?;
        let (demand, control) = (recording.samples(Channel::Demand)?, recording.samples(Channel::Control)?);
        let period_s = recording.sample_period_s;
        let from = if measured.is_position() { hub.first().copied().unwrap_or(0.0) } else { 0.0 };
        let platform = recording.samples(Channel::PlatformRate).unwrap_or_default();
        let travel = match recording.samples(Channel::HubPosition) {
            _ if measured.is_position() => hub.iter().map(|value| value - from).collect(),
            Some(angle) => angle.iter().map(|value| value - angle[0]).collect(),
            None => {
                let on_platform = hub.iter().enumerate();
                let rates = on_platform.map(|(k, rate)| rate - platform.get(k).copied().unwrap_or(0.0));
                integrate(rates, period_s)
            }
        };
        let heave = recording.samples(Channel::PlatformAccel).unwrap_or_default();
        let history = Self::zeros(Model::Nonlinear, experiment, hub.len())
            .with(HistoryColumn::Time, (0..hub.len()).map(|k| k as f64 * period_s))
            .with(HistoryColumn::Demand, demand.iter().map(|value| value - from))
            .with(HistoryColumn::Heave, heave.iter().copied())
            .with(HistoryColumn::PitchRate, platform.iter().copied())
            .with(HistoryColumn::HubRate, hub.iter().map(|value| value - from))
            .with(HistoryColumn::Control, control.iter().copied())
            .with(HistoryColumn::Travel, travel);
        Some(history)
    }

    /// Returns the number of samples.
    pub fn len(&self) -> usize {
        self.signals.len()
    }

    /// Returns whether the history has no sample.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the time, s.
    pub fn time_s(&self) -> &[f64] {
        self.signals.column(HistoryColumn::Time)
    }

    /// Returns the demanded hub rate, rad/s.
    pub fn demand_rad_s(&self) -> &[f64] {
        self.signals.column(HistoryColumn::Demand)
    }

    /// Returns the heave, m/s^2.
    pub fn heave_m_s2(&self) -> &[f64] {
        self.signals.column(HistoryColumn::Heave)
    }

    /// Returns the platform's pitch rate, rad/s.
    pub fn pitch_rate_rad_s(&self) -> &[f64] {
        self.signals.column(HistoryColumn::PitchRate)
    }

    /// Returns the hub rate, inertial, rad/s.
    pub fn hub_rate_rad_s(&self) -> &[f64] {
        self.signals.column(HistoryColumn::HubRate)
    }

    /// Returns the tip rate, inertial, rad/s.
    pub fn tip_rate_rad_s(&self) -> &[f64] {
        self.signals.column(HistoryColumn::TipRate)
    }

    /// Returns the control with the voltage that holds the out-of-balance, V.
    pub fn control_v(&self) -> &[f64] {
        self.signals.column(HistoryColumn::Control)
    }

    /// Returns the motor current, A; about its value at rest on the linear plant.
    pub fn current_a(&self) -> &[f64] {
        self.signals.column(HistoryColumn::Current)
    }

    /// Returns the hub angle relative to the platform from its start, rad.
    pub fn travel_rad(&self) -> &[f64] {
        self.signals.column(HistoryColumn::Travel)
    }

    /// Returns whether the gear teeth touch, 1 or 0; nothing on the linear plant.
    pub fn contact(&self) -> &[f64] {
        self.signals.column(HistoryColumn::Contact)
    }

    /// Returns the demanded less the actual hub rate, rad/s.
    pub fn tracking_error_rad_s(&self) -> Vec<f64> {
        self.demand_rad_s().iter().zip(self.hub_rate_rad_s()).map(|(demand, rate)| demand - rate).collect()
    }

    /// Returns the first sample at or after a time; the number of samples if there is none.
    pub fn index_at(&self, time_s: f64) -> usize {
        self.time_s().partition_point(|t| *t < time_s)
    }

    /// Returns the platform's motion: its acceleration in m/s^2 if it heaves alone, its pitch rate in rad/s otherwise.
    pub fn motion(&self, source: Source) -> &[f64] {
        if source == Source::Heave { self.heave_m_s2() } else { self.pitch_rate_rad_s() }
    }

    /// Returns the largest size of the platform's motion: its acceleration in m/s^2 if it heaves alone, its pitch rate in rad/s otherwise;
    /// `None` if the platform stands still.
    pub fn motion_amplitude(&self) -> Option<f64> {
        let Experiment::Disturbance(source, _) = self.experiment else { return None };
        Some(crate::signals::peak(self.motion(source))).filter(|amplitude| *amplitude > 0.0)
    }

    /// Returns the history from a time on, its clock and its travel starting there.
    pub fn from_time(self, time_s: f64) -> Self {
        let mut rest =
            Self { signals: self.signals.from_sample(self.index_at(time_s - SAME_INSTANT_S)), ..self };
        for column in [HistoryColumn::Time, HistoryColumn::Travel] {
            let samples = rest.signals.column_mut(column);
            let start = samples.first().copied().unwrap_or(0.0);
            samples.iter_mut().for_each(|value| *value -= start);
        }
        rest
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
