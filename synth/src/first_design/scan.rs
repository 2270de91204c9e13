//! The highest bandwidth that everything allows, and what each limit alone would have allowed.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::OnceLock;

use counterpoise_linalg::C64;
use counterpoise_lti::StateSpace;

use super::candidate::{
    DAMPED_LOAD, DEAR, MORE_PHASE, PlantGain, SHAPES, STIFF_MODES, Shape, position_gain, weights,
};
use super::judgement::{Judge, LoopJudgement};
use super::{Circumstances, ControlLimit};
use crate::bandwidth::{BandwidthLimit, LimitKind, Unknown};
use crate::cascade::with_position_loop;
use crate::error::attempt;
use crate::modes::{light_modes, shifted_modes};
use crate::tolerance::{
    CAUTION, CEILING, FEWEST_DESIGNS, HIGHER_BANDWIDTH, LARGEST_EXCESS, MOST_DESIGNS, WORK_OF_SEARCH,
};
use crate::{Error, FeedbackWeights, LightModes, Reference, design_feedback};
use counterpoise_pool::Pool;

/// A feedback to be tried.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Candidate {
    /// The bandwidth that it aims at, rad/s.
    pub aim_rad_s: f64,
    /// Number of its shape.
    pub shape: usize,
}

/// A feedback that was tried.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct TriedFeedback {
    pub aim_rad_s: f64,
    /// Number of its shape.
    pub shape: usize,
    pub weights: FeedbackWeights,
    pub position_gain: Option<f64>,
    pub judgement: LoopJudgement,
}

impl Candidate {
    /// The key by which a judged candidate is found again.
    fn key(self) -> (u64, usize) {
        (self.aim_rad_s.to_bits(), self.shape)
    }
}

/// The shapes that a search tries beside the usual ones.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct FurtherShapes {
    /// Those that attenuate modes and leave more phase.
    pub have_more_phase: bool,
    /// Those that damp the load.
    pub damp_the_load: bool,
    /// Those for the plant with stiff modes.
    pub stiffen_modes: bool,
    /// Number of the answer's own shape, if it is none of those of every search.
    pub refined: Option<usize>,
}

/// Each of some shapes at each of some aims.
pub(super) fn at_aims(aims_rad_s: &[f64], shapes: Range<usize>) -> Vec<Candidate> {
    let at = |&aim_rad_s: &f64| shapes.clone().map(move |shape| Candidate { aim_rad_s, shape });
    aims_rad_s.iter().flat_map(at).collect()
}

/// Quotient of an aim and the next lower one.
pub(super) fn step_of_aims() -> f64 {
    10f64.powf(1.0 / f64::from(PER_DECADE))
}

/// Aims per decade.
pub(super) const PER_DECADE: i32 = 10;
/// Highest aim over the ceiling: a little beyond, so that limits above it are told too.
const REACH: f64 = 3.0;
/// States that error and control weight add to a design, about.
const ORDER_OF_WEIGHTS: usize = 4;
/// No loop with a delay reaches a bandwidth of this over the delay: it would cost 115 degrees.
const DELAY_REACH: f64 = 2.0;

/// How near a loop must come to a bandwidth and to all limits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Approach {
    /// The bandwidth, rad/s.
    pub target_rad_s: f64,
    /// By how much it may miss it and the limits: less than this.
    pub least_miss: f64,
}

/// How far candidates are judged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Thoroughness {
    /// To their end.
    Everything,
    /// Until they miss so many limits.
    Misses { most: usize },
    /// Until they miss a limit, or are seen not to be promising.
    Improvements,
    /// Until they miss their limits by so much.
    Nearer(Approach),
}

impl Thoroughness {
    /// Returns the number of missed limits at which a candidate is judged no further; `None` if it is judged to its end.
    fn most_missed(self) -> Option<usize> {
        match self {
            Thoroughness::Everything | Thoroughness::Nearer(_) => None,
            Thoroughness::Misses { most } => Some(most),
            Thoroughness::Improvements => Some(1),
        }
    }
}

