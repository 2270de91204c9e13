//! Draws the manual's pictures of the studio without a graphics card: `cargo run --release -p counterpoise-studio --example manual_pictures -- docs/pictures`.
//!
//! With names behind the folder, only these pictures are drawn. That of a commissioning, which needs a compiler, is the test's; those of dragged tiles, of selected limits and of weights
//! without a controller were taken in a window.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "../tests/common/paint.rs"]
mod paint;

use std::path::{Path, PathBuf};

use counterpoise_studio::command::{
    BrowsePurpose, Command, DesignSlot, DesignTab, DiagnosisTab, Page, VerificationTab,
};
use counterpoise_studio::frame_log::FrameLog;
use counterpoise_studio::offscreen::OffscreenStudio;
use counterpoise_studio::study_inputs::StudyKind;
use paint::Painter;

/// Size of most pictures, and the foot of the window with its times, which is cut off.
const SIZE: [u32; 2] = [1280, 800];
const LARGE: [u32; 2] = [2560, 1440];
const FOOT: u32 = 30;
/// Time between the frames before a picture.
const FADING: std::time::Duration = std::time::Duration::from_millis(120);

/// Pictures of one project in one window, in their order.
struct Sitting {
    size: [u32; 2],
    project: Option<&'static str>,
    shots: Vec<(&'static str, Vec<Command>)>,
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let folder = PathBuf::from(arguments.next().expect("the folder of the pictures"));
    let names: Vec<String> = arguments.collect();
    let is_wanted = |name: &str| names.is_empty() || names.iter().any(|wanted| wanted == name);
    let folder = std::fs::canonicalize(folder).expect("the folder of the pictures exists");
    // the first screen shows where the studio was started
    let scratch = std::env::temp_dir().join("machines");
    std::fs::create_dir_all(&scratch).unwrap();
    std::env::set_current_dir(&scratch).unwrap();
    for sitting in sittings(&scratch) {
        if sitting.shots.iter().any(|shot| is_wanted(shot.0)) {
            draw(&sitting, &scratch, &folder, &is_wanted);
        }
    }
    let _ = std::fs::remove_dir_all(scratch);
}

fn draw(sitting: &Sitting, scratch: &Path, folder: &Path, is_wanted: &dyn Fn(&str) -> bool) {
    let state = scratch.join(".state");
    let _ = std::fs::remove_dir_all(&state);
    let mut seat = OffscreenStudio::new(&state, sitting.size.map(|v| v as f32));
    let (mut log, mut painter) = (FrameLog::new(None), Painter::default());
    if let Some(example) = sitting.project {
        copy_example(example, &scratch.join(example));
        seat.run_script(vec![Command::Open { path: scratch.join(example) }, Command::CloseHint], &mut log);
    }
    for (name, commands) in &sitting.shots {
        seat.run_script(commands.clone(), &mut log);
        if !name.ends_with("export") {
            seat.studio.view.notice = None;
        }
        let picture = painter.paint_window(&mut seat, sitting.size, FADING);
        let [width, height] = sitting.size;
        // where the code went stands in the foot
        let foot = if name.ends_with("export") { 0 } else { FOOT };
        let shown = image::imageops::crop_imm(&picture, 0, 0, width, height - foot).to_image();
        if is_wanted(name) {
            shown.save(folder.join(format!("{name}.png"))).unwrap();
            println!("{name}");
        }
    }
}

/// Copies an example, whose recordings the studio then opens beside it.
fn copy_example(example: &str, to: &Path) {
    let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples").join(example);
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap().flatten().filter(|entry| entry.path().is_file()) {
        std::fs::copy(entry.path(), to.join(entry.file_name())).unwrap();
    }
}

fn set(path: &str, value: f64) -> Command {
    Command::Set { path: path.to_owned(), value, gesture: None }
}

fn show_design(tab: DesignTab) -> Command {
    Command::ShowDesign { tab }
}

fn show_verification(tab: VerificationTab) -> Command {
    Command::ShowVerification { tab }
}

fn sittings(scratch: &Path) -> Vec<Sitting> {
    let gain = || set("synth.feedback.error.gain", 31.0);
    vec![
        Sitting { size: SIZE, project: Some("reference-rig"), shots: pages_of_the_rig() },
        Sitting { size: SIZE, project: Some("left-out-friction"), shots: recordings(scratch) },
        Sitting { size: SIZE, project: Some("servo-pendulum"), shots: studies() },
        Sitting { size: SIZE, project: None, shots: first_steps(scratch) },
        Sitting {
            size: LARGE,
            project: Some("reference-rig"),
            shots: vec![
                ("studio-design-2560", vec![Command::Keep { slot: DesignSlot::A }, gain()]),
                (
                    "studio-verify-light",
                    vec![
                        Command::ToggleTheme,
                        Command::Verify,
                        show_verification(VerificationTab::Histories),
                    ],
                ),
            ],
        },
    ]
}

fn pages_of_the_rig() -> Vec<(&'static str, Vec<Command>)> {
    let inserted = "colour = 3\n".to_owned();
    let wrong_key = Command::SpliceText { from: 0, to: 0, inserted, gesture: None };
    let name = "before the change".to_owned();
    let history = vec![
        Command::KeepDesign { name: name.clone() },
        set("synth.feedback.control.gain", 2.0),
        Command::OverlayDesign { name },
        show_design(DesignTab::History),
    ];
    vec![
        (
            "studio-design",
            vec![Command::Keep { slot: DesignSlot::A }, set("synth.feedback.error.gain", 31.0)],
        ),
        ("studio-loop", vec![show_design(DesignTab::Loop)]),
        ("studio-plant", vec![Command::Go { page: Page::Plant }]),
        ("studio-reduce", vec![Command::Go { page: Page::Reduce }]),
        ("studio-verify", vec![Command::Verify, show_verification(VerificationTab::Histories)]),
        ("studio-rejection", vec![show_verification(VerificationTab::Rejection)]),
        ("studio-analyser", vec![Command::Measure, show_verification(VerificationTab::Map)]),
        ("studio-robustness", vec![Command::Sweep, show_verification(VerificationTab::Robustness)]),
        ("studio-text", vec![set("plant.gearbox.backlash", -1e-3), wrong_key, Command::NextError]),
        (
            "studio-light",
            vec![
                Command::Undo,
                Command::Undo,
                Command::ToggleTheme,
                Command::Go { page: Page::Design },
                show_design(DesignTab::Consequences),
            ],
        ),
        ("studio-history", [vec![Command::ToggleTheme], history].concat()),
        ("studio-commands", vec![show_design(DesignTab::Consequences), Command::Palette]),
    ]
}

fn recordings(scratch: &Path) -> Vec<(&'static str, Vec<Command>)> {
    let recordings = ["steps.parquet", "triangle.parquet"];
    let paths = recordings.map(|name| scratch.join("left-out-friction").join(name)).into();
    let channels = Command::SetCrossPlot {
        x: "hub_rate".to_owned(),
        y: "control".to_owned(),
        window_s: Some([0.5, 6.5]),
    };
    vec![
        (
            "studio-x-y",
            vec![
                Command::Recordings { paths },
                channels,
                Command::ShowDiagnosis { tab: DiagnosisTab::CrossPlot },
            ],
        ),
        ("studio-spectra", vec![Command::ShowDiagnosis { tab: DiagnosisTab::Spectra }]),
        ("studio-diagnose", vec![Command::ShowDiagnosis { tab: DiagnosisTab::Errors }]),
        ("studio-findings", vec![Command::Diagnose, Command::ShowDiagnosis { tab: DiagnosisTab::Findings }]),
    ]
}

fn studies() -> Vec<(&'static str, Vec<Command>)> {
    vec![("studio-search", vec![Command::RunStudy { study: StudyKind::Search }])]
}

fn first_steps(scratch: &Path) -> Vec<(&'static str, Vec<Command>)> {
    let folder = scratch.join("turret");
    vec![
        ("guide-1-new", vec![]),
        ("studio-open", vec![Command::Browse { purpose: BrowsePurpose::Project }]),
        (
            "guide-2-plant",
            vec![Command::New { folder, like: None }, Command::CloseHint, Command::Go { page: Page::Plant }],
        ),
        (
            "guide-3-design",
            vec![
                Command::Go { page: Page::Design },
                Command::Keep { slot: DesignSlot::A },
                set("synth.feedback.error.gain", 31.0),
            ],
        ),
        ("guide-4-verify", vec![Command::Verify, Command::Go { page: Page::Verify }]),
        ("guide-5-export", vec![Command::Export]),
    ]
}
