//! A feedback of fixed structure: its blocks, and what their open parameters are tuned for.

use counterpoise_synth::{Block, BlockKind, BlockParameter, LoopLimits, ParameterName};

use super::model::count;
use crate::file::field::{Field, NumberRange, TableField};
use crate::file::visit::{Count, NamedChoice, Visit, choose, list, maybe_number, pair};

/// Objective and limits of a tuning of open parameters or of weights.
#[derive(Debug, Clone, PartialEq)]
pub struct TuningOptions {
    /// The treatment of the weights of the H2 feedback: tuned or as stated.
    pub weights: TunedWeights,
    /// Objective that is minimised.
    pub objective: TuningObjective,
    /// The band of [`TuningObjective::Band`], rad/s.
    pub band_rad_s: [f64; 2],
    /// Limits that the loop must keep on every plant.
    pub limits: LoopLimits,
    /// The plants that one controller must serve besides the nominal one.
    pub plants: Vec<FurtherPlants>,
    /// Number of starts.
    pub starts: usize,
    /// Seed of the starts.
    pub seed: u32,
}

/// Origin of the weights of the H2 feedback: those of the file, or tuned from there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TunedWeights {
    /// As the file states them.
    Stated,
    /// To be tuned from there.
    ToTune,
    /// As the file states them, because a tuning wrote them.
    Tuned,
}

/// Quantity that a tuning minimises.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TuningObjective {
    /// The hub rate that the project's own motion, friction and noise leave.
    Motion,
    /// The RMS of |S| over a band.
    Band,
}

/// Plants besides the nominal one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FurtherPlants {
    /// The states of balance of `[synth.schedule]`.
    Schedule,
    /// The extremes of the variations of `[sweep]`.
    Sweep,
}

impl NamedChoice for BlockKind {
    const NAMES: &'static [(&'static str, Self)] = &[
        ("gain", Self::Gain),
        ("pi", Self::ProportionalIntegral),
        ("pid", Self::ProportionalIntegralDerivative),
        ("lead", Self::Lead),
        ("lag", Self::Lag),
        ("notch", Self::Notch),
        ("biquad", Self::Biquad),
        ("low-pass", Self::LowPass),
        ("second-order-low-pass", Self::SecondOrderLowPass),
    ];
}

impl NamedChoice for TunedWeights {
    const NAMES: &'static [(&'static str, Self)] =
        &[("stated", Self::Stated), ("tune", Self::ToTune), ("tuned", Self::Tuned)];
}

impl NamedChoice for TuningObjective {
    const NAMES: &'static [(&'static str, Self)] = &[("motion", Self::Motion), ("band", Self::Band)];
}

impl NamedChoice for FurtherPlants {
    const NAMES: &'static [(&'static str, Self)] = &[("schedule", Self::Schedule), ("sweep", Self::Sweep)];
}

const ABOVE_0: NumberRange = NumberRange::Above(0.0);
const AT_LEAST_0: NumberRange = NumberRange::AtLeast(0.0);
const KIND: Field =
    Field::new("kind", "kind of the block; the signal passes the blocks in their order in the file");

impl Default for TuningOptions {
    fn default() -> Self {
        // Ms 1.4 keeps 41 degrees and a gain factor of 3.5 (Astrom and Murray, Feedback Systems, section 12.2).
        let limits = LoopLimits { max_sensitivity: 1.4, max_complementary: 1.4, ..LoopLimits::default() };
        Self {
            weights: TunedWeights::Stated,
            objective: TuningObjective::Motion,
            band_rad_s: [1.26, 12.6],
            limits,
            plants: Vec::new(),
            starts: 12,
            seed: 1,
        }
    }
}

/// Reads or lists the blocks of the feedback.
pub(crate) fn blocks(v: &mut dyn Visit, blocks: &mut Vec<Block>) {
    let meaning = "a block of a feedback of fixed structure, which takes the place of the H2 feedback";
    let blank = Block::open(BlockKind::Gain);
    list(v, &TableField::optional("block", meaning), blocks, blank, block);
}

