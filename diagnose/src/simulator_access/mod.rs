//! What the diagnosis asks of a simulator, and how it asks for many runs at once.
//!
//! Modules in reading order: `pool`, many jobs at once; `access`, the questions; [`objective`], the simulator that answers them by
//! replays of the recordings.

mod access;
pub mod objective;
mod pool;

pub use access::{
    Assessment, ChannelResidual, ControlSource, MechanismVariant, SimulatorAccess, Span, StartShift,
};
pub use pool::{Pool, Serial, join, map, map_all, map_with_progress};
