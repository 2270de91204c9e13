//! Options of `[synth]` besides the weights of its three parts: the method, the order, prefilter, friction observer, schedule,
//! adaptation and the search for weights.

use counterpoise_models::Friction;
use counterpoise_synth::{BandSpectrum, Drives, FixedStructure, Requirements, SynthesisMethod, Weight};

use super::fixed_structure::{TuningOptions, blocks, tuning};
use super::friction::{blank_identified, identified_friction};
use super::front::{FrontOptions, front};
use super::imported_controller::{ImportedController, imported_controller};
use super::model::count;
use super::weight::{blank_weight, weight};
use crate::file::field::{Field, NumberRange, TableField};
use crate::file::visit::{Count, NamedChoice, Visit, choose, maybe_number, pair, table, visit_optional};

/// Options of a design besides the weights of its three parts.
#[derive(Debug, Clone, PartialEq)]
pub struct SynthesisOptions {
    /// The method of the feedback that is built.
    pub method: SynthesisMethod,
    /// Further methods, shown beside it with the same figures.
    pub alternatives: Vec<SynthesisMethod>,
    /// States that are kept of the feedback; `None` keeps them all.
    pub controller_order: Option<usize>,
    /// Filter of the demand before the controller.
    pub prefilter: Option<Weight>,
    /// Compensation of the amplifier's measured curve.
    pub amplifier_curve: Compensation,
    /// Compensation of the known gain and bias of the sensors.
    pub sensor_errors: Compensation,
    /// Nonlinear observer of friction.
    pub observer: Option<ObserverOptions>,
    /// Designs over out-of-balance.
    pub schedule: Option<ScheduleOptions>,
    /// Estimation of the out-of-balance while the machine runs.
    pub adaptation: Option<AdaptationOptions>,
    /// Requirements from which weights are searched.
    pub search: Option<WeightSearch>,
    /// Objectives, limits and size of a front of designs.
    pub front: Option<FrontOptions>,
    /// Blocks of the feedback in place of the H2 feedback; none without a fixed structure.
    pub structure: FixedStructure,
    /// A feedback that was made elsewhere, in place of the H2 feedback.
    pub imported: Option<ImportedController>,
    /// Objective of the tuning of the blocks' open parameters.
    pub tuning: Option<TuningOptions>,
}

impl SynthesisOptions {
    /// Leaves the feedback to the method: no blocks, and none that was made elsewhere.
    pub fn remove_fixed_feedback(&mut self) {
        self.structure = FixedStructure::default();
        self.imported = None;
    }

    /// Returns what the feedback is called that stands in place of the method's; `None` if the method's is taken.
    pub fn fixed_feedback_name(&self) -> Option<String> {
        match &self.imported {
            Some(imported) => Some(format!("controller in {}", imported.file)),
            None => (!self.structure.blocks.is_empty()).then(|| self.structure.name()),
        }
    }
}

/// The friction law that an observer follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ObserverFriction {
    /// Dahl's law with the same level and stiffness at rest.
    Dahl,
    /// The friction's own law.
    OwnLaw,
}

/// Compensation of a known deviation of the amplifier or of a sensor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Compensation {
    /// The controller does not compensate. The estimator of `adapt` alone knows the amplifier's curve.
    Absent,
    /// The controller compensates: its last step is the inverse of the amplifier's curve, and its first corrects the readings.
    Applied,
}

/// Options of a friction observer: which friction it cancels, and its law.
#[derive(Debug, Clone, PartialEq)]
pub struct ObserverOptions {
    /// Signal that drives its friction state.
    pub drives: Drives,
    /// Part that is cancelled, 0 to 1.
    pub share: f64,
    /// Friction at the motor shaft, as identified; `None` takes the plant's.
    pub motor: Option<Friction>,
    /// Friction at the pivot, as identified; `None` takes the plant's.
    pub pivot: Option<Friction>,
    /// The law by which the plant's friction is followed.
    pub model: ObserverFriction,
    /// Rate below which the sign of a law that truly sticks is softened, rad/s.
    pub sign_rate_rad_s: f64,
    /// The learning of the level that is really there; `None` keeps the stated one.
    pub learning: Option<LevelLearning>,
}

