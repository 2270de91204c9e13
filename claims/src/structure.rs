//! Claims on the plant's models: the reduction, and two inertias against finite elements.

use counterpoise_lti::{StateSpace, poles};
use counterpoise_models::LumpedStructure;
use counterpoise_models::plant::{Angles, Body, LinearPlant, Plant};
use counterpoise_models::structure::{FeModel, NodeRows, Support, pinned_modes, undamped_modes};
use counterpoise_reduce::{
    Method, Order, Residual, SecondOrder, balred, guyan, minimal_realisation, modal_truncation,
};

use super::drawing::{ClaimCurve, frequency_axis, gain_db, make_figure, make_panel, phase_deg};
use super::tested_design::{largest_db, rate_grid};
use super::{Claim, Criterion, TestedDesign};
use crate::tolerance::{KEPT_RESPONSE, UNSEEN_STATE};
use counterpoise_pipeline::{PipelineError, build_plant_model};
use counterpoise_plot::{Axis, Figure as Drawing, Point};
use counterpoise_project::resolve::model::StructureChoice;

/// The band in which the reduction is judged, Hz.
const REDUCED_HZ: [f64; 2] = [0.1, 20.0];
/// Range of frequency that is drawn, Hz.
const DRAWN_HZ: [f64; 2] = [0.1, 400.0];
/// Flexible modes of the finite-element plant: with drive and rigid body this makes the thesis' order 21.
const MODES: usize = 8;
/// The order that the thesis reduces to, and the flexible modes that are left in it.
const ORDER: usize = 11;
const KEPT_MODES: usize = 3;
/// The inputs in words.
const INPUTS: [&str; 3] = ["control", "heave", "pitch"];

/// Returns the plant by finite elements, the project's other choices kept.
fn beam_plant(tested: &TestedDesign, modes: usize) -> Result<LinearPlant, PipelineError> {
    let mut project = tested.project.clone();
    (project.model.structure, project.model.modes) = (StructureChoice::Beam, modes);
    Ok(build_plant_model(&project)?.linear)
}

/// Returns a plant with another structure, linear.
fn with_body(tested: &TestedDesign, body: Body) -> Result<StateSpace, PipelineError> {
    let plant = Plant::with_body(&tested.project.plant, body)?;
    let choice = &tested.project.model;
    let at = plant.equilibrium(&choice.operating_point);
    Ok(plant.linearise(&at, choice.friction, Angles::Drop)?.system)
}

/// Guyan's condensation onto every fourth node's deflection, the hub and the tip, then the first pinned modes.
fn condense_structure(tested: &TestedDesign) -> Result<StateSpace, PipelineError> {
    let (fe, ratios) = counterpoise_pipeline::finite_elements(tested.project, StructureChoice::Beam)?;
    let hub = fe.hub.ok_or(counterpoise_models::Error::NoHubNode)?;
    let n = fe.M.nrows();
    let mut masters: Vec<usize> = (0..n).step_by(8).collect();
    masters.extend([hub.deflection, hub.rotation, fe.tip.deflection, fe.tip.rotation]);
    masters.sort_unstable();
    masters.dedup();
    let small = condense(&fe, &masters)?;
    with_body(tested, pinned_modes(&small, ratios, KEPT_MODES)?.body)
}

/// Guyan's condensation of finite elements onto some of their degrees of freedom, hub and tip among them.
fn condense(fe: &FeModel, masters: &[usize]) -> Result<FeModel, PipelineError> {
    let hub = fe.hub.ok_or(counterpoise_models::Error::NoHubNode)?;
    let n = fe.M.nrows();
    let none = |rows, columns| counterpoise_linalg::Mat::zeros(rows, columns);
    let whole = SecondOrder {
        M: fe.M.clone(),
        C: none(n, n),
        K: fe.K.clone(),
        F: none(n, 1),
        P: none(1, n),
        V: none(1, n),
    };
    let small = guyan(&whole, masters)?.structure;
    let at = |index: usize| masters.iter().position(|master| *master == index).unwrap_or(0);
    let rows = |node: NodeRows| NodeRows { deflection: at(node.deflection), rotation: at(node.rotation) };
    let kept = |all: &[f64]| masters.iter().map(|master| all[*master]).collect();
    Ok(FeModel {
        M: small.M,
        K: small.K,
        C: None,
        heave: kept(&fe.heave),
        pitch: kept(&fe.pitch),
        hub: Some(rows(hub)),
        tip: rows(fe.tip),
        tip_arm_m: fe.tip_arm_m,
        truncation: None,
    })
}

