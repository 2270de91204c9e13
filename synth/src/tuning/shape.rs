//! A weight as what moves in a tuning: its modulus far above its roots, and the roots off the origin.

use counterpoise_linalg::C64;

use crate::Weight;

/// Roots of weights lie between these shares of half the sample rate: outside nothing sees them.
const ROOTS: [f64; 2] = [3e-5, 0.8];
/// Damping ratio of complex roots.
const DAMPING: [f64; 2] = [0.02, 0.99];
/// Poles over zeros of the pair that takes the place of a plain control weight, and the zeros of a constant one as a share of half the sample rate.
const CONTROL_PAIR: (f64, f64) = (2.0, 0.05);

/// Damping ratio of a pair that takes a place where no root was.
pub(super) const PAIR_DAMPING: f64 = 0.7;

/// A root, or a pair of conjugate ones.
#[derive(Debug, Clone, Copy)]
pub(super) enum Root {
    Origin,
    Real { rate: f64 },
    Pair { rate: f64, damping: f64 },
}

impl Root {
    fn of(root: &C64) -> Option<Self> {
        if root.norm() == 0.0 {
            Some(Self::Origin)
        } else if root.im == 0.0 {
            Some(Self::Real { rate: root.re.abs() })
        } else {
            let damping = (root.re.abs() / root.norm()).clamp(DAMPING[0], DAMPING[1]);
            (root.im > 0.0).then(|| Self::Pair { rate: root.norm(), damping })
        }
    }

    fn roots(self) -> Vec<C64> {
        match self {
            Self::Origin => vec![C64::ZERO],
            Self::Real { rate } => vec![C64::new(-rate, 0.0)],
            Self::Pair { rate, damping } => {
                let half = C64::new(-damping * rate, rate * (1.0 - damping * damping).sqrt());
                vec![half, half.conj()]
            }
        }
    }
}

/// A weight by its roots; `modulus` is what remains of it far above them.
#[derive(Debug, Clone)]
pub(super) struct Shape {
    pub modulus: f64,
    pub zeros: Vec<Root>,
    pub poles: Vec<Root>,
}

impl Shape {
    pub fn of(weight: &Weight) -> Self {
        let rational = weight.rational().mirror_to_left();
        let roots = |all: &[C64]| all.iter().filter_map(Root::of).collect();
        Self { modulus: rational.gain, zeros: roots(&rational.zeros), poles: roots(&rational.poles) }
    }

    pub fn weight(&self) -> Weight {
        let roots = |all: &[Root]| all.iter().flat_map(|root| root.roots()).collect();
        Weight::ZeroPoleGain { zeros: roots(&self.zeros), poles: roots(&self.poles), gain: self.modulus }
    }

    /// Returns the parameters that may move, as logarithms with their ranges; the modulus is not among them.
    pub fn parameters(&self, half: f64) -> Vec<(f64, [f64; 2])> {
        let rate = |value: f64| {
            let range = [(ROOTS[0] * half).min(value), (ROOTS[1] * half).max(value)];
            (value.ln(), range.map(f64::ln))
        };
        let of = |root: &Root| match *root {
            Root::Origin => Vec::new(),
            Root::Real { rate: value } => vec![rate(value)],
            Root::Pair { rate: value, damping } => vec![rate(value), (damping.ln(), DAMPING.map(f64::ln))],
        };
        self.zeros.iter().chain(&self.poles).flat_map(of).collect()
    }

    /// Returns the shape with its parameters taken from `values`, in the order of [`Shape::parameters`].
    pub fn with_parameters(&self, values: &mut impl Iterator<Item = f64>) -> Self {
        let mut next = || values.next().unwrap_or(0.0);
        let mut move_root = |root: &Root| match *root {
            Root::Origin => Root::Origin,
            Root::Real { .. } => Root::Real { rate: next() },
            Root::Pair { .. } => Root::Pair { rate: next(), damping: next() },
        };
        let zeros = self.zeros.iter().map(&mut move_root).collect();
        let poles = self.poles.iter().map(&mut move_root).collect();
        Self { modulus: self.modulus, zeros, poles }
    }

    /// Returns the geometric mean of the corners; `None` without any.
    pub fn mean_corner(&self) -> Option<f64> {
        let rate = |root: &Root| match *root {
            Root::Origin => None,
            Root::Real { rate } | Root::Pair { rate, .. } => Some(rate.ln()),
        };
        let all: Vec<f64> = self.zeros.iter().chain(&self.poles).filter_map(rate).collect();
        (!all.is_empty()).then(|| (all.iter().sum::<f64>() / all.len() as f64).exp())
    }
}

/// The shape of a control weight: its own, or a pair from its corner on if it has fewer than two roots.
pub(super) fn control_shape(weight: &Weight, half: f64) -> Shape {
    let stated = Shape::of(weight);
    if stated.zeros.len() + stated.poles.len() > 1
        || stated.zeros.iter().any(|root| matches!(root, Root::Pair { .. }))
    {
        return stated;
    }
    let rate = stated.mean_corner().unwrap_or(CONTROL_PAIR.1 * half).min(CONTROL_PAIR.1 * half);
    let pair = |rate: f64| vec![Root::Pair { rate, damping: PAIR_DAMPING }];
    // The same modulus far below the corner.
    let modulus = weight.magnitude(1e-3 * rate) * CONTROL_PAIR.0.powi(2);
    Shape { modulus, zeros: pair(rate), poles: pair(CONTROL_PAIR.0 * rate) }
}
