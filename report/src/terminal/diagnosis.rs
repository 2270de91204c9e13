//! What `counterpoise diagnose` prints of an answer: the verdict with its findings, and what it means for the project's design.

use counterpoise_diagnose::findings::answer::{DiagnosisVerdict, FitTable, Hypothesis};
use counterpoise_diagnose::findings::channel_fits::PooledFits;
use counterpoise_pipeline::RedesignComparison;
use counterpoise_recordings::Channel;
use counterpoise_verify::Verification;

use super::add_line;
use crate::difference;
use crate::wording::answer::{
    AnswerText, FindingText, component_list, describe_verdict, describe_warning, unit_suffix,
};
use crate::wording::figures::describe_figure;
use crate::wording::held_out_recordings::HeldOutText;
use crate::wording::learned::LearnedText;

/// Returns the lines on an answer: remarks on the recordings, what the sensors show, the verdict, what was found, and how well it fits. `label`
/// gives a channel's name in the words of the machine.
pub fn answer_lines(answer: &AnswerText, label: impl Fn(Channel) -> &'static str) -> Vec<String> {
    let mut all = Vec::new();
    let lines = &mut all;
    if !answer.qualification.is_empty() {
        add_line!(lines, "about the recordings themselves:");
        answer.qualification.iter().for_each(|remark| add_line!(lines, "  {remark}"));
        add_line!(lines);
    }
    add_line!(lines, "equations of torque and motion that these sensors allow:");
    for row in &answer.isolability {
        let available = if row.available { "yes" } else { "no" };
        let (balance, parts) = (row.balance.name(), component_list(&row.sees));
        add_line!(lines, "  {balance:<8} {available:<4} depends on {parts}");
    }
    add_line!(lines);
    let verdict = describe_verdict(answer.verdict);
    add_line!(lines, "{}: {}", verdict.name, verdict.sentence);
    answer.findings.iter().for_each(|finding| add_finding(lines, finding));
    answer.learned.iter().for_each(|learned| add_learned(lines, learned));
    add_candidates(lines, answer);
    add_fit(lines, &answer.fit, label);
    if let Some(next) = &answer.next_experiment {
        add_line!(lines, "next experiment: {}; it {}", next.what, next.why);
    }
    answer.warnings.iter().for_each(|warning| add_line!(lines, "note: {}", describe_warning(*warning)));
    all
}

/// Returns the lines on recordings that the diagnosis was not given; none if there are none. `label` gives a channel's name in the words of the machine.
pub fn held_out_lines<'n>(recordings: &'n [HeldOutText], label: impl Fn(&'n str) -> &'n str) -> Vec<String> {
    let mut all = Vec::new();
    let lines = &mut all;
    if recordings.is_empty() {
        return all;
    }
    add_line!(
        lines,
        "recordings that the diagnosis was not given, replayed by the model as it was and by the improved one:"
    );
    for recording in recordings {
        add_line!(lines, "  {}", recording.file);
        add_line!(
            lines,
            "    {:<14} {:>12} {:>12} {:>12} {:>16}",
            "channel",
            "floor",
            "before",
            "after",
            "after / floor"
        );
        for (name, c) in &recording.channels {
            let (name, ratio) = (label(name), c.after_over_floor);
            add_line!(
                lines,
                "    {name:<14} {:12.4e} {:12.4e} {:12.4e} {ratio:16.2}",
                c.floor,
                c.before,
                c.after
            );
        }
        recording.remarks.iter().for_each(|remark| add_line!(lines, "    {remark}"));
    }
    all
}

fn add_fit(lines: &mut Vec<String>, fit: &FitTable, label: impl Fn(Channel) -> &'static str) {
    add_line!(
        lines,
        "  {:<14} {:>12} {:>12} {:>12} {:>16} {:>16}",
        "channel",
        "floor",
        "before",
        "after",
        "held out before",
        "held out after"
    );
    for (channel, before) in fit.before.iter() {
        let number = |table: &PooledFits| table.get(channel).map_or(f64::NAN, |c| c.rms_error);
        add_line!(
            lines,
            "  {:<14} {:12.4e} {:12.4e} {:12.4e} {:16.4e} {:16.4e}",
            label(channel),
            before.floor,
            before.rms_error,
            number(&fit.after),
            number(&fit.held_out_before),
            number(&fit.held_out_after)
        );
    }
}

/// Returns the lines on what an improved model means for the project's design.
pub fn consequence_lines(found: &RedesignComparison) -> Vec<String> {
    let mut lines = Vec::new();
    add_consequence(&mut lines, found);
    lines
}

fn add_finding(lines: &mut Vec<String>, finding: &FindingText) {
    add_line!(
        lines,
        "  {} {} (probability {:.0} %)",
        finding.component,
        finding.effect,
        100.0 * finding.probability
    );
    add_line!(lines, "    {}", finding.explanation);
    add_line!(lines, "    shows {}", finding.when);
    for p in &finding.parameters {
        add_line!(
            lines,
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
        add_line!(lines, "    cannot be distinguished from {} {}", other.component, other.effect);
    }
}

fn add_learned(lines: &mut Vec<String>, learned: &LearnedText) {
    add_line!(lines, "free functions in place of an unidentified effect:");
    for function in &learned.functions {
        add_line!(lines, "  {}", function.reading);
        add_line!(lines, "    {}", function.range);
    }
    add_line!(lines, "  {}", learned.summary);
}

/// Effects that are shown if none is certain.
const SHOWN_CANDIDATES: usize = 3;

/// Adds the effects of the library that explain most, each with its size and what it leaves, if no name explains everything.
fn add_candidates(lines: &mut Vec<String>, answer: &AnswerText) {
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
    add_line!(lines, "effects of the library that explain most, each alone:");
    for h in best {
        let unit = |unit: &str| if unit == "1" { String::new() } else { format!(" {unit}") };
        let sizes: Vec<String> =
            h.values.iter().map(|v| format!("{} {:.4}{}", v.name, v.value, unit(v.unit))).collect();
        let left = 100.0 * h.power_left;
        let (component, effect) = (h.component, h.effect);
        add_line!(
            lines,
            "  {component} {effect}: {}; leaves {left:.0} % of the residual's power on held-out data",
            sizes.join(", ")
        );
    }
}

fn add_consequence(lines: &mut Vec<String>, found: &RedesignComparison) {
    add_line!(lines, "the project's design on the improved model:");
    for change in found.changes.iter().filter(|change| change.has_changed_verdict()) {
        let (_, word) = difference::classify_change(change);
        add_line!(
            lines,
            "  {word}: {} ({})",
            describe_figure(change.figure, change.controlled),
            difference::describe_size(change)
        );
    }
    let mut line = |name: &str, v: &Verification| {
        let (hold, fail, _) = v.counts();
        add_line!(lines, "  {name:<32} {hold} requirements hold, {fail} fail");
    };
    line("before, on the model as it was", &found.before);
    line("the same controller", &found.kept);
    found.redesigned.iter().for_each(|v| line("designed anew", v));
}
