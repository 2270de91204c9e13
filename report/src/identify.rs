//! The report of an identification: the numbers with their intervals, control against rate, the amplifier's curve.

use crate::tolerance::LEAST_WITH_THREE_DECIMALS;
use crate::wording::identification::{AmplifierText, IdentificationText};
use counterpoise_diagnose::identification::{Estimate, FrictionPicture, GainPoint};
use counterpoise_pipeline::recordings::AxisUnits;

use crate::{
    FigureTile, Headline, OutcomeTone, ProvenanceEntry, Report, ReportCell, ReportColumn, ReportSection,
    ReportTable,
};
use counterpoise_plot::number::short_number;
use counterpoise_plot::{Axis, Band, Colour, Figure, Mark, Panel, Series};

/// Its name in tables; a peak, so that it is not held against the project's level.
const BREAKAWAY: &str = "highest after a reversal";

/// Returns the report.
pub fn identification_report(
    machine: &str,
    command: &str,
    found: &IdentificationText,
    units: &AxisUnits,
) -> Report {
    let loops: Vec<Figure> =
        found.loops.iter().map(|l| loop_figure(l, found, DrawingContext { command, units })).collect();
    let (first, others) = loops.split_at(loops.len().min(1));
    let mut sections = Vec::new();
    if !others.is_empty() {
        sections.push(ReportSection::new("Control against rate").with_figures(others.to_vec()));
    }
    sections.push(amplifier_section(&found.amplifier, command));
    sections.push(
        found.notes.iter().fold(ReportSection::new("To be known with the numbers"), |s, n| s.with_text(n)),
    );
    Report {
        title: format!("Identification of {machine}"),
        subtitle: "out-of-balance, friction, inertia and amplifier, from recordings in closed loop"
            .to_owned(),
        headline: headline(found, units),
        tiles: tiles(found, units),
        verdicts: estimates(found, units),
        glance: first.iter().map(|figure| explain_figure(figure, found, units)).collect(),
        sections,
        provenance: vec![
            ProvenanceEntry::new("version", env!("CARGO_PKG_VERSION")),
            ProvenanceEntry::new("command", command),
        ],
    }
}

fn headline(found: &IdentificationText, units: &AxisUnits) -> Headline {
    let moved: Vec<&str> = named_estimates(found, units)
        .into_iter()
        .filter(|(name, e, _)| *name != BREAKAWAY && e.before.is_finite() && !e.holds(e.before))
        .map(|(name, _, _)| name)
        .collect();
    let text = if moved.is_empty() {
        "Every identified value agrees with the project".to_owned()
    } else {
        format!("Not as in the project: {}", moved.join(", "))
    };
    let detail = format!(
        "From {:.1} s of sliding; the torque balance leaves {:.2} {} RMS.",
        found.sliding_s, found.residual_nm, units.torque
    );
    Headline { tone: OutcomeTone::Neutral, text, detail }
}

/// Returns every estimate with its name and unit.
fn named_estimates(
    found: &IdentificationText,
    units: &AxisUnits,
) -> Vec<(&'static str, Estimate, &'static str)> {
    let mut out = Vec::new();
    for (state, b) in found.balances.iter().enumerate() {
        let names = if state == 0 {
            ["out-of-balance", "inertia"]
        } else {
            ["out-of-balance, other state", "inertia, other state"]
        };
        out.push((names[0], b.out_of_balance_kg_m, units.moment));
        out.push((
            names[1],
            b.inertia_kg_m2,
            if units.inertia == "kg m^2" { "kg m²" } else { units.inertia },
        ));
    }
    out.push(("Coulomb friction", found.coulomb_nm, units.torque));
    out.push(("viscous friction", found.viscous_nm_s_rad, units.viscous));
    out.extend(found.breakaway_nm.map(|e| (BREAKAWAY, e, units.torque)));
    out.extend(found.sensor_errors());
    out.retain(|(_, e, _)| e.is_known());
    out
}

