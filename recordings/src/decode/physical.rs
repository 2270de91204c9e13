//! The contents of a column of a Parquet file, and its stored values as numbers.

use bytes::Bytes;
use half::f16;
use parquet::basic::{ConvertedType, LogicalType, TimeUnit, Type};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::DataType;
use parquet::errors::ParquetError;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::schema::types::ColumnDescriptor;

/// The kind of a column's values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Holds {
    /// Numbers as stored.
    Numbers,
    /// Integers without a sign.
    Unsigned,
    /// Integers that count this part of one.
    Decimal(f64),
    /// Instants or times of day, counted in this unit.
    Time(Tick),
    /// Something else, in the plural.
    Other(&'static str),
}

/// The unit in which a column counts time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Tick {
    Milliseconds,
    Microseconds,
    Nanoseconds,
}

/// The instant from which all instants of a file are counted: the whole second before the first one. Counted from 1970, nanoseconds
/// exceed what a double holds exactly.
#[derive(Debug, Default)]
pub(super) struct Origin {
    seconds: Option<i64>,
}

impl Holds {
    /// Returns the unit of the column's numbers; `None` if its type has none.
    pub(super) fn unit(self) -> Option<&'static str> {
        match self {
            Self::Time(Tick::Milliseconds) => Some("ms"),
            Self::Time(Tick::Microseconds) => Some("us"),
            Self::Time(Tick::Nanoseconds) => Some("ns"),
            _ => None,
        }
    }
}

impl Tick {
    fn per_second(self) -> i64 {
        match self {
            Self::Milliseconds => 1_000,
            Self::Microseconds => 1_000_000,
            Self::Nanoseconds => 1_000_000_000,
        }
    }
}

impl Origin {
    /// Returns an instant counted from the origin, which the first instant sets.
    fn count(&mut self, instant: i64, tick: Tick) -> f64 {
        let seconds = *self.seconds.get_or_insert(instant.div_euclid(tick.per_second()));
        instant.wrapping_sub(seconds.wrapping_mul(tick.per_second())) as f64
    }
}

/// Returns what a column holds, by its logical type, else by its converted and physical types.
pub(super) fn content_of(column: &ColumnDescriptor) -> Holds {
    let is_read = match column.physical_type() {
        Type::INT32 | Type::INT64 => true,
        Type::FIXED_LEN_BYTE_ARRAY => usize::try_from(column.type_length()).is_ok_and(|n| n <= DECIMAL_BYTES),
        _ => false,
    };
    let decimal = |scale: i32| match is_read {
        true => Holds::Decimal(10_f64.powi(-scale)),
        false => Holds::Other("decimal numbers of more than 38 digits, or of any number of them"),
    };
    match column.logical_type_ref() {
        Some(LogicalType::Timestamp(kind)) => Holds::Time(tick(&kind.unit)),
        Some(LogicalType::Time(kind)) => Holds::Time(tick(&kind.unit)),
        Some(LogicalType::Decimal(kind)) => decimal(kind.scale),
        Some(LogicalType::Integer(kind)) if !kind.is_signed => Holds::Unsigned,
        Some(LogicalType::Date) => Holds::Other("dates"),
        Some(LogicalType::String | LogicalType::Enum | LogicalType::Json) => Holds::Other("texts"),
        _ => match column.converted_type() {
            ConvertedType::DECIMAL => decimal(column.type_scale()),
            ConvertedType::DATE => Holds::Other("dates"),
            ConvertedType::TIMESTAMP_MILLIS | ConvertedType::TIME_MILLIS => Holds::Time(Tick::Milliseconds),
            ConvertedType::TIMESTAMP_MICROS | ConvertedType::TIME_MICROS => Holds::Time(Tick::Microseconds),
            _ => physical_type(column),
        },
    }
}

fn physical_type(column: &ColumnDescriptor) -> Holds {
    match column.physical_type() {
        Type::INT96 => Holds::Other("times of 96 bits, an outdated type"),
        Type::BYTE_ARRAY => Holds::Other("texts or bytes"),
        Type::FIXED_LEN_BYTE_ARRAY if column.logical_type_ref() != Some(&LogicalType::Float16) => {
            Holds::Other("bytes")
        }
        _ => Holds::Numbers,
    }
}

