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
    /// Another column, of the same unit, that is added before the factor (a deflection to an angle).
    pub plus: Option<String>,
    /// A counter that starts anew after this many is unrolled; none where it does not.
    pub wraps_at: Option<f64>,
    /// The channel is the column's slope, by the difference over this time, s; none where it is the column itself.
    pub slope_over_s: Option<f64>,
}

/// How the columns of recordings become channels.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mapping {
    /// Sample period of recordings without a time column, and the one on which uneven time is evened out, s.
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
        Self {
            column: column.to_owned(),
            unit: None,
            scale: 1.0,
            offset: 0.0,
            plus: None,
            wraps_at: None,
            slope_over_s: None,
        }
    }

    /// The unit that the column must be like, for a channel of a unit: the channel's own, or what has it as its slope.
    pub fn unit_of_column(&self, channel: &'static str) -> &'static str {
        match (self.slope_over_s, channel) {
            (Some(_), "rad/s") => "rad",
            (Some(_), "m/s^2") => "m/s",
            _ => channel,
        }
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
        let mut record = record(&table.name, self.time(table)?, self.sample_period_s, channels)?;
        self.differentiate(&mut record);
        Ok(record)
    }

    /// Puts slopes in the place of the columns that the mapping takes them of.
    fn differentiate(&self, record: &mut Record) {
        let period_s = record.sample_period_s;
        for (channel, source) in &self.channels {
            let Some(over_s) = source.slope_over_s else { continue };
            for (_, values) in record.channels.iter_mut().filter(|(c, _)| c == channel) {
                *values = slopes(values, period_s, over_s);
            }
        }
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
        values.iter_mut().zip(&table.column(other)?.values).for_each(|(v, o)| *v += o);
    }
    if let Some(turn) = source.wraps_at {
        unroll(&mut values, turn);
    }
    Ok(values.iter().map(|v| unit.to_si(source.scale * v + source.offset)).collect())
}

/// Adds a turn wherever a counter has started anew: a step of more than half a turn is none of the machine's.
fn unroll(values: &mut [f64], turn: f64) {
    let (mut turns, mut last) = (0.0, f64::NAN);
    for value in values.iter_mut().filter(|v| v.is_finite()) {
        let step = *value - last;
        if step.is_finite() {
            turns -= (step / turn).round();
        }
        last = *value;
        *value += turns * turn;
    }
}

/// Central differences over the given time, at least one sample to either side; one-sided at the ends.
fn slopes(values: &[f64], period_s: f64, over_s: f64) -> Vec<f64> {
    let half = (0.5 * over_s / period_s).round().max(1.0) as usize;
    let last = values.len().saturating_sub(1);
    let at = |k: usize| {
        let (low, high) = (k.saturating_sub(half), (k + half).min(last));
        if high == low { 0.0 } else { (values[high] - values[low]) / ((high - low) as f64 * period_s) }
    };
    (0..values.len()).map(at).collect()
}
