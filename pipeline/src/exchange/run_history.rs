//! Time histories of simulated runs as plain data, beside the figures that were measured on them.

use std::collections::BTreeMap;

use serde::Serialize;

/// Signals of one run, sample by sample.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RunHistory {
    /// The run.
    pub name: String,
    /// Sample time, s.
    pub sample_time_s: f64,
    /// The samples by the name of each signal, which ends in its unit.
    #[serde(flatten)]
    pub signals: BTreeMap<String, Vec<f64>>,
}

impl RunHistory {
    /// Returns the history of a run with some signals.
    pub fn new(
        name: impl Into<String>,
        sample_time_s: f64,
        signals: impl IntoIterator<Item = RunSignal>,
    ) -> Self {
        let signals = signals.into_iter().map(|signal| (signal.name, signal.samples)).collect();
        Self { name: name.into(), sample_time_s, signals }
    }
}

/// A signal of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct RunSignal {
    /// Name, which ends in its unit.
    pub name: String,
    /// Samples.
    pub samples: Vec<f64>,
}

impl RunSignal {
    /// Returns a signal by its name.
    pub fn new(name: impl Into<String>, samples: impl Into<Vec<f64>>) -> Self {
        Self { name: name.into(), samples: samples.into() }
    }
}

/// A result with the time histories that its figures were measured on.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WithHistories<'a, T> {
    /// The result.
    #[serde(flatten)]
    pub result: &'a T,
    /// Time histories; absent unless they were asked for.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub histories: Vec<RunHistory>,
}
