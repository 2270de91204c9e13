//! The units of an answer on a linear axis: kg, N and m in place of kg m^2, N m and rad, for all but the motor that turns.

use counterpoise_models::{Axis, Parameters, Transmission};

use super::answer::Answer;
use crate::library::Component;

/// Gives every parameter of an answer the unit that it has on the machine's axis; nothing changes on a turning one.
pub fn set_axis_units(answer: &mut Answer, base: &Parameters) {
    if base.axis == Axis::Rotary {
        return;
    }
    for finding in &mut answer.findings {
        let component = finding.component;
        finding.parameters.iter_mut().for_each(|p| p.unit = unit(base, component, p.unit));
    }
    for hypothesis in &mut answer.hypotheses {
        let component = hypothesis.component;
        hypothesis.values.iter_mut().for_each(|value| value.unit = unit(base, component, value.unit));
    }
    for not_excited in &mut answer.not_excited {
        not_excited.unit = unit(base, not_excited.component, not_excited.unit);
    }
}

fn unit(base: &Parameters, component: Component, turning: &'static str) -> &'static str {
    // A linear motor slides with what it drives; every other one turns.
    let turns = component == Component::Motor && base.gearbox.kind != Transmission::Direct;
    if turns { turning } else { base.axis.unit(turning) }
}
