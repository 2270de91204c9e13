//! Diagnosis of what a structure's model lacks, from natural frequencies measured on the real one.
//!
//! Every hypothesis changes the finite elements of the project's beam by at most two numbers. It is fitted to all modes but
//! one and judged on that one, mode after mode: the error that counts is that of the held-out frequencies.

use counterpoise_diagnose::findings::answer::DiagnosisVerdict;
use counterpoise_models::structure::{
    AttachedMasses, ElementMesh, FeModel, FeOptions, Theory, undamped_modes,
};
use counterpoise_models::{Beam, PointMass};

use super::structure_hypotheses::{
    Change, End, FittedParameter, FittedStructureValue, Hypothesis, Scale, TriedStructure,
};
use crate::tolerance::{ALIKE_HYPOTHESES, EXPLAINED_STRUCTURE, FEWEST_JUDGED_MODES, WORTH_COMPLICATING};
use crate::{PipelineError, finite_elements};
use counterpoise_project::Project;
use counterpoise_project::resolve::measured_modes::MeasuredModes;
use counterpoise_project::resolve::model::StructureChoice;

/// Factor by which the mesh of the hypothesis "too few elements" is.
const FINER: usize = 4;
/// Masses that are tried at an end of the beam, as shares of the beam's own, in equal ratios.
const MASSES: (f64, f64, usize) = (1e-3, 0.5, 40);

/// The answer.
#[derive(Debug, Clone, PartialEq)]
pub struct StructureAnswer {
    /// Verdict.
    pub verdict: DiagnosisVerdict,
    /// Measured frequencies, Hz.
    pub measured_hz: Vec<f64>,
    /// Frequencies of the model as it is, Hz.
    pub model_hz: Vec<f64>,
    /// By how much each of them is off, percent of the measured one.
    pub model_errors_percent: Vec<f64>,
    /// Trials; the first one is the model as it is, the others best first.
    pub tried: Vec<TriedStructure>,
    /// The trial that explains the modes; `None` if none does better than the model as it is.
    pub chosen: Option<TriedStructure>,
    /// Others that explain the modes as well as the one that is named.
    pub alternatives: Vec<Hypothesis>,
}

/// The answer, and the project with what was named.
#[derive(Debug, Clone, PartialEq)]
pub struct StructureDiagnosis {
    /// The answer.
    pub answer: StructureAnswer,
    /// The improved project; as it was if nothing was named.
    pub improved: Project,
}

/// Diagnoses a structure from its measured modes.
///
/// # Errors
/// A project without a beam or with fewer flexible modes than were measured.
pub fn diagnose_structure(
    project: &Project,
    measured: &MeasuredModes,
) -> Result<StructureDiagnosis, PipelineError> {
    let trials = StructureTrials { project, measured };
    let mut tried: Vec<TriedStructure> = Vec::new();
    for hypothesis in hypotheses(measured.modes_hz.len()) {
        tried.extend(trials.try_hypothesis(hypothesis)?);
    }
    let as_it_is = tried.remove(0);
    tried.sort_by(|a, b| a.left_out_percent.total_cmp(&b.left_out_percent));
    let chosen = choose_hypothesis(&as_it_is, &tried);
    let improved = match chosen {
        Some(found) => trials.improved_project(found),
        None => project.clone(),
    };
    Ok(StructureDiagnosis { answer: answer(measured, &as_it_is, &tried, chosen), improved })
}

fn hypotheses(modes: usize) -> Vec<Hypothesis> {
    let changes =
        [Change::Nothing, Change::Mesh, Change::Shear, Change::EndMass(End::Near), Change::EndMass(End::Tip)];
    let scales =
        if modes < FEWEST_JUDGED_MODES { vec![Scale::AsItIs] } else { vec![Scale::AsItIs, Scale::Fitted] };
    let all =
        changes.iter().flat_map(|&change| scales.iter().map(move |&scaled| Hypothesis { change, scaled }));
    all.filter(|h| modes >= FEWEST_JUDGED_MODES || !matches!(h.change, Change::EndMass(_))).collect()
}

impl Hypothesis {
    /// Returns the number of fitted parameters.
    fn parameters(self) -> usize {
        usize::from(self.scaled == Scale::Fitted) + usize::from(matches!(self.change, Change::EndMass(_)))
    }
}

/// A variant of a change of the structure.
struct Candidate {
    /// Mass that is added, kg.
    added_kg: f64,
    /// Frequencies of as many flexible modes as were measured, Hz.
    modes_hz: Vec<f64>,
}

/// The variant that fits best, all frequencies times a factor.
struct Fitting {
    added_kg: f64,
    scale: f64,
    modes_hz: Vec<f64>,
}

/// The project and what was measured on the real structure.
struct StructureTrials<'a> {
    project: &'a Project,
    measured: &'a MeasuredModes,
}

