//! The tab X-Y: one channel of a recording against another, over a window whose ends are dragged or moved by keys.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::common;

use std::path::{Path, PathBuf};

use common::{StudioHarness, bench, rest, says};
use counterpoise_studio::command::{Command, DiagnosisTab};
use egui::Key;
use egui_kittest::kittest::Queryable;

/// Returns a copy of the example whose recordings show friction that the model lacks.
pub fn friction_example(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("counterpoise-cross-{name}-{}", std::process::id()));
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/left-out-friction");
    for file in ["project.toml", "steps.parquet", "triangle.parquet"] {
        std::fs::copy(example.join(file), folder.join(file)).unwrap();
    }
    folder
}

fn measured_points(bench: &StudioHarness) -> usize {
    bench.state().view.cross_plot.paths.as_ref().unwrap().measured.len()
}

#[test]
fn channels_are_drawn_against_each_other_in_a_window() {
    let folder = friction_example("window");
    let mut bench = bench(&folder);
    rest(&mut bench);
    bench.state_mut().run(&Command::Recordings { paths: vec![folder.join("triangle.parquet")] });
    bench.state_mut().run(&Command::ShowDiagnosis { tab: DiagnosisTab::CrossPlot });
    rest(&mut bench);
    assert!(says(&bench, "plot: control against hub rate"));
    assert!(bench.state().view.cross_plot.paths.as_ref().unwrap().model.is_some(), "the model is beside it");
    let whole = measured_points(&bench);
    let at = bench.get_by_label("end of the window").rect().center();
    bench.drag_at(at);
    bench.run_steps(1);
    for k in 1..=10 {
        bench.hover_at(at - egui::vec2(40.0 * k as f32, 0.0));
        bench.run_steps(1);
    }
    bench.drop_at(at - egui::vec2(400.0, 0.0));
    rest(&mut bench);
    let window = bench.state().view.cross_plot.window_s.unwrap();
    assert!(window[0] < window[1] && measured_points(&bench) < whole, "{window:?}");
    bench.get_by_label("start of the window").focus();
    bench.run_steps(1);
    bench.key_press(Key::ArrowRight);
    rest(&mut bench);
    assert!(bench.state().view.cross_plot.window_s.unwrap()[0] > window[0], "an arrow key moves the start");
    bench.get_by_label("Swap").click();
    rest(&mut bench);
    assert!(says(&bench, "plot: hub rate against control"));
    bench.get_by_label("Whole recording").click();
    rest(&mut bench);
    assert_eq!(bench.state().view.cross_plot.window_s, None);
    drop(bench);
    std::fs::remove_dir_all(folder).unwrap();
}
