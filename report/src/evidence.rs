//! The evidence of a verification as sections with figures and tables.

use crate::wording::figures::{describe_figure, describe_unmeasured};
use counterpoise_models::ControlledQuantity;
use counterpoise_verify::linear_loop::{ResponseCurve, frequency::Rejection};
use counterpoise_verify::{
    Arrangement, Experiment, History, HistoryColumn, Model, Source, Value, Verification,
};

use crate::bode::{BodeCurve, PhasePanel, bode_figure, response_of};
use crate::triangle;
use crate::wording::capitalise_first;
use crate::{ReportCell, ReportColumn, ReportSection, ReportTable};
use counterpoise_plot::number::short_number;
use counterpoise_plot::{Axis, Colour, Dash, Figure, Mark, Panel, Series};

const ARRANGEMENTS: [(Arrangement, &str, Colour); 3] = [
    (Arrangement::Uncontrolled, "without control", Colour::Muted),
    (Arrangement::Feedback, "feedback", Colour::Second),
    (Arrangement::Compensated, "feedback + feedforward", Colour::First),
];

const SOURCES: [(Source, &str); 4] = [
    (Source::Heave, "heave"),
    (Source::Pitch, "pitch"),
    (Source::Both, "heave and pitch"),
    (Source::Road, "the road"),
];

/// Heading of the section with the plant.
pub const PLANT: &str = "Plant";

/// Returns the sections in the order in which a reader asks.
pub fn evidence_sections(found: &Verification) -> Vec<ReportSection> {
    let first = [loop_section(found), step_section(found)];
    let rest = [
        disturbance_section(found),
        rejection_section(found),
        controller_section(found),
        plant_section(found),
    ];
    first.into_iter().chain(triangle::triangle_section(found)).chain(rest).collect()
}

fn curve_points<'a>(
    frequency_hz: &'a [f64],
    curve: &'a ResponseCurve,
) -> impl Iterator<Item = [f64; 3]> + 'a {
    frequency_hz.iter().zip(&curve.response).map(|(f, h)| [*f, h.re, h.im])
}

fn bode_curves(found: &Verification, curves: &[ResponseCurve]) -> Vec<BodeCurve> {
    let frequency = &found.evidence.curves.frequency_hz;
    let coloured = curves.iter().zip(Colour::CYCLE);
    coloured
        .map(|(curve, colour)| {
            BodeCurve::new(response_of(&curve.name, curve_points(frequency, curve)), colour)
        })
        .collect()
}

fn loop_section(found: &Verification) -> ReportSection {
    let curves = &found.evidence.curves;
    let broken = bode_curves(found, std::slice::from_ref(&curves.broken));
    let mut figure =
        bode_figure("Loop broken at the plant's input", "", &broken, PhasePanel::Shown, gain_marks(found));
    if let Some(phase) = figure.panels_mut().get_mut(1) {
        phase.marks = phase_marks(found);
    }
    let sensitivities = bode_curves(found, &curves.sensitivities);
    let ms = found.evidence.margins.ms;
    let peak = Mark::Point {
        x: ms.rate_rad_s / std::f64::consts::TAU,
        y: found.evidence.largest_sensitivity_db(),
        text: format!(
            "Ms {} at {} Hz",
            short_number(ms.value),
            short_number(ms.rate_rad_s / std::f64::consts::TAU)
        ),
        colour: Colour::Second,
    };
    let sensitivity = bode_figure(
        "Sensitivity and complementary sensitivity",
        "",
        &sensitivities,
        PhasePanel::Hidden,
        vec![peak],
    );
    ReportSection::new("Loop and margins")
        .with_text("The discrete controller as exported, with the plant and its sensors sampled exactly.")
        .with_figures([figure, sensitivity])
        .with_table(margin_table(found))
}