/// Returns the rate between the poles that stay and those that go, rad/s.
fn cut(system: &StateSpace) -> Result<f64, PipelineError> {
    let mut sizes: Vec<f64> = poles(system)?.iter().map(|pole| pole.norm()).collect();
    sizes.sort_by(f64::total_cmp);
    let (below, above) = (sizes.get(ORDER - 1), sizes.get(ORDER));
    Ok(below.zip(above).map_or(f64::INFINITY, |(a, b)| (a * b).sqrt()))
}

/// Returns row C3: order 21 to order 11.
///
/// # Errors
/// Those of the reduction.
pub fn reduced_order(tested: &TestedDesign<'_>) -> Result<Claim, PipelineError> {
    let full = beam_plant(tested, MODES)?.system;
    let rate = cut(&full)?;
    let seen = minimal_realisation(&full, UNSEEN_STATE)?;
    let by = |method, system| NamedReduction { method, system };
    let all = [
        by("modal truncation", modal_truncation(&full, rate, Residual::Drop)?.system),
        by("modal truncation, static gain kept", modal_truncation(&full, rate, Residual::MatchDc)?.system),
        by("balanced truncation", balred(&full, Order::States(ORDER), Method::MatchDc)?.system),
        by("Guyan and truncation", condense_structure(tested)?),
    ];
    let mut words = Vec::new();
    let mut best = f64::INFINITY;
    for NamedReduction { method: name, system } in &all {
        let mut errors = [0.0; 3];
        for (input, error) in errors.iter_mut().enumerate() {
            *error = 100.0 * relative_error(&full, system, input)?;
        }
        best = best.min(errors.iter().copied().fold(0.0, f64::max));
        words.push(format!(
            "{name} (order {}) {:.2} / {:.2} / {:.2}",
            system.order(),
            errors[0],
            errors[1],
            errors[2]
        ));
    }
    Ok(Claim {
        id: "C3",
        title: "order 21 to 11",
        source: "fig 6-1",
        says: "an 11th-order reduction of the 21st-order plant keeps the response to input, heave and pitch",
        measured: format!(
            "order {}, minimal realisation {}; largest error to {} Hz over the largest response, in % for control / heave / pitch: {}",
            full.order(),
            seen.system.order(),
            REDUCED_HZ[1],
            words.join("; ")
        ),
        criteria: vec![Criterion::at_most(
            "largest error of the best reduction, % of the largest response",
            "keeps the response",
            best,
            100.0 * KEPT_RESPONSE,
            "5 % cannot be seen in the thesis' figure",
        )],
        why: String::new(),
        drawings: reductions(&full, &all)?,
    })
}

/// A reduced plant with the name of its method.
struct NamedReduction {
    method: &'static str,
    system: StateSpace,
}

/// Returns each input's response by every reduction, beside the whole plant's.
fn reductions(full: &StateSpace, all: &[NamedReduction]) -> Result<Vec<Drawing>, PipelineError> {
    let drawn = rate_grid(DRAWN_HZ);
    let mut drawings = Vec::new();
    for (input, name) in INPUTS.iter().enumerate() {
        let mut curves = vec![ClaimCurve::faint_line(
            format!("whole, order {}", full.order()),
            gain_db(full, input, &drawn)?,
        )];
        for NamedReduction { method, system } in all {
            curves.push(ClaimCurve::new(
                *method,
                super::drawing::CurveStyle::Line,
                gain_db(system, input, &drawn)?,
            ));
        }
        let panel =
            make_panel(Axis::linear("hub rate", "dB"), curves).with_instant(REDUCED_HZ[1], "judged to here");
        drawings.push(make_figure(
            format!("Reduced to order {ORDER}: hub rate for {name}"),
            frequency_axis(),
            vec![panel],
        ));
    }
    Ok(drawings)
}

/// Returns the largest |a - b| over the band relative to the largest |a| there.
fn relative_error(a: &StateSpace, b: &StateSpace, input: usize) -> Result<f64, PipelineError> {
    let rates = rate_grid(REDUCED_HZ);
    let of = |system| counterpoise_lti::Response::of(system)?.at_all(&rates);
    let (x, y) = (of(a)?, of(b)?);
    let largest = x.iter().map(|m| m[(0, input)].norm()).fold(f64::MIN_POSITIVE, f64::max);
    let error = (0..rates.len()).map(|k| (x[k][(0, input)] - y[k][(0, input)]).norm()).fold(0.0, f64::max);
    Ok(error / largest)
}

