//! What may be exported: a verified controller, or one that says it is not.

use counterpoise_controller::Controller;
use counterpoise_verify::VerifiedController;

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

    /// Returns the line of the header that says whether the controller was verified.
    pub(crate) fn line(&self) -> String {
        match self {
            ExportSource::Verified(verified) => {
                let (hold, fail, open) = verified.verification().counts();
                format!("verified: {hold} requirements hold, {fail} fail, {open} could not be judged")
            }
            ExportSource::Unverified(_) => "verified: NO. For tests and experiments only.".to_owned(),
        }
    }
}
