//! Every design of a project in one table: terminal lines, page, and Markdown.

use counterpoise_pipeline::ProjectIdentity;
use counterpoise_pipeline::studies::designs::{DesignRow, DesignTable, LimitsResult};
use counterpoise_pipeline::tuning::{BlockResult, WeightsResult};
use counterpoise_plot::number::short_number;
use counterpoise_plot::{Axis, Colour, Figure, Mark, Panel, Series};

use crate::{Cell, Column, Headline, Origin, Report, Section, Table, Tile, Tone};

/// What each column of the table is.
pub const COLUMNS: [&str; 18] = [
    "order",
    "Ms",
    "Mt",
    "gain margin [dB]",
    "phase margin [deg]",
    "delay margin [ms]",
    "decay [rad/s]",
    "noise gain [V s/rad]",
    "largest KS [V s/rad]",
    "effort [V]",
    "RMS of S, 0.2 to 2 Hz",
    "residual hub rate [mrad/s]",
    "step [mrad/s]",
    "sines [mrad/s]",
    "motion [mrad/s]",
    "rest [mrad/s]",
    "control [V]",
    "time [s]",
];

/// What the columns mean, for a reader of the table.
pub const LEGEND: [&str; 4] = [
    "Order: states of the feedback. Decay: the slowest pole of the closed loop. Margins, noise gain (RMS control for readings with noise of unit RMS), largest KS and |S| are those of the \
     sampled linear loop.",
    "Residual hub rate and effort: RMS rate and RMS control that the estimated disturbance at the output leaves in the linear loop; a tuned structure makes the \
     residual hub rate least.",
    "Step, sines, motion, rest: RMS of the true hub rate less its demand in the nonlinear closed loop with friction, backlash, converters and noise. Every \
     design has the project's feedforwards and friction observers, except a joint optimum, which is one controller.",
    "Control: RMS of the control about its mean under the motion.",
];

/// Returns the cells of a row after its name, with the time that its design took in s; empty text if there is no number.
pub fn design_cells(row: &DesignRow, time_s: Option<f64>) -> Vec<String> {
    let number =
        |value: Option<f64>| value.filter(|value| !value.is_nan()).map_or(String::new(), short_number);
    let linear = |of: fn(&counterpoise_pipeline::tuning::LoopMeasuresResult) -> f64| {
        number(row.linear.as_ref().map(of))
    };
    let run = |of: fn(&counterpoise_pipeline::studies::designs::RunFigures) -> f64| {
        number(row.nonlinear.as_ref().map(of))
    };
    let has_controller = row.why.is_none() && row.bound.is_none();
    let order = if !has_controller { String::new() } else { row.order.to_string() };
    vec![
        order,
        linear(|m| m.max_sensitivity),
        linear(|m| m.max_complementary),
        linear(|m| m.gain_margin_db),
        linear(|m| m.phase_margin_deg),
        linear(|m| 1e3 * m.delay_margin_s),
        linear(|m| m.decay_rad_s),
        linear(|m| m.noise_gain),
        linear(|m| m.control_peak),
        linear(|m| m.effort_v),
        number(row.rejection),
        linear(|m| 1e3 * m.residual_rad_s),
        run(|r| 1e3 * r.step_rad_s),
        run(|r| 1e3 * r.sines_rad_s),
        number(row.nonlinear.as_ref().and_then(|r| r.motion_rad_s).map(|rate| 1e3 * rate)),
        run(|r| 1e3 * r.rest_rad_s),
        run(|r| r.control_v),
        number(time_s),
    ]
}

