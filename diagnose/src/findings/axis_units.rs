//! The units of an answer: on a linear axis kg, N and m in place of kg m^2, N m and rad, for all but the motor that turns; of the loop's
//! sensor the unit of what it measures.

use counterpoise_models::{AxisKind, Parameters, Transmission};

use super::answer::Answer;
use crate::library::Component;

/// Parameters that are frequencies and angles on every axis.
const OF_NO_AXIS: [&str; 6] =
    ["natural_frequency", "bandwidth", "phase", "tilt", "roll_sensitivity", "yaw_sensitivity"];

/// Gives every parameter of an answer the unit that it has on the machine's axis and in its loop; nothing changes on a turning axis whose rate is
/// controlled.
pub fn set_axis_units(answer: &mut Answer, base: &Parameters) {
    for finding in &mut answer.findings {
        let component = finding.component;
        finding.parameters.iter_mut().for_each(|p| p.unit = unit(base, component, p.name, p.unit));
    }
    for hypothesis in &mut answer.hypotheses {
        let component = hypothesis.component;
        hypothesis.values.iter_mut().for_each(|v| v.unit = unit(base, component, v.name, v.unit));
    }
    for effect in &mut answer.not_excited {
        effect.unit = unit(base, effect.component, effect.parameter, effect.unit);
    }
}

fn unit(base: &Parameters, component: Component, parameter: &str, turning: &'static str) -> &'static str {
    if OF_NO_AXIS.contains(&parameter) {
        return turning;
    }
    if component == Component::HubGyro && parameter == "bias" {
        return base.controlled_quantity().unit();
    }
    // A linear motor slides with what it drives; every other one turns.
    let turns = component == Component::Motor && base.gearbox.kind != Transmission::Direct;
    if turns || base.axis == AxisKind::Rotary { turning } else { base.axis.unit(turning) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use counterpoise_models::{FeedbackSignal, reference};

    #[test]
    fn a_sensor_has_the_unit_of_what_it_measures_and_a_frequency_that_of_a_frequency() {
        let mut machine = reference::rig();
        let of = |p: &Parameters, parameter| unit(p, Component::HubGyro, parameter, "rad/s");
        assert_eq!([of(&machine, "bias"), of(&machine, "natural_frequency")], ["rad/s", "rad/s"]);
        machine.sensors.measured = FeedbackSignal::Torque;
        assert_eq!([of(&machine, "bias"), of(&machine, "natural_frequency")], ["N m", "rad/s"]);
        machine.axis = AxisKind::Linear;
        assert_eq!([of(&machine, "bias"), of(&machine, "natural_frequency")], ["N", "rad/s"]);
        machine.sensors.measured = FeedbackSignal::HubPosition;
        assert_eq!(of(&machine, "bias"), "m");
        assert_eq!(unit(&machine, Component::Pivot, "phase", "rad"), "rad");
        assert_eq!(unit(&machine, Component::Pivot, "coulomb", "N m"), "N");
    }
}
