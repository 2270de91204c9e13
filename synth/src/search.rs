//! From requirements to weights: the weights are moved until the figures of the *sampled* loop hold, and then as far as
//! they go towards rejection.

use crate::error::attempt;
use crate::figures::{BAND_POINTS, Figures, rejection, sampled_loop_figures};
use crate::tolerance::{LAST_WEIGHT_STEP, LEAST_GAIN, WEIGHT_REACH};
use crate::{
    DesignPlant, Error, Reference, Requirements, Sampling, Specification, Weight, design, discretise,
};

/// Start and budget of a search.
#[derive(Debug, Clone, Copy)]
pub struct SearchTask<'a> {
    /// The plant.
    pub plant: &'a DesignPlant,
    /// The specification that the search starts from.
    pub start: &'a Specification,
    /// Limits that the loop must keep.
    pub requirements: &'a Requirements,
    /// Sampling of the controller.
    pub sampling: &'a Sampling,
    /// Designs at most.
    pub most_trials: usize,
}

/// One trial of the search.
#[derive(Debug, Clone, PartialEq)]
pub struct SearchTrial {
    /// The specification that was tried.
    pub specification: Specification,
    /// Figures of its sampled loop.
    pub figures: Figures,
    /// Largest miss of a requirement: 0 if the requirements hold.
    pub missed: f64,
}

/// The answer of a search.
#[derive(Debug, Clone, PartialEq)]
pub struct SearchResult {
    /// The best trial: nothing missed if that could be had, then the best rejection.
    pub best: SearchTrial,
    /// Trials made.
    pub trials: usize,
    /// Reason for which the search ended.
    pub ended: SearchEnding,
}

/// Reason for which a search ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SearchEnding {
    /// No step of the smallest size improves.
    Settled,
    /// The limit of trials was reached.
    OutOfTrials,
    /// The caller stopped it.
    Stopped,
}

impl SearchEnding {
    /// Returns the name of the reason in results.
    pub fn name(self) -> &'static str {
        match self {
            SearchEnding::Settled => "Settled",
            SearchEnding::OutOfTrials => "OutOfTrials",
            SearchEnding::Stopped => "Stopped",
        }
    }
}

/// First step of the search, as a natural logarithm of a factor.
const FIRST_STEP: f64 = 0.7;
/// Weight of a missed requirement against rejection.
const PENALTY: f64 = 100.0;
/// Parameters that are searched: error gain, error corners, control corners, loop recovery.
const PARAMETERS: usize = 4;

/// Searches weights and loop recovery of the feedback so that the requirements hold on the sampled loop.
///
/// A pattern search from the given specification over four factors (error weight's gain, the corners of the error and of
/// the control weight, the loop recovery), singly and in pairs, each direction walked as far as it improves:
/// deterministic, at most `task.most_trials` designs, and it asks `go_on` before each with the best so far. The feedforwards are left as they are, since they do not depend on the feedback's weights.
///
/// # Errors
/// [`Error`] for a plant or sampling that is none. If not even the start can be designed: [`Error::Refused`].
pub fn search_specification(
    task: &SearchTask<'_>,
    go_on: &mut dyn FnMut(&SearchTrial) -> bool,
) -> Result<SearchResult, Error> {
    let SearchTask { plant, start, requirements, sampling, most_trials } = *task;
    let feedback_alone = Specification { heave: None, pitch: None, ..start.clone() };
    let powers = requirements.powers(plant, start)?;
    let problem = Problem { plant, start: &feedback_alone, requirements, sampling, powers };
    let first = problem.attempt([0.0; PARAMETERS])?;
    let (mut at, mut best, mut trials, mut step) = ([0.0; PARAMETERS], first, 1, FIRST_STEP);
    let mut ended = SearchEnding::Settled;
    'search: while step >= LAST_WEIGHT_STEP {
        let mut improved = false;
        for direction in directions() {
            let mut walks = true;
            while walks {
                ended = if trials >= most_trials { SearchEnding::OutOfTrials } else { SearchEnding::Stopped };
                if trials >= most_trials || !go_on(&best) {
                    break 'search;
                }
                trials += 1;
                let next = std::array::from_fn(|i| at[i] + step * direction[i]);
                walks = false;
                if problem.reaches(next)
                    && let Ok(trial) = attempt(problem.attempt(next))?
                    && merit(&trial) < (1.0 - LEAST_GAIN) * merit(&best)
                {
                    (at, best, improved, walks) = (next, trial, true, true);
                }
            }
        }
        ended = SearchEnding::Settled;
        step *= if improved { 1.0 } else { 0.5 };
    }
    best.specification = Specification { feedback: best.specification.feedback, ..start.clone() };
    Ok(SearchResult { best, trials, ended })
}

