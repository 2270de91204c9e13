//! The report of a whole design: the verification's, then the plant that was designed for, the weights and the certificates.

use counterpoise_lti::{Error, Response, StateSpace};
use counterpoise_models::plant::LinearPlant;
use counterpoise_pipeline::{Designed, Reduced};
use counterpoise_synth::{Certified, Channel, Cost, Equation, Feedforward, Specification, Weight};

use crate::bode::{BodeCurve, Phase, bode};
use crate::evidence::PLANT;
use crate::verification::{Context, of_verification};
use crate::{Cell, Column, Report, Section, Table, Tone};
use counterpoise_plot::number::short;
use counterpoise_plot::{Colour, Figure};

/// Residuals of an equation are good below this.
const GOOD_RESIDUAL: f64 = 1e-8;
/// Predicted and achieved cost agree within this.
const GOOD_COST: f64 = 1e-6;
/// Heading of the section with the weights.
pub const WEIGHTS: &str = "Weights";
const POINTS: usize = 500;
const LOWEST_HZ: f64 = 0.02;
const HIGHEST_HZ: f64 = 500.0;

/// The report of a design.
///
/// # Errors
/// A frequency response that does not exist.
pub fn of_design(designed: &Designed, mut context: Context) -> Result<Report, Error> {
    let mut more = vec![
        reduction_section(designed)?,
        weight_section(&designed.synthesised.design.specification),
        certificate_section(designed),
    ];
    more.append(&mut context.more);
    let mut report = of_verification(designed.verified.verification(), Context { more, ..context });
    report.sections.retain(|section| section.heading != PLANT);
    Ok(report)
}

fn rates_hz() -> Vec<f64> {
    let ratio = (HIGHEST_HZ / LOWEST_HZ).ln() / (POINTS - 1) as f64;
    (0..POINTS).map(|k| LOWEST_HZ * (ratio * k as f64).exp()).collect()
}

fn response(system: &StateSpace, input: usize) -> Result<Vec<(f64, f64, f64)>, Error> {
    let frequency = rates_hz();
    let rates: Vec<f64> = frequency.iter().map(|f| std::f64::consts::TAU * f).collect();
    let all = Response::of(system)?.at_all(&rates)?;
    let hub = |k: usize| all[k][(LinearPlant::HUB_RATE, input)];
    Ok((0..rates.len()).map(|k| (frequency[k], hub(k).re, hub(k).im)).collect())
}

fn reduction_section(designed: &Designed) -> Result<Section, Error> {
    let (full, reduced) = (&designed.modelled.linear.system, &designed.reduced);
    let mut figures = Vec::new();
    for (input, name) in [
        (LinearPlant::CONTROL, "control"),
        (LinearPlant::HEAVE, "heave"),
        (LinearPlant::PITCH_RATE, "pitch rate"),
    ] {
        let curves = [
            BodeCurve::new(
                &format!("full plant, order {}", full.order()),
                Colour::Muted,
                response(full, input)?,
            ),
            BodeCurve::new(
                &format!("design plant, order {}", reduced.system.order()),
                Colour::First,
                response(&reduced.system, input)?,
            )
            .dashed(),
        ];
        figures.push(bode(&format!("Hub rate for {name}"), "", &curves, Phase::Shown, Vec::new()));
    }
    let mut section =
        Section::new("Plant and design plant").saying(reduction_words(reduced)).showing(figures);
    section.text.extend(reduced.warnings.iter().cloned());
    Ok(section)
}

fn reduction_words(reduced: &Reduced) -> String {
    let (before, after) = (reduced.order_before, reduced.system.order());
    if before == after {
        return format!("The design took the plant as it is, order {before}.");
    }
    let error = reduced.error.map_or(String::new(), |(size, rate)| {
        format!(" Largest error {} at {} Hz", short(size), short(rate / std::f64::consts::TAU))
    });
    let bound = reduced.bound.map_or(String::new(), |bound| format!(", bound {}", short(bound)));
    format!("Order {before} was reduced to {after} ({:?}).{error}{bound}.", reduced.method)
}

/// The weights in pictures, with their meaning in words.
pub fn weight_section(asked: &Specification) -> Section {
    let mut section = Section::new(WEIGHTS)
        .saying(format!(
            "Feedback: {}. {}.",
            asked.feedback.error.meaning("error"),
            capital(&asked.feedback.control.meaning("control"))
        ))
        .showing([weight_figure(
            "Feedback",
            &[("error", &asked.feedback.error), ("control", &asked.feedback.control)],
        )]);
    for (name, part) in [("Heave feedforward", &asked.heave), ("Pitch feedforward", &asked.pitch)] {
        if let Some(weights) = part {
            let three = [
                ("error", &weights.error),
                ("control", &weights.control),
                ("disturbance", &weights.generator),
            ];
            let (error, control) = (weights.error.meaning("hub rate"), weights.control.meaning("control"));
            section = section
                .saying(format!("{name}: {error}. {}.", capital(&control)))
                .showing([weight_figure(name, &three)]);
        }
    }
    section
}

