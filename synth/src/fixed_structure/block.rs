//! One block of a feedback of fixed structure: its transfer function, its roots, and its slopes in its parameters.

use counterpoise_linalg::C64;

use crate::rational_function::RationalFunction;
use crate::weight::quadratic_roots;

/// A block with its parameters, in the order of [`BlockKind::parameters`].
#[derive(Debug, Clone, PartialEq)]
pub struct Block {
    /// Kind.
    pub kind: BlockKind,
    /// Parameters.
    pub parameters: Vec<BlockParameter>,
}

/// A parameter, all of which are positive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BlockParameter {
    /// Value; where it is tuned, the first value that is tried.
    pub value: Option<f64>,
    /// Lowest and highest value that the tuning may choose; `None` fixes the value, or without a value leaves the range to
    /// the tuning.
    pub range: Option<[f64; 2]>,
}

/// Kinds of blocks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BlockKind {
    /// `k`.
    Gain,
    /// `k (s + c) / s`.
    ProportionalIntegral,
    /// `k (1 + c / s + T s / (1 + t s))`.
    ProportionalIntegralDerivative,
    /// `(1 + s / w) / (1 + s / (w r))`: unit gain at zero frequency, r at infinity.
    Lead,
    /// `(s + w) / (s + w / r)`: gain r at zero frequency, unit gain at infinity.
    Lag,
    /// `(s^2 + 2 d z w s + w^2) / (s^2 + 2 z w s + w^2)`: gain d at w, unit gain elsewhere.
    Notch,
    /// `(s^2/a^2 + 2 y s/a + 1) / (s^2/b^2 + 2 z s/b + 1)`: unit gain at zero frequency.
    Biquad,
    /// `1 / (1 + s / w)`.
    LowPass,
    /// `1 / (s^2/w^2 + 2 z s/w + 1)`.
    SecondOrderLowPass,
}

/// Kind of a block's parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ParameterName {
    /// Gain, V s/rad.
    Gain,
    /// Corner below which the block integrates, rad/s.
    Corner,
    /// Time constant of the derivative, s.
    DerivativeTime,
    /// Time constant of the filter of the derivative, s.
    FilterTime,
    /// Frequency, rad/s.
    Frequency,
    /// Ratio of the two corners.
    Ratio,
    /// Damping ratio of the poles.
    Damping,
    /// Gain at the centre.
    Depth,
    /// Natural frequency of the zeros, rad/s.
    ZeroFrequency,
    /// Damping ratio of the zeros.
    ZeroDamping,
    /// Natural frequency of the poles, rad/s.
    PoleFrequency,
    /// Damping ratio of the poles of a biquad.
    PoleDamping,
}

impl ParameterName {
    /// Returns the key in a project file.
    pub fn key(self) -> &'static str {
        match self {
            Self::Gain => "gain",
            Self::Corner => "corner",
            Self::DerivativeTime => "derivative_time",
            Self::FilterTime => "filter_time",
            Self::Frequency => "frequency",
            Self::Ratio => "ratio",
            Self::Damping => "damping",
            Self::Depth => "depth",
            Self::ZeroFrequency => "zero_frequency",
            Self::ZeroDamping => "zero_damping",
            Self::PoleFrequency => "pole_frequency",
            Self::PoleDamping => "pole_damping",
        }
    }
}

impl BlockParameter {
    /// Returns a parameter of a fixed value.
    pub fn with_fixed_value(value: f64) -> Self {
        Self { value: Some(value), range: None }
    }

    /// A parameter of which the tuning chooses value and range.
    pub const OPEN: Self = Self { value: None, range: None };

    /// Returns whether the parameter is left to the tuning.
    pub fn is_open(&self) -> bool {
        self.value.is_none() || self.range.is_some()
    }
}

impl Block {
    /// Returns a block of which every parameter is left to the tuning.
    pub fn open(kind: BlockKind) -> Self {
        Self { kind, parameters: vec![BlockParameter::OPEN; kind.parameters().len()] }
    }
}

impl BlockKind {
    /// Every kind.
    pub const ALL: [Self; 9] = [
        Self::Gain,
        Self::ProportionalIntegral,
        Self::ProportionalIntegralDerivative,
        Self::Lead,
        Self::Lag,
        Self::Notch,
        Self::Biquad,
        Self::LowPass,
        Self::SecondOrderLowPass,
    ];

