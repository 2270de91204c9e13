//! The plant that the project describes, and its linearisation.

use std::ops::ControlFlow;

use counterpoise_linalg::sparse::StageProgress;
use counterpoise_models::plant::{Angles, Equilibrium, FrictionLinearisation, LinearPlant, Plant};
use counterpoise_models::structure::{
    AttachedMasses, Condensation, ConfiguredStructure, FeModel, pinned_modes, reduce_to_lumped,
    with_derived_lumped,
};
use counterpoise_models::{CONVERTER_RANGE_V, Configuration, Parameters, PointMass};
use counterpoise_pool::{Pool, Serial};

use crate::PipelineError;
use crate::configuration::{apply_configuration, named_configuration};
use counterpoise_project::Project;
use counterpoise_project::resolve::import::ImportedStructure;
use counterpoise_project::resolve::model::StructureChoice;

/// The plant, configured, with its linearisation.
#[derive(Debug, Clone)]
pub struct PlantModel {
    /// Parameters with the configuration applied and the lumped structure derived if it is not given.
    pub parameters: Parameters,
    /// The nonlinear plant.
    pub plant: Plant,
    /// Linearisation where it stands.
    pub linear: LinearPlant,
    /// Linearisation there with the rate of what the loop's sensor measures in place of the position, for the inner loop of a
    /// cascade; `None` if the sensor measures a rate.
    pub rate: Option<LinearPlant>,
    /// The finite elements that it was made from, if it was.
    pub elements: Option<FeModel>,
}

/// Builds the plant in the project's configuration and linearises it at the project's operating point.
///
/// # Errors
/// A configuration that does not exist, and parameters that make no mechanism.
pub fn build_plant_model(project: &Project) -> Result<PlantModel, PipelineError> {
    model_watched(project, &Serial)
}

/// Does the same as [`build_plant_model`], tells `pool` how far a large structure is, and stops if it asks to.
///
/// # Errors
/// As for [`build_plant_model`].
pub fn model_watched(project: &Project, pool: &dyn Pool) -> Result<PlantModel, PipelineError> {
    let choice = &project.model;
    let (parameters, plant, elements) = match choice.structure {
        StructureChoice::Lumped => {
            let (parameters, elements) = lumped_parameters(project, pool)?;
            (parameters.clone(), Plant::from_lumped(&parameters)?, elements)
        }
        StructureChoice::Beam | StructureChoice::Import => {
            let (fe, ratios) = finite_elements_watched(project, choice.structure, pool)?;
            let body = pinned_modes(&fe, ratios, choice.modes)?.body;
            (project.plant.clone(), Plant::with_body(&project.plant, body)?, Some(fe))
        }
    };
    let equilibrium = plant.equilibrium(&choice.operating_point);
    let linear = plant.linearise(&equilibrium, choice.friction, plant.angles())?;
    let rate = of_rate(&plant, &equilibrium, choice.friction)?;
    Ok(PlantModel { parameters, plant, linear, rate, elements })
}

/// Returns the linear plant whose measured output is the rate of the measured position; `None` if a rate is measured.
pub(crate) fn of_rate(
    plant: &Plant,
    equilibrium: &Equilibrium,
    friction: FrictionLinearisation,
) -> Result<Option<LinearPlant>, PipelineError> {
    let Some(rate) = plant.parameters().sensors.measured.rate() else { return Ok(None) };
    let mut parameters = plant.parameters().clone();
    parameters.sensors.measured = rate;
    let moving = Plant::with_whole_body(&parameters, plant.body().clone())?;
    Ok(Some(moving.linearise(equilibrium, friction, Angles::Drop)?))
}

/// Returns why the motor alone cannot hold the plant where it stands, if it cannot: the drive that the weight takes is beyond what the
/// control's limit allows. Friction is left out.
pub fn cannot_hold(modelled: &PlantModel) -> Option<PipelineError> {
    if let Some(beyond) = cannot_carry(modelled) {
        return Some(beyond);
    }
    let p = &modelled.parameters;
    let limit_v = p.amplifier.drive_v(p.amplifier.input_limit_v.min(CONVERTER_RANGE_V), &p.motor).abs();
    let needed_v = modelled.linear.equilibrium.drive_v.abs();
    let moment_kg_m = modelled.plant.body().out_of_balance_kg_m;
    (needed_v > limit_v).then_some(PipelineError::CannotHold { moment_kg_m, needed_v, limit_v })
}

