//! Claims of the thesis' test procedures: triangle, and frequency responses at several amplitudes.

use counterpoise_controller::Controller;
use counterpoise_linalg::C64;
use counterpoise_models::Parameters;
use counterpoise_models::plant::Plant;
use counterpoise_simulate::fra::{Settings, Test, TestSine, measure_point};
use counterpoise_simulate::{Scenario, Signal, Simulator};
use counterpoise_verify::signals::rms;

use super::drawing::{ClaimCurve, frequency_axis, make_figure, make_panel, time_axis};
use super::imbalance::apply_configuration;
use super::{Claim, Criterion, TestedDesign};
use crate::tolerance::BADLY_REPRODUCED;
use counterpoise_pipeline::PipelineError;
use counterpoise_plot::{Axis, Figure as Drawing, Point};

/// Frequency of the amplitude tests, Hz, and full amplitudes of demand (rad/s) and control (V).
const TONE_HZ: f64 = 1.0;
const DEMAND_RAD_S: f64 = 0.1;
const CONTROL_V: f64 = 1.5;
const AMPLITUDES: [f64; 4] = [1.0, 0.5, 0.25, 0.1];

/// Returns the largest less smallest.
fn spread(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::MIN, f64::max) - values.iter().copied().fold(f64::MAX, f64::min)
}

fn text(values: &[f64]) -> String {
    values.iter().map(|v| format!("{v:.1}")).collect::<Vec<_>>().join(" / ")
}

/// Frequencies of the maps, Hz.
const MAPPED_HZ: [f64; 7] = [0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 5.0];

/// dB over Hz at each of the amplitudes.
type Map = Vec<Vec<Point>>;

/// Returns the frequency response analyser at every amplitude and frequency; `of` makes a figure in dB of a
/// response.
fn map(
    tested: &TestedDesign<'_>,
    controller: &Controller,
    test: Test,
    amplitude: f64,
    of: &dyn Fn(C64) -> f64,
) -> Result<Map, PipelineError> {
    let plant = &tested.designed.modelled.plant;
    let settings = Settings { least_duration_s: 1.0, ..Settings::default() };
    let one = |share: f64, hz: f64| -> Result<Point, PipelineError> {
        let at = TestSine { frequency_rad_s: std::f64::consts::TAU * hz, amplitude: share * amplitude };
        let found = measure_point(plant, &mut controller.runner(), test, at, &settings)?;
        Ok(Point::new(hz, of(found.response.value)))
    };
    AMPLITUDES.iter().map(|&share| MAPPED_HZ.iter().map(|&hz| one(share, hz)).collect()).collect()
}

/// Returns the largest spread over the amplitudes at any frequency, dB.
fn largest_spread(map: &Map) -> f64 {
    (0..MAPPED_HZ.len())
        .map(|k| spread(&map.iter().map(|row| row[k].y).collect::<Vec<_>>()))
        .fold(0.0, f64::max)
}

/// Returns the values at the frequency of the tone.
fn at_tone(map: &Map) -> Vec<f64> {
    let near =
        |row: &Vec<Point>| row.iter().find(|point| point.x == TONE_HZ).map_or(f64::NAN, |point| point.y);
    map.iter().map(near).collect()
}

fn map_drawing(title: &str, quantity: &str, map: &Map, full: f64, unit: &str) -> Drawing {
    let named = AMPLITUDES.iter().map(|share| format!("{:.3} {unit}", share * full));
    let curves = named.zip(map).map(|(name, row)| ClaimCurve::points(name, row.clone())).collect();
    make_figure(title, frequency_axis(), vec![make_panel(Axis::linear(quantity, "dB"), curves)])
}