/// The search over the aim.
pub(super) struct Scan<'a> {
    pub circumstances: &'a Circumstances,
    pub judge: Judge<'a>,
    pub gain: PlantGain,
    /// Whether the plant has lightly damped modes.
    pub has_modes: bool,
    /// The shapes by number: those of every search, then those that a refinement tried.
    pub shapes: Vec<Shape>,
    pub unknown: Vec<Unknown>,
    pub tried: Vec<TriedFeedback>,
    pub best: Option<TriedFeedback>,
    /// The shapes that are tried beside the usual ones.
    pub further_shapes: FurtherShapes,
    /// How far candidates are judged.
    thoroughness: Thoroughness,
    /// Factor by which the bandwidth of a loop may rise above it.
    pub rise_above: f64,
    pub pool: &'a dyn Pool,
    /// Feedbacks that were designed, also those that are forgotten.
    designs: usize,
    /// Feedbacks that are designed at most before a search ends with what it has.
    most_designs: usize,
    /// Every feedback that was designed, by the bits of its aim and its shape; `None` if there is none, its loop is not stable or, where one
    /// miss is too many, its sensitivity is seen to be too large.
    attempts: BTreeMap<(u64, usize), Option<TriedFeedback>>,
    /// Candidates that were judged before the search asked for them. It does not know of those that it never asks for.
    ahead: BTreeMap<(u64, usize), Result<Option<TriedFeedback>, Error>>,
}

impl<'a> Scan<'a> {
    /// Prepares the scan.
    ///
    /// # Errors
    /// Those of the plant.
    pub fn new(circumstances: &'a Circumstances, pool: &'a dyn Pool) -> Result<Self, Error> {
        let modes = light_modes(&circumstances.plant)?;
        let neighbours = shifted_modes(&circumstances.plant, &modes)?;
        let attenuated = if modes.is_empty() { softest_modes(circumstances)? } else { modes.clone() };
        let gain = PlantGain::of(circumstances, attenuated.iter().map(|mode| mode.norm()).collect())?;
        let unknown = list_unknowns(circumstances, &modes);
        let judge = Judge::new(circumstances, &neighbours)?;
        let attempts = BTreeMap::new();
        let of_controller = circumstances.plant.weighted_plant().measured_plant()?.order() + ORDER_OF_WEIGHTS;
        let order = of_controller + judge.largest_order();
        Ok(Self {
            designs: 0,
            most_designs: (WORK_OF_SEARCH / order.pow(3)).clamp(FEWEST_DESIGNS, MOST_DESIGNS),
            circumstances,
            judge,
            has_modes: !modes.is_empty(),
            gain,
            shapes: SHAPES.to_vec(),
            unknown,
            tried: Vec::new(),
            best: None,
            further_shapes: FurtherShapes::default(),
            thoroughness: Thoroughness::Everything,
            rise_above: step_of_aims(),
            pool,
            attempts,
            ahead: BTreeMap::new(),
        })
    }

    /// Sets the designs that are allowed from here on to a share, as for one of several searches after the first.
    pub fn limit_designs_to(&mut self, share: f64) {
        self.most_designs = self.designs + (share * self.most_designs as f64) as usize;
    }

    /// Returns whether the search may design more feedbacks. Work is counted and not timed, so that the same file gives the same answer on every machine.
    pub fn may_design_more(&self) -> bool {
        self.designs < self.most_designs
    }

    /// Returns the ceiling that sample rate, ignorance and what was asked for set, rad/s.
    pub fn ceiling(&self) -> f64 {
        let asked = self.circumstances.asked_rad_s.unwrap_or(f64::INFINITY);
        self.sample_ceiling().min(asked)
    }

    pub fn sample_ceiling(&self) -> f64 {
        let caution = CAUTION.powi(self.unknown.len() as i32);
        CEILING * self.circumstances.sampling.rate_rad_s() * caution
    }

    /// Returns whether a loop, or one of an aim that is tried above it, may have a higher bandwidth than the answer: between two aims the bandwidth rises no
    /// more than the aim.
    pub fn is_promising(&self, found: &LoopJudgement) -> bool {
        found.bandwidth_rad_s * self.rise_above > self.best_bandwidth()
    }

    /// Returns the bandwidth of the best feedback so far, rad/s; 0 if there is none.
    pub fn best_bandwidth(&self) -> f64 {
        self.best.as_ref().map_or(0.0, |best| best.judgement.bandwidth_rad_s)
    }