/// Returns the limits of a row in words.
pub fn limits_words(limits: &LimitsResult) -> String {
    let pairs = [
        ("Ms", limits.max_sensitivity),
        ("Mt", limits.max_complementary),
        ("noise gain", limits.noise_gain),
        ("KS", limits.control_peak),
    ];
    let lower = [
        ("gain margin", limits.gain_margin_db, "dB"),
        ("phase margin", limits.phase_margin_deg, "deg"),
        ("delay margin", limits.delay_margin_s, "s"),
        ("decay", limits.decay_rad_s, "rad/s"),
    ];
    let above =
        pairs.into_iter().filter_map(|(name, limit)| Some(format!("{name} <= {}", short_number(limit?))));
    let below = lower
        .into_iter()
        .filter_map(|(name, limit, unit)| Some(format!("{name} >= {} {unit}", short_number(limit?))));
    above.chain(below).collect::<Vec<_>>().join(", ")
}

/// Returns a block with its values in words.
pub fn block_words(block: &BlockResult) -> String {
    let values: Vec<String> =
        block.values.iter().map(|(key, value)| format!("{key} {}", short_number(*value))).collect();
    format!("{} ({})", block.kind, values.join(", "))
}

/// Returns tuned weights in words.
pub fn weight_words(weights: &WeightsResult) -> String {
    format!(
        "error weight {}; control weight {}; measurement noise {} (rad/s)^2 s; loop recovery {} V^2 s",
        weights.error,
        weights.control,
        short_number(weights.measurement_noise),
        short_number(weights.loop_recovery)
    )
}

/// Returns the remarks on a row: limits, blocks, what is missed, or why there is no controller.
pub fn design_remarks(row: &DesignRow) -> Vec<String> {
    let mut all = Vec::new();
    all.extend(row.limits.as_ref().map(|limits| format!("tuned under {}", limits_words(limits))));
    if !row.blocks.is_empty() {
        all.push(row.blocks.iter().map(block_words).collect::<Vec<_>>().join(" "));
    }
    all.extend(row.weights.as_ref().map(weight_words));
    if let (Some(bound), Some(linear)) = (&row.bound, &row.linear) {
        let gap = 100.0 * (linear.residual_rad_s / bound.lower_bound - 1.0);
        let half = bound.half_basis.map_or("keeps no such limits".to_owned(), |value| {
            format!("is {} % above it", short_number(100.0 * (value / linear.residual_rad_s - 1.0)))
        });
        all.push(format!(
            "a bound, not a controller: {} functions, limits of S, T, KS, noise gain and effort verified at {} frequencies; its value is {} % above the dual bound of the basis, and half the basis {half}",
            bound.basis,
            bound.frequencies,
            short_number(gap)
        ));
    }
    if row.missed > 0.0 {
        all.push(format!("A LIMIT IS MISSED by {} %", short_number(100.0 * row.missed)));
    }
    all.extend(row.why.as_ref().map(|why| format!("no controller: {why}")));
    all
}

/// Returns the table in Markdown, with its legend.
pub fn markdown_table(table: &DesignTable, times_s: &[f64]) -> String {
    let mut text = format!("| design | {} |\n", COLUMNS.join(" | "));
    text += &format!("|---|{}\n", "---|".repeat(COLUMNS.len()));
    for (k, row) in table.rows.iter().enumerate() {
        let cells = design_cells(row, times_s.get(k).copied());
        text += &format!("| {} {} | {} |\n", k + 1, row.name, cells.join(" | "));
    }
    text.push('\n');
    for (k, row) in table.rows.iter().enumerate() {
        let words = design_remarks(row);
        if !words.is_empty() {
            text += &format!("{}. {}: {}.\n", k + 1, row.name, words.join("; "));
        }
    }
    text.push('\n');
    for line in LEGEND {
        text += &format!("{line}\n");
    }
    text
}

