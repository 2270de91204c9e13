//! The bands of an adaptation whose project states neither dead-band nor hold band: trials choose both, so that no trial is worse than without
//! adaptation.
//!
//! A correct estimate can be worse than a wrong one. The torque that is left of the imbalance, dM a, adds to that of friction, and where both are
//! correlated (heave and pitch come from the same wheels) the mean square of their sum is F^2 + 2 c F dM a + (dM a)^2: least not at dM = 0 but
//! at -c F / a. What a right load gains grows with the square of the platform's acceleration a, and below some a it is negative. Without gravity
//! friction moves the estimate, too, by more the quieter the platform is. So the bands are found on the acceleration: the estimate stands still on each motion on which a trial
//! is worse than without adaptation, and on every quieter one.

use counterpoise_controller::Controller;
use counterpoise_pool::map_all;
use counterpoise_project::Project;
use counterpoise_project::resolve::synthesis_options::{AdaptationMethod, AdaptationOptions, AdaptationUse};
use counterpoise_verify::Procedure;

use super::adaptation_trials::{
    LOADS, MOTIONS, RECURSIVE, Stage, TrialController, TrialLoad, TrialMotion, TrialRow, TrialRun,
    adaptation_options, rms_or_infinite, set_spreads,
};
use crate::synth::controller_blocks::HOLD_BAND;
use crate::tolerance::LEAST_DEAD_BAND_M_S2;
use crate::tolerance::{BELOW_TRIED, DEAD_BAND_MARGIN, LEAST_REMOVED, NEVER_WORSE};
use crate::{
    PipelineError, PlantModel, World, build_plant_model, project_procedure, reduce_plant, synthesise,
};

/// Hold bands that are tried, the usual one first. A wider one covers more of what friction does to the estimate, and leaves more of a changed load.
const HOLD_BANDS: [f64; 3] = [HOLD_BAND, 1.375 * HOLD_BAND, 1.75 * HOLD_BAND];
/// A band in which the estimate is never followed: no estimate is off by a thousand times the load.
const NEVER_FOLLOWED: f64 = 1e3;

/// Returns the project with the bands of its adaptation chosen, or with the adaptation left out of the exported controller where no motion is left on which it helps; `None`
/// if the project states a band or has no such adaptation, or if no controller or no procedure exists.
///
/// # Errors
/// Those of the plant and the simulator.
pub fn with_chosen_adaptation(
    project: &Project,
    world: &dyn World,
) -> Result<Option<Project>, PipelineError> {
    let Some(adaptation) = adaptation_options(project).filter(|adaptation| is_open(adaptation)) else {
        return Ok(None);
    };
    let modelled = build_plant_model(project)?;
    // A design that does not exist and a road that cannot be read are told by the stages that need them.
    let Ok(made) = synthesise(project, &modelled, &reduce_plant(project, &modelled)?) else {
        return Ok(None);
    };
    let tried = project.clone().with_usual_verification();
    let Ok(procedure) = project_procedure(&tried, world) else { return Ok(None) };
    let controller = &made.sampled.controller;
    let search =
        Search { project, adaptation, modelled: &modelled, controller, procedure: &procedure, world };
    let found = search.best_candidate()?;
    let chosen = match found {
        Some(bands) => bands.of(adaptation),
        None => AdaptationOptions { use_in_code: AdaptationUse::LeftOut, ..adaptation.clone() },
    };
    let mut synth = project.synth.clone().unwrap_or_default();
    synth.options.adaptation = Some(chosen);
    Ok(Some(Project { synth: Some(synth), ..project.clone() }))
}

fn is_open(adaptation: &AdaptationOptions) -> bool {
    let states_none = adaptation.dead_band_m_s2.is_none() && adaptation.hold_band.is_none();
    let is_exported = adaptation.use_in_code == AdaptationUse::Exported;
    adaptation.method == AdaptationMethod::Recursive && states_none && is_exported
}