impl StructureTrials<'_> {
    /// Fits and judges one hypothesis; `None` if it changes nothing.
    fn try_hypothesis(&self, hypothesis: Hypothesis) -> Result<Option<TriedStructure>, PipelineError> {
        let candidates = self.candidates(hypothesis.change)?;
        if candidates.is_empty() {
            return Ok(None);
        }
        let count = self.measured.modes_hz.len();
        let fit = |left_out: Option<usize>| self.fit(&candidates, hypothesis.scaled, left_out);
        let Fitting { added_kg, scale, modes_hz } = fit(None);
        let errors = |modes: &[f64]| rms((0..count).map(|k| (modes[k] / self.measured.modes_hz[k]).ln()));
        let left_out = rms((0..count).map(|k| (fit(Some(k)).modes_hz[k] / self.measured.modes_hz[k]).ln()));
        let mut parameters = Vec::new();
        if matches!(hypothesis.change, Change::EndMass(_)) {
            parameters.push(FittedStructureValue { parameter: FittedParameter::Mass, value: added_kg });
        }
        if hypothesis.scaled == Scale::Fitted {
            parameters.push(FittedStructureValue {
                parameter: FittedParameter::StiffnessFactor,
                value: scale * scale,
            });
        }
        Ok(Some(TriedStructure {
            hypothesis,
            parameters,
            rms_percent: 100.0 * errors(&modes_hz),
            left_out_percent: 100.0 * if hypothesis.parameters() == 0 { errors(&modes_hz) } else { left_out },
            errors_percent: (0..count)
                .map(|k| 100.0 * (modes_hz[k] / self.measured.modes_hz[k] - 1.0))
                .collect(),
            modes_hz,
        }))
    }

    /// Returns every variant of a change.
    fn candidates(&self, change: Change) -> Result<Vec<Candidate>, PipelineError> {
        let options = &self.project.model.elements;
        match change {
            Change::Nothing => {
                Ok(vec![Candidate { added_kg: 0.0, modes_hz: self.frequencies(options, None)? }])
            }
            Change::Mesh => {
                let Some(options) = finer_mesh(options) else { return Ok(Vec::new()) };
                Ok(vec![Candidate { added_kg: 0.0, modes_hz: self.frequencies(&options, None)? }])
            }
            Change::Shear if options.theory == Theory::Timoshenko => Ok(Vec::new()),
            Change::Shear => {
                let options = FeOptions { theory: Theory::Timoshenko, ..options.clone() };
                Ok(vec![Candidate { added_kg: 0.0, modes_hz: self.frequencies(&options, None)? }])
            }
            Change::EndMass(end) => {
                let (fe, _) = finite_elements(self.project, StructureChoice::Beam)?;
                let own = fe.mass_kg();
                let ratio = (MASSES.1 / MASSES.0).powf(1.0 / (MASSES.2 - 1) as f64);
                let masses =
                    (0..MASSES.2).map(|k| own * MASSES.0 * ratio.powi(i32::try_from(k).unwrap_or(0)));
                masses
                    .map(|mass_kg| {
                        let modes_hz = self.frequencies(options, Some(EndMass { end, mass_kg }))?;
                        Ok(Candidate { added_kg: mass_kg, modes_hz })
                    })
                    .collect()
            }
        }
    }

    /// Returns frequencies of as many flexible modes as were measured, Hz.
    fn frequencies(&self, options: &FeOptions, added: Option<EndMass>) -> Result<Vec<f64>, PipelineError> {
        let fe = match added {
            None => {
                let mut project = self.project.clone();
                project.model.elements = options.clone();
                finite_elements(&project, StructureChoice::Beam)?.0
            }
            Some(added) => {
                let beam = self.project.plant.beam.as_ref().ok_or(counterpoise_models::Error::NoStructure)?;
                let point = added.place_on(beam);
                FeModel::beam(
                    beam,
                    &AttachedMasses { masses: vec![point], ..AttachedMasses::default() },
                    options,
                )?
            }
        };
        let all = undamped_modes(&fe, self.measured.support)?;
        let wanted = self.measured.modes_hz.len();
        let known = all.flexible_rad_s();
        if known.len() < wanted {
            return Err(PipelineError::FewModes { modes: known.len(), measured: wanted });
        }
        Ok(known[..wanted].iter().map(|w| w / std::f64::consts::TAU).collect())
    }

    /// Returns the variant and the factor on all frequencies that fit best, one mode left out or none.
    fn fit(&self, candidates: &[Candidate], scaled: Scale, left_out: Option<usize>) -> Fitting {
        let fitted = |modes: &Vec<f64>| {
            let seen = (0..modes.len()).filter(|k| Some(*k) != left_out);
            let logs: Vec<f64> = seen.map(|k| (self.measured.modes_hz[k] / modes[k]).ln()).collect();
            let mean = logs.iter().sum::<f64>() / logs.len().max(1) as f64;
            let shift = if scaled == Scale::Fitted { mean } else { 0.0 };
            (rms(logs.iter().map(|l| l - shift)), shift.exp())
        };
        let scored = candidates.iter().map(|one| (fitted(&one.modes_hz), one));
        let best = scored.min_by(|a, b| a.0.0.total_cmp(&b.0.0));
        let none = Fitting { added_kg: 0.0, scale: 1.0, modes_hz: Vec::new() };
        best.map_or(none, |((_, scale), one)| {
            let modes_hz = one.modes_hz.iter().map(|f| scale * f).collect();
            Fitting { added_kg: one.added_kg, scale, modes_hz }
        })
    }

    /// Returns the project with a hypothesis as it was fitted.
    fn improved_project(&self, found: &TriedStructure) -> Project {
        let mut project = self.project.clone();
        let elements = &mut project.model.elements;
        match found.hypothesis.change {
            Change::Shear => elements.theory = Theory::Timoshenko,
            Change::Mesh => *elements = finer_mesh(elements).unwrap_or_else(|| elements.clone()),
            Change::Nothing | Change::EndMass(_) => {}
        }
        let factor = found.parameters.iter().find(|one| one.parameter == FittedParameter::StiffnessFactor);
        if let (Some(beam), Some(factor)) = (&mut project.plant.beam, factor) {
            beam.youngs_modulus_pa *= factor.value;
        }
        project
    }
}

