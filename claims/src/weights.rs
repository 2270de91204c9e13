//! Claims on the choice of weights.

use counterpoise_linalg::Mat;
use counterpoise_lti::{StateSpace, feedback, margins, series, step};
use counterpoise_synth::{Alternative, SynthesisMethod, Weight, attempt, design_alternative};
use counterpoise_verify::{
    Arrangement, Experiment, LoopFigure, Model, PerformanceFigure, Source, StepFigure,
};

use super::drawing::{
    ClaimCurve, frequency_axis, gain_db, hub_panel, hub_rates, make_figure, make_panel, points_of, time_axis,
};
use super::tested_design::rate_grid;
use super::{Claim, Criterion, TestedDesign};
use crate::tolerance::SMALL_ERROR_PERCENT;
use counterpoise_pipeline::{DesignStages, PipelineError};
use counterpoise_plot::{Axis, Figure as Drawing, Point};

/// K1 / a1 of the integrating design, and the corner of the error weight without integral action, s: where the integrating design's own
/// weight levels off.
const INTEGRAL_GAIN: f64 = 200.0;
const CORNER_S: f64 = 1.0 / 1.8;
/// Gains K7 that are tried, over the one that equals the integrating weight at high frequency. The thesis draws "the high gain controller
/// without integrator" and says that gain reduces what it leaves.
const GAINS: [f64; 6] = [1.0, 2.0, 4.0, 8.0, 16.0, 32.0];

/// Steady-state error %, overshoot %, Ms, phase margin deg.
type Figures = [f64; 4];

/// A design without integral action.
struct DesignWithoutIntegral {
    gain: f64,
    figures: Figures,
    designed: DesignStages,
}

/// Returns row C26: with and without integral action.
///
/// # Errors
/// Those of the pipeline.
pub fn integral_action(tested: &TestedDesign<'_>) -> Result<Claim, PipelineError> {
    let integral = with_error(tested, Weight::Integral { gain: INTEGRAL_GAIN, time_s: 1.0 })?;
    let own = figures(&integral);
    let family = design_lag_family(tested);
    let high = family.iter().find(|one| one.figures[0] < SMALL_ERROR_PERCENT).or(family.last());
    let rows: Vec<String> =
        family.iter().map(|one| format!("K7 x{}: {}", one.gain, text(&one.figures))).collect();
    let high_figures = high.map_or([f64::NAN; 4], |one| one.figures);
    let least_error = family.iter().map(|one| one.figures[0]).fold(f64::INFINITY, f64::min);
    let low = family.first().map_or(f64::NAN, |one| one.figures[0]);
    Ok(Claim {
        id: "C26",
        title: "with and without integral action",
        source: "app. 5",
        says: "weights K1/(a1 s) and K2(a2 s + 1) give no steady-state error and less oscillation than K7/(a7 s + 1) and K8(a8 s + 1)",
        measured: format!(
            "with K1/(a1 s): {}; with K7/(a7 s + 1), from the gain of the same weight at high frequency upwards: {}",
            text(&own),
            rows.join("; ")
        ),
        criteria: integral_action_criteria(&own, &high_figures, least_error),
        why: format!(
            "the steady state is as claimed. At the gain of the same weight the design without integral action is the calmer one and leaves {low:.1} %"
        ),
        drawings: integral_action_figures(&integral, &family, high),
    })
}

/// Returns what is asked of the designs with and without integral action.
fn integral_action_criteria(own: &Figures, high: &Figures, least_error: f64) -> Vec<Criterion> {
    vec![
        Criterion::at_most(
            "steady-state error with integral action, %",
            "none",
            own[0],
            0.1,
            "what is left of the transient",
        ),
        Criterion::at_least(
            "smallest steady-state error without it, %",
            "some",
            least_error,
            5.0 * own[0].max(0.02),
            "five times as much can be seen",
        ),
        Criterion::at_least(
            "overshoot of the high gain above that with integral action, percentage points",
            "less oscillation with it",
            high[1] - own[1],
            2.0,
            "2 points can be seen in a figure",
        ),
        Criterion::at_least(
            "Ms of the high gain over that with integral action",
            "less oscillation with it",
            high[2] / own[2],
            1.1,
            "a tenth can be seen in a figure",
        ),
        Criterion::at_most(
            "overshoot with integral action, %",
            "13 (6.3.1)",
            own[1],
            14.0,
            "the weights are the thesis' form, not its numbers: a point more is allowed",
        ),
    ]
}

fn text(f: &Figures) -> String {
    format!(
        "steady-state error {:.2} %, overshoot {:.1} %, Ms {:.2}, phase margin {:.0} deg",
        f[0], f[1], f[2], f[3]
    )
}

