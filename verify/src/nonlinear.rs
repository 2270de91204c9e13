//! Time histories on the nonlinear plant.

use counterpoise_controller::Controller;
use counterpoise_models::plant::Plant;

use crate::history::History;
use crate::{Error, Procedure};

/// Runs the procedure.
///
/// # Errors
/// Those of the simulator.
pub fn histories(
    _plant: &Plant,
    _controller: &Controller,
    _procedure: &Procedure,
) -> Result<Vec<History>, Error> {
    Ok(Vec::new())
}
