//! The manual's page of JSON results: the keys of stored example results, and that the program still gives these keys.
//!
//! `WRITE_MANUAL=1 cargo test --release -p counterpoise --test all results_page` runs the commands, stores their shortened results in
//! `app/tests/data/results`, and writes `docs/reference/results.md` and `docs/reference/results.schema.json` again. Figures of cores whose compiler
//! is missing stay as they are stored.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "support/schema.rs"]
mod schema;

use crate::support;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};

use serde_json::Value;

/// An example of a result: the command that gives it, and the name under which it is stored.
struct Example {
    name: &'static str,
    command: &'static [&'static str],
}

const fn example(name: &'static str, command: &'static [&'static str]) -> Example {
    Example { name, command }
}

/// Paths are relative to the repository; `OUT` is a scratch folder, and `RIG` the reference rig with a small campaign: with the runs of the example if
/// the results are stored, with short ones if their keys are compared.
const EXAMPLES: &[Example] = &[
    example("design", &["design", "examples/reference-rig", "-o", "OUT"]),
    example("check", &["check", "examples/reference-rig"]),
    example("model", &["model", "examples/reference-rig"]),
    example("reduce", &["reduce", "examples/reference-rig"]),
    example("synth", &["synth", "examples/reference-rig"]),
    example("synth-search", &["synth", "examples/servo-pendulum", "--search", "--evaluations", "400"]),
    example("compare", &["compare", "examples/reference-rig"]),
    example("verify", &["verify", "examples/reference-rig"]),
    example("verify-line-of-sight", &["verify", "examples/gun-recoil"]),
    example("export", &["export", "examples/reference-rig", "-o", "OUT"]),
    example(CONTROLLER, &["export", "examples/adaptation", "-o", "OUT"]),
    example("fra", &["fra", "examples/reference-rig", "--amplitudes", "0.2,0.02", "--frequencies", "1:10:3"]),
    example("replay", &["replay", "examples/left-out-friction", "examples/left-out-friction/steps.parquet"]),
    example(
        "diagnose",
        &["diagnose", "examples/left-out-friction", "examples/left-out-friction/triangle.parquet"],
    ),
    example("diagnose-modes", &["diagnose", "examples/measured-modes"]),
    example(
        "identify",
        &[
            "identify",
            "examples/amplifier-curve",
            "examples/amplifier-curve/balanced",
            "--other",
            "examples/amplifier-curve/midpoint",
        ],
    ),
    example(
        "experiment",
        &[
            "experiment",
            "examples/left-out-friction",
            "--angle",
            "0.1",
            "--rate",
            "0.3",
            "--duration",
            "4",
            "-o",
            "OUT/demand.csv",
        ],
    ),
    example("adapt", &["adapt", "examples/adaptation"]),
    example("sweep", &["sweep", "RIG", "-o", "OUT"]),
    example("claims", &["claims", "--only", "C6", "--report", "OUT/claims.html"]),
];

/// The example whose result is the file of the controller that stands beside the code.
const CONTROLLER: &str = "controller";

const INTRODUCTION: &str = "# JSON results

This page is generated from stored results; a test compares their keys with those of the program. `--json FILE` writes the result of any
command except `new`, `machine` and `studio`.

Numbers are in SI units, and a key that has a unit ends in it (`_rad_s`, `_nm`, `_kg_m2`). Angles are in radians, except where a key ends in
`_deg`; ratios in dB end in `_db`. A complex number is a list of real and imaginary part. A value that does not exist is `null`. `[]` marks the elements of
a list, and `NAME` a key that is a name from the project or the recording, such as a channel. `floor` is the noise floor of a channel, `vaf` its variance
accounted for in percent, and `ci95` a 95 % interval. The words of a diagnosis' `verdict` are explained in
[the theory of the diagnosis](../theory/diagnosis.md).

Every result is an object whose key `schema` holds name and version of the schema, `counterpoise.results/2`. The number rises when a key changes its
meaning or goes; new keys leave it as it is. [results.schema.json](results.schema.json) is the same as JSON Schema (draft 2020-12): a program can
check a result against the definition that has the name of the command. Version 1 had lists in place of the objects of `claims`, `export`, `fra`,
`sweep` and `verify --against`.

`counterpoise verify --json` lists every figure that a requirement can ask for, with its unit.
";

/// Commands whose keys are compared on another project, which takes less time and has the same keys: name and project. What is stored, and so
/// what the page shows, is the result of the command as listed. `FEW` is `RIG` with its first requirements alone, whose worst cases are searched,
/// `BRIEF` the example of the diagnosis with the first seconds of its recording, and `DAMPED` the direct drive with friction, so that the sines move it.
const QUICKER: [(&str, &str); 7] = [
    ("diagnose", "BRIEF"),
    ("sweep", "FEW"),
    ("design", "RIG"),
    ("compare", "DAMPED"),
    ("verify", "RIG"),
    ("export", "RIG"),
    ("fra", "RIG"),
];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Returns whether the page and the stored results are written again.
fn writes() -> bool {
    std::env::var_os("WRITE_MANUAL").is_some()
}

fn stored_result(name: &str) -> PathBuf {
    root().join("app/tests/data/results").join(format!("{name}.json"))
}

/// Folders of projects that take less time than the examples.
struct BriefProjects {
    /// The reference rig with a campaign of eight mechanisms; its runs are short unless the results are stored.
    rig: String,
    /// The same with the first requirements alone.
    few: String,
    /// The example of the diagnosis, which uses the first seconds of a recording.
    brief: String,
    /// The direct drive with friction.
    damped: String,
}

impl BriefProjects {
    fn write() -> Self {
        let folder = support::folder("results-page");
        let rig = small_campaign(&folder.join("rig"));
        let few = folder.join("few");
        fs::create_dir_all(&few).unwrap();
        let text = support::write_short_rig(&few, 8);
        let requirements: Vec<&str> = text.split("[[verify.requirement]]").collect();
        let (_, campaign) = text.split_once("\n[sweep]\n").unwrap();
        let text = format!("{}\n[sweep]\n{campaign}", requirements[..4].join("[[verify.requirement]]"));
        fs::write(few.join("project.toml"), text).unwrap();
        let brief = folder.join("brief");
        fs::create_dir_all(&brief).unwrap();
        let text = fs::read_to_string(root().join("examples/left-out-friction/project.toml")).unwrap();
        let text = text + "\n[recording]\nwindows = [[0.0, 2.0]]\n";
        fs::write(brief.join("project.toml"), text).unwrap();
        let damped = folder.join("damped");
        fs::create_dir_all(&damped).unwrap();
        let text = fs::read_to_string(root().join("examples/direct-gimbal/project.toml")).unwrap();
        let friction = "inertia = 0.5\nfriction = { pivot = { viscous = 0.5 } }\n";
        assert!(text.contains("inertia = 0.5\n"));
        fs::write(damped.join("project.toml"), text.replacen("inertia = 0.5\n", friction, 1)).unwrap();
        let [few, brief, damped] = [few, brief, damped].map(|folder| folder.to_str().unwrap().to_owned());
        Self { rig, few, brief, damped }
    }
}

/// Writes the reference rig with a campaign of eight mechanisms into a folder, and returns its path.
fn small_campaign(folder: &Path) -> String {
    fs::create_dir_all(folder).unwrap();
    support::write_short_rig(folder, 8);
    if writes() {
        let text = fs::read_to_string(support::EXAMPLE).unwrap();
        fs::write(folder.join("project.toml"), text.replace("\nsamples = 200\n", "\nsamples = 8\n")).unwrap();
    }
    folder.to_str().unwrap().to_owned()
}

/// Runs the commands of all examples, as many at once as the machine has processors, and returns their results in order.
fn run_all() -> Vec<Value> {
    let (quick, next) = (BriefProjects::write(), AtomicUsize::new(0));
    let results: Vec<OnceLock<Value>> = EXAMPLES.iter().map(|_| OnceLock::new()).collect();
    let work = || {
        while let Some((k, example)) = EXAMPLES.iter().enumerate().nth(next.fetch_add(1, Ordering::Relaxed)) {
            results[k].set(run(example, &quick)).unwrap();
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..std::thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(work);
        }
    });
    results.into_iter().map(|result| result.into_inner().unwrap()).collect()
}

