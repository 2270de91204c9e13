//! Campaigns of the command line: the same bytes however they are cut, run or killed.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::OnceLock;
use std::time::Duration;

use crate::support;

/// A quick campaign on the example's design.
const CAMPAIGN: &str = r#"
[verify]
duration = 1.0
settle = 0.3
[[verify.requirement]]
figure = "gain_margin_db"
at_least = 9.0
[[verify.requirement]]
figure = "nonlinear_both_compensated_hub_rms_rad_s"
at_most = 0.02
[sweep]
samples = 120
seed = 5
[[sweep.variation]]
parameter = "hub_inertia"
low = 0.8
high = 1.25
[[sweep.variation]]
parameter = "friction"
distribution = "log-uniform"
low = 0.5
high = 2.0
"#;

/// Returns a fresh folder with the project in it.
fn folder(name: &str) -> PathBuf {
    support::folder_with(name, CAMPAIGN)
}

fn sweep(folder: &Path, threads: &str, more: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_counterpoise"));
    command.arg("sweep").arg(folder).arg("-o").arg(folder.join("out")).arg("-q").args(more);
    command.env("RAYON_NUM_THREADS", threads).stdout(Stdio::null()).stderr(Stdio::piped());
    command
}

fn samples(folder: &Path) -> Vec<u8> {
    fs::read(folder.join("out/samples.parquet")).unwrap()
}

/// Returns the bytes of an undisturbed run on one thread, which is made once for all tests.
fn reference() -> &'static [u8] {
    static BYTES: OnceLock<Vec<u8>> = OnceLock::new();
    BYTES.get_or_init(|| {
        let folder = folder("sweep_one");
        let done = sweep(&folder, "1", &[]).output().unwrap();
        assert!(done.status.code().is_some_and(|code| code < 2), "{}", String::from_utf8_lossy(&done.stderr));
        samples(&folder)
    })
}

#[test]
fn threads_and_shards_do_not_change_a_byte() {
    let expected = reference();
    let two = folder("sweep_two");
    sweep(&two, "2", &[]).output().unwrap();
    assert!(samples(&two) == expected, "two threads");
    let cut = folder("sweep_cut");
    for shard in ["2/3", "0/3", "1/3"] {
        assert!(sweep(&cut, "2", &["--shard", shard]).status().unwrap().success());
    }
    sweep(&cut, "1", &["--merge"]).output().unwrap();
    assert!(samples(&cut) == expected, "three shards");
}

#[test]
fn a_killed_campaign_goes_on_to_the_same_result() {
    let expected = reference();
    let killed = folder("sweep_killed");
    let mut state = 20_260_101_u64;
    for _ in 0..50 {
        let mut child = sweep(&killed, "2", &[]).spawn().unwrap();
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        std::thread::sleep(Duration::from_millis(20 + (state >> 33) % 400));
        let _ = child.kill();
        child.wait().unwrap();
    }
    sweep(&killed, "2", &[]).output().unwrap();
    assert!(samples(&killed) == expected);
}

#[test]
fn shards_of_another_campaign_are_refused() {
    let mixed = folder("sweep_mixed");
    assert!(sweep(&mixed, "1", &["--shard", "0/2"]).status().unwrap().success());
    let text = fs::read_to_string(mixed.join("project.toml")).unwrap();
    fs::write(mixed.join("project.toml"), text.replace("seed = 5", "seed = 6")).unwrap();
    assert!(sweep(&mixed, "1", &["--shard", "1/2"]).status().unwrap().success());
    let refused = sweep(&mixed, "1", &["--merge"]).output().unwrap();
    assert_eq!(refused.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("another campaign"));
}

/// A shard of another version is refused by its name, even where project, seed and samples are the same.
#[test]
fn shards_of_another_version_are_refused() {
    let mixed = folder("sweep_versions");
    for shard in ["0/2", "1/2"] {
        assert!(sweep(&mixed, "1", &["--shard", shard]).status().unwrap().success());
    }
    let path = mixed.join("out/shard-000001-of-000002.parquet");
    let mut bytes = fs::read(&path).unwrap();
    let version = format!("{} ", env!("CARGO_PKG_VERSION"));
    let at = bytes.windows(version.len()).position(|part| part == version.as_bytes()).unwrap();
    bytes[at] = b'9';
    fs::write(&path, bytes).unwrap();
    let refused = sweep(&mixed, "1", &["--merge"]).output().unwrap();
    let told = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert_eq!(refused.status.code(), Some(2), "{told}");
    assert!(told.contains("another campaign") && told.contains("version"), "{told}");
}

