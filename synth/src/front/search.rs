//! The stages of a search for a front: starts, generations, descents, and the exact figures of what is returned.

use counterpoise_pool::Pool;

use super::domination::{least_crowded, nondominated_places, select_survivors, thin_points};
use super::evaluator::{Candidate, Evaluator, worst_shortfall};
use super::evolution::make_children;
use super::refinement::{Refinement, refine};
use super::{DesignFront, FrontObjective, FrontPoint, FrontTask};
use crate::tolerance::LIMIT_KEPT;
use crate::tuning::grid::LoopPlant;
use crate::tuning::measure_loop;
use crate::tuning::problem::Problem;
use crate::tuning::random_generator::RandomGenerator;
use crate::{Error, LoopMeasures};

/// Points of a generation: some for each of a dozen parameters and three objectives.
const POPULATION: usize = 60;
/// Points that the archive keeps at most.
const ARCHIVE: usize = 240;
/// Rounds, each of generations and of descents.
const ROUNDS: usize = 2;
/// Share of the evaluations that goes into descents, if the residual is an objective.
const REFINED_SHARE: f64 = 0.5;
/// Steps of a descent at least: fewer than this do not leave a kink.
const LEAST_STEPS: usize = 8;
/// Steps of a descent at most in one round.
const MOST_STEPS: usize = 40;
/// Designs that are measured for each that is returned: some are dominated by their exact figures.
const MEASURED: usize = 2;
/// Draws of a random search that are evaluated at once.
const BATCH: usize = 240;
/// Largest factor on a parameter of a random draw about a start, as a natural logarithm: a decade.
const DRAW_REACH: f64 = 2.3;

/// A search on its way.
pub(super) struct FrontSearch<'a> {
    task: &'a FrontTask<'a>,
    evaluator: Evaluator<'a>,
    ranges: Vec<[f64; 2]>,
    starts: Vec<Vec<f64>>,
    random: RandomGenerator,
    population: Vec<Candidate>,
    archive: Vec<Candidate>,
    /// The ends of the last descents.
    refined: Vec<Candidate>,
    evaluations: usize,
    is_stopped: bool,
}

impl<'a> FrontSearch<'a> {
    /// Sets up the search and its starts.
    ///
    /// # Errors
    /// As [`super::search_front`].
    pub fn new(task: &'a FrontTask<'a>, pool: &'a dyn Pool) -> Result<Self, Error> {
        let evaluator = Evaluator::new(&task.tuning, task.objectives, pool)?;
        let (ranges, starts) = evaluator.with_problem(|problem| {
            let (family, nominal) = (&problem.family, &problem.plants[0]);
            let starts = family.starts(nominal, &problem.grid, POPULATION, task.tuning.seed);
            Ok((family.ranges().to_vec(), starts))
        })?;
        let random = RandomGenerator(task.tuning.seed ^ 0x5bf0_3635);
        let (population, archive, refined) = Default::default();
        Ok(Self {
            task,
            evaluator,
            ranges,
            starts,
            random,
            population,
            archive,
            refined,
            evaluations: 0,
            is_stopped: false,
        })
    }

    /// Lets generations compete and descends from the best of them, in rounds, until the evaluations are used. The last descents start from the points
    /// that are returned, so that each is the best near it.
    ///
    /// # Errors
    /// Those of the evaluation.
    pub fn evolve_and_refine(&mut self) -> Result<(), Error> {
        self.begin()?;
        let refines = self.task.objectives.contains(&FrontObjective::Residual);
        for round in 1..=ROUNDS {
            let end = self.task.evaluations * round / ROUNDS;
            let part = self.task.evaluations / ROUNDS;
            let refined = if refines { (REFINED_SHARE * part as f64) as usize } else { 0 };
            while !self.is_stopped && self.evaluations + refined < end {
                let good = self.leading_places();
                let children = make_children(&self.population, &good, &self.ranges, &mut self.random);
                self.compete(children)?;
            }
            if refines && !self.is_stopped {
                self.refine_archive(end.saturating_sub(self.evaluations).max(1))?;
            }
        }
        Ok(())
    }