/// Runs the command of an example and returns its result.
fn run(example: &Example, quick: &BriefProjects) -> Value {
    let out = Path::new(env!("CARGO_TARGET_TMPDIR")).join("results-page").join(example.name);
    let _ = fs::remove_dir_all(&out);
    fs::create_dir_all(&out).unwrap();
    let result = out.join("result.json");
    let quicker = QUICKER.iter().find(|(name, _)| *name == example.name && !writes());
    let substituted = |word: &&str| {
        let word = quicker.filter(|_| *word == example.command[1]).map_or(*word, |(_, project)| *project);
        match word {
            "RIG" => quick.rig.clone(),
            "FEW" => quick.few.clone(),
            "BRIEF" => quick.brief.clone(),
            "DAMPED" => quick.damped.clone(),
            other => other.replace("OUT", out.to_str().unwrap()),
        }
    };
    let done = Command::new(env!("CARGO_BIN_EXE_counterpoise"))
        .args(example.command.iter().map(substituted))
        .arg(format!("--json={}", result.to_str().unwrap()))
        .arg("--quiet")
        .current_dir(root())
        .output()
        .unwrap();
    assert!(done.status.code() != Some(2), "{}: {}", example.name, String::from_utf8_lossy(&done.stderr));
    let result = if example.name == CONTROLLER { out.join("controller.json") } else { result };
    serde_json::from_str(&fs::read_to_string(result).unwrap()).unwrap()
}

