//! The estimator of the out-of-balance in a step.

use crate::lowering::regressors::{EstimatorInputs, regressors, write_gravity_change, write_unexplained};
use crate::lowering::schedule::{self, settable_moments};
use crate::lowering::squares::squares;
use crate::lowering::{Limits, States, Writer};
use crate::program::{OnRestart, ProgramTerm, Slot};
use crate::tolerance::{LEAST_LIFT, SETTLED_SHARE, SWITCH_WIDTH};
use crate::{Estimator, Learning};

/// Writes the estimator's step.
pub(crate) fn estimate(inputs: &EstimatorInputs<'_>, states: &mut States, writer: &mut Writer) {
    let Some(estimator) = &inputs.parts.estimator else { return };
    writer.section("estimate of the out-of-balance from the control");
    match &estimator.learning {
        Learning::Gradient { step, scale } => gradient(inputs, estimator, *step, scale, writer),
        Learning::Mean { window_samples } => mean(inputs, estimator, *window_samples, writer),
        Learning::Squares { .. } => squares(inputs, estimator, states, writer),
    }
    follow(inputs, estimator, states, writer);
}

/// The normalised gradient step.
fn gradient(
    inputs: &EstimatorInputs<'_>,
    estimator: &Estimator,
    step: f64,
    scale: &[f64; 3],
    writer: &mut Writer,
) {
    let p = &inputs.layout.estimate;
    let phi = regressors(inputs, estimator, writer);
    let left = write_unexplained(inputs.control, p, &phi, writer);
    let squares: [Slot; 3] = std::array::from_fn(|i| writer.product(format!("square_{i}"), phi[i], phi[i]));
    let size = writer.local("excitation");
    let weights: Vec<ProgramTerm> = (0..3).map(|i| scale[i].powi(2) * squares[i]).collect();
    writer.sum_into(size, Some(1.0), &weights);
    let push = writer.quotient("push", left, size);
    for i in 0..3 {
        let along = writer.product(format!("along_{i}"), push, phi[i]);
        let gain = step * scale[i].powi(2);
        let next = writer.sum(format!("estimate_next_{i}"), &[1.0 * p[i], gain * along]);
        writer.copy(p[i], next);
    }
}

/// The windowed mean: `window_ends` is 1 at the end of a window and 0 else.
///
/// What is summed is the control less what the estimate explains, and what gravity's share falls short of the whole: long
/// sums of nearly equal numbers would round the same way at every sample. The divisor is kept from 0, so that fixed point
/// can prove its quotient.
fn mean(inputs: &EstimatorInputs<'_>, estimator: &Estimator, window: u32, writer: &mut Writer) {
    let (p, Some([sum, fallen, count])) = (inputs.layout.estimate[0], inputs.layout.window) else { return };
    let falls = write_gravity_change(inputs, estimator, writer);
    let lift = writer.local("lift_m_s2");
    writer.sum_into(lift, Some(estimator.gravity_m_s2), &falls);
    let explained = writer.product("explained_v", p, lift);
    let sum_now = writer.sum("sum_now_v", &[1.0 * sum, 1.0 * inputs.control, -1.0 * explained]);
    let falls: Vec<ProgramTerm> = std::iter::once(1.0 * fallen).chain(falls).collect();
    let fallen_now = writer.sum("fall_now_m_s2", &falls);
    let count_now = writer.local("count_now");
    writer.sum_into(count_now, Some(1.0), &[1.0 * count]);
    let past = writer.local("window_past");
    writer.sum_into(past, Some(1.0 - f64::from(window)), &[1.0 * count_now]);
    let ends = writer.clamp("window_ends", past, Limits::UNIT);
    let goes_on = writer.local("window_goes_on");
    writer.sum_into(goes_on, Some(1.0), &[-1.0 * ends]);
    let divisor = window_lift(fallen_now, estimator.gravity_m_s2 * f64::from(window), writer);
    let found = writer.quotient("mean_v_per_m_s2", sum_now, divisor);
    let taken = writer.product("taken_v_per_m_s2", found, ends);
    let next = writer.sum("estimate_next", &[1.0 * p, 1.0 * taken]);
    writer.copy(p, next);
    for (state, now, name) in [
        (sum, sum_now, "sum_next_v"),
        (fallen, fallen_now, "fall_next_m_s2"),
        (count, count_now, "count_next"),
    ] {
        let next = writer.product(name, now, goes_on);
        writer.copy(state, next);
    }
}

/// Gravity's share summed over a whole window, at least [`LEAST_LIFT`] of `whole`.
fn window_lift(fallen: Slot, whole: f64, writer: &mut Writer) -> Slot {
    let sum = writer.local("window_lift_m_s2");
    writer.sum_into(sum, Some(whole), &[1.0 * fallen]);
    let least = LEAST_LIFT * whole;
    writer.clamp("divisor_m_s2", sum, Limits { low: least.min(whole), high: least.max(whole) })
}

