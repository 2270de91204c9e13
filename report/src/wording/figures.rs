//! Names and values of figures, as a person reads them.

use crate::tolerance::{SHOWN_AS_ZERO_DB, SHOWN_DISTANCE};
use counterpoise_models::ControlledQuantity;
use counterpoise_plot::number::short_number;
use counterpoise_verify::{
    Arrangement, CertificateFigure, JointExperiment, JointFigure, JointQuantity, LoopFigure, MissingReason,
    Model, PerformanceFigure, Quantity, RestFigure, SightFigure, Source, StepFigure, TriangleFigure,
};

/// Returns a number of a printed line: five significant digits, a plain minus sign, and a word for what has
/// no bound.
pub fn format_figure(value: f64) -> String {
    if !value.is_finite() {
        let sign = if value < 0.0 { "minus " } else { "" };
        return format!("{sign}infinite");
    }
    let magnitude = if value == 0.0 { 0.0 } else { value.abs().log10().floor() };
    if !(-4.0..7.0).contains(&magnitude) {
        return format!("{value:.4e}");
    }
    let decimals = (4.0 - magnitude).clamp(0.0, 8.0) as usize;
    format!("{value:.decimals$}")
}

/// Returns the name of a figure in a loop, for example `peak hub rate, pitch, feedback, linear plant`.
pub fn describe_figure(figure: PerformanceFigure, controlled: ControlledQuantity) -> String {
    match figure {
        PerformanceFigure::Loop(figure) => loop_figure(figure).to_owned(),
        PerformanceFigure::Step(model, figure) => format!("step {}, {}", step_figure(figure), plant(model)),
        PerformanceFigure::Triangle(model, figure) => {
            format!("triangle {}, {}", triangle_figure(figure), plant(model))
        }
        PerformanceFigure::Disturbance(model, source, arrangement, quantity) => {
            let (quantity, moving) = (quantity_name(quantity, controlled), platform_motion(source));
            format!("{quantity}, {moving}, {}, {}", acting_control(arrangement), plant(model))
        }
        PerformanceFigure::Rejection { source, arrangement, frequency_hz } => {
            format!(
                "DRR {} at {frequency_hz} Hz, {}, linear plant",
                platform_motion(source),
                acting_control(arrangement)
            )
        }
        PerformanceFigure::Rest(RestFigure::HubRms) => format!("RMS {} at rest", controlled.name()),
        PerformanceFigure::Rest(RestFigure::Drift) => "drift at rest".to_owned(),
        PerformanceFigure::Sight(figure) => sight_figure(figure).to_owned(),
        PerformanceFigure::Certificate(CertificateFigure::GainMargin) => {
            "gain margin, worst regime".to_owned()
        }
        PerformanceFigure::Certificate(CertificateFigure::MaxSensitivity) => {
            "largest sensitivity Ms, worst regime".to_owned()
        }
        PerformanceFigure::Certificate(CertificateFigure::LimitCyclePeak) => {
            format!("amplitude of the limit cycle that stays, {}", controlled.name())
        }
    }
}

/// Returns the name of a figure of both axes.
pub fn describe_joint_figure(figure: JointFigure) -> String {
    format!("{}, {}", describe_joint_experiment(figure.experiment), describe_joint_quantity(figure.quantity))
}

/// Returns the name of a run of both axes.
pub fn describe_joint_experiment(experiment: JointExperiment) -> &'static str {
    match experiment {
        JointExperiment::ElevationStep => "step in elevation",
        JointExperiment::TraverseStep => "step in traverse",
        JointExperiment::BothSteps => "steps of both axes",
        JointExperiment::Motion => "motion of the base",
    }
}

/// Returns the name of what is measured in a run of both axes.
pub fn describe_joint_quantity(quantity: JointQuantity) -> &'static str {
    match quantity {
        JointQuantity::ElevationRate => "rate error, elevation",
        JointQuantity::TraverseRate => "rate error, traverse",
        JointQuantity::ElevationSight => "line of sight, elevation",
        JointQuantity::CrossElevationSight => "line of sight, cross-elevation",
        JointQuantity::Sight => "line of sight, total",
    }
}

