//! The claim that designs on either model of the structure perform alike.

use counterpoise_controller::Controller;
use counterpoise_lti::StateSpace;
use counterpoise_models::plant::Plant;
use counterpoise_report::wording::code_header::HeaderText;
use counterpoise_verify::robustness::figures_of;
use counterpoise_verify::{
    Arrangement, Experiment, Model, PerformanceFigure, Quantity, Source, StepFigure, Value,
};

use super::drawing::{
    ClaimCurve, frequency_axis, gain_db, hub_from, hub_panel, hub_rates, make_figure, make_panel, time_axis,
};
use super::tested_design::{largest_db, rate_grid};
use super::{Claim, Criterion, TestedDesign};
use crate::tolerance::{ALIKE_DB, MARGIN_ALIKE_DB, OVERSHOOT_ALIKE, RESIDUAL_ALIKE};
use counterpoise_pipeline::PipelineError;
use counterpoise_plot::{Axis, Figure as Drawing};
use counterpoise_project::resolve::model::StructureChoice;

/// Control band, Hz.
const BAND_HZ: [f64; 2] = [0.1, 10.0];

/// Returns row C9: designed on either model, run on the finer one, linear and nonlinear.
///
/// # Errors
/// Those of the pipeline.
pub fn designs_on_two_models(tested: &TestedDesign<'_>) -> Result<Claim, PipelineError> {
    let mut project = tested.project.clone();
    (project.model.structure, project.model.modes) = (StructureChoice::Beam, 3);
    project.verify.iter_mut().for_each(|verify| verify.road = None);
    let other = counterpoise_pipeline::run_stages(&project, &HeaderText, tested.world)?;
    let linear = |c: &Controller| {
        c.linear(c.parts().design_out_of_balance_kg_m).map_err(counterpoise_verify::Error::from)
    };
    let both = [linear(tested.controller())?, linear(other.verified.controller())?];
    let mut apart = [0.0; 3];
    for (difference, input) in apart.iter_mut().zip([1, 3, 2]) {
        *difference = largest_db(&both[0], &both[1], input, BAND_HZ)?;
    }
    let fine = &other.modelled.plant;
    let spillover = counterpoise_verify::verify_linear(fine, tested.controller(), &tested.procedure, &[])?;
    let radius = spillover.evidence.poles.iter().map(|pole| pole.norm()).fold(0.0, f64::max);
    let margin_db = [
        spillover.evidence.margins.gain_margin_db(),
        other.verified.verification().evidence.margins.gain_margin_db(),
    ];
    let ran = [
        on_elements(tested, fine, tested.controller())?,
        on_elements(tested, fine, other.verified.controller())?,
    ];
    Ok(Claim {
        id: "C9",
        title: "designed on either model",
        source: "6.4, fig 6-8",
        says: "controllers from the lumped and the finite-element model are nearly the same and perform alike; no spillover",
        measured: format!(
            "feedback / heave / pitch differ by {:.2} / {:.2} / {:.2} dB to {} Hz; on the finite-element plant, designed on lumped against on elements: gain margin {:.1} against {:.1} dB (largest pole {radius:.5}); with friction and backlash overshoot {:.1} against {:.1} %, RMS hub rate {:.2} against {:.2} mrad/s under heave and pitch",
            apart[0],
            apart[1],
            apart[2],
            BAND_HZ[1],
            margin_db[0],
            margin_db[1],
            ran[0][0],
            ran[1][0],
            ran[0][1],
            ran[1][1]
        ),
        criteria: designs_criteria(&apart, radius, (margin_db[0] - margin_db[1]).abs(), &ran),
        why: String::new(),
        drawings: designs_on_two_models_figures(tested, fine, &both, other.verified.controller())?,
    })
}

