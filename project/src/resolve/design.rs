//! The `[reduce]`, `[synth]` and `[export]` sections: what is asked of the design and of its code.

use counterpoise_controller::sensitivity::RealisationForm;
use counterpoise_controller::words::is_word;
use counterpoise_export::{CodeOptions, Precision};
use counterpoise_linalg::sparse::VectorEntry;
use counterpoise_lti::{Discretisation, Timebase};
use counterpoise_models::plant::LinearPlant;
use counterpoise_models::{AxisKind, FeedbackSignal};
use counterpoise_synth::{
    Assembly, DisturbanceKnowledge, FeedbackWeights, FeedforwardBasis, FeedforwardWeights, LightModes,
    Reference, SamplingMethod,
};

use super::cascade;
use super::fixed_structure::{TunedWeights, TuningOptions};
use super::model::count;
use super::synthesis::{DesignRequest, WeightSource, blank_feedback, blank_feedforward};
use super::synthesis_options::{self, SynthesisOptions};
use super::weight::weight;
use crate::file::field::{Field, NumberRange, TableField};
use crate::file::visit::{NamedChoice, Visit, choose, maybe_number, table, visit_optional};

/// Options of the reduction of the plant before the design.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ReductionOptions {
    /// Method.
    pub method: ReductionMethod,
    /// States that are kept; `None` leaves the choice to the method.
    pub order: Option<usize>,
}

/// Methods of reduction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ReductionMethod {
    /// The plant as it is.
    None,
    /// States that are neither controllable nor observable are removed.
    Minimal,
    /// Fast modes are removed.
    Modal,
    /// Guyan's condensation of the structure.
    Guyan,
    /// Balanced truncation.
    Balanced,
}

/// Code that an export generates.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ExportRequest {
    /// Languages.
    pub languages: Vec<Language>,
    /// Name and precision.
    pub options: CodeOptions,
}

/// Languages of generated code.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Language {
    /// C of 1999.
    C99,
    /// Rust without its standard library.
    Rust,
    /// C of 1999 in 32-bit fixed point, under NAME_fixed.
    Fixed,
    /// FMI 3.0 co-simulation units of the controller, NAME_unit, and of the plant, NAME_plant.
    Fmi,
}

impl NamedChoice for ReductionMethod {
    const NAMES: &'static [(&'static str, Self)] = &[
        ("none", Self::None),
        ("minimal", Self::Minimal),
        ("modal", Self::Modal),
        ("guyan", Self::Guyan),
        ("balanced", Self::Balanced),
    ];
}

impl NamedChoice for LightModes {
    const NAMES: &'static [(&'static str, Self)] = &[("kept", Self::Kept), ("stiffened", Self::Stiffened)];
}

impl NamedChoice for Assembly {
    const NAMES: &'static [(&'static str, Self)] =
        &[("simple-add", Self::SimpleAdd), ("grimble", Self::Grimble), ("joint", Self::Joint)];
}

impl NamedChoice for Reference {
    const NAMES: &'static [(&'static str, Self)] =
        &[("error", Self::Error), ("weight-only", Self::WeightOnly)];
}

impl NamedChoice for Language {
    const NAMES: &'static [(&'static str, Self)] =
        &[("c99", Self::C99), ("rust", Self::Rust), ("fixed", Self::Fixed), ("fmi", Self::Fmi)];
}

impl NamedChoice for Precision {
    const NAMES: &'static [(&'static str, Self)] = &[("double", Self::Double), ("single", Self::Single)];
}

impl NamedChoice for RealisationForm {
    const NAMES: &'static [(&'static str, Self)] =
        &[("least-sensitive", Self::LeastSensitive), ("modal", Self::Modal), ("balanced", Self::Balanced)];
}

/// The discretisation of a controller, by name.
#[derive(Debug, Clone, Copy, PartialEq)]
enum SamplingName {
    Tustin,
    ZeroOrderHold,
    FirstOrderHold,
    Matched,
    SampledData,
}

impl NamedChoice for SamplingName {
    const NAMES: &'static [(&'static str, Self)] = &[
        ("tustin", Self::Tustin),
        ("zero-order-hold", Self::ZeroOrderHold),
        ("first-order-hold", Self::FirstOrderHold),
        ("matched", Self::Matched),
        ("sampled-data", Self::SampledData),
    ];
}

/// The knowledge of a feedforward, by name.
#[derive(Debug, Clone, Copy, PartialEq)]
enum FeedforwardKnowledge {
    Exact,
    Measured,
}

