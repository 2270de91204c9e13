//! The report of a planned experiment: its demand, what every machine that is left does in it, and which of them it tells apart.

use counterpoise_diagnose::experiment::{ExperimentPlan, MachineMotion};
use counterpoise_models::ControlledQuantity;
use counterpoise_plot::number::short_number;
use counterpoise_plot::{Axis, Colour, Figure, Panel, Series};

use crate::page::{
    FigureTile, Headline, OutcomeTone, ProvenanceEntry, Report, ReportCell, ReportColumn, ReportSection,
    ReportTable,
};
use crate::tolerance::TOLD_APART;
use crate::wording::experiment::{ExperimentPlanText, SeparationText};

/// A plan, and the quantity that its machine controls.
#[derive(Debug, Clone, Copy)]
pub struct PlannedMotion<'a> {
    /// The plan.
    pub plan: &'a ExperimentPlan,
    /// The quantity.
    pub controlled: ControlledQuantity,
}

/// Returns the report of a plan.
pub fn experiment_report(
    machine: &str,
    command: &str,
    text: &ExperimentPlanText,
    planned: PlannedMotion<'_>,
) -> Report {
    let apart = text.separations.iter().filter(|pair| pair.probability >= TOLD_APART).count();
    let all = text.separations.len();
    let controlled = planned.controlled;
    let tile = |label: &str, value: f64, unit: &str| FigureTile::plain(label, short_number(value), unit);
    let machines = text.machines.iter().enumerate();
    let machines = machines.fold(ReportSection::new("Machines that are left"), |section, (k, name)| {
        section.with_text(format!("{}: {name}", k + 1))
    });
    let others = text.others.iter().fold(ReportSection::new("Other experiments"), |section, other| {
        section.with_text(format!(
            "{} (expected log-likelihood ratio {} for the two machines that are hardest to separate)",
            other.what,
            short_number(other.log_likelihood_ratio)
        ))
    });
    let report = Report {
        title: format!("Experiment for {machine}"),
        subtitle: "the demand that best separates what the recordings leave possible".to_owned(),
        headline: Headline {
            tone: if apart == all { OutcomeTone::Good } else { OutcomeTone::Neutral },
            text: format!(
                "{apart} of {all} pairs of machines will be told apart with a probability of {:.0} %",
                100.0 * TOLD_APART
            ),
            detail: format!("The demand: {}.", text.what),
        },
        tiles: vec![
            tile("largest angle from the start", text.reached_angle_rad, controlled.travel_unit()),
            tile("largest rate", text.reached_rate_rad_s, controlled.rate().unit()),
            tile("largest current", text.reached_current_a, "A"),
        ],
        verdicts: separations_table(text),
        glance: motion_figure(planned).into_iter().collect(),
        sections: vec![machines, others],
        provenance: vec![
            ProvenanceEntry::new("version", env!("CARGO_PKG_VERSION")),
            ProvenanceEntry::new("command", command),
        ],
    };
    report.with_command(command)
}

fn separations_table(text: &ExperimentPlanText) -> ReportTable {
    let columns = [
        ReportColumn::Text("machines"),
        ReportColumn::Number("expected log-likelihood ratio"),
        ReportColumn::Text("probability of deciding"),
    ];
    let mut table = ReportTable::new("Which machines the experiment tells apart", &columns);
    let row = |pair: &SeparationText| {
        let tone = if pair.probability >= TOLD_APART { OutcomeTone::Good } else { OutcomeTone::Neutral };
        vec![
            ReportCell::text(format!("{} and {}", pair.first + 1, pair.second + 1)),
            ReportCell::number(pair.log_likelihood_ratio),
            ReportCell::Verdict(tone, format!("{:.0} %", 100.0 * pair.probability)),
        ]
    };
    table.rows = text.separations.iter().map(row).collect();
    table
}

/// Returns the motion of every machine in the best experiment; `None` if there is none.
fn motion_figure(planned: PlannedMotion<'_>) -> Option<Figure> {
    let (plan, controlled) = (planned.plan, planned.controlled);
    plan.motions.first()?;
    let series = |of: fn(&MachineMotion) -> &[f64]| {
        let one = |(k, motion): (usize, &MachineMotion)| {
            let colour = Colour::CYCLE[k % Colour::CYCLE.len()];
            let points: Vec<(f64, f64)> =
                of(motion).iter().enumerate().map(|(i, y)| (i as f64 * motion.period_s, *y)).collect();
            Series::solid_line(&format!("{}", k + 1), colour, points)
        };
        plan.motions.iter().enumerate().map(one).collect::<Vec<Series>>()
    };
    let panels = vec![
        Panel::new(Axis::linear("rate", controlled.rate().unit()), series(|m| &m.rate_rad_s)),
        Panel::new(Axis::linear("angle", controlled.travel_unit()), series(|m| &m.angle_rad)),
        Panel::new(Axis::linear("current", "A"), series(|m| &m.current_a)),
    ];
    let figure =
        Figure::new("The motion of every machine in the experiment", Axis::linear("time", "s"), panels);
    Some(figure.with_caption("The numbers are those of the machines that are left."))
}
