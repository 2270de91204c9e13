//! Every design of a project in one table: terminal lines, page, and Markdown.

use counterpoise_models::{AxisKind as Travel, ControlledQuantity, QuantityKind};
use counterpoise_pipeline::ProjectIdentity;
use counterpoise_pipeline::studies::designs::{DesignRow, LimitsResult};
use counterpoise_pipeline::tuning::{BlockResult, DisturbedFigures, MeasuredLoops, WeightsResult};
use counterpoise_plot::number::short_number;
use counterpoise_plot::{Axis, Colour, Figure, Mark, Panel, Series};
use counterpoise_project::TuningObjective;

use crate::results::DesignTableText;
use crate::wording::capitalise_first;
use crate::{
    FigureTile, Headline, OutcomeTone, Report, ReportCell, ReportColumn, ReportOrigin, ReportSection,
    ReportTable,
};

/// The columns of the table: name of the controlled quantity, a thousandth of its unit, unit of a gain from a reading to the control. Behind
/// them, what the effort is over a band.
macro_rules! heads {
    ($name:literal, $milli:literal, $gain:literal) => {
        (
            [
                "order",
                "Ms",
                "Mt",
                "gain margin [dB]",
                "phase margin [deg]",
                "delay margin [ms]",
                "decay [rad/s]",
                concat!("noise gain [", $gain, "]"),
                concat!("largest KS [", $gain, "]"),
                "effort [V]",
                "RMS of S, 0.2 to 2 Hz",
                concat!("residual ", $name, " [", $milli, "]"),
                concat!("step [", $milli, "]"),
                concat!("sines [", $milli, "]"),
                concat!("motion [", $milli, "]"),
                concat!("rest [", $milli, "]"),
                "control [V]",
                "time [s]",
            ],
            concat!("RMS of KS (band) [", $gain, "]"),
        )
    };
}

/// Returns what each column of the table is: effort and residual are those under a motion, or shares of 1 over a band.
pub fn table_columns(loops: MeasuredLoops) -> [&'static str; 18] {
    let controlled = loops.controlled;
    let (mut all, effort_of_band) = match (controlled.kind, controlled.axis) {
        (QuantityKind::Rate, Travel::Rotary) => heads!("hub rate", "mrad/s", "V s/rad"),
        (QuantityKind::Rate, Travel::Linear) => heads!("slide speed", "mm/s", "V s/m"),
        (QuantityKind::Position, Travel::Rotary) => heads!("hub angle", "mrad", "V/rad"),
        (QuantityKind::Position, Travel::Linear) => heads!("slide position", "mm", "V/m"),
        (QuantityKind::Effort, Travel::Rotary) => heads!("transmitted torque", "mN m", "V/(N m)"),
        (QuantityKind::Effort, Travel::Linear) => heads!("transmitted force", "mN", "V/N"),
        (QuantityKind::Current, _) => heads!("controlled current", "mA", "V/A"),
    };
    if loops.objective == TuningObjective::Band {
        (all[EFFORT], all[RESIDUAL]) = (effort_of_band, "RMS of S (band)");
    }
    all
}

/// Places of columns.
const NOISE_GAIN: usize = 7;
const EFFORT: usize = 9;
const RESIDUAL: usize = 11;

/// Returns what the column of the noise gain is.
pub fn noise_gain_column(controlled: ControlledQuantity) -> &'static str {
    table_columns(MeasuredLoops { objective: TuningObjective::Motion, controlled })[NOISE_GAIN]
}

/// Returns what the columns mean, for a reader of the table.
pub fn column_legend(loops: MeasuredLoops) -> [String; 4] {
    let (name, short) = (loops.controlled.name(), loops.controlled.short_name());
    [
        "Order: states of the feedback. Decay: the slowest pole of the closed loop. Margins, noise gain (RMS control for readings with noise of unit RMS), largest KS and |S| are those of the \
         sampled linear loop."
            .to_owned(),
        match loops.objective {
            TuningObjective::Motion => format!(
                "Residual {name} and effort: RMS {short} and RMS control that the estimated disturbance at the output leaves in the linear loop; a tuned structure makes the \
                 residual {name} least."
            ),
            TuningObjective::Band => "RMS of S and of KS in the band: even over the logarithm of frequency; a tuned structure makes that of S least.".to_owned(),
        },
        format!(
            "Step, sines, motion, rest: RMS of the true {name} less its demand in the nonlinear closed loop with friction, backlash, converters and noise. Every \
             design has the project's feedforwards and friction observers, except a joint optimum, which is one controller."
        ),
        "Control: RMS of the control about its mean under the motion.".to_owned(),
    ]
}