    /// Evaluates the starts and as many points that are drawn at random.
    fn begin(&mut self) -> Result<(), Error> {
        let mut points: Vec<Vec<f64>> = self.starts.iter().map(|at| self.within_ranges(at)).collect();
        points.extend((0..POPULATION).map(|k| self.draw_point(k)).collect::<Vec<_>>());
        self.compete(points)
    }

    /// Evaluates points that are drawn at random until the evaluations are used.
    ///
    /// # Errors
    /// Those of the evaluation.
    pub fn draw(&mut self) -> Result<(), Error> {
        self.begin()?;
        while !self.is_stopped && self.evaluations < self.task.evaluations {
            let count = BATCH.min(self.task.evaluations - self.evaluations);
            let points = (0..count).map(|k| self.draw_point(k)).collect();
            let Some(found) = self.evaluate(points)? else { break };
            self.keep(&found);
        }
        Ok(())
    }

    fn draw_point(&mut self, number: usize) -> Vec<f64> {
        let start = self.starts[self.random.next_place(self.starts.len())].clone();
        let mut point = Vec::with_capacity(start.len());
        for (n, ([low, high], start)) in self.ranges.iter().zip(&start).enumerate() {
            point.push(match number % 2 {
                0 => low + (high - low) * self.random.next_share(),
                _ => (start + DRAW_REACH * self.random.next_symmetric(n)).clamp(*low, *high),
            });
        }
        point
    }

    fn within_ranges(&self, at: &[f64]) -> Vec<f64> {
        at.iter().zip(&self.ranges).map(|(value, [low, high])| value.clamp(*low, *high)).collect()
    }

    fn evaluate(&mut self, points: Vec<Vec<f64>>) -> Result<Option<Vec<Candidate>>, Error> {
        let count = points.len();
        let found = self.evaluator.evaluate(points)?;
        match found {
            Some(_) => self.evaluations += count,
            None => self.is_stopped = true,
        }
        self.evaluator.report_progress(self.evaluations, self.task.evaluations);
        Ok(found)
    }

    /// Evaluates points; the best of them and of the population survive.
    fn compete(&mut self, points: Vec<Vec<f64>>) -> Result<(), Error> {
        let Some(found) = self.evaluate(points)? else { return Ok(()) };
        self.keep(&found);
        self.admit(found);
        Ok(())
    }

    fn admit(&mut self, found: Vec<Candidate>) {
        let mut all = std::mem::take(&mut self.population);
        all.extend(found);
        let ratings: Vec<_> = all.iter().map(|each| each.rating.clone()).collect();
        let places = select_survivors(&ratings, POPULATION);
        self.population = places.into_iter().map(|k| all[k].clone()).collect();
    }

    /// Puts the points that keep the limits into the archive, which keeps those that no other dominates.
    fn keep(&mut self, found: &[Candidate]) {
        self.archive.extend(found.iter().filter(|each| each.rating.missed == 0.0).cloned());
        let costs: Vec<Vec<f64>> = self.archive.iter().map(|each| each.rating.costs.clone()).collect();
        let mut places = nondominated_places(&costs);
        if places.len() > ARCHIVE {
            let left: Vec<Vec<f64>> = places.iter().map(|&k| costs[k].clone()).collect();
            places = least_crowded(&left, ARCHIVE).into_iter().map(|k| places[k]).collect();
        }
        self.archive = places.into_iter().map(|k| self.archive[k].clone()).collect();
    }

    /// Returns the places in the population of the points that no other dominates; that of the point that misses its limits least if none keeps them.
    fn leading_places(&self) -> Vec<usize> {
        let rating = |k: &usize| &self.population[*k].rating;
        let kept: Vec<usize> = (0..self.population.len()).filter(|k| rating(k).missed == 0.0).collect();
        if kept.is_empty() {
            let least =
                (0..self.population.len()).min_by(|a, b| rating(a).missed.total_cmp(&rating(b).missed));
            return least.into_iter().collect();
        }
        let costs: Vec<Vec<f64>> = kept.iter().map(|k| rating(k).costs.clone()).collect();
        nondominated_places(&costs).into_iter().map(|k| kept[k]).collect()
    }

