//! The `[recording_controller]` section: what was in the loop when recordings were made.

use std::sync::Arc;

use counterpoise_controller::ProportionalIntegral;

use super::controller_file::{ControllerContent, parse};

use crate::file::field::Field;
use crate::file::visit::{Choice, Visit, choose};

/// The controller that was in the loop when recordings were made.
#[derive(Debug, Clone, PartialEq)]
pub enum RecordingController {
    /// A proportional-integral controller of the hub rate.
    ProportionalIntegral(ProportionalIntegral),
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
    /// What the file holds; `None` if it is not at hand.
    pub content: Option<Arc<ControllerContent>>,
}

impl RecordingController {
    /// Returns the proportional-integral controller; `None` if it is another one.
    pub fn as_proportional_integral(&self) -> Option<&ProportionalIntegral> {
        match self {
            Self::ProportionalIntegral(controller) => Some(controller),
            Self::Project | Self::Exported(_) => None,
        }
    }
}

/// The kinds of controller that recordings were made with.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    ProportionalIntegral,
    Project,
    Exported,
}

impl Choice for Kind {
    const NAMES: &'static [(&'static str, Self)] =
        &[("pi", Self::ProportionalIntegral), ("project", Self::Project), ("exported", Self::Exported)];
}

/// Returns a controller that is still to be read.
pub(crate) fn blank() -> RecordingController {
    RecordingController::ProportionalIntegral(blank_proportional_integral())
}

fn blank_proportional_integral() -> ProportionalIntegral {
    ProportionalIntegral {
        kp_v_s_rad: f64::NAN,
        ki_v_rad: f64::NAN,
        bias_v: f64::NAN,
        sample_period_s: f64::NAN,
        integral_v: 0.0,
    }
}

/// Reads or lists the controller of the recordings.
pub(crate) fn recording_controller(v: &mut dyn Visit, controller: &mut RecordingController) {
    let mut kind = match controller {
        RecordingController::ProportionalIntegral(_) => Kind::ProportionalIntegral,
        RecordingController::Project => Kind::Project,
        RecordingController::Exported(_) => Kind::Exported,
    };
    let meaning = "controller in the loop: pi, project for the one that this project exports, or exported for one in a file";
    choose(v, &Field::new("kind", meaning), &mut kind);
    *controller = match (kind, std::mem::replace(controller, RecordingController::Project)) {
        (Kind::Project, _) => RecordingController::Project,
        (Kind::ProportionalIntegral, before) => {
            let mut pi =
                before.as_proportional_integral().cloned().unwrap_or_else(blank_proportional_integral);
            proportional_integral(v, &mut pi);
            RecordingController::ProportionalIntegral(pi)
        }
        (Kind::Exported, before) => {
            let mut source = match before {
                RecordingController::Exported(source) => source,
                _ => ControllerSource::default(),
            };
            exported(v, &mut source);
            RecordingController::Exported(source)
        }
    };
}

fn exported(v: &mut dyn Visit, source: &mut ControllerSource) {
    v.text(&Field::new("file", "the controller.json that an export wrote"), &mut source.file);
    let hash =
        "hash of the project that it was exported from, as in the header of the C code; checked if given";
    v.text(&Field::new("hash", hash).or_text(""), &mut source.hash);
    let Some(text) = v.attached(&source.file) else { return };
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
}
