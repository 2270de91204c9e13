//! Why a mechanism is refused.

use std::borrow::Cow;

/// Every way in which a mechanism can be refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A configuration fits a mass that the beam does not have.
    #[error("configuration \"{configuration}\" uses mass \"{mass}\", but the beam has no mass of that name")]
    UnknownMass {
        /// Name of the mass.
        mass: String,
        /// Name of the configuration.
        configuration: String,
    },
    /// A parameter outside the range in which the mechanism makes sense.
    #[error("{parameter} is {value}: it {allowed}")]
    Parameter {
        /// The parameter, with its path.
        parameter: String,
        /// Value.
        value: f64,
        /// The requirement on it, as a phrase that follows "it": "must be above 0".
        allowed: Cow<'static, str>,
    },
    /// The structure is described neither as a beam nor as lumped inertias.
    #[error("the structure is missing: give a beam, lumped inertias, or both")]
    NoStructure,
    /// No power law passes through an element's three cross sections.
    #[error(
        "no power law passes through the cross sections of the element from {from_m} m to {to_m} m, because the middle one is not between the ends: use integration by quadrature"
    )]
    PowerLaw {
        /// Near end, m.
        from_m: f64,
        /// Far end, m.
        to_m: f64,
    },
    /// The structure must be held where it has no node.
    #[error("the structure has no node at the pivot, where it must be held: choose a mesh with a node there")]
    NoHubNode,
    /// A stiffness matrix that resists a motion it should leave free.
    #[error(
        "the stiffness matrix resists rigid {motion}: the product of K and that motion is {relative:.1e} of the norm of K, but must be 0 within rounding"
    )]
    NotFree {
        /// Heave or pitch.
        motion: &'static str,
        /// `norm(K r) / (norm(K) norm(r))`.
        relative: f64,
    },
    /// A stiffness matrix that leaves motions free besides heave and pitch.
    #[error(
        "the stiffness matrix leaves more motions free than heave and pitch ({support} still moves without stress): hold the other directions in the finite-element package before the matrices are written"
    )]
    MovesFreely {
        /// The support that was analysed.
        support: &'static str,
    },
    /// A file of matrices that cannot be read.
    #[error("line {line}: {what}")]
    Import {
        /// Line, from 1.
        line: usize,
        /// The problem there.
        what: String,
    },
    /// A matrix operation failed.
    #[error(transparent)]
    Linalg(#[from] counterpoise_linalg::Error),
    /// A linear-systems operation failed.
    #[error(transparent)]
    Lti(#[from] counterpoise_lti::Error),
}
