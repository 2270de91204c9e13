//! What a front of designs trades, and under which limits.

use counterpoise_synth::{FrontMethod, FrontObjective, LoopLimits};

use super::fixed_structure::{LimitDefaults, limits};
use super::model::count;
use crate::file::field::{Field, NumberRange};
use crate::file::visit::{NamedChoice, Visit, choose};

/// Objectives, limits and size of a front.
#[derive(Debug, Clone, PartialEq)]
pub struct FrontOptions {
    /// The objectives that are traded.
    pub objectives: Vec<FrontObjective>,
    /// Limits that every design keeps. A decay of 0 stands for that of the project's own design.
    pub limits: LoopLimits,
    /// Method.
    pub method: FrontMethod,
    /// Feedbacks that are evaluated for each kind of design, about.
    pub evaluations: usize,
    /// Designs of each kind at most.
    pub points: usize,
    /// Seed.
    pub seed: u32,
}

impl NamedChoice for FrontMethod {
    const NAMES: &'static [(&'static str, Self)] =
        &[("evolution", Self::Evolution), ("random", Self::Random)];
}

impl Default for FrontOptions {
    fn default() -> Self {
        // Ms and Mt of 2 are the largest that a robust loop has (Astrom and Murray, Feedback Systems, section 12.2).
        let limits = LoopLimits { max_sensitivity: 2.0, max_complementary: 2.0, ..LoopLimits::default() };
        Self {
            objectives: vec![
                FrontObjective::Residual,
                FrontObjective::NoiseGain,
                FrontObjective::MaxSensitivity,
            ],
            limits,
            method: FrontMethod::Evolution,
            evaluations: 6000,
            points: 16,
            seed: 1,
        }
    }
}

/// Reads or lists what a front trades.
pub(crate) fn front(v: &mut dyn Visit, front: &mut FrontOptions) {
    objectives(v, &mut front.objectives);
    limits(v, &mut front.limits, LimitDefaults::OF_FRONT);
    let method = "how designs are found: by evolution with descents, or drawn at random to compare with";
    choose(v, &Field::new("method", method).or_text("evolution"), &mut front.method);
    let evaluations =
        Field::new("evaluations", "feedbacks that are evaluated for each kind of design, about");
    count(v, &evaluations.limit(NumberRange::Between(1.0, 1e7)).or(6000.0), &mut front.evaluations);
    let points = Field::new("points", "largest number of designs of each kind");
    count(v, &points.limit(NumberRange::Between(1.0, 200.0)).or(16.0), &mut front.points);
    let seed = Field::new("seed", "seed of the random part of the search").limit(NumberRange::AtLeast(0.0));
    v.whole_number(&seed.or(1.0), &mut front.seed);
}

fn objectives(v: &mut dyn Visit, objectives: &mut Vec<FrontObjective>) {
    let mut names: Vec<String> = objectives.iter().map(|each| each.name().to_owned()).collect();
    let meaning = "figures of the loop that are traded, two or more: residual, effort, noise-gain, max-sensitivity, max-complementary, control-peak, gain-margin, phase-margin, delay-margin; absent, residual, noise-gain and max-sensitivity";
    v.texts(&Field::new("objectives", meaning).or_empty(), &mut names);
    match read_objectives(&names) {
        Ok(found) if found.is_empty() => {}
        Ok(found) => *objectives = found,
        Err(problem) => v.complain("objectives", &problem.allowed, problem.hint),
    }
}

/// What is wrong with the names of objectives.
#[derive(Debug, Clone, PartialEq)]
pub struct ObjectiveProblem {
    /// What may stand there.
    pub allowed: String,
    /// A name that may be meant.
    pub hint: Option<String>,
}

/// Returns the objectives of their names.
///
/// # Errors
/// [`ObjectiveProblem`] for an unknown name, one that stands twice, or a single one.
pub fn read_objectives(names: &[String]) -> Result<Vec<FrontObjective>, ObjectiveProblem> {
    let mut found: Vec<FrontObjective> = Vec::new();
    let keys = || FrontObjective::NAMES.iter().map(|(name, _)| *name);
    for name in names {
        let Some((_, objective)) = FrontObjective::NAMES.iter().find(|(known, _)| known == name) else {
            let allowed =
                format!("may hold {}; \"{name}\" is none of them", keys().collect::<Vec<_>>().join(", "));
            return Err(ObjectiveProblem { allowed, hint: crate::diagnostic::did_you_mean(name, keys()) });
        };
        if found.contains(objective) {
            let allowed = format!("must name each objective once; \"{name}\" stands twice");
            return Err(ObjectiveProblem { allowed, hint: Some("remove one of the two".to_owned()) });
        }
        found.push(*objective);
    }
    if found.len() == 1 {
        let allowed = format!("must name two objectives or more; \"{}\" alone has no front", names[0]);
        return Err(ObjectiveProblem {
            allowed,
            hint: Some("use `[synth.tune]` to make one figure least".to_owned()),
        });
    }
    Ok(found)
}
