//! The highest bandwidth that everything allows, and what each limit alone would have allowed.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::OnceLock;

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
    ABOVE_AIM, CAUTION, CEILING, CLEARLY_QUICKER, CLOCK_SHARE, FAR_ABOVE_CEILING, LARGEST_EXCESS,
    NEAR_CEILING, REPAIR_PROGRESS, RISE, STIFF_REACHES,
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
    shape: usize,
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
    have_more_phase: bool,
    /// Those that damp the load.
    damp_the_load: bool,
    /// Those for the plant with stiff modes.
    stiffen_modes: bool,
    /// Number of the answer's own shape, if it is none of those of every search.
    pub refined: Option<usize>,
}

/// Each of some shapes at each of some aims.
fn at_aims(aims_rad_s: &[f64], shapes: Range<usize>) -> Vec<Candidate> {
    let at = |&aim_rad_s: &f64| shapes.clone().map(move |shape| Candidate { aim_rad_s, shape });
    aims_rad_s.iter().flat_map(at).collect()
}

/// Quotient of an aim and the next lower one.
fn step_of_aims() -> f64 {
    10f64.powf(1.0 / f64::from(PER_DECADE))
}

/// Aims per decade.
pub(super) const PER_DECADE: i32 = 10;
/// Highest aim over the ceiling: a little beyond, so that limits above it are told too.
const REACH: f64 = 3.0;
/// Decades of aims.
const DECADES: i32 = 5;
/// Halvings of the stretch between the answer and the aim above it: a tenth of a decade becomes 0.7 %.
const HALVINGS: usize = 5;
/// No loop with a delay reaches a bandwidth of this over the delay: it would cost 115 degrees.
const DELAY_REACH: f64 = 2.0;

/// Factors by which the multiples of the answer's shape are varied.
const VARIATIONS: [f64; 2] = [1.5, 1.2];

/// Steps of a repair, at most.
const REPAIR_STEPS: usize = 12;
/// Loops that are repaired, at most.
const REPAIRED: usize = 3;
/// How far candidates are judged.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Thoroughness {
    /// To their end.
    Everything,
    /// Until they miss so many limits.
    Misses { most: usize },
    /// Until they miss a limit, or are seen not to be promising.
    Improvements,
}

impl Thoroughness {
    /// Returns the number of missed limits at which a candidate is judged no further; `None` if it is judged to its end.
    fn most_missed(self) -> Option<usize> {
        match self {
            Thoroughness::Everything => None,
            Thoroughness::Misses { most } => Some(most),
            Thoroughness::Improvements => Some(1),
        }
    }
}

