//! Test vectors: readings, settings and what the reference answers.

use counterpoise_controller::{Controller, Number, READINGS};

use crate::Precision;

/// Number of samples of the vectors that travel with the code.
pub const SHIPPED_SAMPLES: usize = 48;

/// One sample of a test.
#[derive(Debug, Clone, PartialEq)]
pub struct Vector {
    /// Out-of-balance to set before the sample, kg m.
    pub set_out_of_balance_kg_m: Option<f64>,
    /// The readings.
    pub readings: [f64; READINGS],
    /// Control of the controller, V.
    pub control_v: f64,
}

/// Largest readings of the generated vectors, in the order of the controller's readings.
pub const LARGEST: [f64; READINGS] = [0.8, 0.8, 0.5, 8.0, 100.0, 0.4, 6.0];

/// Returns vectors for a controller in the numbers N: irregular readings that fill [`LARGEST`], a stretch of large demand that
/// reaches the limiter, and two changes of the out-of-balance. The same for every call.
pub fn self_test_vectors<N: Number>(controller: &Controller, samples: usize) -> Vec<Vector> {
    let mut runner = controller.runner_in::<N>();
    let mut source = Source(0x2545_F491_4F6C_DD1D);
    let (low, high) = controller.parts().out_of_balance_range_kg_m;
    let design = controller.parts().design_out_of_balance_kg_m;
    let taken = controller.parts().reading_count();
    (0..samples)
        .map(|k| {
            let mut readings = [0.0; READINGS];
            let pairs = readings.iter_mut().zip(LARGEST).take(taken);
            pairs.for_each(|(reading, largest)| *reading = round_to_single(largest * source.next()));
            let set = match k {
                k if k == samples / 3 => Some(round_to_single((0.7 * design).clamp(low, high))),
                k if k == 2 * samples / 3 => Some(round_to_single((1.3 * design + 1.0).clamp(low, high))),
                _ => None,
            };
            if let Some(set) = set {
                runner.set_out_of_balance(set);
            }
            Vector { set_out_of_balance_kg_m: set, readings, control_v: runner.step_array(&readings) }
        })
        .collect()
}

/// Returns the vectors that travel with code of a precision.
pub(crate) fn shipped_vectors(controller: &Controller, precision: Precision) -> Vec<Vector> {
    match precision {
        Precision::Double => self_test_vectors::<f64>(controller, SHIPPED_SAMPLES),
        Precision::Single => self_test_vectors::<f32>(controller, SHIPPED_SAMPLES),
    }
}

/// Returns the nearest single-precision number, so that every target reads the same readings.
fn round_to_single(value: f64) -> f64 {
    f64::from(value as f32)
}

/// Marsaglia's xorshift generator.
struct Source(u64);

impl Source {
    /// Returns a number between -1 and 1.
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}
