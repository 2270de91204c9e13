//! Hostile and accidental projects and surroundings: pipes, devices, links and huge numbers in a project file, escape
//! codes in its texts, arguments that are not UTF-8, a lost standard output. The program says what is wrong, soon, with its
//! documented exit code, and sends no control character to the terminal.
#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::ffi::OsStr;
use std::fs;
use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::symlink;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use crate::support;

use support::counterpoise;

const RIG: &str = include_str!("../../examples/reference-rig/project.toml");
/// No refusal may take longer.
const SOON: Duration = Duration::from_secs(60);

/// Runs a command that must end soon.
fn soon(command: &mut Command) -> Output {
    let begun = Instant::now();
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    while child.try_wait().unwrap().is_none() {
        if begun.elapsed() > SOON {
            child.kill().unwrap();
            panic!("{command:?} has not ended after {SOON:?}");
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    child.wait_with_output().unwrap()
}

/// Refused with code 2; what was said, free of control characters.
fn refusal_text(command: &mut Command) -> String {
    let output = soon(command);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.chars().all(|c| c == '\n' || c == '\t' || !c.is_control()), "{said:?}");
    said
}

/// Returns the reference rig with a recording of the platform's motion under a name.
fn with_road(name: &str) -> String {
    let kept: Vec<&str> = RIG.split("[verify.road]").collect();
    let rest = kept.get(1).map_or("", |rest| rest.find("\n[").map_or("", |at| &rest[at..]));
    format!(
        "{}[verify.road]\nrecording = \"{name}\"\nheave = \"a\"\npitch = \"b\"\nduration = 10.0\n{rest}",
        kept[0]
    )
}

#[test]
fn references_that_are_no_regular_files_are_refused_at_once() {
    let folder = support::folder("hostile_references");
    assert!(Command::new("mkfifo").arg(folder.join("pipe.csv")).status().unwrap().success());
    symlink("/etc/passwd", folder.join("link.csv")).unwrap();
    symlink("/dev/zero", folder.join("device.csv")).unwrap();
    fs::create_dir(folder.join("folder.csv")).unwrap();
    let cases = [
        ("pipe.csv", "no regular file but a pipe"),
        ("link.csv", "symbolic link"),
        ("device.csv", "symbolic link"),
        ("/dev/zero", "no regular file but a pipe, a socket or a device"),
        ("folder.csv", "a folder, not a file"),
        ("absent.csv", "absent.csv"),
    ];
    for (name, expected) in cases {
        fs::write(folder.join("project.toml"), with_road(name)).unwrap();
        let said = refusal_text(counterpoise().arg("verify").arg(&folder).arg("-q"));
        assert!(said.contains(expected), "{name}: {said}");
    }
}

#[test]
fn pipes_and_devices_as_inputs_are_refused_at_once() {
    let folder = support::folder("hostile_inputs");
    fs::write(folder.join("project.toml"), RIG).unwrap();
    assert!(Command::new("mkfifo").arg(folder.join("pipe")).status().unwrap().success());
    for input in ["/dev/zero", "/dev/tty", folder.join("pipe").to_str().unwrap()] {
        refusal_text(counterpoise().arg("model").arg(input));
        refusal_text(counterpoise().arg("replay").arg(&folder).arg(input));
    }
}

#[test]
fn runs_that_no_machine_has_memory_for_are_refused_with_an_estimate() {
    let folder = support::folder("hostile_sizes");
    let cases = [
        ("duration", RIG.replacen("[verify]", "[verify]\nduration = 1e5", 1)),
        ("sample_period", replace_value(RIG, "sample_period", "1e-7")),
    ];
    for (name, text) in cases {
        let text = without_second(&text, "[verify]", "duration");
        fs::write(folder.join("project.toml"), text).unwrap();
        let said = refusal_text(counterpoise().arg("verify").arg(&folder).arg("-q"));
        assert!(said.contains("GB") || said.contains("sample"), "{name}: {said}");
    }
}

/// Returns the text with the first value of a key replaced.
fn replace_value(text: &str, key: &str, value: &str) -> String {
    let mut done = false;
    let line = |line: &str| match line.trim_start().starts_with(key) && !done {
        true => {
            done = true;
            format!("{key} = {value}")
        }
        false => line.to_owned(),
    };
    text.lines().map(line).collect::<Vec<_>>().join("\n")
}

/// Returns the text without a second value of a key in a section.
fn without_second(text: &str, section: &str, key: &str) -> String {
    let (mut inside, mut count) = (false, 0);
    let keep = |line: &&str| {
        if line.starts_with('[') {
            inside = *line == section;
        }
        let is_key = inside && line.split('=').next().is_some_and(|found| found.trim() == key);
        count += usize::from(is_key);
        !is_key || count == 1
    };
    text.lines().filter(keep).collect::<Vec<_>>().join("\n")
}

#[test]
fn texts_of_a_project_cannot_speak_to_the_terminal() {
    let folder = support::folder("hostile_escapes");
    let hostile = "\\u001b]0;owned\\u0007\\u001b[2J\\u202e";
    let text = replace_value(RIG, "name", &format!("\"{hostile}\""));
    fs::write(folder.join("project.toml"), &text).unwrap();
    let output = soon(counterpoise().arg("model").arg(&folder));
    for stream in [output.stdout, output.stderr] {
        let said = String::from_utf8_lossy(&stream).into_owned();
        assert!(said.chars().all(|c| c == '\n' || c == '\t' || !c.is_control()), "{said:?}");
        assert!(!said.contains('\u{202e}'), "{said:?}");
    }
    fs::write(folder.join("project.toml"), format!("\"{hostile}\" = 1\n{text}")).unwrap();
    refusal_text(counterpoise().arg("model").arg(&folder));
}

#[test]
fn very_many_errors_are_counted_and_cut_short() {
    let folder = support::folder("hostile_many");
    let wrong: String = (0..20_000).map(|k| format!("unknown_{k} = {k}\n")).collect();
    fs::write(folder.join("project.toml"), wrong + RIG).unwrap();
    let said = refusal_text(counterpoise().arg("model").arg(&folder));
    assert!(said.contains("more") && said.len() < 100_000, "{} bytes", said.len());
}

#[test]
fn very_many_masses_are_counted_and_cut_short() {
    let folder = support::folder("hostile_masses");
    let mass = |k: usize| format!("[[plant.beam.mass]]\nname = \"{k}\"\nposition = 0.1\nmass = 1e-4\n");
    let project = format!(
        "[plant]\nname = \"beam\"\n[plant.beam]\nyoungs_modulus = 2e11\ndensity = 7850.0\npivot = 0.0\nmodal_damping = [0.01]\n\
         [[plant.beam.section]]\nname = \"tube\"\nfrom = -1.0\nto = 1.0\nouter_diameter = [0.1, 0.1]\ninner_diameter = [0.05, 0.05]\n\
         {}[plant.motor]\ninertia = 1e-3\n[plant.drive]\nkind = \"torque\"\nlimit = 200.0\n[plant.interface]\nsample_period = 1e-3\n",
        (0..20_000).map(mass).collect::<String>()
    );
    fs::write(folder.join("project.toml"), project).unwrap();
    let output = soon(counterpoise().arg("check").arg(&folder));
    let said = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(said.contains("and 19980 more") && said.lines().count() < 200, "{} lines", said.lines().count());
}

#[test]
fn arguments_need_not_be_utf8() {
    let folder = support::folder("hostile_arguments");
    let name = OsStr::from_bytes(b"rig-\xff\xfe.toml");
    fs::write(folder.join(name), RIG).unwrap();
    let output = soon(counterpoise().arg("model").arg(folder.join(name)).arg("-q"));
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let said = refusal_text(counterpoise().arg(OsStr::from_bytes(b"--wei\xffrd")));
    assert!(said.contains("error"), "{said}");
}

#[test]
fn a_lost_standard_output_is_a_failure() {
    let folder = support::folder("hostile_lost");
    fs::write(folder.join("project.toml"), RIG).unwrap();
    let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let output = counterpoise().arg("model").arg(&folder).stdout(full).output().unwrap();
    assert_eq!(output.status.code(), Some(3));
    assert!(String::from_utf8_lossy(&output.stderr).contains("could not be written"));
    let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    assert_eq!(counterpoise().arg("--help").stdout(full).output().unwrap().status.code(), Some(3));
    let mut child = counterpoise()
        .arg("model")
        .arg(&folder)
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    assert_eq!(child.wait().unwrap().code(), Some(3));
}

#[test]
fn the_temporary_folder_and_partial_files_belong_to_this_user_alone() {
    use std::os::unix::fs::PermissionsExt;
    let folder = support::folder("hostile_modes");
    let scratch = counterpoise_host::files::scratch_folder().unwrap();
    assert_eq!(fs::metadata(scratch.path()).unwrap().permissions().mode() & 0o777, 0o700);
    // What stands in the place of a partial file is not written through.
    symlink("/etc/passwd", folder.join("a.txt.partial")).unwrap();
    counterpoise_host::files::write_file(&folder.join("a.txt"), b"content").unwrap();
    assert_eq!(fs::read(folder.join("a.txt")).unwrap(), b"content");
    // A link in the place of the file is replaced, and what it names stays as it was.
    fs::write(folder.join("target"), b"kept").unwrap();
    symlink(folder.join("target"), folder.join("b.txt")).unwrap();
    counterpoise_host::files::write_file(&folder.join("b.txt"), b"new").unwrap();
    assert_eq!(fs::read(folder.join("target")).unwrap(), b"kept");
    assert_eq!(fs::read(folder.join("b.txt")).unwrap(), b"new");
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 4);
}

