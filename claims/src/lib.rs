//! The claims of the thesis that this studio grew from, each measured on the project's mechanism.
//!
//! In comes a project (the reference rig); out comes one [`Claim`] a row: what the thesis says, what was measured, and whether it
//! holds. Nothing is tuned for a row: every [`Criterion`] states the number of the thesis, the range that agrees with it and why it is that
//! wide. A row that differs stays, with its reason, and the reason predicts a range in which the measured value must lie.
//!
//! The source is D. K. Dholiwar, *Control of out-of-balance servo mechanism subjected to external disturbances*, PhD thesis,
//! Loughborough University, 2007.
//!
//! Each row comes with the figures that show what decided it ([`drawing`] makes them from curves).
//!
//! Modules in reading order: [`criterion`], [`drawing`], [`friction_identification`], [`tested_design`], [`beam`], [`structure`], [`designs`], [`linear_loop`], [`nonlinear_plant`], [`imbalance`], [`rejection`],
//! [`friction_laws`] (with [`explicit_solver`]), [`literature_friction`], [`test_procedures`], [`identification`], [`adaptation`], [`exported_code`], [`weights`], [`loop_charts`], [`compensation_schemes`], [`gyroscope_alignment`], [`extensions`], [`page`].

pub mod adaptation;
pub mod beam;
pub mod compensation_schemes;
pub mod criterion;
pub mod designs;
pub mod drawing;
pub mod explicit_solver;
pub mod exported_code;
pub mod extensions;
pub mod friction_identification;
pub mod friction_laws;
pub mod gyroscope_alignment;
pub mod identification;
pub mod imbalance;
pub mod linear_loop;
pub mod literature_friction;
pub mod loop_charts;
pub mod nonlinear_plant;
pub mod page;
pub mod rejection;
pub mod structure;
pub mod test_procedures;
pub mod tested_design;
mod tolerance;
pub mod weights;

pub use criterion::{Agreement, Criterion};
pub use tested_design::TestedDesign;

use std::sync::atomic::{AtomicUsize, Ordering};

use counterpoise_pipeline::{PipelineError, World};
use counterpoise_plot::Figure as Drawing;
use counterpoise_pool::map_all;
use counterpoise_project::Project;

/// A row of the table.
#[derive(Debug, Clone, PartialEq)]
pub struct Claim {
    /// C1 to C34, and F1 to F4 for what the thesis asks for beyond itself.
    pub id: &'static str,
    /// Subject of the row, in a few words.
    pub title: &'static str,
    /// Place in the thesis.
    pub source: &'static str,
    /// Statement of the thesis.
    pub says: &'static str,
    /// Value measured here.
    pub measured: String,
    /// Conditions for the row to hold; empty if it was not measured.
    pub criteria: Vec<Criterion>,
    /// Why a value outside its accepted range is as its explanation predicts; empty if every value is inside.
    pub why: String,
    /// Figures of what decided it.
    pub drawings: Vec<Drawing>,
}

/// Outcome of a claim.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ClaimOutcome {
    /// The measured values are as the thesis says.
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
        why: String,
    },
}

impl Claim {
    /// Returns a row by its name, title, place in the thesis and what the thesis says; nothing is measured yet.
    pub fn of([id, title, source, says]: [&'static str; 4]) -> Self {
        let (measured, criteria, why, drawings) = (String::new(), Vec::new(), String::new(), Vec::new());
        Self { id, title, source, says, measured, criteria, why, drawings }
    }

    /// Returns a row that this project does not allow to be measured.
    pub fn not_measured(named: [&'static str; 4], why: &'static str) -> Self {
        Self { why: why.to_owned(), ..Self::of(named) }
    }

    /// Returns how the row turned out. It holds if every criterion agrees with the thesis; it differs if every other one is as the
    /// stated explanation predicts, and fails otherwise.
    pub fn finding(&self) -> ClaimOutcome {
        let agreements: Vec<Agreement> = self.criteria.iter().map(Criterion::agreement).collect();
        if agreements.is_empty() {
            return ClaimOutcome::NotMeasured { why: self.why.clone() };
        }
        if agreements.contains(&Agreement::Disagrees) {
            return ClaimOutcome::Fails;
        }
        if agreements.contains(&Agreement::Explained) {
            return ClaimOutcome::Differs { why: self.why.clone() };
        }
        ClaimOutcome::Holds
    }
}

/// A row and what measures it.
type Row = fn(&TestedDesign<'_>) -> Result<Claim, PipelineError>;

const ROWS: [(&str, Row); 38] = [
    ("C1", beam::uniform_elements),
    ("C2", beam::tapered_elements),
    ("C3", structure::reduced_order),
    ("C4", structure::lumped_against_elements),
    ("C5", linear_loop::margins_and_step),
    ("C6", linear_loop::pitch_rejection),
    ("C7", linear_loop::heave_rejection),
    ("C8", nonlinear_plant::friction_observer),
    ("C9", designs::designs_on_two_models),
    ("C10", nonlinear_plant::other_inertia),
    ("C11", nonlinear_plant::other_friction),
    ("C12", nonlinear_plant::other_backlash),
    ("C13", imbalance::other_imbalance),
    ("C14", imbalance::redesigned_for_imbalance),
    ("C15", friction_laws::friction_laws_over_amplitude),
    ("C16", friction_laws::cost_of_friction_laws),
    ("C17", test_procedures::place_of_friction),
    ("C18", test_procedures::plant_over_amplitude),
    ("C19", identification::triangle_identification),
    ("C20", identification::amplifier_curve),
    ("C21", test_procedures::closed_loop_over_amplitude),
    ("C22", rejection::balanced_against_compensated),
    ("C23", rejection::small_amplitude_rejection),
    ("C24", adaptation::adapted_feedforward),
    ("C25", exported_code::exported_controller),
    ("C26", weights::integral_action),
    ("C27", weights::three_methods),
    ("C28", loop_charts::nyquist_and_nichols),
    ("C29", loop_charts::open_loop_analyser),
    ("C30", structure::condensed_beam),
    ("C31", imbalance::gravity_over_elevation),
    ("C32", compensation_schemes::schemes_of_the_appendix),
    ("C33", literature_friction::laws_of_the_literature),
    ("C34", gyroscope_alignment::misaligned_gyroscopes),
    ("F1", adaptation::imbalance_without_gravity),
    ("F2", extensions::tip_motion),
    ("F3", friction_laws::fitted_friction_laws),
    ("F4", extensions::inertia_and_imbalance_apart),
];

/// Returns the names of all rows, in order.
pub fn claim_ids() -> impl Iterator<Item = &'static str> {
    ROWS.iter().map(|row| row.0)
}

/// Measures every row of which `wanted` holds, in order, side by side on the processors of `world`. `progress` is told the number of rows
/// done and of all that are wanted.
///
/// # Errors
/// Those of the pipeline: a project that is not a whole design.
pub fn measure_claims(
    project: &Project,
    world: &(dyn World + Sync),
    wanted: &dyn Fn(&str) -> bool,
    progress: &(dyn Fn(usize, usize) + Sync),
) -> Result<Vec<Claim>, PipelineError> {
    let tested = TestedDesign::new(project, world)?;
    let rows: Vec<Row> = ROWS.iter().filter(|row| wanted(row.0)).map(|row| row.1).collect();
    let done = AtomicUsize::new(0);
    progress(0, rows.len());
    let found = map_all(world.pool(), rows.len(), |k| {
        let row = rows[k](&tested);
        progress(done.fetch_add(1, Ordering::Relaxed) + 1, rows.len());
        row
    });
    found.into_iter().collect()
}
