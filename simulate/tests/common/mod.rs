//! Helpers that the tests of the simulator share: the practice recordings, the controller of their loop, and random numbers.

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
        ..ProportionalIntegral::default()
    }
}

/// Numbers between 0 and 1, the same for one seed (Marsaglia's xorshift).
pub struct RandomGenerator(pub u64);

impl RandomGenerator {
    /// Returns the next number.
    pub fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Returns a number between two others.
    pub fn draw_between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    /// Returns a whole number below another.
    pub fn draw_below(&mut self, count: usize) -> usize {
        (self.next() * count as f64) as usize
    }

    /// Returns a factor within a decade around 1.
    pub fn factor(&mut self) -> f64 {
        10f64.powf(self.draw_between(-0.5, 0.5))
    }
}
