//! Gains, bias and transfer that follow the out-of-balance.

use crate::lowering::{Limits, States, Writer};
use crate::program::{OnRestart, Operation, Program, ProgramTerm, Slot, StateLimits};
use crate::tolerance::{ESTIMATE_SPAN, SLOWEST_RAD_S};
use crate::{Estimator, Learning, Parts, Scaling};

/// States that belong to the out-of-balance.
pub(crate) struct Layout {
    /// The out-of-balance in force, kg m.
    pub out_of_balance: Slot,
    /// Bias in force, V.
    pub bias: Option<Slot>,
    /// Remainder of the last change's step, V.
    pub transfer: Option<Slot>,
    /// The estimator's parameters.
    pub estimate: Vec<Slot>,
    /// Of a mean over windows: sum of the control, of what gravity's share falls short, and samples so far.
    pub window: Option<[Slot; 3]>,
    /// Gain in force and last output of each path that follows the out-of-balance.
    pub paths: Vec<Option<ScheduledPath>>,
}

/// A path that follows the out-of-balance.
#[derive(Clone, Copy)]
pub(crate) struct ScheduledPath {
    /// Gain in force.
    pub gain: Slot,
    /// The path's output before its gain in the last step, V.
    pub last: Slot,
}

/// Hands out the states, with the values that belong to the design's out-of-balance.
pub(crate) fn layout(parts: &Parts, states: &mut States) -> Layout {
    let design = parts.design_out_of_balance_kg_m;
    let out_of_balance = states.scalar("out_of_balance_kg_m", design, OnRestart::Keep);
    let bias = (parts.bias_v_per_kg_m != 0.0)
        .then(|| states.scalar("bias_v", parts.bias_v_per_kg_m * design, OnRestart::Keep));
    let paths: Vec<Option<ScheduledPath>> = parts
        .paths
        .iter()
        .map(|path| {
            let initial = initial_gain(path.scaling, design)?;
            let gain = states.scalar(&format!("{}_gain", path.name), initial, OnRestart::Keep);
            let last = states.scalar(&format!("{}_last_v", path.name), 0.0, OnRestart::Restart);
            Some(ScheduledPath { gain, last })
        })
        .collect();
    let follows = bias.is_some() || paths.iter().any(Option::is_some);
    let transfer = (follows && parts.transfer_time_s > 0.0)
        .then(|| states.scalar("transfer_v", 0.0, OnRestart::Restart));
    let estimate = parts.estimator.as_ref().map_or(Vec::new(), |estimator| {
        let holds = design * estimator.volts_per_kg_m_s2;
        let initial = |i| if i == 0 { holds } else { 0.0 };
        let add = |i| {
            let slot = states.scalar(&format!("estimate_{i}"), initial(i), OnRestart::Keep);
            states.keep_within(plausible_limits(parts, estimator, i));
            slot
        };
        (0..parameters(estimator)).map(add).collect()
    });
    let averages = |estimator: &Estimator| matches!(estimator.learning, Learning::Mean { .. });
    let window = parts.estimator.as_ref().is_some_and(averages).then(|| {
        ["window_sum_v", "window_fall_m_s2", "window_count"]
            .map(|name| states.scalar(name, 0.0, OnRestart::Restart))
    });
    Layout { out_of_balance, bias, transfer, estimate, window, paths }
}

/// Returns the limits of an estimated parameter: [`ESTIMATE_SPAN`] times the largest size that it can plausibly have.
fn plausible_limits(parts: &Parts, estimator: &Estimator, i: usize) -> StateLimits {
    let (low, high) = parts.out_of_balance_range_kg_m;
    let volts = parts.equivalent_limit_v();
    let size = match i {
        0 => low.abs().max(high.abs()) * estimator.volts_per_kg_m_s2.abs(),
        2 => volts / estimator.half_rate_rad_s.max(SLOWEST_RAD_S),
        _ => volts,
    };
    let most = ESTIMATE_SPAN * if size > 0.0 { size } else { volts };
    StateLimits { low: -most, high: most }
}

