//! The `[recording_controller]` section: what was in the loop when recordings were made.

use counterpoise_controller::ProportionalIntegral;

use crate::file::field::Field;
use crate::file::visit::{Choice, Visit, choose};

/// The controller that was in the loop when recordings were made.
#[derive(Debug, Clone, PartialEq)]
pub enum RecordingController {
    /// A proportional-integral controller of the hub rate.
    ProportionalIntegral(ProportionalIntegral),
    /// The controller that the project itself designs and exports.
    Project,
}

impl RecordingController {
    /// Returns the proportional-integral controller; `None` if it is another one.
    pub fn as_proportional_integral(&self) -> Option<&ProportionalIntegral> {
        match self {
            Self::ProportionalIntegral(controller) => Some(controller),
            Self::Project => None,
        }
    }
}

/// The kinds of controller that recordings were made with.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    ProportionalIntegral,
    Project,
}

impl Choice for Kind {
    const NAMES: &'static [(&'static str, Self)] =
        &[("pi", Self::ProportionalIntegral), ("project", Self::Project)];
}

/// Returns a controller that is still to be read.
pub(crate) fn blank() -> RecordingController {
    RecordingController::ProportionalIntegral(blank_proportional_integral())
}

fn blank_proportional_integral() -> ProportionalIntegral {
    ProportionalIntegral {
        kp_v_s_rad: f64::NAN,
        ki_v_rad: f64::NAN,
        bias_v: f64::NAN,
        sample_period_s: f64::NAN,
        integral_v: 0.0,
    }
}

/// Reads or lists the controller of the recordings.
pub(crate) fn recording_controller(v: &mut dyn Visit, controller: &mut RecordingController) {
    let mut kind = match controller {
        RecordingController::ProportionalIntegral(_) => Kind::ProportionalIntegral,
        RecordingController::Project => Kind::Project,
    };
    let meaning = "controller in the loop: pi, or project for the controller that this project exports";
    choose(v, &Field::new("kind", meaning), &mut kind);
    match (kind, &mut *controller) {
        (Kind::Project, _) => *controller = RecordingController::Project,
        (Kind::ProportionalIntegral, RecordingController::ProportionalIntegral(pi)) => {
            proportional_integral(v, pi);
        }
        (Kind::ProportionalIntegral, RecordingController::Project) => {
            let mut pi = blank_proportional_integral();
            proportional_integral(v, &mut pi);
            *controller = RecordingController::ProportionalIntegral(pi);
        }
    }
}

fn proportional_integral(v: &mut dyn Visit, controller: &mut ProportionalIntegral) {
    v.number(&Field::new("kp", "proportional gain").unit("V s/rad"), &mut controller.kp_v_s_rad);
    v.number(&Field::new("ki", "integral gain").unit("V/rad").or(0.0), &mut controller.ki_v_rad);
    v.number(&Field::new("bias", "constant added to the control").unit("V").or(0.0), &mut controller.bias_v);
}
