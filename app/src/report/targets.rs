//! What smaller numbers cost: the controller in double, single and fixed point, side by side.

use counterpoise_project::export::{Numbers, TargetFigures, Targets};
use counterpoise_project::verify::{Experiment, Source};

use super::{Cell, Column, Section, Table};

/// The section of a report that sets the targets' numbers side by side.
pub fn section(targets: &Targets) -> Section {
    let columns = [
        Column::Text("numbers"),
        Column::Text("experiment"),
        Column::Number("hub rate error RMS [rad/s]"),
        Column::Number("against double [dB]"),
        Column::Number("control off by [V]"),
        Column::Number("predicted at most [V]"),
    ];
    let mut table =
        Table::new("The closed loop with the exported controller in each kind of numbers", &columns);
    table.rows = targets.figures.iter().flat_map(rows).collect();
    let section = Section::new("Targets").listing(table);
    match &targets.fixed {
        Ok(_) => section,
        Err(why) => section.saying(format!("There is no fixed-point form: {why}.")),
    }
}

fn rows(figures: &TargetFigures) -> Vec<Vec<Cell>> {
    let row = |each: &counterpoise_project::export::targets::ExperimentFigures| {
        vec![
            Cell::text(numbers(figures.numbers)),
            Cell::text(experiment(each.experiment)),
            Cell::text(format!("{:.3e}", each.error_rms_rad_s)),
            Cell::text(format!("{:+.3}", each.cost_db)),
            Cell::text(format!("{:.1e}", figures.measured_v)),
            Cell::text(format!("{:.1e}", figures.predicted.worst_v)),
        ]
    };
    figures.experiments.iter().map(row).collect()
}

fn numbers(numbers: Numbers) -> &'static str {
    match numbers {
        Numbers::Double => "double: C and Rust, equal to the reference",
        Numbers::Single => "single: C and Rust",
        Numbers::Fixed => "32-bit fixed point: C",
    }
}

fn experiment(experiment: Experiment) -> &'static str {
    match experiment {
        Experiment::Step => "step of the demand",
        Experiment::Rest => "rest",
        Experiment::Disturbance(Source::Heave, _) => "heave",
        Experiment::Disturbance(Source::Pitch, _) => "pitch",
        Experiment::Disturbance(Source::Both, _) => "heave and pitch",
        Experiment::Disturbance(Source::Road, _) => "road",
    }
}
