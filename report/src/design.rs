//! The report of a whole design: the verification's, then the plant that was designed for, the weights and the certificates.

use crate::advice::advice_section;
use crate::wording::certificates::{describe_certified_quantity, describe_cost_source};
use crate::wording::design_findings::describe_design_finding;
use crate::wording::figures::{describe_modulus, drop_small_sign};
use crate::wording::reduction::describe_reduction_warning;
use counterpoise_models::ControlledQuantity;
use counterpoise_pipeline::certificates::Certificate;
use counterpoise_pipeline::design_views::{PlantResponse, WeightResponses};
use counterpoise_pipeline::export::target_proofs::{CompiledCodeTest, StepCosts};
use counterpoise_pipeline::results::{DesignResult, SynthResult};
use counterpoise_pipeline::studies::comparison::TotalCostResult;
use counterpoise_pipeline::{CompletedDesign, FirstDesignResult, ReducedPlant, StageTime, SynthesisStudy};

use crate::adaptation::trial_section;
use crate::bode::{BodeCurve, PhasePanel, bode_figure};
use crate::evidence::PLANT;
use crate::page::ReportOrigin;
use crate::targets::{self, TargetEvidence};
use crate::verification::{VerificationContext, of_verification};
use crate::wording::capitalise_first;
use crate::wording::weights::describe_weights;
use crate::{
    FigureTile, Headline, OutcomeTone, Report, ReportCell, ReportColumn, ReportSection, ReportTable,
    alternatives,
};
use counterpoise_plot::number::short_number;
use counterpoise_plot::{Colour, Figure};
use counterpoise_project::file::NamedChoice;

/// Results of a design that its report shows and that were found outside the pipeline.
#[derive(Debug, Clone, Copy)]
pub struct DesignRun<'a> {
    /// Origin of the report.
    pub origin: &'a ReportOrigin,
    /// Times of the stages.
    pub times: &'a [StageTime],
    /// The compiled code, compared with its model.
    pub proofs: &'a [CompiledCodeTest],
    /// Instructions and memory of a step.
    pub costs: &'a StepCosts,
    /// Why the weights are what they are, if they were chosen.
    pub first_design: Option<&'a FirstDesignResult>,
}

/// Returns the report of a design.
pub fn of_design(designed: &CompletedDesign, result: &DesignResult, run: &DesignRun<'_>) -> Report {
    let stages = &designed.stages;
    let mut more = vec![
        crate::certificate::certificate_section(&stages.stability, &[]),
        reduction_section(&designed.views.plants, &stages.reduced, stages.synthesised.controlled),
        weight_section(&describe_weights(&designed.asked), &designed.views.weights),
        certificate_section(designed, &result.synth),
    ];
    more.extend(advice_section(&designed.advice));
    more.extend(run.first_design.map(crate::first_design::first_design_section));
    more.extend(alternatives::alternatives_sections(
        &designed.comparison,
        &designed.views.families,
        stages.synthesised.controlled,
    ));
    more.extend(designed.two_axes.as_ref().map(crate::two_axes::two_axes_section));
    more.push(order_section(result));
    more.push(crate::check::assumptions_section(&result.model.assumptions, &result.model.assumption_effects));
    let controlled = stages.synthesised.controlled;
    let evidence =
        TargetEvidence { study: &designed.targets, proofs: run.proofs, costs: run.costs, controlled };
    more.push(targets::targets_section(&evidence));
    if stages.all_left_out().next().is_some() {
        let lines = stages.all_left_out().map(ToString::to_string);
        more.push(lines.fold(ReportSection::new("Code that was left out"), ReportSection::with_text));
    }
    if !run.times.is_empty() {
        more.push(times_section(run.times));
    }
    let context = VerificationContext {
        title: designed.identity.name.clone(),
        subtitle: "From the project file to a verified controller".to_owned(),
        loop_view: Some(designed.loop_view.clone()),
        sight_views: designed.sight_views.clone(),
        more,
        provenance: run.origin.provenance(&designed.identity),
    };
    let mut report = of_verification(stages.verified.verification(), &designed.spectra, context);
    report.sections.retain(|section| section.heading != PLANT);
    report.sections.extend(designed.adaptation.as_ref().map(trial_section));
    report.with_command(&run.origin.command)
}

/// Returns the report of a synthesis: the weights, and the design beside its alternatives.
pub fn of_synthesis(study: &SynthesisStudy, result: &SynthResult, origin: &ReportOrigin) -> Report {
    let mut sections = alternatives::alternatives_sections(
        &study.comparison,
        &study.views.families,
        study.synthesised.controlled,
    );
    sections.push(weight_section(&describe_weights(&study.asked), &study.views.weights));
    let tile = |(name, order): (&String, &usize)| FigureTile::plain(name, order.to_string(), "states");
    let report = Report {
        title: study.identity.name.clone(),
        subtitle: "The design, and its alternatives".to_owned(),
        headline: Headline {
            tone: OutcomeTone::Neutral,
            text: format!(
                "The sampled loop is stable: largest pole modulus {:.6}",
                result.figures.largest_pole_modulus
            ),
            detail: format!("Design plant of order {}.", result.figures.plant_order),
        },
        tiles: result.figures.path_orders.iter().map(tile).collect(),
        verdicts: ReportTable::new("", &[]),
        glance: Vec::new(),
        sections,
        provenance: origin.provenance(&study.identity),
    };
    report.with_command(&origin.command)
}

