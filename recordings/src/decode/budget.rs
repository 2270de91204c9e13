//! Limits of the memory that the columns of a file may take: checked by an estimate before anything is allocated.

use crate::Error;

/// Memory that any file may take, bytes: a quarter of an hour of nine channels at a kilohertz takes a quarter of this.
const SMALLEST: u64 = 256 << 20;
/// Times its own size that a file may take. Compressed recordings take up to about 20 times, constant channels more.
const EXPANSION: u64 = 200;
/// Memory that no file may exceed, bytes: its columns are copied once when they become channels.
const LARGEST: u64 = 1 << 30;
/// Bytes of a value.
const VALUE: u64 = 8;

/// The memory that the columns of one file may still take.
pub(super) struct Budget<'a> {
    file: &'a str,
    limit: u64,
    taken: u64,
}

impl<'a> Budget<'a> {
    /// Returns the budget of a file of so many bytes.
    pub(super) fn new(file: &'a str, bytes: usize) -> Self {
        let limit = (bytes as u64).saturating_mul(EXPANSION).clamp(SMALLEST, LARGEST);
        Self { file, limit, taken: 0 }
    }

    /// Takes the memory of so many values of a column.
    ///
    /// # Errors
    /// [`Error::TooLarge`], with the estimate, if they exceed what is left.
    pub(super) fn take(&mut self, column: &str, values: u64) -> Result<(), Error> {
        self.admits(column, values)?;
        self.taken = self.taken.saturating_add(values.saturating_mul(VALUE));
        Ok(())
    }

    /// Returns whether there is memory for so many values of a column that are dropped again.
    ///
    /// # Errors
    /// As [`Budget::take`].
    pub(super) fn admits(&self, column: &str, values: u64) -> Result<(), Error> {
        let bytes = self.taken.saturating_add(values.saturating_mul(VALUE));
        if bytes <= self.limit {
            return Ok(());
        }
        let (file, column) = (self.file.to_owned(), column.to_owned());
        Err(Error::TooLarge { file, column, bytes, limit: self.limit })
    }
}
