//! A studio without a window: the same frames, laid out and cut into triangles, but drawn nowhere.
//!
//! It carries out scripts on machines without a screen, and measures times without a renderer.

use counterpoise_host::clock::Moment;
use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

use crate::command::Command;
use crate::frame_log::{FrameLog, FrameTiming};
use crate::main_window;
use crate::script::Script;
use crate::studio::Studio;

/// Longest wait for a worker: a wake that came just before the wait began is not missed for longer.
const LONGEST_WAIT: Duration = Duration::from_millis(200);

/// A frame, cut into triangles.
pub struct TessellatedFrame {
    /// Shapes to be painted, in order.
    pub primitives: Vec<egui::ClippedPrimitive>,
    /// Changes of the textures that it is painted with.
    pub textures: egui::TexturesDelta,
}

/// A studio whose frames are laid out and drawn nowhere.
pub struct OffscreenStudio {
    /// The studio.
    pub studio: Studio,
    context: egui::Context,
    size: egui::Vec2,
    theme: Option<crate::theme::WindowTheme>,
    /// Changes of the textures in frames of scripts.
    pub textures: egui::TexturesDelta,
    woken: Receiver<()>,
    begun: Moment,
}

impl OffscreenStudio {
    /// Starts a studio that keeps its own files in `state`, in a window of the given size that is not shown.
    pub fn new(state: &Path, size: [f32; 2]) -> Self {
        let (wake, woken) = channel();
        let wake = std::sync::Mutex::new(wake);
        let wake = Arc::new(move || {
            if let Ok(wake) = wake.lock() {
                let _ = wake.send(());
            }
        });
        Self {
            studio: Studio::new(state, wake),
            context: egui::Context::default(),
            size: size.into(),
            theme: None,
            textures: egui::TexturesDelta::default(),
            woken,
            begun: Moment::now(),
        }
    }

    /// Lays out one frame with events.
    pub fn draw_frame(&mut self, events: Vec<egui::Event>) -> TessellatedFrame {
        self.studio.update();
        let input = egui::RawInput {
            screen_rect: Some(egui::Rect::from_min_size(egui::Pos2::ZERO, self.size)),
            time: Some(self.begun.elapsed().as_secs_f64()),
            events,
            ..Default::default()
        };
        let studio = &mut self.studio;
        if self.theme != Some(studio.view.theme) {
            studio.view.theme.apply(&self.context);
            self.theme = Some(studio.view.theme);
        }
        let output = self.context.run_ui(input, |ui| main_window::show(studio, ui));
        self.studio.update();
        let primitives = self.context.tessellate(output.shapes, output.pixels_per_point);
        TessellatedFrame { primitives, textures: output.textures_delta }
    }

    /// Waits until a worker has an answer or the studio has something to do by itself.
    pub fn wait_for_work(&self) {
        let _ = self.woken.recv_timeout(self.studio.next_wake_after().unwrap_or(LONGEST_WAIT));
    }

    /// Carries out commands one after the other, each drawn with its consequences before the next, and waits until nothing runs.
    /// Returns the time that the redrawn designs took.
    pub fn run_script(&mut self, commands: Vec<Command>, log: &mut FrameLog) -> Vec<FrameTiming> {
        let (mut script, mut timings) = (Script::new(commands), Vec::new());
        loop {
            let begun = Moment::now();
            let drawn = self.draw_frame(Vec::new());
            self.textures.append(drawn.textures);
            timings.extend(log.record_frame(&self.studio, begun));
            match script.next_command(&self.studio) {
                Some(command) => {
                    log.mark_change();
                    self.studio.run(&command);
                    self.studio.update();
                    continue;
                }
                None if script.is_done() && self.studio.is_idle() => return timings,
                None => {}
            }
            self.wait_for_work();
        }
    }
}