/// Returns the page.
pub fn comparison_report(table: &DesignTable, times_s: &[f64], origin: &Origin) -> Report {
    let mut columns = vec![Column::Text("design")];
    columns.extend(COLUMNS.map(Column::Number));
    let mut shown = Table::new("Designs", &columns);
    for (k, row) in table.rows.iter().enumerate() {
        let mut line = vec![Cell::text(row.name.clone())];
        line.extend(design_cells(row, times_s.get(k).copied()).into_iter().map(Cell::text));
        shown.rows.push(line);
    }
    let mut details = Section::new("What each design is");
    for row in table.rows.iter().filter(|row| !design_remarks(row).is_empty()) {
        details = details.saying(format!("{}: {}.", row.name, design_remarks(row).join("; ")));
    }
    let legend = LEGEND.iter().fold(Section::new("Columns"), |section, line| section.saying(*line));
    let best = best_row(table);
    let text = match best {
        Some(row) => format!("Least hub rate under {}: {}", table.motion, row.name),
        None => "No design could be simulated".to_owned(),
    };
    let tiles = best.map(tiles).unwrap_or_default();
    let identity = ProjectIdentity { name: table.name.clone(), hash: table.hash.clone() };
    let report = Report {
        title: format!("Designs of {}", table.name),
        subtitle: format!("tuned structures make least: {}", table.objective),
        headline: Headline { tone: Tone::Neutral, text, detail: String::new() },
        tiles,
        verdicts: shown,
        glance: figure(table).into_iter().collect(),
        sections: vec![details, legend],
        provenance: origin.provenance(&identity),
    };
    report.reproduced_by(&origin.command)
}

/// Returns every simulated design: hub rate against noise gain, each with its number.
fn figure(table: &DesignTable) -> Option<Figure> {
    const COLOURS: [Colour; 4] = [Colour::First, Colour::Second, Colour::Third, Colour::Fourth];
    let mut marks = Vec::new();
    for (k, row) in table.rows.iter().enumerate() {
        let (Some(linear), Some(run)) = (&row.linear, &row.nonlinear) else { continue };
        marks.push(Mark::Point {
            x: linear.noise_gain,
            y: 1e3 * run.motion_rad_s.unwrap_or(run.sines_rad_s),
            text: format!("{} {}", k + 1, row.name),
            colour: COLOURS[k % COLOURS.len()],
        });
    }
    if marks.is_empty() {
        return None;
    }
    let points: Vec<(f64, f64)> = marks
        .iter()
        .filter_map(|mark| match mark {
            Mark::Point { x, y, .. } => Some((*x, *y)),
            _ => None,
        })
        .collect();
    // The series gives the axes their range; its points lie under the rings.
    let series = Series::dotted("", Colour::Muted, points);
    let panel =
        Panel::new(Axis::linear("hub rate under the motion", "mrad/s RMS"), vec![series]).with_marks(marks);
    let x = Axis::linear("noise gain", "V s/rad");
    let caption = "Down is less motion, left is less noise in the control. The line joins the designs in the order of the table.";
    Some(Figure::new("Hub rate against noise gain", x, vec![panel]).with_caption(caption))
}

/// Returns the row of the least hub rate under the motion.
fn best_row(table: &DesignTable) -> Option<&DesignRow> {
    let moved =
        |row: &DesignRow| row.nonlinear.as_ref().map(|run| run.motion_rad_s.unwrap_or(run.sines_rad_s));
    let rows = table.rows.iter().filter_map(|row| Some((moved(row)?, row)));
    rows.min_by(|a, b| a.0.total_cmp(&b.0)).map(|pair| pair.1)
}

fn tiles(row: &DesignRow) -> Vec<Tile> {
    let mut all = Vec::new();
    if let Some(run) = &row.nonlinear {
        let moved = run.motion_rad_s.unwrap_or(run.sines_rad_s);
        all.push(Tile::plain("hub rate under the motion", short_number(1e3 * moved), "mrad/s RMS"));
    }
    if let Some(linear) = &row.linear {
        all.push(Tile::plain("largest sensitivity", short_number(linear.max_sensitivity), ""));
        all.push(Tile::plain("noise gain", short_number(linear.noise_gain), "V s/rad"));
    }
    all
}
