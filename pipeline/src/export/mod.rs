//! The verified controller as code, with where it comes from.

mod feedback_alone;
pub mod header_words;
pub mod target_proofs;

use counterpoise_controller::PathSignal;
use counterpoise_controller::realisation::count_coefficients;
use counterpoise_controller::sensitivity::{RealisationCandidate, RealisationForm, form_candidates};
use counterpoise_export::fmi::{PlantUnit, controller_unit, plant_unit};
use counterpoise_export::signal_names;
use counterpoise_export::{
    CodeOptions, Converters, File, Numbers, Provenance, Targets, c99, compare_targets, fixed_c99, fixed_form,
    rust_crate,
};
use counterpoise_models::plant::Plant;
use counterpoise_verify::{Procedure, VerifiedController};
use sha2::{Digest, Sha256};

use crate::first_design::leaves_weights_open;
use crate::traverse_file::{FolderOfFile, traverse_project};
use crate::{PipelineError, PlantModel, World};
use counterpoise_project::Project;
use counterpoise_project::resolve::controller::RecordingController;
use counterpoise_project::resolve::design::Language;
use counterpoise_project::resolve::platform::PlatformSource;

pub use header_words::HeaderWords;

/// The code that was made, and what the project asks for and cannot have.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ExportedCode {
    /// Files of code.
    pub files: Vec<File>,
    /// The target that was left out.
    pub left_out: Vec<OmittedCode>,
}

/// Code that the project asks for and that does not exist.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OmittedCode {
    /// The code.
    pub what: String,
    /// Why there is none.
    pub why: String,
}

impl std::fmt::Display for OmittedCode {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: {}", self.what, self.why)
    }
}

impl ExportedCode {
    /// Takes what was made, or notes why there is nothing.
    fn add<E: std::fmt::Display>(&mut self, what: &str, made: Result<Vec<File>, E>) {
        match made {
            Ok(files) => self.files.extend(files),
            Err(why) => self.left_out.push(OmittedCode { what: what.to_owned(), why: why.to_string() }),
        }
    }
}

/// Returns the code in the languages that the project asks for.
///
/// Fixed point takes its formats from the verification's nonlinear runs, and may deviate from the reference by half a step
/// of the output converter, or of one of 16 bits if the project's is finer. What cannot be had (a coefficient that the target's numbers cannot hold, a controller without a
/// fixed-point form, a plant whose unit does not exist) is left out, with the reason; the rest is there.
///
/// # Errors
/// A file that the verification's experiments need, and those of the simulator.
pub fn export(
    project: &Project,
    modelled: &PlantModel,
    verified: &VerifiedController,
    words: &dyn HeaderWords,
    world: &dyn World,
) -> Result<ExportedCode, PipelineError> {
    let procedure = crate::project_procedure(project, world)?;
    export_by(&ExportTask { project, modelled, verified, procedure: &procedure }, words, world)
}

/// A verified controller whose code is written.
#[derive(Debug, Clone, Copy)]
pub struct ExportTask<'a> {
    /// The project.
    pub project: &'a Project,
    /// Its plant.
    pub modelled: &'a PlantModel,
    /// The controller.
    pub verified: &'a VerifiedController,
    /// The procedure of the verification.
    pub procedure: &'a Procedure,
}

