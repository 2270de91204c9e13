//! The `[recording_controller]` section: what was in the loop when recordings were made.

use std::sync::Arc;

use counterpoise_controller::{
    AntiWindup, PositionController, PositionSource, ProportionalIntegral, RateSource,
};
use counterpoise_models::CONVERTER_RANGE_V;

use super::controller_file::{ControllerContent, parse};

use crate::file::field::{Field, NumberRange};
use crate::file::visit::{NamedChoice, Visit, choose};
use crate::tolerance::MOST_RATE_SAMPLES;

/// The controller that was in the loop when recordings were made.
#[derive(Debug, Clone, PartialEq)]
pub enum RecordingController {
    /// A proportional-integral controller of the hub rate.
    ProportionalIntegral(ProportionalIntegral),
    /// A position controller with a rate loop inside.
    Position(PositionController),
    /// The controller that the project itself designs and exports.
    Project,
    /// The controller in a file that an export wrote.
    Exported(ControllerSource),
}

/// An exported controller by the file that holds it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ControllerSource {
    /// Name of the file.
    pub file: String,
    /// Hash of the project that it was exported from; empty if it is not checked.
    pub hash: String,
    /// Content of the file; `None` if it is not at hand.
    pub content: Option<Arc<ControllerContent>>,
}

impl RecordingController {
    /// Returns the proportional-integral controller; `None` if it is another one.
    pub fn as_proportional_integral(&self) -> Option<&ProportionalIntegral> {
        match self {
            Self::ProportionalIntegral(controller) => Some(controller),
            Self::Position(_) | Self::Project | Self::Exported(_) => None,
        }
    }
}

/// The kinds of controller that recordings were made with.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    ProportionalIntegral,
    Position,
    Project,
    Exported,
}

impl NamedChoice for Kind {
    const NAMES: &'static [(&'static str, Self)] = &[
        ("pi", Self::ProportionalIntegral),
        ("position", Self::Position),
        ("project", Self::Project),
        ("exported", Self::Exported),
    ];
}

/// Returns a controller that is still to be read.
pub(crate) fn blank_recording_controller() -> RecordingController {
    RecordingController::ProportionalIntegral(blank_proportional_integral())
}

fn blank_proportional_integral() -> ProportionalIntegral {
    ProportionalIntegral {
        kp_v_s_rad: f64::NAN,
        ki_v_rad: f64::NAN,
        bias_v: f64::NAN,
        sample_period_s: f64::NAN,
        ..ProportionalIntegral::default()
    }
}

fn blank_position() -> PositionController {
    PositionController {
        kp_1_s: f64::NAN,
        kv_v_s_rad: f64::NAN,
        ki_v_rad: 0.0,
        sample_period_s: f64::NAN,
        rate: RateSource::Differences(1),
        position: PositionSource::HubPosition,
        start_rate_rad_s: 0.0,
        integral_v: 0.0,
        anti_windup: AntiWindup::None,
        earlier_rad: Vec::new(),
    }
}

/// Reads or lists the controller of the recordings.
pub(crate) fn recording_controller(v: &mut dyn Visit, controller: &mut RecordingController) {
    let mut kind = match controller {
        RecordingController::ProportionalIntegral(_) => Kind::ProportionalIntegral,
        RecordingController::Position(_) => Kind::Position,
        RecordingController::Project => Kind::Project,
        RecordingController::Exported(_) => Kind::Exported,
    };
    let meaning = "controller in the loop: pi of the rate, position for one of the position with a rate loop inside, project for the one that this project exports, or exported for one in a file";
    choose(v, &Field::new("kind", meaning), &mut kind);
    *controller = match (kind, std::mem::replace(controller, RecordingController::Project)) {
        (Kind::Project, _) => RecordingController::Project,
        (Kind::ProportionalIntegral, before) => {
            let mut pi =
                before.as_proportional_integral().cloned().unwrap_or_else(blank_proportional_integral);
            proportional_integral(v, &mut pi);
            RecordingController::ProportionalIntegral(pi)
        }
        (Kind::Position, before) => {
            let mut position = match before {
                RecordingController::Position(position) => position,
                _ => blank_position(),
            };
            position_controller(v, &mut position);
            RecordingController::Position(position)
        }
        (Kind::Exported, before) => {
            let mut source = match before {
                RecordingController::Exported(source) => source,
                _ => ControllerSource::default(),
            };
            visit_exported_controller(v, &mut source);
            RecordingController::Exported(source)
        }
    };
}