/// Returns the nearest crossings of -180 degrees, as points of the magnitude.
fn gain_marks(found: &Verification) -> Vec<Mark> {
    let margins = &found.evidence.margins;
    let nearest = [margins.gain_increase(), margins.gain_decrease()];
    let point = |db: f64, rate: f64, text: String| Mark::Point {
        x: rate / std::f64::consts::TAU,
        y: -db,
        text,
        colour: Colour::Second,
    };
    let all =
        nearest.into_iter().flatten().filter(|gain| gain.rate_rad_s > 0.0 && gain.rate_rad_s.is_finite());
    let marks = all.map(|gain| {
        let hz = gain.rate_rad_s / std::f64::consts::TAU;
        point(
            gain.db,
            gain.rate_rad_s,
            format!("gain margin {} dB at {} Hz", short_number(gain.db), short_number(hz)),
        )
    });
    marks.chain([Mark::Level { y: 0.0, text: String::new() }]).collect()
}

/// Returns the crossing of 0 dB with the smallest phase margin, as a point of the phase.
fn phase_marks(found: &Verification) -> Vec<Mark> {
    let Some(phase) = found.evidence.margins.phase_margin() else { return Vec::new() };
    let hz = phase.rate_rad_s / std::f64::consts::TAU;
    let text = format!("phase margin {} deg at {} Hz", short_number(phase.deg), short_number(hz));
    let at = Mark::Point { x: hz, y: -180.0 + phase.deg, text, colour: Colour::Third };
    vec![at, Mark::Level { y: -180.0, text: String::new() }]
}

fn margin_table(found: &Verification) -> ReportTable {
    let margins = &found.evidence.margins;
    let hz = |rate: f64| rate / std::f64::consts::TAU;
    let columns = [
        ReportColumn::Text("crossing"),
        ReportColumn::Number("frequency [Hz]"),
        ReportColumn::Number("margin"),
        ReportColumn::Text("unit"),
    ];
    let mut table = ReportTable::new("Every crossing", &columns);
    let row = |what: &str, rate: f64, margin: f64, unit: &str| {
        vec![
            ReportCell::text(what),
            ReportCell::number(hz(rate)),
            ReportCell::number(margin),
            ReportCell::text(unit),
        ]
    };
    table
        .rows
        .extend(margins.gain.iter().map(|gain| row("\u{2212}180 degrees", gain.rate_rad_s, gain.db, "dB")));
    table.rows.extend(margins.phase.iter().map(|phase| row("0 dB", phase.rate_rad_s, phase.deg, "deg")));
    table.rows.push(row("disk", margins.disk.rate_rad_s, margins.disk.alpha, ""));
    table
}

fn step_section(found: &Verification) -> ReportSection {
    let control = step_column(found, "Control during the step", "control", "V", HistoryColumn::Control);
    let controlled = found.controlled_quantity();
    let (name, unit) = (controlled.tip_name(), controlled.tip_unit());
    let title = format!("{} during the step", capitalise_first(&name));
    let tip = step_column(found, &title, &name, unit, HistoryColumn::TipRate);
    ReportSection::new(&format!("Step of the demanded {}", controlled.name()))
        .with_figures(step_figure(found, 220.0))
        .with_figures(control)
        .with_figures(tip)
}

const MODELS: [(Model, &str, Colour, Dash); 2] = [
    (Model::Linear, "linear plant", Colour::Muted, Dash::Dashed),
    (Model::Nonlinear, "nonlinear plant", Colour::First, Dash::Solid),
];

fn steps(found: &Verification) -> impl Iterator<Item = (&History, &'static str, Colour, Dash)> {
    MODELS.iter().filter_map(|(model, name, colour, dash)| {
        found.history(*model, Experiment::Step).map(|history| (history, *name, *colour, *dash))
    })
}

fn pair_with_time(time_s: &[f64], column: &[f64]) -> Vec<(f64, f64)> {
    time_s.iter().copied().zip(column.iter().copied()).collect()
}

