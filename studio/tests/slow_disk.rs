//! A disk that takes its time: frames go on while a project is read or saved, and nothing is lost.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::common;

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Condvar, Mutex};
use std::time::{Duration, Instant};

use common::{StudioHarness, open_window, rest, rig, says, studio, text, wait_for_files, wait_until};
use counterpoise_host::files::Disk;
use counterpoise_studio::command::Command;
use counterpoise_studio::studio::Studio;
use egui::{Key, Modifiers};

const CTRL: Modifiers = Modifiers::COMMAND;
/// Frames that are drawn while the disk is held.
const FRAMES: usize = 100;

/// A disk that can be held: until it is let go no read ends, and no wait for what was written.
#[derive(Default)]
struct HeldDisk {
    is_held: Mutex<bool>,
    changed: Condvar,
}

impl HeldDisk {
    fn hold(&self) {
        *self.is_held.lock().unwrap() = true;
    }

    fn let_go(&self) {
        *self.is_held.lock().unwrap() = false;
        self.changed.notify_all();
    }

    fn wait(&self) {
        drop(self.changed.wait_while(self.is_held.lock().unwrap(), |held| *held).unwrap());
    }
}

impl Disk for HeldDisk {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        self.wait();
        std::fs::read(path)
    }

    fn sync(&self, file: &File) -> io::Result<()> {
        self.wait();
        file.sync_all()
    }
}

fn open_on(disk: &Arc<HeldDisk>, folder: &Path) -> StudioHarness {
    let disk = Arc::clone(disk) as Arc<dyn Disk>;
    let mut studio = Studio::with_disk(&folder.join("state"), Arc::new(|| {}), disk);
    studio.run(&Command::Open { path: folder.to_owned() });
    wait_for_files(&mut studio);
    open_window(studio)
}