/// Returns row C18: the plant's response to the control depends on amplitude.
///
/// # Errors
/// Those of the simulator.
pub fn plant_over_amplitude(tested: &TestedDesign<'_>) -> Result<Claim, PipelineError> {
    let gain = |h: C64| 20.0 * h.norm().log10();
    let found = map(tested, tested.controller(), Test::Plant, CONTROL_V, &gain)?;
    Ok(Claim {
        id: "C18",
        title: "plant over amplitude",
        source: "7.2.2",
        says: "the plant's frequency response depends on the input amplitude",
        measured: format!(
            "hub rate over control at {TONE_HZ} Hz and amplitudes 1 / 0.5 / 0.25 / 0.1 of {CONTROL_V} V: {} dB; from {} to {} Hz they are up to {:.1} dB apart",
            text(&at_tone(&found)),
            MAPPED_HZ[0],
            MAPPED_HZ[MAPPED_HZ.len() - 1],
            largest_spread(&found)
        ),
        criteria: vec![Criterion::at_least(
            "largest spread over the amplitudes, dB",
            "depends on the amplitude",
            largest_spread(&found),
            3.0,
            "3 dB is far above what the analyser scatters by",
        )],
        why: String::new(),
        drawings: vec![map_drawing(
            "Control to hub rate at four amplitudes",
            "hub rate over control",
            &found,
            CONTROL_V,
            "V",
        )],
    })
}

/// Returns row C21: the observer makes the closed loop linear in amplitude.
///
/// # Errors
/// Those of the simulator.
pub fn closed_loop_over_amplitude(tested: &TestedDesign<'_>) -> Result<Claim, PipelineError> {
    let error = |h: C64| 20.0 * (1.0 - h).norm().log10();
    let closed = |controller| map(tested, controller, Test::ClosedLoop, DEMAND_RAD_S, &error);
    let (with, without) = (closed(&tested.observed)?, closed(tested.controller())?);
    let quantity = "error over demand";
    let drawn = |title, map| map_drawing(title, quantity, map, 1e3 * DEMAND_RAD_S, "mrad/s");
    Ok(Claim {
        id: "C21",
        title: "closed loop over amplitude",
        source: "7.4.1, fig 7-13",
        says: "with the observer the closed loop is linear in amplitude; without, it is not",
        measured: format!(
            "error over demand at {TONE_HZ} Hz, amplitudes 1 / 0.5 / 0.25 / 0.1 of {DEMAND_RAD_S} rad/s: with observer {} dB, without {} dB; from {} to {} Hz the amplitudes are up to {:.1} dB apart with it, {:.1} dB without",
            text(&at_tone(&with)),
            text(&at_tone(&without)),
            MAPPED_HZ[0],
            MAPPED_HZ[MAPPED_HZ.len() - 1],
            largest_spread(&with),
            largest_spread(&without)
        ),
        criteria: vec![
            Criterion::at_most(
                "largest spread with the observer, dB",
                "linear in amplitude",
                largest_spread(&with),
                2.0,
                "2 dB is the scatter of the thesis' measured curves",
            ),
            Criterion::at_least(
                "largest spread without, dB",
                "not linear",
                largest_spread(&without),
                3.0,
                "clearly more than with it",
            ),
        ],
        why: String::new(),
        drawings: vec![
            drawn("Closed loop with the friction observer, four amplitudes", &with),
            drawn("Closed loop without it, four amplitudes", &without),
        ],
    })
}

/// Factor on the backlash by the largest spacer of the thesis' table 4-1.
const SPACER: f64 = 5.0;
/// Shares of the motor in all friction that are tried.
const SPLITS: [f64; 5] = [0.0, 1.0, 0.5, 0.3, 0.1];

/// The splits beside a rig: the part of friction's own control by which each is off, and the loops.
struct RigComparison {
    off: Vec<f64>,
    loops: Vec<NamedTriangle>,
}