/// The learning of the level of a friction from the feedback.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LevelLearning {
    /// Lowest level over the stated one, and the level at the start.
    pub lowest: f64,
    /// Highest level over the stated one.
    pub highest: f64,
    /// Time constant of the learning while the friction slides, s.
    pub time_constant_s: f64,
    /// Rate above which the friction slides for certain, rad/s.
    pub sliding_rate_rad_s: f64,
}

/// The states of balance that are designed for.
#[derive(Debug, Clone, PartialEq)]
pub struct ScheduleOptions {
    /// Names of the plant's configurations: masses fitted, inertia changed with them.
    pub configurations: Vec<String>,
    /// Factors factors on the out-of-balance alone; the inertia stays.
    pub factors: Vec<f64>,
    /// Part that the exported controller has.
    pub law: ScheduleLaw,
}

/// Part of a schedule that the exported controller has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ScheduleLaw {
    /// The gain law where it stands in for every redesign, else the redesigns, interpolated.
    Auto,
    /// The gain law.
    Gain,
    /// The redesigns, interpolated.
    Redesign,
}

/// Options of the estimation of the out-of-balance from the control.
#[derive(Debug, Clone, PartialEq)]
pub struct AdaptationOptions {
    /// Method.
    pub method: AdaptationMethod,
    /// Window of the mean, s.
    pub window_s: f64,
    /// Forgetting time of least squares, s.
    pub memory_s: f64,
    /// RMS of the platform's acceleration below which least squares stand still, m/s^2; `None` for what friction demands.
    pub dead_band_m_s2: Option<f64>,
    /// Lag that control and regressors of least squares pass, s.
    pub filter_s: f64,
    /// Share of the design's out-of-balance by which the estimate of least squares may differ before it is followed; `None` for the usual one.
    pub hold_band: Option<f64>,
    /// Normalised step of the gradient, 0 to 2.
    pub step: f64,
    /// Rate at which the sign of a rate counts half, rad/s.
    pub half_rate_rad_s: f64,
    /// Largest change of the estimate, kg m/s.
    pub rate_limit_kg_m_s: f64,
    /// The runs in which it is tried.
    pub trial: AdaptationRuns,
    /// The use of the adaptation in the exported controller.
    pub use_in_code: AdaptationUse,
}

impl AdaptationOptions {
    /// Returns the adaptation of a project that states none of its values.
    pub fn usual() -> Self {
        Self {
            method: AdaptationMethod::Recursive,
            window_s: 1.0,
            // With 2 s the noise of the estimate raises the hub rate by 4 % on a road; with 8 s by 1 %, and a change of 30 % is still
            // followed within 20 s (`counterpoise adapt`).
            memory_s: 8.0,
            dead_band_m_s2: None,
            filter_s: 0.02,
            hold_band: None,
            step: 0.002,
            half_rate_rad_s: 5e-3,
            rate_limit_kg_m_s: 400.0,
            trial: AdaptationRuns {
                duration_s: 40.0,
                changes: vec![1.0, 0.5, 1.25, 0.75],
                amplifier_curve: Vec::new(),
            },
            use_in_code: AdaptationUse::Exported,
        }
    }
}

/// Use of the adaptation in the exported controller.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AdaptationUse {
    /// The exported controller adapts.
    Exported,
    /// The exported controller does not adapt: the trials of the project leave no motion on which an adaptation helps.
    LeftOut,
}

/// Methods of adaptation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AdaptationMethod {
    /// A normalised gradient.
    Gradient,
    /// The mean of the control over a window.
    WindowedMean,
    /// Recursive least squares with forgetting.
    Recursive,
}

/// The runs in which the adaptation is tried.
#[derive(Debug, Clone, PartialEq)]
pub struct AdaptationRuns {
    /// Length of a run, s.
    pub duration_s: f64,
    /// Factors on the out-of-balance, one for each equal part of the run.
    pub changes: Vec<f64>,
    /// Gain curve of another amplifier, [control V, equivalent V]; empty for the plant's own alone.
    pub amplifier_curve: Vec<[f64; 2]>,
}

