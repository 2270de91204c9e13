//! The boundary of the region of stability.

use crate::mat::C64;
use crate::sylvester::Kind;

/// The boundary of the region of stability.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Boundary {
    /// The imaginary axis, of continuous time.
    ImaginaryAxis,
    /// The unit circle, of discrete time.
    UnitCircle,
}

impl Boundary {
    /// Returns how far an eigenvalue lies beyond the boundary; negative for a stable one.
    pub fn excess(self, eigenvalue: C64) -> f64 {
        match self {
            Self::ImaginaryAxis => eigenvalue.re,
            Self::UnitCircle => eigenvalue.norm() - 1.0,
        }
    }

    /// Returns the kind of equation whose solutions end there.
    pub(crate) fn kind(self) -> Kind {
        match self {
            Self::ImaginaryAxis => Kind::Continuous,
            Self::UnitCircle => Kind::Discrete,
        }
    }

    /// Returns the unit number that points across the boundary beside an eigenvalue, away from the stable ones.
    pub(crate) fn outward_direction(self, eigenvalue: C64) -> C64 {
        match self {
            Self::ImaginaryAxis => C64::new(1.0, 0.0),
            Self::UnitCircle => eigenvalue / eigenvalue.norm(),
        }
    }
}

impl From<Kind> for Boundary {
    fn from(kind: Kind) -> Self {
        match kind {
            Kind::Continuous => Self::ImaginaryAxis,
            Kind::Discrete => Self::UnitCircle,
        }
    }
}
