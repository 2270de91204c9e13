//! The rows and columns of the table of designs, in words.

use counterpoise_models::ControlledQuantity;
use counterpoise_pipeline::studies::designs::{DesignFailure, TableMotion, TableObjective};

use super::errors::describe_pipeline_error;

/// Returns the name of the motion under which designs are simulated.
pub fn name_motion(motion: TableMotion) -> &'static str {
    match motion {
        TableMotion::Own => "the project's own motion",
        TableMotion::Sines => "the sines",
    }
}

/// Describes what the tuned structures of a table make least.
pub fn describe_objective(
    objective: TableObjective,
    controlled: ControlledQuantity,
    motion: TableMotion,
) -> String {
    match objective {
        TableObjective::Motion => format!("{} under {}", controlled.name(), name_motion(motion)),
        TableObjective::Band([low, high]) => format!("RMS of |S| from {low} to {high} rad/s"),
    }
}

/// Describes why a row of the table has no controller.
pub fn describe_design_failure(why: &DesignFailure) -> String {
    match why {
        DesignFailure::Design(error) => describe_pipeline_error(error),
        DesignFailure::BestLoop(error) => error.to_string(),
    }
}
