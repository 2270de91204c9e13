//! The `[measured]` section: natural frequencies of the real structure.

use counterpoise_models::structure::Support;

use crate::file::field::{Field, NumberRange};
use crate::file::visit::{Count, NamedChoice, Visit, choose};

/// Natural frequencies measured on the real structure.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredModes {
    /// Flexible modes in rising order, Hz.
    pub modes_hz: Vec<f64>,
    /// Support of the structure.
    pub support: Support,
}

impl NamedChoice for Support {
    const NAMES: &'static [(&'static str, Self)] =
        &[("free", Self::Free), ("pinned", Self::Pinned), ("clamped", Self::Clamped)];
}

/// Still to be read.
pub(crate) fn blank_modes() -> MeasuredModes {
    MeasuredModes { modes_hz: Vec::new(), support: Support::Free }
}

/// Reads or lists the measurement.
pub(crate) fn measured_modes(v: &mut dyn Visit, measured: &mut MeasuredModes) {
    let modes = Field::new("modes", "natural frequencies of the flexible modes, in rising order").unit("Hz");
    v.numbers(&modes.limit(NumberRange::Above(0.0)), Count::AtLeastOne, &mut measured.modes_hz);
    let rising = measured.modes_hz.windows(2).all(|two| two[0] < two[1]);
    if !rising {
        v.complain("modes", "must rise from mode to mode", None);
    }
    let support = Field::new("support", "how the structure was held while it was measured");
    choose(v, &support.or_text("free"), &mut measured.support);
}
