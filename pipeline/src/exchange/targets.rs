//! The controller on its targets as plain data: the loop in each kind of numbers, forms of its paths, what compilers and emulators answered.

use counterpoise_controller::sensitivity::RealisationForm;
use counterpoise_export::TargetFigures;
use counterpoise_models::ControlledQuantity;
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

use super::SystemResult;
use super::verification_data::history_name;
use crate::design::TargetStudy;
use crate::export::PathForms;
use crate::export::target_proofs::{CodeAgreement, CompiledCodeTest, CoreCost, StepCosts};
use counterpoise_verify::Model;

/// The controller in every kind of numbers.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TargetsResult {
    /// Double, single and, where it exists, fixed point.
    pub numbers: Vec<NumbersResult>,
    /// Each path in the forms that it can have.
    pub path_forms: Vec<PathFormResult>,
    /// The whole controller with every path in each form.
    pub by_form: Vec<FormResult>,
    /// Multiplications of a step.
    pub multiplications: usize,
    /// Additions of a step.
    pub additions: usize,
    /// States.
    pub states: usize,
    /// Instructions of a step by hand: two for a product, one for a sum, two for a state.
    pub instructions_by_hand: usize,
    /// Compiled code beside its model; empty unless the caller ran it.
    pub compiled: Vec<CompiledResult>,
    /// Cost on each core; empty unless the caller counted it.
    pub cores: Vec<CoreResult>,
}

/// The controller in some numbers, in the simulated loop.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NumbersResult {
    /// `double`, `single` or `fixed`.
    pub numbers: &'static str,
    /// Largest difference of the control from the reference for the same readings, predicted, V.
    pub predicted_v: f64,
    /// The same if every rounding goes the same way, V.
    pub worst_v: f64,
    /// RMS difference, predicted, V.
    pub predicted_rms_v: f64,
    /// Largest difference, measured, V.
    pub measured_v: f64,
    /// RMS difference, measured, V.
    pub measured_rms_v: f64,
    /// Each experiment.
    pub experiments: Vec<TargetRunResult>,
}

/// The closed loop with some numbers in one experiment. Errors have the unit of what the loop controls in their names: `error_rms_nm` for
/// `error_rms_rad_s` in a loop of torque.
#[derive(Debug, Clone, PartialEq)]
pub struct TargetRunResult {
    /// Quantity that the loop controls.
    pub controlled: ControlledQuantity,
    /// The experiment, by the name of its time history.
    pub experiment: String,
    /// RMS of demand less hub rate, rad/s.
    pub error_rms_rad_s: f64,
    /// Closed-loop error relative to double, dB; `None` if the loop in double has no error.
    pub cost_db: Option<f64>,
    /// Demand less hub rate, rad/s, at the controller's sample time; absent unless time histories were asked for.
    pub errors_rad_s: Vec<f64>,
}

impl Serialize for TargetRunResult {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("experiment", &self.experiment)?;
        map.serialize_entry(&self.controlled.key_of("error_rms"), &self.error_rms_rad_s)?;
        map.serialize_entry("cost_db", &self.cost_db)?;
        if !self.errors_rad_s.is_empty() {
            map.serialize_entry(&self.controlled.key_of("errors"), &self.errors_rad_s)?;
        }
        map.end()
    }
}

/// A path of the controller in one form.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PathFormResult {
    /// Name of the path.
    pub path: String,
    /// `modal` or `balanced`.
    pub form: &'static str,
    /// `true` if the exported controller has it.
    pub is_in_use: bool,
    /// Coefficients that a step multiplies by.
    pub coefficients: usize,
    /// Error of the frequency response with coefficients in single precision, predicted.
    pub predicted: f64,
    /// Error, measured.
    pub measured: f64,
    /// The path in this form.
    pub system: SystemResult,
}

/// The controller with every path in one form.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FormResult {
    /// The form.
    pub form: &'static str,
    /// Multiplications of a step.
    pub multiplications: usize,
    /// Largest difference of its control in double from the reference, V; `None` if it leaves all range.
    pub double_v: Option<f64>,
    /// The same in single precision.
    pub single_v: Option<f64>,
    /// RMS difference in single precision, V.
    pub single_rms_v: Option<f64>,
}

/// Code that was compiled and run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CompiledResult {
    /// `c` or `rust`.
    pub language: &'static str,
    /// Kind of numbers, see [`NumbersResult::numbers`].
    pub numbers: &'static str,
    /// Samples compared with its model; `None` if it was not run.
    pub samples: Option<usize>,
    /// Those that differ.
    pub wrong: Option<usize>,
    /// Why it was not run.
    pub why: Option<String>,
}

