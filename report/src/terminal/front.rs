//! What `counterpoise synth --search` prints of a front: its kinds, every design with its figures, and the design that was chosen.

use super::add_line;
use crate::designs::limits_words;
use crate::front::{ObjectiveWords, content_words, headline_words, objective_words, standing_words};
use crate::results::FrontText;

/// Width of the column of a figure, and of that of a name.
const FIGURE: usize = 17;
const NAME: usize = 28;

/// Returns the lines on a front.
pub fn front_lines(front: &FrontText) -> Vec<String> {
    let mut lines = vec![headline_words(front)];
    let limits = limits_words(&front.limits);
    add_line!(lines, "the residual is the {}; every design keeps {limits}", front.objective);
    for kind in &front.kinds {
        match &kind.why {
            Some(why) => add_line!(lines, "{}: no front: {why}", kind.name),
            None => add_line!(lines, "{}: {} feedbacks were evaluated", kind.name, kind.evaluations),
        }
    }
    add_line!(lines);
    add_designs(&mut lines, front);
    add_line!(lines);
    match front.chosen.and_then(|number| front.designs.get(number - 1)) {
        Some(design) => {
            add_line!(lines, "design {} was chosen: {}", design.number, content_words(front, design));
            add_verdicts(&mut lines, front);
        }
        None => add_line!(lines, "`--choose NUMBER --save FILE` verifies a design and writes it"),
    }
    lines
}

/// Adds the table of the designs, below those that they are compared with.
fn add_designs(lines: &mut Vec<String>, front: &FrontText) {
    let words = objective_words(front);
    let row = |number: &str, name: &str, cells: Vec<String>, standing: &str| {
        let cells: String = cells.iter().map(|cell| format!("{cell:>FIGURE$}")).collect();
        format!("{number:>4}  {name:NAME$}{cells}   {standing}")
    };
    let unit =
        |word: &ObjectiveWords| if word.unit.is_empty() { String::new() } else { format!("[{}]", word.unit) };
    let short = |word: &ObjectiveWords| word.name.chars().take(FIGURE - 1).collect::<String>();
    lines.push(row("", "", words.iter().map(short).collect(), ""));
    lines.push(row("", "", words.iter().map(unit).collect(), ""));
    let cells =
        |figures: &[f64]| words.iter().zip(figures).map(|(word, figure)| word.show(*figure)).collect();
    for reference in &front.references {
        lines.push(row("", &reference.name, cells(&reference.figures), "to compare with"));
    }
    for design in &front.designs {
        let (number, standing) = (design.number.to_string(), standing_words(design));
        lines.push(row(&number, &design.kind, cells(&design.figures), standing));
    }
}

fn add_verdicts(lines: &mut Vec<String>, front: &FrontText) {
    let Some(found) = &front.verified else {
        return add_line!(lines, "no [verify] section: the figures are those of the linear loop alone");
    };
    let [holds, fails, _] = found.verdicts;
    add_line!(lines, "verified on the nonlinear plant: {holds} requirements hold, {fails} fail");
    found.failing.iter().for_each(|line| add_line!(lines, "    {line}"));
}