/// Requirements, and how far the search goes.
#[derive(Debug, Clone, PartialEq)]
pub struct WeightSearch {
    /// Limits that the sampled loop must keep.
    pub requirements: Requirements,
    /// Most designs that are tried for one answer.
    pub trials: usize,
    /// Limits of the sensitivity at which the trade-off curve has its points.
    pub ms_limits: Vec<f64>,
}

impl NamedChoice for SynthesisMethod {
    const NAMES: &'static [(&'static str, Self)] = &[
        ("three-part", Self::ThreePart),
        ("joint-h2", Self::JointH2),
        ("lqg-ltr", Self::LqgLtr),
        ("h-infinity", Self::HInfinity),
    ];
}

impl NamedChoice for BandSpectrum {
    const NAMES: &'static [(&'static str, Self)] = &[("flat", Self::Flat), ("expected", Self::Expected)];
}

impl NamedChoice for Drives {
    const NAMES: &'static [(&'static str, Self)] =
        &[("measured-rate", Self::MeasuredRate), ("demand", Self::Demand)];
}

impl NamedChoice for ObserverFriction {
    const NAMES: &'static [(&'static str, Self)] = &[("dahl", Self::Dahl), ("plant", Self::OwnLaw)];
}

impl NamedChoice for Compensation {
    const NAMES: &'static [(&'static str, Self)] = &[("leave", Self::Absent), ("undo", Self::Applied)];
}

impl NamedChoice for ScheduleLaw {
    const NAMES: &'static [(&'static str, Self)] =
        &[("auto", Self::Auto), ("gain", Self::Gain), ("redesign", Self::Redesign)];
}

impl NamedChoice for AdaptationMethod {
    const NAMES: &'static [(&'static str, Self)] = &[
        ("gradient", Self::Gradient),
        ("windowed-mean", Self::WindowedMean),
        ("recursive", Self::Recursive),
    ];
}

impl Default for SynthesisOptions {
    /// Returns the three-part design as it is.
    fn default() -> Self {
        Self {
            method: SynthesisMethod::ThreePart,
            alternatives: Vec::new(),
            controller_order: None,
            prefilter: None,
            amplifier_curve: Compensation::Absent,
            sensor_errors: Compensation::Absent,
            observer: None,
            schedule: None,
            adaptation: None,
            search: None,
            front: None,
            structure: FixedStructure::default(),
            imported: None,
            tuning: None,
        }
    }
}

const ABOVE_0: NumberRange = NumberRange::Above(0.0);
const AT_LEAST_0: NumberRange = NumberRange::AtLeast(0.0);

/// Reads or lists the keys of `[synth]` that are not the three parts'.
pub(crate) fn keys(v: &mut dyn Visit, options: &mut SynthesisOptions) {
    let method = Field::new("method", "method of the feedback that is built").or_text("three-part");
    choose(v, &method, &mut options.method);
    methods(v, &mut options.alternatives);
    let mut order = options.controller_order.unwrap_or(0);
    let field = Field::new("controller_order", "number of states that the feedback keeps; 0 keeps all");
    count(v, &field.limit(NumberRange::Between(0.0, 1000.0)).or(0.0), &mut order);
    options.controller_order = (order > 0).then_some(order);
    let curve = "the gain curve `plant.amplifier.map` (in `adapt`, that of the trial): `undo` makes its inverse the last step of the controller";
    choose(v, &Field::new("amplifier_curve", curve).or_text("leave"), &mut options.amplifier_curve);
    let errors = "gain and bias of `plant.sensors`: `undo` corrects the readings by them and designs for sensors without them";
    choose(v, &Field::new("sensor_errors", errors).or_text("leave"), &mut options.sensor_errors);
}

