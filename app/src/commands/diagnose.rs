//! `counterpoise diagnose`: locate, name, model, and show that the fit improves.

use super::replay::track_histories;
use crate::output::say;
use counterpoise_diagnose::Diagnosis;
use counterpoise_diagnose::findings::answer::FitTable;
use counterpoise_diagnose::findings::channel_fits::PooledFits;
use counterpoise_pipeline::exchange::WithHistories;
use counterpoise_pipeline::recordings::{
    RecordingFile, channel_label, channel_words, diagnose, replay_held_out, replay_improved,
};
use counterpoise_pipeline::results::RecordingResult;
use counterpoise_pipeline::{RedesignComparison, verify_redesign};
use counterpoise_project::Purpose;
use counterpoise_report::diagnosis;
use counterpoise_report::terminal::diagnosis::{answer_lines, consequence_lines};
use counterpoise_report::wording::answer::{AnswerText, describe_diagnosed_recordings, describe_warning};
use counterpoise_report::wording::held_out_recordings::{HeldOutText, describe_held_out};
use counterpoise_report::wording::recordings::{describe_recordings_error, describe_replay};

use crate::exit::{CommandResult, ExitStatus};
use crate::options::DiagnoseOptions;
use crate::output;
use counterpoise_host::interrupt;
use counterpoise_host::projects::{self, ProjectOnDisk, ProjectWorld};
use counterpoise_host::stages::ProgressDisplay;
use counterpoise_host::workers::ProgressPool;

/// Runs the command.
pub fn run(options: &DiagnoseOptions) -> CommandResult {
    let loaded = projects::load_project(&options.project, Purpose::Diagnose)?;
    output::print_warnings(&loaded, options.outputs.results.progress());
    if options.recordings.is_empty() {
        return super::structure::run(&loaded, options);
    }
    super::replay::tell_other_export(&loaded);
    let files = projects::read_recordings(&options.recordings)?;
    let workers = ProgressPool::new(options.outputs.results.progress());
    let watch = interrupt::watch_interrupts();
    let diagnosed = diagnose(&loaded.project, &files, &workers);
    drop(watch);
    workers.finish();
    let diagnosed = diagnosed.map_err(|error| anyhow::Error::msg(describe_recordings_error(&error)))?;
    let mut answer = describe_diagnosed_recordings(&diagnosed).answer;
    let found = &diagnosed.diagnosis;
    let mut confirmed = Vec::new();
    if let Some(path) = &options.save {
        projects::save_improved(&loaded, &found.improved, path)?;
        confirmed = confirm(&loaded, &files, found)?;
    }
    if !options.held_out.is_empty() {
        let held_out = projects::read_recordings(&options.held_out)?;
        let refused = |error| anyhow::Error::msg(describe_recordings_error(&error));
        let replayed = replay_held_out(&loaded.project, &found.improved, &held_out).map_err(refused)?;
        answer.held_out_recordings = describe_held_out(&replayed);
    }
    let consequence = redesign(&loaded, found, options.outputs.results.progress())?;
    if let Some(path) = &options.outputs.report {
        let command = format!("counterpoise diagnose {}", loaded.path.display());
        let name = &loaded.project.plant.name;
        let page = diagnosis::diagnosis_report(name, &command, &diagnosed, &answer, consequence.as_ref());
        output::write_report(path, &options.outputs.results, &page)?;
    }
    output::write_tracks(&options.outputs.results, &diagnosed.tracks)?;
    let histories = if options.histories { track_histories(&diagnosed.tracks) } else { Vec::new() };
    if !output::write_result(&options.outputs.results, &WithHistories { result: &answer, histories })? {
        print(&loaded, &answer);
        print_confirmation(&loaded, &confirmed);
        print_held_out(&loaded, &answer.held_out_recordings);
        consequence.iter().for_each(|found| output::print_lines(&consequence_lines(found)));
    }
    Ok(ExitStatus::SUCCESS)
}

/// Replays the recordings on the improved mechanism as `counterpoise replay` does of the project that was saved.
fn confirm(
    loaded: &ProjectOnDisk,
    files: &[RecordingFile],
    found: &Diagnosis,
) -> anyhow::Result<Vec<RecordingResult>> {
    let refused = |error| anyhow::Error::msg(describe_recordings_error(&error));
    let replayed = replay_improved(&loaded.project, &found.improved, files).map_err(refused)?;
    Ok(replayed.iter().map(describe_replay).collect())
}

fn print_confirmation(loaded: &ProjectOnDisk, replayed: &[RecordingResult]) {
    if replayed.is_empty() {
        return;
    }
    say!("replay of the project that was saved, over whole recordings:");
    for recording in replayed {
        let ratios: Vec<String> = recording
            .channels
            .iter()
            .map(|(name, c)| (channel_label(&loaded.project.plant, name), c))
            .map(|(name, c)| {
                format!("{name} {:.4e} ({:.2} noise floors)", c.rms_error, c.residual_over_floor)
            })
            .collect();
        say!("  {}: {}", recording.file, ratios.join(", "));
    }
}

fn print_held_out(loaded: &ProjectOnDisk, recordings: &[HeldOutText]) {
    if recordings.is_empty() {
        return;
    }
    say!(
        "recordings that the diagnosis was not given, replayed by the model as it was and by the improved one:"
    );
    for recording in recordings {
        say!("  {}", recording.file);
        say!(
            "    {:<14} {:>12} {:>12} {:>12} {:>16}",
            "channel",
            "floor",
            "before",
            "after",
            "after / floor"
        );
        for (name, c) in &recording.channels {
            let ratio = c.after_over_floor;
            let name = channel_label(&loaded.project.plant, name);
            say!("    {name:<14} {:12.4e} {:12.4e} {:12.4e} {ratio:16.2}", c.floor, c.before, c.after);
        }
        recording.remarks.iter().for_each(|remark| say!("    {remark}"));
    }
}

/// Returns what the improved model means for the project's design; `None` if nothing was found or the project has no
/// design.
fn redesign(
    loaded: &ProjectOnDisk,
    found: &Diagnosis,
    progress: ProgressDisplay,
) -> anyhow::Result<Option<RedesignComparison>> {
    if found.improved == loaded.project.plant {
        return Ok(None);
    }
    Ok(verify_redesign(&loaded.project, &found.improved, &ProjectWorld::of(loaded, progress))?)
}

fn print(loaded: &ProjectOnDisk, answer: &AnswerText) {
    output::print_lines(&answer_lines(answer));
    print_fit(loaded, &answer.fit);
    if let Some(next) = &answer.next_experiment {
        say!("next experiment: {}; it {}", next.what, next.why);
    }
    answer.warnings.iter().for_each(|warning| say!("note: {}", describe_warning(*warning)));
}

fn print_fit(loaded: &ProjectOnDisk, fit: &FitTable) {
    say!(
        "  {:<14} {:>12} {:>12} {:>12} {:>16} {:>16}",
        "channel",
        "floor",
        "before",
        "after",
        "held out before",
        "held out after"
    );
    for (channel, before) in fit.before.iter() {
        let name = channel_words(&loaded.project.plant, channel).name;
        let number = |table: &PooledFits| table.get(channel).map_or(f64::NAN, |c| c.rms_error);
        say!(
            "  {name:<14} {:12.4e} {:12.4e} {:12.4e} {:16.4e} {:16.4e}",
            before.floor,
            before.rms_error,
            number(&fit.after),
            number(&fit.held_out_before),
            number(&fit.held_out_after)
        );
    }
}