    /// Takes over the shapes that another search tries.
    pub fn adopt_shapes(&mut self, shapes: &[Shape], further: FurtherShapes) {
        (self.shapes, self.further_shapes) = (shapes.to_vec(), further);
    }

    /// Returns the numbers of the shapes with which a limit is lifted: those of every search, then the answer's own.
    pub fn shapes_to_climb(&self) -> impl Iterator<Item = usize> + use<> {
        (0..SHAPES.len()).chain(self.further_shapes.refined)
    }

    /// Returns the highest aim that is looked at, rad/s.
    pub fn highest_aim(&self) -> f64 {
        let sampling = &self.circumstances.sampling;
        let samples_s = sampling.delay_samples as f64 * sampling.period_s;
        let late_s = self.circumstances.plant.late_reading.as_ref().map_or(0.0, |reading| reading.delay_s);
        let delay_s = self.circumstances.plant.delay_s.max(samples_s) + late_s + 0.5 * sampling.period_s;
        (REACH * CEILING * sampling.rate_rad_s()).min(DELAY_REACH / delay_s)
    }

    /// Judges the next candidates of a search side by side, as many as there are processors, if the first of them is not known yet.
    pub fn look_ahead(&mut self, upcoming: impl Iterator<Item = Candidate>) {
        let is_known = |candidate: &Candidate| {
            let key = candidate.key();
            self.attempts.contains_key(&key) || self.ahead.contains_key(&key)
        };
        let mut upcoming = upcoming.peekable();
        if self.pool.processors() < 2 || upcoming.peek().is_none_or(is_known) {
            return;
        }
        let next: Vec<Candidate> =
            upcoming.filter(|next| !is_known(next)).take(self.pool.processors()).collect();
        let found: Vec<OnceLock<_>> = next.iter().map(|_| OnceLock::new()).collect();
        self.pool.run(next.len(), &|k| drop(found[k].set(self.judge_aim(next[k].aim_rad_s, next[k].shape))));
        let keys = next.into_iter().map(|candidate| candidate.key());
        let judged = keys.zip(found).filter_map(|(key, one)| Some((key, one.into_inner()?)));
        self.ahead.extend(judged);
    }

    /// Judges candidates from now on no further if they miss so many limits already.
    pub fn judge_up_to(&mut self, most: usize) {
        self.judge_by(Thoroughness::Misses { most });
    }

    /// Judges candidates from now on so far. Those for stiff modes and with a shape of the answer's own, which alone are judged for improvements, are
    /// forgotten at the end of it: the search for what limits the answer must know more of them than their first miss.
    pub fn judge_by(&mut self, thoroughness: Thoroughness) {
        self.thoroughness = thoroughness;
        self.ahead.clear();
        if thoroughness == Thoroughness::Everything {
            self.attempts.retain(|(_, shape), _| *shape < STIFF_MODES);
        }
    }

    /// Judges candidates from now on until they are seen to be no nearer than asked for.
    pub fn judge_nearer(&mut self, approach: Approach) {
        self.thoroughness = Thoroughness::Nearer(approach);
    }

    /// Returns the feedback of an aim and the number of a shape as [`Self::attempt`] does; `None` also if the shape is not among those that are
    /// tried, or leaves more phase and the shapes that it stands in for miss something else.
    ///
    /// # Errors
    /// Those of the design.
    pub fn attempt_if_worthwhile(
        &mut self,
        aim_rad_s: f64,
        shape: usize,
    ) -> Result<Option<TriedFeedback>, Error> {
        const KNOWN: usize = SHAPES.len();
        let FurtherShapes { have_more_phase, damp_the_load, stiffen_modes, refined } = self.further_shapes;
        let is_tried = match shape {
            ..MORE_PHASE => true,
            DAMPED_LOAD..STIFF_MODES => damp_the_load,
            STIFF_MODES..KNOWN => stiffen_modes,
            KNOWN.. => refined == Some(shape),
            _ => false,
        };
        if is_tried {
            return self.attempt(aim_rad_s, shape);
        }
        if shape >= DAMPED_LOAD || !have_more_phase {
            return Ok(None);
        }
        for usual in DEAR {
            let lacks_phase = match self.attempt(aim_rad_s, usual)? {
                Some(tried) => self.missed_limits(&tried.judgement) == [LimitKind::Margins],
                // Where one miss is too many, a candidate that misses the margins is not kept.
                None => self.thoroughness.most_missed() == Some(1),
            };
            if lacks_phase {
                self.look_ahead((shape..DAMPED_LOAD).map(|shape| Candidate { aim_rad_s, shape }));
                return self.attempt(aim_rad_s, shape);
            }
        }
        Ok(None)
    }

