//! The report of a plant: its numbers, poles, the modes of its structure, and its friction.

use counterpoise_pipeline::plant_views::{FrictionLoop, FrictionView, MeshComparison, ModeSet, PlantViews};
use counterpoise_pipeline::results::ModelResult;
use counterpoise_pipeline::studies::accuracy::Accuracy;
use counterpoise_pipeline::studies::model::ModelStudy;

use crate::check::assumptions_section;
use crate::learned::elements_section;
use crate::{
    FigureTile, Headline, OutcomeTone, ProvenanceEntry, Report, ReportCell, ReportColumn, ReportSection,
    ReportTable,
};
use counterpoise_plot::number::short_number;
use counterpoise_plot::{Axis, Colour, Figure, Panel, Series};

/// Returns the report.
pub fn model_report(study: &ModelStudy, command: &str) -> Report {
    let (result, views) = (&study.result, &study.views);
    let mut sections: Vec<ReportSection> = Vec::new();
    if !views.modes.is_empty() {
        sections.push(modes_section(&views.modes, command));
    }
    sections.extend(views.meshes.as_ref().map(|meshes| meshes_section(meshes, command)));
    sections.extend(views.frictions.iter().map(|friction| friction_section(friction, command)));
    sections.extend(elements_section(&views.learned));
    if !result.accuracy.is_empty() {
        sections.push(accuracy_section(&result.accuracy, command));
    }
    if !result.assumptions.is_empty() {
        sections.push(assumptions_section(&result.assumptions, &result.assumption_effects));
    }
    let glance = views.modes.iter().find(|set| set.support == "pinned").map(|set| shapes(set, command));
    Report {
        title: format!("Plant of {}", result.name),
        subtitle: "operating point, poles, modes of the structure, friction".to_owned(),
        headline: Headline {
            tone: OutcomeTone::Neutral,
            text: format!("Linear plant of order {}", result.order),
            detail: format!(
                "Out-of-balance {} kg m, held by {} V.",
                short_number(result.out_of_balance_kg_m),
                short_number(result.holding_v)
            ),
        },
        tiles: tiles(result, views),
        verdicts: poles(result),
        glance: glance.into_iter().collect(),
        sections,
        provenance: vec![
            ProvenanceEntry::new("version", env!("CARGO_PKG_VERSION")),
            ProvenanceEntry::new("command", command),
        ],
    }
}

fn tiles(result: &ModelResult, views: &PlantViews) -> Vec<FigureTile> {
    let tile = |label: String, value: f64, unit: &str| FigureTile {
        label,
        value: short_number(value),
        unit: unit.to_owned(),
        note: String::new(),
        tone: OutcomeTone::Neutral,
    };
    let mut out = vec![
        tile("out-of-balance".to_owned(), result.out_of_balance_kg_m, "kg m"),
        tile("holding control".to_owned(), result.holding_v, "V"),
    ];
    for set in views.modes.iter().filter(|set| set.support != "free") {
        out.extend(
            set.modes
                .first()
                .map(|mode| tile(format!("first mode, hub {}", set.support), mode.frequency_hz, "Hz")),
        );
    }
    out
}

fn poles(result: &ModelResult) -> ReportTable {
    let columns = [ReportColumn::Number("frequency [Hz]"), ReportColumn::Number("damping ratio")];
    let mut table = ReportTable::new("Poles of the linear plant", &columns);
    let mut rising = result.pole_figures();
    rising.sort_by(|a, b| a.frequency_hz.total_cmp(&b.frequency_hz));
    for pole in rising {
        table.rows.push(vec![ReportCell::number(pole.frequency_hz), ReportCell::number(pole.damping_ratio)]);
    }
    table
}

