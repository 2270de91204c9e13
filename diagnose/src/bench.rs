//! What the diagnosis asks of a simulator, and how it asks for many runs at once.

use counterpoise_models::Parameters;
use counterpoise_simulate::PlantState;
use counterpoise_simulate::replay::START_FREEDOMS;

/// By how many of its steps each freedom of a recording's start is moved.
pub type StartShift = [f64; START_FREEDOMS];

/// What one channel of one recording says about a model.
#[derive(Debug, Clone, PartialEq)]
pub struct Misfit {
    /// Channel name.
    pub channel: &'static str,
    /// (simulated - measured) / floor, sample by sample.
    pub residual: Vec<f64>,
    /// RMS that a perfect model would leave (noise, quantisation, what the platform's sensors add), in the channel's unit.
    pub floor: f64,
}

impl Misfit {
    /// RMS of the residual in units of the floor.
    pub fn relative_rms(&self) -> f64 {
        rms(&self.residual)
    }
}

/// What one pair of runs parts by is a poor estimate of what any two part by: it is taken this many times.
const WANDER_DOUBT: f64 = 2.0;

/// Root of the mean square; 0 for nothing.
pub fn rms(series: &[f64]) -> f64 {
    if series.is_empty() {
        0.0
    } else {
        (series.iter().map(|r| r * r).sum::<f64>() / series.len() as f64).sqrt()
    }
}

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
pub struct Judged {
    /// Channels.
    pub misfits: Vec<Misfit>,
    /// How far two runs of the same mechanism part that differ in sensor noise alone: RMS per channel, in units of the
    /// floor. Small for a well-behaved loop; large where the loop hunts and no replay can follow it.
    pub wander: Vec<f64>,
    /// The state in which the recording starts, where the simulator has one.
    pub start: Option<PlantState>,
    /// How the recording was run.
    pub drive: Drive,
}

/// How a recording is run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Drive {
    /// The recording's controller acts on the simulated hub.
    ClosedLoop,
    /// The recorded control is played back: where the closed loop hunts, it repeats what the closed loop cannot.
    Playback,
}

impl Judged {
    /// The judgement without its residuals: where a run nearby may start.
    pub fn stance(&self) -> Self {
        Self { misfits: Vec::new(), ..self.clone() }
    }

    /// RMS of a channel's residual in floors, less where a run does not repeat.
    pub fn excess(&self, channel: usize) -> f64 {
        self.misfits[channel].relative_rms() * self.weight(channel)
    }

    /// Weight of a channel in a fit: less where a run does not repeat.
    pub fn weight(&self, channel: usize) -> f64 {
        let wander = WANDER_DOUBT * self.wander.get(channel).copied().unwrap_or(0.0);
        1.0 / (1.0 + wander * wander).sqrt()
    }
}

/// A set of recordings of one machine, and a simulator that replays them.
pub trait Bench: Sync {
    /// Number of recordings.
    fn count(&self) -> usize;
    /// The recording in which the machine moves most.
    fn liveliest(&self) -> usize;
    /// The misfit of each channel of recording `index` over its first part or all of it, from the start of a judgement
    /// of a mechanism nearby; none where it cannot be simulated.
    fn misfit(&self, parameters: &Parameters, index: usize, span: Span, near: &Judged)
    -> Option<Vec<Misfit>>;
    /// As [`Bench::misfit`], the freedoms of the start moved, and the start that this gives; none where the simulator's starts
    /// have no freedoms.
    fn misfit_nudged(
        &self,
        _parameters: &Parameters,
        _index: usize,
        _span: Span,
        _near: &Judged,
        _shift: &StartShift,
    ) -> Option<(Vec<Misfit>, PlantState)> {
        None
    }
    /// Angle over which the hub moves on the platform, rad.
    fn travel_rad(&self) -> f64 {
        f64::INFINITY
    }
    /// Turns of the hub on the platform from one sample to the next, RMS, in the liveliest recording.
    fn turns_per_sample(&self) -> f64 {
        0.0
    }
    /// What other noise of the sensors in the loop would have changed, channel by channel, in floors: one of many
    /// possible outcomes, told by its number. None where the simulator has no noise.
    fn chance(
        &self,
        _parameters: &Parameters,
        _index: usize,
        _near: &Judged,
        _which: u64,
    ) -> Option<Vec<Vec<f64>>> {
        None
    }
    /// As [`Bench::judge`], but from the start of a judgement of a mechanism nearby: quicker.
    fn glance(&self, parameters: &Parameters, index: usize, near: &Judged) -> Option<Judged>;
    /// As [`Bench::judge`], the mechanism's own start sought from that of a judgement nearby: quicker.
    fn judge_near(&self, parameters: &Parameters, index: usize, _near: &Judged) -> Option<Judged> {
        self.judge(parameters, index)
    }
    /// Recording `index` from the mechanism's own start; none where it cannot be simulated.
    fn judge(&self, parameters: &Parameters, index: usize) -> Option<Judged>;
}

/// Runs independent jobs, in any order, on as many processors as the caller has.
pub trait Pool: Sync {
    /// Calls `job(0) .. job(count - 1)`, each once.
    fn run(&self, count: usize, job: &(dyn Fn(usize) + Sync));
    /// Whether the user asked to stop.
    fn cancelled(&self) -> bool {
        false
    }
    /// Says how far the work is.
    fn progress(&self, _stage: &str, _done: usize, _of: usize) {}
}

/// One job after the other, on the calling thread.
pub struct Serial;

impl Pool for Serial {
    fn run(&self, count: usize, job: &(dyn Fn(usize) + Sync)) {
        (0..count).for_each(job);
    }
}

/// `count` results of independent jobs, in order; fewer where the user asked to stop.
pub fn map<T: Send>(pool: &dyn Pool, count: usize, job: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let slots: Vec<std::sync::Mutex<Option<T>>> = (0..count).map(|_| std::sync::Mutex::new(None)).collect();
    pool.run(count, &|index| {
        if pool.cancelled() {
            return;
        }
        let result = job(index);
        if let Ok(mut slot) = slots[index].lock() {
            *slot = Some(result);
        }
    });
    slots.into_iter().filter_map(|slot| slot.into_inner().ok().flatten()).collect()
}
