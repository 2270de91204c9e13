//! The family of the H2 feedback: its weights, from those that a specification states.
//!
//! Error and control weight move by their gain and the roots off the origin, the filter by the noise of the measurement and the loop
//! recovery; all are relative to the disturbances, which stay. The error weight gets a further pair of complex zeros and poles, which
//! nearly cancel at the start: with it the weight can follow a spectrum that has a peak, such as that of a road. A control weight with fewer than two roots becomes
//! such a pair, which holds the control down in a band; the controller falls off by its filter.
//!
//! The feedback at a point is the sampled controller as it runs. Its slopes are differences, since a Riccati solution has none in closed form that
//! would cost less than another solution.

use std::cell::RefCell;
use std::f64::consts::PI;

use counterpoise_controller::Signal;
use counterpoise_lti::response::Response;
use counterpoise_lti::{C64, StateSpace};

use super::TunedFeedback;
use super::evaluation::POLE_STEP;
use super::family::{Family, GridResponse};
use super::grid::LoopGrid;
use super::limits::hub_path;
use super::problem::Problem;
use super::starts::Random;
use crate::{
    Assembly, DesignPlant, Error, FeedbackWeights, Reference, Sampling, Specification, Weight, design,
    discretise,
};

/// Roots of weights lie between these shares of half the sample rate: outside nothing sees them.
const ROOTS: [f64; 2] = [3e-5, 0.8];
/// Largest factor on a gain, and on a noise, as natural logarithms.
const GAIN: f64 = 7.0;
const NOISE: f64 = 12.0;
/// Damping ratio of complex roots.
const DAMPING: [f64; 2] = [0.02, 0.99];
/// Damping ratio of the further pair, its centre over the error weight's own corner, and the distance of its zeros from its poles,
/// which keeps the start from being a stationary point.
const FURTHER: (f64, f64, f64) = (0.7, 0.5, 1.1);
/// Poles over zeros of the pair that takes the place of a plain control weight, and the zeros of a constant one as a share of half the sample rate.
const CONTROL_PAIR: (f64, f64) = (2.0, 0.05);
/// Centre of the further pair if the error weight has no corner, as a share of half the sample rate.
const NO_CORNER: f64 = 3e-3;
/// Largest random factor on a start, as natural logarithms: gains and noises, and the other parameters.
const SPREAD: (f64, f64) = (2.0, 0.6);
/// How many loops of blocks are evaluated in the time of one design with its slopes, by order of magnitude; it lowers the number of starts.
const COST: usize = 2;
/// Designs that are kept: those of one set of slopes.
const KEPT: usize = 40;

/// A root, or a pair of conjugate ones.
#[derive(Debug, Clone, Copy)]
enum Root {
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
struct Shape {
    modulus: f64,
    zeros: Vec<Root>,
    poles: Vec<Root>,
}

impl Shape {
    fn of(weight: &Weight) -> Self {
        let rational = weight.rational().mirrored();
        let roots = |all: &[C64]| all.iter().filter_map(Root::of).collect();
        Self { modulus: rational.gain, zeros: roots(&rational.zeros), poles: roots(&rational.poles) }
    }

    fn weight(&self) -> Weight {
        let roots = |all: &[Root]| all.iter().flat_map(|root| root.roots()).collect();
        Weight::ZeroPoleGain { zeros: roots(&self.zeros), poles: roots(&self.poles), gain: self.modulus }
    }

    /// The parameters that may move, as logarithms with their ranges; the modulus is not among them.
    fn parameters(&self, half: f64) -> Vec<(f64, [f64; 2])> {
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

    /// The shape with its parameters taken from `values`, in the order of [`Shape::parameters`].
    fn moved(&self, values: &mut impl Iterator<Item = f64>) -> Self {
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

    /// Geometric mean of the corners; `None` without any.
    fn corner(&self) -> Option<f64> {
        let rate = |root: &Root| match *root {
            Root::Origin => None,
            Root::Real { rate } | Root::Pair { rate, .. } => Some(rate.ln()),
        };
        let all: Vec<f64> = self.zeros.iter().chain(&self.poles).filter_map(rate).collect();
        (!all.is_empty()).then(|| (all.iter().sum::<f64>() / all.len() as f64).exp())
    }
}

/// The weights of a specification.
pub(crate) struct Weights<'a> {
    plant: &'a DesignPlant,
    sampling: &'a Sampling,
    stated: &'a FeedbackWeights,
    position_gain: Option<f64>,
    error: Shape,
    control: Shape,
    /// Where the tuning starts: error gain, noise of the measurement, loop recovery if there is any, then the roots of the error and of the
    /// control weight.
    start: Vec<f64>,
    ranges: Vec<[f64; 2]>,
    recovers: bool,
    /// The last designs.
    designs: RefCell<Vec<(Vec<f64>, StateSpace)>>,
}

impl<'a> Weights<'a> {
    /// The family about the weights of a specification.
    ///
    /// # Errors
    /// [`Error::System`] if the feedback does not see the error alone, or noise and weights are not above 0.
    pub fn new(
        specification: &'a Specification,
        plant: &'a DesignPlant,
        sampling: &'a Sampling,
    ) -> Result<Self, Error> {
        let refused = |problem| Err(Error::System { what: "tuning of weights", problem });
        if specification.reference != Reference::Error {
            return refused("it needs reference = \"error\"");
        }
        if specification.assembly == Assembly::Joint {
            return refused("a joint optimum has one problem for all parts: use another assembly");
        }
        let stated = &specification.feedback;
        if stated.measurement_noise <= 0.0 {
            return refused("`measurement_noise` must be above 0");
        }
        let half = PI / sampling.period_s;
        let (mut error, control) = (Shape::of(&stated.error), control_shape(&stated.control, half));
        let rate = error.corner().map_or(NO_CORNER * half, |corner| FURTHER.1 * corner);
        error.zeros.push(Root::Pair { rate: rate * FURTHER.2, damping: FURTHER.0 });
        error.poles.push(Root::Pair { rate, damping: FURTHER.0 });
        let about = |value: f64, reach: f64| (value.ln(), [value.ln() - reach, value.ln() + reach]);
        let mut all = vec![about(error.modulus, GAIN), about(stated.measurement_noise, NOISE)];
        let recovers = stated.loop_recovery > 0.0;
        all.extend(recovers.then(|| about(stated.loop_recovery, NOISE)));
        all.extend(error.parameters(half));
        all.extend(control.parameters(half));
        let (start, ranges) = all.into_iter().unzip();
        let position_gain = specification.position_gain;
        let designs = RefCell::new(Vec::new());
        Ok(Self { plant, sampling, stated, position_gain, error, control, start, ranges, recovers, designs })
    }