    /// Returns the feedback of an aim and the number of a shape; `None` if there is none or its loop is not stable.
    ///
    /// # Errors
    /// Those of the design.
    pub fn attempt(&mut self, aim_rad_s: f64, shape: usize) -> Result<Option<TriedFeedback>, Error> {
        let key = (aim_rad_s.to_bits(), shape);
        if let Some(known) = self.attempts.get(&key) {
            return Ok(known.clone());
        }
        let found = match self.ahead.remove(&key) {
            Some(judged) => judged?,
            None => self.judge_aim(aim_rad_s, shape)?,
        };
        self.designs += 1;
        self.attempts.insert(key, found.clone());
        Ok(found)
    }

    fn judge_aim(&self, aim_rad_s: f64, shape: usize) -> Result<Option<TriedFeedback>, Error> {
        let weights =
            self.shapes.get(shape).and_then(|s| weights(self.circumstances, &self.gain, aim_rad_s, *s));
        let Some(weights) = weights else { return Ok(None) };
        let position_gain = position_gain(self.circumstances, aim_rad_s);
        let controller = match (self.controller(&weights, position_gain), weights.modes) {
            (Ok(controller), _) => controller,
            // A plant that is nothing but its modes may have no design with them moved.
            (Err(_), LightModes::Stiffened) => return Ok(None),
            (Err(error), LightModes::Kept) => return attempt(Err(error)).map(|_: Result<(), _>| None),
        };
        if self.thoroughness.most_missed() == Some(1)
            && self.judge.exceeds_sensitivity(&controller, aim_rad_s)?
        {
            return Ok(None);
        }
        let judged = self.judge.judge(&controller, |found| {
            if let Thoroughness::Nearer(approach) = self.thoroughness {
                return self.miss(found, approach.target_rad_s) >= approach.least_miss;
            }
            let is_slow = self.thoroughness == Thoroughness::Improvements && !self.is_promising(found);
            let most = self.thoroughness.most_missed();
            let misses_too_many = most.is_some_and(|most| self.missed_limits(found).len() >= most);
            is_slow || misses_too_many
        })?;
        Ok(judged.map(|judgement| TriedFeedback { aim_rad_s, shape, weights, position_gain, judgement }))
    }

    /// Returns the feedback of weights, with the position loop about it if the plant has one.
    pub fn controller(
        &self,
        weights: &FeedbackWeights,
        position_gain: Option<f64>,
    ) -> Result<StateSpace, Error> {
        let plant = &self.circumstances.plant;
        let designed = design_feedback(plant.weighted_plant(), weights, Reference::Error)?;
        let cascade = with_position_loop(plant, &designed.controller, position_gain)?;
        Ok(cascade.unwrap_or(designed.controller))
    }

    /// Returns the sampled loops on which a feedback was judged: that of the plant, then those of the plants with shifted modes.
    ///
    /// # Errors
    /// Those of the design.
    pub fn loops(&self, tried: &TriedFeedback) -> Result<Vec<StateSpace>, Error> {
        self.judge.loops(&self.controller(&tried.weights, tried.position_gain)?)
    }

    pub fn keeps_all(&self, found: &LoopJudgement) -> bool {
        found.bandwidth_rad_s <= self.ceiling() && KINDS.into_iter().all(|kind| self.keeps(kind, found))
    }

    /// Returns by how much a loop misses its limits and a bandwidth: the sum of the logarithms of what it has over what is allowed.
    pub fn miss(&self, found: &LoopJudgement, target_rad_s: f64) -> f64 {
        let given = self.circumstances;
        let shares = found.shares_of_limits(&given.margins, &given.sampling, given.holding_v);
        let is_beside = |kind| matches!(kind, LimitKind::Resonance | LimitKind::AtRest);
        // Shifted modes and what the linear plant leaves out are missed together: they count once.
        let (beside, over): (Vec<_>, Vec<_>) = shares.into_iter().partition(|(kind, _)| is_beside(*kind));
        let beside = beside.into_iter().map(|(_, share)| share).fold(0.0, f64::max);
        let rates = [beside, found.bandwidth_rad_s / self.ceiling(), target_rad_s / found.bandwidth_rad_s];
        let all = over.into_iter().map(|(_, share)| share).chain(rates);
        all.map(|share| share.max(1.0).ln().min(LARGEST_EXCESS)).sum()
    }