/// Designs without integral action over the gain; the family ends if there is no design.
fn design_lag_family(tested: &TestedDesign<'_>) -> Vec<DesignWithoutIntegral> {
    let one = |gain: f64| {
        let weight = Weight::Lag { gain: gain * INTEGRAL_GAIN * CORNER_S, time_s: CORNER_S };
        let designed = with_error(tested, weight).ok()?;
        let figures = figures(&designed);
        figures.iter().all(|figure| figure.is_finite()).then_some(DesignWithoutIntegral {
            gain,
            figures,
            designed,
        })
    };
    GAINS.into_iter().map_while(one).collect()
}

fn integral_action_figures(
    integral: &DesignStages,
    family: &[DesignWithoutIntegral],
    high: Option<&DesignWithoutIntegral>,
) -> Vec<Drawing> {
    let response = |designed: &DesignStages| {
        let history = designed.verified.verification().history(Model::Linear, Experiment::Step)?;
        Some(hub_rates(history))
    };
    let mut steps: Vec<ClaimCurve> = response(integral)
        .map(|points| ClaimCurve::line("with integral action", points))
        .into_iter()
        .collect();
    for one in family {
        let style = |points| {
            let name = format!("without, K7 x{}", one.gain);
            if high.is_some_and(|high| high.gain == one.gain) {
                ClaimCurve::line(name, points)
            } else {
                ClaimCurve::reference(name, points)
            }
        };
        steps.extend(response(&one.designed).map(style));
    }
    let steps: Vec<ClaimCurve> =
        steps.into_iter().map(|curve| ClaimCurve { points: first_second(curve.points), ..curve }).collect();
    let over = |k: usize| family.iter().map(|one| Point::new(one.figures[0], one.figures[k])).collect();
    let own = figures(integral);
    let overshoot = make_panel(
        Axis::linear("overshoot", "%"),
        vec![ClaimCurve::points("without integral action", over(1))],
    )
    .with_level(own[1], "with integral action, no steady-state error");
    let ms = make_panel(Axis::linear("Ms", ""), vec![ClaimCurve::points("without integral action", over(2))])
        .with_level(own[2], "");
    let mut all = vec![
        make_figure("Step by both kinds of design, linear plant", time_axis(), vec![hub_panel(steps)])
            .with_caption(
                "Drawn through: the design with integral action, and the high gain that leaves as little.",
            ),
        make_figure(
            "What a small steady-state error costs without integral action",
            Axis::logarithmic("steady-state error", "%"),
            vec![overshoot, ms],
        ),
    ];
    all.extend(high.map(|high| disturbance_drawing(integral, &high.designed)));
    all
}

fn first_second(points: Vec<Point>) -> Vec<Point> {
    points.into_iter().filter(|point| point.x <= 1.0).collect()
}

/// Returns both designs under heave and pitch, with feedback alone: figures A5-7(b) and A5-8(b).
fn disturbance_drawing(integral: &DesignStages, high: &DesignStages) -> Drawing {
    let curve = |designed: &DesignStages, name: &str, experiment| {
        let history = designed.verified.verification().history(Model::Linear, experiment)?;
        Some(ClaimCurve::line(name, hub_rates(history)))
    };
    let panel = |arrangement| {
        let experiment = Experiment::Disturbance(Source::Both, arrangement);
        let curves = [
            curve(integral, "with integral action", experiment),
            curve(high, "without, high gain", experiment),
        ];
        hub_panel(curves.into_iter().flatten().collect())
    };
    let panels = vec![panel(Arrangement::Feedback), panel(Arrangement::Compensated)];
    make_figure("Heave and pitch by both kinds of design, linear plant", time_axis(), panels)
        .with_caption("Above by feedback alone, below with both feedforwards.")
}

/// Returns the thesis' form of the feedback weights with another error weight.
fn with_error(tested: &TestedDesign<'_>, error: Weight) -> Result<DesignStages, PipelineError> {
    tested.redesign(|project| {
        project.verify.iter_mut().for_each(|verify| verify.road = None);
        if let Some(synthesis) = &mut project.synth {
            synthesis.specification.feedback.error = error;
            synthesis.specification.feedback.control = Weight::Lead { gain: 1.0, time_s: 0.005 };
        }
    })
}

fn figures(designed: &DesignStages) -> Figures {
    let wanted = [
        PerformanceFigure::Step(Model::Linear, StepFigure::SteadyStateError),
        PerformanceFigure::Step(Model::Linear, StepFigure::Overshoot),
        PerformanceFigure::Loop(LoopFigure::MaxSensitivity),
        PerformanceFigure::Loop(LoopFigure::PhaseMargin),
    ];
    wanted.map(|figure| designed.verified.verification().value(figure).unwrap_or(f64::NAN))
}