/// Returns the code as [`export`] makes it, with the procedure of the verification at hand.
///
/// # Errors
/// Those of the simulator.
pub fn export_by(
    task: &ExportTask<'_>,
    words: &dyn HeaderWords,
    world: &dyn World,
) -> Result<ExportedCode, PipelineError> {
    let ExportTask { project, modelled, verified, procedure } = *task;
    let degraded = feedback_alone::verify_feedback_alone(task);
    let feedback_alone = words.describe_feedback_alone(degraded.as_ref());
    let origin = Provenance { feedback_alone, ..provenance(project, verified, words, world) };
    let options = &project.export.options;
    let mut made = ExportedCode::default();
    for language in &project.export.languages {
        match language {
            Language::C99 => made.add("C99", c99(verified, &origin, options)),
            Language::Rust => made.add("Rust", rust_crate(verified, &origin, options)),
            Language::Fixed => {
                let allowed_v = half_step_v(&modelled.plant);
                let code = fixed_form(verified, &modelled.plant, procedure, allowed_v)?
                    .map(|fixed| fixed_c99(verified, &fixed, &origin, &format!("{}_fixed", options.name)));
                match code {
                    Ok(files) => made.add("C99 in fixed point", files),
                    refused => made.add("C99 in fixed point", refused.map(|_| Vec::new())),
                }
            }
            Language::Fmi => units(&mut made, &modelled.plant, verified, &origin, options),
        }
    }
    made.files = signal_names::with_loop_names(project.plant.controlled_quantity(), made.files);
    Ok(made)
}

/// Returns the controller in double, single and fixed point, side by side in the verification's nonlinear
/// runs.
///
/// # Errors
/// Those of the simulator.
pub fn run_targets(
    modelled: &PlantModel,
    verified: &VerifiedController,
    procedure: &Procedure,
) -> Result<Targets, PipelineError> {
    Ok(compare_targets(verified, &modelled.plant, procedure, half_step_v(&modelled.plant))?)
}

/// The code of a controller in some numbers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TargetCode {
    /// C99 or Rust.
    pub language: Language,
    /// The numbers.
    pub numbers: Numbers,
    /// The prefix of every name of the code.
    pub name: String,
    /// Number of readings that it takes.
    pub readings: usize,
    /// Code and self test.
    pub files: Vec<File>,
}

/// Returns the code in every language and every kind of numbers that the controller exists in, whatever the project asks
/// for: to run it beside its model, and to count its cost.
///
/// # Errors
/// A name that no code can have.
pub fn every_target(
    project: &Project,
    verified: &VerifiedController,
    compared: &Targets,
    words: &dyn HeaderWords,
    world: &dyn World,
) -> Result<Vec<TargetCode>, PipelineError> {
    let origin = provenance(project, verified, words, world);
    let name = project.export.options.name.clone();
    let readings = verified.controller().parts().reading_count();
    let code =
        |language, numbers, files| TargetCode { language, numbers, name: name.clone(), readings, files };
    let mut all = Vec::new();
    for (numbers, options) in
        [(Numbers::Double, CodeOptions::double(&name)), (Numbers::Single, CodeOptions::single(&name))]
    {
        // What single precision cannot hold has no form in it.
        let (Ok(c), Ok(rust)) = (c99(verified, &origin, &options), rust_crate(verified, &origin, &options))
        else {
            continue;
        };
        all.push(code(Language::C99, numbers, c));
        all.push(code(Language::Rust, numbers, rust));
    }
    if let Ok(fixed) = &compared.fixed {
        all.push(code(Language::C99, Numbers::Fixed, fixed_c99(verified, fixed, &origin, &name)?));
    }
    Ok(all)
}

/// The sensitivity of each path's coefficients: the forms that it could have, and the one that it has.
#[derive(Debug, Clone, PartialEq)]
pub struct PathForms {
    /// Name of the path.
    pub path: String,
    /// Signals that it reads.
    pub inputs: Vec<PathSignal>,
    /// Modal and balanced.
    pub candidates: Vec<RealisationCandidate>,
    /// The form of the verified controller.
    pub chosen: RealisationForm,
}

/// Returns the forms of each path that has states.
///
/// # Errors
/// Those of the realisation.
pub fn path_forms(verified: &VerifiedController) -> Result<Vec<PathForms>, PipelineError> {
    let paths = verified.controller().parts().paths.iter().filter(|path| path.system.order() > 0);
    let of = |path: &counterpoise_controller::Path| {
        let candidates = form_candidates(&path.system).map_err(counterpoise_synth::Error::from)?;
        let count = count_coefficients(&path.system);
        // A form is known by its number of coefficients: few in blocks, all of them in a full matrix.
        let nearest = candidates.iter().min_by_key(|candidate| candidate.coefficients.abs_diff(count));
        let chosen = nearest.map_or(RealisationForm::Modal, |candidate| candidate.form);
        Ok(PathForms { path: path.name.clone(), inputs: path.inputs.clone(), candidates, chosen })
    };
    paths.map(of).collect()
}

