//! Plots written as numbers, as a drawing or as pixels, for the clipboard or into a file.

use std::path::PathBuf;
use std::sync::Arc;

use counterpoise_host::files;

use crate::charts::chart::Chart;
use crate::charts::chart_figure::{chart_bitmap, chart_png, chart_svg};
use crate::charts::csv::chart_csv;

/// The format in which a plot is copied.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CopyFormat {
    /// Numbers.
    Csv,
    /// A drawing.
    Svg,
    /// Pixels.
    Png,
}

impl CopyFormat {
    /// Returns the format in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Csv => "numbers (CSV)",
            Self::Svg => "a drawing (SVG)",
            Self::Png => "pixels (PNG)",
        }
    }

    /// Returns the format of files with an ending, or `None` if there is none.
    pub fn with_ending(ending: &str) -> Option<Self> {
        match ending {
            "csv" => Some(Self::Csv),
            "svg" => Some(Self::Svg),
            "png" => Some(Self::Png),
            _ => None,
        }
    }
}

/// Destination of a plot.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum CopyTarget {
    /// Into the clipboard.
    Clipboard,
    /// Into a file.
    File(PathBuf),
}

/// Content for the clipboard.
#[derive(Debug, Clone, PartialEq)]
pub enum ClipboardContent {
    /// Numbers or a drawing.
    Text(String),
    /// Pixels.
    Pixels(Arc<egui::ColorImage>),
}

/// A plot to copy.
#[derive(Debug, Clone)]
pub struct CopyRequest {
    /// The plot.
    pub chart: Chart,
    /// The format.
    pub format: CopyFormat,
    /// Destination.
    pub target: CopyTarget,
}

/// Outcome of a copy of a plot.
#[derive(Debug, Clone)]
pub enum CopyOutcome {
    /// The content is ready for the clipboard.
    ForClipboard(ClipboardContent),
    /// The file was written.
    Written(PathBuf),
}

/// A plot that was copied.
#[derive(Debug, Clone)]
pub struct CopiedPlot {
    /// The format.
    pub format: CopyFormat,
    /// The title of the plot.
    pub title: String,
    /// Result, or why there is none.
    pub outcome: Result<CopyOutcome, String>,
}

/// Writes a plot.
pub fn copy_plot(request: CopyRequest) -> CopiedPlot {
    let CopyRequest { chart, format, target } = request;
    let outcome = match target {
        CopyTarget::Clipboard => clipboard_content(&chart, format).map(CopyOutcome::ForClipboard),
        CopyTarget::File(path) => file_content(&chart, format).and_then(|bytes| {
            files::write_file(&path, &bytes)
                .map_err(|error| format!("{} cannot be written: {error}", path.display()))?;
            Ok(CopyOutcome::Written(path))
        }),
    };
    CopiedPlot { format, title: chart.title, outcome }
}

fn clipboard_content(chart: &Chart, format: CopyFormat) -> Result<ClipboardContent, String> {
    match format {
        CopyFormat::Csv => Ok(ClipboardContent::Text(chart_csv(chart))),
        CopyFormat::Svg => Ok(ClipboardContent::Text(chart_svg(chart))),
        CopyFormat::Png => chart_bitmap(chart).map_err(|error| error.to_string()).map(|picture| {
            let size = [picture.width, picture.height];
            ClipboardContent::Pixels(Arc::new(egui::ColorImage::from_rgb(size, &picture.rgb)))
        }),
    }
}

fn file_content(chart: &Chart, format: CopyFormat) -> Result<Vec<u8>, String> {
    match format {
        CopyFormat::Csv => Ok(chart_csv(chart).into_bytes()),
        CopyFormat::Svg => Ok(chart_svg(chart).into_bytes()),
        CopyFormat::Png => chart_png(chart).map_err(|error| error.to_string()),
    }
}
