//! What the diagnosis asks of a simulator.

use counterpoise_models::Parameters;
use counterpoise_simulate::PlantState;
use counterpoise_simulate::replay::START_FREEDOMS;

use crate::recording::series::rms;

/// By how many of its steps each freedom of a recording's start is moved.
pub type StartShift = [f64; START_FREEDOMS];

/// What one channel of one recording says about a model.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelResidual {
    /// Channel name.
    pub channel: &'static str,
    /// (simulated - measured) / floor, sample by sample.
    pub residual: Vec<f64>,
    /// RMS that a perfect model would leave (noise, quantisation, what the platform's sensors add), in the channel's unit.
    pub floor: f64,
}

impl ChannelResidual {
    /// RMS of the residual in units of the floor.
    pub fn relative_rms(&self) -> f64 {
        rms(&self.residual)
    }
}

/// What one pair of runs parts by is a poor estimate of what any two part by: it is taken this many times.
const WANDER_DOUBT: f64 = 2.0;

/// How much of a recording is replayed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Span {
    /// All of it.
    Whole,
    /// The first part, which candidates are fitted to.
    Head,
}

/// How one recording stands to one mechanism.
#[derive(Debug, Clone)]
pub struct Assessment {
    /// Channels.
    pub channels: Vec<ChannelResidual>,
    /// How far two runs of the same mechanism part that differ in sensor noise alone: RMS per channel, in units of the
    /// floor. Small for a well-behaved loop; large where the loop hunts and no replay can follow it.
    pub divergence: Vec<f64>,
    /// The state in which the recording starts, where the simulator has one.
    pub start: Option<PlantState>,
    /// How the recording was run.
    pub source: ControlSource,
}

/// How a recording is run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ControlSource {
    /// The recording's controller acts on the simulated hub.
    ClosedLoop,
    /// The recorded control is played back: where the closed loop hunts, it repeats what the closed loop cannot.
    Playback,
}

impl Assessment {
    /// The judgement without its residuals: where a run nearby may start.
    pub fn without_residuals(&self) -> Self {
        Self { channels: Vec::new(), ..self.clone() }
    }

    /// RMS of a channel's residual in floors, less where a run does not repeat.
    pub fn excess(&self, channel: usize) -> f64 {
        self.channels[channel].relative_rms() * self.weight(channel)
    }

    /// Weight of a channel in a fit: less where a run does not repeat.
    pub fn weight(&self, channel: usize) -> f64 {
        let divergence = WANDER_DOUBT * self.divergence.get(channel).copied().unwrap_or(0.0);
        1.0 / (1.0 + divergence * divergence).sqrt()
    }
}

/// A set of recordings of one machine, and a simulator that replays them.
pub trait SimulatorAccess: Sync {
    /// Number of recordings.
    fn count(&self) -> usize;
    /// The recording in which the machine moves most.
    fn most_active_recording(&self) -> usize;
    /// The misfit of each channel of recording `index` over its first part or all of it, from the start of a judgement
    /// of a mechanism nearby; none where it cannot be simulated.
    fn residuals(
        &self,
        parameters: &Parameters,
        index: usize,
        span: Span,
        near: &Assessment,
    ) -> Option<Vec<ChannelResidual>>;
    /// As [`SimulatorAccess::residuals`], the freedoms of the start moved, and the start that this gives; none where the simulator's starts
    /// have no freedoms.
    fn residuals_from_shifted_start(
        &self,
        _parameters: &Parameters,
        _index: usize,
        _span: Span,
        _near: &Assessment,
        _shift: &StartShift,
    ) -> Option<(Vec<ChannelResidual>, PlantState)> {
        None
    }
    /// Angle over which the hub moves on the platform, rad.
    fn travel_rad(&self) -> f64 {
        f64::INFINITY
    }
    /// Turns of the hub on the platform from one sample to the next, RMS, in the most_active_recording recording.
    fn turns_per_sample(&self) -> f64 {
        0.0
    }
    /// What other noise of the sensors in the loop would have changed, channel by channel, in floors: one of many
    /// possible outcomes, told by its number. None where the simulator has no noise.
    fn noise_response(
        &self,
        _parameters: &Parameters,
        _index: usize,
        _near: &Assessment,
        _which: u64,
    ) -> Option<Vec<Vec<f64>>> {
        None
    }
    /// As [`SimulatorAccess::assess`], but from the start of a judgement of a mechanism nearby: quicker.
    fn assess_from(&self, parameters: &Parameters, index: usize, near: &Assessment) -> Option<Assessment>;
    /// As [`SimulatorAccess::assess`], the mechanism's own start sought from that of a judgement nearby: quicker.
    fn assess_near(&self, parameters: &Parameters, index: usize, _near: &Assessment) -> Option<Assessment> {
        self.assess(parameters, index)
    }
    /// Recording `index` from the mechanism's own start; none where it cannot be simulated.
    fn assess(&self, parameters: &Parameters, index: usize) -> Option<Assessment>;
}