/// Returns row C27: three methods on one plant and one pair of weights.
///
/// # Errors
/// Those of the design and the margins.
pub fn three_methods(tested: &TestedDesign<'_>) -> Result<Claim, PipelineError> {
    let design = &tested.designed.synthesised.design;
    let (mut words, mut loops, mut criteria) = (Vec::new(), Vec::new(), Vec::new());
    for (method, name) in [
        (SynthesisMethod::ThreePart, "H2"),
        (SynthesisMethod::LqgLtr, "LQG/LTR"),
        (SynthesisMethod::HInfinity, "H-infinity"),
    ] {
        match attempt(design_alternative(&design.plant, &design.specification.feedback, method))? {
            Ok(part) => {
                let broken = open_loop(tested, &part)?;
                let (text, judged) = judged_loop(name, &broken)?;
                criteria.extend(judged);
                words.push(format!("{name}: {text}"));
                let controller = part.controller.select(&[0], &[0]);
                loops.push(MethodLoop { name, controller, broken });
            }
            Err(_) => {
                words.push(format!("{name}: no solution"));
                criteria.push(Criterion::at_least(
                    &format!("{name}: gain margin, dB"),
                    "a controller",
                    f64::NAN,
                    6.0,
                    "there is none",
                ));
            }
        }
    }
    Ok(Claim {
        id: "C27",
        title: "three methods",
        source: "app. 2",
        says: "LQG/LTR, H2 and H-infinity as alternatives on the same plant",
        measured: words.join("; "),
        criteria,
        why: String::new(),
        drawings: three_methods_figures(&loops)?,
    })
}

/// The controller of a method, and its loop.
struct MethodLoop {
    name: &'static str,
    controller: StateSpace,
    /// The loop, broken at the plant's input.
    broken: StateSpace,
}

/// Returns the loop of a continuous design on the design plant.
fn open_loop(tested: &TestedDesign<'_>, part: &Alternative) -> Result<StateSpace, PipelineError> {
    let plant = &tested.designed.synthesised.design.plant;
    let seen = plant.measured_plant()?.select(&[0], &[plant.control]);
    Ok(series(&part.controller.select(&[0], &[0]), &seen)?)
}

/// Margins of a loop in words, and judged: zero if it is unstable when closed.
fn judged_loop(name: &str, broken: &StateSpace) -> Result<(String, [Criterion; 3]), PipelineError> {
    let found = margins(broken)?;
    let phase = found.phase_margin().map_or(f64::INFINITY, |phase| phase.deg);
    let gain = found.gain_margin_db();
    let text = format!("gain margin {gain:.1} dB, phase margin {phase:.0} deg, Ms {:.2}", found.ms.value);
    let stable = |value: f64| if found.closed_loop_stable { value } else { 0.0 };
    let reason = "a usual requirement on a servo loop; the thesis prints no figures for the alternatives";
    let criteria = [
        Criterion::at_least(&format!("{name}: gain margin, dB"), "an alternative", stable(gain), 6.0, reason),
        Criterion::at_least(
            &format!("{name}: phase margin, deg"),
            "an alternative",
            stable(phase),
            45.0,
            reason,
        ),
        Criterion::with_range(
            &format!("{name}: Ms"),
            "an alternative",
            stable(found.ms.value),
            [1.0, 2.0],
            reason,
        ),
    ];
    Ok((text, criteria))
}

fn three_methods_figures(loops: &[MethodLoop]) -> Result<Vec<Drawing>, PipelineError> {
    let drawn = rate_grid([0.05, 100.0]);
    let (mut controllers, mut gains, mut steps) = (Vec::new(), Vec::new(), Vec::new());
    for MethodLoop { name, controller, broken } in loops {
        controllers.push(ClaimCurve::line(*name, gain_db(controller, 0, &drawn)?));
        gains.push(ClaimCurve::line(*name, gain_db(broken, 0, &drawn)?));
        let unity = StateSpace::gain(Mat::eye(1), broken.timebase)?;
        let response = step(&feedback(broken, &unity)?, 1.0, 1000)?;
        let y: Vec<f64> = (0..response.time_s.len()).map(|k| response.y[(k, 0)]).collect();
        steps.push(ClaimCurve::line(*name, points_of(&response.time_s, &y, 1.0)));
    }
    let panels = vec![
        make_panel(Axis::linear("controller", "dB re V s/rad"), controllers),
        make_panel(Axis::linear("loop gain", "dB"), gains).with_level(0.0, ""),
    ];
    let step = make_panel(Axis::linear("measured rate over demand", ""), steps).with_level(1.0, "");
    Ok(vec![
        make_figure("Three methods, one plant, one pair of weights", frequency_axis(), panels),
        make_figure("Step by the three methods, continuous design plant", time_axis(), vec![step]),
    ])
}
