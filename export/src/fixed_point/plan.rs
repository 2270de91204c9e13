//! The fixed-point form of a controller: formats from ranges, integer operations, and how far they are from the reference.

use counterpoise_controller::Controller;
use counterpoise_controller::program::Slot;
use counterpoise_lti::poles;

use crate::Ranges;
use crate::fixed_point::format::{bits_for, to_integer};
use crate::fixed_point::prediction::predict;
use crate::fixed_point::writer::Writer;
use crate::fixed_point::{FixedError, FixedPointController};
use crate::ranges::settings;
use crate::rounding::Deviation;
use crate::tolerance::UNSTABLE_MODULUS;

/// Chooses formats for the ranges, fixes the integer arithmetic, proves that it cannot overflow and predicts how far it
/// is from the reference over `samples` samples.
///
/// # Errors
/// [`FixedError`]: a range that is unknown, a sum that does not fit, a divisor that may be 0, or a predicted worst
/// deviation above `allowed_v`.
pub fn plan_fixed_point(
    controller: &Controller,
    ranges: &Ranges,
    allowed_v: f64,
    samples: usize,
) -> Result<FixedPointController, FixedError> {
    let programs = controller.programs();
    let states = (0..programs.state_count()).map(|i| {
        let largest = ranges.of(Slot::State(i)).max(programs.initial().get(i).map_or(0.0, |v| v.abs()));
        let name = || Ranges::name(controller, &programs.step, Slot::State(i));
        if largest > 0.0 { Ok(bits_for(largest)) } else { Err(FixedError::NeverMoved { name: name() }) }
    });
    let states: Vec<i32> = states.collect::<Result<_, _>>()?;
    let inputs: Vec<i32> = (0..controller.parts().reading_count())
        .map(|i| bits_for(ranges.of(Slot::Input(i)).max(f64::MIN_POSITIVE)))
        .collect();
    let mut step = Writer::new(controller, &programs.step, &states, inputs);
    step.all(|slot| ranges.of(slot))?;
    let (low, high) = controller.parts().out_of_balance_range_kg_m;
    let input = vec![bits_for(low.abs().max(high.abs()).max(1.0))];
    let mut set = Writer::new(controller, &programs.set_out_of_balance, &states, input);
    set.all(|_| 0.0)?;
    let initial =
        programs.initial().iter().zip(&states).map(|(value, bits)| to_integer(*value, *bits)).collect();
    let errors = std::mem::take(&mut step.errors);
    let mut fixed = FixedPointController {
        controller: controller.clone(),
        initial,
        step: step.finish(),
        set_out_of_balance: set.program(),
        deviation: Deviation::none(samples),
        states: states.clone(),
    };
    fixed.deviation = predict(&fixed, ranges, errors, &set, samples);
    let worst_v = fixed.deviation.worst_v;
    if worst_v <= allowed_v {
        return Ok(fixed);
    }
    Err(match find_unstable_setting(controller) {
        Some((out_of_balance_kg_m, radius)) => FixedError::Unstable { out_of_balance_kg_m, radius, worst_v },
        None => FixedError::TooCoarse { worst_v, samples, allowed_v },
    })
}

/// Returns a setting at which the controller by itself is unstable, with the modulus of its largest pole.
fn find_unstable_setting(controller: &Controller) -> Option<(f64, f64)> {
    let all = std::iter::once(controller.parts().design_out_of_balance_kg_m).chain(settings(controller));
    let radius = |set: f64| {
        let poles = poles(&controller.linear(set).ok()?).ok()?;
        Some((set, poles.iter().map(|pole| pole.norm()).fold(0.0, f64::max)))
    };
    all.filter_map(radius).max_by(|a, b| a.1.total_cmp(&b.1)).filter(|(_, radius)| *radius > UNSTABLE_MODULUS)
}
