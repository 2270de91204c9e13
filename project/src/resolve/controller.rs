//! The `[recording_controller]` section: what was in the loop when recordings were made.

use counterpoise_controller::ProportionalIntegral;

use crate::file::field::Field;
use crate::file::visit::{Choice, Visit, choose};

/// The kinds of controller that recordings were made with.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Pi,
}

impl Choice for Kind {
    const NAMES: &'static [(&'static str, Self)] = &[("pi", Self::Pi)];
}

/// A controller still to be read.
pub(crate) fn blank() -> ProportionalIntegral {
    ProportionalIntegral {
        kp_v_s_rad: f64::NAN,
        ki_v_rad: f64::NAN,
        bias_v: f64::NAN,
        sample_period_s: f64::NAN,
        integral_v: 0.0,
    }
}

/// Reads or lists the controller of the recordings.
pub(crate) fn recording_controller(v: &mut dyn Visit, controller: &mut ProportionalIntegral) {
    choose(v, &Field::new("kind", "kind of controller"), &mut Kind::Pi);
    v.number(&Field::new("kp", "proportional gain").unit("V s/rad"), &mut controller.kp_v_s_rad);
    v.number(&Field::new("ki", "integral gain").unit("V/rad").or(0.0), &mut controller.ki_v_rad);
    v.number(&Field::new("bias", "constant added to the control").unit("V").or(0.0), &mut controller.bias_v);
}