fn block(v: &mut dyn Visit, block: &mut Block) {
    let mut kind = block.kind;
    choose(v, &KIND, &mut kind);
    if kind != block.kind {
        *block = Block::open(kind);
    }
    for (parameter, name) in block.parameters.iter_mut().zip(kind.parameters()) {
        let (value, range) = fields(*name);
        read_parameter(v, parameter, &value, &range);
    }
}

fn read_parameter(v: &mut dyn Visit, parameter: &mut BlockParameter, value: &Field, range: &Field) {
    maybe_number(v, value, &mut parameter.value);
    let mut ends: Vec<f64> = parameter.range.map(|range| range.to_vec()).unwrap_or_default();
    v.numbers(range, Count::Exactly(2), &mut ends);
    parameter.range = match ends[..] {
        [low, high] => Some([low, high]),
        _ => None,
    };
    let Some([low, high]) = parameter.range else { return };
    if low >= high {
        v.complain(range.key, &format!("must rise: {low} is not below {high}"), None);
    } else if let Some(start) = parameter.value.filter(|start| !(low..=high).contains(start)) {
        let allowed = format!("must lie in `{}`, from {low} to {high}, not {start}", range.key);
        v.complain(value.key, &allowed, Some("remove one of the two, or widen the range".to_owned()));
    }
}

/// Returns the fields of a parameter's value and of its range.
fn fields(name: ParameterName) -> (Field, Field) {
    use ParameterName::*;
    let (key, range, unit, meaning) = match name {
        Gain => ("gain", "gain_range", "V s/rad", "gain k"),
        Corner => ("corner", "corner_range", "rad/s", "corner c: the block integrates below it"),
        DerivativeTime => {
            ("derivative_time", "derivative_time_range", "s", "time constant T of the derivative")
        }
        FilterTime => ("filter_time", "filter_time_range", "s", "time constant t of the derivative's filter"),
        Frequency => ("frequency", "frequency_range", "rad/s", "corner, or centre of a notch, w"),
        Ratio => (
            "ratio",
            "ratio_range",
            "",
            "ratio r of the two corners, which is the gain between their two sides",
        ),
        Damping => ("damping", "damping_range", "", "damping ratio z of the poles"),
        Depth => ("depth", "depth_range", "", "gain d at the centre of the notch"),
        ZeroFrequency => {
            ("zero_frequency", "zero_frequency_range", "rad/s", "natural frequency a of the zeros")
        }
        ZeroDamping => ("zero_damping", "zero_damping_range", "", "damping ratio y of the zeros"),
        PoleFrequency => {
            ("pole_frequency", "pole_frequency_range", "rad/s", "natural frequency b of the poles")
        }
        PoleDamping => ("pole_damping", "pole_damping_range", "", "damping ratio z of the poles"),
    };
    let between =
        "lowest and highest value that the tuning may choose; a value beside it is where the tuning starts";
    let limit = if name == Ratio { NumberRange::AtLeast(1.0) } else { ABOVE_0 };
    (
        Field::new(key, meaning).unit(unit).limit(limit),
        Field::new(range, between).unit(unit).limit(limit).or_empty(),
    )
}

/// Reads or lists what the open parameters are tuned for.
pub(crate) fn tuning(v: &mut dyn Visit, tuning: &mut TuningOptions) {
    let which = "weights of an H2 feedback: as [synth.feedback] states them, to be tuned from there under the limits, or written by a tuning";
    choose(v, &Field::new("weights", which).or_text("stated"), &mut tuning.weights);
    let meaning = "what is made least: the hub rate that the project's motion, friction and noise leave, or the RMS of the sensitivity over `band`";
    choose(v, &Field::new("objective", meaning).or_text("motion"), &mut tuning.objective);
    let mut band = tuning.band_rad_s;
    let field =
        Field::new("band", "lower and upper end of the band of the objective `band`; absent, 1.26 to 12.6");
    pair(v, &field.unit("rad/s").limit(ABOVE_0).or_empty(), &mut band);
    if band[0] >= band[1] {
        v.complain("band", "must rise", None);
    } else {
        tuning.band_rad_s = band;
    }
    limits(v, &mut tuning.limits, LimitDefaults::OF_TUNING);
    plants(v, &mut tuning.plants);
    let starts = Field::new(
        "starts",
        "number of points from which the tuning starts, and of restarts near the best answer",
    );
    count(v, &starts.limit(NumberRange::Between(1.0, 1000.0)).or(12.0), &mut tuning.starts);
    let seed = Field::new("seed", "seed of the random part of the starts").limit(AT_LEAST_0);
    v.whole_number(&seed.or(1.0), &mut tuning.seed);
}

