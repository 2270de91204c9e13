//! Helpers that the tests of the window share.
#![allow(dead_code)]

use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use counterpoise_studio::command::Command;
use counterpoise_studio::main_window;
use counterpoise_studio::studio::Studio;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;

/// Says that a test is skipped, with the tool that is missing. The line goes past the capture of a test's output, so that `.ci/skips` sees it.
pub fn report_skip(reason: &str) {
    let _ = writeln!(std::io::stderr(), "skipped: {reason}");
}

/// A window with a studio.
pub type StudioHarness = Harness<'static, Studio>;

/// Lines of the reference rig that say how long its runs last, and those of short runs. What a window shows and does is the same for both.
const SHORT_RUNS: [(&str, &str); 4] = [
    ("duration = 10.0              # s of heave", "duration = 2.0               # s of heave"),
    ("settle = 2.0 ", "settle = 0.5 "),
    ("duration = 3.0\n", "duration = 1.0\n"),
    ("duration = 20.0\n", "duration = 3.0\n"),
];

/// Returns a copy of the reference rig, with runs as long as its file states, in a folder of its own.
pub fn whole_rig(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("counterpoise-studio-{name}-{}", std::process::id()));
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/reference-rig");
    for file in ["project.toml", "sandy-loam.parquet"] {
        std::fs::copy(example.join(file), folder.join(file)).unwrap();
    }
    folder
}

/// Returns a copy of the reference rig with short runs in a folder of its own.
pub fn rig(name: &str) -> PathBuf {
    let folder = whole_rig(name);
    let path = folder.join("project.toml");
    let short = SHORT_RUNS.iter().fold(std::fs::read_to_string(&path).unwrap(), |text, (from, to)| {
        assert_eq!(text.matches(from).count(), 1, "{from}");
        text.replace(from, to)
    });
    std::fs::write(path, short).unwrap();
    folder
}

/// Returns a studio with the project of a folder.
pub fn studio(folder: &Path) -> Studio {
    let mut studio = Studio::new(&folder.join("state"), Arc::new(|| {}));
    studio.run(&Command::Open { path: folder.to_owned() });
    wait_for_files(&mut studio);
    studio
}

/// Waits until everything is read and written that was to be.
pub fn wait_for_files(studio: &mut Studio) {
    let end = Instant::now() + Duration::from_secs(60);
    studio.update();
    while studio.file_queue.is_busy() {
        assert!(Instant::now() < end, "an errand does not end");
        std::thread::sleep(Duration::from_millis(1));
        studio.update();
    }
}

/// Returns a window with that studio.
pub fn bench(folder: &Path) -> StudioHarness {
    open_window(studio(folder))
}

/// Returns a window around a studio.
pub fn open_window(studio: Studio) -> StudioHarness {
    let show = |ui: &mut egui::Ui, studio: &mut Studio| {
        studio.update();
        main_window::show(studio, ui);
        studio.update();
    };
    let bench = Harness::builder().with_size([1280.0, 800.0]).build_ui_state(show, studio);
    let theme = bench.state().view.theme;
    theme.apply(&bench.ctx);
    bench
}

/// A disk that can be full: then nothing that is written is kept.
#[derive(Default)]
pub struct FullDisk {
    pub is_full: std::sync::atomic::AtomicBool,
}

impl FullDisk {
    pub fn set_full(&self, is_full: bool) {
        self.is_full.store(is_full, std::sync::atomic::Ordering::SeqCst);
    }
}

impl counterpoise_host::files::Disk for FullDisk {
    fn sync(&self, file: &std::fs::File) -> std::io::Result<()> {
        const NO_SPACE: i32 = 28;
        match self.is_full.load(std::sync::atomic::Ordering::SeqCst) {
            true => Err(std::io::Error::from_raw_os_error(NO_SPACE)),
            false => file.sync_all(),
        }
    }
}

/// Returns a window with the project of a folder on a disk.
pub fn bench_on(disk: &Arc<FullDisk>, folder: &Path) -> StudioHarness {
    let disk = Arc::clone(disk) as Arc<dyn counterpoise_host::files::Disk>;
    let mut studio = Studio::with_disk(&folder.join("state"), Arc::new(|| {}), disk);
    studio.run(&Command::Open { path: folder.to_owned() });
    wait_for_files(&mut studio);
    open_window(studio)
}

/// Ends a studio as a crash does: nothing is closed, and the operating system releases the lock on the project.
pub fn crash(mut bench: StudioHarness) {
    bench.state_mut().opened.as_mut().unwrap().lock = None;
    std::mem::forget(bench);
}

/// Waits until nothing runs.
pub fn settle(studio: &mut Studio) {
    let end = Instant::now() + Duration::from_secs(240);
    studio.update();
    while !studio.is_idle() {
        assert!(Instant::now() < end, "the studio does not come to rest");
        std::thread::sleep(Duration::from_millis(2));
        studio.update();
    }
}

/// A frame, and what follows from it.
pub fn rest(bench: &mut StudioHarness) {
    bench.run_steps(2);
    settle(bench.state_mut());
    bench.run_steps(2);
}

/// Frames until something is so.
pub fn wait_until(bench: &mut StudioHarness, what: &str, so: impl Fn(&Studio) -> bool) {
    let end = Instant::now() + Duration::from_secs(60);
    bench.run_steps(1);
    while !so(bench.state()) {
        assert!(Instant::now() < end, "waited for {what} in vain: {:?}", bench.state().view.notice);
        std::thread::sleep(Duration::from_millis(5));
        bench.run_steps(1);
    }
}

/// Returns the project's text.
pub fn text(bench: &StudioHarness) -> String {
    bench.state().opened.as_ref().unwrap().session.text().to_owned()
}

/// Returns whether something in the window says this.
pub fn says(bench: &StudioHarness, what: &str) -> bool {
    bench.query_all_by_label_contains(what).next().is_some()
}