#[test]
fn a_campaign_tells_what_a_large_one_would_cost_unless_nothing_was_run() {
    let told = folder("sweep_cost");
    let run = || {
        let mut command = Command::new(env!("CARGO_BIN_EXE_counterpoise"));
        command.arg("sweep").arg(&told).arg("-o").arg(told.join("out")).env("RAYON_NUM_THREADS", "1");
        String::from_utf8(command.output().unwrap().stderr).unwrap()
    };
    let first = run();
    let line = first.lines().last().unwrap_or_default();
    assert!(line.starts_with("120 samples run in ") && line.contains(" on 1 thread: "), "{first}");
    assert!(line.contains("at this pace 100000 would take "), "{first}");
    fs::remove_file(told.join("out/shard-000002-of-000003.parquet")).unwrap();
    assert!(run().contains("40 samples run in "), "only the shard that was missing");
    assert!(!run().contains("100000"), "nothing was run");
}

/// What the search from the worst samples finds is at least as bad, and its options run the same mechanism again.
#[test]
fn a_worst_case_is_told_and_can_be_run_again() {
    let folder = folder("sweep_worst");
    let run = |more: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_counterpoise"));
        command.arg("sweep").arg(&folder).arg("-o").arg(folder.join("out")).arg("-q").args(more);
        String::from_utf8(command.output().unwrap().stdout).unwrap()
    };
    let result = folder.join("result.json");
    let text = run(&[&format!("--json={}", result.display())]);
    let rows: serde_json::Value = serde_json::from_str(&fs::read_to_string(result).unwrap()).unwrap();
    for (k, row) in rows["figures"].as_array().unwrap().iter().enumerate() {
        let (worst, figure) = (&row["worst_case"], row["figure"].as_str().unwrap());
        let options: Vec<&str> = worst["options"].as_str().unwrap().split(' ').collect();
        let again: serde_json::Value =
            serde_json::from_str(&run(&[&options[..], &["--json"]].concat())).unwrap();
        let (told, found) = (worst["value"].as_f64().unwrap(), again["figures"][k][1].as_f64().unwrap());
        assert!((told - found).abs() < 1e-3 * told.abs(), "{figure}: {told} and {found}");
        let least = row["q05"].as_f64().unwrap();
        assert!(if k == 0 { told <= least } else { told >= row["q95"].as_f64().unwrap() }, "{figure}");
    }
    assert!(text.contains("linear, sliding friction: robust: stable for every mechanism within "), "{text}");
    assert!(text.contains("linear: the linear loop is stable within "), "{text}");
    assert!(text.contains("linear: design, at rest: robust: stable within "), "{text}");
    assert!(
        text.contains("friction: not in the linear loop") || text.contains("friction: dry friction counts"),
        "{text}"
    );
    let page = fs::read_to_string(folder.join("out/report.html")).unwrap();
    assert!(page.contains("Linear worst case") && page.contains("Structured singular value"));
}

#[test]
fn a_factor_that_does_not_vary_and_a_campaign_in_which_nothing_varies_are_told() {
    let folder = folder("sweep_nothing");
    let refused = sweep(&folder, "1", &["--sample", "3", "--factors", "inertai=2"]).output().unwrap();
    let told = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert_eq!(refused.status.code(), Some(2));
    assert!(told.contains("what varies here is hub_inertia, friction"), "{told}");
    let text = fs::read_to_string(folder.join("project.toml")).unwrap();
    let cut = text.split("[[sweep.variation]]").next().unwrap().to_owned();
    fs::write(folder.join("project.toml"), cut).unwrap();
    let refused = sweep(&folder, "1", &[]).output().unwrap();
    assert_eq!(refused.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("[[sweep.variation]]"));
}