/// A result is never renamed over a device or a pipe: that would replace it.
#[test]
fn what_is_no_file_is_not_replaced_by_a_result() {
    use std::os::unix::fs::FileTypeExt;
    let folder = support::folder("hostile_places");
    fs::write(folder.join("project.toml"), RIG).unwrap();
    let model = |place: &std::path::Path| {
        soon(counterpoise().arg("model").arg(&folder).arg("-q").arg(format!("--json={}", place.display())))
    };
    let pipe = folder.join("pipe");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    symlink(&pipe, folder.join("link")).unwrap();
    for place in [pipe.clone(), folder.join("link"), folder.clone()] {
        let output = model(&place);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains("no regular file") || said.contains("a folder"), "{said}");
    }
    assert!(fs::symlink_metadata(&pipe).unwrap().file_type().is_fifo());
    assert!(fs::symlink_metadata(folder.join("link")).unwrap().is_symlink());
    let null = folder.join("null");
    let made = Command::new("mknod").arg(&null).args(["c", "1", "3"]).stderr(Stdio::null()).status();
    if !made.is_ok_and(|status| status.success()) {
        return support::report_skip("no right to make a device: none is written to");
    }
    assert_eq!(model(&null).status.code(), Some(0));
    assert!(fs::symlink_metadata(&null).unwrap().file_type().is_char_device());
    let output =
        counterpoise().arg("model").arg(&folder).args(["-q", "--json=/dev/stdout"]).output().unwrap();
    assert!(serde_json::from_slice::<serde_json::Value>(&output.stdout).is_ok());
}

