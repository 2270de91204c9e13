//! The origin of exported code, in words: lines in its header.

use counterpoise_models::{AxisKind, FeedbackSignal, Parameters};
use counterpoise_verify::{Limit, Verdict, Verification};

use super::acceptance::AcceptanceSource;
use super::figures::{describe_figure, describe_unmeasured};

/// Describes the verdict on every requirement, one a line.
pub(crate) fn describe_verdicts(verification: &Verification) -> Vec<String> {
    let verdicts = verification.verdicts.iter().map(|(requirement, verdict)| {
        let controlled = verification.controlled_quantity();
        let (figure, unit) =
            (describe_figure(requirement.figure, controlled), requirement.figure.unit(controlled));
        let basis = verification.acceptance(&requirement.figure).basis;
        let said = |value: f64, limit: &Limit| format!("{figure}: {value:.4} {unit} ({limit}; {basis})");
        match verdict {
            Verdict::Holds { value, limit, .. } => format!("{}: holds", said(*value, limit)),
            Verdict::Fails { value, limit, .. } => format!("{}: FAILS", said(*value, limit)),
            Verdict::NotApplicable { why } => {
                format!("{figure}: not applicable, {}", describe_unmeasured(why))
            }
        }
    });
    verdicts.collect()
}

/// Describes what the first two readings of the controller hold; `None` if the loop is one of the hub's inertial rate on a turning axis.
pub(crate) fn describe_loop_signals(plant: &Parameters) -> Option<String> {
    let (angle, rate, torque) = match plant.axis {
        AxisKind::Rotary => ("angle, rad", "rate, rad/s", "torque of the transmission, N m"),
        AxisKind::Linear => ("position, m", "speed, m/s", "force of the transmission, N"),
    };
    let signal = match plant.sensors.measured {
        FeedbackSignal::HubRate if plant.axis == AxisKind::Rotary => return None,
        FeedbackSignal::HubRate => format!("inertial {rate}"),
        FeedbackSignal::RelativeRate => format!("{rate}, relative to the platform"),
        FeedbackSignal::MotorRate => format!("motor's {rate}, over the ratio, relative to the platform"),
        FeedbackSignal::HubPosition => format!("{angle}, relative to the platform"),
        FeedbackSignal::MotorPosition => format!("motor's {angle}, over the ratio, relative to the platform"),
        FeedbackSignal::Torque => torque.to_owned(),
        FeedbackSignal::Current => "current of the motor, A".to_owned(),
    };
    Some(format!("the reading demand_rad_s is the demanded and hub_rate_rad_s the measured {signal}"))
}
