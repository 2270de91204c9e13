//! The reference of the project file's keys, for a terminal.

/// A section of the reference.
struct Section<'r> {
    /// Path, without brackets; empty at the top of the file.
    path: &'r str,
    /// Meaning, with what may be absent.
    meaning: &'r str,
    lines: Vec<&'r str>,
}

/// Returns what the reference says of a section, a key, or the figures of requirements, in lines; the sections for an empty word. `None` if it has nothing of that name.
pub fn key_lines(reference: &str, asked: &str) -> Option<Vec<String>> {
    let sections = read_sections(reference);
    let asked = asked.trim_matches(['[', ']']);
    if asked.is_empty() {
        return Some(section_lines(&sections));
    }
    if let Some(section) = sections.iter().find(|section| section.path == asked) {
        let inside = format!("{asked}.");
        let parts = sections.iter().filter(|part| part.path.starts_with(&inside));
        return Some(whole_section(section).into_iter().chain(parts.map(heading)).collect());
    }
    let found: Vec<String> = sections.iter().flat_map(|section| rows_of_key(section, asked)).collect();
    (!found.is_empty()).then_some(found)
}

fn read_sections(reference: &str) -> Vec<Section<'_>> {
    let mut sections: Vec<Section<'_>> = Vec::new();
    for line in reference.lines() {
        if let Some(title) = line.strip_prefix("## ") {
            let path = title.split('`').nth(1).unwrap_or_default().trim_matches(['[', ']']);
            let (path, meaning) = match title.split_once("`: ") {
                Some((_, meaning)) => (path, meaning),
                None if title.to_lowercase().starts_with(FIGURES) => (FIGURES, title),
                None => ("", title),
            };
            sections.push(Section { path, meaning, lines: Vec::new() });
        } else if let Some(section) = sections.last_mut() {
            section.lines.push(line);
        }
    }
    sections
}

/// The word for the figures that a requirement may limit.
const FIGURES: &str = "figures";

fn section_lines(sections: &[Section<'_>]) -> Vec<String> {
    let named = sections.iter().filter(|section| !section.path.is_empty());
    let end = [
        "",
        "`counterpoise check --keys=SECTION` lists the keys of a section, `--keys=KEY` tells those of a name",
    ];
    named.map(heading).chain(end.map(str::to_owned)).collect()
}

fn heading(section: &Section<'_>) -> String {
    match section.path {
        FIGURES => format!("{FIGURES}  {}", section.meaning),
        path => format!("[{path}]  {}", section.meaning),
    }
}

fn whole_section(section: &Section<'_>) -> Vec<String> {
    let rows = section.lines.iter().filter_map(|line| match line.starts_with("| `") {
        true => row(line).map(|row| format!("  {row}")),
        false if line.is_empty() || line.starts_with('|') => None,
        false => Some((*line).to_owned()),
    });
    std::iter::once(heading(section)).chain(rows).collect()
}

/// The rows of a key, named by its path or by its last part.
fn rows_of_key(section: &Section<'_>, asked: &str) -> Vec<String> {
    let in_section = asked.strip_prefix(section.path).and_then(|rest| rest.strip_prefix('.'));
    let is_asked = |line: &&&str| {
        let name = line.strip_prefix("| `").and_then(|rest| rest.split('`').next());
        name.is_some_and(|name| name == asked || Some(name) == in_section)
    };
    let rows = section.lines.iter().filter(is_asked).filter_map(|line| row(line));
    rows.map(|row| format!("[{}] {row}", section.path)).collect()
}

/// A row of a table as a sentence without its full stop.
fn row(line: &str) -> Option<String> {
    let cells: Vec<String> =
        line.trim_matches('|').split('|').map(|cell| cell.trim().replace('`', "")).collect();
    match &cells[..] {
        [name, unit, allowed, absent, meaning] => {
            let unit = if unit.is_empty() { String::new() } else { format!(" [{unit}]") };
            let absent = match absent.as_str() {
                "must be there" => absent.clone(),
                other => format!("{other} if absent"),
            };
            Some(format!("{name}{unit}: {meaning}; {allowed}; {absent}"))
        }
        [name, unit] if unit.is_empty() => Some(name.clone()),
        [name, unit] => Some(format!("{name} [{unit}]")),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    const REFERENCE: &str = "# Keys\n\n## at the top of the file\n\n| key | unit | allowed | if absent | meaning |\n|---|---|---|---|---|\n\
        | `format` |  | a whole number | 2 | format |\n\n## `[plant.gearbox]`: gearbox (may be absent)\n\n| key | unit | allowed | if absent | meaning |\n|---|---|---|---|---|\n\
        | `ratio` |  | > 0 | must be there | motor turns per hub turn |\n| `backlash` | rad | >= 0 | 0 | total gap |\n\n\
        ## `[plant.gearbox.mesh_ripple]`: ripple\n\nKeys as in `[plant.friction]`.\n\n## Figures of requirements\n\n| figure | unit |\n|---|---|\n| `gain_margin_db` | dB |\n";

    fn lines(asked: &str) -> String {
        key_lines(REFERENCE, asked).unwrap().join("\n")
    }

    #[test]
    fn sections_keys_and_figures_are_found_by_their_names() {
        assert!(lines("").contains("[plant.gearbox]  gearbox (may be absent)"), "{}", lines(""));
        let section = "[plant.gearbox]  gearbox (may be absent)\n  ratio: motor turns per hub turn; > 0; must be there\n  backlash [rad]: total gap; >= 0; 0 if absent\n\
                       [plant.gearbox.mesh_ripple]  ripple";
        assert_eq!(lines("plant.gearbox"), section);
        assert_eq!(lines("[plant.gearbox]"), section);
        let key = "[plant.gearbox] backlash [rad]: total gap; >= 0; 0 if absent";
        assert_eq!([lines("backlash"), lines("plant.gearbox.backlash")], [key, key]);
        assert!(lines("figures").contains("gain_margin_db [dB]"), "{}", lines("figures"));
        assert_eq!(key_lines(REFERENCE, "plant.gearbox.colour"), None);
    }
}
