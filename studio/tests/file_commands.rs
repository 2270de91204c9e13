//! Files through the window: opened, made, saved under other names, dropped; and disks that are full or may not be written.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::common;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use common::{StudioHarness, bench, open_window, rest, rig, says, studio, text, wait_until};
use counterpoise_studio::command::{BrowsePurpose, Command, Page};
use counterpoise_studio::studio::Studio;
use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;

const CTRL: Modifiers = Modifiers::COMMAND;
const CTRL_SHIFT: Modifiers = Modifiers { shift: true, ..Modifiers::COMMAND };

/// Waits until the browser has listed its folder.
fn wait_for_listing(bench: &mut StudioHarness) {
    wait_until(bench, "a listing", |studio| {
        let browser = studio.view.browser.as_ref();
        browser.is_some_and(|b| b.listing.as_ref().is_some_and(|l| l.request.folder == b.folder()))
    });
    bench.run_steps(2);
}

fn name(bench: &mut StudioHarness, name: &str) {
    let path = PathBuf::from("plant.name").display().to_string();
    bench.state_mut().run(&Command::SetText { path, value: name.to_owned() });
    rest(bench);
}

#[test]
fn a_project_is_found_and_opened_by_keyboard_alone() {
    let folder = rig("browse");
    std::fs::create_dir_all(folder.join("machines/turret")).unwrap();
    std::fs::create_dir_all(folder.join("machines/crane")).unwrap();
    std::fs::copy(folder.join("project.toml"), folder.join("machines/turret/project.toml")).unwrap();
    let mut bench = open_window(Studio::new(&folder.join("state"), Arc::new(|| {})));
    bench.run_steps(2);
    bench.state_mut().view.browser.as_mut().unwrap().set_path(&folder.join("machines"));
    wait_for_listing(&mut bench);
    assert!(says(&bench, "turret/") && says(&bench, "crane/"));
    bench.check_accessibility();
    bench.event(egui::Event::Text("cra".to_owned()));
    bench.run_steps(2);
    assert!(!says(&bench, "turret/"), "typing narrows the list");
    assert!(says(&bench, "a new project can be made"));
    (0..3).for_each(|_| bench.key_press(Key::Backspace));
    wait_for_listing(&mut bench);
    bench.key_press(Key::ArrowDown);
    bench.run_steps(2);
    bench.key_press(Key::Enter);
    rest(&mut bench);
    assert_eq!(bench.state().opened.as_ref().unwrap().path, folder.join("machines/turret/project.toml"));
    bench.key_press_modifiers(CTRL, Key::O);
    bench.run_steps(2);
    assert!(says(&bench, "Open or make a project"));
    bench.key_press(Key::Escape);
    bench.run_steps(3);
    assert!(bench.state().view.browser.is_none(), "Esc closes the browser");
    drop(bench);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_project_saved_under_another_name_takes_its_files_along_and_the_old_one_stays() {
    let folder = rig("save-as");
    let original = std::fs::read_to_string(folder.join("project.toml")).unwrap();
    let mut bench = bench(&folder);
    rest(&mut bench);
    name(&mut bench, "second");
    bench.key_press_modifiers(CTRL_SHIFT, Key::S);
    bench.run_steps(2);
    let copy = folder.join("copy");
    bench.state_mut().view.browser.as_mut().unwrap().set_path(&copy);
    wait_for_listing(&mut bench);
    bench.key_press(Key::Enter);
    rest(&mut bench);
    assert!(says(&bench, "saved as"), "{:?}", bench.state().view.notice);
    assert!(bench.state().view.browser.is_none());
    assert!(copy.join("sandy-loam.parquet").is_file(), "the road comes along");
    assert_eq!(std::fs::read_to_string(folder.join("project.toml")).unwrap(), original);
    assert_eq!(std::fs::read_to_string(copy.join("project.toml")).unwrap(), text(&bench));
    bench.key_press_modifiers(CTRL, Key::Z);
    rest(&mut bench);
    assert_eq!(text(&bench), original, "the way back goes on");
    bench.state_mut().run(&Command::Browse { purpose: BrowsePurpose::SaveAs });
    wait_for_listing(&mut bench);
    bench.key_press(Key::Enter);
    bench.run_steps(3);
    assert!(says(&bench, "it would be replaced") && bench.state().view.browser.is_some());
    bench.get_by_label("Replace").click();
    rest(&mut bench);
    assert!(std::fs::read_to_string(copy.join("project.toml")).unwrap() == original);
    drop(bench);
    assert!(
        !studio(&folder).opened.as_ref().unwrap().session.is_changed(),
        "nothing is left of the edits here"
    );
    std::fs::remove_dir_all(folder).unwrap();
}

/// A file that is dropped.
#[derive(Debug)]
struct FileDrop(PathBuf);

impl egui::DroppedFile for FileDrop {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|error| error.to_string())
    }
}