/// Reads or lists the tables of `[synth]` that are not the three parts'.
pub(crate) fn tables(v: &mut dyn Visit, options: &mut SynthesisOptions) {
    let section = TableField::optional("prefilter", "filter of the demand before the controller");
    visit_optional(v, &section, &mut options.prefilter, blank_weight(), prefilter);
    let section = TableField::optional("observer", "nonlinear observer that cancels dry friction");
    visit_optional(v, &section, &mut options.observer, blank_observer(), observer);
    let section = TableField::optional("schedule", "designs for several states of out-of-balance");
    visit_optional(v, &section, &mut options.schedule, blank_schedule(), schedule);
    let section = TableField::optional("adaptation", "estimation of the out-of-balance from the control");
    visit_optional(v, &section, &mut options.adaptation, AdaptationOptions::usual(), adaptation);
    let section = TableField::optional("search", "requirements from which weights are searched");
    visit_optional(v, &section, &mut options.search, blank_search(), search);
    let section =
        TableField::optional("front", "what `synth --search` trades between designs, and under which limits");
    visit_optional(v, &section, &mut options.front, FrontOptions::default(), front);
    blocks(v, &mut options.structure.blocks);
    let section = TableField::optional(
        "controller",
        "a feedback that was made elsewhere, which takes the place of the H2 feedback",
    );
    visit_optional(v, &section, &mut options.imported, ImportedController::default(), imported_controller);
    let section =
        TableField::optional("tune", "what the open parameters of the blocks, or the weights, are tuned for");
    visit_optional(v, &section, &mut options.tuning, TuningOptions::default(), tuning);
}

fn methods(v: &mut dyn Visit, methods: &mut Vec<SynthesisMethod>) {
    let mut names: Vec<String> = methods.iter().map(|m| m.name().to_owned()).collect();
    let meaning = "further methods of the feedback, shown for comparison with the same figures";
    v.texts(&Field::new("alternatives", meaning).or_empty(), &mut names);
    let known = |name: &String| SynthesisMethod::NAMES.iter().find(|(n, _)| n == name).map(|(_, m)| *m);
    if let Some(unknown) = names.iter().find(|name| known(name).is_none()) {
        let hint = crate::diagnostic::did_you_mean(unknown, SynthesisMethod::NAMES.iter().map(|(n, _)| *n));
        let allowed = "may hold \"three-part\", \"joint-h2\", \"lqg-ltr\" and \"h-infinity\"";
        v.complain("alternatives", allowed, hint);
    }
    *methods = names.iter().filter_map(known).collect();
}

fn prefilter(v: &mut dyn Visit, filter: &mut Weight) {
    weight(v, filter);
    let rational = filter.rational();
    if rational.relative_degree() < 0 || rational.poles.iter().any(|pole| pole.re >= 0.0) {
        v.complain("form", "must have no more zeros than poles, and all poles in the left half plane", None);
    }
}

fn blank_observer() -> ObserverOptions {
    ObserverOptions {
        drives: Drives::MeasuredRate,
        share: 1.0,
        motor: None,
        pivot: None,
        model: ObserverFriction::Dahl,
        sign_rate_rad_s: 5e-3,
        learning: None,
    }
}

fn level_learning(v: &mut dyn Visit, learning: &mut LevelLearning) {
    let lowest = Field::new("lowest", "lowest level over the stated one, and the level at the start");
    v.number(&lowest.limit(NumberRange::Between(0.0, 1.0)).or(0.5), &mut learning.lowest);
    let highest = Field::new("highest", "highest level over the stated one");
    v.number(&highest.limit(NumberRange::AtLeast(1.0)).or(2.0), &mut learning.highest);
    let time = "time constant of the learning while the friction slides; a level that is wrong by half is put right within about ten of them";
    v.number(
        &Field::new("time_constant", time).unit("s").limit(ABOVE_0).or(0.3),
        &mut learning.time_constant_s,
    );
    let rate = "rate above which the friction slides for certain";
    let rate = Field::new("sliding_rate", rate).unit("rad/s").limit(ABOVE_0);
    v.number(&rate.or(0.01), &mut learning.sliding_rate_rad_s);
}

fn blank_learning() -> LevelLearning {
    LevelLearning { lowest: 0.5, highest: 2.0, time_constant_s: 0.3, sliding_rate_rad_s: 0.01 }
}