/// Returns row C4: lumped against finite elements. Half the first mode with the hub locked parts low from
/// high.
///
/// # Errors
/// Those of the models.
pub fn lumped_against_elements(tested: &TestedDesign<'_>) -> Result<Claim, PipelineError> {
    let beam = beam_plant(tested, MODES)?.system;
    let lumped = &tested.designed.modelled.linear.system;
    let locked =
        |l: &LumpedStructure| (l.stiffness_nm_rad / l.beam_inertia_kg_m2).sqrt() / std::f64::consts::TAU;
    let first_hz = tested.parameters().lumped.as_ref().map_or(f64::NAN, locked);
    let (low, high) = ([0.1, 0.5 * first_hz], [first_hz, DRAWN_HZ[1]]);
    let (mut below, mut above) = ([0.0; 3], [0.0; 3]);
    for input in 0..3 {
        below[input] = largest_db(&beam, lumped, input, low)?;
        above[input] = largest_db(&beam, lumped, input, high)?;
    }
    let text = |values: &[f64; 3]| values.iter().map(|v| format!("{v:.2}")).collect::<Vec<_>>().join(" / ");
    let (why, others, as_elements) = heave_explained(tested, &beam, low)?;
    let at_low = |name: &str, k: usize| {
        let what = format!("largest difference below half the first mode, {name}, dB");
        Criterion::at_most(&what, "agree", below[k], 1.0, "1 dB is the width of a line in the thesis' figure")
    };
    let criteria = vec![
        at_low("control", 0),
        at_low("heave", 1).with_explained_range(1.0, 3.0),
        at_low("pitch", 2),
        Criterion::at_most(
            "the same for heave, with the load where the elements put it, dB",
            "agree",
            as_elements,
            0.5,
            "if the load's place is the reason, little may be left with it corrected",
        ),
        Criterion::at_least(
            "largest difference above the first mode, dB",
            "the higher modes are missing",
            above.iter().copied().fold(0.0, f64::max),
            6.0,
            "a missing mode is a peak of several times",
        ),
    ];
    Ok(Claim {
        id: "C4",
        title: "two inertias against elements",
        source: "fig 6-2",
        says: "lumped and finite-element responses agree at low frequency, the higher modes are missing",
        measured: format!(
            "largest difference in dB for control / heave / pitch: to {:.1} Hz (half the first mode with the hub locked) {}; {:.1} to {:.0} Hz {}",
            low[1],
            text(&below),
            high[0],
            high[1],
            text(&above)
        ),
        criteria,
        why,
        drawings: compare_plants(&beam, lumped, low[1], &others)?,
    })
}

/// Two inertias with another share of the flexible mode in weight and heave.
struct TwoMassVariant {
    name: &'static str,
    system: StateSpace,
}

/// Why heave differs: the load's share of the flexible mode is exchanged in the two-inertia plant and the difference measured again.
fn heave_explained(
    tested: &TestedDesign<'_>,
    beam: &StateSpace,
    low: [f64; 2],
) -> Result<(String, [TwoMassVariant; 2], f64), PipelineError> {
    let body = tested.designed.modelled.plant.body();
    let (fe, ratios) = counterpoise_pipeline::finite_elements(tested.project, StructureChoice::Beam)?;
    let elements = pinned_modes(&fe, ratios, 1)?.body;
    let share = |load_share_kg_m: f64| {
        let mut body = body.clone();
        body.modes.iter_mut().for_each(|mode| mode.load_share_kg_m = load_share_kg_m);
        with_body(tested, body)
    };
    let moment = body.out_of_balance_kg_m;
    let outer = body.modes.first().map_or(0.0, |mode| moment * mode.tip_shape);
    let own = elements.modes.first().map_or(0.0, |mode| mode.load_share_kg_m * mode.hub_shape.signum());
    let own = own * body.modes.first().map_or(1.0, |mode| mode.hub_shape.signum());
    let others = [
        TwoMassVariant { name: "two inertias, load on the beam's inertia", system: share(outer)? },
        TwoMassVariant { name: "two inertias, the elements' load on the mode", system: share(own)? },
    ];
    let db = |system: &StateSpace| largest_db(beam, system, LinearPlant::HEAVE, low);
    let here = db(&tested.designed.modelled.linear.system)?;
    let (on_beam, as_fe) = (db(&others[0].system)?, db(&others[1].system)?);
    let why = format!(
        "control and pitch agree to {:.1} Hz. In heave the two-inertia plant puts the whole out-of-balance torque on the hub (as the thesis' equations do), while heave loads every mass along the beam and bends it: {here:.2} dB apart as it is, {on_beam:.2} dB with the torque on the beam's inertia instead, {as_fe:.2} dB with the share of the flexible mode that the elements give. The load's place is the cause",
        low[1]
    );
    Ok((why, others, as_fe))
}

