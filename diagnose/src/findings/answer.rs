//! The findings of the diagnosis: plain data, without sentences.

use serde::Serialize;

use crate::findings::channel_fits::{PooledFits, largest_ratio};
use crate::learning::{LearnedModel, is_at};
use crate::library::{Component, EffectName, component_of};
use crate::localisation::error_hypotheses::Regime;
use crate::localisation::error_map::MapCell;
use crate::localisation::torque_balances::BalanceVisibility;
use crate::localisation::trend::Trend;
use crate::recording::instrument_faults::InstrumentFault;
use crate::recording::remarks::RecordingRemark;
use crate::tolerance::RIGHT_OF_UNKNOWN;

/// The verdict of a diagnosis: of recordings, or of the measured modes of a structure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum DiagnosisVerdict {
    /// The model explains what was measured: nothing found.
    Consistent,
    /// An effect was identified, and with it the measurements are explained.
    Named,
    /// An effect was identified, but it explains only part.
    Incomplete,
    /// One of several equivalent effects, which these measurements cannot tell apart.
    Ambiguous,
    /// No effect that is known explains the measurements.
    Unknown,
}

/// A fitted parameter of an effect.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FittedParameter {
    /// Name.
    pub name: &'static str,
    /// Value.
    pub value: f64,
    /// Unit.
    pub unit: &'static str,
    /// Value in the model as it was.
    pub before: f64,
    /// 95 % interval.
    pub ci95: [f64; 2],
}

/// An effect by its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Name {
    /// Effect.
    pub effect: EffectName,
    /// Component.
    pub component: Component,
}

impl Name {
    /// Returns component and effect as results name them.
    pub fn names(self) -> (&'static str, &'static str) {
        (self.component.name(), self.effect.name())
    }
}

/// Evidence of a finding.
#[derive(Debug, Clone, PartialEq)]
pub enum FindingBasis {
    /// An effect of the library that was fitted in the simulator.
    FittedEffect {
        /// Largest RMS error over its noise floor, with the model as it was.
        worst_before: f64,
        /// The same with the fitted model.
        worst_after: f64,
    },
    /// No effect of the library explains the residual.
    NoKnownEffect {
        /// The variable that the mismatch depends on; `None` if that was not found.
        pattern: Option<Pattern>,
        /// The known effect that explains most.
        nearest: Option<NearestEffect>,
    },
    /// A fault of a sensor or of the recorder.
    InstrumentFault(InstrumentFault),
}

/// Variable on which a mismatch depends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pattern {
    /// The variable that it follows.
    pub regime: Regime,
    /// Share of what can be explained that an error along that variable explains, 0 to 1.
    pub explained: f64,
    /// Course of the error along the variable.
    pub trend: Option<Trend>,
}

/// The known effect that is nearest to explaining a mismatch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NearestEffect {
    /// Name.
    pub name: Name,
    /// Share of the residual's power that it removes on held-out data, 0 to 1.
    pub share: f64,
}

/// One finding.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// Effect.
    pub effect: EffectName,
    /// Component.
    pub component: Component,
    /// Probability that the effect, by this name, is in the machine.
    pub probability: f64,
    /// Evidence.
    pub basis: FindingBasis,
    /// Fitted parameters.
    pub parameters: Vec<FittedParameter>,
    /// Effects that explain these recordings equally well.
    pub alternatives: Vec<Name>,
}

impl Finding {
    /// Puts an unknown effect where a free function models it: what predicts held-out data in the simulator tells more than the balances.
    fn relocate(&mut self, learned: &LearnedModel) {
        let Some(first) = learned.parts.first() else { return };
        self.probability = RIGHT_OF_UNKNOWN * learned.place_probability;
        let place = first.element.place;
        if is_at(self.component, place) {
            return;
        }
        let unknown = |component| Name { effect: EffectName::Unknown, component };
        let (was, now) = (unknown(self.component), unknown(component_of(place)));
        self.component = now.component;
        self.alternatives.retain(|name| *name != now);
        if was.component != Component::Unknown {
            self.alternatives.insert(0, was);
        }
    }

    /// Returns the name of the effect that was found.
    pub fn name(&self) -> Name {
        Name { effect: self.effect, component: self.component }
    }
}

/// Table of the improvement of the fit.
#[derive(Debug, Clone, PartialEq, Serialize, Default)]
pub struct FitTable {
    /// All data, the model as it was.
    pub before: PooledFits,
    /// All data, the improved model.
    pub after: PooledFits,
    /// Held-out data, the model as it was.
    pub held_out_before: PooledFits,
    /// Held-out data, the model fitted to the rest.
    pub held_out_after: PooledFits,
}

impl FitTable {
    /// Returns the largest RMS error over its noise floor of all channels, of all data with the model as it was.
    pub fn largest_before(&self) -> f64 {
        largest_ratio(&self.before)
    }

    /// Returns the same with the improved model.
    pub fn largest_after(&self) -> f64 {
        largest_ratio(&self.after)
    }

