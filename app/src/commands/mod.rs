//! The commands: each loads what it needs, calls the pipeline, prints the result, and returns an exit code.

pub mod adapt;
pub mod check;
pub mod claims;
pub mod commission;
pub mod compare;
pub mod design;
pub mod diagnose;
pub mod experiment;
pub mod export;
pub mod first_design;
pub mod fra;
pub mod identify;
pub mod machine;
pub mod model;
pub mod new;
pub mod replay;
pub mod stages;
pub mod structure;
pub mod studio;
pub mod sweep;
pub mod synth;
mod synth_front;
mod synth_outputs;
pub mod verify;