/// Returns the gain and phase of both plants for each input, with what else was tried in heave.
fn compare_plants(
    beam: &StateSpace,
    lumped: &StateSpace,
    low_hz: f64,
    others: &[TwoMassVariant],
) -> Result<Vec<Drawing>, PipelineError> {
    let drawn = rate_grid(DRAWN_HZ);
    let mut drawings = Vec::new();
    for (input, name) in INPUTS.iter().enumerate() {
        let mut gains = vec![ClaimCurve::line("finite elements", gain_db(beam, input, &drawn)?)];
        let mut phases = vec![ClaimCurve::line("finite elements", phase_deg(beam, input, &drawn)?)];
        gains.push(ClaimCurve::reference("two inertias", gain_db(lumped, input, &drawn)?));
        phases.push(ClaimCurve::reference("two inertias", phase_deg(lumped, input, &drawn)?));
        let also = others.iter().filter(|_| input == LinearPlant::HEAVE);
        for other in also {
            gains.push(ClaimCurve::line(other.name, gain_db(&other.system, input, &drawn)?));
        }
        let panels = vec![
            make_panel(Axis::linear("hub rate", "dB"), gains)
                .with_instant(low_hz, "half the first mode, hub locked"),
            make_panel(Axis::degrees("phase"), phases).with_instant(low_hz, ""),
        ];
        drawings.push(make_figure(format!("Hub rate for {name}, both plants"), frequency_axis(), panels));
    }
    Ok(drawings)
}

/// Nodes whose deflection and rotation are kept by the condensation: one of four.
const KEPT_OF: usize = 4;

/// Returns row C30: Guyan's condensation of the beam.
///
/// # Errors
/// Those of the finite elements and of the condensation.
pub fn condensed_beam(tested: &TestedDesign<'_>) -> Result<Claim, PipelineError> {
    let named = [
        "C30",
        "Guyan on the beam",
        "6.2",
        "Guyan's condensation keeps the low modes of the finite-element beam",
    ];
    if tested.project.plant.beam.is_none() {
        return Ok(Claim::not_measured(named, "the project has no beam"));
    }
    let (fe, _) = counterpoise_pipeline::finite_elements(tested.project, StructureChoice::Beam)?;
    let n = fe.M.nrows();
    let mut masters: Vec<usize> =
        (0..n / 2).step_by(KEPT_OF).flat_map(|node| [2 * node, 2 * node + 1]).collect();
    masters.extend(fe.hub.iter().flat_map(|hub| [hub.deflection, hub.rotation]));
    masters.extend([fe.tip.deflection, fe.tip.rotation]);
    masters.sort_unstable();
    masters.dedup();
    let kept = condense(&fe, &masters)?;
    let flexible = |model: &FeModel| {
        Ok::<_, PipelineError>(undamped_modes(model, Support::Free)?.flexible_rad_s().to_vec())
    };
    let (full, condensed) = (flexible(&fe)?, flexible(&kept)?);
    let count = condensed.len().min(full.len()).min(8);
    let off: Vec<f64> = (0..count).map(|k| 100.0 * (condensed[k] / full[k] - 1.0)).collect();
    let words: Vec<String> = off.iter().map(|v| format!("{v:+.3}")).collect();
    let points = off.iter().enumerate().map(|(k, v)| Point::new((k + 1) as f64, *v)).collect();
    let panel =
        make_panel(Axis::linear("frequency off by", "%"), vec![ClaimCurve::points("condensed", points)])
            .with_level(0.0, "");
    Ok(Claim {
        measured: format!(
            "{n} degrees of freedom condensed to {}; flexible modes off in %: {}",
            masters.len(),
            words.join(", ")
        ),
        criteria: condensation_criteria(&off),
        drawings: vec![make_figure(
            "Flexible modes after Guyan's condensation",
            Axis::linear("flexible mode", ""),
            vec![panel],
        )],
        ..Claim::of(named)
    })
}

/// Returns what is asked of the condensed modes, in % off.
fn condensation_criteria(off: &[f64]) -> Vec<Criterion> {
    vec![
        Criterion::at_most(
            "largest |off| of the first three modes, %",
            "kept",
            off.iter().take(3).map(|v| v.abs()).fold(0.0, f64::max),
            1.0,
            "the control band ends below the third mode",
        ),
        Criterion::at_least(
            "lowest mode off, % (condensation never softens)",
            "above 0",
            off.first().copied().unwrap_or(f64::NAN),
            -1e-6,
            "a constraint raises frequencies; below 0 only rounding is allowed",
        ),
    ]
}