/// Returns a figure in decibels, or 0 if two decimals show it as 0: it is then written without a sign.
pub fn drop_small_sign(db: f64) -> f64 {
    if db.abs() < SHOWN_AS_ZERO_DB { 0.0 } else { db }
}

/// Returns the modulus of a pole with its distance from 1 where six decimals do not show it.
pub fn describe_modulus(modulus: f64) -> String {
    let inside = 1.0 - modulus;
    match inside.abs() {
        0.0 => "1".to_owned(),
        distance if distance < SHOWN_DISTANCE => {
            format!("1 {} {}", if inside > 0.0 { '-' } else { '+' }, short_number(distance))
        }
        _ => format!("{modulus:.6}"),
    }
}

/// Describes why a figure was not measured, or has no number.
pub fn describe_unmeasured(why: &MissingReason) -> String {
    match why {
        MissingReason::NoRoad => "this experiment was not run: the verification has no road".to_owned(),
        MissingReason::NoTriangle => {
            "this experiment was not run: the verification has no triangle".to_owned()
        }
        MissingReason::LinearPlantAlone => {
            "this experiment was not run: the linear plant alone was verified".to_owned()
        }
        MissingReason::NotRun => "this experiment was not run".to_owned(),
        MissingReason::NoLineOfSight => {
            "this figure was not measured: the project has no [verify.line_of_sight]".to_owned()
        }
        MissingReason::NoCoincidence => {
            "this figure was not measured: the project has no [verify.line_of_sight.coincidence]".to_owned()
        }
        MissingReason::NoOptics => {
            "this figure was not measured: the project has no [verify.line_of_sight.optics]".to_owned()
        }
        MissingReason::HoldsPosition => {
            "the loop holds a position on the platform: its line of sight moves with it".to_owned()
        }
        MissingReason::HoldsEffort => {
            "the loop holds a torque, a force or a current: nothing holds a line of sight".to_owned()
        }
        MissingReason::NoSuchSignal => "not computed on this plant".to_owned(),
        MissingReason::ShortRun => "the run is too short for it".to_owned(),
        MissingReason::EmptyRecord => "the record is empty".to_owned(),
        MissingReason::NoRise => "the hub never reaches 90 % of the demand".to_owned(),
        MissingReason::NoPeak => "the hub never exceeds the demand".to_owned(),
        MissingReason::PlatformStill => "the platform does not move".to_owned(),
        MissingReason::NotANumber => "not a number".to_owned(),
        MissingReason::NoValue => "it could not be measured".to_owned(),
        MissingReason::NoCertificate => {
            "the stability certificate was not computed here: `verify` and `design` compute it".to_owned()
        }
        MissingReason::NotPredicted => {
            "the certificate neither shows a limit cycle nor excludes one".to_owned()
        }
        MissingReason::StepResponse(error) => error.to_string(),
    }
}

fn quantity_name(quantity: Quantity, controlled: ControlledQuantity) -> String {
    match quantity {
        Quantity::HubRms => format!("RMS {}", controlled.name()),
        Quantity::HubPeak => format!("peak {}", controlled.name()),
        Quantity::TipRms => format!("RMS {}", controlled.tip_name()),
        Quantity::TipPeak => format!("peak {}", controlled.tip_name()),
        Quantity::CurrentPeak => format!("peak {}", controlled.drive_name()),
        Quantity::ControlRms => "RMS control".to_owned(),
        Quantity::ControlPeak => "peak control".to_owned(),
        Quantity::TravelPeak => "peak travel".to_owned(),
        Quantity::GearOpen => "gear open".to_owned(),
        Quantity::Rejection => "DRR at the procedure's motion".to_owned(),
    }
}

