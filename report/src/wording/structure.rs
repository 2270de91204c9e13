//! The diagnosis of a structure from its natural frequencies, in words.

use counterpoise_models::structure::Support;
use counterpoise_pipeline::recordings::structure_hypotheses::StructureVerdict;

/// Returns the name of a verdict, as the glossary has it. The JSON result keeps its own words.
pub fn structure_verdict_name(verdict: StructureVerdict) -> &'static str {
    match verdict {
        StructureVerdict::Consistent => "consistent",
        StructureVerdict::Named => "identified",
        StructureVerdict::Incomplete => "incomplete",
        StructureVerdict::Ambiguous => "ambiguous",
        StructureVerdict::Unknown => "unidentified",
    }
}

/// Describes how the structure was supported when its modes were measured.
pub fn describe_support(support: Support) -> &'static str {
    match support {
        Support::Free => "free",
        Support::Pinned => "pinned at its hub",
        Support::Clamped => "clamped at its hub",
    }
}
