//! Claims on the structure's models and their reduction.

use counterpoise_lti::{Response, StateSpace};
use counterpoise_models::plant::LinearPlant;
use counterpoise_models::structure::{FeModel, FeOptions, Fitted, Integration, Mesh, Support, Theory, modes};
use counterpoise_reduce::{Method, Order, balred};

use super::bench::{largest_db, rates};
use super::{Bench, Claim, Finding};
use crate::pipeline::{PipelineError, model};
use crate::resolve::model::StructureChoice;

/// Elements of the thesis' reference model.
const FINE: usize = 129;
/// Control band, Hz.
const BAND_HZ: (f64, f64) = (0.1, 10.0);
/// Flexible modes of the finite-element plant: with drive and rigid body this makes the thesis' order 21 and a little more.
const MODES: usize = 8;

/// Free-free flexible frequencies of a mesh over those of the fine one, mode by mode.
fn ratios(bench: &Bench<'_>, elements: usize, integration: Integration) -> Result<Vec<f64>, PipelineError> {
    let Some(beam) = bench.project.plant.beam.as_ref() else { return Ok(Vec::new()) };
    let frequencies = |mesh: Mesh, integration: Integration| -> Result<Vec<f64>, PipelineError> {
        let options = FeOptions { mesh, theory: Theory::BernoulliEuler, integration };
        let model = FeModel::beam(beam, &Fitted::default(), &options)?;
        Ok(modes(&model, Support::Free)?.flexible_rad_s().to_vec())
    };
    let fine = frequencies(Mesh::Equal(FINE), Integration::Quadrature)?;
    let coarse = frequencies(Mesh::Equal(elements), integration)?;
    Ok(coarse.iter().zip(&fine).map(|(a, b)| a / b).collect())
}

fn percent(ratios: &[f64]) -> String {
    ratios.iter().map(|r| format!("{:+.1}", 100.0 * (r - 1.0))).collect::<Vec<_>>().join(", ")
}

/// C1: uniform elements.
///
/// # Errors
/// Those of the finite elements.
pub fn c1(bench: &Bench<'_>) -> Result<Claim, PipelineError> {
    let many = ratios(bench, 14, Integration::UniformAverage)?;
    let few = ratios(bench, 3, Integration::UniformAverage)?;
    let five = &many[..many.len().min(5)];
    let (good, first) =
        (five.iter().all(|r| (r - 1.0).abs() < 0.04), few.first().is_some_and(|r| (r - 1.0).abs() < 0.01));
    let why = "this beam has a stout breech and steps between its sections, which three equal elements average away";
    Ok(Claim {
        id: "C1",
        source: "table 6-1",
        says: "14 uniform elements are within 4 % for modes 1 to 5, 3 within 1 % on mode 1 (free-free)",
        measured: format!("14 elements, modes 1 to 5: {} %; 3 elements: {} %", percent(five), percent(&few)),
        finding: if many.is_empty() {
            Finding::NotMeasured { why: "the project has no beam" }
        } else {
            Finding::holds_or(good && first, why)
        },
    })
}

/// C2: tapered elements.
///
/// # Errors
/// Those of the finite elements.
pub fn c2(bench: &Bench<'_>) -> Result<Claim, PipelineError> {
    let uniform = ratios(bench, 3, Integration::UniformAverage)?;
    let tapered = ratios(bench, 3, Integration::Quadrature)?;
    let mean = |r: &[f64]| 100.0 * r.iter().map(|x| (x - 1.0).abs()).sum::<f64>() / r.len().max(1) as f64;
    let first = |r: &[f64]| r.first().map_or(f64::NAN, |x| 100.0 * (x - 1.0));
    let closer = mean(&tapered) <= mean(&uniform) && first(&tapered).abs() <= first(&uniform).abs();
    Ok(Claim {
        id: "C2",
        source: "table 6-1",
        says: "tapered elements are at least as close as uniform ones; 3 tapered within 0.2 % on mode 1",
        measured: format!(
            "3 elements, mode 1: tapered {:+.2} %, uniform {:+.2} %; mean over modes {:.1} % against {:.1} %",
            first(&tapered),
            first(&uniform),
            mean(&tapered),
            mean(&uniform)
        ),
        finding: Finding::holds_or(
            closer && first(&tapered).abs() < 0.2,
            "equal elements do not end where this beam's sections do; the thesis' single taper has no such step",
        ),
    })
}

/// The linear plant by finite elements, the project's other choices kept.
fn beam_plant(bench: &Bench<'_>, modes: usize) -> Result<LinearPlant, PipelineError> {
    let mut project = bench.project.clone();
    (project.model.structure, project.model.modes) = (StructureChoice::Beam, modes);
    Ok(model(&project)?.linear)
}

/// C3: order 21 to order 11.
///
/// # Errors
/// Those of the reduction.
pub fn c3(bench: &Bench<'_>) -> Result<Claim, PipelineError> {
    let full = beam_plant(bench, MODES)?.system;
    let reduced = balred(&full, Order::States(11), Method::MatchDc)?;
    let band = (BAND_HZ.0, 20.0);
    let names = ["control", "heave", "pitch"];
    let mut words = Vec::new();
    let mut largest: f64 = 0.0;
    for (input, name) in names.iter().enumerate() {
        let error = relative_error(&full, &reduced.system, input, band)?;
        largest = largest.max(error);
        words.push(format!("{name} {:.2} %", 100.0 * error));
    }
    Ok(Claim {
        id: "C3",
        source: "fig 6-1",
        says: "an 11th-order reduction of the 21st-order plant keeps the response to input, heave and pitch",
        measured: format!(
            "order {} to 11, balanced: largest error to {} Hz over the largest response: {}",
            full.order(),
            band.1,
            words.join(", ")
        ),
        finding: Finding::of(largest < 0.05),
    })
}