/// The search over the aim.
pub(super) struct Scan<'a> {
    pub circumstances: &'a Circumstances,
    judge: Judge<'a>,
    gain: PlantGain,
    /// The shapes by number: those of every search, then those that a refinement tried.
    pub shapes: Vec<Shape>,
    pub unknown: Vec<Unknown>,
    tried: Vec<TriedFeedback>,
    best: Option<TriedFeedback>,
    /// The shapes that are tried beside the usual ones.
    pub further_shapes: FurtherShapes,
    /// How far candidates are judged.
    thoroughness: Thoroughness,
    /// Factor by which the bandwidth of a loop may rise above it.
    rise_above: f64,
    pub pool: &'a dyn Pool,
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
        let gain = PlantGain::of(circumstances, modes.iter().map(|mode| mode.norm()).collect())?;
        let unknown = list_unknowns(circumstances, &gain.modes);
        let judge = Judge::new(circumstances, &neighbours)?;
        let attempts = BTreeMap::new();
        Ok(Self {
            circumstances,
            judge,
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

    /// The ceiling that sample rate, ignorance and what was asked for set, rad/s.
    fn ceiling(&self) -> f64 {
        let asked = self.circumstances.asked_rad_s.unwrap_or(f64::INFINITY);
        self.sample_ceiling().min(asked)
    }

    fn sample_ceiling(&self) -> f64 {
        let caution = CAUTION.powi(self.unknown.len() as i32);
        CEILING * self.circumstances.sampling.rate_rad_s() * caution
    }

    /// Tries aims from above the ceiling downwards until none can have a higher bandwidth than one that keeps everything, and closes in on the highest.
    /// A shape that attenuates modes may keep everything at an aim far above its bandwidth, and be slower than what a lower aim gives.
    ///
    /// # Errors
    /// Those of the design.
    pub fn run(&mut self) -> Result<(), Error> {
        let highest = self.highest_aim();
        let descent = self.descent(highest);
        for (at, &Candidate { aim_rad_s: aim, shape }) in descent.iter().enumerate() {
            if ABOVE_AIM * aim <= self.best_bandwidth() {
                break;
            }
            self.look_ahead(descent[at..].iter().copied());
            let Some(tried) = self.attempt(aim, shape)? else { continue };
            self.tried.push(tried.clone());
            if self.is_promising(&tried.judgement) && self.keeps_all(&tried.judgement) {
                let above =
                    descent[..at].iter().rev().map(|tried| tried.aim_rad_s).find(|other| *other != aim);
                self.take_if_higher(tried, above)?;
            }
        }
        if self.is_free_of_clock() {
            self.attenuate_modes(highest)?;
        }
        let is_slow = self.best.is_none() || self.is_free_of_clock();
        if is_slow && self.gain.load.is_some() {
            self.damp_load(highest)?;
        }
        let has_modes = !self.gain.modes.is_empty();
        let may_stiffen = self.circumstances.may_stiffen_modes && has_modes && is_slow;
        if let Some(best) = self.best.clone() {
            let controller = self.controller(&best.weights, best.position_gain)?;
            self.judge.put_hardest_first(&controller, &best.judgement)?;
        }
        if self.best.is_none() {
            self.repair_nearest()?;
        }
        for reach in STIFF_REACHES {
            let before = self.best_bandwidth();
            if may_stiffen {
                self.stiffen_modes(highest, reach)?;
            }
            if reach == STIFF_REACHES[0] || self.best_bandwidth() > before {
                self.refine()?;
            }
        }
        self.further_shapes.refined =
            self.best.as_ref().map(|best| best.shape).filter(|shape| *shape >= SHAPES.len());
        Ok(())
    }

    /// Varies the multiples of the answer's shape, one after the other, as long as the bandwidth rises.
    fn refine(&mut self) -> Result<(), Error> {
        if self.best_bandwidth() > NEAR_CEILING * self.ceiling() {
            return Ok(());
        }
        self.rise_above = 1.0 / (1.0 + RISE);
        self.judge_by(Thoroughness::Improvements);
        // Where a wide variation does not help, a narrow one hardly does.
        let [wide, narrow] = VARIATIONS;
        if self.vary(wide)? {
            while self.vary(wide)? {}
            while self.vary(narrow)? {}
        }
        self.judge_by(Thoroughness::Everything);
        Ok(())
    }

    /// Varies each multiple of the answer's shape by a factor either way. Returns whether the bandwidth rose.
    fn vary(&mut self, factor: f64) -> Result<bool, Error> {
        let Some(start) = self.best.clone() else { return Ok(false) };
        let from = self.shapes.len();
        let varied = self.shapes[start.shape].variations(factor);
        self.shapes.extend(varied);
        let aims = [start.aim_rad_s * step_of_aims().cbrt(), start.aim_rad_s];
        for shape in from..self.shapes.len() {
            for aim_rad_s in aims {
                self.look_ahead(at_aims(&aims, shape..self.shapes.len()).into_iter());
                let Some(tried) = self.attempt(aim_rad_s, shape)? else { continue };
                if self.is_promising(&tried.judgement) && self.keeps_all(&tried.judgement) {
                    self.take_if_higher(tried, Some(aim_rad_s * step_of_aims()))?;
                    break;
                }
            }
        }
        Ok(self.best_bandwidth() > (1.0 + RISE) * start.judgement.bandwidth_rad_s)
    }

    /// Varies the shapes of the loops that miss their limits least until one keeps everything: where more is required than usual, none of the shapes of the search
    /// may keep it.
    fn repair_nearest(&mut self) -> Result<(), Error> {
        let mut nearest: Vec<TriedFeedback> = self.tried.clone();
        nearest.sort_by(|a, b| self.excess(&a.judgement).total_cmp(&self.excess(&b.judgement)));
        for start in nearest.into_iter().take(REPAIRED) {
            if let Some(kept) = self.repair(start)? {
                return self.take_if_higher(kept, None);
            }
        }
        Ok(())
    }

    /// Varies the multiples of a loop's shape, and its aim, in the way that lowers most by how much it misses its limits; `None` if that does not end in a
    /// loop that keeps everything.
    fn repair(&mut self, start: TriedFeedback) -> Result<Option<TriedFeedback>, Error> {
        let mut nearest = start;
        for _ in 0..REPAIR_STEPS {
            let from = self.shapes.len();
            let varied = self.shapes[nearest.shape].variations(VARIATIONS[0]);
            self.shapes.extend(varied);
            let aims = [nearest.aim_rad_s, nearest.aim_rad_s / step_of_aims()];
            let mut all = at_aims(&aims[..1], from..self.shapes.len());
            all.extend(at_aims(&aims[1..], nearest.shape..nearest.shape + 1));
            let mut better: Option<TriedFeedback> = None;
            for (k, candidate) in all.iter().enumerate() {
                self.look_ahead(all[k..].iter().copied());
                let Some(tried) = self.attempt(candidate.aim_rad_s, candidate.shape)? else { continue };
                if self.keeps_all(&tried.judgement) {
                    return Ok(Some(tried));
                }
                let least =
                    better.as_ref().map_or(REPAIR_PROGRESS * self.excess(&nearest.judgement), |one| {
                        self.excess(&one.judgement)
                    });
                if self.excess(&tried.judgement) < least {
                    better = Some(tried);
                }
            }
            let Some(better) = better else { return Ok(None) };
            nearest = better;
        }
        Ok(None)
    }

    /// Returns by how much a loop misses its limits: the sum of the logarithms of what it has over what is allowed.
    fn excess(&self, found: &LoopJudgement) -> f64 {
        let given = self.circumstances;
        let over = found.shares_of_limits(&given.margins, given.sampling.limit_v, given.holding_v);
        over.into_iter().map(|share| share.max(1.0).ln().min(LARGEST_EXCESS)).sum()
    }

    /// Returns whether the answer is far below what the clock allows.
    fn is_free_of_clock(&self) -> bool {
        self.best.is_some() && self.best_bandwidth() < CLOCK_SHARE * self.sample_ceiling()
    }

    /// Tries the shapes that attenuate modes and leave more phase, from the highest aim at which 3 or 4 lacks nothing but phase down to the
    /// answer.
    fn attenuate_modes(&mut self, highest_rad_s: f64) -> Result<(), Error> {
        self.further_shapes.have_more_phase = true;
        let two_aims = |aim_rad_s: f64| at_aims(&[aim_rad_s, aim_rad_s / step_of_aims()], DEAR);
        self.descend(highest_rad_s, 0.0, MORE_PHASE..DAMPED_LOAD, two_aims)?;
        // Without an answer among them they are no part of the search for what limits it.
        self.further_shapes.have_more_phase = self.has_answer_among(MORE_PHASE..DAMPED_LOAD);
        Ok(())
    }

    /// Tries the shapes that damp the load, from the highest aim down to the answer.
    fn damp_load(&mut self, highest_rad_s: f64) -> Result<(), Error> {
        self.further_shapes.damp_the_load = true;
        let (shapes, lowest) = (DAMPED_LOAD..STIFF_MODES, highest_rad_s * 10f64.powi(-DECADES));
        self.descend(highest_rad_s, lowest, shapes.clone(), |aim_rad_s| {
            at_aims(&[aim_rad_s], shapes.clone())
        })?;
        self.further_shapes.damp_the_load = self.has_answer_among(shapes);
        Ok(())
    }

    /// Tries the shapes for the plant with stiff modes, from the highest aim, or that many times the answer, down to the answer.
    fn stiffen_modes(&mut self, highest_rad_s: f64, reach: f64) -> Result<(), Error> {
        let had_answer = std::mem::replace(&mut self.further_shapes.stiffen_modes, true);
        self.rise_above = step_of_aims();
        self.judge_by(Thoroughness::Improvements);
        let before = self.best.clone();
        let (shapes, lowest) = (STIFF_MODES..SHAPES.len(), highest_rad_s * 10f64.powi(-DECADES));
        let highest_rad_s = match self.best_bandwidth() {
            0.0 => highest_rad_s,
            best => highest_rad_s.min(reach * best),
        };
        self.descend(highest_rad_s, lowest, shapes.clone(), |aim_rad_s| {
            at_aims(&[aim_rad_s], shapes.clone())
        })?;
        self.judge_by(Thoroughness::Everything);
        // A design on the plant as it is has costs that are those of the loop: it gives way to one that is clearly quicker.
        let quickest = before.as_ref().map_or(0.0, |before| before.judgement.bandwidth_rad_s);
        if self.best_bandwidth() < CLEARLY_QUICKER * quickest {
            self.best = before;
        }
        let is_refined = self.best.as_ref().is_some_and(|best| best.shape >= SHAPES.len());
        self.further_shapes.stiffen_modes = self.has_answer_among(shapes) || (is_refined && had_answer);
        Ok(())
    }

    /// Improves the answer by further shapes, from the highest aim down to the answer or the lowest aim. What `upcoming` gives for an aim is judged side by
    /// side before.
    fn descend(
        &mut self,
        highest_rad_s: f64,
        lowest_rad_s: f64,
        shapes: Range<usize>,
        upcoming: impl Fn(f64) -> Vec<Candidate>,
    ) -> Result<(), Error> {
        let mut aim = highest_rad_s;
        while ABOVE_AIM * aim > self.best_bandwidth() && aim > lowest_rad_s {
            for (k, shape) in shapes.clone().enumerate() {
                self.look_ahead(upcoming(aim).into_iter().skip(k));
                self.improve(aim, shape)?;
            }
            aim /= step_of_aims();
        }
        Ok(())
    }

    fn has_answer_among(&self, shapes: Range<usize>) -> bool {
        self.best.as_ref().is_some_and(|best| shapes.contains(&best.shape))
    }

    /// Takes the feedback of an aim and a further shape, or one of an aim closely above, if it keeps everything and has a higher bandwidth than
    /// the answer.
    fn improve(&mut self, aim_rad_s: f64, shape: usize) -> Result<(), Error> {
        let Some(found) = self.attempt_if_worthwhile(aim_rad_s, shape)? else { return Ok(()) };
        if self.is_promising(&found.judgement) && self.keeps_all(&found.judgement) {
            self.take_if_higher(found, Some(aim_rad_s * step_of_aims()))?;
        }
        Ok(())
    }

    /// Closes in on the aim above a feedback that keeps everything, and takes the result if its bandwidth is higher than the answer's.
    fn take_if_higher(&mut self, found: TriedFeedback, above: Option<f64>) -> Result<(), Error> {
        let closer = self.close_in(found, above)?;
        if closer.judgement.bandwidth_rad_s > self.best_bandwidth() {
            self.best = Some(closer);
        }
        Ok(())
    }

    /// Whether a loop, or one of an aim that is tried above it, may have a higher bandwidth than the answer: between two aims the bandwidth rises no
    /// more than the aim.
    fn is_promising(&self, found: &LoopJudgement) -> bool {
        found.bandwidth_rad_s * self.rise_above > self.best_bandwidth()
    }

    /// The bandwidth of the best feedback so far, rad/s; 0 if there is none.
    fn best_bandwidth(&self) -> f64 {
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

    /// Aims from the highest downwards, each with the shapes that are tried there.
    fn descent(&self, highest: f64) -> Vec<Candidate> {
        let far = FAR_ABOVE_CEILING * self.ceiling();
        let aim = |k: i32| highest * 10f64.powf(-f64::from(k) / f64::from(PER_DECADE));
        let shapes = |aim_rad_s: f64| {
            let count = if aim_rad_s > far { 1 } else { MORE_PHASE };
            (0..count).map(move |shape| Candidate { aim_rad_s, shape })
        };
        (0..DECADES * PER_DECADE).map(aim).flat_map(shapes).collect()
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
    fn judge_by(&mut self, thoroughness: Thoroughness) {
        self.thoroughness = thoroughness;
        self.ahead.clear();
        if thoroughness == Thoroughness::Everything {
            self.attempts.retain(|(_, shape), _| *shape < STIFF_MODES);
        }
    }

    /// Halves the stretch between an aim that keeps everything and one above it that does not, if there is one, as long as an aim in between may have
    /// a higher bandwidth than the answer. Returns the highest that keeps everything.
    fn close_in(&mut self, found: TriedFeedback, above: Option<f64>) -> Result<TriedFeedback, Error> {
        let Some(mut high) = above else { return Ok(found) };
        let mut best = found;
        for _ in 0..HALVINGS {
            // Between two aims the bandwidth rises no more than the aim.
            if best.judgement.bandwidth_rad_s * high / best.aim_rad_s <= self.best_bandwidth() {
                break;
            }
            let middle = (best.aim_rad_s * high).sqrt();
            match self.attempt(middle, best.shape)? {
                Some(tried) if self.keeps_all(&tried.judgement) => best = tried,
                _ => high = middle,
            }
        }
        Ok(best)
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
            let is_slow = self.thoroughness == Thoroughness::Improvements && !self.is_promising(found);
            let most = self.thoroughness.most_missed();
            let misses_too_many = most.is_some_and(|most| self.missed_limits(found).len() >= most);
            is_slow || misses_too_many
        })?;
        Ok(judged.map(|judgement| TriedFeedback { aim_rad_s, shape, weights, position_gain, judgement }))
    }

    /// The feedback of weights, with the position loop about it if the plant has one.
    fn controller(&self, weights: &FeedbackWeights, position_gain: Option<f64>) -> Result<StateSpace, Error> {
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

    fn keeps_all(&self, found: &LoopJudgement) -> bool {
        found.bandwidth_rad_s <= self.ceiling() && KINDS.into_iter().all(|kind| self.keeps(kind, found))
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
        let limit =
            |kind| BandwidthLimit { kind, bandwidth_rad_s: self.highest_bandwidth(kind), lifted_rad_s: None };
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

fn list_unknowns(given: &Circumstances, modes: &[f64]) -> Vec<Unknown> {
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
