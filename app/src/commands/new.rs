//! `counterpoise new`: a folder with a complete project file to start from.

use std::process::ExitCode;

use counterpoise_host::files::create;

use super::Done;
use crate::arguments::NewOptions;
use crate::output::say;

/// Writes the project file; never over another.
pub fn run(options: &NewOptions) -> Done {
    let path = create(&options.folder).map_err(anyhow::Error::msg)?;
    say!(
        "wrote {}: a complete machine. Change its numbers to your own, and after each change run",
        path.display()
    );
    say!("    counterpoise design {0} -o {0}/out", options.folder.display());
    Ok(ExitCode::SUCCESS)
}