/// Returns half a step of the output converter, V. A converter that the project leaves ideal counts as one of
/// [`FINEST_CONVERTER_BITS`] bits: code in fixed point is for targets that have a real one.
pub(crate) fn half_step_v(plant: &Plant) -> f64 {
    let bits = plant.parameters().interface.output_bits.min(FINEST_CONVERTER_BITS);
    CONVERTER_SPAN_V / 2.0 / f64::from(bits).exp2()
}

/// Range of the output converter, V.
const CONVERTER_SPAN_V: f64 = 20.0;
/// Bits of the finest converter whose steps the code in fixed point keeps to: those of [`counterpoise_export::Converters`]'
/// default, and the most that the converters of drives have. With more, sums of 32 bits have no room left.
const FINEST_CONVERTER_BITS: u32 = 16;

/// The units of the controller and of the plant that it was verified on.
fn units(
    made: &mut ExportedCode,
    plant: &Plant,
    verified: &VerifiedController,
    origin: &Provenance,
    options: &CodeOptions,
) {
    let named = |ending: &str| format!("{}_{ending}", options.name);
    let controller = CodeOptions { name: named("unit"), ..options.clone() };
    made.add("FMI unit of the controller", controller_unit(verified, origin, &controller));
    made.add("FMI unit of the plant", plant_unit(PlantUnit { plant, name: &named("plant") }, origin));
}

/// Returns the hash of the project as it was resolved, with the content of every file that it names: the same for two projects
/// that mean the same. A file that cannot be read counts by its name alone.
pub fn project_hash(project: &Project, world: &dyn World) -> String {
    let mut text = project.meaning();
    if leaves_weights_open(project) {
        // What is known and what is not decides on weights that are chosen.
        text.extend(project.stated_defaults.iter().map(|key| format!("{key} is stated\n")));
    }
    if let Some(content) = project.import.as_ref().and_then(|import| import.content.as_ref()) {
        text += &format!("{content:?}");
    }
    if let Some(RecordingController::Exported(source)) = &project.recording_controller {
        text += &format!("{:?}", source.content.as_ref().map(|content| content.controller.parts()));
    }
    let mut digest = Sha256::new_with_prefix(text.as_bytes());
    let road = project.verify.as_ref().and_then(|asked| asked.road.as_ref());
    if let Some(recording) = road.and_then(PlatformSource::recording)
        && let Ok(bytes) = world.read(recording)
    {
        digest.update(Sha256::digest(&bytes));
    }
    if let Some(axis) = &project.traverse
        && let Ok(traverse) = traverse_project(axis, world)
    {
        // a traverse axis has none itself: a file that names itself is refused by the stages
        let traverse = Project { traverse: None, ..traverse };
        digest.update(project_hash(&traverse, &FolderOfFile::of(&axis.file, world)));
    }
    digest.finalize().iter().take(16).map(|byte| format!("{byte:02x}")).collect()
}

fn provenance(
    project: &Project,
    verified: &VerifiedController,
    words: &dyn HeaderWords,
    world: &dyn World,
) -> Provenance {
    Provenance {
        generator: format!("counterpoise {}", env!("CARGO_PKG_VERSION")),
        project: project.plant.name.clone(),
        project_hash: project_hash(project, world),
        loop_signals: words.describe_loop_signals(&project.plant),
        weights: project.synth.as_ref().map(|asked| words.describe_weights(asked)).unwrap_or_default(),
        verdicts: words.describe_verdicts(verified.verification()),
        feedback_alone: Vec::new(),
        converters: Converters::of(&project.plant),
    }
}