fn tiles(found: &IdentificationText, units: &AxisUnits) -> Vec<FigureTile> {
    let tile = |(name, e, unit): (&str, Estimate, &str)| {
        FigureTile::plain(name, short_number(e.value), unit)
            .with_note(&format!("± {}", short_number(e.half_width())))
    };
    named_estimates(found, units)
        .into_iter()
        .filter(|(name, ..)| !name.contains("other"))
        .take(4)
        .map(tile)
        .collect()
}

fn estimates(found: &IdentificationText, units: &AxisUnits) -> ReportTable {
    let columns = [
        ReportColumn::Text("value"),
        ReportColumn::Number("identified"),
        ReportColumn::Number("95 % interval"),
        ReportColumn::Number("project"),
        ReportColumn::Text("unit"),
    ];
    let mut table = ReportTable::new("Identified, all torques at the hub", &columns);
    for (name, e, unit) in named_estimates(found, units) {
        table.rows.push(vec![
            ReportCell::text(name),
            ReportCell::number(e.value),
            ReportCell::text(format!("{} to {}", interval_end(e.ci95[0]), interval_end(e.ci95[1]))),
            if e.before.is_finite() { ReportCell::number(e.before) } else { ReportCell::text("") },
            ReportCell::text(unit),
        ]);
    }
    table
}

/// Returns the end of an interval with three decimals, or with three digits if those say nothing.
fn interval_end(value: f64) -> String {
    if value == 0.0 || value.abs() >= LEAST_WITH_THREE_DECIMALS {
        format!("{value:.3}")
    } else {
        format!("{value:.2e}")
    }
}

/// The context that a figure is drawn in.
#[derive(Clone, Copy)]
struct DrawingContext<'a> {
    command: &'a str,
    units: &'a AxisUnits,
}

/// Control against the rate of the axis, measured and as the identified mechanism needs it.
fn loop_figure(picture: &FrictionPicture, found: &IdentificationText, drawn: DrawingContext<'_>) -> Figure {
    let rate = drawn.units.rate;
    let points = |k: usize| picture.points.iter().map(move |p| (p[0], p[k]));
    let series = vec![
        Series::solid_line("recorded", Colour::Second, points(1)),
        Series::dashed_line("identified", Colour::First, points(2)),
    ];
    let panel = Panel::new(Axis::linear("control", "V"), series).with_height(300.0);
    let panel = if picture.balance == 0 {
        let text = format!("holds the out-of-balance: {:.2} V", found.lobes.offset_v);
        panel.with_marks(vec![Mark::Level { y: found.lobes.offset_v, text }])
    } else {
        panel
    };
    let state = if picture.balance == 0 { "" } else { ", other state" };
    let title = format!("{}{state}: control against {}", picture.recording, rate.name());
    let figure = Figure::new(&title, Axis::linear(rate.name(), rate.unit()), vec![panel]);
    Figure { command: drawn.command.to_owned(), ..figure }
}

/// Returns the same figure with how it is read.
fn explain_figure(figure: &Figure, found: &IdentificationText, units: &AxisUnits) -> Figure {
    let l = &found.lobes;
    figure.clone().with_caption(&format!(
        "Offset: out-of-balance. Step at rate zero ({:.2} V): twice the Coulomb friction. Slope of the lobes ({:.2} {}): \
         viscous friction and back-EMF. Width ({:.2} V per {}/s²): inertia. Presliding, about rate zero, was not fitted.",
        l.step_v, l.slope_v_s_rad, units.slope, l.width_v_s2_rad, units.position
    ))
}

fn amplifier_section(amplifier: &AmplifierText, command: &str) -> ReportSection {
    let section = ReportSection::new("Amplifier");
    let points = amplifier.points();
    let text = match amplifier {
        AmplifierText::Curve { .. } => "Its gain curve differs from the project's.".to_owned(),
        AmplifierText::AsInProject { .. } => "Its gain curve is the project's.".to_owned(),
        AmplifierText::NotIdentifiable { why } => format!("Not identifiable: {why}."),
    };
    let section = section.with_text(text);
    if points.is_empty() {
        return section;
    }
    section.with_figures([curve_figure(points, command)]).with_table(curve_table(points))
}

