//! The time that a dragged weight takes, from the change to the drawn frame, without a renderer; and long recordings. Figures are printed
//! (`-- --nocapture`), for a loaded machine tells nothing.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::common;

use std::sync::Arc;
use std::time::{Duration, Instant};

use common::whole_rig;
use counterpoise_pipeline::preview::{PreviewCache, PreviewRequest};
use counterpoise_project::{Attachments, Project};
use counterpoise_studio::charts::chart::{Chart, ChartCurve, LineDash};
use counterpoise_studio::charts::chart_view::{ChartStyle, show_chart};
use counterpoise_studio::charts::curve_points::CurvePoints;
use counterpoise_studio::charts::min_max_pyramid::MinMaxPyramid;
use counterpoise_studio::command::Command;
use counterpoise_studio::editing::session::Session;
use counterpoise_studio::frame_log::FrameLog;
use counterpoise_studio::jobs::live_design::preview_timed;
use counterpoise_studio::offscreen::OffscreenStudio;
use counterpoise_studio::theme::DARK;

const TEXT: &str = include_str!("../../examples/reference-rig/project.toml");

fn gain(k: u32) -> Command {
    let value = 25.0 + 0.05 * f64::from(k);
    Command::Set { path: "synth.feedback.error.gain".to_owned(), value, gesture: Some(1) }
}

fn print_times(what: &str, mut ms: Vec<f64>) {
    ms.sort_by(f64::total_cmp);
    let at = |share: f64| ms[((ms.len() - 1) as f64 * share) as usize];
    eprintln!(
        "{what}: median {:.2} ms, 95 % {:.2} ms, 99 % {:.2} ms, largest {:.2} ms",
        at(0.5),
        at(0.95),
        at(0.99),
        at(1.0)
    );
}

#[test]
fn every_revision_of_a_drag_is_designed() {
    let mut session = Session::new(TEXT, "project.toml", Attachments::none());
    let mut cache = PreviewCache::default();
    let mut took: Vec<f64> = Vec::new();
    let workers =
        counterpoise_host::workers::ProgressPool::new(counterpoise_host::stages::ProgressDisplay::Quiet);
    for k in 0..60 {
        session.apply(&gain(4 * k)).unwrap();
        let project: Arc<Project> = Arc::clone(session.project().unwrap());
        let request = PreviewRequest { project, out_of_balance_kg_m: None };
        let made = preview_timed(&request, &mut cache, &workers).unwrap();
        assert!(made.design.unwrap().unwrap().margins.closed_loop_stable);
        took.push(made.took.as_secs_f64() * 1e3);
    }
    print_times("live road", took);
}

#[test]
fn every_change_of_a_replayed_drag_is_drawn_and_verified_when_it_ends() {
    let folder = whole_rig("drag");
    let begun = Instant::now();
    let mut first = OffscreenStudio::new(&folder.join("first"), [1280.0, 800.0]);
    first.studio.open(&folder);
    while first.studio.results.design.is_none() {
        first.draw_frame(Vec::new());
    }
    first.draw_frame(Vec::new());
    eprintln!("first picture {:.0} ms after the start", begun.elapsed().as_secs_f64() * 1e3);
    drop(first);
    let begun = Instant::now();
    let mut seat = OffscreenStudio::new(&folder.join("state"), [1280.0, 800.0]);
    seat.run_script(vec![Command::Open { path: folder.clone() }], &mut FrameLog::new(None));
    eprintln!("opened, designed, verified and drawn in {:.0} ms", begun.elapsed().as_secs_f64() * 1e3);
    let log = folder.join("frames.csv");
    let frames = seat.run_script((1..=120).map(gain).collect(), &mut FrameLog::new(Some(&log)));
    assert!(frames.len() >= 120, "every change is drawn: {}", frames.len());
    assert_eq!(std::fs::read_to_string(log).unwrap().lines().count(), frames.len() + 1);
    print_times("pipeline", frames.iter().skip(1).map(|f| f.pipeline_ms).collect());
    print_times("change to drawn", frames.iter().skip(1).map(|f| f.change_to_drawn_ms).collect());
    print_times("frame with triangles", frames.iter().skip(1).map(|f| f.frame_ms).collect());
    let of = seat.studio.results.verified.as_ref().unwrap();
    assert_eq!(of.revision, seat.studio.opened.as_ref().unwrap().session.revision());
    let let_go = Instant::now();
    seat.run_script(vec![gain(200)], &mut FrameLog::new(None));
    eprintln!("designed and verified {:.0} ms after the last change", let_go.elapsed().as_secs_f64() * 1e3);
    drop(seat);
    std::fs::remove_dir_all(folder).unwrap();
}

/// Ten minutes of eight channels at 1 kHz, panned and zoomed.
#[test]
fn long_recordings_are_panned_and_zoomed() {
    let begun = Instant::now();
    let channel = |c: u32| {
        let value = |k: u32| {
            (f64::from(k) * 0.003 * f64::from(c + 1)).sin() + 0.1 * f64::from(k * 2_654_435_761 % 97)
        };
        Arc::new(MinMaxPyramid::new((0..600_000_u32).map(|k| [f64::from(k) * 1e-3, value(k)]).collect()))
    };
    let channels: Vec<Arc<MinMaxPyramid>> = (0..8).map(channel).collect();
    eprintln!("eight pyramids built in {:.0} ms", begun.elapsed().as_secs_f64() * 1e3);
    let context = egui::Context::default();
    DARK.apply(&context);
    let (mut took, mut time) = (Vec::new(), 0.0);
    for frame in 0..200 {
        let at = egui::pos2(640.0 + (frame % 50) as f32, 300.0);
        let scroll = egui::vec2(if frame % 3 == 0 { 30.0 } else { 0.0 }, 0.0);
        let zoom = if frame < 100 { 1.05 } else { 0.96 };
        let input = egui::RawInput {
            screen_rect: Some(egui::Rect::from_min_size(egui::Pos2::ZERO, egui::vec2(1280.0, 800.0))),
            time: Some(time),
            events: vec![
                egui::Event::PointerMoved(at),
                egui::Event::Zoom(zoom),
                egui::Event::MouseWheel {
                    unit: egui::MouseWheelUnit::Point,
                    delta: scroll,
                    phase: egui::TouchPhase::Move,
                    source: egui::MouseWheelSource::Wheel,
                    modifiers: egui::Modifiers::NONE,
                },
            ],
            ..Default::default()
        };
        let begun = Instant::now();
        let output = context.run_ui(input, |ui| show_stacked_charts(ui, &channels));
        let drawn = context.tessellate(output.shapes, output.pixels_per_point);
        assert!(!drawn.is_empty());
        took.push(begun.elapsed().as_secs_f64() * 1e3);
        time += Duration::from_millis(16).as_secs_f64();
    }
    print_times("a frame of eight channels, 600 000 points each", took);
}

fn show_stacked_charts(ui: &mut egui::Ui, channels: &[Arc<MinMaxPyramid>]) {
    for (k, pyramid) in channels.iter().enumerate() {
        let mut chart = Chart::new(&format!("channel {k}"), "time, s", "value").with_group("recording");
        chart = chart.with_any_curve(ChartCurve {
            name: "measured".to_owned(),
            points: CurvePoints::Many(Arc::clone(pyramid), 1.0),
            colour: DARK.curves[k % 4],
            dash: LineDash::Solid,
        });
        let style = ChartStyle { theme: &DARK, scope: "", corner: None };
        show_chart(ui, &chart, style, egui::vec2(1260.0, 96.0));
    }
}
