//! Requirements traced: the run that judges a figure, and the test on the machine that would.
//!
//! The tests on the machine are the experiments of the verification carried out on hardware: the same demand, the same motion of the
//! platform, the same statistics. What a loop's margins are worth is measured with a network or frequency response analyser, as
//! Skogestad and Postlethwaite (Multivariable Feedback Control, section 2.4) define them.

use counterpoise_models::ControlledQuantity;
use counterpoise_project::file::NamedChoice;
use counterpoise_verify::{
    Arrangement, CertificateFigure, LoopFigure, Model, PerformanceFigure, Procedure, Quantity, RestFigure,
    RoadOrigin, SightFigure, Source, Verification,
};

/// Description of the assessment of a requirement on a figure.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AcceptanceText {
    /// The basis of the figure: linear, or nonlinear with its amplitude, for example `nonlinear at heave 2 m/s^2, 1.5 Hz`.
    pub basis: String,
    /// The run of the verification that gives the figure.
    pub judged_by: String,
    /// The test on the machine that would show whether the requirement holds.
    pub test: String,
}

/// A result whose requirements can be traced to runs and to tests.
pub trait AcceptanceSource {
    /// Returns how a requirement on a figure is judged, and the test on the machine that would show whether it holds.
    fn acceptance(&self, figure: &PerformanceFigure) -> AcceptanceText;
}

impl AcceptanceSource for Verification {
    fn acceptance(&self, figure: &PerformanceFigure) -> AcceptanceText {
        let of =
            LoopProcedure { procedure: &self.evidence.procedure, controlled: self.controlled_quantity() };
        AcceptanceText {
            basis: basis(figure, &of),
            judged_by: judged_by(figure, &of),
            test: acceptance_test(figure, &of),
        }
    }
}

/// A procedure on a loop.
struct LoopProcedure<'a> {
    procedure: &'a Procedure,
    controlled: ControlledQuantity,
}

impl LoopProcedure<'_> {
    /// Returns the sensor of the loop.
    fn sensor(&self) -> String {
        if self.controlled == ControlledQuantity::RATE {
            return "the hub gyroscope".to_owned();
        }
        format!("the sensor of the {}", self.controlled.name())
    }
}

/// Returns whether a figure is linear, which holds at any amplitude, or at which amplitude it is nonlinear.
fn basis(figure: &PerformanceFigure, of: &LoopProcedure<'_>) -> String {
    let (procedure, unit) = (of.procedure, of.controlled.unit());
    let at = match figure {
        PerformanceFigure::Loop(_) | PerformanceFigure::Rejection { .. } => return "linear".to_owned(),
        PerformanceFigure::Step(Model::Linear, _)
        | PerformanceFigure::Triangle(Model::Linear, _)
        | PerformanceFigure::Disturbance(Model::Linear, ..) => return "linear".to_owned(),
        PerformanceFigure::Step(..) => format!("at a step of {} {unit}", procedure.step.rate_rad_s),
        PerformanceFigure::Triangle(..) => match procedure.triangle {
            Some(triangle) => format!("at a triangle of {} {unit}", triangle.rate_rad_s),
            None => "at a triangle".to_owned(),
        },
        PerformanceFigure::Disturbance(_, source, ..) => format!("at {}", size(*source, procedure)),
        PerformanceFigure::Certificate(CertificateFigure::LimitCyclePeak) => {
            "from rest and from near each predicted limit cycle".to_owned()
        }
        PerformanceFigure::Certificate(_) => return "linear, in the worst regime".to_owned(),
        PerformanceFigure::Rest(_) => "at rest".to_owned(),
        PerformanceFigure::Sight(_) => format!("at {}", size(sight_source(procedure), procedure)),
    };
    format!("nonlinear {at}")
}

/// Returns the amplitudes of a motion of the platform.
fn size(source: Source, procedure: &Procedure) -> String {
    let heave = format!("heave {} m/s^2, {} Hz", procedure.heave.amplitude, procedure.heave.frequency_hz);
    let pitch = format!("pitch {} rad/s, {} Hz", procedure.pitch.amplitude, procedure.pitch.frequency_hz);
    match source {
        Source::Heave => heave,
        Source::Pitch => pitch,
        Source::Both => format!("{heave}, and {pitch}"),
        Source::Road => match &procedure.road {
            Some(road) => {
                let (heave, pitch) = (road.heave_rms_m_s2(), road.pitch_rms_rad_s());
                format!(
                    "the road \"{}\", RMS heave {heave:.3} m/s^2 and pitch {pitch:.4} rad/s",
                    describe_road(&road.origin)
                )
            }
            None => "the road".to_owned(),
        },
    }
}

