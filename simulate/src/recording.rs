//! A recording of the machine as plain data.

use std::ops::Range;

use crate::history::ReadingColumns;

/// A channel of a recording that a replay compares.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Channel {
    /// Control after the output converter, V.
    Control,
    /// Hub gyroscope, rad/s.
    HubRate,
    /// Platform gyroscope, rad/s.
    PlatformRate,
    /// Platform accelerometer, m/s^2.
    PlatformAccel,
    /// Motor tachometer, rad/s.
    MotorRate,
    /// Hub resolver, rad.
    HubPosition,
}

/// Experiments of one machine: one value a sample in every column, SI units, NaN where a sample is missing.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Recording {
    /// Name, for reports.
    pub name: String,
    /// Sample period, s.
    pub sample_period_s: f64,
    /// Demanded hub rate, rad/s.
    pub demand_rad_s: Option<Vec<f64>>,
    /// Control after the output converter, V.
    pub control_v: Option<Vec<f64>>,
    /// Hub gyroscope, rad/s.
    pub hub_rate_rad_s: Option<Vec<f64>>,
    /// Platform gyroscope, rad/s; a still platform where there is none.
    pub platform_rate_rad_s: Option<Vec<f64>>,
    /// Platform accelerometer, m/s^2; no heave where there is none.
    pub platform_accel_m_s2: Option<Vec<f64>>,
    /// Motor tachometer, rad/s.
    pub motor_rate_rad_s: Option<Vec<f64>>,
    /// Hub resolver, rad, relative to the platform.
    pub hub_position_rad: Option<Vec<f64>>,
}

impl Channel {
    /// All channels.
    pub const ALL: [Self; 6] = [
        Self::Control,
        Self::HubRate,
        Self::PlatformRate,
        Self::PlatformAccel,
        Self::MotorRate,
        Self::HubPosition,
    ];

    /// Name in recordings and answers.
    pub fn name(self) -> &'static str {
        match self {
            Self::Control => "control",
            Self::HubRate => "hub_rate",
            Self::PlatformRate => "platform_rate",
            Self::PlatformAccel => "platform_accel",
            Self::MotorRate => "motor_rate",
            Self::HubPosition => "hub_position",
        }
    }

    /// The column of a run.
    pub fn of(self, columns: &ReadingColumns) -> &[f64] {
        match self {
            Self::Control => &columns.control_v,
            Self::HubRate => &columns.hub_rate_rad_s,
            Self::PlatformRate => &columns.platform_rate_rad_s,
            Self::PlatformAccel => &columns.platform_accel_m_s2,
            Self::MotorRate => &columns.motor_rate_rad_s,
            Self::HubPosition => &columns.hub_position_rad,
        }
    }

    /// The same, to be changed.
    pub(crate) fn of_mut(self, columns: &mut ReadingColumns) -> &mut [f64] {
        match self {
            Self::Control => &mut columns.control_v,
            Self::HubRate => &mut columns.hub_rate_rad_s,
            Self::PlatformRate => &mut columns.platform_rate_rad_s,
            Self::PlatformAccel => &mut columns.platform_accel_m_s2,
            Self::MotorRate => &mut columns.motor_rate_rad_s,
            Self::HubPosition => &mut columns.hub_position_rad,
        }
    }
}

impl Recording {
    /// The column of a channel, where it was recorded.
    pub fn column(&self, channel: Channel) -> Option<&[f64]> {
        match channel {
            Channel::Control => self.control_v.as_deref(),
            Channel::HubRate => self.hub_rate_rad_s.as_deref(),
            Channel::PlatformRate => self.platform_rate_rad_s.as_deref(),
            Channel::PlatformAccel => self.platform_accel_m_s2.as_deref(),
            Channel::MotorRate => self.motor_rate_rad_s.as_deref(),
            Channel::HubPosition => self.hub_position_rad.as_deref(),
        }
    }

    /// The samples `range` of every channel; of a shorter column what it has of them. The name is kept.
    pub fn part(&self, range: Range<usize>) -> Self {
        let cut = |column: &Option<Vec<f64>>| {
            let column = column.as_deref()?;
            let end = range.end.min(column.len());
            Some(column[range.start.min(end)..end].to_vec())
        };
        Self {
            name: self.name.clone(),
            sample_period_s: self.sample_period_s,
            demand_rad_s: cut(&self.demand_rad_s),
            control_v: cut(&self.control_v),
            hub_rate_rad_s: cut(&self.hub_rate_rad_s),
            platform_rate_rad_s: cut(&self.platform_rate_rad_s),
            platform_accel_m_s2: cut(&self.platform_accel_m_s2),
            motor_rate_rad_s: cut(&self.motor_rate_rad_s),
            hub_position_rad: cut(&self.hub_position_rad),
        }
    }

    /// Number of samples: that of the longest column.
    pub fn len(&self) -> usize {
        let columns = Channel::ALL.into_iter().filter_map(|channel| self.column(channel));
        columns.chain(self.demand_rad_s.as_deref()).map(<[f64]>::len).max().unwrap_or(0)
    }

    /// Whether no channel has a sample.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The recording that a machine like the simulated one would have left of a run.
    pub fn from_run(name: &str, sample_period_s: f64, columns: &ReadingColumns) -> Self {
        Self {
            name: name.to_owned(),
            sample_period_s,
            demand_rad_s: Some(columns.demand_rad_s.clone()),
            control_v: Some(columns.control_v.clone()),
            hub_rate_rad_s: Some(columns.hub_rate_rad_s.clone()),
            platform_rate_rad_s: Some(columns.platform_rate_rad_s.clone()),
            platform_accel_m_s2: Some(columns.platform_accel_m_s2.clone()),
            motor_rate_rad_s: Some(columns.motor_rate_rad_s.clone()),
            hub_position_rad: Some(columns.hub_position_rad.clone()),
        }
    }
}
