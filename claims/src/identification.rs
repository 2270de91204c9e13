//! Claims on identification by the triangle wave: a machine that the project does not know, recorded and identified.

use counterpoise_controller::SampledController;
use counterpoise_diagnose::identification::{Estimate, GainPoint, Identification, identify};
use counterpoise_models::Parameters;
use counterpoise_models::parameters::MapPoint;
use counterpoise_models::plant::Plant;
use counterpoise_recordings::Recording;
use counterpoise_simulate::{Detail, Imperfections, Scenario, Signal, Simulator};

use super::drawing::{ClaimCurve, CurveStyle, make_figure, make_panel};
use super::friction_identification::holding_controller;
use super::{Claim, Criterion, TestedDesign};
use counterpoise_pipeline::PipelineError;
use counterpoise_plot::{Axis, Figure as Drawing, Point};

/// By how much the recorded machine differs from the project: out-of-balance, inertias, Coulomb level and viscous friction at the
/// pivot.
const CONCEALED: [f64; 4] = [1.13, 1.15, 1.28, 1.8];
/// The amplifier of the thesis' tables 7-1 and 7-2: (V, A).
pub const AMPLIFIER: [(f64, f64); 14] = [
    (0.12, 0.27),
    (0.22, 0.48),
    (0.28, 0.6),
    (0.34, 0.7),
    (0.42, 0.83),
    (0.51, 0.96),
    (0.57, 1.08),
    (0.8, 1.86),
    (1.04, 2.79),
    (1.13, 3.04),
    (1.2, 3.3),
    (1.27, 3.53),
    (1.34, 3.81),
    (2.0, 6.0),
];
/// Shares of the normal out-of-balance of the balanced run (under 1 %) and of the midpoint run.
const STATES: [f64; 2] = [0.005, 0.5];
/// The triangle: rad/s, s, and how long it is recorded, s.
const TRIANGLE: (f64, f64, f64) = (0.15, 2.0, 10.0);

/// Returns a triangle wave recorded on a machine in closed loop, with noise and converters.
fn record_triangle(
    machine: &Parameters,
    controller: &mut dyn SampledController,
    seed: u64,
) -> Result<Recording, PipelineError> {
    let plant = Plant::from_lumped(machine)?;
    let sample_period_s = machine.interface.sample_period_s;
    let scenario = Scenario {
        demand_rad_s: Signal::Triangle { amplitude: TRIANGLE.0, period_s: TRIANGLE.1 },
        imperfections: Imperfections::NoiseAndQuantisation { seed },
        detail: Detail::Recording,
        ..Scenario::at_rest(TRIANGLE.2)
    };
    let run = Simulator::new(&plant)?.run(controller, &scenario)?;
    Ok(run.readings.recording("triangle", sample_period_s))
}

/// Returns the machine that the project does not know.
fn concealed_machine(nominal: &Parameters) -> Parameters {
    let mut machine = nominal.clone();
    if let Some(lumped) = &mut machine.lumped {
        lumped.out_of_balance_kg_m *= CONCEALED[0];
        lumped.hub_inertia_kg_m2 *= CONCEALED[1];
        lumped.beam_inertia_kg_m2 *= CONCEALED[1];
    }
    machine.pivot_friction.law.scale_coulomb(CONCEALED[2]);
    machine.pivot_friction.viscous_nm_s_rad *= CONCEALED[3];
    machine
}

/// Returns the first moment, inertia, Coulomb and viscous friction of a machine, all at the output.
fn four_parameters(p: &Parameters) -> [f64; 4] {
    let n = p.gearbox.ratio;
    let lumped = p.lumped.as_ref();
    [
        lumped.map_or(f64::NAN, |l| l.out_of_balance_kg_m),
        lumped.map_or(f64::NAN, |l| l.hub_inertia_kg_m2 + l.beam_inertia_kg_m2),
        p.pivot_friction.coulomb_nm() + n * p.motor_friction.coulomb_nm(),
        p.pivot_friction.viscous_nm_s_rad + n * n * p.motor_friction.viscous_nm_s_rad,
    ]
}

