//! What can be wrong with a mechanism.

/// Every way in which a mechanism can be refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A configuration fits a mass that the beam does not have.
    #[error("configuration \"{configuration}\" fits mass \"{mass}\", which the beam does not have")]
    UnknownMass {
        /// Name of the mass.
        mass: String,
        /// Name of the configuration.
        configuration: String,
    },
    /// A parameter outside the range in which the mechanism makes sense.
    #[error("{parameter} = {value}: {allowed}")]
    Parameter {
        /// Which parameter, with its path.
        parameter: String,
        /// Its value.
        value: f64,
        /// What is allowed.
        allowed: &'static str,
    },
    /// The structure is described neither as a beam nor as lumped inertias.
    #[error("the structure is missing: give a beam, lumped inertias, or both")]
    NoStructure,
    /// A linear-systems operation failed.
    #[error(transparent)]
    Lti(#[from] counterpoise_lti::Error),
}