/// Returns row C17: where friction shows in the triangle test. On the rig as it is, and on one whose friction is half and half as the
/// thesis found on its own.
///
/// # Errors
/// Those of the simulator.
pub fn place_of_friction(tested: &TestedDesign<'_>) -> Result<Claim, PipelineError> {
    let named = [
        "C17",
        "where friction sits",
        "7.2.1",
        "on the balanced rig, where the backlash acts, friction at one end of the gearbox alone reproduces the triangle test badly; split between motor and load it fits",
    ];
    let Some(mut balanced) = apply_configuration(tested, "balanced")? else {
        return Ok(Claim::not_measured(named, "the project has no configuration \"balanced\""));
    };
    balanced.gearbox.backlash_rad *= SPACER;
    let (motor, pivot) = levels(&balanced);
    let total = motor + pivot;
    let own = compare_splits(tested, "the rig", &balanced, total)?;
    let half = split(&balanced, 0.5 * total, 0.5 * total);
    let half = compare_splits(tested, "half and half", &half, total)?;
    let words = |found: &RigComparison| {
        let one = |(share, off): (&f64, &f64)| format!("{} {:.1}", ratio(*share), 100.0 * off);
        SPLITS.iter().zip(&found.off).map(one).collect::<Vec<_>>().join(", ")
    };
    let ends = [own.off[0], own.off[1], half.off[0], half.off[1]].map(|off| 100.0 * off);
    let (least, most) =
        (ends.iter().copied().fold(f64::MAX, f64::min), ends.iter().copied().fold(0.0, f64::max));
    // the split of the rig itself is the last one tried, that of the other rig the third
    let right = 100.0 * own.off[SPLITS.len() - 1].max(half.off[2]);
    Ok(Claim {
        measured: format!(
            "balanced, backlash of the largest spacer (x{SPACER}); difference of the control in % of what friction does to it, motor:load: from the rig ({}) {}; from a rig of 50:50 {}",
            ratio(motor / total),
            words(&own),
            words(&half)
        ),
        criteria: place_criteria(right, least, most),
        why: format!(
            "the direction is as claimed, and the wrong end is up to {most:.0} % off; the end that is nearer to the rig's own split ({}) is off by less than a tenth",
            ratio(motor / total)
        ),
        drawings: vec![lobes(&own.loops), separation_drawing(&own.loops), separation_drawing(&half.loops)],
        ..Claim::of(named)
    })
}

/// Returns what is asked of the split, in % off: the right one, and the best and the worst end alone.
fn place_criteria(right: f64, least: f64, most: f64) -> Vec<Criterion> {
    vec![
        Criterion::at_least(
            "one end alone, the worst of four: off, %",
            "badly",
            most,
            100.0 * BADLY_REPRODUCED,
            "a tenth of what friction does can be seen in the loop",
        ),
        Criterion::at_least(
            "one end alone, the best of four: off, %",
            "badly",
            least,
            100.0 * BADLY_REPRODUCED,
            "a tenth of what friction does can be seen in the loop",
        )
        .with_explained_range(2.0, 100.0 * BADLY_REPRODUCED),
        Criterion::at_most("the rig's own split: off, %", "fits", right, 2.0, "the simulator repeats itself"),
        Criterion::at_least(
            "best wrong end over the right split",
            "the split fits better",
            least / right.max(0.1),
            2.0,
            "twice as near",
        ),
    ]
}

fn ratio(share: f64) -> String {
    format!("{:.0}:{:.0}", 100.0 * share, 100.0 - 100.0 * share)
}

/// Returns every split beside a mechanism.
fn compare_splits(
    tested: &TestedDesign<'_>,
    name: &str,
    mechanism: &Parameters,
    total: f64,
) -> Result<RigComparison, PipelineError> {
    let rig = triangle(tested, mechanism)?;
    let off = |run: &Triangle| -> Vec<f64> {
        run.control_v.iter().zip(&rig.control_v).map(|(a, b)| a - b).collect()
    };
    let friction = rms(&off(&triangle(tested, &split(mechanism, 0.0, 0.0))?));
    let mut found = RigComparison {
        off: Vec::new(),
        loops: vec![NamedTriangle { name: name.to_owned(), run: rig.clone() }],
    };
    for share in SPLITS {
        let run = triangle(tested, &split(mechanism, share * total, (1.0 - share) * total))?;
        found.off.push(rms(&off(&run)) / friction);
        found.loops.push(NamedTriangle { name: format!("motor:load {}", ratio(share)), run });
    }
    Ok(found)
}