    /// The weights at a point.
    fn weights(&self, at: &[f64]) -> FeedbackWeights {
        let mut values = at.iter().map(|value| value.exp());
        let mut next = || values.next().unwrap_or(1.0);
        let (modulus, measurement_noise) = (next(), next());
        let loop_recovery = if self.recovers { next() } else { self.stated.loop_recovery };
        let error = Shape { modulus, ..self.error.moved(&mut values) };
        let control = self.control.moved(&mut values);
        FeedbackWeights {
            error: error.weight(),
            control: control.weight(),
            measurement_noise,
            loop_recovery,
            ..self.stated.clone()
        }
    }

    fn designed(&self, at: &[f64]) -> Result<StateSpace, Error> {
        let specification = Specification {
            feedback: self.weights(at),
            heave: None,
            pitch: None,
            assembly: Assembly::SimpleAdd,
            reference: Reference::Error,
            position_gain: self.position_gain,
        };
        let sampled = discretise(&design(self.plant, &specification)?, self.sampling)?;
        let linear = sampled.controller.linear(self.sampling.out_of_balance_kg_m)?;
        Ok(hub_path(&linear, Signal::HubRate.reading().unwrap_or(1)).negate())
    }
}

/// The shape of a control weight: its own, or a pair from its corner on if it has fewer than two roots.
fn control_shape(weight: &Weight, half: f64) -> Shape {
    let stated = Shape::of(weight);
    if stated.zeros.len() + stated.poles.len() > 1
        || stated.zeros.iter().any(|root| matches!(root, Root::Pair { .. }))
    {
        return stated;
    }
    let rate = stated.corner().unwrap_or(CONTROL_PAIR.1 * half).min(CONTROL_PAIR.1 * half);
    let pair = |rate: f64| vec![Root::Pair { rate, damping: FURTHER.0 }];
    // The same modulus far below the corner.
    let modulus = weight.magnitude(1e-3 * rate) * CONTROL_PAIR.0.powi(2);
    Shape { modulus, zeros: pair(rate), poles: pair(CONTROL_PAIR.0 * rate) }
}

/// The response of a system with one input and one output on the grid.
fn on_grid(system: &StateSpace, grid: &LoopGrid) -> Result<Vec<C64>, Error> {
    Ok(Response::of(system)?.at_all(&grid.rates)?.iter().map(|H| H[(0, 0)]).collect())
}

impl Family for Weights<'_> {
    fn ranges(&self) -> &[[f64; 2]] {
        &self.ranges
    }

    fn gain(&self, at: &[f64], grid: &LoopGrid) -> Result<Vec<C64>, Error> {
        on_grid(&self.sampled(at)?, grid)
    }

    fn response(&self, at: &[f64], grid: &LoopGrid) -> Result<GridResponse, Error> {
        let K = self.gain(at, grid)?;
        let mut slopes = vec![Vec::with_capacity(at.len()); K.len()];
        for k in 0..at.len() {
            let mut moved = at.to_vec();
            moved[k] += POLE_STEP;
            for ((slopes, K), next) in slopes.iter_mut().zip(&K).zip(self.gain(&moved, grid)?) {
                slopes.push((next / K - C64::ONE) / POLE_STEP);
            }
        }
        Ok(GridResponse { K, slopes })
    }

    fn sampled(&self, at: &[f64]) -> Result<StateSpace, Error> {
        if let Some((_, known)) = self.designs.borrow().iter().find(|(of, _)| of == at) {
            return Ok(known.clone());
        }
        let system = self.designed(at)?;
        let mut designs = self.designs.borrow_mut();
        if designs.len() == KEPT {
            designs.remove(0);
        }
        designs.push((at.to_vec(), system.clone()));
        Ok(system)
    }

    fn calmer(&self, at: &[f64]) -> Option<Vec<f64>> {
        let mut calmer = at.to_vec();
        calmer[0] = (at[0] - std::f64::consts::LN_2).max(self.ranges[0][0]);
        Some(calmer)
    }

    fn cost(&self) -> usize {
        COST
    }

    fn starts(&self, _problem: &Problem<'_>, count: usize, seed: u64) -> Vec<Vec<f64>> {
        let mut random = Random(seed);
        let levels = 2 + usize::from(self.recovers);
        let mut all = vec![self.start.clone()];
        for _ in 1..count {
            let moved = |(n, value): (usize, &f64)| {
                let spread = if n < levels { SPREAD.0 } else { SPREAD.1 };
                value + spread * random.symmetric(n)
            };
            all.push(self.start.iter().enumerate().map(moved).collect());
        }
        all
    }

    fn feedback(&self, at: &[f64]) -> TunedFeedback {
        TunedFeedback::Weights(Box::new(self.weights(at)))
    }
}
