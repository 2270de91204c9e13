//! The assignment of a file's columns to the mechanism's channels, and the conversion of their numbers.

use crate::time_unit::doubtful_unit;
use ndarray::{Array1, Array2, ArrayViewMut1};

use crate::checks::{check_time_unit, find_missing, nearly_named, without_infinities, without_outliers};
use crate::clock::{UniformSignals, check_length, stack_columns, to_uniform_clock};
use crate::shaping::{Resampling, interpolate_on_clock, lagging_slopes, resample, slopes, unroll};
use crate::table::TIME_NAMES;
use crate::tolerance::STATED_PERIOD;
use crate::{Channel, ChannelUnits, Error, LoopQuantity, Recording, RecordingTable, Remark, Unit};

/// Most remarks about columns that are listed.
const MOST_REMARKS: usize = 30;

/// The column that holds a channel, and how its numbers become the channel's: value in SI = unit x (scale x (column + plus) +
/// offset), of which the channel may be the slope over time.
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
    /// A counter that starts again after this many is unrolled; `None` if the column is not such a counter.
    pub wraps_at: Option<f64>,
    /// The channel is the column's slope, by the difference over this time, s; `None` if it is the column itself.
    pub slope_over_s: Option<f64>,
    /// The channel is the slope with which something follows the column with this lag, s; `None` if it is not.
    pub slope_lag_s: Option<f64>,
    /// The column with the times of this one; `None` if it is on the file's clock.
    pub clock: Option<String>,
}

/// Mapping of the columns of recordings to channels.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mapping {
    /// Sample period of recordings without a time column, and the one on which all others are put, s.
    pub sample_period_s: Option<f64>,
    /// The parts of each recording that are used, s from its first sample; all of it if there are none.
    pub windows_s: Vec<[f64; 2]>,
    /// The time column; `None` for a column of the name `time`, `t`, `Time` or `__time`.
    pub time: Option<ChannelSource>,
    /// Channels whose column has another name than the channel.
    pub channels: Vec<(Channel, ChannelSource)>,
    /// Units of the machine's channels.
    pub units: ChannelUnits,
}

