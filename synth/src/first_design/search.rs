//! The stages of the search: aims from the highest downwards, further shapes where the clock is not what limits, and variations of the answer.

use std::ops::Range;

use super::candidate::{DAMPED_LOAD, DEAR, MORE_PHASE, SHAPES, STIFF_MODES};
use super::scan::{Candidate, PER_DECADE, Scan, Thoroughness, TriedFeedback, at_aims, step_of_aims};
use crate::tolerance::{
    ABOVE_AIM, CLEARLY_QUICKER, CLOCK_SHARE, FAR_ABOVE_CEILING, HIGHER_BANDWIDTH, NEAR_CEILING, RISE,
    STIFF_REACHES,
};
use crate::{Error, LightModes};

/// Decades of aims.
const DECADES: i32 = 5;
/// Halvings of the stretch between the answer and the aim above it: a tenth of a decade becomes 0.7 %.
const HALVINGS: usize = 5;
/// Factors by which the multiples of the answer's shape are varied.
const VARIATIONS: [f64; 2] = [1.5, 1.2];

impl Scan<'_> {
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
        // No loop is quicker than the answer, because of the clock or of what is asked for.
        if self.best_bandwidth() * (1.0 + HIGHER_BANDWIDTH) >= self.ceiling() {
            return Ok(());
        }
        if self.is_free_of_clock() {
            self.attenuate_modes(highest)?;
        }
        let is_slow = self.best.is_none() || self.is_free_of_clock();
        if is_slow && self.gain.load.is_some() {
            self.damp_load(highest)?;
        }
        let may_stiffen = self.circumstances.may_stiffen_modes && self.has_modes && is_slow;
        if let Some(best) = self.best.clone() {
            let controller = self.controller(&best.weights, best.position_gain)?;
            self.judge.put_hardest_first(&controller, &best.judgement)?;
        }
        if self.best.is_none() {
            self.approach_from_tried()?;
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
        let plants = [LightModes::Kept, LightModes::Stiffened];
        let plants = if may_stiffen { &plants[..] } else { &plants[..1] };
        if is_slow && self.approach_from_kinds(plants)? {
            self.refine()?;
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
            while self.may_design_more() && self.vary(wide)? {}
            while self.may_design_more() && self.vary(narrow)? {}
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
        while ABOVE_AIM * aim > self.best_bandwidth() && aim > lowest_rad_s && self.may_design_more() {
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
}