/// Returns the result with its lists cut to three elements, and without paths of this machine.
fn shorten_lists(value: Value) -> Value {
    match value {
        Value::Array(all) => Value::Array(all.into_iter().take(3).map(shorten_lists).collect()),
        Value::Object(all) => {
            Value::Object(all.into_iter().map(|(key, v)| (key, shorten_lists(v))).collect())
        }
        Value::String(text) if text.contains('/') && Path::new(&text).is_absolute() => {
            Value::String(Path::new(&text).file_name().unwrap().to_string_lossy().into_owned())
        }
        other => other,
    }
}

/// Returns the result with the stored figures of cores in the place of its own, if this machine has no compiler for these cores.
fn with_stored_cores(name: &str, mut given: Value) -> Value {
    let known = fs::read_to_string(stored_result(name))
        .ok()
        .and_then(|text| serde_json::from_str::<Value>(&text).ok());
    let cores = known.as_ref().and_then(|known| known.pointer("/targets/cores"));
    if let (Some(own), Some(cores)) = (given.pointer_mut("/targets/cores"), cores)
        && own.as_array().is_some_and(Vec::is_empty)
    {
        *own = cores.clone();
    }
    given
}

/// Keys that are names: of channels, and of the controller's paths.
const NAMES: &[&str] = &[
    "control",
    "hub_rate",
    "hub_position",
    "motor_rate",
    "motor_position",
    "motor_current",
    "platform_rate",
    "platform_accel",
    "feedback",
    "heave",
    "pitch",
];

/// Every key of a result with the type and an example of its value.
fn keys(value: &Value, path: &str, into: &mut BTreeMap<String, (String, String)>) {
    let (kind, shown) = match value {
        Value::Null => ("", "null".to_owned()),
        Value::Bool(b) => ("true or false", b.to_string()),
        Value::Number(number) => ("number", number.as_f64().map(short_number).unwrap_or_default()),
        Value::String(text) => ("text", text.chars().take(60).collect()),
        Value::Array(_) => ("list", String::new()),
        Value::Object(_) => ("object", String::new()),
    };
    let entry = into.entry(path.to_owned()).or_default();
    if entry.0.is_empty() {
        *entry = (kind.to_owned(), shown);
    }
    match value {
        Value::Array(all) => all.iter().for_each(|v| keys(v, &format!("{path}[]"), into)),
        Value::Object(all) => {
            for (key, v) in all {
                let key = if NAMES.contains(&key.as_str()) { "NAME" } else { key };
                let dot = if path.is_empty() { "" } else { "." };
                keys(v, &format!("{path}{dot}{key}"), into);
            }
        }
        _ => {}
    }
}

fn short_number(number: f64) -> String {
    if number.fract() == 0.0 && number.abs() < 1e6 { format!("{number:.0}") } else { format!("{number:.3e}") }
}

fn keys_of(value: &Value) -> BTreeMap<String, (String, String)> {
    let mut all = BTreeMap::new();
    keys(value, "", &mut all);
    all.remove("");
    all
}

