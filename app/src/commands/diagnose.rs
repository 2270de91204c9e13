//! `counterpoise diagnose`: locate, name, model, and show that the fit improves.

use super::replay::track_histories;
use counterpoise_diagnose::Diagnosis;
use counterpoise_pipeline::exchange::WithHistories;
use counterpoise_pipeline::recordings::{
    RecordingFile, channel_label, channel_words, diagnose, replay_held_out, replay_improved,
};
use counterpoise_pipeline::results::RecordingResult;
use counterpoise_pipeline::{RedesignComparison, verify_redesign};
use counterpoise_project::Purpose;
use counterpoise_report::diagnosis;
use counterpoise_report::terminal::diagnosis::{answer_lines, consequence_lines, held_out_lines};
use counterpoise_report::terminal::replay::saved_project_lines;
use counterpoise_report::wording::answer::{AnswerText, describe_diagnosed_recordings};
use counterpoise_report::wording::held_out_recordings::describe_held_out;
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
        print(&loaded, &answer, &confirmed);
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

fn print(loaded: &ProjectOnDisk, answer: &AnswerText, confirmed: &[RecordingResult]) {
    let plant = &loaded.project.plant;
    output::print_lines(&answer_lines(answer, |channel| channel_words(plant, channel).name));
    output::print_lines(&saved_project_lines(confirmed, |name| channel_label(plant, name)));
    output::print_lines(&held_out_lines(&answer.held_out_recordings, |name| channel_label(plant, name)));
}
