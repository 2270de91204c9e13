//! The schedule over out-of-balance: the plant in each state of balance, and what becomes of the three controllers.

use counterpoise_models::plant::{Body, Plant};
use counterpoise_synth::{
    Conditions, HeaveFeedforwardLaw, ScheduleConfiguration, ScheduleEntry, design_schedule,
};
use serde::Serialize;

use crate::model::of_rate;
use crate::synth::design_plant::design_plant;
use crate::{PipelineError, PlantModel, build_plant_model, reduce_plant};
use counterpoise_project::Project;
use counterpoise_project::resolve::synthesis::DesignRequest;
use counterpoise_project::resolve::synthesis_options::{ScheduleLaw, ScheduleOptions};

/// A state of balance with what becomes of the controllers there: as it was found, or with sentences about it, which a result file has.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BalanceRow<Condition = Conditions, Law = HeaveFeedforwardLaw> {
    /// Name.
    pub name: String,
    /// Out-of-balance, kg m.
    pub out_of_balance_kg_m: f64,
    /// Conditions of the gain law that hold.
    pub conditions: Condition,
    /// Consequence for the heave feedforward.
    pub law: Law,
    /// Change of the feedback, lowest and highest over 0.1 to 20 Hz, dB.
    pub feedback_db: [f64; 2],
    /// Change of the heave feedforward, dB.
    pub heave_db: Option<[f64; 2]>,
    /// Change of the pitch feedforward, dB.
    pub pitch_db: Option<[f64; 2]>,
    /// RMS hub rate under the expected heave with the nominal controllers, rad/s.
    pub error_before_rad_s: Option<f64>,
    /// With the gain law.
    pub error_gain_law_rad_s: Option<f64>,
    /// With the redesign.
    pub error_after_rad_s: Option<f64>,
}

impl BalanceRow {
    /// Returns the row with sentences: about its conditions, and about its law.
    pub fn with_sentences(&self, conditions: String, law: String) -> BalanceRow<String, String> {
        BalanceRow {
            name: self.name.clone(),
            out_of_balance_kg_m: self.out_of_balance_kg_m,
            conditions,
            law,
            feedback_db: self.feedback_db,
            heave_db: self.heave_db,
            pitch_db: self.pitch_db,
            error_before_rad_s: self.error_before_rad_s,
            error_gain_law_rad_s: self.error_gain_law_rad_s,
            error_after_rad_s: self.error_after_rad_s,
        }
    }
}

/// Returns every state of balance designed for, the nominal one first.
///
/// # Errors
/// A configuration that does not exist, and those of the plant and the design.
pub fn schedule_entries(
    project: &Project,
    asked: &DesignRequest,
    modelled: &PlantModel,
    wanted: &ScheduleOptions,
) -> Result<Vec<ScheduleEntry>, PipelineError> {
    let nominal = make_configuration(project, asked, "nominal", modelled)?;
    let others = other_configurations(project, asked, modelled, wanted)?;
    Ok(design_schedule(&nominal, &others, &asked.specification)?)
}

/// Returns every state of balance besides the nominal one.
///
/// # Errors
/// As [`schedule_entries`].
pub(crate) fn other_configurations(
    project: &Project,
    asked: &DesignRequest,
    modelled: &PlantModel,
    wanted: &ScheduleOptions,
) -> Result<Vec<ScheduleConfiguration>, PipelineError> {
    let mut others = Vec::new();
    for name in &wanted.configurations {
        let mut project = project.clone();
        project.model.configuration = Some(name.clone());
        let modelled = build_plant_model(&project)?;
        others.push(make_configuration(&project, asked, name, &modelled)?);
    }
    for &factor in &wanted.factors {
        let name = format!("{:.0} % out-of-balance", 100.0 * factor);
        others.push(make_configuration(project, asked, &name, &with_factor(project, modelled, factor)?)?);
    }
    Ok(others)
}

fn make_configuration(
    project: &Project,
    asked: &DesignRequest,
    name: &str,
    modelled: &PlantModel,
) -> Result<ScheduleConfiguration, PipelineError> {
    let reduced = reduce_plant(project, modelled)?;
    Ok(ScheduleConfiguration {
        name: name.to_owned(),
        out_of_balance_kg_m: modelled.plant.body().out_of_balance_kg_m,
        plant: design_plant(asked, modelled, &reduced)?,
    })
}

/// Returns the mechanism with its out-of-balance times a factor, everything else kept.
///
/// # Errors
/// Those of the plant.
pub fn with_factor(
    project: &Project,
    modelled: &PlantModel,
    factor: f64,
) -> Result<PlantModel, PipelineError> {
    let plant = scale_imbalance(&modelled.plant, factor)?;
    let equilibrium = plant.equilibrium(&project.model.operating_point);
    let linear = plant.linearise(&equilibrium, project.model.friction, plant.angles())?;
    let rate = of_rate(&plant, &equilibrium, project.model.friction)?;
    let (parameters, elements) = (modelled.parameters.clone(), modelled.elements.clone());
    Ok(PlantModel { plant, linear, rate, parameters, elements })
}

/// Returns the plant with its out-of-balance times a factor.
pub(crate) fn scale_imbalance(plant: &Plant, factor: f64) -> Result<Plant, PipelineError> {
    let mut body: Body = plant.body().clone();
    body.out_of_balance_kg_m *= factor;
    body.modes.iter_mut().for_each(|mode| mode.load_share_kg_m *= factor);
    Ok(Plant::with_whole_body(plant.parameters(), body)?)
}

/// Returns whether the exported controller interpolates redesigns.
pub(crate) fn redesigns(asked: &ScheduleOptions, entries: &[ScheduleEntry]) -> bool {
    match asked.law {
        ScheduleLaw::Gain => false,
        ScheduleLaw::Redesign => true,
        ScheduleLaw::Auto => {
            entries.iter().any(|entry| matches!(entry.law, HeaveFeedforwardLaw::Redesign { .. }))
        }
    }
}

/// Returns the designs that the exported controller interpolates: those of the configurations; of the factors where
/// there are none, because two designs of one out-of-balance and different inertia cannot both hold.
pub(crate) fn select_interpolated<'a>(
    asked: &ScheduleOptions,
    entries: &'a [ScheduleEntry],
) -> &'a [ScheduleEntry] {
    match asked.configurations.len() {
        0 => entries,
        count => &entries[..entries.len().min(1 + count)],
    }
}

/// Returns the entries as plain rows.
pub fn balance_rows(entries: &[ScheduleEntry]) -> Vec<BalanceRow> {
    entries.iter().map(row).collect()
}

fn row(entry: &ScheduleEntry) -> BalanceRow {
    let both = |(low, high): (f64, f64)| [low, high];
    BalanceRow {
        name: entry.name.clone(),
        out_of_balance_kg_m: entry.out_of_balance_kg_m,
        conditions: entry.conditions,
        law: entry.law,
        feedback_db: both(entry.feedback_db),
        heave_db: entry.heave_db.map(both),
        pitch_db: entry.pitch_db.map(both),
        error_before_rad_s: entry.error_before,
        error_gain_law_rad_s: entry.error_gain_law,
        error_after_rad_s: entry.error_after,
    }
}
