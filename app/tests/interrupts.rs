//! Ctrl-C ends every long command with exit code 130, whether it stops in good order or at once.
#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::support;

use support::{CAMPAIGN, counterpoise, folder, folder_with};

/// No command may take longer to stop. The machine that runs the tests may be busy with others.
const SOON: Duration = Duration::from_secs(120);
/// The program is interrupted when it has used this much processor time: it is then at work, and far from its end. Ticks of 10 ms.
const AT_WORK_TICKS: u64 = 8;

fn example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples").join(name)
}

/// Returns the processor time that a process has used, in ticks; `None` if it has ended.
fn ticks(child: &Child) -> Option<u64> {
    let text = fs::read_to_string(format!("/proc/{}/stat", child.id())).ok()?;
    let fields: Vec<&str> = text.rsplit_once(") ")?.1.split(' ').collect();
    Some(fields.get(11)?.parse::<u64>().ok()? + fields.get(12)?.parse::<u64>().ok()?)
}

/// Starts a command, interrupts it when it is at work, and returns its exit code.
fn interrupt_command(command: &mut Command) -> Option<i32> {
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let begun = Instant::now();
    while ticks(&child).is_some_and(|used| used < AT_WORK_TICKS) {
        assert!(child.try_wait().unwrap().is_none(), "{command:?} ended before it could be interrupted");
        assert!(begun.elapsed() < SOON, "{command:?} does not begin");
        std::thread::sleep(Duration::from_millis(5));
    }
    assert!(child.try_wait().unwrap().is_none(), "{command:?} ended before it could be interrupted");
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let asked = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if asked.elapsed() > SOON {
            child.kill().unwrap();
            panic!("{command:?} goes on {SOON:?} after Ctrl-C");
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    child.wait().unwrap().code()
}

/// Writes a recording of half a million rows.
fn long_recording(folder: &Path) -> PathBuf {
    let mut text = "time [s],demand [rad/s],hub_rate [rad/s]\n".to_owned();
    for k in 0..500_000 {
        let rate = 0.1 * (0.003 * f64::from(k)).sin();
        writeln!(text, "{:.3},{rate:.6},{rate:.6}", f64::from(k) * 1e-3).unwrap();
    }
    let path = folder.join("long.csv");
    fs::write(&path, text).unwrap();
    path
}

#[test]
fn every_long_command_ends_with_code_130() {
    let out = folder("interrupts");
    let campaign = folder_with("interrupts_sweep", &CAMPAIGN.replace("samples = 4", "samples = 100000"));
    let recording = long_recording(&out);
    let friction = example("left-out-friction");
    let (road, steps) = (friction.join("road.parquet"), friction.join("steps.parquet"));
    let (rig, adaptation) = (example("reference-rig"), example("adaptation"));
    let searched = example("lqg-ltr-and-hinf");
    let commands: [(&str, Vec<&Path>); 10] = [
        ("design", vec![&rig, Path::new("-o"), &out]),
        ("verify", vec![&rig]),
        ("sweep", vec![&campaign, Path::new("-o"), &out]),
        ("synth", vec![&searched, Path::new("--search")]),
        ("replay", vec![&friction, &recording]),
        ("diagnose", vec![&friction, &road, &steps]),
        ("identify", vec![&friction, &recording, Path::new("--other"), &recording]),
        ("fra", vec![&rig]),
        ("adapt", vec![&adaptation]),
        ("export", vec![&rig, Path::new("-o"), &out]),
    ];
    let mut wrong = Vec::new();
    for (name, arguments) in commands {
        let mut command = counterpoise();
        let code = interrupt_command(command.arg(name).args(arguments).arg("-q"));
        if code != Some(130) {
            wrong.push((name, code));
        }
    }
    assert!(wrong.is_empty(), "{wrong:?}");
}

/// A campaign that was interrupted keeps the shards that it finished, and the same command goes on from there.
#[test]
fn an_interrupted_campaign_keeps_what_was_finished() {
    let campaign = folder_with("interrupts_kept", &CAMPAIGN.replace("samples = 4", "samples = 400"));
    let out = campaign.join("out");
    let sweep = || {
        let mut command = counterpoise();
        command.arg("sweep").arg(&campaign).arg("-o").arg(&out).arg("-q").stdout(Stdio::null());
        command
    };
    let shards = || {
        fs::read_dir(&out).map_or(0, |all| {
            all.filter(|entry| entry.as_ref().unwrap().file_name().to_string_lossy().starts_with("shard-"))
                .count()
        })
    };
    let mut child = sweep().stderr(Stdio::null()).spawn().unwrap();
    let begun = Instant::now();
    while shards() == 0 {
        assert!(begun.elapsed() < SOON, "no shard is finished");
        std::thread::sleep(Duration::from_millis(2));
    }
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    let kept = shards();
    assert!(kept > 0);
    assert!(sweep().status().unwrap().code().is_some_and(|code| code < 2));
    assert!(shards() >= kept);
}