fn modes_section(sets: &[ModeSet], command: &str) -> ReportSection {
    let columns = [
        ReportColumn::Text("hub"),
        ReportColumn::Number("mode"),
        ReportColumn::Number("frequency [Hz]"),
        ReportColumn::Number("effective mass, heave [kg]"),
        ReportColumn::Number("effective inertia, pitch [kg m\u{B2}]"),
    ];
    let mut table = ReportTable::new("Flexible modes by how the hub is held", &columns);
    for set in sets {
        for (k, mode) in set.modes.iter().enumerate() {
            table.rows.push(vec![
                ReportCell::text(set.support),
                ReportCell::text((k + 1).to_string()),
                ReportCell::number(mode.frequency_hz),
                ReportCell::number(mode.effective_mass_kg),
                ReportCell::number(mode.effective_inertia_kg_m2),
            ]);
        }
    }
    ReportSection::new("Modes of the structure")
        .with_figures(sets.iter().filter(|set| set.support != "pinned").map(|set| shapes(set, command)))
        .with_table(table)
}

fn shapes(set: &ModeSet, command: &str) -> Figure {
    let series = set.modes.iter().zip(Colour::CYCLE).map(|(mode, colour)| {
        let points = mode.shape.iter().map(|p| (p[0], p[1]));
        Series::solid_line(&format!("{} Hz", short_number(mode.frequency_hz)), colour, points)
    });
    let panel = Panel::new(Axis::linear("deflection", ""), series.collect()).with_height(240.0);
    let title = format!("Mode shapes, hub {}", set.support);
    let figure = Figure::new(&title, Axis::linear("distance from the pivot", "m"), vec![panel])
        .with_caption("Deflection of each flexible mode, its largest being 1; the tip is to the right.");
    Figure { command: command.to_owned(), ..figure }
}

fn meshes_section(meshes: &MeshComparison, command: &str) -> ReportSection {
    let mut columns = vec![ReportColumn::Text("elements")];
    columns.extend(MODE_HEADS.iter().take(meshes.reference_hz.len()).map(|head| ReportColumn::Number(head)));
    let mut table = ReportTable::new("Frequencies over the reference's, free at both ends", &columns);
    let row = |name: String, values: Vec<String>| {
        let filled = values.into_iter().chain(std::iter::repeat(String::new())).take(columns.len() - 1);
        std::iter::once(name).chain(filled).map(ReportCell::text).collect()
    };
    let hertz = meshes.reference_hz.iter().map(|hz| short_number(*hz)).collect();
    table.rows.push(row(format!("{} tapered [Hz]", meshes.reference), hertz));
    for mesh in &meshes.columns {
        let ratios = mesh.ratios.iter().map(|r| format!("{r:.4}")).collect();
        table.rows.push(row(format!("{} {}", mesh.elements, mesh.kind), ratios));
    }
    ReportSection::new("How many elements")
        .with_text(
            "Uniform elements have the mean diameter of the stretch that they stand for, tapered ones its true cross section by \
             quadrature: their frequencies are never below the beam's.",
        )
        .with_figures([convergence(meshes, command)])
        .with_table(table)
}

/// Heads of the table's columns.
const MODE_HEADS: [&str; 9] =
    ["mode 1", "mode 2", "mode 3", "mode 4", "mode 5", "mode 6", "mode 7", "mode 8", "mode 9"];

/// Modes whose errors are drawn.
const DRAWN: usize = 3;

fn convergence(meshes: &MeshComparison, command: &str) -> Figure {
    let curve = |kind: &str, mode: usize| -> Vec<(f64, f64)> {
        let all = meshes.finer.iter().filter(|c| c.kind == kind);
        all.filter_map(|c| Some((c.elements as f64, 100.0 * c.relative_error(mode)?))).collect()
    };
    let mut series = Vec::new();
    for (mode, colour) in (0..DRAWN).zip(Colour::CYCLE) {
        series.push(Series::solid_line(
            &format!("mode {}, tapered", mode + 1),
            colour,
            curve("tapered", mode),
        ));
        series.push(Series::dashed_line(
            &format!("mode {}, uniform", mode + 1),
            colour,
            curve("uniform", mode),
        ));
    }
    let panel = Panel::new(Axis::logarithmic("error of the frequency", "%"), series).with_height(260.0);
    let caption = format!(
        "Against {} elements. The error of tapered elements falls with the fourth power of their number, that of uniform ones with the second.",
        meshes.reference
    );
    let figure =
        Figure::new("Error against the number of elements", Axis::logarithmic("elements", ""), vec![panel]);
    Figure { command: command.to_owned(), ..figure.with_caption(&caption) }
}

