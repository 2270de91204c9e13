//! A diagnosis in sentences: what the command line prints, the JSON result carries and the studio shows.

use counterpoise_diagnose::Diagnosis;
use counterpoise_diagnose::findings::answer::{
    Answer, DiagnosisVerdict, Finding, FindingBasis, FitTable, FittedParameter, Hypothesis, Name,
    NextExperiment, SearchWarning, UnexcitedEffect,
};
use counterpoise_diagnose::findings::localisation_chart::LocalisationChart;
use counterpoise_diagnose::library::{Component, EffectName};
use counterpoise_diagnose::localisation::error_hypotheses::Regime;
use counterpoise_diagnose::localisation::error_map::MapCell;
use counterpoise_diagnose::localisation::torque_balances::BalanceVisibility;
use counterpoise_pipeline::recordings::{ColumnRemark, DiagnosedRecordings};
use serde::{Serialize, Serializer};

use super::effects::{describe_effect, experiment_for};
use super::held_out_recordings::HeldOutText;
use super::learned::{LearnedText, describe_learned};
use super::localisation::{describe_chart, describe_pattern, describe_trend};
use super::recordings::{describe_column_remark, describe_fault, describe_missing_demand, describe_remark};

/// A whole answer, its findings and remarks in sentences.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AnswerText {
    /// Verdict.
    pub verdict: DiagnosisVerdict,
    /// Findings, most important first; none if the verdict is consistent.
    pub findings: Vec<FindingText>,
    /// Improvement of the fit.
    pub fit: FitTable,
    /// Effects of which these recordings cannot tell whether they are there.
    pub not_excited: Vec<UnexcitedEffect>,
    /// Proposed next experiment.
    pub next_experiment: Option<ExperimentText>,
    /// Balances that these sensors allow, and what each can show.
    pub isolability: Vec<BalanceVisibility>,
    /// The localisation: component by regime.
    pub map: Vec<CellText>,
    /// Evidence: everything that was tried.
    pub hypotheses: Vec<Hypothesis>,
    /// Remarks on the recordings themselves.
    pub qualification: Vec<String>,
    /// Warnings about the search itself; serialised as sentences.
    #[serde(serialize_with = "write_warnings")]
    pub warnings: Vec<SearchWarning>,
    /// A model without a name of what no known effect explains; absent if there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub learned: Option<LearnedText>,
    /// Recordings that the diagnosis was not given, replayed by the model as it was and by the improved one; absent if there are none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub held_out_recordings: Vec<HeldOutText>,
    /// The chart of the localisation; not part of the JSON result.
    #[serde(skip)]
    pub chart: LocalisationChart,
    /// Conclusion of the chart; not part of the JSON result.
    #[serde(skip)]
    pub chart_summary: String,
}

/// One finding.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FindingText {
    /// Effect.
    pub effect: EffectName,
    /// Component.
    pub component: Component,
    /// Probability that the effect, by this name, is in the machine.
    pub probability: f64,
    /// The regime in which it shows.
    pub when: String,
    /// Equation, size, and what it explains.
    pub explanation: String,
    /// Fitted parameters.
    pub parameters: Vec<FittedParameter>,
    /// Effects that explain these recordings equally well.
    pub alternatives: Vec<Name>,
}

/// The experiment that would say more.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ExperimentText {
    /// The experiment to run.
    pub what: String,
    /// The effects that it separates.
    pub why: String,
}

/// Gain that an error at one component explains if it is a free function of one regime variable.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CellText {
    /// Component.
    pub component: Component,
    /// Regime variable.
    pub regime: Regime,
    /// Share, 0 to 1, of the log-likelihood that a perfect explanation would gain; 0 if it gains no more than noise may.
    pub explained: f64,
    /// Gain in the natural logarithm of the likelihood of held-out data.
    pub log_likelihood_gain: f64,
    /// Shape of that function; empty if the variable explains little or the function has no simple form.
    pub shape: String,
}

/// A diagnosis with its answer in sentences.
#[derive(Debug, Clone)]
pub struct DescribedDiagnosis {
    /// The answer in sentences.
    pub answer: AnswerText,
    /// The diagnosis.
    pub diagnosis: Diagnosis,
}