    /// Returns the share of what a limit allows that a loop uses up.
    pub fn used_share(&self, kind: LimitKind, found: &LoopJudgement) -> f64 {
        let given = self.circumstances;
        let ceiling = match kind {
            LimitKind::SampleRate => self.sample_ceiling(),
            LimitKind::Asked => given.asked_rad_s.unwrap_or(f64::INFINITY),
            _ => f64::INFINITY,
        };
        let shares = found.shares_of_limits(&given.margins, &given.sampling, given.holding_v);
        let own = shares.into_iter().filter(|(of, _)| *of == kind).map(|(_, share)| share);
        own.fold(found.bandwidth_rad_s / ceiling, f64::max)
    }

    /// Returns the limits that a loop does not keep.
    pub fn missed_limits(&self, found: &LoopJudgement) -> Vec<LimitKind> {
        let kinds = KINDS.into_iter().chain([LimitKind::Asked]);
        kinds.filter(|kind| !self.keeps(*kind, found)).collect()
    }

    fn keeps(&self, kind: LimitKind, found: &LoopJudgement) -> bool {
        let given = self.circumstances;
        let limit_v = given.sampling.limit_v;
        match kind {
            LimitKind::SampleRate => {
                found.bears_sampling(&given.sampling) && found.bandwidth_rad_s <= self.sample_ceiling()
            }
            LimitKind::Margins => found.keeps_margins(&given.margins),
            LimitKind::Resonance => found.bears_shifted_modes(),
            LimitKind::Noise => found.bears_noise(limit_v),
            LimitKind::Quantisation => found.bears_quantisation(limit_v),
            LimitKind::Control => found.bears_step(limit_v - given.holding_v.abs()),
            LimitKind::AtRest => found.holds_others(),
            LimitKind::Tolerances => found.bears_tolerances(),
            LimitKind::UsualRanges => found.bears_usual_ranges(),
            LimitKind::Asked => found.bandwidth_rad_s <= given.asked_rad_s.unwrap_or(f64::INFINITY),
        }
    }

    /// Returns the answer; `None` if nothing keeps everything.
    pub fn best_design(&self) -> Option<TriedFeedback> {
        self.best.clone()
    }

    /// The highest bandwidth that was seen to keep a limit, rad/s; infinite if nothing missed it.
    fn highest_bandwidth(&self, kind: LimitKind) -> f64 {
        match kind {
            LimitKind::SampleRate => return self.sample_ceiling(),
            LimitKind::Asked => return self.circumstances.asked_rad_s.unwrap_or(f64::INFINITY),
            _ => {}
        }
        let mut all = self.tried.iter().chain(&self.best);
        if all.all(|tried| self.keeps(kind, &tried.judgement)) {
            return f64::INFINITY;
        }
        self.highest_keeping(kind).map_or(0.0, |tried| tried.judgement.bandwidth_rad_s)
    }

    /// Returns the fewest limits that only together keep the candidates that were seen from being the answer, the highest bandwidth first; none if no
    /// stable loop above the answer was seen.
    pub fn joint_limits(&self) -> Vec<LimitKind> {
        let reached = self.best_bandwidth() * (1.0 + HIGHER_BANDWIDTH);
        let above = self.tried.iter().filter(|tried| tried.judgement.bandwidth_rad_s > reached);
        let missed =
            above.map(|tried| (self.missed_limits(&tried.judgement), tried.judgement.bandwidth_rad_s));
        let fewest = missed.min_by(|a, b| a.0.len().cmp(&b.0.len()).then(b.1.total_cmp(&a.1)));
        fewest.map(|(kinds, _)| kinds).unwrap_or_default()
    }

    /// The feedback of the highest bandwidth that was seen to keep a limit.
    fn highest_keeping(&self, kind: LimitKind) -> Option<&TriedFeedback> {
        let keeping = self.tried.iter().chain(&self.best).filter(|tried| self.keeps(kind, &tried.judgement));
        keeping.max_by(|a, b| a.judgement.bandwidth_rad_s.total_cmp(&b.judgement.bandwidth_rad_s))
    }