/// Returns the trade-off between rejection and the largest sensitivity: for each limit of Ms the better of two searches, one
/// started from the given specification and one from the answer before. Limits that cannot be had come with what their best trial
/// misses. `go_on` is asked before each trial; once it says no, every search ends with its first.
///
/// # Errors
/// As [`search_specification`].
pub fn trade_off(
    task: &SearchTask<'_>,
    ms_limits: &[f64],
    go_on: &mut dyn FnMut(&SearchTrial) -> bool,
) -> Result<Vec<SearchResult>, Error> {
    let mut curve: Vec<SearchResult> = Vec::new();
    for &ms in ms_limits {
        let limited = Requirements { ms, ..*task.requirements };
        let before = curve.last().map(|found| found.best.specification.clone());
        let mut best: Option<SearchResult> = None;
        for from in before.iter().chain([task.start]) {
            let found =
                search_specification(&SearchTask { start: from, requirements: &limited, ..*task }, go_on)?;
            if best.as_ref().is_none_or(|other| merit(&found.best) < merit(&other.best)) {
                best = Some(found);
            }
        }
        curve.extend(best);
    }
    Ok(curve)
}

/// Each parameter up and down, then each pair of parameters together and against each other.
fn directions() -> Vec<[f64; PARAMETERS]> {
    let mut all = Vec::new();
    for parameter in 0..PARAMETERS {
        for sign in [1.0, -1.0] {
            let mut direction = [0.0; PARAMETERS];
            direction[parameter] = sign;
            all.push(direction);
        }
    }
    for (first, second) in (0..PARAMETERS).flat_map(|i| (i + 1..PARAMETERS).map(move |j| (i, j))) {
        for (a, b) in [(1.0, 1.0), (-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0)] {
            let mut direction = [0.0; PARAMETERS];
            (direction[first], direction[second]) = (a, b);
            all.push(direction);
        }
    }
    all
}

fn merit(trial: &SearchTrial) -> f64 {
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
    /// Returns whether no parameter is further than [`WEIGHT_REACH`], and no corner is moved beyond half the sampling rate, where nothing sees it.
    fn reaches(&self, parameters: [f64; PARAMETERS]) -> bool {
        let highest = std::f64::consts::PI / self.sampling.period_s;
        let corner = |weight: &Weight| {
            let rational = weight.rational();
            rational.zeros.iter().chain(&rational.poles).map(|root| root.norm()).fold(0.0, f64::max)
        };
        let [_, error, control, _] = parameters.map(f64::exp);
        let below = |weight: &Weight, factor: f64| factor <= 1.0 || factor * corner(weight) <= highest;
        let feedback = &self.start.feedback;
        parameters.iter().all(|parameter| parameter.abs() <= WEIGHT_REACH)
            && below(&feedback.error, error)
            && below(&feedback.control, control)
    }

    fn attempt(&self, parameters: [f64; PARAMETERS]) -> Result<SearchTrial, Error> {
        let specification = move_specification(self.start, parameters);
        let designed = design(self.plant, &specification)?;
        let sampled = discretise(&designed, self.sampling)?;
        let band = self.requirements.band_rad_s;
        let of_all = sampled_loop_figures(self.plant, &sampled, self.sampling, band)?;
        let figures = Figures { rejection: rejection(&sampled.loop_gain, band, &self.powers)?, ..of_all };
        let missed = self.requirements.total_shortfall(&figures);
        Ok(SearchTrial { specification, figures, missed })
    }
}

/// The specification with its parameters multiplied by the factors exp(parameters).
fn move_specification(start: &Specification, parameters: [f64; PARAMETERS]) -> Specification {
    let mut moved = start.clone();
    let [gain, error, control, recovery] = parameters.map(f64::exp);
    moved.feedback.error = stretch_weight(&start.feedback.error, error, gain);
    moved.feedback.control = stretch_weight(&start.feedback.control, control, 1.0);
    moved.feedback.loop_recovery *= recovery;
    debug_assert!(matches!(moved.reference, Reference::Error | Reference::WeightOnly));
    moved
}

/// gain W(s / factor): the corners moved, the modulus kept relative to them.
fn stretch_weight(weight: &Weight, factor: f64, gain: f64) -> Weight {
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
