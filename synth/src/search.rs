//! From requirements to weights: the weights are moved until the figures of the *sampled* loop hold, and then as far as
//! they go towards rejection.

use counterpoise_lti::StateSpace;
use counterpoise_lti::response::Response;

use crate::feedforward::with_derivatives;
use crate::figures::{BAND_POINTS, Figures, band_rate, figures, rejection};
use crate::{
    Channel, DesignPlant, Error, Outcome, Reference, Sampling, Specification, Weight, design, discretise,
};

/// What the feedback loop must keep. Infinite or zero limits ask for nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Requirements {
    /// Smallest gain margin, dB.
    pub gain_margin_db: f64,
    /// Smallest phase margin, degrees.
    pub phase_margin_deg: f64,
    /// Largest sensitivity.
    pub ms: f64,
    /// Largest overshoot of a step, as a share of it.
    pub overshoot: f64,
    /// Smallest crossover, rad/s.
    pub crossover_rad_s: f64,
    /// Largest control after a unit step, V s/rad.
    pub step_control_v: f64,
    /// Largest RMS control for measurement noise of unit RMS, V s/rad.
    pub noise_gain: f64,
    /// Band over which rejection is wanted, rad/s.
    pub band_rad_s: (f64, f64),
    /// By what the share that is left is averaged over the band.
    pub spectrum: Spectrum,
}

/// By what the share of a disturbance that is left is averaged over the band.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Spectrum {
    /// Alike everywhere on the logarithmic axis.
    #[default]
    Flat,
    /// By the spectrum of the rate that the expected heave and pitch (the generators of the feedforwards) cause where no
    /// control acts.
    Expected,
}

impl Requirements {
    /// The margins and the overshoot of the source thesis: 12 dB, 60 degrees, 13 %; rejection from 0.2 to 2 Hz.
    pub fn thesis() -> Self {
        Self {
            gain_margin_db: 12.0,
            phase_margin_deg: 60.0,
            ms: f64::INFINITY,
            overshoot: 0.13,
            crossover_rad_s: 0.0,
            step_control_v: f64::INFINITY,
            noise_gain: f64::INFINITY,
            band_rad_s: (1.26, 12.6),
            spectrum: Spectrum::Flat,
        }
    }

    /// RMS of |S| over the band, averaged as the requirements say.
    ///
    /// # Errors
    /// [`Error::System`] where the average is by the expected motion and the specification expects none.
    pub fn share_left(
        &self,
        loop_gain: &StateSpace,
        (plant, specification): (&DesignPlant, &Specification),
    ) -> Result<f64, Error> {
        rejection(loop_gain, self.band_rad_s, &self.powers(plant, specification)?)
    }

    /// The average's weights at the points of the band.
    fn powers(
        &self,
        plant: &DesignPlant,
        specification: &Specification,
    ) -> Result<[f64; BAND_POINTS], Error> {
        match self.spectrum {
            Spectrum::Flat => Ok([1.0; BAND_POINTS]),
            Spectrum::Expected => expected(plant, specification, self.band_rad_s),
        }
    }

    /// The sum of what is missed, each relative to its limit; 0 where everything holds.
    pub fn missed(&self, found: &Figures) -> f64 {
        let below =
            |value: f64, limit: f64| if limit > 0.0 { ((limit - value) / limit).max(0.0) } else { 0.0 };
        let above =
            |value: f64, limit: f64| if limit.is_finite() { ((value - limit) / limit).max(0.0) } else { 0.0 };
        below(found.gain_margin_db, self.gain_margin_db)
            + below(found.phase_margin_deg, self.phase_margin_deg)
            + below(found.crossover_rad_s, self.crossover_rad_s)
            + above(found.ms, self.ms)
            + above(found.overshoot, self.overshoot)
            + above(found.step_control_v, self.step_control_v)
            + above(found.noise_gain, self.noise_gain)
    }
}

/// One trial of the search.
#[derive(Debug, Clone, PartialEq)]
pub struct Trial {
    /// The specification that was tried.
    pub specification: Specification,
    /// What its sampled loop does.
    pub figures: Figures,
    /// What it misses: 0 where the requirements hold.
    pub missed: f64,
}

/// The answer of a search.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// The best trial: nothing missed if that could be had, then the best rejection.
    pub best: Trial,
    /// Trials made.
    pub trials: usize,
    /// How the search ended.
    pub ended: Ended,
}

/// How a search ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ended {
    /// No step of the smallest size improves.
    Settled,
    /// The limit of trials was reached.
    OutOfTrials,
    /// The caller stopped it.
    Stopped,
}

