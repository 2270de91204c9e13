//! The controller on its targets: in double, single and fixed point side by side, and what a step costs.

use counterpoise_project::export::board::Cost;
use counterpoise_project::export::{Numbers, TargetFigures, Targets};
use counterpoise_project::verify::{Experiment, Source};

use super::{Cell, Column, Section, Table};

/// What the code in some numbers costs on a core.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CoreCost {
    /// Name of the core.
    pub core: &'static str,
    /// Numbers of the code.
    pub numbers: Numbers,
    /// What was counted.
    pub cost: Cost,
}

/// What was counted, and what was not.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Costs {
    /// Each core with each kind of numbers.
    pub counted: Vec<CoreCost>,
    /// Why something is missing.
    pub remark: Option<String>,
}

/// Operations of a step, for a reader who has no board.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Operations {
    /// Multiplications.
    pub multiplications: usize,
    /// Additions.
    pub additions: usize,
    /// States.
    pub states: usize,
}

/// The section of a report that sets the targets side by side.
pub fn section(targets: &Targets, operations: Operations, costs: &Costs) -> Section {
    let about = "The C in double and the Rust in double are equal to the verified controller to the last bit, so their \
                 column is one; so are C and Rust in single precision to each other.";
    let section = Section::new("On the target").saying(about).listing(loops(targets));
    let section = match &targets.fixed {
        Ok(_) => section,
        Err(why) => section.saying(format!("There is no fixed-point form: {why}.")),
    };
    let Operations { multiplications, additions, states } = operations;
    let work = format!(
        "One step takes {multiplications} multiplications and {additions} additions on {states} states, without a loop; only \
         limits branch, so the largest count is the worst case within a few instructions."
    );
    let section = section.listing(deviations(targets)).saying(work);
    let section = if costs.counted.is_empty() { section } else { section.listing(cost_table(costs)) };
    match &costs.remark {
        Some(remark) => section.saying(format!("Instructions, flash and stack: {remark}.")),
        None => section,
    }
}

/// The closed loop in each experiment, a column for each kind of numbers.
fn loops(targets: &Targets) -> Table {
    let mut columns = vec![Column::Text("experiment")];
    for figures in &targets.figures {
        columns.push(Column::Number(match figures.numbers {
            Numbers::Double => "double, C and Rust [rad/s]",
            Numbers::Single => "single, C and Rust [rad/s]",
            Numbers::Fixed => "fixed point, C [rad/s]",
        }));
        match figures.numbers {
            Numbers::Double => {}
            Numbers::Single => columns.push(Column::Number("single costs [dB]")),
            Numbers::Fixed => columns.push(Column::Number("fixed costs [dB]")),
        }
    }
    let mut table =
        Table::new("Hub rate error RMS of the closed loop with the exported code, nonlinear plant", &columns);
    let experiments =
        targets.figures.first().map(|figures| figures.experiments.as_slice()).unwrap_or_default();
    table.rows = (0..experiments.len()).map(|i| loop_row(targets, i)).collect();
    table
}

fn loop_row(targets: &Targets, i: usize) -> Vec<Cell> {
    let mut cells = Vec::new();
    for figures in &targets.figures {
        let Some(each) = figures.experiments.get(i) else { continue };
        if cells.is_empty() {
            cells.push(Cell::text(experiment(each.experiment)));
        }
        cells.push(Cell::text(format!("{:.4e}", each.error_rms_rad_s)));
        if figures.numbers != Numbers::Double {
            // Less than 0.0005 dB either way prints as 0, without a sign.
            let cost = match each.cost_db {
                None => "\u{2013}".to_owned(),
                Some(cost) if cost.abs() < 5e-4 => "0.000".to_owned(),
                Some(cost) => format!("{cost:+.3}"),
            };
            cells.push(Cell::text(cost));
        }
    }
    cells
}

/// How far the control is from the reference for the same readings.
fn deviations(targets: &Targets) -> Table {
    let columns = [
        Column::Text("numbers"),
        Column::Number("largest, measured [V]"),
        Column::Number("largest, likely [V]"),
        Column::Number("largest, worst case [V]"),
        Column::Number("RMS, measured [V]"),
        Column::Number("RMS, predicted [V]"),
    ];
    let mut table = Table::new("Control against the reference for the same readings", &columns);
    table.rows = targets.figures.iter().map(deviation_row).collect();
    table
}

fn deviation_row(figures: &TargetFigures) -> Vec<Cell> {
    let predicted = &figures.predicted;
    let volts = |value: f64| Cell::text(if value == 0.0 { "0".to_owned() } else { format!("{value:.1e}") });
    vec![
        Cell::text(numbers(figures.numbers)),
        volts(figures.measured_v),
        volts(predicted.likely_v),
        volts(predicted.worst_v),
        volts(figures.measured_rms_v),
        volts(predicted.rms_v),
    ]
}

fn cost_table(costs: &Costs) -> Table {
    let columns = [
        Column::Text("core"),
        Column::Text("numbers"),
        Column::Number("step, at most [instructions]"),
        Column::Number("set out-of-balance [instructions]"),
        Column::Number("flash [bytes]"),
        Column::Number("state in RAM [bytes]"),
        Column::Number("stack [bytes]"),
    ];
    let title =
        "Cost on a Cortex-M, counted in QEMU; code compiled with gcc -O2; without the compiler's own library";
    let mut table = Table::new(title, &columns);
    table.rows = costs.counted.iter().map(cost_row).collect();
    table
}

fn cost_row(each: &CoreCost) -> Vec<Cell> {
    let c = &each.cost;
    let counts = [c.step_instructions, c.set_instructions, c.flash_bytes, c.state_bytes, c.stack_bytes];
    let names = [each.core, numbers(each.numbers)].map(Cell::text);
    names.into_iter().chain(counts.map(|count| Cell::text(count.to_string()))).collect()
}

fn numbers(numbers: Numbers) -> &'static str {
    match numbers {
        Numbers::Double => "double",
        Numbers::Single => "single",
        Numbers::Fixed => "32-bit fixed point",
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