fn visit_exported_controller(v: &mut dyn Visit, source: &mut ControllerSource) {
    v.text(&Field::new("file", "the controller.json that an export wrote"), &mut source.file);
    let hash =
        "hash of the project that it was exported from, as in the header of the C code; checked if given";
    v.text(&Field::new("hash", hash).or_text(""), &mut source.hash);
    let Some(text) = v.attached_text(&source.file) else { return };
    match text.and_then(|text| parse(&text).map_err(|why| format!("\"{}\": {why}", source.file))) {
        Ok(content) => {
            let found = &content.project_hash;
            if !source.hash.is_empty() && source.hash != *found {
                let other = format!(
                    "must be the hash in \"{}\", which is {found}: the file belongs to another export than the recordings",
                    source.file
                );
                let hint = "give the controller.json of the export that ran on the machine".to_owned();
                v.complain("hash", &other, Some(hint));
            }
            source.content = Some(Arc::new(content));
        }
        Err(why) => v.complain("file", &why, None),
    }
}

fn proportional_integral(v: &mut dyn Visit, controller: &mut ProportionalIntegral) {
    v.number(&Field::new("kp", "proportional gain").unit("V s/rad"), &mut controller.kp_v_s_rad);
    v.number(&Field::new("ki", "integral gain").unit("V/rad").or(0.0), &mut controller.ki_v_rad);
    v.number(&Field::new("bias", "constant added to the control").unit("V").or(0.0), &mut controller.bias_v);
    anti_windup(v, &mut controller.anti_windup);
}

/// The rules of an integral while the control is limited.
#[derive(Debug, Clone, Copy, PartialEq)]
enum WindupRule {
    None,
    Hold,
    HoldOutward,
    Clamp,
}

impl NamedChoice for WindupRule {
    const NAMES: &'static [(&'static str, Self)] = &[
        ("none", Self::None),
        ("hold", Self::Hold),
        ("hold-outward", Self::HoldOutward),
        ("clamp", Self::Clamp),
    ];
}

fn anti_windup(v: &mut dyn Visit, controller: &mut AntiWindup) {
    let (mut rule, mut limit) = match *controller {
        AntiWindup::None => (WindupRule::None, CONVERTER_RANGE_V),
        AntiWindup::Hold(limit) => (WindupRule::Hold, limit),
        AntiWindup::HoldOutward(limit) => (WindupRule::HoldOutward, limit),
        AntiWindup::Clamp(limit) => (WindupRule::Clamp, limit),
    };
    let meaning = "treatment of the integral while the control is limited: none goes on, hold waits, hold-outward waits while the error would drive the control further, clamp keeps the integral itself within the limit";
    choose(v, &Field::new("anti_windup", meaning).or_text("none"), &mut rule);
    if rule == WindupRule::None {
        *controller = AntiWindup::None;
        return;
    }
    let meaning = "control beyond which the integral is treated so; only with an `anti_windup`";
    v.number(
        &Field::new("limit", meaning)
            .unit("V")
            .limit(NumberRange::AboveTo(0.0, CONVERTER_RANGE_V))
            .or(CONVERTER_RANGE_V),
        &mut limit,
    );
    *controller = match rule {
        WindupRule::None => AntiWindup::None,
        WindupRule::Hold => AntiWindup::Hold(limit),
        WindupRule::HoldOutward => AntiWindup::HoldOutward(limit),
        WindupRule::Clamp => AntiWindup::Clamp(limit),
    };
}

fn position_controller(v: &mut dyn Visit, controller: &mut PositionController) {
    let gain = "gain of the position loop: the rate is to be this times the position error";
    v.number(&Field::new("position_gain", gain).unit("1/s"), &mut controller.kp_1_s);
    v.number(
        &Field::new("rate_gain", "proportional gain of the rate loop").unit("V s/rad"),
        &mut controller.kv_v_s_rad,
    );
    let integral = Field::new("rate_integral_gain", "integral gain of the rate loop").unit("V/rad").or(0.0);
    v.number(&integral, &mut controller.ki_v_rad);
    let mut samples = match controller.rate {
        RateSource::Measured => 0,
        RateSource::Differences(count) => count as u32,
    };
    let meaning =
        "samples over which the position is differenced to get the rate; 0 for the reading of a rate sensor";
    let field =
        Field::new("rate_samples", meaning).limit(NumberRange::Between(0.0, MOST_RATE_SAMPLES)).or(1.0);
    v.whole_number(&field, &mut samples);
    controller.rate =
        if samples == 0 { RateSource::Measured } else { RateSource::Differences(samples as usize) };
    anti_windup(v, &mut controller.anti_windup);
}

/// Takes the position from the sensor of the loop, which measures one; complains if the rate is to be read and no sensor measures it.
pub(super) fn read_position_of_loop(v: &mut dyn Visit, controller: &mut PositionController) {
    controller.position = PositionSource::LoopSensor;
    if controller.rate == RateSource::Measured {
        let allowed = "must be at least 1: the sensor of this loop measures a position, so no rate is read";
        v.complain("recording_controller.rate_samples", allowed, None);
    }
}
