//! The plant that the project describes, and its linearisation.

use counterpoise_models::plant::{Angles, LinearPlant, Plant};
use counterpoise_models::structure::{FeModel, Fitted, Structure, lumped, pinned, with_derived_lumped};
use counterpoise_models::{Configuration, Parameters, PointMass};

use crate::PipelineError;
use counterpoise_project::Project;
use counterpoise_project::resolve::import::ImportedStructure;
use counterpoise_project::resolve::model::StructureChoice;

/// The plant, configured, with its linearisation.
#[derive(Debug, Clone)]
pub struct Modelled {
    /// Parameters with the configuration applied and the lumped structure derived where it is not given.
    pub parameters: Parameters,
    /// The nonlinear plant.
    pub plant: Plant,
    /// Its linearisation where it stands.
    pub linear: LinearPlant,
}

/// Builds the plant in the project's configuration and linearises it at the project's operating point.
///
/// # Errors
/// A configuration that does not exist, and parameters that make no mechanism.
pub fn model(project: &Project) -> Result<Modelled, PipelineError> {
    let choice = &project.model;
    let (parameters, plant) = match choice.structure {
        StructureChoice::Lumped => {
            let parameters = lumped_parameters(project)?;
            (parameters.clone(), Plant::lumped(&parameters)?)
        }
        StructureChoice::Beam | StructureChoice::Import => {
            let (fe, ratios) = finite_elements(project, choice.structure)?;
            let body = pinned(&fe, ratios, choice.modes)?.body;
            (project.plant.clone(), Plant::with_body(&project.plant, body)?)
        }
    };
    let equilibrium = plant.equilibrium(&choice.operating_point);
    let linear = plant.linearise(&equilibrium, choice.friction, Angles::Drop)?;
    Ok(Modelled { parameters, plant, linear })
}

/// Why the motor alone cannot hold the plant where it stands, if it cannot: the drive that the weight takes is beyond what the control's
/// limit allows. Friction is left out.
pub fn cannot_hold(modelled: &Modelled) -> Option<PipelineError> {
    let p = &modelled.parameters;
    let limit_v = p.amplifier.drive_v(p.amplifier.input_limit_v.min(CONVERTER_RANGE_V), &p.motor).abs();
    let needed_v = modelled.linear.equilibrium.drive_v.abs();
    let moment_kg_m = modelled.plant.body().out_of_balance_kg_m;
    (needed_v > limit_v).then_some(PipelineError::CannotHold { moment_kg_m, needed_v, limit_v })
}

/// Volts of the output converter beyond which the control is limited: the converter's own range.
pub(crate) const CONVERTER_RANGE_V: f64 = 10.0;

/// The two inertias as given, or derived from the beam, or from the imported matrices; what is fitted added.
fn lumped_parameters(project: &Project) -> Result<Parameters, PipelineError> {
    let choice = &project.model;
    if project.plant.lumped.is_none() && project.plant.beam.is_none() && project.import.is_some() {
        let (fe, ratios) = finite_elements(project, StructureChoice::Import)?;
        let derived = lumped(&fe, ratios)?;
        return Ok(Parameters { lumped: Some(derived), ..project.plant.clone() });
    }
    let whole = with_derived_lumped(&project.plant, &choice.elements)?;
    let fitted = configured(project)?.map(|c| whole.configured(c)).transpose()?;
    Ok(fitted.unwrap_or(whole))
}

/// The finite elements of the project's beam or of its imported matrices, with what the configuration fits to them, and the
/// damping ratios that hold where they have no damping matrix.
///
/// # Errors
/// A configuration that does not exist, and a structure that is missing or makes no model.
pub fn finite_elements(project: &Project, of: StructureChoice) -> Result<(FeModel, &[f64]), PipelineError> {
    let configuration = configured(project)?;
    if let (StructureChoice::Import, Some(import)) = (of, &project.import) {
        let content = import.content.as_ref().ok_or(counterpoise_models::Error::NoStructure)?;
        let fe = content.structure(&fitted(project, import, configuration)?)?;
        return Ok((fe, &import.modal_damping));
    }
    let structure = Structure::new(&project.plant, configuration)?;
    let ratios = project.plant.beam.as_ref().map_or(&[] as &[f64], |beam| &beam.modal_damping);
    Ok((structure.fe(&project.model.elements)?, ratios))
}

/// Which finite elements a project has: those that its model takes, else its beam's, else imported ones.
pub fn finite_elements_of(project: &Project) -> Option<StructureChoice> {
    let (beam, import) = (project.plant.beam.is_some(), project.import.is_some());
    match (project.model.structure, beam, import) {
        (StructureChoice::Import, _, true) | (_, false, true) => Some(StructureChoice::Import),
        (_, true, _) => Some(StructureChoice::Beam),
        _ => None,
    }
}

/// What a configuration fits to imported matrices.
fn fitted(
    project: &Project,
    import: &ImportedStructure,
    configuration: Option<&Configuration>,
) -> Result<Fitted, PipelineError> {
    let mut out = Fitted::default();
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

fn configured(project: &Project) -> Result<Option<&Configuration>, PipelineError> {
    project.model.configuration.as_deref().map(|name| configuration(project, name)).transpose()
}

fn configuration<'a>(project: &'a Project, name: &str) -> Result<&'a Configuration, PipelineError> {
    let all = &project.plant.configurations;
    all.iter().find(|c| c.name == name).ok_or_else(|| {
        let known: Vec<&str> = all.iter().map(|c| c.name.as_str()).collect();
        PipelineError::Configuration { name: name.to_owned(), known: known.join(", ") }
    })
}
