//! Which column of a file is which channel of the mechanism, and how its numbers become the channel's.

use super::timing::{Record, record};
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

/// Where a channel comes from: value in SI = unit x (scale x column + offset).
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
}

/// How the columns of recordings become channels.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mapping {
    /// Sample period of recordings without a time column, s.
    pub sample_period_s: Option<f64>,
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
        Self { column: column.to_owned(), unit: None, scale: 1.0, offset: 0.0 }
    }
}

impl Mapping {
    /// The channels of a table, in SI units and uniform in time.
    ///
    /// A channel that the mapping names must be there; the others are taken where a column bears their name.
    /// Uneven time is evened out by linear interpolation; gaps become NaN; both are told as findings.
    ///
    /// # Errors
    /// A named column is missing, a unit is unknown or of another quantity, or time cannot be told.
    pub fn apply(&self, table: &Table) -> Result<Record, RecordingError> {
        let mut channels = Vec::new();
        for channel in Channel::ALL {
            if let Some(values) = self.channel(table, channel)? {
                channels.push((channel, values));
            }
        }
        record(&table.name, self.time(table)?, self.sample_period_s, channels)
    }

    fn channel(&self, table: &Table, channel: Channel) -> Result<Option<Vec<f64>>, RecordingError> {
        let mapped = self.channels.iter().find(|(c, _)| *c == channel).map(|(_, source)| source);
        match mapped {
            Some(source) => converted(table, source, channel.name(), channel.unit()).map(Some),
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
    let target = Unit::parse(wanted).unwrap_or(Unit::ONE);
    let written = source.unit.as_ref().or(column.unit.as_ref());
    let unit = written.map_or(Ok(target), |w| table.unit(&source.column, w))?;
    if !unit.is_like(&target) && unit.dimension != Unit::ONE.dimension {
        let unit = written.cloned().unwrap_or_default();
        let (file, column) = (table.name.clone(), source.column.clone());
        return Err(RecordingError::WrongUnit { file, column, unit, channel, wanted });
    }
    Ok(column.values.iter().map(|v| unit.to_si(source.scale * v + source.offset)).collect())
}
