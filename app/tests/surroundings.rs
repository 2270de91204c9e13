//! Results do not depend on where and when the program runs: not on locale, time zone, folder, home or number of threads.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;
use std::path::Path;

use crate::support;

use support::counterpoise;

/// Variables of the environment of the runs that are compared: locale, time zone, threads, home.
const SURROUNDINGS: [[(&str, &str); 5]; 3] = [
    [("LC_ALL", "C"), ("LANG", "C"), ("TZ", "UTC"), ("RAYON_NUM_THREADS", "1"), ("HOME", "/")],
    [
        ("LC_ALL", "de_DE.UTF-8"),
        ("LANG", "de_DE.UTF-8"),
        ("TZ", "Asia/Kathmandu"),
        ("RAYON_NUM_THREADS", "2"),
        ("HOME", "/nonexistent"),
    ],
    [
        ("LC_ALL", "tr_TR.UTF-8"),
        ("LANG", "ar_EG.UTF-8"),
        ("TZ", "America/St_Johns"),
        ("RAYON_NUM_THREADS", "5"),
        ("HOME", ""),
    ],
];

/// Returns what a command prints in every surrounding; each runs in a folder of its own.
fn print_everywhere(name: &str, arguments: &[&str]) -> Vec<Vec<u8>> {
    let run = |(k, variables): (usize, &[(&str, &str); 5])| {
        let mut command = counterpoise();
        command.args(arguments).arg("-q").envs(variables.iter().copied());
        let output =
            command.current_dir(support::folder(&format!("surroundings_{name}_{k}"))).output().unwrap();
        assert!(
            output.stderr.is_empty() && !output.stdout.is_empty(),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
        output.stdout
    };
    SURROUNDINGS.iter().enumerate().map(run).collect()
}

#[test]
fn results_are_the_same_bytes_in_every_locale_zone_and_folder() {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples");
    let friction = examples.join("left-out-friction");
    let recording = friction.join("steps.parquet");
    let (friction, recording) = (friction.to_str().unwrap(), recording.to_str().unwrap());
    let rig = examples.join("appendix-5/integral.toml");
    let rig = rig.to_str().unwrap();
    let gimbal = examples.join("direct-gimbal");
    for (name, arguments) in [
        ("model", vec!["model", friction, "--json"]),
        ("replay", vec!["replay", friction, recording, "--json"]),
        ("synth", vec!["synth", rig, "--json"]),
        ("export", vec!["export", gimbal.to_str().unwrap(), "-o", "out", "--json"]),
    ] {
        let printed = print_everywhere(name, &arguments);
        assert!(printed.windows(2).all(|two| two[0] == two[1]), "{name}");
    }
    let exported = |k: usize| {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("surroundings_export_{k}/out"));
        let mut files: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
        files.sort();
        let named = files.iter().filter(|path| path.is_file());
        named.map(|path| (path.file_name().unwrap().to_owned(), fs::read(path).unwrap())).collect::<Vec<_>>()
    };
    assert!(exported(0).len() > 2);
    assert!(exported(0) == exported(1) && exported(1) == exported(2), "exported files differ");
}
