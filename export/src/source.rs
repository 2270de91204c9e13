//! The source of an export: a verified controller, or one that says it is not.

use counterpoise_controller::Controller;
use counterpoise_verify::{Verification, VerifiedController};

/// A controller to be turned into code.
#[derive(Debug, Clone, Copy)]
pub enum ExportSource<'a> {
    /// The usual one: its verdicts are known.
    Verified(&'a VerifiedController),
    /// For tests and experiments; the code says so in its header.
    Unverified(&'a Controller),
}

impl<'a> From<&'a VerifiedController> for ExportSource<'a> {
    fn from(verified: &'a VerifiedController) -> Self {
        ExportSource::Verified(verified)
    }
}

impl<'a> ExportSource<'a> {
    /// Returns the controller.
    pub fn controller(&self) -> &'a Controller {
        match self {
            ExportSource::Verified(verified) => verified.controller(),
            ExportSource::Unverified(controller) => controller,
        }
    }

    /// Returns the verification that the controller passed through; `None` if it was not verified.
    pub(crate) fn verification(&self) -> Option<&'a Verification> {
        match self {
            ExportSource::Verified(verified) => Some(verified.verification()),
            ExportSource::Unverified(_) => None,
        }
    }
}