fn observer(v: &mut dyn Visit, observer: &mut ObserverOptions) {
    let drives = "the rate that drives the friction model: measured (feedback) or demanded (feedforward)";
    choose(v, &Field::new("drives", drives).or_text("measured-rate"), &mut observer.drives);
    let share =
        Field::new("share", "fraction of the level that is cancelled").limit(NumberRange::Between(0.0, 1.0));
    v.number(&share.or(1.0).show_default(), &mut observer.share);
    let law = "the law by which the plant's friction is followed: Dahl's law with its level and stiffness, or its own";
    choose(v, &Field::new("law", law).or_text("dahl"), &mut observer.model);
    let sign = Field::new("sign_rate", "rate over which the sign of a law with true sticking is smoothed")
        .unit("rad/s");
    v.number(&sign.limit(ABOVE_0).or(5e-3), &mut observer.sign_rate_rad_s);
    let learning =
        TableField::optional("learning", "the level that is really there is learnt from the feedback");
    visit_optional(v, &learning, &mut observer.learning, blank_learning(), level_learning);
    let motor = "identified friction at the motor shaft, with its own law; if absent, the plant's";
    let motor = TableField::optional("motor", motor);
    visit_optional(v, &motor, &mut observer.motor, blank_identified(), identified_friction);
    let pivot = "identified friction at the pivot, with its own law; if absent, the plant's";
    let pivot = TableField::optional("pivot", pivot);
    visit_optional(v, &pivot, &mut observer.pivot, blank_identified(), identified_friction);
}

fn blank_schedule() -> ScheduleOptions {
    ScheduleOptions { configurations: Vec::new(), factors: Vec::new(), law: ScheduleLaw::Auto }
}

fn schedule(v: &mut dyn Visit, schedule: &mut ScheduleOptions) {
    let names =
        "names of the plant's configurations: their masses change inertia and out-of-balance together";
    v.texts(&Field::new("configurations", names).or_empty(), &mut schedule.configurations);
    let factors =
        Field::new("factors", "factors on the out-of-balance alone; the inertia stays").limit(AT_LEAST_0);
    v.numbers(&factors.or_empty(), Count::AtLeastOne, &mut schedule.factors);
    choose(
        v,
        &Field::new("law", "the law that the exported controller uses").or_text("auto"),
        &mut schedule.law,
    );
    if schedule.configurations.is_empty() && schedule.factors.is_empty() {
        v.complain("configurations", "must name a configuration where there are no factors", None);
    }
}

fn adaptation(v: &mut dyn Visit, a: &mut AdaptationOptions) {
    let usual = AdaptationOptions::usual();
    let method = "method of the estimator, which is part of the exported code";
    choose(v, &Field::new("method", method).or_text("recursive").show_default(), &mut a.method);
    match a.method {
        AdaptationMethod::Gradient => {
            let step = Field::new("step", "normalised step").limit(NumberRange::AboveTo(0.0, 1.9));
            v.number(&step.or(usual.step), &mut a.step);
        }
        AdaptationMethod::WindowedMean => {
            let window = Field::new("window", "length of the window over which the control is averaged")
                .unit("s")
                .limit(ABOVE_0);
            v.number(&window.or(usual.window_s), &mut a.window_s);
        }
        AdaptationMethod::Recursive => {
            let memory = Field::new("memory", "time constant of forgetting").unit("s").limit(ABOVE_0);
            v.number(&memory.or(usual.memory_s), &mut a.memory_s);
            let band = "RMS of the platform's acceleration below which the estimate is not changed; without it, and without `hold_band`, trials choose both so that no trial is worse than without adaptation";
            maybe_number(
                v,
                &Field::new("dead_band", band).unit("m/s^2").limit(AT_LEAST_0),
                &mut a.dead_band_m_s2,
            );
            let filter = "lag by which control and regressors are filtered, so that accelerations are known; 0 for none";
            let filter = Field::new("filter", filter).unit("s").limit(AT_LEAST_0);
            v.number(&filter.or(usual.filter_s), &mut a.filter_s);
            let hold = "share of the design's out-of-balance by which the estimate may differ before it is followed; chosen by the same trials, else 0.04";
            maybe_number(
                v,
                &Field::new("hold_band", hold).limit(NumberRange::Between(0.0, 1.0)),
                &mut a.hold_band,
            );
        }
    }
    if a.method != AdaptationMethod::WindowedMean {
        let half = Field::new("half_rate", "rate at which the sign of the rate counts half").unit("rad/s");
        v.number(&half.limit(ABOVE_0).or(usual.half_rate_rad_s), &mut a.half_rate_rad_s);
        let limit = Field::new("rate_limit", "largest rate of change of the estimate").unit("kg m/s");
        v.number(&limit.limit(ABOVE_0).or(usual.rate_limit_kg_m_s), &mut a.rate_limit_kg_m_s);
    }
    table(v, &TableField::optional("trial", "the runs of `adapt`"), &mut a.trial, trial);
}