/// Returns the run of the verification that gives a figure, in words.
fn judged_by(figure: &PerformanceFigure, of: &LoopProcedure<'_>) -> String {
    let procedure = of.procedure;
    let on = |model: &Model| match model {
        Model::Linear => "linear plant",
        Model::Nonlinear => "nonlinear simulation",
    };
    match figure {
        PerformanceFigure::Loop(LoopFigure::PoleRadius) => "poles of the sampled linear loop".to_owned(),
        PerformanceFigure::Loop(_) => {
            "frequency response of the sampled linear loop, broken at the control".to_owned()
        }
        PerformanceFigure::Step(model, _) => format!("{}, {}", on(model), step(of)),
        PerformanceFigure::Triangle(model, _) => format!("{}, {}", on(model), triangle(of)),
        PerformanceFigure::Disturbance(model, source, arrangement, _) => {
            format!("{}, {}, {}", on(model), motion(*source, procedure), acting_control(*arrangement))
        }
        PerformanceFigure::Rejection { frequency_hz, arrangement, .. } => {
            format!(
                "frequency response of the linear loop at {frequency_hz} Hz, {}",
                acting_control(*arrangement)
            )
        }
        PerformanceFigure::Rest(_) => format!("nonlinear simulation, {} s at rest", procedure.duration_s),
        PerformanceFigure::Certificate(CertificateFigure::LimitCyclePeak) => {
            "stability certificate: harmonic balance, and the runs that start from it".to_owned()
        }
        PerformanceFigure::Certificate(_) => {
            "stability certificate: frequency response in each regime of friction, at each setting of the schedule".to_owned()
        }
        PerformanceFigure::Sight(_) => format!("nonlinear simulation, {}", sight_run(procedure)),
    }
}

/// Returns the test on the machine that would show whether a requirement on the figure holds, in words.
fn acceptance_test(figure: &PerformanceFigure, of: &LoopProcedure<'_>) -> String {
    let (procedure, name) = (of.procedure, of.controlled.name());
    match figure {
        PerformanceFigure::Loop(figure) => of_loop(*figure).to_owned(),
        PerformanceFigure::Step(..) => format!(
            "with the platform still, demand a {}; record demand, {name} and control at every sample",
            step(of)
        ),
        PerformanceFigure::Triangle(..) => format!(
            "with the platform still, demand a {}; record demand, {name} and control at every sample",
            triangle(of)
        ),
        PerformanceFigure::Disturbance(_, source, arrangement, quantity) => {
            let run = format!("{}, {}", motion(*source, procedure), acting_control(*arrangement));
            let settled = format!("from {} s on", procedure.settle_s);
            format!("move the platform: {run}; record {} {settled}", recorded_signal(*quantity, of))
        }
        PerformanceFigure::Rejection { source, arrangement, frequency_hz } => {
            let moved = if *source == Source::Heave { "heave" } else { "pitch" };
            format!(
                "move the platform in {moved} as a sine of {frequency_hz} Hz at a large and at a small amplitude, {}; compare {} \
                 and platform sensor at that frequency (`counterpoise fra` does it)",
                acting_control(*arrangement),
                of.sensor().trim_start_matches("the ")
            )
        }
        PerformanceFigure::Rest(figure) => {
            let what = match figure {
                RestFigure::HubRms => of.sensor(),
                RestFigure::Drift => "the hub's position".to_owned(),
            };
            format!(
                "with platform and demand at rest, record {what} for {} s; use the second half",
                procedure.duration_s
            )
        }
        PerformanceFigure::Sight(figure) => sight_test(*figure, procedure),
        PerformanceFigure::Certificate(CertificateFigure::LimitCyclePeak) => format!(
            "with platform and demand at rest, push the axis by hand, let it go and record {} for {} s; use the second half",
            of.sensor(),
            procedure.duration_s
        ),
        PerformanceFigure::Certificate(_) => {
            "with platform and demand at rest, raise the gain in steps until an oscillation stays".to_owned()
        }
    }
}

