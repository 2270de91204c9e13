//! The reading of a project file and the values that are assumed, in words.

use counterpoise_pipeline::check::{CheckResult, OpenFact, PlantOverview};
use counterpoise_pipeline::studies::assumptions::{AssumptionEffect, EffectAtValue};
use counterpoise_project::diagnostic::MOST_SHOWN;
use counterpoise_project::{Assumption, KeyTolerance, SectionStatement, ValueStatement};

use crate::page::{ReportCell, ReportColumn, ReportSection, ReportTable};
use crate::tolerance::{MOST_COUNTED, NO_EFFECT};
use crate::wording::learned::describe_elements;

/// Returns the lines that `counterpoise check` prints.
pub fn check_lines(found: &CheckResult<String>) -> Vec<String> {
    let mut lines = vec![heading(found)];
    lines.extend(found.plant.iter().flat_map(plant));
    lines.push(String::new());
    lines.push("Understood:".to_owned());
    lines.extend(understood_sections(&stated_part(&found.sections, Origin::File)));
    let beside = stated_part(&found.sections, Origin::Elsewhere);
    if !beside.is_empty() {
        lines.push(String::new());
        lines.push("Taken beside it, by default or from what is stated elsewhere:".to_owned());
        lines.extend(understood_sections(&beside));
    }
    if !found.tolerances.is_empty() {
        lines.push(String::new());
        lines.push("Known within a tolerance:".to_owned());
        lines.extend(first_lines(&found.tolerances, MOST_LISTED, tolerance));
    }
    lines.push(String::new());
    lines.extend(assumption_lines(&found.assumptions));
    if !found.effects.is_empty() {
        lines.push(String::new());
    }
    lines.extend(ranking_lines(&found.effects));
    lines.extend(describe_open_facts(&found.open_facts));
    lines.push(String::new());
    lines.extend(found.warnings.iter().take(MOST_SHOWN).map(ToString::to_string));
    if found.warnings.len() > MOST_SHOWN {
        lines.push(format!("and {} more", found.warnings.len() - MOST_SHOWN));
    }
    lines.extend(first_lines(&found.problems, MOST_SHOWN, String::clone));
    lines.push(format!("Commands that can run on this file: {}.", found.commands.join(", ")));
    lines
}

fn heading(found: &CheckResult<String>) -> String {
    let format = found.format.map_or(String::new(), |format| format!(", format {format}"));
    let parts = match &found.parts[..] {
        [] => String::new(),
        parts => format!(", with the parts {}", parts.join(", ")),
    };
    format!("{}: \"{}\"{format}{parts}", found.file, found.machine)
}

/// Returns the plant in sentences.
fn plant(plant: &PlantOverview) -> Vec<String> {
    let mode = match (plant.first_mode_hz, plant.transmission_mode_hz) {
        (Some(hz), _) => format!("Its first flexible mode, with the hub held, is at {} Hz", short_number(hz)),
        (None, Some(hz)) => format!(
            "The structure is rigid; the first flexible mode is that of the {}, {} Hz",
            plant.transmission,
            short_number(hz)
        ),
        (None, None) => "It is rigid".to_owned(),
    };
    let (inertia, moment) = (short_number(plant.inertia_kg_m2), short_number(plant.out_of_balance_kg_m));
    let volts = short_number(plant.holding_v);
    let is_balanced = plant.out_of_balance_kg_m == 0.0;
    let balance = match (is_balanced, plant.is_sliding) {
        (true, false) => "it is balanced".to_owned(),
        (true, true) => "no weight acts along it".to_owned(),
        (false, false) => format!("its out-of-balance is {moment} kg m, which {volts} V of control hold"),
        (false, true) => format!("the weight of {moment} kg acts along it, which {volts} V of control hold"),
    };
    let body = match plant.is_sliding {
        false => format!("The structure has an inertia of {inertia} kg m^2"),
        true => format!("The slide has a mass of {inertia} kg"),
    };
    let functions = describe_elements(&plant.learned);
    let functions =
        functions.iter().map(|f| format!("A free function is part of it: {}; {}.", f.reading, f.range));
    let mut sentences = vec![
        format!("{body}; {balance}."),
        format!(
            "{mode}. The linear plant has order {}; the controller runs at {} Hz.",
            plant.order,
            short_number(plant.sample_rate_hz)
        ),
    ];
    sentences.extend(functions);
    sentences
}