fn trial(v: &mut dyn Visit, trial: &mut AdaptationRuns) {
    let usual = AdaptationOptions::usual().trial;
    let duration = Field::new("duration", "length of a run of `adapt`").unit("s").limit(ABOVE_0);
    v.number(&duration.or(usual.duration_s), &mut trial.duration_s);
    let changes = "factors on the out-of-balance, one for each equal part of a run";
    v.numbers(
        &Field::new("changes", changes).limit(AT_LEAST_0).or_empty(),
        Count::AtLeastOne,
        &mut trial.changes,
    );
    if trial.changes.is_empty() {
        trial.changes = usual.changes;
    }
    let curve = Field::new(
        "amplifier_curve",
        "gain curve of the runs with a nonlinear amplifier: control voltage and equivalent voltage",
    );
    v.pairs(&curve.units("V", "V").or_empty(), &mut trial.amplifier_curve);
}

fn blank_search() -> WeightSearch {
    WeightSearch { requirements: Requirements::thesis(), trials: 300, ms_limits: Vec::new() }
}

fn search(v: &mut dyn Visit, search: &mut WeightSearch) {
    let usual = Requirements::thesis();
    let asked = &mut search.requirements;
    let margin = Field::new("gain_margin", "lowest gain margin").unit("dB").limit(AT_LEAST_0);
    v.number(&margin.or(usual.gain_margin_db), &mut asked.gain_margin_db);
    let margin = Field::new("phase_margin", "lowest phase margin").unit("degrees").limit(AT_LEAST_0);
    v.number(&margin.or(usual.phase_margin_deg), &mut asked.phase_margin_deg);
    let overshoot = Field::new("overshoot", "largest overshoot of a step, as a fraction of the step");
    v.number(&overshoot.limit(AT_LEAST_0).or(usual.overshoot), &mut asked.overshoot);
    let crossover = Field::new("crossover", "lowest crossover frequency").unit("rad/s").limit(AT_LEAST_0);
    v.number(&crossover.or(usual.crossover_rad_s), &mut asked.crossover_rad_s);
    visit_limit(v, &Field::new("max_sensitivity", "largest sensitivity"), &mut asked.ms);
    let control = Field::new("step_control", "largest control after a unit step").unit("V s/rad");
    visit_limit(v, &control, &mut asked.step_control_v);
    let gain = Field::new("noise_gain", "largest RMS control for noise of unit RMS").unit("V s/rad");
    visit_limit(v, &gain, &mut asked.noise_gain);
    let field = Field::new("band", "lower and upper end of the band over which rejection is wanted")
        .unit("rad/s")
        .limit(ABOVE_0);
    pair(v, &field.or_empty(), &mut asked.band_rad_s);
    if asked.band_rad_s[0] >= asked.band_rad_s[1] {
        v.complain("band", "must rise", None);
    }
    let spectrum = "weight of the average of the rejection: the same over the band, or the rate that the expected heave and pitch cause";
    choose(v, &Field::new("spectrum", spectrum).or_text("flat"), &mut asked.spectrum);
    let trials = Field::new("trials", "largest number of designs that are tried for one answer");
    count(v, &trials.limit(NumberRange::Between(1.0, 100_000.0)).or(300.0), &mut search.trials);
    let limits =
        Field::new("trade_off", "limits of the largest sensitivity, one for each point of the trade-off");
    v.numbers(&limits.limit(NumberRange::Above(1.0)).or_empty(), Count::AtLeastOne, &mut search.ms_limits);
}

/// A limit that is infinite if it is not written.
fn visit_limit(v: &mut dyn Visit, field: &Field, value: &mut f64) {
    let mut slot = value.is_finite().then_some(*value);
    maybe_number(v, &field.limit(ABOVE_0), &mut slot);
    *value = slot.unwrap_or(f64::INFINITY);
}