fn tick(unit: &TimeUnit) -> Tick {
    match unit {
        TimeUnit::MILLIS => Tick::Milliseconds,
        TimeUnit::MICROS => Tick::Microseconds,
        TimeUnit::NANOS => Tick::Nanoseconds,
    }
}

/// Returns the values of a column over all row groups, NaN if there is none.
pub(super) fn column(
    reader: &SerializedFileReader<Bytes>,
    index: usize,
    present: i16,
    holds: Holds,
    origin: &mut Origin,
) -> Result<Vec<f64>, ParquetError> {
    let mut long = |v: i64| match holds {
        Holds::Unsigned => v as u64 as f64,
        Holds::Decimal(part) => v as f64 * part,
        Holds::Time(tick) => origin.count(v, tick),
        Holds::Numbers | Holds::Other(_) => v as f64,
    };
    let mut all = Vec::new();
    for group in 0..reader.num_row_groups() {
        let group = reader.get_row_group(group)?;
        let rows = usize::try_from(group.metadata().num_rows()).unwrap_or(0);
        let values = match group.get_column_reader(index)? {
            ColumnReader::DoubleColumnReader(r) => numbers(r, rows, present, |v| v)?,
            ColumnReader::FloatColumnReader(r) => numbers(r, rows, present, f64::from)?,
            ColumnReader::Int32ColumnReader(r) if holds == Holds::Unsigned => {
                numbers(r, rows, present, |v| f64::from(v as u32))?
            }
            ColumnReader::Int32ColumnReader(r) => numbers(r, rows, present, |v| long(i64::from(v)))?,
            ColumnReader::Int64ColumnReader(r) => numbers(r, rows, present, &mut long)?,
            ColumnReader::BoolColumnReader(r) => numbers(r, rows, present, f64::from)?,
            ColumnReader::FixedLenByteArrayColumnReader(r) => {
                if let Holds::Decimal(part) = holds {
                    all.extend(numbers(r, rows, present, |v| whole_number(v.data()) as f64 * part)?);
                    continue;
                }
                let half =
                    |bytes: &[u8]| bytes.try_into().map_or(f64::NAN, |b| f16::from_le_bytes(b).to_f64());
                numbers(r, rows, present, |v| half(v.data()))?
            }
            _ => return Err(ParquetError::General("its type is not that of its description".to_owned())),
        };
        all.extend(values);
    }
    Ok(all)
}

/// Bytes of the longest integer of a decimal number that is read: 38 digits.
const DECIMAL_BYTES: usize = size_of::<i128>();

/// Returns an integer of at most [`DECIMAL_BYTES`] bytes, two's complement with the most significant byte first.
fn whole_number(bytes: &[u8]) -> i128 {
    let sign = if bytes.first().is_some_and(|first| *first >= 0x80) { -1 } else { 0 };
    bytes.iter().fold(sign, |number, byte| (number << 8) | i128::from(*byte))
}

/// Returns the values of a column in one row group, NaN if there is none.
fn numbers<T: DataType>(
    mut reader: ColumnReaderImpl<T>,
    rows: usize,
    present: i16,
    convert: impl FnMut(T::T) -> f64,
) -> Result<Vec<f64>, ParquetError> {
    let (mut values, mut levels) = (Vec::new(), Vec::new());
    while levels.len() < rows || (present == 0 && values.len() < rows) {
        let levels_wanted = (present > 0).then_some(&mut levels);
        let (records, ..) = reader.read_records(rows, levels_wanted, None, &mut values)?;
        if records == 0 {
            break;
        }
        if present == 0 {
            levels.resize(values.len(), 0);
        }
    }
    let mut values = values.into_iter().map(convert);
    Ok(levels
        .iter()
        .map(|level| if *level == present { values.next().unwrap_or(f64::NAN) } else { f64::NAN })
        .collect())
}
