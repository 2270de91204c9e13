//! The header of generated code in words: what the readings hold, what the weights ask for, the verdicts, and the loop with feedback alone.

use counterpoise_models::{AxisKind, FeedbackSignal, Parameters};
use counterpoise_pipeline::{HeaderWords, PipelineError};
use counterpoise_project::resolve::synthesis::DesignRequest;
use counterpoise_verify::{Limit, Verdict, Verification};

use super::acceptance::AcceptanceSource;
use super::feedback_alone::{describe_feedback_alone, describe_uncertified};
use super::figures::{describe_figure, describe_unmeasured, format_figure};
use super::weights::describe_weights;

/// The sentences in the header of generated code.
#[derive(Debug, Clone, Copy)]
pub struct HeaderText;

impl HeaderWords for HeaderText {
    fn describe_loop_signals(&self, plant: &Parameters) -> Option<String> {
        describe_loop_signals(plant)
    }

    fn describe_weights(&self, asked: &DesignRequest) -> Vec<String> {
        describe_weights(asked)
    }

    fn describe_verdicts(&self, found: &Verification) -> Vec<String> {
        describe_verdicts(found)
    }

    fn describe_feedback_alone(&self, verified: Result<&Verification, &PipelineError>) -> Vec<String> {
        match verified {
            Ok(found) => describe_feedback_alone(found),
            Err(why) => vec![describe_uncertified(why)],
        }
    }
}

/// Describes the verdict on every requirement, one a line.
fn describe_verdicts(verification: &Verification) -> Vec<String> {
    let verdicts = verification.verdicts.iter().map(|(requirement, verdict)| {
        let controlled = verification.controlled_quantity();
        let (figure, unit) =
            (describe_figure(requirement.figure, controlled), requirement.figure.unit(controlled));
        let basis = verification.acceptance(&requirement.figure).basis;
        let said = |value: f64, limit: &Limit| {
            format!("{figure}: {} {unit} ({limit}; {basis})", format_figure(value))
        };
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
fn describe_loop_signals(plant: &Parameters) -> Option<String> {
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