/// The out-of-balance moves to the estimate at its limited rate.
fn follow(inputs: &EstimatorInputs<'_>, estimator: &Estimator, states: &mut States, writer: &mut Writer) {
    let (parts, layout) = (inputs.parts, inputs.layout);
    let fades = matches!(estimator.learning, Learning::Mean { .. });
    let transfer = layout.transfer.filter(|_| fades);
    let before = transfer.map(|_| schedule::slow_part(writer, layout, "before"));
    let aim = writer.sum("aim_kg_m", &[1.0 / estimator.volts_per_kg_m_s2 * layout.estimate[0]]);
    let mut way = writer.sum("way_kg_m", &[1.0 * aim, -1.0 * layout.out_of_balance]);
    if estimator.hold_band_kg_m > 0.0 {
        way = match estimator.follow_samples {
            0 => {
                let inside = writer.clamp("held_way_kg_m", way, Limits::symmetric(estimator.hold_band_kg_m));
                writer.sum("way_left_kg_m", &[1.0 * way, -1.0 * inside])
            }
            _ => {
                let design_kg_m = parts.design_out_of_balance_kg_m;
                let follows = write_follow_switch(
                    &FollowedEstimate { estimator, aim, way, design_kg_m },
                    states,
                    writer,
                );
                writer.product("way_left_kg_m", way, follows)
            }
        };
    }
    if estimator.rate_limit_kg_m_s.is_finite() {
        let most = estimator.rate_limit_kg_m_s * parts.sample_period_s;
        way = writer.clamp("moved_kg_m", way, Limits::symmetric(most));
    }
    if estimator.hold_samples > 0 {
        let enabled = write_enable_switch(estimator.hold_samples, states, writer);
        way = writer.product("enabled_move_kg_m", way, enabled);
    }
    let sum = writer.sum("unbounded_kg_m", &[1.0 * layout.out_of_balance, 1.0 * way]);
    let bounded = writer.clamp("bounded_kg_m", sum, settable_moments(parts));
    writer.copy(layout.out_of_balance, bounded);
    schedule::write_scheduled_gains(writer, parts, layout);
    if let (Some(transfer), Some(before)) = (transfer, before) {
        let after = schedule::slow_part(writer, layout, "after");
        let sum = writer.sum("new_transfer_v", &[1.0 * before, -1.0 * after, 1.0 * transfer]);
        writer.copy(transfer, sum);
    }
}

/// An estimate that the out-of-balance in force follows once it has left the hold band.
struct FollowedEstimate<'a> {
    estimator: &'a Estimator,
    /// The estimate, kg m.
    aim: Slot,
    /// Way from the out-of-balance in force to it, kg m.
    way: Slot,
    /// The out-of-balance of the design, kg m.
    design_kg_m: f64,
}

/// Writes a switch that is 1 from the sample in which the estimate leaves the hold band until it has moved by no more than
/// [`SETTLED_SHARE`] of the band for `follow_samples`. The anchor is the estimate where the count began.
fn write_follow_switch(of: &FollowedEstimate<'_>, states: &mut States, writer: &mut Writer) -> Slot {
    let (band, all) = (of.estimator.hold_band_kg_m, f64::from(of.estimator.follow_samples));
    let left = states.scalar("follow_samples_left", 0.0, OnRestart::Restart);
    let anchor = states.scalar("anchor_kg_m", of.design_kg_m, OnRestart::Restart);
    let drift = writer.sum("drift_kg_m", &[1.0 * of.aim, -1.0 * anchor]);
    let outside = write_excess("outside_band", of.way, band, writer);
    let moved = write_excess("estimate_moved", drift, SETTLED_SHARE * band, writer);
    let follows = writer.clamp("followed_before", left, Limits::UNIT);
    let moves = writer.product("followed_moves", moved, follows);
    let both = writer.sum("begins_sum", &[1.0 * outside, 1.0 * moves]);
    let begins = writer.clamp("begins_again", both, Limits::UNIT);
    let step = writer.product("anchor_step_kg_m", begins, drift);
    let next = writer.sum("anchor_next_kg_m", &[1.0 * anchor, 1.0 * step]);
    writer.copy(anchor, next);
    let count = writer.local("follow_count");
    writer.sum_into(count, Some(-1.0), &[1.0 * left, (all + 1.0) * begins]);
    let kept = writer.clamp("follow_count_kept", count, Limits { low: 0.0, high: all });
    writer.copy(left, kept);
    writer.clamp("follows", kept, Limits::UNIT)
}

/// Writes a switch that rises from 0 to 1 while the size of a value exceeds a limit by up to [`SWITCH_WIDTH`].
fn write_excess(name: &str, of: Slot, limit: f64, writer: &mut Writer) -> Slot {
    let size = writer.magnitude(format!("{name}_size"), of);
    let excess = writer.local(format!("{name}_excess"));
    writer.sum_into(excess, Some(-1.0 / SWITCH_WIDTH), &[1.0 / (SWITCH_WIDTH * limit) * size]);
    writer.clamp(name, excess, Limits::UNIT)
}

/// Writes a switch that is 0 for `hold_samples` samples and 1 after them.
fn write_enable_switch(hold_samples: u32, states: &mut States, writer: &mut Writer) -> Slot {
    let count = states.scalar("estimator_samples", 0.0, OnRestart::Restart);
    let now = writer.local("estimator_samples_now");
    writer.sum_into(now, Some(1.0), &[1.0 * count]);
    let kept =
        writer.clamp("estimator_samples_kept", now, Limits { low: 0.0, high: f64::from(hold_samples) + 1.0 });
    writer.copy(count, kept);
    let past = writer.local("past_hold");
    writer.sum_into(past, Some(-f64::from(hold_samples)), &[1.0 * kept]);
    writer.clamp("estimator_enabled", past, Limits::UNIT)
}
