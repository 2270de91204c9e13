//! Random mechanisms with the default adaptation: its trials, each against the same controller without it.

use counterpoise_pipeline::studies::adaptation_trials::{
    HoldBands, TrialLoad, TrialMotion, TrialRow, own_trials,
};
use counterpoise_pipeline::{build_plant_model, project_procedure, reduce_plant, synthesise};
use counterpoise_project::{Attachments, Document, Project, SettingValue};

use crate::sealed::Dice;
use crate::workspace::root;
use crate::{ExampleFolder, decide_choices};

/// Two runs of the same controller that differ in noise alone differ by less than this share.
const NOISE: f64 = 0.001;
/// The share of the hub rate added by a changed load that an adaptation must remove.
const REMOVED: f64 = 0.8;

/// The trials of the default adaptation on one mechanism.
#[derive(Debug, Clone)]
pub struct AdaptationCase {
    pub seed: u64,
    /// Description of the sample, in words.
    pub drawn: String,
    /// Motions on which the default acts; `None` if it acts on none.
    pub bands: Option<HoldBands>,
    pub rows: Vec<TrialRow>,
    pub is_refused: bool,
}

impl AdaptationCase {
    /// Returns the trial in which adaptation does worst against none.
    pub fn worst_trial(&self) -> Option<&TrialRow> {
        self.rows.iter().max_by(|a, b| a.ratio().total_cmp(&b.ratio()))
    }

    /// Returns whether no trial is worse than without adaptation by more than the noise, and none with a smaller load or one that returns by more than that for which a
    /// method is refused.
    pub fn is_never_worse(&self) -> bool {
        self.rows.iter().all(|row| match row.load {
            TrialLoad::Lower | TrialLoad::Returned => !row.is_harmful(),
            TrialLoad::Nominal | TrialLoad::WrongStart | TrialLoad::Sudden | TrialLoad::Slow => {
                row.ratio() <= 1.0 + NOISE
            }
        })
    }

    /// Returns the least share removed of what a changed load adds on road and multisine; `None` if it adds too little to tell.
    pub fn least_removed(&self) -> Option<f64> {
        let changed = |row: &&TrialRow| {
            matches!(row.load, TrialLoad::Sudden | TrialLoad::Slow) && row.motion != TrialMotion::Sines
        };
        self.rows.iter().filter(changed).filter_map(TrialRow::removed_share).min_by(f64::total_cmp)
    }

    /// Returns whether the adaptation removes enough wherever there is something to remove.
    pub fn removes_enough(&self) -> bool {
        self.least_removed().is_none_or(|share| share >= REMOVED)
    }
}

/// Returns the trials of a seed, with noise of another seed than that of the choice if `noise` is not 0; `None` if no controller exists for its
/// mechanism.
pub fn trial(seed: u64, noise: u64) -> Option<AdaptationCase> {
    let folder = root().join("examples/reference-rig");
    let text = std::fs::read(folder.join("project.toml")).ok()?;
    let (document, drawn) = draw_mechanism(Document::from_bytes(&text, "project.toml").ok()?, seed)?;
    let beside = ExampleFolder(folder);
    let stated = Project::resolve(&document, &Attachments::none()).ok()?.project;
    let project = decide_choices(stated, &beside);
    let modelled = build_plant_model(&project).ok()?;
    let made = synthesise(&project, &modelled, &reduce_plant(&project, &modelled).ok()?).ok()?;
    let mut procedure = project_procedure(&project, &beside).ok()?;
    procedure.seed += noise;
    let mut tried = own_trials(&project, &modelled, &made, &procedure).ok()??;
    let bands = tried.bands.filter(|bands| bands.is_exported);
    if bands.is_none() {
        // what runs is the controller without adaptation
        tried.rows.iter_mut().for_each(|row| row.with_rad_s = row.without_rad_s);
    }
    Some(AdaptationCase { seed, drawn, bands, is_refused: !tried.refused.is_empty(), rows: tried.rows })
}

/// A mechanism with the default adaptation: out-of-balance, gravity, friction, inertia, observer and motion are drawn.
fn draw_mechanism(document: Document, seed: u64) -> Option<(Document, String)> {
    let mut dice = Dice::new(seed);
    let mut log_uniform = |low: f64, high: f64| low * (high / low).powf(dice.uniform(0.0, 1.0));
    let balance = log_uniform(0.1, 1.2);
    let values = [
        ("plant.lumped.out_of_balance", 151.67 * balance),
        ("plant.lumped.hub_inertia", 74.1 * log_uniform(0.6, 1.6)),
        ("plant.lumped.beam_inertia", 271.6 * log_uniform(0.6, 1.6)),
        ("plant.friction.motor.coulomb", 0.065 * log_uniform(0.3, 2.5)),
        ("plant.friction.pivot.coulomb", 117.0 * log_uniform(0.3, 2.5)),
        ("plant.friction.motor.rest_stiffness", 1.3 * log_uniform(0.4, 2.5)),
        ("plant.friction.pivot.rest_stiffness", 2.4e5 * log_uniform(0.4, 2.5)),
        ("verify.heave.amplitude", 2.0 * log_uniform(0.5, 1.5)),
        ("verify.pitch.amplitude", 0.2 * log_uniform(0.5, 1.5)),
    ];
    let mut words = vec![format!("{:.0} % out of balance", 100.0 * balance)];
    let dry_nm = values[4].1 + 200.0 * values[3].1;
    words.push(format!(
        "friction over imbalance {:.2} m/s^2, heave {:.1}",
        dry_nm / values[0].1,
        values[7].1
    ));
    let has_gravity = dice.draw_below(3) != 0;
    let observes = dice.draw_below(2) == 0;
    let mut document = document;
    for section in ["synth.adaptation", "synth.schedule", "synth.observer"] {
        document = document.remove(section).unwrap_or(document);
    }
    for (key, value) in values {
        document = document.set(key, &SettingValue::Number(value)).ok()?;
    }
    if !has_gravity {
        words.push("no gravity".to_owned());
        document = document.set("plant.gravity", &SettingValue::Number(0.0)).ok()?;
    }
    if observes {
        words.push("observer".to_owned());
        document = document.set("synth.observer.share", &SettingValue::Number(0.9)).ok()?;
    }
    document = document.set("synth.adaptation.method", &SettingValue::Text("recursive".to_owned())).ok()?;
    Some((document, words.join(", ")))
}