impl NamedChoice for FeedforwardKnowledge {
    const NAMES: &'static [(&'static str, Self)] = &[("exact", Self::Exact), ("measured", Self::Measured)];
}

const AT_LEAST_0: NumberRange = NumberRange::AtLeast(0.0);

impl Default for ReductionOptions {
    fn default() -> Self {
        Self { method: ReductionMethod::None, order: None }
    }
}

impl Default for ExportRequest {
    fn default() -> Self {
        Self { languages: vec![Language::C99], options: CodeOptions::double("controller") }
    }
}

/// Reads or lists the reduction.
pub(crate) fn reduce(v: &mut dyn Visit, reduce: &mut ReductionOptions) {
    choose(
        v,
        &Field::new("method", "how the plant is reduced").or_text("none").show_default(),
        &mut reduce.method,
    );
    let mut order = reduce.order.unwrap_or(0);
    count(
        v,
        &Field::new("order", "number of states that are kept; 0 lets the method choose")
            .limit(NumberRange::Between(0.0, 10_000.0))
            .or(0.0),
        &mut order,
    );
    reduce.order = (order > 0).then_some(order);
}

/// Reads or lists the design of a loop whose sensor measures a rate or a position.
pub(crate) fn synth(v: &mut dyn Visit, synth: &mut DesignRequest, measured: FeedbackSignal, axis: AxisKind) {
    cascade::loop_kind(v, synth, measured);
    cascade::rate_limit(v, synth, axis);
    assembly_and_form(v, synth);
    weights(v, synth);
    synthesis_options::tables(v, &mut synth.options);
    let specification = &synth.specification;
    if specification.assembly != Assembly::SimpleAdd {
        let apart =
            |part: &FeedforwardWeights| part.output.is_some() || part.basis == FeedforwardBasis::ClosedLoop;
        if [&specification.heave, &specification.pitch].into_iter().flatten().any(apart) {
            let allowed =
                "must be \"simple-add\" where a feedforward weighs the tip or is designed on the closed loop";
            v.complain("assembly", allowed, None);
        }
    }
    if synth.discretisation == SamplingMethod::SampledData {
        sampled_problem_exists(v, &synth.options);
    }
    if synth.specification.assembly == Assembly::Joint {
        joint_problem_exists(v, synth);
    }
    if synth.specification.feedback.modes == LightModes::Stiffened {
        modes_can_be_stiffened(v, synth);
    }
    cascade::problem_exists(v, synth);
    fixed_feedback_stands_alone(v, synth);
}

/// Reads or lists how the controller is put together, sampled and run.
fn assembly_and_form(v: &mut dyn Visit, synth: &mut DesignRequest) {
    let asked = "bandwidth that chosen weights aim at (lowest frequency at which the loop's gain falls to 1); only without \
                 `[synth.feedback]`, which states weights";
    let bandwidth = Field::new("bandwidth", asked).unit("rad/s").limit(NumberRange::Above(0.0));
    maybe_number(v, &bandwidth, &mut synth.bandwidth_rad_s);
    let specification = &mut synth.specification;
    choose(
        v,
        &Field::new("assembly", "how feedback and feedforward are put together")
            .or_text("simple-add")
            .show_default(),
        &mut specification.assembly,
    );
    choose(
        v,
        &Field::new("reference", "where the demand enters the controller").or_text("error").show_default(),
        &mut specification.reference,
    );
    let delay = Field::new("delay_samples", "delay of the plant that is designed for, in sample periods")
        .limit(NumberRange::Between(0.0, 100.0));
    v.number(&delay.or(1.0).show_default(), &mut synth.delay_samples);
    count(
        v,
        &Field::new("pade_order", "order of the Pade approximation of the delay")
            .limit(NumberRange::Between(0.0, 8.0))
            .or(2.0)
            .show_default(),
        &mut synth.pade_order,
    );
    discretisation(v, &mut synth.discretisation);
    let form = Field::new("realisation", "form in which the controller runs").or_text("least-sensitive");
    choose(v, &form, &mut synth.form);
    let transfer = Field::new("transfer_time", "time in which a changed out-of-balance fades in")
        .unit("s")
        .limit(AT_LEAST_0);
    v.number(&transfer.or(0.0), &mut synth.transfer_time_s);
    synthesis_options::keys(v, &mut synth.options);
}

