//! A first design by itself: the weights that give the highest bandwidth which the loop allows at stated margins.
//!
//! The feedback's weights follow from one number, the bandwidth that they aim at (`candidate`): an error weight that
//! integrates below a fifth of it and is the inverse of the plant's gain at it, a control weight that rises above it, and
//! noises that make the observer a few times as quick. For each aim the *sampled* loop is judged (`judgement`): margins,
//! the same margins with every lightly damped mode shifted ([`crate::modes`]), the control that noise and quantisation cost,
//! and the control that a step of the demand takes. The highest aim that keeps everything is the answer. Every limit
//! is told with the bandwidth up to which it alone would have allowed the loop, and with the bandwidth if it alone were lifted (`lifted_limits`):
//! what limits is what raises the bandwidth when it is lifted.
//!
//! In a cascade the weights aim at the bandwidth of the rate loop, the position loop has a fixed share of it, and the judged loop is
//! the whole cascade at the plant's input.
//!
//! *Bandwidth* is the lowest frequency at which the loop's gain falls to 1: a resonance at which it rises above 1 once more
//! makes no loop quick. It never exceeds a twentieth of the sample rate
//! (nor does the frequency at which the closed loop has fallen by 3 dB), and each fact of the loop that is not known
//! lowers that ceiling ([`tolerance::CAUTION`](crate::tolerance::CAUTION)).
//!
//! Sources: the bandwidth that delay, right half plane zeros and unstable poles leave is Åström's (Limitations on control
//! system performance, European Journal of Control 6 (2000) 2); gain stabilisation of uncertain modes is from Preumont,
//! Vibration Control of Active Structures, chapter 4; a sample rate of twenty times the bandwidth is from Franklin, Powell
//! and Workman, Digital Control of Dynamic Systems, chapter 11.

mod approach;
mod candidate;
mod feedforwards;
mod judgement;
mod lifted_limits;
mod scan;
mod search;

pub use feedforwards::ExpectedMotion;
pub use judgement::{LoopJudgement, RequiredMargins};

use counterpoise_lti::StateSpace;

use crate::bandwidth::{Bandwidth, Unknown};
use crate::cause::{Cause, PlantCause};
use crate::finding::{DesignFinding, Part};
use crate::{DesignPlant, Error, Sampling, Specification};
use counterpoise_pool::{Pool, Serial};
use scan::Scan;

/// The origin of the limit of a control.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ControlLimit {
    /// From what the drive can give.
    OfDrive,
    /// From the range of the controller's output alone: what the drive can give is not known.
    OfConverter,
}

/// The usual worst of a reading if nothing is known of it; 0 if nothing is usual.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct UsualReading {
    /// RMS noise, in the unit of the measured signal.
    pub noise_rms: f64,
    /// Step, in the unit of the measured signal.
    pub step: f64,
}

/// A machine with what is not stated at the ends of its usual range.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct UsualPlants {
    /// With the values that set its modes or its lags, which the loop must hold with the largest sensitivity of its margins.
    pub within_ranges: Vec<DesignPlant>,
    /// The same with what the linear plant leaves out (gravity's gradient, a spring), which the loop must hold with the largest sensitivity of
    /// [`Circumstances::others`].
    pub others_at_ends: Vec<DesignPlant>,
    /// With the largest usual lags of reading, control and drive where none is stated, and the least damping: the loop must keep its margins with them, be slow
    /// enough for its sample rate, and bear shifted modes.
    pub with_lags: Vec<DesignPlant>,
}

impl UsualPlants {
    /// Returns whether there is none.
    pub fn is_empty(&self) -> bool {
        self.within_ranges.is_empty() && self.others_at_ends.is_empty() && self.with_lags.is_empty()
    }
}

