//! The plant that the project describes, and its linearisation.

use counterpoise_models::plant::{Angles, LinearPlant, Plant};
use counterpoise_models::structure::{Structure, with_derived_lumped};
use counterpoise_models::{Configuration, Parameters};

use super::PipelineError;
use crate::Project;
use crate::resolve::model::StructureChoice;

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
    let configuration =
        choice.configuration.as_deref().map(|name| configuration(project, name)).transpose()?;
    let (parameters, plant) = match choice.structure {
        StructureChoice::Lumped => {
            let whole = match project.plant.lumped {
                Some(_) => project.plant.clone(),
                None => with_derived_lumped(&project.plant, &choice.elements)?,
            };
            let parameters = configuration.map_or_else(|| Ok(whole.clone()), |c| whole.configured(c))?;
            (parameters.clone(), Plant::lumped(&parameters)?)
        }
        StructureChoice::Beam => {
            let structure = Structure::new(&project.plant, configuration)?;
            let body = structure.pinned(&choice.elements, choice.modes)?.body;
            (project.plant.clone(), Plant::with_body(&project.plant, body)?)
        }
    };
    let equilibrium = plant.equilibrium(&choice.operating_point);
    let linear = plant.linearise(&equilibrium, choice.friction, Angles::Drop)?;
    Ok(Modelled { parameters, plant, linear })
}

fn configuration<'a>(project: &'a Project, name: &str) -> Result<&'a Configuration, PipelineError> {
    let all = &project.plant.configurations;
    all.iter().find(|c| c.name == name).ok_or_else(|| {
        let known: Vec<&str> = all.iter().map(|c| c.name.as_str()).collect();
        PipelineError::Configuration { name: name.to_owned(), known: known.join(", ") }
    })
}
