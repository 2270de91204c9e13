//! `counterpoise replay`: simulate what was recorded, and say how well it fits.

use counterpoise_host::projects;
use counterpoise_pipeline::recordings::read::{control_for, missing_demand};
use counterpoise_pipeline::recordings::{Gaps, ReplayLength, read, replay};
use counterpoise_pipeline::results::ReplayResult;
use counterpoise_project::Purpose;
use counterpoise_simulate::replay::Loop;

use super::{Done, verdict_code};
use crate::arguments::ReplayOptions;
use crate::output::{self, say};

/// Runs the command.
pub fn run(options: &ReplayOptions) -> Done {
    let open = options.open_loop || matches!(options.windows, ReplayLength::Windows { .. });
    let loaded = projects::load(&options.project, if open { Purpose::Model } else { Purpose::Replay })?;
    output::warnings(&loaded, options.results.quiet);
    let files = projects::recordings(&options.recordings)?;
    let read = read(&loaded.project, &files, Gaps::Repaired)?;
    let control = if options.open_loop {
        Loop::Open
    } else {
        if let Some(remark) =
            missing_demand(&loaded.project, read.iter().map(|item| (item.file.as_str(), &item.recording)))
        {
            eprintln!("note: {remark}");
        }
        control_for(&loaded.project, read.iter().map(|item| &item.recording))
    };
    let replayed = replay(&loaded.project, &read, &control, options.windows)?;
    if let Some(path) = &options.report {
        let page = super::pages::replay(&loaded, &read, &replayed);
        projects::write(path, page.as_bytes())?;
    }
    if !output::json(&options.results, &replayed.result)? {
        print(&replayed.result);
    }
    Ok(verdict_code(true))
}

fn print(result: &ReplayResult) {
    for recording in &result.recordings {
        say!("{}", recording.file);
        say!("  followed {}", recording.way());
        recording.remarks.iter().for_each(|remark| say!("  {remark}"));
        say!("  {:<16} {:>12} {:>12} {:>8} {:>10}", "channel", "RMS error", "floor", "ratio", "VAF %");
        for (name, c) in &recording.channels {
            let ratio = c.rms_error / c.floor;
            say!("  {name:<16} {:12.4e} {:12.4e} {ratio:8.2} {:10.4}", c.rms_error, c.floor, c.vaf);
        }
    }
}
