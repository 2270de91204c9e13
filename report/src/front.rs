//! The front of a project's designs: every kind on one plot, with the tuned PI as the bar to clear.

use counterpoise_pipeline::ProjectIdentity;
use counterpoise_pipeline::tuning::MeasuredLoops;
use counterpoise_plot::number::short_number;
use counterpoise_plot::{Axis, Colour, Figure, Mark, Panel, Series};
use counterpoise_project::TuningObjective;
use counterpoise_synth::FrontObjective;

use crate::designs::{block_words, limits_words, table_columns, weight_words};
use crate::results::FrontText;
use crate::results::front::FrontDesign;
use crate::tolerance::DECADE;
use crate::wording::capitalise_first;
use crate::{
    FigureTile, Headline, OutcomeTone, Report, ReportCell, ReportColumn, ReportOrigin, ReportSection,
    ReportTable,
};

/// Colours of the kinds and of the single designs, in their order.
const KINDS: [Colour; 3] = [Colour::First, Colour::Second, Colour::Third];
const REFERENCES: [Colour; 3] = [Colour::Fourth, Colour::Fifth, Colour::Sixth];
/// Room at either end of an axis, as a share of the range of the designs.
const ROOM: f64 = 0.05;

/// An objective as a person reads it.
#[derive(Debug, Clone, PartialEq)]
pub struct ObjectiveWords {
    /// Name with its unit.
    pub heading: &'static str,
    /// Name.
    pub name: &'static str,
    /// Unit in which it is shown; empty for a ratio.
    pub unit: &'static str,
    /// Factor from the figure in SI units to the figure that is shown.
    pub scale: f64,
}

impl ObjectiveWords {
    /// Returns the words for an objective of loops.
    pub fn of(objective: FrontObjective, loops: MeasuredLoops) -> Self {
        let (column, scale) = match objective {
            FrontObjective::Residual if loops.objective == TuningObjective::Band => (11, 1.0),
            FrontObjective::Residual => (11, 1e3),
            FrontObjective::Effort => (9, 1.0),
            FrontObjective::NoiseGain => (7, 1.0),
            FrontObjective::MaxSensitivity => (1, 1.0),
            FrontObjective::MaxComplementary => (2, 1.0),
            FrontObjective::ControlPeak => (8, 1.0),
            FrontObjective::GainMargin => (3, 1.0),
            FrontObjective::PhaseMargin => (4, 1.0),
            FrontObjective::DelayMargin => (5, 1e3),
        };
        let heading = table_columns(loops)[column];
        let (name, unit) = heading.split_once(" [").unwrap_or((heading, ""));
        Self { heading, name, unit: unit.trim_end_matches(']'), scale }
    }

    /// Returns a figure in the shown unit; "none" for a margin that is infinite.
    pub fn show(&self, figure: f64) -> String {
        if figure.is_infinite() { "none".to_owned() } else { short_number(self.scale * figure) }
    }
}

/// Returns the columns of the objectives, in words.
pub fn objective_words(front: &FrontText) -> Vec<ObjectiveWords> {
    front.objectives.iter().map(|each| ObjectiveWords::of(*each, front.loops)).collect()
}

/// Returns how a design stands against the others.
pub fn standing_words(design: &FrontDesign) -> &'static str {
    match (design.nondominated, design.clears_bar) {
        (true, _) => "best",
        (false, true) => "another kind is better",
        (false, false) => "a PI with a lag is better",
    }
}

/// Returns what a design consists of.
pub fn content_words(front: &FrontText, design: &FrontDesign) -> String {
    match &design.weights {
        Some(weights) => weight_words(weights, front.loops.controlled),
        None => design.blocks.iter().map(block_words).collect::<Vec<_>>().join(" "),
    }
}

/// Returns the answer in a sentence: how many designs of each kind no other beats.
pub fn headline_words(front: &FrontText) -> String {
    let of = |kind: &crate::results::front::KindText| match &kind.why {
        Some(_) => format!("{}: no front", kind.name),
        None => format!("{}: {} of {}", kind.name, kind.nondominated, kind.designs),
    };
    format!(
        "Designs that no other beats in every objective: {}",
        front.kinds.iter().map(of).collect::<Vec<_>>().join("; ")
    )
}

/// Returns the page of a front.
pub fn front_report(front: &FrontText, origin: &ReportOrigin) -> Report {
    let words = objective_words(front);
    let mut kinds = ReportSection::new("Kinds of designs").with_text(format!(
        "Every design keeps {}, on {} plant{}.",
        limits_words(&front.limits),
        front.plants,
        if front.plants == 1 { "" } else { "s" }
    ));
    for kind in &front.kinds {
        let text = match &kind.why {
            Some(why) => format!("{}: no front, because of {why}.", kind.name),
            None => format!("{}: {} designs of {} feedbacks.", kind.name, kind.designs, kind.evaluations),
        };
        kinds = kinds.with_text(text);
    }
    let mut content = ReportSection::new("What each design is");
    for design in &front.designs {
        content = content.with_text(format!(
            "{}. {}: {}.",
            design.number,
            design.kind,
            content_words(front, design)
        ));
    }
    let identity = ProjectIdentity { name: front.name.clone(), hash: front.hash.clone() };
    let detail = match front.chosen {
        Some(number) => format!("Design {number} was chosen."),
        None => format!("The residual is the {}.", front.objective),
    };
    let report = Report {
        title: format!("Front of designs of {}", front.name),
        subtitle: "designs of which none is better than another in every objective".to_owned(),
        headline: Headline { tone: OutcomeTone::Neutral, text: headline_words(front), detail },
        tiles: tiles(front, &words),
        verdicts: designs_table(front, &words),
        glance: figures(front, &words),
        sections: vec![kinds, content],
        provenance: origin.provenance(&identity),
    };
    report.with_command(&origin.command)
}