fn sight_test(figure: SightFigure, procedure: &Procedure) -> String {
    let recorded = match figure {
        SightFigure::Hub | SightFigure::HubJitter => {
            "record the image of a fixed target by a camera at the hub, and measure how it moves".to_owned()
        }
        SightFigure::Tip | SightFigure::TipJitter => {
            "record the image of a fixed target by a camera at the tip, and measure how it moves".to_owned()
        }
        SightFigure::Bending => {
            "record the images of a fixed target by cameras at hub and tip, and measure how the second moves against the first".to_owned()
        }
        SightFigure::Coincidence | SightFigure::Wait => {
            "record the signal of coincidence of the fire control at every sample".to_owned()
        }
        SightFigure::Hit => {
            "press the trigger at many random instants; record the angle of the tip by a camera when the projectile would leave, and count".to_owned()
        }
        SightFigure::HubTransferLoss | SightFigure::TipTransferLoss => {
            let at = if figure == SightFigure::HubTransferLoss { "hub" } else { "tip" };
            format!(
                "record the image of a bar target by the sight at the {at}; compare its modulation with that at rest"
            )
        }
    };
    format!(
        "move the platform: {}; from {} s on, {recorded}",
        sight_run(procedure),
        procedure.sight_settle_s()
    )
}

fn sight_source(procedure: &Procedure) -> Source {
    if procedure.road.is_some() { Source::Road } else { Source::Both }
}

fn sight_run(procedure: &Procedure) -> String {
    format!("{}, {}", motion(sight_source(procedure), procedure), acting_control(Arrangement::Compensated))
}

fn of_loop(figure: LoopFigure) -> &'static str {
    match figure {
        LoopFigure::GainMargin => {
            "raise the gain of the control from 1 in small steps until the loop begins to oscillate; the last stable gain is the margin"
        }
        LoopFigure::GainReductionMargin => {
            "lower the gain of the control from 1 in small steps until the loop begins to oscillate; the last stable gain is the margin"
        }
        LoopFigure::PhaseMargin | LoopFigure::DelayMargin => {
            "hold the control back by one sample more at a time until the loop begins to oscillate; the delay times crossover is the phase"
        }
        LoopFigure::DiskMargin | LoopFigure::MaxSensitivity | LoopFigure::MaxComplementary => {
            "inject a swept sine into the control and measure the response from injection to control (`counterpoise fra`); take its largest \
             modulus"
        }
        LoopFigure::Crossover => {
            "inject a swept sine into the control and measure the loop's response (`counterpoise fra`); take the frequency at which its \
             modulus is 1"
        }
        LoopFigure::PoleRadius => "close the loop and record its decay after a small step of the demand",
    }
}

fn step(of: &LoopProcedure<'_>) -> String {
    let step = &of.procedure.step;
    format!("step of {} {}, {} s", step.rate_rad_s, of.controlled.unit(), step.duration_s)
}

fn triangle(of: &LoopProcedure<'_>) -> String {
    match of.procedure.triangle {
        Some(triangle) => {
            let unit = of.controlled.unit();
            format!("triangle of {} {unit}, period {} s", triangle.rate_rad_s, triangle.period_s)
        }
        None => "triangle that the project does not have".to_owned(),
    }
}

/// Returns the name of a platform motion: the recording's file, or what generates the motion.
fn describe_road(origin: &RoadOrigin) -> String {
    match origin {
        RoadOrigin::Recording(file) => file.clone(),
        RoadOrigin::IsoRoad { class, speed_m_s } => {
            format!("ISO 8608 class {} at {speed_m_s} m/s", class.name())
        }
        RoadOrigin::Sea { significant_height_m, seed } => {
            format!("sea of {significant_height_m} m, seed {seed}")
        }
        RoadOrigin::SixAxes { seed } => format!("motion of six axes, seed {seed}"),
        RoadOrigin::Spectrum { seed } => format!("motion of a given spectrum, seed {seed}"),
        RoadOrigin::MotionSimulator { offset_m } => {
            format!("platform motion simulator, pivot {offset_m} m in front of its axis")
        }
    }
}

