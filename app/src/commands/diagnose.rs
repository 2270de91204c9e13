//! `counterpoise diagnose`: locate, name, model, and show that the fit improves.

use crate::output::say;
use counterpoise_diagnose::Diagnosis;
use counterpoise_diagnose::findings::answer::{DiagnosisVerdict, FitTable, Hypothesis};
use counterpoise_diagnose::findings::channel_fits::PooledFits;
use counterpoise_pipeline::recordings::{
    RecordingFile, channel_label, channel_words, diagnose, replay_held_out, replay_improved,
};
use counterpoise_pipeline::results::RecordingResult;
use counterpoise_pipeline::{RedesignComparison, verify_redesign};
use counterpoise_project::Purpose;
use counterpoise_report::wording::answer::{
    AnswerText, FindingText, component_list, describe_diagnosed_recordings, describe_verdict,
    describe_warning, unit_suffix,
};
use counterpoise_report::wording::figures::describe_figure;
use counterpoise_report::wording::held_out_recordings::{HeldOutText, describe_held_out};
use counterpoise_report::wording::learned::LearnedText;
use counterpoise_report::wording::recordings::{describe_recordings_error, describe_replay};
use counterpoise_report::{diagnosis, difference};
use counterpoise_verify::Verification;

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
    if !output::write_result(&options.outputs.results, &answer)? {
        print(&loaded, &answer);
        print_confirmation(&loaded, &confirmed);
        print_held_out(&loaded, &answer.held_out_recordings);
        consequence.iter().for_each(print_consequence);
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
            .map(|(name, c)| format!("{name} {:.4e} ({:.2} floors)", c.rms_error, c.residual_over_floor))
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

fn print_consequence(found: &RedesignComparison) {
    say!("the project's design on the improved model:");
    for change in found.changes.iter().filter(|change| change.has_changed_verdict()) {
        let (_, word) = difference::classify_change(change);
        say!(
            "  {word}: {} ({})",
            describe_figure(change.figure, change.controlled),
            difference::describe_size(change)
        );
    }
    let line = |name: &str, v: &Verification| {
        let (hold, fail, _) = v.counts();
        say!("  {name:<32} {hold} requirements hold, {fail} fail");
    };
    line("before, on the model as it was", &found.before);
    line("the same controller", &found.kept);
    found.redesigned.iter().for_each(|v| line("designed anew", v));
}

fn print(loaded: &ProjectOnDisk, answer: &AnswerText) {
    if !answer.qualification.is_empty() {
        say!("about the recordings themselves:");
        answer.qualification.iter().for_each(|remark| say!("  {remark}"));
        say!();
    }
    say!("equations of torque and motion that these sensors allow:");
    for row in &answer.isolability {
        say!(
            "  {:<8} {:<4} depends on {}",
            row.balance.name(),
            if row.available { "yes" } else { "no" },
            component_list(&row.sees)
        );
    }
    say!();
    let verdict = describe_verdict(answer.verdict);
    say!("{}: {}", verdict.name, verdict.sentence);
    answer.findings.iter().for_each(print_finding);
    answer.learned.iter().for_each(print_learned);
    print_candidates(answer);
    print_fit(loaded, &answer.fit);
    if let Some(next) = &answer.next_experiment {
        say!("next experiment: {}; it {}", next.what, next.why);
    }
    answer.warnings.iter().for_each(|warning| say!("note: {}", describe_warning(*warning)));
}

fn print_finding(finding: &FindingText) {
    say!("  {} {} (probability {:.0} %)", finding.component, finding.effect, 100.0 * finding.probability);
    say!("    {}", finding.explanation);
    say!("    shows {}", finding.when);
    for p in &finding.parameters {
        say!(
            "    {} = {:.5}{}  [{:.5}, {:.5}], was {:.5}",
            p.name,
            p.value,
            unit_suffix(p),
            p.ci95[0],
            p.ci95[1],
            p.before
        );
    }
    for other in &finding.alternatives {
        say!("    cannot be distinguished from {} {}", other.component, other.effect);
    }
}

fn print_learned(learned: &LearnedText) {
    say!("free functions in place of an unidentified effect:");
    for function in &learned.functions {
        say!("  {}", function.reading);
        say!("    {}", function.range);
    }
    say!("  {}", learned.summary);
}

/// Effects that are shown if none is certain.
const SHOWN_CANDIDATES: usize = 3;

/// Prints the effects of the library that explain most, each with its size and what it leaves, if no name explains everything.
fn print_candidates(answer: &AnswerText) {
    if !matches!(answer.verdict, DiagnosisVerdict::Unknown | DiagnosisVerdict::Incomplete) {
        return;
    }
    let first = answer.hypotheses.iter().filter(|h| h.stage == 1 && h.beside.is_empty());
    let mut best: Vec<&Hypothesis> = first.filter(|h| h.power_left < 1.0).collect();
    best.sort_by(|a, b| a.power_left.total_cmp(&b.power_left));
    best.truncate(SHOWN_CANDIDATES);
    if best.is_empty() {
        return;
    }
    say!("effects of the library that explain most, each alone:");
    for h in best {
        let unit = |unit: &str| if unit == "1" { String::new() } else { format!(" {unit}") };
        let sizes: Vec<String> =
            h.values.iter().map(|v| format!("{} {:.4}{}", v.name, v.value, unit(v.unit))).collect();
        let left = 100.0 * h.power_left;
        let (component, effect) = (h.component, h.effect);
        say!(
            "  {component} {effect}: {}; leaves {left:.0} % of the residual's power on held-out data",
            sizes.join(", ")
        );
    }
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