/// First and last step of the search, as natural logarithms of factors.
const STEPS: (f64, f64) = (0.7, 0.04);
/// An answer must be better by this share to count: below it a search would walk a knob that hardly matters to its end.
const LEAST_GAIN: f64 = 1e-5;
/// Largest factor on a knob, as a natural logarithm: three decades.
const REACH: f64 = 6.9;
/// Weight of a missed requirement against rejection.
const PENALTY: f64 = 100.0;
/// Knobs: error gain, error corners, control corners, loop recovery.
const KNOBS: usize = 4;

/// Power of the uncontrolled rate under the expected motion, per unit of the logarithm of frequency.
fn expected(
    plant: &DesignPlant,
    specification: &Specification,
    band_rad_s: (f64, f64),
) -> Result<[f64; BAND_POINTS], Error> {
    let mut powers = [0.0; BAND_POINTS];
    for channel in [Channel::Heave, Channel::Pitch] {
        let Some(weights) = specification.feedforward(channel) else { continue };
        let columns = plant.columns(channel);
        let generator = Response::of(&with_derivatives(&weights.generator.realise()?, columns.len())?)?;
        let path = Response::of(&plant.system.select(&[plant.rate], columns))?;
        for (k, power) in powers.iter_mut().enumerate() {
            let rate = band_rate(band_rad_s, k);
            *power += rate * (&path.at(rate)? * &generator.at(rate)?)[(0, 0)].norm_sqr();
        }
    }
    if powers.iter().any(|power| *power > 0.0) {
        return Ok(powers);
    }
    let problem = "no motion is expected that causes a rate: it needs a feedforward with its generator";
    Err(Error::System { what: "search by the expected motion", problem })
}

/// Searches weights and loop recovery of the feedback so that the requirements hold on the sampled loop.
///
/// A pattern search from the given specification over four factors (error weight's gain, the corners of the error and of
/// the control weight, the loop recovery), singly and in pairs, each direction walked as far as it improves:
/// deterministic, at most `most_trials` designs, and it asks `go_on` before each with the best so far. The feedforwards are left as they are, since they do not depend on the feedback's weights.
///
/// # Errors
/// [`Error`] for a plant or sampling that is none. Where not even the start can be designed: [`Outcome::Infeasible`].
pub fn search(
    plant: &DesignPlant,
    start: &Specification,
    (requirements, sampling): (&Requirements, &Sampling),
    most_trials: usize,
    go_on: &mut dyn FnMut(&Trial) -> bool,
) -> Result<Outcome<Found>, Error> {
    let feedback_alone = Specification { heave: None, pitch: None, ..start.clone() };
    let powers = requirements.powers(plant, start)?;
    let problem = Problem { plant, start: &feedback_alone, requirements, sampling, powers };
    let first = match problem.attempt([0.0; KNOBS])? {
        Outcome::Solved(trial) => trial,
        Outcome::Infeasible(findings) => return Ok(Outcome::Infeasible(findings)),
    };
    let (mut at, mut best, mut trials, mut step) = ([0.0; KNOBS], first, 1, STEPS.0);
    let mut ended = Ended::Settled;
    'search: while step >= STEPS.1 {
        let mut improved = false;
        for direction in directions() {
            let mut walks = true;
            while walks {
                ended = if trials >= most_trials { Ended::OutOfTrials } else { Ended::Stopped };
                if trials >= most_trials || !go_on(&best) {
                    break 'search;
                }
                trials += 1;
                let next = std::array::from_fn(|i| at[i] + step * direction[i]);
                walks = false;
                if problem.reaches(next)
                    && let Outcome::Solved(trial) = problem.attempt(next)?
                    && merit(&trial) < (1.0 - LEAST_GAIN) * merit(&best)
                {
                    (at, best, improved, walks) = (next, trial, true, true);
                }
            }
        }
        ended = Ended::Settled;
        step *= if improved { 1.0 } else { 0.5 };
    }
    best.specification = Specification { feedback: best.specification.feedback, ..start.clone() };
    Ok(Outcome::Solved(Found { best, trials, ended }))
}

