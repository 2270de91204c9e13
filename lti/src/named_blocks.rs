//! Connection by name: blocks with named signals, and sums of signals.

use std::collections::BTreeMap;

use crate::connect::{Wiring, append, interconnect};
use crate::{Error, Mat, StateSpace};

/// A system whose signals have names.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedSystem {
    /// The system.
    pub system: StateSpace,
    /// One name an input: which signal feeds it. Several blocks may listen to one signal.
    pub inputs: Vec<String>,
    /// One name an output: the signal that it drives. A signal is driven once.
    pub outputs: Vec<String>,
}

/// A summand of a sum of named signals: `factor * signal`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SignalTerm<'a> {
    /// Factor of the signal.
    pub factor: f64,
    /// The name of the signal.
    pub signal: &'a str,
}

impl<'a> SignalTerm<'a> {
    /// Returns the summand `factor * signal`.
    pub const fn new(factor: f64, signal: &'a str) -> Self {
        Self { factor, signal }
    }
}

impl NamedSystem {
    /// Returns names the signals of a system.
    ///
    /// # Errors
    /// [`Error::Shape`] if the names are not one a signal.
    pub fn new(system: StateSpace, inputs: &[&str], outputs: &[&str]) -> Result<Self, Error> {
        let (found, expected) = ((outputs.len(), inputs.len()), (system.outputs(), system.inputs()));
        if found != expected {
            return Err(Error::Shape { what: "names of outputs and inputs", found, expected });
        }
        let own = |names: &[&str]| names.iter().map(|&name| name.to_string()).collect();
        Ok(Self { system, inputs: own(inputs), outputs: own(outputs) })
    }