/// Returns what the loop controls after a step, on both plants.
pub fn step_figure(found: &Verification, height: f64) -> Option<Figure> {
    let mut series: Vec<Series> = steps(found)
        .map(|(history, name, colour, dash)| {
            let points = pair_with_time(history.time_s(), history.hub_rate_rad_s());
            Series::new(name, colour, dash, points)
        })
        .collect();
    let first = steps(found).next()?.0;
    series.push(Series::dotted_line(
        "demand",
        Colour::Third,
        pair_with_time(first.time_s(), first.demand_rad_s()),
    ));
    let panel = Panel::new(controlled_axis(found), series).with_height(height);
    Some(Figure::new("Step of the demand", Axis::linear("time", "s"), vec![panel]))
}

fn step_column(
    found: &Verification,
    title: &str,
    label: &str,
    unit: &str,
    column: HistoryColumn,
) -> Option<Figure> {
    steps(found).next()?;
    let series = steps(found).map(|(history, name, colour, dash)| {
        let points = pair_with_time(history.time_s(), history.signals.column(column));
        Series::new(name, colour, dash, points)
    });
    let panel = Panel::new(Axis::linear(label, unit), series.collect()).with_height(220.0);
    Some(Figure::new(title, Axis::linear("time", "s"), vec![panel]))
}

fn disturbance_section(found: &Verification) -> ReportSection {
    let mut section = ReportSection::new("Platform in motion").with_text(
        "Without control, only the constant voltage that holds the out-of-balance acts; left to itself the mechanism would fall.",
    );
    for (model, ..) in MODELS.iter().rev() {
        let figures =
            SOURCES.iter().filter_map(|(source, _)| disturbance_figure(found, *model, *source, 180.0));
        section = section.with_figures(figures);
    }
    section
}

/// Returns what the loop controls while the platform moves, in the three arrangements; the second panel leaves out the one without
/// control, whose size would hide the others.
pub fn disturbance_figure(found: &Verification, model: Model, source: Source, height: f64) -> Option<Figure> {
    let run = |arrangement| found.history(model, Experiment::Disturbance(source, arrangement));
    let series: Vec<Series> = ARRANGEMENTS
        .iter()
        .filter_map(|(arrangement, name, colour)| {
            run(*arrangement)
                .map(|h| Series::solid_line(name, *colour, pair_with_time(h.time_s(), h.hub_rate_rad_s())))
        })
        .collect();
    let controlled: Vec<Series> = series.iter().filter(|s| s.colour != Colour::Muted).cloned().collect();
    if series.is_empty() {
        return None;
    }
    let name = SOURCES.iter().find(|row| row.0 == source).map_or("", |row| row.1);
    let plant = MODELS.iter().find(|row| row.0 == model).map_or("", |row| row.1);
    let panels = vec![
        Panel::new(controlled_axis(found), series).with_height(height),
        Panel::new(controlled_axis(found), controlled).with_height(height),
    ];
    let caption = "The lower panel shows the controlled loops alone.";
    let title = format!("{} under {name}, {plant}", capitalise_first(found.controlled_quantity().name()));
    Some(Figure::new(&title, Axis::linear("time", "s"), panels).with_caption(caption))
}

fn rejection_section(found: &Verification) -> ReportSection {
    let figure = |source: Source, title: &str, unit: &str, marks: Vec<Mark>| {
        let curves: Vec<BodeCurve> = ARRANGEMENTS
            .iter()
            .filter_map(|(arrangement, name, colour)| {
                rejection_curve(found, source, *arrangement, name, *colour)
            })
            .collect();
        bode_figure(title, unit, &curves, PhasePanel::Hidden, marks)
    };
    let unity = vec![Mark::Level { y: 0.0, text: String::new() }];
    let controlled = found.controlled_quantity();
    let (name, unit) = (controlled.name(), controlled.unit());
    let over_pitch = over_base_rate(found);
    ReportSection::new("Disturbance rejection ratio")
        .with_text(format!("{} over platform motion, linear plant; low is good. Exact for a tone at each frequency, hold and sampling included.", capitalise_first(name)))
        .with_figures([
            figure(Source::Pitch, &format!("DRR: {name} over {}", controlled.base_rate_name()), &over_pitch, unity),
            figure(
                Source::Heave,
                &format!("DRR: {name} over heave"),
                &format!("{unit} per m/s\u{B2}"),
                Vec::new(),
            ),
        ])
}

