//! Why a figure cannot be written.

/// Why a bitmap of a figure cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum PlotError {
    /// Plotters refused the drawing.
    #[error("the figure cannot be drawn: {0}")]
    Drawing(String),
    /// The picture could not be packed as PNG.
    #[error("the picture cannot be packed as PNG: {0}")]
    Encoding(#[from] png::EncodingError),
}
