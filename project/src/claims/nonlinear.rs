//! Claims on the nonlinear plant: friction observer, and inertia, friction and backlash that are not as designed.

use counterpoise_models::Parameters;
use counterpoise_verify::robust::Varied;
use counterpoise_verify::{Arrangement, Figure, LoopFigure, Model, Quantity, Source, StepFigure};

use super::bench::{Behaviour, with_observers};
use super::{Bench, Claim, Finding};
use crate::pipeline::PipelineError;

/// The mechanism with a parameter changed by a factor.
fn changed(bench: &Bench<'_>, varied: Varied, factor: f64) -> Result<Parameters, PipelineError> {
    let mut parameters = bench.parameters().clone();
    varied.scale(&mut parameters, factor)?;
    Ok(parameters)
}

/// Step and stabilisation with the observed controller at factors of a parameter.
fn family(bench: &Bench<'_>, varied: Varied, factors: &[f64]) -> Result<Vec<Behaviour>, PipelineError> {
    factors.iter().map(|&factor| bench.behaviour(&changed(bench, varied, factor)?, &bench.observed)).collect()
}

fn mrad(rates: &[Behaviour]) -> String {
    rates.iter().map(|b| format!("{:.2}", 1e3 * b.residual_rad_s)).collect::<Vec<_>>().join(" / ")
}

fn overshoots(rates: &[Behaviour]) -> String {
    rates.iter().map(|b| format!("{:.1}", b.overshoot_percent)).collect::<Vec<_>>().join(" / ")
}

/// C8: the observer makes the nonlinear plant like the linear one.
///
/// # Errors
/// Those of the verification.
pub fn c8(bench: &Bench<'_>) -> Result<Claim, PipelineError> {
    let linear = bench.value(Figure::Step(Model::Linear, StepFigure::Overshoot));
    let plain = bench.behaviour(bench.parameters(), bench.controller())?;
    let observed = bench.behaviour(bench.parameters(), &bench.observed)?;
    let holds = (observed.overshoot_percent - linear).abs() < 5.0 && observed.steady_error_percent < 1.0;
    Ok(Claim {
        id: "C8",
        source: "6.3.2",
        says: "with the friction observer: 15 % overshoot against 13 % on the linear model, same steady state, slightly more residual",
        measured: format!(
            "overshoot {:.1} % against {linear:.1} % linear ({:.1} % without observer); steady-state error {:.2} %; RMS hub rate {:.2} mrad/s against {:.2} without observer",
            observed.overshoot_percent,
            plain.overshoot_percent,
            observed.steady_error_percent,
            1e3 * observed.residual_rad_s,
            1e3 * plain.residual_rad_s
        ),
        finding: Finding::of(holds),
    })
}

/// C10: inertia.
///
/// # Errors
/// Those of the verification.
pub fn c10(bench: &Bench<'_>) -> Result<Claim, PipelineError> {
    let found = family(bench, Varied::HubInertia, &[0.5, 1.0, 2.0])?;
    let whole = beam_inertia_range(bench)?;
    let grows = found[2].overshoot_percent > found[1].overshoot_percent
        && found[2].peak_time_s > found[1].peak_time_s;
    let stable = found.iter().all(|b| (b.residual_rad_s / found[1].residual_rad_s - 1.0).abs() < 0.5);
    Ok(Claim {
        id: "C10",
        source: "fig 6-9(a-c)",
        says: "doubled hub inertia: overshoot 20.5 %, slower peak; halved: 13 %; stabilisation hardly changes",
        measured: format!(
            "hub inertia at 0.5x / 1x / 2x: overshoot {} %, peak at {:.3} / {:.3} / {:.3} s, RMS {} mrad/s; the beam's inertia may change from {:.2}x to {:.2}x before the loop is unstable",
            overshoots(&found),
            found[0].peak_time_s,
            found[1].peak_time_s,
            found[2].peak_time_s,
            mrad(&found),
            whole.0,
            whole.1
        ),
        finding: match (grows, stable) {
            (true, true) => Finding::Holds,
            (true, false) => Finding::Differs {
                why: "the step is as claimed; stabilisation changes by more than half".to_owned(),
            },
            _ => Finding::Fails,
        },
    })
}

