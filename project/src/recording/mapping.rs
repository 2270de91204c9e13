//! Which column of a file is which channel of the mechanism, and how its numbers become the channel's.

use super::shaping::{lagging_slopes, on_clock, slopes, unroll};
use super::timing::{Finding, Record, record};
use super::{RecordingError, Table, Unit};

/// A quantity of the mechanism that a recording can hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Channel {
    /// Demanded hub rate, rad/s.
    Demand,
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
    /// Hub angle relative to the platform, rad.
    HubPosition,
    /// Motor angle relative to the platform, rad.
    MotorPosition,
    /// Motor current, A.
    MotorCurrent,
}

/// Where a channel comes from: value in SI = unit x (scale x (column + plus) + offset), of which the channel may be
/// the slope over time.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelSource {
    /// Name of the column.
    pub column: String,
    /// Unit of the column in place of the one in its header.
    pub unit: Option<String>,
    /// Factor; a negative one turns the sign.
    pub scale: f64,
    /// Added after the factor, in the column's unit.
    pub offset: f64,
    /// Another column that is added before the factor (a deflection to an angle).
    pub plus: Option<String>,
    /// Factor on that other column.
    pub plus_scale: f64,
    /// A counter that starts anew after this many is unrolled; none where it does not.
    pub wraps_at: Option<f64>,
    /// The channel is the column's slope, by the difference over this time, s; none where it is the column itself.
    pub slope_over_s: Option<f64>,
    /// The channel is the slope with which something follows the column with this lag, s; none where it is not.
    pub slope_lag_s: Option<f64>,
    /// The column with the times of this one; none where it is on the file's clock.
    pub clock: Option<String>,
}

/// How the columns of recordings become channels.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mapping {
    /// Sample period of recordings without a time column, and the one on which all others are put, s.
    pub sample_period_s: Option<f64>,
    /// The parts of each recording that are used, s from its first sample; all of it where there is none.
    pub windows_s: Vec<[f64; 2]>,
    /// Name of the time column; `time` if none is given.
    pub time: Option<ChannelSource>,
    /// Channels whose column has another name than the channel.
    pub channels: Vec<(Channel, ChannelSource)>,
}

impl Channel {
    /// All channels.
    pub const ALL: [Self; 9] = [
        Self::Demand,
        Self::Control,
        Self::HubRate,
        Self::PlatformRate,
        Self::PlatformAccel,
        Self::MotorRate,
        Self::HubPosition,
        Self::MotorPosition,
        Self::MotorCurrent,
    ];

    /// The name of the channel's column.
    pub fn name(self) -> &'static str {
        match self {
            Self::Demand => "demand",
            Self::Control => "control",
            Self::HubRate => "hub_rate",
            Self::PlatformRate => "platform_rate",
            Self::PlatformAccel => "platform_accel",
            Self::MotorRate => "motor_rate",
            Self::HubPosition => "hub_position",
            Self::MotorPosition => "motor_position",
            Self::MotorCurrent => "motor_current",
        }
    }

    /// The unit of the channel.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Demand | Self::HubRate | Self::PlatformRate | Self::MotorRate => "rad/s",
            Self::Control => "V",
            Self::PlatformAccel => "m/s^2",
            Self::HubPosition | Self::MotorPosition => "rad",
            Self::MotorCurrent => "A",
        }
    }
}

impl ChannelSource {
    /// A column taken as it is.
    pub fn named(column: &str) -> Self {
        Self {
            column: column.to_owned(),
            unit: None,
            scale: 1.0,
            offset: 0.0,
            plus: None,
            plus_scale: 1.0,
            wraps_at: None,
            slope_over_s: None,
            slope_lag_s: None,
            clock: None,
        }
    }

    /// The unit that the column must be like, for a channel of a unit: the channel's own, or what has it as its slope.
    pub fn unit_of_column(&self, channel: &'static str) -> &'static str {
        let is_slope = self.slope_over_s.or(self.slope_lag_s).is_some();
        match channel {
            "rad/s" if is_slope => "rad",
            "m/s^2" if is_slope => "m/s",
            _ => channel,
        }
    }
}

impl Mapping {
    /// Whether demand, control and hub rate of a record are the samples that were written: not slopes of others, on one clock, not
    /// interpolated.
    pub fn keeps_samples(&self, record: &Record) -> bool {
        let loop_channels = [Channel::Demand, Channel::Control, Channel::HubRate];
        let made = |(channel, source): &(Channel, ChannelSource)| {
            let shaped =
                source.slope_over_s.is_some() || source.slope_lag_s.is_some() || source.clock.is_some();
            loop_channels.contains(channel) && shaped
        };
        let moved = |f: &Finding| matches!(f, Finding::Uneven { .. } | Finding::Resampled { .. });
        !self.channels.iter().any(made) && !record.findings.iter().any(moved)
    }