/// Waits until a line that is not the first of a journal holds a text.
fn wait_for_journal(folder: &Path, text: &str) {
    let end = Instant::now() + Duration::from_secs(60);
    let holds = |path: PathBuf| {
        let journal = std::fs::read_to_string(path).unwrap_or_default();
        journal.lines().skip(1).any(|line| line.contains(text))
    };
    let found = || std::fs::read_dir(folder.join("state")).unwrap().any(|entry| holds(entry.unwrap().path()));
    while !found() {
        assert!(Instant::now() < end, "no journal holds {text}");
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// Returns a copy of the reference rig, open in a window at rest, on a disk that is not held yet.
fn open_rig(name: &str) -> (PathBuf, Arc<HeldDisk>, StudioHarness) {
    let (folder, disk) = (rig(name), Arc::new(HeldDisk::default()));
    let mut bench = open_on(&disk, &folder);
    rest(&mut bench);
    (folder, disk, bench)
}

fn gain(value: f64) -> Command {
    Command::Set { path: "synth.feedback.error.gain".to_owned(), value, gesture: None }
}

fn file(folder: &Path) -> String {
    std::fs::read_to_string(folder.join("project.toml")).unwrap()
}

#[test]
fn frames_go_on_while_a_save_takes_its_time_and_what_is_edited_meanwhile_stays_unsaved() {
    let (folder, disk, mut bench) = open_rig("slow-save");
    let before = file(&folder);
    bench.state_mut().run(&gain(27.0));
    rest(&mut bench);
    disk.hold();
    bench.key_press_modifiers(CTRL, Key::S);
    bench.run_steps(2);
    assert!(says(&bench, "saving") && bench.state().file_queue.is_saving());
    bench.state_mut().run(&gain(28.0));
    bench.run_steps(FRAMES);
    wait_until(&mut bench, "the design of the last edit", |s| {
        s.results.design.as_ref().is_some_and(|live| live.revision == 2)
    });
    assert!(bench.state().file_queue.is_saving(), "the disk is still held");
    wait_for_journal(&folder, "28");
    disk.let_go();
    wait_until(&mut bench, "the save", |s| !s.file_queue.is_saving());
    bench.run_steps(2);
    assert!(says(&bench, "edited") && says(&bench, "saved "));
    assert!(file(&folder).contains("gain = 27.0") && text(&bench).contains("gain = 28.0"));
    assert_ne!(before, file(&folder));
    disk.hold();
    bench.state_mut().run(&gain(29.0));
    wait_for_journal(&folder, "29");
    common::crash(bench);
    let again = studio(&folder);
    assert!(
        again.opened.as_ref().unwrap().session.text().contains("gain = 29.0"),
        "the journal has it at once"
    );
    drop(again);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn two_saves_are_made_in_order_and_leaving_waits_for_them() {
    let (folder, disk, mut bench) = open_rig("slow-order");
    disk.hold();
    for value in [27.0, 28.0] {
        bench.state_mut().run(&gain(value));
        bench.state_mut().run(&Command::Save);
    }
    bench.state_mut().run(&Command::Close);
    bench.state_mut().run(&gain(29.0));
    bench.run_steps(FRAMES);
    assert!(bench.state().opened.is_some(), "the project stays until it is saved");
    disk.let_go();
    wait_until(&mut bench, "leaving", |s| s.opened.is_none());
    assert!(file(&folder).contains("gain = 28.0"), "the later save is the later one");
    drop(bench);
    let again = studio(&folder);
    assert!(again.opened.as_ref().unwrap().session.text().contains("gain = 29.0"), "not saved, not lost");
    drop(again);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn the_end_of_the_studio_waits_for_a_save_under_way() {
    let (folder, disk, mut bench) = open_rig("slow-end");
    disk.hold();
    bench.state_mut().run(&gain(27.0));
    bench.state_mut().run(&Command::Save);
    let later = Arc::clone(&disk);
    let release = std::thread::spawn(move || {
        std::thread::sleep(Duration::from_millis(200));
        later.let_go();
    });
    drop(bench);
    release.join().unwrap();
    assert!(file(&folder).contains("gain = 27.0"));
    assert!(!studio(&folder).opened.as_ref().unwrap().session.is_changed());
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn the_project_stays_until_another_is_read_and_what_cannot_be_read_changes_nothing() {
    let (folder, other) = (rig("slow-open"), rig("slow-other"));
    let disk = Arc::new(HeldDisk::default());
    let mut bench = open_on(&disk, &folder);
    rest(&mut bench);
    bench.state_mut().run(&gain(27.0));
    rest(&mut bench);
    disk.hold();
    bench.state_mut().run(&Command::Open { path: other.clone() });
    bench.run_steps(FRAMES);
    assert!(bench.state().file_queue.path_being_opened().is_some() && bench.state().opened.is_some());
    disk.let_go();
    wait_until(&mut bench, "the other project", |s| s.file_queue.path_being_opened().is_none());
    assert_eq!(bench.state().opened.as_ref().unwrap().path, other.join("project.toml"));
    disk.hold();
    bench.state_mut().run(&Command::Open { path: folder.join("absent.toml") });
    bench.run_steps(1);
    assert!(says(&bench, "opening"));
    disk.let_go();
    wait_until(&mut bench, "the refusal", |s| s.open_error.is_some());
    assert_eq!(bench.state().opened.as_ref().unwrap().path, other.join("project.toml"));
    disk.hold();
    bench.state_mut().run(&Command::Open { path: folder.clone() });
    bench.run_steps(1);
    bench.key_press(Key::Escape);
    bench.run_steps(1);
    assert!(!bench.state().file_queue.is_busy(), "what is stopped is dropped");
    disk.let_go();
    std::thread::sleep(Duration::from_millis(200));
    bench.run_steps(FRAMES);
    assert_eq!(bench.state().opened.as_ref().unwrap().path, other.join("project.toml"));
    bench.state_mut().run(&Command::Open { path: folder.clone() });
    bench.state_mut().run(&gain(26.5));
    bench.state_mut().run(&Command::Save);
    wait_until(&mut bench, "both", |s| !s.file_queue.is_busy());
    assert!(file(&other).contains("gain = 26.5"), "what was asked to be saved is saved where it belongs");
    assert!(text(&bench).contains("gain = 27.0") && file(&folder).contains("gain = 25.0"), "edits came back");
    drop(bench);
    [folder, other].iter().for_each(|f: &PathBuf| std::fs::remove_dir_all(f).unwrap());
}

#[test]
fn a_step_back_behind_a_save_outlives_a_crash() {
    let (folder, _, mut bench) = open_rig("slow-undo");
    let before = text(&bench);
    bench.state_mut().run(&gain(27.0));
    bench.state_mut().run(&Command::Save);
    wait_until(&mut bench, "the save", |s| !s.file_queue.is_busy());
    bench.state_mut().run(&Command::Undo);
    wait_for_journal(&folder, "undo");
    common::crash(bench);
    let again = studio(&folder);
    assert_eq!(again.opened.as_ref().unwrap().session.text(), before);
    drop(again);
    std::fs::remove_dir_all(folder).unwrap();
}
