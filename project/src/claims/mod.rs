//! The claims of the thesis that this studio grew from, each measured on the project's mechanism.
//!
//! In comes a project (the reference rig); out comes one [`Claim`] a row: what the thesis says, what was measured, and whether it
//! holds. Nothing is tuned for a row: every threshold stands beside its claim. A row that honestly differs stays, with its reason.
//!
//! The source is D. K. Dholiwar, *Control of out-of-balance servo mechanism subjected to external disturbances*, PhD thesis,
//! Loughborough University, 2007.
//!
//! Modules in reading order: [`bench`], [`structure`], [`linear`], [`nonlinear`], [`imbalance`], [`friction_laws`], [`tests_of`],
//! [`identified`], [`adaptation`], [`weights`], [`beyond`].

pub mod adaptation;
pub mod bench;
pub mod beyond;
pub mod friction_laws;
pub mod identified;
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
    /// C1 to C27, and F1 to F4 for what the thesis asks for beyond itself.
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

const ROWS: [Row; 31] = [
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
    friction_laws::c15,
    friction_laws::c16,
    tests_of::c17,
    tests_of::c18,
    identified::c19,
    identified::c20,
    tests_of::c21,
    imbalance::c22,
    nonlinear::c23,
    adaptation::c24,
    nonlinear::c25,
    weights::c26,
    weights::c27,
    adaptation::f1,
    beyond::f2,
    friction_laws::f3,
    beyond::f4,
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
    Ok(rows)
}
