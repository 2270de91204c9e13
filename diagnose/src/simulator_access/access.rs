//! The requests of the diagnosis to a simulator.

use crate::tolerance::fitting::DIVERGENCE_DOUBT;
use counterpoise_models::Parameters;
use counterpoise_recordings::Channel;
use counterpoise_simulate::PlantState;
use counterpoise_simulate::replay::START_FREEDOMS;
use counterpoise_simulate::sensitivity::Side;

use crate::recording::measured_signals::MeasuredSignals;
use crate::recording::series::rms;

/// The shift of each degree of freedom of a recording's initial state, in units of its step.
pub type StartShift = [f64; START_FREEDOMS];

/// The residual of one channel of one recording.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelResidual {
    /// The channel.
    pub channel: Channel,
    /// (measured - simulated) / noise floor, sample by sample.
    pub residual: Vec<f64>,
    /// Noise floor in the channel's unit: the RMS of the residual of a perfect model (noise, quantisation, what the platform's
    /// sensors add).
    pub floor: f64,
}

impl ChannelResidual {
    /// Returns the RMS of the residual in noise floors.
    pub fn relative_rms(&self) -> f64 {
        rms(&self.residual)
    }
}

/// A variant of a mechanism, and where it starts.
#[derive(Debug, Clone, PartialEq)]
pub struct MechanismVariant {
    /// The mechanism.
    pub parameters: Parameters,
    /// The shift of its initial state.
    pub shift: StartShift,
}

/// A variant of a mechanism in one of the recordings.
#[derive(Debug, Clone)]
pub struct PlacedVariant<'a> {
    /// The variant.
    pub variant: MechanismVariant,
    /// The recording.
    pub index: usize,
    /// The assessment of a similar mechanism, from whose initial state the variant starts.
    pub near: &'a Assessment,
}

/// A recording with the assessment of a similar mechanism.
#[derive(Debug, Clone, Copy)]
pub struct NearRecording<'a> {
    /// The recording.
    pub index: usize,
    /// The assessment.
    pub near: &'a Assessment,
}

/// A direction along which residuals are differentiated.
pub struct VariantDirection<'a> {
    /// Returns the variant at a distance from the one at hand, in units of the direction.
    pub member: &'a (dyn Fn(f64) -> MechanismVariant + Sync),
    /// The side on which there are variants.
    pub side: Side,
}

/// Part of a recording that is replayed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Span {
    /// All of it.
    Whole,
    /// The first part, which candidates are fitted to.
    Head,
}

/// Fit of one mechanism to one recording.
#[derive(Debug, Clone)]
pub struct Assessment {
    /// Channels.
    pub channels: Vec<ChannelResidual>,
    /// Divergence of two runs of the same mechanism that differ only in sensor noise: RMS per channel, in noise floors. It is small
    /// for a well-behaved loop, and large if the loop hunts and no replay can follow it.
    pub divergence: Vec<f64>,
    /// The initial state, if the simulator has one.
    pub start: Option<PlantState>,
    /// Source of the control of the run.
    pub source: ControlSource,
}

/// Source of the control of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ControlSource {
    /// The recording's controller acts on the simulated hub.
    ClosedLoop,
    /// The recorded control is played back: if the closed loop hunts, this repeats what the closed loop cannot.
    Playback,
}

impl Assessment {
    /// Returns the assessment without its residuals: it holds the initial state from which a similar mechanism may be run.
    pub fn without_residuals(&self) -> Self {
        Self { channels: Vec::new(), ..self.clone() }
    }

    /// Returns the RMS of a channel's residual in noise floors, reduced if runs do not repeat.
    pub fn excess(&self, channel: usize) -> f64 {
        self.channels[channel].relative_rms() * self.weight(channel)
    }

    /// Returns the weight of a channel in a fit: below 1 if runs do not repeat.
    pub fn weight(&self, channel: usize) -> f64 {
        let divergence = DIVERGENCE_DOUBT * self.divergence.get(channel).copied().unwrap_or(0.0);
        1.0 / (1.0 + divergence * divergence).sqrt()
    }
}