/// Returns row C19: the picture of control against rate.
///
/// # Errors
/// Those of the simulator and of the identification.
pub fn triangle_identification(tested: &TestedDesign<'_>) -> Result<Claim, PipelineError> {
    let machine = concealed_machine(tested.parameters());
    let found = identify(
        tested.parameters(),
        &[&[record_triangle(&machine, &mut tested.controller().runner(), 1)?]],
    )?;
    let b = &found.balances[0];
    let all = [b.out_of_balance_kg_m, b.inertia_kg_m2, found.coulomb_nm, found.viscous_nm_s_rad];
    let names = ["out-of-balance [kg m]", "inertia [kg m^2]", "Coulomb [N m]", "viscous [N m s/rad]"];
    let truth = four_parameters(&machine);
    let line = |k: usize| {
        let e: &Estimate = &all[k];
        format!("{} {:.1} [{:.1}, {:.1}], true {:.1}", names[k], e.value, e.ci95[0], e.ci95[1], truth[k])
    };
    let inside = (0..4).filter(|&k| all[k].holds(truth[k])).count();
    let lines: Vec<String> = (0..4).map(line).collect();
    Ok(Claim {
        id: "C19",
        title: "triangle identified",
        source: "7.3, fig 7-10",
        says: "u against hub rate: offset = out-of-balance, step at zero rate = Coulomb friction, slope of the lobes = viscous, loop width = inertia",
        measured: format!(
            "a machine that differs from the project in all four, one noisy triangle of 10 s under the exported H2 controller: {}; {inside} of 4 true values inside their 95 % intervals",
            lines.join("; ")
        ),
        criteria: (0..4)
            .map(|k| {
                let allowed = if k == 0 { 2.0 } else { 10.0 };
                let off = 100.0 * (all[k].value / truth[k] - 1.0);
                let name = format!("{}: identified off the truth, %", names[k]);
                Criterion::with_range(
                    &name,
                    "read from the picture",
                    off,
                    [-allowed, allowed],
                    "as near as the thesis reads it from its plot",
                )
            })
            .collect(),
        why: String::new(),
        drawings: vec![lobes(&found)],
    })
}

/// Control against hub rate, recorded and as the identified mechanism needs it, with what is read from it.
fn lobes(found: &Identification) -> Drawing {
    let points: &[[f64; 3]] = found.loops.first().map_or(&[], |one| &one.points);
    let every = points.len().div_ceil(DRAWN).max(1);
    let of =
        |column: usize| points.iter().step_by(every).map(|p| Point::new(1e3 * p[0], p[column])).collect();
    let panel = make_panel(
        Axis::linear("control", "V"),
        vec![ClaimCurve::new("recorded", CurveStyle::Faint, of(1)), ClaimCurve::line("identified", of(2))],
    );
    let read = &found.lobes;
    let panel = panel.with_level(read.offset_v, format!("offset {:.2} V", read.offset_v));
    make_figure("Control against hub rate: recorded and identified", Axis::linear("hub rate", "mrad/s"), vec![panel])
        .with_caption(&format!(
            "Step at zero rate {:.3} V (Coulomb friction), slope of the lobes {:.2} V s/rad (viscous friction and back-EMF), width {:.3} V s²/rad (inertia).",
            read.step_v, read.slope_v_s_rad, read.width_v_s2_rad
        ))
}

/// Most points of a loop that are drawn.
const DRAWN: usize = 1500;

/// Returns the mechanism with the thesis' amplifier at a share of its out-of-balance.
pub fn with_amplifier(nominal: &Parameters, share: f64) -> Parameters {
    let mut machine = nominal.clone();
    machine.amplifier.map =
        AMPLIFIER.iter().map(|&(input_v, current_a)| MapPoint { input_v, current_a }).collect();
    machine.lumped.iter_mut().for_each(|lumped| lumped.out_of_balance_kg_m *= share);
    machine
}

