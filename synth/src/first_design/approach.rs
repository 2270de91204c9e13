//! Loops that keep everything are looked for from loops that nearly do.
//!
//! A loop has a distance from a bandwidth and all limits: the sum of the logarithms of what it has over what is allowed. Aim and multiples of its shape are
//! varied one by one, in the way that shortens it, as Hooke and Jeeves do (Direct search solution of numerical and statistical problems, Journal of
//! the ACM 8 (1961) 2). A loop at no distance is the answer, and the bandwidth that is asked for rises.

use super::candidate::Shape;
use super::scan::{Approach, Candidate, Scan, Thoroughness, TriedFeedback, step_of_aims};
use crate::tolerance::{APPROACH_RISE, NARROW_MISS};
use crate::{Error, LightModes};

/// Factors by which aim and multiples are varied, one after the other.
const FACTORS: [f64; 3] = [2.0, 1.5, 1.25];
/// Loops that are judged from one start, at most.
const MOST_JUDGED: usize = 60;
/// Loops that an approach starts from, at most; half of them where no loop keeps everything yet.
const STARTS: usize = 6;
/// Aims of a kind of shape from which the nearest is taken, in steps of aims above the bandwidth that is asked for: a notch makes the bandwidth lower than
/// the aim.
const AIMS_ABOVE: [i32; 2] = [0, 3];

/// Costs of the load's motion over that of the control; the first leaves the load out.
const LOADS: [f64; 2] = [0.0, 3.0];

/// A loop and its distance.
#[derive(Debug, Clone, PartialEq)]
struct NearLoop {
    miss: f64,
    found: TriedFeedback,
}

/// Returns the loops that are near enough to start from, the nearest first.
fn narrowest(mut starts: Vec<NearLoop>) -> impl Iterator<Item = NearLoop> {
    starts.retain(|start| start.miss < NARROW_MISS);
    starts.sort_by(|a, b| a.miss.total_cmp(&b.miss));
    starts.into_iter()
}