/// The factors of the beam's inertia, in steps of 2 % from 1 and no farther than 0.5 and 2, between which the loop stays stable.
fn beam_inertia_range(bench: &Bench<'_>) -> Result<(f64, f64), PipelineError> {
    let radius = [Figure::Loop(LoopFigure::PoleRadius)];
    let stable = |factor: f64| -> Result<bool, PipelineError> {
        let parameters = changed(bench, Varied::BeamInertia, factor)?;
        Ok(bench.figures(&parameters, bench.controller(), &radius)?[0] < 1.0)
    };
    let (mut low, mut high) = (1.0, 1.0);
    while low > 0.5 && stable(low - 0.02)? {
        low -= 0.02;
    }
    while high < 2.0 && stable(high + 0.02)? {
        high += 0.02;
    }
    Ok((low, high))
}

/// C11: friction.
///
/// # Errors
/// Those of the verification.
pub fn c11(bench: &Bench<'_>) -> Result<Claim, PipelineError> {
    let found = family(bench, Varied::Friction, &[0.5, 1.0, 2.0])?;
    let mut updated = Vec::new();
    for factor in [0.5, 2.0] {
        let told = with_observers(bench.controller(), bench.parameters(), factor)?;
        updated.push(bench.behaviour(&changed(bench, Varied::Friction, factor)?, &told)?);
    }
    let nominal = found[1].residual_rad_s;
    let degrades = found[2].residual_rad_s > 1.2 * nominal;
    let restores = updated[1].residual_rad_s < 0.5 * (found[2].residual_rad_s + nominal);
    Ok(Claim {
        id: "C11",
        source: "fig 6-9(d-f)",
        says: "doubled or halved friction degrades stabilisation; updating the observer restores it",
        measured: format!(
            "RMS at 0.5x / 1x / 2x: {} mrad/s; observer updated: {:.2} (0.5x), {:.2} (2x); overshoot {} %",
            mrad(&found),
            1e3 * updated[0].residual_rad_s,
            1e3 * updated[1].residual_rad_s,
            overshoots(&found)
        ),
        finding: Finding::of(degrades && restores),
    })
}

/// C12: backlash.
///
/// # Errors
/// Those of the verification.
pub fn c12(bench: &Bench<'_>) -> Result<Claim, PipelineError> {
    let found = family(bench, Varied::Backlash, &[0.5, 1.0, 2.0, 5.0])?;
    let same = found.iter().all(|b| {
        (b.overshoot_percent - found[1].overshoot_percent).abs() < 1.0
            && (b.residual_rad_s / found[1].residual_rad_s - 1.0).abs() < 0.05
    });
    let open = found.iter().map(|b| b.gear_open).fold(0.0, f64::max);
    Ok(Claim {
        id: "C12",
        source: "fig 6-9(g-i), 7-17(a)",
        says: "backlash of half to five times hardly matters out of balance: gravity preloads the gear",
        measured: format!(
            "at 0.5x / 1x / 2x / 5x: overshoot {} %, RMS {} mrad/s; teeth apart {:.1} % of the time",
            overshoots(&found),
            mrad(&found),
            100.0 * open
        ),
        finding: Finding::of(same && open == 0.0),
    })
}

