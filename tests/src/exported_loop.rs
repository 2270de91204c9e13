//! The practice effects in recordings under the controller that the reference rig exports: made by the independent simulator of
//! [`crate::sealed`], diagnosed in closed loop with the controller read from its own file, and with the recorded control played back.

use std::fs;
use std::path::Path;

use counterpoise_controller::Controller;
use counterpoise_diagnose::diagnose;
use counterpoise_diagnose::findings::answer::{Answer, DiagnosisVerdict};
use counterpoise_models::Parameters;
use counterpoise_pipeline::exchange::ControllerResult;
use counterpoise_pipeline::recordings::read::recording_controller;
use counterpoise_pipeline::{ProjectIdentity, build_plant_model, reduce_plant, synthesise};
use counterpoise_pool::Pool;
use counterpoise_project::{Attachments, Document, Project, SettingValue};
use counterpoise_simulate::replay::{RecordedController, ReplayLoop};

use crate::sealed::row::{offers, recordings};
use crate::sealed::truth::SHOW_WHEN_BALANCED;
use crate::sealed::{Case, PracticeEffect, case_of, case_under, controller, nominal_of};

/// Size of the concealed effects, relative to one that is easily seen.
pub const SIZE: f64 = 0.7;
/// Out-of-balance of the nearly balanced machine, kg m.
const BALANCED_KG_M: f64 = 20.0;

/// Under which controller the recordings were made, and how they are replayed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RecordedLoop {
    /// Under the exported controller, replayed with it.
    Exported,
    /// Under the exported controller, its recorded control played back.
    PlayedBack,
    /// Under the proportional-integral controller, replayed with it.
    ProportionalIntegral,
}

impl RecordedLoop {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Exported, Self::PlayedBack, Self::ProportionalIntegral];
}

/// A diagnosis with whether it is right.
pub struct CheckedDiagnosis {
    /// The answer.
    pub answer: Answer,
    /// `true` if the concealed effect is among the findings or their alternatives, or none is found if none is there.
    pub is_right: bool,
}

/// Returns the reference rig's project text with an out-of-balance.
pub fn document(out_of_balance_kg_m: Option<f64>) -> Document {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/reference-rig/project.toml");
    let document = Document::from_bytes(&fs::read(file).unwrap(), "project.toml").unwrap();
    match out_of_balance_kg_m {
        Some(value) => document.set("plant.lumped.out_of_balance", &SettingValue::Number(value)).unwrap(),
        None => document,
    }
}

/// Returns the controller that a project exports.
pub fn export_controller(project: &Project) -> Controller {
    let modelled = build_plant_model(project).unwrap();
    synthesise(project, &modelled, &reduce_plant(project, &modelled).unwrap()).unwrap().sampled.controller
}

/// Returns the text of the `controller.json` of a controller.
pub fn controller_file(project: &Project, controller: &Controller) -> String {
    let identity = ProjectIdentity { name: project.plant.name.clone(), hash: "0123".to_owned() };
    serde_json::to_string(&ControllerResult::new(&identity, controller)).unwrap()
}

/// Returns the controller of the recordings, read from its file by a project that names it.
pub fn from_file(document: &Document, text: &str) -> RecordedController {
    let named = document
        .set("recording_controller.kind", &SettingValue::Text("exported".to_owned()))
        .and_then(|it| it.set("recording_controller.file", &SettingValue::Text("controller.json".to_owned())))
        .unwrap();
    let files = Attachments::none().with("controller.json", text.as_bytes().to_vec());
    let project = Project::resolve(&named, &files).unwrap().project;
    recording_controller(&project).unwrap().unwrap()
}

/// The project's mechanism in which an effect shows, and its file.
fn rig(effect: &PracticeEffect) -> (Document, Parameters) {
    let balanced = effect.which.is_some_and(|which| SHOW_WHEN_BALANCED.contains(&which));
    let document = document(balanced.then_some(BALANCED_KG_M));
    (document, nominal_of(effect.which.unwrap_or(usize::MAX)))
}

/// Records the machine with a practice effect, and diagnoses it.
pub fn record_and_diagnose(effect: &PracticeEffect, way: RecordedLoop, pool: &dyn Pool) -> CheckedDiagnosis {
    let (document, nominal) = rig(effect);
    let project = Project::resolve(&document, &Attachments::none()).unwrap().project;
    let (case, control): (Case, ReplayLoop) = match way {
        RecordedLoop::ProportionalIntegral => {
            let case = effect.which.map_or_else(
                || crate::sealed::case_of_nothing(&nominal),
                |which| case_of(which, SIZE, &nominal),
            );
            (case, ReplayLoop::from(&controller()))
        }
        RecordedLoop::Exported | RecordedLoop::PlayedBack => {
            let controller = export_controller(&project);
            let replayed = from_file(&document, &controller_file(&project, &controller));
            let case = case_under(effect.which, SIZE, &nominal, &controller);
            (case, if way == RecordedLoop::Exported { ReplayLoop::from(replayed) } else { ReplayLoop::Open })
        }
    };
    let answer = diagnose(&nominal, control, &recordings(&case), pool).unwrap().answer;
    let is_right = match case.sealed.concealed.first() {
        Some(concealed) => answer.findings.iter().any(|finding| offers(concealed, finding)),
        None => answer.verdict == DiagnosisVerdict::Consistent,
    };
    CheckedDiagnosis { answer, is_right }
}