/// The trade-off between rejection and the largest sensitivity: for each limit of Ms the better of two searches, one
/// started from the given specification and one from the answer before. Limits that cannot be had come with what their
/// best trial misses. `go_on` is asked before each trial; once it says no, every search ends with its first.
///
/// # Errors
/// As [`search`].
pub fn trade_off(
    plant: &DesignPlant,
    start: &Specification,
    (requirements, sampling): (&Requirements, &Sampling),
    (ms_limits, most_trials): (&[f64], usize),
    go_on: &mut dyn FnMut(&Trial) -> bool,
) -> Result<Outcome<Vec<Found>>, Error> {
    let mut curve: Vec<Found> = Vec::new();
    for &ms in ms_limits {
        let limited = Requirements { ms, ..*requirements };
        let before = curve.last().map(|found| found.best.specification.clone());
        let mut best: Option<Found> = None;
        for from in before.iter().chain([start]) {
            let found = match search(plant, from, (&limited, sampling), most_trials, go_on)? {
                Outcome::Solved(found) => found,
                Outcome::Infeasible(findings) => return Ok(Outcome::Infeasible(findings)),
            };
            if best.as_ref().is_none_or(|other| merit(&found.best) < merit(&other.best)) {
                best = Some(found);
            }
        }
        curve.extend(best);
    }
    Ok(Outcome::Solved(curve))
}

/// Each knob up and down, then each pair of knobs together and against each other.
fn directions() -> Vec<[f64; KNOBS]> {
    let mut all = Vec::new();
    for knob in 0..KNOBS {
        for sign in [1.0, -1.0] {
            let mut direction = [0.0; KNOBS];
            direction[knob] = sign;
            all.push(direction);
        }
    }
    for (first, second) in (0..KNOBS).flat_map(|i| (i + 1..KNOBS).map(move |j| (i, j))) {
        for (a, b) in [(1.0, 1.0), (-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0)] {
            let mut direction = [0.0; KNOBS];
            (direction[first], direction[second]) = (a, b);
            all.push(direction);
        }
    }
    all
}

fn merit(trial: &Trial) -> f64 {
    PENALTY * trial.missed + trial.figures.rejection
}

struct Problem<'a> {
    plant: &'a DesignPlant,
    start: &'a Specification,
    requirements: &'a Requirements,
    sampling: &'a Sampling,
    powers: [f64; BAND_POINTS],
}

impl Problem<'_> {
    /// Whether no knob is further than [`REACH`], and no corner is moved beyond half the sampling rate, where nothing sees it.
    fn reaches(&self, knobs: [f64; KNOBS]) -> bool {
        let highest = std::f64::consts::PI / self.sampling.period_s;
        let corner = |weight: &Weight| {
            let rational = weight.rational();
            rational.zeros.iter().chain(&rational.poles).map(|root| root.norm()).fold(0.0, f64::max)
        };
        let [_, error, control, _] = knobs.map(f64::exp);
        let below = |weight: &Weight, factor: f64| factor <= 1.0 || factor * corner(weight) <= highest;
        let feedback = &self.start.feedback;
        knobs.iter().all(|knob| knob.abs() <= REACH)
            && below(&feedback.error, error)
            && below(&feedback.control, control)
    }

    fn attempt(&self, knobs: [f64; KNOBS]) -> Result<Outcome<Trial>, Error> {
        let specification = moved(self.start, knobs);
        let designed = match design(self.plant, &specification)? {
            Outcome::Solved(design) => design,
            Outcome::Infeasible(findings) => return Ok(Outcome::Infeasible(findings)),
        };
        discretise(&designed, self.sampling)?.try_map(|sampled| {
            let band = self.requirements.band_rad_s;
            let of_all = figures(self.plant, &sampled, self.sampling, band)?;
            let figures = Figures { rejection: rejection(&sampled.loop_gain, band, &self.powers)?, ..of_all };
            let missed = self.requirements.missed(&figures);
            Ok(Trial { specification, figures, missed })
        })
    }
}

/// The specification with its knobs turned by exp(knobs).
fn moved(start: &Specification, knobs: [f64; KNOBS]) -> Specification {
    let mut moved = start.clone();
    let [gain, error, control, recovery] = knobs.map(f64::exp);
    moved.feedback.error = stretched(&start.feedback.error, error, gain);
    moved.feedback.control = stretched(&start.feedback.control, control, 1.0);
    moved.feedback.loop_recovery *= recovery;
    debug_assert!(matches!(moved.reference, Reference::Error | Reference::WeightOnly));
    moved
}

/// gain W(s / factor): the corners moved, the modulus kept relative to them.
fn stretched(weight: &Weight, factor: f64, gain: f64) -> Weight {
    if factor == 1.0 && gain == 1.0 {
        return weight.clone();
    }
    let rational = weight.rational();
    let scale = factor.powi(rational.relative_degree());
    Weight::ZeroPoleGain {
        zeros: rational.zeros.iter().map(|root| root * factor).collect(),
        poles: rational.poles.iter().map(|root| root * factor).collect(),
        gain: rational.gain * gain * scale,
    }
}