/// Overshoot in % and RMS hub rate in mrad/s under heave and pitch on a nonlinear plant.
fn on_elements(
    tested: &TestedDesign<'_>,
    plant: &Plant,
    controller: &Controller,
) -> Result<[f64; 2], PipelineError> {
    let both = PerformanceFigure::Disturbance(
        Model::Nonlinear,
        Source::Both,
        Arrangement::Compensated,
        Quantity::HubRms,
    );
    let wanted = [PerformanceFigure::Step(Model::Nonlinear, StepFigure::Overshoot), both];
    let values = figures_of(plant, controller, &tested.procedure, &wanted)?;
    let number = |k: usize| if let Value::Is(number) = values[k] { number } else { f64::NAN };
    Ok([number(0), 1e3 * number(1)])
}

fn designs_on_two_models_figures(
    tested: &TestedDesign<'_>,
    fine: &Plant,
    linear: &[StateSpace; 2],
    other: &Controller,
) -> Result<Vec<Drawing>, PipelineError> {
    let drawn = rate_grid([0.1, 100.0]);
    let names = ["designed on two inertias", "designed on finite elements"];
    let mut panels = Vec::new();
    for (input, name) in [(1, "feedback"), (3, "heave"), (2, "pitch")] {
        let curves = vec![
            ClaimCurve::line(names[0], gain_db(&linear[0], input, &drawn)?),
            ClaimCurve::reference(names[1], gain_db(&linear[1], input, &drawn)?),
        ];
        panels
            .push(make_panel(Axis::linear(name, "dB"), curves).with_instant(BAND_HZ[1], "compared to here"));
    }
    let controllers = make_figure(
        "The three controllers by both designs (V s/rad, V s²/m, V s/rad)",
        frequency_axis(),
        panels,
    );
    let mut simulator = counterpoise_simulate::Simulator::new(fine)?;
    let mut run = |controller: &Controller, experiment| {
        counterpoise_verify::nonlinear_runs::run_history(
            &mut simulator,
            controller,
            &tested.procedure,
            experiment,
        )
    };
    let moving = Experiment::Disturbance(Source::Both, Arrangement::Compensated);
    let steps = [run(tested.controller(), Experiment::Step)?, run(other, Experiment::Step)?];
    let motions = [run(tested.controller(), moving)?, run(other, moving)?];
    let step = hub_panel(vec![
        ClaimCurve::line(names[0], hub_rates(&steps[0])),
        ClaimCurve::reference(names[1], hub_rates(&steps[1])),
    ]);
    let from = tested.procedure.settle_s;
    let motion = hub_panel(vec![
        ClaimCurve::line(names[0], hub_from(&motions[0], from)),
        ClaimCurve::reference(names[1], hub_from(&motions[1], from)),
    ]);
    Ok(vec![
        controllers,
        make_figure("Step on the nonlinear finite-element plant", time_axis(), vec![step]),
        make_figure("Heave and pitch on the nonlinear finite-element plant", time_axis(), vec![motion]),
    ])
}

fn designs_criteria(
    apart_db: &[f64],
    radius: f64,
    margins_apart_db: f64,
    ran: &[[f64; 2]; 2],
) -> Vec<Criterion> {
    vec![
        Criterion::at_most(
            "largest difference of the three controllers to 10 Hz, dB",
            "nearly the same",
            apart_db.iter().copied().fold(0.0, f64::max),
            ALIKE_DB,
            "2 dB is what two careful readings of the figure differ by",
        ),
        Criterion::at_most(
            "largest pole of the lumped design on the elements",
            "no spillover",
            radius,
            1.0,
            "stable",
        ),
        Criterion::at_most(
            "gain margins apart on the elements, dB",
            "perform alike",
            margins_apart_db,
            MARGIN_ALIKE_DB,
            "a quarter of the margin itself",
        ),
        Criterion::at_most(
            "overshoots apart, percentage points",
            "perform alike",
            (ran[0][0] - ran[1][0]).abs(),
            OVERSHOOT_ALIKE,
            "2 points can be seen in a figure",
        ),
        Criterion::at_most(
            "RMS hub rates apart, relative",
            "perform alike",
            (ran[0][1] / ran[1][1] - 1.0).abs(),
            RESIDUAL_ALIKE,
            "a tenth is a decibel",
        ),
    ]
}