fn rejection_curve(
    found: &Verification,
    source: Source,
    arrangement: Arrangement,
    name: &str,
    colour: Colour,
) -> Option<BodeCurve> {
    let matches = |r: &&Rejection| (r.source, r.arrangement) == (source, arrangement);
    let rejection = found.evidence.curves.rejection.iter().find(matches)?;
    let frequency = &found.evidence.curves.frequency_hz;
    let points = frequency.iter().zip(&rejection.response).map(|(f, h)| [*f, h.re, h.im]);
    Some(BodeCurve::new(response_of(name, points), colour))
}

fn controller_section(found: &Verification) -> ReportSection {
    let controlled = found.controlled_quantity();
    let of_error = match controlled == ControlledQuantity::RATE {
        true => "V s/rad".to_owned(),
        false => format!("V per {}", controlled.unit()),
    };
    let units = [of_error.as_str(), "V s\u{B2}/m", "V s/rad"];
    let curves = &found.evidence.curves;
    let present = curves
        .controller
        .iter()
        .zip(units)
        .filter(|(curve, _)| curve.response.iter().any(|h| h.norm() > 0.0));
    let figures = present.map(|(curve, unit)| {
        let response = response_of("", curve_points(&curves.frequency_hz, curve));
        bode_figure(
            &capitalise_first(&curve.name),
            unit,
            &[BodeCurve::new(response, Colour::First)],
            PhasePanel::Shown,
            Vec::new(),
        )
    });
    ReportSection::new("Controllers")
        .with_text("The discrete transfer functions as exported, from the readings to the control.")
        .with_figures(figures)
}

fn plant_section(found: &Verification) -> ReportSection {
    let unit = found.controlled_quantity().unit();
    let units = [format!("{unit} per V"), format!("{unit} per m/s\u{B2}"), over_base_rate(found)];
    let hub = capitalise_first(found.controlled_quantity().name());
    let curves = &found.evidence.curves;
    let figures = curves.plant.iter().zip(units).map(|(curve, unit)| {
        let response = response_of("", curve_points(&curves.frequency_hz, curve));
        let title = format!("{hub} for {}", curve.name);
        bode_figure(&title, &unit, &[BodeCurve::new(response, Colour::First)], PhasePanel::Shown, Vec::new())
    });
    ReportSection::new(PLANT)
        .with_text("The linear plant that was verified, without sensors.")
        .with_figures(figures)
}

/// Returns the axis of what the loop controls.
fn controlled_axis(found: &Verification) -> Axis {
    Axis::linear(found.controlled_quantity().name(), found.controlled_quantity().unit())
}

/// Returns the unit of what the loop controls over the rate of the base; empty for a rate over a rate.
fn over_base_rate(found: &Verification) -> String {
    let controlled = found.controlled_quantity();
    match (controlled.unit(), controlled.base_rate_unit()) {
        (unit, base) if unit == base => String::new(),
        (unit, base) => format!("{unit} per {base}"),
    }
}

/// Returns every figure with its key: what a requirement can name.
pub fn figure_section(found: &Verification) -> ReportSection {
    let mut table = ReportTable::new(
        "",
        &[
            ReportColumn::Text("figure"),
            ReportColumn::Number("value"),
            ReportColumn::Text("unit"),
            ReportColumn::Text("key"),
        ],
    );
    for measured in &found.figures {
        let value = match &measured.value {
            Value::Is(number) => ReportCell::number(*number),
            Value::Absent { why } => ReportCell::text(describe_unmeasured(why)),
        };
        let (name, key) = (
            ReportCell::text(describe_figure(measured.figure, found.controlled_quantity())),
            ReportCell::text(measured.figure.key_in(found.controlled_quantity())),
        );
        table.rows.push(vec![
            name,
            value,
            ReportCell::text(measured.figure.unit(found.controlled_quantity())),
            key,
        ]);
    }
    ReportSection::new("All figures").with_table(table)
}
