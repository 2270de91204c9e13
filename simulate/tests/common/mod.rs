//! Helpers that the tests of the simulator share: the practice recordings, and the controller of their loop.

use counterpoise_controller::ProportionalIntegral;
use counterpoise_recordings::{Mapping, Recording, RecordingTable};

/// Returns a practice recording, made by an independent simulator: `p04/triangle`.
pub fn recording(path: &str) -> Recording {
    let base = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/data/practice");
    let bytes = std::fs::read(format!("{base}/{path}.parquet")).unwrap();
    Mapping::default().apply(&RecordingTable::read(&bytes, path).unwrap()).unwrap()
}

/// Returns the controller that was in the loop when the practice recordings were made.
pub fn controller() -> ProportionalIntegral {
    ProportionalIntegral {
        kp_v_s_rad: 18.0,
        ki_v_rad: 80.0,
        bias_v: 2.88,
        sample_period_s: 1e-3,
        integral_v: 0.0,
    }
}
