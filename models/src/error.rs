//! What can be wrong with a mechanism.

use std::borrow::Cow;

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
    #[error("{parameter} is {value}: it {allowed}")]
    Parameter {
        /// Which parameter, with its path.
        parameter: String,
        /// Its value.
        value: f64,
        /// What is required of it, as a phrase that follows "it": "must be above 0".
        allowed: Cow<'static, str>,
    },
    /// The structure is described neither as a beam nor as lumped inertias.
    #[error("the structure is missing: give a beam, lumped inertias, or both")]
    NoStructure,
    /// No power law passes through an element's three cross sections.
    #[error(
        "no power law fits the cross sections of the element from {from_m} m to {to_m} m: use quadrature"
    )]
    PowerLaw {
        /// Near end, m.
        from_m: f64,
        /// Far end, m.
        to_m: f64,
    },
    /// The structure must be held where it has no node.
    #[error("no node lies at the pivot: choose a mesh with one")]
    NoHubNode,
    /// A stiffness matrix that resists a motion it should leave free.
    #[error("the stiffness matrix resists rigid {motion}: K r is {relative:.1e} of K's norm, not zero")]
    NotFree {
        /// Heave or pitch.
        motion: &'static str,
        /// `norm(K r) / (norm(K) norm(r))`.
        relative: f64,
    },
    /// A file of matrices that cannot be read.
    #[error("line {line}: {what}")]
    Import {
        /// Line, from 1.
        line: usize,
        /// What is wrong there.
        what: String,
    },
    /// A matrix operation failed.
    #[error(transparent)]
    Linalg(#[from] counterpoise_lti::linalg::Error),
    /// A linear-systems operation failed.
    #[error(transparent)]
    Lti(#[from] counterpoise_lti::Error),
}
