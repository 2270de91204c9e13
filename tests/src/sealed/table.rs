//! The score of many machines as a page.

use std::fmt::Write;

use super::Row;

/// Visibility, in floors, from which an effect counts as detectable.
pub const DETECTABLE: f64 = 1.0;

/// Returns the whole page.
pub fn page(rows: &[Row]) -> String {
    let mut out = String::from("| figure | value |\n|---|---|\n");
    for (name, value) in figures(rows) {
        let _ = writeln!(out, "| {name} | {value} |");
    }
    out.push_str("\nPower against size, single effects (visibility: RMS change of the most changed channel, in floors):\n\n");
    out.push_str(
        "| visibility | machines | something found | named | among the equivalent effects |\n|---|---|---|---|---|\n",
    );
    for (low, high) in [(0.0, 0.5), (0.5, 1.0), (1.0, 2.0), (2.0, 5.0), (5.0, f64::INFINITY)] {
        out.push_str(&power(rows, low, high));
    }
    out.push_str("\nProbability as stated against how often the name was true:\n\n");
    out.push_str("| stated | findings | mean stated | true |\n|---|---|---|---|\n");
    for (low, high) in [(0.0, 0.3), (0.3, 0.6), (0.6, 0.9), (0.9, 1.01)] {
        out.push_str(&reliability(rows, low, high));
    }
    out
}

/// A kind of answer: its name, and which answers are of it.
type Kind<'a> = (&'a str, &'a dyn Fn(&Row) -> bool);

/// Returns how often names were true, kind of answer by kind, and (n + 1) / (m + 2) of it: what `diagnose` states of a name without a rival.
pub fn calibration(rows: &[Row]) -> String {
    let mut out =
        String::from("| answer | names | true | (n + 1) / (m + 2) | mean stated |\n|---|---|---|---|---|\n");
    let kinds: [Kind<'_>; 4] = [
        ("named, one or two effects", &|r| r.verdict == "Named" && r.found.len() < 3),
        ("named, three effects", &|r| r.verdict == "Named" && r.found.len() > 2),
        ("incomplete", &|r| r.verdict == "Incomplete"),
        ("ambiguous", &|r| r.verdict == "Ambiguous"),
    ];
    for (name, is) in kinds {
        let stated: Vec<&(f64, bool)> = rows.iter().filter(|r| is(r)).flat_map(|r| &r.stated).collect();
        let (right, all) = (stated.iter().filter(|s| s.1).count(), stated.len());
        let shrunk = (right + 1) as f64 / (all + 2) as f64;
        let mean = stated.iter().map(|s| s.0).sum::<f64>() / all.max(1) as f64;
        let _ = writeln!(out, "| {name} | {all} | {right} | {shrunk:.2} | {mean:.2} |");
    }
    let unknown: Vec<&Row> = rows.iter().filter(|r| r.verdict == "Unknown").collect();
    let (right, all) = (unknown.iter().filter(|r| r.component > 0).count(), unknown.len());
    let shrunk = (right + 1) as f64 / (all + 2) as f64;
    let _ = writeln!(out, "| unknown, in the component named first | {all} | {right} | {shrunk:.2} | |");
    out
}

fn figures(rows: &[Row]) -> Vec<(&'static str, String)> {
    let of = |family: &str| rows.iter().filter(|r| r.family == family).collect::<Vec<_>>();
    let (nothing, outside, pairs) = (of("Nothing"), of("Outside"), of("Pair"));
    let singles: Vec<&Row> = rows.iter().filter(|r| is_single(r)).collect();
    let clear: Vec<&Row> = singles.iter().copied().filter(|r| r.visibility >= DETECTABLE).collect();
    let known: Vec<&Row> = rows.iter().filter(|r| r.family != "Nothing").collect();
    let named = |rows: &[&Row]| {
        rows.iter().filter(|r| r.top == r.truth.len() && r.found.len() == r.truth.len()).count()
    };
    let some =
        |rows: &[&Row], hit: &dyn Fn(&Row) -> bool| share(rows.iter().filter(|r| hit(r)).count(), rows.len());
    let inside = rows.iter().map(|r| r.covered).sum();
    let intervals = rows.iter().map(|r| r.intervals).sum();
    let mut all = vec![
        ("machines", rows.len().to_string()),
        (
            "false alarms (anything found where nothing is concealed)",
            some(&nothing, &|r| !r.found.is_empty()),
        ),
        ("their rate is below, one-sided 95 % (Clopper and Pearson)", {
            let alarms = nothing.iter().filter(|r| !r.found.is_empty()).count();
            format!("{:.1} %", 100.0 * upper_bound(alarms, nothing.len()))
        }),
        (
            "detectable single effects and instrument faults named, nothing else",
            share(named(&clear), clear.len()),
        ),
        ("the same, truth among the equivalent effects", some(&clear, &|r| r.in_set == r.truth.len())),
        ("mean number of equivalent effects", format!("{:.2}", mean(&|r| r.offered as f64, &clear))),
        ("all single effects named, of any size", share(named(&singles), singles.len())),
        ("component right, where something is concealed and found", {
            let found: Vec<&Row> = known.iter().copied().filter(|r| !r.found.is_empty()).collect();
            some(&found, &|r| r.component > 0)
        }),
        ("two effects, both detected by name, nothing else", share(named(&pairs), pairs.len())),
        ("the same, where each makes a change of at least one floor beside the other", {
            let clear: Vec<&Row> =
                pairs.iter().copied().filter(|r| r.sizes.iter().all(|s| *s >= DETECTABLE)).collect();
            share(named(&clear), clear.len())
        }),
        ("two effects, at least one", some(&pairs, &|r| r.top > 0)),
        ("outside the library: no name given", some(&outside, &|r| r.stated.is_empty())),
        ("95 % intervals that hold the truth", share(inside, intervals)),
        ("damage (held-out data got worse)", some(&rows.iter().collect::<Vec<_>>(), &|r| r.damaged)),
    ];
    all.extend(improvement_figures(rows));
    all
}