/// What JSON holds of a hostile name is harmless on a terminal, and means the same.
#[test]
fn json_of_hostile_names_can_be_read() {
    let name = "a\u{1b}[2J\u{7f}\u{202e}\u{2028}b";
    let folder = support::folder("hostile_json").join(name);
    fs::create_dir(&folder).unwrap();
    fs::write(folder.join("project.toml"), RIG).unwrap();
    let output = counterpoise().arg("check").arg(&folder).args(["-q", "--json"]).output().unwrap();
    let result: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(result["file"].as_str().unwrap().contains(name), "{}", result["file"]);
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(said.chars().all(|c| c == '\n' || !(c.is_control() || c == '\u{202e}')), "{said:?}");
}

/// Of two programs that export into one folder at once, the files of one stand there in the end.
#[test]
fn two_writers_leave_the_set_of_one() {
    let folder = support::folder("hostile_writers");
    let rig = fs::read_to_string(
        std::path::Path::new(support::EXAMPLE).with_file_name("../appendix-5/integral.toml"),
    )
    .unwrap();
    let out = folder.join("out");
    let projects = ["one", "two"].map(|name| {
        let path = folder.join(format!("{name}.toml"));
        fs::write(&path, replace_value(&rig, "name", &format!("\"machine {name}\""))).unwrap();
        path
    });
    let export = |path| {
        counterpoise()
            .arg("export")
            .arg(path)
            .arg("-q")
            .arg("-o")
            .arg(&out)
            .stdout(Stdio::null())
            .spawn()
            .unwrap()
    };
    for mut child in projects.each_ref().map(export) {
        assert_eq!(child.wait().unwrap().code(), Some(0));
    }
    let mut marks = std::collections::BTreeSet::new();
    let mut names = std::collections::BTreeSet::new();
    for entry in fs::read_dir(&out).unwrap() {
        let text = fs::read_to_string(entry.unwrap().path()).unwrap();
        marks.extend(text.split("_SET_").skip(1).map(|rest| rest[..16].to_owned()));
        names.extend(["machine one", "machine two"].into_iter().filter(|name| text.contains(name)));
    }
    assert_eq!((marks.len(), names.len()), (1, 1), "{marks:?} {names:?}");
}