/// Returns the out-of-balance that may be set, kg m.
pub(crate) fn settable_moments(parts: &Parts) -> Limits {
    let (low, high) = parts.out_of_balance_range_kg_m;
    Limits { low, high }
}

/// Returns the number of estimated parameters.
fn parameters(estimator: &Estimator) -> usize {
    match estimator.learning {
        Learning::Gradient { .. } => 3,
        Learning::Mean { .. } => 1,
        Learning::Squares { .. } if estimator.gravity_m_s2 == 0.0 => 4,
        Learning::Squares { .. } => 3,
    }
}

fn initial_gain(scaling: Scaling, design: f64) -> Option<f64> {
    let mut states = States::default();
    let into = states.scalar("gain", 0.0, OnRestart::Keep);
    let of = states.scalar("out_of_balance_kg_m", design, OnRestart::Keep);
    let mut writer = Writer::new(&[]);
    writer.section("gain");
    gain(&mut writer, "path", scaling, of, design)
        .map(|from| writer.copy(into, from))
        .map(|()| evaluate(&writer.finish(Some(into)), design))
}

fn evaluate(program: &Program, out_of_balance: f64) -> f64 {
    let compiled = crate::compiled_program::CompiledProgram::<f64>::new(program, 2);
    let mut memory = vec![0.0; compiled.memory()];
    if let Some(place) = memory.get_mut(1) {
        *place = out_of_balance;
    }
    compiled.run(&mut memory, &[]).unwrap_or(0.0)
}

/// Writes the gain of a path at the out-of-balance `of`; `None` for a fixed path.
fn gain(writer: &mut Writer, name: &str, scaling: Scaling, of: Slot, design: f64) -> Option<Slot> {
    match scaling {
        Scaling::Fixed => None,
        Scaling::WithOutOfBalance => {
            let reference = constant(writer, format!("{name}_design_kg_m"), design);
            Some(writer.quotient(format!("{name}_ratio"), of, reference))
        }
        Scaling::Scheduled { below_kg_m, at_kg_m, above_kg_m } => {
            let rising = below_kg_m.map(|below| {
                edge(writer, &format!("{name}_rise"), of, &Edge { from_kg_m: below, to_kg_m: at_kg_m })
            });
            let falling = above_kg_m.map(|above| {
                edge(writer, &format!("{name}_fall"), of, &Edge { from_kg_m: above, to_kg_m: at_kg_m })
            });
            Some(match (rising, falling) {
                (Some(a), Some(b)) => writer.product(format!("{name}_share"), a, b),
                (Some(one), None) | (None, Some(one)) => one,
                (None, None) => constant(writer, format!("{name}_share"), 1.0),
            })
        }
    }
}

/// One side of a scheduled path's hat: its gain is 0 at `from_kg_m` and 1 at `to_kg_m`.
struct Edge {
    from_kg_m: f64,
    to_kg_m: f64,
}

/// (of - from) / (to - from) between 0 and 1.
fn edge(writer: &mut Writer, name: &str, of: Slot, edge: &Edge) -> Slot {
    let start = constant(writer, format!("{name}_from"), edge.from_kg_m);
    let span = constant(writer, format!("{name}_span"), edge.to_kg_m - edge.from_kg_m);
    let way = writer.sum(format!("{name}_way"), &[1.0 * of, -1.0 * start]);
    let part = writer.quotient(format!("{name}_part"), way, span);
    writer.clamp(name, part, Limits::UNIT)
}

fn constant(writer: &mut Writer, name: String, value: f64) -> Slot {
    let into = writer.local(name);
    writer.push(Operation::Sum { into, constant: Some(value), terms: Vec::new() });
    into
}