/// A verdict in words.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct VerdictText {
    /// Name, as the glossary has it.
    pub name: &'static str,
    /// Statement on the model and the recordings, without a capital and a full stop.
    pub sentence: &'static str,
}

/// Describes a verdict: the one wording of the terminal, the report and the studio. The JSON result keeps its own words.
pub fn describe_verdict(verdict: DiagnosisVerdict) -> VerdictText {
    let (name, sentence) = match verdict {
        DiagnosisVerdict::Consistent => ("consistent", "the model explains the recordings"),
        DiagnosisVerdict::Named => {
            ("identified", "with the effects found, the model explains the recordings")
        }
        DiagnosisVerdict::Ambiguous => {
            ("ambiguous", "several effects explain the recordings, which cannot distinguish between them")
        }
        DiagnosisVerdict::Incomplete => {
            ("incomplete", "the effects found explain part of the residual; something else remains")
        }
        DiagnosisVerdict::Unknown => ("unidentified", "the model lacks an effect that is not in the library"),
    };
    VerdictText { name, sentence }
}

/// Describes a diagnosis of files: what was found on reading them comes first among the remarks about the recordings.
pub fn describe_diagnosed_recordings(diagnosed: &DiagnosedRecordings) -> DescribedDiagnosis {
    let diagnosis = diagnosed.diagnosis.clone();
    let answer = describe_answer(&diagnosis.answer, &diagnosed.chart);
    let mut described = DescribedDiagnosis { answer, diagnosis };
    let of_file = |(file, remarks): &(String, Vec<ColumnRemark>)| {
        let sentence = |remark: &ColumnRemark| format!("{file}: {}", describe_column_remark(remark));
        remarks.iter().map(sentence).collect::<Vec<_>>()
    };
    let demand = describe_missing_demand(&diagnosed.without_demand);
    let remarks = demand.into_iter().chain(diagnosed.remarks.iter().flat_map(of_file));
    described.answer.qualification.splice(0..0, remarks);
    described
}

/// Describes an answer with the chart of its localisation.
pub fn describe_answer(answer: &Answer, chart: &LocalisationChart) -> AnswerText {
    let cell = |cell: &MapCell| CellText {
        component: cell.component,
        regime: cell.regime,
        explained: cell.explained,
        log_likelihood_gain: cell.log_likelihood_gain,
        shape: cell.trend.map_or_else(String::new, describe_trend),
    };
    AnswerText {
        verdict: answer.verdict,
        findings: answer.findings.iter().map(describe_finding).collect(),
        fit: answer.fit.clone(),
        not_excited: answer.not_excited.clone(),
        next_experiment: answer.next_experiment.map(describe_experiment),
        isolability: answer.isolability.clone(),
        map: answer.map.iter().map(cell).collect(),
        hypotheses: answer.hypotheses.clone(),
        qualification: answer.remarks.iter().map(describe_remark).collect(),
        warnings: answer.warnings.clone(),
        learned: answer.learned.as_ref().map(describe_learned),
        held_out_recordings: Vec::new(),
        chart_summary: describe_chart(chart),
        chart: chart.clone(),
    }
}

/// Returns a unit as it is written after a number: a space and the unit, or nothing for a pure number.
pub fn unit_suffix(parameter: &FittedParameter) -> String {
    if parameter.unit == "1" { String::new() } else { format!(" {}", parameter.unit) }
}

/// Returns names of components, separated by commas.
pub fn component_list(components: &[Component]) -> String {
    let names: Vec<&str> = components.iter().map(|component| component.name()).collect();
    names.join(", ")
}