fn finer_mesh(options: &FeOptions) -> Option<FeOptions> {
    let ElementMesh::Pivoted(count) = options.mesh else { return None };
    Some(FeOptions { mesh: ElementMesh::Pivoted(FINER * count), ..options.clone() })
}

/// A mass at an end of the beam.
#[derive(Clone, Copy)]
struct EndMass {
    end: End,
    mass_kg: f64,
}

impl EndMass {
    fn place_on(self, beam: &Beam) -> PointMass {
        let from = beam.sections.first().map_or(0.0, |s| s.from_m);
        let to = beam.sections.last().map_or(0.0, |s| s.to_m);
        let position_m = if self.end == End::Near { from } else { to };
        PointMass { name: "end".to_owned(), position_m, mass_kg: self.mass_kg, inertia_kg_m2: 0.0 }
    }
}

fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(s, n), v| (s + v * v, n + 1.0));
    if count > 0.0 { (sum / count).sqrt() } else { 0.0 }
}

/// Returns the simplest hypothesis that no more complicated one beats by far, where it beats the model as it
/// is.
fn choose_hypothesis<'a>(
    as_it_is: &TriedStructure,
    tried: &'a [TriedStructure],
) -> Option<&'a TriedStructure> {
    if as_it_is.left_out_percent < 100.0 * EXPLAINED_STRUCTURE {
        return None;
    }
    let best = tried.first()?;
    let near = tried.iter().filter(|one| WORTH_COMPLICATING * one.left_out_percent <= best.left_out_percent);
    let simplest = near.min_by_key(|one| one.hypothesis.parameters())?;
    let gains = simplest.left_out_percent < WORTH_COMPLICATING * as_it_is.left_out_percent;
    gains.then_some(simplest)
}

fn answer(
    measured: &MeasuredModes,
    as_it_is: &TriedStructure,
    tried: &[TriedStructure],
    chosen: Option<&TriedStructure>,
) -> StructureAnswer {
    let alike = |one: &&TriedStructure| {
        chosen.is_some_and(|best| {
            one.hypothesis.change != best.hypothesis.change
                && one.left_out_percent < ALIKE_HYPOTHESES * best.left_out_percent
        })
    };
    let alternatives: Vec<Hypothesis> = tried.iter().filter(alike).map(|one| one.hypothesis).collect();
    let verdict = match chosen {
        None if as_it_is.left_out_percent < 100.0 * EXPLAINED_STRUCTURE => DiagnosisVerdict::Consistent,
        None => DiagnosisVerdict::Unknown,
        Some(_) if !alternatives.is_empty() => DiagnosisVerdict::Ambiguous,
        Some(best) if best.left_out_percent < 100.0 * EXPLAINED_STRUCTURE => DiagnosisVerdict::Named,
        Some(_) => DiagnosisVerdict::Incomplete,
    };
    let mut all = vec![as_it_is.clone()];
    all.extend(tried.iter().cloned());
    StructureAnswer {
        verdict,
        measured_hz: measured.modes_hz.clone(),
        model_hz: as_it_is.modes_hz.clone(),
        model_errors_percent: as_it_is.errors_percent.clone(),
        tried: all,
        chosen: chosen.cloned(),
        alternatives,
    }
}