    /// Returns the same of held-out data, with the model fitted to the rest.
    pub fn largest_held_out(&self) -> f64 {
        largest_ratio(&self.held_out_after)
    }
}

/// An effect of which these recordings cannot show whether it is present.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct UnexcitedEffect {
    /// Effect.
    pub effect: EffectName,
    /// Component.
    pub component: Component,
    /// Smallest change of its first parameter that these recordings would show; `None` if no reasonable change affects them.
    pub smallest_detectable: Option<f64>,
    /// Parameter whose size is meant.
    pub parameter: &'static str,
    /// Unit.
    pub unit: &'static str,
}

/// The experiment that would say more.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NextExperiment {
    /// The experiment that shows the found effect clearly, so that it can be told from another.
    Separate {
        /// The effect that was found.
        found: Name,
        /// The effect that explains the recordings equally well.
        alternative: Name,
    },
    /// Slow travel and a multisine at several amplitudes: they separate what depends on position, on rate and on amplitude.
    TravelAndMultisine,
    /// The comparison of a sensor that may err with another one of the same motion.
    Comparison {
        /// The sensor.
        sensor: Component,
    },
}

impl NextExperiment {
    /// Returns the experiment that would say more of an effect without a name, by where it was located.
    pub(crate) fn of_unknown(findings: &[Finding]) -> Self {
        let unknown = findings.iter().find(|finding| finding.effect == EffectName::Unknown);
        match unknown.map(|finding| finding.component) {
            Some(
                sensor @ (Component::HubGyro
                | Component::PlatformGyro
                | Component::PlatformAccelerometer
                | Component::MotorTachometer
                | Component::HubResolver),
            ) => Self::Comparison { sensor },
            _ => Self::TravelAndMultisine,
        }
    }
}

/// A warning about the search itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SearchWarning {
    /// The user stopped the search before it was finished.
    Stopped,
    /// The last fit reached its iteration limit before it settled.
    IterationLimit,
}

/// A fitted parameter of a hypothesis.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HypothesisValue {
    /// Name.
    pub name: &'static str,
    /// Value.
    pub value: f64,
    /// Unit.
    pub unit: &'static str,
}

/// A hypothesis that was fitted and assessed, for the table of evidence.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Hypothesis {
    /// Stage of the search at which it was tried, from 1.
    pub stage: usize,
    /// Effect.
    pub effect: EffectName,
    /// Component.
    pub component: Component,
    /// Effects that were fitted together with it.
    pub beside: Vec<Name>,
    /// Fitted parameters.
    pub values: Vec<HypothesisValue>,
    /// Share of the power of the residual that it leaves on held-out data, mean over recordings and channels.
    pub power_left: f64,
    /// Log-likelihood gained on held-out data.
    pub log_likelihood_gain: f64,
    /// Mean ln(RMS / floor) left over all channels: 0 is perfect.
    pub distance: f64,
    /// Largest RMS / floor left.
    pub worst: f64,
    /// `true` if it was accepted.
    pub accepted: bool,
}

/// The whole answer.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// Verdict.
    pub verdict: DiagnosisVerdict,
    /// Findings, most important first; empty if the verdict is consistent.
    pub findings: Vec<Finding>,
    /// Improvement of the fit.
    pub fit: FitTable,
    /// Effects that these recordings do not excite enough to show.
    pub not_excited: Vec<UnexcitedEffect>,
    /// Proposed next experiment.
    pub next_experiment: Option<NextExperiment>,
    /// Balances that these sensors allow, and what each can see.
    pub isolability: Vec<BalanceVisibility>,
    /// The localisation: component by regime.
    pub map: Vec<MapCell>,
    /// Evidence: everything that was tried.
    pub hypotheses: Vec<Hypothesis>,
    /// Remarks on the recordings themselves.
    pub remarks: Vec<RecordingRemark>,
    /// Warnings of the search itself.
    pub warnings: Vec<SearchWarning>,
    /// Free functions that model what no effect of the library explains; `None` if nothing is left over, or no free function
    /// predicts it.
    pub learned: Option<LearnedModel>,
}

impl Answer {
    /// Returns the answer with a model of what no effect of the library explains.
    #[must_use]
    pub(crate) fn with_learned(mut self, learned: LearnedModel) -> Self {
        self.fit.after.clone_from(&learned.after);
        self.fit.held_out_before.clone_from(&learned.held_out_before);
        self.fit.held_out_after.clone_from(&learned.held_out_after);
        for finding in self.findings.iter_mut().filter(|f| f.effect == EffectName::Unknown) {
            finding.relocate(&learned);
        }
        if matches!(
            self.next_experiment,
            Some(NextExperiment::TravelAndMultisine | NextExperiment::Comparison { .. })
        ) {
            self.next_experiment = Some(NextExperiment::of_unknown(&self.findings));
        }
        self.learned = Some(learned);
        self
    }
}