fn curve_figure(points: &[GainPoint], command: &str) -> Figure {
    let of = |y: fn(&GainPoint) -> f64| points.iter().map(move |q| (q.input_v, y(q)));
    let series = vec![
        Series::dashed_line("project", Colour::Muted, of(|q| q.linear_a)),
        Series::solid_line("identified", Colour::First, of(|q| q.current_a)),
    ];
    let edges = points.iter().map(|q| (q.input_v, q.ci95_a[0], q.ci95_a[1]));
    let band = Band::new("95 % interval", Colour::First, edges);
    let ring = |q: &GainPoint| Mark::Point {
        x: q.input_v,
        y: q.current_a,
        text: "recovered points".to_owned(),
        colour: Colour::First,
    };
    let panel = Panel::new(Axis::linear("current, stalled", "A"), series).with_height(260.0);
    let panel = panel.with_bands(vec![band]).with_marks(points.iter().map(ring).collect());
    let figure = Figure::new("Gain curve of the amplifier", Axis::linear("input", "V"), vec![panel]);
    Figure { command: command.to_owned(), ..figure }
}

fn curve_table(points: &[GainPoint]) -> ReportTable {
    let columns = [
        ReportColumn::Number("input [V]"),
        ReportColumn::Number("current [A]"),
        ReportColumn::Number("95 % interval [A]"),
        ReportColumn::Number("project [A]"),
        ReportColumn::Number("scatter [A]"),
    ];
    let mut table = ReportTable::new("Points of the gain curve, recovered without a stall test", &columns);
    for q in points {
        table.rows.push(vec![
            ReportCell::number(q.input_v),
            ReportCell::number(q.current_a),
            ReportCell::text(format!("{:.3} to {:.3}", q.ci95_a[0], q.ci95_a[1])),
            ReportCell::number(q.linear_a),
            ReportCell::number(q.scatter_a),
        ]);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::html_page;
    use crate::wording::identification::RegressionText;
    use counterpoise_diagnose::identification::{BalanceState, Lobes, NormalEquations};

    fn example_text() -> IdentificationText {
        let estimate = |value| Estimate::new(value, 0.5, 150.0);
        let turn = |k: i32| f64::from(k) * 0.01;
        IdentificationText {
            balances: vec![BalanceState {
                out_of_balance_kg_m: estimate(186.0),
                inertia_kg_m2: estimate(150.2),
            }],
            coulomb_nm: estimate(130.0),
            viscous_nm_s_rad: estimate(140.0),
            breakaway_nm: None,
            amplifier: AmplifierText::NotIdentifiable { why: "the control stays large" },
            lobes: Lobes { offset_v: 3.5, step_v: 0.5, slope_v_s_rad: 6.0, width_v_s2_rad: 2.0 },
            loops: vec![FrictionPicture {
                recording: "triangle".to_owned(),
                balance: 0,
                points: (0..700).map(|k| [turn(k).sin(), turn(k).cos(), turn(k).cos()]).collect(),
            }],
            residual_nm: 0.2,
            noise_share: 1e-6,
            sliding_s: 6.0,
            sensors: None,
            regression: RegressionText { unknowns: Vec::new(), equations: NormalEquations::default() },
            notes: vec!["a note".to_owned()],
        }
    }

    #[test]
    fn the_page_names_what_moved_and_draws_the_loop() {
        let rotary = AxisUnits {
            moment: "kg m",
            inertia: "kg m^2",
            torque: "N m",
            viscous: "N m s/rad",
            slope: "V s/rad",
            position: "rad",
            rate: counterpoise_models::ControlledQuantity::RATE,
        };
        let page =
            html_page(&identification_report("rig", "counterpoise identify rig", &example_text(), &rotary));
        assert!(page.contains("Not as in the project: out-of-balance, Coulomb friction"), "headline");
        assert!(page.contains("control against hub rate") && page.contains("the control stays large"));
        assert!(!page.contains("NaN"));
    }
}
