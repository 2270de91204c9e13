//! The forms of a weight, as data.

use counterpoise_linalg::C64;

/// A weight over frequency, in the forms of the source thesis and those that a designer draws.
#[derive(Debug, Clone, PartialEq)]
pub enum Weight {
    /// `K`: the same at every frequency.
    Constant {
        /// K.
        gain: f64,
    },
    /// `K / (a s)`: infinite at zero frequency, so that no steady error remains.
    Integral {
        /// K.
        gain: f64,
        /// a, s.
        time_s: f64,
    },
    /// `K / (a s + 1)`: K below 1/a, falling above.
    Lag {
        /// K.
        gain: f64,
        /// a, s.
        time_s: f64,
    },
    /// `K (a s + 1)`: K below 1/a, rising above.
    Lead {
        /// K.
        gain: f64,
        /// a, s.
        time_s: f64,
    },
    /// `K (b s^2 + a s + 1)`: K at low frequency, rising with the square above 1/sqrt(b).
    Quadratic {
        /// K.
        gain: f64,
        /// b, s^2.
        second_s2: f64,
        /// a, s.
        first_s: f64,
    },
    /// `K (b s^2 + a s)`: nothing at zero frequency (steady control is free), rising with the square.
    QuadraticFreeAtZero {
        /// K.
        gain: f64,
        /// b, s^2.
        second_s2: f64,
        /// a, s.
        first_s: f64,
    },
    /// `K prod(s - z) / prod(s - p)`.
    ZeroPoleGain {
        /// Zeros, rad/s; complex ones with their conjugates.
        zeros: Vec<C64>,
        /// Poles, rad/s; complex ones with their conjugates.
        poles: Vec<C64>,
        /// K.
        gain: f64,
    },
    /// From `low` well below the corner to `high` well above it, first order: the modulus is sqrt(low high) at the corner.
    Shelf {
        /// Modulus at zero frequency.
        low: f64,
        /// Modulus at infinity.
        high: f64,
        /// Corner, rad/s.
        corner_rad_s: f64,
    },
    /// `K (s^2 + 2 z g w s + w^2) / (s^2 + 2 z w s + w^2)`: K everywhere but near w, where it is K g (g < 1 a notch,
    /// g > 1 a peak).
    Notch {
        /// K.
        gain: f64,
        /// w, rad/s.
        centre_rad_s: f64,
        /// z, the relative half width.
        width: f64,
        /// g, the factor at the centre.
        factor: f64,
    },
    /// The product of weights.
    Product(Vec<Weight>),
    /// A table of moduli, by the stable function of minimum phase that comes nearest to it ([`Weight::table`]).
    Table {
        /// Frequency in rad/s and modulus, the frequencies rising.
        points: Vec<[f64; 2]>,
        /// Order of the function.
        order: usize,
        /// The function.
        fitted: Box<Weight>,
    },
}
