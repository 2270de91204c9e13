//! The diagnosis of a structure from its natural frequencies, in words.

use counterpoise_models::structure::Support;

/// Describes how the structure was supported when its modes were measured.
pub fn describe_support(support: Support) -> &'static str {
    match support {
        Support::Free => "free",
        Support::Pinned => "pinned at its hub",
        Support::Clamped => "clamped at its hub",
    }
}
