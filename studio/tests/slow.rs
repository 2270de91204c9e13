//! A disk that takes its time: frames go on while a project is read or saved, and nothing is lost.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use common::{Bench, around, filed, rest, rig, says, studio, text, until};
use counterpoise_studio::command::Command;
use counterpoise_studio::files::Disk;
use counterpoise_studio::studio::Studio;
use egui::{Key, Modifiers};

const CTRL: Modifiers = Modifiers::COMMAND;
/// What a frame may take here, with its layout: far less than the disk takes.
const FRAME: Duration = Duration::from_millis(250);

/// A disk whose every read, and every wait for what was written, takes so many ms.
#[derive(Default)]
struct Slow(AtomicU64);

impl Slow {
    fn takes(&self, ms: u64) {
        self.0.store(ms, Ordering::Relaxed);
    }

    fn wait(&self) {
        std::thread::sleep(Duration::from_millis(self.0.load(Ordering::Relaxed)));
    }
}

impl Disk for Slow {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        self.wait();
        std::fs::read(path)
    }

    fn sync(&self, file: &File) -> io::Result<()> {
        self.wait();
        file.sync_all()
    }
}

fn on(disk: &Arc<Slow>, folder: &Path) -> Bench {
    let disk = Arc::clone(disk) as Arc<dyn Disk>;
    let mut studio = Studio::on(&folder.join("state"), Arc::new(|| {}), disk);
    studio.run(&Command::Open { path: folder.to_owned() });
    filed(&mut studio);
    around(studio)
}

fn gain(value: f64) -> Command {
    Command::Set { path: "synth.feedback.error.gain".to_owned(), value, gesture: None }
}

fn file(folder: &Path) -> String {
    std::fs::read_to_string(folder.join("project.toml")).unwrap()
}

/// Frames while something goes on: how many, and the longest.
fn frames(bench: &mut Bench, while_so: impl Fn(&Studio) -> bool) -> (usize, Duration) {
    let (mut count, mut longest) = (0, Duration::ZERO);
    while while_so(bench.state()) {
        let begun = Instant::now();
        bench.run_steps(1);
        longest = longest.max(begun.elapsed());
        count += 1;
        std::thread::sleep(Duration::from_millis(4));
    }
    (count, longest)
}

