//! The time that redrawn designs take, as CSV.

use counterpoise_host::clock::Moment;
use std::io::Write;
use std::path::Path;
use std::time::Duration;

use counterpoise_host::files::create_log;

use crate::studio::Studio;

/// The time that one redrawn design took, ms.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameTiming {
    /// Revision of the project that is shown.
    pub revision: u64,
    /// From the weights to the responses.
    pub pipeline_ms: f64,
    /// From the change to the end of the frame that shows it.
    pub change_to_drawn_ms: f64,
    /// Time of this frame alone: layout and triangles.
    pub frame_ms: f64,
}

/// A log of frames.
pub struct FrameLog {
    file: Option<Box<dyn Write>>,
    drawn: Option<u64>,
    changed: Moment,
}

impl FrameLog {
    /// Starts a log in a file; without a path, or if the file cannot be made, nothing is written.
    pub fn new(path: Option<&Path>) -> Self {
        let mut file = path.and_then(|path| create_log(path).ok());
        if let Some(file) = &mut file {
            let _ = writeln!(file, "revision,pipeline_ms,change_to_drawn_ms,frame_ms");
        }
        Self { file, drawn: None, changed: Moment::now() }
    }

    /// Records that the project is changed now.
    pub fn mark_change(&mut self) {
        self.changed = Moment::now();
    }

    /// Records a frame that began at a time and has just ended; returns its timing if it shows another design than the one before.
    pub fn record_frame(&mut self, studio: &Studio, begun: Moment) -> Option<FrameTiming> {
        let of = studio.results.design.as_ref().filter(|of| self.drawn != Some(of.revision))?;
        self.drawn = Some(of.revision);
        let ms = |d: Duration| d.as_secs_f64() * 1e3;
        let timing = FrameTiming {
            revision: of.revision,
            pipeline_ms: ms(studio.results.design_time),
            change_to_drawn_ms: ms(self.changed.elapsed()),
            frame_ms: ms(begun.elapsed()),
        };
        if let Some(file) = &mut self.file {
            let FrameTiming { revision, pipeline_ms, change_to_drawn_ms, frame_ms } = timing;
            let _ = writeln!(file, "{revision},{pipeline_ms:.2},{change_to_drawn_ms:.2},{frame_ms:.2}");
        }
        Some(timing)
    }
}