/// Cost of the code on a core.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CoreResult {
    /// Name of the core.
    pub core: &'static str,
    /// Kind of numbers, see [`NumbersResult::numbers`].
    pub numbers: &'static str,
    /// Most instructions of a step.
    pub step_instructions: u64,
    /// Most instructions of setting the out-of-balance.
    pub set_instructions: u64,
    /// Code and constants, bytes.
    pub flash_bytes: u64,
    /// State that the caller owns, bytes.
    pub state_bytes: u64,
    /// Deepest stack, bytes.
    pub stack_bytes: u64,
}

impl TargetsResult {
    /// Returns the results of a study, with the names of what the loop controls.
    pub fn of(study: &TargetStudy, controlled: ControlledQuantity) -> Self {
        let operations = study.operations;
        let finite = |value: f64| value.is_finite().then_some(value);
        let by_form = study.by_form.iter().map(|each| FormResult {
            form: each.form.name(),
            multiplications: each.multiplications,
            double_v: finite(each.double.largest_v),
            single_v: finite(each.single.largest_v),
            single_rms_v: finite(each.single.rms_v),
        });
        Self {
            numbers: study.compared.figures.iter().map(|each| NumbersResult::of(each, controlled)).collect(),
            path_forms: study.forms.iter().flat_map(path_forms).collect(),
            by_form: by_form.collect(),
            multiplications: operations.multiplications,
            additions: operations.additions,
            states: operations.states,
            instructions_by_hand: operations.instructions_by_hand(),
            compiled: Vec::new(),
            cores: Vec::new(),
        }
    }

    /// Adds what compilers and emulators answered.
    pub fn with_answers(self, proofs: &[CompiledCodeTest], costs: &StepCosts) -> Self {
        let compiled = proofs.iter().map(CompiledResult::from).collect();
        Self { compiled, cores: costs.counted.iter().map(CoreResult::from).collect(), ..self }
    }

    /// Leaves out the time histories.
    pub fn leave_histories_out(&mut self) {
        let experiments = self.numbers.iter_mut().flat_map(|numbers| &mut numbers.experiments);
        experiments.for_each(|run| run.errors_rad_s.clear());
    }
}

impl NumbersResult {
    fn of(figures: &TargetFigures, controlled: ControlledQuantity) -> Self {
        let experiments = figures.experiments.iter().map(|each| TargetRunResult {
            controlled,
            experiment: history_name(Model::Nonlinear, each.experiment),
            error_rms_rad_s: each.error_rms_rad_s,
            cost_db: each.cost_db,
            errors_rad_s: each.errors_rad_s.clone(),
        });
        Self {
            numbers: figures.numbers.name(),
            predicted_v: figures.predicted.likely_v,
            worst_v: figures.predicted.worst_v,
            predicted_rms_v: figures.predicted.rms_v,
            measured_v: figures.measured_v,
            measured_rms_v: figures.measured_rms_v,
            experiments: experiments.collect(),
        }
    }
}

fn path_forms(each: &PathForms) -> impl Iterator<Item = PathFormResult> {
    let inputs: Vec<&str> = each.inputs.iter().map(|signal| signal.name()).collect();
    each.candidates.iter().map(move |candidate| PathFormResult {
        path: each.path.clone(),
        form: if candidate.form == RealisationForm::Balanced { "balanced" } else { "modal" },
        is_in_use: candidate.form == each.chosen,
        coefficients: candidate.coefficients,
        predicted: candidate.predicted,
        measured: candidate.measured,
        system: SystemResult::new(&each.path, &candidate.system, &inputs, &["control_v"]),
    })
}

impl From<&CompiledCodeTest> for CompiledResult {
    fn from(proof: &CompiledCodeTest) -> Self {
        let (samples, wrong, why) = match &proof.answered {
            CodeAgreement::Alike { samples } => (Some(*samples), Some(0), None),
            CodeAgreement::Otherwise { samples, wrong } => (Some(*samples), Some(*wrong), None),
            CodeAgreement::NotRun(why) => (None, None, Some(why.clone())),
        };
        let language = if proof.rust { "rust" } else { "c" };
        Self { language, numbers: proof.numbers.name(), samples, wrong, why }
    }
}

impl From<&CoreCost> for CoreResult {
    fn from(each: &CoreCost) -> Self {
        let cost = each.cost;
        Self {
            core: each.core,
            numbers: each.numbers.name(),
            step_instructions: cost.step_instructions,
            set_instructions: cost.set_instructions,
            flash_bytes: cost.flash_bytes,
            state_bytes: cost.state_bytes,
            stack_bytes: cost.stack_bytes,
        }
    }
}
