//! Processors for work that has independent parts, handed in by whoever owns them.

/// Calls a part with each of the numbers 0 .. count - 1, each once, in any order and on any thread.
type Run<'a> = &'a (dyn Fn(usize, &(dyn Fn(usize) + Sync)) + Sync);

/// Processors for work that has independent parts. Results do not depend on how many there are.
#[derive(Clone, Copy)]
pub struct ParallelRun<'a> {
    /// How many parts run side by side: so many are worth beginning at a time.
    pub count: usize,
    /// Runs the parts. One that is left out is computed when it is needed.
    pub run: Run<'a>,
}

impl ParallelRun<'_> {
    /// The calling thread alone.
    pub const SERIAL: Self = Self { count: 1, run: &|count, part| (0..count).for_each(part) };
}