/// Bands that are tried.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Candidate {
    dead_band_m_s2: f64,
    hold_band: f64,
}

impl Candidate {
    fn of(self, adaptation: &AdaptationOptions) -> AdaptationOptions {
        AdaptationOptions {
            dead_band_m_s2: Some(self.dead_band_m_s2),
            hold_band: Some(self.hold_band),
            ..adaptation.clone()
        }
    }
}

/// The merits of a candidate, the most important first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Merit {
    /// Trials in which enough of what the load adds is removed.
    removed: usize,
    /// Motions on which the estimate is followed.
    motions: usize,
}

/// Returns whether a controller that knows the load is nowhere worse than one that does not.
fn is_helped(motion: TrialMotion, base: &[TrialRow]) -> bool {
    let mut same = base.iter().filter(|row| row.motion == motion);
    same.all(|row| row.told_rad_s <= row.without_rad_s * (1.0 + NEVER_WORSE))
}

/// A run to be made.
#[derive(Debug, Clone, Copy)]
struct Job {
    motion: TrialMotion,
    load: TrialLoad,
    acts: TrialController,
}

struct Search<'a> {
    project: &'a Project,
    adaptation: &'a AdaptationOptions,
    modelled: &'a PlantModel,
    controller: &'a Controller,
    procedure: &'a Procedure,
    world: &'a dyn World,
}

