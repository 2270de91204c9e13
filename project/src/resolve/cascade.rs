//! The quantity that the loop controls: the rate, the position, the torque or the current that its sensor measures, or rate and position in a cascade.

use counterpoise_lti::Discretisation;
use counterpoise_models::{AxisKind, FeedbackSignal};
use counterpoise_synth::{Assembly, FeedforwardBasis, SamplingMethod, SynthesisMethod};

use super::synthesis::{DesignRequest, LoopKind};
use crate::file::field::{Field, NumberRange};
use crate::file::visit::{NamedChoice, Visit, choose, maybe_number};

impl NamedChoice for LoopKind {
    const NAMES: &'static [(&'static str, Self)] = &[
        ("rate", Self::Rate),
        ("position", Self::Position),
        ("cascade", Self::Cascade),
        ("torque", Self::Torque),
        ("current", Self::Current),
    ];
}

const LOOP: &str = "what the loop controls: the rate, the position, the torque or the current that its sensor measures (if absent, whichever it \
     is), or `cascade`: that position, by a proportional loop around a rate loop with the weights of `[synth.feedback]`, which takes the rate as \
     the difference of two readings over the sample period";
const GAIN: Field = Field::new(
    "position_gain",
    "gain of the position loop, demanded rate per position error; if absent and the weights are chosen, a fifth of the bandwidth that \
     they aim at",
)
.unit("rad/s")
.limit(NumberRange::Above(0.0));

/// Reads or lists what the loop controls.
pub(super) fn loop_kind(v: &mut dyn Visit, synth: &mut DesignRequest, measured: FeedbackSignal) {
    let usual = usual_kind(measured);
    if synth.loop_kind != LoopKind::Cascade {
        synth.loop_kind = usual;
    }
    choose(v, &Field::new("loop", LOOP).or_text(usual.name()), &mut synth.loop_kind);
    let is_cascade = synth.loop_kind == LoopKind::Cascade && usual == LoopKind::Position;
    if synth.loop_kind != usual && !is_cascade {
        let allowed = match usual {
            LoopKind::Position | LoopKind::Cascade => {
                "must be \"position\" or \"cascade\" with an encoder or a resolver"
            }
            LoopKind::Rate if synth.loop_kind == LoopKind::Cascade => {
                "needs an encoder or a resolver: the loop of rate within it is that of the differences of their readings"
            }
            LoopKind::Rate => "must be \"rate\" with a sensor of rate, and without any sensor",
            LoopKind::Torque => "must be \"torque\" with a torque sensor",
            LoopKind::Current => "must be \"current\" with a current sensor",
        };
        let instead = match synth.loop_kind {
            LoopKind::Rate => {
                "for a loop of rate let the encoder read it: encoder = { reads = \"rate\", ... }; or give [plant.sensors] a tachometer or a hub_gyro in its place"
            }
            LoopKind::Cascade => {
                "add [plant.sensors.encoder] or resolver, as in `encoder = { counts = 4096 }`"
            }
            LoopKind::Position => {
                "for a loop of position give [plant.sensors.encoder] or resolver, as in `encoder = { counts = 4096 }`"
            }
            LoopKind::Torque => "for a loop of torque give [plant.sensors.torque] in its place",
            LoopKind::Current => "for a loop of current give [plant.sensors.current] in its place",
        };
        v.complain("loop", allowed, Some(instead.to_owned()));
    }
    if synth.loop_kind == LoopKind::Cascade {
        maybe_number(v, &GAIN, &mut synth.specification.position_gain);
    } else {
        synth.specification.position_gain = None;
    }
}

/// Returns what the loop of a sensor controls if nothing else is said.
fn usual_kind(measured: FeedbackSignal) -> LoopKind {
    match measured {
        FeedbackSignal::HubRate | FeedbackSignal::RelativeRate | FeedbackSignal::MotorRate => LoopKind::Rate,
        FeedbackSignal::HubPosition | FeedbackSignal::MotorPosition => LoopKind::Position,
        FeedbackSignal::Torque => LoopKind::Torque,
        FeedbackSignal::Current => LoopKind::Current,
    }
}

const RATE_LIMIT: Field = Field::new(
    "rate_limit",
    "largest rate that the loop demands, however large the step; 0 for no limit; if absent, half of the rate that the drive can take up \
     and brake again without saturating",
)
.limit(NumberRange::AtLeast(0.0));

/// Reads or lists the largest rate that a loop of position demands.
pub(super) fn rate_limit(v: &mut dyn Visit, synth: &mut DesignRequest, axis: AxisKind) {
    if !matches!(synth.loop_kind, LoopKind::Position | LoopKind::Cascade) {
        synth.rate_limit = None;
        return;
    }
    let unit = match axis {
        AxisKind::Rotary => "rad/s",
        AxisKind::Linear => "m/s",
    };
    maybe_number(v, &RATE_LIMIT.unit(unit), &mut synth.rate_limit);
}

/// Complains of a cascade whose weights are stated without the gain of its position loop.
pub(super) fn with_stated_weights(v: &mut dyn Visit, kind: LoopKind, position_gain: Option<f64>) {
    if kind == LoopKind::Cascade && position_gain.is_none() {
        let allowed = "must be stated as `position_gain` beside [synth.feedback], in rad/s";
        let hint = "if no value is known, take a fifth of the bandwidth of the rate loop, or leave [synth.feedback] out: then both are chosen";
        v.complain("loop", allowed, Some(hint.to_owned()));
    }
}

/// Complains of what a cascade cannot be together with: the position loop is put around the three-part feedback and converted with
/// it, so that the rate is exactly a difference of readings.
pub(super) fn problem_exists(v: &mut dyn Visit, synth: &DesignRequest) {
    if synth.loop_kind != LoopKind::Cascade {
        return;
    }
    let (options, specification) = (&synth.options, &synth.specification);
    let is_tustin =
        synth.discretisation == SamplingMethod::Emulation(Discretisation::Tustin { prewarp_rad_s: None });
    let on_closed_loop = [&specification.heave, &specification.pitch]
        .into_iter()
        .flatten()
        .any(|part| part.basis == FeedforwardBasis::ClosedLoop);
    let apart = [
        (options.method != SynthesisMethod::ThreePart, "`method`"),
        (!options.alternatives.is_empty(), "`alternatives`"),
        (options.controller_order.is_some(), "`controller_order`"),
        (!options.structure.blocks.is_empty(), "[[synth.block]]"),
        (options.imported.is_some(), "[synth.controller]"),
        (options.search.is_some(), "[synth.search]"),
        (!is_tustin, "another `discretisation` than \"tustin\" without `prewarp`"),
        (specification.assembly != Assembly::SimpleAdd, "another `assembly` than \"simple-add\""),
        (on_closed_loop, "a feedforward whose `basis` is \"closed-loop\""),
    ];
    for (_, what) in apart.into_iter().filter(|(is_asked, _)| *is_asked) {
        let problem = format!("must not be \"cascade\" with {what}");
        v.complain("loop", &problem, Some("leave one of the two out".to_owned()));
    }
}