fn accuracy_section(all: &[Accuracy], command: &str) -> ReportSection {
    let sticking: Vec<&Accuracy> = all.iter().filter(|a| a.sticks).collect();
    let others: Vec<&Accuracy> = all.iter().filter(|a| !a.sticks && a.name != CONTACT).collect();
    let mut figures = vec![errors("Laws that truly stick", &sticking), errors("Laws that yield", &others)];
    figures.extend(all.iter().find(|a| a.name == CONTACT).map(contact_errors));
    figures.iter_mut().for_each(|figure| command.clone_into(&mut figure.command));
    ReportSection::new("How exactly it is simulated")
        .with_text(
            "This machine with every law of friction in turn at its pivot, and nearly balanced with a gap between its teeth, set in motion \
             from rest on a platform that pitches and heaves: the largest error of the hub rate relative to its largest value. It is \
             compared with a second method, the classical Runge-Kutta method in a thousand steps for one of ours, which finds the \
             instants of its own changes; its own error stands in the table.",
        )
        .with_figures(figures)
        .with_table(accuracy_table(all))
}

/// Name of the case in which teeth part and meet.
const CONTACT: &str = "contact";

/// Returns points of a line of errors: the step in milliseconds; an error of exactly 0 has no logarithm.
fn line(steps: &[f64], errors: &[f64]) -> Vec<(f64, f64)> {
    let pairs = steps.iter().zip(errors).map(|(s, e)| (1e3 * s, *e));
    pairs.filter(|(_, e)| *e > 0.0 && e.is_finite()).collect()
}

fn errors(title: &str, laws: &[&Accuracy]) -> Figure {
    let series = laws.iter().enumerate().map(|(k, law)| {
        let colour = Colour::CYCLE[k % Colour::CYCLE.len()];
        let points = line(&law.step_s, &law.error);
        if k < Colour::CYCLE.len() {
            Series::solid_line(law.name, colour, points)
        } else {
            Series::dashed_line(law.name, colour, points)
        }
    });
    let panel = Panel::new(Axis::logarithmic("error", ""), series.collect()).with_height(260.0);
    Figure::new(title, Axis::logarithmic("sample period", "ms"), vec![panel])
        .with_caption("With the simulator's own steps within a sample of that length.")
}

fn contact_errors(contact: &Accuracy) -> Figure {
    let series = vec![
        Series::solid_line("instants found", Colour::First, line(&contact.step_s, &contact.error)),
        Series::dashed_line("steps as they are", Colour::Second, line(&contact.step_s, &contact.plain)),
    ];
    let panel = Panel::new(Axis::logarithmic("error", ""), series).with_height(260.0);
    Figure::new("Teeth that part and meet", Axis::logarithmic("sample period", "ms"), vec![panel]).with_caption(
        "Solid: the simulator finds the instants at which teeth part and meet, to a 2048th of a sample. Dashed: it does not.",
    )
}

fn accuracy_table(all: &[Accuracy]) -> ReportTable {
    let columns = [
        ReportColumn::Text("law"),
        ReportColumn::Number("error, longest"),
        ReportColumn::Number("error, shortest"),
        ReportColumn::Number("order, steps as they are"),
        ReportColumn::Number("second method"),
    ];
    let mut table = ReportTable::new(&format!("Errors with samples of {}", span(all)), &columns);
    let small = |value: Option<&f64>| value.map_or("-".to_owned(), |v| format!("{v:.1e}"));
    for law in all {
        table.rows.push(vec![
            ReportCell::text(law.name),
            ReportCell::text(small(law.error.first())),
            ReportCell::text(small(law.error.last())),
            ReportCell::text(law.order.map_or("exact".to_owned(), |order| format!("{order:.1}"))),
            ReportCell::text(small(Some(&law.second_method))),
        ]);
    }
    table
}

