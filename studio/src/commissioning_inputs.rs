//! The inputs of a commissioning in the window.

use serde::{Deserialize, Serialize};

/// Inputs of the page Commission.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CommissioningInputs {
    /// The machine program, with its arguments.
    pub machine: String,
    /// Largest angle from the start, rad.
    pub angle_rad: f64,
    /// Largest rate, rad/s.
    pub rate_rad_s: f64,
    /// Largest current, A; 0 for no limit.
    pub current_a: f64,
    /// Duration of the experiment that tells machines apart, s.
    pub duration_s: f64,
    /// Folder of the rounds, in the folder of the project.
    pub folder: String,
}

impl Default for CommissioningInputs {
    fn default() -> Self {
        Self {
            machine: String::new(),
            angle_rad: 0.1,
            rate_rad_s: 0.2,
            current_a: 0.0,
            duration_s: 10.0,
            folder: "commission".to_owned(),
        }
    }
}