    /// Returns the sum `output = sum of factor * signal`, as a static block: `Named::sum("e", &[SignalTerm::new(1.0, "r"),
    /// SignalTerm::new(-1.0, "y")], ...)`.
    ///
    /// # Errors
    /// As [`StateSpace::gain`].
    pub fn sum(output: &str, terms: &[SignalTerm<'_>], timebase: crate::Timebase) -> Result<Self, Error> {
        let factors: Vec<f64> = terms.iter().map(|term| term.factor).collect();
        let names: Vec<&str> = terms.iter().map(|term| term.signal).collect();
        Self::new(StateSpace::gain(Mat::row(&factors), timebase)?, &names, &[output])
    }
}

/// Returns the system from the external signals `inputs` to the signals `outputs`, all blocks wired by name.
///
/// An input of a block is fed by the block output or external input of the same name; an external input may be asked
/// for as an output too. States are those of the blocks, in their order.
///
/// # Errors
/// [`Error::Signal`] for a name that nothing drives (with the nearest name that exists), that is driven twice, or an
/// external input that nothing listens to; [`Error::Timebase`], [`Error::AlgebraicLoop`].
pub fn connect(blocks: &[NamedSystem], inputs: &[&str], outputs: &[&str]) -> Result<StateSpace, Error> {
    let Some((first, rest)) = blocks.split_first() else {
        return Err(signal("(none)", "cannot be connected: there are no blocks", &[]));
    };
    let all = rest.iter().try_fold(first.system.clone(), |sum, block| append(&sum, &block.system))?;
    // External inputs pass through a unit gain, so that they can be outputs as well.
    let through = StateSpace::gain(Mat::eye(inputs.len()), all.timebase)?;
    let all = append(&all, &through)?;
    let external = inputs.iter().map(|&name| name.to_string());
    let driven: Vec<String> = blocks.iter().flat_map(|b| b.outputs.clone()).chain(external).collect();
    let wanted: Vec<&str> = blocks.iter().flat_map(|b| b.inputs.iter().map(String::as_str)).collect();
    let drivers = drivers(&driven)?;
    check_heard(inputs, &wanted, outputs)?;
    let find = |name: &str| {
        drivers.get(name).copied().ok_or_else(|| signal(name, "is not driven by any block", &driven))
    };

    let (m, p) = (all.inputs(), all.outputs());
    let (mut F, mut E, mut S) = (Mat::zeros(m, p), Mat::zeros(m, inputs.len()), Mat::zeros(outputs.len(), p));
    for (row, name) in wanted.iter().enumerate() {
        F[(row, find(name)?)] = 1.0;
    }
    E.set_block(wanted.len(), 0, &Mat::eye(inputs.len()));
    for (row, name) in outputs.iter().enumerate() {
        S[(row, find(name)?)] = 1.0;
    }
    interconnect("connect", &all, &Wiring { F: &F, E: &E, S: &S })
}

/// Returns which output drives each signal.
fn drivers(driven: &[String]) -> Result<BTreeMap<&str, usize>, Error> {
    let mut drivers = BTreeMap::new();
    for (at, name) in driven.iter().enumerate() {
        if drivers.insert(name.as_str(), at).is_some() {
            return Err(signal(name, "is driven twice", &[]));
        }
    }
    Ok(drivers)
}

/// Checks that a block uses every external input.
fn check_heard(inputs: &[&str], wanted: &[&str], outputs: &[&str]) -> Result<(), Error> {
    let wanted: Vec<String> = wanted.iter().map(|name| name.to_string()).collect();
    let deaf = inputs.iter().find(|&&name| !wanted.iter().any(|w| w == name) && !outputs.contains(&name));
    deaf.map_or(Ok(()), |name| Err(signal(name, "is an external input that no block listens to", &wanted)))
}

fn signal(name: &str, problem: &'static str, known: &[String]) -> Error {
    let nearest = known.iter().map(|other| (distance(name, other), other)).min();
    let hint = match nearest {
        Some((d, other)) if d <= name.chars().count().div_ceil(2) => format!(", did you mean '{other}'?"),
        _ => String::new(),
    };
    Error::Signal { name: name.to_string(), problem, hint }
}

/// Returns the number of letters to change, add or leave out (Levenshtein).
fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, from) in a.chars().enumerate() {
        let mut diagonal = std::mem::replace(&mut row[0], i + 1);
        for (j, to) in b.iter().enumerate() {
            let change = diagonal + usize::from(from != *to);
            diagonal = row[j + 1];
            row[j + 1] = change.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::panic)]
    use super::*;
    use crate::{Timebase, feedback, response_at, series};

    fn lag(pole: f64) -> StateSpace {
        StateSpace::new(
            Mat::row(&[-pole]),
            Mat::eye(1),
            Mat::row(&[pole]),
            Mat::zeros(1, 1),
            Timebase::Continuous,
        )
        .unwrap()
    }

    fn blocks() -> Vec<NamedSystem> {
        vec![
            NamedSystem::new(lag(2.0), &["u"], &["y"]).unwrap(),
            NamedSystem::new(lag(9.0), &["e"], &["u"]).unwrap(),
            NamedSystem::sum(
                "e",
                &[SignalTerm::new(1.0, "r"), SignalTerm::new(-1.0, "y")],
                Timebase::Continuous,
            )
            .unwrap(),
        ]
    }

    #[test]
    fn a_loop_wired_by_name_is_the_loop() {
        let named = connect(&blocks(), &["r"], &["y", "e", "r"]).unwrap();
        let path = series(&lag(9.0), &lag(2.0)).unwrap();
        let closed = feedback(&path, &StateSpace::gain(Mat::eye(1), Timebase::Continuous).unwrap()).unwrap();
        let (a, b) = (response_at(&named, 3.0).unwrap(), response_at(&closed, 3.0).unwrap()[(0, 0)]);
        assert!((a[(0, 0)] - b).norm() < 1e-15 && (a[(1, 0)] + b - 1.0).norm() < 1e-15);
        assert_eq!(a[(2, 0)].re, 1.0);
    }

    #[test]
    fn wrong_names_are_named() {
        let mut wrong = blocks();
        wrong[1].inputs[0] = "ee".to_string();
        let Err(error) = connect(&wrong, &["r"], &["y"]) else { panic!("accepted") };
        assert_eq!(error.to_string(), "signal 'ee' is not driven by any block, did you mean 'e'?");
        let mut twice = blocks();
        twice[1].outputs[0] = "y".to_string();
        assert!(connect(&twice, &["r"], &["y"]).is_err());
        let Err(error) = connect(&blocks(), &["r", "spare"], &["y"]) else { panic!("accepted") };
        assert_eq!(error.to_string(), "signal 'spare' is an external input that no block listens to");
    }
}