/// Returns the longest and the shortest sample in words.
fn span(all: &[Accuracy]) -> String {
    let steps = all.first().map_or(&[][..], |law| &law.step_s[..]);
    match (steps.first(), steps.last()) {
        (Some(long), Some(brief)) => {
            format!("{} to {} ms", short_number(1e3 * long), short_number(1e3 * brief))
        }
        _ => "no length".to_owned(),
    }
}

/// Loops in order of swing that have not slid: those below the one whose torque no longer grows.
const PRESLIDING: usize = 3;

fn friction_section(friction: &FrictionView, command: &str) -> ReportSection {
    let place = friction.place;
    let steady = friction.steady.iter().map(|p| (p[0], p[1]));
    let mut figures = vec![
        Figure::new(
            &format!("Friction at the {place} against steady rate"),
            Axis::linear("rate", "rad/s"),
            vec![torques(vec![Series::solid_line("", Colour::First, steady)])],
        )
        .with_caption("The torque after a long time at a constant rate, viscous part included."),
    ];
    let mut section = ReportSection::new(&format!("Friction at the {place}"));
    let loops: Vec<&FrictionLoop> = friction.loops.iter().filter(|l| !l.points.is_empty()).collect();
    if !loops.is_empty() {
        figures.extend(loop_figures(place, &loops));
        section = section.with_table(losses(&loops));
    }
    figures.iter_mut().for_each(|figure| command.clone_into(&mut figure.command));
    section.with_figures(figures)
}

fn torques(series: Vec<Series>) -> Panel {
    Panel::new(Axis::linear("torque", "N m"), series).with_height(240.0)
}

fn swing(one: &FrictionLoop) -> String {
    format!("\u{B1} {} mrad", short_number(1e3 * one.amplitude_rad))
}

/// Returns the loops through presliding over the angle, all loops over their own swing, and over their own
/// largest rate.
fn loop_figures(place: &str, loops: &[&FrictionLoop]) -> [Figure; 3] {
    let curves = |many: usize, of: &dyn Fn(&FrictionLoop) -> Vec<(f64, f64)>| -> Panel {
        let named = loops.iter().zip(Colour::CYCLE).take(many);
        torques(named.map(|(one, colour)| Series::solid_line(&swing(one), colour, of(one))).collect())
    };
    let milli = |one: &FrictionLoop| one.points.iter().map(|p| (1e3 * p[0], p[1])).collect();
    let pairs = |points: Vec<[f64; 2]>| points.into_iter().map(|[x, torque]| (x, torque)).collect();
    let presliding = curves(PRESLIDING, &milli);
    let sliding = curves(loops.len(), &|one| pairs(one.torque_against_relative_angle()));
    let rates = curves(loops.len(), &|one| pairs(one.torque_against_relative_rate()));
    [
        Figure::new(&format!("Presliding at the {place}"), Axis::linear("angle", "mrad"), vec![presliding])
            .with_caption("Torque over the angle in settled loops under a 1 Hz sine, from a spring with little loss to sliding."),
        Figure::new(&format!("Into sliding at the {place}"), Axis::linear("angle over its swing", ""), vec![sliding])
            .with_caption("Every loop over its own swing: the fuller it is, the more of the work is lost."),
        Figure::new(&format!("Loops at the {place} against rate"), Axis::linear("rate over its peak", ""), vec![rates])
            .with_caption("The same loops against rate, each over its own largest rate."),
    ]
}

fn losses(loops: &[&FrictionLoop]) -> ReportTable {
    let columns = [
        ReportColumn::Number("swing [mrad]"),
        ReportColumn::Number("largest torque [N m]"),
        ReportColumn::Number("lost in a period [J]"),
        ReportColumn::Number("equivalent viscous damping at 1 Hz [N m s/rad]"),
    ];
    let mut table = ReportTable::new("Loops under a 1 Hz sine", &columns);
    for one in loops {
        let cells =
            [1e3 * one.amplitude_rad, one.largest_torque_nm, one.lost_j, one.equivalent_damping_nm_s_rad];
        table.rows.push(cells.iter().map(|value| ReportCell::number(*value)).collect());
    }
    table
}