/// Why the drive cannot carry the weight at any control, if it cannot.
pub(crate) fn cannot_carry(modelled: &PlantModel) -> Option<PipelineError> {
    let (p, at) = (&modelled.parameters, &modelled.linear.equilibrium);
    let needed_nm = (p.gearbox.ratio * p.motor.torque_constant_nm_a * at.current_a).abs();
    let moment_kg_m = modelled.plant.body().out_of_balance_kg_m;
    let largest_nm = p.largest_hold_nm();
    let is_carried = needed_nm < largest_nm && at.control_v.is_finite();
    (!is_carried).then_some(PipelineError::CannotCarry { moment_kg_m, needed_nm, largest_nm })
}

/// Returns the mechanism in the project's configuration with two inertias: as given, or derived from the beam or from the imported matrices.
///
/// # Errors
/// A configuration that does not exist, and a structure that is missing or makes no mechanism.
pub(crate) fn two_inertias(project: &Project) -> Result<Parameters, PipelineError> {
    Ok(lumped_parameters(project, &Serial)?.0)
}

/// Returns the two inertias as given, or derived from the beam, or from the imported matrices; what is fitted
/// added.
fn lumped_parameters(
    project: &Project,
    pool: &dyn Pool,
) -> Result<(Parameters, Option<FeModel>), PipelineError> {
    let choice = &project.model;
    if project.plant.lumped.is_none() && project.plant.beam.is_none() && project.import.is_some() {
        let (fe, ratios) = finite_elements_watched(project, StructureChoice::Import, pool)?;
        let derived = reduce_to_lumped(&fe, ratios)?;
        return Ok((Parameters { lumped: Some(derived), ..project.plant.clone() }, Some(fe)));
    }
    let whole = with_derived_lumped(&project.plant, &choice.elements)?;
    Ok((apply_configuration(project, &whole)?, None))
}

/// Returns the finite elements of the project's beam or of its imported matrices, with what the configuration fits to them,
/// and the damping ratios that hold where they have no damping matrix.
///
/// # Errors
/// A configuration that does not exist, and a structure that is missing or makes no model.
pub fn finite_elements(project: &Project, of: StructureChoice) -> Result<(FeModel, &[f64]), PipelineError> {
    finite_elements_watched(project, of, &Serial)
}

/// Does the same as [`finite_elements`], tells `pool` how far a large structure is, and stops if it asks to.
///
/// # Errors
/// As for [`finite_elements`].
pub fn finite_elements_watched<'a>(
    project: &'a Project,
    of: StructureChoice,
    pool: &dyn Pool,
) -> Result<(FeModel, &'a [f64]), PipelineError> {
    let configuration = named_configuration(project)?;
    if let (StructureChoice::Import, Some(import)) = (of, &project.import) {
        let content = import.content.as_ref().ok_or(counterpoise_models::Error::NoStructure)?;
        let mut watch = |at: StageProgress| {
            pool.progress(at.stage, at.done.min(at.of.saturating_sub(1)), at.of);
            if pool.is_cancelled() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let fitted = fitted_parts(project, import, configuration)?;
        let wanted = Condensation {
            modes: project.model.modes,
            shapes: import.shapes,
            damping_ratio: import.modal_damping.first().copied().unwrap_or(0.0),
        };
        let fe = content.structure(&fitted, &wanted, &mut watch)?;
        return Ok((fe, &import.modal_damping));
    }
    let structure = ConfiguredStructure::new(&project.plant, configuration)?;
    let ratios = project.plant.beam.as_ref().map_or(&[] as &[f64], |beam| &beam.modal_damping);
    Ok((structure.build_fe_model(&project.model.elements)?, ratios))
}

/// Returns which finite elements a project has: those that its model takes, else its beam's, else imported
/// ones.
pub fn finite_elements_of(project: &Project) -> Option<StructureChoice> {
    let (beam, import) = (project.plant.beam.is_some(), project.import.is_some());
    match (project.model.structure, beam, import) {
        (StructureChoice::Import, _, true) | (_, false, true) => Some(StructureChoice::Import),
        (_, true, _) => Some(StructureChoice::Beam),
        _ => None,
    }
}

/// Returns what a configuration fits to imported matrices.
fn fitted_parts(
    project: &Project,
    import: &ImportedStructure,
    configuration: Option<&Configuration>,
) -> Result<AttachedMasses, PipelineError> {
    let mut out = AttachedMasses::default();
    let Some(configuration) = configuration else { return Ok(out) };
    out.hub_inertia_kg_m2 = configuration.added_hub_inertia_kg_m2;
    let of_beam = project.plant.beam.iter().flat_map(|beam| &beam.masses);
    let known: Vec<&PointMass> = import.masses.iter().chain(of_beam).collect();
    for name in &configuration.masses {
        let found = known.iter().find(|mass| mass.name == *name);
        let missing = || counterpoise_models::Error::UnknownMass {
            mass: name.clone(),
            configuration: configuration.name.clone(),
        };
        out.masses.push((*found.ok_or_else(missing)?).clone());
    }
    Ok(out)
}
