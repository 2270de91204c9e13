//! A session without a window: the same studio and the same frames, laid out and cut into triangles, but drawn nowhere.
//!
//! For logs of commands on machines without a screen, and for timing without a renderer.

use std::io::Write;
use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use crate::command::Command;
use crate::shell;
use crate::studio::Studio;

/// What one redrawn design took, in ms.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// Revision of the project that is shown.
    pub revision: u64,
    /// The road from weights to responses.
    pub pipeline_ms: f64,
    /// From the change to the end of the frame that shows it.
    pub change_to_drawn_ms: f64,
    /// That frame alone: layout and triangles.
    pub frame_ms: f64,
}

/// Where frames are noted as CSV.
pub struct FrameLog {
    file: Option<std::fs::File>,
    drawn: Option<u64>,
    changed: Instant,
}

impl FrameLog {
    /// A log in a file; nowhere without one, or where it cannot be made.
    pub fn new(path: Option<&Path>) -> Self {
        let mut file = path.and_then(|path| std::fs::File::create(path).ok());
        if let Some(file) = &mut file {
            let _ = writeln!(file, "revision,pipeline_ms,change_to_drawn_ms,frame_ms");
        }
        Self { file, drawn: None, changed: Instant::now() }
    }

    /// Notes that the project is changed now.
    pub fn changes(&mut self) {
        self.changed = Instant::now();
    }

    /// Notes a frame that began at a time and has just ended, where it shows another design than the one before.
    pub fn frame(&mut self, studio: &Studio, begun: Instant) -> Option<Frame> {
        let of = studio.results.live.as_ref().filter(|of| self.drawn != Some(of.revision))?;
        self.drawn = Some(of.revision);
        let ms = |d: Duration| d.as_secs_f64() * 1e3;
        let frame = Frame {
            revision: of.revision,
            pipeline_ms: ms(of.value.took),
            change_to_drawn_ms: ms(self.changed.elapsed()),
            frame_ms: ms(begun.elapsed()),
        };
        if let Some(file) = &mut self.file {
            let Frame { revision, pipeline_ms, change_to_drawn_ms, frame_ms } = frame;
            let _ = writeln!(file, "{revision},{pipeline_ms:.2},{change_to_drawn_ms:.2},{frame_ms:.2}");
        }
        Some(frame)
    }
}

/// A script of commands: the next one when the one before has had its consequences.
pub struct Script(std::vec::IntoIter<Command>);

impl Script {
    /// A script.
    pub fn new(commands: Vec<Command>) -> Self {
        Self(commands.into_iter())
    }

    /// Whether nothing is left to do.
    pub fn is_done(&self) -> bool {
        self.0.len() == 0
    }

    /// The next command, where the studio is ready for it.
    pub fn next(&mut self, studio: &Studio) -> Option<Command> {
        if studio.filing.is_busy() {
            return None;
        }
        let drawn = studio.results.live.as_ref().map(|of| of.revision);
        let now = studio.opened.as_ref().map(|o| o.session.revision());
        let busy = studio.results.designing || (drawn != now && studio.results.no_design.is_none());
        let early = self.0.as_slice().first().is_some_and(needs_rest) && !studio.is_idle();
        if (busy || early) && now.is_some() { None } else { self.0.next() }
    }
}

/// Whether a command can only be carried out on what has been verified or diagnosed.
fn needs_rest(command: &Command) -> bool {
    matches!(command, Command::Sweep | Command::Export | Command::ExportTo { .. } | Command::Accept)
}

/// A frame, cut into triangles.
pub struct Drawn {
    /// What is to be painted, in order.
    pub primitives: Vec<egui::ClippedPrimitive>,
    /// Changes of the textures that it is painted with.
    pub textures: egui::TexturesDelta,
}

/// A studio whose frames are laid out and nowhere drawn.
pub struct Offscreen {
    /// The studio.
    pub studio: Studio,
    context: egui::Context,
    size: egui::Vec2,
    themed: Option<crate::theme::Theme>,
    /// Changes of the textures in frames that were only played.
    pub textures: egui::TexturesDelta,
    woken: Receiver<()>,
    begun: Instant,
}

impl Offscreen {
    /// A studio that keeps its own files in `state`, in a window of a size that nobody sees.
    pub fn new(state: &Path, size: [f32; 2]) -> Self {
        let (wake, woken) = channel();
        let wake = std::sync::Mutex::new(wake);
        let wake = Arc::new(move || {
            if let Ok(wake) = wake.lock() {
                let _ = wake.send(());
            }
        });
        let studio = Studio::new(state, wake);
        let context = egui::Context::default();
        Self {
            studio,
            context,
            size: size.into(),
            themed: None,
            textures: egui::TexturesDelta::default(),
            woken,
            begun: Instant::now(),
        }
    }

    /// One frame with events.
    pub fn frame(&mut self, events: Vec<egui::Event>) -> Drawn {
        self.studio.tick();
        let input = egui::RawInput {
            screen_rect: Some(egui::Rect::from_min_size(egui::Pos2::ZERO, self.size)),
            time: Some(self.begun.elapsed().as_secs_f64()),
            events,
            ..Default::default()
        };
        let studio = &mut self.studio;
        if self.themed != Some(studio.view.theme) {
            studio.view.theme.apply(&self.context);
            self.themed = Some(studio.view.theme);
        }
        let output = self.context.run_ui(input, |ui| shell::show(studio, ui));
        self.studio.tick();
        let primitives = self.context.tessellate(output.shapes, output.pixels_per_point);
        Drawn { primitives, textures: output.textures_delta }
    }

    /// Waits until a worker has an answer or the studio has something to do by itself.
    pub fn wait(&self) {
        let _ = self.woken.recv_timeout(self.studio.wakes_after());
    }

    /// Carries out commands one after the other, each drawn with its consequences before the next; then comes to rest. Gives what
    /// the redrawn designs took.
    pub fn play(&mut self, commands: Vec<Command>, log: &mut FrameLog) -> Vec<Frame> {
        let (mut script, mut frames) = (Script::new(commands), Vec::new());
        loop {
            let begun = Instant::now();
            let drawn = self.frame(Vec::new());
            self.textures.append(drawn.textures);
            frames.extend(log.frame(&self.studio, begun));
            match script.next(&self.studio) {
                Some(command) => {
                    log.changes();
                    self.studio.run(&command);
                    self.studio.tick();
                    continue;
                }
                None if script.is_done() && self.studio.is_idle() => return frames,
                None => {}
            }
            self.wait();
        }
    }
}
