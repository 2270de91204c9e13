//! The mechanism in the configuration that the project's model names: what is fitted to it adds inertia and out-of-balance to
//! those of the file.

use counterpoise_models::{Configuration, Parameters};
use counterpoise_project::Project;

use crate::PipelineError;

/// Returns a mechanism with what the project's configuration fits to it; as it is if the project names none.
///
/// # Errors
/// A configuration, or a mass of it, that does not exist.
pub fn apply_configuration(project: &Project, bare: &Parameters) -> Result<Parameters, PipelineError> {
    let fitted = named_configuration(project)?
        .map(|configuration| bare.with_configuration(configuration))
        .transpose()?;
    Ok(fitted.unwrap_or_else(|| bare.clone()))
}

/// Returns an improved mechanism without what the project's configuration fits to it, as a project file states it.
///
/// # Errors
/// As [`apply_configuration`].
pub(crate) fn without_configuration(
    project: &Project,
    improved: &Parameters,
) -> Result<Parameters, PipelineError> {
    let (bare, fitted) = (&project.plant, apply_configuration(project, &project.plant)?);
    let mut out = improved.clone();
    if let (Some(out), Some(bare), Some(fitted)) = (&mut out.lumped, &bare.lumped, &fitted.lumped) {
        // a value that did not change keeps its digits
        let less = |improved: f64, bare: f64, fitted: f64| {
            if improved == fitted { bare } else { improved - (fitted - bare) }
        };
        out.hub_inertia_kg_m2 = less(out.hub_inertia_kg_m2, bare.hub_inertia_kg_m2, fitted.hub_inertia_kg_m2);
        out.out_of_balance_kg_m =
            less(out.out_of_balance_kg_m, bare.out_of_balance_kg_m, fitted.out_of_balance_kg_m);
    }
    Ok(out)
}

/// Returns the configuration that the project's model names.
///
/// # Errors
/// A name that no configuration has.
pub(crate) fn named_configuration(project: &Project) -> Result<Option<&Configuration>, PipelineError> {
    project.model.configuration.as_deref().map(|name| configuration(project, name)).transpose()
}

fn configuration<'a>(project: &'a Project, name: &str) -> Result<&'a Configuration, PipelineError> {
    let all = &project.plant.configurations;
    all.iter().find(|c| c.name == name).ok_or_else(|| {
        let known: Vec<&str> = all.iter().map(|c| c.name.as_str()).collect();
        PipelineError::Configuration { name: name.to_owned(), known: known.join(", ") }
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use counterpoise_models::Configuration;

    /// Returns a mechanism in a configuration that adds 40 kg m^2 to its hub.
    fn loaded_project() -> Project {
        let mut project = Project::parse(counterpoise_project::STARTER, "project.toml").unwrap().project;
        project.plant.configurations.push(Configuration {
            name: "loaded".to_owned(),
            masses: Vec::new(),
            added_hub_inertia_kg_m2: 40.0,
        });
        project.model.configuration = Some("loaded".to_owned());
        project
    }

    #[test]
    fn recordings_belong_to_the_configuration_and_the_file_to_the_bare_mechanism() {
        let project = loaded_project();
        let inertia = |plant: &Parameters| plant.lumped.as_ref().unwrap().hub_inertia_kg_m2;
        let fitted = apply_configuration(&project, &project.plant).unwrap();
        assert_eq!(inertia(&fitted), inertia(&project.plant) + 40.0);
        // nothing found: the file's own digits
        assert_eq!(without_configuration(&project, &fitted).unwrap(), project.plant);
        // an inertia that was found to be 3 kg m^2 larger is larger by that in the file, and the configuration adds its own again
        let mut improved = fitted.clone();
        improved.lumped.as_mut().unwrap().hub_inertia_kg_m2 += 3.0;
        let stated = without_configuration(&project, &improved).unwrap();
        assert!((inertia(&stated) - inertia(&project.plant) - 3.0).abs() < 1e-9);
        let again = apply_configuration(&project, &stated).unwrap();
        assert!((inertia(&again) - inertia(&improved)).abs() < 1e-9);
    }

    #[test]
    fn a_configuration_that_does_not_exist_is_refused() {
        let mut project = loaded_project();
        project.model.configuration = Some("unknown".to_owned());
        assert!(matches!(
            apply_configuration(&project, &project.plant),
            Err(PipelineError::Configuration { .. })
        ));
    }
}