/// Reads or lists the weights of feedback and feedforward.
fn weights(v: &mut dyn Visit, synth: &mut DesignRequest) {
    let specification = &mut synth.specification;
    let mut stated = (synth.weights != WeightSource::Chosen).then(|| specification.feedback.clone());
    let section = "weights of the feedback; without them, weights are chosen for the highest bandwidth";
    visit_optional(v, &TableField::optional("feedback", section), &mut stated, blank_feedback(), feedback);
    if let Some(stated) = stated {
        specification.feedback = stated;
        if synth.weights == WeightSource::Chosen {
            synth.weights = WeightSource::Stated;
        }
        cascade::with_stated_weights(v, synth.loop_kind, specification.position_gain);
        if synth.bandwidth_rad_s.is_some() {
            let allowed = "must not be given together with [synth.feedback]: a bandwidth is for weights that are chosen";
            v.complain("bandwidth", allowed, Some("remove one of the two".to_owned()));
        }
    }
    let heave = TableField::optional("heave", "weights of the feedforward from heave");
    visit_optional(v, &heave, &mut specification.heave, blank_feedforward(), |v, part| {
        feedforward(v, part, "(m/s^2)^2 s")
    });
    let pitch = TableField::optional("pitch", "weights of the feedforward from pitch");
    visit_optional(v, &pitch, &mut specification.pitch, blank_feedforward(), |v, part| {
        feedforward(v, part, "(rad/s)^2 s")
    });
}

/// Complains if weights are to be tuned of a feedback that has none, and if there is nothing to tune.
fn weights_can_be_tuned(v: &mut dyn Visit, synth: &DesignRequest, tuning: &TuningOptions) {
    let specification = &synth.specification;
    let problem = match tuning.weights {
        TunedWeights::Stated | TunedWeights::Tuned => return,
        TunedWeights::ToTune if synth.options.method != counterpoise_synth::SynthesisMethod::ThreePart => {
            "can tune the weights of method = \"three-part\" alone"
        }
        TunedWeights::ToTune if specification.assembly == Assembly::Joint => {
            "cannot tune the weights of assembly = \"joint\", where one problem holds all parts"
        }
        TunedWeights::ToTune if specification.reference != Reference::Error => {
            "needs reference = \"error\" to tune weights"
        }
        TunedWeights::ToTune if specification.position_gain.is_some() => {
            "cannot tune the weights of a cascade: state them, or leave them out"
        }
        TunedWeights::ToTune => return,
    };
    v.complain("tune", problem, Some("add [[synth.block]] tables, or remove [synth.tune]".to_owned()));
}

/// Complains where a feedback of fixed structure, or one that was made elsewhere, is asked for together with what makes or changes
/// another feedback.
fn fixed_feedback_stands_alone(v: &mut dyn Visit, synth: &DesignRequest) {
    let (options, specification) = (&synth.options, &synth.specification);
    let (section, remedy) = match (&options.imported, options.structure.blocks.is_empty()) {
        (Some(_), true) => ("[synth.controller]", "remove [synth.controller], or change this key"),
        (None, false) => ("[[synth.block]]", "remove the blocks, or change this key"),
        (Some(_), false) => {
            let problem = "must not stand beside [[synth.block]]: both make the feedback";
            v.complain("controller", problem, Some("remove one of the two".to_owned()));
            return;
        }
        (None, true) => {
            if let Some(tuning) = &options.tuning {
                weights_can_be_tuned(v, synth, tuning);
            }
            return;
        }
    };
    let tustin = matches!(synth.discretisation, SamplingMethod::Emulation(Discretisation::Tustin { .. }));
    let on_closed_loop = |part: &FeedforwardWeights| part.basis == FeedforwardBasis::ClosedLoop;
    let feedforwards = [&specification.heave, &specification.pitch];
    let tunes_weights = options.tuning.as_ref().is_some_and(|tuning| tuning.weights == TunedWeights::ToTune);
    let apart = [
        (
            options.method != counterpoise_synth::SynthesisMethod::ThreePart,
            "method",
            "must be \"three-part\"",
        ),
        (options.controller_order.is_some(), "controller_order", "must be absent"),
        (tunes_weights, "tune", "must not have weights = \"tune\""),
        (specification.assembly == Assembly::Joint, "assembly", "must not be \"joint\""),
        (specification.reference != Reference::Error, "reference", "must be \"error\""),
        (!tustin, "discretisation", "must be \"tustin\", which keeps the feedback's meaning,"),
        (
            feedforwards.into_iter().flatten().any(on_closed_loop),
            "basis",
            "must be \"open-loop\" in every feedforward",
        ),
    ];
    for (_, key, allowed) in apart.into_iter().filter(|(is_asked, ..)| *is_asked) {
        let problem = format!("{allowed} where {section} makes the feedback");
        v.complain(key, &problem, Some(remedy.to_owned()));
    }
    imported_can_run(v, synth);
}

