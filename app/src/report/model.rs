//! The report of a plant: its numbers, poles, the modes of its structure, and its friction.

use counterpoise_project::pipeline::portrait::{FrictionPortrait, ModeSet, Portrait};
use counterpoise_project::results::ModelResult;

use super::{Cell, Column, Headline, Report, Section, Table, Tile, Tone};
use crate::plot::ticks::short;
use crate::plot::{Axis, Colour, Figure, Panel, Series};

/// The report.
pub fn report(result: &ModelResult, portrait: &Portrait, command: &str) -> Report {
    let mut sections: Vec<Section> = Vec::new();
    if !portrait.modes.is_empty() {
        sections.push(modes_section(&portrait.modes, command));
    }
    sections.extend(portrait.frictions.iter().map(|friction| friction_section(friction, command)));
    let glance = portrait.modes.iter().find(|set| set.support == "pinned").map(|set| shapes(set, command));
    Report {
        title: format!("Plant of {}", result.name),
        subtitle: "operating point, poles, modes of the structure, friction".to_owned(),
        headline: Headline {
            tone: Tone::Neutral,
            text: format!("Linear plant of order {}", result.order),
            detail: format!(
                "Out-of-balance {} kg m, held by {} V.",
                short(result.out_of_balance_kg_m),
                short(result.holding_v)
            ),
        },
        tiles: tiles(result, portrait),
        verdicts: poles(result),
        glance: glance.into_iter().collect(),
        sections,
        provenance: vec![
            ("version".to_owned(), env!("CARGO_PKG_VERSION").to_owned()),
            ("command".to_owned(), command.to_owned()),
        ],
    }
}

fn tiles(result: &ModelResult, portrait: &Portrait) -> Vec<Tile> {
    let tile = |label: String, value: f64, unit: &str| Tile {
        label,
        value: short(value),
        unit: unit.to_owned(),
        note: String::new(),
        tone: Tone::Neutral,
    };
    let mut out = vec![
        tile("out-of-balance".to_owned(), result.out_of_balance_kg_m, "kg m"),
        tile("holding control".to_owned(), result.holding_v, "V"),
    ];
    for set in portrait.modes.iter().filter(|set| set.support != "free") {
        out.extend(
            set.modes
                .first()
                .map(|mode| tile(format!("first mode, hub {}", set.support), mode.frequency_hz, "Hz")),
        );
    }
    out
}

fn poles(result: &ModelResult) -> Table {
    let columns = [Column::Number("frequency [Hz]"), Column::Number("damping ratio")];
    let mut table = Table::new("Poles of the linear plant", &columns);
    let mut upper: Vec<[f64; 2]> = result.poles_rad_s.iter().filter(|p| p[1] >= 0.0).copied().collect();
    upper.sort_by(|a, b| a[0].hypot(a[1]).total_cmp(&b[0].hypot(b[1])));
    for [re, im] in upper {
        let size = re.hypot(im);
        let damping = -re / size.max(f64::MIN_POSITIVE);
        table.rows.push(vec![Cell::number(size / std::f64::consts::TAU), Cell::number(damping)]);
    }
    table
}

fn modes_section(sets: &[ModeSet], command: &str) -> Section {
    let columns = [
        Column::Text("hub"),
        Column::Number("mode"),
        Column::Number("frequency [Hz]"),
        Column::Number("effective mass, heave [kg]"),
        Column::Number("effective inertia, pitch [kg m\u{B2}]"),
    ];
    let mut table = Table::new("Flexible modes by how the hub is held", &columns);
    for set in sets {
        for (k, mode) in set.modes.iter().enumerate() {
            table.rows.push(vec![
                Cell::text(set.support),
                Cell::text((k + 1).to_string()),
                Cell::number(mode.frequency_hz),
                Cell::number(mode.effective_mass_kg),
                Cell::number(mode.effective_inertia_kg_m2),
            ]);
        }
    }
    Section::new("Modes of the structure")
        .showing(sets.iter().filter(|set| set.support != "pinned").map(|set| shapes(set, command)))
        .listing(table)
}

fn shapes(set: &ModeSet, command: &str) -> Figure {
    let series = set.modes.iter().zip(Colour::CYCLE).map(|(mode, colour)| {
        let points = mode.shape.iter().map(|p| (p[0], p[1])).collect();
        Series::solid(&format!("{} Hz", short(mode.frequency_hz)), colour, points)
    });
    let panel = Panel::of(Axis::linear("deflection", ""), series.collect()).high(240.0);
    let title = format!("Mode shapes, hub {}", set.support);
    let figure = Figure::new(&title, Axis::linear("distance from the pivot", "m"), vec![panel])
        .captioned("Deflection of each flexible mode, its largest being 1; the tip is to the right.");
    Figure { command: command.to_owned(), ..figure }
}

fn friction_section(friction: &FrictionPortrait, command: &str) -> Section {
    let place = friction.place;
    let points = |all: &[[f64; 2]]| -> Vec<(f64, f64)> { all.iter().map(|p| (p[0], p[1])).collect() };
    let torque = || Axis::linear("torque", "N m");
    let steady = vec![Series::solid("", Colour::First, points(&friction.steady))];
    let mut figures = vec![
        Figure::new(
            &format!("Friction at the {place} against steady rate"),
            Axis::linear("rate", "rad/s"),
            vec![Panel::of(torque(), steady).high(220.0)],
        )
        .captioned("The torque after a long time at a constant rate, viscous part included."),
    ];
    let name = |amplitude: f64| format!("\u{B1} {} mrad", short(1e3 * amplitude));
    for one in friction.loops.iter().filter(|l| !l.points.is_empty()) {
        let milli = one.points.iter().map(|p| (1e3 * p[0], p[1])).collect();
        let loops = vec![Series::solid(&name(one.amplitude_rad), Colour::First, milli)];
        let title = format!("Loop at the {place}, {}", name(one.amplitude_rad));
        let caption = format!("One period of a 1 Hz sine, settled: {} J are lost in it.", short(one.lost_j));
        let panel = Panel::of(torque(), loops).high(200.0);
        figures.push(Figure::new(&title, Axis::linear("angle", "mrad"), vec![panel]).captioned(&caption));
    }
    let all_rates: Vec<Series> = friction
        .loops
        .iter()
        .zip(Colour::CYCLE)
        .map(|(one, colour)| {
            let top = one.over_rate.iter().map(|p| p[0].abs()).fold(f64::MIN_POSITIVE, f64::max);
            let relative = one.over_rate.iter().map(|p| (p[0] / top, p[1])).collect();
            Series::solid(&name(one.amplitude_rad), colour, relative)
        })
        .collect();
    if !all_rates.is_empty() {
        let panel = Panel::of(torque(), all_rates).high(220.0);
        let title = format!("Loops at the {place} against rate");
        figures.push(
            Figure::new(&title, Axis::linear("rate over its peak", ""), vec![panel])
                .captioned("The same loops against rate, each over its own largest rate."),
        );
    }
    figures.iter_mut().for_each(|figure| command.clone_into(&mut figure.command));
    Section::new(&format!("Friction at the {place}")).showing(figures)
}
