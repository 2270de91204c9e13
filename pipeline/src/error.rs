//! Why the pipeline can end without a result.

use counterpoise_synth::DesignFinding;

use crate::axes_problem::AxesProblem;
use crate::recordings::{ColumnRemark, UnusedColumn};

/// Every reason for which a stage of the pipeline has no result. The text of an error names what is wrong; what was found beside it (findings of
/// a design, remarks about columns) is data that the crate `report` puts into words.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PipelineError {
    /// A section of the project that a step needs.
    #[error("the project has no [{section}] section; {needed_by} needs it")]
    Missing {
        /// The section.
        section: &'static str,
        /// The step.
        needed_by: &'static str,
    },
    /// Two axes on a road whose sideways motion is not known.
    #[error(
        "verify.road: the road of ISO 8608 states what an elevation axis that points forward feels, which is not enough under a traverse axis: give \
         kind = \"six-axes\", \"sea\" or \"inertial-unit\", or a recording of heave, pitch and surge"
    )]
    PlaneRoad,
    /// A road on a ring at another angle than the traverse axis.
    #[error(
        "verify.road.traverse_angle and traverse_rate must be {ring_rad} rad and 0 rad/s: the ring stands where [model] hub_angle of the traverse axis says, \
         and its axis turns it; the road has {road_rad} rad"
    )]
    RingAngle {
        /// Of the road.
        road_rad: f64,
        /// Of the traverse axis.
        ring_rad: f64,
    },
    /// A motion of the base in a plane under a ring that points out of this plane.
    #[error(
        "[model] hub_angle of the traverse axis must be 0 rad: the base's motion is heave, pitch and surge alone, which belong to a ring that points forward; \
         the ring stands at {ring_rad} rad. For another angle take a road of kind \"inertial-unit\", \"six-axes\" or \"sea\""
    )]
    PlaneMotion {
        /// Angle of the ring, rad.
        ring_rad: f64,
    },
    /// A campaign on a project that says nothing of what varies.
    #[error(
        "nothing varies from mechanism to mechanism: give a value of [plant] a tolerance, for example {{ value = 2.0, tolerance = 0.1 }}, or list what varies as [[sweep.variation]]"
    )]
    NothingVaries,
    /// A key that needs a controller which sees the error alone.
    #[error("synth.{key} needs reference = \"error\": the controller must see demand less rate alone")]
    NeedsError {
        /// The key.
        key: &'static str,
    },
    /// A plan of an experiment for a single machine.
    #[error(
        "the findings leave one machine, so that there is nothing to separate: give the JSON result of a diagnosis that is ambiguous, \
         incomplete or unknown, or none, for the effects that machines most often lack"
    )]
    NothingToSeparate,
    /// A plan of an experiment whose limits no demand keeps.
    #[error(
        "no demand in the menu keeps the limits: with each of them one of the remaining machines moves farther or faster than allowed, takes a larger \
         current, or cannot be simulated; raise --angle, --rate or --current"
    )]
    NoExperiment,
    /// A feedback of fixed structure whose parameters have not been tuned.
    #[error(
        "a parameter of [[synth.block]] has no value: `counterpoise synth PROJECT --save FILE` tunes the open parameters and writes \
         their values into the file"
    )]
    NotTuned,
    /// A front without a design.
    #[error(
        "no design of any kind has a stable loop within the limits of the front: largest |S| {ms}, largest |T| {mt}, slowest decay {decay_rad_s:.3} rad/s, and those \
         that [synth.front] states besides{}; raise the limits, state a lower `decay`, or raise `evaluations`",
        first_reason(.why)
    )]
    NoFront {
        /// Limit of |S|.
        ms: f64,
        /// Limit of |T|.
        mt: f64,
        /// Limit of the decay, rad/s.
        decay_rad_s: f64,
        /// Why the first kind without a search could not be searched.
        why: Option<Box<counterpoise_synth::Error>>,
    },
    /// A controller whose file was not handed in.
    #[error("the file \"{file}\" of [synth.controller] was not read")]
    ControllerNotRead {
        /// Name of the file.
        file: String,
    },
    /// A controller that does not hold the loop, every reason.
    #[error("the controller in \"{file}\" does not hold the loop")]
    ControllerUnstable {
        /// Name of the file.
        file: String,
        /// Findings.
        findings: Vec<DesignFinding>,
    },
    /// A controller in sampled time that oscillates at half the sample rate.
    #[error(
        "\"{file}\": the controller has a pole at z = -1, which no continuous system becomes under the bilinear map; it rings at half the sample \
         rate (a derivative by the bilinear map does so): give the derivative a lag, or the controller in continuous time"
    )]
    ControllerPole {
        /// Name of the file.
        file: String,
    },
    /// A configuration that the project does not have.
    #[error("there is no configuration \"{name}\"; the project has: {known}")]
    Configuration {
        /// Requested name.
        name: String,
        /// The names that exist.
        known: String,
    },
    /// A run that would take more memory than any usual machine has to spare.
    #[error(
        "{key} = {duration_s} s at a sample period of {period_s} s is a run of {samples:.3e} samples, about {gigabytes:.0} GB of memory \
         and {minutes:.0} min of time: at this period at most {most_s} s are run; shorten it, or raise \
         plant.interface.sample_period"
    )]
    TooLong {
        /// The key that gives the duration.
        key: String,
        /// The duration, s.
        duration_s: f64,
        /// The sample period, s.
        period_s: f64,
        /// Samples of the run.
        samples: f64,
        /// Estimated memory, GB.
        gigabytes: f64,
        /// Estimated time, minutes.
        minutes: f64,
        /// Longest run at this period, s.
        most_s: f64,
    },
    /// More modes were measured than the model has.
    #[error("{measured} modes were measured, the finite elements have {modes}: raise model.elements")]
    FewModes {
        /// Flexible modes of the model.
        modes: usize,
        /// Measured modes.
        measured: usize,
    },
    /// A control range in which the mechanism cannot be held against gravity.
    #[error(
        "the out-of-balance of {moment_kg_m:.2} kg m takes {:.2} times what the drive's limit gives to hold ({needed_v:.3} V of control, which ends at {limit_v} V): \
         balance the mechanism, carry its weight with [plant.equilibrator], state a larger `limit` of [plant.drive], or put a gear before it \
         (with [plant.amplifier] raise its input_limit or gain)",
        needed_v / limit_v
    )]
    CannotHold {
        /// The out-of-balance, kg m.
        moment_kg_m: f64,
        /// The control that holds it, V.
        needed_v: f64,
        /// The limit, V.
        limit_v: f64,
    },
    /// A weight that the drive cannot carry at any control.
    #[error(
        "the out-of-balance of {moment_kg_m:.2} kg m takes {needed_nm:.4} N m to hold, and the drive gives at most {largest_nm:.4} N m: \
         raise `limit` of [plant.drive] (of a cylinder supply_pressure, area or lever), put a gear before the load, or carry the weight with \
         [plant.equilibrator]"
    )]
    CannotCarry {
        /// The out-of-balance, kg m.
        moment_kg_m: f64,
        /// The torque that holds it, N m.
        needed_nm: f64,
        /// The largest torque of the drive, N m.
        largest_nm: f64,
    },
    /// A reduction that the chosen structure does not allow.
    #[error("reduction by {method}: {problem}")]
    Reduction {
        /// The method.
        method: &'static str,
        /// The problem, and what to do.
        problem: String,
    },
    /// Weights that make no solvable problem, every reason.
    #[error("there is no controller for these weights")]
    NoController(Vec<DesignFinding>),
    /// A file that the project names.
    #[error("the file \"{name}\", which [{section}] names: {problem}")]
    File {
        /// Name.
        name: String,
        /// The section that names it.
        section: &'static str,
        /// Description of the error.
        problem: String,
    },
    /// Two axes that do not fit together.
    #[error("the file \"{name}\", which [traverse] names: {problem}")]
    Axes {
        /// The file of the traverse axis.
        name: String,
        /// Why they do not.
        problem: AxesProblem,
    },
    /// The mechanism was refused.
    #[error("plant: {0}")]
    Models(#[from] counterpoise_models::Error),
    /// A linear-systems operation failed.
    #[error("linear system: {0}")]
    Lti(#[from] counterpoise_lti::Error),
    /// The reduction failed.
    #[error("reduction: {0}")]
    Reduce(#[from] counterpoise_reduce::Error),
    /// The design failed.
    #[error("design: {0}")]
    Synth(#[source] counterpoise_synth::Error),
    /// There is no fixed-point form.
    #[error("fixed point: {0}")]
    Fixed(#[from] counterpoise_export::FixedError),
    /// The verification failed.
    #[error("verification: {0}")]
    Verify(#[from] counterpoise_verify::Error),
    /// The export failed.
    #[error("export: {0}")]
    Export(#[from] counterpoise_export::Error),
    /// The simulator refused.
    #[error("simulation: {0}")]
    Simulate(#[from] counterpoise_simulate::Error),
    /// The identification refused.
    #[error("identification: {0}")]
    Diagnose(#[from] counterpoise_diagnose::Error),
    /// A channel that a recording lacks.
    #[error("the recording {recording} has no channel {channel}, which this frequency response needs")]
    Channel {
        /// Name of the recording.
        recording: String,
        /// The channel.
        channel: &'static str,
    },
    /// A file of recordings cannot be read as the project maps it.
    #[error(transparent)]
    UnreadableRecording(counterpoise_recordings::Error),
    /// The gaps of a recording leave no part of it.
    #[error("no part of {recording} can be replayed")]
    NothingToReplay {
        /// Name of the recording.
        recording: String,
        /// The remarks about it.
        remarks: Vec<ColumnRemark>,
    },
    /// The model cannot replay a recording.
    #[error("cannot replay {recording}")]
    CannotReplay {
        /// Name of the recording.
        recording: String,
        /// Why.
        #[source]
        cause: Box<counterpoise_simulate::Error>,
        /// The columns of its file that were not used, of which one may be what it lacks.
        unused: Vec<UnusedColumn>,
    },
    /// Recordings cannot be diagnosed.
    #[error("{cause}")]
    Diagnosis {
        /// Why.
        cause: counterpoise_diagnose::Error,
        /// The columns of their files that were not used, of which one may be what they lack.
        unused: Vec<UnusedColumn>,
    },
    /// A recording cannot be used.
    #[error("recording: {0}")]
    Recording(#[from] counterpoise_recordings::Error),
}

impl From<counterpoise_synth::Error> for PipelineError {
    /// A refusal of the design keeps its reasons.
    fn from(error: counterpoise_synth::Error) -> Self {
        match error {
            counterpoise_synth::Error::Refused(refusal) => PipelineError::NoController(refusal.findings),
            other => PipelineError::Synth(other),
        }
    }
}

fn first_reason(why: &Option<Box<counterpoise_synth::Error>>) -> String {
    why.as_ref().map_or(String::new(), |why| format!(" ({why})"))
}