fn tiles(front: &FrontText, words: &[ObjectiveWords]) -> Vec<FigureTile> {
    let chosen = front.chosen.and_then(|number| front.designs.get(number - 1));
    let tile = |(k, word): (usize, &ObjectiveWords)| match chosen {
        Some(design) => FigureTile::plain(word.name, word.show(design.figures[k]), word.unit),
        None => FigureTile::plain(&format!("best {}", word.name), word.show(front.best[k]), word.unit),
    };
    words.iter().enumerate().map(tile).collect()
}

fn designs_table(front: &FrontText, words: &[ObjectiveWords]) -> ReportTable {
    let mut heads = vec![ReportColumn::Number("number"), ReportColumn::Text("kind")];
    heads.extend(words.iter().map(|word| ReportColumn::Number(word.heading)));
    heads.push(ReportColumn::Text("standing"));
    let mut table = ReportTable::new("Designs", &heads);
    let cells = |figures: &[f64]| -> Vec<ReportCell> {
        words.iter().zip(figures).map(|(word, figure)| ReportCell::text(word.show(*figure))).collect()
    };
    for reference in &front.references {
        let mut row = vec![ReportCell::text(""), ReportCell::text(reference.name.clone())];
        row.extend(cells(&reference.figures));
        row.push(ReportCell::text("to compare with"));
        table.rows.push(row);
    }
    for design in &front.designs {
        let mut row =
            vec![ReportCell::text(design.number.to_string()), ReportCell::text(design.kind.clone())];
        row.extend(cells(&design.figures));
        row.push(ReportCell::text(standing_words(design)));
        table.rows.push(row);
    }
    table
}

/// Returns the first objective against each of the others: every kind, and the designs to compare with.
pub fn figures(front: &FrontText, words: &[ObjectiveWords]) -> Vec<Figure> {
    (1..words.len()).filter_map(|k| figure(front, words, k)).collect()
}

/// Returns where each design stands in each of the [`figures`]: figure by figure, design by design.
pub fn design_places(front: &FrontText) -> Vec<Vec<[f64; 2]>> {
    let words = objective_words(front);
    let in_figure =
        |other: usize| front.designs.iter().map(|design| place_of(&words, other, &design.figures)).collect();
    (1..words.len()).map(in_figure).collect()
}

/// Returns the place of some figures where the first objective is drawn against another.
fn place_of(words: &[ObjectiveWords], other: usize, figures: &[f64]) -> [f64; 2] {
    [words[other].scale * figures[other], words[0].scale * figures[0]]
}

fn figure(front: &FrontText, words: &[ObjectiveWords], other: usize) -> Option<Figure> {
    let at = |figures: &[f64]| place_of(words, other, figures);
    let is_drawn = |point: &[f64; 2]| point.iter().all(|value| value.is_finite());
    let (mut marks, mut series, mut all) = (Vec::new(), Vec::new(), Vec::new());
    for (kind, colour) in front.kinds.iter().zip(KINDS) {
        let of_kind = front.designs.iter().filter(|design| design.kind == kind.name);
        let points: Vec<[f64; 2]> = of_kind.map(|design| at(&design.figures)).filter(is_drawn).collect();
        marks.extend(points.iter().map(|&[x, y]| Mark::Cross { x, y, text: String::new(), colour }));
        all.extend(points);
        let edge = kind.edges[other - 1].iter().map(|place| at(&front.designs[*place].figures));
        series.push(Series::solid_line(&kind.name, colour, edge.map(|[x, y]| (x, y))));
    }
    for (reference, colour) in front.references.iter().zip(REFERENCES) {
        let [x, y] = at(&reference.figures);
        if is_drawn(&[x, y]) {
            all.push([x, y]);
            marks.push(Mark::Point { x, y, text: reference.name.clone(), colour });
        }
    }
    if let Some(design) = front.chosen.and_then(|number| front.designs.get(number - 1)) {
        let [x, y] = at(&design.figures);
        marks.push(Mark::Point { x, y, text: format!("chosen: {}", design.number), colour: Colour::First });
    }
    if all.is_empty() {
        return None;
    }
    let axis = |word: &ObjectiveWords, place: usize| {
        let values = all.iter().map(|point| point[place]);
        let (low, high) = values
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
        if low > 0.0 && high > DECADE * low {
            let room = (high / low).powf(ROOM);
            return Axis::logarithmic(word.name, word.unit).with_range(low / room, high * room);
        }
        let room = ROOM * if high > low { high - low } else { high.abs().max(1.0) };
        Axis::linear(word.name, word.unit).with_range(low - room, high + room)
    };
    let panel = Panel::new(axis(&words[0], 1), series).with_marks(marks);
    let title = format!("{} against {}", capitalise_first(words[0].name), words[other].name);
    let caption = format!(
        "Each cross is a design; the line joins those of a kind that are the best in these two objectives alone. {} were measured.",
        short_number(front.designs.len() as f64)
    );
    Some(Figure::new(&title, axis(&words[other], 0), vec![panel]).with_caption(&caption))
}
