//! `counterpoise identify`: the triangle-wave method.

use std::path::PathBuf;

use crate::output::say;
use clap::Args;
use counterpoise_diagnose::identification::Estimate;
use counterpoise_pipeline::recordings::{AxisUnits, identify};
use counterpoise_project::Purpose;
use counterpoise_report::identify::identification_report;
use counterpoise_report::wording::identification::{
    AmplifierText, IdentificationText, describe_identified_recordings,
};
use counterpoise_report::wording::recordings::describe_recordings_error;

use crate::exit::{CommandResult, ExitStatus};
use crate::options::CommandOutputs;
use crate::output;
use counterpoise_host::projects;

/// Arguments of `identify`.
#[derive(Args)]
pub struct IdentifyOptions {
    /// Project file, or a folder with a project.toml
    pub project: PathBuf,
    /// Recordings of one machine in one state of balance: CSV, Parquet, MATLAB, HDF5 or NumPy files, or folders of them
    #[arg(required = true)]
    pub recordings: Vec<PathBuf>,
    /// Recordings of the same machine at another out-of-balance: they separate the amplifier's curve from friction
    #[arg(long, value_name = "RECORDING", num_args = 1..)]
    pub other: Vec<PathBuf>,
    /// Write the project file with the identified values
    #[arg(long, value_name = "FILE")]
    pub save: Option<PathBuf>,
    /// The destinations of report and results.
    #[command(flatten)]
    pub outputs: CommandOutputs,
}

/// Runs the command.
pub fn run(options: &IdentifyOptions) -> CommandResult {
    let loaded = projects::load_project(&options.project, Purpose::Model)?;
    output::print_warnings(&loaded, options.outputs.results.progress());
    let (first, second) =
        (projects::read_recordings(&options.recordings)?, projects::read_recordings(&options.other)?);
    let identified = identify(&loaded.project, &[&first, &second])
        .map_err(|error| anyhow::Error::msg(describe_recordings_error(&error)))?;
    let found = describe_identified_recordings(&identified);
    if let Some(path) = &options.save {
        projects::save_improved(&loaded, &identified.improved, path)?;
    }
    if let Some(path) = &options.outputs.report {
        let command = format!("counterpoise identify {}", loaded.path.display());
        let name = &loaded.project.plant.name;
        let page = identification_report(name, &command, &found, &identified.units);
        output::write_report(path, &options.outputs.results, &page)?;
    }
    if !output::write_result(&options.outputs.results, &found)? {
        print(&found, &identified.units);
    }
    Ok(ExitStatus::SUCCESS)
}

fn print(found: &IdentificationText, units: &AxisUnits) {
    say!("{:<28} {:>12}   {:^25} {:>12}  unit", "", "identified", "95 % interval", "project");
    for (state, balance) in found.balances.iter().enumerate() {
        let of = |name: &str| match state {
            0 => name.to_owned(),
            _ => format!("{name}, other state"),
        };
        line(&of("out-of-balance"), &balance.out_of_balance_kg_m, units.moment);
        line(&of("inertia"), &balance.inertia_kg_m2, units.inertia);
    }
    line("Coulomb friction, total", &found.coulomb_nm, units.torque);
    line("viscous friction, total", &found.viscous_nm_s_rad, units.viscous);
    match &found.breakaway_nm {
        Some(breakaway) => line("highest after a reversal", breakaway, units.torque),
        None => say!("highest friction after a reversal: too few reversals"),
    }
    for (name, estimate, unit) in found.sensor_errors() {
        line(name, &estimate, unit);
    }
    let l = &found.lobes;
    say!(
        "u against rate: offset {} V, step {} V, slope {} {}, width {} V per {}/s^2",
        figure(l.offset_v),
        figure(l.step_v),
        figure(l.slope_v_s_rad),
        units.slope,
        figure(l.width_v_s2_rad),
        units.position
    );
    let left = if found.residual_nm >= LEAST_WITH_DECIMALS {
        format!("{:.2}", found.residual_nm)
    } else {
        figure(found.residual_nm)
    };
    say!("left over: {left} {} RMS, of {:.1} s of sliding", units.torque, found.sliding_s);
    amplifier(&found.amplifier);
    found.notes.iter().for_each(|note| say!("note: {note}"));
}

fn line(name: &str, e: &Estimate, unit: &str) {
    if !e.is_known() {
        return;
    }
    let [low, high] = e.ci95.map(figure);
    let before = if e.before.is_finite() { figure(e.before) } else { "-".to_owned() };
    say!("{name:<28} {:>12}   [{low:>10}, {high:>10}] {before:>12}  {unit}", figure(e.value));
}

/// Returns a number with three decimals, or with three digits if those say nothing.
fn figure(value: f64) -> String {
    if value == 0.0 || value.abs() >= LEAST_WITH_DECIMALS {
        return format!("{value:.3}");
    }
    format!("{value:.2e}")
}

/// Size from which on three decimals have at least two digits.
const LEAST_WITH_DECIMALS: f64 = 0.01;

fn amplifier(found: &AmplifierText) {
    match found {
        AmplifierText::Curve { .. } => say!("amplifier: its gain curve is not the project's"),
        AmplifierText::AsInProject { .. } => say!("amplifier: its gain curve is the project's"),
        AmplifierText::NotIdentifiable { why } => say!("amplifier: not identifiable: {why}"),
    }
    for q in found.points() {
        say!(
            "  {:6.3} V  {:7.3} A  [{:7.3}, {:7.3}]  project {:7.3} A  scatter {:.4} A",
            q.input_v,
            q.current_a,
            q.ci95_a[0],
            q.ci95_a[1],
            q.linear_a,
            q.scatter_a
        );
    }
}