impl Scan<'_> {
    /// Tries to find a loop that keeps everything from those that were tried and miss their limits least: where more is required than usual, none of the shapes of the
    /// search may keep it.
    pub fn approach_from_tried(&mut self) -> Result<(), Error> {
        let starts: Vec<NearLoop> =
            self.tried.iter().map(|tried| self.measure_distance(tried.clone(), 0.0)).collect();
        for start in narrowest(starts).take(STARTS / 2) {
            let target_rad_s = APPROACH_RISE * self.best_bandwidth();
            self.approach(start.found, target_rad_s)?;
        }
        self.judge_by(Thoroughness::Everything);
        Ok(())
    }

    /// Tries to find a clearly quicker loop than the answer from shapes of every kind that miss that narrowly. Returns whether there is one.
    pub fn approach_from_kinds(&mut self, plants: &[LightModes]) -> Result<bool, Error> {
        let reached = self.best_bandwidth();
        if reached == 0.0 {
            return Ok(false);
        }
        let starts = self.starts_of_kinds(plants, APPROACH_RISE * reached)?;
        for start in narrowest(starts).take(STARTS) {
            let target_rad_s = APPROACH_RISE * self.best_bandwidth();
            self.approach(start.found, target_rad_s)?;
        }
        self.judge_by(Thoroughness::Everything);
        Ok(self.best_bandwidth() > reached)
    }

    /// Returns the loop of each kind of shape that is nearest to a bandwidth and all limits.
    fn starts_of_kinds(&mut self, plants: &[LightModes], target_rad_s: f64) -> Result<Vec<NearLoop>, Error> {
        let mut starts = Vec::new();
        let loads = if self.gain.load.is_some() { &LOADS[..] } else { &LOADS[..1] };
        let aims: Vec<f64> = AIMS_ABOVE.iter().map(|&k| target_rad_s * step_of_aims().powi(k)).collect();
        for kind in Shape::kinds(plants, loads) {
            let from = self.shapes.len();
            self.shapes.resize(from + aims.len(), kind);
            let candidates: Vec<Candidate> =
                (from..).zip(&aims).map(|(shape, &aim_rad_s)| Candidate { aim_rad_s, shape }).collect();
            let mut nearest = None;
            for k in 0..candidates.len() {
                let least_miss = nearest.as_ref().map_or(f64::INFINITY, |near: &NearLoop| near.miss);
                let nearer = self.attempt_nearer(&candidates[k..], Approach { target_rad_s, least_miss })?;
                nearest = nearer.or(nearest);
            }
            starts.extend(nearest);
        }
        Ok(starts)
    }

    /// Varies aim and multiples of a loop as long as that brings it nearer to a bandwidth and all limits. From each loop that reaches them on, a higher bandwidth is
    /// asked for.
    fn approach(&mut self, start: TriedFeedback, target_rad_s: f64) -> Result<(), Error> {
        let mut target_rad_s = target_rad_s;
        let mut at = self.measure_distance(start, target_rad_s);
        self.ask_for_more_if_reached(&mut at, &mut target_rad_s);
        let mut judged = 0;
        for factor in FACTORS {
            let (mut way, mut failures) = (0, 0);
            let mut ways = self.ways(&at.found, factor);
            while failures < ways.len() && judged < MOST_JUDGED && self.may_design_more() {
                let upcoming: Vec<Candidate> = ways[way..].iter().flatten().copied().collect();
                let approach = Approach { target_rad_s, least_miss: at.miss };
                let nearer = match ways[way] {
                    Some(_) => self.attempt_nearer(&upcoming, approach)?,
                    None => None,
                };
                judged += usize::from(ways[way].is_some());
                if let Some(nearer) = nearer {
                    (at, failures) = (nearer, 0);
                    self.ask_for_more_if_reached(&mut at, &mut target_rad_s);
                    ways = self.ways(&at.found, factor);
                } else {
                    failures += 1;
                    way = (way + 1) % ways.len();
                }
            }
        }
        Ok(())
    }

    /// Takes a loop at no distance as the answer if it is the quickest, and asks for a higher bandwidth than its own.
    fn ask_for_more_if_reached(&mut self, at: &mut NearLoop, target_rad_s: &mut f64) {
        if at.miss > 0.0 {
            return;
        }
        let bandwidth_rad_s = at.found.judgement.bandwidth_rad_s;
        if self.keeps_all(&at.found.judgement) && bandwidth_rad_s > self.best_bandwidth() {
            self.best = Some(at.found.clone());
        }
        *target_rad_s = APPROACH_RISE * bandwidth_rad_s;
        at.miss = self.miss(&at.found.judgement, *target_rad_s);
    }

    /// Returns the candidates beside a loop, always in the same order; `None` for one that is out of range. Each has a shape with a number of its own, because a loop is
    /// judged only so far as it is nearer than another.
    fn ways(&mut self, at: &TriedFeedback, factor: f64) -> Vec<Option<Candidate>> {
        let shape = self.shapes[at.shape];
        let aims = [at.aim_rad_s / factor, at.aim_rad_s * factor];
        let highest = self.highest_aim();
        let other_aims = aims.map(|aim_rad_s| (aim_rad_s <= highest).then_some((aim_rad_s, shape)));
        let other_shapes = shape.steps(factor).map(|other| Some((at.aim_rad_s, other?)));
        let number = |way: Option<(f64, Shape)>| {
            let (aim_rad_s, shape) = way?;
            self.shapes.push(shape);
            Some(Candidate { aim_rad_s, shape: self.shapes.len() - 1 })
        };
        other_aims.into_iter().chain(other_shapes).map(number).collect()
    }

    /// Returns the first of some candidates if it is nearer than asked for; the others are judged beside it if there are processors.
    fn attempt_nearer(
        &mut self,
        upcoming: &[Candidate],
        approach: Approach,
    ) -> Result<Option<NearLoop>, Error> {
        let Some(Candidate { aim_rad_s, shape }) = upcoming.first().copied() else { return Ok(None) };
        self.judge_nearer(approach);
        self.look_ahead(upcoming.iter().copied());
        let found = self.attempt(aim_rad_s, shape)?;
        let near = found.map(|found| self.measure_distance(found, approach.target_rad_s));
        Ok(near.filter(|near| near.miss < approach.least_miss))
    }

    fn measure_distance(&self, found: TriedFeedback, target_rad_s: f64) -> NearLoop {
        NearLoop { miss: self.miss(&found.judgement, target_rad_s), found }
    }
}