/// Complains of what a feedback that was made elsewhere cannot be together with.
fn imported_can_run(v: &mut dyn Visit, synth: &DesignRequest) {
    let Some(imported) = &synth.options.imported else { return };
    if synth.options.tuning.is_some() {
        let problem = "must be absent where [synth.controller] makes the feedback: nothing of it is open";
        v.complain("tune", problem, Some("remove one of the two sections".to_owned()));
    }
    let is_sampled = imported.system.as_ref().is_some_and(|system| system.timebase != Timebase::Continuous);
    let is_prewarped = matches!(
        synth.discretisation,
        SamplingMethod::Emulation(Discretisation::Tustin { prewarp_rad_s: Some(_) })
    );
    if is_sampled && is_prewarped {
        let problem = "must be absent where [synth.controller] is in sampled time: it runs as it is";
        v.complain("prewarp", problem, Some("remove this key".to_owned()));
    }
}

/// Complains where a joint design is asked for together with what takes feedback or feedforward apart.
fn joint_problem_exists(v: &mut dyn Visit, synth: &DesignRequest) {
    let options = &synth.options;
    let apart = [
        (options.method != counterpoise_synth::SynthesisMethod::ThreePart, "`method`"),
        (options.controller_order.is_some(), "`controller_order`"),
        (options.schedule.is_some(), "[synth.schedule]"),
        (synth.discretisation == SamplingMethod::SampledData, "`discretisation` = \"sampled-data\""),
    ];
    for (_, what) in apart.into_iter().filter(|(is_asked, _)| *is_asked) {
        let problem = format!("must not be \"joint\" with {what}: the joint design is one controller");
        v.complain("assembly", &problem, Some("use \"simple-add\"".to_owned()));
    }
}

/// Complains where modes are stiffened for a feedback that must know the plant as it is.
fn modes_can_be_stiffened(v: &mut dyn Visit, synth: &DesignRequest) {
    if synth.may_stiffen_modes() {
        return;
    }
    let problem = "must be \"kept\" but with method = \"three-part\", assembly = \"simple-add\", a discretisation that converts the controller, and \
                   without [synth.schedule]";
    v.complain("feedback.modes", problem, Some("remove the key".to_owned()));
}

/// Complains where a feedback that is not the three-part one is to be designed in sampled time.
fn sampled_problem_exists(v: &mut dyn Visit, options: &SynthesisOptions) {
    let problem = if options.method != counterpoise_synth::SynthesisMethod::ThreePart {
        "must not be \"sampled-data\" with another `method`: only the three-part design has a sampled problem"
    } else if options.controller_order.is_some() {
        "must not be \"sampled-data\" with `controller_order`: a feedback of lower order is converted, not designed anew"
    } else {
        return;
    };
    v.complain("discretisation", problem, Some("use \"tustin\"".to_owned()));
}

const SAMPLED_HOW: &str = "how the controller is sampled: each path is converted, or (`sampled-data`) all paths are designed for the sampled plant, with \
     hold and `output_delay_samples` exact and `delay_samples` unused";

fn discretisation(v: &mut dyn Visit, method: &mut SamplingMethod) {
    let (mut name, mut prewarp_rad_s) = match *method {
        SamplingMethod::SampledData => (SamplingName::SampledData, None),
        SamplingMethod::Emulation(conversion) => match conversion {
            Discretisation::Tustin { prewarp_rad_s } => (SamplingName::Tustin, prewarp_rad_s),
            Discretisation::ZeroOrderHold => (SamplingName::ZeroOrderHold, None),
            Discretisation::FirstOrderHold => (SamplingName::FirstOrderHold, None),
            Discretisation::Matched => (SamplingName::Matched, None),
        },
    };
    choose(v, &Field::new("discretisation", SAMPLED_HOW).or_text("tustin").show_default(), &mut name);
    *method = match name {
        SamplingName::Tustin => {
            let field =
                Field::new("prewarp", "frequency at which the sampled and the continuous controller agree")
                    .unit("rad/s")
                    .limit(NumberRange::Above(0.0));
            maybe_number(v, &field, &mut prewarp_rad_s);
            SamplingMethod::Emulation(Discretisation::Tustin { prewarp_rad_s })
        }
        SamplingName::ZeroOrderHold => SamplingMethod::Emulation(Discretisation::ZeroOrderHold),
        SamplingName::FirstOrderHold => SamplingMethod::Emulation(Discretisation::FirstOrderHold),
        SamplingName::Matched => SamplingMethod::Emulation(Discretisation::Matched),
        SamplingName::SampledData => SamplingMethod::SampledData,
    };
}