/// Returns the first lines of a list, and how many it has beside them.
fn first_lines<T>(items: &[T], most: usize, line: impl Fn(&T) -> String) -> Vec<String> {
    let mut lines: Vec<String> = items.iter().take(most).map(line).collect();
    if let Some(more) = items.len().checked_sub(most).filter(|more| *more > 0) {
        lines.push(format!("  and {more} more (--json lists all)"));
    }
    lines
}

/// Returns the sections, one a line: of sections of one kind, masses for example, only the first ones.
fn understood_sections(sections: &[SectionStatement]) -> Vec<String> {
    let kind = |section: &SectionStatement| section.path.split('[').next().unwrap_or_default().to_owned();
    let is_alike = |a: &SectionStatement, b: &SectionStatement| kind(a) == kind(b);
    sections.chunk_by(is_alike).flat_map(|alike| first_lines(alike, MOST_ALIKE, section)).collect()
}

/// The origin of a value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Origin {
    /// The value is written in the file.
    File,
    /// The value is a default, or follows from other keys.
    Elsewhere,
}

/// Returns the sections with the values that come from one place; those without any are left out. The machine's name stands in the
/// heading.
fn stated_part(sections: &[SectionStatement], origin: Origin) -> Vec<SectionStatement> {
    let is_here = |value: &ValueStatement| value.written.is_some() == (origin == Origin::File);
    let is_in_heading = |section: &SectionStatement, key: &str| section.path == "plant" && key == "name";
    let part = |section: &SectionStatement| {
        let mut part = section.clone();
        part.values.retain(|value| is_here(value) && !is_in_heading(section, &value.key));
        (!part.values.is_empty()).then_some(part)
    };
    sections.iter().filter_map(part).collect()
}

/// Returns a section on one line: its meaning, then its values.
fn section(section: &SectionStatement) -> String {
    let values: Vec<String> = section.values.iter().map(value).collect();
    format!("  {} ({}): {}", section.path, section.meaning, values.join(", "))
}

/// Returns a value as the file spells it; a quantity with a unit of its own is followed by what it is in the unit of the key.
fn value(value: &ValueStatement) -> String {
    let with_unit = |text: &str| match value.unit {
        "" => text.to_owned(),
        unit => format!("{text} {unit}"),
    };
    let number = value.value.parse::<f64>().ok();
    let rounded = with_unit(&number.map_or_else(|| value.value.clone(), short_number));
    let shown = match &value.written {
        Some(written) if number.is_some() && written.parse::<f64>().is_ok() => with_unit(written),
        Some(written) if number.is_some() && *written != rounded => format!("{written} ({rounded})"),
        _ => rounded,
    };
    format!("{} {shown}", value.key.replace('_', " "))
}

fn tolerance(tolerance: &KeyTolerance) -> String {
    let [low, high] = tolerance.range();
    format!("  {}: {} to {}", tolerance.key, short_number(low), with_unit(high, tolerance.unit))
}

/// Most assumptions, and most tolerances, that are listed one by one.
const MOST_LISTED: usize = 60;
/// Most sections of one kind that are listed one by one.
const MOST_ALIKE: usize = 20;

