//! `counterpoise diagnose` without recordings: what the structure's model lacks, from measured natural frequencies.

use anyhow::bail;
use counterpoise_pipeline::recordings::measured_modes::diagnose_structure;
use counterpoise_report::results::StructureText;
use counterpoise_report::structure::structure_report;
use counterpoise_report::terminal::structure::structure_lines;

use crate::exit::{CommandResult, ExitStatus};
use crate::options::DiagnoseOptions;
use crate::output;
use counterpoise_host::projects::{self, ProjectOnDisk};

/// Runs the command on a project with measured modes.
pub fn run(loaded: &ProjectOnDisk, options: &DiagnoseOptions) -> CommandResult {
    let Some(measured) = &loaded.project.measured else {
        bail!(
            "no recording to diagnose, and {} has no [measured] section: name recordings, or give the natural frequencies of the \
             structure as measured.modes",
            loaded.path.display()
        );
    };
    let found = diagnose_structure(&loaded.project, measured)?;
    if let Some(path) = &options.save {
        let document = found.improved.update(&loaded.document, &loaded.project)?;
        projects::write_file(path, document.text().as_bytes())?;
    }
    if let Some(path) = &options.outputs.report {
        let command = format!("counterpoise diagnose {}", loaded.path.display());
        let page = structure_report(&loaded.project.plant.name, &command, &found.answer);
        output::write_report(path, &options.outputs.results, &page)?;
    }
    if !output::write_result(&options.outputs.results, &StructureText::from(&found.answer))? {
        output::print_lines(&structure_lines(measured, &found.answer));
    }
    Ok(ExitStatus::SUCCESS)
}