const STIFFENED: &str = "the lightly damped modes in the plant that the feedback is designed on: as they are, or far quicker and well damped, as if the structure were \
                         much stiffer: the observer then follows none of them; the loop is judged on the plant as it is";

fn feedback(v: &mut dyn Visit, feedback: &mut FeedbackWeights) {
    let noise = Field::new("measurement_noise", "spectral density of the noise of the measured rate")
        .unit("(rad/s)^2 s");
    v.number(&noise.limit(NumberRange::Above(0.0)), &mut feedback.measurement_noise);
    let recovery =
        Field::new("loop_recovery", "spectral density of a fictitious noise on the control").unit("V^2 s");
    v.number(&recovery.limit(AT_LEAST_0).or(0.0), &mut feedback.loop_recovery);
    let modes = Field::new("modes", STIFFENED).or_text("kept");
    choose(v, &modes, &mut feedback.modes);
    visit_indexed_values(v, &DISTURBANCES, &mut feedback.disturbances);
    visit_indexed_values(v, &COMBINATION, &mut feedback.combination);
    table(v, &TableField::mandatory("error", "weight on the measured error"), &mut feedback.error, weight);
    table(v, &TableField::mandatory("control", "weight on the control"), &mut feedback.control, weight);
}

/// A key whose number belongs to an input or an output of the plant.
struct SignalField {
    field: Field,
    /// Index of the input or output.
    signal: usize,
}

/// Densities of white disturbances that no sensor announces, by the plant's inputs.
const DISTURBANCES: [SignalField; 3] = [
    SignalField {
        field: Field::new("control_disturbance", "spectral density of a disturbance at the control")
            .unit("V^2 s")
            .limit(AT_LEAST_0),
        signal: LinearPlant::CONTROL,
    },
    SignalField {
        field: Field::new("heave_disturbance", "spectral density of heave that is not measured")
            .unit("(m/s^2)^2 s")
            .limit(AT_LEAST_0),
        signal: LinearPlant::HEAVE,
    },
    SignalField {
        field: Field::new("pitch_disturbance", "spectral density of pitch that is not measured")
            .unit("(rad/s)^2 s")
            .limit(AT_LEAST_0),
        signal: LinearPlant::PITCH_RATE,
    },
];

/// Constant weights on further outputs, summed into one signal, by the plant's outputs.
const COMBINATION: [SignalField; 3] = [
    SignalField {
        field: Field::new("hub_weight", "constant weight on the hub rate"),
        signal: LinearPlant::HUB_RATE,
    },
    SignalField {
        field: Field::new("tip_weight", "constant weight on the tip rate, added to that on the hub rate"),
        signal: LinearPlant::TIP_RATE,
    },
    SignalField {
        field: Field::new(
            "motor_weight",
            "constant weight on the motor rate, added to those on hub and tip rate",
        ),
        signal: LinearPlant::MOTOR_RATE,
    },
];

/// Numbers by the index of a signal; those that are 0 are left out.
fn visit_indexed_values(v: &mut dyn Visit, fields: &[SignalField], values: &mut Vec<VectorEntry>) {
    let old = std::mem::take(values);
    for SignalField { field, signal } in fields {
        let mut value = old.iter().find(|entry| entry.index == *signal).map_or(0.0, |entry| entry.value);
        v.number(&field.or(0.0), &mut value);
        if value != 0.0 {
            values.push(VectorEntry::new(*signal, value));
        }
    }
}

/// The rate that a feedforward weighs, by name.
#[derive(Debug, Clone, Copy, PartialEq)]
enum WeightedRate {
    Hub,
    Tip,
}

impl NamedChoice for WeightedRate {
    const NAMES: &'static [(&'static str, Self)] = &[("hub", Self::Hub), ("tip", Self::Tip)];
}