/// Describes one finding.
pub fn describe_finding(finding: &Finding) -> FindingText {
    let (when, explanation) = match &finding.basis {
        FindingBasis::FittedEffect { worst_before, worst_after } => {
            describe_fitted_effect(finding, *worst_before, *worst_after)
        }
        FindingBasis::NoKnownEffect { pattern, nearest } => {
            let nearest = nearest.map_or_else(String::new, |nearest| {
                format!(
                    " The nearest, {} {}, removes {:.0} % of the residual's power on held-out data.",
                    nearest.name.component,
                    nearest.name.effect,
                    100.0 * nearest.share.max(0.0)
                )
            });
            let explanation = format!("No effect of the library explains the residual.{nearest}");
            (describe_pattern(pattern.as_ref()), explanation)
        }
        FindingBasis::InstrumentFault(fault) => {
            let when = if fault.everywhere {
                "in every recording".to_owned()
            } else {
                format!("in {}", fault.recordings.join(", "))
            };
            (when, format!("A fault of the sensor or the recorder, no physics: {}.", describe_fault(fault)))
        }
    };
    FindingText {
        effect: finding.effect,
        component: finding.component,
        probability: finding.probability,
        when,
        explanation,
        parameters: finding.parameters.clone(),
        alternatives: finding.alternatives.clone(),
    }
}

/// Parameters of an effect whose values its explanation gives.
const PARAMETERS_IN_EXPLANATION: usize = 4;

/// Returns when a fitted effect shows, and its explanation.
fn describe_fitted_effect(finding: &Finding, worst_before: f64, worst_after: f64) -> (String, String) {
    let first = finding.parameters.first().map_or("", |parameter| parameter.name);
    let text = describe_effect(finding.component, finding.effect, first);
    let size =
        |p: &FittedParameter| format!("{} {:.4}{} (was {:.4})", p.name, p.value, unit_suffix(p), p.before);
    let sizes: Vec<String> = finding.parameters.iter().take(PARAMETERS_IN_EXPLANATION).map(size).collect();
    let explanation = format!(
        "{}; {}. Largest RMS residual over its noise floor: {worst_before:.1} before, {worst_after:.2} after.",
        text.map_or("", |text| text.equation),
        sizes.join(", ")
    );
    (text.map_or("", |text| text.regime).to_owned(), explanation)
}

fn describe_experiment(experiment: NextExperiment) -> ExperimentText {
    match experiment {
        NextExperiment::Separate { found, alternative } => ExperimentText {
            what: experiment_for(found.component, found.effect).unwrap_or_default().to_owned(),
            why: format!(
                "distinguishes {} {} from {} {}",
                found.component, found.effect, alternative.component, alternative.effect
            ),
        },
        NextExperiment::TravelAndMultisine => ExperimentText {
            what: "slow travel over the whole range both ways, then a multisine at three amplitudes"
                .to_owned(),
            why: "separates what depends on position, on rate and on amplitude".to_owned(),
        },
        NextExperiment::Comparison { sensor } => ExperimentText {
            what: comparison_of(sensor).to_owned(),
            why: format!(
                "compares {sensor} with another sensor of the same motion: an error of the sensor is in its reading alone, physics is in both"
            ),
        },
    }
}

/// Returns the experiment that compares a sensor with another one.
fn comparison_of(sensor: Component) -> &'static str {
    match sensor {
        Component::PlatformGyro | Component::PlatformAccelerometer => {
            "the hub held on the platform, and the platform moved slowly through zero and to its largest motion both ways, recorded by the sensors of hub and platform together"
        }
        Component::MotorTachometer | Component::HubResolver => {
            "a slow triangle of the rate through zero to the largest rate both ways, recorded with the gyroscope, the resolver and the tachometer together"
        }
        _ => {
            "a slow triangle of the rate through zero to the largest rate both ways, recorded with a resolver, an encoder or a tachometer as well; then the hub held on the platform and the platform tilted slowly"
        }
    }
}

fn write_warnings<S: Serializer>(warnings: &[SearchWarning], to: S) -> Result<S::Ok, S::Error> {
    to.collect_seq(warnings.iter().copied().map(describe_warning))
}

/// Describes a warning about the search itself.
pub fn describe_warning(warning: SearchWarning) -> &'static str {
    match warning {
        SearchWarning::Stopped => {
            "stopped before the search was finished: the answer is what was found so far"
        }
        SearchWarning::IterationLimit => "the last fit reached its iteration limit before it settled",
    }
}