fn motion(source: Source, procedure: &Procedure) -> String {
    let heave = format!("heave {} m/s^2 at {} Hz", procedure.heave.amplitude, procedure.heave.frequency_hz);
    let pitch = format!("pitch {} rad/s at {} Hz", procedure.pitch.amplitude, procedure.pitch.frequency_hz);
    match source {
        Source::Heave => format!("{heave}, {} s", procedure.duration_s),
        Source::Pitch => format!("{pitch}, {} s", procedure.duration_s),
        Source::Both => format!("{heave} and {pitch}, {} s", procedure.duration_s),
        Source::Road => match &procedure.road {
            Some(road) => format!("road \"{}\", {:.1} s", describe_road(&road.origin), road.duration_s()),
            None => "road that the project does not have".to_owned(),
        },
    }
}

fn acting_control(arrangement: Arrangement) -> &'static str {
    match arrangement {
        Arrangement::Uncontrolled => "control constant",
        Arrangement::Feedback => "feedback alone",
        Arrangement::Compensated => "the whole controller",
    }
}

fn recorded_signal(quantity: Quantity, of: &LoopProcedure<'_>) -> String {
    let fixed = match quantity {
        Quantity::HubRms | Quantity::HubPeak => return of.sensor(),
        Quantity::Rejection => return format!("{} and the platform's sensors", of.sensor()),
        Quantity::TipRms | Quantity::TipPeak => "a gyroscope at the tip",
        Quantity::ControlRms | Quantity::ControlPeak => "the control",
        Quantity::CurrentPeak => "the motor current",
        Quantity::TravelPeak => "the hub's position relative to the platform",
        Quantity::GearOpen => {
            "motor and hub position, whose difference beyond the gear's wind-up shows open teeth,"
        }
    };
    fixed.to_owned()
}

#[cfg(test)]
mod tests {
    use counterpoise_verify::signals::RoadClass;

    use super::*;

    #[test]
    fn a_road_is_named_by_its_file_or_by_what_generates_it() {
        let named = [
            (RoadOrigin::Recording("drive.csv".to_owned()), "drive.csv"),
            (RoadOrigin::IsoRoad { class: RoadClass::D, speed_m_s: 12.5 }, "ISO 8608 class D at 12.5 m/s"),
            (RoadOrigin::Sea { significant_height_m: 3.0, seed: 7 }, "sea of 3 m, seed 7"),
            (RoadOrigin::SixAxes { seed: 1 }, "motion of six axes, seed 1"),
            (RoadOrigin::Spectrum { seed: 2 }, "motion of a given spectrum, seed 2"),
            (
                RoadOrigin::MotionSimulator { offset_m: 0.4 },
                "platform motion simulator, pivot 0.4 m in front of its axis",
            ),
        ];
        for (origin, name) in named {
            assert_eq!(describe_road(&origin), name);
        }
    }

    #[test]
    fn every_figure_has_a_run_and_a_test_of_its_own_motion() {
        let procedure = &Procedure::default();
        let procedure = LoopProcedure { procedure, controlled: ControlledQuantity::RATE };
        for figure in PerformanceFigure::all() {
            assert!(!judged_by(&figure, &procedure).is_empty(), "{figure}");
            let basis = basis(&figure, &procedure);
            let is_known = ["linear", "linear, in the worst regime"].contains(&basis.as_str());
            let from = ["nonlinear at ", "nonlinear from rest "];
            assert!(is_known || from.iter().any(|start| basis.starts_with(start)), "{figure}: {basis}");
            assert!(acceptance_test(&figure, &procedure).len() > 20, "{figure}");
        }
        let both = PerformanceFigure::Disturbance(
            Model::Nonlinear,
            Source::Both,
            Arrangement::Compensated,
            Quantity::HubRms,
        );
        assert_eq!(basis(&both, &procedure), "nonlinear at heave 2 m/s^2, 1.5 Hz, and pitch 0.2 rad/s, 1 Hz");
        let run = "nonlinear simulation, heave 2 m/s^2 at 1.5 Hz and pitch 0.2 rad/s at 1 Hz, 10 s, the whole controller";
        assert_eq!(judged_by(&both, &procedure), run);
        let test = acceptance_test(&both, &procedure);
        assert!(
            test.contains("0.2 rad/s at 1 Hz") && test.ends_with("the hub gyroscope from 2 s on"),
            "{test}"
        );
    }
}