/// Returns the mean of a figure over machines.
fn mean(f: &dyn Fn(&Row) -> f64, rows: &[&Row]) -> f64 {
    rows.iter().map(|r| f(r)).sum::<f64>() / rows.len().max(1) as f64
}

/// Returns how much the fit improved, and what it cost.
fn improvement_figures(rows: &[Row]) -> Vec<(&'static str, String)> {
    let improved: Vec<&Row> = rows.iter().filter(|r| !r.stated.is_empty()).collect();
    vec![
        (
            "distance on held-out data, named machines: before",
            format!("{:.3}", mean(&|r| r.held_out_before, &improved)),
        ),
        ("the same, after", format!("{:.3}", mean(&|r| r.held_out_after, &improved))),
        (
            "last part of every recording, fitted to the first: distance of the model as it was",
            split(rows, 0),
        ),
        ("the same, its ordinary parameters refitted", split(rows, 1)),
        ("the same, what was found", split(rows, 2)),
        ("the same, the truth's own structure refitted", split(rows, 3)),
        ("seconds a machine", format!("{:.0}", mean(&|r| r.seconds, &rows.iter().collect::<Vec<_>>()))),
    ]
}

/// Chance that is left for as few hits as were seen, or fewer, at the upper bound of their rate.
const DOUBT: f64 = 0.05;

/// Returns the one-sided upper bound of a rate of which `hits` of `all` were seen (Clopper and Pearson 1934): the rate at which
/// so few would be seen once in twenty times. 1 if nothing was looked at.
pub fn upper_bound(hits: usize, all: usize) -> f64 {
    if hits >= all {
        return 1.0;
    }
    let so_few = |rate: f64| {
        let mut term = (1.0 - rate).powi(all as i32);
        let mut sum = term;
        for k in 0..hits {
            term *= (all - k) as f64 / (k + 1) as f64 * rate / (1.0 - rate);
            sum += term;
        }
        sum
    };
    let (mut low, mut high) = (0.0, 1.0 - f64::EPSILON);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if so_few(middle) > DOUBT { low = middle } else { high = middle }
    }
    high
}

/// Mean of one of the four distances over the machines that conceal something the library has.
fn split(rows: &[Row], which: usize) -> String {
    let known = |r: &&Row| r.family != "Nothing" && r.split.iter().all(Option::is_some);
    let values: Vec<f64> = rows.iter().filter(known).filter_map(|r| r.split[which]).collect();
    format!("{:.3} ({} machines)", values.iter().sum::<f64>() / values.len().max(1) as f64, values.len())
}

fn is_single(row: &Row) -> bool {
    row.family == "Single" || row.family == "Instrument"
}

/// `part of whole`, with the percentage.
fn share(part: usize, whole: usize) -> String {
    format!("{part} of {whole} ({:.0} %)", 100.0 * part as f64 / whole.max(1) as f64)
}

fn power(rows: &[Row], low: f64, high: f64) -> String {
    let here: Vec<&Row> =
        rows.iter().filter(|r| is_single(r) && r.visibility >= low && r.visibility < high).collect();
    let found = here.iter().filter(|r| !r.found.is_empty()).count();
    let named = here.iter().filter(|r| r.top == 1 && r.found.len() == 1).count();
    let offered = here.iter().filter(|r| r.in_set == 1).count();
    let label = if high.is_finite() { format!("{low} to {high}") } else { format!("above {low}") };
    format!("| {label} | {} | {found} | {named} | {offered} |\n", here.len())
}

fn reliability(rows: &[Row], low: f64, high: f64) -> String {
    let all = rows.iter().flat_map(|r| &r.stated);
    let here: Vec<&(f64, bool)> = all.filter(|(p, _)| *p >= low && *p < high).collect();
    let mean = here.iter().map(|s| s.0).sum::<f64>() / here.len().max(1) as f64;
    let right = here.iter().filter(|s| s.1).count();
    format!(
        "| {low:.1} to {:.1} | {} | {mean:.2} | {} |\n",
        high.min(1.0),
        here.len(),
        share(right, here.len())
    )
}
