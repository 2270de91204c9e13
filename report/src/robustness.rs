//! The linear worst case: how far all stated ranges may be widened together, in words and as a section.

use counterpoise_verify::structured::{DestabilisingMechanism, RobustStability};

use crate::wording::figures::describe_modulus;
use crate::{ReportCell, ReportColumn, ReportSection, ReportTable};
use counterpoise_plot::number::short_number;
use counterpoise_plot::{Axis, Colour, Figure, Mark, Panel, Series};

/// Returns what was found, a line each: for a terminal and for the section's text.
pub fn robustness_lines(found: &RobustStability) -> Vec<String> {
    let word = robustness_word(found);
    let mut lines = vec![format!(
        "{word}: stable for every mechanism within {} times the stated ranges{} (upper bound of mu, largest at {} Hz)",
        short_number(found.guaranteed),
        errors(found),
        short_number(found.worst_hz)
    )];
    lines.push(found.found.as_ref().map_or(
        "no mechanism with which the loop is unstable was found by the search".to_owned(),
        describe_nearest,
    ));
    if let Some(rate) = found.dry_friction_at_rad_s {
        lines.push(format!(
            "dry friction counts as the viscous friction that takes as much work at a hub rate of {} rad/s",
            short_number(rate)
        ));
    }
    if !found.left_out.is_empty() {
        let keys: Vec<&str> = found.left_out.iter().map(|varied| varied.key()).collect();
        lines.push(format!("not in the linear loop: {}", keys.join(", ")));
    }
    lines
}

/// Returns whether a loop is robust in the stated ranges, in words.
pub fn robustness_word(found: &RobustStability) -> &'static str {
    let unstable = found.found.as_ref().is_some_and(|nearest| nearest.scale < 1.0);
    match (found.guaranteed >= 1.0, unstable) {
        (true, _) => "robust",
        (false, true) => "NOT robust: within the stated ranges the loop can be unstable",
        (false, false) => "not shown to be robust",
    }
}

fn errors(found: &RobustStability) -> String {
    let names = ["the plant's gain at its input", "the loop's sensor"];
    let present = names.iter().zip(found.errors).filter(|(_, error)| *error > 0.0);
    let words: Vec<String> =
        present.map(|(name, error)| format!("{} % of {name}", short_number(100.0 * error))).collect();
    if words.is_empty() {
        String::new()
    } else {
        format!(", with as many times {} at any phase", words.join(" and "))
    }
}

/// Returns the nearest mechanism at the limit of stability.
fn describe_nearest(found: &DestabilisingMechanism) -> String {
    let mut parts: Vec<String> = found
        .factors
        .iter()
        .map(|(varied, factor)| format!("{} x {}", varied.key(), short_number(*factor)))
        .collect();
    let errors = gain_errors(found, ["plant's input", "loop's sensor"]);
    parts.extend(errors.map(|(name, error)| format!("{name} off by {error}")));
    format!(
        "nearest limit that was found: {} times the ranges, oscillating at {} Hz: {}; the loop closed with it has a pole of modulus {}",
        short_number(found.scale),
        short_number(found.frequency_hz),
        parts.join(", "),
        describe_modulus(found.pole.norm())
    )
}

/// Returns the errors of gain that are not zero, as modulus and angle, each with its name.
fn gain_errors(
    found: &DestabilisingMechanism,
    names: [&'static str; 2],
) -> impl Iterator<Item = (&'static str, String)> {
    names.into_iter().zip(found.errors).filter(|(_, error)| error.norm() > 0.0).map(|(name, error)| {
        let (modulus, angle_rad) = error.to_polar();
        (name, format!("{} % at {:.0} deg", short_number(100.0 * modulus), angle_rad.to_degrees()))
    })
}

/// Returns the section: the lines, the bounds over frequency, the nearest mechanism.
pub fn robustness_section(found: &RobustStability) -> ReportSection {
    let mut section = ReportSection::new("Linear worst case");
    for line in robustness_lines(found) {
        let first = line.chars().next().map(|c| c.to_uppercase().to_string()).unwrap_or_default();
        section = section.with_text(format!("{first}{}.", line.chars().skip(1).collect::<String>()));
    }
    section = section.with_text(
        "The structured singular value mu at a frequency is 1 over the number of times that the ranges must be widened for the loop to \
         oscillate there. Real parameters are real numbers; the errors of gain have any phase. Below the upper curve lies mu, above \
         the lower one, and the lower one is drawn where a perturbation was found. A range is \
         widened so that no parameter becomes negative: one from half to double reaches 0 and infinity at three times, so that a mu \
         of 1/3 all along says no more than that.",
    );
    let section = section.with_figures([bounds(found)]);
    match &found.found {
        Some(nearest) => section.with_table(table(nearest)),
        None => section,
    }
}

fn bounds(found: &RobustStability) -> Figure {
    let points = |value: fn(&counterpoise_verify::structured::Bounds) -> f64| {
        found.bounds.iter().map(move |at| (at.frequency_hz, value(at))).filter(|point| point.1 > 0.0)
    };
    let series = vec![
        Series::solid_line("upper bound", Colour::First, points(|at| at.upper)),
        Series::dotted_line("lower bound", Colour::Second, points(|at| at.lower)),
    ];
    let marks = vec![Mark::Level { y: 1.0, text: "unstable within the stated ranges above this".to_owned() }];
    let panel = Panel::new(Axis::linear("structured singular value", ""), series).with_marks(marks);
    Figure::new("Structured singular value", Axis::logarithmic("frequency", "Hz"), vec![panel])
}

fn table(found: &DestabilisingMechanism) -> ReportTable {
    let columns = [ReportColumn::Text("parameter"), ReportColumn::Number("factor at the limit")];
    let mut table = ReportTable::new("The nearest mechanism at the limit of stability", &columns);
    for (varied, factor) in &found.factors {
        table.rows.push(vec![ReportCell::text(varied.key()), ReportCell::number(*factor)]);
    }
    for (name, error) in gain_errors(found, ["error at the plant's input", "error of the loop's sensor"]) {
        table.rows.push(vec![ReportCell::text(name), ReportCell::text(error)]);
    }
    table
}
