//! The claims of the thesis that this studio grew from, each measured on the project's mechanism.
//!
//! In comes a project (the reference rig); out comes one [`Claim`] a row: what the thesis says, what was measured, and whether it
//! holds. Nothing is tuned for a row: every threshold stands beside its claim. A row that honestly differs stays, with its reason.
//!
//! The source is D. K. Dholiwar, *Control of out-of-balance servo mechanism subjected to external disturbances*, PhD thesis,
//! Loughborough University, 2007.
//!
//! Each row comes with the curves that decided it, as data ([`picture`]); whoever shows them draws them.
//!
//! Modules in reading order: [`picture`], [`bench`], [`beam`], [`structure`], [`designs`], [`linear`], [`nonlinear`], [`imbalance`], [`rejection`],
//! [`friction_laws`] (with [`explicit`]), [`tests_of`], [`identified`], [`adaptation`], [`exported`], [`weights`], [`beyond`], [`page`].

pub mod adaptation;
pub mod beam;
pub mod bench;
pub mod beyond;
pub mod designs;
pub mod explicit;
pub mod exported;
pub mod friction_laws;
pub mod identified;
pub mod imbalance;
pub mod linear;
pub mod nonlinear;
pub mod page;
pub mod picture;
pub mod rejection;
pub mod structure;
pub mod tests_of;
pub mod weights;

pub use bench::Bench;
pub use picture::Picture;

use counterpoise_pipeline::{PipelineError, World};
use counterpoise_project::Project;

/// A row of the table.
#[derive(Debug, Clone, PartialEq)]
pub struct Claim {
    /// C1 to C27, and F1 to F4 for what the thesis asks for beyond itself.
    pub id: &'static str,
    /// What the row is about, in a few words.
    pub title: &'static str,
    /// Where in the thesis.
    pub source: &'static str,
    /// What the thesis says.
    pub says: &'static str,
    /// What was measured here.
    pub measured: String,
    /// How the two compare.
    pub finding: Finding,
    /// The curves that decided it.
    pub pictures: Vec<Picture>,
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

const ROWS: [(&str, Row); 31] = [
    ("C1", beam::c1),
    ("C2", beam::c2),
    ("C3", structure::c3),
    ("C4", structure::c4),
    ("C5", linear::c5),
    ("C6", linear::c6),
    ("C7", linear::c7),
    ("C8", nonlinear::c8),
    ("C9", designs::c9),
    ("C10", nonlinear::c10),
    ("C11", nonlinear::c11),
    ("C12", nonlinear::c12),
    ("C13", imbalance::c13),
    ("C14", imbalance::c14),
    ("C15", friction_laws::c15),
    ("C16", friction_laws::c16),
    ("C17", tests_of::c17),
    ("C18", tests_of::c18),
    ("C19", identified::c19),
    ("C20", identified::c20),
    ("C21", tests_of::c21),
    ("C22", rejection::c22),
    ("C23", rejection::c23),
    ("C24", adaptation::c24),
    ("C25", exported::c25),
    ("C26", weights::c26),
    ("C27", weights::c27),
    ("F1", adaptation::f1),
    ("F2", beyond::f2),
    ("F3", friction_laws::f3),
    ("F4", beyond::f4),
];

/// The names of all rows, in order.
pub fn ids() -> impl Iterator<Item = &'static str> {
    ROWS.iter().map(|row| row.0)
}

/// Measures every row of which `wanted` holds, in order. `progress` is told the number of rows done and of all that are wanted.
///
/// # Errors
/// Those of the pipeline: a project that is not a whole design.
pub fn claims(
    project: &Project,
    world: &dyn World,
    wanted: &dyn Fn(&str) -> bool,
    progress: &dyn Fn(usize, usize),
) -> Result<Vec<Claim>, PipelineError> {
    let bench = Bench::new(project, world)?;
    let rows: Vec<Row> = ROWS.iter().filter(|row| wanted(row.0)).map(|row| row.1).collect();
    let measured = |(done, row): (usize, &Row)| {
        progress(done, rows.len());
        row(&bench)
    };
    rows.iter().enumerate().map(measured).collect()
}