/// A set of recordings of one machine, and a simulator that replays them.
pub trait SimulatorAccess: Sync {
    /// Returns the number of recordings.
    fn count(&self) -> usize;
    /// Returns the measured signals of a recording; `None` if the simulator has no recordings of a machine.
    fn measured_signals(&self, _index: usize) -> Option<MeasuredSignals> {
        None
    }
    /// Returns the index of the recording in which the machine moves most.
    fn most_active_recording(&self) -> usize;
    /// Returns the residuals of recording `index` over its first part or all of it, from the initial state of the assessment of a
    /// similar mechanism; `None` if the mechanism cannot be simulated.
    fn residuals(
        &self,
        parameters: &Parameters,
        index: usize,
        span: Span,
        near: &Assessment,
    ) -> Option<Vec<ChannelResidual>>;
    /// Returns the residuals from a shifted initial state, and that state; `None` if the simulator's initial states have no degrees
    /// of freedom.
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
    /// Returns the residuals of one variant of a mechanism, as [`SimulatorAccess::residuals`] and
    /// [`SimulatorAccess::residuals_from_shifted_start`] do.
    fn residuals_of(
        &self,
        variant: &MechanismVariant,
        index: usize,
        span: Span,
        near: &Assessment,
    ) -> Option<Vec<ChannelResidual>> {
        let MechanismVariant { parameters, shift } = variant;
        if shift.iter().all(|s| *s == 0.0) {
            return self.residuals(parameters, index, span, near);
        }
        let shifted = self.residuals_from_shifted_start(parameters, index, span, near, shift);
        shifted.map(|(channels, _)| channels)
    }
    /// Returns the residuals of several variants, each in its recording: the same as of one after the other, but quicker.
    fn residuals_of_each(&self, placed: &[PlacedVariant], span: Span) -> Vec<Option<Vec<ChannelResidual>>> {
        placed.iter().map(|one| self.residuals_of(&one.variant, one.index, span, one.near)).collect()
    }
    /// Returns the derivatives of the residuals of a variant along directions, direction by direction: exact, from one run. Returns `None` if the
    /// simulator has none for this variant or one of these directions; differences of runs then take their place.
    fn residual_slopes(
        &self,
        _variant: &MechanismVariant,
        _directions: &[VariantDirection],
        _index: usize,
        _span: Span,
        _near: &Assessment,
    ) -> Option<Vec<Vec<ChannelResidual>>> {
        None
    }
    /// Returns the angle over which the hub moves on the platform, rad.
    fn travel_rad(&self) -> f64 {
        f64::INFINITY
    }
    /// Returns the turns of the hub on the platform from one sample to the next, RMS, in the most active recording.
    fn turns_per_sample(&self) -> f64 {
        0.0
    }
    /// Returns what another realisation of the sensors' noise in the loop would have changed, channel by channel, in noise floors;
    /// `which` is the number of the realisation. Returns `None` if the simulator has no noise.
    fn noise_response(
        &self,
        _parameters: &Parameters,
        _index: usize,
        _near: &Assessment,
        _which: u64,
    ) -> Option<Vec<Vec<f64>>> {
        None
    }
    /// Assesses a recording from the initial state of the assessment of a similar mechanism, which is quicker than
    /// [`SimulatorAccess::assess`].
    fn assess_from(&self, parameters: &Parameters, index: usize, near: &Assessment) -> Option<Assessment>;
    /// Assesses several recordings as [`SimulatorAccess::assess_from`] does, but quicker.
    fn assess_each_from(
        &self,
        parameters: &Parameters,
        recordings: &[NearRecording],
    ) -> Vec<Option<Assessment>> {
        recordings.iter().map(|one| self.assess_from(parameters, one.index, one.near)).collect()
    }
    /// Assesses a recording from the mechanism's own initial state, which is sought near that of the assessment of a similar
    /// mechanism.
    fn assess_near(&self, parameters: &Parameters, index: usize, _near: &Assessment) -> Option<Assessment> {
        self.assess(parameters, index)
    }
    /// Assesses recording `index` from the mechanism's own initial state; returns `None` if the mechanism cannot be simulated.
    fn assess(&self, parameters: &Parameters, index: usize) -> Option<Assessment>;
}