    /// Returns the name in a project file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Gain => "gain",
            Self::ProportionalIntegral => "pi",
            Self::ProportionalIntegralDerivative => "pid",
            Self::Lead => "lead",
            Self::Lag => "lag",
            Self::Notch => "notch",
            Self::Biquad => "biquad",
            Self::LowPass => "low-pass",
            Self::SecondOrderLowPass => "second-order-low-pass",
        }
    }

    /// Returns the parameters in their order.
    pub fn parameters(self) -> &'static [ParameterName] {
        use ParameterName::*;
        match self {
            Self::Gain => &[Gain],
            Self::ProportionalIntegral => &[Gain, Corner],
            Self::ProportionalIntegralDerivative => &[Gain, Corner, DerivativeTime, FilterTime],
            Self::Lead | Self::Lag => &[Frequency, Ratio],
            Self::Notch => &[Frequency, Damping, Depth],
            Self::Biquad => &[ZeroFrequency, ZeroDamping, PoleFrequency, PoleDamping],
            Self::LowPass => &[Frequency],
            Self::SecondOrderLowPass => &[Frequency, Damping],
        }
    }

    /// Returns the transfer function at s for values in the order of [`BlockKind::parameters`].
    pub fn at(self, p: &[f64], s: C64) -> C64 {
        match self {
            Self::Gain => C64::new(p[0], 0.0),
            Self::ProportionalIntegral => p[0] * (s + p[1]) / s,
            Self::ProportionalIntegralDerivative => p[0] * (1.0 + p[1] / s + p[2] * s / (1.0 + p[3] * s)),
            Self::Lead => (1.0 + s / p[0]) / (1.0 + s / (p[0] * p[1])),
            Self::Lag => (s + p[0]) / (s + p[0] / p[1]),
            Self::Notch => monic(p[0], p[1] * p[2], s) / monic(p[0], p[1], s),
            Self::Biquad => unit(p[0], p[1], s) / unit(p[2], p[3], s),
            Self::LowPass => 1.0 / (1.0 + s / p[0]),
            Self::SecondOrderLowPass => 1.0 / unit(p[0], p[1], s),
        }
    }

    /// Returns the derivatives of the logarithm of the transfer function by the logarithm of each parameter.
    pub fn slopes(self, p: &[f64], s: C64) -> Vec<C64> {
        // d ln(1 + x) / d ln x.
        let share = |x: C64| x / (1.0 + x);
        match self {
            Self::Gain => vec![C64::ONE],
            Self::ProportionalIntegral => vec![C64::ONE, p[1] / (s + p[1])],
            Self::ProportionalIntegralDerivative => {
                let filter = 1.0 + p[3] * s;
                let whole = 1.0 + p[1] / s + p[2] * s / filter;
                let derivative = p[2] * s / filter;
                vec![C64::ONE, p[1] / s / whole, derivative / whole, -derivative * share(p[3] * s) / whole]
            }
            Self::Lead => {
                let (zero, pole) = (share(s / p[0]), share(s / (p[0] * p[1])));
                vec![pole - zero, pole]
            }
            Self::Lag => {
                let (zero, pole) = (share(p[0] / s), share(p[0] / p[1] / s));
                vec![zero - pole, pole]
            }
            Self::Notch => {
                let (n, d) = (monic(p[0], p[1] * p[2], s), monic(p[0], p[1], s));
                let (above, below) = (2.0 * p[0] * p[1] * p[2] * s, 2.0 * p[0] * p[1] * s);
                let square = 2.0 * p[0] * p[0];
                let centre = (above + square) / n - (below + square) / d;
                vec![centre, above / n - below / d, above / n]
            }
            Self::Biquad => {
                let (zero, pole) = (unit_slopes(p[0], p[1], s), unit_slopes(p[2], p[3], s));
                vec![zero[0], zero[1], -pole[0], -pole[1]]
            }
            Self::LowPass => vec![share(s / p[0])],
            Self::SecondOrderLowPass => unit_slopes(p[0], p[1], s).into_iter().map(|slope| -slope).collect(),
        }
    }

    /// Returns the gain, zeros and poles.
    pub fn rational(self, p: &[f64]) -> RationalFunction {
        let real = |value: f64| C64::new(value, 0.0);
        let pair = |frequency: f64, damping: f64| {
            quadratic_roots(2.0 * damping * frequency, frequency * frequency).to_vec()
        };
        match self {
            Self::Gain => RationalFunction::new(&[], &[], p[0]),
            Self::ProportionalIntegral => RationalFunction::new(&[real(-p[1])], &[C64::ZERO], p[0]),
            Self::ProportionalIntegralDerivative => {
                // (t + T) s^2 + (1 + c t) s + c over t s (s + 1/t).
                let second = p[2] + p[3];
                let zeros = quadratic_roots((1.0 + p[1] * p[3]) / second, p[1] / second);
                RationalFunction::new(&zeros, &[C64::ZERO, real(-1.0 / p[3])], p[0] * second / p[3])
            }
            Self::Lead => RationalFunction::new(&[real(-p[0])], &[real(-p[0] * p[1])], p[1]),
            Self::Lag => RationalFunction::new(&[real(-p[0])], &[real(-p[0] / p[1])], 1.0),
            Self::Notch => RationalFunction::new(&pair(p[0], p[1] * p[2]), &pair(p[0], p[1]), 1.0),
            Self::Biquad => {
                RationalFunction::new(&pair(p[0], p[1]), &pair(p[2], p[3]), (p[2] / p[0]).powi(2))
            }
            Self::LowPass => RationalFunction::new(&[], &[real(-p[0])], p[0]),
            Self::SecondOrderLowPass => RationalFunction::new(&[], &pair(p[0], p[1]), p[0] * p[0]),
        }
    }
}

/// s^2 + 2 z w s + w^2.
fn monic(frequency: f64, damping: f64, s: C64) -> C64 {
    s * s + 2.0 * damping * frequency * s + frequency * frequency
}

/// s^2/w^2 + 2 z s/w + 1.
fn unit(frequency: f64, damping: f64, s: C64) -> C64 {
    let x = s / frequency;
    x * x + 2.0 * damping * x + 1.0
}

/// The derivatives of ln(s^2/w^2 + 2 z s/w + 1) by ln w and ln z.
fn unit_slopes(frequency: f64, damping: f64, s: C64) -> [C64; 2] {
    let x = s / frequency;
    let linear = 2.0 * damping * x;
    let whole = unit(frequency, damping, s);
    [-(2.0 * x * x + linear) / whole, linear / whole]
}
