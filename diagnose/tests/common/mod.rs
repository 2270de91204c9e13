//! Helpers that the tests of the diagnosis share.

use counterpoise_controller::ProportionalIntegral;

/// The controller of the reference rig's recordings, with the bias (V) that holds the weight.
pub fn controller(bias_v: f64) -> ProportionalIntegral {
    ProportionalIntegral {
        kp_v_s_rad: 18.0,
        ki_v_rad: 80.0,
        bias_v,
        sample_period_s: 1e-3,
        ..ProportionalIntegral::default()
    }
}