/// Largest |a - b| over a band relative to the largest |a| there.
fn relative_error(
    a: &StateSpace,
    b: &StateSpace,
    input: usize,
    band_hz: (f64, f64),
) -> Result<f64, PipelineError> {
    let rates = rates(band_hz);
    let (x, y) = (Response::of(a)?.at_all(&rates)?, Response::of(b)?.at_all(&rates)?);
    let largest = x.iter().map(|m| m[(0, input)].norm()).fold(f64::MIN_POSITIVE, f64::max);
    let error = (0..rates.len()).map(|k| (x[k][(0, input)] - y[k][(0, input)]).norm()).fold(0.0, f64::max);
    Ok(error / largest)
}

/// C4: lumped against finite elements.
///
/// # Errors
/// Those of the models.
pub fn c4(bench: &Bench<'_>) -> Result<Claim, PipelineError> {
    let beam = beam_plant(bench, MODES)?.system;
    let lumped = &bench.designed.modelled.linear.system;
    let hub = |system: &StateSpace| {
        system.select(
            &[LinearPlant::HUB_RATE],
            &[LinearPlant::CONTROL, LinearPlant::HEAVE, LinearPlant::PITCH_RATE],
        )
    };
    let (beam, lumped) = (hub(&beam), hub(lumped));
    let (mut low, mut high) = (Vec::new(), Vec::new());
    for input in 0..3 {
        low.push(largest_db(&beam, &lumped, input, (0.1, 8.0))?);
        high.push(largest_db(&beam, &lumped, input, (50.0, 400.0))?);
    }
    let text = |values: &[f64]| values.iter().map(|v| format!("{v:.2}")).collect::<Vec<_>>().join(" / ");
    let agrees = low.iter().all(|db| *db < 1.0) && high.iter().any(|db| *db > 6.0);
    Ok(Claim {
        id: "C4",
        source: "fig 6-2",
        says: "lumped and finite-element responses agree at low frequency, the higher modes are missing",
        measured: format!(
            "control / heave / pitch: to 8 Hz {} dB; 50 to 400 Hz {} dB",
            text(&low),
            text(&high)
        ),
        finding: Finding::holds_or(
            agrees,
            "heave moves the hub through the beam's own modes too, which two inertias do not have",
        ),
    })
}

/// C9: designed on either model, run on the finer one.
///
/// # Errors
/// Those of the pipeline.
pub fn c9(bench: &Bench<'_>) -> Result<Claim, PipelineError> {
    let mut project = bench.project.clone();
    (project.model.structure, project.model.modes) = (StructureChoice::Beam, 3);
    project.verify.iter_mut().for_each(|verify| verify.road = None);
    let other = crate::pipeline::design(&project, bench.world)?;
    let linear = |c: &counterpoise_controller::Controller| {
        c.linear(c.parts().design_out_of_balance_kg_m).map_err(counterpoise_verify::Error::from)
    };
    let (lumped, beam) = (linear(bench.controller())?, linear(other.verified.controller())?);
    let changes = [1, 3, 2].map(|input| largest_db(&lumped, &beam, input, BAND_HZ));
    let mut values = Vec::new();
    for change in changes {
        values.push(change?);
    }
    let spillover =
        counterpoise_verify::verify_linear(&other.modelled.plant, bench.controller(), &bench.procedure, &[])?;
    let radius = spillover.evidence.poles.iter().map(|pole| pole.norm()).fold(0.0, f64::max);
    let (of_lumped, of_beam) = (
        spillover.evidence.margins.gain_margin_db(),
        other.verified.verification().evidence.margins.gain_margin_db(),
    );
    Ok(Claim {
        id: "C9",
        source: "6.4, fig 6-8",
        says: "controllers from the lumped and the finite-element model are nearly the same and perform alike; no spillover",
        measured: format!(
            "feedback / heave / pitch differ by {:.2} / {:.2} / {:.2} dB to {} Hz; on the finite-element plant: gain margin {of_lumped:.1} against {of_beam:.1} dB, largest pole {radius:.5}",
            values[0], values[1], values[2], BAND_HZ.1
        ),
        finding: c9_finding(&values, radius, (of_lumped - of_beam).abs()),
    })
}

/// Largest difference of the two controllers in their band, and of their gain margins on the finite-element plant, dB.
const ALIKE_DB: f64 = 2.0;
const MARGIN_ALIKE_DB: f64 = 3.0;

fn c9_finding(differences_db: &[f64], radius: f64, margins_apart_db: f64) -> Finding {
    let alike = differences_db.iter().all(|db| *db < ALIKE_DB);
    let why = match (radius < 1.0, alike) {
        (false, _) => "the lumped design is unstable on the finite-element plant",
        (true, false) => "no spillover, but the controllers differ in the band",
        (true, true) if margins_apart_db < MARGIN_ALIKE_DB => return Finding::Holds,
        (true, true) => {
            "no spillover and nearly the same in the band, but the lumped design loses gain margin: its feedback inverts the hub-locked antiresonance, which lies a little elsewhere in the finer model"
        }
    };
    Finding::Differs { why: why.to_owned() }
}
