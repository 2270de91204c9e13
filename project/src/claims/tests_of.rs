//! Claims of the thesis' test procedures: triangle, and frequency responses at several amplitudes.

use counterpoise_controller::Controller;
use counterpoise_models::plant::Plant;
use counterpoise_models::{FrictionLaw, Parameters};
use counterpoise_simulate::fra::{Settings, Test, measure};
use counterpoise_simulate::{Scenario, Signal, Simulator};
use counterpoise_verify::C64;
use counterpoise_verify::signals::rms;

use super::picture::{Axis, Curve, Panel, Picture};
use super::{Bench, Claim, Finding};
use crate::pipeline::PipelineError;

/// Frequency of the amplitude tests, Hz, and full amplitudes of demand (rad/s) and control (V).
const TONE_HZ: f64 = 1.0;
const DEMAND_RAD_S: f64 = 0.1;
const CONTROL_V: f64 = 1.5;
const AMPLITUDES: [f64; 4] = [1.0, 0.5, 0.25, 0.1];

/// Largest less smallest.
fn spread(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::MIN, f64::max) - values.iter().copied().fold(f64::MAX, f64::min)
}

fn text(values: &[f64]) -> String {
    values.iter().map(|v| format!("{v:.1}")).collect::<Vec<_>>().join(" / ")
}

/// Frequencies of the maps, Hz.
const MAPPED_HZ: [f64; 7] = [0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 5.0];

/// (Hz, dB) at each of the amplitudes.
type Map = Vec<Vec<(f64, f64)>>;

/// The frequency response analyser at every amplitude and frequency; `of` makes a figure in dB of a response.
fn map(
    bench: &Bench<'_>,
    controller: &Controller,
    (test, amplitude): (Test, f64),
    of: &dyn Fn(C64) -> f64,
) -> Result<Map, PipelineError> {
    let plant = &bench.designed.modelled.plant;
    let settings = Settings { least_duration_s: 1.0, ..Settings::default() };
    let one = |share: f64, hz: f64| -> Result<(f64, f64), PipelineError> {
        let at = (std::f64::consts::TAU * hz, share * amplitude);
        let found = measure(plant, &mut controller.runner(), test, at, &settings)?;
        Ok((hz, of(found.response.value)))
    };
    AMPLITUDES.iter().map(|&share| MAPPED_HZ.iter().map(|&hz| one(share, hz)).collect()).collect()
}

/// The largest spread over the amplitudes at any frequency, dB.
fn largest_spread(map: &Map) -> f64 {
    (0..MAPPED_HZ.len())
        .map(|k| spread(&map.iter().map(|row| row[k].1).collect::<Vec<_>>()))
        .fold(0.0, f64::max)
}

/// The values at the frequency of the tone.
fn at_tone(map: &Map) -> Vec<f64> {
    let near =
        |row: &Vec<(f64, f64)>| row.iter().find(|point| point.0 == TONE_HZ).map_or(f64::NAN, |point| point.1);
    map.iter().map(near).collect()
}

fn mapped(title: &str, quantity: &str, (map, full, unit): (&Map, f64, &str)) -> Picture {
    let named = AMPLITUDES.iter().map(|share| format!("{} {unit}", share * full));
    let curves = named.zip(map).map(|(name, row)| Curve::points(name, row.clone())).collect();
    Picture::new(title, Axis::frequency(), vec![Panel::of(Axis::even(quantity, "dB"), curves)])
}

/// C18: the plant's response to the control depends on amplitude.
///
/// # Errors
/// Those of the simulator.
pub fn c18(bench: &Bench<'_>) -> Result<Claim, PipelineError> {
    let gain = |h: C64| 20.0 * h.norm().log10();
    let found = map(bench, bench.controller(), (Test::Plant, CONTROL_V), &gain)?;
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
        finding: Finding::of(largest_spread(&found) > 3.0),
        pictures: vec![mapped(
            "Control to hub rate at four amplitudes",
            "hub rate over control, re rad/s per V",
            (&found, CONTROL_V, "V"),
        )],
    })
}

/// C21: the observer makes the closed loop linear in amplitude.
///
/// # Errors
/// Those of the simulator.
pub fn c21(bench: &Bench<'_>) -> Result<Claim, PipelineError> {
    let error = |h: C64| 20.0 * (1.0 - h).norm().log10();
    let closed = |controller| map(bench, controller, (Test::ClosedLoop, DEMAND_RAD_S), &error);
    let (with, without) = (closed(&bench.observed)?, closed(bench.controller())?);
    let quantity = "error over demand";
    let full = |map| (map, 1e3 * DEMAND_RAD_S, "mrad/s");
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
        finding: Finding::of(largest_spread(&with) < 0.5 * largest_spread(&without)),
        pictures: vec![
            mapped("Closed loop with the friction observer, four amplitudes", quantity, full(&with)),
            mapped("Closed loop without it, four amplitudes", quantity, full(&without)),
        ],
    })
}

