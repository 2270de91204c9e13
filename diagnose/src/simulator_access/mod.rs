//! The simulator as the diagnosis uses it.
//!
//! Modules in reading order: `access`, the questions; [`objective`], the simulator that answers them by
//! replays of the recordings.

mod access;
pub mod objective;

pub use access::{
    Assessment, ChannelResidual, ControlSource, MechanismVariant, NearRecording, PlacedVariant,
    SimulatorAccess, Span, StartShift, VariantDirection,
};