/// Control against hub rate over the last period.
fn lobes(loops: &[NamedTriangle]) -> Drawing {
    let one = |NamedTriangle { name, run }: &NamedTriangle| {
        let last = run.control_v.len() - run.control_v.len() / 2;
        let points = (last..run.control_v.len())
            .step_by(EVERY)
            .map(|k| (1e3 * run.hub_rate_rad_s[k], run.control_v[k]));
        ClaimCurve::line(name.clone(), points.map(Point::from).collect())
    };
    let panel = make_panel(Axis::linear("control", "V"), loops.iter().map(one).collect());
    make_figure("Triangle: control against hub rate", Axis::linear("hub rate", "mrad/s"), vec![panel])
}

/// Returns how far each split's control is from the rig's.
fn separation_drawing(loops: &[NamedTriangle]) -> Drawing {
    let Some(NamedTriangle { run: rig, .. }) = loops.first() else { return lobes(loops) };
    let one = |NamedTriangle { name, run }: &NamedTriangle| {
        let off = |k: usize| 1e3 * (run.control_v[k] - rig.control_v[k]);
        let half = run.control_v.len() / 2;
        ClaimCurve::line(
            name.clone(),
            (half..run.control_v.len()).map(|k| Point::new(k as f64 * rig.period_s, off(k))).collect(),
        )
    };
    let panel = make_panel(Axis::linear("change of the control", "mV"), loops[1..].iter().map(one).collect());
    let title = format!("Triangle: what another split changes, against {}", loops[0].name);
    make_figure(title, time_axis(), vec![panel])
}

/// Every so many samples of a loop are drawn.
const EVERY: usize = 4;

/// A triangle in closed loop with its name in the legend.
struct NamedTriangle {
    name: String,
    run: Triangle,
}

/// A triangle in closed loop.
#[derive(Clone)]
struct Triangle {
    period_s: f64,
    hub_rate_rad_s: Vec<f64>,
    control_v: Vec<f64>,
}

/// Coulomb levels at the output: of the motor through the gear, and of the pivot.
fn levels(parameters: &Parameters) -> (f64, f64) {
    (
        parameters.gearbox.ratio * parameters.motor_friction.coulomb_nm(),
        parameters.pivot_friction.coulomb_nm(),
    )
}

fn split(parameters: &Parameters, motor_nm: f64, pivot_nm: f64) -> Parameters {
    let mut out = parameters.clone();
    let ratio = out.gearbox.ratio;
    out.motor_friction.law.set_coulomb_at_same_deflection_nm(motor_nm / ratio);
    out.pivot_friction.law.set_coulomb_at_same_deflection_nm(pivot_nm);
    out
}

/// Returns the control of the recording's controller, or the design's, while the demand is a triangle.
fn triangle(tested: &TestedDesign<'_>, parameters: &Parameters) -> Result<Triangle, PipelineError> {
    let demand_rad_s = Signal::Triangle { amplitude: DEMAND_RAD_S, period_s: 4.0 };
    let scenario = Scenario { demand_rad_s, ..Scenario::at_rest(8.0) };
    let run = Simulator::new(&Plant::from_lumped(parameters)?)?
        .run(&mut tested.controller().runner(), &scenario)?;
    Ok(Triangle {
        period_s: run.sample_period_s,
        hub_rate_rad_s: run.truth.hub_rate_rad_s().to_vec(),
        control_v: run.readings.control_v().to_vec(),
    })
}
