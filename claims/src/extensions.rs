//! The extensions that the thesis asks for: the tip, and inertia apart from out-of-balance.

use counterpoise_models::Parameters;
use counterpoise_verify::history::{Experiment, History};
use counterpoise_verify::robustness::VariedParameter;
use counterpoise_verify::signals::rms;
use counterpoise_verify::{Arrangement, Source};

use super::drawing::{ClaimCurve, factor_axis, make_figure, make_panel, points_of, time_axis};
use super::{Claim, Criterion, TestedDesign};
use counterpoise_pipeline::PipelineError;
use counterpoise_plot::{Axis, Figure as Drawing, Point};

/// Returns the tip's rate predicted from the hub's: the beam on its spring,
///
/// ```text
///     J_b dw/dt = D_h (w_h - w) + K_h integral (w_h - w)
/// ```
///
/// by the trapezoidal rule.
fn predicted_tip(p: &Parameters, hub: &[f64]) -> Vec<f64> {
    let Some(lumped) = &p.lumped else { return Vec::new() };
    let (t, d, k) = (
        p.interface.sample_period_s,
        lumped.damping_nm_s_rad / lumped.beam_inertia_kg_m2,
        lumped.stiffness_nm_rad / lumped.beam_inertia_kg_m2,
    );
    let (mut rate, mut twist, mut before) =
        (hub.first().copied().unwrap_or(0.0), 0.0, hub.first().copied().unwrap_or(0.0));
    let mut out = Vec::with_capacity(hub.len());
    let weight = 0.5 * t * (d + 0.5 * t * k);
    for &now in hub {
        let drive = rate + weight * (before - rate + now) + t * k * twist;
        let next = drive / (1.0 + weight);
        twist += 0.5 * t * (before - rate + now - next);
        (rate, before) = (next, now);
        out.push(rate);
    }
    out
}

fn subtract(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(x, y)| x - y).collect()
}

/// Returns row F2: the tip.
///
/// # Errors
/// Those of the simulator.
pub fn tip_motion(tested: &TestedDesign<'_>) -> Result<Claim, PipelineError> {
    let source = if tested.procedure.road.is_some() { Source::Road } else { Source::Both };
    let run = |arrangement| {
        let experiment = Experiment::Disturbance(source, arrangement);
        tested.history(tested.parameters(), tested.controller(), experiment)
    };
    let (free, held) = (run(Arrangement::Uncontrolled)?, run(Arrangement::Compensated)?);
    let first = held.index_at(tested.procedure.settle_s);
    let predicted = predicted_tip(tested.parameters(), held.hub_rate_rad_s());
    let (tip, hub) = (&held.tip_rate_rad_s()[first..], &held.hub_rate_rad_s()[first..]);
    let as_hub = 1e3 * rms(&subtract(tip, hub));
    let as_predicted = 1e3 * rms(&subtract(tip, predicted.get(first..).unwrap_or(&[])));
    let (before, after) = (1e3 * rms(&free.tip_rate_rad_s()[first..]), 1e3 * rms(tip));
    let hub_after = 1e3 * rms(hub);
    Ok(Claim {
        id: "F2",
        title: "the tip",
        source: "9.2",
        says: "asks for the tip's motion predicted and stabilised, not only the hub's",
        measured: format!(
            "on the {}: tip {before:.2} mrad/s RMS without control, {after:.2} with the whole controller (hub {hub_after:.2}); tip taken as the hub errs by {as_hub:.3}, predicted from the hub's rate through the beam by {as_predicted:.3}",
            if source == Source::Road { "road" } else { "heave and pitch" }
        ),
        criteria: vec![
            Criterion::at_most(
                "error of the predicted tip rate over that of taking the hub's",
                "asked for",
                as_predicted / as_hub,
                0.5,
                "a prediction that is worth its computation halves the error",
            ),
            Criterion::at_most(
                "tip rate over hub rate with the whole controller, RMS",
                "stabilised, too",
                after / hub_after,
                1.1,
                "a tenth more than the hub",
            ),
            Criterion::at_most(
                "tip rate with the whole controller over that without control, RMS",
                "stabilised",
                after / before,
                0.5,
                "half is the least that can be called stabilised",
            ),
        ],
        why: String::new(),
        drawings: tip_motion_figures(&free, &held, &predicted, first),
    })
}