/// The known facts of a loop beyond its linear plant. Numbers of 0 are not known.
#[derive(Debug, Clone, PartialEq)]
pub struct Circumstances {
    /// The plant. Its `rate` is the signal that is measured and controlled, a rate or a position.
    pub plant: DesignPlant,
    /// Plants that the loop must hold too: the same machine with what the linear plant leaves out (gravity's gradient, dry friction
    /// at rest).
    pub others: Vec<DesignPlant>,
    /// The same machine with values at the ends of their tolerances, which the loop must hold with the margin that shifted modes keep.
    pub within_tolerances: Vec<DesignPlant>,
    /// The same machine with what is not stated at the ends of its usual range.
    pub usual: UsualPlants,
    /// Noise and step of the readings that are usual, which count if neither is known.
    pub usual_reading: UsualReading,
    /// The output of the plant (of its inner loop, if it has one) that is the load's motion, where a sensor measures something else; `None` if
    /// nothing but the measured signal is known.
    pub load_output: Option<usize>,
    /// The sampling of the controller.
    pub sampling: Sampling,
    /// The origin of the limit of the control.
    pub control_limit: ControlLimit,
    /// RMS noise of a reading, in the unit of the measured signal.
    pub noise_rms: f64,
    /// Step of a digital reading, in the unit of the measured signal.
    pub reading_step: f64,
    /// Control that holds the machine where it stands, V.
    pub holding_v: f64,
    /// Step of the demand that must not take more than the control's limit, in the unit of the measured signal.
    pub demand_step: f64,
    /// Noise, lag of the sensor or delay of which is known that there is none.
    pub known_absent: Vec<Unknown>,
    /// Margins that the loop must keep.
    pub margins: RequiredMargins,
    /// Whether the feedback may be designed on the plant with stiff modes.
    pub may_stiffen_modes: bool,
    /// Gain of the position loop that is asked for, 1/s; `None` chooses it. Only a plant with a rate loop has one.
    pub position_gain: Option<f64>,
    /// The bandwidth that is asked for, rad/s; `None` asks for the highest.
    pub asked_rad_s: Option<f64>,
    /// The heave that is expected and measured.
    pub heave: Option<ExpectedMotion>,
    /// The pitch that is expected and measured.
    pub pitch: Option<ExpectedMotion>,
}

impl Circumstances {
    /// Returns whether noise or step of the readings is known.
    fn is_reading_known(&self) -> bool {
        self.noise_rms > 0.0 || self.reading_step > 0.0 || self.known_absent.contains(&Unknown::Noise)
    }

    /// Returns RMS noise and step of a reading: those that are known, or else those that are usual.
    fn reading(&self) -> [f64; 2] {
        match self.is_reading_known() {
            true => [self.noise_rms, self.reading_step],
            false => [self.usual_reading.noise_rms, self.usual_reading.step],
        }
    }
}

/// Weights that were chosen, and why the loop is no quicker.
#[derive(Debug, Clone, PartialEq)]
pub struct FirstDesign {
    /// The weights.
    pub specification: Specification,
    /// The bandwidth with its limits.
    pub bandwidth: Bandwidth,
    /// The figures of the sampled feedback loop.
    pub judgement: LoopJudgement,
    /// The sampled loops that were judged, broken at the control: that of the plant, then those of the plants with shifted modes.
    pub loops: Vec<StateSpace>,
    /// The loops that show what each limit allows, in the order of the limits.
    pub shown_by: Vec<LimitLoops>,
    /// The margins that the loop had to keep.
    pub required: RequiredMargins,
    /// Sample period of the controller, s.
    pub sample_period_s: f64,
    /// Channels that are measured but have no feedforward, with the reason.
    pub left_out: Vec<DesignFinding>,
}

/// The sampled loops, broken at the control, whose bandwidths are those of a limit.
#[derive(Debug, Clone, PartialEq)]
pub struct LimitLoops {
    /// The loop of the highest bandwidth that keeps the limit; `None` if none was needed to tell, or none keeps it.
    pub allowed: Option<StateSpace>,
    /// The loop of the highest bandwidth with the limit lifted; `None` if it would be no higher.
    pub lifted: Option<StateSpace>,
}

/// Chooses the weights of a loop.
///
/// # Errors
/// [`Error`] for a plant or sampling that is none; [`Error::Refused`] if no bandwidth keeps the margins.
pub fn first_design(circumstances: &Circumstances) -> Result<FirstDesign, Error> {
    first_design_on(circumstances, &Serial)
}

/// Chooses the weights of a loop, with candidates judged side by side on the processors at hand; the result is that of [`first_design`].
///
/// # Errors
/// As [`first_design`].
pub fn first_design_on(circumstances: &Circumstances, pool: &dyn Pool) -> Result<FirstDesign, Error> {
    let mut scan = Scan::new(circumstances, pool)?;
    scan.run()?;
    let Some(found) = scan.best_design() else {
        let finding = DesignFinding::refusal(
            Part::Feedback,
            Cause::Plant(PlantCause::NoBandwidth { limits: scan.summary() }),
        );
        return Err(Error::refusal(vec![finding]));
    };
    let lifted_limits::BandwidthWithLoops { bandwidth, shown_by } =
        lifted_limits::bandwidth(&mut scan, &found)?;
    let (specification, left_out) = feedforwards::with_feedforwards(circumstances, &found)?;
    let loops = scan.loops(&found)?;
    let sample_period_s = circumstances.sampling.period_s;
    let (judgement, required) = (found.judgement, circumstances.margins);
    Ok(FirstDesign {
        specification,
        bandwidth,
        judgement,
        loops,
        shown_by,
        required,
        sample_period_s,
        left_out,
    })
}