    /// The channels of a table, in SI units and uniform in time.
    ///
    /// A channel that the mapping names must be there; the others are taken where a column bears their name.
    /// Uneven time is evened out by linear interpolation; gaps become NaN; a file at another rate than
    /// [`Mapping::sample_period_s`] is put on that; all are told as findings. Windows are not looked at.
    ///
    /// # Errors
    /// A named column is missing, a unit is unknown or of another quantity, or time cannot be told.
    pub fn apply(&self, table: &Table) -> Result<Record, RecordingError> {
        let time = self.time(table)?;
        let mut channels = Vec::new();
        for channel in Channel::ALL {
            if let Some(values) = self.channel(table, channel, time.as_deref())? {
                channels.push((channel, values));
            }
        }
        let mut record = record(&table.name, time, self.sample_period_s, channels)?;
        self.differentiate(&mut record);
        record.resample(self.sample_period_s);
        Ok(record)
    }

    /// The windows of a table, each a recording of its own; the whole of it where the mapping has none.
    ///
    /// # Errors
    /// As [`Mapping::apply`], and a window that the recording does not cover.
    pub fn records(&self, table: &Table) -> Result<Vec<Record>, RecordingError> {
        let whole = self.apply(table)?;
        if self.windows_s.is_empty() {
            return Ok(vec![whole]);
        }
        self.windows_s.iter().map(|window| whole.window(*window)).collect()
    }

    /// Puts slopes in the place of the columns that the mapping takes them of.
    fn differentiate(&self, record: &mut Record) {
        let period_s = record.sample_period_s;
        for (channel, source) in &self.channels {
            for (_, values) in record.channels.iter_mut().filter(|(c, _)| c == channel) {
                if let Some(over_s) = source.slope_over_s {
                    *values = slopes(values, period_s, over_s);
                }
                if let Some(lag_s) = source.slope_lag_s {
                    *values = lagging_slopes(values, period_s, lag_s);
                }
            }
        }
    }

    fn channel(
        &self,
        table: &Table,
        channel: Channel,
        time: Option<&[f64]>,
    ) -> Result<Option<Vec<f64>>, RecordingError> {
        let mapped = self.channels.iter().find(|(c, _)| *c == channel).map(|(_, source)| source);
        match mapped {
            Some(source) => {
                let values = converted(table, source, channel.name(), channel.unit())?;
                on_the_clock(table, source, values, time).map(Some)
            }
            None if table.column(channel.name()).is_ok() => {
                converted(table, &ChannelSource::named(channel.name()), channel.name(), channel.unit())
                    .map(Some)
            }
            None => Ok(None),
        }
    }

    /// Time of every row, s; none where the file has no time.
    fn time(&self, table: &Table) -> Result<Option<Vec<f64>>, RecordingError> {
        let column = ["time", "t", "Time"].into_iter().find(|name| table.column(name).is_ok());
        match (&self.time, column) {
            (Some(source), _) => converted(table, source, "time", "s").map(Some),
            (None, Some(name)) => converted(table, &ChannelSource::named(name), "time", "s").map(Some),
            (None, None) => Ok(None),
        }
    }
}

/// A column in a channel's unit. A column without a unit, or in counts, is taken to be in the channel's.
fn converted(
    table: &Table,
    source: &ChannelSource,
    channel: &'static str,
    wanted: &'static str,
) -> Result<Vec<f64>, RecordingError> {
    let column = table.column(&source.column)?;
    let wanted = source.unit_of_column(wanted);
    let target = Unit::parse(wanted).unwrap_or(Unit::ONE);
    let written = source.unit.as_ref().or(column.unit.as_ref());
    let unit = written.map_or(Ok(target), |w| table.unit(&source.column, w))?;
    if !unit.is_like(&target) && unit.dimension != Unit::ONE.dimension {
        let unit = written.cloned().unwrap_or_default();
        let (file, column) = (table.name.clone(), source.column.clone());
        return Err(RecordingError::WrongUnit { file, column, unit, channel, wanted });
    }
    let mut values = column.values.clone();
    if let Some(other) = &source.plus {
        values.iter_mut().zip(&table.column(other)?.values).for_each(|(v, o)| *v += source.plus_scale * o);
    }
    if let Some(turn) = source.wraps_at {
        unroll(&mut values, turn);
    }
    Ok(values.iter().map(|v| unit.to_si(source.scale * v + source.offset)).collect())
}

/// Values whose times stand in a column of their own, on the file's clock.
fn on_the_clock(
    table: &Table,
    source: &ChannelSource,
    values: Vec<f64>,
    time: Option<&[f64]>,
) -> Result<Vec<f64>, RecordingError> {
    let (Some(clock), Some(time)) = (&source.clock, time) else { return Ok(values) };
    let own = converted(table, &ChannelSource::named(clock), "time", "s")?;
    Ok(on_clock(&values, &own, time))
}
