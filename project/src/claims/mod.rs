//! The claims of the thesis that this studio grew from, each measured on the project's mechanism.
//!
//! In comes a project (the reference rig); out comes one [`Claim`] a row: what the thesis says, what was measured, and whether it
//! holds. Nothing is tuned for a row: every threshold stands beside its claim. A row that honestly differs stays, with its reason.
//!
//! The source is D. K. Dholiwar, *Control of out-of-balance servo mechanism subjected to external disturbances*, PhD thesis,
//! Loughborough University, 2007.
//!
//! Modules in reading order: [`bench`], [`structure`], [`linear`], [`nonlinear`], [`imbalance`], [`tests_of`], [`weights`].

pub mod bench;
pub mod imbalance;
pub mod linear;
pub mod nonlinear;
pub mod structure;
pub mod tests_of;
pub mod weights;

pub use bench::Bench;

use crate::Project;
use crate::pipeline::{PipelineError, World};

/// A row of the table.
#[derive(Debug, Clone, PartialEq)]
pub struct Claim {
    /// C1 to C27.
    pub id: &'static str,
    /// Where in the thesis.
    pub source: &'static str,
    /// What the thesis says.
    pub says: &'static str,
    /// What was measured here.
    pub measured: String,
    /// How the two compare.
    pub finding: Finding,
}

/// How a claim turned out.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Finding {
    /// As the thesis says.
    Holds,
    /// Not as the thesis says, for a reason.
    Differs {
        /// The reason.
        why: String,
    },
    /// Not as the thesis says.
    Fails,
    /// There is no measurement.
    NotMeasured {
        /// Why.
        why: &'static str,
    },
}

impl Finding {
    /// Holds, or differs for the given reason.
    pub fn holds_or(holds: bool, why: &str) -> Self {
        if holds { Finding::Holds } else { Finding::Differs { why: why.to_owned() } }
    }

    /// Holds or fails.
    pub fn of(holds: bool) -> Self {
        if holds { Finding::Holds } else { Finding::Fails }
    }
}

/// A row and what measures it.
type Row = fn(&Bench<'_>) -> Result<Claim, PipelineError>;

const ROWS: [Row; 22] = [
    structure::c1,
    structure::c2,
    structure::c3,
    structure::c4,
    linear::c5,
    linear::c6,
    linear::c7,
    nonlinear::c8,
    structure::c9,
    nonlinear::c10,
    nonlinear::c11,
    nonlinear::c12,
    imbalance::c13,
    imbalance::c14,
    tests_of::c17,
    tests_of::c18,
    tests_of::c21,
    imbalance::c22,
    nonlinear::c23,
    nonlinear::c25,
    weights::c26,
    weights::c27,
];

/// Rows that this command does not measure.
const ELSEWHERE: [(&str, &str, &str, &str); 5] = [
    (
        "C15",
        "7.2, figs 7-2 to 7-5",
        "friction models agree at large amplitude and differ at small; Dahl fits the rig best",
        "the frequency map of the friction laws is not part of this command",
    ),
    (
        "C16",
        "7.2",
        "Dahl runs 1.5 times as fast as the reset integrator and 3 times as fast as LuGre",
        "results do not depend on a clock: the speed is a benchmark's",
    ),
    (
        "C19",
        "7.3, fig 7-10",
        "u against hub rate shows out-of-balance, friction, viscous friction and inertia",
        "identification from recordings is not part of this command",
    ),
    (
        "C20",
        "7.3.1, tables 7-1, 7-2",
        "the amplifier's gain curve is recovered without a stall test",
        "identification from recordings is not part of this command",
    ),
    (
        "C24",
        "7.6, fig 7-18",
        "the mean of the control updates the heave feedforward after steps of out-of-balance",
        "a mechanism that changes during a run is not part of this command",
    ),
];

/// Measures every row, in order. `progress` is told the number of rows done and of all.
///
/// # Errors
/// Those of the pipeline: a project that is not a whole design.
pub fn claims(
    project: &Project,
    world: &dyn World,
    progress: &dyn Fn(usize, usize),
) -> Result<Vec<Claim>, PipelineError> {
    let bench = Bench::new(project, world)?;
    let mut rows = Vec::new();
    for (done, row) in ROWS.iter().enumerate() {
        progress(done, ROWS.len());
        rows.push(row(&bench)?);
    }
    rows.extend(ELSEWHERE.map(|(id, source, says, why)| Claim {
        id,
        source,
        says,
        measured: String::new(),
        finding: Finding::NotMeasured { why },
    }));
    rows.sort_by_key(|claim| claim.id[1..].parse::<u32>().unwrap_or(u32::MAX));
    Ok(rows)
}
