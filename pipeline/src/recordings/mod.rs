//! From recordings of a machine to a better model: the one way that command line, studio and the package for Python all take.
//!
//! [`project_replayer`] leads from files to replays: [`read`](mod@read) reads them as the project maps their columns, and
//! [`replay`](mod@replay) simulates what was recorded;
//! [`diagnose`](mod@diagnose) finds what the model lacks; [`identify`](mod@identify) measures by triangle waves. Files are handed
//! in as names and bytes.
//!
//! Modules in reading order: [`read`](mod@read), [`replay`](mod@replay), [`project_replayer`], [`diagnose`](mod@diagnose), [`identify`](mod@identify),
//! [`experiment`] (the next one, which separates what a diagnosis leaves), [`held_out_recordings`] (recordings that no diagnosis was given, before and after),
//! [`channel_words`](mod@channel_words) (what a machine's channels are called), [`tracks`] (channels as measured and as simulated), [`amplitude_density`] (their spectra), [`residuals`] (what the models leave unexplained), [`redesign`] (what an improved model means for the design),
//! [`converter_range`] (readings that cannot be), [`controller_origin`] (which export the recordings' controller comes from),
//! [`column_remarks`] (what was found about columns), [`structure_hypotheses`] and [`measured_modes`] (what a structure's model lacks, from its measured natural frequencies).

pub mod amplitude_density;
pub mod channel_words;
pub mod column_remarks;
pub mod controller_origin;
pub mod converter_range;
pub mod diagnose;
pub mod experiment;
pub mod held_out_recordings;
pub mod identify;
pub mod measured_modes;
pub mod project_replayer;
pub mod read;
pub mod redesign;
pub mod replay;
pub mod residuals;
pub mod structure_hypotheses;
pub mod tracks;

pub use channel_words::{ChannelWords, channel_label, channel_words};
pub use column_remarks::{ColumnRemark, UnusedColumn};
pub use diagnose::{DiagnosedRecordings, diagnose};
pub use held_out_recordings::{HeldOutRecording, replay_held_out};
pub use identify::{AxisUnits, identify};
pub use project_replayer::{ProjectReplayer, ReplayControl, ReplaySettings, replay_improved};
pub use read::{GapTreatment, ReadRecording, RecordingFile, read_files};
pub use replay::{ReplayLength, ReplayedRecording, replay};