impl NamedChoice for FeedforwardBasis {
    const NAMES: &'static [(&'static str, Self)] =
        &[("open-loop", Self::OpenLoop), ("closed-loop", Self::ClosedLoop)];
}

fn visit_weighted_output(v: &mut dyn Visit, part: &mut FeedforwardWeights) {
    let mut which =
        if part.output == Some(LinearPlant::TIP_RATE) { WeightedRate::Tip } else { WeightedRate::Hub };
    choose(
        v,
        &Field::new("output", "the rate that is weighted: that of the hub or of the tip").or_text("hub"),
        &mut which,
    );
    part.output = (which == WeightedRate::Tip).then_some(LinearPlant::TIP_RATE);
    let basis = Field::new("basis", "the plant that it is designed on: alone, or with the feedback closed");
    choose(v, &basis.or_text("open-loop"), &mut part.basis);
}

fn feedforward(v: &mut dyn Visit, part: &mut FeedforwardWeights, noise_unit: &'static str) {
    visit_weighted_output(v, part);
    let (mut known, mut noise) = match part.knowledge {
        DisturbanceKnowledge::Exact => (FeedforwardKnowledge::Exact, f64::NAN),
        DisturbanceKnowledge::Measured { noise } => (FeedforwardKnowledge::Measured, noise),
    };
    choose(
        v,
        &Field::new("knowledge", "what the feedforward knows of the disturbance").or_text("measured"),
        &mut known,
    );
    part.knowledge = match known {
        FeedforwardKnowledge::Exact => DisturbanceKnowledge::Exact,
        FeedforwardKnowledge::Measured => {
            let field = Field::new("measurement_noise", "spectral density of the noise of its sensor")
                .unit(noise_unit);
            v.number(&field.limit(NumberRange::Above(0.0)), &mut noise);
            DisturbanceKnowledge::Measured { noise }
        }
    };
    table(
        v,
        &TableField::mandatory("error", "weight on the rate that the disturbance would cause"),
        &mut part.error,
        weight,
    );
    table(
        v,
        &TableField::mandatory("control", "weight on the feedforward's control"),
        &mut part.control,
        weight,
    );
    table(
        v,
        &TableField::mandatory("generator", "weight whose square is the spectrum of the disturbance"),
        &mut part.generator,
        weight,
    );
}

/// Reads or lists what code is generated.
pub(crate) fn export(v: &mut dyn Visit, export: &mut ExportRequest) {
    let name = Field::new("name", "prefix of every name of the code").or_text("controller").show_default();
    v.text(&name, &mut export.options.name);
    if let Some(problem) = identifier(&export.options.name) {
        v.complain("name", problem, None);
    }
    choose(
        v,
        &Field::new("precision", "precision of the numbers on the target").or_text("double").show_default(),
        &mut export.options.precision,
    );
    languages(v, &mut export.languages);
}

fn languages(v: &mut dyn Visit, languages: &mut Vec<Language>) {
    let mut names: Vec<String> = languages.iter().map(|l| l.name().to_owned()).collect();
    v.texts(&Field::new("languages", "languages of the generated code").or_empty(), &mut names);
    let known = |name: &String| Language::NAMES.iter().find(|(n, _)| n == name).map(|(_, l)| *l);
    if let Some(unknown) = names.iter().find(|name| known(name).is_none()) {
        let hint = crate::diagnostic::did_you_mean(unknown, Language::NAMES.iter().map(|(n, _)| *n));
        v.complain("languages", "may hold \"c99\", \"rust\", \"fixed\" and \"fmi\"", hint);
    }
    *languages = names.iter().filter_map(known).collect();
    if languages.is_empty() {
        *languages = ExportRequest::default().languages;
    }
}

/// Longest name that generated code may start with: a language may add to it.
const LONGEST_NAME: usize = 18;

/// Returns what keeps a name from being a short lower-case identifier.
fn identifier(name: &str) -> Option<&'static str> {
    let plain = name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_');
    if !name.starts_with(|c: char| c.is_ascii_lowercase()) {
        Some("must start with a lower-case letter")
    } else if !plain {
        Some("may hold only a to z, 0 to 9 and _")
    } else if name.len() > LONGEST_NAME {
        Some("must not be longer than 18 characters")
    } else if is_word(name) {
        Some(
            "must not be a keyword of C, C++ or Rust, or a name that their tools have taken; \"axis_controller\" is one that is free",
        )
    } else {
        None
    }
}
