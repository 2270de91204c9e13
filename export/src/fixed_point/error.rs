//! Why a controller has no fixed-point form.

/// Why a controller has no fixed-point form.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FixedError {
    /// A number that stayed 0 in the runs that the ranges came from.
    #[error(
        "'{name}' stayed 0 in the runs given, so its format is unknown: give runs that move it (a feedforward needs its disturbance)"
    )]
    NeverMoved {
        /// Name of the number.
        name: String,
    },
    /// A sum whose coefficients and ranges do not fit one accumulator.
    #[error(
        "'{name}': its terms are too far apart in size for one 64-bit sum ({missing_bits} bits missing): use single precision, \
         or another realisation of its path"
    )]
    NoRoom {
        /// Name of what is computed.
        name: String,
        /// Bits that would be needed besides.
        missing_bits: i32,
    },
    /// A divisor that its range does not keep away from 0.
    #[error(
        "'{name}' divides by '{divisor}', which intervals can only prove to lie from {low:.3e} to {high:.3e}: limit it away from \
         0, or use single precision"
    )]
    Divisor {
        /// Name of what is computed.
        name: String,
        /// Name of the divisor.
        divisor: String,
        /// Lowest value that is possible.
        low: f64,
        /// Highest value that is possible.
        high: f64,
    },
    /// A controller whose errors grow without bound.
    #[error(
        "by itself, without the plant, the controller is unstable at an out-of-balance of {out_of_balance_kg_m} kg m, which can be \
         set (a pole at {radius:.6} from 0): rounding errors would grow to {worst_v:.1e} V"
    )]
    Unstable {
        /// The out-of-balance, kg m.
        out_of_balance_kg_m: f64,
        /// Modulus of the largest pole.
        radius: f64,
        /// Predicted worst deviation, V.
        worst_v: f64,
    },
    /// A deviation larger than allowed.
    #[error(
        "the control may deviate by {worst_v:.3e} V over {samples} samples; {allowed_v:.3e} V are allowed (half a step of the \
         output converter, or of one of 16 bits if the project's is finer): use single precision, or another realisation of the paths"
    )]
    TooCoarse {
        /// Predicted worst deviation, V.
        worst_v: f64,
        /// Samples of the prediction.
        samples: usize,
        /// The allowed deviation, V.
        allowed_v: f64,
    },
}
