//! `counterpoise diagnose`: locate, name, model, and show that the fit improves.

use std::process::ExitCode;

use crate::output::say;
use counterpoise_diagnose::Diagnosis;
use counterpoise_diagnose::findings::answer::{Channels, FitTable, Verdict};
use counterpoise_pipeline::recordings::diagnose;
use counterpoise_pipeline::{Consequence, consequence};
use counterpoise_project::Purpose;
use counterpoise_report::wording::answer::{
    AnswerText, FindingText, component_list, describe_diagnosed_recordings, unit_suffix,
};
use counterpoise_report::wording::recordings::describe_recordings_error;
use counterpoise_report::{diagnosis, difference, html};
use counterpoise_verify::Verification;

use crate::exit::Done;
use crate::options::DiagnoseOptions;
use crate::output;
use counterpoise_host::interrupt;
use counterpoise_host::projects::{self, Loaded, Surroundings};
use counterpoise_host::stages::Progress;
use counterpoise_host::workers::Workers;

/// Runs the command.
pub fn run(options: &DiagnoseOptions) -> Done {
    let loaded = projects::load(&options.project, Purpose::Diagnose)?;
    output::warnings(&loaded, options.outputs.results.progress());
    if options.recordings.is_empty() {
        return super::structure::run(&loaded, options);
    }
    super::replay::tell_other_export(&loaded);
    let files = projects::recordings(&options.recordings)?;
    let workers = Workers::new(options.outputs.results.progress());
    let watch = interrupt::watch();
    let diagnosed = diagnose(&loaded.project, &files, &workers);
    drop(watch);
    workers.finish();
    let diagnosed = diagnosed.map_err(|error| anyhow::Error::msg(describe_recordings_error(&error)))?;
    let answer = describe_diagnosed_recordings(&diagnosed).answer;
    let found = &diagnosed.diagnosis;
    if let Some(path) = &options.save {
        projects::save_improved(&loaded, &found.improved, path)?;
    }
    let consequence = redesign(&loaded, found, options.outputs.results.progress())?;
    if let Some(path) = &options.outputs.report {
        let command = format!("counterpoise diagnose {}", loaded.path.display());
        let name = &loaded.project.plant.name;
        let page = diagnosis::report(name, &command, &diagnosed, &answer, consequence.as_ref());
        projects::write(path, html(&page).as_bytes())?;
    }
    if !output::json(&options.outputs.results, &answer)? {
        print(&answer);
        consequence.iter().for_each(print_consequence);
    }
    Ok(ExitCode::SUCCESS)
}

/// What the improved model means for the project's design; `None` if nothing was found or the project has no design.
fn redesign(loaded: &Loaded, found: &Diagnosis, progress: Progress) -> anyhow::Result<Option<Consequence>> {
    if found.improved == loaded.project.plant {
        return Ok(None);
    }
    Ok(consequence(&loaded.project, &found.improved, &Surroundings::of(loaded, progress))?)
}

fn print_consequence(found: &Consequence) {
    say!("the project's design on the improved model:");
    for change in found.changes.iter().filter(|change| change.turned()) {
        let (_, word) = difference::verdict(change);
        say!("  {word}: {} ({})", change.figure.name(), difference::size(change));
    }
    let line = |name: &str, v: &Verification| {
        let (hold, fail, _) = v.counts();
        say!("  {name:<32} {hold} requirements hold, {fail} fail");
    };
    line("before, on the model as it was", &found.before);
    line("the same controller", &found.kept);
    found.redesigned.iter().for_each(|v| line("designed anew", v));
}

fn print(answer: &AnswerText) {
    if !answer.qualification.is_empty() {
        say!("about the recordings themselves:");
        answer.qualification.iter().for_each(|remark| say!("  {remark}"));
        say!();
    }
    say!("balances that these sensors allow:");
    for row in &answer.isolability {
        say!(
            "  {:<8} {:<4} sees {}",
            row.balance.name(),
            if row.available { "yes" } else { "no" },
            component_list(&row.sees)
        );
    }
    say!();
    say!("{}", sentence(answer.verdict));
    answer.findings.iter().for_each(print_finding);
    print_fit(&answer.fit);
    if let Some(next) = &answer.next_experiment {
        say!("next experiment: {}; it {}", next.what, next.why);
    }
    answer.warnings.iter().for_each(|remark| say!("note: {remark}"));
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
        say!("    cannot be told from {} {}", other.component, other.effect);
    }
}

fn print_fit(fit: &FitTable) {
    say!(
        "  {:<14} {:>12} {:>12} {:>12} {:>16} {:>16}",
        "channel",
        "floor",
        "before",
        "after",
        "held out before",
        "held out after"
    );
    for (channel, before) in &fit.before {
        let number = |table: &Channels| table.get(channel).map_or(f64::NAN, |c| c.rms_error);
        say!(
            "  {channel:<14} {:12.4e} {:12.4e} {:12.4e} {:16.4e} {:16.4e}",
            before.floor,
            before.rms_error,
            number(&fit.after),
            number(&fit.held_out_before),
            number(&fit.held_out_after)
        );
    }
}

fn sentence(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Consistent => "consistent: the model explains the recordings",
        Verdict::Named => "named: with this, the model explains the recordings",
        Verdict::Ambiguous => "ambiguous: one of several that these recordings cannot tell apart",
        Verdict::Incomplete => "incomplete: this is part of it, something is left over",
        Verdict::Unknown => "unknown: something was left out that is none of the known effects",
    }
}
