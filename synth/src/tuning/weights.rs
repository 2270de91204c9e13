//! The family of the H2 feedback: its weights, from those that a specification states.
//!
//! Error and control weight move by their gain and the roots off the origin, the filter by the noise of the measurement and the loop
//! recovery; all are relative to the disturbances, which stay. The error weight gets a further pair of complex zeros and poles, which
//! nearly cancel at the start: with it the weight can follow a spectrum that has a peak, such as that of a road. A control weight with fewer than two roots becomes
//! such a pair, which holds the control down in a band; the controller falls off by its filter.
//!
//! The feedback at a point is the sampled controller as it runs. Its slopes are differences, since a Riccati solution has none in closed form that
//! would cost less than another solution. What is differenced is the same feedback without the checks of the design and the choice of a
//! realisation, which take most of a design's time and do not change its response.

use std::cell::RefCell;
use std::f64::consts::PI;

use counterpoise_linalg::{C64, Mat};
use counterpoise_lti::response::Response;
use counterpoise_lti::{Discretisation, StateSpace, c2d};

use super::TunedFeedback;
use super::family::{FeedbackFamily, GridResponse};
use super::grid::{LoopGrid, LoopPlant};
use super::limits::feedback_path;
use super::random_generator::RandomGenerator;
use super::shape::{PAIR_DAMPING, Root, Shape, control_shape};
use crate::feedback::{controller_with_observer, observer_gain};
use crate::tolerance::POLE_STEP;
use crate::{
    Assembly, DesignPlant, Error, FeedbackWeights, Reference, Sampling, SamplingMethod, Specification,
    design, discretise,
};

/// Largest factor on a gain, and on a noise, as natural logarithms.
const GAIN: f64 = 7.0;
const NOISE: f64 = 12.0;
/// Centre of the further pair over the error weight's own corner.
const FURTHER_CENTRE: f64 = 0.5;
/// Distance of its zeros from its poles, as a factor: it keeps the start from being a stationary point.
const FURTHER_DISTANCE: f64 = 1.1;
/// Centre of the further pair if the error weight has no corner, as a share of half the sample rate.
const NO_CORNER: f64 = 3e-3;
/// Largest random factor on a start, as natural logarithms: gains and noises, and the other parameters.
const SPREAD: (f64, f64) = (2.0, 0.6);
/// Designs that are kept: those of one set of slopes.
const KEPT: usize = 40;

/// The weights of a specification.
pub(crate) struct Weights<'a> {
    plant: &'a DesignPlant,
    sampling: &'a Sampling,
    stated: &'a FeedbackWeights,
    position_gain: Option<f64>,
    error: Shape,
    control: Shape,
    /// The start of the tuning: error gain, noise of the measurement, loop recovery if there is any, then the roots of the error and of the
    /// control weight.
    start: Vec<f64>,
    ranges: Vec<[f64; 2]>,
    recovers: bool,
    /// The last designs, and the last feedbacks without checks.
    designs: RefCell<Vec<KeptSystem>>,
    plain: RefCell<Vec<KeptSystem>>,
    /// The last observer, with the measurement noise and the loop recovery that it belongs to.
    observer: RefCell<Option<Observer>>,
}

/// An observer's gain and what it depends on.
struct Observer {
    measurement_noise: f64,
    loop_recovery: f64,
    gain: Mat,
}

/// A system that is kept, and the point of the family that it belongs to.
struct KeptSystem {
    at: Vec<f64>,
    system: StateSpace,
}

/// The system that a list keeps for a point, or the one that is computed and kept now.
fn cached_system(
    list: &RefCell<Vec<KeptSystem>>,
    at: &[f64],
    compute: impl FnOnce() -> Result<StateSpace, Error>,
) -> Result<StateSpace, Error> {
    if let Some(known) = list.borrow().iter().find(|known| known.at == at) {
        return Ok(known.system.clone());
    }
    let system = compute()?;
    let mut list = list.borrow_mut();
    if list.len() == KEPT {
        list.remove(0);
    }
    list.push(KeptSystem { at: at.to_vec(), system: system.clone() });
    Ok(system)
}