fn reduction_section(
    plants: &[PlantResponse],
    reduced: &ReducedPlant,
    controlled: ControlledQuantity,
) -> ReportSection {
    let hub = capitalise_first(controlled.motion().name());
    let figure = |plant: &PlantResponse| {
        let curves = [
            BodeCurve::new(plant.full.clone(), Colour::Muted),
            BodeCurve::new(plant.reduced.clone(), Colour::First).with_dashes(),
        ];
        bode_figure(&format!("{hub} for {}", plant.input), "", &curves, PhasePanel::Shown, Vec::new())
    };
    let mut section = ReportSection::new("Plant and design plant")
        .with_text(reduction_words(reduced))
        .with_figures(plants.iter().map(figure));
    section.text.extend(reduced.warnings.iter().map(describe_reduction_warning));
    section
}

fn reduction_words(reduced: &ReducedPlant) -> String {
    let (before, after) = (reduced.order_before(), reduced.system.order());
    if before == after {
        return format!("The design took the plant as it is, order {before}.");
    }
    let error = reduced.error.map_or(String::new(), |(size, rate)| {
        format!(" Largest error {} at {} Hz", short_number(size), short_number(rate / std::f64::consts::TAU))
    });
    let bound = reduced.bound.map_or(String::new(), |bound| format!(", bound {}", short_number(bound)));
    format!(
        "Order {before} was reduced to {after} ({}).{error}{bound}.",
        capitalise_first(reduced.method.name())
    )
}

/// Returns the section of the weights: their meaning in words, and their frequency responses.
pub fn weight_section(lines: &[String], weights: &[WeightResponses]) -> ReportSection {
    let section =
        lines.iter().fold(ReportSection::new("Weights"), |section, line| section.with_text(line.as_str()));
    section.with_figures(weights.iter().map(weight_figure))
}

fn weight_figure(part: &WeightResponses) -> Figure {
    let curves: Vec<BodeCurve> = part
        .curves
        .iter()
        .zip(Colour::CYCLE)
        .map(|(response, colour)| BodeCurve::new(response.clone(), colour))
        .collect();
    bode_figure(&format!("{}: weights", part.part), "", &curves, PhasePanel::Hidden, Vec::new())
}

fn certificate_section(designed: &CompletedDesign, result: &SynthResult) -> ReportSection {
    let columns =
        [ReportColumn::Text("certificate"), ReportColumn::Number("value"), ReportColumn::Text("verdict")];
    let mut table = ReportTable::new("Certificates", &columns);
    table.rows = designed.certificates.iter().map(certificate_row).collect();
    let mut section = ReportSection::new("Certificates")
        .with_text("Residuals are relative to the terms of their equation; costs are predicted by the equations and found on the assembled loop.")
        .with_table(table);
    section.text.extend(result.warnings.iter().map(describe_design_finding));
    section.tables.extend(designed.comparison.total_cost.as_ref().map(total_cost_table));
    section
}

/// The cost of the assembled loop, and whether another gain of a part lowers it.
fn total_cost_table(cost: &TotalCostResult) -> ReportTable {
    let columns = [
        ReportColumn::Text("disturbances of"),
        ReportColumn::Number("cost"),
        ReportColumn::Number("slope per unit of its gain"),
        ReportColumn::Number("best gain"),
        ReportColumn::Number("lowers the total by [%]"),
    ];
    let title = format!("Total cost of the assembled loop: {}", short_number(cost.total));
    let mut table = ReportTable::new(&title, &columns);
    let optional = |value: Option<f64>| value.map_or(ReportCell::text(""), ReportCell::number);
    for row in &cost.parts {
        table.rows.push(vec![
            ReportCell::text(describe_cost_source(row.part)),
            ReportCell::number(row.cost),
            ReportCell::text(format!("{:+.4}", drop_small_sign(row.slope))),
            optional(row.best_gain),
            optional(row.gained_percent),
        ]);
    }
    table
}

fn certificate_row(certificate: &Certificate) -> Vec<ReportCell> {
    let verdict = if certificate.holds {
        ReportCell::Verdict(OutcomeTone::Good, "good".to_owned())
    } else {
        ReportCell::Verdict(OutcomeTone::Bad, "outside its limit".to_owned())
    };
    let name = describe_certified_quantity(certificate.quantity);
    vec![ReportCell::text(name), ReportCell::number(certificate.value), verdict]
}

fn order_section(result: &DesignResult) -> ReportSection {
    let mut table = ReportTable::new("", &[ReportColumn::Text("certificate"), ReportColumn::Number("value")]);
    let mut row =
        |name: &str, value: String| table.rows.push(vec![ReportCell::text(name), ReportCell::text(value)]);
    row("order of the plant", result.model.order.to_string());
    row(
        "order of the design plant, sensors and delay included",
        result.synth.figures.plant_order.to_string(),
    );
    for (name, order) in &result.synth.figures.path_orders {
        row(&format!("states of the {name} path"), order.to_string());
    }
    let radius = result.synth.figures.largest_pole_modulus;
    row("largest modulus of a pole of the closed sampled loop", describe_modulus(radius));
    if let Some(difference) = result.synth.figures.cost_difference {
        row("predicted cost against cost of the assembled loop, relative", format!("{difference:.1e}"));
    }
    let section = ReportSection::new("Orders").with_table(table);
    let of_design = result.synth.warnings.iter().map(describe_design_finding);
    let remarks = of_design.chain(result.reduce.warnings.iter().map(describe_reduction_warning));
    remarks.fold(section, |section, warning| section.with_text(format!("Warning: {warning}")))
}

fn times_section(times: &[StageTime]) -> ReportSection {
    let mut table = ReportTable::new("", &[ReportColumn::Text("stage"), ReportColumn::Number("time [ms]")]);
    for time in times {
        table.rows.push(vec![
            ReportCell::text(time.name.clone()),
            ReportCell::text(format!("{:.1}", time.milliseconds)),
        ]);
    }
    ReportSection::new("What each stage took").with_table(table)
}