fn section(example: &Example) -> String {
    let value: Value =
        serde_json::from_str(&fs::read_to_string(stored_result(example.name)).unwrap()).unwrap();
    let kind = if value.is_array() { "a list" } else { "an object" };
    let command = example.command.join(" ").replace("-o OUT", "-o out").replace("OUT", "out");
    let command = command.replace("RIG", "examples/reference-rig");
    let rows = keys_of(&value).into_iter().map(|(key, (kind, shown))| {
        let kind = if kind.is_empty() { "" } else { &kind };
        format!("| `{key}` | {kind} | {} |\n", shown.replace('|', "\\|"))
    });
    let (option, result) = match example.name {
        CONTROLLER => ("", "`design` and `export` write `controller.json` beside the code"),
        _ => (" --json", "The result"),
    };
    format!(
        "## `{}`\n\n    counterpoise {command}{option}\n\n{result}{}.\n\n| key | type | example |\n|---|---|---|\n{}",
        example.name.replace("-modes", "` without recordings, `[measured]"),
        if example.name == CONTROLLER { format!(": {kind}") } else { format!(" is {kind}") },
        rows.collect::<String>()
    )
}

/// Returns the stored results by their names.
fn all_stored() -> Vec<(&'static str, Value)> {
    let read = |example: &Example| {
        serde_json::from_str(&fs::read_to_string(stored_result(example.name)).unwrap()).unwrap()
    };
    EXAMPLES.iter().map(|example| (example.name, read(example))).collect()
}

/// Returns the published schema, as its file holds it.
fn schema_text() -> String {
    let made = schema::published_schema(&all_stored(), &|key| NAMES.contains(&key));
    serde_json::to_string_pretty(&made).unwrap() + "\n"
}

fn page() -> String {
    let sections = EXAMPLES.iter().map(section);
    std::iter::once(INTRODUCTION.to_owned()).chain(sections).collect::<Vec<_>>().join("\n")
}

#[test]
fn the_program_gives_the_keys_of_the_stored_results() {
    let writes = writes();
    // a new example has no stored result before it is written
    let published: Option<Value> = (!writes).then(|| serde_json::from_str(&schema_text()).unwrap());
    for (example, given) in EXAMPLES.iter().zip(run_all()) {
        if let Some(published) = &published {
            let wrong = schema::violations(&published["$defs"][example.name], &given, example.name);
            assert!(wrong.is_empty(), "{wrong:#?}");
        }
        let given = with_stored_cores(example.name, shorten_lists(given));
        if writes {
            let text = serde_json::to_string_pretty(&given).unwrap();
            fs::write(stored_result(example.name), text + "\n").unwrap();
        }
        let known: Value =
            serde_json::from_str(&fs::read_to_string(stored_result(example.name)).unwrap()).unwrap();
        let names = |value: &Value| keys_of(value).into_keys().collect::<Vec<_>>();
        assert_eq!(names(&given), names(&known), "{}", example.name);
    }
    if writes {
        write_page();
    }
}

/// Writes the page and the schema of the stored results.
fn write_page() {
    fs::write(root().join("docs/reference/results.md"), page()).unwrap();
    fs::write(root().join("docs/reference/results.schema.json"), schema_text()).unwrap();
}

#[test]
fn a_result_that_breaks_the_schema_is_found() {
    if writes() {
        return;
    }
    let published: Value = serde_json::from_str(&schema_text()).unwrap();
    let replay = &published["$defs"]["replay"];
    let (_, good) = all_stored().into_iter().find(|(name, _)| *name == "replay").unwrap();
    assert_eq!(schema::violations(replay, &good, "replay"), [""; 0]);
    let broken = |change: &dyn Fn(&mut Value)| {
        let mut value = good.clone();
        change(&mut value);
        schema::violations(replay, &value, "replay").len()
    };
    assert_eq!(broken(&|v| v["schema"] = "counterpoise.results/1".into()), 1);
    assert_eq!(broken(&|v| v["recordings"] = 3.into()), 1);
    assert_eq!(broken(&|v| drop(v.as_object_mut().unwrap().remove("recordings"))), 1);
    assert_eq!(broken(&|v| v["recordings"][0]["file"] = 1.5.into()), 1);
    assert_eq!(broken(&|v| v["recordings"][0]["new key"] = 1.5.into()), 0);
}

#[test]
fn the_page_of_results_is_current() {
    if writes() {
        return;
    }
    assert_eq!(fs::read_to_string(root().join("docs/reference/results.schema.json")).unwrap(), schema_text());
    let written = fs::read_to_string(root().join("docs/reference/results.md")).unwrap();
    for (number, (written, stored)) in written.lines().zip(page().lines()).enumerate() {
        assert_eq!(written, stored, "line {} of docs/reference/results.md", number + 1);
    }
    assert_eq!(written.lines().count(), page().lines().count());
}
