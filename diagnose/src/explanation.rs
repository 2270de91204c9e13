//! The model that explains the recordings: effects of the library, a free function, or both.

use counterpoise_models::Parameters;

use crate::findings::answer::{Answer, DiagnosisVerdict, Name};
use crate::findings::verdict::VerdictEvidence;
use crate::learning::LearningTask;
use crate::learning::comparison::{Comparison, is_flexible};
use crate::learning::visited_ranges::VisitedRanges;
use crate::library::{Component, EffectName};
use crate::localisation::error_map::rank_components;
use crate::recording::measured_signals::MeasuredSignals;
use crate::selection::candidate::FittedCandidate;
use crate::selection::outcome::SearchOutcome;
use crate::selection::searcher::Searcher;
use crate::simulator_access::Assessment;
use crate::tolerance::RIVAL_DECAY;
use crate::tolerance::learning::NAMED_FROM_CURVES;

/// The answer with the mechanism that explains the recordings.
pub(crate) struct Explanation {
    pub answer: Answer,
    pub improved: Parameters,
}

/// Derives the answer from a search: effects of the library are named if they predict held-out data better than one free function does in
/// their place; what they leave, or all of it, is modelled by free functions; a curve that is an effect of the library gets its name.
pub(crate) fn explain(searcher: &Searcher, evidence: VerdictEvidence) -> Explanation {
    let mut search = evidence.search.clone();
    let comparison =
        flexible_effects(searcher, &evidence).and_then(|named| compare(searcher, &evidence, &named));
    if comparison.is_some_and(|c| c.prefers_function()) {
        search.accepted = None;
        search.rivals = Vec::new();
    }
    let mut learned = None;
    for _ in 0..=NAMED_FROM_CURVES {
        let now = VerdictEvidence { search: &search, map: evidence.map.clone(), ..copy_of(&evidence) };
        learned = None;
        if !matches!(now.verdict(), DiagnosisVerdict::Unknown | DiagnosisVerdict::Incomplete)
            || searcher.pool.is_cancelled()
        {
            break;
        }
        let named = now.named_model().cloned();
        let Some(rest) = Rest::of(searcher, &now) else { break };
        let task = rest.task(searcher, &now);
        let Some(first) = task.one_function() else { break };
        let first = task.with_simple_form(first);
        if let Some(better) = task.name_function(&first, named.as_ref()) {
            search.accepted = Some(better);
            search.rivals = Vec::new();
            continue;
        }
        learned = task.with_more(first).model(&task);
        break;
    }
    if learned.is_none() && search.accepted.is_none() {
        // no free function took the place of what was named after all
        search = evidence.search.clone();
    }
    let evidence = VerdictEvidence { search: &search, ..evidence };
    let improved = evidence.improved_mechanism();
    let even = comparison.filter(Comparison::is_even);
    let answer = evidence.answer();
    match learned {
        Some((model, improved)) => Explanation { answer: answer.with_learned(model), improved },
        None => Explanation { answer: lower_confidence(answer, even), improved },
    }
}

/// Returns the same evidence with an empty localisation.
fn copy_of<'e>(evidence: &VerdictEvidence<'e>) -> VerdictEvidence<'e> {
    VerdictEvidence {
        simulator: evidence.simulator,
        base: evidence.base,
        search: evidence.search,
        map: Vec::new(),
        isolability: evidence.isolability.clone(),
        remarks: Vec::new(),
        sizes: evidence.sizes,
    }
}

/// Returns the named effects if they are flexible enough to imitate an error that is none of them.
fn flexible_effects(searcher: &Searcher, evidence: &VerdictEvidence) -> Option<FittedCandidate> {
    let named = evidence.named_model()?;
    is_flexible(named, searcher.simulator.travel_rad()).then(|| named.clone())
}

/// Compares the named effects with one free function in their place.
fn compare(searcher: &Searcher, evidence: &VerdictEvidence, named: &FittedCandidate) -> Option<Comparison> {
    let nothing = SearchOutcome { accepted: None, ..evidence.search.clone() };
    let bare = VerdictEvidence { search: &nothing, map: evidence.map.clone(), ..copy_of(evidence) };
    let rest = Rest::of(searcher, &bare)?;
    let task = rest.task(searcher, &bare);
    task.compare(named)
}

/// The part that is left to be modelled beside the named effects.
struct Rest {
    base: Parameters,
    before: Vec<Assessment>,
    components: Vec<Component>,
    visited: VisitedRanges,
}

impl Rest {
    fn of(searcher: &Searcher, evidence: &VerdictEvidence) -> Option<Self> {
        let base = evidence.improved_mechanism();
        let before = match evidence.named_model() {
            Some(named) => searcher.assess_model(&base, &|r| named.assessments.get(r))?,
            None => evidence.search.baseline.fitted.clone(),
        };
        let simulator = evidence.simulator;
        let signals: Vec<MeasuredSignals> =
            (0..simulator.count()).filter_map(|r| simulator.measured_signals(r)).collect();
        let visited = VisitedRanges::of(&base, &signals);
        Some(Self { base, before, components: rank_components(&evidence.map), visited })
    }

    fn task<'t>(&'t self, searcher: &'t Searcher<'t>, evidence: &'t VerdictEvidence) -> LearningTask<'t> {
        LearningTask {
            searcher,
            base: &self.base,
            before: &self.before,
            map: &evidence.map,
            components: &self.components,
            visited: &self.visited,
        }
    }
}

/// Returns an answer whose names are as probable as the comparison with a free function allows.
fn lower_confidence(mut answer: Answer, even: Option<Comparison>) -> Answer {
    let Some(comparison) = even else { return answer };
    let share = 1.0 / (1.0 + (RIVAL_DECAY * comparison.function_gain_nats.min(0.0)).exp());
    for finding in &mut answer.findings {
        finding.probability *= share;
        let unknown = Name { effect: EffectName::Unknown, component: finding.component };
        if !finding.alternatives.contains(&unknown) {
            finding.alternatives.push(unknown);
        }
    }
    if answer.verdict == DiagnosisVerdict::Named {
        answer.verdict = DiagnosisVerdict::Ambiguous;
    }
    answer
}