/// Returns what is assumed, one value a line; keys that nothing is taken for stand together at the end.
fn assumption_lines(assumptions: &[Assumption]) -> Vec<String> {
    if assumptions.is_empty() {
        return vec!["Nothing is assumed: every value of the plant is stated.".to_owned()];
    }
    let is_nothing = |a: &&Assumption| a.value == 0.0 && a.usual.is_none();
    let (nothing, something): (Vec<&Assumption>, Vec<&Assumption>) = assumptions.iter().partition(is_nothing);
    let line =
        |a: &&Assumption| format!("  {} = {} ({}; {})", a.key, with_unit(a.value, a.unit), a.rule, a.source);
    let mut lines = vec!["Assumed, because the file does not state it:".to_owned()];
    lines.extend(first_lines(&something, MOST_LISTED, line));
    if !nothing.is_empty() {
        lines.push("  0, as in an ideal machine:".to_owned());
        let section = |a: &&Assumption| section_of(&a.key).to_owned();
        let alike: Vec<&[&Assumption]> = nothing.chunk_by(|a, b| section(a) == section(b)).collect();
        lines.extend(first_lines(&alike, MOST_LISTED, |alike| {
            let keys: Vec<&str> = alike.iter().map(|a| key_of(&a.key)).collect();
            format!("    {}: {}", section(&alike[0]), keys.join(", "))
        }));
    }
    lines
}

/// Returns the path of the section in which a key stands.
fn section_of(path: &str) -> &str {
    path.rsplit_once('.').map_or("", |(section, _)| section)
}

/// Returns a key without the path of its section.
fn key_of(path: &str) -> &str {
    path.rsplit_once('.').map_or(path, |(_, key)| key)
}

/// Returns how much the assumptions matter, one on a line below a heading, the largest effect first, and those without an effect together on
/// the last line; nothing if none is ranked.
pub fn ranking_lines(effects: &[AssumptionEffect]) -> Vec<String> {
    if effects.is_empty() {
        return Vec::new();
    }
    let heading = "What the assumptions may cost, the most important first (measure this next):".to_owned();
    std::iter::once(heading)
        .chain(
            effects.iter().filter(|e| has_effect(e)).map(|effect| format!("  {}", describe_effect(effect))),
        )
        .chain(describe_no_effect(effects).map(|line| format!("  {line}")))
        .collect()
}

/// Returns the facts that are not known and lower the ceiling of the bandwidth, as one sentence; nothing if there is none.
fn describe_open_facts(facts: &[OpenFact]) -> Option<String> {
    let ceiling = facts.first()?.ceiling_if_known_rad_s;
    let keys: Vec<&str> = facts.iter().map(|fact| fact.key.as_str()).collect();
    Some(format!(
        "Not known, and each lowers the ceiling of the bandwidth by 3 dB (stated, each raises it to {} rad/s, if nothing else limits): {}.",
        short_number(ceiling),
        keys.join(", ")
    ))
}

/// Returns whether an assumption that is wrong by its usual range changes a figure of the loop by what two decimals show.
pub fn has_effect(effect: &AssumptionEffect) -> bool {
    effect.at.iter().any(changes_loop)
}

fn changes_loop(at: &EffectAtValue) -> bool {
    let changes = [
        at.gain_margin_change_db,
        at.phase_margin_change_deg,
        at.sensitivity_change_db,
        at.residual_change_db,
    ];
    !at.is_stable || changes.into_iter().flatten().any(|change| change.abs() >= NO_EFFECT)
}

/// Returns the keys whose usual range has no effect on the loop as one sentence without a period; `None` if each has one.
pub fn describe_no_effect(effects: &[AssumptionEffect]) -> Option<String> {
    let keys: Vec<&str> = effects.iter().filter(|e| !has_effect(e)).map(|e| e.key.as_str()).collect();
    (!keys.is_empty())
        .then(|| format!("no effect on the linear loop anywhere in their usual ranges: {}", keys.join(", ")))
}

/// Returns what the loop loses or gains if an assumption is wrong by its usual range, as one sentence without a period; an end of the range that changes
/// nothing is left out.
pub fn describe_effect(effect: &AssumptionEffect) -> String {
    let ends = effect.at.iter().filter(|at| changes_loop(at));
    let ends = ends.map(|at| format!("at {} {}", with_unit(at.value, effect.unit), change(at)));
    format!("{}: {}", effect.key, ends.collect::<Vec<_>>().join("; "))
}

