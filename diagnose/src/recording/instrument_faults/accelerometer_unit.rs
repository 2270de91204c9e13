//! The accelerometer's gain from the torque balance: a column in g or with a swapped sign scales the weight accordingly.

use crate::tolerance::recording::{HEAVE_FACTOR_DOUBT, HEAVE_FACTOR_REACH, HEAVE_UNIT_FACTORS, SMOOTHING_S};
use counterpoise_models::Parameters;
use counterpoise_recordings::{Channel, Recording};

use super::regression::regress;
use crate::machine::SteadyDrive;
use crate::recording::series::{derivative, deviation, low_pass};

/// Returns the gain of the accelerometer's column if it is that of a unit or a sign, with its relative uncertainty:
///
/// ```text
///     N K_t i = b0 + b1 hub_rate' + b2 rel + b3 sign(rel) + mu / gain x platform_accel
/// ```
pub(super) fn estimate_gain(base: &Parameters, r: &Recording) -> Option<(f64, f64)> {
    let moment = base.lumped.as_ref()?.out_of_balance_kg_m;
    let half = (SMOOTHING_S / r.sample_period_s).round().max(1.0) as usize;
    let ready = |series: &[f64]| low_pass(series, half);
    let hub = ready(r.samples(Channel::HubRate)?);
    let heave = ready(r.samples(Channel::PlatformAccel)?);
    let platform = r.samples(Channel::PlatformRate).map_or_else(|| vec![0.0; hub.len()], ready);
    let relative: Vec<f64> = hub.iter().zip(&platform).map(|(h, p)| h - p).collect();
    let torque: Vec<f64> =
        ready(r.samples(Channel::Control)?).iter().zip(&relative).map(|(u, w)| drive(base, *u, *w)).collect();
    let acceleration = derivative(&hub, r.sample_period_s);
    let turning = derivative(&platform, r.sample_period_s);
    let size = 0.1 * deviation(&relative);
    let dry: Vec<f64> = relative.iter().map(|w| (w / size).tanh()).collect();
    let one = vec![1.0; hub.len()];
    let mut columns: Vec<&[f64]> = vec![&heave, &one, &acceleration, &relative, &dry];
    columns.extend((deviation(&turning) > 0.0).then_some(turning.as_slice()));
    let found = regress(&columns, &torque)?;
    let (value, doubt) = (moment / found.value[0], (found.doubt[0] / found.value[0]).abs());
    let near = |known: &f64| (1.0 / HEAVE_FACTOR_REACH..HEAVE_FACTOR_REACH).contains(&(value.abs() / known));
    let known = HEAVE_UNIT_FACTORS.into_iter().find(near)?.copysign(value);
    (known != 1.0 && doubt < HEAVE_FACTOR_DOUBT).then_some((known, doubt))
}

/// Returns the motor's torque at the hub under a constant control, N m.
fn drive(p: &Parameters, control_v: f64, relative_rad_s: f64) -> f64 {
    let drive = SteadyDrive::of(p);
    let back = drive.back_emf * p.gearbox.ratio * relative_rad_s;
    p.gearbox.ratio * p.motor.torque_constant_nm_a * (drive.gain * control_v - back) / drive.loss
}