/// The sentence with a capital in front.
fn capital(sentence: &str) -> String {
    let mut letters = sentence.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

fn weight_figure(name: &str, weights: &[(&str, &Weight)]) -> Figure {
    let curve = |(what, weight): &(&str, &Weight), colour| {
        let value = |f: f64| {
            let h = weight.response(std::f64::consts::TAU * f);
            (f, h.re, h.im)
        };
        BodeCurve::new(what, colour, rates_hz().into_iter().map(value).collect())
    };
    let curves: Vec<BodeCurve> =
        weights.iter().zip(Colour::CYCLE).map(|(weight, colour)| curve(weight, colour)).collect();
    bode(&format!("{name}: weights"), "", &curves, Phase::Hidden, Vec::new())
}

fn certificate_section(designed: &Designed) -> Section {
    let design = &designed.synthesised.design;
    let columns = [Column::Text("certificate"), Column::Number("value"), Column::Text("verdict")];
    let mut table = Table::new("Certificates", &columns);
    table.rows.push(equation_row("feedback, regulator equation", &design.feedback.regulator));
    table.rows.push(equation_row("feedback, filter equation", &design.feedback.filter));
    table.rows.extend(cost_row("feedback", design.feedback.cost));
    for (name, channel) in [("heave", Channel::Heave), ("pitch", Channel::Pitch)] {
        design.part(channel).into_iter().for_each(|part| table.rows.extend(feedforward_rows(name, part)));
    }
    designed.synthesised.sampled.certified.iter().for_each(|part| table.rows.extend(sampled_rows(part)));
    let radius = designed.synthesised.sampled.closed_loop.iter().map(|pole| pole.norm()).fold(0.0, f64::max);
    table.rows.push(row("largest pole of the sampled loop on the design plant", radius, radius < 1.0));
    let verified =
        designed.verified.verification().evidence.poles.iter().map(|pole| pole.norm()).fold(0.0, f64::max);
    table.rows.push(row("largest pole of the sampled loop on the full plant", verified, verified < 1.0));
    let warnings = designed.synthesised.warnings.iter().map(ToString::to_string);
    let mut section = Section::new("Certificates")
        .saying("Residuals are relative to the terms of their equation; costs are predicted by the equations and found on the assembled loop.")
        .listing(table);
    section.text.extend(warnings);
    section
}

fn row(name: &str, value: f64, good: bool) -> Vec<Cell> {
    let verdict = if good {
        Cell::Verdict(Tone::Good, "good".to_owned())
    } else {
        Cell::Verdict(Tone::Bad, "look here".to_owned())
    };
    vec![Cell::text(name), Cell::number(value), verdict]
}

fn equation_row(name: &str, equation: &Equation) -> Vec<Cell> {
    row(&format!("{name}: residual"), equation.relative_residual, equation.relative_residual < GOOD_RESIDUAL)
}

fn cost_row(name: &str, cost: Cost) -> Option<Vec<Cell>> {
    let difference = cost.relative_difference()?;
    Some(row(
        &format!("{name}: predicted against achieved cost, relative"),
        difference,
        difference < GOOD_COST,
    ))
}

fn sampled_rows(part: &Certified) -> Vec<Vec<Cell>> {
    let name = format!("{} in sampled time", part.part);
    let mut rows = vec![equation_row(&format!("{name}, regulator equation"), &part.regulator)];
    rows.extend(part.filter.as_ref().map(|filter| equation_row(&format!("{name}, filter equation"), filter)));
    rows.extend(cost_row(&name, part.cost));
    rows
}

fn feedforward_rows(name: &str, part: &Feedforward) -> Vec<Vec<Cell>> {
    let mut rows = vec![equation_row(&format!("{name} feedforward, regulator equation"), &part.regulator)];
    rows.extend(
        part.filter
            .as_ref()
            .map(|filter| equation_row(&format!("{name} feedforward, filter equation"), filter)),
    );
    let residual = part.sylvester_residual;
    rows.push(row(
        &format!("{name} feedforward, Sylvester equation: residual"),
        residual,
        residual < GOOD_RESIDUAL,
    ));
    rows.extend(cost_row(&format!("{name} feedforward"), part.cost));
    rows
}
