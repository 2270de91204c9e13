//! The structure of a mechanism in one of its configurations.

use super::damping::{modal_with_stiffness, rayleigh_coefficients, rayleigh_damping};
use super::fe::{AttachedMasses, FeModel, FeOptions};
use super::modes::{Support, undamped_modes};
use super::reduction::{PinnedStructure, pinned_modes, reduce_to_lumped};
use crate::Error;
use crate::parameters::{Beam, Configuration, Parameters, StructuralDamping};

/// A mechanism's beam with what a configuration fits to it.
#[derive(Debug, Clone, PartialEq)]
pub struct ConfiguredStructure {
    /// The beam.
    pub beam: Beam,
    /// Masses that are fitted to it.
    pub fitted: AttachedMasses,
}

impl ConfiguredStructure {
    /// Returns the structure of a mechanism; `configuration` is `None` if nothing is fitted.
    ///
    /// # Errors
    /// [`Error::NoStructure`] if the mechanism has no beam, [`Error::UnknownMass`] for a mass that it does not have.
    pub fn new(parameters: &Parameters, configuration: Option<&Configuration>) -> Result<Self, Error> {
        let beam = parameters.beam.clone().ok_or(Error::NoStructure)?;
        let mut fitted = AttachedMasses::default();
        if let Some(configuration) = configuration {
            fitted.hub_inertia_kg_m2 = configuration.added_hub_inertia_kg_m2;
            for name in &configuration.masses {
                let found = beam.masses.iter().find(|m| m.name == *name);
                fitted.masses.push(found.cloned().ok_or_else(|| Error::UnknownMass {
                    mass: name.clone(),
                    configuration: configuration.name.clone(),
                })?);
            }
        }
        Ok(Self { beam, fitted })
    }

    /// Returns its finite-element model, with a damping matrix if its damping is not modal with the last ratio for all above.
    ///
    /// # Errors
    /// As for [`FeModel::beam`], [`rayleigh_coefficients`] and [`undamped_modes`].
    pub fn build_fe_model(&self, options: &FeOptions) -> Result<FeModel, Error> {
        let mut model = FeModel::beam(&self.beam, &self.fitted, options)?;
        model.C = match self.beam.damping {
            StructuralDamping::Modal => None,
            StructuralDamping::ModalWithStiffness => {
                let pinned = undamped_modes(&model, Support::Pinned)?;
                Some(modal_with_stiffness(&model, &pinned, &self.beam.modal_damping))
            }
            StructuralDamping::Rayleigh { first, second } => {
                Some(rayleigh_damping(&model, rayleigh_coefficients(first.into(), second.into())?))
            }
        };
        Ok(model)
    }

    /// Returns its first `modes` flexible modes, pinned at the hub: what [`crate::Plant::with_body`] takes.
    ///
    /// # Errors
    /// As for [`FeModel::beam`] and [`pinned_modes`].
    pub fn pinned_modes(&self, options: &FeOptions, modes: usize) -> Result<PinnedStructure, Error> {
        pinned_modes(&self.build_fe_model(options)?, &self.beam.modal_damping, modes)
    }
}

/// Returns the parameters with two inertias derived from the bare beam if none are given, and as they are otherwise.
///
/// # Errors
/// [`Error::NoStructure`] if there is neither, else as for [`FeModel::beam`] and [`reduce_to_lumped`].
pub fn with_derived_lumped(parameters: &Parameters, options: &FeOptions) -> Result<Parameters, Error> {
    if parameters.lumped.is_some() {
        return Ok(parameters.clone());
    }
    let structure = ConfiguredStructure::new(parameters, None)?;
    let derived = reduce_to_lumped(&structure.build_fe_model(options)?, &structure.beam.modal_damping)?;
    Ok(Parameters { lumped: Some(derived), ..parameters.clone() })
}
