//! Recordings beside the workspace, read for tests.

use counterpoise_controller::ProportionalIntegral;
use counterpoise_recordings::{Mapping, Recording, Table};
use std::path::PathBuf;

/// A file beside the workspace; none, with a message, where it is absent.
pub fn shared(path: &str) -> Option<PathBuf> {
    let file = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../shared").join(path);
    if file.exists() {
        return Some(file);
    }
    println!("skipped: {} is absent", file.display());
    None
}

/// A practice recording.
pub fn recording(path: &str) -> Option<Recording> {
    let bytes = std::fs::read(shared(&format!("recordings/practice/{path}.parquet"))?).unwrap();
    Some(Mapping::default().apply(&Table::read(&bytes, path).unwrap()).unwrap())
}

/// The controller that was in the loop when the practice recordings were made.
pub fn controller() -> ProportionalIntegral {
    ProportionalIntegral {
        kp_v_s_rad: 18.0,
        ki_v_rad: 80.0,
        bias_v: 2.88,
        sample_period_s: 1e-3,
        integral_v: 0.0,
    }
}