/// Returns the tip with and without control, and what hub and prediction say of it.
fn tip_motion_figures(free: &History, held: &History, predicted: &[f64], first: usize) -> Vec<Drawing> {
    let at_s = &held.time_s()[first..];
    let tip = &held.tip_rate_rad_s()[first..];
    let of = |values: &[f64]| points_of(at_s, values.get(first..).unwrap_or(&[]), 1e3);
    let stabilised = vec![
        ClaimCurve::faint_line("without control", of(free.tip_rate_rad_s())),
        ClaimCurve::line("with the whole controller", of(held.tip_rate_rad_s())),
    ];
    let off = |name: &str, values: &[f64]| {
        ClaimCurve::line(name, points_of(at_s, &subtract(tip, values.get(first..).unwrap_or(&[])), 1e3))
    };
    let errors = vec![off("tip less hub", held.hub_rate_rad_s()), off("tip less its prediction", predicted)];
    vec![
        make_figure(
            "The tip's rate",
            time_axis(),
            vec![make_panel(Axis::linear("tip rate", "mrad/s"), stabilised)],
        ),
        make_figure(
            "The tip's rate predicted from the hub's",
            time_axis(),
            vec![make_panel(Axis::linear("difference", "mrad/s"), errors)],
        ),
    ]
}

/// Returns row F4: inertia and out-of-balance apart.
///
/// # Errors
/// Those of the verification.
pub fn inertia_and_imbalance_apart(tested: &TestedDesign<'_>) -> Result<Claim, PipelineError> {
    let mut lines = Vec::new();
    let mut rows: Vec<Vec<Cell>> = Vec::new();
    for moment in [0.5, 1.0, 1.5] {
        let mut row = Vec::new();
        for inertia in [0.5, 1.0, 2.0] {
            let mut parameters = tested.parameters().clone();
            VariedParameter::OutOfBalance.scale(&mut parameters, moment)?;
            VariedParameter::HubInertia.scale(&mut parameters, inertia)?;
            let found = tested.behaviour(&parameters, &tested.observed)?;
            row.push(Cell {
                overshoot_percent: found.overshoot_percent,
                residual_mrad_s: 1e3 * found.residual_rad_s,
            });
        }
        let words =
            |cell: &Cell| format!("{:.1} %, {:.2} mrad/s", cell.overshoot_percent, cell.residual_mrad_s);
        let cells: Vec<String> = row.iter().map(words).collect();
        lines.push(format!("out-of-balance x{moment}: {}", cells.join(" | ")));
        rows.push(row);
    }
    let step_by_inertia = spread((0..3).map(|k| rows[1][k].overshoot_percent));
    let step_by_moment = spread((0..3).map(|k| rows[k][1].overshoot_percent));
    let rate_by_moment = spread((0..3).map(|k| rows[k][1].residual_mrad_s));
    let rate_by_inertia = spread((0..3).map(|k| rows[1][k].residual_mrad_s));
    Ok(Claim {
        id: "F4",
        title: "inertia and out-of-balance apart",
        source: "9.2",
        says: "asks for inertia and out-of-balance varied independently",
        measured: format!(
            "overshoot and RMS hub rate at hub inertia x0.5 | x1 | x2; {}. Inertia moves the overshoot by {step_by_inertia:.1} % and the rate by {rate_by_inertia:.2} mrad/s, out-of-balance by {step_by_moment:.1} % and {rate_by_moment:.2} mrad/s",
            lines.join("; ")
        ),
        criteria: vec![
            Criterion::at_least(
                "change of the overshoot by inertia over that by out-of-balance",
                "apart",
                step_by_inertia / step_by_moment,
                1.0,
                "the step belongs to inertia",
            ),
            Criterion::at_least(
                "change of the RMS hub rate by out-of-balance over that by inertia",
                "apart",
                rate_by_moment / rate_by_inertia,
                3.0,
                "stabilisation belongs to out-of-balance",
            ),
        ],
        why: String::new(),
        drawings: vec![inertia_and_imbalance_apart_figure(&rows)],
    })
}

/// Figures of a mechanism with another inertia and out-of-balance.
struct Cell {
    overshoot_percent: f64,
    /// RMS hub rate, mrad/s.
    residual_mrad_s: f64,
}

/// Overshoot and residual over inertia, a curve an out-of-balance.
fn inertia_and_imbalance_apart_figure(rows: &[Vec<Cell>]) -> Drawing {
    let of = |value: &dyn Fn(&Cell) -> f64| -> Vec<ClaimCurve> {
        let points = |row: &Vec<Cell>| {
            let inertia = [0.5, 1.0, 2.0].into_iter();
            inertia.zip(row).map(|(factor, cell)| Point::new(factor, value(cell))).collect()
        };
        let named = ["out-of-balance x0.5", "out-of-balance x1", "out-of-balance x1.5"].into_iter().zip(rows);
        named.map(|(name, row)| ClaimCurve::points(name, points(row))).collect()
    };
    let panels = vec![
        make_panel(Axis::linear("overshoot", "%"), of(&|cell| cell.overshoot_percent)),
        make_panel(Axis::linear("RMS hub rate", "mrad/s"), of(&|cell| cell.residual_mrad_s)),
    ];
    make_figure("Inertia and out-of-balance varied apart", factor_axis("hub inertia"), panels)
}

fn spread(values: impl Iterator<Item = f64>) -> f64 {
    let (low, high) = values.fold((f64::MAX, f64::MIN), |(a, b), v| (a.min(v), b.max(v)));
    high - low
}