#[test]
fn frames_go_on_while_a_save_takes_two_seconds_and_what_is_edited_meanwhile_stays_unsaved() {
    let folder = rig("slow-save");
    let disk = Arc::new(Slow::default());
    let mut bench = on(&disk, &folder);
    rest(&mut bench);
    let before = file(&folder);
    bench.state_mut().run(&gain(27.0));
    rest(&mut bench);
    disk.takes(2000);
    let begun = Instant::now();
    bench.key_press_modifiers(CTRL, Key::S);
    bench.run_steps(2);
    assert!(says(&bench, "saving") && bench.state().filing.is_saving());
    bench.state_mut().run(&gain(28.0));
    let (count, longest) = frames(&mut bench, |s| s.filing.is_saving());
    eprintln!("a save of {:.1} s: {count} frames, the longest {longest:?}", begun.elapsed().as_secs_f64());
    assert!(begun.elapsed() > Duration::from_millis(1900) && count > 50 && longest < FRAME);
    assert!(says(&bench, "edited") && says(&bench, "saved "));
    assert!(file(&folder).contains("gain = 27.0") && text(&bench).contains("gain = 28.0"));
    assert_ne!(before, file(&folder));
    assert_eq!(bench.state().results.live.as_ref().unwrap().revision, 2, "the design went on, too");
    bench.state_mut().run(&gain(29.0));
    std::thread::sleep(Duration::from_millis(300));
    std::mem::forget(bench);
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
    let folder = rig("slow-order");
    let disk = Arc::new(Slow::default());
    let mut bench = on(&disk, &folder);
    rest(&mut bench);
    disk.takes(300);
    let begun = Instant::now();
    for value in [27.0, 28.0] {
        bench.state_mut().run(&gain(value));
        bench.state_mut().run(&Command::Save);
    }
    bench.state_mut().run(&Command::Close);
    bench.state_mut().run(&gain(29.0));
    bench.run_steps(2);
    assert!(bench.state().opened.is_some(), "the project stays until it is saved");
    until(&mut bench, "the first save", |_| file(&folder).contains("gain = 27.0"));
    until(&mut bench, "the second save", |_| file(&folder).contains("gain = 28.0"));
    until(&mut bench, "leaving", |s| s.opened.is_none());
    assert!(begun.elapsed() > Duration::from_millis(600));
    disk.takes(0);
    drop(bench);
    let again = studio(&folder);
    assert!(again.opened.as_ref().unwrap().session.text().contains("gain = 29.0"), "not saved, not lost");
    drop(again);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn the_end_of_the_studio_waits_for_a_save_under_way() {
    let folder = rig("slow-end");
    let disk = Arc::new(Slow::default());
    let mut bench = on(&disk, &folder);
    rest(&mut bench);
    disk.takes(400);
    bench.state_mut().run(&gain(27.0));
    bench.state_mut().run(&Command::Save);
    drop(bench);
    assert!(file(&folder).contains("gain = 27.0"));
    assert!(!studio(&folder).opened.as_ref().unwrap().session.is_changed());
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn the_project_stays_until_another_is_read_and_what_cannot_be_read_changes_nothing() {
    let (folder, other) = (rig("slow-open"), rig("slow-other"));
    let disk = Arc::new(Slow::default());
    let mut bench = on(&disk, &folder);
    rest(&mut bench);
    bench.state_mut().run(&gain(27.0));
    rest(&mut bench);
    disk.takes(500);
    bench.state_mut().run(&Command::Open { path: other.clone() });
    let (count, longest) = frames(&mut bench, |s| {
        assert!(s.opened.is_some());
        s.filing.opening().is_some()
    });
    eprintln!("{count} frames while a project was read, the longest {longest:?}");
    assert!(count > 20 && longest < FRAME);
    assert_eq!(bench.state().opened.as_ref().unwrap().path, other.join("project.toml"));
    bench.state_mut().run(&Command::Open { path: folder.join("absent.toml") });
    bench.run_steps(1);
    assert!(says(&bench, "opening"));
    until(&mut bench, "the refusal", |s| s.refused.is_some());
    assert_eq!(bench.state().opened.as_ref().unwrap().path, other.join("project.toml"));
    bench.state_mut().run(&Command::Open { path: folder.clone() });
    bench.run_steps(1);
    bench.key_press(Key::Escape);
    bench.run_steps(1);
    assert!(!bench.state().filing.is_busy(), "what is stopped is dropped");
    std::thread::sleep(Duration::from_millis(1200));
    bench.run_steps(2);
    assert_eq!(bench.state().opened.as_ref().unwrap().path, other.join("project.toml"));
    bench.state_mut().run(&Command::Open { path: folder.clone() });
    bench.state_mut().run(&gain(26.5));
    bench.state_mut().run(&Command::Save);
    until(&mut bench, "both", |s| !s.filing.is_busy());
    assert!(file(&other).contains("gain = 26.5"), "what was asked to be saved is saved where it belongs");
    assert!(text(&bench).contains("gain = 27.0") && file(&folder).contains("gain = 25.0"), "edits came back");
    disk.takes(0);
    drop(bench);
    [folder, other].iter().for_each(|f: &PathBuf| std::fs::remove_dir_all(f).unwrap());
}

#[test]
fn a_step_back_behind_a_save_outlives_a_crash() {
    let folder = rig("slow-undo");
    let disk = Arc::new(Slow::default());
    let mut bench = on(&disk, &folder);
    rest(&mut bench);
    let before = text(&bench);
    bench.state_mut().run(&gain(27.0));
    bench.state_mut().run(&Command::Save);
    until(&mut bench, "the save", |s| !s.filing.is_busy());
    bench.state_mut().run(&Command::Undo);
    std::thread::sleep(Duration::from_millis(300));
    std::mem::forget(bench);
    let again = studio(&folder);
    assert_eq!(again.opened.as_ref().unwrap().session.text(), before);
    drop(again);
    std::fs::remove_dir_all(folder).unwrap();
}