fn loop_figure(of: LoopFigure) -> &'static str {
    match of {
        LoopFigure::GainMargin => "gain margin",
        LoopFigure::GainReductionMargin => "gain reduction margin",
        LoopFigure::PhaseMargin => "phase margin",
        LoopFigure::DelayMargin => "delay margin",
        LoopFigure::DiskMargin => "disk margin",
        LoopFigure::MaxSensitivity => "largest sensitivity Ms",
        LoopFigure::MaxComplementary => "largest complementary sensitivity Mt",
        LoopFigure::PoleRadius => "largest closed-loop pole modulus",
        LoopFigure::Crossover => "highest crossover",
    }
}

fn step_figure(of: StepFigure) -> &'static str {
    match of {
        StepFigure::Overshoot => "overshoot",
        StepFigure::RiseTime => "rise time",
        StepFigure::PeakTime => "peak time",
        StepFigure::SettlingTime => "settling time",
        StepFigure::SteadyStateError => "steady-state error",
        StepFigure::ControlPeak => "peak control",
    }
}

fn triangle_figure(of: TriangleFigure) -> &'static str {
    match of {
        TriangleFigure::ErrorRms => "RMS error",
        TriangleFigure::ErrorPeak => "peak error",
        TriangleFigure::ControlPeak => "peak control",
    }
}

fn sight_figure(of: SightFigure) -> &'static str {
    match of {
        SightFigure::Hub => "RMS line of sight",
        SightFigure::HubJitter => "line-of-sight jitter",
        SightFigure::Tip => "RMS line of sight of the tip",
        SightFigure::TipJitter => "line-of-sight jitter of the tip",
        SightFigure::Bending => "RMS angle of the tip against the hub",
        SightFigure::Coincidence => "time within the coincidence window",
        SightFigure::Wait => "mean wait for coincidence",
        SightFigure::Hit => "hit probability",
        SightFigure::HubTransferLoss => "MTF loss by motion",
        SightFigure::TipTransferLoss => "MTF loss by motion of the tip",
    }
}

fn plant(of: Model) -> &'static str {
    match of {
        Model::Linear => "linear plant",
        Model::Nonlinear => "nonlinear plant",
    }
}

fn platform_motion(of: Source) -> &'static str {
    match of {
        Source::Heave => "heave",
        Source::Pitch => "pitch",
        Source::Both => "heave and pitch",
        Source::Road => "road",
    }
}

fn acting_control(of: Arrangement) -> &'static str {
    match of {
        Arrangement::Uncontrolled => "without control",
        Arrangement::Feedback => "feedback",
        Arrangement::Compensated => "feedback + feedforward",
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use counterpoise_models::{DriveQuantity, QuantityKind};

    #[test]
    fn printed_figures_keep_their_digits_at_every_size() {
        let texts: Vec<String> =
            [14.49204, -0.000_123_456, 0.0, 151_670.4, 2.5e9, f64::INFINITY].map(format_figure).into();
        assert_eq!(texts, ["14.492", "-0.00012346", "0.0000", "151670", "2.5000e9", "infinite"]);
    }

    #[test]
    fn no_two_figures_have_one_name() {
        let mut names: Vec<String> = PerformanceFigure::all()
            .into_iter()
            .map(|figure| describe_figure(figure, ControlledQuantity::RATE))
            .collect();
        let all = names.len();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), all);
    }

    #[test]
    fn a_figure_has_the_name_of_what_its_loop_controls() {
        let torque = ControlledQuantity { kind: QuantityKind::Effort, ..ControlledQuantity::RATE };
        let boom = ControlledQuantity { drive: DriveQuantity::Pressure, ..ControlledQuantity::RATE };
        let peak = PerformanceFigure::from_key("linear_pitch_feedback_current_peak_a").unwrap();
        let name = describe_figure(peak, torque);
        assert_eq!(describe_figure(peak, boom), name.replace("current", "load pressure"));
        let rms = PerformanceFigure::from_key("linear_pitch_feedback_hub_rms_rad_s").unwrap();
        assert_eq!(describe_figure(rms, torque), "RMS transmitted torque, pitch, feedback, linear plant");
    }
}