fn let_fall(bench: &mut StudioHarness, paths: &[PathBuf]) {
    for path in paths {
        bench.input_mut().dropped_files.push(Arc::new(FileDrop(path.clone())));
    }
    bench.run_steps(2);
    rest(bench);
}

#[test]
fn recordings_and_projects_are_dropped_and_recordings_are_looked_for() {
    let folder = rig("drop");
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/left-out-friction");
    for file in ["project.toml", "steps.parquet", "triangle.parquet"] {
        std::fs::create_dir_all(folder.join("found")).unwrap();
        std::fs::copy(source.join(file), folder.join("found").join(file)).unwrap();
    }
    let found = |file: &str| folder.join("found").join(file);
    let mut bench = bench(&folder);
    rest(&mut bench);
    let_fall(&mut bench, &[found("project.toml")]);
    assert_eq!(bench.state().opened.as_ref().unwrap().path, found("project.toml"));
    let_fall(&mut bench, &[found("steps.parquet")]);
    assert_eq!(bench.state().view.page, Page::Diagnose);
    assert!(says(&bench, "x its noise floor"), "what was dropped is laid beside the model");
    bench.key_press_modifiers(CTRL, Key::R);
    wait_for_listing(&mut bench);
    assert!(says(&bench, "Add all 2"));
    bench.query_all_by_label_contains("triangle.parquet").last().unwrap().click();
    bench.run_steps(2);
    bench.get_by_label("Add this recording").click();
    rest(&mut bench);
    assert_eq!(bench.state().jobs().recordings, [found("steps.parquet"), found("triangle.parquet")]);
    let_fall(&mut bench, &[folder.join("project.toml")]);
    assert!(bench.state().jobs().recordings.is_empty(), "another project begins without them");
    bench.key_press_modifiers(CTRL, Key::R);
    wait_for_listing(&mut bench);
    assert!(says(&bench, "found"), "where recordings came from is offered again");
    drop(bench);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_full_disk_is_told_and_when_there_is_room_saving_goes_on() {
    let folder = rig("no-room");
    let original = std::fs::read_to_string(folder.join("project.toml")).unwrap();
    let disk = Arc::default();
    let mut bench = common::bench_on(&disk, &folder);
    rest(&mut bench);
    name(&mut bench, "other");
    disk.set_full(true);
    bench.key_press_modifiers(CTRL, Key::S);
    rest(&mut bench);
    assert!(says(&bench, "not saved") && says(&bench, "No space left") && says(&bench, "Ctrl+Shift+S"));
    assert_eq!(std::fs::read_to_string(folder.join("project.toml")).unwrap(), original);
    std::fs::create_dir_all(folder.join("out/controller.h")).unwrap();
    bench.key_press_modifiers(CTRL, Key::E);
    rest(&mut bench);
    assert!(says(&bench, "not exported") && says(&bench, "controller.h"));
    disk.set_full(false);
    bench.key_press_modifiers(CTRL, Key::S);
    rest(&mut bench);
    assert!(says(&bench, "saved "), "there is room again");
    assert!(std::fs::read_to_string(folder.join("project.toml")).unwrap().contains("other"));
    drop(bench);
    std::fs::remove_dir_all(folder).unwrap();
}

/// In the environment of a process that a test starts: the folder that it works in.
const FOLDER: &str = "COUNTERPOISE_FILING_FOLDER";

fn given_folder() -> Option<PathBuf> {
    std::env::var_os(FOLDER).map(PathBuf::from)
}

/// Runs one of the tests here in a process of its own, through a command that narrows what it may do.
fn run_apart(narrow: &[&str], test: &str, folder: &Path) {
    let (program, words) = narrow.split_first().unwrap();
    let test = format!("file_commands::{test}");
    let mut process = std::process::Command::new(program);
    process.args(words).arg(std::env::current_exe().unwrap());
    process.args(["--exact", &test, "--nocapture"]).env(FOLDER, folder);
    let Ok(output) = process.output() else {
        return common::report_skip(&format!("{narrow:?} cannot be run here"));
    };
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    let results = String::from_utf8_lossy(&output.stdout);
    assert!(results.contains("1 passed"), "{test} did not run: {results}");
    said.lines().filter_map(|line| line.strip_prefix("skipped: ")).for_each(common::report_skip);
}

#[test]
fn a_disk_that_fills_up_keeps_the_edits_until_there_is_room() {
    let folder = rig("fills-up");
    // Files of this process may grow to 14 kB: the project fits, a journal of many edits does not. The text stands in its head.
    let text = std::fs::metadata(folder.join("project.toml")).unwrap().len();
    let blocks = (text + text / 8 + 3000) / 512;
    let narrow = format!("trap '' XFSZ; ulimit -S -f {blocks}; exec \"$0\" \"$@\"");
    run_apart(&["sh", "-c", &narrow], "session_on_a_disk_that_fills_up", &folder);
    std::fs::remove_dir_all(folder).unwrap();
}

/// Does nothing in an ordinary run of the tests.
#[test]
fn session_on_a_disk_that_fills_up() {
    let Some(folder) = given_folder() else { return };
    let mut bench = bench(&folder);
    rest(&mut bench);
    let path = "synth.feedback.error.gain".to_owned();
    let set =
        |k: u32| Command::Set { path: path.clone(), value: 26.0 + 0.01 * f64::from(k), gesture: Some(1) };
    (1..=120).for_each(|k| bench.state_mut().run(&set(k)));
    wait_until(&mut bench, "the message", |s| {
        s.view.notice.as_ref().is_some_and(|n| n.text.contains("not kept"))
    });
    bench.run_steps(2);
    assert!(says(&bench, "File too large") && says(&bench, "Ctrl+S"));
    let done = text(&bench);
    let id = std::process::id().to_string();
    let room = std::process::Command::new("prlimit").args(["--pid", &id, "--fsize=unlimited"]).status();
    if !room.is_ok_and(|status| status.success()) {
        return common::report_skip("no prlimit here to make room");
    }
    wait_until(&mut bench, "the journal", |s| {
        s.view.notice.as_ref().is_some_and(|n| n.text.contains("are kept again"))
    });
    common::crash(bench);
    let again = studio(&folder);
    assert_eq!(again.opened.as_ref().unwrap().session.text(), done, "a crash now takes nothing");
    eprintln!("tried: 120 edits on a full disk, all there again");
}

#[test]
fn a_read_only_folder_is_told_and_another_place_takes_the_work() {
    let folder = rig("read-only");
    let all = std::os::unix::fs::PermissionsExt::from_mode;
    for name in ["state", "other"] {
        std::fs::create_dir_all(folder.join(name)).unwrap();
        std::fs::set_permissions(folder.join(name), all(0o777)).unwrap();
    }
    std::fs::set_permissions(&folder, all(0o555)).unwrap();
    let is_root = std::fs::write(folder.join("may"), "").is_ok();
    let _ = std::fs::remove_file(folder.join("may"));
    let narrow: &[&str] =
        if is_root { &["setpriv", "--reuid=65534", "--regid=65534", "--clear-groups"] } else { &["env"] };
    run_apart(narrow, "session_in_a_read_only_folder", &folder);
    std::fs::set_permissions(&folder, all(0o755)).unwrap();
    std::fs::remove_dir_all(folder).unwrap();
}

/// Does nothing in an ordinary run of the tests.
#[test]
fn session_in_a_read_only_folder() {
    let Some(folder) = given_folder() else { return };
    let mut bench = bench(&folder);
    rest(&mut bench);
    name(&mut bench, "other");
    bench.key_press_modifiers(CTRL, Key::S);
    rest(&mut bench);
    assert!(says(&bench, "not saved") && says(&bench, "Permission denied") && says(&bench, "Ctrl+Shift+S"));
    bench.key_press_modifiers(CTRL, Key::E);
    rest(&mut bench);
    assert!(says(&bench, "not exported") && says(&bench, "Ctrl+Shift+E"));
    bench.state_mut().run(&Command::Browse { purpose: BrowsePurpose::Export });
    bench.state_mut().view.browser.as_mut().unwrap().set_path(&folder.join("other/code"));
    wait_for_listing(&mut bench);
    bench.get_by_label("Export here").click();
    rest(&mut bench);
    assert!(folder.join("other/code/controller.c").is_file(), "{:?}", bench.state().view.notice);
    bench.state_mut().run(&Command::SaveAs { path: folder.join("machine.toml") });
    rest(&mut bench);
    assert!(says(&bench, "choose another place"));
    bench.state_mut().run(&Command::SaveAs { path: folder.join("other") });
    rest(&mut bench);
    assert!(says(&bench, "saved as") && folder.join("other/project.toml").is_file());
    assert!(!bench.state().opened.as_ref().unwrap().session.is_changed());
    eprintln!("tried: a read-only folder");
}
