//! A log of commands, and what the window then looks like: painted without a graphics card, compared with `tests/pictures/*.png`.
//! `UPDATE_PICTURES=1 cargo test` takes them again.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::common;
#[path = "common/paint.rs"]
mod paint;

use std::path::Path;
use std::time::Duration;

use crate::commissioning::commissioned_folder;
use crate::cross_plot::friction_example;
use common::whole_rig;
use counterpoise_studio::command::{Command, DesignSlot, DesignTab, DiagnosisTab, Page, VerificationTab};
use counterpoise_studio::frame_log::FrameLog;
use counterpoise_studio::offscreen::OffscreenStudio;
use image::RgbaImage;
use paint::Painter;

const SIZE: [u32; 2] = [1280, 800];
/// The foot of the window, where times stand that differ from run to run.
const FOOT: u32 = 30;
/// Two colours that differ by this much are two.
const TOLD_APART: u8 = 40;
/// Share of pixels that may differ.
const ALLOWED: f64 = 0.004;

fn is_same(a: &RgbaImage, b: &RgbaImage) -> bool {
    if a.dimensions() != b.dimensions() {
        return false;
    }
    let differs = |(p, q): &(&image::Rgba<u8>, &image::Rgba<u8>)| {
        p.0.iter().zip(&q.0).any(|(x, y)| x.abs_diff(*y) > TOLD_APART)
    };
    let count = a.pixels().zip(b.pixels()).filter(differs).count();
    let share = count as f64 / f64::from(a.width() * a.height());
    if share > ALLOWED {
        eprintln!("{:.2} % of the pixels differ", 100.0 * share);
    }
    share <= ALLOWED
}

fn compare(name: &str, picture: &RgbaImage) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/pictures");
    let path = folder.join(format!("{name}.png"));
    if std::env::var_os("UPDATE_PICTURES").is_some() {
        std::fs::create_dir_all(&folder).unwrap();
        return picture.save(path).unwrap();
    }
    let before = image::open(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display())).to_rgba8();
    if !is_same(&before, picture) {
        let new = std::env::temp_dir().join(format!("counterpoise-{name}.png"));
        picture.save(&new).unwrap();
        panic!("{name} looks different: see {}; UPDATE_PICTURES=1 keeps the new look", new.display());
    }
}

#[test]
fn the_rounds_of_a_commissioning_look_as_they_did() {
    let folder = commissioned_folder("round-pictures");
    let mut seat = OffscreenStudio::new(&folder.join("state"), SIZE.map(|v| v as f32));
    let (mut log, mut painter) = (FrameLog::new(None), Painter::default());
    let commands = vec![Command::Open { path: folder.clone() }, Command::Go { page: Page::Commission }];
    take_picture("commission", commands, &mut seat, &mut log, &mut painter);
    drop(seat);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_channel_against_another_looks_as_it_did() {
    let folder = friction_example("picture");
    let mut seat = OffscreenStudio::new(&folder.join("state"), SIZE.map(|v| v as f32));
    let (mut log, mut painter) = (FrameLog::new(None), Painter::default());
    let channels = Command::SetCrossPlot {
        x: "hub_rate".to_owned(),
        y: "control".to_owned(),
        window_s: Some([0.5, 6.5]),
    };
    let commands = vec![
        Command::Open { path: folder.clone() },
        Command::Recordings { paths: vec![folder.join("triangle.parquet")] },
        channels,
        Command::ShowDiagnosis { tab: DiagnosisTab::CrossPlot },
    ];
    take_picture("cross-plot", commands, &mut seat, &mut log, &mut painter);
    drop(seat);
    std::fs::remove_dir_all(folder).unwrap();
}

/// Runs commands, and compares what the window then looks like.
fn take_picture(
    name: &str,
    commands: Vec<Command>,
    seat: &mut OffscreenStudio,
    log: &mut FrameLog,
    painter: &mut Painter,
) {
    seat.run_script(commands, log);
    seat.studio.view.notice = None;
    let mut picture = painter.paint_window(seat, SIZE, Duration::ZERO);
    for y in SIZE[1] - FOOT..SIZE[1] {
        (0..SIZE[0]).for_each(|x| picture.put_pixel(x, y, image::Rgba([0, 0, 0, 255])));
    }
    if name != "welcome" {
        compare(name, &picture);
    }
}

#[test]
fn each_page_looks_as_it_did() {
    let folder = whole_rig("pictures");
    let mut seat = OffscreenStudio::new(&folder.join("state"), SIZE.map(|v| v as f32));
    let (mut log, mut painter) = (FrameLog::new(None), Painter::default());
    let gain = Command::Set { path: "synth.feedback.error.gain".to_owned(), value: 31.0, gesture: Some(1) };
    let backlash = Command::Set { path: "plant.gearbox.backlash".to_owned(), value: -1e-3, gesture: None };
    let inserted = "colour = 3\n".to_owned();
    let wrong_key = Command::SpliceText { from: 0, to: 0, inserted, gesture: None };
    let consequences = Command::ShowDesign { tab: DesignTab::Consequences };
    let name = "before the change".to_owned();
    let history = vec![
        Command::Help,
        Command::KeepDesign { name: name.clone() },
        Command::Set { path: "synth.feedback.control.gain".to_owned(), value: 2.0, gesture: None },
        Command::OverlayDesign { name },
        Command::ShowDesign { tab: DesignTab::History },
    ];
    let first = vec![Command::Open { path: folder.clone() }];
    let shots: Vec<(&str, Vec<Command>)> = vec![
        ("design", [first, vec![Command::Keep { slot: DesignSlot::A }, gain]].concat()),
        ("loop", vec![Command::ShowDesign { tab: DesignTab::Loop }]),
        ("plant", vec![Command::Go { page: Page::Plant }]),
        ("reduce", vec![Command::Go { page: Page::Reduce }]),
        ("verify", vec![Command::ShowVerification { tab: VerificationTab::Histories }]),
        ("rejection", vec![Command::ShowVerification { tab: VerificationTab::Rejection }]),
        ("diagnose", vec![Command::Go { page: Page::Diagnose }]),
        ("text", vec![backlash, wrong_key, Command::NextError]),
        ("light", vec![Command::Undo, Command::Undo, Command::ToggleTheme, consequences]),
        ("help", vec![Command::ToggleTheme, Command::Help]),
        ("history", history),
        ("welcome", vec![Command::Close]),
    ];
    for (name, commands) in shots {
        take_picture(name, commands, &mut seat, &mut log, &mut painter);
    }
    drop(seat);
    std::fs::remove_dir_all(folder).unwrap();
}