impl ChannelSource {
    /// Returns a column taken as it is.
    pub fn from_column(column: &str) -> Self {
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

    /// Returns the unit that the column must be like, for a channel of a unit: the channel's own, or what has it as its slope.
    pub fn unit_of_column(&self, channel: &'static str) -> &'static str {
        let is_slope = self.slope_over_s.or(self.slope_lag_s).is_some();
        match channel {
            "rad/s" if is_slope => "rad",
            "m/s" if is_slope => "m",
            "m/s^2" if is_slope => "m/s",
            _ => channel,
        }
    }
}

impl Mapping {
    /// Returns whether a channel or the time is taken from the column of this name.
    fn names_column(&self, name: &str) -> bool {
        let sources = self.channels.iter().map(|(_, source)| source).chain(&self.time);
        let columns = |source: &ChannelSource| {
            [Some(&source.column), source.plus.as_ref(), source.clock.as_ref()]
                .into_iter()
                .flatten()
                .any(|used| used == name)
        };
        sources.into_iter().any(columns)
    }

    /// Returns whether demand, control and hub rate of a recording are the samples that were written: not slopes of others, on one
    /// clock, not interpolated.
    pub fn keeps_samples(&self, recording: &Recording) -> bool {
        let loop_channels = [Channel::Demand, Channel::Control, Channel::HubRate];
        let is_made = |(channel, source): &(Channel, ChannelSource)| {
            let is_shaped =
                source.slope_over_s.is_some() || source.slope_lag_s.is_some() || source.clock.is_some();
            loop_channels.contains(channel) && is_shaped
        };
        let is_moved = |r: &Remark| matches!(r, Remark::Uneven { .. } | Remark::Resampled { .. });
        !self.channels.iter().any(is_made) && !recording.remarks.iter().any(is_moved)
    }

    /// Returns the channels of a table, in SI units and uniform in time.
    ///
    /// A channel that the mapping names must be there; the others are taken if a column has their name.
    /// Uneven time is evened out by linear interpolation; gaps become NaN; a file at another rate than
    /// [`Mapping::sample_period_s`] is put on that; all of this is said in [`Recording::remarks`]. Windows are ignored.
    ///
    /// # Errors
    /// A named column is missing, a unit is unknown or of another quantity, or the clock cannot be read.
    pub fn apply(&self, table: &RecordingTable) -> Result<Recording, Error> {
        let time_s = self.time(table)?;
        let (mut channels, mut signals, mut odd) = (Vec::new(), Vec::new(), Vec::new());
        for channel in Channel::ALL {
            if let Some(mut values) = self.channel(table, channel, time_s.as_ref())? {
                odd.extend(without_infinities(channel, &mut values));
                odd.extend(without_outliers(channel, &mut values));
                channels.push(channel);
                signals.push(values);
            }
        }
        let mut remarks = table.remarks.clone();
        remarks.extend(nearly_named(table, |name| self.names_column(name), &channels, time_s.as_ref()));
        let mut remarks = limit_remarks(remarks);
        remarks.extend(odd);
        let signals = stack_columns(signals.iter().map(|values| values.view()));
        let UniformSignals { period_s, start_s, mut signals, remarks: of_clock } =
            self.put_on_clock(table, time_s, signals)?;
        remarks.extend(of_clock);
        let columns = channels.iter().zip(signals.columns());
        remarks.extend(columns.filter_map(|(channel, values)| find_missing(*channel, values)));
        for (channel, values) in channels.iter().zip(signals.columns_mut()) {
            self.differentiate(*channel, values, period_s);
        }
        let mut recording = Recording::from_signals(table.name.clone(), period_s, &channels, signals);
        (recording.start_s, recording.remarks) = (start_s, remarks);
        self.resample(&mut recording)?;
        Ok(recording)
    }

    /// Returns the windows of a table, each a recording of its own; the whole of it if the mapping has no windows.
    ///
    /// # Errors
    /// As [`Mapping::apply`], and [`Error::Window`] if the recording does not cover a window.
    pub fn recordings(&self, table: &RecordingTable) -> Result<Vec<Recording>, Error> {
        let whole = self.apply(table)?;
        if self.windows_s.is_empty() {
            return Ok(vec![whole]);
        }
        self.windows_s.iter().map(|window| whole.window(*window)).collect()
    }

    /// Returns the signals on a uniform clock: the file's, or the given sample period if the file has no time.
    fn put_on_clock(
        &self,
        table: &RecordingTable,
        time_s: Option<Array1<f64>>,
        signals: Array2<f64>,
    ) -> Result<UniformSignals, Error> {
        match (time_s, self.sample_period_s) {
            (Some(time_s), wanted_s) => to_uniform_clock(&table.name, time_s.view(), wanted_s, signals),
            (None, Some(period_s)) => {
                let remarks = vec![Remark::PeriodAssumed { period_s }];
                Ok(UniformSignals { period_s, start_s: 0.0, signals, remarks })
            }
            (None, None) => Err(Error::NoTime { file: table.name.clone() }),
        }
    }

    /// Replaces a channel by its slope if the mapping asks for it.
    fn differentiate(&self, channel: Channel, mut values: ArrayViewMut1<'_, f64>, period_s: f64) {
        for (_, source) in self.channels.iter().filter(|(c, _)| *c == channel) {
            if let Some(over_s) = source.slope_over_s {
                let of = slopes(&values.to_vec(), period_s, over_s);
                values.assign(&of);
            }
            if let Some(lag_s) = source.slope_lag_s {
                let of = lagging_slopes(&values.to_vec(), period_s, lag_s);
                values.assign(&of);
            }
        }
    }

    /// Puts every channel on the given sample period if the file has another.
    fn resample(&self, recording: &mut Recording) -> Result<(), Error> {
        let file_s = recording.sample_period_s;
        let is_other = |wanted_s: &f64| (file_s - wanted_s).abs() > STATED_PERIOD * wanted_s;
        let Some(project_s) = self.sample_period_s.filter(is_other) else { return Ok(()) };
        let duration_s = recording.len() as f64 * file_s;
        check_length(&recording.name, duration_s, project_s, recording.channels().count())?;
        let resampled = recording.channels().map(|(channel, samples)| {
            let kind = if channel.is_held() { Resampling::Held } else { Resampling::Read };
            (channel, resample(kind, samples, file_s, project_s))
        });
        let resampled: Vec<_> = resampled.collect();
        resampled.iter().for_each(|(channel, _)| drop(recording.remove(*channel)));
        for (channel, samples) in resampled {
            recording.set(channel, samples);
        }
        recording.sample_period_s = project_s;
        recording.remarks.push(Remark::Resampled {
            file_s,
            project_s,
            doubt: doubtful_unit(file_s, project_s),
        });
        Ok(())
    }

    /// Returns a channel in SI units; `None` if the mapping does not name it and no column has its name.
    fn channel(
        &self,
        table: &RecordingTable,
        channel: Channel,
        time_s: Option<&Array1<f64>>,
    ) -> Result<Option<Array1<f64>>, Error> {
        let from = match channel {
            Channel::HubRate if self.position_is_read(table) => Channel::HubPosition,
            Channel::HubPosition if self.position_is_read(table) => return Ok(None),
            other => other,
        };
        let wanted =
            ColumnPurpose { channel: channel.name(), unit: self.units.of(channel), usual: channel.unit() };
        match self.source_of(from) {
            Some(source) => {
                let values = convert_column(table, source, &wanted)?;
                on_file_clock(table, source, values, time_s).map(Some)
            }
            None if table.find(from.name()).is_some() => {
                convert_column(table, &ChannelSource::from_column(from.name()), &wanted).map(Some)
            }
            None => Ok(None),
        }
    }

    /// Returns the source that the mapping names for a channel.
    fn source_of(&self, channel: Channel) -> Option<&ChannelSource> {
        self.channels.iter().find(|(c, _)| *c == channel).map(|(_, source)| source)
    }

    /// Returns whether the position stands for the reading of a loop whose sensor measures it: it is given, and no `hub_rate` is.
    fn position_is_read(&self, table: &RecordingTable) -> bool {
        let given =
            |channel: Channel| self.source_of(channel).is_some() || table.find(channel.name()).is_some();
        self.units.reading == LoopQuantity::Position
            && !given(Channel::HubRate)
            && given(Channel::HubPosition)
    }

    /// Returns the time of every row, s; `None` if the file has no time.
    fn time(&self, table: &RecordingTable) -> Result<Option<Array1<f64>>, Error> {
        let column = TIME_NAMES.into_iter().find(|name| table.find(name).is_some());
        let by_name = column.map(ChannelSource::from_column);
        let Some(source) = self.time.as_ref().or(by_name.as_ref()) else { return Ok(None) };
        let time_s = convert_column(table, source, &ColumnPurpose::TIME)?;
        let has_unit = source.unit.is_some() || table.column(&source.column)?.unit.is_some();
        if let Some(project_s) = self.sample_period_s.filter(|_| !has_unit && source.scale == 1.0) {
            check_time_unit(&table.name, &time_s, project_s)?;
        }
        Ok(Some(time_s))
    }
}

/// Returns the first remarks about columns, and how many others there are.
fn limit_remarks(mut remarks: Vec<Remark>) -> Vec<Remark> {
    let further = remarks.len().saturating_sub(MOST_REMARKS);
    if further > 0 {
        // Columns with nearly the name of a channel come first: they are the likeliest to be missed.
        remarks.sort_by_key(|remark| !matches!(remark, Remark::NearlyNamed { .. }));
        remarks.truncate(MOST_REMARKS);
        remarks.push(Remark::Further { columns: further });
    }
    remarks
}

/// The purpose that a column is wanted for.
struct ColumnPurpose {
    /// Name of the channel, for messages.
    channel: &'static str,
    /// Unit on this machine.
    unit: &'static str,
    /// Unit in a rate loop of a turning axis, in which every machine's channels may be written.
    usual: &'static str,
}

impl ColumnPurpose {
    const TIME: Self = Self { channel: "time", unit: "s", usual: "s" };
}

/// Returns a column in a channel's unit. A column without a unit, or in counts, is taken to be in the channel's.
fn convert_column(
    table: &RecordingTable,
    source: &ChannelSource,
    wanted: &ColumnPurpose,
) -> Result<Array1<f64>, Error> {
    let column = table.column(&source.column)?;
    let of_column = source.unit_of_column(wanted.unit);
    let target = Unit::parse(of_column).unwrap_or(Unit::ONE);
    let usual = Unit::parse(source.unit_of_column(wanted.usual)).unwrap_or(Unit::ONE);
    let written = source.unit.as_ref().or(column.unit.as_ref());
    let unit = written.map_or(Ok(target), |w| table.unit(&source.column, w))?;
    if !unit.is_like(&target) && !unit.is_like(&usual) && unit.dimension != Unit::ONE.dimension {
        let unit = written.cloned().unwrap_or_default();
        let (file, column) = (table.name.clone(), source.column.clone());
        return Err(Error::WrongUnit { file, column, unit, channel: wanted.channel, wanted: of_column });
    }
    let mut values = column.values.clone();
    if let Some(other) = &source.plus {
        values.iter_mut().zip(&table.column(other)?.values).for_each(|(v, o)| *v += source.plus_scale * o);
    }
    if let Some(turn) = source.wraps_at {
        values = unroll(values, turn);
    }
    values.mapv_inplace(|v| unit.to_si(source.scale * v + source.offset));
    Ok(values)
}

/// Returns values on the file's clock, if their times stand in a column of their own.
fn on_file_clock(
    table: &RecordingTable,
    source: &ChannelSource,
    values: Array1<f64>,
    time_s: Option<&Array1<f64>>,
) -> Result<Array1<f64>, Error> {
    let (Some(clock), Some(time_s)) = (&source.clock, time_s) else { return Ok(values) };
    let own_s = convert_column(table, &ChannelSource::from_column(clock), &ColumnPurpose::TIME)?;
    Ok(interpolate_on_clock(values.view(), own_s.view(), time_s.view()))
}