/// C23: rejection at small amplitude.
///
/// # Errors
/// Those of the verification.
pub fn c23(bench: &Bench<'_>) -> Result<Claim, PipelineError> {
    let coulomb = bench.parameters().pivot_friction.coulomb_nm();
    let more = |torque_nm: f64| if coulomb > 0.0 { 1.0 + torque_nm / coulomb } else { 1.0 };
    let backlash = ratios_db(bench, Varied::Backlash, &[1.0, 2.0, 5.0])?;
    let added = added_inertia(bench);
    let inertia = ratios_db(bench, Varied::HubInertia, &added)?;
    let friction = ratios_db(bench, Varied::PivotFriction, &[1.0, more(50.0), more(100.0), more(150.0)])?;
    let spread = |found: &[f64]| found.iter().map(|db| (db - found[0]).abs()).fold(0.0, f64::max);
    let worse = friction.windows(2).all(|pair| pair[1] > pair[0]);
    let still = spread(&backlash) < 1.0 && spread(&inertia) < 3.0;
    Ok(Claim {
        id: "C23",
        source: "7.5, fig 7-17",
        says: "DRR at amplitude 0.333 hardly changes with backlash and inertia, worsens with friction (+50, +100, +150 N m)",
        measured: format!(
            "DRR in pitch {:.1} dB; change with backlash 1 to 5x {:.1} dB, the dumb-bells' inertia {:.1} dB, friction {:+.1} / {:+.1} / {:+.1} dB",
            friction[0],
            spread(&backlash),
            spread(&inertia),
            friction[1] - friction[0],
            friction[2] - friction[0],
            friction[3] - friction[0]
        ),
        finding: match (worse, still) {
            (true, true) => Finding::Holds,
            (true, false) => Finding::Differs {
                why: "friction worsens it as claimed; inertia matters too on this rig".to_owned(),
            },
            _ => Finding::Fails,
        },
    })
}

/// Factors of the hub's inertia: as it is, and with each of the configurations' added inertias (the thesis' dumb-bells).
fn added_inertia(bench: &Bench<'_>) -> Vec<f64> {
    let hub = bench.parameters().lumped.as_ref().map_or(f64::NAN, |lumped| lumped.hub_inertia_kg_m2);
    let added =
        bench.parameters().configurations.iter().map(|c| c.added_hub_inertia_kg_m2).filter(|j| *j > 0.0);
    std::iter::once(1.0).chain(added.map(|inertia| 1.0 + inertia / hub)).collect()
}

/// RMS hub rate over RMS pitch rate, dB, with the observed controller and a third of the procedure's pitch.
fn ratios_db(bench: &Bench<'_>, varied: Varied, factors: &[f64]) -> Result<Vec<f64>, PipelineError> {
    let mut small = bench.procedure.clone();
    small.pitch.amplitude /= 3.0;
    let figure =
        Figure::Disturbance(Model::Nonlinear, Source::Pitch, Arrangement::Compensated, Quantity::HubRms);
    let pitch_rms = small.pitch.amplitude.abs() / std::f64::consts::SQRT_2;
    let mut ratios = Vec::new();
    for &factor in factors {
        let plant = counterpoise_models::plant::Plant::lumped(&changed(bench, varied, factor)?)?;
        let values = counterpoise_verify::robust::figures_of(&plant, &bench.observed, &small, &[figure])?;
        let rms = if let counterpoise_verify::Value::Is(rms) = values[0] { rms } else { f64::NAN };
        ratios.push(20.0 * (rms / pitch_rms).log10());
    }
    Ok(ratios)
}

/// C25: what is exported is what was verified.
///
/// # Errors
/// Those of the verification.
pub fn c25(bench: &Bench<'_>) -> Result<Claim, PipelineError> {
    let design = counterpoise_lti::margins(&bench.designed.synthesised.sampled.loop_gain)?;
    let exported = &bench.designed.verified.verification().evidence.margins;
    let (before, after) = (design.gain_margin_db(), exported.gain_margin_db());
    let phase =
        |margins: &counterpoise_lti::Margins| margins.phase_margin().map_or(f64::NAN, |phase| phase.deg);
    let (lag_before, lag_after) = (phase(&design), phase(exported));
    Ok(Claim {
        id: "C25",
        source: "8.6, A4",
        says: "controllers go to the z-domain and to C automatically, and give the same closed loop on the target",
        measured: format!(
            "{} files written; margins of the design's sampled loop {before:.2} dB, {lag_before:.2} deg, of the exported coefficients {after:.2} dB, {lag_after:.2} deg",
            bench.designed.files.len()
        ),
        finding: Finding::of(
            (before - after).abs() < 0.5
                && (lag_before - lag_after).abs() < 1.0
                && !bench.designed.files.is_empty(),
        ),
    })
}