fn change(at: &EffectAtValue) -> String {
    if !at.is_stable {
        return "the loop is unstable".to_owned();
    }
    let part = |name: &str, value: Option<f64>, unit: &str| {
        let value = value.filter(|value| value.abs() >= NO_EFFECT);
        value.map(|value| format!("{name} {value:+.2}{unit}"))
    };
    let parts = [
        part("gain margin", at.gain_margin_change_db, " dB"),
        part("phase margin", at.phase_margin_change_deg, " deg"),
        part("sensitivity", at.sensitivity_change_db, " dB"),
        part("residual", at.residual_change_db, " dB"),
    ];
    parts.into_iter().flatten().collect::<Vec<_>>().join(", ")
}

fn with_unit(value: f64, unit: &str) -> String {
    if unit.is_empty() { short_number(value) } else { format!("{} {unit}", short_number(value)) }
}

/// Returns a number with up to four significant digits, and a whole number, which counts something, with all of its digits.
fn short_number(value: f64) -> String {
    if value.is_infinite() {
        return "infinite".to_owned();
    }
    if value.fract() == 0.0 && value.abs() < MOST_COUNTED {
        return value.to_string();
    }
    let rounded: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    let size = rounded.abs();
    if rounded == 0.0 || (1e-3..1e6).contains(&size) { rounded.to_string() } else { format!("{rounded:e}") }
}

/// Returns the section of a report that lists what is assumed, and what each assumption may cost.
pub fn assumptions_section(assumptions: &[Assumption], effects: &[AssumptionEffect]) -> ReportSection {
    let mut section = ReportSection::new("Assumptions");
    if assumptions.is_empty() {
        return section.with_text("Every value of the plant is stated in the project file.".to_owned());
    }
    section = section.with_text(
        "The project file does not state these values of the plant. For those whose usual range is known, a second table says what the loop loses or gains at either end of it, the largest change first: measure that value next."
            .to_owned(),
    );
    let columns = [
        ReportColumn::Text("key"),
        ReportColumn::Text("value"),
        ReportColumn::Text("rule"),
        ReportColumn::Text("source"),
    ];
    let mut table = ReportTable::new("Assumed values", &columns);
    for a in assumptions {
        let texts = [a.key.clone(), with_unit(a.value, a.unit), a.rule.to_owned(), a.source.to_owned()];
        table.rows.push(texts.into_iter().map(ReportCell::Text).collect());
    }
    section.tables.push(table);
    if effects.iter().any(has_effect) {
        section.tables.push(effects_table(effects));
    }
    match describe_no_effect(effects) {
        Some(line) => section.with_text(format!("There is {line}.")),
        None => section,
    }
}

/// Returns the effects of assumptions as a table, a row for each end of a usual range.
fn effects_table(effects: &[AssumptionEffect]) -> ReportTable {
    let columns = [
        ReportColumn::Text("key"),
        ReportColumn::Text("at the value"),
        ReportColumn::Number("gain margin [dB]"),
        ReportColumn::Number("phase margin [deg]"),
        ReportColumn::Number("sensitivity [dB]"),
        ReportColumn::Number("residual [dB]"),
    ];
    let mut table = ReportTable::new("Change if an assumption is wrong by its usual range", &columns);
    for effect in effects.iter().filter(|effect| has_effect(effect)) {
        for at in &effect.at {
            let change = |value: Option<f64>| match value {
                _ if !at.is_stable => ReportCell::text("unstable"),
                Some(value) => ReportCell::number(value),
                None => ReportCell::text("-"),
            };
            table.rows.push(vec![
                ReportCell::text(effect.key.as_str()),
                ReportCell::Text(with_unit(at.value, effect.unit)),
                change(at.gain_margin_change_db),
                change(at.phase_margin_change_deg),
                change(at.sensitivity_change_db),
                change(at.residual_change_db),
            ]);
        }
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_count_keeps_its_digits_and_a_measured_value_four() {
        let texts = [16384.0, -12.0, 0.0, 3.24681, 1.23456e-5, 4.2e12].map(short_number);
        assert_eq!(texts, ["16384", "-12", "0", "3.247", "1.235e-5", "4.2e12"]);
    }
}