    /// Returns the loop that shows the highest bandwidth that a limit allows; `None` if a formula tells it, if nothing missed the limit, or if nothing
    /// keeps it.
    ///
    /// # Errors
    /// Those of the design.
    pub fn demonstrate_limit(&self, limit: &BandwidthLimit) -> Result<Option<StateSpace>, Error> {
        let is_formula = matches!(limit.kind, LimitKind::SampleRate | LimitKind::Asked);
        match self.highest_keeping(limit.kind) {
            Some(tried) if !is_formula && limit.bandwidth_rad_s.is_finite() => {
                self.nominal_loop(tried).map(Some)
            }
            _ => Ok(None),
        }
    }

    /// Returns the sampled loop of a feedback with the plant, broken at the control.
    ///
    /// # Errors
    /// Those of the design.
    pub fn nominal_loop(&self, tried: &TriedFeedback) -> Result<StateSpace, Error> {
        self.judge.nominal_loop(&self.controller(&tried.weights, tried.position_gain)?)
    }

    /// Returns every limit, the lowest first.
    pub fn summary(&self) -> Vec<BandwidthLimit> {
        let asked = self.circumstances.asked_rad_s.map(|_| LimitKind::Asked);
        let limit = |kind| {
            let bandwidth_rad_s = self.highest_bandwidth(kind);
            let used = self.best.as_ref().map(|best| self.used_share(kind, &best.judgement));
            BandwidthLimit { kind, bandwidth_rad_s, used, lifted_rad_s: None }
        };
        let mut limits: Vec<BandwidthLimit> = KINDS.into_iter().chain(asked).map(limit).collect();
        // Of a machine without friction whose weight does not matter there is nothing to say.
        // Nor of one whose file has no tolerances, or leaves nothing open that sets a mode.
        let may_be_silent =
            |kind| matches!(kind, LimitKind::AtRest | LimitKind::Tolerances | LimitKind::UsualRanges);
        limits.retain(|limit| !may_be_silent(limit.kind) || limit.bandwidth_rad_s.is_finite());
        limits.sort_by(|a, b| a.bandwidth_rad_s.total_cmp(&b.bandwidth_rad_s));
        limits
    }
}

/// The limits of every loop.
const KINDS: [LimitKind; 9] = [
    LimitKind::SampleRate,
    LimitKind::Margins,
    LimitKind::Resonance,
    LimitKind::Noise,
    LimitKind::Quantisation,
    LimitKind::Control,
    LimitKind::AtRest,
    LimitKind::Tolerances,
    LimitKind::UsualRanges,
];

/// Returns the lightly damped modes at the softest that is usual, if the plant has none: weights that attenuate modes attenuate those.
fn softest_modes(given: &Circumstances) -> Result<Vec<C64>, Error> {
    let mut softest: Vec<C64> = Vec::new();
    for plant in &given.usual.within_ranges {
        let modes = light_modes(plant)?;
        let slowest = |modes: &[C64]| modes.first().map_or(f64::INFINITY, |mode| mode.norm());
        if slowest(&modes) < slowest(&softest) {
            softest = modes;
        }
    }
    Ok(softest)
}

fn list_unknowns(given: &Circumstances, modes: &[C64]) -> Vec<Unknown> {
    let sensor_lags = given.plant.hub_sensor.as_ref().is_some_and(|sensor| sensor.order() > 0)
        || given.plant.late_reading.is_some();
    let all = [
        (Unknown::Structure, modes.is_empty()),
        (Unknown::Noise, !given.is_reading_known()),
        (Unknown::Sensor, !sensor_lags),
        (
            Unknown::Delay,
            given.plant.delay_s == 0.0
                && given.sampling.delay_samples == 0
                && given.plant.late_reading.is_none(),
        ),
        (Unknown::Demand, given.demand_step == 0.0),
        (Unknown::DriveLimit, given.control_limit == ControlLimit::OfConverter),
    ];
    let is_open = |(fact, is_unknown): &(Unknown, bool)| *is_unknown && !given.known_absent.contains(fact);
    all.into_iter().filter(is_open).map(|(fact, _)| fact).collect()
}
