//! What the diagnosis says: plain data, in the words that a script and a person both read.

use serde::Serialize;
use std::collections::BTreeMap;

use crate::localisation::error_map::MapCell;

/// How the recordings and the model stand to each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// The model explains the recordings: nothing found.
    Consistent,
    /// What was left out has a name, and with it the recordings are explained.
    Named,
    /// What has a name is part of it; something is left over.
    Incomplete,
    /// One of several effects that these recordings cannot tell apart.
    Ambiguous,
    /// None of the known effects.
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

impl FittedParameter {
    /// The unit as it is written after a number: a space and the unit, or nothing for a pure number.
    pub fn suffix(&self) -> String {
        if self.unit == "1" { String::new() } else { format!(" {}", self.unit) }
    }

    /// Name, value and the value in the model as it was, in words.
    pub fn in_words(&self) -> String {
        format!("{} {:.4}{} (was {:.4})", self.name, self.value, self.suffix(), self.before)
    }
}

/// An effect by its name.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Name {
    /// Effect.
    pub effect: &'static str,
    /// Component.
    pub component: &'static str,
}

/// One finding.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Finding {
    /// Effect.
    pub effect: &'static str,
    /// Component.
    pub component: &'static str,
    /// Probability that the effect, by this name, is in the machine.
    pub probability: f64,
    /// Regime in which it shows.
    pub when: String,
    /// In words: equation, size, what it explains.
    pub explanation: String,
    /// Fitted parameters.
    pub parameters: Vec<FittedParameter>,
    /// Effects that explain these recordings as well.
    pub alternatives: Vec<Name>,
}

/// Fit of one channel.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ChannelFit {
    /// RMS error.
    pub rms_error: f64,
    /// RMS that a perfect model would leave.
    pub floor: f64,
}

/// Fit of every channel, over all recordings.
pub type Channels = BTreeMap<&'static str, ChannelFit>;

/// How the fit improved.
#[derive(Debug, Clone, PartialEq, Serialize, Default)]
pub struct FitTable {
    /// All data, the model as it was.
    pub before: Channels,
    /// All data, the improved model.
    pub after: Channels,
    /// Data that was not fitted, the model as it was.
    pub held_out_before: Channels,
    /// Data that was not fitted, the model fitted to the rest.
    pub held_out_after: Channels,
}

/// An effect of which these recordings cannot say whether it is there.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NotExcited {
    /// Effect.
    pub effect: &'static str,
    /// Component.
    pub component: &'static str,
    /// Smallest change of its first parameter that these recordings would show; none where no change within reason moves them.
    pub smallest_detectable: Option<f64>,
    /// That parameter.
    pub parameter: &'static str,
    /// Its unit.
    pub unit: &'static str,
}

/// The experiment that would say more.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Experiment {
    /// What to do.
    pub what: String,
    /// What it tells apart or shows.
    pub why: String,
}

/// A hypothesis that was fitted and judged, for the table of evidence.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Hypothesis {
    /// Stage of the search at which it was tried, from 1.
    pub stage: usize,
    /// Effect.
    pub effect: &'static str,
    /// Component.
    pub component: &'static str,
    /// Effects that were fitted together with it.
    pub beside: Vec<Name>,
    /// Log-likelihood gained on data that it was not fitted to, in nats.
    pub gain_nats: f64,
    /// Mean ln(RMS / floor) left over all channels: 0 is perfect.
    pub distance: f64,
    /// Largest RMS / floor left.
    pub worst: f64,
    /// Whether it was accepted.
    pub accepted: bool,
}

/// The whole answer.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Answer {
    /// Verdict.
    pub verdict: Verdict,
    /// Findings, most important first; none where the verdict is consistent.
    pub findings: Vec<Finding>,
    /// How the fit improved.
    pub fit: FitTable,
    /// Effects of which these recordings cannot tell.
    pub not_excited: Vec<NotExcited>,
    /// What to do next.
    pub next_experiment: Option<Experiment>,
    /// Balances that these sensors allow, and what each can see.
    pub isolability: Vec<crate::localisation::torque_balances::BalanceVisibility>,
    /// Component x regime.
    pub map: Vec<MapCell>,
    /// Evidence: everything that was tried.
    pub hypotheses: Vec<Hypothesis>,
    /// What was wrong with the recordings themselves.
    pub qualification: Vec<String>,
    /// Warnings of the search itself.
    pub warnings: Vec<String>,
}