impl<'a> Weights<'a> {
    /// Returns the family about the weights of a specification.
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
        let rate = error.mean_corner().map_or(NO_CORNER * half, |corner| FURTHER_CENTRE * corner);
        error.zeros.push(Root::Pair { rate: rate * FURTHER_DISTANCE, damping: PAIR_DAMPING });
        error.poles.push(Root::Pair { rate, damping: PAIR_DAMPING });
        let about = |value: f64, reach: f64| (value.ln(), [value.ln() - reach, value.ln() + reach]);
        let mut all = vec![about(error.modulus, GAIN), about(stated.measurement_noise, NOISE)];
        let recovers = stated.loop_recovery > 0.0;
        all.extend(recovers.then(|| about(stated.loop_recovery, NOISE)));
        all.extend(error.parameters(half));
        all.extend(control.parameters(half));
        let (start, ranges) = all.into_iter().unzip();
        let position_gain = specification.position_gain;
        let (designs, plain, observer) = Default::default();
        Ok(Self {
            plant,
            sampling,
            stated,
            position_gain,
            error,
            control,
            start,
            ranges,
            recovers,
            designs,
            plain,
            observer,
        })
    }

    /// The weights at a point.
    fn weights(&self, at: &[f64]) -> FeedbackWeights {
        let mut values = at.iter().map(|value| value.exp());
        let mut next = || values.next().unwrap_or(1.0);
        let (modulus, measurement_noise) = (next(), next());
        let loop_recovery = if self.recovers { next() } else { self.stated.loop_recovery };
        let error = Shape { modulus, ..self.error.with_parameters(&mut values) };
        let control = self.control.with_parameters(&mut values);
        FeedbackWeights {
            error: error.weight(),
            control: control.weight(),
            measurement_noise,
            loop_recovery,
            ..self.stated.clone()
        }
    }

    /// The observer's gain, computed anew only if noise or recovery differ from the last ones.
    fn observer(&self, weights: &FeedbackWeights) -> Result<Mat, Error> {
        let of = |last: &&Observer| {
            last.measurement_noise == weights.measurement_noise && last.loop_recovery == weights.loop_recovery
        };
        if let Some(last) = self.observer.borrow().as_ref().filter(of) {
            return Ok(last.gain.clone());
        }
        let gain = observer_gain(self.plant, weights)?;
        *self.observer.borrow_mut() = Some(Observer {
            measurement_noise: weights.measurement_noise,
            loop_recovery: weights.loop_recovery,
            gain: gain.clone(),
        });
        Ok(gain)
    }

    /// The feedback by its two Riccati equations and the conversion alone.
    fn plain_feedback(&self, at: &[f64], conversion: Discretisation) -> Result<StateSpace, Error> {
        let weights = self.weights(at);
        let L = self.observer(&weights)?;
        let controller = controller_with_observer(self.plant, &weights, &L)?.select(&[0], &[0]);
        Ok(c2d(&controller, self.sampling.period_s, conversion)?)
    }

    fn design_feedback(&self, at: &[f64]) -> Result<StateSpace, Error> {
        let specification = Specification {
            feedback: self.weights(at),
            heave: None,
            pitch: None,
            assembly: Assembly::SimpleAdd,
            reference: Reference::Error,
            position_gain: self.position_gain,
        };
        let sampled = discretise(&design(self.plant, &specification)?, self.sampling)?;
        feedback_path(&sampled.controller, self.sampling)
    }
}

/// The response of a system with one input and one output on the grid.
fn on_grid(system: &StateSpace, grid: &LoopGrid) -> Result<Vec<C64>, Error> {
    Ok(Response::of(system)?.at_all(&grid.rates)?.iter().map(|H| H[(0, 0)]).collect())
}

impl FeedbackFamily for Weights<'_> {
    fn ranges(&self) -> &[[f64; 2]] {
        &self.ranges
    }

    fn gain(&self, at: &[f64], grid: &LoopGrid) -> Result<Vec<C64>, Error> {
        on_grid(&self.unchecked_feedback(at)?, grid)
    }

    fn response(&self, at: &[f64], grid: &LoopGrid) -> Result<GridResponse, Error> {
        let K = on_grid(&self.sampled_feedback(at)?, grid)?;
        let here = self.gain(at, grid)?;
        let mut slopes = vec![Vec::with_capacity(at.len()); K.len()];
        for k in 0..at.len() {
            let mut moved = at.to_vec();
            moved[k] += POLE_STEP;
            for ((slopes, here), next) in slopes.iter_mut().zip(&here).zip(self.gain(&moved, grid)?) {
                slopes.push((next / here - C64::ONE) / POLE_STEP);
            }
        }
        Ok(GridResponse { K, slopes })
    }

    fn response_feedbacks(&self) -> usize {
        self.ranges.len() + 1
    }

    fn sampled_feedback(&self, at: &[f64]) -> Result<StateSpace, Error> {
        cached_system(&self.designs, at, || self.design_feedback(at))
    }

    fn unchecked_feedback(&self, at: &[f64]) -> Result<StateSpace, Error> {
        match self.sampling.method {
            SamplingMethod::Emulation(conversion) if self.plant.rate_loop.is_none() => {
                cached_system(&self.plain, at, || self.plain_feedback(at, conversion))
            }
            _ => self.sampled_feedback(at),
        }
    }

    fn calmer_point(&self, at: &[f64]) -> Option<Vec<f64>> {
        let mut calmer = at.to_vec();
        calmer[0] = (at[0] - std::f64::consts::LN_2).max(self.ranges[0][0]);
        Some(calmer)
    }

    fn starts(&self, _nominal: &LoopPlant, _grid: &LoopGrid, count: usize, seed: u64) -> Vec<Vec<f64>> {
        let mut random = RandomGenerator(seed);
        let levels = 2 + usize::from(self.recovers);
        let mut all = vec![self.start.clone()];
        for _ in 1..count {
            let moved = |(n, value): (usize, &f64)| {
                let spread = if n < levels { SPREAD.0 } else { SPREAD.1 };
                value + spread * random.next_symmetric(n)
            };
            all.push(self.start.iter().enumerate().map(moved).collect());
        }
        all
    }

    fn feedback(&self, at: &[f64]) -> TunedFeedback {
        TunedFeedback::Weights(Box::new(self.weights(at)))
    }
}