impl Search<'_> {
    /// Returns the bands with which most of what a changed load adds is removed, and then with which most motions are adapted to, among those
    /// that are nowhere worse than none; `None` if no motion is left.
    fn best_candidate(&self) -> Result<Option<Candidate>, PipelineError> {
        let base = self.base()?;
        let wanted = base.iter().filter(|row| row.removed_share().is_some()).count();
        // Gravity shows the load exactly. Without it friction moves the estimate, and where the load adds nothing there is nothing to gain by that.
        if wanted == 0 && self.modelled.parameters.gravity_m_s2 == 0.0 {
            return Ok(None);
        }
        let levels = self.levels()?;
        let quietest = levels.iter().copied().fold(f64::INFINITY, f64::min);
        let helped_motions = MOTIONS.into_iter().filter(|motion| is_helped(*motion, &base)).count();
        let mut best: Option<(Merit, Candidate)> = None;
        for hold_band in HOLD_BANDS {
            let dead_band_m_s2 = LEAST_DEAD_BAND_M_S2.max(BELOW_TRIED * quietest);
            let (candidate, rows) =
                self.raise_dead_band(Candidate { dead_band_m_s2, hold_band }, &levels, &base)?;
            let removes = |row: &&TrialRow| row.removed_share().is_some_and(|share| share >= LEAST_REMOVED);
            let motions = levels.iter().filter(|level| **level > candidate.dead_band_m_s2).count();
            let merit = Merit { removed: rows.iter().filter(removes).count(), motions };
            if motions > 0 && best.is_none_or(|(before, _)| merit > before) {
                best = Some((merit, candidate));
            }
            if merit.removed == wanted && motions >= helped_motions {
                break;
            }
        }
        Ok(best.map(|(_, candidate)| candidate))
    }

    /// Raises the dead-band until no trial is worse than without adaptation; returns it with its trials.
    fn raise_dead_band(
        &self,
        mut candidate: Candidate,
        levels: &[f64; 3],
        base: &[TrialRow],
    ) -> Result<(Candidate, Vec<TrialRow>), PipelineError> {
        loop {
            let acting =
                MOTIONS.into_iter().zip(levels).filter(|(_, level)| **level > candidate.dead_band_m_s2);
            let rows =
                self.adapted_trials(candidate, &acting.map(|(motion, _)| motion).collect::<Vec<_>>(), base)?;
            let is_worse =
                |motion: TrialMotion| rows.iter().any(|row| row.motion == motion && row.is_harmful());
            let worse = MOTIONS.into_iter().zip(levels).filter(|(motion, _)| is_worse(*motion));
            let Some(level) = worse.map(|(_, level)| *level).reduce(f64::max) else {
                return Ok((candidate, rows));
            };
            candidate.dead_band_m_s2 = DEAD_BAND_MARGIN * level;
        }
    }

    /// Returns the trials without adaptation, and with the load known.
    fn base(&self) -> Result<Vec<TrialRow>, PipelineError> {
        let all = MOTIONS.iter().flat_map(|motion| LOADS.iter().map(move |load| (*motion, *load)));
        let each = |(motion, load)| {
            [TrialController::Without, TrialController::Told].map(|acts| Job { motion, load, acts })
        };
        let jobs: Vec<Job> = all.flat_map(each).collect();
        let runs = self.runs(self.adaptation, &jobs)?;
        let mut rows: Vec<TrialRow> = jobs
            .chunks(2)
            .zip(runs.chunks(2))
            .map(|(jobs, runs)| {
                let rate =
                    |k: usize| runs.get(k).map_or(f64::INFINITY, |run| rms_or_infinite(&run.hub_rate_rad_s));
                TrialRow {
                    rate: self.modelled.parameters.controlled_quantity().rate(),
                    method: RECURSIVE,
                    motion: jobs[0].motion,
                    load: jobs[0].load,
                    without_rad_s: rate(0),
                    with_rad_s: rate(0),
                    told_rad_s: rate(1),
                    spread_rad_s: 0.0,
                }
            })
            .collect();
        set_spreads(&mut rows);
        Ok(rows)
    }

    /// Returns how lively the estimator finds each motion, m/s^2.
    fn levels(&self) -> Result<[f64; 3], PipelineError> {
        let listens = Candidate { dead_band_m_s2: LEAST_DEAD_BAND_M_S2, hold_band: NEVER_FOLLOWED };
        let jobs = MOTIONS.map(|motion| Job { motion, load: TrialLoad::Nominal, acts: ADAPTS });
        let runs = self.runs(&listens.of(self.adaptation), &jobs)?;
        // a run that diverged shows no level, and no band makes the motion a quiet one
        let level =
            |run: &TrialRun| if run.hub_rate_rad_s.is_empty() { f64::INFINITY } else { run.peak_rms_m_s2 };
        Ok(std::array::from_fn(|k| runs.get(k).map_or(f64::INFINITY, level)))
    }

    /// Returns the trials with a candidate, which stands still on every motion but those given.
    fn adapted_trials(
        &self,
        candidate: Candidate,
        acting: &[TrialMotion],
        base: &[TrialRow],
    ) -> Result<Vec<TrialRow>, PipelineError> {
        let mut rows = base.to_vec();
        let of_acting = || (0..rows.len()).filter(|k| acting.contains(&rows[*k].motion));
        let places: Vec<usize> = of_acting().collect();
        let job = |k: &usize| Job { motion: rows[*k].motion, load: rows[*k].load, acts: ADAPTS };
        let jobs: Vec<Job> = places.iter().map(job).collect();
        let runs = self.runs(&candidate.of(self.adaptation), &jobs)?;
        for (place, run) in places.into_iter().zip(&runs) {
            rows[place].with_rad_s = rms_or_infinite(&run.hub_rate_rad_s);
        }
        Ok(rows)
    }

    /// Makes runs side by side.
    fn runs(&self, adaptation: &AdaptationOptions, jobs: &[Job]) -> Result<Vec<TrialRun>, PipelineError> {
        let Self { project, modelled, controller, procedure, .. } = *self;
        let stage = Stage { project, adaptation, modelled, controller, procedure };
        let one = |job: &Job| stage.run(&stage.platform(job.motion)?, job.load, job.acts);
        map_all(self.world.pool(), jobs.len(), |k| one(&jobs[k])).into_iter().collect()
    }
}

const ADAPTS: TrialController = TrialController::Adapts(AdaptationMethod::Recursive);
