//! Recordings of a machine: bytes of a file to named channels in SI units on one uniform clock.
//!
//! In come the bytes of a CSV, Parquet, MATLAB (version 5 or 7.3), HDF5 or NumPy file and a [`Mapping`] of its columns; out comes a
//! [`Recording`], or an [`Error`] that says what is wrong with the file and where. What the user should know although the
//! recording can be used is returned as [`Remark`]s.
//!
//! *Invariant*: nothing here knows a model of the machine, a path or a file system: bytes are handed in.
//!
//! Modules in reading order: [`unit`](mod@unit) (with the table of units by name) and [`channel`] (what is measured), [`table`] (columns as written, from the decoders in
//! `decode`), [`mapping`] (which column is which channel, with `shaping`, `checks` and `time_unit`), [`clock`] (uniform time), [`signals`] (one array with named columns), [`recording`], [`error`], [`remark`].
//!
//! ```
//! use counterpoise_recordings::{Channel, Mapping, RecordingTable};
//! let text = "time [ms],hub_rate [deg/s]\n0,0\n1,180\n2,90\n";
//! let table = RecordingTable::read(text.as_bytes(), "run.csv")?;
//! let recording = Mapping::default().apply(&table)?;
//! assert_eq!(recording.sample_period_s, 1e-3);
//! assert_eq!(recording.samples(Channel::HubRate).map(|rate| rate[1]), Some(std::f64::consts::PI));
//! # Ok::<(), counterpoise_recordings::Error>(())
//! ```

pub mod channel;
mod checks;
pub mod clock;
mod decode;
pub mod error;
pub mod mapping;
pub mod recording;
pub mod remark;
mod shaping;
pub mod signals;
pub mod table;
mod time_unit;
mod tolerance;
pub mod unit;

pub use channel::{Channel, ChannelUnits, LoopQuantity, Travel};
pub use decode::{CsvParts, NamedArray, is_text, read_arrays};
pub use error::Error;
pub use mapping::{ChannelSource, Mapping};
pub use recording::Recording;
pub use remark::{Remark, UnreadReason};
pub use shaping::repeat_last;
pub use signals::{ColumnName, Signals};
pub use table::{RecordingColumn, RecordingTable};
pub use time_unit::DoubtfulUnit;
pub use unit::Unit;