/// What limits of a loop are if a file states none.
#[derive(Debug, Clone, Copy)]
pub(super) struct LimitDefaults {
    /// Largest |S| and largest |T|.
    pub peak: f64,
    /// Meaning of the limit of the decay.
    pub decay: &'static str,
}

impl LimitDefaults {
    /// Those of a tuning.
    pub const OF_TUNING: Self = Self { peak: 1.4, decay: "slowest decay of a pole of the closed loop" };
    /// Those of a front.
    pub const OF_FRONT: Self = Self {
        peak: 2.0,
        decay: "slowest decay of a pole of the closed loop; 0 takes that of the project's own design",
    };
}

/// Reads or lists the limits of a loop.
pub(super) fn limits(v: &mut dyn Visit, limits: &mut LoopLimits, usual: LimitDefaults) {
    let above_1 = NumberRange::Above(1.0);
    let ms = Field::new("max_sensitivity", "largest sensitivity").limit(above_1).or(usual.peak);
    v.number(&ms.show_default(), &mut limits.max_sensitivity);
    let mt =
        Field::new("max_complementary", "largest complementary sensitivity").limit(above_1).or(usual.peak);
    v.number(&mt.show_default(), &mut limits.max_complementary);
    let gain = Field::new("gain_margin", "lowest gain margin").unit("dB").limit(AT_LEAST_0).or(0.0);
    v.number(&gain, &mut limits.gain_margin_db);
    let phase = Field::new("phase_margin", "lowest phase margin").unit("degrees").limit(AT_LEAST_0).or(0.0);
    v.number(&phase, &mut limits.phase_margin_deg);
    let delay = Field::new("delay_margin", "lowest delay margin").unit("s").limit(AT_LEAST_0).or(0.0);
    v.number(&delay, &mut limits.delay_margin_s);
    let noise = Field::new("noise_gain", "largest RMS control for noise of unit RMS").unit("V s/rad");
    visit_limit(v, &noise, &mut limits.noise_gain);
    let peak =
        Field::new("control_peak", "largest gain from the reading's noise to the control at any frequency")
            .unit("V s/rad");
    visit_limit(v, &peak, &mut limits.control_peak);
    let effort =
        Field::new("effort", "largest RMS control of the feedback under the objective's disturbance");
    visit_limit(v, &effort.unit("V"), &mut limits.effort_v);
    let decay = Field::new("decay", usual.decay).unit("rad/s");
    v.number(&decay.limit(AT_LEAST_0).or(0.0), &mut limits.decay_rad_s);
    let damping = Field::new("damping", "smallest damping ratio of the poles up to twice the crossover");
    v.number(&damping.limit(NumberRange::Between(0.0, 0.99)).or(0.0), &mut limits.damping);
}

/// A limit that is infinite if it is not written.
fn visit_limit(v: &mut dyn Visit, field: &Field, value: &mut f64) {
    let mut slot = value.is_finite().then_some(*value);
    maybe_number(v, &field.limit(ABOVE_0), &mut slot);
    *value = slot.unwrap_or(f64::INFINITY);
}

fn plants(v: &mut dyn Visit, plants: &mut Vec<FurtherPlants>) {
    let mut names: Vec<String> = plants.iter().map(|each| each.name().to_owned()).collect();
    let meaning = "plants besides the nominal one on which one controller keeps the limits: the states of balance of [synth.schedule], the extremes of [sweep]";
    v.texts(&Field::new("plants", meaning).or_empty(), &mut names);
    let known = |name: &String| FurtherPlants::NAMES.iter().find(|(n, _)| n == name).map(|(_, each)| *each);
    if let Some(unknown) = names.iter().find(|name| known(name).is_none()) {
        let hint = crate::diagnostic::did_you_mean(unknown, FurtherPlants::NAMES.iter().map(|(n, _)| *n));
        v.complain("plants", "may hold \"schedule\" and \"sweep\"", hint);
    }
    *plants = names.iter().filter_map(known).collect();
}