/// C17: where friction sits shows in the triangle test.
///
/// # Errors
/// Those of the simulator.
pub fn c17(bench: &Bench<'_>) -> Result<Claim, PipelineError> {
    let rig = triangle(bench, bench.parameters())?;
    let (motor, pivot) = levels(bench.parameters());
    let total = motor + pivot;
    let (mut found, mut loops) = (Vec::new(), vec![("the rig".to_owned(), rig.clone())]);
    for share in [0.0, 1.0, 0.5, 0.3, 0.1] {
        let run = triangle(bench, &split(bench.parameters(), share * total, (1.0 - share) * total))?;
        let difference: Vec<f64> = run.control_v.iter().zip(&rig.control_v).map(|(a, b)| a - b).collect();
        found.push((share, 1e3 * rms(&difference)));
        loops.push((format!("motor:load {:.0}:{:.0}", 100.0 * share, 100.0 - 100.0 * share), run));
    }
    let words: Vec<String> = found
        .iter()
        .map(|(share, error)| format!("{:.0}:{:.0} {error:.0}", 100.0 * share, 100.0 - 100.0 * share))
        .collect();
    let best = found.iter().min_by(|a, b| a.1.total_cmp(&b.1)).map_or(f64::NAN, |row| row.0);
    let ends = found[0].1.min(found[1].1);
    Ok(Claim {
        id: "C17",
        title: "where friction sits",
        source: "7.2.1",
        says: "friction at one end of the gearbox alone reproduces the triangle test badly; split between motor and load it fits",
        measured: format!(
            "RMS difference of the control in mV from the rig ({:.0}:{:.0}), motor:load: {}",
            100.0 * motor / total,
            100.0 * pivot / total,
            words.join(", ")
        ),
        finding: Finding::of(best > 0.0 && best < 1.0 && ends > 2.0 * found[4].1),
        pictures: vec![lobes(&loops), apart(&loops)],
    })
}

/// Control against hub rate over the last period.
fn lobes(loops: &[(String, Triangle)]) -> Picture {
    let one = |(name, run): &(String, Triangle)| {
        let last = run.control_v.len() - run.control_v.len() / 2;
        let points = (last..run.control_v.len())
            .step_by(EVERY)
            .map(|k| (1e3 * run.hub_rate_rad_s[k], run.control_v[k]));
        Curve::line(name.clone(), points.collect())
    };
    let panel = Panel::of(Axis::even("control", "V"), loops.iter().map(one).collect());
    Picture::new("Triangle: control against hub rate", Axis::even("hub rate", "mrad/s"), vec![panel])
}

/// How far each split's control is from the rig's.
fn apart(loops: &[(String, Triangle)]) -> Picture {
    let Some((_, rig)) = loops.first() else { return lobes(loops) };
    let one = |(name, run): &(String, Triangle)| {
        let off = |k: usize| 1e3 * (run.control_v[k] - rig.control_v[k]);
        let half = run.control_v.len() / 2;
        Curve::line(
            name.clone(),
            (half..run.control_v.len()).map(|k| (k as f64 * rig.period_s, off(k))).collect(),
        )
    };
    let panel = Panel::of(Axis::even("control less the rig's", "mV"), loops[1..].iter().map(one).collect());
    Picture::new("Triangle: what another split changes", Axis::time(), vec![panel])
}

/// Every so many samples of a loop are drawn.
const EVERY: usize = 4;

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
    set_level(&mut out.motor_friction.law, motor_nm / ratio);
    set_level(&mut out.pivot_friction.law, pivot_nm);
    out
}

/// A Dahl law at another level, with the same deflection at breakaway; none where the level is 0.
fn set_level(law: &mut FrictionLaw, level_nm: f64) {
    if let FrictionLaw::Dahl { coulomb_nm, rest_stiffness_nm_rad, .. } = law {
        if level_nm == 0.0 {
            *law = FrictionLaw::None;
        } else {
            *rest_stiffness_nm_rad *= level_nm / *coulomb_nm;
            *coulomb_nm = level_nm;
        }
    }
}

/// The control of the recording's controller, or the design's, while the demand is a triangle.
fn triangle(bench: &Bench<'_>, parameters: &Parameters) -> Result<Triangle, PipelineError> {
    let demand_rad_s = Signal::Triangle { amplitude: DEMAND_RAD_S, period_s: 4.0 };
    let scenario = Scenario { demand_rad_s, ..Scenario::still(8.0) };
    let run =
        Simulator::new(&Plant::lumped(parameters)?)?.run(&mut bench.controller().runner(), &scenario)?;
    Ok(Triangle {
        period_s: run.sample_period_s,
        hub_rate_rad_s: run.truth.hub_rate_rad_s,
        control_v: run.readings.control_v,
    })
}