/// Writes gains and bias that belong to the out-of-balance in force.
pub(crate) fn write_scheduled_gains(writer: &mut Writer, parts: &Parts, layout: &Layout) {
    let of = layout.out_of_balance;
    for (path, followed) in parts.paths.iter().zip(&layout.paths) {
        let new = gain(writer, &path.name, path.scaling, of, parts.design_out_of_balance_kg_m);
        if let (Some(followed), Some(new)) = (followed, new) {
            writer.copy(followed.gain, new);
        }
    }
    if let Some(bias) = layout.bias {
        writer.sum_into(bias, None, &[parts.bias_v_per_kg_m * of]);
    }
}

/// Returns the program that sets the out-of-balance.
pub(crate) fn program(parts: &Parts, layout: &Layout) -> Program {
    let mut writer = Writer::new(&["new_out_of_balance_kg_m"]);
    let before = layout.transfer.map(|_| {
        writer.section("what the last step would give with the old gains and bias");
        slow_part(&mut writer, layout, "before")
    });
    writer.section("out-of-balance inside its range");
    let set = writer.clamp("set_kg_m", Slot::Input(0), settable_moments(parts));
    writer.copy(layout.out_of_balance, set);
    if let (Some(&first), Some(estimator)) = (layout.estimate.first(), &parts.estimator) {
        writer.sum_into(first, None, &[estimator.volts_per_kg_m_s2 * set]);
    }
    if let Some(window) = layout.window {
        writer.section("the estimator begins a new window");
        window.iter().for_each(|sum| writer.sum_into(*sum, None, &[]));
    }
    writer.section("gains and bias that belong to it");
    write_scheduled_gains(&mut writer, parts, layout);
    if let (Some(transfer), Some(before)) = (layout.transfer, before) {
        writer.section("the step this makes is taken out, to fade in");
        let after = slow_part(&mut writer, layout, "after");
        let sum = writer.sum("new_transfer_v", &[1.0 * before, -1.0 * after, 1.0 * transfer]);
        writer.copy(transfer, sum);
    }
    writer.finish(None)
}

/// Writes the part of the last control that gains and bias make.
pub(crate) fn slow_part(writer: &mut Writer, layout: &Layout, when: &str) -> Slot {
    let mut parts: Vec<ProgramTerm> = Vec::new();
    for (i, followed) in layout.paths.iter().enumerate() {
        if let Some(followed) = followed {
            parts.push(1.0 * writer.product(format!("{when}_{i}_v"), followed.gain, followed.last));
        }
    }
    parts.extend(layout.bias.map(|bias| 1.0 * bias));
    writer.sum(format!("{when}_v"), &parts)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::{Controller, Runner};

    /// The gains of a runner at an out-of-balance are those of a controller designed there.
    #[test]
    fn a_hat_is_one_at_its_point_and_zero_at_its_neighbours() {
        let scaling = Scaling::Scheduled { below_kg_m: Some(50.0), at_kg_m: 100.0, above_kg_m: Some(200.0) };
        for (of, expected) in [(0.0, 0.0), (50.0, 0.0), (75.0, 0.5), (100.0, 1.0), (150.0, 0.5), (250.0, 0.0)]
        {
            assert_eq!(initial_gain(scaling, of), Some(expected));
        }
        let lowest = Scaling::Scheduled { below_kg_m: None, at_kg_m: 100.0, above_kg_m: Some(200.0) };
        assert_eq!(initial_gain(lowest, -5.0), Some(1.0));
        assert_eq!(initial_gain(Scaling::Fixed, 3.0), None);
    }

    #[test]
    fn a_controller_without_paths_holds_its_bias() {
        let mut parts = Parts::new(1e-3, 10.0);
        parts.design_out_of_balance_kg_m = 150.0;
        parts.bias_v_per_kg_m = 0.02;
        let mut runner: Runner = Controller::new(parts).unwrap().runner();
        assert_eq!(runner.step_array(&[0.0; crate::READINGS]), 3.0);
        runner.set_out_of_balance(50.0);
        assert_eq!(runner.step_array(&[0.0; crate::READINGS]), 1.0);
    }
}