    /// Descends from points that stand for the archive, or for the population if no point keeps the limits yet.
    fn refine_archive(&mut self, budget: usize) -> Result<(), Error> {
        let from = if self.archive.is_empty() { &self.population } else { &self.archive };
        let feedbacks = self.evaluator.with_problem(|problem| Ok(problem.family.response_feedbacks()))?;
        let count = (budget / (feedbacks * LEAST_STEPS)).clamp(1, self.task.points);
        let steps = (budget / (feedbacks * count)).clamp(LEAST_STEPS, MOST_STEPS);
        let costs: Vec<Vec<f64>> = from.iter().map(|each| each.rating.costs.clone()).collect();
        let points: Vec<Candidate> =
            thin_points(&costs, count).into_iter().map(|k| from[k].clone()).collect();
        match refine(&self.evaluator, self.task.objectives, &points, steps)? {
            Some(Refinement { found, evaluations }) => {
                self.evaluations += evaluations;
                self.keep(&found);
                self.refined.clone_from(&found);
                self.admit(found);
                self.evaluator.report_progress(self.evaluations, self.task.evaluations);
            }
            None => self.is_stopped = true,
        }
        Ok(())
    }

    /// Returns the front by the exact figures of its designs.
    ///
    /// # Errors
    /// Those of the figures.
    pub fn measure_front(self) -> Result<DesignFront, Error> {
        let chosen = self.returned_candidates();
        let measured = self
            .evaluator
            .map_places(chosen.len(), |problem, k| Ok(measure_point(problem, &chosen[k].at, self.task)))?;
        let is_complete = measured.is_some() && !self.is_stopped;
        let points: Vec<FrontPoint> = measured.unwrap_or_default().into_iter().flatten().collect();
        let points = select_front(points, self.task.objectives, self.task.points);
        Ok(DesignFront { points, evaluations: self.evaluations, is_complete })
    }

    /// Returns the candidates whose exact figures are computed: the ends of the last descents that no other point dominates, and, if they are fewer than the points
    /// that are asked for, points that stand for the archive.
    fn returned_candidates(&self) -> Vec<Candidate> {
        let is_refined = |each: &&Candidate| self.refined.iter().any(|end| end.at == each.at);
        let mut chosen: Vec<Candidate> = self.archive.iter().filter(is_refined).cloned().collect();
        let wanted = MEASURED * self.task.points;
        if chosen.len() < self.task.points {
            let costs: Vec<Vec<f64>> = self.archive.iter().map(|each| each.rating.costs.clone()).collect();
            let others = thin_points(&costs, wanted - chosen.len());
            chosen.extend(others.into_iter().map(|k| self.archive[k].clone()));
        }
        chosen
    }
}

/// Returns the points that no other dominates, at most `count` of them that stand for all, by the first objective.
pub(super) fn select_front(
    points: Vec<FrontPoint>,
    objectives: &[FrontObjective],
    count: usize,
) -> Vec<FrontPoint> {
    let costs: Vec<Vec<f64>> = points.iter().map(|point| point.costs(objectives)).collect();
    let places = nondominated_places(&costs);
    let left: Vec<Vec<f64>> = places.iter().map(|&k| costs[k].clone()).collect();
    let mut kept: Vec<usize> = thin_points(&left, count).into_iter().map(|k| places[k]).collect();
    kept.sort_by(|&a, &b| costs[a][0].total_cmp(&costs[b][0]).then(a.cmp(&b)));
    kept.into_iter().map(|k| points[k].clone()).collect()
}

/// Returns a design with its exact figures; `None` if there is none, its loop is not stable, or it misses a limit.
fn measure_point(problem: &Problem<'_>, at: &[f64], task: &FrontTask<'_>) -> Option<FrontPoint> {
    let sampled = problem.family.sampled_feedback(at).ok()?;
    if !problem.is_stable(at) {
        return None;
    }
    let measure = |plant: &LoopPlant| measure_loop(&plant.system, &sampled, task.tuning.disturbance);
    let measures = problem.plants.iter().map(measure).collect::<Result<Vec<LoopMeasures>, Error>>().ok()?;
    if worst_shortfall(&task.tuning.limits, &measures) > LIMIT_KEPT {
        return None;
    }
    let figures: Vec<f64> = task.objectives.iter().map(|each| each.worst_figure(&measures)).collect();
    let is_known = figures.iter().all(|figure| !figure.is_nan());
    is_known.then(|| FrontPoint { feedback: problem.family.feedback(at), sampled, measures, figures })
}