/// Returns the cells of a row after its name, with the time that its design took in s; empty text if there is no number.
pub fn design_cells(row: &DesignRow<String>, time_s: Option<f64>) -> Vec<String> {
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
        linear(|m| m.disturbed.effort),
        number(row.rejection),
        linear(|m| shown_residual(&m.disturbed)),
        run(|r| 1e3 * r.step.value),
        run(|r| 1e3 * r.sines.value),
        number(row.nonlinear.as_ref().and_then(|r| r.motion.value).map(|rate| 1e3 * rate)),
        run(|r| 1e3 * r.rest.value),
        run(|r| r.control_v),
        number(time_s),
    ]
}

/// Returns a residual as the tables show it: a thousandth of a unit for 1 under a motion, a pure number over a band.
pub fn shown_residual(figures: &DisturbedFigures) -> f64 {
    match figures.objective {
        TuningObjective::Motion => 1e3 * figures.residual,
        TuningObjective::Band => figures.residual,
    }
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
pub fn weight_words(weights: &WeightsResult, controlled: ControlledQuantity) -> String {
    format!(
        "error weight {}; control weight {}; measurement noise {} {}; loop recovery {} V^2 s",
        weights.error,
        weights.control,
        short_number(weights.measurement_noise),
        controlled.density_unit(),
        short_number(weights.loop_recovery)
    )
}

/// Returns the remarks on a row: limits, blocks, what is missed, or why there is no controller.
pub fn design_remarks(row: &DesignRow<String>, controlled: ControlledQuantity) -> Vec<String> {
    let mut all = Vec::new();
    all.extend(row.limits.as_ref().map(|limits| format!("tuned under {}", limits_words(limits))));
    if !row.blocks.is_empty() {
        all.push(row.blocks.iter().map(block_words).collect::<Vec<_>>().join(" "));
    }
    all.extend(row.weights.as_ref().map(|weights| weight_words(weights, controlled)));
    if let (Some(bound), Some(gap)) = (&row.bound, row.bound_gap()) {
        let half = gap.half_basis_percent.map_or("keeps no such limits".to_owned(), |above| {
            format!("is {} % above it", short_number(above))
        });
        all.push(format!(
            "a bound, not a controller: {} functions, limits of S, T, KS, noise gain and effort verified at {} frequencies; its value is {} % above the dual bound of the basis, and half the basis {half}",
            bound.basis,
            bound.frequencies,
            short_number(gap.above_dual_percent)
        ));
    }
    if row.missed > 0.0 {
        all.push(format!("A LIMIT IS MISSED by {} %", short_number(100.0 * row.missed)));
    }
    all.extend(row.why.as_ref().map(|why| format!("no controller: {why}")));
    all
}

/// Returns the table in Markdown, with its legend.
pub fn markdown_table(table: &DesignTableText, times_s: &[f64]) -> String {
    let columns = table_columns(table.loops);
    let mut text = format!("| design | {} |\n", columns.join(" | "));
    text += &format!("|---|{}\n", "---|".repeat(columns.len()));
    for (k, row) in table.rows.iter().enumerate() {
        let cells = design_cells(row, times_s.get(k).copied());
        text += &format!("| {} {} | {} |\n", k + 1, row.name, cells.join(" | "));
    }
    text.push('\n');
    for (k, row) in table.rows.iter().enumerate() {
        let words = design_remarks(row, table.loops.controlled);
        if !words.is_empty() {
            text += &format!("{}. {}: {}.\n", k + 1, row.name, words.join("; "));
        }
    }
    text.push('\n');
    for line in column_legend(table.loops) {
        text += &format!("{line}\n");
    }
    text
}

/// Returns the page.
pub fn comparison_report(table: &DesignTableText, times_s: &[f64], origin: &ReportOrigin) -> Report {
    let controlled = table.loops.controlled;
    let mut heads = vec![ReportColumn::Text("design")];
    heads.extend(table_columns(table.loops).map(ReportColumn::Number));
    let mut shown = ReportTable::new("Designs", &heads);
    for (k, row) in table.rows.iter().enumerate() {
        let mut line = vec![ReportCell::text(row.name.clone())];
        line.extend(design_cells(row, times_s.get(k).copied()).into_iter().map(ReportCell::text));
        shown.rows.push(line);
    }
    let mut details = ReportSection::new("What each design is");
    for row in &table.rows {
        let remarks = design_remarks(row, controlled);
        if !remarks.is_empty() {
            details = details.with_text(format!("{}: {}.", row.name, remarks.join("; ")));
        }
    }
    let legend = column_legend(table.loops)
        .into_iter()
        .fold(ReportSection::new("Columns"), |section, line| section.with_text(line));
    let best = best_row(table);
    let text = match best {
        Some(row) => format!("Least {} under {}: {}", controlled.name(), table.motion, row.name),
        None => "No design could be simulated".to_owned(),
    };
    let tiles = best.map(|row| tiles(row, controlled)).unwrap_or_default();
    let identity = ProjectIdentity { name: table.name.clone(), hash: table.hash.clone() };
    let report = Report {
        title: format!("Designs of {}", table.name),
        subtitle: format!("tuned structures make least: {}", table.objective),
        headline: Headline { tone: OutcomeTone::Neutral, text, detail: String::new() },
        tiles,
        verdicts: shown,
        glance: figure(table).into_iter().collect(),
        sections: vec![details, legend],
        provenance: origin.provenance(&identity),
    };
    report.with_command(&origin.command)
}

/// Returns every simulated design: what the loop controls against noise gain, each with its number.
fn figure(table: &DesignTableText) -> Option<Figure> {
    const COLOURS: [Colour; 4] = [Colour::First, Colour::Second, Colour::Third, Colour::Fourth];
    let mut marks = Vec::new();
    for (k, row) in table.rows.iter().enumerate() {
        let (Some(linear), Some(run)) = (&row.linear, &row.nonlinear) else { continue };
        marks.push(Mark::Point {
            x: linear.noise_gain,
            y: 1e3 * run.motion.value.unwrap_or(run.sines.value),
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
    let series = Series::dotted_line("", Colour::Muted, points);
    let controlled = table.loops.controlled;
    let y = Axis::linear(
        &format!("{} under the motion", controlled.name()),
        &format!("{} RMS", controlled.milli_unit()),
    );
    let panel = Panel::new(y, vec![series]).with_marks(marks);
    let x = Axis::linear("noise gain", controlled.gain_unit());
    let caption = "Down is less motion, left is less noise in the control. The line joins the designs in the order of the table.";
    let title = format!("{} against noise gain", capitalise_first(controlled.name()));
    Some(Figure::new(&title, x, vec![panel]).with_caption(caption))
}

/// Returns the row of the least controlled quantity under the motion.
fn best_row(table: &DesignTableText) -> Option<&DesignRow<String>> {
    let moved = |row: &DesignRow<String>| {
        row.nonlinear.as_ref().map(|run| run.motion.value.unwrap_or(run.sines.value))
    };
    let rows = table.rows.iter().filter_map(|row| Some((moved(row)?, row)));
    rows.min_by(|a, b| a.0.total_cmp(&b.0)).map(|pair| pair.1)
}

fn tiles(row: &DesignRow<String>, controlled: ControlledQuantity) -> Vec<FigureTile> {
    let mut all = Vec::new();
    if let Some(run) = &row.nonlinear {
        let moved = run.motion.value.unwrap_or(run.sines.value);
        let (name, unit) =
            (format!("{} under the motion", controlled.name()), format!("{} RMS", controlled.milli_unit()));
        all.push(FigureTile::plain(&name, short_number(1e3 * moved), &unit));
    }
    if let Some(linear) = &row.linear {
        all.push(FigureTile::plain("largest sensitivity", short_number(linear.max_sensitivity), ""));
        all.push(FigureTile::plain("noise gain", short_number(linear.noise_gain), controlled.gain_unit()));
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_columns_have_the_names_and_units_of_the_controlled_quantity() {
        let kinds = [QuantityKind::Rate, QuantityKind::Position, QuantityKind::Effort, QuantityKind::Current];
        for kind in kinds {
            for axis in [Travel::Rotary, Travel::Linear] {
                let controlled = ControlledQuantity { kind, axis, ..ControlledQuantity::RATE };
                let (milli, gain) = (controlled.milli_unit(), controlled.gain_unit());
                let loops = MeasuredLoops { objective: TuningObjective::Motion, controlled };
                let own = table_columns(loops);
                assert_eq!(own[7], format!("noise gain [{gain}]"));
                assert_eq!(own[8], format!("largest KS [{gain}]"));
                assert_eq!(own[11], format!("residual {} [{milli}]", controlled.name()));
                assert!(own[12..16].iter().all(|name| name.ends_with(&format!("[{milli}]"))), "{own:?}");
                assert!(column_legend(loops)[1].contains(controlled.name()));
                assert!(column_legend(loops)[2].contains(controlled.name()));
                let band = MeasuredLoops { objective: TuningObjective::Band, controlled };
                assert_eq!(table_columns(band)[EFFORT], format!("RMS of KS (band) [{gain}]"));
                assert_eq!(table_columns(band)[RESIDUAL], "RMS of S (band)");
                assert!(column_legend(band)[1].starts_with("RMS of S and of KS in the band"));
            }
        }
    }
}