/// Returns row C20: the amplifier's gain curve.
///
/// # Errors
/// Those of the simulator and of the identification.
pub fn amplifier_curve(tested: &TestedDesign<'_>) -> Result<Claim, PipelineError> {
    let machines = STATES.map(|share| with_amplifier(tested.parameters(), share));
    let (balanced, midpoint) = (
        record_triangle(&machines[0], &mut holding_controller(&machines[0])?, 1)?,
        record_triangle(&machines[1], &mut holding_controller(&machines[1])?, 2)?,
    );
    let found = identify(tested.parameters(), &[&[balanced], &[midpoint]])?;
    let points = found.amplifier.points();
    let (amplifier, motor) = (&machines[0].amplifier, &machines[0].motor);
    let truth = |v: f64| amplifier.drive_v(v, motor) * amplifier.stall_gain_a_v(motor);
    let errors = points.iter().map(|q| (q.current_a / truth(q.input_v) - 1.0).abs());
    let worst = errors.fold(0.0, f64::max);
    Ok(Claim {
        id: "C20",
        title: "amplifier's curve",
        source: "7.3.1, tables 7-1, 7-2",
        says: "the amplifier's gain curve is recovered without a stall test, in one iteration, from balanced and midpoint runs",
        measured: format!(
            "{} points from one triangle at each of two out-of-balances, {:.2} to {:.2} V, worst {:.1} % from the concealed map of tables 7-1 and 7-2",
            points.len(),
            points.first().map_or(f64::NAN, |q| q.input_v),
            points.last().map_or(f64::NAN, |q| q.input_v),
            100.0 * worst
        ),
        criteria: vec![
            Criterion::at_least(
                "points of the curve",
                "14 in its tables",
                points.len() as f64,
                6.0,
                "fewer do not show where the curve bends",
            ),
            Criterion::at_most(
                "largest error of a point, %",
                "recovered",
                100.0 * worst,
                10.0,
                "the scatter of the thesis' own two tables",
            ),
        ],
        why: String::new(),
        drawings: vec![curve(points, &truth)],
    })
}

/// Recovered points over the concealed map, and how far they are from it.
fn curve(points: &[GainPoint], truth: &dyn Fn(f64) -> f64) -> Drawing {
    let end = points.last().map_or(1.0, |q| q.input_v);
    let inputs: Vec<f64> = (0..200).map(|k| end * f64::from(k) / 199.0).collect();
    let map = inputs.iter().map(|v| Point::new(*v, truth(*v))).collect();
    let linear = points.iter().map(|q| Point::new(q.input_v, q.linear_a)).collect();
    let recovered = points.iter().map(|q| Point::new(q.input_v, q.current_a)).collect();
    let off = |a: f64, v: f64| 100.0 * (a / truth(v) - 1.0);
    let limits =
        |side: usize| points.iter().map(|q| Point::new(q.input_v, off(q.ci95_a[side], q.input_v))).collect();
    let errors = points.iter().map(|q| Point::new(q.input_v, off(q.current_a, q.input_v))).collect();
    let panels = vec![
        make_panel(
            Axis::linear("stalled current", "A"),
            vec![
                ClaimCurve::reference("concealed map", map),
                ClaimCurve::points("recovered", recovered),
                ClaimCurve::faint_line("linear amplifier", linear),
            ],
        ),
        make_panel(
            Axis::linear("off the map", "%"),
            vec![
                ClaimCurve::points("recovered", errors),
                ClaimCurve::faint_line("95 % interval", limits(0)),
                ClaimCurve::faint_line("95 % interval", limits(1)),
            ],
        )
        .with_level(0.0, ""),
    ];
    make_figure("The amplifier's gain curve without a stall test", Axis::linear("input", "V"), panels)
}
